/* Integrals along edges against quadrature; plates against integral-equation results (Austin RCS Benchmark Suite). */
#include "tests/render/hand_mesh.h"
#include "render/scattering/field/edge_field_private.h"

static const double pi = 3.14159265358979323846, c_mps = 299792458;

/* --- Integrals --- */

static double uniform(uint32_t i, int stream)
{
    static const double step[] = {0.6180339887498949, 0.7548776662466927, 0.5698402909980532, 0.8191725133961645};
    return fmod(0.5 + i * step[stream], 1);
}

static ScatterAntenna antenna(double theta_deg, double phi_deg, double range_m)
{
    const double t = theta_deg * rad_per_deg, p = phi_deg * rad_per_deg;
    return (ScatterAntenna){{sin(t) * cos(p), sin(t) * sin(p), cos(t)}, range_m};
}

static const double complex *entries(const ScatterMatrix *s) { return &s->hh; }

/* One edge of 2 m at 94 GHz, near and far, against the sum over 50 000 points with their own directions and phases. */
static void test_integral(void **state)
{
    (void)state;
    const double k = 2 * pi * 94e9 / c_mps;
    const double range_m[] = {30, 300, 10000, INFINITY};
    double       worst = 0, far = 0;
    for (uint32_t i = 0; i < 24; i++) {
        const double         turn = 2 * pi * uniform(i, 0);
        Wedge                w = {.frame = {.x = {cos(turn), sin(turn), 0},
                                            .y = {-sin(turn), cos(turn), 0},
                                            .z = {0, 0, 1},
                                            .exterior_pi = i % 2 ? 2 : 1.5},
                                  .p = {{0.3, 0.2, -1}, {0.3, 0.2, 1}}};
        const double         r_m = range_m[i % 4];
        const ScatterAntenna t = antenna(88 + 4 * uniform(i, 1), 360 * uniform(i, 2), r_m);
        const ScatterAntenna r = i % 3 ? t : antenna(91, 360 * uniform(i, 3), r_m * 1.5);
        const EdgeConfig     config = {.k_per_m = k, .sample_m = 0.05, .clear_m = 1e-4};
        if (edge_angle(&w.frame, t.u) > w.frame.exterior_pi * pi - 0.1 ||
            edge_angle(&w.frame, r.u) > w.frame.exterior_pi * pi - 0.1 || edge_angle(&w.frame, r.u) < 0.1)
            continue;
        ScatterMatrix got = {0};
        edge_field(&got, &w, 1, &t, &r, &config);

        double complex want[4] = {0};
        double         basis[2][2][3], most = 0;
        scatter_basis(basis[0][0], basis[0][1], t.u);
        scatter_basis(basis[1][0], basis[1][1], r.u);
        enum { points = 50000 };
        for (int n = 0; n < points; n++) {
            const double p[3] = {0.3, 0.2, -1 + 2 * (n + 0.5) / points};
            double       u[2][3], across[2][2][3], d[2][2], path_m = 0, spread = 1;
            for (int a = 0; a < 2; a++) {
                const ScatterAntenna *at = a ? &r : &t;
                const double          more_m = scatter_path(u[a], at, p);
                path_m += more_m;
                if (!isinf(at->range_m)) spread *= at->range_m / (at->range_m + more_m);
                for (int q = 0; q < 2; q++) {
                    v3_add_scaled(across[a][q], basis[a][q], -v3_dot(basis[a][q], u[a]), u[a]);
                    v3_normalize(across[a][q], across[a][q]);
                }
            }
            edge_fringe(d, &w.frame, u[0], across[0], u[1], across[1]);
            const double complex wave = spread * cexp(-I * k * path_m) * 2 / points;
            for (int e = 0; e < 4; e++) want[e] += d[e / 2][e % 2] * wave;
            for (int e = 0; e < 4; e++) most = fmax(most, fabs(d[e / 2][e % 2]) * 2);
        }
        for (int e = 0; e < 4; e++) {
            const double error = cabs(entries(&got)[e] - want[e]) / most;
            worst = fmax(worst, error);
            if (isinf(r_m)) far = fmax(far, error);
        }
    }
    printf("integral: largest error %.1e of the edge's most; plane waves %.1e\n", worst, far);
    CHECK_NEAR(worst, 0, 2e-3);
    CHECK_NEAR(far, 0, 1e-5);
}

/* Segments made at the top of a band give every frequency in it; made twice, the same bits; in pieces, the same sum. */
static void test_segments(void **state)
{
    (void)state;
    begin();
    add_box((const double[3]){-0.5, -1, 0}, (const double[3]){1, 2, 0.7}, 2, 0);
    WedgeList            list = find();
    const double         k = 2 * pi * 35e9 / c_mps;
    const ScatterAntenna t = antenna(70, 33, 50), r = antenna(75, 30, 80);
    EdgeConfig           config = {.k_per_m = k, .sample_m = 0.05, .clear_m = 1e-4};
    EdgeSegments         segments = {0}, again = {0};
    CHECK(edge_segments(&segments, list.wedge, list.count, &t, &r, &config) == STATUS_OK);
    CHECK(edge_segments(&again, list.wedge, list.count, &t, &r, &config) == STATUS_OK);
    CHECK(segments.count == again.count && segments.count > 50);
    CHECK(memcmp(segments.segment, again.segment, (size_t)segments.count * sizeof *again.segment) == 0);
    for (int i = 0; i < 10; i++) {
        ScatterMatrix banded = {0}, single = {0};
        config.k_per_m = k * (0.5 + i / 18.0);
        edge_segments_field(&banded, &segments, config.k_per_m);
        edge_field(&single, list.wedge, list.count, &t, &r, &config);
        for (int e = 0; e < 4; e++) CHECK_NEAR(cabs(entries(&banded)[e] - entries(&single)[e]), 0, 2e-3);
        if (i == 9) CHECK(memcmp(&banded, &single, sizeof single) == 0);
    }
    edge_segments_destroy(&segments);
    edge_segments_destroy(&again);
    wedges_destroy(&list);
}

/* An edge 2 m long, across the line of sight of an antenna R away: directions turn by 2 / R a metre, and the path
 * departs from a line by (2 / R) length^2 / 8: by 0.02 rad of either, so in so many segments, each with the mean of the
 * path over it, and its slope. Amplitudes fall with the square of the distance. */
static void test_lengths(void **state)
{
    (void)state;
    const double k = 2 * pi * 10e9 / c_mps;
    static const struct {
        double r_m, k_share;
    } of[] = {{20, 1}, {20, 1e-3}, {300, 1}, {INFINITY, 1}};
    for (int i = 0; i < 4; i++) {
        const Wedge w = {.frame = {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}, 2}, .p = {{0, 0, 1}, {0, 0, -1}}, .part = 5};
        const ScatterAntenna a = {{1, 0, 0}, of[i].r_m};
        const EdgeConfig     config = {.k_per_m = k * of[i].k_share, .sample_m = 0.05, .clear_m = 1e-4};
        EdgeSegments         s = {0};
        CHECK(edge_segments(&s, &w, 1, &a, &a, &config) == STATUS_OK);
        /* the stretch is the whole edge, whose ends are the same distance away */
        const double far_m = hypot(of[i].r_m, 1), per_m = isinf(far_m) ? 0 : 2 / far_m;
        const int    want =
            isinf(far_m) ? 1 : (int)ceil(2 / fmin(0.02 / per_m, sqrt(8 * 0.02 / (config.k_per_m * per_m))));
        CHECK(s.count == want);
        for (int n = 0; n < s.count && !isinf(far_m); n++) {
            const EdgeSegment *e = &s.segment[n];
            const double       length_m = 2.0 / want, z = 1 - (n + 0.5) * length_m, r_m = hypot(of[i].r_m, z);
            double             mean_m = 0;
            for (int x = 0; x < 100; x++)
                mean_m += 2 * (hypot(of[i].r_m, z + length_m * ((x + 0.5) / 100 - 0.5)) - of[i].r_m) / 100;
            CHECK_NEAR(e->length_m, length_m, 1e-12);
            CHECK_NEAR(e->p[2], z, 1e-12);
            CHECK_NEAR(e->path_m, mean_m, 2e-9 + 1e-4 * length_m * length_m / r_m);
            CHECK_NEAR(e->slope, -2 * z / r_m, 1e-9); /* along the edge, which leads down */
            CHECK(e->part == 5 && e->wedge == 0 && e->order == 0);
            /* h is y, v up: along the edge; backscatter of a half plane from its front is the same from all of it, but
             * for the turn of directions by up to 1 / 20 */
            CHECK_NEAR(creal(e->amplitude[1][1]) / creal(s.segment[want / 2].amplitude[1][1]) * (r_m * r_m) /
                           pow(hypot(of[i].r_m, s.segment[want / 2].p[2]), 2),
                       1, 0.01);
        }
        edge_segments_destroy(&s);
    }
}

typedef struct Screen {
    double above_m; /* points below are hidden */
    int    calls[2];
} Screen;

static bool above(void *user, const double p[3], int which)
{
    Screen *screen = user;
    screen->calls[which]++;
    return p[2] > screen->above_m;
}

/* An edge half hidden is the other half; one hidden from either antenna is nothing; faces hide their own edges. */
static void test_hidden(void **state)
{
    (void)state;
    const double k = 2 * pi * 10e9 / c_mps;
    const Wedge  whole = {.frame = {.x = {1, 0, 0}, .y = {0, 1, 0}, .z = {0, 0, 1}, .exterior_pi = 1.5},
                          .p = {{0, 0, -1}, {0, 0, 1}}};
    Wedge        half = whole;
    half.p[0][2] = 0;
    const ScatterAntenna t = antenna(80, 130, INFINITY), inside = antenna(80, -45, INFINITY);
    Screen               screen = {0};
    const EdgeConfig     open = {.k_per_m = k, .sample_m = 0.01, .clear_m = 1e-4};
    EdgeConfig           hides = open;
    hides.visible = above;
    hides.user = &screen;
    ScatterMatrix got = {0}, want = {0};
    edge_field(&got, &whole, 1, &t, &t, &hides);
    edge_field(&want, &half, 1, &t, &t, &open);
    for (int e = 0; e < 4; e++) CHECK_NEAR(cabs(entries(&got)[e] - entries(&want)[e]), 0, 1e-12);
    CHECK(cabs(want.hh) > 1e-4 && screen.calls[0] == 200 && screen.calls[1] == 100);

    screen.above_m = 2;
    ScatterMatrix none = {0};
    edge_field(&none, &whole, 1, &t, &t, &hides);
    edge_field(&none, &whole, 1, &inside, &inside, &open);
    edge_field(&none, &whole, 1, &t, &inside, &open);
    for (int e = 0; e < 4; e++) CHECK(entries(&none)[e] == 0);
}

/* Turned and moved with its node, a wedge scatters as a target whose antennas moved the other way. */
static void test_place(void **state)
{
    (void)state;
    begin();
    add_panel((const double[3]){0}, (const double[3]){0, 1, 0}, (const double[3]){0, 0, 2}, 1, 0);
    WedgeList      list = find();
    Wedge          placed[4];
    const NodePose pose = {.p_body = {1, 2, 3}, .r_body_from_node = {0, -1, 0, 1, 0, 0, 0, 0, 1}}; /* x to y */
    wedges_place(placed, &list, &pose, (const double[3]){1, 2, 3});
    const EdgeConfig     config = {.k_per_m = 100, .sample_m = 0.05, .clear_m = 1e-4};
    const ScatterAntenna before = antenna(60, 20, 100), after = antenna(60, 110, 100);
    ScatterMatrix        a = {0}, b = {0};
    edge_field(&a, list.wedge, list.count, &before, &before, &config);
    edge_field(&b, placed, list.count, &after, &after, &config);
    for (int e = 0; e < 4; e++) CHECK_NEAR(cabs(entries(&a)[e] - entries(&b)[e]), 0, 1e-12);
    wedges_destroy(&list);
}

/* --- Austin plates --- */

static double sinc(double x) { return fabs(x) < 1e-8 ? 1 : sin(x) / x; }

/* Physical optics of a rectangle (centre, half sides, its normal towards the antenna), backscatter, closed form. */
static void add_rectangle(ScatterMatrix *s, const double centre[3], const double a[3], const double b[3],
                          const double n[3], const double u[3], double k)
{
    if (v3_dot(n, u) <= 0) return;
    const double         area = 4 * v3_length(a) * v3_length(b);
    const double         pattern = area * sinc(2 * k * v3_dot(u, a)) * sinc(2 * k * v3_dot(u, b));
    const double complex wave = -I * k / (2 * pi) * pattern * cexp(2 * I * k * v3_dot(u, centre));
    double               e[2][3], d[3];
    scatter_basis(e[0], e[1], u);
    v3_scale(d, -1, u);
    double complex *out = &s->hh;
    for (int q = 0; q < 4; q++) {
        double h[3], current[3];
        v3_cross(h, d, e[q % 2]);
        v3_cross(current, n, h);
        out[q] += v3_dot(e[q / 2], current) * wave;
    }
}

enum { angles_most = 400, windows = 6 };
static const double window_deg[windows][2] = {{0, 90}, {0, 20}, {20, 40}, {40, 60}, {60, 80}, {80, 90}};

static int double_order(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Medians of |error| in dB by window: without and with edges; HH, VV, both. */
typedef struct Medians {
    double without[3], with[3];
} Medians;

/* What the sides of a plate at y = +-width / 2, height long, do to one another's waves, for the electric field across
 * them and antennas in the plane across them: Keller's coefficients for hard half planes, once and again, over all
 * orders. Waves cross on both faces, each with half of what grazing incidence with its reflection would be. Not near
 * grazing. */
static double complex strip_orders(double k, double phi_rad, double width, double height, bool all)
{
    /* cosines of half the angles from the faces; the far edge's is 0 along the plate, where this does not hold */
    const double         near = sqrt((1 + sin(phi_rad)) / 2), far = sqrt(fmax(1 - sin(phi_rad), 1e-12) / 2);
    const double complex cross = csqrt(2 * pi / k) * cexp(-I * (pi / 4 + k * width)) / sqrt(width);
    const double complex again = -cross / (2 * pi), turn = cexp(I * k * width * sin(phi_rad));
    const double complex even = 2 / (near * far), odd = again * (turn / (far * far) + 1 / (turn * near * near));
    return -height * cross / (4 * pi * pi) * (all ? (even + odd) / (1 - again * again) : even);
}

/* What pairs of edges add, as rendering does it. */
static void add_pairs(ScatterMatrix *out, const WedgeList *list, const ScatterAntenna *t, const ScatterAntenna *r,
                      double k)
{
    EdgePairs            pairs;
    EdgeSegments         segments = {0};
    const EdgePairConfig config = {.edge = {.k_per_m = k, .sample_m = 0.01, .clear_m = 1e-4}, .k_per_m = k};
    CHECK(edge_pairs_find(&pairs, list->wedge, list->count) == STATUS_OK);
    CHECK(edge_pair_segments(&segments, pairs.pair, pairs.count, list->wedge, t, r, &config) == STATUS_OK);
    edge_segments_field(out, &segments, k);
    edge_segments_destroy(&segments);
    edge_pairs_destroy(&pairs);
}

/* The transition function against quadrature along a ray of the complex plane on which its integrand decays, and at
 * its ends. */
static void test_transition(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i <= 60; i++) {
        const double x = pow(10, -4 + i * 0.1), root = sqrt(x);
        enum { steps = 200000 };
        const double complex turn = cexp(-0.25 * I * pi);
        double complex       sum = 0;
        const double h = 12.0 / steps; /* t = root + turn y: exp(-j t^2) = exp(-j x) exp(-2 j root turn y - y^2) */
        for (int n = 0; n < steps; n++) {
            const double y = (n + 0.5) * h;
            sum += cexp(-2 * I * root * turn * y - y * y) * h;
        }
        worst = fmax(worst, cabs(2 * I * root * turn * sum - edge_transition(x)));
    }
    printf("transition function, x of 1e-4 .. 100: within %.1e\n", worst);
    CHECK(worst < 2e-4 && edge_transition(0) == 0 && cabs(edge_transition(1e9) - 1) < 1e-8);
}

/* Two opposite edges against Keller's coefficients for hard half planes, put together in strip_orders: within the
 * transition function's own share, and that at 60 degrees and more from the plane to a hundredth. Reciprocal; nothing
 * where the electric field is along the edges; a plate with another material part between has no pair. */
static void test_pairs(void **state)
{
    (void)state;
    const double width = 0.3, height = 0.2, k = 2 * pi * 30e9 / c_mps;
    double       worst = 0;
    begin();
    add_panel((const double[3]){0, -width / 2, -height / 2}, (const double[3]){0, width, 0},
              (const double[3]){0, 0, height}, 1, 0);
    WedgeList list = find();
    for (int i = 0; i <= 12; i++) {
        const double         phi_deg = 2.5 * i;
        const ScatterAntenna at = antenna(90, phi_deg, INFINITY);
        ScatterMatrix        got = {0};
        add_pairs(&got, &list, &at, &at, k);
        const double complex want = strip_orders(k, phi_deg * rad_per_deg, width, height, true);
        worst = fmax(worst, cabs(got.hh - want) / cabs(want));
        /* the other pair of edges is along h: seen end-on by its own tangent, it has no part in hh */
        CHECK(cabs(got.hv) < 1e-9 && cabs(got.vh) < 1e-9);
    }
    printf("double diffraction of a plate of 30 wavelengths: within %.1e of Keller's\n", worst);
    CHECK(worst < 0.02);
    for (int i = 0; i < 20; i++) {
        const ScatterAntenna a = antenna(40 + 100 * uniform((uint32_t)i, 0), 360 * uniform((uint32_t)i, 1), 40);
        const ScatterAntenna b = antenna(40 + 100 * uniform((uint32_t)i, 2), 360 * uniform((uint32_t)i, 3), 70);
        ScatterMatrix        ab = {0}, ba = {0};
        add_pairs(&ab, &list, &a, &b, k);
        add_pairs(&ba, &list, &b, &a, k);
        CHECK_NEAR(cabs(ab.hv - ba.vh), 0, 1e-9 + 1e-6 * cabs(ab.hv));
        CHECK_NEAR(cabs(ab.hh - ba.hh), 0, 1e-9 + 1e-6 * cabs(ab.hh));
    }
    wedges_destroy(&list);
}

/* A box of size m (0: no thickness) about the origin. False: no data. second: waves of second order, 1: by
 * strip_orders, 2: by pairs of edges. */
static bool compare(Medians out[windows], const char *name, const double size[3], int second)
{
    char path[512];
    if (!reference_path(path, name)) return false;
    begin();
    int thin = -1;
    for (int i = 0; i < 3; i++)
        if (size[i] == 0) thin = i;
    const double low[3] = {-size[0] / 2, -size[1] / 2, -size[2] / 2};
    if (thin < 0) {
        add_box(low, size, 1, 0);
    } else {
        double a[3] = {0}, b[3] = {0};
        a[(thin + 1) % 3] = size[(thin + 1) % 3], b[(thin + 2) % 3] = size[(thin + 2) % 3];
        add_panel(low, a, b, 1, 0);
    }
    WedgeList list = find();
    CHECK(list.count == (thin < 0 ? 12 : 4));

    static double phi_deg[angles_most], error[2][2][angles_most];
    int           count = 0;
    char          line[256];
    FILE         *file = fopen(path, "r");
    CHECK(file && fgets(line, sizeof line, file));
    double f_hz, theta, phi, hh, vv;
    while (count < angles_most && fscanf(file, "%lf,%lf,%lf,%lf,%lf", &f_hz, &theta, &phi, &hh, &vv) == 5) {
        const double         k = 2 * pi * f_hz / c_mps;
        const ScatterAntenna at = antenna(theta, phi, INFINITY);
        ScatterMatrix        s[2] = {0};
        for (int axis = 0; axis < 3; axis++)
            for (int side = -1; side <= 1; side += 2) {
                double    centre[3] = {0}, n[3] = {0}, a[3] = {0}, b[3] = {0};
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                centre[axis] = side * size[axis] / 2, n[axis] = side, a[u] = size[u] / 2, b[v] = size[v] / 2;
                add_rectangle(&s[0], centre, a, b, n, at.u, k);
            }
        s[1] = s[0];
        const EdgeConfig config = {.k_per_m = k, .sample_m = 0.05, .clear_m = 1e-4};
        edge_field(&s[1], list.wedge, list.count, &at, &at, &config);
        if (second == 1) s[1].hh += strip_orders(k, phi * rad_per_deg, size[1], size[2], true);
        if (second == 2) add_pairs(&s[1], &list, &at, &at, k);
        for (int edges = 0; edges < 2; edges++) {
            error[edges][0][count] = fabs(20 * log10(cabs(s[edges].hh)) + 10 * log10(4 * pi) - hh);
            error[edges][1][count] = fabs(20 * log10(cabs(s[edges].vv)) + 10 * log10(4 * pi) - vv);
        }
        phi_deg[count++] = phi;
    }
    fclose(file);
    wedges_destroy(&list);
    CHECK(count > 100);

    printf("%s\n", name);
    for (int w = 0; w < windows; w++) {
        for (int edges = 0; edges < 2; edges++)
            for (int which = 0; which < 3; which++) {
                static double of[2 * angles_most];
                int           n = 0;
                for (int i = 0; i < count; i++) {
                    if (phi_deg[i] < window_deg[w][0] || phi_deg[i] > window_deg[w][1]) continue;
                    for (int q = 0; q < 2; q++)
                        if (which == 2 || which == q) of[n++] = error[edges][q][i];
                }
                qsort(of, (size_t)n, sizeof *of, double_order);
                (edges ? out[w].with : out[w].without)[which] = of[n / 2];
            }
        const double *from = out[w].without, *to = out[w].with;
        printf("  %2.0f-%2.0f deg: HH %5.2f -> %5.2f, VV %5.2f -> %5.2f, both %5.2f -> %5.2f dB\n", window_deg[w][0],
               window_deg[w][1], from[0], to[0], from[1], to[1], from[2], to[2]);
    }
    return true;
}

static const double inch_m = 0.0254;

/* First order: field across the edges (HH) is held less well than along them (VV), and least within 30 degrees of the
 * plate's plane, where waves travel along the plate and back. */
static void test_austin_thin(void **state)
{
    (void)state;
    const double size[3] = {0, 10.5 * inch_m, 6 * inch_m};
    Medians      m[windows];
    if (!compare(m, "radar/austin/IIA_plate_W6in_zy_f11_ref.csv", size, 0)) skip();
    CHECK(m[0].without[2] > 5 && m[0].with[2] < 1.0 && m[0].with[0] < 2.0 && m[0].with[1] < 0.6);
    CHECK(m[3].with[1] < 0.6 && m[4].with[1] < 1.3 && m[5].with[1] < 1.8);
    if (!compare(m, "radar/austin/IIA_plate_W6in_zy_f10_ref.csv", size, 0)) skip();
    CHECK(m[0].without[2] > 5 && m[0].with[2] < 1.5 && m[0].with[1] < 1.0);
}

/* What is missing in HH is waves that cross the plate: with them, added here in closed form, HH is as good as VV to 80
 * degrees. */
static void test_austin_second_order(void **state)
{
    (void)state;
    const double size[3] = {0, 10.5 * inch_m, 6 * inch_m};
    Medians      m[windows];
    if (!compare(m, "radar/austin/IIA_plate_W6in_zy_f11_ref.csv", size, 1)) skip();
    for (int w = 1; w < 5; w++) CHECK(m[w].with[0] < 0.8);
    if (!compare(m, "radar/austin/IIA_plate_W6in_zy_f10_ref.csv", size, 1)) skip();
    for (int w = 1; w < 5; w++) CHECK(m[w].with[0] < 1.3);
}

/* The same waves by pairs of edges as the mesh has them, to the plane of the plate; the field along the edges stays.
 * Thick plates have four more pairs, across faces of a twentieth of a wavelength. */
static void test_austin_pairs(void **state)
{
    (void)state;
    const double thin[3] = {0, 10.5 * inch_m, 6 * inch_m}, thick[3] = {0.064 * inch_m, 10.5 * inch_m, 6 * inch_m};
    Medians      m[windows];
    if (!compare(m, "radar/austin/IIA_plate_W6in_zy_f11_ref.csv", thin, 2)) skip();
    CHECK(m[0].with[0] < 0.7 && m[0].with[1] < 0.55);
    for (int w = 1; w < 4; w++) CHECK(m[w].with[0] < 0.65 && m[w].with[1] < 0.55);
    CHECK(m[4].with[0] < 1.5 && m[4].with[1] < 1.2 && m[5].with[0] < 2.8 && m[5].with[1] < 1.8);
    if (!compare(m, "radar/austin/IIA_plate_W6in_zy_f10_ref.csv", thin, 2)) skip();
    CHECK(m[0].with[0] < 1.2 && m[0].with[1] < 0.9);
    if (!compare(m, "radar/austin/IIB_thinPECplate_W6in_f11_ref.csv", thick, 2)) skip();
    CHECK(m[0].with[0] < 1.5 && m[0].with[1] < 0.5);
    if (!compare(m, "radar/austin/IIB_thinPECplate_W6in_f10_ref.csv", thick, 2)) skip();
    CHECK(m[0].with[0] < 2.3 && m[0].with[1] < 1.0);
    const double wide[3] = {128 * inch_m, 224 * inch_m, 0};
    if (!compare(m, "radar/austin/IIA_plate_W128in_xy_theta80_f6_ref.csv", wide, 2)) skip();
    CHECK(m[0].with[2] < 8 && m[0].with[1] < 8 && m[5].with[2] < 3);
}

/* 64 mil thick: twelve right-angled wedges, opposite ones 0.03 and 0.06 wavelengths apart. */
static void test_austin_thick(void **state)
{
    (void)state;
    const double size[3] = {0.064 * inch_m, 10.5 * inch_m, 6 * inch_m};
    Medians      m[windows];
    if (!compare(m, "radar/austin/IIB_thinPECplate_W6in_f11_ref.csv", size, 0)) skip();
    CHECK(m[0].without[2] > 4 && m[0].with[2] < 0.9 && m[0].with[1] < 0.5);
    if (!compare(m, "radar/austin/IIB_thinPECplate_W6in_f10_ref.csv", size, 0)) skip();
    CHECK(m[0].without[2] > 5 && m[0].with[2] < 1.5 && m[0].with[1] < 1.0);
}

/* Ten degrees from the plate's plane all the way round: what is left out of first order rules except before the front
 * edge (80 to 90 degrees). Better than without edges, and no more than that is claimed. */
static void test_austin_grazing(void **state)
{
    (void)state;
    Medians      m[windows];
    const double size[3] = {128 * inch_m, 224 * inch_m, 0};
    if (!compare(m, "radar/austin/IIA_plate_W128in_xy_theta80_f6_ref.csv", size, 0)) skip();
    CHECK(m[5].with[2] < 4.5 && m[5].without[2] > 20 && m[0].with[2] < 0.6 * m[0].without[2]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_integral),
        cmocka_unit_test(test_segments),
        cmocka_unit_test(test_lengths),
        cmocka_unit_test(test_hidden),
        cmocka_unit_test(test_place),
        cmocka_unit_test(test_austin_thin),
        cmocka_unit_test(test_austin_second_order),
        cmocka_unit_test(test_austin_pairs),
        cmocka_unit_test(test_austin_thick),
        cmocka_unit_test(test_austin_grazing),
        cmocka_unit_test(test_transition),
        cmocka_unit_test(test_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
