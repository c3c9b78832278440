/* tests/render/test_radar_propagation.c: attenuation of radio waves by gases, rain, cloud and fog against values of
 * ITU-R's own validation, dispersion against causality, paths against closed forms and fine quadrature, the radar
 * equation by hand. labels: physics */
#include "tests/check.h"

#include "render/scattering/paths/attenuation.h"
#include "render/scattering/paths/radar_path.h"

static GasLines    lines;
static Atmosphere *us1976;

static int set_up(void **state)
{
    (void)state;
    return gas_lines_read(&lines, NULL, NULL) == STATUS_OK && atmosphere_open_at(&us1976, "us1976", 23000) == STATUS_OK
               ? 0
               : -1;
}

static int tear_down(void **state)
{
    (void)state;
    atmosphere_close(us1976);
    return 0;
}

static double number(const Table *table, int row, const char *name)
{
    double    value = NAN;
    const int column = table_column(table, name);
    CHECK(column >= 0 && table_number(&value, table, row, column, -1e9, 1e9) == STATUS_OK);
    return value;
}

/* A table of the reference data; false, said, when there is none. */
static bool reference(Table *table, const char *name)
{
    char path[512];
    if (!reference_path(path, name)) return false;
    CHECK(table_open(table, path) == STATUS_OK);
    return true;
}

static GasAttenuation gas(double f_ghz, double dry_hpa, double vapour_hpa, double temp_k)
{
    GasAttenuation out;
    gas_attenuation(&out, &lines, f_ghz, &(GasState){dry_hpa, vapour_hpa, temp_k});
    return out;
}

/* ---- gases --------------------------------------------------------------------------------------- */

/* ITU-R SG 3, validation examples for P.676-13: 1013.25 hPa, 288.15 K, 7.5 g/m3; printed to 15 digits. */
static const double official_gas[][3] = {
    {1, 0.00538865816790655, 5.09046173249644e-05}, {9, 0.00802346644646405, 0.00466095673594269},
    {23, 0.0138472778555002, 0.180441698099627},    {35, 0.0318430338643549, 0.0696142956245662},
    {61, 15.0071590859967, 0.159826896312118},      {95, 0.0338583895985994, 0.381834968591039},
    {119, 1.30637904078462, 0.617993479946656}};

static void gas_equals_official_values(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof official_gas / sizeof *official_gas; i++) {
        const GasAttenuation got = gas(official_gas[i][0], 1013.25, gas_vapour_hpa(7.5, 288.15), 288.15);
        CHECK_NEAR(got.dry_db_km / official_gas[i][1], 1, 1e-12);
        CHECK_NEAR(got.wet_db_km / official_gas[i][2], 1, 1e-12);
    }
}

static void gas_equals_official_table(void **state)
{
    (void)state;
    Table  table;
    double worst = 0;
    if (!reference(&table, "radar/itu/p676-13_specific_attenuation.csv")) skip();
    CHECK(table.rows == 175);
    for (int row = 0; row < table.rows; row++) {
        const double         temp_k = number(&table, row, "T_K");
        const GasAttenuation got = gas(number(&table, row, "f_GHz"), number(&table, row, "P_hPa"),
                                       gas_vapour_hpa(number(&table, row, "rho_g_m3"), temp_k), temp_k);
        const double         dry = got.dry_db_km / number(&table, row, "gamma_o_dB_km") - 1;
        const double         wet = got.wet_db_km / number(&table, row, "gamma_w_dB_km") - 1;
        CHECK_NEAR(dry, 0, 1e-12);
        CHECK_NEAR(wet, 0, 1e-12);
        worst = fmax(worst, fmax(fabs(dry), fabs(wet)));
    }
    table_close(&table);
    printf("P.676-13, 175 frequencies: worst relative difference %.1e\n", worst);
}

/* The lines as shipped with the validation data: the same figures in another layout. */
static void lines_equal_reference(void **state)
{
    (void)state;
    static const char *const coefficient[2][7] = {{"f0", "a1", "a2", "a3", "a4", "a5", "a6"},
                                                  {"f0", "b1", "b2", "b3", "b4", "b5", "b6"}};
    for (int k = 0; k < 2; k++) {
        Table              table;
        const GasLineList *list = k == 0 ? &lines.oxygen : &lines.water;
        if (!reference(&table,
                       k == 0 ? "radar/itu/p676-13_lines_oxygen.csv" : "radar/itu/p676-13_lines_water_vapour.csv"))
            skip();
        CHECK(table.rows == list->count);
        for (int row = 0; row < table.rows; row++)
            for (int c = 0; c < 7; c++)
                CHECK(number(&table, row, coefficient[k][c]) == (c == 0 ? list->f_ghz[row] : list->c[c - 1][row]));
        table_close(&table);
    }
}

/* Integral over u of f N''(u) / (u^2 - f^2), principal value: N''(f) is taken off, whose own principal value is closed.
 * The lines of oxygen are some 1 GHz wide at 1013 hPa: midpoints of 10 MHz. */
static double causal_ppm(double f_ghz, double low_ghz, double high_ghz, bool wet)
{
    static const double  step_ghz = 0.01;
    const double         e_hpa = wet ? 10 : 0;
    const GasAttenuation here = gas(f_ghz, 1013.25, e_hpa, 288.15);
    const double         n_here = (wet ? here.wet_db_km : here.dry_db_km) / (0.1820 * f_ghz);
    double               sum = 0;
    for (double u = low_ghz + 0.5 * step_ghz; u < high_ghz; u += step_ghz) {
        const GasAttenuation there = gas(u, 1013.25, e_hpa, 288.15);
        const double         n = (wet ? there.wet_db_km : there.dry_db_km) / (0.1820 * u);
        if (fabs(u - f_ghz) > 0.1 * step_ghz) sum += step_ghz * (u * n - f_ghz * n_here) / (u * u - f_ghz * f_ghz);
    }
    const double rest = 0.5 * log((high_ghz - f_ghz) * (f_ghz + low_ghz) / ((high_ghz + f_ghz) * (f_ghz - low_ghz)));
    return 2 / pi_rad * (sum + n_here * rest);
}

/* What lies outside 1 .. 1000 GHz changes slowly with frequency: differences of nearby frequencies are compared. It is
 * largest for water, whose lines beyond 1000 GHz add as f^2: the part in f^2 is taken from a third frequency. */
static void dispersion_is_causal(void **state)
{
    (void)state;
    double worst = 0, least = 0, most = 0, base_got = 0, base_want = 0;
    for (int i = 0; i <= 9; i++) { /* through the oxygen complex */
        const double f = 50.003 + 2.2 * i, got = gas(f, 1013.25, 0, 288.15).dry_ppm,
                     want = causal_ppm(f, 1, 1000, false);
        if (i == 0) base_got = got, base_want = want;
        worst = fmax(worst, fabs(got - base_got - (want - base_want)));
        least = fmin(least, got), most = fmax(most, got);
        CHECK_NEAR(got - base_got, want - base_want, 0.002);
    }
    CHECK(most - least > 0.5); /* there is something to compare */
    printf("dispersion, oxygen, 50 to 70 GHz: over %.2f ppm, within %.1e ppm of Kramers and Kronig\n", most - least,
           worst);

    static const double f[4] = {165.003, 181.003, 185.503, 200.003};
    double              got[4], want[4];
    for (int i = 0; i < 4; i++)
        got[i] = gas(f[i], 1013.25, 10, 288.15).wet_ppm, want[i] = causal_ppm(f[i], 1, 1000, true);
    const double square = (got[3] - got[0] - (want[3] - want[0])) / (f[3] * f[3] - f[0] * f[0]);
    for (int i = 1; i < 3; i++) {
        const double error = got[i] - got[0] - (want[i] - want[0]) - square * (f[i] * f[i] - f[0] * f[0]);
        CHECK_NEAR(error, 0, 0.002);
        printf("dispersion, water, %.1f GHz: %.3f ppm, within %.1e\n", f[i], got[i], fabs(error));
    }
    CHECK(got[1] - got[2] > 0.5);
}

static void gas_at_its_limits(void **state)
{
    (void)state;
    const double bad[][4] = {{0.99, 1013, 10, 288}, {1000.1, 1013, 10, 288}, {10, -1, 10, 288},    {10, 1201, 10, 288},
                             {10, 1013, -1, 288},   {10, 1013, 151, 288},    {10, 1013, 10, 149},  {10, 1013, 10, 351},
                             {NAN, 1013, 10, 288},  {10, NAN, 10, 288},      {10, 1013, NAN, 288}, {10, 1013, 10, NAN}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const GasAttenuation got = gas(bad[i][0], bad[i][1], bad[i][2], bad[i][3]);
        CHECK(isnan(got.dry_db_km) && isnan(got.wet_db_km) && isnan(got.dry_ppm) && isnan(got.wet_ppm));
    }
    const GasAttenuation none = gas(60, 0, 0, 200), dry = gas(183, 1013, 0, 288);
    CHECK(none.dry_db_km == 0 && none.wet_db_km == 0 && none.dry_ppm == 0 && none.wet_ppm == 0 && dry.wet_db_km == 0);
    for (double f = 1; f <= 1000; f += 0.37)
        for (int corner = 0; corner < 8; corner++) {
            const GasAttenuation got = gas(f, corner & 1 ? 1200 : 1, corner & 2 ? 150 : 0.1, corner & 4 ? 350 : 150);
            CHECK(got.dry_db_km > 0 && got.wet_db_km > 0 &&
                  isfinite(got.dry_db_km + got.wet_db_km + got.dry_ppm + got.wet_ppm));
        }
}

static void tables_of_lines_are_checked(void **state)
{
    (void)state;
    static const char *const head = "line_ghz,strength,strength_slope,width,width_exponent,coupling,coupling_slope\n";
    static const char *const rows[] = {"60,1,1,1,0,0\n",
                                       "60,1,1,1,0,0,x\n",
                                       "60,1,1,0,0,0,0\n",
                                       "60,1,1,1,0,0,0\n60,1,1,1,0,0,0\n",
                                       "61,1,1,1,0,0,0\n60,1,1,1,0,0,0\n",
                                       "60,nan,1,1,0,0,0\n",
                                       "0,1,1,1,0,0,0\n",
                                       ""};
    char                     text[512], path[text_file_size];
    GasLines                 kept = lines;
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i <= sizeof rows / sizeof *rows; i++) {
        const bool last = i == sizeof rows / sizeof *rows;
        snprintf(text, sizeof text, "%s%s", head, last ? "60,1,1,1,0,0,0\n62,1,1,1,0,0,0\n" : rows[i]);
        text_file(path, text);
        *check_said = 0;
        CHECK((gas_lines_read(&kept, path, NULL) == STATUS_OK) == last);
        CHECK(last || *check_said);
        CHECK(last ? kept.oxygen.count == 2 : memcmp(&kept, &lines, sizeof kept) == 0);
        CHECK(gas_lines_read(&kept, NULL, path) == STATUS_BAD_VALUE); /* oxygen's columns are not water's */
        kept = lines;
        remove(path);
    }
    log_set_sink(NULL, NULL);
}

/* ---- rain, cloud, fog ------------------------------------------------------------------------------ */

/* ITU-R SG 3, validation examples for P.838-3, at 14.25 GHz: elevation, rain, tilt; k, alpha, dB/km, to 8 decimals. */
static void rain_equals_official_examples(void **state)
{
    (void)state;
    static const double official[][6] = {{31.07699124, 26.48052, 0, 0.03975488, 1.12418043, 1.58130839},
                                         {40.232036, 33.936232, 0, 0.04007624, 1.11804138, 2.06173213},
                                         {46.35969261, 27.13586832, 0, 0.04030344, 1.11376017, 1.5920842},
                                         {22.27833468, 50.639304, 0, 0.03949319, 1.12925336, 3.32139638},
                                         {52.67898486, 78.2994993, 0, 0.04053522, 1.10944215, 5.11503463},
                                         {48.24117054, 63.62668149, 90, 0.04226474, 1.07871664, 3.72901264},
                                         {85.80459566, 99.13558978, 90, 0.04133039, 1.09499629, 6.34064598},
                                         {20.14335809, 42.91007183, 90, 0.04319835, 1.0631531, 2.35032323}};
    for (size_t i = 0; i < sizeof official / sizeof *official; i++) {
        double        k, alpha;
        const double *o = official[i], elevation_rad = o[0] * rad_per_deg, tilt_rad = o[2] * rad_per_deg;
        CHECK(rain_coefficients(&k, &alpha, 14.25, elevation_rad, tilt_rad));
        CHECK_NEAR(k, o[3], 0.5e-8 + 1e-15); /* half of the last digit */
        CHECK_NEAR(alpha, o[4], 0.5e-8 + 1e-15);
        CHECK_NEAR(rain_attenuation(14.25, o[1], elevation_rad, tilt_rad), o[5], 0.5e-8 + 1e-15);
        CHECK_NEAR(rain_attenuation(14.25, o[1], -elevation_rad, tilt_rad), o[5], 0.5e-8 + 1e-15);
    }
    CHECK(isnan(rain_attenuation(0.9, 1, 0, 0)) && isnan(rain_attenuation(1001, 1, 0, 0)) &&
          isnan(rain_attenuation(10, -1, 0, 0)) && isnan(rain_attenuation(10, 301, 0, 0)) &&
          isnan(rain_attenuation(10, 1, 1.6, 0)) && isnan(rain_attenuation(10, 1, 0, NAN)));
    CHECK(rain_attenuation(94, 0, 0, 0) == 0);
    /* seen from straight below there is no horizontal */
    CHECK_NEAR(rain_attenuation(94, 25, 0.5 * pi_rad, 0), rain_attenuation(94, 25, 0.5 * pi_rad, 0.5 * pi_rad), 1e-12);
}

static void rain_equals_table(void **state)
{
    (void)state;
    Table  table;
    double worst = 0;
    if (!reference(&table, "radar/itu/p838-3_itu-rpy.csv")) skip();
    CHECK(table.rows == 280);
    for (int row = 0; row < table.rows; row++) {
        double       k, alpha;
        const double f = number(&table, row, "f_GHz"), elevation_rad = number(&table, row, "el_deg") * rad_per_deg;
        const double tilt_rad = number(&table, row, "tau_deg") * rad_per_deg, rain = number(&table, row, "R_mm_h");
        CHECK(rain_coefficients(&k, &alpha, f, elevation_rad, tilt_rad));
        const double error[3] = {
            k / number(&table, row, "k") - 1, alpha / number(&table, row, "alpha") - 1,
            rain_attenuation(f, rain, elevation_rad, tilt_rad) / number(&table, row, "gammaR_dB_per_km") - 1};
        for (int i = 0; i < 3; i++) {
            CHECK_NEAR(error[i], 0, 6e-10); /* printed to ten digits, the first of which may be 1 */
            worst = fmax(worst, fabs(error[i]));
        }
    }
    table_close(&table);
    printf("P.838-3, 280 rows: worst relative difference %.1e\n", worst);
}

/* By hand, in 50 digits (Python's decimal) from P.840-9's equations: 94 GHz, 283.15 K. */
static void cloud_by_hand(void **state)
{
    (void)state;
    CHECK_NEAR(cloud_attenuation(94, 283.15), 4.2375474902349728, 1e-12);
    CHECK(isnan(cloud_attenuation(0.9, 283)) && isnan(cloud_attenuation(200.1, 283)) &&
          isnan(cloud_attenuation(94, 233.1)) && isnan(cloud_attenuation(94, 323.2)) &&
          isnan(cloud_attenuation(NAN, 283)) && isnan(cloud_attenuation(94, NAN)));
    for (double f = 1; f <= 200; f += 0.5)
        for (double t = 233.15; t <= 323.15; t += 0.5)
            CHECK(cloud_attenuation(f, t) > 0 && cloud_attenuation(f, t) < 50);
}

static void cloud_equals_table(void **state)
{
    (void)state;
    Table  table;
    double worst = 0;
    if (!reference(&table, "radar/itu/p840-9_Kl_itu-rpy.csv")) skip();
    CHECK(table.rows == 54);
    for (int row = 0; row < table.rows; row++) {
        const double got = cloud_attenuation(number(&table, row, "f_GHz"), number(&table, row, "T_C") + 273.15);
        const double error = got / number(&table, row, "Kl_dB_per_km_per_g_m3") - 1;
        CHECK_NEAR(error, 0, 6e-10);
        worst = fmax(worst, fabs(error));
    }
    table_close(&table);
    printf("P.840-9, 54 rows: worst relative difference %.1e\n", worst);
}

/* P.840: about 0.05 g/m3 in medium fog (visibility of the order of 300 m) and 0.5 g/m3 in thick fog (50 m). */
static void fog_holds_what_p840_says(void **state)
{
    (void)state;
    CHECK_NEAR(fog_liquid_g_m3(50), 0.5, 0.05);
    CHECK_NEAR(fog_liquid_g_m3(300), 0.05, 0.02);
    CHECK_NEAR(144.7 * pow(fog_liquid_g_m3(200), 0.88), 3.912023005428146 / 0.2, 1e-11); /* there and back: ln 50 */
    CHECK(fog_liquid_g_m3(1000.1) == 0 && fog_liquid_g_m3(INFINITY) == 0 && isnan(fog_liquid_g_m3(9)) &&
          isnan(fog_liquid_g_m3(NAN)));
}

/* ---- air and paths --------------------------------------------------------------------------------- */

static RadarAir air_of(double humidity, double temp_k)
{
    RadarAir air;
    Weather  weather = weather_default();
    weather.humidity = humidity, weather.air_temp_k = temp_k;
    CHECK(radar_air_of(&air, us1976, &weather) == STATUS_OK);
    return air;
}

/* US Standard Atmosphere 1976, NOAA-S/T 76-1562, Table I, by geometric height. The model's temperatures are those to
 * 0.1 K. */
static void pressure_is_the_standard_atmospheres(void **state)
{
    (void)state;
    static const double standard[][2] = {{1000, 898.76},  {2000, 795.01},  {5000, 540.48},
                                         {10000, 264.99}, {15000, 121.11}, {20000, 55.293}};
    const RadarAir      air = air_of(0, NAN);
    GasState            at;
    for (size_t i = 0; i < sizeof standard / sizeof *standard; i++) {
        radar_air_at(&at, &air, standard[i][0]);
        CHECK_NEAR(at.dry_hpa / standard[i][1], 1, 1e-3);
        CHECK(at.vapour_hpa == 0);
    }
    const RadarAir moist = air_of(0.6, 288.15);
    radar_air_at(&at, &moist, 0);
    CHECK_NEAR(at.dry_hpa + at.vapour_hpa, 1013.25, 1e-9);
    CHECK_NEAR(moist.vapour_g_m3, 0.6 * 12.83, 0.03); /* saturated at 15 C: 12.83 g/m3 (Smithsonian tables) */
    radar_air_at(&at, &moist, 2000);
    CHECK_NEAR(at.vapour_hpa / at.temp_k * 216.7, moist.vapour_g_m3 / exp(1), 1e-12);
    CHECK_NEAR(moist.rain_top_m, (288.15 - 273.15) / 6.5e-3 + 360, 30); /* 6.5 K/km */
    CHECK(air_of(0.5, 250).rain_top_m == 0);                            /* snow */
    Weather  bad = weather_default();
    RadarAir out;
    bad.rain_mm_h = 301;
    CHECK(radar_air_of(&out, us1976, &bad) == STATUS_BAD_VALUE);
    bad = weather_default(), bad.pressure_mbar = NAN;
    CHECK(radar_air_of(&out, us1976, &bad) == STATUS_BAD_VALUE);
    bad = weather_default(), bad.humidity = 1.1;
    CHECK(radar_air_of(&out, us1976, &bad) == STATUS_BAD_VALUE);
}

static RadarLoss loss_of(const RadarAir *air, double f_ghz, double a_m, double b_m, double range_m, int fine)
{
    RadarLoss loss;
    radar_path_loss_fine(&loss, &(RadarPath){a_m, b_m, range_m, f_ghz, 0}, &lines, air, fine);
    return loss;
}

/* Air that is saturated somewhere has a kink there. */
static void quadrature_is_close_to_a_fine_one(void **state)
{
    (void)state;
    static const double path[][3] = {{0, 0, 1000},         {0, 0, 50000},        {2, 100, 8000},
                                     {10, 3000, 10000},    {0, 20000, 20000},    {20000, 0, 40000},
                                     {5000, 5000, 300000}, {500, 12000, 150000}, {12000, 12000, 10}};
    static const double f[] = {5, 10, 22.2, 35, 60, 94, 140, 183}, bound[2] = {1e-5, 2e-4}, bound_rad[2] = {1e-4, 1e-3};
    for (int saturated = 0; saturated < 2; saturated++) {
        double   worst = 0, worst_rad = 0;
        RadarAir air = saturated ? air_of(0.95, 305) : air_of(0.6, 288.15);
        air.liquid[1] = (RadarLiquid){700, 2300, 0.4};
        for (size_t p = 0; p < sizeof path / sizeof *path; p++)
            for (size_t i = 0; i < sizeof f / sizeof *f; i++) {
                const RadarLoss got = loss_of(&air, f[i], path[p][0], path[p][1], path[p][2], 1);
                const RadarLoss want = loss_of(&air, f[i], path[p][0], path[p][1], path[p][2], 10);
                const double    error[3] = {got.dry_db / want.dry_db - 1, got.wet_db / want.wet_db - 1,
                                         want.liquid_db > 0 ? got.liquid_db / want.liquid_db - 1 : 0};
                for (int e = 0; e < 3; e++) {
                    CHECK_NEAR(error[e], 0, bound[saturated]);
                    worst = fmax(worst, fabs(error[e]));
                }
                CHECK_NEAR(got.dispersion_rad, want.dispersion_rad,
                           bound_rad[saturated] + bound[saturated] * fabs(want.dispersion_rad));
                worst_rad = fmax(worst_rad, fabs(got.dispersion_rad - want.dispersion_rad));
                /* the way back is the way out */
                const RadarLoss back = loss_of(&air, f[i], path[p][1], path[p][0], path[p][2], 1);
                CHECK_NEAR(radar_loss_db(&back) / radar_loss_db(&got), 1, 1e-9);
            }
        printf("paths, %s air: within %.1e and %.1e rad of a fine quadrature\n", saturated ? "saturated" : "usual",
               worst, worst_rad);
    }
}

/* Where everything is even the integral is a product: a short level path; and lengths below a height are those of the
 * round Earth. */
static void paths_in_closed_form(void **state)
{
    (void)state;
    RadarAir air = air_of(0.6, 288.15);
    GasState at;
    radar_air_at(&at, &air, 0);
    const GasAttenuation near = gas(94, at.dry_hpa, at.vapour_hpa, at.temp_k);
    RadarLoss            loss = loss_of(&air, 94, 0, 0, 1000, 1);
    CHECK_NEAR(loss.dry_db + loss.wet_db, near.dry_db_km + near.wet_db_km, 1e-5);
    CHECK_NEAR(loss.dispersion_rad, 2 * pi_rad * 94e9 / 299792458.0 * 1e-6 * (near.dry_ppm + near.wet_ppm) * 1000,
               1e-4);
    CHECK(loss.rain_db == 0 && loss.liquid_db == 0);

    /* rain over a straight vertical path: to its top and no farther; slant: by the sine */
    air.rain_mm_h = 25, air.rain_top_m = 2000;
    CHECK_NEAR(loss_of(&air, 35, 500, 9000, 0, 1).rain_db, 1.5 * rain_attenuation(35, 25, 0.5 * pi_rad, 0), 1e-9);
    CHECK_NEAR(loss_of(&air, 35, 0, 4000, 8000, 1).rain_db / (4 * rain_attenuation(35, 25, pi_rad / 6, 0)), 1, 1e-3);
    CHECK(loss_of(&air, 35, 2001, 9000, 20000, 1).rain_db == 0);
    /* between two aircraft above it the line dips into it: half chord sqrt(2 R (h - top)) each side of the middle */
    const double range_m = 2 * sqrt(2 * 6371e3 * 1000); /* from 3 km, 1 km of sag: touches 2 km in the middle */
    CHECK_NEAR(loss_of(&air, 35, 3000, 3000, range_m - 100, 1).rain_db, 0, 1e-9);
    const double dip_km = 1e-3 * 2 * sqrt(0.25 * 300e3 * 300e3 - 2 * 6373e3 * 1000); /* R and heights: (R + 2.5 km) */
    CHECK_NEAR(loss_of(&air, 35, 3000, 3000, 300e3, 1).rain_db / (dip_km * rain_attenuation(35, 25, 0, 0)), 1, 1e-3);

    /* a thin cloud straight above; and none where it is ice */
    air.rain_mm_h = 0;
    air.liquid[1] = (RadarLiquid){1000, 1010, 0.5};
    radar_air_at(&at, &air, 1005);
    CHECK_NEAR(loss_of(&air, 94, 0, 5000, 5000, 1).liquid_db, 0.010 * 0.5 * cloud_attenuation(94, at.temp_k), 1e-7);
    /* slant: the sine there is less than half by the round Earth's turn over the 3 km to the middle of the path */
    const double sine = 0.5 - 0.75 * 3000 / 6371e3;
    CHECK_NEAR(loss_of(&air, 94, 0, 5000, 10000, 1).liquid_db, 0.010 / sine * 0.5 * cloud_attenuation(94, at.temp_k),
               1e-6);
    CHECK(isnan(loss_of(&air, 250, 0, 5000, 5000, 1).liquid_db) && !isnan(loss_of(&air, 250, 0, 5000, 5000, 1).dry_db));
    /* fog without a top: the whole path */
    air.liquid[1] = (RadarLiquid){0, INFINITY, 0.1};
    radar_air_at(&at, &air, 0);
    CHECK_NEAR(loss_of(&air, 94, 2, 2, 3000, 1).liquid_db, 3 * 0.1 * cloud_attenuation(94, at.temp_k), 1e-3);
    air.liquid[1] = (RadarLiquid){9000, 10000, 0.5};
    CHECK(loss_of(&air, 94, 0, 12000, 12000, 1).liquid_db == 0);
    CHECK(loss_of(&air, 250, 0, 5000, 5000, 1).liquid_db == 0);
    CHECK(radar_loss_db(&(RadarLoss){0}) == 0 && loss_of(&air, 94, 0, 0, 0, 1).dry_db == 0);
    CHECK(isnan(loss_of(&air, 94, -1, 0, 10, 1).dry_db) && isnan(loss_of(&air, 94, 0, 20001, 10, 1).dry_db) &&
          isnan(loss_of(&air, 0.5, 0, 0, 10, 1).dry_db) && isnan(loss_of(&air, 94, 0, 0, NAN, 1).dry_db) &&
          isnan(loss_of(&air, 94, 0, 0, 2e6, 1).rain_db));
}

/* 94 GHz, 10 km and back at sea level, 15 C, 7.5 g/m3: 20 km of P.676-13's 0.40813 dB/km (its value at 1013.25 hPa of
 * dry air). */
static void two_ways_at_sea_level(void **state)
{
    (void)state;
    RadarAir air = air_of(0.6, 288.15);
    for (int i = 0; i < radar_air_levels; i++) air.ln_hpa[i] = log(1013.25 + 9.97279); /* even air: dry and vapour */
    for (int i = 0; i < radar_air_levels; i++) air.temp_k[i] = 288.15;
    air.vapour_g_m3 = 7.5;
    const RadarLoss      loss = loss_of(&air, 94, 0, 0, 10000, 1);
    const double complex factor = radar_path_factor(&loss);
    CHECK_NEAR(2 * radar_loss_db(&loss), 20 * 0.40813, 1e-3);
    CHECK_NEAR(20 * log10(cabs(factor)), -2 * radar_loss_db(&loss), 1e-12);
    CHECK_NEAR(carg(factor * cexp(CMPLX(0, 2 * loss.dispersion_rad))), 0, 1e-12);
}

/* ---- radar equation -------------------------------------------------------------------------------- */

/* By hand: 10 W, 40 dB, 94 GHz, 10 m2 at 3 km: lambda = 299792458 / 94e9 = 3.18928147e-3 m;
 * 10 x 1e4 x 1e4 x 1.01715163e-5 x 10 / (1984.40171 x 8.1e13) = 6.32808e-13 W. Noise: 1.380649e-23 x 290 x 1e8 x
 * 10^0.6. */
static void radar_equation_by_hand(void **state)
{
    (void)state;
    const RadarLink link = {10, 1e4, 1e4, 299792458.0 / 94e9, 3000, 1};
    const double    received_w = radar_received_w(&link, 10), noise_w = radar_noise_w(1e8, pow(10, 0.6));
    CHECK_NEAR(received_w / 6.32808e-13, 1, 1e-5);
    CHECK_NEAR(noise_w / 1.593970e-12, 1, 1e-5);
    RadarLink lossy = link, far = link;
    lossy.loss = 2, far.range_m = 6000;
    CHECK_NEAR(radar_received_w(&lossy, 10) / received_w, 0.5, 1e-15);
    CHECK_NEAR(radar_received_w(&far, 10) / received_w, 1.0 / 16, 1e-15);

    const double complex s = sqrt(10 / (4 * pi_rad)) * cexp(CMPLX(0, 0.7)), v = radar_voltage(&link, s, 1);
    CHECK_NEAR(creal(v * conj(v)) / received_w, 1, 1e-14);
    /* a quarter of a wave farther: half a turn of phase */
    far = link, far.range_m += 0.25 * link.wavelength_m;
    CHECK_NEAR(fabs(carg(radar_voltage(&far, s, 1) / v)), pi_rad, 1e-8);
    /* the air: its dB off the power */
    const RadarLoss loss = {.dry_db = 1.5};
    CHECK_NEAR(20 * log10(cabs(radar_voltage(&link, s, radar_path_factor(&loss)) / v)), -3, 1e-12);
    lossy.loss = 0.5;
    CHECK(isnan(radar_received_w(&lossy, 10)) && isnan(radar_received_w(&link, -1)) &&
          isnan(creal(radar_voltage(&lossy, s, 1))));
    CHECK(isnan(radar_noise_w(0, 1)) && isnan(radar_noise_w(1, 0.9)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gas_equals_official_values),
        cmocka_unit_test(gas_equals_official_table),
        cmocka_unit_test(lines_equal_reference),
        cmocka_unit_test(dispersion_is_causal),
        cmocka_unit_test(gas_at_its_limits),
        cmocka_unit_test(tables_of_lines_are_checked),
        cmocka_unit_test(rain_equals_official_examples),
        cmocka_unit_test(rain_equals_table),
        cmocka_unit_test(cloud_by_hand),
        cmocka_unit_test(cloud_equals_table),
        cmocka_unit_test(fog_holds_what_p840_says),
        cmocka_unit_test(pressure_is_the_standard_atmospheres),
        cmocka_unit_test(quadrature_is_close_to_a_fine_one),
        cmocka_unit_test(paths_in_closed_form),
        cmocka_unit_test(two_ways_at_sea_level),
        cmocka_unit_test(radar_equation_by_hand),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
