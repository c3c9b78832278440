/* render/frame/scenery_sums.c: which objects of scenery the samples of all tiles show, and how much of each. */

#include "render/frame/frame_private.h"

#include <stdlib.h>

/* The slot of an object, or the free slot for it. There is always a free one. */
static ScenerySum *find_object(const ScenerySums *table, uint32_t instance)
{
    const uint64_t key = instance * 0x9e3779b97f4a7c15u;
    for (size_t at = (size_t)(key ^ key >> 29);; at++) {
        ScenerySum *o = &table->slot[at & (table->capacity - 1)];
        if (!o->instance || o->instance == instance) return o;
    }
}

static bool grow_table(ScenerySums *table, Arena *arena)
{
    ScenerySums larger = {.capacity = table->capacity ? 2 * table->capacity : 64, .used = table->used};
    larger.slot = arena_alloc(arena, larger.capacity, sizeof *larger.slot);
    if (!larger.slot) return false;
    for (size_t i = 0; i < table->capacity; i++)
        if (table->slot[i].instance) *find_object(&larger, table->slot[i].instance) = table->slot[i];
    *table = larger;
    return true;
}

static ScenerySum *take_object(ScenerySums *table, Arena *arena, uint32_t instance)
{
    if (2 * (table->used + 1) > table->capacity && !grow_table(table, arena)) {
        table->lost = true;
        return NULL;
    }
    ScenerySum *o = find_object(table, instance);
    if (!o->instance) {
        *o = (ScenerySum){.instance = instance, .nearest_m = INFINITY, .hottest_k = -INFINITY};
        table->used++;
    }
    return o;
}

void scenery_sums_area(ScenerySums *sums, const SumRules *rules, const SharedBlock *of)
{
    const Hits       *hits = &of->samples->hits;
    const PixelBlock *block = of->block;
    const int         samples = block->n * block->n;
    ScenerySum       *o = NULL;
    for (int i = 0; i < hits->count; i++) {
        if (hits->kind[i] != hit_scenery) continue;
        if (!o || o->instance != hits->instance[i]) o = take_object(sums, rules->arena, hits->instance[i]);
        if (!o) return;
        const int x = block->x[i / samples], y = block->y[i / samples];
        int64_t   seen;
        target_sums_steps(&seen, rules, of, picture_index(rules->picture, x, y));
        o->steps += seen;
        if (of->share < 0) continue; /* what is taken back was there: boxes keep it, as those of targets do */
        grow_pixel_box(o->box, x, y);
        o->nearest_m = fmin(o->nearest_m, hits->range_m[i]);
    }
}

void scenery_sums_heat(ScenerySums *sums, const SumRules *rules, const Samples *s)
{
    ScenerySum *o = NULL;
    for (int i = 0; i < s->hits.count; i++) {
        if (s->hits.kind[i] != hit_scenery || !isfinite(s->temp_k[i])) continue;
        if (!o || o->instance != s->hits.instance[i]) o = take_object(sums, rules->arena, s->hits.instance[i]);
        if (!o) return;
        o->hottest_k = fmaxf(o->hottest_k, s->temp_k[i]);
    }
}

static int by_instance(const void *pa, const void *pb)
{
    const ScenerySum *a = pa, *b = pb;
    return (a->instance > b->instance) - (a->instance < b->instance);
}

static void join_box(int box[4], const int other[4])
{
    if (other[2] == 0) return;
    grow_pixel_box(box, other[0], other[1]);
    grow_pixel_box(box, other[2] - 1, other[3] - 1);
}

Status scenery_sums_gather(Picture *picture, const SumRules *rules, const ScenerySums *const *sums, int workers,
                           const Scenery *scenery, Arena *arena)
{
    size_t most = 0, count = 0;
    for (int w = 0; w < workers; w++) {
        if (sums[w]->lost) return STATUS_NO_MEMORY;
        most += sums[w]->used;
    }
    if (most == 0) return STATUS_OK;
    ScenerySum *all = arena_alloc(arena, most, sizeof *all);
    picture->scenery = arena_alloc(arena, most, sizeof *picture->scenery);
    if (!all || !picture->scenery) return STATUS_NO_MEMORY;
    for (int w = 0; w < workers; w++)
        for (size_t i = 0; i < sums[w]->capacity; i++)
            if (sums[w]->slot[i].instance && scenery->object[sums[w]->slot[i].instance - 1].kind == SCENERY_CLUTTER)
                all[count++] = sums[w]->slot[i];
    qsort(all, count, sizeof *all, by_instance);
    for (size_t i = 0, end; i < count; i = end) {
        ScenerySum sum = all[i];
        for (end = i + 1; end < count && all[end].instance == sum.instance; end++) {
            sum.steps += all[end].steps;
            sum.nearest_m = fmin(sum.nearest_m, all[end].nearest_m);
            sum.hottest_k = fmaxf(sum.hottest_k, all[end].hottest_k);
            join_box(sum.box, all[end].box);
        }
        if (sum.steps <= 0) continue; /* first samples met it that others replaced, or a small target covers it */
        SceneryPixels *out = &picture->scenery[picture->scenery_count++];
        *out = (SceneryPixels){.object = (int)sum.instance - 1,
                               .visible = (double)sum.steps / (double)rules->steps_per_px,
                               .range_m = sum.nearest_m,
                               .hottest_k = isfinite(sum.hottest_k) ? (double)sum.hottest_k : NAN};
        memcpy(out->box, sum.box, sizeof out->box);
    }
    return STATUS_OK;
}
