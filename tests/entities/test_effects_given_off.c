/* What entities give off by their engines and by each bit of their appearance. */
#include "tests/entities/entity_fixture.h"
#include "entities/table/entity_index.h"

/* A running engine gives off gas behind its outlet, as much as it drives, bounded; a stopped one none; and any instant
 * has its puffs whatever was asked before. The wind takes them along, and they cool and thin out together. */
static void engines_give_off_gas(void **state)
{
    (void)state;
    static EffectPuff first[8];
    Fixture           f = fixture_open(NULL);
    DisEntityState    tank = report(1, tank_type), craft = report(2, helicopter_type);
    craft.p_ecef[0] += 100;
    craft.p_ecef[1] += 500;
    hear(&f, &tank, 0);
    seen_at(&f, 1, 1);
    CHECK(f.snapshot.puff_count == 0); /* stands, and has no power-plant bit */
    tank.appearance = power_plant_bit;
    hear(&f, &tank, 1);
    hear(&f, &craft, 1);
    seen_at(&f, 1, 2);
    int count = 0, turbine = 0;
    for (int i = 0; i < f.snapshot.puff_count; i++) {
        turbine += f.snapshot.puff[i].kind == EFFECT_TURBINE_EXHAUST;
        if (f.snapshot.puff[i].kind != EFFECT_EXHAUST) continue;
        CHECK(count < 8);
        first[count++] = f.snapshot.puff[i];
    }
    CHECK(count == 5 && turbine == 5 && f.snapshot.puff_count == 10);
    const Weather    still = {.air_temp_k = 288.15}, wind = {.air_temp_k = 288.15, .wind_mps = 5, .wind_from_rad = 0};
    const LocalFrame frame = frame_here();
    double           before_k = INFINITY, before_kg_m3 = INFINITY;
    for (int i = 1; i < count; i++) { /* the first one grows in */
        EffectVolume a, b;
        CHECK(effect_volume(&a, f.snapshot.effect_table, &first[i], &still, &frame));
        CHECK(effect_volume(&b, f.snapshot.effect_table, &first[i], &wind, &frame));
        CHECK_NEAR(a.p_enu[1] - b.p_enu[1], 5 * first[i].age_s, 1e-9); /* a north wind: to the south */
        CHECK(a.temp_k > 288.15 && a.temp_k < before_k && a.co2_kg_m3 < before_kg_m3);
        CHECK(a.co2_kg_m3 > 2 * a.h2o_kg_m3);
        for (int c = 0; c < effect_band_mwir; c++) CHECK(a.extinction_per_m[c] == 0);
        CHECK(v3_length(a.p_enu) < 12);
        before_k = a.temp_k;
        before_kg_m3 = a.co2_kg_m3;
    }
    seen_at(&f, 1, 2.7);
    seen_at(&f, 1, 2);
    int same = 0;
    for (int i = 0; i < f.snapshot.puff_count; i++)
        if (f.snapshot.puff[i].kind == EFFECT_EXHAUST) {
            CHECK(memcmp(&f.snapshot.puff[i], &first[same], sizeof *first) == 0);
            same++;
        }
    CHECK(same == count);
    tank.appearance = craft.appearance = destroyed_bits;
    hear(&f, &tank, 3);
    hear(&f, &craft, 3);
    seen_at(&f, 1, 4);
    CHECK(f.snapshot.puff_count == 0);
    fixture_close(&f);
}

static int of_kind_in(const Snapshot *s, EffectKind kind)
{
    int n = 0;
    for (int i = 0; i < s->puff_count; i++) n += s->puff[i].kind == kind;
    return n;
}

/* The mass of exhaust is that of its row by the engine's share of full power and the size of the vehicle: 0.6 at idle,
 * 0.8 at 5 m/s, 1 at 10 m/s and beyond. Over a whole interval of emission (the first puff grows in) it is the row's
 * kg/s by the five and a half intervals of its life, of which the first is present in proportion. */
static void exhaust_is_as_much_as_the_engine_drives(void **state)
{
    (void)state;
    static const float  speed_mps[] = {0, 5, 10, 20};
    static const double share[] = {0.6, 0.8, 1, 1};
    Fixture             f = fixture_open(NULL);
    for (int k = 0; k < 4; k++) {
        DisEntityState tank = report(1 + k, tank_type);
        tank.appearance = power_plant_bit;
        tank.velocity_mps[2] = speed_mps[k];
        hear(&f, &tank, 0);
    }
    const SnapshotEntity *e = seen_at(&f, 1, 1);
    const Model          *model = catalog_model(f.catalog, e->model);
    const double          size = cbrt(model->length_m * model->width_m * model->height_m / 40); /* 1 for 40 m3 */
    const EffectModel    *law = &f.snapshot.effect_table->law[EFFECT_EXHAUST];
    const double          interval_s = law->life_s / 5.5, phase = 1 / interval_s - floor(1 / interval_s);
    for (int k = 0; k < 4; k++) {
        double kg = 0;
        for (int i = 0; i < f.snapshot.puff_count; i++)
            if (f.snapshot.puff[i].owner == entity_key(entity_id(1 + k)) + 1) kg += f.snapshot.puff[i].mass_kg;
        const double want_kg = law->mass_kg * share[k] * size * size * interval_s * (4 + phase);
        CHECK_NEAR(kg, want_kg, 1e-6 * want_kg);
    }
    fixture_close(&f);
}

/* What each bit of the appearance gives off: smoke bits 1 a plume, 2 engine smoke, 3 both; a trail is dust of what
 * drives, a contrail of what flies, smoke of a munition's motor, nothing of a person, and the after burner is of what
 * flies alone. Trails of the sizes small, medium and large have 0.35, 1 and 2.5 times the mass. */
static void each_bit_has_its_effect(void **state)
{
    (void)state;
    static const uint32_t afterburner = UINT32_C(1) << dis_appearance_afterburner_bit;
    static const struct {
        DisEntityType type;
        uint32_t      bits;
        EffectKind    is;
    } c[] = {{{1, 1, 222, 1, 1, 1, 0}, 1 << 5, EFFECT_SMOKE},
             {{1, 1, 222, 1, 1, 1, 0}, 2 << 5, EFFECT_ENGINE_SMOKE},
             {{1, 1, 222, 1, 1, 1, 0}, 2 << 7, EFFECT_DUST},
             {{1, 2, 225, 1, 1, 0, 0}, 2 << 7, EFFECT_CONTRAIL},
             {{2, 2, 225, 1, 1, 3, 0}, 2 << 7, EFFECT_MOTOR_SMOKE},
             {{1, 2, 225, 1, 1, 0, 0}, afterburner, EFFECT_AFTERBURNER},
             {{1, 1, 222, 1, 1, 1, 0}, afterburner, EFFECT_EXHAUST},
             {{3, 1, 225, 1, 0, 0, 0}, 2 << 7, EFFECT_KIND_COUNT}};
    static const EffectKind kinds[] = {EFFECT_SMOKE, EFFECT_ENGINE_SMOKE, EFFECT_DUST, EFFECT_CONTRAIL,
                                       EFFECT_AFTERBURNER};
    static const double     trail[] = {0, 0.35, 1, 2.5};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState pdu = report(1, c[i].type);
        pdu.appearance = c[i].bits;
        pdu.velocity_mps[2] = 50;
        hear(&f, &pdu, 0);
        seen_at(&f, 1, 4);
        for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
            CHECK((of_kind_in(&f.snapshot, kinds[k]) > 0) == (kinds[k] == c[i].is));
        if (c[i].is != EFFECT_KIND_COUNT) CHECK(of_kind_in(&f.snapshot, c[i].is) > 0);
        fixture_close(&f);
    }
    Fixture f = fixture_open(NULL);
    double  kg[4] = {0};
    for (int size = 0; size < 4; size++) {
        DisEntityState pdu = report(1, tank_type);
        pdu.appearance = (uint32_t)size << 7;
        pdu.velocity_mps[2] = 8;
        hear(&f, &pdu, 100 * size); /* later than any timeout */
        seen_at(&f, 1, 100 * size + 4);
        for (int i = 0; i < f.snapshot.puff_count; i++)
            if (f.snapshot.puff[i].kind == EFFECT_DUST && f.snapshot.puff[i].age_s <= 4)
                kg[size] += f.snapshot.puff[i].mass_kg;
        CHECK_NEAR(kg[size], size == 0 ? 0 : kg[1] / 0.35 * trail[size], 1e-9);
        CHECK(size == 0 || kg[size] > 0);
    }
    fixture_close(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_give_off_gas),
        cmocka_unit_test(exhaust_is_as_much_as_the_engine_drives),
        cmocka_unit_test(each_bit_has_its_effect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
