/* tests/bench/sensor/speed_light.c: what two kinds of light cost: gloss that shows what is near, on the unlit side of a
 * close target, and twilight, to the display. */
#include "tests/bench/sensor/speed_private.h"

#include "sensor/frame/frame_display.h"
#include "sensor/settings/config.h"

#include <stdlib.h>

/* ---- gloss ------------------------------------------------------------------------------------ */

typedef struct GlossFrame {
    TrialFrame frame;
    Material  *material; /* that the world has in this frame */
} GlossFrame;

static void gloss_frame(void *user)
{
    GlossFrame *g = user;
    Materials  *m = &((TrialScene *)g->frame.scene)->world.materials;
    memcpy(m->material, g->material, (size_t)m->count * sizeof *m->material);
    trial_frame(&g->frame);
}

/* The target's own radiance of each optical plane, seen from the north, where the sun of noon does not shine. */
static bool target_radiance(double out[3], GlossFrame *g)
{
    gloss_frame(g);
    const TargetPixels *t = &g->frame.picture.target[0];
    for (int c = 0; c < 3; c++) out[c] = t->radiance[picture_optical + c] / t->visible;
    return g->frame.status == STATUS_OK && t->visible > 0;
}

/* Largest error of a target's radiance, %, against light sampled over the hemisphere, in a small picture. */
static double gloss_error(const Speed *s, const GlossFrame *of, int samples)
{
    GlossFrame got = *of;
    double     worst = 0, want[3], is[3];
    View      *view = &got.frame.request.view;
    const bool quick = bench_quick(s->bench);
    view->focal_px *= (quick ? 32.0 : 96.0) / view->width;
    view->width = quick ? 32 : 96, view->height = quick ? 24 : 64;
    GlossFrame fine = got;
    fine.frame.request.sky_samples = samples;
    if (!target_radiance(want, &fine) || !target_radiance(is, &got)) return NAN;
    for (int c = 0; c < 3; c++) bench_worse(&worst, 100 * (is[c] / want[c] - 1));
    return fabs(worst);
}

Status speed_gloss(Speed *s, const RenderRequest *close)
{
    enum { SHOWN, LEVEL, MATT, settings };
    static const char *const name[settings] = {"gloss: unlit side of a close target, it shows what is near",
                                               "gloss: the same, without contact shadows",
                                               "gloss: the same, with them, paint without gloss"};
    Materials               *m = &s->close.world.materials;
    Material                *material[2];
    BenchWork                work[settings];
    BenchTime                time[settings];
    GlossFrame               gloss[settings];
    char                     what[what_size];
    bench_progress(s->bench, "gloss");
    for (int k = 0; k < 2; k++) {
        if (!(material[k] = malloc((size_t)m->count * sizeof *m->material))) return STATUS_NO_MEMORY;
        memcpy(material[k], m->material, (size_t)m->count * sizeof *m->material);
    }
    for (int i = 0; i < m->count; i++) material[1][i].gloss = 0;
    RenderRequest request = *close;
    request.bands = 1u << BAND_OPTICAL;
    request.view.p_enu[1] *= -1; /* the origin, from the other side */
    const double d_enu[3] = {-close->view.r_enu_from_cam[2], -close->view.r_enu_from_cam[5],
                             close->view.r_enu_from_cam[8]};
    view_upright(request.view.r_enu_from_cam, d_enu);
    for (int k = 0; k < settings; k++) {
        request.sky_visibility = k != LEVEL;
        gloss[k] = (GlossFrame){speed_frame(s, &s->close, &request, true), material[k == MATT]};
        work[k] = (BenchWork){gloss_frame, &gloss[k], 1};
    }
    bench_time(time, s->bench, work, settings);
    Status status = STATUS_OK;
    for (int k = 0; k < settings; k++) {
        snprintf(what, sizeof what, "%s, %s", name[k], all_threads);
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        row.ratio = bench_ratio(&time[SHOWN], &time[k]);
        row.to = k == SHOWN ? NULL : "the first / this";
        if (k == SHOWN) row.ratio = NAN;
        row.error = gloss_error(s, &gloss[k], bench_quick(s->bench) ? 64 : 256);
        if (k != LEVEL) row.error_limit = 4;
        row.error_unit = "%";
        row.against = "the target's radiance, optical, light sampled over the hemisphere";
        bench_add(s->bench, &row);
        if (gloss[k].frame.status != STATUS_OK) status = gloss[k].frame.status;
    }
    memcpy(m->material, material[0], (size_t)m->count * sizeof *m->material);
    for (int k = 0; k < 2; k++) free(material[k]);
    return status;
}

/* ---- twilight --------------------------------------------------------------------------------- */

typedef struct LitFrame {
    const Speed *s;
    TrialFrame   frame; /* its air gives the heat of noon: what is warm costs the same */
    double       sun_deg;
    Air          air;
    Arena       *arena;
    uint8_t     *shown; /* [3 * pixels] */
    Status       status;
} LitFrame;

/* From the light on: air, picture, display. */
static void lit_frame(void *user)
{
    LitFrame       *l = user;
    const World    *world = &l->s->scene.world;
    const Config    config = config_default();
    const double    up = l->sun_deg * rad_per_deg;
    const Sun       sun = {.elevation_rad = up, .distance_au = 1, .d_enu = {0, -cos(up), sin(up)}};
    const Weather   weather = weather_default();
    const AirSource source = world_air_source(world, 0);
    RenderRequest  *request = &l->frame.request;
    const AirEye    eye = {request->view.p_enu[2], render_air_bands(request->bands, request->optical), &request->view};
    Picture         picture;
    Camera          camera = {.chain = {NULL}};
    FrameDisplay    display[BAND_COUNT];
    arena_reset(l->arena);
    l->status = air_at(&l->air, &source, &weather, &sun, &eye, l->frame.pool, l->arena);
    l->air.heat = l->frame.air.heat;
    if (l->status == STATUS_OK)
        l->status = render(&picture, world, &l->frame.snapshot, request, &l->air, l->frame.pool, l->arena);
    const DisplaysOf of = {.config = &config, .picture = &picture, .camera = &camera};
    if (l->status == STATUS_OK) l->status = frame_displays_make(display, &of, request->bands, l->frame.pool, l->arena);
    if (l->status != STATUS_OK) return;
    frame_display_quantise(l->shown, &display[BAND_OPTICAL], (size_t)picture.width * (size_t)picture.height, 8);
    bench_keep(l->shown);
}

/* Light on level ground, lx: CIE's luminous efficiency over each band, by an even spectrum. */
static double illuminance_lx(const Daylight *light)
{
    static const double lm_w[3] = {683 * 0.0745, 683 * 0.790, 683 * 0.206};
    double              sum = 0;
    for (int b = 0; b < 3; b++)
        sum += lm_w[b] * (light->sky_w_m2[AIR_B + b] + fmax(light->sun_d_enu[2], 0) * light->sun_w_m2[AIR_B + b]);
    return sum;
}

Status speed_twilight(Speed *s, const RenderRequest *of)
{
    enum { settings = 4 };
    static const struct {
        double sun_deg, lx; /* Janiczek & DeYoung, USNO Circular 171 (1987); NaN: they say nothing of this haze */
    } row_of[settings] = {{40, NAN}, {-0.5, NAN}, {-6, 3.41}, {-18, 0.000644}};
    static LitFrame lit[settings];
    BenchWork       work[settings];
    BenchTime       time[settings];
    char            what[what_size];
    Status          status = STATUS_OK;
    TrialFrame      first = speed_frame(s, &s->scene, of, true);
    first.request.bands = 1u << BAND_OPTICAL;
    bench_progress(s->bench, "twilight");
    trial_frame(&first);
    Arena   *arena = arena_create();
    uint8_t *shown = malloc(3 * (size_t)s->width * (size_t)s->height);
    if (!arena || !shown) status = STATUS_NO_MEMORY;
    else status = first.status;
    for (int k = 0; k < settings; k++) {
        lit[k] = (LitFrame){.s = s, .frame = first, .sun_deg = row_of[k].sun_deg, .arena = arena, .shown = shown};
        work[k] = (BenchWork){lit_frame, &lit[k], 1};
    }
    if (status == STATUS_OK) bench_time(time, s->bench, work, settings);
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        snprintf(what, sizeof what, "twilight: optical frame and its display, sun at %g degrees, %s", row_of[k].sun_deg,
                 all_threads);
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        if (k > 0) row.ratio = bench_ratio(&time[k], &time[0]), row.to = "by day";
        if (row_of[k].lx > 0) {
            row.error = 100 * fabs(illuminance_lx(&lit[k].air.light) / row_of[k].lx - 1);
            row.error_limit = 5; /* its own weather, 500 m up */
            row.error_unit = "%";
            row.against = "illuminance, USNO Circular 171";
        }
        status = lit[k].status;
        bench_add(s->bench, &row);
    }
    free(shown);
    arena_destroy(arena);
    return status;
}
