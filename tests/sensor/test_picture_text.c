/* Words and boxes in pictures, pixel by pixel. */
#include "tests/check.h"

#include "sensor/publish/images/picture_text.h"

enum { width = 80, height = 60, untouched = 77 };

static bool on_edge(int x, int y, int x0, int y0, int x1, int y1)
{
    return x >= x0 && x < x1 && y >= y0 && y < y1 && (x == x0 || x == x1 - 1 || y == y0 || y == y1 - 1);
}

/* White just outside the box, black just outside of that; what lies outside of the columns, or of the picture, stays.
 */
static void a_box_is_drawn_around_its_pixels(void **state)
{
    (void)state;
    static uint16_t  wide[width * height * 3 + 1];
    static uint8_t   grey[width * height + 1];
    static const int box[][4] = {{20, 15, 40, 30}, {20, 15, 21, 16}, {0, 0, width, height},
                                 {-9, 40, 5, 90},  {60, -9, 99, 3},  {2, 2, 78, 58}};
    for (size_t k = 0; k < sizeof box / sizeof *box; k++)
        for (int columns = 0; columns < 2; columns++) {
            const int left = columns ? 10 : 0, right = columns ? 61 : width, *b = box[k];
            for (int i = 0; i < width * height * 3 + 1; i++) wide[i] = untouched;
            memset(grey, untouched, sizeof grey);
            picture_text_box(&(Drawing){grey, width, height, 1, false, 255, left, right}, b);
            picture_text_box(&(Drawing){wide, width, height, 3, true, 1023, left, right}, b);
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++) {
                    const bool inside = x >= left && x < right;
                    const int  white = inside && on_edge(x, y, b[0] - 1, b[1] - 1, b[2] + 1, b[3] + 1);
                    const int  black = inside && on_edge(x, y, b[0] - 2, b[1] - 2, b[2] + 2, b[3] + 2);
                    const int  at = y * width + x;
                    assert_int_equal(grey[at], white ? 255 : black ? 0 : untouched);
                    for (int p = 0; p < 3; p++)
                        assert_int_equal(wide[3 * at + p], white ? 1023 : black ? 0 : untouched);
                }
            CHECK(grey[width * height] == untouched && wide[3 * width * height] == untouched);
        }
}

static uint8_t picture[width * height];

static void draw(int x, int y, int times, const char *text)
{
    memset(picture, untouched, sizeof picture);
    picture_text_draw(&(Drawing){picture, width, height, 1, false, 255, 0, width}, x, y, times, text);
}

/* Whether the font is installed: without it there are no words. */
static bool has_font(void)
{
    draw(10, 10, 1, "H");
    for (int i = 0; i < width * height; i++)
        if (picture[i] != untouched) return true;
    return false;
}

/* A letter fills 6 x 10 dots, black where it does not stand, with one dot of black before the first; a capital is 7
 * high and begins at the given row. */
static void letters_stand_in_their_cells(void **state)
{
    (void)state;
    static uint8_t first[width * height], both[width * height];
    if (!has_font()) skip();
    for (int times = 1; times <= 5; times++) {
        const int x0 = 12, y0 = 9;
        int       top = height, bottom = -1;
        draw(x0, y0, times, "H");
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const bool cell = x >= x0 - times && x < x0 + 6 * times && y >= y0 - times && y < y0 + 9 * times;
                const int  value = picture[y * width + x];
                if (!cell) assert_int_equal(value, untouched);
                if (cell && x < x0) assert_int_equal(value, 0);
                if (cell && value > 127) top = y < top ? y : top, bottom = y > bottom ? y : bottom;
            }
        /* DejaVu's capitals are 0.729 of its size high: 6.56 dots of 9, on the foot of the seventh row */
        CHECK(bottom + 1 == y0 + 7 * times);
        CHECK_NEAR(top, y0 + (7 - 9 * 0.729) * times, 1);
    }
    /* letters one behind the other: the second as if alone at its place */
    draw(8, 20, 2, "Hg");
    memcpy(both, picture, sizeof both);
    draw(8, 20, 2, "H");
    memcpy(first, picture, sizeof first);
    draw(8 + 12, 20, 2, "g");
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const int at = y * width + x;
            assert_int_equal(both[at], x < 20 ? first[at] : picture[at]);
        }
    CHECK(memcmp(both, first, sizeof both) != 0);
    /* the first and the last of ASCII, and what has no letter */
    draw(8, 20, 2, "?");
    memcpy(first, picture, sizeof first);
    static const char *const others[] = {"\x1F", "\x7F", "\xE9"};
    for (int k = 0; k < 3; k++) {
        draw(8, 20, 2, others[k]);
        assert_memory_equal(picture, first, sizeof first);
    }
    draw(8, 20, 2, "~");
    CHECK(memcmp(picture, first, sizeof first) != 0);
    draw(8, 20, 2, " ");
    for (int y = 18; y < 38; y++)
        for (int x = 6; x < 20; x++) assert_int_equal(picture[y * width + x], 0);
    /* sizes below 1 and above 8 are these */
    draw(8, 20, 1, "H");
    memcpy(first, picture, sizeof first);
    draw(8, 20, 0, "H");
    assert_memory_equal(picture, first, sizeof first);
    draw(8, 2, 8, "H");
    memcpy(first, picture, sizeof first);
    draw(8, 2, 9, "H");
    assert_memory_equal(picture, first, sizeof first);
}

/* picture_text_write: white on black in colour, twice as large as a dot, cut at the picture's edges. */
static void words_in_colour(void **state)
{
    (void)state;
    static uint8_t rgb[width * height * 3 + 3];
    if (!has_font()) skip();
    memset(rgb, untouched, sizeof rgb);
    draw(70, 50, 2, "Wg");
    picture_text_write(rgb, width, height, 70, 50, "Wg");
    for (int i = 0; i < width * height; i++)
        for (int p = 0; p < 3; p++) assert_int_equal(rgb[3 * i + p], picture[i]);
    CHECK(rgb[sizeof rgb - 1] == untouched);
    CHECK(picture[(50 + 5) * width + width - 1] != untouched && picture[(height - 1) * width + 75] != untouched);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_drawn_around_its_pixels),
        cmocka_unit_test(letters_stand_in_their_cells),
        cmocka_unit_test(words_in_colour),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
