/* tests/bench/dis/speed_pdus.c: decoding and encoding of PDUs, bundles, and a capture from the disk. The PDUs are
 * random octets with valid headers, from a counter; each row's error is the number of octets that differ after a round
 * trip. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "dis/pdu/decode.h"
#include "dis/capture/log.h"
#include "dis/pdu/octets.h"

#include <stdlib.h>
#include <unistd.h>

enum { kinds = 3, pdu_room = 144 + 16 * 8, bundle_octets = 1400, what_size = 96 };

static const struct {
    const char *name;
    uint8_t     type;
    int         fixed, count_at; /* octets without records; where their number stands, 0: none */
} kind_table[kinds] = {{"Entity State", dis_pdu_entity_state, 144, 19},
                       {"Fire", dis_pdu_fire, 96, 0},
                       {"Detonation", dis_pdu_detonation, 104, 101}};

typedef struct Octets {
    int      pdus, kind;
    size_t   size;
    size_t  *first; /* [pdus + 1] */
    uint8_t *octet;
    DisPdu  *decoded; /* [few]: large, and only so many that they stay in a cache as in a node's loop */
    uint8_t  again[pdu_room];
} Octets;
enum { few = 8 };

static uint32_t roll(uint32_t stream, uint32_t index)
{
    uint32_t       word[4];
    const uint32_t counter[4] = {index, stream, 0, 0}, key[2] = {0xBE7C, 1};
    random_u32x4(word, counter, key);
    return word[0];
}

/* Makes a PDU with up to five records, two as a rule: a tank's turret and gun. */
static size_t make_pdu(uint8_t *out, int kind, uint32_t index)
{
    const uint32_t dice = roll(100 + (uint32_t)kind, index);
    const int      records = kind_table[kind].count_at == 0 ? 0 : dice % 4 ? 2 : (int)(dice / 4 % 6);
    const size_t   length = (size_t)(kind_table[kind].fixed + 16 * records);
    for (size_t i = 0; i < length; i += 4) {
        const uint32_t word = roll((uint32_t)kind, index * 128 + (uint32_t)i / 4);
        memcpy(out + i, &word, length - i < 4 ? length - i : 4);
    }
    out[0] = (uint8_t)(5 + dice / 64 % 3);
    out[2] = kind_table[kind].type;
    out[8] = (uint8_t)(length >> 8);
    out[9] = (uint8_t)length;
    if (kind_table[kind].count_at) out[kind_table[kind].count_at] = (uint8_t)records;
    for (int r = 0; r < records; r++) out[kind_table[kind].fixed + 16 * r] = 0; /* articulated */
    return length;
}

/* Makes the octets of PDUs. kind < 0: of all kinds, eight in ten of them Entity States. */
static Status make_octets(Octets *out, int kind, int pdus)
{
    *out = (Octets){.pdus = pdus,
                    .kind = kind,
                    .first = calloc((size_t)pdus + 1, sizeof *out->first),
                    .octet = malloc((size_t)pdus * pdu_room),
                    .decoded = calloc(few, sizeof *out->decoded)};
    if (!out->first || !out->octet || !out->decoded) return STATUS_NO_MEMORY;
    for (int i = 0; i < pdus; i++) {
        const int one_of_ten = (int)(roll(200, (uint32_t)i) % 10);
        out->size += make_pdu(out->octet + out->size,
                              kind >= 0        ? kind
                              : one_of_ten < 8 ? 0
                                               : one_of_ten - 7,
                              (uint32_t)i);
        out->first[i + 1] = out->size;
    }
    return STATUS_OK;
}

static void free_octets(Octets *o)
{
    free(o->first);
    free(o->octet);
    free(o->decoded);
}

static void decode_all(void *user)
{
    Octets *o = user;
    for (int i = 0; i < o->pdus; i++) {
        const Status status = dis_decode(&o->decoded[i % few], o->octet + o->first[i], o->first[i + 1] - o->first[i]);
        bench_keep(&status);
        bench_keep(&o->decoded[i % few]);
    }
}

static void encode_all(void *user)
{
    Octets *o = user;
    for (int i = 0; i < o->pdus; i++) {
        const size_t octets = dis_encode(o->again, pdu_room, &o->decoded[i % few]);
        bench_keep(&octets);
        bench_keep(o->again);
    }
}

static void walk_all(void *user)
{
    Octets        *o = user;
    DisCounters    counters = {0};
    DisHeader      header;
    const uint8_t *pdu;
    for (int i = 0, n = 0; i < o->pdus;) { /* datagrams as long as a network takes them */
        int last = i + 1;
        while (last < o->pdus && o->first[last + 1] - o->first[i] <= bundle_octets) last++;
        const uint8_t *const end = o->octet + o->first[last];
        for (const uint8_t *at = o->octet + o->first[i]; dis_next_pdu(&header, &pdu, &at, end, &counters); n++) {
            const Status status = dis_decode(&o->decoded[n % few], pdu, header.length);
            bench_keep(&status);
            bench_keep(&o->decoded[n % few]);
        }
        i = last;
    }
    bench_keep(&counters);
}

/* Octets that decoding and encoding do not give back; of every PDU. */
static double lost_octets(const Octets *o)
{
    double  lost = 0;
    uint8_t again[pdu_room];
    for (int i = 0; i < o->pdus; i++) {
        const uint8_t *pdu = o->octet + o->first[i];
        const size_t   octets = o->first[i + 1] - o->first[i];
        if (dis_decode(&o->decoded[0], pdu, octets) != STATUS_OK ||
            dis_encode(again, pdu_room, &o->decoded[0]) != octets)
            return INFINITY;
        for (size_t k = 0; k < octets; k++) lost += again[k] != pdu[k];
    }
    return lost;
}

static BenchRow octets_row(const char *what, const BenchTime *time, const Octets *o)
{
    BenchRow row = bench_row_of(what, time, "M PDUs/s", 1e6);
    row.error = lost_octets(o);
    row.error_limit = 0;
    row.error_unit = "octets";
    row.against = "of those, encoded again";
    return row;
}

static Status time_kind(Bench *bench, int kind)
{
    Octets       o;
    BenchTime    time[2];
    BenchRow     row;
    char         what[what_size];
    const Status status = make_octets(&o, kind, bench_quick(bench) ? 512 : 8192);
    if (status == STATUS_OK) {
        const BenchWork work[2] = {{decode_all, &o, o.pdus}, {encode_all, &o, o.pdus}};
        decode_all(&o);
        bench_time(time, bench, work, 2);
        snprintf(what, sizeof what, "%s: decode", kind_table[kind].name);
        row = octets_row(what, &time[0], &o);
        bench_add(bench, &row);
        snprintf(what, sizeof what, "%s: encode", kind_table[kind].name);
        row = octets_row(what, &time[1], &o);
        row.ratio = bench_ratio(&time[1], &time[0]);
        row.to = "decode";
        bench_add(bench, &row);
    }
    free_octets(&o);
    return status;
}

/* ---- a capture -------------------------------------------------------------------------------- */

/* Ethernet, IPv4 and UDP around a datagram for port 3000, as a classic pcap has it; little-endian. */
static bool write_packet(FILE *file, uint32_t index, const uint8_t *octet, size_t octets)
{
    const uint32_t all = (uint32_t)(14 + 20 + 8 + octets);
    const uint32_t head[4] = {1000000000 + index / 100, index % 100 * 10000, all, all};
    uint8_t        layer[42] = {0};
    layer[12] = 0x08; /* IPv4 */
    layer[14] = 0x45;
    dis_store_u16(layer + 16, (uint16_t)(20 + 8 + octets));
    layer[22] = 64;
    layer[23] = 17; /* UDP */
    memcpy(layer + 26, "\x0a\x00\x00\x01\x0a\x00\x00\xff", 8);
    dis_store_u16(layer + 34, dis_port);
    dis_store_u16(layer + 36, dis_port);
    dis_store_u16(layer + 38, (uint16_t)(8 + octets));
    return fwrite(head, sizeof head, 1, file) == 1 && fwrite(layer, sizeof layer, 1, file) == 1 &&
           fwrite(octet, octets, 1, file) == 1;
}

typedef struct Capture {
    char          path[temp_path_size];
    const Octets *octets;
    Status        status;
} Capture;

static void read_capture(void *user)
{
    Capture *c = user;
    DisLog   log;
    c->status = dis_log_open(&log, c->path, dis_port);
    if (c->status != STATUS_OK) return;
    bench_keep(log.datagram);
    dis_log_close(&log);
}

static double lost_of_capture(const Capture *c)
{
    const Octets *o = c->octets;
    DisLog        log;
    double        lost = 0;
    if (dis_log_open(&log, c->path, dis_port) != STATUS_OK) return INFINITY;
    if (log.count != o->pdus) lost = INFINITY;
    for (int i = 0; i < log.count && i < o->pdus; i++) {
        const size_t      octets = o->first[i + 1] - o->first[i];
        const DisDatagram d = dis_log_datagram(&log, i);
        lost += d.octets != octets || memcmp(d.bytes, o->octet + o->first[i], octets) != 0 ? (double)octets : 0;
    }
    dis_log_close(&log);
    return lost;
}

static Status time_capture(Bench *bench, const Octets *o)
{
    static const uint32_t head[6] = {0xA1B2C3D4, 0x00040002, 0, 0, 262144, 1};
    Capture               c = {.octets = o};
    BenchTime             time;
    FILE                 *file = temp_file(c.path, "") ? output_file(c.path, 0) : NULL;
    bool                  ok = file && fwrite(head, sizeof head, 1, file) == 1;
    for (int i = 0; i < o->pdus && ok; i++)
        ok = write_packet(file, (uint32_t)i, o->octet + o->first[i], o->first[i + 1] - o->first[i]);
    ok = file && fclose(file) == 0 && ok;
    if (ok) {
        const BenchWork work = {read_capture, &c, o->pdus};
        bench_time(&time, bench, &work, 1);
        BenchRow row = bench_row_of("capture: read from a file, a datagram", &time, "M datagrams/s", 1e6);
        row.error = lost_of_capture(&c);
        row.error_limit = 0;
        row.error_unit = "octets";
        row.against = "of those that were written";
        bench_add(bench, &row);
    } else {
        log_error("bench: cannot write %s", c.path);
    }
    if (*c.path) remove(c.path);
    return ok ? c.status : STATUS_IO;
}

/* ---- the whole -------------------------------------------------------------------------------- */

Status bench_speed_pdus(Bench *bench)
{
    Octets    o = {0};
    BenchTime time;
    Status    status = STATUS_OK;
    for (int kind = 0; kind < kinds && status == STATUS_OK; kind++) status = time_kind(bench, kind);
    if (status == STATUS_OK) status = make_octets(&o, -1, bench_quick(bench) ? 1024 : 20000);
    if (status == STATUS_OK) {
        const BenchWork work = {walk_all, &o, o.pdus};
        bench_time(&time, bench, &work, 1);
        BenchRow row = octets_row("bundles of up to 1400 octets: walk and decode, a PDU", &time, &o);
        bench_add(bench, &row);
        status = time_capture(bench, &o);
    }
    if (status != STATUS_OK) log_error("bench: dis: %s", status_name(status));
    free_octets(&o);
    return status;
}
