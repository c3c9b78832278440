/* tests/render/change_stage.h: hand-made bodies in an even sky over level ground that is not traced, and points among
 * them that ask how the light changes (hemisphere_change). */
#ifndef TESTS_RENDER_CHANGE_STAGE_H
#define TESTS_RENDER_CHANGE_STAGE_H

#include "tests/render/hand_models.h"

#include "render/light/hemisphere.h"
#include "render/light/sky_visibility.h"
#include "render/trace/parts/parts.h"

#include <string.h>

enum { model_sphere, model_room, model_brick, model_crate, model_count, most_bodies = 12 };

static const double sphere_m = 1, room_m = 10; /* radius; half a side */
static const double brick_low[3] = {-2, -1, -0.5}, brick_high[3] = {3, 1.5, 1};

static struct {
    PlanckTable   *mwir, *lwir;
    Model          model[model_count];
    Tracer        *tracer;
    Arena         *arena;
    LocalFrame     frame;
    SnapshotEntity entity[most_bodies];
    NodePose       pose[most_bodies];
    Snapshot       snapshot;
    Visibility    *visibility;
    Material       rows[1 + model_count];
    Materials      materials;
    int           *part[model_count], row_of[model_count];
    Air            air;
} stage;

static int open_stage(void **state)
{
    (void)state;
    const Geodetic origin = {0.6, -1.9, 700};
    const Model   *models[model_count] = {&stage.model[0], &stage.model[1], &stage.model[2], &stage.model[3]};
    if (planck_table_create(&stage.mwir, 3.4e-6, 4.8e-6) != STATUS_OK ||
        planck_table_create(&stage.lwir, 8e-6, 12e-6) != STATUS_OK ||
        local_frame_at(&stage.frame, &origin) != STATUS_OK)
        return -1;
    hand_sphere(&stage.model[model_sphere], sphere_m, 64);
    hand_box(&stage.model[model_room], (const double[3]){-room_m, -room_m, -room_m},
             (const double[3]){room_m, room_m, room_m});
    hand_box(&stage.model[model_brick], brick_low, brick_high);
    hand_box(&stage.model[model_crate], (const double[3]){-1.5, -2, -1}, (const double[3]){1.5, 2, 1});
    if (tracer_create_models(&stage.tracer, models, model_count, "avx2") != STATUS_OK) return -1;
    stage.arena = arena_create();
    for (int k = 0; k < model_count; k++) stage.row_of[k] = k + 1, stage.part[k] = &stage.row_of[k];
    stage.materials =
        (Materials){.count = 1 + model_count, .material = stage.rows, .part = stage.part, .model_count = model_count};
    stage.snapshot = (Snapshot){.entity = stage.entity, .node = stage.pose};
    return stage.arena ? 0 : -1;
}

static int close_stage(void **state)
{
    (void)state;
    tracer_destroy(stage.tracer);
    arena_destroy(stage.arena);
    planck_table_destroy(stage.mwir), planck_table_destroy(stage.lwir);
    for (int m = 0; m < model_count; m++) hand_free(&stage.model[m]);
    return 0;
}

static void clear_bodies(void)
{
    stage.snapshot.count = stage.snapshot.node_count = 0;
    arena_reset(stage.arena);
}

static int add_body(int model, const double p_enu[3], const double r_enu_from_body[9])
{
    static const double straight[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int           k = stage.snapshot.count++;
    stage.snapshot.node_count = stage.snapshot.count;
    stage.entity[k] = (SnapshotEntity){.model = model, .first_node = k};
    ecef_from_enu(stage.entity[k].p_ecef, &stage.frame, p_enu);
    m3_mul(stage.entity[k].r_ecef_from_body, stage.frame.r_ecef_from_enu, r_enu_from_body ? r_enu_from_body : straight);
    stage.pose[k] = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return k;
}

static void pose_bodies(void)
{
    assert_int_equal(
        visibility_create(&stage.visibility, stage.tracer, NULL, &stage.frame, &stage.snapshot, 0, stage.arena),
        STATUS_OK);
    visibility_materials(stage.visibility, &stage.materials);
}

/* Of all bodies, in all bands. */
static void set_rho(double bodies, double ground)
{
    for (int c = 0; c < optical_channel_count; c++) {
        for (int m = 1; m <= model_count; m++) stage.rows[m].rho[c] = (float)bodies;
        stage.materials.ground_rho[c] = (float)ground;
    }
    for (int m = 1; m <= model_count; m++) stage.rows[m].rho_mwir = stage.rows[m].rho_lwir = (float)bodies;
}

/* An even sky of this radiance in all bands; thermal ground of `ground`. */
static void set_air(const double sun[3], double sun_w_m2, double sky, double ground)
{
    double even[AIR_BAND_COUNT];
    for (int b = 0; b < AIR_BAND_COUNT; b++) even[b] = sky;
    air_even(&stage.air, sun, sun_w_m2, even, 0, stage.mwir, stage.lwir);
    stage.air.light.ground_w_m2_sr[AIR_MWIR] = stage.air.light.ground_w_m2_sr[AIR_LWIR] = ground;
}

static HemisphereScene stage_scene(void)
{
    return (HemisphereScene){stage.visibility, &stage.air, &stage.materials, NULL, &stage.snapshot};
}

static void put_point(Hits *hits, const double p_enu[3], const double n_enu[3], int entity)
{
    const int i = hits->count++;
    for (int c = 0; c < 3; c++) hits->p_enu[c][i] = p_enu[c], hits->n_enu[c][i] = hits->n_geo[c][i] = (float)n_enu[c];
    hits->range_m[i] = 10, hits->entity[i] = (uint32_t)entity, hits->kind[i] = entity ? hit_part : hit_ground;
}

/* The change at the hits by all bodies, with keys of this series. */
static inline void change_of(HemisphereChange *out, const Hits *hits, unsigned bands, int samples, double reach_m,
                             double list_reach_m, uint64_t series, SkyNotes *notes)
{
    static uint64_t    key[hits_capacity];
    int                list[most_bodies];
    double             list_reach[most_bodies];
    VisibilityCounters counters = {0};
    for (int k = 0; k < stage.snapshot.count; k++) list[k] = k, list_reach[k] = list_reach_m;
    for (int i = 0; i < hits->count; i++) key[i] = series * hits_capacity + (uint64_t)i;
    const HemisphereNear  near = {.bands = bands,
                                  .samples = samples,
                                  .reach_m = reach_m,
                                  .listed = stage.snapshot.count,
                                  .list = list,
                                  .list_reach_m = list_reach};
    const HemisphereScene scene = stage_scene();
    hemisphere_change(out, &scene, hits, &near, key, notes, &counters);
}

#endif
