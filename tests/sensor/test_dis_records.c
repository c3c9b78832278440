/* The Data PDUs of a frame, read octet by octet as consume_dis.h describes them. tests/system/test_live.sh has tshark
 * read them. */
#include "tests/check.h"

#include "dis/pdu/decode.h"
#include "sensor/publish/dis/consume_dis.h"

#include <stdlib.h>

static uint64_t big(const uint8_t *at, int octets)
{
    uint64_t value = 0;
    for (int i = 0; i < octets; i++) value = value << 8 | at[i];
    return value;
}

static double f32(const uint8_t *at)
{
    const uint32_t bits = (uint32_t)big(at, 4);
    float          value;
    memcpy(&value, &bits, 4);
    return value;
}

static double f64(const uint8_t *at)
{
    const uint64_t bits = big(at, 8);
    double         value;
    memcpy(&value, &bits, 8);
    return value;
}

/* Value of the fixed datum of that id; fails when there is none. */
static uint32_t fixed(const uint8_t *pdu, uint32_t id)
{
    for (uint32_t i = 0; i < big(pdu + 32, 4); i++)
        if (big(pdu + 40 + 8 * i, 4) == id) return (uint32_t)big(pdu + 44 + 8 * i, 4);
    fail_msg("no fixed datum %u", id);
    return 0;
}

/* The value of the n-th variable datum of that id, NULL: none; its bits. */
static const uint8_t *variable(uint32_t *bits, const uint8_t *pdu, size_t octets, uint32_t id, int n)
{
    const uint8_t *at = pdu + 40 + 8 * big(pdu + 32, 4);
    for (uint32_t i = 0; i < big(pdu + 36, 4); i++) {
        const uint32_t here = (uint32_t)big(at, 4);
        *bits = (uint32_t)big(at + 4, 4);
        if (here == id && n-- == 0) return at + 8;
        at += 8 + (*bits + 63) / 64 * 8;
        CHECK(at <= pdu + octets);
    }
    return NULL;
}

enum { most_targets = 60 };
static TargetRecord   target[most_targets];
static SnapshotEntity entity[most_targets + 1];
static Snapshot       snapshot = {.entity = entity};
static RenderRequest  request = {.bands = 15, .view = {.width = 720, .height = 486, .focal_px = 6868.6}};
static Sun            sun;

/* Target i is entity 1:2:(100 + i), has 10 * (i + 1) pixels; those below `hidden` have none. */
static FrameRecord frame_of(int targets, int hidden)
{
    for (int i = 0; i < targets; i++) {
        entity[i].id = (DisEntityId){1, 2, (uint16_t)(100 + i)};
        target[i] = (TargetRecord){.index = i,
                                   .id = entity[i].id,
                                   .range_m = 1000 + i,
                                   .closing_mps = 200,
                                   .aspect_rad = 0.5,
                                   .los_az_rad = 1.25,
                                   .los_el_rad = -0.125,
                                   .boresight_error_rad = {0.015625, -0.03125},
                                   .pixels = i < hidden ? 0 : 10 * (i + 1),
                                   .visible_fraction = 0.75,
                                   .box = {i, 2, i + 3, 4}};
        for (int b = 0; b < BAND_COUNT; b++)
            target[i].band[b] = (TargetBand){
                .contrast_k = b == BAND_LWIR ? 3.5 : NAN, .contrast = b == BAND_OPTICAL ? 0.25 : NAN, .snr = 25};
    }
    entity[targets].id = (DisEntityId){7, 8, 9};
    snapshot.count = targets + 1;
    /* the camera looks north along the equator's meridian 0: forward +z, right +y (east), down -x */
    FrameRecord r = {.frame = 123456,
                     .time_s = 1392.4,
                     .snapshot = &snapshot,
                     .host = &entity[targets],
                     .p_eye_ecef = {6378137.25, -2, 3},
                     .request = &request,
                     .hfov_rad = 0.104719755,
                     .r_ecef_from_cam = {0, -1, 0, 1, 0, 0, 0, 0, 1},
                     .sun = &sun,
                     .target = target,
                     .target_count = targets};
    return r;
}

static const DisRecordSender sender = {
    .version = 7, .exercise = 33, .site = 4711, .application = 1, .timestamp = 0x12345678};

static void the_frame_is_where_the_description_says(void **state)
{
    (void)state;
    const FrameRecord r = frame_of(3, 0);
    uint8_t           pdu[dis_smallest_mtu];
    uint32_t          bits;
    const size_t      n = dis_record_frame(pdu, &sender, &r, BAND_LWIR, false);
    CHECK(n > 0 && n <= 1400 && big(pdu + 8, 2) == n);
    CHECK(pdu[0] == 7 && pdu[1] == 33 && pdu[2] == 20 && pdu[3] == 5 && big(pdu + 4, 4) == 0x12345678);
    CHECK(big(pdu + 12, 2) == 4711 && big(pdu + 14, 2) == 1 && big(pdu + 16, 2) == 0);
    CHECK(big(pdu + 18, 6) == 0xFFFFFFFFFFFF);
    CHECK(fixed(pdu, 600001) == 123456 && fixed(pdu, 600002) == 2 && fixed(pdu, 600003) == 1);
    CHECK(fixed(pdu, 600004) == (720u << 16 | 486));
    CHECK(fixed(pdu, 600007) == 3 && fixed(pdu, 600008) == 0);
    const uint32_t hfov = fixed(pdu, 600005), vfov = fixed(pdu, 600006);
    const uint8_t  hfov_at[4] = {(uint8_t)(hfov >> 24), (uint8_t)(hfov >> 16), (uint8_t)(hfov >> 8), (uint8_t)hfov};
    const uint8_t  vfov_at[4] = {(uint8_t)(vfov >> 24), (uint8_t)(vfov >> 16), (uint8_t)(vfov >> 8), (uint8_t)vfov};
    CHECK_NEAR(f32(hfov_at), 0.104719755, 1e-8); /* a float's rounding */
    CHECK_NEAR(f32(vfov_at), 2 * atan(243 / 6868.6), 1e-8);
    CHECK_NEAR(f64(variable(&bits, pdu, n, 600101, 0)), 1392.4, 0);
    CHECK(bits == 64);
    const uint8_t *eye = variable(&bits, pdu, n, 600102, 0), *camera;
    CHECK(bits == 192 && f64(eye) == 6378137.25 && f64(eye + 8) == -2 && f64(eye + 16) == 3);
    /* a body at 0 N 0 E heading north and level: theta = -90 degrees turns x to the pole; psi and phi are one angle
     * there, and their sum is 180 degrees (the belly, z, looks to -x) */
    camera = variable(&bits, pdu, n, 600103, 0);
    CHECK(bits == 192);
    double forward[3] = {cos(f64(camera + 8)) * cos(f64(camera)), cos(f64(camera + 8)) * sin(f64(camera)),
                         -sin(f64(camera + 8))};
    CHECK_NEAR(forward[0], 0, 1e-7); /* at the pole of Euler angles half the digits are lost */
    CHECK_NEAR(forward[1], 0, 1e-7);
    CHECK_NEAR(forward[2], 1, 1e-14);
    const uint8_t *host = variable(&bits, pdu, n, 600104, 0);
    CHECK(bits == 64 && big(host, 8) == 0x0007000800090000);
}

/* A camera turned by 0.7, -0.4 and 1.1 rad about the axes of Earth as DIS does it (IEEE 1278.1, 1.6.3.3): psi about z,
 * then theta about y, then phi about x. Boresight, right and down are the body's x, y and z. */
static void the_camera_has_its_euler_angles(void **state)
{
    (void)state;
    FrameRecord  r = frame_of(0, 0);
    const double p = 0.7, q = -0.4, s = 1.1;
    const double body[9] = {cos(q) * cos(p),
                            sin(s) * sin(q) * cos(p) - cos(s) * sin(p),
                            cos(s) * sin(q) * cos(p) + sin(s) * sin(p),
                            cos(q) * sin(p),
                            sin(s) * sin(q) * sin(p) + cos(s) * cos(p),
                            cos(s) * sin(q) * sin(p) - sin(s) * cos(p),
                            -sin(q),
                            sin(s) * cos(q),
                            cos(s) * cos(q)};
    uint8_t      pdu[dis_smallest_mtu];
    uint32_t     bits;
    for (int k = 0; k < 9; k++) r.r_ecef_from_cam[k] = body[k / 3 * 3 + (k % 3 + 1) % 3];
    const size_t   n = dis_record_frame(pdu, &sender, &r, BAND_LWIR, false);
    const uint8_t *camera = variable(&bits, pdu, n, 600103, 0);
    CHECK_NEAR(f64(camera), p, 1e-12);
    CHECK_NEAR(f64(camera + 8), q, 1e-12);
    CHECK_NEAR(f64(camera + 16), s, 1e-12);
}

/* The largest first, of equal ones in the order of the list, wherever they stand in it. */
static void the_largest_come_first(void **state)
{
    (void)state;
    static const double pixels[6] = {50, 7, 50, 90, 7, 50};
    static const int    order[6] = {3, 0, 2, 5, 1, 4};
    const FrameRecord   r = frame_of(6, 0);
    uint8_t             pdu[dis_smallest_mtu];
    uint32_t            bits;
    for (int i = 0; i < 6; i++) target[i].pixels = pixels[i];
    const size_t n = dis_record_frame(pdu, &sender, &r, BAND_LWIR, true);
    for (int i = 0; i < 6; i++) CHECK(big(variable(&bits, pdu, n, 600202, i) + 4, 2) == 100u + (unsigned)order[i]);
}

static void a_seeker_tells_no_names(void **state)
{
    (void)state;
    const FrameRecord r = frame_of(3, 1);
    uint8_t           pdu[dis_smallest_mtu];
    uint32_t          bits;
    size_t            n = dis_record_frame(pdu, &sender, &r, BAND_LWIR, false);
    CHECK(fixed(pdu, 600007) == 2 && fixed(pdu, 600008) == 0); /* the hidden one is not there */
    CHECK(!variable(&bits, pdu, n, 600202, 0) && !variable(&bits, pdu, n, 600201, 2));
    const uint8_t *t = variable(&bits, pdu, n, 600201, 0); /* the largest: target 2 */
    CHECK(bits == 288 && big(t, 2) == 2 && big(t + 2, 2) == 2 && big(t + 4, 2) == 5 && big(t + 6, 2) == 4);
    CHECK(f32(t + 8) == 30 && f32(t + 12) == 0.015625 && f32(t + 16) == -0.03125);
    CHECK(f32(t + 20) == 3.5 && f32(t + 24) == 25 && isnan(f32(t + 28)) && isnan(f32(t + 32)));
    n = dis_record_frame(pdu, &sender, &r, BAND_RADAR, false);
    t = variable(&bits, pdu, n, 600201, 0);
    CHECK(isnan(f32(t + 20)) && f32(t + 28) == 1002 && f32(t + 32) == 200);
    n = dis_record_frame(pdu, &sender, &r, BAND_OPTICAL, false);
    t = variable(&bits, pdu, n, 600201, 0);
    CHECK(f32(t + 20) == 0.25 && isnan(f32(t + 28)));
    /* nowhere in any of them: the id of a target */
    static const uint8_t id[6] = {0, 1, 0, 2, 0, 102};
    for (size_t i = 0; i + 6 <= n; i++) CHECK(memcmp(pdu + i, id, 6) != 0);
}

static void truth_tells_all(void **state)
{
    (void)state;
    const FrameRecord r = frame_of(3, 1);
    uint8_t           pdu[dis_smallest_mtu];
    uint32_t          bits;
    const size_t      n = dis_record_frame(pdu, &sender, &r, BAND_OPTICAL, true);
    CHECK(fixed(pdu, 600003) == 2 && fixed(pdu, 600007) == 3);
    const uint8_t *t = variable(&bits, pdu, n, 600202, 0);
    CHECK(bits == 448 && big(t, 8) == 0x0001000200660000 && big(t + 8, 2) == 2 && big(t + 14, 2) == 4);
    CHECK(f32(t + 16) == 30 && f32(t + 20) == 0.75 && f32(t + 24) == 1002 && f32(t + 28) == 200 && f32(t + 32) == 0.5);
    CHECK(f32(t + 36) == 1.25 && f32(t + 40) == -0.125 && f32(t + 44) == 0.015625 && f32(t + 48) == -0.03125 &&
          f32(t + 52) == 25);
    t = variable(&bits, pdu, n, 600202, 2); /* hidden, and said so */
    CHECK(big(t, 8) == 0x0001000200640000 && f32(t + 16) == 0);
}

static void what_has_no_room_is_counted_the_smallest_first(void **state)
{
    (void)state;
    uint8_t  pdu[dis_smallest_mtu];
    uint32_t bits;
    for (int truth = 0; truth <= 1; truth++)
        for (int targets = 0; targets <= most_targets; targets++) {
            const FrameRecord r = frame_of(targets, 0);
            const size_t      n = dis_record_frame(pdu, &sender, &r, BAND_MWIR, truth);
            const uint32_t    in = fixed(pdu, 600007);
            CHECK(n > 0 && n <= 1400 && in + fixed(pdu, 600008) == (uint32_t)targets);
            /* 1400 octets, less 40 of the PDU's head, 64 of eight fixed datums, 16 + 32 + 32 + 16 of four variable
             * ones: 1200, of 8 + 56 or of 8 + 36, filled up to 40, each */
            const int most = truth ? 18 : 25;
            CHECK(in == (uint32_t)(targets < most ? targets : most));
            for (uint32_t i = 0; i < in; i++) {
                const uint8_t *t = variable(&bits, pdu, n, truth ? 600202 : 600201, (int)i);
                CHECK(t && f32(t + (truth ? 16 : 8)) == 10 * (targets - (int)i));
            }
            DisPdu back;
            CHECK(dis_decode(&back, pdu, n) == STATUS_OK && back.type == dis_pdu_data);
        }
}

/* ---- a radar ---- */

enum { most_detections = 300 };
static Detection         detection[most_detections];
static const RadarPreset preset = {.name = "paper",
                                   .wave = {.centre_hz = 35e9, .bandwidth_hz = 150e6, .samples = 256, .pulses = 64}};

static RadarFrame radar_of(int detections, int in_all)
{
    for (int i = 0; i < detections; i++)
        detection[i] = (Detection){.range_m = 3000.25 + i,
                                   .range_rate_mps = -7.5,
                                   .cos_right = 0.5,
                                   .cos_down = -0.0625,
                                   .snr = 1000,
                                   .rcs_m2 = 0.01};
    return (RadarFrame){.preset = &preset,
                        .reference_m = 3001.125,
                        .reference_rate_mps = -200,
                        .map = {.rows = 64, .columns = 256, .metre_per_column = 1.5, .mps_per_row = 0.5},
                        .detections = detections,
                        .detections_in_all = in_all,
                        .detection = detection};
}

static void detections_are_where_the_description_says(void **state)
{
    (void)state;
    FrameRecord      r = frame_of(0, 0);
    const RadarFrame radar = radar_of(3, 3);
    uint8_t          pdu[dis_smallest_mtu];
    uint32_t         bits;
    r.radar = &radar;
    CHECK(dis_record_radar_count(&r) == 1);
    const size_t n = dis_record_radar(pdu, &sender, &r, 0);
    CHECK(n > 0 && big(pdu + 8, 2) == n && pdu[2] == 20 && big(pdu + 32, 4) == 5 && big(pdu + 36, 4) == 4 + 1 + 3);
    CHECK(fixed(pdu, 600001) == 123456 && fixed(pdu, 600003) == 4);
    CHECK(fixed(pdu, 600012) == 3 && fixed(pdu, 600013) == 0 && fixed(pdu, 600014) == 1);
    CHECK_NEAR(f64(variable(&bits, pdu, n, 600101, 0)), 1392.4, 0);
    CHECK(f64(variable(&bits, pdu, n, 600102, 0)) == 6378137.25);
    CHECK(variable(&bits, pdu, n, 600103, 0) && bits == 192);
    CHECK(big(variable(&bits, pdu, n, 600104, 0), 8) == 0x0007000800090000);
    const uint8_t *of = variable(&bits, pdu, n, 600401, 0);
    CHECK(bits == 256 && f64(of) == 35e9 && f64(of + 8) == 3001.125 && f32(of + 16) == 150e6 && f32(of + 20) == -200);
    CHECK(f32(of + 24) == 384 && f32(of + 28) == 32);
    const uint8_t *d = variable(&bits, pdu, n, 600402, 2);
    CHECK(bits == 192 && f32(d) == 3002.25 && f32(d + 4) == -7.5);
    CHECK_NEAR(f32(d + 8), 0.52359877559829887, 3e-8); /* 30 degrees to the right */
    CHECK_NEAR(f32(d + 12), 0.06254076, 1e-8);         /* asin(1/16), up */
    CHECK_NEAR(f32(d + 16), 30, 0);
    CHECK_NEAR(f32(d + 20), -20, 0);
}

/* Every number of detections: in order over the frame's PDUs, none twice, the rest counted. */
static void many_detections_take_several(void **state)
{
    (void)state;
    FrameRecord r = frame_of(0, 0);
    uint8_t     pdu[dis_smallest_mtu];
    uint32_t    bits;
    for (int all = 0; all <= most_detections; all++) {
        const int        kept = all < 256 ? all : 256, sent = all < 128 ? all : 128;
        const RadarFrame radar = radar_of(kept, all);
        int              next = 0;
        r.radar = &radar;
        const int count = dis_record_radar_count(&r);
        CHECK(count == (sent > 0 ? (sent + 31) / 32 : 1));
        for (int k = 0; k < count; k++) {
            const size_t n = dis_record_radar(pdu, &sender, &r, k);
            DisPdu       back;
            CHECK(n > 0 && n <= 1400 && dis_decode(&back, pdu, n) == STATUS_OK && back.type == dis_pdu_data);
            CHECK(fixed(pdu, 600014) == ((uint32_t)k << 16 | (uint32_t)count) &&
                  fixed(pdu, 600013) == (uint32_t)(all - sent));
            for (uint32_t i = 0; i < fixed(pdu, 600012); i++)
                CHECK(f32(variable(&bits, pdu, n, 600402, (int)i)) == (double)(float)(3000.25 + next++));
            CHECK(!variable(&bits, pdu, n, 600402, (int)fixed(pdu, 600012)));
        }
        CHECK(next == sent);
    }
}

/* ---- a consumer ---- */

enum { most_sent = 64 };
typedef struct Sent {
    int     count;
    uint8_t pdu[most_sent][dis_smallest_mtu];
    size_t  octets[most_sent];
    Status  result;
} Sent;

static Status take(void *user, const uint8_t *pdu, size_t octets)
{
    Sent *sent = user;
    CHECK(sent->count < most_sent && octets > 0);
    memcpy(sent->pdu[sent->count], pdu, octets);
    sent->octets[sent->count++] = octets;
    return sent->result;
}

static double half_a_minute_later(const void *clock, double t_s)
{
    CHECK(clock == &sun);
    return t_s + 30;
}

/* Frames at these times, two bands. */
static Sent *send_frames(Config *config, const double *time_s, int count, Status result)
{
    Sent     *sent = calloc(1, sizeof *sent);
    Consumer *consumer;
    CHECK(sent);
    sent->result = result;
    const DisOf of = {.config = config,
                      .bands = 1u << BAND_OPTICAL | 1u << BAND_LWIR,
                      .version = 6,
                      .exercise = 9,
                      .send = take,
                      .user = sent,
                      .arrival_s = half_a_minute_later,
                      .clock = &sun};
    CHECK(consume_dis(&consumer, &of) == STATUS_OK && consumer->wants == WANT_TARGETS);
    for (int i = 0; i < count; i++) {
        Frame frame = {.record = frame_of(3, 0)};
        frame.record.frame = i;
        frame.record.time_s = time_s[i];
        CHECK(consumer->put(consumer, &frame) == STATUS_OK); /* also when nothing can be sent */
    }
    CHECK(consumer->close(consumer) == STATUS_OK);
    return sent;
}

/* Behind the frame's bands, whichever kind those are of. */
static void a_consumer_sends_detections(void **state)
{
    (void)state;
    const RadarFrame radar = radar_of(40, 41);
    Config           config = config_default();
    for (int truth = 0; truth <= 1; truth++) {
        Sent     *sent = calloc(1, sizeof *sent);
        Consumer *consumer;
        Frame     frame = {.record = frame_of(3, 0)};
        config.publish.dis = truth ? PUBLISH_DIS_TRUTH : PUBLISH_DIS_SENSOR;
        const DisOf of = {.config = &config,
                          .bands = 1u << BAND_LWIR,
                          .version = 7,
                          .exercise = 33,
                          .send = take,
                          .user = sent,
                          .arrival_s = half_a_minute_later,
                          .clock = &sun};
        CHECK(sent && consume_dis(&consumer, &of) == STATUS_OK);
        frame.record.radar = &radar;
        CHECK(consumer->put(consumer, &frame) == STATUS_OK && consumer->close(consumer) == STATUS_OK);
        CHECK(sent->count == 3);
        CHECK(fixed(sent->pdu[0], 600003) == (truth ? 2u : 1u));
        CHECK(fixed(sent->pdu[1], 600003) == 4 && fixed(sent->pdu[1], 600012) == 32);
        CHECK(fixed(sent->pdu[2], 600003) == 4 && fixed(sent->pdu[2], 600012) == 8 && fixed(sent->pdu[2], 600013) == 1);
        free(sent);
    }
}

static void a_consumer_sends_each_frame_and_band(void **state)
{
    (void)state;
    static const double time_s[2] = {100, 100.5};
    Config              config = config_default();
    for (int truth = 0; truth <= 1; truth++) {
        config.publish.dis = truth ? PUBLISH_DIS_TRUTH : PUBLISH_DIS_SENSOR;
        Sent *sent = send_frames(&config, time_s, 2, truth ? STATUS_IO : STATUS_OK);
        CHECK(sent->count == 4);
        for (int i = 0; i < 4; i++) {
            const uint8_t *pdu = sent->pdu[i];
            uint8_t        want[dis_smallest_mtu];
            CHECK(fixed(pdu, 600001) == (uint32_t)i / 2 && fixed(pdu, 600002) == (i % 2 ? 2u : 0u));
            CHECK(fixed(pdu, 600003) == (truth ? 2u : 1u) && pdu[0] == 6 && pdu[1] == 9);
            /* past the hour, in steps of an hour / 2^31; relative: the lowest bit is 0 */
            CHECK_NEAR((double)(big(pdu + 4, 4) >> 1) * 3600 / 2147483648.0, time_s[i / 2] + 30, 2e-6);
            CHECK((pdu[7] & 1) == 0);
            const DisRecordSender node = {6, 9, 4711, 1, (uint32_t)big(pdu + 4, 4)};
            FrameRecord           r = frame_of(3, 0);
            r.frame = i / 2;
            r.time_s = time_s[i / 2];
            CHECK(dis_record_frame(want, &node, &r, i % 2 ? BAND_LWIR : BAND_OPTICAL, truth) == sent->octets[i]);
            CHECK(memcmp(want, pdu, sent->octets[i]) == 0);
        }
        free(sent);
    }
}

/* With the first frame, then with the first one of each 5 s of exercise time; before the frame's own. */
static void streams_are_announced(void **state)
{
    (void)state;
    static const double time_s[] = {1353.5, 1354.9, 1355, 1359.99, 1366, 1366.5, 1370};
    static const bool   due[] = {true, false, true, false, true, false, true};
    enum { frames = sizeof due / sizeof *due };
    Config   config = config_default();
    uint32_t bits;
    config.publish.dis = PUBLISH_DIS_SENSOR;
    strcpy(config.publish.stream, "udp://239.1.2.3:5004");
    config.publish.video_codec = VIDEO_HEVC_12;
    config.publish.klv = KLV_SYNC;
    config.publish.vmti = VMTI_ATR;
    Sent *sent = send_frames(&config, time_s, frames, STATUS_OK);
    int   at = 0;
    for (int i = 0; i < frames; i++) {
        for (int k = 0; due[i] && k < 2; k++, at++) {
            static const char *const url[2] = {"udp://239.1.2.3:5004", "udp://239.1.2.3:5006"};
            const uint8_t           *pdu = sent->pdu[at], *text;
            CHECK(big(pdu + 8, 2) == sent->octets[at]);
            CHECK(big(pdu + 32, 4) == 8 && fixed(pdu, 600002) == (k ? 2u : 0u) && fixed(pdu, 600003) == 3);
            CHECK(fixed(pdu, 600004) == (720u << 16 | 486));
            CHECK(fixed(pdu, 600009) == 3 && fixed(pdu, 600010) == 2 && fixed(pdu, 600011) == 1);
            CHECK_NEAR(f64(variable(&bits, pdu, sent->octets[at], 600101, 0)), time_s[i], 0);
            CHECK(big(variable(&bits, pdu, sent->octets[at], 600104, 0), 8) == 0x0007000800090000);
            text = variable(&bits, pdu, sent->octets[at], 600301, 0);
            CHECK(text && bits == 8 * strlen(url[k]) && memcmp(text, url[k], bits / 8) == 0);
            DisPdu back;
            CHECK(dis_decode(&back, pdu, sent->octets[at]) == STATUS_OK && back.type == dis_pdu_data);
        }
        for (int k = 0; k < 2; k++, at++) CHECK(fixed(sent->pdu[at], 600001) == (uint32_t)i);
    }
    CHECK(at == sent->count);
    free(sent);
    /* codes of the announcement: codec, metadata, targets */
    static const int codec[][2] = {{VIDEO_H264, 1}, {VIDEO_H264_10, 2}, {VIDEO_HEVC_12, 3}, {VIDEO_FFV1, 4}},
                     klv[][2] = {{KLV_ASYNC, 1}, {KLV_SYNC, 2}, {KLV_ASYNC, 1}, {KLV_SYNC, 2}},
                     vmti[][2] = {{VMTI_OFF, 0}, {VMTI_ATR, 1}, {VMTI_TRUTH, 2}, {VMTI_OFF, 0}};
    for (int k = 0; k < 4; k++) {
        config.publish.video_codec = codec[k][0], config.publish.klv = klv[k][0], config.publish.vmti = vmti[k][0];
        sent = send_frames(&config, time_s, 1, STATUS_OK);
        CHECK(fixed(sent->pdu[0], 600009) == (uint32_t)codec[k][1] &&
              fixed(sent->pdu[0], 600010) == (uint32_t)klv[k][1] &&
              fixed(sent->pdu[0], 600011) == (uint32_t)vmti[k][1]);
        free(sent);
    }
    config.publish.klv = KLV_OFF; /* so there are no targets either */
    sent = send_frames(&config, time_s, 1, STATUS_OK);
    CHECK(fixed(sent->pdu[0], 600010) == 0 && fixed(sent->pdu[0], 600011) == 0);
    free(sent);
    strcpy(config.publish.stream, "udp://10.0.0.1:65534"); /* the second would be at 65536 */
    sent = send_frames(&config, time_s, 1, STATUS_OK);
    CHECK(sent->count == 3);
    free(sent);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_frame_is_where_the_description_says),
        cmocka_unit_test(the_camera_has_its_euler_angles),
        cmocka_unit_test(the_largest_come_first),
        cmocka_unit_test(a_seeker_tells_no_names),
        cmocka_unit_test(truth_tells_all),
        cmocka_unit_test(what_has_no_room_is_counted_the_smallest_first),
        cmocka_unit_test(detections_are_where_the_description_says),
        cmocka_unit_test(many_detections_take_several),
        cmocka_unit_test(a_consumer_sends_detections),
        cmocka_unit_test(a_consumer_sends_each_frame_and_band),
        cmocka_unit_test(streams_are_announced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
