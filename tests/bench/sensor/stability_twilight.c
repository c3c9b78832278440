/* tests/bench/sensor/stability_twilight.c: twilight on the display: the sun from 1 degree up to the night, a block on
 * flat ground. Without a detector's noise, and with the levels of each picture alone. */
#include "tests/bench/suites.h"
#include "sensor/frame/frame_display.h"
#include "tests/scenes/stress_world.h"

enum { width = 48, height = 36, pixels = width * height };

typedef struct Shown {
    StressWorld w;
    uint16_t    value[3 * pixels];
    double      mean; /* of 65535 */
    double      wrong;
} Shown;

/* Level 10 m over the ground: ground, the block, sky. */
static bool show(Shown *s, double sun_deg, double gain)
{
    StressWorld  *w = &s->w;
    const double  ground_m = elevation_height(&w->landscape.elevation, 0, 0, NULL);
    const double  eye[3] = {3, -20, ground_m + 6}, d[3] = {-3, 20, -4};
    const View    view = stress_view(eye, d, 0, width, height, 60);
    RenderRequest request = stress_request(&view);
    Config        config = config_default();
    Camera        camera = {.chain = {NULL}};
    FrameDisplay  display[BAND_COUNT];
    config.detector.noise = 0;
    config.detector.gain = gain;
    request.bands = 1 << BAND_OPTICAL;
    request.optical = OPTICAL_RGB;
    request.sky_visibility = true;
    if (stress_real_air(w, sun_deg * rad_per_deg, 6) != STATUS_OK || !stress_render(w, &request)) return false;
    const DisplaysOf of = {.config = &config, .picture = &w->picture, .camera = &camera};
    if (frame_displays_make(display, &of, request.bands, w->pool, w->arena) != STATUS_OK) return false;
    s->wrong += stress_bad_values(&w->picture);
    const FrameDisplay *optical = &display[BAND_OPTICAL];
    s->wrong += optical->planes != 3 || !(optical->level.high > optical->level.low);
    for (int c = 0; c < optical->planes; c++)
        for (int i = 0; i < pixels; i++) s->wrong += !isfinite(optical->plane[c][i]);
    frame_display_quantise(s->value, optical, pixels, 16);
    s->mean = 0;
    for (int i = 0; i < 3 * pixels; i++) s->mean += (double)s->value[i] / (3 * pixels);
    return true;
}

/* Any sun from -18 to 1 degree, and exactly where a law ends, with gains of 1e-6 to 1e6. */
static double any_sun(void *user, bool quick)
{
    static const double at_deg[] = {-18, -12, -6, -5, -0.8, -0.2665, 0, 0.2665, -90, -1e-300, 1};
    Shown              *s = user;
    Dice                dice = {.stream = 71};
    s->wrong = 0;
    for (int n = quick ? 22 : 200; n > 0; n--) {
        const double gain = n % 3 ? 1 : stress_log_uniform(&dice, 1e-6, 1e6);
        if (!show(s, n % 2 ? at_deg[n / 2 % 11] : stress_uniform(&dice, -18, 1), gain)) return INFINITY;
    }
    return s->wrong;
}

/* Largest change of the picture's mean over 1e-6 degree, about the ends of each law and at random. */
static double no_jump(void *user, bool quick)
{
    static const double at_deg[] = {-18, -12, -6, -5, -4, -3, -2, -1, -0.8, -0.2665, 0, 0.2665};
    Shown              *s = user;
    Dice                dice = {.stream = 72};
    double              worst = 0;
    for (int n = 0; n < (quick ? 12 : 60); n++) {
        const double at = n < 12 ? at_deg[n] : stress_uniform(&dice, -18, 1);
        if (!show(s, at - 5e-7, 1)) return INFINITY;
        const double before = s->mean;
        if (!show(s, at + 5e-7, 1)) return INFINITY;
        bench_worse(&worst, 100 * (s->mean - before) / 65535);
    }
    return fabs(worst);
}

/* As the sun sinks from where the level is held, a grey of 4 lux, into the night: by how much a picture is brighter
 * than any before it. */
static double darker(void *user, bool quick)
{
    Shown *s = user;
    double least = INFINITY, worst = 0;
    for (double deg = -6; deg >= -20; deg -= quick ? 1 : 0.1) {
        if (!show(s, deg, 1)) return INFINITY;
        worst = fmax(worst, 100 * (s->mean - least) / 65535);
        least = fmin(least, s->mean);
    }
    return worst;
}

Status bench_stability_twilight(Bench *bench)
{
    static const StressCase cases[] = {
        {"twilight: displays, sun at -18 .. 1 degrees, gains of 1e-6 .. 1e6", any_sun, 0, "values",
         "finite, not below 0; a level above its black"},
        {"twilight: displays, largest jump within 1e-6 degree", no_jump, 0.1, "% of white", "none"},
        {"twilight: displays grow darker from -6 degrees to the night", darker, 0.01, "% of white", "never brighter"},
    };
    static Shown s;
    const double upright[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    Status       status = stress_world_open(&s.w, bench_threads(bench));
    if (status != STATUS_OK) return status;
    const double p[3] = {0, 0, elevation_height(&s.w.landscape.elevation, 0, 0, NULL) + 0.75};
    s.w.world.landscape = &s.w.landscape;
    stress_add(&s.w, p, upright);
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &s);
    s.w.world.landscape = NULL;
    stress_world_close(&s.w);
    return STATUS_OK;
}
