/* sensor/node/run/run_end.c: the end of a host's run: run.json, and the messages that say what there is. */
#include "sensor/node/run/host_run_private.h"

#include "sensor/instruments/radar.h"
#include "sensor/publish/memory/consume_memory.h"

#include <stdlib.h>

enum { path_size = 4096 };

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static Status summarise_stages(double out[session_stages][3], const SessionResult *r)
{
    double *sorted = calloc((size_t)r->listed + 1, sizeof *sorted);
    if (!sorted) return STATUS_NO_MEMORY;
    for (int stage = 0; stage < session_stages; stage++) {
        for (int i = 0; i < r->listed; i++) sorted[i] = r->stage_ms[i][stage];
        qsort(sorted, (size_t)r->listed, sizeof *sorted, compare_doubles);
        out[stage][0] = sorted[r->listed / 2];
        out[stage][1] =
            r->listed ? sorted[(int)ceil(0.95 * r->listed) - 1] : 0; /* nearest rank: never below the median */
        out[stage][2] = r->listed ? sorted[r->listed - 1] : 0;
    }
    free(sorted);
    return STATUS_OK;
}

Status run_write(const Run *run, const RunEnd *end)
{
    const Choices       *choices = end->choices;
    const SessionResult *result = end->result;
    const WoodsChoice   *woods = end->woods;
    char                 path[path_size + 16], settings[config_text_size], ring[memory_name_size];
    const Config        *config = &run->options.config;
    const char          *choice[choices_capacity], *hosts[session_hosts_kept];
    const char          *table[tables_used_max], *table_sha256[tables_used_max];
    double               stage_ms[session_stages][3];
    const char         **hash = calloc((size_t)result->listed + 1, sizeof *hash);
    if (!hash || summarise_stages(stage_ms, result) != STATUS_OK) {
        log_error("%s: out of memory for run.json", options_command(&run->options));
        free(hash);
        return STATUS_NO_MEMORY;
    }

    for (int i = 0; i < result->listed; i++) hash[i] = result->hash[i];
    config_text(settings, sizeof settings, &run->options.config);
    for (int i = 0; i < run->tables.count; i++) {
        table[i] = run->tables.table[i].name;
        table_sha256[i] = run->tables.table[i].sha256;
    }
    for (int i = 0; i < choices->count; i++) choice[i] = choices->line[i];
    for (int i = 0; i < result->host_count; i++) hosts[i] = result->host[i];
    if (result->host_count == 0) hosts[0] = end->host; /* not received so far */
    for (int i = 0; i < session_stages; i++)
        log_detail("%s: %s: %.3g ms a frame (median; 95 %%: %.3g; most: %.3g)", options_command(&run->options),
                   session_stage_name[i], stage_ms[i][0], stage_ms[i][1], stage_ms[i][2]);
    snprintf(path, sizeof path, "%s/run.json", end->folder);
    memory_name(ring, config, run->options.host_count > 1 ? end->host : NULL);
    const DisLogCounters *link = run->link;
    const WoodsRecord     plants = {.woods = &woods->woods,
                                    .paths = woods->config.path_count,
                                    .entities = woods->entities,
                                    .in_trunks = woods->in_trunks};
    const RunRecord       record = {.status = end->state,
                                    .planes = run->options.config.publish.files ? run->options.config.publish.planes : NULL,
                                    .config_sha256 = run->config_sha256,
                                    .log_name = run->log_name,
                                    .log_sha256 = run->log_sha256,
                                    .settings = settings,
                                    .table_count = run->tables.count,
                                    .table = table,
                                    .table_sha256 = table_sha256,
                                    .isa = run->options.isa,
                                    .seed = run->options.config.seed,
                                    .threads = run->options.threads,
                                    .host_count = result->host_count > 0 ? result->host_count : 1,
                                    .choice_count = choices->count,
                                    .frames = result->frames,
                                    .listed = result->listed,
                                    .frame_number = result->number,
                                    .host = hosts,
                                    .choice = choice,
                                    .frame_sha256 = run->options.config.publish.truth ? hash : NULL,
                                    .dis = end->heard,
                                    .link_dropped = link ? dis_log_dropped(link) : 0,
                                    .own = run->own,
                                    .live = run->live,
                                    .entities_created = result->entities.created,
                                    .entities_timed_out = result->entities.timed_out,
                                    .entities_deactivated = result->entities.deactivated,
                                    .entities_removed = result->entities.removed,
                                    .entities_evicted = result->entities.evicted,
                                    .entities_refused = result->entities.refused,
                                    .entities_over_rate = result->entities.over_rate,
                                    .tombstones_dropped = result->entities.tombstones_dropped,
                                    .marks_forgotten = result->entities.marks_forgotten,
                                    .shots_forgotten = result->shots_forgotten,
                                    .munitions_forgotten = result->munitions_forgotten,
                                    .frames_crowded = result->frames_crowded,
                                    .most_left_out = result->most_left_out,
                                    .at_limit = result->at_limit,
                                    .radar_left_out = instruments_left_out(result->instrument, &radar_kind),
                                    .frames_reduced = result->frames_reduced,
                                    .effects = result->effects,
                                    .render = result->counters,
                                    .stage_count = session_stages,
                                    .stage = session_stage_name,
                                    .stage_ms = stage_ms,
                                    .latency = clock_on_wall(run->clock) ? &result->latency : NULL,
                                    .woods = woods->on ? &plants : NULL,
                                    .memory = *config->publish.memory ? ring : NULL,
                                    .detections_port = config->publish.detections_port,
                                    .sent = &result->sent,
                                    .streams = *config->publish.stream != 0,
                                    .answers = config->publish.detections_port ? &result->answers : NULL,
                                    .materials = &run->world.materials};
    const Status          status = record_write_run(path, &record);
    free(hash);
    return status;
}

Status run_conclude(const Run *run, const RunEnd *end)
{
    const Config        *config = &run->options.config;
    const SessionResult *result = end->result;
    const char          *name = options_command(&run->options);
    const Status         status = run_write(run, end);
    if (run->stopped && !run->live) log_warn("%s: stopped before its last frame; run.json says so", name);
    if (config->publish.files) log_print("%d frames in %s/frames\n", result->frames, end->folder);
    else if (!config->publish.truth) log_print("%d frames; figures in %s/run.json\n", result->frames, end->folder);
    else log_print("%d frames; their truth is in %s/truth.jsonl\n", result->frames, end->folder);
    fflush(stdout);
    for (int i = 0; i < instruments_most; i++) {
        const InstrumentCount *lacking = &result->instrument[i];
        if (lacking->left_out > 0)
            log_warn("%s: %d of %d frames are without %s: %s", name, lacking->left_out, result->frames, lacking->name,
                     lacking->why);
    }
    if (result->at_limit > 0) /* its warning came when it was */
        log_print("the aim was beyond the gimbal in %d of %d frames (sensor.gimbal_limit_deg)\n", result->at_limit,
                  result->frames);
    if (result->buried > 0)
        log_warn("%s: the eye was below the ground in %d of %d frames and saw nothing of use%s", name, result->buried,
                 result->frames,
                 *config->terrain.elevation && config->terrain.ground != TERRAIN_GROUND_FIT
                     ? "; over other ground than the exercise's, terrain.ground=fit leads it through"
                     : "");
    return status;
}
