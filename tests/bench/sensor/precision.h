/* tests/bench/sensor/precision.h: `pitviper bench precision` for whole frames, models and detectors: for every
 * tunable its settings, with the cost and the error of each. */
#ifndef TESTS_BENCH_SENSOR_PRECISION_H
#define TESTS_BENCH_SENSOR_PRECISION_H

#include "sensor/quality/trial_private.h"
#include "tests/bench/bench.h"

/* The images in which errors are measured: several, so that no error is that of a lucky one. */
typedef enum PrecisionShot { SHOT_GROUND, SHOT_NEAR, SHOT_SMALL, SHOT_HORIZON, SHOT_COUNT } PrecisionShot;
extern const char *const precision_shot_name[SHOT_COUNT];

typedef struct Precision {
    Bench     *bench;
    Landscape  landscape;
    TrialScene scene;
    Pool      *pool;
    Arena     *keep[SHOT_COUNT], *arena, *other; /* of shots; of images */
    TrialFrame shot[SHOT_COUNT];                 /* poses and atmosphere, made once; views of shot_px */
    int        shot_px[2];
    Status     status; /* of the timed frames */
} Precision;

Status precision_open(Precision *out, Bench *bench);
void   precision_close(Precision *p);
/* Requests a central piece of a shot's view, no larger than it, with the default settings of a node. */
RenderRequest precision_request(const Precision *p, PrecisionShot shot, int width, int height);
/* Moves around the central vehicle, by 1.3 rad a turn, aimed at it; returns its range, m. */
double precision_go_round(View *view, const Precision *p, int turn);
/* Of a shot's poses and atmosphere; in the arena, which is not reset. */
Status precision_render(Picture *out, Precision *p, PrecisionShot shot, const RenderRequest *request, Arena *arena);
/* Root of the mean squared difference over the radiance planes, each relative to its own mean; thermal planes in K. */
double precision_rms(const Picture *got, const Picture *want);
double precision_rms_k(const Picture *got, const Picture *want, const PlanckTable *lwir);

/* The suite, and its parts in files of their own. */
Status bench_precision(Bench *bench);
Status precision_models(Precision *p);
Status precision_detectors(Bench *bench);
Status precision_small_target(Bench *bench);
Status precision_plants(Bench *bench);
Status precision_radar_seeker(Bench *bench);
Status precision_coarse(Bench *bench);
Status precision_sampling(Bench *bench);
Status precision_scenery(Bench *bench);

#endif
