/* tests/fuzz/fuzz_pdu.c: any octets as a datagram: walked, decoded, encoded again, timed. Without a
 * fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"
#include "tests/dis/random_pdu.h"

#include "dis/pdu/decode.h"
#include "dis/clock/exercise_clock.h"

#include <stdlib.h>

const int fuzz_rounds = 40000;

/* One to three PDUs of the types this node decodes. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    Dice      d = dice(index);
    size_t    octets = 0;
    const int pdus = 1 + (int)(roll(&d) % 3);
    for (int i = 0; i < pdus; i++) octets += random_pdu(out + octets, &d, (int)(roll(&d) % random_pdu_kinds));
    return octets;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static DisPdu  decoded;
    static uint8_t back[1 << 16];
    ExerciseClock *clock = NULL;
    if (exercise_clock_create(&clock) != STATUS_OK) return 0;

    const uint8_t *at = data, *pdu;
    DisHeader      header;
    DisCounters    counters = {0};
    while (dis_next_pdu(&header, &pdu, &at, data + size, &counters)) {
        double capture_s = 0; /* the octets behind the header, as a double: every kind of it */
        if (header.length >= 20) memcpy(&capture_s, pdu + 12, sizeof capture_s);
        if (!isfinite(exercise_clock_time(clock, header.exercise, header.family, header.timestamp, capture_s))) abort();
        if (dis_decode(&decoded, pdu, header.length) != STATUS_OK) continue;
        const size_t length = dis_encode(back, sizeof back, &decoded);
        if (length < dis_header_octets || length > header.length) abort();
        if (memcmp(back, pdu, 8) != 0 || memcmp(back + 10, pdu + 10, length - 10) != 0) abort();
    }
    exercise_clock_destroy(clock);
    return 0;
}
