/* Draws of a sweep: different ones, as many as asked for or a line that says why not; those of a smaller count first;
 * no value and no combination favoured. labels: physics */
#include "tests/check.h"

#include "sensor/commands/sweep/sweep.h"

enum { text_size = 4096 };

static Status read_text(Sweep *sweep, const char *text)
{
    static Config base;
    char          path[text_file_size];
    base = config_default();
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = sweep_read(sweep, path, &base);
    remove(path);
    return status;
}

/* All values of a variant as numbers where they are numbers: what makes two the same. */
static void say(char out[text_size], const Sweep *sweep, int variant)
{
    char   value[sweep_value_size];
    double number;
    size_t n = 0;
    for (int i = 0; i < sweep->axis_count; i++) {
        sweep_value(value, sweep, variant, i);
        if (text_to_double(&number, value)) n += (size_t)snprintf(out + n, text_size - n, "%.17g|", number);
        else n += (size_t)snprintf(out + n, text_size - n, "%s|", value);
    }
}

static int by_text(const void *a, const void *b) { return strcmp(a, b); }

static int distinct(const Sweep *sweep)
{
    char(*said)[text_size] = malloc((size_t)sweep->count * sizeof *said);
    int different = 0;
    CHECK(said);
    for (int i = 0; i < sweep->count; i++) say(said[i], sweep, i);
    qsort(said, (size_t)sweep->count, sizeof *said, by_text);
    for (int i = 0; i < sweep->count; i++) different += i == 0 || strcmp(said[i - 1], said[i]) != 0;
    free(said);
    return different;
}

static void draws_differ(void **state)
{
    (void)state;
    static const char *const axes[] = {
        "{seed: [1, 2, 3], weather.visibility_m: [5000, 23000]}",
        "{seed: {from: 4, to: 6}, sensor.optical: [rgb, pan, rgb]}",
        "{seed: [7], sensor.optical: [rgb, rgb, rgb, rgb, rgb, rgb, rgb, pan], weather.visibility_m: [1000, 2000, 3000]}",
    };
    char   text[text_size], few[text_size], all[text_size];
    Sweep *sweep = calloc(2, sizeof *sweep), *six = sweep + 1;
    CHECK(sweep);
    for (size_t i = 0; i < sizeof axes / sizeof *axes; i++) {
        snprintf(text, sizeof text, "mode: random\ncount: 6\naxes: %s\n", axes[i]);
        if (read_text(six, text) != STATUS_OK) fail_msg("%s", check_said);
        CHECK(six->count == 6 && distinct(six) == 6);
        for (int count = 1; count < 6; count++) {
            snprintf(text, sizeof text, "mode: random\ncount: %d\naxes: %s\n", count, axes[i]);
            CHECK(read_text(sweep, text) == STATUS_OK && sweep->count == count);
            for (int v = 0; v < count; v++) {
                say(few, sweep, v);
                say(all, six, v);
                assert_string_equal(few, all);
            }
            sweep_close(sweep);
        }
        sweep_close(six);
        snprintf(text, sizeof text, "mode: random\ncount: 7\naxes: %s\n", axes[i]);
        assert_int_equal(read_text(sweep, text), STATUS_BAD_VALUE);
        CHECK(strstr(check_said, ":2: count: 7 different draws are requested, but the axes have 6 combinations"));
    }
    CHECK(read_text(six,
                    "mode: random\ncount: 4\naxes: {weather.visibility_m: [5000, 5e3, 23000.0, 23000], seed: [1, 2]}"
                    "\n") == STATUS_OK);
    CHECK(distinct(six) == 4);
    sweep_close(six);
    free(sweep);
}

/* Every one of many combinations is found, and one that is drawn once in 1e12 times too. */
static void the_rare_are_found(void **state)
{
    (void)state;
    Sweep *sweep = calloc(1, sizeof *sweep);
    char  *text = malloc(200000);
    CHECK(sweep && text);
    CHECK(read_text(sweep, "mode: random\ncount: 10000\naxes: {seed: {from: 1, to: 100}, weather.pressure_mbar: [") !=
          STATUS_OK); /* a list without an end */
    int n = snprintf(text, 200000,
                     "mode: random\ncount: 5000\naxes: {seed: {from: 1, to: 50}, weather.pressure_mbar: [900");
    for (int i = 1; i < 100; i++) n += snprintf(text + n, 200, ", %d", 900 + i);
    snprintf(text + n, 200, "]}\n");
    CHECK(read_text(sweep, text) == STATUS_OK && distinct(sweep) == 5000);
    sweep_close(sweep);

    static const char *const keys[] = {"sensor.width_px", "sensor.height_px", "radar.bins"};
    n = snprintf(text, 200000, "mode: random\ncount: 8\naxes:\n");
    for (int k = 0; k < 3; k++) {
        n += snprintf(text + n, 200, "  %s: [64", keys[k]);
        for (int i = 0; i < 9999; i++) n += snprintf(text + n, 200, ",%d", i == 5000 ? 65 : 64);
        n += snprintf(text + n, 200, "]\n");
    }
    CHECK(read_text(sweep, text) == STATUS_OK && distinct(sweep) == 8);
    sweep_close(sweep);

    assert_int_equal(read_text(sweep, "mode: random\ncount: 3\naxes: {sensor.hfov_deg: {from: 3, to: 3.000000001}}\n"),
                     STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "count: only "));
    assert_int_equal(read_text(sweep, "mode: random\ncount: 2\naxes: {sensor.hfov_deg: {from: 3, to: 3}}\n"),
                     STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "1 combination;"));
    free(text);
    free(sweep);
}

/* The first draw over many seeds: each of twelve combinations as often as any other. chi2 of 11 degrees of freedom is
 * above 31.3 once in a thousand times; the draws are always the same ones. */
static void none_is_favoured(void **state)
{
    (void)state;
    int    count[3][4] = {{0}};
    Sweep *sweep = calloc(1, sizeof *sweep);
    char   text[256], a[sweep_value_size], b[sweep_value_size];
    CHECK(sweep);
    for (int seed = 0; seed < 1200; seed++) {
        snprintf(text, sizeof text,
                 "mode: random\ncount: 2\ndraw: %d\naxes: {seed: [0, 1, 2], radar.bins: {from: 64, to: 67}}\n", seed);
        if (read_text(sweep, text) != STATUS_OK) fail_msg("%s", check_said);
        sweep_value(a, sweep, 1, 0); /* the second: it passed over what the first is */
        sweep_value(b, sweep, 1, 1);
        count[atoi(a)][atoi(b) - 64]++;
        sweep_close(sweep);
    }
    double chi2 = 0;
    for (int i = 0; i < 12; i++) chi2 += (count[i / 4][i % 4] - 100.) * (count[i / 4][i % 4] - 100.) / 100;
    if (!(chi2 < 31.3)) fail_msg("chi2 %g", chi2);
    free(sweep);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_differ),
        cmocka_unit_test(the_rare_are_found),
        cmocka_unit_test(none_is_favoured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
