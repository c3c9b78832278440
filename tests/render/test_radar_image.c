/* The pseudo-radar picture on shapes whose answer geometry gives: plate, dihedral, trihedral.
 *
 * A corner sends every ray that meets all of its mirrors back where it came from, so its power per steradian is
 * its effective area, over range squared, times the lobe's peak. Effective areas: plate a b cos(tilt); dihedral of
 * square faces 2 a b min(sin, cos); square trihedral on its axis sqrt(3) a^2. labels: physics */
#include "tests/check.h"
#include "render/trace/parts/parts.h"
#include "render/scattering/radar_image.h"

static const double edge_m = 2, range_m = 1500, lobe_rad = 0.05;

enum { model_plate, model_dihedral, model_trihedral, model_wall, model_wedge, model_total };
enum { material_mirror = 1, material_earth = 2 };

/* Squares of edge_m, each two triangles, corner at the origin. Corners of a face: any of the axes' planes. */
typedef struct Shape {
    Model     model;
    ModelNode node;
    ModelPart part;
    double    vertex[12][3];
    float     normal[12][3];
    uint32_t  triangle[6][3];
    uint16_t  triangle_part[6];
} Shape;
static Shape shapes[model_total];

static void add_square(Shape *s, int axis, double from_u, double from_v, double at)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3, first = s->model.vertex_count;
    for (int k = 0; k < 4; k++) {
        double *p = s->vertex[first + k];
        p[axis] = at;
        p[u] = from_u + edge_m * (k == 1 || k == 2);
        p[v] = from_v + edge_m * (k >= 2);
        s->normal[first + k][axis] = 1;
    }
    for (int t = 0; t < 2; t++) {
        uint32_t *corner = s->triangle[s->model.triangle_count++];
        corner[0] = (uint32_t)first;
        corner[1] = (uint32_t)(first + 1 + t);
        corner[2] = (uint32_t)(first + 2 + t);
    }
    s->model.vertex_count += 4;
    s->part.triangle_count += 2;
}

static void finish(Shape *s, const char *name)
{
    strcpy(s->model.name, name);
    strcpy(s->node.name, "body");
    strcpy(s->part.name, "face");
    s->node.parent = -1;
    s->node.low = 1;
    m3_identity(s->node.r_parent_from_node);
    s->model.node_count = s->model.part_count = 1;
    s->model.node = &s->node;
    s->model.part = &s->part;
    s->model.vertex = s->vertex;
    s->model.normal = s->normal;
    s->model.triangle = s->triangle;
    s->model.triangle_part = s->triangle_part;
    s->model.radius_m = 2 * edge_m;
}

/* One world at a time: up to two entities, at the origin of ENU, body axes along ENU. */
typedef struct Bench {
    Tracer        *tracer;
    Arena         *arena;
    LocalFrame     frame;
    SnapshotEntity entity[2];
    NodePose       pose[2];
    Snapshot       snapshot;
    Visibility    *visibility;
    Material       rows[3];
    Materials      materials;
    int            part_rows[model_total], *part[model_total];
} Bench;
static Bench bench;

static int open_bench(void **state)
{
    (void)state;
    add_square(&shapes[model_plate], 0, -edge_m / 2, -edge_m / 2, 0);
    add_square(&shapes[model_dihedral], 0, 0, 0, 0); /* x = 0: y and z from 0 */
    add_square(&shapes[model_dihedral], 2, 0, 0, 0); /* z = 0 */
    for (int axis = 0; axis < 3; axis++) add_square(&shapes[model_trihedral], axis, 0, 0, 0);
    add_square(&shapes[model_wall], 0, -edge_m / 2, -edge_m / 2, 0);
    /* z = 0 and a square that leans over it by 45 degrees, about the y axis */
    Shape *wedge = &shapes[model_wedge];
    add_square(wedge, 2, 0, 0, 0);
    add_square(wedge, 2, 0, 0, 0);
    for (int k = 4; k < 8; k++) {
        wedge->normal[k][0] = -(float)sqrt(0.5), wedge->normal[k][2] = (float)sqrt(0.5);
        wedge->vertex[k][2] = wedge->vertex[k][0] *= sqrt(0.5);
    }
    static const char *const names[] = {"plate", "dihedral", "trihedral", "wall", "wedge"};
    const Model             *models[model_total];
    for (int m = 0; m < model_total; m++) {
        finish(&shapes[m], names[m]);
        models[m] = &shapes[m].model;
        bench.part_rows[m] = m == model_wall ? material_earth : material_mirror;
        bench.part[m] = &bench.part_rows[m];
    }
    bench.rows[material_mirror] = (Material){.metal = 1};
    bench.rows[material_earth] = (Material){.radar_gamma = 0.2f};
    bench.materials = (Materials){.count = 3, .material = bench.rows, .part = bench.part, .model_count = model_total};
    const Geodetic origin = {.lat_rad = 0.6, .lon_rad = -1.2, .h_m = 100};
    bench.arena = arena_create();
    return tracer_create_models(&bench.tracer, models, model_total, "avx2") != STATUS_OK || !bench.arena ||
           local_frame_at(&bench.frame, &origin) != STATUS_OK;
}

static int close_bench(void **state)
{
    (void)state;
    tracer_destroy(bench.tracer);
    arena_destroy(bench.arena);
    return 0;
}

static void place(int index, int model, const double p_enu[3])
{
    SnapshotEntity *e = &bench.entity[index];
    *e = (SnapshotEntity){.model = model, .first_node = index};
    ecef_from_enu(e->p_ecef, &bench.frame, p_enu);
    memcpy(e->r_ecef_from_body, bench.frame.r_ecef_from_enu, sizeof e->r_ecef_from_body);
    bench.pose[index] = (NodePose){.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    bench.snapshot =
        (Snapshot){.count = index + 1, .node_count = index + 1, .entity = bench.entity, .node = bench.pose};
}

static void pose_world(void)
{
    arena_reset(bench.arena);
    CHECK(visibility_create(&bench.visibility, bench.tracer, NULL, &bench.frame, &bench.snapshot, false, bench.arena) ==
          STATUS_OK);
    visibility_materials(bench.visibility, &bench.materials);
}

typedef struct Sum {
    double power[radar_bounces];      /* integral over the eye rays' solid angle */
    double slant_low_m, slant_high_m; /* of the highest bounce with power */
    int    first_hits;
} Sum;

static Rays         rays;
static Hits         hits;
static RadarReturns returns;

/* Looks from towards_eye at `aim`, over a square wide enough for any shape here, n rays a side. */
static Sum look(const double towards_eye[3], const double aim_enu[3], int n, int hidden)
{
    const RadarConfig  config = {.lobe_rad = lobe_rad};
    VisibilityCounters counters = {0};
    double             back[3] = {0}, side[3] = {0}, up[3] = {0}, eye[3];
    CHECK(v3_normalize(back, towards_eye));
    v3_cross(side, fabs(back[2]) < 0.9 ? (double[3]){0, 0, 1} : (double[3]){0, 1, 0}, back);
    CHECK(v3_normalize(side, side));
    v3_cross(up, back, side);
    v3_add_scaled(eye, aim_enu, range_m, back);
    const double half_width = 2 * edge_m / range_m, step = 2 * half_width / n;
    Sum          sum = {.slant_low_m = INFINITY, .slant_high_m = -INFINITY};
    int          highest = 0;
    rays.count = 0;
    for (int i = 0; i < n * n; i++) {
        const double x = -half_width + (i % n + 0.5) * step, y = -half_width + (i / n + 0.5) * step;
        double       d[3];
        v3_scale(d, -1, back);
        v3_add_scaled(d, d, x, side);
        v3_add_scaled(d, d, y, up);
        CHECK(v3_normalize(d, d));
        const int k = rays.count++;
        for (int a = 0; a < 3; a++) rays.o_enu[a][k] = eye[a], rays.d_enu[a][k] = d[a];
        rays.far_m[k] = INFINITY;
        if (rays.count < hits_capacity && i + 1 < n * n) continue;
        visibility_first_hit(&hits, bench.visibility, &rays, visibility_all_but(hidden), &counters);
        memset(&returns, 0xff, sizeof returns); /* NaN: whatever is left unwritten is found */
        radar_shade(&returns, &config,
                    &(RadarRays){.visibility = bench.visibility,
                                 .materials = &bench.materials,
                                 .hits = &hits,
                                 .rays = &rays,
                                 .hidden = hidden},
                    &counters);
        for (int h = 0; h < hits.count; h++) {
            sum.first_hits += hits.range_m[h] < INFINITY;
            for (int b = 0; b < radar_bounces; b++) {
                CHECK(returns.power[b][h] >= 0 && isfinite(returns.power[b][h]));
                sum.power[b] += returns.power[b][h] * step * step;
                if (!(returns.power[b][h] > 0) || b < highest) continue;
                if (b > highest) sum.slant_low_m = INFINITY, sum.slant_high_m = -INFINITY, highest = b;
                sum.slant_low_m = fmin(sum.slant_low_m, returns.slant_m[b][h]);
                sum.slant_high_m = fmax(sum.slant_high_m, returns.slant_m[b][h]);
            }
        }
        rays.count = 0;
    }
    return sum;
}

static const double origin_enu[3] = {0, 0, 0};

/* Power of a perfect retroreflector of this effective area. */
static double retro(double area_m2) { return area_m2 / (range_m * range_m) * radar_lobe(lobe_rad, 1); }

static void the_lobe_keeps_energy(void **state)
{
    (void)state;
    for (double lobe = 0.01; lobe < 1.5; lobe *= 1.7) {
        double    whole = 0, square = 0;
        const int n = 200000;
        for (int i = 0; i < n; i++) {
            const double angle = (i + 0.5) / n * pi_rad / 2;
            const double ring = radar_lobe(lobe, cos(angle)) * 2 * pi_rad * sin(angle) * pi_rad / 2 / n;
            whole += ring;
            square += ring * angle * angle;
        }
        CHECK_NEAR(whole, 1, 1e-5);
        if (lobe < 0.3) CHECK_NEAR(sqrt(square) / lobe, 1, 0.02); /* rms angle */
    }
    CHECK(radar_lobe(0.05, -0.1) == 0 && radar_lobe(0.05, 0) == 0);
}

static void a_plate_peaks_at_its_normal(void **state)
{
    (void)state;
    place(0, model_plate, origin_enu);
    pose_world();
    double last = INFINITY;
    for (int k = 0; k <= 8; k++) {
        const double tilt = k * 0.01, towards[3] = {cos(tilt), sin(tilt), 0};
        const Sum    sum = look(towards, origin_enu, 96, -1);
        /* the ray leaves at twice the tilt from its way back */
        const double want = edge_m * edge_m * cos(tilt) / (range_m * range_m) * radar_lobe(lobe_rad, cos(2 * tilt));
        CHECK_NEAR(sum.power[0] / want, 1, 0.01);
        CHECK(sum.power[1] == 0 && sum.power[2] == 0 && sum.power[0] < last);
        last = sum.power[0];
        if (k == 0) CHECK(sum.slant_low_m > range_m - 1e-3 && sum.slant_high_m < range_m + 2e-3);
    }
    /* far off: nothing comes back from a mirror; from behind it is a mirror again */
    CHECK(look((double[3]){1, 1, 0}, origin_enu, 32, -1).power[0] < 1e-9 * retro(edge_m * edge_m));
    CHECK_NEAR(look((double[3]){-1, 0, 0}, origin_enu, 96, -1).power[0] / retro(edge_m * edge_m), 1, 0.01);
}

static void a_dihedral_is_seen_all_over_its_plane(void **state)
{
    (void)state;
    place(0, model_dihedral, origin_enu);
    pose_world();
    const double aim[3] = {0, edge_m / 2, 0};
    for (int deg = 5; deg <= 85; deg += 8) {
        const double a = deg * rad_per_deg, towards[3] = {cos(a), 0, sin(a)};
        const Sum    sum = look(towards, aim, 160, -1);
        /* rays 5 cm apart over a band this wide: one column more or less, and a hundredth for the height */
        const double width_m = 2 * edge_m * fmin(sin(a), cos(a));
        CHECK_NEAR(sum.power[1] / retro(width_m * edge_m), 1, 0.05 / width_m + 0.01);
        CHECK(sum.power[2] == 0);
        /* every path through both faces is as long as the one to the edge */
        CHECK_NEAR(sum.slant_low_m, range_m, 2e-3);
        CHECK_NEAR(sum.slant_high_m, range_m, 4e-3);
        /* out of its plane it is dark: 15 degrees are twelve times the exit lobe's half width */
        const double out_of_plane[3] = {cos(a), tan(15 * rad_per_deg), sin(a)};
        CHECK(look(out_of_plane, aim, 40, -1).power[1] < 1e-9 * sum.power[1]);
    }
}

/* A wedge of an eighth of a turn sends back what comes along its middle by four mirrors. Unfolded, the way is a
 * straight line, which meets the faces at 22.5, 67.5, 112.5 and 157.5 degrees: those that pass the edge within a
 * sin(22.5). */
static void a_sharp_wedge_takes_four_mirrors(void **state)
{
    (void)state;
    place(0, model_wedge, origin_enu);
    pose_world();
    const double a = pi_rad / 8, towards[3] = {cos(a), 0, sin(a)}, aim[3] = {0, edge_m / 2, 0};
    const double width_m = 2 * edge_m * sin(a);
    const Sum    sum = look(towards, aim, 160, -1);
    CHECK_NEAR(sum.power[2] / retro(width_m * edge_m), 1, 0.05 / width_m + 0.01); /* as of the dihedral */
    CHECK(sum.power[0] + sum.power[1] < 1e-9 * sum.power[2]);
    CHECK_NEAR(sum.slant_low_m, range_m, 2e-3); /* as long as the way to the edge, not as the third mirror's */
    CHECK_NEAR(sum.slant_high_m, range_m, 4e-3);
}

static void a_trihedral_is_seen_over_its_cone(void **state)
{
    (void)state;
    place(0, model_trihedral, origin_enu);
    pose_world();
    const double axis[3] = {1, 1, 1};
    const Sum    on_axis = look(axis, origin_enu, 192, -1);
    CHECK_NEAR(on_axis.power[2] / retro(sqrt(3) * edge_m * edge_m), 1, 0.02);
    /* bounces apart: one or two mirrors send it elsewhere, 70 degrees and more, where the lobe is dark */
    CHECK(on_axis.power[0] < 1e-9 * on_axis.power[2] && on_axis.power[1] < 1e-9 * on_axis.power[2]);
    CHECK_NEAR(on_axis.slant_low_m, range_m, 2e-3);
    CHECK_NEAR(on_axis.slant_high_m, range_m, 4e-3);
    for (int k = 0; k < 12; k++) {
        /* 20 degrees from the axis, all round it */
        const double turn = k * pi_rad / 6, s = sin(20 * rad_per_deg), c = cos(20 * rad_per_deg);
        const double e1[3] = {1 / sqrt(2), -1 / sqrt(2), 0}, e2[3] = {1 / sqrt(6), 1 / sqrt(6), -2 / sqrt(6)};
        double       towards[3] = {c / sqrt(3), c / sqrt(3), c / sqrt(3)};
        v3_add_scaled(towards, towards, s * cos(turn), e1);
        v3_add_scaled(towards, towards, s * sin(turn), e2);
        const Sum sum = look(towards, origin_enu, 64, -1);
        CHECK(sum.power[2] > 0.3 * on_axis.power[2] && sum.power[2] < 1.02 * on_axis.power[2]);
    }
}

/* 1, 4 and 16 rays a pixel: the picture's sum settles on the answer, wherever the pixels fall (rms of nine shifts of
 * the grid by thirds of a pixel, 0.4 m wide). */
static void it_converges(void **state)
{
    (void)state;
    place(0, model_dihedral, origin_enu);
    pose_world();
    const double a = 33 * rad_per_deg, towards[3] = {cos(a), 0.003, sin(a)};
    double       error[3] = {0};
    const double want = look(towards, (double[3]){0, edge_m / 2, 0}, 480, -1).power[1];
    for (int k = 0; k < 3; k++) {
        for (int shift = 0; shift < 9; shift++) {
            const double aim[3] = {0.13 * (shift % 3), edge_m / 2 + 0.13 * (shift / 3), 0};
            const double e = look(towards, aim, 20 << k, -1).power[1] / want - 1;
            error[k] += e * e / 9;
        }
        error[k] = sqrt(error[k]);
    }
    print_message("dihedral in 20 x 20 pixels of 1 / 4 / 16 rays: error %.3f %.3f %.3f\n", error[0], error[1],
                  error[2]);
    CHECK(error[0] < 0.2 && error[1] < 0.7 * error[0] && error[2] < 0.7 * error[1]);
}

/* A wall before the lower half of a dihedral stops what would leave there: all of its double bounces. */
static void the_way_home_must_be_free(void **state)
{
    (void)state;
    const double aim[3] = {0, edge_m / 2, 0}, towards[3] = {1, 0, 1};
    place(0, model_dihedral, origin_enu);
    pose_world();
    const double free_power = look(towards, aim, 80, -1).power[1];
    /* the wall, normal to x, 2 m square, reaches up to the line of sight through the edge */
    place(1, model_wall, (double[3]){30, edge_m / 2, 30 - edge_m / 2});
    pose_world();
    const Sum blocked = look(towards, aim, 80, -1);
    CHECK(free_power > 0.9 * retro(2 * edge_m * edge_m * sqrt(0.5)));
    CHECK(blocked.power[1] < 0.02 * free_power && blocked.first_hits > 0);
    /* hidden, as the eye's own host is, it stops nothing */
    CHECK_NEAR(look(towards, aim, 80, 1).power[1] / free_power, 1, 1e-6);
}

static void earth_scatters_by_its_gamma(void **state)
{
    (void)state;
    place(0, model_wall, origin_enu);
    pose_world();
    for (int k = 0; k < 5; k++) {
        const double tilt = k * 0.3, towards[3] = {cos(tilt), sin(tilt), 0};
        const Sum    sum = look(towards, origin_enu, 96, -1);
        /* sigma0 A / (4 pi R^2) with sigma0 = gamma cos(tilt from the normal) */
        const double want = 0.2 * cos(tilt) * edge_m * edge_m / (4 * pi_rad * range_m * range_m);
        /* rays 83 mm apart over this width */
        CHECK_NEAR(sum.power[0] / want, 1, 0.083 / (edge_m * cos(tilt)) + 0.01);
        CHECK(sum.power[1] == 0 && sum.power[2] == 0);
    }
}

static void sky_gives_nothing(void **state)
{
    (void)state;
    place(0, model_plate, origin_enu);
    pose_world();
    const Sum sum = look((double[3]){1, 0, 0}, (double[3]){0, 0, 500}, 16, -1);
    CHECK(sum.first_hits == 0 && sum.power[0] == 0 && sum.power[1] == 0 && sum.power[2] == 0);
}

/* A perfect mirror and an even hemisphere are the ends, not 0 / 0. */
static void no_lobe_is_too_narrow_or_too_wide(void **state)
{
    (void)state;
    static const double narrow[3] = {0, 1e-300, 1e-10}, wide[2] = {1e8, 1e300};
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(radar_lobe(narrow[k], 1) * pi_rad * 1e-18, 1, 1e-12);
        CHECK(radar_lobe(narrow[k], 0.999) == 0);
    }
    for (int k = 0; k < 2; k++) CHECK_NEAR(radar_lobe(wide[k], 0.5) * 2 * pi_rad, 1, 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lobe_keeps_energy),
        cmocka_unit_test(a_plate_peaks_at_its_normal),
        cmocka_unit_test(a_dihedral_is_seen_all_over_its_plane),
        cmocka_unit_test(a_sharp_wedge_takes_four_mirrors),
        cmocka_unit_test(a_trihedral_is_seen_over_its_cone),
        cmocka_unit_test(it_converges),
        cmocka_unit_test(the_way_home_must_be_free),
        cmocka_unit_test(earth_scatters_by_its_gamma),
        cmocka_unit_test(sky_gives_nothing),
        cmocka_unit_test(no_lobe_is_too_narrow_or_too_wide),
    };
    return cmocka_run_group_tests(tests, open_bench, close_bench);
}
