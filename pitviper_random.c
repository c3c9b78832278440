/* pitviper_random.c: random numbers as a function of counters, so that order and threads do not matter. */
#include "pitviper.h"

/* Philox 4x32-10. Source: Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011; the
 * authors' published vectors are in tests/base/test_random.c. */
static inline void philox(uint32_t c[4], uint32_t k0, uint32_t k1)
{
    static const uint32_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
    static const uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
    for (int round = 0; round < 10; round++) {
        const uint64_t a = (uint64_t)multiplier_0 * c[0], b = (uint64_t)multiplier_1 * c[2];
        c[0] = (uint32_t)(b >> 32) ^ c[1] ^ k0;
        c[1] = (uint32_t)b;
        c[2] = (uint32_t)(a >> 32) ^ c[3] ^ k1;
        c[3] = (uint32_t)a;
        k0 += weyl_0;
        k1 += weyl_1;
    }
}

void random_u32x4(uint32_t out[4], const uint32_t counter[4], const uint32_t key[2])
{
    memcpy(out, counter, 4 * sizeof *out);
    philox(out, key[0], key[1]);
}

static inline void draw(uint32_t out[4], uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index)
{
    out[0] = (uint32_t)index;
    out[1] = (uint32_t)(index >> 32);
    out[2] = frame;
    out[3] = stream;
    philox(out, (uint32_t)seed, (uint32_t)(seed >> 32));
}

/* A number in [0, 1) from 53 bits of two words, exact. It uses signed conversions, which AVX2 has. */
static inline double unit_from(uint32_t high, uint32_t low)
{
    return ((double)(int32_t)(high ^ 0x80000000u) + 0x1p31) * 0x1p-32 + (double)(int32_t)(low >> 11) * 0x1p-53;
}

double random_uniform(uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index)
{
    uint32_t bits[4];
    draw(bits, seed, stream, frame, index);
    return unit_from(bits[0], bits[1]);
}

/* ln x, x in (0, 1], within 2 units of the last place: x = m 2^e, m in [sqrt(1/2), sqrt 2), by artanh. Written for
 * loops that become vector instructions, which calls of libm do not. */
static inline double log_of(double x)
{
    static const uint64_t half_root = 0x3FE6A09E667F3BCD, bias = 1024; /* bits of sqrt(1/2) */
    static const double   ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;
    uint64_t              bits;
    double                m;
    memcpy(&bits, &x, sizeof bits);
    const uint64_t k = (bits - half_root + (bias << 52)) >> 52;
    const double   e = (double)((int32_t)(uint32_t)k - (int32_t)bias);
    bits -= (k - bias) << 52;
    memcpy(&m, &bits, sizeof m);
    const double s = (m - 1) / (m + 1), z = s * s;
    double       sum = 1.0 / 21;
    sum = sum * z + 1.0 / 19;
    sum = sum * z + 1.0 / 17;
    sum = sum * z + 1.0 / 15;
    sum = sum * z + 1.0 / 13;
    sum = sum * z + 1.0 / 11;
    sum = sum * z + 1.0 / 9;
    sum = sum * z + 1.0 / 7;
    sum = sum * z + 1.0 / 5;
    sum = sum * z + 1.0 / 3;
    return e * ln2_high + (e * ln2_low + (2 * s + 2 * s * (z * sum)));
}

/* cos(2 pi v), v in [0, 1), within 1e-16 of the exact: sin of an angle in +-pi/2, by its series. */
static inline double cos_of_turns(double v)
{
    const double y = 2 * pi_rad * (fabs(v - 0.5) - 0.25), z = y * y;
    double       sum = -1.0 / 25852016738884976640000.0; /* 23! */
    sum = sum * z + 1.0 / 51090942171709440000.0;
    sum = sum * z - 1.0 / 121645100408832000.0;
    sum = sum * z + 1.0 / 355687428096000.0;
    sum = sum * z - 1.0 / 1307674368000.0;
    sum = sum * z + 1.0 / 6227020800.0;
    sum = sum * z - 1.0 / 39916800.0;
    sum = sum * z + 1.0 / 362880.0;
    sum = sum * z - 1.0 / 5040.0;
    sum = sum * z + 1.0 / 120.0;
    sum = sum * z - 1.0 / 6.0;
    return y + y * (z * sum);
}

/* A normal number by Box-Muller, one draw each. */
static inline double normal_from(const uint32_t bits[4])
{
    const double u = 1 - unit_from(bits[0], bits[1]); /* (0, 1], so the logarithm is finite */
    return sqrt(-2 * log_of(u)) * cos_of_turns(unit_from(bits[2], bits[3]));
}

double random_normal(uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index)
{
    uint32_t bits[4];
    draw(bits, seed, stream, frame, index);
    return normal_from(bits);
}

/* The same operations on several numbers at once. */
void random_normals(double *out, size_t count, uint64_t seed, uint32_t stream, uint32_t frame, uint64_t first)
{
    enum { lanes = 16 };
    uint32_t bits[4][lanes];
    for (size_t from = 0; from < count; from += lanes) {
        const size_t here = count - from < lanes ? count - from : lanes;
        double       normal[lanes];
        for (int i = 0; i < lanes; i++) {
            uint32_t c[4];
            draw(c, seed, stream, frame, first + from + (uint64_t)i);
            for (int k = 0; k < 4; k++) bits[k][i] = c[k];
        }
        for (int i = 0; i < lanes; i++)
            normal[i] = normal_from((const uint32_t[4]){bits[0][i], bits[1][i], bits[2][i], bits[3][i]});
        memcpy(out + from, normal, here * sizeof *out);
    }
}
