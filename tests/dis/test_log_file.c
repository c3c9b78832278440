/* tests/dis/test_log_file.c: a log larger than what is kept in memory: every datagram as it was written, in any order,
 * of one packet and of several, packed and not; what becomes of one that is cut meanwhile. */
#include "tests/check.h"

#include "dis/capture/log.h"
#include "dis/pdu/octets.h"

#include <unistd.h>
#include <zlib.h>

enum { count = 30000, most = 3000, link_raw = 101 };

static uint32_t length_of(int i) { return 600 + (uint32_t)(i * 7919 % 2400); }
static uint8_t  octet_of(int i, uint32_t k) { return (uint8_t)((uint32_t)i * 31 + k * 7 + (k >> 8)); }

/* A packet with part of datagram i, which lies from `from` on, and more behind it. */
static size_t put_packet(uint8_t *out, int i, uint32_t from, uint32_t octets, bool more)
{
    const uint32_t length = length_of(i), udp = 8 + length, part = from == 0 ? 8 + octets : octets;
    uint8_t       *ip = out + 16, *at = ip + 20;
    const uint32_t head[4] = {1700000000 + (uint32_t)i / 1000, (uint32_t)i % 1000, 20 + part, 20 + part};
    memcpy(out, head, sizeof head);
    memset(ip, 0, 20);
    ip[0] = 0x45, ip[8] = 64, ip[9] = 17;
    dis_store_u16(ip + 2, (uint16_t)(20 + part));
    dis_store_u16(ip + 4, (uint16_t)i);
    dis_store_u16(ip + 6, (uint16_t)((more ? 0x2000 : 0) | (from ? (from + 8) / 8 : 0)));
    if (from == 0) {
        dis_store_u16(at, 3000), dis_store_u16(at + 2, 3000), dis_store_u16(at + 4, (uint16_t)udp),
            dis_store_u16(at + 6, 0);
        at += 8;
    }
    for (uint32_t k = 0; k < octets; k++) at[k] = octet_of(i, from + k);
    return 16 + 20 + part;
}

/* Every ninth datagram is of two packets. */
static void write_log(const char *path, bool packed)
{
    static const uint32_t head[6] = {0xA1B2C3D4, 0x00040002, 0, 0, 262144, link_raw};
    static uint8_t        octet[2 * (most + 64)];
    gzFile                file = gzopen(path, packed ? "wb1" : "wbT");
    CHECK(file && gzwrite(file, head, sizeof head) == sizeof head);
    for (int i = 0; i < count; i++) {
        const uint32_t length = length_of(i), first = i % 9 == 0 ? 400 : length;
        size_t         n = put_packet(octet, i, 0, first, first < length);
        if (first < length) n += put_packet(octet + n, i, first, length - first, false);
        CHECK(gzwrite(file, octet, (unsigned)n) == (int)n);
    }
    CHECK(gzclose(file) == Z_OK);
}

static bool is_as_written(const DisLog *log, int i)
{
    const DisDatagram d = dis_log_datagram(log, i);
    bool              same = d.octets == length_of(i);
    for (uint32_t k = 0; same && k < d.octets; k += k % 97 == 0 ? 1 : 13) same = d.bytes[k] == octet_of(i, k);
    return same && d.packet == (uint32_t)(i + (i + 8) / 9 + 1 + (i % 9 == 0));
}

static void a_large_log_is_read_from_disk(void **state)
{
    (void)state;
    for (int packed = 0; packed < 2; packed++) {
        char   path[temp_path_size];
        DisLog log;
        int    wrong = 0, on_disk = 0;
        assert_true(temp_file(path, ""));
        write_log(path, packed);
        assert_int_equal(dis_log_open(&log, path, packed ? dis_port_default : 3000), STATUS_OK);
        assert_int_equal(log.count, count);
        for (int i = 0; i < count; i++) on_disk += (log.datagram[i].packet & dis_datagram_on_disk) != 0;
        CHECK(on_disk > count / 4 && on_disk < count);
        for (int i = 0; i < count; i++) wrong += !is_as_written(&log, i);
        for (int i = count; i-- > 0;) wrong += !is_as_written(&log, i);
        for (int i = 0; i < 3000; i++) wrong += !is_as_written(&log, (int)((int64_t)i * 7477 % count));
        assert_int_equal(wrong, 0);
        CHECK(!dis_log_failed(&log));
        dis_log_close(&log);
        unlink(path);
    }
}

static void a_log_that_is_cut_meanwhile_is_said(void **state)
{
    (void)state;
    char   path[temp_path_size];
    DisLog log;
    assert_true(temp_file(path, ""));
    write_log(path, false);
    assert_int_equal(dis_log_open(&log, path, 3000), STATUS_OK);
    assert_int_equal(truncate(path, 40 << 20), 0);
    log_set_sink(check_listen, NULL);
    const DisDatagram last = dis_log_datagram(&log, count * 4 / 5), first = dis_log_datagram(&log, 0);
    log_set_sink(NULL, NULL);
    CHECK(last.octets == 0 && first.octets == length_of(0) && dis_log_failed(&log));
    CHECK(strstr(check_said, path) && strstr(check_said, "it was cut meanwhile"));
    dis_log_close(&log);
    unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_large_log_is_read_from_disk),
                                       cmocka_unit_test(a_log_that_is_cut_meanwhile_is_said)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
