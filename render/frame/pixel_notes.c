/* render/frame/pixel_notes.c: notes what the passes do to the one pixel that is recorded (pixel_record.h). */
#include "render/frame/frame_private.h"

#include <stdlib.h>

/* A new element at the end; NULL: out of memory, which is noted. The lock is held. */
static void *grown(PixelRecord *record, void **list, int *count, int *room, size_t size)
{
    if (*count == *room) {
        const int more = *room ? 2 * *room : 64;
        void     *list_now = realloc(*list, (size_t)more * size);
        if (!list_now) {
            record->lost = true;
            return NULL;
        }
        *list = list_now, *room = more;
    }
    void *last = (char *)*list + (size_t)(*count)++ * size;
    memset(last, 0, size);
    return last;
}

static PixelStep *add_step(PixelRecord *r)
{
    void *list = r->step;
    pthread_mutex_lock(&r->lock);
    PixelStep *step = grown(r, &list, &r->steps, &r->step_room, sizeof *step);
    r->step = list;
    pthread_mutex_unlock(&r->lock);
    return step;
}

bool record_wants(const Job *job, const PixelBlock *block)
{
    const PixelRecord *r = job->request->record;
    for (int p = 0; r && p < block->pixels; p++)
        if (block->x[p] == r->x && block->y[p] == r->y) return true;
    return false;
}

static void set_patches(PixelSample *out, const Job *job, const Hits *hits, int i)
{
    const Snapshot *snapshot = job->scene.snapshot;
    const double    n_enu[3] = {(double)hits->n_geo[0][i], (double)hits->n_geo[1][i], (double)hits->n_geo[2][i]};
    double          p_node[3], n_node[3];
    float           one[patches_most] = {0};
    const int       e = (int)hits->entity[i] - 1;
    if (!snapshot->patch_k || snapshot->entity[e].first_patch < 0) return;
    const SnapshotEntity *entity = &snapshot->entity[e];
    const Patches        *patches = &job->scene.world->patches->of[entity->model];
    if (!job->scene.world->patches->cut[entity->model] || patches->count != entity->patches) return;
    visibility_on_part(p_node, n_node, job->scene.visibility, hits, i, n_enu);
    for (int k = 0; k < patches->count && k < patches_most; k++) {
        one[k] = 1; /* the temperature is linear in those of the patches */
        const float share = (float)patches_value(patches, one, hits->part[i] - 1, p_node, n_node);
        one[k] = 0;
        if (!(share > 0)) continue;
        int at = out->patches < pixel_patches ? out->patches++ : pixel_patches - 1;
        if (at == pixel_patches - 1 && out->patch[at].share >= share) continue;
        for (; at > 0 && out->patch[at - 1].share < share; at--) out->patch[at] = out->patch[at - 1];
        out->patch[at].index = k, out->patch[at].share = share;
        out->patch[at].temp_k = snapshot->patch_k[entity->first_patch + k];
    }
}

static void set_light(PixelLight *out, const Worker *w, int b, int i)
{
    const Samples    *s = &w->samples;
    const ShadeTerms *t = w->terms;
    const AirPaths   *air = &w->shader.air[b];
    *out = (PixelLight){.path = air->added_w_m2_sr[i], .seen = s->radiance[b][i], .smoky = s->smoke.any};
    if (s->smoke.any) out->smoke_transmittance = s->smoke.transmittance[b][i], out->smoke = s->smoke.added[b][i];
    if (!(s->hits.range_m[i] < INFINITY)) {
        out->beyond = t->beyond[b], out->disc = t->disc[b][i];
        out->beyond_transmittance = b >= AIR_MWIR ? air->air_transmittance[i] : air->sun_transmittance[i];
        return;
    }
    out->emitted = t->emitted[b][i], out->reflected = t->reflected[b][i], out->sunlit = t->sunlit[b][i];
    out->lamps = t->lamps[b][i];
    out->reflected_sky = t->sky[b][i], out->reflected_ground = t->ground[b][i];
    out->air_transmittance = air->air_transmittance[i], out->sun_transmittance = air->sun_transmittance[i];
    out->transmittance = b >= AIR_MWIR ? air->transmittance[i] : 0;
}

static bool has_temp(const Samples *s) { return s->temperature || s->channels & (1u << AIR_MWIR | 1u << AIR_LWIR); }

static void add_sample(const Worker *w, const Job *job, int i, int group, double weight)
{
    PixelRecord      *r = job->request->record;
    const Samples    *s = &w->samples;
    const Hits       *hits = &s->hits;
    const ShadeTerms *t = w->terms;
    pthread_mutex_lock(&r->lock);
    void        *list = r->sample;
    PixelSample *out = grown(r, &list, &r->samples, &r->sample_room, sizeof *out);
    r->sample = list;
    if (out) {
        *out = (PixelSample){.group = group,
                             .weight = weight,
                             .kind = (HitKind)hits->kind[i],
                             .range_m = hits->range_m[i],
                             .entity = hits->entity[i],
                             .part = hits->part[i],
                             .plant = hits->instance[i],
                             .model = hits->model[i],
                             .material = w->shader.any_far ? w->shader.far_material[i] : hits->material[i],
                             .surface = hits->surface[i],
                             .radius_m = hits->radius_m[i],
                             .open_up = hits->open_up[i],
                             .sun = w->shader.any_far ? w->shader.far_sun[i] : s->sun[i],
                             .air_k = t->air_k[i],
                             .still_k = t->still_k[i],
                             .sunlit_k = t->sunlit_k[i],
                             .detailed_k = t->detailed_k[i],
                             .temp_k = has_temp(s) ? s->temp_k[i] : NAN,
                             .channels = s->channels,
                             .has_radar = s->radar};
        for (int k = 0; k < 3; k++) out->p_enu[k] = hits->p_enu[k][i], out->n_enu[k] = hits->n_enu[k][i];
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (s->channels >> b & 1) set_light(&out->light[b], w, b, i);
        for (int b = 0; b < radar_bounces && s->radar; b++) out->radar[b] = s->returns.power[b][i];
        if (s->radar) out->radar_power = s->radar_power[i];
        if (hits->kind[i] == hit_part && hits->entity[i]) set_patches(out, job, hits, i);
        if (hits->kind[i] == hit_scenery)
            thermal_scenery_of(&out->scenery, job->scene.air, job->scene.visibility, hits, i);
    }
    pthread_mutex_unlock(&r->lock);
}

void record_block(const Worker *w, const Job *job, double share)
{
    PixelRecord      *r = job->request->record;
    const PixelBlock *block = &w->block;
    if (!record_wants(job, block)) return;
    PixelStep *step = add_step(r);
    if (!step) return;
    *step = (PixelStep){
        .kind = PIXEL_MEAN, .group = r->steps, .n = block->n, .several = w->samples.hits.several, .share = share};
    for (int plane = 0; plane < picture_plane_count; plane++)
        if (block_values(w, job, plane)) step->planes |= 1u << plane;
    for (int i = 0; i < w->samples.hits.count; i++) {
        const int p = hit_pixel(block, &w->samples.hits, i);
        if (block->x[p] == r->x && block->y[p] == r->y)
            add_sample(w, job, i, r->steps, hit_share(block, &w->samples.hits, i));
    }
}

static int group_of(int entity, PixelStepKind kind) { return -1 - 2 * entity - (kind == PIXEL_TARGET); }

void record_cells(const TargetGrid *f, const Worker *w, const Job *job, const int *cell, PixelStepKind kind)
{
    const PixelRecord *r = job->request->record;
    for (int i = 0; i < w->samples.hits.count && w->shader.terms; i++) {
        CellShares shares;
        target_grid_shares(&shares, f, cell[i]);
        for (int k = 0; k < shares.count; k++)
            if (shares.x[k] == r->x && shares.y[k] == r->y)
                add_sample(w, job, i, group_of(f->entity, kind), shares.area[k]);
    }
}

void record_smoothed(const Job *job, const float weight[9])
{
    PixelRecord *r = job->request->record;
    const int    width = job->picture->width;
    const size_t px = pixel_index(job, r->x, r->y);
    PixelStep   *step = add_step(r);
    if (!step) return;
    step->kind = PIXEL_SMOOTHED;
    memcpy(step->weight, weight, sizeof step->weight);
    for (int c = 0; c < job->channels; c++) {
        const int    plane = job->channel[c].plane;
        const float *value = picture_plane(job->picture, plane) + px;
        step->planes |= 1u << plane;
        for (int k = 0; k < 9; k++)
            if (weight[k] > 0) step->value[plane][k] = value[(k / 3 - 1) * width + k % 3 - 1];
    }
}

void record_composite(const Job *job, PixelStepKind kind, int entity, double share)
{
    PixelStep *step = add_step(job->request->record);
    if (!step) return;
    *step = (PixelStep){
        .kind = kind, .group = kind == PIXEL_BESIDE ? 0 : group_of(entity, kind), .share = share, .entity = entity};
    for (int plane = 0; plane < picture_plane_count; plane++)
        if (picture_plane(job->picture, plane)) step->planes |= 1u << plane;
}
