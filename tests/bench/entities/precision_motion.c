/* tests/bench/entities/precision_motion.c: where a body is after its report, and how warm. */
#include "tests/bench/suites.h"

#include "entities/motion/dead_reckoning.h"
#include "tests/bench/bench.h"

/* ---- dead reckoning ------------------------------------------------------------------------------- */

enum { bodies = 512 };

typedef struct ReckonSet {
    double     below_rad2; /* NaN: Euler's steps of 10 ms */
    Kinematics from[bodies];
    double     dt_s[bodies], p_ecef[bodies][3];
} ReckonSet;

/* Turns from nothing at all to a quarter circle: 1e-9 .. 1.6 rad, accelerating in body axes. */
static void make_bodies(ReckonSet *s)
{
    for (int i = 0; i < bodies; i++) {
        Kinematics *k = &s->from[i];
        *k = (Kinematics){.algorithm = 8};
        s->dt_s[i] = 5;
        const double rate_rps = pow(10, -9 + 9.2 * random_uniform(51, 0, 0, (uint64_t)i)) / s->dt_s[i];
        double       axis[3];
        for (int c = 0; c < 3; c++) {
            axis[c] = random_uniform(51, 1 + (uint32_t)c, 0, (uint64_t)i) - 0.5;
            k->v_mps[c] = 200 * (random_uniform(51, 4 + (uint32_t)c, 0, (uint64_t)i) - 0.5);
            k->a_mps2[c] = 40 * (random_uniform(51, 7 + (uint32_t)c, 0, (uint64_t)i) - 0.5);
        }
        v3_normalize(axis, axis);
        v3_scale(k->w_body_rps, rate_rps, axis);
        r_ecef_from_body_euler(k->r_ecef_from_body, 0.3 * i, 0.1, 0.2 * i);
    }
}

/* R' = R [w] by small steps, as a simple receiver would. */
static void step_body(double p[3], const Kinematics *k, double dt_s)
{
    enum { steps = 500 };
    const double h_s = dt_s / steps, *w = k->w_body_rps;
    const double cross[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};
    double       r[9], v[3], v_ecef[3];
    memcpy(r, k->r_ecef_from_body, sizeof r);
    memcpy(p, k->p_ecef, 3 * sizeof *p);
    for (int n = 0; n < steps; n++) {
        double slope[9];
        v3_add_scaled(v, k->v_mps, n * h_s, k->a_mps2);
        m3_mul_v3(v_ecef, r, v);
        v3_add_scaled(p, p, h_s, v_ecef);
        m3_mul(slope, r, cross);
        for (int i = 0; i < 9; i++) r[i] += h_s * slope[i];
    }
}

static void reckon_all(void *user)
{
    ReckonSet *s = user;
    for (int i = 0; i < bodies; i++) {
        Motion motion;
        if (isnan(s->below_rad2)) {
            step_body(s->p_ecef[i], &s->from[i], s->dt_s[i]);
            continue;
        }
        dead_reckon_series(&motion, &s->from[i], s->dt_s[i], s->below_rad2);
        memcpy(s->p_ecef[i], motion.p_ecef, sizeof s->p_ecef[i]);
    }
    bench_keep(s->p_ecef);
}

/* R0 times the integral of exp([w] t) (v + a t), the exponential as its own series in long double: no closed form, no
 * cancellation; at 1.6 rad 30 terms are 1e-27. */
static void body_exactly(long double p[3], const Kinematics *k, double dt_s)
{
    long double term_v[3], term_a[3], sum[3], t = (long double)dt_s;
    for (int c = 0; c < 3; c++) {
        term_v[c] = (long double)k->v_mps[c] * t;
        term_a[c] = (long double)k->a_mps2[c] * t * t;
        sum[c] = term_v[c] + term_a[c] / 2;
    }
    for (int n = 1; n < 40; n++) { /* [w]^n t^(n + 1) / (n + 1)! v + [w]^n t^(n + 2) / (n! (n + 2)) a */
        for (int part = 0; part < 2; part++) {
            long double  *u = part ? term_a : term_v, next[3];
            const double *w = k->w_body_rps;
            for (int c = 0; c < 3; c++)
                next[c] = (long double)w[(c + 1) % 3] * u[(c + 2) % 3] - (long double)w[(c + 2) % 3] * u[(c + 1) % 3];
            for (int c = 0; c < 3; c++) u[c] = next[c] * t / (part ? n : n + 1);
        }
        for (int c = 0; c < 3; c++) sum[c] += term_v[c] + term_a[c] / (n + 2);
    }
    for (int c = 0; c < 3; c++) {
        p[c] = (long double)k->p_ecef[c];
        for (int m = 0; m < 3; m++) p[c] += (long double)k->r_ecef_from_body[3 * c + m] * sum[m];
    }
}

static void tunable_reckoning(Bench *bench)
{
    enum { settings = 7 };
    static const char *const name[settings] = {
        "Euler's steps of 10 ms", "closed forms alone", "series below 0.01 rad", "series below 0.1 rad",
        "series below 0.5 rad",   "series below 1 rad", "series below 2 rad"};
    static const double below_rad[settings] = {NAN, 0, 0.01, 0.1, 0.5, 1, 2};
    static ReckonSet    set[settings];
    BenchWork           work[settings];
    BenchSetting        point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        set[k].below_rad2 = below_rad[k] * below_rad[k];
        make_bodies(&set[k]);
        reckon_all(&set[k]);
        for (int i = 0; i < bodies; i++) {
            long double want[3], square = 0;
            body_exactly(want, &set[k].from[i], set[k].dt_s[i]);
            for (int c = 0; c < 3; c++) square += (set[k].p_ecef[i][c] - want[c]) * (set[k].p_ecef[i][c] - want[c]);
            bench_worst(&point[k].error, (double)sqrtl(square));
        }
        work[k] = (BenchWork){reckon_all, &set[k], bodies};
        point[k].setting = name[k];
        point[k].is_default = k == 4;
    }
    bench_tunable(bench,
                  &(BenchTunable){"dead reckoning", "entities/motion/dead_reckoning.c", "a turning body, 5 s later",
                                  "m", "largest, about the body; long double", 1e-11},
                  work, point, settings);
}

Status bench_precision_motion(Bench *bench)
{
    tunable_reckoning(bench);
    return STATUS_OK;
}
