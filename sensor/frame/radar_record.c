/* sensor/frame/radar_record.c: writes what the radar measured in a frame as the radar object of truth.jsonl. */
#include "sensor/frame/radar_record.h"

#include "sensor/frame/json_object.h"

#include <jansson.h>

static double db(double ratio) { return 10 * log10(ratio); }

static json_t *direction_json(json_t *object, double cos_right, double cos_down)
{
    json_set_number(object, "az_deg", asin(clamp(cos_right, -1, 1)) / rad_per_deg);
    json_set_number(object, "el_deg", -asin(clamp(cos_down, -1, 1)) / rad_per_deg);
    return object;
}

static json_t *detection_json(const Detection *d)
{
    json_t *o = json_object();
    json_set_number(o, "range_m", d->range_m);
    json_set_number(o, "range_rate_mps", d->range_rate_mps);
    direction_json(o, d->cos_right, d->cos_down);
    json_set_number(o, "snr_db", db(d->snr));
    json_set_number(o, "rcs_dbsm", db(d->rcs_m2));
    json_object_set_new(o, "moving", json_boolean(d->moving));
    return o;
}

static json_t *timing_json(const RadarFrame *r)
{
    const WaveformTiming *t = &r->timing;
    const Waveform       *w = &r->preset->wave;
    json_t               *o = json_object();
    json_object_set_new(o, "kind", json_string(waveform_name[w->kind]));
    json_set_number(o, "pulse_us", 1e6 * w->pulse_s);
    json_set_number(o, "sample_us", 1e6 * t->sample_s);
    json_set_number(o, "profile_ms", 1e3 * t->profile_s);
    json_set_number(o, "row_ms", 1e3 * t->row_s);
    json_set_number(o, "interval_ms", 1e3 * t->interval_s);
    json_set_number(o, "window_m", t->window_m);
    json_set_number(o, "unambiguous_m", t->unambiguous_m);
    json_set_number(o, "blind_mps", t->blind_mps);
    json_set_number(o, "coupling_s", t->coupling_s);
    json_set_number(o, "smear_s", t->smear_s);
    json_set_number(o, "beat_hz_m", t->beat_hz_m);
    return o;
}

static json_t *scatterer_json(const RadarScatterer *s, const Model *model)
{
    json_t *o = json_object(), *at = json_array();
    for (int k = 0; k < 3; k++) json_array_append_new(at, json_real(s->p_body[k]));
    json_set_number(o, "rcs_hh_dbsm", db(s->hh_m2));
    json_set_number(o, "rcs_vv_dbsm", db(s->vv_m2));
    json_object_set_new(o, "body_m", at);
    json_object_set_new(o, "bounces", json_integer(s->bounce));
    json_object_set_new(o, "visible", json_boolean(s->seen));
    if (s->part >= 0 && s->part < model->part_count)
        json_object_set_new(o, "part", json_string(model->part[s->part].name));
    return o;
}

static json_t *target_json(const RadarTruth *t, const Snapshot *snapshot, const Catalog *catalog)
{
    static const char *const polarisation[3] = {"hh", "vv", "hv"};
    json_t                  *o = json_object(), *rcs = json_object(), *error = json_object(), *strongest = json_array();
    const SnapshotEntity    *e = &snapshot->entity[t->entity];
    char                     text[dis_id_text_size];
    dis_entity_id_text(text, e->id);
    json_object_set_new(o, "entity", json_string(text));
    json_object_set_new(o, "signature", json_string(t->given ? "given" : "model"));
    json_set_number(o, "range_m", t->range_m);
    json_set_number(o, "range_rate_mps", t->range_rate_mps);
    json_set_number(o, "appears_m", t->appears_m);
    direction_json(o, t->cos_right, t->cos_down);
    json_set_number(o, "visible_fraction", t->visible);
    for (int p = 0; p < 3; p++) json_set_number(rcs, polarisation[p], db(t->rcs_m2[p]));
    json_object_set_new(o, "rcs_dbsm", rcs);
    for (int p = 0; p < 3; p++) json_set_number(error, polarisation[p], t->rcs_error_db[p]);
    if (!t->given) json_object_set_new(o, "rcs_error_db", error);
    else json_decref(error);
    json_set_number(o, "map_error_db", db(t->map_error));
    json_set_number(o, "snr_db", db(t->snr));
    json_object_set_new(o, "centres", json_integer(t->centres));
    if (t->bounce.coherence > 0) {
        const double *const      m2[3] = {t->bounce.rcs_m2, t->bounce.once_m2, t->bounce.twice_m2};
        static const char *const name[3] = {"rcs_dbsm", "once_dbsm", "twice_dbsm"};
        json_t                  *bounce = json_object();
        json_set_number(bounce, "coherence", t->bounce.coherence);
        for (int i = 0; i < 3; i++) {
            json_t *by = json_object();
            for (int p = 0; p < 3; p++) json_set_number(by, polarisation[p], db(m2[i][p]));
            json_object_set_new(bounce, name[i], by);
        }
        json_object_set_new(o, "ground_bounce", bounce);
    }
    const Model *model = catalog_model(catalog, e->model);
    for (int i = 0; i < t->strongest_count; i++)
        json_array_append_new(strongest, scatterer_json(&t->strongest[i], model));
    json_object_set_new(o, "strongest", strongest);
    return o;
}

int radar_arrays(FrameArray array[radar_arrays_most], const RadarFrame *r)
{
    const RadarSector *s = r->scan;
    array[0] = (FrameArray){.group = "radar",
                            .name = "range_doppler",
                            .unit = "sqrt(W)",
                            .kind = PLANE_RADIANCE,
                            .type = PLANE_F64,
                            .axes = 3,
                            .axis = {"channel", "range rate", "range: re, im"},
                            .size = {interval_channels, r->map.rows, 2 * r->map.columns},
                            .values = r->map.cell};
    if (!s) return 1;
    array[1] = array[2] = (FrameArray){.group = "radar",
                                       .name = "scan",
                                       .unit = "W",
                                       .kind = PLANE_RADIANCE,
                                       .type = PLANE_F64,
                                       .axes = 2,
                                       .axis = {"azimuth", "range"},
                                       .size = {s->plan.positions, s->columns},
                                       .values = s->power_w};
    array[2].name = "dbs";
    array[2].size[0] = s->azimuths;
    array[2].values = s->sharp_w;
    return radar_arrays_most;
}

Status radar_sha256(char out[sha256_text_size], const RadarFrame *r, int first, int most)
{
    FrameArray array[radar_arrays_most];
    Plane      plane[radar_arrays_most];
    char       ignored[frame_plane_name_size];
    int        count = 0;
    for (int i = first; i < radar_arrays(array, r) && count < most; i++) {
        plane[count] = frame_plane(ignored, &array[i]);
        plane[count++].name = array[i].name;
    }
    return plane_hash(out, plane, count);
}

static void set_hash(json_t *o, const RadarFrame *r)
{
    char hash[sha256_text_size];
    if (radar_sha256(hash, r, 0, 1) == STATUS_OK) json_object_set_new(o, "map_sha256", json_string(hash));
}

/* The scan: how it was made, and the hash of its pictures before anything is rounded for a file. */
static json_t *scan_json(const RadarFrame *r)
{
    const RadarSector *s = r->scan;
    json_t            *o = json_object();
    char               hash[sha256_text_size];
    json_object_set_new(o, "positions", json_integer(s->plan.positions));
    json_set_number(o, "step_deg", s->plan.step_rad / rad_per_deg);
    json_set_number(o, "interval_s", s->plan.interval_s);
    json_set_number(o, "beam_deg", s->beam_rad / rad_per_deg);
    json_set_number(o, "noise_dbw", db(s->noise_w));
    json_set_number(o, "sharpened_share", s->sharpened_share);
    if (radar_sha256(hash, r, 1, 2) == STATUS_OK) json_object_set_new(o, "sha256", json_string(hash));
    return o;
}

json_t *radar_record_json(const RadarFrame *r, const Snapshot *snapshot, const Catalog *catalog)
{
    json_t *o = json_object(), *detections = json_array(), *targets = json_array();
    json_object_set_new(o, "preset", json_string(r->preset->name));
    json_object_set_new(o, "waveform", timing_json(r));
    json_set_number(o, "reference_m", r->reference_m);
    json_set_number(o, "reference_rate_mps", r->reference_rate_mps);
    json_set_number(o, "ground_rate_mps", r->ground_rate_mps);
    json_set_number(o, "notch_mps", r->notch_mps);
    json_set_number(o, "air_db", r->air_db);
    json_set_number(o, "noise_dbw", db(r->receiver.noise_w * r->map.noise_share));
    json_object_set_new(o, "saturated", json_integer(r->receiver.saturated));
    json_object_set_new(o, "ground_cells", json_integer(r->ground_cells));
    json_object_set_new(o, "plants", json_integer(r->crowns));
    json_object_set_new(o, "chaff", json_integer(r->clouds));
    json_object_set_new(o, "rain_1_m", json_real(r->rain_1_m));
    json_object_set_new(o, "ground_hidden", json_integer(r->ground_hidden));
    set_hash(o, r);
    if (r->scan) json_object_set_new(o, "scan", scan_json(r));
    for (int i = 0; i < r->detections; i++) json_array_append_new(detections, detection_json(&r->detection[i]));
    json_object_set_new(o, "detections", detections);
    json_object_set_new(o, "detections_in_all", json_integer(r->detections_in_all));
    for (int i = 0; i < r->targets; i++) json_array_append_new(targets, target_json(&r->target[i], snapshot, catalog));
    json_object_set_new(o, "targets", targets);
    return o;
}
