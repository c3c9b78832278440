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

/* ---- threads ------------------------------------------------------------------------------------------ */

static void threads_change_no_bit(void **state)
{
    (void)state;
    TubeHits             first = {0};
    ScatterMatrix        want[33], got[33];
    RadarStage           s = {0};
    const ScatterAntenna tx = antenna_at(25, 8, 500), rx = antenna_at(40, 8, 500);
    stage_open(&s, "dihedral:0.5x0.4", x_hz);
    for (int threads = 0; threads < 5; threads++) {
        Pool *pool = NULL;
        if (threads > 0) CHECK(pool_create(&pool, threads) == STATUS_OK);
        TubeHits *hits = threads == 0 ? &first : &s.hits;
        CHECK(tubes_trace(hits, s.target, &tx, &rx, &s.config, pool) == STATUS_OK);
        CHECK(field_sweep(threads == 0 ? want : got, &(FrequencySweep){.count = 33, .first_hz = 9e9, .step_hz = 3e7},
                          hits, pool) == STATUS_OK);
        pool_destroy(pool);
        if (threads == 0) continue;
        CHECK(hits->count == first.count && hits->count > 1000);
        CHECK(memcmp(hits->path_m, first.path_m, hits->count * sizeof(double)) == 0);
        for (int c = 0; c < 8; c++)
            CHECK(memcmp(hits->amplitude[c], first.amplitude[c], hits->count * sizeof(float)) == 0);
        CHECK(memcmp(want, got, sizeof want) == 0);
    }
    tubes_free(&first);
    stage_close(&s);
}

/* ---- one list for many fields ------------------------------------------------------------------------- */

static void a_sweep_equals_its_frequencies(void **state)
{
    (void)state;
    enum { count = 200 };
    ScatterMatrix sweep[count], one;
    RadarStage    s;
    double        worst = 0;
    stage_open(&s, "trihedral:0.4", x_hz);
    const double peak = cabs(stage_look(&s, 50, 25, INFINITY).hh);
    CHECK(field_sweep(sweep, &(FrequencySweep){.count = count, .first_hz = 9.5e9, .step_hz = 5e6}, &s.hits, s.pool) ==
          STATUS_OK);
    for (int f = 0; f < count; f += 13) {
        CHECK(field_at(&one, 9.5e9 + f * 5e6, &s.hits, s.pool) == STATUS_OK);
        worst = fmax(worst, cabs(one.hh - sweep[f].hh) / peak);
        worst = fmax(worst, cabs(one.vh - sweep[f].vh) / peak);
    }
    printf("recurrence over %d frequencies: within %.1e\n", count, worst);
    CHECK(worst <= 1e-9);
    stage_close(&s);
}

/* Two models as two parts of one, the second moved. */
static void join(Model *out, const Model *a, const Model *b, const double shift[3])
{
    const Model *both[2] = {a, b};
    hand_model(out, 1, a->vertex_count + b->vertex_count, a->triangle_count + b->triangle_count);
    free(out->part);
    out->part = calloc(2, sizeof *out->part);
    out->part_count = 2;
    out->node[0].parent = -1;
    for (int k = 0; k < 2; k++) {
        const int first = out->vertex_count;
        out->part[k].first_triangle = out->triangle_count;
        for (int v = 0; v < both[k]->vertex_count; v++) {
            const int at = hand_vertex(out, both[k]->vertex[v][0] + k * shift[0], both[k]->vertex[v][1] + k * shift[1],
                                       both[k]->vertex[v][2] + k * shift[2]);
            memcpy(out->normal[at], both[k]->normal[v], sizeof out->normal[at]);
        }
        for (int t = 0; t < both[k]->triangle_count; t++) {
            const uint32_t *i = both[k]->triangle[t];
            hand_triangle(out, k, first + (int)i[0], first + (int)i[1], first + (int)i[2]);
        }
    }
    CHECK(model_measure(out) == STATUS_OK);
}

static void turn_plate_flat(Model *plate)
{
    for (int v = 0; v < plate->vertex_count; v++) {
        double *p = plate->vertex[v], x = p[0];
        float  *n = plate->normal[v], nx = n[0];
        p[0] = -p[2], p[2] = x;
        n[0] = -n[2], n[2] = nx;
    }
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

/* ---- curved mirrors ----------------------------------------------------------------------------------- */

/* A cylinder of radius r, h high, on a wide plate, seen from an elevation e: plate and cylinder in either order
 * return 8 pi r h^2 cos e / lambda: by images the cylinder's k r h^2 cos e, twice in amplitude. Either order gives
 * half of the field, where the cylinder comes first only if its curvature spreads the tubes as it must. */
static void a_curved_mirror_spreads_the_field(void **state)
{
    (void)state;
    const double r_m = 0.3, h_m = 0.4, e_deg = 40;
    Model        cylinder, plate;
    RadarStage   s = {0};
    const double up[3] = {0, 0, -h_m / 2};
    double       half[2];
    CHECK(radar_shape_build(&cylinder, "cylinder:0.3x0.4", 1e-5) == STATUS_OK &&
          radar_shape_build(&plate, "plate:3x3", 1) == STATUS_OK);
    turn_plate_flat(&plate);
    join(&s.model, &plate, &cylinder, up);
    stage_target(&s, 3e10);
    stage_look(&s, 33, e_deg, INFINITY);
    const double   want = 8 * pi_rad * r_m * h_m * h_m * cos(e_deg * rad_per_deg) * s.config.frequency_hz / light_mps;
    double complex whole = 0;
    for (int last = 0; last < 2; last++) {
        double complex sum = 0;
        const double   k = 2 * pi_rad * s.config.frequency_hz / light_mps;
        for (size_t i = 0; i < s.hits.count; i++) {
            if (s.hits.bounce[i] != 2 || s.hits.part[i] != last) continue;
            double x[2];
            for (int c = 0; c < 2; c++) {
                x[c] = k * (double)s.hits.slope_m[c][i];
                x[c] = fabs(x[c]) < 1e-6 ? 1 : sin(x[c]) / x[c];
            }
            sum += CMPLX((double)s.hits.amplitude[0][i], (double)s.hits.amplitude[1][i]) * x[0] * x[1] *
                   cexp(-I * k * s.hits.path_m[i]);
        }
        sum *= -I * k / (2 * pi_rad);
        half[last] = decibels(4 * sigma(sum) / want);
        whole += sum;
    }
    printf("top hat: cylinder first %.3f dB, plate first %.3f dB, both %.3f dB of the closed form\n", half[0], half[1],
           decibels(sigma(whole) / want));
    CHECK(fabs(half[0]) < 0.3 && fabs(half[1]) < 0.3 && fabs(decibels(sigma(whole) / want)) < 0.3);
    stage_close(&s);
    model_destroy(&cylinder);
    model_destroy(&plate);
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

/* ---- uneven surfaces ---------------------------------------------------------------------------------- */

static void warp_is_smooth_and_of_its_height(void **state)
{
    (void)state;
    Warp   w;
    double square = 0, worst = 0;
    hand_draw = 7;
    for (int i = 0; i < 4000; i++) {
        const double step = 1e-5;
        double       p[3], h, g[3], b[9];
        tubes_warp_make(&w, 0.002, 0.4, 11, i % 40);
        for (int c = 0; c < 3; c++) p[c] = hand_uniform(-3, 3);
        tubes_warp_at(&h, g, b, &w, p);
        square += h * h / 4000;
        for (int c = 0; c < 3; c++) {
            double q[3] = {p[0], p[1], p[2]}, h2, g2[3], b2[9];
            q[c] += step;
            tubes_warp_at(&h2, g2, b2, &w, q);
            worst = fmax(worst, fabs((h2 - h) / step - g[c] - 0.5 * step * b[4 * c]));
            for (int d = 0; d < 3; d++) worst = fmax(worst, fabs((g2[d] - g[d]) / step - b[3 * d + c]) * 0.01);
        }
    }
    printf("warp: %.4f mm rms for 2; derivatives within %.1e\n", 1000 * sqrt(square), worst);
    CHECK(fabs(sqrt(square) - 0.002) < 1e-4 && worst < 1e-6);
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

/* ---- rays and edges ----------------------------------------------------------------------------------- */

static void edges_are_added_to_the_rays(void **state)
{
    (void)state;
    enum { count = 70 };
    ScatterMatrix got[count], one[count], want;
    TotalField    field = {0}, alone = {0};
    RadarStage    s;
    double        worst = 0, moved = 0;
    stage_open(&s, "disc:0.4", x_hz);
    const ScatterAntenna tx = antenna_at(50, 20, 300), rx = antenna_at(55, 18, 300);
    const ScatterAntenna tx2 = antenna_at(50.02, 20.01, 300), rx2 = antenna_at(55.01, 18, 300);
    CHECK(total_field_trace(&field, s.target, &tx, &rx, &s.config, true, s.pool) == STATUS_OK);
    CHECK(field.edges.count > 100);
    CHECK(total_field_sweep(got, &(FrequencySweep){.count = count, .first_hz = 9e9, .step_hz = 2e7}, &field, s.pool) ==
          STATUS_OK);
    for (int f = 0; f < count; f += 3) {
        CHECK(field_at(&want, 9e9 + f * 2e7, &field.hits, s.pool) == STATUS_OK);
        const double complex rays = want.vv;
        edge_segments_field(&want, &field.edges, 2 * pi_rad * (9e9 + f * 2e7) / light_mps);
        worst = fmax(worst, (cabs(got[f].hh - want.hh) + cabs(got[f].hv - want.hv) + cabs(got[f].vv - want.vv)) /
                                cabs(want.vv));
        CHECK(cabs(want.vv - rays) > 1e-3 * cabs(want.vv)); /* they do something */
    }
    /* the same without threads */
    CHECK(total_field_trace(&alone, s.target, &tx, &rx, &s.config, true, NULL) == STATUS_OK);
    CHECK(total_field_sweep(one, &(FrequencySweep){.count = count, .first_hz = 9e9, .step_hz = 2e7}, &alone, NULL) ==
          STATUS_OK);
    CHECK(memcmp(got, one, sizeof got) == 0);
    /* moved antennas, against a look of their own; the rays' own list aside */
    CHECK(total_field_sweep(got, &(FrequencySweep){.count = 1, .first_hz = x_hz, .tx = &tx2, .rx = &rx2}, &field,
                            s.pool) == STATUS_OK);
    CHECK(field_sweep(one, &(FrequencySweep){.count = 1, .first_hz = x_hz, .tx = &tx2, .rx = &rx2}, &field.hits,
                      s.pool) == STATUS_OK);
    CHECK(total_field_trace(&alone, s.target, &tx2, &rx2, &s.config, true, s.pool) == STATUS_OK);
    want = (ScatterMatrix){0};
    edge_segments_field(&want, &alone.edges, 2 * pi_rad * x_hz / light_mps);
    moved = cabs(got[0].vv - one[0].vv - want.vv) / cabs(want.vv);
    printf("edges in a sweep: within %.1e; 0.02 degrees away: %.1e\n", worst, moved);
    CHECK(worst <= 1e-8 && moved <= 0.02);
    total_field_free(&field);
    total_field_free(&alone);
    stage_close(&s);
}

/* ---- what is refused ---------------------------------------------------------------------------------- */

static void bad_looks_are_refused(void **state)
{
    (void)state;
    RadarStage s;
    stage_open(&s, "plate:1x1", x_hz);
    log_set_sink(check_listen, NULL);
    ScatterAntenna a = antenna_at(10, 5, 0.1);
    CHECK(tubes_trace(&s.hits, s.target, &a, &a, &s.config, s.pool) == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "within the target"));
    a = antenna_at(0, 0, 100);
    a.u[0] = NAN;
    CHECK(tubes_trace(&s.hits, s.target, &a, &a, &s.config, s.pool) == STATUS_BAD_VALUE);
    a = antenna_at(0, 0, INFINITY);
    s.config.frequency_hz = 1e15;
    CHECK(tubes_trace(&s.hits, s.target, &a, &a, &s.config, s.pool) == STATUS_UNSUPPORTED);
    CHECK(radar_shape_build(&s.model, "sphere:1e9", 0.01) == STATUS_BAD_VALUE);
    CHECK(radar_shape_build(&s.model, "plate:1", 0.01) == STATUS_BAD_VALUE);
    CHECK(radar_shape_build(&s.model, "cube:1", 0.01) == STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_are_exact_at_every_range),
        cmocka_unit_test(the_field_is_the_same_everywhere),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(a_sweep_equals_its_frequencies),
        cmocka_unit_test(lists_serve_other_aspects),
        cmocka_unit_test(a_curved_mirror_spreads_the_field),
        cmocka_unit_test(bistatic_fields_are_reciprocal),
        cmocka_unit_test(bistatic_spheres_equal_mie),
        cmocka_unit_test(edges_are_added_to_the_rays),
        cmocka_unit_test(warp_is_smooth_and_of_its_height),
        cmocka_unit_test(an_uneven_plate_loses_what_it_must),
        cmocka_unit_test(an_uneven_corner_converges),
        cmocka_unit_test(bad_looks_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
