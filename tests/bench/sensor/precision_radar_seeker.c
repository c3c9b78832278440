/* tests/bench/sensor/precision_radar_seeker.c: what a seeker's radar saves, and loses, where a target has fewer echoes
 * than scattering centres (sensor/radar/shot_targets.c), and where echoes far off the axis are left out. */
#include "tests/bench/sensor/precision.h"

#include "tests/bench/sensor/radar_update.h"
#include "terrain/ground/landscape.h"

enum { tanks = 12 };
static const DisEntityType tank_type = {1, 1, 222, 1, 1, 1, 0};

/* Root of the power by which the maps differ, over that of the map, %. */
static double apart(const RadarFrame *got, const RadarFrame *want)
{
    const size_t cells = (size_t)interval_channels * (size_t)want->map.rows * (size_t)want->map.columns;
    double       off = 0, power = 0;
    for (size_t i = 0; i < cells; i++) {
        off += scatter_power(got->map.cell[i] - want->map.cell[i]);
        power += scatter_power(want->map.cell[i]);
    }
    return 100 * sqrt(off / power);
}

/* Tanks, or ground alone, with and without what is saved. */
static Status compare(Bench *bench, TrialScene *scene, SeekerRadar *radar, Arena *const arena[3], bool ground)
{
    enum { settings = 2 };
    const Weather weather = weather_default();
    Snapshot      snapshot;
    RadarUpdate   way[settings];
    BenchWork     work[settings];
    char          name[settings][64];
    BenchSetting  point[settings];
    Status        status = STATUS_OK;
    for (int i = 0; i < tanks && status == STATUS_OK && !ground; i++)
        status = trial_scene_place(scene, &(TrialPlace){.type = tank_type,
                                                        .number = 100 + i,
                                                        .east_m = 20 * (i % 4) - 30,
                                                        .north_m = 25 * (i / 4),
                                                        .turn_rad = 0.6});
    if (status == STATUS_OK) status = entity_table_snapshot(&snapshot, scene->table, scene->sun_now_s + 0.5, arena[2]);
    const View view = trial_view(scene, ground ? 2500 : 4000, 400, 3 * rad_per_deg, 64, 64);
    if (ground) snapshot.count = 0;
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        way[k] = (RadarUpdate){.radar = radar,
                               .arena = arena[k],
                               .scene = {.world = &scene->world,
                                         .snapshot = &snapshot,
                                         .view = &view,
                                         .hidden = -1,
                                         .v_enu_mps = {0, 200, -20},
                                         .reference_m = NAN,
                                         .t_s = 1,
                                         .weather = &weather,
                                         .number = 1,
                                         .apart = k == 0,
                                         .reach = ground && k == 0 ? 2.5 : 1}};
        radar_update(&way[k]);
        status = way[k].status;
        work[k] = (BenchWork){radar_update, &way[k], 1};
    }
    if (status != STATUS_OK) return status;
    for (int k = 0; k < settings; k++) {
        const RadarFrame *f = way[k].frame;
        if (ground)
            snprintf(name[k], sizeof name[k], k ? "to the main lobe's null: %d" : "2.5 times as far: %d scatterers",
                     f->ground_cells);
        else snprintf(name[k], sizeof name[k], k ? "%d echoes" : "each centre: %d echoes", f->echoes);
        point[k] = (BenchSetting){
            .setting = name[k], .error = k ? apart(way[1].frame, way[0].frame) : 0, .is_default = k == 1};
    }
    const BenchTunable tunable[2] = {
        {"echoes of targets hardly resolved", "sensor/radar/shot_targets.c",
         "search_ku, twelve tanks 4 km away, no ground", "%", "map of four channels, of each centre's own", 2},
        {"ground off a radar's axis", "sensor/radar/shot_ground.c", "seeker_35, open ground 2.5 km away", "%",
         "map of four channels, of ground 2.5 times as far off the axis", 5}};
    bench_tunable(bench, &tunable[ground], work, point, settings);
    return STATUS_OK;
}

Status precision_radar_seeker(Bench *bench)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    LocalFrame     frame;
    Landscape      landscape = {0};
    TrialScene     scene = {0};
    SeekerRadar   *radar[2] = {NULL, NULL};
    Arena         *arena[3] = {arena_create(), arena_create(), arena_create()};
    char           catalog[4096];
    double         times_s[2];
    Pool          *pool = NULL;
    Status         status = arena[0] && arena[1] && arena[2] ? STATUS_OK : STATUS_NO_MEMORY;
    bench_progress(bench, "what a seeker's radar leaves out");
    if (status == STATUS_OK) status = pool_create(&pool, bench_threads(bench));
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = landscape_quick(&landscape, times_s, &frame, 6000, 6000, pool);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = trial_scene_open(&scene, &landscape, catalog, &tank_type, 1, 0);
    for (int ground = 0; ground < 2 && status == STATUS_OK; ground++) {
        status = seeker_radar_create(&radar[ground], &(SeekerRadarConfig){.preset = ground ? "seeker_35" : "search_ku",
                                                                          .catalog = catalog,
                                                                          .ground = ground,
                                                                          .warp_m = 1e-3,
                                                                          .seed = 1});
        if (status == STATUS_OK) status = compare(bench, &scene, radar[ground], arena, ground);
        seeker_radar_destroy(radar[ground]);
    }
    trial_scene_close(&scene);
    landscape_destroy(&landscape);
    for (int k = 0; k < 3; k++) arena_destroy(arena[k]);
    pool_destroy(pool);
    return status;
}
