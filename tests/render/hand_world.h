/* tests/render/hand_world.h: a world of hand-made models whose light has answers on paper: no air, a sun, no sky. */
#ifndef TESTS_RENDER_HAND_WORLD_H
#define TESTS_RENDER_HAND_WORLD_H

#include "tests/render/hand_models.h"

#include "render/frame/render.h"

enum { hand_plate_model, hand_sphere_model, hand_mast_model, hand_models, hand_most_entities = 96 };

static const double hand_plate_y_m = 1, hand_plate_z_m = 1, hand_sphere_m = 1;
static const float  hand_rho = 0.5f, hand_rho_ir = 0.2f;

typedef struct HandWorld {
    Landscape      landscape;
    Catalog       *catalog;
    World          world;
    Pool          *pool;
    Arena         *arena, *air_arena;
    int            model[hand_models]; /* of the catalog */
    SnapshotEntity entity[hand_most_entities];
    NodePose       pose[hand_most_entities];
    Snapshot       snapshot;
    Air            air;
} HandWorld;

static HandWorld hand;

/* Puts a hand-made model in the place of a built-in one. */
static inline int hand_replace(int index, const Model *model)
{
    Model *m = (Model *)catalog_model(hand.catalog, index); /* the catalog's own, in memory that may be written */
    model_destroy(m);
    *m = *model;
    for (int n = 0; n < m->node_count; n++) strcpy(m->node[n].name, "node"), m->node[n].low = 1;
    for (int p = 0; p < m->part_count; p++) strcpy(m->part[p].name, "part"), strcpy(m->part[p].material, "brick_red");
    model_measure(m);
    return index;
}

static inline int hand_open(bool with_ground)
{
    char            path[text_file_size];
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    LandscapeConfig config = landscape_default_config();
    Model           model;
    text_file(path, "type,model,origin\n1,tank,base\n2,missile,base\n3,marker,base\n");
    const Status status = catalog_open(&hand.catalog, path, 0.01);
    remove(path);
    if (status != STATUS_OK || catalog_model_count(hand.catalog) < 1 + hand_models) return -1;
    hand_plate(&model, hand_plate_y_m, hand_plate_z_m);
    hand.model[hand_plate_model] = hand_replace(1, &model);
    hand_sphere(&model, hand_sphere_m, 48);
    hand.model[hand_sphere_model] = hand_replace(2, &model);
    hand_box(&model, (const double[3]){-0.03, -0.03, -8}, (const double[3]){0.03, 0.03, 0});
    hand.model[hand_mast_model] = hand_replace(3, &model);

    config.half_width_m = 500;
    config.horizon_m = 20000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    if (with_ground && landscape_create(&hand.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (world_open(&hand.world, hand.catalog, with_ground ? &hand.landscape : NULL, &frame, "avx2") != STATUS_OK)
        return -1;
    const int brick = materials_find(&hand.world.materials, "brick_red");
    Material *m = &hand.world.materials.material[brick];
    for (int c = 0; c < optical_channel_count; c++) m->rho[c] = hand_rho, hand.world.materials.ground_rho[c] = 0;
    m->rho_mwir = m->rho_lwir = hand_rho_ir;
    m->gloss = 0;
    m->metal = 1;
    hand.arena = arena_create();
    hand.air_arena = arena_create();
    return hand.arena && hand.air_arena && atmosphere_open(&hand.world.atmosphere, "us1976") == STATUS_OK &&
                   pool_create(&hand.pool, 2) == STATUS_OK
               ? 0
               : -1;
}

static inline int hand_close(void **state)
{
    (void)state;
    pool_destroy(hand.pool);
    world_close(&hand.world);
    if (hand.world.landscape || hand.landscape.cover) landscape_destroy(&hand.landscape);
    catalog_close(hand.catalog);
    arena_destroy(hand.arena);
    arena_destroy(hand.air_arena);
    return 0;
}

static inline void hand_clear(void) { hand.snapshot = (Snapshot){.entity = hand.entity, .node = hand.pose}; }

static inline int hand_add(int model, const double p_enu[3], const double r_enu_from_body[9])
{
    const int       k = hand.snapshot.count++;
    SnapshotEntity *e = &hand.entity[k];
    *e = (SnapshotEntity){.id = {1, 1, (uint16_t)(k + 1)}, .model = hand.model[model], .first_node = k};
    ecef_from_enu(e->p_ecef, &hand.world.frame, p_enu);
    m3_mul(e->r_ecef_from_body, hand.world.frame.r_ecef_from_enu, r_enu_from_body);
    hand.pose[k] = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    hand.snapshot.node_count = hand.snapshot.count;
    return k;
}

/* Body axes: forward in the plane of east and north at this angle from east, then turned down by dive. */
static inline void hand_attitude(double r[9], double from_east_rad, double dive_rad)
{
    const double c = cos(from_east_rad), s = sin(from_east_rad), cd = cos(dive_rad), sd = sin(dive_rad);
    const double x[3] = {c * cd, s * cd, -sd}, y[3] = {s, -c, 0};
    double       z[3];
    v3_cross(z, x, y);
    for (int k = 0; k < 3; k++) r[3 * k] = x[k], r[3 * k + 1] = y[k], r[3 * k + 2] = z[k];
}

/* Looks from p_enu along d_enu, columns level. */
static inline View hand_view(const double p_enu[3], const double d_enu[3], int width, int height, double focal_px)
{
    View   view = {.width = width, .height = height, .focal_px = focal_px};
    double x[3], y[3], z[3] = {0, 0, 1};
    v3_normalize(z, d_enu);
    v3_cross(x, z, (const double[3]){0, 0, 1});
    v3_normalize(x, x);
    v3_cross(y, z, x);
    for (int k = 0; k < 3; k++) {
        view.p_enu[k] = p_enu[k];
        view.r_enu_from_cam[3 * k] = x[k];
        view.r_enu_from_cam[3 * k + 1] = y[k];
        view.r_enu_from_cam[3 * k + 2] = z[k];
    }
    return view;
}

/* A sun, and nothing else that shines, warms, cools, dims or glows. */
static inline void hand_air_off(const double sun_enu[3])
{
    static const double dark[AIR_BAND_COUNT] = {0};
    Air                *a = &hand.air;
    air_even(a, sun_enu, 300, dark, 0, hand.world.planck_mwir, hand.world.planck_lwir);
    for (int b = AIR_MWIR; b <= AIR_LWIR; b++) a->light.sun_w_m2[b] = a->sun_eye_w_m2[b] = 0;
    a->light.solar_direct_w_m2 = a->light.solar_diffuse_w_m2 = 0;
}

/* Air of the tables about an eye at this height; good until hand_close. */
static inline void hand_air_on(const double sun_enu[3], double height_m)
{
    const AirSource source = {hand.world.atmosphere, hand.world.planck_mwir, hand.world.planck_lwir, 0, 0};
    const AirEye    eye = {.height_m = height_m, .bands = (1 << AIR_BAND_COUNT) - 1};
    const Weather   weather = weather_default();
    Sun             sun = {.elevation_rad = asin(sun_enu[2]), .distance_au = 1};
    memcpy(sun.d_enu, sun_enu, sizeof sun.d_enu);
    assert_int_equal(air_at(&hand.air, &source, &weather, &sun, &eye, NULL, hand.air_arena), STATUS_OK);
}

/* What a part of brick sends out by itself, W/(m2 sr): it is as warm as the air. */
static inline double hand_emitted(Band band)
{
    const bool mwir = band == BAND_MWIR;
    return (1 - hand_rho_ir) *
           planck_band(mwir ? 3.4e-6 : 8e-6, mwir ? 4.8e-6 : 12e-6, hand.air.light.weather.air_temp_k, NULL);
}

static inline RenderRequest hand_request(const View *view)
{
    return (RenderRequest){.view = *view,
                           .bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR,
                           .truth = true,
                           .samples = 1,
                           .edge_samples = 4,
                           .target_samples = 48,
                           .hidden_entity = -1};
}

static inline Picture hand_render(const RenderRequest *request, Pool *pool)
{
    Picture picture;
    assert_int_equal(render(&picture, &hand.world, &hand.snapshot, request, &hand.air, pool, hand.arena), STATUS_OK);
    return picture;
}

/* Sum over the picture of (radiance - even background) x solid angle, W/m2 at the eye. */
static inline double hand_irradiance(const Picture *p, const View *view, int plane, double background_w_m2_sr)
{
    double sum = 0;
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++) {
            const double u = (x + 0.5 - 0.5 * view->width) / view->focal_px,
                         v = (y + 0.5 - 0.5 * view->height) / view->focal_px;
            sum += (picture_plane(p, plane)[y * p->width + x] - background_w_m2_sr) /
                   (pow(1 + u * u + v * v, 1.5) * view->focal_px * view->focal_px);
        }
    return sum;
}

/* The hand's world as an eye over its origin sees it; bent: through air. */
static inline const Visibility *hand_see(double eye_m, bool bent, unsigned skips_off)
{
    Visibility      *v;
    VisibilityConfig config = {.tracer = hand.world.tracer,
                               .ground = &hand.landscape,
                               .frame = &hand.world.frame,
                               .snapshot = &hand.snapshot,
                               .skips_off = skips_off,
                               .eye_enu = {0, 0, eye_m}};
    if (bent) config.bend_per_m = world_bend(&hand.world, REFRACTION_OPTICAL, config.eye_enu);
    assert_int_equal(visibility_create_seen(&v, &config, hand.arena), STATUS_OK);
    return v;
}

/* One ray of that eye. */
static inline const Hits *hand_look(const Visibility *v, double eye_m, const double d_enu[3], bool bent)
{
    static Rays        rays;
    static Hits        hits;
    VisibilityCounters unused = {0};
    rays.count = 1, rays.bent = bent, rays.far_m[0] = INFINITY;
    for (int k = 0; k < 3; k++) rays.o_enu[k][0] = k == 2 ? eye_m : 0, rays.d_enu[k][0] = d_enu[k];
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &unused);
    return &hits;
}

#endif
