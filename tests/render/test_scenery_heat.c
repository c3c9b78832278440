/* Temperatures of scenery in frames: walls of a turned house against its construction by itself, normals between
 * facets, the same whatever frames were made; clutter by what it does, and at what cost. labels: physics */
#include "tests/render/hand_models.h"
#include "tests/scenes/paper_day.h"

#include "entities/catalog/catalog.h"
#include "render/heat/scenery_heat.h"
#include "render/heat/scenery_heat_private.h"

typedef struct Lab {
    Materials         materials;
    GroundKinds       kinds;
    Constructions     constructions;
    PartTable         parts;
    LocalFrame        frame;
    Arena            *arena;
    SceneryHeatConfig config;
} Lab;
static Lab lab;

static int open_lab(void **state)
{
    static const char *const file[] = {"materials.csv",           "surfaces.csv", "constructions.csv",
                                       "construction_layers.csv", "heat.csv",     "heat_machines.csv"};
    char                     path[6][512];
    (void)state;
    for (int k = 0; k < 6; k++)
        if (!etc_path(path[k], sizeof path[k], file[k])) return -1;
    paper_kinds(&lab.kinds);
    lab.arena = arena_create();
    lab.config = scenery_heat_default_config();
    lab.config.heat.unix_s = paper_unix_s + 3600 * 6, lab.config.heat.weather = paper_weather;
    lab.config.heat.user = &paper_summer;
    lab.config.ground = &lab.kinds, lab.config.constructions = &lab.constructions;
    lab.config.materials = &lab.materials, lab.config.parts = &lab.parts, lab.config.frame = &lab.frame;
    lab.config.isa = "avx2";
    return materials_open(&lab.materials, path[0], path[1], NULL) == STATUS_OK &&
                   constructions_open(&lab.constructions, path[2], path[3]) == STATUS_OK &&
                   part_table_open(&lab.parts, path[4], path[5]) == STATUS_OK &&
                   local_frame_at(&lab.frame, &(Geodetic){0.785, 0, 100}) == STATUS_OK && lab.arena
               ? 0
               : -1;
}

static int close_lab(void **state)
{
    (void)state;
    materials_close(&lab.materials);
    arena_destroy(lab.arena);
    return 0;
}

/* Temperatures h hours after midnight. */
static const SceneryTemps *at(SceneryHeat *heat, double h)
{
    SceneryTemps *t;
    CHECK(scenery_temps_at(&t, heat, paper_unix_s + 3600 * h, lab.arena) == STATUS_OK);
    return t;
}

/* ---- buildings ------------------------------------------------------------------------------- */

typedef struct House {
    Model         model;
    SceneryObject object;
    Scenery       scenery;
} House;

/* A box of walls below a box of roof, turned clockwise from north. */
static void build_house(House *h, double heading_rad)
{
    const double c = cos(heading_rad), n = sin(heading_rad);
    hand_model(&h->model, 2, 16, 24);
    hand_box_into(&h->model, 0, (const double[3]){-5, -4, -3}, (const double[3]){5, 4, 0});
    hand_box_into(&h->model, 1, (const double[3]){-5, -4, -3.4}, (const double[3]){5, 4, -3});
    strcpy(h->model.part[0].name, "wall"), strcpy(h->model.part[0].material, "brick_red");
    strcpy(h->model.part[1].name, "roof"), strcpy(h->model.part[1].material, "asphalt_road");
    h->model.part[0].role = HEAT_DWELLING;
    h->object =
        (SceneryObject){.kind = SCENERY_BUILDINGS, .state = -1, .r_enu_from_body = {n, c, 0, c, -n, 0, 0, 0, -1}};
    h->scenery = (Scenery){.models = 1, .objects = 1, .model = &h->model, .object = &h->object};
}

static SceneryHeat *open_heat(const Scenery *scenery, const SceneryHeatConfig *config)
{
    SceneryHeat *h;
    CHECK(scenery_heat_create(&h, config, scenery) == STATUS_OK);
    return h;
}

static SceneryHeat *wall_alone(const char *construction, const char *material, int facets)
{
    SceneryHeatConfig c = lab.config;
    SceneryHeat      *h;
    c.heat.facets = facets;
    CHECK(scenery_heat_wall(&h, &c, constructions_named(&lab.constructions, construction),
                            materials_find(&lab.materials, material)) == STATUS_OK);
    return h;
}

static const double here[3] = {5, 0, -1};

static double alone_k(SceneryHeat *alone, double h, const double n_enu[3])
{
    WallSeen seen;
    scenery_wall_seen(&seen, at(alone, h), n_enu, 0);
    return seen.temp_k;
}

/* The faces of a house that looks to the north-north-east are those of its construction, whichever other faces it has.
 */
static void a_turned_house_has_its_own_normals(void **state)
{
    (void)state;
    const double turn = 22 * rad_per_deg;
    House        h;
    build_house(&h, turn);
    SceneryHeat *heat = open_heat(&h.scenery, &lab.config);
    SceneryHeat *alone = wall_alone("wall_brick_cavity", "brick_red", lab.config.heat.facets);
    SceneryHeat *felt = wall_alone("roof_tile", "asphalt_road", lab.config.heat.facets);
    for (double hour = 7; hour < 30; hour += 3.3) {
        const SceneryTemps *now = at(heat, hour);
        for (int k = 0; k < 4; k++) {
            const double n[3] = {sin(turn + k * pi_rad / 2), cos(turn + k * pi_rad / 2), 0};
            CHECK_NEAR(scenery_temp_k(now, 0, 0, here, n), alone_k(alone, hour, n), 1e-4);
        }
        const double up[3] = {0, 0, 1}, down[3] = {0.6, 0, -0.8}, east[3] = {1, 0, 0}, below[3] = {0, 0, -1};
        CHECK_NEAR(scenery_temp_k(now, 0, 1, here, up), alone_k(felt, hour, up), 1e-4);
        /* what faces down has no more sun than the wall of that side */
        CHECK(scenery_temp_k(now, 0, 0, here, down) < scenery_temp_k(now, 0, 0, here, east) + 1e-3);
        CHECK(scenery_temp_k(now, 0, 0, here, down) > scenery_temp_k(now, 0, 0, here, below) - 2);
        WallSeen shade;
        scenery_wall_seen(&shade, at(alone, hour), east, 1);
        CHECK_NEAR(scenery_temp_k(now, 0, 0, here, below), shade.temp_k, 1e-4);
        CHECK(scenery_temp_k(now, 0, 7, here, up) == now->air_k); /* no such part */
    }
    scenery_heat_destroy(heat), scenery_heat_destroy(alone), scenery_heat_destroy(felt);
    model_destroy(&h.model);
    arena_reset(lab.arena);
}

/* A clear day: the east is warmest in the morning, the west in the afternoon, the north never; a sheet swings more than
 * a brick wall and is coldest at night. */
static void walls_follow_the_sun(void **state)
{
    (void)state;
    static const double n[4][3] = {{0, 1, 0}, {1, 0, 0}, {0, -1, 0}, {-1, 0, 0}};
    SceneryHeat        *brick = wall_alone("wall_brick_cavity", "brick_red", 17),
                *sheet = wall_alone("roof_sheet", "metal_steel_galvanized", 17);
    for (int k = 1; k < 4; k++) {
        CHECK(alone_k(brick, 9, n[1]) > alone_k(brick, 9, n[k == 1 ? 0 : k]) + 3);
        CHECK(alone_k(brick, 17.5, n[3]) > alone_k(brick, 17.5, n[3 - k]) + 3);
    }
    const double up[3] = {0, 0, 1}, sheet_k = alone_k(sheet, 13, up), night_k = alone_k(sheet, 27, up);
    WallSeen     seen;
    scenery_wall_seen(&seen, at(sheet, 27), up, 0);
    print_message("roof of sheet: %.1f K at 13 h, %.1f K at 27 h, in air of %.1f K\n", sheet_k, night_k, seen.air_k);
    CHECK(sheet_k > 315 && night_k < seen.air_k - 1); /* its sky is colder than the air */
    scenery_heat_destroy(brick), scenery_heat_destroy(sheet);
    arena_reset(lab.arena);
}

/* Normals that 33 facets have and the usual 17 have not: walls, roofs of at most 60 degrees, and what is steeper. The
 * largest errors are where sunlight grazes: 33 K per unit of its cosine of sheet, whose
 * kink lies up to a quarter of two facets' 0.12 from their straight line, along both axes: 2 K, but for the memory of
 * it. */
static void facets_are_close(void **state)
{
    (void)state;
    static const char *const of[][2] = {{"wall_brick_cavity", "brick_red"},
                                        {"wall_sheet", "metal_steel_galvanized"},
                                        {"roof_tile_insulated", "brick_red"}};
    for (int k = 0; k < 3; k++) {
        SceneryHeat *fine = wall_alone(of[k][0], of[k][1], 33), *usual = wall_alone(of[k][0], of[k][1], 17);
        double       sum[3] = {0}, worst_k[3] = {0}, rms_k[3];
        int          count[3] = {0};
        for (double hour = 8; hour < 20; hour += 2)
            for (int c = 0; c < 33 * 33; c++) {
                double n[3];
                heat_facet_normal(n, c % 33, c / 33, 33);
                const double miss = alone_k(usual, hour, n) - alone_k(fine, hour, n);
                const int    sort = n[2] == 0 ? 0 : n[2] >= 0.5 ? 1 : 2;
                sum[sort] += miss * miss, worst_k[sort] = fmax(worst_k[sort], fabs(miss)), count[sort]++;
            }
        for (int i = 0; i < 3; i++) rms_k[i] = sqrt(sum[i] / count[i]);
        print_message("%s: between facets: walls %.2f K rms, %.2f K at most; roofs %.2f, %.2f; steeper %.2f, %.2f\n",
                      of[k][0], rms_k[0], worst_k[0], rms_k[1], worst_k[1], rms_k[2], worst_k[2]);
        CHECK(rms_k[0] < 0.1 && rms_k[1] < 0.2 && rms_k[2] < 0.25);
        CHECK(worst_k[0] < 0.6 && worst_k[1] < 1.4 && worst_k[2] < 1.5);
        scenery_heat_destroy(fine), scenery_heat_destroy(usual);
        arena_reset(lab.arena);
    }
}

/* Wall in the shade of the direct sun all day, against the sun of it: what the shade of a neighbour is worth, and so
 * how wrong a wall is that has one. */
static void shade_is_worth_this(void **state)
{
    (void)state;
    static const char *const of[][2] = {{"wall_brick_cavity", "brick_red"}, {"wall_sheet", "metal_steel_galvanized"}};
    for (int k = 0; k < 2; k++) {
        SceneryHeat *heat = wall_alone(of[k][0], of[k][1], 17);
        const double south[3] = {0, -1, 0}, north[3] = {0, 1, 0};
        WallSeen     sun, shade, away, away_shade;
        scenery_wall_seen(&sun, at(heat, 14), south, 0);
        scenery_wall_seen(&shade, at(heat, 14), south, 1);
        scenery_wall_seen(&away, at(heat, 14), north, 0);
        scenery_wall_seen(&away_shade, at(heat, 14), north, 1);
        print_message("%s at 14 h: %.1f K in the sun, %.1f K in the shade\n", of[k][0], sun.temp_k, shade.temp_k);
        CHECK(sun.temp_k > shade.temp_k + 4 && sun.temp_k < shade.temp_k + 25);
        CHECK(shade.absorbed_w_m2 < sun.absorbed_w_m2 - 100);
        /* whichever way it faces: the shade's columns look east; early and late sun of the north side is still in it */
        CHECK_NEAR(away_shade.temp_k, shade.temp_k, 1e-6);
        CHECK(away.temp_k > away_shade.temp_k - 0.01 && away.temp_k < away_shade.temp_k + 6);
        scenery_heat_destroy(heat);
        arena_reset(lab.arena);
    }
}

/* A wall's memory of past sun, by the sum of all half hours, is what a day of sun and one of shade differ by. */
static void memory_adds_up(void **state)
{
    (void)state;
    static const char *const of[][2] = {{"wall_brick_cavity", "brick_red"}, {"wall_sheet", "metal_steel_galvanized"}};
    static const double      limit[] = {0.3, 0.3};
    for (int k = 0; k < 2; k++) {
        SceneryHeatConfig c = lab.config;
        ShadowMap *const  some = (ShadowMap *)&lab; /* never asked: no object stands in it */
        c.shadow = some;
        SceneryHeat *h;
        CHECK(scenery_heat_wall(&h, &c, constructions_named(&lab.constructions, of[k][0]),
                                materials_find(&lab.materials, of[k][1])) == STATUS_OK);
        const SceneryTemps *t = at(h, 14);
        const double        south[3] = {0, -1, 0};
        WallSeen            sun, shade;
        double              sum_k = 0;
        scenery_wall_seen(&sun, t, south, 0);
        scenery_wall_seen(&shade, t, south, 1);
        for (int s = 0; s < h->walls.slots; s++)
            sum_k += fmax(-(double)h->walls.slot_d_enu[1][s], 0) * (double)t->sun_k[0][s];
        print_message("%s: sun of the day past %.2f K, by memory %.2f K\n", of[k][0], sun.temp_k - shade.temp_k, sum_k);
        CHECK_NEAR(sum_k / (sun.temp_k - shade.temp_k), 1, limit[k]); /* it is linear, with one film for all hours */
        scenery_heat_destroy(h);
        arena_reset(lab.arena);
    }
}

static void wood_in_the_east(ShadowStand *out, const void *user, double x_m, double y_m)
{
    (void)user, (void)y_m;
    *out = x_m > 0 ? (ShadowStand){60, 0, 20, 0.1f} : (ShadowStand){.open = 1};
}

/* Three houses: in the open, deep in a dense wood, and 16 m west of its edge, whose trees of 20 m take the morning's
 * sun and no other. */
static void a_wood_shades_walls(void **state)
{
    (void)state;
    enum { posts = 65 };
    Elevation ground = {0};
    CHECK(elevation_level_create(&ground, 0, &(ElevationGrid){posts, posts, -512, -512, 16, -100, 1.0 / 64}) ==
          STATUS_OK);
    for (int t = 0; t < ground.level[0].tiles_x * ground.level[0].tiles_y; t++)
        ground.level[0].tile[t] = (ElevationTile){0, 0};
    ground.level[0].plain = true;
    for (int j = 0; j < posts; j++)
        for (int i = 0; i < posts; i++) elevation_set_post(&ground.level[0], i, j, 6400);
    elevation_build_pyramids(&ground);
    SceneryHeatConfig c = lab.config;
    House             h;
    int               slot_of[heat_day_slots];
    float             d_enu[3][heat_day_slots] = {{0}};
    ShadowMap        *map;
    c.heat.unix_s = paper_unix_s + 3600 * 14;
    const int slots = heat_day_sun(slot_of, d_enu, &c.heat);
    CHECK(heat_shadow_create(&map,
                             &(ShadowOf){&ground, 8, slots, d_enu, wood_in_the_east, NULL, NULL, NULL, NULL, NULL},
                             NULL) == STATUS_OK);
    c.shadow = map;
    build_house(&h, 0);
    SceneryObject three[3] = {h.object, h.object, h.object};
    const double  x_m[3] = {-300, 300, -24};
    for (int k = 0; k < 3; k++) three[k].p_enu[0] = x_m[k], three[k].p_enu[2] = 100;
    h.scenery.objects = 3, h.scenery.object = three;
    SceneryHeat        *heat = open_heat(&h.scenery, &c), *alone = wall_alone("wall_brick_cavity", "brick_red", 17);
    const SceneryTemps *t = at(heat, 14);
    const double        south[3] = {0, -1, 0}, east[3] = {1, 0, 0}, up[3] = {0, 0, 1};
    WallSeen            sun, shade;
    scenery_heat_destroy(alone);
    c.shadow = NULL;
    CHECK(scenery_heat_wall(&alone, &c, constructions_named(&lab.constructions, "wall_brick_cavity"),
                            materials_find(&lab.materials, "brick_red")) == STATUS_OK);
    scenery_wall_seen(&sun, at(alone, 14), south, 0);
    scenery_wall_seen(&shade, at(alone, 14), south, 1);
    CHECK_NEAR(scenery_temp_k(t, 0, 0, here, south), sun.temp_k, 1e-3);
    CHECK_NEAR(scenery_temp_k(t, 1, 0, here, south), shade.temp_k, 0.1);
    CHECK(scenery_temp_k(t, 1, 1, here, up) < scenery_temp_k(t, 0, 1, here, up) - 15);
    /* the edge: its east wall has lost the morning, its south wall little of it */
    const double lost_east = scenery_temp_k(t, 0, 0, here, east) - scenery_temp_k(t, 2, 0, here, east),
                 lost_south = scenery_temp_k(t, 0, 0, here, south) - scenery_temp_k(t, 2, 0, here, south);
    print_message("at 14 h, 20 m west of a wood: an east wall has lost %.1f K, a south wall %.1f K of %.1f K\n",
                  lost_east, lost_south, sun.temp_k - shade.temp_k);
    CHECK(lost_east > 2 && lost_south < 0.5 * lost_east && lost_south > -0.01);
    scenery_heat_destroy(heat), scenery_heat_destroy(alone);
    heat_shadow_destroy(map);
    elevation_destroy(&ground);
    model_destroy(&h.model);
    arena_reset(lab.arena);
}

/* Whatever frames were made before, and after going back; from the cache too. */
static void frames_decide_nothing(void **state)
{
    (void)state;
    static const double hours[] = {6, 6.01, 7.3, 9.2, 12};
    House               h;
    double              want[5], temp_k;
    char                folder[] = "/tmp/pitviper_scenery_XXXXXX";
    const double        n[3] = {0, -1, 0};
    CHECK(mkdtemp(folder));
    build_house(&h, 0);
    SceneryHeat *heat = open_heat(&h.scenery, &lab.config);
    for (int k = 4; k >= 0; k--) want[k] = scenery_temp_k(at(heat, hours[k]), 0, 0, here, n);
    scenery_heat_destroy(heat);
    SceneryHeatConfig c = lab.config;
    for (int kept = 0; kept < 2; kept++) {
        c.heat.cache = cache_open(folder, 1 << 26);
        CHECK(c.heat.cache);
        heat = open_heat(&h.scenery, &c);
        for (int k = 0; k < 5; k++) {
            for (double early = k ? hours[k - 1] : 6; early < hours[k]; early += 0.07) at(heat, early);
            temp_k = scenery_temp_k(at(heat, hours[k]), 0, 0, here, n);
            CHECK(temp_k == want[k]);
        }
        CHECK(scenery_temp_k(at(heat, hours[1]), 0, 0, here, n) == want[1]);
        CHECK(scenery_temp_k(at(heat, 1), 0, 0, here, n) == want[0]); /* before the exercise: as at its beginning */
        const CacheCounters counters = cache_counters(c.heat.cache);
        CHECK(counters.fetched == (uint64_t)kept);
        scenery_heat_destroy(heat);
        cache_close(c.heat.cache);
    }
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    CHECK(system(command) == 0);
    model_destroy(&h.model);
    arena_reset(lab.arena);
}

/* ---- clutter --------------------------------------------------------------------------------- */

enum { most_models = 8, most_things = 5000, most_in_state = 32 };
typedef struct Yard {
    Model         model[most_models];
    Catalog      *catalog[most_models]; /* whose the model is; NULL: it is by hand */
    SceneryState  state[most_in_state];
    SceneryObject object[most_things];
    SceneryMover  mover[2];
    double        path_enu[4][3];
    Scenery       scenery;
} Yard;
static Yard yard;

static void empty_yard(void)
{
    for (int k = 0; k < yard.scenery.models; k++)
        if (yard.catalog[k]) catalog_close(yard.catalog[k]);
        else model_destroy(&yard.model[k]);
    memset(&yard, 0, sizeof yard);
    yard.scenery = (Scenery){.model = yard.model,
                             .state = yard.state,
                             .object = yard.object,
                             .mover = yard.mover,
                             .path_enu = yard.path_enu};
}

static int add_shape(const char *name)
{
    int index;
    CHECK(catalog_open_one(&yard.catalog[yard.scenery.models], &index, name, 0.02) == STATUS_OK);
    yard.model[yard.scenery.models] = *catalog_model(yard.catalog[yard.scenery.models], index);
    return yard.scenery.models++;
}

static int add_state(int model, EntityDrives drives, double heading_rad, double stood_s)
{
    yard.state[yard.scenery.states] = (SceneryState){model, drives, (float)heading_rad, (float)stood_s};
    return yard.scenery.states++;
}

static int add_thing(int state, double heading_rad)
{
    const double c = cos(heading_rad), n = sin(heading_rad);
    yard.object[yard.scenery.objects] = (SceneryObject){.kind = SCENERY_CLUTTER,
                                                        .class = CLUTTER_CAR,
                                                        .state = state,
                                                        .model = yard.state[state].model,
                                                        .r_enu_from_body = {n, c, 0, c, -n, 0, 0, 0, -1}};
    return yard.scenery.objects++;
}

/* Mean over the triangles of parts of a role. */
static double role_k(const SceneryTemps *t, int object, HeatRole role)
{
    const SceneryObject *o = &yard.object[object];
    const Model         *m = &yard.model[o->model];
    double               sum = 0, area = 0;
    for (int i = 0; i < m->triangle_count; i++) {
        if (m->part[m->triangle_part[i]].role != role || m->part[m->triangle_part[i]].node != 0) continue;
        double a[3], b[3], n[3], n_enu[3], p[3] = {0};
        for (int k = 0; k < 3; k++) v3_add_scaled(p, p, 1.0 / 3, m->vertex[m->triangle[i][k]]);
        v3_sub(a, m->vertex[m->triangle[i][1]], m->vertex[m->triangle[i][0]]);
        v3_sub(b, m->vertex[m->triangle[i][2]], m->vertex[m->triangle[i][0]]);
        v3_cross(n, a, b);
        const double twice_m2 = v3_length(n);
        if (!v3_normalize(n, n)) continue;
        m3_mul_v3(n_enu, o->r_enu_from_body, n);
        sum += twice_m2 * scenery_temp_k(t, object, m->triangle_part[i], p, n_enu), area += twice_m2;
    }
    CHECK(area > 0);
    return sum / area;
}

/* Bonnets, exhausts, and what cools: an engine that idles, has stopped for longer and longer, never ran. */
static void engines_run_stop_and_cool(void **state)
{
    (void)state;
    static const double stood_s[] = {120, 600, 1800, 7200};
    const EntityDrives  runs = {.engine = 0.6f}, drives = {.engine = 1, .speed_mps = 20}, rests = {0};
    double              bonnet_k[7], exhaust_k[7];
    empty_yard();
    const int car = add_shape("car");
    add_thing(add_state(car, drives, 0, 0), 0);
    add_thing(add_state(car, runs, 0, 0), 0);
    for (int k = 0; k < 4; k++) add_thing(add_state(car, runs, 0, stood_s[k]), 0);
    add_thing(add_state(car, rests, 0, 0), 0);
    SceneryHeat        *heat = open_heat(&yard.scenery, &lab.config);
    const SceneryTemps *t = at(heat, 6);
    print_message("car: bonnet, exhaust (drives, idles, stopped 2, 10, 30, 120 min, cold), air %.0f K\n", t->air_k);
    for (int k = 0; k < 7; k++) {
        bonnet_k[k] = role_k(t, k, HEAT_ENGINE_DECK), exhaust_k[k] = role_k(t, k, HEAT_EXHAUST);
        print_message("  %.1f K, %.1f K\n", bonnet_k[k], exhaust_k[k]);
    }
    CHECK(exhaust_k[0] > 420 && exhaust_k[0] < 700);
    CHECK(bonnet_k[1] > 305 && bonnet_k[1] < 345);
    for (int k = 1; k < 6; k++) CHECK(bonnet_k[k] > bonnet_k[k + 1] - 0.3 && exhaust_k[k] > exhaust_k[k + 1] - 0.3);
    CHECK(bonnet_k[3] > bonnet_k[6] + 3); /* warm ten minutes after */
    /* stopped two minutes before the exercise, half an hour later, against stopped half an hour before it: the same
     * age, but for the weather, whose change the cold one tells */
    const SceneryTemps *later = at(heat, 6 + (1800 - 120) / 3600.0);
    const double        weather_k = role_k(later, 6, HEAT_ENGINE_DECK) - bonnet_k[6];
    CHECK_NEAR(role_k(later, 2, HEAT_ENGINE_DECK) - weather_k, bonnet_k[4], 1);
    scenery_heat_destroy(heat);
    arena_reset(lab.arena);
}

/* Fires: flames, embers, the crust of a heap. */
static void fires_are_as_hot_as_their_class(void **state)
{
    (void)state;
    static const HeatRole role[3] = {HEAT_FIRE, HEAT_EMBER, HEAT_SMOULDER};
    static const double   low_k[3] = {900, 700, 320}, high_k[3] = {1300, 1000, 370};
    empty_yard();
    for (int k = 0; k < 3; k++) {
        Model *m = &yard.model[yard.scenery.models++];
        hand_box(m, (const double[3]){-0.4, -0.4, -0.8}, (const double[3]){0.4, 0.4, -0.05});
        strcpy(m->part[0].name, "fire"), strcpy(m->part[0].material, "flare_grain");
        m->part[0].role = role[k];
        CHECK(model_measure(m) == STATUS_OK);
        add_thing(add_state(k, (EntityDrives){.burning = 1}, 0, 0), 0);
        add_thing(add_state(k, (EntityDrives){0}, 0, 0), 0);
    }
    SceneryHeat        *heat = open_heat(&yard.scenery, &lab.config);
    const SceneryTemps *t = at(heat, 6.5);
    for (int k = 0; k < 3; k++) {
        const double burns_k = role_k(t, 2 * k, role[k]), cold_k = role_k(t, 2 * k + 1, role[k]);
        print_message("%s: %.0f K, cold %.0f K\n", heat_role_name(role[k]), burns_k, cold_k);
        CHECK(burns_k > low_k[k] && burns_k < high_k[k] && fabs(cold_k - t->air_k) < 25);
    }
    scenery_heat_destroy(heat);
    arena_reset(lab.arena);
}

/* Objects of a state, however many, are its patches, in their own axes: one that is turned with its state's heading is
 * as it; 5000 cost what one costs. What the nearest of 16 headings is wrong by. */
static void objects_share_their_state(void **state)
{
    (void)state;
    const double half = pi_rad / 16;
    empty_yard();
    const int car = add_shape("car");
    const int zero = add_state(car, (EntityDrives){0}, 0, 0), turned = add_state(car, (EntityDrives){0}, half, 0);
    for (int k = 0; k < most_things - 1; k++) add_thing(zero, 0);
    const int other = add_thing(turned, half);
    yard.object[7].r_enu_from_body[0] = sin(half), yard.object[7].r_enu_from_body[1] = cos(half);
    yard.object[7].r_enu_from_body[3] = cos(half), yard.object[7].r_enu_from_body[4] = -sin(half);
    SceneryHeat *heat = open_heat(&yard.scenery, &lab.config);
    at(heat, 9);
    const SceneryTemps *t = at(heat, 10);
    CHECK(role_k(t, 0, HEAT_CABIN) == role_k(t, 4321, HEAT_CABIN));
    CHECK(fabs(role_k(t, 7, HEAT_CABIN) - role_k(t, 0, HEAT_CABIN)) < 0.02); /* turned: blends of patches round */
    const VehicleHeatCounters *c = vehicle_heat_counters(heat->states.heat);
    CHECK(c->begun == 2 && c->failed == 0 && c->neighbours_left_out == 0);
    double       sum = 0, worst_k = 0;
    const Model *m = &yard.model[car];
    for (int i = 0; i < m->triangle_count; i++) {
        double a[3], b[3], n[3], n_enu[2][3], p[3] = {0};
        if (m->part[m->triangle_part[i]].node != 0) continue;
        for (int k = 0; k < 3; k++) v3_add_scaled(p, p, 1.0 / 3, m->vertex[m->triangle[i][k]]);
        v3_sub(a, m->vertex[m->triangle[i][1]], m->vertex[m->triangle[i][0]]);
        v3_sub(b, m->vertex[m->triangle[i][2]], m->vertex[m->triangle[i][0]]);
        v3_cross(n, a, b);
        if (!v3_normalize(n, n)) continue;
        m3_mul_v3(n_enu[0], yard.object[0].r_enu_from_body, n);
        m3_mul_v3(n_enu[1], yard.object[other].r_enu_from_body, n);
        const double miss = scenery_temp_k(t, 0, m->triangle_part[i], p, n_enu[0]) -
                            scenery_temp_k(t, other, m->triangle_part[i], p, n_enu[1]);
        sum += miss * miss / m->triangle_count, worst_k = fmax(worst_k, fabs(miss));
    }
    print_message("a car at 10 h, half of a sixteenth of a turn away: %.2f K rms, %.2f K at most\n", sqrt(sum),
                  worst_k);
    CHECK(sqrt(sum) < 1.5 && worst_k < 8);
    scenery_heat_destroy(heat);
    arena_reset(lab.arena);
}

/* The same whatever frames are made, and turned back. */
static void frames_decide_nothing_of_clutter(void **state)
{
    (void)state;
    empty_yard();
    const int car = add_shape("car");
    add_thing(add_state(car, (EntityDrives){.engine = 0.6f}, 1, 0), 1);
    add_thing(add_state(car, (EntityDrives){.engine = 0.6f}, 1, 600), 1);
    SceneryHeat *heat = open_heat(&yard.scenery, &lab.config);
    const double far_k[2] = {role_k(at(heat, 6.2), 0, HEAT_CABIN), role_k(at(heat, 6.2), 1, HEAT_ENGINE_DECK)};
    const double begun_k = role_k(at(heat, 6), 1, HEAT_ENGINE_DECK);
    for (double hour = 6; hour < 6.2; hour += 0.0093) at(heat, hour);
    CHECK(role_k(at(heat, 6.2), 0, HEAT_CABIN) == far_k[0]);
    CHECK(role_k(at(heat, 6.2), 1, HEAT_ENGINE_DECK) == far_k[1]);
    CHECK(begun_k > far_k[1]);
    scenery_heat_destroy(heat);
    arena_reset(lab.arena);
}

/* What drives turns: its sun-lit side is that of its pose then, of the state's patches in its own axes. */
static void movers_keep_their_own_axes(void **state)
{
    (void)state;
    empty_yard();
    const int car = add_shape("car"), drives = add_state(car, (EntityDrives){.engine = 1, .speed_mps = 15}, 0, 0);
    const int stands = add_thing(drives, 0), moves = add_thing(drives, 0);
    yard.path_enu[1][0] = 1000, yard.path_enu[2][0] = 1000, yard.path_enu[2][1] = 1000;
    yard.mover[0] = (SceneryMover){.object = moves, .count = 3, .speed_mps = 15};
    yard.scenery.movers = 1, yard.scenery.paths = 3;
    SceneryHeat        *heat = open_heat(&yard.scenery, &lab.config);
    const SceneryTemps *t = at(heat, 6);
    const int           part = 0;
    const double        p[3] = {0, 0.8, -0.7}, east[3] = {1, 0, 0}, south[3] = {0, -1, 0};
    /* it drives east: its right side faces south, as that of the one that looks north faces east */
    CHECK_NEAR(scenery_temp_k(t, moves, part, p, south), scenery_temp_k(t, stands, part, p, east), 1e-6);
    scenery_heat_destroy(heat);
    empty_yard();
    arena_reset(lab.arena);
}

/* What cannot be is refused. */
static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    SceneryHeat      *heat = NULL;
    SceneryHeatConfig c = lab.config;
    House             h;
    build_house(&h, 0);
    strcpy(h.model.part[1].material, "no_such_material");
    CHECK(scenery_heat_create(&heat, &c, &h.scenery) == STATUS_BAD_VALUE && !heat);
    strcpy(h.model.part[1].material, "asphalt_road");
    c.heat.facets = 8;
    CHECK(scenery_heat_create(&heat, &c, &h.scenery) == STATUS_BAD_VALUE && !heat);
    c = lab.config;
    h.scenery.states = scenery_most_states + 1;
    CHECK(scenery_heat_create(&heat, &c, &h.scenery) == STATUS_BAD_VALUE && !heat);
    h.scenery.states = 0;
    CHECK(scenery_heat_create(&heat, &c, &h.scenery) == STATUS_OK);
    SceneryTemps *t;
    CHECK(scenery_temps_at(&t, heat, NAN, lab.arena) == STATUS_BAD_VALUE);
    scenery_heat_destroy(heat);
    scenery_heat_destroy(NULL);
    model_destroy(&h.model);
    /* nothing at all */
    const Scenery none = {0};
    CHECK(scenery_heat_create(&heat, &c, &none) == STATUS_OK);
    CHECK(scenery_temps_at(&t, heat, paper_unix_s + 7 * 3600, lab.arena) == STATUS_OK);
    scenery_heat_destroy(heat);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turned_house_has_its_own_normals),
        cmocka_unit_test(walls_follow_the_sun),
        cmocka_unit_test(facets_are_close),
        cmocka_unit_test(shade_is_worth_this),
        cmocka_unit_test(memory_adds_up),
        cmocka_unit_test(a_wood_shades_walls),
        cmocka_unit_test(frames_decide_nothing),
        cmocka_unit_test(engines_run_stop_and_cool),
        cmocka_unit_test(fires_are_as_hot_as_their_class),
        cmocka_unit_test(objects_share_their_state),
        cmocka_unit_test(frames_decide_nothing_of_clutter),
        cmocka_unit_test(movers_keep_their_own_axes),
        cmocka_unit_test(what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
