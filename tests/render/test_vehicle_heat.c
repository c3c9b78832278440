/* tests/render/test_vehicle_heat.c: entities' temperatures over time, on weather from paper: nothing comes from
 * nothing, the sun's side is warm, engines, guns, exhausts, speed and bodies are what balances on paper give, and
 * the past decides. labels: physics */
#include "tests/render/vehicle_stage.h"

#include "render/heat/surface_flux_private.h"

static PlaceHeat weather;  /* at all times and places */
static double    sun_up_s; /* exercise time from which its sun shines; Unix time of exercise time 0 is 0 */
static double    ground_k_m, ground_k_s; /* by which its ground is warmer to the north, and with time */

static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)present;
    *out = weather;
    out->ground_k += ground_k_m * p_enu[1] + ground_k_s * unix_s;
    if (unix_s < sun_up_s) out->direct_w_m2 = out->diffuse_w_m2 = 0;
    return STATUS_OK;
}

/* All around, air too, at one temperature; no sun. */
static void enclose(double temp_k)
{
    sun_up_s = 0, ground_k_m = ground_k_s = 0;
    weather = (PlaceHeat){.air_k = temp_k,
                          .air_density = 1,
                          .longwave_w_m2 = stefan_w_m2k4 * pow(temp_k, 4),
                          .ground_k = temp_k,
                          .under_k = temp_k,
                          .water_k = temp_k,
                          .ground_rho = 0.2,
                          .sun_d_enu = {0, 0, 1}};
}

static const KeptHeat *last_run; /* NULL: none */

static VehicleHeat *start_limited(double step_s, double window_us)
{
    return stage_start(&(VehicleHeatConfig){.step_s = step_s, .window_us = window_us, .place = everywhere}, last_run);
}

static VehicleHeat *start(double step_s) { return start_limited(step_s, INFINITY); }

static void fly(Scene *s, double speed_mps)
{
    const double v_enu[3] = {0, speed_mps, 0};
    m3_mul_v3(s->entity.v_ecef_mps, stage.frame.r_ecef_from_enu, v_enu);
    s->entity.drives.speed_mps = (float)speed_mps;
}

/* Ticks each second until t_s. */
static void run(VehicleHeat *heat, Scene *s, double from_s, double to_s)
{
    for (double t_s = from_s; t_s <= to_s; t_s += 1) {
        s->snapshot.t_s = t_s;
        CHECK(vehicle_heat_tick(heat, &s->snapshot) == STATUS_OK);
    }
    CHECK(vehicle_heat_counters(heat)->failed == 0);
}

/* Mean by area of a role's patches on the side n (axes of their node; NULL: all) that face within 60 degrees of it,
 * at the snapshot's time. */
static double mean_k(const VehicleHeat *heat, Scene *s, HeatRole role, const double *n)
{
    double sum = 0, m2 = 0;
    CHECK(vehicle_heat_show(heat, &s->snapshot, stage.arena) == STATUS_OK);
    CHECK(s->entity.first_patch == 0);
    const Patches *p = &stage.patches.of[s->entity.model];
    for (int i = 0; i < p->count; i++) {
        if (p->patch[i].role != role) continue;
        if (n && !(p->patch[i].facing * v3_dot(p->patch[i].n_node, n) > 0.5 && v3_dot(p->patch[i].p_node, n) > 0))
            continue;
        sum += patch_open_m2(&p->patch[i]) * (double)s->snapshot.patch_k[i];
        m2 += patch_open_m2(&p->patch[i]);
    }
    return m2 > 0 ? sum / m2 : NAN;
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, person = {3, 1, 225, 1, 0, 0, 0},
                           missile = {2, 2, 225, 1, 0, 0, 0}, flare = {8, 2, 225, 2, 0, 0, 0},
                           jet = {1, 2, 225, 1, 0, 0, 0};

/* What is as warm as its surroundings stays so, however it is shaped, to the solver's tolerance. */
static void an_enclosure_stays_as_it_is(void **state)
{
    (void)state;
    for (double temp_k = 220; temp_k < 340; temp_k += 60) {
        Scene s;
        enclose(temp_k);
        VehicleHeat *heat = start(30);
        place(&s, tank, (EntityDrives){0});
        run(heat, &s, 0, 300);
        CHECK(vehicle_heat_show(heat, &s.snapshot, stage.arena) == STATUS_OK);
        double worst_k = 0;
        for (int i = 0; i < s.snapshot.patch_count; i++)
            worst_k = fmax(worst_k, fabs((double)s.snapshot.patch_k[i] - temp_k));
        print_message("enclosure of %g K: %.1e K\n", temp_k, worst_k);
        CHECK(worst_k < 1e-3);
        vehicle_heat_destroy(heat);
    }
}

/* The sun 30 degrees up in the east, for three hours: thin sheet follows its balance, armour is on its way. */
static void the_side_of_the_sun_is_warm(void **state)
{
    (void)state;
    static const double right[3] = {0, 1, 0}, left[3] = {0, -1, 0};
    Scene               s;
    enclose(285);
    weather.sun_d_enu[0] = cos(pi_rad / 6), weather.sun_d_enu[2] = 0.5;
    weather.direct_w_m2 = 700, weather.diffuse_w_m2 = 80;
    weather.longwave_w_m2 *= 0.8;
    weather.wind_enu_mps[0] = 2;
    sun_up_s = -3 * 3600;
    VehicleHeat *heat = start(30);
    place(&s, tank, (EntityDrives){0});
    run(heat, &s, 0, 2);
    const double east_k = mean_k(heat, &s, HEAT_PASSIVE, right), west_k = mean_k(heat, &s, HEAT_PASSIVE, left);
    const double turret_k = mean_k(heat, &s, HEAT_TURRET, right) - mean_k(heat, &s, HEAT_TURRET, left);
    print_message("sheet east %.1f, west %.1f K; turret east over west %.1f K\n", east_k, west_k, turret_k);
    /* 0.6 .. 0.94 x 606 W/m2 over 15 W/(m2 K) of film and emission, less what conduction takes round the corners */
    CHECK(east_k - west_k > 10 && east_k - west_k < 32);
    /* Armour of 60 mm (235 kJ/(m2 K)) that takes 0.595 x 700 x 0.8 = 333 W/m2 for three hours against 19 W/(m2 K) of
     * both sides' films would be 10 K warmer; conduction to the roof, 2.7 W/K by a metre's length and as much as half
     * of the films', takes up to two thirds of that. */
    CHECK(turret_k > 3.3 && turret_k < 8);
    vehicle_heat_destroy(heat);
}

/* An hour of driving, then forty minutes of standing; and three rounds. */
static void engines_warm_and_stay_warm(void **state)
{
    (void)state;
    static const double up[3] = {0, 0, -1};
    Scene               s;
    enclose(288);
    weather.wind_enu_mps[1] = 2;
    VehicleHeat *heat = start(30);
    place(&s, tank, (EntityDrives){.engine = 1, .speed_mps = 10});
    run(heat, &s, 0, 60);
    const double deck_k = mean_k(heat, &s, HEAT_ENGINE_DECK, up), gas_k = mean_k(heat, &s, HEAT_EXHAUST, NULL),
                 track_k = mean_k(heat, &s, HEAT_TRACK, NULL), hull_k = mean_k(heat, &s, HEAT_HULL, NULL);
    print_message("driving: deck %.1f, exhaust %.1f, tracks %.1f, hull %.1f K over the air\n", deck_k - 288,
                  gas_k - 288, track_k - 288, hull_k - 288);
    /* the engine has 363 K behind 15 W/(m2 K); outside there are 14.6 of the wind of 2 m/s and 5.4 of radiation */
    CHECK_NEAR(deck_k - 288, 75 * 15 / (15 + 14.6 + 5.4), 3);
    /* gas of 750 K behind 60 W/(m2 K): 372 K over the air without radiation, 291 K as a black body */
    CHECK(gas_k > 288 + 280 && gas_k < 288 + 372);
    /* 1500 W/m2 into 40 mm of steel, 151 kJ/(m2 K), over 14.6 and 5.3 W/(m2 K): 75 K in the end, 28.5 K in an hour,
     * less what the ground takes */
    CHECK(track_k > 288 + 20 && track_k < 288 + 29);
    CHECK(hull_k > 289.2 && hull_k < 293); /* a cabin of 1.5 kW, and what comes along from the deck: by 2 either way */

    s.entity.drives.engine = 0, s.entity.drives.speed_mps = 0;
    run(heat, &s, 61, 61 + 2400);
    const double after_k = mean_k(heat, &s, HEAT_ENGINE_DECK, up), cold_k = mean_k(heat, &s, HEAT_EXHAUST, NULL);
    print_message("forty minutes after the halt: deck %.1f, exhaust %.1f, tracks %.1f K\n", after_k - 288, cold_k - 288,
                  mean_k(heat, &s, HEAT_TRACK, NULL) - 288);
    /* its engine still has 68 K (leaks of 25000 s) behind a film of 6 instead of 15: 75 % of what the deck had, in the
     * end half; pipes are cold within 20 minutes but for what the deck gives them */
    CHECK(after_k > 288 + 16 && after_k < deck_k - 4 && cold_k < 306);

    const double bore_k = mean_k(heat, &s, HEAT_GUN, NULL);
    VehicleNodes before, after;
    CHECK(vehicle_heat_nodes(&before, heat, s.entity.id));
    const double held_j = heat_network_heat_j(before.shape->network, before.temp_k), in_j = before.heat_in_j;
    s.entity.drives.fired_kg[1] = 24;
    run(heat, &s, 2462, 2462);
    CHECK(vehicle_heat_nodes(&after, heat, s.entity.id));
    const double rise_j = heat_network_heat_j(after.shape->network, after.temp_k) - held_j;
    CHECK_NEAR(rise_j, after.heat_in_j - in_j, 1e-6 * (24 * 180e3)); /* what came from outside is in its nodes */
    run(heat, &s, 2463, 2462 + 300);
    const double shot_k = mean_k(heat, &s, HEAT_GUN, NULL) - bore_k;
    /* 24 kg give 180 kJ/kg to a wall of 40 mm of steel, 7824 kg/m3 of 500 J/(kg K): 6.9 K of the 4.0 m2 that the model
     * has. In five minutes a film of 15 W/(m2 K) takes 3 % of it, and what carries the gun some more. */
    const Patches *cut = &stage.patches.of[s.entity.model];
    double         gun_m2 = 0;
    for (int i = 0; i < cut->count; i++)
        if (cut->patch[i].role == HEAT_GUN) gun_m2 += patch_open_m2(&cut->patch[i]);
    const double want_k = 24 * 180e3 / (gun_m2 * 0.04 * 7824 * 500);
    print_message("three rounds, five minutes later: gun %.2f K warmer, of %.2f K\n", shot_k, want_k);
    CHECK(shot_k > 0.92 * want_k && shot_k < want_k);
    vehicle_heat_destroy(heat);
}

/* Kelvins over air of 288 K of a plate between gas that is excess_k warmer, by a film of inside W/(m2 K), and air at
 * rest, whose film is 4 W/(m2 K), with surroundings as warm as it: the root of its balance, by halving. */
static double plate_over_k(double inside_w_m2k, double excess_k, double emissivity)
{
    double low_k = 0, high_k = excess_k;
    for (int n = 0; n < 60; n++) {
        const double k = 0.5 * (low_k + high_k),
                     lost = 4 * k + emissivity * stefan_w_m2k4 * (pow(288 + k, 4) - pow(288, 4));
        *(inside_w_m2k * (excess_k - k) > lost ? &low_k : &high_k) = k;
    }
    return low_k;
}

/* A vehicle that stands at full power, at half of its load and at idle (shares of full power e of 1, 0.8 and 0.6): gas
 * is half as hot over the air at idle as at full power, 462 K (750 K of a tank, etc/heat_machines.csv), and in between
 * by the load; its film is 2 + (60 - 2) e (etc/heat.csv). The outlet's louvres see each other, so what share of their
 * radiation leaves is found from the temperature at full power; the other two follow from the balance, within 1 %. Gas
 * as hot at idle as at full power would be 1.7 times as warm an outlet. */
static void an_outlet_is_as_hot_as_its_engine_works(void **state)
{
    (void)state;
    static const double engine[] = {1, 0.8, 0.6}, excess_k[] = {462, 0.75 * 462, 0.5 * 462};
    double              over_k[3];
    enclose(288);
    for (int c = 0; c < 3; c++) {
        Scene        s;
        VehicleHeat *heat = start(30);
        place(&s, tank, (EntityDrives){.engine = (float)engine[c]});
        run(heat, &s, 0, 1800);
        over_k[c] = mean_k(heat, &s, HEAT_EXHAUST, NULL) - 288;
        vehicle_heat_destroy(heat);
    }
    const double black_w_m2 = stefan_w_m2k4 * (pow(288 + over_k[0], 4) - pow(288, 4));
    const double emissivity = (60 * (excess_k[0] - over_k[0]) - 4 * over_k[0]) / black_w_m2;
    print_message("outlet %.2f, %.2f and %.2f K over the air, emissivity %.3f\n", over_k[0], over_k[1], over_k[2],
                  emissivity);
    CHECK(emissivity > 0.45 && emissivity < 0.98); /* paint of 0.95 that sees half and more of what is around it */
    for (int c = 1; c < 3; c++) {
        const double want_k = plate_over_k(2 + 58 * engine[c], excess_k[c], emissivity);
        CHECK_NEAR(over_k[c], want_k, 0.01 * want_k);
    }
}

/* A jet as wide as the points of a patch lie apart, on the hull's rear, warms it, and the turret's front hardly;
 * away from the entity it warms nothing, nor does an engine that is off. */
static void exhaust_warms_what_it_blows_on(void **state)
{
    (void)state;
    static const double back[3] = {-1, 0, 0}, front[3] = {1, 0, 0};
    const ExhaustJet    across = {
           .at_body = {-5.5, 0, -0.95}, .d_body = {1, 0, 0}, .radius_m = 0.5, .speed_mps = 30, .excess_k = 300};
    const ExhaustJet away = {
        .at_body = {-5.5, 0, -0.95}, .d_body = {-1, 0, 0}, .radius_m = 0.5, .speed_mps = 30, .excess_k = 300};
    double back_k[4], front_k[4];
    enclose(288);
    for (int c = 0; c < 4; c++) { /* none, across, away, across without its engine */
        Scene        s;
        VehicleHeat *heat = start(30);
        place(&s, tank, (EntityDrives){.engine = c == 3 ? 0 : 0.6f});
        s.entity.exhaust = c == 0 ? NULL : c == 2 ? &away : &across;
        run(heat, &s, 0, 600);
        back_k[c] = mean_k(heat, &s, HEAT_HULL, back), front_k[c] = mean_k(heat, &s, HEAT_TURRET, front);
        vehicle_heat_destroy(heat);
    }
    print_message(
        "rear of the hull and front of the turret: no outlet %.2f %.2f K, one that blows on it %.2f %.2f K, one that blows away %.2f %.2f K\n",
        back_k[0], front_k[0], back_k[1], front_k[1], back_k[2], front_k[2]);
    CHECK(back_k[1] > back_k[0] + 10 && back_k[1] < 288 + 300);
    CHECK(fabs(front_k[1] - front_k[0]) < 0.1 * (back_k[1] - back_k[0]));
    CHECK(back_k[2] == back_k[0] && front_k[2] == front_k[0]);
    CHECK_NEAR(back_k[3], 288, 0.01);
}

/* A node that starts again ten minutes later goes on within a tenth of what an assumed past would be off; another
 * model's, older or broken files do not count. */
static void a_restart_goes_on(void **state)
{
    (void)state;
    char  path[text_file_size];
    Scene s;
    text_file(path, "");
    enclose(288);
    place(&s, tank, (EntityDrives){.engine = 1, .speed_mps = 10});
    VehicleHeat *whole = start(30);
    run(whole, &s, 0, 1200);
    s.entity.drives = (EntityDrives){.engine = 0.6f}; /* it halts: no assumed past knows that it drove */
    run(whole, &s, 1201, 1800);
    CHECK(vehicle_heat_keep(whole, path) == STATUS_OK);
    run(whole, &s, 1801, 2400);
    const double tracks_k = mean_k(whole, &s, HEAT_TRACK, NULL);
    double       again_k[3];
    for (int c = 0; c < 3; c++) { /* kept; not; kept too long ago */
        KeptHeat    *file = NULL;
        VehicleHeat *again;
        CHECK(heat_kept_open(&file, path) == STATUS_OK);
        last_run = c == 1 ? NULL : file;
        again = start(30);
        s.snapshot.t_s = c == 2 ? 40000 : 2400;
        CHECK(vehicle_heat_tick(again, &s.snapshot) == STATUS_OK);
        again_k[c] = mean_k(again, &s, HEAT_TRACK, NULL);
        vehicle_heat_destroy(again);
        heat_kept_close(file);
    }
    last_run = NULL;
    print_message("tracks after a restart %.2f K, unbroken %.2f K, with an assumed past %.2f K\n", again_k[0], tracks_k,
                  again_k[1]);
    CHECK(tracks_k > again_k[1] + 5);
    CHECK_NEAR(again_k[0], tracks_k, 0.1 * (tracks_k - again_k[1]));
    CHECK(again_k[2] == again_k[1]);
    static const char *const bad[] = {"entity,model,unix_s\n",
                                      "entity,model,unix_s,node_k\nx,tank,5,290\n",
                                      "entity,model,unix_s,node_k\n1:1:1,tank,nan,290\n",
                                      "entity,model,unix_s,node_k\n1:1:1,tank,5,\n",
                                      "entity,model,unix_s,node_k\n1:1:1,tank,5,290 x\n",
                                      "entity,model,unix_s,node_k\n1:1:1,tank,5,290 20000\n"};
    remove(path);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        KeptHeat *file = NULL;
        text_file(path, bad[i]);
        CHECK(heat_kept_open(&file, path) == STATUS_BAD_VALUE && !file);
        remove(path);
    }
    vehicle_heat_destroy(whole);
}

static void heat_is_kept(void **state)
{
    (void)state;
    Scene s;
    enclose(280);
    weather.sun_d_enu[2] = 1, weather.direct_w_m2 = 800;
    VehicleHeat *heat = start(30);
    place(&s, tank, (EntityDrives){.engine = 0.7f, .speed_mps = 5});
    run(heat, &s, 0, 0);
    VehicleNodes n;
    CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
    const double held_j = heat_network_heat_j(n.shape->network, n.temp_k), in_j = n.heat_in_j;
    run(heat, &s, 1, 600);
    CHECK(vehicle_heat_nodes(&n, heat, s.entity.id));
    const double gained_j = heat_network_heat_j(n.shape->network, n.temp_k) - held_j;
    print_message("gained %.6g J, from outside %.6g J\n", gained_j, n.heat_in_j - in_j);
    CHECK(fabs(gained_j) > 1e5);
    CHECK_NEAR(gained_j, n.heat_in_j - in_j, 1e-6 * held_j);
    vehicle_heat_destroy(heat);
}

/* Skin of what flies fast: 0.85 v^2 / (2 cp), 26 K at 250 m/s, less what it radiates. */
static void speed_warms(void **state)
{
    (void)state;
    Scene s;
    enclose(250);
    VehicleHeat *heat = start(30);
    place(&s, jet, (EntityDrives){.engine = 1, .flying = 1});
    fly(&s, 250);
    run(heat, &s, 0, 5);
    const double skin_k = mean_k(heat, &s, HEAT_AIRFRAME, NULL) - 250;
    vehicle_heat_destroy(heat);
    heat = start(30);
    place(&s, missile, (EntityDrives){.motor = 1});
    fly(&s, 300);
    run(heat, &s, 0, 2);
    const double motor_k = mean_k(heat, &s, HEAT_MOTOR, NULL);
    s.entity.drives.motor = 0;
    run(heat, &s, 3, 40);
    const double nose_k = mean_k(heat, &s, HEAT_NOSE, NULL) - 250;
    print_message("airframe %.1f K at 250 m/s, nose %.1f K at 300 m/s, motor %.0f K after two seconds\n", skin_k,
                  nose_k, motor_k);
    CHECK(skin_k > 22 && skin_k < 30); /* parts of it are behind the engines */
    CHECK_NEAR(nose_k, 38.06, 2);
    /* Three ticks of a second: gas of 2500 K by 250 W/(m2 K) into 3 mm of steel, 11.7 kJ/(m2 K): 139 K; the air's
     * friction adds up to the 38 K that it gives to all of the missile. */
    CHECK(motor_k > 250 + 139 && motor_k < 250 + 139 + 38);
    vehicle_heat_destroy(heat);
}

/* A person in a room; a flare that burns four seconds. */
static void bodies_and_flares(void **state)
{
    (void)state;
    Scene s;
    enclose(293);
    VehicleHeat *heat = start(30);
    place(&s, person, (EntityDrives){.alive = 1});
    run(heat, &s, 0, 5);
    const double skin_k = mean_k(heat, &s, HEAT_SKIN, NULL), cloth_k = mean_k(heat, &s, HEAT_CLOTHING, NULL);
    print_message("skin %.1f, clothing %.1f K in a room of 293 K\n", skin_k, cloth_k);
    CHECK(skin_k > 303 && skin_k < 308 && cloth_k > 296 && cloth_k < 303); /* published: 303 .. 307 K */
    vehicle_heat_destroy(heat);
    heat = start(30);
    place(&s, flare, (EntityDrives){.flare = 1});
    run(heat, &s, 0, 3);
    const double ember_k = mean_k(heat, &s, HEAT_FLARE, NULL);
    s.entity.drives.flare = 0;
    run(heat, &s, 4, 60);
    print_message("flare %.0f K, a minute later %.0f K\n", ember_k, mean_k(heat, &s, HEAT_FLARE, NULL));
    CHECK(ember_k > 1500 && ember_k < 2000 && mean_k(heat, &s, HEAT_FLARE, NULL) < 600);
    vehicle_heat_destroy(heat);
}

/* Frames between ticks, and another entity beside it, change no bit; steps of 10 s against 30 s little. */
static void the_past_alone_decides(void **state)
{
    (void)state;
    Scene s;
    float kept[patches_most];
    enclose(288);
    weather.sun_d_enu[1] = 0.6, weather.sun_d_enu[2] = 0.8, weather.direct_w_m2 = 800;
    for (int k = 0; k < 3; k++) {
        VehicleHeat *heat = start(k == 2 ? 10 : 30);
        place(&s, tank, (EntityDrives){.engine = 0.6f});
        for (double t_s = 0; t_s <= 400; t_s += 1) {
            if (t_s == 100) s.entity.drives.fired_kg[1] = 8;
            run(heat, &s, t_s, t_s);
            s.snapshot.t_s = t_s + 0.37;
            if (k == 1) CHECK(vehicle_heat_show(heat, &s.snapshot, stage.arena) == STATUS_OK);
        }
        s.snapshot.t_s = 400.6;
        CHECK(vehicle_heat_show(heat, &s.snapshot, stage.arena) == STATUS_OK);
        double worst_k = 0;
        for (int i = 0; i < s.snapshot.patch_count; i++) {
            if (k == 0) kept[i] = s.snapshot.patch_k[i];
            worst_k = fmax(worst_k, fabs((double)(kept[i] - s.snapshot.patch_k[i])));
        }
        if (k == 1) CHECK(worst_k == 0);
        if (k == 2) print_message("steps of 30 s against 10 s: %.3f K\n", worst_k);
        CHECK(worst_k < 0.1);
        print_message("%llu steps, %.1f us each, %zu octets\n", (unsigned long long)vehicle_heat_counters(heat)->steps,
                      1e6 * vehicle_heat_counters(heat)->spent_s / (double)vehicle_heat_counters(heat)->steps,
                      vehicle_heat_bytes(heat));
        vehicle_heat_destroy(heat);
    }
}

/* It is less the ground where it is, at the frame's time: not that of its last step. */
static void contrast_is_to_the_ground_below(void **state)
{
    (void)state;
    Scene s;
    enclose(290);
    ground_k_m = 0.02, ground_k_s = -1e-3;
    VehicleHeat *heat = start(30);
    place(&s, tank, (EntityDrives){.engine = 1, .alive = true});
    fly(&s, 8);
    double most_lag_k = 0;
    for (int t_s = 0; t_s <= 200; t_s++) {
        const double p_enu[3] = {0, 8 * t_s, 0};
        VehicleNodes nodes;
        ecef_from_enu(s.entity.p_ecef, &stage.frame, p_enu);
        s.snapshot.t_s = t_s;
        CHECK(vehicle_heat_tick(heat, &s.snapshot) == STATUS_OK);
        CHECK(vehicle_heat_show(heat, &s.snapshot, stage.arena) == STATUS_OK);
        const Patches *p = &stage.patches.of[s.entity.model];
        double         sum = 0, m2 = 0;
        for (int i = 0; i < p->count; i++)
            sum += patch_open_m2(&p->patch[i]) * (double)s.snapshot.patch_k[i], m2 += patch_open_m2(&p->patch[i]);
        CHECK_NEAR((double)s.entity.dt_k, sum / m2 - (290 + 0.02 * 8 * t_s - 1e-3 * t_s), 2e-5);
        CHECK(vehicle_heat_nodes(&nodes, heat, s.entity.id));
        most_lag_k = fmax(most_lag_k, (0.02 * 8 - 1e-3) * (t_s - nodes.t_s));
    }
    CHECK(most_lag_k > 3); /* what the ground of its last step would be off by */
    vehicle_heat_destroy(heat);
    ground_k_m = ground_k_s = 0;
}

/* Of nine entities the last is left out of eight places, counted, and as warm as the air; one that goes is
 * forgotten. */
static void room_is_bounded(void **state)
{
    (void)state;
    enum { many = 9 };
    Scene          s;
    SnapshotEntity entity[many];
    SnapshotJoints joints[many] = {{0}};
    enclose(288);
    VehicleHeat *heat = start(30);
    place(&s, tank, (EntityDrives){0});
    for (int i = 0; i < many; i++) entity[i] = s.entity, entity[i].id.entity = (uint16_t)(i + 1);
    Snapshot all = {.count = many, .entity = entity, .joints = joints};
    CHECK(vehicle_heat_tick(heat, &all) == STATUS_OK && vehicle_heat_show(heat, &all, stage.arena) == STATUS_OK);
    CHECK(entity[7].first_patch >= 0 && entity[8].first_patch == -1 && vehicle_heat_counters(heat)->left_out == 1);
    const size_t full = vehicle_heat_bytes(heat);
    all.count = 2, all.t_s = 1;
    CHECK(vehicle_heat_tick(heat, &all) == STATUS_OK && vehicle_heat_bytes(heat) < full / 2);
    vehicle_heat_destroy(heat);
}

/* What appears at once is worked out one after the other, each before it is shown, and with the temperatures that it
 * has where nothing limits the work, but for the second or two that it began later; a change is not waited for by
 * all. */
static void crowds_wait(void **state)
{
    (void)state;
    enum { many = 8 };
    Scene          s;
    SnapshotEntity entity[many];
    SnapshotJoints joints[many] = {{0}};
    Snapshot       none = {0};
    VehicleHeat   *heat[2];
    static float   kept[many * patches_most];
    int            shown_before = 0, slowest = 0;
    enclose(288);
    weather.sun_d_enu[1] = 0.6, weather.sun_d_enu[2] = 0.8, weather.direct_w_m2 = 800;
    place(&s, tank, (EntityDrives){.engine = 0.6f});
    for (int i = 0; i < many; i++) { /* 100 m apart: none is the other's neighbour */
        const double p_enu[3] = {100 * i, 0, 0};
        entity[i] = s.entity, entity[i].id.entity = (uint16_t)(i + 1);
        ecef_from_enu(entity[i].p_ecef, &stage.frame, p_enu);
    }
    Snapshot all = {.count = many, .entity = entity, .joints = joints};
    heat[0] = start(30), heat[1] = start_limited(30, 3500);
    for (int k = 0; k < 2; k++) CHECK(vehicle_heat_tick(heat[k], &none) == STATUS_OK);
    for (int tick = 1; tick <= 300; tick++) {
        all.t_s = tick / 10.0;
        for (int k = 0; k < 2; k++) CHECK(vehicle_heat_tick(heat[k], &all) == STATUS_OK);
        CHECK(!vehicle_heat_waits(heat[0]));
        CHECK(vehicle_heat_show(heat[1], &all, stage.arena) == STATUS_OK);
        int shown = 0;
        for (int i = 0; i < many; i++) shown += entity[i].first_patch >= 0;
        CHECK(shown >= shown_before && shown - shown_before <= 2); /* one needs 1 ms and more */
        if (shown < many) slowest = tick;
        CHECK((shown == many) || vehicle_heat_waits(heat[1]));
        shown_before = shown;
    }
    print_message("%d tanks are warm after %.1f s\n", many, slowest / 10.0 + 0.1);
    CHECK(shown_before == many && slowest >= many / 2);
    CHECK(vehicle_heat_show(heat[0], &all, stage.arena) == STATUS_OK);
    memcpy(kept, all.patch_k, (size_t)all.patch_count * sizeof *kept);
    CHECK(vehicle_heat_show(heat[1], &all, stage.arena) == STATUS_OK);
    double worst_k = 0;
    for (int i = 0; i < all.patch_count; i++) worst_k = fmax(worst_k, fabs((double)(kept[i] - all.patch_k[i])));
    print_message("limited against not: %.3f K\n", worst_k);
    CHECK(worst_k < 0.5);
    for (int k = 0; k < 2; k++) vehicle_heat_destroy(heat[k]);
}

/* A model that is met after the first tick: its patches are cut by another thread, and its entity waits for a time
 * that depends on nothing but its size; then it begins as one whose patches were there. One that goes before that is
 * no trouble. */
static void a_new_model_is_cut_meanwhile(void **state)
{
    (void)state;
    static PatchSet own; /* of this world: nothing is cut yet */
    Scene           s;
    Snapshot        none = {0};
    VehicleHeat    *heat[2];
    const PatchSet  before = stage.patches;
    enclose(288);
    place(&s, tank, (EntityDrives){.engine = 1});
    CHECK(heat_patches_create(&own, catalog_model_count(stage.catalog)) == STATUS_OK);
    stage.patches = own;
    heat[0] = start_limited(30, 3500), heat[1] = start_limited(30, 3500);
    for (int k = 0; k < 2; k++) CHECK(vehicle_heat_tick(heat[k], &none) == STATUS_OK);
    const double wait_s = 0.1 + 15e-6 * catalog_model(stage.catalog, s.entity.model)->triangle_count;
    for (int tick = 1; tick <= 20; tick++) {
        s.snapshot.t_s = tick / 10.0;
        CHECK(vehicle_heat_tick(heat[0], &s.snapshot) == STATUS_OK &&
              vehicle_heat_show(heat[0], &s.snapshot, stage.arena) == STATUS_OK);
        if (s.snapshot.t_s < 0.1 + wait_s - 1e-9) CHECK(s.entity.first_patch == -1 && vehicle_heat_waits(heat[0]));
    }
    CHECK(s.entity.first_patch >= 0 && !vehicle_heat_waits(heat[0]));
    s.snapshot.t_s = 0.1; /* the other world meets it, and it goes at once */
    CHECK(vehicle_heat_tick(heat[1], &s.snapshot) == STATUS_OK);
    none.t_s = 5;
    CHECK(vehicle_heat_tick(heat[1], &none) == STATUS_OK);
    for (int k = 0; k < 2; k++) vehicle_heat_destroy(heat[k]);
    heat_patches_destroy(&stage.patches);
    stage.patches = before;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_model_is_cut_meanwhile),
        cmocka_unit_test(an_enclosure_stays_as_it_is),
        cmocka_unit_test(the_side_of_the_sun_is_warm),
        cmocka_unit_test(engines_warm_and_stay_warm),
        cmocka_unit_test(an_outlet_is_as_hot_as_its_engine_works),
        cmocka_unit_test(exhaust_warms_what_it_blows_on),
        cmocka_unit_test(a_restart_goes_on),
        cmocka_unit_test(heat_is_kept),
        cmocka_unit_test(speed_warms),
        cmocka_unit_test(bodies_and_flares),
        cmocka_unit_test(the_past_alone_decides),
        cmocka_unit_test(contrast_is_to_the_ground_below),
        cmocka_unit_test(room_is_bounded),
        cmocka_unit_test(crowds_wait),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
