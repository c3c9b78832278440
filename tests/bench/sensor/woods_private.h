/* tests/bench/sensor/woods_private.h: shared by the files woods_*.c of `bench woods`. */
#ifndef TESTS_BENCH_SENSOR_WOODS_PRIVATE_H
#define TESTS_BENCH_SENSOR_WOODS_PRIVATE_H

#include "tests/bench/picture_statistics.h"
#include "tests/bench/sensor/speed_private.h"

enum { woods_views = 4, woods_vehicles = 20, woods_details = 2 /* full detail; the representation that is judged */ };

/* Parts of the bench, each with its word for --parts: bits of WoodsBench.parts. */
typedef enum WoodsPart { WOODS_TIMES, WOODS_ERRORS, WOODS_VEHICLES, WOODS_FLIGHT, WOODS_SEEKER, WOODS_PARTS } WoodsPart;

typedef struct WoodsPose {
    const char *name;
    double      above_m, down_deg, hfov_deg;
} WoodsPose;
extern const WoodsPose woods_pose[woods_views];

extern const char *const woods_detail[woods_details];

/* Places of planes in rows: as picture_plane. */
extern const char *const woods_plane[picture_plane_count];
/* Those whose errors have limits: red, 3-5 um, 8-12 um. */
enum { woods_bands = 3 };
static const int woods_band_plane[woods_bands] = {picture_optical, picture_mwir, picture_lwir};

typedef struct WoodsBench {
    Bench     *bench;
    unsigned   parts, views; /* bits: that are asked for */
    int        width, height, trees;
    double     east_m, north_m;
    LocalFrame frame;
    Landscape  landscape;
    Woods      woods;
    TrialScene scene;
    Forest    *forest[woods_details]; /* the scene's own is one of them */
    Pool      *one, *many;
    Arena     *arena[3];
} WoodsBench;

static inline bool woods_wants(const WoodsBench *w, WoodsPart part) { return w->parts >> part & 1; }

/* One frame of a detail. scene: NULL: the bench's own. */
typedef struct WoodsFrame {
    WoodsBench *w;
    int         detail;
    TrialScene *scene;
    TrialFrame  frame;
} WoodsFrame;

WoodsFrame woods_frame(WoodsBench *w, int detail, const RenderRequest *request, Pool *pool, Arena *arena);
void       woods_render(void *user); /* user: a WoodsFrame */
/* View of a pose from south of the vehicles, so far that its middle is at their height. */
View woods_view(const WoodsBench *w, int v);
/* samples x samples rays in every pixel, no others; all bands, all truth. */
RenderRequest woods_request(const WoodsBench *w, int v, int samples);

/* Whether a pixel's `instance` is a standing plant. */
static inline bool woods_is_standing(uint32_t instance) { return instance && !((instance - 1) & forest_low_bit); }

double woods_processor_s(void);

/* Sums of squared differences b - a of pixels and of means over blocks of 4 px, of those where `of` is not 0 (NULL:
 * all).
 */
void woods_add_squares(double sum[2], const float *a, const float *b, const uint8_t *of, int width, int height);

/* A forest of another kind in the place of a detail's. */
Status woods_replace(WoodsBench *w, int detail, const ForestConfig *config);

/* ---- rows ----------------------------------------------------------------------------------------- */

void woods_say(WoodsBench *w, const char *what, double value, const char *unit);
void woods_say_memory(WoodsBench *w, const char *what, double limit_mb);

/* The magnitude of a figure beside its limit. Its standard error is said; twice it, at least 0.5 % and at most half of
 * the limit, is allowed beyond the limit, so that noise alone seldom fails a row, and a figure that is hardly known
 * cannot pass by that. limit NaN: none. Quick runs have too few pixels for limits: theirs have none. */
typedef struct WoodsLimit {
    double      limit;
    const char *unit;
    bool        below; /* whatever is below 0 is well, and the figure keeps its sign */
} WoodsLimit;
void woods_judge(WoodsBench *w, const char *what, Estimate figure, WoodsLimit limit, const char *text);

/* ---- vehicles among the plants: woods_targets.c --------------------------------------------------- */

enum { woods_sites = 150, woods_quick_sites = 10 };
static inline int woods_sites_used(const WoodsBench *w)
{
    return bench_quick(w->bench) ? woods_quick_sites : woods_sites;
}

/* Vehicles at random places that a view sees, wherever plants stand there, in place of the bench's twenty. */
typedef struct WoodsCrowd {
    WoodsBench *w;
    int         v;
    TrialScene  scene; /* the bench's but for its table, and what is warm */
} WoodsCrowd;

enum { woods_ring_features = 3 * woods_bands };

/* About each site, by view, with its vehicle and without, in each detail: what the surroundings look like. */
typedef struct WoodsRings {
    double  feature[woods_views * woods_sites][2][woods_details][woods_ring_features];
    uint8_t known[woods_views * woods_sites]; /* all of its surroundings are in the picture */
} WoodsRings;

/* woods_recognisers.c: rows of false alarms in one view; surroundings of the crowd's vehicles; rows of a classifier of
 * them, once all views are in. */
Status woods_alarms(WoodsCrowd *crowd, WoodsRings *rings);
Status woods_classify(WoodsBench *w, const WoodsRings *rings);

/* ---- parts of the bench --------------------------------------------------------------------------- */

Status woods_timings(WoodsBench *w, int v); /* woods_timings.c: frames, default quality, pixels of plants */
Status woods_stages(WoodsBench *w, int v);  /* woods_timings.c */
Status woods_errors(WoodsBench *w, int v);  /* woods_errors.c: pictures beside many rays in full detail */
Status woods_targets(WoodsBench *w);        /* woods_targets.c: vehicles among plants, recognisers */
Status woods_seeker(WoodsBench *w);         /* woods_seeker.c: two cameras and a radar */
Status woods_flight(WoodsBench *w);         /* woods_flight.c: changes of representation on the way to an impact */
Status woods_far_end(WoodsBench *w);        /* woods_far_end.c: where plants of pages end */

#endif
