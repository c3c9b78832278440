/* The table of clutter: what it must hold, what it must refuse, and the forms its figures go into. labels: physics */
#include "tests/check.h"
#include "render/scattering/clutter/clutter_table_private.h"

static ClutterTable table;

static int open_table(void **state)
{
    (void)state;
    char path[512];
    log_set_sink(check_listen, NULL);
    return etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&table, path) == STATUS_OK ? 0 : -1;
}

static const char header[] = "surface,band,model,gamma_db,a,b,c,d,roughness_mm,nu,texture_m,hh_vv_db,hv_vv_db,rho,"
                             "motion,still,extent_mm,foliage_db_m,source\n";
static const char good[] = "gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test";

/* A whole table whose row of crop in Ka is this one; from: NULL leaves it out. */
static Status open_with(ClutterTable *out, const char *crop_ka, const char *head)
{
    char   path[text_file_size], *text = NULL;
    size_t size;
    FILE  *to = open_memstream(&text, &size);
    CHECK(to);
    fputs(head, to);
    for (int s = 1; s < SURFACE_COUNT; s++)
        for (int b = 0; b < CLUTTER_BAND_COUNT; b++) {
            if (s != SURFACE_CROP || b != CLUTTER_KA)
                fprintf(to, "%s,%s,%s\n", surface_name((SurfaceClass)s), clutter_band_name((ClutterBand)b), good);
            else if (crop_ka) fprintf(to, "%s\n", crop_ka);
        }
    fclose(to);
    text_file(path, text);
    *check_said = 0;
    const Status status = clutter_table_open(out, path);
    if (status != STATUS_OK && crop_ka && head == header && !strstr(check_said, path))
        fail_msg("no file in: %s", check_said);
    remove(path);
    free(text);
    return status;
}

static void every_class_has_its_rows(void **state)
{
    (void)state;
    for (int s = 1; s < SURFACE_COUNT; s++)
        for (int b = 0; b < CLUTTER_BAND_COUNT; b++) {
            const ClutterRow *row = &table.row[s][b];
            CHECK(row->gamma > 0 && row->nu > 0 && row->texture_m > 0 && row->hh > 0 && row->hv > 0 && row->hv < 1);
            CHECK(row->rho <= 1 && row->extent_m > 0);
        }
    CHECK_NEAR(10 * log10(table.row[SURFACE_BARE_SOIL][CLUTTER_KU].gamma), -20 + 5 * log10(1.6), 0.05);
    CHECK(memcmp(&table.row[SURFACE_NONE], &table.row[SURFACE_BARE_SOIL], sizeof table.row[0]) == 0);
    ClutterBand band;
    CHECK(clutter_band_of(&band, 94e9) && band == CLUTTER_W && clutter_band_of(&band, 35e9) && band == CLUTTER_KA);
    CHECK(clutter_band_of(&band, 12e9) && band == CLUTTER_KU);
    CHECK(!clutter_band_of(&band, 20e9) && !clutter_band_of(&band, NAN));
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *row, *said;
    } cases[] = {
        {NULL, "no row"},
        {"crop,Ku,gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "a second row"},
        {"lava,Ka,gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "surface: 'lava' is not one of grass, dry_grass"},
        {"none,Ka,gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "surface: 'none' is not one of grass, dry_grass"},
        {"crop,X,gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "band: 'X' is not one of Ku, Ka, W"},
        {"crop,Ka,ulaby,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "model: 'ulaby' is not one of gamma, git"},
        {"crop,Ka,gamma,,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "gamma_db"},
        {"crop,Ka,gamma,nan,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "gamma_db"},
        {"crop,Ka,gamma,21,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "-60 .. 20"},
        {"crop,Ka,git,-14,0.1,1.5,,2,20,4,1,0,-8,0.6,0.7,3,5,1.2,test", "column c"},
        {"crop,Ka,gamma,-14,,,,,20,0.01,1,0,-8,0.6,0.7,3,5,1.2,test", "0.05"},
        {"crop,Ka,gamma,-14,,,,,20,4,0,0,-8,0.6,0.7,3,5,1.2,test", "texture_m"},
        {"crop,Ka,gamma,-14,,,,,20,4,1,0,-8,1.1,0.7,3,5,1.2,test", "rho"},
        {"crop,Ka,gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,-1,5,1.2,test", "still"},
        {"crop,Ka,gamma,-14,,,,,20,4,1,0,-8,0.6,0.7,3,5,x,test", "foliage_db_m"},
    };
    ClutterTable kept = table, out = table;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        CHECK(open_with(&out, cases[k].row, header) == STATUS_BAD_VALUE);
        if (!strstr(check_said, cases[k].said)) fail_msg("%s: said %s", cases[k].row, check_said);
        CHECK(memcmp(&out, &kept, sizeof out) == 0);
    }
    CHECK(open_with(&out, good, "surface,band\n") != STATUS_OK);
    CHECK(clutter_table_open(&out, "/nowhere/clutter.csv") == STATUS_IO);
    CHECK(open_with(&out, "crop,Ka,git,,0.1,1.5,0.01,2,20,0,1,0,-8,0.6,0.7,3,5,1.2,test", header) == STATUS_OK);
    CHECK(isinf(out.row[SURFACE_CROP][CLUTTER_KA].nu) && out.row[SURFACE_CROP][CLUTTER_KA].model == CLUTTER_GIT);
}

static void backscatter_has_its_form(void **state)
{
    (void)state;
    const ClutterRow gamma = {.gamma = 0.1},
                     git = {.model = CLUTTER_GIT, .a = 0.05, .b = 0.83, .c = 0.0013, .d = 2.3, .roughness_m = 0.01};
    CHECK_NEAR(clutter_sigma0(&gamma, pi_rad / 6, 0.03), 0.05, 1e-16);
    CHECK_NEAR(clutter_sigma0(&gamma, pi_rad / 2, 0.03), 0.1, 1e-16);
    CHECK(clutter_sigma0(&gamma, 0, 0.03) == 0 && clutter_sigma0(&git, -0.1, 0.03) == 0);
    /* by hand, at 0.1 rad and 20 mm: 0.05 * 0.1013^0.83 * exp(-2.3 / 1.05) = 0.05 * 0.149504 * 0.111864 */
    CHECK_NEAR(clutter_sigma0(&git, 0.1, 0.02), 8.3621e-4, 1e-8);
}

/* Below a normal deviate the texture has that deviate's share: against closed forms of the gamma distribution,
 * between the nodes of the table as well. */
static double normal_share(double deviate) { return 0.5 * erfc(-deviate * 0.70710678118654752440); }

static double erlang_above(int nu, double t)
{
    double sum = 0, term = 1;
    for (int n = 0; n < nu; n++) sum += term, term *= nu * t / (n + 1);
    return sum * exp(-nu * t);
}

static void texture_is_gamma_distributed(void **state)
{
    (void)state;
    static const char *const shapes[] = {"0.5", "1", "3", "20"};
    ClutterTable             made;
    double                   worst = 0;
    for (int k = 0; k < 4; k++) {
        char row[128];
        snprintf(row, sizeof row, "crop,Ka,gamma,-14,,,,,20,%s,1,0,-8,0.6,0.7,3,5,1.2,test", shapes[k]);
        CHECK(open_with(&made, row, header) == STATUS_OK);
        const ClutterRow *crop = &made.row[SURFACE_CROP][CLUTTER_KA];
        double            mean = 0, square = 0, before = 0;
        for (double g = -4; g <= 4; g += 0.0117) {
            const double t = clutter_texture(crop, g), want = normal_share(-fabs(g));
            /* share of the smaller tail, and its slope by ln t, for an error in t */
            const double below = k == 0 ? erf(sqrt(0.5 * t)) : 1 - erlang_above((int)crop->nu, t);
            const double above = k == 0 ? erfc(sqrt(0.5 * t)) : erlang_above((int)crop->nu, t);
            const double share = g < 0 ? below : above;
            const double density = exp(crop->nu * log(crop->nu * t) - crop->nu * t - lgamma(crop->nu));
            worst = fmax(worst, fabs(share - want) / density);
            CHECK(t >= before);
            before = t;
        }
        CHECK_NEAR(worst, 0, 3e-4);
        for (int i = 0; i < 200000; i++) { /* of the normal density: mean 1, variance 1 / nu */
            const double g = -8 + (i + 0.5) * 16 / 200000, t = clutter_texture(crop, g);
            const double share = 16.0 / 200000 * exp(-0.5 * g * g) / sqrt(2 * pi_rad);
            mean += share * t, square += share * t * t;
        }
        CHECK_NEAR(mean, 1, 2e-4);
        CHECK_NEAR((square - 1) * crop->nu, 1, 2e-3);
    }
    printf("largest relative error of the texture %.2g\n", worst);
    /* the ends of what is accepted: no NaN, nothing infinite */
    static const char *const ends[] = {"0.05", "10000"};
    for (int k = 0; k < 2; k++) {
        char row[128];
        snprintf(row, sizeof row, "crop,Ka,gamma,-14,,,,,20,%s,1,0,-8,0.6,0.7,3,5,1.2,test", ends[k]);
        CHECK(open_with(&made, row, header) == STATUS_OK);
        double mean = 0;
        for (int i = 0; i < 200000; i++) {
            const double g = -8 + (i + 0.5) * 16 / 200000, t = clutter_texture(&made.row[SURFACE_CROP][CLUTTER_KA], g);
            CHECK(t >= 0 && t < 1e4);
            mean += 16.0 / 200000 * exp(-0.5 * g * g) / sqrt(2 * pi_rad) * t;
        }
        printf("nu %s: mean %.5f\n", ends[k], mean);
        CHECK_NEAR(mean, 1, 1e-3);
    }
}

static void motion_is_billingsleys(void **state)
{
    (void)state;
    const ClutterRow trees = {.motion = 1, .still = 1};
    /* by hand: 10 mph at 10 GHz: r = 489.8 * 10^-1.55 * 10^-1.21 = 0.8512, 1 / beta = 0.1048 * 1.4147 = 0.14826 m/s */
    const ClutterMotion m = clutter_motion(&trees, 10e9, 4.4704);
    CHECK_NEAR(m.still, 0.8512 / 1.8512, 1e-4);
    CHECK_NEAR(m.spread_mps, 0.14826, 1e-5);
    CHECK_NEAR(clutter_correlation(&m, 0, 0.03), 1, 1e-15);
    CHECK_NEAR(clutter_correlation(&m, 0.03 / (4 * pi_rad * m.spread_mps), 0.03), m.still + (1 - m.still) / 2, 1e-12);
    const ClutterRow road = {.motion = 0, .still = 0};
    CHECK(clutter_motion(&road, 35e9, 20).still == 1 && clutter_motion(&trees, 35e9, 0).still == 1);
    CHECK(clutter_motion(&trees, 35e9, 0.1).still == 1); /* below 0.385 mph the spread would be negative */
    double before = 1;
    for (double wind = 0.2; wind < 30; wind += 0.1) {
        const double still = clutter_motion(&trees, 35e9, wind).still;
        CHECK(still <= before && still > 0);
        before = still;
    }
}

static void foliage_takes_and_returns(void **state)
{
    (void)state;
    const ClutterRow *trees = &table.row[SURFACE_FOREST_BROADLEAF][CLUTTER_KA];
    CHECK_NEAR(clutter_foliage_db(trees, 10), 0.45 * pow(35, 0.284) * 10, 0.06);
    CHECK_NEAR(clutter_foliage_db(trees, 100), 1.33 * pow(35, 0.284) * pow(100, 0.588), 0.5);
    CHECK(clutter_foliage_db(trees, -1) == 0 && clutter_foliage_db(&table.row[SURFACE_ROAD][CLUTTER_KA], 5) == 0);
    /* a deep canopy by single scattering, slice by slice: eta dV / A, through the loss twice. It is the row's sigma0 */
    const double eta = clutter_foliage_volume(trees), sine = sin(0.4), db_m = trees->foliage_db_m;
    double       sigma0 = 0;
    for (int i = 0; i < 100000; i++) {
        const double depth_m = (i + 0.5) * 5e-4;
        sigma0 += eta * 5e-4 * pow(10, -0.1 * 2 * db_m * depth_m / sine);
    }
    CHECK_NEAR(sigma0 / clutter_sigma0(trees, 0.4, 0.0086), 1, 1e-5);
}

/* Every column, each of another value, in its own member: decibels of power as ratios, millimetres as metres. */
static void columns_are_taken_by_their_names(void **state)
{
    (void)state;
    ClutterTable out;
    CHECK(open_with(&out, "crop,Ka,git,-10,0.11,1.5,0.012,2.2,21,4,1.6,3,-7,0.61,0.71,3.3,5.5,1.2,test", header) ==
          STATUS_OK);
    const ClutterRow   *row = &out.row[SURFACE_CROP][CLUTTER_KA];
    const double        got[15] = {row->gamma,       row->a,      row->b,         row->c,        row->d,
                                   row->roughness_m, row->nu,     row->texture_m, row->hh,       row->hv,
                                   row->rho,         row->motion, row->still,     row->extent_m, row->foliage_db_m};
    static const double want[15] = {
        0.1,  0.11, 1.5, 0.012,  2.2, 0.021, 4, 1.6, 1.9952623149688795, 0.19952623149688797,
        0.61, 0.71, 3.3, 0.0055, 1.2};
    CHECK(row->model == CLUTTER_GIT);
    for (int k = 0; k < 15; k++) CHECK_NEAR(got[k] / want[k], 1, 1e-12);
}

/* A table whose gamma is -(10 surface + band) dB, its rows from the last to the first: each class has its own, in each
 * band; and the bundled one is read the same way (grass, soil, rock and water of etc/radar/clutter.csv, Ku and W). */
static void rows_are_taken_by_their_names(void **state)
{
    (void)state;
    char         path[text_file_size], *text = NULL;
    size_t       size;
    FILE        *to = open_memstream(&text, &size);
    ClutterTable out;
    CHECK(to);
    fputs(header, to);
    for (int s = SURFACE_COUNT - 1; s > 0; s--)
        for (int b = CLUTTER_BAND_COUNT - 1; b >= 0; b--)
            fprintf(to, "%s,%s,gamma,%g,,,,,20,4,1,0,-8,0.6,0.7,3,5,1.2,test\n", surface_name((SurfaceClass)s),
                    clutter_band_name((ClutterBand)b), -s - 0.1 * b);
    fclose(to);
    text_file(path, text);
    CHECK(clutter_table_open(&out, path) == STATUS_OK);
    remove(path);
    free(text);
    for (int s = 1; s < SURFACE_COUNT; s++)
        for (int b = 0; b < CLUTTER_BAND_COUNT; b++) CHECK_NEAR(-10 * log10(out.row[s][b].gamma), s + 0.1 * b, 1e-9);
    CHECK_NEAR(-10 * log10(out.row[SURFACE_NONE][CLUTTER_W].gamma), SURFACE_BARE_SOIL + 0.2, 1e-9);
    static const struct {
        SurfaceClass surface;
        double       db[2];
    } of[] = {{SURFACE_GRASS, {-14.0, -10.1}},
              {SURFACE_BARE_SOIL, {-19.0, -14.1}},
              {SURFACE_ROCK, {-11.0, -7.1}},
              {SURFACE_WATER, {-40, -40}},
              {SURFACE_WETLAND, {-14.0, -10.1}}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        CHECK_NEAR(10 * log10(table.row[of[k].surface][CLUTTER_KU].gamma), of[k].db[0], 1e-9);
        CHECK_NEAR(10 * log10(table.row[of[k].surface][CLUTTER_W].gamma), of[k].db[1], 1e-9);
    }
    /* the bands of IEEE 521 that have rows, both ends of each */
    static const struct {
        double      ghz;
        ClutterBand band;
    } end[] = {{12, CLUTTER_KU}, {18, CLUTTER_KU}, {27, CLUTTER_KA},
               {40, CLUTTER_KA}, {75, CLUTTER_W},  {110, CLUTTER_W}};
    static const double outside_ghz[] = {11.999, 18.001, 26.999, 40.001, 74.999, 110.001};
    ClutterBand         band;
    for (int k = 0; k < 6; k++) {
        CHECK(clutter_band_of(&band, 1e9 * end[k].ghz) && band == end[k].band);
        CHECK(!clutter_band_of(&band, 1e9 * outside_ghz[k]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_class_has_its_rows),      cmocka_unit_test(columns_are_taken_by_their_names),
        cmocka_unit_test(rows_are_taken_by_their_names), cmocka_unit_test(what_is_wrong_is_refused),
        cmocka_unit_test(backscatter_has_its_form),      cmocka_unit_test(texture_is_gamma_distributed),
        cmocka_unit_test(motion_is_billingsleys),        cmocka_unit_test(foliage_takes_and_returns),
    };
    return cmocka_run_group_tests(tests, open_table, NULL);
}
