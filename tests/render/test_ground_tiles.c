/* Ground in tiles of different bases and shifts: the same posts stored otherwise give the same bits, and heights over
 * kilometres are those of every triangle, for one ray, eight at a time, and rays together. */
#include "tests/check.h"

#include "render/trace/ground/ground.h"

#include <stdlib.h>

enum { nx = 150, ny = 139, rays = 2048 };

static uint64_t draws;

static double uniform(double low, double high) { return low + (high - low) * random_uniform(20261122, 5, 0, draws++); }

static int pick(int count) { return (int)uniform(0, count); }

static struct {
    double    o[3][rays], d[3][rays], far_m[rays], range_m[3][rays];
    GroundHit hit[3][rays];
} batch;

/* ---- ground --------------------------------------------------------------------------------- */

/* Every tile has a range and a height of its own: from 1 m to 2 km, with walls of up to 500 m where tiles meet. */
static int32_t ragged(int i, int j)
{
    const int ti = i / elevation_tile_cells, tj = j / elevation_tile_cells, of = ti + 3 * tj;
    return (int32_t)(uniform(0, 1) * (1 << (9 + (5 * of) % 12))) + 512 * (250 * ((ti + tj) % 3) - 1000 * (ti == 1));
}

static int32_t walls(int i, int j) /* 500 m from one post to the next, across the edges of tiles too */
{
    return 256000 * ((i / 32 + j / 64) % 2) + (i > 100 ? 3 : 0) * i * j;
}

typedef int32_t Shape(int i, int j);

static void make_ground(Elevation *e, Shape *shape, double spacing_m)
{
    int32_t *post = malloc((size_t)nx * ny * sizeof *post);
    CHECK(post);
    *e = (Elevation){0};
    CHECK(elevation_level_create(
              e, 0, &(ElevationGrid){nx, ny, -0.5 * nx * spacing_m, -0.5 * ny * spacing_m, spacing_m, 0, 1.0 / 512}) ==
          STATUS_OK);
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) post[j * nx + i] = shape(i, j);
    CHECK(elevation_fill(&e->level[0], post) == STATUS_OK);
    elevation_build_pyramids(e);
    free(post);
    const ElevationLevel *l = &e->level[0];
    int                   shifts = 0;
    for (int t = 0; t < l->tiles_x * l->tiles_y; t++) shifts |= 1 << l->tile[t].shift;
    CHECK(!l->plain && (shifts & (shifts - 1)) != 0); /* more than one */
}

static void post_at(double p[3], const ElevationLevel *l, int i, int j)
{
    p[0] = l->x0_m + i * l->spacing_m;
    p[1] = l->y0_m + j * l->spacing_m;
    p[2] = elevation_post_m(l, i, j);
}

/* ---- rays ----------------------------------------------------------------------------------- */

/* From above the ground to below it: anywhere, at posts, along the edges of tiles, straight down; or one eye's. */
static void fill_rays(const Elevation *e, bool one_eye)
{
    const ElevationLevel *l = &e->level[0];
    const double          wide = l->spacing_m * (nx - 1), tall = l->spacing_m * (ny - 1);
    double                eye[3] = {l->x0_m + uniform(0.4, 0.6) * wide, l->y0_m + uniform(0.4, 0.6) * tall, 0};
    eye[2] = elevation_height(e, eye[0], eye[1], NULL) + exp(uniform(0, 7));
    for (int n = 0; n < rays; n++) {
        double o[3] = {l->x0_m + uniform(0, 1) * wide, l->y0_m + uniform(0, 1) * tall, 0}, to[3], d[3];
        post_at(to, l, pick(nx), pick(ny));
        if (n % 4 == 0) post_at(to, l, elevation_tile_cells * pick(3), pick(ny));
        if (n % 4 == 1) to[0] += uniform(0, 1) * l->spacing_m * (to[0] < l->x0_m + 0.9 * wide);
        if (one_eye) { /* as a tile of a picture: not far apart, and within what is swept */
            const double yaw_rad = n / 1024 + uniform(-0.2, 0.2), away = uniform(0.05, 0.5) * fmin(wide, tall);
            to[0] = eye[0] + away * sin(yaw_rad), to[1] = eye[1] + away * cos(yaw_rad);
        }
        if (n % 8 == 2) o[0] = to[0];
        if (n % 16 == 3) o[0] = to[0], o[1] = to[1];
        o[2] = elevation_height(e, o[0], o[1], NULL) + exp(uniform(-3, 7));
        const double below = elevation_height(e, to[0], to[1], NULL);
        if (isfinite(below)) to[2] = below - exp(uniform(-8, 5));
        v3_sub(d, to, one_eye ? eye : o);
        if (!v3_normalize(d, d)) d[0] = d[1] = 0, d[2] = -1;
        for (int c = 0; c < 3; c++) batch.o[c][n] = one_eye ? eye[c] : o[c], batch.d[c][n] = d[c];
        batch.far_m[n] = n % 7 ? INFINITY : exp(uniform(0, 8));
    }
}

/* One by one, by eights, together. */
static void trace(const Elevation *e)
{
    Ground ground;
    ground_prepare(&ground, e);
    const double *const o[3] = {batch.o[0], batch.o[1], batch.o[2]}, *const d[3] = {batch.d[0], batch.d[1], batch.d[2]};
    memset(batch.hit, 0, sizeof batch.hit);
    for (int n = 0; n < rays; n++)
        batch.range_m[0][n] = ground_first_hit(&batch.hit[0][n], &ground, (double[3]){o[0][n], o[1][n], o[2][n]},
                                               (double[3]){d[0][n], d[1][n], d[2][n]}, batch.far_m[n]);
    ground_first_hits(batch.range_m[1], batch.hit[1], &ground, rays, o, d, batch.far_m);
    ground_first_hits_together(batch.range_m[2], batch.hit[2], &ground, rays, o, d, batch.far_m);
    for (int k = 1; k < 3; k++)
        for (int n = 0; n < rays; n++) {
            const GroundHit *p = &batch.hit[0][n], *q = &batch.hit[k][n];
            if (memcmp(&batch.range_m[0][n], &batch.range_m[k][n], sizeof(double)))
                fail_msg("ray %d: %.17g, way %d: %.17g", n, batch.range_m[0][n], k, batch.range_m[k][n]);
            if (!(batch.range_m[0][n] < INFINITY)) continue;
            CHECK(p->level == q->level && p->i == q->i && p->j == q->j && p->north_west == q->north_west);
        }
}

/* ---- the first of every triangle ------------------------------------------------------------ */

static long double triangle_hit(const double a[3], const double b[3], const double c[3], const double o[3],
                                const double d[3])
{
    long double ab[3], ac[3], ao[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = (long double)b[k] - a[k];
        ac[k] = (long double)c[k] - a[k];
        ao[k] = (long double)o[k] - a[k];
    }
    const long double p[3] = {d[1] * ac[2] - d[2] * ac[1], d[2] * ac[0] - d[0] * ac[2], d[0] * ac[1] - d[1] * ac[0]};
    const long double q[3] = {ao[1] * ab[2] - ao[2] * ab[1], ao[2] * ab[0] - ao[0] * ab[2],
                              ao[0] * ab[1] - ao[1] * ab[0]};
    const long double det = ab[0] * p[0] + ab[1] * p[1] + ab[2] * p[2];
    if (!(fabsl(det) > 1e-18L)) return INFINITY;
    const long double u = (ao[0] * p[0] + ao[1] * p[1] + ao[2] * p[2]) / det;
    const long double v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / det;
    const long double t = (ac[0] * q[0] + ac[1] * q[1] + ac[2] * q[2]) / det;
    return u >= -1e-12L && v >= -1e-12L && u + v <= 1 + 1e-12L && t >= 0 ? t : (long double)INFINITY;
}

static double every_triangle(const ElevationLevel *l, const double o[3], const double d[3])
{
    long double first = INFINITY;
    for (int j = 0; j + 1 < ny; j++)
        for (int i = 0; i + 1 < nx; i++) {
            double sw[3], se[3], nw[3], ne[3];
            /* the track does not come near the cell */
            const double x = l->x0_m + (i + 0.5) * l->spacing_m - o[0], y = l->y0_m + (j + 0.5) * l->spacing_m - o[1];
            if (fabs(x * d[1] - y * d[0]) > l->spacing_m * (fabs(d[0]) + fabs(d[1]))) continue;
            post_at(sw, l, i, j);
            post_at(se, l, i + 1, j);
            post_at(nw, l, i, j + 1);
            post_at(ne, l, i + 1, j + 1);
            first = fminl(first, fminl(triangle_hit(sw, se, ne, o, d), triangle_hit(sw, ne, nw, o, d)));
        }
    return (double)first;
}

static double clearance(const Elevation *e, const double o[3], const double d[3], double t)
{
    return o[2] + t * d[2] - elevation_height(e, o[0] + t * d[0], o[1] + t * d[1], NULL);
}

static void ragged_ground_is_every_triangle(void **state)
{
    (void)state;
    static const double spacing_m[3] = {1, 0.1, 100};
    for (int kind = 0; kind < 12; kind++) {
        Elevation e;
        int       hits = 0, touched = 0;
        make_ground(&e, kind < 6 ? ragged : walls, spacing_m[kind % 3]);
        fill_rays(&e, kind % 2);
        trace(&e);
        for (int n = 0; n < rays; n++) {
            const double o[3] = {batch.o[0][n], batch.o[1][n], batch.o[2][n]};
            const double d[3] = {batch.d[0][n], batch.d[1][n], batch.d[2][n]}, got = batch.range_m[0][n];
            if (batch.far_m[n] < INFINITY || n % 8 > 2) continue;
            const double want = every_triangle(&e.level[0], o, d);
            hits += got < INFINITY;
            if (got == want || fabs(got - want) <= 1e-9 + 1e-12 * want) continue;
            /* a post or an edge that is touched, on walls of 1000 : 1 */
            const double first = fmin(got, want), steep = 1e-7 / spacing_m[kind % 3];
            if (!(fabs(clearance(&e, o, d, first)) <= steep && clearance(&e, o, d, first + 1e-6) >= -steep))
                fail_msg("kind %d, ray %d: %.17g, every triangle: %.17g", kind, n, got, want);
            touched++;
        }
        CHECK(hits > rays / 5 && touched < rays / 50);
        elevation_destroy(&e);
    }
}

/* ---- the same posts, stored otherwise ------------------------------------------------------- */

static void another_base_and_shift_is_the_same_ground(void **state)
{
    (void)state;
    static double plain_m[3][rays];
    Elevation     plain = {0}, tiled = {0};
    Elevation    *both[2] = {&plain, &tiled};
    for (int k = 0; k < 2; k++)
        CHECK(elevation_level_create(both[k], 0, &(ElevationGrid){nx, ny, -75, -70, 1, -100, 1.0 / 128}) == STATUS_OK);
    ElevationLevel *l = &tiled.level[0];
    l->plain = false;
    for (int t = 0; t < l->tiles_x * l->tiles_y; t++)
        l->tile[t] = (ElevationTile){elevation_base_unit * (t % 4 - 2), t % 5};
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            const int32_t post = 16 * (int32_t)uniform(200, 1000 + 50 * (i / 10));
            for (int k = 0; k < 2; k++) elevation_set_post(&both[k]->level[0], i, j, post);
            CHECK(elevation_post(l, i, j) == post);
        }
    for (int k = 0; k < 2; k++) elevation_build_pyramids(both[k]);
    for (int one_eye = 0; one_eye < 2; one_eye++) {
        fill_rays(&plain, one_eye);
        trace(&plain);
        memcpy(plain_m, batch.range_m, sizeof plain_m);
        trace(&tiled);
        assert_memory_equal(plain_m, batch.range_m, sizeof plain_m);
        /* and nothing skipped */
        for (int k = elevation_pyramid_first; k < l->pyramid_count; k++)
            memset(l->pyramid[k], 0xff, (size_t)(l->pyramid_nx[k] * l->pyramid_ny[k]) * sizeof(uint16_t));
        trace(&tiled);
        assert_memory_equal(plain_m, batch.range_m, sizeof plain_m);
        elevation_build_pyramids(&tiled);
    }
    for (int n = 0; n < 2000; n++) {
        const double x = uniform(-75, 74), y = uniform(-70, 68);
        double       a[3], b[3];
        CHECK(elevation_height(&plain, x, y, a) == elevation_height(&tiled, x, y, b));
        assert_memory_equal(a, b, sizeof a);
    }
    for (int k = 0; k < 2; k++) elevation_destroy(both[k]);
}

/* Rays between boxes that are said to be clear meet nothing; most that pass high above are said to be. */
static void clear_is_clear_over_tiles(void **state)
{
    (void)state;
    Elevation e;
    Ground    ground;
    int       clear = 0;
    make_ground(&e, ragged, 1);
    ground_prepare(&ground, &e);
    for (int n = 0; n < 3000; n++) {
        double from[2][3], to[2][3], o[3], d[3];
        for (int c = 0; c < 3; c++) {
            from[0][c] = c < 2 ? uniform(-60, 60) : uniform(-2000, 4000), from[1][c] = from[0][c] + uniform(0, 2);
            to[0][c] = c < 2 ? uniform(-60, 60) : uniform(-2000, 4000), to[1][c] = to[0][c] + uniform(0, 2);
            o[c] = uniform(from[0][c], from[1][c]);
            d[c] = uniform(to[0][c], to[1][c]) - o[c];
        }
        if (!ground_is_clear(&ground, from, to)) continue;
        clear++;
        const double length_m = v3_length(d);
        v3_normalize(d, d);
        CHECK(isinf(ground_first_hit(NULL, &ground, o, d, length_m)));
    }
    CHECK(clear > 300);
    elevation_destroy(&e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ragged_ground_is_every_triangle),
        cmocka_unit_test(another_base_and_shift_is_the_same_ground),
        cmocka_unit_test(clear_is_clear_over_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
