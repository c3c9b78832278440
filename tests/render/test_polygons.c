/* Flat faces in closed form against answers from elsewhere: a plate's formula, direct integrals over a triangle and
 * near a plate, Fresnel's coefficients. Each figure reached is printed. labels: physics */
#include "tests/render/polygon_stage.h"

/* Gauss's rule of 3 points on 0 .. 1 */
static const double at[3] = {0.1127016653792583, 0.5, 0.8872983346207417}, weight[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};

/* ---- the closed form ----------------------------------------------------------------------------------- */

/* Mean of exp(-j x) over a triangle, by Gauss's rule of 3 points on fine strips in both directions. */
static double complex mean_directly(const double x[3])
{
    enum { cuts = 120 };
    double complex sum = 0;
    for (int i = 0; i < cuts; i++)
        for (int p = 0; p < 3; p++) {
            const double   u = (i + at[p]) / cuts;
            double complex strip = 0;
            for (int j = 0; j < cuts; j++)
                for (int q = 0; q < 3; q++) {
                    const double v = (1 - u) * (j + at[q]) / cuts;
                    strip += weight[q] / cuts * cexp(-I * (x[0] + u * (x[1] - x[0]) + v * (x[2] - x[0])));
                }
            sum += 2 * weight[p] / cuts * (1 - u) * strip;
        }
    return sum;
}

static void closed_form_is_the_mean(void **state)
{
    (void)state;
    static const double spread[] = {0, 1e-9, 1e-5, 1e-3, 0.1, 0.12, 0.2, 0.26, 1, 5, 20};
    double              worst = 0, seam = 0;
    for (size_t i = 0; i < sizeof spread / sizeof *spread; i++)
        for (int kind = 0; kind < 5; kind++) { /* two corners alike; one almost between; any */
            const double middle = hand_uniform(-3, 3), half = 0.5 * spread[i];
            const double b = kind == 0 ? half : kind == 1 ? -half : kind == 2 ? 1e-7 : hand_uniform(-half, half);
            const double x[3] = {middle - half, middle + half, middle + b};
            const double complex got = polygon_mean(x);
            worst = fmax(worst, cabs(got - mean_directly(x)));
            for (int turn = 1; turn < 3; turn++) {
                const double turned[3] = {x[turn], x[(turn + 1) % 3], x[(turn + 2) % 3]};
                worst = fmax(worst, cabs(got - polygon_mean(turned)));
            }
        }
    for (int i = 0; i < 100; i++) { /* where the series ends */
        const double b = hand_uniform(0, 0.25), x[3] = {0, 0.25, b}, y[3] = {0, 0.25 * (1 + 1e-15), b};
        seam = fmax(seam, cabs(polygon_mean(x) - polygon_mean(y)));
    }
    printf("mean over a triangle: within %.1e; series and closed form %.1e apart\n", worst, seam);
    CHECK(worst <= 2e-12 && seam <= 2e-14);
}

/* ---- a plate ------------------------------------------------------------------------------------------- */

static const double plate_m[2] = {0.3, 0.2};

/* Physical optics of the plate across x for one antenna at infinity, over the cosine. */
static double complex plate_form(const double u[3], double k)
{
    const double shape = scatter_sinc(k * plate_m[0] * u[1]) * scatter_sinc(k * plate_m[1] * u[2]);
    return -I * k / (2 * pi_rad) * plate_m[0] * plate_m[1] * shape;
}

static void a_plate_is_its_closed_form(void **state)
{
    (void)state;
    for (int band = 0; band < 2; band++) {
        const double hz = band ? w_hz : x_hz, k = 2 * pi_rad * hz / light_mps, normal[3] = {1, 0, 0};
        double       worst = 0;
        RadarStage   s;
        stage_open(&s, "plate:0.3x0.2", hz);
        const double peak = cabs(plate_form(normal, k));
        for (int i = 0; i < 200; i++) {
            const ScatterAntenna a = antenna_at(i ? hand_uniform(-88, 88) : 0, i ? hand_uniform(-70, 70) : 0, INFINITY);
            const ScatterMatrix  m = look(&s, &a, &a, polygon_faces_few);
            const double complex want = a.u[0] * plate_form(a.u, k);
            CHECK(field.hits.count == 0 && field.hits.rays == 0 && field.polygons.all);
            worst = fmax(worst, fmax(cabs(m.hh - want), cabs(m.vv - want)) / peak);
            worst = fmax(worst, fmax(cabs(m.hv), cabs(m.vh)) / peak);
        }
        printf("plate at %g GHz: within %.0f dB of the peak's amplitude, %lld rays a look\n", 1e-9 * hz,
               2 * decibels(worst), field.polygons.rays);
        CHECK(worst <= 1e-9 && field.polygons.rays < 1000);
        close_stage(&s);
    }
}

/* Of one antenna at a point: (range / distance)^2 cosine exp(-j k path) over the plate, Gauss's 3 points a cell. */
static double complex plate_directly(const double antenna[3], double range_m, double k)
{
    const double   cell_m = 2 * pi_rad / k / 3;
    const int      cells[2] = {(int)ceil(plate_m[0] / cell_m), (int)ceil(plate_m[1] / cell_m)};
    double complex sum = 0;
    for (int i = 0; i < 3 * cells[0]; i++)
        for (int j = 0; j < 3 * cells[1]; j++) {
            const double y = ((i / 3 + at[i % 3]) / cells[0] - 0.5) * plate_m[0];
            const double z = ((j / 3 + at[j % 3]) / cells[1] - 0.5) * plate_m[1];
            const double from[3] = {antenna[0], antenna[1] - y, antenna[2] - z}, r_m = v3_length(from);
            sum += weight[i % 3] * weight[j % 3] * antenna[0] / r_m * pow(range_m / r_m, 2) *
                   cexp(-2 * I * k * (r_m - range_m));
        }
    return -I * k / (2 * pi_rad) * sum * (plate_m[0] / cells[0]) * (plate_m[1] / cells[1]);
}

static void near_a_plate_it_is_the_integral(void **state)
{
    (void)state;
    static const struct {
        double hz, range_m;
    } cases[] = {{10e9, 1.5}, {10e9, 20}, {94e9, 3}, {94e9, 50}, {94e9, 2000}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const double k = 2 * pi_rad * cases[n].hz / light_mps, ahead[3] = {cases[n].range_m, 0, 0};
        double       worst = 0, most = cabs(plate_directly(ahead, cases[n].range_m, k));
        RadarStage   s;
        stage_open(&s, "plate:0.3x0.2", cases[n].hz);
        for (int i = 0; i < 8; i++) {
            const ScatterAntenna a = antenna_at(0.6 * i * i, 0.4 * i, cases[n].range_m);
            double               p[3];
            v3_scale(p, a.range_m, a.u);
            const ScatterMatrix  m = look(&s, &a, &a, polygon_faces_few);
            const double complex want = plate_directly(p, a.range_m, k);
            most = fmax(most, cabs(want));
            worst = fmax(worst, cabs(m.vv - want));
            CHECK(field.hits.rays == 0);
        }
        printf("plate at %g GHz from %g m: within %.0f dB of the largest amplitude, %d triangles\n", 1e-9 * cases[n].hz,
               cases[n].range_m, 2 * decibels(worst / most), field.polygons.count);
        CHECK(worst / most <= 1e-3);
        close_stage(&s);
    }
}

/* ---- a triangle ---------------------------------------------------------------------------------------- */

static const double corner[3][3] = {{0, -0.11, -0.05}, {0, 0.13, -0.02}, {0, -0.02, 0.10}};

/* Against its Fourier transform, transmitter and receiver apart; the tubes' own error beside it. */
static void a_triangle_is_its_transform(void **state)
{
    (void)state;
    static const double hz = 24e9;
    const double        k = 2 * pi_rad * hz / light_mps;
    double              worst[2] = {0}, ab[3], ac[3], n[3], peak = 0;
    RadarStage          s = {0};
    hand_model(&s.model, 1, 3, 1);
    s.model.node[0].parent = -1;
    for (int v = 0; v < 3; v++) {
        hand_vertex(&s.model, corner[v][0], corner[v][1], corner[v][2]);
        s.model.normal[v][0] = 1, s.model.normal[v][1] = s.model.normal[v][2] = 0;
    }
    hand_triangle(&s.model, 0, 0, 1, 2);
    open_model(&s, hz);
    v3_sub(ab, corner[1], corner[0]);
    v3_sub(ac, corner[2], corner[0]);
    v3_cross(n, ab, ac);
    peak = k / (2 * pi_rad) * 0.5 * v3_length(n);
    for (int i = 0; i < 30; i++) {
        const ScatterAntenna tx = antenna_at(1.9 * i, 0, INFINITY), rx = antenna_at(-1.3 * i + 4, 0, INFINITY);
        double               x[3];
        for (int c = 0; c < 3; c++) x[c] = -k * (v3_dot(corner[c], tx.u) + v3_dot(corner[c], rx.u));
        /* v lies in the plate: 2 n x H is 2 cos(tx) v */
        const double complex want = -I * peak * tx.u[0] * mean_directly(x);
        for (int on = 0; on < 2; on++) {
            const ScatterMatrix got = look(&s, &tx, &rx, on * polygon_faces_few);
            worst[on] = fmax(worst[on], cabs(got.vv - want) / peak);
        }
    }
    printf("triangle, antennas apart: tubes within %.0f dB of the peak's amplitude, closed form %.0f dB\n",
           2 * decibels(worst[0]), 2 * decibels(worst[1]));
    CHECK(worst[0] <= 1e-2 && worst[1] <= 1e-9);
    close_stage(&s);
}

/* ---- no metal ------------------------------------------------------------------------------------------ */

/* In the plane of incidence each polarisation returns its own reflection coefficient, roughness included. */
static void other_surfaces_reflect_by_fresnel(void **state)
{
    (void)state;
    RadarMaterial        row = {.name = "metal",
                                .thick_m = 0.004,
                                .rough_m = 0.0005,
                                .points = 1,
                                .frequency_hz = {1e10},
                                .e1 = {6},
                                .e2 = {0.5}};
    const RadarMaterials materials = {1, &row};
    const double         k = 2 * pi_rad * x_hz / light_mps;
    double               worst = 0;
    RadarStage           s;
    stage_open(&s, "plate:0.3x0.2", x_hz);
    s.target->materials = &materials;
    for (int kind = 0; kind < RADAR_SURFACE_KINDS; kind++)
        for (int i = 0; i < 20; i++) {
            RadarSurface         surface;
            double complex       te, tm;
            const ScatterAntenna a = antenna_at(3.7 * i, 0, INFINITY);
            const double complex metal = a.u[0] * plate_form(a.u, k);
            row.kind = (RadarSurfaceKind)kind;
            radar_surface(&surface, &row, x_hz);
            fresnel_surface(&te, &tm, &surface, k, a.u[0]);
            const ScatterMatrix m = look(&s, &a, &a, polygon_faces_few);
            const double        peak = k / (2 * pi_rad) * plate_m[0] * plate_m[1];
            worst = fmax(worst, fmax(cabs(m.vv + te * metal), cabs(m.hh - tm * metal)) / peak);
        }
    printf("surfaces of four kinds: within %.1e of the peak\n", worst);
    CHECK(worst <= 1e-12);
    close_stage(&s);
}

/* ---- many frequencies, other antennas ------------------------------------------------------------------ */

static void sweeps_and_moved_antennas(void **state)
{
    (void)state;
    enum { count = 40 };
    RadarStage    s;
    ScatterMatrix many[count], moved, own;
    double        worst = 0, peak = 0;
    stage_open(&s, "plate:0.3x0.2", x_hz);
    const ScatterAntenna a = antenna_at(9, 4, 30), b = antenna_at(9.2, 3.9, 30);
    look(&s, &a, &a, polygon_faces_few);
    CHECK(total_field_sweep(many, &(FrequencySweep){.count = count, .first_hz = 9e9, .step_hz = 25e6}, &field,
                            s.pool) == STATUS_OK);
    for (int f = 0; f < count; f++) {
        ScatterMatrix single;
        CHECK(total_field_sweep(&single, &(FrequencySweep){.count = 1, .first_hz = 9e9 + f * 25e6}, &field, NULL) ==
              STATUS_OK);
        worst = fmax(worst, cabs(single.hh - many[f].hh)), peak = fmax(peak, cabs(single.hh));
    }
    CHECK(total_field_sweep(&moved, &(FrequencySweep){.count = 1, .first_hz = x_hz, .tx = &b, .rx = &b}, &field,
                            s.pool) == STATUS_OK);
    own = look(&s, &b, &b, polygon_faces_few);
    const double off_db = 2 * decibels(cabs(moved.vv - own.vv) / cabs(own.vv));
    printf("sweep: within %.0e of the peak; a list 0.2 degrees away %.0f dB\n", worst / peak, off_db);
    CHECK(worst <= 1e-9 * peak && off_db <= -50);

    s.config.warp_m = 1e-3;
    look(&s, &a, &a, polygon_faces_few);
    CHECK(field.polygons.count == 0 && field.hits.count > 0);
    s.config.warp_m = 0, s.config.last_only = true;
    look(&s, &a, &a, polygon_faces_few);
    CHECK(field.polygons.count == 0 && field.hits.count > 0);
    close_stage(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_form_is_the_mean),           cmocka_unit_test(a_plate_is_its_closed_form),
        cmocka_unit_test(near_a_plate_it_is_the_integral),   cmocka_unit_test(a_triangle_is_its_transform),
        cmocka_unit_test(other_surfaces_reflect_by_fresnel), cmocka_unit_test(sweeps_and_moved_antennas),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
