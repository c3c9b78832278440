/* sensor/publish/dis/consume_dis.h: measurements of the sensor and ground truth, as Data PDUs (type 20) on the
 * exercise: one per frame and band, never more than 1400 octets, to all (0xFFFF), originating site:application:0,
 * request 0.
 *
 * Datum ids are this program's own, experimental, not registered. Numbers are big-endian as all of DIS; f32 and f64
 * are IEEE 754; NaN: not computed.
 *
 *     fixed, 32 bits
 *     600001  frame number, u32
 *     600002  band, u32: 0 optical, 1 mwir, 2 lwir, 3 radar
 *     600003  kind, u32: 1 sensor (measurable by a seeker), 2 truth
 *     600004  raster, u16 columns, u16 rows
 *     600005  horizontal field of view, f32 rad
 *     600006  vertical field of view, f32 rad
 *     600007  targets in this PDU, u32
 *     600008  targets omitted for lack of space, the smallest, u32
 *
 *     variable
 *     600101   64 bits  exercise time of the frame, f64 s
 *     600102  192 bits  sensor position, ECEF, 3 f64 m
 *     600103  192 bits  camera attitude as of a body with x along the boresight, y right, z down: psi, theta, phi
 *                       as in an Entity State, 3 f64 rad
 *     600104   64 bits  host: u16 site, application, entity, 0; 0:0:0: an observer that is no entity
 *     600201  288 bits  kind sensor, one per visible target, largest first:
 *                       0  box of its visible pixels, u16 left, top, right, bottom, the last two beyond it
 *                       8  f32 area, px       12 f32 boresight error right, rad   16 f32 the same up, rad
 *                       20 f32 contrast: K (mwir, lwir), a share (optical, radar) 24 f32 signal to noise
 *                       28 f32 range, m, and 32 f32 closing speed, m/s: radar only, else NaN
 *     600202  448 bits  kind truth, one per target in the field of view, largest first:
 *                       0  u16 site, application, entity, 0                       8  box, as above; 0 0 0 0: hidden
 *                       16 f32 visible area, px   20 f32 visible fraction         24 f32 range, m
 *                       28 f32 closing speed, m/s 32 f32 aspect, rad, 0 nose on   36 f32 line of sight, azimuth from
 *                       40 f32 its elevation, rad                                    north, rad
 *                       44 f32 boresight error right, rad                         48 f32 the same up, rad
 *                       52 f32 signal to noise
 *
 * The announcement of a video stream, one PDU per band and stream, has the datums 600002, 600004 .. 600006, 600101,
 * 600104 and these; no 600001:
 *
 *     fixed, 32 bits
 *     600003  kind, u32: 3 stream
 *     600009  codec, u32: 1 H.264, 8 bits; 2 H.264, 10 bits; 3 HEVC, 12 bits; 4 FFV1, 16 bits. In MPEG-TS
 *     600010  KLV in it (MISB ST 0601), u32: 0 none, 1 asynchronous, 2 synchronous
 *     600011  its targets (MISB ST 0903), u32: 0 none, 1 detections of a recogniser, 2 truth
 *
 *     variable
 *     600301  8 bits per character: address of the stream, ASCII, udp://HOST:PORT
 *
 * What a radar of radar.preset detected in the frame, whatever publish.dis says of the bands: its strongest 128
 * detections, strongest first, 32 a PDU; one PDU where it has none. Datums 600001, 600101 .. 600104 and these; no
 * 600002:
 *
 *     fixed, 32 bits
 *     600003  kind, u32: 4 radar
 *     600012  detections in this PDU, u32
 *     600013  detections of the frame that are in none of its PDUs, the weakest, u32
 *     600014  u16 number of this PDU among those of the frame, from 0, u16 how many they are
 *
 *     variable
 *     600401  256 bits  the radar: 0  f64 centre frequency, Hz         8  f64 range of the middle of its window, m
 *                       16 f32 bandwidth, Hz                           20 f32 range rate of the middle of its map, m/s
 *                       24 f32 length of the window, m                 28 f32 span of range rates of the map, m/s
 *     600402  192 bits  a detection: 0 f32 range, m                    4  f32 range rate, m/s, above 0: receding
 *                       8  f32 azimuth from the boresight, right, rad  12 f32 elevation from it, up, rad
 *                       16 f32 signal to noise, dB                     20 f32 cross section, dBsm */
#ifndef SENSOR_PUBLISH_DIS_CONSUME_DIS_H
#define SENSOR_PUBLISH_DIS_CONSUME_DIS_H

#include "dis/pdu/decode.h"
#include "sensor/frame/records.h"
#include "sensor/settings/config.h"
#include "sensor/publish/consumers/consumer.h"

enum {
    datum_frame = 600001,
    datum_band,
    datum_kind,
    datum_raster,
    datum_hfov,
    datum_vfov,
    datum_targets,
    datum_left_out,
    datum_stream_codec,
    datum_stream_klv,
    datum_stream_targets,
    datum_detections,
    datum_detections_omitted,
    datum_radar_pdu,
    datum_time = 600101,
    datum_sensor_position,
    datum_camera,
    datum_host,
    datum_target_measured = 600201,
    datum_truth,
    datum_stream_url = 600301,
    datum_radar = 600401,
    datum_detection,
    datum_kind_sensor = 1,
    datum_kind_truth = 2,
    datum_kind_stream = 3,
    datum_kind_radar = 4,
};

typedef struct DisRecordSender {
    uint8_t  version, exercise; /* as in the exercise */
    uint16_t site, application;
    uint32_t timestamp; /* raw, at the time of the frame */
} DisRecordSender;

/* Encodes one frame of one band as a PDU. Returns its size in octets, at most dis_smallest_mtu. */
size_t dis_record_frame(uint8_t out[dis_smallest_mtu], const DisRecordSender *sender, const FrameRecord *frame,
                        Band band, bool truth);
/* The n-th PDU, from 0, of the detections of a frame with a radar; how many it has. */
size_t dis_record_radar(uint8_t out[dis_smallest_mtu], const DisRecordSender *sender, const FrameRecord *frame, int n);
int    dis_record_radar_count(const FrameRecord *frame);

/* ---- the consumer -------------------------------------------------------------------------------- */

/* Data PDUs as a consumer of frames: one per frame and band, as publish.dis says, and the announcements of the video
 * streams, as publish.stream says. What they contain depends on the frame alone, so a live node and a replay of its
 * recording send the same octets for the same frame. */

/* Sends one datagram; must not wait. What it returns is for its own counters: a PDU that is not sent ends nothing. */
typedef Status DisSend(void *user, const uint8_t *pdu, size_t octets);
/* Unix time at which an exercise time is over, on the clock that datagrams are stamped with on arrival. */
typedef double DisArrivalTime(const void *clock, double t_s);

typedef struct DisOf {
    const Config   *config; /* publish.dis: not off */
    unsigned        bands;
    uint8_t         version, exercise; /* as in the exercise */
    DisSend        *send;
    void           *user;
    DisArrivalTime *arrival_s; /* time stamps follow it: those of a replay are of the recorded hour */
    const void     *clock;
} DisOf;

Status consume_dis(Consumer **out, const DisOf *of);

/* Exercise time between two announcements of a stream. */
static const double dis_announce_s = 5;

#endif
