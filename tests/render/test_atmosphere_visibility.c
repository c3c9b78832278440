/* The air of visibilities that have no table, against the program that filled the tables: paths, the sun and the sky's
 * light; that the tables come back at their own; that one visibility alone is the same air. labels: physics */
#include "tests/render/atmosphere_errors.h"
#include "render/air/atmosphere.h"

static Atmosphere       *model[2];
static const char *const model_name[2] = {"us1976", "midlat_summer"};
static const char *const tabled[6] = {"b", "g", "r", "nir", "mwir", "lwir"};
static const AirBand     tabled_band[6] = {AIR_B, AIR_G, AIR_R, AIR_NIR, AIR_MWIR, AIR_LWIR};

static int open_models(void **state)
{
    (void)state;
    for (int m = 0; m < 2; m++)
        if (atmosphere_open(&model[m], model_name[m]) != STATUS_OK) return -1;
    return 0;
}

static int close_models(void **state)
{
    (void)state;
    for (int m = 0; m < 2; m++) atmosphere_close(model[m]);
    return 0;
}

static const Atmosphere *model_of(const Table *table, int row)
{
    return model[strcmp(word(table, row, "model"), model_name[1]) == 0];
}

static double cell_of(const Table *table, int row, const char *before, const char *after)
{
    char column[32];
    snprintf(column, sizeof column, "%s%s", before, after);
    return cell(table, row, column);
}

/* Transmittances above a hundredth, of all weights; and kelvin by which the path's own light shifts a body at 300 K. */
typedef struct Found {
    Errors near, far, kelvin; /* to 20 km, beyond */
} Found;

static void find(Found *out, const Table *table, int row, int i)
{
    static const double temp_k[4] = {300, 350, 800, 1700};
    static const double per_k[2] = {0.04997, 0.6297}; /* d radiance / d temp at 300 K */
    const AirBand       band = tabled_band[i];
    const int           line = table->line[row + 1];
    const double        a_m = cell(table, row, "observer_m"), b_m = cell(table, row, "target_m");
    const double        range_m = cell(table, row, "range_m");
    /* the reader's level path is a straight line, which lies lower by this in the mean than one of constant height */
    const double  lift_m = a_m == b_m ? range_m * range_m / (12 * 7433000.0) : 0;
    const AirPath path = {a_m + lift_m, b_m + lift_m, range_m, pi_rad, 0};
    const double  visibility_m = 1000 * cell(table, row, "visibility_km");
    Errors       *errors = range_m > 20000 ? &out->far : &out->near;
    PathAir       air;
    for (int t = -1; t < (i < 4 ? 0 : 4); t++) {
        char column[32];
        snprintf(column, sizeof column, t < 0 ? "sun_%s" : "%s_%.0fk", tabled[i], t < 0 ? 0 : temp_k[t]);
        const double want = cell(table, row, column);
        atmosphere_path(&air, model_of(table, row), visibility_m, band, &path, t < 0 ? 300 : temp_k[t]);
        if (want > 0.01) keep(errors, relative(t < 0 ? air.sun_transmittance : air.transmittance, want, 0), line);
        if (t == 0)
            keep(&out->kelvin, (air.thermal_w_m2_sr - cell_of(table, row, tabled[i], "_thermal")) / per_k[i - 4], line);
    }
}

static void paths(bool fog)
{
    static Found found[6];
    memset(found, 0, sizeof found);
    Table table;
    CHECK(table_open(&table, "tests/render/atmosphere_visibilities.csv") == STATUS_OK);
    for (int row = 0; row < table.rows; row++)
        for (int i = 0; i < 6; i++)
            if ((cell(&table, row, "visibility_km") < 2) == fog) find(&found[i], &table, row, i);
    for (int i = 0; i < 6; i++) {
        char what[64];
        snprintf(what, sizeof what, "%s: tau %s", fog ? "fog" : "2-50 km", tabled[i]);
        judge(&found[i].near, what, fog ? 0.05 : 0.015, fog ? 0.05 : 0.04);
        snprintf(what, sizeof what, "%s: tau %s beyond 20 km", fog ? "fog" : "2-50 km", tabled[i]);
        judge(&found[i].far, what, 0.05, 0.05);
        snprintf(what, sizeof what, "%s: path kelvin %s", fog ? "fog" : "2-50 km", tabled[i]);
        if (i >= 4) judge(&found[i].kelvin, what, fog ? 0.55 : 0.3, 0.55);
    }
    table_close(&table);
}

static void paths_of_other_visibilities(void **state)
{
    (void)state;
    paths(false);
}

static void paths_in_fog(void **state)
{
    (void)state;
    paths(true);
}

/* Direct light where a hundredth of it is left, and all light on a level plane; the sun to 80 degrees. */
static void sun_of_other_visibilities(void **state)
{
    (void)state;
    static Errors direct[2], total[2];
    memset(direct, 0, sizeof direct);
    memset(total, 0, sizeof total);
    Table table;
    CHECK(table_open(&table, "tests/render/atmosphere_visibilities_sun.csv") == STATUS_OK);
    for (int row = 0; row < table.rows; row++)
        for (int i = 0; i < 6; i++) {
            const double visibility_m = 1000 * cell(&table, row, "visibility_km");
            const double zenith_rad = rad_per_deg * cell(&table, row, "sun_zenith_deg"), level = cos(zenith_rad);
            const double want = cell_of(&table, row, "direct_", tabled[i]);
            const double diffuse = cell_of(&table, row, "diffuse_", tabled[i]),
                         height_m = cell(&table, row, "observer_m");
            const int fog = visibility_m < 2000;
            SunAir    sun, top;
            atmosphere_sun(&sun, model_of(&table, row), visibility_m, tabled_band[i], height_m, zenith_rad);
            atmosphere_sun(&top, model_of(&table, row), 50000, tabled_band[i], 16000, 0);
            if (want > 0.01 * top.direct_normal_w_m2)
                keep(&direct[fog], relative(sun.direct_normal_w_m2, want, 0), table.line[row + 1]);
            const double all = sun.direct_normal_w_m2 * level + sun.diffuse_horizontal_w_m2;
            keep(&total[fog], relative(all, want * level + diffuse, 0), table.line[row + 1]);
        }
    judge(&direct[0], "2-50 km: sun direct", 0.01, 0.02);
    judge(&total[0], "2-50 km: sun and sky", 0.01, 0.01);
    judge(&direct[1], "fog: sun direct", 0.05, 0.05);
    judge(&total[1], "fog: sun and sky", 0.25, 0.25); /* the worst: a low sun, of whose light a hundredth is left */
    CHECK(percentile(&total[1], 0.5) < 0.002);
    table_close(&table);
}

/* Scattered light at 10 km, between the tables of 5 and 23 that alone have it: of the sky and of paths. Thermal bands,
 * where the air's own light is more, are left out. */
static void scattered_between_its_tables(void **state)
{
    (void)state;
    static Errors sky_errors, path_errors;
    memset(&sky_errors, 0, sizeof sky_errors);
    memset(&path_errors, 0, sizeof path_errors);
    for (int path = 0; path < 2; path++) {
        Table table;
        CHECK(table_open(&table, path ? "tests/render/atmosphere_scattered.csv" : "tests/render/atmosphere_sky.csv") ==
              STATUS_OK);
        for (int row = 0; row < table.rows; row++)
            for (int i = 0; i < 4; i++) {
                if (cell(&table, row, "visibility_km") != 10) continue;
                const double sun_rad = rad_per_deg * cell(&table, row, "sun_zenith_deg");
                const double azimuth_rad = rad_per_deg * cell(&table, row, "rel_azimuth_deg");
                const double eye_m = cell(&table, row, "observer_m"),
                             want = cell_of(&table, row, "scattered_", tabled[i]);
                const Atmosphere *a = model_of(&table, row);
                SkyAir            sky;
                PathAir           air;
                if (path) {
                    const AirPath at = {eye_m, cell(&table, row, "target_m"), cell(&table, row, "range_m"), sun_rad,
                                        azimuth_rad};
                    atmosphere_path(&air, a, 10000, tabled_band[i], &at, 300);
                    keep(&path_errors, relative(air.scattered_w_m2_sr, want, 0), table.line[row + 1]);
                } else {
                    const double zenith_rad = rad_per_deg * cell(&table, row, "zenith_deg");
                    atmosphere_sky(&sky, a, 10000, tabled_band[i], eye_m, zenith_rad, sun_rad, azimuth_rad);
                    keep(&sky_errors, relative(sky.scattered_w_m2_sr, want, 0), table.line[row + 1]);
                }
            }
        table_close(&table);
    }
    judge(&sky_errors, "10 km: sky scattered", 0.4, 0.52); /* the worst: along the horizon */
    judge(&path_errors, "10 km: path scattered", 0.25, 0.35);
    CHECK(percentile(&sky_errors, 0.5) < 0.02 && percentile(&path_errors, 0.5) < 0.04);
}

/* More haze is never clearer, no step where tables meet, and the span is what it says. */
static void goes_smoothly(void **state)
{
    (void)state;
    double low_m, high_m;
    atmosphere_visibilities(model[0], &low_m, &high_m);
    CHECK_NEAR(low_m, 0.4 * 200, 1e-9); /* 0.4 to 2.2 times beyond the tables of 200 m and 50 km (etc/atmosphere) */
    CHECK_NEAR(high_m, 2.2 * 50000, 1e-9);
    const AirPath path = {0, 300, 400, 0.9, 1}, far = {0, 300, 4000, 0.9, 1};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        for (int k = 0; k < 2; k++) {
            double last = 0, step = 0;
            for (double visibility_m = low_m; visibility_m < high_m; visibility_m *= 1.01) {
                PathAir air;
                atmosphere_path(&air, model[0], visibility_m, (AirBand)b, k ? &far : &path, 300);
                CHECK(air.transmittance >= last - 1e-6);
                if (visibility_m > low_m) step = fmax(step, air.transmittance - last);
                last = air.transmittance;
            }
            CHECK(step < 0.012); /* of one per cent of visibility: tau ln(1 / tau) / 100, with room for the band */
        }
    PathAir at, beyond;
    atmosphere_path(&at, model[0], high_m, AIR_G, &far, 300);
    atmosphere_path(&beyond, model[0], 10 * high_m, AIR_G, &far, 300);
    CHECK(at.transmittance == beyond.transmittance);
}

/* A row of a table comes back, also where other tables of the model have no paths; one visibility alone is the same. */
static void alone_and_among_others(void **state)
{
    (void)state;
    static const double  visibility_m[] = {100,   200,   700,   2000,  3000,  5000, 10000,
                                           15000, 23000, 40000, 50000, 90000, 3e5};
    static const AirPath path[3] = {{500, 500, 7000, 0.9, 1}, {0, 1500, 3000, 0.5, 2}, {6000, 100, 9000, 1.2, 0}};
    for (size_t v = 0; v < sizeof visibility_m / sizeof *visibility_m; v++) {
        Atmosphere *one = NULL;
        CHECK(atmosphere_open_at(&one, "us1976", visibility_m[v]) == STATUS_OK);
        const double soft = visibility_m[v] < 200 ? 0.01 : 0.004; /* beyond the tables */
        double       low_m, high_m, all_low_m, all_high_m;
        atmosphere_visibilities(one, &low_m, &high_m);
        atmosphere_visibilities(model[0], &all_low_m, &all_high_m);
        CHECK(low_m == all_low_m && high_m == all_high_m);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int p = 0; p < 3; p++) {
                PathAir a, all;
                SunAir  sun, all_sun;
                atmosphere_path(&a, one, visibility_m[v], (AirBand)b, &path[p], 300);
                atmosphere_path(&all, model[0], visibility_m[v], (AirBand)b, &path[p], 300);
                atmosphere_sun(&sun, one, visibility_m[v], (AirBand)b, 300 * p, 0.8);
                atmosphere_sun(&all_sun, model[0], visibility_m[v], (AirBand)b, 300 * p, 0.8);
                CHECK_NEAR(a.transmittance, all.transmittance, 0.003);
                CHECK_NEAR(a.thermal_w_m2_sr, all.thermal_w_m2_sr, 0.003 * all.thermal_w_m2_sr);
                CHECK_NEAR(a.scattered_w_m2_sr, all.scattered_w_m2_sr, 0.01 * all.scattered_w_m2_sr);
                const double direct = all_sun.direct_normal_w_m2, diffuse = all_sun.diffuse_horizontal_w_m2;
                CHECK_NEAR(sun.direct_normal_w_m2, direct, 0.003 * direct + 0.01);
                CHECK_NEAR(sun.diffuse_horizontal_w_m2, diffuse, soft * diffuse);
            }
        atmosphere_close(one);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_of_other_visibilities),
        cmocka_unit_test(paths_in_fog),
        cmocka_unit_test(sun_of_other_visibilities),
        cmocka_unit_test(scattered_between_its_tables),
        cmocka_unit_test(goes_smoothly),
        cmocka_unit_test(alone_and_among_others),
    };
    return cmocka_run_group_tests(tests, open_models, close_models);
}
