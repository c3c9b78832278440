/* render/ground/ground_together.c: coherent rays: start distances (ground_sweep.c), nearby hits (ground_near.c), and
 * the remaining rays (ground8.c). */
#include "render/ground/ground_private.h"

/* Whether all are the same. */
static bool one_vector(int count, const double *const p[3])
{
    bool same = true;
    for (int c = 0; c < 3; c++)
        for (int i = 1; i < count; i++) same &= p[c][i] == p[c][0];
    return same;
}

static void tile_hits(double *range_m, GroundHit *hit, const Ground *ground, int count, const double *const o[3],
                      const double *const d[3], const double *far_m)
{
    double from_m[ground_together];
    int    left[ground_together];
    int    start_level = 0;
    if (one_vector(count, o)) {
        const double eye[3] = {o[0][0], o[1][0], o[2][0]};
        if (!ground_sweep(from_m, ground, count, eye, d)) {
            for (int i = 0; i < count; i++) from_m[i] = 0;
            start_level = 6;
        }
    } else if (one_vector(count, d)) {
        for (int i = 0; i < count; i++) from_m[i] = 0;
    } else { /* each is traced separately */
        ground_first_hits(range_m, hit, ground, count, o, d, far_m);
        return;
    }
    count = ground_near_hits(left, range_m, hit, ground, count, o, d, far_m, from_m, start_level);
    ground_first_hits_from(range_m, hit, ground, count, o, d, far_m, from_m, left);
}

void ground_first_hits_together(double *range_m, GroundHit *hit, const Ground *ground, int count,
                                const double *const o_enu[3], const double *const d_enu[3], const double *far_m)
{
    if (ground->level_count == 0) {
        ground_first_hits(range_m, hit, ground, count, o_enu, d_enu, far_m);
        return;
    }
    for (int n = 0; n < count; n += ground_together) {
        const double *const o[3] = {o_enu[0] + n, o_enu[1] + n, o_enu[2] + n};
        const double *const d[3] = {d_enu[0] + n, d_enu[1] + n, d_enu[2] + n};
        const int some = count - n < ground_together ? count - n : ground_together;
        tile_hits(range_m + n, hit ? hit + n : NULL, ground, some, o, d, far_m + n);
    }
}
