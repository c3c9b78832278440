/* render/frame/base.c: the base pass: shades every pixel of a tile once and adds it to the planes, the truth and the
 * sums. */
#include "render/frame/base.h"

static void write_truth(const Worker *w, const Job *job)
{
    const Picture *picture = job->picture;
    const PixelBlock *block = &w->block;
    const Samples *s       = &w->samples;
    const Hits    *hits    = &s->hits;
    const int      samples = block->n * block->n, centre = pixels_centre_sample(block->n);
    for (int p = 0, run; p < block->pixels; p += run) {
        run = pixels_run(block, p);
        /* plane by plane: one stream of writes at a time */
        const size_t px = pixel_index(job, block->x[p], block->y[p]);
        const int    first = p * samples + centre;
        float       *range_m = picture->range_m + px;
        uint32_t    *entity = picture->entity + px, *part = picture->part + px, *material = picture->material + px;
        for (int k = 0; k < run; k++) range_m[k] = (float)hits->range_m[first + k * samples];
        for (int k = 0; k < run; k++) entity[k] = hits->entity[first + k * samples];
        for (int k = 0; k < run; k++) part[k] = hits->part[first + k * samples];
        for (int k = 0; k < run; k++) material[k] = s->hits.material[first + k * samples];
        for (int k = 0; k < run; k++) picture->cover[px + (size_t)k] = hits->surface[first + k * samples];
        for (int k = 0; picture->instance && k < run; k++) picture->instance[px + (size_t)k] = hits->plant[first + k * samples];
        for (int k = 0; k < run; k++) picture->temp_k[px + (size_t)k] = s->temp_k[first + k * samples];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < run; k++) picture->normal[c][px + (size_t)k] = hits->n_enu[c][first + k * samples];
        for (int k = 0; job->sun && k < run; k++) job->sun[px + (size_t)k] = s->sun[first + k * samples];
    }
}

void base_tile(void *user, int worker, int task)
{
    const Job    *job   = user;
    Worker       *w     = job->worker[worker];
    const Tile    tile  = tile_of(job, task);
    PixelBlock   *block = &w->block;
    const double  box_px[4] = {tile.x0, tile.y0, tile.x1, tile.y1};

    block->n       = job->request->samples;
    block->columns = block->n == 1 ? tile.x1 - tile.x0 : 0;
    block->pixels  = 0;
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) pixels_add(block, x, y);
    const int listed = list_entities(w, job, box_px, false);
    w->counters.pixels += (uint64_t)block->pixels;
    w->counters.tiles++;
    w->counters.tiles_without_entities += listed == 0;
    block_trace(w, job, job->request->bands, listed);
    samples_sun(&w->shader, &job->scene, &w->samples);
    block_light(w, job);
    block_write(w, job, 1);
    block_add(w, job, 1);
    if (job->picture->target) block_add_areas(w, job, 1, w->list, listed);
    if (job->picture->entity) write_truth(w, job);
}
