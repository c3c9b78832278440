/* render/frame/render.h: a picture is a pure function of (world, snapshot, request). */
#ifndef RENDER_FRAME_RENDER_H
#define RENDER_FRAME_RENDER_H

#include "render/air/air.h"
#include "render/radar/radar_image.h"
#include "render/light/thermal.h"
#include "render/scene/visibility.h"

/* What does not change between frames. */
typedef struct World {
    const Catalog   *catalog;
    const Landscape *landscape;      /* NULL: no ground */
    LocalFrame       frame;          /* whose ENU the views are in */
    Tracer          *tracer;
    Materials        materials;
    PlanckTable     *planck_mwir, *planck_lwir;
    Atmosphere      *atmosphere;     /* NULL after world_open; whoever opens one here, world_close closes it */
    RadarConfig      radar;
} World;

/* Planes that carry radiance. */
enum { picture_optical, picture_mwir = picture_optical + 3, picture_lwir, picture_radar, picture_plane_count };

/* How wrong a frame's planes are by its own account: root of the mean squared error over the picture, in the plane's
 * unit, by source. The planes are the same with and without. Where each comes from, and what it leaves out:
 * render/frame/error_budget.h; how right it is: tests/sensor/test_error_budget.c. */
typedef struct ErrorBudget {
    double mean[picture_plane_count];            /* of the plane, from the pixels that were looked at */
    double sampling[picture_plane_count];        /* rays a pixel, edges, small targets */
    double level_of_detail[picture_plane_count]; /* posts of the ground. Facets of models: sensor/truth/frame_error.h */
    double tables[picture_plane_count];          /* air and shading; radar: 0, it has none */
    int    probes;                               /* pixels looked at again */
    double ms;                                   /* wall time */
} ErrorBudget;

/* What a target gave in this view, in units of pixels: areas, which may be fractions. */
typedef struct TargetPixels {
    double visible, amodal;
    /* its own radiance at the aperture, by the area it fills, less by the cube of the cosine off the axis:
     * over focal_px^2 and times range^2 this is its intensity. px W/(m2 sr); radar: relative */
    double radiance[picture_plane_count];
    bool   small;                 /* sampled over its own box: what follows is of its samples, too */
    double mean[picture_plane_count], variance[picture_plane_count]; /* of radiance over its visible area */
    double radiance_error[picture_plane_count]; /* rms, of `radiance`; with a budget, else 0 */
    double peak_area;             /* of the pixel that it fills most */
    int    box[4], amodal_box[4]; /* first column, first row, last column + 1, last row + 1; empty: all 0 */
    bool   projected;             /* in front of the eye and its bounding sphere meets the image */
    double projected_box[4];      /* of all of it, px, not clipped to the image; where `projected` */
    double occluded_ground;       /* pixels that the ground hides, and other entities */
    double occluded_entity;
    double veiled[BAND_COUNT];    /* share of its light that smoke and dust take, mean over what is visible, 0 .. 1 */
    int    occluder;              /* snapshot index of the entity that hides most; -1 */
} TargetPixels;

/* Smaller than this one way, and than the other the other way, a target is sampled over its own box. */
enum { small_target_px = 16, small_target_long_px = 4 * small_target_px };

/* A small target as it was sampled, for what must know where within a pixel its light lies: a detector behind optics
 * (sensor/detector/subpixel.h). The cells fill the box evenly, row by row; their radiance is that at the aperture. */
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
    uint64_t rays_primary;                 /* all from the eye; of these: */
    uint64_t rays_edges, rays_small_targets;
    uint64_t pixels, pixels_refined, small_targets;
    uint64_t tiles, tiles_without_entities;
} RenderCounters;

void render_counters_add(RenderCounters *sum, const RenderCounters *more);

typedef struct RenderTimes {
    double prepare_ms, visibility_ms, shadow_ms, shade_ms, radar_ms; /* summed over threads but prepare */
    double footprints_ms, base_ms, edges_ms; /* wall times of the passes */
} RenderTimes;

/* Planes are width * height, rows top down; NULL where not asked for. All in the frame's arena.
 *
 * Truth of a pixel is that of the sample nearest its centre; of a small target where it covers more than half of the
 * pixel, and then that of the target's sample nearest the centre. */
typedef struct Picture {
    int       width, height;
    float    *optical[3];           /* R G B, or pan or near infrared in [0] alone: W/(m2 sr) */
    double    white_w_m2_sr[3];     /* R G B: of white, level ground in the open (optical_white); 0 without RGB */
    float    *mwir, *lwir;          /* W/(m2 sr) */
    float    *radar;                /* relative */
    double   *profile;              /* [profile_bins][radar_bounces], relative power */
    float    *range_m;              /* +inf: sky */
    uint32_t *entity;               /* snapshot index + 1; 0: none */
    uint32_t *part, *material;      /* + 1; 0: none */
    float    *temp_k;               /* NaN: sky */
    float    *normal[3];            /* ENU of the terrain origin */
    float    *covered;              /* share of the pixel that small targets cover; NULL: there are none */
    TargetPixels *target;           /* [snapshot count]; NULL without truth */
    SmallTargets  small;            /* none: not asked for */
    ErrorBudget  *budget;           /* NULL: not asked for */
    RenderCounters counters;
    RenderTimes    times;
} Picture;

/* One of the radiance planes; NULL where there is none. */
float *picture_plane(const Picture *picture, int plane);

/* frame: the landscape's, or any where there is none. */
Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame, const char *isa);
void   world_close(World *world);

/* How many different places along a row (or column) of a pixel an edge there is averaged over: n^2 for the turned grid
 * of n x n rays that edges get. A detector's footprint must not take them away again (sensor/detector/mtf.h). */
int render_places(int samples, int edge_samples);

/* 1 << AirBand of all that a request of these bands needs of the air. */
unsigned render_air_bands(unsigned bands, OpticalChannels optical);

/* An entity whose model is -1 keeps its place in the snapshot and is not drawn: no pixel, no shadow, no echo. */
Status render(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request,
              const Air *air, Pool *pool, Arena *arena);

#endif
