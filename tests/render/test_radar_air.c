/* The air that a radar's waves pass, at a height: between levels by hand, vapour that fades and is at most saturated,
 * heights held to 0 and 20 km. labels: physics */
#include "tests/check.h"

#include "render/scattering/paths/radar_path.h"

static RadarAir air;

/* 6.5 K less a kilometre, pressure falling by 1.2 % a level of 100 m. */
static void fill(double ground_k, double k_per_level)
{
    air = (RadarAir){0};
    for (int i = 0; i < radar_air_levels; i++) {
        air.temp_k[i] = ground_k - k_per_level * i;
        air.ln_hpa[i] = log(1000) - 0.012 * i;
    }
}

static void between_levels(void **state)
{
    (void)state;
    static const double height_m[] = {0, 25, 100, 1234, 19999, 20000};
    fill(300, 0.65);
    for (int i = 0; i < 6; i++) {
        GasState s;
        radar_air_at(&s, &air, height_m[i]);
        CHECK_NEAR(s.temp_k, 300 - 0.0065 * height_m[i], 1e-9);
        CHECK_NEAR(s.dry_hpa, 1000 * exp(-0.00012 * height_m[i]), 1e-9);
        CHECK(s.vapour_hpa == 0);
    }
    static const double beyond[][2] = {{-50, 0}, {30000, 20000}};
    for (int i = 0; i < 2; i++) {
        GasState s, at;
        radar_air_at(&s, &air, beyond[i][0]);
        radar_air_at(&at, &air, beyond[i][1]);
        CHECK(s.temp_k == at.temp_k && s.dry_hpa == at.dry_hpa);
    }
}

/* 5 g/m3 at the ground and 5 exp(-h / 2 km) above it are e = rho T / 216.7 hPa (ITU-R P.453); of more than saturation
 * what is left is 23.39 hPa at 20 C and 6.11 hPa at 0 C (CRC Handbook), and dry air is the rest. */
static void vapour_fades_and_saturates(void **state)
{
    (void)state;
    GasState s;
    fill(293.15, 0);
    air.vapour_g_m3 = 5;
    for (int h = 0; h <= 6000; h += 1500) {
        radar_air_at(&s, &air, h);
        CHECK_NEAR(s.vapour_hpa, 5 * exp(-h / 2000.0) * 293.15 / 216.7, 1e-3);
        CHECK_NEAR(s.dry_hpa + s.vapour_hpa, 1000 * exp(-0.00012 * h), 1e-9);
    }
    air.vapour_g_m3 = 60;
    radar_air_at(&s, &air, 0);
    CHECK_NEAR(s.vapour_hpa, 23.39, 0.15);
    CHECK_NEAR(s.dry_hpa + s.vapour_hpa, 1000, 1e-9);
    fill(273.15, 0);
    air.vapour_g_m3 = 60;
    radar_air_at(&s, &air, 0);
    CHECK_NEAR(s.vapour_hpa, 6.11, 0.04);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(between_levels),
        cmocka_unit_test(vapour_fades_and_saturates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
