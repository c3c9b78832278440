/* tests/bench/sensor/speed_heat.c: what the ground's heat costs: spin-up, steps, shadows, hits, and a frame with it. */
#include "tests/bench/sensor/speed_private.h"

#include "render/frame/world.h"
#include "sensor/settings/config.h"
#include "terrain/weather/weather.h"

/* ---- the state --------------------------------------------------------------------------------- */

static Status warm(World *world, double unix_s, Pool *pool)
{
    const Config        config = config_default();
    HeatConfig          heat = heat_default_config();
    WeatherCourseConfig about = {weather_default(), config.weather.air_range_k, world->frame.origin.lon_rad,
                                 world->frame.origin.lat_rad};
    WeatherCourse      *course;
    about.base.air_temp_k = atmosphere_temp_k(world->atmosphere, 0);
    heat.step_s = config.heat.step_s, heat.facets = config.heat.facets, heat.unix_s = unix_s;
    const Status status = weather_course_open(&course, "clear", &about);
    return status == STATUS_OK ? world_warm(world, course, &heat, 0, pool) : status;
}

/* Steps on the thread of the first pool: the world keeps it. */
static Status time_state(Speed *s)
{
    World       *world = &s->scene.world;
    const double begun_s = wall_clock_s(), unix_s = s->scene.unix_s;
    HeatNow     *now;
    int          steps;
    Status       status = warm(world, unix_s, s->one);
    if (status != STATUS_OK) return status;
    BenchRow row = bench_row("heat of the ground: spin-up, 1 thread");
    row.median = row.best = wall_clock_s() - begun_s;
    row.unit = "s";
    bench_add(s->bench, &row);
    const int count = bench_quick(s->bench) ? 12 : 144;
    arena_reset(s->arena[2]);
    status = heat_now(&now, world->heat, unix_s + 600.0 * count, s->arena[2]);
    row = bench_row("heat of the ground: a step of its grid, 1 thread");
    row.median = heat_spent_s(world->heat, &steps) / fmax(steps, 1);
    row.unit = "s";
    row.rate = 1e-6 * (double)heat_bytes(world->heat), row.rate_unit = "MB";
    bench_add(s->bench, &row);
    return status;
}

/* ---- shadows ------------------------------------------------------------------------------------ */

typedef struct Cast {
    const Elevation *elevation;
    float            d_enu[3][shadow_most_slots];
    int              slots;
    Pool            *pool;
    ShadowMap       *map;
    Status           status;
} Cast;

static void cast(void *user)
{
    Cast *c = user;
    heat_shadow_destroy(c->map);
    c->map = NULL;
    c->status = heat_shadow_create(
        &c->map,
        &(ShadowOf){
            .elevation = c->elevation, .cell_m = config_default().heat.shadow_m, .slots = c->slots, .d_enu = c->d_enu},
        c->pool);
    bench_keep(c->map);
}

static Status time_shadows(Speed *s)
{
    static Cast many, one;
    BenchTime   time[2];
    many = (Cast){.elevation = &s->landscape.elevation, .pool = s->many};
    many.slots = heat_slots(many.d_enu, s->scene.world.heat);
    one = many;
    one.pool = s->one;
    const BenchWork work[2] = {{cast, &many, 1}, {cast, &one, 1}};
    bench_progress(s->bench, "shadows of a day");
    bench_time(time, s->bench, work, 2);
    const Status status = many.status != STATUS_OK ? many.status : one.status;
    if (status == STATUS_OK) {
        double  different = 0, open[2];
        uint8_t shadow[2][shadow_most_slots] = {{0}};
        for (int i = 0; i < 2000; i++) {
            const double x_m = s->east_m * (random_uniform(29, 0, 0, (uint64_t)i) - 0.5),
                         y_m = s->north_m * (random_uniform(29, 1, 0, (uint64_t)i) - 0.5);
            heat_shadow_at(shadow[0], &open[0], many.map, x_m, y_m);
            heat_shadow_at(shadow[1], &open[1], one.map, x_m, y_m);
            different += memcmp(shadow[0], shadow[1], (size_t)many.slots) != 0 || open[0] != open[1];
        }
        char     against[96];
        BenchRow row = bench_row_of("heat of the ground: shadows of a day, 1 thread", &time[1], NULL, 1);
        row.rate = 1e-6 * (double)heat_shadow_bytes(one.map), row.rate_unit = "MB";
        row.ratio = bench_ratio(&time[1], &time[0]), row.to = all_threads;
        row.error = different, row.error_limit = 0, row.error_unit = "places differ";
        snprintf(against, sizeof against, "all threads; %.0f x %.0f km, cells of %.0f m", 1e-3 * s->east_m,
                 1e-3 * s->north_m, heat_shadow_cell_m(one.map));
        row.against = against;
        bench_add(s->bench, &row);
    }
    heat_shadow_destroy(one.map);
    s->scene.world.shadow = many.map; /* closed with the world */
    return status;
}

/* ---- hits --------------------------------------------------------------------------------------- */

enum { heat_hits = 4096 };

typedef struct HitSet {
    HeatScene scene;
    double    p_enu[heat_hits][3], n_enu[heat_hits][3], temp_k[heat_hits];
    int       surface[heat_hits];
} HitSet;

static void ask_ground(void *user)
{
    HitSet *s = user;
    for (int i = 0; i < heat_hits; i++) {
        double lifted_k;
        s->temp_k[i] = heat_scene_ground_k(&lifted_k, &s->scene, s->surface[i], s->p_enu[i], s->n_enu[i], 1);
    }
    bench_keep(s->temp_k);
}

static void fill_hits(HitSet *s, const HeatNow *now, const ShadowMap *shadow, const Landscape *landscape,
                      const double half_m[2])
{
    s->scene = (HeatScene){.now = now, .shadow = shadow};
    for (int i = 0; i < heat_hits; i++) { /* neighbours, as pixels of a row are */
        const double at_x = random_uniform(31, 0, 0, (uint64_t)(i / 64)),
                     at_y = random_uniform(31, 1, 0, (uint64_t)(i / 64));
        s->p_enu[i][0] = half_m[0] * (1.9 * at_x - 0.95) + i % 64, s->p_enu[i][1] = half_m[1] * (1.9 * at_y - 0.95);
        s->p_enu[i][2] = 0;
        const double n[3] = {0.3 * (random_uniform(31, 2, 0, (uint64_t)i) - 0.5),
                             0.3 * (random_uniform(31, 3, 0, (uint64_t)i) - 0.5), 1};
        v3_normalize(s->n_enu[i], n);
        s->surface[i] = landscape_surface(landscape, s->p_enu[i][0], s->p_enu[i][1]);
    }
}

static Status time_hits(Speed *s, const HeatNow *now)
{
    static HitSet set[2];
    BenchTime     time[2];
    double        bad = 0;
    const double  half_m[2] = {0.5 * s->east_m, 0.5 * s->north_m};
    fill_hits(&set[0], now, s->scene.world.shadow, &s->landscape, half_m);
    fill_hits(&set[1], now, NULL, &s->landscape, half_m);
    const BenchWork work[2] = {{ask_ground, &set[0], heat_hits}, {ask_ground, &set[1], heat_hits}};
    bench_time(time, s->bench, work, 2);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < heat_hits; i++) bad += !(set[k].temp_k[i] > 200 && set[k].temp_k[i] < 400);
    BenchRow row = bench_row_of("heat of the ground: a hit, with shadows", &time[0], "M hits/s", 1e6);
    row.ratio = bench_ratio(&time[0], &time[1]), row.to = "without";
    row.error = bad, row.error_limit = 0, row.error_unit = "hits", row.against = "200 .. 400 K";
    bench_add(s->bench, &row);
    row = bench_row_of("heat of the ground: a hit, without shadows", &time[1], "M hits/s", 1e6);
    bench_add(s->bench, &row);
    return STATUS_OK;
}

/* ---- frames ------------------------------------------------------------------------------------- */

typedef struct HeatFrame {
    const TrialFrame *of;
    Air               air;
    HeatScene         scene;
    Pool             *pool;
    Arena            *arena;
    Picture           picture;
    Status            status;
} HeatFrame;

static void render_heat(void *user)
{
    HeatFrame *f = user;
    arena_reset(f->arena);
    f->status =
        render(&f->picture, &f->of->scene->world, &f->of->snapshot, &f->of->request, &f->air, f->pool, f->arena);
}

/* Times rendering alone, from 100 m up, with the same snapshot and air: with the ground as warm as the air, with its
 * heat, and with its shadows. */
static Status time_frames(Speed *s, const HeatNow *now)
{
    static HeatFrame         frame[3];
    static const char *const name[3] = {"as the air", "no shadows", "with shadows"};
    const View               view = trial_view(&s->scene, 600, 100, 40 * rad_per_deg, s->width, s->height);
    const RenderRequest      request = speed_request(&view, three_bands, true);
    TrialFrame               base = speed_frame(s, &s->scene, &request, false);
    BenchWork                work[3];
    BenchTime                time[3];
    char                     what[what_size];
    trial_frame(&base);
    if (base.status != STATUS_OK) return base.status;
    for (int k = 0; k < 3; k++) {
        frame[k] = (HeatFrame){.of = &base,
                               .air = base.air,
                               .scene = {now, k == 2 ? s->scene.world.shadow : NULL, NULL},
                               .pool = s->one,
                               .arena = s->arena[0]};
        frame[k].air.heat = k > 0 ? &frame[k].scene : NULL;
        work[k] = (BenchWork){render_heat, &frame[k], 1};
    }
    bench_progress(s->bench, "frames with the ground's heat");
    bench_time(time, s->bench, work, 3);
    for (int k = 0; k < 3; k++) {
        if (frame[k].status != STATUS_OK) return frame[k].status;
        snprintf(what, sizeof what, "heat of the ground: 100 m up, 1 thread: %s", name[k]);
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        if (k > 0) row.ratio = bench_ratio(&time[k], &time[k - 1]), row.to = name[k - 1];
        bench_add(s->bench, &row);
    }
    return STATUS_OK;
}

/* ---- vehicles ----------------------------------------------------------------------------------- */

enum { vehicle_rounds = 5 };

/* Measures what the longest 0.1 s and the mean one cost, over a minute in which all of the scene's vehicles appear at
 * once, stand, and after half of it turn round; and the seconds until all are warm. Their models are known. */
static Status time_vehicle_minute(double out_s[3], size_t *bytes, const TrialScene *scene, Snapshot snapshot)
{
    WorldVehicles *v = NULL;
    const Snapshot none = {0};
    Status         status = world_vehicles_create(
                &v, &scene->world,
                &(WorldVehiclesConfig){.step_s = config_default().heat.vehicle_step_s, .window_us = vehicle_window_us});
    if (status == STATUS_OK) status = world_vehicles_tick(v, &none);
    double spent_s = 0;
    out_s[0] = out_s[2] = 0;
    for (int k = 1; k <= 600 && status == STATUS_OK; k++) {
        snapshot.t_s = k / 10.0;
        for (int i = 0; k == 300 && i < snapshot.count; i++)
            for (int m = 0; m < 9; m++) snapshot.entity[i].r_ecef_from_body[m] *= m % 3 < 2 ? -1 : 1;
        const double before_s = vehicle_heat_counters(world_vehicles_heat(v))->spent_s;
        status = world_vehicles_tick(v, &snapshot);
        const VehicleHeatCounters *counters = vehicle_heat_counters(world_vehicles_heat(v));
        out_s[0] = fmax(out_s[0], counters->spent_s - before_s);
        if (counters->begun < (uint64_t)snapshot.count) out_s[2] = snapshot.t_s;
        spent_s = counters->spent_s;
    }
    out_s[1] = spent_s / 600;
    *bytes = v ? vehicle_heat_bytes(world_vehicles_heat(v)) : 0;
    world_vehicles_destroy(v);
    return status;
}

static Status time_vehicles(Speed *s)
{
    double   longest_s = INFINITY, mean_s = INFINITY, warm_s = 0;
    size_t   bytes = 0;
    Snapshot snapshot;
    arena_reset(s->arena[2]);
    Status status = entity_table_snapshot(&snapshot, s->scene.table, s->scene.sun_now_s + 0.5, s->arena[2]);
    bench_progress(s->bench, "heat of vehicles");
    for (int round = 0; round < vehicle_rounds && status == STATUS_OK; round++) {
        double out_s[3];
        status = time_vehicle_minute(out_s, &bytes, &s->scene, snapshot);
        if (status != STATUS_OK) return status;
        longest_s = fmin(longest_s, out_s[0]), mean_s = fmin(mean_s, out_s[1]), warm_s = out_s[2];
    }
    BenchRow row = bench_row("heat of the vehicles: the longest 0.1 s of a minute");
    row.median = row.best = longest_s, row.unit = "s";
    row.rate = 1e-6 * (double)bytes, row.rate_unit = "MB";
    row.error = warm_s, row.error_unit = "s", row.against = "until all are warm";
    bench_add(s->bench, &row);
    row = bench_row("heat of the vehicles: the mean 0.1 s of that minute");
    row.median = row.best = mean_s, row.unit = "s";
    bench_add(s->bench, &row);
    return status;
}

Status speed_heat(Speed *s)
{
    HeatNow *now = NULL;
    Arena   *arena = arena_create();
    bench_progress(s->bench, "heat of the ground");
    Status status = arena ? time_state(s) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = time_shadows(s);
    if (status == STATUS_OK) status = heat_now(&now, s->scene.world.heat, s->scene.unix_s, arena);
    if (status == STATUS_OK) status = time_hits(s, now);
    if (status == STATUS_OK) status = time_frames(s, now);
    if (status == STATUS_OK) status = time_vehicles(s);
    arena_destroy(arena);
    return status;
}
