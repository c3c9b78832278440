/* tests/bench/render/precision_vehicle.c: a vehicle's heat: the steps in time of its network of thermal nodes, with
 * loads that change within them and are straight between their ends; what a step costs; the number of its patches. */
#include "tests/scenes/plate_vehicle.h"
#include "tests/bench/suites.h"
#include "render/heat/surface_flux_private.h"
#include "render/heat/vehicle_heat.h"
#include "render/trace/parts/parts.h"

#include <stdlib.h>

/* ---- steps in time ------------------------------------------------------------------------------ */

static const double span_s = 7200, look_s = 120;
enum { looks = 60 };

typedef struct Drive {
    const PlateVehicle *vehicle;
    Network            *network;
    double              step_s;
    Status              status;
    double              temp_k[looks][vehicle_most_nodes];
} Drive;

static void drive(void *user)
{
    Drive       *d = user;
    NetworkLoad  load[2][vehicle_most_nodes];
    double       temp_k[vehicle_most_nodes];
    const int    steps = (int)lround(span_s / d->step_s), every = (int)lround(look_s / d->step_s);
    const size_t size = (size_t)d->vehicle->nodes * sizeof *temp_k;
    memcpy(temp_k, d->vehicle->start_k, size);
    plate_vehicle_loads(load[0], d->vehicle, 0);
    for (int s = 0; s < steps && d->status == STATUS_OK; s++) {
        plate_vehicle_loads(load[(s + 1) % 2], d->vehicle, (s + 1) * d->step_s);
        d->status = heat_network_step(temp_k, NULL, d->network, load[s % 2], load[(s + 1) % 2], d->step_s);
        if ((s + 1) % every == 0) memcpy(d->temp_k[(s + 1) / every - 1], temp_k, size);
    }
    bench_keep(d->temp_k);
}

static void compare(BenchSetting *point, const Drive *a, const Drive *fine)
{
    double sum = 0;
    for (int t = 0; t < looks; t++)
        for (int i = 0; i < fine->vehicle->nodes; i++) {
            const double off_k = a->temp_k[t][i] - fine->temp_k[t][i];
            bench_worse(&point->error, fabs(off_k));
            sum += off_k * off_k;
        }
    point->also = sqrt(sum / (looks * fine->vehicle->nodes));
}

static Status tunable_step(Bench *bench, const PlateVehicle *vehicle, Network *network)
{
    enum { settings = 4 };
    static const double      step_s[settings] = {10, 30, 60, 120};
    static const char *const name[settings] = {"10 s", "30 s", "60 s", "120 s"};
    static Drive             set[settings], fine;
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    fine = (Drive){.vehicle = vehicle, .network = network, .step_s = 1};
    drive(&fine);
    Status status = fine.status;
    for (int k = 0; k < settings; k++) {
        set[k] = (Drive){.vehicle = vehicle, .network = network, .step_s = step_s[k]};
        drive(&set[k]);
        if (set[k].status != STATUS_OK) status = set[k].status;
        work[k] = (BenchWork){drive, &set[k], span_s / 60};
        point[k] = (BenchSetting){.setting = name[k], .also_is = "rms, K", .is_default = step_s[k] == 30};
        compare(&point[k], &set[k], &fine);
    }
    if (status != STATUS_OK) return status;
    bench_tunable(bench,
                  &(BenchTunable){"steps of a vehicle's heat", "render/heat/heat_network_private.h",
                                  "a minute of 100 nodes", "K", "largest, over two hours, steps of 1 s", 0.2},
                  work, point, settings);
    return STATUS_OK;
}

Status bench_precision_network(Bench *bench)
{
    static PlateVehicle vehicle;
    Network            *network = NULL;
    plate_vehicle(&vehicle, vehicle_most_nodes);
    Status status = plate_vehicle_create(&network, &vehicle);
    if (status == STATUS_OK) status = tunable_step(bench, &vehicle, network);
    if (status != STATUS_OK) log_error("bench: precision: network: %s", status_name(status));
    heat_network_destroy(network);
    return status;
}

/* ---- the time of a step -------------------------------------------------------------------------- */

static const double time_step_s = 30;
enum { timed_steps = 100 };

typedef struct Timed {
    const PlateVehicle *vehicle;
    Network            *network;
    NetworkLoad         load[timed_steps + 1][vehicle_most_nodes];
    double              temp_k[vehicle_most_nodes], heat_j;
    int                 failed;
} Timed;

static void steps(void *user)
{
    Timed *t = user;
    memcpy(t->temp_k, t->vehicle->start_k, sizeof t->temp_k);
    for (int s = 0; s < timed_steps; s++) {
        const Status status =
            heat_network_step(t->temp_k, &t->heat_j, t->network, t->load[s], t->load[s + 1], time_step_s);
        t->failed += status != STATUS_OK;
    }
    bench_keep(t->temp_k);
}

Status bench_speed_network(Bench *bench)
{
    static PlateVehicle vehicle;
    static Timed        t;
    BenchTime           time;
    plate_vehicle(&vehicle, vehicle_most_nodes);
    t = (Timed){.vehicle = &vehicle};
    const Status status = plate_vehicle_create(&t.network, &vehicle);
    if (status != STATUS_OK) return status;
    for (int s = 0; s <= timed_steps; s++) plate_vehicle_loads(t.load[s], &vehicle, s * time_step_s);
    bench_time(&time, bench, &(BenchWork){steps, &t, timed_steps}, 1);
    BenchRow row = bench_row_of("heat of a vehicle: a step of 30 s, 100 nodes, 1 thread", &time, "steps/s", 1);
    row.error = t.failed, row.error_limit = 0, row.error_unit = "steps", row.against = "no failure";
    bench_add(bench, &row);
    heat_network_destroy(t.network);
    return STATUS_OK;
}

/* ---- patches ------------------------------------------------------------------------------------ */

/* Compares temperatures over the surface, as a picture blends them, with those of the most patches. */

enum { patch_settings = 3, ticks = 60 };
static const double tick_s = 30;

typedef struct Stage {
    Catalog   *catalog;
    Materials  materials;
    PartTable  table;
    Tracer    *tracer;
    LocalFrame frame;
    Arena     *arena;
    int        model;
} Stage;

/* A clear morning, the sun in the east; exercise time 0 is 8 o'clock. */
static Status morning(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)p_enu, (void)present;
    const double hour = 8 + unix_s / 3600, turn = (hour - 12) * pi_rad / 12, up = 0.7 * cos(turn) + 0.15;
    *out = (PlaceHeat){.air_k = 288,
                       .air_density = 1,
                       .wind_enu_mps = {2, 0, 0},
                       .longwave_w_m2 = 300,
                       .ground_k = 292,
                       .under_k = 288,
                       .water_k = 288,
                       .ground_rho = 0.2,
                       .sun_d_enu = {-sqrt(fmax(1 - up * up, 0)) * sin(turn) / fmax(fabs(sin(turn)), 1e-9), 0, up}};
    if (up > 0) out->direct_w_m2 = 800, out->diffuse_w_m2 = 80;
    return STATUS_OK;
}

/* A tank that idles, nose north; its last half hour is in view. */
typedef struct Morning {
    const Stage   *stage;
    PatchSet       patches;
    Snapshot       snapshot;
    SnapshotEntity entity;
    SnapshotJoints joints;
    Status         status;
} Morning;

static void live(void *user)
{
    Morning                *m = user;
    const Stage            *s = m->stage;
    VehicleHeat            *heat = NULL;
    const VehicleHeatConfig config = {
        .first_step_s = 1, .step_s = tick_s, .window_us = INFINITY, .capacity = 1, .place = morning};
    const VehicleHeatWorld world = {s->catalog, &s->materials, &s->table, &s->frame,
                                    s->tracer,  &m->patches,   NULL,      NULL};
    arena_reset(s->arena);
    m->status = vehicle_heat_create(&heat, &config, &world);
    for (int t = 0; t < ticks && m->status == STATUS_OK; t++) {
        m->snapshot.t_s = t * tick_s;
        m->status = vehicle_heat_tick(heat, &m->snapshot);
    }
    if (m->status == STATUS_OK) m->status = vehicle_heat_show(heat, &m->snapshot, s->arena);
    if (m->status == STATUS_OK && m->entity.first_patch < 0) m->status = STATUS_BAD_VALUE;
    vehicle_heat_destroy(heat);
}

static Status begin(Morning *m, const Stage *s, int wanted)
{
    static const double p_enu[3] = {0, 0, 0}, r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    *m = (Morning){.stage = s,
                   .entity = {.id = {1, 1, 1},
                              .type = {1, 1, 222, 1, 1, 1, 0},
                              .model = s->model,
                              .drives = {.engine = 0.6f},
                              .first_patch = -1}};
    ecef_from_enu(m->entity.p_ecef, &s->frame, p_enu);
    m3_mul(m->entity.r_ecef_from_body, s->frame.r_ecef_from_enu, r_enu_from_body);
    m->snapshot = (Snapshot){.count = 1, .entity = &m->entity, .joints = &m->joints};
    Status status = heat_patches_create(&m->patches, catalog_model_count(s->catalog));
    if (status == STATUS_OK)
        status = patches_create_of(&m->patches.of[s->model], tracer_model(s->tracer, s->model), wanted);
    if (status == STATUS_OK) m->patches.cut[s->model] = true;
    return status;
}

/* Twice the area of a triangle, its unit normal and its middle; 0: it has none. */
static double facet(double n[3], double middle[3], const Model *model, int triangle)
{
    const double *a = model->vertex[model->triangle[triangle][0]], *b = model->vertex[model->triangle[triangle][1]],
                 *c = model->vertex[model->triangle[triangle][2]];
    double ab[3], ac[3];
    v3_sub(ab, b, a), v3_sub(ac, c, a);
    v3_cross(n, ab, ac);
    for (int i = 0; i < 3; i++) middle[i] = (a[i] + b[i] + c[i]) / 3;
    const double area = v3_length(n);
    return v3_normalize(n, n) ? area : 0;
}

/* Temperatures of the middles of all triangles. k[triangle_count]; NAN: no area. */
static void read_all(float *k, const Morning *m)
{
    const Model *model = tracer_model(m->stage->tracer, m->stage->model);
    for (int p = 0; p < model->part_count; p++)
        for (int t = 0; t < model->part[p].triangle_count; t++) {
            const int at = model->part[p].first_triangle + t;
            double    n[3], middle[3];
            k[at] = facet(n, middle, model, at) > 0
                        ? (float)patch_set_temp_k(&m->patches, &m->snapshot, 0, p, middle, n)
                        : NAN;
        }
}

/* By area. */
static void compare_surfaces(BenchSetting *out, const Model *model, const float *k, const float *fine)
{
    double sum = 0, m2 = 0;
    for (int at = 0; at < model->triangle_count; at++) {
        double       n[3], middle[3];
        const double off_k = (double)(k[at] - fine[at]), area = facet(n, middle, model, at);
        if (!isfinite(off_k)) continue;
        sum += area * off_k * off_k, m2 += area;
    }
    out->error = m2 > 0 ? sqrt(sum / m2) : INFINITY;
}

static Status open_stage(Stage *s)
{
    char path[512], materials[512], surfaces[512], machines[512];
    if (!etc_path(path, sizeof path, "catalog.csv") || !etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv"))
        return STATUS_BAD_VALUE;
    Status status = catalog_open(&s->catalog, path, 0.01);
    if (status == STATUS_OK) status = materials_open(&s->materials, materials, surfaces, s->catalog);
    if (status == STATUS_OK &&
        !(etc_path(path, sizeof path, "heat.csv") && etc_path(machines, sizeof machines, "heat_machines.csv")))
        status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = part_table_open(&s->table, path, machines);
    if (status == STATUS_OK) status = tracer_create(&s->tracer, s->catalog, "avx2");
    if (status == STATUS_OK) status = local_frame_at(&s->frame, &(Geodetic){0.7, 0.2, 0});
    if (status == STATUS_OK && !(s->arena = arena_create())) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    s->model = catalog_find(s->catalog, (DisEntityType){1, 1, 222, 1, 1, 1, 0}, NULL, NULL);
    return tracer_need(s->tracer, s->model);
}

static Status tunable_patches(Bench *bench, const Stage *s)
{
    static const int         wanted[patch_settings] = {30, 60, patches_wanted};
    static const char *const name[patch_settings] = {"30", "60", "110"};
    const Model             *model = tracer_model(s->tracer, s->model);
    Morning                  set[patch_settings], fine;
    BenchWork                work[patch_settings];
    BenchSetting             point[patch_settings] = {0};
    float *k = calloc(2 * (size_t)model->triangle_count, sizeof *k), *fine_k = k ? k + model->triangle_count : NULL;
    Status status = k ? begin(&fine, s, patches_most) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) live(&fine), status = fine.status;
    if (status == STATUS_OK) read_all(fine_k, &fine);
    for (int i = 0; i < patch_settings; i++) {
        set[i] = (Morning){0};
        if (status == STATUS_OK) status = begin(&set[i], s, wanted[i]);
        if (status == STATUS_OK) live(&set[i]), status = set[i].status;
        if (status == STATUS_OK) read_all(k, &set[i]);
        work[i] = (BenchWork){live, &set[i], 1};
        point[i] = (BenchSetting){.setting = name[i], .is_default = wanted[i] == patches_wanted};
        if (status == STATUS_OK) compare_surfaces(&point[i], model, k, fine_k);
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"patches of a vehicle", "entities/models/patches.h",
                                      "half an hour of a tank, with its past", "K",
                                      "rms over its surface, the most patches", 4},
                      work, point, patch_settings);
    heat_patches_destroy(&fine.patches);
    for (int i = 0; i < patch_settings; i++) heat_patches_destroy(&set[i].patches);
    free(k);
    return status;
}

Status bench_precision_patches(Bench *bench)
{
    Stage  s = {0};
    Status status = open_stage(&s);
    if (status == STATUS_OK) status = tunable_patches(bench, &s);
    if (status != STATUS_OK) log_error("bench: precision: patches: %s", status_name(status));
    arena_destroy(s.arena);
    tracer_destroy(s.tracer);
    materials_close(&s.materials);
    catalog_close(s.catalog);
    return status;
}
