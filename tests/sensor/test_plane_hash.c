/* Plane hashes: published SHA-256 vectors, and the format that the header promises, built by hand. */
#include "tests/check.h"

#include "sensor/frame/plane.h"

#include <unistd.h>

/* FIPS 180-4's examples, as NIST publishes them. */
static void sha256_gives_the_published_vectors(void **state)
{
    (void)state;
    char text[sha256_text_size];
    assert_int_equal(sha256_bytes(text, "abc", 3), STATUS_OK);
    assert_string_equal(text, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    assert_int_equal(sha256_bytes(text, NULL, 0), STATUS_OK);
    assert_string_equal(text, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    const char *two_blocks = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    assert_int_equal(sha256_bytes(text, two_blocks, strlen(two_blocks)), STATUS_OK);
    assert_string_equal(text, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    static char a[1000000];
    memset(a, 'a', sizeof a);
    assert_int_equal(sha256_bytes(text, a, sizeof a), STATUS_OK);
    assert_string_equal(text, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");

    char      path[] = "/tmp/XXXXXX";
    const int file = mkstemp(path);
    CHECK(file >= 0 && write(file, a, sizeof a) == sizeof a);
    close(file);
    assert_int_equal(sha256_file(text, path), STATUS_OK);
    assert_string_equal(text, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    unlink(path);
    log_set_level(LOG_ERROR + 1);
    strcpy(text, "untouched");
    assert_int_equal(sha256_file(text, path), STATUS_IO);
    assert_int_equal(sha256_file(text, "/tmp"), STATUS_IO); /* a folder opens, and cannot be read */
    log_set_level(LOG_INFO);
    assert_string_equal(text, "untouched");
}

/* The bytes the header describes, laid out one by one, through sha256_bytes. */
static void the_format_is_what_the_header_says(void **state)
{
    (void)state;
    const float    y[2] = {1.0f, -0.0f};
    const uint32_t id[3] = {4294967295u, 0, 258};
    const double   profile[1] = {-2.0};
    const Plane    plane[] = {plane_f32("b/Y", 2, 1, y), plane_u32("a/id", 1, 3, id), plane_f64("c", 1, 1, profile)};
    static const uint8_t bytes[] = {
        'a',  '/',  'i',  'd',  0,   1,   0,   0,   0,   3, 0,    0,    0,   'u', '3', '2',  0, /* name, 1 x 3, type */
        0xff, 0xff, 0xff, 0xff, 0,   0,   0,   0,   2,   1, 0,    0,    'b', '/', 'Y', 0,    2,   0,   0, 0,
        1,    0,    0,    0,    'f', '3', '2', 0,   0,   0, 0x80, 0x3f, 0,   0,   0,   0x80, 'c', 0,   1, 0,
        0,    0,    1,    0,    0,   0,   'f', '6', '4', 0, 0,    0,    0,   0,   0,   0,    0,   0xc0};
    char got[sha256_text_size], want[sha256_text_size];
    assert_int_equal(plane_hash(got, plane, 3), STATUS_OK);
    assert_int_equal(sha256_bytes(want, bytes, sizeof bytes), STATUS_OK);
    assert_string_equal(got, want);

    assert_int_equal(plane_hash(got, plane, 0), STATUS_OK);
    assert_string_equal(got, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

static void order_of_planes_does_not_matter(void **state)
{
    (void)state;
    static float values[5][100];
    for (int p = 0; p < 5; p++)
        for (int i = 0; i < 100; i++) values[p][i] = (float)(p * 100 + i);
    const char *name[5] = {"lwir/Y", "lwir", "truth/nx", "Z", "a"};
    Plane       plane[5];
    for (int p = 0; p < 5; p++) plane[p] = plane_f32(name[p], 10, 10, values[p]);

    char first[sha256_text_size], text[sha256_text_size];
    assert_int_equal(plane_hash(first, plane, 5), STATUS_OK);
    for (int turn = 0; turn < 120; turn++) { /* all orders, by the factorial number system */
        Plane shuffled[5], rest[5];
        memcpy(rest, plane, sizeof rest);
        for (int p = 0, code = turn; p < 5; code /= 5 - p, p++) {
            const int take = code % (5 - p);
            shuffled[p] = rest[take];
            memmove(rest + take, rest + take + 1, (size_t)(4 - take) * sizeof *rest);
        }
        assert_int_equal(plane_hash(text, shuffled, 5), STATUS_OK);
        assert_string_equal(text, first);
    }
}

/* Every NaN counts as one; every other bit counts. */
static void nan_is_canonical_and_nothing_else(void **state)
{
    (void)state;
    enum { n = 5000 }; /* more than one chunk */
    static uint32_t bits[n];
    static uint64_t wide[n];
    const Plane     plane = plane_f32("t", 50, 100, (const float *)(const void *)bits);
    const Plane     plane64 = plane_f64("t", 50, 100, (const double *)(const void *)wide);
    char            want[sha256_text_size], text[sha256_text_size];
    const int       at[] = {0, 4095, 4096, n - 1};

    for (int k = 0; k < 4; k++) {
        const uint32_t nans[] = {0x7fc00000u, 0xffc00000u, 0x7f800001u, 0xffffffffu, 0x7fffffffu};
        const uint64_t nans64[] = {0x7ff8000000000000u, 0xfff8000000000000u, 0x7ff0000000000001u, UINT64_MAX};
        bits[at[k]] = nans[0];
        assert_int_equal(plane_hash(want, &plane, 1), STATUS_OK);
        for (int i = 1; i < 5; i++) {
            bits[at[k]] = nans[i];
            assert_int_equal(plane_hash(text, &plane, 1), STATUS_OK);
            assert_string_equal(text, want);
        }
        const uint32_t others[] = {0x7f800000u, 0xff800000u, 0x80000000u, 0, 1};
        for (int i = 0; i < 5; i++) {
            bits[at[k]] = others[i];
            assert_int_equal(plane_hash(text, &plane, 1), STATUS_OK);
            assert_string_not_equal(text, want);
        }
        wide[at[k]] = nans64[0];
        assert_int_equal(plane_hash(want, &plane64, 1), STATUS_OK);
        for (int i = 1; i < 4; i++) {
            wide[at[k]] = nans64[i];
            assert_int_equal(plane_hash(text, &plane64, 1), STATUS_OK);
            assert_string_equal(text, want);
        }
        wide[at[k]] = 0x7ff0000000000000u;
        assert_int_equal(plane_hash(text, &plane64, 1), STATUS_OK);
        assert_string_not_equal(text, want);
        bits[at[k]] = 0;
        wide[at[k]] = 0;
    }
    assert_int_equal(bits[4096], 0); /* and the planes themselves were left alone */
}

/* Shape, name and type are part of it: 2 x 3 zeros are not 3 x 2 zeros, nor one plane two. */
static void shape_name_and_type_count(void **state)
{
    (void)state;
    static const float zero[8];
    const Plane        one[] = {plane_f32("a", 2, 3, zero), plane_f32("a", 3, 2, zero),
                                plane_f32("b", 2, 3, zero), plane_u32("a", 2, 3, (const uint32_t *)zero),
                                plane_f32("a", 1, 6, zero), {"a", PLANE_U8, 2, 3, zero}};
    char               text[6][sha256_text_size];
    for (int i = 0; i < 6; i++) {
        assert_int_equal(plane_hash(text[i], &one[i], 1), STATUS_OK);
        for (int j = 0; j < i; j++) assert_string_not_equal(text[i], text[j]);
    }
}

static void misuse_is_refused(void **state)
{
    (void)state;
    static const float zero[4];
    const Plane        twice[] = {plane_f32("a", 2, 2, zero), plane_f32("b", 2, 2, zero), plane_f32("a", 2, 2, zero)};
    const Plane        nameless = plane_f32("", 2, 2, zero), flat = plane_f32("a", 2, 0, zero);
    char               text[sha256_text_size] = "untouched";
    assert_int_equal(plane_hash(text, twice, 3), STATUS_BAD_VALUE);
    assert_int_equal(plane_hash(text, &nameless, 1), STATUS_BAD_VALUE);
    assert_int_equal(plane_hash(text, &flat, 1), STATUS_BAD_VALUE);
    assert_int_equal(plane_hash(text, twice, plane_hash_max_planes + 1), STATUS_BAD_VALUE);
    assert_string_equal(text, "untouched");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sha256_gives_the_published_vectors), cmocka_unit_test(the_format_is_what_the_header_says),
        cmocka_unit_test(order_of_planes_does_not_matter),    cmocka_unit_test(nan_is_canonical_and_nothing_else),
        cmocka_unit_test(shape_name_and_type_count),          cmocka_unit_test(misuse_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
