/* tests/render/test_probe_heat.c: `probe heat-ground`, through the CSV that a user gives, against one column of ground
 * alone under the same weather, in steps of half the length. labels: physics slow */
#include "tests/check.h"

#include "render/frame/world.h"
#include "render/probe.h"
#include "terrain/probe.h"

enum { most_rows = 64, most_octets = 1 << 16 };
static const double day_s = 86400, midnight_s = 1782000000; /* 2026-06-21 at 0 E */

/* Through the probe, a clear day at 45 N 0 E: temp_k, air_temp_k, absorbed_w_m2, ... of each row; reason: its last
 * cell. */
static int asked(double value[most_rows][8], char reason[most_rows][96], const char *csv)
{
    static char text[most_octets];
    char  name[] = "heat-ground", day[] = "clear", lat[] = "45", lon[] = "0", *argv[] = {name, day, lat, lon, NULL};
    char *cell[32], *line, *rest = text;
    const Probe *probe = NULL;
    for (int i = 0; i < render_probe_count; i++)
        if (strcmp(render_probes[i].name, argv[0]) == 0) probe = &render_probes[i];
    memset(text, 0, sizeof text);
    FILE *in = fmemopen((void *)(uintptr_t)csv, strlen(csv), "r"), *out = fmemopen(text, sizeof text - 1, "w");
    CHECK(probe && in && out && probe_run(probe, 4, argv, in, out) == STATUS_OK);
    fclose(in);
    fclose(out);
    int rows = 0;
    strtok_r(rest, "\n", &rest);
    for (; (line = strtok_r(NULL, "\n", &rest)); rows++) {
        const int cells = text_split(cell, 32, line);
        CHECK(rows < most_rows && cells == 6 + 8 + 1);
        for (int c = 0; c < 8; c++)
            if (!*cell[6 + c] || !text_to_double(&value[rows][c], cell[6 + c])) value[rows][c] = NAN;
        snprintf(reason[rows], 96, "%s", cell[14]);
    }
    return rows;
}

typedef struct Ground {
    Materials      materials;
    GroundKinds    kinds;
    PlanckTable   *planck[2];
    Atmosphere    *atmosphere;
    WeatherCourse *course;
    HeatDrive      drive;
} Ground;
static Ground ground;

static int set_up(void **state)
{
    (void)state;
    char materials[512], surfaces[512], path[512];
    char name[] = "test", day[] = "clear", lat[] = "45", lon[] = "0", *argv[] = {name, day, lat, lon, NULL};
    if (!etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv") || !etc_path(path, sizeof path, "ground_heat.csv") ||
        materials_open(&ground.materials, materials, surfaces, NULL) != STATUS_OK ||
        ground_kinds_open(&ground.kinds, path, &ground.materials) != STATUS_OK ||
        atmosphere_open_at(&ground.atmosphere, "us1976", 23000) != STATUS_OK ||
        probe_weather(&ground.course, &ground.drive.place, 4, argv) != STATUS_OK)
        return -1;
    for (int k = 0; k < 2; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        if (planck_table_create(&ground.planck[k], low_m, high_m) != STATUS_OK) return -1;
    }
    ground.drive.course = ground.course;
    ground.drive.source = (AirSource){ground.atmosphere, ground.planck[0], ground.planck[1], 0, 0};
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    weather_course_close(ground.course);
    atmosphere_close(ground.atmosphere);
    for (int k = 0; k < 2; k++) planck_table_destroy(ground.planck[k]);
    materials_close(&ground.materials);
    return 0;
}

/* Steps of 300 s through a day from begin_s; the mean of its surface. */
static double march(GroundColumn *c, const GroundExposure *e, double begin_s, double hours)
{
    GroundWeather w[2];
    double        sum = 0;
    const int     steps = (int)round(12 * hours);
    world_heat_weather(&w[0], begin_s, &ground.drive);
    for (int i = 0; i < steps; i++) {
        world_heat_weather(&w[1], begin_s + 300 * (i + 1), &ground.drive);
        ground_column_step(c, ground_grid_default.tolerance_k, &w[0], &w[1], e, 300);
        sum += c->state.temp_k[0] / steps;
        w[0] = w[1];
    }
    return sum;
}

/* One column of one kind: from the mean of its first level day, two days, and the hours of the third. */
static void alone(GroundColumn *out, Column *layers, int kind, const GroundExposure *e, double hours)
{
    static const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
    const double                begin_s = midnight_s - 2 * day_s;
    CHECK(ground_layers(layers, &ground.kinds.kind[kind], &ground_grid_default) == STATUS_OK);
    ground_column_start(out, &ground.kinds.kind[kind], layers, 288.15);
    const double mean_k = march(out, &level, begin_s, 24);
    ground_column_start(out, &ground.kinds.kind[kind], layers, mean_k);
    march(out, e, begin_s, 48 + hours);
}

static const char *const kinds[] = {"grass", "bare_soil", "rock", "road", "water"};
enum { kind_count = sizeof kinds / sizeof *kinds };

/* Within 0.01 K: longer steps, those of half hours in the spin-up above all. */
static void level_ground_is_its_column(void **state)
{
    (void)state;
    static const double hour[] = {5, 9.25, 12, 17, 21};
    static char         csv[most_octets], reason[most_rows][96];
    static double       got[most_rows][8];
    char               *at = csv + sprintf(csv, "unix_s,surface,slope_deg,aspect_deg,shade,depth_m\n");
    for (int h = 0; h < 5; h++)
        for (int k = 0; k < kind_count; k++) at += sprintf(at, "%.0f,%s,0,,,\n", midnight_s + 3600 * hour[h], kinds[k]);
    CHECK(asked(got, reason, csv) == 5 * kind_count);
    static const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
    double                      worst = 0;
    for (int k = 0; k < kind_count; k++) {
        Column       layers;
        GroundColumn column;
        alone(&column, &layers, ground_kind_find(kinds[k]), &level, 0);
        for (int h = 0; h < 5; h++) {
            const double *row = got[h * kind_count + k], from = h ? hour[h - 1] : 0;
            march(&column, &level, midnight_s + 3600 * from, hour[h] - from);
            worst = fmax(worst, fabs(row[0] - column.state.temp_k[0]));
            CHECK_NEAR(row[0], column.state.temp_k[0], 0.02);

            GroundWeather w;
            SurfaceFlux   flux;
            world_heat_weather(&w, midnight_s + 3600 * hour[h], &ground.drive);
            ground_flux(&flux, &column, &w, &level);
            CHECK_NEAR(row[1], w.air.temp_k, 1e-9);
            CHECK_NEAR(row[2], flux.absorbed_w_m2, 0.1);
            CHECK_NEAR(row[3], w.direct_w_m2, 1e-9);
            CHECK_NEAR(row[4], w.diffuse_w_m2, 1e-9);
            CHECK_NEAR(row[5], w.longwave_w_m2, 1e-9);
            CHECK_NEAR(row[6], surface_film_w_m2k(&flux, column.state.temp_k[0]), 0.05);
            CHECK_NEAR(row[7], surface_latent_w_m2(&flux, column.state.temp_k[0]), 1);
        }
    }
    print_message("level ground: within %.3f K\n", worst);
}

/* A slope that is a facet of the table, (1/6, 1/6, 2/3), in sun and in shade; and what lies below level ground. */
static void slopes_shade_and_depth(void **state)
{
    (void)state;
    static char   csv[most_octets], reason[most_rows][96];
    static double got[most_rows][8];
    const double  slope_rad = atan(sqrt(2) / 4), noon_s = midnight_s + day_s / 2;
    sprintf(
        csv,
        "unix_s,surface,slope_deg,aspect_deg,shade,depth_m\n%.0f,sand,%.12g,45,0,\n%.0f,sand,0,,1,\n%.0f,sand,,,,0.1\n%.0f,sand,,,,0\n",
        noon_s, slope_rad / rad_per_deg, noon_s, noon_s, noon_s);
    CHECK(asked(got, reason, csv) == 4);
    const int            sand = ground_kind_find("sand");
    const GroundExposure slope = {{sin(slope_rad) * sqrt(0.5), sin(slope_rad) * sqrt(0.5), cos(slope_rad)}, 1, 1, 300},
                         shade = {{0, 0, 1}, 0, 1, 0}, level = {{0, 0, 1}, 1, 1, 0};
    Column       layers;
    GroundColumn column;
    alone(&column, &layers, sand, &slope, 12);
    CHECK_NEAR(got[0][0], column.state.temp_k[0], 0.5); /* level ground fills the rest of its view: here 300 K of it */
    alone(&column, &layers, sand, &shade, 12);
    CHECK_NEAR(got[1][0], column.state.temp_k[0], 0.02);
    CHECK(got[1][2] < got[3][2] - 300); /* absorbed */
    alone(&column, &layers, sand, &level, 12);
    CHECK_NEAR(got[2][0], column_temp_k(&column.state, &layers, 0.1), 0.02);
    CHECK_NEAR(got[3][0], column.state.temp_k[0], 0.02);
}

static void a_row_answers_alone(void **state)
{
    (void)state;
    static char   reason[most_rows][96];
    static double got[most_rows][8];
    CHECK(
        asked(
            got, reason,
            "unix_s,surface,slope_deg,aspect_deg,shade,depth_m\n1782043200,grass,10,90,0.5,\n1782129600,grass,10,90,0.5,\n"
            "1782021600,grass,10,90,0.5,\n1782043200,grass,10,90,0.5,\n") == 4);
    CHECK(memcmp(got[0], got[3], sizeof got[0]) == 0);
    CHECK(fabs(got[0][0] - got[1][0]) < 0.2 && got[0][0] != got[2][0]);
}

static void bad_rows_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *row, *why;
    } bad[] = {
        {"1782043200,lava,0,0,0,", "surface is no row"},
        {"1782043200,,0,0,0,", "surface is empty"},
        {"1782043200,sand,95,0,0,", "slope_deg"},
        {"1782043200,sand,-1,0,0,", "slope_deg"},
        {"1782043200,sand,nan,0,0,", "not a number"},
        {"nan,sand,0,0,0,", "not a number"},
        {"1e12,sand,0,0,0,", "unix_s"},
        {"1782043200,sand,0,1e9,0,", "aspect_deg"},
        {"1782043200,sand,0,0,1.5,", "shade"},
        {"1782043200,sand,0,0,0,-1", "depth_m"},
        {"1782043200,sand,0,0,0,99", "depth_m must be in 0 .. 3"},
        {"1782043200,sand,10,0,0,0.1", "level ground"},
    };
    enum { count = sizeof bad / sizeof *bad };
    static char   csv[most_octets], reason[most_rows][96];
    static double got[most_rows][8];
    char         *at = csv + sprintf(csv, "unix_s,surface,slope_deg,aspect_deg,shade,depth_m\n");
    for (int i = 0; i < count; i++) at += sprintf(at, "%s\n", bad[i].row);
    CHECK(asked(got, reason, csv) == count);
    for (int i = 0; i < count; i++) {
        if (!strstr(reason[i], bad[i].why)) fail_msg("%s: %s", bad[i].row, reason[i]);
        for (int c = 0; c < 8; c++) CHECK(isnan(got[i][c]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_ground_is_its_column),
        cmocka_unit_test(slopes_shade_and_depth),
        cmocka_unit_test(a_row_answers_alone),
        cmocka_unit_test(bad_rows_are_told),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
