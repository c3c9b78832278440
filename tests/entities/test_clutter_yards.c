/* Clutter in yards: as dense on a yard's ground as its table says; in invented farms and works, by an oracle of
 * rectangles and outlines of its own, never in a wall, a fence, a tank or another thing, nor near what was reported. */
#include "tests/entities/clutter_fixture.h"

#include "terrain/culture/culture_invented.h"

/* ---- rectangles, by separating axes ------------------------------------------------------------- */

typedef struct Box {
    double corner_m[4][2];
} Box;

static Box box_about(double x_m, double y_m, double forward_x, double forward_y, double length_m, double width_m)
{
    Box          b;
    const double run = hypot(forward_x, forward_y), f[2] = {forward_x / run, forward_y / run};
    for (int k = 0; k < 4; k++) {
        const double a = (k == 1 || k == 2 ? 0.5 : -0.5) * length_m, c = (k >= 2 ? 0.5 : -0.5) * width_m;
        b.corner_m[k][0] = x_m + a * f[0] - c * f[1], b.corner_m[k][1] = y_m + a * f[1] + c * f[0];
    }
    return b;
}

static bool is_apart(const double (*a)[2], int as, const double (*b)[2], int bs)
{
    for (int k = 0; k < as; k++) {
        const double n[2] = {a[(k + 1) % as][1] - a[k][1], a[k][0] - a[(k + 1) % as][0]};
        double       highest = -INFINITY, lowest = INFINITY;
        for (int i = 0; i < as; i++) highest = fmax(highest, n[0] * a[i][0] + n[1] * a[i][1]);
        for (int i = 0; i < bs; i++) lowest = fmin(lowest, n[0] * b[i][0] + n[1] * b[i][1]);
        if (lowest >= highest) return true;
    }
    return false;
}

static bool meet(const Box *a, const Box *b)
{
    const double(*p)[2] = a->corner_m, (*q)[2] = b->corner_m;
    return !is_apart(p, 4, q, 4) && !is_apart(q, 4, p, 4);
}

static Box box_of(const Scenery *s, int object)
{
    const SceneryObject *o = &s->object[object];
    const Model         *m = &s->model[o->model];
    return box_about(o->p_enu[0], o->p_enu[1], o->r_enu_from_body[0], o->r_enu_from_body[3], 0.98 * m->length_m,
                     0.98 * m->width_m);
}

/* What of a culture a thing is in; NULL: nothing. Outlines of invented buildings are convex. */
static const char *stands_in(const Culture *c, const Box *box)
{
    const double *p = box->corner_m[0];
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        const double(*corner)[2] = (const double(*)[2])c->corner_m + b->first_corner;
        if (hypot(corner[0][0] - p[0], corner[0][1] - p[1]) < 150 && !is_apart(corner, b->corners, box->corner_m, 4) &&
            !is_apart(box->corner_m, 4, corner, b->corners))
            return "a building";
    }
    for (int n = 0; n < c->lines; n++) {
        const CultureLine *l = &c->line[n];
        for (int k = 0; k + 1 < l->corners && l->kind != CULTURE_YARD && l->kind != CULTURE_POWER_LINE; k++) {
            const double *a = c->corner_m[l->first_corner + k], *b = c->corner_m[l->first_corner + k + 1];
            const double  long_m = hypot(b[0] - a[0], b[1] - a[1]);
            if (long_m <= 0 || hypot(a[0] - p[0], a[1] - p[1]) > long_m + 40) continue;
            const Box of = box_about(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), b[0] - a[0], b[1] - a[1], long_m,
                                     (double)l->width_m);
            if (meet(&of, box)) return l->kind == CULTURE_TRACK || l->kind == CULTURE_ROAD ? "a way" : "a fence";
        }
    }
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *t = &c->point[n];
        const double        heading = (double)t->heading_rad;
        const Box           of =
            box_about(t->x_m, t->y_m, sin(heading), cos(heading), (double)t->size_m[0], (double)t->size_m[1]);
        if (hypot(t->x_m - p[0], t->y_m - p[1]) < 40 && meet(&of, box)) return "a thing of the culture";
    }
    return NULL;
}

static bool is_on_yard(const Culture *c, double x_m, double y_m)
{
    const int n = culture_line_near(c, CULTURE_YARD, x_m, y_m, 0);
    return n >= 0;
}

/* ---- tests -------------------------------------------------------------------------------------- */

/* Yards without anything on them, far apart: a Poisson number on each, four standard deviations. */
static void as_dense_as_the_table(void **state)
{
    Culture culture = {0};
    double  hectares[2] = {0};
    (void)state;
    for (int j = -9; j <= 9; j++)
        for (int i = -9; i <= 9; i++) {
            const bool        paved = (i + j) & 1;
            const double      x = 110 * i, y = 110 * j, p[2][2] = {{x - 20, y}, {x + 20, y + 9}};
            const CultureLine yard = {.id = (uint64_t)(100 + 20 * j + i),
                                      .width_m = paved ? 22 : 18,
                                      .kind = CULTURE_YARD,
                                      .surface = paved ? SURFACE_BUILT : SURFACE_BARE_SOIL};
            double            normal[3];
            elevation_height(&plain.elevation, x, y, normal);
            if (hypot(normal[0], normal[1]) > 0.2 * normal[2]) continue;
            assert_int_equal(culture_add_line(&culture, &yard, p, 2), STATUS_OK);
            hectares[paved] += 41 * (double)yard.width_m * 1e-4;
        }
    const double   far[4][2] = {{2000, 2000}, {2010, 2000}, {2010, 2010}, {2000, 2010}};
    const Building one = {.id = 1, .use = BUILDING_SHED, .eaves_m = 3, .ridge_m = 3, .levels = 1};
    assert_int_equal(culture_add_building(&culture, &one, far, 4), STATUS_OK);
    assert_int_equal(culture_index(&culture), STATUS_OK);
    ClutterConfig c = about(&plain, 1200);
    c.culture = &culture;
    Scenery s = add_rows(&c, "crates,crates,,farmyard,15,1,1,0,0,0,cold,0,0\n"
                             "crates,crates,,works,12,1,1,0,0,0,cold,0,0\n");
    double  got[2] = {0};
    for (int k = 0; k < s.objects; k++) {
        const int n = culture_line_near(&culture, CULTURE_YARD, s.object[k].p_enu[0], s.object[k].p_enu[1], 0);
        CHECK(n >= 0);
        got[culture.line[n].surface == SURFACE_BUILT]++;
    }
    for (int paved = 0; paved < 2; paved++) {
        const double want = (paved ? 12 : 15) * hectares[paved];
        print_message("%.2f hectares %s: %.0f crates, want %.0f\n", hectares[paved], paved ? "paved" : "unpaved",
                      got[paved], want);
        /* of two whose circles of 0.8 m and 0.3 m between touch one goes: 15e-4 pi 1.9^2 / 2, 0.9 % */
        CHECK(want > 150);
        CHECK_NEAR(got[paved], want, 4 * sqrt(want) + 0.02 * want);
    }
    scenery_free(&s);
    culture_free(&culture);
}

/* Farms and works as they are invented, with the table that is shipped, eight times as dense. */
static void farms_and_works_are_used(void **state)
{
    static const double half_m = 5000;
    Landscape           wide;
    LandscapeConfig     config = landscape_default_config();
    LocalFrame          frame;
    Culture             culture;
    int                 on[CLUTTER_CLASSES] = {0}, beside = 0, in_another = 0, yards = 0;
    (void)state;
    config.seed = 5, config.half_width_m = half_m, config.horizon_m = 20000;
    CHECK(local_frame_at(&frame, &(Geodetic){0.6, -1.9, 700}) == STATUS_OK);
    CHECK(landscape_create(&wide, &config, &frame, NULL, 0, NULL, 0) == STATUS_OK);
    CHECK(culture_invent(&culture, &wide, &(CultureConfig){3, {0, 0}, half_m}) == STATUS_OK);
    ClutterConfig c = about(&wide, half_m);
    c.culture = &culture, c.density = 8;
    /* vehicles that came there only now stand in every third yard */
    LandscapeEvidence evidence = {0};
    GroundFix        *at = calloc((size_t)culture.lines + 1, sizeof *at);
    for (int n = 0; n < culture.lines; n++) {
        const double(*p)[2] = (const double(*)[2])culture.corner_m + culture.line[n].first_corner;
        if (culture.line[n].kind != CULTURE_YARD || yards++ % 3) continue;
        for (int k = 0; k < 2; k++) at[evidence.fix_count].p_enu[k] = 0.5 * (p[0][k] + p[1][k]);
        at[evidence.fix_count++].voter = 1;
    }
    evidence.fix = at, c.evidence = &evidence;
    Scenery s = add(&c);
    int    *near = malloc((size_t)s.objects * sizeof *near), nears = 0;
    for (int k = 0; k < s.objects; k++) {
        const SceneryObject *o = &s.object[k];
        const double        *p = o->p_enu;
        const bool           yard = is_on_yard(&culture, p[0], p[1]);
        if (is_driven(&s, k) || (!yard && culture_building_at(&culture, p[0], p[1], 8) < 0)) continue;
        const Box   box = box_of(&s, k);
        const char *what = stands_in(&culture, &box);
        if (what) fail_msg("a %s at %.1f %.1f stands in %s", scenery_class_name(o->class), p[0], p[1], what);
        for (int n = 0; n < evidence.fix_count; n++)
            CHECK(hypot(at[n].p_enu[0] - p[0], at[n].p_enu[1] - p[1]) > clutter_clear_m);
        for (int n = 0; n < nears; n++) {
            const double *q = s.object[near[n]].p_enu;
            if (hypot(p[0] - q[0], p[1] - q[1]) > 30) continue;
            const Box other = box_of(&s, near[n]);
            in_another += meet(&box, &other);
        }
        near[nears++] = k;
        if (yard) on[o->class]++;
        else beside++;
    }
    print_message("%d yards, %d vehicles in them\n", yards, evidence.fix_count);
    for (int n = 1; n < CLUTTER_CLASSES; n++)
        if (on[n]) print_message("%s %d, ", scenery_class_name((SceneryClass)n), on[n]);
    print_message("in yards; %d beside buildings elsewhere\n", beside);
    CHECK(in_another == 0 && yards > 30 && beside > 100);
    CHECK(on[CLUTTER_TRACTOR] > 10 && on[CLUTTER_TRAILER] > 10 && on[CLUTTER_CAR] > 20 && on[CLUTTER_GENERATOR] > 3);
    CHECK(on[CLUTTER_CONTAINER] > 3 && on[CLUTTER_MACHINE] > 2 && on[CLUTTER_LORRY] > 3);
    scenery_free(&s);
    culture_free(&culture);
    landscape_destroy(&wide);
    free(at), free(near);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_dense_as_the_table),
        cmocka_unit_test(farms_and_works_are_used),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
