/* render/frame/frame_private.h: what the passes of a frame share, and what each of them offers the others. */
#ifndef RENDER_FRAME_FRAME_PRIVATE_H
#define RENDER_FRAME_FRAME_PRIVATE_H

#include "render/frame/picture.h"
#include "render/frame/pixel_record.h"
#include "render/frame/shade_private.h"
#include "render/frame/world.h"
#include "pitviper.h"

/* ---- pixels as blocks of samples: passes.c --------------------------------------------------- */

/* Pixels of n x n samples, all samples of a pixel together. */
typedef struct PixelBlock {
    int      n, pixels;
    int      columns;                            /* of a whole tile with n = 1: its pixels lie in rows; else 0 */
    uint16_t x[hits_capacity], y[hits_capacity]; /* of each pixel */
} PixelBlock;

static inline void pixels_add(PixelBlock *block, int x, int y)
{
    block->x[block->pixels] = (uint16_t)x;
    block->y[block->pixels++] = (uint16_t)y;
}

/* The pixel of a hit, index into x and y; and the hit's share of it. */
static inline int hit_pixel(const PixelBlock *block, const Hits *hits, int i)
{
    return hit_ray(hits, i) / (block->n * block->n);
}
static inline double hit_share(const PixelBlock *block, const Hits *hits, int i)
{
    return (double)hit_weight(hits, i) * (1.0 / (block->n * block->n));
}

/* Place of sample s of n x n in its pixel, 0 .. 1. A grid rotated by atan(1 / n), so that an edge along the rows or
 * columns is met in n^2 steps and not in n; the one sample of n = 1 is the centre. */
static inline void sample_place(double place[2], int n, int s)
{
    const int column = s % n, row = s / n;
    place[0] = (column + (row + 0.5) / n) / n;
    place[1] = (row + (n - column - 0.5) / n) / n;
}

/* view_ray for all samples, in arrays. */
void pixels_rays(Rays *rays, const PixelBlock *block, const View *view);
/* Columns and rows from, to, of all pixels. */
void pixels_box(double box_px[4], const PixelBlock *block);

/* ---- sums over targets: target_sums.c -------------------------------------------------------- */

/* Results of each target, summed over the samples of all tiles: visible and hidden areas, its occluders, its own
 * radiance; and the radar's range profile.
 *
 * Sums are integers in fixed steps, one set per worker, added at the end: independent of the order in which threads
 * finish. A share of a block's samples may be taken back (share below 0) when others join them. */

/* Areas in steps of 1 / SumRules.steps_per_px of a pixel, powers in steps of the rules' quanta. */
typedef struct TargetCount {
    int64_t visible, amodal, hidden_ground, hidden_entity, hidden_plants, hidden_scenery;
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
    Arena            *arena;                     /* where tables of pairs grow while threads run */
    int64_t           steps_per_px;
    /* fixed point: fine enough to be exact in float's terms, coarse enough that all samples of a picture at the
     * limit stay below 2^62 quanta */
    double profile_limit, profile_quantum, radiance_limit, radiance_quantum;
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

/* ---- sums over scenery: scenery_sums.c ------------------------------------------------------- */

/* What a worker's samples showed of an object: in integers and extremes, independent of the order of threads. */
typedef struct ScenerySum {
    uint32_t instance; /* of Hits; 0: a free slot */
    int64_t  steps;    /* area, in steps; what small targets cover is left out */
    int      box[4];
    double   nearest_m;
    float    hottest_k; /* -INFINITY: not known */
} ScenerySum;

/* Every object that a worker met: a growing hash table. */
typedef struct ScenerySums {
    ScenerySum *slot; /* [capacity] */
    size_t      capacity, used;
    bool        lost; /* out of memory: the sums are incomplete */
} ScenerySums;

Status target_sums_create(TargetSums *out, int entities, int profile_bins, Arena *arena);
/* Steps and quanta for a request. */
void sum_rules_choose(SumRules *rules, const RenderRequest *request, const RadarConfig *radar);

/* cos^3 of the angle off the axis at a pixel's centre: what its solid angle has less than 1 / focal_px^2. */
double pixel_cosine3(const View *view, int x, int y);

/* A block's samples, and the share of its pixels' areas that they are to count for. */
typedef struct SharedBlock {
    const Samples    *samples;
    const PixelBlock *block;
    double            share;
} SharedBlock;

/* A sample's area in steps, which divide by every share, and the part of it that no small target covers. */
int64_t target_sums_steps(int64_t *seen, const SumRules *rules, const SharedBlock *of, size_t px);
/* The block's scenery: areas, of samples as they were shot, and temperatures, once they are known. */
void scenery_sums_area(ScenerySums *sums, const SumRules *rules, const SharedBlock *of);
void scenery_sums_heat(ScenerySums *sums, const SumRules *rules, const Samples *s);
/* All workers' clutter that is seen into the picture, by object. STATUS_NO_MEMORY. */
Status scenery_sums_gather(Picture *picture, const SumRules *rules, const ScenerySums *const *sums, int workers,
                           const Scenery *scenery, Arena *arena);
/* The visible and amodal area of the listed entities: all that the block can show. */
void target_sums_areas(TargetSums *sums, const SumRules *rules, const SharedBlock *of, const int *list, int listed,
                       VisibilityCounters *counters);
/* The block's radiance of a plane, weighted by area, to the targets that it shows. target_sums_view comes first. */
void target_sums_view(TargetSums *sums, const PixelBlock *block, const View *view);
void target_sums_radiance(TargetSums *sums, const SumRules *rules, const Hits *hits, const PixelBlock *block,
                          double share, const float *value, int plane);
/* Radar returns of samples of these areas (px; below 0: taken back) to the range profile. */
void target_sums_profile(TargetSums *sums, const SumRules *rules, const RenderRequest *request, const Samples *s,
                         const double *area_px);

/* The sums of a frame over all its samples, as its workers left them. */
typedef struct WorkerSums {
    const TargetSums *const *sums; /* [workers] */
    int                      workers, entities, profile_bins;
    const TargetPixels      *boxes; /* [entities]: where the targets lie */
} WorkerSums;

/* Adds all workers' sums into the picture: targets, their occluders, and the profile. STATUS_NO_MEMORY. */
Status target_sums_gather(Picture *picture, const SumRules *rules, const WorkerSums *of, Arena *arena);

/* ---- passes: passes.c ------------------------------------------------------------------------ */

/* The data and steps that the passes of a frame share.
 *
 * A frame is rendered in passes over a thread pool, each made of tasks that write to separate memory:
 *   boxes          every entity's box on the image                         target_sums.c
 *   small targets  each sampled on a grid over its own box                 target_grid.c
 *   base           every pixel, without the small targets                  passes.c
 *   fill           at cheaper steps of sampling, pixels without rays       sampling.c
 *   edges          pixels whose neighbours differ, with more rays          edges.c selects, refine.c samples
 *                  pixels on narrow hot parts of clutter, too              hot_parts.c
 *   leaves         pixels of plants, smoothed among themselves              leaf_filter.c
 *   composite      the small targets, over the pixels                      target_grid_picture.c
 *   error estimate a few pixels, re-sampled                                error_estimate.c, plant_price.c
 * Each of them shades samples (shade.h) and sums the results in its own way; render.c runs them in turn. */

enum { tile_side_samples = 32 };

/* Working memory of a thread. */
typedef struct Worker {
    Shader         shader;
    Samples        samples;
    PixelBlock     block; /* base and edges, error estimate */
    TargetSums     sums;
    ScenerySums    scenery;
    RenderCounters counters; /* without visibility, which is in shader.counters */
    int           *list;     /* [snapshot count]: entities */
    int           *outline;  /* [snapshot count]: those whose areas are sampled again */
    int           *volume;   /* [volumes of the effects] */
    uint64_t       key[hits_capacity];
    double         area_px[hits_capacity];
    uint8_t        meets[hits_capacity];
    EntityHits     known;
    ShadeTerms    *terms; /* NULL: no pixel is recorded */
    Hits           hits;  /* before some of them are removed or split */
    Rays           rays;
} Worker;

typedef struct TargetGrid TargetGrid; /* a small target: frame_private.h */

/* Inputs and outputs of the passes of one frame. */
typedef struct Job {
    const RenderRequest *request;
    ShadeScene           scene;
    Picture             *picture;                /* truth planes where requested or where edges are looked for */
    PictureChannel       channel[picture_radar]; /* [channels] of the request */
    int                  channels;
    Worker             **worker;
    int                  side_px, tiles_x, tiles_y;
    SumRules             rules;
    TargetPixels        *boxes;    /* [snapshot count]: projected and projected_box only */
    bool                *is_small; /* [snapshot count]: sampled on its own grid; the pixels' samples do not see it */
    /* small targets */
    int         grid_side; /* cells a side of a grid at least: target_samples, or as many as fit */
    TargetGrid *footprint; /* [small targets], by entity */
    int         footprints;
    int        *target_grid_order; /* [small targets]: the order in which they are sampled */
    float      *before;            /* [pixels]: share of what hides small targets, which their grids know */
    int32_t    *coverer;           /* [pixels]: snapshot index of the small target that covers most; valid where
                                    * any does */
    double target_variance[picture_plane_count]; /* squared errors over the pixels, summed */
    /* edges; NULL: not looked for */
    uint8_t *refine;   /* a pixel: RefineFlag */
    uint8_t *hot;      /* a pixel: 1, hot_samples a side where refine_all is set; NULL: none */
    float   *sun;      /* a pixel: Samples.sun of the sample that truth is of */
    uint8_t *whole;    /* a pixel: 1, it has its rays at every step of sampling (sampling.c); NULL: all have */
    float  **smoothed; /* [channels]: each plane's pixels, smoothed (leaf_filter.c); NULL: they are not */
    bool    *leafy;    /* [tiles]: some plant is in or beside it */
    double (*law)[picture_plane_count]; /* [tiles]: squared errors, summed; NULL: no error estimate */
} Job;

typedef struct Tile {
    int x0, y0, x1, y1; /* px */
} Tile;

/* The pixels of a task. */
Tile                 tile_of(const Job *job, int task);
static inline size_t pixel_index(const Job *job, int x, int y) { return picture_index(job->picture, x, y); }

/* Entities that samples within a box of the image may see, into worker->list; without `small_ones` small targets are
 * left to their grids. Returns their number. */
int list_entities(Worker *w, const Job *job, const double box_px[4], bool small_ones);
/* Channels that the samples need: those of `bands`. */
void ask_bands(Worker *w, const Job *job, unsigned bands);
/* Smoke that samples within a box of the image may meet. */
void ask_smoke(Worker *w, const Job *job, const double box_px[4]);

/* Eye rays of the block's pixels, in the channels of `bands`, and what they meet. */
void block_trace(Worker *w, const Job *job, unsigned bands, int listed);
/* Light of the block's hits. */
void block_light(Worker *w, const Job *job);
/* Adds a share of the block's contribution to the sums of the targets and of the range profile; below 0: takes it back.
 */
void block_add(Worker *w, const Job *job, double share);
/* A share of the areas of the listed targets to the sums. */
void block_add_areas(Worker *w, const Job *job, double share, const int *list, int listed);
/* The block's means into the planes of its channels, with this share; the rest is what they hold. */
void block_write(Worker *w, const Job *job, double share);
/* Array of a plane's values at the block's samples; NULL: not requested. */
float *block_values(const Worker *w, const Job *job, int plane);

/* The worker's block of a tile's pixels, with the sample count that all have: planes and truth. They count in no sum.
 */
void base_others(Worker *w, const Job *job, const Tile *tile);
/* The base pass, with the sample count that all pixels have: a pool task: planes, truth and sums of a tile. */
void base_tile(void *job, int worker, int task);

/* ---- pixels without rays of their own: sampling.c --------------------------------------------- */

/* Marks what is whole. After mark_boxes. */
void sampling_mark(Job *job);
/* Marks the pixels of a tile that look through smoke, flames or hot gas. In the base pass. */
void sampling_mark_smoke(Worker *w, Job *job, const Tile *tile);
/* Whether a pixel has rays of its own in the base pass. */
bool sampling_traces(const Job *job, int x, int y);
/* After the base pass: whether it shows the mean of those beside it, and no ray of its own. */
bool sampling_fills(const Job *job, int x, int y);
/* A pool task, after the base pass: fills a tile's other pixels from those beside them, or traces them. */
void sampling_fill_tile(void *job, int worker, int task);

/* ---- pixels that one sample does not represent: edges.c -------------------------------------- */

/* Refinement that a pixel needs. What only the shadow-sensitive bands need must not affect the others, whose bits
 * would then depend on the requested bands; and bare ground must stay cheap. */
typedef enum RefineFlag {
    refine_all = 1,      /* edge_samples a side, every band */
    refine_step = 2,     /* 2 a side, each split by ground class; every band: a crest of the ground, the horizon */
    refine_sun = 4,      /* edge_samples a side, optical and MWIR: the edge of a shadow */
    refine_ground = 8,   /* the plane of the existing hit, split by ground class, no ray; not the radar */
    refine_plants = 16,  /* leaf_samples a side, which join the first one; every band: plants about a target */
    refine_leaves = 32,  /* a mark: plants are refined here */
    refine_scenery = 64, /* 2 a side, which join the first one; every band: borders of scenery */
    refine_shade = 128,  /* 2 a side, which join the first one, optical and MWIR: edges of shadows amid scenery */
    refine_hot = 256,    /* with refine_all, of Job.hot and in no plane of flags: hot_samples a side, or edge_samples */
} RefineFlag;
enum { hot_samples = 8 };

/* Marks what is always refined: bounding boxes of medium-sized targets, and the ground where a target's shadow
 * falls; and where plants are refined. After the target grids. */
void mark_boxes(Job *job);
/* Marks the pixels on hot parts of clutter that are narrow on the image: exhausts of engines that run or stopped
 * lately, and what burns (hot_parts.c). STATUS_NO_MEMORY. */
Status mark_hot_parts(Job *job, Arena *arena);
/* The flags of a tile's pixels, row by row, including those marked. Reads the truth planes and the plane of
 * sunlight. */
void refine_flags(uint8_t flags[hits_capacity], const Job *job, const Tile *tile);
/* The block's pixels, with rays, hits and sun restored from the planes; all hits are ground; n is 1. */
void recall_ground(Worker *w, const Job *job);

/* ---- samples that cover several ground classes: ground_mix.c --------------------------------- */

enum {
    ground_mix_places = 256, /* most points a sample at which the class is looked up */
    ground_mix_most = 4,     /* most classes that a sample is split into */
    corner_capacity = (tile_side_samples + 1) * (tile_side_samples + 1),
    material_unknown = 0xffff,
};

/* Materials of the ground at the wanted corners of a tile's pixels, one column and one row more than it has pixels;
 * material_unknown where the pixel right and below shows no ground. Reads the truth planes. */
void corner_materials(uint16_t out[corner_capacity], const Job *job, const Tile *tile,
                      const bool wanted[corner_capacity]);
/* Whether one of the four corners from `corner` on is of another material than that. columns: corners a row. */
bool corners_differ(const uint16_t *corner, int columns, uint32_t material);
/* Splits the block's samples of ground by the surface classes within their squares of 1 / n px, several returns each:
 * looked up at side x side points, at most `most` classes kept. hits.count x most <= hits_capacity; side <= 16,
 * most <= ground_mix_most. */
void split_ground(Worker *w, const Job *job, int side, int most);

/* Pixels at edges, sampled again. */

/* A pool task: selects the pixels of a tile to refine (edges.h), and samples them. */
void refine_tile(void *job, int worker, int task);
/* After the edges: the planes (1 << plane) whose error at a pixel cannot be estimated from its own samples. */
unsigned planes_to_resample(const Job *job, size_t px);

/* Radiance of plants, smoothed from pixel to pixel.
 *
 * One sample a pixel shows one leaf, lit or shaded, or the ground in a gap: it has more contrast than the pixel's mean.
 * Neighbouring samples know more of that mean than a single one does: the weighted mean over 3 x 3 pixels (11 parts for
 * the pixel, 2 for those beside it, 1 for those at its corners) of those that show plants, or ground beside a plant. It
 * costs no ray. Beside 144 rays a pixel, in three frames of the demonstration: rms 15 % of the mean in red (23 %
 * smoothed among leaves alone), 3.7 and 1.9 % in 3.4-4.8 and 8-12 um, deviations 0.99, 1.01 and 1.02 of the true ones;
 * where a pixel is far larger than a leaf the deviation stays too large (tests/render/test_leaf_filter.c). The radar's
 * picture keeps its own samples. */

/* Memory for it where the picture has plants, one sample a pixel, and edges that are refined: Job.smoothed.
 * STATUS_NO_MEMORY. */
Status leaf_filter_prepare(Job *job, Arena *arena);
/* After the edges: smooths those pixels that were not refined. */
void leaf_filter(Job *job, Pool *pool);

/* Where targets lie on the image. */

/* A pool task: the whole box of entity `index`, into Job.boxes. */
void project_target(void *job, int worker, int index);

/* Targets that are small on the image, each sampled on a grid over its own box. */

/* Selects the small targets and allocates their grids. */
Status target_grids_plan(Job *job, Arena *arena);
/* A pool task: samples one grid. */
void target_grid_task(void *job, int worker, int index);
/* After all tasks: whether an entity has a grid, all of which is hidden. */
bool target_grid_hidden(const Job *job, int entity);
/* After all tasks: the pixels that the grids cover. */
void target_grids_cover(Job *job);
/* Errors of every grid, from its samples' variance, before compositing: into Job.target_variance and the targets. */
void target_grids_error(Job *job);
/* Composites the grids over the finished pixels, in order of entity. */
void target_grids_composite(Job *job);
/* Their areas and radiance into the picture's targets, after target_sums_gather. */
void target_grids_sample(const Job *job);

/* ---- the record of a pixel: pixel_notes.c; its meaning: pixel_record.h ---------------------------- */

/* Whether a block has the pixel that is recorded, if any is. */
bool record_wants(const Job *job, const PixelBlock *block);
/* What block_write does to that pixel, before it does. */
void record_block(const Worker *w, const Job *job, double share);
/* Cells of a small target that lie on it, once they are lit: of the target, or of what hides it. From any thread. */
void record_cells(const TargetGrid *f, const Worker *w, const Job *job, const int *cell, PixelStepKind kind);
/* A step of the composite. */
void record_composite(const Job *job, PixelStepKind kind, int entity, double share);
/* Weights of 3 x 3 pixels about it, before any is replaced. */
void record_smoothed(const Job *job, const float weight[9]);
/* Whether a small target's box has the pixel that is recorded, if any is. */
static inline bool record_in_box(const Job *job, int x0, int y0, int x1, int y1)
{
    const PixelRecord *r = job->request->record;
    return r && r->x >= x0 && r->x < x1 && r->y >= y0 && r->y < y1;
}

/* ---- the error estimate: error_estimate.c; its meaning: render.h ----------------------------- */

/* The last pass: fills picture->budget. STATUS_NO_MEMORY. */
Status error_estimate(const Job *job, Pool *pool, Arena *arena);
/* Where plants are simplified, or met in tables: what that costs. STATUS_NO_MEMORY. */
Status plant_price(PlantPrice *out, const Job *job, Pool *pool, Arena *arena);

/* ---- a small target: target_grid.c samples it, target_grid_picture.c composites it ----------- */

/* The target's sample nearest the centre of a pixel. */
typedef struct TargetGridTruth {
    double   square_px; /* of its distance */
    float    range_m, temp_k, normal[3];
    uint16_t part, material;
} TargetGridTruth;

struct TargetGrid {
    int     entity;                   /* snapshot index */
    double  box[4];                   /* of all its vertices, px */
    int     columns, rows;            /* cells; 0: seen edge-on, nothing to sample */
    int     x0, y0, x1, y1;           /* pixels that it may touch */
    double *sum[picture_plane_count]; /* of area x radiance, a pixel [(y1 - y0) (x1 - x0)] */
    double *area;                     /* px, a pixel */
    double *before_sum[picture_plane_count],
        *before;            /* the same of what hides the target, a pixel that shows some of it */
    TargetGridTruth *truth; /* [pixels]; NULL: not needed */
    /* over the target, px within the image */
    double visible, amodal, hidden_ground, hidden_entity, hidden_plants, hidden_scenery;
    double veiled[BAND_COUNT];          /* area x the share that smoke absorbs */
    double square[picture_plane_count]; /* area x radiance^2 */
    float *cell[picture_plane_count];   /* radiance of each; NULL: neither needed for the budget nor for a detector */
    float *behind[picture_plane_count]; /* [pixels], before small targets are composited; NULL: not needed for a
                                         * detector */
    bool *met;                          /* cells that show the target */
    int   amodal_box[4];
};

/* The pixels that a cell overlaps: no more than two each way, since cells are no larger than a pixel. */
enum { shares_most = 9 };
typedef struct CellShares {
    int    count, pixel[shares_most], x[shares_most], y[shares_most];
    double area[shares_most]; /* px */
} CellShares;
void target_grid_shares(CellShares *out, const TargetGrid *f, int cell);

/* The first and last pixels, of a box that is all 0 at first. */
static inline void grow_pixel_box(int box[4], int x, int y)
{
    box[0] = box[2] == 0 || x < box[0] ? x : box[0];
    box[1] = box[3] == 0 || y < box[1] ? y : box[1];
    box[2] = x + 1 > box[2] ? x + 1 : box[2];
    box[3] = y + 1 > box[3] ? y + 1 : box[3];
}

#endif
