/* What bursts, burns and trails: closed forms against their own formulae, histories against counts on paper. */
#include "tests/entities/entity_fixture.h"
#include "entities/traces/effect_history.h"

static const uint32_t flaming_bit = UINT32_C(1) << 15, plume_bit = UINT32_C(1) << 5, dust_bits = UINT32_C(2) << 7;

static EffectHistory *open_history(void)
{
    EffectHistory *history = NULL;
    char           path[512];
    CHECK(etc_path(path, sizeof path, "effects.csv"));
    CHECK(effect_history_create(&history, path) == STATUS_OK);
    return history;
}

static DisDetonation burst_here(int number, uint8_t result)
{
    return (DisDetonation){.munition = entity_id(number),
                           .event = {1, 3001, (uint16_t)number},
                           .p_ecef = {earth_radius_m + 2, 0, 0},
                           .velocity_mps = {0, 300, 0},
                           .result = result,
                           .descriptor = {{2, 2, 225, 1, 1, 3, 0}, 1000, 1000, 1, 0}};
}

static DisFire shot_here(int number)
{
    return (DisFire){.firing = entity_id(number),
                     .event = {1, 3001, (uint16_t)number},
                     .p_ecef = {earth_radius_m + 2, 0, 0},
                     .velocity_mps = {0, 0, 1500},
                     .descriptor = {{2, 2, 225, 2, 1, 1, 0}, 1000, 1000, 1, 0}};
}

static EffectPuff puffs[effect_puff_capacity];
static int        puffs_at(const EffectHistory *h, double t_s)
{
    return (int)effect_history_puffs(puffs, effect_puff_capacity, h, t_s);
}

static int of_kind(int count, EffectKind kind)
{
    int n = 0;
    for (int i = 0; i < count; i++) n += puffs[i].kind == kind;
    return n;
}

/* ---- one puff ----------------------------------------------------------------------------- */

static EffectPuff puff_of(EffectKind kind, double age_s, double scale)
{
    return (EffectPuff){.kind = kind,
                        .age_s = age_s,
                        .p_ecef = {earth_radius_m, 0, 0},
                        .up_ecef = {1, 0, 0},
                        .axis_ecef = {1, 0, 0},
                        .throw_s = 1,
                        .scale = scale,
                        .mass_kg = 0.5};
}

/* From the south-west at 5 m/s: to the north-east, at full speed from the first moment, at any age. */
static void drift_is_wind_times_age(void **state)
{
    (void)state;
    EffectHistory   *h = open_history();
    const LocalFrame frame = frame_here();
    Weather          weather = weather_default(), calm = weather;
    weather.wind_mps = 5;
    weather.wind_from_rad = 225 * rad_per_deg;
    calm.wind_mps = 0;
    for (double age_s = 0; age_s < 30; age_s += 3.7) {
        const EffectPuff puff = puff_of(EFFECT_SMOKE, age_s, 1);
        EffectVolume     blown, still;
        CHECK(effect_volume(&blown, effect_history_table(h), &puff, &weather, &frame));
        CHECK(effect_volume(&still, effect_history_table(h), &puff, &calm, &frame));
        /* 1e-8 m: a metre in ECEF has 1 nm */
        CHECK_NEAR(blown.p_enu[0] - still.p_enu[0], 5 * age_s * sqrt(0.5), 1e-8);
        CHECK_NEAR(blown.p_enu[1] - still.p_enu[1], 5 * age_s * sqrt(0.5), 1e-8);
        CHECK_NEAR(blown.p_enu[2], still.p_enu[2], 1e-8);
        const EffectModel *law = &effect_history_table(h)->law[EFFECT_SMOKE];
        CHECK_NEAR(still.p_enu[2], law->rise_mps * law->rise_s * (1 - exp(-age_s / law->rise_s)), 1e-7);
    }
    effect_history_destroy(h);
}

/* Mass over the spheroid's volume is what the extinction is of: integrated back, it is all there. */
static void extinction_holds_its_mass(void **state)
{
    (void)state;
    EffectHistory   *h = open_history();
    const LocalFrame frame = frame_here();
    const Weather    weather = weather_default();
    EffectPuff       puff = puff_of(EFFECT_BURST_DUST, 0, 1.5);
    puff.along_m = 9;
    EffectVolume v;
    CHECK(effect_volume(&v, effect_history_table(h), &puff, &weather, &frame));
    const EffectModel *law = &effect_history_table(h)->law[EFFECT_BURST_DUST];
    /* integral of (1 - q^2)^2 over the ball by a thousand shells */
    double sum = 0;
    for (int i = 0; i < 1000; i++) {
        const double q = (i + 0.5) / 1000, f = 1 - q * q;
        sum += 4 * pi_rad * q * q * f * f / 1000;
    }
    const double kg = v.extinction_per_m[effect_band_lwir] / law->extinction_m2_kg[effect_band_lwir] * sum *
                      v.across_m * v.across_m * v.along_m;
    CHECK_NEAR(kg, 0.5, 0.5 * 1e-5); /* midpoint rule of 1000 shells: 1e-6 */
    CHECK_NEAR(v.along_m, 9, 0);
    effect_history_destroy(h);
}

/* The flash cools and ends as its row says, in time with the cube root of the charge. */
static void flash_has_its_time_course(void **state)
{
    (void)state;
    EffectHistory     *h = open_history();
    const LocalFrame   frame = frame_here();
    const Weather      weather = weather_default();
    const EffectModel *law = &effect_history_table(h)->law[EFFECT_MUZZLE_FLASH];
    for (double scale = 0.5; scale <= 2; scale *= 2) {
        EffectVolume v;
        double       before_k = INFINITY;
        for (double age_s = 0; age_s < law->life_s * scale; age_s += 0.01 * scale) {
            const EffectPuff puff = puff_of(EFFECT_MUZZLE_FLASH, age_s, scale);
            CHECK(effect_volume(&v, effect_history_table(h), &puff, &weather, &frame));
            CHECK_NEAR(v.temp_k, 288.15 + law->temp_rise_k * exp(-age_s / (law->cool_s * scale)), 1e-9);
            CHECK(v.temp_k < before_k);
            before_k = v.temp_k;
        }
        const EffectPuff over = puff_of(EFFECT_MUZZLE_FLASH, law->life_s * scale, scale);
        CHECK(!effect_volume(&v, effect_history_table(h), &over, &weather, &frame));
        CHECK(effect_life_s(effect_history_table(h), EFFECT_MUZZLE_FLASH, scale) < 0.2);
    }
    effect_history_destroy(h);
}

/* ---- events ------------------------------------------------------------------------------- */

static void results_burst_in_their_way(void **state)
{
    (void)state;
    static const struct {
        uint8_t result;
        bool    fire, smoke, dust;
    } want[] = {{1, true, true, true},     {2, true, true, false},   {3, true, true, true},  {5, true, true, false},
                {6, false, false, false},  {12, true, true, true},   {19, true, true, true}, {30, true, true, false},
                {31, false, false, false}, {33, false, false, false}};
    double dust_kg[16] = {0};
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        EffectHistory      *h = open_history();
        const DisDetonation pdu = burst_here(7, want[i].result);
        effect_history_detonation(h, &pdu, 100);
        CHECK(puffs_at(h, 99.999) == 0); /* not before it */
        int n = puffs_at(h, 100.4);
        CHECK((of_kind(n, EFFECT_FIREBALL) > 0) == want[i].fire);
        CHECK((of_kind(n, EFFECT_BURST_SMOKE) > 0) == want[i].smoke);
        CHECK((of_kind(n, EFFECT_BURST_DUST) > 0) == want[i].dust);
        for (int p = 0; p < n; p++)
            if (puffs[p].kind == EFFECT_BURST_DUST) dust_kg[i] += puffs[p].mass_kg;
        n = puffs_at(h, 100.005);
        CHECK((of_kind(n, EFFECT_BURST_FLASH) > 0) == want[i].fire);
        CHECK((puffs_at(h, 120) > 0) == want[i].fire && of_kind(puffs_at(h, 120), EFFECT_FIREBALL) == 0);
        CHECK(puffs_at(h, 200) == 0);
        effect_history_destroy(h);
    }
    CHECK(dust_kg[2] > 3 * dust_kg[0]); /* the ground is dustier than a vehicle */
    EffectHistory *h = open_history();
    DisDetonation  rod = burst_here(8, 1);
    rod.descriptor.warhead = 5000;
    effect_history_detonation(h, &rod, 0);
    const int n = puffs_at(h, 0.05);
    CHECK(of_kind(n, EFFECT_SPARKS) > 0 && of_kind(n, EFFECT_FIREBALL) == 0); /* a penetrator does not explode */
    effect_history_destroy(h);
}

/* Every value of the Detonation Result enumeration (SISO-REF-010, UID 62), by its name: 3 ground impact, 4 ground
 * proximate, 11 .. 13 dirt blast small, medium, large: on the ground; 1 entity impact, 7 .. 9 HE hit small, medium,
 * large, 10 armour-piercing hit, 18 .. 20 building hit: on a thing; 14 .. 16 water blast, 24 water impact: in water; 6
 * none, 31 .. 33 misses: nothing. The others, and numbers that have no name, in the air: 0 other, 2 entity proximate, 5
 * detonation, 17 air hit, 21 line charge, 22 and 23 environment object, 25 air burst, 26 .. 30 kills with fragments.
 * What each makes is in the order of fireballs, clouds of smoke, clouds of dust at 0.1 s; all of it is of the ground,
 * or none. */
static void every_result_bursts_by_its_name(void **state)
{
    (void)state;
    static const char named[] = "aeagganeeeegggwwwaeeeaaawaaaaaannn"; /* 0 .. 33 */
    for (int result = 0; result < 256; result++) {
        const char          how = result < 34 ? named[result] : 'a';
        EffectHistory      *h = open_history();
        const DisDetonation pdu = burst_here(7, (uint8_t)result);
        effect_history_detonation(h, &pdu, 100);
        int n = puffs_at(h, 100.001);
        assert_int_equal(of_kind(n, EFFECT_BURST_FLASH), how != 'n');
        n = puffs_at(h, 100.3); /* the last cloud is born at 0.15 s times the cube root of 4 kg, 0.24 s */
        assert_int_equal(of_kind(n, EFFECT_FIREBALL), how == 'g' ? 4 : how == 'e' || how == 'a' ? 7 : 0);
        assert_int_equal(of_kind(n, EFFECT_BURST_SMOKE), how == 'g' ? 5 : how == 'e' || how == 'a' ? 8 : 0);
        assert_int_equal(of_kind(n, EFFECT_BURST_DUST), how == 'g' ? 16 : how == 'e' ? 5 : 0);
        for (int i = 0; i < n; i++) CHECK(puffs[i].grounded == (how == 'g'));
        CHECK(effect_result_is_ground(result) == (how == 'g') && effect_result_is_water(result) == (how == 'w') &&
              effect_result_is_none(result) == (how == 'n'));
        effect_history_destroy(h);
    }
}

static void shots_flash_by_kind_and_size(void **state)
{
    (void)state;
    EffectHistory *h = open_history();
    DisFire        gun = shot_here(1), rifle = shot_here(2), missile = shot_here(3);
    rifle.descriptor.type.domain = 8;
    missile.descriptor.type.category = 1;
    CHECK(effect_charge_kg(&gun.descriptor, true) > 100 * effect_charge_kg(&rifle.descriptor, true));
    effect_history_fire(h, &gun, 0);
    effect_history_fire(h, &rifle, 10);
    effect_history_fire(h, &missile, 20);
    int n = puffs_at(h, 0.01);
    CHECK(of_kind(n, EFFECT_MUZZLE_FLASH) == 4 && of_kind(n, EFFECT_LAUNCH_FLASH) == 0);
    double largest = 0;
    for (int i = 0; i < n; i++) {
        /* in front of the muzzle: the gun points north, which is z */
        if (puffs[i].kind == EFFECT_MUZZLE_FLASH) CHECK(puffs[i].p_ecef[2] > 0);
        largest = fmax(largest, puffs[i].scale);
    }
    CHECK_NEAR(largest, 2, 1e-12); /* 8 kg of propellant */
    CHECK(of_kind(puffs_at(h, 0.25), EFFECT_MUZZLE_FLASH) == 0 && of_kind(puffs_at(h, 0.25), EFFECT_MUZZLE_SMOKE) > 0);
    n = puffs_at(h, 10.0008);
    for (int i = 0; i < n; i++)
        if (puffs[i].kind == EFFECT_MUZZLE_FLASH) CHECK(puffs[i].scale < 0.2);
    n = puffs_at(h, 20.03);
    CHECK(of_kind(n, EFFECT_LAUNCH_FLASH) > 0 && of_kind(n, EFFECT_LAUNCH_SMOKE) > 0);
    effect_history_destroy(h);
}

static void absurd_events_are_refused_and_counted(void **state)
{
    (void)state;
    EffectHistory      *h = open_history();
    DisDetonation       pdu = burst_here(1, 1);
    static const double bad[] = {NAN, INFINITY, 0, 1e12};
    for (int i = 0; i < 4; i++) {
        pdu.p_ecef[0] = bad[i];
        effect_history_detonation(h, &pdu, 1);
    }
    CHECK(effect_history_counters(h)->refused == 4 && puffs_at(h, 1.1) == 0);
    /* a velocity that is none: it bursts all the same, and every number of it is one */
    pdu = burst_here(2, 1);
    pdu.velocity_mps[1] = NAN;
    effect_history_detonation(h, &pdu, 1);
    const int n = puffs_at(h, 1.1);
    CHECK(n > 5);
    for (int i = 0; i < n; i++)
        CHECK(v3_is_finite(puffs[i].p_ecef) && v3_is_finite(puffs[i].throw_mps) && v3_is_finite(puffs[i].axis_ecef) &&
              isfinite(puffs[i].mass_kg));
    effect_history_detonation(h, &pdu, 1.2); /* the same again: a repeated PDU */
    CHECK(effect_history_counters(h)->repeated == 1 && puffs_at(h, 1.1) == n);
    effect_history_destroy(h);
}

/* A million bursts in ten seconds: the newest are kept, the rest are counted, and nothing grows. */
static void flood_is_bounded(void **state)
{
    (void)state;
    enum { flood = 1000000 };
    EffectHistory *h = open_history();
    for (int i = 0; i < flood; i++) {
        DisDetonation pdu = burst_here(i, 5);
        pdu.p_ecef[1] = i;
        effect_history_detonation(h, &pdu, 10.0 * i / flood);
    }
    CHECK(effect_history_counters(h)->events_dropped == flood - effect_event_capacity);
    const size_t all = effect_history_puffs(NULL, 0, h, 10.1);
    CHECK(all > effect_puff_capacity);
    CHECK(effect_history_puffs(puffs, effect_puff_capacity, h, 10.1) == all);
    CHECK(puffs[0].p_ecef[1] > flood - 10);
    CHECK(puffs[effect_puff_capacity - 1].p_ecef[1] > flood - effect_event_capacity - 10);
    CHECK(effect_history_puffs(NULL, 0, h, 1e300) == 0);
    effect_history_destroy(h);
}

/* Asked in any order, asked twice: the same bits. */
static void any_instant_in_any_order(void **state)
{
    (void)state;
    static EffectPuff first[effect_puff_capacity];
    EffectHistory    *h = open_history();
    for (int i = 0; i < 20; i++) {
        const DisDetonation pdu = burst_here(i, (uint8_t)(1 + i % 3));
        effect_history_detonation(h, &pdu, i);
    }
    const int n = puffs_at(h, 19.3);
    memcpy(first, puffs, (size_t)n * sizeof *first);
    puffs_at(h, 30);
    puffs_at(h, 5);
    CHECK(n > 50 && puffs_at(h, 19.3) == n && memcmp(first, puffs, (size_t)n * sizeof *first) == 0);
    effect_history_destroy(h);
}

/* ---- what entities give off --------------------------------------------------------------- */

static double trail_mass(const Snapshot *s, EffectKind kind)
{
    double kg = 0;
    for (int i = 0; i < s->puff_count; i++)
        if (s->puff[i].kind == kind) kg += s->puff[i].mass_kg;
    return kg;
}

static void appearance_lets_go(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState tank = report(1, tank_type);
    hear(&f, &tank, 0);
    seen_at(&f, 1, 5);
    CHECK(f.snapshot.puff_count == 0);
    tank.appearance = flaming_bit | plume_bit;
    hear(&f, &tank, 5);
    seen_at(&f, 1, 4.9);
    CHECK(f.snapshot.puff_count == 0); /* not before it was said */
    seen_at(&f, 1, 12);
    int flames = 0, smoke = 0;
    for (int i = 0; i < f.snapshot.puff_count; i++) {
        const EffectPuff *p = &f.snapshot.puff[i];
        flames += p->kind == EFFECT_FLAME;
        smoke += p->kind == EFFECT_SMOKE;
        /* about its own place, above the ground: up is x */
        CHECK(p->p_ecef[0] > earth_radius_m && p->p_ecef[0] < earth_radius_m + 4 && fabs(p->p_ecef[1]) < 5);
    }
    CHECK(flames > 10 && smoke > 10 && flames + smoke == f.snapshot.puff_count);
    /* a trail thins its old puffs, and keeps its mass: 7 s of it */
    char        path[512];
    EffectTable table;
    CHECK(etc_path(path, sizeof path, "effects.csv") && effect_table_open(&table, path) == STATUS_OK);
    for (double t_s = 8; t_s < 40; t_s += 4.9) {
        tank.p_ecef[0] = earth_radius_m;
        hear(&f, &tank, t_s); /* its heartbeat breaks nothing */
        seen_at(&f, 1, t_s);
        double scale = 1;
        for (int i = 0; i < f.snapshot.puff_count; i++)
            if (f.snapshot.puff[i].kind == EFFECT_SMOKE) scale = f.snapshot.puff[i].scale;
        const double want_kg = table.law[EFFECT_SMOKE].mass_kg * (t_s - 5) * scale * scale;
        /* one interval at either end, and half an interval of the widest spacing */
        CHECK_NEAR(trail_mass(&f.snapshot, EFFECT_SMOKE), want_kg,
                   table.law[EFFECT_SMOKE].mass_kg * scale * scale * 1.1);
        CHECK(f.snapshot.puff_count < 150);
    }
    tank.appearance = 0;
    hear(&f, &tank, 45);
    seen_at(&f, 1, 45 + table.law[EFFECT_FLAME].life_s * 1.01);
    for (int i = 0; i < f.snapshot.puff_count; i++) CHECK(f.snapshot.puff[i].kind == EFFECT_SMOKE); /* it lingers */
    fixture_close(&f);
}

/* No puff of a trail comes or goes at once: from one millisecond to the next each changes by little, and those that end
 * had nearly ended. */
static void trails_change_evenly(void **state)
{
    (void)state;
    static EffectPuff  before[512];
    EffectHistory     *h = open_history();
    const EffectSource source = {
        .kind = EFFECT_SMOKE,
        .key = 5,
        .to_s = INFINITY,
        .scale = 1,
        .rate = 1,
        .hold_s = 1,
        .motion = {.algorithm = 1, .p_ecef = {earth_radius_m, 0, 0}, .r_ecef_from_body = {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
    effect_history_open(h, &source);
    const double whole_kg = effect_history_table(h)->law[EFFECT_SMOKE].mass_kg * 0.25; /* of one just let go */
    int          n = 0, met = 0;
    for (double t_s = 60.0001; t_s < 60.6; t_s += 0.001) {
        const int now = puffs_at(h, t_s);
        CHECK(now < 512);
        for (int i = 0; i < n; i++) {
            double kg = 0;
            for (int k = 0; k < now; k++)
                if (puffs[k].seed == before[i].seed) kg = puffs[k].mass_kg, met++;
            CHECK_NEAR(kg, before[i].mass_kg, 0.005 * whole_kg); /* halved within 2 s at the quickest, log2: 0.0007 */
        }
        n = now;
        memcpy(before, puffs, (size_t)n * sizeof *before);
    }
    CHECK(n > 20 && met > 10000);
    effect_history_destroy(h);
}

/* Dust lies along the way that was driven, each puff where the vehicle's tail was when it was let go. */
static void dust_lies_along_the_way(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState tank = report(1, tank_type);
    tank.appearance = dust_bits;
    hear(&f, &tank, 0);
    seen_at(&f, 1, 3);
    CHECK(f.snapshot.puff_count == 0); /* it stands */
    tank.velocity_mps[2] = 8;          /* north, as it heads */
    hear(&f, &tank, 3);
    seen_at(&f, 1, 3.001);
    tank.p_ecef[2] = 16;
    hear(&f, &tank, 5);
    tank.velocity_mps[2] = 4;
    tank.p_ecef[2] = 24;
    hear(&f, &tank, 6);
    const SnapshotEntity *e = seen_at(&f, 1, 8);
    CHECK(e && f.snapshot.puff_count > 10);
    double tail_m = NAN;
    for (int i = 0; i < f.snapshot.puff_count; i++) {
        const EffectPuff *p = &f.snapshot.puff[i];
        if (p->kind == EFFECT_EXHAUST) continue;
        CHECK(p->kind == EFFECT_DUST);
        const double t_s = 8 - p->age_s, way_m = t_s < 6 ? 8 * (t_s - 3) : 24 + 4 * (t_s - 6);
        if (isnan(tail_m)) tail_m = p->p_ecef[2] - way_m;
        CHECK_NEAR(p->p_ecef[2] - way_m, tail_m, 1e-6);
        CHECK_NEAR(t_s * 4, round(t_s * 4), 1e-9); /* on the grid of its kind, whenever it is looked at */
    }
    CHECK(tail_m < -2);
    fixture_close(&f);
}

/* What trails is behind what it comes from, however quick, at any instant: no puff's front passes its nose. */
static void nobody_flies_in_his_own_trail(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState missile = report(4, missile_type);
    missile.p_ecef[0] += 100;
    missile.velocity_mps[2] = 300;
    hear(&f, &missile, 0);
    Weather          still = weather_default();
    const LocalFrame frame = frame_here();
    int              met = 0;
    still.wind_mps = 0;
    for (double t_s = 0.013; t_s < 1.9; t_s += 0.017) {
        const SnapshotEntity *e = seen_at(&f, 4, t_s);
        CHECK(e != NULL);
        double nose_enu[3];
        enu_from_ecef(nose_enu, &frame, e->p_ecef);
        for (int i = 0; i < f.snapshot.puff_count; i++) {
            EffectVolume v;
            if (f.snapshot.puff[i].kind != EFFECT_MOTOR_SMOKE) continue;
            if (!effect_volume(&v, f.snapshot.effect_table, &f.snapshot.puff[i], &still, &frame)) continue;
            CHECK(v.p_enu[1] + v.along_m < nose_enu[1]); /* it flies north, and is reported at its middle */
            met++;
        }
    }
    CHECK(met > 500);
    fixture_close(&f);
}

/* A missile leaves its trail hanging when it is gone, and its motor shines while it burns. */
static void trails_outlive_their_missile(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState missile = report(4, missile_type);
    missile.p_ecef[0] += 100;
    missile.velocity_mps[2] = 200;
    hear(&f, &missile, 0);
    seen_at(&f, 4, 0.5);
    int plumes = 0;
    for (int i = 0; i < f.snapshot.puff_count; i++) plumes += f.snapshot.puff[i].kind == EFFECT_MOTOR_PLUME;
    CHECK(plumes == 1);
    CHECK(f.snapshot.puff[0].kind == EFFECT_MOTOR_PLUME && f.snapshot.puff[0].p_ecef[2] < 100); /* behind it */
    DisDetonation end = burst_here(4, 1);
    end.p_ecef[0] += 98;
    end.p_ecef[2] = 240;
    entity_table_detonation(f.table, &end, 1.2);
    CHECK(!seen_at(&f, 4, 1.5));
    int    trail = 0;
    double last_m = 0;
    for (int i = 0; i < f.snapshot.puff_count; i++) {
        CHECK(f.snapshot.puff[i].kind != EFFECT_MOTOR_PLUME);
        if (f.snapshot.puff[i].kind != EFFECT_MOTOR_SMOKE) continue;
        trail++;
        last_m = fmax(last_m, f.snapshot.puff[i].p_ecef[2]);
    }
    CHECK(trail > 10 && last_m < 240 && last_m > 220);
    fixture_close(&f);
}

/* What a stopped simulation had smoking smokes where it stands; on resuming it goes on from there. */
static void stop_holds_the_place(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState tank = report(1, tank_type);
    tank.appearance = plume_bit;
    tank.velocity_mps[2] = 10;
    hear(&f, &tank, 0);
    const DisStopFreeze  stop = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    const DisStartResume start = {.receiving = {0xFFFF, 0xFFFF, 0xFFFF}};
    entity_table_stop(f.table, &stop, 2);
    entity_table_start(f.table, &start, 6);
    seen_at(&f, 1, 8);
    for (int i = 0; i < f.snapshot.puff_count; i++) {
        const double t_s = 8 - f.snapshot.puff[i].age_s, way_m = t_s < 2   ? 10 * t_s
                                                                 : t_s < 6 ? 20
                                                                           : 20 + 10 * (t_s - 6);
        CHECK_NEAR(f.snapshot.puff[i].p_ecef[2], way_m, 2.5); /* spread over the hull's top */
    }
    CHECK(f.snapshot.puff_count > 8);
    fixture_close(&f);
}

/* Nor does smoke end while its entity is stopped, however long, nor move: a frozen one and a stopped one smoke on at
 * their place, half a minute after every timeout. */
static void smoke_goes_on_through_a_stop(void **state)
{
    (void)state;
    for (int frozen = 0; frozen < 2; frozen++) {
        Fixture        f = fixture_open(NULL);
        DisEntityState tank = report(1, tank_type);
        tank.appearance = plume_bit | (frozen ? frozen_bit : 0);
        tank.velocity_mps[2] = 10;
        hear(&f, &tank, 0);
        if (!frozen) entity_table_stop(f.table, &(DisStopFreeze){.receiving = {0xFFFF, 0xFFFF, 0xFFFF}}, 2);
        for (double t_s = 5; t_s <= (frozen ? 11 : 42); t_s += 1) {
            int young = 0;
            seen_at(&f, 1, t_s);
            for (int i = 0; i < f.snapshot.puff_count; i++) {
                const EffectPuff *p = &f.snapshot.puff[i];
                if (p->kind != EFFECT_SMOKE || p->age_s > 2) continue;
                CHECK_NEAR(p->p_ecef[2], frozen ? 0 : 20, 2.5); /* spread over the hull's top */
                young++;
            }
            CHECK(young >= 7); /* four a second */
        }
        fixture_close(&f);
    }
}

/* ---- wrecks ------------------------------------------------------------------------------- */

static void wrecks_burn_and_go_out(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState seen_hit = report(1, tank_type), found_cold = report(2, tank_type),
                   found_burning = report(3, tank_type);
    hear(&f, &seen_hit, 0);
    seen_hit.appearance = destroyed_bits;
    found_cold.appearance = destroyed_bits;
    found_burning.appearance = destroyed_bits | flaming_bit;
    hear(&f, &seen_hit, 10);
    hear(&f, &found_cold, 10);
    hear(&f, &found_burning, 10);
    CHECK(snapshot_is_wreck(seen_at(&f, 1, 11)));
    CHECK(seen_at(&f, 1, 11)->drives.burning == 1);
    CHECK(seen_at(&f, 2, 11)->drives.burning == 0);
    CHECK(seen_at(&f, 3, 11)->drives.burning == 1);
    for (double t_s = 15; t_s <= 3610; t_s += 5) hear(&f, &seen_hit, t_s);
    CHECK(seen_at(&f, 1, 3610)->drives.burning == 0); /* burnt out */
    fixture_close(&f);
}

/* The gun of a wreck has sunk; a sender who says where it points is believed. */
static void wrecked_guns_droop(void **state)
{
    (void)state;
    Fixture        f = fixture_open(NULL);
    DisEntityState tank = report(1, tank_type);
    hear(&f, &tank, 0);
    const SnapshotEntity *e = seen_at(&f, 1, 1);
    const Model          *model = catalog_model(f.catalog, e->model);
    int                   gun = -1;
    for (int n = 0; n < model->node_count; n++)
        if (model->node[n].dis_class == 4416 && model->node[n].dis_metric == 13) gun = n;
    CHECK(gun >= 0);
    const double level = node_of(&f, e, gun).r_body_from_node[6];
    tank.appearance = destroyed_bits;
    hear(&f, &tank, 2);
    e = seen_at(&f, 1, 3);
    CHECK(node_of(&f, e, gun).r_body_from_node[6] > level + 0.03); /* x of the gun turned to +z: down */
    tank.variable_count = 1;
    tank.variable[0] = articulated(4416 + 13, 0.2f);
    hear(&f, &tank, 4);
    e = seen_at(&f, 1, 5);
    CHECK(node_of(&f, e, gun).r_body_from_node[6] < level - 0.15);
    fixture_close(&f);
}

/* ---- the table ---------------------------------------------------------------------------- */

static void bad_tables_are_named(void **state)
{
    (void)state;
    char        path[text_file_size];
    EffectTable table;
    log_set_sink(check_listen, NULL);
    text_file(path, "name,ext_b\nsmoke,1\n");
    CHECK(effect_table_open(&table, path) == STATUS_BAD_VALUE && strstr(check_said, "column"));
    remove(path);
    char good[512], text[16384];
    CHECK(etc_path(good, sizeof good, "effects.csv"));
    FILE *file = fopen(good, "rb");
    CHECK(file != NULL);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    char *row = strstr(text, "\nsmoke,");
    CHECK(row != NULL);
    row[2] = 'n';
    text_file(path, text);
    CHECK(effect_table_open(&table, path) == STATUS_BAD_VALUE &&
          strstr(check_said, "name: 'snoke' is not one of muzzle_flash, "));
    remove(path);
    row[2] = 'm';
    row[7] = '-';
    text_file(path, text);
    CHECK(effect_table_open(&table, path) == STATUS_BAD_VALUE && strstr(check_said, "ext_b"));
    remove(path);
    row[1] = 0;
    text_file(path, text);
    CHECK(effect_table_open(&table, path) == STATUS_BAD_VALUE && strstr(check_said, "no row of name smoke"));
    remove(path);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drift_is_wind_times_age),
        cmocka_unit_test(extinction_holds_its_mass),
        cmocka_unit_test(flash_has_its_time_course),
        cmocka_unit_test(results_burst_in_their_way),
        cmocka_unit_test(every_result_bursts_by_its_name),
        cmocka_unit_test(shots_flash_by_kind_and_size),
        cmocka_unit_test(absurd_events_are_refused_and_counted),
        cmocka_unit_test(flood_is_bounded),
        cmocka_unit_test(any_instant_in_any_order),
        cmocka_unit_test(appearance_lets_go),
        cmocka_unit_test(trails_change_evenly),
        cmocka_unit_test(dust_lies_along_the_way),
        cmocka_unit_test(nobody_flies_in_his_own_trail),
        cmocka_unit_test(trails_outlive_their_missile),
        cmocka_unit_test(stop_holds_the_place),
        cmocka_unit_test(smoke_goes_on_through_a_stop),
        cmocka_unit_test(wrecks_burn_and_go_out),
        cmocka_unit_test(wrecked_guns_droop),
        cmocka_unit_test(bad_tables_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
