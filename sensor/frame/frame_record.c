/* sensor/frame/frame_record.c: truth.jsonl, a line per frame: its fields, and how it is written. */
#include "sensor/frame/records.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"

#include <errno.h>
#include <stdlib.h>

/* ---- the host and its sensor --------------------------------------------------------------------- */

/* NaN: not known. */
typedef struct Host {
    const SnapshotEntity *entity; /* NULL: an observer */
    double                p_ecef[3], psi_rad, theta_rad, phi_rad, speed_mps;
    Geodetic              place;
} Host;
_Static_assert(sizeof(Host) <= sizeof((FieldItem){0}).room, "it has no room");

static const void *the_host(FieldItem *item, const void *of, int i, const void *record)
{
    const FrameRecord *r = of;
    Host              *host = (Host *)item->room;
    (void)i, (void)record;
    *host = (Host){.entity = r->host, .speed_mps = v3_length(r->host ? r->host->v_ecef_mps : r->v_eye_mps)};
    memcpy(host->p_ecef, r->p_eye_ecef, sizeof host->p_ecef);
    if (geodetic_from_ecef(&host->place, r->p_eye_ecef) != STATUS_OK) host->place = (Geodetic){NAN, NAN, NAN};
    euler_from_r_ecef_from_body(&host->psi_rad, &host->theta_rad, &host->phi_rad, r->r_ecef_from_body);
    return host;
}

static const void *entity_of(const void *of) { return ((const Host *)of)->entity; }

static json_t *host_id(const void *of, const void *record)
{
    const Host *host = of;
    (void)record;
    return host->entity ? field_id(host->entity->id) : json_string("observer");
}

static const void *sun_of(const void *of) { return ((const FrameRecord *)of)->sun; }
static const void *view_of(const void *of) { return &((const FrameRecord *)of)->request->view; }

static const void *the_sensor(FieldItem *item, const void *of, int i, const void *record)
{
    (void)item, (void)record;
    return i == 0 ? of : NULL;
}

static json_t *sensor_name(const void *of, const void *record)
{
    (void)of, (void)record;
    return json_string("seeker");
}

static json_t *bands_rendered(const void *of, const void *record)
{
    const FrameRecord *r = of;
    json_t            *bands = json_array();
    (void)record;
    for (int b = 0; b < BAND_COUNT; b++)
        if (r->request->bands >> b & 1) json_array_append_new(bands, json_string(band_name((Band)b)));
    return bands;
}

static json_t *vertical_view(const void *of, const void *record)
{
    const View *view = view_of(of);
    (void)record;
    return field_number(2 * atan(0.5 * view->height / view->focal_px) / rad_per_deg);
}

static json_t *distortion(const void *of, const void *record)
{
    const View *view = view_of(of);
    const Lens *l = &view->lens;
    (void)record;
    return view_has_lens(view) ? json_number_list((const double[]){l->k[0], l->k[1], l->p[0], l->p[1], l->k[2]}, 5)
                               : NULL;
}

/* NULL: it has no lateral colour. */
static const void *lateral_of(const void *of)
{
    const RenderRequest *request = ((const FrameRecord *)of)->request;
    return request->lateral[0] != 0 || request->lateral[1] != 0 ? request : NULL;
}

static const void *next_target(FieldItem *item, const void *of, int i, const void *record)
{
    const FrameRecord *r = of;
    (void)item, (void)record;
    return i < r->target_count ? &r->target[i] : NULL;
}

/* ---- its error ----------------------------------------------------------------------------------- */

/* rms over the image as a share of the band's mean, and in kelvin about that mean. The mean of the pseudo-radar is that
 * of a few mirrors, and no measure. */
typedef struct BandError {
    double share[error_sources], kelvin[error_sources], median_k, beyond_1k;
} BandError;
_Static_assert(sizeof(BandError) <= sizeof((FieldItem){0}).room, "it has no room");

static const void *error_of_band(FieldItem *item, const void *of, int i, const void *record)
{
    const FrameError *e = ((const FrameRecord *)of)->error;
    BandError        *out = (BandError *)item->room;
    (void)record;
    if (!e || i == BAND_RADAR) return NULL;
    snprintf(item->key, sizeof item->key, "%s", band_name((Band)i));
    *out = (BandError){.median_k = e->median_k[i], .beyond_1k = e->beyond_1k[i]};
    memcpy(out->share, e->share[i], sizeof out->share);
    memcpy(out->kelvin, e->kelvin[i], sizeof out->kelvin);
    return out;
}

static const void *errors_of(const void *of)
{
    const FrameRecord *r = of;
    return r->error || r->radar_error ? r : NULL;
}

static const void *radar_error_of(const void *of) { return ((const FrameRecord *)of)->radar_error; }
static const void *radar_of(const void *of) { return ((const FrameRecord *)of)->radar; }

static const void *next_consumer(FieldItem *item, const void *of, int i, const void *record)
{
    const LatencyLine *l = of;
    (void)record;
    if (i == l->consumers) return NULL;
    snprintf(item->key, sizeof item->key, "%s", l->name[i]);
    return &l->done_ms[i];
}

/* ---- the fields ---------------------------------------------------------------------------------- */

static const Field host_rows[] = {
    {"entity", "string", "", "site:application:entity", "", "id, or `observer`: a sensor position that is no entity",
     .get = host_id, FIELD_EXACT},
    {"marking", "string", "", "", "when the host is an observer", "its marking, at most 11 characters", .at = entity_of,
     FIELD_MEMBER(SnapshotEntity, marking), FIELD_EXACT},
    {"ecef_m", "list of 3 numbers", "m", "ecef", "", "position of the sensor", FIELD_MEMBER(Host, p_ecef),
     FIELD_WITHIN(1e-3, 0)},
    {"lat_deg", "number", "deg", "WGS 84, geodetic", "", "latitude of the sensor, north positive",
     FIELD_MEMBER(Host, place.lat_rad), .as = field_deg, FIELD_WITHIN(1e-8, 0)},
    {"lon_deg", "number", "deg", "WGS 84", "", "longitude of the sensor, east positive",
     FIELD_MEMBER(Host, place.lon_rad), .as = field_deg, FIELD_WITHIN(1e-8, 0)},
    {"height_m", "number", "m", "above the WGS 84 ellipsoid", "", "height of the sensor", FIELD_MEMBER(Host, place.h_m),
     FIELD_WITHIN(1e-3, 0)},
    {"psi_deg", "number", "deg", "ecef to body, as in an Entity State", "",
     "first Euler angle of the host's body, about z; of an observer: of the camera", FIELD_MEMBER(Host, psi_rad),
     .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"theta_deg", "number", "deg", "ecef to body", "", "second Euler angle, about y", FIELD_MEMBER(Host, theta_rad),
     .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"phi_deg", "number", "deg", "ecef to body", "", "third Euler angle, about x", FIELD_MEMBER(Host, phi_rad),
     .as = field_deg, FIELD_WITHIN(1e-4, 0)},
    {"speed_mps", "number", "m/s", "relative to the rotating Earth", "", "speed of the host",
     FIELD_MEMBER(Host, speed_mps), FIELD_WITHIN(1e-3, 0)},
};
static const FieldTable host_fields = FIELD_TABLE(host_rows);

static const Field sun_rows[] = {
    {"azimuth_deg", "number", "deg", "ENU at the sensor, from north over east", "", "0 .. 360",
     FIELD_MEMBER(Sun, azimuth_rad), .as = field_deg, FIELD_WITHIN(0.005, 0)},
    {"elevation_deg", "number", "deg", "ENU at the sensor", "", "above the horizontal, with refraction",
     FIELD_MEMBER(Sun, elevation_rad), .as = field_deg, FIELD_WITHIN(0.005, 0)},
};
static const FieldTable sun_fields = FIELD_TABLE(sun_rows);

static const Field sensor_rows[] = {
    {"name", "string", "", "", "", "`seeker`", .get = sensor_name, FIELD_EXACT},
    {"bands", "list of strings", "", "", "", "which of optical, mwir, lwir, radar were rendered", .get = bands_rendered,
     FIELD_EXACT},
    {"width_px", "integer", "px", "", "", "columns", .at = view_of, FIELD_MEMBER(View, width), FIELD_EXACT},
    {"height_px", "integer", "px", "", "", "rows", .at = view_of, FIELD_MEMBER(View, height), FIELD_EXACT},
    {"hfov_deg", "number", "deg", "", "", "horizontal field of view", FIELD_MEMBER(FrameRecord, hfov_rad),
     .as = field_deg, FIELD_WITHIN(1e-6, 0)},
    {"vfov_deg", "number", "deg", "", "", "vertical field of view", .get = vertical_view, FIELD_WITHIN(1e-6, 0)},
    {"distortion", "list of 5 numbers", "", "k1, k2, p1, p2, k3 as OpenCV has them", "without a lens (sensor.lens_*)",
     "Brown-Conrady coefficients of tangents of angles; boxes and masks follow", .get = distortion},
    {"lateral_colour", "list of 2 numbers", "", "red, blue", "without (sensor.lateral_*)",
     "magnification relative to green, minus 1", .at = lateral_of, FIELD_MEMBER(RenderRequest, lateral)},
    {"ecef_from_cam", "list of 9 numbers", "", "row by row; its columns are the camera's x, y, z in ecef", "",
     "rotation: ecef = R camera", FIELD_MEMBER(FrameRecord, r_ecef_from_cam), FIELD_WITHIN(2e-6, 0)},
    {"gimbal_at_limit", "boolean", "", "", "", "the aim point is beyond sensor.gimbal_limit_deg",
     FIELD_MEMBER(FrameRecord, gimbal_at_limit), FIELD_EXACT},
    {"scene_rate_px_s", "list of 2 numbers", "px/s", "image: column, row", "",
     "image motion of a stationary object at the image centre", FIELD_MEMBER(FrameRecord, scene_rate_px_s),
     FIELD_WITHIN(0.01, 1e-5), .channel = FIELD_TARGETS},
};
static const FieldTable sensor_fields = FIELD_TABLE(sensor_rows);

static const Field band_error_rows[] = {
    {"sampling", "number", "", "share of the band's mean", "", "finite number of rays per pixel",
     FIELD_MEMBER(BandError, share[ERROR_SAMPLING]), FIELD_WITHIN(1e-3, 0.05)},
    {"sampling_k", "number", "K, apparent", "", "in optical", "the same in temperature",
     FIELD_MEMBER(BandError, kelvin[ERROR_SAMPLING]), FIELD_WITHIN(0.05, 0.05)},
    {"level_of_detail", "number", "", "share of the band's mean", "", "level of detail of ground and models",
     FIELD_MEMBER(BandError, share[ERROR_LEVEL_OF_DETAIL]), FIELD_WITHIN(1e-3, 0.05)},
    {"level_of_detail_k", "number", "K, apparent", "", "in optical", "the same in temperature",
     FIELD_MEMBER(BandError, kelvin[ERROR_LEVEL_OF_DETAIL]), FIELD_WITHIN(0.05, 0.05)},
    {"table", "number", "", "share of the band's mean", "",
     "interpolation in tables of the atmosphere and Planck's law", FIELD_MEMBER(BandError, share[ERROR_TABLES]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"table_k", "number", "K, apparent", "", "in optical", "the same in temperature",
     FIELD_MEMBER(BandError, kelvin[ERROR_TABLES]), FIELD_WITHIN(0.05, 0.05)},
    {"heat", "number", "", "share of the band's mean", "",
     "steps, elements and facets of the heat of ground and parts; 0 in optical",
     FIELD_MEMBER(BandError, share[ERROR_HEAT]), FIELD_WITHIN(1e-3, 0.05)},
    {"heat_k", "number", "K, apparent", "", "in optical", "the same in temperature",
     FIELD_MEMBER(BandError, kelvin[ERROR_HEAT]), FIELD_WITHIN(0.05, 0.05)},
    {"dead_reckoning", "number", "", "share of the band's mean", "", "position errors of dead-reckoned entities",
     FIELD_MEMBER(BandError, share[ERROR_DEAD_RECKONING]), FIELD_WITHIN(1e-3, 0.05)},
    {"dead_reckoning_k", "number", "K, apparent", "", "in optical", "the same in temperature",
     FIELD_MEMBER(BandError, kelvin[ERROR_DEAD_RECKONING]), FIELD_WITHIN(0.05, 0.05)},
    {"total", "number", "", "share of the band's mean", "", "total of these",
     FIELD_MEMBER(BandError, share[ERROR_TOTAL]), FIELD_WITHIN(1e-3, 0.05)},
    {"total_k", "number", "K, apparent", "", "in optical", "the same in temperature",
     FIELD_MEMBER(BandError, kelvin[ERROR_TOTAL]), FIELD_WITHIN(0.05, 0.05)},
    {"median_k", "number", "K, apparent", "", "in optical",
     "median of the pixels' expected errors: half of them are better", FIELD_MEMBER(BandError, median_k),
     FIELD_WITHIN(0.05, 0.05), .newer = true},
    {"beyond_1k", "number", "share of the image", "0 .. 1", "in optical",
     "pixels that are expected to be off by more than 1 K", FIELD_MEMBER(BandError, beyond_1k),
     FIELD_WITHIN(0.01, 0.05), .newer = true},
};
static const FieldTable band_error_fields = FIELD_TABLE(band_error_rows);

static const Field radar_error_rows[] = {
    {"sampling", "number", "", "share of the cells' rms", "", "grid of ray tubes on entities",
     FIELD_MEMBER(RadarError, share[ERROR_SAMPLING]), FIELD_WITHIN(1e-3, 0.05)},
    {"sampling_db", "number", "dB", "", "without an entity in sight, or of given signatures alone",
     "the same of an entity's cross section, and of a detection's: one standard deviation",
     FIELD_MEMBER(RadarError, db[ERROR_SAMPLING])},
    {"level_of_detail", "number", "", "share of the cells' rms", "",
     "scattering centres in place of what the tubes hit", FIELD_MEMBER(RadarError, share[ERROR_LEVEL_OF_DETAIL]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"level_of_detail_db", "number", "dB", "", "likewise", "likewise",
     FIELD_MEMBER(RadarError, db[ERROR_LEVEL_OF_DETAIL])},
    {"table", "number", "", "share of the cells' rms", "", "gridding of echoes over delay and Doppler",
     FIELD_MEMBER(RadarError, share[ERROR_TABLES]), FIELD_WITHIN(1e-3, 0.05)},
    {"table_db", "number", "dB", "", "likewise", "likewise", FIELD_MEMBER(RadarError, db[ERROR_TABLES])},
    {"dead_reckoning", "number", "", "share of the cells' rms", "",
     "position errors of dead-reckoned entities along the line of sight: of the cells' magnitudes",
     FIELD_MEMBER(RadarError, share[ERROR_DEAD_RECKONING]), FIELD_WITHIN(1e-3, 0.05)},
    {"total", "number", "", "share of the cells' rms", "", "total of these",
     FIELD_MEMBER(RadarError, share[ERROR_TOTAL]), FIELD_WITHIN(1e-3, 0.05)},
    {"total_db", "number", "dB", "", "likewise", "likewise, of these three", FIELD_MEMBER(RadarError, db[ERROR_TOTAL])},
};
static const FieldTable radar_error_fields = FIELD_TABLE(radar_error_rows);

static const Field error_rows[] = {
    {"BAND", "object", "", "",
     "when the band was not rendered; of the pseudo-radar, whose mean is that of a few mirrors",
     "rms over the image: that of the brightest pixels, if these may be off", .item = error_of_band,
     .unless_empty = true, .rows = &band_error_fields},
    {"range_doppler", "object", "", "", "with radar.preset none",
     "the same of the radar's map, rms over the cells of its sum channel", .at = radar_error_of, .unless_empty = true,
     .rows = &radar_error_fields},
};
static const FieldTable error_fields = FIELD_TABLE(error_rows);

static const Field consumer_rows[] = {
    {"CONSUMER", "number", "ms", "after the end of rendering",
     "when it was not given the frame, or not done two frames later", "the consumer was done with the frame",
     .item = next_consumer, .kind = FIELD_OF_DOUBLE, .as = field_ms},
};
static const FieldTable consumer_fields = FIELD_TABLE(consumer_rows);

static const Field latency_rows[] = {
    {"arrival_to_pose", "number", "ms", "", "before the first datagram",
     "from the arrival of the newest datagram that the frame used until the sensor's pose was sampled",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_ARRIVAL_TO_POSE]), .as = field_ms},
    {"pose_to_render", "number", "ms", "", "", "from then until rendering began",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_POSE_TO_RENDER]), .as = field_ms},
    {"render", "number", "ms", "", "", "rendering, with the truth of targets where it is requested",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_RENDER]), .as = field_ms},
    {"display", "number", "ms", "after the end of rendering",
     "when no consumer takes displays, or not done two frames later", "displays made: the detector, gain and level",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_DISPLAY]), .as = field_ms},
    {"consumers", "object", "", "", "", "by consumer of the frame", .rows = &consumer_fields},
};
static const FieldTable latency_fields = FIELD_TABLE(latency_rows);

static const Field record_frame_rows[] = {
    {"frame", "integer", "", "from 0", "", "number of the frame, as in the names of its files",
     FIELD_MEMBER(FrameRecord, frame), FIELD_EXACT},
    {"time_s", "number", "s", "exercise time", "", "instant of the frame", FIELD_MEMBER(FrameRecord, time_s),
     FIELD_WITHIN(1e-6, 0), .channel = FIELD_TIME},
    {"frame_sha256", "string", "", "", "when hashes are not requested", "SHA-256 of all planes before they are encoded",
     FIELD_MEMBER(FrameRecord, frame_sha256), .channel = FIELD_APART},
    {"host", "object", "", "", "", "the entity that carries the sensor", .item = the_host, .rows = &host_fields},
    {"sun", "object", "", "", "", "direction of the sun", .at = sun_of, .rows = &sun_fields, .channel = FIELD_SUN},
    {"sensors", "list of objects", "", "from 0", "", "one: all bands share the optics and the instant",
     .item = the_sensor, .rows = &sensor_fields},
    {"targets", "list of objects", "", "in the order of the frame's entity table", "",
     "every entity in the field of view except the host, occluded ones too", .item = next_target,
     .rows = &target_fields, .channel = FIELD_MOTION},
    {"error", "object", "", "", "with quality.budget off", "the frame's estimate of its own error", .at = errors_of,
     .rows = &error_fields, .channel = FIELD_ERROR},
    {"radar", "object", "", "", "with radar.preset none",
     "what the radar on the sensor's axis measured, and the truth of it", .at = radar_of, .rows = &radar_fields,
     .channel = FIELD_RADAR},
    {"latency_ms", "object", "", "", "in a replay at full speed",
     "when each step of the frame was done; of a run and of replay --speed X", .elsewhere = true,
     .rows = &latency_fields},
};
const FieldTable record_frame_fields = FIELD_TABLE(record_frame_rows);

/* ---- writing ------------------------------------------------------------------------------------- */

static char *text_of(json_t *object, size_t digits)
{
    char *text = json_dumps(object, JSON_COMPACT | JSON_REAL_PRECISION(digits));
    json_decref(object);
    return text;
}

char *record_frame_text(const FrameRecord *r) { return text_of(field_object(&record_frame_fields, r), 15); }

Status record_write_text(FILE *file, const char *text, const LatencyLine *latency)
{
    char *more = latency ? text_of(field_object(&latency_fields, latency), 9) : NULL;
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
