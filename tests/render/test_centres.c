/* Signatures and their centres against the hits and edges that they stand for: the field over a band, and from antennas
 * elsewhere in the bin. labels: physics */
#include "tests/check.h"

#include "render/scattering/signatures/centres.h"
#include "render/scattering/field/total_field.h"

enum { hits = 20000, frequencies = 33 };

static float          path_slope[2][hits], amplitude[8][hits], first[3][hits], last[3][hits];
static double         path_m[hits];
static uint8_t        bounce[hits];
static uint16_t       part[hits];
static const double   centre_hz = 94e9, band_hz = 500e6;
static ScatterAntenna antenna = {.u = {0.8, 0.36, 0.48}, .range_m = 3000};

/* Paths of one or two mirrors between points of a box of 1.2 x 0.6 x 0.3 m. */
static TubeHits some_hits(void)
{
    TubeHits h = {.tx = antenna,
                  .rx = antenna,
                  .frequency_hz = centre_hz,
                  .count = hits,
                  .path_m = path_m,
                  .slope_m = {path_slope[0], path_slope[1]},
                  .bounce = bounce,
                  .part = part};
    for (int c = 0; c < 8; c++) h.amplitude[c] = amplitude[c];
    for (int x = 0; x < 3; x++) h.first[x] = first[x], h.last[x] = last[x];
    for (int i = 0; i < hits; i++) {
        static const double size_m[3] = {1.2, 0.6, 0.3};
        double              a[3], b[3], way[3];
        bounce[i] = (uint8_t)(1 + i % 2);
        part[i] = (uint16_t)(i % 7);
        for (int x = 0; x < 3; x++) {
            first[x][i] = (float)(size_m[x] * (random_uniform(1, (uint32_t)x, 0, (uint64_t)i) - 0.5));
            last[x][i] = bounce[i] == 1 ? first[x][i]
                                        : first[x][i] + (float)(0.1 * random_uniform(2, (uint32_t)x, 0, (uint64_t)i));
            a[x] = (double)first[x][i], b[x] = (double)last[x][i];
        }
        path_m[i] = scatter_path(way, &antenna, a) + scatter_path(way, &antenna, b) + (bounce[i] == 1 ? 0 : 0.3);
        for (int s = 0; s < 2; s++) path_slope[s][i] = (float)(1e-3 * random_uniform(3, (uint32_t)s, 0, (uint64_t)i));
        for (int c = 0; c < 8; c++) amplitude[c][i] = (float)(1e-4 * random_normal(4, (uint32_t)c, 0, (uint64_t)i));
    }
    return h;
}

static const double turn_rad = 0.3 * rad_per_deg;

static SignatureCells cells_of(double phase_rad)
{
    SignatureCells cells = signature_default_cells(centre_hz, band_hz, turn_rad, 0);
    cells.path_phase_rad = cells.across_phase_rad = phase_rad;
    return cells;
}

/* An antenna at the edge of the bin, by two angles of half a bin, and nearer or farther by the most that a bin spans.
 */
static ScatterAntenna moved(int az, int el, double range)
{
    ScatterAntenna now = antenna;
    double         h[3], v[3];
    scatter_basis(h, v, antenna.u);
    v3_add_scaled(now.u, now.u, 0.5 * turn_rad * az, h);
    v3_add_scaled(now.u, now.u, 0.5 * turn_rad * el, v);
    v3_scale(now.u, 1 / v3_length(now.u), now.u);
    now.range_m *= range;
    return now;
}

static void add(double *error, double *power, const ScatterMatrix *got, const ScatterMatrix *want)
{
    const double complex g[4] = {got->hh, got->hv, got->vh, got->vv}, w[4] = {want->hh, want->hv, want->vh, want->vv};
    for (int p = 0; p < 4; p++) *error += pow(cabs(g[p] - w[p]), 2), *power += pow(cabs(w[p]), 2);
}

/* Errors are those of random phases: rms over band or bin, over the rms of the field. */
static void error_at(double phase_rad, double *of_band, double *of_bin, int *count)
{
    static ScatterMatrix want[frequencies];
    const double         step_hz = band_hz / (frequencies - 1);
    const TubeHits       h = some_hits();
    const SignatureCells cells = cells_of(phase_rad);
    Signature            signature = {0};
    Centres              centres = {0};
    ScatterMatrix        got;
    CHECK(signature_make(&signature, &(TotalField){.hits = h}, NULL, &cells) == STATUS_OK);
    CHECK(signature_is_sound(&signature, 7) && !signature_is_sound(&signature, 3));
    double error = 0, power = 0;
    CHECK(field_sweep(
              want, &(FrequencySweep){.count = frequencies, .first_hz = centre_hz - 0.5 * band_hz, .step_hz = step_hz},
              &h, NULL) == STATUS_OK);
    CHECK(centres_make(&centres, &signature, &antenna, &antenna, NULL) == STATUS_OK);
    for (int f = 0; f < frequencies; f++) {
        centres_field(&got, &centres, centre_hz - 0.5 * band_hz + f * step_hz);
        add(&error, &power, &got, &want[f]);
    }
    *of_band = sqrt(error / power);
    error = power = 0;
    for (int i = 0; i < 18; i++) {
        const ScatterAntenna now = moved(i % 3 - 1, i / 3 % 3 - 1, i < 9 ? 1.09 : 0.917);
        ScatterMatrix        exact;
        CHECK(field_sweep(&exact, &(FrequencySweep){.count = 1, .first_hz = centre_hz, .tx = &now, .rx = &now}, &h,
                          NULL) == STATUS_OK);
        CHECK(centres_make(&centres, &signature, &now, &now, NULL) == STATUS_OK);
        centres_field(&got, &centres, centre_hz);
        add(&error, &power, &got, &exact);
    }
    *of_bin = sqrt(error / power);
    *count = centres.count;
    centres_free(&centres);
    signature_free(&signature);
}

/* Of paths that fill their cells evenly, with random phases. Over the band the mean path and no more is kept: the error
 * is of first order, phase / 3, rms over cell and band. Across, first moments are kept and half the square of the
 * phase is the error: rms 0.516 phase^2 at the corners of the bin, 0.224 in the middle of its sides, 0.375 phase^2 over
 * both and the middle. A band of 4 or 5 resolution cells of this box, in 4 polarisations, is some 16 draws, whose rms
 * is within 1.4 in 95 of 100 cases; the bin's are more. */
static void centres_have_the_field_of_their_hits(void **state)
{
    (void)state;
    double of_band[4], of_bin[4];
    for (int i = 0; i < 4; i++) {
        static const double phase_rad[4] = {0.1, 0.3, 0.6, 0.9};
        int                 count;
        error_at(phase_rad[i], &of_band[i], &of_bin[i], &count);
        printf("cells of %.1f rad: %d centres of %d hits: %.4f over the band, %.4f at the edge of the bin\n",
               phase_rad[i], count, hits, of_band[i], of_bin[i]);
        CHECK(of_band[i] < 1.4 * phase_rad[i] / 3 && of_bin[i] < 1.2 * 0.375 * phase_rad[i] * phase_rad[i]);
    }
    CHECK(of_bin[2] > 3 * of_bin[1] && of_bin[2] < 5 * of_bin[1]); /* of second order: four times */
}

/* In the middle of band and bin nothing is lost but the rounding of 16 bits, however large the cells. */
static void middle_is_exact(void **state)
{
    (void)state;
    const TubeHits       h = some_hits();
    const SignatureCells cells = signature_default_cells(centre_hz, 1e6, 1e-5, 0);
    Signature            signature = {0};
    Centres              centres = {0};
    ScatterMatrix        want, got;
    CHECK(signature_make(&signature, &(TotalField){.hits = h}, NULL, &cells) == STATUS_OK);
    CHECK(centres_make(&centres, &signature, &antenna, &antenna, NULL) == STATUS_OK);
    CHECK(field_at(&want, centre_hz, &h, NULL) == STATUS_OK);
    centres_field(&got, &centres, centre_hz);
    CHECK(centres.count < hits / 100);
    CHECK(cabs(got.hh - want.hh) < 1e-4 * cabs(want.hh));
    centres_free(&centres);
    signature_free(&signature);
}

/* Edges among the hits, of one antenna and of one that has moved: as total_field_sweep adds them. */
static void edges_are_centres_too(void **state)
{
    (void)state;
    enum { edges = 300 };
    static EdgeSegment   segment[edges];
    const ScatterAntenna now = {.u = {0.8, 0.3601, 0.479925}, .range_m = 2990};
    TotalField           field = {.hits = some_hits(), .edges = {.count = edges, .segment = segment}};
    ScatterMatrix        want;
    Signature            signature = {0};
    Centres              centres = {0};
    ScatterMatrix        got;
    field.hits.count = 1000;
    for (int i = 0; i < edges; i++) {
        EdgeSegment *e = &segment[i];
        double       way[2][3];
        e->length_m = 0.05;
        e->part = 3;
        for (int x = 0; x < 3; x++) e->p[x] = 4 * (random_uniform(5, (uint32_t)x, 0, (uint64_t)i) - 0.5);
        e->path_m = scatter_path(way[0], &antenna, e->p) + scatter_path(way[1], &antenna, e->p);
        e->slope = 0.02 * random_uniform(5, 4, 0, (uint64_t)i);
        memcpy(e->u[0], way[0], sizeof way[0]);
        memcpy(e->u[1], way[1], sizeof way[1]);
        for (int c = 0; c < 4; c++) e->amplitude[c / 2][c % 2] = 0.01 * random_normal(6, (uint32_t)c, 0, (uint64_t)i);
    }
    CHECK(total_field_sweep(&want, &(FrequencySweep){.count = 1, .first_hz = centre_hz, .tx = &now, .rx = &now}, &field,
                            NULL) == STATUS_OK);
    const SignatureCells cells = cells_of(0.05);
    CHECK(signature_make(&signature, &field, NULL, &cells) == STATUS_OK);
    CHECK(centres_make(&centres, &signature, &now, &now, NULL) == STATUS_OK);
    centres_field(&got, &centres, centre_hz);
    int of_edges = 0;
    for (int i = 0; i < centres.count; i++) of_edges += centres.centre[i].bounce == 0 && centres.centre[i].part == 3;
    printf("edges among hits, an antenna moved on: %.5f\n", cabs(got.hv - want.hv) / cabs(want.hv));
    CHECK(cabs(want.hv) > 1e-3 && cabs(got.hv - want.hv) < 1e-3 * cabs(want.hv));
    CHECK(of_edges > edges / 2);
    centres_free(&centres);
    signature_free(&signature);
}

/* Each number of a list from a file just within and just beyond what is believed of it. */
static void numbers_of_a_list_are_checked(void **state)
{
    (void)state;
    const SignatureCentre fine = {
        .path_share = 0.5f, .scale = 1, .moment_scale = 1, .weight = 2, .strongest = 1, .part = 2};
    SignatureCentre c = fine;
    Signature       s = {.count = 1, .centre = &c};
    CHECK(signature_is_sound(&s, 3));
#define TRY(member, value, sound)                                                                                      \
    do {                                                                                                               \
        const Signature kept = s;                                                                                      \
        c = fine;                                                                                                      \
        member = value;                                                                                                \
        if (signature_is_sound(&s, 3) != (sound)) fail_msg("%s = %.9g", #member, (double)(value));                     \
        s = kept, c = fine;                                                                                            \
    } while (0)
    TRY(s.tubes_same_m2, 0.999e18, true);
    TRY(s.tubes_same_m2, 1e18, false);
    TRY(s.tubes_same_m2, -1e-9, false);
    TRY(s.tubes_cross_m2, 0.999e18, true);
    TRY(s.tubes_cross_m2, 1e18, false);
    TRY(s.tubes_cross_m2, -1e-9, false);
    TRY(s.tubes_same_m2, NAN, false);
    TRY(s.tubes_cross_m2, NAN, false);
    TRY(c.path, 999999999, true);
    TRY(c.path, 1000000000, false);
    TRY(c.path, -999999999, true);
    TRY(c.path, -1000000000, false);
    TRY(c.part, 3, false);
    TRY(c.zero, 1, false);
    for (int x = 0; x < 3; x++) {
        TRY(c.p[x], 0.999e5f, true);
        TRY(c.p[x], 1e5f, false);
        TRY(c.p[x], -1e5f, false);
        TRY(c.p[x], NAN, false);
        TRY(c.half[x], 0.999e5f, true);
        TRY(c.half[x], 1e5f, false);
        TRY(c.half[x], -1e5f, false);
        TRY(c.half[x], NAN, false);
    }
    TRY(c.path_share, 0, true);
    TRY(c.path_share, 1, true);
    TRY(c.path_share, 1.001f, false);
    TRY(c.path_share, -0.001f, false);
    TRY(c.path_share, NAN, false);
    TRY(c.scale, 0, true);
    TRY(c.scale, 0.999e9f, true);
    TRY(c.scale, 1e9f, false);
    TRY(c.scale, -1, false);
    TRY(c.moment_scale, 0, true);
    TRY(c.moment_scale, 0.999e9f, true);
    TRY(c.moment_scale, 1e9f, false);
    TRY(c.moment_scale, -1, false);
    TRY(c.weight, 0.999e9f, true);
    TRY(c.weight, 1e9f, false);
    TRY(c.weight, 0, false);
    TRY(c.strongest, 0, false);
    TRY(c.strongest, 2, true);
    TRY(c.strongest, 2.001f, true);
    TRY(c.strongest, 2.01f, false);
#undef TRY
}

/* ---- cells by hand ------------------------------------------------------------------------------------- */

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
    TubeHits h = some_hits();
    h.count = 0;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_a_list_are_checked),
        cmocka_unit_test(centres_have_the_field_of_their_hits),
        cmocka_unit_test(middle_is_exact),
        cmocka_unit_test(edges_are_centres_too),
        cmocka_unit_test(cells_are_as_wide_as_phases_allow),
        cmocka_unit_test(a_cell_holds_sum_and_moments),
        cmocka_unit_test(a_mean_path_stays_in_its_cell),
        cmocka_unit_test(weak_cells_are_wider),
        cmocka_unit_test(what_turns_has_cells_of_range_rate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
