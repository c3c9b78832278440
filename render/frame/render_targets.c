/* render/frame/render_targets.c: what each target gave: its boxes, its area seen and unseen, its own radiance, who hides
 * it. */
#include "render/frame/render_private.h"

#include <stdlib.h>

/* ---- where it is on the image ---------------------------------------------------------------- */

/* Only those whose bounding sphere can show: a vertex is not looked at otherwise. */
void project_target(void *user, int worker, int index)
{
    (void)worker;
    const Job            *job    = user;
    TargetPixels         *target = &job->boxes[index];
    const View           *view   = &job->request->view;
    const SnapshotEntity *entity = &job->snapshot->entity[index];
    double                p_enu[3], offset_enu[3], p_cam[3];
    if (index == job->request->hidden_entity || entity->model < 0) return;
    enu_from_ecef(p_enu, &job->world->frame, entity->p_ecef);
    v3_sub(offset_enu, p_enu, view->p_enu);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    const double radius_m = catalog_model(job->world->catalog, entity->model)->radius_m;
    if (!(p_cam[2] > -radius_m)) return;
    /* half a picture and the sphere, in the plane of the sphere's far side: generous, never too tight */
    const double depth_m = p_cam[2] + radius_m;
    double       half[2], box[4];
    view_half_tangents(half, view);
    if (fabs(p_cam[0]) - radius_m > depth_m * half[0] || fabs(p_cam[1]) - radius_m > depth_m * half[1]) return;
    if (!visibility_project_box(box, job->visibility, view, index)) return;
    if (!(box[2] > 0 && box[0] < view->width && box[3] > 0 && box[1] < view->height)) return;
    target->projected = true;
    memcpy(target->projected_box, box, sizeof box);
}

/* ---- areas ---------------------------------------------------------------------------------- */

static void grow_box(int box[4], int x, int y)
{
    if (box[2] == 0) {
        box[0] = x, box[1] = y, box[2] = x + 1, box[3] = y + 1;
        return;
    }
    if (x < box[0]) box[0] = x;
    if (y < box[1]) box[1] = y;
    if (x + 1 > box[2]) box[2] = x + 1;
    if (y + 1 > box[3]) box[3] = y + 1;
}

static void merge_box(int box[4], const int other[4])
{
    if (other[2] == 0) return;
    grow_box(box, other[0], other[1]);
    grow_box(box, other[2] - 1, other[3] - 1);
}

static void note_hidden(HiddenBy *pairs, int target, int occluder, int64_t area)
{
    for (int k = 0; k < pairs_per_tile; k++) {
        if (!pairs[k].used) pairs[k] = (HiddenBy){true, target, occluder, 0};
        if (pairs[k].target == target && pairs[k].occluder == occluder) {
            pairs[k].area += area;
            return;
        }
    }
}

/* A sample's area in steps, and how much of it no small target covers. Rounding is the same when it is taken back. */
static int64_t sample_steps(int64_t *seen, const Scratch *s, const Job *job, size_t px)
{
    const int64_t whole = job->steps_per_px / (s->block.n * s->block.n) * s->block.sign;
    const double  covered = job->picture->covered ? (double)job->picture->covered[px] : 0;
    *seen = covered > 0 ? llrint((double)whole * (1 - covered)) : whole;
    return whole;
}

/* One sample that shows the target. */
static void count_seen(TargetCount *count, int index, const Scratch *s, const Job *job, HiddenBy *pairs, int sample)
{
    const int     pixel = sample / (s->block.n * s->block.n), x = s->block.x[pixel], y = s->block.y[pixel];
    const size_t  px = pixel_index(job, x, y);
    int64_t       seen;
    const int64_t whole = sample_steps(&seen, s, job, px);
    count->visible += seen;
    for (int b = 0; b < BAND_COUNT && s->veil.any; b++)
        count->veiled[b] += llrint((double)seen * veil_taken(s, job, (Band)b, sample));
    count->amodal += whole;
    grow_box(count->box, x, y);
    grow_box(count->amodal_box, x, y);
    if (seen == whole) return;
    count->hidden_entity += whole - seen;
    note_hidden(pairs, index, job->coverer[px], whole - seen);
}

void count_targets(Scratch *s, const Job *job, int listed, HiddenBy *pairs)
{
    const Block *block   = &s->block;
    const int    samples = block->n * block->n;
    for (int n = 0; n < listed; n++) {
        const int      index = s->list[n];
        const uint32_t id    = (uint32_t)index + 1;
        TargetCount   *count = &s->target[index];
        uint64_t       left_out = 0;

        s->some.count = 0;
        for (int i = 0; i < s->hits.count; i++) {
            if (s->hits.entity[i] == id) {
                count_seen(count, index, s, job, pairs, i);
                continue;
            }
            const double o_enu[3] = {s->rays.o_enu[0][i], s->rays.o_enu[1][i], s->rays.o_enu[2][i]};
            const double d_enu[3] = {s->rays.d_enu[0][i], s->rays.d_enu[1][i], s->rays.d_enu[2][i]};
            if (!visibility_may_lie_beyond(job->visibility, index, o_enu, d_enu, s->hits.range_m[i])) {
                left_out++;
                continue;
            }
            const int to      = s->some.count++;
            s->some_index[to] = i;
            for (int k = 0; k < 3; k++) {
                s->some.o_enu[k][to] = o_enu[k];
                s->some.d_enu[k][to] = d_enu[k];
            }
            s->some.far_m[to] = INFINITY;
        }
        s->counters.visibility.skipped[SKIP_AMODAL] += left_out;
        if (s->some.count == 0) continue;
        visibility_entity_only(s->meets, job->visibility, &s->some, index, &s->counters.visibility);
        for (int k = 0; k < s->some.count; k++) {
            if (!s->meets[k]) continue;
            const int     i = s->some_index[k], x = block->x[i / samples], y = block->y[i / samples];
            int64_t       seen;
            const int64_t whole = sample_steps(&seen, s, job, pixel_index(job, x, y));
            count->amodal += whole;
            grow_box(count->amodal_box, x, y);
            if (s->hits.entity[i]) {
                count->hidden_entity += whole;
                note_hidden(pairs, index, (int)s->hits.entity[i] - 1, whole);
            } else {
                count->hidden_ground += whole;
            }
        }
    }
}

void add_radiance(Scratch *s, const Job *job, int plane)
{
    const Block  *block   = &s->block;
    const double  per_quantum = 1 / job->radiance_quantum; /* powers of two: exact */
    const float  *covered = job->picture->covered;
    uint32_t      of = 0;
    int64_t       sum = 0;
    for (int i = 0; i < s->hits.count; i++) {
        if (!s->hits.entity[i] || !isfinite(s->out[i])) continue;
        if (s->hits.entity[i] != of) {
            if (of) s->target[of - 1].radiance[plane] += sum;
            of = s->hits.entity[i], sum = 0;
        }
        const int    pixel = sample_pixel(block, i);
        const double open = covered ? 1 - (double)covered[pixel_index(job, block->x[pixel], block->y[pixel])] : 1;
        const double value = clamp(s->out[i], -job->radiance_limit, job->radiance_limit);
        sum += block->sign * llrint(value * (open * sample_part(block, i)) * s->cosine3[pixel] * per_quantum);
    }
    if (of) s->target[of - 1].radiance[plane] += sum;
}

/* ---- after the tiles ------------------------------------------------------------------------ */

void render_counters_add(RenderCounters *sum, const RenderCounters *more)
{
    VisibilityCounters       *to   = &sum->visibility;
    const VisibilityCounters *from = &more->visibility;
    sum->rays_primary += more->rays_primary;
    sum->rays_edges += more->rays_edges;
    sum->rays_small_targets += more->rays_small_targets;
    sum->pixels += more->pixels;
    sum->pixels_refined += more->pixels_refined;
    sum->small_targets += more->small_targets;
    sum->tiles += more->tiles;
    sum->tiles_without_entities += more->tiles_without_entities;
    to->rays_ground += from->rays_ground;
    to->rays_parts += from->rays_parts;
    to->rays_sun_ground += from->rays_sun_ground;
    to->rays_sun_parts += from->rays_sun_parts;
    to->skipped_parts += from->skipped_parts;
    to->skipped_sun_parts += from->skipped_sun_parts;
    for (int k = 0; k < SKIP_COUNT; k++) to->skipped[k] += from->skipped[k];
}

static int compare_pairs(const void *a, const void *b)
{
    const HiddenBy *p = a, *q = b;
    if (p->target != q->target) return p->target < q->target ? -1 : 1;
    return p->occluder < q->occluder ? -1 : p->occluder > q->occluder;
}

/* Who hides most of each target; of equals, the lowest id. Sorts the pairs. */
static void name_occluders(TargetPixels *target, HiddenBy *pairs, size_t count)
{
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (pairs[i].used && pairs[i].area > 0) pairs[used++] = pairs[i];
    if (used > 1) qsort(pairs, used, sizeof *pairs, compare_pairs);
    int64_t most = 0;
    for (size_t i = 0; i < used;) {
        int64_t   area = 0;
        const int who = pairs[i].target, by = pairs[i].occluder;
        if (i == 0 || pairs[i - 1].target != who) most = 0;
        for (; i < used && pairs[i].target == who && pairs[i].occluder == by; i++) area += pairs[i].area;
        if (area > most) {
            most                 = area;
            target[who].occluder = by;
        }
    }
}

static void gather_target(TargetPixels *target, const Job *job, int index, int workers)
{
    const double share = 1.0 / (double)job->steps_per_px;
    TargetCount  sum = {0};
    for (int w = 0; w < workers; w++) {
        const TargetCount *t = &job->scratch[w]->target[index];
        sum.visible += t->visible;
        sum.amodal += t->amodal;
        sum.hidden_ground += t->hidden_ground;
        sum.hidden_entity += t->hidden_entity;
        for (int k = 0; k < picture_plane_count; k++) sum.radiance[k] += t->radiance[k];
        for (int b = 0; b < BAND_COUNT; b++) sum.veiled[b] += t->veiled[b];
        merge_box(sum.box, t->box);
        merge_box(sum.amodal_box, t->amodal_box);
    }
    *target                 = job->boxes[index];
    target->visible         = (double)sum.visible * share;
    target->amodal          = (double)sum.amodal * share;
    target->occluded_ground = (double)sum.hidden_ground * share;
    target->occluded_entity = (double)sum.hidden_entity * share;
    target->occluder        = -1;
    for (int k = 0; k < picture_plane_count; k++)
        target->radiance[k] = (double)sum.radiance[k] * job->radiance_quantum;
    for (int b = 0; b < BAND_COUNT; b++)
        target->veiled[b] = sum.visible > 0 ? (double)sum.veiled[b] / (double)sum.visible : 0;
    /* a first sample may have met what those that took its place did not */
    if (sum.visible > 0) memcpy(target->box, sum.box, sizeof sum.box);
    if (sum.amodal > 0) memcpy(target->amodal_box, sum.amodal_box, sizeof sum.amodal_box);
}

void gather(Job *job, int workers)
{
    Picture *picture = job->picture;
    for (int w = 0; w < workers; w++) {
        const Scratch *s = job->scratch[w];
        render_counters_add(&picture->counters, &s->counters);
        picture->times.visibility_ms += 1e3 * s->visibility_s;
        picture->times.shadow_ms += 1e3 * s->shadow_s;
        picture->times.shade_ms += 1e3 * s->shade_s;
        picture->times.radar_ms += 1e3 * s->radar_s;
    }
    if (picture->target) {
        for (int i = 0; i < job->snapshot->count; i++) gather_target(&picture->target[i], job, i, workers);
        name_occluders(picture->target, job->pairs, (size_t)job->tiles_x * (size_t)job->tiles_y * pairs_per_tile);
        footprints_gather(job);
    }
    for (int i = 0; picture->profile && i < job->request->profile_bins * radar_bounces; i++) {
        int64_t sum = 0;
        for (int w = 0; w < workers; w++) sum += job->scratch[w]->profile[i];
        picture->profile[i] = (double)sum * job->profile_quantum;
    }
}
