/* Ground clutter: its distributions against closed forms, its correlations over aspect, time and polarisation, and
 * what does not depend on order or level. Seeds are fixed; each bound is 4 standard errors of the exact
 * distribution, or the 1 % point of Kolmogorov and Smirnov. labels: physics */
#include "tests/render/clutter_stage.h"

/* ---- distributions ------------------------------------------------------------------------------------ */

/* K_nu(z) = integral of exp(-z cosh t) cosh(nu t): the trapezium rule is exact to rounding (error exp(-pi^2 /
 * step)), as the integrand dies doubly exponentially. */
static double bessel_k(double nu, double z)
{
    const double step = 0.2;
    double       sum = 0.5 * exp(-z);
    for (int i = 1; z * cosh(step * i) - nu * step * i < 40; i++) sum += exp(-z * cosh(step * i)) * cosh(nu * step * i);
    return step * sum;
}

/* Share of intensities of mean 1 below x: K-distributed of shape nu, or exponential. */
static double share_below(double nu, double x)
{
    if (isinf(nu)) return 1 - exp(-x);
    return 1 - 2 * pow(nu * x, 0.5 * nu) * bessel_k(nu, 2 * sqrt(nu * x)) / tgamma(nu);
}

static double moment(double nu, int n)
{
    return tgamma(n + 1) * (isinf(nu) ? 1 : exp(lgamma(nu + n) - lgamma(nu) - n * log(nu)));
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void check_distribution(double *intensity, int count, double nu)
{
    for (int n = 1; n <= 4; n++) {
        double sum = 0;
        for (int i = 0; i < count; i++) sum += pow(intensity[i], n);
        const double want = moment(nu, n), error = sqrt((moment(nu, 2 * n) - want * want) / count);
        printf("nu %g: moment %d %.4f of %.4f, %.2f standard errors\n", nu, n, sum / count, want,
               (sum / count - want) / error);
        CHECK_NEAR(sum / count, want, 4 * error);
    }
    qsort(intensity, (size_t)count, sizeof *intensity, ascending);
    double most = 0;
    for (int i = 0; i < count; i++) {
        const double share = share_below(nu, intensity[i]);
        most = fmax(most, fmax(share - (double)i / count, (double)(i + 1) / count - share));
    }
    printf("nu %g: Kolmogorov-Smirnov D sqrt(n) = %.3f\n", nu, most * sqrt(count));
    CHECK(most * sqrt(count) < 1.6276); /* 1 % */
}

/* Intensities over their mean of single cells four nodes of the texture apart, so that they are independent. */
static void intensities_are_distributed_as_stated(void **state)
{
    (void)state;
    enum { across = 240, count = across * across };
    CHECK_NEAR(bessel_k(0.5, 2), sqrt(pi_rad / 4) * exp(-2), 1e-14);
    CHECK_NEAR(bessel_k(1.5, 2), sqrt(pi_rad / 4) * exp(-2) * 1.5, 1e-14);
    static const double shapes[] = {INFINITY, 8, 3, 1, 0.5};
    static double       intensity[count];
    ClutterRow          kept = table.row[SURFACE_GRASS][CLUTTER_KU];
    for (int k = 0; k < 5; k++) {
        /* the row of a class with this shape, from a file: its texture comes with it */
        char   path[text_file_size], *text = NULL;
        size_t size;
        FILE  *to = open_memstream(&text, &size);
        CHECK(to);
        fputs("surface,band,model,gamma_db,a,b,c,d,roughness_mm,nu,texture_m,hh_vv_db,hv_vv_db,rho,motion,still,"
              "extent_mm,foliage_db_m,source\n",
              to);
        for (int s = 1; s < SURFACE_COUNT; s++)
            for (int b = 0; b < CLUTTER_BAND_COUNT; b++)
                fprintf(to, "%s,%s,gamma,-14,,,,,20,%g,10,0,-8,0.6,0.7,3,5,0,test\n", surface_name((SurfaceClass)s),
                        clutter_band_name((ClutterBand)b), isinf(shapes[k]) ? 0 : shapes[k]);
        fclose(to);
        text_file(path, text);
        ClutterTable made;
        CHECK(clutter_table_open(&made, path) == STATUS_OK);
        remove(path);
        free(text);
        table.row[SURFACE_GRASS][CLUTTER_KU] = made.row[SURFACE_GRASS][CLUTTER_KU];

        Stage *s = stage(count, SURFACE_GRASS, 1, 11);
        for (int i = 0; i < count; i++)
            s->cell[i] = (ClutterCell){40 * (i % across) - 5000, 40 * (i / across) - 5000, 0};
        stage_place(s);
        stage_draw(s, CLUTTER_KU);
        ClutterLook look = look_from(0.4, 0.5, ku_hz);
        look.wind_mps = 5, look.t_s = 100;
        see(s, &look);
        const double mean = pow(10, -1.4) * sin(0.5); /* from the file's figure: sigma0 of a cell of 1 m^2 */
        for (int i = 0; i < count; i++) intensity[i] = 4 * pi_rad * power(s->seen[i].vv) / mean;
        check_distribution(intensity, count, shapes[k]);
        stage_free(s);
    }
    table.row[SURFACE_GRASS][CLUTTER_KU] = kept;
}

/* ---- correlations -------------------------------------------------------------------------------------- */

/* Complex correlation of VV between the last look and what is kept. */
static double complex correlation(const ScatterMatrix *a, const ScatterMatrix *b, int count)
{
    double complex sum = 0;
    double         pa = 0, pb = 0;
    for (int i = 0; i < count; i++) {
        sum += a[i].vv * conj(b[i].vv);
        pa += power(a[i].vv), pb += power(b[i].vv);
    }
    return sum / sqrt(pa * pb);
}

/* Transform of the exponential spectrum, by quadrature: the still line and beta / 2 exp(-beta |v|). */
static double from_spectrum(double still, double spread_mps, double lag_s, double wavelength_m)
{
    const double step = spread_mps / 400;
    double       sum = 0;
    for (int i = 0; i < 16000; i++) {
        const double v = (i + 0.5) * step;
        sum += step / spread_mps * exp(-v / spread_mps) * cos(4 * pi_rad * v * lag_s / wavelength_m);
    }
    return still + (1 - still) * sum;
}

static void motion_has_its_spectrum(void **state)
{
    (void)state;
    enum { count = 40000 };
    static ScatterMatrix before[count];
    Stage               *s = stage(count, SURFACE_FOREST_BROADLEAF, 1, 12);
    for (int i = 0; i < count; i++) s->cell[i] = (ClutterCell){25 * (i % 200), 25 * (i / 200), 0};
    stage_place(s);
    stage_draw(s, CLUTTER_KA);
    ClutterLook look = look_from(0, 0.3, ka_hz);
    look.t_s = 7;
    see(s, &look);
    memcpy(before, s->seen, sizeof before);
    look.t_s = 1234567.8;
    see(s, &look);
    CHECK(memcmp(before, s->seen, sizeof before) == 0); /* no wind: the same cell, the same phase */

    static const double winds[] = {2, 8}, lags[] = {1e-4, 1e-3, 3e-3, 1e-2, 0.1, 10};
    for (int w = 0; w < 2; w++) {
        look.wind_mps = winds[w];
        /* by hand: 8 m/s is 17.9 mph */
        const double mph = winds[w] / 0.44704, spread_mps = 0.1048 * (log10(mph) + 0.4147);
        const double ratio = 489.8 * pow(mph, -1.55) * pow(35, -1.21);
        for (int k = 0; k < 6; k++) {
            look.t_s = 1e6;
            see(s, &look);
            memcpy(before, s->seen, sizeof before);
            look.t_s = 1e6 + lags[k];
            see(s, &look);
            const double         lag_s = look.t_s - 1e6;
            const double         want = from_spectrum(ratio / (1 + ratio), spread_mps, lag_s, c_mps / ka_hz);
            const double complex got = correlation(before, s->seen, count);
            printf("wind %g m/s, lag %g s: %.4f, want %.4f\n", winds[w], lags[k], creal(got), want);
            /* of 40000 with the texture's weights, <tau^2> = 1 + 1/3 */
            CHECK_NEAR(creal(got), want, 4 * sqrt(1.34 / count));
            CHECK_NEAR(cimag(got), 0, 4 * sqrt(1.34 / count));
        }
    }
    stage_free(s);
}

/* The array factor of a cell of resolution: sin(x) / x with its first zero at lambda / (2 extent). */
static void aspect_decorrelates_a_resolution_cell(void **state)
{
    (void)state;
    enum { across = 8, each = across * across, cells = 4000, count = each * cells };
    static ScatterMatrix before[cells], after[cells];
    const double         side_m = 0.25, extent_m = across * side_m, wavelength_m = c_mps / ka_hz;
    Stage               *s = stage(count, SURFACE_BARE_SOIL, side_m, 13);
    for (int i = 0; i < count; i++) {
        const int block = i / each, within = i % each;
        s->cell[i] = (ClutterCell){block % 50 * 40 + within % across, block / 50 * 40 + within / across, 0};
    }
    stage_place(s);
    stage_draw(s, CLUTTER_KA);
    for (int k = 0; k <= 5; k++) {
        const double turn = k < 5 ? 0.3 * k * wavelength_m / (2 * extent_m) : wavelength_m / (2 * extent_m);
        for (int side = 0; side < 2; side++) {
            const double psi = 0.2, azimuth = (side ? 0.5 : -0.5) * turn / cos(psi);
            ClutterLook  look = look_from(azimuth, psi, ka_hz);
            see(s, &look);
            ScatterMatrix *sum = side ? after : before;
            memset(sum, 0, sizeof before);
            for (int i = 0; i < count; i++) {
                const double path_m = -2 * (cos(psi) * (sin(azimuth) * (s->p[0][i] - s->p[0][i / each * each]) +
                                                        cos(azimuth) * (s->p[1][i] - s->p[1][i / each * each])));
                sum[i / each].vv += s->seen[i].vv * cexp(-I * 2 * pi_rad / wavelength_m * path_m);
            }
            /* the phase centre: the middle of each cell, not its first scatterer */
            for (int b = 0; b < cells; b++) {
                const double x = s->p[0][b * each] - (s->cell[b * each].x * side_m + 0.5 * extent_m);
                sum[b].vv *= cexp(I * 4 * pi_rad / wavelength_m * cos(psi) * sin(azimuth) * x);
            }
        }
        const double         x = 2 * pi_rad / wavelength_m * extent_m * turn;
        const double         own = exp(-8 * pow(pi_rad * 0.010 * turn / wavelength_m, 2)); /* 10 mm: bare_soil */
        const double         want = own * (x > 0 ? sin(x) / x : 1);
        const double complex got = correlation(before, after, cells);
        printf("turn %.2f lambda/(2 extent): %.3f, want %.3f\n", turn * 2 * extent_m / wavelength_m, creal(got), want);
        CHECK_NEAR(creal(got), want, k ? 4 / sqrt(cells) : 1e-12);
        CHECK_NEAR(cimag(got), 0, 4 / sqrt(cells));
    }
    stage_free(s);
}

/* One scatterer's own: a Gaussian in the change of direction, of its extent. */
static void aspect_decorrelates_a_scatterer(void **state)
{
    (void)state;
    enum { count = 40000 };
    static ScatterMatrix before[count];
    Stage               *s = stage(count, SURFACE_ROCK, 1, 14);
    for (int i = 0; i < count; i++) s->cell[i] = (ClutterCell){10 * (i % 200), 10 * (i / 200), 0};
    stage_draw(s, CLUTTER_KA);
    ClutterLook look = look_from(0, 0.3, ka_hz);
    see(s, &look); /* all at the origin: one direction */
    memcpy(before, s->seen, sizeof before);
    for (int k = 1; k <= 4; k++) {
        look = look_from(0.01 * k, 0.3, ka_hz);
        see(s, &look);
        const double du = 2 * sin(0.005 * k) * cos(0.3), want = exp(-8 * pow(pi_rad * 0.020 * du / (c_mps / ka_hz), 2));
        const double complex got = correlation(before, s->seen, count);
        printf("turn %g rad: %.4f, want %.4f\n", 0.01 * k, creal(got), want);
        CHECK_NEAR(creal(got), want, 4 * sqrt(1.5 / count)); /* nu 2 */
    }
    stage_free(s);
}

static void polarisations_correlate_as_stated(void **state)
{
    (void)state;
    enum { count = 90000 };
    const SurfaceClass classes[] = {SURFACE_ROAD, SURFACE_FOREST_CONIFER, SURFACE_BARE_SOIL};
    for (int k = 0; k < 3; k++) {
        const ClutterRow *row = &table.row[classes[k]][CLUTTER_KU];
        Stage            *s = stage(count, classes[k], 1, 15);
        for (int i = 0; i < count; i++) s->cell[i] = (ClutterCell){20 * (i % 300), 20 * (i / 300), 0};
        stage_place(s);
        stage_draw(s, CLUTTER_KU);
        ClutterLook look = look_from(1, 0.6, ku_hz);
        look.wind_mps = 4, look.t_s = 3;
        see(s, &look);
        double         hh = 0, vv = 0, hv = 0;
        double complex co = 0, cross = 0, cross_v = 0;
        for (int i = 0; i < count; i++) {
            CHECK(s->seen[i].hv == s->seen[i].vh);
            hh += power(s->seen[i].hh), vv += power(s->seen[i].vv), hv += power(s->seen[i].hv);
            co += s->seen[i].hh * conj(s->seen[i].vv);
            cross += s->seen[i].hh * conj(s->seen[i].hv), cross_v += s->seen[i].vv * conj(s->seen[i].hv);
        }
        const double         more = 1 + 1 / row->nu, se = sqrt(more / count);
        const double complex rho = co / sqrt(hh * vv);
        printf("%s: rho %.3f of %.3f, hh/vv %.3f of %.3f, hv/vv %.3f of %.3f\n", surface_name(classes[k]), creal(rho),
               row->rho, hh / vv, row->hh, hv / vv, row->hv);
        CHECK_NEAR(creal(rho), row->rho, 4 * se);
        CHECK_NEAR(cimag(rho), 0, 4 * se);
        CHECK(cabs(cross / sqrt(hh * hv)) < 4 * se && cabs(cross_v / sqrt(vv * hv)) < 4 * se);
        CHECK_NEAR(hh / vv / row->hh, 1, 4 * se * sqrt(2 * (1 - row->rho * row->rho)) + 1e-12);
        CHECK_NEAR(hv / vv / row->hv, 1, 4 * se * sqrt(2));
        CHECK_NEAR(4 * pi_rad * vv / count / (row->gamma * sin(0.6)), 1, 4 * sqrt((2 * more - 1) / count));
        stage_free(s);
    }
}

/* ---- cells and levels ---------------------------------------------------------------------------------- */

static void neighbours_and_levels_are_independent(void **state)
{
    (void)state;
    enum { across = 200, count = across * across };
    static ScatterMatrix     before[count];
    static const ClutterCell beside[] = {{1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, 2}};
    Stage                   *s = stage(count, SURFACE_SAND, 1, 16);
    for (int k = -1; k < 6; k++) {
        for (int i = 0; i < count; i++) {
            s->cell[i] = (ClutterCell){i % across - 100, i / across - 100, 0};
            if (k >= 0) s->cell[i].x += beside[k].x, s->cell[i].y += beside[k].y, s->cell[i].level = beside[k].level;
        }
        stage_place(s);
        stage_draw(s, CLUTTER_W);
        for (int i = 0; i < count; i++) s->p[0][i] = s->p[1][i] = 0;
        const ClutterLook look = look_from(2, 0.3, 94e9);
        see(s, &look);
        if (k < 0) memcpy(before, s->seen, sizeof before);
        else CHECK(cabs(correlation(before, s->seen, count)) < 4 * sqrt(1.1 / count));
    }
    stage_free(s);
}

/* Share of the variance of a field of correlation exp(-d^2) that its mean over a square keeps: by quadrature. */
static double kept_by_mean(double side)
{
    double sum = 0;
    for (int i = 0; i < 20000; i++) {
        const double d = side * (i + 0.5) / 20000;
        sum += 2 * (1 - d / side) * exp(-d * d) / 20000;
    }
    return sum * sum;
}

/* Means of the texture over blocks of 16 nodes vary alike at every level, also where cells are longer than the
 * texture: as the field's, but for the edges of the blocks. One place a cell, of cells 4 nodes long, would vary 6
 * times as much. */
static void levels_keep_the_variance_of_means(void **state)
{
    (void)state;
    enum { across = 4096, block = 64, blocks = across / block };
    const ClutterRow *row = &table.row[SURFACE_GRASS][CLUTTER_KU];
    const ClutterGrid grid = {2, 21};
    for (int level = 1; level < 4; level++) {
        const int side_m = (int)clutter_side(&grid, level), each = block / side_m;
        double    square = 0;
        for (int b = 0; b < blocks * blocks; b++) {
            double sum = 0;
            for (int i = 0; i < each * each; i++) {
                const ClutterCell cell = {b % blocks * each + i % each, b / blocks * each + i / each, level};
                double            p_m[2];
                clutter_place(p_m, &grid, &cell);
                sum += clutter_texture_at(&grid, row, level, p_m) - 1;
            }
            square += sum * sum / (each * each) / (each * each);
        }
        const double variance = square / (blocks * blocks) * row->nu;
        printf("cells of %d nodes: variance of a block's mean %.5f\n", side_m / 4, variance);
        const double cell = side_m / 4.0, field = pi_rad / (cell * cell), within = 1 - kept_by_mean(cell);
        /* a place a cell: the field's, and what is within a cell over their number; 2.2 % is a standard error */
        const double want = field / (field + within) * (kept_by_mean(16) + within / (each * each));
        CHECK_NEAR(variance / want, 1, 0.09);
        CHECK_NEAR(variance / kept_by_mean(16), 1, 0.15);
    }
}

/* Correlation of the texture along one axis: of the lattice's weights, over even places between nodes. */
static double weight_at(double place, int node)
{
    double square = 0;
    for (int k = (int)floor(place) - 1; k <= (int)floor(place) + 2; k++) square += exp(-4 * (place - k) * (place - k));
    const int near = (int)floor(place);
    return node < near - 1 || node > near + 2 ? 0 : exp(-2 * (place - node) * (place - node)) / sqrt(square);
}

static void texture_correlates_over_its_length(void **state)
{
    (void)state;
    enum { count = 40000 };
    static const double lags[] = {0, 0.25, 0.5, 1, 1.5, 4};
    const ClutterRow   *row = &table.row[SURFACE_GRASS][CLUTTER_KU];
    const ClutterGrid   grid = {0.1, 19};
    for (int k = 0; k < 6; k++) {
        double sum = 0, square = 0, want = 0;
        for (int i = 0; i < count; i++) {
            const double x = row->texture_m * (9 * (i % 200) + random_uniform(3, 1, 0, (uint64_t)i));
            const double y = row->texture_m * 5 * (i / 200);
            const double a = clutter_texture_at(&grid, row, 0, (double[2]){x, y}) - 1;
            const double b = clutter_texture_at(&grid, row, 0, (double[2]){x + lags[k] * row->texture_m, y}) - 1;
            sum += a * b, square += 0.5 * (a * a + b * b);
        }
        for (int i = 0; i < 1000; i++)
            for (int node = -1; node <= 7; node++)
                want += 1e-3 * weight_at((i + 0.5) / 1000, node) * weight_at((i + 0.5) / 1000 + lags[k], node);
        printf("texture at %.2f nodes: %.3f, of the deviates %.3f, exp(-lag^2) %.3f\n", lags[k], sum / square, want,
               exp(-lags[k] * lags[k]));
        CHECK_NEAR(want, exp(-lags[k] * lags[k]), 0.02);
        /* the gamma of nu 8 is not far from normal: its correlation is within 0.02 of that of the deviates */
        CHECK_NEAR(sum / square, want, 0.02 + 4 / sqrt(count));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intensities_are_distributed_as_stated),
        cmocka_unit_test(motion_has_its_spectrum),
        cmocka_unit_test(aspect_decorrelates_a_resolution_cell),
        cmocka_unit_test(aspect_decorrelates_a_scatterer),
        cmocka_unit_test(polarisations_correlate_as_stated),
        cmocka_unit_test(neighbours_and_levels_are_independent),
        cmocka_unit_test(levels_keep_the_variance_of_means),
        cmocka_unit_test(texture_correlates_over_its_length),
    };
    return cmocka_run_group_tests(tests, open_table, NULL);
}
