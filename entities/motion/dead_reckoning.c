/* entities/motion/dead_reckoning.c: pose of a body dt after its report, by the nine algorithms.
 *
 * Source: IEEE 1278.1 Annex E. With w the body rates, x = |w| t, W v = w x v and R0 the world -> body rotation:
 *
 *   attitude      R(t) = D R0,  D = cos x I + (1 - cos x)/w^2 w w' - sin x / w W        algorithms 3, 4, 7, 8
 *   world axes    p = p0 + v t (2, 3),  p = p0 + v t + a t^2 / 2 (4, 5)
 *   body axes     p = p0 + R0' (I1 v + I2 a),  I1 = int D' dt,  I2 = int t D' dt        algorithms 6 .. 9
 *
 * `a` of the body algorithms is dv_body/dt, what an accelerometer-free sender differentiates: 0 on a steady
 * circle, not A + w x v. Algorithms 6 and 7 leave it out. 6 and 9 hold the attitude that is shown, while their
 * path still turns with w, as the standard's formula does.
 *
 * The textbook coefficients such as (x - sin x)/w^3 lose everything as w -> 0 (82 m at 1e-8 rad/s for 100 m/s^2
 * and 5 s). Here each is a power of t times an even function of x: a series below x = 0.5, the closed form above.
 * Error against wider arithmetic: tests/entities/test_dead_reckoning.c. */
#include "entities/motion/dead_reckoning.h"

/* t-scaled even functions of x. Turn: the three of D. Path: those of I1 and I2 that D does not have. */
typedef struct Turn {
    double cos_x;   /* cos x */
    double sin_w;   /* sin x / w */
    double vers_w2; /* (1 - cos x) / w^2 */
    double c1;      /* (x - sin x) / w^3 */
    double d1;      /* (x^2/2 - cos x - x sin x + 1) / w^4 */
    double d2;      /* (cos x + x sin x - 1) / w^2 */
    double d3;      /* (sin x - x cos x) / w^3 */
} Turn;

static const double series_below_x2 = 0.25;

/* Everything about one body that the formulas need; as locals of one loop turn they become registers. */
typedef struct Body {
    double p[3], v[3], a[3], w[3], r[9];
} Body;

#define ALWAYS_INLINE static inline __attribute__((always_inline))
/* Put before a loop with outputs that do not overlap its inputs. */
#ifdef __clang__
#define LANES_ARE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define LANES_ARE_INDEPENDENT _Pragma("GCC ivdep")
#endif

/* Eight terms: at x^2 = 1/4 the ninth is below 1e-19 of the sum. */
ALWAYS_INLINE Turn turn_series(double x2, double t)
{
    Turn         turn;
    const double t2 = t * t;

    turn.cos_x =
        1 - x2 * (1.0 / 2 -
                  x2 * (1.0 / 24 - x2 * (1.0 / 720 - x2 * (1.0 / 40320 -
                                                           x2 * (1.0 / 3628800 - x2 * (1.0 / 479001600 -
                                                                                       x2 * (1.0 / 87178291200.0)))))));
    turn.sin_w =
        t * (1 - x2 * (1.0 / 6 -
                       x2 * (1.0 / 120 -
                             x2 * (1.0 / 5040 - x2 * (1.0 / 362880 -
                                                      x2 * (1.0 / 39916800 - x2 * (1.0 / 6227020800.0 -
                                                                                   x2 * (1.0 / 1307674368000.0))))))));
    turn.vers_w2 =
        t2 * (1.0 / 2 -
              x2 * (1.0 / 24 -
                    x2 * (1.0 / 720 -
                          x2 * (1.0 / 40320 - x2 * (1.0 / 3628800 -
                                                    x2 * (1.0 / 479001600 - x2 * (1.0 / 87178291200.0 -
                                                                                  x2 * (1.0 / 20922789888000.0))))))));
    turn.c1 =
        t2 * t *
        (1.0 / 6 -
         x2 * (1.0 / 120 -
               x2 * (1.0 / 5040 -
                     x2 * (1.0 / 362880 - x2 * (1.0 / 39916800 -
                                                x2 * (1.0 / 6227020800.0 - x2 * (1.0 / 1307674368000.0 -
                                                                                 x2 * (1.0 / 355687428096000.0))))))));
    /* sum (-1)^k (2k+3)/(2k+4)! x^2k, and likewise below */
    turn.d1 =
        t2 * t2 *
        (3.0 / 24 -
         x2 * (5.0 / 720 -
               x2 * (7.0 / 40320 -
                     x2 * (9.0 / 3628800 - x2 * (11.0 / 479001600 - x2 * (13.0 / 87178291200.0 -
                                                                          x2 * (15.0 / 20922789888000.0 -
                                                                                x2 * (17.0 / 6402373705728000.0))))))));
    turn.d2 =
        t2 * (1.0 / 2 -
              x2 * (3.0 / 24 -
                    x2 * (5.0 / 720 -
                          x2 * (7.0 / 40320 - x2 * (9.0 / 3628800 - x2 * (11.0 / 479001600 -
                                                                          x2 * (13.0 / 87178291200.0 -
                                                                                x2 * (15.0 / 20922789888000.0))))))));
    turn.d3 =
        t2 * t *
        (2.0 / 6 -
         x2 * (4.0 / 120 -
               x2 * (6.0 / 5040 -
                     x2 * (8.0 / 362880 - x2 * (10.0 / 39916800 - x2 * (12.0 / 6227020800.0 -
                                                                        x2 * (14.0 / 1307674368000.0 -
                                                                              x2 * (16.0 / 355687428096000.0))))))));
    return turn;
}

/* For x2 >= series_below_x2: the worst cancellation is d1's at x = 0.5, 130 roundings of a term that is itself
 * 3 % of the displacement by acceleration. */
static Turn turn_closed(double x2, double t)
{
    Turn         turn;
    const double x = sqrt(x2), sin_x = sin(x), cos_x = cos(x), t2 = t * t;

    turn.cos_x = cos_x;
    turn.sin_w = t * (sin_x / x);
    turn.vers_w2 = t2 * ((1 - cos_x) / x2);
    turn.c1 = t2 * t * ((x - sin_x) / (x2 * x));
    turn.d1 = t2 * t2 * ((0.5 * x2 - cos_x - x * sin_x + 1) / (x2 * x2));
    turn.d2 = t2 * ((cos_x + x * sin_x - 1) / x2);
    turn.d3 = t2 * t * ((sin_x - x * cos_x) / (x2 * x));
    return turn;
}

ALWAYS_INLINE double turn_angle_squared(const double w[3], double t)
{
    const double x = w[0] * t, y = w[1] * t, z = w[2] * t;
    return x * x + y * y + z * z;
}

/* out = (alpha w w' + beta I + gamma W) u, with W u = w x u */
ALWAYS_INLINE void apply_turn(double out[3], double alpha, double beta, double gamma, const double w[3],
                              const double u[3])
{
    const double along = alpha * (w[0] * u[0] + w[1] * u[1] + w[2] * u[2]);
    out[0] = along * w[0] + beta * u[0] + gamma * (w[1] * u[2] - w[2] * u[1]);
    out[1] = along * w[1] + beta * u[1] + gamma * (w[2] * u[0] - w[0] * u[2]);
    out[2] = along * w[2] + beta * u[2] + gamma * (w[0] * u[1] - w[1] * u[0]);
}

ALWAYS_INLINE void world_from_body(double out[3], const double r[9], const double u[3])
{
    out[0] = r[0] * u[0] + r[1] * u[1] + r[2] * u[2];
    out[1] = r[3] * u[0] + r[4] * u[1] + r[5] * u[2];
    out[2] = r[6] * u[0] + r[7] * u[1] + r[8] * u[2];
}

/* r_ecef_from_body(t) = R0' D': every row u of R0' becomes D u, since (R0' D')_row = D row. */
ALWAYS_INLINE void turn_attitude(double out[9], const Turn *turn, const double w[3], const double r[9])
{
    for (int row = 0; row < 3; row++)
        apply_turn(out + 3 * row, turn->vers_w2, turn->cos_x, -turn->sin_w, w, r + 3 * row);
}

ALWAYS_INLINE void path_static(Body *out, const Body *in)
{
    for (int i = 0; i < 3; i++) {
        out->p[i] = in->p[i];
        out->v[i] = 0;
    }
}

ALWAYS_INLINE void path_world(Body *out, const Body *in, double t, bool accelerates)
{
    for (int i = 0; i < 3; i++) {
        const double a = accelerates ? in->a[i] : 0;
        out->p[i] = in->p[i] + t * (in->v[i] + 0.5 * t * a);
        out->v[i] = in->v[i] + t * a;
    }
}

ALWAYS_INLINE void path_body(Body *out, const Body *in, const Turn *turn, double t, bool accelerates)
{
    double by_v[3], by_a[3], moved[3], v_end[3], v_turned[3], step[3];

    apply_turn(by_v, turn->c1, turn->sin_w, turn->vers_w2, in->w, in->v);
    apply_turn(by_a, turn->d1, turn->d2, turn->d3, in->w, in->a);
    for (int i = 0; i < 3; i++) {
        moved[i] = accelerates ? by_v[i] + by_a[i] : by_v[i];
        v_end[i] = accelerates ? in->v[i] + t * in->a[i] : in->v[i];
    }
    /* into the axes of the report: D' v */
    apply_turn(v_turned, turn->vers_w2, turn->cos_x, turn->sin_w, in->w, v_end);
    world_from_body(step, in->r, moved);
    world_from_body(out->v, in->r, v_turned);
    for (int i = 0; i < 3; i++) out->p[i] = in->p[i] + step[i];
}

/* One loop turn. `algorithm` is a literal where it matters, so no branch is left inside the loop. */
ALWAYS_INLINE void reckon(Body *out, int algorithm, const Body *in, const Turn *turn, double t)
{
    if (algorithm == 2 || algorithm == 3) path_world(out, in, t, false);
    else if (algorithm == 4 || algorithm == 5) path_world(out, in, t, true);
    else if (algorithm == 6 || algorithm == 7) path_body(out, in, turn, t, false);
    else if (algorithm == 8 || algorithm == 9) path_body(out, in, turn, t, true);
    else path_static(out, in);

    if (algorithm == 3 || algorithm == 4 || algorithm == 7 || algorithm == 8) turn_attitude(out->r, turn, in->w, in->r);
    else
        for (int i = 0; i < 9; i++) out->r[i] = in->r[i];
}

bool dead_reckoning_turns(int algorithm)
{
    return algorithm == 3 || algorithm == 4 || algorithm == 7 || algorithm == 8;
}

bool dead_reckoning_in_body_axes(int algorithm) { return algorithm >= 6 && algorithm <= 9; }

void dead_reckon(Motion *out, const Kinematics *k, double dt_s) { dead_reckon_series(out, k, dt_s, series_below_x2); }

void dead_reckon_series(Motion *out, const Kinematics *k, double dt_s, double below_rad2)
{
    Body in, end;
    memcpy(in.p, k->p_ecef, sizeof in.p);
    memcpy(in.v, k->v_mps, sizeof in.v);
    memcpy(in.a, k->a_mps2, sizeof in.a);
    memcpy(in.w, k->w_body_rps, sizeof in.w);
    memcpy(in.r, k->r_ecef_from_body, sizeof in.r);

    const double x2 = turn_angle_squared(in.w, dt_s);
    const Turn   turn = x2 < below_rad2 ? turn_series(x2, dt_s) : turn_closed(x2, dt_s);

    reckon(&end, k->algorithm, &in, &turn, dt_s);
    memcpy(out->p_ecef, end.p, sizeof end.p);
    memcpy(out->v_ecef_mps, end.v, sizeof end.v);
    memcpy(out->w_body_rps, in.w, sizeof in.w);
    memcpy(out->r_ecef_from_body, end.r, sizeof end.r);
}

/* ---- many at once ------------------------------------------------------------------------- */

/* Coefficients are made a block at a time, so that they stay in the nearest cache. */
enum { block_count = 128 };

typedef struct TurnBlock {
    double cos_x[block_count], sin_w[block_count], vers_w2[block_count], c1[block_count];
    double d1[block_count], d2[block_count], d3[block_count];
} TurnBlock;

static void store_turn(TurnBlock *block, int i, Turn turn)
{
    block->cos_x[i] = turn.cos_x;
    block->sin_w[i] = turn.sin_w;
    block->vers_w2[i] = turn.vers_w2;
    block->c1[i] = turn.c1;
    block->d1[i] = turn.d1;
    block->d2[i] = turn.d2;
    block->d3[i] = turn.d3;
}

/* The series for all entities (it vectorizes; where it does not converge its value is replaced), then the few with high
 * angular rates one by one. */
static void turn_block(TurnBlock *block, const KinematicsArrays *k, int first, int count)
{
    const double *wx = k->w_body_rps[0] + first, *wy = k->w_body_rps[1] + first, *wz = k->w_body_rps[2] + first;
    const double *t = k->dt_s + first;

    LANES_ARE_INDEPENDENT
    for (int i = 0; i < count; i++) {
        const double w[3] = {wx[i], wy[i], wz[i]};
        const Turn   turn = turn_series(turn_angle_squared(w, t[i]), t[i]);
        block->cos_x[i] = turn.cos_x;
        block->sin_w[i] = turn.sin_w;
        block->vers_w2[i] = turn.vers_w2;
        block->c1[i] = turn.c1;
        block->d1[i] = turn.d1;
        block->d2[i] = turn.d2;
        block->d3[i] = turn.d3;
    }
    for (int i = 0; i < count; i++) {
        const double w[3] = {wx[i], wy[i], wz[i]};
        const double x2 = turn_angle_squared(w, t[i]);
        if (!(x2 < series_below_x2)) store_turn(block, i, turn_closed(x2, t[i]));
    }
}

/* With `algorithm` a literal in each caller the compiler writes nine loops, each with only its own streams.
 * Independent: out never overlaps in (see the header); forty pointers are too many for a run-time check. */
ALWAYS_INLINE void reckon_block(MotionArrays *out, int algorithm, const KinematicsArrays *k, const TurnBlock *block,
                                int first, int count)
{
    LANES_ARE_INDEPENDENT
    for (int i = 0; i < count; i++) {
        const int j = first + i;
        Body      in, end;
        in.p[0] = k->p_ecef[0][j], in.p[1] = k->p_ecef[1][j], in.p[2] = k->p_ecef[2][j];
        in.v[0] = k->v_mps[0][j], in.v[1] = k->v_mps[1][j], in.v[2] = k->v_mps[2][j];
        in.a[0] = k->a_mps2[0][j], in.a[1] = k->a_mps2[1][j], in.a[2] = k->a_mps2[2][j];
        in.w[0] = k->w_body_rps[0][j], in.w[1] = k->w_body_rps[1][j], in.w[2] = k->w_body_rps[2][j];
        for (int e = 0; e < 9; e++) in.r[e] = k->r_ecef_from_body[e][j];

        const Turn turn = {.cos_x = block->cos_x[i],
                           .sin_w = block->sin_w[i],
                           .vers_w2 = block->vers_w2[i],
                           .c1 = block->c1[i],
                           .d1 = block->d1[i],
                           .d2 = block->d2[i],
                           .d3 = block->d3[i]};
        reckon(&end, algorithm, &in, &turn, k->dt_s[j]);

        out->p_ecef[0][j] = end.p[0], out->p_ecef[1][j] = end.p[1], out->p_ecef[2][j] = end.p[2];
        out->v_ecef_mps[0][j] = end.v[0], out->v_ecef_mps[1][j] = end.v[1], out->v_ecef_mps[2][j] = end.v[2];
        for (int e = 0; e < 9; e++) out->r_ecef_from_body[e][j] = end.r[e];
    }
}

void dead_reckon_arrays(MotionArrays *out, int algorithm, const KinematicsArrays *k)
{
    /* copies: the pointers then cannot be what the loop writes to */
    MotionArrays           to = *out;
    const KinematicsArrays from = *k;
    TurnBlock              block;

    for (int first = 0; first < from.count; first += block_count) {
        const int count = from.count - first < block_count ? from.count - first : block_count;

        if (algorithm >= 3 && algorithm <= 9 && algorithm != 5) turn_block(&block, &from, first, count);
        switch (algorithm) {
        case 2:
            reckon_block(&to, 2, &from, &block, first, count);
            break;
        case 3:
            reckon_block(&to, 3, &from, &block, first, count);
            break;
        case 4:
            reckon_block(&to, 4, &from, &block, first, count);
            break;
        case 5:
            reckon_block(&to, 5, &from, &block, first, count);
            break;
        case 6:
            reckon_block(&to, 6, &from, &block, first, count);
            break;
        case 7:
            reckon_block(&to, 7, &from, &block, first, count);
            break;
        case 8:
            reckon_block(&to, 8, &from, &block, first, count);
            break;
        case 9:
            reckon_block(&to, 9, &from, &block, first, count);
            break;
        default:
            reckon_block(&to, 1, &from, &block, first, count);
            break;
        }
    }
}

/* ---- Euler angles ------------------------------------------------------------------------- */

/* The columns are the body axes in the world: r_body_from_ecef = Rx(phi) Ry(theta) Rz(psi), transposed. */
void r_ecef_from_body_euler(double r_ecef_from_body[9], double psi_rad, double theta_rad, double phi_rad)
{
    const double sin_psi = sin(psi_rad), cos_psi = cos(psi_rad);
    const double sin_theta = sin(theta_rad), cos_theta = cos(theta_rad);
    const double sin_phi = sin(phi_rad), cos_phi = cos(phi_rad);
    double      *r = r_ecef_from_body;

    r[0] = cos_theta * cos_psi;
    r[3] = cos_theta * sin_psi;
    r[6] = -sin_theta;
    r[1] = sin_phi * sin_theta * cos_psi - cos_phi * sin_psi;
    r[4] = sin_phi * sin_theta * sin_psi + cos_phi * cos_psi;
    r[7] = sin_phi * cos_theta;
    r[2] = cos_phi * sin_theta * cos_psi + sin_phi * sin_psi;
    r[5] = cos_phi * sin_theta * sin_psi - sin_phi * cos_psi;
    r[8] = cos_phi * cos_theta;
}

/* phi is read after turning psi back, not from the last row: at theta = +-90 degrees psi alone is noise, but psi
 * and phi together still give the attitude back. */
void euler_from_r_ecef_from_body(double *psi_rad, double *theta_rad, double *phi_rad, const double r_ecef_from_body[9])
{
    const double *r = r_ecef_from_body;
    const double  psi = atan2(r[3], r[0]);
    const double  sin_psi = sin(psi), cos_psi = cos(psi);
    const double  phi = atan2(sin_psi * r[2] - cos_psi * r[5], cos_psi * r[4] - sin_psi * r[1]);

    *psi_rad = psi == -pi_rad ? pi_rad : psi;
    *theta_rad = atan2(-r[6], hypot(r[0], r[3]));
    *phi_rad = phi == -pi_rad ? pi_rad : phi;
}
