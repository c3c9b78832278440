/* tests/render/test_view_memory.c: views that are remembered between sessions decide no bit of temperatures and no
 * work; and what changes a view is in its key. */
#include "tests/render/vehicle_stage.h"

#include "render/heat/surface_flux_private.h"

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 2, 6, 0, 0};

static Status sunny(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)p_enu, (void)present;
    *out = (PlaceHeat){.air_k = 288,
                       .air_density = 1,
                       .longwave_w_m2 = stefan_w_m2k4 * pow(270, 4),
                       .direct_w_m2 = 800,
                       .diffuse_w_m2 = 90,
                       .ground_k = 295,
                       .under_k = 290,
                       .ground_rho = 0.2,
                       .sun_d_enu = {sin(1e-4 * unix_s) * 0.8, cos(1e-4 * unix_s) * 0.8, 0.6}};
    return STATUS_OK;
}

enum { entities = 3, most_ticks = 40, most_patches = 600 };

typedef struct Course {
    int   patches[most_ticks];
    bool  waits[most_ticks];
    float patch_k[most_ticks][most_patches];
} Course;

/* Three that drive beside each other, the second past the first. */
static void drive(Course *out, double window_us)
{
    Snapshot          all = {.count = entities};
    SnapshotEntity    entity[entities];
    SnapshotJoints    joints[entities];
    Scene             one;
    VehicleHeatConfig config = {.step_s = 30, .window_us = window_us, .place = sunny};
    VehicleHeat      *heat = stage_start(&config, NULL);
    *out = (Course){0};
    for (int tick = 0; tick < most_ticks; tick++) {
        for (int i = 0; i < entities; i++) {
            const double p_enu[3] = {6.0 * i, 0.2 * tick * i, 0};
            place(&one, i == 2 ? truck : tank, (EntityDrives){.engine = 1});
            entity[i] = one.entity, joints[i] = one.joints;
            entity[i].id.entity = (uint16_t)(i + 1);
            ecef_from_enu(entity[i].p_ecef, &stage.frame, p_enu);
        }
        all.entity = entity, all.joints = joints;
        all.t_s = tick / 4.0;
        CHECK(vehicle_heat_tick(heat, &all) == STATUS_OK);
        CHECK(vehicle_heat_show(heat, &all, stage.arena) == STATUS_OK && all.patch_count <= most_patches);
        out->patches[tick] = all.patch_count;
        out->waits[tick] = vehicle_heat_waits(heat);
        memcpy(out->patch_k[tick], all.patch_k, (size_t)all.patch_count * sizeof *all.patch_k);
        arena_reset(stage.arena);
    }
    CHECK(out->patches[most_ticks - 1] > 20);
    vehicle_heat_destroy(heat);
}

static void what_is_remembered_decides_no_bit(void **state)
{
    (void)state;
    static Course     without, first, again;
    static const char limits[] = {0, 1};
    ViewMemory       *memory = stage.patches.seen;
    for (int k = 0; k < 2; k++) {
        const double window_us = limits[k] ? 3500 : INFINITY;
        stage.patches.seen = NULL;
        drive(&without, window_us);
        stage.patches.seen = memory;
        drive(&first, window_us);
        drive(&again, window_us);
        CHECK(memcmp(&without, &first, sizeof first) == 0);
        CHECK(memcmp(&without, &again, sizeof again) == 0);
    }
}

/* A pose, for its key alone. */
typedef struct Posed {
    PatchPose   pose;
    PosedEntity entity;
    PosedNode   node[64];
    NodePose    at[64];
} Posed;

static void pose_one(Posed *p)
{
    Scene        s;
    const double origin[3] = {0, 0, 0}, r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    const Model *model;
    memset(p, 0, sizeof *p);
    place(&s, tank, (EntityDrives){0});
    CHECK(tracer_need(stage.tracer, s.entity.model) == STATUS_OK);
    model = tracer_model(stage.tracer, s.entity.model);
    CHECK(heat_patches_need(&stage.patches, s.entity.model, model) == STATUS_OK);
    CHECK(model->node_count <= 64);
    model_pose(p->at, model, NULL);
    p->entity.node = p->node;
    parts_pose(&p->entity, stage.tracer, s.entity.model, p->at, origin, r_enu_from_body, 0);
    p->pose = (PatchPose){.patches = &stage.patches.of[s.entity.model],
                          .model = model,
                          .posed = &p->entity,
                          .node = p->at,
                          .above_m = 0.1};
    memcpy(p->pose.r_enu_from_body, r_enu_from_body, sizeof p->pose.r_enu_from_body);
}

static bool is_known(ViewMemory *memory, const Posed *p, const PosedEntity *const *other, int others,
                     const double *toward, size_t octets)
{
    const KnownViews seen = view_memory_of(memory, &p->pose, other, others, toward, octets);
    CHECK(seen.known);
    const bool known = seen.known[0];
    seen.known[0] = true;
    memset(seen.record, 1, octets * (size_t)p->pose.patches->count);
    return known;
}

static void each_input_is_in_the_key(void **state)
{
    (void)state;
    static Posed       p, other;
    const double       toward[3] = {0, 0, 1}, aside[3] = {0, 0.6, 0.8};
    const PosedEntity *there[2] = {NULL, NULL};
    ViewMemory        *memory = view_memory_create();
    pose_one(&p), pose_one(&other);
    CHECK(!is_known(memory, &p, NULL, 0, NULL, 4) && is_known(memory, &p, NULL, 0, NULL, 4));
    CHECK(!is_known(memory, &p, NULL, 0, NULL, 8) && !is_known(memory, &p, NULL, 0, toward, 4));
    CHECK(!is_known(memory, &p, NULL, 0, aside, 4) && !is_known(memory, &p, there, 1, NULL, 4));
    there[1] = &other.entity;
    CHECK(!is_known(memory, &p, there, 2, NULL, 4) && is_known(memory, &p, there, 2, NULL, 4));
    other.node[0].p_enu[1] += 1e-12;
    CHECK(!is_known(memory, &p, there, 2, NULL, 4));
    /* every number of the pose, first and last, and of the last node; those of others by the same function */
    PosedNode    *last = &p.node[p.entity.node_count - 1];
    NodePose     *end = &p.at[p.pose.model->node_count - 1];
    double *const moved[] = {&p.pose.above_m,
                             &p.pose.r_enu_from_body[0],
                             &p.pose.r_enu_from_body[8],
                             &p.at[0].p_body[0],
                             &end->p_body[2],
                             &end->r_body_from_node[8],
                             &p.node[0].p_enu[0],
                             &last->p_enu[2],
                             &p.node[0].r_enu_from_node[0],
                             &last->r_enu_from_node[8],
                             &p.node[0].centre_enu[0],
                             &last->centre_enu[2],
                             &p.entity.centre_enu[0],
                             &p.entity.centre_enu[2],
                             &p.entity.radius_m,
                             &p.entity.p_enu[0],
                             &p.entity.p_enu[2],
                             &p.entity.r_enu_from_body[0],
                             &p.entity.r_enu_from_body[8],
                             &p.entity.box_low[0],
                             &p.entity.box_low[2],
                             &p.entity.box_high[0],
                             &p.entity.box_high[2]};
    for (size_t k = 0; k < sizeof moved / sizeof *moved; k++) {
        *moved[k] += 1e-9;
        CHECK(!is_known(memory, &p, NULL, 0, NULL, 4) && is_known(memory, &p, NULL, 0, NULL, 4));
    }
    p.entity.damage = 3; /* a wreck sees, and is seen, past what its damage hides */
    CHECK(!is_known(memory, &p, NULL, 0, NULL, 4) && is_known(memory, &p, NULL, 0, NULL, 4));
    p.entity.model++;
    CHECK(!is_known(memory, &p, NULL, 0, NULL, 4) && is_known(memory, &p, NULL, 0, NULL, 4));
    last->mesh = p.node[0].mesh;
    CHECK(p.entity.node_count < 2 || !is_known(memory, &p, NULL, 0, NULL, 4));
    p.entity.node_count--;
    CHECK(!is_known(memory, &p, NULL, 0, NULL, 4));
    /* of others: each of them, its damage, and which of the places it has */
    there[0] = &other.entity, there[1] = NULL;
    CHECK(!is_known(memory, &p, there, 2, NULL, 4));
    there[1] = &other.entity;
    CHECK(!is_known(memory, &p, there, 2, NULL, 4));
    other.entity.damage = 3;
    CHECK(!is_known(memory, &p, there, 2, NULL, 4) && is_known(memory, &p, there, 2, NULL, 4));
    double each[3] = {0.1, 0.2, 0.9};
    for (int x = 0; x < 3; x++) {
        CHECK(is_known(memory, &p, NULL, 0, each, 4) == (x > 0));
        each[x] += 1e-9;
        CHECK(!is_known(memory, &p, NULL, 0, each, 4));
    }
    int kept = 0; /* it ends, and says so */
    for (; kept < 100000; kept++) {
        p.pose.above_m += 1e-6;
        if (!view_memory_of(memory, &p.pose, NULL, 0, NULL, sizeof(PatchView)).known) break;
    }
    CHECK(kept > 1000 && kept < 100000);
    CHECK(!view_memory_of(NULL, &p.pose, NULL, 0, NULL, 4).known);
    view_memory_destroy(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_remembered_decides_no_bit),
        cmocka_unit_test(each_input_is_in_the_key),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
