/* render/frame/picture.h: what is asked of a frame, and what it is: radiance planes, truth planes, targets, counters.
 */
#ifndef RENDER_FRAME_PICTURE_H
#define RENDER_FRAME_PICTURE_H

#include "render/scene/view.h"
#include "render/air/air.h"
#include "render/scattering/radar_image.h"
#include "render/trace/visibility/visibility.h"

/* Which pixels of ground, plants and sky get rays of their own; what an entity may touch is sampled in full in every
 * step. Each is cheaper than the one before. */
typedef enum Sampling {
    SAMPLING_ALL,
    SAMPLING_TARGETS,      /* borders of ground, horizon and shadow edges are not refined */
    SAMPLING_CHECKERBOARD, /* every second pixel, the others from their four neighbours */
    SAMPLING_QUARTER,      /* one of 2 x 2, bilinear */
} Sampling;

typedef struct RenderRequest {
    View            view;
    unsigned        bands; /* 1 << Band, the bands that have consumers */
    bool            truth; /* id, part, material, range, normal, temperature planes and target counts */
    OpticalChannels optical;
    double          lateral[2];  /* lateral colour of R G B: magnification of R, and of B, over that of G, less 1 */
    int             sky_samples; /* directions a hit over which light from sky and surroundings is sampled; 0: the quick
                                  * form */
    bool sky_visibility;         /* with the quick form: nearby objects hide sky and ground
                                  * (render/light/sky_visibility.h) */
    int samples;                 /* a side: samples^2 rays a pixel, on a rotated grid, box-averaged. 1 .. 16 */
    int edge_samples;            /* the same where neighbours disagree, 2 .. 16; not above samples: nowhere */
    int target_samples;          /* rays a side over the whole of a target that is small on the image, 8 .. 256; 0: as
                                  * all others */
    bool refraction;             /* rays from the eye bend in air (terrain/earth/refraction.h) */
    int  hidden_entity;          /* snapshot index of the entity whose parts the eye does not see (they cast shadows);
                                  * -1: none */
    unsigned
           skips_off; /* 1 << Skip (render/trace/visibility/visibility.h): skips to disable; must give the same bits */
    bool   budget;    /* estimate the error of the planes: Picture.budget */
    bool   hand_over_cells; /* keep the samples of small targets for a detector behind optics: Picture.small */
    double t_s;             /* exercise time: plants sway by it */
    double low_plants_m;    /* low plants stand within this of the eye; 0: none */
    double scenery_px_m;    /* pixels wider than this show scenery as a texture (edges.c); 0: the default */
    double profile_near_m, profile_bin_m; /* radar range profile */
    int    profile_bins;
    Sampling            sampling;
    struct PixelRecord *record; /* [pixel_records]: what a pixel is made of (render/frame/pixel_record.h); NULL: none */
} RenderRequest;

/* ---- the picture ----------------------------------------------------------------------------- */

/* Planes that carry radiance. */
enum { picture_optical, picture_mwir = picture_optical + 3, picture_lwir, picture_radar, picture_plane_count };

/* Error estimate of a frame's planes, made by the frame itself: root of the mean squared error over the picture, in
 * the plane's unit, by source. The planes are the same with and without it. How each figure is made and what it
 * leaves out: render/frame/render.h; how accurate the estimate is: tests/sensor/test_error_budget.c. */
enum { error_thermal_planes = picture_radar - picture_mwir };

/* What simplified plants and tables of plants change: of rays drawn over the whole picture, as the frame has plants,
 * less the same rays in full detail. Of the radiance planes, in their unit; of the share of rays that meet a plant; of
 * the share that meets an entity, without small targets, whose own rays meet plants themselves. 0: no such plane. */
enum { price_cover = picture_plane_count, price_visible, price_quantities };
typedef struct PlantPrice {
    int    rays, met;                 /* drawn; of them those that met a plant, either way. 0: all are in full detail */
    double cover, visible;            /* those shares in full detail */
    double bias[price_quantities];    /* mean difference */
    double bias_se[price_quantities]; /* its standard error, by pixels of four rays; NaN: there is one pixel */
    double rms[price_quantities];     /* of single rays: mostly another leaf */
    /* mean square of the difference of pixels' expected values, by products of the differences of two rays: without
     * what rays differ by among themselves; below 0 by chance */
    double structure_square[price_quantities];
} PlantPrice;

typedef struct ErrorBudget {
    double mean[picture_plane_count];            /* of the plane, estimated from the candidate pixels */
    double sampling[picture_plane_count];        /* rays a pixel, edges, small targets */
    double level_of_detail[picture_plane_count]; /* posts of the ground; plants. Facets of models:
                                                    sensor/truth/frame_error.h */
    double tables[picture_plane_count];          /* air and shading; radar: 0, it has none */
    int    probes;                               /* re-sampled pixels */
    /* the thermal planes pixel by pixel: of each probe the pixels that it stands for, and the squared error by sampling
     * and level of detail; NaN: of a plane that its own samples estimate. Those are the rest, `refined` in all. */
    const double *probe_px;                             /* [probes] */
    const float  *probe_square[error_thermal_planes];   /* [probes] mwir, lwir */
    double        refined_square[error_thermal_planes]; /* sum of theirs */
    PlantPrice    plants;
    double        ms; /* wall time */
} ErrorBudget;

/* Result of a target in this view, in units of pixels: areas, which may be fractions. Where more than 40 boxes share a
 * tile the outlines of hidden ones (amodal, occluded_*) are of one sample a pixel (refine.c). */
typedef struct TargetPixels {
    double visible, amodal;
    /* its own radiance at the aperture, by the area it fills, less by the cube of the cosine off the axis:
     * over focal_px^2 and times range^2 this is its intensity. px W/(m2 sr); radar: relative */
    double radiance[picture_plane_count];
    bool   small; /* sampled on its own grid: what follows is of its samples, too */
    double mean[picture_plane_count], variance[picture_plane_count]; /* of radiance over its visible area */
    double radiance_error[picture_plane_count];                      /* rms, of `radiance`; with a budget, else 0 */
    double peak_area;                                                /* of the pixel that it fills most */
    int    box[4], amodal_box[4]; /* first column, first row, last column + 1, last row + 1; empty: all 0 */
    bool   projected;             /* in front of the eye and its bounding sphere meets the image */
    double projected_box[4];      /* of all of it, px, not clipped to the image; where `projected` */
    double occluded_ground;       /* pixels hidden by the ground, by other entities ... */
    double occluded_entity;
    double occluded_plants;
    double occluded_scenery;
    double veiled[BAND_COUNT]; /* share of its light that smoke and dust take, mean over what is visible, 0 .. 1 */
    int    occluder;           /* snapshot index of the entity that hides most; -1 */
} TargetPixels;

/* Clutter (entities/scenery) that samples of this view show, what small targets cover left out. */
typedef struct SceneryPixels {
    int    object;    /* of Scenery.object */
    double visible;   /* px, parts of pixels too */
    int    box[4];    /* as TargetPixels.box */
    double range_m;   /* of its nearest sample */
    double hottest_k; /* of its samples; NaN: not known */
} SceneryPixels;

/* Smaller than this one way, and than the other the other way, a target is sampled on its own grid. */
enum { small_target_px = 16, small_target_long_px = 4 * small_target_px };

/* The samples of a small target, for models that need the position of its light within a pixel: a detector behind
 * optics (sensor/detector/subpixel_private.h). The cells fill the box evenly, row by row; their radiance is that at the
 * aperture. */
typedef struct SmallTarget {
    double        box_px[4];                   /* columns and rows from, to; may reach beyond the picture */
    int           columns, rows;               /* cells */
    int           x0, y0, x1, y1;              /* pixels that it may touch, within the picture */
    const bool   *met;                         /* [rows][columns]: cells that show the target */
    const float  *cell[picture_plane_count];   /* [rows][columns], where met; NULL: no such plane */
    const float  *behind[picture_plane_count]; /* [y1 - y0][x1 - x0]: the pixels as they were without small targets */
    const double *area;                        /* [y1 - y0][x1 - x0]: share of the pixel that shows the target */
} SmallTarget;

typedef struct SmallTargets {
    int          count;
    SmallTarget *target; /* in order of entity */
} SmallTargets;

typedef struct RenderCounters {
    VisibilityCounters visibility;
    uint64_t           rays_primary; /* all from the eye; of these: */
    uint64_t           rays_edges, rays_small_targets;
    uint64_t           pixels, pixels_refined, small_targets;
    uint64_t           small_targets_by_pixels; /* beyond the limit of cells a frame (target_grid.c) */
    uint64_t           tiles, tiles_without_entities;
} RenderCounters;

void render_counters_add(RenderCounters *sum, const RenderCounters *more);

typedef struct RenderTimes {
    double prepare_ms, visibility_ms, shadow_ms, shade_ms, radar_ms; /* summed over threads, except prepare */
    double target_grids_ms, base_ms, edges_ms;                       /* wall times of the passes */
} RenderTimes;

/* Planes are width * height, rows top down; NULL where not requested. All in the frame's arena.
 *
 * Truth of a pixel is that of the sample nearest its centre; of a small target where it covers more than half of the
 * pixel, and then that of the target's sample nearest the centre. What is made, when, and what is said of it:
 * render/frame/planes.h. */
typedef struct Picture {
    int       width, height;
    float    *optical[3];       /* R G B, or pan or near infrared in [0] alone: W/(m2 sr) */
    double    white_w_m2_sr[3]; /* R G B: of white, level ground in the open (optical_white); 0 without RGB */
    float    *mwir, *lwir;      /* W/(m2 sr) */
    float    *radar;            /* relative */
    double   *profile;          /* [profile_bins][radar_bounces], relative power */
    float    *range_m;          /* +inf: sky */
    uint32_t *entity;           /* snapshot index + 1; 0: none */
    uint32_t *part, *material;  /* + 1; 0: none. part: of entities and scenery */
    uint32_t *instance;         /* plant: 1 + ForestHit.plant; low plants: forest_low_bit and a number; scenery, where
                                 * there is a part and no entity: 1 + its number of Scenery.object; 0: none. NULL where
                                 * the world has neither */
    uint8_t       *cover;       /* SurfaceClass of the ground that is seen, 0: none is */
    float         *temp_k;      /* NaN: sky */
    float         *normal[3];   /* ENU of the terrain origin */
    float         *covered;     /* share of the pixel that small targets cover; NULL: there are none */
    TargetPixels  *target;      /* [snapshot count]; NULL without truth */
    SceneryPixels *scenery;     /* [scenery_count]: clutter that is seen, by object; with truth alone */
    int            scenery_count;
    SmallTargets   small;  /* none: not requested */
    ErrorBudget   *budget; /* NULL: not requested */
    RenderCounters counters;
    RenderTimes    times;
} Picture;

/* One of the radiance planes; NULL where there is none. */
float *picture_plane(const Picture *picture, int plane);

/* A radiance plane and the channel of light that it shows. */
typedef struct PictureChannel {
    int     plane;
    Band    band;
    AirBand channel; /* the same number is the smoke's band (entities/traces/effect_puffs.h) */
} PictureChannel;

/* The channels of a request of these bands, without the radar's, in the planes' order; returns their number. */
int picture_channels(PictureChannel out[picture_radar], unsigned bands, OpticalChannels optical);
/* The channel whose smoke transmittance applies to a band; -1: none (the radar). */
int picture_smoke_channel(Band band, unsigned bands, OpticalChannels optical);
/* 1 << AirBand of all that a request of these bands needs of the air. */
unsigned render_air_bands(unsigned bands, OpticalChannels optical);
/* The band that a plane belongs to. */
Band picture_band(int plane);

/* Whether pixels are sampled again where neighbours differ. */
static inline bool looks_for_edges(const RenderRequest *request) { return request->edge_samples > request->samples; }
/* Samples a side of plants about a target, beside the first one: half as many as at edges, at least 2. */
static inline int leaf_samples(const RenderRequest *request)
{
    return request->edge_samples < 4 ? 2 : request->edge_samples / 2;
}
static inline bool   has_band(unsigned bands, Band band) { return bands >> band & 1; }
static inline size_t picture_index(const Picture *picture, int x, int y)
{
    return (size_t)y * (size_t)picture->width + (size_t)x;
}

/* Whether a pixel shows a plant: entities and scenery have parts. */
static inline bool picture_shows_plant(const Picture *picture, size_t px)
{
    return picture->instance && picture->instance[px] && !picture->part[px];
}

/* Mean squared difference of a pixel to its neighbours, left, right, above and below. */
double picture_contrast(const Picture *picture, const float *value, int x, int y);

#endif
