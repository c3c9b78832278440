/* How warm clutter is by class, against published ranges: engines that run and that stopped, hides, embers, drums,
 * crusts, stones; at noon and before sunrise of a summer's day. labels: physics */
#include "tests/render/hand_models.h"
#include "tests/scenes/paper_day.h"

#include "entities/scenery/scenery_clutter.h"
#include "entities/shapes/parametric.h"
#include "render/heat/scenery_heat.h"

static Materials         materials;
static GroundKinds       kinds;
static Constructions     constructions;
static PartTable         parts;
static LocalFrame        frame;
static Arena            *arena;
static SceneryHeatConfig config;

static void light_wind(double wind_enu_mps[3], double unix_s, const void *user)
{
    (void)unix_s, (void)user;
    wind_enu_mps[0] = 2, wind_enu_mps[1] = wind_enu_mps[2] = 0;
}

static int setup(void **state)
{
    static const char *const file[] = {"materials.csv",           "surfaces.csv", "constructions.csv",
                                       "construction_layers.csv", "heat.csv",     "heat_machines.csv"};
    char                     path[6][512];
    (void)state;
    for (int k = 0; k < 6; k++)
        if (!etc_path(path[k], sizeof path[k], file[k])) return -1;
    paper_kinds(&kinds);
    arena = arena_create();
    config = scenery_heat_default_config();
    config.heat.unix_s = paper_unix_s + 3600 * 2, config.heat.weather = paper_weather;
    config.heat.user = &paper_summer;
    config.ground = &kinds, config.constructions = &constructions;
    config.materials = &materials, config.parts = &parts, config.frame = &frame;
    config.isa = "avx2", config.wind = light_wind;
    return materials_open(&materials, path[0], path[1], NULL) == STATUS_OK &&
                   constructions_open(&constructions, path[2], path[3]) == STATUS_OK &&
                   part_table_open(&parts, path[4], path[5]) == STATUS_OK &&
                   local_frame_at(&frame, &(Geodetic){0.785, 0, 100}) == STATUS_OK && arena
               ? 0
               : -1;
}

static int teardown(void **state)
{
    (void)state;
    materials_close(&materials);
    arena_destroy(arena);
    return 0;
}

enum { idles, works, drives, lives, burns, cold, stopped_3_min, stopped_1_h, stopped_1_day };

typedef struct Want {
    const char *shape, *part;
    int         does;
    double      low_k, high_k; /* of the warmest place of the part, above absolute zero or, below 100, above the air */
    const char *source;
} Want;

/* Of the warmest place: in the sun of noon that is where it falls square, at 2 m/s. */
static const Want want[] = {
    {"car", "bonnet", idles, 3, 70, "bonnets of idling cars: 310 .. 350 K (thermographs of parked and running cars)"},
    {"car", "exhaust", idles, 80, 350,
     "pipes and silencers behind the catalyst: 370 .. 620 K (Heywood, table 12: by load)"},
    {"car", "exhaust", drives, 80, 350, "the same"},
    {"generator", "exhaust", works, 80, 350, "the same of a diesel's stack"},
    {"tractor", "bonnet", works, 3, 80, "as the car's, closer to the engine"},
    {"tractor", "exhaust", works, 80, 350, "a stack without a shield"},
    {"lorry", "grille", idles, 3, 80, "as the tractor's bonnet"},
    {"lorry", "exhaust", idles, 80, 350, "as the car's (Heywood)"},
    {"van", "bonnet", idles, 3, 70, "as the car's"},
    {"van", "exhaust", idles, 80, 350, "as the car's (Heywood)"},
    {"semi_trailer", "box", cold, -6, 45, "light sheet in the sun: up to 45 K above the air (Levinson et al. 2011)"},
    {"bulldozer", "engine", works, 3, 80, "as the tractor's bonnet"},
    {"bulldozer", "exhaust", works, 80, 350, "as the tractor's"},
    {"excavator", "engine_deck", works, 3, 80, "as the tractor's bonnet"},
    {"excavator", "exhaust", works, 80, 350, "as the tractor's"},
    {"farm_trailer", "body", cold, -6, 45, "light sheet in the sun: up to 45 K above the air (Levinson et al. 2011)"},
    {"tent", "roof", cold, -6, 50, "canvas in the sun: as dark sheet, less for its little mass (Levinson et al. 2011)"},
    {"crates", "crates", cold, -6, 50, "dark painted boards in the sun, as dark sheet"},
    {"cow", "body", lives, 2, 40, "dark coats in the sun: up to 40 K above the air at low wind (Stewart 1953)"},
    {"cow", "udder", lives, 8, 20,
     "udders and muzzles: 303 .. 309 K in barns of 293 K: 10 .. 16 K above the air (thermographs)"},
    {"sheep", "fleece", lives, 2, 47, "tips of fleece: up to 47 K above the air in the sun (Macfarlane et al. 1958)"},
    {"deer", "head", lives, 2, 40, "as coats"},
    {"campfire", "embers", burns, 700, 1000, "glowing char: 700 .. 1000 K (Drysdale)"},
    {"campfire", "flames", burns, 900, 1300, "lasting part of flames (Drysdale)"},
    {"barrel", "drum", burns, 500, 900, "walls of drums that burn, dull red at most"},
    {"smoulder", "heap", burns, 310, 400, "crusts of 320 .. 370 K over 700 .. 1000 K within (Rein)"},
    {"rock_1", "rock", cold, -6, 30, "sunlit rock: up to 30 K above the air (McGreevy 1985; dark basalt more)"},
    {"wreck", "body", cold, -6, 55, "dark sheet of cars in the sun: 340 .. 350 K (Levinson et al. 2011)"},
};
enum { wants = sizeof want / sizeof *want };

static SceneryState state_of(int model, int does)
{
    static const float stood_s[] = {[stopped_3_min] = 180, [stopped_1_h] = 3600, [stopped_1_day] = 86400};
    SceneryState       s = {.model = model};
    s.drives.engine = does == idles                             ? 0.6f
                      : does == works                           ? 0.82f
                      : does == drives || does >= stopped_3_min ? 0.75f
                                                                : 0;
    s.drives.speed_mps = does == drives ? 15 : 0;
    s.drives.alive = does == lives, s.drives.burning = does == burns;
    s.stood_s = does >= stopped_3_min ? stood_s[does] : 0;
    return s;
}

/* The warmest middle of a triangle of a part. */
static double warmest_k(const SceneryTemps *temps, int object, const Model *m, const char *name)
{
    NodePose pose[64];
    double   most = -INFINITY;
    CHECK(m->node_count <= 64);
    model_pose(pose, m, NULL);
    for (int t = 0; t < m->triangle_count; t++) {
        const int part = m->triangle_part[t];
        double    p[3] = {0}, corner[3][3], e[3], f[3], n[3], up[3];
        if (strcmp(m->part[part].name, name) != 0) continue;
        const NodePose *at = &pose[m->part[part].node];
        for (int k = 0; k < 3; k++) {
            m3_mul_v3(corner[k], at->r_body_from_node, m->vertex[m->triangle[t][k]]);
            v3_add(corner[k], corner[k], at->p_body);
            v3_add_scaled(p, p, 1. / 3, corner[k]);
        }
        v3_sub(e, corner[1], corner[0]), v3_sub(f, corner[2], corner[0]), v3_cross(n, e, f);
        if (!v3_normalize(n, n)) continue;
        /* heading north: x forward is north, y right east, z down */
        up[0] = n[1], up[1] = n[0], up[2] = -n[2];
        most = fmax(most, scenery_temp_k(temps, object, part, p, up));
    }
    return most;
}

static Scenery made(const int *does, const char *const *shape, int count)
{
    Scenery s = {.model = calloc((size_t)count, sizeof *s.model),
                 .object = calloc((size_t)count, sizeof *s.object),
                 .state = calloc((size_t)count, sizeof *s.state)};
    for (int k = 0; k < count; k++) {
        CHECK(parametric_build(&s.model[k], shape[k], 0.1) == STATUS_OK);
        s.state[k] = state_of(k, does[k]);
        s.object[k] = (SceneryObject){.kind = SCENERY_CLUTTER,
                                      .class = CLUTTER_CAR,
                                      .model = k,
                                      .state = k,
                                      .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    }
    s.models = s.objects = s.states = count;
    return s;
}

static void as_warm_as_published(void **state)
{
    (void)state;
    const char *shape[wants];
    int         does[wants], faults = 0;
    for (int k = 0; k < wants; k++) shape[k] = want[k].shape, does[k] = want[k].does;
    Scenery      s = made(does, shape, wants);
    SceneryHeat *heat;
    CHECK(scenery_heat_create(&heat, &config, &s) == STATUS_OK);
    for (int hour = 4; hour <= 14; hour += 10) {
        SceneryTemps *temps;
        GroundWeather w;
        CHECK(scenery_temps_at(&temps, heat, paper_unix_s + 3600 * hour, arena) == STATUS_OK);
        paper_weather(&w, paper_unix_s + 3600 * hour, &paper_summer);
        for (int k = 0; k < wants; k++) {
            const double k_now = warmest_k(temps, k, &s.model[k], want[k].part);
            const double base = fabs(want[k].low_k) < 100 ? w.air.temp_k : 0;
            const bool   good = k_now >= base + want[k].low_k && k_now <= base + want[k].high_k;
            print_message("%2d h, air %.1f: %-10s %-8s %6.1f K%s\n", hour, w.air.temp_k, want[k].shape, want[k].part,
                          k_now, good ? "" : "  <- OUT OF RANGE");
            faults += !good;
        }
    }
    scenery_heat_destroy(heat);
    scenery_free(&s);
    arena_reset(arena);
    CHECK(faults == 0);
}

/* Engines cool for hours: each that stopped later is warmer, and one that stopped a day ago is as one that never ran.
 */
static void engines_cool(void **state)
{
    (void)state;
    static const char *const shape[] = {"car", "car", "car", "car", "car"};
    static const int         does[] = {idles, stopped_3_min, stopped_1_h, stopped_1_day, cold};
    Scenery                  s = made(does, shape, 5);
    SceneryHeat             *heat;
    SceneryTemps            *temps;
    double                   k[5];
    CHECK(scenery_heat_create(&heat, &config, &s) == STATUS_OK);
    CHECK(scenery_temps_at(&temps, heat, config.heat.unix_s, arena) == STATUS_OK);
    for (int i = 0; i < 5; i++) k[i] = warmest_k(temps, i, &s.model[i], "bonnet");
    print_message("bonnets: running %.1f, 3 min %.1f, 1 h %.1f, 1 day %.1f, never %.1f K\n", k[0], k[1], k[2], k[3],
                  k[4]);
    CHECK(k[1] > k[2] + 1 && k[2] > k[3] + 1 && fabs(k[3] - k[4]) < 1.5 && k[1] > k[4] + 5);
    scenery_heat_destroy(heat);
    scenery_free(&s);
    arena_reset(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_warm_as_published),
        cmocka_unit_test(engines_cool),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
