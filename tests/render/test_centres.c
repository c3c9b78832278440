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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_a_list_are_checked),
        cmocka_unit_test(centres_have_the_field_of_their_hits),
        cmocka_unit_test(middle_is_exact),
        cmocka_unit_test(edges_are_centres_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
