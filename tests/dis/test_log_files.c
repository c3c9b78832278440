/* tests/dis/test_log_files.c: captures as files: compressed by each program's own library, whole, cut, damaged and
 * overlarge; pcapng with several interfaces and sections; and libpcap as the judge of what both of us read. */
#include "tests/check.h"
#include "tests/dis/make_capture.h"

#include "dis/capture/log.h"

#include <bzlib.h>
#include <lzma.h>
#include <pcap/pcap.h>
#include <zlib.h>
#include <zstd.h>

enum { link_ethernet = 1, link_raw = 101, link_80211 = 105, link_sll2 = 276, octets_of_pdu = 160 };

static Bytes   file, packet, packed;
static uint8_t pdu[octets_of_pdu] = {7, 1, 20, 5, 0, 0, 0, 0, 0, octets_of_pdu};
static char    said[4096];

static void listen_to(void *user, LogLevel level, const char *line)
{
    (void)user;
    (void)level;
    strncat(said, line, sizeof said - strlen(said) - 1);
}

static Status open_bytes(DisLog *log, const Bytes *bytes)
{
    char path[64];
    CHECK(write_file(path, bytes));
    said[0] = 0;
    log_set_sink(listen_to, NULL);
    const Status status = dis_log_open(log, path, 3000);
    log_set_sink(NULL, NULL);
    unlink(path);
    return status;
}

static void make_packet(uint32_t link, unsigned mark)
{
    packet.count = 0;
    if (link == link_ethernet) put_ethernet(&packet, 0x0800);
    if (link == link_sll2) put(&packet, "\x08\x00\0\0\0\0\0\1\0\1\4\6\0\0\0\0\0\0\0\0", 20);
    put_ipv4(&packet, 17, octets_of_pdu + 8, mark, 0, 0);
    pdu[octets_of_pdu - 2] = (uint8_t)(mark >> 8);
    pdu[octets_of_pdu - 1] = (uint8_t)mark;
    put_udp(&packet, 3000, pdu, octets_of_pdu);
}

/* `count` datagrams that can be told apart, with octets that do not compress away. */
static void make_file(int count)
{
    pcap_begin(&file, link_ethernet, true, false);
    for (int i = 0; i < count; i++) {
        for (int k = 12; k < octets_of_pdu - 2; k++)
            pdu[k] = (uint8_t)(random_uniform(3, 1, (uint32_t)i, (uint64_t)k) * 256);
        make_packet(link_ethernet, (unsigned)i);
        pcap_packet(&file, 1000 + (uint32_t)i, 0, &packet, packet.count, false);
    }
}

static int mark_of(const DisDatagram *d) { return d->bytes[d->octets - 2] << 8 | d->bytes[d->octets - 1]; }

/* ---- compressed ------------------------------------------------------------------------------------------ */

enum { GZIP, ZSTD, BZIP2, XZ, PACKINGS };

static void pack_more(int packing, const uint8_t *from, size_t octets)
{
    size_t   room = sizeof packed.at - packed.count;
    uint8_t *to = packed.at + packed.count;
    if (packing == GZIP) {
        z_stream z = {
            .next_in = (uint8_t *)(uintptr_t)from, .avail_in = (uInt)octets, .next_out = to, .avail_out = (uInt)room};
        CHECK(deflateInit2(&z, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY) == Z_OK &&
              deflate(&z, Z_FINISH) == Z_STREAM_END);
        room -= z.avail_out;
        deflateEnd(&z);
    } else if (packing == ZSTD) {
        ZSTD_CCtx *c = ZSTD_createCCtx();
        ZSTD_CCtx_setParameter(c, ZSTD_c_checksumFlag, 1); /* as the program does */
        room = ZSTD_compress2(c, to, room, from, octets);
        CHECK(!ZSTD_isError(room));
        ZSTD_freeCCtx(c);
    } else if (packing == BZIP2) {
        unsigned made = (unsigned)room;
        CHECK(BZ2_bzBuffToBuffCompress((char *)to, &made, (char *)(uintptr_t)from, (unsigned)octets, 9, 0, 0) == BZ_OK);
        room = made;
    } else {
        size_t made = 0;
        CHECK(lzma_easy_buffer_encode(6, LZMA_CHECK_CRC64, NULL, from, octets, to, &made, room) == LZMA_OK);
        room = made;
    }
    packed.count += room;
}

static void expect_whole(int count)
{
    DisLog log;
    CHECK(open_bytes(&log, &packed) == STATUS_OK);
    CHECK(log.count == count && !log.truncated);
    for (int i = 0; i < count; i++) CHECK(mark_of(&log.datagram[i]) == i);
    dis_log_close(&log);
}

static void every_packing_gives_the_datagrams(void **state)
{
    (void)state;
    for (int packing = 0; packing < PACKINGS; packing++) {
        make_file(500); /* more than one buffer */
        packed.count = 0;
        pack_more(packing, file.at, file.count);
        expect_whole(500);
        CHECK(!*said);

        packed.count = 0; /* cut anywhere and compressed apart: one capture; padding behind it is none of it */
        pack_more(packing, file.at, 7);
        pack_more(packing, file.at + 7, 70000);
        pack_more(packing, file.at + 70007, 0);
        pack_more(packing, file.at + 70007, file.count - 70007);
        put_zeros(&packed, 1024);
        expect_whole(500);
        CHECK(!*said);

        put(&packed, "something else", 14);
        expect_whole(500);
        CHECK(strstr(said, "behind the end"));
    }
}

static void a_cut_stream_gives_what_it_has(void **state)
{
    (void)state;
    for (int packing = 0; packing < PACKINGS; packing++) {
        make_file(40);
        packed.count = 0;
        pack_more(packing, file.at, file.count);
        const size_t whole = packed.count;
        int          most = 0;
        for (size_t octets = 1; octets < whole; octets += 1 + whole / 30) {
            DisLog log = {0};
            packed.count = octets;
            if (open_bytes(&log, &packed) != STATUS_OK) {
                CHECK(strstr(said, "not a capture"));
                continue;
            }
            CHECK(log.truncated && strstr(said, "ends early") && strstr(said, "ends before its end"));
            for (int i = 0; i < log.count; i++) CHECK(mark_of(&log.datagram[i]) == i);
            if (log.count > most) most = log.count;
            dis_log_close(&log);
        }
        CHECK(packing == BZIP2 || packing == ZSTD || most > 20); /* those two hand out whole blocks */
    }
}

/* Their sums know: what is damaged never passes for whole. */
static void a_damaged_stream_is_said(void **state)
{
    (void)state;
    for (int packing = 0; packing < PACKINGS; packing++) {
        make_file(40);
        packed.count = 0;
        pack_more(packing, file.at, file.count);
        for (size_t at = 20; at < packed.count; at += 1 + packed.count / 25) {
            DisLog log = {0};
            packed.at[at] ^= 0x10;
            if (open_bytes(&log, &packed) == STATUS_OK) {
                CHECK(log.truncated && strstr(said, "ends early"));
                dis_log_close(&log);
            } else {
                CHECK(strstr(said, "not a capture") || strstr(said, "cannot use"));
            }
            packed.at[at] ^= 0x10;
        }
    }
}

/* Empty packets of a valid capture, a thousand for each octet of the file. */
static void bombs_are_refused(void **state)
{
    (void)state;
    static uint8_t zeros[1 << 20];
    for (int packing = 0; packing < PACKINGS; packing++) {
        DisLog log = {.count = 77};
        pcap_begin(&file, link_raw, false, false);
        packed.count = 0;
        pack_more(packing, file.at, file.count);
        for (int i = 0; i < 30; i++) pack_more(packing, zeros, sizeof zeros);
        CHECK(packed.count < 1 << 16);
        CHECK(open_bytes(&log, &packed) == STATUS_UNSUPPORTED && log.count == 77);
        CHECK(strstr(said, "256 times") && strstr(said, "expand it"));
    }
}

/* A window of 512 MiB: more than is granted. */
static void windows_are_bounded(void **state)
{
    (void)state;
    DisLog log;
    packed.count = 0;
    put(&packed, "\x28\xB5\x2F\xFD\x00\x98\x01\x00\x00", 9); /* window descriptor: 2^(10 + 19) */
    CHECK(open_bytes(&log, &packed) == STATUS_UNSUPPORTED && strstr(said, "window"));
}

/* ---- pcapng ------------------------------------------------------------------------------------------------ */

static void put_section(bool big)
{
    put_file32(&file, 0x0A0D0D0A, big);
    put_file32(&file, 28, big);
    put_file32(&file, 0x1A2B3C4D, big);
    put_file16(&file, 1, big);
    put_file16(&file, 0, big);
    put_file32(&file, 0xFFFFFFFF, big);
    put_file32(&file, 0xFFFFFFFF, big);
    put_file32(&file, 28, big);
}

/* resolution: if_tsresol; -1: not said. offset_s: if_tsoffset, 0: not said. */
static void put_interface(uint32_t link, int resolution, int64_t offset_s, bool big)
{
    const uint32_t length = 20 + (resolution >= 0 ? 8 : 0) + (offset_s ? 12 : 0) + 4;
    put_file32(&file, 1, big);
    put_file32(&file, length, big);
    put_file16(&file, link, big);
    put_file16(&file, 0, big);
    put_file32(&file, 0, big);
    if (resolution >= 0) {
        put_file16(&file, 9, big);
        put_file16(&file, 1, big);
        put_u8(&file, (unsigned)resolution);
        put_zeros(&file, 3);
    }
    if (offset_s) {
        put_file16(&file, 14, big);
        put_file16(&file, 8, big);
        put_file32(&file, (uint32_t)(big ? (uint64_t)offset_s >> 32 : (uint64_t)offset_s), big);
        put_file32(&file, (uint32_t)(big ? (uint64_t)offset_s : (uint64_t)offset_s >> 32), big);
    }
    put_file32(&file, 0, big);
    put_file32(&file, length, big);
}

static void put_enhanced(uint32_t interface, uint64_t ticks, bool big)
{
    const size_t   pad = -packet.count & 3;
    const uint32_t length = (uint32_t)(32 + packet.count + pad);
    put_file32(&file, 6, big);
    put_file32(&file, length, big);
    put_file32(&file, interface, big);
    put_file32(&file, (uint32_t)(ticks >> 32), big);
    put_file32(&file, (uint32_t)ticks, big);
    put_file32(&file, (uint32_t)packet.count, big);
    put_file32(&file, (uint32_t)packet.count, big);
    put(&file, packet.at, packet.count);
    put_zeros(&file, pad);
    put_file32(&file, length, big);
}

/* if_tsoffset moves the stamps, and times end at 0 and at 9e9 s (the year 2255); the fraction of the second stays. */
static void offsets_end_at_the_limits_of_time(void **state)
{
    (void)state;
    static const struct {
        int64_t offset_s;
        double  want_s; /* of a stamp of 1000.25 s */
    } c[] = {{-990, 10.25},
             {-1000, 0.25},
             {-1001, 0.25},
             {-2000, 0.25},
             {8999998500, 8999999500.25},
             {8999999000, 9000000000.25},
             {8999999500, 9000000000.25},
             {INT64_MAX, 9000000000.25},
             {INT64_MIN + 1, 0.25}};
    for (size_t k = 0; k < sizeof c / sizeof c[0]; k++) {
        file.count = 0;
        put_section(false);
        put_interface(link_raw, -1, c[k].offset_s, false);
        make_packet(link_raw, 5);
        put_enhanced(0, 1000250000, false);
        DisLog log;
        CHECK(open_bytes(&log, &file) == STATUS_OK && log.count == 1);
        CHECK_NEAR(log.datagram[0].capture_s, c[k].want_s, 2e-6);
        dis_log_close(&log);
    }
}

/* An option counts by its code and its length: if_tsresol (9) has 1 octet, if_tsoffset (14) has 8; if_speed (8) has 8
 * too. */
static void options_of_another_length_are_passed_over(void **state)
{
    (void)state;
    static const struct {
        unsigned code, length;
    } odd[] = {{8, 8}, {14, 4}, {14, 12}, {9, 2}, {9, 4}, {2, 1}};
    for (int order = 0; order < 2; order++) {
        const bool big = order;
        file.count = 0;
        put_section(big);
        uint32_t length = 24;
        for (size_t k = 0; k < sizeof odd / sizeof odd[0]; k++) length += 4 + (odd[k].length + 3) / 4 * 4;
        put_file32(&file, 1, big);
        put_file32(&file, length, big);
        put_file16(&file, link_raw, big);
        put_file16(&file, 0, big);
        put_file32(&file, 0, big);
        for (size_t k = 0; k < sizeof odd / sizeof odd[0]; k++) {
            put_file16(&file, odd[k].code, big);
            put_file16(&file, odd[k].length, big);
            for (unsigned i = 0; i < (odd[k].length + 3) / 4 * 4; i++) put_u8(&file, 3);
        }
        put_file32(&file, 0, big);
        put_file32(&file, length, big);
        make_packet(link_raw, 5);
        put_enhanced(0, 1000250000, big);
        DisLog log;
        CHECK(open_bytes(&log, &file) == STATUS_OK);
        CHECK(log.count == 1 && !log.truncated);
        CHECK_NEAR(log.datagram[0].capture_s, 1000.25, 1e-9);
        dis_log_close(&log);
    }
}

static void every_interface_has_its_own_link_and_clock(void **state)
{
    (void)state;
    static const struct {
        uint32_t link;
        int      resolution;
        int64_t  offset_s;
        uint64_t ticks; /* of 1000.25 s */
    } face[] = {{link_ethernet, -1, 0, 1000250000},
                {link_raw, 9, 0, 1000250000000},
                {link_sll2, 0x80 | 20, 0, ((uint64_t)1000 << 20) + (1 << 18)},
                {link_80211, 3, 0, 1000250},
                {link_raw, 3, 990, 10250},
                {link_raw, 0x80 | 40, -20, ((uint64_t)1020 << 40) + ((uint64_t)1 << 38)},
                {link_ethernet, 12, 0, 1000250000000000}};
    enum { faces = sizeof face / sizeof face[0] };
    for (int order = 0; order < 4; order++) { /* of the two sections */
        file.count = 0;
        for (int section = 0; section < 2; section++) {
            const bool big = order >> section & 1;
            put_section(big);
            /* the second section has them the other way round */
            for (int i = 0; i < faces; i++) {
                const int f = section ? faces - 1 - i : i;
                put_interface(face[f].link, face[f].resolution, face[f].offset_s, big);
            }
            for (int i = 0; i < faces; i++) {
                const int f = section ? faces - 1 - i : i;
                make_packet(face[f].link, (unsigned)(100 * section + f));
                put_enhanced((uint32_t)i, face[f].ticks, big);
            }
        }
        DisLog log;
        CHECK(open_bytes(&log, &file) == STATUS_OK);
        CHECK(log.count == 2 * (faces - 1) && !log.truncated);
        CHECK(log.counters.packets == 2 * faces && log.counters.other_link == 2 && log.counters.other_protocol == 0);
        CHECK(strstr(said, "2 packets") && strstr(said, "802_11"));
        for (int i = 0; i < log.count; i++) {
            CHECK_NEAR(log.datagram[i].capture_s, 1000.25, 1e-9);
            CHECK(mark_of(&log.datagram[i]) % 100 != 3);
        }
        CHECK(mark_of(&log.datagram[0]) == 0 && mark_of(&log.datagram[log.count - 1]) == 100);
        CHECK(log.datagram[log.count - 1].packet == 2 * faces);
        dis_log_close(&log);
    }
}

static void nothing_readable_is_refused_by_name(void **state)
{
    (void)state;
    DisLog log;
    for (int packets = 0; packets < 3; packets++) {
        file.count = 0;
        put_section(false);
        put_interface(link_80211, 9, 0, false);
        put_interface(link_80211, 9, 0, false);
        make_packet(link_raw, 1);
        for (int i = 0; i < packets; i++) put_enhanced((uint32_t)i, 5, false);
        CHECK(open_bytes(&log, &file) == STATUS_UNSUPPORTED && strstr(said, "802_11") && strstr(said, "Ethernet"));
    }
}

/* Blocks that contradict themselves end the reading where they stand. */
static void broken_blocks_end_the_file(void **state)
{
    (void)state;
    for (int fault = 0; fault < 5; fault++) {
        file.count = 0;
        put_section(false);
        put_interface(link_raw, 9, 0, false);
        make_packet(link_raw, 0);
        put_enhanced(0, 5, false);
        const size_t second = file.count;
        put_enhanced(fault == 0 ? 1 : 0, 6, false);                       /* 0: an interface that was not described */
        if (fault == 1) file.at[file.count - 4] ^= 4;                     /* its second length */
        if (fault == 2) file.at[second + 4] ^= 2;                         /* a length that is no multiple of four */
        if (fault == 3) file.at[second + 4] = 8, file.at[second + 5] = 0; /* shorter than a block can be */
        if (fault == 4) file.at[second + 21] = 0xFF;                      /* more captured than its block holds */
        put_enhanced(0, 7, false);
        DisLog log;
        CHECK(open_bytes(&log, &file) == STATUS_OK);
        CHECK(log.count == 1 && log.truncated && strstr(said, "ends early after packet 1"));
        dis_log_close(&log);
    }
    file.count = 0; /* finer than 64 bits can count */
    put_section(false);
    put_interface(link_raw, 0x80 | 64, 0, false);
    DisLog log;
    CHECK(open_bytes(&log, &file) == STATUS_OK && log.truncated && strstr(said, "finer"));
    dis_log_close(&log);
}

/* ---- the judge ---------------------------------------------------------------------------------------------- */

/* Captures of one link layer, spoilt at random: what libpcap hands out, the log has, and at the same time. */
static void libpcap_reads_the_same(void **state)
{
    (void)state;
    int same = 0;
    for (uint32_t round = 0; round < 400; round++) {
        const bool ng = round & 1, nanoseconds = round & 2, big = round & 4;
        if (ng) {
            pcapng_begin(&file, link_raw);
        } else {
            pcap_begin(&file, link_raw, nanoseconds, big);
        }
        const size_t head = file.count;
        for (unsigned i = 0; i < 6; i++) {
            make_packet(link_raw, i);
            if (ng) pcapng_packet(&file, 1700000000123456789u + i, &packet);
            else pcap_packet(&file, 1700000000 + i, 123456, &packet, packet.count, big);
        }
        if (round >= 8) { /* one octet of a packet's record, not of the file's head */
            const size_t at = head + (size_t)(random_uniform(9, 2, round, 0) * (double)(file.count - head));
            file.at[at] = (uint8_t)(random_uniform(9, 2, round, 1) * 256);
        }
        char path[64], reason[PCAP_ERRBUF_SIZE];
        CHECK(write_file(path, &file));
        pcap_t *judge = pcap_open_offline_with_tstamp_precision(path, PCAP_TSTAMP_PRECISION_NANO, reason);
        CHECK(judge);
        DisLog log;
        log_set_level((LogLevel)(LOG_ERROR + 1));
        CHECK(dis_log_open(&log, path, 3000) == STATUS_OK);
        log_set_level(LOG_INFO);
        struct pcap_pkthdr *header;
        const u_char       *bytes;
        uint64_t            packets = 0;
        int                 result, k = 0;
        while ((result = pcap_next_ex(judge, &header, &bytes)) == 1) {
            packets++;
            while (k < log.count && log.datagram[k].packet < packets) k++;
            if (k == log.count || log.datagram[k].packet != packets) continue;
            CHECK_NEAR(log.datagram[k].packet_s, (double)header->ts.tv_sec + 1e-9 * (double)header->ts.tv_usec, 1e-6);
            CHECK(memcmp(log.datagram[k].bytes, bytes + 28, log.datagram[k].octets) == 0);
        }
        CHECK(log.counters.packets == packets && log.truncated == (result == PCAP_ERROR));
        same++;
        pcap_close(judge);
        dis_log_close(&log);
        unlink(path);
    }
    CHECK(same == 400);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_packing_gives_the_datagrams),
        cmocka_unit_test(a_cut_stream_gives_what_it_has),
        cmocka_unit_test(a_damaged_stream_is_said),
        cmocka_unit_test(bombs_are_refused),
        cmocka_unit_test(windows_are_bounded),
        cmocka_unit_test(offsets_end_at_the_limits_of_time),
        cmocka_unit_test(options_of_another_length_are_passed_over),
        cmocka_unit_test(every_interface_has_its_own_link_and_clock),
        cmocka_unit_test(nothing_readable_is_refused_by_name),
        cmocka_unit_test(broken_blocks_end_the_file),
        cmocka_unit_test(libpcap_reads_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
