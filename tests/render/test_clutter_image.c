/* Ground clutter in a spotlight image: a phase history of scatterers and a point, by distances alone, focused by plain
 * backprojection. The image must read sigma0 back, show a shadow as dark, and focus the point. labels: physics */
#include "tests/check.h"
#include "render/scattering/clutter/clutter.h"

static const double c_mps = 299792458.0, carrier_hz = 16e9, psi = 0.5, range_m = 2000, cell_m = 0.5;

enum { pulses = 96, tones = 96, side_cells = 160, scatterers = side_cells * side_cells, image = 64 };

static double complex history[pulses][tones];
static double         antenna[pulses][3], wave[tones] /* 2 k */, weight[tones];

/* An arc about the origin, wide enough for cells of half a metre both ways, and Hann's window both ways. */
static double lay_out(double *step_rad, double *step_hz)
{
    *step_hz = c_mps / (2 * cell_m * cos(psi)) / tones;
    *step_rad = c_mps / carrier_hz / (2 * cell_m * cos(psi)) / pulses;
    double sum = 0, square = 0;
    for (int i = 0; i < pulses; i++) {
        const double azimuth = (i - 0.5 * (pulses - 1)) * *step_rad;
        antenna[i][0] = range_m * cos(psi) * sin(azimuth);
        antenna[i][1] = range_m * cos(psi) * cos(azimuth);
        antenna[i][2] = range_m * sin(psi);
    }
    for (int n = 0; n < tones; n++) {
        wave[n] = 4 * pi_rad * (carrier_hz + (n - 0.5 * (tones - 1)) * *step_hz) / c_mps;
        weight[n] = 0.5 - 0.5 * cos(2 * pi_rad * (n + 0.5) / tones);
        sum += weight[n], square += weight[n] * weight[n];
    }
    return square / (sum * sum);
}

static double beyond(int pulse, const double p[3])
{
    double d[3];
    v3_sub(d, antenna[pulse], p);
    return v3_length(d) - range_m;
}

static void add_echo(int pulse, const double p[3], double complex s)
{
    const double   path_m = beyond(pulse, p);
    double complex z = s * cexp(-I * wave[0] * path_m), turn = cexp(-I * (wave[1] - wave[0]) * path_m);
    for (int n = 0; n < tones; n++) {
        history[pulse][n] += z;
        z = CMPLX(creal(z) * creal(turn) - cimag(z) * cimag(turn), creal(z) * cimag(turn) + cimag(z) * creal(turn));
    }
}

/* Cross section that the image shows at a place, m^2. */
static double focus(double x_m, double y_m)
{
    const double   p[3] = {x_m, y_m, 0};
    double complex sum = 0;
    double         weights = 0;
    for (int i = 0; i < pulses; i++) {
        const double   path_m = beyond(i, p);
        double complex z = cexp(I * wave[0] * path_m), turn = cexp(I * (wave[1] - wave[0]) * path_m), line = 0;
        for (int n = 0; n < tones; n++) {
            const double re = weight[n] * creal(history[i][n]), im = weight[n] * cimag(history[i][n]);
            line += CMPLX(re * creal(z) - im * cimag(z), re * cimag(z) + im * creal(z));
            z = CMPLX(creal(z) * creal(turn) - cimag(z) * cimag(turn), creal(z) * cimag(turn) + cimag(z) * creal(turn));
        }
        sum += weight[i] * line;
        weights += weight[i];
    }
    sum /= weights * weights;
    return 4 * pi_rad * (creal(sum) * creal(sum) + cimag(sum) * cimag(sum));
}

static bool in_shadow(const double p[2]) { return p[0] > 4 && p[0] < 12 && p[1] > -12 && p[1] < -4; }

static const double point[3] = {-5.3, 6.1, 0}, point_m2 = 100;

static void collect(const ClutterTable *table, uint64_t seed, SurfaceClass ground_class, bool with_point)
{
    static ClutterCell      cell[scatterers];
    static ClutterScatterer scatterer[scatterers];
    static ScatterMatrix    seen[scatterers];
    static uint8_t          surface[scatterers];
    static double           p[3][scatterers];
    static float            n[3][scatterers];
    const ClutterGrid       grid = {0.25, seed};
    const double            low[2] = {-20, -20}, high[2] = {20, 20};
    int                     count = 0;
    CHECK(clutter_cells(cell, scatterers, &grid, 0, low, high) == scatterers);
    for (int i = 0; i < scatterers; i++) {
        double centre[2];
        clutter_centre(centre, &grid, &cell[i]);
        if (!in_shadow(centre)) cell[count++] = cell[i];
    }
    for (int i = 0; i < count; i++) {
        double place[2];
        clutter_place(place, &grid, &cell[i]);
        p[0][i] = place[0], p[1][i] = place[1], n[2][i] = 1;
        surface[i] = (uint8_t)ground_class;
    }
    clutter_draw(scatterer, &grid, table, CLUTTER_KU, count, cell, surface);
    memset(history, 0, sizeof history);
    const ClutterGround ground = {count, cell, surface, {p[0], p[1], p[2]}, {n[0], n[1], n[2]}};
    for (int i = 0; i < pulses; i++) {
        ClutterLook look = {.frequency_hz = carrier_hz, .t_s = 1000 + 0.01 * i, .wind_mps = 10};
        memcpy(look.antenna_enu, antenna[i], sizeof look.antenna_enu);
        clutter_see(seen, &grid, table, scatterer, &ground, &look);
        for (int k = 0; k < count; k++) add_echo(i, (double[3]){p[0][k], p[1][k], p[2][k]}, seen[k].vv);
        if (with_point) add_echo(i, point, sqrt(point_m2 / (4 * pi_rad)));
    }
}

static bool is_dark(const double p[2]) { return p[0] > 6 && p[0] < 10 && p[1] > -10 && p[1] < -6; }

static double db(double ratio) { return 10 * log10(ratio); }

static void an_image_reads_sigma0_and_focuses(void **state)
{
    (void)state;
    static ClutterTable table;
    char                path[512];
    double              step_rad, step_hz;
    CHECK(etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&table, path) == STATUS_OK);
    table.row[SURFACE_BARE_SOIL][CLUTTER_KU].nu = INFINITY; /* the mean of a thousand cells, to 0.1 dB */
    const double noise = lay_out(&step_rad, &step_hz);
    /* the point response's equivalent area, by Parseval over one period of range and cross-range */
    const double range_period_m = c_mps / (2 * step_hz * cos(psi));
    const double cross_period_m = c_mps / carrier_hz / (2 * step_rad * cos(psi));
    const double area_m2 = noise * noise * range_period_m * cross_period_m;
    const double sigma0 = table.row[SURFACE_BARE_SOIL][CLUTTER_KU].gamma * sin(psi);

    double sum = 0, dark = 0;
    int    lit = 0, shadowed = 0;
    for (uint64_t seed = 31; seed < 33; seed++) {
        collect(&table, seed, SURFACE_BARE_SOIL, false);
        for (int y = 0; y < image; y++)
            for (int x = 0; x < image; x++) {
                const double p[2] = {(x - 31.5) * cell_m, (y - 31.5) * cell_m}, m2 = focus(p[0], p[1]);
                if (is_dark(p)) dark += m2, shadowed++;
                else if (!(p[0] > 2 && p[0] < 14 && p[1] > -14 && p[1] < -2)) sum += m2, lit++;
            }
    }
    printf("sigma0 in the image %.2f dB, put in %.2f dB; shadow %.1f dB below\n", db(sum / lit / area_m2), db(sigma0),
           db(sum / lit * shadowed / dark));
    CHECK_NEAR(db(sum / lit / area_m2), db(sigma0), 0.3);
    CHECK(dark / shadowed < 0.003 * sum / lit);

    collect(&table, 33, SURFACE_BARE_SOIL, true);
    const double peak = focus(point[0], point[1]);
    double       most = 0, best[2] = {0, 0};
    for (int k = 0; k < 81; k++) {
        const double x = point[0] + 0.1 * (k % 9 - 4), y = point[1] + 0.1 * (k / 9 - 4), m2 = focus(x, y);
        if (m2 > most) most = m2, best[0] = x, best[1] = y;
    }
    printf("point of %.1f dBsm: %.2f dBsm, largest at %.2f %.2f m from it, %.1f dB above the clutter\n", db(point_m2),
           db(peak), best[0] - point[0], best[1] - point[1], db(peak / (sum / lit)));
    CHECK_NEAR(db(peak), db(point_m2), 0.2);
    CHECK_NEAR(best[0], point[0], 1e-9);
    CHECK_NEAR(best[1], point[1], 1e-9);
    /* half width of Hann's window: 0.72 of a cell */
    for (int a = 0; a < 2; a++) {
        double at = 0;
        while (focus(point[0] + (a == 0) * at, point[1] + (a == 1) * at) > 0.5 * peak && at < 2) at += 0.005;
        printf("half width %.3f cells\n", at / cell_m);
        CHECK_NEAR(at / cell_m, 0.72, 0.04);
    }
}

/* What keeps no phase fills the shadow: scrub in wind. The shadow above is dark because the ground keeps its own. */
static void moving_foliage_fills_a_shadow(void **state)
{
    (void)state;
    static ClutterTable table;
    char                path[512];
    double              step_rad, step_hz, dark = 0, lit = 0;
    CHECK(etc_path(path, sizeof path, "radar/clutter.csv") && clutter_table_open(&table, path) == STATUS_OK);
    (void)lay_out(&step_rad, &step_hz);
    collect(&table, 34, SURFACE_SCRUB, false);
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 8; x++) {
            const double p[2] = {6.25 + x * cell_m, -9.75 + y * cell_m};
            if (is_dark(p)) dark += focus(p[0], p[1]), lit += focus(p[0] - 12, p[1]);
        }
    printf("shadow in moving scrub %.1f dB below\n", db(lit / dark));
    CHECK(dark > 0.03 * lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(an_image_reads_sigma0_and_focuses),
                                       cmocka_unit_test(moving_foliage_fills_a_shadow)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
