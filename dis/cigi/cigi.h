/* dis/cigi/cigi.h: the packets of CIGI 3.3 (Common Image Generator Interface) that a hardware-in-the-loop host and this
 * image generator (IG) exchange, as plain structs.
 *
 * Source: Interface Control Document for the Common Image Generator Interface, version 3.3 (Boeing, public); layouts
 * octet by octet against Wireshark's dissector (tests/system/test_cigi_judge.sh). Members have the units of the wire:
 * degrees, metres, and ticks of 10 microseconds; what is reserved is not kept, and is written as 0. A datagram's octet
 * order is its sender's: the byte swap magic number of the first packet tells it. */
#ifndef DIS_CIGI_CIGI_H
#define DIS_CIGI_CIGI_H

#include "pitviper.h"

enum {
    cigi_ig_control = 1, /* host to IG */
    cigi_entity_control = 2,
    cigi_rate_control = 8,
    cigi_view_control = 16,
    cigi_sensor_control = 17,
    cigi_view_definition = 21,
    cigi_hat_hot_request = 24,
    cigi_los_segment_request = 25,
    cigi_los_vector_request = 26,
    cigi_start_of_frame = 101, /* IG to host */
    cigi_hat_hot_response = 102,
    cigi_hat_hot_extended_response = 103,
    cigi_los_response = 104,
    cigi_los_extended_response = 105,
    cigi_sensor_response = 106,
    cigi_sensor_extended_response = 107,
};

enum { cigi_major = 3, cigi_minor = 3, cigi_magic = 0x8000, cigi_ticks_per_s = 100000, cigi_most_octets = 64 };

/* IG Control's and Start of Frame's mode; 3 is for Start of Frame alone. */
enum { cigi_mode_standby = 0, cigi_mode_operate = 1, cigi_mode_debug = 2, cigi_mode_maintenance = 3 };
enum { cigi_request_hat = 0, cigi_request_hot = 1, cigi_request_extended = 2 };
enum { cigi_entity_standby = 0, cigi_entity_active = 1, cigi_entity_destroyed = 2 };

/* Of the octets of a number. */
typedef enum CigiOrder { CIGI_BIG_ENDIAN, CIGI_LITTLE_ENDIAN } CigiOrder;

typedef struct CigiIgControl {
    uint8_t  major, minor; /* before 3.2 the minor version is not sent: 0 */
    int8_t   database;     /* 0: none is to be loaded */
    uint8_t  mode;
    bool     timestamp_valid, smoothing;
    uint32_t host_frame, timestamp; /* of the host's frame, in ticks since a time of its own */
    uint32_t last_ig_frame;         /* number of the last Start of Frame that the host has received; before 3.2: 0 */
} CigiIgControl;

typedef struct CigiEntityControl {
    uint16_t id;
    uint8_t  state;
    bool     attached, collides, inherits_alpha;
    uint8_t  clamp;           /* to ground or water: 0 no, 1 position, 2 position and attitude */
    bool     backward, loops; /* its animation */
    uint8_t  animation;       /* 0 stop, 1 pause, 2 play, 3 continue */
    bool     smoothing;
    uint8_t  alpha;        /* 0 transparent .. 255 opaque */
    uint16_t type, parent; /* type: numbers are the IG's own */
    float    roll_deg, pitch_deg, yaw_deg;
    double   p[3]; /* latitude, longitude, degrees, and altitude, m; attached: offset from the parent, m, its axes */
} CigiEntityControl;

typedef struct CigiRateControl {
    uint16_t entity;
    uint8_t  part;
    bool     of_part, local; /* local: in the entity's own axes, else in those of its place, or of its parent */
    float    v_mps[3], roll_deg_s, pitch_deg_s, yaw_deg_s; /* v: forward, right, down, or north, east, down */
} CigiRateControl;

typedef struct CigiViewControl {
    uint16_t view;
    uint8_t  group; /* 0: the view, else all views of the group */
    bool     x_on, y_on, z_on, roll_on, pitch_on, yaw_on;
    uint16_t entity;
    float    offset_m[3]; /* in the entity's axes: forward, right, down */
    float    roll_deg, pitch_deg, yaw_deg;
} CigiViewControl;

typedef struct CigiSensorControl {
    uint16_t view;
    uint8_t  sensor;
    bool     on, black_hot, line_dropout, automatic_gain, tracks_black;
    uint8_t  track_mode; /* 0 off, 1 force correlate, 2 scene, 3 target, 4 ship, 5 .. 7 of the IG */
    bool     extended;   /* the answer is to be a Sensor Extended Response */
    float    gain, level, ac_coupling_us, noise;
} CigiSensorControl;

typedef struct CigiViewDefinition {
    uint16_t view;
    uint8_t  group;
    bool     near_on, far_on, left_on, right_on, top_on, bottom_on;
    uint8_t  mirror, replication;
    bool     parallel, reorder;
    uint8_t  type;
    float    near_m, far_m, left_deg, right_deg, top_deg, bottom_deg; /* half angles, signed: left < right */
} CigiViewDefinition;

typedef struct CigiHatHotRequest {
    uint16_t id;
    uint8_t  type;
    bool     by_entity; /* p is an offset in the entity's axes */
    uint8_t  period;    /* 0: once; else again every so many frames */
    uint16_t entity;
    double   p[3]; /* latitude, longitude, altitude, or offset, as of Entity Control */
} CigiHatHotRequest;

typedef struct CigiLosSegmentRequest {
    uint16_t id;
    bool     extended, from_entity, to_entity, answer_entity, other_entity;
    uint8_t  alpha; /* least opacity that counts as a hit */
    uint16_t entity;
    double   from[3], to[3];
    uint32_t materials; /* mask */
    uint8_t  period;
    uint16_t destination_entity; /* with other_entity: to is an offset from it */
} CigiLosSegmentRequest;

typedef struct CigiLosVectorRequest {
    uint16_t id;
    bool     extended, from_entity, answer_entity;
    uint8_t  alpha;
    uint16_t entity;
    float    azimuth_deg, elevation_deg, least_m, most_m;
    double   from[3];
    uint32_t materials;
    uint8_t  period;
} CigiLosVectorRequest;

typedef struct CigiStartOfFrame {
    uint8_t  major, minor;
    int8_t   database; /* 0: the IG loads what it wants */
    uint8_t  status;   /* 0: normal */
    uint8_t  mode;
    bool     timestamp_valid, other_earth; /* other_earth: not WGS 84 */
    uint32_t ig_frame, timestamp, last_host_frame;
} CigiStartOfFrame;

typedef struct CigiHatHotResponse {
    uint16_t id;
    bool     valid, hot; /* hot: height of terrain, else height above it */
    uint8_t  host_frame; /* its last four bits */
    double   height_m;
} CigiHatHotResponse;

typedef struct CigiHatHotExtendedResponse {
    uint16_t id;
    bool     valid;
    uint8_t  host_frame;
    double   hat_m, hot_m;
    uint32_t material;
    float    normal_azimuth_deg, normal_elevation_deg;
} CigiHatHotExtendedResponse;

typedef struct CigiLosResponse {
    uint16_t id;
    bool     valid, entity_valid, visible;
    uint8_t  host_frame, count; /* count: of answers to the request */
    uint16_t entity;
    double   range_m;
} CigiLosResponse;

typedef struct CigiLosExtendedResponse {
    uint16_t id;
    bool     valid, entity_valid, range_valid, visible;
    uint8_t  host_frame, count;
    uint16_t entity;
    double   range_m, p[3];
    uint8_t  red, green, blue, alpha;
    uint32_t material;
    float    normal_azimuth_deg, normal_elevation_deg;
} CigiLosExtendedResponse;

typedef struct CigiSensorResponse {
    uint16_t view;
    uint8_t  sensor, status; /* status: 0 searching, 1 tracking, 2 impending break of lock, 3 broken */
    uint16_t gate_px[2];     /* width, height */
    float    gate_deg[2];    /* its place about the axis of the view: to the right, up */
    uint32_t frame;          /* of the IG, for which it was found */
} CigiSensorResponse;

typedef struct CigiSensorExtendedResponse {
    uint16_t view;
    uint8_t  sensor, status;
    bool     entity_valid;
    uint16_t entity;
    uint16_t gate_px[2];
    float    gate_deg[2];
    uint32_t frame;
    double   track[3]; /* latitude, longitude, degrees, altitude, m */
} CigiSensorExtendedResponse;

typedef struct CigiPacket {
    uint8_t id;
    union {
        CigiIgControl              ig_control;
        CigiEntityControl          entity_control;
        CigiRateControl            rate_control;
        CigiViewControl            view_control;
        CigiSensorControl          sensor_control;
        CigiViewDefinition         view_definition;
        CigiHatHotRequest          hat_hot_request;
        CigiLosSegmentRequest      los_segment_request;
        CigiLosVectorRequest       los_vector_request;
        CigiStartOfFrame           start_of_frame;
        CigiHatHotResponse         hat_hot_response;
        CigiHatHotExtendedResponse hat_hot_extended_response;
        CigiLosResponse            los_response;
        CigiLosExtendedResponse    los_extended_response;
        CigiSensorResponse         sensor_response;
        CigiSensorExtendedResponse sensor_extended_response;
    } of;
} CigiPacket;

#endif
