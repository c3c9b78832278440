/* tests/render/test_vehicle_loads.c: what heats and cools the nodes of a vehicle at a moment: from behind its skins,
 * from the ground under its tracks and wheels, by their friction. labels: physics */
#include "tests/render/vehicle_stage.h"

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 7, 1, 0, 0};

/* Loads of a type's model at a place, all of whose nodes have temperature 0; freed by the caller, shape destroyed. */
static NetworkLoad *loads_at(VehicleShape *shape, const DisEntityType type, EntityDrives drives, const PlaceHeat *where)
{
    static PatchView view[1024];
    static float     zeros[5][1024];
    Scene            s;
    place(&s, type, drives);
    CHECK(tracer_need(stage.tracer, s.entity.model) == STATUS_OK);
    const Model *model = tracer_model(stage.tracer, s.entity.model);
    CHECK(heat_patches_need(&stage.patches, s.entity.model, model) == STATUS_OK);
    const Patches *patches = &stage.patches.of[s.entity.model];
    CHECK(patches->count <= 1024 &&
          vehicle_shape_create(shape, patches, model, s.entity.model, &stage.table, &stage.materials) == STATUS_OK);
    NodePose    *node = calloc((size_t)model->node_count, sizeof *node);
    NetworkLoad *load = calloc((size_t)shape->nodes, sizeof *load);
    double      *temp_k = calloc((size_t)shape->nodes, sizeof *temp_k);
    CHECK(node && load && temp_k);
    model_pose(node, model, NULL);
    VehicleMoment moment = {.entity = &s.entity,
                            .model = model,
                            .shape = shape,
                            .pose = {.patches = patches, .model = model, .node = node},
                            .node = node,
                            .lit = zeros[0],
                            .gas_k = zeros[1],
                            .gas_mps = zeros[2],
                            .sent_w_m2 = zeros[3],
                            .place = *where};
    vehicle_loads(load, &moment, view, temp_k, &drives);
    free(node), free(temp_k);
    return load;
}

/* Heat that goes from behind the skins of a role to them at a moment, over their area and the excess of what is there
 * over the air: the film, W/(m2 K). In still air of 288 K the outer film takes nothing of a node at that; what is left
 * of film times excess is from behind. */
static NetworkLoad engine_load, cabin_load; /* of its model's, where it has them */

static double film_from_behind(const DisEntityType type, HeatRole role, EntityDrives drives, double behind_k)
{
    const double    air_k = 288;
    const PlaceHeat still = {.air_k = air_k, .air_density = 1, .water_k = air_k, .above_m = 50};
    VehicleShape    shape = {0};
    NetworkLoad    *load = loads_at(&shape, type, drives, &still);
    double          w = 0, m2 = 0;
    for (int i = 0; i < shape.patches->count; i++) {
        if (shape.patches->patch[i].role != role) continue;
        const SkinNode *skin = &shape.skin[i];
        const int       at = skin->row.inside == INSIDE_GRAIN ? skin->surface : skin->inner;
        w += load[at].film_w_k * (load[at].fluid_k - air_k), m2 += skin->area_m2;
    }
    CHECK(m2 > 0);
    if (shape.engine >= 0) engine_load = load[shape.engine];
    if (shape.cabin >= 0) cabin_load = load[shape.cabin];
    free(load);
    vehicle_shape_destroy(&shape);
    return w / m2 / (behind_k - air_k);
}

/* What the ground takes of tracks and wheels, W/K: two half-spaces brought together (Carslaw & Jaeger 2.4), after t
 * seconds 2 e s / (e + s) / sqrt(pi t) W/(m2 K) of skin's effusivity e and soil's s = 1000, in series with the 200
 * W/(m2 K) of the gaps between (0.025 W/(m K) of air over 0.13 mm); t is the print's length over the speed, an hour for
 * what stands. It is the excess of the film on the ground over that half a metre above it. */
static void ground_takes_what_contact_gives(void **state)
{
    (void)state;
    static const double speed_mps[] = {0, 5, 12};
    for (int k = 0; k < 6; k++) {
        const double       v = speed_mps[k / 2];
        const EntityDrives drives = {.speed_mps = (float)v};
        PlaceHeat          where = {.air_k = 288, .air_density = 1, .water_k = 288, .ground_k = 0, .above_m = 0.51};
        VehicleShape       shape = {0}, again = {0};
        NetworkLoad       *above = loads_at(&shape, k % 2 ? truck : tank, drives, &where);
        where.above_m = 0.49;
        NetworkLoad *on = loads_at(&again, k % 2 ? truck : tank, drives, &where);
        double      *want = calloc((size_t)shape.nodes, sizeof *want);
        int          count = 0;
        for (int i = 0; i < shape.patches->count; i++) {
            const SkinNode *skin = &shape.skin[i];
            if (!(skin->rolls_m2 > 0)) continue;
            const double t_s = v > 0 ? skin->print_m / v : 3600, e = skin->effusivity;
            const double contact_w_m2k = 2 * e * 1000 / (e + 1000) / sqrt(3.14159265358979 * t_s);
            want[skin->surface] += (v > 0 ? skin->rolls_m2 : skin->ground_m2) / (1 / contact_w_m2k + 1.0 / 200);
            count++;
        }
        CHECK(count > 0);
        for (int n = 0; n < shape.nodes; n++)
            CHECK_NEAR(on[n].film_w_k - above[n].film_w_k, want[n], 1e-9 * (1 + on[n].film_w_k));
        free(above), free(on), free(want);
        vehicle_shape_destroy(&shape), vehicle_shape_destroy(&again);
    }
}

/* Friction of what rolls (etc/heat.csv: W/m2 at 10 m/s, in proportion to speed, up to twice that): half of it goes in
 * at the surface, half behind the skin. Nothing else heats a node here: no light falls on it, all about it has 0 K. */
static void friction_heats_both_faces(void **state)
{
    (void)state;
    static const double at[][2] = {{5, 0.5}, {10, 1}, {15, 1.5}, {30, 2}}; /* m/s, share of the row's */
    const PlaceHeat     where = {.air_k = 288, .air_density = 1, .water_k = 288, .above_m = 0};
    for (int k = 0; k < 4; k++) {
        VehicleShape shape = {0};
        NetworkLoad *load = loads_at(&shape, tank, (EntityDrives){.speed_mps = (float)at[k][0]}, &where);
        double      *want = calloc((size_t)shape.nodes, sizeof *want), all = 0;
        for (int i = 0; i < shape.patches->count; i++) {
            const SkinNode *skin = &shape.skin[i];
            if (skin->row.drive != PART_DRIVE_MOTION) continue;
            const double w = skin->area_m2 * skin->friction * skin->row.drive_value * at[k][1];
            want[skin->surface] += w / 2, want[skin->inner] += w / 2, all += w;
        }
        CHECK(all > 0);
        for (int n = 0; n < shape.nodes; n++)
            if (n != shape.engine && n != shape.cabin) CHECK_NEAR(load[n].heat_w, want[n], 1e-6 * all);
        free(load), free(want);
        vehicle_shape_destroy(&shape);
    }
}

/* Films and temperatures behind the skins by each driver, from etc/heat.csv and heat_machines.csv: a tank's exhaust
 * louvres have 2 W/(m2 K) at rest and 60 at full power, its gas 750 K at full power; idling, at 0.6 of that, the gas is
 * half as far above the air (519 K) and the film 2 + 58 0.6 = 36.8; half way up from there, at 0.8, three quarters
 * (634.5 K) and 48.4. Without its engine there is no gas. A helicopter's casing has 2 and 40, its gas 650 K; a rocket
 * motor 250 at 2500 K, a person 20 through the skin and 5 through clothes at 310 K, a flare 4000 at 1900 K. */
static void what_is_behind_a_skin_follows_its_driver(void **state)
{
    (void)state;
    const DisEntityType person = {3, 1, 225, 1, 0, 0, 0}, missile = {2, 2, 225, 1, 0, 0, 0},
                        flare = {8, 2, 225, 2, 0, 0, 0}, helicopter = {1, 2, 225, 20, 1, 0, 0},
                        building = {1, 1, 225, 30, 1, 0, 0};
    const struct {
        DisEntityType type;
        HeatRole      role;
        EntityDrives  drives;
        double        behind_k, film_w_m2k;
    } c[] = {{tank, HEAT_EXHAUST, {.engine = 1}, 750, 60},
             {tank, HEAT_EXHAUST, {.engine = 0.6f}, 519, 36.8},
             {tank, HEAT_EXHAUST, {.engine = 0.8f}, 634.5, 48.4},
             {tank, HEAT_EXHAUST, {.engine = 0.3f}, 519, 19.4}, /* running down: as idling */
             {tank, HEAT_EXHAUST, {.engine = 0}, 519, 0},
             {helicopter, HEAT_TURBINE, {.engine = 1}, 650, 40},
             {helicopter, HEAT_TURBINE, {.engine = 0.6f}, 469, 24.8},
             {missile, HEAT_MOTOR, {.motor = 1}, 2500, 250},
             {missile, HEAT_MOTOR, {.motor = 0.5f}, 2500, 125},
             {missile, HEAT_MOTOR, {.engine = 1}, 2500, 0},
             {person, HEAT_SKIN, {.alive = 1}, 310, 20},
             {person, HEAT_CLOTHING, {.alive = 1}, 310, 5},
             {person, HEAT_SKIN, {.alive = 0.25f}, 310, 5},
             {person, HEAT_SKIN, {.engine = 1}, 310, 0},
             {building, HEAT_DWELLING, {.alive = 1}, 293, 2.5},
             {building, HEAT_WINDOW, {.alive = 1}, 293, 3.5},
             {building, HEAT_FLUE, {.alive = 1}, 400, 10},
             {flare, HEAT_FLARE, {.flare = 1}, 1900, 4000},
             {flare, HEAT_FLARE, {.flare = 0.5f}, 1900, 2000}};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        const double got = film_from_behind(c[i].type, c[i].role, c[i].drives, c[i].behind_k);
        CHECK_NEAR(got, c[i].film_w_m2k, 1e-4 * (c[i].film_w_m2k + 1)); /* shares are floats */
    }
    /* a tank's engine of 300 kW and 1000 kJ/K keeps 363 K, 75 K over the air; leaks go in 25000 s; its cabin has
     * 160 kJ/K, and 1500 W while the engine runs */
    static const double at[3][4] = {/* engine, its heat, its film, the cabin's heat */
                                    {0, 0, 40, 0},
                                    {0.6, 180e3, 2440, 1500},
                                    {1, 300e3, 4040, 1500}};
    for (int k = 0; k < 3; k++) {
        film_from_behind(tank, HEAT_EXHAUST, (EntityDrives){.engine = (float)at[k][0]}, 750);
        CHECK_NEAR(engine_load.heat_w, at[k][1], 0.1);
        CHECK_NEAR(engine_load.film_w_k, at[k][2], 0.01);
        CHECK_NEAR(engine_load.fluid_k, 288, 1e-9);
        CHECK_NEAR(cabin_load.heat_w, at[k][3], 1e-9);
        CHECK_NEAR(cabin_load.film_w_k, 6.4, 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_behind_a_skin_follows_its_driver),
        cmocka_unit_test(ground_takes_what_contact_gives),
        cmocka_unit_test(friction_heats_both_faces),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
