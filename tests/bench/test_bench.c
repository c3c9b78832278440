/* The harness of benchmarks: what it says of times it was given, what it refuses, and that a broken promise shows in
 * the table, the file and the exit code. */
#include "tests/bench/bench.h"
#include "tests/check.h"

#include <stdlib.h>
#include <unistd.h>

static int    works[2];
static double error_now;

static void count_work(void *user) { ++*(int *)user; }

static Status judged_run(Bench *bench)
{
    BenchTime       time[2];
    const BenchWork work[2] = {{count_work, &works[0], 1}, {count_work, &works[1], 4}};
    works[0] = works[1] = 0;
    bench_time(time, bench, work, 2);
    CHECK(time[0].rounds >= 3 && time[0].rounds == time[1].rounds);
    CHECK(works[0] == time[0].rounds + 1 && works[1] == works[0]); /* in turn, and once to warm up */
    BenchRow row = bench_row_of("a \"work\", counted", &time[0], "runs/s", 1);
    row.error = error_now;
    row.error_limit = 1;
    row.error_unit = "m";
    row.against = "nothing";
    bench_add(bench, &row);
    row = bench_row("a figure without a time");
    bench_add(bench, &row);
    const char *size = bench_option(bench, "size");
    CHECK(!size || strcmp(size, "3x4") == 0);
    CHECK(bench_option(bench, "siz") == NULL);
    return STATUS_OK;
}

/* ---- the rule of tunables ------------------------------------------------------------------------ */

/* Makes nine rounds about a time, each so much above or below it. */
static BenchSetting point_of(const char *setting, double s, double spread, double error, double bytes)
{
    BenchSetting p = {.setting = setting, .time = {.rounds = 9}, .error = error, .bytes = bytes};
    for (int r = 0; r < 9; r++) p.time.item_s[r] = s * (1 + spread * (r * 5 % 9 - 4) / 4);
    bench_time_finish(&p.time);
    return p;
}

static const BenchTunable tunable = {.name = "a tunable",
                                     .turned_by = "sensor.<key>",
                                     .of = "a work",
                                     .error_unit = "%",
                                     .against = "the whole & more",
                                     .stated = 2};

static void a_setting_that_is_better_and_nowhere_worse_dominates(void **state)
{
    (void)state;
    const BenchSetting held = point_of("held", 1e-3, 0.02, 1, 1e6);
    const struct {
        BenchSetting point;
        bool         dominates, is_dominated;
    } cases[] = {
        {point_of("faster", 0.8e-3, 0.02, 1, 1e6), true, false},
        {point_of("closer", 1e-3, 0.02, 0.8, 1e6), true, false},
        {point_of("smaller", 1e-3, 0.02, 1, 0.8e6), true, false},
        {point_of("faster and worse", 0.5e-3, 0.02, 1.1, 1e6), false, false},
        {point_of("closer and slower", 1.1e-3, 0.02, 0.5, 1e6), false, false},
        {point_of("slower, memory saves it", 1.5e-3, 0.02, 1, 0.5e6), false, false},
        {point_of("worse, memory saves it", 1e-3, 0.02, 2, 0.5e6), false, false},
        {point_of("slower", 1.2e-3, 0.02, 1, 1e6), false, true},
        {point_of("all worse", 2e-3, 0.02, 2, 2e6), false, true},
        {point_of("the same", 1e-3, 0.02, 1, 1e6), false, false},
        {point_of("noise of time", 0.95e-3, 0.02, 1, 1e6), false, false},
        {point_of("noise of a busy machine", 0.85e-3, 0.5, 1, 1e6), false, false},
        {point_of("noise of error", 1e-3, 0.02, 0.95, 1e6), false, false},
        {point_of("memory unknown", 0.8e-3, 0.02, 1, 0), true, false},
        {point_of("error unknown", 0.5e-3, 0.02, NAN, 1e6), false, false},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        if (bench_dominates(&tunable, &cases[k].point, &held) != cases[k].dominates ||
            bench_dominates(&tunable, &held, &cases[k].point) != cases[k].is_dominated) {
            print_error("%s\n", cases[k].point.setting);
            CHECK(false);
        }
    }
    const BenchSetting unknown = cases[14].point;
    CHECK(!bench_on_front(&tunable, &unknown, 1, 0));
    /* far below what is stated, a difference is rounding; the faster wins nothing by it either */
    const BenchSetting tiny = point_of("", 1e-3, 0.02, 1e-9, 0), less = point_of("", 1e-3, 0.02, 1e-10, 0);
    CHECK(!bench_dominates(&tunable, &less, &tiny) && !bench_dominates(&tunable, &tiny, &less));
    const BenchSetting three[3] = {held, cases[0].point, cases[4].point};
    CHECK(!bench_on_front(&tunable, three, 3, 0) && bench_on_front(&tunable, three, 3, 1) &&
          bench_on_front(&tunable, three, 3, 2));
}

/* Settings with two errors are judged by both: better in one alone dominates nobody that is better in the other. */
static void two_errors_are_judged_together(void **state)
{
    (void)state;
    BenchSetting held = point_of("held", 1e-3, 0.02, 1, 1e6), other = point_of("other", 0.5e-3, 0.02, 0.5, 0.5e6);
    CHECK(bench_dominates(&tunable, &other, &held)); /* none has a second */
    held.also = other.also = 3;
    CHECK(bench_dominates(&tunable, &other, &held));
    other.also = 3.5;
    CHECK(!bench_dominates(&tunable, &other, &held) && !bench_dominates(&tunable, &held, &other));
    other.also = NAN;
    CHECK(!bench_dominates(&tunable, &other, &held));
    other = held, other.also = 2; /* the same, but for the second */
    CHECK(bench_dominates(&tunable, &other, &held) && !bench_dominates(&tunable, &held, &other));
}

static bool says(const BenchSetting *point, int count, bool quick, const char *text)
{
    char words[512];
    bench_verdict(words, &tunable, point, count, quick);
    const bool found = strstr(words, text);
    if (!found) print_error("%s\n", words);
    return found;
}

static void verdicts_are_said_in_words(void **state)
{
    (void)state;
    BenchSetting three[3] = {point_of("coarse", 0.5e-3, 0.02, 4, 1e6), point_of("middle", 1e-3, 0.02, 1, 1e6),
                             point_of("fine", 2e-3, 0.02, 0.2, 3e6)};
    CHECK(says(three, 3, false, "nothing is judged"));
    three[1].is_default = true;
    CHECK(says(three, 3, false, "'middle', keeps its stated error: 1.00 %, stated at most 2.00 %. It is on the front"));
    CHECK(says(three, 3, false, "the next faster one is 'coarse': 0.5 x the time, 4 x the error;"));
    CHECK(says(three, 3, false, "the next closer one is 'fine': 2 x the time, 0.2 x the error, 3 x the memory."));
    three[1].error = 2.5;
    CHECK(says(three, 3, false, "MISSES its stated error"));
    three[0].error = 0.1; /* planted: quicker, closer, no larger */
    CHECK(says(three, 3, false, "2.5") &&
          says(three, 3, false, " 1 better setting: 'coarse': 0.5 x the time, 0.04 x the"));
    CHECK(says(three, 3, false, "NOT on the front") && says(three, 3, true, "not judged"));
    three[1].error = NAN;
    CHECK(says(three, 3, false, "'middle', is unknown"));
}

/* What is planted in noise: times of a machine that others share. A default that another setting beats by a quarter
 * must fail in nearly all draws, one that is as good must hardly ever. Lognormal noise of 20 %, the same for all of a
 * round, as a neighbour makes it, and 5 % of each alone; 7 rounds, the fewest that there are. */
static void noise_neither_hides_nor_makes_a_verdict(void **state)
{
    (void)state;
    enum { draws = 1000 };
    int found = 0, made = 0;
    for (uint32_t n = 0; n < draws; n++) {
        BenchSetting        two[3] = {point_of("held", 1, 0, 1, 0), point_of("a quarter faster", 1, 0, 1, 0),
                                      point_of("as good", 1, 0, 1, 0)};
        static const double take_s[3] = {1, 0.75, 1};
        for (int k = 0; k < 3; k++) two[k].time.rounds = 7;
        for (int r = 0; r < 7; r++) {
            const double all = exp(0.2 * random_normal(3, n, (uint32_t)r, 9));
            for (int k = 0; k < 3; k++)
                two[k].time.item_s[r] = take_s[k] * all * exp(0.05 * random_normal(3, n, (uint32_t)r, (uint64_t)k));
        }
        found += bench_dominates(&tunable, &two[1], &two[0]);
        made += bench_dominates(&tunable, &two[2], &two[0]);
    }
    print_message("of %d: found %d, made of nothing %d\n", draws, found, made);
    CHECK(found > 0.99 * draws); /* the median's own 0.035 is five times below 0.9 - 0.75 */
    CHECK(made < 0.01 * draws);  /* and three times below 1 - 0.9 */
}

static BenchSetting settings[3];

static Status tunable_run(Bench *bench)
{
    bench_tunable_rows(bench, &tunable, settings, 3);
    return STATUS_OK;
}

static Status broken_run(Bench *bench)
{
    (void)bench;
    return STATUS_IO;
}

static const BenchSuite suites[] = {{.name = "judged", .help = "", .options = "size=WxH,model=FILE", .run = judged_run},
                                    {.name = "broken", .help = "", .run = broken_run},
                                    {.name = "tunable", .help = "", .run = tunable_run}};

static const BenchSuite *next(size_t state[2]) { return state[0] < 3 ? &suites[state[0]++] : NULL; }

static int command(int argc, const char *const *argv)
{
    char *copy[8];
    for (int i = 0; i < argc; i++) copy[i] = (char *)(uintptr_t)argv[i];
    return bench_command(argc, copy, next);
}
#define COMMAND(...) command(sizeof((const char *[]){__VA_ARGS__}) / sizeof(char *), (const char *[]){__VA_ARGS__})

static void medians_and_ratios_are_those_of_rounds(void **state)
{
    (void)state;
    BenchTime a = {.rounds = 4, .item_s = {4, 1, 100, 2}}, b = {.rounds = 4, .item_s = {1, 1, 50, 1}};
    bench_time_finish(&a);
    CHECK_NEAR(a.median_s, 3, 0);
    CHECK_NEAR(a.best_s, 1, 0);
    CHECK_NEAR(bench_ratio(&a, &b), 2, 0); /* of 4, 1, 2, 2 */
    const BenchRow row = bench_row_of("", &a, "M/s", 1e6);
    CHECK_NEAR(row.rate, 1 / 3e6, 1e-20);
    CHECK(isnan(row.error) && isnan(row.error_limit) && isnan(row.ratio));
}

static void an_error_beyond_its_limit_fails_the_run(void **state)
{
    (void)state;
    error_now = 1;
    CHECK(COMMAND("bench", "judged", "--quick", "--size", "3x4") == 0);
    error_now = 1.001;
    CHECK(COMMAND("bench", "judged", "--quick") == 1);
    error_now = NAN;
    CHECK(COMMAND("bench", "judged", "--quick") == 1);
    CHECK(COMMAND("bench", "broken", "--quick") == 1);
}

static void what_it_does_not_know_it_refuses(void **state)
{
    (void)state;
    CHECK(COMMAND("bench") == 2);
    CHECK(COMMAND("bench", "nothing") == 2);
    CHECK(COMMAND("bench", "judged", "--sise", "3x4") == 2);
    CHECK(COMMAND("bench", "judged", "size", "3x4") == 2);
    CHECK(COMMAND("bench", "judged", "--model") == 2);
    CHECK(COMMAND("bench", "broken", "--size", "3x4") == 2); /* another suite's */
    CHECK(COMMAND("bench", "judged", "--threads", "0") == 2);
    CHECK(COMMAND("bench", "judged", "--quick", "--csv", "/nowhere/at/all.csv") == 1);
    CHECK(COMMAND("bench", "--help") == 0);
}

static void the_file_has_a_row_for_each_and_says_what_holds(void **state)
{
    char path[text_file_size], text[2048];
    (void)state;
    text_file(path, "");
    error_now = 0.5;
    CHECK(COMMAND("bench", "judged", "--quick", "--csv", path) == 0);
    Table table;
    CHECK(table_open(&table, path) == STATUS_OK);
    CHECK(table.rows == 2 && table.columns == 17);
    CHECK(strcmp(table_text(&table, 0, table_column(&table, "what")), "a \"work\", counted") == 0);
    CHECK(strcmp(table_text(&table, 0, table_column(&table, "holds")), "yes") == 0);
    CHECK(strcmp(table_text(&table, 0, table_column(&table, "error")), "0.5") == 0);
    CHECK(strcmp(table_text(&table, 1, table_column(&table, "holds")), "") == 0);
    CHECK(strcmp(table_text(&table, 1, table_column(&table, "median")), "") == 0);
    table_close(&table);
    FILE *file = fopen(path, "r");
    CHECK(file && fgets(text, sizeof text, file) && strncmp(text, "# ", 2) == 0 &&
          strstr(text, "pitviper ")); /* the machine */
    fclose(file);
    remove(path);
}

static void a_default_off_the_front_fails_and_is_told_why(void **state)
{
    (void)state;
    char path[text_file_size];
    text_file(path, "");
    settings[0] = point_of("coarse", 0.5e-3, 0.02, 4, 0);
    settings[1] = point_of("default", 1e-3, 0.02, 1, 0);
    settings[2] = point_of("fine", 2e-3, 0.02, 0.2, 0);
    settings[1].is_default = true;
    CHECK(COMMAND("bench", "tunable", "--csv", path) == 0);
    Table table;
    CHECK(table_open(&table, path) == STATUS_OK && table.rows == 4);
    const int mark = table_column(&table, "mark"), what = table_column(&table, "what"),
              error = table_column(&table, "error");
    CHECK(strcmp(table_text(&table, 1, what), "a tunable: default") == 0);
    CHECK(strcmp(table_text(&table, 1, mark), "* default") == 0 && strcmp(table_text(&table, 2, mark), "*") == 0);
    CHECK(strcmp(table_text(&table, 3, error), "0") == 0);
    table_close(&table);

    settings[2] = point_of("fine", 0.9e-3, 0.02, 0.2, 0);
    CHECK(COMMAND("bench", "tunable", "--quick") == 0); /* shown, not judged */
    CHECK(COMMAND("bench", "tunable", "--csv", path) == 1);
    CHECK(table_open(&table, path) == STATUS_OK);
    CHECK(strcmp(table_text(&table, 1, mark), "default") == 0 && strcmp(table_text(&table, 3, error), "1") == 0);
    CHECK(strstr(table_text(&table, 3, table_column(&table, "against")), "'fine': 0.9 x the time, 0.2 x the error"));
    table_close(&table);

    settings[2] = point_of("fine", 2e-3, 0.02, 0.2, 0);
    settings[1].error = 2.1; /* stated: 2 */
    CHECK(COMMAND("bench", "tunable", "--quick") == 1);
    remove(path);
}

/* What is text in a picture stays text, and points without a figure do not spoil it. */
static void a_plot_shows_each_setting_once(void **state)
{
    (void)state;
    char        folder[] = "/tmp/pitviper_plots_XXXXXX", path[64];
    static char text[32768];
    CHECK(mkdtemp(folder) != NULL);
    settings[0] = point_of("<a> & b", 0.5e-3, 0.02, 0, 2e6);
    settings[1] = point_of("default", 1e-3, 0.02, 1, 1e6);
    settings[2] = point_of("unknown", 2e-3, 0.02, NAN, 0);
    settings[1].is_default = true;
    COMMAND("bench", "tunable", "--quick", "--plots", folder);
    snprintf(path, sizeof path, "%s/a-tunable.svg", folder);
    FILE *file = fopen(path, "r");
    CHECK(file != NULL);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    CHECK(strstr(text, "&lt;a&gt; &amp; b (2 MB)") && !strstr(text, "<a>") && !strstr(text, "nan") &&
          !strstr(text, "inf"));
    CHECK(strstr(text, "1 without a time or an error") && strstr(text, "stated: 2 %") && strstr(text, "</svg>"));
    CHECK(strstr(text, "run time, us") && strstr(text, "class=\"df\""));
    remove(path);
    rmdir(folder);
    CHECK(COMMAND("bench", "tunable", "--quick", "--plots", "/proc/nowhere") == 1);
}

/* ---- two runs side by side -------------------------------------------------------------------- */

static const char *const csv_head =
    "# version: 0.1\n# machine: a box\n# rounds: full\n# threads: 2\n"
    "bench,what,median,best,unit,error,error_limit,error_unit,lower_quartile,upper_quartile\n";

static int compare(const char *a, const char *b, const char *slower)
{
    char path[2][text_file_size], text[2][4096];
    snprintf(text[0], sizeof text[0], "%s%s", csv_head, a);
    snprintf(text[1], sizeof text[1], "%s%s", csv_head, b);
    text_file(path[0], text[0]);
    text_file(path[1], text[1]);
    const int code = slower ? COMMAND("bench", "compare", path[0], path[1], "--slower", slower)
                            : COMMAND("bench", "compare", path[0], path[1]);
    remove(path[0]);
    remove(path[1]);
    return code;
}

static void what_became_worse_fails_a_comparison(void **state)
{
    const char *const base = "s,frame,1e-3,0.9e-3,s,0.5,1,m,0.95e-3,1.05e-3\n";
    (void)state;
    CHECK(compare(base, base, "1.01") == 0);
    CHECK(compare(base, "s,frame,1.3e-3,1.2e-3,s,0.5,1,m,1.25e-3,1.35e-3\n", NULL) == 0);
    CHECK(compare(base, "s,frame,1.3e-3,1.2e-3,s,0.5,1,m,1.25e-3,1.35e-3\n", "1.2") == 1);
    CHECK(compare(base, "s,frame,1.3e-3,1.2e-3,s,0.5,1,m,1.25e-3,1.35e-3\n", "1.4") == 0);
    CHECK(compare(base, "s,frame,1.3e-3,0.9e-3,s,0.5,1,m,1.0e-3,1.6e-3\n", "1.2") == 0); /* the quartiles meet */
    CHECK(compare(base, "s,frame,1e-3,0.9e-3,s,0.9,1,m,,\n", NULL) == 0);                /* worse, within its limit */
    CHECK(compare(base, "s,frame,1e-3,0.9e-3,s,1.1,1,m,,\n", NULL) == 1);
    CHECK(compare(base, "s,frame,1e-3,0.9e-3,s,,1,m,,\n", NULL) == 1); /* no longer known */
    CHECK(compare(base, "s,frame,1e-3,0.9e-3,s,inf,1,m,,\n", NULL) == 1);
    CHECK(compare("s,frame,1,,s,3,1,m,,\n", "s,frame,1,,s,2,1,m,,\n", NULL) == 0); /* broken before, and now less so */
    CHECK(compare(base, "s,another,1e-3,,s,9,1,m,,\n", NULL) == 0);                /* only in one: told, not judged */
    CHECK(compare("s,x,1,,s,,,,,\ns,x,2,,s,,,,,\n", "s,x,1,,s,,,,,\ns,x,2,,s,,,,,\n", "1.1") ==
          0); /* one name twice: in turn */
}

static void a_table_that_is_none_is_refused(void **state)
{
    static const char *const bad[] = {"s,frame,1e-3,,s,0.5,1\n",    "s,frame,many,,s,0.5,1,m,,\n",
                                      "s,frame,-1,,s,0.5,1,m,,\n",  "s,frame,1e999,,s,0.5,1,m,,\n",
                                      "s,\"frame,1,,s,0.5,1,m,,\n", "s,frame,nan,,s,0.5,1,m,,\n"};
    char                     path[text_file_size];
    (void)state;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) CHECK(compare(bad[k], bad[k], NULL) == 1);
    text_file(path, "");
    CHECK(COMMAND("bench", "compare", path, path) == 1);
    remove(path);
    text_file(path, "a,b\n1,2\n");
    log_set_sink(check_listen, NULL);
    CHECK(COMMAND("bench", "compare", path, path) == 1);
    CHECK(strstr(check_said, "no column `bench`"));
    log_set_sink(NULL, NULL);
    CHECK(COMMAND("bench", "compare", path) == 2);
    CHECK(COMMAND("bench", "compare", path, path, path) == 2);
    CHECK(COMMAND("bench", "compare", path, path, "--slower", "0.5") == 2);
    CHECK(COMMAND("bench", "compare", path, path, "--report") == 2);
    remove(path);
    CHECK(COMMAND("bench", "compare", path, path) == 1);
}

/* ---- all, as a page --------------------------------------------------------------------------- */

static void a_page_says_first_what_failed(void **state)
{
    char        path[text_file_size];
    static char text[65536];
    (void)state;
    text_file(path, "");
    settings[0] = point_of("coarse", 0.5e-3, 0.02, 4, 0);
    settings[1] = point_of("default", 1e-3, 0.02, 2.5, 0);
    settings[2] = point_of("fine", 2e-3, 0.02, 0.2, 0);
    settings[1].is_default = true;
    error_now = 0.5;
    CHECK(COMMAND("bench", "all", "--quick", "--report", path, "--size", "3x4") == 1);
    FILE *file = fopen(path, "r");
    CHECK(file != NULL);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    const char *failed = strstr(text, "1 of 2 errors beyond their limit; 1 suites did not come"),
               *row = strstr(text, "a tunable: default");
    const char *machine = strstr(text, "<h2>Machine"), *plot = strstr(text, "<svg");
    CHECK(failed && row && machine && plot && failed < row && row < machine && machine < plot);
    CHECK(strstr(text, "a &quot;work&quot;, counted") && strstr(text, "broken did not come to its end"));
    remove(path);
    CHECK(COMMAND("bench", "judged", "--quick", "--report", "/nowhere/at/all.html") == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(medians_and_ratios_are_those_of_rounds),
        cmocka_unit_test(an_error_beyond_its_limit_fails_the_run),
        cmocka_unit_test(what_it_does_not_know_it_refuses),
        cmocka_unit_test(a_setting_that_is_better_and_nowhere_worse_dominates),
        cmocka_unit_test(two_errors_are_judged_together),
        cmocka_unit_test(verdicts_are_said_in_words),
        cmocka_unit_test(noise_neither_hides_nor_makes_a_verdict),
        cmocka_unit_test(a_default_off_the_front_fails_and_is_told_why),
        cmocka_unit_test(a_plot_shows_each_setting_once),
        cmocka_unit_test(what_became_worse_fails_a_comparison),
        cmocka_unit_test(a_table_that_is_none_is_refused),
        cmocka_unit_test(a_page_says_first_what_failed),
        cmocka_unit_test(the_file_has_a_row_for_each_and_says_what_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
