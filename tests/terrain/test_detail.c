/* Noise of the ground: against a plain form of it in double, one place at a time, written here; its statistics against
 * the table's; filtered, against means over the footprint of the unfiltered noise. labels: physics */
#include "tests/check.h"

#include "terrain/detail/detail.h"

static Landscape    bare; /* of one seed, without photograph and fields */
static DetailTable *table;

static int open_table(void **state)
{
    char path[1024];
    (void)state;
    return etc_path(path, sizeof path, "ground_detail.csv") &&
                   detail_table_open(&table, path, detail_cut_off) == STATUS_OK
               ? 0
               : -1;
}

static int close_table(void **state)
{
    (void)state;
    detail_table_close(table);
    return 0;
}

enum { most = 65536 };
static double x_m[most], y_m[most];
static uint8_t class[most];
static float across_m[most], along_m[most], found[detail_fields][most], slope_y[most];

static void ask(int count, double across, double elongation)
{
    const GroundDetail out = {.albedo = found[DETAIL_ALBEDO],
                              .warmth_k = found[DETAIL_WARMTH],
                              .radar = found[DETAIL_RADAR],
                              .slope_x = found[DETAIL_HEIGHT],
                              .slope_y = slope_y};
    for (int n = 0; n < count; n++) across_m[n] = (float)across, along_m[n] = (float)(across * elongation);
    detail_at(&out, table, &bare, count, class, x_m, y_m, &(GroundFootprint){across_m, along_m});
}

static double far_place(int axis, int n) { return 60e3 * (random_uniform(9, (uint32_t)axis, 0, (uint64_t)n) - 0.5); }

/* ---- the plain form ----------------------------------------------------------------------------- */

static uint64_t mixed(uint64_t seed)
{
    uint64_t h = seed;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

static void corner(double value[2], uint32_t key, int64_t i, int64_t j)
{
    uint32_t h = key + (uint32_t)i * 0x9e3779b1u + (uint32_t)j * 0x85ebca77u;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    const double high = (int16_t)(h >> 16), low = (int16_t)(h & 0xffff), unit = sqrt(6) / 65536;
    value[0] = (high + low) * unit, value[1] = (high - low) * unit;
}

static double bump(double t) { return cos(pi_rad / 2 * t * t * (3 - 2 * t)); }

static void plain_octave(double value[2], int n, double x, double y)
{
    const double   turn = (n + 1) * pi_rad * (3 - sqrt(5)), cell_m = 0.08 * pow(2.5, n);
    const double   u = (x * cos(turn) + y * sin(turn)) / cell_m, v = (y * cos(turn) - x * sin(turn)) / cell_m;
    const double   i = floor(u), j = floor(v);
    const uint32_t key = (uint32_t)(mixed(20 + (uint64_t)n) >> 32);
    value[0] = value[1] = 0;
    for (int k = 0; k < 4; k++) {
        double       of[2];
        const double w = bump(k & 1 ? i + 1 - u : u - i) * bump(k & 2 ? j + 1 - v : v - j);
        corner(of, key, (int64_t)i + (k & 1), (int64_t)j + (k >> 1));
        for (int c = 0; c < 2; c++) value[c] += w * of[c];
    }
}

/* At places up to 30 km out; the polynomial sine is within 1.1e-4 of the sine. */
static void eight_at_once_are_the_plain_form(void **state)
{
    (void)state;
    double worst = 0;
    for (int n = 0; n < 4000; n++) {
        x_m[n] = far_place(0, n), y_m[n] = far_place(1, n);
        class[n] = (uint8_t)(1 + n % (SURFACE_COUNT - 1));
    }
    ask(4000, 0, 1);
    for (int n = 0; n < 4000; n++) {
        double octave[detail_octaves][2];
        for (int k = 0; k < detail_octaves; k++) plain_octave(octave[k], k, x_m[n], y_m[n]);
        for (int f = 0; f < DETAIL_HEIGHT; f++) {
            const int            c = class[n];
            const DetailWeights *w = &table->weights[c][0][0];
            double               g = 0, variance = 0;
            for (int k = 0; k < detail_octaves; k++) {
                const double follows = table->statistics[c][f].follows;
                g += (double)w->of[f][k] * (follows * octave[k][0] + sqrt(1 - follows * follows) * octave[k][1]);
                variance += (double)(w->of[f][k] * w->of[f][k]);
            }
            const double plain = g + (double)table->bend[c][f] * (g * g - variance) + (f == DETAIL_WARMTH ? 0 : 1);
            if (table->statistics[c][f].sigma > 0 && plain > 0.1)
                worst = fmax(worst, fabs((double)found[f][n] - plain) / table->statistics[c][f].sigma);
        }
    }
    print_message("worst %.1e of sigma\n", worst);
    CHECK(worst < 2e-3);
}

/* A place's result does not depend on its neighbours in the list: of one class and footprint, or mixed. */
static void company_changes_nothing(void **state)
{
    enum { some = 3000 };
    static float mixed_list[detail_fields][some];
    (void)state;
    for (int n = 0; n < some; n++) {
        x_m[n] = far_place(2, n), y_m[n] = far_place(3, n), class[n] = (uint8_t)(n * 7 % (SURFACE_COUNT + 1));
        across_m[n] = (float)(0.01 * pow(1e5, random_uniform(9, 4, 0, (uint64_t)n)));
        along_m[n] = across_m[n] * (float)(1 + 50 * random_uniform(9, 5, 0, (uint64_t)n));
    }
    GroundDetail out = {.albedo = mixed_list[0],
                        .warmth_k = mixed_list[1],
                        .radar = mixed_list[2],
                        .slope_x = mixed_list[3],
                        .slope_y = slope_y};
    detail_at(&out, table, &bare, some, class, x_m, y_m, &(GroundFootprint){across_m, along_m});
    for (int n = 0; n < some; n++) {
        float              alone[5];
        const GroundDetail one = {
            .albedo = alone, .warmth_k = alone + 1, .radar = alone + 2, .slope_x = alone + 3, .slope_y = alone + 4};
        detail_at(&one, table, &bare, 1, class + n, x_m + n, y_m + n, &(GroundFootprint){across_m + n, along_m + n});
        for (int f = 0; f < detail_fields; f++) CHECK(alone[f] == mixed_list[f][n]);
        CHECK(alone[4] == slope_y[n] && alone[0] > 0 && alone[2] > 0);
        const GroundDetail only = {.radar = alone};
        detail_at(&only, table, &bare, 1, class + n, x_m + n, y_m + n, &(GroundFootprint){across_m + n, along_m + n});
        CHECK(alone[0] == mixed_list[2][n]);
    }
}

/* ---- statistics --------------------------------------------------------------------------------- */

typedef struct Moments {
    double mean, variance, skew;
} Moments;

static Moments moments_of(const float *v, int count)
{
    Moments m = {0};
    double  cube = 0;
    for (int n = 0; n < count; n++) m.mean += (double)v[n] / count;
    for (int n = 0; n < count; n++) {
        const double d = (double)v[n] - m.mean;
        m.variance += d * d / count;
        cube += d * d * d / count;
    }
    m.skew = m.variance > 0 ? cube / (m.variance * sqrt(m.variance)) : 0;
    return m;
}

/* Of every class, unfiltered: 16384 places tens of kilometres apart, and as many at a distance from them. */
static void statistics_are_the_tables(void **state)
{
    enum { places = 8192, lags = 3 };
    double worst_variance = 0, worst_skew = 0, worst_correlation = 0;
    (void)state;
    for (int c = 1; c < SURFACE_COUNT; c++)
        for (int f = 0; f < DETAIL_HEIGHT; f++) {
            const DetailStatistics *s = &table->statistics[c][f];
            memset(class, c, sizeof class);
            for (int n = 0; n < places; n++)
                for (int k = 0; k <= lags; k++) {
                    const double d_m = k ? s->length_m * ldexp(1, k - 2) : 0,
                                 angle = 2 * pi_rad * random_uniform(9, 8, 0, (uint64_t)n);
                    x_m[n + k * places] = far_place(6, n + places * c) + d_m * cos(angle);
                    y_m[n + k * places] = far_place(7, n + places * c) + d_m * sin(angle);
                }
            ask(places * (lags + 1), 0, 1);
            const Moments m = moments_of(found[f], places * (lags + 1));
            worst_variance = fmax(worst_variance, fabs(m.variance / (s->sigma * s->sigma) - 1));
            worst_skew = fmax(worst_skew, fabs(m.skew - s->skew));
            for (int k = 1; k <= lags; k++) {
                const double d_m = s->length_m * ldexp(1, k - 2);
                const double want =
                    (1 - s->far_share) * exp(-d_m / s->length_m) + s->far_share * exp(-d_m / s->far_length_m);
                double sum = 0;
                for (int n = 0; n < places; n++)
                    sum += ((double)found[f][n] - m.mean) * ((double)found[f][n + k * places] - m.mean) / places;
                worst_correlation = fmax(worst_correlation, fabs(sum / m.variance - want));
            }
        }
    print_message("variance within %.1f %%, skew within %.2f, autocorrelation within %.3f\n", 100 * worst_variance,
                  worst_skew, worst_correlation);
    CHECK(worst_variance < 0.07); /* 8192 places: 1.6 % (one deviation); largest of 48 */
    CHECK(worst_skew < 0.2);
    CHECK(worst_correlation < 0.06);
}

/* The mean over a footprint by 16 x 16 places, of two neighbours each way. */
static void filtered_is_the_mean_over_the_footprint(void **state)
{
    enum { places = 2500, side = 16, pixels = 3 };
    static const struct {
        SurfaceClass class;
        double across_m, elongation;
    } tried[] = {{SURFACE_GRASS, 0.15, 1},  {SURFACE_GRASS, 0.6, 1}, {SURFACE_GRASS, 2.5, 1},
                 {SURFACE_GRASS, 0.3, 5},   {SURFACE_GRASS, 1, 3},   {SURFACE_BARE_SOIL, 0.5, 2.5},
                 {SURFACE_SCRUB, 0.9, 1.6}, {SURFACE_ROCK, 1.7, 5}};
    static float mean[DETAIL_HEIGHT][pixels][places], quick[DETAIL_HEIGHT][pixels][places];
    (void)state;
    for (size_t t = 0; t < sizeof tried / sizeof *tried; t++) {
        const double wide[2] = {tried[t].across_m, tried[t].across_m * tried[t].elongation};
        memset(class, tried[t].class, sizeof class);
        for (int p = 0; p < pixels; p++)
            for (int n = 0; n < places; n++) {
                const double angle = 2 * pi_rad * random_uniform(9, 12, 0, (uint64_t)n), c = cos(angle), s = sin(angle);
                const double at[2] = {far_place(10, n), far_place(11, n)};
                for (int k = 0; k < side * side; k++) {
                    const double u = wide[0] * ((k % side + 0.5) / side - 0.5 + (p == 1));
                    const double v = wide[1] * ((k / side + 0.5) / side - 0.5 + (p == 2));
                    x_m[k] = at[0] + c * u - s * v, y_m[k] = at[1] + s * u + c * v;
                }
                ask(side * side, 0, 1);
                for (int f = 0; f < DETAIL_HEIGHT; f++) mean[f][p][n] = (float)moments_of(found[f], side * side).mean;
                x_m[0] = at[0] + c * wide[0] * (p == 1) - s * wide[1] * (p == 2);
                y_m[0] = at[1] + s * wide[0] * (p == 1) + c * wide[1] * (p == 2);
                ask(1, wide[0], tried[t].elongation);
                for (int f = 0; f < DETAIL_HEIGHT; f++) quick[f][p][n] = found[f][0];
            }
        for (int f = 0; f < DETAIL_HEIGHT; f++) {
            const Moments a = moments_of(mean[f][0], places), b = moments_of(quick[f][0], places);
            double        of[2][2] = {{0}};
            for (int p = 1; p < pixels; p++)
                for (int n = 0; n < places; n++) {
                    of[0][p - 1] +=
                        ((double)mean[f][0][n] - a.mean) * ((double)mean[f][p][n] - a.mean) / (places * a.variance);
                    of[1][p - 1] +=
                        ((double)quick[f][0][n] - b.mean) * ((double)quick[f][p][n] - b.mean) / (places * b.variance);
                }
            print_message("class %d %.2f m x %g field %d: variance %.3f, skew %.2f for %.2f, across %.2f for %.2f, "
                          "along "
                          "%.2f for %.2f\n",
                          tried[t].class, tried[t].across_m, tried[t].elongation, f, b.variance / a.variance, b.skew,
                          a.skew, of[1][0], of[0][0], of[1][1], of[0][1]);
            CHECK_NEAR(b.variance / a.variance, 1, 0.10);
            CHECK_NEAR(b.skew, a.skew, fmax(0.25 * fabs(a.skew), 0.15));
            for (int p = 0; p < 2; p++) CHECK_NEAR(of[1][p], of[0][p], 0.10);
        }
    }
}

/* The slopes are those of a height of the table's deviation: summed along a line they give it. */
static void slopes_are_of_the_height(void **state)
{
    enum { lines = 120, steps = 400 };
    static const double step_m = 0.005;
    double              square = 0;
    (void)state;
    memset(class, SURFACE_GRASS, sizeof class);
    for (int line = 0; line < lines; line++) {
        for (int n = 0; n < steps; n++) x_m[n] = far_place(13, line) + step_m * n, y_m[n] = far_place(14, line);
        ask(steps, 0, 1);
        double rise_m = 0;
        for (int n = 0; n < steps; n++) rise_m += step_m * (double)found[DETAIL_HEIGHT][n];
        square += rise_m * rise_m / lines; /* 2 m apart: independent heights */
    }
    const double sigma_m = table->statistics[SURFACE_GRASS][DETAIL_HEIGHT].sigma;
    print_message("rms height %.4f m for %.4f\n", sqrt(square / 2), sigma_m);
    CHECK_NEAR(sqrt(square / 2), sigma_m, 0.2 * sigma_m);
}

/* ---- continuity --------------------------------------------------------------------------------- */

/* Over the borders of cells, over nodes of the footprint, 30 km out; nothing remains at 128 m. */
static void no_seams(void **state)
{
    double worst = 0, worst_size = 0;
    (void)state;
    memset(class, SURFACE_ROCK, sizeof class);
    for (int n = 0; n < 40000; n++) x_m[n] = 30e3 + 1e-4 * n, y_m[n] = -30e3 + 3e-5 * n;
    ask(40000, 0, 1);
    for (int n = 1; n < 40000; n++)
        for (int f = 0; f < detail_fields; f++) worst = fmax(worst, fabs((double)(found[f][n] - found[f][n - 1])));
    for (int n = 0; n < 40000; n++) {
        x_m[n] = 5, y_m[n] = 7, across_m[n] = (float)(0.01 * pow(20000, n / 40000.0)), along_m[n] = across_m[n] * 1.7f;
    }
    const GroundDetail out = {.albedo = found[0], .warmth_k = found[1]};
    detail_at(&out, table, &bare, 40000, class, x_m, y_m, &(GroundFootprint){across_m, along_m});
    for (int n = 1; n < 40000; n++)
        for (int f = 0; f < 2; f++) worst_size = fmax(worst_size, fabs((double)(found[f][n] - found[f][n - 1])));
    print_message("worst step %.1e over 0.1 mm, %.1e over 0.025 %% of the footprint\n", worst, worst_size);
    CHECK(worst < 0.0055 && worst_size < 0.01); /* a rock's slope changes by 1 within 2 cm: by 0.005 over 0.1 mm */
    CHECK(found[0][39999] == 1 && found[1][39999] == 0);
}

static void without_a_table_or_a_place(void **state)
{
    static const double  places[][2] = {{1, 1}, {NAN, 1}, {1, INFINITY}, {1e300, 0}};
    static const uint8_t classes[] = {SURFACE_GRASS, SURFACE_NONE, SURFACE_COUNT, 255};
    static const float   footprints[] = {1, NAN, -1, 0, INFINITY, 1e30f};
    (void)state;
    for (int t = 0; t < 2; t++)
        for (int p = 0; p < 4; p++)
            for (int c = 0; c < 4; c++)
                for (int w = 0; w < 6; w++) {
                    float              of[5] = {9, 9, 9, 9, 9};
                    const GroundDetail out = {of, of + 1, of + 2, of + 3, of + 4};
                    detail_at(&out, t ? table : NULL, &bare, 1, classes + c, &places[p][0], &places[p][1],
                              &(GroundFootprint){footprints + w, footprints + (w + c) % 6});
                    const bool even = of[0] == 1 && of[1] == 0 && of[2] == 1 && of[3] == 0 && of[4] == 0;
                    if (!t || c > 0 || p == 1 || p == 2) CHECK(even);
                    for (int k = 0; k < 5; k++) CHECK(isfinite(of[k]));
                }
}

/* ---- the file ----------------------------------------------------------------------------------- */

static void bad_tables_are_refused(void **state)
{
    static const char head[] = "surface,field,sigma,length_m,far_share,far_length_m,skew,follows_albedo,source\n";
    static const char *const rows[] = {"",
                                       "grass,albedo,2,1,0,1,0,1,x\n",
                                       "grass,albedo,0.1,0,0,1,0,1,x\n",
                                       "grass,height,0.06,1,0,1,0,1,x\n",
                                       "grass,albedo,0.1,1,0,1,0,0.5,x\n",
                                       "moss,albedo,0.1,1,0,1,0,1,x\n",
                                       "grass,smell,0.1,1,0,1,0,1,x\n",
                                       "grass,albedo,0.1,1,0,1,0,1,x\ngrass,albedo,0.1,1,0,1,0,1,x\n",
                                       "grass,albedo,nan,1,0,1,0,1,x\n"};
    (void)state;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char         path[text_file_size], text[1024];
        DetailTable *none = NULL;
        snprintf(text, sizeof text, "%s%s", head, rows[k]);
        text_file(path, text);
        CHECK(detail_table_open(&none, path, detail_cut_off) == STATUS_BAD_VALUE && !none);
        remove(path);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eight_at_once_are_the_plain_form), cmocka_unit_test(company_changes_nothing),
        cmocka_unit_test(statistics_are_the_tables),        cmocka_unit_test(filtered_is_the_mean_over_the_footprint),
        cmocka_unit_test(slopes_are_of_the_height),         cmocka_unit_test(no_seams),
        cmocka_unit_test(without_a_table_or_a_place),       cmocka_unit_test(bad_tables_are_refused),
    };
    return cmocka_run_group_tests(tests, open_table, close_table);
}
