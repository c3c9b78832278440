/* Shapes of radar targets: areas, volumes, normals and sizes of their facets against geometry's formulas; which of
 * their faces are flat, and bodies convex; what names and sizes are refused. labels: physics */
#include "tests/render/hand_models.h"
#include "tests/render/radar_stage.h"

static double facet(double area_normal[3], const Model *m, int t)
{
    double ab[3], ac[3];
    v3_sub(ab, m->vertex[m->triangle[t][1]], m->vertex[m->triangle[t][0]]);
    v3_sub(ac, m->vertex[m->triangle[t][2]], m->vertex[m->triangle[t][0]]);
    v3_cross(area_normal, ab, ac);
    v3_scale(area_normal, 0.5, area_normal);
    return v3_length(area_normal);
}

/* Area; volume by Gauss's theorem, positive where facets look outwards; facets whose given normals are their planes'.
 */
static void measure(double *area_m2, double *volume_m3, int *plane, const Model *m)
{
    *area_m2 = *volume_m3 = *plane = 0;
    for (int t = 0; t < m->triangle_count; t++) {
        double       n[3];
        const double area = facet(n, m, t);
        bool         is = true;
        *area_m2 += area;
        *volume_m3 += v3_dot(n, m->vertex[m->triangle[t][0]]) / 3;
        for (int c = 0; c < 3; c++)
            for (int x = 0; x < 3; x++) is = is && fabs((double)m->normal[m->triangle[t][c]][x] - n[x] / area) < 1e-6;
        *plane += is;
    }
}

static void build(Model *m, const char *name, double sag_m)
{
    if (radar_shape_build(m, name, sag_m) != STATUS_OK) fail_msg("%s does not build", name);
    CHECK(m->sag_m == sag_m);
}

static void extent(double low[3], double high[3], const Model *m)
{
    for (int x = 0; x < 3; x++) low[x] = INFINITY, high[x] = -INFINITY;
    for (int v = 0; v < m->vertex_count; v++)
        for (int x = 0; x < 3; x++) {
            low[x] = fmin(low[x], m->vertex[v][x]);
            high[x] = fmax(high[x], m->vertex[v][x]);
        }
}

/* A chord of sag s lies s beneath the sphere; facets of the finest sphere that is asked for are no deeper, and of one
 * with a facet less along each side are. Its volume is short by no more than its area times the sag. */
static void a_sphere_is_round(void **state)
{
    (void)state;
    static const double radius = 0.7, sags[] = {0.05, 0.004, 3e-4};
    for (int i = 0; i < 3; i++) {
        Model  m;
        double area, volume, deepest = 0;
        int    plane;
        build(&m, "sphere:0.7", sags[i]);
        measure(&area, &volume, &plane, &m);
        const double whole = 4 * pi_rad / 3 * pow(radius, 3);
        CHECK(volume < whole && volume > whole - 4 * pi_rad * radius * radius * sags[i]);
        CHECK(area < 4 * pi_rad * radius * radius && area > 4 * pi_rad * radius * (radius - 2 * sags[i]));
        for (int v = 0; v < m.vertex_count; v++) {
            CHECK_NEAR(v3_length(m.vertex[v]), radius, 1e-12);
            for (int x = 0; x < 3; x++) CHECK_NEAR((double)m.normal[v][x], m.vertex[v][x] / radius, 1e-6);
        }
        for (int t = 0; t < m.triangle_count; t++) {
            double       n[3];
            const double size = facet(n, &m, t);
            deepest = fmax(deepest, radius - v3_dot(n, m.vertex[m.triangle[t][0]]) / size);
        }
        printf("sphere: %d facets, %.3g of %.3g m\n", m.triangle_count, deepest, sags[i]);
        const double n = sqrt(m.triangle_count / 8.0); /* facets along an octant's side; they are n^2 times less deep */
        CHECK(deepest <= 1.01 * sags[i] && deepest * pow(n / (n - 1), 2) > 0.97 * sags[i]);
        model_destroy(&m);
    }
}

/* An n-gon within a circle of radius r has the area n r^2 sin(2 pi / n) / 2, and sides n 2 r sin(pi / n); it is as far
 * in as r (1 - cos(pi / n)). n is the smallest, from 8, that is within the sag. */
static void discs_and_cylinders_are_polygons(void **state)
{
    (void)state;
    static const double r = 0.4, l = 1.5, sags[] = {0.1, 0.01, 0.001};
    for (int i = 0; i < 3; i++) {
        int sides = 8, plane;
        while (r * (1 - cos(pi_rad / sides)) > sags[i]) sides++;
        const double polygon = 0.5 * sides * r * r * sin(2 * pi_rad / sides);
        double       area, volume, low[3], high[3];
        Model        m;
        build(&m, "disc:0.4", sags[i]);
        measure(&area, &volume, &plane, &m);
        CHECK(m.triangle_count == sides && plane == sides);
        CHECK_NEAR(area, polygon, 1e-12);
        for (int v = 0; v < m.vertex_count; v++) CHECK(m.vertex[v][0] == 0 && m.normal[v][0] == 1);
        extent(low, high, &m);
        CHECK_NEAR(high[1], r, 1e-12);
        CHECK_NEAR(low[2], -high[2], 1e-12);
        model_destroy(&m);

        build(&m, "cylinder:0.4x1.5", sags[i]);
        measure(&area, &volume, &plane, &m);
        CHECK(m.triangle_count == 4 * sides && plane == 2 * sides && m.part_count == 2);
        CHECK(m.part[0].triangle_count == 2 * sides && m.part[1].first_triangle == 2 * sides);
        CHECK(m.part[1].triangle_count == 2 * sides && m.triangle_part[2 * sides - 1] == 0 &&
              m.triangle_part[2 * sides] == 1);
        CHECK_NEAR(area, 2 * polygon + sides * 2 * r * sin(pi_rad / sides) * l, 1e-12);
        CHECK_NEAR(volume, polygon * l, 1e-12);
        for (int v = 0; v < m.vertex_count; v++) CHECK_NEAR(fabs(m.vertex[v][2]), 0.5 * l, 1e-15);
        for (int t = 0; t < 2 * sides; t++)
            for (int c = 0; c < 3; c++) { /* the side's normals are the cylinder's own */
                const uint32_t v = m.triangle[t][c];
                CHECK_NEAR((double)m.normal[v][0], m.vertex[v][0] / r, 1e-6);
                CHECK_NEAR((double)m.normal[v][1], m.vertex[v][1] / r, 1e-6);
                CHECK(m.normal[v][2] == 0);
            }
        model_destroy(&m);
    }
}

/* Flat shapes: area, extent and the axes of their faces, which have two sides each, from the header's words. */
static void flat_ones_are_where_they_are_said(void **state)
{
    (void)state;
    const double h = sqrt(0.5);
    const struct {
        const char *name;
        double      area_m2, low[3], high[3];
        int         normals;
        double      normal[3][3];
    } of[] = {{"plate:0.6x0.2", 0.12, {0, -0.3, -0.1}, {0, 0.3, 0.1}, 1, {{1, 0, 0}}},
              {"dihedral:0.6x0.2", 0.24, {0, -0.6 * h, -0.1}, {0.6 * h, 0.6 * h, 0.1}, 2, {{h, h, 0}, {h, -h, 0}}},
              {"trihedral:0.5", 0.375, {0, 0, -0.5}, {0.5, 0.5, 0}, 3, {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}},
              {"corner:0.5", 0.75, {0, 0, -0.5}, {0.5, 0.5, 0}, 3, {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        Model  m;
        double area, volume, low[3], high[3], looks[3] = {0};
        int    plane;
        build(&m, of[i].name, 0.01);
        measure(&area, &volume, &plane, &m);
        extent(low, high, &m);
        CHECK_NEAR(area, of[i].area_m2, 1e-12);
        CHECK(plane == m.triangle_count);
        for (int x = 0; x < 3; x++) {
            CHECK_NEAR(low[x], of[i].low[x], 1e-12);
            CHECK_NEAR(high[x], of[i].high[x], 1e-12);
        }
        for (int t = 0; t < m.triangle_count; t++) {
            double n[3];
            CHECK(facet(n, &m, t) > 0 && v3_normalize(n, n));
            for (int k = 0; k < of[i].normals; k++)
                if (fabs(v3_dot(n, of[i].normal[k])) > 1 - 1e-12) looks[k]++;
        }
        for (int k = 0; k < of[i].normals; k++) CHECK(looks[k] * of[i].normals == m.triangle_count);
        model_destroy(&m);
    }
}

static void names_are_checked(void **state)
{
    (void)state;
    static const char *const good[] = {"plate:0.001x0.001", "plate:100x100", "corner:0.001", "trihedral:100"};
    static const char *const bad[] = {"plate:0.00099x1", "plate:1x0.00099", "plate:100.1x1", "plate:1x100.1",
                                      "plate:1",         "sphere:1x1",      "cube:1",        "plat:1x1",
                                      "plates:1x1",      "sphere:nan",      "sphere:",       "plate:1xa"};
    Model                    m;
    for (int i = 0; i < 4; i++) {
        build(&m, good[i], 0.01);
        model_destroy(&m);
    }
    for (int i = 0; i < 12; i++) CHECK(radar_shape_build(&m, bad[i], 0.01) == STATUS_BAD_VALUE);
    CHECK(radar_shape_build(&m, "sphere:100", 1e-6) == STATUS_BAD_VALUE); /* 8 x 83 M facets */
}

/* ---- flat faces ---------------------------------------------------------------------------------------------- */

/* Faces, their triangles in all, and whether the body is convex or one face, which needs no search for what hides it.
 */
static void faces_are_counted(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int         faces, triangles;
        bool        convex;
    } of[] = {{"plate:1x2", 1, 2, true},    {"disc:1", 1, 0, true},       {"dihedral:1x1", 2, 4, false},
              {"corner:1", 3, 6, false},    {"trihedral:1", 3, 3, false}, {"sphere:1", 0, 0, false},
              {"cylinder:1x1", 2, 0, false}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        Model     m;
        FlatFaces f;
        build(&m, of[i].name, 0.01);
        CHECK(radar_flat_faces_find(&f, &m) == STATUS_OK);
        const int triangles = i == 1 ? m.triangle_count : i == 6 ? m.part[1].triangle_count : of[i].triangles;
        if (f.count != of[i].faces || f.convex != of[i].convex || (f.count && f.first[f.count] != triangles))
            fail_msg("%s: %d faces of %d triangles, convex %d", of[i].name, f.count, f.count ? f.first[f.count] : 0,
                     f.convex);
        radar_flat_faces_free(&f);
        model_destroy(&m);
    }
}

static void put_triangle(Model *m, const double p[3][3])
{
    double n[3], ab[3], ac[3];
    v3_sub(ab, p[1], p[0]);
    v3_sub(ac, p[2], p[0]);
    v3_cross(n, ab, ac);
    CHECK(v3_normalize(n, n));
    const int t = m->triangle_count++;
    m->part[0].triangle_count++;
    for (int c = 0; c < 3; c++) {
        const int v = hand_vertex(m, p[c][0], p[c][1], p[c][2]);
        for (int x = 0; x < 3; x++) m->normal[v][x] = (float)n[x];
        m->triangle[t][c] = (uint32_t)v;
    }
}

/* Two triangles that share a corner are one face where each lies within 10 um of the other's plane: of a large one and
 * a small one, tilted by less than 1 mrad, the small one does and the large one does not. */
static void a_tilted_neighbour_is_another_face(void **state)
{
    (void)state;
    static const double large = 1, small = 0.01;
    static const struct {
        double tilt_rad;
        int    faces;
    } of[] = {{0, 1}, {5e-6, 1}, {5e-4, 2}, {2e-3, 2}};
    for (int order = 0; order < 2; order++)
        for (int i = 0; i < 4; i++) {
            const double rise = small * of[i].tilt_rad;
            const double big[3][3] = {{0, 0, 0}, {0, large, 0}, {-large, 0, 0}},
                         little[3][3] = {{0, 0, 0}, {small, 0, rise}, {0, small, 0}};
            Model     m;
            FlatFaces f;
            hand_model(&m, 1, 6, 2);
            m.node[0].parent = -1;
            put_triangle(&m, order ? little : big);
            put_triangle(&m, order ? big : little);
            CHECK(model_measure(&m) == STATUS_OK && radar_flat_faces_find(&f, &m) == STATUS_OK);
            if (f.count != of[i].faces) fail_msg("tilted by %g: %d faces", of[i].tilt_rad, f.count);
            radar_flat_faces_free(&f);
            model_destroy(&m);
        }
}

/* Rays over the two triangles of a plate, which hides nothing: one of each first; then its middle, along each side and
 * in rows along the longest one, all as far apart as the radius of the target's sphere over 8 (a convex body), in rows
 * as their length is. A corner's faces are asked at a sixteenth of that. Two antennas ask twice. */
static long long rays_by_hand(double a, double b, double apart_m)
{
    const double c = hypot(a, b);
    const int    rows = (int)floor(a * b / c / apart_m);
    int          rays = 2 + (int)(ceil(a / apart_m) + ceil(b / apart_m) + ceil(c / apart_m));
    for (int j = 0; j < rows; j++) rays += (int)ceil((1 - (j + 0.5) / rows) * c / apart_m);
    return 2 * rays;
}

static void faces_are_searched_by_so_many_rays(void **state)
{
    (void)state;
    const ScatterAntenna front[2] = {{{0.8, 0.6, 0}, INFINITY}, {{0.8, 0, -0.6}, 100}};
    const ScatterAntenna split[2] = {{{0.8, 0.6, 0}, INFINITY}, {{-0.8, 0.6, 0}, INFINITY}};
    const ScatterAntenna grazing[3] = {{{9e-4, 1, 0}, INFINITY}, {{1.1e-3, 1, 0}, INFINITY}};
    RadarStage           s;
    uint8_t              seen[8];
    stage_open(&s, "plate:0.8x0.6", 10e9);
    const double apart_m = s.target->entity.radius_m / 8;
    CHECK_NEAR(s.target->entity.radius_m, 0.5, 1e-3);
    CHECK(radar_flat_faces_seen(seen, s.target, front, 1, NULL) == rays_by_hand(0.8, 0.6, apart_m) && seen[0] == 1);
    CHECK(radar_flat_faces_seen(seen, s.target, front, 2, NULL) == 2 * rays_by_hand(0.8, 0.6, apart_m) && seen[0] == 1);
    /* an antenna on either side, or one that looks along it by less than a thousandth: neither sees it */
    CHECK(radar_flat_faces_seen(seen, s.target, split, 2, NULL) == 0 && seen[0] == 0);
    CHECK(radar_flat_faces_seen(seen, s.target, &grazing[0], 1, NULL) == 0 && seen[0] == 0);
    CHECK(radar_flat_faces_seen(seen, s.target, &grazing[1], 1, NULL) > 0 && seen[0] == 1);
    stage_close(&s);

    const double         third = sqrt(1 / 3.0);
    const ScatterAntenna into[2] = {{{third, third, -third}, INFINITY}};
    stage_open(&s, "corner:0.5", 10e9);
    CHECK(radar_flat_faces_seen(seen, s.target, into, 1, NULL) ==
          3 * rays_by_hand(0.5, 0.5, s.target->entity.radius_m / 128));
    CHECK(seen[0] == 1 && seen[1] == 1 && seen[2] == 1);
    stage_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_is_round),
        cmocka_unit_test(discs_and_cylinders_are_polygons),
        cmocka_unit_test(flat_ones_are_where_they_are_said),
        cmocka_unit_test(names_are_checked),
        cmocka_unit_test(faces_are_counted),
        cmocka_unit_test(a_tilted_neighbour_is_another_face),
        cmocka_unit_test(faces_are_searched_by_so_many_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
