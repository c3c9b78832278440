/* Lists of hits of ray tubes: the same bits for any number of threads, many frequencies of one list, mirrors that are
 * curved or uneven, edges. labels: physics */
#include "tests/render/hand_models.h"
#include "tests/render/radar_stage.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/field/tubes.h"

static const double x_hz = 10e9;

static double sigma(double complex s) { return 4 * pi_rad * scatter_power(s); }

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

static Status with(RadarStage *s, const TubeConfig *config)
{
    const ScatterAntenna a = antenna_at(0, 0, INFINITY);
    return tubes_trace(&s->hits, s->target, &a, &a, config, s->pool);
}

/* Each number of the configuration beyond what tubes.h says of it, alone; and at the ends that it may have. */
static void numbers_are_checked(void **state)
{
    (void)state;
    RadarStage s;
    stage_open(&s, "plate:0.1x0.1", x_hz);
    const TubeConfig good = s.config;
    log_set_sink(check_listen, NULL);
#define TRY(member, value, want)                                                                                       \
    do {                                                                                                               \
        TubeConfig c = good;                                                                                           \
        c.member = value;                                                                                              \
        if (with(&s, &c) != want) fail_msg("%s = %g", #member, (double)(value));                                       \
    } while (0)
    const Status bad = STATUS_BAD_VALUE, ok = STATUS_OK;
    TRY(frequency_hz, 0, bad);
    TRY(frequency_hz, -1, bad);
    TRY(frequency_hz, INFINITY, bad);
    TRY(frequency_hz, NAN, bad);
    TRY(rays_per_wavelength, 0, bad);
    TRY(rays_per_wavelength, NAN, bad);
    TRY(rays_per_radius, -1, bad);
    TRY(rays_per_radius, 0, ok);
    TRY(warp_m, -1e-3, bad);
    TRY(warp_length_m, 0, bad);
    TRY(bounces, 0, bad);
    TRY(bounces, 1, ok);
    TRY(bounces, 255, ok);
    TRY(bounces, 256, bad);
    TRY(splits, -1, bad);
    TRY(splits, 0, ok);
    TRY(splits, tubes_splits_most, ok);
    TRY(splits, tubes_splits_most + 1, bad);
    TRY(cuts_per_radius, 0, bad);
    TRY(cuts_per_radius, NAN, bad);
    TRY(split_rad, 0, bad);
    TRY(split_rad, NAN, bad);
#undef TRY
    log_set_sink(NULL, NULL);
    stage_close(&s);
}

/* ---- a field by hand ----------------------------------------------------------------------------------- */

/* Four hits, or as many as fill a chunk and more, and an edge of each order: their fields by the formulas of tubes.h
 * and edge_field_private.h at each frequency, from one and from many; and after the antennas have moved. */
static void a_field_by_hand(void **state)
{
    (void)state;
    enum { most = 8193, frequencies = 9 };
    static double        path_m[most + 1];
    static float         slope_m[2][most + 1], amplitude[8][most + 1], first[3][most + 1], last[3][most + 1];
    const ScatterAntenna tx = antenna_at(10, 5, 400), rx = antenna_at(-20, 9, 300);
    const ScatterAntenna tx_moved = antenna_at(10.1, 5.2, 420), rx_moved = antenna_at(-20.2, 8.9, 290);
    EdgeSegment          edge[3] = {0};
    TotalField           field = {.hits = {.tx = tx, .rx = rx, .frequency_hz = x_hz, .path_m = path_m}};
    for (int s = 0; s < 2; s++) field.hits.slope_m[s] = slope_m[s];
    for (int c = 0; c < 8; c++) field.hits.amplitude[c] = amplitude[c];
    for (int x = 0; x < 3; x++) field.hits.first[x] = first[x], field.hits.last[x] = last[x];
    for (int i = 0; i < most; i++) {
        const int which = i % 3;
        path_m[i] = 0.3 * which - 0.41;
        slope_m[0][i] = which == 0 ? 0 : 2e-3f, slope_m[1][i] = which == 1 ? -4e-3f : 1e-3f;
        for (int c = 0; c < 8; c++) amplitude[c][i] = (float)(1e-3 * ((i * 7 + c * 5) % 11 - 4.0));
        for (int x = 0; x < 3; x++) first[x][i] = 0.25f * (float)(x + which), last[x][i] = 0.5f * (float)(x - which);
    }
    for (int e = 0; e < 3; e++) {
        edge[e] = (EdgeSegment){.order = e, .order_k = 150, .p = {0.3, -0.2, 0.1 * e}, .length_m = 0.05 + 0.01 * e};
        edge[e].slope = e == 0 ? 0 : 0.7, edge[e].path_m = 0.2 - 0.15 * e;
        for (int q = 0; q < 4; q++) edge[e].amplitude[q / 2][q % 2] = 0.02 * (q + 1.0) + 0.01 * I * (e - q);
    }
    for (int chunks = 0; chunks < 2; chunks++)
        for (int edges = 0; edges < 2; edges++)
            for (int moves = 0; moves < 3; moves++) { /* none; both antennas; the receiver alone */
                ScatterMatrix  got[frequencies], one;
                FrequencySweep sweep = {.count = frequencies, .first_hz = 9e9, .step_hz = 1.7e8};
                if (moves == 1) sweep.tx = &tx_moved;
                if (moves > 0) sweep.rx = &rx_moved;
                field.hits.count = chunks ? most : 4; /* behind the last of an odd number is one of no amplitude */
                field.edges = (EdgeSegments){.count = edges ? 3 : 0, .segment = edge};
                CHECK(total_field_sweep(got, &sweep, &field, NULL) == STATUS_OK);
                for (int f = 0; f < frequencies; f++) {
                    const double   hz = 9e9 + 1.7e8 * f, k = 2 * pi_rad * hz / light_mps;
                    double complex want[4] = {0};
                    double         way[3], full = 0;
                    for (int i = 0; i < (int)field.hits.count; i++) {
                        double path = path_m[i], sinc = 1;
                        for (int s = 0; s < 2; s++) {
                            const double x = k * (double)slope_m[s][i];
                            if (x != 0) sinc *= sin(x) / x;
                        }
                        const double a[3] = {(double)first[0][i], (double)first[1][i], (double)first[2][i]};
                        const double b[3] = {(double)last[0][i], (double)last[1][i], (double)last[2][i]};
                        if (moves == 1) path += scatter_path(way, &tx_moved, a) - scatter_path(way, &tx, a);
                        if (moves > 0) path += scatter_path(way, &rx_moved, b) - scatter_path(way, &rx, b);
                        const double complex wave = -I * k / (2 * pi_rad) * sinc * cexp(-I * k * path);
                        for (int q = 0; q < 4; q++) {
                            const double re = (double)amplitude[2 * q][i], im = (double)amplitude[2 * q + 1][i];
                            want[q] += (re + I * im) * wave;
                            full += hypot(re, im) * cabs(wave);
                        }
                    }
                    for (int e = 0; e < field.edges.count; e++) {
                        double       path = edge[e].path_m;
                        const double x = 0.5 * k * edge[e].slope * edge[e].length_m, *p = edge[e].p;
                        if (moves == 1) path += scatter_path(way, &tx_moved, p) - scatter_path(way, &tx, p);
                        if (moves > 0) path += scatter_path(way, &rx_moved, p) - scatter_path(way, &rx, p);
                        const double complex wave =
                            pow(150 / k, 0.5 * e) * (x != 0 ? sin(x) / x : 1) * cexp(-I * k * path);
                        for (int q = 0; q < 4; q++) want[q] += edge[e].amplitude[q / 2][q % 2] * wave;
                    }
                    const double within = 1e-9 * (full + 0.1);
                    sweep.count = 1, sweep.first_hz = hz;
                    CHECK(total_field_sweep(&one, &sweep, &field, NULL) == STATUS_OK);
                    for (int which = 0; which < 2; which++) {
                        const ScatterMatrix *s = which ? &one : &got[f];
                        CHECK_NEAR(cabs(s->hh - want[0]) + cabs(s->hv - want[1]), 0, within);
                        CHECK_NEAR(cabs(s->vh - want[2]) + cabs(s->vv - want[3]), 0, within);
                    }
                }
            }
}

/* ---- uneven surfaces, and how fine the grid is ------------------------------------------------------- */

/* Twelve waves of rms (2 / 12)^0.5 each, so that heights have that rms: numbers even over 0.5 .. 1.5 of 2 pi / length,
 * directions even over the sphere, phases over the circle. */
static void unevenness_has_its_figures(void **state)
{
    (void)state;
    enum { seeds = 400, waves = seeds * warp_waves };
    double number = 0, number2 = 0, along[3] = {0}, along2[3] = {0}, turn[2] = {0}, square = 0;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        Warp warp;
        tubes_warp_make(&warp, 2e-3, 0.5, seed, 3);
        CHECK_NEAR(warp.amplitude_m, 2e-3 * sqrt(1 / 6.0), 1e-15);
        for (int w = 0; w < warp_waves; w++) {
            const double k = v3_length(warp.k[w]), n = k * 0.5 / (2 * pi_rad);
            CHECK(n >= 0.5 && n <= 1.5 && warp.phase_rad[w] >= 0 && warp.phase_rad[w] <= 2 * pi_rad);
            number += n / waves, number2 += n * n / waves;
            for (int x = 0; x < 3; x++) {
                along[x] += warp.k[w][x] / k / waves;
                along2[x] += pow(warp.k[w][x] / k, 2) / waves;
            }
            turn[0] += cos(warp.phase_rad[w]) / waves, turn[1] += sin(warp.phase_rad[w]) / waves;
        }
        for (uint64_t i = 0; i < 10; i++) {
            double height, gradient[3], bend[9], p[3];
            for (uint64_t x = 0; x < 3; x++) p[x] = 20 * random_uniform(1, 0, (uint32_t)seed, 3 * i + x);
            tubes_warp_at(&height, gradient, bend, &warp, p);
            square += height * height / (10 * seeds);
        }
    }
    printf("unevenness: rms %.4f of 2 mm; waves a length %.3f, squared %.3f; up %.3f, up^2 %.3f; phase %.3f %.3f\n",
           1e3 * sqrt(square), number, number2, along[2], along2[2], turn[0], turn[1]);
    CHECK_NEAR(sqrt(square) / 2e-3, 1, 0.03);
    CHECK_NEAR(number, 1, 0.015);
    CHECK_NEAR(number2, 13 / 12.0, 0.03);
    for (int x = 0; x < 3; x++) {
        CHECK_NEAR(along[x], 0, 0.03);
        CHECK_NEAR(along2[x], 1 / 3.0, 0.02);
    }
    CHECK(hypot(turn[0], turn[1]) < 0.04);
    Warp one, other;
    tubes_warp_make(&one, 2e-3, 0.5, 1, 0);
    tubes_warp_make(&other, 2e-3, 0.5, 1, 1);
    CHECK(memcmp(one.phase_rad, other.phase_rad, sizeof one.phase_rad) != 0);
}

/* The least of lambda over rays_per_wavelength, the target's radius over rays_per_radius, and (lambda curve / 16)^0.5,
 * which is lambda / 8 at least. Rays: so many squares in the plate's outline, seen from its front, and its borders. */
static void the_grid_is_as_fine_as_asked(void **state)
{
    (void)state;
    const double l = light_mps / x_hz, radius_m = 0.5 * hypot(0.4, 0.3);
    static const struct {
        double per_wavelength, per_radius, curve_m;
    } of[] = {{1.25, 0, 0}, {2, 4, 0}, {1, 0, 0.2}, {1, 0, 1e-3}, {0.5, 20, 100}};
    const double want_m[] = {l / 1.25, l / 2, sqrt(l * 0.2 / 16), l / 8, radius_m / 20};
    RadarStage   s;
    stage_open(&s, "plate:0.4x0.3", x_hz);
    /* the defaults that tubes.h states */
    CHECK(s.config.frequency_hz == x_hz && s.config.rays_per_wavelength == 1.25 && s.config.rays_per_radius == 128);
    CHECK(s.config.splits == 2 && s.config.cuts_per_radius == 768 && s.config.split_rad == 0.5);
    CHECK(s.config.bounces == 8 && s.config.warp_m == 0 && s.config.warp_length_m == 0.5 && s.config.curve_m == 0);
    s.config.splits = 0;
    for (int i = 0; i < 5; i++) {
        const ScatterAntenna a = antenna_at(3, 2, INFINITY);
        s.config.rays_per_wavelength = of[i].per_wavelength, s.config.rays_per_radius = of[i].per_radius;
        s.config.curve_m = of[i].curve_m;
        CHECK(tubes_trace(&s.hits, s.target, &a, &a, &s.config, s.pool) == STATUS_OK);
        CHECK_NEAR(s.hits.spacing_m / want_m[i], 1, 1e-3); /* the sphere has a margin */
        CHECK_NEAR((double)s.hits.count * want_m[i] * want_m[i] / 0.12, 1, 6 * want_m[i]);
    }
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_looks_are_refused),
        cmocka_unit_test(numbers_are_checked),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(a_sweep_equals_its_frequencies),
        cmocka_unit_test(a_curved_mirror_spreads_the_field),
        cmocka_unit_test(edges_are_added_to_the_rays),
        cmocka_unit_test(warp_is_smooth_and_of_its_height),
        cmocka_unit_test(a_field_by_hand),
        cmocka_unit_test(unevenness_has_its_figures),
        cmocka_unit_test(the_grid_is_as_fine_as_asked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
