/* A vehicle of patches that are written down here: nodes and links of its network, what heats and cools a skin, when
 * its views and its step are over, which is its neighbour. labels: physics */
#include "tests/render/hand_models.h"

#include "render/heat/surface_flux_private.h"
#include "render/heat/vehicle_state_private.h"

enum { hull, thick, thin, small_gun, large_gun, large_too, track, track_too, stiff, hidden, bodies = 9, patches = 10 };
static const int body_of[patches] = {0, 1, 2, 3, 4, 4, 5, 5, 6, 7};

static Patch     patch[patches];
static PatchLink adjoin[2] = {{hull, thick, 2, 0.5, false}, {thin, hidden, 3, 0.6, true}};
static int first_of[bodies + 1] = {0, 1, 2, 3, 4, 6, 8, 9, 10, 10}, body_of_part[bodies] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
static Patches      cut = {patches, 2, bodies, bodies, patch, adjoin, body_of_part, first_of, NULL};
static ModelNode    node = {.parent = -1, .axis = {0, 0, 1}};
static ModelPart    part[bodies];
static Model        model = {.name = "hand", .node_count = 1, .part_count = bodies, .node = &node, .part = part};
static Material     material[4];
static int          of_part[bodies] = {1, 1, 1, 1, 1, 2, 3, 1, 1}, *of_model[1] = {of_part};
static Materials    materials = {.count = 4, .material = material, .part = of_model, .model_count = 1};
static PartTable    table;
static VehicleShape shape;

/* Areas 1, 2, 3 ... m2, a tenth of it inside; steel of 45 W/(m K) and 4 MJ/(m3 K), rubber of 0.9, brass of 1.05. */
static int open_shape(void **state)
{
    (void)state;
    static const HeatRole role[patches] = {HEAT_HULL, HEAT_ENGINE_DECK, HEAT_CABIN, HEAT_GUN,   HEAT_GUN,
                                           HEAT_GUN,  HEAT_TRACK,       HEAT_TRACK, HEAT_WHEEL, HEAT_HULL};
    for (int i = 0; i < patches; i++) {
        patch[i] = (Patch){.part = body_of[i],
                           .role = role[i],
                           .area_m2 = i + 1,
                           .open_share = i == hidden ? 0 : 0.9,
                           .n_node = {0, 0, -1}};
        for (int p = 0; p < patch_points; p++) patch[i].point_n_node[p][2] = -1;
    }
    patch[track].ground_m2 = 1.5, patch[track_too].ground_m2 = 0.75, patch[stiff].ground_m2 = 0.04;
    part[1].thickness_m = 0.19, part[2].thickness_m = 0.17, part[6].thickness_m = 0.03;
    material[1] = (Material){.conductivity_w_mk = 45,
                             .density_kg_m3 = 8000,
                             .heat_capacity_j_kgk = 500,
                             .solar_absorptance = 0.75f,
                             .rho_lwir = 0.25f};
    material[2] = material[1], material[2].conductivity_w_mk = 0.9f;
    material[3] = material[1], material[3].conductivity_w_mk = 1.05f;
    table.role[HEAT_HULL] =
        (PartRow){.thickness_m = 0.025, .inside = INSIDE_CABIN, .inside_w_m2k = 4, .running_w_m2k = 8};
    table.role[HEAT_ENGINE_DECK] =
        (PartRow){.thickness_m = 0.01, .inside = INSIDE_ENGINE, .inside_w_m2k = 6, .running_w_m2k = 15};
    table.role[HEAT_CABIN] = (PartRow){.thickness_m = 0.01};
    table.role[HEAT_GUN] = (PartRow){.thickness_m = 0.04, .drive = PART_DRIVE_FIRING, .drive_value = 180000};
    table.role[HEAT_TRACK] = (PartRow){.thickness_m = 0.04, .drive = PART_DRIVE_MOTION, .drive_value = 1500};
    table.role[HEAT_WHEEL] = (PartRow){.thickness_m = 0.03, .drive = PART_DRIVE_MOTION, .drive_value = 700};
    table.machines = 1;
    table.machine[0] = (MachineRow){"hand", 300e3, 1.2e6, 363, 750, 160e3, 1500, 1.1e6, 140};
    model.length_m = model.width_m = model.height_m = 1; /* the last row is of a cubic metre */
    m3_identity(node.r_parent_from_node);
    return vehicle_shape_create(&shape, &cut, &model, 0, &table, &materials) != STATUS_OK;
}

static int close_shape(void **state)
{
    (void)state;
    vehicle_shape_destroy(&shape);
    return 0;
}

static double conductance(int a, int b)
{
    double w_k = 0;
    for (int l = 0; l < shape.links; l++)
        if ((shape.link[l].a == a && shape.link[l].b == b) || (shape.link[l].a == b && shape.link[l].b == a))
            w_k += shape.link[l].conductance_w_k;
    return w_k;
}

/* A skin is thick where 25 W/(m2 K) of film over its conductance pass a Biot number of 0.1: 180 mm of this steel. Then
 * it has nodes at 0, 0.1, 0.35 and 1 of its thickness, each with half of what lies to either side; the wall of a gun at
 * thirds. Sheets that adjoin: the lesser of conductivity times thickness, by length over distance, a third of it across
 * a joint. Behind the skins: the row's film; engine to cabin its capacity in 60000 s; fuel by a tenth of 30 W/(m2 K) to
 * the outer hull, and to the engine by its own figure. */
static void nodes_and_links(void **state)
{
    (void)state;
    static const double depth[4] = {0.05, 0.175, 0.45, 0.325}, third[4] = {1 / 6.0, 1 / 3.0, 1 / 3.0, 1 / 6.0},
                        apart[2][3] = {{0.1, 0.25, 0.65}, {1 / 3.0, 1 / 3.0, 1 / 3.0}};
    int nodes = 0;
    for (int i = 0; i < patches; i++) {
        const SkinNode *s = &shape.skin[i];
        const bool      gun = i == small_gun || i == large_gun || i == large_too,
                   deep = gun || i == thick || i == track || i == track_too || i == stiff;
        const double m2 = i == hidden ? 10 : 0.9 * (i + 1), t_m = i == thick                 ? 0.19
                                                                  : i == thin                ? 0.17
                                                                  : i == stiff               ? 0.03
                                                                  : i == hull || i == hidden ? 0.025
                                                                                             : 0.04;
        const double k = (double)material[of_part[body_of[i]]].conductivity_w_mk;
        CHECK(s->surface == nodes && s->inner == nodes + (deep ? 3 : 0));
        CHECK_NEAR(s->area_m2, m2, 1e-12);
        CHECK_NEAR(s->open_m2, i == hidden ? 0 : m2, 1e-12);
        CHECK_NEAR(s->effusivity, sqrt(k * 4e6), 1e-3);
        CHECK(s->absorptance == 0.75 && s->emissivity == 0.75 && s->row.thickness_m == t_m);
        for (int d = 0; d < (deep ? 4 : 1); d++, nodes++) {
            CHECK_NEAR(shape.capacity_j_k[nodes], 4e6 * t_m * m2 * (!deep ? 1 : gun ? third[d] : depth[d]), 1e-3);
            if (d > 0)
                CHECK_NEAR(conductance(nodes - 1, nodes), k * m2 / (t_m * apart[gun][d - 1]), 1e-9 * k * m2 / t_m);
        }
    }
    CHECK(shape.engine == nodes && shape.cabin == nodes + 1 && shape.fuel == nodes + 2 && shape.nodes == nodes + 3);
    CHECK(shape.capacity_j_k[shape.engine] == 1.2e6 && shape.capacity_j_k[shape.cabin] == 160e3 &&
          shape.capacity_j_k[shape.fuel] == 1.1e6);
    CHECK_NEAR(conductance(shape.skin[hull].surface, shape.skin[thick].surface), 45 * 0.025 * 2 / 0.5, 1e-9);
    CHECK_NEAR(conductance(shape.skin[thin].surface, shape.skin[hidden].surface), 45 * 0.025 * 3 / 0.6 / 3, 1e-9);
    CHECK_NEAR(conductance(shape.skin[hull].inner, shape.cabin), 4 * 0.9, 1e-12);
    CHECK_NEAR(conductance(shape.skin[hidden].inner, shape.cabin), 4 * 10, 1e-12);
    CHECK_NEAR(conductance(shape.skin[thick].inner, shape.engine), 6 * 1.8, 1e-12);
    CHECK_NEAR(conductance(shape.engine, shape.cabin), 1.2e6 / 6e4, 1e-12);
    CHECK_NEAR(conductance(shape.skin[hull].inner, shape.fuel), 0.1 * 30 * 0.9, 1e-12);
    CHECK(conductance(shape.skin[hidden].inner, shape.fuel) == 0 &&
          conductance(shape.skin[thick].inner, shape.fuel) == 0);
    CHECK_NEAR(conductance(shape.engine, shape.fuel), 140, 1e-12);
    /* friction: all of what yields, tracks and what conducts less than 1 W/(m K); a fifth of stiff wheels */
    CHECK(shape.skin[track].friction == 1 && shape.skin[stiff].friction == 0.2);
    /* prints: as they stand; as they roll, of the body's 2.25 m2 by outer area, 6.3 of 13.5 m2 */
    CHECK(shape.skin[track].ground_m2 == 1.5 && shape.skin[hull].rolls_m2 == 0 && shape.skin[hidden].ground_m2 == 0);
    CHECK_NEAR(shape.skin[track].rolls_m2, 2.25 * 6.3 / 13.5, 1e-12);
    CHECK_NEAR(shape.skin[track_too].rolls_m2, 2.25 * 7.2 / 13.5, 1e-12);
    CHECK_NEAR(shape.skin[track].print_m, 1.5, 1e-12);
    CHECK(shape.gun_body[0] == 3 && shape.gun_body[1] == 4);
    CHECK_NEAR(shape.gun_m2[0], 0.9 * 4, 1e-12);
    CHECK_NEAR(shape.gun_m2[1], 0.9 * 11, 1e-12);
    vehicle_links(&shape, &(EntityDrives){.engine = 0.5f}); /* half way to the running film; half of the return line */
    CHECK_NEAR(shape.conductance_w_k[shape.skin[hull].inside_link], 6 * 0.9, 1e-12);
    CHECK_NEAR(shape.conductance_w_k[shape.skin[thick].inside_link], 10.5 * 1.8, 1e-12);
    CHECK_NEAR(shape.conductance_w_k[shape.fuel_link], 70, 1e-12);
}

/* A moment of it, facing north, of all of whose patches' points one is 1 m over the base and three 0.2, 0.4 and 0.6 m
 * below it. */
static float          lit[patches], gas_k[patches], gas_mps[patches], sent[patches], near_w[patches], near_sun[patches];
static NodePose       pose = {.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
static PosedEntity    posed;
static double         joint[1];
static SnapshotEntity entity;

static VehicleMoment moment_of(const PlaceHeat *where, DisEntityType type)
{
    static const double below_m[patch_points] = {-1, 0.2, 0.4, 0.6};
    entity = (SnapshotEntity){.type = type};
    for (int i = 0; i < patches; i++)
        for (int p = 0; p < patch_points; p++) patch[i].point_node[p][2] = below_m[p];
    return (VehicleMoment){.entity = &entity,
                           .model = &model,
                           .shape = &shape,
                           .pose = {.patches = &cut,
                                    .model = &model,
                                    .posed = &posed,
                                    .node = &pose,
                                    .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1},
                                    .above_m = where->above_m},
                           .node = &pose,
                           .joint = joint,
                           .lit = lit,
                           .gas_k = gas_k,
                           .gas_mps = gas_mps,
                           .sent_w_m2 = sent,
                           .near_w_m2 = near_w,
                           .near_sun_w_m2 = near_sun,
                           .place = *where};
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, ship = {1, 3, 225, 6, 1, 0, 0};

/* Sums by hand of vehicle_load_private.h's text, on the hull, of absorptance and emissivity 0.75. */
static void what_arrives_at_a_skin(void **state)
{
    (void)state;
    static PatchView view[patches];
    static NearView  near[patches];
    NetworkLoad      load[64];
    double           temp_k[64];
    const PlaceHeat  where = {.air_k = 285,
                              .air_density = 0.8,
                              .wind_enu_mps = {3, -4, 0},
                              .direct_w_m2 = 700,
                              .diffuse_w_m2 = 120,
                              .longwave_w_m2 = 310,
                              .sun_d_enu = {0.6, 0, 0.8},
                              .ground_k = 300,
                              .under_k = 290,
                              .ground_rho = 0.2,
                              .above_m = 5,
                              .water_k = 279};
    CHECK(shape.nodes <= 64);
    for (int n = 0; n < shape.nodes; n++) temp_k[n] = 320 + n;
    view[hull] = (PatchView){0.3f, 0.25f, 0.05f, 2, {thin, hidden}, {0.25f, 0.15f}};
    lit[hull] = 0.5f;
    near[hull] = (NearView){.sky = 12, .ground = 48, .under = 3, .own = 12, .partners = 1};
    near_w[hull] = 400, near_sun[hull] = 60;
    for (int c = 0; c < 3; c++) {
        VehicleMoment m = moment_of(&where, tank);
        m.v_enu_mps[0] = 3, m.v_enu_mps[1] = c == 2 ? 8 : -4; /* with the wind; against it, 12 m/s */
        if (c == 1) m.near = near;
        vehicle_loads(load, &m, view, temp_k, &(EntityDrives){.burning = c == 2 ? 0.5f : 0, .flying = 1});
        /* rays of 96 that others take: an eighth of the hemisphere from the sky; of the ground all of its quarter; */
        /* 3 of the ground beneath; an eighth of what its own parts fill, 0.4 */
        const double sky = c == 1 ? 0.3 - 0.125 : 0.3, ground = c == 1 ? 0 : 0.25,
                     under = c == 1 ? 0.05 - 3 / 96.0 : 0.05, own = c == 1 ? (0.4 - 0.125) / 0.4 : 1,
                     others = c == 1 ? 0.125 + 0.25 + 3 / 96.0 + 0.125 : 0;
        const double sun = 700 * 0.5 + 120 * sky + 0.2 * (700 * 0.8 + 120) * ground + others * 60;
        const double around =
            310 * sky + stefan_w_m2k4 * (8.1e9 * ground + pow(290, 4) * under) +
            own * stefan_w_m2k4 *
                (0.25 * pow(temp_k[shape.skin[thin].surface], 4) + 0.15 * pow(temp_k[shape.skin[hidden].surface], 4)) +
            others * 400;
        const NetworkLoad *at = &load[shape.skin[hull].surface];
        CHECK_NEAR(at->heat_w, 0.9 * (0.75 * sun + 0.75 * around + (c == 2 ? 10e3 : 0)), 1e-3);
        CHECK_NEAR(at->emits_m2, 0.75 * 0.9, 1e-12);
        CHECK_NEAR((double)sent[hull], 0.25 * sun, 1e-4);
        CHECK_NEAR(at->film_w_k, 0.9 * (4 + (c == 2 ? 6.1 * pow(12, 0.8) : 0)) * pow(0.8, 0.8), 1e-9);
        CHECK_NEAR(at->fluid_k, 285 + (c == 2 ? 0.85 * 144 / 2010 : 0), 1e-9);
    }
    /* a blade: 0.7 of the tip's speed of 20 rad/s at 3 m, half a metre more by its extent, while its engine runs */
    node.spin_rps_moving = -20, patch[hull].p_node[0] = 3, patch[hull].p_node[2] = 7, patch[hull].reach_m = 0.5;
    for (int runs = 0; runs < 2; runs++) {
        VehicleMoment m = moment_of(&where, tank);
        vehicle_loads(load, &m, view, temp_k, &(EntityDrives){.engine = runs ? 0.6f : 0, .flying = 1});
        const double v = 5 + (runs ? 0.7 * 20 * 3.5 : 0);
        CHECK_NEAR(load[shape.skin[hull].surface].film_w_k, 0.9 * (4 + 6.1 * pow(v, 0.8)) * pow(0.8, 0.8), 1e-9);
        CHECK_NEAR(load[shape.skin[hull].surface].fluid_k, 285 + 0.85 * v * v / 2010, 1e-9);
    }
    node.spin_rps_moving = 0, patch[hull].p_node[0] = patch[hull].p_node[2] = patch[hull].reach_m = 0;
}

/* Half of its points lie below water 0.3 m under its base: half of the skin has the air, sun and radiation, half the
 * water by 200 + 1500 v^0.8 W/(m2 K). On land a tank has none of it, on water it has, and a ship anywhere. */
static void water_takes_its_share(void **state)
{
    (void)state;
    static PatchView view[patches];
    NetworkLoad      load[64];
    double           temp_k[64] = {0};
    PlaceHeat        where = {.air_k = 285, .air_density = 1, .longwave_w_m2 = 300, .above_m = 0.3, .water_k = 279};
    view[hull].sky = 1;
    for (int c = 0; c < 6; c++) {
        where.water = c & 1;
        where.above_m = c < 4 ? 0.3 : -5;
        VehicleMoment m = moment_of(&where, c & 2 ? ship : tank);
        vehicle_loads(load, &m, view, temp_k, &(EntityDrives){.speed_mps = 4, .flying = 1});
        const double wet = c == 0 || c == 4 ? 0
                           : c == 5         ? 1
                                            : 0.5,
                     air = 0.9 * (1 - wet) * 4, water = 0.9 * wet * (200 + 1500 * pow(4, 0.8));
        const NetworkLoad *at = &load[shape.skin[hull].surface];
        CHECK_NEAR(at->film_w_k, air + water, 1e-9);
        CHECK_NEAR(at->fluid_k, (285 * air + 279 * water) / (air + water), 1e-9);
        CHECK_NEAR(at->heat_w, 0.9 * (1 - wet) * 0.75 * 300, 1e-9);
        CHECK_NEAR(at->emits_m2, 0.9 * (1 - wet) * 0.75, 1e-12);
    }
}

/* A track that moves at less than 0.3 m/s stands: Carslaw & Jaeger 2.4, an hour of contact; faster it rolls: its print
 * over its speed. In series with 200 W/(m2 K) of gaps; from the ground in its shade, or in the open. */
static void contact_begins_to_roll(void **state)
{
    (void)state;
    static PatchView    view[patches];
    static const double v[] = {0, 0.29, 0.32, 5};
    NetworkLoad         load[64];
    double              temp_k[64] = {0};
    const PlaceHeat     where = {.air_k = 285, .air_density = 1, .ground_k = 300, .under_k = 270};
    for (int c = 0; c < 4; c++) {
        VehicleMoment m = moment_of(&where, tank);
        vehicle_loads(load, &m, view, temp_k, &(EntityDrives){.speed_mps = (float)v[c]});
        const double e = sqrt((double)0.9f * 4e6), t_s = c < 2 ? 3600 : 1.5 / v[c], film = 6.3 * 4;
        const double touch =
            (c < 2 ? 1.5 : 2.25 * 6.3 / 13.5) / (sqrt(pi_rad * t_s) * (e + 1000) / (2 * e * 1000) + 1.0 / 200);
        CHECK_NEAR(load[shape.skin[track].surface].film_w_k, film + touch, 1e-6);
        CHECK_NEAR(load[shape.skin[track].surface].fluid_k, (film * 285 + touch * (c < 2 ? 270 : 300)) / (film + touch),
                   1e-6);
    }
}

/* Views are of a pose while it is within 10 degrees, 0.3 m of height (below 1.5 m), and 0.17 rad or m of every joint
 * that neither spins nor rolls; a step is over when what heats it has changed, or it has turned by that. */
static void what_ends_views_and_steps(void **state)
{
    (void)state;
    const PlaceHeat where = {.above_m = 0.5};
    VehicleState   *s = vehicle_state_create(&shape, &model);
    VehicleMoment   m = moment_of(&where, tank);
    CHECK(s != NULL);
    vehicle_state_look(s, &m);
    vehicle_state_stay(s, &m, 10);
    static const double heights[][3] = {{0.5, 0.79, 1}, {0.5, 0.82, 0}, {0.5, 0.21, 1}, {0.5, 0.18, 0},
                                        {1.3, 50, 1},   {1.1, 50, 0},   {9, 1.3, 1},    {9, 1.1, 0}};
    for (int k = 0; k < 8; k++) {
        s->view_above_m = heights[k][0], m.place.above_m = heights[k][1];
        CHECK(vehicle_state_sees(s, &m) == (heights[k][2] > 0));
    }
    s->view_above_m = m.place.above_m = 0.5;
    for (int side = -1; side <= 1; side += 2) {
        joint[0] = 0.16 * side;
        CHECK(vehicle_state_sees(s, &m));
        joint[0] = 0.18 * side;
        CHECK(!vehicle_state_sees(s, &m));
        node.roll_radius_m = 0.3;
        CHECK(vehicle_state_sees(s, &m));
        node.roll_radius_m = 0, node.spin_rps_moving = 3;
        CHECK(vehicle_state_sees(s, &m));
        node.spin_rps_moving = 0, joint[0] = 0;
    }
    static const double turn_deg[2] = {9.5, 10.5};
    for (int k = 0; k < 2; k++) {
        const double t = turn_deg[k] * rad_per_deg, rolled[9] = {0, cos(t), -sin(t), 1, 0, 0, 0, -sin(t), -cos(t)},
                     turned[9] = {sin(t), cos(t), 0, cos(t), -sin(t), 0, 0, 0, -1};
        memcpy(m.pose.r_enu_from_body, rolled, sizeof rolled);
        CHECK(vehicle_state_sees(s, &m) == (k == 0) && vehicle_state_changed(s, &entity, rolled) == (k == 1));
        memcpy(m.pose.r_enu_from_body, turned, sizeof turned);
        CHECK(vehicle_state_sees(s, &m)); /* a turn about the vertical changes no view, but the step */
        CHECK(vehicle_state_changed(s, &entity, turned) == (k == 1));
    }
    const double north[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    static const struct {
        EntityDrives a, b;
        bool         changed;
    } d[] = {{{.engine = 0.6f}, {.engine = 0.649f}, false},
             {{.engine = 0.6f}, {.engine = 0.652f}, true},
             {{.engine = 0.6f}, {.engine = 0.548f}, true},
             {{.speed_mps = 20}, {.speed_mps = 22.1f}, false},
             {{.speed_mps = 20}, {.speed_mps = 22.3f}, true},
             {{.speed_mps = 22.3f}, {.speed_mps = 20}, true},
             {{.speed_mps = 5}, {.speed_mps = 5.9f}, false},
             {{.speed_mps = 5}, {.speed_mps = 6.1f}, true},
             {{.burning = 0}, {.burning = 0.1f}, true},
             {{.motor = 1}, {.motor = 0}, true},
             {{.flare = 1}, {.flare = 0}, true},
             {{.alive = 1}, {.alive = 0}, true},
             {{.flying = 1}, {.flying = 0}, true},
             {{.fired_kg = {1, 0}}, {.fired_kg = {1.1, 0}}, true},
             {{.fired_kg = {0, 1}}, {.fired_kg = {0, 2}}, true}};
    for (size_t k = 0; k < sizeof d / sizeof *d; k++) {
        s->drives = d[k].a, entity.drives = d[k].b;
        CHECK(vehicle_state_changed(s, &entity, north) == d[k].changed);
    }
    /* straight between its own two times; what others read is as the tick began */
    double temp_k, sent_w_m2;
    s->t_s = 10, s->next_s = 20, s->now_k[hull] = 300, s->next_k[hull] = 310, s->sent_w_m2[hull] = 7,
    s->given[hull] = -1;
    static const double k_at[][2] = {{5, 300}, {10, 300}, {12.5, 302.5}, {20, 310}, {30, 310}};
    for (int k = 0; k < 5; k++) CHECK_NEAR(vehicle_state_k(s, NULL, hull, k_at[k][0]), k_at[k][1], 1e-4);
    CHECK(!vehicle_state_then(&temp_k, &sent_w_m2, s, hull, 15));
    s->shown = true;
    CHECK(vehicle_state_then(&temp_k, &sent_w_m2, s, hull, 15) && temp_k == 305 && sent_w_m2 == 7);
    vehicle_state_remember(s, patches, 15);
    s->now_k[hull] = s->next_k[hull] = 500, s->sent_w_m2[hull] = 9;
    CHECK(vehicle_state_then(&temp_k, &sent_w_m2, s, hull, 15) && temp_k == 305 && sent_w_m2 == 7);
    CHECK(vehicle_state_then(&temp_k, &sent_w_m2, s, hull, 16) && temp_k == 500 && sent_w_m2 == 9);
    s->was_shown = false;
    CHECK(!vehicle_state_then(&temp_k, &sent_w_m2, s, hull, 15) &&
          vehicle_state_then(&temp_k, &sent_w_m2, s, hull, 16));
    vehicle_state_destroy(s);
}

static unsigned why(double radius_m, double jet_m, double east_m, double north_m, const double sun[3], double v_mps,
                    bool resting)
{
    const NearBody body[2] = {{.id = {1, 1, 1}, .radius_m = 3},
                              {.id = {1, 1, 2},
                               .radius_m = radius_m,
                               .jet_m = jet_m,
                               .p_enu = {east_m, north_m, 0},
                               .v_enu_mps = {0, v_mps, 0}}};
    Neighbours     found;
    vehicle_neighbours_find(&found, body, 2, 0, sun, resting);
    CHECK(found.left_out == 0 && found.count <= 1);
    return found.count ? found.of[0].why : 0;
}

/* One of 3 m beside another. It is seen while (radius / gap)^2 is 0.005 or more, a gap of 14.14 radii from the first's
 * own sphere; it stands before a sun whose half width has a tangent of 0.00465 within 215 radii, where the sun's ray
 * passes the spheres; a jet reaches its own length. Of the past, those count that do not move by 1 m/s. */
static void who_is_a_neighbour(void **state)
{
    (void)state;
    const double dark[3] = {0, 0, -1}, low = 1e-3, east[3] = {sqrt(1 - low * low), 0, low};
    CHECK(why(1, 0, 17.1, 0, dark, 0, false) == NEAR_SEEN && why(1, 0, 17.2, 0, dark, 0, false) == 0);
    CHECK(why(2, 0, 31.2, 0, dark, 0, false) == NEAR_SEEN && why(2, 0, 31.4, 0, dark, 0, false) == 0);
    CHECK(why(1, 0, 218, 0, east, 0, false) == NEAR_SUN && why(1, 0, 219, 0, east, 0, false) == 0);
    CHECK(why(1, 0, 100, 3.99, east, 0, false) == NEAR_SUN && why(1, 0, 100, 4.01, east, 0, false) == 0);
    CHECK(why(1, 0, -3.9, 0, east, 0, false) == (NEAR_SEEN | NEAR_SUN) &&
          why(1, 0, -4.1, 0, east, 0, false) == NEAR_SEEN);
    CHECK(why(1, 50, 0, 52.9, dark, 0, false) == NEAR_JET && why(1, 50, 0, 53.1, dark, 0, false) == 0);
    CHECK(why(1, 0, 10, 0, dark, 0.95, true) == NEAR_SEEN && why(1, 0, 10, 0, dark, 1.05, true) == 0);
    CHECK(why(1, 0, 10, 0, dark, 9, false) == NEAR_SEEN && why(0, 0, 10, 0, dark, 0, false) == 0);
    /* the largest shares first, ties by place; those beyond eight are counted */
    NearBody   body[12] = {{.radius_m = 3}};
    Neighbours found;
    for (int i = 1; i < 12; i++) body[i] = (NearBody){.radius_m = 1, .p_enu = {0, 6 + (i * 7 % 5), 0}};
    vehicle_neighbours_find(&found, body, 12, 0, dark, false);
    CHECK(found.count == 8 && found.left_out == 3);
    for (int k = 1; k < 8; k++)
        CHECK(found.of[k - 1].share > found.of[k].share ||
              (found.of[k - 1].share == found.of[k].share && found.of[k - 1].body < found.of[k].body));
    for (int k = 0; k < 8; k++) {
        const double away_m = body[found.of[k].body].p_enu[1];
        CHECK_NEAR(found.of[k].share, 1 / ((away_m - 3) * (away_m - 3)), 1e-12);
        CHECK_NEAR(found.of[k].fill, 1 / (away_m * away_m), 1e-12);
    }
}

/* Of entities with a hand's box as their model: a neighbour has moved by 0.3 m, or where it is seen alone by a
 * twentieth of its distance, or turned by 10 degrees; its exhaust may reach 400 radii of its outlet; one that stands
 * where the entity does counts for four in what its views cost. */
static void what_a_neighbour_changes(void **state)
{
    (void)state;
    const double     corner[2][3] = {{-2, -2, -2}, {2, 2, 0}}, dark[3] = {0, 0, -1}, sun[3] = {0, 0, 1};
    const ExhaustJet outlet = {.radius_m = 0.1, .speed_mps = 10, .excess_k = 100};
    Model            box;
    Tracer          *tracer;
    LocalFrame       frame;
    SnapshotEntity   e[2] = {{.id = {1, 1, 1}}, {.id = {1, 1, 2}}};
    const Snapshot   snapshot = {.count = 2, .entity = e};
    VehicleState    *s[2];
    NearBody         b[2];
    hand_box(&box, corner[0], corner[1]);
    box.radius_m = 3;
    const Model *models[1] = {&box};
    CHECK(tracer_create_models(&tracer, models, 1, "avx2") == STATUS_OK &&
          local_frame_at(&frame, &(Geodetic){0.7, 0.2, 0}) == STATUS_OK);
    for (int k = 0; k < 2; k++) {
        CHECK((s[k] = vehicle_state_create(&shape, &model)) != NULL);
        s[k]->index = k, s[k]->id = e[k].id;
    }
    NearScene scene = {&snapshot, tracer, &shape, &frame, s, b, 2};
    const struct {
        double at_m, to_m, turn_deg;
        bool   sunny, changed;
    } c[] = {{5, 5.24, 0, true, false},    {5, 5.32, 0, true, true},    {5, 5.24, 0, false, false},
             {20, 20.98, 0, false, false}, {20, 21.05, 0, false, true}, {5, 5, 9.5, false, false},
             {5, 5, 10.5, false, true},    {20, 200, 0, false, true},   {5, 5.32, 0, false, true}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        bool changed;
        int  left_out;
        free(s[0]->near), s[0]->near = NULL;
        for (int step = 0; step < 3; step++) { /* found; as it was; elsewhere */
            const double t = step == 2 ? c[k].turn_deg * rad_per_deg : 0,
                         r[9] = {sin(t), cos(t), 0, cos(t), -sin(t), 0, 0, 0, -1},
                         none[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
            m3_mul(e[0].r_ecef_from_body, frame.r_ecef_from_enu, none);
            m3_mul(e[1].r_ecef_from_body, frame.r_ecef_from_enu, r);
            ecef_from_enu(e[0].p_ecef, &frame, (const double[3]){0, 0, 0});
            ecef_from_enu(e[1].p_ecef, &frame, (const double[3]){0, step == 2 ? c[k].to_m : c[k].at_m, 0});
            vehicle_near_bodies(&scene);
            CHECK(vehicle_near_check(&changed, &left_out, &scene, 0, c[k].sunny ? sun : dark) == STATUS_OK);
            CHECK(changed == (step == 0 || (step == 2 && c[k].changed)));
            if (step == 0) CHECK_NEAR(s[0]->near->fill, 9 / (c[k].at_m * c[k].at_m), 1e-6);
        }
    }
    bool changed;
    int  left_out;
    free(s[0]->near), s[0]->near = NULL;
    memcpy(e[1].p_ecef, e[0].p_ecef, sizeof e[0].p_ecef);
    vehicle_near_bodies(&scene);
    CHECK(b[0].radius_m == 3 && b[1].jet_m == 0);
    CHECK(vehicle_near_check(&changed, &left_out, &scene, 0, dark) == STATUS_OK && s[0]->near->fill == 4);
    e[1].exhaust = &outlet;
    vehicle_near_bodies(&scene);
    CHECK(b[1].jet_m == 0); /* its engine stands */
    e[1].drives.engine = 0.6f;
    vehicle_near_bodies(&scene);
    CHECK_NEAR(b[1].jet_m, 40, 1e-12);
    for (int k = 0; k < 2; k++) vehicle_state_destroy(s[k]);
    tracer_destroy(tracer);
    hand_free(&box);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_and_links),           cmocka_unit_test(what_arrives_at_a_skin),
        cmocka_unit_test(water_takes_its_share),     cmocka_unit_test(contact_begins_to_roll),
        cmocka_unit_test(what_ends_views_and_steps), cmocka_unit_test(who_is_a_neighbour),
        cmocka_unit_test(what_a_neighbour_changes),
    };
    return cmocka_run_group_tests(tests, open_shape, close_shape);
}
