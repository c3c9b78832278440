/* tests/entities/test_ground_marks.c: what is left on the ground, against drives known on paper; marks depend on PDUs
 * alone; bounds; files. */
#include "entities/traces/ground_marks.h"
#include "entities/table/entity_index.h"
#include "dis/pdu/pdu.h"
#include "tests/entities/entity_fixture.h"

enum { heartbeat_s = 5 };
static const DisEntityType person_type = {3, 1, 225, 1, 1, 0, 0}, house_type = {5, 1, 225, 1, 1, 0, 0};

/* North of the start by north_m, at speed_mps; DIS velocity is world. */
static DisEntityState driving(int entity, DisEntityType type, double north_m, double speed_mps)
{
    DisEntityState pdu = report(entity, type);
    pdu.p_ecef[2] = north_m;
    pdu.velocity_mps[2] = (float)speed_mps;
    return pdu;
}

static const GroundMarks *marks_at(Fixture *f, double t_s)
{
    arena_reset(f->arena);
    CHECK(entity_table_snapshot(&f->snapshot, f->table, t_s, f->arena) == STATUS_OK);
    return &f->snapshot.marks;
}

/* Length of all pieces; each begins where the one before it ends, in place and time. */
static double joined_m(const GroundMarks *m)
{
    double sum_m = 0, along[3];
    for (int i = 0; i < m->tracks; i++) {
        v3_sub(along, m->track[i].b_ecef, m->track[i].a_ecef);
        sum_m += v3_length(along);
        CHECK(m->track[i].b_s > m->track[i].a_s && v3_length(along) <= 50.0001);
        if (i == 0) continue;
        CHECK(memcmp(m->track[i].a_ecef, m->track[i - 1].b_ecef, sizeof m->track[i].a_ecef) == 0);
        CHECK(m->track[i].a_s == m->track[i - 1].b_s);
    }
    return sum_m;
}

static void same_marks(const GroundMarks *a, const GroundMarks *b)
{
    CHECK(a->stands == b->stands && a->tracks == b->tracks && a->burns == b->burns && a->forgotten == b->forgotten);
    CHECK(a->stands == 0 || memcmp(a->stand, b->stand, (size_t)a->stands * sizeof *a->stand) == 0);
    CHECK(a->burns == 0 || memcmp(a->burn, b->burn, (size_t)a->burns * sizeof *a->burn) == 0);
    for (int i = 0; i < a->tracks; i++) {
        const GroundTrack *p = &a->track[i], *q = &b->track[i];
        CHECK(memcmp(p, q, offsetof(GroundTrack, tracked)) == 0 && p->tracked == q->tracked);
    }
}

/* ---- a tank's day ---------------------------------------------------------------------------- */

static const double arrives_s = 20, leaves_s = 20 + 4 * 3600, ends_s = 20 + 4 * 3600 + 10;

/* 200 m north at 10 m/s, four hours there, on for 100 m. looks: snapshots on the way. */
static void drive_one(Fixture *f, DisEntityType type, int looks)
{
    for (int t_s = 0; t_s <= (int)ends_s; t_s += heartbeat_s) {
        const bool     first = t_s < (int)arrives_s, last = t_s >= (int)leaves_s;
        const double   north_m = first ? 10 * t_s : last ? 200 + 10 * (t_s - leaves_s) : 200;
        DisEntityState pdu = driving(1, type, north_m, first || last ? 10 : 0);
        hear(f, &pdu, t_s);
        for (int k = looks; k > 0; k--) (void)marks_at(f, t_s + 0.93 * heartbeat_s * k / looks);
        if (looks) entity_table_expire(f->table, t_s + 0.37 * heartbeat_s);
    }
}

static void drive(Fixture *f, int looks) { drive_one(f, tank_type, looks); }

static void a_tank_leaves_tracks_and_a_stand(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL);
    drive(&f, 0);
    const GroundMarks *m = marks_at(&f, ends_s);
    CHECK(m->stands == 1 && m->burns == 0 && m->forgotten == 0);
    const GroundStand    *s = &m->stand[0];
    const SnapshotEntity *e = &f.snapshot.entity[0];
    const Model          *model = catalog_model(f.catalog, e->model);
    CHECK(s->from_s == arrives_s && s->to_s == leaves_s && s->owner == entity_key(entity_id(1)) + 1);
    CHECK_NEAR(s->p_ecef[2], 200, 1e-9);
    /* its body shades the ground, not the air beside its gun, which is metres of the box of all of it */
    CHECK(s->low_m[0] == (float)model->box_low[0] && (double)s->high_m[0] < model->box_high[0] - 1.5);
    for (int k = 1; k < 3; k++) {
        CHECK_NEAR((double)s->low_m[k], model->box_low[k], k == 2 ? 0.4 : 1e-6); /* a machine gun is on top */
        CHECK_NEAR((double)s->high_m[k], model->box_high[k], 1e-6);
    }
    double tracks_m = 0; /* as far as its tracks reach ahead, and no more than a fender beyond */
    for (int p = 0; p < model->part_count; p++)
        for (int c = 0; model->part[p].role == HEAT_TRACK && c < 3 * model->part[p].triangle_count; c++) {
            const ModelPart *part = &model->part[p];
            tracks_m = fmax(tracks_m, model->vertex[model->triangle[part->first_triangle + c / 3][c % 3]][0]);
        }
    CHECK_NEAR((double)s->high_m[0], tracks_m, 0.6);
    /* forward is north */
    CHECK_NEAR(s->r_ecef_from_body[6], 1, 1e-6);
    /* its engine idles for two minutes */
    CHECK(s->blow.from_s == arrives_s && s->blow.to_s == arrives_s + 120);
    /* exhaust of etc/effects.csv: 380 K, and 0.12 m at a vehicle of 40 m3 */
    CHECK_NEAR(s->blow.excess_k, 380, 1e-3);
    CHECK_NEAR(s->blow.radius_m, 0.12 * cbrt(model->length_m * model->width_m * model->height_m / 40), 1e-6);

    /* 200 m in four pieces of 50 m at most (the reports are 50 m apart), 100 m in two */
    CHECK(m->tracks == 6);
    CHECK_NEAR(m->track[0].a_ecef[2], 0, 1e-9);
    CHECK_NEAR(m->track[5].b_ecef[2], 300, 1e-9);
    double sum_m = 0;
    for (int i = 0; i < m->tracks; i++) {
        const GroundTrack *t = &m->track[i];
        sum_m += t->b_ecef[2] - t->a_ecef[2];
        CHECK_NEAR(t->b_s - t->a_s, 5, 1e-9);
        CHECK(t->tracked);
        CHECK_NEAR(t->width_m, 0.16 * model->width_m, 1e-6);
        CHECK_NEAR(t->apart_m, 0.84 * model->width_m, 1e-6);
        /* 0.5 x 5 % of the weight a metre, over two widths; box density 0.9 t/m3 */
        const double weight_n = 900 * model->length_m * model->width_m * model->height_m * 9.80665;
        CHECK_NEAR(t->heat_j_m2, 0.025 * weight_n / (2 * 0.16 * model->width_m), 0.01);
        /* a T-72 of 41 t: 0.5 x 5 % x 402 kN over two tracks of 0.58 m, 8.7 kJ/m2; stated is a factor of two */
        CHECK(t->heat_j_m2 > 8.7e3 / 2.01 && t->heat_j_m2 < 8.7e3 * 2.01);
    }
    CHECK_NEAR(sum_m, 300, 1e-6);
    fixture_close(&f);
}

/* Rolling resistance of tyres is 3 % of the weight, of which half heats the ground under two tyres, each a tenth of the
 * lorry wide; a lorry of 55 m3 weighs 19 t: 0.35 t/m3 of its box. */
static void a_lorry_leaves_the_tracks_of_tyres(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL);
    drive_one(&f, truck_type, 0);
    const GroundMarks *m = marks_at(&f, ends_s);
    const Model       *model = catalog_model(f.catalog, catalog_find(f.catalog, truck_type, NULL, NULL));
    const double       weight_n = 350 * model->length_m * model->width_m * model->height_m * 9.80665;
    CHECK(m->tracks > 0);
    CHECK_NEAR(weight_n, 19e3 * 9.80665, 0.35 * 19e3 * 9.80665); /* a lorry of 19 t, of this shape's box */
    for (int i = 0; i < m->tracks; i++) {
        CHECK(!m->track[i].tracked);
        CHECK_NEAR(m->track[i].width_m, 0.1 * model->width_m, 1e-6);
        CHECK_NEAR(m->track[i].apart_m, 0.9 * model->width_m, 1e-6);
        CHECK_NEAR(m->track[i].heat_j_m2, 0.5 * 0.03 * weight_n / (2 * 0.1 * model->width_m), 0.01);
    }
    fixture_close(&f);
}

/* An engine that runs, stops, and runs again: two stands of one place; one that runs at the first report has done so
 * for an hour. */
static void an_engine_that_starts_again_is_another_stand(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL);
    for (int t_s = 0; t_s <= 3000; t_s += heartbeat_s) {
        DisEntityState pdu = driving(1, tank_type, 0, 0);
        if (t_s < 1000 || t_s >= 2000) pdu.appearance |= 1u << dis_appearance_power_plant_bit;
        hear(&f, &pdu, t_s);
    }
    const GroundMarks *m = marks_at(&f, 3000);
    CHECK(m->stands == 2);
    const GroundBlow *a = &m->stand[0].blow, *b = &m->stand[1].blow;
    CHECK(a->from_s == -3600 && a->to_s >= 1000 - heartbeat_s && a->to_s <= 1000 + heartbeat_s);
    CHECK(b->from_s >= 2000 && b->from_s <= 2000 + heartbeat_s && b->to_s > 3000);
    CHECK(m->stand[0].to_s == m->stand[1].from_s);
    fixture_close(&f);
}

/* A tank that stopped at 100 s idles until 220 s and warms the ground behind it until then; a Freeze of 1000 s from 210
 * s on, or as many of its reports with the frozen bit, lets it do so until the Freeze's end and 10 s more, as one
 * stand. A report holds for 12 s. */
static void an_engine_stands_with_its_tank(void **state)
{
    (void)state;
    for (int frozen = 0; frozen < 2; frozen++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState pdu = driving(1, tank_type, 0, 1);
        for (int t_s = 0; t_s < 210; t_s += 10) {
            if (t_s == 100) pdu = driving(1, tank_type, 0, 0);
            hear(&f, &pdu, t_s);
        }
        if (!frozen) entity_table_stop(f.table, &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 210);
        pdu.appearance = frozen_bit;
        for (int t_s = 210; frozen && t_s < 1210; t_s += 10) hear(&f, &pdu, t_s);
        CHECK(marks_at(&f, 1205)->stand[0].blow.to_s == (frozen ? 1212 : INFINITY));
        if (!frozen) entity_table_start(f.table, &(DisStartResume){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 1210);
        pdu.appearance = 0;
        for (int k = 0; k < 4; k++) {
            const GroundMarks *m = marks_at(&f, 1210 + 10 * k);
            CHECK(m->stands == 1 && m->stand[0].blow.from_s == 100);
            CHECK(m->stand[0].blow.to_s == fmin(1220, 1200 + 10 * k + 12));
            hear(&f, &pdu, 1210 + 10 * k);
        }
        CHECK(marks_at(&f, 1240)->stand[0].blow.to_s == 1220);
        fixture_close(&f);
    }
}

/* The same PDUs: the same bits, whatever snapshots were taken in between, and in any order afterwards. */
static void marks_depend_on_pdus_alone(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL), g = fixture_open(NULL);
    drive(&f, 0);
    drive(&g, 3);
    for (int k = 0; k < 7; k++) {
        const double t_s = ends_s + 0.613 * (k * 4 % 7);
        marks_at(&g, ends_s + 0.613 * (6 - k)); /* g is asked in another order than f */
        same_marks(marks_at(&f, t_s), marks_at(&g, t_s));
    }
    fixture_close(&f);
    fixture_close(&g);
}

/* Traffic with silences, removals and turns: the same marks whether those silent are removed every 0.1 s, at their next
 * report, or after marks were looked at. */
static void timeouts_found_late_change_nothing(void **state)
{
    (void)state;
    enum { entities = 40 };
    Fixture  f = fixture_open(NULL), g = fixture_open(NULL);
    uint32_t draw = 12345;
    double   t_s = 0, north_m[entities] = {0}, reported_s[entities] = {0}, speed_mps[entities] = {0};
    for (int i = 0; i < 6000; i++) {
        draw = draw * 1664525u + 1013904223u;
        const int e = (int)(draw >> 16) % entities;
        north_m[e] += speed_mps[e] * fmin(t_s - reported_s[e], 12);
        reported_s[e] = t_s;
        if (draw >> 8 & 1) speed_mps[e] = draw >> 9 & 1 ? 0 : 1 + (draw >> 10) % 12;
        DisEntityState pdu = driving(e, e % 2 ? tank_type : truck_type, north_m[e], speed_mps[e]);
        pdu.p_ecef[1] = 30 * e;
        if ((draw >> 5) % 50 == 0) pdu.appearance |= deactivated_bit;
        hear(&f, &pdu, t_s), hear(&g, &pdu, t_s);
        if (i % 1000 == 999) same_marks(marks_at(&f, t_s + 0.3), marks_at(&g, t_s + 0.3));
        const double next_s = t_s + (draw >> 3 & 127) * 0.01;
        for (double tick_s = ceil(10 * t_s) / 10; tick_s <= next_s; tick_s += 0.1) entity_table_expire(g.table, tick_s);
        t_s = next_s;
    }
    CHECK(entity_table_counters(f.table)->timed_out > 500 && entity_table_counters(f.table)->deactivated > 30);
    const GroundMarks *m = marks_at(&f, t_s);
    CHECK(m->tracks > 500 && m->stands > 20);
    same_marks(m, marks_at(&g, t_s));
    fixture_close(&f);
    fixture_close(&g);
}

/* Between reports the trail follows the extrapolated path, up to the vehicle. */
static void the_trail_reaches_its_vehicle(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = driving(1, tank_type, 0, 10);
    hear(&f, &pdu, 0);
    for (double t_s = 0.2; t_s < 12; t_s += 0.7) {
        const GroundMarks *m = marks_at(&f, t_s);
        CHECK(m->tracks == 1 && m->stands == 0);
        CHECK_NEAR(m->track[0].b_ecef[2], 10 * t_s, 1e-9);
        CHECK(m->track[0].b_s == t_s);
    }
    /* held, then silent: nothing of it was confirmed */
    CHECK(marks_at(&f, 12.5)->tracks == 0);
    fixture_close(&f);
}

/* A circle of 40 m radius, heading and velocity turning (algorithm 8, RVB): pieces lie on it. */
static void bends_are_followed(void **state)
{
    (void)state;
    static const double radius_m = 40, w_rps = 0.25;
    Fixture             f = fixture_open(NULL);
    for (int t_s = 0; t_s <= 20; t_s += heartbeat_s) {
        const double   turned = w_rps * t_s;
        DisEntityState pdu = report(1, tank_type);
        double         r[9] = {0, 0, -1, sin(turned), cos(turned), 0, cos(turned), -sin(turned), 0}, euler[3];
        euler_from_r_ecef_from_body(&euler[0], &euler[1], &euler[2], r);
        pdu.psi_rad = (float)euler[0], pdu.theta_rad = (float)euler[1], pdu.phi_rad = (float)euler[2];
        pdu.dead_reckoning = 7;
        pdu.p_ecef[1] = radius_m * (1 - cos(turned));
        pdu.p_ecef[2] = radius_m * sin(turned);
        pdu.velocity_mps[0] = (float)(radius_m * w_rps); /* body axes */
        pdu.angular_rate_rps[2] = (float)w_rps;
        hear(&f, &pdu, t_s);
    }
    const GroundMarks *m = marks_at(&f, 22);
    CHECK_NEAR(joined_m(m), radius_m * w_rps * 22, 2);
    CHECK(m->tracks > 25 && m->tracks < 110);
    for (int i = 0; i < m->tracks; i++) {
        const double east_m = m->track[i].b_ecef[1] - radius_m, north_m = m->track[i].b_ecef[2];
        CHECK_NEAR(hypot(east_m, north_m), radius_m, 0.05); /* angles of PDUs are floats at psi ~ pi: microradians */
    }
    fixture_close(&f);
}

/* ---- who leaves what ---------------------------------------------------------------------------- */

static void who_stands_has_stood(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState tank = report(1, tank_type), man = report(2, person_type), house = report(3, house_type);
    DisEntityState ship = report(4, (DisEntityType){1, 3, 225, 1, 1, 0, 0}), heli = report(5, helicopter_type);
    hear(&f, &tank, 100), hear(&f, &man, 100), hear(&f, &house, 100), hear(&f, &ship, 100), hear(&f, &heli, 100);
    const GroundMarks *m = marks_at(&f, 101);
    CHECK(m->stands == 3); /* without elevation a helicopter without speed may hover */
    for (int i = 0; i < 3; i++) CHECK(m->stand[i].from_s == 100 - 3600 && m->stand[i].to_s == INFINITY);
    /* one timed out; the others were removed, moved, turned */
    DisRemoveEntity away = {.receiving = entity_id(2)};
    entity_table_remove(f.table, &away, 105);
    house.psi_rad = 0.2f;
    hear(&f, &house, 106);
    m = marks_at(&f, 130);
    CHECK(m->stands == 3 && m->stand[0].to_s == 112 && m->stand[1].to_s == 105 && m->stand[2].to_s == 106);
    CHECK(marks_at(&f, 111)->stand[0].to_s == INFINITY);
    /* back again in the same place: it went on */
    hear(&f, &tank, 200);
    m = marks_at(&f, 201);
    CHECK(m->stands == 3 && m->stand[0].from_s == 100 - 3600 && m->stand[0].to_s == INFINITY);
    fixture_close(&f);
}

/* 0.4 m and 4 degrees are the same place; a halt of 55 s is no stand; a wreck stands on. */
static void jitter_is_no_motion(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = driving(1, truck_type, 0, 5);
    hear(&f, &pdu, 0);
    for (int t_s = 5; t_s <= 60; t_s += heartbeat_s) {
        pdu = driving(1, truck_type, 25 + (t_s % 2 ? 0.4 : 0), 0);
        hear(&f, &pdu, t_s);
    }
    CHECK(marks_at(&f, 60)->stands == 0);
    pdu.appearance = 3 << 3; /* destroyed */
    hear(&f, &pdu, 65);
    CHECK(marks_at(&f, 66)->stands == 1 && f.snapshot.marks.stand[0].from_s == 5);
    CHECK(!f.snapshot.marks.track[0].tracked && f.snapshot.marks.tracks == 1);
    pdu.theta_rad += 4 * (float)rad_per_deg;
    hear(&f, &pdu, 70);
    CHECK(marks_at(&f, 71)->stand[0].to_s == INFINITY);
    pdu.p_ecef[2] -= 0.2; /* 0.6 m from its first place */
    hear(&f, &pdu, 75);
    CHECK(marks_at(&f, 76)->stands == 1 && f.snapshot.marks.stand[0].to_s == 75);
    fixture_close(&f);
}

/* Over a flat place 30 m above the ellipsoid: parked helicopters stand, hovering ones do not; bursts burn near the
 * ground. */
static void the_ground_decides(void **state)
{
    (void)state;
    LocalFrame        frame;
    const Geodetic    origin = {0, 0, 0};
    Elevation         ground = {0};
    EntityTableConfig config = entity_table_default_config();
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    CHECK(elevation_level_create(&ground, 0, &(ElevationGrid){101, 101, -500, -500, 10, 0, 0.5}) == STATUS_OK);
    for (int j = 0; j < 101; j++)
        for (int i = 0; i < 101; i++) elevation_set_post(&ground.level[0], i, j, 60);
    elevation_build_pyramids(&ground);
    config.ground = (ContactGround){.frame = &frame, .elevation = &ground};
    Fixture        f = fixture_open(&config);
    DisEntityState parked = report(1, helicopter_type), hovers = report(2, helicopter_type);
    parked.p_ecef[0] += 32, hovers.p_ecef[0] += 45;
    hear(&f, &parked, 0), hear(&f, &hovers, 0);
    const GroundMarks *m = marks_at(&f, 1);
    CHECK(m->stands == 1 && m->stand[0].owner == entity_key(entity_id(1)) + 1);

    static const struct {
        uint8_t  result;
        double   height_m;
        uint16_t warhead;
        bool     burns;
    } want[] = {{1, 31, 1000, true},  {1, 40, 1000, false},  {3, 40, 1000, true},
                {12, 30, 1000, true}, {5, 32.9, 1000, true}, {5, 33.1, 1000, false},
                {6, 30, 1000, false}, {14, 30, 1000, false}, {3, 30, 5000, false}};
    int burns = 0;
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        DisDetonation pdu = {.munition = entity_id(50),
                             .event = {1, 3001, (uint16_t)i},
                             .result = want[i].result,
                             .p_ecef = {earth_radius_m + want[i].height_m, (double)i, 0},
                             .descriptor = {{2, 2, 225, 1, 1, 3, 0}, want[i].warhead, 1000, 1, 0}};
        entity_table_detonation(f.table, &pdu, 10 + (double)i);
        entity_table_detonation(f.table, &pdu, 10.1 + (double)i); /* once more */
        burns += want[i].burns;
        CHECK(marks_at(&f, 11 + (double)i)->burns == burns);
    }
    m = marks_at(&f, 30);
    CHECK_NEAR(m->burn[0].radius_m, 2.5 * cbrt(4), 1e-5); /* a guided anti-armour warhead: 4 kg */
    CHECK_NEAR(m->burn[0].crater_m, 0.4 * cbrt(4), 1e-6);
    CHECK(m->burn[0].t_s == 10 && m->burn[0].heat_j_m2 == 1e5f);
    CHECK(marks_at(&f, 11.5)->burns == 1); /* those of later are not there yet */

    /* every result, at the ground and 400 m above it: those that name the ground burn it at any height, those that name
     * water and those that are no burst at none, all others where the ground is near */
    for (int result = 0; result < 256; result++)
        for (int high = 0; high < 2; high++) {
            const bool dirt = result == 3 || result == 4 || (result >= 11 && result <= 13);
            const bool none =
                result == 6 || (result >= 14 && result <= 16) || result == 24 || (result >= 31 && result <= 33);
            const DisDetonation pdu = {.munition = entity_id(50),
                                       .event = {1, 3002, (uint16_t)(2 * result + high)},
                                       .result = (uint8_t)result,
                                       .p_ecef = {earth_radius_m + (high ? 430 : 30), 50 + result, 0},
                                       .descriptor = {{2, 2, 225, 1, 1, 3, 0}, 1000, 1000, 1, 0}};
            entity_table_detonation(f.table, &pdu, 40 + result);
            burns += dirt || (!none && !high);
            assert_int_equal(marks_at(&f, 300)->burns, burns);
        }
    fixture_close(&f);
    elevation_destroy(&ground);
}

/* The sender's ground is level; ours is a slope of one in five, 15 m lower where it starts. */
static void marks_lie_where_their_entity_is_shown(void **state)
{
    (void)state;
    LocalFrame        frame;
    const Geodetic    origin = {0, 0, 0};
    Elevation         ground = {0};
    EntityTableConfig config = entity_table_default_config();
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    CHECK(elevation_level_create(&ground, 0, &(ElevationGrid){101, 101, -500, -500, 10, -200, 1}) == STATUS_OK);
    for (int j = 0; j < 101; j++)
        for (int i = 0; i < 101; i++) elevation_set_post(&ground.level[0], i, j, 185 + 2 * (j - 50));
    elevation_build_pyramids(&ground);
    config.ground = (ContactGround){.frame = &frame, .elevation = &ground};
    Fixture        f = fixture_open(&config);
    DisEntityState stands = driving(1, tank_type, 100, 0);
    for (int t_s = 0; t_s <= 120; t_s += heartbeat_s) {
        const DisEntityState drives = driving(2, tank_type, 2.0 * t_s, 2);
        hear(&f, &stands, t_s), hear(&f, &drives, t_s);
    }
    const DisDetonation pdu = {.munition = entity_id(50),
                               .event = {1, 3001, 1},
                               .result = 3,
                               .p_ecef = {earth_radius_m + 0.3, 5, 100},
                               .descriptor = {{2, 2, 225, 1, 1, 3, 0}, 1000, 1000, 1, 0}};
    entity_table_detonation(f.table, &pdu, 121);
    const GroundMarks    *m = marks_at(&f, 122);
    const SnapshotEntity *shown = NULL;
    for (int i = 0; i < f.snapshot.count; i++)
        if (f.snapshot.entity[i].id.entity == stands.id.entity) shown = &f.snapshot.entity[i];
    CHECK(shown && m->stands == 1 && m->tracks >= 4 && m->burns == 1);
    CHECK(memcmp(m->stand[0].p_ecef, shown->p_ecef, sizeof shown->p_ecef) == 0);
    CHECK(memcmp(m->stand[0].r_ecef_from_body, shown->r_ecef_from_body, sizeof shown->r_ecef_from_body) == 0);
    CHECK_NEAR(m->stand[0].p_ecef[0] - earth_radius_m, -15 + 0.2 * 100, 0.01); /* paper; north is z here, up is x */
    CHECK_NEAR(m->stand[0].r_ecef_from_body[0], sin(atan(0.2)), 1e-4);         /* its nose is north, and up */
    for (int i = 0; i < m->tracks; i++) {
        CHECK_NEAR(m->track[i].a_ecef[0] - earth_radius_m, -15 + 0.2 * m->track[i].a_ecef[2], 0.02);
        CHECK_NEAR(m->track[i].b_ecef[0] - earth_radius_m, -15 + 0.2 * m->track[i].b_ecef[2], 0.02);
    }
    CHECK_NEAR(m->burn[0].p_ecef[0] - earth_radius_m, -15 + 0.2 * 100, 0.01);
    fixture_close(&f);
    elevation_destroy(&ground);
}

/* A jump is no drive, and neither is a lift by a crane or a vehicle in the air. */
static void jumps_leave_no_tracks(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState pdu = driving(1, tank_type, 0, 10);
    hear(&f, &pdu, 0);
    pdu.p_ecef[2] = 500;
    hear(&f, &pdu, 5);
    CHECK(marks_at(&f, 5)->tracks == 0);
    pdu.p_ecef[0] += 50;
    pdu.p_ecef[2] += 10;
    hear(&f, &pdu, 10);
    CHECK(marks_at(&f, 10)->tracks == 0);
    pdu.velocity_mps[2] = 90;
    hear(&f, &pdu, 11);
    pdu.p_ecef[2] += 450;
    hear(&f, &pdu, 16);
    CHECK(marks_at(&f, 16)->tracks == 0);
    fixture_close(&f);
}

/* A pause of the exercise is no motion, and what stands then stands on. */
static void a_pause_holds_trails_and_stands(void **state)
{
    (void)state;
    Fixture              f = fixture_open(NULL);
    DisEntityState       tank = driving(1, tank_type, 0, 10), truck = report(2, truck_type);
    const DisStopFreeze  stop = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    const DisStartResume start = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    truck.p_ecef[1] = 100;
    hear(&f, &tank, 0), hear(&f, &truck, 0);
    entity_table_stop(f.table, &stop, 3);
    const GroundMarks *m = marks_at(&f, 500);
    CHECK(m->tracks == 1 && m->stands == 1 && m->stand[0].to_s == INFINITY);
    CHECK_NEAR(m->track[0].b_ecef[2], 30, 1e-9);
    CHECK(m->track[0].b_s == 3);
    entity_table_start(f.table, &start, 9);
    tank.p_ecef[2] = 50;
    hear(&f, &tank, 11);
    m = marks_at(&f, 13);
    CHECK(m->tracks == 3); /* the last one since the report */
    CHECK_NEAR(m->track[1].b_ecef[2], 50, 1e-9);
    CHECK(m->track[1].a_s == 9 && m->track[1].b_s == 11);
    CHECK(m->stand[0].to_s == INFINITY);          /* it stands yet */
    CHECK(marks_at(&f, 19)->stand[0].to_s == 18); /* its timeout, and the pause */
    fixture_close(&f);
}

/* ---- bounds ----------------------------------------------------------------------------------- */

static void rings_forget_the_oldest(void **state)
{
    (void)state;
    GroundHistory *h = NULL;
    Arena         *arena = arena_create();
    GroundMarks    m;
    GroundTrack   *tail;
    CHECK(ground_history_create(&h) == STATUS_OK);
    for (int i = 0; i < ground_stand_capacity + 5; i++) {
        const GroundStand stand = {.p_ecef = {6e6, i, 0}, .from_s = i, .to_s = 1e9, .owner = (uint64_t)i + 1};
        CHECK(ground_stand_open(h, &stand) == (uint64_t)i + 1);
    }
    for (int i = 0; i < ground_burn_capacity + 3; i++) {
        const GroundBurn burn = {.p_ecef = {6e6, i, 0}, .t_s = i};
        ground_burn(h, &burn);
    }
    GroundTrail trail = {.on = true, .p_ecef = {6e6, 0, 0}, .t_s = 0, .speed_mps = 10};
    for (int i = 1; i <= ground_track_capacity + 7; i++) { /* a zigzag */
        const double p_ecef[3] = {6e6, 10 * i, i % 2 ? 10 : 0};
        ground_trail_point(h, &trail, p_ecef, 2 * i, false);
    }
    ground_stand_until(h, 3, 0); /* forgotten: no effect */
    CHECK(ground_marks_at(&m, &tail, h, 1e6, 2, arena) == STATUS_OK);
    CHECK(m.stands == ground_stand_capacity && m.burns == ground_burn_capacity && m.tracks == ground_track_capacity);
    CHECK(m.forgotten == 5 + 3 + 7 && ground_history_forgotten(h) == 15);
    for (int i = 0; i < m.stands; i++) CHECK(m.stand[i].p_ecef[1] == i + 5 && m.stand[i].to_s == INFINITY);
    for (int i = 0; i < m.burns; i++) CHECK(m.burn[i].p_ecef[1] == i + 3);
    for (int i = 0; i < m.tracks; i++) CHECK(m.track[i].b_ecef[1] == 10 * (i + 8));
    arena_destroy(arena);
    ground_history_destroy(h);
}

/* One vehicle on a straight road for a day does not push out the others. */
static void a_road_is_few_pieces(void **state)
{
    (void)state;
    Fixture f = fixture_open(NULL);
    for (int i = 0; i <= 7200; i++) { /* every half second */
        DisEntityState pdu = driving(1, truck_type, 5.0 * i, 10);
        hear(&f, &pdu, 0.5 * i);
    }
    const GroundMarks *m = marks_at(&f, 3600);
    CHECK_NEAR(joined_m(m), 36000, 4);
    CHECK(m->tracks <= 36000 / 50 + 1);
    fixture_close(&f);
}

static void a_flood_stays_bounded(void **state)
{
    (void)state;
    EntityTableConfig config = entity_table_default_config();
    config.capacity = 3000;
    Fixture  f = fixture_open(&config);
    uint32_t draw = 1;
    for (int i = 0; i < 60000; i++) {
        draw = draw * 1664525u + 1013904223u;
        DisEntityState pdu = driving(draw >> 8 & 0x1FFF, i % 3 ? tank_type : truck_type, draw % 1000,
                                     draw % 5 ? (double)(draw % 70) : 0);
        pdu.dead_reckoning = (uint8_t)(draw >> 5 & 15);
        pdu.acceleration_mps2[1] = (float)(draw % 9000);
        pdu.angular_rate_rps[2] = (float)(draw % 40);
        pdu.p_ecef[1] = draw % 7919;
        (void)entity_table_entity_state(f.table, &pdu, 0.001 * i);
        DisDetonation burst = {.munition = entity_id(i % 60000),
                               .result = 3,
                               .descriptor = {{2, 9, 225, 2, 1, 0, 0}, 1000, 1000, 1, 0},
                               .p_ecef = {draw % 11 ? earth_radius_m : NAN, draw % 1000, i}};
        entity_table_detonation(f.table, &burst, 0.001 * i);
    }
    const GroundMarks *m = marks_at(&f, 60);
    CHECK(m->stands <= ground_stand_capacity && m->burns == ground_burn_capacity && m->tracks <= ground_tracks_most);
    CHECK(m->forgotten > 0 && entity_table_counters(f.table)->marks_forgotten == (uint64_t)m->forgotten);
    for (int i = 0; i < m->tracks; i++)
        CHECK(v3_is_finite(m->track[i].a_ecef) && v3_is_finite(m->track[i].b_ecef) &&
              m->track[i].b_s > m->track[i].a_s);
    fixture_close(&f);
}

/* Full rings and 1000 vehicles under way: the marks of a snapshot cost copies. Printed, and bounded generously. */
static void snapshots_stay_cheap(void **state)
{
    (void)state;
    enum { vehicles = 1000, rounds = 20 };
    double took_s[2];
    for (int full = 0; full < 2; full++) {
        Fixture f = fixture_open(NULL);
        for (int t_s = 0; t_s < (full ? 100 : 2); t_s++)
            for (int e = 0; e < vehicles; e++) {
                DisEntityState pdu = driving(e, full ? tank_type : helicopter_type, 10.0 * t_s, 10);
                pdu.p_ecef[1] = 20 * e + (full ? t_s % 2 * 3 : 0); /* a zigzag: nothing merges */
                hear(&f, &pdu, t_s);
            }
        double best_s = INFINITY;
        for (int i = 0; i < rounds; i++) {
            const double       begun_s = cpu_s();
            const GroundMarks *m = marks_at(&f, (full ? 99 : 1) + 0.1 * i);
            best_s = fmin(best_s, cpu_s() - begun_s);
            CHECK(m->tracks == (full ? ground_track_capacity + (i > 0 ? vehicles : 0) : 0));
        }
        took_s[full] = best_s;
        fixture_close(&f);
    }
    printf("snapshot of %d: helicopters %.3f ms, tanks with %d pieces %.3f ms\n", vehicles, 1e3 * took_s[0],
           ground_track_capacity, 1e3 * took_s[1]);
    CHECK(took_s[1] < 0.05);
}

/* ---- files ------------------------------------------------------------------------------------ */

static char *whole_file(const char *path)
{
    char  *text = NULL;
    size_t octets;
    CHECK(text_read_file(&text, &octets, "test", path, 1 << 26) == STATUS_OK);
    return text;
}

static void saved_marks_come_back(void **state)
{
    (void)state;
    static const double unix_s = 1782036000; /* 2026-06-21T10:00:00Z: whole, so that times here are exact */
    Fixture             f = fixture_open(NULL), g = fixture_open(NULL);
    char                folder[temp_path_size], path[temp_name_size], again[temp_name_size];
    CHECK(temp_folder(folder));
    snprintf(path, sizeof path, "%s/marks.csv", folder);
    snprintf(again, sizeof again, "%s/again.csv", folder);
    drive(&f, 0);
    DisEntityState truck = report(2, truck_type);
    truck.p_ecef[1] = 77.125;
    hear(&f, &truck, ends_s);
    DisDetonation burst = {.result = 3, .p_ecef = {earth_radius_m + 1.0 / 3, 5, 6}};
    entity_table_detonation(f.table, &burst, ends_s);
    CHECK(entity_table_marks_save(f.table, unix_s, path) == STATUS_OK);
    CHECK(entity_table_marks_load(g.table, unix_s, path) == STATUS_OK);
    CHECK(entity_table_marks_save(g.table, unix_s, again) == STATUS_OK);
    char *a = whole_file(path), *b = whole_file(again);
    CHECK(strcmp(a, b) == 0 && strstr(a, "stand,") && strstr(a, "track,") && strstr(a, "burn,"));
    free(a), free(b);
    same_marks(marks_at(&f, ends_s), marks_at(&g, ends_s));

    /* a restart an hour later: exercise time 0 is another; who stands there again stood all the time */
    Fixture      h = fixture_open(NULL);
    const double later_s = ends_s + 1800;
    CHECK(entity_table_marks_load(h.table, unix_s + later_s, path) == STATUS_OK);
    const GroundMarks *m = marks_at(&h, 0);
    CHECK(m->stands == 2 && m->stand[0].from_s == arrives_s - later_s && m->stand[0].to_s == leaves_s - later_s);
    CHECK(m->stand[1].to_s == -1800 + 12 && m->tracks == 6 && m->burns == 1 && m->burn[0].t_s == -1800);
    hear(&h, &truck, 0);
    m = marks_at(&h, 1);
    CHECK(m->stands == 2 && m->stand[1].to_s == INFINITY && m->stand[1].from_s == -1800 - 3600);

    log_set_sink(check_listen, NULL);
    CHECK(entity_table_marks_load(h.table, unix_s, path) == STATUS_UNSUPPORTED &&
          strstr(check_said, "before the exercise"));
    CHECK(entity_table_marks_load(h.table, unix_s, "/none") != STATUS_OK);
    CHECK(entity_table_marks_save(h.table, unix_s, "/none/at/all.csv") == STATUS_IO);
    log_set_sink(NULL, NULL);
    remove(path), remove(again), rmdir(folder);
    fixture_close(&f), fixture_close(&g), fixture_close(&h);
}

static const char header[] =
    "kind,owner,from_unix_s,to_unix_s,x_m,y_m,z_m,to_x_m,to_y_m,to_z_m,r11,r12,r13,r21,r22,r23,r31,r32,r33,low_x_m,"
    "low_y_m,low_z_m,high_x_m,high_y_m,high_z_m,width_m,apart_m,tracked,radius_m,crater_m,heat_j_m2\n";

static void bad_files_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *row, *said;
    } bad[] = {
        {"hole,,0,,6378137,0,0,,,,,,,,,,,,,,,,,,,,,,1,1,1\n", "kind: 'hole' is not one of stand, track, burn"},
        {"burn,,0,,6378137,0,0,,,,,,,,,,,,,,,,,,,,,,-1,1,1\n", "radius_m"},
        {"burn,,0,,6378137,0,0,,,,,,,,,,,,,,,,,,,,,,nan,1,1\n", "radius_m"},
        {"burn,,0,,0,0,0,,,,,,,,,,,,,,,,,,,,,,1,1,1\n", "far from the Earth"},
        {"burn,,x,,6378137,0,0,,,,,,,,,,,,,,,,,,,,,,1,1,1\n", "from_unix_s"},
        {"track,,2,1,6378137,0,0,6378137,5,0,,,,,,,,,,,,,,,,0.5,2,1,,,9000\n", "before"},
        {"track,,1,2,6378137,0,0,6378137,50000,0,,,,,,,,,,,,,,,,0.5,2,1,,,9000\n", "too long"},
        {"track,,1,2,6378137,0,0,6378137,5,0,,,,,,,,,,,,,,,,0.5,2,0.5,,,9000\n", "tracked"},
        {"stand,1,1,2,6378137,0,0,,,,1,0,0,0,1,0,0,0,2,-1,-1,-1,1,1,1,,,,,,\n", "rotation"},
        {"stand,1,1,2,6378137,0,0,,,,1,0,0,0,1,0,0,0,1,-1,-1,2,1,1,1,,,,,,\n", "box"},
        {"stand,0,1,2,6378137,0,0,,,,1,0,0,0,1,0,0,0,1,-1,-1,-1,1,1,1,,,,,,\n", "owner"},
        {"stand,1,3,2,6378137,0,0,,,,1,0,0,0,1,0,0,0,1,-1,-1,-1,1,1,1,,,,,,\n", "before"},
    };
    GroundHistory *h = NULL;
    char           path[text_file_size], text[2048];
    CHECK(ground_history_create(&h) == STATUS_OK);
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        snprintf(text, sizeof text, "%sburn,,0,,6378137,0,0,,,,,,,,,,,,,,,,,,,,,,1,1,1\n%s", header, bad[i].row);
        text_file(path, text);
        CHECK(ground_marks_load(h, 0, path) == STATUS_BAD_VALUE);
        if (!strstr(check_said, bad[i].said) || !strstr(check_said, ":3:"))
            fail_msg("row %zu: said \"%s\", want \"%s\"", i, check_said, bad[i].said);
        remove(path);
    }
    text_file(path, "kind,owner\nburn,1\n");
    CHECK(ground_marks_load(h, 0, path) == STATUS_BAD_VALUE && strstr(check_said, "no column"));
    remove(path);
    log_set_sink(NULL, NULL);
    /* nothing of the refused ones is there, and a good one is still taken */
    snprintf(text, sizeof text, "%sstand,1,1,,6378137,0,0,,,,1,0,0,0,1,0,0,0,1,-1,-1,-1,1,1,1,,,,,,\n", header);
    text_file(path, text);
    CHECK(ground_marks_load(h, 0, path) == STATUS_OK);
    remove(path);
    ground_history_destroy(h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tank_leaves_tracks_and_a_stand),
        cmocka_unit_test(a_lorry_leaves_the_tracks_of_tyres),
        cmocka_unit_test(an_engine_that_starts_again_is_another_stand),
        cmocka_unit_test(an_engine_stands_with_its_tank),
        cmocka_unit_test(marks_depend_on_pdus_alone),
        cmocka_unit_test(timeouts_found_late_change_nothing),
        cmocka_unit_test(the_trail_reaches_its_vehicle),
        cmocka_unit_test(bends_are_followed),
        cmocka_unit_test(who_stands_has_stood),
        cmocka_unit_test(jitter_is_no_motion),
        cmocka_unit_test(the_ground_decides),
        cmocka_unit_test(marks_lie_where_their_entity_is_shown),
        cmocka_unit_test(jumps_leave_no_tracks),
        cmocka_unit_test(a_pause_holds_trails_and_stands),
        cmocka_unit_test(rings_forget_the_oldest),
        cmocka_unit_test(a_road_is_few_pieces),
        cmocka_unit_test(a_flood_stays_bounded),
        cmocka_unit_test(snapshots_stay_cheap),
        cmocka_unit_test(saved_marks_come_back),
        cmocka_unit_test(bad_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
