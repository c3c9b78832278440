/* Axes of plots and what is written of them: ticks worked out by hand, places on the page. */
#include "tests/check.h"

#include "sensor/publish/files/svg_plot.h"

static char  *text;
static size_t octets;

static FILE *page(void)
{
    FILE *to = open_memstream(&text, &octets);
    CHECK(to);
    return to;
}

/* Whether the page has this, which must be there so many times. */
static int times_of(const char *what)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, what)); at++) count++;
    return count;
}

static void check_ticks(const SvgAxis *a, int count, const double *tick)
{
    assert_int_equal(a->ticks, count);
    for (int k = 0; k < count; k++) CHECK_NEAR(a->tick[k], tick[k], 1e-9 * fabs(tick[k]));
}

/* The first of 1, 2, 5, 10 .. 500 of which at most nine are from low to high; from the step below low to the one above
 * high. */
static void linear_axes(void **state)
{
    (void)state;
    static const struct {
        double low, high, step, from, to;
    } of[] = {{0, 9, 1, 0, 10},        {0, 9.5, 2, 0, 10},       {0, 10, 2, 0, 12},       {-3, 40, 5, -5, 45},
              {12, 19, 1, 12, 20},     {0.5, 80, 10, 0, 90},     {0, 1000, 200, 0, 1200}, {0, 901, 200, 0, 1000},
              {0, 4500, 500, 0, 5000}, {-899, 1, 100, -900, 100}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const SvgAxis a = svg_linear_axis(of[k].low, of[k].high, 50, 250);
        CHECK(a.scale == SVG_LINEAR && a.low == of[k].from && a.high == of[k].to);
        assert_int_equal(a.ticks, (int)((of[k].to - of[k].from) / of[k].step) + 1);
        for (int n = 0; n < a.ticks; n++) CHECK_NEAR(a.tick[n], of[k].from + n * of[k].step, 1e-9);
        CHECK_NEAR(svg_at(&a, a.low), 50, 1e-9);
        CHECK_NEAR(svg_at(&a, 0.75 * a.low + 0.25 * a.high), 100, 1e-9);
        CHECK_NEAR(svg_at(&a, a.high), 250, 1e-9);
    }
    CHECK(svg_linear_axis(0, 90000, 0, 1).ticks == svg_ticks_max); /* there is no larger step */
}

/* With a margin of 8 % of the decades on either side, or so much that it is 0.3 of a decade in all; ticks are whole
 * decades, else 1 and 3, else 1, 2 and 5, else even steps of 1, 2 or 5 times a power of ten, about five of them. */
static void logarithmic_axes(void **state)
{
    (void)state;
    SvgAxis a = svg_log_axis(1, 1000, 0, 348);
    CHECK_NEAR(a.low, -0.24, 1e-12);
    CHECK_NEAR(a.high, 3.24, 1e-12);
    check_ticks(&a, 4, (const double[]){1, 10, 100, 1000});
    CHECK_NEAR(svg_at(&a, 100), 224, 1e-9);
    a = svg_log_axis(1, 10, 0, 1);
    check_ticks(&a, 3, (const double[]){1, 3, 10});
    a = svg_log_axis(1.9, 10.5, 0, 1);
    check_ticks(&a, 3, (const double[]){2, 5, 10});
    a = svg_log_axis(2, 8, 0, 1); /* 1.79 .. 8.94: 2 and 5 are two; a fifth is 1.43 */
    check_ticks(&a, 7, (const double[]){2, 3, 4, 5, 6, 7, 8});
    /* one value: 0.15 of a decade about it, of which a fifth is 0.1409 of the value */
    a = svg_log_axis(10, 10, 0, 1);
    CHECK_NEAR(a.low, 0.85, 1e-12);
    CHECK_NEAR(a.high, 1.15, 1e-12);
    check_ticks(&a, 7, (const double[]){8, 9, 10, 11, 12, 13, 14}); /* 1.41: by ones */
    a = svg_log_axis(11, 11, 0, 1);
    check_ticks(&a, 4, (const double[]){8, 10, 12, 14}); /* 1.55: by twos */
    a = svg_log_axis(24, 24, 0, 1);
    check_ticks(&a, 8, (const double[]){18, 20, 22, 24, 26, 28, 30, 32}); /* 3.38 */
    a = svg_log_axis(26, 26, 0, 1);
    check_ticks(&a, 4, (const double[]){20, 25, 30, 35}); /* 3.66: by fives */
    a = svg_log_axis(0.026, 0.026, 0, 1);
    check_ticks(&a, 4, (const double[]){0.02, 0.025, 0.03, 0.035});
    a = svg_log_axis(53, 53, 0, 1);
    check_ticks(&a, 7, (const double[]){40, 45, 50, 55, 60, 65, 70}); /* 7.47 */
    a = svg_log_axis(55, 55, 0, 1);
    check_ticks(&a, 4, (const double[]){40, 50, 60, 70}); /* 7.75: by tens */
    a = svg_log_axis(100, 120, 0, 1);                     /* 0.0792 of a decade and 0.1104 about it: 77.5 .. 155 */
    CHECK_NEAR(a.high - a.low, 0.3, 1e-12);
    check_ticks(&a, 4, (const double[]){80, 100, 120, 140});
    /* of more than eight decades every second, of more than sixteen every third */
    a = svg_log_axis(1e-6, 1e6, 0, 1);
    check_ticks(&a, 7, (const double[]){1e-6, 1e-4, 1e-2, 1, 1e2, 1e4, 1e6});
    a = svg_log_axis(1e-9, 1e9, 0, 1);
    check_ticks(&a, 7, (const double[]){1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9});
    a = svg_log_axis(1e-3, 1e3, 0, 1);
    check_ticks(&a, 7, (const double[]){1e-3, 1e-2, 0.1, 1, 10, 100, 1000});
    /* a tick on an end, to rounding, is on the axis; one that is beyond it is not: 1 .. 10000 but for 5e-7 or 5e-10 of
     * a decade either side */
    for (int k = 0; k < 2; k++) {
        const double beyond = k ? 5e-10 : 5e-7, third = (4 - 2 * beyond) / 1.16;
        a = svg_log_axis(pow(10, beyond + 0.08 * third), pow(10, 4 - beyond - 0.08 * third), 0, 1);
        CHECK_NEAR(a.low, beyond, 1e-13);
        CHECK_NEAR(a.high, 4 - beyond, 1e-13);
        if (k) check_ticks(&a, 5, (const double[]){1, 10, 100, 1000, 10000});
        else check_ticks(&a, 3, (const double[]){10, 100, 1000});
    }
}

static void numbers(void **state)
{
    (void)state;
    static const struct {
        double      value;
        const char *text;
    } of[] = {{0, "0"},
              {1, "1"},
              {1000, "1000"},
              {0.001, "0.001"},
              {0.00099, "9.9e-4"},
              {0.0001, "1e-4"},
              {1e5, "1e5"},
              {99990, "9.999e+04"},
              {-2e6, "-2e6"},
              {-0.25, "-0.25"},
              {123456, "1.2e5"},
              {3e-7, "3e-7"},
              {99999.9, "1e+05"}, /* below 1e5, and so to four digits */
              {99999.99999, "1e5"},
              {2.0000005e6, "2e6"}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        char out[24];
        svg_number(out, of[k].value);
        assert_string_equal(out, of[k].text);
    }
}

static void what_is_written_of_axes(void **state)
{
    (void)state;
    const SvgBox  box = {.left = 60, .right = 260, .top = 10, .bottom = 110};
    const SvgAxis x = {SVG_HOURS, 0, 24, 60, 260, 2, {6, 18}}, y = svg_linear_axis(0, 3, 110, 10);
    FILE         *to = page();
    svg_axes(to, &box, &x, "time", &y, "kelvin");
    fclose(to);
    /* 6 of 24 hours are 50 of 200 px; the lines are as high as the box, their names 17 px below */
    CHECK(times_of("x1=\"110.0\" y1=\"10.0\" x2=\"110.0\" y2=\"110.0\"") == 1);
    CHECK(times_of("text-anchor=\"middle\" x=\"110.0\" y=\"127.0\">06:00<") == 1);
    CHECK(times_of("x=\"210.0\" y=\"127.0\">18:00<") == 1);
    /* 0 .. 4: 25 px each, from below; names 7 px to the left */
    CHECK(times_of("x1=\"60.0\" y1=\"85.0\" x2=\"260.0\" y2=\"85.0\"") == 1);
    CHECK(times_of("text-anchor=\"end\" x=\"53.0\" y=\"89.0\">1<") == 1);
    CHECK(times_of("<line class=\"g\" fill=\"none\" stroke=\"#ddd\" stroke-width=\"1\"") == 2 + 5);
    CHECK(times_of("<path class=\"ax\" fill=\"none\" stroke=\"#777\" stroke-width=\"1\" d=\"M60 10V110H260\"/>") == 1);
    CHECK(times_of("text-anchor=\"middle\" x=\"160.0\" y=\"148.0\">time<") == 1);
    CHECK(times_of("transform=\"translate(16 60) rotate(-90)\">kelvin<") == 1);
    free(text);

    to = page();
    svg_axes(to, &box, &y, "v", &x, "w"); /* without hours, plain numbers */
    svg_legend(to, &(SvgPen){SVG_RED, 2, "4 3"}, 100, 40, "a < b");
    svg_curve_begin(to, &(SvgPen){"#123456", 1.5, NULL});
    svg_curve_point(to, 1, 2.25);
    svg_curve_end(to);
    svg_circle(to, &(SvgPen){.colour = SVG_BLUE}, 5, 6, 7);
    svg_area_begin(to, SVG_PLUM, 0.25);
    svg_curve_point(to, 3, 4);
    svg_curve_end(to);
    fclose(to);
    CHECK(times_of("<polygon class=\"pl\" fill=\"#8e44ad\" fill-opacity=\"0.25\" points=\" 3.0,4.0\"/>") == 1);
    CHECK(times_of(":00<") == 0 && times_of(">6<") == 1 && times_of(">18<") == 1);
    CHECK(
        times_of(
            "<line class=\"s\" fill=\"none\" stroke=\"#c0392b\" stroke-width=\"2\" stroke-dasharray=\"4 3\" x1=\"100.0\" "
            "y1=\"40.0\" x2=\"122.0\" y2=\"40.0\"/>") == 1);
    CHECK(times_of("x=\"128.0\" y=\"44.0\">a &lt; b<") == 1);
    CHECK(
        times_of(
            "<polyline fill=\"none\" stroke=\"#123456\" stroke-width=\"1.5\" stroke-linejoin=\"round\" points=\" 1.0,2.2\"/>") ==
        1);
    CHECK(times_of("<circle class=\"f\" fill=\"#1f6fb2\" cx=\"5.0\" cy=\"6.0\" r=\"7.0\"/>") == 1);
    free(text);

    to = page();
    svg_begin(to, 320, 200, "name", " & more", "below");
    svg_end(to);
    fclose(to);
    CHECK(times_of("width=\"320\" height=\"200\" viewBox=\"0 0 320 200\"") == 1 &&
          times_of("<title>name &amp; more</title>") == 1);
    /* ten colours, each twice: filled, and as a stroke */
    CHECK(times_of(".pvp .") == 1 + 2 * 10 && times_of("{fill:none;stroke:") == 10 && times_of(">below<") == 1);
    free(text);
}

/* Spokes every 30 degrees, clockwise from above, with their names 16 px beyond; circles at the ticks. */
static void what_is_written_of_a_polar_grid(void **state)
{
    (void)state;
    const SvgAxis radius = {SVG_LINEAR, 0, 10, 0, 100, 2, {5, 10}};
    FILE         *to = page();
    svg_polar_grid(to, 200, 150, &radius);
    fclose(to);
    CHECK(times_of("cx=\"200.0\" cy=\"150.0\" r=\"50.0\"") == 1 &&
          times_of("cx=\"200.0\" cy=\"150.0\" r=\"100.0\"") == 1);
    CHECK(times_of("x=\"203.0\" y=\"112.0\">5<") == 1 && times_of("x=\"203.0\" y=\"62.0\">10<") == 1);
    CHECK(times_of("<line") == 12 && times_of(">360<") == 0);
    CHECK(times_of("x1=\"200.0\" y1=\"150.0\" x2=\"200.0\" y2=\"50.0\"") == 1);
    CHECK(times_of("x1=\"200.0\" y1=\"150.0\" x2=\"250.0\" y2=\"63.4\"") == 1);
    CHECK(times_of("x=\"200.0\" y=\"38.0\">0<") == 1); /* 150 - 116, and 4 down to the middle of its letters */
    CHECK(times_of("x=\"316.0\" y=\"154.0\">90<") == 1);
    CHECK(times_of("x=\"258.0\" y=\"53.5\">30<") == 1); /* 116 sin 30, 116 cos 30 */
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_axes),
        cmocka_unit_test(logarithmic_axes),
        cmocka_unit_test(numbers),
        cmocka_unit_test(what_is_written_of_axes),
        cmocka_unit_test(what_is_written_of_a_polar_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
