/* test_signature_error.c at higher frequencies, and where the constant was fitted. labels: deep */
#include "tests/render/signature_cases.h"

static void estimates_are_within_a_factor_of_two(void **state)
{
    (void)state;
    static const Case cases[] = {{"tank", 10, true}, {"truck", 16.5, false}};
    judge_estimates(cases, sizeof cases / sizeof *cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(estimates_are_within_a_factor_of_two)};
    return cmocka_run_group_tests(tests, begin, end);
}
