/* The height-field tracer against planes, against every triangle of small fields asked one by one, against
 * itself without the pyramid, and eight rays against one. */
#include "tests/check.h"

#include "render/trace/ground/ground.h"

enum { random_rays = 100000 };

static uint64_t draw_count;

static double uniform(double low, double high)
{
    return low + (high - low) * random_uniform(20240611, 7, 0, draw_count++);
}

static void aim(double d[3], const double from[3], const double to[3])
{
    v3_sub(d, to, from);
    if (!v3_normalize(d, d)) d[0] = 0, d[1] = 0, d[2] = -1;
}

static void normals_at(double n_geo[3], double n_enu[3], const Ground *ground, const GroundHit *hit, double x_m,
                       double y_m)
{
    static const int first = 0;
    double           geo[3][ground_normals_lanes], enu[3][ground_normals_lanes];
    ground_normals(geo, enu, ground, hit, &first, 1, &x_m, &y_m);
    for (int c = 0; c < 3; c++) n_geo[c] = geo[c][0], n_enu[c] = enu[c][0];
}

static void make_level(Elevation *e, int index, int nx, int ny, double x0_m, double y0_m, double spacing_m, double z0_m,
                       double step_m)
{
    assert_int_equal(elevation_level_create(e, index, &(ElevationGrid){nx, ny, x0_m, y0_m, spacing_m, z0_m, step_m}),
                     STATUS_OK);
}

static void make_rough(Elevation *e, int index, int highest)
{
    ElevationLevel *level = &e->level[index];
    for (int n = 0; n < level->nx * level->ny; n++)
        elevation_set_post(level, n % level->nx, n / level->nx, (uint16_t)uniform(0, highest));
}

/* 33 x 29 posts, 3 m apart, 0 .. 20 m high: steeper than any country. */
static void make_field(Elevation *e)
{
    memset(e, 0, sizeof *e);
    make_level(e, 0, 33, 29, -40, 17, 3, -5, 0.01);
    make_rough(e, 0, 2000);
    elevation_build_pyramids(e);
}

/* ---- every triangle, one by one ------------------------------------------------------------ */

typedef struct Soup {
    int count;
    double (*corner)[3][3];
} Soup;

static void soup_add(Soup *soup, const double a[3], const double b[3], const double c[3])
{
    memcpy(soup->corner[soup->count][0], a, 3 * sizeof *a);
    memcpy(soup->corner[soup->count][1], b, 3 * sizeof *b);
    memcpy(soup->corner[soup->count][2], c, 3 * sizeof *c);
    soup->count++;
}

static void post_at(double p[3], const ElevationLevel *e, int i, int j)
{
    p[0] = e->x0_m + i * e->spacing_m;
    p[1] = e->y0_m + j * e->spacing_m;
    p[2] = elevation_post_m(e, i, j);
}

static void soup_wall(Soup *soup, const double a[3], const double b[3])
{
    const double low_a[3] = {a[0], a[1], -1000}, low_b[3] = {b[0], b[1], -1000};
    soup_add(soup, a, b, low_a);
    soup_add(soup, low_a, b, low_b);
}

/* The surface of one level and the walls under its outline: the solid that the tracer promises. */
static Soup soup_of(const ElevationLevel *e)
{
    Soup soup = {.corner = calloc((size_t)(2 * e->nx * e->ny + 8 * (e->nx + e->ny)), sizeof *soup.corner)};
    assert_non_null(soup.corner);
    for (int j = 0; j + 1 < e->ny; j++)
        for (int i = 0; i + 1 < e->nx; i++) {
            double sw[3], se[3], nw[3], ne[3];
            post_at(sw, e, i, j);
            post_at(se, e, i + 1, j);
            post_at(nw, e, i, j + 1);
            post_at(ne, e, i + 1, j + 1);
            soup_add(&soup, sw, se, ne);
            soup_add(&soup, sw, ne, nw);
            if (i == 0) soup_wall(&soup, sw, nw);
            if (i + 2 == e->nx) soup_wall(&soup, se, ne);
            if (j == 0) soup_wall(&soup, sw, se);
            if (j + 2 == e->ny) soup_wall(&soup, nw, ne);
        }
    return soup;
}

static double soup_first_hit(const Soup *soup, const double o[3], const double d[3])
{
    double best_m = INFINITY;
    for (int n = 0; n < soup->count; n++) {
        double ab[3], ac[3], ao[3], p[3], q[3];
        v3_sub(ab, soup->corner[n][1], soup->corner[n][0]);
        v3_sub(ac, soup->corner[n][2], soup->corner[n][0]);
        v3_sub(ao, o, soup->corner[n][0]);
        v3_cross(p, d, ac);
        v3_cross(q, ao, ab);
        const double det = v3_dot(ab, p);
        if (!(fabs(det) > 1e-14)) continue;
        const double b = v3_dot(ao, p) / det, c = v3_dot(d, q) / det, t = v3_dot(ac, q) / det;
        if (b >= -1e-12 && c >= -1e-12 && b + c <= 1 + 1e-12 && t >= 0 && t < best_m) best_m = t;
    }
    return best_m;
}

/* Height of a ray over the ground at t. */
static double clearance(const Elevation *e, const double o[3], const double d[3], double t)
{
    return o[2] + t * d[2] - elevation_height(e, o[0] + t * d[0], o[1] + t * d[1], NULL);
}

/* A ray that is never under the ground's rules at its start: above the surface, or beside the field. kind
 * chooses the nastiness. */
static void field_ray(double o[3], double d[3], const Elevation *e, int kind)
{
    const ElevationLevel *level = &e->level[0];
    double                to[3];
    const int             i = (int)uniform(0, level->nx), j = (int)uniform(0, level->ny);
    post_at(to, level, i, j);
    for (;;) {
        o[0] = uniform(-60, 80), o[1] = uniform(0, 120), o[2] = uniform(-8, 40);
        const double ground = elevation_height(e, o[0], o[1], NULL);
        if (isnan(ground) || o[2] > ground + 1e-3) break;
    }
    switch (kind) {
    case 0: /* anywhere */
        for (int c = 0; c < 3; c++) to[c] = o[c] + uniform(-1, 1);
        break;
    case 1: /* grazing */
        to[0] = o[0] + uniform(-1, 1), to[1] = o[1] + uniform(-1, 1), to[2] = o[2] + uniform(-0.05, 0.05);
        break;
    case 2: /* at a post; those on the outline have no other side to tell touching from meeting */
        post_at(to, level, i > 0 && i + 1 < level->nx ? i : 5, j > 0 && j + 1 < level->ny ? j : 5);
        break;
    case 3: /* straight down on a post, or beside it */
        if (i % 2) o[0] = to[0], o[1] = to[1];
        else to[0] = o[0], to[1] = o[1];
        o[2] = 40, to[2] = 0;
        break;
    case 4: /* along a line of posts, or a diagonal */
        o[2] = 30;
        o[0] = to[0], o[1] = to[1];
        to[0] += j % 3 == 0 ? 0 : i % 2 ? 1 : -1;
        to[1] += j % 3 == 1 ? 0 : i % 2 ? 1 : -1;
        to[2] = 30 - uniform(0, 2);
        break;
    default: /* parallel to an axis */
        to[0] = o[0], to[1] = o[1], to[2] = o[2];
        to[j % 2] += i % 2 ? 1 : -1;
        break;
    }
    aim(d, o, to);
}

static void same_as_every_triangle(void **state)
{
    (void)state;
    Elevation e;
    make_field(&e);
    Ground ground;
    ground_prepare(&ground, &e);
    Soup soup = soup_of(&e.level[0]);
    int  hits = 0;
    for (int n = 0; n < random_rays; n++) {
        double    o[3], d[3];
        GroundHit hit;
        field_ray(o, d, &e, n % 6);
        const double got = ground_first_hit(&hit, &ground, o, d, INFINITY), want = soup_first_hit(&soup, o, d);
        hits += got < INFINITY;
        if (got == want) continue; /* both miss, at the latest */
        if (fabs(got - want) <= 1e-9) continue;
        /* to touch a post or an edge and go on is not to go through: rounding may call it either way */
        const double first = fmin(got, want);
        if (!(fabs(clearance(&e, o, d, first)) <= 1e-9 && clearance(&e, o, d, first + 1e-6) >= -1e-9))
            fail_msg("ray %d from %.17g %.17g %.17g along %.17g %.17g %.17g: %.17g, every triangle: %.17g", n, o[0],
                     o[1], o[2], d[0], d[1], d[2], got, want);
        CHECK(n % 6 >= 2 && n % 6 <= 4); /* only those that were aimed so */
    }
    CHECK(hits > random_rays / 4);
    free(soup.corner);
    elevation_destroy(&e);
}

/* ---- planes --------------------------------------------------------------------------------- */

static void planes_are_met_where_paper_says(void **state)
{
    (void)state;
    static const int rise[4][2] = {{0, 0}, {7, 0}, {3, 5}, {-4, 6}};
    for (int p = 0; p < 4; p++) {
        Elevation e = {0};
        make_level(&e, 0, 301, 401, -3000, -4000, 20, 100, 1.0 / 64);
        for (int j = 0; j < 401; j++)
            for (int i = 0; i < 301; i++)
                elevation_set_post(&e.level[0], i, j, (uint16_t)(20000 + rise[p][0] * i + rise[p][1] * j));
        elevation_build_pyramids(&e);
        Ground ground;
        ground_prepare(&ground, &e);
        /* z = a + b x + c y */
        const double b = rise[p][0] / 64.0 / 20, c = rise[p][1] / 64.0 / 20;
        const double a = 100 + 20000 / 64.0 + b * 3000 + c * 4000;
        for (int n = 0; n < 5000; n++) {
            double       o[3] = {uniform(-2000, 2000), uniform(-3000, 3000), 0}, d[3], n_geo[3], n_enu[3];
            const double to[3] = {uniform(-2900, 2900), uniform(-3900, 3900), 0};
            o[2] = a + b * o[0] + c * o[1] + exp(uniform(0, 9));
            const double goal[3] = {to[0], to[1], a + b * to[0] + c * to[1]};
            GroundHit    hit = {0};
            aim(d, o, goal);
            const double want = (a + b * o[0] + c * o[1] - o[2]) / (d[2] - b * d[0] - c * d[1]);
            const double got = ground_first_hit(&hit, &ground, o, d, INFINITY);
            /* 1e-12 m of rounding in z at these sizes, over the sine of the grazing angle */
            CHECK_NEAR(got, want, 2e-12 * (1 + 1 / fabs(d[2] - b * d[0] - c * d[1])) + 1e-12 * want);
            normals_at(n_geo, n_enu, &ground, &hit, o[0] + got * d[0], o[1] + got * d[1]);
            const double s = 1 / sqrt(1 + b * b + c * c), normal[3] = {-b * s, -c * s, s};
            for (int k = 0; k < 3; k++) {
                CHECK_NEAR(n_geo[k], normal[k], 1e-12);
                CHECK_NEAR(n_enu[k], normal[k], 1e-12);
            }
        }
        elevation_destroy(&e);
    }
}

/* The surface that is met is the one elevation_height tells of. */
static void hits_lie_on_the_surface(void **state)
{
    (void)state;
    Elevation e;
    make_field(&e);
    Ground ground;
    ground_prepare(&ground, &e);
    for (int n = 0; n < random_rays; n++) {
        const double to[3] = {uniform(-39, 55), uniform(18, 100), uniform(-5, 10)};
        double       o[3] = {uniform(-39, 55), uniform(18, 100), uniform(16, 60)}, d[3], n_geo[3], n_enu[3], normal[3];
        GroundHit    hit;
        aim(d, o, to);
        const double t = ground_first_hit(&hit, &ground, o, d, INFINITY);
        if (!(t < INFINITY)) continue;
        const double x = o[0] + t * d[0], y = o[1] + t * d[1];
        CHECK_NEAR(o[2] + t * d[2], elevation_height(&e, x, y, normal), 1e-11);
        normals_at(n_geo, n_enu, &ground, &hit, x, y);
        CHECK_NEAR(v3_dot(n_enu, n_enu), 1, 1e-12);
        CHECK(v3_dot(n_geo, d) < 0);
        /* on the line between two triangles either normal is right */
        const ElevationLevel *l = &e.level[0];
        const double          a = (x - l->x0_m) / 3 - hit.i, b = (y - l->y0_m) / 3 - hit.j;
        if (fabs(a - b) < 1e-9 || a < 1e-9 || b < 1e-9 || a > 1 - 1e-9 || b > 1 - 1e-9) continue;
        for (int c = 0; c < 3; c++) CHECK_NEAR(n_geo[c], normal[c], 1e-9);
    }
    elevation_destroy(&e);
}

/* ---- levels --------------------------------------------------------------------------------- */

/* Three levels; with seams that meet, or with levels that know nothing of each other. */
static void make_levels(Elevation *e, bool meet)
{
    memset(e, 0, sizeof *e);
    make_level(e, 0, 25, 33, -8, -16, 1, -8, 1.0 / 128);
    make_level(e, 1, 33, 29, -64, -48, 4, -8, 1.0 / 128);
    make_level(e, 2, 31, 28, -256, -208, 16, -8, 1.0 / 128);
    for (int k = 0; k < 3; k++) make_rough(e, k, 512 << k);
    for (int k = 2; meet && k >= 0; k--) {
        /* an edge post is so many quarters of the way between two posts outside: a whole number, if those are
         * multiples of 16, and of 4 one level further in */
        ElevationLevel *in = &e->level[k];
        const int       unit = k == 2 ? 16 : k == 1 ? 4 : 1;
        for (int j = 0; j < in->ny; j++)
            for (int i = 0; i < in->nx; i++) elevation_set_post(in, i, j, elevation_post(in, i, j) / unit * unit);
        if (k == 2) continue;
        const Elevation outer = {.level_count = 1, .level = {e->level[k + 1]}};
        for (int j = 0; j < in->ny; j++)
            for (int i = 0; i < in->nx; i++) {
                if (i > 0 && j > 0 && i + 1 < in->nx && j + 1 < in->ny) continue;
                const double x = in->x0_m + i * in->spacing_m, y = in->y0_m + j * in->spacing_m;
                const double z = elevation_height(&outer, x, y, NULL);
                elevation_set_post(in, i, j, (uint16_t)((z - in->z0_m) / in->step_m));
            }
    }
    elevation_build_pyramids(e);
}

/* A ray from above the ground to below it meets it on the way, whatever it crosses; and where it does, it is on
 * the surface, or at a step between levels. */
static void nothing_leaks(bool meet)
{
    Elevation e;
    make_levels(&e, meet);
    Ground ground;
    ground_prepare(&ground, &e);
    int on_surface = 0;
    for (int n = 0; n < random_rays; n++) {
        const double reach = n % 3 == 0 ? 30 : n % 3 == 1 ? 90 : 220;
        double       o[3] = {uniform(-reach, reach), uniform(-reach, reach) * 0.7, 0}, d[3];
        double       to[3] = {uniform(-reach, reach), uniform(-reach, reach) * 0.7, 0}, span[3];
        if (n % 5 == 0) { /* across a corner of level 0, or down its outline */
            to[0] = n % 2 ? -8 : 16, to[1] = n % 4 < 2 ? -16 : 16;
            if (n % 7 == 0) o[0] = to[0];
        }
        o[2] = elevation_height(&e, o[0], o[1], NULL) + exp(uniform(-5, 4));
        to[2] = elevation_height(&e, to[0], to[1], NULL) - exp(uniform(-10, 2));
        if (!meet) to[2] = fmin(to[2], n % 5 == 0 ? -9 : INFINITY); /* on an outline: below both surfaces */
        aim(d, o, to);
        v3_sub(span, to, o);
        GroundHit    hit = {0};
        const double t = ground_first_hit(&hit, &ground, o, d, INFINITY);
        if (!(t <= v3_length(span)))
            fail_msg("leak: from %.17g %.17g %.17g to %.17g %.17g %.17g", o[0], o[1], o[2], to[0], to[1], to[2]);
        /* it was never under the ground before */
        for (int s = 0; s < 8; s++) CHECK(clearance(&e, o, d, t * uniform(0, 1)) > -1e-9);
        on_surface += fabs(clearance(&e, o, d, t)) < 1e-6;
    }
    if (meet) assert_int_equal(on_surface, random_rays);
    else CHECK(on_surface > random_rays * 0.9);
    elevation_destroy(&e);
}

static void matched_levels_do_not_leak(void **state)
{
    (void)state;
    nothing_leaks(true);
}

static void unmatched_levels_do_not_leak(void **state)
{
    (void)state;
    nothing_leaks(false);
}

static void solid_ground_stops_a_ray_at_once(void **state)
{
    (void)state;
    Elevation e;
    make_levels(&e, true);
    Ground ground;
    ground_prepare(&ground, &e);
    GroundHit hit;
    CHECK(ground_first_hit(&hit, &ground, (double[3]){3, 4, -100}, (double[3]){0, 0, 1}, INFINITY) == 0);
    CHECK(ground_first_hit(&hit, &ground, (double[3]){3, 4, -100}, (double[3]){0, 0, -1}, INFINITY) == 0);
    CHECK(ground_first_hit(&hit, &ground, (double[3]){100, 4, -9}, (double[3]){1, 0, 0}, INFINITY) == 0);
    /* from beside the outermost level, in through its side */
    CHECK_NEAR(ground_first_hit(&hit, &ground, (double[3]){-300, 10, -9}, (double[3]){1, 0, 0}, INFINITY), 44, 1e-12);
    /* and past it */
    CHECK(isinf(ground_first_hit(&hit, &ground, (double[3]){-300, 10, 99}, (double[3]){1, 0, 0}, INFINITY)));
    CHECK(isinf(ground_first_hit(&hit, &ground, (double[3]){-300, 10, 0}, (double[3]){-1, 0, 0}, INFINITY)));
    ground_prepare(&ground, NULL);
    CHECK(isinf(ground_first_hit(&hit, &ground, (double[3]){0, 0, 0}, (double[3]){0, 0, -1}, INFINITY)));
    elevation_destroy(&e);
}

/* ---- the same bits -------------------------------------------------------------------------- */

typedef struct List {
    int        count;
    double    *o[3], *d[3], *far_m, *range_m;
    GroundHit *hit;
} List;

static List list_create(int count)
{
    List list = {.count = count,
                 .far_m = calloc((size_t)count, sizeof(double)),
                 .range_m = calloc((size_t)count, sizeof(double)),
                 .hit = calloc((size_t)count, sizeof *list.hit)};
    for (int c = 0; c < 3; c++) {
        list.o[c] = calloc((size_t)count, sizeof(double));
        list.d[c] = calloc((size_t)count, sizeof(double));
    }
    return list;
}

static void list_destroy(List *list)
{
    for (int c = 0; c < 3; c++) {
        free(list->o[c]);
        free(list->d[c]);
    }
    free(list->far_m);
    free(list->range_m);
    free(list->hit);
}

static void list_set(List *list, int n, const double o[3], const double d[3], double far_m)
{
    for (int c = 0; c < 3; c++) {
        list->o[c][n] = o[c];
        list->d[c][n] = d[c];
    }
    list->far_m[n] = far_m;
}

static double one_of(const double *choice, int count) { return choice[(int)uniform(0, count)]; }

/* Ordinary rays, and numbers no ray should have. */
static void fill_with_everything(List *list)
{
    static const double place[] = {0,      -0.0,    1,   -8,   16,   -16, 64,   -64,   4,
                                   1e-300, -1e-300, 1e9, -1e9, 1e12, 0.5, -256, 5e-324};
    static const double along[] = {
        0, -0.0, 1, -1, 1e-300, -1e-300, 1e-31, -1e-31, 1e-17, -1e-9, 0.6, -0.8, 0.70710678118654757};
    static const double wrong[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308};
    for (int n = 0; n < list->count; n++) {
        double o[3], d[3], far_m = INFINITY;
        for (int c = 0; c < 3; c++) o[c] = uniform(-1, 1) * (c == 2 ? 40 : n % 2 ? 30 : 250);
        for (int c = 0; c < 3; c++) d[c] = uniform(-1, 1) * (c == 2 ? 0.3 : 1);
        if (n % 4 == 1)
            for (int c = 0; c < 3; c++) o[c] = one_of(place, 17);
        if (n % 8 >= 5)
            for (int c = 0; c < 3; c++) d[c] = one_of(along, 13);
        if (n % 16 == 7) o[2] = 30, d[0] = one_of(along, 8) * 1e-3, d[1] = one_of(along, 8) * 1e-3, d[2] = -1;
        v3_normalize(d, d);
        if (n % 5 == 0) far_m = one_of((const double[]){0, -1, 1, 10, 30, 100, NAN, 1e300}, 8);
        if (n % 37 == 0) o[n % 3] = one_of(wrong, 5);
        if (n % 41 == 0) d[n % 3] = one_of(wrong, 5);
        list_set(list, n, o, d, far_m);
    }
}

static bool same_hit(const List *a, int at_a, const List *b, int at_b)
{
    if (memcmp(&a->range_m[at_a], &b->range_m[at_b], sizeof(double))) return false;
    if (!(a->range_m[at_a] < INFINITY)) return true;
    const GroundHit *p = &a->hit[at_a], *q = &b->hit[at_b];
    return p->level == q->level && p->i == q->i && p->j == q->j && p->north_west == q->north_west;
}

static void trace_one_by_one(List *list, const Ground *ground)
{
    for (int n = 0; n < list->count; n++) {
        const double o[3] = {list->o[0][n], list->o[1][n], list->o[2][n]};
        const double d[3] = {list->d[0][n], list->d[1][n], list->d[2][n]};
        list->range_m[n] = ground_first_hit(&list->hit[n], ground, o, d, list->far_m[n]);
    }
}

static void trace_by_eights(List *list, const Ground *ground, int first, int count)
{
    const double *const o[3] = {list->o[0] + first, list->o[1] + first, list->o[2] + first};
    const double *const d[3] = {list->d[0] + first, list->d[1] + first, list->d[2] + first};
    ground_first_hits(list->range_m + first, list->hit + first, ground, count, o, d, list->far_m + first);
}

static void copy_ray(List *to, int n, const List *from, int m)
{
    list_set(to, n, (double[3]){from->o[0][m], from->o[1][m], from->o[2][m]},
             (double[3]){from->d[0][m], from->d[1][m], from->d[2][m]}, from->far_m[m]);
}

static void eight_give_the_bits_of_one(void **state)
{
    (void)state;
    Elevation e;
    make_levels(&e, true);
    Ground ground;
    ground_prepare(&ground, &e);
    List one = list_create(2 * random_rays), eight = list_create(2 * random_rays);
    fill_with_everything(&one);
    trace_one_by_one(&one, &ground);
    int hits = 0;
    for (int n = 0; n < one.count; n++) hits += one.range_m[n] < INFINITY;
    CHECK(hits > one.count / 5 && hits < one.count * 9 / 10);

    /* all at once; in handfuls of every size from 0; backwards */
    for (int n = 0; n < one.count; n++) copy_ray(&eight, n, &one, n);
    trace_by_eights(&eight, &ground, 0, eight.count);
    for (int n = 0; n < one.count; n++) CHECK(same_hit(&one, n, &eight, n));
    memset(eight.range_m, 0, (size_t)eight.count * sizeof(double));
    for (int first = 0, size = 0; first < eight.count; first += size, size = (size + 1) % 23)
        trace_by_eights(&eight, &ground, first, first + size <= eight.count ? size : eight.count - first);
    for (int n = 0; n < one.count; n++) CHECK(same_hit(&one, n, &eight, n));
    for (int n = 0; n < one.count; n++) copy_ray(&eight, n, &one, one.count - 1 - n);
    trace_by_eights(&eight, &ground, 0, eight.count);
    for (int n = 0; n < one.count; n++) CHECK(same_hit(&one, one.count - 1 - n, &eight, n));
    list_destroy(&one);
    list_destroy(&eight);
    elevation_destroy(&e);
}

/* Every node of the pyramid as high as can be: nothing is skipped, and not a bit changes. */
static void skipping_changes_no_bit(void **state)
{
    (void)state;
    Elevation e;
    make_levels(&e, true);
    Ground ground;
    ground_prepare(&ground, &e);
    List skip = list_create(random_rays), all = list_create(random_rays);
    fill_with_everything(&skip);
    for (int n = 0; n < skip.count; n++) copy_ray(&all, n, &skip, n);
    trace_one_by_one(&skip, &ground);
    for (int k = 0; k < e.level_count; k++)
        for (int p = elevation_pyramid_first; p < e.level[k].pyramid_count; p++)
            memset(e.level[k].pyramid[p], 0xff,
                   (size_t)e.level[k].pyramid_nx[p] * (size_t)e.level[k].pyramid_ny[p] * sizeof(uint16_t));
    ground_prepare(&ground, &e);
    trace_one_by_one(&all, &ground);
    for (int n = 0; n < skip.count; n++) CHECK(same_hit(&skip, n, &all, n));
    trace_by_eights(&all, &ground, 0, all.count);
    for (int n = 0; n < skip.count; n++) CHECK(same_hit(&skip, n, &all, n));
    list_destroy(&skip);
    list_destroy(&all);
    elevation_destroy(&e);
}

static void far_cuts_and_changes_nothing_else(void **state)
{
    (void)state;
    Elevation e;
    make_levels(&e, true);
    Ground ground;
    ground_prepare(&ground, &e);
    for (int n = 0; n < random_rays / 4; n++) {
        const double o[3] = {uniform(-200, 200), uniform(-150, 150), 30};
        const double to[3] = {uniform(-200, 200), uniform(-150, 150), -4};
        double       d[3];
        aim(d, o, to);
        const double t = ground_first_hit(NULL, &ground, o, d, INFINITY);
        if (!(t < INFINITY)) continue;
        CHECK(ground_first_hit(NULL, &ground, o, d, nextafter(t, INFINITY)) == t);
        CHECK(ground_first_hit(NULL, &ground, o, d, t * 1.5) == t);
        CHECK(isinf(ground_first_hit(NULL, &ground, o, d, t)));
    }
    elevation_destroy(&e);
}

/* Grid numbers so large that doubles grow coarse: a seeker in orbit still meets the right place. */
static void far_origins_stay_close(void **state)
{
    (void)state;
    Elevation e;
    make_field(&e);
    Ground ground;
    ground_prepare(&ground, &e);
    for (int n = 0; n < 2000; n++) {
        const double to[3] = {uniform(-20, 30), uniform(35, 80), -5};
        double       d[3] = {uniform(-0.5, 0.5), uniform(-0.5, 0.5), -1}, o[3];
        v3_normalize(d, d);
        v3_add_scaled(o, to, -1e8, d);
        GroundHit    hit;
        const double t = ground_first_hit(&hit, &ground, o, d, INFINITY);
        CHECK(t < 1e8 + 1 && t > 1e8 - 60);
        CHECK_NEAR(clearance(&e, o, d, t), 0, 1e-5);
    }
    elevation_destroy(&e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(planes_are_met_where_paper_says),   cmocka_unit_test(same_as_every_triangle),
        cmocka_unit_test(hits_lie_on_the_surface),           cmocka_unit_test(matched_levels_do_not_leak),
        cmocka_unit_test(unmatched_levels_do_not_leak),      cmocka_unit_test(solid_ground_stops_a_ray_at_once),
        cmocka_unit_test(eight_give_the_bits_of_one),        cmocka_unit_test(skipping_changes_no_bit),
        cmocka_unit_test(far_cuts_and_changes_nothing_else), cmocka_unit_test(far_origins_stay_close),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
