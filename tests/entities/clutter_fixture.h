/* tests/entities/clutter_fixture.h: two landscapes, and clutter on them by tables made by hand. */
#ifndef TESTS_ENTITIES_CLUTTER_FIXTURE_H
#define TESTS_ENTITIES_CLUTTER_FIXTURE_H

#include "tests/check.h"

#include "entities/scenery/scenery_clutter_private.h"

static Landscape land, plain;
static GroundFix fix[64];
static ClearLine line[16];

/* A landscape with a column of vehicles, and flat shots over it; another without evidence. */
static inline int setup(void **state)
{
    (void)state;
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = 5, config.half_width_m = 2500, config.horizon_m = 20000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return 1;
    for (int k = 0; k < 64; k++)
        fix[k] = (GroundFix){{20.0 * k - 600, 300 + 60 * sin(0.2 * k), 2 * sin(0.1 * k)}, k / 8 + 1};
    for (int k = 0; k < 16; k++)
        line[k] = (ClearLine){{-900, -800 + 100.0 * k, 30}, {900, -850 + 105.0 * k, 3.0 + 0.2 * k}};
    return landscape_create(&land, &config, &frame, fix, 64, line, 16) != STATUS_OK ||
           landscape_create(&plain, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK;
}

static inline int teardown(void **state)
{
    (void)state;
    landscape_destroy(&land), landscape_destroy(&plain);
    return 0;
}

static inline ClutterConfig about(const Landscape *l, double half_m)
{
    ClutterConfig c = clutter_default_config();
    c.landscape = l, c.seed = 3, c.most = clutter_most_objects, c.sag_m = 0.1;
    for (int k = 0; k < 2; k++) c.south_west_m[k] = -half_m, c.north_east_m[k] = half_m;
    return c;
}

static inline Scenery add(const ClutterConfig *c)
{
    Scenery s = {0};
    assert_int_equal(scenery_add_clutter(&s, c), STATUS_OK);
    return s;
}

#define HEADER                                                                                                         \
    "class,shape,paint,where,density,group_low,group_high,spread_m,length_low_m,length_high_m,heat,running,recent\n"

/* A scenery by a table of these rows. */
static inline Scenery add_rows(ClutterConfig *c, const char *rows)
{
    char path[text_file_size], text[2048];
    snprintf(text, sizeof text, HEADER "%s\n", rows);
    text_file(path, text);
    c->table = path;
    Scenery s = add(c);
    c->table = NULL;
    remove(path);
    return s;
}

static inline bool is_driven(const Scenery *s, int object)
{
    for (int k = 0; k < s->movers; k++)
        if (s->mover[k].object == object) return true;
    return false;
}

#endif
