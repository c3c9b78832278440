/* render/frame/pixel_record.h: what one pixel of a picture was made of: its samples, the terms of their light, and the
 * steps from them to the values of the planes.
 *
 * render() fills it where a request asks for it (RenderRequest.record): the passes note what they do to that pixel, in
 * their order, and terms are found by the functions that shade it (shade_terms.c). The planes are the same with and
 * without it. pixel_record_value adds the terms in the order of the program: it equals the plane to the bit
 * (tests/render/test_pixel_record.c, tests/system/test_explain.sh). */
#ifndef RENDER_FRAME_PIXEL_RECORD_H
#define RENDER_FRAME_PIXEL_RECORD_H

#include "render/frame/picture.h"
#include "render/heat/scenery_heat.h"

#include <pthread.h>

/* Light of a sample in one channel, W/(m2 sr), and shares 0 .. 1.
 *
 *   a surface           path + reflected air_transmittance + sunlit sun_transmittance + emitted transmittance
 *                       + lamps air_transmittance
 *   what met nothing    beyond beyond_transmittance + path + disc: ground beyond the terrain's edge; in the sky, whose
 *                       radiance the path is, the sun's disc
 *   smoke before it     that times smoke_transmittance + smoke */
typedef struct PixelLight {
    float  emitted, reflected, sunlit;      /* at the surface; emitted 0 in optical channels */
    float  lamps;                           /* their own light, and what they throw on it (render/light/lamps.h) */
    float  reflected_sky, reflected_ground; /* of `reflected`, to rounding; the rest: plants, or all surroundings */
    float  transmittance, air_transmittance, sun_transmittance; /* of the path, for the spectrum of each */
    float  path;                                                /* radiance of the path */
    double beyond, disc;
    float  beyond_transmittance;
    bool   smoky;
    float  smoke_transmittance, smoke;
    float  seen; /* at the eye, as the program has it */
} PixelLight;

enum { pixel_patches = 4 };

/* What a sample met. Temperatures, K: `air_k` of the air there; `still_k` with the heat of the hours before, of a plant
 * in the shade; `sunlit_k` with the sun of the moment on a leaf, and the darkness of the photograph on ground;
 * `detailed_k` with the ground's detail; `temp_k` at last: far woods have their canopy's. NaN: sky, or not needed. */
typedef struct PixelSample {
    int      group;  /* PixelStep.group */
    double   weight; /* share of the pixel's area within its group */
    HitKind  kind;
    double   range_m, p_enu[3];
    float    n_enu[3];
    uint32_t entity, part, plant; /* as in Picture: from 1; plant: of scenery its object */
    uint16_t model, material;     /* material: as the light has it, of far woods their canopy's */
    uint8_t  surface;
    float    radius_m, open_up; /* of plants */
    float    sun;               /* share of the direct sun that arrives */
    float    air_k, still_k, sunlit_k, detailed_k, temp_k;
    int      patches; /* of a part: those that its temperature comes from, the most important first */
    struct {
        int   index;
        float share, temp_k;
    } patch[pixel_patches];
    SceneryHeatOf scenery;  /* of scenery; zeroes: as warm as the air */
    unsigned      channels; /* 1 << AirBand: those of `light` */
    PixelLight    light[AIR_BAND_COUNT];
    bool          has_radar;
    float         radar[radar_bounces], radar_power; /* relative; the sum of the three */
} PixelSample;

typedef enum PixelStepKind {
    PIXEL_MEAN,     /* value = mean of a group; with `share` below 1: share of it, and the rest of the value before */
    PIXEL_SMOOTHED, /* of plants: weighted mean over 3 x 3 pixels (leaf_filter.c) */
    PIXEL_BESIDE,   /* value times `share`: what small targets, and what hides them, leave of the pixel */
    PIXEL_BEFORE,   /* + share times sum of area x value: what hides a small target */
    PIXEL_TARGET,   /* + sum of area x value: a small target */
} PixelStepKind;

typedef struct PixelStep {
    PixelStepKind kind;
    unsigned      planes; /* 1 << plane: of which */
    int           group;  /* of its samples; 0: none */
    int           n;      /* PIXEL_MEAN: n x n samples, `several`: each with one return or more */
    bool          several;
    double        share;
    int           entity;    /* snapshot index of the small target */
    float         weight[9]; /* PIXEL_SMOOTHED: row by row; value: of the pixels, [4] this one */
    float         value[picture_plane_count][9];
} PixelStep;

typedef struct PixelRecord {
    int             x, y; /* column, row */
    int             steps, step_room, samples, sample_room;
    PixelStep      *step;
    PixelSample    *sample;
    bool            lost; /* out of memory: it is incomplete */
    int             channels;
    PictureChannel  channel[picture_radar];
    pthread_mutex_t lock; /* small targets are sampled side by side */
} PixelRecord;

/* A request takes an array of three: of the picture, and with lateral colour those of R and of B (render.c). */
enum { pixel_records = 3 };

void pixel_record_open(PixelRecord *out, int x, int y);
void pixel_record_close(PixelRecord *record); /* accepts zeroes */
/* Puts the samples in order of their groups, which threads note one beside another; within a group they keep theirs. */
void pixel_record_sort(PixelRecord *record);

/* The sum of a light's terms in the order of the program. met: of a surface. */
float pixel_light_sum(const PixelLight *light, AirBand channel, bool met);
/* The value of a plane after the first `steps` steps, from the samples' terms. coefficient: of each sample in it
 * [samples], beside: of the neighbours that were smoothed into it; may be NULL. NaN where the plane has no step. */
float pixel_record_value(double *coefficient, double *beside, const PixelRecord *record, int plane, int steps);

#endif
