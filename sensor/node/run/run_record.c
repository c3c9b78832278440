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
    return clock_on_wall(r->run->clock) ? &r->end->result->latency : NULL;
}

/* ---- one of several ------------------------------------------------------------------------------ */

static const void *next_kind(FieldAt *at, int i)
{
    const WoodsChoice *w = at->of;
    return i < PLANT_STANDING ? field_keyed(at, plant_name((PlantKind)i), &w->woods.by_kind[i]) : NULL;
}

static const void *next_stage(FieldAt *at, int i)
{
    const RunRecord *r = at->of;
    return i < session_stages ? field_keyed(at, session_stage_name[i], &r->stage[i]) : NULL;
}

static const void *next_latency(FieldAt *at, int i)
{
    const LatencySummary *l = at->of;
    if (i == LATENCY_STAGE_COUNT) return NULL;
    return field_keyed(at, l->stage[i].count > 0 ? latency_stage_name[i] : "", &l->stage[i]);
}

static const void *next_consumer(FieldAt *at, int i)
{
    const LatencySummary *l = at->of;
    return i < l->consumers ? field_keyed(at, l->name[i], &l->consumer[i]) : NULL;
}

/* ---- values that are no plain member ------------------------------------------------------------- */

static void append(json_t *array, const char *text) { json_array_append_new(array, json_string(text)); }

static json_t *program_version(FieldAt *at)
{
    (void)at;
    return json_string(PITVIPER_VERSION);
}

static json_t *planes(FieldAt *at)
{
    const Config *config = run_config_of(at->record);
    return json_string(config->publish.files ? config->publish.planes : "none");
}

/* Lines `section.key=value`; all values are text. */
static json_t *settings(FieldAt *at)
{
    json_t *object = json_object();
    char    lines[config_text_size], key[96];
    size_t  length;
    config_text(lines, sizeof lines, run_config_of(at->record));
    for (const char *text = lines; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        const size_t name = strcspn(text, "=");
        if (name >= length || name >= sizeof key) continue;
        snprintf(key, sizeof key, "%.*s", (int)name, text);
        json_object_set_new(object, key, field_octets(text + name + 1, length - name - 1));
    }
    return object;
}

static json_t *tables(FieldAt *at)
{
    const TablesUsed *t = &((const Run *)run_of_record(at->of))->tables;
    json_t           *object = json_object();
    for (int i = 0; i < t->count; i++) json_object_set_new(object, t->table[i].name, json_string(t->table[i].sha256));
    return object;
}

static json_t *log_name(FieldAt *at)
{
    const Run *run = run_of_record(at->of);
    return field_octets(run->log_name, strlen(run->log_name));
}

/* Versions of the program's libraries. Headers of the libraries are included only by the files that use them: versions
 * come from the build (CMakeLists.txt); that of the C library, whose functions affect every number, from the running
 * one. */
static json_t *libraries(FieldAt *at)
{
    const char *const name[][2] = {{"embree", PITVIPER_EMBREE_VERSION},
                                   {"openimageio", PITVIPER_OPENIMAGEIO_VERSION},
                                   {"geographiclib", PITVIPER_GEOGRAPHICLIB_VERSION},
                                   {"erfa", PITVIPER_ERFA_VERSION},
                                   {"fftw", PITVIPER_FFTW_VERSION},
                                   {"libc", gnu_get_libc_version()},
                                   {"compiler", PITVIPER_COMPILER}};
    json_t           *object = json_object();
    (void)at;
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        json_object_set_new(object, name[i][0], json_string(name[i][1]));
    return object;
}

static json_t *hosts(FieldAt *at)
{
    const RunEnd *end = end_of(at->of);
    json_t       *array = json_array();
    for (int i = 0; i < end->result->host_count; i++) append(array, end->result->host[i]);
    if (end->result->host_count == 0) append(array, end->host); /* not received so far */
    return array;
}

static json_t *choices(FieldAt *at)
{
    const Choices *c = ((const RunEnd *)end_of(at->of))->choices;
    json_t        *array = json_array();
    for (int i = 0; i < c->count; i++) append(array, c->line[i]);
    return array;
}

static json_t *frame_hashes(FieldAt *at)
{
    const SessionResult *result = run_result_of(at->of);
    json_t              *array = run_config_of(at->record)->publish.truth ? json_array() : NULL;
    for (int i = 0; array && i < result->listed; i++) append(array, result->hash[i]);
    return array;
}

static json_t *frame_numbers(FieldAt *at)
{
    const SessionResult *result = run_result_of(at->of);
    json_t              *array = json_array();
    for (int i = 0; i < result->listed; i++) json_array_append_new(array, json_integer(result->number[i]));
    return array;
}

static json_t *list_mb(FieldAt *at)
{
    const Woods *w = &((const WoodsChoice *)at->of)->woods;
    return field_number(
        1e-6 * (double)((size_t)w->count * sizeof *w->plant + ((size_t)w->nx * (size_t)w->ny + 1) * sizeof *w->first));
}

static json_t *materials(FieldAt *at)
{
    const MadeWorld *made = ((const Run *)run_of_record(at->of))->made; /* NULL: nothing was heard */
    const Materials *m = made ? &made->world.materials : NULL;
    json_t          *array = m && m->count > 1 ? json_array() : NULL;
    for (int i = 1; array && i < m->count; i++) append(array, m->material[i].name);
    return array;
}

/* ---- the fields ---------------------------------------------------------------------------------- */

#define IN_RUN(member)     FIELD_IN(run_of_record, Run, member)
#define IN_RESULT(member)  FIELD_IN(run_result_of, SessionResult, member)
#define OF_WOODS(member)   FIELD_MEMBER(WoodsChoice, member)
#define OF_FIGURES(member) FIELD_MEMBER(LatencyFigures, member)
#define OF_STAGE(member)   FIELD_MEMBER(StageTimes, member)

static const Field key_rows[] = {
    {"KEY", "as in `pitviper check --default`", "", "", "its value as text; `nan`: not given",
     FIELD_ELSEWHERE("string")},
};

static const Field file_rows[] = {
    {"FILE", "", "", "", "SHA-256; of a folder of the atmosphere: of all its tables", FIELD_ELSEWHERE("string")},
};

static const Field library_rows[] = {
    {"LIBRARY", "", "", "", "its version", FIELD_ELSEWHERE("string")},
};

static const Field kind_rows[] = {
    {"KIND", "", "", "", "plants", .item = next_kind, .kind = FIELD_OF_INT},
};

static const Field origin_rows[] = {
    {"crowns", "", "", "", "trunks marked in the terrain store", OF_WOODS(woods.from_crowns)},
    {"canopy", "", "", "", "its layers of canopy height and cover", OF_WOODS(woods.from_canopy)},
    {"classes", "", "", "", "surface classes alone", OF_WOODS(woods.from_classes)},
    {"hedges", "", "", "", "edges of fields", OF_WOODS(woods.from_hedges)},
};

static const Field woods_rows[] = {
    {"plants", "", "", "", "trees, bushes and hedges", OF_WOODS(woods.count)},
    {"kinds", "", "", "", "of these, by kind", FIELD_OBJECT(kind_rows)},
    {"from", "", "", "", "by what says where they stand", FIELD_OBJECT(origin_rows)},
    {"marked", "", "", "", "trees of terrain.trees with a painted ring", OF_WOODS(woods.marked)},
    {"left_out", "", "", "", "plants beyond terrain.woods_trees", OF_WOODS(woods.left_out)},
    {"reach_m", "m", "from what is on the ground in the middle of the world", "", "within it none is left out",
     OF_WOODS(woods.reach_m)},
    {"paths", "", "", "", "straight pieces of paths cleared of plants; on real ground none",
     OF_WOODS(config.path_count)},
    {"entities", "", "", "", "entities on the ground at their first report", OF_WOODS(entities)},
    {"in_trunks", "", "", "", "of these, within a trunk", OF_WOODS(in_trunks)},
    {"list_mb", "MB", "", "", "memory of the list of plants, without the ray tracer's", FIELD_GET("number", list_mb)},
};

static const Field stage_rows[] = {
    {"median", "ms", "", "", "median over the frames", OF_STAGE(median_ms)},
    {"p95", "ms", "", "", "95th percentile", OF_STAGE(p95_ms)},
    {"max", "ms", "", "", "maximum", OF_STAGE(max_ms)},
};

static const Field timing_rows[] = {
    {"STAGE", "", "", "", "one stage; `frame` is the total", .item = next_stage, FIELD_OBJECT(stage_rows)},
};

static const Field figure_rows[] = {
    {"median", "ms", "", "", "median, at most 2.4 % above the exact one", OF_FIGURES(median_ms), .as = field_ms},
    {"p95", "ms", "", "", "95th percentile, likewise", OF_FIGURES(p95_ms), .as = field_ms},
    {"p99", "ms", "", "", "99th percentile, likewise", OF_FIGURES(p99_ms), .as = field_ms},
    {"max", "ms", "", "", "maximum", OF_FIGURES(max_ms), .as = field_ms},
    {"count", "", "", "", "number of frames", OF_FIGURES(count)},
    {"histogram", "", "below the first edge, between edges, above the last", "", "number of frames by latency",
     OF_FIGURES(histogram)},
};

static const Field consumer_rows[] = {
    {"median", "ms", "", "when it was done with no frame", "as above", OF_FIGURES(median_ms), .as = field_ms},
    {"p95", "ms", "", "when it was done with no frame", "as above", OF_FIGURES(p95_ms), .as = field_ms},
    {"p99", "ms", "", "when it was done with no frame", "as above", OF_FIGURES(p99_ms), .as = field_ms},
    {"max", "ms", "", "when it was done with no frame", "as above", OF_FIGURES(max_ms), .as = field_ms},
    {"count", "", "", "", "frames that it was done with", OF_FIGURES(count)},
    {"left_out", "", "", "", "frames that it was not given, for lack of time", OF_FIGURES(left_out)},
    {"histogram", "", "as above", "", "number of frames by latency", OF_FIGURES(histogram)},
};

static const Field consumers_rows[] = {
    {"CONSUMER", "", "", "", "one consumer", .item = next_consumer, FIELD_OBJECT(consumer_rows)},
};

static const Field latency_rows[] = {
    {"edges_ms", "ms", "ascending", "", "edges of the histograms' bins, five a decade, 0.01 ms .. 10 s",
     FIELD_MEMBER(LatencySummary, edge_ms)},
    {"LATENCY", "", "", "when no frame has it",
     "one step; arrival_to_pose: only of frames that used a datagram which no earlier frame used", .item = next_latency,
     FIELD_OBJECT(figure_rows)},
    {"consumers", "", "", "", "by consumer: from the end of rendering until it was done", FIELD_OBJECT(consumers_rows)},
};

static const Field run_rows[] = {
    {"pitviper", "", "", "", "version of the program", FIELD_GET("string", program_version)},
    {"status", "", "", "", "complete; stopped: by a signal; failed", FIELD_IN(end_of, RunEnd, state)},
    {"planes", "", "", "", "planes of the truth files, or `none` (--planes, --no-files)", FIELD_GET("string", planes)},
    {"config_sha256", "", "", "", "SHA-256 of every setting that the planes depend on", IN_RUN(config_sha256)},
    {"settings", "", "", "", "those settings, given or by default", FIELD_OBJECT(key_rows), .get = settings},
    {"tables_sha256", "", "", "", "the tables and model files that were readable", FIELD_OBJECT(file_rows),
     .get = tables},
    {"log", "", "", "", "name of the log, or of the network's address", FIELD_GET("string", log_name)},
    {"log_sha256", "", "", "in a live run", "SHA-256 of the log's octets", FIELD_IN(logged, Run, log_sha256)},
    {"seed", "", "", "", "of all random numbers", IN_RUN(options.config.seed)},
    {"threads", "", "", "", "number of threads; no effect on the planes", IN_RUN(options.threads)},
    {"isa", "", "", "", "instruction set of the ray tracer", IN_RUN(options.isa)},
    {"libraries", "", "", "", "libraries used in the computation", FIELD_OBJECT(library_rows), .get = libraries},
    {"memory", "", "", "without publish.memory", "name of the ring of frames in /dev/shm",
     FIELD_MEMBER(RunRecord, memory)},
    {"detections_port", "", "", "without publish.detections_port", "UDP port that received a recogniser's answers",
     IN_RUN(options.config.publish.detections_port), .unless_0 = true},
    {"hosts", "", "site:application:entity, or `observer`", "",
     "which entities carried the sensor, one after the other", FIELD_GET("list of strings", hosts)},
    {"choices", "", "`what: choice`", "", "automatic choices, as printed", FIELD_GET("list of strings", choices)},
    {"frames", "", "", "", "number of frames rendered", IN_RESULT(frames)},
    {"frame_sha256", "", "as frame_number", "with publish.truth false", "SHA-256 of all planes before they are encoded",
     FIELD_GET("list of strings", frame_hashes)},
    {"frame_number", "", "from 0", "", "numbers of the frames in frame_sha256; of a very long run only the first",
     FIELD_GET("list of integers", frame_numbers)},
    {"woods", "", "", "with terrain.woods off", "plants that stand on the ground", .in = woods_of,
     FIELD_OBJECT(woods_rows)},
    {"scenery", "", "", "with none of terrain.buildings, terrain.trees and terrain.clutter",
     "what stands in the world and is no entity", .in = run_scenery_of, .type = "object", .rows = &run_scenery_fields},
    {"materials", "", "", "", "names of the materials: the k-th, from 1, is value k of the material planes",
     FIELD_GET("list of strings", materials)},
    {"counters", "", "", "", "over the whole run", .type = "object", .rows = &run_counter_fields},
    {"timings_ms", "", "", "", "wall time per stage of a frame; differs in every run", FIELD_OBJECT(timing_rows)},
    {"latency_ms", "", "", "in a replay at full speed",
     "latency_ms of truth.jsonl over all frames; of a run and of replay --speed X", .in = latency_of,
     FIELD_OBJECT(latency_rows)},
};
const FieldTable run_record_fields = {run_rows, sizeof run_rows / sizeof *run_rows};

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
    run_count_scenery(&record);
    for (int i = 0; i < session_stages; i++)
        log_detail("%s: %s: %.3g ms a frame (median; 95 %%: %.3g; most: %.3g)", name, session_stage_name[i],
                   record.stage[i].median_ms, record.stage[i].p95_ms, record.stage[i].max_ms);
    snprintf(path, sizeof path, "%s/run.json", end->folder);
    memory_name(ring, &run->options.config, run->options.host_count > 1 ? end->host : NULL);
    return write_file(path, &record);
}
