/* tests/fuzz/fuzz_seed.h: what a fuzz entry point offers: a test of one input, and good inputs to start from. */
#ifndef TESTS_FUZZ_FUZZ_SEED_H
#define TESTS_FUZZ_FUZZ_SEED_H

#include <stddef.h>
#include <stdint.h>

enum { fuzz_seed_octets = 1 << 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
/* A well-formed input into fuzz_seed_octets; the same one for the same index. */
size_t           fuzz_seed(uint8_t *out, uint32_t index);
extern const int fuzz_rounds; /* mutated seeds that run in about a second */

#endif
