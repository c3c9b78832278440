/* The note of a live node's world: what is written comes back to the bit; what was not written so is none. */
#include "tests/check.h"

#include "sensor/node/run/world_note.h"

static double drawn(uint64_t k, uint32_t of, double most) { return most * (2 * random_uniform(7, of, 0, k) - 1); }

static WorldNote some(uint64_t k)
{
    return (WorldNote){1.7e9 + drawn(k, 0, 1e8),
                       {drawn(k, 1, 0.5 * pi_rad), drawn(k, 2, pi_rad), drawn(k, 3, 5000)},
                       {{drawn(k, 4, 5e4), drawn(k, 5, 5e4)}, 25050 + drawn(k, 6, 24900), k % 2 == 0}};
}

static bool is_same(const WorldNote *a, const WorldNote *b)
{
    return a->until_s == b->until_s && a->origin.lat_rad == b->origin.lat_rad &&
           a->origin.lon_rad == b->origin.lon_rad && a->origin.h_m == b->origin.h_m &&
           memcmp(a->square.centre_m, b->square.centre_m, sizeof a->square.centre_m) == 0 &&
           a->square.half_width_m == b->square.half_width_m && a->square.own == b->square.own;
}

static void notes_come_back(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < 2000; k++) {
        const WorldNote note = some(k);
        WorldNote       got;
        char            text[world_note_size], notes[2 * world_note_size];
        world_note_text(text, &note);
        assert_true(strlen(text) + 1 < sizeof text);
        snprintf(notes, sizeof notes, "pitviper: no radar in frame 5 at 1.000000 s\n%s\nand more", text);
        CHECK(world_note_read(&got, notes) && is_same(&got, &note));
        CHECK(world_note_read(&got, text) && is_same(&got, &note));
    }
}

static void other_lines_are_none(void **state)
{
    (void)state;
    static const char *const other[] = {
        "",
        "\n\n",
        "pitviper: world until",
        "pitviper: world until 0x1p+30 at 0x0p+0 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0",
        "pitviper: world until nan at 0x0p+0 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0 0x1p+10",
        "pitviper: world until 0x1p+30 at 0x1p+1 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0 0x1p+10",    /* beyond a pole */
        "pitviper: world until 0x1p+30 at 0x0p+0 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0 0x1p+20",    /* too wide */
        "pitviper: world until 1073741824 at 0x0p+0 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0 0x1p+10", /* not as written */
        "pitviper: world until 0x1p+30 at 0x0p+0 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0 0x1p+10 mine"};
    WorldNote got;
    CHECK(!world_note_read(&got, NULL));
    for (size_t k = 0; k < sizeof other / sizeof *other; k++) CHECK(!world_note_read(&got, other[k]));
    CHECK(world_note_read(&got, "pitviper: world until 0x1p+30 at 0x0p+0 0x0p+0 0x0p+0 square 0x0p+0 0x0p+0 0x1p+10"));
    CHECK(got.until_s == 1073741824 && got.square.half_width_m == 1024 && !got.square.own);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(notes_come_back), cmocka_unit_test(other_lines_are_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
