/* sensor/commands/inspect/inspect_command.c: `pitviper inspect`: a summary of a log as tables, or its Entity States
 * line by line. exercise: only this one; -1: all. */
#include "sensor/commands/commands.h"

#include "dis/pdu/decode.h"
#include "dis/capture/log.h"
#include "entities/catalog/catalog.h"
#include "sensor/commands/inspect/findings_private.h"
#include "sensor/settings/command_line.h"
#include "sensor/settings/config.h"
#include "terrain/earth/geodesy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* ---- the summary ------------------------------------------------------------------------------------ */

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
        const char *stamps = row->unstamped == row->pdus  ? "none"
                             : row->absolute == 0         ? "relative"
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
    TypeRow     *row = malloc((entities + 1) * sizeof *row);
    int          kept = 0;
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

/* Prints each type once, in the order of the table above, with its model. */
static Status print_shapes(const Findings *f)
{
    static const double chord_error_m = 0.1; /* sizes are needed, not facets */
    char                path[4096];
    Catalog            *catalog;
    int                 count = 0;
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
        if (!catalog_has_shape(catalog, index)) printf("  %-22s nothing is seen of it\n", text);
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
    case dis_result_entity_impact:
        return "entity impact";
    case dis_result_entity_proximate:
        return "entity proximate detonation";
    case dis_result_ground_impact:
        return "ground impact";
    case dis_result_detonation:
        return "detonation";
    case dis_result_none:
        return "no detonation";
    default:
        return "result";
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
        if (dis_entity_id_is_none(e->target)) snprintf(target, sizeof target, "nobody");
        else dis_entity_id_text(target, e->target);
        if (e->fire) printf("  %11.3f s  %s fires %s (%s) at %s\n", e->t_s, firing, munition, type, target);
        else
            printf("  %11.3f s  %s of %s ends: %s (%u), target %s\n", e->t_s, munition, firing, result_text(e->result),
                   e->result, target);
    }
    if (f->removed || f->started || f->stopped)
        printf("\nSimulation management\n  %llu Remove Entity, %llu Start/Resume, %llu Stop/Freeze\n",
               (unsigned long long)f->removed, (unsigned long long)f->started, (unsigned long long)f->stopped);
}

static Status print_summary(const DisLog *log, const char *path, int exercise)
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

/* ---- one line per Entity State ---------------------------------------------------------------------- */

/* The lines have the column names and number formats of `tshark -T fields`, so that the two programs can be compared.
 */

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
 * dis_timestamp_seconds, and printed for comparison only. */
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

/* full: all columns. */
static void print_tsv(const DisLog *log, const char *path, int exercise, bool full)
{
    static DisPdu decoded; /* 11 KiB, and the command has one thread */
    DisCounters   counters = {0};
    uint64_t      undecoded = 0;
    printf("%s%s\n", tsv_header, full ? tsv_full_header : "");
    for (int i = 0; i < log->count; i++) {
        const DisDatagram d = dis_log_datagram(log, i);
        const uint8_t    *at = d.bytes, *end = d.bytes + d.octets, *pdu;
        DisHeader         header;
        while (dis_next_pdu(&header, &pdu, &at, end, &counters)) {
            if (header.type != dis_pdu_entity_state) continue;
            if (exercise >= 0 && header.exercise != exercise) continue;
            if (dis_decode(&decoded, pdu, header.length) == STATUS_OK)
                print_tsv_row(d.packet, &decoded.entity_state, full);
            else undecoded++;
        }
    }
    for (int why = 0; why < DIS_DROP_COUNT; why++) undecoded += counters.dropped[why];
    if (undecoded)
        log_warn("inspect: PDUs left out as malformed: count=%llu; `pitviper inspect %s` says why",
                 (unsigned long long)undecoded, path);
}

/* ---- the command line, and which of the two is printed ---------------------------------------------- */

static const char usage_text[] =
    "usage: pitviper inspect LOG [--pdus tsv [--full]] [--port N] [--exercise N] [-c FILE]\n"
    "\n"
    "LOG is a pcap or pcapng capture, also compressed (gzip, zstd, bzip2, xz) or a pipe. Without --pdus: a summary of\n"
    "the exercise.\n"
    "\n"
    "  --pdus tsv    one line per Entity State PDU, with the columns and formats of\n"
    "                tshark -d udp.port==3000,dis -T fields\n"
    "  --full        with --pdus tsv: also entity type, dead reckoning, capabilities,\n"
    "                alternative type and articulation (change:attached:parameter:value; ...)\n"
    "  --port N      UDP destination port; 0: any that carries DIS (default: 3000, any when nothing went there)\n"
    "  --exercise N  only this exercise, 0 .. 255; default: all\n"
    "  --config FILE or -c: settings, whose models.catalog and models.materials are read\n";

typedef struct InspectOptions {
    const char *path, *config;
    bool        tsv, full;
    long long   port, exercise; /* exercise -1: all */
} InspectOptions;

/* Returns 0 to go on; else the program exits with this code - 1. */
static int read_options(InspectOptions *o, int argc, char **argv)
{
    enum { CONFIG = 'c', PDUS = 256, FULL, PORT, EXERCISE, HELP };
    static const struct option options[] = {
        {"pdus", 1, NULL, PDUS},     {"full", 0, NULL, FULL}, {"port", 1, NULL, PORT}, {"exercise", 1, NULL, EXERCISE},
        {"config", 1, NULL, CONFIG}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    *o = (InspectOptions){.port = dis_port_default, .exercise = -1};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "c:", options)) != -1;) switch (option) {
        case PDUS:
            if (strcmp(optarg, "tsv") != 0) return 1 + command_line_wrong("inspect", "--pdus: '%s' is not tsv", optarg);
            o->tsv = true;
            break;
        case FULL:
            o->full = true;
            break;
        case CONFIG:
            o->config = optarg;
            break;
        case PORT:
            if (!text_to_long(&o->port, optarg) || o->port < 0 || o->port > 65535)
                return 1 + command_line_wrong("inspect", "--port: '%s' is not a whole number in 0 .. 65535", optarg);
            break;
        case EXERCISE:
            if (!text_to_long(&o->exercise, optarg) || o->exercise < 0 || o->exercise > 255)
                return 1 + command_line_wrong("inspect", "--exercise: '%s' is not a whole number in 0 .. 255", optarg);
            break;
        case HELP:
            fputs(usage_text, stdout);
            return 1 + 0;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    if (optind == argc)
        return 1 + command_line_wrong("inspect", "no LOG is named: usage: pitviper inspect LOG [options]");
    o->path = argv[optind];
    if (optind + 1 < argc)
        return 1 + command_line_wrong("inspect", "one LOG at a time, not also '%s'", argv[optind + 1]);
    if (o->full && !o->tsv) return 1 + command_line_wrong("inspect", "--full applies to --pdus tsv only");
    return 0;
}

int inspect_command(int argc, char **argv)
{
    InspectOptions options;
    const int      stop = read_options(&options, argc, argv);
    if (stop || config_tables_of(options.config) != STATUS_OK) return stop ? stop - 1 : 1;

    DisLog log;
    Status status = dis_log_open(&log, options.path, (int)options.port);
    if (status == STATUS_NO_MEMORY) log_error("inspect: %s: %s", options.path, status_name(status));
    if (status != STATUS_OK) return 1; /* all other errors have been logged */
    if (log.retimed)
        log_warn("inspect: packet times do not keep pace with the time stamps; the stamps are taken as the clock");
    if (log.any_port && options.port == dis_port_default)
        log_warn("inspect: nothing went to port %d: every port that carries DIS is taken; --port N chooses", dis_port);
    if (log.count == 0 && options.port > 0 && log.counters.other_port)
        log_warn("inspect: no UDP to port %lld in %s; try --port 0", options.port, options.path);

    if (options.tsv) print_tsv(&log, options.path, (int)options.exercise, options.full);
    else status = print_summary(&log, options.path, (int)options.exercise);
    if (status == STATUS_OK && dis_log_failed(&log)) status = STATUS_IO;
    dis_log_close(&log);
    if (status != STATUS_OK) {
        log_error("inspect: %s: %s", options.path, status_name(status));
        return 1;
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        log_error("inspect: cannot write the output; is the disk full or the pipe closed?");
        return 1;
    }
    return 0;
}
