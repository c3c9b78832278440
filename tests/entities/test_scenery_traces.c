/* Dust, marks and exhaust gas of clutter: the same as an entity's of that model that drives the same way; nothing
 * ahead, nothing on paved ways; closed forms of time; bounded. */
#include "tests/entities/entity_fixture.h"

#include "entities/scenery/scenery_exhaust.h"
#include "entities/scenery/scenery_traces.h"
#include "entities/shapes/parametric.h"
#include "entities/traces/effect_history.h"
#include "entities/traces/vehicle_traces.h"

enum { most_movers = 300, most_corners = 64 };

static struct {
    EffectTable   table;
    LocalFrame    frame;
    Model         model[2];
    SceneryObject object[most_movers];
    SceneryMover  mover[most_movers];
    SceneryState  state[2];
    double        path[most_corners][3];
    uint8_t       loose[most_corners];
    Scenery       scenery;
    Arena        *arena;
} stage;

static int open_stage(void **state)
{
    (void)state;
    char path[512];
    stage.arena = arena_create();
    stage.frame = frame_here();
    return parametric_build(&stage.model[0], "lorry", 0.01) == STATUS_OK &&
                   parametric_build(&stage.model[1], "generator", 0.01) == STATUS_OK &&
                   etc_path(path, sizeof path, "effects.csv") && effect_table_open(&stage.table, path) == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) model_destroy(&stage.model[k]);
    arena_destroy(stage.arena);
    return 0;
}

/* Things that drive north from the origin at 10 m/s, 12 m a corner, and back 6 m beside it, a metre apart. */
static void drive(const Model *model, int movers)
{
    enum { side = most_corners / 2 };
    stage.scenery = (Scenery){.models = 1,
                              .model = stage.model,
                              .objects = movers,
                              .object = stage.object,
                              .states = 2,
                              .state = stage.state,
                              .movers = movers,
                              .mover = stage.mover,
                              .paths = most_corners,
                              .path_enu = stage.path,
                              .path_loose = stage.loose,
                              .smokes = true};
    if (model) stage.scenery.model = (Model *)model;
    stage.state[0] = (SceneryState){.drives = {.engine = 0.8f}};
    for (int k = 0; k < most_corners; k++) {
        const double along_m = 12 * (k < side ? k : most_corners - 1 - k);
        stage.path[k][0] = k < side ? 0 : -6, stage.path[k][1] = along_m, stage.path[k][2] = 0;
        stage.loose[k] = 1;
    }
    for (int k = 0; k < movers; k++) {
        stage.object[k] = (SceneryObject){.id = (uint64_t)k + 9, .kind = SCENERY_CLUTTER, .class = CLUTTER_LORRY};
        stage.mover[k] = (SceneryMover){.object = k, .count = most_corners, .speed_mps = 10, .phase_m = k};
    }
}

static const double eye[3] = {0, 0, 300};

static Snapshot dust_at(double t_s)
{
    Snapshot          s = {.t_s = t_s, .effect_table = &stage.table};
    const SceneryCone down = {.p_enu = {0, 0, 300}, .d_enu = {0, 0, -1}, .tangent = 5};
    assert_int_equal(scenery_dust(&s, &stage.scenery, &stage.frame, &down, stage.arena), STATUS_OK);
    return s;
}

static GroundMarks marks_at(double t_s)
{
    const GroundMarks own = {0};
    GroundMarks       m;
    assert_int_equal(scenery_marks(&m, &own, &stage.scenery, &stage.frame, eye, t_s, stage.arena), STATUS_OK);
    return m;
}

static double length_of(const GroundTrack *t)
{
    double along[3];
    v3_sub(along, t->b_ecef, t->a_ecef);
    return v3_length(along);
}

/* A truck of the exercise reports every 5 s that it drives north at 10 m/s with a small trail. */
static void as_of_an_entity(void **state)
{
    (void)state;
    static const double look_s = 22;
    Fixture             f = fixture_open(NULL);
    for (int t_s = 0; t_s <= 20; t_s += 5) {
        DisEntityState pdu = report(1, truck_type);
        pdu.p_ecef[2] = 10 * t_s, pdu.velocity_mps[2] = 10;
        pdu.appearance = UINT32_C(1) << dis_appearance_trail_shift;
        hear(&f, &pdu, t_s);
    }
    const SnapshotEntity *e = seen_at(&f, 1, look_s);
    const GroundMarks    *theirs = &f.snapshot.marks;
    const Model          *model = catalog_model(f.catalog, e->model);
    drive(model, 1);
    double base_enu[3];
    enu_from_ecef(base_enu, &stage.frame, theirs->track[0].a_ecef);
    for (int k = 0; k < most_corners; k++) stage.path[k][2] = base_enu[2];

    const GroundMarks ours = marks_at(look_s);
    double            their_m = 0, our_m = 0, to_enu[3];
    for (int k = 0; k < theirs->tracks; k++) their_m += length_of(&theirs->track[k]);
    for (int k = 0; k < ours.tracks; k++) {
        const GroundTrack *t = &ours.track[k], *o = &theirs->track[0];
        if (t->a_s >= 0) our_m += length_of(t);
        CHECK(t->width_m == o->width_m && t->apart_m == o->apart_m && t->heat_j_m2 == o->heat_j_m2);
        CHECK(t->tracked == o->tracked && t->b_s <= look_s && t->a_s < t->b_s);
    }
    print_message("tracks of the entity %.1f m, of clutter %.1f m\n", their_m, our_m);
    CHECK_NEAR(their_m, 220, 0.01);
    CHECK_NEAR(our_m, 220, 12.1); /* the piece that begins before 0 is left out above */
    enu_from_ecef(to_enu, &stage.frame, ours.track[0].b_ecef);
    CHECK_NEAR(to_enu[1], 220, 0.02);

    const Snapshot s = dust_at(look_s);
    int            n = 0;
    for (int k = 0; k < f.snapshot.puff_count; k++) {
        const EffectPuff *o = &f.snapshot.puff[k], *p = &s.puff[n];
        double            away[3];
        if (o->kind != EFFECT_DUST) continue;
        assert_true(n < s.puff_count);
        CHECK(p->kind == EFFECT_DUST);
        CHECK_NEAR(p->age_s, o->age_s, 1e-9);
        CHECK_NEAR(p->mass_kg, o->mass_kg, 1e-12);
        CHECK_NEAR(p->along_m, o->along_m, 1e-9);
        CHECK_NEAR(p->scale, o->scale, 1e-12);
        v3_sub(away, p->p_ecef, o->p_ecef);
        CHECK_NEAR(away[0], 0, 0.02);
        CHECK_NEAR(away[2], 0, 0.02);                  /* up, north: the Earth is round */
        CHECK(fabs(away[1]) <= 0.81 * model->width_m); /* east: each has its own draws */
        n++;
    }
    print_message("%d puffs of dust, as many of the entity\n", n);
    CHECK(n > 20 && s.puff_count == n);
    fixture_close(&f);
}

/* Whatever time it is looked at, puffs are the same, behind it, and their mass is what was raised in their life. */
static void a_closed_form_of_time(void **state)
{
    (void)state;
    drive(NULL, 1);
    const EffectModel *law = &stage.table.law[EFFECT_DUST];
    const double       scale = vehicle_effect_scale(&stage.model[0]);
    const double       given_kg = law->mass_kg * vehicle_trail_rate[1] * scale * scale * law->life_s;
    for (double t_s = 3; t_s < 300; t_s += 16.7) {
        const Snapshot s = dust_at(t_s), later = dust_at(t_s + 0.13);
        double         mass_kg = 0, p_enu[3], r[9], seen_enu[3], ahead[3];
        int            found = 0;
        scenery_pose(p_enu, r, &stage.scenery, &stage.mover[0], t_s);
        for (int k = 0; k < s.puff_count; k++) {
            mass_kg += s.puff[k].mass_kg;
            enu_from_ecef(seen_enu, &stage.frame, s.puff[k].p_ecef);
            v3_sub(ahead, seen_enu, p_enu);
            if (s.puff[k].age_s < 0.9) /* of the stretch that it is on */
                CHECK(v3_dot(ahead, (const double[3]){r[0], r[3], r[6]}) < stage.model[0].box_low[0] + 0.3 ||
                      s.t_s > 30);
            for (int n = 0; n < later.puff_count; n++)
                if (later.puff[n].seed == s.puff[k].seed) {
                    CHECK(memcmp(later.puff[n].p_ecef, s.puff[k].p_ecef, sizeof s.puff[k].p_ecef) == 0);
                    found++;
                }
        }
        CHECK(found >= s.puff_count - 2);
        CHECK_NEAR(mass_kg / given_kg, 1, 0.08);
    }
}

static void marks_lie_behind(void **state)
{
    (void)state;
    drive(NULL, 1);
    for (double t_s = 1; t_s < 200; t_s += 7.3) {
        const GroundMarks m = marks_at(t_s);
        double            all_m = 0, p_enu[3], r[9], to_enu[3];
        scenery_pose(p_enu, r, &stage.scenery, &stage.mover[0], t_s);
        for (int k = 0; k < m.tracks; k++) {
            const GroundTrack *t = &m.track[k];
            CHECK(t->b_s <= t_s && t->a_s < t->b_s);
            CHECK_NEAR(length_of(t), 10 * (t->b_s - t->a_s), 1e-4);
            if (k > 0) CHECK_NEAR(t->b_s, m.track[k - 1].a_s, 1e-9);
            all_m += length_of(t);
        }
        CHECK_NEAR(m.track[0].b_s, t_s, 1e-9);
        enu_from_ecef(to_enu, &stage.frame, m.track[0].b_ecef);
        for (int k = 0; k < 2; k++) CHECK_NEAR(to_enu[k], p_enu[k], 1e-6);
        /* one round of 2 x 372 m and both ends of 6 m, or as many pieces as are kept */
        CHECK(all_m <= 756.001 && all_m > 700);
    }
}

static void none_where_it_is_paved(void **state)
{
    (void)state;
    drive(NULL, 2);
    memset(stage.loose, 0, sizeof stage.loose);
    Snapshot          s = dust_at(50);
    const GroundMarks paved = marks_at(50);
    CHECK(s.puff_count == 0 && !s.puff && paved.tracks == 0 && !paved.track);
    /* soil from 120 m to 240 m alone: of that way alone */
    for (int k = 10; k < 20; k++) stage.loose[k] = 1;
    const GroundMarks some = marks_at(36); /* at 360 m */
    double            all_m = 0;
    for (int k = 0; k < some.tracks; k++) all_m += length_of(&some.track[k]);
    CHECK_NEAR(all_m, 2 * 120, 1e-3); /* each of the two */
    stage.scenery.movers = 0;
    s = dust_at(50);
    CHECK(s.puff_count == 0);
}

static void numbers_are_bounded(void **state)
{
    (void)state;
    drive(NULL, most_movers);
    const Snapshot    s = dust_at(77);
    const GroundMarks m = marks_at(77);
    print_message("%d puffs, %d tracks of %d that drive\n", s.puff_count, m.tracks, (int)most_movers);
    CHECK(m.tracks > 0 && m.tracks <= scenery_trails_most * scenery_trail_pieces);
    uint64_t owner[most_movers];
    int      owners = 0;
    for (int k = 0; k < s.puff_count; k++) {
        bool known = false;
        for (int o = 0; o < owners; o++) known |= owner[o] == s.puff[k].owner;
        if (!known) owner[owners++] = s.puff[k].owner;
    }
    CHECK(owners == scenery_dusts_most);
    /* none of it in view */
    Snapshot          up = {.t_s = 77, .effect_table = &stage.table};
    const SceneryCone away = {.p_enu = {0, -2000, 300}, .d_enu = {0, -1, 0}, .tangent = 0.3};
    assert_int_equal(scenery_dust(&up, &stage.scenery, &stage.frame, &away, stage.arena), STATUS_OK);
    CHECK(up.puff_count == 0);
}

/* What runs and is in view gives off gas, as an entity with an engine does: five puffs behind its pipe. */
static void gas_of_what_runs(void **state)
{
    (void)state;
    SceneryCone seen = {.p_enu = {0, -500, 50}, .d_enu = {0, 1, 0}, .tangent = 0.1};
    drive(NULL, 1);
    stage.scenery.models = 2, stage.scenery.movers = 0, stage.scenery.objects = 4;
    stage.state[1] = (SceneryState){.drives = {.engine = 0.8f}, .stood_s = 600};
    for (int k = 0; k < 4; k++)
        stage.object[k] = (SceneryObject){.id = (uint64_t)k + 9,
                                          .kind = SCENERY_CLUTTER,
                                          .model = 1,
                                          .state = k == 1,
                                          .p_enu = {k == 2 ? 400 : 0, k == 3 ? 5000 : 10.0 * k, 0},
                                          .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    Snapshot s = {.t_s = 12.34, .effect_table = &stage.table};
    assert_int_equal(scenery_exhaust(&s, &stage.scenery, &stage.frame, &seen, stage.arena), STATUS_OK);
    CHECK(s.puff_count == 5); /* the second has stopped, the third is beside the view, the fourth far off */
    double mass_kg = 0;
    for (int k = 0; k < s.puff_count; k++) {
        double p_enu[3];
        CHECK(s.puff[k].kind == EFFECT_EXHAUST && s.puff[k].owner == (stage.object[0].id | UINT64_C(1) << 63));
        enu_from_ecef(p_enu, &stage.frame, s.puff[k].p_ecef);
        CHECK(fabs(p_enu[0]) < 0.5 * stage.model[1].length_m + 0.1 && p_enu[2] > 0 && p_enu[2] < 4);
        mass_kg += s.puff[k].mass_kg;
    }
    const EffectModel *law = &stage.table.law[EFFECT_EXHAUST];
    const double       scale = vehicle_effect_scale(&stage.model[1]);
    CHECK_NEAR(mass_kg / (law->mass_kg * scale * scale * 0.8 * law->life_s), 0.82, 0.1); /* 4 .. 5 of 5.5 */
    stage.scenery.smokes = false;
    s = (Snapshot){.t_s = 12.34, .effect_table = &stage.table};
    assert_int_equal(scenery_exhaust(&s, &stage.scenery, &stage.frame, &seen, stage.arena), STATUS_OK);
    CHECK(s.puff_count == 0 && !s.puff);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(as_of_an_entity),     cmocka_unit_test(a_closed_form_of_time),
                                       cmocka_unit_test(marks_lie_behind),    cmocka_unit_test(none_where_it_is_paved),
                                       cmocka_unit_test(numbers_are_bounded), cmocka_unit_test(gas_of_what_runs)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
