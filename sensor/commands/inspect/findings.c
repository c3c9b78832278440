/* sensor/commands/inspect/findings.c: one pass over a log: every PDU decoded once, rows by id. */
#include "sensor/commands/inspect/findings_private.h"

#include "dis/capture/log.h"
#include "dis/pdu/decode.h"

#include <math.h>
#include <stdlib.h>

/* Adds a zeroed row at the end; NULL when memory is out. */
static void *add_row(Rows *rows)
{
    if (rows->count == rows->capacity) {
        if (rows->capacity > (1 << 28)) return NULL;
        const int capacity = rows->capacity ? 2 * rows->capacity : 64;
        char     *grown = realloc(rows->row, (size_t)capacity * rows->size);
        if (!grown) return NULL;
        rows->row = grown;
        rows->capacity = capacity;
    }
    void *row = findings_row(rows, rows->count++);
    memset(row, 0, rows->size);
    return row;
}

static uint32_t hash_id(DisEntityId id, uint32_t slots)
{
    const uint64_t key = (uint64_t)id.site << 32 | (uint64_t)id.application << 16 | id.entity;
    return (uint32_t)(key * 0x9E3779B97F4A7C15u >> 32) & (slots - 1);
}

/* The row of an id, made when it is new. Every keyed row begins with its DisEntityId. */
static void *row_of(Rows *rows, DisEntityId id)
{
    if (2 * (uint32_t)rows->count >= rows->slots) {
        const uint32_t slots = rows->slots ? 2 * rows->slots : 256;
        uint32_t      *slot = calloc(slots, sizeof *slot);
        if (!slot) return NULL;
        for (int i = 0; i < rows->count; i++) {
            DisEntityId other;
            memcpy(&other, findings_row(rows, i), sizeof other);
            uint32_t s = hash_id(other, slots);
            while (slot[s]) s = (s + 1) & (slots - 1);
            slot[s] = (uint32_t)i + 1;
        }
        free(rows->slot);
        rows->slot = slot;
        rows->slots = slots;
    }
    uint32_t s = hash_id(id, rows->slots);
    for (; rows->slot[s]; s = (s + 1) & (rows->slots - 1)) {
        char *row = findings_row(rows, (int)rows->slot[s] - 1);
        if (memcmp(row, &id, sizeof id) == 0) return row;
    }
    char *row = add_row(rows);
    if (!row) return NULL;
    memcpy(row, &id, sizeof id);
    rows->slot[s] = (uint32_t)rows->count;
    return row;
}

static int compare_rows(const void *a, const void *b)
{
    DisEntityId x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return dis_entity_id_compare(x, y);
}

/* ---- the pass ------------------------------------------------------------------------------------ */

static void note_motion(Findings *f, EntityRow *row, DisEntityId id, const double p_ecef[3],
                        const float velocity_mps[3], const float euler_rad[3], double t_s)
{
    DisDrop why;
    if (row->reports++ == 0) row->first_s = row->last_s = t_s;
    row->first_s = fmin(row->first_s, t_s);
    row->last_s = fmax(row->last_s, t_s);
    if (!dis_entity_is_usable(&why, id, p_ecef, velocity_mps, euler_rad)) {
        f->counters.dropped[why]++;
        return;
    }
    const double v_mps[3] = {velocity_mps[0], velocity_mps[1], velocity_mps[2]};
    row->fastest_mps = fmax(row->fastest_mps, v3_length(v_mps)); /* the same in world and body axes */
    if (row->placed) {
        double step_m[3];
        v3_sub(step_m, p_ecef, row->last_ecef);
        row->travelled_m += v3_length(step_m);
    } else {
        memcpy(row->first_ecef, p_ecef, sizeof row->first_ecef);
        row->placed = true;
    }
    memcpy(row->last_ecef, p_ecef, sizeof row->last_ecef);
}

static Status note_entity_state(Findings *f, const DisEntityState *es, double t_s)
{
    EntityRow *row = row_of(&f->entities, es->id);
    if (!row) return STATUS_NO_MEMORY;
    const float euler_rad[3] = {es->psi_rad, es->theta_rad, es->phi_rad};
    note_motion(f, row, es->id, es->p_ecef, es->velocity_mps, euler_rad, t_s);
    row->type = es->type;
    row->force = es->force;
    memcpy(row->marking, es->marking, sizeof row->marking);
    if (es->variable_count > row->most_variable) row->most_variable = es->variable_count;
    row->algorithms[es->dead_reckoning / 32] |= (uint32_t)1 << es->dead_reckoning % 32;
    row->deactivated = es->appearance >> 23 & 1;
    return STATUS_OK;
}

static Status note_update(Findings *f, const DisEntityStateUpdate *update, double t_s)
{
    EntityRow *row = row_of(&f->entities, update->id);
    if (!row) return STATUS_NO_MEMORY;
    const float euler_rad[3] = {update->psi_rad, update->theta_rad, update->phi_rad};
    note_motion(f, row, update->id, update->p_ecef, update->velocity_mps, euler_rad, t_s);
    row->deactivated = update->appearance >> 23 & 1;
    return STATUS_OK;
}

static Status note_event(Findings *f, EventRow event)
{
    EventRow *row = add_row(&f->events);
    if (!row) return STATUS_NO_MEMORY;
    *row = event;
    return STATUS_OK;
}

static Status note_pdu(Findings *f, const DisPdu *pdu, double t_s)
{
    switch (pdu->type) {
    case dis_pdu_entity_state:
        return note_entity_state(f, &pdu->entity_state, t_s);
    case dis_pdu_entity_state_update:
        return note_update(f, &pdu->update, t_s);
    case dis_pdu_fire:
        return note_event(f, (EventRow){t_s, true, pdu->fire.firing, pdu->fire.target, pdu->fire.munition,
                                        pdu->fire.descriptor.type, 0});
    case dis_pdu_detonation:
        return note_event(f, (EventRow){t_s, false, pdu->detonation.firing, pdu->detonation.target,
                                        pdu->detonation.munition, pdu->detonation.descriptor.type,
                                        pdu->detonation.result});
    case dis_pdu_remove_entity:
    case dis_pdu_remove_entity_r:
        f->removed++;
        return STATUS_OK;
    case dis_pdu_start_resume:
    case dis_pdu_start_resume_r:
        f->started++;
        return STATUS_OK;
    case dis_pdu_stop_freeze:
    case dis_pdu_stop_freeze_r:
        f->stopped++;
        return STATUS_OK;
    default:
        return STATUS_OK;
    }
}

Status findings_gather(Findings *f, const DisLog *log, int exercise)
{
    static DisPdu decoded; /* 11 KiB, and the command has one thread */
    DisLogTimes   times = {0};
    size_t        next = 0;
    Status        status = dis_log_times(&times, log, exercise);
    *f = (Findings){
        .entities.size = sizeof(EntityRow), .senders.size = sizeof(SenderRow), .events.size = sizeof(EventRow)};
    f->first_s = INFINITY;
    f->last_s = -INFINITY;
    for (int i = 0; i < log->count && status == STATUS_OK; i++) {
        const DisDatagram d = dis_log_datagram(log, i);
        const uint8_t    *at = d.bytes, *end = d.bytes + d.octets, *pdu;
        DisHeader         header;
        f->counters.datagrams++;
        while (status == STATUS_OK && dis_next_pdu(&header, &pdu, &at, end, &f->counters)) {
            f->exercise[header.exercise]++;
            if (exercise >= 0 && header.exercise != exercise) {
                f->counters.dropped[DIS_DROP_OTHER_EXERCISE]++;
                continue;
            }
            f->version[header.version]++;
            const double t_s = times.pdu[next++].t_s;
            uint16_t     sender[2];
            if (!dis_pdu_sender(sender, &header, pdu)) continue;
            SenderRow *row = row_of(&f->senders, (DisEntityId){sender[0], sender[1], 0});
            if (!row) {
                status = STATUS_NO_MEMORY;
                break;
            }
            row->pdus++;
            row->absolute += dis_timestamp_is_absolute(header.timestamp);
            row->unstamped += header.timestamp == 0;
            row->version[header.version] = true;
            f->first_s = fmin(f->first_s, t_s);
            f->last_s = fmax(f->last_s, t_s);
            const Status refused = dis_decode(&decoded, pdu, header.length);
            if (refused != STATUS_OK) dis_count_refused(&f->counters, header.type, refused);
            else status = note_pdu(f, &decoded, t_s);
        }
    }
    f->doubts = times.doubts;
    dis_log_times_release(&times);
    if (f->entities.count) qsort(f->entities.row, (size_t)f->entities.count, f->entities.size, compare_rows);
    if (f->senders.count) qsort(f->senders.row, (size_t)f->senders.count, f->senders.size, compare_rows);
    return status;
}

void findings_release(Findings *f)
{
    Rows *const all[3] = {&f->entities, &f->senders, &f->events};
    for (int i = 0; i < 3; i++) {
        free(all[i]->row);
        free(all[i]->slot);
    }
}
