/* render/frame/refine.c: the edges pass: pixels marked by edges.c are sampled again with more samples, which replace
 * their first ones in the planes and in all sums over pixels. Of plants the first samples stay, and all count alike:
 * they are as good as any other there. At a straight edge the grid alone is more accurate than the grid and a sample
 * at the centre. */
#include "render/frame/frame_private.h"
#include "render/frame/render.h"

#include <stdlib.h>

/* One kind of refinement, and the pixels that get it. */
typedef struct Refinement {
    unsigned has, lacks; /* RefineFlag: pixels with all of these and none of those */
    unsigned bands;
    int      n;
} Refinement;

enum {
    few_entities = 8,   /* of a tile: up to here a closer list saves nothing */
    crowd_entities = 40 /* in a tile: beyond, list_outlines */
};

/* Whether the planes still hold all that a pixel's own sample contributed to the sums; else it is traced again. */
static bool planes_remember(const Job *job)
{
    return job->request->samples == 1 && !job->picture->profile && job->scene.effects.count == 0 &&
           skips(job->request->skips_off, SKIP_RETRACE);
}

/* What the block's first samples met, one a pixel, from the planes. */
static void restore_first(Worker *w, const Job *job)
{
    const Picture *picture = job->picture;
    PixelBlock    *block = &w->block;
    Samples       *s = &w->samples;
    block->n = 1;
    pixels_rays(&s->rays, block, &job->request->view);
    s->hits.count = block->pixels;
    s->hits.several = false;
    s->smoke.any = false;
    for (size_t p = 0; p < (size_t)block->pixels; p++) {
        const size_t px = pixel_index(job, block->x[p], block->y[p]);
        s->hits.entity[p] = picture->entity[px];
        s->hits.instance[p] = picture->instance ? picture->instance[px] : 0;
        s->hits.kind[p] = picture->entity[px]               ? hit_part
                          : picture->part[px]               ? hit_scenery
                          : s->hits.instance[p]             ? hit_plant
                          : picture->range_m[px] < INFINITY ? hit_ground
                                                            : hit_sky;
        s->hits.range_m[p] = picture->range_m[px] * (1 - 1e-6); /* a float's: no farther than it was */
    }
}

/* Takes back from the sums a share of what the block's pixels contributed with one sample each, but for areas, restored
 * from the planes before they change. */
static void take_back(Worker *w, const Job *job, unsigned bands, double share)
{
    const Picture *picture = job->picture;
    PixelBlock    *block = &w->block;
    restore_first(w, job);
    ask_bands(w, job, bands);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        float *out = block_values(w, job, plane);
        for (size_t p = 0; out && p < (size_t)block->pixels; p++)
            out[p] = picture_plane(picture, plane)[pixel_index(job, block->x[p], block->y[p])];
    }
    block_add(w, job, -share);
    w->shader.counters.skipped[SKIP_RETRACE] += (uint64_t)block->pixels;
}

static int compare_indices(const void *a, const void *b)
{
    const int p = *(const int *)a, q = *(const int *)b;
    return (p > q) - (p < q);
}

/* Whether the boxes of many entities share a tile. */
static bool is_crowd(const Job *job, const Tile *tile)
{
    int count = 0;
    for (int i = 0; i < job->scene.snapshot->count && count <= crowd_entities; i++) {
        const double *box = job->boxes[i].projected_box;
        count += job->boxes[i].projected && !job->is_small[i] && box[0] < tile->x1 && box[2] > tile->x0 &&
                 box[1] < tile->y1 && box[3] > tile->y0;
    }
    return count > crowd_entities;
}

/* The entities whose areas are sampled again, into w->outline. In a crowd only those that the block's first samples or
 * its present ones show: of what it hides the outline stays as the first samples have it, one a pixel, or every sample
 * would ask for every hidden vehicle behind it. The error of that: tests/render/test_crowd_areas.c. */
static int list_outlines(Worker *w, const Job *job, int listed, bool crowd)
{
    const PixelBlock *block = &w->block;
    const Hits       *hits = &w->samples.hits;
    int               shown[2 * hits_capacity], count = 0, kept = 0;
    if (!crowd || job->request->samples > 1) {
        memcpy(w->outline, w->list, (size_t)listed * sizeof *w->list);
        return listed;
    }
    for (int i = 0; i < hits->count; i++)
        if (hits->entity[i] && (i == 0 || hits->entity[i] != hits->entity[i - 1]))
            shown[count++] = (int)hits->entity[i] - 1;
    for (int p = 0; p < block->pixels; p++) {
        const uint32_t first = job->picture->entity[pixel_index(job, block->x[p], block->y[p])];
        if (first) shown[count++] = (int)first - 1;
    }
    qsort(shown, (size_t)count, sizeof *shown, compare_indices);
    for (int n = 0; n < count; n++)
        if (n == 0 || shown[n] != shown[n - 1]) w->outline[kept++] = shown[n];
    return kept;
}

/* Points a side at which the ground class of a sample of n x n is looked up: twice as fine as edges of parts are
 * sampled, since it is cheap. */
static int ground_side(const Job *job, int n)
{
    const int side = 2 * job->request->edge_samples / n;
    return side < 2 ? 2 : side > 16 ? 16 : side;
}

enum { step_kinds = 2 }; /* of ground, a sample at a step */

/* Squared errors of the block's pixels, by their own samples. */
static void add_variance(const Worker *w, const Job *job, double sum[picture_plane_count])
{
    const PixelBlock *block = &w->block;
    const int         samples = block->n * block->n;
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = block_values(w, job, plane);
        for (int p = 0; value && p < block->pixels; p++) {
            const size_t px = pixel_index(job, block->x[p], block->y[p]);
            const double open = job->picture->covered ? 1 - (double)job->picture->covered[px] : 1;
            sum[plane] += open * open * render_error_variance(value + p * samples, block->n);
        }
    }
}

/* Samples the block's pixels with n more samples a side. law: receives their squared errors; NULL: not needed. */
static void refine_block(Worker *w, const Job *job, const Refinement *how, int listed, bool crowd, double *law)
{
    PixelBlock *block = &w->block;
    Samples    *s = &w->samples;
    const bool  areas = job->picture->target && !(how->has & (refine_sun | refine_shade)),
               ground = how->has & refine_ground;
    const bool   sums = job->picture->target || job->picture->profile, remembered = planes_remember(job);
    const double share = how->has & (refine_plants | refine_scenery | refine_shade)
                             ? (double)(how->n * how->n) / (1 + how->n * how->n)
                             : 1; /* of them in all */
    if (sums && remembered && !ground) take_back(w, job, how->bands, share);
    block->n = how->n;
    if (ground) {
        double box_px[4];
        pixels_box(box_px, block);
        ask_bands(w, job, how->bands);
        ask_smoke(w, job, box_px);
        recall_ground(w, job);
    } else {
        block_trace(w, job, how->bands, listed);
        shade_samples_sun(&w->shader, &job->scene, s);
        w->counters.rays_edges += (uint64_t)s->rays.count;
    }
    const int  outlines = areas && !ground ? list_outlines(w, job, listed, crowd) : 0;
    const bool step = how->has & refine_step;
    if (step && areas) { /* of the samples as they were shot */
        shade_samples_smoke(&job->scene, s);
        block_add_areas(w, job, share, w->outline, outlines);
    }
    if (ground) split_ground(w, job, ground_side(job, 1), ground_mix_most);
    else if (step && job->scene.world->landscape) split_ground(w, job, ground_side(job, block->n), step_kinds);
    block_light(w, job);
    if (law) add_variance(w, job, law);
    block_write(w, job, share);
    block_add(w, job, share);
    if (areas && !step && !ground) block_add_areas(w, job, share, w->outline, outlines);
    if (ground || !sums) return;
    if (remembered) {
        restore_first(w, job);
        if (areas) block_add_areas(w, job, -share, w->outline, outlines);
        return;
    }
    block->n = job->request->samples;
    block_trace(w, job, how->bands, listed);
    shade_samples_sun(&w->shader, &job->scene, s);
    block_light(w, job);
    block_add(w, job, -share);
    if (areas) block_add_areas(w, job, -share, w->outline, outlines);
    w->counters.rays_edges += (uint64_t)s->rays.count;
}

/* The entities that the block may see: where there are many, those of its own pixels. */
static int list_block(Worker *w, const Job *job, int listed)
{
    double box_px[4];
    if (listed <= few_entities) return listed;
    pixels_box(box_px, &w->block);
    return list_entities(w, job, box_px, false);
}

/* Whether pixels of a tile may be refined: at cheaper steps of sampling those that are whole, marked, or on or beside
 * an entity. */
static bool may_refine(const Job *job, const Tile *tile)
{
    const Picture *p = job->picture;
    if (job->request->sampling == SAMPLING_ALL) return true;
    for (int y = tile->y0; y < tile->y1; y++) {
        const size_t row = pixel_index(job, tile->x0, y), count = (size_t)(tile->x1 - tile->x0);
        if (job->whole && memchr(job->whole + row, 1, count)) return true;
        for (size_t px = row; !job->whole && px < row + count; px++)
            if (job->refine[px]) return true;
    }
    for (int y = tile->y0 - 1; !job->whole && y <= tile->y1; y++)
        for (int x = tile->x0 - 1; x <= tile->x1; x++)
            if (x >= 0 && y >= 0 && x < p->width && y < p->height && p->entity[pixel_index(job, x, y)]) return true;
    return false;
}

static unsigned marked_hot(const Job *job, size_t px) { return job->hot && job->hot[px] ? refine_hot : 0; }

void refine_tile(void *user, int worker, int task)
{
    const Job     *job = user;
    Worker        *w = job->worker[worker];
    const Tile     tile = tile_of(job, task);
    const double   box_px[4] = {tile.x0, tile.y0, tile.x1, tile.y1};
    const int      edge = job->request->edge_samples;
    const unsigned all = job->request->bands, no_radar = all & ~(1u << BAND_RADAR);
    const unsigned sunlit = all & (1u << BAND_OPTICAL | 1u << BAND_MWIR), lwir = all & 1u << BAND_LWIR;
    unsigned       any = 0;
    const bool     bare = job->request->sampling > SAMPLING_ALL; /* borders of ground are not refined */

    const unsigned   whole = refine_all | refine_step | refine_scenery;
    const Refinement ways[] = {
        {refine_all, refine_hot, all, edge},
        {refine_all | refine_hot, 0, all, edge > hot_samples ? edge : hot_samples},
        {refine_step, refine_all, all, 2},
        {refine_scenery, refine_all | refine_step, all, 2},
        {refine_plants, whole, all, leaf_samples(job->request)},
        {refine_sun, whole | refine_plants, sunlit, edge},
        {refine_shade, whole | refine_plants | refine_sun, sunlit, 2},
        {refine_ground, whole | refine_plants | refine_sun | refine_shade, no_radar, 1},
        {refine_ground | refine_sun, whole | refine_plants, lwir, 1},
        {refine_ground | refine_shade, whole | refine_plants | refine_sun, lwir, 1},
    };
    uint8_t flags_of[hits_capacity];
    if (!may_refine(job, &tile)) return;
    refine_flags(flags_of, job, &tile);
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) {
            const size_t px = pixel_index(job, x, y);
            unsigned     flags = flags_of[(y - tile.y0) * (tile.x1 - tile.x0) + x - tile.x0];
            /* a shadow's edge on a target stays */
            if (bare && !job->picture->entity[px]) flags &= job->refine[px] | refine_all | refine_plants;
            if (job->whole && !job->whole[px]) flags = 0;
            job->refine[px] = (uint8_t)flags;
            any |= flags | marked_hot(job, px);
            w->counters.pixels_refined += flags != 0;
        }
    if (!any) return;
    const int  listed = list_entities(w, job, box_px, false);
    const bool crowd = is_crowd(job, &tile);
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        const Refinement *how = &ways[k];
        if ((any & how->has) != how->has || how->bands == 0) continue;
        double *law =
            job->law && !(how->has & (refine_step | refine_scenery | refine_plants | refine_ground | refine_shade))
                ? job->law[task]
                : NULL;
        w->block.pixels = w->block.columns = 0;
        for (int y = tile.y0; y < tile.y1; y++)
            for (int x = tile.x0; x < tile.x1; x++) {
                const size_t   px = pixel_index(job, x, y);
                const unsigned flags = job->refine[px] | marked_hot(job, px);
                if ((flags & how->has) != how->has || flags & how->lacks) continue;
                pixels_add(&w->block, x, y);
                const int each = how->n * how->n *
                                 (how->has & refine_ground ? ground_mix_most
                                  : how->has & refine_step ? step_kinds
                                                           : 1);
                if ((w->block.pixels + 1) * each <= hits_capacity) continue;
                refine_block(w, job, how, list_block(w, job, listed), crowd, law);
                w->block.pixels = 0;
            }
        if (w->block.pixels > 0) refine_block(w, job, how, list_block(w, job, listed), crowd, law);
    }
}

unsigned planes_to_resample(const Job *job, size_t px)
{
    const unsigned flags = job->refine ? job->refine[px] : 0;
    unsigned       planes = 0;
    if (flags & refine_all || (job->picture->covered && job->picture->covered[px] > 0)) return 0;
    for (int k = 0; k < picture_plane_count; k++) {
        const bool sunlit = picture_band(k) == BAND_OPTICAL || picture_band(k) == BAND_MWIR;
        if (picture_plane(job->picture, k) &&
            !(flags & refine_sun && !(flags & (refine_step | refine_scenery | refine_plants)) && sunlit))
            planes |= 1u << k;
    }
    return planes;
}
