/* sensor/publish/dis/consume_dis.c: Data PDUs of each frame, of its radar's detections and of the video streams, and
 * the consumer that sends them. */
#include "sensor/publish/dis/consume_dis.h"
#include "dis/pdu/octets.h"
#include "sensor/settings/publish_choice.h"
#include "dis/clock/exercise_clock.h"

#include <stdlib.h>

enum { seen_octets = 36, truth_octets = 56, datum_head_octets = 8, target_room = 2048 };

/* Values of variable datums are assembled here first; big-endian. */
typedef struct Octets {
    uint8_t at[target_room];
    size_t  used;
} Octets;

static void put(Octets *o, uint64_t value, int count)
{
    for (int i = count - 1; i >= 0; i--) o->at[o->used++] = (uint8_t)(value >> (8 * i));
}

static void put_f64(Octets *o, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(o, bits, 8);
}

static uint32_t f32_bits(double value)
{
    const float narrow = isnan(value) ? NAN : (float)value; /* one NaN, whatever its payload */
    uint32_t    bits;
    memcpy(&bits, &narrow, sizeof bits);
    return bits;
}

static void put_f32(Octets *o, double value) { put(o, f32_bits(value), 4); }

static void put_id(Octets *o, DisEntityId id)
{
    put(o, id.site, 2);
    put(o, id.application, 2);
    put(o, id.entity, 2);
    put(o, 0, 2);
}

static void put_box(Octets *o, const int box[4])
{
    uint16_t edge[4];
    target_box_u16(edge, box);
    for (int k = 0; k < 4; k++) put(o, edge[k], 2);
}

static void add_fixed(DisData *pdu, uint32_t id, uint32_t value)
{
    pdu->fixed[pdu->fixed_count++] = (DisFixedDatum){id, value};
}

/* Adds the octets written since `from`. */
static void add_variable(DisData *pdu, uint32_t id, const Octets *o, size_t from)
{
    pdu->variable[pdu->variable_count++] =
        (DisVariableDatum){.id = id, .bits = (uint32_t)(8 * (o->used - from)), .value = o->at + from};
}

static void put_seen(Octets *o, const TargetRecord *t, Band band)
{
    const bool thermal = band == BAND_MWIR || band == BAND_LWIR;
    put_box(o, t->box);
    put_f32(o, t->pixels);
    put_f32(o, t->boresight_error_rad[0]);
    put_f32(o, t->boresight_error_rad[1]);
    put_f32(o, thermal ? t->band[band].contrast_k : t->band[band].contrast);
    put_f32(o, t->band[band].snr);
    put_f32(o, band == BAND_RADAR ? t->range_m : NAN);
    put_f32(o, band == BAND_RADAR ? t->closing_mps : NAN);
}

static void put_truth(Octets *o, const TargetRecord *t, Band band)
{
    put_id(o, t->id);
    put_box(o, t->box);
    put_f32(o, t->pixels);
    put_f32(o, t->visible_fraction);
    put_f32(o, t->range_m);
    put_f32(o, t->closing_mps);
    put_f32(o, t->aspect_rad);
    put_f32(o, t->los_az_rad);
    put_f32(o, t->los_el_rad);
    put_f32(o, t->boresight_error_rad[0]);
    put_f32(o, t->boresight_error_rad[1]);
    put_f32(o, t->band[band].snr);
}

/* Largest first, then in the order of the list; its index in list. */
static int next_largest(const FrameRecord *r, const int *chosen, int count, bool truth)
{
    int best = -1;
    for (int i = 0; i < r->target_count; i++) {
        bool taken = !truth && !(r->target[i].pixels > 0); /* a hidden target is not measured */
        for (int k = 0; k < count; k++) taken |= chosen[k] == i;
        if (!taken && (best < 0 || r->target[i].pixels > r->target[best].pixels)) best = i;
    }
    return best;
}

static void add_targets(DisData *pdu, Octets *o, const FrameRecord *r, Band band, bool truth)
{
    enum { most = 32 };
    const size_t one = (size_t)(datum_head_octets + ((truth ? truth_octets : seen_octets) + 7) / 8 * 8);
    size_t       room = dis_smallest_mtu - 40 - 8 * 8 - (8 + 8) - 2 * (8 + 24) - (8 + 8);
    int          chosen[most], count = 0, all = 0;
    for (int i = 0; i < r->target_count; i++) all += truth || r->target[i].pixels > 0;
    for (int i; count < most && room >= one && (i = next_largest(r, chosen, count, truth)) >= 0; room -= one) {
        const size_t from = o->used;
        chosen[count++] = i;
        if (truth) put_truth(o, &r->target[i], band);
        else put_seen(o, &r->target[i], band);
        add_variable(pdu, truth ? datum_truth : datum_target_measured, o, from);
    }
    add_fixed(pdu, datum_targets, (uint32_t)count);
    add_fixed(pdu, datum_left_out, (uint32_t)(all - count));
}

/* Columns of the camera's axes in the order of a body's: forward, right, down. */
static void put_camera(Octets *o, const double r_ecef_from_cam[9])
{
    double r_ecef_from_body[9], psi_rad, theta_rad, phi_rad;
    for (int k = 0; k < 3; k++) {
        r_ecef_from_body[3 * k] = r_ecef_from_cam[3 * k + 2];
        r_ecef_from_body[3 * k + 1] = r_ecef_from_cam[3 * k];
        r_ecef_from_body[3 * k + 2] = r_ecef_from_cam[3 * k + 1];
    }
    euler_from_r_ecef_from_body(&psi_rad, &theta_rad, &phi_rad, r_ecef_from_body);
    put_f64(o, psi_rad);
    put_f64(o, theta_rad);
    put_f64(o, phi_rad);
}

/* What all PDUs begin with. */
static DisData data_pdu(const DisRecordSender *sender)
{
    enum { simulation_management = 5 };
    return (DisData){.header = {.version = sender->version,
                                .exercise = sender->exercise,
                                .type = dis_pdu_data,
                                .family = simulation_management,
                                .timestamp = sender->timestamp},
                     .originating = {sender->site, sender->application, 0},
                     .receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
}

static void add_image(DisData *pdu, const FrameRecord *r)
{
    const View *view = &r->request->view;
    add_fixed(pdu, datum_raster, (uint32_t)view->width << 16 | (uint32_t)view->height);
    add_fixed(pdu, datum_hfov, f32_bits(r->hfov_rad));
    add_fixed(pdu, datum_vfov, f32_bits(2 * atan(0.5 * view->height / view->focal_px)));
}

static void add_time(DisData *pdu, Octets *o, const FrameRecord *r)
{
    const size_t from = o->used;
    put_f64(o, r->time_s);
    add_variable(pdu, datum_time, o, from);
}

static void add_host(DisData *pdu, Octets *o, const FrameRecord *r)
{
    const size_t from = o->used;
    put_id(o, r->host ? r->host->id : (DisEntityId){0});
    add_variable(pdu, datum_host, o, from);
}

static void add_pose(DisData *pdu, Octets *o, const FrameRecord *r)
{
    size_t from = o->used;
    for (int k = 0; k < 3; k++) put_f64(o, r->p_eye_ecef[k]);
    add_variable(pdu, datum_sensor_position, o, from);
    from = o->used;
    put_camera(o, r->r_ecef_from_cam);
    add_variable(pdu, datum_camera, o, from);
}

size_t dis_record_frame(uint8_t out[dis_smallest_mtu], const DisRecordSender *sender, const FrameRecord *r, Band band,
                        bool truth)
{
    Octets  o = {.used = 0};
    DisData pdu = data_pdu(sender);
    add_fixed(&pdu, datum_frame, (uint32_t)r->frame);
    add_fixed(&pdu, datum_band, (uint32_t)band);
    add_fixed(&pdu, datum_kind, truth ? datum_kind_truth : datum_kind_sensor);
    add_image(&pdu, r);
    add_time(&pdu, &o, r);
    add_pose(&pdu, &o, r);
    add_host(&pdu, &o, r);
    add_targets(&pdu, &o, r, band, truth);
    return dis_encode_data(out, dis_smallest_mtu, &pdu);
}

enum { detections_a_pdu = 32, radar_pdus_most = 4 };

static int detections_sent(const RadarFrame *radar)
{
    return radar->detections < radar_pdus_most * detections_a_pdu ? radar->detections
                                                                  : radar_pdus_most * detections_a_pdu;
}

int dis_record_radar_count(const FrameRecord *r)
{
    const int count = (detections_sent(r->radar) + detections_a_pdu - 1) / detections_a_pdu;
    return count > 0 ? count : 1;
}

static void put_radar(Octets *o, const RadarFrame *radar)
{
    put_f64(o, radar->preset->wave.centre_hz);
    put_f64(o, radar->reference_m);
    put_f32(o, radar->preset->wave.bandwidth_hz);
    put_f32(o, radar->reference_rate_mps);
    put_f32(o, radar->map.columns * radar->map.metre_per_column);
    put_f32(o, radar->map.rows * radar->map.mps_per_row);
}

static void put_detection(Octets *o, const Detection *d)
{
    put_f32(o, d->range_m);
    put_f32(o, d->range_rate_mps);
    put_f32(o, asin(clamp(d->cos_right, -1, 1)));
    put_f32(o, -asin(clamp(d->cos_down, -1, 1)));
    put_f32(o, 10 * log10(d->snr));
    put_f32(o, 10 * log10(d->rcs_m2));
}

size_t dis_record_radar(uint8_t out[dis_smallest_mtu], const DisRecordSender *sender, const FrameRecord *r, int n)
{
    const RadarFrame *radar = r->radar;
    const int         all = detections_sent(radar), first = n * detections_a_pdu;
    const int         count = all - first < detections_a_pdu ? all - first : detections_a_pdu;
    Octets            o = {.used = 0};
    DisData           pdu = data_pdu(sender);
    add_fixed(&pdu, datum_frame, (uint32_t)r->frame);
    add_fixed(&pdu, datum_kind, datum_kind_radar);
    add_fixed(&pdu, datum_detections, (uint32_t)count);
    add_fixed(&pdu, datum_detections_omitted, (uint32_t)(radar->detections_in_all - all));
    add_fixed(&pdu, datum_radar_pdu, (uint32_t)n << 16 | (uint32_t)dis_record_radar_count(r));
    add_time(&pdu, &o, r);
    add_pose(&pdu, &o, r);
    add_host(&pdu, &o, r);
    size_t from = o.used;
    put_radar(&o, radar);
    add_variable(&pdu, datum_radar, &o, from);
    for (int i = first; i < first + count; i++) {
        from = o.used;
        put_detection(&o, &radar->detection[i]);
        add_variable(&pdu, datum_detection, &o, from);
    }
    return dis_encode_data(out, dis_smallest_mtu, &pdu);
}

/* The announcement of the band's video stream, which is number `stream` of the run's, from 0, by publish.stream,
 * video_codec, klv and vmti. 0: there is no such stream. */
static size_t dis_record_stream(uint8_t out[dis_smallest_mtu], const DisRecordSender *sender, const FrameRecord *r,
                                Band band, const Config *config, int stream)
{
    static const uint32_t codec[] = {[VIDEO_H264] = 1, [VIDEO_H264_10] = 2, [VIDEO_HEVC_12] = 3, [VIDEO_FFV1] = 4},
                          klv[] = {[KLV_OFF] = 0, [KLV_ASYNC] = 1, [KLV_SYNC] = 2},
                          targets[] = {[VMTI_OFF] = 0, [VMTI_ATR] = 1, [VMTI_TRUTH] = 2};
    const bool  no_klv = config->publish.klv == KLV_OFF; /* then it has no targets either */
    const char *why;
    char        text[40];
    StreamUrl   url;
    Octets      o = {.used = 0};
    DisData     pdu = data_pdu(sender);
    if (!publish_stream_parse(&url, &why, config->publish.stream)) return 0;
    const int port = url.port + stream * publish_stream_port_step;
    if (port > UINT16_MAX) return 0;
    add_fixed(&pdu, datum_band, (uint32_t)band);
    add_fixed(&pdu, datum_kind, datum_kind_stream);
    add_image(&pdu, r);
    add_fixed(&pdu, datum_stream_codec, codec[config->publish.video_codec]);
    add_fixed(&pdu, datum_stream_klv, klv[config->publish.klv]);
    add_fixed(&pdu, datum_stream_targets, no_klv ? 0 : targets[config->publish.vmti]);
    add_time(&pdu, &o, r);
    add_host(&pdu, &o, r);
    const size_t from = o.used;
    snprintf(text, sizeof text, "udp://%u.%u.%u.%u:%d", url.address[0], url.address[1], url.address[2], url.address[3],
             port);
    for (const char *at = text; *at; at++) put(&o, (uint8_t)*at, 1);
    add_variable(&pdu, datum_stream_url, &o, from);
    return dis_encode_data(out, dis_smallest_mtu, &pdu);
}

/* ---- the consumer that sends them, and announces the video streams ------------------------------- */

typedef struct Sending {
    Consumer consumer;
    DisOf    of;
    double   announced; /* intervals of dis_announce_s at the last announcement; NaN: none so far */
} Sending;

/* Whether the announcement is due: it goes out with the first frame of each interval of exercise time. */
static bool announcement_is_due(Sending *s, double time_s)
{
    const double interval = floor(time_s / dis_announce_s);
    if (interval == s->announced) return false;
    s->announced = interval;
    return true;
}

static void announce(const Sending *s, const DisRecordSender *sender, const FrameRecord *record)
{
    uint8_t pdu[dis_smallest_mtu];
    int     stream = 0;
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->of.bands >> b & 1) {
            const size_t octets = dis_record_stream(pdu, sender, record, (Band)b, s->of.config, stream++);
            if (octets > 0) s->of.send(s->of.user, pdu, octets);
        }
}

static Status put_frame(Consumer *consumer, Frame *frame)
{
    Sending              *s = (Sending *)consumer;
    const Config         *config = s->of.config;
    const FrameRecord    *record = &frame->record;
    const bool            truth = config->publish.dis == PUBLISH_DIS_TRUTH;
    const DisRecordSender sender = {.version = s->of.version,
                                    .exercise = s->of.exercise,
                                    .site = (uint16_t)config->node.site,
                                    .application = (uint16_t)config->node.application,
                                    .timestamp = dis_timestamp(s->of.arrival_s(s->of.clock, record->time_s), false)};
    uint8_t               pdu[dis_smallest_mtu];
    if (*config->publish.stream && announcement_is_due(s, record->time_s)) announce(s, &sender, record);
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->of.bands >> b & 1) s->of.send(s->of.user, pdu, dis_record_frame(pdu, &sender, record, (Band)b, truth));
    for (int n = 0; record->radar && n < dis_record_radar_count(record); n++)
        s->of.send(s->of.user, pdu, dis_record_radar(pdu, &sender, record, n));
    return STATUS_OK;
}

static Status close_sending(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

Status consume_dis(Consumer **out, const DisOf *of)
{
    Sending *s = malloc(sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    *s = (Sending){.consumer = {WANT_TARGETS, put_frame, NULL, close_sending, "dis"}, .of = *of, .announced = NAN};
    *out = &s->consumer;
    return STATUS_OK;
}
