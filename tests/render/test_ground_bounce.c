/* A target and the ground near it against image theory, the two-ray pattern and closed forms: none of the answers comes
 * from the code that is tested. labels: physics */
#include "tests/render/ground_paths.h"

/* ---- the plane and its legs ------------------------------------------------------------------------------ */

static GroundPlane tilted(uint32_t i)
{
    GroundPlane plane = {{0.3 * (random_uniform(1, i, 0, 0) - 0.5), 0.3 * (random_uniform(1, i, 0, 1) - 0.5), -1},
                         20 * random_uniform(1, i, 0, 2)};
    v3_normalize(plane.n, plane.n);
    return plane;
}

/* Every point of the plane is as far from the antenna as from its image; what an image is farther is to the rounding
 * that a difference of lengths in long double shows. */
static void an_image_is_as_far_from_the_plane(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 200; i++) {
        const GroundPlane    plane = tilted(i);
        const ScatterAntenna a = antenna_at(360 * random_uniform(2, i, 0, 0), 60 * random_uniform(2, i, 0, 1) + 12,
                                            pow(10, 2 + 3 * random_uniform(2, i, 0, 2)));
        ScatterAntenna       image;
        double               at[3], u[3], p[3], to[3], from_image[3];
        const double         extra_m = ground_image(&image, &a, &plane);
        long double          far[2] = {0, 0};
        for (int c = 0; c < 3; c++) {
            far[0] += (long double)(a.u[c] * a.range_m) * (long double)(a.u[c] * a.range_m);
            p[c] = a.u[c] * a.range_m - 2 * (v3_dot(plane.n, a.u) * a.range_m + plane.height_m) * plane.n[c];
            far[1] += (long double)p[c] * (long double)p[c];
        }
        CHECK_NEAR(extra_m, (double)(sqrtl(far[1]) - sqrtl(far[0])), 1e-10);
        for (int c = 0; c < 3; c++) u[c] = random_uniform(3, i, 0, (uint64_t)c) - 0.5;
        v3_add_scaled(at, u, -ground_above_m(&plane, u), plane.n);
        v3_scale(to, a.range_m, a.u);
        v3_scale(from_image, image.range_m, image.u);
        v3_sub(to, to, at);
        v3_sub(from_image, from_image, at);
        CHECK_NEAR(v3_length(to), v3_length(from_image), 1e-9);

        ScatterAntenna plane_wave = a, its;
        plane_wave.range_m = INFINITY;
        CHECK_NEAR(ground_image(&its, &plane_wave, &plane), 2 * plane.height_m * v3_dot(plane.n, a.u), 1e-12);
    }
}

/* On a perfect mirror the electric field along the plane is 0: of the wave from the antenna and the one that its leg
 * makes of it. By reciprocity the same leg serves the way back. */
static void a_mirror_has_no_field_along_it(void **state)
{
    (void)state;
    double worst = 0;
    for (uint32_t i = 0; i < 500; i++) {
        const GroundPlane plane = tilted(i);
        double            right[3] = {random_uniform(5, i, 0, 0) - 0.5, random_uniform(5, i, 0, 1) - 0.5,
                                      random_uniform(5, i, 0, 2) - 0.5};
        ScatterAntenna a = antenna_at(360 * random_uniform(4, i, 0, 0), 75 * random_uniform(4, i, 0, 1) + 14, INFINITY),
                       image;
        GroundLeg leg, direct;
        double    h[3], v[3], axis[2][3];
        if (i % 10 == 0)
            for (int c = 0; c < 3; c++) a.u[c] = plane.n[c]; /* straight above */
        const double extra_m = ground_image(&image, &a, &plane);
        CHECK(ground_leg_image(&leg, &(GroundMirror){&a, &image, extra_m, &plane}, &mirror, 200, right));
        ground_leg_direct(&direct, &a, right);
        v3_add_scaled(axis[0], right, -v3_dot(right, a.u), a.u);
        v3_normalize(axis[0], axis[0]);
        v3_cross(axis[1], a.u, axis[0]);
        for (int e = 0; e < 2; e++) {
            double complex whole[3], up = 0;
            double         straight[3];
            scatter_basis(h, v, image.u);
            for (int c = 0; c < 3; c++) whole[c] = axis[e][c] + leg.m[0][e] * h[c] + leg.m[1][e] * v[c];
            for (int c = 0; c < 3; c++) up += whole[c] * plane.n[c];
            for (int c = 0; c < 3; c++) worst = fmax(worst, cabs(whole[c] - up * plane.n[c]));
            scatter_basis(h, v, a.u); /* and the direct leg is a turn of the basis */
            for (int c = 0; c < 3; c++) straight[c] = creal(direct.m[0][e]) * h[c] + creal(direct.m[1][e]) * v[c];
            for (int c = 0; c < 3; c++) CHECK_NEAR(straight[c], axis[e][c], 1e-12);
        }
    }
    printf("field along a perfect mirror: %.1e\n", worst);
    CHECK(worst < 1e-6);
    ScatterAntenna      a = antenna_at(0, 10, 100), image;
    const GroundPlane   above = level(-50); /* antenna beneath it */
    GroundLeg           leg;
    static const double right[3] = {0, 1, 0};
    const double        extra_m = ground_image(&image, &a, &above);
    CHECK(!ground_leg_image(&leg, &(GroundMirror){&a, &image, extra_m, &above}, &mirror, 200, right));
}

/* exp(-x) I0(x) by its integral, exp(x (cos t - 1)) over t; and Ament's. */
static void roughness_is_as_published(void **state)
{
    (void)state;
    double worst = 0;
    for (double x = 0; x < 200; x += 0.37) {
        double sum = 0;
        for (int i = 0; i < 4000; i++) sum += exp(x * (cos(pi_rad * (i + 0.5) / 4000) - 1)) / 4000;
        const double phase = sqrt(x / 2); /* k rms sine */
        worst = fmax(worst, fabs(ground_roughness(phase / 50, true, 100, 0.5) - sum));
        CHECK_NEAR(ground_roughness(phase / 50, false, 100, 0.5), exp(-x), 1e-14);
    }
    printf("roughness of waves: within %.1e of its integral\n", worst);
    CHECK(worst < 3e-7);
}

/* ---- the table -------------------------------------------------------------------------------------------- */

static Status open_text(GroundTable *out, const char *text)
{
    char  path[] = "/tmp/pitviper_ground_XXXXXX";
    FILE *file = fdopen(mkstemp(path), "w");
    fputs(text, file);
    fclose(file);
    const Status status = ground_table_open(out, path);
    remove(path);
    return status;
}

/* Every class is there; permittivities lie where P.527's own figures do (sea of fresh water at 10 GHz and 20 C: 60.8
 * - 32.7 j; ours is at 15 C); what is wrong with a table is refused. */
static void every_surface_has_a_ground(void **state)
{
    (void)state;
    static GroundTable table;
    char               path[4096];
    CHECK(etc_path(path, sizeof path, "radar/ground.csv") && ground_table_open(&table, path) == STATUS_OK);
    for (int s = 0; s < SURFACE_COUNT; s++) {
        double before = INFINITY;
        for (double f_hz = 9e9; f_hz < 110e9; f_hz *= 1.3) {
            const GroundSurface g = ground_surface(&table.row[s], f_hz);
            CHECK(creal(g.eps) > 1 && creal(g.eps) <= before && cimag(g.eps) <= 0 && g.rms_m > 0);
            before = creal(g.eps);
            double complex te, tm;
            ground_reflection(&te, &tm, &g, wave_number(f_hz), 0.01); /* grazing: both towards -1 */
            CHECK(cabs(te) <= 1 && cabs(tm) <= 1);
        }
    }
    const GroundSurface water = ground_surface(&table.row[SURFACE_WATER], 10e9);
    CHECK(fabs(creal(water.eps) - 60.8) < 4 && fabs(-cimag(water.eps) - 32.7) < 4 && water.waves);
    const GroundSurface between = ground_surface(&table.row[SURFACE_BARE_SOIL], sqrt(10e9 * 35e9)),
                        low = ground_surface(&table.row[SURFACE_BARE_SOIL], 10e9),
                        high = ground_surface(&table.row[SURFACE_BARE_SOIL], 35e9);
    CHECK(cabs(between.eps - 0.5 * (low.eps + high.eps)) < 1e-12);

    static GroundTable kept;
    kept.row[1].points = 77;
    static const char *const bad[] = {
        "surface,f_ghz,eps_re,eps_im,rms_mm,heights\n",
        "surface,f_ghz,eps_re\ngrass,10,5\n",
        "surface,f_ghz,eps_re,eps_im,rms_mm,heights\nlawn,10,5,1,5,gaussian\n",
        "surface,f_ghz,eps_re,eps_im,rms_mm,heights\ngrass,10,0.5,1,5,gaussian\n",
        "surface,f_ghz,eps_re,eps_im,rms_mm,heights\ngrass,10,5,1,5,fractal\n",
        "surface,f_ghz,eps_re,eps_im,rms_mm,heights\ngrass,10,5,1,5,gaussian\ngrass,10,5,1,5,gaussian\n",
        "surface,f_ghz,eps_re,eps_im,rms_mm,heights\ngrass,10,5,1,5,gaussian\ngrass,20,5,1,6,gaussian\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(open_text(&kept, bad[i]) == STATUS_BAD_VALUE);
    CHECK(ground_table_open(&kept, "/nowhere/ground.csv") == STATUS_IO && kept.row[1].points == 77);
}

/* ---- a point above the ground: the two-ray pattern --------------------------------------------------------- */

/* An isotropic point, whose field is 1 for every pair of directions, horizontally polarised, over the range at which
 * the direct path alone gives 1: the fourth power of |F|, with F = 1 + G exp(-j k (r_i - r_a)), from heights alone. */
static void a_point_has_the_two_ray_pattern(void **state)
{
    (void)state;
    static const struct {
        double complex eps;
        double         rms_m;
    } ground[] = {{1 - 1e16 * I, 0}, {15 - 3 * I, 0}, {15 - 3 * I, 0.02}, {5 - 0.5 * I, 0.1}};
    static const double right[3] = {0, 1, 0};
    const double        k = wave_number(x_hz), antenna_m = 12, away_m = 6000;
    double              peak = 0, null = 1, worst_db = 0, worst_flat_db = 0;
    for (int g = 0; g < 4; g++)
        for (double h = 0.2; h < 40; h += 0.05) {
            const double up = antenna_m - h, range_m = hypot(away_m, up),
                         sine = (antenna_m + h) / hypot(away_m, antenna_m + h);
            const ScatterAntenna a = {{away_m / range_m, 0, -up / range_m}, range_m};
            const GroundPlane    plane = level(h);
            const GroundSurface  surface = {ground[g].eps, ground[g].rms_m, false};
            const GroundFields   one = {{1, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1}};
            ScatterAntenna       image;
            GroundLeg            legs[2];
            ScatterMatrix        s;
            const double         extra_m = ground_image(&image, &a, &plane);
            ground_leg_direct(&legs[0], &a, right);
            CHECK(ground_leg_image(&legs[1], &(GroundMirror){&a, &image, extra_m, &plane}, &surface, k, right));
            ground_sum(&s, &one, &legs[0], &legs[1], k);
            const double complex q = csqrt(ground[g].eps - (1 - sine * sine));
            const double complex fresnel = (sine - q) / (sine + q);
            const double         rough = exp(-0.5 * pow(2 * k * ground[g].rms_m * sine, 2));
            const double         far_m = hypot(away_m, antenna_m + h);
            const double f4 = pow(cabs(1 + rough * fresnel * range_m / far_m * cexp(-I * k * (far_m - range_m))), 4);
            const double got = cabs(s.hh) * cabs(s.hh);
            if (f4 > 1e-3) worst_db = fmax(worst_db, fabs(decibels(got / f4)));
            if (g > 0) continue;
            /* textbook: 16 sin^4 (k h1 h2 / d) */
            const double flat = 16 * pow(sin(k * antenna_m * h / away_m), 4);
            if (flat > 0.1) worst_flat_db = fmax(worst_flat_db, fabs(decibels(got / flat)));
            peak = fmax(peak, got);
            null = fmin(null, got);
        }
    printf("a point over ground: %.1e dB of the two-ray formula, %.3f dB of 16 sin^4; lobes %.3f dB, nulls %.0f dB\n",
           worst_db, worst_flat_db, decibels(peak), decibels(null));
    CHECK(worst_db < 1e-5 && worst_flat_db < 0.1);
    CHECK_NEAR(decibels(peak), 20 * log10(4), 0.01);
    CHECK(decibels(null) < -60);
}

/* Physical optics of a plate, A along y and B along z about the origin, normal x, for any two far antennas:
 * -j k / (2 pi) A B q . (n x (d x p)) sinc sinc. */
static double complex plate_optics(const ScatterAntenna *tx, const ScatterAntenna *rx, int received, int transmitted,
                                   double a_m, double b_m, double k)
{
    double              q[2][3], p[2][3], d[3], h[3], j[3];
    static const double n[3] = {1, 0, 0};
    scatter_basis(q[0], q[1], rx->u);
    scatter_basis(p[0], p[1], tx->u);
    v3_scale(d, -1, tx->u);
    v3_cross(h, d, p[transmitted]);
    v3_cross(j, n, h);
    const double y = 0.5 * k * a_m * (tx->u[1] + rx->u[1]), z = 0.5 * k * b_m * (tx->u[2] + rx->u[2]);
    const double share = (fabs(y) < 1e-9 ? 1 : sin(y) / y) * (fabs(z) < 1e-9 ? 1 : sin(z) / z);
    return -I * k / (2 * pi_rad) * a_m * b_m * v3_dot(q[received], j) * share;
}

/* A plate that stands on a mirror: the sum over antenna and image, each way, of the plate's own closed form; its peak
 * that of the dihedral that plate and ground make, 16 pi (A B cos e)^2 / lambda^2, at any elevation. */
static void a_standing_plate_is_a_dihedral(void **state)
{
    (void)state;
    RadarStage   s;
    const double a_m = 0.5, b_m = 0.8, k = wave_number(x_hz), wavelength_m = light_mps / x_hz;
    double       worst = 0, worst_peak_db = 0, worst_edge_db = 0;
    stage_open(&s, "plate:0.5x0.8", x_hz);
    const GroundPlane plane = level(b_m / 2);
    for (int i = 0; i < 12; i++) {
        const double         el = 8 + 12 * (i % 4), az = 1.3 * (i / 4);
        const ScatterAntenna a = antenna_at(az, el, INFINITY);
        Paths                p;
        ScatterMatrix        sum;
        trace_paths(&p, &s, &a, &plane, &mirror, false);
        ground_sum(&sum, &p.s, &p.direct, &p.image, k);
        /* the image's horizontal field is reversed, its vertical one (v points up at both) is not: the mirror's own
         * bases */
        const double complex e = cexp(-I * k * 2 * plane.height_m * sin(el * rad_per_deg));
        double complex       want[2];
        for (int c = 0; c < 2; c++) {
            const double turn = c == 0 ? -1 : 1;
            want[c] = plate_optics(&a, &a, c, c, a_m, b_m, k) + turn * e * plate_optics(&p.i, &a, c, c, a_m, b_m, k) +
                      turn * e * plate_optics(&a, &p.i, c, c, a_m, b_m, k) +
                      e * e * plate_optics(&p.i, &p.i, c, c, a_m, b_m, k);
        }
        const double peak = 2 * a_m * b_m * cos(el * rad_per_deg) / wavelength_m;
        worst = fmax(worst, fmax(cabs(sum.hh - want[0]), cabs(sum.vv - want[1])) / peak);
        if (i >= 4) continue;
        worst_peak_db = fmax(worst_peak_db, fabs(2 * decibels(2 * cabs(p.s.once.hh) / peak)));
        trace_paths(&p, &s, &a, &plane, &mirror, true);
        worst_edge_db = fmax(worst_edge_db, fabs(2 * decibels(2 * cabs(p.s.once.hh) / peak)));
        worst_edge_db = fmax(worst_edge_db, fabs(2 * decibels(2 * cabs(p.s.once.vv) / peak)));
    }
    printf("a plate on a mirror: %.4f of its peak from image theory; dihedral %.3f dB, with edges %.3f dB\n", worst,
           worst_peak_db, worst_edge_db);
    CHECK(worst < 0.01 && worst_peak_db < 0.05 && worst_edge_db < 0.3);
    stage_close(&s);
}

/* A cylinder that stands on a mirror (a top hat without its brim): side and ground return 4 k a L^2 cos e. */
static void a_standing_cylinder_is_a_top_hat(void **state)
{
    (void)state;
    RadarStage   s;
    const double radius_m = 0.25, long_m = 0.6, k = wave_number(x_hz);
    stage_open(&s, "cylinder:0.25x0.6", x_hz);
    const GroundPlane plane = level(long_m / 2);
    for (int i = 0; i < 3; i++) {
        const double         el = 10 + 20 * i;
        const ScatterAntenna a = antenna_at(33, el, INFINITY);
        Paths                p;
        trace_paths(&p, &s, &a, &plane, &mirror, false);
        const double want_m2 = 4 * k * radius_m * long_m * long_m * cos(el * rad_per_deg);
        const double hh_db = decibels(4 * pi_rad * pow(2 * cabs(p.s.once.hh), 2) / want_m2);
        const double vv_db = decibels(4 * pi_rad * pow(2 * cabs(p.s.once.vv), 2) / want_m2);
        printf("a cylinder on a mirror at %.0f degrees: %.2f dBsm, %+.3f %+.3f dB\n", el, decibels(want_m2), hh_db,
               vv_db);
        CHECK_NEAR(hh_db, 0, 0.2);
        CHECK_NEAR(vv_db, 0, 0.2);
    }
    stage_close(&s);
}

/* ---- what sees the image ------------------------------------------------------------------------------------- */

/* A level plate so high above the ground: by way of the ground the antenna lights a strip of its underside that is as
 * wide as the ray that just misses its edge reaches in: 2 h cot e behind the edge (down to the ground and up again). */
static void a_roof_hides_its_own_ground(void **state)
{
    (void)state;
    RadarStage s;
    stage_open(&s, "plate:2x2", 3e9);
    NodePose level_pose = {.r_body_from_node = {0, 0, 1, 0, 1, 0, -1, 0, 0}}; /* its normal down */
    radar_target_pose(s.target, &level_pose, 0);
    for (int i = 0; i < 3; i++) {
        const double         el = 30 + 10 * i, high_m = 0.3;
        const GroundPlane    plane = level(high_m);
        const ScatterAntenna a = antenna_at(0, el, INFINITY);
        Paths                p;
        trace_paths(&p, &s, &a, &plane, &mirror, false);
        const double strip_m = 1 - p.seen_deepest_m, want_m = 2 * high_m / tan(el * rad_per_deg);
        printf("a roof at %.0f degrees: %.3f m of its underside lit, %.3f by the ray past its edge\n", el, strip_m,
               want_m);
        CHECK_NEAR(strip_m, want_m, 0.02);
    }
    /* sunk by half: what is beneath the ground does not count, for any path */
    radar_target_pose(s.target, NULL, 0);
    const GroundPlane    half = level(0);
    const ScatterAntenna a = antenna_at(0, 20, INFINITY);
    Paths                p;
    trace_paths(&p, &s, &a, &half, &mirror, false);
    const double want =
        2 * 1 * cos(20 * rad_per_deg) / (light_mps / 3e9); /* one leg of a plate of half the area, 2 m2 */
    CHECK_NEAR(2 * decibels(cabs(p.s.once.hh) / want), 0, 0.2);
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_image_is_as_far_from_the_plane), cmocka_unit_test(a_mirror_has_no_field_along_it),
        cmocka_unit_test(roughness_is_as_published),         cmocka_unit_test(every_surface_has_a_ground),
        cmocka_unit_test(a_point_has_the_two_ray_pattern),   cmocka_unit_test(a_standing_plate_is_a_dihedral),
        cmocka_unit_test(a_standing_cylinder_is_a_top_hat),  cmocka_unit_test(a_roof_hides_its_own_ground),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
