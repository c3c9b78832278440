/* sensor/frame/radar_record.c: the fields of what the radar measured in a frame: the object radar of truth.jsonl. */
#include "sensor/frame/radar_record.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"
#include "sensor/frame/records.h"

#include <inttypes.h>
#include <stdio.h>

/* ---- hashes -------------------------------------------------------------------------------------- */

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

static json_t *map_hash(FieldAt *at)
{
    char hash[sha256_text_size];
    return radar_sha256(hash, at->of, 0, 1) == STATUS_OK ? json_string(hash) : NULL;
}

/* Of its pictures, before anything is rounded for a file. */
static json_t *scan_hash(FieldAt *at)
{
    char hash[sha256_text_size];
    return radar_sha256(hash, ((const FrameRecord *)at->record)->radar, 1, 2) == STATUS_OK ? json_string(hash) : NULL;
}

/* ---- values that are no plain member ------------------------------------------------------------- */

/* Cosines along the sensor's right and down axes in degrees. */
static double azimuth(double cos_right) { return field_deg(asin(clamp(cos_right, -1, 1))); }
static double elevation(double cos_down) { return -field_deg(asin(clamp(cos_down, -1, 1))); }

static const void *preset_of(const void *of) { return ((const RadarFrame *)of)->preset; }
static const void *scan_of(const void *of) { return ((const RadarFrame *)of)->scan; }

static json_t *preset_name(FieldAt *at) { return json_string(((const RadarFrame *)at->of)->preset->name); }
static json_t *waveform_kind(FieldAt *at)
{
    return json_string(waveform_name[((const RadarFrame *)at->of)->preset->wave.kind]);
}

static json_t *cell_noise(FieldAt *at)
{
    const RadarFrame *r = at->of;
    return field_number(field_db(r->receiver.noise_w * r->map.noise_share));
}

static const void *next_detection(FieldAt *at, int i)
{
    const RadarFrame *r = at->of;
    return i < r->detections ? &r->detection[i] : NULL;
}

static const void *next_truth(FieldAt *at, int i)
{
    const RadarFrame *r = at->of;
    return i < r->targets ? &r->target[i] : NULL;
}

/* ---- of an entity -------------------------------------------------------------------------------- */

static const SnapshotEntity *entity_of(const FieldAt *at)
{
    return &((const FrameRecord *)at->record)->snapshot->entity[((const RadarTruth *)at->of)->entity];
}

static json_t *entity_id(FieldAt *at) { return field_id(entity_of(at)->id); }
static json_t *signature(FieldAt *at)
{
    const RadarTruth *t = at->of;
    return json_string(t->given ? "given" : t->coarse ? "coarse" : "model");
}

/* NULL: by a signature of radar.given. */
static const void *by_model(const void *of) { return ((const RadarTruth *)of)->given ? NULL : of; }

static const void *bounce_of(const void *of)
{
    const RadarBounceTruth *bounce = &((const RadarTruth *)of)->bounce;
    return bounce->coherence > 0 ? bounce : NULL;
}

/* Powers by polarisation, as the arrays of RadarBounceTruth have them. */
typedef struct Powers {
    double hh, vv, hv;
} Powers;
static const void *rcs_of(const void *of) { return ((const RadarBounceTruth *)of)->rcs_m2; }
static const void *once_of(const void *of) { return ((const RadarBounceTruth *)of)->once_m2; }
static const void *twice_of(const void *of) { return ((const RadarBounceTruth *)of)->twice_m2; }

typedef struct Strongest {
    RadarScatterer centre;
    const char    *part; /* name; NULL: of a given signature */
} Strongest;
_Static_assert(sizeof(Strongest) <= sizeof((FieldAt){0}).room, "it has no room");

static const void *next_strongest(FieldAt *at, int i)
{
    const RadarTruth *t = at->of;
    if (i >= t->strongest_count) return NULL;
    const Model *model = catalog_model(((const FrameRecord *)at->record)->catalog, entity_of(at)->model);
    const int    part = t->strongest[i].part;
    Strongest   *out = (Strongest *)at->room;
    *out = (Strongest){t->strongest[i], part >= 0 && part < model->part_count ? model->part[part].name : NULL};
    return out;
}

/* ---- the fields ---------------------------------------------------------------------------------- */

#define OF_RADAR(member)     FIELD_MEMBER(RadarFrame, member)
#define OF_SCAN(member)      FIELD_MEMBER(RadarSector, member)
#define OF_DETECTION(member) FIELD_MEMBER(Detection, member)
#define OF_TRUTH(member)     FIELD_MEMBER(RadarTruth, member)
#define OF_POWERS(member)    FIELD_MEMBER(Powers, member)
#define OF_STRONGEST(member) FIELD_MEMBER(Strongest, member)

static const Field waveform_rows[] = {
    {"kind", "", "", "", "lfm, stepped, pulse_doppler or fmcw", FIELD_GET("string", waveform_kind)},
    {"pulse_us", "us", "", "", "length of a pulse; of fmcw of a sweep", FIELD_IN(preset_of, RadarPreset, wave.pulse_s),
     .as = field_micro},
    {"sample_us", "us", "", "", "from one frequency of a profile to the next; 0: at once", OF_RADAR(timing.sample_s),
     .as = field_micro},
    {"profile_ms", "ms", "", "", "over which a range profile is taken", OF_RADAR(timing.profile_s), .as = field_milli},
    {"row_ms", "ms", "", "", "from one profile to the next", OF_RADAR(timing.row_s), .as = field_milli},
    {"interval_ms", "ms", "", "", "coherent interval, about the frame's time", OF_RADAR(timing.interval_s),
     .as = field_milli},
    {"window_m", "m", "", "", "width of the range window", OF_RADAR(timing.window_m)},
    {"unambiguous_m", "m", "", "", "range by which echoes fold over", OF_RADAR(timing.unambiguous_m)},
    {"blind_mps", "m/s", "", "", "range rates apart by it look alike; its multiples from the ground are blind speeds",
     OF_RADAR(timing.blind_mps)},
    {"coupling_s", "s", "", "", "an echo appears farther by it times its range rate over the reference's",
     OF_RADAR(timing.coupling_s)},
    {"smear_s", "s", "", "", "and is smeared in range over it times the same rate", OF_RADAR(timing.smear_s)},
    {"beat_hz_m", "Hz/m", "", "", "beat frequency of lfm, deramped, and fmcw; else 0", OF_RADAR(timing.beat_hz_m)},
};

static const Field scan_rows[] = {
    {"positions", "", "", "", "of the beam, an odd number; the middle one is the frame's interval",
     OF_SCAN(plan.positions)},
    {"step_deg", "deg", "", "", "between positions, left to right, about the camera's rows axis",
     OF_SCAN(plan.step_rad), .as = field_deg},
    {"interval_s", "s", "", "", "from one position to the next", OF_SCAN(plan.interval_s)},
    {"beam_deg", "deg", "", "", "width of the two-way beam at half power", OF_SCAN(beam_rad), .as = field_deg},
    {"noise_dbw", "dB over 1 W", "", "", "thermal noise in a cell of the real-beam image", OF_SCAN(noise_w),
     .as = field_db, FIELD_WITHIN(0.01, 0)},
    {"sharpened_share", "", "0 .. 1", "", "of the sharpened image's cells where Doppler is finer than the beam",
     OF_SCAN(sharpened_share)},
    {"sha256", "", "", "", "SHA-256 of both images over range and azimuth, before they are rounded for a file",
     FIELD_GET("string", scan_hash)},
};

/* NULL: it is not of scenery. */
static const void *scenery_of_detection(const void *of)
{
    const DetectedScenery *on = &((const Detection *)of)->scenery;
    return on->source > 0 ? on : NULL;
}

static json_t *detected_class(FieldAt *at)
{
    const DetectedScenery *on = at->of;
    return json_string(on->class == CLUTTER_NONE ? "building" : scenery_class_name((SceneryClass)on->class));
}

static json_t *detected_id(FieldAt *at)
{
    char id[17];
    snprintf(id, sizeof id, "%016" PRIx64, ((const DetectedScenery *)at->of)->id);
    return json_string(id);
}

#define OF_DETECTED(member) FIELD_MEMBER(DetectedScenery, member)

static const Field detected_rows[] = {
    {"class", "", "", "", "building (all that is built), or a class of clutter[]", FIELD_GET("string", detected_class),
     FIELD_EXACT, .newer = true},
    {"id", "", "16 hexadecimal digits", "", "of its brightest thing: of a thing that of clutter[]",
     FIELD_GET("string", detected_id), FIELD_EXACT, .newer = true},
    {"share", "", "0.5 .. 1", "", "of the detection's power that scenery makes by itself", OF_DETECTED(share),
     FIELD_WITHIN(0.02, 0), .newer = true},
};

/* NULL: there is none about. */
static const void *scenery_of(const void *of)
{
    const RadarSceneryCount *n = &((const RadarFrame *)of)->scenery;
    return n->objects > 0 ? n : NULL;
}

#define OF_SCENERY(member) FIELD_MEMBER(RadarSceneryCount, member)

static const Field scenery_rows[] = {
    {"pieces", "", "", "", "pieces of walls, roofs and other faces in sight", OF_SCENERY(pieces), FIELD_WITHIN(0, 0.01),
     .newer = true},
    {"hidden", "", "", "", "of those that face the radar, out of sight", OF_SCENERY(hidden), FIELD_WITHIN(0, 0.01),
     .newer = true},
    {"by_ground", "", "", "", "pieces of walls that the ground before them mirrors, too", OF_SCENERY(by_ground),
     FIELD_WITHIN(0, 0.01), .newer = true},
    {"things", "", "", "", "vehicles and other clutter of which something is in sight", OF_SCENERY(things), FIELD_EXACT,
     .newer = true},
    {"detections", "", "", "", "of detections[] that are of scenery: false alarms on it", OF_SCENERY(detections),
     FIELD_EXACT, .newer = true},
};

static const Field detection_rows[] = {
    {"range_m", "m", "from the sensor", "", "between cells", OF_DETECTION(range_m), FIELD_WITHIN(1e-3, 1e-6)},
    {"range_rate_mps", "m/s", "above 0: receding", "", "between cells; folds over at half of the map",
     OF_DETECTION(range_rate_mps), FIELD_WITHIN(0.01, 1e-5)},
    {"az_deg", "deg", "camera, right positive", "", "by monopulse", OF_DETECTION(cos_right), .as = azimuth,
     FIELD_WITHIN(0.005, 0)},
    {"el_deg", "deg", "camera, up positive", "", "by monopulse", OF_DETECTION(cos_down), .as = elevation,
     FIELD_WITHIN(0.005, 0)},
    {"snr_db", "dB", "", "", "over the noise and clutter about it", OF_DETECTION(snr), .as = field_db,
     FIELD_WITHIN(0.1, 0)},
    {"rcs_dbsm", "dB over 1 m2", "", "", "by the radar equation, as one point where it was found", OF_DETECTION(rcs_m2),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"moving", "", "", "", "clear of the ground's range rate by more than notch_mps", OF_DETECTION(moving)},
    {"scenery", "", "", "when it is not of buildings or clutter",
     "what of these it is: more than half of its power, and more than entities make", .in = scenery_of_detection,
     FIELD_OBJECT(detected_rows), .newer = true},
};

static const Field rcs_rows[] = {
    {"hh", "dB over 1 m2", "received, transmitted", "when it is 0", "h along the camera's columns", OF_TRUTH(rcs_m2[0]),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"vv", "dB over 1 m2", "", "when it is 0", "v along its rows", OF_TRUTH(rcs_m2[1]), .as = field_db,
     FIELD_WITHIN(0.1, 0)},
    {"hv", "dB over 1 m2", "", "when it is 0", "received h, transmitted v", OF_TRUTH(rcs_m2[2]), .as = field_db,
     FIELD_WITHIN(0.5, 0)},
};

static const Field rcs_error_rows[] = {
    {"hh", "dB", "", "when it scatters nothing back", "of HH", OF_TRUTH(rcs_error_db[0]), FIELD_WITHIN(0.1, 0)},
    {"vv", "dB", "", "when it scatters nothing back", "of VV", OF_TRUTH(rcs_error_db[1]), FIELD_WITHIN(0.1, 0)},
    {"hv", "dB", "", "when it scatters nothing back", "of HV", OF_TRUTH(rcs_error_db[2]), FIELD_WITHIN(0.5, 0)},
};

static const Field mirrored_rows[] = {
    {"hh", "dB over 1 m2", "", "when it is 0", "likewise", OF_POWERS(hh), .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"vv", "dB over 1 m2", "", "when it is 0", "likewise", OF_POWERS(vv), .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"hv", "dB over 1 m2", "", "when it is 0", "likewise", OF_POWERS(hv), .as = field_db, FIELD_WITHIN(0.5, 0)},
};

static const Field bounce_rows[] = {
    {"coherence", "", "0.001 .. 1", "",
     "share of the amplitude that the ground mirrors, roughness included; the larger of both polarisations",
     FIELD_MEMBER(RadarBounceTruth, coherence)},
    {"rcs_dbsm", "", "", "", "cross section by all paths together, the direct one included", .in = rcs_of,
     FIELD_OBJECT(mirrored_rows)},
    {"once_dbsm", "", "", "", "by the ground one way alone, both ways round together", .in = once_of,
     FIELD_OBJECT(mirrored_rows)},
    {"twice_dbsm", "", "", "", "by the ground both ways alone", .in = twice_of, FIELD_OBJECT(mirrored_rows)},
};

static const Field strongest_rows[] = {
    {"rcs_hh_dbsm", "dB over 1 m2", "", "when it returns nothing so", "its cross section", OF_STRONGEST(centre.hh_m2),
     .as = field_db},
    {"rcs_vv_dbsm", "dB over 1 m2", "", "when it returns nothing so", "its cross section", OF_STRONGEST(centre.vv_m2),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"body_m", "m", "body", "", "middle of its path's first and last mirror", OF_STRONGEST(centre.p_body),
     FIELD_WITHIN(0.01, 0)},
    {"bounces", "", "0: an edge", "", "mirrors on its path", OF_STRONGEST(centre.bounce), FIELD_EXACT},
    {"visible", "", "", "", "nothing else is in its way", OF_STRONGEST(centre.seen)},
    {"part", "", "", "of a given signature", "part of the model with the last mirror", OF_STRONGEST(part), FIELD_EXACT},
};

static const Field truth_rows[] = {
    {"entity", "", "site:application:entity", "", "id", FIELD_GET("string", entity_id), FIELD_EXACT},
    {"signature", "", "model, coarse, given", "",
     "by its model, by a coarse signature of that while finer ones are made (live), or by a signature of radar.given",
     FIELD_GET("string", signature)},
    {"range_m", "m", "from the sensor", "", "to the origin of its model", OF_TRUTH(range_m), FIELD_WITHIN(1e-3, 1e-6)},
    {"range_rate_mps", "m/s", "above 0: receding", "", "of that origin", OF_TRUTH(range_rate_mps),
     FIELD_WITHIN(0.01, 1e-5)},
    {"appears_m", "m", "from the sensor", "",
     "range at which the profile has that origin: folded over, and coupled to its range rate", OF_TRUTH(appears_m)},
    {"az_deg", "deg", "camera, right positive", "", "direction of that origin", OF_TRUTH(cos_right), .as = azimuth,
     FIELD_WITHIN(0.005, 0)},
    {"el_deg", "deg", "camera, up positive", "", "likewise", OF_TRUTH(cos_down), .as = elevation,
     FIELD_WITHIN(0.005, 0)},
    {"visible_fraction", "", "0 .. 1", "",
     "share of its scattering centres' power in sight: those centres alone return", OF_TRUTH(visible),
     FIELD_WITHIN(0.005, 0)},
    {"rcs_dbsm", "", "", "", "cross section at the centre frequency, as if wholly in sight, without the ground",
     FIELD_OBJECT(rcs_rows)},
    {"rcs_error_db", "", "", "of a given signature",
     "estimated standard deviation of these, by the grid of ray tubes alone, not by the model or physical optics; of a coarse signature that of its "
     "mean over 0.1 degrees",
     .in = by_model, FIELD_OBJECT(rcs_error_rows)},
    {"map_error_db", "dB", "", "of a given signature",
     "error of its cells of the map, over its power in them: by ray tubes and by scattering centres",
     OF_TRUTH(map_error), .as = field_db},
    {"snr_db", "dB", "", "when none of it is in sight",
     "by the radar equation, of its centres in sight in one cell, over the thermal noise of a cell", OF_TRUTH(snr),
     .as = field_db, FIELD_WITHIN(0.1, 0)},
    {"centres", "", "", "", "scattering centres that it was summed from", OF_TRUTH(centres), FIELD_WITHIN(0, 0.01)},
    {"ground_bounce", "", "", "where the ground near it mirrors too little, or out of sight",
     "what the ground near it mirrors; as if wholly in sight", .in = bounce_of, FIELD_OBJECT(bounce_rows)},
    {"strongest", "", "strongest first, at most 8", "", "the strongest of them, by the mean of HH and VV",
     .item = next_strongest, FIELD_OBJECTS(strongest_rows)},
};

static const Field radar_rows[] = {
    {"preset", "", "", "", "row of etc/radars.csv or radar.table", FIELD_GET("string", preset_name), FIELD_EXACT},
    {"waveform", "", "", "", "its times, and what they limit (etc/reference/radar_waveforms.md)",
     FIELD_OBJECT(waveform_rows)},
    {"reference_m", "m", "from the sensor", "", "middle of the range window: the aim, else the ground ahead",
     OF_RADAR(reference_m), FIELD_WITHIN(1e-3, 1e-6)},
    {"reference_rate_mps", "m/s", "above 0: receding", "", "range rate in the middle of the map",
     OF_RADAR(reference_rate_mps), FIELD_WITHIN(1e-3, 1e-6)},
    {"ground_rate_mps", "m/s", "above 0: receding", "", "of still ground on the axis", OF_RADAR(ground_rate_mps)},
    {"notch_mps", "m/s", "", "", "detections so near to the ground's range rate in their direction count as ground",
     OF_RADAR(notch_mps)},
    {"air_db", "dB", "one way", "", "loss by gases, rain and fog over that range", OF_RADAR(air_db),
     FIELD_WITHIN(1e-3, 1e-3)},
    {"noise_dbw", "dB over 1 W", "", "", "thermal noise in a cell of the map", FIELD_GET("number", cell_noise),
     FIELD_WITHIN(0.01, 0)},
    {"saturated", "", "", "", "I and Q values at the end of the converter's range", OF_RADAR(receiver.saturated),
     FIELD_EXACT},
    {"ground_cells", "", "", "", "scatterers of the ground within main lobe and window", OF_RADAR(ground_cells),
     FIELD_WITHIN(0, 0.001)},
    {"scenery", "", "", "without buildings and clutter about the beam, and with radar.scenery false",
     "their echoes (etc/reference/radar_built.md)", .in = scenery_of, FIELD_OBJECT(scenery_rows), .newer = true},
    {"plants", "", "", "", "plants within main lobe and window, which return from their crowns", OF_RADAR(crowns)},
    {"chaff", "", "", "", "clouds of chaff within beam and window", OF_RADAR(clouds)},
    {"rain_1_m", "m2/m3", "", "", "backscatter of the rain by its volume; 0: none falls", OF_RADAR(rain_1_m)},
    {"ground_hidden", "", "", "", "of ground_cells, hidden by relief or entities", OF_RADAR(ground_hidden),
     FIELD_WITHIN(0, 0.01)},
    {"map_sha256", "", "", "", "SHA-256 of the map of all channels, before it is rounded for a file",
     FIELD_GET("string", map_hash), .channel = FIELD_APART},
    {"scan", "", "", "with radar.scan_deg 0", "how the beam scanned", .in = scan_of, FIELD_OBJECT(scan_rows)},
    {"detections", "", "strongest first, at most 256", "", "peaks over the threshold of constant false alarms",
     .item = next_detection, FIELD_OBJECTS(detection_rows)},
    {"detections_in_all", "", "", "", "how many passed the threshold", OF_RADAR(detections_in_all), FIELD_EXACT},
    {"targets", "", "", "", "truth of each entity near beam and window, in order of ids", .item = next_truth,
     FIELD_OBJECTS(truth_rows)},
};
const FieldTable radar_fields = {radar_rows, sizeof radar_rows / sizeof *radar_rows};
