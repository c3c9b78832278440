/* render/smoke/smoke_crossings.c: spheroids that a ray crosses, four at a time. Scaling space along its axis maps a
 * spheroid to a unit ball; along a ray the squared distance from the centre is then a parabola, and the density (1 -
 * q^2)^2 a quartic. */
#include "render/smoke/smoke_private.h"

#include "pitviper_simd.h"

/* ---- one volume along one ray ------------------------------------------------------------- */

static void to_ball(double out[3], const SmokeVolume *v, const SmokeBall *ball, const double a_enu[3])
{
    const double across = ball->across_per_m, more = v3_dot(a_enu, v->axis_enu) * ball->more_per_m;
    for (int i = 0; i < 3; i++) out[i] = a_enu[i] * across + more * v->axis_enu[i];
}

static void fill_scale(SmokeBall *ball, const SmokeVolume *v)
{
    ball->across_per_m = 1 / v->across_m;
    ball->more_per_m = 1 / v->along_m - ball->across_per_m;
}

/* o and d in the ball's units. */
static bool chord_of(Chord *chord, const double o[3], const double d[3])
{
    const double rate2 = v3_dot(d, d), middle_m = -v3_dot(o, d) / rate2;
    double       nearest[3];
    /* the point itself, not the difference of two large squares */
    v3_add_scaled(nearest, o, middle_m, d);
    const double q2 = v3_dot(nearest, nearest);
    if (!(q2 < 1)) return false;
    *chord = (Chord){middle_m, sqrt((1 - q2) / rate2), rate2};
    return true;
}

/* Integral of the density from the middle to u metres beyond it, |u| <= half. */
static inline double column_to(const Chord *c, bool even, double u)
{
    if (even) return u;
    const double h2 = c->half_m * c->half_m, u2 = u * u;
    return c->rate2 * c->rate2 * u * (h2 * h2 - u2 * (2.0 / 3 * h2 - 0.2 * u2));
}

double smoke_chord_column(const Chord *c, bool even, double from_m, double to_m)
{
    const double a = clamp(from_m - c->middle_m, -c->half_m, c->half_m);
    const double b = clamp(to_m - c->middle_m, -c->half_m, c->half_m);
    return b > a ? column_to(c, even, b) - column_to(c, even, a) : 0;
}

double smoke_column_m(const SmokeVolume *volume, const double o_enu[3], const double d_enu[3], double from_m,
                      double to_m)
{
    double    off[3], o[3], d[3];
    Chord     chord;
    SmokeBall ball;
    fill_scale(&ball, volume);
    v3_sub(off, o_enu, volume->p_enu);
    to_ball(o, volume, &ball, off);
    to_ball(d, volume, &ball, d_enu);
    return chord_of(&chord, o, d) ? smoke_chord_column(&chord, volume->even, from_m, to_m) : 0;
}

/* ---- a set of volumes --------------------------------------------------------------------- */

void smoke_set_fill(SmokeSet *set, const SmokeVolume *volume, const int *list, int count)
{
    static const double zenith_enu[3] = {0, 0, 1};
    set->count = count;
    for (int n = 0; n < count; n++) {
        const SmokeVolume *v = &volume[list[n]];
        SmokeBall         *ball = &set->ball[n];
        const double       reach = fmax(v->along_m, v->across_m);
        set->volume[n] = v;
        for (int c = 0; c < 3; c++) set->p_enu[c][n] = v->p_enu[c];
        set->reach2_m2[n] = reach * reach * 1.001;
        fill_scale(ball, v);
        to_ball(ball->sun, v, ball, v->d_sun_enu);
        to_ball(ball->up, v, ball, zenith_enu);
        ball->up_length = v3_length(ball->up);
    }
    for (int n = count; n < ((count + 3) & ~3); n++) { /* the last four are loaded whole */
        for (int c = 0; c < 3; c++) set->p_enu[c][n] = 0;
        set->reach2_m2[n] = -1;
    }
}

static inline F64x4 dot4(const F64x4 a[3], const F64x4 b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

int smoke_set_near(int near[smoke_set_most], const SmokeSet *set, const double o_enu[3], const double d_enu[3])
{
    const F64x4 o[3] = {f64x4_set(o_enu[0]), f64x4_set(o_enu[1]), f64x4_set(o_enu[2])};
    const F64x4 d[3] = {f64x4_set(d_enu[0]), f64x4_set(d_enu[1]), f64x4_set(d_enu[2])};
    int         listed = 0;
    for (int n = 0; n < set->count; n += 4) {
        F64x4 off[3];
        for (int c = 0; c < 3; c++) off[c] = o[c] - f64x4_loadu(&set->p_enu[c][n]);
        const F64x4 along = dot4(off, d);
        unsigned    in = f64x4_bits(f64x4_at_most(dot4(off, off) - along * along, f64x4_loadu(&set->reach2_m2[n])));
        for (; in; in &= in - 1) near[listed++] = n + __builtin_ctz(in);
    }
    return listed;
}

/* ---- noise pattern ------------------------------------------------------------------------ */

static inline __m128 lattice4(__m128i x, __m128i y, __m128i z) /* each by its own factor already */
{
    __m128i h = _mm_xor_si128(_mm_xor_si128(x, y), z);
    h = _mm_xor_si128(h, _mm_srli_epi32(h, 15));
    h = _mm_mullo_epi32(h, _mm_set1_epi32(0x2c1b3c6d));
    h = _mm_xor_si128(h, _mm_srli_epi32(h, 12));
    h = _mm_mullo_epi32(h, _mm_set1_epi32(0x297a2d39));
    h = _mm_xor_si128(h, _mm_srli_epi32(h, 15));
    return _mm_cvtepi32_ps(h) * _mm_set1_ps(1 / 2147483648.0f);
}

/* Values at the corners of a lattice of cubes, -1 .. 1, and smooth between. */
static F64x4 noise4(const F64x4 p[3])
{
    static const uint32_t factor[3] = {0x8da6b343u, 0xd8163841u, 0xcb1ab31fu};
    __m128i               i[3][2]; /* of both sides */
    __m128                f[3], plane[2];
    for (int k = 0; k < 3; k++) {
        const F64x4   low = f64x4_floor(p[k]);
        const __m128  t = _mm256_cvtpd_ps(p[k] - low);
        const __m128i by = _mm_set1_epi32((int)factor[k]);
        i[k][0] = _mm_mullo_epi32(_mm256_cvttpd_epi32(low), by);
        i[k][1] = _mm_add_epi32(i[k][0], by);
        f[k] = t * t * (_mm_set1_ps(3) - _mm_set1_ps(2) * t);
    }
    for (int z = 0; z < 2; z++) {
        const __m128 a = lattice4(i[0][0], i[1][0], i[2][z]), b = lattice4(i[0][1], i[1][0], i[2][z]);
        const __m128 c = lattice4(i[0][0], i[1][1], i[2][z]), d = lattice4(i[0][1], i[1][1], i[2][z]);
        const __m128 low = a + f[0] * (b - a), high = c + f[0] * (d - c);
        plane[z] = low + f[1] * (high - low);
    }
    return _mm256_cvtps_pd(plane[0] + f[2] * (plane[1] - plane[0]));
}

static inline void turn4(F64x4 out[3], const F64x4 a[3])
{
    static const double m[9] = {0.00, 0.80, 0.60, -0.80, 0.36, -0.48, -0.60, -0.48, 0.64};
    for (int i = 0; i < 3; i++)
        out[i] = f64x4_set(m[3 * i]) * a[0] + f64x4_set(m[3 * i + 1]) * a[1] + f64x4_set(m[3 * i + 2]) * a[2];
}

/* Billows: three octaves of noise, the finer ones folded so that they bulge outwards. About -1 .. 1, mean near 0.
 * Each octave has axes of its own: aligned lattices show as squares. */
static F64x4 billows4(const F64x4 p[3])
{
    F64x4 at[3], turned[3];
    turn4(turned, p);
    for (int k = 0; k < 3; k++) at[k] = f64x4_set(1.7) * turned[k];
    F64x4 sum = noise4(at);
    for (int octave = 0; octave < 2; octave++) {
        turn4(turned, at);
        for (int k = 0; k < 3; k++) at[k] = f64x4_set(2.17) * turned[k] + f64x4_set(11.3);
        sum += f64x4_set(octave ? 0.4 : 0.7) * (f64x4_set(0.62) - f64x4_set(1.9) * f64x4_abs(noise4(at)));
    }
    return sum;
}

/* ---- four volumes along a ray ------------------------------------------------------------- */

typedef struct Chord4 {
    F64x4 middle_m, half_m, rate2, q2, nearest[3]; /* q2: squared distance of closest approach, inside: below 1 */
} Chord4;

static inline F64x4 clamp4(F64x4 x, F64x4 low, F64x4 high)
{
    return f64x4_select(f64x4_less(x, low), low, f64x4_select(f64x4_less(high, x), high, x));
}

/* As chord_of; half_m: NaN outside. */
static inline void chord4_of(Chord4 *c, const F64x4 o[3], const F64x4 d[3])
{
    c->rate2 = dot4(d, d);
    c->middle_m = -dot4(o, d) / c->rate2;
    for (int i = 0; i < 3; i++) c->nearest[i] = o[i] + c->middle_m * d[i];
    c->q2 = dot4(c->nearest, c->nearest);
    c->half_m = f64x4_sqrt((f64x4_set(1) - c->q2) / c->rate2);
}

/* As smoke_chord_column from 0 on. */
static inline F64x4 column4_ahead(const Chord4 *c, F64x4 even)
{
    const F64x4 a = clamp4(f64x4_set(0) - c->middle_m, -c->half_m, c->half_m), b = c->half_m;
    const F64x4 h2 = c->half_m * c->half_m, r4 = c->rate2 * c->rate2;
    F64x4       to[2] = {a, b};
    for (int k = 0; k < 2; k++) {
        const F64x4 u = to[k], u2 = u * u;
        const F64x4 all = r4 * u * (h2 * h2 - u2 * (f64x4_set(2.0 / 3) * h2 - f64x4_set(0.2) * u2));
        to[k] = f64x4_select(even, u, all);
    }
    return f64x4_and(f64x4_less(a, b), to[1] - to[0]);
}

/* Fields of four volumes. */
#define OF4(field)      _mm256_setr_pd(v[0]->field, v[1]->field, v[2]->field, v[3]->field)
#define OF4_BALL(field) _mm256_setr_pd(ball[0]->field, ball[1]->field, ball[2]->field, ball[3]->field)

typedef struct Four {
    const SmokeVolume *volume[4];
    const SmokeBall   *ball[4];
    F64x4              o[3], d[3]; /* of the ray in their units, stretched */
    F64x4              from_m, to_m, factor;
    Chord4             chord;
} Four;

static inline void within4(Four *f, double far_m)
{
    f->from_m = f64x4_max(f->chord.middle_m - f->chord.half_m, f64x4_set(0));
    f->to_m = f64x4_min(f->chord.middle_m + f->chord.half_m, f64x4_set(far_m));
}

static inline F64x4 crossed4(const Four *f)
{
    return f64x4_and(f64x4_less(f->chord.q2, f64x4_set(1)), f64x4_less(f->from_m, f->to_m));
}

/* At the ray's closest approach to the centre the pattern gives the bulge of the ball there (space is scaled by it,
 * 1 .. 1.6) and the density: the factor on the ray's whole column. The constant compensates the scaling: the mean
 * mass is kept (tests/render/test_smoke_volume.c). */
static void stretch4(Four *f)
{
    const SmokeVolume *const *v = f->volume;
    const F64x4               one = f64x4_set(1), billow = OF4(billow);
    F64x4                     p[3];
    for (int k = 0; k < 3; k++) p[k] = f->chord.nearest[k] + OF4(pattern[k]);
    const F64x4 n = billows4(p), patterned = f64x4_less(f64x4_set(0), billow);
    const F64x4 dense = one + billow * n * (f64x4_set(0.7) + f64x4_set(1.2) * f->chord.q2);
    const F64x4 factor = (one + f64x4_set(0.42) * billow) * f64x4_max(dense, f64x4_set(0));
    const F64x4 bulge = clamp4(f64x4_set(0.6) - n, f64x4_set(0), f64x4_set(1.6));
    const F64x4 stretch = f64x4_select(patterned, one + f64x4_set(0.38) * billow * bulge, one);
    f->factor = f64x4_select(patterned, factor, one);
    for (int k = 0; k < 3; k++) f->o[k] = stretch * f->o[k], f->d[k] = stretch * f->d[k];
    chord4_of(&f->chord, f->o, f->d);
}

/* Of the sunlight that reaches one point of the chord, in front of the middle: the column that it crossed; and how far
 * up in the ball that point is, -1 .. 1. */
static void light4(double column_m[4], double top[4], const Four *f)
{
    const SmokeBall *const   *ball = f->ball;
    const SmokeVolume *const *v = f->volume;
    const F64x4               at_m = f64x4_max(f->from_m, f->chord.middle_m - f64x4_set(0.55) * f->chord.half_m);
    const F64x4               even = f64x4_less(f64x4_set(0), OF4(even));
    F64x4                     at[3], sun[3], up[3];
    Chord4                    sunward;
    for (int k = 0; k < 3; k++) {
        at[k] = f->o[k] + at_m * f->d[k];
        sun[k] = OF4_BALL(sun[k]);
        up[k] = OF4_BALL(up[k]);
    }
    chord4_of(&sunward, at, sun);
    const F64x4 column = f->factor * column4_ahead(&sunward, even);
    f64x4_storeu(column_m, f64x4_and(f64x4_less(sunward.q2, f64x4_set(1)), column));
    f64x4_storeu(top, clamp4(dot4(at, up) / OF4_BALL(up_length), f64x4_set(-1), f64x4_set(1)));
}

/* Source radiance of the volume on this ray. */
static void source_of(Crossing *c, double column_m, double top, unsigned bands)
{
    const SmokeVolume *v = c->volume;
    for (int b = 0; b < smoke_bands; b++) {
        if (!(bands >> b & 1)) continue;
        double lit = v->source[b] + top * v->from_top[b];
        if (v->sun[b][0] > 0) {
            const double e4 = exp(-0.25 * (v->extinction_per_m[b] * column_m + v->sun_depth[b])), e2 = e4 * e4;
            lit += v->sun[b][0] * e2 * e2 + v->sun[b][1] * e2 + v->sun[b][2] * e4;
        }
        c->source[b] = lit;
    }
}

static int write_crossings(Crossing out[4], const Four *f, unsigned in, unsigned bands)
{
    double middle_m[4], half_m[4], rate2[4], from_m[4], to_m[4], factor[4], column_m[4], top[4];
    int    count = 0;
    f64x4_storeu(middle_m, f->chord.middle_m), f64x4_storeu(half_m, f->chord.half_m);
    f64x4_storeu(rate2, f->chord.rate2), f64x4_storeu(factor, f->factor);
    f64x4_storeu(from_m, f->from_m), f64x4_storeu(to_m, f->to_m);
    light4(column_m, top, f);
    for (int k = 0; k < 4; k++) {
        if (!(in >> k & 1)) continue;
        Crossing *c = &out[count++];
        c->volume = f->volume[k];
        c->chord = (Chord){middle_m[k], half_m[k], rate2[k]};
        c->from_m = from_m[k], c->to_m = to_m[k], c->factor = factor[k];
        source_of(c, column_m[k], top[k], bands);
    }
    return count;
}

int smoke_cross(Crossing out[4], const SmokeSet *set, const int *near, int count, const SmokeRay *ray)
{
    const SmokeBall   *ball[4];
    const SmokeVolume *v[4];
    Four               f;
    F64x4              axis[3], off[3], d_enu[3], patterned = f64x4_set(0);
    for (int k = 0; k < 4; k++) { /* the last once more in the places beyond it */
        const int n = near[k < count ? k : count - 1];
        f.volume[k] = v[k] = set->volume[n];
        f.ball[k] = ball[k] = &set->ball[n];
    }
    for (int c = 0; c < 3; c++) {
        axis[c] = OF4(axis_enu[c]);
        off[c] = f64x4_set(ray->o_enu[c]) - OF4(p_enu[c]);
        d_enu[c] = f64x4_set(ray->d_enu[c]);
    }
    const F64x4 across = OF4_BALL(across_per_m), more = OF4_BALL(more_per_m);
    const F64x4 more_o = dot4(off, axis) * more, more_d = dot4(d_enu, axis) * more;
    for (int c = 0; c < 3; c++) {
        f.o[c] = off[c] * across + more_o * axis[c];
        f.d[c] = d_enu[c] * across + more_d * axis[c];
    }
    chord4_of(&f.chord, f.o, f.d);
    within4(&f, ray->far_m);
    unsigned in = f64x4_bits(crossed4(&f)) & ((1u << count) - 1);
    if (!in) return 0;
    f.factor = f64x4_set(1);
    patterned = f64x4_less(f64x4_set(0), OF4(billow));
    if (f64x4_bits(patterned) & in) {
        stretch4(&f);
        within4(&f, ray->far_m);
        in &= f64x4_bits(f64x4_and(crossed4(&f), f64x4_less(f64x4_set(0), f.factor)));
        if (!in) return 0;
    }
    return write_crossings(out, &f, in, ray->bands);
}
