/* tests/bench/render/stability_gloss.c: gloss that shows what is near, under stress: any light, blocks that touch,
 * cross and sink into the ground, any paint. References: an even light on white surfaces, which all of it leaves even.
 */
#include "tests/bench/suites.h"
#include "render/light/hemisphere.h"
#include "render/light/optical.h"
#include "tests/scenes/stress_world.h"

/* ---- the factors ---------------------------------------------------------------------------------- */

/* Wrong are: factors that are not 0 .. 100, another than 1 where nothing changes, one that falls as light is added, and
 * a step of more than 1e-6 over one of 1e-9 in the tilt or the light. */
static double any_light(void *user, bool quick)
{
    static const double odd[] = {0, -1e-300, 1e-300, 1e-40, 1e300, -1e300, 1, -1};
    Dice                dice = {.stream = 45};
    double              wrong = 0;
    (void)user;
    for (int n = quick ? 2000 : 100000; n > 0; n--) {
        const double ground = n % 11 ? stress_log_uniform(&dice, 1e-12, 1e4) : 0, up = stress_uniform(&dice, -1, 1);
        const double change = n % 7 ? ground * stress_uniform(&dice, -4, 4) : odd[n / 7 % 8];
        const double below = hemisphere_below(change, ground, up);
        wrong += !(below >= 0 && below <= 100) + !(hemisphere_below(0, ground, up) == 1);
        wrong += !(hemisphere_below(change + 1e-3 * ground, ground, up) >= below);
        wrong += !(fabs(hemisphere_below(change, ground, up - 1e-9) - below) <= 1e-6);
        const double level = ground * pi_rad, open = level * stress_uniform(&dice, 0, 1), sky = fmax(open + change, 0);
        const double above = mirror_sky_factor(sky, open, level);
        wrong += !(above >= 0 && above <= 100) + !(mirror_sky_factor(open, open, level) == 1);
        wrong += !(mirror_sky_factor(sky + 1e-3 * level, open, level) >= above);
        wrong += !(fabs(mirror_sky_factor(sky, open + 1e-9 * level, level) - above) <= 2e-6 * (1 + above));
    }
    return wrong;
}

/* ---- pictures ------------------------------------------------------------------------------------- */

static void turned(double r_enu_from_body[9], double turn_rad)
{
    const double c = cos(turn_rad), s = sin(turn_rad), r[9] = {s, c, 0, c, -s, 0, 0, 0, -1};
    memcpy(r_enu_from_body, r, sizeof r);
}

/* Two blocks, this far apart and this high, seen from near by. */
static bool blocks(StressWorld *w, double gap_m, double lift_m, double turn_rad, int size)
{
    const double  at[3] = {0, 0, elevation_height(&w->landscape.elevation, 0, 0, NULL)};
    const double  eye[3] = {9 * sin(turn_rad), 9 * cos(turn_rad), at[2] + 3}, d[3] = {-eye[0], -eye[1], -2.3};
    const View    view = stress_view(eye, d, 0, size, size * 3 / 4, size);
    RenderRequest request = stress_request(&view);
    double        r[9];
    stress_clear(w);
    for (int k = 0; k < 2; k++) {
        const double p[3] = {k ? gap_m + stress_size_m[1] : 0, 0, at[2] + lift_m + 0.75};
        turned(r, 0.3 * k * turn_rad);
        stress_add(w, p, r);
    }
    request.bands = 1 << BAND_OPTICAL;
    request.optical = OPTICAL_RGB;
    request.target_samples = 0; /* small targets that overlap share pixels */
    request.sky_visibility = true;
    return stress_render(w, &request);
}

static void paint_all(StressWorld *w, const Material *block, float ground_rho)
{
    Materials *m = &w->world.materials;
    Material   ground = {.roughness = 1};
    for (int c = 0; c < optical_channel_count; c++) ground.rho[c] = m->ground_rho[c] = ground_rho;
    for (int k = 1; k < m->count; k++) m->material[k] = *block;
    for (int k = 0; k < SURFACE_COUNT; k++) m->material[m->surface[k]] = ground;
}

/* White ground, white blocks of any gloss and roughness, no sun, a sky of one radiance: everything has that radiance.
 */
static double even_light(void *user, bool quick)
{
    static const double gap_m[] = {-0.5, 0, 1e-6, 1e-3, 0.05, 0.4, 3}, sun[3] = {0, -0.6, 0.8}, light = 5;
    StressWorld        *w = user;
    double              sky[AIR_BAND_COUNT], worst = 0;
    Material            white = {.roughness = 1};
    for (int b = 0; b < AIR_BAND_COUNT; b++) sky[b] = light;
    for (int c = 0; c < optical_channel_count; c++) white.rho[c] = 1;
    for (int n = 0; n < (quick ? 7 : 56); n++) {
        white.gloss = (float)(n % 5) / 4, white.roughness = (float)(0.02 + 0.9 * (n % 3) / 2);
        paint_all(w, &white, 1);
        air_even(&w->air, sun, 0, sky, 0, w->world.planck_mwir, w->world.planck_lwir);
        if (!blocks(w, gap_m[n % 7], n % 4 ? 0.4 * (n % 4 - 1) : -0.7, 0.4 * n, quick ? 32 : 64)) return INFINITY;
        for (int c = 0; c < 3 && w->picture.optical[c]; c++)
            for (int i = 0; i < w->picture.width * w->picture.height; i++)
                bench_worse(&worst, (double)w->picture.optical[c][i] / light - 1);
    }
    return fabs(worst);
}

/* Paint and metal, dark to white, under sun and sky: values that are none. */
static double any_paint(void *user, bool quick)
{
    StressWorld *w = user;
    Dice         dice = {.stream = 46};
    double       wrong = 0;
    for (int n = 0; n < (quick ? 12 : 120); n++) {
        Material paint = {.gloss = (float)(n % 4 == 0 ? n % 3 / 2 : stress_uniform(&dice, 0, 1)),
                          .roughness = n % 6 == 0 ? 0 : (float)stress_log_uniform(&dice, 1e-4, 1),
                          .metal = (float)(n % 2)};
        for (int c = 0; c < optical_channel_count; c++)
            paint.rho[c] = (float)(n % 5 == 0 ? n % 2 : stress_uniform(&dice, 0, 1));
        paint_all(w, &paint, (float)(n % 3) / 2);
        if (stress_real_air(w, stress_uniform(&dice, -0.35, 1.5), 3) != STATUS_OK ||
            !blocks(w, stress_uniform(&dice, -3, 3), stress_uniform(&dice, -2, 2), stress_uniform(&dice, 0, 6.28), 32))
            return INFINITY;
        wrong += stress_bad_values(&w->picture);
    }
    return wrong;
}

Status bench_stability_gloss(Bench *bench)
{
    static const StressCase cases[] = {
        {"gloss: factors of any light near a surface", any_light, 0, "values", "0 .. 100; 1 of no change; no step"},
        {"gloss: white blocks that touch and cross, even light", even_light, 1e-5, "relative",
         "that light, everywhere"},
        {"gloss: any paint and metal, any sun, blocks in each other", any_paint, 0, "values", "finite, not below 0"},
    };
    StressWorld world;
    Status      status = stress_world_open(&world, bench_threads(bench));
    if (status != STATUS_OK) return status;
    detail_table_close(world.world.detail);
    world.world.detail = NULL;
    world.world.landscape = &world.landscape;
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &world);
    world.world.landscape = NULL;
    stress_world_close(&world);
    return STATUS_OK;
}
