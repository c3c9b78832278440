/* render/frame/passes.h: what the passes of a frame share.
 *
 * A frame goes in passes over a pool, each of tasks that write to places of their own:
 *   boxes          every entity's box on the image                         target_boxes.c
 *   small targets  sampled over their own boxes                            footprint.c
 *   base           every pixel, small targets taken away                   base.c
 *   edges          pixels whose neighbours disagree, with more rays        edges.c decides, refine.c samples
 *   put on         the small targets, over the pixels                      footprint_picture.c
 *   error estimate a few pixels, looked at again                           error_budget.c
 * Each of them has samples shaded (shade.h) and adds the results up in its own way; render.c runs them in turn. */
#ifndef RENDER_FRAME_PASSES_H
#define RENDER_FRAME_PASSES_H

#include "render/frame/pixels.h"
#include "render/frame/shade.h"
#include "render/frame/target_sums.h"
#include "render/frame/world.h"

enum { tile_side_samples = 32 };

/* A thread's own. */
typedef struct Worker {
    Shader         shader;
    Samples        samples;
    PixelBlock     block;   /* base and edges, error estimate */
    TargetSums     sums;
    RenderCounters counters; /* but visibility: shader.counters */
    int           *list;    /* [snapshot count]: entities */
    int           *volume;  /* [volumes of the effects] */
    uint64_t       key[hits_capacity];
    double         area_px[hits_capacity];
    uint8_t        meets[hits_capacity];
    Hits           hits;    /* before some of them are taken, or split */
    Rays           rays;
} Worker;

typedef struct TargetGrid TargetGrid; /* a small target: footprint.h */

/* What the passes of one frame read and write. */
typedef struct Job {
    const RenderRequest *request;
    ShadeScene           scene;
    Picture             *picture; /* truth planes where asked for or where edges are looked for */
    PictureChannel       channel[picture_radar]; /* [channels] of the request */
    int                  channels;
    Worker             **worker;
    int                  side_px, tiles_x, tiles_y;
    SumRules             rules;
    TargetPixels        *boxes;     /* [snapshot count]: projected and projected_box only */
    bool                *is_small;  /* [snapshot count]: left to its footprint; pixels do not see it */
    /* small targets */
    TargetGrid           *footprint; /* [footprints], by entity */
    int                  footprints;
    int                 *target_grid_order; /* [footprints]: in which order they are sampled */
    int32_t             *coverer;   /* a pixel: snapshot index of the small target that covers most; where any does */
    double               target_variance[picture_plane_count]; /* squared errors over the pixels, summed */
    /* edges; NULL: not looked for */
    uint8_t             *refine;    /* a pixel: RefineFlag */
    float               *sun;       /* a pixel: Samples.sun of the sample that truth is of */
    double             (*law)[picture_plane_count]; /* [tiles]: squared errors, summed; NULL: no error estimate */
} Job;

typedef struct Tile {
    int x0, y0, x1, y1; /* px */
} Tile;

/* The pixels of a task. */
Tile tile_of(const Job *job, int task);
static inline size_t pixel_index(const Job *job, int x, int y) { return picture_index(job->picture, x, y); }

/* Entities that samples within a box of the image may see, into worker->list; without `small_ones` small targets are
 * left to their footprints. Returns how many. */
int  list_entities(Worker *w, const Job *job, const double box_px[4], bool small_ones);
/* Which channels the samples are asked for: those of `bands`. */
void ask_bands(Worker *w, const Job *job, unsigned bands);
/* Smoke that samples within a box of the image may meet. */
void ask_smoke(Worker *w, const Job *job, const double box_px[4]);

/* Eye rays of the block's pixels, in the channels of `bands`, and what they meet. */
void block_trace(Worker *w, const Job *job, unsigned bands, int listed);
/* Light of the block's hits. */
void block_light(Worker *w, const Job *job);
/* Adds what the block's samples show of the targets, and of the range profile, to the sums. */
void block_add(Worker *w, const Job *job, int sign);
/* Areas of the listed targets to the sums. */
void block_add_areas(Worker *w, const Job *job, int sign, int listed);
/* The block's means into the planes of its channels. */
void block_write(Worker *w, const Job *job);
/* Room for a plane's values at the block's samples; NULL: not asked for. */
float *block_values(const Worker *w, const Job *job, int plane);

#endif
