/* sensor/bench/render/stability.h: `pitviper bench stability`: stress cases with a measured figure each.
 *
 * The reference of a case is independent of the code under test: a closed form, brute force in long double,
 * symmetry, conservation of energy. Robustness cases count values that are not finite or below 0, and their limit is
 * 0. A time beside a figure is that of the whole case. */
#ifndef SENSOR_BENCH_RENDER_STABILITY_H
#define SENSOR_BENCH_RENDER_STABILITY_H

#include "sensor/bench/bench.h"
#include "entities/models/model.h"

typedef struct StabilityCase {
    const char *what;
    double    (*figure)(void *user, bool quick); /* INFINITY: the case could not be set up */
    double      limit;
    const char *unit, *against;
} StabilityCase;

/* Runs each and adds its row. */
void stability_cases(Bench *bench, const StabilityCase *cases, int count, void *user);

/* A separate random stream for each case: same figure whichever cases ran before. */
typedef struct Dice {
    uint32_t stream;
    uint64_t index;
} Dice;
double dice_uniform(Dice *dice, double low, double high);
double dice_log(Dice *dice, double low, double high); /* log-uniform; 0 < low */
void   dice_direction(double d[3], Dice *dice);
void   dice_rotation(double r[9], Dice *dice);

/* ---- synthetic models: one node, one part ----------------------------------------------------- */

/* STATUS_NO_MEMORY. */
Status stress_model(Model *out, int vertices, int triangles);
void   stress_model_free(Model *model);
void   stress_triangle(Model *model, const double a[3], const double b[3], const double c[3]);
void   stress_box(Model *model, const double low[3], const double high[3]); /* 8 vertices, 12 triangles */
/* Vertices on a sphere, joined: 2 + (bands - 1) 2 bands of them, 4 bands (bands - 1) triangles. */
void   stress_sphere(Model *model, double radius_m, int bands);

/* ---- the parts of the suite -------------------------------------------------------------------- */

Status bench_stability(Bench *bench);
Status stability_parts(Bench *bench);    /* rays against triangles */
Status stability_ground(Bench *bench);   /* rays against the height field */
Status stability_light(Bench *bench);    /* Planck, air, smoke, surfaces */
Status stability_sun(Bench *bench);      /* the sun at the horizon, overhead, behind */
Status stability_pictures(Bench *bench); /* ranges, origins, views, sizes */
Status stability_plants(Bench *bench);   /* rays against plants */
Status stability_heat(Bench *bench);     /* the ground's heat */
Status stability_network(Bench *bench);  /* networks of thermal nodes */
Status stability_crowd(Bench *bench);    /* numbers of entities, positions of the eye, the radar */
Status stability_radar(Bench *bench);    /* the field of a radar target */

#endif
