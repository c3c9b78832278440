/* entities/scenery/scenery_puffs.c: sources of scenery by range, and their puffs in a snapshot. */
#include "entities/scenery/scenery_puffs_private.h"

#include <stdlib.h>

static int by_range(const void *pa, const void *pb)
{
    const SceneryNear *a = pa, *b = pb;
    return a->range_m != b->range_m ? (a->range_m > b->range_m) - (a->range_m < b->range_m)
                                    : (a->which > b->which) - (a->which < b->which);
}

int scenery_nearest(SceneryNear *near, int count, int most)
{
    qsort(near, (size_t)count, sizeof *near, by_range);
    return count < most ? count : most;
}

bool scenery_in_cone(double *range_m, const SceneryCone *seen, const double p_enu[3], double radius_m, double most_m)
{
    double to[3];
    v3_sub(to, p_enu, seen->p_enu);
    *range_m = v3_length(to);
    const double along_m = v3_dot(to, seen->d_enu), off_m = sqrt(fmax(*range_m * *range_m - along_m * along_m, 0));
    return *range_m < most_m && along_m > -radius_m &&
           off_m < seen->tangent * fmax(along_m, 0) + radius_m * sqrt(1 + seen->tangent * seen->tangent);
}

Status scenery_puff_room(EffectPuff **at, size_t *room, Snapshot *s, size_t more, Arena *arena)
{
    const size_t was = (size_t)s->puff_count, left = effect_puff_capacity - was;
    *room = more < left ? more : left;
    *at = NULL;
    if (*room == 0) return STATUS_OK;
    EffectPuff *puff = arena_alloc_raw(arena, was + *room, sizeof *puff);
    if (!puff) return STATUS_NO_MEMORY;
    if (was > 0) memcpy(puff, s->puff, was * sizeof *puff);
    s->puff = puff, *at = puff + was;
    return STATUS_OK;
}

Status scenery_add_puffs(Snapshot *s, const EffectSource *source, int count, Arena *arena)
{
    size_t      all = 0, room;
    EffectPuff *at;
    for (int k = 0; k < count; k++) all += effect_source_puffs(NULL, 0, s->effect_table, &source[k], s->t_s);
    const Status status = scenery_puff_room(&at, &room, s, all, arena);
    for (int k = 0; k < count && room > 0 && status == STATUS_OK; k++) {
        const size_t of = effect_source_puffs(at, room, s->effect_table, &source[k], s->t_s);
        const size_t put = of < room ? of : room;
        at += put, room -= put, s->puff_count += (int)put;
    }
    return status;
}
