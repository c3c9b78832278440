/* Sample points on a body (render/light/sky_entities.c): the grid over it, where its points lie on a brick, the light
 * there, and what a hit takes of them. labels: physics */
#include "tests/render/change_stage.h"

#include "render/light/sky_visibility_private.h"

static const unsigned bands = 1u << AIR_R | 1u << AIR_LWIR;

static SkyVisibility *sky;
static SkyWorker     *worker;
static View           view;
static double         box_px[most_bodies][4];
static double         sphere_enu[3] = {0, 0, 1};
static bool           before; /* the sphere stands on the eye's side */

/* A camera that looks from an eye at the origin. */
static void look_from(const double eye_enu[3], double focal_px)
{
    double x[3], y[3], z[3];
    for (int c = 0; c < 3; c++) z[c] = -eye_enu[c];
    v3_normalize(z, z);
    v3_cross(x, z, (const double[3]){0, 0, 1});
    v3_normalize(x, x);
    v3_cross(y, z, x);
    view = (View){.width = 640, .height = 480, .focal_px = focal_px};
    for (int c = 0; c < 3; c++)
        view.p_enu[c] = eye_enu[c], view.r_enu_from_cam[3 * c] = x[c], view.r_enu_from_cam[3 * c + 1] = y[c],
        view.r_enu_from_cam[3 * c + 2] = z[c];
}

/* A turned brick about the origin, 0, and a sphere behind or before it, 1, that is taken for not on the image. */
static void open_sky(double turn_rad, unsigned skips_off)
{
    const double c = cos(turn_rad), s = sin(turn_rad), r[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
    clear_bodies();
    add_body(model_brick, (const double[3]){0, 0, 0}, r);
    sphere_enu[0] = before == (view.p_enu[0] > 0) ? 6 : -6;
    add_body(model_sphere, sphere_enu, NULL);
    pose_bodies();
    set_rho(0.3, 0.2);
    set_air((const double[3]){0.48, 0.6, 0.64}, 300, 20, 15);
    assert_true(visibility_project_box(box_px[0], stage.visibility, &view, 0));
    for (int k = 0; k < 4; k++) box_px[1][k] = NAN;
    const SkyVisibilityScene scene = {.gather = stage_scene(),
                                      .view = &view,
                                      .box_px = (const double(*)[4])box_px,
                                      .air_bands = bands,
                                      .skips_off = skips_off,
                                      .hidden_entity = -1};
    assert_int_equal(sky_visibility_create(&sky, &scene, stage.arena), STATUS_OK);
    assert_int_equal(sky_worker_create(&worker, sky, stage.arena), STATUS_OK);
    CHECK(sky->on_image == 1 && sky->grid_of[0] == 1 && sky->grid_of[1] == 0 && sky->entity[0].index == 0);
}

/* ---- the grid --------------------------------------------------------------------------------- */

/* Axes of the brick's body are the columns of its rotation. */
static void in_body(double out[3], const double enu[3])
{
    const double *r = visibility_posed(stage.visibility, 0)->r_enu_from_body;
    for (int c = 0; c < 3; c++) out[c] = r[c] * enu[0] + r[3 + c] * enu[1] + r[6 + c] * enu[2];
}

typedef struct Grid {
    double from[3], across[2][3]; /* of the body */
    double low[2], step[2];
    int    count[2];
} Grid;

/* Seen along the middle of its bin of directions: a cube of 12 x 12 squares a side; points at the nearest of distances
 * 2^(n / 2) m to 2.75 px at the body's middle, 3 to 48 of them across the box. */
static Grid grid_on_paper(void)
{
    Grid               g;
    const PosedEntity *box = visibility_posed(stage.visibility, 0);
    double             to_eye[3], middle[3], length = 0;
    const double       centre[3] = {0.5, 0.25, 0.25};
    int                axis = 0;
    in_body(to_eye, view.p_enu);
    v3_sub(to_eye, to_eye, centre);
    const double away_m = v3_length(to_eye);
    for (int c = 1; c < 3; c++)
        if (fabs(to_eye[c]) > fabs(to_eye[axis])) axis = c;
    for (int c = 0; c < 3; c++)
        middle[c] = c == axis ? copysign(1, to_eye[c]) : (floor(6 + 6 * to_eye[c] / fabs(to_eye[axis])) + 0.5) / 6 - 1;
    length = v3_length(middle);
    for (int c = 0; c < 3; c++) g.from[c] = middle[c] / length;
    const double flat = hypot(g.from[0], g.from[1]);
    g.across[0][0] = g.from[1] / flat, g.across[0][1] = -g.from[0] / flat, g.across[0][2] = 0;
    v3_cross(g.across[1], g.from, g.across[0]);
    const double pitch = pow(2, 0.5 * rint(2 * log2(2.75 * away_m / view.focal_px)));
    for (int k = 0; k < 2; k++) {
        double low = 0, high = 0;
        for (int c = 0; c < 3; c++) {
            low += fmin(g.across[k][c] * box->box_low[c], g.across[k][c] * box->box_high[c]);
            high += fmax(g.across[k][c] * box->box_low[c], g.across[k][c] * box->box_high[c]);
        }
        g.count[k] = (int)fmin(fmax(ceil((high - low) / pitch), 3), 48);
        g.low[k] = low, g.step[k] = (high - low) / g.count[k];
    }
    return g;
}

static const double eyes_enu[][3] = {{60, 20, 15},    {-40, 70, 30}, {10, -45, 4},
                                     {-30, -28, -25}, {7, 9, 80},    {120, -300, 60}};

static void grids_stand_on_the_body(void **state)
{
    (void)state;
    for (int e = 0; e < 6 + 8; e++)
        for (int turn = 0; turn < 3; turn++) {
            const double away[3] = {50 + 4 * e, 20 + 2 * e, 12 + e};
            look_from(e < 6 ? eyes_enu[e] : away, e == 5 ? 300 : 1000);
            open_sky(0.9 * turn - 0.4, 0);
            const Grid       g = grid_on_paper();
            const SkyEntity *of = &sky->entity[0];
            double           body[3];
            CHECK(of->of_body && of->columns == g.count[0] && of->rows == g.count[1]);
            in_body(body, of->from_enu);
            for (int c = 0; c < 3; c++) CHECK_NEAR(body[c], g.from[c], 1e-6);
            for (int k = 0; k < 2; k++) {
                CHECK_NEAR(of->low[k], g.low[k], 1e-5);
                CHECK_NEAR(of->step[k], g.step[k], 1e-6);
                in_body(body, of->across_enu[k]);
                for (int c = 0; c < 3; c++) CHECK_NEAR(body[c], g.across[k][c], 1e-6);
            }
            CHECK_NEAR(of->pitch_m, fmax(g.step[0], g.step[1]), 1e-6);
            CHECK(of->tasks == (of->columns * of->rows + 31) / 32 && sky_visibility_tasks(sky) == of->tasks &&
                  of->first_task == 0);
        }
    /* straight from above: no level side is nearer than another, and the first axis is taken */
    double low_enu[3] = {0.5, 0.25, 100};
    look_from(low_enu, 1000);
    open_sky(0, 0);
    CHECK(sky->entity[0].columns > 3);
}

/* A body of more than 132 px lies under a grid of the picture, of what of it is on that: 2.75 px, 48 at most. */
static void large_bodies_have_the_pictures_grid(void **state)
{
    (void)state;
    look_from((const double[3]){12, 9, 5}, 1200);
    open_sky(0.4, 0);
    const double left = fmax(box_px[0][0], 0), right = fmin(box_px[0][2], 640), top = fmax(box_px[0][1], 0),
                 bottom = fmin(box_px[0][3], 480);
    const SkyEntity *of = &sky->entity[0];
    CHECK(box_px[0][2] - box_px[0][0] > 132 && !of->of_body);
    CHECK(of->columns == (int)fmin(ceil((right - left) / 2.75), 48) &&
          of->rows == (int)fmin(ceil((bottom - top) / 2.75), 48));
    CHECK_NEAR(of->low[0], left, 1e-9);
    CHECK_NEAR(of->low[1], top, 1e-9);
    CHECK_NEAR(of->step[0], (right - left) / of->columns, 1e-9);
    CHECK_NEAR(of->step[1], (bottom - top) / of->rows, 1e-9);
    double off[3];
    v3_sub(off, visibility_posed(stage.visibility, 0)->centre_enu, view.p_enu);
    CHECK_NEAR(of->pitch_m, v3_length(off) / 1200 * fmax(of->step[0], of->step[1]), 1e-9);
    /* what lies on the picture alone counts: 40 x 33 px of it; and what is no larger than 132 px stands on the body */
    static const double box[4][4] = {
        {600, 10, 760, 43}, {-120, 300, 40, 333}, {10, 447, 50, 620}, {200, -100, 240, 33}};
    static const int more[4][2] = {{15, 12}, {15, 12}, {15, 12}, {15, 12}};
    for (int k = 0; k < 4; k++) {
        SkyEntity e = {0};
        assert_int_equal(sky_entities_grid(&e, sky, visibility_posed(stage.visibility, 0), box[k], stage.arena),
                         STATUS_OK);
        CHECK(!e.of_body && e.columns == more[k][0] && e.rows == more[k][1]);
    }
    for (int k = 0; k < 4; k++) {
        SkyEntity    e = {0};
        const double px = k % 2 ? 133 : 131, wide[4] = {100, 100, k < 2 ? 100 + px : 120, k < 2 ? 120 : 100 + px};
        assert_int_equal(sky_entities_grid(&e, sky, visibility_posed(stage.visibility, 0), wide, stage.arena),
                         STATUS_OK);
        CHECK(e.of_body == !(k % 2));
    }
    /* beside the picture there is no grid */
    look_from((const double[3]){60, 20, 15}, 1000);
    open_sky(0, 0);
    const double beside[4][4] = {{-50, 10, -1, 40}, {641, 10, 660, 40}, {10, -30, 40, -1}, {10, 481, 40, 500}};
    for (int k = 0; k < 4; k++) {
        SkyEntity e = {0};
        CHECK(sky_entities_grid(&e, sky, visibility_posed(stage.visibility, 0), beside[k], stage.arena) == STATUS_OK &&
              e.columns == 0);
    }
}

/* ---- points ----------------------------------------------------------------------------------- */

/* Where a ray of the body's axes enters the brick, and through which face. */
static bool enters_brick(double p[3], double n[3], const double o[3], const double d[3])
{
    double near = -INFINITY, far = INFINITY;
    int    axis = 0;
    for (int c = 0; c < 3; c++) {
        const double a = (brick_low[c] - o[c]) / d[c], b = (brick_high[c] - o[c]) / d[c];
        if (fmin(a, b) > near) near = fmin(a, b), axis = c;
        far = fmin(far, fmax(a, b));
    }
    for (int c = 0; c < 3; c++) p[c] = o[c] + near * d[c], n[c] = c == axis ? -copysign(1, d[c]) : 0;
    return near < far && near > 0;
}

/* Whether the sphere is met on a ray towards the brick from beyond it; grazed: its facets leave that open. */
static bool hides(bool *grazed, const double o_enu[3], const double d_enu[3])
{
    double to[3];
    v3_sub(to, sphere_enu, o_enu);
    const double along = v3_dot(to, d_enu) / v3_length(d_enu), off2 = v3_dot(to, to) - along * along;
    *grazed = before && off2 > 0.98 && off2 < 1.001;
    return before && off2 < 1;
}

/* The middle of each cell of the grid, seen along it, is a point of the brick; of the picture's, through its middle.
 * Its light is that of hemisphere_change there. */
static void points_lie_on_the_brick(bool of_body)
{
    const double *r = visibility_posed(stage.visibility, 0)->r_enu_from_body,
                 *centre = visibility_posed(stage.visibility, 0)->centre_enu;
    const SkyEntity *e = &sky->entity[0];
    int              met = 0, covered = 0;
    for (int task = 0; task < sky_visibility_tasks(sky); task++) sky_visibility_task(sky, worker, task);
    CHECK(e->of_body == of_body);
    for (int spot = 0; spot < e->columns * e->rows; spot++) {
        const double at[2] = {e->low[0] + (spot % e->columns + 0.5) * e->step[0],
                              e->low[1] + (spot / e->columns + 0.5) * e->step[1]};
        double       o[3], d[3], o_enu[3], d_enu[3], p[3], n[3], p_enu[3], n_enu[3];
        if (of_body)
            for (int c = 0; c < 3; c++)
                o_enu[c] = at[0] * e->across_enu[0][c] + at[1] * e->across_enu[1][c] + 200 * e->from_enu[c],
                d_enu[c] = -e->from_enu[c];
        else {
            const double cam[3] = {(at[0] - 320) / view.focal_px, (at[1] - 240) / view.focal_px, 1};
            for (int c = 0; c < 3; c++) {
                o_enu[c] = view.p_enu[c], d_enu[c] = 0;
                for (int k = 0; k < 3; k++) d_enu[c] += view.r_enu_from_cam[3 * c + k] * cam[k];
            }
        }
        in_body(o, o_enu), in_body(d, d_enu);
        bool       grazed = false;
        const bool hit = enters_brick(p, n, o, d) && !hides(&grazed, o_enu, d_enu);
        if (grazed) continue;
        covered += !hit && enters_brick(p, n, o, d);
        const float normal[3] = {e->spot.value[SPOT_NORMAL_X][spot], e->spot.value[SPOT_NORMAL_Y][spot],
                                 e->spot.value[SPOT_NORMAL_Z][spot]};
        if (!hit) {
            CHECK(normal[0] == 0 && normal[1] == 0 && normal[2] == 0);
            continue;
        }
        for (int c = 0; c < 3; c++) {
            p_enu[c] = r[3 * c] * p[0] + r[3 * c + 1] * p[1] + r[3 * c + 2] * p[2];
            n_enu[c] = r[3 * c] * n[0] + r[3 * c + 1] * n[1] + r[3 * c + 2] * n[2];
            CHECK_NEAR(normal[c], n_enu[c], 1e-5);
            CHECK_NEAR(e->spot.value[SPOT_X + c][spot], p_enu[c] - centre[c], 1e-4);
        }
        CHECK(e->spot.value[SPOT_PART][spot] == 1);
        met++;
        if (met % 9) continue;
        static Hits          point;
        HemisphereChange     change;
        VisibilityCounters   counters = {0};
        const int            list[2] = {0, 1};
        const double         reach[2] = {50, 50};
        const uint64_t       key = (uint64_t)2 << 62 | (uint64_t)spot;
        const HemisphereNear near = {
            .bands = bands, .samples = 28, .reach_m = 50, .listed = 2, .list = list, .list_reach_m = reach};
        const HemisphereScene scene = stage_scene();
        point.count = 0;
        put_point(&point, p_enu, n_enu, 1);
        hemisphere_change(&change, &scene, &point, &near, &key, NULL, &counters);
        const double open_w_m2[2] = {
            pi_rad * (20 * 0.5 * (1 + n_enu[2]) + 0.5 * (1 - n_enu[2]) * 0.2 * (300 * 0.64 + 20 * pi_rad) / pi_rad),
            pi_rad * (20 * 0.5 * (1 + n_enu[2]) + 0.5 * (1 - n_enu[2]) * 15)};
        CHECK_NEAR(e->spot.factor[spot][AIR_R], 1 + (double)change.w_m2[AIR_R] / open_w_m2[0], 0.02);
        CHECK_NEAR(e->spot.factor[spot][AIR_LWIR], 1 + (double)change.w_m2[AIR_LWIR] / open_w_m2[1], 0.02);
        CHECK(e->spot.factor[spot][AIR_G] == 1);
        const double least = fmax(0.5 * (1 - n_enu[2]), 1.0 / 16); /* hemisphere_below */
        CHECK_NEAR(e->spot.below[spot][AIR_R],
                   1 + (double)change.below_w_m2[AIR_R] / (least * 0.2 * (300 * 0.64 + 20 * pi_rad)), 0.02);
        CHECK_NEAR(e->spot.below[spot][AIR_LWIR], 1 + (double)change.below_w_m2[AIR_LWIR] / (least * pi_rad * 15),
                   0.02);
    }
    CHECK(met > 40 && (covered > 0) == before);
}

static void points_of_both_grids(void **state)
{
    (void)state;
    for (int all = 0; all < 2; all++)
        for (int k = 0; k < 3; k++) {
            static const double level_enu[3] = {60, 3, 10};
            for (int side = 0; side < 2; side++) {
                before = side;
                look_from(side ? level_enu : eyes_enu[k], 1000);
                open_sky(0.5 * k, all ? skips_all_off : 0);
                points_lie_on_the_brick(true);
            }
            before = false;
            look_from((const double[3]){12, 9 - 7 * k, 5}, 1200);
            open_sky(0.5 * k, all ? skips_all_off : 0);
            points_lie_on_the_brick(false);
        }
}

/* ---- hits ------------------------------------------------------------------------------------- */

/* Weight of a point of a normal that leans by a cosine c from the hit's, d away and off its plane by o, of pitch p:
 * c^8 p^4 / ((p^2 / 10 + d^2) (p^2 + 16 o^2)), a twentieth of it on another part. Points one cell about the hit's, four
 * where these weigh less than 0.3, all of them (every third row of more than 16) where those weigh next to nothing. */
static double mean_on_paper(const SkyEntity *e, int band, const double p_m[3], const double n[3], int part,
                            const int span[4], int step, double *all)
{
    double sum = 0;
    *all = 0;
    for (int row = span[1]; row <= span[3]; row += step)
        for (int column = span[0]; column <= span[2]; column++) {
            const int    at = row * e->columns + column;
            double       c = 0, d2 = 0, off = 0;
            const double p2 = e->pitch_m * e->pitch_m;
            for (int k = 0; k < 3; k++) {
                const double away = (double)e->spot.value[SPOT_X + k][at] - p_m[k];
                c += n[k] * (double)e->spot.value[SPOT_NORMAL_X + k][at], d2 += away * away, off += n[k] * away;
            }
            const double w = (e->spot.value[SPOT_PART][at] == (float)part ? 1 : 0.05) * pow(fmax(c, 0), 8) * p2 * p2 /
                             ((0.1 * p2 + d2) * (p2 + 16 * off * off));
            *all += w, sum += w * (double)e->spot.factor[at][band];
        }
    return *all > 0 ? sum / *all : 1;
}

static int limited(double x, int most) { return (int)fmin(fmax(x, 0), most); }

static void hits_take_similar_points(void **state)
{
    (void)state;
    static Hits    hits;
    static SkyOpen open;
    int            wide = 0, whole = 0;
    hand_draw = 300;
    for (int round = 0; round < 6; round++) {
        look_from(round % 2 ? (const double[3]){12, 9 - 7 * round, 5} : eyes_enu[round / 2], round % 2 ? 1200 : 1000);
        open_sky(0.5 * round, 0);
        const double *r = visibility_posed(stage.visibility, 0)->r_enu_from_body,
                     *centre = visibility_posed(stage.visibility, 0)->centre_enu;
        const SkyEntity *e = &sky->entity[0];
        hits.count = 0;
        for (int i = 0; i < 60; i++) { /* on its faces, and off them; of normals that lean; of another part */
            double    p[3], n[3], p_enu[3], n_enu[3], lean[3];
            const int axis = i % 3;
            for (int c = 0; c < 3; c++) p[c] = hand_uniform(brick_low[c], brick_high[c]), n[c] = 0;
            n[axis] = i % 2 ? 1 : -1, p[axis] = i % 2 ? brick_high[axis] : brick_low[axis];
            hand_direction(lean);
            for (int c = 0; c < 3; c++) n[c] += 0.3 * (i % 4) * lean[c];
            v3_normalize(n, n);
            for (int c = 0; c < 3; c++) {
                p_enu[c] = r[3 * c] * p[0] + r[3 * c + 1] * p[1] + r[3 * c + 2] * p[2];
                n_enu[c] = r[3 * c] * n[0] + r[3 * c + 1] * n[1] + r[3 * c + 2] * n[2];
            }
            put_point(&hits, p_enu, n_enu, 1);
            hits.part[i] = (uint16_t)(1 + (i % 5 == 0));
        }
        hits.range_m[3] = INFINITY, hits.entity[4] = 2;
        /* of any light, so that each weight shows */
        for (int task = 0; task < sky_visibility_tasks(sky); task++) sky_visibility_task(sky, worker, task);
        for (int k = 0; k < e->columns * e->rows * 8; k++) {
            e->spot.factor[k / 8][k % 8] = (float)hand_uniform(0, 2);
            e->spot.below[k / 8][k % 8] = 3 - e->spot.factor[k / 8][k % 8]; /* of a mean of them, too */
        }
        CHECK(sky_visibility_open(&open, sky, worker, &hits, &(VisibilityCounters){0}));
        for (int i = 0; i < hits.count; i++) {
            double p_m[3], n[3], at[2], all = 0, want[2] = {1, 1};
            for (int c = 0; c < 3; c++) p_m[c] = hits.p_enu[c][i] - centre[c], n[c] = (double)hits.n_geo[c][i];
            const double p_enu[3] = {hits.p_enu[0][i], hits.p_enu[1][i], hits.p_enu[2][i]};
            if (e->of_body) {
                for (int k = 0; k < 2; k++) at[k] = v3_dot(p_enu, e->across_enu[k]);
            } else {
                double from[3], cam[3] = {0};
                v3_sub(from, p_enu, view.p_enu);
                for (int k = 0; k < 3; k++)
                    for (int c = 0; c < 3; c++) cam[k] += view.r_enu_from_cam[3 * c + k] * from[c];
                at[0] = 320 + view.focal_px * cam[0] / cam[2], at[1] = 240 + view.focal_px * cam[1] / cam[2];
            }
            const int column = limited(floor((at[0] - e->low[0]) / e->step[0]), e->columns - 1),
                      row = limited(floor((at[1] - e->low[1]) / e->step[1]), e->rows - 1);
            for (int more = 1; more <= 4 && !(all > 0.3); more += 3) {
                const int span[4] = {limited(column - more, e->columns - 1), limited(row - more, e->rows - 1),
                                     limited(column + more, e->columns - 1), limited(row + more, e->rows - 1)};
                for (int k = 0; k < 2; k++)
                    want[k] = mean_on_paper(e, k ? AIR_LWIR : AIR_R, p_m, n, hits.part[i], span, 1, &all);
                wide += more == 4;
            }
            if (!(all > 1e-4)) {
                const int span[4] = {0, 0, e->columns - 1, e->rows - 1};
                for (int k = 0; k < 2; k++)
                    want[k] =
                        mean_on_paper(e, k ? AIR_LWIR : AIR_R, p_m, n, hits.part[i], span, e->rows > 16 ? 3 : 1, &all);
                whole++;
            }
            if (!(all > 1e-12) || i == 3 || i == 4) want[0] = want[1] = 1;
            if (i == 3) continue; /* sky */
            if (all > 1e-12 && all < 1e-11) continue;
            CHECK_NEAR(open.factor[AIR_R][i], want[0], 2e-4);
            CHECK_NEAR(open.factor[AIR_LWIR][i], want[1], 2e-4);
            const bool none = !(all > 1e-12) || i == 4;
            CHECK(open.any_below);
            CHECK_NEAR(open.below[AIR_R][i], none ? 1 : 3 - want[0], 2e-4);
            CHECK_NEAR(open.below[AIR_LWIR][i], none ? 1 : 3 - want[1], 2e-4);
        }
    }
    print_message("%d wider, %d of the whole grid\n", wide, whole);
    CHECK(wide > 20 && whole > 20);
}

/* A point's factor is 1 + change / (E_sky + E_ground) of its tilt in the open, 0 .. 100. */
static void answers_are_over_open_light(void **state)
{
    (void)state;
    look_from(eyes_enu[0], 1000);
    open_sky(0, 0);
    hand_draw = 8;
    for (int k = 0; k < 60; k++) {
        double           n[3];
        SkyAnswer        got;
        HemisphereChange change = {.blocked = 0.25f, .sunlit = 0.5f, .inside = 0.75f};
        hand_direction(n);
        for (int b = 0; b < AIR_BAND_COUNT; b++) change.w_m2[b] = (float)hand_uniform(-80, 60);
        if (k == 0) change.w_m2[AIR_R] = -1e4f, change.w_m2[AIR_LWIR] = 1e5f;
        sky_answer(&got, sky, n, &change);
        CHECK(got.blocked == 0.25f && got.sunlit == 0.5f && got.inside == 0.75f && got.factor[AIR_G] == 1 &&
              got.factor[AIR_MWIR] == 1);
        const double e_sky = 20 * pi_rad * 0.5 * (1 + n[2]), up = 0.5 * (1 - n[2]);
        CHECK_NEAR(got.factor[AIR_R],
                   fmin(fmax(1 + (double)change.w_m2[AIR_R] / (e_sky + up * 0.2 * (300 * 0.64 + 20 * pi_rad)), 0), 100),
                   2e-5);
        CHECK_NEAR(got.factor[AIR_LWIR],
                   fmin(fmax(1 + (double)change.w_m2[AIR_LWIR] / (e_sky + up * pi_rad * 15), 0), 100), 2e-5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grids_stand_on_the_body),     cmocka_unit_test(large_bodies_have_the_pictures_grid),
        cmocka_unit_test(points_of_both_grids),        cmocka_unit_test(hits_take_similar_points),
        cmocka_unit_test(answers_are_over_open_light),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
