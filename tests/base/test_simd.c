/* Each lane of the SIMD words against the same word on one number, bit by bit: random numbers and the extremes. */
#include "pitviper_simd.h"
#include "tests/check.h"

static const double extremes[] = {0,     -0.0,   1,    -1,    0.5,      -0.5,      1.5, -2.5, 126.9,    -126.9,
                                  1e-40, -1e-40, 1e30, -1e30, INFINITY, -INFINITY, NAN, 3e38, 0x1p-149, 2147483000};
enum { extreme_count = sizeof extremes / sizeof *extremes, rounds = 2000 };

static double number(int round, int lane)
{
    const uint64_t at = (uint64_t)(round * 16 + lane);
    if (random_uniform(1, 0, 0, at) < 0.4) return extremes[(int)(random_uniform(1, 1, 0, at) * extreme_count)];
    return random_normal(1, 2, 0, at) * exp2(20 * random_normal(1, 3, 0, at));
}

static bool same_f(float a, float b) { return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b)); }
static bool same_d(double a, double b) { return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b)); }

#define FLOATS(word, plain)                                                                                            \
    do {                                                                                                               \
        f32x8_store(got, word);                                                                                        \
        for (int k = 0; k < 8; k++) {                                                                                  \
            const float x = a[k], y = b[k], z = c[k], want_ = (plain);                                                 \
            (void)x, (void)y, (void)z;                                                                                 \
            if (!same_f(got[k], want_))                                                                                \
                fail_msg("%s of %g %g %g: %g, want %g", #word, (double)x, (double)y, (double)z, (double)got[k],        \
                         (double)want_);                                                                               \
        }                                                                                                              \
    } while (0)
#define DOUBLES(word, plain)                                                                                           \
    do {                                                                                                               \
        f64x4_storeu(got, word);                                                                                       \
        for (int k = 0; k < 4; k++) {                                                                                  \
            const double x = a[k], y = b[k], want_ = (plain);                                                          \
            (void)x, (void)y;                                                                                          \
            if (!same_d(got[k], want_)) fail_msg("%s of %g %g: %g, want %g", #word, x, y, got[k], want_);              \
        }                                                                                                              \
    } while (0)
#define BITS(word, count, plain)                                                                                       \
    do {                                                                                                               \
        unsigned want_ = 0;                                                                                            \
        for (int k = 0; k < (count); k++) want_ |= (unsigned)(plain) << k;                                             \
        assert_int_equal(word, want_);                                                                                 \
    } while (0)

static void floats_lane_by_lane(void **state)
{
    (void)state;
    for (int n = 0; n < rounds; n++) {
        float  a[8], b[8], c[8], got[8];
        double wide[8];
        for (int k = 0; k < 8; k++)
            a[k] = (float)(wide[k] = number(n, k)), b[k] = (float)number(n, k + 8), c[k] = (float)number(n + rounds, k);
        const F32x8    p = f32x8_load(a), q = f32x8_load(b), r = f32x8_load(c), less = f32x8_less(p, q);
        const unsigned some = (unsigned)n & 0xff;
        FLOATS(f32x8_of_doubles(wide), x);
        FLOATS(p + q, x + y);
        FLOATS(p * q, x * y);
        FLOATS(f32x8_set(wide[3]), a[3]);
        FLOATS(f32x8_fma(p, q, r), fmaf(x, y, z));
        FLOATS(f32x8_lerp(p, q, r), fmaf(z, y - x, x));
        FLOATS(f32x8_min(p, q), x < y ? x : y);
        FLOATS(f32x8_max(p, q), x > y ? x : y);
        FLOATS(f32x8_clamp(p, -2, 3), x > -2 ? (x < 3 ? x : 3) : -2);
        FLOATS(f32x8_sqrt(p), sqrtf(x));
        FLOATS(f32x8_abs(p), fabsf(x));
        FLOATS(f32x8_floor(p), floorf(x));
        FLOATS(f32x8_select(less, p, r), x < y ? x : z);
        FLOATS(f32x8_select(f32x8_mask(some), p, q), some >> k & 1 ? x : y);
        BITS(f32x8_bits(f32x8_mask(some)), 8, some >> k & 1);
        BITS(f32x8_bits(less), 8, a[k] < b[k]);
        BITS(f32x8_bits(f32x8_greater(p, q)), 8, a[k] > b[k]);
        BITS(f32x8_bits(f32x8_and(less, f32x8_less(q, r))), 8, a[k] < b[k] && b[k] < c[k]);
        BITS(f32x8_bits(f32x8_or(less, f32x8_less(q, r))), 8, a[k] < b[k] || b[k] < c[k]);
        BITS(f32x8_bits(f32x8_and_not(less, f32x8_less(q, r))), 8, a[k] < b[k] && !(b[k] < c[k]));
    }
}

/* exp2's error is in its comment; below -126 as there, and whole powers exactly. */
static void powers_of_two(void **state)
{
    (void)state;
    for (double x = -130; x < 128; x += 0.125 + 0.01 * random_uniform(2, 0, 0, (uint64_t)(1e3 * (x + 130)))) {
        float got[8];
        f32x8_store(got, f32x8_exp2(f32x8_set(x)));
        const double want = exp2(fmax((double)(float)x, -126));
        CHECK_NEAR((double)got[0] / want, 1, 2e-7);
        f32x8_store(got, f32x8_exp2(f32x8_set(floor(x))));
        CHECK((double)got[5] == exp2(fmax(floor(x), -126)));
    }
}

static void integers_lane_by_lane(void **state)
{
    (void)state;
    static const uint8_t bytes[8] = {0, 1, 127, 128, 255, 7, 9, 200};
    int32_t              table[16], a[8], b[8], got[8];
    float                floats[16], place[8];
    for (int k = 0; k < 16; k++) table[k] = 1000 - 77 * k * k, floats[k] = (float)(3.5 * k);
    for (int n = 0; n < rounds; n++) {
        for (int k = 0; k < 8; k++) {
            a[k] = (int32_t)(uint32_t)(4294967295.0 * random_uniform(3, 0, (uint64_t)k, (uint64_t)n));
            b[k] = n % 3 ? (int32_t)(uint32_t)(4294967295.0 * random_uniform(3, 1, (uint64_t)k, (uint64_t)n)) : a[k];
        }
        const I32x8 p = i32x8_load(a), q = i32x8_load(b), low = i32x8_and(p, i32x8_set(15));
#define INTEGERS(word, plain)                                                                                          \
    do {                                                                                                               \
        i32x8_store(got, word);                                                                                        \
        for (int k = 0; k < 8; k++) assert_int_equal((uint32_t)got[k], (uint32_t)(plain));                             \
    } while (0)
        INTEGERS(i32x8_add(p, q), (uint32_t)a[k] + (uint32_t)b[k]);
        INTEGERS(i32x8_sub(p, q), (uint32_t)a[k] - (uint32_t)b[k]);
        INTEGERS(i32x8_mul(p, q), (uint32_t)a[k] * (uint32_t)b[k]);
        INTEGERS(i32x8_xor(p, q), a[k] ^ b[k]);
        INTEGERS(i32x8_shift_right(p, 13), (uint32_t)a[k] >> 13);
        INTEGERS(i32x8_select(i32x8_greater(p, q), p, q), a[k] > b[k] ? a[k] : b[k]);
        INTEGERS(i32x8_gather(table, low), table[a[k] & 15]);
        INTEGERS(i32x8_of_bytes(bytes), bytes[k]);
        INTEGERS(i32x8_truncate(f32x8_of_ints(low) * f32x8_set(-1.25)), -(a[k] & 15) * 5 / 4);
        BITS(f32x8_bits(i32x8_equal(p, q)), 8, a[k] == b[k]);
        f32x8_store(place, f32x8_gather(floats, low));
        for (int k = 0; k < 8; k++) CHECK(place[k] == floats[a[k] & 15]);
    }
    F32x8       rows[8];
    const I32x8 columns = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
    for (int k = 0; k < 8; k++) rows[k] = f32x8_set(10.0 * k) + f32x8_of_ints(columns);
    f32x8_transpose(rows);
    for (int j = 0; j < 8; j++) {
        f32x8_store(place, rows[j]);
        for (int k = 0; k < 8; k++) CHECK(place[k] == (float)(10 * k + j));
    }
}

static void doubles_lane_by_lane(void **state)
{
    (void)state;
    for (int n = 0; n < rounds; n++) {
        double a[4], b[4], got[4];
        for (int k = 0; k < 4; k++) a[k] = number(n, k), b[k] = n % 3 ? number(n, k + 8) : a[k];
        const F64x4 p = f64x4_loadu(a), q = f64x4_loadu(b), less = f64x4_less(p, q);
        DOUBLES(f64x4_min(p, q), x < y ? x : y);
        DOUBLES(f64x4_max(p, q), x > y ? x : y);
        DOUBLES(f64x4_sqrt(p), sqrt(x));
        DOUBLES(f64x4_abs(p), fabs(x));
        DOUBLES(f64x4_floor(p), floor(x));
        DOUBLES(f64x4_set(a[2]), a[2]);
        DOUBLES(f64x4_select(less, p, q), x < y ? x : y);
        DOUBLES(f64x4_of_ints(_mm_setr_epi32(-3, 0, 7, 1 << 30)), ((double[]){-3, 0, 7, 1 << 30})[k]);
        BITS(f64x4_bits(f64x4_at_most(p, q)), 4, a[k] <= b[k]);
        BITS(f64x4_bits(f64x4_equal(p, q)), 4, a[k] == b[k]);
        BITS(f64x4_bits(f64x4_or(less, f64x4_equal(p, q))), 4, a[k] <= b[k]);
        BITS(f64x4_bits(f64x4_and(less, f64x4_equal(p, q))), 4, false);
        BITS(f64x4_bits(f64x4_and_not(f64x4_at_most(p, q), less)), 4, a[k] == b[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_lane_by_lane),
        cmocka_unit_test(powers_of_two),
        cmocka_unit_test(integers_lane_by_lane),
        cmocka_unit_test(doubles_lane_by_lane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
