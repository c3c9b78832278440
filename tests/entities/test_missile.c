/* Rows of missiles: those of etc/ are read whole; what columns mean together is refused with its row. */
#include "tests/entities/flight_fixture.h"

static void a_row_is_read_in_units_of_the_program(void **state)
{
    (void)state;
    Missile m;
    row_of_etc(&m, "sam_ir");
    assert_string_equal(missile_guidance_name(m.guidance), "augmented");
    CHECK_NEAR(m.area_m2, 0.0038484510006474966, 1e-15); /* pi / 4 (70 mm)^2 */
    CHECK_NEAR(m.most_attack_rad, 0.31415926535897931, 1e-15);
    CHECK_NEAR(m.most_lateral_mps2, 22 * 9.80665, 1e-12);
    CHECK_NEAR(m.gimbal_rate_rps, 1.0471975511965976, 1e-15);
    CHECK_NEAR(missile_mass_kg(&m, 0), 10.1, 0);
    CHECK_NEAR(missile_mass_kg(&m, 0.3 + 0.85), 10.1 - 0.95, 1e-12);
    CHECK_NEAR(missile_mass_kg(&m, 1000), 7, 1e-12);
    CHECK_NEAR(missile_thrust_n(&m, 0.299), 0, 0);
    CHECK_NEAR(missile_thrust_n(&m, 0.3), 2600, 0);
    CHECK_NEAR(missile_thrust_n(&m, 2.001), 920, 0);
    CHECK_NEAR(missile_thrust_n(&m, 5.001), 0, 0);
}

/* The table of etc/ with one cell changed is refused, and the message says why. */
static void refuse(const char *row, const char *column, const char *value, const char *said)
{
    char copy[text_file_size];
    missiles_but(copy, row, column, value);
    Missile m[16];
    int     count;
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    CHECK(missile_read_all(m, 16, &count, copy) == STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    if (!strstr(check_said, said) || !strstr(check_said, copy))
        fail_msg("%s = %s: said: %s", column, value, check_said);
    remove(copy);
}

static void what_columns_mean_together_is_checked(void **state)
{
    (void)state;
    refuse("sam_ir", "boost_s", "1.7005", "whole milliseconds");
    refuse("sam_ir", "ignite_s", "0.00015", "whole milliseconds");
    refuse("sam_ir", "boost_s", "0", "above 0, for a motor");
    refuse("sam_ir", "boost_kg", "9.5", "up to 0.9 of mass_kg");
    refuse("sam_ir", "mass_kg", "3.2", "a tenth more");
    refuse("sam_ir", "damping", "0.05", "first order");
    refuse("sam_ir", "gimbal_deg", "0", "has a seeker");
    refuse("at_loft", "dive_deg", "0", "dive_deg");
    refuse("sam_ir", "guidance", "luck", "pn, augmented, pursuit, command, loft");
    refuse("sam_ir", "name", "a_name_of_more_than_thirty_one_letters", "1 .. 31 letters");
}

static void an_unknown_name_is_said_with_the_nearest(void **state)
{
    (void)state;
    char    path[1024];
    Missile m = {.mass_kg = -1};
    CHECK(etc_path(path, sizeof path, "missiles.csv"));
    log_set_sink(check_listen, NULL);
    CHECK(missile_read(&m, path, "sam_it") == STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    CHECK(strstr(check_said, "sam_ir") && m.mass_kg == -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_is_read_in_units_of_the_program),
        cmocka_unit_test(what_columns_mean_together_is_checked),
        cmocka_unit_test(an_unknown_name_is_said_with_the_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
