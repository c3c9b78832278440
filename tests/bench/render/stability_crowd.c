/* tests/bench/render/stability_crowd.c: no entities, ten thousand in a pixel, two at one position, eyes at invalid
 * positions, and a radar of any lobe width. References: the picture without the invisible entities, symmetry, and
 * sums. */
#include "tests/bench/suites.h"
#include "tests/scenes/stress_world.h"

static void level_attitude(double r[9], double turn_rad)
{
    const double c = cos(turn_rad), s = sin(turn_rad), rows[9] = {c, s, 0, s, -c, 0, 0, 0, -1};
    memcpy(r, rows, sizeof rows);
}

static const unsigned all_bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR | 1 << BAND_RADAR;

/* ---- how many ------------------------------------------------------------------------------------ */

/* So many within one pixel, from 20 km: all values are valid, and their areas add up to the pixel at most. */
static double crowd(StressWorld *w, int count)
{
    const double  north[3] = {0, 1, 0}, eye[3] = {0, 0, 50}, sun_enu[3] = {0, -0.6, 0.8};
    const View    view = stress_view(eye, north, 0, 33, 33, 1000);
    RenderRequest request = stress_request(&view);
    Dice          dice = {.stream = 60};
    double        r[9], visible = 0;
    stress_no_air(w, sun_enu);
    stress_clear(w);
    for (int k = 0; k < count; k++) { /* a pixel is 20 m there */
        const double p[3] = {stress_uniform(&dice, -6, 6), 20000 + stress_uniform(&dice, -6, 6),
                             50 + stress_uniform(&dice, -6, 6)};
        level_attitude(r, stress_uniform(&dice, 0, 6));
        stress_add(w, p, r);
    }
    request.bands = all_bands;
    /* the time grows with the square of the number of entities, so large crowds get fewer samples and bands */
    if (count > 1000) request.target_samples = 8, request.bands = 1 << BAND_LWIR;
    if (!stress_render(w, &request)) return INFINITY;
    for (int k = 0; k < count; k++) visible += w->picture.target[k].visible;
    return stress_bad_values(&w->picture) + !(visible <= 1.001);
}

static double crowd_some(void *user, bool quick) { return crowd(user, quick ? 100 : 400); }
static double crowd_many(void *user, bool quick)
{
    (void)quick;
    return crowd(user, stress_entities);
}

/* Interpenetrating in a square of 60 m, from 150 m: the request that is rendered and its picture. */
static bool draw_stack(StressWorld *w, RenderRequest *request, int count)
{
    const double d[3] = {0, 1, -0.1}, eye[3] = {0, -150, 18}, sun_enu[3] = {0.3, -0.5, 0.8};
    const View   view = stress_view(eye, d, 0, 40, 27, 90);
    Dice         dice = {.stream = 62};
    *request = stress_request(&view);
    request->target_samples = 8, request->edge_samples = 2, request->bands = 1 << BAND_OPTICAL | 1 << BAND_LWIR;
    request->sky_visibility = true;
    stress_no_air(w, sun_enu);
    stress_clear(w);
    for (int k = 0; k < count; k++) {
        const double p[3] = {stress_uniform(&dice, -30, 30), stress_uniform(&dice, -30, 30), 1};
        double       r[9];
        level_attitude(r, stress_uniform(&dice, 0, 6));
        stress_add(w, p, r);
    }
    return stress_render(w, request);
}

static double stacked_many(void *user, bool quick)
{
    StressWorld  *w = user;
    RenderRequest request;
    (void)quick;
    return draw_stack(w, &request, stress_entities) ? stress_bad_values(&w->picture) : INFINITY;
}

/* Compares the tree with a test of every entity. */
static double stacked_some(void *user, bool quick)
{
    StressWorld  *w = user;
    RenderRequest request;
    Arena        *kept = arena_create(), *own = w->arena;
    if (!kept) return INFINITY;
    w->arena = kept;
    bool made = draw_stack(w, &request, quick ? 100 : 300);
    w->arena = own;
    const Picture by_tree = w->picture;
    request.skips_off = skips_all_off;
    made = made && stress_render(w, &request);
    double wrong =
        made ? stress_differences(&by_tree, 0, 0, &w->picture, 0, 0, 40, 27) + stress_bad_values(&by_tree) : INFINITY;
    for (int k = 0; made && k < w->snapshot.count; k++)
        wrong += by_tree.target[k].amodal != w->picture.target[k].amodal ||
                 by_tree.target[k].visible != w->picture.target[k].visible ||
                 by_tree.target[k].occluder != w->picture.target[k].occluder;
    arena_destroy(kept);
    return wrong;
}

/* No entities; and entities with invalid positions: not a number, behind the Moon, of no model. The picture is that
 * without entities. */
static double nobody(void *user, bool quick)
{
    StressWorld  *w = user;
    const double  d[3] = {0, 1, -0.3}, eye[3] = {0, 0, 100};
    const View    view = stress_view(eye, d, 0.1, 65, 43, 60);
    RenderRequest request = stress_request(&view);
    double        r[9], p[3] = {0, 100, 20}, wrong = 0;
    Arena        *kept = arena_create(), *own = w->arena;
    (void)quick;
    request.bands = all_bands;
    stress_clear(w);
    w->world.landscape = &w->landscape;
    if (!kept || stress_real_air(w, 0.3, 100) != STATUS_OK) return INFINITY;
    w->arena = kept;
    wrong += stress_render(w, &request) ? stress_bad_values(&w->picture) : INFINITY;
    w->arena = own;
    const Picture empty = w->picture;
    level_attitude(r, 1);
    for (int k = 0; k < 6; k++) stress_add(w, p, r);
    w->entity[0].p_ecef[1] = NAN;
    w->entity[1].p_ecef[2] = INFINITY;
    w->entity[2].r_ecef_from_body[4] = NAN;
    w->pose[3].p_body[0] = NAN;
    w->entity[4].p_ecef[0] = 1e300;
    w->pose[5].r_body_from_node[0] = INFINITY;
    if (!stress_render(w, &request)) wrong = INFINITY;
    wrong += stress_differences(&empty, 0, 0, &w->picture, 0, 0, 65, 43);
    w->world.landscape = NULL;
    arena_destroy(kept);
    return wrong;
}

/* Two at exactly one position: the first is visible, the second not at all, and the picture is that of one. */
static double two_in_one_place(void *user, bool quick)
{
    StressWorld *w = user;
    Arena       *kept = arena_create(), *own = w->arena;
    const double d[3] = {0, 1, -0.3}, eye[3] = {0, 0, 100}, sun_enu[3] = {0, -0.6, 0.8};
    Dice         dice = {.stream = 61};
    double       wrong = 0;
    if (!kept) return INFINITY;
    for (int n = 0; n < (quick ? 4 : 40); n++) {
        const View    view = stress_view(eye, d, 0.1, 64, 64, n % 2 ? 400 : 40);
        RenderRequest request = stress_request(&view);
        double        r[9], p[3] = {stress_uniform(&dice, -3, 3), 200, 40 + stress_uniform(&dice, -3, 3)};
        stress_any_rotation(r, &dice);
        request.bands = all_bands;
        if (n % 4 >= 2) request.target_samples = 0;
        stress_no_air(w, sun_enu);
        stress_clear(w);
        stress_add(w, p, r);
        arena_reset(kept);
        w->arena = kept;
        bool made = stress_render(w, &request);
        w->arena = own;
        const Picture one = w->picture;
        stress_add(w, p, r);
        made = made && stress_render(w, &request);
        wrong += made ? stress_differences(&one, 0, 0, &w->picture, 0, 0, 64, 64) : INFINITY;
        wrong += made && !(w->picture.target[1].visible == 0);
    }
    arena_destroy(kept);
    return wrong;
}

/* ---- where the eye is ------------------------------------------------------------------------------ */

/* Places eyes inside a block, on its side and edge-on to it, under the ground, on it and at 1000 km; looking level,
 * straight up and straight down; by day, at night and with the sun on the horizon, overhead and at the nadir; wide and
 * narrow. */
static double eyes(void *user, bool quick)
{
    static const double place[][3] = {{0, 101, 20.3}, {0, 100, 20.3}, {0, 99.999999, 20.3}, {0, 0, -40},
                                      {0, 0, 0},      {30, 0, 1e6},   {1.9e4, 1.9e4, 30},   {2e5, 0, 2000}};
    static const double towards[][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0.3, 0.5, -0.7}, {0, -1e-17, -1}};
    static const double sun_rad[] = {0, 0.5, 1.5707963267948966, -0.01, -1.5707963267948966};
    StressWorld        *w = user;
    double              r[9], p[3] = {0, 100, 20.3}, wrong = 0;
    int                 n = 0;
    level_attitude(r, 0);
    w->world.landscape = &w->landscape;
    for (int e = 0; e < 8; e++)
        for (int t = 0; t < 6; t++)
            for (int s = 0; s < 5; s++, n++) {
                if (quick && n % 7) continue;
                const View view = stress_view(place[e], towards[t], 0.2 * s, 40, 24, n % 3 ? 30 : n % 2 ? 0.35 : 3e5);
                RenderRequest request = stress_request(&view);
                request.bands = all_bands;
                request.optical = n % 2 ? OPTICAL_RGB : OPTICAL_NIR;
                request.sky_samples = n % 5 == 0 ? 4 : 0;
                stress_clear(w);
                stress_add(w, p, r);
                if (stress_real_air(w, sun_rad[s], place[e][2]) != STATUS_OK || !stress_render(w, &request))
                    wrong = INFINITY;
                else wrong += stress_bad_values(&w->picture);
            }
    w->world.landscape = NULL;
    return wrong;
}

/* Looks straight down and straight up, rotated by quarters about the axis: the picture must be the same, rotated. In
 * air of uniform radiance and from above a block. Returns the worst change of a pixel's radiance. */
static double turned(void *user, bool quick)
{
    enum { side = 64 };
    static float first[side * side];
    StressWorld *w = user;
    const double sun_enu[3] = {0.36, -0.48, 0.8};
    double       r[9], worst = 0;
    (void)quick;
    level_attitude(r, 0.4);
    for (int up = 0; up < 2; up++)
        for (int q = 0; q < 4; q++) {
            const double  d[3] = {0, 0, up ? 1 : -1}, eye[3] = {1, 100.5, up ? 0 : 60}, p[3] = {0, 100, 20};
            const View    view = stress_view(eye, d, 0.5 * pi_rad * q, side, side, 200);
            RenderRequest request = stress_request(&view);
            stress_no_air(w, sun_enu);
            stress_clear(w);
            stress_add(w, p, r);
            request.edge_samples = 0;
            if (!stress_render(w, &request)) return INFINITY;
            if (q == 0) memcpy(first, w->picture.lwir, sizeof first);
            for (int y = 0; y < side; y++)
                for (int x = 0; x < side; x++) { /* where (x, y) of the rotated camera was before the rotation */
                    double u = x + 0.5 - 0.5 * side, v = y + 0.5 - 0.5 * side;
                    for (int k = 0; k < q; k++) {
                        const double old = u;
                        u = -v, v = old;
                    }
                    const double was = (double)first[(int)(v + 0.5 * side) * side + (int)(u + 0.5 * side)];
                    const double error = fabs((double)w->picture.lwir[y * side + x] - was) / 40;
                    if (!(error <= worst)) worst = error;
                }
        }
    return worst;
}

/* ---- radar ---------------------------------------------------------------------------------------- */

/* Integral over the hemisphere, by Simpson's rule over the angle, dense where the lobe is. */
static double lobe_energy(void *user, bool quick)
{
    double worst = 0;
    (void)user;
    for (int k = 0; k <= (quick ? 12 : 60); k++) {
        const double lobe_rad = pow(10, -4 + 5.0 * k / (quick ? 12 : 60)), end = fmin(0.5 * pi_rad, 12 * lobe_rad);
        const int    steps = 20000;
        double       sum = 0;
        for (int i = 0; i <= steps; i++) {
            const double a = end * i / steps, half = sin(0.5 * a);
            /* the function takes a cosine: 1 - 2 sin^2 (a / 2) */
            sum += 2 * pi_rad * sin(a) * radar_lobe(lobe_rad, 1 - 2 * half * half) *
                   (i == 0 || i == steps ? 1
                    : i % 2              ? 4
                                         : 2);
        }
        const double error = fabs(sum * end / steps / 3 - 1);
        if (!(error <= worst)) worst = error;
    }
    return worst;
}

/* Values that are not finite, for any lobe and cosine, 0 and beyond included. */
static double lobe_values(void *user, bool quick)
{
    static const double lobe[] = {0, 1e-300, 1e-12, 1e-9, 1e-3, 1, 100, 1e300},
                        cosine[] = {-1, 0, 5e-324, 1e-9, 0.5, 0.999999, 1, 1.0000000000000002};
    double bad = 0;
    (void)user, (void)quick;
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 8; c++) {
            const double value = radar_lobe(lobe[k], cosine[c]);
            bad += !(value >= 0 && isfinite(value));
        }
    return bad;
}

/* Two plates that face each other with the eye between them, and a corner: repeated bounces. Range bins with their
 * edges at the returns; the sums of profile and picture are equal. */
static double radar_bins(void *user, bool quick)
{
    enum { side = 40 };
    StressWorld *w = user;
    const double sun_enu[3] = {0, -0.6, 0.8}, north[3] = {0, 1, 0}, eye[3] = {0, 0, 20};
    double       r[9], worst = 0;
    for (int n = 0; n < (quick ? 4 : 24); n++) {
        const double  lobe_rad[4] = {1e-4, 0.0035, 0.05, 0.52}, kept_rad = w->world.radar.lobe_rad;
        const View    view = stress_view(eye, north, 0, side, side, 100);
        RenderRequest request = stress_request(&view);
        const double  p[3][3] = {{0, 16, 20}, {0, -2, 20}, {2.5, 15, 20}};
        stress_no_air(w, sun_enu);
        stress_clear(w);
        for (int k = 0; k < 3; k++) {
            const double turn[3] = {0, pi_rad, 0.5 * pi_rad};
            level_attitude(r, turn[k]);
            stress_add(w, p[k], r);
        }
        request.bands = 1 << BAND_RADAR;
        request.edge_samples = n % 3 ? 4 : 0;
        request.profile_near_m = n % 2 ? 0 : 16 - 0.25 * (n % 5);
        request.profile_bin_m = n % 2 ? 1 : 0.25;
        request.profile_bins = 4096;
        w->world.radar.lobe_rad = lobe_rad[n % 4];
        const bool made = stress_render(w, &request);
        w->world.radar.lobe_rad = kept_rad;
        if (!made) return INFINITY;
        double picture = 0, profile = 0;
        for (int i = 0; i < side * side; i++) picture += (double)w->picture.radar[i];
        for (int i = 0; i < 4096 * radar_bounces; i++) profile += w->picture.profile[i];
        if (stress_bad_values(&w->picture) > 0) return INFINITY;
        /* those before profile_near_m are left out */
        if (n % 2) worst = fmax(worst, picture > 0 ? fabs(profile / picture - 1) : INFINITY);
    }
    return worst;
}

Status bench_stability_crowd(Bench *bench)
{
    static const StressCase cases[] = {
        {"crowd: 100 (400) in one pixel at 20 km", crowd_some, 0, "values",
         "finite, not below 0; areas within a pixel"},
        {"crowd: 100 (300) stacked in 60 m", stacked_some, 0, "values",
         "with nothing skipped, areas and occluders, too"},
        {"crowd: nobody, and six that are nowhere", nobody, 0, "values", "the picture of nobody, to the bit"},
        {"crowd: two in one place", two_in_one_place, 0, "values", "the picture of one, to the bit"},
        {"eye: in a block, edge-on, under ground, 1000 km up; up and down", eyes, 0, "values", "finite, not below 0"},
        {"eye: straight up and down, turned by quarters", turned, 1e-6, "relative", "the first, turned"},
        {"radar: lobes of 1e-4 .. 10 rad: energy", lobe_energy, 1e-7, "relative", "1, by Simpson's rule"},
        {"radar: lobes of 0 .. 1e300 rad", lobe_values, 0, "values", "finite, not below 0"},
        {"radar: to and fro, returns at edges of bins", radar_bins, 1e-5, "relative", "the picture's own sum"},
    };
    static const StressCase full[] = {
        {"crowd: 10,000 in one pixel at 20 km", crowd_many, 0, "values", "finite, not below 0; areas within a pixel"},
        {"crowd: 10,000 stacked in 60 m, 40 x 27", stacked_many, 0, "values", "finite, not below 0"},
    };
    StressWorld world;
    Status      status = stress_world_open(&world, bench_threads(bench));
    if (status != STATUS_OK) return status;
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &world);
    if (!bench_quick(bench)) stress_cases(bench, full, sizeof full / sizeof *full, &world);
    stress_world_close(&world);
    return STATUS_OK;
}
