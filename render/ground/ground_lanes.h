/* render/ground/ground_lanes.h: ground_cell_at for four rays, for the SIMD ground tracers, in intrinsics: the
 * compiler turns these selections into control flow and does not vectorise them (half the speed). */
#ifndef RENDER_GROUND_GROUND_LANES_H
#define RENDER_GROUND_GROUND_LANES_H

#include "pitviper_simd.h"
#include "render/ground/ground_private.h"

/* ground_cell_at, four times. */
static inline F64x4 cell_at(F64x4 p0, F64x4 dp, F64x4 per_dp, F64x4 t, F64x4 last)
{
    const F64x4 zero = f64x4_set(0), one = f64x4_set(1);
    F64x4       e = f64x4_floor(p0 + t * dp);
    e = f64x4_min(f64x4_max(e, zero), last);
    const F64x4 at_low = (e - p0) * per_dp, at_high = (e + one - p0) * per_dp;
    const F64x4 out = f64x4_at_most(f64x4_select(per_dp, at_low, at_high), t),
                early = f64x4_less(t, f64x4_select(per_dp, at_high, at_low));
    const F64x4 sign = f64x4_or(one, f64x4_and(f64x4_set(-0.0), per_dp)); /* of the way along this axis */
    e = e + f64x4_and(out, sign) - f64x4_and(f64x4_and_not(early, out), sign);
    return f64x4_min(f64x4_max(e, zero), last);
}

#endif
