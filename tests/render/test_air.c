/* The air against LOWTRAN's tables, where they are, and against what must hold anywhere. */
#include "tests/check.h"
#include "render/air.h"

static PlanckTable *mwir, *lwir;

static int open_tables(void **state)
{
    (void)state;
    return planck_table_create(&mwir, 3.4e-6, 4.8e-6) != STATUS_OK ||
           planck_table_create(&lwir, 8e-6, 12e-6) != STATUS_OK;
}

static int close_tables(void **state)
{
    (void)state;
    planck_table_destroy(mwir);
    planck_table_destroy(lwir);
    return 0;
}

static Sun sun_at_elevation(double elevation_deg)
{
    const double e = elevation_deg * rad_per_deg, azimuth = 2.1;
    return (Sun){.azimuth_rad = azimuth, .elevation_rad = e, .distance_au = 1,
                 .d_enu = {cos(e) * sin(azimuth), cos(e) * cos(azimuth), sin(e)}};
}

static Air air_of(const Weather *weather, double elevation_deg)
{
    const Sun sun = sun_at_elevation(elevation_deg);
    Air air;
    air_at(&air, weather, &sun, mwir, lwir);
    return air;
}

/* The six atmospheres: air temperature and water vapour at the ground, as LOWTRAN 7 tabulates them. */
typedef struct Atmosphere {
    const char *name;
    double temp_k, vapour_g_m3;
} Atmosphere;
static const Atmosphere atmospheres[] = {
    {"tropical", 299.7, 19.0}, {"midlat_summer", 294.2, 14.0}, {"midlat_winter", 272.2, 3.5},
    {"subarctic_summer", 287.2, 9.1}, {"subarctic_winter", 257.2, 1.2}, {"us1976", 288.15, 5.9},
};

static Weather weather_of(const Atmosphere *atmosphere, double visibility_km)
{
    Weather weather = weather_default();
    weather.visibility_m = visibility_km * 1e3;
    weather.air_temp_k   = atmosphere->temp_k;
    const double t_c = atmosphere->temp_k - 273.15;
    const double saturated_hpa = 6.1094 * exp(17.625 * t_c / (t_c + 243.04));
    weather.relative_humidity = atmosphere->vapour_g_m3 * atmosphere->temp_k / 216.7 / saturated_hpa;
    return weather;
}

/* ---- reading the tables: plain commas, no quotes ---- */

enum { row_columns = 16 };
typedef struct Reader {
    FILE *file;
    char  line[1024], *cell[row_columns];
} Reader;

static bool reader_next(Reader *r)
{
    if (!fgets(r->line, sizeof r->line, r->file)) return false;
    r->line[strcspn(r->line, "\r\n")] = 0;
    char *at = r->line;
    for (int i = 0; i < row_columns; i++) {
        r->cell[i] = at;
        at += strcspn(at, ",");
        if (*at) *at++ = 0;
    }
    return true;
}

static bool reader_open(Reader *r, const char *name)
{
    char path[512];
    if (!reference_path(path, name)) return false;
    r->file = fopen(path, "r");
    return r->file && reader_next(r);
}

static int channel_of(const char *band)
{
    static const char *const names[optical_channel_count] = {"B", "G", "R", "PAN"};
    for (int c = 0; c < optical_channel_count; c++)
        if (strcmp(names[c], band) == 0) return c;
    return -1;
}

static const Atmosphere *atmosphere_of(const char *name)
{
    for (size_t i = 0; i < sizeof atmospheres / sizeof *atmospheres; i++)
        if (strcmp(atmospheres[i].name, name) == 0) return &atmospheres[i];
    fail_msg("atmosphere %s", name);
    return NULL;
}

static double worse(double worst, double got, double want) { return fmax(worst, fabs(got / want - 1)); }

static void sun_follows_the_tables(void **state)
{
    (void)state;
    Reader r;
    if (!reader_open(&r, "atmosphere/sun_irradiance.csv")) skip();
    double pan70 = 0, direct70 = 0, direct80 = 0, diffuse80 = 0, total80 = 0, mwir80 = 0, scattered80 = 0;
    int rows = 0;
    while (reader_next(&r)) {
        const Atmosphere *atmosphere = atmosphere_of(r.cell[0]);
        const double zenith_deg = atof(r.cell[3]), direct = atof(r.cell[6]), total = atof(r.cell[7]);
        const int channel = channel_of(r.cell[4]);
        if (atof(r.cell[2]) != 0 || zenith_deg > 80.5) continue;
        const Weather weather = weather_of(atmosphere, atof(r.cell[1]));
        const Air air = air_of(&weather, 90 - zenith_deg);
        if (strcmp(r.cell[4], "MWIR3448") == 0) {
            mwir80 = worse(mwir80, air.sun_mwir_w_m2, direct);
            /* what the sun adds to the sky, which is even in this model */
            const Air night = air_of(&weather, -30);
            const double scattered = pi_rad * (air_sky_mwir(&air, 1) - air_sky_mwir(&night, 1));
            const double want = total - cos(zenith_deg * rad_per_deg) * direct;
            scattered80 = fmax(scattered80, fabs(log(scattered / want)));
        }
        if (channel < 0 || (strcmp(r.cell[0], "us1976") != 0 && strcmp(r.cell[0], "midlat_summer") != 0)) continue;
        rows++;
        const double up = cos(zenith_deg * rad_per_deg);
        direct80  = worse(direct80, air.sun_w_m2[channel], direct);
        diffuse80 = worse(diffuse80, air.sky_w_m2[channel], total - up * direct);
        total80   = worse(total80, air.sun_w_m2[channel] * up + air.sky_w_m2[channel], total);
        if (zenith_deg > 70.5) continue;
        direct70 = worse(direct70, air.sun_w_m2[channel], direct);
        if (channel == optical_channel_pan) pan70 = worse(pan70, air.sun_w_m2[channel], direct);
    }
    fclose(r.file);
    print_message("direct: PAN %.3f, all %.3f to 70 deg, %.3f to 80; diffuse %.3f, total %.3f; MWIR %.3f, "
                  "scattered %.2f (ln)\n", pan70, direct70, direct80, diffuse80, total80, mwir80, scattered80);
    CHECK(rows == 96);
    CHECK(pan70 < 0.012 && direct70 < 0.04 && direct80 < 0.08 && diffuse80 < 0.042 && total80 < 0.042);
    CHECK(mwir80 < 0.08 && scattered80 < 0.5);
}

static void pins(void **state)
{
    (void)state;
    /* LOWTRAN 7, US standard, 23 km, sun at zenith 40 degrees, PAN; 5 km along the ground */
    const Weather weather = weather_of(&atmospheres[5], 23);
    const Air air = air_of(&weather, 50);
    CHECK_NEAR(air.sun_w_m2[optical_channel_pan] / 282.10, 1, 0.01);
    const double total = air.sun_w_m2[optical_channel_pan] * sin(50 * rad_per_deg) + air.sky_w_m2[optical_channel_pan];
    CHECK_NEAR(total / 344.865, 1, 0.01);
    CHECK_NEAR(air_veil_optical(&air, optical_channel_pan, 5000).transmittance, 0.406126, 0.012);
    CHECK_NEAR(air_veil_lwir(&air, 5000).transmittance, 0.625655, 0.016);
    CHECK_NEAR(air_veil_lwir(&air, 5000).added_w_m2_sr / 11.7559, 1, 0.05);
    /* the kilometre that contrast survives: 2 % over one visibility, in the green */
    CHECK_NEAR(air_veil_optical(&air, optical_channel_g, 23000).transmittance, 0.02, 0.004);
}

static void paths_follow_the_tables(void **state)
{
    (void)state;
    Reader r;
    if (!reader_open(&r, "atmosphere/horizontal.csv")) skip();
    double visible = 0, mid = 0, far = 0, path_mid = 0, path_far = 0;
    int rows = 0;
    while (reader_next(&r)) {
        if (atof(r.cell[2]) != 0) continue;
        const Weather weather = weather_of(atmosphere_of(r.cell[0]), atof(r.cell[1]));
        const Air air = air_of(&weather, 40);
        const double range_m = atof(r.cell[3]) * 1e3;
        const int channel = channel_of(r.cell[4]);
        if (channel >= 0) {
            visible = fmax(visible, fabs(air_veil_optical(&air, channel, range_m).transmittance - atof(r.cell[10])));
            rows++;
        } else if (strcmp(r.cell[4], "MWIR3448") == 0 || strcmp(r.cell[4], "LWIR812") == 0) {
            const bool is_mid = r.cell[4][0] == 'M';
            const Veil veil = is_mid ? air_veil_mwir(&air, range_m) : air_veil_lwir(&air, range_m);
            const double error = fabs(veil.transmittance - atof(r.cell[7]));
            /* path radiance as a share of what an endless path would give */
            const double path = fabs(veil.added_w_m2_sr - atof(r.cell[11])) /
                                (is_mid ? air.air_mwir_w_m2_sr : air.air_lwir_w_m2_sr);
            if (is_mid) mid = fmax(mid, error), path_mid = fmax(path_mid, path);
            else far = fmax(far, error), path_far = fmax(path_far, path);
            rows++;
        }
    }
    fclose(r.file);
    print_message("transmittance 0.1 .. 20 km, worst: visible %.3f, MWIR %.4f, LWIR %.4f; path %.4f, %.4f\n", visible,
                  mid, far, path_mid, path_far);
    CHECK(rows == 6 * 2 * 8 * 6);
    CHECK(visible < 0.025 && mid < 0.0195 && far < 0.0165);
    CHECK(path_mid < 0.04 && path_far < 0.04);
}

static void thermal_sky_follows_the_tables(void **state)
{
    (void)state;
    Reader r;
    if (!reader_open(&r, "atmosphere/sky_thermal.csv")) skip();
    double mid = 0, far = 0, mid_all = 0, far_all = 0;
    int rows = 0;
    while (reader_next(&r)) {
        if (atof(r.cell[2]) != 0) continue;
        const bool is_mid = strcmp(r.cell[4], "MWIR3448") == 0;
        if (!is_mid && strcmp(r.cell[4], "LWIR812") != 0) continue;
        const Weather weather = weather_of(atmosphere_of(r.cell[0]), atof(r.cell[1]));
        const Air air = air_of(&weather, -30); /* no scattered sun: the table's column is thermal */
        const double up = cos(atof(r.cell[3]) * rad_per_deg), want = atof(r.cell[11]);
        const double got = is_mid ? air_sky_mwir(&air, up) : air_sky_lwir(&air, up);
        const bool common = strcmp(r.cell[0], "us1976") == 0 || strcmp(r.cell[0], "midlat_summer") == 0;
        rows++;
        if (is_mid) mid_all = worse(mid_all, got, want);
        else far_all = worse(far_all, got, want);
        if (!common) continue;
        if (is_mid) mid = worse(mid, got, want);
        else far = worse(far, got, want);
    }
    fclose(r.file);
    print_message("thermal sky: MWIR %.3f, LWIR %.3f; all six: %.3f, %.3f\n", mid, far, mid_all, far_all);
    CHECK(rows == 6 * 2 * 2 * 8);
    CHECK(mid < 0.075 && far < 0.045 && mid_all < 0.1 && far_all < 0.105);
}

static void longwave_follows_the_tables(void **state)
{
    (void)state;
    Reader r;
    if (!reader_open(&r, "atmosphere/sky_longwave_irradiance.csv")) skip();
    double worst = 0;
    while (reader_next(&r)) {
        const Weather weather = weather_of(atmosphere_of(r.cell[0]), 23);
        if (atof(r.cell[1]) != 23) continue; /* Brunt's formula knows no aerosol */
        const Air air = air_of(&weather, 40);
        const double black = 5.670374419184429e-8 * pow(weather.air_temp_k, 4);
        worst = worse(worst, black - air.longwave_loss_w_m2, atof(r.cell[2]));
    }
    fclose(r.file);
    print_message("longwave from the sky: %.3f\n", worst);
    CHECK(worst > 0 && worst < 0.045);
}

static void sky_follows_the_tables(void **state)
{
    (void)state;
    Reader r;
    if (!reader_open(&r, "atmosphere/sky_solar.csv")) skip();
    double sum = 0, worst = 0;
    int n = 0;
    while (reader_next(&r)) {
        const int channel = channel_of(r.cell[6]);
        if (channel < 0 || strcmp(r.cell[0], "us1976") != 0 || atof(r.cell[2]) != 0) continue;
        const Weather weather = weather_of(&atmospheres[5], atof(r.cell[1]));
        const Sun sun = sun_at_elevation(90 - atof(r.cell[4]));
        Air air;
        air_at(&air, &weather, &sun, mwir, lwir);
        const double zenith = atof(r.cell[3]) * rad_per_deg, azimuth = sun.azimuth_rad + atof(r.cell[5]) * rad_per_deg;
        const double d_enu[3] = {sin(zenith) * sin(azimuth), sin(zenith) * cos(azimuth), cos(zenith)};
        if (v3_dot(d_enu, sun.d_enu) > 0.97) continue; /* the aureole: too faint in the model, and it says so */
        const double error = log(air_sky_optical(&air, channel, d_enu) / atof(r.cell[7]));
        sum += error * error;
        worst = fmax(worst, fabs(error));
        n++;
    }
    fclose(r.file);
    print_message("sky radiance, %d directions: rms %.3f, worst %.3f (ln)\n", n, sqrt(sum / n), worst);
    CHECK(n > 150);
    CHECK(sqrt(sum / n) < 0.16 && worst < 0.65);
}

/* The sky's radiance adds up to the sky's irradiance, whatever the sun and haze. */
static void sky_adds_up(void **state)
{
    (void)state;
    static const double elevations_deg[] = {-15, -3, 0, 4, 20, 50, 88}, visibilities_m[] = {300, 5000, 23000, 3e5};
    for (int e = 0; e < 7; e++)
        for (int v = 0; v < 4; v++) {
            Weather weather = weather_default();
            weather.visibility_m = visibilities_m[v];
            const Air air = air_of(&weather, elevations_deg[e]);
            const int heights = 400, azimuths = 120;
            for (int c = 0; c < optical_channel_count; c += 3) {
                double sum = 0, level = 0;
                for (int h = 0; h < heights; h++) {
                    /* midpoints in elevation; the kink of air mass at the horizon limits this to 1e-5 */
                    const double e_rad = (h + 0.5) / heights * 0.5 * pi_rad, up = sin(e_rad), flat = cos(e_rad);
                    for (int a = 0; a < azimuths; a++) {
                        const double azimuth = (a + 0.5) * 2 * pi_rad / azimuths;
                        const double d_enu[3] = {flat * sin(azimuth), flat * cos(azimuth), up};
                        sum += air_sky_optical(&air, c, d_enu) * up * flat * pi_rad * pi_rad / heights / azimuths;
                    }
                }
                CHECK(air.sky_w_m2[c] > 0);
                CHECK_NEAR(sum / air.sky_w_m2[c], 1, 2e-5);
                for (int a = 0; a < azimuths; a++) {
                    const double azimuth = (a + 0.5) * 2 * pi_rad / azimuths;
                    level += air_sky_optical(&air, c, (double[3]){sin(azimuth), cos(azimuth), 0}) / azimuths;
                }
                /* a path without end is the horizon */
                CHECK_NEAR(air_veil_optical(&air, c, 1e9).added_w_m2_sr / level, 1, 1e-9);
            }
        }
}

static void sun_disc_adds_up(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air air = air_of(&weather, 30);
    /* rings about the sun */
    double u[3] = {0, 0, 1}, w[3], sum = 0;
    v3_cross(w, u, air.sun_d_enu);
    CHECK(v3_normalize(w, w));
    v3_cross(u, air.sun_d_enu, w);
    const int n = 2000;
    const double reach_rad = 0.01;
    for (int i = 0; i < n; i++) {
        const double angle = (i + 0.5) / n * reach_rad;
        double d_enu[3];
        v3_scale(d_enu, cos(angle), air.sun_d_enu);
        v3_add_scaled(d_enu, d_enu, sin(angle), u);
        sum += air_sun_disc(&air, d_enu) * 2 * pi_rad * sin(angle) * reach_rad / n;
    }
    CHECK_NEAR(sum, 1, 2e-3); /* the rim falls within one ring of 930 */
}

static void light_fades_smoothly(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    double last[2 * optical_channel_count] = {0};
    for (double e = -30; e <= 90; e += 0.05) {
        const Air air = air_of(&weather, e);
        for (int c = 0; c < optical_channel_count; c++) {
            const double sun = air.sun_w_m2[c], sky = air.sky_w_m2[c];
            const double level = fmax(sun * sin(e * rad_per_deg), 0) + sky;
            CHECK(isfinite(sun) && sun >= 0 && sky > 0 && sky < 250);
            if (e < -0.27) CHECK(sun == 0);
            if (e > -30) {
                /* steps of a twentieth of a degree: no jump, and more light for a higher sun */
                CHECK(level >= last[c] && level <= last[c] * 1.06 + 1e-12);
                CHECK(fabs(sun - last[optical_channel_count + c]) < 1.1);
            }
            last[c] = level;
            last[optical_channel_count + c] = sun;
        }
        CHECK(air.sun_mwir_w_m2 >= 0 && (e > -0.27 || air.sun_mwir_w_m2 == 0));
    }
    const Air night = air_of(&weather, -40);
    CHECK(night.sky_w_m2[optical_channel_pan] > 1e-7 && night.sky_w_m2[optical_channel_pan] < 1e-4);
}

static void veils_compose(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air air = air_of(&weather, 40);
    for (int c = 0; c < optical_channel_count; c++) {
        const Veil none = air_veil_optical(&air, c, 0), near = air_veil_optical(&air, c, 700),
                   far = air_veil_optical(&air, c, 1100), both = air_veil_optical(&air, c, 1800);
        CHECK(none.transmittance == 1 && none.added_w_m2_sr == 0);
        CHECK_NEAR(near.transmittance * far.transmittance / both.transmittance, 1, 1e-14);
        CHECK_NEAR((far.added_w_m2_sr * near.transmittance + near.added_w_m2_sr) / both.added_w_m2_sr, 1, 1e-13);
    }
    for (double range_m = 1; range_m < 1e6; range_m *= 1.5) {
        const Veil a = air_veil_mwir(&air, range_m), b = air_veil_lwir(&air, range_m);
        CHECK(a.transmittance > 0 && a.transmittance < 1 && b.transmittance > 0 && b.transmittance < 1);
        CHECK(air_veil_mwir(&air, range_m * 1.5).transmittance < a.transmittance);
        CHECK(air_veil_lwir(&air, range_m * 1.5).transmittance < b.transmittance);
        /* what is at air temperature stays at air temperature through air of the same */
        CHECK_NEAR(air.air_lwir_w_m2_sr * b.transmittance + b.added_w_m2_sr, air.air_lwir_w_m2_sr, 1e-13);
    }
}

static void sky_is_cold_above_and_warm_at_the_horizon(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    const Air air = air_of(&weather, 40);
    double last = INFINITY;
    for (double up = 0; up <= 1; up += 0.001) {
        const double sky = air_sky_lwir(&air, up);
        CHECK(sky < last);
        last = sky;
    }
    const double zenith_k = planck_table_temp(lwir, air_sky_lwir(&air, 1));
    const double horizon_k = planck_table_temp(lwir, air_sky_lwir(&air, 0));
    print_message("LWIR sky: zenith %.1f K, 30 deg %.1f K, horizon %.1f K; hemispherical mean %.1f K\n", zenith_k,
                  planck_table_temp(lwir, air_sky_lwir(&air, 0.5)), horizon_k,
                  planck_table_temp(lwir, air.sky_mean_lwir_w_m2_sr));
    CHECK(zenith_k > 205 && zenith_k < 240);
    CHECK(horizon_k > 284 && horizon_k < 288.15);
    CHECK(air_sky_lwir(&air, -0.5) == air_sky_lwir(&air, 0) && isfinite(air_sky_lwir(&air, 1.0000001)));
    /* the mean that lights surfaces is that of the radiance itself */
    double sum = 0;
    for (int i = 0; i < 20000; i++) {
        const double up = (i + 0.5) / 20000;
        sum += air_sky_lwir(&air, up) * 2 * up / 20000;
    }
    CHECK_NEAR(sum / air.sky_mean_lwir_w_m2_sr, 1, 1e-6);
}

/* Every corner of the documented weather gives numbers. */
static void extremes_are_finite(void **state)
{
    (void)state;
    static const double visibility[] = {100, 1000, 3e5}, temp[] = {220, 330}, humidity[] = {0, 1};
    for (int i = 0; i < 3 * 2 * 2; i++)
        for (double e = -90; e <= 90; e += 15) {
            const Weather weather = {visibility[i / 4], temp[i / 2 % 2], humidity[i % 2], 1013.25, 0, 0};
            const Air air = air_of(&weather, e);
            const double d_enu[3] = {0.6, 0, 0.8}, down_enu[3] = {0, 0, -1};
            for (int c = 0; c < optical_channel_count; c++) {
                CHECK(air.sky_w_m2[c] > 0 && air.sun_w_m2[c] >= 0);
                CHECK(air_sky_optical(&air, c, d_enu) > 0 && air_sky_optical(&air, c, down_enu) > 0);
                CHECK(air_sky_optical(&air, c, d_enu) < 1e3);
            }
            CHECK(air_sky_mwir(&air, 1) > 0 && air_sky_lwir(&air, 1) > 0);
            CHECK(air_sky_lwir(&air, 0) <= air.air_lwir_w_m2_sr);
            CHECK(air.longwave_loss_w_m2 >= 0 && air.longwave_loss_w_m2 < 400);
            CHECK(air.extinction_mwir_per_m > 0 && air.extinction_lwir_per_m > 0);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sun_follows_the_tables),
        cmocka_unit_test(pins),
        cmocka_unit_test(paths_follow_the_tables),
        cmocka_unit_test(thermal_sky_follows_the_tables),
        cmocka_unit_test(longwave_follows_the_tables),
        cmocka_unit_test(sky_follows_the_tables),
        cmocka_unit_test(sky_adds_up),
        cmocka_unit_test(sun_disc_adds_up),
        cmocka_unit_test(light_fades_smoothly),
        cmocka_unit_test(veils_compose),
        cmocka_unit_test(sky_is_cold_above_and_warm_at_the_horizon),
        cmocka_unit_test(extremes_are_finite),
    };
    return cmocka_run_group_tests(tests, open_tables, close_tables);
}
