/* render/frame/refine.c: the pixels that edges.c marks, once more with more samples, in place of what they had: in their planes
 * and in all sums over pixels. */
#include "render/frame/render_private.h"

/* One kind of refinement, and the pixels that get it. */
typedef struct Refinement {
    unsigned has, lacks; /* RefineFlag: pixels with all of these and none of those */
    unsigned bands;
    int      n;
} Refinement;

/* Whether the planes still hold all that a pixel's own sample gave to the sums; else it is traced again. */
static bool planes_remember(const Job *job)
{
    return job->request->samples == 1 && !job->picture->profile && job->effects.count == 0 &&
           skips(job->request->skips_off, SKIP_RETRACE);
}

/* Takes from the sums what the block's pixels gave with one sample each, as the planes say; before they change. */
static void take_back(Scratch *s, const Job *job, int listed, HiddenBy *pairs)
{
    const Picture *picture = job->picture;
    Block         *block   = &s->block;
    block->n    = 1;
    block->sign = -1;
    make_rays(&s->rays, block, &job->request->view);
    s->hits.count = block->pixels;
    s->veil.any   = false;
    s->out        = s->radiance[0];
    for (int p = 0; p < block->pixels; p++) {
        const size_t px = pixel_index(job, block->x[p], block->y[p]);
        s->cosine3[p]      = pixel_cosine3(&job->request->view, block->x[p], block->y[p]);
        s->hits.entity[p]  = picture->entity[px];
        s->hits.range_m[p] = picture->range_m[px] * (1 - 1e-6); /* a float's: no farther than it was */
    }
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const Band   band  = plane == picture_mwir ? BAND_MWIR : plane == picture_lwir ? BAND_LWIR
                           : plane == picture_radar ? BAND_RADAR : BAND_OPTICAL;
        const float *value = picture_plane(picture, plane);
        if (!value || !has_band(block->bands, band)) continue;
        for (int p = 0; p < block->pixels; p++) s->out[p] = value[pixel_index(job, block->x[p], block->y[p])];
        add_radiance(s, job, plane);
    }
    if (pairs) count_targets(s, job, listed, pairs);
    s->counters.visibility.skipped[SKIP_RETRACE] += (uint64_t)block->pixels;
}

/* Places a side at which a sample of n x n is asked for kinds of ground: twice as fine as edges of parts are sampled,
 * since it is cheap. */
static int ground_side(const Job *job, int n)
{
    const int side = 2 * job->request->edge_samples / n;
    return side < 2 ? 2 : side > 16 ? 16 : side;
}

enum { step_kinds = 2 }; /* of ground, a sample at a step */

/* As render_block, with the samples split by kinds of ground. */
static void split_block(Scratch *s, const Job *job, int listed, HiddenBy *pairs)
{
    trace_block(s, job, listed);
    trace_shadows(s, job);
    if (pairs) { /* of the samples as they were shot */
        trace_veils(s, job);
        count_targets(s, job, listed, pairs);
    }
    if (job->world->landscape) split_ground(s, job, ground_side(job, s->block.n), step_kinds);
    shade_block(s, job);
    s->block.split = false;
}

/* The block's pixels once more with n samples a side, in place of what they had. */
static void refine_block(Scratch *s, const Job *job, const Refinement *how, int listed, HiddenBy *pairs)
{
    Block     *block = &s->block;
    const bool areas = job->picture->target && !(how->has & refine_sun);
    const bool sums  = job->picture->target || job->picture->profile, remembered = planes_remember(job);
    block->bands  = how->bands;
    if (sums && remembered && !(how->has & refine_ground)) take_back(s, job, listed, areas ? pairs : NULL);
    block->n      = how->n;
    block->sign   = 1;
    block->writes = true;
    if (how->has & refine_ground) {
        recall_ground(s, job);
        split_ground(s, job, ground_side(job, 1), ground_mix_most);
        shade_block(s, job);
        block->split = false;
        return;
    }
    if (how->has & refine_step) split_block(s, job, listed, areas ? pairs : NULL);
    else render_block(s, job, listed, areas ? pairs : NULL);
    s->counters.rays_edges += (uint64_t)s->rays.count;
    if (!sums || remembered) return;
    block->n      = job->request->samples;
    block->sign   = -1;
    block->writes = false;
    render_block(s, job, listed, areas ? pairs : NULL);
    s->counters.rays_edges += (uint64_t)s->rays.count;
}

void refine_tile(void *user, int worker, int task)
{
    const Job     *job    = user;
    Scratch       *s      = job->scratch[worker];
    const Tile     tile   = tile_of(job, task);
    HiddenBy      *pairs  = job->pairs + (size_t)task * pairs_per_tile;
    const int      edge   = job->request->edge_samples;
    const unsigned all    = job->request->bands, no_radar = all & ~(1u << BAND_RADAR);
    const unsigned sunlit = all & (1u << BAND_OPTICAL | 1u << BAND_MWIR), lwir = all & 1u << BAND_LWIR;
    unsigned       any    = 0;

    const Refinement ways[] = {
        {refine_all, 0, all, edge},
        {refine_step, refine_all, all, 2},
        {refine_sun, refine_all | refine_step, sunlit, edge},
        {refine_ground, refine_all | refine_step | refine_sun, no_radar, 1},
        {refine_ground | refine_sun, refine_all | refine_step, lwir, 1},
    };
    uint8_t flags_of[hits_capacity];
    refine_flags(flags_of, job, tile.x0, tile.y0, tile.x1, tile.y1);
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) {
            const unsigned flags = flags_of[(y - tile.y0) * (tile.x1 - tile.x0) + x - tile.x0];
            job->refine[pixel_index(job, x, y)] = (uint8_t)flags;
            any |= flags;
            s->counters.pixels_refined += flags != 0;
        }
    if (!any) return;
    const int listed = list_entities(s, job, &tile);
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        const Refinement *how = &ways[k];
        if ((any & how->has) != how->has || how->bands == 0) continue;
        s->law = job->law && !(how->has & (refine_step | refine_ground)) ? job->law[task] : NULL;
        s->block = (Block){0};
        for (int y = tile.y0; y < tile.y1; y++)
            for (int x = tile.x0; x < tile.x1; x++) {
                const unsigned flags = job->refine[pixel_index(job, x, y)];
                if ((flags & how->has) != how->has || flags & how->lacks) continue;
                s->block.x[s->block.pixels]   = (uint16_t)x;
                s->block.y[s->block.pixels++] = (uint16_t)y;
                const int each = how->n * how->n * (how->has & refine_ground ? ground_mix_most
                                                    : how->has & refine_step ? step_kinds : 1);
                if ((s->block.pixels + 1) * each <= hits_capacity) continue;
                refine_block(s, job, how, listed, pairs);
                s->block.pixels = 0;
            }
        if (s->block.pixels > 0) refine_block(s, job, how, listed, pairs);
    }
    s->law = NULL;
}
