/* tests/dis/test_log.c: one datagram through every layer a capture may wrap it in, and captures that lie. */
#include "tests/check.h"
#include "tests/dis/make_capture.h"
#include "tests/dis/random_pdu.h"

#include "dis/capture/log.h"

#include <sys/mman.h>

enum {
    link_null = 0,
    link_ethernet = 1,
    link_raw = 101,
    link_loop = 108,
    link_sll = 113,
    link_ipv4 = 228,
    link_ipv6 = 229,
    link_sll2 = 276
};

static Bytes   file, packet;
static uint8_t payload[65536];
static char    said[4096]; /* the log, to see that a failure explains itself */

static void listen_to(void *user, LogLevel level, const char *line)
{
    (void)user;
    (void)level;
    strncat(said, line, sizeof said - strlen(said) - 1);
}

static Status open_bytes(DisLog *log, int port)
{
    char path[64];
    CHECK(write_file(path, &file));
    said[0] = 0;
    log_set_sink(listen_to, NULL);
    const Status status = dis_log_open(log, path, port);
    log_set_sink(NULL, NULL);
    unlink(path);
    return status;
}

/* A DIS header with `octets` to its name, and a body that shows misplacement. */
static void make_payload(size_t octets)
{
    for (size_t i = 0; i < octets; i++) payload[i] = (uint8_t)(i * 7 + (i >> 8));
    payload[0] = 7;
    payload[2] = 20;
    payload[8] = (uint8_t)(octets >> 8);
    payload[9] = (uint8_t)octets;
}

static void expect_one(int port, size_t octets, uint32_t number)
{
    DisLog log;
    CHECK(open_bytes(&log, port) == STATUS_OK);
    CHECK(log.count == 1 && !log.truncated);
    CHECK(log.datagram[0].packet == number && log.datagram[0].octets == octets);
    CHECK(memcmp(log.datagram[0].bytes, payload, octets) == 0);
    dis_log_close(&log);
    CHECK(log.count == 0 && log.datagram == NULL);
}

static void expect_none(int port, DisLogCounters want)
{
    DisLog log;
    CHECK(open_bytes(&log, port) == STATUS_OK);
    CHECK(log.count == 0);
    CHECK(log.counters.other_protocol == want.other_protocol && log.counters.other_port == want.other_port);
    CHECK(log.counters.cut_short == want.cut_short && log.counters.bad_fragment == want.bad_fragment);
    dis_log_close(&log);
}

/* The packet alone in a pcap. */
static void only_packet(uint32_t link)
{
    pcap_begin(&file, link, false, false);
    pcap_packet(&file, 1000, 0, &packet, packet.count, false);
}

/* ---- link layers ------------------------------------------------------------------------------------- */

static void every_link_layer_gives_the_datagram(void **state)
{
    (void)state;
    make_payload(200);
    /* what lies before IP on each */
    static const struct {
        uint32_t    link;
        size_t      octets;
        const char *before;
        bool        v6;
    } layer[] = {
        {link_ethernet, 14, "\1\2\3\4\5\6\7\10\11\12\13\14\x08\x00", false},
        {link_ethernet, 14, "\1\2\3\4\5\6\7\10\11\12\13\14\x86\xDD", true},
        {link_ethernet, 18, "\1\2\3\4\5\6\7\10\11\12\13\14\x81\x00\x00\x05\x08\x00", false},
        {link_ethernet, 22, "\1\2\3\4\5\6\7\10\11\12\13\14\x88\xA8\x00\x05\x81\x00\x00\x06\x86\xDD", true},
        {link_ethernet, 26, "\1\2\3\4\5\6\7\10\11\12\13\14\x91\x00\0\1\x88\xA8\x00\x05\x81\x00\x00\x06\x08\x00", false},
        {link_ethernet, 22, "\1\2\3\4\5\6\7\10\11\12\13\14\x00\xEC\xAA\xAA\x03\0\0\0\x08\x00", false},
        {link_sll, 16, "\0\4\0\1\0\6\0\0\0\0\0\0\0\0\x08\x00", false},
        {link_sll, 16, "\0\4\0\1\0\6\0\0\0\0\0\0\0\0\x86\xDD", true},
        {link_sll2, 20, "\x08\x00\0\0\0\0\0\1\0\1\4\6\0\0\0\0\0\0\0\0", false},
        {link_sll2, 20, "\x86\xDD\0\0\0\0\0\1\0\1\4\6\0\0\0\0\0\0\0\0", true},
        {link_null, 4, "\2\0\0\0", false},
        {link_null, 4, "\0\0\0\2", false},
        {link_null, 4, "\x1E\0\0\0", true},
        {link_null, 4, "\0\0\0\x18", true},
        {link_loop, 4, "\0\0\0\2", false},
        {link_loop, 4, "\0\0\0\x1C", true},
        {link_raw, 0, "", false},
        {link_raw, 0, "", true},
        {link_ipv4, 0, "", false},
        {link_ipv6, 0, "", true},
    };
    for (size_t i = 0; i < sizeof layer / sizeof layer[0]; i++) {
        packet.count = 0;
        put(&packet, layer[i].before, layer[i].octets);
        if (layer[i].v6) put_ipv6(&packet, 17, 208);
        else put_ipv4(&packet, 17, 208, 1, 0, 0);
        put_udp(&packet, 3000, payload, 200);
        only_packet(layer[i].link);
        expect_one(3000, 200, 1);
    }
}

static void foreign_link_layers_are_named(void **state)
{
    (void)state;
    packet.count = 0;
    put_zeros(&packet, 60);
    only_packet(105); /* IEEE 802.11 */
    DisLog log;
    CHECK(open_bytes(&log, 3000) == STATUS_UNSUPPORTED);
    CHECK(strstr(said, "802_11") && strstr(said, "Ethernet"));
}

/* ---- stamps and formats ------------------------------------------------------------------------------ */

static void every_file_format_keeps_the_time(void **state)
{
    (void)state;
    make_payload(64);
    packet.count = 0;
    put_ipv4(&packet, 17, 72, 1, 0, 0);
    put_udp(&packet, 3000, payload, 64);
    for (int format = 0; format < 5; format++) {
        const bool nanoseconds = format & 1, big = format & 2;
        if (format < 4) {
            pcap_begin(&file, link_raw, nanoseconds, big);
            pcap_packet(&file, 1700000000, nanoseconds ? 250000000 : 250000, &packet, packet.count, big);
            pcap_packet(&file, 1700000001, 999, &packet, packet.count, big);
        } else {
            pcapng_begin(&file, link_raw);
            pcapng_packet(&file, 1700000000250000000u, &packet);
            pcapng_packet(&file, 1700000001000000999u, &packet);
        }
        DisLog log;
        CHECK(open_bytes(&log, 3000) == STATUS_OK);
        CHECK(log.count == 2 && log.datagram[1].packet == 2 && !log.truncated);
        /* a double holds Unix time to 0.24 us */
        CHECK_NEAR(log.datagram[0].capture_s, 1700000000.25, 0);
        CHECK_NEAR(log.datagram[1].capture_s - 1700000001.0, format == 0 || format == 2 ? 999e-6 : 999e-9, 2.4e-7);
        dis_log_close(&log);
    }
}

/* A simple packet block has the packet's original length alone: the capture kept what the block has room for, or the
 * interface's snap length where that is less. It has no time of its own. */
static void simple_packets_are_as_long_as_their_block(void **state)
{
    (void)state;
    make_payload(64);
    packet.count = 0;
    put_ipv4(&packet, 17, 72, 1, 0, 0);
    put_udp(&packet, 3000, payload, 64);
    CHECK(packet.count % 4 == 0);
    for (uint32_t cut = 0; cut <= 12; cut++) {
        pcapng_begin(&file, link_raw);
        pcapng_packet(&file, 1700000000250000000u, &packet);
        const uint32_t length = 16 + (uint32_t)packet.count;
        put_file32(&file, 3, false);
        put_file32(&file, length, false);
        put_file32(&file, (uint32_t)packet.count + cut, false);
        put(&file, packet.at, packet.count);
        put_file32(&file, length, false);
        DisLog log;
        CHECK(open_bytes(&log, 3000) == STATUS_OK);
        CHECK(log.count == 2 && !log.truncated && log.datagram[1].octets == 64);
        CHECK_NEAR(log.datagram[1].capture_s, 1700000000.25, 0);
        dis_log_close(&log);
    }
}

/* The header of IPv4 alone, 20 octets, is whole: its protocol is looked at. With 19 it is cut short. */
static void an_ipv4_header_has_20_octets(void **state)
{
    (void)state;
    for (size_t octets = 19; octets <= 20; octets++) {
        packet.count = 0;
        put_ipv4(&packet, 6, 20, 1, 0, 0);
        CHECK(packet.count == 20);
        packet.count = octets;
        pcap_begin(&file, link_raw, true, false);
        pcap_packet(&file, 1000, 0, &packet, packet.count, false);
        expect_none(3000, (DisLogCounters){.cut_short = octets < 20, .other_protocol = octets == 20});
    }
}

static void a_truncated_file_gives_what_it_has(void **state)
{
    (void)state;
    make_payload(64);
    packet.count = 0;
    put_ipv4(&packet, 17, 72, 1, 0, 0);
    put_udp(&packet, 3000, payload, 64);
    for (int format = 0; format < 2; format++) {
        if (format == 0) pcap_begin(&file, link_raw, true, false);
        else pcapng_begin(&file, link_raw);
        const size_t head = file.count;
        for (int i = 0; i < 3; i++) {
            if (format == 0) pcap_packet(&file, 1000, 0, &packet, packet.count, false);
            else pcapng_packet(&file, 1000, &packet);
        }
        const size_t one = (file.count - head) / 3, whole = file.count;
        for (size_t octets = head; octets <= whole; octets += 5) {
            file.count = octets;
            DisLog log;
            CHECK(open_bytes(&log, 3000) == STATUS_OK);
            CHECK(log.count == (int)((octets - head) / one));
            CHECK(log.truncated == ((octets - head) % one != 0));
            CHECK(!log.truncated || strstr(said, "ends early"));
            dis_log_close(&log);
        }
    }
}

static void what_is_no_capture_says_so(void **state)
{
    (void)state;
    DisLog log = {.count = 77};
    file.count = 0;
    put(&file, "# a text log\n-1,2,3\n", 20);
    CHECK(open_bytes(&log, 3000) == STATUS_UNSUPPORTED);
    CHECK(strstr(said, "pcapng") && strstr(said, "dislog"));
    file.count = 0;
    CHECK(open_bytes(&log, 3000) == STATUS_TRUNCATED && strstr(said, "empty"));
    log_set_sink(listen_to, NULL);
    said[0] = 0;
    CHECK(dis_log_open(&log, "/nowhere/at/all.pcap", 3000) == STATUS_IO && strstr(said, "/nowhere/at/all.pcap"));
    said[0] = 0;
    CHECK(dis_log_open(&log, "/tmp", 3000) == STATUS_IO && strstr(said, "/tmp"));
    log_set_sink(NULL, NULL);
    CHECK(log.count == 77); /* untouched by all of them */
}

/* ---- IP and UDP ---------------------------------------------------------------------------------------- */

static void ipv4_options_and_padding(void **state)
{
    (void)state;
    make_payload(20);
    for (int options = 0; options <= 40; options += 20) {
        packet.count = 0;
        put_ethernet(&packet, 0x0800);
        put_ipv4(&packet, 17, 28, 1, 0x4000, options); /* do not fragment */
        put_udp(&packet, 3000, payload, 20);
        put_zeros(&packet, 11); /* Ethernet pads short frames */
        only_packet(link_ethernet);
        expect_one(3000, 20, 1);
    }
}

static void ipv6_extension_headers(void **state)
{
    (void)state;
    make_payload(40);
    packet.count = 0;
    put_ipv6(&packet, 0, 8 + 24 + 16 + 12 + 8 + 48);
    put_u8(&packet, 60); /* hop-by-hop, 8 octets */
    put_zeros(&packet, 7);
    put_u8(&packet, 43); /* destination, 24 octets */
    put_u8(&packet, 2);
    put_zeros(&packet, 22);
    put_u8(&packet, 51); /* routing, 16 octets */
    put_u8(&packet, 1);
    put_zeros(&packet, 14);
    put_u8(&packet, 44); /* authentication: (1 + 2) words of 4 */
    put_u8(&packet, 1);
    put_zeros(&packet, 10);
    put_u8(&packet, 17); /* an atomic fragment */
    put_zeros(&packet, 7);
    put_udp(&packet, 3000, payload, 40);
    only_packet(link_raw);
    expect_one(3000, 40, 1);
}

static void what_is_left_out_is_counted(void **state)
{
    (void)state;
    make_payload(40);
    packet.count = 0;
    put_ipv4(&packet, 6, 48, 1, 0, 0); /* TCP */
    put_udp(&packet, 3000, payload, 40);
    only_packet(link_raw);
    expect_none(3000, (DisLogCounters){.other_protocol = 1});

    packet.count = 0;
    put_ipv4(&packet, 17, 48, 1, 0, 0);
    put_udp(&packet, 3001, payload, 40);
    only_packet(link_raw);
    expect_none(3000, (DisLogCounters){.other_port = 1});
    expect_one(0, 40, 1); /* any port: it looks like DIS */
    expect_one(3001, 40, 1);
    expect_one(dis_port_default, 40, 1); /* nothing went to 3000 */

    static const uint8_t not_dis[] = {0, 4, 9, 1}; /* version, version, length, type */
    for (int i = 0; i < 4; i++) {
        make_payload(40);
        if (i < 2) payload[0] = not_dis[i];
        if (i == 2) payload[9] = 41;
        if (i == 3) payload[2] = 0;
        packet.count = 0;
        put_ipv4(&packet, 17, 48, 1, 0, 0);
        put_udp(&packet, 3001, payload, 40);
        only_packet(link_raw);
        expect_none(0, (DisLogCounters){.other_port = 1});
    }

    make_payload(40);
    packet.count = 0;
    put_ethernet(&packet, 0x0806); /* ARP */
    put_zeros(&packet, 46);
    only_packet(link_ethernet);
    expect_none(3000, (DisLogCounters){.other_protocol = 1});
}

/* Lengths that do not fit what was captured: at every capture length below the whole, cut short, never more. */
static void cut_packets_give_nothing(void **state)
{
    (void)state;
    make_payload(40);
    for (int v6 = 0; v6 < 2; v6++) {
        packet.count = 0;
        put_ethernet(&packet, v6 ? 0x86DD : 0x0800);
        if (v6) put_ipv6(&packet, 17, 48);
        else put_ipv4(&packet, 17, 48, 1, 0, 0);
        put_udp(&packet, 3000, payload, 40);
        for (size_t captured = 0; captured < packet.count; captured++) {
            pcap_begin(&file, link_ethernet, true, false);
            pcap_packet(&file, 1000, 0, &packet, captured, false);
            expect_none(3000, (DisLogCounters){.cut_short = 1});
        }
    }
    /* a UDP length of 7, and one beyond the IP payload */
    static const unsigned udp_length[] = {7, 49, 65535, 0};
    for (int i = 0; i < 4; i++) {
        packet.count = 0;
        put_ipv4(&packet, 17, 48, 1, 0, 0);
        put_udp(&packet, 3000, payload, 40);
        packet.at[24] = (uint8_t)(udp_length[i] >> 8);
        packet.at[25] = (uint8_t)udp_length[i];
        only_packet(link_raw);
        expect_none(3000, (DisLogCounters){.cut_short = 1});
    }
}

/* ---- fragments ------------------------------------------------------------------------------------------ */

typedef struct Fragment {
    size_t from, to; /* of the IP payload: UDP header and all */
} Fragment;

static Bytes udp;

static void put_fragment(Fragment f, bool v6, unsigned id, bool more, uint32_t s)
{
    packet.count = 0;
    if (v6) {
        put_ipv6(&packet, 44, 8 + f.to - f.from);
        put_u8(&packet, 17);
        put_u8(&packet, 0);
        put_be16(&packet, (unsigned)f.from | more);
        put_be32(&packet, id);
    } else {
        put_ipv4(&packet, 17, f.to - f.from, id, (unsigned)(f.from / 8) | (more ? 0x2000u : 0), 0);
    }
    put(&packet, udp.at + f.from, f.to - f.from);
    pcap_packet(&file, s, 0, &packet, packet.count, false);
}

static void make_udp(size_t octets)
{
    make_payload(octets);
    udp.count = 0;
    put_udp(&udp, 3000, payload, octets);
}

/* 3000 octets and 8 of UDP in five parts, in every one of the 120 orders: the datagram appears with the packet
 * that completes it. */
static void fragments_in_every_order(void **state)
{
    (void)state;
    static const Fragment part[5] = {{0, 800}, {800, 1600}, {1600, 1608}, {1608, 2400}, {2400, 3008}};
    make_udp(3000);
    for (int v6 = 0; v6 < 2; v6++) {
        for (int order = 0; order < 120; order++) {
            int left[5] = {0, 1, 2, 3, 4}, code = order;
            pcap_begin(&file, link_raw, true, false);
            for (int n = 5; n > 0; n--) {
                const int pick = code % n;
                code /= n;
                put_fragment(part[left[pick]], v6, 77, left[pick] != 4, 1000);
                memmove(&left[pick], &left[pick + 1], (size_t)(n - pick - 1) * sizeof left[0]);
            }
            expect_one(3000, 3000, 5);
        }
    }
}

static void fragments_of_several_datagrams_are_told_apart(void **state)
{
    (void)state;
    make_udp(3000);
    pcap_begin(&file, link_raw, true, false);
    for (int half = 0; half < 2; half++) {
        for (unsigned id = 1; id <= 40; id++) {
            const bool v6 = id % 2;
            put_fragment(half ? (Fragment){1600, 3008} : (Fragment){0, 1600}, v6, id, !half, 1000);
        }
    }
    DisLog log;
    CHECK(open_bytes(&log, 3000) == STATUS_OK);
    CHECK(log.count == 40 && log.counters.bad_fragment == 0);
    for (int i = 0; i < 40; i++) {
        CHECK(log.datagram[i].packet == (uint32_t)(41 + i) && log.datagram[i].octets == 3000);
        CHECK(memcmp(log.datagram[i].bytes, payload, 3000) == 0);
    }
    dis_log_close(&log);
}

static void the_largest_datagram(void **state)
{
    (void)state;
    make_udp(65507); /* 65535 less the IP and UDP headers: the last fragment is no whole unit */
    pcap_begin(&file, link_raw, true, false);
    uint32_t packets = 0;
    for (size_t from = 0; from < 65515; from += 1480, packets++) {
        const size_t to = from + 1480 < 65515 ? from + 1480 : 65515;
        put_fragment((Fragment){from, to}, false, 5, to != 65515, 1000);
    }
    expect_one(3000, 65507, packets);
}

/* Repeated and overlapping fragments: what came first stays. */
static void overlaps_have_one_outcome(void **state)
{
    (void)state;
    make_udp(1000); /* 1008 octets */
    pcap_begin(&file, link_raw, true, false);
    put_fragment((Fragment){0, 504}, false, 9, true, 1000);
    put_fragment((Fragment){0, 504}, false, 9, true, 1000);
    memset(udp.at + 400, 0xBB, 104); /* a liar */
    put_fragment((Fragment){400, 504}, false, 9, true, 1000);
    udp.count = 0;
    put_udp(&udp, 3000, payload, 1000);
    put_fragment((Fragment){496, 1008}, false, 9, false, 1000);
    expect_one(3000, 1000, 4);
}

static void bad_fragments_are_counted(void **state)
{
    (void)state;
    static const struct {
        Fragment a, b;
        bool     a_more, b_more;
        uint64_t bad;
    } odd[] = {
        {{0, 500}, {504, 1008}, true, false, 2},     /* not whole units: given up, and its rest never comes whole */
        {{0, 504}, {512, 1008}, true, false, 2},     /* a hole */
        {{8, 504}, {504, 1008}, true, false, 2},     /* no beginning */
        {{504, 1008}, {0, 1008}, false, true, 2},    /* more, and yet all of it: no end agrees with the length */
        {{504, 1008}, {1000, 1016}, false, true, 2}, /* beyond the end */
        {{504, 1008}, {504, 1000}, false, false, 2}, /* two ends */
    };
    make_udp(1200);
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        for (int v6 = 0; v6 < 2; v6++) {
            pcap_begin(&file, link_raw, true, false);
            put_fragment(odd[i].a, v6, 3, odd[i].a_more, 1000);
            put_fragment(odd[i].b, v6, 3, odd[i].b_more, 1000);
            DisLog log;
            CHECK(open_bytes(&log, 3000) == STATUS_OK);
            if (i == 3) { /* whole after all: 1008 octets of a UDP length of 1208 */
                CHECK(log.count == 0 && log.counters.cut_short == 2);
            } else {
                CHECK(log.count == 0 && log.counters.bad_fragment == odd[i].bad);
            }
            dis_log_close(&log);
        }
    }
}

/* An identification used again after a minute is another datagram. */
static void identifications_come_round(void **state)
{
    (void)state;
    make_udp(1000);
    pcap_begin(&file, link_raw, true, false);
    put_fragment((Fragment){0, 504}, false, 4, true, 1000);
    put_fragment((Fragment){504, 1008}, false, 4, false, 1060);
    expect_none(3000, (DisLogCounters){.bad_fragment = 2});
}

/* Many beginnings and no ends: bounded, the oldest given up, the newest still finished. */
static void assemblies_are_bounded(void **state)
{
    (void)state;
    make_udp(1000);
    pcap_begin(&file, link_raw, true, false);
    for (unsigned id = 0; id < 500; id++) put_fragment((Fragment){0, 504}, false, id, true, 1000);
    for (unsigned id = 499; id > 0; id--) put_fragment((Fragment){504, 1008}, false, id, false, 1000);
    DisLog log;
    CHECK(open_bytes(&log, 3000) == STATUS_OK);
    CHECK(log.count == 64); /* those still in assembly when the ends came */
    CHECK(log.counters.packets == 999 && log.counters.bad_fragment == 999 - 2 * 64);
    dis_log_close(&log);
}

/* ---- spoilt files ------------------------------------------------------------------------------------------ */

static void spoilt_captures_do_no_harm(void **state)
{
    (void)state;
    static Bytes good;
    make_udp(600);
    Dice d = dice(5);
    log_set_level((LogLevel)(LOG_ERROR + 1));
    uint64_t opened = 0, datagrams = 0;
    for (int round = 0; round < 6000; round++) {
        if (round % 3 == 2) {
            pcapng_begin(&good, link_raw);
        } else {
            static const uint32_t links[] = {link_raw, link_ethernet, link_sll, link_null};
            pcap_begin(&good, links[roll(&d) % 4], false, false);
        }
        for (int i = 0; i < 6; i++) {
            const bool v6 = i % 2;
            packet.count = 0;
            if (v6) {
                put_ipv6(&packet, 44, 8 + 304);
                put_u8(&packet, 17);
                put_u8(&packet, 0);
                put_be16(&packet, i < 3 ? 1 : 304);
                put_be32(&packet, 5);
            } else {
                put_ipv4(&packet, 17, 304, 5, i < 3 ? 0x2000 : 38, 0);
            }
            put(&packet, udp.at + (i < 3 ? 0 : 304), 304);
            if (round % 3 == 2) pcapng_packet(&good, 1000, &packet);
            else pcap_packet(&good, 1000, 0, &packet, packet.count, false);
        }
        const int changes = 1 + (int)(roll(&d) % 12);
        for (int i = 0; i < changes; i++) good.at[24 + roll(&d) % (good.count - 24)] = (uint8_t)roll(&d);
        if (roll(&d) % 8 == 0) good.count = roll(&d) % good.count;

        const int fd = memfd_create("capture", 0);
        char      path[64];
        CHECK(fd >= 0 && write(fd, good.at, good.count) == (ssize_t)good.count);
        snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
        DisLog log;
        if (dis_log_open(&log, path, roll(&d) % 2 ? 3000 : 0) == STATUS_OK) {
            opened++;
            datagrams += (uint64_t)log.count;
            size_t kept = 0;
            for (int i = 0; i < log.count; i++) kept += log.datagram[i].octets;
            CHECK(kept <= good.count);
            dis_log_close(&log);
        }
        close(fd);
    }
    log_set_level(LOG_INFO);
    CHECK(opened > 4000 && datagrams > 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_link_layer_gives_the_datagram),
        cmocka_unit_test(foreign_link_layers_are_named),
        cmocka_unit_test(every_file_format_keeps_the_time),
        cmocka_unit_test(simple_packets_are_as_long_as_their_block),
        cmocka_unit_test(an_ipv4_header_has_20_octets),
        cmocka_unit_test(a_truncated_file_gives_what_it_has),
        cmocka_unit_test(what_is_no_capture_says_so),
        cmocka_unit_test(ipv4_options_and_padding),
        cmocka_unit_test(ipv6_extension_headers),
        cmocka_unit_test(what_is_left_out_is_counted),
        cmocka_unit_test(cut_packets_give_nothing),
        cmocka_unit_test(fragments_in_every_order),
        cmocka_unit_test(fragments_of_several_datagrams_are_told_apart),
        cmocka_unit_test(the_largest_datagram),
        cmocka_unit_test(overlaps_have_one_outcome),
        cmocka_unit_test(bad_fragments_are_counted),
        cmocka_unit_test(identifications_come_round),
        cmocka_unit_test(assemblies_are_bounded),
        cmocka_unit_test(spoilt_captures_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
