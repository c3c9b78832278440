/* entities/traces/ground_marks.h: what entities leave on the ground: where they stood, tracks of vehicles, burnt
 * ground. Bounded: when full, the oldest is forgotten and counted.
 *
 * Marks are recorded at PDUs, at instants that follow from them alone; what a snapshot holds at t is a function of the
 * PDUs received and of t. Which entity leaves which mark: entities/table/entity_marks.c. */
#ifndef ENTITIES_TRACES_GROUND_MARKS_H
#define ENTITIES_TRACES_GROUND_MARKS_H

#include "entities/traces/effect_puffs.h"

/* most marks of a snapshot, those since the last reports included */
enum {
    ground_stand_capacity = 4096,
    ground_track_capacity = 32768,
    ground_burn_capacity = 1024,
    ground_tracks_most = 1 << 20
};
/* Longer pieces are refused when read: recorded ones are shorter than 60 m/s over a long timeout. */
static const double ground_track_longest_m = 20000;

/* Exhaust from a place where an entity stands: one interval of its engine. */
typedef struct GroundBlow {
    float  at_m[3], d[3]; /* as in ExhaustJet, body axes */
    float  radius_m, speed_mps, excess_k;
    double from_s, to_s; /* exercise time; there is none where to_s is not after from_s */
} GroundBlow;

/* An entity that stood still within 0.5 m and 5 degrees for 60 s or more, or stands: recorded with the first report
 * that finds it so. One that first appears standing is taken to have stood for EntityTableConfig.stood_s before:
 * from_s is its first report less that, and to have run its engine for the last hour if it does then. An engine that
 * starts again begins another stand. Ends with the report that shows it moved or turned, its removal, or its
 * timeout. */
typedef struct GroundStand {
    double     p_ecef[3]; /* the model's origin (base centre), on the ground where its entity is clamped to it */
    double     r_ecef_from_body[9];
    float      low_m[3], high_m[3]; /* box of the model at rest without guns and rotors, body axes, from that origin */
    double     from_s, to_s;        /* exercise time; to_s is INFINITY while it still stands */
    uint64_t   owner;               /* entity_key + 1 */
    GroundBlow blow;
} GroundStand;

/* One straight piece of a trail: both tracks, or the wheels of both sides. */
typedef struct GroundTrack {
    double a_ecef[3],
        b_ecef[3];             /* centre line, at the base of the vehicle, on the ground where that is clamped to it */
    double   a_s, b_s;         /* when it passed there */
    float    width_m, apart_m; /* width of one track or tyre; distance between both centre lines */
    float    heat_j_m2;        /* friction heat left in the ground under each */
    bool     tracked;
    uint64_t owner; /* entity_key + 1; 0: not known, as of a frame file */
} GroundTrack;

/* Ground that a burst burnt. */
typedef struct GroundBurn {
    double p_ecef[3];
    double t_s;
    float  radius_m, crater_m; /* radius of the burnt ground, and of the crater */
    float  heat_j_m2;
} GroundBurn;

/* All marks at one instant, each sort in the order recorded, tracks since the last reports at the end. */
typedef struct GroundMarks {
    int                stands, tracks, burns;
    const GroundStand *stand;
    const GroundTrack *track;
    const GroundBurn  *burn;
    int64_t            forgotten; /* how many of the oldest were forgotten beyond capacity */
} GroundMarks;

/* The trail of one vehicle: its end, which the next point continues. */
typedef struct GroundTrail {
    bool        on, has_course;
    double      p_ecef[3], t_s;
    double      course_ecef[3]; /* unit direction of the last piece */
    double      speed_mps;      /* the larger speed of the two reports around it */
    uint64_t    piece;          /* handle of the last piece; 0: none */
    GroundTrack shape;          /* widths and heat of its pieces */
} GroundTrail;

typedef struct GroundHistory GroundHistory;

Status  ground_history_create(GroundHistory **out);
void    ground_history_destroy(GroundHistory *history);
int64_t ground_history_forgotten(const GroundHistory *history);

/* to_s: the latest it can last as far as it is known now. Returns a handle, never 0; those of forgotten stands, and 0,
 * have no effect below. */
uint64_t ground_stand_open(GroundHistory *history, const GroundStand *stand);
void     ground_stand_until(GroundHistory *history, uint64_t handle, double to_s);
void     ground_stand_blows(GroundHistory *history, uint64_t handle, const GroundBlow *blow);
/* The latest stand of the owner, if it is in the same place and ended at since_s or later; 0: none. O(capacity). */
uint64_t ground_stand_again(double *from_s, const GroundHistory *history, const GroundStand *stand, double since_s);
/* Whether two places and attitudes are the same within 0.5 m and 5 degrees. */
bool ground_stand_same_place(const double p_ecef[3], const double r_ecef_from_body[9], const double q_ecef[3],
                             const double r_other[9]);

/* Another point of a trail, at a later time: a piece every 4 m, or from 1 m where the course changes by more than 3
 * degrees; last: it stops here, a piece from 0.5 m. A piece is merged with the one before it while the course stays
 * within 1 degree of that one's and the speed within 10 %, up to 50 m; longer ones are divided. Where the point cannot
 * have been reached on the ground (60 m/s, much faster than reported, steeper than 45 degrees) a new trail begins. */
void ground_trail_point(GroundHistory *history, GroundTrail *trail, const double p_ecef[3], double t_s, bool last);
/* The same into out, at most one piece, which is not merged. Returns how many. */
int ground_trail_tail(GroundTrack *out, GroundTrail *trail, const double p_ecef[3], double t_s, bool last);

/* Records a burst. One repeated (same place, within 0.5 s, among the last 8) is ignored. */
void ground_burn(GroundHistory *history, const GroundBurn *burn);

/* Those with from_s, a_s or t_s up to t_s, in the arena; room for tail_capacity more tracks. */
Status ground_marks_at(GroundMarks *out, GroundTrack **tail, const GroundHistory *history, double t_s,
                       int tail_capacity, Arena *arena);

/* ---- over a restart: entities/traces/ground_marks_file.c ------------------------------------------------ */

/* A CSV file, written to PATH.part and renamed. unix_s: Unix time of exercise time 0. Times of the file are Unix time,
 * so those of marks come back to 0.3 us; places and figures to the bit. */
Status ground_marks_save(const GroundHistory *history, double unix_s, const char *path);
/* Into a history without marks (else STATUS_UNSUPPORTED). Stands that still went on end when their entity would have
 * timed out (those of a paused exercise: at exercise time 0), or go on where the same entity stands there again:
 * ground_stand_again. Every value is checked; on failure, logged with file and line, the history is unchanged. */
Status ground_marks_load(GroundHistory *history, double unix_s, const char *path);

#endif
