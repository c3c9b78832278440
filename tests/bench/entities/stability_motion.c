/* tests/bench/entities/stability_motion.c: motion and attitude at their edge cases: dead reckoning from tiny to large
 * angular rates, from microseconds to hours; Euler angles straight up and down. The reference for motion is the
 * exponential of the rotation's matrix by doubling, in 113 bits where the compiler has them, independent of the closed
 * forms. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"

#include "entities/motion/articulation.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/survey/survey.h"

#ifdef __SIZEOF_FLOAT128__
typedef __float128 Wide;
#else
typedef long double Wide;
#endif

static double uniform(uint32_t stream, uint64_t index, double low, double high)
{
    return low + (high - low) * random_uniform(0xDEAD, stream, 0, index);
}

/* ---- reference ----------------------------------------------------------------------------- */

/* For a rotation over a time t, where W u = w x u: e^(Wt), its integral, and the integral of s e^(Ws). */
typedef struct Exponential {
    Wide e[9], i1[9], i2[9];
} Exponential;

static void wide_mul(Wide out[9], const Wide a[9], const Wide b[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

/* Computes them by Taylor's series over t / 2^n, where |w| t / 2^n < 1/2, and n doublings of the time: e(2h) = e e,
 * i1(2h) = i1 + e i1, i2(2h) = i2 + e (i2 + h i1). */
static void exponential(Exponential *out, const double w[3], double t_s)
{
    const Wide cross[9] = {0, -(Wide)w[2], w[1], w[2], 0, -(Wide)w[0], -(Wide)w[1], w[0], 0};
    int        doublings = 0;
    Wide       h = t_s;
    for (double x = v3_length(w) * fabs(t_s); x > 0.5 && doublings < 60; x *= 0.5, doublings++) h *= 0.5;
    Wide term[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, next[9]; /* W^n h^n / n! */
    *out = (Exponential){0};
    for (int n = 0; n < 28; n++) {
        for (int k = 0; k < 9; k++) {
            out->e[k] += term[k];
            out->i1[k] += term[k] * h / (n + 1);
            out->i2[k] += term[k] * h * h / (n + 2);
        }
        wide_mul(next, term, cross);
        for (int k = 0; k < 9; k++) term[k] = next[k] * h / (n + 1);
    }
    for (; doublings > 0; doublings--, h *= 2) {
        Wide sum[9], moved[9];
        for (int k = 0; k < 9; k++) sum[k] = out->i2[k] + h * out->i1[k];
        wide_mul(moved, out->e, sum);
        for (int k = 0; k < 9; k++) out->i2[k] += moved[k];
        wide_mul(moved, out->e, out->i1);
        for (int k = 0; k < 9; k++) out->i1[k] += moved[k];
        wide_mul(moved, out->e, out->e);
        memcpy(out->e, moved, sizeof moved);
    }
}

static Wide row_times(const Wide m[9], int row, const double v[3])
{
    return m[3 * row] * v[0] + m[3 * row + 1] * v[1] + m[3 * row + 2] * v[2];
}

typedef struct MotionErrors {
    double place, speed, turn; /* in roundings of the longest distance, of the fastest speed, of 1 */
    double place_m;
    double crooked;
} MotionErrors;

/* Allows one roundoff of each quantity that enters, and of the angle itself: 2^-53 of x radians. */
static void judge(MotionErrors *errors, const Kinematics *k, const Exponential *x, double t_s)
{
    const int    a = k->algorithm;
    const bool   body = dead_reckoning_in_body_axes(a), accelerates = a == 4 || a == 5 || a >= 8, moves = a > 1;
    const Wide   t = t_s;
    const double half_ulp = 0x1p-53, angle = v3_length(k->w_body_rps) * fabs(t_s), grain = half_ulp * (1 + angle);
    const double speed = v3_length(k->v_mps) + v3_length(k->a_mps2) * fabs(t_s),
                 reach = v3_length(k->p_ecef) + speed * fabs(t_s);
    Wide   r[9], turned[9], way[3], end[3];
    Motion got;
    dead_reckon(&got, k, t_s);
    for (int i = 0; i < 9; i++) r[i] = k->r_ecef_from_body[i];
    wide_mul(turned, r, x->e);
    for (int i = 0; i < 3; i++) {
        way[i] = body    ? row_times(x->i1, i, k->v_mps) + (accelerates ? row_times(x->i2, i, k->a_mps2) : 0)
                 : moves ? t * k->v_mps[i] + (accelerates ? t * t / 2 * k->a_mps2[i] : 0)
                         : 0;
        end[i] = moves ? k->v_mps[i] + (accelerates ? t * k->a_mps2[i] : 0) : 0;
    }
    for (int i = 0; i < 3; i++) {
        const Wide p =
            k->p_ecef[i] + (body ? r[3 * i] * way[0] + r[3 * i + 1] * way[1] + r[3 * i + 2] * way[2] : way[i]);
        const Wide v = body ? turned[3 * i] * end[0] + turned[3 * i + 1] * end[1] + turned[3 * i + 2] * end[2] : end[i];
        const double off_m = (double)(got.p_ecef[i] - p);
        bench_worse(&errors->place_m, off_m);
        if (off_m != 0) bench_worse(&errors->place, off_m / (reach * grain));
        const double off_mps = (double)(got.v_ecef_mps[i] - v);
        if (off_mps != 0) bench_worse(&errors->speed, off_mps / (speed * grain));
    }
    for (int i = 0; i < 9; i++)
        bench_worse(&errors->turn,
                    (double)(got.r_ecef_from_body[i] - (dead_reckoning_turns(a) ? turned[i] : r[i])) / grain);
    stress_off_rotation(&errors->crooked, got.r_ecef_from_body);
}

/* ---- dead reckoning ------------------------------------------------------------------------- */

typedef struct Reach {
    double least_rps, most_rps, least_s, most_s, speed_mps, acceleration_mps2;
} Reach;

static Kinematics random_motion(uint64_t at, const Reach *reach)
{
    Kinematics k = {0};
    double     axis[3];
    for (int c = 0; c < 3; c++) {
        const uint32_t s = (uint32_t)c;
        k.p_ecef[c] = at / 2 % 2 ? uniform(1 + s, at, -6.4e6, 6.4e6) : 0; /* from 0, so small distances are not
                                                                           * masked */
        k.v_mps[c] = uniform(4 + s, at, -reach->speed_mps, reach->speed_mps) / 1.74;
        k.a_mps2[c] = uniform(7 + s, at, -reach->acceleration_mps2, reach->acceleration_mps2) / 1.74;
        axis[c] = at % 4 == s ? 1 : at % 4 < 3 ? 0 : uniform(10 + s, at, -1, 1); /* about one axis, or any */
    }
    if (v3_normalize(axis, axis))
        v3_scale(k.w_body_rps,
                 at % 97 == 5 ? 0 : pow(10, uniform(13, at, log10(reach->least_rps), log10(reach->most_rps))), axis);
    r_ecef_from_body_euler(k.r_ecef_from_body, uniform(14, at, -3.2, 3.2),
                           at % 9 == 1 ? 0.5 * pi_rad : uniform(15, at, -1.6, 1.6), uniform(16, at, -3.2, 3.2));
    return k;
}

static MotionErrors motions(const Reach *reach, int count)
{
    MotionErrors errors = {0};
    for (int n = 0; n < count; n++) {
        const uint64_t at = (uint64_t)n;
        Kinematics     k = random_motion(at, reach);
        double         t_s = (n & 1 ? -1 : 1) * pow(10, uniform(17, at, log10(reach->least_s), log10(reach->most_s)));
        Exponential    x;
        /* the series and the closed form meet at |w| t = 1/2, which is tried with its neighbours */
        if (n % 7 == 3 && v3_length(k.w_body_rps) > 0) {
            const double joint_s = 0.5 / v3_length(k.w_body_rps);
            if (joint_s <= reach->most_s) t_s = n % 3 == 0 ? joint_s : nextafter(joint_s, n % 3 == 1 ? 0 : INFINITY);
        }
        exponential(&x, k.w_body_rps, t_s);
        for (k.algorithm = 1; k.algorithm <= 9; k.algorithm++) judge(&errors, &k, &x, t_s);
    }
    return errors;
}

static void dead_reckoning(Bench *bench)
{
    /* the limits of the table, and the extremes of the formulas */
    static const Reach table = {1e-12, 20, 1e-6, 132, 2e4, 1e4}, real = {1e-12, 20, 1e-3, 12, 1000, 100},
                       all = {1e-12, 60, 1e-6, 1e4, 2e4, 1e4};
    const int          count = bench_quick(bench) ? 400 : 5000;
    const char        *judge = sizeof(Wide) == 16 && (Wide)1 + (Wide)0x1p-100 != (Wide)1
                                   ? "exponential of the turn by doubling, 113 bits"
                                   : "exponential of the turn by doubling, 64 bits";
    const MotionErrors whole = motions(&all, count), believed = motions(&table, count), common = motions(&real, count);
    /* the limit allows some roundings: products, sums, and the closed form's cancellation at 1/2 rad */
    bench_stress(bench, "dead reckoning, nine algorithms, 1e-12 .. 60 rad/s, 1 us .. 1e4 s: place", whole.place, 8,
                 "roundings", judge);
    bench_stress(bench, "the same: velocity", whole.speed, 8, "roundings", judge);
    bench_stress(bench, "the same: attitude", whole.turn, 8, "roundings", judge);
    bench_stress(bench, "the same: attitude not square, unit, right-handed", fmax(whole.crooked, believed.crooked),
                 4e-15, "", "R'R = I");
    bench_stress(bench, "dead reckoning of 1 km/s, 100 m/s2, 12 s: place", common.place_m, 4e-9, "m", judge);
    /* the entity moves 8.7e7 m in 132 s, where a double steps by 1.5e-8 m */
    bench_stress(bench, "dead reckoning of all that a report may say: place", believed.place_m, 5e-8, "m", judge);
}

/* Everything at the ends of double: no crash, and static stays where it is. */
static void extremes(Bench *bench)
{
    static const double extreme[] = {0, -0.0, 5e-324, 1e-310, 2.3e-308, 1e-160, 1e-20, 1, 1e20};
    enum { extreme_count = sizeof extreme / sizeof *extreme };
    double bad = 0;
    for (int n = 0; n < 9 * 9 * 9 * 9; n++) {
        Kinematics k = {.algorithm = 1 + n % 9, .p_ecef = {6378137, 0, 0}};
        Motion     m;
        m3_identity(k.r_ecef_from_body);
        for (int c = 0; c < 3; c++) {
            k.v_mps[c] = extreme[n / 9 % extreme_count];
            k.a_mps2[c] = extreme[n / 81 % extreme_count];
            k.w_body_rps[c] = fmin(extreme[n / 729 % extreme_count], 60) / 1.74;
        }
        for (int s = 0; s < 4; s++) {
            dead_reckon(&m, &k, (double[4]){0, 1e-310, 12, -132}[s]);
            double crooked = 0;
            stress_off_rotation(&crooked, m.r_ecef_from_body);
            bad += !v3_is_finite(m.p_ecef) || !v3_is_finite(m.v_ecef_mps) || !(crooked <= 1e-14);
            if (s == 0) bad += m.p_ecef[0] != 6378137 || m.p_ecef[1] != 0 || m.p_ecef[2] != 0;
        }
    }
    bench_stress(bench, "dead reckoning of denormals and 1e20 m/s: not finite, or moved in no time", bad, 0, "motions",
                 "its start");
}

/* Rotates a body in many small steps, each from the result of the last. */
static void drift(Bench *bench)
{
    const int   steps = bench_quick(bench) ? 20000 : 1000000;
    Kinematics  k = {.algorithm = 4, .w_body_rps = {0.3, -0.4, 0.5}};
    Motion      m;
    double      crooked = 0, off = 0;
    Exponential x;
    r_ecef_from_body_euler(k.r_ecef_from_body, 0.4, 1.3, -1.1);
    Wide start[9], want[9];
    for (int i = 0; i < 9; i++) start[i] = k.r_ecef_from_body[i];
    for (int n = 0; n < steps; n++) {
        dead_reckon(&m, &k, 0.015625);
        memcpy(k.r_ecef_from_body, m.r_ecef_from_body, sizeof m.r_ecef_from_body);
    }
    exponential(&x, k.w_body_rps, 0.015625 * steps);
    wide_mul(want, start, x.e);
    stress_off_rotation(&crooked, k.r_ecef_from_body);
    for (int i = 0; i < 9; i++) bench_worse(&off, (double)(k.r_ecef_from_body[i] - want[i]));
    /* half a rounding a step if all were of one sign */
    bench_stress(bench, "attitude handed from turn to turn, 64 a second: not square or unit by", crooked,
                 steps * 0x1p-53, "", "R'R = I");
    bench_stress(bench, "the same: from where one long turn leads", off, 2 * steps * 0x1p-53, "rad",
                 "one turn, 113 bits");
}

/* ---- Euler angles --------------------------------------------------------------------------- */

/* The angle of a' b. */
static double apart_rad(const double a[9], const double b[9])
{
    double sum = 0;
    for (int i = 0; i < 9; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return 2 * asin(fmin(1, sqrt(sum / 8)));
}

static void euler(Bench *bench)
{
    static const double angle[] = {0,
                                   -0.0,
                                   1e-310,
                                   1e-20,
                                   1e-8,
                                   0.5,
                                   1.5707963267948966,
                                   -1.5707963267948966,
                                   1.5707,
                                   -1.5707,
                                   1.57079637050628662109375 /* of float: past it */,
                                   1.57079625129699707,
                                   3.1415926535897931,
                                   -3.1415926535897931,
                                   3.14159274101257324,
                                   6.2831853071795862,
                                   -6.2831853071795862,
                                   100};
    enum { angles = sizeof angle / sizeof *angle, specials = angles * angles * angles };
    double    off_rad = 0, wire_rad = 0, crooked = 0, range = 0, want_off = 0;
    const int count = specials * 3 + (bench_quick(bench) ? 20000 : 1000000);
    for (int n = 0; n < count; n++) {
        double e[3], back[3], r[9], again[9];
        for (int c = 0; c < 3; c++) {
            const int    which = n % specials / (c == 0 ? 1 : c == 1 ? angles : angles * angles) % angles;
            const double special = angle[which];
            e[c] = n >= 3 * specials ? uniform(20 + (uint32_t)c, (uint64_t)n, -7, 7)
                   : n < specials    ? special
                                     : nextafter(special, n < 2 * specials ? 10 : -10);
            /* also angles close to straight up, from either side */
            if (n >= 3 * specials && c == 1 && n % 2)
                e[c] = copysign(0.5 * pi_rad, e[c]) + pow(10, uniform(23, (uint64_t)n, -17, -1)) * (n % 4 - 2);
        }
        r_ecef_from_body_euler(r, e[0], e[1], e[2]);
        stress_off_rotation(&crooked, r);
        /* Computes Rz(psi) Ry(theta) Rx(phi) as three products. */
        long double sine[3], cosine[3];
        for (int c = 0; c < 3; c++) sine[c] = sinl(e[c]), cosine[c] = cosl(e[c]);
        const long double z[9] = {cosine[0], -sine[0], 0, sine[0], cosine[0], 0, 0, 0, 1};
        const long double y[9] = {cosine[1], 0, sine[1], 0, 1, 0, -sine[1], 0, cosine[1]};
        const long double x[9] = {1, 0, 0, 0, cosine[2], -sine[2], 0, sine[2], cosine[2]};
        for (int i = 0; i < 9; i++) {
            long double want = 0;
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++) want += z[3 * (i / 3) + a] * y[3 * a + b] * x[3 * b + i % 3];
            bench_worse(&want_off, (double)(r[i] - want));
        }
        /* turned about some axis and back: what roundings leave, straight up too, where psi alone is noise */
        Kinematics turn = {.algorithm = 3, .w_body_rps = {0.3 + n % 7, -0.4, 0.5}};
        Motion     turned, home;
        memcpy(turn.r_ecef_from_body, r, sizeof r);
        dead_reckon(&turned, &turn, 1);
        memcpy(turn.r_ecef_from_body, turned.r_ecef_from_body, sizeof r);
        dead_reckon(&home, &turn, -1);
        memcpy(r, home.r_ecef_from_body, sizeof r);
        euler_from_r_ecef_from_body(&back[0], &back[1], &back[2], r);
        range += !(back[0] > -pi_rad && back[0] <= pi_rad && fabs(back[1]) <= 0.5 * pi_rad && back[2] > -pi_rad &&
                   back[2] <= pi_rad);
        r_ecef_from_body_euler(again, back[0], back[1], back[2]);
        bench_worse(&off_rad, apart_rad(r, again));
        r_ecef_from_body_euler(again, (float)back[0], (float)back[1], (float)back[2]);
        bench_worse(&wire_rad, apart_rad(r, again));
    }
    bench_stress(bench, "psi, theta, phi to a rotation, at +-90 degrees and about", want_off, 1e-15, "",
                 "three turns, long double");
    bench_stress(bench, "the same: not square, unit, right-handed", crooked, 1e-15, "", "R'R = I");
    bench_stress(bench, "a rotation to psi, theta, phi and back", off_rad, 2e-15, "rad", "itself");
    bench_stress(bench, "the same through the floats of a PDU", wire_rad, 3e-7, "rad",
                 "itself; half an ulp of pi is 1.2e-7, twice");
    bench_stress(bench, "angles out of their range", range, 0, "angles", "(-pi, pi], theta within pi / 2");
}

/* ---- a recorded track ------------------------------------------------------------------------- */

/* Takes a time between two reports: a turn of 0 .. pi about any axis, and half of it. */
static void tracks(Bench *bench)
{
    const int count = bench_quick(bench) ? 5000 : 300000;
    double    crooked = 0, half_rad = 0, place = 0;
    for (int n = 0; n < count; n++) {
        const uint64_t at = (uint64_t)n;
        const double   turn_rad = n % 5 == 0   ? pi_rad - pow(10, uniform(30, at, -16, -2))
                                  : n % 5 == 1 ? pow(10, uniform(30, at, -18, -1))
                                               : uniform(30, at, 0, pi_rad - 0.01);
        const double   h_s = pow(10, uniform(31, at, -9, 4));
        Kinematics     k = {.algorithm = 3, .p_ecef = {6378137, 0, 0}};
        Motion         whole, half;
        double         axis[3] = {uniform(32, at, -1, 1), uniform(33, at, -1, 1), uniform(34, at, -1, 1)};
        TrackPoint     point[2] = {{.t_s = 1000}, {.t_s = 1000 + h_s}};
        Track          track = {.count = 2, .point = point};
        TrackPose      pose;
        if (!v3_normalize(axis, axis) || !(point[1].t_s > point[0].t_s)) continue;
        r_ecef_from_body_euler(k.r_ecef_from_body, uniform(35, at, -3, 3), uniform(36, at, -1.5, 1.5),
                               uniform(37, at, -3, 3));
        v3_scale(k.w_body_rps, turn_rad, axis);
        dead_reckon(&whole, &k, 1);
        dead_reckon(&half, &k, 0.5);
        for (int p = 0; p < 2; p++) memcpy(point[p].p_ecef, p ? whole.p_ecef : k.p_ecef, sizeof k.p_ecef);
        const double middle_s = 0.5 * (point[0].t_s + point[1].t_s);
        survey_track_at(&pose, &track, middle_s);
        /* a report has its attitude in floats: the turn is that of doubles */
        survey_turn(pose.r_ecef_from_body, k.r_ecef_from_body, whole.r_ecef_from_body,
                    (middle_s - point[0].t_s) / (point[1].t_s - point[0].t_s));
        stress_off_rotation(&crooked, pose.r_ecef_from_body);
        bench_worse(&place, pose.p_ecef[0] - 6378137);
        bench_worse(&place, v3_length(pose.v_ecef_mps));
        /* the instant itself is a double: half a step of 1000 s of h_s; and at pi either way round is short */
        const double instant = 1.2e-13 / h_s * turn_rad, to_pi = pi_rad - turn_rad;
        if (to_pi > 1e-14)
            bench_worse(&half_rad,
                        fmax(apart_rad(pose.r_ecef_from_body, half.r_ecef_from_body) - instant, 0) * fmin(1, to_pi));
    }
    bench_stress(bench, "a track between reports, turns of 0 .. pi: not square or unit", crooked, 4e-15, "", "R'R = I");
    bench_stress(bench, "the same: half way, times the rest to pi", half_rad, 1e-14, "rad", "half of the turn");
    bench_stress(bench, "the same: a stand that moves", place, 0, "m", "its two reports");
}

/* ---- joints --------------------------------------------------------------------------------- */

/* Angles of any size that a float has: brought to -pi .. pi. */
static void joints(Bench *bench)
{
    static const float value[] = {0,   -0.0f, 1e-45f, -1e-45f, 1,      3.14159274f, -3.14159274f,  9.42477f,
                                  350, -1e4f, 1e7f,   1e9f,    -1e15f, 1e30f,       3.4028235e38f, -3.4028235e38f};
    static const float rate[] = {0, 1e-45f, -100, 100, 12.5f};
    double             beyond = 0, off_rad = 0;
    for (size_t v = 0; v < sizeof value / sizeof *value; v++)
        for (size_t r = 0; r < sizeof rate / sizeof *rate; r++)
            for (int t = 0; t < 4; t++) {
                const double               later_s = (double[4]){0, 1e-9, 12, 132}[t];
                const DisVariableParameter record[2] = {{.parameter = 4096 + 12, .value = rate[r]},
                                                        {.parameter = 4096 + 11, .value = value[v]}};
                Articulation               joint = {0};
                double                     got = NAN;
                articulation_report(&joint, record, 2, 100, 132);
                if (!articulation_value(&got, &joint, 4096, 11, 100 + later_s, 132)) got = NAN;
                bench_worse(&beyond, fmax(fabs(got) - pi_rad, 0));
                /* later_s as the sum above has it */
                const long double angle = value[v] + (long double)rate[r] * (100 + later_s - 100);
                if (fabsl(angle) > 1e6L) continue; /* a float's step is the better part of a turn */
                const double off = (double)remainderl(got - angle, 6.283185307179586476925286766559L);
                bench_worse(&off_rad, off);
            }
    bench_stress(bench, "turrets at any angle that a float has: beyond -pi .. pi by", beyond, 1e-9, "rad",
                 "the half turn");
    bench_stress(bench, "the same up to 1e6 rad: off the angle", off_rad, 1e-9, "rad", "remainder, long double");
}

Status bench_stability_motion(Bench *bench)
{
    bench_progress(bench, "dead reckoning");
    dead_reckoning(bench);
    extremes(bench);
    drift(bench);
    euler(bench);
    tracks(bench);
    joints(bench);
    Status status = bench_stability_pdus(bench);
    if (status == STATUS_OK) status = bench_stability_text(bench);
    if (status == STATUS_OK) status = bench_stability_models(bench);
    return status;
}
