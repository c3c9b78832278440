/* render/frame/passes.h: the data and steps that the passes of a frame share.
 *
 * A frame is rendered in passes over a thread pool, each made of tasks that write to separate memory:
 *   boxes          every entity's box on the image                         target_boxes.c
 *   small targets  each sampled on a grid over its own box                 target_grid.c
 *   base           every pixel, without the small targets                  base.c
 *   edges          pixels whose neighbours differ, with more rays          edges.c selects, refine.c samples
 *   leaves         pixels of plants, smoothed among themselves              leaf_filter.c
 *   composite      the small targets, over the pixels                      target_grid_picture.c
 *   error estimate a few pixels, re-sampled                                error_budget.c
 * Each of them shades samples (shade.h) and sums the results in its own way; render.c runs them in turn. */
#ifndef RENDER_FRAME_PASSES_H
#define RENDER_FRAME_PASSES_H

#include "render/frame/pixels.h"
#include "render/frame/shade.h"
#include "render/frame/target_sums.h"
#include "render/frame/world.h"

enum { tile_side_samples = 32 };

/* Working memory of a thread. */
typedef struct Worker {
    Shader         shader;
    Samples        samples;
    PixelBlock     block;   /* base and edges, error estimate */
    TargetSums     sums;
    RenderCounters counters; /* without visibility, which is in shader.counters */
    int           *list;    /* [snapshot count]: entities */
    int           *outline; /* [snapshot count]: those whose areas are sampled again */
    int           *volume;  /* [volumes of the effects] */
    uint64_t       key[hits_capacity];
    double         area_px[hits_capacity];
    uint8_t        meets[hits_capacity];
    EntityHits     known;
    Hits           hits;    /* before some of them are removed or split */
    Rays           rays;
} Worker;

typedef struct TargetGrid TargetGrid; /* a small target: target_grid.h */

/* Inputs and outputs of the passes of one frame. */
typedef struct Job {
    const RenderRequest *request;
    ShadeScene           scene;
    Picture             *picture; /* truth planes where requested or where edges are looked for */
    PictureChannel       channel[picture_radar]; /* [channels] of the request */
    int                  channels;
    Worker             **worker;
    int                  side_px, tiles_x, tiles_y;
    SumRules             rules;
    TargetPixels        *boxes;     /* [snapshot count]: projected and projected_box only */
    bool                *is_small;  /* [snapshot count]: sampled on its own grid; the pixels' samples do not see it */
    /* small targets */
    int                  grid_side;  /* cells a side of a grid at least: target_samples, or as many as fit */
    TargetGrid           *footprint; /* [small targets], by entity */
    int                  footprints;
    int                 *target_grid_order; /* [small targets]: the order in which they are sampled */
    float               *before;    /* [pixels]: share of what hides small targets, which their grids know */
    int32_t             *coverer;   /* [pixels]: snapshot index of the small target that covers most; valid where
                                     * any does */
    double               target_variance[picture_plane_count]; /* squared errors over the pixels, summed */
    /* edges; NULL: not looked for */
    uint8_t             *refine;    /* a pixel: RefineFlag */
    float               *sun;       /* a pixel: Samples.sun of the sample that truth is of */
    float              **smoothed; /* [channels]: each plane's pixels, smoothed (leaf_filter.h); NULL: they are not */
    bool                *leafy;    /* [tiles]: some plant is in or beside it */
    double             (*law)[picture_plane_count]; /* [tiles]: squared errors, summed; NULL: no error estimate */
} Job;

typedef struct Tile {
    int x0, y0, x1, y1; /* px */
} Tile;

/* The pixels of a task. */
Tile tile_of(const Job *job, int task);
static inline size_t pixel_index(const Job *job, int x, int y) { return picture_index(job->picture, x, y); }

/* Entities that samples within a box of the image may see, into worker->list; without `small_ones` small targets are
 * left to their grids. Returns their number. */
int  list_entities(Worker *w, const Job *job, const double box_px[4], bool small_ones);
/* Channels that the samples need: those of `bands`. */
void ask_bands(Worker *w, const Job *job, unsigned bands);
/* Smoke that samples within a box of the image may meet. */
void ask_smoke(Worker *w, const Job *job, const double box_px[4]);

/* Eye rays of the block's pixels, in the channels of `bands`, and what they meet. */
void block_trace(Worker *w, const Job *job, unsigned bands, int listed);
/* Light of the block's hits. */
void block_light(Worker *w, const Job *job);
/* Adds a share of the block's contribution to the sums of the targets and of the range profile; below 0: takes it back. */
void block_add(Worker *w, const Job *job, double share);
/* A share of the areas of the listed targets to the sums. */
void block_add_areas(Worker *w, const Job *job, double share, const int *list, int listed);
/* The block's means into the planes of its channels, with this share; the rest is what they hold. */
void block_write(Worker *w, const Job *job, double share);
/* Array of a plane's values at the block's samples; NULL: not requested. */
float *block_values(const Worker *w, const Job *job, int plane);

#endif
