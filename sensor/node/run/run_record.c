/* sensor/node/run/run_record.c: run.json: its fields, and how it is written. */
#include "sensor/node/run/run_record.h"
#include "sensor/node/run/run_record_private.h"
#include "pitviper_output.h"
#include "sensor/frame/json_object.h"
#include "sensor/publish/memory/consume_memory.h"

#include <errno.h>
#include <gnu/libc-version.h>
#include <stdlib.h>

enum { path_size = 4096 };

/* ---- where the values are ------------------------------------------------------------------------ */

static const void *end_of(const void *of) { return ((const RunRecord *)of)->end; }
static const void *logged(const void *of)
{
    const Run *run = run_of_record(of);
    return *run->log_sha256 ? run : NULL;
}

static const void *woods_of(const void *of)
{
    const WoodsChoice *woods = ((const RunRecord *)of)->end->woods;
    return woods->on ? woods : NULL;
}

static const void *latency_of(const void *of)
{
    const RunRecord *r = of;
    return r->run->wall_s ? &r->end->result->latency : NULL;
}

/* ---- one of several ------------------------------------------------------------------------------ */

static const void *next_kind(FieldItem *item, const void *of, int i, const void *record)
{
    const WoodsChoice *w = of;
    (void)record;
    return i < PLANT_STANDING ? run_keyed(item, plant_name((PlantKind)i), &w->woods.by_kind[i]) : NULL;
}

static const void *next_stage(FieldItem *item, const void *of, int i, const void *record)
{
    const RunRecord *r = of;
    (void)record;
    return i < session_stages ? run_keyed(item, session_stage_name[i], &r->stage[i]) : NULL;
}

static const void *next_latency(FieldItem *item, const void *of, int i, const void *record)
{
    const LatencySummary *l = of;
    (void)record;
    if (i == LATENCY_STAGE_COUNT) return NULL;
    return run_keyed(item, l->stage[i].count > 0 ? latency_stage_name[i] : "", &l->stage[i]);
}

static const void *next_consumer(FieldItem *item, const void *of, int i, const void *record)
{
    const LatencySummary *l = of;
    (void)record;
    return i < l->consumers ? run_keyed(item, l->name[i], &l->consumer[i]) : NULL;
}

/* ---- values that are no plain member ------------------------------------------------------------- */

static void append(json_t *array, const char *text) { json_array_append_new(array, json_string(text)); }

static json_t *escaped(const char *text, size_t octets)
{
    char out[256];
    text_escape(out, sizeof out, text, octets);
    return json_string(out);
}

static json_t *program_version(const void *of, const void *record)
{
    (void)of, (void)record;
    return json_string(PITVIPER_VERSION);
}

static json_t *planes(const void *of, const void *record)
{
    const Config *config = run_config_of(record);
    (void)of;
    return json_string(config->publish.files ? config->publish.planes : "none");
}

/* Lines `section.key=value`; all values are text. */
static json_t *settings(const void *of, const void *record)
{
    json_t *object = json_object();
    char    lines[config_text_size], key[96];
    size_t  length;
    (void)of;
    config_text(lines, sizeof lines, run_config_of(record));
    for (const char *text = lines; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        const size_t name = strcspn(text, "=");
        if (name >= length || name >= sizeof key) continue;
        snprintf(key, sizeof key, "%.*s", (int)name, text);
        json_object_set_new(object, key, escaped(text + name + 1, length - name - 1));
    }
    return object;
}

static json_t *tables(const void *of, const void *record)
{
    const TablesUsed *t = &((const Run *)run_of_record(of))->tables;
    json_t           *object = json_object();
    (void)record;
    for (int i = 0; i < t->count; i++) json_object_set_new(object, t->table[i].name, json_string(t->table[i].sha256));
    return object;
}

static json_t *log_name(const void *of, const void *record)
{
    const Run *run = run_of_record(of);
    (void)record;
    return escaped(run->log_name, strlen(run->log_name));
}

/* Versions of the program's libraries. Headers of the libraries are included only by the files that use them: versions
 * come from the build (CMakeLists.txt); that of the C library, whose functions affect every number, from the running
 * one. */
static json_t *libraries(const void *of, const void *record)
{
    const char *const name[][2] = {{"embree", PITVIPER_EMBREE_VERSION},
                                   {"openimageio", PITVIPER_OPENIMAGEIO_VERSION},
                                   {"geographiclib", PITVIPER_GEOGRAPHICLIB_VERSION},
                                   {"erfa", PITVIPER_ERFA_VERSION},
                                   {"fftw", PITVIPER_FFTW_VERSION},
                                   {"libc", gnu_get_libc_version()},
                                   {"compiler", PITVIPER_COMPILER}};
    json_t           *object = json_object();
    (void)of, (void)record;
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        json_object_set_new(object, name[i][0], json_string(name[i][1]));
    return object;
}

static json_t *hosts(const void *of, const void *record)
{
    const RunEnd *end = end_of(of);
    json_t       *array = json_array();
    (void)record;
    for (int i = 0; i < end->result->host_count; i++) append(array, end->result->host[i]);
    if (end->result->host_count == 0) append(array, end->host); /* not received so far */
    return array;
}

static json_t *choices(const void *of, const void *record)
{
    const Choices *c = ((const RunEnd *)end_of(of))->choices;
    json_t        *array = json_array();
    (void)record;
    for (int i = 0; i < c->count; i++) append(array, c->line[i]);
    return array;
}

static json_t *frame_hashes(const void *of, const void *record)
{
    const SessionResult *result = run_result_of(of);
    json_t              *array = run_config_of(record)->publish.truth ? json_array() : NULL;
    for (int i = 0; array && i < result->listed; i++) append(array, result->hash[i]);
    return array;
}

static json_t *frame_numbers(const void *of, const void *record)
{
    const SessionResult *result = run_result_of(of);
    json_t              *array = json_array();
    (void)record;
    for (int i = 0; i < result->listed; i++) json_array_append_new(array, json_integer(result->number[i]));
    return array;
}

static json_t *list_mb(const void *of, const void *record)
{
    const Woods *w = &((const WoodsChoice *)of)->woods;
    (void)record;
    return field_number(
        1e-6 * (double)((size_t)w->count * sizeof *w->plant + ((size_t)w->nx * (size_t)w->ny + 1) * sizeof *w->first));
}

static json_t *materials(const void *of, const void *record)
{
    const Materials *m = &((const Run *)run_of_record(of))->world.materials;
    json_t          *array = m->count > 1 ? json_array() : NULL;
    (void)record;
    for (int i = 1; i < m->count; i++) append(array, m->material[i].name);
    return array;
}

/* ---- the fields ---------------------------------------------------------------------------------- */

static const Field key_rows[] = {
    {"KEY", "string", "as in `pitviper check --default`", "", "", "its value as text; `nan`: not given",
     .elsewhere = true},
};
static const FieldTable key_fields = FIELD_TABLE(key_rows);

static const Field file_rows[] = {
    {"FILE", "string", "", "", "", "SHA-256; of a folder of the atmosphere: of all its tables", .elsewhere = true},
};
static const FieldTable file_fields = FIELD_TABLE(file_rows);

static const Field library_rows[] = {
    {"LIBRARY", "string", "", "", "", "its version", .elsewhere = true},
};
static const FieldTable library_fields = FIELD_TABLE(library_rows);

static const Field kind_rows[] = {
    {"KIND", "integer", "", "", "", "plants", .item = next_kind, .kind = FIELD_OF_INT},
};
static const FieldTable kind_fields = FIELD_TABLE(kind_rows);

static const Field origin_rows[] = {
    {"crowns", "integer", "", "", "", "trunks marked in the terrain store",
     FIELD_MEMBER(WoodsChoice, woods.from_crowns)},
    {"canopy", "integer", "", "", "", "its layers of canopy height and cover",
     FIELD_MEMBER(WoodsChoice, woods.from_canopy)},
    {"classes", "integer", "", "", "", "surface classes alone", FIELD_MEMBER(WoodsChoice, woods.from_classes)},
    {"hedges", "integer", "", "", "", "edges of fields", FIELD_MEMBER(WoodsChoice, woods.from_hedges)},
};
static const FieldTable origin_fields = FIELD_TABLE(origin_rows);

static const Field woods_rows[] = {
    {"plants", "integer", "", "", "", "trees, bushes and hedges", FIELD_MEMBER(WoodsChoice, woods.count)},
    {"kinds", "object", "", "", "", "of these, by kind", .rows = &kind_fields},
    {"from", "object", "", "", "", "by what says where they stand", .rows = &origin_fields},
    {"left_out", "integer", "", "", "", "plants beyond terrain.woods_trees", FIELD_MEMBER(WoodsChoice, woods.left_out)},
    {"reach_m", "number", "m", "from the aim, when the world was made", "", "within it none is left out",
     FIELD_MEMBER(WoodsChoice, woods.reach_m)},
    {"paths", "integer", "", "", "", "straight pieces of paths cleared of plants; on real ground none",
     FIELD_MEMBER(WoodsChoice, config.path_count)},
    {"entities", "integer", "", "", "", "entities on the ground at their first report",
     FIELD_MEMBER(WoodsChoice, entities)},
    {"in_trunks", "integer", "", "", "", "of these, within a trunk", FIELD_MEMBER(WoodsChoice, in_trunks)},
    {"list_mb", "number", "MB", "", "", "memory of the list of plants, without the ray tracer's", .get = list_mb},
};
static const FieldTable woods_fields = FIELD_TABLE(woods_rows);

static const Field stage_rows[] = {
    {"median", "number", "ms", "", "", "median over the frames", FIELD_MEMBER(StageTimes, median_ms)},
    {"p95", "number", "ms", "", "", "95th percentile", FIELD_MEMBER(StageTimes, p95_ms)},
    {"max", "number", "ms", "", "", "maximum", FIELD_MEMBER(StageTimes, max_ms)},
};
static const FieldTable stage_fields = FIELD_TABLE(stage_rows);

static const Field timing_rows[] = {
    {"STAGE", "object", "", "", "", "one stage; `frame` is the total", .item = next_stage, .rows = &stage_fields},
};
static const FieldTable timing_fields = FIELD_TABLE(timing_rows);

static const Field figure_rows[] = {
    {"median", "number", "ms", "", "", "median, at most 2.4 % above the exact one",
     FIELD_MEMBER(LatencyFigures, median_ms), .as = field_ms},
    {"p95", "number", "ms", "", "", "95th percentile, likewise", FIELD_MEMBER(LatencyFigures, p95_ms), .as = field_ms},
    {"p99", "number", "ms", "", "", "99th percentile, likewise", FIELD_MEMBER(LatencyFigures, p99_ms), .as = field_ms},
    {"max", "number", "ms", "", "", "maximum", FIELD_MEMBER(LatencyFigures, max_ms), .as = field_ms},
    {"count", "integer", "", "", "", "number of frames", FIELD_MEMBER(LatencyFigures, count)},
    {"histogram", "list of 32 integers", "", "below the first edge, between edges, above the last", "",
     "number of frames by latency", FIELD_MEMBER(LatencyFigures, histogram)},
};
static const FieldTable figure_fields = FIELD_TABLE(figure_rows);

static const Field consumer_rows[] = {
    {"median", "number", "ms", "", "when it was done with no frame", "as above",
     FIELD_MEMBER(LatencyFigures, median_ms), .as = field_ms},
    {"p95", "number", "ms", "", "when it was done with no frame", "as above", FIELD_MEMBER(LatencyFigures, p95_ms),
     .as = field_ms},
    {"p99", "number", "ms", "", "when it was done with no frame", "as above", FIELD_MEMBER(LatencyFigures, p99_ms),
     .as = field_ms},
    {"max", "number", "ms", "", "when it was done with no frame", "as above", FIELD_MEMBER(LatencyFigures, max_ms),
     .as = field_ms},
    {"count", "integer", "", "", "", "frames that it was done with", FIELD_MEMBER(LatencyFigures, count)},
    {"left_out", "integer", "", "", "", "frames that it was not given, for lack of time",
     FIELD_MEMBER(LatencyFigures, left_out)},
    {"histogram", "list of 32 integers", "", "as above", "", "number of frames by latency",
     FIELD_MEMBER(LatencyFigures, histogram)},
};
static const FieldTable consumer_fields = FIELD_TABLE(consumer_rows);

static const Field consumers_rows[] = {
    {"CONSUMER", "object", "", "", "", "one consumer", .item = next_consumer, .rows = &consumer_fields},
};
static const FieldTable consumers_fields = FIELD_TABLE(consumers_rows);

static const Field latency_rows[] = {
    {"edges_ms", "list of 31 numbers", "ms", "ascending", "",
     "edges of the histograms' bins, five a decade, 0.01 ms .. 10 s", FIELD_MEMBER(LatencySummary, edge_ms)},
    {"LATENCY", "object", "", "", "when no frame has it",
     "one step; arrival_to_pose: only of frames that used a datagram which no earlier frame used", .item = next_latency,
     .rows = &figure_fields},
    {"consumers", "object", "", "", "", "by consumer: from the end of rendering until it was done",
     .rows = &consumers_fields},
};
static const FieldTable latency_fields = FIELD_TABLE(latency_rows);

static const Field run_rows[] = {
    {"pitviper", "string", "", "", "", "version of the program", .get = program_version},
    {"status", "string", "", "", "", "complete; stopped: by a signal; failed", .at = end_of,
     FIELD_MEMBER(RunEnd, state)},
    {"planes", "string", "", "", "", "planes of the truth files, or `none` (--planes, --no-files)", .get = planes},
    {"config_sha256", "string", "", "", "", "SHA-256 of every setting that the planes depend on", .at = run_of_record,
     FIELD_MEMBER(Run, config_sha256)},
    {"settings", "object", "", "", "", "those settings, given or by default", .get = settings, .rows = &key_fields},
    {"tables_sha256", "object", "", "", "", "the tables and model files that were readable", .get = tables,
     .rows = &file_fields},
    {"log", "string", "", "", "", "name of the log, or of the network's address", .get = log_name},
    {"log_sha256", "string", "", "", "in a live run", "SHA-256 of the log's octets", .at = logged,
     FIELD_MEMBER(Run, log_sha256)},
    {"seed", "integer", "", "", "", "of all random numbers", .at = run_of_record,
     FIELD_MEMBER(Run, options.config.seed)},
    {"threads", "integer", "", "", "", "number of threads; no effect on the planes", .at = run_of_record,
     FIELD_MEMBER(Run, options.threads)},
    {"isa", "string", "", "", "", "instruction set of the ray tracer", .at = run_of_record,
     FIELD_MEMBER(Run, options.isa)},
    {"libraries", "object", "", "", "", "libraries used in the computation", .get = libraries, .rows = &library_fields},
    {"memory", "string", "", "", "without publish.memory", "name of the ring of frames in /dev/shm",
     FIELD_MEMBER(RunRecord, memory)},
    {"detections_port", "integer", "", "", "without publish.detections_port",
     "UDP port that received a recogniser's detections", .at = run_of_record,
     FIELD_MEMBER(Run, options.config.publish.detections_port), .unless_0 = true},
    {"hosts", "list of strings", "", "site:application:entity, or `observer`", "",
     "which entities carried the sensor, one after the other", .get = hosts},
    {"choices", "list of strings", "", "`what: choice`", "", "automatic choices, as printed", .get = choices},
    {"frames", "integer", "", "", "", "number of frames rendered", .at = run_result_of,
     FIELD_MEMBER(SessionResult, frames)},
    {"frame_sha256", "list of strings", "", "as frame_number", "with publish.truth false",
     "SHA-256 of all planes before they are encoded", .get = frame_hashes},
    {"frame_number", "list of integers", "", "from 0", "",
     "numbers of the frames in frame_sha256; of a very long run only the first", .get = frame_numbers},
    {"woods", "object", "", "", "with terrain.woods off", "plants that stand on the ground", .at = woods_of,
     .rows = &woods_fields},
    {"materials", "list of strings", "", "", "",
     "names of the materials: the k-th, from 1, is value k of the material planes", .get = materials},
    {"counters", "object", "", "", "", "over the whole run", .rows = &run_counter_fields},
    {"timings_ms", "object", "", "", "", "wall time per stage of a frame; differs in every run",
     .rows = &timing_fields},
    {"latency_ms", "object", "", "", "in a replay at full speed",
     "latency_ms of truth.jsonl over all frames; of a run and of replay --speed X", .at = latency_of,
     .rows = &latency_fields},
};
const FieldTable run_record_fields = FIELD_TABLE(run_rows);

/* ---- writing ------------------------------------------------------------------------------------- */

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static Status summarise_stages(StageTimes out[session_stages], const SessionResult *r)
{
    double *sorted = calloc((size_t)r->listed + 1, sizeof *sorted);
    if (!sorted) return STATUS_NO_MEMORY;
    for (int stage = 0; stage < session_stages && r->listed > 0; stage++) {
        for (int i = 0; i < r->listed; i++) sorted[i] = r->stage_ms[i][stage];
        qsort(sorted, (size_t)r->listed, sizeof *sorted, compare_doubles);
        out[stage] = (StageTimes){sorted[r->listed / 2],
                                  sorted[(int)ceil(0.95 * r->listed) - 1], /* nearest rank: never below the median */
                                  sorted[r->listed - 1]};
    }
    free(sorted);
    return STATUS_OK;
}

/* The complete file, atomically. */
static Status write_file(const char *path, const RunRecord *record)
{
    json_t    *run = field_object(&run_record_fields, record);
    FILE      *file = output_begin(path, 0);
    const bool put = file && json_dumpf(run, file, JSON_INDENT(1)) == 0;
    json_decref(run);
    if (put && output_end(file, path)) return STATUS_OK;
    if (file && !put) output_abandon(file, path);
    log_error("records: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}

Status run_write(const Run *run, const RunEnd *end)
{
    const char *name = options_command(&run->options);
    char        path[path_size + 16], ring[memory_name_size];
    RunRecord   record = {.run = run, .end = end, .memory = *run->options.config.publish.memory ? ring : NULL};
    if (summarise_stages(record.stage, end->result) != STATUS_OK) {
        log_error("%s: out of memory for run.json", name);
        return STATUS_NO_MEMORY;
    }
    for (int i = 0; i < session_stages; i++)
        log_detail("%s: %s: %.3g ms a frame (median; 95 %%: %.3g; most: %.3g)", name, session_stage_name[i],
                   record.stage[i].median_ms, record.stage[i].p95_ms, record.stage[i].max_ms);
    snprintf(path, sizeof path, "%s/run.json", end->folder);
    memory_name(ring, &run->options.config, run->options.host_count > 1 ? end->host : NULL);
    return write_file(path, &record);
}
