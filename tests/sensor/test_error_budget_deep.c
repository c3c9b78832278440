/* test_error_budget.c over more scenes, heat in those that are its own. labels: deep */
#include "tests/sensor/error_scenes.h"

static const ErrorScene scenes[] = {
    {"ground, steep", 100, 200, 40, 0, false, 0, false},
    {"ground from 100 m", 600, 100, 40, 0, false, 0, true},
    {"ground from 300 m", 1500, 300, 20, 0, false, 0, false},
    {"ground, narrow", 900, 30, 3, 0, false, 0, false},
    {"vehicle at 30 m", 30, 6, 30, 1, false, 0, false},
    {"vehicles at 60 m", 60, 12, 40, 6, false, 0, true},
    {"vehicles at 150 m", 150, 25, 30, 10, false, 0, false},
    {"vehicles at 300 m", 300, 40, 20, 10, false, 0, false},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0, true},
    {"small vehicles", 900, 100, 25, 20, false, 0, false},
    {"horizon", 300, 8, 30, 3, false, 3, true},
    {"horizon, wide", 200, 30, 70, 5, false, 8, false},
    {"sky", 300, 20, 30, 0, false, 25, false},
    {"smoke at 60 m", 60, 12, 40, 3, true, 0, false},
    {"smoke at 200 m", 200, 20, 20, 3, true, 0, false},
};
enum { scene_count = sizeof scenes / sizeof *scenes };

static void estimates_are_near_the_truth(void **state)
{
    (void)state;
    Tally rays = {0}, ground = {0}, sum = {0}, tables = {0}, heat = {0};
    int   heated = 0;
    for (int k = 0; k < scene_count; k++) {
        ErrorCase c;
        open_case(&c, &scenes[k]);
        judge_sampling(&rays, &c);
        judge_ground(&ground, &c);
        judge_sum(&sum, &c);
        if (!scenes[k].smoke) judge_tables(&tables, &c); /* what leaves a surface is not told from smoke */
        if (scenes[k].heat) judge_heat(&heat, &c, 150, heat_most_facets), heated++;
        close_case(&c);
    }
    const bool held[] = {nine_in_ten(&rays, "sampling"), nine_in_ten(&ground, "level of detail"),
                         nine_in_ten(&sum, "rays and posts"), nine_in_ten(&tables, "tables")};
    CHECK(held[0] && held[1] && held[2] && held[3]);
    for (int b = BAND_MWIR; b <= BAND_LWIR; b++)
        CHECK(heated == 4 && heat.cases[b] == heated && heat.held[b] == heated);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(estimates_are_near_the_truth)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
