/* Roads, tracks and waters of culture as surfaces of the ground: where they are and nowhere else, the same by one, by
 * eight and by squares, of any width; nothing changes without; and its trees in the woods. labels: physics */
#include "tests/check.h"

#include "terrain/culture/culture_ground.h"
#include "terrain/woods/woods.h"

static Landscape  land;
static LocalFrame frame;

static int open_ground(void **state)
{
    LandscapeConfig config = landscape_default_config();
    (void)state;
    config.seed = 3;
    if (local_frame_at(&frame, &(Geodetic){49 * rad_per_deg, 11 * rad_per_deg, 300}) != STATUS_OK) return 1;
    return landscape_create(&land, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK;
}

static int close_ground(void **state)
{
    (void)state;
    landscape_destroy(&land);
    return 0;
}

static const struct {
    double  p[2][2];
    float   width_m;
    uint8_t surface;
} lines[] = {{{{-400, -300}, {500, 350}}, 8, SURFACE_ROAD},
             {{{-300, 400}, {350, -450}}, 0.3f, SURFACE_TRACK}, /* a path */
             {{{-500, 100}, {500, 130}}, 20, SURFACE_WATER},
             {{{0, -500}, {0, 500}}, 6, SURFACE_NONE}}; /* a bridge */
enum { line_count = sizeof lines / sizeof *lines };

static void make(Culture *c)
{
    for (int n = 0; n < line_count; n++) {
        const CultureLine l = {.width_m = lines[n].width_m, .surface = lines[n].surface};
        assert_int_equal(culture_add_line(c, &l, lines[n].p, 2), STATUS_OK);
    }
    assert_int_equal(culture_index(c), STATUS_OK);
}

/* The surface that the last line over a place has; negative: within a micrometre of an edge. */
static int laid(double x_m, double y_m)
{
    int surface = SURFACE_NONE;
    for (int n = 0; n < line_count; n++) {
        const double *a = lines[n].p[0], *b = lines[n].p[1], dx = b[0] - a[0], dy = b[1] - a[1];
        const double  t = fmin(fmax(((x_m - a[0]) * dx + (y_m - a[1]) * dy) / (dx * dx + dy * dy), 0), 1);
        const double  over_m = hypot(x_m - a[0] - t * dx, y_m - a[1] - t * dy) - 0.5 * (double)lines[n].width_m;
        if (fabs(over_m) < 1e-6) return -1;
        if (over_m < 0 && lines[n].surface) surface = lines[n].surface;
    }
    return surface;
}

static void lines_are_surfaces(void **state)
{
    enum { places = 40000 };
    static double  x_m[places], y_m[places];
    static uint8_t bare[places], with[places], again[places];
    int            seen[SURFACE_COUNT] = {0};
    Culture        c = {0};
    (void)state;
    for (int k = 0; k < places; k++) {
        x_m[k] = 1200 * (random_uniform(9, 1, 0, (uint64_t)k) - 0.5),
        y_m[k] = 1200 * (random_uniform(9, 2, 0, (uint64_t)k) - 0.5);
        if (k % 8 == 0) { /* on the path, which chance seldom meets */
            const double t = random_uniform(9, 3, 0, (uint64_t)k);
            x_m[k] = -300 + 650 * t + 0.2 * random_uniform(9, 4, 0, (uint64_t)k), y_m[k] = 400 - 850 * t;
        }
    }
    landscape_surfaces(bare, &land, places, x_m, y_m);
    make(&c);
    culture_lay(&land, &c);
    landscape_surfaces(with, &land, places, x_m, y_m);
    for (int k = 0; k < places; k++) {
        const int want = laid(x_m[k], y_m[k]);
        if (want < 0) continue;
        if (with[k] != (want ? want : bare[k])) fail_msg("%g, %g: %d, want %d", x_m[k], y_m[k], with[k], want);
        if (k < 2000) CHECK(landscape_surface(&land, x_m[k], y_m[k]) == with[k]);
        seen[want]++;
    }
    CHECK(seen[SURFACE_ROAD] > 200 && seen[SURFACE_TRACK] > 1000 && seen[SURFACE_WATER] > 300);
    culture_lay(&land, NULL);
    landscape_surfaces(again, &land, places, x_m, y_m);
    assert_memory_equal(again, bare, sizeof bare);
    /* culture without surfaces lays nothing */
    Culture           none = {0};
    const CultureLine bridge = {.width_m = 6};
    assert_int_equal(culture_add_line(&none, &bridge, lines[0].p, 2), STATUS_OK);
    assert_int_equal(culture_index(&none), STATUS_OK);
    culture_lay(&land, &none);
    CHECK(land.over.of == NULL);
    culture_free(&none), culture_free(&c);
}

/* Of a pixel's square every place, also where a line is narrower than the pattern of those looked at first. */
static void squares_miss_nothing(void **state)
{
    enum { side = 16 };
    double  x_m[side * side], y_m[side * side];
    uint8_t square[side * side], one[side * side], bare[side * side];
    Culture c = {0};
    int     over = 0, mixed = 0;
    (void)state;
    make(&c);
    for (int n = 0; n < 1500; n++) {
        const double t = random_uniform(4, 1, 0, (uint64_t)n), wide_m = n % 2 ? 4 : 12, turned = 0.01 * n;
        const double at[2] = {-300 + 650 * t, 400 - 850 * t};
        for (int k = 0; k < side * side; k++) {
            const double u = wide_m * ((k % side + 0.5) / side - 0.5), v = wide_m * ((k / side + 0.5) / side - 0.5);
            x_m[k] = at[0] + u * cos(turned) - v * sin(turned), y_m[k] = at[1] + u * sin(turned) + v * cos(turned);
        }
        culture_lay(&land, NULL);
        landscape_surfaces_square(bare, &land, side, x_m, y_m);
        culture_lay(&land, &c);
        landscape_surfaces_square(square, &land, side, x_m, y_m);
        landscape_surfaces(one, &land, side * side, x_m, y_m);
        int path = 0;
        for (int k = 0; k < side * side; k++) {
            const int want = laid(x_m[k], y_m[k]);
            if (want > 0) CHECK(square[k] == want && one[k] == want);
            if (want == 0 && n % 2) CHECK(square[k] == bare[k] || square[k] == one[k]);
            path += want == SURFACE_TRACK;
        }
        over += path > 0, mixed += path > 0 && path < side * side / 8;
    }
    CHECK(over > 1000 && mixed > 500); /* most squares have a path in them that covers less than an eighth */
    culture_lay(&land, NULL);
    culture_free(&c);
}

/* ---- trees ------------------------------------------------------------------------------------------- */

static int same_plants(const Woods *a, const Woods *b)
{
    return a->count == b->count && memcmp(a->plant, b->plant, (size_t)a->count * sizeof *a->plant) == 0;
}

static void trees_stand_where_they_are(void **state)
{
    (void)state;
    Woods       bare, none, with;
    Culture     c = {0};
    WoodsConfig config = {.seed = 5, .half_width_m = 400, .most_trees = woods_most_trees};
    assert_int_equal(woods_create(&bare, &land, &config, NULL), STATUS_OK);
    assert_int_equal(culture_index(&c), STATUS_OK);
    config.culture = &c;
    assert_int_equal(woods_create(&none, &land, &config, NULL), STATUS_OK);
    CHECK(same_plants(&bare, &none));
    enum { trees = 300 };
    for (int k = 0; k < trees; k++) {
        const CultureTree t = {.id = (uint64_t)k,
                               .x_m = 780 * (random_uniform(8, 1, 0, (uint64_t)k) - 0.5),
                               .y_m = 780 * (random_uniform(8, 2, 0, (uint64_t)k) - 0.5),
                               .height_m = k % 3 ? 5 + 0.05f * (float)k : 0,
                               .kind = (uint8_t)(k % PLANT_STANDING),
                               .mark = (uint8_t)(k % 2)};
        assert_int_equal(culture_add_tree(&c, &t), STATUS_OK);
    }
    assert_int_equal(culture_index(&c), STATUS_OK);
    assert_int_equal(woods_create(&with, &land, &config, NULL), STATUS_OK);
    CHECK(with.count == bare.count + trees); /* all others stay */
    for (int k = 0; k < trees; k++) {
        const CultureTree *t = &c.tree[k];
        int                found = 0;
        for (int n = 0; n < with.count; n++) {
            const Plant *p = &with.plant[n];
            const double x = with.origin_enu[0] + (double)p->p_m[0], y = with.origin_enu[1] + (double)p->p_m[1];
            if (p->kind != t->kind || hypot(x - t->x_m, y - t->y_m) > 1e-3) continue;
            found++;
            if (t->height_m > 0) CHECK_NEAR(plant_height_m(p), (double)t->height_m, 0.0051);
            else CHECK(plant_height_m(p) > 1 && plant_height_m(p) < 25);
            CHECK_NEAR(with.origin_enu[2] + (double)p->p_m[2], elevation_height(&land.elevation, x, y, NULL), 0.01);
        }
        if (found != 1) fail_msg("tree %d: %d plants", k, found);
    }
    woods_destroy(&bare), woods_destroy(&none), woods_destroy(&with);
    culture_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_surfaces),
        cmocka_unit_test(squares_miss_nothing),
        cmocka_unit_test(trees_stand_where_they_are),
    };
    return cmocka_run_group_tests(tests, open_ground, close_ground);
}
