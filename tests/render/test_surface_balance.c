/* The balance of a surface in the open and of the ground below it, term by term: figures worked out in Python from the
 * published forms, water at the top by its closed form, one step of changing weather against many. labels: physics */
#include "tests/check.h"

#include "render/heat/ground_column_private.h"

/* Worked out in Python (12 digits) from: u = max(wind, 1); neutral transfer 0.4^2 / (ln(hw / z0 + 1) (ln(h / z0 + 1) +
 * 0.1 * 0.4 sqrt(u* z0 / 1.5e-5))), u* = 0.4 u / ln(hw / z0 + 1) (Zilitinkevich 1995, Chen et al. 1997); stability of
 * Ri = 9.81 h (Ta - T) / (Tm u^2), 1 / (1 + 15 Ri sqrt(1 + 5 Ri)) or 1 - 15 Ri / (1 + 75 C sqrt(h / z0 + 1) sqrt(-Ri))
 * (Louis, Tiedtke & Geleyn 1982); p / (287.05 Ta) of 1005 J/(kg K); vapour 0.622 / p of 2.45 MJ/kg through 1 / v and
 * the surface's resistance, dew through 1 / v alone; saturation 611 exp(17.502 t / (240.97 + t)) (Campbell & Norman
 * 1998). Rows: unstable, stable, dew in a wind, neutral, calm air, Richardson numbers beyond 1e4 on either side. */
static void the_balance_is_its_terms(void **state)
{
    (void)state;
    static const struct {
        double     temp_k;
        SurfaceAir air;
        double     roughness_m, absorbed_w_m2, emissivity, resistance_s_m;
        double     film, latent, flux, falls;
    } c[] = {
        {310,
         {290, 1000, 101325, 3, 2, 10},
         0.03,
         700,
         0.95,
         80,
         39.2425263034,
         860.616396874,
         -1442.95435907,
         97.2987028401},
        {280,
         {290, 1000, 101325, 3, 2, 10},
         0.03,
         300,
         0.95,
         80,
         8.55450125824,
         -1.13239724722,
         55.5710922248,
         13.2845915097},
        {275,
         {285, 1200, 90000, 6, 1.5, 8},
         0.005,
         250,
         0.9,
         0,
         19.1481008321,
         -161.898580745,
         311.512570768,
         23.3934392801},
        {300, {300, 1000, 101325, 5, 2, 10}, 0.1, 400, 1, INFINITY, 39.4607595424, 0, -59.3003279539, 45.5847639151},
        {300,
         {290, 800, 101325, 0.2, 2, 10},
         0.03,
         600,
         0.97,
         0,
         25.3154081414,
         1035.15996058,
         -1133.83536011,
         93.3652900176},
        {100,
         {288, 0, 101325, 1, 1000, 10},
         0.03,
         0,
         0.5,
         INFINITY,
         1.00213082014e-07,
         0,
         -2.83516836953,
         0.113407588597},
        {1e5,
         {288, 0, 101325, 1, 1000, 10},
         0.03,
         0,
         0.5,
         INFINITY,
         138.00921701,
         0,
         -2.83520097077e+12,
         113407626.393},
    };
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        SurfaceFlux l = {.air = c[k].air,
                         .absorbed_w_m2 = c[k].absorbed_w_m2,
                         .emissivity = c[k].emissivity,
                         .roughness_m = c[k].roughness_m,
                         .resistance_s_m = c[k].resistance_s_m};
        double      falls;
        surface_flux_prepare(&l);
        CHECK_NEAR(surface_film_w_m2k(&l, c[k].temp_k), c[k].film, 1e-10 * c[k].film);
        CHECK_NEAR(surface_latent_w_m2(&l, c[k].temp_k), c[k].latent, 1e-9 * fabs(c[k].latent));
        CHECK_NEAR(surface_flux_w_m2(&falls, c[k].temp_k, &l), c[k].flux, 1e-10 * fabs(c[k].flux));
        CHECK_NEAR(falls, c[k].falls, 1e-10 * c[k].falls);
    }
    /* of the formula; below its pole's reach that of 123.15 K */
    static const double pa[][2] = {
        {273.15, 611}, {300, 3532.42806214}, {250, 95.1045806886}, {130, 4.59927216041e-09}, {90, 1.78958436635e-10}};
    for (size_t k = 0; k < sizeof pa / sizeof *pa; k++) CHECK_NEAR(saturation_pa(pa[k][0]) / pa[k][1], 1, 1e-10);
}

/* Johansen (1975), as in Peters-Lidard et al. 1998: dry (0.135 d + 64.7) / (2700 - 0.947 d), d = 2700 (1 - n); solids
 * 7.7^q 2^(1 - q), or 3^(1 - q) where q < 0.2; wet solids^(1 - n) 0.57^n; in between by log10 S + 1 above S = 0.1.
 * Worked out in Python. de Vries 1963: 2.0e6 (1 - n) + 4.18e6 n S. */
static void soil_conducts_by_its_water(void **state)
{
    (void)state;
    static const double c[][4] = {{0.435, 0.6, 0.5, 1.34374237676},  {0.4, 0.21, 0.9, 1.38009542399},
                                  {0.4, 0.19, 0.9, 1.65152213491},   {0.5, 0.6, 0, 0.17371882804},
                                  {0.5, 0.6, 0.105, 0.203938436168}, {0.5, 0.6, 1, 1.59989191797}};
    for (int k = 0; k < 6; k++) CHECK_NEAR(ground_soil_conductivity_w_mk(c[k][0], c[k][1], c[k][2]), c[k][3], 1e-10);
    CHECK_NEAR(ground_soil_capacity_j_m3k(0.435, 0.5), 2039150, 1e-6);
    CHECK_NEAR(ground_soil_capacity_j_m3k(0.5, 0), 1e6, 1e-6);
}

static const GroundWeather  noon = {.air = {290, 1000, 101325, 3, 2, 10},
                                    .direct_w_m2 = 800,
                                    .diffuse_w_m2 = 100,
                                    .longwave_w_m2 = 320,
                                    .sun_d_enu = {0.48, 0.36, 0.8}};
static const GroundExposure open = {{0, 0, 1}, 1, 1, 300};

/* A slope that looks along (0.6, 0, 0.8): the sun's cosine is 0.6 * 0.48 + 0.8 * 0.8 = 0.928, of its half space 0.9 is
 * over the horizon. Half of that sky is hidden by what has 300 K, and 0.7 of the sun arrives. On level ground there are
 * 800 * 0.8 + 100 = 740 W/m2, of which ground of absorptance 0.6 sends 0.4 to the slope's other tenth: 0.6 (0.7 * 800 *
 * 0.928 + 100 * 0.45 + 0.1 * 0.4 * 740) + 0.9 (0.45 * 320 + 0.55 sigma 300^4). A face turned from the sun has none.
 *
 * Leaves of 40 s/m in full sun and an index of 3 (Noilhan & Planton 1989, eq. 33): f = 0.55 G / 100 * 2 / 3 of the 0.7
 * * 640 + 50 = 498 W/m2 that arrive; 40 (1 + f) / (f + 40 / 5000). Water has none, rock lets no vapour through. */
static void what_a_slope_absorbs(void **state)
{
    (void)state;
    GroundKind           kind = {.absorptance = 0.6, .emissivity = 0.9, .roughness_m = 0.01, .resistance_s_m = 40};
    const GroundColumn   c = {.kind = &kind, .saturation = 0.4};
    const GroundExposure slope = {{0.6, 0, 0.8}, 0.7, 0.5, 300}, away = {{-0.6, -0.64, -0.48}, 1, 1, 300};
    SurfaceFlux          flux;
    ground_flux(&flux, &c, &noon, &slope);
    CHECK_NEAR(flux.absorbed_w_m2, 0.6 * (0.7 * 800 * 0.928 + 45 + 29.6) + 0.9 * (144 + 0.55 * stefan_w_m2k4 * 8.1e9),
               1e-9);
    CHECK(flux.resistance_s_m == INFINITY && flux.emissivity == 0.9 && flux.roughness_m == 0.01);
    ground_flux(&flux, &c, &noon, &away); /* 0.26 of its half space is sky */
    CHECK_NEAR(flux.absorbed_w_m2,
               0.6 * (100 * 0.26 + 0.74 * 0.4 * 740) + 0.9 * (0.26 * 320 + 0.74 * stefan_w_m2k4 * 8.1e9), 1e-9);
    kind.vapour = GROUND_LEAVES;
    ground_flux(&flux, &c, &noon, &slope);
    const double f = 0.55 * 498 / 150;
    CHECK_NEAR(flux.resistance_s_m, 40 * (1 + f) / (f + 0.008), 1e-9);
    kind.vapour = GROUND_WATER;
    ground_flux(&flux, &c, &noon, &slope);
    CHECK(flux.resistance_s_m == 0);
}

/* Deardorff 1978, force-restore over a day with 0.9: dS/dt = C1 (rain - E) / (1000 * 0.1 n) - 0.9 (S - deep) / day, C1
 * 0.5 from S = 0.75 up, 14 below 0.15, 14 - 22.5 (S - 0.15) in between: exponential to deep + gain day / 0.9.
 * Evaporation is the mean of the beginning's and the end's, both of the balance that the test above holds. Saturation
 * stays within 0.01 .. 1. */
static void water_at_the_top(void **state)
{
    (void)state;
    static const struct {
        double top, rain_kg_m2s[2], c1;
    } c[] = {{0.77, {2e-4, 4e-4}, 0.5},
             {0.9, {0, 0}, 0.5},
             {0.14, {0, 0}, 14},
             {0.155, {1e-4, 0}, 14 - 22.5 * 0.005},
             {0.45, {1e-4, 3e-4}, 14 - 22.5 * 0.3},
             {0.74, {0, 0}, 14 - 22.5 * 0.59}};
    GroundKind kind = {.porosity = 0.4,
                       .quartz = 0.5,
                       .saturation = 0.5,
                       .vapour = GROUND_SOIL,
                       .absorptance = 0.8,
                       .emissivity = 0.95,
                       .roughness_m = 0.01,
                       .melts_k = INFINITY};
    Column     layers;
    CHECK(ground_layers(&layers, &kind, &ground_grid_default) == STATUS_OK);
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        GroundColumn  g;
        GroundWeather w[2] = {noon, noon};
        SurfaceFlux   flux[2];
        for (int i = 0; i < 2; i++) w[i].rain_kg_m2s = c[k].rain_kg_m2s[i];
        ground_column_start(&g, &kind, &layers, 295);
        CHECK(g.saturation == 0.5);
        g.saturation = c[k].top;
        for (int i = 0; i < 2; i++) ground_flux(&flux[i], &g, &w[i], &open);
        ground_column_step(&g, 0.02, &w[0], &w[1], &open, 1800);
        const double e =
            0.5 * (surface_latent_w_m2(&flux[0], 295) + surface_latent_w_m2(&flux[1], g.state.temp_k[0])) / 2.45e6;
        const double gain = c[k].c1 * (0.5 * (c[k].rain_kg_m2s[0] + c[k].rain_kg_m2s[1]) - e) / 40;
        const double ends = 0.5 + gain * 86400 / 0.9;
        CHECK_NEAR(g.saturation, ends + (c[k].top - ends) * exp(-0.9 * 1800 / 86400), 1e-12);
    }
    for (int wet = 0; wet < 2; wet++) {
        GroundColumn  g;
        GroundWeather w = noon;
        w.rain_kg_m2s = wet ? 0.1 : 0, w.air.vapour_pa = wet ? 1000 : 0, w.air.wind_mps = wet ? 3 : 30;
        ground_column_start(&g, &kind, &layers, 340);
        kind.saturation = g.saturation = wet ? 0.9 : 0.02;
        for (int k = 0; k < 4; k++) ground_column_step(&g, 0.02, &w, &w, &open, 3600);
        CHECK(g.saturation == (wet ? 1 : 0.01));
    }
}

/* Weather of which one thing changes over an hour: a step of an hour (taken in halves as far as 1e-3 K asks) against
 * 360 of ten seconds, whose weather is straight between. What follows from the wind, in the step itself straight, is
 * not: within a seventh of the change. */
static void weather_changes_within_a_step(void **state)
{
    (void)state;
    GroundKind kind = {.rock_w_mk = 2,
                       .rock_j_m3k = 2e6,
                       .vapour = GROUND_LEAVES,
                       .absorptance = 0.8,
                       .emissivity = 0.95,
                       .roughness_m = 0.02,
                       .resistance_s_m = 40,
                       .melts_k = INFINITY};
    Column     layers;
    CHECK(ground_layers(&layers, &kind, &ground_grid_default) == STATUS_OK);
    for (int what = 0; what < 7; what++) {
        GroundWeather from = noon, to = noon;
        GroundColumn  one, many, none;
        if (what == 0) to.air.temp_k += 12;
        if (what == 1) to.air.vapour_pa = 200;
        if (what == 2) to.air.wind_mps = 6;
        if (what == 3) to.longwave_w_m2 += 200;
        kind.vapour = what == 4 ? GROUND_DRY : GROUND_LEAVES;
        if (what == 4) to.air.pressure_pa = 70000; /* of dry ground: vapour's pressure is the beginning's */
        if (what == 5)
            from.air.temp_k = to.air.temp_k = 315, from.direct_w_m2 = to.direct_w_m2 = 0, to.air.wind_mps = 4.5;
        if (what == 6) /* leaves open in the light, that is all */
            from.direct_w_m2 = to.direct_w_m2 = 0, to.diffuse_w_m2 = 250, to.longwave_w_m2 -= 150 * 0.8 / 0.95;
        ground_column_start(&one, &kind, &layers, 300);
        ground_column_start(&many, &kind, &layers, 300);
        ground_column_start(&none, &kind, &layers, 300);
        ground_column_step(&one, 1e-3, &from, &to, &open, 3600);
        GroundWeather last = from;
        for (int s = 1; s <= 360; s++) {
            GroundWeather next = from;
            const double  share = s / 360.0;
            next.air.temp_k += share * (to.air.temp_k - from.air.temp_k);
            next.air.vapour_pa += share * (to.air.vapour_pa - from.air.vapour_pa);
            next.air.wind_mps += share * (to.air.wind_mps - from.air.wind_mps);
            next.air.pressure_pa += share * (to.air.pressure_pa - from.air.pressure_pa);
            next.longwave_w_m2 += share * (to.longwave_w_m2 - from.longwave_w_m2);
            next.diffuse_w_m2 += share * (to.diffuse_w_m2 - from.diffuse_w_m2);
            ground_column_step(&many, 0, &last, &next, &open, 10);
            ground_column_step(&none, 0, &from, &from, &open, 10);
            last = next;
        }
        const double change_k = many.state.temp_k[0] - none.state.temp_k[0];
        print_message("%d: %.3f K, in small steps %.3f K; %.3f K of the change\n", what, one.state.temp_k[0],
                      many.state.temp_k[0], change_k);
        CHECK(fabs(change_k) > 0.2);
        CHECK_NEAR(one.state.temp_k[0], many.state.temp_k[0], fabs(change_k) / 7);
    }
}

/* Snow stays at its melting point, and none of it above; below layers of 2.8 m of a grid of 3 m lies half a metre. */
static void melting_and_depth(void **state)
{
    (void)state;
    GroundKind   kind = {.rock_w_mk = 0.3,
                         .rock_j_m3k = 5e5,
                         .absorptance = 0.9,
                         .emissivity = 0.95,
                         .roughness_m = 0.01,
                         .melts_k = 273.15};
    Column       layers, deep;
    GroundColumn g;
    CHECK(ground_layers(&layers, &kind, &ground_grid_default) == STATUS_OK);
    CHECK_NEAR(layers.depth_m[layers.nodes - 1], 3, 1e-12);
    ground_column_start(&g, &kind, &layers, 272);
    for (int k = 0; k < 6; k++) ground_column_step(&g, 0.02, &noon, &noon, &open, 600);
    CHECK(g.state.temp_k[0] == 273.15 && g.state.temp_k[1] > 272.1);
    for (int i = 0; i < layers.nodes; i++) CHECK(g.state.temp_k[i] <= 273.15);
    kind.layers = 1, kind.layer[0] = (ColumnLayer){2.8, 0.5, 1e6};
    CHECK(ground_layers(&deep, &kind, &ground_grid_default) == STATUS_OK);
    CHECK_NEAR(deep.depth_m[deep.nodes - 1], 3.3, 1e-12);
    kind.layer[0].thickness_m = 1;
    CHECK(ground_layers(&deep, &kind, &ground_grid_default) == STATUS_OK);
    CHECK_NEAR(deep.depth_m[deep.nodes - 1], 3, 1e-12);
}

/* Every kind has a name of its own, by which it is found; two of them are of heat alone. */
static void kinds_by_name(void **state)
{
    (void)state;
    for (int k = 1; k < SURFACE_COUNT; k++) CHECK(ground_kind_find(surface_name((SurfaceClass)k)) == k);
    CHECK(ground_kind_find("forest_floor") == ground_forest_floor && ground_kind_find("burnt") == ground_burnt);
    CHECK(ground_kind_find("sand") == SURFACE_SAND && ground_kind_find("none at all") == -1 &&
          ground_kind_find("") == -1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_balance_is_its_terms),
        cmocka_unit_test(soil_conducts_by_its_water),
        cmocka_unit_test(what_a_slope_absorbs),
        cmocka_unit_test(water_at_the_top),
        cmocka_unit_test(weather_changes_within_a_step),
        cmocka_unit_test(melting_and_depth),
        cmocka_unit_test(kinds_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
