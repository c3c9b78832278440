/* Smoke of fires and heaps of clutter: the mass that hangs over one is what it gives off, it drifts as the wind goes,
 * what it lets through follows from the row's extinction, heaps and fires beyond the limits have none, and nothing else
 * smokes. */
#include "tests/check.h"

#include "entities/scenery/scenery_smoke.h"
#include "entities/shapes/parametric.h"
#include "entities/traces/effect_history.h"

#include <stdlib.h>

enum { most = 400 };

static struct {
    EffectTable   table;
    LocalFrame    frame;
    Model         model[3];
    SceneryObject object[most];
    Scenery       scenery;
    Arena        *arena;
} stage;

static int open_stage(void **state)
{
    (void)state;
    static const char *const shape[3] = {"campfire", "smoulder", "car"};
    const Geodetic           origin = {0.8, 0.2, 500};
    char                     path[512];
    stage.arena = arena_create();
    for (int k = 0; k < 3; k++)
        if (parametric_build(&stage.model[k], shape[k], 0.01) != STATUS_OK) return -1;
    stage.scenery = (Scenery){.models = 3, .model = stage.model, .object = stage.object, .smokes = true};
    return etc_path(path, sizeof path, "effects.csv") && effect_table_open(&stage.table, path) == STATUS_OK &&
                   local_frame_at(&stage.frame, &origin) == STATUS_OK
               ? 0
               : -1;
}

static int close_stage(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) model_destroy(&stage.model[k]);
    arena_destroy(stage.arena);
    return 0;
}

static void place(int k, SceneryClass class, double east_m)
{
    stage.object[k] = (SceneryObject){.id = (uint64_t)k + 7,
                                      .kind = SCENERY_CLUTTER,
                                      .class = (uint8_t) class,
                                      .model = class == CLUTTER_FIRE   ? 0
                                               : class == CLUTTER_HEAP ? 1
                                                                       : 2,
                                      .p_enu = {east_m, 0, 3},
                                      .r_enu_from_body = {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    stage.scenery.objects = k + 1;
}

static Snapshot smoke_at(double t_s, const double eye_enu[3])
{
    Snapshot s = {.t_s = t_s, .effect_table = &stage.table};
    assert_int_equal(scenery_smoke(&s, &stage.scenery, &stage.frame, eye_enu, stage.arena), STATUS_OK);
    return s;
}

/* Their mass is the row's a second, times the size squared, over their life. */
static void mass_is_what_is_given_off(void **state)
{
    (void)state;
    for (int heap = 0; heap < 2; heap++) {
        const EffectKind kind = heap ? EFFECT_SMOULDER_SMOKE : EFFECT_WOOD_SMOKE;
        const Model     *m = &stage.model[heap];
        const double     scale = fmax(m->length_m, m->width_m) / (heap ? 3 : 1.2);
        double           mass_kg = 0;
        place(0, heap ? CLUTTER_HEAP : CLUTTER_FIRE, 10);
        const Snapshot s = smoke_at(1234.5, (const double[3]){0, 0, 50});
        for (int i = 0; i < s.puff_count; i++) {
            CHECK(s.puff[i].kind == kind && s.puff[i].group == s.puff[0].group);
            mass_kg += s.puff[i].mass_kg;
        }
        const double given_kg = stage.table.law[kind].mass_kg * stage.table.law[kind].life_s * scale * scale;
        print_message("%s: %d puffs, %.3g kg of %.3g\n", heap ? "heap" : "fire", s.puff_count, mass_kg, given_kg);
        CHECK(s.puff_count > 20 && s.puff_count < 100 && fabs(mass_kg / given_kg - 1) < 0.08);
    }
}

/* A puff is where the wind has carried it since it left: wind times age, and up. */
static void it_drifts_by_the_wind(void **state)
{
    (void)state;
    Weather weather = {.air_temp_k = 288, .wind_mps = 4, .wind_from_rad = 1.5 * pi_rad}; /* from the west */
    place(0, CLUTTER_HEAP, 10);
    const Snapshot s = smoke_at(77, (const double[3]){0, 0, 50});
    double         farthest_m = 0;
    for (int i = 0; i < s.puff_count; i++) {
        EffectVolume v;
        if (!effect_volume(&v, &stage.table, &s.puff[i], &weather, &stage.frame)) continue;
        const double way_m = v.p_enu[0] - 10;
        CHECK(fabs(way_m - 4 * s.puff[i].age_s) < 3.5 && fabs(v.p_enu[1]) < 3.5 && v.p_enu[2] > 3);
        farthest_m = fmax(farthest_m, way_m);
        /* extinction by band, as the row has it: more of short waves */
        const EffectModel *law = &stage.table.law[EFFECT_SMOULDER_SMOKE];
        for (int b = 0; b < effect_band_count; b++)
            CHECK(fabs(v.extinction_per_m[b] * law->extinction_m2_kg[effect_band_g] -
                       v.extinction_per_m[effect_band_g] * law->extinction_m2_kg[b]) < 1e-9);
        CHECK(v.extinction_per_m[effect_band_b] > 10 * v.extinction_per_m[effect_band_lwir]);
    }
    CHECK(farthest_m > 150);
}

/* No more than the limit, the nearest; none far off; the same at the same time. */
static void its_number_is_bounded(void **state)
{
    (void)state;
    const double eye[3] = {0, 0, 50};
    for (int k = 0; k < most; k++) place(k, k % 2 ? CLUTTER_HEAP : CLUTTER_FIRE, 30.0 * (most - k));
    const Snapshot s = smoke_at(50, eye), again = smoke_at(50, eye);
    CHECK(s.puff_count == again.puff_count && s.puff_count <= effect_puff_capacity);
    double farthest_m = 0;
    for (int i = 0; i < s.puff_count; i++) {
        double p_enu[3];
        CHECK(memcmp(s.puff[i].p_ecef, again.puff[i].p_ecef, sizeof s.puff[i].p_ecef) == 0);
        enu_from_ecef(p_enu, &stage.frame, s.puff[i].p_ecef);
        farthest_m = fmax(farthest_m, p_enu[0]);
    }
    print_message("%d puffs of %d fires, to %.0f m\n", s.puff_count, (int)scenery_smokes_most, farthest_m);
    CHECK(farthest_m > 30.0 * scenery_smokes_most - 5 && farthest_m < 30.0 * scenery_smokes_most + 5);
    /* behind those that are there, up to the limit */
    static EffectPuff there[effect_puff_capacity - 5];
    Snapshot full = {.t_s = 50, .effect_table = &stage.table, .puff = there, .puff_count = effect_puff_capacity - 5};
    assert_int_equal(scenery_smoke(&full, &stage.scenery, &stage.frame, eye, stage.arena), STATUS_OK);
    CHECK(full.puff_count == effect_puff_capacity);
    stage.scenery.smokes = false;
    CHECK(smoke_at(50, eye).puff_count == 0);
    stage.scenery.smokes = true;
    place(0, CLUTTER_CAR, 10);
    CHECK(smoke_at(50, eye).puff_count == 0);
    place(0, CLUTTER_FIRE, scenery_smokes_m + 10);
    CHECK(smoke_at(50, eye).puff_count == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(mass_is_what_is_given_off),
                                       cmocka_unit_test(it_drifts_by_the_wind),
                                       cmocka_unit_test(its_number_is_bounded)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
