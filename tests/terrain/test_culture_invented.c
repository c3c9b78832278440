/* Invented culture: houses are where the cover draws them, nothing overlaps, nothing stands on a slope, a road or in
 * water; the same from any thread and any square. labels: threads */
#include "tests/terrain/culture_lab.h"

#include <stdlib.h>

/* ---- plots --------------------------------------------------------------------------------------- */

/* Every house of a plot is there, but for a few on slopes and on each other; its corners are those of the rectangle
 * that the cover draws as built, which is tried just inside and, where nothing else is built, just outside of them. */
static void plots_have_their_houses(void **state)
{
    (void)state;
    int       plots, missing = 0, wrong = 0, inside = 0, outside = 0, heated = 0, houses = 0, steep = 0;
    Landscape land;
    make(&land, 5, 3000, NULL);
    Culture          c = invent(&land, 0, 0, 4000);
    const HousePlot *plot = landscape_plots(&land, &plots);
    for (int n = 0; n < plots; n++) {
        const HousePlot *p = &plot[n];
        const double     x = p->x_m + p->house[0] * p->direction[0] - p->house[1] * p->direction[1];
        const double     y = p->y_m + p->house[0] * p->direction[1] + p->house[1] * p->direction[0];
        const Building  *b = building_at(&c, x, y);
        if (!b) {
            missing++;
            continue;
        }
        houses++, heated += b->heated;
        CHECK(b->corners == 4 && b->id != 0 && (b->use == BUILDING_HOUSE || b->use == BUILDING_FLATS));
        const double pitch = atan2((double)(b->ridge_m - b->eaves_m), fmin(p->house_half[0], p->house_half[1]));
        steep += b->roof != ROOF_FLAT && (pitch < 29 * rad_per_deg || pitch > 65 * rad_per_deg);
        for (int k = 0; k < 4; k++) {
            const double *corner = c.corner_m[b->first_corner + k], dx = corner[0] - x, dy = corner[1] - y;
            wrong += fabs(fabs(dx * p->direction[0] + dy * p->direction[1]) - p->house_half[0]) > 0.1 ||
                     fabs(fabs(dy * p->direction[0] - dx * p->direction[1]) - p->house_half[1]) > 0.1;
            inside += landscape_surface(&land, x + 0.99 * dx, y + 0.99 * dy) == SURFACE_BUILT;
            outside += landscape_surface(&land, x + 1.02 * dx, y + 1.02 * dy) == SURFACE_BUILT;
        }
    }
    print_message("%d plots, %d without house, %d heated; corners inside %d, outside %d\n", plots, missing, heated,
                  inside, outside);
    CHECK(plots > 100 && missing * 20 < plots && wrong == 0 && steep == 0);
    CHECK(inside > 4 * houses * 98 / 100 && outside < 4 * houses / 50);
    CHECK(heated > houses * 8 / 10 && heated < houses);
    culture_free(&c);
    landscape_destroy(&land);
}

/* Gates: no border of a plot before the drive. */
static void drives_are_open(void **state)
{
    (void)state;
    static const double half_m = 1.4;
    int                 plots, shut = 0, enclosed = 0;
    Landscape           land;
    make(&land, 5, 3000, NULL);
    Culture          c = invent(&land, 0, 0, 4000);
    const HousePlot *plot = landscape_plots(&land, &plots);
    for (int n = 0; n < plots; n++) {
        const HousePlot *p = &plot[n];
        const double     along = p->house[0] + (p->house[0] > 0 ? -1 : 1) * (p->house_half[0] + 1.8);
        const double     left = p->half_across_m * (p->house[1] < 0 ? -1 : 1);
        const double     x = p->x_m + along * p->direction[0] - left * p->direction[1];
        const double     y = p->y_m + along * p->direction[1] + left * p->direction[0];
        if (fabs(along) + half_m > p->half_along_m) continue; /* at the plot's side */
        for (int k = 0; k < c.lines; k++) {
            const CultureLine *l = &c.line[k];
            const double      *a = c.corner_m[l->first_corner], *b = c.corner_m[l->first_corner + 1];
            if (l->kind > CULTURE_WIRE_FENCE || hypot(a[0] - x, a[1] - y) > 60) continue;
            enclosed++;
            const double d[2] = {b[0] - a[0], b[1] - a[1]}, square = d[0] * d[0] + d[1] * d[1];
            const double t = clamp(((x - a[0]) * d[0] + (y - a[1]) * d[1]) / square, 0, 1);
            shut += hypot(a[0] + t * d[0] - x, a[1] + t * d[1] - y) < half_m;
        }
    }
    print_message("%d borders about plots, %d across drives\n", enclosed, shut);
    CHECK(enclosed > 200 && shut == 0);
    culture_free(&c);
    landscape_destroy(&land);
}

/* ---- nothing on anything ------------------------------------------------------------------------ */

typedef struct Outline {
    double p[4][2];
} Outline;

static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Whether a line along a side of one has all of the other on its outer side, but for a hair: so they are apart. */
static bool a_side_parts(const Outline *one, const Outline *other)
{
    for (int k = 0; k < 4; k++) {
        const double *a = one->p[k], *b = one->p[(k + 1) % 4], length_m = hypot(b[0] - a[0], b[1] - a[1]);
        bool          all = true;
        for (int m = 0; m < 4; m++) all = all && turn(a, b, other->p[m]) / length_m < 1e-5;
        if (all) return true;
    }
    return false;
}

static void outlines_are_apart(const Culture *c)
{
    int      count = 0, pairs = 0, meet = 0;
    Outline *outline = malloc((size_t)(c->buildings + c->points + 1) * sizeof *outline);
    CHECK(outline != NULL);
    for (int n = 0; n < c->buildings; n++) {
        CHECK(c->building[n].corners == 4);
        memcpy(outline[count++].p, c->corner_m[c->building[n].first_corner], sizeof outline->p);
    }
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        const double        ahead[2] = {sin((double)p->heading_rad), cos((double)p->heading_rad)};
        for (int k = 0; k < 4; k++) { /* counter-clockwise from above: right behind, right ahead, left ahead ... */
            const double u = 0.5 * (double)p->size_m[0] * (k == 1 || k == 2 ? 1 : -1);
            const double w = 0.5 * (double)p->size_m[1] * (k < 2 ? 1 : -1);
            outline[count].p[k][0] = p->x_m + u * ahead[0] + w * ahead[1];
            outline[count].p[k][1] = p->y_m + u * ahead[1] - w * ahead[0];
        }
        count++;
    }
    for (int n = 0; n < count; n++)
        for (int k = n + 1; k < count; k++) {
            if (hypot(outline[n].p[0][0] - outline[k].p[0][0], outline[n].p[0][1] - outline[k].p[0][1]) > 130) continue;
            pairs++;
            meet += !a_side_parts(&outline[n], &outline[k]) && !a_side_parts(&outline[k], &outline[n]);
        }
    print_message("%d outlines, %d pairs, %d on each other\n", count, pairs, meet);
    CHECK(pairs > count && meet == 0);
    free(outline);
}

/* Along every outline: the base is the lowest ground, the eaves are above the highest; neither road nor water. */
static void outlines_are_on_the_ground(const Culture *c, const Landscape *land)
{
    double below_m = 0, above_m = 0, steepest = 0, door_m = INFINITY;
    int    wet = 0, places = 0;
    for (int n = 0; n < c->buildings; n++) {
        const Building *b = &c->building[n];
        double          low_m = INFINITY, high_m = -INFINITY, corner[4];
        double(*p)[2] = c->corner_m + b->first_corner;
        for (int k = 0; k < 4; k++) {
            const double *from = p[k], *to = p[(k + 1) % 4];
            const int     parts = (int)ceil(hypot(to[0] - from[0], to[1] - from[1]) / 0.2);
            corner[k] = elevation_height(&land->elevation, from[0], from[1], NULL);
            for (int m = 0; m < parts; m++) {
                const double x = from[0] + (to[0] - from[0]) * m / parts, y = from[1] + (to[1] - from[1]) * m / parts;
                const double z_m = elevation_height(&land->elevation, x, y, NULL);
                low_m = fmin(low_m, z_m), high_m = fmax(high_m, z_m);
                if (m % 5) continue;
                const SurfaceClass surface = landscape_surface(land, x, y);
                wet += surface == SURFACE_WATER || surface == SURFACE_ROAD, places++;
            }
        }
        below_m = fmax(below_m, (double)b->base_m - low_m);
        above_m = fmax(above_m, low_m - (double)b->base_m);
        door_m = fmin(door_m, (double)b->base_m + (double)b->eaves_m - high_m);
        const double a = hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]), w = hypot(p[2][0] - p[1][0], p[2][1] - p[1][1]);
        steepest = fmax(steepest, hypot((corner[1] + corner[2] - corner[0] - corner[3]) / (2 * a),
                                        (corner[2] + corner[3] - corner[0] - corner[1]) / (2 * w)));
    }
    print_message(
        "%d buildings: base over the ground by %.1e m, under it by %.3f; eaves over it by %.2f m; slope %.3f; %d of "
        "%d places wet\n",
        c->buildings, below_m, above_m, door_m, steepest, wet, places);
    CHECK(c->buildings > 100 && below_m < 1e-6 && above_m < 0.03 && door_m > 1.9 && steepest < 0.1501 && wet == 0);
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        const SurfaceClass  surface = landscape_surface(land, p->x_m, p->y_m);
        CHECK(surface != SURFACE_WATER && surface != SURFACE_ROAD);
        for (int k = 0; k < 4; k++) { /* its corners are in the ground */
            const double ahead = 0.5 * (double)p->size_m[0] * (k < 2 ? 1 : -1), h = (double)p->heading_rad;
            const double right = 0.5 * (double)p->size_m[1] * (k % 2 ? 1 : -1);
            CHECK((double)p->base_m <= elevation_height(&land->elevation, p->x_m + ahead * sin(h) + right * cos(h),
                                                        p->y_m + ahead * cos(h) - right * sin(h), NULL) +
                                           1e-6);
        }
    }
}

/* Spans of power lines, which have poles of their own at their corners; lamps along roads; signs beside them. */
static void wires_and_lamps_are_spaced(const Culture *c, const Landscape *land)
{
    int spans = 0, lamps = 0, spaced = 0, signs = 0, poles = 0;
    for (int n = 0; n < c->lines; n++) {
        if (c->line[n].kind != CULTURE_POWER_LINE) continue;
        for (int k = 0; k < c->line[n].corners; k++) {
            const double *p = c->corner_m[c->line[n].first_corner + k];
            for (int m = 0; m < c->points; m++) CHECK(hypot(c->point[m].x_m - p[0], c->point[m].y_m - p[1]) > 0.5);
            poles++;
            if (k == 0) continue;
            const double span_m = hypot(p[0] - p[-2], p[1] - p[-1]);
            CHECK(span_m >= 40 && span_m <= 60);
            spans++;
        }
    }
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        WayPlace            way;
        double              least = INFINITY;
        if (p->kind == CULTURE_SIGN && landscape_way(&way, land, p->x_m, p->y_m) && way.kind == WAY_ROAD) signs++;
        if (p->kind != CULTURE_LAMP || !landscape_way(&way, land, p->x_m, p->y_m)) continue;
        CHECK(fabs(way.across_m) > way.half_m + 0.5);
        for (int k = 0; k < c->points; k++)
            if (k != n && c->point[k].kind == CULTURE_LAMP)
                least = fmin(least, hypot(c->point[k].x_m - p->x_m, c->point[k].y_m - p->y_m));
        lamps++, spaced += least > 24 && least < 46;
    }
    print_message("%d spans, %d poles; %d lamps, %d spaced; %d signs at roads\n", spans, poles, lamps, spaced, signs);
    CHECK(spans > 20 && lamps > 15 && spaced > lamps / 2 && signs > 1);
}

static void nothing_is_on_anything(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) { /* the last one: hills and a stone's throw to the sea */
        Landscape        land;
        LandscapeConfig  config = landscape_default_config();
        LocalFrame       frame;
        const Geodetic   origin = {0.9, 0.2, 120};
        const CoastPlace place[] = {{2600, 0, true}, {2500, 2500, true}, {-500, 0, false}, {-500, -2500, false}};
        const bool       sea = seed == 4;
        config.seed = seed, config.half_width_m = 3000, config.horizon_m = 30000,
        config.relief_m = sea ? 15 : 15.0 * (double)seed;
        CHECK(local_frame_at(&frame, &origin) == STATUS_OK);
        CHECK(landscape_create_from(&land, &config, &frame,
                                    &(LandscapeEvidence){.place_count = sea ? 4 : 0, .place = place}) == STATUS_OK);
        CHECK(!sea || landscape_surface(&land, 2600, 0) == SURFACE_WATER);
        Culture c = invent(&land, 0, 0, 4000);
        outlines_are_apart(&c);
        outlines_are_on_the_ground(&c, &land);
        wires_and_lamps_are_spaced(&c, &land);
        culture_free(&c);
        landscape_destroy(&land);
    }
}

/* ---- the same from anywhere ------------------------------------------------------------------------ */

static uint64_t mixed(uint64_t h, const void *data, size_t octets)
{
    const uint8_t *at = data;
    for (size_t n = 0; n < octets; n++) h = (h ^ at[n]) * 0x100000001b3u;
    return h;
}

/* The sum of a hash of every record with its corners: the same for the same records in any order. */
static uint64_t sum_of(const Culture *c, bool in_order)
{
    uint64_t sum = 0;
    for (int n = 0; n < c->buildings; n++) {
        Building       b = c->building[n];
        const uint64_t h = mixed(1, c->corner_m[b.first_corner], (size_t)b.corners * sizeof *c->corner_m);
        b.first_corner = 0;
        sum = (in_order ? 31 * sum : sum) + mixed(h, &b, sizeof b);
    }
    for (int n = 0; n < c->lines; n++) {
        const CultureLine *l = &c->line[n];
        uint64_t           h = mixed(2, c->corner_m[l->first_corner], (size_t)l->corners * sizeof *c->corner_m);
        h = mixed(mixed(h, &l->id, sizeof l->id), &l->width_m, 2 * sizeof l->width_m);
        sum = (in_order ? 31 * sum : sum) + mixed(h, &l->kind, 2);
    }
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        sum = (in_order ? 31 * sum : sum) + mixed(mixed(3, p, offsetof(CulturePoint, kind)), &p->kind, 1);
    }
    return sum;
}

typedef struct Job {
    const Landscape *land;
    Culture          whole[6], part[9];
} Job;

/* Nine squares over the ground; their borders are not those of cells in which sites are looked for. */
static const double part_half_m = 1130;

static void invent_some(void *user, int worker, int task)
{
    Job *job = user;
    (void)worker;
    if (task < 6) job->whole[task] = invent(job->land, 0, 0, 3000);
    else {
        const int k = 14 - task; /* the last first */
        job->part[k] = invent(job->land, 2 * part_half_m * (k % 3 - 1), 2 * part_half_m * (k / 3 - 1), part_half_m);
    }
}

static int by_id(const void *a, const void *b)
{
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

static void the_same_from_any_thread_and_square(void **state)
{
    (void)state;
    Landscape land;
    Pool     *pool;
    Job       job = {.land = &land};
    make(&land, 3, 3000, NULL);
    CHECK(pool_create(&pool, 4) == STATUS_OK);
    pool_run(pool, 15, invent_some, &job);
    pool_destroy(pool);
    const Culture *c = &job.whole[0];
    uint64_t       parts = 0;
    int            records = 0;
    for (int k = 1; k < 6; k++) CHECK(sum_of(&job.whole[k], true) == sum_of(c, true));
    for (int k = 0; k < 9; k++) {
        CHECK(job.part[k].buildings > 0);
        parts += sum_of(&job.part[k], false);
    }
    CHECK(parts == sum_of(c, false));
    uint64_t *id = malloc((size_t)(c->buildings + c->lines + c->points) * sizeof *id);
    for (int n = 0; n < c->buildings; n++) id[records++] = c->building[n].id;
    for (int n = 0; n < c->lines; n++) id[records++] = c->line[n].id;
    for (int n = 0; n < c->points; n++) id[records++] = c->point[n].id;
    qsort(id, (size_t)records, sizeof *id, by_id);
    for (int n = 1; n < records; n++) CHECK(id[n] != id[n - 1] && id[n - 1] != 0);
    print_message("%d records in one square and in nine\n", records);
    free(id);
    Culture other;
    CHECK(culture_invent(&other, &land, &(CultureConfig){4, {0, 0}, 3000}) == STATUS_OK);
    CHECK(sum_of(&other, false) != sum_of(c, false)); /* of another seed */
    culture_free(&other);
    for (int k = 0; k < 6; k++) culture_free(&job.whole[k]);
    for (int k = 0; k < 9; k++) culture_free(&job.part[k]);
    landscape_destroy(&land);
}

/* ---- how much of it --------------------------------------------------------------------------------- */

static void a_large_world_has_everything(void **state)
{
    (void)state;
    Landscape land;
    int       use[BUILDING_USES] = {0}, roof[ROOF_SHAPES] = {0}, line[CULTURE_LINE_KINDS] = {0},
        point[CULTURE_POINT_KINDS] = {0};
    int farms = 0, buildings = 0;
    make(&land, 1, 8000, NULL);
    const double start_s = cpu_s();
    Culture      c = invent(&land, 0, 0, 8000);
    const double took_s = cpu_s() - start_s;
    const size_t octets = (size_t)c.corners * sizeof *c.corner_m + (size_t)c.buildings * sizeof *c.building +
                          (size_t)c.lines * sizeof *c.line + (size_t)c.points * sizeof *c.point;
    for (int n = 0; n < c.buildings; n++) { /* 12 x 16 km of it */
        if (fabs(c.corner_m[c.building[n].first_corner][0]) > 6000) continue;
        use[c.building[n].use]++, roof[c.building[n].roof]++, buildings++;
    }
    for (int n = 0; n < c.lines; n++) {
        if (fabs(c.corner_m[c.line[n].first_corner][0]) > 6000) continue;
        line[c.line[n].kind]++;
        farms += c.line[n].kind == CULTURE_TRACK && c.line[n].surface == SURFACE_TRACK;
    }
    for (int n = 0; n < c.points; n++)
        if (fabs(c.point[n].x_m) <= 6000) point[c.point[n].kind]++;
    print_message("12 x 16 km: %d buildings, %.1f a km2, %.2f farms a km2\n", buildings, buildings / 192.0,
                  farms / 192.0);
    print_message("houses %d flats %d barns %d sheds %d halls %d churches %d\n", use[0], use[1], use[2], use[3], use[4],
                  use[5]);
    print_message(
        "poles %d lamps %d signs %d tanks %d silos %d containers %d heaps %d stacks %d chimneys %d masts %d\n",
        point[0], point[1], point[2], point[3], point[4], point[5], point[6], point[7], point[8], point[9]);
    print_message("walls %d fences %d wire fences %d power lines %d roads %d tracks %d\n", line[CULTURE_WALL],
                  line[CULTURE_FENCE], line[CULTURE_WIRE_FENCE], line[CULTURE_POWER_LINE], line[CULTURE_ROAD],
                  line[CULTURE_TRACK]);
    print_message("16 x 16 km: %.2f s of one processor, %.2f MB of records\n", took_s, 1e-6 * (double)octets);
    for (int k = 0; k < BUILDING_USES; k++) CHECK(use[k] > 0);
    for (int k = 0; k < ROOF_SHAPES; k++) CHECK(roof[k] > 0);
    for (int k = 0; k < CULTURE_POINT_KINDS; k++) CHECK(point[k] > 0);
    CHECK(line[CULTURE_WALL] && line[CULTURE_FENCE] && line[CULTURE_WIRE_FENCE] && line[CULTURE_POWER_LINE]);
    CHECK(line[CULTURE_ROAD] && farms > 192 / 2 && farms < 192 * 5 / 4);
    CHECK(c.left_out == 0 && c.repaired == 0 && octets < 4 << 20);
    culture_free(&c);
    landscape_destroy(&land);
}

static void an_empty_world_stays_empty(void **state)
{
    (void)state;
    Landscape  land;
    LocalFrame frame;
    Pool      *pool;
    double     times_s[2];
    Culture    c = {.left_out = 7};
    CHECK(local_frame_at(&frame, &(Geodetic){0.6, -1.9, 700}) == STATUS_OK);
    CHECK(pool_create(&pool, 1) == STATUS_OK);
    CHECK(landscape_quick(&land, times_s, &frame, 800, 800, pool) == STATUS_OK); /* it has no ways */
    pool_destroy(pool);
    const CultureConfig bad[] = {
        {1, {0, 0}, 0}, {1, {0, 0}, NAN}, {1, {NAN, 0}, 100}, {1, {0, 2e6}, 100}, {1, {0, 0}, 2e6}};
    log_suppress(true);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        CHECK(culture_invent(&c, &land, &bad[k]) == STATUS_BAD_VALUE && c.left_out == 7);
    log_suppress(false);
    CHECK(culture_invent(&c, &land, &(CultureConfig){1, {0, 0}, 400}) == STATUS_OK);
    CHECK(c.buildings == 0 && c.lines == 0 && c.points == 0 && c.left_out == 0);
    CHECK(!culture_is_near(&c, 0, 0, 100));
    culture_free(&c);
    landscape_destroy(&land);
    make(&land, 1, 280, NULL); /* too small for a village */
    double village[2];
    CHECK(!landscape_village(village, &land, 0));
    c = invent(&land, 0, 0, 400);
    for (int n = 0; n < c.buildings; n++) CHECK(c.building[n].use != BUILDING_FLATS);
    culture_free(&c);
    landscape_destroy(&land);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plots_have_their_houses),      cmocka_unit_test(drives_are_open),
        cmocka_unit_test(nothing_is_on_anything),       cmocka_unit_test(the_same_from_any_thread_and_square),
        cmocka_unit_test(a_large_world_has_everything), cmocka_unit_test(an_empty_world_stays_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
