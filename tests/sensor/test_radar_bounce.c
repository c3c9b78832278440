/* Echoes by way of the ground through the whole chain: where they lie in range and Doppler by geometry that the test
 * works out itself, what the ground mirrors, and the same bits for threads. labels: physics */
#include "tests/check.h"

#include "render/scattering/paths/ground_bounce.h"
#include "sensor/radar/seeker_radar.h"

static double away_m = 900; /* of the truck, north */

typedef struct Stage {
    Landscape      landscape;
    Catalog       *catalog;
    World          world;
    Pool          *pool;
    Arena         *arena;
    View           view;
    SnapshotEntity truck;
    NodePose       node[256];
    Snapshot       snapshot;
    char           catalog_path[4096];
} Stage;

static Stage stage;

static int open_stage(void **state)
{
    (void)state;
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 2000;
    config.horizon_m = 20000;
    config.relief_m = 0;
    if (!etc_path(stage.catalog_path, sizeof stage.catalog_path, "catalog.csv")) return -1;
    if (catalog_open(&stage.catalog, stage.catalog_path, 0.01) != STATUS_OK) return -1;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (world_open(&stage.world, stage.catalog, &stage.landscape, &frame, "avx2") != STATUS_OK) return -1;
    if (atmosphere_open(&stage.world.atmosphere, "us1976") != STATUS_OK) return -1;
    stage.arena = arena_create();
    return stage.arena && pool_create(&stage.pool, 2) == STATUS_OK ? 0 : -1;
}

static int close_stage(void **state)
{
    (void)state;
    pool_destroy(stage.pool);
    arena_destroy(stage.arena);
    world_close(&stage.world);
    landscape_destroy(&stage.landscape);
    catalog_close(stage.catalog);
    return 0;
}

/* A truck north of the origin, heading east, raised by some metres; the antenna over the origin looks at it. */
static RadarScene scene_of(double raised_m, double antenna_m, double p_truck[3], const Weather *weather)
{
    static const DisEntityType type = {1, 1, 225, 7, 1, 0, 0};
    const LocalFrame          *frame = &stage.world.frame;
    Origin                     origin;
    double                     ahead[3], right[3] = {1, 0, 0}, below[3];
    p_truck[0] = 0, p_truck[1] = away_m;
    p_truck[2] = elevation_height(&stage.landscape.elevation, 0, away_m, NULL) + raised_m;
    stage.truck =
        (SnapshotEntity){.id = {1, 1, 1}, .type = type, .model = catalog_find(stage.catalog, type, &origin, NULL)};
    const Model *model = catalog_model(stage.catalog, stage.truck.model);
    CHECK(model->node_count <= 256);
    model_pose(stage.node, model, NULL);
    ecef_from_enu(stage.truck.p_ecef, frame, p_truck);
    for (int i = 0; i < 3; i++) { /* forward east, right south, down */
        stage.truck.r_ecef_from_body[3 * i] = frame->r_ecef_from_enu[3 * i];
        stage.truck.r_ecef_from_body[3 * i + 1] = -frame->r_ecef_from_enu[3 * i + 1];
        stage.truck.r_ecef_from_body[3 * i + 2] = -frame->r_ecef_from_enu[3 * i + 2];
    }
    stage.snapshot =
        (Snapshot){.count = 1, .node_count = model->node_count, .entity = &stage.truck, .node = stage.node};
    stage.view = (View){.p_enu = {0, 0, elevation_height(&stage.landscape.elevation, 0, 0, NULL) + antenna_m},
                        .width = 64,
                        .height = 64,
                        .focal_px = 1000};
    v3_sub(ahead, p_truck, stage.view.p_enu);
    v3_normalize(ahead, ahead);
    v3_cross(below, ahead, right);
    for (int k = 0; k < 3; k++) {
        stage.view.r_enu_from_cam[3 * k] = right[k];
        stage.view.r_enu_from_cam[3 * k + 1] = below[k];
        stage.view.r_enu_from_cam[3 * k + 2] = ahead[k];
    }
    double to[3];
    v3_sub(to, p_truck, stage.view.p_enu);
    return (RadarScene){.world = &stage.world,
                        .snapshot = &stage.snapshot,
                        .view = &stage.view,
                        .hidden = -1,
                        .reference_m = v3_length(to),
                        .weather = weather,
                        .number = 1};
}

static SeekerRadar *open_radar(bool bounce)
{
    SeekerRadar            *radar;
    const SeekerRadarConfig config = {
        .preset = "search_ku", .catalog = stage.catalog_path, .isa = "avx2", .ground_bounce = bounce, .seed = 3};
    CHECK(seeker_radar_create(&radar, &config) == STATUS_OK);
    return radar;
}

/* Path of a leg, and how it grows, from places alone: the antenna's image in level ground. */
static void leg(double *length_m, double *rate_mps, const double p_truck[3], double ground_m, const double v[3],
                bool image)
{
    double a[3], far[2];
    for (int step = 0; step < 2; step++) {
        const double t_s = 1e-4 * (step - 0.5);
        for (int k = 0; k < 3; k++) a[k] = stage.view.p_enu[k] + v[k] * t_s;
        if (image) a[2] = 2 * ground_m - a[2];
        v3_sub(a, p_truck, a);
        far[step] = v3_length(a);
    }
    *length_m = 0.5 * (far[0] + far[1]);
    *rate_mps = (far[1] - far[0]) / 1e-4;
}

/* The map with ground bounce less that without is what the ground adds: its strongest cell lies where a path with
 * one or with
 * two reflections must, 7 and 14 rows from the direct one. */
static void the_bounce_is_where_it_must_be(void **state)
{
    (void)state;
    const Weather       weather = weather_default();
    double              p_truck[3];
    RadarScene          scene = scene_of(6, 20, p_truck, &weather);
    SeekerRadar        *with = open_radar(true), *without = open_radar(false);
    const double        ground_m = p_truck[2] - 6;
    static const double velocity[2][3] = {{0, 0, -300}, {20, 10, 250}};
    for (int i = 0; i < 2; i++) {
        const RadarFrame *on, *off;
        memcpy(scene.v_enu_mps, velocity[i], sizeof scene.v_enu_mps);
        arena_reset(stage.arena);
        CHECK(seeker_radar_measure(&on, with, &scene, stage.pool, stage.arena) == STATUS_OK);
        CHECK(seeker_radar_measure(&off, without, &scene, stage.pool, stage.arena) == STATUS_OK);
        CHECK(on->targets == 1 && off->targets == 1 && off->target[0].bounce.coherence == 0);
        CHECK(memcmp(on->target[0].rcs_m2, off->target[0].rcs_m2, sizeof on->target[0].rcs_m2) == 0);
        const RadarBounceTruth *bounce = &on->target[0].bounce;
        const int               rows = on->map.rows, columns = on->map.columns;
        double                  most = 0;
        int                     row = 0, column = 0;
        for (int y = 0; y < rows; y++)
            for (int x = 0; x < columns; x++) {
                const size_t at = (size_t)y * (size_t)columns + (size_t)x;
                const double power = cabs(on->map.cell[at] - off->map.cell[at]);
                if (power > most) most = power, row = y, column = x;
            }
        double length_m[2], rate_mps[2], nearest = INFINITY;
        for (int image = 0; image < 2; image++)
            leg(&length_m[image], &rate_mps[image], p_truck, ground_m, velocity[i], image);
        for (int times = 1; times <= 2; times++) {
            const double rate = times == 1 ? 0.5 * (rate_mps[0] + rate_mps[1]) : rate_mps[1];
            const double want = rows / 2 + (rate - on->reference_rate_mps) / on->map.mps_per_row;
            nearest = fmin(nearest, fabs(remainder(row - want, rows)));
        }
        const double direct = rows / 2 + (rate_mps[0] - on->reference_rate_mps) / on->map.mps_per_row;
        printf(
            "ground mirrors %.3f: once %.1f, twice %.1f, all %.1f, alone %.1f dBsm; strongest %.2f rows from where a reflection must "
            "be, %.1f from the direct path, %d columns from the middle\n",
            bounce->coherence, 10 * log10(bounce->once_m2[0]), 10 * log10(bounce->twice_m2[0]),
            10 * log10(bounce->rcs_m2[0]), 10 * log10(on->target[0].rcs_m2[0]), nearest,
            fabs(remainder(row - direct, rows)), column - columns / 2);
        CHECK(nearest < 1.1 && fabs(remainder(row - direct, rows)) > 5 && abs(column - columns / 2) <= 1);

        /* grass: loam of eps 8 - 2.9 j at 16.5 GHz, 20 mm */
        const double         sine = 26 / length_m[1], k = 2 * pi_rad * 16.5e9 / 299792458;
        const double complex eps =
            ground_surface(&(GroundRow){2, {10e9, 35e9}, {9.987, 5.496}, {2.775, 2.035}, 0, false}, 16.5e9).eps;
        const double complex q = csqrt(eps - (1 - sine * sine));
        CHECK_NEAR(bounce->coherence, cabs((sine - q) / (sine + q)) * exp(-2 * pow(k * 0.02 * sine, 2)), 0.01);
    }
    seeker_radar_destroy(with);
    seeker_radar_destroy(without);
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    double        p_truck[3];
    for (away_m = 600; landscape_surface(&stage.landscape, 0, away_m) != SURFACE_GRASS; away_m += 5)
        CHECK(away_m < 1500);
    RadarScene        scene = scene_of(0, 20, p_truck, &weather);
    SeekerRadar      *radar[2] = {open_radar(true), open_radar(true)};
    const RadarFrame *first, *other, *again;
    arena_reset(stage.arena);
    CHECK(seeker_radar_measure(&first, radar[0], &scene, stage.pool, stage.arena) == STATUS_OK);
    CHECK(seeker_radar_measure(&other, radar[1], &scene, NULL, stage.arena) == STATUS_OK);
    CHECK(seeker_radar_measure(&again, radar[0], &scene, NULL, stage.arena) == STATUS_OK); /* from what is kept */
    const size_t octets =
        interval_channels * (size_t)first->map.rows * (size_t)first->map.columns * sizeof *first->map.cell;
    CHECK(first->target[0].bounce.coherence > 0.1);
    CHECK(memcmp(first->map.cell, other->map.cell, octets) == 0 &&
          memcmp(first->map.cell, again->map.cell, octets) == 0);
    CHECK(memcmp(&first->target[0].bounce, &other->target[0].bounce, sizeof first->target[0].bounce) == 0);

    /* high above, the ground mirrors too little of it to be asked for */
    scene = scene_of(0, 700, p_truck, &weather);
    CHECK(seeker_radar_measure(&other, radar[0], &scene, NULL, stage.arena) == STATUS_OK);
    CHECK(other->targets == 1 && other->target[0].bounce.coherence == 0 && other->target[0].bounce.rcs_m2[0] == 0);
    seeker_radar_destroy(radar[0]);
    seeker_radar_destroy(radar[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bounce_is_where_it_must_be),
        cmocka_unit_test(threads_change_no_bit),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
