/* entities/table/entity_table.c: the table, and the effects of PDUs other than Entity State. Slots: entity_slots.c;
 * reports: entity_report.c; from a slot to a pose: entity_snapshot.c. */
#include "entities/table/entity_table_private.h"

#include <stdlib.h>

enum { capacity_limit = 1 << 22 };

EntityTableConfig entity_table_default_config(void)
{
    return (EntityTableConfig){.capacity = 16384,
                               .shown = capacity_limit,
                               .timeout_s = 12,
                               .timeout_land_v7_s = 132,
                               .extrapolation_limit_s = 12,
                               .rate_limit_rps = 20,
                               .stood_s = 3600,
                               .new_per_s = 65536};
}

static bool config_is_usable(const EntityTableConfig *config)
{
    const double positive[4] = {config->timeout_s, config->timeout_land_v7_s, config->extrapolation_limit_s,
                                config->rate_limit_rps};
    for (int i = 0; i < 4; i++)
        if (!(positive[i] > 0 && positive[i] <= 1e6)) return false;
    return config->capacity > 0 && config->capacity <= capacity_limit && config->shown > 0 && !(config->stood_s < 0) &&
           config->new_per_s >= 1 && config->new_per_s <= 1e9;
}

static uint32_t roles_of(const Model *model)
{
    uint32_t roles = 0;
    for (int p = 0; p < model->part_count; p++) roles |= UINT32_C(1) << model->part[p].role;
    return roles;
}

Status entity_table_create(EntityTable **out, const EntityTableConfig *config, const Catalog *catalog)
{
    if (!config_is_usable(config)) {
        log_error("entity_table: configuration out of range: capacity=%d of 1 .. %d, times and rates above 0 up to 1e6",
                  config->capacity, capacity_limit);
        return STATUS_BAD_VALUE;
    }
    Status       status = STATUS_NO_MEMORY;
    EntityTable *table = calloc(1, sizeof *table);
    if (!table) return status;

    table->config = *config;
    table->catalog = catalog;
    table->arrival_s = NAN;
    const int slots = config->capacity + 1;
    table->slot = calloc((size_t)slots, sizeof *table->slot);
    table->free_slot = calloc((size_t)slots, sizeof *table->free_slot);
    table->mark = calloc((size_t)slots, sizeof *table->mark);
    table->outlet = calloc((size_t)catalog_model_count(catalog), sizeof *table->outlet);
    table->stood = calloc((size_t)catalog_model_count(catalog), sizeof *table->stood);
    table->model_roles = calloc((size_t)catalog_model_count(catalog), sizeof *table->model_roles);
    if (!table->slot || !table->free_slot || !table->mark || !table->model_roles || !table->outlet || !table->stood)
        goto fail;
    status = entity_index_create(&table->index, slots);
    if (status == STATUS_OK) status = entity_ranks_create(&table->ranks, slots, config->capacity);
    if (status == STATUS_OK)
        status = tombstones_create(&table->tombstones, config->capacity, config->timeout_land_v7_s);
    if (status == STATUS_OK) status = entity_rate_create(&table->rate, config->new_per_s);
    if (status != STATUS_OK) goto fail;
    status = ground_history_create(&table->ground);
    if (status != STATUS_OK) goto fail;
    char path[4096];
    status = STATUS_BAD_VALUE;
    if (etc_path(path, sizeof path, "effects.csv")) status = effect_history_create(&table->effects, path);
    if (status != STATUS_OK) goto fail;
    for (int m = 0; m < catalog_model_count(catalog); m++) table->model_roles[m] = roles_of(catalog_model(catalog, m));

    *out = table;
    return STATUS_OK;

fail:
    entity_table_destroy(table);
    return status;
}

void entity_table_destroy(EntityTable *table)
{
    if (!table) return;
    entity_index_destroy(&table->index);
    entity_ranks_destroy(table->ranks);
    tombstones_destroy(table->tombstones);
    entity_rate_destroy(table->rate);
    effect_history_destroy(table->effects);
    ground_history_destroy(table->ground);
    free(table->mark);
    free(table->slot);
    free(table->free_slot);
    free(table->model_roles);
    free(table->outlet);
    free(table->stood);
    free(table);
}

/* ---- what is in the table ---------------------------------------------------------------------- */

int entity_table_count(const EntityTable *table) { return table->count; }

EntityHandle entity_table_find(const EntityTable *table, DisEntityId id)
{
    const int s = entity_index_find(&table->index, entity_key(id));
    return s < 0 ? (EntityHandle){0} : (EntityHandle){(uint32_t)s, table->slot[s].generation};
}

bool entity_table_alive(const EntityTable *table, EntityHandle handle)
{
    return handle.slot < (uint32_t)table->slot_end && handle.generation & 1 &&
           table->slot[handle.slot].generation == handle.generation;
}

bool entity_table_type(DisEntityType *out, const EntityTable *table, EntityHandle handle)
{
    if (!entity_table_alive(table, handle)) return false;
    *out = table->slot[handle.slot].type;
    return true;
}

const EntityCounters *entity_table_counters(const EntityTable *table) { return &table->counters; }

Status entity_table_marks_save(const EntityTable *table, double unix_s, const char *path)
{
    return ground_marks_save(table->ground, unix_s, path);
}

Status entity_table_marks_load(EntityTable *table, double unix_s, const char *path)
{
    return ground_marks_load(table->ground, unix_s, path);
}

uint64_t entity_table_changes(const EntityTable *table) { return table->changes; }

const EffectCounters *entity_table_effect_counters(const EntityTable *table)
{
    return effect_history_counters(table->effects);
}

/* ---- events ------------------------------------------------------------------------------- */

static const uint16_t all_ids = 0xFFFF;

enum { most_rounds = 1000 }; /* most rounds of one Fire PDU: a burst, and not an arbitrary number */

void entity_table_fire(EntityTable *table, const DisFire *pdu, double t_s)
{
    effect_history_fire(table->effects, pdu, t_s);
    EntitySlot *firing = entity_slot_find(table, pdu->firing), *munition = entity_slot_find(table, pdu->munition);
    const int   rounds = pdu->descriptor.quantity > 0 ? pdu->descriptor.quantity : 1;
    if (firing)
        drives_fire(&firing->drives, effect_charge_kg(&pdu->descriptor, true),
                    rounds < most_rounds ? rounds : most_rounds);
    if (munition && munition->type.kind == dis_kind_munition)
        drives_launch(&munition->drives, entity_slot_running(munition, t_s));
    if (firing || munition) table->changes++;
}

/* A munition ends with its Detonation; not every sender reports that with a last Entity State. Version 7 also
 * detonates things that are no munition and may stay. */
void entity_table_detonation(EntityTable *table, const DisDetonation *pdu, double t_s)
{
    effect_history_detonation(table->effects, pdu, t_s);
    entity_marks_detonation(table, pdu, t_s);
    EntitySlot *munition = entity_slot_find(table, pdu->munition);
    if (!munition || munition->type.kind != dis_kind_munition || t_s < munition->created_s) return;
    entity_slot_remove(table, munition, t_s, &table->counters.detonated);
}

static bool part_matches(uint16_t asked, uint16_t is) { return asked == is || asked == all_ids; }

static bool id_matches(DisEntityId asked, DisEntityId is)
{
    return part_matches(asked.site, is.site) && part_matches(asked.application, is.application) &&
           part_matches(asked.entity, is.entity);
}

void entity_table_remove(EntityTable *table, const DisRemoveEntity *pdu, double t_s)
{
    const DisEntityId asked = pdu->receiving;
    if (asked.site != all_ids && asked.application != all_ids && asked.entity != all_ids) {
        EntitySlot *slot = entity_slot_find(table, asked);
        if (slot) entity_slot_remove(table, slot, t_s, &table->counters.removed);
        return;
    }
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (entity_slot_lives(slot) && id_matches(asked, slot->id))
            entity_slot_remove(table, slot, t_s, &table->counters.removed);
    }
}

void entity_table_stop(EntityTable *table, const DisStopFreeze *pdu, double t_s)
{
    if (table->stopped_count == table->count) return; /* a repeated PDU must not cost another walk over all entities */
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (!entity_slot_lives(slot) || slot->stopped || !dis_simulation_names(pdu->receiving, slot->id)) continue;
        const double stop_s = fmax(t_s, slot->report_s);
        entity_marks_stop(table, slot, stop_s);
        slot->spin_s = entity_slot_spin(slot, stop_s);
        slot->spin_from_s = stop_s;
        slot->stop_s = stop_s;
        slot->stopped = true;
        slot->reports_on = dis_stop_lets_report(pdu);
        table->stopped_count++;
        entity_effects_report(table, slot, stop_s);
    }
}

/* Continues from the entity's position: the pause does not count as motion. */
void entity_table_start(EntityTable *table, const DisStartResume *pdu, double t_s)
{
    if (table->stopped_count == 0) return;
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (!entity_slot_lives(slot) || !slot->stopped || !dis_simulation_names(pdu->receiving, slot->id)) continue;
        slot->paused_s += fmax(0, t_s - slot->stop_s);
        slot->spin_from_s = fmax(t_s, slot->stop_s);
        slot->stopped = false;
        table->stopped_count--;
        entity_marks_start(table, slot, fmax(t_s, slot->stop_s));
        entity_effects_report(table, slot, fmax(t_s, slot->stop_s));
    }
}

void entity_table_expire(EntityTable *table, double t_s)
{
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (entity_slot_lives(slot) && entity_slot_silent(slot, t_s))
            entity_slot_remove(table, slot, t_s, &table->counters.timed_out);
    }
}

/* ---- by type ------------------------------------------------------------------------------ */

/* Passes on a report, and counts what the table refuses. */
static Status take_report(EntityTable *table, const DisPdu *pdu, double t_s, DisCounters *counters)
{
    DisDrop    why;
    const bool update = pdu->type == dis_pdu_entity_state_update;
    if (!(update ? dis_entity_state_update_is_usable(&why, &pdu->update)
                 : dis_entity_state_is_usable(&why, &pdu->entity_state))) {
        counters->dropped[why]++;
        return STATUS_OK;
    }
    return update ? entity_table_entity_state_update(table, &pdu->update, t_s)
                  : entity_table_entity_state(table, &pdu->entity_state, t_s);
}

void entity_table_arrival(EntityTable *table, double now_s, bool by_stamp)
{
    table->arrival_s = now_s;
    table->by_stamp = by_stamp;
}

void entity_table_pdu(EntityTable *table, const DisPdu *pdu, double t_s, DisCounters *counters)
{
    if (!isfinite(t_s)) return;
    switch (pdu->type) {
    case dis_pdu_entity_state:
    case dis_pdu_entity_state_update:
        if (take_report(table, pdu, t_s, counters) == STATUS_UNSUPPORTED) counters->dropped[DIS_DROP_TABLE_FULL]++;
        break;
    case dis_pdu_fire:
        entity_table_fire(table, &pdu->fire, t_s);
        break;
    case dis_pdu_detonation:
        entity_table_detonation(table, &pdu->detonation, t_s);
        break;
    case dis_pdu_remove_entity:
    case dis_pdu_remove_entity_r:
        entity_table_remove(table, &pdu->remove, t_s);
        break;
    case dis_pdu_start_resume:
    case dis_pdu_start_resume_r:
        entity_table_start(table, &pdu->start, t_s);
        break;
    case dis_pdu_stop_freeze:
    case dis_pdu_stop_freeze_r:
        entity_table_stop(table, &pdu->stop, t_s);
        break;
    default:
        break;
    }
}
