/* Rays that keep together against the same rays eight by eight: not a bit may differ, whatever the country and wherever
 * the eye. Of this the second knows neither strips nor groups (tests/render/test_ground.c judges it). Normals of four
 * hits at a time likewise against those of one, post by post. labels: physics slow */
#include "tests/check.h"

#include "render/trace/ground/ground.h"
#include "render/scene/view.h"

enum { tile = 1024 };

static uint64_t draw_count;

static double uniform(double low, double high)
{
    return low + (high - low) * random_uniform(20241121, 3, 0, draw_count++);
}

static int pick_of(int count) { return (int)uniform(0, count); }

typedef struct Batch {
    int       count;
    double    o[3][tile], d[3][tile], far_m[tile], range_m[tile], plain_m[tile];
    GroundHit hit[tile], plain_hit[tile];
} Batch;

static Batch batch;

/* ---- normals, post by post -------------------------------------------------------------------- */

static void slope_at(double slope[2], const ElevationLevel *e, double scale, int i, int j)
{
    const int west = i > 0 ? i - 1 : i, east = i < e->nx - 1 ? i + 1 : i;
    const int south = j > 0 ? j - 1 : j, north = j < e->ny - 1 ? j + 1 : j;
    slope[0] = (elevation_post(e, east, j) - elevation_post(e, west, j)) * scale / (east - west);
    slope[1] = (elevation_post(e, i, north) - elevation_post(e, i, south)) * scale / (north - south);
}

static void upward(double n[3], double slope_x, double slope_y)
{
    const double s = 1 / sqrt(slope_x * slope_x + slope_y * slope_y + 1);
    n[0] = -slope_x * s, n[1] = -slope_y * s, n[2] = s;
}

static void normals_at(double n_geo[3], double n_enu[3], const Ground *ground, const GroundHit *hit, double x_m,
                       double y_m)
{
    const GroundLevel    *g = &ground->level[hit->level];
    const ElevationLevel *e = &ground->elevation->level[hit->level];
    const double          scale = g->cells_per_m / g->posts_per_m;
    const int             i = hit->i, j = hit->j, sw = elevation_post(e, i, j), se = elevation_post(e, i + 1, j),
              nw = elevation_post(e, i, j + 1), ne = elevation_post(e, i + 1, j + 1);
    if (hit->north_west) upward(n_geo, (ne - nw) * scale, (nw - sw) * scale);
    else upward(n_geo, (se - sw) * scale, (ne - se) * scale);
    const double a = clamp((x_m - g->x0_m) * g->cells_per_m - i, 0, 1),
                 b = clamp((y_m - g->y0_m) * g->cells_per_m - j, 0, 1);
    const double low = a < b ? a : b, high = a < b ? b : a;
    double       at[3][2], slope[2];
    slope_at(at[0], e, scale, i, j);
    slope_at(at[1], e, scale, i + 1, j + 1);
    slope_at(at[2], e, scale, i + !hit->north_west, j + hit->north_west);
    for (int c = 0; c < 2; c++) slope[c] = (1 - high) * at[0][c] + low * at[1][c] + (high - low) * at[2][c];
    upward(n_enu, slope[0], slope[1]);
}

/* Those of the batch's hits, in fours from one of the first on. */
static void compare_normals(const Ground *ground, const char *what)
{
    static double x_m[tile], y_m[tile];
    static int    list[tile];
    int           count = 0;
    for (int n = 0; n < batch.count; n++) {
        x_m[n] = batch.o[0][n] + batch.plain_m[n] * batch.d[0][n],
        y_m[n] = batch.o[1][n] + batch.plain_m[n] * batch.d[1][n];
        if (batch.plain_m[n] < INFINITY) list[count++] = n;
    }
    for (int first = 0, some; first < count; first += some) {
        double n_geo[3][ground_normals_lanes], n_enu[3][ground_normals_lanes];
        some = first ? ground_normals_lanes : 1 + count % ground_normals_lanes;
        if (some > count - first) some = count - first;
        ground_normals(n_geo, n_enu, ground, batch.plain_hit, list + first, some, x_m, y_m);
        for (int k = 0; k < some; k++) {
            const int n = list[first + k];
            double    geo[3], enu[3];
            normals_at(geo, enu, ground, &batch.plain_hit[n], x_m[n], y_m[n]);
            for (int c = 0; c < 3; c++)
                if (memcmp(&geo[c], &n_geo[c][k], sizeof geo[c]) || memcmp(&enu[c], &n_enu[c][k], sizeof enu[c]))
                    fail_msg("%s: normals of hit %d, axis %d: %.17g %.17g, plain %.17g %.17g", what, n, c, n_geo[c][k],
                             n_enu[c][k], geo[c], enu[c]);
        }
    }
}

/* Traces the batch both ways; returns how many met something. */
static int compare_as_bent(const Ground *ground, const char *what)
{
    const double *const o[3] = {batch.o[0], batch.o[1], batch.o[2]}, *const d[3] = {batch.d[0], batch.d[1], batch.d[2]};
    int hits = 0;
    memset(batch.range_m, 0xee, sizeof batch.range_m);
    ground_first_hits(batch.plain_m, batch.plain_hit, ground, batch.count, o, d, batch.far_m);
    ground_first_hits_together(batch.range_m, batch.hit, ground, batch.count, o, d, batch.far_m);
    for (int n = 0; n < batch.count; n++) {
        const GroundHit *a = &batch.hit[n], *b = &batch.plain_hit[n];
        const bool       met = batch.plain_m[n] < INFINITY;
        hits += met;
        if (!memcmp(&batch.range_m[n], &batch.plain_m[n], sizeof(double)) &&
            (!met || (a->level == b->level && a->i == b->i && a->j == b->j && a->north_west == b->north_west)))
            continue;
        fail_msg("%s: ray %d of %d from %.17g %.17g %.17g along %.17g %.17g %.17g, far %g: %.17g, plain %.17g", what, n,
                 batch.count, o[0][n], o[1][n], o[2][n], d[0][n], d[1][n], d[2][n], batch.far_m[n], batch.range_m[n],
                 batch.plain_m[n]);
    }
    compare_normals(ground, what);
    return hits;
}

/* Straight, and bent as much as over 100 m of these small countries shows: up to 10 m in 100 m, of air 1e-8. */
static int compare(const Ground *ground, const char *what)
{
    static const double per_m[] = {1e-8, 1e-6, 1e-5, 1e-4, 1e-3};
    Ground              bent = *ground;
    bent.bend_per_m = per_m[pick_of(5)];
    const int hits = compare_as_bent(ground, what);
    compare_as_bent(&bent, what);
    return hits;
}

/* ---- countries ------------------------------------------------------------------------------ */

static double hills(double x_m, double y_m)
{
    return 40 * sin(x_m / 61) * cos(y_m / 47) + 9 * sin(x_m / 7.3 + y_m / 11.1) + 120;
}

static double canyon(double x_m, double y_m)
{
    const double across = fabs(fmod(fabs(x_m + 0.3 * y_m), 70) - 35);
    return across < 9 ? 10 + 0.1 * fabs(y_m) : 190 + sin(y_m / 3);
}

static double spikes(double x_m, double y_m) /* of one post, on a plain; and one hole */
{
    const long i = lround(x_m), j = lround(y_m);
    return i % 23 == 0 && j % 19 == 0 ? 240 : i % 31 == 5 && j % 29 == 7 ? 0 : 100;
}

static double steps(double x_m, double y_m) /* cliffs along posts and diagonals */
{
    return 60 * floor(fabs(fmod(x_m, 64)) / 32) + 30 * floor(fabs(fmod(x_m - y_m, 48)) / 24) + 0.01 * y_m;
}

static double downs(double x_m, double y_m) /* so gentle that a sun of 30 degrees outruns most; with a few walls */
{
    return 60 + 15 * sin(x_m / 91) + 8 * cos(y_m / 53) + (fabs(x_m - 30) < 2 && y_m > 0 ? 12 : 0) +
           (fabs(y_m + 0.5 * x_m) < 3 ? 5 : 0);
}

static double plain(double x_m, double y_m) { return -10 + 0.002 * x_m + 0.003 * y_m; }

static double noise(double x_m, double y_m)
{
    return random_uniform(5, 0, (uint32_t)(int)(10 * x_m), (uint64_t)(int64_t)(10 * y_m)) * 200;
}

typedef double Country(double x_m, double y_m);

static void add_level(Elevation *e, int index, int nx, int ny, double x0_m, double y0_m, double spacing_m,
                      Country *country)
{
    assert_int_equal(elevation_level_create(e, index, &(ElevationGrid){nx, ny, x0_m, y0_m, spacing_m, -20, 1.0 / 128}),
                     STATUS_OK);
    ElevationLevel *level = &e->level[index];
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++)
            elevation_set_post(
                level, i, j,
                (uint16_t)clamp(128 * (country(x0_m + i * spacing_m, y0_m + j * spacing_m) + 20), 0, 65535));
}

/* One level; three that meet only nearly; two of which the inner lies on the outer's edge; a country on a plain below
 * it. */
static void make_country(Elevation *e, Country *country, int kind)
{
    memset(e, 0, sizeof *e);
    if (kind == 0) add_level(e, 0, 700, 500, -350, -250, 1, country);
    if (kind == 1) {
        add_level(e, 0, 161, 241, -80, -120, 1, country);
        add_level(e, 1, 101, 121, -200, -240, 4, country);
        add_level(e, 2, 61, 71, -480, -560, 16, country);
    }
    if (kind == 2) {
        add_level(e, 0, 201, 161, -200, -80, 1, country);
        add_level(e, 1, 101, 91, -200, -180, 4, country);
    }
    if (kind == 3) {
        add_level(e, 0, 161, 241, -80, -120, 1, country);
        add_level(e, 1, 101, 121, -200, -240, 4, plain);
    }
    elevation_build_pyramids(e);
}

/* ---- eyes ----------------------------------------------------------------------------------- */

static void turn(double r_enu_from_cam[9], double yaw_rad, double pitch_rad, double roll_rad)
{
    const double ahead[3] = {sin(yaw_rad) * cos(pitch_rad), cos(yaw_rad) * cos(pitch_rad), sin(pitch_rad)};
    const double right[3] = {cos(yaw_rad), -sin(yaw_rad), 0};
    double       down[3];
    v3_cross(down, ahead, right);
    for (int c = 0; c < 3; c++) {
        r_enu_from_cam[3 * c] = right[c] * cos(roll_rad) + down[c] * sin(roll_rad);
        r_enu_from_cam[3 * c + 1] = down[c] * cos(roll_rad) - right[c] * sin(roll_rad);
        r_enu_from_cam[3 * c + 2] = ahead[c];
    }
}

static void random_view(View *view, const Elevation *e)
{
    static const double quarter[4] = {0, 0.5, 1, 1.5};
    const double        reach = pick_of(8) == 0 ? 900 : 300;
    view->width = 32 + pick_of(800), view->height = 32 + pick_of(600);
    view->p_enu[0] = uniform(-reach, reach);
    view->p_enu[1] = uniform(-reach, reach);
    if (pick_of(10) == 0) view->p_enu[pick_of(2)] = pick_of(9) * 40 - 160; /* on a line of posts, on an outline */
    const double ground = elevation_height(e, view->p_enu[0], view->p_enu[1], NULL);
    view->p_enu[2] = (isnan(ground) ? 100 : ground) + (pick_of(12) == 0 ? -uniform(0, 50) : exp(uniform(-6, 8)));
    double yaw_rad = uniform(0, 2 * pi_rad), pitch_rad = uniform(-0.6, 0.1), roll_rad = uniform(-0.5, 0.5);
    switch (pick_of(8)) {
    case 0:
        pitch_rad = -pi_rad / 2;
        break;
    case 1:
        pitch_rad = pi_rad / 2;
        break;
    case 2:
        pitch_rad = uniform(-pi_rad / 2, pi_rad / 2);
        break;
    case 3:
        yaw_rad = quarter[pick_of(4)] * pi_rad;
        break;
    case 4:
        roll_rad = uniform(-pi_rad, pi_rad);
        break;
    default:
        break;
    }
    view->focal_px = view_focal_px(view->width, exp(uniform(log(0.01), log(120))) * rad_per_deg);
    turn(view->r_enu_from_cam, yaw_rad, pitch_rad, pick_of(3) ? roll_rad : 0);
    view->lens = (Lens){0};
    if (pick_of(16) == 0) { /* whose columns and rows are no planes */
        const double half[2] = {0.5 * view->width / view->focal_px, 0.5 * view->height / view->focal_px}, p[2] = {0, 0};
        const double r2 = half[0] * half[0] + half[1] * half[1], k[3] = {uniform(-0.1, 0.2) / r2, 0.02 / (r2 * r2), 0};
        assert_int_equal(view_lens_make(&view->lens, k, p, half), STATUS_OK);
    }
}

/* A tile of the view, or pixels here and there. */
static void fill_from_eye(const View *view)
{
    const bool tiled = pick_of(4) > 0;
    const int  x0 = pick_of(view->width - 31), y0 = pick_of(view->height - 31), side = tiled ? 32 : 1 + pick_of(31);
    batch.count = tiled ? 32 * 32 : pick_of(tile + 1);
    for (int n = 0; n < batch.count; n++) {
        double       d[3];
        const double x = x0 + (tiled ? n % side + 0.5 : uniform(0, side));
        const double y = y0 + (tiled ? n / side + 0.5 : uniform(0, side));
        view_ray(d, view, x, y);
        for (int c = 0; c < 3; c++) batch.o[c][n] = view->p_enu[c], batch.d[c][n] = d[c];
        batch.far_m[n] = pick_of(6) ? INFINITY : exp(uniform(0, 7));
    }
}

/* From the hits of the batch towards the sun, or anything else far away. */
static void fill_from_hits(const Ground *ground, const double sun_enu[3])
{
    int count = 0;
    for (int n = 0; n < batch.count; n++) {
        if (!(batch.plain_m[n] < INFINITY)) continue;
        double p[3], n_geo[3], n_enu[3];
        for (int c = 0; c < 3; c++) p[c] = batch.o[c][n] + batch.plain_m[n] * batch.d[c][n];
        normals_at(n_geo, n_enu, ground, &batch.plain_hit[n], p[0], p[1]);
        for (int c = 0; c < 3; c++) batch.o[c][count] = p[c] + 1e-3 * n_geo[c], batch.d[c][count] = sun_enu[c];
        batch.far_m[count++] = INFINITY;
    }
    batch.count = count;
}

static void every_view(Country *country, const char *name, int views)
{
    int rays = 0, hits = 0, dark = 0, sun_rays = 0;
    for (int kind = 0; kind < 4; kind++) {
        Elevation e;
        Ground    ground;
        make_country(&e, country, kind);
        ground_prepare(&ground, &e);
        for (int n = 0; n < views; n++) {
            View view;
            random_view(&view, &e);
            for (int t = 0; t < 3; t++) {
                fill_from_eye(&view);
                rays += batch.count;
                hits += compare(&ground, name);
                double       sun_enu[3];
                const double elevation_rad = pick_of(6) ? uniform(0, pi_rad / 2) : uniform(-0.3, 0);
                const double azimuth_rad = uniform(0, 2 * pi_rad);
                sun_enu[0] = cos(elevation_rad) * sin(azimuth_rad), sun_enu[1] = cos(elevation_rad) * cos(azimuth_rad);
                sun_enu[2] = sin(elevation_rad);
                if (pick_of(9) == 0) sun_enu[0] = sun_enu[1] = 0, sun_enu[2] = 1;
                fill_from_hits(&ground, sun_enu);
                sun_rays += batch.count;
                dark += compare(&ground, name);
            }
        }
        elevation_destroy(&e);
    }
    /* none of it was idle */
    CHECK(hits > rays / 8 && hits < rays * 19 / 20);
    CHECK(dark > sun_rays / 50 && dark < sun_rays * 19 / 20);
}

static void hills_are_the_same(void **state)
{
    (void)state;
    every_view(hills, "hills", 120);
}
static void canyons_are_the_same(void **state)
{
    (void)state;
    every_view(canyon, "canyon", 120);
}
static void spikes_are_the_same(void **state)
{
    (void)state;
    every_view(spikes, "spikes", 120);
}
static void cliffs_are_the_same(void **state)
{
    (void)state;
    every_view(steps, "cliffs", 120);
}
static void downs_are_the_same(void **state)
{
    (void)state;
    every_view(downs, "downs", 120);
}
static void noise_is_the_same(void **state)
{
    (void)state;
    every_view(noise, "noise", 120);
}

/* Rays no camera makes: of one eye or one direction, with numbers among them that no ray should have. */
static void odd_rays_are_the_same(void **state)
{
    (void)state;
    static const double odd[] = {0,      -0.0, 1,        -1,        1e-300, 1e-31, -1e-31, 1e-9,
                                 -1e-12, NAN,  INFINITY, -INFINITY, 1e308,  3,     5e-324};
    static const double place[] = {0, -0.0, -80, 80, 161, 1e9, -1e9, 1e12, 1e-300, 1e6, NAN, INFINITY, 0.5, 16};
    for (int n = 0; n < 2000; n++) {
        static Elevation e;
        static Ground    ground;
        if (n % 500 == 0) {
            elevation_destroy(&e);
            make_country(&e, hills, n / 500 % 3);
            ground_prepare(&ground, &e);
        }
        double eye[3] = {uniform(-300, 300), uniform(-300, 300), uniform(0, 300)};
        double way[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-0.5, 0.3)};
        if (n % 3 == 0) eye[pick_of(3)] = place[pick_of(14)];
        if (n % 5 == 0) way[pick_of(3)] = odd[pick_of(15)];
        if (n % 7 == 0) way[pick_of(2)] = odd[pick_of(9)];
        v3_normalize(way, way);
        batch.count = pick_of(5) ? 1024 : pick_of(1025);
        const double wide = exp(uniform(-9, 0));
        for (int k = 0; k < batch.count; k++) {
            double d[3], o[3];
            for (int c = 0; c < 3; c++) {
                o[c] = eye[c] + (n % 2 ? uniform(-200, 200) : 0);
                d[c] = way[c] + (n % 2 ? 0 : uniform(-wide, wide));
            }
            if (n % 2 == 0) v3_normalize(d, d);
            if (n % 4 == 0 && pick_of(50) == 0) d[pick_of(3)] = odd[pick_of(15)];
            if (n % 4 == 1 && pick_of(50) == 0) o[pick_of(3)] = place[pick_of(14)];
            for (int c = 0; c < 3; c++) batch.o[c][k] = o[c], batch.d[c][k] = d[c];
            batch.far_m[k] = pick_of(9) ? INFINITY : odd[pick_of(15)];
        }
        compare(&ground, "odd");
        if (n == 1999) elevation_destroy(&e);
    }
}

/* More than one helping at once, and none. */
static void any_count_is_the_same(void **state)
{
    (void)state;
    Elevation e;
    Ground    ground;
    make_country(&e, hills, 0);
    ground_prepare(&ground, &e);
    for (batch.count = 0; batch.count < 70; batch.count++) {
        for (int n = 0; n < batch.count; n++) {
            double d[3] = {0.01 * n - 0.3, 1, -0.2};
            v3_normalize(d, d);
            for (int c = 0; c < 3; c++) batch.o[c][n] = c == 2 ? 250 : 3, batch.d[c][n] = d[c];
            batch.far_m[n] = INFINITY;
        }
        compare(&ground, "count");
    }
    enum { many = 2500 };
    static double o[3][many], d[3][many], far_m[many], range_m[2][many];
    for (int n = 0; n < many; n++) {
        double way[3] = {0.0002 * n, 1, -0.1 - 0.0001 * n};
        v3_normalize(way, way);
        for (int c = 0; c < 3; c++) o[c][n] = c == 2 ? 200 : -5, d[c][n] = way[c];
        far_m[n] = INFINITY;
    }
    const double *const op[3] = {o[0], o[1], o[2]}, *const dp[3] = {d[0], d[1], d[2]};
    ground_first_hits(range_m[0], NULL, &ground, many, op, dp, far_m);
    ground_first_hits_together(range_m[1], NULL, &ground, many, op, dp, far_m);
    assert_memory_equal(range_m[0], range_m[1], sizeof range_m[0]);
    ground_prepare(&ground, NULL);
    ground_first_hits_together(range_m[1], NULL, &ground, many, op, dp, far_m);
    for (int n = 0; n < many; n++) CHECK(isinf(range_m[1][n]));
    elevation_destroy(&e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hills_are_the_same),    cmocka_unit_test(canyons_are_the_same),
        cmocka_unit_test(spikes_are_the_same),   cmocka_unit_test(cliffs_are_the_same),
        cmocka_unit_test(downs_are_the_same),    cmocka_unit_test(noise_is_the_same),
        cmocka_unit_test(odd_rays_are_the_same), cmocka_unit_test(any_count_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
