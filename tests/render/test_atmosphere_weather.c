/* The air under a weather: LOWTRAN7's six atmospheres by their temperature and vapour at the ground alone, points
 * between the nodes of etc/atmosphere/vapour.bin, the ends, and the file spoilt. labels: physics */
#include "tests/render/atmosphere_errors.h"
#include "render/air/atmosphere.h"
#include "render/air/vapour_private.h"
#include "terrain/weather/weather.h"

#include <stdlib.h>
#include <unistd.h>

static Atmosphere *us1976;
static Arena      *arena;

static int open_model(void **state)
{
    (void)state;
    return atmosphere_open(&us1976, "us1976") != STATUS_OK || !(arena = arena_create());
}

static int close_model(void **state)
{
    (void)state;
    atmosphere_close(us1976);
    arena_destroy(arena);
    return 0;
}

/* Ground of LOWTRAN7's atmospheres: temperature, and vapour as it has it, in ppmv at a pressure in hPa. */
typedef struct Ground {
    const char *name;
    double      temp_k, ppmv, hpa;
} Ground;
static const Ground grounds[] = {{"tropical", 299.7, 25930, 1013},        {"midlat_summer", 294.2, 18760, 1013},
                                 {"midlat_winter", 272.2, 4316, 1018},    {"subarctic_summer", 287.2, 11940, 1010},
                                 {"subarctic_winter", 257.2, 1405, 1013}, {"us1976", 288.2, 7745, 1013}};
enum { ground_count = sizeof grounds / sizeof *grounds, every_band = (1 << AIR_BAND_COUNT) - 1 };

/* e = x p; density by the gas law of water vapour, 461.52 J/(kg K). */
static double density_kg_m3(const Ground *g) { return g->ppmv * 1e-6 * g->hpa * 100 / (461.52 * g->temp_k); }

static const Atmosphere *air_in(double visibility_m, double temp_k, double vapour_kg_m3)
{
    const Atmosphere *out = NULL;
    const AirState    state = {visibility_m, temp_k, vapour_kg_m3};
    CHECK(atmosphere_in(&out, us1976, &state, every_band, arena) == STATUS_OK && out);
    return out;
}

/* The air of a row's atmosphere and visibility, each made once. */
static const Atmosphere *air_of_row(const Table *table, int row)
{
    static const Atmosphere *known[ground_count][2];
    if (row == 0) memset(known, 0, sizeof known);
    const int five = cell(table, row, "vis_km") == 5;
    int       g = 0;
    while (g < ground_count && strcmp(grounds[g].name, word(table, row, "atmosphere")) != 0) g++;
    CHECK(g < ground_count);
    if (!known[g][five])
        known[g][five] = air_in(1000 * cell(table, row, "vis_km"), grounds[g].temp_k, density_kg_m3(&grounds[g]));
    return known[g][five];
}

static int band_of(const char *name)
{
    static const char *const names[AIR_BAND_COUNT] = {"B", "G", "R", "PAN", "NIR", "MWIR3448", "LWIR812"};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (strcmp(name, names[b]) == 0) return b;
    return -1;
}

static bool open_reference(Table *table, const char *name)
{
    char path[512], file[64];
    snprintf(file, sizeof file, "atmosphere/%s.csv", name);
    if (!reference_path(path, file)) return false;
    CHECK(table_open(table, path) == STATUS_OK);
    arena_reset(arena);
    return true;
}

static Errors tau_errors[AIR_BAND_COUNT], share_errors, light_errors[2];

static void clear_errors(void)
{
    memset(tau_errors, 0, sizeof tau_errors);
    memset(&share_errors, 0, sizeof share_errors);
    memset(light_errors, 0, sizeof light_errors);
}

static void keep_tau(int band, double got, double want, int line)
{
    keep(&tau_errors[band], got - want, line);
    if (want > 0.1) keep(&share_errors, relative(got, want, 0), line);
}

/* ---- six atmospheres by what the ground has ------------------------------------------------------------ */

static void paths_of(const char *name, bool slant)
{
    static const struct {
        const char *column;
        double      temp_k;
    } weight[] = {{"tau_bb250", 250}, {"tau_bb300", 300}, {"tau_bb500", 500}, {"tau_bb1000", 1000}};
    Table table;
    if (!open_reference(&table, name)) skip();
    clear_errors();
    for (int row = 0; row < table.rows; row++) {
        const Atmosphere *air = air_of_row(&table, row);
        const int         band = band_of(word(&table, row, "band")), line = table.line[row + 1];
        /* rows in which the model contradicts itself, as in tests/render/test_atmosphere.c */
        if (band < 0 || (slant && cell(&table, row, "zenith_deg") == 90)) continue;
        if (slant && cell(&table, row, "end_alt_km") > 2 && cell(&table, row, "end_alt_km") < 3) continue;
        const double  height_m = 1000 * cell(&table, row, "alt_km"), visibility_m = 1000 * cell(&table, row, "vis_km");
        const AirPath path = {height_m, slant ? 1000 * cell(&table, row, "end_alt_km") : height_m,
                              1000 * cell(&table, row, "range_km"), pi_rad, 0};
        PathAir       got;
        for (int w = 0; w < 4; w++) {
            const double want = cell(&table, row, weight[w].column);
            if (isnan(want)) continue;
            atmosphere_path(&got, air, visibility_m, (AirBand)band, &path, weight[w].temp_k);
            keep_tau(band, got.transmittance, want, line);
        }
        atmosphere_path(&got, air, visibility_m, (AirBand)band, &path, 300);
        keep_tau(band, got.sun_transmittance, cell(&table, row, "tau_sun"), line);
        if (band >= AIR_MWIR)
            keep(&light_errors[band - AIR_MWIR], got.thermal_w_m2_sr / cell(&table, row, "Lpath_thermal_W_m2_sr") - 1,
                 line);
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        char what[64];
        snprintf(what, sizeof what, "%s |d tau| %s", name, air_band_name((AirBand)b));
        judge(&tau_errors[b], what, 0.004, 0.008);
    }
    judge(&share_errors, "relative, where tau > 0.1", 0.02, 0.03);
    /* slanting, the model emits by whole kilometres (etc/atmosphere/README.md) */
    judge(&light_errors[0], "path radiance mwir", slant ? 0.03 : 0.01, slant ? 0.03 : 0.01);
    judge(&light_errors[1], "path radiance lwir", slant ? 0.03 : 0.01, slant ? 0.03 : 0.01);
    table_close(&table);
}

static void level_paths_of_six_atmospheres(void **state)
{
    (void)state;
    paths_of("horizontal", false);
}

static void slant_paths_of_six_atmospheres(void **state)
{
    (void)state;
    paths_of("slant", true);
}

static void sky_and_sun_of_six_atmospheres(void **state)
{
    (void)state;
    Table table;
    if (!open_reference(&table, "sky_thermal")) skip();
    clear_errors();
    for (int row = 0; row < table.rows; row++) {
        const Atmosphere *air = air_of_row(&table, row);
        const int         band = band_of(word(&table, row, "band"));
        if (band < AIR_MWIR) continue;
        SkyAir sky;
        atmosphere_sky(&sky, air, 1000 * cell(&table, row, "vis_km"), (AirBand)band, 1000 * cell(&table, row, "alt_km"),
                       rad_per_deg * cell(&table, row, "zenith_deg"), pi_rad, 0);
        keep(&light_errors[band - AIR_MWIR], sky.thermal_w_m2_sr / cell(&table, row, "Lpath_thermal_W_m2_sr") - 1,
             table.line[row + 1]);
    }
    judge(&light_errors[0], "sky mwir", 0.001, 0.001);
    judge(&light_errors[1], "sky lwir", 0.001, 0.001);
    table_close(&table);

    CHECK(open_reference(&table, "sun_irradiance"));
    Errors *direct = &tau_errors[0], *total = &tau_errors[1];
    for (int row = 0; row < table.rows; row++) {
        const Atmosphere *air = air_of_row(&table, row);
        const int         band = band_of(word(&table, row, "band"));
        if (band < 0) continue;
        const double zenith_rad = rad_per_deg * cell(&table, row, "sun_zenith_deg");
        const double top = cell(&table, row, "E_toa_normal_W_m2"), want = cell(&table, row, "E_total_horizontal_W_m2");
        SunAir       sun;
        atmosphere_sun(&sun, air, 1000 * cell(&table, row, "vis_km"), (AirBand)band, 1000 * cell(&table, row, "alt_km"),
                       zenith_rad);
        keep(direct, (sun.direct_normal_w_m2 - cell(&table, row, "E_direct_normal_W_m2")) / top, table.line[row + 1]);
        if (isnan(want)) continue;
        const double diffuse = want - cell(&table, row, "E_direct_horizontal_W_m2");
        keep(total, (sun.diffuse_horizontal_w_m2 - diffuse) / top, table.line[row + 1]);
    }
    judge(direct, "sun direct, of that above the air", 0.01, 0.015);
    judge(total, "sun diffuse, of that above the air", 0.025, 0.03); /* the file has LOWTRAN7's two streams */
    table_close(&table);

    CHECK(open_reference(&table, "sky_longwave_irradiance"));
    for (int row = 0; row < table.rows; row++)
        CHECK_NEAR(atmosphere_longwave_down(air_of_row(&table, row), 1000 * cell(&table, row, "vis_km")) /
                       cell(&table, row, "E_longwave_down_W_m2"),
                   1, 0.01);
    table_close(&table);
}

static void longwave_follows_the_vapour(void **state)
{
    (void)state;
    /* Brutsaert (1975), 1.24 (e / T)^(1/7) sigma T^4 with e in hPa, and Prata (1996), 1 - (1 + w) exp(-sqrt(1.2 + 3
     * w)), w = 46.5 e / T: at 308 K (55.77 hPa saturated) and 15, 50, 85 %; apart from each other by 2 % */
    static const double of[][3] = {{0.15, 378.0, 386.6}, {0.5, 449.0, 445.8}, {0.85, 484.3, 474.7}};
    const Weather       full = {.air_temp_k = 308, .humidity = 1};
    arena_reset(arena);
    double before = 0;
    for (int i = 0; i < 3; i++) {
        const Atmosphere *air = air_in(23000, 308, of[i][0] * weather_vapour_kg_m3(&full));
        const double      down_w_m2 = atmosphere_longwave_down(air, 23000) * pow(308 / atmosphere_temp_k(air, 0), 4);
        print_message("308 K, %2.0f %%: %.1f W/m2 down; Brutsaert %.0f, Prata %.0f\n", 100 * of[i][0], down_w_m2,
                      of[i][1], of[i][2]);
        CHECK_NEAR(down_w_m2 / of[i][1], 1, 0.05);
        CHECK_NEAR(down_w_m2 / of[i][2], 1, i > 0 ? 0.05 : 0.06);
        CHECK(down_w_m2 > before);
        before = down_w_m2;
    }
}

/* ---- between the nodes ----------------------------------------------------------------------------------- */

static void follows_lowtran_between_the_nodes(void **state)
{
    (void)state;
    static const AirBand     bands[] = {AIR_B, AIR_G, AIR_R, AIR_NIR, AIR_MWIR, AIR_LWIR};
    static const char *const names[] = {"b", "g", "r", "nir", "mwir", "lwir"};
    /* of the median: what drawing lines over the vapour itself, or the continuum over its root, would exceed */
    static const double medians[] = {4e-4, 3e-4, 4e-4, 1.2e-3, 2e-4, 1.2e-3};
    Table               table;
    CHECK(table_open(&table, "tests/render/atmosphere_vapour.csv") == STATUS_OK);
    clear_errors();
    for (int row = 0; row < table.rows; row++) {
        arena_reset(arena);
        const Atmosphere *air = air_in(23000, cell(&table, row, "temp_k"), 1e-3 * cell(&table, row, "vapour_g_m3"));
        const AirPath     path = {cell(&table, row, "observer_m"), cell(&table, row, "target_m"),
                                  cell(&table, row, "range_m"), pi_rad, 0};
        for (int b = 0; b < 6; b++) {
            PathAir got;
            atmosphere_path(&got, air, 23000, bands[b], &path, 300);
            keep_tau(bands[b], got.transmittance, cell(&table, row, names[b]), table.line[row + 1]);
        }
    }
    for (int b = 0; b < 6; b++) {
        char what[64];
        snprintf(what, sizeof what, "between nodes |d tau| %s", names[b]);
        /* near saturation haze swells fast, and by the ground's humidity at every height */
        judge(&tau_errors[bands[b]], what, bands[b] == AIR_B ? 0.008 : 0.006, 0.008);
        CHECK(percentile(&tau_errors[bands[b]], 0.5) < medians[b]);
    }
    judge(&share_errors, "relative, where tau > 0.1", 0.02, 0.03);
    table_close(&table);
}

/* More vapour lets less through; and no step in vapour or temperature. */
static void is_monotone_and_continuous(void **state)
{
    (void)state;
    static const double  temps_k[] = {230, 257.2, 265, 280, 287.7, 291, 299.7, 310, 325};
    static const AirBand bands[] = {AIR_R, AIR_NIR, AIR_MWIR, AIR_LWIR};
    const AirPath        paths[] = {{0, 0, 1000, pi_rad, 0}, {0, 0, 10000, pi_rad, 0}, {2000, 0, 5000, pi_rad, 0}};
    for (int t = 0; t < 9; t++) {
        const Weather full = {.air_temp_k = temps_k[t], .humidity = 1};
        double        before[3][4];
        for (int h = 0; h <= 50; h++) {
            arena_reset(arena);
            const Atmosphere *air = air_in(23000, temps_k[t], 0.02 * h * weather_vapour_kg_m3(&full));
            for (int p = 0; p < 3; p++)
                for (int b = 0; b < 4; b++) {
                    PathAir got;
                    atmosphere_path(&got, air, 23000, bands[b], &paths[p], 300);
                    /* LOWTRAN7's rural haze of a given visibility lets a little more infrared through when it is moist
                     */
                    if (h > 0 && !(got.transmittance <= before[p][b] + (bands[b] == AIR_LWIR ? 2e-5 : 1e-6)))
                        fail_msg("%g K, path %d, %s: %.6f at %d %%, %.6f before", temps_k[t], p,
                                 air_band_name(bands[b]), got.transmittance, 2 * h, before[p][b]);
                    before[p][b] = got.transmittance;
                }
        }
    }
    /* across the profiles' own temperatures and a node of the vapour (tropical's 1.6): steps of a thousandth */
    static const double across[][4] = {{288.2 - 5e-4, 0.006, 288.2 + 5e-4, 0.006},
                                       {299.7 - 5e-4, 0.019, 299.7 + 5e-4, 0.019},
                                       {257.2 - 5e-4, 0.001, 257.2 + 5e-4, 0.001},
                                       {305, 0.03038468 - 1e-7, 305, 0.03038468 + 1e-7}};
    for (int i = 0; i < 4; i++)
        for (int b = 0; b < 4; b++) {
            PathAir low, high;
            SkyAir  sky[2] = {{0}};
            arena_reset(arena);
            const Atmosphere *first = air_in(23000, across[i][0], across[i][1]),
                             *second = air_in(23000, across[i][2], across[i][3]);
            atmosphere_path(&low, first, 23000, bands[b], &paths[1], 300);
            atmosphere_path(&high, second, 23000, bands[b], &paths[1], 300);
            atmosphere_sky(&sky[0], first, 23000, bands[b], 0, 1, 0.5, 1);
            atmosphere_sky(&sky[1], second, 23000, bands[b], 0, 1, 0.5, 1);
            CHECK_NEAR(low.transmittance, high.transmittance, 2e-5);
            CHECK_NEAR(sky[0].thermal_w_m2_sr, sky[1].thermal_w_m2_sr, 1e-4 * sky[1].thermal_w_m2_sr);
            CHECK_NEAR(sky[0].scattered_w_m2_sr, sky[1].scattered_w_m2_sr, 1e-4 * sky[1].scattered_w_m2_sr);
        }
}

/* Its own ground's state: the model's own tables. */
static void its_own_state_is_the_model(void **state)
{
    (void)state;
    arena_reset(arena);
    for (int v = 0; v < 3; v++) {
        const double      visibility_m = (const double[]){5000, 14000, 60000}[v];
        const Atmosphere *air = air_in(visibility_m, 288.2, density_kg_m3(&grounds[5]));
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int i = 0; i < 20; i++) {
                const AirPath path = {100.0 * (i % 5), 400.0 * (i % 7), 3000 * pow(1.2, i), 0.7, 0.3 * i};
                PathAir       own, got;
                SkyAir        own_sky, sky;
                SunAir        own_sun, sun;
                atmosphere_path(&own, us1976, visibility_m, (AirBand)b, &path, 300);
                atmosphere_path(&got, air, visibility_m, (AirBand)b, &path, 300);
                atmosphere_sky(&own_sky, us1976, visibility_m, (AirBand)b, 300 * i, 0.07 * i, 0.7, 0.1 * i);
                atmosphere_sky(&sky, air, visibility_m, (AirBand)b, 300 * i, 0.07 * i, 0.7, 0.1 * i);
                atmosphere_sun(&own_sun, us1976, visibility_m, (AirBand)b, 300 * i, 0.07 * i);
                atmosphere_sun(&sun, air, visibility_m, (AirBand)b, 300 * i, 0.07 * i);
                CHECK_NEAR(got.transmittance, own.transmittance, 1e-4);
                CHECK_NEAR(got.thermal_w_m2_sr, own.thermal_w_m2_sr, 1e-3 * own.thermal_w_m2_sr);
                CHECK_NEAR(got.scattered_w_m2_sr, own.scattered_w_m2_sr, 1e-3 * own.scattered_w_m2_sr);
                CHECK_NEAR(sky.thermal_w_m2_sr, own_sky.thermal_w_m2_sr, 1e-3 * own_sky.thermal_w_m2_sr);
                CHECK_NEAR(sky.scattered_w_m2_sr, own_sky.scattered_w_m2_sr, 1e-3 * own_sky.scattered_w_m2_sr);
                CHECK_NEAR(sun.direct_normal_w_m2, own_sun.direct_normal_w_m2, 1e-6 * own_sun.direct_normal_w_m2);
            }
    }
}

/* ---- the file ---------------------------------------------------------------------------------------------- */

static char   spoilt[64];
static char  *whole;
static size_t octets;

static void write_spoilt(size_t count)
{
    FILE *file = fopen(spoilt, "wb");
    CHECK(file && fwrite(whole, 1, count, file) == count && fclose(file) == 0);
}

static void refused(const char *what)
{
    Vapour      *v = NULL;
    const Status status = vapour_open(&v, spoilt);
    if (status == STATUS_OK || v) fail_msg("%s was accepted", what);
}

/* The sums of the file as README.md has them, made again: so that what is wrong is the numbers alone. */
static void seal(void)
{
    uint64_t a = 0, b = 0;
    for (size_t i = 40; i < octets; i += 4) {
        uint32_t word_there;
        memcpy(&word_there, whole + i, 4);
        a += word_there;
        b += a;
    }
    memcpy(whole + 24, &a, 8);
    memcpy(whole + 32, &b, 8);
}

static void sink(void *user, LogLevel level, const char *line)
{
    (void)level;
    snprintf(user, 256, "%s", line);
}

static void a_spoilt_file_is_refused(void **state)
{
    (void)state;
    char    path[512], said[256] = "";
    Vapour *v = NULL;
    strcpy(spoilt, "/tmp/pitviper-test-XXXXXX");
    const int made = mkstemp(spoilt);
    CHECK(made >= 0 && close(made) == 0 && etc_path(path, sizeof path, "atmosphere/vapour.bin"));
    FILE *file = fopen(path, "rb");
    CHECK(file && fseek(file, 0, SEEK_END) == 0);
    octets = (size_t)ftell(file);
    whole = malloc(octets);
    CHECK(whole && fseek(file, 0, SEEK_SET) == 0 && fread(whole, 1, octets, file) == octets && fclose(file) == 0);
    write_spoilt(octets);
    CHECK(vapour_open(&v, spoilt) == STATUS_OK);
    vapour_close(v);
    log_set_sink(sink, said);
    /* an octet or a range of them, anywhere; the sums say so. Octets 12 to 15 are 0, and are asked for too */
    for (size_t k = 0; k < 60; k++) {
        const size_t at = k < 30 ? 3 * k : (size_t)((double)octets * (double)(k - 29) / 31) - 3;
        const char   was = whole[at];
        whole[at] = (char)(whole[at] ^ (1 << k % 8));
        write_spoilt(octets);
        refused("a bit turned over");
        whole[at] = was;
    }
    CHECK(strstr(said, spoilt) && strstr(said, "README.md"));
    for (size_t k = 0; k < 12; k++) {
        write_spoilt(k < 4 ? 30 * k : octets - 3 * k * k);
        refused("a file cut off");
    }
    /* each count, too large or none, with sums that fit */
    for (size_t k = 0; k < 12; k++)
        for (int other = 0; other < 3; other++) {
            uint32_t       was;
            const uint32_t now = (const uint32_t[]){0, 3, 0xffffffffu}[other];
            memcpy(&was, whole + 40 + 4 * k, 4);
            memcpy(whole + 40 + 4 * k, &now, 4);
            seal();
            write_spoilt(octets);
            refused("another count");
            memcpy(whole + 40 + 4 * k, &was, 4);
        }
    /* a number that is none, in the axes and among the last depths */
    for (size_t k = 0; k < 6; k++) {
        const size_t at = k < 3 ? 88 + 7 * 136 + 32 + 56 * k : octets - 8 * (k - 2);
        char         was[8];
        memcpy(was, whole + at, 8);
        memset(whole + at, 0xff, 8);
        seal();
        write_spoilt(octets);
        refused("a number that is none");
        memcpy(whole + at, was, 8);
    }
    log_set_sink(NULL, NULL);
    unlink(spoilt);
    free(whole);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(level_paths_of_six_atmospheres),    cmocka_unit_test(slant_paths_of_six_atmospheres),
        cmocka_unit_test(sky_and_sun_of_six_atmospheres),    cmocka_unit_test(longwave_follows_the_vapour),
        cmocka_unit_test(follows_lowtran_between_the_nodes), cmocka_unit_test(is_monotone_and_continuous),
        cmocka_unit_test(its_own_state_is_the_model),        cmocka_unit_test(a_spoilt_file_is_refused)};
    return cmocka_run_group_tests(tests, open_model, close_model);
}
