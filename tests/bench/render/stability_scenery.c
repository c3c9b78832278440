/* tests/bench/render/stability_scenery.c: a street of houses and cars, anywhere on the Earth, from outside and inside,
 * at every hour. References: the picture by one thread with nothing skipped; the same street elsewhere; where the eye
 * was put. */
#include "tests/bench/suites.h"
#include "tests/scenes/stress_world.h"
#include "tests/scenes/town.h"

#include <stdlib.h>

enum { street_px = 64 };

typedef struct Street {
    StressWorld *world, *one; /* one: of one thread; the same scenery */
    Scenery      scenery;
} Street;

static bool draw(StressWorld *w, const double eye[3], const double d[3], const double offset_m[3], unsigned skips_off)
{
    const double sun_enu[3] = {0.3, -0.6, 0.7};
    double       at[3];
    v3_add(at, eye, offset_m);
    const View    view = stress_view(at, d, 0, street_px, street_px, 60);
    RenderRequest request = stress_request(&view);
    request.sky_visibility = true;
    request.skips_off = skips_off;
    stress_clear(w);
    stress_no_air(w, sun_enu);
    return stress_render(w, &request);
}

/* Eyes in the street, over it, and within houses. */
static void eye_of(double eye[3], double d[3], Dice *dice)
{
    stress_direction(d, dice);
    for (int k = 0; k < 2; k++) eye[k] = stress_uniform(dice, -60, 60);
    eye[2] = stress_log_uniform(dice, 0.05, 60);
    if (eye[2] > 10) d[2] = -fabs(d[2]);
}

static double on_one_thread(void *user, bool quick)
{
    const Street *s = user;
    const double  none[3] = {0};
    double        wrong = 0;
    Dice          dice = {.stream = 70};
    for (int n = quick ? 2 : 30; n > 0; n--) {
        double eye[3], d[3];
        eye_of(eye, d, &dice);
        if (!draw(s->world, eye, d, none, 0) || !draw(s->one, eye, d, none, skips_all_off)) return INFINITY;
        wrong += stress_differences(&s->world->picture, 0, 0, &s->one->picture, 0, 0, street_px, street_px);
        wrong += stress_bad_values(&s->world->picture);
    }
    return wrong;
}

/* The poles, both sides of 180 degrees, anywhere: the picture is that of home. */
static double elsewhere(void *user, bool quick)
{
    const Street    *s = user;
    const double     none[3] = {0}, eye[3] = {-50, -40, 12}, d[3] = {0.7, 0.6, -0.2};
    const LocalFrame home = s->one->world.frame;
    double           wrong = 0;
    Dice             dice = {.stream = 71};
    if (!draw(s->world, eye, d, none, 0)) return INFINITY;
    for (int n = quick ? 4 : 60; n > 0; n--) {
        const Geodetic place = {n % 4 == 0   ? 0.5 * pi_rad
                                : n % 4 == 1 ? -0.5 * pi_rad
                                             : stress_uniform(&dice, -1.57, 1.57),
                                n % 4 == 2 ? (n % 8 == 2 ? 1 : -1) * (pi_rad - 1e-9) : stress_uniform(&dice, -3, 3),
                                stress_uniform(&dice, -400, 9000)};
        if (local_frame_at(&s->one->world.frame, &place) != STATUS_OK || !draw(s->one, eye, d, none, 0))
            wrong = INFINITY;
        else wrong += stress_differences(&s->world->picture, 0, 0, &s->one->picture, 0, 0, street_px, street_px);
    }
    s->one->world.frame = home;
    return wrong;
}

/* The whole street up to 200 km from the origin: pixels that show another part, or lie elsewhere by 1e-4 of the range.
 */
static double far_away(void *user, bool quick)
{
    const Street *s = user;
    const double  none[3] = {0}, eye[3] = {-50, -40, 12}, d[3] = {0.7, 0.6, -0.2};
    double        wrong = 0;
    Dice          dice = {.stream = 72};
    if (!draw(s->world, eye, d, none, 0)) return INFINITY;
    for (int n = quick ? 1 : 8; n > 0; n--) {
        double         away[3] = {0};
        SceneryTracer *tracer = s->one->world.scenery;
        Scenery        moved = s->scenery;
        stress_direction(away, &dice);
        v3_scale(away, n % 2 ? 200e3 : stress_log_uniform(&dice, 1e3, 200e3), away);
        moved.object = calloc((size_t)moved.objects, sizeof *moved.object);
        if (!moved.object) return INFINITY;
        memcpy(moved.object, s->scenery.object, (size_t)moved.objects * sizeof *moved.object);
        for (int k = 0; k < moved.objects; k++) v3_add(moved.object[k].p_enu, moved.object[k].p_enu, away);
        if (world_scenery(&s->one->world, &moved, NULL, NULL) != STATUS_OK || !draw(s->one, eye, d, away, 0))
            wrong = INFINITY;
        const Picture *a = &s->world->picture, *b = &s->one->picture;
        for (int i = 0; i < street_px * street_px && isfinite(wrong); i++)
            wrong += a->part[i] != b->part[i] ||
                     (isfinite(a->range_m[i]) && !(fabsf(a->range_m[i] - b->range_m[i]) <= 1e-4f * a->range_m[i]));
        if (s->one->world.scenery != tracer) scenery_tracer_destroy(s->one->world.scenery);
        s->one->world.scenery = tracer;
        free(moved.object);
    }
    return wrong;
}

/* An eye at 0.1 m, down to 1 um, from the wall that it looks at squarely: its range, relative. */
static double by_a_wall(void *user, bool quick)
{
    const Street *s = user;
    const double  none[3] = {0};
    double        worst = 0;
    int           met = 0;
    Dice          dice = {.stream = 73};
    for (int n = 0; n < (quick ? 8 : 100); n++) {
        double    eye[3], d[3], normal[3];
        const int middle = street_px * street_px / 2 + street_px / 2;
        eye_of(eye, d, &dice);
        d[2] = 0, eye[2] = stress_uniform(&dice, 0.5, 2.5);
        if (!draw(s->world, eye, d, none, 0)) return INFINITY;
        const Picture *p = &s->world->picture;
        double         ray[3];
        if (!p->part[middle]) continue;
        const View view = stress_view(eye, d, 0, street_px, street_px, 60);
        view_ray(ray, &view, street_px / 2 + 0.5, street_px / 2 + 0.5);
        for (int k = 0; k < 3; k++) normal[k] = (double)p->normal[k][middle];
        const double off_m = n % 2 ? 0.1 : stress_log_uniform(&dice, 1e-6, 1), towards = v3_dot(ray, normal);
        for (int k = 0; k < 3; k++) eye[k] += ray[k] * ((double)p->range_m[middle] - off_m / fmax(fabs(towards), 0.05));
        if (!draw(s->world, eye, d, none, 0)) return INFINITY;
        /* along the same ray, of which a float's range told the length: 6e-8 of up to 100 m */
        const double told = off_m / fmax(fabs(towards), 0.05), is = (double)s->world->picture.range_m[middle];
        if (!(stress_bad_values(&s->world->picture) == 0)) return INFINITY;
        if (told > 1e-3 && s->world->picture.part[middle]) worst = fmax(worst, fabs(is - told) / (told + 1)), met++;
    }
    return met > 0 ? worst : INFINITY;
}

/* Within houses: the eye at random places of their boxes. */
static double inside(void *user, bool quick)
{
    const Street *s = user;
    const double  none[3] = {0};
    double        wrong = 0;
    int           within = 0;
    Dice          dice = {.stream = 74};
    for (int n = quick ? 20 : 300; n > 0; n--) {
        double eye[3], d[3];
        eye_of(eye, d, &dice);
        eye[2] = stress_uniform(&dice, 0.3, 2.8);
        if (!draw(s->world, eye, d, none, 0)) return INFINITY;
        wrong += stress_bad_values(&s->world->picture);
        const int middle = street_px * street_px / 2;
        within += s->world->picture.part[middle] && s->world->picture.range_m[middle] < 12;
    }
    return within > 0 ? wrong : INFINITY;
}

/* Every part and side of it, every hour of two days: temperatures that are none of this Earth's. */
static double every_hour(void *user, bool quick)
{
    Street    *s = user;
    World     *world = &s->world->world;
    Arena     *arena = arena_create();
    HeatConfig config = heat_default_config();
    double     wrong = 0;
    config.unix_s = 1782000000;
    if (!arena || world_warm_clear(world, &config, 0, s->world->pool) != STATUS_OK ||
        world_warm_scenery(world, &s->scenery, &config, NULL, s->world->pool) != STATUS_OK)
        wrong = INFINITY;
    for (int hour = 0; hour < (quick ? 6 : 48) && isfinite(wrong); hour++) {
        SceneryTemps *temps;
        arena_reset(arena);
        if (world_scenery_temps(&temps, world, config.unix_s + 3600 * hour, arena) != STATUS_OK) wrong = INFINITY;
        for (int k = 0; k < s->scenery.objects && isfinite(wrong); k++) {
            const SceneryObject *o = &s->scenery.object[k];
            const Model         *model = &s->scenery.model[o->model];
            for (int t = 0; t < model->triangle_count; t += 7) {
                double n_enu[3], n[3];
                for (int i = 0; i < 3; i++) n[i] = (double)model->normal[model->triangle[t][0]][i];
                m3_mul_v3(n_enu, o->r_enu_from_body, n);
                const double temp_k =
                    scenery_temp_k(temps, k, model->triangle_part[t], model->vertex[model->triangle[t][0]], n_enu);
                wrong += !(temp_k > 230 && temp_k < 370);
            }
        }
    }
    world_cool(world);
    arena_destroy(arena);
    return wrong;
}

static Status open_street(Street *s, StressWorld worlds[2], int threads)
{
    const TownOf of = {.buildings = 25, .clutter = 20, .seed = 4};
    Status       status = stress_world_open(&worlds[0], threads);
    if (status == STATUS_OK) status = stress_world_open(&worlds[1], 1);
    if (status == STATUS_OK) status = town_create(&s->scenery, &of);
    for (int k = 0; k < 2 && status == STATUS_OK; k++)
        status = world_scenery(&worlds[k].world, &s->scenery, NULL, worlds[k].pool);
    s->world = &worlds[0], s->one = &worlds[1];
    return status;
}

Status bench_stability_scenery(Bench *bench)
{
    static const StressCase cases[] = {
        {"scenery: eyes in a street, above it and in its houses", on_one_thread, 0, "values",
         "one thread, nothing skipped; finite, not below 0"},
        {"scenery: at the poles, at 180 degrees, anywhere", elsewhere, 0, "values", "the same street at home"},
        {"scenery: 1 .. 200 km from the origin", far_away, 0, "px", "the same street at the origin"},
        {"scenery: an eye at 1 um .. 1 m from a wall", by_a_wall, 1e-5, "m/(m + 1)", "where it was put"},
        {"scenery: eyes within houses", inside, 0, "values", "finite, not below 0"},
        {"scenery: temperatures of two days, by the hour", every_hour, 0, "values", "230 .. 370 K"},
    };
    StressWorld  worlds[2] = {0};
    Street       street = {0};
    const Status status = open_street(&street, worlds, bench_threads(bench));
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &street);
    for (int k = 0; k < 2; k++) stress_world_close(&worlds[k]);
    scenery_free(&street.scenery);
    return status;
}
