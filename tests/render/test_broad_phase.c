/* The tree of spheres against looking at every one: what it lists holds all that may be met, on scenes that are strewn,
 * stacked, far away, huge and without sense; and what rays meet by it is what they meet without. */
#include "tests/render/hand_models.h"

#include "render/trace/visibility/broad_phase.h"
#include "render/trace/visibility/visibility.h"

enum { most = 600, scenes = 6 };

static Arena *arena;
static int    item[most], found[most], sorted_by_hand[most];
static double sphere[most][4];

static int open_arena(void **state)
{
    (void)state;
    arena = arena_create();
    return arena ? 0 : -1;
}
static int close_arena(void **state)
{
    (void)state;
    arena_destroy(arena);
    return 0;
}

static double between(double low, double high) { return hand_uniform(low, high); }

/* Strewn, stacked in one place, all the same, on a line with one very far, of all sizes, and some that are no spheres.
 */
static int strew(int scene)
{
    const int count = scene == 4 ? 3 : most;
    for (int i = 0; i < count; i++) {
        item[i] = 7 + 3 * i;
        const double wide = scene == 1 ? 3 : 2000;
        for (int c = 0; c < 3; c++) sphere[i][c] = between(-wide, wide);
        sphere[i][3] = scene == 3 ? pow(10, between(-3, 7)) : between(0, 8);
        if (scene == 2) sphere[i][0] = i == 17 ? 9e7 : i, sphere[i][1] = sphere[i][2] = 5;
        if (scene == 0 && i % 50 == 0) sphere[i][3] = 0;
        if (scene != 5) continue;
        if (i % 7 == 0) sphere[i][i % 4] = NAN;
        if (i % 7 == 1) sphere[i][i % 3] = INFINITY;
        if (i % 7 == 2) sphere[i][3] = -1;
        if (i % 7 == 3)
            for (int c = 0; c < 4; c++) sphere[i][c] = 4;
        if (i % 7 == 4) sphere[i][3] = 1e300;
    }
    return count;
}

static bool is_sphere(int i) { return v3_is_finite(sphere[i]) && isfinite(sphere[i][3]) && sphere[i][3] >= 0; }

static BroadPhase *plant(int count)
{
    BroadPhase *tree = NULL;
    int         good = 0;
    arena_reset(arena);
    CHECK(broad_phase_create(&tree, item, (const double(*)[4])sphere, count, arena) == STATUS_OK);
    for (int i = 0; i < count; i++) good += is_sphere(i);
    CHECK(broad_phase_count(tree) == good);
    return tree;
}

static bool has(int listed, int wanted)
{
    for (int k = 0; k < listed; k++)
        if (found[k] == wanted) return true;
    return false;
}

/* Ascending, each once, none that is no sphere. */
static void check_list(int listed, int count)
{
    for (int k = 0; k < listed; k++) {
        CHECK(k == 0 || found[k - 1] < found[k]);
        CHECK(found[k] >= 7 && (found[k] - 7) % 3 == 0 && (found[k] - 7) / 3 < count && is_sphere((found[k] - 7) / 3));
    }
}

static void volumes_lose_nothing(void **state)
{
    (void)state;
    int left_out = 0;
    for (int scene = 0; scene < scenes; scene++) {
        const int         count = strew(scene);
        const BroadPhase *tree = plant(count);
        for (int n = 0; n < 40; n++) {
            double plane[5][4], low[3], high[3], d[3], centre[3];
            for (int p = 0; p < 5; p++) {
                hand_direction(plane[p]);
                plane[p][3] = between(-1500, 300);
            }
            int listed = broad_phase_in_planes(found, tree, (const double(*)[4])plane, n % 6);
            check_list(listed, count);
            left_out += count - listed;
            for (int i = 0; i < count; i++) {
                bool within = is_sphere(i);
                for (int p = 0; p < n % 6; p++) within &= v3_dot(plane[p], sphere[i]) + sphere[i][3] >= plane[p][3];
                if (within) CHECK(has(listed, item[i]));
            }
            for (int c = 0; c < 3; c++) {
                low[c] = between(-1000, 1000);
                high[c] = low[c] + between(0, 300);
                centre[c] = between(-1000, 1000);
            }
            const double more_m = between(0, 50), radius_m = between(0, 20);
            listed = broad_phase_near_box(found, tree, low, high, more_m);
            check_list(listed, count);
            for (int i = 0; i < count; i++) {
                double square = 0;
                for (int c = 0; c < 3; c++) {
                    const double out = fmax(fmax(low[c] - sphere[i][c], sphere[i][c] - high[c]), 0);
                    square += out * out;
                }
                if (is_sphere(i) && sqrt(square) <= sphere[i][3] + more_m) CHECK(has(listed, item[i]));
            }
            hand_direction(d);
            listed = broad_phase_swept(found, most, tree, centre, radius_m, d);
            CHECK(listed >= 0 &&
                  (listed == 0 || broad_phase_swept(sorted_by_hand, listed - 1, tree, centre, radius_m, d) == -1));
            for (int i = 0; i < count; i++) {
                double m[3], across[3];
                if (!is_sphere(i)) continue;
                v3_sub(m, sphere[i], centre);
                const double along = v3_dot(m, d), reach_m = sphere[i][3] + radius_m;
                v3_add_scaled(across, m, -along, d);
                if (along >= 0 && v3_length(across) <= reach_m) CHECK(has(listed, item[i]));
            }
        }
    }
    CHECK(left_out > 10000); /* and it is of use */
}

typedef struct Visits {
    BroadRays *rays;
    int        count;
    bool       stops; /* at the first that is visited */
} Visits;

static void note_visit(void *user, int at)
{
    Visits *v = user;
    found[v->count++] = at;
    for (int k = 0; k < broad_packet && v->stops; k++) v->rays->limit_m[k] = -1;
}

static void rays_lose_nothing(void **state)
{
    (void)state;
    for (int scene = 0; scene < scenes; scene++) {
        const int         count = strew(scene);
        const BroadPhase *tree = plant(count);
        for (int n = 0; n < 60; n++) {
            BroadRays rays;
            Visits    visits = {.rays = &rays};
            const int used = 1 + n % broad_packet;
            for (int k = 0; k < broad_packet; k++) {
                double d[3];
                hand_direction(d);
                if (n % 5 == 0) d[0] = 1, d[1] = d[2] = 0; /* along the slabs */
                for (int c = 0; c < 3; c++) {
                    rays.o[c][k] = between(-1500, 1500);
                    rays.d[c][k] = d[c];
                }
                if (n % 10 == 0) rays.o[1][k] = rays.o[2][k] = 5;
                rays.limit_m[k] = k >= used ? -1 : n % 3 ? INFINITY : between(0, 2000);
                if (n == 31 && k == 0) rays.o[0][k] = NAN;
                if (n == 32 && k == 0) rays.d[2][k] = NAN;
            }
            broad_phase_rays(tree, &rays, note_visit, &visits);
            for (int i = 0; i < count; i++)
                for (int k = 0; k < used && is_sphere(i); k++) {
                    const double o[3] = {rays.o[0][k], rays.o[1][k], rays.o[2][k]},
                                 d[3] = {rays.d[0][k], rays.d[1][k], rays.d[2][k]};
                    double m[3], across[3];
                    v3_sub(m, sphere[i], o);
                    const double along = v3_dot(m, d), r = sphere[i][3];
                    v3_add_scaled(across, m, -along, d);
                    const double left = r * r - v3_dot(across, across);
                    if (!(left >= 0) || along + sqrt(left) < 0) continue;
                    if (fmax(along - sqrt(left), 0) <= rays.limit_m[k]) CHECK(has(visits.count, item[i]));
                }
            visits.count = 0, visits.stops = true; /* who wants nothing more is asked no more */
            for (int k = 0; k < used; k++) rays.limit_m[k] = INFINITY;
            broad_phase_rays(tree, &rays, note_visit, &visits);
            CHECK(visits.count <= 1);
        }
    }
}

/* The inner ball of a sphere: a third of it, off its middle. */
static double inner(double centre[3], int i)
{
    for (int c = 0; c < 3; c++) centre[c] = sphere[i][c] + (c - 1) * 0.4 * sphere[i][3];
    return sphere[i][3] / 3;
}

typedef struct Items {
    int count, odd; /* odd: only these have boxes of their own */
} Items;

static bool box_of_inner(void *user, int at, double low[3], double high[3])
{
    const Items *items = user;
    double       centre[3];
    int          i = 0;
    while (i < items->count && item[i] != at) i++;
    if (i == items->count || i % 2 != items->odd) return false;
    const double r = inner(centre, i);
    for (int c = 0; c < 3; c++) low[c] = centre[c] - r, high[c] = centre[c] + r;
    return true;
}

/* With boxes of their own: rays that meet an inner ball still come to its item, and many others no more. */
static void closer_boxes_lose_nothing_in_them(void **state)
{
    (void)state;
    static const double grown_m = 7;
    uint64_t            visited[2] = {0}, met = 0, near = 0;
    for (int scene = 0; scene < scenes; scene++) {
        const int   count = strew(scene);
        BroadPhase *tree = plant(count);
        Items       items = {count, scene % 2};
        for (int tight = 0; tight < 2; tight++) {
            if (tight) broad_phase_tighten(tree, box_of_inner, &items);
            for (int n = 0; n < 40; n++) {
                BroadRays rays;
                Visits    visits = {.rays = &rays};
                hand_draw = (uint64_t)(100 * n + 1); /* the same rays again: close together, past one of the spheres */
                const double *at = sphere[n * 37 % count];
                double        o[3], d[3];
                for (int c = 0; c < 3; c++) o[c] = between(-1500, 1500), d[c] = at[c] + between(-8, 8) - o[c];
                if (!v3_normalize(d, d)) continue;
                for (int k = 0; k < broad_packet; k++) {
                    for (int c = 0; c < 3; c++) rays.o[c][k] = o[c] + 0.01 * k, rays.d[c][k] = d[c];
                    rays.limit_m[k] = INFINITY;
                }
                broad_phase_rays(tree, &rays, note_visit, &visits);
                if (scene != 3 && scene != 5)
                    visited[tight] += (uint64_t)visits.count; /* those have giants, which all meet */
                for (int i = 0; i < count; i++)
                    for (int k = 0; k < broad_packet && is_sphere(i); k++) {
                        const double from[3] = {rays.o[0][k], rays.o[1][k], rays.o[2][k]};
                        double       centre[3], m[3], across[3];
                        const double r = inner(centre, i);
                        v3_sub(m, centre, from);
                        const double along = v3_dot(m, d);
                        v3_add_scaled(across, m, -along, d);
                        if (!(along >= 0 && v3_dot(across, across) <= r * r && r < 1e100)) continue;
                        met++;
                        CHECK(has(visits.count, item[i]));
                    }
                visits.count = 0;
                broad_phase_rays_near(tree, &rays, grown_m, note_visit, &visits);
                for (int i = 0; i < count; i++) { /* by the whole spheres and more, whatever boxes there are */
                    double m[3], across[3];
                    v3_sub(m, sphere[i], o);
                    const double along = v3_dot(m, d), r = sphere[i][3] + grown_m;
                    v3_add_scaled(across, m, -along, d);
                    if (!is_sphere(i) || !(along >= 0 && v3_dot(across, across) <= r * r && r < 1e100)) continue;
                    near++;
                    CHECK(has(visits.count, item[i]));
                }
            }
        }
    }
    print_message("closer boxes: %llu visits instead of %llu\n", (unsigned long long)visited[1],
                  (unsigned long long)visited[0]);
    CHECK(met > 100 && near > 100);
    CHECK(visited[1] < visited[0] - visited[0] / 8); /* half of the items have boxes of a ninth of the area */
}

static void nothing_and_one(void **state)
{
    (void)state;
    BroadRays         rays = {.d = {{1}}, .limit_m = {INFINITY}};
    Visits            visits = {.rays = &rays};
    const BroadPhase *tree = plant(0);
    for (int k = 1; k < broad_packet; k++) rays.limit_m[k] = -1;
    CHECK(broad_phase_in_planes(found, tree, NULL, 0) == 0);
    CHECK(broad_phase_near_box(found, tree, (const double[3]){-1, -1, -1}, (const double[3]){1, 1, 1}, 1e9) == 0);
    broad_phase_rays(tree, &rays, note_visit, &visits);
    CHECK(visits.count == 0);
    sphere[0][0] = 10, sphere[0][1] = 1, sphere[0][2] = 0, sphere[0][3] = 1; /* it touches the ray */
    item[0] = 42;
    tree = plant(1);
    CHECK(broad_phase_in_planes(found, tree, NULL, 0) == 1 && found[0] == 42);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < broad_packet; k++) rays.d[c][k] = c == 0;
    rays.limit_m[0] = 9; /* begins at the limit, not strictly beyond */
    broad_phase_rays(tree, &rays, note_visit, &visits);
    CHECK(visits.count == 1);
    visits.count = 0, rays.limit_m[0] = 8.99;
    broad_phase_rays(tree, &rays, note_visit, &visits);
    CHECK(visits.count == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_lose_nothing),
        cmocka_unit_test(rays_lose_nothing),
        cmocka_unit_test(closer_boxes_lose_nothing_in_them),
        cmocka_unit_test(nothing_and_one),
    };
    return cmocka_run_group_tests(tests, open_arena, close_arena);
}
