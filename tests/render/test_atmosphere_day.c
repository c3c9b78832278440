/* An atmosphere's day against the atmosphere itself, asked one thing at a time: the plain form, whose own truth is
 * tests/render/test_atmosphere.c. Random paths, skies, suns and visibilities of both models, and the ends of all of
 * them. labels: physics */
#include "tests/check.h"

#include "render/air/atmosphere.h"

/* Both round some hundred times in a row of products and sums of positive numbers, and exp of up to 70 magnifies an ulp
 * of its argument: 100 * 70 * 1e-16. Measured 3e-13. */
static const double near = 1e-12;

static const char *const models[] = {"us1976", "midlat_summer"};
static const double      temps_k[] = {220, 260, 288.15, 300, 417, 1000, 2500};
enum { temps = sizeof temps_k / sizeof *temps_k, all_bands = (1 << AIR_BAND_COUNT) - 1, days = 12, paths = 120 };

static uint64_t drawn;
static double   dice(double low, double high) { return low + (high - low) * random_uniform(7, 1, 0, drawn++); }

static void same(double got, double want, const char *what, double least)
{
    if (!(fabs(got - want) <= near * fabs(want) + least)) fail_msg("%s: %.17g, want %.17g", what, got, want);
}

static AirPath random_path(void)
{
    AirPath p = {.observer_m = dice(0, 1) < 0.2 ? 0 : dice(0, 1) < 0.5 ? dice(0, 500) : dice(0, 22000)};
    p.target_m = dice(0, 1) < 0.2 ? p.observer_m : dice(0, 1) < 0.5 ? p.observer_m + dice(-0.9, 0.9) : dice(0, 22000);
    p.range_m = fabs(p.target_m - p.observer_m) + (dice(0, 1) < 0.1 ? 0 : pow(10, dice(-1, 5.3)));
    return p;
}

static void check_path(const AirDay *day, const Atmosphere *atmosphere, double visibility_m, double sun_rad)
{
    const AirPath path = random_path();
    double        azimuth[5] = {0, pi_rad, dice(0, pi_rad), dice(0, pi_rad), dice(0, 0.2)}, seen[5][AIR_BAND_COUNT],
           sun[AIR_BAND_COUNT];
    DayPath got;
    air_day_path(&got, day, &path);
    air_day_scattered(seen, sun, day, &path, azimuth, 5);
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        PathAir want;
        AirPath lit = path;
        lit.sun_zenith_rad = sun_rad;
        for (int a = 0; a < 5; a++) {
            lit.rel_azimuth_rad = azimuth[a];
            atmosphere_path(&want, atmosphere, visibility_m, b, &lit, 300);
            same(seen[a][b], want.scattered_w_m2_sr, "scattered", 1e-30);
        }
        same(exp(-got.sun[b]), want.sun_transmittance, "sun_transmittance", 1e-280);
        same(exp(-sun[b]), want.sun_transmittance, "sun_transmittance, scattered", 1e-280);
        for (int t = 0; t < temps && b >= AIR_MWIR; t++) {
            atmosphere_path(&want, atmosphere, visibility_m, b, &lit, temps_k[t]);
            same(exp(-got.emitted[b - AIR_MWIR][t]), want.transmittance, "transmittance", 1e-280);
            same(got.thermal_w_m2_sr[b - AIR_MWIR], want.thermal_w_m2_sr, "thermal", 1e-30);
        }
    }
}

static void check_sky(const AirDay *day, const Atmosphere *atmosphere, double visibility_m, double sun_rad)
{
    const double observer_m = dice(0, 1) < 0.3 ? 0 : dice(0, 25000),
                 zenith_rad = dice(0, 1) < 0.2 ? 0.5 * pi_rad : dice(0, 1.6);
    double azimuth[3] = {0, pi_rad, dice(0, pi_rad)}, seen[3][AIR_BAND_COUNT], thermal[2];
    air_day_sky(seen, thermal, day, observer_m, zenith_rad, azimuth, 3);
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++)
        for (int a = 0; a < 3; a++) {
            SkyAir want;
            atmosphere_sky(&want, atmosphere, visibility_m, b, observer_m, zenith_rad, sun_rad, azimuth[a]);
            same(seen[a][b], want.scattered_w_m2_sr, "sky, scattered", 1e-30);
            if (b >= AIR_MWIR) same(thermal[b - AIR_MWIR], want.thermal_w_m2_sr, "sky, thermal", 1e-30);
        }
}

static void a_day_answers_as_the_atmosphere_does(void **state)
{
    (void)state;
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        Atmosphere *atmosphere;
        Arena      *arena = arena_create();
        double      low_m, high_m;
        CHECK(arena && atmosphere_open(&atmosphere, models[m]) == STATUS_OK);
        atmosphere_visibilities(atmosphere, &low_m, &high_m);
        for (int d = 0; d < days; d++) {
            const double  ends_m[] = {low_m / 2, low_m, 5000, 23000, high_m, 2 * high_m};
            const double  visibility_m = d < 6 ? ends_m[d] : exp(dice(log(low_m), log(high_m)));
            const double  sun_rad = d == 0 ? 0 : d == 1 ? 0.5 * pi_rad : d == 2 ? 2 : dice(0, 1.5);
            const AirDay *day;
            arena_reset(arena);
            CHECK(air_day_at(&day, atmosphere, visibility_m, sun_rad, all_bands, temps_k, temps, arena) == STATUS_OK);
            for (int k = 0; k < paths; k++) {
                check_path(day, atmosphere, visibility_m, sun_rad);
                check_sky(day, atmosphere, visibility_m, sun_rad);
            }
        }
        atmosphere_close(atmosphere);
        arena_destroy(arena);
    }
}

/* Who asks for one band gets the bits of who asks for all. */
static void bands_do_not_depend_on_each_other(void **state)
{
    (void)state;
    Atmosphere   *atmosphere;
    Arena        *arena = arena_create();
    const AirDay *every, *one;
    CHECK(arena && atmosphere_open(&atmosphere, "us1976") == STATUS_OK);
    CHECK(air_day_at(&every, atmosphere, 15000, 0.7, all_bands, temps_k, temps, arena) == STATUS_OK);
    for (AirBand b = 0; b < AIR_BAND_COUNT; b++) {
        CHECK(air_day_at(&one, atmosphere, 15000, 0.7, 1u << b, temps_k, temps, arena) == STATUS_OK);
        for (int k = 0; k < 20; k++) {
            const AirPath path = random_path();
            const double  azimuth = dice(0, pi_rad);
            double all[1][AIR_BAND_COUNT], alone[1][AIR_BAND_COUNT], sun_all[AIR_BAND_COUNT], sun_alone[AIR_BAND_COUNT];
            air_day_scattered(all, sun_all, every, &path, &azimuth, 1);
            air_day_scattered(alone, sun_alone, one, &path, &azimuth, 1);
            CHECK(all[0][b] == alone[0][b] && sun_all[b] == sun_alone[b]);
        }
    }
    atmosphere_close(atmosphere);
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_day_answers_as_the_atmosphere_does),
        cmocka_unit_test(bands_do_not_depend_on_each_other),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
