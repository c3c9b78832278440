/* Invented culture: houses are where the cover draws them, nothing overlaps, nothing stands where something was
 * reported, in the way of a shot, on a slope or in water; the same from any thread and any square. */
#include "tests/check.h"

#include "terrain/culture/culture_invented.h"

#include <stdlib.h>

static void make(Landscape *land, uint64_t seed, double half_m, const LandscapeEvidence *evidence)
{
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    config.seed = seed, config.half_width_m = half_m, config.horizon_m = 30000;
    CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
    CHECK(landscape_create_from(land, &config, &frame, evidence ? evidence : &(LandscapeEvidence){0}) == STATUS_OK);
}

static Culture invent(const Landscape *land, double x_m, double y_m, double half_m)
{
    Culture culture;
    CHECK(culture_invent(&culture, land, &(CultureConfig){3, {x_m, y_m}, half_m}) == STATUS_OK);
    return culture;
}

/* ---- plots --------------------------------------------------------------------------------------- */

/* The building whose outline's middle is at a place; NULL: none. */
static const Building *building_at(const Culture *c, double x_m, double y_m)
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

/* Every house of a plot is there, but for a few on slopes and on each other; its corners are those of the rectangle
 * that the cover draws as built, which is tried just inside and, where nothing else is built, just outside of them. */
static void plots_have_their_houses(void **state)
{
    (void)state;
    int       plots, missing = 0, wrong = 0, inside = 0, outside = 0, heated = 0, houses = 0, steep = 0;
    Landscape land;
    make(&land, 5, 3000, NULL);
    Culture          c = invent(&land, 0, 0, 4000);
    const HousePlot *plot = landscape_plots(&land, &plots);
    for (int n = 0; n < plots; n++) {
        const HousePlot *p = &plot[n];
        const double     x = p->x_m + p->house[0] * p->direction[0] - p->house[1] * p->direction[1];
        const double     y = p->y_m + p->house[0] * p->direction[1] + p->house[1] * p->direction[0];
        const Building  *b = building_at(&c, x, y);
        if (!b) {
            missing++;
            continue;
        }
        houses++, heated += b->heated;
        CHECK(b->corners == 4 && b->id != 0 && (b->use == BUILDING_HOUSE || b->use == BUILDING_FLATS));
        const double pitch = atan2((double)(b->ridge_m - b->eaves_m), fmin(p->house_half[0], p->house_half[1]));
        steep += b->roof != ROOF_FLAT && (pitch < 29 * rad_per_deg || pitch > 65 * rad_per_deg);
        for (int k = 0; k < 4; k++) {
            const double *corner = c.corner_m[b->first_corner + k], dx = corner[0] - x, dy = corner[1] - y;
            wrong += fabs(fabs(dx * p->direction[0] + dy * p->direction[1]) - p->house_half[0]) > 0.1 ||
                     fabs(fabs(dy * p->direction[0] - dx * p->direction[1]) - p->house_half[1]) > 0.1;
            inside += landscape_surface(&land, x + 0.99 * dx, y + 0.99 * dy) == SURFACE_BUILT;
            outside += landscape_surface(&land, x + 1.02 * dx, y + 1.02 * dy) == SURFACE_BUILT;
        }
    }
    print_message("%d plots, %d without house, %d heated; corners inside %d, outside %d\n", plots, missing, heated,
                  inside, outside);
    CHECK(plots > 100 && missing * 20 < plots && wrong == 0 && steep == 0);
    CHECK(inside > 4 * houses * 98 / 100 && outside < 4 * houses / 50);
    CHECK(heated > houses * 8 / 10 && heated < houses);
    culture_free(&c);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plots_have_their_houses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
