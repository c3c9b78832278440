/* tests/fuzz/fuzz_seed.h: what a fuzz entry point offers: a test of one input, and good inputs to start from. */
#ifndef TESTS_FUZZ_FUZZ_SEED_H
#define TESTS_FUZZ_FUZZ_SEED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { fuzz_seed_octets = 1 << 16 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
/* A well-formed input into fuzz_seed_octets; the same one for the same index. */
size_t           fuzz_seed(uint8_t *out, uint32_t index);
extern const int fuzz_rounds; /* mutated seeds that run in about a second */

enum { fuzz_path_size = 32 };

/* The octets as a file in memory, for readers that want a path; until close(). -1: there is none. */
static inline int fuzz_file(char path[fuzz_path_size], const uint8_t *data, size_t size)
{
    const int file = memfd_create("fuzz", 0);
    if (file < 0) return -1;
    snprintf(path, fuzz_path_size, "/proc/self/fd/%d", file);
    if (write(file, data, size) == (ssize_t)size) return file;
    close(file);
    return -1;
}

/* Text of ours as a seed. */
static inline size_t fuzz_seed_text(uint8_t *out, const char *text)
{
    const size_t size = strlen(text);
    memcpy(out, text, size);
    return size;
}

#endif
