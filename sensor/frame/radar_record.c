/* sensor/frame/radar_record.c: the fields of what the radar measured in a frame: the object radar of truth.jsonl. */
#include "sensor/frame/radar_record.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"
#include "sensor/frame/records.h"

/* ---- hashes -------------------------------------------------------------------------------------- */

Status radar_map_sha256(char out[sha256_text_size], const RadarFrame *r)
{
    const Plane plane = {"range_doppler", PLANE_F64, 2 * r->map.columns, interval_channels * r->map.rows, r->map.cell};
    return plane_hash(out, &plane, 1);
}

static json_t *map_hash(const void *of, const void *record)
{
    char hash[sha256_text_size];
    (void)record;
    return radar_map_sha256(hash, of) == STATUS_OK ? json_string(hash) : NULL;
}

/* Of its pictures, before anything is rounded for a file. */
static json_t *scan_hash(const void *of, const void *record)
{
    const RadarSector *s = of;
    char               hash[sha256_text_size];
    const Plane        plane[] = {{"scan", PLANE_F64, s->columns, s->plan.positions, s->power_w},
                                  {"dbs", PLANE_F64, s->columns, s->azimuths, s->sharp_w}};
    (void)record;
    return plane_hash(hash, plane, 2) == STATUS_OK ? json_string(hash) : NULL;
}

/* ---- values that are no plain member ------------------------------------------------------------- */

/* Cosines along the sensor's right and down axes in degrees. */
static double azimuth(double cos_right) { return field_deg(asin(clamp(cos_right, -1, 1))); }
static double elevation(double cos_down) { return -asin(clamp(cos_down, -1, 1)) / rad_per_deg; }

static const void *preset_of(const void *of) { return ((const RadarFrame *)of)->preset; }
static const void *scan_of(const void *of) { return ((const RadarFrame *)of)->scan; }

static json_t *preset_name(const void *of, const void *record)
{
    const RadarFrame *r = of;
    (void)record;
    return json_string(r->preset->name);
}

static json_t *waveform_kind(const void *of, const void *record)
{
    const RadarFrame *r = of;
    (void)record;
    return json_string(waveform_name[r->preset->wave.kind]);
}

static json_t *cell_noise(const void *of, const void *record)
{
    const RadarFrame *r = of;
    (void)record;
    return field_number(field_db(r->receiver.noise_w * r->map.noise_share));
}

static const void *next_detection(FieldItem *item, const void *of, int i, const void *record)
{
    const RadarFrame *r = of;
    (void)item, (void)record;
    return i < r->detections ? &r->detection[i] : NULL;
}

static const void *next_truth(FieldItem *item, const void *of, int i, const void *record)
{
    const RadarFrame *r = of;
    (void)item, (void)record;
    return i < r->targets ? &r->target[i] : NULL;
}

/* ---- of an entity -------------------------------------------------------------------------------- */

static const SnapshotEntity *entity_of(const RadarTruth *t, const FrameRecord *record)
{
    return &record->snapshot->entity[t->entity];
}

static json_t *entity_id(const void *of, const void *record) { return field_id(entity_of(of, record)->id); }

static json_t *signature(const void *of, const void *record)
{
    const RadarTruth *t = of;
    (void)record;
    return json_string(t->given ? "given" : "model");
}

/* NULL: by a signature of radar.given. */
static const void *by_model(const void *of)
{
    const RadarTruth *t = of;
    return t->given ? NULL : t;
}

static const void *bounce_of(const void *of)
{
    const RadarTruth *t = of;
    return t->bounce.coherence > 0 ? &t->bounce : NULL;
}

typedef struct Strongest {
    RadarScatterer centre;
    const char    *part; /* name; NULL: of a given signature */
} Strongest;
_Static_assert(sizeof(Strongest) <= sizeof((FieldItem){0}).room, "it has no room");

static const void *next_strongest(FieldItem *item, const void *of, int i, const void *record)
{
    const RadarTruth *t = of;
    if (i >= t->strongest_count) return NULL;
    const FrameRecord *r = record;
    const Model       *model = catalog_model(r->catalog, entity_of(t, r)->model);
    const int          part = t->strongest[i].part;
    Strongest         *out = (Strongest *)item->room;
    *out = (Strongest){t->strongest[i], part >= 0 && part < model->part_count ? model->part[part].name : NULL};
    return out;
}

/* ---- the fields ---------------------------------------------------------------------------------- */

static const Field waveform_rows[] = {
    {"kind", "string", "", "", "", "lfm, stepped, pulse_doppler or fmcw", .get = waveform_kind},
    {"pulse_us", "number", "us", "", "", "length of a pulse; of fmcw of a sweep", .at = preset_of,
     FIELD_MEMBER(RadarPreset, wave.pulse_s), .as = field_micro},
    {"sample_us", "number", "us", "", "", "from one frequency of a profile to the next; 0: at once",
     FIELD_MEMBER(RadarFrame, timing.sample_s), .as = field_micro},
    {"profile_ms", "number", "ms", "", "", "over which a range profile is taken",
     FIELD_MEMBER(RadarFrame, timing.profile_s), .as = field_milli},
    {"row_ms", "number", "ms", "", "", "from one profile to the next", FIELD_MEMBER(RadarFrame, timing.row_s),
     .as = field_milli},
    {"interval_ms", "number", "ms", "", "", "coherent interval, about the frame's time",
     FIELD_MEMBER(RadarFrame, timing.interval_s), .as = field_milli},
    {"window_m", "number", "m", "", "", "width of the range window", FIELD_MEMBER(RadarFrame, timing.window_m)},
    {"unambiguous_m", "number", "m", "", "", "range by which echoes fold over",
     FIELD_MEMBER(RadarFrame, timing.unambiguous_m)},
    {"blind_mps", "number", "m/s", "", "",
     "range rates apart by it look alike; its multiples from the ground are blind speeds",
     FIELD_MEMBER(RadarFrame, timing.blind_mps)},
    {"coupling_s", "number", "s", "", "", "an echo appears farther by it times its range rate over the reference's",
     FIELD_MEMBER(RadarFrame, timing.coupling_s)},
    {"smear_s", "number", "s", "", "", "and is smeared in range over it times the same rate",
     FIELD_MEMBER(RadarFrame, timing.smear_s)},
    {"beat_hz_m", "number", "Hz/m", "", "", "beat frequency of lfm, deramped, and fmcw; else 0",
     FIELD_MEMBER(RadarFrame, timing.beat_hz_m)},
};
static const FieldTable waveform_fields = FIELD_TABLE(waveform_rows);

static const Field scan_rows[] = {
    {"positions", "integer", "", "", "", "of the beam, an odd number; the middle one is the frame's interval",
     FIELD_MEMBER(RadarSector, plan.positions)},
    {"step_deg", "number", "deg", "", "", "between positions, left to right, about the camera's rows axis",
     FIELD_MEMBER(RadarSector, plan.step_rad), .as = field_deg},
    {"interval_s", "number", "s", "", "", "from one position to the next", FIELD_MEMBER(RadarSector, plan.interval_s)},
    {"beam_deg", "number", "deg", "", "", "width of the two-way beam at half power",
     FIELD_MEMBER(RadarSector, beam_rad), .as = field_deg},
    {"noise_dbw", "number", "dB over 1 W", "", "", "thermal noise in a cell of the real-beam image",
     FIELD_MEMBER(RadarSector, noise_w), .as = field_db, FIELD_WITHIN(0.01, 0)},
    {"sharpened_share", "number", "", "0 .. 1", "",
     "of the sharpened image's cells where Doppler is finer than the beam", FIELD_MEMBER(RadarSector, sharpened_share)},
    {"sha256", "string", "", "", "",
     "SHA-256 of both images over range and azimuth, before they are rounded for a file", .get = scan_hash},
};
static const FieldTable scan_fields = FIELD_TABLE(scan_rows);

static const Field detection_rows[] = {
    {"range_m", "number", "m", "from the sensor", "", "between cells", FIELD_MEMBER(Detection, range_m),
     FIELD_WITHIN(1e-3, 1e-6)},
    {"range_rate_mps", "number", "m/s", "above 0: receding", "", "between cells; folds over at half of the map",
     FIELD_MEMBER(Detection, range_rate_mps), FIELD_WITHIN(0.01, 1e-5)},
    {"az_deg", "number", "deg", "camera, right positive", "", "by monopulse", FIELD_MEMBER(Detection, cos_right),
     .as = azimuth, FIELD_WITHIN(0.005, 0)},
    {"el_deg", "number", "deg", "camera, up positive", "", "by monopulse", FIELD_MEMBER(Detection, cos_down),
     .as = elevation, FIELD_WITHIN(0.005, 0)},
    {"snr_db", "number", "dB", "", "", "over the noise and clutter about it", FIELD_MEMBER(Detection, snr),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"rcs_dbsm", "number", "dB over 1 m2", "", "", "by the radar equation, as one point where it was found",
     FIELD_MEMBER(Detection, rcs_m2), .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"moving", "boolean", "", "", "", "clear of the ground's range rate by more than notch_mps",
     FIELD_MEMBER(Detection, moving)},
};
static const FieldTable detection_fields = FIELD_TABLE(detection_rows);

static const Field rcs_rows[] = {
    {"hh", "number", "dB over 1 m2", "received, transmitted", "when it is 0", "h along the camera's columns",
     FIELD_MEMBER(RadarTruth, rcs_m2[0]), .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"vv", "number", "dB over 1 m2", "", "when it is 0", "v along its rows", FIELD_MEMBER(RadarTruth, rcs_m2[1]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"hv", "number", "dB over 1 m2", "", "when it is 0", "received h, transmitted v",
     FIELD_MEMBER(RadarTruth, rcs_m2[2]), .as = field_db, FIELD_WITHIN(0.5, 0)},
};
static const FieldTable rcs_fields = FIELD_TABLE(rcs_rows);

static const Field rcs_error_rows[] = {
    {"hh", "number", "dB", "", "when it scatters nothing back", "of HH", FIELD_MEMBER(RadarTruth, rcs_error_db[0]),
     FIELD_WITHIN(0.1, 0)},
    {"vv", "number", "dB", "", "when it scatters nothing back", "of VV", FIELD_MEMBER(RadarTruth, rcs_error_db[1]),
     FIELD_WITHIN(0.1, 0)},
    {"hv", "number", "dB", "", "when it scatters nothing back", "of HV", FIELD_MEMBER(RadarTruth, rcs_error_db[2]),
     FIELD_WITHIN(0.5, 0)},
};
static const FieldTable rcs_error_fields = FIELD_TABLE(rcs_error_rows);

static const Field bounce_rcs_rows[] = {
    {"hh", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, rcs_m2[0]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"vv", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, rcs_m2[1]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"hv", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, rcs_m2[2]),
     .as = field_db, FIELD_WITHIN(0.5, 0)},
};
static const FieldTable bounce_rcs_fields = FIELD_TABLE(bounce_rcs_rows);

static const Field once_rows[] = {
    {"hh", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, once_m2[0]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"vv", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, once_m2[1]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"hv", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, once_m2[2]),
     .as = field_db, FIELD_WITHIN(0.5, 0)},
};
static const FieldTable once_fields = FIELD_TABLE(once_rows);

static const Field twice_rows[] = {
    {"hh", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, twice_m2[0]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"vv", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, twice_m2[1]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"hv", "number", "dB over 1 m2", "", "when it is 0", "likewise", FIELD_MEMBER(RadarBounceTruth, twice_m2[2]),
     .as = field_db, FIELD_WITHIN(0.5, 0)},
};
static const FieldTable twice_fields = FIELD_TABLE(twice_rows);

static const Field bounce_rows[] = {
    {"coherence", "number", "", "0.001 .. 1", "",
     "share of the amplitude that the ground mirrors, roughness included; the larger of both polarisations",
     FIELD_MEMBER(RadarBounceTruth, coherence)},
    {"rcs_dbsm", "object", "", "", "", "cross section by all paths together, the direct one included",
     .rows = &bounce_rcs_fields},
    {"once_dbsm", "object", "", "", "", "by the ground one way alone, both ways round together", .rows = &once_fields},
    {"twice_dbsm", "object", "", "", "", "by the ground both ways alone", .rows = &twice_fields},
};
static const FieldTable bounce_fields = FIELD_TABLE(bounce_rows);

static const Field strongest_rows[] = {
    {"rcs_hh_dbsm", "number", "dB over 1 m2", "", "when it returns nothing so", "its cross section",
     FIELD_MEMBER(Strongest, centre.hh_m2), .as = field_db},
    {"rcs_vv_dbsm", "number", "dB over 1 m2", "", "when it returns nothing so", "its cross section",
     FIELD_MEMBER(Strongest, centre.vv_m2), .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"body_m", "list of 3 numbers", "m", "body", "", "middle of its path's first and last mirror",
     FIELD_MEMBER(Strongest, centre.p_body), FIELD_WITHIN(0.01, 0)},
    {"bounces", "integer", "", "0: an edge", "", "mirrors on its path", FIELD_MEMBER(Strongest, centre.bounce),
     FIELD_EXACT},
    {"visible", "boolean", "", "", "", "nothing else is in its way", FIELD_MEMBER(Strongest, centre.seen)},
    {"part", "string", "", "", "of a given signature", "part of the model with the last mirror",
     FIELD_MEMBER(Strongest, part), FIELD_EXACT},
};
static const FieldTable strongest_fields = FIELD_TABLE(strongest_rows);

static const Field truth_rows[] = {
    {"entity", "string", "", "site:application:entity", "", "id", .get = entity_id, FIELD_EXACT},
    {"signature", "string", "", "model, given", "", "by its model, or by a signature of radar.given", .get = signature},
    {"range_m", "number", "m", "from the sensor", "", "to the origin of its model", FIELD_MEMBER(RadarTruth, range_m),
     FIELD_WITHIN(1e-3, 1e-6)},
    {"range_rate_mps", "number", "m/s", "above 0: receding", "", "of that origin",
     FIELD_MEMBER(RadarTruth, range_rate_mps), FIELD_WITHIN(0.01, 1e-5)},
    {"appears_m", "number", "m", "from the sensor", "",
     "range at which the profile has that origin: folded over, and coupled to its range rate",
     FIELD_MEMBER(RadarTruth, appears_m)},
    {"az_deg", "number", "deg", "camera, right positive", "", "direction of that origin",
     FIELD_MEMBER(RadarTruth, cos_right), .as = azimuth, FIELD_WITHIN(0.005, 0)},
    {"el_deg", "number", "deg", "camera, up positive", "", "likewise", FIELD_MEMBER(RadarTruth, cos_down),
     .as = elevation, FIELD_WITHIN(0.005, 0)},
    {"visible_fraction", "number", "", "0 .. 1", "",
     "share of its scattering centres' power in sight: those centres alone return", FIELD_MEMBER(RadarTruth, visible),
     FIELD_WITHIN(0.005, 0)},
    {"rcs_dbsm", "object", "", "", "",
     "cross section at the centre frequency, as if wholly in sight, without the ground", .rows = &rcs_fields},
    {"rcs_error_db", "object", "", "", "of a given signature",
     "estimated standard deviation of these, by the grid of ray tubes alone: not by the model or physical optics",
     .at = by_model, .rows = &rcs_error_fields},
    {"map_error_db", "number", "dB", "", "of a given signature",
     "error of its cells of the map, over its power in them: by ray tubes and by scattering centres",
     FIELD_MEMBER(RadarTruth, map_error), .as = field_db},
    {"snr_db", "number", "dB", "", "when none of it is in sight",
     "by the radar equation, of its centres in sight in one cell, over the thermal noise of a cell",
     FIELD_MEMBER(RadarTruth, snr), .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"centres", "integer", "", "", "", "scattering centres that it was summed from", FIELD_MEMBER(RadarTruth, centres),
     FIELD_WITHIN(0, 0.01)},
    {"ground_bounce", "object", "", "", "where the ground near it mirrors too little, or out of sight",
     "what the ground near it mirrors; as if wholly in sight", .at = bounce_of, .rows = &bounce_fields},
    {"strongest", "list of objects", "", "strongest first, at most 8", "",
     "the strongest of them, by the mean of HH and VV", .item = next_strongest, .rows = &strongest_fields},
};
static const FieldTable truth_fields = FIELD_TABLE(truth_rows);

static const Field radar_rows[] = {
    {"preset", "string", "", "", "", "row of etc/radars.csv or radar.table", .get = preset_name, FIELD_EXACT},
    {"waveform", "object", "", "", "", "its times, and what they limit (etc/reference/radar_waveforms.md)",
     .rows = &waveform_fields},
    {"reference_m", "number", "m", "from the sensor", "", "middle of the range window: the aim, else the ground ahead",
     FIELD_MEMBER(RadarFrame, reference_m), FIELD_WITHIN(1e-3, 1e-6)},
    {"reference_rate_mps", "number", "m/s", "above 0: receding", "", "range rate in the middle of the map",
     FIELD_MEMBER(RadarFrame, reference_rate_mps), FIELD_WITHIN(1e-3, 1e-6)},
    {"ground_rate_mps", "number", "m/s", "above 0: receding", "", "of still ground on the axis",
     FIELD_MEMBER(RadarFrame, ground_rate_mps)},
    {"notch_mps", "number", "m/s", "", "",
     "detections so near to the ground's range rate in their direction count as ground",
     FIELD_MEMBER(RadarFrame, notch_mps)},
    {"air_db", "number", "dB", "one way", "", "loss by gases, rain and fog over that range",
     FIELD_MEMBER(RadarFrame, air_db), FIELD_WITHIN(1e-3, 1e-3)},
    {"noise_dbw", "number", "dB over 1 W", "", "", "thermal noise in a cell of the map", .get = cell_noise,
     FIELD_WITHIN(0.01, 0)},
    {"saturated", "integer", "", "", "", "I and Q values at the end of the converter's range",
     FIELD_MEMBER(RadarFrame, receiver.saturated), FIELD_EXACT},
    {"ground_cells", "integer", "", "", "", "scatterers of the ground within main lobe and window",
     FIELD_MEMBER(RadarFrame, ground_cells), FIELD_WITHIN(0, 0.001)},
    {"plants", "integer", "", "", "", "plants within main lobe and window, which return from their crowns",
     FIELD_MEMBER(RadarFrame, crowns)},
    {"chaff", "integer", "", "", "", "clouds of chaff within beam and window", FIELD_MEMBER(RadarFrame, clouds)},
    {"rain_1_m", "number", "m2/m3", "", "", "backscatter of the rain by its volume; 0: none falls",
     FIELD_MEMBER(RadarFrame, rain_1_m)},
    {"ground_hidden", "integer", "", "", "", "of ground_cells, hidden by relief or entities",
     FIELD_MEMBER(RadarFrame, ground_hidden), FIELD_WITHIN(0, 0.01)},
    {"map_sha256", "string", "", "", "", "SHA-256 of the map of all channels, before it is rounded for a file",
     .get = map_hash, .channel = FIELD_APART},
    {"scan", "object", "", "", "with radar.scan_deg 0", "how the beam scanned", .at = scan_of, .rows = &scan_fields},
    {"detections", "list of objects", "", "strongest first, at most 256", "",
     "peaks over the threshold of constant false alarms", .item = next_detection, .rows = &detection_fields},
    {"detections_in_all", "integer", "", "", "", "how many passed the threshold",
     FIELD_MEMBER(RadarFrame, detections_in_all), FIELD_EXACT},
    {"targets", "list of objects", "", "", "", "truth of each entity near beam and window, in order of ids",
     .item = next_truth, .rows = &truth_fields},
};
const FieldTable radar_fields = FIELD_TABLE(radar_rows);
