/* sensor/frame/frame_record.c: truth.jsonl, a line per frame: its fields, and how it is written. */
#include "sensor/frame/records.h"

#include "sensor/frame/json_object.h"
#include "sensor/frame/record_fields.h"

#include <errno.h>
#include <stdlib.h>

/* ---- the host and its sensor --------------------------------------------------------------------- */

/* NaN: not known. */
typedef struct Host {
    const SnapshotEntity *entity; /* NULL: an observer, or flown */
    DisEntityId           flown;  /* a missile in the loop; 0:0:0: none */
    double                p_ecef[3], psi_rad, theta_rad, phi_rad, speed_mps;
    Geodetic              place;
} Host;
_Static_assert(sizeof(Host) <= sizeof((FieldAt){0}).room, "it has no room");

static const void *the_host(FieldAt *at, int i)
{
    const FrameRecord *r = at->of;
    Host              *host = (Host *)at->room;
    (void)i;
    *host = (Host){
        .entity = r->host, .flown = r->host_id, .speed_mps = v3_length(r->host ? r->host->v_ecef_mps : r->v_eye_mps)};
    memcpy(host->p_ecef, r->p_eye_ecef, sizeof host->p_ecef);
    if (geodetic_from_ecef(&host->place, r->p_eye_ecef) != STATUS_OK) host->place = (Geodetic){NAN, NAN, NAN};
    euler_from_r_ecef_from_body(&host->psi_rad, &host->theta_rad, &host->phi_rad, r->r_ecef_from_body);
    return host;
}

static const void *entity_of(const void *of) { return ((const Host *)of)->entity; }
static const void *sun_of(const void *of) { return ((const FrameRecord *)of)->sun; }
static const void *view_of(const void *of) { return &((const FrameRecord *)of)->request->view; }
static const void *radar_of(const void *of) { return ((const FrameRecord *)of)->radar; }

static json_t *host_id(FieldAt *at)
{
    const SnapshotEntity *host = entity_of(at->of);
    const DisEntityId     flown = ((const Host *)at->of)->flown;
    if (!host && !dis_entity_id_is_none(flown)) return field_id(flown);
    return host ? field_id(host->id) : json_string("observer");
}

static const void *the_sensor(FieldAt *at, int i) { return i == 0 ? at->of : NULL; }

static json_t *sensor_name(FieldAt *at)
{
    (void)at;
    return json_string("seeker");
}

static json_t *bands_rendered(FieldAt *at)
{
    json_t *bands = json_array();
    for (int b = 0; b < BAND_COUNT; b++)
        if (((const FrameRecord *)at->of)->request->bands >> b & 1)
            json_array_append_new(bands, json_string(band_name((Band)b)));
    return bands;
}

static json_t *vertical_view(FieldAt *at)
{
    const View *view = view_of(at->of);
    return field_number(field_deg(2 * atan(0.5 * view->height / view->focal_px)));
}

static json_t *distortion(FieldAt *at)
{
    const View  *view = view_of(at->of);
    const Lens  *l = &view->lens;
    const double opencv[5] = {l->k[0], l->k[1], l->p[0], l->p[1], l->k[2]};
    return view_has_lens(view) ? json_number_list(opencv, 5) : NULL;
}

/* NULL: it has no lateral colour. */
static const void *lateral_of(const void *of)
{
    const RenderRequest *request = ((const FrameRecord *)of)->request;
    return request->lateral[0] != 0 || request->lateral[1] != 0 ? request : NULL;
}

static const void *next_target(FieldAt *at, int i)
{
    const FrameRecord *r = at->of;
    return i < r->target_count ? &r->target[i] : NULL;
}

static const void *clutter_of(const void *of) { return ((const FrameRecord *)of)->clutter_count > 0 ? of : NULL; }

static const void *next_clutter(FieldAt *at, int i)
{
    const FrameRecord *r = at->of;
    return i < r->clutter_count ? &r->clutter[i] : NULL;
}

static const void *head_of(const void *of)
{
    const FrameRecord *r = of;
    return r->turned ? &r->head : NULL;
}

static json_t *head_relative(FieldAt *at) { return json_boolean(((const HeadPose *)at->of)->flags & HEAD_RELATIVE); }
static json_t *head_sequence(FieldAt *at) { return json_integer(((const HeadPose *)at->of)->sequence); }
static json_t *head_buttons(FieldAt *at) { return json_integer(((const HeadPose *)at->of)->buttons); }

/* ---- its error ----------------------------------------------------------------------------------- */

/* rms over the image as a share of the band's mean, and in kelvin about that mean. The mean of the pseudo-radar is that
 * of a few mirrors, and no measure. */
typedef struct BandError {
    double share[error_sources], kelvin[error_sources], median_k, beyond_1k, plants_bias, plants_bias_se, plants_rms;
} BandError;
_Static_assert(sizeof(BandError) <= sizeof((FieldAt){0}).room, "it has no room");

static const void *error_of_band(FieldAt *at, int i)
{
    const FrameError *e = ((const FrameRecord *)at->of)->error;
    BandError        *out = (BandError *)at->room;
    if (!e || i == BAND_RADAR) return NULL;
    *out = (BandError){.median_k = e->median_k[i],
                       .beyond_1k = e->beyond_1k[i],
                       .plants_bias = e->plants_bias[i],
                       .plants_bias_se = e->plants_bias_se[i],
                       .plants_rms = e->plants_rms[i]};
    memcpy(out->share, e->share[i], sizeof out->share);
    memcpy(out->kelvin, e->kelvin[i], sizeof out->kelvin);
    return field_keyed(at, band_name((Band)i), out);
}

static const void *plants_of(const void *of)
{
    const FrameError *e = ((const FrameRecord *)of)->error;
    return e && e->plants.rays > 0 ? &e->plants : NULL;
}

static const void *errors_of(const void *of)
{
    const FrameRecord *r = of;
    return r->error || r->radar_error ? r : NULL;
}

static const void *radar_error_of(const void *of) { return ((const FrameRecord *)of)->radar_error; }

/* ---- its latency, which is put behind the line when its consumers are done ------------------------ */

static json_t *latency_later(FieldAt *at)
{
    (void)at;
    return NULL;
}

static const void *next_consumer(FieldAt *at, int i)
{
    const LatencyLine *l = at->of;
    return i < l->consumers ? field_keyed(at, l->name[i], &l->done_ms[i]) : NULL;
}

/* ---- the fields ---------------------------------------------------------------------------------- */

#define OF_FRAME(member) FIELD_MEMBER(FrameRecord, member)
#define OF_HOST(member)  FIELD_MEMBER(Host, member)
#define OF_ERROR(member) FIELD_MEMBER(BandError, member)
#define OF_RADAR(member) FIELD_MEMBER(RadarError, member)

static const Field host_rows[] = {
    {"entity", "", "site:application:entity", "", "id, or `observer`: a sensor position that is no entity",
     FIELD_GET("string", host_id), FIELD_EXACT},
    {"marking", "", "", "when the host is an observer", "its marking, at most 11 characters",
     FIELD_IN(entity_of, SnapshotEntity, marking), FIELD_EXACT},
    {"ecef_m", "m", "ecef", "", "position of the sensor", OF_HOST(p_ecef), FIELD_WITHIN(1e-3, 0)},
    {"lat_deg", "deg", "WGS 84, geodetic", "", "latitude of the sensor, north positive", OF_HOST(place.lat_rad),
     .as = field_deg, FIELD_WITHIN(1e-8, 0)},
    {"lon_deg", "deg", "WGS 84", "", "longitude of the sensor, east positive", OF_HOST(place.lon_rad), .as = field_deg,
     FIELD_WITHIN(1e-8, 0)},
    {"height_m", "m", "above the WGS 84 ellipsoid", "", "height of the sensor", OF_HOST(place.h_m),
     FIELD_WITHIN(1e-3, 0)},
    {"psi_deg", "deg", "ecef to body, as in an Entity State", "",
     "first Euler angle of the host's body, about z; of an observer: of the camera", OF_HOST(psi_rad), .as = field_deg,
     FIELD_WITHIN(1e-4, 0)},
    {"theta_deg", "deg", "ecef to body", "", "second Euler angle, about y", OF_HOST(theta_rad), .as = field_deg,
     FIELD_WITHIN(1e-4, 0)},
    {"phi_deg", "deg", "ecef to body", "", "third Euler angle, about x", OF_HOST(phi_rad), .as = field_deg,
     FIELD_WITHIN(1e-4, 0)},
    {"speed_mps", "m/s", "relative to the rotating Earth", "", "speed of the host", OF_HOST(speed_mps),
     FIELD_WITHIN(1e-3, 0)},
};

static const Field sun_rows[] = {
    {"azimuth_deg", "deg", "ENU at the sensor, from north over east", "", "0 .. 360", FIELD_MEMBER(Sun, azimuth_rad),
     .as = field_deg, FIELD_WITHIN(0.005, 0)},
    {"elevation_deg", "deg", "ENU at the sensor", "", "above the horizontal, with refraction",
     FIELD_MEMBER(Sun, elevation_rad), .as = field_deg, FIELD_WITHIN(0.005, 0)},
};

static const Field sensor_rows[] = {
    {"name", "", "", "", "`seeker`", FIELD_GET("string", sensor_name), FIELD_EXACT},
    {"bands", "", "", "", "which of optical, mwir, lwir, radar were rendered",
     FIELD_GET("list of strings", bands_rendered), FIELD_EXACT},
    {"width_px", "px", "", "", "columns", FIELD_IN(view_of, View, width), FIELD_EXACT},
    {"height_px", "px", "", "", "rows", FIELD_IN(view_of, View, height), FIELD_EXACT},
    {"hfov_deg", "deg", "", "", "horizontal field of view", OF_FRAME(hfov_rad), .as = field_deg, FIELD_WITHIN(1e-6, 0)},
    {"vfov_deg", "deg", "", "", "vertical field of view", FIELD_GET("number", vertical_view), FIELD_WITHIN(1e-6, 0)},
    {"distortion", "", "k1, k2, p1, p2, k3 as OpenCV has them", "without a lens (sensor.lens_*)",
     "Brown-Conrady coefficients of tangents of angles; boxes and masks follow",
     FIELD_GET("list of 5 numbers", distortion)},
    {"lateral_colour", "", "red, blue", "without (sensor.lateral_*)", "magnification relative to green, minus 1",
     FIELD_IN(lateral_of, RenderRequest, lateral)},
    {"ecef_from_cam", "", "row by row; its columns are the camera's x, y, z in ecef", "", "rotation: ecef = R camera",
     OF_FRAME(r_ecef_from_cam), FIELD_WITHIN(2e-6, 0)},
    {"gimbal_at_limit", "", "", "", "the aim point is beyond sensor.gimbal_limit_deg", OF_FRAME(gimbal_at_limit),
     FIELD_EXACT},
    {"scene_rate_px_s", "px/s", "image: column, row", "", "image motion of a stationary object at the image centre",
     OF_FRAME(scene_rate_px_s), FIELD_WITHIN(0.01, 1e-5), .channel = FIELD_TARGETS},
    {"ground_km2", "km2", "on the map", "",
     "ground that the image shows within 10 km, as if nothing stood on it: what was searched for targets",
     OF_FRAME(ground_km2), FIELD_WITHIN(1e-4, 0.02), .channel = FIELD_TARGETS, .newer = true},
};

static const Field band_error_rows[] = {
    {"sampling", "", "share of the band's mean", "", "finite number of rays per pixel", OF_ERROR(share[ERROR_SAMPLING]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"sampling_k", "K, apparent", "", "in optical", "the same in temperature", OF_ERROR(kelvin[ERROR_SAMPLING]),
     FIELD_WITHIN(0.05, 0.05)},
    {"level_of_detail", "", "share of the band's mean", "", "level of detail of ground and models",
     OF_ERROR(share[ERROR_LEVEL_OF_DETAIL]), FIELD_WITHIN(1e-3, 0.05)},
    {"level_of_detail_k", "K, apparent", "", "in optical", "the same in temperature",
     OF_ERROR(kelvin[ERROR_LEVEL_OF_DETAIL]), FIELD_WITHIN(0.05, 0.05)},
    {"table", "", "share of the band's mean", "", "interpolation in tables of the atmosphere and Planck's law",
     OF_ERROR(share[ERROR_TABLES]), FIELD_WITHIN(1e-3, 0.05)},
    {"table_k", "K, apparent", "", "in optical", "the same in temperature", OF_ERROR(kelvin[ERROR_TABLES]),
     FIELD_WITHIN(0.05, 0.05)},
    {"heat", "", "share of the band's mean", "",
     "steps, elements and facets of the heat of ground and parts; 0 in optical", OF_ERROR(share[ERROR_HEAT]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"heat_k", "K, apparent", "", "in optical", "the same in temperature", OF_ERROR(kelvin[ERROR_HEAT]),
     FIELD_WITHIN(0.05, 0.05)},
    {"dead_reckoning", "", "share of the band's mean", "", "position errors of dead-reckoned entities",
     OF_ERROR(share[ERROR_DEAD_RECKONING]), FIELD_WITHIN(1e-3, 0.05)},
    {"dead_reckoning_k", "K, apparent", "", "in optical", "the same in temperature",
     OF_ERROR(kelvin[ERROR_DEAD_RECKONING]), FIELD_WITHIN(0.05, 0.05)},
    {"total", "", "share of the band's mean", "", "total of these", OF_ERROR(share[ERROR_TOTAL]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"total_k", "K, apparent", "", "in optical", "the same in temperature", OF_ERROR(kelvin[ERROR_TOTAL]),
     FIELD_WITHIN(0.05, 0.05)},
    {"median_k", "K, apparent", "", "in optical", "median of the pixels' expected errors: half of them are better",
     OF_ERROR(median_k), FIELD_WITHIN(0.05, 0.05), .newer = true},
    {"beyond_1k", "share of the image", "0 .. 1", "in optical", "pixels that are expected to be off by more than 1 K",
     OF_ERROR(beyond_1k), FIELD_WITHIN(0.01, 0.05), .newer = true},
    {"plants_bias", "", "share of the band's mean", "where every plant is in full detail",
     "how much brighter rays are in the mean than in full detail, by the rays of `plants`", OF_ERROR(plants_bias),
     FIELD_WITHIN(0.01, 0.05), .newer = true},
    {"plants_bias_se", "", "share of the band's mean", "likewise", "standard error of this", OF_ERROR(plants_bias_se),
     FIELD_WITHIN(0.01, 0.2), .newer = true},
    {"plants_rms", "", "share of the band's mean", "likewise", "rms difference of single rays: mostly another leaf",
     OF_ERROR(plants_rms), FIELD_WITHIN(0.01, 0.2), .newer = true},
};

#define OF_PLANTS(member) FIELD_MEMBER(PlantPrice, member)

static const Field plants_error_rows[] = {
    {"rays", "", "", "", "rays that were traced both as the frame has plants and with all of them in full detail",
     OF_PLANTS(rays), FIELD_EXACT, .newer = true},
    {"met", "", "of `rays`", "", "those that met a plant, either way", OF_PLANTS(met), FIELD_WITHIN(20, 0.05),
     .newer = true},
    {"cover", "", "share of `rays`", "", "those that meet a plant, in full detail", OF_PLANTS(cover),
     FIELD_WITHIN(0.01, 0.05), .newer = true},
    {"cover_bias", "", "share of `rays`", "", "how many more the frame has", OF_PLANTS(bias[price_cover]),
     FIELD_WITHIN(0.01, 0), .newer = true},
    {"cover_bias_se", "", "share of `rays`", "", "standard error of this", OF_PLANTS(bias_se[price_cover]),
     FIELD_WITHIN(0.01, 0), .newer = true},
    {"visible", "", "share of `rays`", "", "those that meet an entity, but for small ones, in full detail",
     OF_PLANTS(visible), FIELD_WITHIN(0.01, 0.05), .newer = true},
    {"visible_bias", "", "share of `rays`", "", "how many more the frame has", OF_PLANTS(bias[price_visible]),
     FIELD_WITHIN(0.01, 0), .newer = true},
};

static const Field radar_error_rows[] = {
    {"sampling", "", "share of the cells' rms", "", "grid of ray tubes on entities", OF_RADAR(share[ERROR_SAMPLING]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"sampling_db", "dB", "", "without an entity in sight, or of given signatures alone",
     "the same of an entity's cross section, and of a detection's: one standard deviation",
     OF_RADAR(db[ERROR_SAMPLING])},
    {"level_of_detail", "", "share of the cells' rms", "", "scattering centres in place of what the tubes hit",
     OF_RADAR(share[ERROR_LEVEL_OF_DETAIL]), FIELD_WITHIN(1e-3, 0.05)},
    {"level_of_detail_db", "dB", "", "likewise", "likewise", OF_RADAR(db[ERROR_LEVEL_OF_DETAIL])},
    {"table", "", "share of the cells' rms", "", "gridding of echoes over delay and Doppler",
     OF_RADAR(share[ERROR_TABLES]), FIELD_WITHIN(1e-3, 0.05)},
    {"table_db", "dB", "", "likewise", "likewise", OF_RADAR(db[ERROR_TABLES])},
    {"dead_reckoning", "", "share of the cells' rms", "",
     "position errors of dead-reckoned entities along the line of sight: of the cells' magnitudes",
     OF_RADAR(share[ERROR_DEAD_RECKONING]), FIELD_WITHIN(1e-3, 0.05)},
    {"total", "", "share of the cells' rms", "", "total of these", OF_RADAR(share[ERROR_TOTAL]),
     FIELD_WITHIN(1e-3, 0.05)},
    {"total_db", "dB", "", "likewise", "likewise, of these three", OF_RADAR(db[ERROR_TOTAL])},
};

static const Field error_rows[] = {
    {"BAND", "", "", "when the band was not rendered; of the pseudo-radar, whose mean is that of a few mirrors",
     "rms over the image: that of the brightest pixels, if these may be off", .item = error_of_band,
     .unless_empty = true, FIELD_OBJECT(band_error_rows)},
    {"plants", "", "", "where every plant is in full detail (terrain.woods_tables, terrain.woods_level1_px)",
     "what it changes that plants are met in tables or simplified, by rays drawn over the image", .in = plants_of,
     FIELD_OBJECT(plants_error_rows), .newer = true},
    {"range_doppler", "", "", "with radar.preset none",
     "the same of the radar's map, rms over the cells of its sum channel", .in = radar_error_of, .unless_empty = true,
     FIELD_OBJECT(radar_error_rows)},
};

static const Field consumer_rows[] = {
    {"CONSUMER", "ms", "after the end of rendering", "when it was not given the frame, or not done two frames later",
     "the consumer was done with the frame", .item = next_consumer, .kind = FIELD_OF_DOUBLE, .as = field_ms},
};

static const Field latency_rows[] = {
    {"arrival_to_pose", "ms", "", "before the first datagram",
     "from the arrival of the newest datagram that the frame used until the sensor's pose was sampled",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_ARRIVAL_TO_POSE]), .as = field_ms},
    {"pose_to_render", "ms", "", "", "from then until rendering began",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_POSE_TO_RENDER]), .as = field_ms},
    {"render", "ms", "", "", "rendering, with the truth of targets where it is requested",
     FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_RENDER]), .as = field_ms},
    {"display", "ms", "after the end of rendering", "when no consumer takes displays, or not done two frames later",
     "displays made: the detector, gain and level", FIELD_MEMBER(LatencyLine, stage_ms[LATENCY_DISPLAY]),
     .as = field_ms},
    {"consumers", "", "", "", "by consumer of the frame", FIELD_OBJECT(consumer_rows)},
};

static const Field head_rows[] = {
    {"sequence", "", "", "", "of the datagram", FIELD_GET("integer", head_sequence), FIELD_EXACT},
    {"relative", "", "", "", "to the body of the host, of an observer to its line to the aim; else to north and level",
     FIELD_GET("boolean", head_relative), FIELD_EXACT},
    {"yaw_deg", "deg", "", "", "to the right, as it was sent", FIELD_MEMBER(HeadPose, yaw_deg), FIELD_WITHIN(1e-6, 0)},
    {"pitch_deg", "deg", "", "", "then up", FIELD_MEMBER(HeadPose, pitch_deg), FIELD_WITHIN(1e-6, 0)},
    {"roll_deg", "deg", "", "", "then the right side down", FIELD_MEMBER(HeadPose, roll_deg), FIELD_WITHIN(1e-6, 0)},
    {"zoom", "", "", "", "factor of the focal length", FIELD_MEMBER(HeadPose, zoom), FIELD_WITHIN(1e-6, 0)},
    {"buttons", "", "", "", "a bit each", FIELD_GET("integer", head_buttons), FIELD_EXACT},
};

static const Field frame_rows[] = {
    {"frame", "", "from 0", "", "number of the frame, as in the names of its files", OF_FRAME(frame), FIELD_EXACT},
    {"time_s", "s", "exercise time", "", "instant of the frame", OF_FRAME(time_s), FIELD_WITHIN(1e-6, 0),
     .channel = FIELD_TIME},
    {"frame_sha256", "", "", "when hashes are not requested", "SHA-256 of all planes before they are encoded",
     OF_FRAME(frame_sha256), .channel = FIELD_APART},
    {"host", "", "", "", "the entity that carries the sensor", .item = the_host, FIELD_OBJECT(host_rows)},
    {"head", "", "", "without exercise.head, and before its first pose", "the pose that turned the sensor",
     .in = head_of, FIELD_OBJECT(head_rows), .newer = true},
    {"sun", "", "", "", "direction of the sun", .in = sun_of, FIELD_OBJECT(sun_rows), .channel = FIELD_SUN},
    {"sensors", "", "from 0", "", "one: all bands share the optics and the instant", .item = the_sensor,
     FIELD_OBJECTS(sensor_rows)},
    {"targets", "", "in the order of the frame's entity table", "",
     "every entity in the field of view except the host, occluded ones too", .item = next_target,
     .type = "list of objects", .rows = &target_fields, .channel = FIELD_MOTION},
    {"clutter", "", "in the order of the world's objects", "where no clutter is seen",
     "what stands or drives about and takes no part in the exercise, of which some sample is seen: terrain.clutter",
     .in = clutter_of, .item = next_clutter, .type = "list of objects", .rows = &clutter_fields,
     .channel = FIELD_TARGETS, .newer = true},
    {"error", "", "", "with quality.budget off", "the frame's estimate of its own error", .in = errors_of,
     FIELD_OBJECT(error_rows), .channel = FIELD_ERROR},
    {"given_up", "", "", "in a frame of full quality",
     "what a live node gave up in this frame to keep its rate: `targets` (borders of ground, shadows and horizon are not refined), `checkerboard` (of ground, plants and sky every second pixel has a ray), `quarter` (every fourth), `target_grids` (small targets have the samples of all others); several are separated by commas",
     OF_FRAME(given_up), .channel = FIELD_APART},
    {"radar", "", "", "with radar.preset none", "what the radar on the sensor's axis measured, and the truth of it",
     .in = radar_of, .type = "object", .rows = &radar_fields, .channel = FIELD_RADAR},
    {"latency_ms", "", "", "in a replay at full speed",
     "when each step of the frame was done; of a run and of replay --speed X", FIELD_OBJECT(latency_rows),
     .get = latency_later},
};
const FieldTable record_frame_fields = {frame_rows, sizeof frame_rows / sizeof *frame_rows};

/* ---- writing ------------------------------------------------------------------------------------- */

char *record_frame_text(const FrameRecord *r) { return field_line(&record_frame_fields, r, 15); }

Status record_write_text(FILE *file, const char *text, const LatencyLine *latency)
{
    char *more = latency ? field_line(&FIELD_TABLE(latency_rows), latency, 9) : NULL;
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
