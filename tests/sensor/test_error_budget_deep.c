/* test_error_budget.c over more scenes. labels: deep */
#include "tests/sensor/error_scenes.h"

static const ErrorScene scenes[] = {
    {"ground, steep", 100, 200, 40, 0, false, 0},     {"ground from 100 m", 600, 100, 40, 0, false, 0},
    {"ground from 300 m", 1500, 300, 20, 0, false, 0}, {"ground, narrow", 900, 30, 3, 0, false, 0},
    {"vehicle at 30 m", 30, 6, 30, 1, false, 0},       {"vehicles at 60 m", 60, 12, 40, 6, false, 0},
    {"vehicles at 150 m", 150, 25, 30, 10, false, 0},  {"vehicles at 300 m", 300, 40, 20, 10, false, 0},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0},  {"small vehicles", 900, 100, 25, 20, false, 0},
    {"horizon", 300, 8, 30, 3, false, 3},              {"horizon, wide", 200, 30, 70, 5, false, 8},
    {"sky", 300, 20, 30, 0, false, 25},                {"smoke at 60 m", 60, 12, 40, 3, true, 0},
    {"smoke at 200 m", 200, 20, 20, 3, true, 0},
};
enum { scene_count = sizeof scenes / sizeof *scenes };

static void estimates_are_near_the_truth(void **state)
{
    (void)state;
    Tally rays = {0}, ground = {0}, sum = {0}, tables = {0};
    for (int k = 0; k < scene_count; k++) {
        judge_sampling(&rays, &scenes[k]);
        judge_ground(&ground, &scenes[k]);
        judge_sum(&sum, &scenes[k]);
        if (!scenes[k].smoke) judge_tables(&tables, &scenes[k]); /* what leaves a surface is not told from smoke */
    }
    const bool held[] = {nine_in_ten(&rays, "sampling"), nine_in_ten(&ground, "level of detail"),
                         nine_in_ten(&sum, "rays and posts"), nine_in_ten(&tables, "tables")};
    CHECK(held[0] && held[1] && held[2] && held[3]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(estimates_are_near_the_truth)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
