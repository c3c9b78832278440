/* tests/dis/test_data.c: Data PDUs: real ones octet for octet, random ones there and back, and every way to lie about
 * counts and bits. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"

#include "dis/pdu/decode.h"
#include "dis/capture/log.h"
#include "dis/pdu/octets.h"

enum { most_octets = 65535 };

static DisPdu         first, second;
static DisData *const data = &first.data, *const again = &second.data;
static uint8_t built[most_octets + 1], back[most_octets + 1];

/* Any header, datums of random size and content under true counts; returns the length. */
static size_t random_data(Dice *d, int fixed, int variable)
{
    size_t length = 40;
    roll_octets(d, built, length);
    dis_store_u32(built + 32, (uint32_t)fixed);
    dis_store_u32(built + 36, (uint32_t)variable);
    roll_octets(d, built + length, (size_t)fixed * 8);
    length += (size_t)fixed * 8;
    for (int i = 0; i < variable; i++) {
        const uint32_t bits = roll(d) % 4 ? roll(d) % 300 : roll(d) % 5 * 64; /* with odd bits and without padding */
        const size_t   octets = 8 + (bits + 63) / 64 * 8;
        roll_octets(d, built + length, octets);
        dis_store_u32(built + length + 4, bits);
        length += octets;
    }
    dis_store_u16(built + 8, (uint16_t)length);
    built[2] = dis_pdu_data;
    return length;
}

static void fields_are_where_the_standard_says(void **state)
{
    (void)state;
    static const uint8_t pdu[] = {
        7, 1, 20, 5,  0, 0, 0, 9,  0, 72, 0,    0,                         /* header: 72 octets */
        0, 1, 0,  2,  0, 3, 0, 4,  0, 5,  0,    6,                         /* from 1:2:3 to 4:5:6 */
        1, 2, 3,  4,  5, 6, 7, 8,  0, 0,  0,    1,    0,    0,    0,    1, /* request, padding, one of each */
        0, 0, 0,  11, 0, 0, 0, 12,                                         /* fixed */
        0, 0, 0,  13, 0, 0, 0, 76,                                         /* variable: 76 bits in 10 octets of 16 */
        1, 2, 3,  4,  5, 6, 7, 8,  9, 10, 0xF1, 0xF2, 0xF3, 0xF4, 0xF5, 0xF6};
    CHECK(sizeof pdu == 72 && dis_decode(&first, pdu, sizeof pdu) == STATUS_OK);
    CHECK(data->originating.entity == 3 && data->receiving.site == 4 && data->request == 0x01020304);
    CHECK(data->padding == 0x05060708 && data->fixed_count == 1 && data->variable_count == 1);
    CHECK(data->fixed[0].id == 11 && data->fixed[0].value == 12);
    CHECK(data->variable[0].id == 13 && data->variable[0].bits == 76);
    CHECK(data->variable[0].value == pdu + 56 && data->variable[0].padding == pdu + 66);
    CHECK(dis_encode_data(back, sizeof back, data) == sizeof pdu && memcmp(back, pdu, sizeof pdu) == 0);
    data->variable[0].padding = NULL;
    CHECK(dis_encode_data(back, sizeof back, data) == sizeof pdu && memcmp(back, pdu, 66) == 0);
    for (int k = 66; k < 72; k++) CHECK(back[k] == 0);
    CHECK(dis_encode_data(back, sizeof pdu - 1, data) == 0);
}

/* How many Data and Set Data there are, as tshark 4.0.17 counts them (README of the data). */
static void real_ones_come_back_octet_for_octet(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int         count;
    } captures[] = {{"dis/vrf-dis5-tow-vs-armor.pcap", 193},
                    {"dis/vrf-dis7-gaz69-blocks.pcap", 71},
                    {"dis/vrf-dis7-gaz69-straight.pcap", 16},
                    {"dis/singles.pcap", 2}};
    for (int i = 0; i < 4; i++) {
        DisLog      log;
        DisCounters counters = {0};
        char        path[512];
        int         count = 0;
        if (!reference_path(path, captures[i].name)) skip();
        CHECK(dis_log_open(&log, path, dis_port) == STATUS_OK);
        for (int k = 0; k < log.count; k++) {
            const uint8_t *at = log.datagram[k].bytes, *end = at + log.datagram[k].octets, *pdu;
            DisHeader      header;
            while (dis_next_pdu(&header, &pdu, &at, end, &counters)) {
                if (header.type != dis_pdu_data && header.type != dis_pdu_set_data) continue;
                CHECK(dis_decode(&first, pdu, header.length) == STATUS_OK);
                CHECK(data->variable_count >= 1 && data->variable[0].bits > 0);
                CHECK(dis_encode_data(back, sizeof back, data) == header.length);
                CHECK(memcmp(back, pdu, header.length) == 0);
                count++;
            }
        }
        CHECK(count == captures[i].count);
        dis_log_close(&log);
    }
}

static void any_data_come_back(void **state)
{
    (void)state;
    Dice d = dice(20);
    for (int round = 0; round < 20000; round++) {
        const int    fixed = (int)(roll(&d) % 4 ? roll(&d) % 4 : roll(&d) % 65);
        const int    variable = (int)(roll(&d) % 4 ? roll(&d) % 4 : roll(&d) % 65);
        const size_t length = random_data(&d, fixed, variable);
        CHECK(dis_decode(&first, built, length) == STATUS_OK);
        CHECK(data->fixed_count == fixed && data->variable_count == variable);
        CHECK(dis_encode_data(back, sizeof back, data) == length && memcmp(back, built, length) == 0);
        CHECK(dis_encode_data(back, length - 1, data) == 0);
    }
}

/* Memory of exactly the PDU's size, for a sanitizer to see one octet too many. */
static Status decode_exactly(size_t octets)
{
    uint8_t *heap = malloc(octets ? octets : 1);
    CHECK(heap != NULL);
    memcpy(heap, built, octets);
    *again = (DisData){.request = 77};
    const Status status = dis_decode(&second, heap, octets);
    if (status != STATUS_OK) CHECK(again->request == 77 && again->fixed_count == 0); /* untouched */
    if (status == STATUS_OK) CHECK(dis_encode_data(back, sizeof back, again) <= octets);
    free(heap);
    return status;
}

static void a_cut_one_is_refused(void **state)
{
    (void)state;
    Dice         d = dice(21);
    const size_t length = random_data(&d, 3, 4);
    for (size_t cut = 0; cut < length; cut++) {
        CHECK(decode_exactly(cut) == STATUS_TRUNCATED); /* the length field says more */
        dis_store_u16(built + 8, (uint16_t)cut);
        CHECK(decode_exactly(cut) == (cut < 40 ? STATUS_TRUNCATED : STATUS_BAD_VALUE));
        dis_store_u16(built + 8, (uint16_t)length);
    }
    CHECK(decode_exactly(length) == STATUS_OK);
}

static void counts_and_bits_that_lie_do_no_harm(void **state)
{
    (void)state;
    static const uint32_t lies[] = {5, 64, 65, 0x1000, 0x10000000, 0x20000000, 0x7FFFFFFF, 0xFFFFFFF8, 0xFFFFFFFF};
    Dice                  d = dice(22);
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        size_t length = random_data(&d, 1, 1);
        dis_store_u32(built + 32, lies[i]);
        CHECK(decode_exactly(length) != STATUS_OK || lies[i] <= 64);
        length = random_data(&d, 1, 0);
        dis_store_u32(built + 36, lies[i]);
        CHECK(decode_exactly(length) == STATUS_BAD_VALUE);
        length = random_data(&d, 0, 1);
        const uint32_t bits = dis_load_u32(built + 44);
        dis_store_u32(built + 44, lies[i]);
        if (lies[i] > (bits + 63) / 64 * 64) CHECK(decode_exactly(length) == STATUS_BAD_VALUE);
    }
    /* more than there is room for, honestly */
    CHECK(decode_exactly(random_data(&d, 65, 0)) == STATUS_UNSUPPORTED);
    CHECK(decode_exactly(random_data(&d, 0, 65)) == STATUS_UNSUPPORTED);
    CHECK(decode_exactly(random_data(&d, 64, 64)) == STATUS_OK);
    /* anything at all */
    for (int round = 0; round < 100000; round++) {
        const size_t length = random_data(&d, (int)(roll(&d) % 3), (int)(roll(&d) % 3));
        for (int k = 0; k < 3; k++) {
            const size_t at = 28 + roll(&d) % (length - 28);
            built[at] = (uint8_t)(roll(&d) % 3 ? roll(&d) % 66 : roll(&d));
        }
        const Status status = decode_exactly(length);
        CHECK(status == STATUS_OK || status == STATUS_BAD_VALUE || status == STATUS_UNSUPPORTED);
    }
}

static void what_no_length_can_say_is_not_encoded(void **state)
{
    (void)state;
    static const uint8_t large[70000];
    *data = (DisData){.header = {.version = 7, .type = dis_pdu_data}, .variable_count = 1};
    data->variable[0] = (DisVariableDatum){1, 8 * 65480, large, NULL};
    CHECK(dis_encode_data(back, sizeof back, data) == 40 + 8 + 65480);
    data->variable[0].bits = 8 * 65488; /* 65536 in all */
    CHECK(dis_encode_data(back, sizeof back, data) == 0);
    data->variable[0].bits = UINT32_MAX;
    CHECK(dis_encode_data(back, sizeof back, data) == 0);
    *data = (DisData){.fixed_count = 65};
    CHECK(dis_encode_data(back, sizeof back, data) == 0);
    *data = (DisData){.variable_count = -1};
    CHECK(dis_encode_data(back, sizeof back, data) == 0);
    *data = (DisData){.variable_count = 1}; /* a datum of no bits needs no octets */
    CHECK(dis_encode_data(back, sizeof back, data) == 48);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_are_where_the_standard_says),
        cmocka_unit_test(real_ones_come_back_octet_for_octet),
        cmocka_unit_test(any_data_come_back),
        cmocka_unit_test(a_cut_one_is_refused),
        cmocka_unit_test(counts_and_bits_that_lie_do_no_harm),
        cmocka_unit_test(what_no_length_can_say_is_not_encoded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
