/* sensor/node/flight/operator_sight.c: datagrams of an operator's aim. */
#include "sensor/node/flight/operator_sight.h"

#include "terrain/earth/geodesy.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { line_size = 128 };

/* The next word, behind one blank; words are of printable characters. */
static const char *word(char **at)
{
    char *begin = *at;
    if (!begin || !*begin || *begin == ' ') return NULL;
    char *end = strchr(begin, ' ');
    if (end) *end = 0;
    *at = end ? end + 1 : NULL;
    return begin;
}

Status operator_aim_parse(OperatorAim *out, const uint8_t *bytes, size_t octets)
{
    char        line[line_size], *at = line;
    OperatorAim aim = {0};
    double      azimuth_deg, elevation_deg;
    if (octets > 0 && bytes[octets - 1] == '\n') octets--;
    if (octets == 0 || octets >= sizeof line) return STATUS_BAD_VALUE;
    for (size_t i = 0; i < octets; i++)
        if (bytes[i] < ' ' || bytes[i] > '~') return STATUS_BAD_VALUE;
    memcpy(line, bytes, octets);
    line[octets] = 0;
    const char *const said = word(&at), *const number = word(&at), *const azimuth = word(&at),
                      *const elevation = word(&at);
    if (!said || strcmp(said, "aim") != 0 || !number || !azimuth || !elevation) return STATUS_BAD_VALUE;
    if (!text_to_long(&aim.number, number) || !text_to_double(&azimuth_deg, azimuth) ||
        !text_to_double(&elevation_deg, elevation))
        return STATUS_BAD_VALUE;
    if (at) {
        aim.launch = strcmp(at, "launch") == 0;
        if (!aim.launch) return STATUS_BAD_VALUE;
    }
    if (aim.number < 0 || aim.number > 1LL << 53 || !(fabs(azimuth_deg) <= 360) || !(fabs(elevation_deg) <= 90))
        return STATUS_BAD_VALUE;
    aim.azimuth_rad = azimuth_deg * rad_per_deg;
    aim.elevation_rad = elevation_deg * rad_per_deg;
    *out = aim;
    return STATUS_OK;
}

bool operator_direction(double los_ecef[3], const OperatorAim *aim, const double p_ecef[3])
{
    LocalFrame   frame;
    Geodetic     place;
    const double e = aim->elevation_rad, a = aim->azimuth_rad, enu[3] = {cos(e) * sin(a), cos(e) * cos(a), sin(e)};
    if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK || local_frame_at(&frame, &place) != STATUS_OK) return false;
    m3_mul_v3(los_ecef, frame.r_ecef_from_enu, enu);
    return v3_normalize(los_ecef, los_ecef);
}

/* ---- the socket ---------------------------------------------------------------------------------------- */

struct OperatorSight {
    int       socket;
    bool      any;
    long long number;
    double    heard_s; /* wall clock */
    uint64_t  taken, refused, old;
};

Status operator_sight_open(OperatorSight **out, int port)
{
    const struct sockaddr_in own = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    OperatorSight           *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (s->socket < 0 || bind(s->socket, (const struct sockaddr *)&own, sizeof own) != 0) {
        log_error("flight: flight.operator_port: port %d cannot be listened on: %s; choose another", port,
                  strerror(errno));
        if (s->socket >= 0) close(s->socket);
        free(s);
        return STATUS_IO;
    }
    *out = s;
    return STATUS_OK;
}

bool operator_sight_newest(OperatorAim *out, OperatorSight *s)
{
    enum { most = 1024 };
    static const double anew_s = 1;
    uint8_t             bytes[line_size + 1];
    OperatorAim         aim;
    bool                any = false, launch = false;
    for (int i = 0; i < most; i++) {
        const ssize_t octets = recv(s->socket, bytes, sizeof bytes, 0);
        if (octets < 0) break;
        if (operator_aim_parse(&aim, bytes, (size_t)octets) != STATUS_OK) {
            s->refused++;
            continue;
        }
        const double now_s = wall_clock_s();
        if (s->any && aim.number <= s->number && now_s - s->heard_s < anew_s) {
            s->old++;
            continue;
        }
        s->any = any = true;
        s->number = aim.number;
        s->heard_s = now_s;
        s->taken++;
        launch |= aim.launch;
        *out = aim;
    }
    if (any) out->launch = launch;
    return any;
}

void operator_sight_close(OperatorSight *s)
{
    if (!s) return;
    log_info("flight: operator: %llu datagrams taken, %llu refused, %llu old", (unsigned long long)s->taken,
             (unsigned long long)s->refused, (unsigned long long)s->old);
    close(s->socket);
    free(s);
}
