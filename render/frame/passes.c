/* render/frame/passes.c: a block of pixels, shaded and summed: the steps that the passes share. */
#include "render/frame/passes.h"

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
    const int all =
        visibility_block_entities(w->list, job->scene.visibility, &job->request->view, box_px[0], box_px[1], box_px[2],
                                  box_px[3], job->request->hidden_entity, &w->shader.counters);
    int       listed = 0;
    if (small_ones) return all;
    for (int k = 0; k < all; k++)
        if (!job->is_small[w->list[k]]) w->list[listed++] = w->list[k];
    return listed;
}

void ask_bands(Worker *w, const Job *job, unsigned bands)
{
    w->samples.channels    = render_air_bands(bands, job->request->optical);
    w->samples.radar       = has_band(bands, BAND_RADAR);
    w->samples.temperature = job->request->truth;
}

void ask_smoke(Worker *w, const Job *job, const double box_px[4])
{
    const EffectScene *effects = &job->scene.effects;
    int                volumes = effects->count;
    for (int n = 0; n < volumes; n++) w->volume[n] = n;
    if (volumes > 0 && skips(job->request->skips_off, SKIP_SMOKE)) {
        volumes = smoke_cull_block(w->volume, effects->volume, volumes, &job->request->view, box_px[0], box_px[1], box_px[2],
                             box_px[3]);
        w->shader.counters.skipped[SKIP_SMOKE] += (uint64_t)(effects->count - volumes);
    }
    w->samples.volume  = w->volume;
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
    samples_trace(&w->shader, &job->scene, &w->samples, w->list, listed);
}

void block_light(Worker *w, const Job *job)
{
    w->samples.per_rad = job->request->view.focal_px * w->block.n;
    if (job->scene.sky_samples > 0) pixels_keys(w->key, &w->block, &w->samples.hits, job->picture->width);
    w->samples.key = w->key;
    samples_light(&w->shader, &job->scene, &w->samples);
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

void block_add(Worker *w, const Job *job, double share)
{
    const Samples *s = &w->samples;
    if (job->picture->target) {
        target_sums_view(&w->sums, &w->block, &job->request->view);
        for (int plane = 0; plane < picture_plane_count; plane++) {
            const float *value = block_values(w, job, plane);
            if (value) target_sums_radiance(&w->sums, &job->rules, &s->hits, &w->block, share, value, plane);
        }
    }
    if (!s->radar || job->request->profile_bins == 0) return;
    /* samples behind which a small target lies count with the share of their pixel that it leaves uncovered */
    for (int i = 0; i < s->hits.count; i++) {
        const int    p  = hit_pixel(&w->block, &s->hits, i);
        const size_t px = pixel_index(job, w->block.x[p], w->block.y[p]);
        w->area_px[i]   = share * (job->picture->covered ? 1 - (double)job->picture->covered[px] : 1) *
                        hit_share(&w->block, &s->hits, i);
    }
    target_sums_profile(&w->sums, &job->rules, job->request, s, w->area_px);
}

void block_add_areas(Worker *w, const Job *job, double share, const int *list, int listed)
{
    target_sums_areas(&w->sums, &job->rules, &w->samples, &w->block, share, list, listed, &w->shader.counters);
}

void block_write(Worker *w, const Job *job, double share)
{
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = block_values(w, job, plane);
        if (value)
            pixels_average(picture_plane(job->picture, plane), job->picture->width, &w->block, &w->samples.hits, value, share);
    }
}
