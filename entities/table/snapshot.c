/* entities/table/snapshot.c: what can be asked of a snapshot and of one of its entities. */
#include "entities/table/entity_index.h"
#include "entities/table/snapshot.h"

void snapshot_drift(double *drift_m, double *drift_rad, double age_s, const SnapshotMiss *missed, double otherwise_m,
                    double heartbeat_s)
{
    static const double threshold_rad = 3 * (3.14159265358979323846 / 180);
    *drift_m = otherwise_m;
    *drift_rad = threshold_rad * fmin(fmax(age_s, 0) / heartbeat_s, 1);
    if (!(missed->s > 0)) return;
    const double share = clamp(age_s / missed->s, 0, 1);
    *drift_m = missed->m * share * share;
    *drift_rad = missed->rad * share;
}

int snapshot_find(const Snapshot *snapshot, DisEntityId id)
{
    int low = 0, high = snapshot->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        const int order = dis_entity_id_compare(snapshot->entity[middle].id, id);
        if (order == 0) return middle;
        if (order < 0) low = middle + 1;
        else high = middle;
    }
    return -1;
}

bool snapshot_owns_puff(const Snapshot *snapshot, int index, const EffectPuff *puff)
{
    return puff->owner == entity_key(snapshot->entity[index].id) + 1;
}

int snapshot_damage(const SnapshotEntity *entity)
{
    return entity->type.kind == dis_kind_platform ? (int)(entity->appearance >> dis_appearance_damage_shift & 3) : 0;
}

bool snapshot_is_short_lived(const SnapshotEntity *entity)
{
    return entity->type.kind == dis_kind_munition || entity->type.kind == dis_kind_expendable;
}

bool snapshot_is_wreck(const SnapshotEntity *entity) { return snapshot_damage(entity) == dis_damage_destroyed; }
