/* Ground on which an exercise stands does not tell where its vehicles will go: along their paths it has the statistics
 * of any other path of their shape. The judge is a classifier that knows surface class, plants and relief at places of
 * one half of the paths, and is asked about those of the other half: the area under its ROC curve is 0.5 for one that
 * guesses. Its twins are grounds that do tell. */
#include "tests/check.h"

#include "sensor/node/choices/choices.h"
#include "tests/sensor/stood_exercise.h"

#include <stdlib.h>

enum { paths = 48, reports = 40, between = 4, places = (reports - 1) * between, decoys = 3, features = 4 };

/* One place of a path: surface class, distance of the nearest stem, number of low plants in its square, bend of the
 * ground over 8 m. Over tens of metres it bends as that of the exercise does, through whose reports it is led. */
typedef struct Place {
    double of[features];
} Place;

static TrackPoint point[paths][reports];
static Track      track[paths];
static double     path_m[paths][reports][2];
static Place      real[paths][places], other[decoys][paths][places];

static double hill_m(double x, double y) /* of the ground that the exercise was run on, which is not ours */
{
    return 500 + 14 * sin(x / 310 + 1) * cos(y / 270) + 3 * sin(x / 90) * sin(y / 70 + 2);
}

/* Drives of a tank's: 20 m from report to report, which turn by a little each time. */
static void drive(uint64_t seed)
{
    Origin       origin;
    const Model *model = catalog_model(catalog, catalog_find(catalog, tank, &origin, NULL));
    for (int t = 0; t < paths; t++) {
        const uint64_t n = (uint64_t)t;
        double x = 1800 * (random_uniform(seed, 1, 0, n) - 0.5), y = 1800 * (random_uniform(seed, 2, 0, n) - 0.5);
        double heading_rad = 2 * pi_rad * random_uniform(seed, 3, 0, n);
        track[t] = (Track){.id = {1, 1, (uint16_t)(t + 1)}, .type = tank, .count = reports, .point = point[t]};
        for (int k = 0; k < reports; k++) {
            double       p_enu[3] = {x, y, 0}, r[9], euler[3];
            const double c = cos(heading_rad), s = sin(heading_rad), r_enu_from_body[9] = {c, s, 0, s, -c, 0, 0, 0, -1};
            Geodetic     place;
            TrackPoint  *p = &point[t][k];
            *p = (TrackPoint){.t_s = 100 + 2 * k};
            for (int again = 0; again < 4; again++) {
                ecef_from_enu(p->p_ecef, &frame, p_enu);
                assert_int_equal(geodetic_from_ecef(&place, p->p_ecef), STATUS_OK);
                p_enu[2] += hill_m(x, y) - place.h_m;
            }
            m3_mul(r, frame.r_ecef_from_enu, r_enu_from_body);
            euler_from_r_ecef_from_body(&euler[0], &euler[1], &euler[2], r);
            for (int a = 0; a < 3; a++) p->euler_rad[a] = (float)euler[a];
            m3_mul_v3(p->v_ecef_mps, frame.r_ecef_from_enu, (const double[3]){10 * c, 10 * s, 0});
            if (origin == ORIGIN_CENTRE)
                for (int a = 0; a < 3; a++) p->p_ecef[a] -= 0.5 * model->height_m * r[3 * a + 2];
            path_m[t][k][0] = x, path_m[t][k][1] = y;
            heading_rad += 0.5 * (random_uniform(seed, 4, (uint32_t)k, n) - 0.5);
            x += 20 * cos(heading_rad), y += 20 * sin(heading_rad);
        }
    }
}

static double nearest_stem_m(const Woods *woods, double x, double y)
{
    static const double reach_m = 24;
    double              nearest = reach_m;
    const double        u = x - woods->origin_enu[0], v = y - woods->origin_enu[1];
    for (int j = (int)floor((v - reach_m) / woods_square_m); j <= (int)floor((v + reach_m) / woods_square_m); j++)
        for (int i = (int)floor((u - reach_m) / woods_square_m); i <= (int)floor((u + reach_m) / woods_square_m); i++) {
            if (i < 0 || j < 0 || i >= woods->nx || j >= woods->ny) continue;
            for (uint32_t n = woods->first[j * woods->nx + i]; n < woods->first[j * woods->nx + i + 1]; n++)
                nearest = fmin(nearest, hypot((double)woods->plant[n].p_m[0] - u, (double)woods->plant[n].p_m[1] - v));
        }
    return nearest;
}

/* How far the ground is from the plane through places about it, m: a ledge fitted in would show. */
static double rough_m(const Landscape *land, double x, double y)
{
    static const double arm_m = 8;
    double              sum = 0;
    for (int k = 0; k < 4; k++)
        sum += elevation_height(&land->elevation,
                                x + arm_m * (k == 0   ? 1
                                             : k == 1 ? -1
                                                      : 0),
                                y + arm_m * (k == 2   ? 1
                                             : k == 3 ? -1
                                                      : 0),
                                NULL);
    return fabs(elevation_height(&land->elevation, x, y, NULL) - sum / 4);
}

static void look(Place *out, const Landscape *land, const Woods *woods, double x, double y)
{
    static Plant low[woods_low_most];
    out->of[0] = landscape_surface(land, x, y);
    out->of[1] = nearest_stem_m(woods, x, y);
    out->of[2] = woods_low_plants(low, woods, (int64_t)floor((x - woods->origin_enu[0]) / woods_low_m),
                                  (int64_t)floor((y - woods->origin_enu[1]) / woods_low_m));
    out->of[3] = rough_m(land, x, y);
}

/* Along all paths, turned about the middle of the square and mirrored: angle 0 are the paths themselves. */
static void look_along(Place (*out)[places], const Landscape *land, const Woods *woods, double angle_rad, double sign)
{
    const double c = cos(angle_rad), s = sin(angle_rad);
    for (int t = 0; t < paths; t++)
        for (int k = 0; k < places; k++) {
            const double *a = path_m[t][k / between], *b = path_m[t][k / between + 1],
                         u = (k % between + 0.5) / between;
            const double x = (1 - u) * a[0] + u * b[0], y = sign * ((1 - u) * a[1] + u * b[1]);
            look(&out[t][k], land, woods, c * x - s * y, s * x + c * y);
        }
}

/* ---- the judge ---------------------------------------------------------------------------------- */

/* Naive Bayes: log of how much more often a bin of each feature was met on paths than beside them. */
enum { bins = 32 };
static double bin_low[features], bin_high[features], weight[features][bins];

static int bin_of(int f, double value)
{
    const double at = (value - bin_low[f]) / (bin_high[f] - bin_low[f]);
    return (int)clamp(floor(at * bins), 0, bins - 1);
}

static void learn(void)
{
    static double met[2][features][bins];
    const double  most[features] = {bins, 24, 256, 0.3};
    for (int f = 0; f < features; f++)
        for (int b = 0; b < bins; b++) met[0][f][b] = met[1][f][b] = 1;
    for (int f = 0; f < features; f++) bin_low[f] = 0, bin_high[f] = most[f];
    for (int t = 0; t < paths; t += 2)
        for (int k = 0; k < places; k++)
            for (int f = 0; f < features; f++) {
                met[1][f][bin_of(f, real[t][k].of[f])] += 1;
                for (int d = 0; d < decoys; d++) met[0][f][bin_of(f, other[d][t][k].of[f])] += 1.0 / decoys;
            }
    for (int f = 0; f < features; f++)
        for (int b = 0; b < bins; b++) weight[f][b] = log(met[1][f][b] / met[0][f][b]);
}

static double score_of(const Place *p, int only)
{
    double sum = 0;
    for (int f = 0; f < features; f++)
        if (only < 0 || f == only) sum += weight[f][bin_of(f, p->of[f])];
    return sum;
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* Share of pairs, of a place of the other paths and one beside them, in which the former has the higher score. */
static double area_under_curve(int only)
{
    enum { half = paths / 2 * places };
    static double on[half], off[decoys * half];
    int           ons = 0, offs = 0;
    for (int t = 1; t < paths; t += 2)
        for (int k = 0; k < places; k++) {
            on[ons++] = score_of(&real[t][k], only);
            for (int d = 0; d < decoys; d++) off[offs++] = score_of(&other[d][t][k], only);
        }
    qsort(on, (size_t)ons, sizeof *on, by_value);
    qsort(off, (size_t)offs, sizeof *off, by_value);
    double sum = 0;
    for (int n = 0, below = 0, upto = 0; n < ons; n++) {
        while (below < offs && off[below] < on[n]) below++;
        while (upto < offs && off[upto] <= on[n]) upto++;
        sum += 0.5 * (below + upto);
    }
    return sum / ((double)ons * offs);
}

/* ---- grounds ------------------------------------------------------------------------------------- */

static double judged(double by[features], const Landscape *land, const Woods *woods, uint64_t seed)
{
    look_along(real, land, woods, 0, 1);
    for (int d = 0; d < decoys; d++)
        look_along(other[d], land, woods, 2 * pi_rad * (d + random_uniform(seed, 9, 0, (uint64_t)d)) / decoys + 0.6,
                   d % 2 ? -1 : 1);
    learn();
    for (int f = 0; f < features; f++) by[f] = area_under_curve(f);
    return area_under_curve(-1);
}

static void ground_does_not_tell_paths(void **state)
{
    (void)state;
    double sum = 0, wide_sum = 0;
    enum { seeds = 2 };
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        static Exercise e;
        WoodsChoice     woods;
        Landscape       land;
        Choices         choices = {0};
        Config          config = config_default();
        HostPlan        plan = {0};
        GroundContact   contact;
        double          by[features], wide_by[features];
        config.terrain.woods = true;
        config.terrain.woods_half_m = 1500;
        config.seed = (int)seed;
        drive(seed);
        e.survey = (Survey){.track = track, .track_count = paths, .shot = e.shot, .first_s = 100, .last_s = 180};
        assert_int_equal(stood_ground(&land, &contact, &choices, &e, &config, &plan), STATUS_OK);
        assert_int_equal(stood_woods(&woods, &choices, &e, &config, &plan, &land), STATUS_OK);
        const double area = judged(by, &land, &woods.woods, seed);

        /* the twin: stems and grass are gone for 8 m on both sides of the paths */
        Woods       open;
        WoodsConfig wide = woods.config;
        double      wide_area = 1;
        for (int n = 0; n < wide.path_count; n++) woods.path[n].half_m = woods.path[n].low_half_m = 8;
        assert_int_equal(woods_create(&open, &land, &wide, NULL), STATUS_OK);
        wide_area = judged(wide_by, &land, &open, seed);
        printf("seed %d: AUC %.3f (class %.3f, stems %.3f, low plants %.3f, relief %.3f); cleared for 8 m %.3f\n",
               (int)seed, area, by[0], by[1], by[2], by[3], wide_area);
        sum += area, wide_sum += wide_area;
        woods_destroy(&open);
        choice_woods_free(&woods);
        landscape_destroy(&land);
    }
    CHECK(sum / seeds <= 0.55);
    CHECK(wide_sum / seeds > 0.6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(ground_does_not_tell_paths)};
    return cmocka_run_group_tests(tests, open_place, close_place);
}
