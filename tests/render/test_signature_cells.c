/* Cells of signatures by hand: how wide they are, what one holds of its hits and edges, which are merged. labels:
 * physics
 */
#include "tests/check.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/signatures/centres.h"

enum { hits = 64 };

static float        path_slope[2][hits], amplitude[8][hits], first[3][hits], last[3][hits];
static double       path_m[hits];
static uint8_t      bounce[hits];
static uint16_t     part[hits];
static const double centre_hz = 94e9, band_hz = 500e6, turn_rad = 0.3 * rad_per_deg;

/* A hit of one mirror, about the origin; its path is given, whatever its place. */
static void put_hit(TubeHits *h, double path, double x, double y, double z, double size)
{
    const size_t i = h->count++;
    const double at[3] = {x, y, z};
    path_m[i] = path;
    for (int k = 0; k < 3; k++) first[k][i] = last[k][i] = (float)at[k];
    for (int s = 0; s < 2; s++) path_slope[s][i] = s ? 1e-4f : 2e-4f;
    for (int c = 0; c < 8; c++) amplitude[c][i] = (float)(size * (c + 1.0));
    bounce[i] = 1, part[i] = 0;
}

static TubeHits no_hits(void)
{
    TubeHits h = {.path_m = path_m, .slope_m = {path_slope[0], path_slope[1]}, .bounce = bounce, .part = part};
    for (int c = 0; c < 8; c++) h.amplitude[c] = amplitude[c];
    for (int x = 0; x < 3; x++) h.first[x] = first[x], h.last[x] = last[x];
    h.tx = h.rx = (ScatterAntenna){{1, 0, 0}, INFINITY}; /* right is y, up z: scatter.h's h and v = u x h */
    return h;
}

static void make_of(Signature *s, const TubeHits *h, const SignatureCells *cells, const RadarTarget *target)
{
    const TotalField field = {.hits = *h};
    CHECK(signature_make(s, &field, target, cells) == STATUS_OK);
}

/* Amplitude of a hit of put_hit: -j k / 2 pi sinc sinc (re + j im). */
static double complex field_of(int q, double size, double k)
{
    const double a = k * (double)2e-4f, b = k * (double)1e-4f;
    return -I * k / (2 * pi_rad) * sin(a) / a * sin(b) / b * size * (2.0 * q + 1 + I * (2.0 * q + 2));
}

/* Sides of cells: phases of 0.2 rad half a cell from the middle, at the ends of the band (pi B / c of path) and at the
 * edge of the bin (k times half of its width, there and back); at most 10 m and 0.1 m. */
static void cells_are_as_wide_as_phases_allow(void **state)
{
    (void)state;
    const SignatureCells cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0.01);
    const double         k = 2 * pi_rad * centre_hz / light_mps, step_m = 0.4 * light_mps / (pi_rad * band_hz);
    const double         across_m = 0.4 / (k * turn_rad);
    CHECK(cells.path_phase_rad == 0.2 && cells.across_phase_rad == 0.2 && cells.spin_phase_rad == 1);
    CHECK(cells.weak_share == 0.01 && cells.weak_times == 4 && cells.interval_s == 0.01);
    /* a third of a third of the phase's square along, 0.4 of the phase's square across; weak ones four times as wide */
    CHECK_NEAR(signature_cells_error(), 0.99 * (0.04 / 9 + pow(0.4 * 0.04, 2)) + 0.01 * (0.64 / 9 + pow(0.4 * 0.64, 2)),
               1e-12);
    static const struct {
        double from, to;
        int    count;
    } of[] = {{0.01, 0.99, 1}, {0.99, 1.01, 2}, {-0.01, 0.01, 2}, {-0.99, -0.01, 1}, {3.02, 3.98, 1}, {3.98, 4.02, 2}};
    for (int axis = 0; axis < 3; axis++)
        for (int wide = 0; wide < 2; wide++)
            for (int i = 0; i < 6; i++) {
                Signature      s = {0};
                TubeHits       h = no_hits();
                SignatureCells c = cells;
                double         side_m = axis == 0 ? step_m : across_m;
                if (wide) c.bandwidth_hz = 10, c.turn_rad = 1e-7, side_m = axis == 0 ? 10 : 0.1;
                for (int end = 0; end < 2; end++) {
                    const double at_m = side_m * (end ? of[i].to : of[i].from);
                    put_hit(&h, axis == 0 ? at_m : 0.01, 0, axis == 1 ? at_m : 0.01, axis == 2 ? at_m : 0.01, 1e-4);
                }
                make_of(&s, &h, &c, NULL);
                CHECK_NEAR(s.path_step_m, wide ? 10 : step_m, 1e-9);
                if (s.count != of[i].count) fail_msg("axis %d, case %d: %d cells", axis, i, s.count);
                signature_free(&s);
            }
}

/* Two hits in one cell: the path at which the sum's phase turns over the band, the mean of theirs weighted by conj(sum)
 * v; point and moments by amplitude; numbers as 16 and 8 bits of the largest. One alone has no moments. */
static void a_cell_holds_sum_and_moments(void **state)
{
    (void)state;
    const SignatureCells cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0);
    const double         k = 2 * pi_rad * centre_hz / light_mps, step_m = 0.4 * light_mps / (pi_rad * band_hz);
    static const double  path[2] = {0.0801, 0.0833}, size[2] = {1e-4, 6e-5};
    static const double  y[2] = {0.003, 0.02}, z[2] = {0.031, 0.008};
    for (int n = 1; n <= 2; n++) {
        Signature      s = {0};
        TubeHits       h = no_hits();
        double complex sum[4] = {0}, moment[2][4] = {{0}};
        double         along = 0, power = 0, weight = 0, same = 0, cross = 0, p[3] = {0};
        for (int i = 0; i < n; i++) put_hit(&h, path[i], -0.5, y[i], z[i], size[i]);
        make_of(&s, &h, &cells, NULL);
        CHECK(s.count == 1);
        const SignatureCentre *c = &s.centre[0];
        for (int pass = 0; pass < 2; pass++) /* about the first's path; then about the mean */
            for (int q = 0; q < 4; q++) {
                const double about = pass == 0 ? path[0] : path[0] + along / power;
                if (pass == 1) sum[q] = 0;
                for (int i = 0; i < n; i++) sum[q] += field_of(q, size[i], k) * cexp(-I * k * (path[i] - about));
                if (pass == 1) continue;
                power += creal(conj(sum[q]) * sum[q]);
                for (int i = 0; i < n; i++)
                    along += (path[i] - path[0]) *
                             creal(conj(sum[q]) * field_of(q, size[i], k) * cexp(-I * k * (path[i] - about)));
            }
        const double mean_m = path[0] + along / power;
        for (int i = 0; i < n; i++) {
            double squares = 0;
            for (int q = 0; q < 4; q++) {
                const double complex v = field_of(q, size[i], k);
                squares += 0.5 * creal(conj(v) * v);
                *(q % 3 == 0 ? &same : &cross) += 0.5 * creal(conj(v) * v);
            }
            const double a = sqrt(squares);
            weight += a, p[0] += a * -0.5, p[1] += a * y[i], p[2] += a * z[i];
            if (i == 0) CHECK_NEAR((double)c->strongest / a, 1, 1e-6);
        }
        CHECK_NEAR((c->path + (double)c->path_share) * step_m, mean_m, 1e-7);
        CHECK(c->path == (int)floor(mean_m / step_m) && c->bounce == 1 && c->part == 0);
        CHECK_NEAR((double)c->weight / weight, 1, 1e-6);
        CHECK_NEAR(s.tubes_same_m2 / same, 1, 1e-6);
        CHECK_NEAR(s.tubes_cross_m2 / cross, 1, 1e-6);
        double most = 0, most_moment = 0;
        for (int x = 0; x < 3; x++) {
            CHECK_NEAR((double)c->p[x], p[x] / weight, 1e-7);
            CHECK(c->half[x] == 0);
        }
        for (int q = 0; q < 4; q++) {
            for (int i = 0; i < n; i++) {
                const double complex v = field_of(q, size[i], k) * cexp(-I * k * (path[i] - mean_m));
                moment[0][q] += (y[i] - p[1] / weight) * v, moment[1][q] += (z[i] - p[2] / weight) * v;
            }
            most = fmax(most, fmax(fabs(creal(sum[q])), fabs(cimag(sum[q]))));
            for (int x = 0; x < 2; x++)
                most_moment = fmax(most_moment, fmax(fabs(creal(moment[x][q])), fabs(cimag(moment[x][q]))));
        }
        CHECK_NEAR((double)c->scale / most, 1, 1e-4);
        if (n == 1) CHECK((double)c->moment_scale < 1e-6 * most);
        else CHECK_NEAR((double)c->moment_scale / most_moment, 1, 1e-3);
        for (int q = 0; q < 4; q++) {
            CHECK_NEAR(c->s[2 * q], 32767 * creal(sum[q]) / most, 3);
            CHECK_NEAR(c->s[2 * q + 1], 32767 * cimag(sum[q]) / most, 3);
            for (int x = 0; x < 2 && n == 2; x++) {
                CHECK_NEAR(c->moment[x][2 * q], 127 * creal(moment[x][q]) / most_moment, 0.7);
                CHECK_NEAR(c->moment[x][2 * q + 1], 127 * cimag(moment[x][q]) / most_moment, 0.7);
            }
        }
        signature_free(&s);
    }
}

/* Two that nearly cancel have their mean path far beyond both: it is held at the border of their cell. */
static void a_mean_path_stays_in_its_cell(void **state)
{
    (void)state;
    const SignatureCells cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0);
    const double         step_m = 0.4 * light_mps / (pi_rad * band_hz), half_m = 0.5 * light_mps / centre_hz;
    for (int up = 0; up < 2; up++) {
        Signature s = {0};
        TubeHits  h = no_hits();
        put_hit(&h, 1.3 * step_m, 0, 0.01, 0.01, up ? 0.9e-4 : 1e-4);
        put_hit(&h, 1.3 * step_m + 5 * half_m, 0, 0.01, 0.01, up ? 1e-4 : 0.9e-4); /* 2.5 wavelengths: opposite */
        make_of(&s, &h, &cells, NULL);
        CHECK(s.count == 1);
        CHECK_NEAR(s.centre[0].path + (double)s.centre[0].path_share, up ? 2 : 1, 1e-6);
        signature_free(&s);
    }
}

/* The weakest, which have a hundredth of all squares, are in cells four times as wide: of those that are alike, all. */
static void weak_cells_are_wider(void **state)
{
    (void)state;
    SignatureCells cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0);
    const double   step_m = 0.4 * light_mps / (pi_rad * band_hz);
    static const struct {
        double size; /* of eight, over one strong */
        int    count, without;
    } of[] = {{0.035, 3, 9}, {0.0999, 3, 9}, {0.105, 9, 9}};
    for (int i = 0; i < 3; i++)
        for (int none = 0; none < 2; none++) {
            Signature s = {0};
            TubeHits  h = no_hits();
            put_hit(&h, 20.5 * step_m, 0, 0.01, 0.01, 1e-4);
            for (int n = 0; n < 8; n++) put_hit(&h, (n + 0.5) * step_m, 0, 0.01, 0.01, 1e-4 * of[i].size);
            cells.weak_share = none ? 0 : 0.01;
            make_of(&s, &h, &cells, NULL);
            if (s.count != (none ? of[i].without : of[i].count)) fail_msg("case %d, %d: %d", i, none, s.count);
            signature_free(&s);
        }
}

/* On a node that spins, or rolls at 20 m/s, cells are as long as half an interval turns the phase by 1 rad half a cell
 * from the middle: k T / 4 of the range rates, 2 w across the axis, to a cell. Other nodes have cells of their own. */
static void what_turns_has_cells_of_range_rate(void **state)
{
    (void)state;
    static ModelNode    node[3] = {{.parent = -1, .axis = {0, 0, 1}},
                                   {.parent = 0, .axis = {0, 0, 1}, .spin_rps_moving = 40},
                                   {.parent = 1, .axis = {0, 0, 1}, .roll_radius_m = 0.5}};
    static ModelPart    parts[3] = {{.node = 0}, {.node = 1}, {.node = 2}};
    static NodePose     pose[3];
    Model               model = {.node_count = 3, .part_count = 3, .node = node, .part = parts};
    RadarTarget         target = {.model = &model, .pose = pose};
    SignatureCells      cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0.002);
    const double        k = 2 * pi_rad * centre_hz / light_mps;
    static const double w_rps[3] = {0, 40, 80}; /* 20 m/s over 0.5 m: 40, beside its parent's 40 */
    for (int n = 0; n < 3; n++) pose[n] = (NodePose){.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int n = 0; n < 3; n++) {
        const double side_m = n == 0 ? 1 : 4 / (k * 0.002 * 2 * w_rps[n]);
        CHECK(n == 0 || side_m < 0.5 * 0.4 / (k * turn_rad)); /* well within a cell across */
        for (int i = 0; i < 2; i++) {
            Signature s = {0};
            TubeHits  h = no_hits();
            put_hit(&h, 0.01, 0, side_m * (n == 0 ? 0.001 : i ? 0.97 : 0.03), 0.01, 1e-4);
            put_hit(&h, 0.01, 0, side_m * (n == 0 ? 0.03 : i ? 1.03 : 0.97), 0.01, 1e-4);
            part[0] = part[1] = (uint16_t)n;
            make_of(&s, &h, &cells, &target);
            if (s.count != (n > 0 && i ? 2 : 1)) fail_msg("node %d, case %d: %d", n, i, s.count);
            signature_free(&s);
        }
    }
    Signature s = {0};
    TubeHits  h = no_hits();
    for (int n = 0; n < 3; n++) put_hit(&h, 0.01, 0, 1e-4, 0.01, 1e-4), part[n] = (uint16_t)n;
    make_of(&s, &h, &cells, &target);
    CHECK(s.count == 3 && s.centre[2].part == 2);
    signature_free(&s);
}

/* An edge by itself: its field at the centre frequency with the share that its slope leaves, sin x / x of x = k slope
 * length / 2, and what its order fades, (order_k / k)^(order / 2); half of the squares of its entries are its weight's.
 */
static void an_edge_has_a_cell(void **state)
{
    (void)state;
    const SignatureCells cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0);
    const double         k = 2 * pi_rad * centre_hz / light_mps, step_m = 0.4 * light_mps / (pi_rad * band_hz);
    for (int order = 0; order < 3; order++) {
        EdgeSegment      e = {.part = 4, .order = order, .order_k = 1200, .p = {0.2, 0.011, 0.017}, .length_m = 0.03};
        Signature        s = {0};
        const TotalField field = {.hits = no_hits(), .edges = {.count = 1, .segment = &e}};
        double           squares = 0, most = 0;
        e.slope = 0.02, e.path_m = -0.31;
        for (int q = 0; q < 4; q++) e.amplitude[q / 2][q % 2] = (0.01 + 0.03 * q) - 0.02 * I * (q + 1.0);
        CHECK(signature_make(&s, &field, NULL, &cells) == STATUS_OK && s.count == 1);
        const SignatureCentre *c = &s.centre[0];
        const double           x = 0.5 * k * 0.02 * 0.03, share = sin(x) / x * pow(1200 / k, 0.5 * order);
        for (int q = 0; q < 4; q++) {
            const double complex a = e.amplitude[q / 2][q % 2];
            squares += creal(a) * creal(a) + cimag(a) * cimag(a);
            most = fmax(most, share * fmax(fabs(creal(a)), fabs(cimag(a))));
        }
        CHECK(c->bounce == 0 && c->part == 4 && s.tubes_same_m2 == 0 && s.tubes_cross_m2 == 0);
        CHECK_NEAR((double)c->weight / (share * sqrt(0.5 * squares)), 1, 1e-6);
        CHECK_NEAR((double)c->scale / most, 1, 1e-4); /* its path is kept to a few micrometres */
        CHECK_NEAR((c->path + (double)c->path_share) * step_m, -0.31, 1e-7);
        for (int q = 0; q < 4; q++) {
            const double complex a = share * e.amplitude[q / 2][q % 2];
            CHECK_NEAR(c->s[2 * q], 32767 * creal(a) / most, 3);
            CHECK_NEAR(c->s[2 * q + 1], 32767 * cimag(a) / most, 3);
        }
        for (int i = 0; i < 3; i++) CHECK_NEAR((double)c->p[i], e.p[i], 1e-7);
        signature_free(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_are_as_wide_as_phases_allow),  cmocka_unit_test(a_cell_holds_sum_and_moments),
        cmocka_unit_test(a_mean_path_stays_in_its_cell),      cmocka_unit_test(weak_cells_are_wider),
        cmocka_unit_test(what_turns_has_cells_of_range_rate), cmocka_unit_test(an_edge_has_a_cell),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
