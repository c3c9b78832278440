/* sensor/commands/inspect.c: one pass over a log, then a summary; or one line per Entity State.
 *
 * The lines are those of `tshark -T fields`, column names and number formats too, so that either program can be
 * held against the other. */
#include "sensor/commands/inspect.h"

#include "dis/entity_state.h"
#include "dis/exercise_clock.h"
#include "dis/log.h"
#include "dis/simulation_management.h"
#include "dis/warfare.h"
#include "entities/catalog/catalog.h"
#include "terrain/earth/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const char usage_text[] =
    "usage: pitviper inspect LOG [--pdus tsv [--full]] [--port N] [--exercise N]\n"
    "\n"
    "LOG is a pcap or pcapng capture, also compressed (gzip, zstd, bzip2, xz). Without --pdus: a summary of\n"
    "the exercise.\n"
    "\n"
    "  --pdus tsv    one line per Entity State PDU, with the columns and formats of\n"
    "                tshark -d udp.port==3000,dis -T fields\n"
    "  --full        with --pdus tsv: also entity type, dead reckoning, capabilities,\n"
    "                alternative type and articulation (change:attached:parameter:value; ...)\n"
    "  --port N      UDP destination port; 0: any that carries DIS (default: 3000, any when nothing went there)\n"
    "  --exercise N  only this exercise, 0 .. 255; default: all\n";

typedef struct Options {
    const char *path;
    bool        tsv, full;
    long long   port, exercise; /* exercise -1: all */
} Options;

/* ---- what is gathered for the summary --------------------------------------------------------- */

typedef struct EntityRow {
    DisEntityId   id;
    DisEntityType type;
    char          marking[11];
    uint8_t       force, most_variable;
    uint64_t      reports;
    bool          placed;              /* some report had a usable position */
    double        first_s, last_s;
    double        first_ecef[3], last_ecef[3];
    double        travelled_m, fastest_mps;
    uint32_t      algorithms[8];       /* bit set over 0 .. 255 */
    bool          deactivated;
} EntityRow;

typedef struct SenderRow {
    DisEntityId id; /* entity 0 */
    uint64_t    pdus, absolute, unstamped;
    bool        version[8];
} SenderRow;

typedef struct EventRow {
    double        t_s;
    bool          fire;
    DisEntityId   firing, target, munition;
    DisEntityType type;
    uint8_t       result;
} EventRow;

/* A growing array of rows, with a hash over their ids where they have one. */
typedef struct Rows {
    size_t    size; /* of a row */
    int       count, capacity;
    char     *row;
    uint32_t *slot; /* row + 1, 0 = empty [slots] */
    uint32_t  slots;
} Rows;

typedef struct Findings {
    DisCounters counters;
    uint64_t    version[8], exercise[256];
    double      first_s, last_s;
    Rows        entities, senders, events;
    uint64_t    removed, started, stopped;
    ExerciseClockDoubts doubts; /* senders whose stamps are no clock */
} Findings;

static void *row_at(const Rows *rows, int i) { return rows->row + (size_t)i * rows->size; }

/* A zeroed row at the end; NULL when memory is out. */
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
    void *row = row_at(rows, rows->count++);
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
            memcpy(&other, row_at(rows, i), sizeof other);
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
        char *row = row_at(rows, (int)rows->slot[s] - 1);
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

/* Reads one PDU of a type this node decodes. A decoder that fails is a drop, not an error. */
static Status note_pdu(Findings *f, uint8_t type, const uint8_t *pdu, size_t octets, double t_s)
{
    static union { /* 10 KB each: not on the stack of a loop, and the command has one thread */
        DisEntityState       es;
        DisEntityStateUpdate update;
        DisFire              fire;
        DisDetonation        detonation;
    } u;
    Status decoded = STATUS_OK, status = STATUS_OK;
    switch (type) {
    case dis_pdu_entity_state:
        decoded = dis_decode_entity_state(&u.es, pdu, octets);
        if (decoded == STATUS_OK) status = note_entity_state(f, &u.es, t_s);
        break;
    case dis_pdu_entity_state_update:
        decoded = dis_decode_entity_state_update(&u.update, pdu, octets);
        if (decoded == STATUS_OK) status = note_update(f, &u.update, t_s);
        break;
    case dis_pdu_fire:
        decoded = dis_decode_fire(&u.fire, pdu, octets);
        if (decoded == STATUS_OK)
            status = note_event(f, (EventRow){t_s, true, u.fire.firing, u.fire.target, u.fire.munition,
                                              u.fire.descriptor.type, 0});
        break;
    case dis_pdu_detonation:
        decoded = dis_decode_detonation(&u.detonation, pdu, octets);
        if (decoded == STATUS_OK)
            status = note_event(f, (EventRow){t_s, false, u.detonation.firing, u.detonation.target,
                                              u.detonation.munition, u.detonation.descriptor.type,
                                              u.detonation.result});
        break;
    case dis_pdu_remove_entity: f->removed++; break;
    case dis_pdu_start_resume: f->started++; break;
    case dis_pdu_stop_freeze: f->stopped++; break;
    default: break;
    }
    if (decoded == STATUS_TRUNCATED) f->counters.dropped[DIS_DROP_TRUNCATED]++;
    if (decoded == STATUS_BAD_VALUE) f->counters.dropped[DIS_DROP_BAD_COUNT]++;
    return status;
}

static Status gather(Findings *f, const DisLog *log, const Options *options)
{
    ExerciseClock *clock = NULL;
    Status         status = exercise_clock_create(&clock);
    f->first_s = INFINITY;
    f->last_s = -INFINITY;
    for (int i = 0; i < log->count && status == STATUS_OK; i++) {
        const DisDatagram *d = &log->datagram[i];
        const uint8_t     *at = d->bytes, *end = d->bytes + d->octets, *pdu;
        DisHeader          header;
        f->counters.datagrams++;
        while (status == STATUS_OK && dis_next_pdu(&header, &pdu, &at, end, &f->counters)) {
            f->exercise[header.exercise]++;
            if (options->exercise >= 0 && header.exercise != options->exercise) {
                f->counters.dropped[DIS_DROP_OTHER_EXERCISE]++;
                continue;
            }
            f->version[header.version]++;
            uint16_t sender[2];
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
            const double t_s = exercise_clock_pdu_time(clock, &header, pdu, d->capture_s);
            f->first_s = fmin(f->first_s, t_s);
            f->last_s = fmax(f->last_s, t_s);
            status = note_pdu(f, header.type, pdu, header.length, t_s);
        }
    }
    if (clock) f->doubts = *exercise_clock_doubts(clock);
    exercise_clock_destroy(clock);
    return status;
}

static void release(Findings *f)
{
    Rows *const all[3] = {&f->entities, &f->senders, &f->events};
    for (int i = 0; i < 3; i++) {
        free(all[i]->row);
        free(all[i]->slot);
    }
}

/* ---- the summary --------------------------------------------------------------------------------- */

static void print_log(const DisLog *log, const Findings *f, const char *path)
{
    text_print(stdout, "%s\n", path);
    if (log->count) {
        double first_s = INFINITY, last_s = -INFINITY;
        for (int i = 0; i < log->count; i++) {
            first_s = fmin(first_s, log->datagram[i].capture_s);
            last_s = fmax(last_s, log->datagram[i].capture_s);
        }
        const time_t whole_s = (time_t)floor(first_s);
        struct tm    utc;
        char         text[32] = "?";
        if (gmtime_r(&whole_s, &utc)) strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &utc);
        printf("  captured from %s UTC for %.3f s\n", text, last_s - first_s);
    }
    if (f->first_s <= f->last_s)
        printf("  exercise time %.3f .. %.3f s (%.3f s)\n", f->first_s, f->last_s, f->last_s - f->first_s);
    uint64_t pdus = 0;
    for (int type = 0; type < 256; type++) pdus += f->counters.pdus[type];
    printf("  %llu packets, %d datagrams, %llu PDUs%s\n", (unsigned long long)log->counters.packets, log->count,
           (unsigned long long)pdus, log->truncated ? "; the file ends inside a packet" : "");

    const DisLogCounters *c = &log->counters;
    const struct {
        uint64_t    count;
        const char *what;
    } left[] = {{c->other_link, "of a link layer that is not read"},
                {c->other_protocol, "not UDP over IP"},
                {c->other_port, "UDP to another port"},
                {c->cut_short, "cut short or with a wrong length"},
                {c->bad_fragment, "fragments of a datagram that never came whole"}};
    for (size_t i = 0; i < sizeof left / sizeof left[0]; i++)
        if (left[i].count) printf("  %llu packets left out: %s\n", (unsigned long long)left[i].count, left[i].what);
}

static void print_counts(const Findings *f)
{
    printf("\nPDUs\n");
    for (int type = 0; type < 256; type++)
        if (f->counters.pdus[type])
            printf("  %8llu  %3d %s\n", (unsigned long long)f->counters.pdus[type], type,
                   dis_pdu_type_name((uint8_t)type));
    for (int version = 5; version <= 7; version++)
        if (f->version[version])
            printf("  %8llu  of DIS version %d\n", (unsigned long long)f->version[version], version);
    for (int exercise = 0; exercise < 256; exercise++)
        if (f->exercise[exercise])
            printf("  %8llu  of exercise %d\n", (unsigned long long)f->exercise[exercise], exercise);

    bool any = false;
    for (int why = 0; why < DIS_DROP_COUNT; why++) any |= f->counters.dropped[why] != 0;
    printf("\nDropped\n");
    if (!any) printf("  nothing\n");
    for (int why = 0; why < DIS_DROP_COUNT; why++)
        if (f->counters.dropped[why])
            printf("  %8llu  %s\n", (unsigned long long)f->counters.dropped[why], dis_drop_name((DisDrop)why));
}

static void print_senders(const Findings *f)
{
    printf("\nSenders\n  %-12s %-8s %8s  stamps\n", "site:app", "version", "PDUs");
    for (int i = 0; i < f->senders.count; i++) {
        const SenderRow *row = row_at(&f->senders, i);
        char             name[16], versions[16] = "";
        snprintf(name, sizeof name, "%u:%u", row->id.site, row->id.application);
        for (int v = 5, n = 0; v <= 7; v++)
            if (row->version[v]) n += snprintf(versions + n, sizeof versions - (size_t)n, n ? ",%d" : "%d", v);
        const char *stamps = row->unstamped == row->pdus ? "none"
                             : row->absolute == 0        ? "relative"
                             : row->absolute == row->pdus ? "absolute"
                                                          : "relative and absolute";
        printf("  %-12s %-8s %8llu  %s\n", name, versions, (unsigned long long)row->pdus, stamps);
    }
    for (int i = 0; i < f->doubts.count; i++) {
        char text[exercise_clock_doubt_text_size];
        exercise_clock_doubt_text(text, sizeof text, &f->doubts.sender[i]);
        printf("  %s\n", text);
    }
}

static void algorithms_text(char *out, size_t size, const uint32_t algorithms[8])
{
    size_t n = 0;
    *out = 0;
    for (int a = 0; a < 256; a++)
        if (algorithms[a / 32] >> a % 32 & 1 && n + 5 < size)
            n += (size_t)snprintf(out + n, size - n, n ? ",%d" : "%d", a);
    if (!n) snprintf(out, size, "-");
}

static void print_entities(const Findings *f)
{
    printf("\nEntities (time: exercise time; place: first, WGS 84; dr: dead-reckoning algorithms; art: articulation "
           "records)\n");
    printf("  %-14s %-12s %-22s %5s %8s %11s %11s %10s %8s %-6s %3s  %s\n", "id", "marking", "type", "force", "reports",
           "first s", "last s", "path m", "max m/s", "dr", "art", "lat, lon deg, height m");
    for (int i = 0; i < f->entities.count; i++) {
        const EntityRow *row = row_at(&f->entities, i);
        char             id[dis_id_text_size], type[dis_type_text_size], marking[64], algorithms[24], place[64] = "-";
        dis_entity_id_text(id, row->id);
        dis_entity_type_text(type, row->type);
        text_escape(marking, sizeof marking, row->marking, strnlen(row->marking, sizeof row->marking));
        algorithms_text(algorithms, sizeof algorithms, row->algorithms);
        Geodetic first;
        if (row->placed && geodetic_from_ecef(&first, row->first_ecef) == STATUS_OK)
            snprintf(place, sizeof place, "%.5f, %.5f, %.1f", first.lat_rad / rad_per_deg, first.lon_rad / rad_per_deg,
                     first.h_m);
        printf("  %-14s %-12s %-22s %5u %8llu %11.3f %11.3f %10.1f %8.1f %-6s %3u  %s%s\n", id, marking, type,
               row->force, (unsigned long long)row->reports, row->first_s, row->last_s, row->travelled_m,
               row->fastest_mps, algorithms, row->most_variable, place, row->deactivated ? "; deactivated" : "");
    }
}

/* Each type once, in the order of the table above, with what it is seen as. */
static Status print_shapes(const Findings *f)
{
    static const double sag_m = 0.1; /* sizes are wanted, not facets */
    char path[4096];
    Catalog *catalog;
    if (f->entities.count == 0) return STATUS_OK;
    if (!etc_path(path, sizeof path, "catalog.csv")) return STATUS_BAD_VALUE;
    const Status status = catalog_open(&catalog, path, sag_m);
    if (status != STATUS_OK) return status;
    printf("\nShapes (of etc/catalog.csv: length x width x height m; from the ground, of hulls from the keel)\n");
    for (int i = 0; i < f->entities.count; i++) {
        const EntityRow *row = row_at(&f->entities, i);
        const DisEntityType type = row->type;
        char text[dis_type_text_size];
        bool said = false;
        for (int k = 0; k < i && !said; k++) {
            const EntityRow *other = row_at(&f->entities, k);
            said = memcmp(&type, &other->type, sizeof type) == 0;
        }
        if (said) continue;
        dis_entity_type_text(text, type);
        const int index = catalog_find(catalog, type, NULL, NULL);
        const Model *model = catalog_model(catalog, index);
        if (!catalog_shows(catalog, index))
            printf("  %-22s nothing is seen of it\n", text);
        else
            text_print(stdout, "  %-22s %s, %.3g x %.3g x %.3g%s\n", text, model->name, model->length_m, model->width_m,
                   fmax(model->box_high[2], 0) - model->box_low[2],
                   index == 0 ? " (no row of the catalog: a stand-in)" : "");
    }
    catalog_close(catalog);
    return STATUS_OK;
}

static const char *result_text(uint8_t result)
{
    switch (result) {
    case dis_result_entity_impact: return "entity impact";
    case dis_result_entity_proximate: return "entity proximate detonation";
    case dis_result_ground_impact: return "ground impact";
    case dis_result_detonation: return "detonation";
    case dis_result_none: return "no detonation";
    default: return "result";
    }
}

static void print_events(const Findings *f)
{
    if (f->events.count) printf("\nFire and detonation\n");
    for (int i = 0; i < f->events.count; i++) {
        const EventRow *e = row_at(&f->events, i);
        char firing[dis_id_text_size], target[dis_id_text_size], munition[dis_id_text_size], type[dis_type_text_size];
        dis_entity_id_text(firing, e->firing);
        dis_entity_id_text(munition, e->munition);
        dis_entity_type_text(type, e->type);
        if (dis_entity_id_is_none(e->target))
            snprintf(target, sizeof target, "nobody");
        else
            dis_entity_id_text(target, e->target);
        if (e->fire)
            printf("  %11.3f s  %s fires %s (%s) at %s\n", e->t_s, firing, munition, type, target);
        else
            printf("  %11.3f s  %s of %s ends: %s (%u), target %s\n", e->t_s, munition, firing, result_text(e->result),
                   e->result, target);
    }
    if (f->removed || f->started || f->stopped)
        printf("\nSimulation management\n  %llu Remove Entity, %llu Start/Resume, %llu Stop/Freeze\n",
               (unsigned long long)f->removed, (unsigned long long)f->started, (unsigned long long)f->stopped);
}

static Status print_summary(const DisLog *log, const Options *options)
{
    Findings f = {.entities.size = sizeof(EntityRow),
                  .senders.size = sizeof(SenderRow),
                  .events.size = sizeof(EventRow)};
    Status status = gather(&f, log, options);
    if (status == STATUS_OK) {
        if (f.entities.count) qsort(f.entities.row, (size_t)f.entities.count, f.entities.size, compare_rows);
        if (f.senders.count) qsort(f.senders.row, (size_t)f.senders.count, f.senders.size, compare_rows);
        print_log(log, &f, options->path);
        print_counts(&f);
        print_senders(&f);
        print_entities(&f);
        status = print_shapes(&f);
        print_events(&f);
    }
    release(&f);
    return status;
}

/* ---- one line per Entity State ------------------------------------------------------------------- */

static const char tsv_header[] =
    "frame.number\tdis.proto_ver\tdis.exer_id\tdis.timestamp\tdis.pdu_length\tdis.entity_id_site\t"
    "dis.entity_id_application\tdis.entity_id_entity\tdis.force_id\tdis.num_articulation_params\t"
    "dis.entity_linear_velocity.x\tdis.entity_linear_velocity.y\tdis.entity_linear_velocity.z\t"
    "dis.entity_location.x\tdis.entity_location.y\tdis.entity_location.z\tdis.entity_orientation.psi\t"
    "dis.entity_orientation.theta\tdis.entity_orientation.phi\tdis.appearance\tdis.entity_linear_acceleration.x\t"
    "dis.entity_linear_acceleration.y\tdis.entity_linear_acceleration.z\tdis.entity_angular_velocity.x\t"
    "dis.entity_angular_velocity.y\tdis.entity_angular_velocity.z\tdis.entity_marking";
static const char tsv_full_header[] =
    "\tdis.entityKind\tdis.entityDomain\tdis.country\tdis.category\tdis.subcategory\tdis.specific\tdis.extra\t"
    "dis.dead_reckoning_algorithm\tdis.dead_reckoning_other_parameters\tdis.capabilities\talternative_type\t"
    "articulation";

/* tshark divides by 2^31 - 1 and cuts to microseconds, here in integers; it is up to 1.7 us ahead of
 * dis_timestamp_seconds, and shown only to be compared. */
static void print_stamp(uint32_t timestamp)
{
    const uint64_t us = (uint64_t)(timestamp >> 1) * 3600000000u / 0x7FFFFFFF;
    printf("\t%llu.%06llu000", (unsigned long long)(us / 1000000), (unsigned long long)(us % 1000000));
}

static void print_floats(const float v[3])
{
    for (int i = 0; i < 3; i++) printf("\t%.6g", (double)v[i]);
}

static void print_full(const DisEntityState *es)
{
    printf("\t%u\t%u\t%u\t%u\t%u\t%u\t%u\t%u\t", es->type.kind, es->type.domain, es->type.country, es->type.category,
           es->type.subcategory, es->type.specific, es->type.extra, es->dead_reckoning);
    for (size_t i = 0; i < sizeof es->dead_reckoning_other; i++) printf("%02x", es->dead_reckoning_other[i]);
    char alternative[dis_type_text_size];
    dis_entity_type_text(alternative, es->alternative_type);
    printf("\t%u\t%s\t", es->capabilities, alternative);
    for (int i = 0; i < es->variable_count; i++) {
        const DisVariableParameter *v = &es->variable[i];
        if (i) putchar(';');
        if (v->record_type == dis_variable_articulated) {
            printf("%u:%u:%u:%.6g", v->change, v->attached_to, v->parameter, (double)v->value);
        } else if (v->record_type == dis_variable_attached) {
            char type[dis_type_text_size];
            dis_entity_type_text(type, v->type);
            printf("attached:%u:%u:%u:%s", v->change, v->attached_to, v->parameter, type);
        } else {
            printf("record:");
            for (size_t k = 0; k < sizeof v->octets; k++) printf("%02x", v->octets[k]);
        }
    }
}

static void print_tsv_row(uint32_t packet, const DisEntityState *es, bool full)
{
    char marking[64];
    text_escape(marking, sizeof marking, es->marking, strnlen(es->marking, sizeof es->marking));
    printf("%u\t%u\t%u", packet, es->header.version, es->header.exercise);
    print_stamp(es->header.timestamp);
    printf("\t%u\t%u\t%u\t%u\t%u\t%u", es->header.length, es->id.site, es->id.application, es->id.entity, es->force,
           es->variable_count);
    print_floats(es->velocity_mps);
    for (int i = 0; i < 3; i++) printf("\t%.15g", es->p_ecef[i]);
    print_floats((const float[3]){es->psi_rad, es->theta_rad, es->phi_rad});
    printf("\t0x%08x", es->appearance);
    print_floats(es->acceleration_mps2);
    print_floats(es->angular_rate_rps);
    printf("\t%s", marking);
    if (full) print_full(es);
    putchar('\n');
}

static void print_tsv(const DisLog *log, const Options *options)
{
    static DisEntityState es;
    DisCounters           counters = {0};
    uint64_t              undecoded = 0;
    printf("%s%s\n", tsv_header, options->full ? tsv_full_header : "");
    for (int i = 0; i < log->count; i++) {
        const DisDatagram *d = &log->datagram[i];
        const uint8_t     *at = d->bytes, *end = d->bytes + d->octets, *pdu;
        DisHeader          header;
        while (dis_next_pdu(&header, &pdu, &at, end, &counters)) {
            if (header.type != dis_pdu_entity_state) continue;
            if (options->exercise >= 0 && header.exercise != options->exercise) continue;
            if (dis_decode_entity_state(&es, pdu, header.length) == STATUS_OK)
                print_tsv_row(d->packet, &es, options->full);
            else
                undecoded++;
        }
    }
    for (int why = 0; why < DIS_DROP_COUNT; why++) undecoded += counters.dropped[why];
    if (undecoded)
        log_warn("inspect: PDUs left out as malformed: count=%llu; `pitviper inspect %s` says why",
                 (unsigned long long)undecoded, options->path);
}

/* ---- the command --------------------------------------------------------------------------------- */

static bool read_number(long long *out, const char *name, const char *text, long long low, long long high)
{
    long long value;
    if (!text || !text_to_long(&value, text) || value < low || value > high) {
        text_print(stderr, "pitviper inspect: %s wants a number %lld .. %lld, not `%s`\n", name, low, high,
                text ? text : "");
        return false;
    }
    *out = value;
    return true;
}

/* 0: go on; else the exit code + 1. */
static int read_options(Options *out, int argc, char **argv)
{
    Options o = {.port = dis_port_default, .exercise = -1};
    bool    only_paths = false;
    for (int i = 1; i < argc; i++) {
        const char *arg = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (only_paths || arg[0] != '-' || !arg[1]) {
            if (o.path) {
                text_print(stderr, "pitviper inspect: one log at a time: `%s` and `%s`\n", o.path, arg);
                return 3;
            }
            o.path = arg;
        } else if (strcmp(arg, "--") == 0) {
            only_paths = true;
        } else if (strcmp(arg, "--help") == 0 || strcmp(arg, "-h") == 0) {
            fputs(usage_text, stdout);
            return 1;
        } else if (strcmp(arg, "--full") == 0) {
            o.full = true;
        } else if (strcmp(arg, "--pdus") == 0) {
            if (!value || strcmp(value, "tsv") != 0) {
                text_print(stderr, "pitviper inspect: --pdus knows `tsv`, not `%s`\n", value ? value : "");
                return 3;
            }
            o.tsv = true;
            i++;
        } else if (strcmp(arg, "--port") == 0) {
            if (!read_number(&o.port, arg, value, 0, 65535)) return 3;
            i++;
        } else if (strcmp(arg, "--exercise") == 0) {
            if (!read_number(&o.exercise, arg, value, 0, 255)) return 3;
            i++;
        } else {
            text_print(stderr, "pitviper inspect: unknown option `%s`; see pitviper inspect --help\n", arg);
            return 3;
        }
    }
    if (!o.path) {
        fputs(usage_text, stderr);
        return 3;
    }
    if (o.full && !o.tsv) {
        text_print(stderr, "pitviper inspect: --full goes with --pdus tsv\n");
        return 3;
    }
    *out = o;
    return 0;
}

int inspect_command(int argc, char **argv)
{
    Options   options;
    const int stop = read_options(&options, argc, argv);
    if (stop) return stop - 1;

    DisLog log;
    Status status = dis_log_open(&log, options.path, (int)options.port);
    if (status == STATUS_NO_MEMORY) log_error("inspect: %s: %s", options.path, status_name(status));
    if (status != STATUS_OK) return 1; /* all else was said where it happened */
    if (log.retimed)
        log_warn("inspect: packet times do not keep pace with the time stamps; the stamps are taken as the clock");
    if (log.any_port && options.port == dis_port_default)
        log_warn("inspect: nothing went to port %d: every port that carries DIS is taken; --port N chooses", dis_port);
    if (log.count == 0 && options.port > 0 && log.counters.other_port)
        log_warn("inspect: no UDP to port %lld in %s; try --port 0", options.port, options.path);

    if (options.tsv)
        print_tsv(&log, &options);
    else
        status = print_summary(&log, &options);
    dis_log_close(&log);
    if (status != STATUS_OK) {
        log_error("inspect: %s: %s", options.path, status_name(status));
        return 1;
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        text_print(stderr, "pitviper inspect: cannot write the output; is the disk full or the pipe closed?\n");
        return 1;
    }
    return 0;
}
