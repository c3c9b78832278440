/* Scattering centres against the hits and edges that they stand for: the field over a band, and from antennas that
 * have moved on. */
#include "tests/check.h"

#include "render/radar/centres.h"

enum { hits = 20000, frequencies = 33 };

static float          path_slope[2][hits], amplitude[8][hits], first[3][hits], last[3][hits];
static double         path_m[hits];
static uint8_t        bounce[hits];
static uint16_t       part[hits];
static const double   centre_hz = 94e9, band_hz = 500e6;
static ScatterAntenna antenna = {.u = {0.8, 0.36, 0.48}, .range_m = 3000};

/* Paths of one or two mirrors between points of a box of 6 x 3 x 2 m. */
static TubeHits some_hits(void)
{
    TubeHits h = {.tx = antenna, .rx = antenna, .frequency_hz = centre_hz, .count = hits, .path_m = path_m,
                  .slope_m = {path_slope[0], path_slope[1]}, .bounce = bounce, .part = part};
    for (int c = 0; c < 8; c++) h.amplitude[c] = amplitude[c];
    for (int x = 0; x < 3; x++) h.first[x] = first[x], h.last[x] = last[x];
    for (int i = 0; i < hits; i++) {
        static const double size_m[3] = {6, 3, 2};
        double              a[3], b[3], way[3];
        bounce[i] = (uint8_t)(1 + i % 2);
        part[i] = (uint16_t)(i % 7);
        for (int x = 0; x < 3; x++) {
            first[x][i] = (float)(size_m[x] * (random_uniform(1, (uint32_t)x, 0, (uint64_t)i) - 0.5));
            last[x][i] = bounce[i] == 1 ? first[x][i] : first[x][i] + (float)(0.4 * random_uniform(2, (uint32_t)x, 0, (uint64_t)i));
            a[x] = (double)first[x][i], b[x] = (double)last[x][i];
        }
        path_m[i] = scatter_path(way, &antenna, a) + scatter_path(way, &antenna, b) + (bounce[i] == 1 ? 0 : 0.3);
        for (int s = 0; s < 2; s++) path_slope[s][i] = (float)(1e-3 * random_uniform(3, (uint32_t)s, 0, (uint64_t)i));
        for (int c = 0; c < 8; c++) amplitude[c][i] = (float)(1e-4 * random_normal(4, (uint32_t)c, 0, (uint64_t)i));
    }
    return h;
}

/* Field of the centres at a wavenumber, from an antenna that the line of sight has turned to. */
static double complex field_of(const Centres *centres, double k, const ScatterAntenna *now)
{
    double complex sum = 0;
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        double               way[3];
        const double         moved = 2 * (scatter_path(way, now, c->p) - scatter_path(way, &antenna, c->p));
        sum += c->s.vv * cexp(-I * k * (c->path_m + moved));
    }
    return sum;
}

/* Errors are those of random phases: rms over the band, over the rms of the field. */
static void error_at(double phase_rad, double *of_band, double *of_turn, int *count)
{
    static ScatterMatrix want[frequencies];
    const double         turn_rad = 2e-4, step_hz = band_hz / (frequencies - 1);
    const TubeHits       h = some_hits();
    Centres              centres = {0};
    CHECK(centres_make(&centres, &(TotalField){.hits = h}, NULL, NULL,
                       &(CentresConfig){.frequency_hz = centre_hz, .bandwidth_hz = band_hz, .turn_rad = turn_rad,
                                        .phase_rad = phase_rad}) == STATUS_OK);
    double error = 0, power = 0;
    CHECK(field_sweep(want, frequencies, centre_hz - 0.5 * band_hz, step_hz, &h, NULL, NULL, NULL) == STATUS_OK);
    for (int f = 0; f < frequencies; f++) {
        const double k = 2 * pi_rad * (centre_hz - 0.5 * band_hz + f * step_hz) / light_mps;
        const double complex got = field_of(&centres, k, &antenna);
        error += pow(cabs(got - want[f].vv), 2);
        power += pow(cabs(want[f].vv), 2);
    }
    *of_band = sqrt(error / power);
    error = power = 0;
    for (int t = -8; t <= 8; t++) { /* the line of sight, half of the turn either way */
        ScatterAntenna now = antenna;
        ScatterMatrix  moved;
        now.u[0] -= now.u[1] * turn_rad / 2 * t / 8;
        now.u[1] += antenna.u[0] * turn_rad / 2 * t / 8;
        v3_scale(now.u, 1 / v3_length(now.u), now.u);
        CHECK(field_sweep(&moved, 1, centre_hz, 0, &h, &now, &now, NULL) == STATUS_OK);
        error += pow(cabs(field_of(&centres, 2 * pi_rad * centre_hz / light_mps, &now) - moved.vv), 2);
        power += pow(cabs(moved.vv), 2);
    }
    *of_turn = sqrt(error / power);
    *count = centres.count;
    centres_free(&centres);
}

static void centres_have_the_field_of_their_hits(void **state)
{
    (void)state;
    double of_band[3], of_turn[3];
    for (int i = 0; i < 3; i++) {
        static const double phase_rad[3] = {0.025, 0.1, 0.4};
        int                 count;
        error_at(phase_rad[i], &of_band[i], &of_turn[i], &count);
        printf("cells of %.3f rad: %d centres of %d hits: %.4f over the band, %.4f over the turn\n", phase_rad[i], count, hits,
               of_band[i], of_turn[i]);
        /* even over a cell: phase / 3^0.5 at an end of the band, 3^0.5 less over all of it */
        CHECK(of_band[i] < 0.5 * phase_rad[i] && of_turn[i] < 0.5 * phase_rad[i] + 0.01);
    }
    CHECK(of_band[0] < 0.1 * of_band[2]); /* it falls with the cells */
}

/* At the centre of band and interval nothing is lost but rounding, however large the cells. */
static void middle_is_exact(void **state)
{
    (void)state;
    const TubeHits h = some_hits();
    Centres        centres = {0};
    ScatterMatrix  want;
    double complex got = 0;
    CHECK(centres_make(&centres, &(TotalField){.hits = h}, NULL, NULL,
                       &(CentresConfig){.frequency_hz = centre_hz, .bandwidth_hz = 1e6, .turn_rad = 1e-6, .phase_rad = 0.5}) ==
          STATUS_OK);
    CHECK(field_at(&want, centre_hz, &h, NULL) == STATUS_OK);
    for (int i = 0; i < centres.count; i++)
        got += centres.centre[i].s.hh * cexp(-I * 2 * pi_rad * centre_hz / light_mps * centres.centre[i].path_m);
    CHECK(centres.count < hits / 100);
    CHECK(cabs(got - want.hh) < 1e-9 * cabs(want.hh));
    centres_free(&centres);
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
    Centres              centres = {0};
    double complex       got = 0;
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
    CHECK(total_field_sweep(&want, 1, centre_hz, 0, &field, &now, &now, NULL) == STATUS_OK);
    CHECK(centres_make(&centres, &field, &now, &now,
                       &(CentresConfig){.frequency_hz = centre_hz, .bandwidth_hz = band_hz, .turn_rad = 1e-4, .phase_rad = 0.1}) ==
          STATUS_OK);
    int of_edges = 0;
    for (int i = 0; i < centres.count; i++) {
        got += centres.centre[i].s.hv * cexp(-I * 2 * pi_rad * centre_hz / light_mps * centres.centre[i].path_m);
        of_edges += centres.centre[i].bounce == 0 && centres.centre[i].part == 3;
    }
    CHECK(cabs(want.hv) > 1e-3 && cabs(got - want.hv) < 1e-6 * cabs(want.hv));
    CHECK(of_edges > edges / 2);
    centres_free(&centres);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(centres_have_the_field_of_their_hits),
        cmocka_unit_test(middle_is_exact),
        cmocka_unit_test(edges_are_centres_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
