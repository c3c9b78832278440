/* Puffs in the picture: what a flash shines with, what a cloud hides, and that nothing changes where there is none. */
#include "tests/check.h"

#include "render/smoke/smoke.h"
#include "render/frame/render.h"

static Catalog    *catalog;
static World       world;
static Pool       *pool;
static Arena      *arena, *air_arena;
static EffectTable effects;

static int open_world(void **state)
{
    (void)state;
    char           path[512], hand[text_file_size];
    LocalFrame     frame;
    const Geodetic origin = {0.6, -2.1, 0};
    text_file(hand, "type,model,origin\n*.*.*.*.*.*.*,marker,base\n");
    const Status status = catalog_open(&catalog, hand, 0.01);
    remove(hand);
    arena = arena_create();
    air_arena = arena_create();
    return status == STATUS_OK && arena && air_arena && local_frame_at(&frame, &origin) == STATUS_OK &&
                   etc_path(path, sizeof path, "effects.csv") && effect_table_open(&effects, path) == STATUS_OK &&
                   world_open(&world, catalog, NULL, &frame, "avx2") == STATUS_OK &&
                   atmosphere_open(&world.atmosphere, "us1976") == STATUS_OK && pool_create(&pool, 2) == STATUS_OK
               ? 0
               : -1;
}

static int close_world(void **state)
{
    (void)state;
    pool_destroy(pool);
    world_close(&world);
    catalog_close(catalog);
    arena_destroy(arena);
    arena_destroy(air_arena);
    return 0;
}

static Air air_when(double elevation_deg)
{
    const double    e = elevation_deg * rad_per_deg;
    const Sun       sun = {.elevation_rad = e, .distance_au = 1, .d_enu = {0, -cos(e), sin(e)}};
    const Weather   weather = weather_default();
    const AirSource source = {world.atmosphere, world.planck_mwir, world.planck_lwir, 0, 0};
    const AirEye    eye = {.bands = (1 << AIR_BAND_COUNT) - 1};
    Air             air;
    arena_reset(air_arena);
    assert_int_equal(air_at(&air, &source, &weather, &sun, &eye, NULL, air_arena), STATUS_OK);
    return air;
}

/* What the air does on the way to a puff's centre, due north. */
static void path_north(AirPaths *veils, const Air *air, int band, double range_m, float temp_k)
{
    static Hits hits;
    static Rays rays;
    hits.count = rays.count = 1;
    hits.range_m[0] = hits.p_enu[1][0] = range_m;
    rays.d_enu[1][0] = 1;
    float temps_k[8] = {temp_k}; /* eight paths at once: arrays are padded, as those of Hits are */
    air_path(veils, air, (AirBand)band, &hits, &rays, temps_k);
}

static EffectPuff puff_at(EffectKind kind, double north_m, double age_s, double mass_kg)
{
    EffectPuff   puff = {.kind = kind, .age_s = age_s, .throw_s = 1, .scale = 2, .mass_kg = mass_kg};
    const double p_enu[3] = {0, north_m, 0};
    ecef_from_enu(puff.p_ecef, &world.frame, p_enu);
    for (int i = 0; i < 3; i++) puff.up_ecef[i] = puff.axis_ecef[i] = world.frame.r_ecef_from_enu[3 * i + 2];
    return puff;
}

/* Towards north from the origin. */
static View view_north(int side_px)
{
    return (View){
        .width = side_px, .height = side_px, .focal_px = 20 * side_px, .r_enu_from_cam = {1, 0, 0, 0, 0, 1, 0, -1, 0}};
}

/* Air temperature where wind and rise have put it: 6.5 K/km from 288.15 K on the round Earth. */
static double air_k_at(const EffectPuff *puff, const Air *air)
{
    EffectVolume v;
    CHECK(effect_volume(&v, &effects, puff, &air->light.weather, &world.frame));
    const double height_m = v.p_enu[2] + (v.p_enu[0] * v.p_enu[0] + v.p_enu[1] * v.p_enu[1]) / (2 * 6371e3);
    return 288.15 - 0.0065 * height_m;
}

static const unsigned all_bands = (1u << effect_band_count) - 1;

/* Transmittance and added radiance along the boresight. */
static void boresight(double transmittance[effect_band_count], double added[effect_band_count], EffectPuff *puff,
                      const Air *air)
{
    static Rays      rays;
    static SmokeRays out;
    Snapshot         snapshot = {.puff_count = 1, .puff = puff, .effect_table = &effects};
    const View       view = view_north(64);
    EffectScene      scene;
    const int        first = 0;
    const double     far_m = INFINITY;

    arena_reset(arena);
    const float ground_rho[optical_channel_count] = {0};
    CHECK(smoke_effects_scene(
              &scene, &snapshot,
              &(EffectView){
                  .frame = &world.frame, .view = &view, .ground_rho = ground_rho, .bands = all_bands, .hidden = -1},
              air, arena) == STATUS_OK);
    CHECK(scene.count == 1);
    scene.volume[0].billow = 0;
    rays.count = 1;
    for (int k = 0; k < 3; k++) rays.o_enu[k][0] = 0;
    /* through its centre, wherever wind and rise have put it */
    double d[3];
    CHECK(v3_normalize(d, scene.volume[0].p_enu));
    for (int k = 0; k < 3; k++) rays.d_enu[k][0] = d[k];
    smoke_trace_rays(&out, scene.volume, &first, 1, &rays, &far_m, all_bands);
    for (int b = 0; b < effect_band_count; b++) {
        transmittance[b] = out.any ? out.transmittance[b][0] : 1;
        added[b] = out.any ? out.added[b][0] : 0;
    }
}

/* Gas through its middle: seen emissivity times a grey body's radiance there, as smoke.h gives it; far less in 8 ..
 * 12 um; nothing in the optical bands; and as warm as the air it can not be told from the air beside it. */
static void gas_shines_by_its_bands(void **state)
{
    (void)state;
    static AirPaths veils;
    const Air       air = air_when(-30);
    EffectPuff      puff = puff_at(EFFECT_JET_EXHAUST, 500, 0, 0.3);
    double          tau[effect_band_count], added[effect_band_count];
    EffectVolume    v;
    boresight(tau, added, &puff, &air);
    CHECK(effect_volume(&v, &effects, &puff, &air.light.weather, &world.frame));
    const double       k = air_k_at(&puff, &air) + v.temp_k - 288.15, column_m = 16.0 / 15 * v.across_m;
    const HotGasColumn column = {smoke_gas_atm_m(v.co2_kg_m3 * column_m, hot_gas_co2_molar_kg, k),
                                 smoke_gas_atm_m(v.h2o_kg_m3 * column_m, hot_gas_h2o_molar_kg, k)};
    const double want[2] = {smoke_gas_emissivity(HOT_GAS_MWIR, column, k) * smoke_gas_passed(column.co2_atm_m, k, 500),
                            smoke_gas_emissivity(HOT_GAS_LWIR, column, k)};
    const double low_m[2] = {3.4e-6, 8e-6}, high_m[2] = {4.8e-6, 12e-6};
    for (int which = 0; which < 2; which++) {
        const int b = effect_band_mwir + which;
        path_north(&veils, &air, b, 500, (float)k);
        CHECK_NEAR((1 - tau[b]) / want[which], 1, 2e-3);
        const double glow = planck_band(low_m[which], high_m[which], k, NULL);
        const double radiance = want[which] * (veils.added_w_m2_sr[0] + veils.transmittance[0] * glow);
        CHECK_NEAR(added[b] / radiance, 1, 5e-3);
    }
    CHECK(1 - tau[effect_band_lwir] < 1 - tau[effect_band_mwir]);
    for (int b = 0; b < effect_band_mwir; b++) CHECK(tau[b] == 1 && added[b] == 0);
}

/* Exhaust of hydrogen: a gas without CO2 is in the scene with its water's pressure, and each by itself. By the gas law
 * 1 kg/m3 of a molar mass M at T is 8.314462618 T / (101325 M) atm. */
static void gas_needs_no_second_gas(void **state)
{
    (void)state;
    static const double share[3][2] = {{0, 0.2}, {0.1, 0.2}, {0.2, 0}}; /* of CO2, of water */
    const Air           air = air_when(-30);
    EffectPuff          puff = puff_at(EFFECT_JET_EXHAUST, 500, 0, 0.3);
    const float         ground_rho[optical_channel_count] = {0};
    const View          view = view_north(64);
    for (int k = 0; k < 3; k++) {
        EffectTable table = effects;
        table.law[EFFECT_JET_EXHAUST].co2_share = share[k][0], table.law[EFFECT_JET_EXHAUST].h2o_share = share[k][1];
        const Snapshot   snapshot = {.puff_count = 1, .puff = &puff, .effect_table = &table};
        const EffectView seen = {
            .frame = &world.frame, .view = &view, .ground_rho = ground_rho, .bands = all_bands, .hidden = -1};
        EffectScene  scene;
        EffectVolume v;
        arena_reset(arena);
        CHECK(smoke_effects_scene(&scene, &snapshot, &seen, &air, arena) == STATUS_OK);
        CHECK(scene.count == 1 && scene.volume[0].gas);
        CHECK(effect_volume(&v, &table, &puff, &air.light.weather, &world.frame));
        const double mass_kg_m3 = (v.co2_kg_m3 + v.h2o_kg_m3) / (share[k][0] + share[k][1]);
        const double atm_mol = 8.314462618 * (air_k_at(&puff, &air) + v.temp_k - 288.15) / 101325 * mass_kg_m3;
        const double co2_atm = share[k][0] * atm_mol / 0.04401, h2o_atm = share[k][1] * atm_mol / 0.018015;
        CHECK(mass_kg_m3 > 0);
        CHECK_NEAR(scene.volume[0].gas->co2_atm, co2_atm, 1e-4 * co2_atm);
        CHECK_NEAR(scene.volume[0].gas->h2o_atm, h2o_atm, 1e-4 * h2o_atm);
    }
}

/* A muzzle flash at night: (1 - exp(-depth)) (1 - albedo) Planck(T(age)), through the air of the way; the peak comes
 * first and the red outlasts the blue. */
static void flash_follows_its_closed_form(void **state)
{
    (void)state;
    static const double low_m[] = {0.4e-6, 0.5e-6, 0.6e-6, 0.4e-6}, high_m[] = {0.5e-6, 0.6e-6, 0.7e-6, 0.7e-6};
    const Air           air = air_when(-30);
    const EffectModel  *law = &effects.law[EFFECT_MUZZLE_FLASH];
    const double        kg = law->mass_kg * 8, scale = 2, range_m = 700;
    double              first_colour = 0;
    for (double age_s = 0; age_s < 0.119; age_s += 0.017) {
        EffectPuff puff = puff_at(EFFECT_MUZZLE_FLASH, range_m, age_s, kg);
        double     tau[effect_band_count], added[effect_band_count];
        boresight(tau, added, &puff, &air);
        const double grown = 1 - exp(-age_s / (law->grow_s * scale)), lived = age_s / (law->life_s * scale);
        const double radius_m = scale * (law->radius_start_m + (law->radius_end_m - law->radius_start_m) * grown);
        const double thin = (1 - lived * lived) * (1 - lived * lived);
        const double temp_k = air_k_at(&puff, &air) + law->temp_rise_k * exp(-age_s / (law->cool_s * scale));
        /* through the centre of (1 - q^2)^2: 16/15 of the radius at the peak, and the peak is 35/8 of the mean */
        const double depth = law->extinction_m2_kg[effect_band_g] * kg * thin / (4.0 / 3 * pi_rad * pow(radius_m, 3)) *
                             35.0 / 8 * 16.0 / 15 * radius_m;
        CHECK_NEAR(tau[effect_band_g], exp(-depth), 2e-6); /* a float, over a centre moved by the wind */
        for (int b = 0; b <= effect_band_pan; b++) {
            static AirPaths path;
            path_north(&path, &air, b, range_m, (float)temp_k);
            const double night = air.light.sky_w_m2[b] / pi_rad; /* starlight from above: of no account */
            const double want =
                (1 - exp(-depth)) *
                (path.added_w_m2_sr[0] + path.transmittance[0] * 0.95 * planck_band(low_m[b], high_m[b], temp_k, NULL));
            CHECK_NEAR(added[b], want, 1e-5 * want + night);
        }
        const double colour = added[effect_band_b] / added[effect_band_r];
        if (age_s == 0) first_colour = colour;
        else CHECK(colour < first_colour);
    }
}

/* Thick and of one temperature, in LWIR: Planck(T) of its own through the air between, for what it does not scatter. */
static void thick_smoke_reads_its_temperature(void **state)
{
    (void)state;
    Air air = air_when(-30);
    for (double range_m = 200; range_m <= 5000; range_m *= 5) {
        EffectPuff   puff = puff_at(EFFECT_BURST_SMOKE, range_m, 0, 50);
        double       tau[effect_band_count], added[effect_band_count];
        const double temp_k = air_k_at(&puff, &air) + effects.law[EFFECT_BURST_SMOKE].temp_rise_k,
                     albedo = smoke_thick_albedo(effects.law[EFFECT_BURST_SMOKE].albedo[effect_band_lwir]);
        /* surroundings as warm as it is: then what it scatters is the same */
        air.light.ground_w_m2_sr[AIR_LWIR] = planck_table_radiance(air.light.planck_lwir, temp_k);
        air.light.sky_w_m2[AIR_LWIR] = pi_rad * air.light.ground_w_m2_sr[AIR_LWIR];
        boresight(tau, added, &puff, &air);
        static AirPaths path;
        path_north(&path, &air, AIR_LWIR, range_m, (float)temp_k);
        CHECK(tau[effect_band_lwir] < 1e-6 && albedo > 0);
        CHECK_NEAR(added[effect_band_lwir],
                   ((1 - albedo) * (double)path.transmittance[0] + albedo * (double)path.air_transmittance[0]) *
                           planck_table_radiance(air.light.planck_lwir, temp_k) +
                       (double)path.added_w_m2_sr[0],
                   5e-5); /* of the 48 W/(m2 sr) behind it a millionth may show through */
    }
}

/* A flame's last second, below 900 K: dark to the eye, 3 W/(m2 sr) in the near infrared, by Planck. */
static void near_infrared_sees_it_longer(void **state)
{
    (void)state;
    static AirPaths    path;
    const Air          air = air_when(-30);
    const EffectModel *law = &effects.law[EFFECT_FLAME];
    const double       age_s = 1, range_m = 100;
    double             tau[effect_band_count], added[effect_band_count];
    EffectPuff         puff = puff_at(EFFECT_FLAME, range_m, age_s, 20);
    const double       temp_k = air_k_at(&puff, &air) + law->temp_rise_k * exp(-age_s / law->cool_s);
    boresight(tau, added, &puff, &air);
    path_north(&path, &air, AIR_NIR, range_m, (float)temp_k);
    const double glow = planck_band(0.7e-6, 1.1e-6, temp_k, NULL), night = air.light.sky_w_m2[AIR_NIR] / pi_rad;
    CHECK(temp_k < 900 && glow > 1);
    /* the wind has moved its centre by some metres of 100 */
    CHECK_NEAR(added[effect_band_nir],
               (1 - tau[effect_band_nir]) * ((double)path.transmittance[0] * (1 - law->albedo[effect_band_nir]) * glow +
                                             (double)path.added_w_m2_sr[0]),
               1e-4 * glow + night);
    CHECK(added[effect_band_pan] < 0.01);
}

/* Air, sky, ground and smoke at one temperature: the smoke cannot be seen. */
static void cavity_hides_it(void **state)
{
    (void)state;
    Air          air;
    EffectPuff   puff = puff_at(EFFECT_DUST, 900, 2, 0.03); /* dust is as warm as the air */
    double       tau[effect_band_count], added[effect_band_count], all[AIR_BAND_COUNT] = {0};
    const double want = all[AIR_LWIR] = planck_table_radiance(world.planck_lwir, weather_default().air_temp_k);
    air_even(&air, (const double[3]){0, 0, 1}, 0, all, 2e-4, world.planck_mwir, world.planck_lwir);
    boresight(tau, added, &puff, &air);
    CHECK(tau[effect_band_lwir] > 0.1 && tau[effect_band_lwir] < 0.9);
    CHECK_NEAR(want * tau[effect_band_lwir] + added[effect_band_lwir], want, 1e-6 * want);
}

/* Oil smoke blinds the eye and not the infrared; dust blinds both. */
static void bands_differ_as_the_stuff_does(void **state)
{
    (void)state;
    Air        air = air_when(40);
    double     tau[effect_band_count], added[effect_band_count];
    EffectPuff smoke = puff_at(EFFECT_SMOKE, 500, 10, 0.06), dust = puff_at(EFFECT_DUST, 500, 4, 0.05);
    boresight(tau, added, &smoke, &air);
    CHECK(log(tau[effect_band_pan]) < 5 * log(tau[effect_band_lwir]));
    /* white sun, black sky, nothing between */
    air_even(&air, (const double[3]){0, -0.8, 0.6}, 1000, (const double[AIR_BAND_COUNT]){0}, 0, world.planck_mwir,
             world.planck_lwir);
    boresight(tau, added, &dust, &air);
    /* 250 m2/kg less the forward peak, 0.62^2 of the scattered 0.44: 207.7; over the visible's mean of 325 */
    CHECK_NEAR(log(tau[effect_band_lwir]) / log(tau[effect_band_pan]), 207.7 / 325, 1e-3);
    CHECK(added[effect_band_r] > 1.1 * added[effect_band_b]); /* brown */
}

/* ---- the picture -------------------------------------------------------------------------- */

enum { side = 96 };

static Picture picture_of(EffectPuff *puff, int count)
{
    static SnapshotEntity entity;
    static NodePose       node;
    const double          p_enu[3] = {0, 400, -1};
    const Air             air = air_when(35);
    Picture               picture;

    entity = (SnapshotEntity){.id = {1, 1, 1}};
    entity.model = catalog_find(catalog, entity.type, &(Origin){ORIGIN_BASE}, NULL);
    model_pose(&node, catalog_model(catalog, entity.model), NULL);
    ecef_from_enu(entity.p_ecef, &world.frame, p_enu);
    for (int i = 0; i < 3; i++) {
        entity.r_ecef_from_body[3 * i] = world.frame.r_ecef_from_enu[3 * i + 1];
        entity.r_ecef_from_body[3 * i + 1] = world.frame.r_ecef_from_enu[3 * i];
        entity.r_ecef_from_body[3 * i + 2] = -world.frame.r_ecef_from_enu[3 * i + 2];
    }
    const Snapshot      snapshot = {.count = 1,
                                    .node_count = 1,
                                    .entity = &entity,
                                    .node = &node,
                                    .puff_count = count,
                                    .puff = puff,
                                    .effect_table = count ? &effects : NULL};
    const RenderRequest request = {.view = view_north(side),
                                   .samples = 1,
                                   .hidden_entity = -1,
                                   .truth = true,
                                   .optical = OPTICAL_RGB,
                                   .bands = 1 << BAND_OPTICAL | 1 << BAND_MWIR | 1 << BAND_LWIR};
    arena_reset(arena);
    assert_int_equal(render(&picture, &world, &snapshot, &request, &air, pool, arena), STATUS_OK);
    return picture;
}

static void without_smoke_no_bit_changes(void **state)
{
    (void)state;
    static float    lwir[side * side], red[side * side];
    static uint32_t id[side * side];
    Picture         picture = picture_of(NULL, 0);
    memcpy(lwir, picture.lwir, sizeof lwir);
    memcpy(red, picture.optical[0], sizeof red);
    memcpy(id, picture.entity, sizeof id);
    int seen = 0;
    for (int i = 0; i < side * side; i++) seen += id[i] == 1;
    CHECK(seen > 20);

    EffectPuff behind = puff_at(EFFECT_SMOKE, -200, 5, 1), beyond = puff_at(EFFECT_SMOKE, 200, 1000, 1);
    picture = picture_of(&behind, 1); /* behind the eye; and long gone */
    CHECK(memcmp(lwir, picture.lwir, sizeof lwir) == 0 && memcmp(red, picture.optical[0], sizeof red) == 0);
    picture = picture_of(&beyond, 1);
    CHECK(memcmp(lwir, picture.lwir, sizeof lwir) == 0 && memcmp(red, picture.optical[0], sizeof red) == 0);

    /* before the target: other radiances, the same truth. Behind it: the target's own stay */
    EffectPuff before = puff_at(EFFECT_SMOKE, 300, 0, 0.3), after = puff_at(EFFECT_SMOKE, 450, 0, 0.3);
    picture = picture_of(&before, 1);
    int changed = 0;
    for (int i = 0; i < side * side; i++) changed += id[i] == 1 && red[i] != picture.optical[0][i];
    CHECK(changed > seen / 2 && memcmp(id, picture.entity, sizeof id) == 0);
    CHECK(picture.target[0].veiled[BAND_OPTICAL] > 0.9 && picture.target[0].veiled[BAND_RADAR] == 0);
    CHECK(picture.target[0].veiled[BAND_LWIR] < picture.target[0].veiled[BAND_OPTICAL]);
    picture = picture_of(&after, 1);
    CHECK(picture.target[0].veiled[BAND_OPTICAL] == 0);
    int sky = 0;
    for (int i = 0; i < side * side; i++) {
        if (id[i] == 1) CHECK(red[i] == picture.optical[0][i] && lwir[i] == picture.lwir[i]);
        sky += red[i] != picture.optical[0][i];
    }
    CHECK(sky > 20);
}

/* A host's eye is not in its own smoke: others see it. */
static void a_host_does_not_see_its_own(void **state)
{
    (void)state;
    SnapshotEntity host = {.id = {1, 3001, 41}}, other = {.id = {1, 3001, 42}};
    SnapshotEntity both[2] = {host, other};
    EffectPuff     puff = puff_at(EFFECT_MOTOR_SMOKE, 30, 0.5, 1);
    const Snapshot snapshot = {.count = 2, .entity = both, .puff_count = 1, .puff = &puff, .effect_table = &effects};
    const View     view = view_north(64);
    const Air      air = air_when(40);
    static const float ground_rho[optical_channel_count] = {0.1f, 0.1f, 0.1f, 0.1f, 0.1f};
    const int          seen_by[3] = {-1, 0, 1};
    /* the key is the entity's own: 16 bits each of site, application and number, and one */
    for (puff.owner = 0;; puff.owner = (UINT64_C(1) << 32 | UINT64_C(3001) << 16 | 41) + 1) {
        for (int k = 0; k < 3; k++) {
            EffectScene scene;
            arena_reset(arena);
            CHECK(smoke_effects_scene(&scene, &snapshot,
                                      &(EffectView){.frame = &world.frame,
                                                    .view = &view,
                                                    .ground_rho = ground_rho,
                                                    .bands = all_bands,
                                                    .hidden = seen_by[k]},
                                      &air, arena) == STATUS_OK);
            CHECK(scene.count == (puff.owner && seen_by[k] == 0 ? 0 : 1));
        }
        if (puff.owner) break;
    }
}

/* Depths of one puff in all bands go by its row's extinctions: engine smoke 5200, 4600, 4000 m2/kg in blue, green and
 * red (panchromatic: their mean, 4600), 2800 in the near infrared, 600 in 3.4-4.8 and 250 in 8-12 um; burst dust and
 * burning oil likewise (etc/effects.csv). */
static void each_band_has_its_own_extinction(void **state)
{
    (void)state;
    static const struct {
        EffectKind kind;
        double     kg, of[7]; /* m2/kg: b, g, r, pan, nir, mwir, lwir */
    } row[] = {{EFFECT_ENGINE_SMOKE, 5e-5, {5200, 4600, 4000, 4600, 2800, 600, 250}},
               /* thermal: 270 (1 - 0.85 0.62^2), 250 (1 - 0.44 0.62^2) */
               {EFFECT_BURST_DUST, 3e-3, {330, 325, 320, 325, 300, 181.7802, 207.716}},
               {EFFECT_SMOKE, 5e-4, {6800, 6100, 5500, 18400.0 / 3, 4000, 1400, 700}}};
    static const int band[7] = {effect_band_b,   effect_band_g,    effect_band_r,   effect_band_pan,
                                effect_band_nir, effect_band_mwir, effect_band_lwir};
    const Air        air = air_when(40);
    for (int k = 0; k < 3; k++) {
        double     tau[effect_band_count], added[effect_band_count];
        EffectPuff puff = puff_at(row[k].kind, 500, 0, row[k].kg);
        boresight(tau, added, &puff, &air);
        CHECK(tau[effect_band_b] > 0.02 && tau[effect_band_b] < 0.9);
        for (int b = 0; b < 7; b++)
            CHECK_NEAR(log(tau[band[b]]) / log(tau[effect_band_b]), row[k].of[b] / row[k].of[0], 2e-4); /* floats */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gas_shines_by_its_bands),        cmocka_unit_test(gas_needs_no_second_gas),
        cmocka_unit_test(flash_follows_its_closed_form),  cmocka_unit_test(thick_smoke_reads_its_temperature),
        cmocka_unit_test(near_infrared_sees_it_longer),   cmocka_unit_test(cavity_hides_it),
        cmocka_unit_test(bands_differ_as_the_stuff_does), cmocka_unit_test(each_band_has_its_own_extinction),
        cmocka_unit_test(a_host_does_not_see_its_own),    cmocka_unit_test(without_smoke_no_bit_changes),
    };
    return cmocka_run_group_tests(tests, open_world, close_world);
}
