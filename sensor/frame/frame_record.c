/* sensor/frame/frame_record.c: truth.jsonl, a line per frame. */
#include "sensor/frame/records.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/radar_record.h"
#include "sensor/frame/target_record.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>

static json_t *pair_deg(const double value_rad[2])
{
    const double deg[2] = {value_rad[0] / rad_per_deg, value_rad[1] / rad_per_deg};
    return json_number_list(deg, 2);
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
        json_set_text(host, "marking", r->host->marking, strnlen(r->host->marking, 11));
    } else {
        json_object_set_new(host, "entity", json_string("observer"));
    }
    json_object_set_new(host, "ecef_m", json_number_list(r->p_eye_ecef, 3));
    if (geodetic_from_ecef(&place, r->p_eye_ecef) == STATUS_OK) {
        json_set_number(host, "lat_deg", place.lat_rad / rad_per_deg);
        json_set_number(host, "lon_deg", place.lon_rad / rad_per_deg);
        json_set_number(host, "height_m", place.h_m);
    }
    double psi_rad, theta_rad, phi_rad;
    euler_from_r_ecef_from_body(&psi_rad, &theta_rad, &phi_rad, r->r_ecef_from_body);
    json_set_number(host, "psi_deg", psi_rad / rad_per_deg);
    json_set_number(host, "theta_deg", theta_rad / rad_per_deg);
    json_set_number(host, "phi_deg", phi_rad / rad_per_deg);
    json_set_number(host, "speed_mps", v3_length(r->host ? r->host->v_ecef_mps : r->v_eye_mps));
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
    json_set_number(sensor, "hfov_deg", r->hfov_rad / rad_per_deg);
    json_set_number(sensor, "vfov_deg", 2 * atan(0.5 * view->height / view->focal_px) / rad_per_deg);
    if (view_has_lens(view)) {
        const Lens  *l = &view->lens;
        const double opencv[5] = {l->k[0], l->k[1], l->p[0], l->p[1], l->k[2]};
        json_object_set_new(sensor, "distortion", json_number_list(opencv, 5));
    }
    if (r->request->lateral[0] != 0 || r->request->lateral[1] != 0)
        json_object_set_new(sensor, "lateral_colour", json_number_list(r->request->lateral, 2));
    json_object_set_new(sensor, "ecef_from_cam", json_number_list(r->r_ecef_from_cam, 9));
    json_object_set_new(sensor, "gimbal_at_limit", json_boolean(r->gimbal_at_limit));
    json_object_set_new(sensor, "scene_rate_px_s", json_number_list(r->scene_rate_px_s, 2));
    return sensor;
}

static json_t *bands_json(const TargetRecord *t)
{
    json_t *bands = json_object();
    for (int b = 0; b < BAND_COUNT; b++) {
        json_t           *band = json_object();
        const TargetBand *v = &t->band[b];
        json_set_number(band, "contrast_k", v->contrast_k);
        json_set_number(band, "dt_rss_k", v->dt_rss_k);
        json_set_number(band, "contrast", v->contrast);
        json_set_number(band, "snr", v->snr);
        json_set_number(band, "veil_transmittance", v->veil_transmittance);
        json_set_number(band, "intensity_w_sr", v->intensity_w_sr);
        json_set_number(band, "intensity_error_w_sr", v->intensity_error_w_sr);
        json_set_number(band, "error_rms_k", v->error_rms_k);
        json_set_number(band, "error_median_k", v->error_median_k);
        if (json_object_size(band) > 0) json_object_set_new(bands, band_name((Band)b), band);
        else json_decref(band);
    }
    return bands;
}

static json_t *target_json(const TargetRecord *t)
{
    json_t *target = json_object();
    char    type[dis_type_text_size], occluder_id[dis_id_text_size];

    set_id(target, "entity", t->id);
    json_set_text(target, "marking", t->marking, strnlen(t->marking, 11));
    dis_entity_type_text(type, t->type);
    json_object_set_new(target, "type", json_string(type));
    json_object_set_new(target, "class", json_string(target_class_name(t->class_number)));
    json_object_set_new(target, "plane_value", json_integer(t->plane_value));
    json_object_set_new(target, "model", json_string(t->model));
    json_set_number(target, "range_m", t->range_m);
    json_set_number(target, "closing_mps", t->closing_mps);
    json_set_number(target, "aspect_deg", t->aspect_rad / rad_per_deg);
    json_set_number(target, "depression_deg", t->depression_rad / rad_per_deg);
    json_set_number(target, "los_az_deg", t->los_az_rad / rad_per_deg);
    json_set_number(target, "los_el_deg", t->los_el_rad / rad_per_deg);
    json_object_set_new(target, "los_rate_dps", pair_deg(t->los_rate_rps));
    json_object_set_new(target, "boresight_error_deg", pair_deg(t->boresight_error_rad));
    json_set_number(target, "pixels", t->pixels);
    json_set_number(target, "visible_fraction", t->visible_fraction);
    json_set_number(target, "foliage_fraction", t->foliage_fraction);
    if (!target_box_is_empty(t->box)) {
        json_t *box = json_array();
        for (int k = 0; k < 4; k++) json_array_append_new(box, json_integer(t->box[k]));
        json_object_set_new(target, "box_px", box);
    }
    json_object_set_new(target, "amodal_box_px", json_number_list(t->amodal_box, 4));
    const char *occluder = target_occluder_text(occluder_id, t);
    if (occluder) json_object_set_new(target, "occluded_by", json_string(occluder));
    json_set_number(target, "dt_k", t->dt_k);
    if (t->patches > 0) {
        json_t *patches = json_array();
        for (int k = 0; k < t->patches; k++)
            json_array_append_new(patches, json_real(round(100 * (double)t->patch_k[k]) / 100));
        json_object_set_new(target, "patch_temp_k", patches);
    }
    json_set_number(target, "age_s", t->age_s);
    json_set_number(target, "position_error_m", t->position_error_m);
    json_set_number(target, "error_px", t->error_px);
    json_object_set_new(target, "bands", bands_json(t));
    return target;
}

/* Makes an object of errors by source: each as a share, and in a unit. */
static json_t *error_by_source(const double share[error_sources], const double same[error_sources], const char *unit)
{
    static const char *const name[error_sources] = {"sampling", "level_of_detail", "table",
                                                    "heat",     "dead_reckoning",  "total"};
    json_t                  *band = json_object();
    char                     key[32];
    for (int s = 0; s < error_sources; s++) {
        snprintf(key, sizeof key, "%s_%s", name[s], unit);
        json_set_number(band, name[s], share[s]);
        json_set_number(band, key, same[s]);
    }
    return band;
}

static void set_if_known(json_t *error, const char *of, json_t *band)
{
    if (json_object_size(band) > 0) json_object_set_new(error, of, band);
    else json_decref(band);
}

/* rms over the image as a share of the band's mean; _k: the same in kelvin about that mean. The mean of the
 * pseudo-radar is that of a few mirrors, and no measure. Of the radar over its map; _db: of an entity's cross section.
 */
static json_t *error_json(const FrameRecord *r)
{
    const FrameError *e = r->error;
    json_t           *error = json_object();
    for (int b = 0; b < BAND_RADAR && e; b++) {
        json_t *band = error_by_source(e->share[b], e->kelvin[b], "k");
        json_set_number(band, "median_k", e->median_k[b]);
        json_set_number(band, "beyond_1k", e->beyond_1k[b]);
        set_if_known(error, band_name((Band)b), band);
    }
    if (r->radar_error)
        set_if_known(error, "range_doppler", error_by_source(r->radar_error->share, r->radar_error->db, "db"));
    return error;
}

char *record_frame_text(const FrameRecord *r)
{
    json_t *line = json_object(), *sun = json_object(), *sensors = json_array(), *targets = json_array();
    json_object_set_new(line, "frame", json_integer(r->frame));
    json_set_number(line, "time_s", r->time_s);
    if (r->frame_sha256) json_object_set_new(line, "frame_sha256", json_string(r->frame_sha256));
    json_object_set_new(line, "host", host_json(r));
    json_set_number(sun, "azimuth_deg", r->sun->azimuth_rad / rad_per_deg);
    json_set_number(sun, "elevation_deg", r->sun->elevation_rad / rad_per_deg);
    json_object_set_new(line, "sun", sun);
    json_array_append_new(sensors, sensor_json(r));
    json_object_set_new(line, "sensors", sensors);
    for (int i = 0; i < r->target_count; i++) json_array_append_new(targets, target_json(&r->target[i]));
    json_object_set_new(line, "targets", targets);
    if (r->error || r->radar_error) json_object_set_new(line, "error", error_json(r));
    if (r->given_up) json_object_set_new(line, "given_up", json_string(r->given_up));
    if (r->radar) json_object_set_new(line, "radar", radar_record_json(r->radar, r->snapshot, r->catalog));

    char *text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(15));
    json_decref(line);
    return text;
}

static char *latency_text(const LatencyLine *l)
{
    json_t *latency = json_object(), *consumers = json_object();
    for (int i = 0; i < LATENCY_STAGE_COUNT; i++) json_set_ms(latency, latency_stage_name[i], l->stage_ms[i]);
    for (int i = 0; i < l->consumers; i++) json_set_ms(consumers, l->name[i], l->done_ms[i]);
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
    const bool ok =
        (more ? fprintf(file, "%.*s,\"latency_ms\":%s}\n", length, text, more) : fprintf(file, "%s\n", text)) > 0 &&
        fflush(file) == 0;
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
