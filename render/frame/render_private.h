/* render/frame/render_private.h: what the files of one frame share: blocks of samples, footprints of small targets, sums.
 *
 * A frame goes in passes over a pool, each of tasks that write to places of their own:
 *   boxes       every entity's box on the image                          render_targets.c
 *   footprints  small targets, sampled over their own boxes              footprint.c
 *   base        every pixel, small targets taken away                    render.c
 *   edges       pixels whose neighbours disagree, again with more rays   edges.c decides, refine.c shades
 *   put on      the footprints, over the pixels                          footprint.c
 * What is summed over tiles (pixels on target, radiance of targets, the range profile) is summed in integers, so the
 * order in which threads finish cannot show. */
#ifndef RENDER_FRAME_RENDER_PRIVATE_H
#define RENDER_FRAME_RENDER_PRIVATE_H

#include "render/smoke/effects.h"
#include "render/light/gather.h"
#include "render/light/sky_visibility.h"
#include "render/light/surface_light.h"
#include "render/frame/render.h"

enum { tile_side_samples = 32, pairs_per_tile = 16 };

/* ---- a block of samples ---------------------------------------------------------------------- */

typedef struct Footprint Footprint;
typedef struct ProbeTask ProbeTask;

/* Pixels of n x n samples, all samples of a pixel together; or the cells of a footprint that met their target. */
typedef struct Block {
    int      n, pixels;
    int      columns;                          /* of a whole tile with n = 1: its pixels lie in rows; else 0 */
    int      sign;                             /* -1: takes back from the sums what these samples gave before */
    bool     writes;                           /* into the planes */
    unsigned bands;                            /* 1 << Band: those to shade */
    uint16_t x[hits_capacity], y[hits_capacity]; /* of each pixel */
    Footprint *footprint;                      /* NULL: pixels */
    ProbeTask *probe;                          /* not NULL: pixels looked at again, for the budget; into no plane */
    int      cell[hits_capacity];              /* of each sample of a footprint: row * columns + column */
    /* after split_ground: samples are no longer n x n a pixel but as many as it shows kinds of ground */
    bool     split;
    uint16_t pixel_of[hits_capacity];          /* of each sample: index into x and y */
    float    part_of[hits_capacity];           /* of each sample: its part of its pixel, 0 .. 1 */
} Block;

/* The pixel that a sample belongs to: index into Block.x and y; and its part of it. */
static inline int sample_pixel(const Block *block, int sample)
{
    return block->split ? block->pixel_of[sample] : sample / (block->n * block->n);
}
static inline double sample_part(const Block *block, int sample)
{
    return block->split ? (double)block->part_of[sample] : 1.0 / (block->n * block->n);
}

/* Place of sample s of n x n in its pixel, 0 .. 1. A grid turned by atan(1 / n), so that an edge along the rows or
 * columns is met in n^2 steps and not in n; the one sample of n = 1 is the centre. */
static inline void sample_place(double place[2], int n, int s)
{
    const int column = s % n, row = s / n;
    place[0] = (column + (row + 0.5) / n) / n;
    place[1] = (row + (n - column - 0.5) / n) / n;
}

/* ---- sums over samples ----------------------------------------------------------------------- */

/* Areas in steps of 1 / Job.steps_per_px of a pixel, powers in steps of the job's quanta. */
typedef struct TargetCount {
    int64_t visible, amodal, hidden_ground, hidden_entity;
    int64_t radiance[picture_plane_count];
    int64_t veiled[BAND_COUNT]; /* area times the share of its light that the veil takes */
    int     box[4], amodal_box[4];
} TargetCount;

typedef struct HiddenBy {
    bool    used;
    int     target, occluder; /* snapshot indices */
    int64_t area;
} HiddenBy;

typedef struct Scratch {
    Block          block;
    Rays           rays, some;
    Hits           hits, all;
    RadarReturns   radar;
    float          radiance[AIR_BAND_COUNT][hits_capacity], temp_k[hits_capacity];
    float         *out;                                           /* the band that is being given to its planes */
    float          texture[optical_channel_count][hits_capacity]; /* relative brightness of the ground, a channel */
    float          footprint_m[hits_capacity];    /* of a sample along the ground */
    uint16_t       material[hits_capacity];
    uint8_t        shadow[hits_capacity], meets[hits_capacity];
    Gathered       gathered; /* with sky_samples only */
    SkyWorker     *sky;      /* NULL: the tilt alone counts */
    SkyOpen        open;
    bool           any_open; /* the block's hits have factors */
    int            some_index[hits_capacity];
    double         cosine3[hits_capacity]; /* of the block's pixels, where truth is wanted */
    VeilRays       veil;
    Veils          air[AIR_BAND_COUNT]; /* of the block's bands */
    int           *veil_list; /* [volumes of the effects] */
    int           *list;    /* [snapshot count] */
    TargetCount   *target;  /* [snapshot count] */
    int64_t       *profile; /* [profile_bins][radar_bounces] */
    RenderCounters counters;
    double         visibility_s, shadow_s, shade_s, radar_s;
    double        *law;     /* [picture_plane_count]: squared errors of the block's pixels go there; NULL: not wanted */
} Scratch;

/* Error of a mean over n x n samples, squared, by the squared differences d of neighbours among them: mean_law sum d^2 /
 * n^4. 0.09: of our turned grid against half planes at all angles and places it is 0.115 for n = 2, 0.093, 0.087, 0.085
 * for 3, 4, 6 and 0.106 for 16 (tests/render/test_error_law.c). */
static const double mean_law = 0.09;

typedef struct Job {
    const World         *world;
    const Snapshot      *snapshot;
    const RenderRequest *request;
    const Air           *air;
    const Visibility    *visibility;
    EffectScene          effects;   /* smoke, dust, flames and bursts */
    SurfaceLight          surface_light;
    SkyVisibility        *sky;       /* NULL: the tilt alone counts */
    Picture             *picture;   /* truth planes where asked for or where edges are looked for */
    Scratch            **scratch;   /* a worker */
    HiddenBy            *pairs;     /* [tiles][pairs_per_tile] */
    int                  side_px, tiles_x, tiles_y;
    TargetPixels        *boxes;     /* [snapshot count]: projected and projected_box only */
    Footprint           *footprint; /* [footprints], by entity */
    int                  footprints;
    int                 *footprint_turn; /* [footprints]: in which order they are sampled */
    bool                *is_small;  /* [snapshot count]: left to its footprint; pixels do not see it */
    /* planes; NULL: none wanted */
    int32_t             *coverer;   /* snapshot index of the small target that covers most; where any does */
    uint8_t             *refine;    /* RefineFlag */
    uint8_t             *shadow;    /* of the sample that truth is of */
    double             (*law)[picture_plane_count];          /* [tiles]: Scratch.law; NULL: no budget */
    double               footprint_law[picture_plane_count]; /* squared errors over the pixels, summed */
    int64_t              steps_per_px;
    /* fixed point: fine enough to be exact in float's terms, coarse enough that all samples of a picture at the
     * limit stay below 2^62 quanta */
    double               profile_limit, profile_quantum, radiance_limit, radiance_quantum;
} Job;

static inline bool has_band(unsigned bands, Band band) { return bands >> band & 1; }
static inline bool looks_for_edges(const RenderRequest *request) { return request->edge_samples > request->samples; }
static inline size_t pixel_index(const Job *job, int x, int y)
{
    return (size_t)y * (size_t)job->picture->width + (size_t)x;
}

/* cos^3 of the angle off the axis at a pixel's centre: what its solid angle has less than 1 / focal_px^2. */
double pixel_cosine3(const View *view, int x, int y);

/* ---- render.c -------------------------------------------------------------------------------- */

typedef struct Tile {
    int x0, y0, x1, y1; /* px */
} Tile;

/* view_ray for all samples, in arrays. */
void make_rays(Rays *rays, const Block *block, const View *view);
/* What stands in the air before the block's hits. */
void trace_veils(Scratch *s, const Job *job);
/* Eye rays of the block's pixels, and what they meet. */
void trace_block(Scratch *s, const Job *job, int listed);
/* Entities that a tile's own samples may see: small targets are left to their footprints. */
int  list_entities(Scratch *s, const Job *job, const Tile *tile);
/* The pixels of a task. */
Tile tile_of(const Job *job, int task);

/* Eye rays of the block's pixels, what they meet, and shade_block. pairs NULL: areas of targets are not counted. */
void render_block(Scratch *s, const Job *job, int listed, HiddenBy *pairs);
/* Rays to the sun from the block's hits, where one of its bands shows shadows. */
void trace_shadows(Scratch *s, const Job *job);
/* Shades the block's hits in its bands, and gives each result to its pixels or its footprint. */
void shade_block(Scratch *s, const Job *job);
/* Share of a sample's light that the block's veil takes in a band, 0 .. 1; 0 for the radar. */
double veil_taken(const Scratch *s, const Job *job, Band band, int sample);

/* ---- refine.c -------------------------------------------------------------------------------- */

/* A pool task: decides what a tile's pixels deserve (edges.c), and does it. */
void refine_tile(void *job, int worker, int task);

/* ---- render_targets.c ------------------------------------------------------------------------ */

/* Whole box of entity `index` on the image; a pool task. */
void project_target(void *job, int worker, int index);
/* Visible and amodal area of every entity that the block can show. */
void count_targets(Scratch *s, const Job *job, int listed, HiddenBy *pairs);
/* The block's own radiance, weighted by area, to the targets that it shows. */
void add_radiance(Scratch *s, const Job *job, int plane);
/* Sums over workers and footprints, into the picture. */
void gather(Job *job, int workers);

/* ---- edges.c --------------------------------------------------------------------------------- */

/* What a pixel deserves. What only the bands that show shadows see must not touch the others, whose bits would then
 * depend on what else is asked for; and bare ground must stay cheap. */
typedef enum RefineFlag {
    refine_all    = 1, /* edge_samples a side, every band */
    refine_step   = 2, /* 2 a side, each by kinds of ground; every band: a crest of the ground, the horizon */
    refine_sun    = 4, /* edge_samples a side, optical and MWIR: the edge of a shadow */
    refine_ground = 8, /* the plane of the hit there is, by kinds of ground, no ray; not the radar */
} RefineFlag;

/* Marks what must be refined whoever stands beside it: boxes of targets of middling size, and where a target's
 * shadow falls. */
void mark_boxes(Job *job);
/* The flags of a tile's pixels, row by row, those marked included. Reads the truth planes and the shadow plane. */
void refine_flags(uint8_t flags[hits_capacity], const Job *job, int x0, int y0, int x1, int y1);
/* The block's pixels as their planes say what their hits were, which are of ground: rays, hits and shadow; n is 1. */
void recall_ground(Scratch *s, const Job *job);

/* ---- ground_mix.c ----------------------------------------------------------------------------- */

enum {
    ground_mix_places = 256,  /* most places a sample at which the class is asked */
    ground_mix_most   = 4,    /* most classes that a sample is split into */
    corner_capacity   = (tile_side_samples + 1) * (tile_side_samples + 1),
    material_unknown  = 0xffff,
};

/* Materials of the ground at the corners of the pixels x0 .. x1 - 1, y0 .. y1 - 1, (x1 - x0 + 1) a row; material_unknown
 * where the pixel right and below shows no ground. Reads the truth planes. */
void corner_materials(uint16_t out[corner_capacity], const Job *job, int x0, int y0, int x1, int y1);
/* Whether one of the four corners from `corner` on is of another material than that. columns: corners a row. */
bool corners_differ(const uint16_t *corner, int columns, uint32_t material);
/* Splits the block's samples of ground by the surface classes within their squares of 1 / n px: side x side places are
 * asked, at most `most` classes kept. hits.count x most <= hits_capacity; side <= 16, most <= ground_mix_most. */
void split_ground(Scratch *s, const Job *job, int side, int most);

/* ---- footprint.c ----------------------------------------------------------------------------- */

/* Which targets are small, and room for their footprints. */
Status footprints_plan(Job *job, Arena *arena);
void   footprint_task(void *job, int worker, int index);
/* After all tasks: which pixels they cover. */
void   footprints_cover(Job *job);
/* Gives the block's samples of a plane (s->out) to its footprint. */
void   footprint_splat(Scratch *s, int plane);
/* All that its samples may meet, px: columns and rows from, to. */
void   footprint_box(double box_px[4], const Footprint *f);
/* One number for each cell of each entity: what random choices for a sample hang on; none is a pixel's. */
uint64_t footprint_key(const Footprint *f, int cell);
/* Area of a sample within the image, px. */
double footprint_area(const Footprint *f, int cell);
/* Of every footprint, by the law, before they are put on: into Job.footprint_law and the targets. */
void   footprints_error(Job *job);
/* Over the finished pixels, in order of entity. */
void   footprints_put_on(Job *job);
void   footprints_gather(const Job *job);

/* ---- error_budget.c -------------------------------------------------------------------------- */

/* Mean squared difference of a pixel to its neighbours, left, right, above and below. */
double plane_contrast(const Picture *picture, const float *value, int x, int y);

/* Where one block's probes give a plane (s->out). */
void   probe_take(Scratch *s, const Job *job, int plane);
/* A plane of the block's pixels, n x n samples each, to Scratch.law. */
void   law_take(Scratch *s, const Job *job, int plane);
/* After everything else: fills picture->budget. STATUS_NO_MEMORY. */
Status error_budget(Job *job, Pool *pool, Arena *arena);

#endif
