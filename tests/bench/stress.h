/* tests/bench/stress.h: `pitviper bench stability`: stress cases with a measured figure each.
 *
 * The reference of a case is independent of the code under test: a closed form, brute force in long double,
 * symmetry, conservation of energy. Robustness cases count values that are not finite or below 0, and their limit is
 * 0. A time beside a figure is that of the whole case. */
#ifndef TESTS_BENCH_STRESS_H
#define TESTS_BENCH_STRESS_H

#include "tests/bench/bench.h"
#include "entities/models/model.h"

typedef struct StressCase {
    const char *what;
    double (*figure)(void *user, bool quick); /* INFINITY: the case could not be set up */
    double      limit;
    const char *unit, *against;
} StressCase;

/* Runs each and adds its row. */
void stress_cases(Bench *bench, const StressCase *cases, int count, void *user);

/* A random stream of each case's own, so that it gives the same figure whichever cases ran before. */
typedef struct Dice {
    uint32_t stream;
    uint64_t index;
} Dice;
double stress_uniform(Dice *dice, double low, double high);
double stress_log_uniform(Dice *dice, double low, double high); /* log-uniform; 0 < low */
void   stress_direction(double d[3], Dice *dice);
void   stress_any_rotation(double r[9], Dice *dice);

/* ---- synthetic models: one node, one part ----------------------------------------------------- */

/* STATUS_NO_MEMORY. */
Status stress_model(Model *out, int vertices, int triangles);
void   stress_model_free(Model *model);
void   stress_triangle(Model *model, const double a[3], const double b[3], const double c[3]);
void   stress_box(Model *model, const double low[3], const double high[3]); /* 8 vertices, 12 triangles */
/* Makes a sphere of joined vertices: 2 + (bands - 1) 2 bands of them, 4 bands (bands - 1) triangles. */
void stress_sphere(Model *model, double radius_m, int bands);

/* ---- matrices ----------------------------------------------------------------------------------- */

/* Adds how far a matrix is from a rotation: the worst element of R'R - I, and its handedness. */
void stress_off_rotation(double *worst, const double r[9]);

#endif
