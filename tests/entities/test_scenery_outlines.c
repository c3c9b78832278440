/* Outlines of any kind as buildings: 10,000 random ones are closed, sound, inside and out; many corners; triangles and
 * straight skeletons. labels: physics */
#include "tests/entities/buildings_fixture.h"

#include "entities/scenery/scenery_buildings_private.h"
#include "terrain/culture/courtyards.h"

#include <time.h>

/* A simple outline by seed, about the middle of a cell of its own: a star of random radii, or a comb of wings, turned;
 * of those two in three have sides of whole metres, so that many events of their skeletons come at once. */
static int random_outline(double (*p)[2], uint64_t seed)
{
    const double x0 = (double)(seed % 100) * 128 + 64, y0 = (double)(seed / 100) * 128 + 64;
    const int    kind = (int)(4 * random_uniform(seed, 1, 0, 0));
    const double turn = kind == 3 ? 0 : 6.3 * random_uniform(seed, 1, 0, 1), c = cos(turn), s = sin(turn);
    int          n = 0;
    if (kind == 0) {
        n = 3 + (int)(random_uniform(seed, 1, 0, 2) * 20);
        for (int k = 0; k < n; k++) {
            const double a = 2 * pi_rad * (k + 0.8 * random_uniform(seed, 2, 0, (uint64_t)k)) / n;
            const double r = 3 + 15 * random_uniform(seed, 3, 0, (uint64_t)k);
            p[k][0] = r * cos(a), p[k][1] = r * sin(a);
        }
    } else {
        const int wings = 1 + (int)(random_uniform(seed, 1, 0, 2) * 6);
        double    x = 0;
        p[n][0] = 0, p[n++][1] = 0;
        for (int k = 0; k < wings; k++) {
            const double u = 2 + 8 * random_uniform(seed, 2, 0, (uint64_t)k);
            const double v = 4 + 12 * random_uniform(seed, 3, 0, (uint64_t)k);
            p[n][0] = x, p[n++][1] = kind > 1 ? -floor(v) : -v;
            x += kind > 1 ? 1 + floor(u) : u;
            p[n][0] = x, p[n][1] = p[n - 1][1], n++;
        }
        p[n][0] = x, p[n++][1] = 0;
    }
    for (int k = 0; k < n; k++) {
        const double x = p[k][0], y = p[k][1];
        p[k][0] = x0 + c * x - s * y, p[k][1] = y0 + s * x + c * y;
    }
    return n;
}

static void add_random(Culture *c, uint64_t seed)
{
    double   p[64][2];
    Building b = house;
    b.id = seed;
    b.roof = (uint8_t)(seed % ROOF_SHAPES), b.use = (uint8_t)(seed / 5 % BUILDING_USES);
    b.ridge_rad = (float)(6.3 * random_uniform(seed, 1, 0, 1));
    b.base_m = 0;
    b.eaves_m = (float)(2.2 + 8 * random_uniform(seed, 4, 0, 0));
    b.ridge_m = b.eaves_m + (float)(0.2 + 5 * random_uniform(seed, 4, 0, 1));
    b.levels = (uint8_t)(1 + seed % 4), b.chimneys = (uint8_t)(seed % 5);
    b.damage = (uint8_t)(seed % 7 < 4 ? 0 : seed % 7 - 3);
    add(c, &b, (const double(*)[2])p, random_outline(p, seed));
}

/* Distance from a place to an outline's nearest side. */
static double side_m(const double (*p)[2], int n, const double at[3])
{
    double nearest = INFINITY;
    for (int k = 0; k < n; k++) {
        const double *a = p[k], *b = p[(k + 1) % n], d[2] = {b[0] - a[0], b[1] - a[1]};
        const double  t = clamp(((at[0] - a[0]) * d[0] + (at[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]), 0, 1);
        nearest = fmin(nearest, hypot(at[0] - a[0] - t * d[0], at[1] - a[1] - t * d[1]));
    }
    return nearest;
}

static bool is_inside(const double (*p)[2], int n, const double at[3])
{
    bool in = false;
    for (int k = 0, last = n - 1; k < n; last = k++)
        if ((p[last][1] > at[1]) != (p[k][1] > at[1]) &&
            at[0] < p[last][0] + (at[1] - p[last][1]) * (p[k][0] - p[last][0]) / (p[k][1] - p[last][1]))
            in = !in;
    return in;
}

/* Facets have an area; walls along the outline face outwards; no roof is farther outside than the mitre of its
 * overhang, and sloped ones cover the outline once and all of it; the highest edge is the ridge. */
static void check_building(const Scenery *s, int model, const Culture *c, const Building *b)
{
    const double(*p)[2] = (const double(*)[2])c->corner_m + b->first_corner;
    double covered = 0, outline = culture_area_m2(p, b->corners), high_m = 0;
    for (int t = 0; t < s->model[model].triangle_count; t++) {
        const Facet  f = facet(s, model, t);
        const double area = 0.5 * v3_length(f.n);
        CHECK(area > 1e-8);
        CHECK(f.facing > 0.99 || area < 1e-4); /* flat; nodes of slivers are moved by up to 1 mm */
        double middle[3], out[3];
        for (int k = 0; k < 3; k++) middle[k] = (f.p[0][k] + f.p[1][k] + f.p[2][k]) / 3;
        if (is_part(&f, "roof") && strcmp(f.part->material, "masonry_sooted")) {
            covered += f.n[2] > 1e-9 ? 0.5 * f.n[2] : 0;
            for (int k = 0; k < 3; k++) {
                CHECK(is_inside(p, b->corners, f.p[k]) ||
                      side_m(p, b->corners, f.p[k]) < 1.5 * scenery_overhang_m + 1e-3);
                high_m = fmax(high_m, f.p[k][2]);
            }
        }
        for (int k = 0; k < 3 && is_part(&f, "chimney"); k++) CHECK(is_inside(p, b->corners, f.p[k]));
        if (!is_part(&f, "wall") || fabs(f.n[2]) > 1e-6 * area || side_m(p, b->corners, middle) > 1e-6) continue;
        v3_add_scaled(out, middle, 1e-4 / v3_length(f.n), f.n);
        CHECK(!is_inside(p, b->corners, out));
        v3_add_scaled(out, middle, -1e-4 / v3_length(f.n), f.n);
        CHECK(is_inside(p, b->corners, out));
    }
    if (b->damage == 3 || b->roof == ROOF_FLAT || b->use == BUILDING_HALL) return; /* parapets, vents */
    CHECK_NEAR(high_m, (double)b->ridge_m, 1e-4);
    if (b->damage < 2) CHECK(covered > outline - 1e-6);
    if (b->damage < 2) CHECK(covered < outline + 1.5 * scenery_overhang_m * (2 * outline + 200));
}

static void any_outline_is_closed_and_sound(void **state)
{
    (void)state;
    Culture c = {0};
    Scenery s = {0};
    for (uint64_t seed = 0; seed < 10000; seed++) add_random(&c, seed);
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    check_closed(&s);
    int seen = 0;
    for (int k = 0; k < s.models; k++) {
        const uint64_t id = s.part_of[s.part_first[k]];
        seen++;
        assert_int_equal(c.building[id].id, id); /* one building a cell, numbered as it was added */
        check_building(&s, k, &c, &c.building[id]);
    }
    assert_int_equal(seen, 10000);
    scenery_free(&s), culture_free(&c);
}

/* A block about a courtyard, or about two, of wings of even widths, turned. */
static int random_block(double (*p)[2], uint64_t seed)
{
    const double x0 = (double)(seed % 100) * 128 + 64, y0 = (double)(seed / 100) * 128 + 64;
    const double wing = 3 + 9 * random_uniform(seed, 5, 0, 0), turn = 6.3 * random_uniform(seed, 5, 0, 1);
    const int    yards = 1 + (int)(2 * random_uniform(seed, 5, 0, 2)), first[3] = {0, 4, 8};
    const double wide = 4 + 14 * random_uniform(seed, 5, 0, 3), deep = 4 + 14 * random_uniform(seed, 5, 0, 4);
    double       ring[8][2];
    int          joined;
    for (int k = 0; k < 4; k++) {
        p[k][0] = k == 1 || k == 2 ? wing + yards * (wide + wing) : 0;
        p[k][1] = k >= 2 ? deep + 2 * wing : 0;
        for (int yard = 0; yard < yards; yard++) {
            ring[4 * yard + k][0] = wing + yard * (wide + wing) + (k == 1 || k == 2 ? wide : 0);
            ring[4 * yard + k][1] = k >= 2 ? wing + deep : wing;
        }
    }
    for (int k = 0; k < 4 * (1 + yards); k++) {
        double      *q = k < 4 ? p[k] : ring[k - 4];
        const double x = q[0], y = q[1];
        q[0] = x0 + cos(turn) * x - sin(turn) * y, q[1] = y0 + sin(turn) * x + cos(turn) * y;
    }
    const int n = courtyards_join(p, 4, (const double(*)[2])ring, first, yards, &joined);
    assert_int_equal(joined, yards);
    return n;
}

/* Closed, sound, roofed as the others; above a courtyard there is no roof, and its wings have slopes. */
static void courtyards_are_open_to_the_sky(void **state)
{
    static double p[culture_outline_most][2];
    Culture       c = {0};
    Scenery       s = {0};
    int           sloped = 0, wanted = 0;
    (void)state;
    for (uint64_t seed = 0; seed < 2000; seed++) {
        Building b = house;
        b.id = seed, b.base_m = 0, b.roof = (uint8_t)(seed % ROOF_SHAPES), b.use = (uint8_t)(seed / 5 % BUILDING_USES);
        b.ridge_m = b.eaves_m + (float)(0.5 + 3 * random_uniform(seed, 4, 0, 1));
        b.damage = (uint8_t)(seed % 11 < 8 ? 0 : seed % 11 - 7);
        add(&c, &b, (const double(*)[2])p, random_block(p, seed));
    }
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    check_closed(&s);
    assert_int_equal(s.models, 2000);
    for (int k = 0; k < s.models; k++) {
        const Building *b = &c.building[s.part_of[s.part_first[k]]];
        check_building(&s, k, &c, b);
        if (b->damage || (b->roof != ROOF_GABLED && b->roof != ROOF_HIPPED)) continue;
        bool slopes = false;
        for (int t = 0; t < s.model[k].triangle_count; t++) {
            const Facet f = facet(&s, k, t);
            slopes |= is_part(&f, "roof") && f.n[2] > 0 && f.n[2] < 0.999 * v3_length(f.n);
        }
        sloped += slopes, wanted++;
    }
    print_message("%d of %d blocks with pitched roofs have slopes\n", sloped, wanted);
    CHECK(sloped > 0.95 * wanted);
    scenery_free(&s), culture_free(&c);
}

/* A village: what it costs is printed. */
static void ten_thousand_houses_are_a_few_hundred_meshes(void **state)
{
    (void)state;
    Culture c = {0};
    Scenery s = {0};
    for (int k = 0; k < 10000; k++) {
        Building     b = house;
        const double x = 22.0 * (k % 100), y = 25.0 * (k / 100), far = 11 + 3 * random_uniform(1, 1, 0, (uint64_t)k);
        const double rect[4][2] = {{x, y}, {x + far, y}, {x + far, y + 8}, {x, y + 8}};
        b.id = (uint64_t)k, b.chimneys = 1, b.roof = (uint8_t)(1 + k % 2), b.levels = (uint8_t)(1 + k % 2);
        b.eaves_m = 2.8F * (float)b.levels, b.ridge_m = b.eaves_m + 3;
        add(&c, &b, rect, 4);
    }
    struct timespec from, to;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    double octets = 0, triangles = 0;
    for (int k = 0; k < s.models; k++) {
        const Model *m = &s.model[k];
        octets += m->vertex_count * (double)(sizeof *m->vertex + sizeof *m->normal) +
                  m->triangle_count * (double)(sizeof *m->triangle + sizeof *m->triangle_part) +
                  m->part_count * (double)(sizeof *m->part + sizeof *s.part_of);
        triangles += m->triangle_count;
    }
    print_message("10,000 houses: %d meshes, %.0f triangles a house, %.0f MB, %.2f s of processor\n", s.models,
                  triangles / 10000, octets / 1e6,
                  (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec));
    CHECK(s.models == 17 * 20 || s.models == 18 * 20);
    CHECK(triangles / 10000 < 390); /* of these 36 of gutters */
    scenery_free(&s), culture_free(&c);
}

/* ---- many corners --------------------------------------------------------------------------------- */

static void an_outline_of_4096_corners_is_made(void **state)
{
    (void)state;
    enum { n = culture_outline_most };
    static double p[n][2];
    for (int shape = 0; shape < 2; shape++) {
        for (int k = 0; k < n; k++) { /* a gear; a long comb */
            const double a = 2 * pi_rad * k / n, r = k % 4 < 2 ? 60 : 55;
            p[k][0] = shape ? (k < n - 2 ? 0.5 * (k / 2) : k == n - 2 ? 0.5 * (n / 2) : -1) : r * cos(a);
            p[k][1] = shape ? (k >= n - 2 ? 20 : (k + 1) / 2 % 2 ? 8 : 0) : r * sin(a);
        }
        for (int k = 0; k < 3; k++) { /* beyond 256 corners other slopes are as flat roofs */
            Building b = house;
            b.roof = k == 2 ? ROOF_SKILLION : ROOF_HIPPED, b.use = BUILDING_HALL, b.damage = (uint8_t)(k == 1 ? 3 : 0);
            Scenery s = scenery_of(&b, (const double(*)[2])p, n);
            check_closed(&s);
            scenery_free(&s);
        }
    }
}

/* Finite numbers that are no building's: left out, or made without trouble. */
static void absurd_records_do_no_harm(void **state)
{
    (void)state;
    static const double far[4][2] = {{1e300, 0}, {1e300, 1e200}, {-1e200, 1e200}, {0, -1e300}};
    static const double wide[4][2] = {{0, 0}, {1e5, 0}, {1e5, 3}, {0, 3}};
    static const double thin[4][2] = {{0, 0}, {4000, 0}, {4000, 0.002}, {0, 0.002}};
    static const double line[3][2] = {{0, 0}, {1e5, 5}, {1e300, 0}};
    Culture             c = {0};
    Scenery             s = {0};
    Building            b = house;
    for (int k = 0; k < 4; k++) {
        b.id = (uint64_t)k, b.roof = (uint8_t)(k % ROOF_SHAPES), b.levels = 255;
        CHECK(culture_add_building(&c, &b, far, 4) == STATUS_OK);
        CHECK(culture_add_building(&c, &b, wide, 4) == STATUS_OK);
        CHECK(culture_add_building(&c, &b, thin, 4) == STATUS_OK);
    }
    b.ridge_m = 3e38F, b.base_m = 1e38F;
    CHECK(culture_add_building(&c, &b, thin, 4) == STATUS_OK);
    b = house, b.eaves_m = 1e-20F, b.ridge_m = 999, b.use = 77, b.roof = 77, b.wall_fabric = 200, b.damage = 200;
    CHECK(culture_add_building(&c, &b, thin, 4) == STATUS_OK);
    for (int kind = 0; kind < CULTURE_LINE_KINDS; kind++) {
        const CultureLine l = {.id = 3, .kind = (uint8_t)kind, .width_m = kind % 2 ? 3e38F : 0};
        CHECK(culture_add_line(&c, &l, line, 3 - kind % 2) == STATUS_OK);
    }
    for (int kind = 0; kind < CULTURE_POINT_KINDS; kind++)
        for (int k = 0; k < 2; k++) {
            const float        size = k ? 1e-30F : 3e37F;
            const CulturePoint p = {.id = 4, .kind = (uint8_t)kind, .x_m = k, .size_m = {size, size, size}};
            CHECK(culture_add_point(&c, &p) == STATUS_OK);
        }
    log_set_level(LOG_ERROR);
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    log_set_level(LOG_INFO);
    for (int k = 0; k < s.models; k++) CHECK(model_check(&s.model[k]) == STATUS_OK);
    scenery_free(&s), culture_free(&c);
}

/* ---- triangles and skeletons ---------------------------------------------------------------------- */

/* n - 2 positive triangles whose areas add up to the outline's: each place is covered once. */
static void triangles_cover_an_outline(void **state)
{
    (void)state;
    Status status = STATUS_OK;
    for (uint64_t seed = 0; seed < 2000; seed++) {
        double    p[64][2], sum = 0;
        int       t[64][3];
        Culture   c = {0};
        const int n = random_outline(p, seed);
        add(&c, &house, (const double(*)[2])p, n); /* turned, without repeated corners */
        const double(*q)[2] = (const double(*)[2])c.corner_m;
        CHECK(outline_triangulate(t, &status, q, c.building[0].corners) && status == STATUS_OK);
        for (int k = 0; k < c.building[0].corners - 2; k++) {
            const double corner[3][2] = {
                {q[t[k][0]][0], q[t[k][0]][1]}, {q[t[k][1]][0], q[t[k][1]][1]}, {q[t[k][2]][0], q[t[k][2]][1]}};
            CHECK(culture_area_m2(corner, 3) > 0);
            sum += culture_area_m2(corner, 3);
        }
        CHECK_NEAR(sum, culture_area_m2(q, c.building[0].corners), 1e-9 * sum);
        culture_free(&c);
    }
    /* one that crosses itself: still n - 2 triangles, but said */
    static const double bow[4][2] = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
    int                 t[2][3];
    CHECK(!outline_triangulate(t, &status, bow, 4) && status == STATUS_OK);
}

/* Every node is as far from the eaves of its face as its time says. */
static void nodes_are_as_far_from_the_eaves_as_their_time(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 2000; seed++) {
        double   p[64][2];
        Culture  c = {0};
        RoofPlan plan;
        Status   status = STATUS_OK;
        add(&c, &house, (const double(*)[2])p, random_outline(p, seed));
        const double(*q)[2] = (const double(*)[2])c.corner_m;
        const int n = c.building[0].corners;
        CHECK(roof_plan_make(&plan, &status, q, n, NULL));
        double sum = 0;
        for (int f = 0; f < plan.faces; f++) {
            double    face[256][2];
            const int count = plan.first[f + 1] - plan.first[f];
            for (int k = 0; k < count; k++) {
                const double *v = plan.node[plan.index[plan.first[f] + k]];
                face[k][0] = v[0], face[k][1] = v[1];
                if (plan.edge[f] < 0) continue;
                const double *a = q[plan.edge[f]], *b = q[(plan.edge[f] + 1) % n];
                const double  m =
                    ((b[0] - a[0]) * (v[1] - a[1]) - (b[1] - a[1]) * (v[0] - a[0])) / hypot(b[0] - a[0], b[1] - a[1]);
                CHECK_NEAR(v[2], m, 3e-3); /* nodes nearer than 1 mm are one, at corners of any sharpness */
            }
            sum += culture_area_m2((const double(*)[2])face, count);
            CHECK(culture_area_m2((const double(*)[2])face, count) > 0);
        }
        CHECK_NEAR(sum, culture_area_m2(q, n), 1e-6 * sum);
        roof_plan_free(&plan), culture_free(&c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_outline_is_closed_and_sound),
        cmocka_unit_test(courtyards_are_open_to_the_sky),
        cmocka_unit_test(ten_thousand_houses_are_a_few_hundred_meshes),
        cmocka_unit_test(an_outline_of_4096_corners_is_made),
        cmocka_unit_test(absurd_records_do_no_harm),
        cmocka_unit_test(triangles_cover_an_outline),
        cmocka_unit_test(nodes_are_as_far_from_the_eaves_as_their_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
