/* tests/bench/render/speed_crowd.c: cost of many entities in a frame: 100,000 entities of which 20 are in view, and
 * tanks stacked in a square of 60 m. */
#include "tests/bench/suites.h"

#include "tests/bench/bench.h"
#include "terrain/ground/landscape.h"
#include "sensor/quality/trial_private.h"
#include "sensor/settings/config.h"

#include <time.h>

enum { in_view = 20, world_entities = 100000, id_numbers = 60000 };

typedef struct CrowdFrame {
    TrialScene scene;
    TrialFrame frame;
} CrowdFrame;

static const DisEntityType tank_type = {1, 1, 222, 1, 1, 1, 0};

/* Gives the place of tank k, east and north. */
typedef void CrowdPlace(double p_enu[2], int k);

static double crowd_dice(uint32_t stream, int k) { return random_uniform(1, stream, 0, (uint64_t)k); }

/* South of the eye, in rings of up to 12 km. */
static void behind_the_eye(double p_enu[2], int k)
{
    p_enu[0] = 24000 * (crowd_dice(2, k) - 0.5);
    p_enu[1] = -1000 - 11000 * crowd_dice(3, k);
}

static void in_a_square(double p_enu[2], int k)
{
    p_enu[0] = 60 * (crowd_dice(4, k) - 0.5);
    p_enu[1] = 60 * (crowd_dice(5, k) - 0.5);
}

static Status add_tank(TrialScene *scene, int k, CrowdPlace *place)
{
    const LocalFrame *frame = &scene->landscape->frame;
    const double      turn = 2 * pi_rad * crowd_dice(1, k);
    const double      r_enu_from_body[9] = {sin(turn), cos(turn), 0, cos(turn), -sin(turn), 0, 0, 0, -1};
    double            p_enu[3], r_ecef_from_body[9], euler[3];
    DisEntityState    pdu = {.header = {.version = 7, .type = dis_pdu_entity_state},
                             .force = 1,
                             .type = tank_type,
                             .id = {(uint16_t)(2 + k / id_numbers), 1, (uint16_t)(1 + k % id_numbers)},
                             .appearance = 1u << 22,
                             .dead_reckoning = 4,
                             .variable_count = 2};
    place(p_enu, k);
    p_enu[2] = elevation_height(&scene->landscape->elevation, p_enu[0], p_enu[1], NULL);
    ecef_from_enu(pdu.p_ecef, frame, p_enu);
    m3_mul(r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    euler_from_r_ecef_from_body(&euler[0], &euler[1], &euler[2], r_ecef_from_body);
    pdu.psi_rad = (float)euler[0], pdu.theta_rad = (float)euler[1], pdu.phi_rad = (float)euler[2];
    pdu.variable[0] = (DisVariableParameter){.parameter = 4096 + 11, .value = (float)(turn - 3)};
    pdu.variable[1] = (DisVariableParameter){.parameter = 4416 + 13, .value = 0.1f};
    return entity_table_entity_state(scene->table, &pdu, scene->sun_now_s);
}

/* Vehicles in rows in front of the eye, and `more` tanks by position. */
static Status crowd_open(CrowdFrame *c, const Landscape *landscape, int vehicles, int more, CrowdPlace *place)
{
    EntityTableConfig config = entity_table_default_config();
    char              catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = trial_scene_open(&c->scene, landscape, catalog, &tank_type, 1, 0);
    if (status != STATUS_OK) return status;
    config.ground = (ContactGround){.frame = &landscape->frame, .elevation = &landscape->elevation};
    config.capacity = vehicles + more + 1;
    entity_table_destroy(c->scene.table);
    c->scene.table = NULL;
    status = entity_table_create(&c->scene.table, &config, c->scene.catalog);
    for (int k = 0; k < vehicles && status == STATUS_OK; k++) {
        const TrialPlace at = {.type = tank_type,
                               .number = k + 1,
                               .appearance = 1u << 22,
                               .east_m = 40.0 * (k % 5) - 80,
                               .north_m = 40.0 * (k / 5) - 60,
                               .turn_rad = 2 * pi_rad * crowd_dice(6, k)};
        status = trial_scene_place(&c->scene, &at);
    }
    for (int k = 0; k < more && status == STATUS_OK; k++) status = add_tank(&c->scene, k, place);
    return status;
}

static RenderRequest crowd_request(const View *view)
{
    const Config config = config_default();
    return (RenderRequest){.view = *view,
                           .bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR,
                           .truth = true,
                           .optical = OPTICAL_RGB,
                           .samples = 1,
                           .edge_samples = config.sensor.edge_samples,
                           .target_samples = config.sensor.target_samples,
                           .sky_visibility = true,
                           .hidden_entity = -1};
}

typedef struct Crowds {
    Bench    *bench;
    Landscape landscape;
    Pool     *pool;
    Arena    *arena;
} Crowds;

static double thread_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Times one thread: the snapshot of a world, and the tree over it. */
static Status time_tree(Crowds *all, const TrialScene *scene)
{
    enum { rounds = 15 };
    BenchTime snapshot = {.rounds = rounds}, tree = {.rounds = rounds};
    Status    status = STATUS_OK;
    for (int r = 0; r < rounds && status == STATUS_OK; r++) {
        Snapshot    s;
        Visibility *v;
        arena_reset(all->arena);
        const double t0 = thread_s();
        status = entity_table_snapshot(&s, scene->table, scene->sun_now_s + 0.5, all->arena);
        const double t1 = thread_s();
        if (status == STATUS_OK)
            status =
                visibility_create(&v, scene->world.tracer, &all->landscape, &all->landscape.frame, &s, 0, all->arena);
        snapshot.item_s[r] = t1 - t0;
        tree.item_s[r] = thread_s() - t1;
    }
    if (status != STATUS_OK) return status;
    bench_time_finish(&snapshot);
    bench_time_finish(&tree);
    BenchRow row = bench_row_of("crowd: snapshot of 100,000, one thread", &snapshot, "snapshots/s", 1);
    bench_add(all->bench, &row);
    row = bench_row_of("crowd: the tree over 100,000, one thread", &tree, "trees/s", 1);
    bench_add(all->bench, &row);
    return STATUS_OK;
}

static Status time_world(Crowds *all)
{
    CrowdFrame few = {0}, many = {0};
    Status     status = crowd_open(&few, &all->landscape, in_view, 0, NULL);
    if (status == STATUS_OK)
        status = crowd_open(&many, &all->landscape, in_view, world_entities - in_view, behind_the_eye);
    CrowdFrame *const both[2] = {&few, &many};
    const int         rounds = bench_quick(all->bench) ? 3 : 9;
    BenchTime         time[2] = {{.rounds = rounds}, {.rounds = rounds}};
    BenchTime         prepare = {.rounds = rounds};
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const View view = trial_view(&both[k]->scene, 300, 40, 0.7, 320, 216);
        both[k]->frame = (TrialFrame){
            .scene = &both[k]->scene, .request = crowd_request(&view), .pool = all->pool, .arena = all->arena};
    }
    for (int r = -1; r < rounds && status == STATUS_OK; r++)
        for (int k = 0; k < 2 && status == STATUS_OK; k++) {
            TrialFrame *f = &both[k]->frame;
            trial_frame(f);
            status = f->status;
            if (r < 0) continue;
            time[k].item_s[r] = f->stage_s[STAGE_FRAME] - f->stage_s[STAGE_SNAPSHOT];
            if (k == 1) prepare.item_s[r] = f->stage_s[STAGE_PREPARE];
        }
    if (status == STATUS_OK) {
        for (int k = 0; k < 2; k++) bench_time_finish(&time[k]);
        bench_time_finish(&prepare);
        BenchRow row =
            bench_row_of("crowd: frame of 320 x 216 beside its snapshot, 20 tanks in view", &time[0], "frames/s", 1);
        bench_add(all->bench, &row);
        row = bench_row_of("crowd: the same, 100,000 in the world", &time[1], "frames/s", 1);
        row.ratio = bench_ratio(&time[1], &time[0]), row.to = "the 20 alone";
        bench_add(all->bench, &row);
        row = bench_row_of("crowd: prepare, of 100,000", &prepare, "frames/s", 1);
        bench_add(all->bench, &row);
        status = time_tree(all, &many.scene);
    }
    trial_scene_close(&few.scene);
    trial_scene_close(&many.scene);
    return status;
}

/* Interpenetrating tanks. */
static Status time_stack(Crowds *all, int count, double back_m, double hfov_rad, const char *what)
{
    CrowdFrame stack = {0};
    Status     status = crowd_open(&stack, &all->landscape, 0, count, in_a_square);
    BenchTime  time = {.rounds = 3};
    if (status == STATUS_OK) {
        const View view = trial_view(&stack.scene, back_m, 0.1 * back_m, hfov_rad, 160, 108);
        stack.frame = (TrialFrame){
            .scene = &stack.scene, .request = crowd_request(&view), .pool = all->pool, .arena = all->arena};
    }
    for (int r = 0; r < time.rounds && status == STATUS_OK; r++) {
        trial_frame(&stack.frame);
        status = stack.frame.status;
        time.item_s[r] = stack.frame.stage_s[STAGE_FRAME] - stack.frame.stage_s[STAGE_SNAPSHOT];
        if (time.item_s[r] > 5) time.rounds = r + 1;
    }
    if (status == STATUS_OK) {
        bench_time_finish(&time);
        BenchRow row = bench_row_of(what, &time, "frames/s", 1);
        bench_add(all->bench, &row);
    }
    trial_scene_close(&stack.scene);
    return status;
}

Status bench_speed_crowd(Bench *bench)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    Crowds         all = {.bench = bench, .arena = arena_create()};
    LocalFrame     frame;
    double         times_s[2];
    Status         status = all.arena ? pool_create(&all.pool, bench_threads(bench)) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&all.landscape, times_s, &frame, 2000, 2000, all.pool);
    if (status == STATUS_OK) status = time_world(&all);
    if (status == STATUS_OK && bench_quick(bench))
        status = time_stack(&all, 40, 150, 0.5, "crowd: 40 tanks in 60 m, from 150 m, 160 x 108");
    if (status == STATUS_OK && !bench_quick(bench))
        status = time_stack(&all, 200, 150, 0.5, "crowd: 200 tanks in 60 m, from 150 m, 160 x 108");
    if (status == STATUS_OK && !bench_quick(bench))
        status = time_stack(&all, 1000, 150, 0.5, "crowd: 1000 tanks in 60 m, from 150 m, 160 x 108");
    if (status == STATUS_OK && !bench_quick(bench))
        status = time_stack(&all, 2000, 150, 0.5, "crowd: 2000 tanks in 60 m, from 150 m, 160 x 108");
    if (all.landscape.cover) landscape_destroy(&all.landscape);
    pool_destroy(all.pool);
    arena_destroy(all.arena);
    return status;
}
