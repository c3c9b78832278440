/* A ray through smoke, four volumes at a time and in closed forms, against the same written plainly: one volume at a
 * time, its density summed up step by step. labels: physics */
#include "tests/check.h"

#include "render/smoke/smoke.h"

static Rays      rays;
static double    far_m[hits_capacity];
static SmokeRays out;

/* ---- the pattern -------------------------------------------------------------------------- */

/* A value of -1 .. 1 at a corner of the lattice: a hash of its three whole coordinates. */
static double corner(int x, int y, int z)
{
    uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (double)(int32_t)(h ^ h >> 15) / 2147483648.0;
}

/* Between the eight corners, each weighted by a smooth step of every coordinate: 3 t^2 - 2 t^3. */
static double noise(const double p[3])
{
    double sum = 0, step[3];
    for (int k = 0; k < 3; k++) {
        const double t = p[k] - floor(p[k]);
        step[k] = 3 * t * t - 2 * t * t * t;
    }
    for (int c = 0; c < 8; c++) {
        double weight = 1;
        int    at[3];
        for (int k = 0; k < 3; k++) {
            const int high = c >> k & 1;
            at[k] = (int)floor(p[k]) + high;
            weight *= high ? step[k] : 1 - step[k];
        }
        sum += weight * corner(at[0], at[1], at[2]);
    }
    return sum;
}

/* By the rotation of 180 degrees and more that has rational entries, 0, 4/5, 3/5; -4/5, 9/25, -12/25; -3/5, -12/25,
 * 16/25. */
static void turn(double to[3], const double a[3])
{
    to[0] = (4 * a[1] + 3 * a[2]) / 5;
    to[1] = (-20 * a[0] + 9 * a[1] - 12 * a[2]) / 25;
    to[2] = (-15 * a[0] - 12 * a[1] + 16 * a[2]) / 25;
}

/* Three octaves: noise at 1.7 per ball radius; then 2.17 times as fine, folded, 0.7 and 0.4 of 0.62 - 1.9 |noise|; each
 * turned and shifted by 11.3. */
static double billows(const double p[3])
{
    double a[3], b[3];
    turn(a, p);
    for (int k = 0; k < 3; k++) a[k] *= 1.7;
    double sum = noise(a);
    for (int octave = 1; octave <= 2; octave++) {
        turn(b, a);
        for (int k = 0; k < 3; k++) a[k] = 2.17 * b[k] + 11.3;
        sum += (octave == 1 ? 0.7 : 0.4) * (0.62 - 1.9 * fabs(noise(a)));
    }
    return sum;
}

/* ---- one volume --------------------------------------------------------------------------- */

/* A vector in axes in which the spheroid is a ball of radius 1: along its axis over one half axis, the rest over the
 * other. */
static void in_ball(double to[3], const SmokeVolume *v, const double a[3])
{
    const double along = v3_dot(a, v->axis_enu);
    for (int k = 0; k < 3; k++)
        to[k] = (a[k] - along * v->axis_enu[k]) / v->across_m + along * v->axis_enu[k] / v->along_m;
}

static double density(bool even, const double o[3], const double d[3], double s)
{
    double p[3];
    v3_add_scaled(p, o, s, d);
    const double q2 = v3_dot(p, p);
    return q2 >= 1 ? 0 : even ? 1 : (1 - q2) * (1 - q2);
}

/* Simpson's rule between the two; the ends are where the density ends, or earlier. */
static double summed(bool even, const double o[3], const double d[3], double from, double to)
{
    enum { steps = 400 };
    double sum = 0;
    if (even) return fmax(to - from, 0);
    if (!(to > from)) return 0;
    for (int n = 0; n <= steps; n++)
        sum += density(even, o, d, from + (to - from) * n / steps) * (n == 0 || n == steps ? 1 : n % 2 ? 4 : 2);
    return sum * (to - from) / steps / 3;
}

/* Middle and half of the chord inside the ball; none: half is 0. */
static void chord(double *middle, double *half, const double o[3], const double d[3])
{
    const double a = v3_dot(d, d), b = v3_dot(o, d), root = b * b - a * (v3_dot(o, o) - 1);
    *middle = -b / a;
    *half = root > 0 ? sqrt(root) / a : 0;
}

typedef struct Plain {
    double column_m, sunward_m, top; /* on the ray; from its lit point to the sun; height of that point in the ball */
} Plain;

static Plain plainly(const SmokeVolume *v, const double o_enu[3], const double d_enu[3], double ends_m)
{
    static const double zenith[3] = {0, 0, 1};
    Plain               p = {0, 0, 0};
    double              off[3], o[3], d[3], middle, half, factor = 1;
    v3_sub(off, o_enu, v->p_enu);
    in_ball(o, v, off);
    in_ball(d, v, d_enu);
    chord(&middle, &half, o, d);
    if (!(half > 0) || !(middle + half > 0) || !(middle - half < ends_m)) return p;
    if (v->billow > 0) {
        /* at the closest approach: density by the noise, more so towards the rim, and at least none; and a ball smaller
         * where the noise is low */
        double nearest[3], at[3];
        v3_add_scaled(nearest, o, middle, d);
        for (int k = 0; k < 3; k++) at[k] = nearest[k] + v->pattern[k];
        const double n = billows(at), q2 = v3_dot(nearest, nearest);
        factor = (1 + 0.42 * v->billow) * fmax(1 + v->billow * n * (0.7 + 1.2 * q2), 0);
        const double smaller = 1 + 0.38 * v->billow * fmin(fmax(0.6 - n, 0), 1.6);
        for (int k = 0; k < 3; k++) o[k] *= smaller, d[k] *= smaller;
        chord(&middle, &half, o, d);
        if (!(half > 0) || !(factor > 0)) return p;
    }
    const double from = fmax(middle - half, 0), to = fmin(middle + half, ends_m);
    p.column_m = factor * summed(v->even, o, d, from, to);
    /* lit where the ray is 0.55 of its half chord before the middle, or where it begins inside */
    double lit[3], sun[3], up[3], sun_middle, sun_half;
    v3_add_scaled(lit, o, fmax(from, middle - 0.55 * half), d);
    in_ball(sun, v, v->d_sun_enu);
    in_ball(up, v, zenith);
    chord(&sun_middle, &sun_half, lit, sun);
    if (sun_half > 0)
        p.sunward_m = factor * summed(v->even, lit, sun, fmax(sun_middle - sun_half, 0), sun_middle + sun_half);
    p.top = fmin(fmax(v3_dot(lit, up) / v3_length(up), -1), 1);
    return p;
}

/* ---- the test ----------------------------------------------------------------------------- */

static double lot(uint32_t trial, int i) { return random_uniform(17, 1, trial, (uint64_t)i); }

static SmokeVolume random_volume(uint32_t trial, int i)
{
    double      u[20];
    SmokeVolume v = {0};
    for (int k = 0; k < 20; k++) u[k] = lot(trial, 20 * i + k);
    v.p_enu[0] = 5.0 * i, v.p_enu[1] = 4 * u[0], v.p_enu[2] = 60 + 10 * u[1];
    for (int k = 0; k < 3; k++) v.axis_enu[k] = u[2 + k] - 0.5, v.d_sun_enu[k] = u[5 + k] - (k == 2 ? 0 : 0.5);
    if (!v3_normalize(v.axis_enu, v.axis_enu)) v.axis_enu[0] = 1;
    if (!v3_normalize(v.d_sun_enu, v.d_sun_enu)) v.d_sun_enu[2] = 1;
    v.across_m = 1 + 3 * u[8];
    v.along_m = 1 + 6 * u[9];
    v.range_m = v.p_enu[2];
    v.even = u[10] < 0.3;
    v.billow = u[11] < 0.3 ? 0 : u[11];
    for (int k = 0; k < 3; k++) v.pattern[k] = 256 * u[12 + k] - 30;
    for (int b = 0; b < smoke_bands; b++) {
        v.extinction_per_m[b] = 0.05 * (b + 1) * u[15];
        v.source[b] = 2 + b;
        v.from_top[b] = u[16] < 0.5 ? 0 : 1 + 0.1 * b;
        for (int n = 0; n < smoke_scatter_orders; n++) v.sun[b][n] = b == 3 ? 0 : 5.0 / (n + 1) + b;
        v.sun_depth[b] = 0.3 * b * u[17];
    }
    return v;
}

/* What passes: exp(-extinction column); what is added: 1 less that, times the source: that of the middle height, half
 * the difference from top to bottom by the height, and of the sun's three orders exp(-depth), exp(-depth / 2) and
 * exp(-depth / 4). Spheroids of all shapes beside one another, from outside and within, cut off by what is behind; rays
 * that cross one of them. 3e-6: floats of 1, of 20 where added. */
static void fast_is_as_plain(void **state)
{
    (void)state;
    enum { volumes = 7, trials = 2000 };
    int compared = 0, patterned = 0, inside = 0, cut = 0, empty = 0;
    for (uint32_t trial = 0; trial < trials; trial++) {
        SmokeVolume volume[volumes];
        int         list[volumes], crossed = -1, others = 0;
        Plain       p = {0, 0, 0};
        for (int i = 0; i < volumes; i++) volume[i] = random_volume(trial, i), list[i] = i;
        const double begin_m = lot(trial, 900) < 0.3 ? 62 : 20 * lot(trial, 901);
        const double o[3] = {35 * lot(trial, 902) - 2, 6 * lot(trial, 903) - 1, begin_m};
        double       d[3] = {0.2 * (lot(trial, 904) - 0.5), 0.2 * (lot(trial, 905) - 0.5), 1};
        v3_normalize(d, d);
        far_m[0] = lot(trial, 906) < 0.3 ? 65 - begin_m : INFINITY;
        for (int i = 0; i < volumes; i++) {
            const Plain one = plainly(&volume[i], o, d, far_m[0]);
            if (one.column_m > 0) p = one, others += crossed >= 0, crossed = i;
        }
        rays.count = 1;
        for (int k = 0; k < 3; k++) rays.o_enu[k][0] = o[k], rays.d_enu[k][0] = d[k];
        smoke_trace_rays(&out, volume, list, volumes, &rays, far_m, (1u << smoke_bands) - 1);
        if (others > 0) continue;
        if (crossed < 0) {
            CHECK(!out.any);
            empty++;
            continue;
        }
        const SmokeVolume *v = &volume[crossed];
        CHECK(out.any);
        for (int b = 0; b < smoke_bands; b++) {
            const double depth = v->extinction_per_m[b] * p.sunward_m + v->sun_depth[b];
            double       source = v->source[b] + p.top * v->from_top[b];
            for (int n = 0; n < smoke_scatter_orders; n++) source += v->sun[b][n] * exp(-depth / (1 << n));
            const double passes = exp(-v->extinction_per_m[b] * p.column_m);
            CHECK_NEAR(out.transmittance[b][0], passes, 3e-6);
            CHECK_NEAR(out.added[b][0], (1 - passes) * source, 6e-5);
        }
        compared++;
        patterned += v->billow > 0, inside += begin_m > 50, cut += isfinite(far_m[0]);
    }
    print_message("%d rays of one volume, %d of them patterned, %d from within, %d cut; %d of none\n", compared,
                  patterned, inside, cut, empty);
    CHECK(compared > 600 && patterned > 400 && inside > 200 && cut > 100 && empty > 500);
}

/* A thin volume takes 1 - exp(-depth) of what is behind it and adds as much of its source: 1e-7 of itself, a float. */
static void thin_is_taken_exactly(void **state)
{
    (void)state;
    const int list[1] = {0};
    for (double depth = 1e-7; depth < 0.01; depth *= 1.07) {
        SmokeVolume v = {
            .p_enu = {0, 0, 50}, .axis_enu = {1, 0, 0}, .along_m = 2, .across_m = 2, .range_m = 50, .even = true};
        v.d_sun_enu[2] = 1;
        for (int b = 0; b < smoke_bands; b++) v.extinction_per_m[b] = depth / 4, v.source[b] = 3;
        rays.count = 1, far_m[0] = INFINITY;
        for (int k = 0; k < 3; k++) rays.o_enu[k][0] = 0, rays.d_enu[k][0] = k == 2;
        smoke_trace_rays(&out, &v, list, 1, &rays, far_m, (1u << smoke_bands) - 1);
        for (int b = 0; b < smoke_bands; b++) CHECK_NEAR(out.added[b][0] / (-3 * expm1(-depth)), 1, 1e-7);
    }
}

/* A ball of 1 m is found from 100 m to 300 km away, by a ray 0.9 m beside its centre, alone and among others in one
 * point: 2 sqrt(1 - 0.81) m of it. At 300 km rounding of squares is 1e-5 m2. */
static void the_farthest_is_found(void **state)
{
    (void)state;
    const int list[1] = {0};
    for (double far = 100; far < 3e5; far *= 1.3)
        for (int many = 1; many <= 3; many += 2) {
            SmokeVolume v = {.p_enu = {0.9, 0, far},
                             .axis_enu = {1, 0, 0},
                             .along_m = 1,
                             .across_m = 1,
                             .range_m = far,
                             .even = true};
            v.d_sun_enu[2] = 1;
            for (int b = 0; b < smoke_bands; b++) v.extinction_per_m[b] = 1;
            rays.count = many;
            for (int n = 0; n < many; n++) {
                far_m[n] = INFINITY;
                for (int k = 0; k < 3; k++) rays.o_enu[k][n] = 0, rays.d_enu[k][n] = k == 2;
            }
            smoke_trace_rays(&out, &v, list, 1, &rays, far_m, 1);
            CHECK(out.any);
            for (int n = 0; n < many; n++) CHECK_NEAR(out.transmittance[0][n], exp(-2 * sqrt(1 - 0.81)), 1e-3);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_is_as_plain),
        cmocka_unit_test(thin_is_taken_exactly),
        cmocka_unit_test(the_farthest_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
