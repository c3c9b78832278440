/* render/ground/ground_lanes.h: four doubles at a time, for the ground's eight-wide tracers. Written with intrinsics because
 * the compiler finds control flow in these selections and gives up (half the speed). */
#ifndef RENDER_GROUND_GROUND_LANES_H
#define RENDER_GROUND_GROUND_LANES_H

#include <immintrin.h>

#include "render/ground/ground_private.h"

typedef __m256d Four;

static inline Four set(double x) { return _mm256_set1_pd(x); }
static inline Four load(const double *p) { return _mm256_load_pd(p); }
static inline Four less(Four a, Four b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
static inline Four at_most(Four a, Four b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
static inline Four both(Four a, Four b) { return _mm256_and_pd(a, b); }
static inline Four either(Four a, Four b) { return _mm256_or_pd(a, b); }
static inline Four unless(Four not, Four a) { return _mm256_andnot_pd(not, a); }
static inline Four pick(Four mask, Four yes, Four no) { return _mm256_blendv_pd(no, yes, mask); }
static inline Four smaller(Four a, Four b) { return _mm256_min_pd(a, b); } /* a < b ? a : b */
static inline Four larger(Four a, Four b) { return _mm256_max_pd(a, b); }  /* a > b ? a : b */
static inline unsigned bits(Four mask) { return (unsigned)_mm256_movemask_pd(mask); }

/* ground_cell_at, four times. */
static inline Four cell_at(Four p0, Four dp, Four per_dp, Four t, Four last)
{
    const Four zero = set(0), one = set(1);
    Four       e = _mm256_floor_pd(p0 + t * dp);
    e = smaller(larger(e, zero), last);
    const Four at_low = (e - p0) * per_dp, at_high = (e + one - p0) * per_dp;
    const Four out = at_most(pick(per_dp, at_low, at_high), t), early = less(t, pick(per_dp, at_high, at_low));
    const Four sign = either(one, both(set(-0.0), per_dp)); /* of the way along this axis */
    e = e + both(out, sign) - both(unless(out, early), sign);
    return smaller(larger(e, zero), last);
}

#endif
