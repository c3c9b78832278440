/* render/frame/passes.c: a block of pixels, shaded and summed: the steps that the passes share; and the base pass,
 * which shades every pixel of a tile once and adds it to the planes, the truth and the sums. */

#include "render/frame/frame_private.h"

/* ---- pixels: eye rays through them, means over them ------------------------------------------ */

void pixels_rays(Rays *rays, const PixelBlock *block, const View *view)
{
    const int     samples = block->n * block->n;
    const double *r = view->r_enu_from_cam, centre_x = 0.5 * view->width, centre_y = 0.5 * view->height;
    const double  focal_px = view->focal_px;
    double        place[256][2], column_px[hits_capacity], row_px[hits_capacity];
    double *const restrict dx = rays->d_enu[0], *const restrict dy = rays->d_enu[1],
                           *const restrict dz = rays->d_enu[2];
    const int count = block->pixels * samples;
    for (int k = 0; k < samples; k++) sample_place(place[k], block->n, k);
    for (int p = 0, i = 0; p < block->pixels; p++)
        for (int k = 0; k < samples; k++, i++) {
            column_px[i] = block->x[p] + place[k][0];
            row_px[i] = block->y[p] + place[k][1];
        }
    if (view_has_lens(view)) {
        for (int i = 0; i < count; i++) {
            double at[2];
            lens_back_within(at, &view->lens, (column_px[i] - centre_x) / focal_px, (row_px[i] - centre_y) / focal_px);
            const double n = 1 / sqrt(at[0] * at[0] + at[1] * at[1] + 1), x = n * at[0], y = n * at[1], z = n * 1;
            dx[i] = r[0] * x + r[1] * y + r[2] * z;
            dy[i] = r[3] * x + r[4] * y + r[5] * z;
            dz[i] = r[6] * x + r[7] * y + r[8] * z;
        }
    }
    if (!view_has_lens(view)) view_rays((double *const[3]){dx, dy, dz}, view, count, column_px, row_px);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) rays->o_enu[k][i] = view->p_enu[k];
        rays->far_m[i] = INFINITY;
    }
    rays->count = count;
    rays->columns = block->columns;
}

static void span(double *from, double *to, const uint16_t *at, int count)
{
    uint16_t low = UINT16_MAX, high = 0;
    for (int p = 0; p < count; p++) low = at[p] < low ? at[p] : low, high = at[p] > high ? at[p] : high;
    *from = count > 0 ? low : INFINITY, *to = count > 0 ? high + 1.0 : -INFINITY;
}

void pixels_box(double box_px[4], const PixelBlock *block)
{
    span(&box_px[0], &box_px[2], block->x, block->pixels);
    span(&box_px[1], &box_px[3], block->y, block->pixels);
}

/* The sample nearest a pixel's centre; of equals, the first. */
static int pixels_centre_sample(int n)
{
    int    best = 0;
    double least = INFINITY;
    for (int i = 0; i < n * n; i++) {
        double place[2];
        sample_place(place, n, i);
        const double square = (place[0] - 0.5) * (place[0] - 0.5) + (place[1] - 0.5) * (place[1] - 0.5);
        if (square < least) least = square, best = i;
    }
    return best;
}

/* A mean into a pixel. */
static void mix_in(float *pixel, double mean, double share)
{
    *pixel = (float)(share == 1 ? mean : (1 - share) * (double)*pixel + share * mean);
}

/* A key for each hit that seeds its random choices: from its position on the picture, independent of the block. */
static void pixels_keys(uint64_t *key, const PixelBlock *block, const Hits *hits, int width)
{
    const int samples = block->n * block->n;
    for (int i = 0, within = 0, before = -1; i < hits->count; i++) {
        const int p = hit_pixel(block, hits, i);
        within = hits->several ? (p == before ? within + 1 : 0) : i % samples;
        before = p;
        key[i] = (((uint64_t)block->y[p] * (uint64_t)width + (uint64_t)block->x[p]) * 32 + (uint64_t)block->n) * 256 +
                 (uint64_t)within;
    }
}

/* How many pixels of the block from p on lie side by side. */
static int pixels_run(const PixelBlock *block, int p)
{
    int run = 1;
    while (p + run < block->pixels && block->y[p + run] == block->y[p] && block->x[p + run] == block->x[p] + run) run++;
    return run;
}

/* Mean of a value over each pixel's hits, with this share, and what the plane holds there with the rest, into a plane
 * of this width. */
static void pixels_average(float *plane, int width, const PixelBlock *block, const Hits *hits, const float *value,
                           double share)
{
    const int samples = block->n * block->n;
    if (hits->several) {
        for (int i = 0, p = 0; p < block->pixels; p++) {
            double sum = 0;
            for (; i < hits->count && hit_pixel(block, hits, i) == p; i++) sum += hit_share(block, hits, i) * value[i];
            mix_in(&plane[(size_t)block->y[p] * (size_t)width + block->x[p]], sum, share);
        }
        return;
    }
    if (samples == 1 && share == 1) {
        for (int p = 0, run; p < block->pixels; p += run) {
            run = pixels_run(block, p);
            memcpy(plane + (size_t)block->y[p] * (size_t)width + block->x[p], value + p, (size_t)run * sizeof *plane);
        }
        return;
    }
    for (int p = 0; p < block->pixels; p++) {
        double sum = 0;
        for (int k = 0; k < samples; k++) sum += value[p * samples + k];
        mix_in(&plane[(size_t)block->y[p] * (size_t)width + block->x[p]], sum * (1.0 / samples), share);
    }
}

/* ---- a block of pixels ----------------------------------------------------------------------- */

Tile tile_of(const Job *job, int task)
{
    const View *view = &job->request->view;
    Tile        tile = {.x0 = task % job->tiles_x * job->side_px, .y0 = task / job->tiles_x * job->side_px};
    tile.x1 = tile.x0 + job->side_px < view->width ? tile.x0 + job->side_px : view->width;
    tile.y1 = tile.y0 + job->side_px < view->height ? tile.y0 + job->side_px : view->height;
    return tile;
}

int list_entities(Worker *w, const Job *job, const double box_px[4], bool small_ones)
{
    const int all = visibility_block_entities(w->list, job->scene.visibility, &job->request->view, box_px,
                                              job->request->hidden_entity, &w->shader.counters);
    int       listed = 0;
    if (small_ones) return all;
    for (int k = 0; k < all; k++)
        if (!job->is_small[w->list[k]]) w->list[listed++] = w->list[k];
    return listed;
}

void ask_bands(Worker *w, const Job *job, unsigned bands)
{
    w->samples.channels = render_air_bands(bands, job->request->optical);
    w->samples.radar = has_band(bands, BAND_RADAR);
    w->samples.temperature = job->request->truth;
}

void ask_smoke(Worker *w, const Job *job, const double box_px[4])
{
    const EffectScene *effects = &job->scene.effects;
    int                volumes = effects->count;
    for (int n = 0; n < volumes; n++) w->volume[n] = n;
    if (volumes > 0 && skips(job->request->skips_off, SKIP_SMOKE)) {
        volumes = smoke_cull_block(w->volume, effects->volume, volumes, &job->request->view, box_px[0], box_px[1],
                                   box_px[2], box_px[3]);
        w->shader.counters.skipped[SKIP_SMOKE] += (uint64_t)(effects->count - volumes);
    }
    w->samples.volume = w->volume;
    w->samples.volumes = volumes;
}

void block_trace(Worker *w, const Job *job, unsigned bands, int listed)
{
    double box_px[4];
    pixels_rays(&w->samples.rays, &w->block, &job->request->view);
    w->counters.rays_primary += (uint64_t)w->samples.rays.count;
    pixels_box(box_px, &w->block);
    ask_bands(w, job, bands);
    ask_smoke(w, job, box_px);
    shade_samples_trace(&w->shader, &job->scene, &w->samples, w->list, listed);
}

void block_light(Worker *w, const Job *job)
{
    w->samples.per_rad = job->request->view.focal_px * w->block.n;
    if (job->scene.sky_samples > 0) pixels_keys(w->key, &w->block, &w->samples.hits, job->picture->width);
    w->samples.key = w->key;
    w->shader.terms = record_wants(job, &w->block) ? w->terms : NULL;
    shade_samples_light(&w->shader, &job->scene, &w->samples);
}

float *block_values(const Worker *w, const Job *job, int plane)
{
    if (plane == picture_radar) return w->samples.radar ? w->samples.radar_power : NULL;
    for (int k = 0; k < job->channels; k++) {
        const AirBand channel = job->channel[k].channel;
        if (job->channel[k].plane == plane && w->samples.channels >> channel & 1) return w->samples.radiance[channel];
    }
    return NULL;
}

/* Whether some hit of the block shows an entity. */
static bool shows_entity(const Hits *hits)
{
    uint32_t any = 0;
    for (int i = 0; i < hits->count; i++) any |= hits->entity[i];
    return any != 0;
}

void block_add(Worker *w, const Job *job, double share)
{
    const Samples *s = &w->samples;
    if (job->picture->target && shows_entity(&s->hits)) {
        target_sums_view(&w->sums, &w->block, &job->request->view);
        for (int plane = 0; plane < picture_plane_count; plane++) {
            const float *value = block_values(w, job, plane);
            if (value) target_sums_radiance(&w->sums, &job->rules, &s->hits, &w->block, share, value, plane);
        }
    }
    if (job->picture->target && job->scene.world->scenery && share > 0) scenery_sums_heat(&w->scenery, &job->rules, s);
    if (!s->radar || job->request->profile_bins == 0) return;
    /* samples behind which a small target lies count with the share of their pixel that it leaves uncovered */
    for (int i = 0; i < s->hits.count; i++) {
        const int    p = hit_pixel(&w->block, &s->hits, i);
        const size_t px = pixel_index(job, w->block.x[p], w->block.y[p]);
        w->area_px[i] = share * (job->picture->covered ? 1 - (double)job->picture->covered[px] : 1) *
                        hit_share(&w->block, &s->hits, i);
    }
    target_sums_profile(&w->sums, &job->rules, job->request, s, w->area_px);
}

void block_add_areas(Worker *w, const Job *job, double share, const int *list, int listed)
{
    const SharedBlock of = {&w->samples, &w->block, share};
    target_sums_areas(&w->sums, &job->rules, &of, list, listed, &w->shader.counters);
    if (job->scene.world->scenery) scenery_sums_area(&w->scenery, &job->rules, &of);
}

void block_write(Worker *w, const Job *job, double share)
{
    if (job->request->record) record_block(w, job, share);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = block_values(w, job, plane);
        if (value)
            pixels_average(picture_plane(job->picture, plane), job->picture->width, &w->block, &w->samples.hits, value,
                           share);
    }
}

/* ---- the base pass --------------------------------------------------------------------------- */

static void write_truth(const Worker *w, const Job *job)
{
    const Picture    *picture = job->picture;
    const PixelBlock *block = &w->block;
    const Samples    *s = &w->samples;
    const Hits       *hits = &s->hits;
    const int         samples = block->n * block->n, centre = pixels_centre_sample(block->n);
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
        for (int k = 0; picture->instance && k < run; k++)
            picture->instance[px + (size_t)k] = hits->instance[first + k * samples];
        for (int k = 0; k < run; k++) picture->temp_k[px + (size_t)k] = s->temp_k[first + k * samples];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < run; k++) picture->normal[c][px + (size_t)k] = hits->n_enu[c][first + k * samples];
        for (int k = 0; job->sun && k < run; k++) job->sun[px + (size_t)k] = s->sun[first + k * samples];
    }
}

/* Shades the block's pixels. share: how many of the picture each stands for in sums over it. */
static void base_block(Worker *w, const Job *job, int listed, double share)
{
    if (w->block.pixels == 0) return;
    block_trace(w, job, job->request->bands, listed);
    shade_samples_sun(&w->shader, &job->scene, &w->samples);
    block_light(w, job);
    block_write(w, job, 1);
    if (share > 0) block_add(w, job, share);
    if (share > 0 && job->picture->target) block_add_areas(w, job, share, w->list, listed);
    if (job->picture->entity) write_truth(w, job);
}

/* The tile's pixels that have rays at this step of sampling. whole: those that always have; else the others, which
 * stand for more than themselves. Returns how many of the kind there are. */
static int collect(Worker *w, const Job *job, const Tile *tile, bool whole)
{
    int count = 0;
    w->block.pixels = w->block.columns = 0;
    for (int y = tile->y0; y < tile->y1; y++)
        for (int x = tile->x0; x < tile->x1; x++) {
            if ((!job->whole || job->whole[pixel_index(job, x, y)]) != whole) continue;
            count++;
            if (sampling_traces(job, x, y)) pixels_add(&w->block, x, y);
        }
    return count;
}

void base_others(Worker *w, const Job *job, const Tile *tile)
{
    const double box_px[4] = {tile->x0, tile->y0, tile->x1, tile->y1};
    if (w->block.pixels == 0) return;
    w->block.n = job->request->samples;
    base_block(w, job, list_entities(w, job, box_px, false), 0);
}

void base_tile(void *user, int worker, int task)
{
    Job         *job = user;
    Worker      *w = job->worker[worker];
    const Tile   tile = tile_of(job, task);
    const double box_px[4] = {tile.x0, tile.y0, tile.x1, tile.y1};
    if (job->whole) sampling_mark_smoke(w, job, &tile);
    const int listed = list_entities(w, job, box_px, false);
    const int pixels = (tile.x1 - tile.x0) * (tile.y1 - tile.y0), whole = collect(w, job, &tile, true);

    w->block.n = job->request->samples;
    if (w->block.n == 1 && whole == pixels) w->block.columns = tile.x1 - tile.x0;
    w->counters.pixels += (uint64_t)pixels;
    w->counters.tiles++;
    w->counters.tiles_without_entities += listed == 0;
    base_block(w, job, listed, 1);
    if (whole == pixels) return;
    const int others = collect(w, job, &tile, false);
    if (w->block.pixels > 0) base_block(w, job, listed, (double)others / w->block.pixels);
}
