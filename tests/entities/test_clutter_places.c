/* Clutter: nowhere that the exercise or anything built needs, nothing in another; what drives follows its path, keeps
 * right and to its speed. */
#include "tests/entities/clutter_fixture.h"

/* ---- where nothing stands ----------------------------------------------------------------------- */

static void keeps_clear_of_the_exercise(void **state)
{
    (void)state;
    ClutterConfig c = about(&land, 1500);
    c.density = 20;
    Scenery s = add(&c);
    double  nearest = INFINITY;
    int     beside = 0;
    CHECK(s.objects > 2000);
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const Model         *m = &s.model[o->model];
        const double         radius_m = 0.5 * hypot(m->length_m, m->width_m), *p = o->p_enu;
        const double         more_m = is_driven(&s, k) ? -6 : 0; /* its way keeps clear, at its vertices */
        for (int n = 0; n < 64; n++) {
            const double d = hypot(p[0] - fix[n].p_enu[0], p[1] - fix[n].p_enu[1]);
            nearest = fmin(nearest, d - radius_m - more_m);
            CHECK(d >= 12 + 0.98 * radius_m + more_m);
        }
        for (int n = 0; n < 16 && more_m == 0; n++)
            for (int step = (int)fmax(0, p[0] + 890); step <= fmin(1800, p[0] + 910); step++) { /* a metre apart */
                double q[3];
                for (int i = 0; i < 3; i++)
                    q[i] = line[n].a_enu[i] + (line[n].b_enu[i] - line[n].a_enu[i]) * step / 1800;
                if (hypot(p[0] - q[0], p[1] - q[1]) > radius_m) continue;
                beside++;
                CHECK(q[2] > p[2] + 0.98 * m->height_m);
            }
    }
    print_message("%d things, nearest %.1f m from a report, %d points of lines over them\n", s.objects, nearest,
                  beside);
    CHECK(beside > 0 && nearest < 20);
    scenery_free(&s);
}

static void keeps_off_what_is_built(void **state)
{
    (void)state;
    Culture  culture = {0};
    uint64_t id = 1;
    for (int j = -4; j <= 4; j++)
        for (int i = -4; i <= 4; i++) {
            const double   x = 130 * i, y = 140 * j, turn = 0.3 * i + j, u = cos(turn), v = sin(turn);
            double         p[4][2];
            const Building b = {.id = id++,
                                .use = (uint8_t)((i + j) & 1 ? BUILDING_HOUSE : BUILDING_BARN),
                                .eaves_m = 3,
                                .ridge_m = 5,
                                .levels = 1};
            for (int k = 0; k < 4; k++) {
                const double a = k == 1 || k == 2 ? 7 : -7, d = k >= 2 ? 5 : -5;
                p[k][0] = x + a * u - d * v, p[k][1] = y + a * v + d * u;
            }
            assert_int_equal(culture_add_building(&culture, &b, (const double(*)[2])p, 4), STATUS_OK);
        }
    const double      road[2][2] = {{-700, 60}, {700, 75}};
    const CultureLine street = {.id = id, .width_m = 6, .kind = CULTURE_ROAD, .surface = SURFACE_ROAD};
    assert_int_equal(culture_add_line(&culture, &street, road, 2), STATUS_OK);
    assert_int_equal(culture_index(&culture), STATUS_OK);
    ClutterConfig c = about(&plain, 700);
    c.culture = &culture, c.density = 10;
    Scenery s = add(&c);
    int     near = 0, beside = 0, driven = 0;
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const Model         *m = &s.model[o->model];
        const double        *r = o->r_enu_from_body;
        const double         across_m = (o->p_enu[1] - 60 - (o->p_enu[0] + 700) * 15 / 1400) * cos(atan2(15, 1400));
        near += culture_building_at(&culture, o->p_enu[0], o->p_enu[1], 8) >= 0;
        if (is_driven(&s, k)) {
            driven += fabs(across_m) < 3;
            continue;
        }
        beside += fabs(across_m) < 6;
        /* its corners, and the middles of its sides */
        for (int n = 0; n < 9; n++) {
            const double a = 0.5 * (n % 3 - 1) * m->length_m, b = 0.5 * (n / 3 - 1) * m->width_m;
            const double x = o->p_enu[0] + a * r[0] + b * r[1], y = o->p_enu[1] + a * r[3] + b * r[4];
            CHECK(culture_building_at(&culture, x, y, 0) < 0);
            WayPlace way;
            CHECK(fabs(y - 60 - (x + 700) * 15 / 1400) > 2.9);
            if (landscape_way(&way, &plain, x, y)) CHECK(fabs(way.across_m) > way.half_m - 0.3);
        }
    }
    print_message("%d things, %d about 81 buildings, %d beside the road, %d on it\n", s.objects, near, beside, driven);
    CHECK(near > 80 && beside > 3 && driven > 3);
    scenery_free(&s);
    culture_free(&culture);
}

static void nothing_stands_in_another(void **state)
{
    (void)state;
    ClutterConfig c = about(&plain, 1500);
    c.density = 10;
    Scenery s = add(&c);
    CHECK(s.objects > 2000);
    for (int a = 0; a < s.objects; a++)
        for (int b = 0; b < a; b++) {
            const Model  *ma = &s.model[s.object[a].model], *mb = &s.model[s.object[b].model];
            const double *p = s.object[a].p_enu, *q = s.object[b].p_enu;
            const double  room_m = 0.49 * (hypot(ma->length_m, ma->width_m) + hypot(mb->length_m, mb->width_m));
            if (fabs(p[0] - q[0]) > room_m || hypot(p[0] - q[0], p[1] - q[1]) > room_m) continue;
            if (!is_driven(&s, a) && !is_driven(&s, b)) fail_msg("%d and %d touch", a, b);
        }
    scenery_free(&s);
}

/* ---- what drives -------------------------------------------------------------------------------- */

/* A square of 100 m: where and whither it is after so many metres is known. */
static void a_mover_follows_its_path(void **state)
{
    (void)state;
    double        path[4][3] = {{0, 0, 1}, {0, 100, 1}, {100, 100, 1}, {100, 0, 1}}, p[3], r[9];
    const Scenery s = {.paths = 4, .path_enu = path};
    SceneryMover  m = {.count = 4, .speed_mps = 5, .phase_m = 30};
    static const struct {
        double t_s, x, y, east, north;
    } want[] = {{0, 0, 30, 0, 1}, {10, 0, 80, 0, 1}, {20, 30, 100, 1, 0}, {40, 100, 70, 0, -1}, {60, 70, 0, -1, 0},
                {74, 0, 0, 0, 1}, {80, 0, 30, 0, 1}, {-16, 50, 0, -1, 0}, {8e6, 0, 30, 0, 1}};
    for (size_t k = 0; k < sizeof want / sizeof *want; k++) {
        scenery_pose(p, r, &s, &m, want[k].t_s);
        CHECK_NEAR(p[0], want[k].x, 1e-6);
        CHECK_NEAR(p[1], want[k].y, 1e-6);
        CHECK_NEAR(p[2], 1, 1e-12);
        CHECK_NEAR(r[0], want[k].east, 1e-9);
        CHECK_NEAR(r[3], want[k].north, 1e-9);
        CHECK_NEAR(r[8], -1, 1e-12);
        CHECK_NEAR(r[1], want[k].north, 1e-9); /* right of north is east */
    }
}

static void drivers_keep_right(void **state)
{
    (void)state;
    ClutterConfig c = about(&land, 2400);
    c.density = 3;
    Scenery s = add_rows(&c, "car,car,,road,2,1,1,0,0,0,drives,0,0\nvan,car,,lane,3,1,1,0,0,0,drives,0,0\n"
                             "lorry,semi_trailer,,road,0.5,1,1,0,0,0,drives,0,0\n");
    int     right = 0, all = 0, roads = 0;
    CHECK(s.movers > 20 && s.movers == s.objects);
    for (int k = 0; k < s.movers; k++) {
        const SceneryMover *m = &s.mover[k];
        double              p[3], q[3], r[9];
        CHECK(m->first >= 0 && m->first + m->count <= s.paths && m->object == k);
        scenery_pose(p, r, &s, m, 0);
        for (int i = 0; i < 3; i++) CHECK(p[i] == s.object[k].p_enu[i]);
        const SceneryState *of = &s.state[s.object[k].state];
        CHECK_NEAR((double)of->drives.speed_mps, m->speed_mps, 0.251 * m->speed_mps);
        CHECK(of->drives.engine > 0.6f && of->stood_s == 0);
        for (int n = 0; n < 40; n++) {
            const double t_s = 7.3 * n;
            WayPlace     way;
            scenery_pose(p, r, &s, m, t_s);
            scenery_pose(q, r, &s, m, t_s + 0.05);
            /* a chord over a bend, or a turn at an end, is shorter */
            CHECK(hypot(q[0] - p[0], q[1] - p[1]) <= 0.05 * m->speed_mps * (1 + 1e-9));
            CHECK_NEAR(elevation_height(&land.elevation, p[0], p[1], NULL), p[2], 0.6);
            for (int f = 0; f < 64; f++) CHECK(hypot(p[0] - fix[f].p_enu[0], p[1] - fix[f].p_enu[1]) > 8);
            if (!landscape_way(&way, &land, p[0], p[1])) continue;
            const double along = r[0] * way.direction[0] + r[3] * way.direction[1];
            all += fabs(along) > 0.9;
            right += fabs(along) > 0.9 && (along > 0) == (way.across_m < 0) && fabs(way.across_m) < way.half_m;
        }
        roads += m->speed_mps > 12;
        for (int o = 0; o < k; o++) { /* of one path: as fast, and never in each other */
            if (s.mover[o].first != m->first) continue;
            CHECK(s.mover[o].speed_mps == m->speed_mps);
            for (int n = 0; n < 8; n++) {
                scenery_pose(p, r, &s, m, 20.0 * n), scenery_pose(q, r, &s, &s.mover[o], 20.0 * n);
                const double ahead = hypot(p[0] - q[0], p[1] - q[1]);
                CHECK(ahead > 1.3);
            }
        }
    }
    print_message("%d drive, %d on roads; %d of %d times on the right\n", s.movers, roads, right, all);
    CHECK(all > 20 * s.movers && right > 0.96 * all && roads > 0 && roads < s.movers);
    scenery_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_clear_of_the_exercise), cmocka_unit_test(keeps_off_what_is_built),
        cmocka_unit_test(nothing_stands_in_another),   cmocka_unit_test(a_mover_follows_its_path),
        cmocka_unit_test(drivers_keep_right),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
