/* sensor/frame/run_record.c: run.json: what a run was made with and what it counted. */
#include "sensor/frame/records.h"
#include "pitviper_output.h"

#include "sensor/frame/json_object.h"

#include <errno.h>
#include <gnu/libc-version.h>
#include <jansson.h>

static json_t *texts(const char *const *text, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(array, json_string(text[i]));
    return array;
}

static void set_count(json_t *object, const char *key, uint64_t count)
{
    json_object_set_new(object, key, json_integer((json_int_t)count));
}

/* Absent: 0. So records from before this counter stay comparable. */
static void set_if_any(json_t *object, const char *key, uint64_t count)
{
    if (count) set_count(object, key, count);
}

/* Versions of the program and its libraries. Headers of the libraries are included only by the files that use them:
 * versions come from the build (CMakeLists.txt); that of the C library, whose functions affect every number, from
 * the running one. */
static json_t *libraries_json(void)
{
    json_t *libraries = json_object();
    json_object_set_new(libraries, "embree", json_string(PITVIPER_EMBREE_VERSION));
    json_object_set_new(libraries, "openimageio", json_string(PITVIPER_OPENIMAGEIO_VERSION));
    json_object_set_new(libraries, "geographiclib", json_string(PITVIPER_GEOGRAPHICLIB_VERSION));
    json_object_set_new(libraries, "erfa", json_string(PITVIPER_ERFA_VERSION));
    json_object_set_new(libraries, "fftw", json_string(PITVIPER_FFTW_VERSION));
    json_object_set_new(libraries, "libc", json_string(gnu_get_libc_version()));
    json_object_set_new(libraries, "compiler", json_string(PITVIPER_COMPILER));
    return libraries;
}

double record_live_kept_share(const LiveCounters *c, uint64_t frames)
{
    const uint64_t due = frames + c->frames_late;
    return due ? (double)frames / (double)due : 1;
}

static json_t *live_json(const LiveCounters *c, uint64_t frames)
{
    json_t *live = json_object();
    set_count(live, "datagrams", c->datagrams);
    set_count(live, "lost_kernel", c->lost_kernel);
    set_count(live, "lost_queue", c->lost_queue);
    set_count(live, "sent", c->sent);
    set_count(live, "send_failed", c->send_failed);
    set_count(live, "record_failed", c->record_failed);
    set_count(live, "frames_late", c->frames_late);
    if (c->rate_hz > 0) {
        json_object_set_new(live, "rate_hz", json_real(c->rate_hz));
        json_object_set_new(live, "kept_share", json_real(record_live_kept_share(c, frames)));
    }
    set_count(live, "files_failed", c->files_failed);
    set_count(live, "files_left_out", c->files_left_out);
    return live;
}

static json_t *answers_json(const AnswerCounters *c)
{
    json_t  *answers = json_object(), *refused = json_object();
    uint64_t received = 0;
    for (int i = 0; i < DETECTIONS_REASONS; i++) received += c->datagrams[i];
    set_count(answers, "datagrams", received + c->lost_kernel);
    set_count(answers, "taken", c->datagrams[DETECTIONS_GOOD] + c->datagrams[DETECTIONS_LATE]);
    set_count(answers, "late", c->datagrams[DETECTIONS_LATE]);
    for (int i = 0; i < DETECTIONS_REASONS; i++)
        if (i != DETECTIONS_GOOD && i != DETECTIONS_LATE)
            set_if_any(refused, detections_reason_name[i], c->datagrams[i]);
    json_object_set_new(answers, "refused", refused);
    set_count(answers, "lost_kernel", c->lost_kernel);
    set_count(answers, "lines", c->lines);
    set_if_any(answers, "lines_failed", c->lines_failed);
    return answers;
}

static json_t *streams_json(const StreamCounters *c)
{
    json_t *streams = json_object();
    set_count(streams, "sent", c->sent);
    set_count(streams, "refused", c->refused);
    set_count(streams, "no_route", c->no_route);
    set_count(streams, "lost", c->lost);
    return streams;
}

static json_t *counters_json(const RunRecord *r)
{
    json_t *counters = json_object(), *pdus = json_object(), *dropped = json_object(), *skipped = json_object();
    json_t *entities = json_object(), *effects = json_object();
    char    type[16];
    const VisibilityCounters *v = &r->render.visibility;

    set_count(counters, "datagrams", r->dis->datagrams);
    for (int i = 0; i < 256; i++)
        if (r->dis->pdus[i]) {
            snprintf(type, sizeof type, "%d", i);
            set_count(pdus, type, r->dis->pdus[i]);
        }
    json_object_set_new(counters, "pdus", pdus);
    for (int i = 0; i < DIS_DROP_COUNT; i++) {
        if (i == DIS_DROP_LENGTH_ZERO) set_if_any(dropped, dis_drop_name((DisDrop)i), r->dis->dropped[i]);
        else set_count(dropped, dis_drop_name((DisDrop)i), r->dis->dropped[i]);
    }
    json_object_set_new(counters, "dropped", dropped);
    set_if_any(counters, "lengths_made", r->dis->lengths_made);
    set_if_any(counters, "padded", r->dis->padded);
    set_count(counters, "stamps_doubted", r->dis->stamps_doubted);
    set_count(counters, "packets_without_datagram", r->link_dropped);
    set_count(counters, "own", r->own);
    if (r->live) json_object_set_new(counters, "live", live_json(r->live, (uint64_t)r->frames));
    if (r->answers) json_object_set_new(counters, "answers", answers_json(r->answers));
    if (r->streams) json_object_set_new(counters, "streams", streams_json(&r->sent->stream));
    set_if_any(counters, "frames_in_a_lost_ring", r->sent->frames_unnamed);
    json_object_set_new(counters, "frames_at_gimbal_limit", json_integer(r->at_limit));
    set_if_any(counters, "frames_without_radar", (uint64_t)r->radar_left_out);
    set_if_any(counters, "frames_reduced", (uint64_t)r->frames_reduced);
    set_count(entities, "created", r->entities_created);
    set_count(entities, "timed_out", r->entities_timed_out);
    set_count(entities, "deactivated", r->entities_deactivated);
    set_count(entities, "removed", r->entities_removed);
    set_count(entities, "evicted", r->entities_evicted);
    set_count(entities, "refused", r->entities_refused);
    set_if_any(entities, "over_rate", r->entities_over_rate);
    set_if_any(entities, "tombstones_dropped", r->tombstones_dropped);
    set_if_any(entities, "marks_forgotten", r->marks_forgotten);
    set_if_any(entities, "shots_forgotten", r->shots_forgotten);
    set_if_any(entities, "munitions_forgotten", r->munitions_forgotten);
    set_count(entities, "most_left_out_of_a_frame", (uint64_t)r->most_left_out);
    set_count(counters, "frames_without_all_entities", (uint64_t)r->frames_crowded);
    json_object_set_new(counters, "entities", entities);
    set_count(effects, "events_refused", r->effects.refused);
    set_count(effects, "events_repeated", r->effects.repeated);
    set_count(effects, "events_dropped", r->effects.events_dropped);
    set_count(effects, "trails_dropped", r->effects.sources_dropped);
    json_object_set_new(counters, "effects", effects);
    set_count(counters, "rays_primary", r->render.rays_primary);
    set_count(counters, "rays_edges", r->render.rays_edges);
    set_count(counters, "rays_small_targets", r->render.rays_small_targets);
    set_count(counters, "pixels", r->render.pixels);
    set_count(counters, "pixels_refined", r->render.pixels_refined);
    set_count(counters, "small_targets", r->render.small_targets);
    set_if_any(counters, "small_targets_by_pixels", r->render.small_targets_by_pixels);
    set_count(counters, "rays_ground", v->rays_ground);
    set_count(counters, "rays_parts", v->rays_parts);
    set_count(counters, "rays_sun_ground", v->rays_sun_ground);
    set_count(counters, "rays_sun_parts", v->rays_sun_parts);
    set_count(counters, "rays_sun_for_heat", v->rays_sun_for_heat);
    set_count(skipped, "ray_entity_pairs", v->skipped_parts);
    set_count(skipped, "sun_ray_entity_pairs", v->skipped_sun_parts);
    set_count(skipped, "tiles_without_entities", r->render.tiles_without_entities);
    for (int k = 0; k < SKIP_COUNT; k++) set_count(skipped, visibility_skip_name((Skip)k), v->skipped[k]);
    json_object_set_new(counters, "skipped", skipped);
    return counters;
}

/* Makes an object of lines `section.key=value`; all values are text. */
static json_t *settings_json(const char *text)
{
    json_t *settings = json_object();
    char    key[96];
    for (size_t length; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        const size_t name = strcspn(text, "=");
        if (name >= length || name >= sizeof key) continue;
        snprintf(key, sizeof key, "%.*s", (int)name, text);
        json_set_text(settings, key, text + name + 1, length - name - 1);
    }
    return settings;
}

static json_t *tables_json(const RunRecord *r)
{
    json_t *tables = json_object();
    for (int i = 0; i < r->table_count; i++) json_object_set_new(tables, r->table[i], json_string(r->table_sha256[i]));
    return tables;
}

static json_t *figures_json(const LatencyFigures *f, bool consumer)
{
    json_t *figures = json_object(), *histogram = json_array();
    json_set_ms(figures, "median", f->median_ms);
    json_set_ms(figures, "p95", f->p95_ms);
    json_set_ms(figures, "p99", f->p99_ms);
    json_set_ms(figures, "max", f->max_ms);
    set_count(figures, "count", f->count);
    if (consumer) set_count(figures, "left_out", f->left_out);
    for (int i = 0; i <= latency_edges; i++)
        json_array_append_new(histogram, json_integer((json_int_t)f->histogram[i]));
    json_object_set_new(figures, "histogram", histogram);
    return figures;
}

static json_t *latency_json(const LatencySummary *l)
{
    json_t *latency = json_object(), *consumers = json_object();
    json_object_set_new(latency, "edges_ms", json_number_list(l->edge_ms, latency_edges));
    for (int i = 0; i < LATENCY_STAGE_COUNT; i++)
        if (l->stage[i].count > 0)
            json_object_set_new(latency, latency_stage_name[i], figures_json(&l->stage[i], false));
    for (int i = 0; i < l->consumers; i++)
        json_object_set_new(consumers, l->name[i], figures_json(&l->consumer[i], true));
    json_object_set_new(latency, "consumers", consumers);
    return latency;
}

static json_t *woods_json(const WoodsRecord *r)
{
    const Woods *w = r->woods;
    json_t      *woods = json_object(), *kinds = json_object(), *from = json_object();
    set_count(woods, "plants", (uint64_t)w->count);
    for (int k = 0; k < PLANT_STANDING; k++) set_count(kinds, plant_name((PlantKind)k), (uint64_t)w->by_kind[k]);
    json_object_set_new(woods, "kinds", kinds);
    set_count(from, "crowns", (uint64_t)w->from_crowns);
    set_count(from, "canopy", (uint64_t)w->from_canopy);
    set_count(from, "classes", (uint64_t)w->from_classes);
    set_count(from, "hedges", (uint64_t)w->from_hedges);
    json_object_set_new(woods, "from", from);
    set_count(woods, "left_out", (uint64_t)w->left_out);
    json_set_number(woods, "reach_m", w->reach_m);
    set_count(woods, "paths", (uint64_t)r->paths);
    set_count(woods, "entities", (uint64_t)r->entities);
    set_count(woods, "in_trunks", (uint64_t)r->in_trunks);
    json_set_number(
        woods, "list_mb",
        1e-6 * (double)((size_t)w->count * sizeof *w->plant + ((size_t)w->nx * (size_t)w->ny + 1) * sizeof *w->first));
    return woods;
}

Status record_write_run(const char *path, const RunRecord *r)
{
    json_t *run = json_object(), *timings = json_object();

    json_object_set_new(run, "pitviper", json_string(PITVIPER_VERSION));
    json_object_set_new(run, "status", json_string(r->status));
    json_object_set_new(run, "planes", json_string(r->planes ? r->planes : "none"));
    json_object_set_new(run, "config_sha256", json_string(r->config_sha256));
    json_object_set_new(run, "settings", settings_json(r->settings));
    json_object_set_new(run, "tables_sha256", tables_json(r));
    json_set_text(run, "log", r->log_name, strlen(r->log_name));
    if (*r->log_sha256) json_object_set_new(run, "log_sha256", json_string(r->log_sha256));
    json_object_set_new(run, "seed", json_integer(r->seed));
    json_object_set_new(run, "threads", json_integer(r->threads));
    json_object_set_new(run, "isa", json_string(r->isa));
    json_object_set_new(run, "libraries", libraries_json());
    if (r->memory) json_object_set_new(run, "memory", json_string(r->memory));
    if (r->detections_port) json_object_set_new(run, "detections_port", json_integer(r->detections_port));
    json_object_set_new(run, "hosts", texts(r->host, r->host_count));
    json_object_set_new(run, "choices", texts(r->choice, r->choice_count));
    json_object_set_new(run, "frames", json_integer(r->frames));
    if (r->frame_sha256) json_object_set_new(run, "frame_sha256", texts(r->frame_sha256, r->listed));
    json_t *number = json_array();
    for (int i = 0; i < r->listed; i++) json_array_append_new(number, json_integer(r->frame_number[i]));
    json_object_set_new(run, "frame_number", number);
    if (r->woods) json_object_set_new(run, "woods", woods_json(r->woods));
    if (r->materials && r->materials->count > 1) {
        json_t *names = json_array();
        for (int i = 1; i < r->materials->count; i++)
            json_array_append_new(names, json_string(r->materials->material[i].name));
        json_object_set_new(run, "materials", names);
    }
    json_object_set_new(run, "counters", counters_json(r));
    for (int i = 0; i < r->stage_count; i++) {
        json_t *stage = json_object();
        json_set_number(stage, "median", r->stage_ms[i][0]);
        json_set_number(stage, "p95", r->stage_ms[i][1]);
        json_set_number(stage, "max", r->stage_ms[i][2]);
        json_object_set_new(timings, r->stage[i], stage);
    }
    json_object_set_new(run, "timings_ms", timings);
    if (r->latency) json_object_set_new(run, "latency_ms", latency_json(r->latency));

    FILE      *file = output_begin(path, 0);
    const bool put = file && json_dumpf(run, file, JSON_INDENT(1)) == 0;
    json_decref(run);
    if (put && output_end(file, path)) return STATUS_OK;
    if (file && !put) output_abandon(file, path);
    log_error("records: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}
