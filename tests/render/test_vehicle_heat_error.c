/* tests/render/test_vehicle_heat_error.c: the estimate of what steps and the past's single steps leave out of entities' temperatures, against
 * steps of a second and a past of eight times as many, with error control. */
#include "tests/check.h"
#include "render/heat/vehicle_heat.h"
#include "render/heat/surface_flux.h"
#include "render/parts/parts.h"

typedef struct Stage {
    Catalog   *catalog;
    Materials  materials;
    PartTable  table;
    Tracer    *tracer;
    PatchSet   patches;
    LocalFrame frame;
    Arena     *arena;
} Stage;
static Stage stage;

/* A clear day about the equinox at 45 degrees north; Unix time 0 is noon. */
static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)p_enu, (void)present;
    const double turn = unix_s * 2 * pi_rad / 86400, up = M_SQRT1_2 * cos(turn);
    *out = (PlaceHeat){.air_k = 288 + 5 * cos(turn - 0.7), .air_density = 1, .wind_enu_mps = {2, 1, 0}, .longwave_w_m2 = 300, .ground_rho = 0.2,
                       .sun_d_enu = {-sin(turn), -M_SQRT1_2 * cos(turn), up}};
    out->ground_k = out->air_k + 10 * cos(turn - 0.4), out->under_k = out->air_k;
    if (up > 0) out->direct_w_m2 = 1361 * pow(0.7, pow(1 / fmax(up, 0.02), 0.678)), out->diffuse_w_m2 = 136 * up;
    return STATUS_OK;
}

static int open_stage(void **state)
{
    (void)state;
    char path[512], materials[512], surfaces[512], machines[512];
    CHECK(etc_path(path, sizeof path, "catalog.csv") && catalog_open(&stage.catalog, path, 0.01) == STATUS_OK);
    CHECK(etc_path(materials, sizeof materials, "materials.csv") && etc_path(surfaces, sizeof surfaces, "surfaces.csv"));
    CHECK(materials_open(&stage.materials, materials, surfaces, stage.catalog) == STATUS_OK);
    CHECK(etc_path(path, sizeof path, "heat.csv") && etc_path(machines, sizeof machines, "heat_machines.csv"));
    CHECK(part_table_open(&stage.table, path, machines) == STATUS_OK);
    CHECK(tracer_create(&stage.tracer, stage.catalog, "avx2") == STATUS_OK);
    CHECK(patch_set_create(&stage.patches, catalog_model_count(stage.catalog)) == STATUS_OK);
    CHECK(local_frame_at(&stage.frame, &(Geodetic){0.7, 0.2, 0}) == STATUS_OK);
    return (stage.arena = arena_create()) == NULL;
}

static int close_stage(void **state)
{
    (void)state;
    arena_destroy(stage.arena);
    patch_set_destroy(&stage.patches);
    tracer_destroy(stage.tracer);
    materials_close(&stage.materials);
    catalog_close(stage.catalog);
    return 0;
}

static VehicleHeat *start(double unix_s, double step_s, int past_parts)
{
    VehicleHeat            *heat;
    const VehicleHeatConfig config = {.first_step_s = 1, .step_s = step_s, .window_us = INFINITY, .past_parts = past_parts, .capacity = 8,
                                      .unix_s = unix_s, .place = everywhere};
    const VehicleHeatWorld  world = {stage.catalog, &stage.materials, &stage.table, &stage.frame, stage.tracer, &stage.patches, NULL, NULL};
    CHECK(vehicle_heat_create(&heat, &config, &world) == STATUS_OK);
    return heat;
}

/* One entity: where it stands, facing north; its drives. */
typedef struct Scene {
    Snapshot       snapshot;
    SnapshotEntity entity;
    SnapshotJoints joints;
} Scene;

static void place(Scene *s, DisEntityType type, EntityDrives drives)
{
    const double p_enu[3] = {0, 0, 0}, r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    memset(s, 0, sizeof *s);
    s->entity = (SnapshotEntity){.id = {1, 1, 1}, .type = type, .model = catalog_find(stage.catalog, type, NULL, NULL),
                                 .drives = drives, .first_patch = -1};
    ecef_from_enu(s->entity.p_ecef, &stage.frame, p_enu);
    m3_mul(s->entity.r_ecef_from_body, stage.frame.r_ecef_from_enu, r_enu_from_body);
    s->snapshot = (Snapshot){.count = 1, .entity = &s->entity, .joints = &s->joints};
}


static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 7, 1, 0, 0}, person = {3, 1, 225, 1, 0, 0, 0},
                           helicopter = {1, 2, 225, 20, 1, 0, 0}, house = {5, 1, 225, 1, 0, 0, 0};

typedef struct Case {
    const char   *name;
    DisEntityType type;
    double        hour;           /* of the day, at its first report */
    EntityDrives  before, after;  /* five minutes after it appeared */
} Case;

/* rms of an entity's patches by area, and of their estimate. */
static void misses(double *off_k, double *estimate_k, const Scene *a, const Scene *fine, double air_k)
{
    const Patches *p = &stage.patches.of[a->entity.model];
    double         off = 0, estimate = 0, m2 = 0;
    CHECK(a->entity.patches == p->count && fine->entity.patches == p->count);
    for (int i = 0; i < p->count; i++) {
        const double k = (double)a->snapshot.patch_k[i], d = k - (double)fine->snapshot.patch_k[i], e = vehicle_heat_error_k(k, air_k);
        off += p->patch[i].area_m2 * d * d, estimate += p->patch[i].area_m2 * e * e, m2 += p->patch[i].area_m2;
    }
    *off_k = sqrt(off / m2), *estimate_k = sqrt(estimate / m2);
}

static void the_estimate_holds(void **state)
{
    (void)state;
    enum { looks = 5 };
    static const double look_s[looks] = {0, 20, 290, 330, 590};
    static const Case   cases[] = {
        {"tank that stands, morning", tank, 9, {.engine = 0}, {.engine = 0}},
        {"tank that stands, then starts", tank, 15, {.engine = 0}, {.engine = 0.6f}},
        {"tank that drives, then halts", tank, 12, {.engine = 1, .speed_mps = 10}, {.engine = 0.6f}},
        {"tank at night, idle, then drives", tank, 2, {.engine = 0.6f}, {.engine = 1, .speed_mps = 10}},
        {"tank that fires", tank, 18, {.engine = 0.6f}, {.engine = 0.6f, .fired_kg = {0, 15}}},
        {"truck that drives, then burns", truck, 10, {.engine = 1, .speed_mps = 15}, {.burning = 1}},
        {"truck that stands, evening", truck, 19, {.engine = 0}, {.engine = 0}},
        {"helicopter", helicopter, 11, {.engine = 1, .flying = 1}, {.engine = 1, .flying = 1}},
        {"person", person, 14, {.alive = 1}, {.alive = 1}},
        {"house", house, 8, {.alive = 1}, {.alive = 1}},
    };
    int held = 0, all = 0;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        Scene        s[2];
        VehicleHeat *heat[2];
        int          look = 0;
        for (int k = 0; k < 2; k++) {
            place(&s[k], cases[c].type, cases[c].before);
            heat[k] = start(3600 * (cases[c].hour - 12), k ? 1 : 30, k ? 8 : 1);
        }
        for (double t_s = 0; t_s <= look_s[looks - 1]; t_s += 1) {
            double off_k, estimate_k;
            for (int k = 0; k < 2; k++) {
                s[k].entity.drives = t_s < 300 ? cases[c].before : cases[c].after;
                s[k].snapshot.t_s = t_s;
                CHECK(vehicle_heat_tick(heat[k], &s[k].snapshot) == STATUS_OK);
            }
            if (t_s != look_s[look]) continue;
            PlaceHeat now;
            CHECK(everywhere(&now, NULL, 3600 * (cases[c].hour - 12) + t_s, (const double[3]){0}, true) == STATUS_OK);
            for (int k = 0; k < 2; k++) CHECK(vehicle_heat_show(heat[k], &s[k].snapshot, stage.arena) == STATUS_OK);
            misses(&off_k, &estimate_k, &s[0], &s[1], now.air_k);
            print_message("%s, %3.0f s: off by %.3f K, estimate %.3f K: %.2f\n", cases[c].name, t_s, off_k, estimate_k, off_k / estimate_k);
            held += off_k < 2 * estimate_k && off_k > 0.5 * estimate_k;
            all++, look++;
        }
        for (int k = 0; k < 2; k++) vehicle_heat_destroy(heat[k]);
    }
    print_message("%d of %d within a factor of 2\n", held, all);
    CHECK(all == looks * (int)(sizeof cases / sizeof *cases) && held >= 0.9 * all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_estimate_holds)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
