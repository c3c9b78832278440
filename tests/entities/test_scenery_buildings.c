/* Buildings of a culture as meshes: heights, areas and volumes of roofs and gables against closed forms, walls, windows
 * and doors, materials and names. Outlines of any kind: test_scenery_outlines. labels: physics */
#include "tests/entities/buildings_fixture.h"

#include <stdio.h>

static const double rectangle[4][2] = {{10, 10}, {22, 10}, {22, 18}, {10, 18}}; /* ridge east */
static const double ell[6][2] = {{0, 0}, {14, 0}, {14, 7}, {7, 7}, {7, 15}, {0, 15}};
static const double u_shape[8][2] = {{0, 0}, {20, 0}, {20, 15}, {14, 15}, {14, 6}, {6, 6}, {6, 15}, {0, 15}};
static const double tee[8][2] = {{0, 0}, {18, 0}, {18, 6}, {12, 6}, {12, 14}, {6, 14}, {6, 6}, {0, 6}};
static const double triangle[3][2] = {{0, 0}, {12, 1}, {4, 9}};
static const double square[4][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}};
static const double cross[12][2] = {{5, 0},   {10, 0}, {10, 5}, {15, 5}, {15, 10}, {10, 10},
                                    {10, 15}, {5, 15}, {5, 10}, {0, 10}, {0, 5},   {5, 5}};
static const struct {
    const double (*p)[2];
    int n;
} outline[] = {{rectangle, 4}, {ell, 6}, {u_shape, 8}, {tee, 8}, {triangle, 3}, {square, 4}, {cross, 12}};
enum { outlines = sizeof outline / sizeof *outline };

static Building with_roof(int roof)
{
    Building b = house;
    b.roof = (uint8_t)roof;
    return b;
}

static void every_roof_closes_every_outline(void **state)
{
    (void)state;
    for (int o = 0; o < outlines; o++)
        for (int roof = 0; roof < ROOF_SHAPES; roof++)
            for (int use = 0; use < BUILDING_USES; use++)
                for (int damage = 0; damage < 4; damage++) {
                    Building b = with_roof(roof);
                    b.use = (uint8_t)use, b.damage = (uint8_t)damage, b.chimneys = 2;
                    b.id = (uint64_t)(1000 * o + 100 * roof + 10 * use + damage);
                    Scenery s = scenery_of(&b, outline[o].p, outline[o].n);
                    check_closed(&s);
                    /* a third of the walls, at most a half, is left of a ruin */
                    const double top_m = fmax(highest(&s, "roof"), highest(&s, "wall"));
                    if (damage == 3) CHECK(top_m < 100 + 0.5 * 5.5 + 1e-6 && top_m > 100 + 0.2 * 5.5);
                    else if (use != BUILDING_HALL && !(damage == 2 && roof == ROOF_FLAT)) CHECK_NEAR(top_m, 109, 1e-5);
                    scenery_free(&s);
                }
}

/* The upper side of a roof is at the eaves' height along the walls from which it rises, and at the ridge's on top. */
static void eaves_and_ridge_are_exact(void **state)
{
    (void)state;
    for (int roof = 0; roof < ROOF_SHAPES; roof++) {
        const Building b = with_roof(roof);
        Scenery        s = scenery_of(&b, rectangle, 4);
        const double   middle_m = height_over(&s, "roof", 16, 14);
        if (roof == ROOF_GABLED || roof == ROOF_HIPPED || roof == ROOF_PYRAMIDAL) {
            CHECK_NEAR(height_over(&s, "roof", 16, 10), 105.5, 1e-5);
            CHECK_NEAR(height_over(&s, "roof", 13.3, 18), 105.5, 1e-5);
            CHECK_NEAR(middle_m, 109, 1e-5);
        }
        if (roof == ROOF_GABLED)
            CHECK_NEAR(height_over(&s, "roof", 10, 14), 109, 1e-5); /* the ridge ends at the gable */
        if (roof == ROOF_HIPPED) CHECK_NEAR(height_over(&s, "roof", 10, 14), 105.5, 1e-5);
        if (roof == ROOF_HIPPED) CHECK_NEAR(height_over(&s, "roof", 14, 14), 109, 1e-5); /* half the width inside */
        if (roof == ROOF_SKILLION) { /* falls towards east, its upper edge an overhang outside the wall */
            CHECK_NEAR(height_over(&s, "roof", 22, 14), 105.5, 1e-5);
            CHECK_NEAR(height_over(&s, "roof", 16, 12), 105.5 + 3.5 * 6 / 12.4, 1e-5);
        }
        if (roof == ROOF_FLAT) CHECK_NEAR(middle_m, 105.5, 1e-5);
        if (roof == ROOF_FLAT) CHECK_NEAR(highest(&s, "wall"), 109, 1e-5); /* its parapet, 0.25 m thick */
        if (roof == ROOF_FLAT) CHECK_NEAR(covered_m2(NULL, &s, "roof", 0), (12 - 0.5) * (8 - 0.5), 1e-6);
        scenery_free(&s);
    }
}

/* What a roof with its overhang covers: of a rectangle a by b by elementary geometry; the volume over its lowest edge:
 * hipped h a (3 b - a) / 6, gabled h a b / 2, pyramidal h a b / 3, skillion h a b / 2. */
static void areas_and_volumes_are_those_of_the_solids(void **state)
{
    (void)state;
    const double o = scenery_overhang_m, a = 8 + 2 * o, b = 12 + 2 * o, slope = 3.5 / 4;
    for (int roof = ROOF_GABLED; roof < ROOF_SHAPES; roof++) {
        const Building of = with_roof(roof);
        Scenery        s = scenery_of(&of, rectangle, 4);
        double         volume_m3;
        const double   low_m = 105.5 - slope * o;
        if (roof == ROOF_GABLED || roof == ROOF_HIPPED) {
            CHECK_NEAR(covered_m2(&volume_m3, &s, "roof", low_m), a * b, 1e-6);
            const double h = slope * 0.5 * a;
            CHECK_NEAR(volume_m3, roof == ROOF_HIPPED ? h * a * (3 * b - a) / 6 : h * a * b / 2, 1e-4);
        }
        if (roof == ROOF_SKILLION) {
            const double rise_m = 3.5 * b / (b - o);
            CHECK_NEAR(covered_m2(&volume_m3, &s, "roof", 109 - rise_m), a * b, 1e-6);
            CHECK_NEAR(volume_m3, rise_m * a * b / 2, 1e-4);
        }
        if (roof == ROOF_PYRAMIDAL) { /* larger by one factor about its apex */
            const double m2 = covered_m2(&volume_m3, &s, "roof", 109), grow = sqrt(m2 / 96);
            CHECK(grow > 1.02 && 12 * (grow - 1) / 2 < 1.4 * o);
            CHECK_NEAR(volume_m3, -m2 * 3.5 * grow * 2 / 3, 1e-4);
        }
        scenery_free(&s);
    }
    /* of an L: Steiner's formula: area + o around + o^2 sum of tan(half the turn): five corners left, one right */
    const Building hipped = with_roof(ROOF_HIPPED);
    Scenery        s = scenery_of(&hipped, ell, 6);
    CHECK_NEAR(covered_m2(NULL, &s, "roof", 0), 14 * 7 + 7 * 8 + o * 58 + o * o * 4, 1e-6);
    scenery_free(&s);
}

/* A slab is as thick across its slope as tiles, battens and rafters are, or thatch: what it encloses is its plan by its
 * upright thickness. */
static void slabs_have_their_thickness(void **state)
{
    (void)state;
    const double o = scenery_overhang_m, plan_m2 = (8 + 2 * o) * (12 + 2 * o);
    for (int roof = ROOF_GABLED; roof <= ROOF_SKILLION; roof++)
        for (int thatch = 0; thatch < 2; thatch++) {
            Building b = with_roof(roof);
            b.roof_fabric = thatch ? FABRIC_THATCH : FABRIC_TILE;
            Scenery s = scenery_of(&b, rectangle, 4);
            double  volume_m3 = 0;
            for (int t = 0; t < s.model[0].triangle_count; t++) {
                const Facet f = facet(&s, 0, t);
                double      away[3];
                if (!is_part(&f, "roof")) continue;
                v3_sub(away, f.p[0], (const double[3]){16, 14, 105});
                volume_m3 += v3_dot(away, f.n) / 6;
            }
            const double slope = roof == ROOF_SKILLION ? 3.5 / 12.4 : 3.5 / 4, m2 = covered_m2(NULL, &s, "roof", 0);
            if (roof != ROOF_PYRAMIDAL) CHECK_NEAR(m2, plan_m2, 1e-6);
            CHECK_NEAR(volume_m3, m2 * (thatch ? 0.35 : 0.2) * sqrt(1 + slope * slope), 1e-4);
            scenery_free(&s);
        }
}

/* Under a gable of a width and slope: the triangle over the walls' upright part. */
static void gables_are_closed_by_triangles(void **state)
{
    (void)state;
    Building b = with_roof(ROOF_GABLED);
    b.use = BUILDING_BARN; /* its gable ends have no openings */
    Scenery s = scenery_of(&b, rectangle, 4);
    double  end_m2 = 0, low_m = INFINITY, corner_m = -INFINITY;
    for (int t = 0; t < s.model[0].triangle_count; t++) {
        const Facet f = facet(&s, 0, t);
        if (!is_part(&f, "wall")) continue;
        for (int k = 0; k < 3; k++) {
            low_m = fmin(low_m, f.p[k][2]);
            if (f.p[k][1] < 10 + 1e-6) corner_m = fmax(corner_m, f.p[k][2]); /* the south wall is level */
        }
        if (f.n[0] > 0.999 * v3_length(f.n)) end_m2 += 0.5 * v3_length(f.n);
    }
    CHECK_NEAR(low_m, 99.5, 1e-5); /* half a metre into the ground */
    CHECK(corner_m < 105.5 && corner_m > 105.5 - 0.3);
    CHECK_NEAR(end_m2, 8 * (corner_m - low_m) + 0.25 * 8 * 8 * 3.5 / 4, 1e-5);
    scenery_free(&s);
}

static double highest_wall_along(const Scenery *s, int axis, double at_m)
{
    double high_m = -INFINITY;
    for (int t = 0; t < s->model[0].triangle_count; t++) {
        const Facet f = facet(s, 0, t);
        if (!is_part(&f, "wall") || fabs(f.n[axis]) < 0.999 * v3_length(f.n) || fabs(f.p[0][axis] - at_m) > 1e-6)
            continue;
        for (int k = 0; k < 3; k++) high_m = fmax(high_m, f.p[k][2]);
    }
    return high_m;
}

/* Gables stand at the ends of wings, of short ones too, and nowhere else. */
static void ridges_end_in_gables(void **state)
{
    (void)state;
    static const double bump[8][2] = {{0, 0}, {6, 0}, {6, -2}, {10, -2}, {10, 0}, {16, 0}, {16, 9}, {0, 9}};
    const Building      b = with_roof(ROOF_GABLED);
    Scenery             s = scenery_of(&b, u_shape, 8);
    CHECK(highest_wall_along(&s, 1, 0) < 105.5 && highest_wall_along(&s, 1, 15) > 108);
    CHECK(highest_wall_along(&s, 0, 0) < 105.5 && highest_wall_along(&s, 0, 20) < 105.5);
    scenery_free(&s);
    s = scenery_of(&b, bump, 8);
    CHECK(highest_wall_along(&s, 1, 0) < 105.5 && highest_wall_along(&s, 1, 9) < 105.5);
    CHECK(highest_wall_along(&s, 0, 0) > 108 && highest_wall_along(&s, 0, 16) > 108);
    CHECK(highest_wall_along(&s, 1, -2) > 106.5);
    scenery_free(&s);
    s = scenery_of(&b, ell, 6);
    CHECK(highest_wall_along(&s, 1, 15) > 108 && highest_wall_along(&s, 0, 14) > 108);
    CHECK(highest_wall_along(&s, 1, 0) < 105.5 && highest_wall_along(&s, 0, 0) < 105.5);
    scenery_free(&s);
}

/* Over a convex outline the roof is the lowest of the planes over its edges: as far up as the nearest edge is away. */
static void a_hipped_roof_is_the_lowest_of_its_planes(void **state)
{
    (void)state;
    const Building b = with_roof(ROOF_HIPPED);
    for (uint64_t seed = 0; seed < 20; seed++) {
        double    p[9][2];
        const int n = 3 + (int)(seed % 7);
        for (int k = 0; k < n; k++) { /* on a circle: convex */
            const double a = 2 * pi_rad * (k + 0.7 * random_uniform(seed, 1, 0, (uint64_t)k)) / n;
            p[k][0] = 12 * cos(a), p[k][1] = 12 * sin(a);
        }
        Scenery s = scenery_of(&b, (const double(*)[2])p, n);
        double  slope = 0;
        for (int k = 0; k < 60; k++) {
            const double r = 5 * sqrt(random_uniform(seed, 2, 0, (uint64_t)k)), a = 2.4 * k;
            const double x = r * cos(a), y = r * sin(a);
            double       nearest_m = INFINITY;
            for (int e = 0; e < n; e++) {
                const double *u = p[e], *v = p[(e + 1) % n];
                nearest_m = fmin(nearest_m, ((v[0] - u[0]) * (y - u[1]) - (v[1] - u[1]) * (x - u[0])) /
                                                hypot(v[0] - u[0], v[1] - u[1]));
            }
            if (nearest_m < 0.2) continue;
            const double here = (height_over(&s, "roof", x, y) - 105.5) / nearest_m;
            if (slope > 0) CHECK_NEAR(here, slope, 2e-3); /* nodes nearer than 1 mm are one */
            else slope = here;
        }
        CHECK(slope > 0.1);
        scenery_free(&s);
    }
}

static void every_slope_of_a_hipped_roof_is_as_steep(void **state)
{
    (void)state;
    const Building b = with_roof(ROOF_HIPPED);
    for (int o = 0; o < outlines; o++) {
        Scenery s = scenery_of(&b, outline[o].p, outline[o].n);
        double  steep = 0;
        for (int t = 0; t < s.model[0].triangle_count; t++) {
            const Facet f = facet(&s, 0, t);
            if (!is_part(&f, "roof") || f.n[2] < 1e-6) continue;
            const double here = hypot(f.n[0], f.n[1]) / f.n[2];
            if (steep > 0) CHECK_NEAR(here, steep, 1e-6);
            else steep = here;
        }
        scenery_free(&s);
    }
}

/* Chimneys rise 0.9 m over the ridge that they stand on, and are hot where a house is heated. */
static void chimneys_stand_on_the_ridge(void **state)
{
    (void)state;
    for (int roof = 0; roof < ROOF_SHAPES; roof++)
        for (int count = 1; count <= 4; count++) {
            Building b = with_roof(roof);
            b.chimneys = (uint8_t)count, b.heated = count != 3;
            Scenery s = scenery_of(&b, rectangle, 4);
            int     facets = 0;
            for (int t = 0; t < s.model[0].triangle_count; t++) {
                const Facet f = facet(&s, 0, t);
                if (!is_part(&f, "chimney")) continue;
                facets++;
                CHECK(f.part->role == (b.heated ? HEAT_FLUE : HEAT_PASSIVE));
                for (int k = 0; k < 3; k++) {
                    CHECK(f.p[k][0] > 10 && f.p[k][0] < 22 && f.p[k][1] > 10 && f.p[k][1] < 18);
                    if (roof != ROOF_GABLED && roof != ROOF_HIPPED) continue;
                    CHECK(fabs(f.p[k][1] - 14) < 0.3);
                    CHECK(fabs(f.p[k][2] - 109 - 0.9) < 1e-5 || f.p[k][2] < 109);
                }
            }
            assert_int_equal(facets, 12 * count);
            scenery_free(&s);
        }
}

/* ---- walls ---------------------------------------------------------------------------------------- */

static void windows_stand_in_rows_and_doors_on_the_floor(void **state)
{
    (void)state;
    Building b = with_roof(ROOF_HIPPED);
    b.levels = 3, b.eaves_m = 9, b.ridge_m = 12;
    Scenery s = scenery_of(&b, rectangle, 4);
    int     panes = 0, doors = 0;
    for (int t = 0; t < s.model[0].triangle_count; t++) {
        const Facet  f = facet(&s, 0, t);
        const bool   pane = is_part(&f, "window") && f.part->role == HEAT_WINDOW, door = is_part(&f, "door");
        const double storey_m = 9.0 / 3;
        if (!pane && !door) continue;
        /* each lies 0.1 m inside one wall, and 0.5 m at least from its corners */
        for (int k = 0; k < 3; k++) {
            const double *p = f.p[k], x = fmin(p[0] - 10, 22 - p[0]), y = fmin(p[1] - 10, 18 - p[1]);
            CHECK_NEAR(fmin(x, y), 0.1, 1e-6);
            CHECK(fmax(x, y) > 0.5);
            const double up_m = fmod(p[2] - 100, storey_m);
            if (pane) CHECK(up_m > 0.3 && up_m < storey_m - 0.3);
            if (door) CHECK(p[2] < 102.5);
        }
        if (door) CHECK(fmin(f.p[0][2], fmin(f.p[1][2], f.p[2][2])) < 100.1);
        CHECK(fabs(f.n[2]) < 1e-9);
        /* half of an upright rectangle */
        int level = 0, plumb = 0;
        for (int k = 0; k < 3; k++) {
            const double *a = f.p[k], *c = f.p[(k + 1) % 3];
            level += fabs(a[2] - c[2]) < 1e-9, plumb += hypot(a[0] - c[0], a[1] - c[1]) < 1e-9;
        }
        CHECK(level == 1 && plumb == 1);
        panes += pane, doors += door;
    }
    CHECK(panes >= 2 * 3 * 6 && doors == 2);
    scenery_free(&s);
    /* so high that no window fits in its storeys: fewer storeys */
    b.levels = 100;
    s = scenery_of(&b, rectangle, 4);
    check_closed(&s);
    scenery_free(&s);
}

/* A garage opens at an end, towards the drive. */
static void doors_open_on_drives(void **state)
{
    (void)state;
    static const double drive[2][2] = {{22, 14}, {60, 14}};
    Culture             c = {0};
    Scenery             s = {0};
    Building            b = house;
    const CultureLine   way = {.id = 5, .width_m = 4, .kind = CULTURE_TRACK, .surface = 1};
    b.use = BUILDING_SHED;
    add(&c, &b, rectangle, 4);
    CHECK(culture_add_line(&c, &way, drive, 2) == STATUS_OK && culture_index(&c) == STATUS_OK);
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    int doors = 0;
    for (int t = 0; t < s.model[0].triangle_count; t++) {
        const Facet f = facet(&s, 0, t);
        if (!is_part(&f, "door")) continue;
        doors++;
        for (int k = 0; k < 3; k++) CHECK_NEAR(f.p[k][0], 21.9, 1e-6);
    }
    assert_int_equal(doors, 2);
    scenery_free(&s), culture_free(&c);
}

/* Panes break, soot comes, then roofs have holes and nothing is warm; a ruin has neither. */
static void damage_goes_on_by_state(void **state)
{
    (void)state;
    int    panes[4] = {0}, warm[4] = {0}, soot[4] = {0};
    double roof_m2[4] = {0};
    for (uint64_t id = 0; id < 10; id++)
        for (int damage = 0; damage < 4; damage++) {
            Building b = with_roof(ROOF_HIPPED);
            b.id = id, b.damage = (uint8_t)damage;
            Scenery s = scenery_of(&b, rectangle, 4);
            roof_m2[damage] += covered_m2(NULL, &s, "roof", 0);
            for (int k = 0; k < s.model[0].part_count; k++) {
                const ModelPart *part = &s.model[0].part[k];
                const bool       is_soot = !strcmp(part->material, "masonry_sooted");
                panes[damage] += strcmp(part->material, "glass_window") ? 0 : part->triangle_count / 2;
                warm[damage] += part->role != HEAT_PASSIVE, soot[damage] += is_soot ? part->triangle_count : 0;
            }
            scenery_free(&s);
        }
    CHECK(soot[0] == 0 && soot[1] > 500 && soot[2] > soot[1]);
    CHECK(panes[1] < 0.75 * panes[0] && panes[1] > 0.45 * panes[0]); /* three in five */
    CHECK(panes[2] < 0.35 * panes[0] && panes[2] > 0 && panes[3] == 0);
    CHECK(warm[0] > 0 && warm[1] > 0 && warm[2] == 0 && warm[3] == 0);
    CHECK_NEAR(roof_m2[1], roof_m2[0], 1e-6);
    CHECK(roof_m2[2] < 0.95 * roof_m2[0] && roof_m2[2] > 0.6 * roof_m2[0] && roof_m2[3] == 0);
}

static double slope_of_ground(void *user, double x_m, double y_m)
{
    CHECK(x_m > 9 && x_m < 23 && y_m > 9 && y_m < 19); /* asked about the building's own ground */
    return 100 + *(const double *)user * (x_m - 10);
}

/* On a slope, walls go down to the ground everywhere; windows that it would cover are left out, and the door is where
 * the floor is near the ground. */
static void buildings_on_a_slope_have_no_windows_in_the_ground(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        double  slope = k == 0 ? 0.2 : k == 1 ? -0.2 : 0.5;
        Culture c = {0};
        Scenery s = {0};
        add(&c, &house, rectangle, 4);
        CHECK(scenery_add_buildings(&s, &c, slope_of_ground, &slope) == STATUS_OK);
        check_closed(&s);
        double low_m = INFINITY;
        for (int t = 0; t < s.model[0].triangle_count; t++) {
            const Facet f = facet(&s, 0, t);
            for (int i = 0; i < 3; i++) {
                const double ground_m = slope_of_ground(&slope, f.p[i][0], 14);
                low_m = fmin(low_m, f.p[i][2]);
                if (is_part(&f, "window") && f.part->role == HEAT_WINDOW) CHECK(f.p[i][2] > ground_m - 0.25);
                if (is_part(&f, "door")) CHECK(fabs(ground_m - 100) < (slope > 0.3 ? 7 : 1.3));
            }
        }
        CHECK_NEAR(low_m, fmin(100, slope_of_ground(&slope, 22, 14)) - 0.5, 1e-5);
        scenery_free(&s), culture_free(&c);
    }
}

/* ---- names ---------------------------------------------------------------------------------------- */

static bool is_material(const char *name)
{
    char path[1024], line[512];
    CHECK(etc_path(path, sizeof path, "materials.csv"));
    FILE *file = fopen(path, "r");
    bool  found = false;
    CHECK(file);
    while (!found && fgets(line, sizeof line, file))
        found = !strncmp(line, name, strlen(name)) && line[strlen(name)] == ',';
    fclose(file);
    return found;
}

static void parts_have_known_names_and_materials_that_exist(void **state)
{
    (void)state;
    static const char *const names[] = {"gutter", "wall", "roof", "window", "door", "chimney", "heap"};
    static const struct {
        int         fabric;
        const char *piece[3];
    } piece[] = {{FABRIC_BRICK, {"brick", "brick", "brick"}},
                 {FABRIC_RENDER, {"render", "render", "render"}},
                 {FABRIC_STONE, {"stone", "stone", "stone"}},
                 {FABRIC_TIMBER, {"timber", "wood", "timber"}},
                 {FABRIC_CONCRETE, {"concrete", "concrete", "concrete"}},
                 {FABRIC_SHEET, {"sheet", "metal", "steel"}},
                 {FABRIC_TILE, {"tile", "tile", "tile"}},
                 {FABRIC_SLATE, {"slate", "slate", "slate"}},
                 {FABRIC_FELT, {"felt", "felt", "felt"}},
                 {FABRIC_THATCH, {"thatch", "thatch", "thatch"}}};
    char        seen[64][32];
    int         known = 0;
    int         bricks = 0; /* materials of brick walls */
    const char *brick[3] = {"brick_red", "brick_brown", "brick_yellow"};
    for (uint64_t id = 0; id < 240; id++) {
        Building b = house;
        b.id = id, b.heated = id % 3 > 0, b.damage = (uint8_t)(id % 4), b.use = (uint8_t)(id % BUILDING_USES);
        b.wall_fabric = (uint8_t)(id / 4 % FABRICS), b.roof_fabric = (uint8_t)(id / 40 % FABRICS);
        Scenery s = scenery_of(&b, rectangle, 4);
        for (int k = 0; k < s.model[0].part_count; k++) {
            const ModelPart *part = &s.model[0].part[k];
            bool             ok = false;
            for (size_t n = 0; n < sizeof names / sizeof *names; n++) ok = ok || !strcmp(part->name, names[n]);
            CHECK(ok);
            CHECK(s.part_of[s.part_first[0] + k] == id);
            int at = 0;
            while (at < known && strcmp(seen[at], part->material)) at++;
            if (at == known) {
                CHECK(known < 64 && is_material(part->material));
                snprintf(seen[known++], sizeof seen[0], "%s", part->material);
            }
            const bool warm = b.heated && b.damage < 2;
            if (!strcmp(part->material, "glass_window")) CHECK(part->role == (warm ? HEAT_WINDOW : HEAT_PASSIVE));
            if (part->role == HEAT_DWELLING) CHECK(warm);
            if (k == 0) { /* the walls' own fabric comes first */
                const char *const *of = piece[b.wall_fabric].piece;
                CHECK(strstr(part->material, of[0]) || strstr(part->material, of[1]) || strstr(part->material, of[2]));
                for (int n = 0; n < 3; n++)
                    if (b.wall_fabric == FABRIC_BRICK && !strcmp(part->material, brick[n])) bricks |= 1 << n;
            }
        }
        scenery_free(&s);
    }
    CHECK(bricks == 7 && known > 30); /* not all of a fabric are alike */
}

/* ---- cells ---------------------------------------------------------------------------------------- */

static void a_cell_is_one_model_and_its_parts_name_their_buildings(void **state)
{
    (void)state;
    Culture c = {0};
    for (int k = 0; k < 8; k++) { /* in the cells from -128, 0 and 128: 20 m apart, from -30 to 110; two beyond */
        double   p[4][2];
        Building b = house;
        b.id = (uint64_t)(50 + k), b.base_m = (float)(100 + k);
        const double x = k < 6 ? -30 + 20 * k : 200;
        const double y = k == 7 ? -40 : 20;
        for (int i = 0; i < 4; i++) p[i][0] = x + rectangle[i][0] - 16, p[i][1] = y + rectangle[i][1] - 14;
        add(&c, &b, (const double(*)[2])p, 4);
    }
    Scenery s = {0};
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    assert_int_equal(s.models, 4);
    assert_int_equal(s.objects, 4);
    for (int k = 0; k < s.models; k++) {
        CHECK(s.object[k].kind == SCENERY_BUILDINGS && s.object[k].state == -1 && s.object[k].model == k);
        CHECK(s.part_first[k] == (k ? s.part_first[k - 1] + s.model[k - 1].part_count : 0));
        for (int i = 0; i < k; i++) CHECK(s.object[i].id != s.object[k].id);
        for (int t = 0; t < s.model[k].triangle_count; t++) {
            /* a facet lies over the building that its part names */
            const Facet    f = facet(&s, k, t);
            const uint64_t id = s.part_of[s.part_first[k] + s.model[k].triangle_part[t]];
            const double   x = id < 56 ? -30 + 20 * (double)(id - 50) : 200, y = id == 57 ? -40 : 20;
            CHECK(id >= 50 && id < 58);
            for (int i = 0; i < 3; i++) {
                CHECK(fabs(f.p[i][0] - x) < 6.5 && fabs(f.p[i][1] - y) < 4.5);
                CHECK(f.p[i][2] > 99.4 + (double)(id - 50) && f.p[i][2] < 109.1 + (double)(id - 50));
            }
        }
    }
    /* again into the same scenery: as many more, numbered on, with the same bits */
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    assert_int_equal(s.models, 8);
    for (int k = 0; k < 4; k++) {
        const Model *a = &s.model[k], *b = &s.model[k + 4];
        CHECK(s.object[k + 4].model == k + 4);
        CHECK(s.part_first[k + 4] == s.part_first[k] + s.part_first[3] + s.model[3].part_count);
        CHECK(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count);
        assert_memory_equal(a->vertex, b->vertex, (size_t)a->vertex_count * sizeof *a->vertex);
        assert_memory_equal(a->normal, b->normal, (size_t)a->vertex_count * sizeof *a->normal);
        assert_memory_equal(a->triangle, b->triangle, (size_t)a->triangle_count * sizeof *a->triangle);
    }
    scenery_free(&s), culture_free(&c);
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK && s.models == 0); /* of nothing nothing */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_roof_closes_every_outline),
        cmocka_unit_test(eaves_and_ridge_are_exact),
        cmocka_unit_test(areas_and_volumes_are_those_of_the_solids),
        cmocka_unit_test(slabs_have_their_thickness),
        cmocka_unit_test(gables_are_closed_by_triangles),
        cmocka_unit_test(ridges_end_in_gables),
        cmocka_unit_test(a_hipped_roof_is_the_lowest_of_its_planes),
        cmocka_unit_test(every_slope_of_a_hipped_roof_is_as_steep),
        cmocka_unit_test(chimneys_stand_on_the_ridge),
        cmocka_unit_test(windows_stand_in_rows_and_doors_on_the_floor),
        cmocka_unit_test(doors_open_on_drives),
        cmocka_unit_test(damage_goes_on_by_state),
        cmocka_unit_test(buildings_on_a_slope_have_no_windows_in_the_ground),
        cmocka_unit_test(parts_have_known_names_and_materials_that_exist),
        cmocka_unit_test(a_cell_is_one_model_and_its_parts_name_their_buildings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
