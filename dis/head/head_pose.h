/* dis/head/head_pose.h: the datagram by which a head tracker, or whatever stands for one, says where an eye looks
 * (etc/reference/head.md).
 *
 * 40 octets, or 64 with a position; network order; floating point is IEEE 754.
 *
 *      0  4   magic "PVHD"
 *      4  u16 version, 1
 *      6  u16 flags: 1: a position is given; 2: angles are relative to what carries the eye, else to north and level
 *      8  u32 sequence: 1 more each time, goes on at 0
 *     12  u32 buttons, a bit each
 *     16  u64 time of the sample by the sender's clock, us
 *     24  f32 yaw, deg: to the right, -360 .. 360
 *     28  f32 pitch, deg: up, -90 .. 90
 *     32  f32 roll, deg: the right side down, -360 .. 360; yaw, pitch, roll in this order
 *     36  f32 zoom: factor of the focal length, 0.05 .. 100; 1: as it is
 *     40  f64 latitude, deg, WGS 84, -90 .. 90
 *     48  f64 longitude, deg, -360 .. 360
 *     56  f64 height, m above the ellipsoid, -1e3 .. 1e5 */
#ifndef DIS_HEAD_HEAD_POSE_H
#define DIS_HEAD_HEAD_POSE_H

#include "pitviper.h"

enum { head_version = 1, head_octets = 40, head_octets_placed = 64, head_octets_most = 64 };
enum { HEAD_PLACED = 1, HEAD_RELATIVE = 2 };

typedef struct HeadPose {
    unsigned flags;
    uint32_t sequence, buttons;
    uint64_t time_us;
    double   yaw_deg, pitch_deg, roll_deg, zoom; /* each a float's value */
    double   lat_deg, lon_deg, height_m;         /* without HEAD_PLACED 0 */
} HeadPose;

typedef enum HeadDrop {
    HEAD_GOOD,
    HEAD_SIZE,    /* not that of its flags */
    HEAD_MAGIC,   /* not PVHD */
    HEAD_VERSION, /* another than 1 */
    HEAD_FLAGS,   /* bits that this version does not have */
    HEAD_RANGE,   /* a number out of its range, or none */
    HEAD_OLD,     /* its sequence is that of the newest one, or before it */
    HEAD_DROPS
} HeadDrop;
extern const char *const head_drop_name[HEAD_DROPS];

/* HEAD_OLD is no matter of octets: see head_newer. On a fault *out is unchanged. */
HeadDrop head_pose_read(HeadPose *out, const uint8_t *octets, size_t count);
/* Returns the number of octets: head_octets, or head_octets_placed. */
size_t head_pose_write(uint8_t out[head_octets_most], const HeadPose *pose);

/* Whether a sequence comes after another, which it may have gone past 2^32 - 1; one that is more than head_back behind
 * is that of a sender that has begun anew. */
enum { head_back = 64 };
bool head_newer(uint32_t sequence, uint32_t than);

#endif
