/* The estimate of a cross section's error against what a finer grid, at the very look, makes of it: models and a
 * frequency that the estimate's constant was not fitted to. Higher frequencies: test_signature_error_deep.c. labels:
 * slow */
#include "tests/render/signature_cases.h"

static void estimates_are_within_a_factor_of_two(void **state)
{
    (void)state;
    static const Case cases[] = {{"helicopter", 6, false}, {"truck", 6, false}};
    judge_estimates(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(estimates_are_within_a_factor_of_two)};
    return cmocka_run_group_tests(tests, begin, end);
}
