/* Tubes divided at edges: a triangle against its Fourier transform, a tank by two grids, cells that add up.
 * labels: physics slow */
#include "tests/render/hand_models.h"
#include "tests/render/radar_stage.h"

#include "render/scattering/field/radar_model.h"

static double power(double complex s) { return creal(s) * creal(s) + cimag(s) * cimag(s); }

/* ---- a triangle ---------------------------------------------------------------------------------------- */

/* Corners, m, of a flat triangle of no right angle and no two equal sides; normal -x. */
static const double corner[3][3] = {{0, -0.11, -0.05}, {0, 0.13, -0.02}, {0, -0.02, 0.10}};

/* Physical optics of the triangle for one antenna at infinity: -(j k / 2 pi) cos times the integral of exp(2 j k u.p),
 * by Gauss's rule of 3 points on strips of strips, far finer than a wavelength. */
static double complex triangle_field(const double u[3], double k)
{
    enum { cuts = 600 };
    static const double at[3] = {0.1127016653792583, 0.5, 0.8872983346207417},
                        weight[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0};
    double         ab[3], ac[3], n[3];
    double complex sum = 0;
    v3_sub(ab, corner[1], corner[0]);
    v3_sub(ac, corner[2], corner[0]);
    v3_cross(n, ab, ac);
    const double area2 = v3_length(n), cosine = fabs(v3_dot(n, u)) / area2;
    const double a = 2 * k * v3_dot(ab, u), c = 2 * k * v3_dot(ac, u);
    for (int i = 0; i < cuts; i++)
        for (int q = 0; q < 3; q++) {
            const double x = (i + at[q]) / cuts; /* along ab; the strip along ac in closed form */
            const double half = 0.5 * c * (1 - x);
            sum += weight[q] / cuts * (1 - x) * scatter_sinc(half) * cexp(I * (a * x + half));
        }
    return -I * k / (2 * pi_rad) * cosine * area2 * sum * cexp(2 * I * k * v3_dot(corner[0], u));
}

static void a_triangle_is_its_transform(void **state)
{
    (void)state;
    RadarStage s = {0};
    double     worst[2] = {0}, db[2] = {0};
    hand_model(&s.model, 1, 3, 1);
    s.model.node[0].parent = -1;
    for (int v = 0; v < 3; v++) {
        hand_vertex(&s.model, corner[v][0], corner[v][1], corner[v][2]);
        s.model.normal[v][0] = 1;
    }
    hand_triangle(&s.model, 0, 0, 1, 2);
    CHECK(model_measure(&s.model) == STATUS_OK);
    stage_target(&s, 24e9);
    const double k = 2 * pi_rad * 24e9 / light_mps, normal[3] = {1, 0, 0};
    const double peak = cabs(triangle_field(normal, k));
    for (int i = 0; i < 40; i++) {
        const ScatterAntenna a = antenna_at(1.9 * i, 0.31 * i - 3, INFINITY);
        const double complex want = triangle_field(a.u, k);
        for (int split = 0; split < 2; split++) {
            s.config.splits = split ? tubes_default_config(24e9).splits : 0;
            const ScatterMatrix got = stage_bistatic(&s, &a, &a);
            worst[split] = fmax(worst[split], cabs(got.vv - want) / peak);
            if (cabs(want) > 0.01 * peak) db[split] = fmax(db[split], fabs(decibels(power(got.hh) / power(want))));
        }
    }
    printf(
        "triangle of 19 wavelengths: amplitude %.1f dB below the peak's whole, %.1f dB divided; down to -40 dB %.2f, "
        "%.2f dB\n",
        -2 * decibels(worst[0]), -2 * decibels(worst[1]), db[0], db[1]);
    CHECK(worst[1] <= 3e-3 && worst[1] < 0.5 * worst[0] && db[1] <= 0.1);
    stage_close(&s);
}

/* ---- a tank -------------------------------------------------------------------------------------------- */

static void two_grids_of_a_tank_agree(void **state)
{
    (void)state;
    static const double x_hz = 10e9;
    RadarMaterials      materials = {0};
    RadarModel          tank = {0};
    RadarStage          s = {0};
    double              off_db[2];
    long long           rays[2] = {0};
    CHECK(radar_materials_load(&materials) == STATUS_OK);
    CHECK(radar_model_open(&tank, "tank", &materials, radar_sag_m(x_hz)) == STATUS_OK);
    CHECK(pool_create(&s.pool, 2) == STATUS_OK);
    s.target = tank.target;
    radar_target_pose(s.target, NULL, 0);
    s.config = tubes_default_config(x_hz);
    for (int split = 0; split < 2; split++) {
        double off = 0, whole = 0;
        s.config.splits = split ? tubes_default_config(x_hz).splits : 0;
        for (int i = 0; i < 4; i++) {
            ScatterMatrix m[2];
            for (int seed = 0; seed < 2; seed++) {
                s.config.seed = (uint64_t)seed;
                m[seed] = stage_look(&s, 60 * i + 0.37, 5 + 7 * i, 2000);
                rays[split] += s.hits.rays;
            }
            off += power(m[0].hh - m[1].hh) + power(m[0].vv - m[1].vv);
            whole += power(m[0].hh) + power(m[0].vv);
        }
        off_db[split] = decibels(0.5 * off / whole); /* half of it is each grid's own */
    }
    printf("two grids of a tank at 10 GHz: %.1f dB of its power whole, %.1f dB divided, %.1f times the rays\n",
           off_db[0], off_db[1], (double)rays[1] / (double)rays[0]);
    CHECK(off_db[1] <= -30 && off_db[1] <= off_db[0] - 6);
    tubes_free(&s.hits);
    pool_destroy(s.pool);
    radar_model_close(&tank);
    radar_materials_close(&materials);
}

/* ---- cells --------------------------------------------------------------------------------------------- */

/* Areas of the cells on a plate across the line of sight add up to its own, the closer the more they are divided. */
static void cells_add_up(void **state)
{
    (void)state;
    RadarStage s;
    stage_open(&s, "plate:0.37x0.29", 10e9);
    const ScatterAntenna a = antenna_at(0, 0, INFINITY);
    double               off[3];
    for (int split = 0; split < 3; split++) {
        s.config.splits = 2 * split;
        s.config.cuts_per_radius = 1e4;
        off[split] = 0;
        for (int seed = 0; seed < 8; seed++) {
            s.config.seed = (uint64_t)seed;
            const ScatterMatrix m = stage_bistatic(&s, &a, &a);
            const double        want = 10e9 / light_mps * 0.37 * 0.29; /* k area / 2 pi */
            off[split] += power(cabs(m.vv) / want - 1) / 8;
        }
    }
    printf("area of a plate: rms error %.1e whole, %.1e divided twice, %.1e four times\n", sqrt(off[0]), sqrt(off[1]),
           sqrt(off[2]));
    CHECK(off[1] < 0.1 * off[0] && off[2] < 0.5 * off[1]);
    s.config.splits = 6;
    ScatterAntenna tx = a;
    CHECK(tubes_trace(&s.hits, s.target, &tx, &tx, &s.config, s.pool) == STATUS_BAD_VALUE);
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_triangle_is_its_transform), cmocka_unit_test(cells_add_up),
                                       cmocka_unit_test(two_grids_of_a_tank_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
