/* sensor/publish/records.c: truth.jsonl and run.json, line by line. */
#include "sensor/publish/records.h"
#include "pitviper_output.h"

#include "sensor/publish/json_write.h"
#include "sensor/publish/radar_record.h"
#include "sensor/publish/target_class.h"

#include <errno.h>
#include <gnu/libc-version.h>
#include <jansson.h>
#include <unistd.h>

static void set_text(json_t *object, const char *key, const char *bytes, size_t count)
{
    char text[256];
    text_escape(text, sizeof text, bytes, count);
    json_object_set_new(object, key, json_string(text));
}

static json_t *numbers(const double *value, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(array, json_real(value[i]));
    return array;
}

static json_t *pair_deg(const double value_rad[2])
{
    const double deg[2] = {value_rad[0] / rad_per_deg, value_rad[1] / rad_per_deg};
    return numbers(deg, 2);
}

static void set_id(json_t *object, const char *key, DisEntityId id)
{
    char text[dis_id_text_size];
    dis_entity_id_text(text, id);
    json_object_set_new(object, key, json_string(text));
}

static json_t *host_json(const FrameRecord *r)
{
    json_t  *host = json_object();
    Geodetic place;
    if (r->host) {
        set_id(host, "entity", r->host->id);
        set_text(host, "marking", r->host->marking, strnlen(r->host->marking, 11));
    } else {
        json_object_set_new(host, "entity", json_string("observer"));
    }
    json_object_set_new(host, "ecef_m", numbers(r->p_eye_ecef, 3));
    if (geodetic_from_ecef(&place, r->p_eye_ecef) == STATUS_OK) {
        set_number(host, "lat_deg", place.lat_rad / rad_per_deg);
        set_number(host, "lon_deg", place.lon_rad / rad_per_deg);
        set_number(host, "height_m", place.h_m);
    }
    double psi_rad, theta_rad, phi_rad;
    euler_from_r_ecef_from_body(&psi_rad, &theta_rad, &phi_rad, r->r_ecef_from_body);
    set_number(host, "psi_deg", psi_rad / rad_per_deg);
    set_number(host, "theta_deg", theta_rad / rad_per_deg);
    set_number(host, "phi_deg", phi_rad / rad_per_deg);
    set_number(host, "speed_mps", v3_length(r->host ? r->host->v_ecef_mps : r->v_eye_mps));
    return host;
}

static json_t *sensor_json(const FrameRecord *r)
{
    json_t     *sensor = json_object(), *bands = json_array();
    const View *view = &r->request->view;
    for (int b = 0; b < BAND_COUNT; b++)
        if (r->request->bands >> b & 1) json_array_append_new(bands, json_string(band_name((Band)b)));
    json_object_set_new(sensor, "name", json_string("seeker"));
    json_object_set_new(sensor, "bands", bands);
    json_object_set_new(sensor, "width_px", json_integer(view->width));
    json_object_set_new(sensor, "height_px", json_integer(view->height));
    set_number(sensor, "hfov_deg", r->hfov_rad / rad_per_deg);
    set_number(sensor, "vfov_deg", 2 * atan(0.5 * view->height / view->focal_px) / rad_per_deg);
    if (view_has_lens(view)) {
        const Lens  *l = &view->lens;
        const double opencv[5] = {l->k[0], l->k[1], l->p[0], l->p[1], l->k[2]};
        json_object_set_new(sensor, "distortion", numbers(opencv, 5));
    }
    if (r->request->lateral[0] != 0 || r->request->lateral[1] != 0)
        json_object_set_new(sensor, "lateral_colour", numbers(r->request->lateral, 2));
    json_object_set_new(sensor, "ecef_from_cam", numbers(r->r_ecef_from_cam, 9));
    json_object_set_new(sensor, "gimbal_at_limit", json_boolean(r->gimbal_at_limit));
    json_object_set_new(sensor, "scene_rate_px_s", numbers(r->scene_rate_px_s, 2));
    return sensor;
}

static json_t *bands_json(const TargetRecord *t)
{
    json_t *bands = json_object();
    for (int b = 0; b < BAND_COUNT; b++) {
        json_t           *band = json_object();
        const TargetBand *v    = &t->band[b];
        set_number(band, "contrast_k", v->contrast_k);
        set_number(band, "dt_rss_k", v->dt_rss_k);
        set_number(band, "contrast", v->contrast);
        set_number(band, "snr", v->snr);
        set_number(band, "veil_transmittance", v->veil_transmittance);
        set_number(band, "intensity_w_sr", v->intensity_w_sr);
        set_number(band, "intensity_error_w_sr", v->intensity_error_w_sr);
        set_number(band, "error_rms_k", v->error_rms_k);
        set_number(band, "error_median_k", v->error_median_k);
        if (json_object_size(band) > 0)
            json_object_set_new(bands, band_name((Band)b), band);
        else
            json_decref(band);
    }
    return bands;
}

static json_t *target_json(const TargetRecord *t)
{
    json_t *target = json_object();
    char    type[dis_type_text_size], occluder_id[dis_id_text_size];

    set_id(target, "entity", t->id);
    set_text(target, "marking", t->marking, strnlen(t->marking, 11));
    dis_entity_type_text(type, t->type);
    json_object_set_new(target, "type", json_string(type));
    json_object_set_new(target, "class", json_string(target_class_name(t->class_number)));
    json_object_set_new(target, "plane_value", json_integer(t->plane_value));
    json_object_set_new(target, "model", json_string(t->model));
    set_number(target, "range_m", t->range_m);
    set_number(target, "closing_mps", t->closing_mps);
    set_number(target, "aspect_deg", t->aspect_rad / rad_per_deg);
    set_number(target, "depression_deg", t->depression_rad / rad_per_deg);
    set_number(target, "los_az_deg", t->los_az_rad / rad_per_deg);
    set_number(target, "los_el_deg", t->los_el_rad / rad_per_deg);
    json_object_set_new(target, "los_rate_dps", pair_deg(t->los_rate_rps));
    json_object_set_new(target, "boresight_error_deg", pair_deg(t->boresight_error_rad));
    set_number(target, "pixels", t->pixels);
    set_number(target, "visible_fraction", t->visible_fraction);
    set_number(target, "foliage_fraction", t->foliage_fraction);
    if (!box_is_empty(t->box)) {
        json_t *box = json_array();
        for (int k = 0; k < 4; k++) json_array_append_new(box, json_integer(t->box[k]));
        json_object_set_new(target, "box_px", box);
    }
    json_object_set_new(target, "amodal_box_px", numbers(t->amodal_box, 4));
    const char *occluder = target_occluder_text(occluder_id, t);
    if (occluder) json_object_set_new(target, "occluded_by", json_string(occluder));
    set_number(target, "dt_k", t->dt_k);
    if (t->patches > 0) {
        json_t *patches = json_array();
        for (int k = 0; k < t->patches; k++)
            json_array_append_new(patches, json_real(round(100 * (double)t->patch_k[k]) / 100));
        json_object_set_new(target, "patch_temp_k", patches);
    }
    set_number(target, "age_s", t->age_s);
    set_number(target, "position_error_m", t->position_error_m);
    set_number(target, "error_px", t->error_px);
    json_object_set_new(target, "bands", bands_json(t));
    return target;
}

/* By source: as a share, and the same in a unit. */
static json_t *error_by_source(const double share[error_sources], const double same[error_sources], const char *unit)
{
    static const char *const name[error_sources] = {"sampling", "level_of_detail", "table",
                                                    "heat",     "dead_reckoning",  "total"};
    json_t *band = json_object();
    char    key[32];
    for (int s = 0; s < error_sources; s++) {
        snprintf(key, sizeof key, "%s_%s", name[s], unit);
        set_number(band, name[s], share[s]);
        set_number(band, key, same[s]);
    }
    return band;
}

static void set_if_known(json_t *error, const char *of, json_t *band)
{
    if (json_object_size(band) > 0) json_object_set_new(error, of, band);
    else json_decref(band);
}

/* rms over the image as a share of the band's mean; _k: the same in kelvin about that mean. The mean of the pseudo-radar
 * is that of a few mirrors, and no measure. Of the radar over its map; _db: of an entity's cross section. */
static json_t *error_json(const FrameRecord *r)
{
    const FrameError *e = r->error;
    json_t           *error = json_object();
    for (int b = 0; b < BAND_RADAR && e; b++) {
        json_t *band = error_by_source(e->share[b], e->kelvin[b], "k");
        set_number(band, "median_k", e->median_k[b]);
        set_number(band, "beyond_1k", e->beyond_1k[b]);
        set_if_known(error, band_name((Band)b), band);
    }
    if (r->radar_error) set_if_known(error, "range_doppler", error_by_source(r->radar_error->share, r->radar_error->db, "db"));
    return error;
}

char *record_frame_text(const FrameRecord *r)
{
    json_t *line = json_object(), *sun = json_object(), *sensors = json_array(), *targets = json_array();
    json_object_set_new(line, "frame", json_integer(r->frame));
    set_number(line, "time_s", r->time_s);
    if (r->frame_sha256) json_object_set_new(line, "frame_sha256", json_string(r->frame_sha256));
    json_object_set_new(line, "host", host_json(r));
    set_number(sun, "azimuth_deg", r->sun->azimuth_rad / rad_per_deg);
    set_number(sun, "elevation_deg", r->sun->elevation_rad / rad_per_deg);
    json_object_set_new(line, "sun", sun);
    json_array_append_new(sensors, sensor_json(r));
    json_object_set_new(line, "sensors", sensors);
    for (int i = 0; i < r->target_count; i++) json_array_append_new(targets, target_json(&r->target[i]));
    json_object_set_new(line, "targets", targets);
    if (r->error || r->radar_error) json_object_set_new(line, "error", error_json(r));
    if (r->radar) json_object_set_new(line, "radar", radar_record_json(r->radar, r->snapshot, r->catalog));

    char *text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(15));
    json_decref(line);
    return text;
}

/* To the microsecond. */
static void set_ms(json_t *object, const char *key, double ms) { set_number(object, key, round(1e3 * ms) * 1e-3); }

static char *latency_text(const LatencyLine *l)
{
    json_t *latency = json_object(), *consumers = json_object();
    for (int i = 0; i < LATENCY_STAGE_COUNT; i++) set_ms(latency, latency_stage_name[i], l->stage_ms[i]);
    for (int i = 0; i < l->consumers; i++) set_ms(consumers, l->name[i], l->done_ms[i]);
    json_object_set_new(latency, "consumers", consumers);
    char *text = json_dumps(latency, JSON_COMPACT | JSON_REAL_PRECISION(9));
    json_decref(latency);
    return text;
}

Status record_write_text(FILE *file, const char *text, const LatencyLine *latency)
{
    char *more = latency ? latency_text(latency) : NULL;
    if (latency && !more) return STATUS_NO_MEMORY;
    const int  length = (int)strlen(text) - 1; /* the object is still open: without its last brace */
    const bool ok     = (more ? fprintf(file, "%.*s,\"latency_ms\":%s}\n", length, text, more)
                              : fprintf(file, "%s\n", text)) > 0 && fflush(file) == 0;
    free(more);
    if (!ok) log_error("records: cannot write truth.jsonl: %s", strerror(errno));
    return ok ? STATUS_OK : STATUS_IO;
}

Status record_write_frame(FILE *file, const FrameRecord *r)
{
    char *text = record_frame_text(r);
    if (!text) return STATUS_NO_MEMORY;
    const Status status = record_write_text(file, text, NULL);
    free(text);
    return status;
}

/* ---- run.json ------------------------------------------------------------------------------- */

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

double live_kept_share(const LiveCounters *c, uint64_t frames)
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
        json_object_set_new(live, "kept_share", json_real(live_kept_share(c, frames)));
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
        if (i != DETECTIONS_GOOD && i != DETECTIONS_LATE) set_if_any(refused, detections_reason_name[i], c->datagrams[i]);
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
    for (int k = 0; k < SKIP_COUNT; k++) set_count(skipped, skip_name((Skip)k), v->skipped[k]);
    json_object_set_new(counters, "skipped", skipped);
    return counters;
}

/* `section.key=value`, lines; all values as text. */
static json_t *settings_json(const char *text)
{
    json_t *settings = json_object();
    char    key[96];
    for (size_t length; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        const size_t name = strcspn(text, "=");
        if (name >= length || name >= sizeof key) continue;
        snprintf(key, sizeof key, "%.*s", (int)name, text);
        set_text(settings, key, text + name + 1, length - name - 1);
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
    set_ms(figures, "median", f->median_ms);
    set_ms(figures, "p95", f->p95_ms);
    set_ms(figures, "p99", f->p99_ms);
    set_ms(figures, "max", f->max_ms);
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
    json_object_set_new(latency, "edges_ms", numbers(l->edge_ms, latency_edges));
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
    for (int k = 0; k < PLANT_STANDING; k++)
        set_count(kinds, plant_name((PlantKind)k), (uint64_t)w->by_kind[k]);
    json_object_set_new(woods, "kinds", kinds);
    set_count(from, "crowns", (uint64_t)w->from_crowns);
    set_count(from, "canopy", (uint64_t)w->from_canopy);
    set_count(from, "classes", (uint64_t)w->from_classes);
    set_count(from, "hedges", (uint64_t)w->from_hedges);
    json_object_set_new(woods, "from", from);
    set_count(woods, "left_out", (uint64_t)w->left_out);
    set_number(woods, "reach_m", w->reach_m);
    set_count(woods, "paths", (uint64_t)r->paths);
    set_count(woods, "entities", (uint64_t)r->entities);
    set_count(woods, "in_trunks", (uint64_t)r->in_trunks);
    set_number(woods, "list_mb", 1e-6 * (double)((size_t)w->count * sizeof *w->plant +
                                                 ((size_t)w->nx * (size_t)w->ny + 1) * sizeof *w->first));
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
    set_text(run, "log", r->log_name, strlen(r->log_name));
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
        set_number(stage, "median", r->stage_ms[i][0]);
        set_number(stage, "p95", r->stage_ms[i][1]);
        set_number(stage, "max", r->stage_ms[i][2]);
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
