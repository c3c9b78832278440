/* The finest level of the plants: its leaf area and the size of its leaves, what crowns let through and hide at it, its
 * memory, and the octets in which it is kept. */
#include "tests/check.h"

#include "render/trace/plants/forest_private.h"
#include "render/trace/plants/plants_kept.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static Plants *plants;
static double  grown_octets; /* resident, with a forest of them */

static double resident_octets(void)
{
    long  size = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file) return NAN;
    if (fscanf(file, "%ld %ld", &size, &resident) != 2) resident = 0;
    fclose(file);
    return (double)resident * (double)sysconf(_SC_PAGESIZE);
}

/* ---- a plant of each kind, 10 m high and 100 m apart ------------------------------------------ */

enum { levels_seen = 3, seen_bare = 2, rays = 4000, trunk_quads = 12 * 6, height_m = 10, apart_m = 100 };

static Forest *forest[levels_seen]; /* at plant_fine, at plant_whole, and that without leaves */
static Plant   plant[PLANT_STANDING];
static Woods   woods;

static int grow(void **state)
{
    static uint32_t first[2] = {0, PLANT_STANDING};
    (void)state;
    const double before = resident_octets();
    for (int k = 0; k < PLANT_STANDING; k++)
        plant[k] =
            (Plant){.p_m = {(float)(apart_m * k), 0, 0}, .height = 100 * height_m, .width = 128, .kind = (uint8_t)k};
    woods = (Woods){.nx = 1, .ny = 1, .first = first, .count = PLANT_STANDING, .plant = plant};
    if (plants_create(&plants, 1995, NULL) != STATUS_OK) return 1;
    for (int l = 0; l < levels_seen; l++) {
        const ForestConfig config = {.leaves = l != seen_bare, .fine = l == 0};
        if (forest_create(&forest[l], &woods, plants, &config, "avx2") != STATUS_OK) return 1;
        if (l == 0) grown_octets = resident_octets() - before;
    }
    return 0;
}

static int fell(void **state)
{
    (void)state;
    for (int l = 0; l < levels_seen; l++) forest_destroy(forest[l]);
    plants_destroy(plants);
    return 0;
}

/* Shares of rays. */
typedef struct Seen {
    double leaf, trunk, gap;
} Seen;

typedef enum Way { AT_THE_TRUNK, ACROSS, DOWN } Way;

/* Level rays from all around through the middle half of the crown's height: at the trunk, whose axis they pass within
 * its own wandering, or across eight tenths of the crown; or down on these. */
static Seen look(int kind, int which, Way way)
{
    static const double calm[2] = {0, 0};
    static double       o[3][rays], d[3][rays], range_m[rays];
    static ForestHit    hit[rays];
    const double *const from[3] = {o[0], o[1], o[2]}, *const to[3] = {d[0], d[1], d[2]};
    const PlantShape *s = &plants->shape[kind][plant_whole];
    const double      r_m = height_m * (double)s->crown_radius * (way == AT_THE_TRUNK ? 0.03 : 0.8);
    const double      eye[3] = {apart_m * kind, -10, 0};
    ForestFrame       frame;
    Arena            *arena = arena_create();
    Seen              seen = {0};
    assert_int_equal(forest_frame_open(&frame, forest[which], eye, 1000, 0, 0, calm, NULL, arena), STATUS_OK);
    for (int i = 0; i < rays; i++) {
        const double turn = 2 * pi_rad * random_uniform(5, 1, 0, (uint64_t)i), c = cos(turn), b = sin(turn);
        const double out = random_uniform(5, 2, 0, (uint64_t)i), up = 0.25 + 0.5 * random_uniform(5, 3, 0, (uint64_t)i);
        const double aside_m = r_m * (2 * out - 1), low = (double)s->crown_low;
        const double at[3] = {way == DOWN ? r_m * sqrt(out) * c : 30 * c - aside_m * b,
                              way == DOWN ? r_m * sqrt(out) * b : 30 * b + aside_m * c,
                              way == DOWN ? 30 : height_m * (low + (1 - low) * up)};
        for (int x = 0; x < 3; x++) o[x][i] = at[x] + (x == 0 ? apart_m * kind : 0), d[x][i] = 0;
        if (way == DOWN) d[2][i] = -1;
        else d[0][i] = -c, d[1][i] = -b;
        range_m[i] = 60;
    }
    forest_first_hits(range_m, hit, &frame, rays, from, to, NULL);
    for (int i = 0; i < rays; i++) {
        const bool met = range_m[i] < 60;
        if (met) assert_int_equal(hit[i].level, which == 0 ? plant_fine : plant_whole);
        seen.gap += !met / (double)rays;
        seen.leaf += (met && hit[i].organ == PLANT_LEAF) / (double)rays;
        seen.trunk += (met && hit[i].quad < trunk_quads) / (double)rays;
    }
    forest_frame_close(&frame);
    arena_destroy(arena);
    return seen;
}

/* ---- leaves ----------------------------------------------------------------------------------- */

static double side_m(const PlantQuad *q, int corner)
{
    double along[3];
    for (int x = 0; x < 3; x++) along[x] = (double)q->corner[corner][x] - (double)q->corner[0][x];
    return v3_length(along);
}

/* Cards, which are rectangles, times the counted cells of their patterns: the area of plant_whole within 1 %. */
static void the_same_leaf_area(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        const PlantShape *s = &plants->shape[kind][plant_fine];
        const double      want = (double)plants->shape[kind][plant_whole].leaf_area;
        double            area = 0, share[plant_outlines] = {0};
        for (int o = 0; o < plant_outlines; o++)
            for (int j = 0; j < plant_pattern_side; j++)
                for (int i = 0; i < plant_pattern_side; i++)
                    share[o] += (plants->pattern[kind][o].leaflet[j][i] > 0) /
                                ((double)plant_pattern_side * plant_pattern_side);
        for (int k = s->bark_quads; k < s->quads; k++)
            area += side_m(&s->quad[k], 1) * side_m(&s->quad[k], 3) * share[s->quad[k].outline];
        CHECK_NEAR(area, want, 0.01 * want);
        CHECK_NEAR((double)s->leaf_area, area, 1e-3 * area);
    }
}

/* Lengths of leaves of the species at their usual heights (etc/woods.csv), m: Stace, New Flora of the British Isles,
 * 4th ed., and Flora of North America: pine needles 4 .. 7 cm, alder 4 .. 9, birch 3 .. 7, English and sessile oak 7 ..
 * 12, red oak 8 .. 22, white oak 8 .. 22; bushes and hedges (hazel, hawthorn) 2 .. 12 cm. No leaf is longer than 0.15
 * m. */
static void leaves_of_their_size(void **state)
{
    static const double usual_m[PLANT_STANDING] = {20, 18, 18, 18, 18, 18, 18, 2.2, 1.6};
    static const double low_m[PLANT_STANDING] = {0.04, 0.04, 0.03, 0.07, 0.07, 0.08, 0.08, 0.02, 0.02};
    static const double high_m[PLANT_STANDING] = {0.08, 0.09, 0.07, 0.12, 0.12, 0.22, 0.22, 0.12, 0.12};
    (void)state;
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        const PlantShape *s = &plants->shape[kind][plant_fine];
        double            sum = 0, longest = 0;
        int               count = 0;
        for (int k = s->bark_quads; k < s->quads; k++) {
            const LeafPattern *p = &plants->pattern[kind][s->quad[k].outline];
            const double u_m = side_m(&s->quad[k], 1) * usual_m[kind], v_m = side_m(&s->quad[k], 3) * usual_m[kind];
            const int    leaves = kind == PLANT_PINE ? p->leaflets : p->leaflets - 1; /* the last is the twig */
            for (int l = 0; l < leaves; l++) {
                const double leaf_m =
                    hypot((double)(p->tip[l][0] - p->foot[l][0]) * u_m, (double)(p->tip[l][1] - p->foot[l][1]) * v_m);
                sum += leaf_m, count++, longest = fmax(longest, leaf_m);
            }
        }
        if (!(sum / count >= low_m[kind] && sum / count <= high_m[kind] && longest <= 0.15))
            fail_msg("%s: %.3f m, longest %.3f", plant_name((PlantKind)kind), sum / count, longest);
    }
}

/* The reflectance of places on leaves has mean 1, as that of a card of plant_whole, and differs within a card. */
static void texture(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_STANDING; kind++) {
        const PlantShape *s = &plants->shape[kind][plant_fine];
        double            sum = 0, square = 0;
        int               count = 0, differ = 0;
        float             before = 0;
        for (int n = 0; n < 40000; n++) {
            const int        k = s->bark_quads + (int)(random_uniform(6, 1, 0, (uint64_t)n / 2) * s->leaves);
            const float      uv[2] = {(float)random_uniform(6, 2, 0, (uint64_t)n),
                                      (float)random_uniform(6, 3, 0, (uint64_t)n)};
            const PlantQuad *q = &s->quad[k];
            if (plants_leaflet(&plants->pattern[kind][q->outline], uv[0], uv[1]) == 0) continue;
            const LeafPlace at = plants_leaf_place(plants, (PlantKind)kind, 7, q, (uint32_t)k, uv);
            sum += (double)at.albedo, square += (double)at.albedo * (double)at.albedo, count++;
            if (n % 2) differ += at.albedo != before;
            before = at.albedo;
            CHECK(at.albedo > 0.4f && at.albedo < 1.8f && fabsf(at.slope[0]) < 0.8f && fabsf(at.slope[1]) < 0.8f);
        }
        CHECK_NEAR(sum / count, 1, 0.01);
        /* of a spray, of a leaf, along it: 0.1, 0.12, 0.16 / sqrt 12 */
        const double want = sqrt(0.1 * 0.1 + 0.12 * 0.12 + 0.16 * 0.16 / 12);
        CHECK_NEAR(sqrt(square / count - sum / count * sum / count), want, 0.01);
        CHECK(differ > 1000);
    }
}

/* ---- crowns ----------------------------------------------------------------------------------- */

/* Surfaces found many at once have the bits of those found one by one: leaves and wood of plants that lean and are
 * turned, in more than one piece of work, and a card without area. */
static void many_surfaces_at_once(void **state)
{
    enum { count = 200, flat = 7 };
    static const double calm[2] = {0, 0}, eye[3] = {0, -100, 5};
    static ForestHit    hit[count];
    static double       o[3][count], d[3][count], range_m[count], n_geo[3][count], n_enu[3][count];
    static float        albedo[count], radius_m[count], open_up[count], open_down[count];
    static uint8_t      mark[count];
    const ForestHit    *list[count];
    const ForestRays    to = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, range_m};
    Plant               straight[PLANT_STANDING];
    ForestFrame         frame;
    Arena              *arena = arena_create();
    ForestSurfaces      all = {
             {n_geo[0], n_geo[1], n_geo[2]}, {n_enu[0], n_enu[1], n_enu[2]}, albedo, radius_m, open_up, open_down, mark};
    int wood = 0;
    (void)state;
    memcpy(straight, plant, sizeof straight);
    for (int k = 0; k < PLANT_STANDING; k++) {
        plant[k].lean[0] = (int8_t)(9 * k), plant[k].lean[1] = (int8_t)(40 - 7 * k);
        plant[k].twist = (uint16_t)(7000 * k), plant[k].width = (uint8_t)(100 + 10 * k);
    }
    assert_int_equal(forest_frame_open(&frame, forest[0], eye, 1000, 0, 0, calm, NULL, arena), STATUS_OK);
    for (int i = 0; i < count; i++) {
        const uint64_t    of = (uint64_t)i;
        const int         kind = i % PLANT_STANDING;
        const PlantShape *s = &plants->shape[kind][plant_fine];
        const bool        bark = i % 5 == 0;
        wood += bark;
        hit[i] = (ForestHit){
            .plant = (uint32_t)kind,
            .place = (uint32_t)kind,
            .quad = (uint32_t)(bark ? i * 37 % s->bark_quads : s->bark_quads + i * 37 % (s->quads - s->bark_quads)),
            .kind = (uint8_t)kind,
            .level = plant_fine,
            .organ = bark ? PLANT_BARK : PLANT_LEAF,
            .uv = {(float)random_uniform(9, 1, 0, of), (float)random_uniform(9, 2, 0, of)}};
        list[i] = &hit[i];
        for (uint32_t c = 0; c < 3; c++) o[c][i] = eye[c], d[c][i] = 2 * random_uniform(9, 3 + c, 0, of) - 1;
        range_m[i] = 5 + 100 * random_uniform(9, 6, 0, of);
    }
    PlantQuad *card = &plants->shape[hit[flat].kind][plant_fine].quad[hit[flat].quad], whole = *card;
    memcpy(card->corner[2], card->corner[1], sizeof card->corner[1]);
    memcpy(card->corner[3], card->corner[0], sizeof card->corner[0]);
    forest_surfaces(&all, &frame, list, count, &to);
    for (int i = 0; i < count; i++) {
        const double way[3] = {d[0][i], d[1][i], d[2][i]}, geo[3] = {n_geo[0][i], n_geo[1][i], n_geo[2][i]},
                     enu[3] = {n_enu[0][i], n_enu[1][i], n_enu[2][i]};
        ForestSurface one;
        forest_surface(&one, &frame, &hit[i], eye, way, range_m[i], (float)(range_m[i] / frame.per_rad));
        assert_memory_equal(one.n_geo, geo, sizeof geo);
        assert_memory_equal(one.n_enu, enu, sizeof enu);
        CHECK(one.albedo == albedo[i] && one.open_up == open_up[i] && one.open_down == open_down[i] &&
              one.mark == mark[i]);
        CHECK(one.radius_m == radius_m[i] && (radius_m[i] > 0) == (hit[i].organ == PLANT_BARK));
    }
    CHECK(wood == count / 5 && fabs(n_geo[2][flat]) == 1);
    *card = whole;
    memcpy(plant, straight, sizeof straight);
    forest_frame_close(&frame);
    arena_destroy(arena);
}

/* ---- crowns ----------------------------------------------------------------------------------- */

/* With the same leaf area in nearly the same places a crown lets as many rays through as at plant_whole. */
static void gaps_of_crowns(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_STANDING; kind++)
        for (Way way = ACROSS; way <= DOWN; way++) {
            const Seen fine = look(kind, 0, way), whole = look(kind, 1, way);
            if (!(fabs(fine.gap - whole.gap) <= 0.06))
                fail_msg("%s: gaps %.3f, at plant_whole %.3f", plant_name((PlantKind)kind), fine.gap, whole.gap);
        }
}

/* Leaves that a level ray from the trunk to afar meets in the mean, in the middle half of the crown's height: of leaf
 * area a at radius r the share |n.r| / (2 pi r) of each height. */
static double leaves_before_the_trunk(int kind)
{
    const PlantShape *s = &plants->shape[kind][plant_fine];
    const double      crown = (double)plants->shape[kind][plant_whole].crown_low, high = 1 - crown;
    double            sum = 0;
    for (int k = s->bark_quads; k < s->quads; k++) {
        const PlantQuad *q = &s->quad[k];
        double           m[3];
        for (int x = 0; x < 3; x++) m[x] = 0.5 * ((double)q->corner[0][x] + (double)q->corner[2][x]);
        const double r = fmax(hypot(m[0], m[1]), 0.01),
                     facing = fabs((double)q->n[0][0] * m[0] + (double)q->n[0][1] * m[1]) / r;
        const double area = side_m(q, 1) * side_m(q, 3) * (double)plants->pattern[kind][q->outline].area;
        if (fabs(m[2] - crown - 0.5 * high) < 0.25 * high) sum += area * facing / (2 * pi_rad * r * 0.5 * high);
    }
    return sum;
}

/* What shows of the trunk among the leaves, of what branches leave to be seen: exp(-c N) of N leaves in the way, with a
 * clumping index c of 0.5 .. 0.95 in forests (Chen, Menges & Leblanc, Remote Sens. Environ. 97, 447, 2005); 1 at
 * random. */
static void crowns_hide_trunks(void **state)
{
    (void)state;
    for (int kind = PLANT_PINE + 1; kind < PLANT_TREES; kind++) { /* those that can be bare */
        const double shows = look(kind, 0, AT_THE_TRUNK).trunk, bare = look(kind, seen_bare, AT_THE_TRUNK).trunk;
        const double n = leaves_before_the_trunk(kind), noise = 4 * sqrt(shows * (1 - shows) / rays);
        if (!(bare > 0.05 && shows - noise <= bare * exp(-0.5 * n) && shows + noise >= bare * exp(-1.1 * n)))
            fail_msg("%s: %.3f of %.3f with %.2f leaves before it", plant_name((PlantKind)kind), shows, bare, n);
    }
}

/* ---- light past the own crown ----------------------------------------------------------------- */

/* What is found of a card when it is asked for, against many rays of our own from all cards of its spray: the mean of
 * sprays within two standard errors of forty, each as far as its dozen rays each way allow (0.15); the same for all of
 * them, and asked again. */
static void openness(void **state)
{
    enum { tried = 40, directions = 60 };
    double mean[2] = {0}, square = 0;
    (void)state;
    for (int t = 0; t < tried; t++) {
        const int         kind = t % PLANT_STANDING;
        const ShapeScene *scene = &forest[0]->shape[kind][plant_fine];
        const PlantShape *s = scene->shape;
        const int         asked = s->bark_quads + (int)(random_uniform(3, 0, 0, (uint64_t)t) * s->leaves);
        int               first = asked, end = asked + 1;
        double            all[2] = {0}, open[2] = {0};
        float             share[2], again[2];
        while (s->quad[first - 1].organ == PLANT_LEAF && s->quad[first - 1].piece == s->quad[asked].piece) first--;
        while (end < s->quads && s->quad[end].piece == s->quad[asked].piece) end++;
        plant_openness(share, scene, (uint32_t)asked);
        plant_openness(again, scene, (uint32_t)first);
        CHECK(end - first > 1 && again[0] == share[0] && again[1] == share[1]);
        CHECK(s->quad[end - 1].open_up == share[0] && s->quad[end - 1].open_down == share[1]);
        for (int q = first; q < end; q++)
            for (int k = 0; k < directions; k++) {
                const PlantQuad *quad = &s->quad[q];
                const uint64_t   draw = 2 * ((uint64_t)q * directions + (uint64_t)k);
                const double     z = 2 * random_uniform(4, 0, (uint32_t)kind, draw) - 1;
                const double     turn = 2 * pi_rad * random_uniform(4, 0, (uint32_t)kind, draw + 1);
                const double     d[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
                const double     n[3] = {(double)quad->n[0][0], (double)quad->n[0][1], (double)quad->n[0][2]};
                const double     cosine = v3_dot(n, d);
                double           o[3];
                for (int c = 0; c < 3; c++)
                    o[c] =
                        0.5 * ((double)quad->corner[0][c] + (double)quad->corner[2][c]) + copysign(1e-4, cosine) * n[c];
                all[z < 0] += fabs(cosine), open[z < 0] += shape_occluded(scene, o, d) ? 0 : fabs(cosine);
            }
        for (int h = 0; h < 2; h++) {
            const double off = (double)share[h] - open[h] / all[h];
            mean[h] += off / tried, square += off * off / (2 * tried);
        }
    }
    print_message("openness: off by %.3f above, %.3f below; rms %.3f\n", mean[0], mean[1], sqrt(square));
    CHECK(fabs(mean[0]) < 0.05 && fabs(mean[1]) < 0.05 && sqrt(square) < 0.2);
}

/* ---- memory, and octets ----------------------------------------------------------------------- */

/* Prototypes of all kinds and levels with Embree's trees: 150 MB. Hits name a quad in 18 bits. */
static void memory(void **state)
{
    double octets = 0;
    (void)state;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            CHECK(plants->shape[kind][level].quads < 1 << 18);
            octets += plants->shape[kind][level].quads * (double)sizeof(PlantQuad);
        }
    CHECK(octets < 60e6);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) /* whose own memory is many times that */
    CHECK(grown_octets > octets && grown_octets < 150e6);
#endif
}

static void kept(void **state)
{
    const size_t count = plants_light_to_octets(NULL, plants);
    float       *octets = malloc(count), *again = malloc(count);
    PlantQuad   *last = &plants->shape[PLANT_KINDS - 1][plant_simple].quad[0];
    (void)state;
    assert_true(octets && again);
    assert_int_equal(plants_light_to_octets(octets, plants), count);
    octets[count / sizeof *octets - 1] = 0.25f;
    assert_int_equal(plants_light_from_octets(plants, octets, count), STATUS_OK);
    CHECK(last[plants->shape[PLANT_KINDS - 1][plant_simple].quads - 1].open_down == 0.25f);
    assert_int_equal(plants_light_to_octets(again, plants), count);
    assert_memory_equal(octets, again, count);
    octets[0] = 0.5f; /* which shall not be taken from what is wrong elsewhere */
    assert_int_equal(plants_light_from_octets(plants, octets, count - sizeof *octets), STATUS_BAD_VALUE);
    for (int k = 0; k < 3; k++) {
        octets[count / sizeof *octets - 1] = k == 0 ? NAN : k == 1 ? -0.01f : 1.01f;
        assert_int_equal(plants_light_from_octets(plants, octets, count), STATUS_BAD_VALUE);
    }
    assert_int_equal(plants_light_to_octets(octets, plants), count);
    assert_memory_equal(octets, again, count);
    free(octets), free(again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_leaf_area),
        cmocka_unit_test(leaves_of_their_size),
        cmocka_unit_test(texture),
        cmocka_unit_test(many_surfaces_at_once),
        cmocka_unit_test(gaps_of_crowns),
        cmocka_unit_test(crowns_hide_trunks),
        cmocka_unit_test(openness),
        cmocka_unit_test(memory),
        cmocka_unit_test(kept),
    };
    return cmocka_run_group_tests(tests, grow, fell);
}
