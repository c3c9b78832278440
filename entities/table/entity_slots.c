/* entities/table/entity_slots.c: slots of entities: found, made and ended; and which of them a full table keeps, by
 * their ranks (entity_limits_private.h) and the focus. */
#include "entities/table/entity_table_private.h"

EntitySlot *entity_slot_find(const EntityTable *table, DisEntityId id)
{
    const int s = entity_index_find(&table->index, entity_key(id));
    return s < 0 ? NULL : table->slot + s;
}

EntitySlot *entity_slot_new(EntityTable *table, DisEntityId id, double t_s)
{
    const int      s = table->free_count > 0 ? table->free_slot[--table->free_count] : table->slot_end++;
    EntitySlot    *slot = table->slot + s;
    const uint32_t generation = slot->generation + 1;
    memset(slot, 0, sizeof *slot);
    slot->generation = generation;
    slot->id = id;
    slot->created_s = t_s;
    entity_index_insert(&table->index, entity_key(id), s);
    table->count++;
    return slot;
}

/* Takes an entity out of the table, without counting why. */
static void free_slot(EntityTable *table, EntitySlot *slot)
{
    const int s = (int)(slot - table->slot);
    entity_ranks_remove(table->ranks, s);
    entity_index_remove(&table->index, entity_key(slot->id));
    table->stopped_count -= slot->stopped;
    slot->generation++;
    table->free_slot[table->free_count++] = s;
    table->count--;
}

void entity_slot_remove(EntityTable *table, EntitySlot *slot, double t_s, uint64_t *counter)
{
    if (counter != &table->counters.evicted) { /* an evicted entity may come back, so it gets no tombstone */
        tombstones_put(table->tombstones, slot->id, t_s, counter == &table->counters.detonated);
        table->counters.tombstones_dropped = tombstones_dropped(table->tombstones);
    }
    entity_effects_end(table, slot, t_s);
    entity_marks_end(table, slot, entity_slot_silent(slot, t_s), t_s);
    free_slot(table, slot);
    ++*counter;
}

double entity_slot_spin(const EntitySlot *slot, double t_s)
{
    if (entity_slot_frozen(slot) || slot->stopped) return slot->spin_s;
    return slot->spin_s + fmax(0, fmin(t_s, drives_run_until(&slot->drives) + slot->paused_s) - slot->spin_from_s);
}

/* The chord between both positions along their mean heading; within 4 % of the arc for turns of up to a radian. */
double entity_slot_forward(const EntitySlot *slot, const double p_ecef[3], const double r_ecef_from_body[9])
{
    const double *r0 = slot->reported.r_ecef_from_body;
    const double  sum[3] = {r0[0] + r_ecef_from_body[0], r0[3] + r_ecef_from_body[3], r0[6] + r_ecef_from_body[6]};
    double        forward[3], moved[3];
    if (!v3_normalize(forward, sum)) return 0;
    v3_sub(moved, p_ecef, slot->reported.p_ecef);
    return v3_dot(moved, forward);
}

/* ---- eviction ---------------------------------------------------------------------------------- */

static bool same_id(DisEntityId a, DisEntityId b) { return dis_entity_id_compare(a, b) == 0; }

static int distance_class(const EntityTable *table, const double p_ecef[3])
{
    return table->focus.placed ? entity_rank_class(p_ecef, table->focus.p_ecef) : entity_rank_unknown;
}

static int slot_class(const void *user, int slot)
{
    const EntityTable *table = user;
    return distance_class(table, table->slot[slot].reported.p_ecef);
}

static void rank_all_again(EntityTable *table, double t_s)
{
    entity_ranks_again(table->ranks, slot_class, table);
    memcpy(table->focus.ranked_ecef, table->focus.p_ecef, sizeof table->focus.ranked_ecef);
    table->focus.ranked_s = t_s;
}

/* The host's last reported position is the focus. Distances of the others are updated at their own reports; all of them
 * when a focus is first set, and when it has moved far enough to matter, once a second at most. */
static void place_focus(EntityTable *table, const double p_ecef[3], double t_s)
{
    static const double far_m = 500, often_s = 1;
    EntityFocus        *focus = &table->focus;
    const bool          first = !focus->placed || !focus->of_host;
    double              went[3];
    memcpy(focus->p_ecef, p_ecef, sizeof focus->p_ecef);
    focus->placed = focus->of_host = true;
    v3_sub(went, focus->p_ecef, focus->ranked_ecef);
    if (first || (v3_length(went) > far_m && fabs(t_s - focus->ranked_s) >= often_s)) rank_all_again(table, t_s);
}

void entity_slot_rank(EntityTable *table, EntitySlot *slot, const double p_ecef[3], double t_s)
{
    static const double known_after_s = 1;
    const int           s = (int)(slot - table->slot);
    if (t_s - slot->created_s >= known_after_s) slot->known = true;
    if (same_id(slot->id, table->focus.host)) place_focus(table, p_ecef, t_s);
    if (same_id(slot->id, table->focus.host) || same_id(slot->id, table->focus.also))
        entity_ranks_remove(table->ranks, s);
    else entity_ranks_put(table->ranks, s, slot->id, slot->known, distance_class(table, p_ecef));
}

bool entity_slot_admit(EntityTable *table, EntitySlot *newcomer, double t_s)
{
    if (table->count <= table->config.capacity) return true;
    const int   worst = entity_ranks_worst(table->ranks);
    EntitySlot *slot = worst < 0 ? newcomer : table->slot + worst;
    if (slot != newcomer) {
        entity_slot_remove(table, slot, t_s, &table->counters.evicted);
        return true;
    }
    free_slot(table, newcomer);
    table->counters.refused++;
    return false;
}

void entity_table_focus(EntityTable *table, DisEntityId host, DisEntityId also)
{
    const DisEntityId before[2] = {table->focus.host, table->focus.also}, now[2] = {host, also};
    if (same_id(before[0], host) && same_id(before[1], also)) return;
    if (!same_id(before[0], host)) table->focus.of_host = false;
    table->focus.host = host;
    table->focus.also = also;
    for (int i = 0; i < 2; i++) {
        EntitySlot *slot = entity_slot_find(table, before[i]);
        if (slot) entity_slot_rank(table, slot, slot->reported.p_ecef, slot->report_s);
    }
    for (int i = 0; i < 2; i++) {
        EntitySlot *slot = entity_slot_find(table, now[i]);
        if (slot) entity_slot_rank(table, slot, slot->reported.p_ecef, slot->report_s);
    }
}

int entity_table_largest_sender(DisEntityId *sender, const EntityTable *table)
{
    return entity_ranks_largest(sender, table->ranks);
}
