/* etc/fmu/host.h: the host of an image generator by CIGI 3.3, in step with it, over UDP on this machine.
 *
 * Each frame: IG Control with number and time, Entity Control, Rate Control where the rates are known, and View Control
 * go out in one datagram, and the Start of Frame that follows says that the frame is delivered. Where it does not
 * come, Start of Frame before it comes again every 0.25 s, and is answered again. */
#ifndef PITVIPER_FMU_HOST_H
#define PITVIPER_FMU_HOST_H

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* The eye: position and attitude in WGS 84's Earth-centred, Earth-fixed axes; its own: forward, right, down. */
typedef struct HostEye {
    double p_ecef[3]; /* m */
    double r_ecef_from_eye[9];
    int    rates; /* whether the following are known; else the IG takes differences of frames */
    double v_ecef_mps[3];
    double w_eye_rps[3]; /* how it turns, in its own axes */
} HostEye;

typedef struct Host {
    int      socket; /* -1: none */
    uint16_t own_port, ig_port;
    int      heard; /* a Start of Frame has come */
    uint32_t frame; /* number of the datagram that was sent last */
    uint32_t ig_frame;
    uint8_t  out[256]; /* that datagram */
    size_t   octets;
} Host;

/* ---- numbers ------------------------------------------------------------------------------------ */

static const double host_rad_per_deg = 0.017453292519943295;

/* Latitude and longitude, rad, height, m, over the ellipsoid; r: columns north, east, down. Below 1 um from 100 km
 * under the ground on. 0: not a place near Earth. */
static inline int host_geodetic(double *lat, double *lon, double *height_m, double r_ecef_from_ned[9],
                                const double p[3])
{
    enum { turns = 12 }; /* each leaves 0.0067 of the error */
    static const double a_m = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
    const double        ring_m = hypot(p[0], p[1]);
    double              phi = atan2(p[2], ring_m * (1 - e2));
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]) || hypot(ring_m, p[2]) < 6.2e6) return 0;
    for (int i = 0; i < turns; i++)
        phi = atan2(p[2] + e2 * a_m / sqrt(1 - e2 * sin(phi) * sin(phi)) * sin(phi), ring_m);
    const double sp = sin(phi), cp = cos(phi), l = atan2(p[1], p[0]), sl = sin(l), cl = cos(l);
    const double r[9] = {-sp * cl, -sl, -cp * cl, -sp * sl, cl, -cp * sl, cp, 0, -sp};
    *lat = phi, *lon = l;
    *height_m = ring_m * cp + p[2] * sp - a_m * sqrt(1 - e2 * sp * sp);
    memcpy(r_ecef_from_ned, r, sizeof r);
    return fabs(*height_m) < 1e7;
}

/* a transposed, times b. */
static inline void host_tmul(double out[9], const double a[9], const double b[9])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) out[3 * i + k] = a[i] * b[k] + a[3 + i] * b[3 + k] + a[6 + i] * b[6 + k];
}

/* Yaw, pitch, roll, deg, as the wire has them, of a rotation from the turned axes. */
static inline void host_turn_of(float turn_deg[3], const double r[9])
{
    turn_deg[0] = (float)(atan2(r[3], r[0]) / host_rad_per_deg);
    turn_deg[1] = (float)(atan2(-r[6], hypot(r[7], r[8])) / host_rad_per_deg);
    turn_deg[2] = (float)(atan2(r[7], r[8]) / host_rad_per_deg);
}

static inline void host_rotation(double r[9], const float turn_deg[3])
{
    const double y = (double)turn_deg[0] * host_rad_per_deg, p = (double)turn_deg[1] * host_rad_per_deg,
                 q = (double)turn_deg[2] * host_rad_per_deg;
    const double sy = sin(y), cy = cos(y), sp = sin(p), cp = cos(p), sq = sin(q), cq = cos(q);
    const double turned[9] = {cy * cp,
                              cy * sp * sq - sy * cq,
                              cy * sp * cq + sy * sq,
                              sy * cp,
                              sy * sp * sq + cy * cq,
                              sy * sp * cq - cy * sq,
                              -sp,
                              cp * sq,
                              cp * cq};
    memcpy(r, turned, sizeof turned);
}

/* ---- packets ------------------------------------------------------------------------------------ */

static inline void host_put(uint8_t *at, uint64_t bits, int octets)
{
    for (int i = 0; i < octets; i++) at[i] = (uint8_t)(bits >> 8 * (octets - 1 - i));
}
static inline void host_put_float(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    host_put(at, bits, 4);
}
static inline void host_put_double(uint8_t *at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    host_put(at, bits, 8);
}

/* A packet of zeros at the end of the datagram. */
static inline uint8_t *host_packet(Host *h, uint8_t id, uint8_t octets)
{
    uint8_t *const at = h->out + h->octets;
    memset(at, 0, octets);
    at[0] = id, at[1] = octets;
    h->octets += octets;
    return at;
}

static inline void host_write_control(Host *h, uint32_t ticks)
{
    enum { ig_control = 1, operate_with_time_of_3_3 = 1 | 1 << 2 | 3 << 4 };
    uint8_t *const p = host_packet(h, ig_control, 24);
    p[2] = 3, p[4] = operate_with_time_of_3_3, p[6] = 0x80;
    host_put(p + 8, h->frame, 4), host_put(p + 12, ticks, 4), host_put(p + 16, h->ig_frame, 4);
}

/* Of entity 0, on which view `view` is. What the entity's angles of 32 bits leave of the attitude is the view's own
 * turn, which is small, so that its rounding is below 1e-13 rad. */
static inline int host_write_eye(Host *h, uint16_t view, const HostEye *eye)
{
    enum { entity_control = 2, rate_control = 8, view_control = 16, active = 1, local = 2, turns_on = 0x38 };
    double lat, lon, height_m, r_ecef_from_ned[9], r_ned[9], rounded[9], rest[9];
    float  turn[3], left[3];
    if (!host_geodetic(&lat, &lon, &height_m, r_ecef_from_ned, eye->p_ecef)) return 0;
    host_tmul(r_ned, r_ecef_from_ned, eye->r_ecef_from_eye);
    host_turn_of(turn, r_ned);
    host_rotation(rounded, turn);
    host_tmul(rest, rounded, r_ned);
    host_turn_of(left, rest);
    uint8_t *p = host_packet(h, entity_control, 48);
    p[4] = active;
    for (int i = 0; i < 3; i++) host_put_float(p + 12 + 4 * i, turn[2 - i]); /* roll, pitch, yaw */
    host_put_double(p + 24, lat / host_rad_per_deg), host_put_double(p + 32, lon / host_rad_per_deg);
    host_put_double(p + 40, height_m);
    if (eye->rates) {
        p = host_packet(h, rate_control, 32);
        p[5] = local;
        for (int i = 0; i < 3; i++) {
            double v_mps = 0;
            for (int k = 0; k < 3; k++) v_mps += eye->r_ecef_from_eye[3 * k + i] * eye->v_ecef_mps[k];
            host_put_float(p + 8 + 4 * i, (float)v_mps);
            host_put_float(p + 20 + 4 * i, (float)(eye->w_eye_rps[i] / host_rad_per_deg));
        }
    }
    p = host_packet(h, view_control, 32);
    host_put(p + 2, view, 2);
    p[5] = turns_on;
    for (int i = 0; i < 3; i++) host_put_float(p + 20 + 4 * i, left[2 - i]);
    return 1;
}

/* ---- the link ------------------------------------------------------------------------------------ */

/* A UDP socket of this machine alone, on a port that is free. -1: errno says why. */
static inline int host_free_port(uint16_t *port, uint32_t address)
{
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr = {htonl(address)}};
    socklen_t          size = sizeof own;
    const int          s = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (s < 0) return -1;
    if (bind(s, (struct sockaddr *)&own, size) != 0 || getsockname(s, (struct sockaddr *)&own, &size) != 0) {
        close(s);
        return -1;
    }
    *port = ntohs(own.sin_port);
    return s;
}

/* Chooses two ports: own_port, and ig_port for the image generator, which is to take it soon. */
static inline int host_open(Host *h)
{
    *h = (Host){.socket = -1};
    const int other = host_free_port(&h->ig_port, INADDR_ANY);
    h->socket = host_free_port(&h->own_port, INADDR_LOOPBACK);
    if (other >= 0) close(other);
    const struct sockaddr_in to = {
        .sin_family = AF_INET, .sin_port = htons(h->ig_port), .sin_addr = {htonl(INADDR_LOOPBACK)}};
    return other >= 0 && h->socket >= 0 && connect(h->socket, (const struct sockaddr *)&to, sizeof to) == 0;
}

static inline void host_close(Host *h)
{
    if (h->socket >= 0) close(h->socket);
    h->socket = -1;
}

/* What cannot be sent is as one that is lost: it is sent again. */
static inline void host_send(const Host *h)
{
    if (h->octets && send(h->socket, h->out, h->octets, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) return;
}

/* Asks for a frame at that time. 0: the eye is not at a place near Earth, and nothing was asked. */
static inline int host_ask(Host *h, uint16_t view, const HostEye *eye, uint32_t ticks)
{
    h->octets = 0;
    h->frame++;
    host_write_control(h, ticks);
    if (!host_write_eye(h, view, eye)) {
        h->octets = 0;
        h->frame--;
        return 0;
    }
    host_send(h);
    return 1;
}

/* Reads what has come. 1: the first Start of Frame, or that after the frame that was asked for last. */
static inline int host_hear(Host *h)
{
    uint8_t  in[2048];
    uint32_t number[4]; /* IG frame, time stamp, last host frame */
    ssize_t  got;
    while ((got = recv(h->socket, in, sizeof in, MSG_DONTWAIT)) >= 0) {
        if (got < 24 || in[0] != 101 || in[1] != 24 || in[2] != 3 || in[6] != 0x80 || in[7] != 0) continue;
        for (int i = 0; i < 3; i++)
            number[i] = (uint32_t)in[8 + 4 * i] << 24 | (uint32_t)in[9 + 4 * i] << 16 | (uint32_t)in[10 + 4 * i] << 8 |
                        in[11 + 4 * i];
        const int first = !h->heard;
        if (first) h->ig_frame = number[0];
        h->heard = 1;
        if (first) return 1;
        if (number[0] == h->ig_frame) host_send(h); /* again: the answer was lost */
        if (number[0] == h->ig_frame || number[2] != h->frame) continue;
        h->ig_frame = number[0];
        h->octets = 0;
        return 1;
    }
    return 0;
}

#endif
