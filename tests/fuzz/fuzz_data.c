/* tests/fuzz/fuzz_data.c: any octets as Data PDUs: decoded, every datum read, encoded again. Without a fuzzer
 * run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"
#include "tests/dis/random_pdu.h"
#include "dis/pdu/decode.h"

#include <stdlib.h>

const int fuzz_rounds = 40000;

/* One to three of them, of a few datums each. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const DisHeader header = {.version = 7, .exercise = 1, .type = dis_pdu_data, .family = 5};
    static const uint8_t   value[64] = {1, 2, 3};
    static DisData         data;
    Dice                   d = dice(index);
    size_t                 octets = 0;
    const int              pdus = 1 + (int)(roll(&d) % 3);
    for (int i = 0; i < pdus; i++) {
        data.header = header;
        data.request = roll(&d);
        data.fixed_count = (int)(roll(&d) % 4);
        data.variable_count = (int)(roll(&d) % 4);
        for (int k = 0; k < data.fixed_count; k++) data.fixed[k] = (DisFixedDatum){roll(&d), roll(&d)};
        for (int k = 0; k < data.variable_count; k++)
            data.variable[k] =
                (DisVariableDatum){.id = roll(&d), .bits = roll(&d) % (8 * sizeof value), .value = value};
        octets += dis_encode_data(out + octets, 4096, &data);
    }
    return octets;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static DisPdu            decoded;
    static uint8_t           back[1 << 16];
    static volatile unsigned sum; /* so that every octet is read */
    const uint8_t           *at = data, *pdu;
    DisHeader                header;
    DisCounters              counters = {0};
    while (dis_next_pdu(&header, &pdu, &at, data + size, &counters)) {
        if (header.type != dis_pdu_data || dis_decode(&decoded, pdu, header.length) != STATUS_OK) continue;
        for (int i = 0; i < decoded.data.variable_count; i++)
            for (size_t k = 0; k < ((size_t)decoded.data.variable[i].bits + 7) / 8; k++)
                sum += decoded.data.variable[i].value[k];
        const size_t length = dis_encode(back, sizeof back, &decoded);
        if (length < dis_header_octets || length > header.length) abort();
        if (memcmp(back, pdu, 8) != 0 || memcmp(back + 10, pdu + 10, length - 10) != 0) abort();
    }
    return 0;
}
