/* render/heat/heat_private.h: the ground's heat over an exercise, shared by heat.c, heat_past.c, heat_course.c and
 * heat_kept.c. */
#ifndef RENDER_HEAT_HEAT_PRIVATE_H
#define RENDER_HEAT_HEAT_PRIVATE_H

#include "render/heat/heat.h"

#include "pitviper_kept.h"

enum { heat_halvings = 6 }; /* lengths of steps whose elimination is kept: the usual one, and its halves */
enum { history = 2048 };    /* steps whose surface is remembered: 34 h of 60 s */

/* One kind: its columns, facet by facet, then by n_up in the shade, without sun, and one that sees no sky. */
typedef struct KindState {
    GroundColumn *column;
    float         falls_w_m2k[history]; /* of the level column, by step */
} KindState;

typedef struct Sky {                             /* of one step of the past */
    double direct_w_m2, diffuse_w_m2, loss_w_m2; /* loss: of a black level plane of air temperature to the sky */
} Sky;

typedef struct Interval {
    int64_t from, to; /* times of the grid, from < to */
} Interval;

/* The next step, as far as it has been worked at. */
typedef struct Ahead {
    int           part, intervals;
    GroundWeather after;
    Interval      interval[heat_past];
    HeatPast      past;
} Ahead;

/* The weather that warms the ground up to an exercise: at coarse times, `wide` steps apart, from the spin-up's first
 * on, then at fine ones, a step apart, up to one beyond the beginning. */
typedef struct Course {
    int64_t        first, wide, fine_from; /* time of the grid; steps; time of the grid */
    int            coarse, fine;
    GroundWeather *at; /* [coarse + fine] */
} Course;

struct Heat {
    GroundKinds      kinds;
    HeatConfig       config;
    Column           layers[ground_kinds];
    ColumnFactors    factors[2][ground_kinds][heat_halvings]; /* of step_s and of half hours, and of their halves */
    int              columns;                                 /* a kind */
    KindState        state[ground_kinds];
    GroundColumn     level[2][ground_kinds]; /* level ground at the times of the tables */
    Ahead           *ahead;
    GroundColumn    *begun; /* all columns at the beginning of the exercise */
    float            begun_falls[ground_kinds][history];
    Sky              sky[history], begun_sky[history];
    int64_t          index, begun_index; /* time of the columns: unix = index * step_s */
    int64_t          shown;              /* of table[1]; the columns may be a step ahead of it */
    int64_t          first;              /* of the spin-up */
    GroundWeather    weather[2];         /* at the columns' time, and a step before */
    GroundHeatTable *table;              /* [2]: a step before, and at shown; past alike */
    HeatPast        *past;
    int              slots, slot_of[heat_day_slots]; /* place of each half hour of UTC; -1: night */
    float            slot_d_enu[3][heat_day_slots];
    int              kind_of[SURFACE_COUNT];
    int              branches;
    BranchKind       branch_kind[branch_most_kinds];
    Branch           branch[branch_most_kinds][branch_radii][2], begun_branch[branch_most_kinds][branch_radii][2];
    Course           course; /* while it is warmed up */
    double           spent_s;
    int              steps;
};

/* Place of a time of the grid, before 1970 too, in what is remembered. */
static inline int place_of(int64_t index) { return (int)((index % history + history) % history); }

/* ---- the past: heat_past.c --------------------------------------------------------------------- */

typedef struct PastJob {
    Heat           *heat;
    const Interval *interval;
    int             count;
    HeatPast       *past;
} PastJob;

/* All but the responses; returns how many intervals there are. */
int heat_past_begin(Heat *h, HeatPast *out, Interval interval[heat_past]);
/* The responses of a kind of ground, a PoolTask: K now for 1 W/m2 over each interval. user: PastJob. */
void heat_past_respond(void *user, int worker, int kind);

/* A pulse of heat at the surface of a column whose bottom lets nothing through, marched back in time by steps: K at the
 * surface now for 1 W/m2 into it over that step. falls: of what leaves it, W/(m2 K). */
void   heat_pulse_start(ColumnState *out, const Column *column);
double heat_pulse_step(ColumnState *state, const Column *column, double falls_w_m2k, double dt_s);

/* ---- the weather that warms it: heat_course.c -------------------------------------------------- */

static const double day_s = 86400, slot_s = 1800;

/* On the pool. */
void heat_run(Pool *pool, int count, PoolTask *task, void *user); /* pool NULL: one after the other */
/* Number of steps in half an hour, and of such strides in a day. */
static inline int64_t heat_half_hour(const HeatConfig *c) { return (int64_t)fmax(1, round(slot_s / c->step_s)); }
static inline int     heat_day_strides(const HeatConfig *c)
{
    const int64_t day = (int64_t)round(day_s / c->step_s), stride = heat_half_hour(c);
    return (int)((day + stride - 1) / stride);
}
/* From the times of the grid first to begun: by half hours till the morning before, then by steps. The caller frees
 * out->at. */
Status heat_course_find(Course *out, const HeatConfig *config, int64_t first, int64_t begun);
/* At a time of the course. */
static inline const GroundWeather *heat_course_at(const Course *c, int64_t index)
{
    return &c->at[index >= c->fine_from ? c->coarse + (index - c->fine_from) : (index - c->first) / c->wide];
}

/* Half hours of the day past (of UTC, by their middle) with the sun up: slot_of of each, -1: night, and where the sun
 * stood. Returns how many. */
int heat_day_sun(int slot_of[heat_day_slots], float d_enu[3][heat_day_slots], const HeatConfig *config);

/* ---- columns: heat.c --------------------------------------------------------------------------- */

/* Normal of a node of the square of facets. */
void heat_facet_normal(double n_enu[3], int u, int v, int facets);
/* Of steps of dt_s, and of those that it is halved into. */
void heat_factors_of(ColumnFactors out[heat_halvings], const Column *layers, double dt_s);

/* ---- between runs: heat_kept.c ----------------------------------------------------------------- */

/* h: with its course, its layers and kinds. */
CacheKey heat_kept_key(const Heat *h);
/* All of a kind of ground, into a key. */
void heat_kept_ground(CacheKey *key, const GroundKind *kind);
/* KeptValues of a Heat whose columns are started: its state at the beginning, and a step on. */
KeptValues heat_kept_values;

#endif
