/* Scenery in the seeker's radar, whole chain: a wall over ground at the range, Doppler and level that an integral of
 * the test's own has; what stands behind it; a car that drives; what detections are of; and the same bits for threads,
 * skips, and where there is none. labels: physics */
#include "tests/sensor/seeker_ground.h"

#include "entities/shapes/mesh_builder.h"
#include "entities/shapes/parametric.h"
#include "sensor/radar/shot_scenery_private.h"

#include <stdlib.h>
#include <unistd.h>

static const double wall_wide_m = 9, wall_high_m = 5, deep_m = 8; /* of a house */
static const double concrete_re = 5.24, concrete_im = 0.3829, road_re = 4, road_im = 0.2, road_rms_m = 1e-3;

static struct {
    Scenery        scenery;
    SceneryObject  object[3];
    Model          model[2];
    SceneryMover   mover;
    double         path[2][3];
    SceneryTracer *tracer;
    double         foot[3]; /* middle of the wall's */
    SnapshotEntity tank;
    NodePose       node[256];
    char           folder[64], given[128]; /* one point of 20 dBsm stands for the tank */
} built;

enum { HOUSE, PARKED, DRIVING };

static Status build_house(Model *out)
{
    MeshBuilder *b = mesh_builder_create("house", 0.01);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "ground", -1, 0, 0, 0);
    mesh_part(b, 0, "wall", "concrete", HEAT_DWELLING);
    mesh_box(b, place_at(0, 0, 0), -0.5 * wall_wide_m, -0.5 * deep_m, -wall_high_m, 0.5 * wall_wide_m, 0.5 * deep_m, 1);
    mesh_part(b, 0, "rubble", "concrete", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), -0.5 * wall_wide_m, -0.5 * deep_m, -1, 0.5 * wall_wide_m, 0.5 * deep_m, 1);
    const Status status = mesh_builder_finish(out, b);
    if (status != STATUS_OK) return status;
    out->part[0].damage_hidden = 1 << 3; /* destroyed it is rubble, else walls */
    out->part[1].damage_hidden = 7;
    return STATUS_OK;
}

static void along_axis(double p[3], double away_m)
{
    p[0] = p[1] = away_m * sqrt(0.5);
    p[2] = elevation_height(&stage.landscape.elevation, p[0], p[1], NULL);
}

static int open_built(void **state)
{
    const int opened = open_stage(state);
    if (opened != 0) return opened;
    /* body x along the wall, y away from it: the wall of -y faces the antenna over the origin */
    const double level_m = sqrt(aim_m * aim_m - height_m * height_m), c = sqrt(0.5);
    built.scenery = (Scenery){.models = 2,
                              .objects = 3,
                              .movers = 1,
                              .paths = 2,
                              .model = built.model,
                              .object = built.object,
                              .mover = &built.mover,
                              .path_enu = built.path};
    if (build_house(&built.model[0]) != STATUS_OK || parametric_build(&built.model[1], "car", 0.02) != STATUS_OK)
        return -1;
    const double house[9] = {c, -c, 0, -c, -c,
                             0, 0,  0, -1}; /* columns: x to the south-east, y to the south-west, z down */
    for (int k = 0; k < 3; k++) {
        built.object[k] = (SceneryObject){.id = 71 + (uint64_t)k,
                                          .kind = k ? SCENERY_CLUTTER : SCENERY_BUILDINGS,
                                          .class = k ? CLUTTER_CAR : CLUTTER_NONE,
                                          .model = k > 0,
                                          .state = -1};
        memcpy(built.object[k].r_enu_from_body, house, sizeof house);
    }
    along_axis(built.foot, level_m);
    along_axis(built.object[HOUSE].p_enu, level_m + 0.5 * deep_m);
    built.object[HOUSE].p_enu[2] = built.foot[2];
    along_axis(built.object[PARKED].p_enu, level_m - 20);
    along_axis(built.path[0], level_m - 60);
    along_axis(built.path[1], level_m - 30);
    built.mover = (SceneryMover){.object = DRIVING, .count = 2, .speed_mps = 7, .phase_m = 10};
    scenery_pose(built.object[DRIVING].p_enu, built.object[DRIVING].r_enu_from_body, &built.scenery, &built.mover, 0);
    if (world_scenery(&stage.world, &built.scenery, NULL, stage.pool) != STATUS_OK) return -1;
    built.tracer = stage.world.scenery;
    strcpy(built.folder, "/tmp/pitviper_built_XXXXXX");
    if (!mkdtemp(built.folder)) return -1;
    for (int k = 0; k < 2; k++) {
        char path[128];
        snprintf(path, sizeof path, "%s/%s", built.folder, k ? "given.csv" : "point.csv");
        FILE *file = fopen(path, "w");
        if (!file) return -1;
        fputs(k ? "entity,signature\n*,point.csv\n" : "x_m,y_m,z_m,hh_dbsm,vv_dbsm\n0,0,-1,20,20\n", file);
        if (fclose(file) != 0) return -1;
        if (k) memcpy(built.given, path, sizeof path);
    }
    return 0;
}

static int close_built(void **state)
{
    stage.world.scenery = built.tracer;
    const int closed = close_stage(state);
    for (int k = 0; k < 2; k++) model_destroy(&built.model[k]);
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", built.folder);
    return system(command) == 0 ? closed : -1;
}

/* A radar whose walls are planes that mirror alone and whose ground is road, so that paper can follow. */
static SeekerRadar *radar_of(bool scenery, bool plain, bool ground)
{
    SeekerRadar            *radar;
    const SeekerRadarConfig config = {.preset = preset,
                                      .catalog = stage.catalog_path,
                                      .isa = "avx2",
                                      .ground = ground,
                                      .ground_bounce = true,
                                      .scenery = scenery,
                                      .seed = 3,
                                      .given = built.given};
    CHECK(seeker_radar_create(&radar, &config) == STATUS_OK);
    if (!plain) return radar;
    for (int i = 0; i < radar->facades.count; i++) {
        memset(radar->facades.row[i].scattered, 0, sizeof radar->facades.row[i].scattered);
        radar->facades.row[i].uneven_m = 0;
    }
    for (int s = 0; s < SURFACE_COUNT; s++) radar->mirror.row[s] = radar->mirror.row[SURFACE_ROAD];
    return radar;
}

static const RadarFrame *measure(SeekerRadar *radar, const RadarScene *scene, Pool *pool)
{
    const RadarFrame *frame;
    CHECK(seeker_radar_measure(&frame, radar, scene, pool, stage.arena) == STATUS_OK);
    return frame;
}

static double complex mirrored(double complex eps, double cosine)
{
    const double complex q = csqrt(eps - (1 - cosine * cosine));
    return (eps * cosine - q) / (eps * cosine + q); /* vertical polarisation: in the plane of incidence of both */
}

/* Cross section of wall and ground: an integral over the wall of exact paths, Fresnel's coefficients and Ament's
 * factors. */
static double dihedral_m2(const RadarScene *scene, double wall_rms_m)
{
    const double *e = scene->view->p_enu, lambda_m = light_mps / 35e9, k = 2 * pi_rad / lambda_m, step_m = 0.02;
    double        to[3], right[3] = {sqrt(0.5), -sqrt(0.5), 0};
    v3_sub(to, e, built.foot);
    const double   range_m = v3_length(to), sine = to[2] / range_m, cosine = sqrt(1 - sine * sine);
    double complex sum = 0;
    for (double x = -0.5 * wall_wide_m + 0.5 * step_m; x < 0.5 * wall_wide_m; x += step_m)
        for (double z = 0.5 * step_m; z < wall_high_m; z += step_m) {
            double p[3], d[3];
            v3_add_scaled(p, built.foot, x, right);
            p[2] += z;
            v3_sub(d, e, p);
            const double there_m = v3_length(d), image_m = sqrt(d[0] * d[0] + d[1] * d[1] + pow(to[2] + z, 2));
            sum += cexp(-I * k * (there_m + image_m - 2 * range_m)) * step_m * step_m;
        }
    const double complex both = mirrored(concrete_re - I * concrete_im, cosine) * mirrored(road_re - I * road_im, sine);
    const double         rough = exp(-2 * pow(k * wall_rms_m * cosine, 2) - 2 * pow(k * road_rms_m * sine, 2));
    print_message(
        "a house at %.0f m, %.1f degrees above: dihedral from afar %.1f dBsm, waves bent %.1f dB, materials %.1f dB\n",
        range_m, asin(sine) / rad_per_deg,
        10 * log10(16 * pi_rad * pow(wall_wide_m * wall_high_m * cosine / lambda_m, 2)),
        20 * log10(cabs(sum) / (wall_wide_m * wall_high_m)), 20 * log10(cabs(both) * rough));
    return 16 * pi_rad * pow(cabs(sum * both) * cosine * rough / lambda_m, 2);
}

static const double flying[3] = {120, 40, -10};

static void a_wall_flashes_at_its_foot(void **state)
{
    (void)state;
    const Weather    weather = weather_default();
    const RadarScene scene = scene_of(flying, 1, &weather);
    SeekerRadar     *radar = radar_of(true, true, false);
    double           to[3];
    arena_reset(stage.arena);
    const RadarFrame *f = measure(radar, &scene, stage.pool);
    const double      want_m2 = dihedral_m2(&scene, 0.5e-3);
    v3_sub(to, built.foot, stage.view.p_enu);
    const double range_m = v3_length(to), rate_mps = -v3_dot(to, flying) / range_m;
    CHECK(f->detections > 0);
    const Detection *d = &f->detection[0];
    print_message(
        "found at %+.2f m of the foot, %+.2f m/s of it, %.2f dBsm for %.2f; %d pieces, %d by the ground, %d hidden; "
        "share of scenery %.3f\n",
        d->range_m - range_m, d->range_rate_mps - rate_mps, 10 * log10(d->rcs_m2), 10 * log10(want_m2),
        f->scenery.pieces, f->scenery.by_ground, f->scenery.hidden, d->scenery.share);
    CHECK_NEAR(d->range_m, range_m, f->map.metre_per_column);
    CHECK_NEAR(d->range_rate_mps, rate_mps, f->map.mps_per_row);
    CHECK_NEAR(10 * log10(d->rcs_m2 / want_m2), 0, 1);
    CHECK(d->scenery.source > 0 && d->scenery.id == built.object[HOUSE].id && d->scenery.class == CLUTTER_NONE);
    CHECK(d->scenery.share > 0.9 && !d->moving && f->scenery.by_ground > 100);
    seeker_radar_destroy(radar);
}

/* ---- what stands behind it ----------------------------------------------------------------------- */

/* A tank on the axis, beyond_m behind the house's far wall. */
static void place_tank(RadarScene *scene, double beyond_m)
{
    static const DisEntityType type = {1, 1, 222, 1, 1, 1, 0};
    const LocalFrame          *frame = &stage.world.frame;
    Origin                     origin;
    double                     p[3];
    along_axis(p, v3_length((const double[3]){built.foot[0], built.foot[1], 0}) + deep_m + beyond_m);
    built.tank =
        (SnapshotEntity){.id = {1, 1, 1}, .type = type, .model = catalog_find(stage.catalog, type, &origin, NULL)};
    const Model *model = catalog_model(stage.catalog, built.tank.model);
    CHECK(model->node_count <= 256);
    model_pose(built.node, model, NULL);
    ecef_from_enu(built.tank.p_ecef, frame, p);
    for (int i = 0; i < 3; i++) { /* forward east, right south, down */
        built.tank.r_ecef_from_body[3 * i] = frame->r_ecef_from_enu[3 * i];
        built.tank.r_ecef_from_body[3 * i + 1] = -frame->r_ecef_from_enu[3 * i + 1];
        built.tank.r_ecef_from_body[3 * i + 2] = -frame->r_ecef_from_enu[3 * i + 2];
    }
    stage.snapshot = (Snapshot){.count = 1, .node_count = model->node_count, .entity = &built.tank, .node = built.node};
    scene->snapshot = &stage.snapshot;
}

/* Detections within some metres of a range. */
static int found_near(const RadarFrame *f, double range_m, int *of_scenery)
{
    int count = 0;
    for (int i = 0; i < f->detections; i++) {
        if (fabs(f->detection[i].range_m - range_m) > 4) continue;
        count++;
        *of_scenery += f->detection[i].scenery.source > 0;
    }
    return count;
}

static void a_house_hides_what_is_behind_it(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    RadarScene    scene = scene_of(flying, 1, &weather);
    SeekerRadar  *radar = radar_of(true, false, false), *silent = radar_of(false, false, true);
    int           told = 0;
    arena_reset(stage.arena);
    place_tank(&scene, 7);
    const RadarFrame *hidden = measure(radar, &scene, stage.pool), *quiet = measure(silent, &scene, stage.pool);
    stage.world.scenery = NULL;
    const RadarFrame *open = measure(radar, &scene, stage.pool);
    stage.world.scenery = built.tracer;
    CHECK(open->targets == 1 && hidden->targets == 1 && quiet->targets == 1);
    const double range_m = open->target[0].range_m;
    print_message(
        "tank behind a house: visible %.3f, %.3f without its echoes, %.3f in the open; found %d, %d, %d times; "
        "ground out of sight %d\n",
        hidden->target[0].visible, quiet->target[0].visible, open->target[0].visible,
        found_near(hidden, range_m, &told), found_near(quiet, range_m, &told), found_near(open, range_m, &told),
        quiet->ground_hidden);
    CHECK(open->target[0].visible > 0.95 && found_near(open, range_m, &told) > 0);
    told = 0;
    CHECK(hidden->target[0].visible == 0 && quiet->target[0].visible == 0);
    CHECK(found_near(hidden, range_m, &told) == 0);
    CHECK(quiet->ground_hidden > 500); /* level ground hides some 150 of itself */
    seeker_radar_destroy(radar);
    seeker_radar_destroy(silent);
}

/* A house that falls 5 s into the exercise returns as its walls, then as a metre of rubble; never as both. */
static void a_house_that_falls_is_rubble(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    RadarScene    scene = scene_of(flying, 1, &weather);
    SeekerRadar  *radar = radar_of(true, false, false);
    SceneryHarm   harm = {HOUSE, 5, 3};
    int           pieces[2];
    arena_reset(stage.arena);
    const int whole = measure(radar, &scene, stage.pool)->scenery.pieces;
    built.scenery.harm = &harm, built.scenery.harms = 1;
    CHECK(scenery_tracer_create(&stage.world.scenery, &built.scenery, "avx2") == STATUS_OK);
    for (int k = 0; k < 2; k++) {
        scene.t_s = 4 + 2 * k;
        pieces[k] = measure(radar, &scene, stage.pool)->scenery.pieces;
    }
    scenery_tracer_destroy(stage.world.scenery);
    stage.world.scenery = built.tracer;
    built.scenery.harm = NULL, built.scenery.harms = 0;
    print_message("%d pieces of a house, %d before it falls, %d after\n", whole, pieces[0], pieces[1]);
    CHECK(whole > 100 && pieces[0] == whole && pieces[1] > 0 && pieces[1] < whole);
    seeker_radar_destroy(radar);
}

/* ---- what drives and what stands ----------------------------------------------------------------- */

/* The driving car: its range rate, which is no ground's. Detections of both name them; none of the tank is of scenery.
 */
static void cars_are_told_apart(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    RadarScene    scene = scene_of(flying, 1, &weather);
    SeekerRadar  *radar = radar_of(true, false, true);
    double        p[3], r[9], to[3];
    int           driving = 0, parked = 0, house = 0, tank = 0;
    arena_reset(stage.arena);
    place_tank(&scene, 60);
    const RadarFrame *f = measure(radar, &scene, stage.pool);
    scenery_pose(p, r, &built.scenery, &built.mover, 0);
    v3_sub(to, p, stage.view.p_enu);
    const double range_m = v3_length(to), along = (to[0] * sqrt(0.5) + to[1] * sqrt(0.5)) / range_m;
    const double rate_mps = 7 * along - v3_dot(to, flying) / range_m;
    for (int i = 0; i < f->detections; i++) {
        const Detection *d = &f->detection[i];
        const uint64_t   id = d->scenery.source > 0 ? d->scenery.id : 0;
        house += id == built.object[HOUSE].id;
        parked += id == built.object[PARKED].id;
        if (fabs(d->range_m - f->target[0].range_m) < 4) tank += 1 + 1000 * (d->scenery.source > 0);
        if (id != built.object[DRIVING].id) continue;
        driving++;
        print_message("driving car: %+.2f m, %+.2f m/s of where it is, %.1f dBsm, share %.2f\n", d->range_m - range_m,
                      d->range_rate_mps - rate_mps, 10 * log10(d->rcs_m2), d->scenery.share);
        CHECK(fabs(d->range_m - range_m) < 3 && fabs(d->range_rate_mps - rate_mps) < 2 * f->map.mps_per_row &&
              d->moving);
        CHECK(d->scenery.class == CLUTTER_CAR && d->scenery.share > 0.5);
    }
    print_message("%d detections: house %d, parked car %d, driving %d, near the tank %d; %d of scenery\n",
                  f->detections, house, parked, driving, tank, f->scenery.detections);
    CHECK(driving > 0 && house > 0 && parked > 0 && tank > 0 && tank < 1000);
    CHECK(f->scenery.things == 2 && f->scenery.detections >= driving + house + parked);
    seeker_radar_destroy(radar);
}

/* ---- phases ------------------------------------------------------------------------------------------ */

/* What a wall scatters keeps its phases: from a millimetre nearer its map is the same, turned by 2 k times that. */
static void phases_stay_with_the_place(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0}, nearer_m = 1e-3;
    const Weather       weather = weather_default();
    SeekerRadar        *radar = radar_of(true, false, false);
    const double        k = 2 * pi_rad * 35e9 / light_mps;
    RadarScene          scene = scene_of(still, 1, &weather);
    View                there = stage.view;
    double complex      both = 0;
    double              power[2] = {0, 0};
    arena_reset(stage.arena);
    const RadarFrame *one = measure(radar, &scene, stage.pool);
    for (int c = 0; c < 3; c++) there.p_enu[c] += nearer_m * there.r_enu_from_cam[3 * c + 2];
    scene.view = &there;
    const RadarFrame *other = measure(radar, &scene, stage.pool);
    const double      noise_w = one->receiver.noise_w * one->map.noise_share;
    int               cells = 0;
    for (int i = 0; i < one->map.rows * one->map.columns; i++) { /* the window is about the same range of both */
        const double complex a = one->map.cell[i], b = other->map.cell[i];
        if (!(scatter_power(a) > 300 * noise_w)) continue;
        both += b * conj(a), power[0] += scatter_power(a), power[1] += scatter_power(b);
        cells++;
    }
    const double alike = cabs(both) / sqrt(power[0] * power[1]), turned = carg(both * cexp(-2 * I * k * nearer_m));
    print_message("%d cells of a house: %.4f alike from a millimetre nearer, phase %+.3f rad off 2 k d\n", cells, alike,
                  turned);
    CHECK(cells > 20 && alike > 0.99 && fabs(turned) < 0.05);
    seeker_radar_destroy(radar);
}

/* A beam that scans has the flash of the wall where it is: range, and the middle of the sector. */
static void a_scan_has_the_wall_where_it_is(void **state)
{
    (void)state;
    const Weather           weather = weather_default();
    const RadarScene        scene = scene_of(flying, 1, &weather);
    SeekerRadar            *radar;
    const SeekerRadarConfig config = {.preset = preset,
                                      .catalog = stage.catalog_path,
                                      .isa = "avx2",
                                      .scenery = true,
                                      .scan_rad = 0.2,
                                      .scan_step = 0.5,
                                      .seed = 3};
    double                  to[3];
    int                     at = 0;
    CHECK(seeker_radar_create(&radar, &config) == STATUS_OK);
    stage.snapshot = (Snapshot){0};
    arena_reset(stage.arena);
    const RadarFrame  *f = measure(radar, &scene, stage.pool);
    const RadarSector *scan = f->scan;
    for (int i = 0; i < scan->plan.positions * scan->columns; i++)
        if (scan->power_w[i] > scan->power_w[at]) at = i;
    v3_sub(to, built.foot, stage.view.p_enu);
    const double range_m = f->reference_m + (at % scan->columns - scan->columns / 2) * f->map.metre_per_column;
    print_message("scan of %d positions: brightest in %d, %.2f m beyond the wall's foot\n", scan->plan.positions,
                  at / scan->columns, range_m - v3_length(to));
    CHECK(abs(at / scan->columns - scan->plan.positions / 2) <= 1);
    CHECK(range_m - v3_length(to) > -4 && range_m - v3_length(to) < 9); /* wall, roof or parapet of the house */
    seeker_radar_destroy(radar);
}

/* ---- the same bits -------------------------------------------------------------------------------- */

static bool same_map(const RadarFrame *a, const RadarFrame *b)
{
    const size_t cells = (size_t)interval_channels * (size_t)a->map.rows * (size_t)a->map.columns;
    return memcmp(a->map.cell, b->map.cell, cells * sizeof *a->map.cell) == 0;
}

static void the_same_bits(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    RadarScene    scene = scene_of(flying, 1, &weather);
    SeekerRadar  *with = radar_of(true, false, true), *without = radar_of(false, false, true);
    arena_reset(stage.arena);
    const RadarFrame *two = measure(with, &scene, stage.pool), *one = measure(with, &scene, NULL);
    CHECK(same_map(two, one) && two->scenery.pieces == one->scenery.pieces);
    /* turned so that the house is at the edge: some of its faces are out of the beam */
    RadarScene   aside = scene;
    View         turned = stage.view;
    const double c = cos(0.084), s = sin(0.084);
    for (int k = 0; k < 3; k++) {
        const double right = stage.view.r_enu_from_cam[3 * k], ahead = stage.view.r_enu_from_cam[3 * k + 2];
        turned.r_enu_from_cam[3 * k] = c * right - s * ahead;
        turned.r_enu_from_cam[3 * k + 2] = c * ahead + s * right;
    }
    aside.view = &turned;
    const RadarFrame *skipped = measure(with, &aside, stage.pool);
    aside.skips_off = skips_all_off;
    const RadarFrame *all = measure(with, &aside, stage.pool);
    print_message(
        "%d pieces, %d hidden, %d by the ground, %d things; at the beam's edge %d triangles skipped, %d without skips\n",
        two->scenery.pieces, two->scenery.hidden, two->scenery.by_ground, two->scenery.things, skipped->scenery.skipped,
        all->scenery.skipped);
    CHECK(same_map(skipped, all) && all->scenery.skipped == 0 && skipped->scenery.skipped > 0);
    stage.world.scenery = NULL;
    const RadarFrame *none = measure(with, &scene, stage.pool), *off = measure(without, &scene, stage.pool);
    stage.world.scenery = built.tracer;
    CHECK(same_map(none, off) && none->scenery.pieces == 0 && none->sources == 0);
    CHECK(!same_map(none, two));
    seeker_radar_destroy(with);
    seeker_radar_destroy(without);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_wall_flashes_at_its_foot),
        cmocka_unit_test(a_house_hides_what_is_behind_it),
        cmocka_unit_test(a_house_that_falls_is_rubble),
        cmocka_unit_test(cars_are_told_apart),
        cmocka_unit_test(phases_stay_with_the_place),
        cmocka_unit_test(a_scan_has_the_wall_where_it_is),
        cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, open_built, close_built);
}
