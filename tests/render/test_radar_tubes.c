/* Ray tubes: paths to the nanometre, the same bits for any number of threads, the same field wherever the target
 * stands and however it is turned, lists reused for other aspects and frequencies, curved mirrors, bistatic looks.
 * labels: physics */
#include "tests/render/hand_models.h"
#include "tests/render/radar_stage.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/field/tubes.h"

static const double x_hz = 10e9, w_hz = 94e9;

static double sigma(double complex s) { return 4 * pi_rad * (creal(s) * creal(s) + cimag(s) * cimag(s)); }

/* ---- paths -------------------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b)
{
    const double p = *(const double *)a, q = *(const double *)b;
    return p > q ? 1 : p < q ? -1 : 0;
}

/* After three mirrors at right angles a source at a seems to be at -a, seen from the corner: so a path is |p - a| +
 * |p + a|, p being its last point, and its length hardly depends on p. For parts turned and moved as well. */
static void paths_are_exact_at_every_range(void **state)
{
    (void)state;
    static double error_m[4000000];
    int           count = 0;
    RadarStage    s;
    stage_open(&s, "corner:0.3", w_hz);
    hand_draw = 0;
    for (int look = 0; look < 6; look++) {
        NodePose pose = {{hand_uniform(-3, 3), hand_uniform(-3, 3), hand_uniform(-3, 0)}, {0}};
        hand_rotation(pose.r_body_from_node);
        radar_target_pose(s.target, &pose, 0);
        const double   range_m = (const double[]){100, 1000, 3000, 10000, 20000, 7000}[look];
        double         out[3] = {1, 1, -1}, aim[3], p_antenna[3], a[3];
        const double   origin[3] = {0, 0, 0};
        double         attitude[9];
        ScatterAntenna antenna;
        m3_identity(attitude);
        for (int c = 0; c < 3; c++) out[c] += hand_uniform(-0.3, 0.3);
        v3_normalize(out, out);
        m3_mul_v3(aim, pose.r_body_from_node, out);
        v3_add_scaled(p_antenna, pose.p_body, range_m, aim);
        radar_antenna(&antenna, p_antenna, origin, attitude);
        stage_bistatic(&s, &antenna, &antenna);
        v3_scale(a, range_m, aim); /* seen from the corner */
        for (size_t i = 0; i < s.hits.count; i++) {
            double minus[3], plus[3];
            if (s.hits.bounce[i] != 3 || count == 4000000) continue;
            for (int c = 0; c < 3; c++) {
                const double p = (double)s.hits.last[c][i] - pose.p_body[c];
                minus[c] = p - a[c], plus[c] = p + a[c];
            }
            const double want_m = (v3_length(minus) - antenna.range_m) + (v3_length(plus) - antenna.range_m);
            error_m[count++] = fabs(s.hits.path_m[i] - want_m);
        }
    }
    qsort(error_m, (size_t)count, sizeof *error_m, by_size);
    printf("%d paths of three mirrors: error median %.1e, 99 %% %.1e, most %.1e m\n", count, error_m[count / 2],
           error_m[(int)(0.99 * count)], error_m[count - 1]);
    CHECK(count > 50000 && error_m[(int)(0.99 * count)] <= 2e-6);
    stage_close(&s);
}

/* ---- where it stands ---------------------------------------------------------------------------------- */

static void the_field_is_the_same_everywhere(void **state)
{
    (void)state;
    RadarStage           s;
    double               worst_deg = 0, worst_db = 0;
    const ScatterAntenna antenna = antenna_at(40, 30, 8000);
    stage_open(&s, "trihedral:0.25", w_hz);
    const ScatterMatrix want = stage_bistatic(&s, &antenna, &antenna);
    hand_draw = 100;
    for (int k = 0; k < 8; k++) {
        double p_target[3], r[9], from[3], turned[3], p_antenna[3];
        for (int c = 0; c < 3; c++) p_target[c] = k == 7 ? 4e6 : hand_uniform(-20000, 20000);
        hand_rotation(r);
        v3_scale(from, antenna.range_m, antenna.u);
        m3_mul_v3(turned, r, from);
        v3_add(p_antenna, p_target, turned);
        ScatterAntenna seen;
        radar_antenna(&seen, p_antenna, p_target, r);
        const ScatterMatrix got = stage_bistatic(&s, &seen, &seen);
        worst_deg = fmax(worst_deg, fmax(fabs(phase_deg(got.hh, want.hh)), fabs(phase_deg(got.vv, want.vv))));
        worst_db = fmax(worst_db, fabs(decibels(sigma(got.hh) / sigma(want.hh))));
    }
    printf("94 GHz, offsets to 20 km (one at 6900 km), any attitude: %.3f deg, %.4f dB\n", worst_deg, worst_db);
    CHECK(worst_deg <= 0.5 && worst_db <= 0.1);
    stage_close(&s);
}

/* A square trihedral: a list traced at one aspect against lists of others, over 33 frequencies. What is left at the
 * smallest step is the difference between two grids of tubes. */
static void lists_serve_other_aspects(void **state)
{
    (void)state;
    enum { count = 33 };
    static const double step_deg[] = {0.03, 0.1, 0.3, 1}, limit_db[] = {-50, -50, -48, -32};
    RadarStage          s;
    ScatterMatrix       got[count], want[count];
    TubeHits            list = {0};
    stage_open(&s, "corner:0.5", x_hz);
    const ScatterAntenna at = antenna_at(30, 20, 2000);
    CHECK(tubes_trace(&list, s.target, &at, &at, &s.config, s.pool) == STATUS_OK);
    for (int k = 0; k < 4; k++) {
        const ScatterAntenna to = antenna_at(30 + step_deg[k] * 0.8, 20 - step_deg[k] * 0.6, 2000);
        double               off = 0, whole = 0;
        stage_bistatic(&s, &to, &to);
        CHECK(field_sweep(
                  got,
                  &(FrequencySweep){.count = count, .first_hz = 9.5e9, .step_hz = 1e9 / count, .tx = &to, .rx = &to},
                  &list, s.pool) == STATUS_OK);
        CHECK(field_sweep(want, &(FrequencySweep){.count = count, .first_hz = 9.5e9, .step_hz = 1e9 / count}, &s.hits,
                          s.pool) == STATUS_OK);
        for (int f = 0; f < count; f++) {
            off += pow(cabs(got[f].hh - want[f].hh), 2) + pow(cabs(got[f].vv - want[f].vv), 2);
            whole += pow(cabs(want[f].hh), 2) + pow(cabs(want[f].vv), 2);
        }
        printf("a list used %.2f deg away: %.1f dB\n", step_deg[k], decibels(off / whole));
        CHECK(decibels(off / whole) <= limit_db[k]);
    }
    tubes_free(&list);
    stage_close(&s);
}

/* ---- bistatic ----------------------------------------------------------------------------------------- */

/* One mirror of physical optics is reciprocal where it mirrors; elsewhere its currents are those of the lit side
 * alone: -24.8 dB, with tubes of a sixth of the width as with divided ones (whole ones: -27). */
static void bistatic_fields_are_reciprocal(void **state)
{
    (void)state;
    RadarStage s;
    double     worst = 0;
    stage_open(&s, "sphere:0.3", 3 * x_hz);
    s.config.bounces = 1;
    for (double apart = 10; apart <= 70; apart += 30) {
        const ScatterAntenna a = antenna_at(10, 5, 400), b = antenna_at(10 + apart, 25, 400);
        const ScatterMatrix  there = stage_bistatic(&s, &a, &b), back = stage_bistatic(&s, &b, &a);
        const double         most = fmax(cabs(there.hh), cabs(there.vv));
        const double complex one[4] = {there.hh, there.hv, there.vh, there.vv};
        const double complex other[4] = {back.hh, back.vh, back.hv, back.vv};
        for (int p = 0; p < 4; p++) worst = fmax(worst, cabs(one[p] - other[p]) / most);
    }
    printf("sphere of ka 189, antennas up to 70 deg apart: reciprocal within %.1f dB\n", 20 * log10(worst));
    CHECK(20 * log10(worst) <= -24.5);
    stage_close(&s);
}

/* In the plane of both antennas: v is across it (S1), h is in it (S2). */
static void bistatic_spheres_equal_mie(void **state)
{
    (void)state;
    static const char *const names[] = {"ka", "scattering_angle_deg(0=forward;180=back)",
                                        "sigma_over_pi_a2_E_perp_plane(S1)", "sigma_over_pi_a2_E_in_plane(S2)"};
    char                     path[512];
    int                      column[4], seen = 0;
    Table                    table;
    RadarStage               s;
    double                   ka = 0, radius_m = 0, worst = 0;
    if (!reference_path(path, "radar/mie/mie_pec_bistatic.csv")) skip();
    CHECK(table_open(&table, path) == STATUS_OK && table_columns(column, &table, names, 4, "test"));
    for (int r = 0; r < table.rows; r++) {
        double x[4];
        for (int c = 0; c < 4; c++) CHECK(text_to_double(&x[c], table_text(&table, r, column[c])));
        if (!(x[0] > 60) || x[1] < 100 || fmod(x[1], 10) != 0) continue;
        if (ka == 0) {
            char name[64];
            ka = x[0], radius_m = ka * light_mps / (2 * pi_rad * x_hz);
            snprintf(name, sizeof name, "sphere:%.12g", radius_m);
            stage_open(&s, name, x_hz);
        }
        if (x[0] != ka) continue;
        const ScatterAntenna tx = antenna_at(7, 0, INFINITY), rx = antenna_at(7 + 180 - x[1], 0, INFINITY);
        const ScatterMatrix  m = stage_bistatic(&s, &tx, &rx);
        const double         unit = pi_rad * radius_m * radius_m;
        worst = fmax(worst, fmax(fabs(decibels(sigma(m.vv) / unit / x[2])), fabs(decibels(sigma(m.hh) / unit / x[3]))));
        seen++;
    }
    printf("sphere of ka %.3g, antennas up to 80 deg apart: within %.2f dB of Mie\n", ka, worst);
    CHECK(seen >= 8 && worst <= 0.5);
    stage_close(&s);
    table_close(&table);
}

/* The mean field of an uneven plate at normal incidence is exp(-2 (k h)^2) of the even one's, for normal heights; and a
 * single plate's field converges with the tubes. */
static void an_uneven_plate_loses_what_it_must(void **state)
{
    (void)state;
    enum { plates = 20 };
    RadarStage     s;
    double complex mean = 0;
    const double   h_m = 0.002, k = 2 * pi_rad * x_hz / light_mps, want = exp(-2 * k * k * h_m * h_m);
    stage_open(&s, "plate:2x2", x_hz);
    const double complex even = stage_look(&s, 0, 0, INFINITY).vv;
    s.config.warp_m = h_m;
    s.config.warp_length_m = 0.2;
    for (int i = 0; i < plates; i++) {
        s.config.warp_seed = (uint64_t)i;
        mean += stage_look(&s, 0, 0, INFINITY).vv / even / plates;
    }
    const ScatterMatrix few = stage_look(&s, 3, 2, INFINITY);
    s.config.rays_per_radius *= 3;
    const ScatterMatrix many = stage_look(&s, 3, 2, INFINITY);
    printf("uneven plates: mean field %.3f %+.3fj, want %.3f; three times the tubes: %.1f dB apart\n", creal(mean),
           cimag(mean), want, 20 * log10(cabs(few.vv - many.vv) / cabs(many.vv)));
    CHECK(cabs(mean - want) < 0.05);
    CHECK(cabs(few.vv - many.vv) < 0.03 * cabs(many.vv));
    stage_close(&s);
}

/* An uneven trihedral: by the many tubes of its converged field, curved mirrors one after another. */
static void an_uneven_corner_converges(void **state)
{
    (void)state;
    RadarStage s;
    stage_open(&s, "corner:0.5", 3 * x_hz);
    const double even = sigma(stage_look(&s, 45, 35, INFINITY).hh);
    s.config.warp_m = 0.0005;
    s.config.warp_length_m = 0.4;
    s.config.rays_per_radius *= 2;
    const ScatterMatrix few = stage_look(&s, 45, 35, INFINITY);
    s.config.rays_per_radius *= 2;
    const ScatterMatrix many = stage_look(&s, 45, 35, INFINITY);
    printf("uneven corner of 50 wavelengths, 0.5 mm: %.2f dB below the even one; twice the tubes: %.1f dB apart\n",
           decibels(even / sigma(many.hh)), 20 * log10(cabs(few.hh - many.hh) / cabs(many.hh)));
    CHECK(decibels(even / sigma(many.hh)) > 0.3);
    CHECK(cabs(few.hh - many.hh) < 0.03 * cabs(many.hh));
    stage_close(&s);
}

/* ---- what is refused ---------------------------------------------------------------------------------- */

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_are_exact_at_every_range), cmocka_unit_test(the_field_is_the_same_everywhere),
        cmocka_unit_test(lists_serve_other_aspects),      cmocka_unit_test(bistatic_fields_are_reciprocal),
        cmocka_unit_test(bistatic_spheres_equal_mie),     cmocka_unit_test(an_uneven_plate_loses_what_it_must),
        cmocka_unit_test(an_uneven_corner_converges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
