/* The probes of the air: its figures by row, bad rows with a reason and no figures. labels: physics */
#include "tests/check.h"

#include "pitviper_table.h"
#include "render/probe.h"

static const char *word(const Table *table, int row, const char *column)
{
    return table_text(table, row, table_column(table, column));
}

static double cell(const Table *table, int row, const char *column)
{
    double value = NAN;
    return text_to_double(&value, word(table, row, column)) ? value : NAN;
}

static Table answers(const char *name, char *rows)
{
    const Probe *probe = NULL;
    for (int i = 0; i < render_probe_count; i++)
        if (strcmp(render_probes[i].name, name) == 0) probe = &render_probes[i];
    CHECK(probe != NULL);
    char  text[4096] = "", path[text_file_size];
    FILE *in = fmemopen(rows, strlen(rows), "r"), *out = fmemopen(text, sizeof text, "w");
    log_set_sink(check_listen, NULL);
    CHECK(in && out && probe_run(probe, 0, NULL, in, out) == STATUS_OK);
    log_set_sink(NULL, NULL);
    fclose(in);
    fclose(out);
    text_file(path, text);
    Table table;
    CHECK(table_open(&table, path) == STATUS_OK);
    remove(path);
    return table;
}

static void paths(void **state)
{
    (void)state;
    /* the third: the tropical ground, 25930 ppmv of vapour at 1013 hPa, of which 34.73 hPa would saturate at 299.7 K */
    static char rows[] = "model,visibility_km,band,observer_m,target_m,range_km,temp_k,sun_zenith_deg,rel_azimuth_deg,"
                         "air_temp_k,humidity_pct\n"
                         "us1976,23,lwir,0,0,5,300,,,,\n"
                         "midlat_summer,5,nir,3000,0,5,300,45,90,,\n"
                         "us1976,23,lwir,0,0,5,300,,,299.7,75.63\n"
                         "us1976,23,red,0,0,5,300,,,,\n"
                         "us1976,23,lwir,0,9000,5,300,,,,\n"
                         "us1976,-1,lwir,0,0,5,300,,,,\n"
                         "mars,23,lwir,0,0,5,300,,,,\n"
                         "us1976,23,lwir,0,0,5,300,,,299.7,101\n"
                         "us1976,23,lwir,0,0,5,300,,,29.97,50\n"
                         "us1976,23,lwir,0,0,5,300,,,299.7,\n";
    Table       table = answers("atmosphere", rows);
    CHECK(table.rows == 10);
    CHECK_NEAR(cell(&table, 0, "tau"), 0.625655, 5e-5); /* infrared.md */
    CHECK_NEAR(cell(&table, 0, "path_radiance"), 11.7559, 2e-3);
    CHECK(isnan(cell(&table, 0, "scattered")));
    /* shared/data/atmosphere/slant_solar.csv: 3 km, 126.888 degrees, to the ground; to a per cent */
    CHECK_NEAR(cell(&table, 1, "scattered") / 9.24522, 1, 0.01);
    /* shared/data/atmosphere/horizontal.csv, tropical, 5 km along the ground at 23 km */
    CHECK_NEAR(cell(&table, 2, "tau"), 0.15798, 1e-3);
    CHECK_NEAR(cell(&table, 2, "path_radiance") / 32.2559, 1, 0.005);
    for (int row = 0; row < 10; row++) {
        CHECK((row < 3) == !*word(&table, row, "error"));
        CHECK((row < 3) == isfinite(cell(&table, row, "tau")));
    }
    table_close(&table);
}

/* Every channel has its own figures, in any order: a vertical kilometre down from 1 km at 23 km, LOWTRAN7's optical
 * depths (a black body of 300 K in the thermal ones), of pan the mean of b, g and r by their sunlight; and by
 * MODTRAN 5.2.1 swir's sunlight keeps 0.7301 of itself, within 4 %. The sun 60 degrees from the zenith: LOWTRAN7's
 * direct light of each band. */
static void channels(void **state)
{
    (void)state;
    static const char *const name[] = {"b", "swir", "g", "r", "nir", "pan", "mwir", "swir", "lwir", "nir"};
    static const double      depth[] = {0.18679, 0.27396, 0.14239, 0.11855, 0.13225,
                                        NAN,     0.52654, 0.27396, 0.11392, 0.13225};
    static const double direct[] = {51.995, 159.6, 73.801, 78.496, 218.87, 204.292, 6.2391, 159.6, 0.64242, 218.87};
    static char         rows[2048] = "model,visibility_km,band,observer_m,target_m,range_km,temp_k,sun_zenith_deg\n";
    size_t              n = strlen(rows);
    for (int i = 0; i < 10; i++)
        n += (size_t)snprintf(rows + n, sizeof rows - n, "us1976,23,%s,1000,0,1,300,60\n", name[i]);
    Table table = answers("atmosphere", rows);
    for (int i = 0; i < 10; i++) {
        const double pan = (186.641 * exp(-0.18679) + 185.365 * exp(-0.14239) + 159.39 * exp(-0.11855)) / 531.396;
        CHECK_NEAR(cell(&table, i, "tau"), isnan(depth[i]) ? pan : exp(-depth[i]), 1e-5);
        CHECK(!*word(&table, i, "error") && cell(&table, i, "scattered") > 0);
    }
    CHECK_NEAR(cell(&table, 1, "sun_tau"), 0.7301, 0.04 * 0.7301 + 0.002);
    table_close(&table);
    n = (size_t)snprintf(rows, sizeof rows, "model,visibility_km,band,observer_m,sun_zenith_deg\n");
    for (int i = 0; i < 10; i++) n += (size_t)snprintf(rows + n, sizeof rows - n, "us1976,23,%s,0,60\n", name[i]);
    snprintf(rows + n, sizeof rows - n, "us1976,23,red,0,60\nus1976,23,b,0,91\nus1976,23,b,-1,60\n");
    table = answers("sunlight", rows);
    CHECK(table.rows == 13);
    for (int i = 0; i < 13; i++) {
        CHECK((i < 10) == !*word(&table, i, "error"));
        if (i < 10) CHECK_NEAR(cell(&table, i, "direct_w_m2") / direct[i], 1, 1e-4);
    }
    table_close(&table);
}

/* us1976 at 23 km: LOWTRAN's level sky from 10 km (shared/data/atmosphere/sky_thermal.csv has 2.046 W/(m2 sr), the
 * tables 2.08 between their heights), and what the sum over shells has of a ray whose lowest point is 5 km up, 2.27
 * degrees below it (tests/data/limb.csv, within 1.2 K). */
static void directions(void **state)
{
    (void)state;
    static char rows[] =
        "model,visibility_km,band,observer_m,zenith_deg,sun_zenith_deg,rel_azimuth_deg,air_temp_k,humidity_pct\n"
        "us1976,23,lwir,10000,90,,,,\n"
        "us1976,23,lwir,10000,92.26975,,,,\n"
        "us1976,23,g,10000,92,45,90,,\n"
        "us1976,23,lwir,0,0,,,299.7,75.63\n"
        "us1976,23,lwir,-1,0,,,,\n"
        "us1976,23,lwir,0,181,,,,\n";
    Table table = answers("sky", rows);
    CHECK(table.rows == 6);
    CHECK_NEAR(cell(&table, 0, "radiance"), 2.046, 0.05);
    CHECK_NEAR(cell(&table, 1, "radiance"), 8.2592, 0.3);
    CHECK(isnan(cell(&table, 1, "scattered")) && cell(&table, 2, "scattered") > 0 && cell(&table, 2, "radiance") == 0);
    CHECK_NEAR(cell(&table, 3, "radiance") / 16.4589, 1, 0.01); /* sky_thermal.csv, tropical, overhead */
    for (int row = 0; row < 6; row++) CHECK((row < 4) == !*word(&table, row, "error"));
    table_close(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths),
        cmocka_unit_test(channels),
        cmocka_unit_test(directions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
