/* tests/fuzz/fuzz_answer_klv.c: any octets as an answer, from local sets of ST 0903 by themselves and in ST 0601. The
 * checksum at the end is made right, so that what is behind it is reached. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_answer.h"

const int fuzz_rounds = 100000;

/* Appends octets that are written as hexadecimal digits. */
static size_t put(uint8_t *out, size_t at, const char *digits)
{
    for (unsigned octet; sscanf(digits, "%2x", &octet) == 1; digits += 2) out[at++] = (uint8_t)octet;
    return at;
}

/* Nothing found; a box with a class of the ontology series, and a centroid; a place of the optical band; a box. */
static const char *const items[4] = {
    "0208000000003BA26B20070106080140090130",
    "0208000000003BA26B2003064D79204154520401060501020601020701060801400901300A074952204C5749520B0205"
    "000C0204000D220170F592F02373364AF8AA9162C00F2EB2DA16B74341000841A0BE365B5AB96A3645653A1609010201"
    "CC020201040302025405014B6B0403030101229080808001010203290501326614010575726E3A78020B75726E3A783A"
    "747275636B671C1B010101030575726E3A78040975726E3A783A6D6274060474616E6B",
    "0701060A02454F65141307110A2D0000005A0000000708130130140140",
    "0208000000003BA26B200A046C776972060101651615908080010201050301490501646606020474616E6B",
};

/* In ST 0601 the local set is tag 74. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const key[2] = {"060E2B34020B01010E01030306000000", "060E2B34020B01010E01030101000000"};
    uint8_t                  set[512];
    const size_t             octets = put(set, 0, items[index % 4]);
    const bool               inside = index / 4 % 2;
    size_t                   at = put(out, 0, key[inside]);
    const size_t             length = octets + 4 + (inside ? 4 : 0);
    out[at++] = 0x82, out[at++] = (uint8_t)(length >> 8), out[at++] = (uint8_t)length;
    if (inside) out[at++] = 74, out[at++] = 0x82, out[at++] = (uint8_t)(octets >> 8), out[at++] = (uint8_t)octets;
    memcpy(out + at, set, octets);
    return put(out, at + octets, "01020000");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t octets[fuzz_seed_octets];
    unsigned       sum = 0;
    fuzz_answer(data, size);
    if (size < 2 || size > sizeof octets) return 0;
    memcpy(octets, data, size);
    for (size_t i = 0; i + 2 < size; i++) sum += i % 2 ? octets[i] : (unsigned)octets[i] << 8;
    octets[size - 2] = (uint8_t)(sum >> 8), octets[size - 1] = (uint8_t)sum;
    fuzz_answer(octets, size);
    return 0;
}
