/* tests/entities/test_drives.c: what counts as evidence of what heats an entity. labels: physics */
#include "tests/entities/entity_fixture.h"
#include "entities/table/snapshot.h"

static EntityDrives at(const DriveState *s, double t_s)
{
    EntityDrives d;
    drives_at(&d, s, t_s);
    return d;
}

/* No power-plant bit: moving is evidence, for two minutes after it stopped; the bit alone is evidence too. */
static void engine_is_inferred(void **state)
{
    (void)state;
    const DriveEvidence drives = {.type = truck_type, .speed_mps = 3}, stands = {.type = truck_type};
    const DriveEvidence idles = {.type = truck_type, .appearance = power_plant_bit},
                        crawls = {.type = truck_type, .speed_mps = 0.1},
                        wreck = {.type = truck_type, .speed_mps = 12, .appearance = 3 << 3};
    DriveState s;

    drives_begin(&s, &stands, 0);
    CHECK(drives_run_until(&s) == -INFINITY && at(&s, 1).engine == 0);
    drives_report(&s, &crawls, 1);
    CHECK(drives_run_until(&s) == -INFINITY);
    drives_report(&s, &drives, 2);
    CHECK(drives_run_until(&s) == INFINITY && at(&s, 50).engine > 0.6f && at(&s, 50).speed_mps == 3);
    drives_report(&s, &stands, 100);
    drives_report(&s, &stands, 105);
    CHECK(drives_run_until(&s) == 220);
    CHECK(at(&s, 219).engine > 0.5f && at(&s, 221).engine == 0);
    drives_report(&s, &idles, 300);
    CHECK(drives_run_until(&s) == INFINITY && at(&s, 1e4).engine > 0.5f);
    drives_report(&s, &wreck, 400);
    CHECK(drives_run_until(&s) == -INFINITY && at(&s, 401).engine == 0);
    CHECK(at(&s, 401).since_s == 0);
}

/* More speed is more engine, up to full power. */
static void speed_is_power(void **state)
{
    (void)state;
    float before = 0;
    for (double v = 1; v <= 10; v += 1) {
        DriveState s;
        drives_begin(&s, &(DriveEvidence){.type = tank_type, .speed_mps = v}, 0);
        CHECK(at(&s, 1).engine > before && at(&s, 1).engine <= 1);
        before = at(&s, 1).engine;
    }
    CHECK_NEAR(before, 1, 1e-6);
}

/* Uphill and in turns the engine gives more, downhill less, never less than idling or more than all; nonsense counts
 * as nothing. */
static void slopes_and_turns_are_power(void **state)
{
    (void)state;
    static const struct {
        double speed_mps, climb_mps, turn_rps, want;
    } c[] = {{5, 0, 0, 0.8},    {5, 0.3, 0, 0.9},   {5, -0.3, 0, 0.7}, {5, -9, 0, 0.6},       {5, 9, 0, 1},
             {5, 0, 0.25, 0.9}, {5, 0, -0.25, 0.9}, {5, NAN, 0, 0.8},  {5, 0, INFINITY, 0.8}, {5, -INFINITY, NAN, 0.8}};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        DriveState s;
        drives_begin(
            &s,
            &(DriveEvidence){
                .type = tank_type, .speed_mps = c[i].speed_mps, .climb_mps = c[i].climb_mps, .turn_rps = c[i].turn_rps},
            0);
        CHECK_NEAR(at(&s, 1).engine, c[i].want, 1e-6);
    }
}

/* Helicopters of a sender that never sets the bit fly all the same; their wrecks do not. */
static void flight_is_evidence(void **state)
{
    (void)state;
    const DriveEvidence hovers = {.type = helicopter_type}, wreck = {.type = helicopter_type, .appearance = 3 << 3};
    DriveState          s;
    drives_begin(&s, &hovers, 0);
    CHECK(at(&s, 0).engine == 1 && at(&s, 0).flying == 1 && drives_run_until(&s) == INFINITY);
    drives_begin(&s, &wreck, 0);
    CHECK(at(&s, 0).engine == 0 && at(&s, 0).flying == 0);
}

/* A wreck burns for ten minutes when it was seen to be hit; found destroyed it is cold, or burns while it flames. */
static void wrecks_burn_out(void **state)
{
    (void)state;
    const DriveEvidence stands = {.type = tank_type}, wreck = {.type = tank_type, .appearance = 3 << 3},
                        flames = {.type = tank_type, .appearance = 3 << 3 | 1 << 15};
    DriveState s;
    drives_begin(&s, &stands, 0);
    CHECK(at(&s, 5).burning == 0);
    drives_report(&s, &wreck, 10);
    CHECK(at(&s, 11).burning == 1 && at(&s, 609).burning == 1 && at(&s, 611).burning == 0);
    drives_report(&s, &wreck, 300);
    CHECK(at(&s, 609).burning == 1 && at(&s, 611).burning == 0);
    drives_begin(&s, &wreck, 0);
    CHECK(at(&s, 1).burning == 0);
    drives_report(&s, &flames, 20);
    CHECK(at(&s, 1e5).burning == 1);
}

/* Engine smoke is an engine that runs, but for a wreck's; a plume from what is damaged smoulders, from what is whole
 * it is a screen. */
static void smoke_is_evidence(void **state)
{
    (void)state;
    static const struct {
        uint32_t smoke, damage;
        float    engine, burning;
    } c[] = {{0, 0, 0, 0},    {1, 0, 0, 0},       {2, 0, 0.6f, 0}, {3, 0, 0.6f, 0},
             {1, 1, 0, 0.1f}, {3, 2, 0.6f, 0.1f}, {1, 3, 0, 0.1f}, {2, 3, 0, 0}};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        DriveState    s;
        DriveEvidence e = {.type = tank_type, .appearance = c[i].smoke << 5 | c[i].damage << 3};
        drives_begin(&s, &e, 0);
        CHECK(at(&s, 1e4).engine == c[i].engine && at(&s, 1e4).burning == c[i].burning);
        e.appearance |= 1 << 15;
        drives_report(&s, &e, 1);
        CHECK(at(&s, 1e4).burning == 1); /* flames are more */
    }
}

/* Shots add up, by the size of the charge, and stay finite. */
static void shots_add_up(void **state)
{
    (void)state;
    DriveState s;
    drives_begin(&s, &(DriveEvidence){.type = tank_type}, 0);
    drives_fire(&s, 8, 1);
    drives_fire(&s, 8, 2);
    drives_fire(&s, 0.005, 100);
    CHECK_NEAR(at(&s, 1).fired_kg[1], 24, 1e-9);
    CHECK_NEAR(at(&s, 1).fired_kg[0], 0.5, 1e-9);
    for (int k = 0; k < 100; k++) drives_fire(&s, 1e300, 1000);
    drives_fire(&s, NAN, 1), drives_fire(&s, -1, 1);
    CHECK(isfinite(at(&s, 1).fired_kg[1]) && at(&s, 1).fired_kg[1] > 0);
}

/* What is above 0.3 m/s moves; half of 10 m/s is half the load between idling at 0.6 and full power; shots of 1 kg and
 * more are of large guns; all shots of an exercise are at most 1e9 kg; an expendable's grain burns, a munition's motor,
 * neither the other's, and a platform has none. */
static void limits_are_where_they_are_said(void **state)
{
    (void)state;
    DriveState s;
    for (int over = 0; over < 2; over++) {
        drives_begin(&s, &(DriveEvidence){.type = truck_type, .speed_mps = over ? 0.301 : 0.299}, 0);
        CHECK_NEAR((double)at(&s, 1).engine, over ? 0.6 + 0.4 * 0.0301 : 0, 1e-6);
        drives_begin(&s, &(DriveEvidence){.type = tank_type, .speed_mps = over ? 9.9 : 5}, 0);
        CHECK_NEAR((double)at(&s, 1).engine, over ? 0.996 : 0.8, 1e-6);
        drives_fire(&s, over ? 1 : 0.999, 1);
        CHECK(s.fired_kg[over] > 0 && s.fired_kg[!over] == 0);
    }
    drives_fire(&s, 9e8, 1), drives_fire(&s, 9e8, 1);
    CHECK(s.fired_kg[1] == 1e9);
    static const DisEntityType types[3] = {{1, 1, 222, 1, 1, 1, 0}, {2, 2, 225, 1, 1, 3, 0}, {8, 2, 225, 2, 0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        drives_begin(&s, &(DriveEvidence){.type = types[k]}, 0);
        CHECK(at(&s, 1).motor == (k == 1) && at(&s, 1).flare == (k == 2));
    }
}

/* A motor burns two seconds from the first report and from its launch, a flare four. */
static void short_lives(void **state)
{
    (void)state;
    DriveState s;
    drives_begin(&s, &(DriveEvidence){.type = missile_type, .speed_mps = 300}, 10);
    CHECK(at(&s, 10).motor == 1 && at(&s, 11.9).motor == 1 && at(&s, 12.1).motor == 0);
    drives_launch(&s, 20);
    CHECK(at(&s, 21).motor == 1 && at(&s, 23).motor == 0);
    drives_begin(&s, &(DriveEvidence){.type = {8, 2, 225, 2, 0, 0, 0}}, 200);
    drives_report(&s, &(DriveEvidence){.type = {8, 2, 225, 2, 0, 0, 0}, .speed_mps = 60}, 202);
    CHECK(at(&s, 203).flare == 1 && at(&s, 204.1).flare == 0 && at(&s, 203).motor == 0);
}

/* People until they are fatally injured, houses until they are destroyed; neither has an engine. */
static void what_lives(void **state)
{
    (void)state;
    DriveState s;
    drives_begin(&s, &(DriveEvidence){.type = {3, 1, 225, 1, 0, 0, 0}}, 0);
    CHECK(at(&s, 1).alive == 1 && at(&s, 1).engine == 0);
    drives_report(&s, &(DriveEvidence){.type = {3, 1, 225, 1, 0, 0, 0}, .appearance = 3 << 3}, 5);
    CHECK(at(&s, 6).alive == 0 && at(&s, 6).burning == 0);
    drives_begin(&s, &(DriveEvidence){.type = {5, 1, 225, 11, 0, 0, 0}}, 0);
    CHECK(at(&s, 1).alive == 1);
    drives_begin(&s, &(DriveEvidence){.type = tank_type}, 0);
    CHECK(at(&s, 1).alive == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engine_is_inferred),
        cmocka_unit_test(speed_is_power),
        cmocka_unit_test(slopes_and_turns_are_power),
        cmocka_unit_test(flight_is_evidence),
        cmocka_unit_test(wrecks_burn_out),
        cmocka_unit_test(smoke_is_evidence),
        cmocka_unit_test(shots_add_up),
        cmocka_unit_test(limits_are_where_they_are_said),
        cmocka_unit_test(short_lives),
        cmocka_unit_test(what_lives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
