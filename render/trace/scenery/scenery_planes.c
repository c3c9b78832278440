/* render/trace/scenery/scenery_planes.c: planes about a bundle of rays, four rays at a time. */
#include "render/trace/scenery/scenery_planes_private.h"

#include "pitviper_simd.h"

static void add_plane(Planes *to, double x, double y, double z, const double at[3], double margin_m)
{
    const double length = sqrt(x * x + y * y + z * z);
    double      *plane = to->plane[to->count++];
    plane[0] = x / length, plane[1] = y / length, plane[2] = z / length;
    plane[3] = v3_dot(plane, at) - margin_m;
}

static void across(double u[3], double v[3], const double axis[3])
{
    const int    least = fabs(axis[0]) < fabs(axis[1]) ? (fabs(axis[0]) < fabs(axis[2]) ? 0 : 2)
                                                       : (fabs(axis[1]) < fabs(axis[2]) ? 1 : 2);
    const double side[3] = {least == 0, least == 1, least == 2};
    v3_cross(u, axis, side);
    if (!v3_normalize(u, u)) u[0] = 1, u[1] = u[2] = 0;
    v3_cross(v, axis, u);
}

/* ---- four at a time ----------------------------------------------------------------------------- */

/* Numbers i .. i + 3 of count; behind the last one some again. */
static inline F64x4 four_of(const double *x, int i, int count)
{
    if (i + 4 <= count) return f64x4_loadu(x + i);
    if (count >= 4) return f64x4_loadu(x + count - 4);
    return _mm256_setr_pd(x[0], x[count > 1], x[count - 1], x[count - 1]);
}

static inline F64x4 dot_of(const double *const x[3], const double u[3], int i, int count)
{
    return four_of(x[0], i, count) * f64x4_set(u[0]) + four_of(x[1], i, count) * f64x4_set(u[1]) +
           four_of(x[2], i, count) * f64x4_set(u[2]);
}

typedef struct Span {
    F64x4 low, high;
} Span;

static inline Span no_span(void) { return (Span){f64x4_set(INFINITY), f64x4_set(-INFINITY)}; }
static inline Span widened(Span s, F64x4 x) { return (Span){f64x4_min(x, s.low), f64x4_max(x, s.high)}; }

static inline double lowest(F64x4 x)
{
    double each[4];
    f64x4_storeu(each, x);
    for (int k = 1; k < 4; k++) each[0] = each[k] < each[0] ? each[k] : each[0];
    return each[0];
}
static inline double highest(F64x4 x) { return -lowest(-x); }

/* ---- the planes ---------------------------------------------------------------------------------- */

bool scenery_pyramid(Planes *out, double axis[3], const Bundle *b, const double *limit_m)
{
    static const double margin_m = 1e-3, slope_margin = 1e-9;
    const double        eye[3] = {b->o[0][0], b->o[1][0], b->o[2][0]};
    double              u[3], v[3], end[3];
    F64x4               strays = f64x4_set(0), far = f64x4_set(0);
    Span                slope[2] = {no_span(), no_span()};
    for (int c = 0; c < 3; c++) {
        Span way = no_span();
        for (int i = 0; i < b->count; i += 4) {
            strays = f64x4_or(strays, f64x4_differ(four_of(b->o[c], i, b->count), f64x4_set(eye[c])));
            way = widened(way, four_of(b->d[c], i, b->count));
        }
        axis[c] = lowest(way.low) + highest(way.high);
    }
    if (f64x4_bits(strays) || !v3_normalize(axis, axis)) return false;
    across(u, v, axis);
    strays = f64x4_set(0);
    for (int i = 0; i < b->count; i += 4) {
        const F64x4 along = dot_of(b->d, axis, i, b->count), per = f64x4_set(1) / along;
        strays = f64x4_or(strays, _mm256_cmp_pd(along, f64x4_set(0.1), _CMP_NGT_UQ));
        slope[0] = widened(slope[0], dot_of(b->d, u, i, b->count) * per);
        slope[1] = widened(slope[1], dot_of(b->d, v, i, b->count) * per);
        far = f64x4_max(four_of(limit_m, i, b->count), far);
    }
    if (f64x4_bits(strays)) return false;
    out->count = 0;
    add_plane(out, axis[0], axis[1], axis[2], eye, margin_m);
    for (int k = 0; k < 2; k++) {
        const double *side = k ? v : u, l = lowest(slope[k].low) - slope_margin,
                     h = highest(slope[k].high) + slope_margin;
        add_plane(out, side[0] - l * axis[0], side[1] - l * axis[1], side[2] - l * axis[2], eye, margin_m);
        add_plane(out, h * axis[0] - side[0], h * axis[1] - side[1], h * axis[2] - side[2], eye, margin_m);
    }
    const double far_m = highest(far);
    if (far_m < INFINITY) {
        v3_add_scaled(end, eye, far_m, axis);
        add_plane(out, -axis[0], -axis[1], -axis[2], end, margin_m);
    }
    return true;
}

void scenery_prism(Planes *out, const Bundle *b, const double way[3])
{
    static const double margin_m = 1e-3;
    double              side[3][3];
    Span                span[3] = {no_span(), no_span(), no_span()};
    memcpy(side[2], way, sizeof side[2]);
    across(side[0], side[1], way);
    for (int i = 0; i < b->count; i += 4)
        for (int k = 0; k < 3; k++) span[k] = widened(span[k], dot_of(b->o, side[k], i, b->count));
    out->count = 0;
    for (int k = 0; k < 3; k++) {
        const double low = lowest(span[k].low), high = highest(span[k].high);
        double       at[3];
        v3_scale(at, low, side[k]);
        add_plane(out, side[k][0], side[k][1], side[k][2], at, margin_m + 1e-9 * fabs(low));
        if (k == 2) break;
        v3_scale(at, high, side[k]);
        add_plane(out, -side[k][0], -side[k][1], -side[k][2], at, margin_m + 1e-9 * fabs(high));
    }
}
