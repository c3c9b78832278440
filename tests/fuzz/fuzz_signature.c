/* tests/fuzz/fuzz_signature.c: any octets as a file of a library of signatures, and again with a checksum that fits.
 * What is accepted gives finite centres. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "render/scattering/signatures/centres.h"
#include "sensor/radar/signature_library.h"

#include <stdlib.h>

const int fuzz_rounds = 3000;

enum { parts = 3 };
static const char name[sha256_text_size] = "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff";

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    SignatureCentre centre[4] = {{.path = -12,
                                  .path_share = 0.25f,
                                  .p = {1, -2, 0.5f},
                                  .scale = 0.1f,
                                  .moment_scale = 0.01f,
                                  .weight = 0.2f,
                                  .strongest = 0.1f,
                                  .s = {32767, -5, 3, 0, 0, 1, -32767, 9},
                                  .part = 2,
                                  .bounce = 3}};
    for (int i = 1; i < 4; i++) centre[i] = centre[0], centre[i].path += i, centre[i].half[i - 1] = (float)i;
    const Signature s = {.count = (int)(index % 5), .centre = centre};
    return signature_to_octets(out, &s, name);
}

static void try_octets(const uint8_t *data, size_t size)
{
    const ScatterAntenna at = {{1, 0, 0}, 1000}, moved = {{0.8, 0.6, 0}, 900};
    const SignatureCells cells = signature_default_cells(94e9, 5e8, 5e-3, 3e-3);
    Signature            s = {.tx = at, .rx = at};
    Centres              centres = {0};
    if (signature_from_octets(&s, data, size, name, parts) != STATUS_OK) return;
    signature_axes(&s, &cells);
    if (centres_make(&centres, &s, &moved, &moved, NULL) != STATUS_OK) abort();
    for (int i = 0; i < centres.count; i++) {
        const ScatterCentre *c = &centres.centre[i];
        if (!isfinite(c->path_m + c->p[0] + c->p[1] + c->p[2] + creal(c->s.vv) + cimag(c->s.hh)) || c->part >= parts)
            abort();
    }
    centres_free(&centres);
    signature_free(&s);
}

/* A file undamaged is accepted, or nothing behind it is tried. */
static void try_seeds(void)
{
    static uint8_t seed[fuzz_seed_octets];
    for (uint32_t i = 0; i < 5; i++) {
        Signature    s = {0};
        const size_t size = fuzz_seed(seed, i);
        if (signature_from_octets(&s, seed, size, name, parts) != STATUS_OK || s.count != (int)i) abort();
        signature_free(&s);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t copy[fuzz_seed_octets];
    static bool    begun = false;
    char           sum[sha256_text_size];
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!begun) try_seeds();
    begun = true;
    try_octets(data, size);
    enum { hash = sha256_text_size - 1 };
    if (size < hash || size > sizeof copy) return 0;
    memcpy(copy, data, size);
    if (sha256_bytes(sum, copy, size - hash) == STATUS_OK) memcpy(copy + size - hash, sum, hash);
    try_octets(copy, size);
    return 0;
}
