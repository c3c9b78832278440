/* Philox against its authors' published vectors; the distributions by their moments. */
#include "tests/check.h"

/* Known answers of philox4x32-10 from the Random123 distribution (kat_vectors). */
static void philox_gives_the_published_vectors(void **state)
{
    (void)state;
    static const struct {
        uint32_t counter[4], key[2], want[4];
    } known[] = {
        {{0, 0, 0, 0}, {0, 0}, {0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}},
        {{~0u, ~0u, ~0u, ~0u}, {~0u, ~0u}, {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}},
        {{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344},
         {0xa4093822, 0x299f31d0},
         {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        uint32_t got[4];
        random_u32x4(got, known[i].counter, known[i].key);
        assert_memory_equal(got, known[i].want, sizeof got);
    }
}

static void moments_are_those_of_the_distributions(void **state)
{
    (void)state;
    enum { n = 200000 };
    double sum = 0, sum_2 = 0, normal = 0, normal_2 = 0, normal_4 = 0;
    for (int i = 0; i < n; i++) {
        const double u = random_uniform(7, 1, 3, (uint64_t)i), z = random_normal(7, 2, 3, (uint64_t)i);
        CHECK(u >= 0 && u < 1);
        sum += u;
        sum_2 += u * u;
        normal += z;
        normal_2 += z * z;
        normal_4 += z * z * z * z;
    }
    /* five standard deviations of each estimate */
    CHECK_NEAR(sum / n, 0.5, 5 * sqrt(1.0 / 12 / n));
    CHECK_NEAR(sum_2 / n, 1.0 / 3, 5 * sqrt(4.0 / 45 / n));
    CHECK_NEAR(normal / n, 0, 5 / sqrt(n));
    CHECK_NEAR(normal_2 / n, 1, 5 * sqrt(2.0 / n));
    CHECK_NEAR(normal_4 / n, 3, 5 * sqrt(96.0 / n));
}

static void every_counter_matters(void **state)
{
    (void)state;
    const double base = random_uniform(1, 2, 3, 4);
    CHECK(base == random_uniform(1, 2, 3, 4));
    CHECK(base != random_uniform(2, 2, 3, 4));
    CHECK(base != random_uniform(1ull << 32 | 1, 2, 3, 4));
    CHECK(base != random_uniform(1, 3, 3, 4));
    CHECK(base != random_uniform(1, 2, 4, 4));
    CHECK(base != random_uniform(1, 2, 3, 5));
    CHECK(base != random_uniform(1, 2, 3, 1ull << 32 | 4));
}

/* Many at once are the single ones to the bit, and those Box and Muller's formula with the mathematical library's
 * logarithm and cosine, to rounding. */
static void normals_are_box_mullers(void **state)
{
    (void)state;
    enum { n = 100003 };
    static double  many[n];
    const uint64_t first = (1ull << 32) - 50000; /* across a word */
    random_normals(many, n, 7, 2, 3, first);
    for (int i = 0; i < n; i++) {
        const uint64_t index = first + (uint64_t)i;
        const uint32_t counter[4] = {(uint32_t)index, (uint32_t)(index >> 32), 3, 2}, key[2] = {7, 0};
        uint32_t       word[4];
        random_u32x4(word, counter, key);
        const double u = 1 - (double)(((uint64_t)word[0] << 32 | word[1]) >> 11) * 0x1p-53;
        const double v = (double)(((uint64_t)word[2] << 32 | word[3]) >> 11) * 0x1p-53;
        CHECK(many[i] == random_normal(7, 2, 3, index));
        CHECK_NEAR(many[i], sqrt(-2 * log(u)) * cos(2 * pi_rad * v), 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(philox_gives_the_published_vectors),
        cmocka_unit_test(moments_are_those_of_the_distributions),
        cmocka_unit_test(every_counter_matters),
        cmocka_unit_test(normals_are_box_mullers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
