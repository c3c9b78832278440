/* A sphere and a vehicle with the ground near them, path by path: Mie's series and image theory. labels: physics slow
 */
#include "tests/render/ground_paths.h"

/* The exact series for a perfectly conducting sphere about the origin, for a transmitter and a receiver at an angle
 * about it: S for fields across (0) and in (1) the plane of both. Source: Bohren & Huffman, 4.3, for exp(+j w t). */
static void mie(double complex s[2], double a_m, double k, double between_rad)
{
    enum { most = 200 };
    const double   x = k * a_m, mu = -cos(between_rad); /* of the scattering angle */
    const int      terms = (int)(x + 4 * cbrt(x) + 3);
    long double    j[most], y[most];
    double         angle[most + 1] = {0, 1};
    double complex sum[2] = {0, 0};
    CHECK(terms < most);
    j[0] = sinl(x) / (long double)x, y[0] = -cosl(x) / (long double)x;
    j[1] = j[0] / (long double)x - cosl(x) / (long double)x, y[1] = y[0] / (long double)x - sinl(x) / (long double)x;
    for (int n = 2; n <= terms; n++) {
        j[n] = (2 * n - 1) / (long double)x * j[n - 1] - j[n - 2];
        y[n] = (2 * n - 1) / (long double)x * y[n - 1] - y[n - 2];
        angle[n] = ((2 * n - 1) * mu * angle[n - 1] - n * angle[n - 2]) / (n - 1);
    }
    for (int n = 1; n <= terms; n++) {
        const double         p = (double)j[n], p1 = (double)(x * j[n - 1] - n * j[n]) / x; /* psi / x, psi' */
        const double complex q = p - I * (double)y[n], q1 = p1 - I * (double)(x * y[n - 1] - n * y[n]) / x;
        const double complex an = p1 / q1, bn = p / q;
        const double         tau = n * mu * angle[n] - (n + 1) * angle[n - 1], share = (2 * n + 1.0) / (n * (n + 1.0));
        sum[0] += share * (an * angle[n] + bn * tau);
        sum[1] += share * (an * tau + bn * angle[n]);
    }
    s[0] = sum[0] / (I * k);
    s[1] = -sum[1] / (I * k);
}

/* A sphere well above a mirror: antenna and image each see a sphere alone. The series is checked by its own limits: the
 * specular point's -a/2 exp(2 j k a), and Rayleigh's. */
static void a_sphere_above_a_mirror(void **state)
{
    (void)state;
    RadarStage     s;
    const double   a_m = 0.3, k = wave_number(x_hz);
    double complex one[2];
    double         worst[2] = {0, 0};
    mie(one, 1, 100, 0);
    CHECK(cabs(one[0] / (-0.5 * cexp(200 * I)) - 1) < 0.01 && cabs(one[0] - one[1]) < 1e-12);
    mie(one, 0.01, 1, 0);
    CHECK_NEAR(cabs(one[0]) / (1.5e-6), 1, 1e-3);
    s = (RadarStage){0};
    CHECK(radar_shape_build(&s.model, "sphere:0.3", 1e-5) ==
          STATUS_OK); /* finer: facets lie within the sphere by 0.1 rad otherwise */
    stage_target(&s, x_hz);
    for (int i = 0; i < 6; i++) {
        const double         el = 5 + 5 * i, height_m = 2 + 0.0031 * i;
        const GroundPlane    plane = level(height_m);
        const ScatterAntenna a = antenna_at(70 * i, el, INFINITY);
        Paths                p;
        ScatterMatrix        sum, sum_of_exact;
        double complex       both[2];
        trace_paths(&p, &s, &a, &plane, &mirror, false);
        ground_sum(&sum, &p.s, &p.direct, &p.image, k);
        mie(one, a_m, k, 0);
        mie(both, a_m, k, 2 * el * rad_per_deg);
        const double complex e = cexp(-I * k * 2 * height_m * sin(el * rad_per_deg));
        const double complex hh = (1 + e * e) * one[0] - 2 * e * both[0], vv = (1 + e * e) * one[1] + 2 * e * both[1];
        /* over what four paths in phase would give: sums that nearly cancel have no error of their own in dB */
        const double error = fmax(cabs(sum.hh - hh), cabs(sum.vv - vv)) / (2 * a_m);
        worst[i > 2] = fmax(worst[i > 2], error);
        const GroundFields exact = {{one[0], 0, 0, one[1]}, {both[0], 0, 0, both[1]}, {one[0], 0, 0, one[1]}};
        ground_sum(&sum_of_exact, &exact, &p.direct, &p.image, k);
        CHECK(cabs(sum_of_exact.hh - hh) < 1e-6 * a_m && cabs(sum_of_exact.vv - vv) < 1e-6 * a_m);
        printf("a sphere above a mirror, %2.0f degrees: %.2f %.2f dBsm, exact %.2f %.2f; %.4f of the lobe\n", el,
               rcs_dbsm(sum.hh), rcs_dbsm(sum.vv), rcs_dbsm(hh), rcs_dbsm(vv), error);
    }
    CHECK(worst[0] < 0.03 &&
          worst[1] < 0.04); /* to 15 and to 30 degrees: physical optics 30 and 60 degrees off backscatter */
    stage_close(&s);
}

/* ---- a vehicle ------------------------------------------------------------------------------------------------ */

static void open_truck(RadarStage *s, Catalog **catalog, RadarMaterials *materials)
{
    static const DisEntityType truck = {1, 1, 225, 7, 1, 0, 0};
    Origin                     origin;
    char                       path[4096];
    *s = (RadarStage){0};
    CHECK(etc_path(path, sizeof path, "catalog.csv") &&
          catalog_open(catalog, path, radar_sag_m(truck_hz)) == STATUS_OK);
    CHECK(radar_materials_load(materials) == STATUS_OK);
    const Model *model = catalog_model(*catalog, catalog_find(*catalog, truck, &origin, NULL));
    CHECK(radar_target_create(&s->target, model, materials, "avx2") == STATUS_OK);
    CHECK(pool_create(&s->pool, 2) == STATUS_OK);
    s->config = tubes_default_config(truck_hz);
    s->config.splits = 0; /* as signatures are made */
}

/* S(a, i) is the transpose of S(i, a) as far as physical optics is reciprocal; leaving out a ground of too little
 * coherence errs by no more than its share of what a mirror adds; threads change no bit. */
static void a_truck_on_the_ground(void **state)
{
    (void)state;
    RadarStage     s;
    Catalog       *catalog;
    RadarMaterials materials;
    open_truck(&s, &catalog, &materials);
    const double      lowest_m = s.target->entity.box_high[2], k = wave_number(truck_hz);
    const GroundPlane plane = level(lowest_m);
    double            apart = 0, power = 0, worst = 0, worst_db = 0, added_db = 0;
    enum { looks = 8 };
    for (int i = 0; i < looks; i++) {
        const ScatterAntenna a = antenna_at(45 * i + 7, 12, 2000);
        GroundSurface        rough = {.eps = 8 - 2 * I};
        Paths                p;
        ScatterMatrix        sum, smooth;
        double               h[3], v[3];
        trace_paths(&p, &s, &a, &plane, &rough, true);
        ground_sum(&smooth, &p.s, &p.direct, &p.image, k);
        added_db += 2 * decibels(rms_of(&smooth) / rms_of(&p.s.direct)) / looks;
        const ScatterMatrix back = trace(&s, &p.i, &p.a, &plane, true, (bool[]){true, false}, NULL);
        apart += pow(cabs(back.hh - p.s.once.hh), 2) + pow(cabs(back.vv - p.s.once.vv), 2) +
                 pow(cabs(back.hv - p.s.once.vh), 2) + pow(cabs(back.vh - p.s.once.hv), 2);
        power += pow(rms_of(&p.s.once), 2);

        scatter_basis(h, v, a.u);
        const double extra_m = p.image.extra_m, sine = -v3_dot(plane.n, p.i.u);
        rough.rms_m =
            sqrt(-0.5 * log(ground_least_coherence / p.image.coherence)) / (k * sine) * (1 + 1e-9); /* just left out */
        CHECK(ground_leg_image(&p.image, &(GroundMirror){&a, &p.i, extra_m, &plane}, &rough, k, h));
        CHECK_NEAR(p.image.coherence / ground_least_coherence, 1, 1e-6);
        CHECK(p.image.coherence < ground_least_coherence);
        ground_sum(&sum, &p.s, &p.direct, &p.image, k);
        sum.hh -= p.s.direct.hh, sum.hv -= p.s.direct.hv, sum.vh -= p.s.direct.vh, sum.vv -= p.s.direct.vv;
        const double bound = 2e-3 * rms_of(&p.s.once) + 1e-6 * rms_of(&p.s.twice);
        worst = fmax(worst, rms_of(&sum) / bound);
        worst_db = fmax(worst_db, 2 * decibels(1 + rms_of(&sum) / rms_of(&p.s.direct)));
    }
    printf("a truck at 3 GHz, 12 degrees: smooth loam adds %.1f dB on average; ways round differ by %.1f dB; left out "
           "at the least "
           "coherence: %.3f of the bound, %.4f dB\n",
           added_db, decibels(apart / power), worst, worst_db);
    CHECK(worst <= 1 && worst > 0.1 && worst_db < 0.1);
    CHECK(decibels(apart / power) < -6);

    const ScatterAntenna a = antenna_at(30, 12, 2000);
    ScatterAntenna       image;
    TotalField           first = {0}, other = {0};
    ground_image(&image, &a, &plane);
    for (int threads = 0; threads < 4; threads++) {
        Pool       *pool = NULL;
        TotalField *field = threads == 0 ? &first : &other;
        if (threads > 0) CHECK(pool_create(&pool, threads) == STATUS_OK);
        CHECK(total_field_trace(field, s.target, &image, &image, &s.config, true, pool) == STATUS_OK);
        const size_t whole = field->hits.count;
        CHECK(ground_hide(field, s.target, &plane, (bool[]){true, true}, pool) == STATUS_OK);
        CHECK(field->hits.count < whole && field->hits.count > 1000 &&
              field->hits.amplitude[0][field->hits.count] == 0);
        pool_destroy(pool);
        CHECK(field->hits.count == first.hits.count && field->edges.count == first.edges.count);
        CHECK(memcmp(field->hits.path_m, first.hits.path_m, first.hits.count * sizeof(double)) == 0);
        CHECK(memcmp(field->edges.segment, first.edges.segment,
                     (size_t)first.edges.count * sizeof *first.edges.segment) == 0);
    }
    total_field_free(&first);
    total_field_free(&other);
    radar_target_destroy(s.target);
    pool_destroy(s.pool);
    radar_materials_close(&materials);
    catalog_close(catalog);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_above_a_mirror),
        cmocka_unit_test(a_truck_on_the_ground),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
