/* dis/capture/log_packet.c: packets of a capture -> UDP payloads, layer by layer.
 *
 * Each layer passes the next a Span of captured octets only; inconsistent packets are counted and skipped.
 * Sources: the link-layer header types of libpcap (pcap-linktype(7)), RFC 791 and 815 (IPv4), RFC 8200 (IPv6),
 * RFC 768 (UDP), IEEE 802.1Q. */
#include "dis/capture/log_private.h"

#include "dis/capture/log.h"

#include "dis/pdu/octets.h"

#include <limits.h>
#include <stdlib.h>

enum {
    protocol_hop_by_hop = 0,
    protocol_udp = 17,
    protocol_routing = 43,
    protocol_fragment = 44,
    protocol_authentication = 51,
    protocol_destination = 60,
    protocol_mobility = 135,
    ethertype_ipv4 = 0x0800,
    ethertype_ipv6 = 0x86DD,
    ethertype_vlan = 0x8100,         /* 802.1Q */
    ethertype_service_vlan = 0x88A8, /* 802.1ad */
    ethertype_old_service_vlan = 0x9100,
    assemblies = 64, /* datagrams in reassembly at a time; the oldest is dropped */
    ip_payload_limit = 65535,
    fragment_unit = 8, /* octets; every fragment but the last has a multiple of them */
    fragment_units = 8192,
    link_null = 0, /* LINKTYPE_ */
    link_ethernet = 1,
    link_raw_bsd = 12, /* DLT_RAW of the BSDs, written by some programs */
    link_raw_openbsd = 14,
    link_raw = 101,
    link_loop = 108,
    link_sll = 113,
    link_ipv4 = 228,
    link_ipv6 = 229,
    link_sll2 = 276,
};

/* A sender repeats an IP identification within this time only by mistake: RFC 791 suggests 15 s, Linux waits
 * 30 s. */
static const double assembly_age_s = 30.0;

typedef struct Span {
    const uint8_t *at;
    size_t         octets;
} Span;

/* One IP datagram in reassembly. */
typedef struct Assembly {
    bool     used;
    uint8_t  key[40]; /* version, protocol, identification, source, destination; zero padded */
    uint64_t age;     /* number of its first fragment; the smallest is the oldest */
    double   first_s;
    uint32_t packets;
    uint8_t  next; /* IPv6: type of the header that follows the fragment header of the first fragment */
    bool     first_seen;
    size_t   total; /* octets of the whole payload; 0: unknown until the last fragment comes */
    size_t   furthest;
    size_t   units; /* received */
    uint64_t have[fragment_units / 64];
    uint8_t *bytes; /* [ip_payload_limit + 1] */
} Assembly;

struct DisPacketReader {
    DisLog  *log;
    Arena   *arena;
    int      capacity;
    int      port;
    bool     sure;      /* with dis_port_default: a datagram to port 3000 has come */
    uint64_t maybe;     /* packets with datagrams to other ports, which stay in the log until one to port 3000 comes */
    size_t   in_memory; /* octets */
    const DisCapturePacket *packet;
    double                  capture_s;
    Assembly                assembly[assemblies];
    uint64_t                fragments; /* fragments received so far, from which `age` is numbered */
    Status                  status;    /* not STATUS_OK (STATUS_NO_MEMORY, STATUS_IO): the reading stops */
};

/* ---- UDP ----------------------------------------------------------------------------------------- */

static bool looks_like_dis(Span payload)
{
    if (payload.octets < dis_header_octets) return false;
    const DisHeader header = dis_load_header(payload.at);
    return header.version >= 5 && header.version <= 7 && header.type != 0 && header.length >= dis_header_octets &&
           header.length <= payload.octets;
}

/* Keeps a datagram's octets: in memory up to a limit; beyond it, by their place in the file. A datagram that came in
 * several packets goes to the scratch file. */
static Status keep_octets(DisDatagram *out, DisPacketReader *reader, Span payload)
{
    const DisCapturePacket *packet = reader->packet;
    DisLog                 *log = reader->log;
    if (!log->file || reader->in_memory + payload.octets <= dis_log_in_memory) {
        uint8_t *bytes = arena_alloc(reader->arena, payload.octets, 1);
        if (!bytes) return STATUS_NO_MEMORY;
        memcpy(bytes, payload.at, payload.octets);
        out->bytes = bytes;
        reader->in_memory += payload.octets;
        return STATUS_OK;
    }
    out->packet |= dis_datagram_on_disk;
    const bool here = payload.at >= packet->bytes && payload.at < packet->bytes + packet->octets;
    if (!here || packet->at == UINT64_MAX) return dis_log_file_keep(&out->at, log->file, payload.at, payload.octets);
    out->at = packet->at + (uint64_t)(payload.at - packet->bytes);
    return STATUS_OK;
}

static void keep_datagram(DisPacketReader *reader, Span payload)
{
    DisLog *log = reader->log;
    if (log->count == reader->capacity) {
        const int capacity = reader->capacity ? reader->capacity > INT_MAX / 2 ? INT_MAX : 2 * reader->capacity : 1024;
        DisDatagram *grown =
            log->count == INT_MAX ? NULL : realloc(log->datagram, (size_t)capacity * sizeof *log->datagram);
        if (!grown) {
            reader->status = STATUS_NO_MEMORY;
            return;
        }
        log->datagram = grown;
        reader->capacity = capacity;
    }
    DisDatagram kept = {.capture_s = reader->capture_s,
                        .packet_s = reader->capture_s,
                        .packet = (uint32_t)log->counters.packets,
                        .octets = (uint32_t)payload.octets};
    reader->status = keep_octets(&kept, reader, payload);
    if (reader->status == STATUS_OK) log->datagram[log->count++] = kept;
}

/* packets: how many packets of the file this IP payload came in. */
static void read_udp(DisPacketReader *reader, Span ip_payload, uint32_t packets)
{
    DisLogCounters *counters = &reader->log->counters;
    if (ip_payload.octets < 8) {
        counters->cut_short += packets;
        return;
    }
    const uint16_t port = dis_load_u16(ip_payload.at + 2); /* destination */
    const size_t   length = dis_load_u16(ip_payload.at + 4);
    if (length < 8 || length > ip_payload.octets) {
        counters->cut_short += packets;
        return;
    }
    const Span payload = {ip_payload.at + 8, length - 8};
    if (reader->port == dis_port_default && port == dis_port && !reader->sure) {
        reader->sure = true;
        reader->log->count = 0;
        counters->other_port += reader->maybe;
        arena_reset(reader->arena);
        reader->in_memory = 0;
    }
    const bool any = reader->port == dis_port_any || (reader->port == dis_port_default && !reader->sure);
    if (any ? !looks_like_dis(payload) : port != (reader->port == dis_port_default ? dis_port : reader->port)) {
        counters->other_port += packets;
        return;
    }
    reader->maybe += packets;
    keep_datagram(reader, payload);
}

/* ---- fragments ----------------------------------------------------------------------------------- */

static void give_up(DisPacketReader *reader, Assembly *a)
{
    reader->log->counters.bad_fragment += a->packets;
    a->used = false;
}

static Assembly *find_assembly(DisPacketReader *reader, const uint8_t key[40])
{
    Assembly *free_one = NULL, *oldest = NULL;
    for (int i = 0; i < assemblies; i++) {
        Assembly *a = &reader->assembly[i];
        if (!a->used) {
            if (!free_one) free_one = a;
            continue;
        }
        if (memcmp(a->key, key, sizeof a->key) == 0) {
            if (fabs(reader->capture_s - a->first_s) <= assembly_age_s) return a;
            give_up(reader, a);
            free_one = a;
            break;
        }
        if (!oldest || a->age < oldest->age) oldest = a;
    }
    if (!free_one) {
        give_up(reader, oldest);
        free_one = oldest;
    }
    uint8_t *bytes = free_one->bytes ? free_one->bytes : malloc(ip_payload_limit + 1);
    if (!bytes) {
        reader->status = STATUS_NO_MEMORY;
        return NULL;
    }
    *free_one = (Assembly){.used = true, .age = reader->fragments++, .first_s = reader->capture_s, .bytes = bytes};
    memcpy(free_one->key, key, sizeof free_one->key);
    return free_one;
}

/* Inserts one fragment. Of overlapping octets those received first stay, so that the result is deterministic. Returns
 * the assembly when it is complete, for the caller to release; NULL otherwise. */
static Assembly *add_fragment(DisPacketReader *reader, const uint8_t key[40], size_t offset, bool more, uint8_t next,
                              Span part)
{
    Assembly *a = find_assembly(reader, key);
    if (!a) return NULL;
    a->packets++;

    const size_t end = offset + part.octets;
    const bool   fits = part.octets > 0 && end <= ip_payload_limit && (!more || part.octets % fragment_unit == 0);
    const bool   agrees =
        more ? a->total == 0 || end <= a->total : (a->total == 0 || a->total == end) && end >= a->furthest;
    if (!fits || !agrees) {
        give_up(reader, a);
        return NULL;
    }
    if (!more) a->total = end;
    if (end > a->furthest) a->furthest = end;
    if (offset == 0 && !a->first_seen) {
        a->first_seen = true;
        a->next = next;
    }
    for (size_t from = offset; from < end; from += fragment_unit) {
        const size_t   unit = from / fragment_unit;
        const uint64_t bit = (uint64_t)1 << unit % 64;
        if (a->have[unit / 64] & bit) continue;
        a->have[unit / 64] |= bit;
        a->units++;
        const size_t octets = end - from < fragment_unit ? end - from : fragment_unit;
        memcpy(a->bytes + from, part.at + (from - offset), octets);
    }
    const bool whole = a->total && a->units == (a->total + fragment_unit - 1) / fragment_unit;
    return whole ? a : NULL;
}

/* ---- IP -------------------------------------------------------------------------------------------- */

static void read_ipv4(DisPacketReader *reader, Span packet)
{
    DisLogCounters *counters = &reader->log->counters;
    if (packet.octets < 20) {
        counters->cut_short++;
        return;
    }
    const uint8_t *p = packet.at;
    const size_t   header = 4 * (size_t)(p[0] & 15);
    size_t         total = dis_load_u16(p + 2);
    if (total == 0)
        total =
            packet.octets; /* checksum offload: the packet was captured before the network card filled in its length */
    if (p[0] >> 4 != 4 || header < 20) {
        counters->other_protocol++;
        return;
    }
    if (p[9] != protocol_udp) {
        counters->other_protocol++;
        return;
    }
    if (total < header || total > packet.octets) {
        counters->cut_short++;
        return;
    }
    const Span     payload = {p + header, total - header};
    const uint16_t flags = dis_load_u16(p + 6);
    const size_t   offset = (size_t)(flags & 0x1FFF) * fragment_unit;
    const bool     more = flags & 0x2000;
    if (offset == 0 && !more) {
        read_udp(reader, payload, 1);
        return;
    }
    uint8_t key[40] = {4, p[9], p[4], p[5]};
    memcpy(key + 8, p + 12, 8);
    Assembly *a = add_fragment(reader, key, offset, more, protocol_udp, payload);
    if (!a) return;
    read_udp(reader, (Span){a->bytes, a->total}, a->packets);
    a->used = false;
}

/* Extension headers from `next` on, then UDP. whole: this payload has been put together already, and a
 * fragment in it is an error. */
static void read_ipv6_payload(DisPacketReader *reader, const uint8_t *addresses, uint8_t next, Span payload,
                              uint32_t packets, bool whole)
{
    DisLogCounters *counters = &reader->log->counters;
    for (;;) {
        if (next == protocol_udp) {
            read_udp(reader, payload, packets);
            return;
        }
        const bool options = next == protocol_hop_by_hop || next == protocol_routing || next == protocol_destination ||
                             next == protocol_mobility;
        if (!options && next != protocol_authentication && next != protocol_fragment) {
            counters->other_protocol += packets;
            return;
        }
        if (payload.octets < 8) {
            counters->cut_short += packets;
            return;
        }
        const uint8_t *p = payload.at;
        if (next == protocol_fragment) {
            const uint16_t flags = dis_load_u16(p + 2);
            const size_t   offset = flags & 0xFFF8;
            const bool     more = flags & 1;
            const Span     part = {p + 8, payload.octets - 8};
            if (offset == 0 && !more) { /* it is an atomic fragment, a whole payload with a fragment header: RFC 6946 */
                next = p[0];
                payload = part;
                continue;
            }
            if (whole) {
                counters->bad_fragment += packets;
                return;
            }
            uint8_t key[40] = {6, 0, 0, 0};
            memcpy(key + 4, p + 4, 4);
            memcpy(key + 8, addresses, 32);
            Assembly *a = add_fragment(reader, key, offset, more, p[0], part);
            if (!a) return;
            read_ipv6_payload(reader, addresses, a->next, (Span){a->bytes, a->total}, a->packets, true);
            a->used = false;
            return;
        }
        const size_t octets = next == protocol_authentication ? 4 * ((size_t)p[1] + 2) : 8 * ((size_t)p[1] + 1);
        if (octets > payload.octets) {
            counters->cut_short += packets;
            return;
        }
        next = p[0];
        payload = (Span){p + octets, payload.octets - octets};
    }
}

static void read_ipv6(DisPacketReader *reader, Span packet)
{
    DisLogCounters *counters = &reader->log->counters;
    if (packet.octets < 40) {
        counters->cut_short++;
        return;
    }
    const uint8_t *p = packet.at;
    const size_t   length = dis_load_u16(p + 4);
    if (p[0] >> 4 != 6) {
        counters->other_protocol++;
        return;
    }
    if (length > packet.octets - 40) {
        counters->cut_short++;
        return;
    }
    read_ipv6_payload(reader, p + 8, p[6], (Span){p + 40, length}, 1, false);
}

static void read_ip(DisPacketReader *reader, Span packet)
{
    if (packet.octets == 0) reader->log->counters.cut_short++;
    else if (packet.at[0] >> 4 == 6) read_ipv6(reader, packet);
    else read_ipv4(reader, packet);
}

/* ---- link layers ------------------------------------------------------------------------------------- */

/* Reads a frame from its EtherType on, through any stack of VLAN tags. */
static void read_ethertype(DisPacketReader *reader, uint16_t type, Span rest)
{
    while (type == ethertype_vlan || type == ethertype_service_vlan || type == ethertype_old_service_vlan) {
        if (rest.octets < 4) {
            reader->log->counters.cut_short++;
            return;
        }
        type = dis_load_u16(rest.at + 2);
        rest = (Span){rest.at + 4, rest.octets - 4};
    }
    /* 802.3 with LLC and SNAP: a length stands where the EtherType would be */
    static const uint8_t snap[6] = {0xAA, 0xAA, 3, 0, 0, 0};
    if (type < 0x600 && rest.octets >= 8 && memcmp(rest.at, snap, sizeof snap) == 0) {
        type = dis_load_u16(rest.at + 6);
        rest = (Span){rest.at + 8, rest.octets - 8};
    }
    if (type == ethertype_ipv4) read_ipv4(reader, rest);
    else if (type == ethertype_ipv6) read_ipv6(reader, rest);
    else reader->log->counters.other_protocol++;
}

/* BSD loopback: the packet begins with an address family in the byte order of the machine that captured it. 2 is IPv4
 * everywhere; IPv6 is 24, 28 or 30 on BSDs, 10 on Linux, 23 on Windows. */
static bool is_ip_family(uint32_t family)
{
    if (family > 0xFFFF) family = __builtin_bswap32(family);
    return family == 2 || family == 10 || family == 23 || family == 24 || family == 28 || family == 30;
}

/* Offset of the network layer; 0: an unsupported link layer. */
static size_t link_header_octets(int link)
{
    switch (link) {
    case link_ethernet:
        return 14;
    case link_sll:
        return 16;
    case link_sll2:
        return 20;
    case link_null:
    case link_loop:
        return 4;
    default:
        return 0;
    }
}

bool dis_packet_reads(int link)
{
    return link_header_octets(link) || link == link_raw || link == link_ipv4 || link == link_ipv6 ||
           link == link_raw_bsd || link == link_raw_openbsd;
}

static void read_frame(DisPacketReader *reader, int link, Span frame)
{
    const size_t header = link_header_octets(link);
    if (frame.octets < header) {
        reader->log->counters.cut_short++;
        return;
    }
    const Span rest = {frame.at + header, frame.octets - header};
    switch (link) {
    case link_ethernet:
        read_ethertype(reader, dis_load_u16(frame.at + 12), rest);
        break;
    case link_sll:
        read_ethertype(reader, dis_load_u16(frame.at + 14), rest);
        break;
    case link_sll2:
        read_ethertype(reader, dis_load_u16(frame.at), rest);
        break;
    case link_null:
    case link_loop:
        if (is_ip_family(dis_load_u32(frame.at))) read_ip(reader, rest);
        else reader->log->counters.other_protocol++;
        break;
    default:
        read_ip(reader, frame);
        break;
    }
}

/* ---- the reader ---------------------------------------------------------------------------------------- */

Status dis_packet_reader_create(DisPacketReader **out, DisLog *log, Arena *arena, int port)
{
    DisPacketReader *reader = calloc(1, sizeof *reader);
    if (!reader) return STATUS_NO_MEMORY;
    reader->log = log;
    reader->arena = arena;
    reader->port = port;
    *out = reader;
    return STATUS_OK;
}

void dis_packet_reader_destroy(DisPacketReader *reader)
{
    if (!reader) return;
    for (int i = 0; i < assemblies; i++) free(reader->assembly[i].bytes);
    free(reader);
}

Status dis_packet_read(DisPacketReader *reader, const DisCapturePacket *packet)
{
    reader->packet = packet;
    reader->capture_s = packet->capture_s;
    read_frame(reader, packet->link, (Span){packet->bytes, packet->octets});
    return reader->status;
}

bool dis_packet_reader_end(DisPacketReader *reader)
{
    for (int i = 0; i < assemblies; i++)
        if (reader->assembly[i].used) give_up(reader, &reader->assembly[i]);
    return reader->port == dis_port_default && !reader->sure && (reader->maybe || reader->log->counters.other_port);
}
