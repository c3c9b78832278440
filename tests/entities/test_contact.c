/* tests/entities/test_contact.c: land vehicles set onto the ground: on planes, where every answer is on paper, and far
 * from the origin, where the local vertical leans. labels: physics */
#include "entities/table/contact.h"
#include "tests/entities/entity_fixture.h"

/* One level of 2 m posts, z = base + slope_x x + slope_y y; slopes in eighths are exact in steps of 1/64 m. */
static Elevation plane(double half_m, double spacing_m, double base_m, double slope_x, double slope_y)
{
    Elevation    ground = {0};
    const int    n = (int)(2 * half_m / spacing_m) + 1;
    const double step_m = 1.0 / 64, z0_m = base_m - 500;
    assert_int_equal(
        elevation_level_create(&ground, 0, &(ElevationGrid){n, n, -half_m, -half_m, spacing_m, z0_m, step_m}),
        STATUS_OK);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            const double z_m = base_m + slope_x * (i * spacing_m - half_m) + slope_y * (j * spacing_m - half_m);
            elevation_set_post(&ground.level[0], i, j, (int32_t)lrint((z_m - z0_m) / step_m));
        }
    elevation_build_pyramids(&ground);
    return ground;
}

static LocalFrame frame_at(double lat_deg, double lon_deg)
{
    LocalFrame     frame;
    const Geodetic place = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, 0};
    assert_int_equal(local_frame_at(&frame, &place), STATUS_OK);
    return frame;
}

/* At an ENU place, level there or not, heading clockwise from north. */
static SnapshotEntity entity_at(const LocalFrame *frame, DisEntityType type, double x_m, double y_m, double z_m,
                                double heading_rad)
{
    SnapshotEntity e = {.type = type};
    const double   p_enu[3] = {x_m, y_m, z_m}, s = sin(heading_rad), c = cos(heading_rad);
    const double   r_enu_from_body[9] = {s, c, 0, c, -s, 0, 0, 0, -1}; /* columns: forward, right, down */
    const double   v_enu[3] = {10 * s, 10 * c, 0};
    ecef_from_enu(e.p_ecef, frame, p_enu);
    m3_mul(e.r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    m3_mul_v3(e.v_ecef_mps, frame->r_ecef_from_enu, v_enu);
    return e;
}

static const Model box = {.box_low = {-3, -1.5, -2}, .box_high = {5, 1.5, 0}}; /* its gun reaches 2 m beyond the bow */

static void it_lies_on_a_slope_as_paper_says(void **state)
{
    (void)state;
    const LocalFrame    frame = frame_at(44, -123);
    Elevation           ground = plane(200, 2, 30, 0.125, -0.25);
    const ContactGround contact = {.frame = &frame, .elevation = &ground};
    for (int n = 0; n < 24; n++) {
        const double   heading_rad = 0.26 * n, x_m = 3 * n - 40, y_m = 25 - 2 * n;
        SnapshotEntity e = entity_at(&frame, tank_type, x_m, y_m, 37, heading_rad);
        double         p_enu[3], r_enu_from_body[9], v_enu[3];
        contact_set(&e, &contact, &box);
        enu_from_ecef(p_enu, &frame, e.p_ecef);
        m3_tmul(r_enu_from_body, frame.r_ecef_from_enu, e.r_ecef_from_body);
        m3_tmul_v3(v_enu, frame.r_ecef_from_enu, e.v_ecef_mps);
        /* 50 m from the origin the vertical leans 8e-6: 0.1 mm of 10 m, and 1e-5 in direction */
        CHECK_NEAR(p_enu[0], x_m, 1e-3);
        CHECK_NEAR(p_enu[1], y_m, 1e-3);
        CHECK_NEAR(p_enu[2], 30 + 0.125 * p_enu[0] - 0.25 * p_enu[1], 1e-4);
        const double climb = 0.125 * sin(heading_rad) - 0.25 * cos(heading_rad), length = sqrt(1 + climb * climb);
        CHECK_NEAR(r_enu_from_body[0], sin(heading_rad) / length, 2e-5);
        CHECK_NEAR(r_enu_from_body[3], cos(heading_rad) / length, 2e-5);
        CHECK_NEAR(r_enu_from_body[6], climb / length, 2e-5);
        /* down is against the plane's normal (-1/8, 1/4, 1) */
        const double normal = sqrt(1 + 0.125 * 0.125 + 0.25 * 0.25);
        CHECK_NEAR(r_enu_from_body[2], 0.125 / normal, 2e-5);
        CHECK_NEAR(r_enu_from_body[5], -0.25 / normal, 2e-5);
        CHECK_NEAR(r_enu_from_body[8], -1 / normal, 2e-5);
        CHECK_NEAR(v_enu[2], 10 * climb, 1e-3);
        CHECK_NEAR(hypot(v_enu[0], v_enu[1]), 10, 1e-3);
        CHECK_NEAR(contact_above_m(&contact, e.p_ecef), 0, 1e-6);
    }
    elevation_destroy(&ground);
}

/* A slope of up to 45 degrees is a road, and it is followed; of what is steeper, such as a wall in a surface model, 45
 * degrees. */
static void it_leans_by_45_degrees_at_most(void **state)
{
    (void)state;
    static const double slope[] = {0.9375, 1.0625, 1.5, 4};
    const LocalFrame    frame = frame_at(44, -123);
    for (int k = 0; k < 4; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            Elevation           ground = plane(60, 2, 30, sign * slope[k], 0);
            const ContactGround contact = {.frame = &frame, .elevation = &ground};
            const double        want_rad = sign * atan(fmin(slope[k], 1));
            double              r_enu_from_body[9];
            SnapshotEntity e = entity_at(&frame, tank_type, 0, 0, 37, pi_rad / 2); /* to the east: uphill, or down */
            contact_set(&e, &contact, &box);
            m3_tmul(r_enu_from_body, frame.r_ecef_from_enu, e.r_ecef_from_body);
            CHECK_NEAR(asin(r_enu_from_body[6]), want_rad, 1e-5);
            CHECK_NEAR(r_enu_from_body[7], 0, 1e-5);
            e = entity_at(&frame, tank_type, 0, 0, 37, 0); /* to the north: it rolls; the right side is in the east */
            contact_set(&e, &contact, &box);
            m3_tmul(r_enu_from_body, frame.r_ecef_from_enu, e.r_ecef_from_body);
            CHECK_NEAR(r_enu_from_body[6], 0, 1e-5);
            CHECK_NEAR(asin(r_enu_from_body[7]), want_rad, 1e-5);
            elevation_destroy(&ground);
        }
}

/* 8 km out the vertical leans 1.25 mrad against ENU: a drop of 400 m is 0.5 m sideways. */
static void it_moves_along_the_local_vertical(void **state)
{
    (void)state;
    const LocalFrame     frame = frame_at(44, -123);
    Elevation            ground = plane(8200, 16, -20, 0, 0);
    const ContactGround  contact = {.frame = &frame, .elevation = &ground};
    SnapshotEntity       e = entity_at(&frame, truck_type, 8000, 0, 380, 0);
    const SnapshotEntity before = e;
    double               moved[3], r_ecef_from_enu[9], p_ecef[3], p_enu[3];
    Geodetic             place;
    contact_set(&e, &contact, &box);
    v3_sub(moved, before.p_ecef, e.p_ecef);
    enu_from_ecef(p_enu, &frame, e.p_ecef);
    CHECK_NEAR(p_enu[2], -20, 1e-6);
    CHECK_NEAR(p_enu[0], 8000 - 400 * 8000 / 6.387e6, 0.01); /* radius of the parallel's normal section at 44 degrees */
    assert_int_equal(geodetic_from_ecef(&place, before.p_ecef), STATUS_OK);
    assert_int_equal(ecef_from_geodetic(p_ecef, r_ecef_from_enu, &place), STATUS_OK);
    double up = 0;
    for (int k = 0; k < 3; k++) up += moved[k] / v3_length(moved) * r_ecef_from_enu[3 * k + 2];
    CHECK_NEAR(up, 1, 1e-12);
    elevation_destroy(&ground);
}

static void who_does_not_stand_stays(void **state)
{
    (void)state;
    const LocalFrame    frame = frame_at(44, -123);
    Elevation           ground = plane(100, 2, 30, 0.125, 0);
    const ContactGround contact = {.frame = &frame, .elevation = &ground}, none = {.frame = &frame};
    SnapshotEntity      e = entity_at(&frame, helicopter_type, 0, 0, 90, 1), before = e;
    contact_set(&e, &contact, &box);
    assert_memory_equal(&e, &before, sizeof e);
    e = before = entity_at(&frame, missile_type, 0, 0, 90, 1);
    contact_set(&e, &contact, &box);
    assert_memory_equal(&e, &before, sizeof e);
    e = before = entity_at(&frame, tank_type, 500, 0, 90, 1); /* beyond the ground */
    contact_set(&e, &contact, &box);
    assert_memory_equal(&e, &before, sizeof e);
    e = before = entity_at(&frame, tank_type, 0, 0, 90, 1);
    contact_set(&e, &none, &box);
    assert_memory_equal(&e, &before, sizeof e);
    CHECK(isnan(contact_above_m(&none, e.p_ecef)));

    /* on his back: down to the ground, but still on his back */
    e = entity_at(&frame, tank_type, 0, 0, 90, 1);
    for (int k = 0; k < 3; k++)
        for (int c = 1; c < 3; c++) e.r_ecef_from_body[3 * k + c] *= -1;
    before = e;
    contact_set(&e, &contact, &box);
    assert_memory_equal(e.r_ecef_from_body, before.r_ecef_from_body, sizeof e.r_ecef_from_body);
    CHECK_NEAR(contact_above_m(&contact, e.p_ecef), 0, 1e-6);
    elevation_destroy(&ground);
}

/* A plain at 50 m with a sea at 50 m east of it. */
static void misfits_alone_are_set_onto_an_invented_ground(void **state)
{
    (void)state;
    static const DisEntityType man = {.kind = 3}, house = {.kind = 5, .domain = 1}, crate = {.kind = 6},
                               ship = {1, 3, 225, 6, 1, 0, 0}, bunker = {.kind = 5, .domain = 4},
                               submarine = {1, 4, 225, 1, 0, 0, 0};
    const LocalFrame frame = frame_at(44, -123);
    LandscapeConfig  config = landscape_default_config();
    config.half_width_m = 1500, config.horizon_m = 1500, config.relief_m = 0;
    const GroundFix         fix = {.p_enu = {-300, 0, 50}};
    const CoastPlace        place[2] = {{-300, 0, false}, {300, 0, true}};
    const LandscapeEvidence said = {.fix = &fix, .fix_count = 1, .place = place, .place_count = 2, .sea_h_m = 50};
    Landscape               land;
    assert_int_equal(landscape_create_from(&land, &config, &frame, &said), STATUS_OK);
    const ContactGround contact = {.frame = &frame, .elevation = &land.elevation, .landscape = &land};
    const ContactGround all = {.frame = &frame, .elevation = &land.elevation};
    static const struct {
        DisEntityType type;
        double        x_m, above_m, v_up_mps, v_mps, left_m;
    } row[] = {
        {tank_type, -300, 0.09, 0, 10, 0.09},
        {tank_type, -300, -0.09, 0, 10, -0.09}, /* within what a fit leaves */
        {tank_type, -300, 20, 0, 10, 0},
        {tank_type, -300, -30, 0, 10, 0},
        {man, -300, 0.6, 0, 1, 0},
        {man, -300, -0.6, 0, 1, 0},
        {man, -300, 300, -5, 1, 300},
        {man, -300, 300, 0, 50, 300}, /* under a parachute, in an aircraft */
        {tank_type, -300, 900, 0, 80, 900},
        {tank_type, -300, -3, -4, 12, 0}, /* carried; down a hill */
        {house, -300, -4, 0, 0, 0},
        {crate, -300, 2, 0, 0, 0},
        {bunker, -300, -8, 0, 0, -8},
        {ship, 300, 1.4, 0, 8, 1.4},
        {ship, 300, -1.4, 0, 8, -1.4}, /* heave */
        {ship, 300, 12, 0, 8, 0},
        {ship, 300, -30, 0, 8, 0},
        {ship, -300, 40, 0, 8, 0},
        {tank_type, 300, 8, 0, 0, 8},
        {tank_type, 300, -2, 0, 0, 0}, /* on a deck; under water */
        {submarine, 300, -40, 0, 4, -40},
        {helicopter_type, -300, 40, 0, 0, 40},
        /* half way between what is left and what is set, 0.1 and 0.5 m (ships 1.5 and 3 m), half of it is left */
        {tank_type, -300, 0.3, 0, 10, 0.15},
        {tank_type, -300, -0.3, 0, 10, -0.15},
        {ship, 300, 2.25, 0, 8, 1.125},
        {ship, 300, -2.25, 0, 8, -1.125},
        /* carried or falling: beyond 60 m/s, people 12 m/s; downwards by more than 2 m/s, and than half of the way
           along */
        {tank_type, -300, 20, 0, 59.9, 0},
        {tank_type, -300, 20, 0, 60.1, 20},
        {man, -300, 20, 0, 11.9, 0},
        {man, -300, 20, 0, 12.1, 20},
        {tank_type, -300, 20, -1.95, 0, 0},
        {tank_type, -300, 20, -2.05, 0, 20},
        {tank_type, -300, 20, -4.95, 10, 0},
        {tank_type, -300, 20, -5.05, 10, 20},
    };
    for (size_t n = 0; n < sizeof row / sizeof row[0]; n++) {
        const double   z_m = elevation_height(&land.elevation, row[n].x_m, 0, NULL) + row[n].above_m;
        SnapshotEntity e = entity_at(&frame, row[n].type, row[n].x_m, 0, z_m, 0.4);
        const double   v_enu[3] = {row[n].v_mps, 0, row[n].v_up_mps};
        m3_mul_v3(e.v_ecef_mps, frame.r_ecef_from_enu, v_enu);
        const SnapshotEntity before = e;
        contact_set(&e, &contact, &box);
        const double left_m = contact_above_m(&contact, e.p_ecef);
        if (!(fabs(left_m - row[n].left_m) <= 2e-3))
            fail_msg("row %d: %.4f above, want %g", (int)n, left_m, row[n].left_m);
        if (row[n].left_m == row[n].above_m) assert_memory_equal(&e, &before, sizeof e); /* to the bit */
        if (row[n].type.kind != 1 || row[n].type.domain != 1)
            if (row[n].type.kind != 3)
                assert_memory_equal(e.r_ecef_from_body, before.r_ecef_from_body, sizeof e.r_ecef_from_body);
        e = before; /* all: no standing entity is excepted; ships are not meant */
        contact_set(&e, &all, &box);
        if (contact_applies(row[n].type)) CHECK_NEAR(contact_above_m(&all, e.p_ecef), 0, 2e-3);
        else assert_memory_equal(&e, &before, sizeof e);
    }
    /* no jump on the way from as sent to set onto */
    double last_m = 0.09;
    for (double above_m = 0.09; above_m < 0.6; above_m += 0.001) {
        SnapshotEntity e =
            entity_at(&frame, tank_type, -300, 0, elevation_height(&land.elevation, -300, 0, NULL) + above_m, 1);
        contact_set(&e, &contact, &box);
        const double left_m = contact_above_m(&contact, e.p_ecef);
        CHECK_NEAR(left_m, last_m, 0.003);
        last_m = left_m;
    }
    /* 0.3 m above level ground, half of the way: half of the tilt is left, as slopes along and across of the plane that
     * the body stands on, whose normal (-across, -along, 1) is its axis up */
    static const double slope[3][2] = {{0.25, 0}, {0, -0.25}, {0.2, -0.1}};
    for (int k = 0; k < 3; k++) {
        SnapshotEntity e =
            entity_at(&frame, tank_type, -300, 0, elevation_height(&land.elevation, -300, 0, NULL) + 0.3, 0);
        const double along = slope[k][0], across = slope[k][1], length = sqrt(1 + along * along);
        const double x[3] = {0, 1 / length, along / length}, aside[3] = {1, 0, across};
        double       y[3], z[3], r_enu_from_body[9];
        v3_cross(z, x, aside);
        CHECK(v3_normalize(z, z));
        v3_cross(y, z, x);
        for (int i = 0; i < 3; i++)
            r_enu_from_body[3 * i] = x[i], r_enu_from_body[3 * i + 1] = y[i], r_enu_from_body[3 * i + 2] = z[i];
        m3_mul(e.r_ecef_from_body, frame.r_ecef_from_enu, r_enu_from_body);
        contact_set(&e, &contact, &box);
        m3_tmul(r_enu_from_body, frame.r_ecef_from_enu, e.r_ecef_from_body);
        CHECK_NEAR(-r_enu_from_body[5] / r_enu_from_body[8], 0.5 * along, 1e-3);
        CHECK_NEAR(-r_enu_from_body[2] / r_enu_from_body[8], 0.5 * across, 1e-3);
    }
    landscape_destroy(&land);
}

/* Snapshot, single pose and so the aim agree to the bit, and stand on the ground. */
/* Over other ground than its sender's an aircraft flies in the air, not in a mountain. */
static void aircraft_are_lifted_out_of_the_ground(void **state)
{
    (void)state;
    const LocalFrame    frame = frame_at(40, 0);
    Elevation           ground = plane(200, 2, 7, 0.125, 0);
    const ContactGround all = {.frame = &frame, .elevation = &ground};
    static const struct {
        double above_m, speed_mps, want_m;
    } cases[] = {{50, 60, 50}, {0.5, 60, 0.5}, {-3, 60, 3},    {-19, 60, 19},  {-300, 60, 20},
                 {-4, 0, 0},   {2, 0, 2},      {-10, 0.29, 0}, {-10, 0.31, 10}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        SnapshotEntity e = entity_at(&frame, helicopter_type, 40, 10, 7 + 0.125 * 40 + cases[k].above_m, 1);
        for (int i = 0; i < 3; i++) e.v_ecef_mps[i] *= cases[k].speed_mps / 10;
        const SnapshotEntity before = e;
        contact_set(&e, &all, &box);
        CHECK_NEAR(contact_above_m(&all, e.p_ecef), cases[k].want_m, 0.01);
        assert_memory_equal(e.r_ecef_from_body, before.r_ecef_from_body, sizeof e.r_ecef_from_body);
        if (cases[k].above_m >= 0) assert_memory_equal(e.p_ecef, before.p_ecef, sizeof e.p_ecef);
    }
    elevation_destroy(&ground);
}

static void every_pose_handed_out_stands(void **state)
{
    (void)state;
    const LocalFrame  frame = frame_at(0, 0);
    Elevation         ground = plane(200, 2, 7, 0.125, 0.125);
    EntityTableConfig config = entity_table_default_config();
    config.ground = (ContactGround){.frame = &frame, .elevation = &ground};
    Fixture        f = fixture_open(&config);
    DisEntityState tank = report(1, tank_type), flyer = report(2, helicopter_type);
    tank.velocity_mps[2] = 5;
    flyer.p_ecef[0] += 30; /* above the ground */
    hear(&f, &tank, 0);
    hear(&f, &flyer, 0);
    for (double t_s = 0; t_s < 3; t_s += 0.7) {
        SnapshotEntity        pose;
        const SnapshotEntity *e = seen_at(&f, 1, t_s);
        CHECK(e && entity_table_pose(&pose, f.table, entity_table_find(f.table, entity_id(1)), t_s));
        CHECK_NEAR(contact_above_m(&config.ground, e->p_ecef), 0, 1e-6);
        assert_memory_equal(pose.p_ecef, e->p_ecef, sizeof e->p_ecef);
        assert_memory_equal(pose.r_ecef_from_body, e->r_ecef_from_body, sizeof e->r_ecef_from_body);
        e = seen_at(&f, 2, t_s);
        CHECK(e && fabs(e->p_ecef[0] - earth_radius_m - 30) < 1e-6);
    }
    fixture_close(&f);
    elevation_destroy(&ground);
}

/* Dust and fire of who was set onto the ground are there too, and so is a burst that its sender calls one on the
 * ground; a burst in the air stays where it was sent. */
static void what_he_gives_off_goes_with_him(void **state)
{
    (void)state;
    const LocalFrame  frame = frame_at(0, 0);
    Elevation         ground = plane(200, 2, -40, 0.125, 0.125); /* 40 m below where everything is sent */
    EntityTableConfig config = entity_table_default_config();
    config.ground = (ContactGround){.frame = &frame, .elevation = &ground};
    Fixture        f = fixture_open(&config);
    DisEntityState tank = report(1, tank_type);
    tank.velocity_mps[2] = 8;
    tank.appearance = UINT32_C(1) << 15 | UINT32_C(2) << 7; /* burns, and raises dust */
    hear(&f, &tank, 0);
    DisDetonation burst = {.munition = entity_id(9),
                           .event = {1, 3001, 9},
                           .p_ecef = {earth_radius_m, 20, 30},
                           .result = 3,
                           .descriptor = {{2, 2, 225, 1, 1, 3, 0}, 1000, 1000, 1, 0}};
    entity_table_detonation(f.table, &burst, 2.5);
    burst.event.number = 10;
    burst.result = 5;
    entity_table_detonation(f.table, &burst, 2.5);
    CHECK(seen_at(&f, 1, 3) != NULL);
    int low = 0, high = 0;
    for (int i = 0; i < f.snapshot.puff_count; i++) {
        const double above_m = contact_above_m(&config.ground, f.snapshot.puff[i].p_ecef);
        const bool   trail = f.snapshot.puff[i].kind == EFFECT_FLAME || f.snapshot.puff[i].kind == EFFECT_DUST;
        if (trail || above_m < 10) {
            CHECK(above_m > 0 && above_m < 5); /* a tank is 2.5 m high; pieces of a burst of 4 kg start within 2 m */
            low++;
        } else {
            CHECK(above_m > 30); /* the ground rises by 6 m from here to the burst */
            high++;
        }
    }
    CHECK(low > 30 && high > 5);
    fixture_close(&f);
    elevation_destroy(&ground);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_lies_on_a_slope_as_paper_says),
        cmocka_unit_test(it_leans_by_45_degrees_at_most),
        cmocka_unit_test(it_moves_along_the_local_vertical),
        cmocka_unit_test(who_does_not_stand_stays),
        cmocka_unit_test(misfits_alone_are_set_onto_an_invented_ground),
        cmocka_unit_test(aircraft_are_lifted_out_of_the_ground),
        cmocka_unit_test(every_pose_handed_out_stands),
        cmocka_unit_test(what_he_gives_off_goes_with_him),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
