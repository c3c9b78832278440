/* terrain/landscape/ground_detail.h: what detail adds to the ground at many places, and what a sample covers of it. */
#ifndef TERRAIN_LANDSCAPE_GROUND_DETAIL_H
#define TERRAIN_LANDSCAPE_GROUND_DETAIL_H

/* Of count places, one array each, [count], the caller's. NULL: not wanted, and not computed. */
typedef struct GroundDetail {
    float *albedo;           /* factor of the reflectance, mean 1, > 0 */
    float *warmth_k;         /* added to the class's temperature at night, mean 0 (by day more: render/light/thermal.c) */
    float *radar;            /* factor of the backscatter, mean 1, > 0 */
    float *slope_x, *slope_y;/* rise of the detail's height eastwards and northwards, metres a metre; both or neither */
} GroundDetail;

/* What a sample covers of the ground, m: across the view and along it (at grazing view longer), [count] each. */
typedef struct GroundFootprint {
    const float *across_m, *along_m;
} GroundFootprint;

#endif
