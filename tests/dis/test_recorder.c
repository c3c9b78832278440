/* tests/dis/test_recorder.c: what was recorded reads back by libpcap, octet for octet and to the same double of
 * seconds; checksums hold; a disk that is full is said once. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"

#include "dis/capture/log.h"
#include "dis/pdu/octets.h"
#include "dis/capture/recorder.h"

#include <pcap/pcap.h>
#include <signal.h>
#include <sys/resource.h>

enum { datagrams = 400, name_size = 80 };

static const uint8_t v4[16] = {[10] = 0xFF, [11] = 0xFF, [12] = 10, [13] = 1, [14] = 2, [15] = 3};
static const uint8_t v6[16] = {0x20, 1, 0x0D, 0xB8, [15] = 9};
static const uint8_t group4[16] = {[10] = 0xFF, [11] = 0xFF, [12] = 239, [13] = 1, [14] = 2, [15] = 3};

static uint8_t payload[dis_recorder_ipv6_octets + 1];
static int     lines;

static void count_lines(void *user, LogLevel level, const char *line)
{
    lines++;
    check_listen(user, level, line);
}

static void listen_begin(void)
{
    lines = 0;
    check_said[0] = 0;
    log_set_sink(count_lines, NULL);
}

static void make_name(char path[name_size], const char *ending)
{
    static int number;
    snprintf(path, name_size, "/tmp/pitviper-recorder-%d-%d%s", (int)getpid(), number++, ending);
}

/* ---- there and back ----------------------------------------------------------------------------------- */

typedef struct Sent {
    int64_t capture_ns;
    size_t  octets;
} Sent;

/* Datagram i of a stream: any size, any octets, at times that grow by anything from nothing to a second. */
static Sent nth(int i)
{
    static const size_t edges[] = {0, 1, 2, 3, 4, 1400, dis_recorder_ipv4_octets};
    static int64_t      now_ns;
    Dice                d = dice((uint32_t)i + 100);
    if (i == 0) now_ns = 1782000000123456789;
    now_ns += roll(&d) % 3 == 0 ? 0 : roll(&d) % 3 ? roll(&d) % 300 : roll(&d) % 1000000000;
    const size_t octets = i < 7 ? edges[i] : roll(&d) % 3000;
    roll_octets(&d, payload, octets < 16 ? octets : 16);
    for (size_t k = 16; k < octets; k++) payload[k] = (uint8_t)(k * 31 + (size_t)i);
    return (Sent){now_ns, octets};
}

static void there_and_back(const char *ending)
{
    char         path[name_size];
    DisRecorder *recorder;
    DisLog       log;
    make_name(path, ending);
    CHECK(dis_recorder_open(&recorder, path, "a test") == STATUS_OK);
    for (int i = 0; i < datagrams; i++) {
        const Sent sent = nth(i);
        CHECK(dis_recorder_add(recorder, sent.capture_ns,
                               i % 3 == 0   ? NULL
                               : i % 3 == 1 ? v4
                                            : v6,
                               50000, payload, sent.octets) == STATUS_OK);
    }
    CHECK(dis_recorder_close(recorder) == STATUS_OK);
    CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK);
    CHECK(log.count == datagrams && !log.truncated && !log.retimed);
    for (int i = 0; i < datagrams; i++) {
        const Sent         sent = nth(i);
        const DisDatagram *d = &log.datagram[i];
        CHECK(d->octets == sent.octets && memcmp(d->bytes, payload, sent.octets) == 0);
        CHECK(d->capture_s == dis_unix_s(sent.capture_ns)); /* the same double, or live and replay part */
        CHECK(d->packet == (uint32_t)i + 1);
    }
    dis_log_close(&log);
    remove(path);
}

static void pcapng_reads_back(void **state)
{
    (void)state;
    there_and_back(".pcapng");
}

static void pcap_reads_back(void **state)
{
    (void)state;
    there_and_back(".pcap");
}

/* ---- headers, as a stranger would check them ------------------------------------------------------------ */

static uint16_t folded(uint32_t sum)
{
    while (sum >> 16) sum = (sum & 0xFFFF) + (sum >> 16);
    return (uint16_t)sum;
}

static uint32_t add_octets(uint32_t sum, const uint8_t *bytes, size_t octets)
{
    for (size_t i = 0; i < octets; i++) sum += i % 2 ? bytes[i] : (uint32_t)bytes[i] << 8;
    return sum;
}

/* RFC 1071: whatever holds its own checksum adds up to all ones. */
static void check_packet(const uint8_t *p, size_t octets, bool is_v6, uint16_t to_port)
{
    const size_t ip = is_v6 ? 40 : 20;
    CHECK(octets >= ip + 8 && p[0] >> 4 == (is_v6 ? 6 : 4));
    if (!is_v6) {
        CHECK(folded(add_octets(0, p, 20)) == 0xFFFF);
        CHECK(dis_load_u16(p + 2) == octets && p[9] == 17);
        CHECK(memcmp(p + 12, v4 + 12, 4) == 0 && memcmp(p + 16, group4 + 12, 4) == 0);
    } else {
        CHECK(dis_load_u16(p + 4) == octets - 40 && p[6] == 17);
        CHECK(memcmp(p + 8, v6, 16) == 0 && p[24] == 0xFF && p[25] == 2 && p[39] == 1);
    }
    const uint8_t *udp = p + ip;
    const size_t   addresses = is_v6 ? 32 : 8;
    CHECK(dis_load_u16(udp) == 3456 && dis_load_u16(udp + 2) == to_port && dis_load_u16(udp + 4) == octets - ip);
    CHECK(dis_load_u16(udp + 6) != 0);
    const uint32_t sum = add_octets(17 + (uint32_t)(octets - ip), udp - addresses, addresses);
    CHECK(folded(add_octets(sum, udp, octets - ip)) == 0xFFFF);
}

static void headers_are_true(void **state)
{
    (void)state;
    static const size_t sizes[] = {
        0, 1, 2, 3, 145, dis_recorder_ipv4_octets - 1, dis_recorder_ipv4_octets, dis_recorder_ipv6_octets};
    char         path[name_size], reason[PCAP_ERRBUF_SIZE];
    DisRecorder *recorder;
    make_name(path, ".pcapng");
    CHECK(dis_recorder_open(&recorder, path, NULL) == STATUS_OK);
    dis_recorder_to(recorder, group4, 3001);
    int made = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int is_v6 = sizes[i] > dis_recorder_ipv4_octets; is_v6 < 2; is_v6++) {
            for (size_t k = 0; k < sizes[i]; k++) payload[k] = (uint8_t)(k * 91 + i);
            CHECK(dis_recorder_add(recorder, 1, is_v6 ? v6 : v4, 3456, payload, sizes[i]) == STATUS_OK);
            made++;
        }
    /* every sum there is, among them the one whose checksum would be 0: that means none */
    for (int word = 0; word < 65536; word++, made++) {
        dis_store_u16(payload, (uint16_t)word);
        CHECK(dis_recorder_add(recorder, 1, v4, 3456, payload, 2) == STATUS_OK);
    }
    CHECK(dis_recorder_close(recorder) == STATUS_OK);

    pcap_t             *capture = pcap_open_offline(path, reason);
    struct pcap_pkthdr *header;
    const u_char       *bytes;
    CHECK(capture != NULL);
    while (pcap_next_ex(capture, &header, &bytes) == 1) {
        CHECK(header->caplen == header->len);
        check_packet(bytes, header->caplen, bytes[0] >> 4 == 6, 3001);
        made--;
    }
    CHECK(made == 0);
    pcap_close(capture);
    remove(path);
}

static void what_no_packet_holds_is_refused(void **state)
{
    (void)state;
    char         path[name_size];
    DisRecorder *recorder;
    DisLog       log;
    make_name(path, ".pcap");
    CHECK(dis_recorder_open(&recorder, path, NULL) == STATUS_OK);
    CHECK(dis_recorder_add(recorder, 1, v4, 1, payload, dis_recorder_ipv4_octets + 1) == STATUS_BAD_VALUE);
    CHECK(dis_recorder_add(recorder, 1, v6, 1, payload, dis_recorder_ipv6_octets + 1) == STATUS_BAD_VALUE);
    CHECK(dis_recorder_add(recorder, -1, v4, 1, payload, 1) == STATUS_BAD_VALUE);
    CHECK(dis_recorder_add(recorder, INT64_MAX, v4, 1, payload, 1) == STATUS_BAD_VALUE);
    CHECK(dis_recorder_add(recorder, 4294967295999999999, v4, 1, payload, 1) == STATUS_OK); /* 2106, the last of pcap */
    CHECK(dis_recorder_close(recorder) == STATUS_OK);
    CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK && log.count == 1);
    dis_log_close(&log);
    remove(path);
}

static void a_comment_of_any_length_does_no_harm(void **state)
{
    (void)state;
    static char comment[100000];
    for (size_t length = 0; length < sizeof comment; length = 3 * length + 1) {
        char         path[name_size];
        DisRecorder *recorder;
        DisLog       log;
        memset(comment, 'c', length);
        comment[length] = 0;
        make_name(path, ".pcapng");
        CHECK(dis_recorder_open(&recorder, path, comment) == STATUS_OK);
        CHECK(dis_recorder_add(recorder, 5, v4, 1, payload, 9) == STATUS_OK);
        CHECK(dis_recorder_close(recorder) == STATUS_OK);
        CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK && log.count == 1 && log.datagram[0].octets == 9);
        dis_log_close(&log);
        remove(path);
    }
}

/* ---- the disk ------------------------------------------------------------------------------------------- */

static void flushed_is_whole(void **state)
{
    (void)state;
    char         path[name_size];
    DisRecorder *recorder;
    make_name(path, ".pcapng");
    CHECK(dis_recorder_open(&recorder, path, NULL) == STATUS_OK);
    for (int i = 0; i < 20; i++) {
        DisLog log;
        CHECK(dis_recorder_add(recorder, i, v4, 1, payload, 200) == STATUS_OK);
        CHECK(dis_recorder_flush(recorder) == STATUS_OK);
        CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK && log.count == i + 1 && !log.truncated);
        dis_log_close(&log);
    }
    CHECK(dis_recorder_close(recorder) == STATUS_OK);
    remove(path);
}

static void a_place_that_takes_nothing_is_known_at_once(void **state)
{
    (void)state;
    DisRecorder *recorder = NULL;
    listen_begin();
    CHECK(dis_recorder_open(&recorder, "/nowhere/at/all.pcapng", NULL) == STATUS_IO && recorder == NULL);
    CHECK(lines == 1 && strstr(check_said, "/nowhere/at/all.pcapng"));
    if (access("/dev/full", W_OK) == 0) {
        CHECK(dis_recorder_open(&recorder, "/dev/full", NULL) == STATUS_IO && recorder == NULL);
        CHECK(lines == 2 && strstr(check_said, "/dev/full"));
    }
    log_set_sink(NULL, NULL);
    CHECK(dis_recorder_close(NULL) == STATUS_OK);
}

static void a_disk_that_fills_is_said_once_and_what_came_before_stays(void **state)
{
    (void)state;
    char          path[name_size];
    DisRecorder  *recorder;
    DisLog        log;
    struct rlimit before, small;
    make_name(path, ".pcapng");
    signal(SIGXFSZ, SIG_IGN); /* a limit on the size of files fails as a full disk does */
    CHECK(getrlimit(RLIMIT_FSIZE, &before) == 0);
    small = before;
    small.rlim_cur = 100000;
    CHECK(setrlimit(RLIMIT_FSIZE, &small) == 0);
    CHECK(dis_recorder_open(&recorder, path, NULL) == STATUS_OK);
    listen_begin();
    Status last = STATUS_OK;
    for (int i = 0; i < 5000; i++) {
        const Status status = dis_recorder_add(recorder, i, v4, 1, payload, 1000);
        CHECK(last == STATUS_OK || status == STATUS_IO); /* never well again */
        last = status;
    }
    CHECK(last == STATUS_IO && dis_recorder_flush(recorder) == STATUS_IO && dis_recorder_close(recorder) == STATUS_IO);
    CHECK(lines == 1 && strstr(check_said, path));
    log_set_sink(NULL, NULL);
    CHECK(setrlimit(RLIMIT_FSIZE, &before) == 0);

    log_set_sink(check_listen, NULL); /* the warning about its end */
    CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK);
    log_set_sink(NULL, NULL);
    CHECK(log.truncated && log.count > 80 && log.count < 100); /* 1060 octets each */
    dis_log_close(&log);
    remove(path);
}

/* ---- seconds ---------------------------------------------------------------------------------------------- */

static void seconds_are_right_and_turn_back(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 200000; i++) {
        const double  most = i % 2 ? 9e18 : 2e18; /* to 2255, to 2033 */
        const int64_t ns = (int64_t)(most * random_uniform(7, 1, 0, i));
        const double  s = dis_unix_s(ns);
        /* half a step of a double, 2^-23 s below 2^31 s and 2^-20 s below 2^34 s, and the rounding of the fraction */
        CHECK_NEAR((double)((long double)s - ns / 1e9L), 0, ns < (1LL << 31) * 1000000000 ? 0x1.001p-23 : 0x1.001p-20);
        CHECK(dis_unix_s(ns + 1) >= s);
        const int64_t until = dis_unix_ns_until(s);
        CHECK(until >= ns && dis_unix_s(until) == s && dis_unix_s(until + 1) > s);
        /* a time between those that arrivals can have */
        const double  between = s + 1e-7 * random_uniform(7, 2, 0, i);
        const int64_t last = dis_unix_ns_until(between);
        CHECK(dis_unix_s(last) <= between && dis_unix_s(last + 1) > between);
    }
    CHECK(dis_unix_ns_until(0) == 0 && dis_unix_ns_until(-1) == -1 && dis_unix_ns_until(NAN) == -1);
    CHECK(dis_unix_ns_until(1.5) == 1500000000 && dis_unix_ns_until(1e-9) == 1);
    CHECK(dis_unix_ns_until(INFINITY) == 9000000000000000000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pcapng_reads_back),
        cmocka_unit_test(pcap_reads_back),
        cmocka_unit_test(headers_are_true),
        cmocka_unit_test(what_no_packet_holds_is_refused),
        cmocka_unit_test(a_comment_of_any_length_does_no_harm),
        cmocka_unit_test(flushed_is_whole),
        cmocka_unit_test(a_place_that_takes_nothing_is_known_at_once),
        cmocka_unit_test(a_disk_that_fills_is_said_once_and_what_came_before_stays),
        cmocka_unit_test(seconds_are_right_and_turn_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
