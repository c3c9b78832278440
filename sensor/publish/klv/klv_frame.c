/* sensor/publish/klv/klv_frame.c: the ST 0601 UAS Datalink local set of a frame. */
#include "sensor/publish/klv/klv_private.h"

#include "sensor/frame/source_sensor.h"

enum { key_octets = 16, text_most = 63 };

/* SMPTE universal key of the UAS Datalink local set. */
static const uint8_t uas_key[key_octets] = {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01,
                                            0x0E, 0x01, 0x03, 0x01, 0x01, 0x00, 0x00, 0x00};

/* The operational mode (tag 77) of ST 0601. */
enum { mode_exercise = 3 };

/* Attitude of a body (x forward, y right, z down), in degrees: yaw is clockwise from above, pitch up, roll right. */
typedef struct Attitude {
    double yaw_deg, pitch_deg, roll_deg;
} Attitude;

/* Where the sensor is, and the local axes there. */
typedef struct Place {
    bool     known;
    Geodetic at;
    double   r_ned_from_ecef[9];
    double   v_ned_mps[3];
} Place;

static Attitude attitude_of(const double r[9])
{
    return (Attitude){atan2(r[3], r[0]) / rad_per_deg, -asin(clamp(r[6], -1, 1)) / rad_per_deg,
                      atan2(r[7], r[8]) / rad_per_deg};
}

static double turn_deg(double angle_deg) { return angle_deg < 0 ? angle_deg + 360 : angle_deg; }

/* Columns of the camera (right, down, boresight) in the order of a body's (forward, right, down). */
static void body_of_camera(double r_ecef_from_body[9], const double r_ecef_from_cam[9])
{
    for (int k = 0; k < 3; k++)
        for (int axis = 0; axis < 3; axis++) r_ecef_from_body[3 * k + axis] = r_ecef_from_cam[3 * k + (axis + 2) % 3];
}

static Place place_of(const FrameRecord *r)
{
    Place  place = {0};
    double p_ecef[3], r_ecef_from_enu[9];
    place.known = geodetic_from_ecef(&place.at, r->p_eye_ecef) == STATUS_OK &&
                  ecef_from_geodetic(p_ecef, r_ecef_from_enu, &place.at) == STATUS_OK;
    for (int k = 0; place.known && k < 3; k++) {
        place.r_ned_from_ecef[k] = r_ecef_from_enu[3 * k + 1];
        place.r_ned_from_ecef[3 + k] = r_ecef_from_enu[3 * k];
        place.r_ned_from_ecef[6 + k] = -r_ecef_from_enu[3 * k + 2];
    }
    m3_mul_v3(place.v_ned_mps, place.r_ned_from_ecef, r->v_eye_mps);
    return place;
}

static double geoid_m(const KlvSource *source, double lat_rad, double lon_rad)
{
    return source->geoid ? geoid_height_m(source->geoid, lat_rad, lon_rad) : NAN;
}

/* Puts latitude and longitude into this tag and the next, both or none. */
static void put_place(KlvWriter *w, unsigned tag, double lat_rad, double lon_rad)
{
    if (!(fabs(lat_rad) <= 0.5 * pi_rad && fabs(lon_rad) <= pi_rad)) return;
    klv_item_signed(w, tag, 4, 90, clamp(lat_rad / rad_per_deg, -90, 90));
    klv_item_signed(w, tag + 1, 4, 180, clamp(lon_rad / rad_per_deg, -180, 180));
}

static void put_height(KlvWriter *w, unsigned tag, double height_m)
{
    klv_item_unsigned(w, tag, 2, -900, 19000, height_m);
}

static bool is_printable(const char *text, size_t most)
{
    for (size_t i = 0; i < most && text[i]; i++)
        if (text[i] > 0x20 && text[i] < 0x7F) return true;
    return false;
}

/* ---- groups of tags, in ascending order --------------------------------------------------------- */

/* 5 .. 7: the platform's attitude in the local axes at the sensor, so that a reader that applies it and then the
 * sensor's own angles gets the camera's direction exactly. 90, 91: the same by wider ranges and in finer steps. */
static void put_platform(KlvWriter *w, const Attitude *platform)
{
    klv_item_unsigned(w, 5, 2, 0, 360, turn_deg(platform->yaw_deg));
    klv_item_signed(w, 6, 2, 20, platform->pitch_deg);
    klv_item_signed(w, 7, 2, 50, platform->roll_deg);
}

static void put_names(KlvWriter *w, const FrameRecord *r, const KlvSource *source)
{
    const char *platform = r->host && r->catalog ? catalog_model(r->catalog, r->host->model)->name : NULL;
    klv_item_text(w, 10, platform ? platform : r->host ? "platform" : "observer", text_most);
    klv_item_text(w, 11, klv_sensor_name(source), text_most);
    klv_item_text(w, 12, "Geodetic WGS84", text_most);
}

static void put_position(KlvWriter *w, const Place *place, const KlvSource *source)
{
    if (!place->known) return;
    put_place(w, 13, place->at.lat_rad, place->at.lon_rad);
    put_height(w, 15, place->at.h_m - geoid_m(source, place->at.lat_rad, place->at.lon_rad));
}

static void put_view(KlvWriter *w, const FrameRecord *r, const Attitude *sensor)
{
    klv_item_unsigned(w, 16, 2, 0, 180, r->hfov_rad / rad_per_deg);
    klv_item_unsigned(w, 17, 2, 0, 180, klv_vfov_deg(r));
    klv_item_unsigned(w, 18, 4, 0, 360, turn_deg(sensor->yaw_deg));
    klv_item_signed(w, 19, 4, 180, sensor->pitch_deg);
    klv_item_unsigned(w, 20, 4, 0, 360, turn_deg(sensor->roll_deg));
}

static void put_centre(KlvWriter *w, const FrameRecord *r, const KlvSource *source)
{
    if (!r->footprint || !r->footprint[FOOTPRINT_CENTRE].known) return;
    const GroundPoint *centre = &r->footprint[FOOTPRINT_CENTRE];
    klv_item_unsigned(w, 21, 4, 0, 5e6, centre->range_m);
    klv_item_unsigned(w, 22, 2, 0, 1e4, 2 * centre->range_m * tan(0.5 * r->hfov_rad));
    put_place(w, 23, centre->lat_rad, centre->lon_rad);
    put_height(w, 25, centre->height_m - geoid_m(source, centre->lat_rad, centre->lon_rad));
}

static void put_corners(KlvWriter *w, const FrameRecord *r)
{
    if (!r->footprint) return;
    for (int k = 0; k < 4; k++) {
        const GroundPoint *corner = &r->footprint[FOOTPRINT_UPPER_LEFT + k];
        if (corner->known) put_place(w, 82 + 2 * (unsigned)k, corner->lat_rad, corner->lon_rad);
    }
}

static void put_vmti(KlvWriter *w, const FrameRecord *r, uint64_t time_us, const KlvSource *source,
                     const KlvTargets *targets)
{
    uint8_t   octet[klv_most_octets];
    KlvWriter set = {.octet = octet, .room = sizeof octet};
    klv_vmti(&set, r, time_us, source, targets);
    klv_item(w, 74, octet, set.used);
    w->full |= set.full;
}

static void put_items(KlvWriter *w, const FrameRecord *r, uint64_t time_us, const KlvSource *source,
                      const KlvTargets *targets)
{
    const Place place = place_of(r);
    double      r_ecef_from_sensor[9], r_ecef_from_platform[9], r_turn[9];
    body_of_camera(r_ecef_from_sensor, r->r_ecef_from_cam);
    /* an observer that is no entity is its own platform */
    memcpy(r_ecef_from_platform, r->host ? r->r_ecef_from_body : r_ecef_from_sensor, sizeof r_ecef_from_platform);
    m3_mul(r_turn, place.r_ned_from_ecef, r_ecef_from_platform);
    const Attitude platform = place.known ? attitude_of(r_turn) : (Attitude){NAN, NAN, NAN};
    m3_tmul(r_turn, r_ecef_from_platform, r_ecef_from_sensor);
    const Attitude sensor = attitude_of(r_turn);

    klv_item_number(w, 2, time_us, 8);
    klv_item_text(w, 3, source->mission ? source->mission : "Exercise", text_most);
    put_platform(w, &platform);
    put_names(w, r, source);
    put_position(w, &place, source);
    put_view(w, r, &sensor);
    put_centre(w, r, source);
    if (place.known) klv_item_unsigned(w, 56, 1, 0, 255, hypot(place.v_ned_mps[0], place.v_ned_mps[1]));
    if (r->host && is_printable(r->host->marking, sizeof r->host->marking))
        klv_item_text(w, 59, r->host->marking, sizeof r->host->marking - 1);
    klv_item_number(w, 65, klv_version, 1);
    if (targets) put_vmti(w, r, time_us, source, targets);
    if (place.known) put_height(w, 75, place.at.h_m);
    klv_item_number(w, 77, mode_exercise, 1);
    if (r->footprint && r->footprint[FOOTPRINT_CENTRE].known)
        put_height(w, 78, r->footprint[FOOTPRINT_CENTRE].height_m);
    if (place.known) {
        klv_item_signed(w, 79, 2, 327, place.v_ned_mps[0]);
        klv_item_signed(w, 80, 2, 327, place.v_ned_mps[1]);
    }
    put_corners(w, r);
    klv_item_signed(w, 90, 4, 90, platform.pitch_deg);
    klv_item_signed(w, 91, 4, 90, platform.roll_deg);
    if (place.known && place.at.h_m > 19000) klv_item_imapb(w, 104, 3, -900, 40000, place.at.h_m);
}

/* ---- the packet ------------------------------------------------------------------------------------ */

const char *klv_sensor_name(const KlvSource *source)
{
    return source->sensor ? source->sensor : source_sensor_name[source->band];
}

double klv_vfov_deg(const FrameRecord *r)
{
    return 2 * atan(0.5 * r->request->view.height / r->request->view.focal_px) / rad_per_deg;
}

bool klv_time_us(uint64_t *out, double unix_s)
{
    static const double latest_s = 7258118400; /* 2200-01-01 */
    if (!(unix_s >= 0 && unix_s < latest_s)) return false;
    *out = (uint64_t)floor(unix_s * 1e6 + 0.5);
    return true;
}

size_t klv_frame(uint8_t out[klv_most_octets], const FrameRecord *record, double unix_s, const KlvSource *source,
                 const KlvTargets *targets)
{
    uint8_t   octet[klv_most_octets - key_octets - 5 - 4];
    KlvWriter items = {.octet = octet, .room = sizeof octet};
    KlvWriter w = {.octet = out, .room = klv_most_octets};
    uint64_t  time_us;
    if (!klv_time_us(&time_us, unix_s)) return 0;

    put_items(&items, record, time_us, source, targets);
    klv_put(&w, uas_key, sizeof uas_key);
    klv_put_length(&w, items.used + 4);
    klv_put(&w, octet, items.used);
    klv_put_oid(&w, 1);
    klv_put_length(&w, 2);
    klv_put_number(&w, klv_checksum(out, w.used), 2);
    return items.full || w.full ? 0 : w.used;
}
