/* Waves that cross a plate from one edge to the other, off the plane across them: as in that plane with the wave number
 * that the edges' own leaves; their paths, pieces and limits by hand. labels: physics */
#include "tests/render/hand_mesh.h"
#include "render/scattering/field/edge_field_private.h"

static const double pi = 3.14159265358979323846, wide_m = 0.3, long_m = 2;

static WedgeList list;
static EdgePairs pairs;
static int       upright; /* the pair whose edges lie along z */

/* A plate in the plane x = 0, its long edges along z. */
static int open_plate(void **state)
{
    (void)state;
    begin();
    add_panel((const double[3]){0, -wide_m / 2, -long_m / 2}, (const double[3]){0, wide_m, 0},
              (const double[3]){0, 0, long_m}, 1, 0);
    list = find();
    if (edge_pairs_find(&pairs, list.wedge, list.count) != STATUS_OK) return -1;
    for (upright = 0; upright < pairs.count; upright++) {
        const EdgePair *p = &pairs.pair[upright];
        if (fabs(list.wedge[p->wedge[0]].frame.z[2]) > 0.9) break;
    }
    if (upright == pairs.count) return -1;
    CHECK_NEAR(pairs.pair[upright].width_m, wide_m, 1e-9);
    CHECK_NEAR(pairs.pair[upright].along_m[1] - pairs.pair[upright].along_m[0], long_m, 1e-9);
    return 0;
}

static int close_plate(void **state)
{
    (void)state;
    wedges_destroy(&list);
    edge_pairs_destroy(&pairs);
    return 0;
}

/* A direction at an azimuth about the edges, whose cosine along z is given. */
static ScatterAntenna at(double azimuth_rad, double along, double range_m)
{
    const double across = sqrt(1 - along * along);
    return (ScatterAntenna){{across * cos(azimuth_rad), across * sin(azimuth_rad), along}, range_m};
}

static void waves_of(EdgeSegments *out, const ScatterAntenna *tx, const ScatterAntenna *rx, double k, double sample_m)
{
    const EdgePairConfig config = {.edge = {.k_per_m = k, .sample_m = sample_m, .clear_m = 1e-4}, .k_per_m = k};
    out->count = 0;
    CHECK(edge_pair_segments(out, &pairs.pair[upright], 1, list.wedge, tx, rx, &config) == STATUS_OK);
}

static double size_of(const EdgeSegment *s)
{
    double squares = 0;
    for (int e = 0; e < 4; e++) squares += pow(cabs(s->amplitude[e / 2][e % 2]), 2);
    return sqrt(squares);
}

/* On the cone of directions with one angle b to the edges, all is a wave along them times that of two dimensions, whose
 * wave number is k sin b: so is what is diffracted, per length. Paths: across the plate they go at b too, the wave's
 * phase by k sin b width; from edge to edge the way of the antennas is that of both ends. */
static void along_the_cone_it_is_the_plane(void **state)
{
    (void)state;
    const double k = 2 * pi * 30e9 / 299792458;
    EdgeSegments oblique = {0}, plane = {0};
    for (int i = 0; i < 12; i++) {
        const double         along = 0.15 * (i % 5) - 0.3, from = -1.1 + 0.19 * i, to = 0.9 - 0.13 * i;
        const double         sine = sqrt(1 - along * along);
        const ScatterAntenna tx = at(from, along, INFINITY), rx = at(to, -along, INFINITY);
        const ScatterAntenna tx2 = at(from, 0, INFINITY), rx2 = at(to, 0, INFINITY);
        waves_of(&oblique, &tx, &rx, k, 10);
        waves_of(&plane, &tx2, &rx2, k * sine, 10);
        CHECK(oblique.count == 4 && plane.count == 4);
        for (int w = 0; w < 4; w++) {
            const EdgeSegment *s = &oblique.segment[w], *t = &plane.segment[w];
            CHECK(s->order == (w < 2 ? 1 : 2) && s->order_k == k && t->order == s->order);
            CHECK_NEAR(size_of(s) / size_of(t), 1, 1e-9);
            CHECK_NEAR(s->slope, 0, 1e-12);
            CHECK_NEAR(s->length_m, long_m, 1e-9);
            /* ends of the way in y: the first pair's begin at either edge; the others return */
            const double y = s->path_m - s->order * sine * wide_m, a = t->path_m - t->order * wide_m;
            CHECK_NEAR(y / sine, a, 1e-9);
            const double edge = list.wedge[pairs.pair[upright].wedge[0]].p[0][1]; /* y of the first edge */
            const double in = w == 0 || w == 2 ? edge : -edge, out = w == 1 || w == 2 ? edge : -edge;
            CHECK_NEAR(a, -in * sin(from) - out * sin(to), 1e-9);
        }
    }
    edge_segments_destroy(&oblique);
    edge_segments_destroy(&plane);
}

/* From antennas r away pieces are as short as the sampling asks, and as a bend of 0.02 rad and a curve of 0.02 rad of
 * phase allow: min(0.02 / b, (8 0.02 / (k b))^0.5), b the sum of one over either distance from the first end. Their
 * amplitudes fall with both distances, their paths and slopes are those of their middles. */
static void pieces_by_hand(void **state)
{
    (void)state;
    const double k = 2 * pi * 30e9 / 299792458;
    static const struct {
        double tx_m, rx_m, k_share, sample_m;
    } of[] = {{20, 30, 1, 10}, {20, 30, 1e-3, 10}, {400, INFINITY, 1, 0.05}};
    for (int i = 0; i < 3; i++) {
        const ScatterAntenna tx = at(0.3, 0, of[i].tx_m), rx = at(-0.2, 0, of[i].rx_m);
        const Wedge         *w = &list.wedge[pairs.pair[upright].wedge[0]];
        const double         k_here = k * of[i].k_share;
        EdgePairConfig       config = {.edge = {.k_per_m = k_here, .sample_m = of[i].sample_m}, .k_per_m = k};
        EdgeSegments         s = {0};
        double               d[2][3];
        CHECK(edge_pair_segments(&s, &pairs.pair[upright], 1, list.wedge, &tx, &rx, &config) == STATUS_OK);
        const ScatterAntenna *antenna[2] = {&tx, &rx};
        double                bend = 0;
        for (int a = 0; a < 2; a++)
            if (!isinf(antenna[a]->range_m)) {
                for (int x = 0; x < 3; x++) d[a][x] = antenna[a]->range_m * antenna[a]->u[x] - w->p[0][x];
                bend += 1 / v3_length(d[a]);
            }
        const int want = (int)ceil(long_m / fmin(of[i].sample_m, fmin(0.02 / bend, sqrt(0.16 / (k_here * bend)))));
        if (s.count != 4 * want) fail_msg("case %d: %d of %d", i, s.count, 4 * want);
        for (int n = 0; n < want && i == 0; n++) {
            const EdgeSegment *e = &s.segment[4 * n], *middle = &s.segment[4 * (want / 2)];
            double             slope = 0, path = 0, fall = 1;
            CHECK_NEAR(e->length_m, long_m / want, 1e-12);
            for (int a = 0; a < 2; a++) { /* the first crossing: from one edge, at y, to the other, at -y */
                const double y = (a ? -1 : 1) * w->p[0][1], z = e->p[2], r_m = antenna[a]->range_m;
                const double from[3] = {r_m * antenna[a]->u[0], r_m * antenna[a]->u[1] - y, r_m * antenna[a]->u[2] - z};
                const double away = v3_length(from);
                slope -= from[2] / away * w->frame.z[2];
                path += away - r_m;
                fall *= away / sqrt(away * away - z * z + middle->p[2] * middle->p[2]);
            }
            CHECK_NEAR(e->slope, slope, 1e-9);
            CHECK_NEAR(e->path_m, path + wide_m, 1e-4);
            CHECK_NEAR(size_of(e) / size_of(middle) * fall, 1, 5e-3);
            CHECK_NEAR(e->p[1], 0, 1e-12);
        }
        edge_segments_destroy(&s);
    }
}

/* Pairs shorter than a Fresnel zone, (lambda width)^0.5, count for nothing, and what adds less than it is asked for is
 * left out, but not what adds as much. */
static void limits(void **state)
{
    (void)state;
    const ScatterAntenna a = at(0.4, 0, INFINITY);
    EdgeSegments         s = {0};
    for (int i = 0; i < 2; i++) { /* length^2 = lambda width at this wavelength */
        const double lambda_m = long_m * long_m / wide_m * (i ? 1.001 : 0.999);
        waves_of(&s, &a, &a, 2 * pi / lambda_m, 10);
        CHECK(s.count == (i ? 0 : 4));
    }
    const double k = 2 * pi * 30e9 / 299792458;
    waves_of(&s, &a, &a, k, 10);
    CHECK(s.count == 4);
    double most = 0;
    for (int w = 0; w < 2; w++)
        for (int e = 0; e < 4; e++) most = fmax(most, cabs(s.segment[w].amplitude[e / 2][e % 2]));
    for (int i = 0; i < 2; i++) {
        const EdgePairConfig config = {
            .edge = {.k_per_m = k, .sample_m = 10}, .k_per_m = k, .least_m = most * (i ? 1.001 : 0.999)};
        s.count = 0;
        CHECK(edge_pair_segments(&s, &pairs.pair[upright], 1, list.wedge, &a, &a, &config) == STATUS_OK);
        CHECK(s.count == (i ? 0 : 4));
    }
    edge_segments_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(along_the_cone_it_is_the_plane),
        cmocka_unit_test(pieces_by_hand),
        cmocka_unit_test(limits),
    };
    return cmocka_run_group_tests(tests, open_plate, close_plate);
}
