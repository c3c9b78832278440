/* Works of a culture as meshes: walls, fences, power lines, bridges; poles, tanks, heaps, masts: closed, of their
 * sizes, on the ground. labels: physics */
#include "tests/entities/buildings_fixture.h"

/* A valley along y: 8 m deep at x = 40. */
static double valley(void *user, double x_m, double y_m)
{
    (void)user, (void)y_m;
    return 50 - 8 * exp(-(x_m - 40) * (x_m - 40) / 200);
}

static Scenery scenery_of_line(int kind, float width_m, float height_m, const double (*p)[2], int n)
{
    Culture           c = {0};
    Scenery           s = {0};
    const CultureLine line = {.id = 11, .width_m = width_m, .height_m = height_m, .kind = (uint8_t)kind};
    CHECK(culture_add_line(&c, &line, p, n) == STATUS_OK && c.lines == 1);
    CHECK(scenery_add_buildings(&s, &c, valley, NULL) == STATUS_OK);
    for (int k = 0; k < s.models; k++)
        for (int q = 0; q < s.model[k].part_count; q++) CHECK(s.part_of[s.part_first[k] + q] == 11);
    culture_free(&c);
    return s;
}

static void every_kind_of_line_is_closed(void **state)
{
    (void)state;
    static const double p[][2] = {{-200, 3}, {-60, 3}, {-60, 3}, {10, 40}, {10, 42}, {9, 3}, {150, -100}, {-20, -90}};
    for (int kind = 0; kind < CULTURE_LINE_KINDS; kind++)
        for (int high = 0; high < 2; high++) {
            Scenery s = scenery_of_line(kind, 3, high ? 20 : 0, p, 8);
            check_closed(&s);
            CHECK((s.models == 0) == (kind >= CULTURE_ROAD));
            /* no cell has what lies far outside of it */
            for (int k = 0; k < s.models; k++)
                for (int t = 0; t < s.model[k].triangle_count; t++) {
                    const Facet f = facet(&s, k, t);
                    CHECK(v3_length(f.n) > 1e-10);
                    for (int i = 0; i < 2 && kind != CULTURE_POWER_LINE; i++)
                        CHECK(fabs(f.p[0][i] - s.object[k].p_enu[i]) < 0.5 * scenery_cell_m + 10);
                }
            scenery_free(&s);
        }
}

/* A wall of a width and height along a straight line on level ground: the volume over the ground is their product. */
static void a_wall_has_its_volume(void **state)
{
    (void)state;
    static const double p[][2] = {{-100, 5}, {-10, 5}}; /* two cells; the valley is far */
    Scenery             s = scenery_of_line(CULTURE_WALL, 0.5F, 1.5F, p, 2);
    double              top_m2 = 0, low_m = INFINITY, high_m = -INFINITY;
    assert_int_equal(s.models, 1);
    for (int t = 0; t < s.model[0].triangle_count; t++) {
        const Facet f = facet(&s, 0, t);
        if (f.n[2] > 0.9 * v3_length(f.n)) top_m2 += 0.5 * f.n[2];
        for (int k = 0; k < 3; k++) {
            CHECK(f.p[k][0] > -100 - 1e-9 && f.p[k][0] < -10 + 1e-9 && fabs(f.p[k][1] - 5) < 0.25 + 1e-9);
            low_m = fmin(low_m, f.p[k][2]), high_m = fmax(high_m, f.p[k][2]);
        }
    }
    CHECK_NEAR(top_m2, 90 * 0.5, 1e-6);
    assert_int_equal(s.model[0].triangle_count, 12 * 8 + 4); /* one band of twelve pieces */
    CHECK_NEAR(high_m, 51.5, 2e-5);
    CHECK(low_m < 49.7);
    scenery_free(&s);
}

static void fences_follow_the_ground(void **state)
{
    (void)state;
    static const double p[][2] = {{5, 20}, {75, 20}};
    static const int    kinds[2] = {CULTURE_FENCE, CULTURE_WIRE_FENCE};
    for (int k = 0; k < 2; k++) {
        Scenery s = scenery_of_line(kinds[k], 0.1F, 1.2F, p, 2);
        int     posts = 0;
        for (int t = 0; t < s.model[0].triangle_count; t++) {
            const Facet f = facet(&s, 0, t);
            posts += is_part(&f, "post");
            for (int i = 0; i < 3; i++) {
                const double over_m = f.p[i][2] - valley(NULL, f.p[i][0], 0);
                CHECK(over_m < 1.45 && over_m > (is_part(&f, "post") ? -0.5 : 0.1));
            }
        }
        const double apart_m = 70.0 / (posts / 12 - 1);
        CHECK(posts % 12 == 0 && apart_m > 2 && apart_m < 4.5);
        scenery_free(&s);
    }
}

/* Wires hang as parabolas: at the middle of a span of 60 m by a fiftieth of it lower than at the poles, 12 mm thick. */
static void wires_sag(void **state)
{
    (void)state;
    static const double p[][2] = {{-120, 5}, {-60, 5}};
    Scenery             s = scenery_of_line(CULTURE_POWER_LINE, 0, 10, p, 2);
    double              ends_m = -INFINITY, middle_m = INFINITY, least_y = INFINITY, most_y = -INFINITY, posts_m = 0;
    for (int t = 0; t < s.model[0].triangle_count; t++) {
        const Facet f = facet(&s, 0, t);
        for (int k = 0; k < 3; k++) {
            if (is_part(&f, "post")) posts_m = fmax(posts_m, f.p[k][2]);
            if (!is_part(&f, "wire")) continue;
            ends_m = fmax(ends_m, f.p[k][2]);
            if (fabs(f.p[k][0] + 90) < 0.01) middle_m = fmin(middle_m, f.p[k][2]);
            least_y = fmin(least_y, f.p[k][1]), most_y = fmax(most_y, f.p[k][1]);
        }
    }
    CHECK_NEAR(ends_m - middle_m, 60.0 / 50 + 0.012, 1e-6);
    CHECK_NEAR(posts_m, 60, 1e-4);
    CHECK_NEAR(most_y - least_y, 2 * 0.99 + 0.012, 1e-6);
    scenery_free(&s);
}

/* Where poles between are not recorded, wires do not hang to the ground: 10 m high over 600 m. */
static void long_spans_stay_off_the_ground(void **state)
{
    (void)state;
    static const double p[][2] = {{-680, 5}, {-80, 5}};
    Scenery             s = scenery_of_line(CULTURE_POWER_LINE, 0, 10, p, 2);
    double              least_m = INFINITY;
    for (int m = 0; m < s.models; m++)
        for (int t = 0; t < s.model[m].triangle_count; t++) {
            const Facet f = facet(&s, m, t);
            for (int k = 0; k < 3 && is_part(&f, "wire"); k++) least_m = fmin(least_m, f.p[k][2]);
        }
    CHECK_NEAR(least_m, 50 + 0.97 * 10 + 0.2 - 3.5, 0.01);
    scenery_free(&s);
}

/* A bridge over the valley is straight between its ends, as wide as said, and stands on piers that reach the ground. */
static void a_bridge_crosses_the_valley(void **state)
{
    (void)state;
    static const double p[][2] = {{2, 10}, {78, 10}};
    Scenery             s = scenery_of_line(CULTURE_BRIDGE, 6, 0, p, 2);
    double              deck_m2 = 0;
    int                 piers = 0, rails[2] = {0};
    for (int t = 0; t < s.model[0].triangle_count; t++) {
        const Facet f = facet(&s, 0, t);
        for (int k = 0; k < 3 && is_part(&f, "deck"); k++) CHECK(f.p[k][2] < 50.01 && f.p[k][2] > 48);
        if (is_part(&f, "deck") && f.n[2] > 0.9 * v3_length(f.n)) deck_m2 += 0.5 * f.n[2];
        if (is_part(&f, "rail")) rails[f.p[0][1] > 10]++;
        if (!is_part(&f, "base") || f.n[2] > -0.9 * v3_length(f.n)) continue;
        piers++;
        for (int k = 0; k < 3; k++) CHECK(f.p[k][2] < valley(NULL, f.p[k][0], 0) - 0.3);
    }
    CHECK_NEAR(deck_m2, 76 * 6, 1e-3);
    CHECK(piers >= 4 && rails[0] > 0 && rails[0] == rails[1]);
    scenery_free(&s);
}

static void points_have_their_sizes(void **state)
{
    (void)state;
    static const struct {
        float       length_m, width_m, height_m, more_m; /* more: what stands out over the size */
        const char *part;
    } of[CULTURE_POINT_KINDS] = {[CULTURE_POLE] = {0.24F, 0.24F, 9, 0, "post"},
                                 [CULTURE_LAMP] = {0.3F, 0.3F, 6, 1.6F, "lamp"},
                                 [CULTURE_SIGN] = {0.8F, 0.8F, 2.4F, 0.1F, "plate"},
                                 [CULTURE_TANK] = {9, 7, 6, 0, "tank"},
                                 [CULTURE_SILO] = {4, 4, 14, 0, "silo"},
                                 [CULTURE_CONTAINER] = {6.06F, 2.44F, 2.59F, 0, "container"},
                                 [CULTURE_HEAP] = {6, 5, 2, 0, "heap"},
                                 [CULTURE_STACK] = {5, 3, 3, 0, "heap"},
                                 [CULTURE_CHIMNEY] = {4, 4, 40, 0, "chimney"},
                                 [CULTURE_MAST] = {2, 2, 30, 0.1F, "post"}};
    for (int kind = 0; kind < CULTURE_POINT_KINDS; kind++)
        for (uint64_t id = 0; id < 5; id++) {
            Culture            c = {0};
            Scenery            s = {0};
            const CulturePoint point = {.id = 100 + id,
                                        .x_m = 30,
                                        .y_m = -20,
                                        .base_m = 47,
                                        .heading_rad = (float)id,
                                        .size_m = {of[kind].length_m, of[kind].width_m, of[kind].height_m},
                                        .kind = (uint8_t)kind};
            CHECK(culture_add_point(&c, &point) == STATUS_OK && c.points == 1);
            CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
            check_closed(&s);
            double high_m = -INFINITY, far_m = 0, aside_m = 0;
            bool   named = false;
            for (int t = 0; t < s.model[0].triangle_count; t++) {
                const Facet f = facet(&s, 0, t);
                named = named || is_part(&f, of[kind].part);
                CHECK(f.facing > (kind == CULTURE_HEAP ? 0.9 : 0.7)); /* round ones are smooth */
                for (int k = 0; k < 3; k++) {
                    /* along its heading, clockwise from north, and across it */
                    const double e = f.p[k][0] - 30, n = f.p[k][1] + 20, h = (double)point.heading_rad;
                    CHECK(fabs(e * sin(h) + n * cos(h)) <
                          0.5 * (double)(of[kind].length_m + 2 * of[kind].more_m) + 1e-5);
                    CHECK(fabs(e * cos(h) - n * sin(h)) <
                          0.5 * (double)(of[kind].width_m + 2 * of[kind].more_m) + 1e-5);
                    CHECK(f.p[k][2] > 47 - 0.5);
                    far_m = fmax(far_m, fabs(e * sin(h) + n * cos(h)));
                    aside_m = fmax(aside_m, fabs(e * cos(h) - n * sin(h)));
                    high_m = fmax(high_m, f.p[k][2]);
                }
            }
            CHECK(named);
            /* layers of a stack lie a little out of place; a lamp or sign is wider than its post */
            const double least = kind == CULTURE_STACK ? 0.42 : 0.48;
            if (kind >= CULTURE_TANK) CHECK(far_m > least * (double)of[kind].length_m);
            if (kind >= CULTURE_TANK) CHECK(aside_m > least * (double)of[kind].width_m);
            CHECK_NEAR(high_m, 47 + (double)of[kind].height_m, 0.05);
            scenery_free(&s), culture_free(&c);
        }
}

/* More parts than one model should have: several models at one place. */
static void a_crowded_cell_is_several_models(void **state)
{
    (void)state;
    enum { poles = 40000 };
    Culture c = {0};
    Scenery s = {0};
    for (int k = 0; k < poles; k++) {
        const CulturePoint p = {.id = (uint64_t)k + 1,
                                .x_m = 0.5 * (k % 200) + 1,
                                .y_m = 0.5 * (k / 200) + 1,
                                .size_m = {0.2F, 0.2F, 5},
                                .kind = CULTURE_POLE};
        CHECK(culture_add_point(&c, &p) == STATUS_OK);
    }
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    assert_int_equal(s.models, 3);
    int parts = 0;
    for (int k = 0; k < 3; k++) {
        for (int q = 0; q < s.model[k].part_count; q++) CHECK(s.part_of[s.part_first[k] + q] == (uint64_t)++parts);
        CHECK(s.object[k].p_enu[0] == 64 && s.object[k].p_enu[1] == 64);
        CHECK(k == 0 || s.object[k].id != s.object[k - 1].id);
    }
    assert_int_equal(parts, poles);
    scenery_free(&s), culture_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_line_is_closed),   cmocka_unit_test(a_wall_has_its_volume),
        cmocka_unit_test(fences_follow_the_ground),       cmocka_unit_test(wires_sag),
        cmocka_unit_test(long_spans_stay_off_the_ground), cmocka_unit_test(a_bridge_crosses_the_valley),
        cmocka_unit_test(points_have_their_sizes),        cmocka_unit_test(a_crowded_cell_is_several_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
