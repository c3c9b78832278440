/* render/frame/target_sums.c: areas, radiance and occluders of targets, over the samples of all tiles. */

#include "render/frame/frame_private.h"

#include <assert.h>
#include <stdlib.h>

Status target_sums_create(TargetSums *out, int entities, int profile_bins, Arena *arena)
{
    out->target = arena_alloc(arena, (size_t)entities, sizeof *out->target);
    out->profile = arena_alloc(arena, (size_t)profile_bins * radar_bounces, sizeof *out->profile);
    return out->target && out->profile ? STATUS_OK : STATUS_NO_MEMORY;
}

/* Quanta: areas divide evenly by both grids; no radar return exceeds the peak of its lobe; and no target's own
 * radiance exceeds 2^20 W/(m2 sr) except that of a perfect mirror of the sun, which is clipped there in the sums of
 * the truth (not in pictures). Powers of two, so that scaling is exact. */
void sum_rules_choose(SumRules *rules, const RenderRequest *request, const RadarConfig *radar)
{
    const double pixels = (double)request->view.width * request->view.height;
    const int    edge = looks_for_edges(request) ? request->edge_samples : 1, leaf = leaf_samples(request);
    /* areas divide by samples^2 (every pixel), edge^2, 2^2 (steps) and 1 + leaf^2, and those by leaf^2 when the first
     * sample's share falls; below 2^34 a pixel, of 2^26 */
    rules->steps_per_px =
        (int64_t)request->samples * request->samples * edge * edge * leaf * leaf * (1 + leaf * leaf) * 4;
    while (rules->steps_per_px < (int64_t)1 << 33) rules->steps_per_px *= 2;
    const double lobe_rad = fmax(radar->lobe_rad, 1e-9); /* as radar_lobe has it */
    rules->profile_limit = exp2(ceil(log2(2 / (pi_rad * lobe_rad * lobe_rad))));
    rules->profile_quantum = rules->profile_limit * exp2(ceil(log2(pixels)) - 61);
    rules->radiance_limit = exp2(20);
    rules->radiance_quantum = rules->radiance_limit * exp2(ceil(log2(pixels)) - 61);
}

double pixel_cosine3(const View *view, int x, int y) { return view_pixel_share(view, x, y); }

/* ---- occluders -------------------------------------------------------------------------------- */

/* The slot of the pair, or the free slot for it. There is always a free one. */
static Occlusion *find_pair(const Occlusions *table, int target, int occluder)
{
    uint64_t key = (uint64_t)(uint32_t)target << 32 | (uint32_t)occluder;
    key = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
    for (size_t at = (size_t)(key ^ key >> 29);; at++) {
        Occlusion *o = &table->pair[at & (table->capacity - 1)];
        if (!o->used || (o->target == target && o->occluder == occluder)) return o;
    }
}

static bool grow_table(Occlusions *table, Arena *arena)
{
    Occlusions larger = {.capacity = table->capacity ? 2 * table->capacity : 64, .used = table->used};
    larger.pair = arena_alloc(arena, larger.capacity, sizeof *larger.pair);
    if (!larger.pair) return false;
    for (size_t i = 0; i < table->capacity; i++)
        if (table->pair[i].used) *find_pair(&larger, table->pair[i].target, table->pair[i].occluder) = table->pair[i];
    *table = larger;
    return true;
}

void occlusion_add(Occlusions *table, Arena *arena, int target, int occluder, int64_t steps, double area_px)
{
    if (2 * (table->used + 1) > table->capacity && !grow_table(table, arena)) {
        table->lost = true;
        return;
    }
    Occlusion *o = find_pair(table, target, occluder);
    if (!o->used) {
        *o = (Occlusion){.used = true, .target = target, .occluder = occluder};
        table->used++;
    }
    o->steps += steps;
    o->area_px += area_px;
}

static int compare_pairs(const void *a, const void *b)
{
    const Occlusion *p = a, *q = b;
    if (p->target != q->target) return p->target < q->target ? -1 : 1;
    return p->occluder < q->occluder ? -1 : p->occluder > q->occluder;
}

/* Sorts the pairs by target (a counting sort), and those of each target by occluder. False: no memory. */
static bool sort_pairs(Occlusion **pair, size_t count, int entities, Arena *arena)
{
    size_t    *first = arena_alloc(arena, (size_t)entities + 1, sizeof *first);
    Occlusion *sorted = arena_alloc(arena, count, sizeof *sorted);
    if (!first || !sorted) return false;
    for (size_t i = 0; i < count; i++) first[(*pair)[i].target + 1]++;
    for (int k = 0; k < entities; k++) first[k + 1] += first[k];
    for (size_t i = 0; i < count; i++) sorted[first[(*pair)[i].target]++] = (*pair)[i];
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && sorted[end].target == sorted[i].target;) end++;
        qsort(sorted + i, end - i, sizeof *sorted, compare_pairs);
    }
    *pair = sorted;
    return true;
}

/* The entity that hides most of each target; of equals, the lowest index. */
static Status name_occluders(TargetPixels *target, int entities, const TargetSums *const *sums, int workers,
                             Arena *arena)
{
    size_t most = 0, count = 0;
    for (int w = 0; w < workers; w++) {
        if (sums[w]->hidden.lost) return STATUS_NO_MEMORY;
        most += sums[w]->hidden.used;
    }
    if (most == 0) return STATUS_OK;
    Occlusion *pair = arena_alloc(arena, most, sizeof *pair);
    if (!pair) return STATUS_NO_MEMORY;
    for (int w = 0; w < workers; w++)
        for (size_t i = 0; i < sums[w]->hidden.capacity; i++)
            if (sums[w]->hidden.pair[i].used) pair[count++] = sums[w]->hidden.pair[i];
    if (!sort_pairs(&pair, count, entities, arena)) return STATUS_NO_MEMORY;
    int64_t most_steps = 0;
    double  most_px = 0;
    for (size_t i = 0; i < count;) {
        const int of = pair[i].target, by = pair[i].occluder;
        int64_t   steps = 0;
        double    area_px = 0;
        if (i == 0 || pair[i - 1].target != of) most_steps = 0, most_px = 0;
        for (; i < count && pair[i].target == of && pair[i].occluder == by; i++)
            steps += pair[i].steps, area_px += pair[i].area_px;
        if (steps > most_steps || area_px > most_px) {
            most_steps = steps;
            most_px = area_px;
            target[of].occluder = by;
        }
    }
    return STATUS_OK;
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

int64_t target_sums_steps(int64_t *seen, const SumRules *rules, const SharedBlock *of, size_t px)
{
    const int64_t whole = llrint((double)rules->steps_per_px * of->share / (of->block->n * of->block->n));
    const double  covered = rules->picture->covered ? (double)rules->picture->covered[px] : 0;
    *seen = covered > 0 ? llrint((double)whole * (1 - covered)) : whole;
    return whole;
}

/* Counts one sample that shows the target. */
static void count_seen(TargetSums *sums, int index, const SumRules *rules, const SharedBlock *of, int sample)
{
    const Samples    *s = of->samples;
    const PixelBlock *block = of->block;
    const int         pixel = sample / (block->n * block->n), x = block->x[pixel], y = block->y[pixel];
    const size_t      px = picture_index(rules->picture, x, y);
    TargetCount      *count = &sums->target[index];
    int64_t           seen;
    const int64_t     whole = target_sums_steps(&seen, rules, of, px);
    count->visible += seen;
    for (int b = 0; b < BAND_COUNT && s->smoke.any; b++)
        count->veiled[b] += llrint((double)seen * samples_smoke_taken(s, rules->smoke_channel[b], sample));
    count->amodal += whole;
    grow_box(count->box, x, y);
    grow_box(count->amodal_box, x, y);
    if (seen == whole) return;
    count->hidden_entity += whole - seen;
    occlusion_add(&sums->hidden, rules->arena, index, rules->coverer[px], whole - seen, 0);
}

void target_sums_areas(TargetSums *sums, const SumRules *rules, const SharedBlock *of, const int *list, int listed,
                       VisibilityCounters *counters)
{
    const Samples    *s = of->samples;
    const PixelBlock *block = of->block;
    const int         samples = block->n * block->n;
    Rays             *some = &sums->some;
    assert(!s->hits.several); /* areas are of the samples as they were shot */
    for (int n = 0; n < listed; n++) {
        const int      index = list[n];
        const uint32_t id = (uint32_t)index + 1;
        TargetCount   *count = &sums->target[index];
        uint64_t       left_out = 0;

        some->count = some->columns = 0;
        some->bent = true;
        visibility_lie_beyond(sums->beyond, rules->visibility, index, &s->rays, s->hits.range_m);
        for (int i = 0; i < s->hits.count; i++) {
            if (s->hits.entity[i] == id) {
                count_seen(sums, index, rules, of, i);
                continue;
            }
            if (!sums->beyond[i]) {
                left_out++;
                continue;
            }
            const int to = some->count++;
            sums->some_index[to] = i;
            for (int k = 0; k < 3; k++) {
                some->o_enu[k][to] = s->rays.o_enu[k][i];
                some->d_enu[k][to] = s->rays.d_enu[k][i];
            }
            some->far_m[to] = INFINITY;
        }
        counters->skipped[SKIP_AMODAL] += left_out;
        if (some->count == 0) continue;
        visibility_entity_only(sums->meets, rules->visibility, some, index, counters);
        for (int k = 0; k < some->count; k++) {
            if (!sums->meets[k]) continue;
            const int     i = sums->some_index[k], x = block->x[i / samples], y = block->y[i / samples];
            int64_t       seen;
            const int64_t whole = target_sums_steps(&seen, rules, of, picture_index(rules->picture, x, y));
            count->amodal += whole;
            grow_box(count->amodal_box, x, y);
            if (s->hits.entity[i]) {
                count->hidden_entity += whole;
                occlusion_add(&sums->hidden, rules->arena, index, (int)s->hits.entity[i] - 1, whole, 0);
            } else if (s->hits.kind[i] == hit_scenery) {
                count->hidden_scenery += whole;
            } else if (s->hits.instance[i]) {
                count->hidden_plants += whole;
            } else {
                count->hidden_ground += whole;
            }
        }
    }
}

/* ---- radiance --------------------------------------------------------------------------------- */

void target_sums_view(TargetSums *sums, const PixelBlock *block, const View *view)
{
    for (int p = 0; p < block->pixels; p++) sums->cosine3[p] = pixel_cosine3(view, block->x[p], block->y[p]);
}

void target_sums_radiance(TargetSums *sums, const SumRules *rules, const Hits *hits, const PixelBlock *block,
                          double share, const float *value, int plane)
{
    const double per_quantum = 1 / rules->radiance_quantum; /* powers of two: exact */
    const float *covered = rules->picture->covered;
    uint32_t     of = 0;
    int64_t      sum = 0;
    for (int i = 0; i < hits->count; i++) {
        if (!hits->entity[i] || !isfinite(value[i])) continue;
        if (hits->entity[i] != of) {
            if (of) sums->target[of - 1].radiance[plane] += sum;
            of = hits->entity[i], sum = 0;
        }
        const int    pixel = hit_pixel(block, hits, i);
        const double open =
            covered ? 1 - (double)covered[picture_index(rules->picture, block->x[pixel], block->y[pixel])] : 1;
        const double held = clamp(value[i], -rules->radiance_limit, rules->radiance_limit);
        sum += llrint(held * (share * open * hit_share(block, hits, i)) * sums->cosine3[pixel] * per_quantum);
    }
    if (of) sums->target[of - 1].radiance[plane] += sum;
}

void target_sums_profile(TargetSums *sums, const SumRules *rules, const RenderRequest *request, const Samples *s,
                         const double *area_px)
{
    for (int b = 0; b < radar_bounces; b++)
        for (int i = 0; i < s->hits.count; i++) {
            const double power = s->returns.power[b][i];
            if (!(power > 0)) continue;
            const double bin = floor((s->returns.slant_m[b][i] - request->profile_near_m) / request->profile_bin_m);
            if (!(bin >= 0 && bin < request->profile_bins)) continue;
            sums->profile[(int)bin * radar_bounces + b] += llrint(
                area_px[i] * (power < rules->profile_limit ? power : rules->profile_limit) / rules->profile_quantum);
        }
}

/* ---- after the tiles ------------------------------------------------------------------------ */

static void gather_target(TargetPixels *target, const SumRules *rules, const TargetSums *const *sums, int workers,
                          const TargetPixels *boxes, int index)
{
    const double share = 1.0 / (double)rules->steps_per_px;
    TargetCount  sum = {0};
    for (int w = 0; w < workers; w++) {
        const TargetCount *t = &sums[w]->target[index];
        sum.visible += t->visible;
        sum.amodal += t->amodal;
        sum.hidden_ground += t->hidden_ground;
        sum.hidden_entity += t->hidden_entity;
        sum.hidden_plants += t->hidden_plants;
        sum.hidden_scenery += t->hidden_scenery;
        for (int k = 0; k < picture_plane_count; k++) sum.radiance[k] += t->radiance[k];
        for (int b = 0; b < BAND_COUNT; b++) sum.veiled[b] += t->veiled[b];
        merge_box(sum.box, t->box);
        merge_box(sum.amodal_box, t->amodal_box);
    }
    *target = boxes[index];
    target->visible = (double)sum.visible * share;
    target->amodal = (double)sum.amodal * share;
    target->occluded_ground = (double)sum.hidden_ground * share;
    target->occluded_entity = (double)sum.hidden_entity * share;
    target->occluded_plants = (double)sum.hidden_plants * share;
    target->occluded_scenery = (double)sum.hidden_scenery * share;
    target->occluder = -1;
    for (int k = 0; k < picture_plane_count; k++)
        target->radiance[k] = (double)sum.radiance[k] * rules->radiance_quantum;
    for (int b = 0; b < BAND_COUNT; b++)
        target->veiled[b] = sum.visible > 0 ? (double)sum.veiled[b] / (double)sum.visible : 0;
    /* a first sample may have met an entity that its replacements did not */
    if (sum.visible > 0) memcpy(target->box, sum.box, sizeof sum.box);
    if (sum.amodal > 0) memcpy(target->amodal_box, sum.amodal_box, sizeof sum.amodal_box);
}

Status target_sums_gather(Picture *picture, const SumRules *rules, const WorkerSums *of, Arena *arena)
{
    Status status = STATUS_OK;
    if (picture->target) {
        for (int i = 0; i < of->entities; i++)
            gather_target(&picture->target[i], rules, of->sums, of->workers, of->boxes, i);
        status = name_occluders(picture->target, of->entities, of->sums, of->workers, arena);
    }
    for (int i = 0; picture->profile && i < of->profile_bins * radar_bounces; i++) {
        int64_t sum = 0;
        for (int w = 0; w < of->workers; w++) sum += of->sums[w]->profile[i];
        picture->profile[i] = (double)sum * rules->profile_quantum;
    }
    return status;
}

/* ---- where targets lie on the image ---------------------------------------------------------- */

/* Only for targets whose bounding sphere may be visible: the vertices of others are not tested. */
void project_target(void *user, int worker, int index)
{
    (void)worker;
    const Job            *job = user;
    TargetPixels         *target = &job->boxes[index];
    const View           *view = &job->request->view;
    const SnapshotEntity *entity = &job->scene.snapshot->entity[index];
    double                p_enu[3], offset_enu[3], p_cam[3];
    if (index == job->request->hidden_entity || entity->model < 0) return;
    enu_from_ecef(p_enu, &job->scene.world->frame, entity->p_ecef);
    v3_sub(offset_enu, p_enu, view->p_enu);
    offset_enu[2] += visibility_lift(job->scene.visibility, index);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    const double radius_m = catalog_model(job->scene.world->catalog, entity->model)->radius_m;
    if (!(p_cam[2] > -radius_m)) return;
    /* half a picture and the sphere, in the plane of the sphere's far side: generous, never too tight */
    const double depth_m = p_cam[2] + radius_m;
    double       half[2], box[4];
    view_half_tangents(half, view);
    if (fabs(p_cam[0]) - radius_m > depth_m * half[0] || fabs(p_cam[1]) - radius_m > depth_m * half[1]) return;
    if (!visibility_project_box(box, job->scene.visibility, view, index)) return;
    if (!(box[2] > 0 && box[0] < view->width && box[3] > 0 && box[1] < view->height)) return;
    target->projected = true;
    memcpy(target->projected_box, box, sizeof box);
}
