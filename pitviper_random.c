/* pitviper_random.c: random numbers as a function of counters, so that order and threads do not matter. */
#include "pitviper.h"

/* Philox 4x32-10. Source: Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011; the
 * authors' published vectors are in tests/base/test_random.c. */
void random_u32x4(uint32_t out[4], const uint32_t counter[4], const uint32_t key[2])
{
    static const uint32_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
    static const uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
    uint32_t              c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
    uint32_t              k0 = key[0], k1 = key[1];

    for (int round = 0; round < 10; round++) {
        const uint64_t a = (uint64_t)multiplier_0 * c0, b = (uint64_t)multiplier_1 * c2;
        c0 = (uint32_t)(b >> 32) ^ c1 ^ k0;
        c1 = (uint32_t)b;
        c2 = (uint32_t)(a >> 32) ^ c3 ^ k1;
        c3 = (uint32_t)a;
        k0 += weyl_0;
        k1 += weyl_1;
    }
    out[0] = c0;
    out[1] = c1;
    out[2] = c2;
    out[3] = c3;
}

static void draw(uint32_t out[4], uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index)
{
    const uint32_t counter[4] = {(uint32_t)index, (uint32_t)(index >> 32), frame, stream};
    const uint32_t key[2]     = {(uint32_t)seed, (uint32_t)(seed >> 32)};
    random_u32x4(out, counter, key);
}

/* 53 bits of two words, in [0, 1). */
static double unit_from(uint32_t high, uint32_t low)
{
    return (double)(((uint64_t)high << 32 | low) >> 11) * 0x1p-53;
}

double random_uniform(uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index)
{
    uint32_t bits[4];
    draw(bits, seed, stream, frame, index);
    return unit_from(bits[0], bits[1]);
}

double random_normal(uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index)
{
    /* Box-Muller: exact, and one draw a number */
    uint32_t bits[4];
    draw(bits, seed, stream, frame, index);
    const double u = 1 - unit_from(bits[0], bits[1]); /* (0, 1], so the logarithm is finite */
    return sqrt(-2 * log(u)) * cos(2 * pi_rad * unit_from(bits[2], bits[3]));
}
