/* One world with ground and parts: silhouettes and shadows against geometry worked out here, and the same bits
 * whether or not anything is skipped. */
#include "tests/render/hand_models.h"

#include <unistd.h>

#include "render/trace/parts/parts.h"
#include "render/trace/visibility/visibility.h"

enum { model_box, model_plate, model_sphere, model_count, most_entities = 240 };

static const double sphere_radius_m = 2, plate_half_y_m = 1.5, plate_half_z_m = 1;

/* A landscape that every test shares, the three models, and a snapshot to fill. */
typedef struct Stage {
    Landscape          landscape;
    Model              model[model_count];
    double             sphere_inside_m;
    Tracer            *tracer;
    Arena             *arena;
    SnapshotEntity     entity[most_entities];
    NodePose           pose[most_entities];
    Snapshot           snapshot;
    VisibilityCounters counters;
} Stage;

static Stage stage;

static int open_stage(void **state)
{
    (void)state;
    LandscapeConfig config = landscape_default_config();
    Geodetic        origin = {0.6, -1.9, 700};
    LocalFrame      frame;
    config.half_width_m = 500;
    config.horizon_m = 20000;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    hand_box(&stage.model[model_box], (const double[3]){-3, -1.5, -2}, (const double[3]){3, 1.5, 0});
    hand_plate(&stage.model[model_plate], plate_half_y_m, plate_half_z_m);
    stage.sphere_inside_m = hand_sphere(&stage.model[model_sphere], sphere_radius_m, 48);
    const Model *models[model_count];
    for (int m = 0; m < model_count; m++) models[m] = &stage.model[m];
    if (tracer_create_models(&stage.tracer, models, model_count, "avx2") != STATUS_OK) return -1;
    stage.arena = arena_create();
    return stage.arena ? 0 : -1;
}

static int close_stage(void **state)
{
    (void)state;
    landscape_destroy(&stage.landscape);
    tracer_destroy(stage.tracer);
    arena_destroy(stage.arena);
    for (int m = 0; m < model_count; m++) hand_free(&stage.model[m]);
    return 0;
}

static void clear_stage(void)
{
    arena_reset(stage.arena);
    memset(&stage.counters, 0, sizeof stage.counters);
    stage.snapshot = (Snapshot){.entity = stage.entity, .node = stage.pose};
}

static int add_entity(int model, const double p_enu[3], const double r_enu_from_body[9])
{
    const int       k = stage.snapshot.count++;
    SnapshotEntity *e = &stage.entity[k];
    *e = (SnapshotEntity){.model = model, .first_node = k};
    ecef_from_enu(e->p_ecef, &stage.landscape.frame, p_enu);
    m3_mul(e->r_ecef_from_body, stage.landscape.frame.r_ecef_from_enu, r_enu_from_body);
    stage.pose[k] = (NodePose){{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return k;
}

static Visibility *see(bool with_ground, bool no_skip)
{
    Visibility *v = NULL;
    assert_int_equal(visibility_create(&v, stage.tracer, with_ground ? &stage.landscape : NULL, &stage.landscape.frame,
                                       &stage.snapshot, no_skip ? skips_all_off : 0, stage.arena),
                     STATUS_OK);
    return v;
}

/* Looks from p_enu towards to_enu, columns level. */
static View view_towards(const double p_enu[3], const double to_enu[3], int width, int height, double focal_px)
{
    View   view = {.width = width, .height = height, .focal_px = focal_px};
    double z[3], x[3], y[3];
    v3_sub(z, to_enu, p_enu);
    v3_normalize(z, z);
    v3_cross(x, z, (const double[3]){0, 0, 1});
    v3_normalize(x, x);
    v3_cross(y, z, x);
    for (int c = 0; c < 3; c++) {
        view.p_enu[c] = p_enu[c];
        view.r_enu_from_cam[3 * c] = x[c];
        view.r_enu_from_cam[3 * c + 1] = y[c];
        view.r_enu_from_cam[3 * c + 2] = z[c];
    }
    return view;
}

static double ground_at(double x, double y) { return elevation_height(&stage.landscape.elevation, x, y, NULL); }

/* A block of one ray a pixel, its first column and row given, 32 x 32. */
static void block_rays(Rays *rays, const View *view, int column, int row)
{
    rays->count = 0;
    for (int r = row; r < row + 32 && r < view->height; r++)
        for (int c = column; c < column + 32 && c < view->width; c++) {
            double d[3];
            view_ray(d, view, c + 0.5, r + 0.5);
            for (int k = 0; k < 3; k++) {
                rays->o_enu[k][rays->count] = view->p_enu[k];
                rays->d_enu[k][rays->count] = d[k];
            }
            rays->far_m[rays->count++] = INFINITY;
        }
}

static void pixel_direction(double d_cam[3], const View *view, const Rays *rays, int i)
{
    const double d[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
    m3_tmul_v3(d_cam, view->r_enu_from_cam, d);
}

static Rays rays;
static Hits hits, other_hits;

/* ---- silhouettes ------------------------------------------------------------------------------ */

/* The cone of half-angle a about a direction at angle b off the axis cuts the image plane in an ellipse of area
 * pi f^2 cos a sin^2 a / (cos^2 a - sin^2 b)^(3/2). */
static double ellipse_px2(double focal_px, double sin_a, double sin_b)
{
    const double cos2 = 1 - sin_a * sin_a;
    return pi_rad * focal_px * focal_px * sqrt(cos2) * sin_a * sin_a / pow(cos2 - sin_b * sin_b, 1.5);
}

static void a_sphere_covers_its_ellipse(void **state)
{
    (void)state;
    static const double away_m[4] = {100, 8000, 50000, 200000};
    for (int n = 0; n < 8; n++) {
        clear_stage();
        double p[3], r[9], eye[3], d[3], to[3];
        hand_direction(p);
        v3_scale(p, away_m[n % 4], p);
        hand_rotation(r);
        add_entity(model_sphere, p, r);
        hand_direction(d);
        const double far_m = n < 4 ? 12 : 3000;
        v3_add_scaled(eye, p, -far_m, d);
        for (int c = 0; c < 3; c++) to[c] = p[c] + (n % 2 ? 0.4 : 0) * far_m * (c == n % 3) * (n < 4 ? 1 : 0.002);
        const View  view = view_towards(eye, to, 256, 256, n < 4 ? 150 : 60000);
        Visibility *v = see(false, false);

        double from_eye[3], c_cam[3];
        v3_sub(from_eye, p, eye);
        m3_tmul_v3(c_cam, view.r_enu_from_cam, from_eye);
        v3_normalize(c_cam, c_cam);
        const double sin_in = stage.sphere_inside_m / far_m, sin_out = sphere_radius_m / far_m;
        int          covered = 0;
        for (int row = 0; row < 256; row += 32)
            for (int column = 0; column < 256; column += 32) {
                int          list[most_entities], amodal;
                const double box_px[4] = {column, row, column + 32, row + 32};
                const int    count = visibility_block_entities(list, v, &view, box_px, -1, &(VisibilityCounters){0});
                block_rays(&rays, &view, column, row);
                visibility_first_hit(&hits, v, &rays, visibility_listed(list, count, -1), &stage.counters);
                uint8_t meets[hits_capacity];
                visibility_entity_only(meets, v, &rays, 0, &(VisibilityCounters){0});
                for (int i = 0; i < rays.count; i++) {
                    double d_cam[3], across[3];
                    pixel_direction(d_cam, &view, &rays, i);
                    v3_cross(across, d_cam, c_cam);
                    const double sine = v3_length(across);
                    const bool   met = hits.entity[i] == 1;
                    amodal = meets[i];
                    covered += met;
                    assert_int_equal(met, amodal);
                    if (sine < sin_in * (1 - 1e-6)) CHECK(met);
                    if (sine > sin_out * (1 + 1e-6)) CHECK(!met);
                }
            }
        /* between the ellipses of the inner and the outer sphere; a row of pixels along the rim either way, and
         * those errors are independent: a tenth of the rim */
        const double sin_b = sqrt(c_cam[0] * c_cam[0] + c_cam[1] * c_cam[1]);
        const double most = ellipse_px2(view.focal_px, sin_out, sin_b);
        const double least = ellipse_px2(view.focal_px, sin_in, sin_b);
        const double rim = 0.1 * 2 * sqrt(pi_rad * most);
        CHECK(covered > 500);
        CHECK(covered >= least - rim && covered <= most + rim);
    }
}

/* A plate's four edges on the image, from its corners; a pixel is in or out, but for a thousandth of a pixel. */
static void a_plate_covers_the_pixels_between_its_edges(void **state)
{
    (void)state;
    static const double away_m[4] = {100, 8000, 50000, 200000};
    int                 checked = 0, inside = 0;
    for (int n = 0; n < 24; n++) {
        clear_stage();
        double p[3], r[9], eye[3], d[3], corner_px[4][2];
        hand_direction(p);
        v3_scale(p, away_m[n % 4], p);
        hand_rotation(r);
        add_entity(model_plate, p, r);
        hand_direction(d);
        const double far_m = n % 3 == 0 ? 6 : n % 3 == 1 ? 300 : 10000;
        v3_add_scaled(eye, p, -far_m, d);
        const View  view = view_towards(eye, p, 96, 96, 20 * far_m);
        Visibility *v = see(false, false);

        double area2 = 0, box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY}, got[4];
        for (int k = 0; k < 4; k++) {
            const double y = (k == 1 || k == 2 ? 1 : -1) * plate_half_y_m, z = k >= 2 ? -2 * plate_half_z_m : 0;
            double       at[3], c_cam[3];
            for (int c = 0; c < 3; c++) at[c] = p[c] + r[3 * c + 1] * y + r[3 * c + 2] * z - eye[c];
            m3_tmul_v3(c_cam, view.r_enu_from_cam, at);
            corner_px[k][0] = 48 + view.focal_px * c_cam[0] / c_cam[2];
            corner_px[k][1] = 48 + view.focal_px * c_cam[1] / c_cam[2];
            for (int c = 0; c < 2; c++) {
                box[c] = fmin(box[c], corner_px[k][c]);
                box[c + 2] = fmax(box[c + 2], corner_px[k][c]);
            }
        }
        assert_true(visibility_project_box(got, v, &view, 0));
        /* a nanometre of ECEF, seen from there */
        for (int c = 0; c < 4; c++) CHECK_NEAR(got[c], box[c], 1e-5);
        for (int k = 0; k < 4; k++)
            area2 += corner_px[k][0] * corner_px[(k + 1) % 4][1] - corner_px[k][1] * corner_px[(k + 1) % 4][0];
        for (int block = 0; block < 9; block++) {
            const int    column = block % 3 * 32, row = block / 3 * 32;
            int          list[most_entities];
            const double box_px[4] = {column, row, column + 32, row + 32};
            const int    count = visibility_block_entities(list, v, &view, box_px, -1, &(VisibilityCounters){0});
            block_rays(&rays, &view, column, row);
            visibility_first_hit(&hits, v, &rays, visibility_listed(list, count, -1), &stage.counters);
            for (int i = 0; i < rays.count; i++) {
                const double x = column + i % 32 + 0.5, y = row + i / 32 + 0.5;
                double       least_px = INFINITY;
                for (int k = 0; k < 4; k++) {
                    const double *a = corner_px[k], *b = corner_px[(k + 1) % 4];
                    const double  ex = b[0] - a[0], ey = b[1] - a[1], length = sqrt(ex * ex + ey * ey);
                    least_px = fmin(least_px, copysign(1, area2) * (ex * (y - a[1]) - ey * (x - a[0])) / length);
                }
                if (fabs(least_px) < 1e-3) continue;
                checked++;
                inside += least_px > 0;
                if ((hits.entity[i] == 1) != (least_px > 0))
                    fail_msg("plate %d, pixel %g %g, %g px inside its edges", n, x, y, least_px);
            }
        }
    }
    CHECK(checked > 200000 && inside > 15000);
}

/* ---- who wins --------------------------------------------------------------------------------- */

static void level_rotation(double r[9], double heading_rad)
{
    /* forward, right, down in east, north, up */
    const double s = sin(heading_rad), c = cos(heading_rad);
    const double m[9] = {s, c, 0, c, -s, 0, 0, 0, -1};
    memcpy(r, m, sizeof m);
}

static void one_ray(const double o[3], const double to[3])
{
    double d[3];
    v3_sub(d, to, o);
    v3_normalize(d, d);
    rays.count = 1;
    for (int c = 0; c < 3; c++) rays.o_enu[c][0] = o[c], rays.d_enu[c][0] = d[c];
    rays.far_m[0] = INFINITY;
}

static void the_nearest_wins_and_the_lowest_id_of_equals(void **state)
{
    (void)state;
    clear_stage();
    double       r[9];
    const double z = ground_at(40, 30) + 50, at[3] = {40, 30, z}, behind[3] = {40, 40, z};
    const double eye[3] = {40.2, -20, z + 0.7};
    level_rotation(r, pi_rad); /* faces south, towards the eye */
    add_entity(model_plate, behind, r);
    add_entity(model_plate, at, r);
    add_entity(model_plate, at, r);
    const double to[3] = {40.2, 30, z + 0.7};
    one_ray(eye, to);
    for (int no_skip = 0; no_skip < 2; no_skip++) {
        Visibility *v = see(true, no_skip);
        visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &stage.counters);
        assert_int_equal(hits.entity[0], 2);
        assert_int_equal(hits.part[0], 1);
        assert_int_equal(hits.model[0], model_plate);
        assert_int_equal(hits.surface[0], 0);
        CHECK_NEAR(hits.range_m[0], 50, 1e-7);
        CHECK_NEAR(hits.p_enu[1][0], 30, 1e-7);
        visibility_first_hit(&hits, v, &rays, visibility_all_but(1), &stage.counters);
        assert_int_equal(hits.entity[0], 3);
        const int list[1] = {0};
        visibility_first_hit(&hits, v, &rays, visibility_listed(list, 1, -1), &stage.counters);
        assert_int_equal(hits.entity[0], 1);
        rays.far_m[0] = 59;
        visibility_first_hit(&hits, v, &rays, visibility_listed(list, 1, -1), &stage.counters);
        assert_int_equal(hits.entity[0], 0);
        CHECK(isinf(hits.range_m[0]));
        rays.far_m[0] = INFINITY;
        /* whole, whoever stands before it */
        uint8_t meets[1];
        for (int k = 0; k < 3; k++) {
            visibility_entity_only(meets, v, &rays, k, &(VisibilityCounters){0});
            assert_int_equal(meets[0], 1);
        }
    }
}

static void the_ground_hides_and_is_hidden(void **state)
{
    (void)state;
    clear_stage();
    double       r[9];
    const double z = ground_at(10, 10);
    level_rotation(r, 0);
    add_entity(model_box, (const double[3]){10, 10, z - 5}, r); /* buried */
    add_entity(model_box, (const double[3]){60, 10, ground_at(60, 10) + 1}, r);
    stage.entity[2] = (SnapshotEntity){.model = 99};
    stage.entity[3] = (SnapshotEntity){.model = -1};
    stage.snapshot.count = 4;
    Visibility *v = see(true, false);
    uint8_t     meets[1];

    one_ray((const double[3]){10, 10, z + 100}, (const double[3]){10, 10, z - 5});
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &stage.counters);
    assert_int_equal(hits.entity[0], 0);
    CHECK(hits.surface[0] > 0 && hits.surface[0] < SURFACE_COUNT);
    assert_int_equal(hits.surface[0], landscape_surface(&stage.landscape, hits.p_enu[0][0], hits.p_enu[1][0]));
    CHECK_NEAR(hits.p_enu[2][0], z, 1e-9);
    visibility_entity_only(meets, v, &rays, 0, &(VisibilityCounters){0});
    assert_int_equal(meets[0], 1);
    for (int k = 2; k < 4; k++) {
        double     box[4];
        const View view = view_towards((const double[3]){10, 10, z + 100}, (const double[3]){60, 10, z}, 64, 64, 100);
        visibility_entity_only(meets, v, &rays, k, &(VisibilityCounters){0});
        assert_int_equal(meets[0], 0);
        assert_false(visibility_project_box(box, v, &view, k));
    }

    one_ray((const double[3]){60, 10, z + 100}, (const double[3]){60, 10, z});
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &stage.counters);
    assert_int_equal(hits.entity[0], 2);
    CHECK_NEAR(hits.p_enu[2][0], ground_at(60, 10) + 3, 1e-7);
    for (int c = 0; c < 3; c++) CHECK_NEAR(hits.n_geo[c][0], c == 2, 1e-7);

    /* sky */
    one_ray((const double[3]){60, 10, z + 100}, (const double[3]){60, 10, z + 101});
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &stage.counters);
    CHECK(isinf(hits.range_m[0]) && hits.entity[0] == 0 && hits.surface[0] == 0 && hits.part[0] == 0);
    uint8_t shadow = 7;
    visibility_shadow(&shadow, v, &hits, (const double[3]){0, 0, 1}, &stage.counters);
    assert_int_equal(shadow, 0);
}

/* ---- shadows ------------------------------------------------------------------------------------ */

/* Does the line from a place along the sun go through the plate? NaN where it is too close to an edge to say. */
static double plate_shades(const double p[3], const double plate[3], const double r[9], const double sun[3],
                           double near_m)
{
    const double normal[3] = {r[0], r[3], r[6]};
    double       from[3], at[3];
    v3_sub(from, plate, p);
    const double t = v3_dot(from, normal) / v3_dot(sun, normal);
    if (t < 0) return 0;
    for (int c = 0; c < 3; c++) at[c] = t * sun[c] - from[c];
    const double y = r[1] * at[0] + r[4] * at[1] + r[7] * at[2], z = r[2] * at[0] + r[5] * at[1] + r[8] * at[2];
    const double out = fmax(fabs(y) - plate_half_y_m, fabs(z + plate_half_z_m) - plate_half_z_m);
    return fabs(out) < near_m ? NAN : out < 0;
}

static void a_plate_shades_what_lies_behind_it(void **state)
{
    (void)state;
    clear_stage();
    const double heading_rad = 0.3, sun_high_rad = 0.9;
    const double plate[3] = {20, -10, ground_at(20, -10) + 6};
    const double level = cos(sun_high_rad);
    const double sun[3] = {sin(heading_rad) * level, cos(heading_rad) * level, sin(sun_high_rad)};
    double       r[9];
    level_rotation(r, heading_rad + 0.2);
    const int      host = add_entity(model_plate, plate, r);
    const double   shade_to[3] = {plate[0] - sun[0] / sun[2] * 7, plate[1] - sun[1] / sun[2] * 7, plate[2] - 7};
    const View     view = view_towards((const double[3]){30, -40, plate[2] + 25}, shade_to, 128, 128, 600);
    Visibility    *v = see(true, false);
    static uint8_t shadow[hits_capacity];
    int            in_shade = 0, in_sun = 0, hidden_seen = 0;
    for (int block = 0; block < 16; block++) {
        block_rays(&rays, &view, block % 4 * 32, block / 4 * 32);
        /* the plate is the host: unseen, and still it shades */
        visibility_first_hit(&hits, v, &rays, visibility_all_but(host), &stage.counters);
        visibility_shadow(shadow, v, &hits, sun, &stage.counters);
        for (int i = 0; i < rays.count; i++) {
            const double p[3] = {hits.p_enu[0][i], hits.p_enu[1][i], hits.p_enu[2][i]};
            hidden_seen += hits.entity[i] != 0;
            const double want = plate_shades(p, plate, r, sun, 3e-3); /* the ray starts 1 mm off the ground */
            if (isnan(want)) continue;
            if (want) CHECK(shadow[i] == 1);
            else in_sun += shadow[i] == 0; /* the hills may shade a little of it */
            in_shade += want == 1;
        }
    }
    assert_int_equal(hidden_seen, 0);
    CHECK(in_shade > 300);
    CHECK(in_sun > 128 * 128 * 0.9 - in_shade);

    /* a sun under the horizon leaves all of it turned away or behind the ground */
    const double night[3] = {0, 0.6, -0.8};
    visibility_shadow(shadow, v, &hits, night, &stage.counters);
    for (int i = 0; i < hits.count; i++) assert_int_equal(shadow[i], 1);
}

/* The far side of a sphere is dark, the near side is lit, and neither shades itself. */
static void a_sphere_is_lit_on_one_side(void **state)
{
    (void)state;
    clear_stage();
    double       r[9];
    const double p[3] = {0, 0, 500}, eye[3] = {3000, 100, 700}, sun[3] = {0, 0.6, 0.8};
    hand_rotation(r);
    add_entity(model_sphere, p, r);
    const View     view = view_towards(eye, p, 96, 96, 60000);
    Visibility    *v = see(true, false);
    static uint8_t shadow[hits_capacity];
    int            lit = 0, dark = 0;
    for (int block = 0; block < 9; block++) {
        block_rays(&rays, &view, block % 3 * 32, block / 3 * 32);
        visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &stage.counters);
        visibility_shadow(shadow, v, &hits, sun, &stage.counters);
        for (int i = 0; i < rays.count; i++) {
            if (hits.entity[i] != 1) continue;
            const double n_sun = hits.n_geo[0][i] * sun[0] + hits.n_geo[1][i] * sun[1] + hits.n_geo[2][i] * sun[2];
            if (n_sun > 1e-6) CHECK(shadow[i] == 0);
            if (n_sun <= 0) CHECK(shadow[i] == 1);
            lit += shadow[i] == 0;
            dark += shadow[i] == 1;
        }
    }
    CHECK(lit > 1000 && dark > 500);
}

/* ---- the same bits ------------------------------------------------------------------------------ */

static void same_hits(const Hits *a, const Hits *b)
{
    const size_t n = (size_t)a->count;
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->range_m, b->range_m, n * sizeof a->range_m[0]);
    for (int c = 0; c < 3; c++) {
        assert_memory_equal(a->p_enu[c], b->p_enu[c], n * sizeof a->p_enu[0][0]);
        assert_memory_equal(a->n_geo[c], b->n_geo[c], n * sizeof a->n_geo[0][0]);
        assert_memory_equal(a->n_enu[c], b->n_enu[c], n * sizeof a->n_enu[0][0]);
    }
    assert_memory_equal(a->entity, b->entity, n * sizeof a->entity[0]);
    assert_memory_equal(a->part, b->part, n * sizeof a->part[0]);
    assert_memory_equal(a->model, b->model, n * sizeof a->model[0]);
    assert_memory_equal(a->surface, b->surface, n * sizeof a->surface[0]);
}

/* Ranges alone are those of the hits; also of rays that end before, at or behind what they would meet. */
static void same_ranges(Visibility *skip, Visibility *all, int hidden)
{
    static double   range_m[hits_capacity];
    static uint32_t entity[hits_capacity];
    const size_t    n = (size_t)rays.count;
    for (int limited = 0; limited < 3; limited++) {
        for (int i = 0; i < rays.count && limited; i++)
            rays.far_m[i] = (limited == 1 ? 0.9 : hand_uniform(0.5, 1.3)) * fmin(hits.range_m[i], 300);
        visibility_first_range(range_m, entity, skip, &rays, visibility_all_but(hidden), &stage.counters);
        visibility_first_hit(&other_hits, all, &rays, visibility_all_but(hidden), &stage.counters);
        assert_memory_equal(range_m, other_hits.range_m, n * sizeof *range_m);
        assert_memory_equal(entity, other_hits.entity, n * sizeof *entity);
    }
    for (int i = 0; i < rays.count; i++) rays.far_m[i] = INFINITY;
}

static void skipping_changes_no_bit(void **state)
{
    (void)state;
    static uint8_t shadow[hits_capacity], other_shadow[hits_capacity], meets[hits_capacity], other_meets[hits_capacity];
    static const double sun[3] = {0.36, 0.48, 0.8};
    int                 seen = 0, shaded = 0;
    for (int scene = 0; scene < 4; scene++) {
        clear_stage();
        for (int k = 0; k < 24; k++) {
            double r[9], p[3] = {hand_uniform(-80, 80), hand_uniform(-80, 80), 0};
            p[2] = ground_at(p[0], p[1]) + hand_uniform(-1, 6);
            if (k % 3) level_rotation(r, hand_uniform(0, 6));
            else hand_rotation(r);
            add_entity(k % model_count, p, r);
        }
        const double eye[3] = {hand_uniform(-90, 90), -110, ground_at(0, -110) + hand_uniform(5, 30)};
        const double to[3] = {0, 0, ground_at(0, 0)};
        const View   view = view_towards(eye, to, 96, 96, 180);
        Visibility  *skip = see(true, false), *all = see(true, true);
        for (int block = 0; block < 9; block++) {
            const int    column = block % 3 * 32, row = block / 3 * 32, hidden = scene % 2 ? 5 : -1;
            int          list[most_entities], every[most_entities];
            const double box_px[4] = {column, row, column + 32, row + 32};
            const int    count = visibility_block_entities(list, skip, &view, box_px, hidden, &(VisibilityCounters){0});
            assert_int_equal(visibility_block_entities(every, all, &view, box_px, hidden, &(VisibilityCounters){0}),
                             hidden < 0 ? 24 : 23);
            block_rays(&rays, &view, column, row);
            visibility_first_hit(&hits, skip, &rays, visibility_listed(list, count, hidden), &stage.counters);
            visibility_first_hit(&other_hits, all, &rays, visibility_listed(every, hidden < 0 ? 24 : 23, hidden),
                                 &stage.counters);
            same_hits(&hits, &other_hits);
            visibility_first_hit(&other_hits, skip, &rays, visibility_all_but(hidden), &stage.counters);
            same_hits(&hits, &other_hits);
            same_ranges(skip, all, hidden);
            visibility_shadow(shadow, skip, &hits, sun, &stage.counters);
            visibility_shadow(other_shadow, all, &hits, sun, &stage.counters);
            assert_memory_equal(shadow, other_shadow, (size_t)rays.count);
            for (int k = 0; k < 24; k += 5) {
                visibility_entity_only(meets, skip, &rays, k, &(VisibilityCounters){0});
                visibility_entity_only(other_meets, all, &rays, k, &(VisibilityCounters){0});
                assert_memory_equal(meets, other_meets, (size_t)rays.count);
            }
            for (int i = 0; i < rays.count; i++) {
                seen += hits.entity[i] > 0;
                shaded += shadow[i] && !hits.entity[i] && hits.n_geo[2][i] > 0.5;
                CHECK(hidden < 0 || hits.entity[i] != 6);
                /* normals are unit, and on the ray's side */
                if (!(hits.range_m[i] < INFINITY)) continue;
                const double d[3] = {rays.d_enu[0][i], rays.d_enu[1][i], rays.d_enu[2][i]};
                const double g[3] = {hits.n_geo[0][i], hits.n_geo[1][i], hits.n_geo[2][i]};
                const double s[3] = {hits.n_enu[0][i], hits.n_enu[1][i], hits.n_enu[2][i]};
                CHECK_NEAR(v3_length(g), 1, 1e-6);
                CHECK_NEAR(v3_length(s), 1, 1e-6);
                CHECK(v3_dot(g, d) <= 1e-7 && v3_dot(s, d) <= 1e-7);
            }
        }
    }
    CHECK(seen > 800 && shaded > 100);
    CHECK(stage.counters.skipped_parts > stage.counters.rays_parts);
}

/* Many through each other, some in exactly one place, one far and one nowhere: by the tree as by looking at all. */
static void a_crowd_is_met_as_without_the_tree(void **state)
{
    (void)state;
    static uint8_t shadow[hits_capacity], other_shadow[hits_capacity];
    const double   sun[3] = {0.6, 0, 0.8};
    int            seen = 0, shaded = 0;
    for (int scene = 0; scene < 4; scene++) {
        clear_stage();
        for (int k = 0; k < most_entities; k++) {
            double       r[9];
            const double wide_m = scene == 1 ? 4 : 25;
            double       p[3] = {hand_uniform(-wide_m, wide_m), hand_uniform(-wide_m, wide_m), 0};
            p[2] = ground_at(p[0], p[1]) + hand_uniform(-1, 6);
            hand_rotation(r);
            if (k % 10 == 1) p[0] = 1, p[1] = 2, p[2] = ground_at(1, 2) + 2, m3_identity(r); /* ties, to the bit */
            if (k == 100) p[0] = 9e6;
            add_entity(k % 10 == 1 ? model_box : k % model_count, p, r);
            if (k == 101) stage.pose[k].p_body[1] = NAN;
        }
        const double eye[3] = {-30, -90, ground_at(-30, -90) + hand_uniform(5, 30)};
        const double to[3] = {0, 0, ground_at(0, 0)};
        const View   view = view_towards(eye, to, 64, 32, 90);
        Visibility  *tree = see(scene % 2, false), *all = see(scene % 2, true);
        for (int block = 0; block < 2; block++) {
            static int   list[most_entities], some[most_entities];
            const int    hidden = scene == 2 ? 4 : -1;
            const double box_px[4] = {32 * block, 0, 32 * block + 32, 32};
            const int    count = visibility_block_entities(list, tree, &view, box_px, hidden, &stage.counters);
            int          odd = 0;
            for (int k = 0; k < count; k++) {
                CHECK(k == 0 || list[k - 1] < list[k]);
                if (list[k] % 2) some[odd++] = list[k];
            }
            block_rays(&rays, &view, 32 * block, 0);
            if (scene == 3) rays.columns = 32;
            visibility_first_hit(&hits, tree, &rays, visibility_listed(list, count, hidden), &stage.counters);
            visibility_first_hit(&other_hits, all, &rays, visibility_all_but(hidden), &(VisibilityCounters){0});
            same_hits(&hits, &other_hits);
            visibility_shadow(shadow, tree, &hits, sun, &stage.counters);
            visibility_shadow(other_shadow, all, &hits, sun, &(VisibilityCounters){0});
            assert_memory_equal(shadow, other_shadow, (size_t)rays.count);
            visibility_first_hit(&other_hits, tree, &rays, visibility_all_but(hidden), &stage.counters);
            same_hits(&hits, &other_hits);
            for (int i = 0; i < hits.count; i++) {
                seen += hits.entity[i] > 0, shaded += shadow[i];
                CHECK(hits.entity[i] % 10 != 2 || hits.entity[i] == 2); /* of those in one place the first */
            }
            /* those of a list alone */
            visibility_first_hit(&hits, tree, &rays, visibility_listed(some, odd, hidden), &stage.counters);
            visibility_first_hit(&other_hits, all, &rays, visibility_listed(some, odd, hidden),
                                 &(VisibilityCounters){0});
            same_hits(&hits, &other_hits);
            for (int i = 0; i < hits.count; i++) CHECK(hits.entity[i] % 2 == 0);
        }
    }
    CHECK(seen > 1000 && shaded > 300);
    CHECK(stage.counters.skipped[SKIP_TREE] > 0);
}

/* A ray's answer does not depend on its company. */
static void a_block_is_the_sum_of_its_rays(void **state)
{
    (void)state;
    clear_stage();
    double       r[9];
    const double p[3] = {5, 5, ground_at(5, 5)}, eye[3] = {-60, -50, ground_at(-60, -50) + 9};
    level_rotation(r, 1);
    add_entity(model_box, p, r);
    const View  view = view_towards(eye, p, 32, 32, 100);
    Visibility *v = see(true, false);
    static Rays alone;
    block_rays(&rays, &view, 0, 0);
    visibility_first_hit(&hits, v, &rays, visibility_all_but(-1), &stage.counters);
    for (int i = 0; i < rays.count; i++) {
        alone.count = 1;
        alone.far_m[0] = INFINITY;
        for (int c = 0; c < 3; c++) {
            alone.o_enu[c][0] = rays.o_enu[c][i];
            alone.d_enu[c][0] = rays.d_enu[c][i];
        }
        visibility_first_hit(&other_hits, v, &alone, visibility_all_but(-1), &stage.counters);
        CHECK(other_hits.range_m[0] == hits.range_m[i] && other_hits.entity[0] == hits.entity[i]);
        for (int c = 0; c < 3; c++) CHECK(other_hits.n_enu[c][0] == hits.n_enu[c][i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_covers_its_ellipse),
        cmocka_unit_test(a_plate_covers_the_pixels_between_its_edges),
        cmocka_unit_test(the_nearest_wins_and_the_lowest_id_of_equals),
        cmocka_unit_test(the_ground_hides_and_is_hidden),
        cmocka_unit_test(a_plate_shades_what_lies_behind_it),
        cmocka_unit_test(a_sphere_is_lit_on_one_side),
        cmocka_unit_test(skipping_changes_no_bit),
        cmocka_unit_test(a_crowd_is_met_as_without_the_tree),
        cmocka_unit_test(a_block_is_the_sum_of_its_rays),
    };
    thread_flush_denormals();
    alarm(120); /* a tracer that never returns is a failure, not a wait */
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
