/* tests/tools/flood.c: invented entities among those of a recording: flood IN OUT [key=value ...]
 *
 * OUT is a recording too, or 127.0.0.1:PORT: what is invented is then sent in real time, and nothing else is. Keys:
 * ids=N how many entities; from_s, for_s when, from the first datagram on; senders=K their sites; reports=R of each,
 * one round after the other; reach_m how far about the recording's first entity; parts=P articulation parameters of
 * each; category=C guided munitions of category C instead of tanks. */
#include "dis/pdu/decode.h"
#include "dis/clock/exercise_clock.h"
#include "dis/capture/log.h"
#include "dis/capture/recorder.h"
#include "dis/network/udp.h"

#include <stdlib.h>
#include <time.h>

typedef struct Flood {
    double         ids, from_s, for_s, senders, reports, reach_m, parts, category;
    DisEntityState like; /* the recording's first */
    double         begun_s;
} Flood;

static bool first_state(Flood *f, const DisLog *log)
{
    static DisPdu decoded;
    for (int i = 0; i < log->count; i++) {
        DisCounters    ignored = {0};
        const uint8_t *at = log->datagram[i].bytes, *pdu;
        DisHeader      header;
        while (dis_next_pdu(&header, &pdu, &at, log->datagram[i].bytes + log->datagram[i].octets, &ignored))
            if (header.type == dis_pdu_entity_state && dis_decode(&decoded, pdu, header.length) == STATUS_OK) {
                f->like = decoded.entity_state;
                return true;
            }
    }
    return false;
}

/* Report n of all. */
static size_t report(uint8_t *out, size_t size, const Flood *f, uint64_t n, double t_s)
{
    const uint64_t id = n % (uint64_t)f->ids, per_sender = (uint64_t)ceil(f->ids / f->senders);
    const double   up_m = v3_length(f->like.p_ecef);
    double         d[3];
    DisEntityState pdu = f->like;
    pdu.id = (DisEntityId){(uint16_t)(1000 + id / per_sender), (uint16_t)(77 + id % per_sender / 60000),
                           (uint16_t)(1 + id % per_sender % 60000)};
    pdu.type = (DisEntityType){1, 1, 222, 1, 1, 1, 0};
    if (f->category > 0) pdu.type = (DisEntityType){2, 2, 225, (uint8_t)f->category, 1, 3, 0};
    memset(pdu.velocity_mps, 0, sizeof pdu.velocity_mps);
    memset(pdu.acceleration_mps2, 0, sizeof pdu.acceleration_mps2);
    memset(pdu.angular_rate_rps, 0, sizeof pdu.angular_rate_rps);
    pdu.appearance = 0;
    pdu.header.timestamp = dis_timestamp(fmod(dis_timestamp_seconds(f->like.header.timestamp) + t_s, 3600), false);
    for (int k = 0; k < 3; k++) d[k] = f->reach_m * (2 * random_uniform(id, 5, (uint32_t)k, 0) - 1);
    for (int k = 0; k < 3; k++) pdu.p_ecef[k] += d[k] - v3_dot(d, f->like.p_ecef) / (up_m * up_m) * f->like.p_ecef[k];
    pdu.variable_count = (uint8_t)f->parts;
    for (int k = 0; k < (int)f->parts; k++)
        pdu.variable[k] = (DisVariableParameter){.record_type = dis_variable_articulated,
                                                 .parameter = (uint32_t)(4096 + 32 * (k / 2) + (k % 2 ? 13 : 11)),
                                                 .value = (float)(0.1 * (double)(n % 10))};
    return dis_encode_entity_state(out, size, &pdu);
}

static int to_recording(const Flood *f, const DisLog *log, const char *path)
{
    DisRecorder   *recorder;
    const uint64_t all = (uint64_t)(f->ids * f->reports);
    const double   first_s = log->datagram[0].packet_s;
    uint8_t        octets[8192];
    uint64_t       n = 0;
    if (dis_recorder_open(&recorder, path, NULL) != STATUS_OK) return 1;
    for (int i = 0; i <= log->count; i++) {
        const double next_s = i < log->count ? log->datagram[i].packet_s - first_s : INFINITY;
        for (double t_s; n < all && (t_s = f->from_s + f->for_s * (double)n / (double)all) <= next_s; n++) {
            const size_t count = report(octets, sizeof octets, f, n, t_s);
            dis_recorder_add(recorder, (int64_t)((first_s + t_s) * 1e9), NULL, 3001, octets, count);
        }
        if (i < log->count)
            dis_recorder_add(recorder, (int64_t)(log->datagram[i].packet_s * 1e9), NULL, 3000, log->datagram[i].bytes,
                             log->datagram[i].octets);
    }
    return dis_recorder_close(recorder) == STATUS_OK ? 0 : 1;
}

static int to_network(const Flood *f, const char *to)
{
    DisUdp        *udp;
    DisUdpConfig   config = dis_udp_default_config();
    const uint64_t all = (uint64_t)(f->ids * f->reports);
    const char    *colon = strchr(to, ':');
    uint8_t        octets[8192];
    uint64_t       n = 0;
    long long      port = 0;
    snprintf(config.address, sizeof config.address, "%.*s", (int)(colon - to), to);
    if (!text_to_long(&port, colon + 1)) return 1;
    config.port = (int)port;
    if (dis_udp_open_sender(&udp, &config) != STATUS_OK) return 1;
    const double begun_s = wall_clock_s() + f->from_s;
    while (n < all) {
        const double now_s = wall_clock_s() - begun_s, due = now_s >= 0 ? fmin(now_s / f->for_s, 1) * (double)all : -1;
        for (; (double)n <= due && n < all; n++) dis_udp_send(udp, octets, report(octets, sizeof octets, f, n, now_s));
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    }
    const double took_s = wall_clock_s() - begun_s;
    printf("%llu datagrams sent in %.2f s, %.0f a second\n", (unsigned long long)dis_udp_counters(udp).sent, took_s,
           (double)all / took_s);
    dis_udp_close(udp);
    return 0;
}

int main(int argc, char **argv)
{
    Flood  f = {.ids = 100000, .from_s = 1, .for_s = 2.5, .senders = 1, .reports = 1, .reach_m = 20000};
    DisLog log;
    const struct {
        const char *key;
        double     *value;
    } keys[] = {{"ids", &f.ids},         {"from_s", &f.from_s},   {"for_s", &f.for_s}, {"senders", &f.senders},
                {"reports", &f.reports}, {"reach_m", &f.reach_m}, {"parts", &f.parts}, {"category", &f.category}};
    for (int i = 3; i < argc; i++) {
        const char *equals = strchr(argv[i], '=');
        bool        known = false;
        for (size_t k = 0; equals && k < sizeof keys / sizeof *keys; k++)
            if (strncmp(argv[i], keys[k].key, (size_t)(equals - argv[i])) == 0 && keys[k].key[equals - argv[i]] == 0)
                known = text_to_double(keys[k].value, equals + 1);
        if (!known) {
            fprintf(stderr, "flood: %s?\n", argv[i]);
            return 2;
        }
    }
    if (argc < 3 || dis_log_open(&log, argv[1], dis_port) != STATUS_OK || !first_state(&f, &log)) return 2;
    const int code = strncmp(argv[2], "127.", 4) == 0 ? to_network(&f, argv[2]) : to_recording(&f, &log, argv[2]);
    dis_log_close(&log);
    return code;
}
