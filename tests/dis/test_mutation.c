/* tests/dis/test_mutation.c: hostile datagrams. Good ones are spoilt in 200 000 ways, walked and decoded, each in
 * memory of exactly its size so that a sanitizer sees one octet too many. What decodes must encode again. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"
#include "dis/pdu/decode.h"

static DisPdu  decoded;
static uint8_t datagram[4 * random_pdu_octets], back[4 * random_pdu_octets], again[4 * random_pdu_octets];

static size_t random_datagram(Dice *d)
{
    size_t    octets = 0;
    const int pdus = 1 + (int)(roll(d) % 3);
    for (int i = 0; i < pdus; i++) octets += random_pdu(datagram + octets, d, (int)(roll(d) % random_pdu_kinds));
    return octets;
}

/* Flips, overwrites, cuts, length fields and counts with values that sit on edges. */
static size_t spoil(Dice *d, size_t octets)
{
    static const uint8_t edge[] = {0, 1, 11, 12, 127, 128, 143, 144, 145, 254, 255};
    const int            changes = 1 + (int)(roll(d) % 4);
    for (int i = 0; i < changes && octets; i++) {
        const size_t at = roll(d) % octets;
        switch (roll(d) % 6) {
        case 0:
            datagram[at] ^= (uint8_t)(1 << roll(d) % 8);
            break;
        case 1:
            datagram[at] = edge[roll(d) % sizeof edge];
            break;
        case 2:
            octets = at;
            break;
        case 3:
            datagram[8 % octets] = (uint8_t)(roll(d) % 20);
            break;
        case 4:
            datagram[9 % octets] = (uint8_t)roll(d);
            break;
        default:
            datagram[(roll(d) % 2 ? 19 : 101) % octets] = (uint8_t)roll(d);
            break;
        }
    }
    return octets;
}

static void spoilt_datagrams_do_no_harm(void **state)
{
    (void)state;
    Dice     d = dice(3);
    uint64_t found = 0, bad_count = 0, stopped = 0;
    for (int round = 0; round < 200000; round++) {
        const size_t octets = spoil(&d, random_datagram(&d));
        uint8_t     *heap = malloc(octets ? octets : 1);
        CHECK(heap != NULL);
        memcpy(heap, datagram, octets);

        const uint8_t *at = heap, *pdu;
        DisHeader      header;
        DisCounters    counters = {0};
        while (dis_next_pdu(&header, &pdu, &at, heap + octets, &counters)) {
            CHECK(pdu >= heap && (size_t)(pdu - heap) + header.length <= octets);
            found++;
            const Status status = dis_decode(&decoded, pdu, header.length);
            if (status == STATUS_BAD_VALUE) bad_count++;
            if (status != STATUS_OK) {
                const bool judged = header.type != dis_pdu_data && header.type != dis_pdu_set_data;
                CHECK(status == STATUS_BAD_VALUE || status == STATUS_UNSUPPORTED ||
                      !judged); /* too short: not this far */
                const uint64_t before = counters.dropped[DIS_DROP_BAD_COUNT];
                dis_count_refused(&counters, header.type, status);
                CHECK(counters.dropped[DIS_DROP_BAD_COUNT] == before + (judged && status == STATUS_BAD_VALUE));
                counters.dropped[DIS_DROP_BAD_COUNT] = before;
                continue;
            }
            /* all that was announced comes back, whatever lies behind it */
            const size_t length = dis_encode(back, sizeof back, &decoded);
            CHECK(length >= dis_header_octets && length <= header.length);
            CHECK(memcmp(back, pdu, 8) == 0 && memcmp(back + 10, pdu + 10, length - 10) == 0);
            CHECK(dis_decode(&decoded, back, length) == STATUS_OK);
            CHECK(dis_encode(again, sizeof again, &decoded) == length);
            CHECK(memcmp(back, again, length) == 0);
        }
        uint64_t drops = 0;
        for (int why = 0; why < DIS_DROP_COUNT; why++) drops += counters.dropped[why];
        CHECK(drops <= 1); /* one misfit ends the walk */
        stopped += drops;
        free(heap);
    }
    /* the mutations reach all of it */
    CHECK(found > 100000 && bad_count > 5000 && stopped > 100000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(spoilt_datagrams_do_no_harm)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
