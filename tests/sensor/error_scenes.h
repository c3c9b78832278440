/* tests/sensor/error_scenes.h: frames and what they say of their own error, held against frames that are better by far:
 * for each scene, band and source the estimate over the truth. */
#ifndef TESTS_SENSOR_ERROR_SCENES_H
#define TESTS_SENSOR_ERROR_SCENES_H

#include "entities/motion/dead_reckoning.h"
#include "sensor/quality/trial_private.h"
#include "sensor/truth/frame_error.h"
#include "tests/check.h"

typedef struct ErrorScene {
    const char *name;
    double      back_m, above_m, hfov_deg;
    int         vehicles;
    bool        smoke;
    double      pitch_deg; /* the camera is turned up by so much */
    bool        heat;      /* its heat is judged */
} ErrorScene;

enum { width_px = 96, height_px = 64, radiance_bands = 3 };

static struct {
    Pool      *pool;
    Arena     *arena[3];
    LocalFrame frame;
    Landscape  ground, fine;
} lab;

static inline Landscape ground_of(double spacing_m)
{
    LandscapeConfig config = landscape_default_config();
    Landscape       made;
    config.spacing_m = spacing_m;
    config.half_width_m = 1000;
    assert_int_equal(landscape_create(&made, &config, &lab.frame, NULL, 0, NULL, 0), STATUS_OK);
    return made;
}

/* The same country with every fourth post of its innermost level; the cover stays the other's. */
static inline Landscape every_fourth(const Landscape *of)
{
    Landscape             made = *of;
    const ElevationLevel *from = &of->elevation.level[0];
    memset(&made.elevation, 0, sizeof made.elevation);
    CHECK((from->nx - 1) % 4 == 0 && (from->ny - 1) % 4 == 0);
    for (int n = 0; n < of->elevation.level_count; n++) {
        const ElevationLevel *l = &of->elevation.level[n];
        const int             stride = n == 0 ? 4 : 1, nx = (l->nx - 1) / stride + 1, ny = (l->ny - 1) / stride + 1;
        assert_int_equal(elevation_level_create(
                             &made.elevation, n,
                             &(ElevationGrid){nx, ny, l->x0_m, l->y0_m, stride * l->spacing_m, l->z0_m, l->step_m}),
                         STATUS_OK);
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++)
                elevation_set_post(&made.elevation.level[n], i, j, elevation_post(l, i * stride, j * stride));
    }
    elevation_build_pyramids(&made.elevation);
    return made;
}

static inline int lab_open(void **state)
{
    (void)state;
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 0}; /* noon, by the benches' clock */
    if (local_frame_at(&lab.frame, &origin) != STATUS_OK || pool_create(&lab.pool, 2) != STATUS_OK) return -1;
    for (int k = 0; k < 3; k++)
        if (!(lab.arena[k] = arena_create())) return -1;
    lab.fine = ground_of(1);
    lab.ground = every_fourth(&lab.fine);
    return 0;
}

static inline int lab_close(void **state)
{
    (void)state;
    elevation_destroy(&lab.ground.elevation);
    landscape_destroy(&lab.fine);
    for (int k = 0; k < 3; k++) arena_destroy(lab.arena[k]);
    pool_destroy(lab.pool);
    return 0;
}

static void open_scene(TrialScene *scene, const Landscape *ground, const ErrorScene *of)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}, {1, 1, 222, 28, 1, 0, 0}};
    char                       catalog[512];
    CHECK(etc_path(catalog, sizeof catalog, "catalog.csv"));
    assert_int_equal(trial_scene_open(scene, ground, catalog, types, 3, of->vehicles), STATUS_OK);
    for (int k = 0; of->smoke && k < 20; k++) { /* one that smokes, for twenty seconds */
        const double   p_enu[3] = {8, -10, elevation_height(&ground->elevation, 8, -10, NULL)};
        DisEntityState pdu = {.header = {.version = 7, .type = dis_pdu_entity_state},
                              .type = types[0],
                              .id = {1, 1, 99},
                              .appearance = 1u << 5,
                              .dead_reckoning = 2};
        double         euler[3];
        ecef_from_enu(pdu.p_ecef, &lab.frame, p_enu);
        const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
        double       r[9];
        m3_mul(r, lab.frame.r_ecef_from_enu, r_enu_from_body);
        euler_from_r_ecef_from_body(&euler[0], &euler[1], &euler[2], r);
        pdu.psi_rad = (float)euler[0], pdu.theta_rad = (float)euler[1], pdu.phi_rad = (float)euler[2];
        scene->sun_now_s += k > 0;
        assert_int_equal(entity_table_entity_state(scene->table, &pdu, scene->sun_now_s), STATUS_OK);
    }
}

static RenderRequest request_of(const TrialScene *scene, const ErrorScene *of)
{
    RenderRequest request = {.bands = 7,
                             .truth = true,
                             .optical = OPTICAL_RGB,
                             .samples = 1,
                             .edge_samples = 4,
                             .target_samples = 48,
                             .hidden_entity = -1,
                             .budget = true};
    request.view = trial_view(scene, of->back_m, of->above_m, of->hfov_deg * rad_per_deg, width_px, height_px);
    const double c = cos(of->pitch_deg * rad_per_deg), s = sin(of->pitch_deg * rad_per_deg),
                 *m = request.view.r_enu_from_cam;
    double turned[9];
    for (int k = 0; k < 3; k++) {
        turned[3 * k] = m[3 * k];
        turned[3 * k + 1] = c * m[3 * k + 1] + s * m[3 * k + 2];
        turned[3 * k + 2] = c * m[3 * k + 2] - s * m[3 * k + 1];
    }
    memcpy(request.view.r_enu_from_cam, turned, sizeof turned);
    return request;
}

static TrialFrame frame_of(const TrialScene *scene, const RenderRequest *request, int arena)
{
    TrialFrame f = {.scene = scene, .request = *request, .pool = lab.pool, .arena = lab.arena[arena]};
    trial_frame(&f);
    assert_int_equal(f.status, STATUS_OK);
    return f;
}

/* Of a band: rms difference over the reference's mean, channels together. */
static double apart(const Picture *a, const Picture *b, Band band)
{
    const int    first = band == BAND_OPTICAL ? picture_optical : band == BAND_MWIR ? picture_mwir : picture_lwir;
    const int    planes = band == BAND_OPTICAL ? 3 : 1;
    const size_t count = (size_t)a->width * (size_t)a->height;
    double       shares = 0;
    for (int k = first; k < first + planes; k++) {
        const float *p = picture_plane(a, k), *q = picture_plane(b, k);
        double       square = 0, sum = 0;
        for (size_t i = 0; i < count; i++) square += ((double)p[i] - q[i]) * ((double)p[i] - q[i]), sum += q[i];
        shares += square * (double)count / (sum * sum) / planes;
    }
    return sqrt(shares);
}

/* targets: how many there are, in the frame's arena. */
static inline FrameError error_of_targets(Target **out, int *targets_out, TrialFrame *f)
{
    FrameError       error;
    Target          *target = arena_alloc(f->arena, (size_t)f->snapshot.count + 1, sizeof *target);
    EyeState         eye = {.host_index = -1};
    const TruthNoise noise = {.optical_w_m2_sr = 0.1, .netd_mwir_k = 0.03, .netd_lwir_k = 0.03};
    ecef_from_enu(eye.p_ecef, &lab.frame, f->request.view.p_enu);
    m3_mul(eye.r_ecef_from_cam, lab.frame.r_ecef_from_enu, f->request.view.r_enu_from_cam);
    const int targets = truth_targets(target, &f->picture, &f->scene->world, &f->snapshot, &f->request, &eye, &noise);
    CHECK(frame_error(&error,
                      &(FrameErrorOf){&f->picture, &f->scene->world, &f->snapshot, &f->request, 0.002, true,
                                      world_air_k(&f->scene->world, f->scene->unix_s)},
                      target, targets));
    *out = target;
    *targets_out = targets;
    return error;
}

static FrameError error_of(TrialFrame *f)
{
    Target *target;
    int     targets;
    return error_of_targets(&target, &targets, f);
}

/* Of one source of error, a band. */
typedef struct Tally {
    int cases[radiance_bands], held[radiance_bands];
} Tally;

/* Whether nine in ten estimates of every band are within a factor of 2 of the truth; says how many are. */
static inline bool nine_in_ten(const Tally *tally, const char *source)
{
    bool all = true;
    for (int b = 0; b < radiance_bands; b++) {
        const bool enough = tally->cases[b] > 0 && tally->held[b] * 10 >= tally->cases[b] * 9;
        print_message("%-16s %-8s within a factor of 2: %d of %d%s\n", source, band_name((Band)b), tally->held[b],
                      tally->cases[b], enough ? "" : ": TOO FEW");
        all = all && enough;
    }
    return all;
}

/* Below this an error is none: a hundredth of a percent of the mean. */
static const double nothing = 1e-4;

static void judge(Tally *tally, const char *scene, const char *source, Band band, double estimate, double truth)
{
    const bool held = (truth < nothing && estimate < 2 * nothing) || (estimate < 2 * truth && estimate > 0.5 * truth);
    tally->cases[band]++, tally->held[band] += held;
    print_message("%-22s %-8s %-16s estimate %8.4f %%  truth %8.4f %%  ratio %5.2f%s\n", scene, band_name(band), source,
                  100 * estimate, 100 * truth, estimate / truth, held ? "" : "  *");
}

/* A scene on both grounds, and its frame, which stays in arena 0, as by default: what all sources are judged by. */
typedef struct ErrorCase {
    const ErrorScene *of;
    TrialScene        coarse, fine;
    RenderRequest     request;
    TrialFrame        frame;
    FrameError        error;
} ErrorCase;

static inline void open_case(ErrorCase *c, const ErrorScene *of)
{
    *c = (ErrorCase){.of = of};
    open_scene(&c->coarse, &lab.ground, of);
    open_scene(&c->fine, &lab.fine, of);
    c->request = request_of(&c->coarse, of);
    c->frame = frame_of(&c->coarse, &c->request, 0);
    c->error = error_of(&c->frame);
    c->request.budget = false; /* of frames that are better */
}

static inline void close_case(ErrorCase *c)
{
    trial_scene_close(&c->coarse);
    trial_scene_close(&c->fine);
}

/* Rays: against 16 x 16 in every pixel. */
static inline void judge_sampling(Tally *tally, const ErrorCase *c)
{
    RenderRequest request = c->request;
    request.samples = 16, request.edge_samples = request.target_samples = 0;
    const TrialFrame better = frame_of(&c->coarse, &request, 1);
    for (int b = 0; b < radiance_bands; b++)
        judge(tally, c->of->name, "sampling", (Band)b, c->error.share[b][ERROR_SAMPLING],
              apart(&c->frame.picture, &better.picture, (Band)b));
}

/* Posts: 4 m apart against 1 m, both of 4 x 4 rays, so that rays are not what differs. */
static inline void judge_ground(Tally *tally, const ErrorCase *c)
{
    RenderRequest request = c->request;
    request.samples = 4, request.edge_samples = 0;
    const TrialFrame a = frame_of(&c->coarse, &request, 1), b = frame_of(&c->fine, &request, 2);
    for (int band = 0; band < radiance_bands; band++)
        judge(tally, c->of->name, "level_of_detail", (Band)band, c->error.share[band][ERROR_LEVEL_OF_DETAIL],
              apart(&a.picture, &b.picture, (Band)band));
}

/* Heat: of ground, against shorter steps, more facets a side and elements of 1.2 mm. */
static inline void judge_heat(Tally *tally, const ErrorCase *c, double step_s, int facets)
{
    TrialScene fine;
    open_scene(&fine, &lab.ground, c->of);
    HeatConfig heat = heat_default_config();
    heat.step_s = step_s, heat.facets = facets, heat.grid = (GroundGrid){0.0012, 1.17, 3, 0.002};
    CHECK(trial_scene_warm(&fine, &heat) == STATUS_OK);
    fine.past_parts = 8;
    const TrialFrame better = frame_of(&fine, &c->request, 1);
    for (int b = BAND_MWIR; b < radiance_bands; b++)
        judge(tally, c->of->name, "heat", (Band)b, c->error.share[b][ERROR_HEAT],
              apart(&c->frame.picture, &better.picture, (Band)b));
    trial_scene_close(&fine);
}

/* Rays and posts together, on a ground of every post with 16 x 16 rays: whether the sources add up as squares do. */
static inline void judge_sum(Tally *tally, const ErrorCase *c)
{
    RenderRequest request = c->request;
    request.samples = 16, request.edge_samples = request.target_samples = 0;
    const TrialFrame better = frame_of(&c->fine, &request, 1);
    for (int b = 0; b < radiance_bands; b++)
        judge(tally, c->of->name, "rays and posts", (Band)b,
              hypot(c->error.share[b][ERROR_SAMPLING], c->error.share[b][ERROR_LEVEL_OF_DETAIL]),
              apart(&c->frame.picture, &better.picture, (Band)b));
}

/* Air: every pixel with the atmosphere asked for its path alone (atmosphere_path, which makes no tables of a frame).
 * What leaves the surface is what the picture shows less its veil. */
static inline void judge_tables(Tally *tally, const ErrorCase *c)
{
    static AirPaths      veils;
    static Hits          hits;
    static Rays          rays;
    static const AirBand air_of[radiance_bands + 2] = {AIR_R, AIR_G, AIR_B, AIR_MWIR, AIR_LWIR};
    RenderRequest        request = c->request;
    request.edge_samples = request.target_samples = 0,
    request.budget = true; /* one ray: what a pixel shows is its truth's */
    TrialFrame       frame = frame_of(&c->coarse, &request, 1);
    const FrameError error = error_of(&frame);
    const Picture   *p = &frame.picture;
    const Air       *air = &frame.air;
    const View      *view = &request.view;
    double           shares[radiance_bands] = {0};
    for (int plane = 0; plane < 5; plane++) {
        const AirBand b = air_of[plane];
        const bool    thermal = b >= AIR_MWIR;
        const float  *value = picture_plane(p, plane < 3    ? picture_optical + plane
                                               : plane == 3 ? picture_mwir
                                                            : picture_lwir);
        const double  warmer =
            thermal ? air->light.thermal_scale[b - AIR_MWIR] : 1; /* air of another temperature than the model's */
        double square = 0, sum = 0;
        hits.count = rays.count = 1;
        for (int i = 0; i < width_px * height_px; i++) {
            double d[3];
            view_ray(d, view, i % width_px + 0.5, i / width_px + 0.5);
            for (int k = 0; k < 3; k++) rays.o_enu[k][0] = view->p_enu[k], rays.d_enu[k][0] = d[k];
            hits.range_m[0] = (double)p->range_m[i];
            float temp_k[8] = {p->temp_k[i]};
            air_path(&veils, air, b, &hits, &rays, thermal ? temp_k : NULL);
            const double *s = air->light.sun_d_enu, level = hypot(d[0], d[1]), range_m = (double)veils.range_m[0];
            const double  azimuth = acos(clamp((d[0] * s[0] + d[1] * s[1]) / (level * hypot(s[0], s[1])), -1, 1));
            const double  sun_zenith = 0.5 * pi_rad - frame.sun.elevation_rad, lit = air->light.scattered_scale[b];
            double        seen = (double)value[i];
            sum += seen;
            if (range_m < INFINITY) {
                const double  climb = d[2] + (view->p_enu[0] * d[0] + view->p_enu[1] * d[1]) / 6371e3;
                const AirPath path = {.observer_m = air->eye_height_m,
                                      .range_m = range_m,
                                      .sun_zenith_rad = sun_zenith,
                                      .rel_azimuth_rad = azimuth,
                                      .target_m = fmax(air->eye_height_m + range_m * climb +
                                                           range_m * range_m * level * level / (2 * 6371e3),
                                                       0)};
                PathAir       want;
                atmosphere_path(&want, air->light.atmosphere, air->light.weather.visibility_m, b, &path,
                                thermal && p->temp_k[i] > 0 ? (double)p->temp_k[i] : 288);
                const double tau = thermal ? want.transmittance : want.sun_transmittance;
                const double added = want.thermal_w_m2_sr * warmer + (b == AIR_LWIR ? 0 : want.scattered_w_m2_sr * lit);
                seen =
                    (seen - (double)veils.added_w_m2_sr[0]) / fmax((double)veils.transmittance[0], 1e-6) * tau + added;
            } else {
                SkyAir sky;
                atmosphere_sky(&sky, air->light.atmosphere, air->light.weather.visibility_m, b, air->eye_height_m,
                               acos(fmax(d[2], 0)), sun_zenith, azimuth);
                seen = sky.thermal_w_m2_sr * warmer + (b == AIR_LWIR ? 0 : sky.scattered_w_m2_sr * lit);
            }
            square += (seen - (double)value[i]) * (seen - (double)value[i]);
        }
        shares[plane < 3 ? 0 : plane - 2] += square * width_px * height_px / (sum * sum) / (plane < 3 ? 3 : 1);
    }
    for (int band = 0; band < radiance_bands; band++)
        judge(tally, c->of->name, "tables", (Band)band, error.share[band][ERROR_TABLES], sqrt(shares[band]));
}

#endif
