/* Poses of a head tracker: octets written out by hand, both ways; what is refused, each by its reason; sequences that
 * go past the end of 32 bits and begin anew. labels: threads */
#include "tests/check.h"

#include "dis/head/head_link.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

/* version 1, placed and relative, sequence 0x01020304, buttons 5, 1 s; 90, -45.5, 0.25 deg, zoom 2; 47, -13.5, 1000 m
 */
static const uint8_t whole[] = {'P',  'V',  'H', 'D', 0,    1,    0,    3,    1,    2,    3,    4, 0,    0,    0, 5,
                                0,    0,    0,   0,   0,    0x0F, 0x42, 0x40, 0x42, 0xB4, 0,    0, 0xC2, 0x36, 0, 0,
                                0x3E, 0x80, 0,   0,   0x40, 0,    0,    0,    0x40, 0x47, 0x80, 0, 0,    0,    0, 0,
                                0xC0, 0x2B, 0,   0,   0,    0,    0,    0,    0x40, 0x8F, 0x40, 0, 0,    0,    0, 0};
enum { octets = sizeof whole };

static void octets_by_hand(void **state)
{
    (void)state;
    HeadPose p = {.flags = 99};
    uint8_t  back[head_octets_most];
    assert_int_equal(octets, head_octets_placed);
    assert_int_equal(head_pose_read(&p, whole, octets), HEAD_GOOD);
    CHECK(p.flags == (HEAD_PLACED | HEAD_RELATIVE) && p.sequence == 0x01020304 && p.buttons == 5 &&
          p.time_us == 1000000);
    CHECK(p.yaw_deg == 90 && p.pitch_deg == -45.5 && p.roll_deg == 0.25 && p.zoom == 2);
    CHECK(p.lat_deg == 47 && p.lon_deg == -13.5 && p.height_m == 1000);
    assert_int_equal(head_pose_write(back, &p), octets);
    assert_memory_equal(back, whole, octets);

    uint8_t alone[head_octets];
    memcpy(alone, whole, sizeof alone);
    alone[7] = 2;
    assert_int_equal(head_pose_read(&p, alone, sizeof alone), HEAD_GOOD);
    CHECK(p.flags == HEAD_RELATIVE && p.lat_deg == 0 && p.lon_deg == 0 && p.height_m == 0);
    assert_int_equal(head_pose_write(back, &p), sizeof alone);
    assert_memory_equal(back, alone, sizeof alone);
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    static const struct {
        int      at;
        uint8_t  octet[4];
        int      count;
        HeadDrop drop;
    } wrong[] = {
        {0, {'p'}, 1, HEAD_MAGIC},
        {5, {2}, 1, HEAD_VERSION},
        {4, {1}, 1, HEAD_VERSION},
        {7, {7}, 1, HEAD_FLAGS},
        {6, {0x80}, 1, HEAD_FLAGS},
        {7, {0}, 1, HEAD_SIZE},                  /* no place, and yet 64 octets */
        {24, {0x43, 0xB4, 0, 1}, 4, HEAD_RANGE}, /* 360.00003 */
        {24, {0x7F, 0xC0, 0, 0}, 4, HEAD_RANGE}, /* NaN */
        {28, {0x42, 0xB4, 0, 1}, 4, HEAD_RANGE}, /* 90.00001 */
        {28, {0xFF, 0x80, 0, 0}, 4, HEAD_RANGE}, /* -infinity */
        {32, {0xC3, 0xB4, 0, 1}, 4, HEAD_RANGE},
        {36, {0, 0, 0, 0}, 4, HEAD_RANGE},             /* zoom 0 */
        {36, {0x42, 0xC8, 0, 1}, 4, HEAD_RANGE},       /* 100.00001 */
        {40, {0x40, 0x56, 0x90, 0}, 4, HEAD_RANGE},    /* 90.25 */
        {48, {0x40, 0x76, 0x90, 0}, 4, HEAD_RANGE},    /* 361 */
        {56, {0x40, 0xF8, 0x6A, 0x01}, 4, HEAD_RANGE}, /* above 1e5 m */
        {56, {0x7F, 0xF0, 0, 0}, 4, HEAD_RANGE},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        uint8_t  spoilt[octets];
        HeadPose p = {.sequence = 77};
        memcpy(spoilt, whole, octets);
        memcpy(spoilt + wrong[i].at, wrong[i].octet, (size_t)wrong[i].count);
        assert_int_equal(head_pose_read(&p, spoilt, octets), wrong[i].drop);
        assert_int_equal(p.sequence, 77); /* untouched */
    }
    for (size_t count = 0; count < octets; count++) {
        HeadPose p;
        assert_int_equal(head_pose_read(&p, whole, count), HEAD_SIZE);
    }
}

static void sequences_go_on(void **state)
{
    (void)state;
    CHECK(head_newer(2, 1) && !head_newer(1, 1) && !head_newer(1, 2));
    CHECK(head_newer(0, UINT32_MAX) && !head_newer(UINT32_MAX, 0) && head_newer(5, UINT32_MAX - 5));
    CHECK(!head_newer(100, 100 + head_back) && head_newer(100, 101 + head_back)); /* it has begun anew */
}

static void the_newest_is_kept(void **state)
{
    (void)state;
    HeadLink          *link = NULL;
    HeadPose           p;
    HeadCounters       counted = {{0}};
    char               address[32];
    const int          to = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    log_set_level((LogLevel)(LOG_ERROR + 1));
    int port = 20000 + (int)((getpid() * 13L) % 12000);
    do snprintf(address, sizeof address, "127.0.0.1:%d", ++port);
    while (head_link_open(&link, address) != STATUS_OK && port < 65535);
    assert_non_null(link);
    HeadLink *second = NULL;
    assert_int_equal(head_link_open(&second, address), STATUS_IO); /* it is taken */
    log_set_level(LOG_INFO);
    at.sin_port = htons((uint16_t)port);
    CHECK(!head_link_newest(&p, link));
    static const uint8_t last[] = {5, 3, 9, 9, 7}; /* of the sequence */
    uint8_t              octet[octets];
    memcpy(octet, whole, octets);
    for (size_t i = 0; i < sizeof last; i++) {
        octet[11] = last[i];
        assert_int_equal(sendto(to, octet, octets, 0, (struct sockaddr *)&at, sizeof at), octets);
    }
    assert_int_equal(sendto(to, octet, 3, 0, (struct sockaddr *)&at, sizeof at), 3); /* in order: the last */
    octet[11] = 10;
    assert_int_equal(sendto(to, octet, octets, 0, (struct sockaddr *)&at, sizeof at), octets);
    while (!head_link_newest(&p, link) || p.sequence != 0x0102030A) usleep(1000);
    head_link_close(link, &counted);
    assert_int_equal(counted.datagrams[HEAD_GOOD], 3);
    assert_int_equal(counted.datagrams[HEAD_OLD], 3);
    assert_int_equal(counted.datagrams[HEAD_SIZE], 1);
    close(to);
    CHECK(head_address_good("[::1]:5010") && head_address_good("0.0.0.0:65535"));
    static const char *const bad[] = {"",          "5010",      "localhost:5010", "127.0.0.1:0", "127.0.0.1:65536",
                                      "127.0.0.1", "[::1:5010", "::1:5010",       ":5010"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(!head_address_good(bad[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(octets_by_hand), cmocka_unit_test(what_is_wrong_is_refused),
                                       cmocka_unit_test(sequences_go_on), cmocka_unit_test(the_newest_is_kept)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
