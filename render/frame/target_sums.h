/* render/frame/target_sums.h: results of each target, summed over the samples of all tiles: visible and hidden areas,
 * its occluders, its own radiance; and the radar's range profile.
 *
 * Sums are integers in fixed steps, one set per worker, added at the end: independent of the order in which threads
 * finish. A share of a block's samples may be taken back (share below 0) when others join them. */
#ifndef RENDER_FRAME_TARGET_SUMS_H
#define RENDER_FRAME_TARGET_SUMS_H

#include "render/frame/pixels.h"
#include "render/frame/shade.h"

/* Areas in steps of 1 / SumRules.steps_per_px of a pixel, powers in steps of the rules' quanta. */
typedef struct TargetCount {
    int64_t visible, amodal, hidden_ground, hidden_entity, hidden_plants;
    int64_t radiance[picture_plane_count];
    int64_t veiled[BAND_COUNT]; /* area times the share of its light that smoke absorbs */
    int     box[4], amodal_box[4];
} TargetCount;

/* The area of a target that an entity hides. */
typedef struct Occlusion {
    bool    used;
    int     target, occluder; /* snapshot indices */
    int64_t steps;            /* area, in steps */
    double  area_px;          /* of small targets, whose areas are not in steps */
} Occlusion;

/* Every pair that a worker met: a growing hash table. */
typedef struct Occlusions {
    Occlusion *pair; /* [capacity] */
    size_t     capacity, used;
    bool       lost; /* out of memory: the sums are incomplete */
} Occlusions;

/* Adds to a pair. */
void occlusion_add(Occlusions *table, Arena *arena, int target, int occluder, int64_t steps, double area_px);

/* Constants for all sums of a frame. */
typedef struct SumRules {
    const Picture    *picture;
    const Visibility *visibility;
    const int32_t    *coverer; /* [pixels]: snapshot index of the small target that covers most; valid where any does */
    int               smoke_channel[BAND_COUNT]; /* the channel whose smoke transmittance applies to a band; -1: none */
    Arena            *arena; /* where tables of pairs grow while threads run */
    int64_t           steps_per_px;
    /* fixed point: fine enough to be exact in float's terms, coarse enough that all samples of a picture at the
     * limit stay below 2^62 quanta */
    double            profile_limit, profile_quantum, radiance_limit, radiance_quantum;
} SumRules;

/* Sums of a worker. */
typedef struct TargetSums {
    TargetCount *target;  /* [snapshot count] */
    int64_t     *profile; /* [profile_bins][radar_bounces] */
    Occlusions   hidden;
    Rays         some; /* rays that may meet a target behind their first hit */
    int          some_index[hits_capacity];
    uint8_t      beyond[hits_capacity], meets[hits_capacity];
    double       cosine3[hits_capacity]; /* of the block's pixels */
} TargetSums;

Status target_sums_create(TargetSums *out, int entities, int profile_bins, Arena *arena);
/* Steps and quanta for a request. */
void   sum_rules_choose(SumRules *rules, const RenderRequest *request, const RadarConfig *radar);

/* cos^3 of the angle off the axis at a pixel's centre: what its solid angle has less than 1 / focal_px^2. */
double pixel_cosine3(const View *view, int x, int y);

/* A share of the visible and amodal area of the listed entities: all that the block can show. */
void target_sums_areas(TargetSums *sums, const SumRules *rules, const Samples *s, const PixelBlock *block, double share,
                       const int *list, int listed, VisibilityCounters *counters);
/* The block's radiance of a plane, weighted by area, to the targets that it shows. target_sums_view comes first. */
void target_sums_view(TargetSums *sums, const PixelBlock *block, const View *view);
void target_sums_radiance(TargetSums *sums, const SumRules *rules, const Hits *hits, const PixelBlock *block, double share,
                          const float *value, int plane);
/* Radar returns of samples of these areas (px; below 0: taken back) to the range profile. */
void target_sums_profile(TargetSums *sums, const SumRules *rules, const RenderRequest *request, const Samples *s,
                         const double *area_px);

/* All workers' sums into the picture: targets, their occluders, and the profile. boxes: where the targets lie.
 * STATUS_NO_MEMORY. */
Status target_sums_gather(Picture *picture, const SumRules *rules, const TargetSums *const *sums, int workers,
                          const TargetPixels *boxes, int entities, int profile_bins, Arena *arena);

#endif
