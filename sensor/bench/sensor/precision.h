/* sensor/bench/sensor/precision.h: `pitviper bench precision`, what concerns whole frames, models and detectors: for
 * every approximation its settings, what each costs and how wrong it is. */
#ifndef SENSOR_BENCH_SENSOR_PRECISION_H
#define SENSOR_BENCH_SENSOR_PRECISION_H

#include "sensor/quality/trial.h"
#include "sensor/bench/turn.h"

/* What errors are measured in: several pictures, so that none is that of a lucky one. */
typedef enum PrecisionShot { SHOT_GROUND, SHOT_NEAR, SHOT_SMALL, SHOT_HORIZON, SHOT_COUNT } PrecisionShot;
extern const char *const precision_shot_name[SHOT_COUNT];

typedef struct Precision {
    Bench     *bench;
    Landscape  landscape;
    TrialScene scene;
    Pool      *pool;
    Arena     *keep[SHOT_COUNT], *arena, *other; /* of shots; of pictures */
    TrialFrame shot[SHOT_COUNT];   /* poses and air, made once; views of shot_px */
    int        shot_px[2];
    Status     status;             /* of what is timed */
} Precision;

Status precision_open(Precision *out, Bench *bench);
void   precision_close(Precision *p);
/* A middle piece of a shot's view, no larger than it, as a node asks for it by default. */
RenderRequest precision_request(const Precision *p, PrecisionShot shot, int width, int height);
/* Goes about the vehicle in the middle, by 1.3 rad a turn, and looks at it; returns its range, m. */
double precision_go_round(View *view, const Precision *p, int turn);
/* Of a shot's poses and air; in the arena, which is not reset. */
Status precision_render(Picture *out, Precision *p, PrecisionShot shot, const RenderRequest *request, Arena *arena);
/* Root of the mean squared difference over the radiance planes, each over its own mean; of thermal ones as K. */
double precision_rms(const Picture *got, const Picture *want);
double precision_rms_k(const Picture *got, const Picture *want, const PlanckTable *lwir);

/* The suite, and what of it stands in files of its own. */
Status bench_precision(Bench *bench);
Status precision_models(Precision *p);
Status precision_detectors(Bench *bench);
Status precision_small_target(Bench *bench);

#endif
