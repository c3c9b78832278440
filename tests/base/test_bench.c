/* The harness of benchmarks: what it says of times it was given, what it refuses, and that a broken promise shows in
 * the table, the file and the exit code. */
#include "tests/check.h"

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
    BenchRow row    = bench_row_of("a \"work\", counted", &time[0], "runs/s", 1);
    row.error       = error_now;
    row.error_limit = 1;
    row.error_unit  = "m";
    row.against     = "nothing";
    bench_add(bench, &row);
    row = bench_row("a figure without a time");
    bench_add(bench, &row);
    const char *size = bench_option(bench, "size");
    CHECK(!size || strcmp(size, "3x4") == 0);
    CHECK(bench_option(bench, "siz") == NULL);
    return STATUS_OK;
}

static Status broken_run(Bench *bench)
{
    (void)bench;
    return STATUS_IO;
}

static const BenchSuite suites[] = {{.name = "judged", .help = "", .options = "size=WxH,model=FILE", .run = judged_run},
                                    {.name = "broken", .help = "", .run = broken_run}};

static const BenchSuite *next(size_t state[2]) { return state[0] < 2 ? &suites[state[0]++] : NULL; }

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
    CHECK(COMMAND("bench", "judged", "--siz", "3x4") == 2);
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
    CHECK(table.rows == 2 && table.columns == 14);
    CHECK(strcmp(table_text(&table, 0, table_column(&table, "what")), "a \"work\", counted") == 0);
    CHECK(strcmp(table_text(&table, 0, table_column(&table, "holds")), "yes") == 0);
    CHECK(strcmp(table_text(&table, 0, table_column(&table, "error")), "0.5") == 0);
    CHECK(strcmp(table_text(&table, 1, table_column(&table, "holds")), "") == 0);
    CHECK(strcmp(table_text(&table, 1, table_column(&table, "median")), "") == 0);
    table_close(&table);
    FILE *file = fopen(path, "r");
    CHECK(file && fgets(text, sizeof text, file) && strncmp(text, "# ", 2) == 0 && strstr(text, "pitviper ")); /* the machine */
    fclose(file);
    remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(medians_and_ratios_are_those_of_rounds),
        cmocka_unit_test(an_error_beyond_its_limit_fails_the_run),
        cmocka_unit_test(what_it_does_not_know_it_refuses),
        cmocka_unit_test(the_file_has_a_row_for_each_and_says_what_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
