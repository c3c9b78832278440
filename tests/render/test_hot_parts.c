/* Exhausts of clutter that are narrower than a pixel: in-band intensity of a plate of 0.12 m x 0.2 m whose engine runs,
 * against emissivity times Planck's radiance times its area, wherever the pixels fall; and of one whose engine never
 * ran, which one ray a pixel meets or misses. No air, no ground. labels: unit */
#include "tests/render/hand_world.h"

static const double eye_enu[3] = {0, 0, 3000};
static const double half_y_m = 0.06, half_z_m = 0.1, focal_px = 2667; /* 0.375 mrad a pixel */
enum { side_px = 32, shifts = 64 };

static struct {
    Model         model;
    SceneryObject object;
    SceneryState  state;
    Scenery       scenery;
} clutter;

static int open_world(void **state)
{
    static const double sun_enu[3] = {-0.6, 0, 0.8};
    (void)state;
    if (hand_open(false) != 0) return -1;
    hand_air_off(sun_enu);
    return 0;
}

/* One plate at this range, east of the eye and facing it. */
static void put(double range_m, float engine, float stood_s, HeatRole role)
{
    hand_plate(&clutter.model, half_y_m, half_z_m);
    strcpy(clutter.model.name, "plate"), strcpy(clutter.model.node[0].name, "node");
    strcpy(clutter.model.part[0].name, "exhaust"), strcpy(clutter.model.part[0].material, "brick_red");
    clutter.model.part[0].role = role;
    model_measure(&clutter.model);
    clutter.state = (SceneryState){.drives.engine = engine, .stood_s = stood_s};
    clutter.object = (SceneryObject){.id = 1,
                                     .kind = SCENERY_CLUTTER,
                                     .class = CLUTTER_GENERATOR,
                                     .p_enu = {range_m, 0, eye_enu[2] - half_z_m},
                                     .r_enu_from_body = {-1, 0, 0, 0, 1, 0, 0, 0, -1}};
    clutter.scenery = (Scenery){.models = 1,
                                .objects = 1,
                                .states = 1,
                                .model = &clutter.model,
                                .object = &clutter.object,
                                .state = &clutter.state};
    assert_int_equal(world_scenery(&hand.world, &clutter.scenery, "avx2", hand.pool), STATUS_OK);
}

static void take_away(void)
{
    scenery_tracer_destroy(hand.world.scenery);
    hand.world.scenery = NULL;
    model_destroy(&clutter.model);
}

typedef struct Seen {
    double mean, rms, least; /* of the intensity, in units of the answer; rms: about 1 */
} Seen;

/* Its intensity over shifts of the axis by up to half a pixel each way. */
static Seen look(int plane, double range_m)
{
    const Band   band = picture_band(plane);
    const double want_w_sr = hand_emitted(band) * 4 * half_y_m * half_z_m;
    Seen         seen = {.least = INFINITY};
    for (int k = 0; k < shifts; k++) {
        const double  d_enu[3] = {1, (random_uniform(7, 0, 0, (uint64_t)k) - 0.5) / focal_px,
                                  (random_uniform(7, 1, 0, (uint64_t)k) - 0.5) / focal_px};
        const View    view = hand_view(eye_enu, d_enu, side_px, side_px, focal_px);
        RenderRequest request = hand_request(&view);
        double        sum = 0;
        hand_clear();
        arena_reset(hand.arena);
        const Picture picture = hand_render(&request, hand.pool);
        const float  *value = picture_plane(&picture, plane);
        for (int i = 0; i < side_px * side_px; i++) sum += (double)value[i];
        const double got = sum * range_m * range_m / (focal_px * focal_px) / want_w_sr;
        seen.mean += got / shifts, seen.rms += (got - 1) * (got - 1) / shifts;
        seen.least = fmin(seen.least, got);
    }
    seen.rms = sqrt(seen.rms);
    return seen;
}

/* rms_most: of 64 samples a pixel some 17 meet it at 800 m, and 2 at 2400 m, where it is 0.13 x 0.22 px. */
static void exhausts_are_never_lost(void **state)
{
    static const struct {
        double range_m, rms_most;
    } at[] = {{400, 0.08}, {800, 0.12}, {1200, 0.2}, {2400, 0.4}};
    (void)state;
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        put(at[k].range_m, 0.6F, 0, HEAT_EXHAUST);
        for (int plane = picture_mwir; plane <= picture_lwir; plane++) {
            const Seen seen = look(plane, at[k].range_m);
            print_message("%4.0f m, plane %d: mean %.3f, rms %.3f, least %.3f of the answer\n", at[k].range_m, plane,
                          seen.mean, seen.rms, seen.least);
            CHECK(fabs(seen.mean - 1) < 3 * at[k].rms_most / sqrt(shifts) + 0.01 && seen.rms < at[k].rms_most);
            CHECK(seen.least > 0.3);
        }
        take_away();
    }
}

/* What is not hot is sampled as all else: lost in most frames, and a pixel of it in the others. */
static void cold_parts_cost_nothing(void **state)
{
    static const struct {
        float    engine, stood_s;
        HeatRole role;
    } of[] = {{0, 0, HEAT_EXHAUST}, {0.6F, 86400, HEAT_EXHAUST}, {0.6F, 0, HEAT_PASSIVE}};
    (void)state;
    for (int k = 0; k < 3; k++) {
        put(2400, of[k].engine, of[k].stood_s, of[k].role);
        const Seen seen = look(picture_lwir, 2400);
        print_message("cold: rms %.2f of the answer\n", seen.rms);
        CHECK(seen.rms > 1.5 && seen.least == 0);
        take_away();
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exhausts_are_never_lost),
        cmocka_unit_test(cold_parts_cost_nothing),
    };
    return cmocka_run_group_tests(tests, open_world, hand_close);
}
