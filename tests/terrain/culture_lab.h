/* tests/terrain/culture_lab.h: invented ground and its culture, for tests of them. */
#ifndef TESTS_TERRAIN_CULTURE_LAB_H
#define TESTS_TERRAIN_CULTURE_LAB_H

#include "tests/check.h"

#include "terrain/culture/culture_invented.h"

static inline void make(Landscape *land, uint64_t seed, double half_m, const LandscapeEvidence *evidence)
{
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = seed, config.half_width_m = half_m, config.horizon_m = 30000;
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    CHECK(landscape_create_from(land, &config, &frame, evidence ? evidence : &(LandscapeEvidence){0}) == STATUS_OK);
}

static inline Culture invent(const Landscape *land, double x_m, double y_m, double half_m)
{
    Culture culture;
    CHECK(culture_invent(&culture, land, &(CultureConfig){3, {x_m, y_m}, half_m}) == STATUS_OK);
    return culture;
}

/* The building whose outline's middle is at a place; NULL: none. */
static inline const Building *building_at(const Culture *c, double x_m, double y_m)
{
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        double          x = 0, y = 0;
        for (int k = 0; k < b->corners; k++) {
            x += c->corner_m[b->first_corner + k][0] / b->corners;
            y += c->corner_m[b->first_corner + k][1] / b->corners;
        }
        if (hypot(x - x_m, y - y_m) < 0.1) return b;
    }
    return NULL;
}

#endif
