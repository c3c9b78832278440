/* tests/sensor/klv_lab.h: a frame whose metadata is encoded, and a reader of local sets that is not the product's. */
#ifndef TESTS_SENSOR_KLV_LAB_H
#define TESTS_SENSOR_KLV_LAB_H

#include "tests/check.h"

#include "sensor/publish/klv/consume_klv.h"
#include "sensor/publish/klv/klv_writer_private.h"

static struct {
    uint8_t        octets[klv_most_octets];
    size_t         used;
    RenderRequest  request;
    SnapshotEntity host;
    GroundPoint    footprint[FOOTPRINT_COUNT];
    FrameRecord    record;
} lab;

static const KlvSource lwir = {.band = BAND_LWIR, .mission = "Exercise 1"};

typedef struct Value {
    const uint8_t *at; /* NULL: absent */
    size_t         count;
} Value;

/* Of a tag of a local set. */
static inline Value find(Value set, unsigned tag)
{
    const uint8_t *at = set.at, *end = set.at + set.count;
    while (at < end) {
        const unsigned found = *at++;
        size_t         length = *at++;
        if (length & 0x80) {
            int octets = (int)(length & 0x7F);
            for (length = 0; octets > 0; octets--) length = length << 8 | *at++;
        }
        if (found == tag) return (Value){at, length};
        at += length;
    }
    return (Value){0};
}

static inline Value tag_of(unsigned tag)
{
    const size_t head = lab.octets[16] < 128 ? 17 : 17 + (lab.octets[16] & 0x7Fu);
    return find((Value){lab.octets + head, lab.used - head}, tag);
}

static inline bool has(unsigned tag) { return tag_of(tag).at != NULL; }

static inline bool is_text(Value value, const char *text)
{
    return value.at && value.count == strlen(text) && memcmp(value.at, text, value.count) == 0;
}

static inline double number(Value v, bool is_signed)
{
    if (!v.at) fail_msg("an absent tag");
    uint64_t value = is_signed && v.at[0] & 0x80 ? UINT64_MAX : 0;
    for (size_t i = 0; i < v.count; i++) value = value << 8 | v.at[i];
    return is_signed ? (double)(int64_t)value : (double)value;
}

static inline double unsigned_of(unsigned tag, double low, double high)
{
    const Value value = tag_of(tag);
    if (!value.at) fail_msg("no tag %u", tag);
    return low + (high - low) * number(value, false) / (ldexp(1, 8 * (int)value.count) - 1);
}

static inline double signed_of(unsigned tag, double high)
{
    const Value value = tag_of(tag);
    if (!value.at) fail_msg("no tag %u", tag);
    return high * number(value, true) / (ldexp(1, 8 * (int)value.count - 1) - 1);
}

/* Axes forward, right, down as columns. */
static inline void turn(double r[9], double yaw_deg, double pitch_deg, double roll_deg)
{
    const double y = yaw_deg * rad_per_deg, p = pitch_deg * rad_per_deg, x = roll_deg * rad_per_deg;
    const double rz[9] = {cos(y), -sin(y), 0, sin(y), cos(y), 0, 0, 0, 1};
    const double ry[9] = {cos(p), 0, sin(p), 0, 1, 0, -sin(p), 0, cos(p)};
    const double rx[9] = {1, 0, 0, 0, cos(x), -sin(x), 0, sin(x), cos(x)};
    double       rzy[9];
    m3_mul(rzy, rz, ry);
    m3_mul(r, rzy, rx);
}

/* A sensor at a place on a platform that flies east; the camera is turned on it. */
static inline void scene(const Geodetic *place, const double platform_deg[3], const double sensor_deg[3])
{
    double r_ecef_from_enu[9], r_ecef_from_ned[9], r_ned_from_body[9], r_body_from_sensor[9], r_ecef_from_sensor[9];
    memset(&lab, 0, sizeof lab);
    lab.request.view = (View){.width = 640, .height = 480, .focal_px = view_focal_px(640, 6 * rad_per_deg)};
    memcpy(lab.host.marking, "MSL 1", 6);
    lab.record = (FrameRecord){.frame = 300,
                               .host = &lab.host,
                               .request = &lab.request,
                               .hfov_rad = 6 * rad_per_deg,
                               .footprint = lab.footprint};
    assert_int_equal(ecef_from_geodetic(lab.record.p_eye_ecef, r_ecef_from_enu, place), STATUS_OK);
    const double v_enu_mps[3] = {200, -30, 5};
    m3_mul_v3(lab.record.v_eye_mps, r_ecef_from_enu, v_enu_mps);
    for (int k = 0; k < 3; k++) {
        r_ecef_from_ned[3 * k] = r_ecef_from_enu[3 * k + 1];
        r_ecef_from_ned[3 * k + 1] = r_ecef_from_enu[3 * k];
        r_ecef_from_ned[3 * k + 2] = -r_ecef_from_enu[3 * k + 2];
    }
    turn(r_ned_from_body, platform_deg[0], platform_deg[1], platform_deg[2]);
    turn(r_body_from_sensor, sensor_deg[0], sensor_deg[1], sensor_deg[2]);
    m3_mul(lab.record.r_ecef_from_body, r_ecef_from_ned, r_ned_from_body);
    m3_mul(r_ecef_from_sensor, lab.record.r_ecef_from_body, r_body_from_sensor);
    for (int k = 0; k < 3; k++) { /* right, down, forward */
        lab.record.r_ecef_from_cam[3 * k] = r_ecef_from_sensor[3 * k + 1];
        lab.record.r_ecef_from_cam[3 * k + 1] = r_ecef_from_sensor[3 * k + 2];
        lab.record.r_ecef_from_cam[3 * k + 2] = r_ecef_from_sensor[3 * k];
    }
}

static inline void encode(const KlvTargets *targets)
{
    lab.used = klv_frame(lab.octets, &lab.record, 1750000000.25, &lwir, targets);
    CHECK(lab.used > 0);
}

static const Geodetic somewhere = {48.25 * rad_per_deg, -11.5 * rad_per_deg, 2345};

#endif
