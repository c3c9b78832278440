/* entities/flight/miss.c: closest approach, fuze and plane by roots of the cubic of one step. */
#include "entities/flight/miss.h"

/* Hermite's cubic of a leg at u = 0 .. 1, and its derivative by u. */
static void cubic(double p[3], double dp[3], const MissLeg *leg, double step_s, double u)
{
    const double u2 = u * u, u3 = u2 * u;
    const double h0 = 2 * u3 - 3 * u2 + 1, h1 = u3 - 2 * u2 + u, h3 = u3 - u2;
    const double d0 = 6 * u2 - 6 * u, d1 = 3 * u2 - 4 * u + 1, d3 = 3 * u2 - 2 * u;
    for (int k = 0; k < 3; k++) {
        const double gone_m = leg->p1_ecef[k] - leg->p0_ecef[k]; /* about the first end: no cancellation at ECEF size */
        const double v0 = step_s * leg->v0_ecef_mps[k], v1 = step_s * leg->v1_ecef_mps[k];
        p[k] = leg->p0_ecef[k] + (1 - h0) * gone_m + h1 * v0 + h3 * v1;
        dp[k] = -d0 * gone_m + d1 * v0 + d3 * v1;
    }
}

/* From the target to the missile, as a leg of its own. */
static void between(MissLeg *out, const MissLeg *missile, const MissLeg *target)
{
    v3_sub(out->p0_ecef, missile->p0_ecef, target->p0_ecef);
    v3_sub(out->v0_ecef_mps, missile->v0_ecef_mps, target->v0_ecef_mps);
    v3_sub(out->p1_ecef, missile->p1_ecef, target->p1_ecef);
    v3_sub(out->v1_ecef_mps, missile->v1_ecef_mps, target->v1_ecef_mps);
}

typedef struct Function {
    const MissLeg *leg;
    double         step_s, fuze_m;
    const double  *on_ecef, *normal_ecef;
} Function;

static double range_rate(const Function *f, double u) /* half the derivative of the squared range, by u */
{
    double p[3], dp[3];
    cubic(p, dp, f->leg, f->step_s, u);
    return v3_dot(p, dp);
}

static double within(const Function *f, double u)
{
    double p[3], dp[3];
    cubic(p, dp, f->leg, f->step_s, u);
    return v3_length(p) - f->fuze_m;
}

static double above(const Function *f, double u)
{
    double p[3], dp[3];
    cubic(p, dp, f->leg, f->step_s, u);
    v3_sub(p, p, f->on_ecef);
    return v3_dot(p, f->normal_ecef);
}

/* The root of a function between a and b, at which its signs differ, by bisection to the last bits. */
static double root(double (*of)(const Function *, double), const Function *f, double a, double b)
{
    const bool up = of(f, a) < 0;
    for (int i = 0; i < 60 && b - a > 1e-15; i++) {
        const double middle = 0.5 * (a + b);
        if ((of(f, middle) < 0) == up) a = middle;
        else b = middle;
    }
    return 0.5 * (a + b);
}

/* A step is looked at in so many parts, so that it may hold more than one turn. */
enum { looks = 4 };

void miss_step(Miss *miss, double t_s, double step_s, const MissLeg *missile, const MissLeg *target, double fuze_m)
{
    MissLeg        leg;
    double         p[3], dp[3];
    const Function f = {.leg = &leg, .step_s = step_s, .fuze_m = fuze_m};
    between(&leg, missile, target);
    double       nearest = 0, least_m = v3_length(leg.p0_ecef);
    const double last_m = v3_length(leg.p1_ecef);
    if (last_m < least_m) nearest = 1, least_m = last_m;
    for (int i = 0; i < looks; i++) {
        const double a = (double)i / looks, b = (double)(i + 1) / looks;
        if (!(range_rate(&f, a) < 0 && range_rate(&f, b) >= 0)) continue;
        const double u = root(range_rate, &f, a, b);
        cubic(p, dp, &leg, step_s, u);
        if (v3_length(p) < least_m) nearest = u, least_m = v3_length(p);
    }
    if (!miss->fuzed && fuze_m > 0 && least_m <= fuze_m) {
        const double u = within(&f, 0) <= 0 ? 0 : nearest > 0 ? root(within, &f, 0, nearest) : 0;
        cubic(miss->fuze_away_ecef, dp, &leg, step_s, u);
        miss->fuzed = true;
        miss->fuze_t_s = t_s + u * step_s;
    }
    if (!(least_m < miss->least_m)) return;
    miss->least_m = least_m;
    miss->t_s = t_s + nearest * step_s;
    cubic(miss->away_ecef, dp, &leg, step_s, nearest);
}

bool plane_crossing(double *after_s, double p_ecef[3], double step_s, const MissLeg *leg, const double on_ecef[3],
                    const double normal_ecef[3])
{
    const Function f = {.leg = leg, .step_s = step_s, .on_ecef = on_ecef, .normal_ecef = normal_ecef};
    double         dp[3], u = 0;
    if (!(above(&f, 0) < 0)) {
        if (!(above(&f, 1) < 0)) return false;
        u = root(above, &f, 0, 1);
    }
    cubic(p_ecef, dp, leg, step_s, u);
    *after_s = u * step_s;
    return true;
}
