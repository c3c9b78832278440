/* sensor/commands/inspect_summary.c: the findings of a log as the tables of `pitviper inspect`. */
#include "sensor/commands/inspect_findings.h"
#include "sensor/commands/inspect_private.h"

#include "entities/catalog/catalog.h"
#include "terrain/earth/geodesy.h"
#include "dis/decode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

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
            printf("  %8llu  %-16s  %s\n", (unsigned long long)f->counters.dropped[why], dis_drop_name((DisDrop)why),
                   dis_drop_cause((DisDrop)why));
    if (f->counters.lengths_made || f->counters.padded) printf("\nAccepted all the same\n");
    if (f->counters.lengths_made)
        printf("  %8llu  PDUs with a length field of 0, by their type and the datagram's length\n",
               (unsigned long long)f->counters.lengths_made);
    if (f->counters.padded)
        printf("  %8llu  runs of up to 7 zeros behind a PDU, as padding\n", (unsigned long long)f->counters.padded);
}

static void print_senders(const Findings *f)
{
    printf("\nSenders\n  %-12s %-8s %8s  stamps\n", "site:app", "version", "PDUs");
    for (int i = 0; i < f->senders.count; i++) {
        const SenderRow *row = findings_row(&f->senders, i);
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
        char text[exercise_clock_anomaly_text_size];
        exercise_clock_anomaly_text(text, sizeof text, &f->doubts.sender[i]);
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
        const EntityRow *row = findings_row(&f->entities, i);
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

typedef struct TypeRow {
    DisEntityType type;
    int           entity; /* the first that has it */
} TypeRow;

static int by_type(const void *a, const void *b)
{
    const TypeRow *x = a, *y = b;
    const int      order = memcmp(&x->type, &y->type, sizeof x->type);
    return order ? order : (x->entity > y->entity) - (x->entity < y->entity);
}

static int by_entity(const void *a, const void *b)
{
    const TypeRow *x = a, *y = b;
    return (x->entity > y->entity) - (x->entity < y->entity);
}

/* All types, each once, in the order of their first entities; malloc'ed. NULL: memory is out. */
static TypeRow *list_types(int *count, const Findings *f)
{
    const size_t entities = (size_t)f->entities.count;
    TypeRow     *row      = malloc((entities + 1) * sizeof *row);
    int          kept     = 0;
    if (!row) return NULL;
    for (int i = 0; i < f->entities.count; i++) {
        const EntityRow *entity = findings_row(&f->entities, i);
        row[i] = (TypeRow){entity->type, i};
    }
    qsort(row, entities, sizeof *row, by_type);
    for (int i = 0; i < f->entities.count; i++)
        if (kept == 0 || memcmp(&row[kept - 1].type, &row[i].type, sizeof row[i].type) != 0) row[kept++] = row[i];
    qsort(row, (size_t)kept, sizeof *row, by_entity);
    *count = kept;
    return row;
}

/* Each type once, in the order of the table above, with its model. */
static Status print_shapes(const Findings *f)
{
    static const double chord_error_m = 0.1; /* sizes are needed, not facets */
    char     path[4096];
    Catalog *catalog;
    int      count = 0;
    if (f->entities.count == 0) return STATUS_OK;
    if (!etc_path(path, sizeof path, "catalog.csv")) return STATUS_BAD_VALUE;
    TypeRow *row = list_types(&count, f);
    if (!row) return STATUS_NO_MEMORY;
    const Status status = catalog_open(&catalog, path, chord_error_m);
    if (status != STATUS_OK) {
        free(row);
        return status;
    }
    printf("\nShapes (of etc/catalog.csv: length x width x height m; from the ground, of hulls from the keel)\n");
    for (int i = 0; i < count; i++) {
        char         text[dis_type_text_size];
        const int    index = catalog_find(catalog, row[i].type, NULL, NULL);
        const Model *model = catalog_model(catalog, index);
        dis_entity_type_text(text, row[i].type);
        if (!catalog_has_shape(catalog, index))
            printf("  %-22s nothing is seen of it\n", text);
        else
            text_print(stdout, "  %-22s %s, %.3g x %.3g x %.3g%s\n", text, model->name, model->length_m, model->width_m,
                   fmax(model->box_high[2], 0) - model->box_low[2],
                   index == 0 ? " (no row of the catalog: a stand-in)" : "");
    }
    catalog_close(catalog);
    free(row);
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
        const EventRow *e = findings_row(&f->events, i);
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

Status inspect_summary(const DisLog *log, const char *path, int exercise)
{
    Findings f;
    Status   status = findings_gather(&f, log, exercise);
    if (status == STATUS_OK) {
        print_log(log, &f, path);
        print_counts(&f);
        print_senders(&f);
        print_entities(&f);
        status = print_shapes(&f);
        print_events(&f);
    }
    findings_release(&f);
    return status;
}
