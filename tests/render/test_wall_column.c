/* Walls and roofs against closed forms: resistances of EN ISO 6946, the steady flux out of a heated room, the response
 * of layers to a daily wave by transfer matrices (EN ISO 13786), films, a sheet after the sun. labels: physics */
#include "tests/check.h"
#include "render/heat/wall_column_private.h"

#include <complex.h>

static Materials     materials;
static Constructions constructions;

static int open_tables(void **state)
{
    (void)state;
    char path[4][512];
    return etc_path(path[0], 512, "materials.csv") && etc_path(path[1], 512, "surfaces.csv") &&
                   etc_path(path[2], 512, "constructions.csv") && etc_path(path[3], 512, "construction_layers.csv") &&
                   materials_open(&materials, path[0], path[1], NULL) == STATUS_OK &&
                   constructions_open(&constructions, path[2], path[3]) == STATUS_OK
               ? 0
               : -1;
}

static int close_tables(void **state)
{
    (void)state;
    materials_close(&materials);
    return 0;
}

static void kind_of(WallKind *out, const char *construction, const char *material)
{
    const int row = constructions_named(&constructions, construction), m = materials_find(&materials, material);
    CHECK(row >= 0 && m >= 0);
    CHECK(wall_kind(out, &constructions.row[row], &materials.material[m]) == STATUS_OK);
}

/* Air of 280 K with a sky of that temperature, or as given. */
static GroundWeather still_weather(double wind_mps)
{
    return (GroundWeather){.air = {280, 800, 101325, wind_mps, 2, 10},
                           .longwave_w_m2 = 0.8 * stefan_w_m2k4 * pow(280, 4),
                           .sun_d_enu = {0, 0, -1}};
}

/* Sums of thickness over conductivity, worked out by hand from the tables that etc/construction_layers.csv names, with
 * 0.13 or 0.10 m2K/W inside. */
static void resistances_are_those_of_the_standard(void **state)
{
    (void)state;
    static const struct {
        const char *name, *material;
        double      m2k_w;
    } c[] = {
        {"wall_brick_cavity", "brick_red", 0.103 / 0.77 + 0.18 + 0.100 / 0.18 + 0.013 / 0.57 + 0.13},
        {"wall_render_block", "concrete", 0.020 / 1.0 + 0.200 / 1.13 + 0.050 / 0.040 + 0.013 / 0.25 + 0.13},
        {"wall_stone", "stone_granite", 0.500 / 1.7 + 0.013 / 0.57 + 0.13},
        {"wall_timber_frame", "wood_pine", 0.020 / 0.13 + 0.18 + 0.009 / 0.13 + 0.140 / 0.038 + 0.013 / 0.25 + 0.13},
        {"roof_tile_insulated", "brick_red", 0.015 / 1.0 + 0.20 + 0.150 / 0.038 + 0.013 / 0.25 + 0.10},
        {"roof_felt_insulated", "asphalt_road", 0.010 / 0.23 + 0.100 / 0.025 + 0.150 / 2.0 + 0.10},
        {"glazing_double", "glass_window", 2 * 0.004 / 1.0 + 0.173 + 0.13},
    };
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        WallKind kind;
        kind_of(&kind, c[k].name, c[k].material);
        CHECK_NEAR(1 / wall_conductance_w_m2k(&kind) / c[k].m2k_w, 1, 5e-4); /* 7.69 for 1 / 0.13 */
    }
    WallKind none;
    kind_of(&none, "rail_metal", "steel_worn");
    CHECK(wall_conductance_w_m2k(&none) == 0);
}

/* Known double panes: 2.8 .. 2.9 W/(m2 K) with 0.04 outside (EN ISO 10077-1); cavity walls about 1 (CIBSE Guide A). */
static void u_values_are_those_in_use(void **state)
{
    (void)state;
    WallKind kind;
    kind_of(&kind, "glazing_double", "glass_window");
    CHECK_NEAR(1 / (1 / wall_conductance_w_m2k(&kind) + 0.04), 2.85, 0.05);
    kind_of(&kind, "glazing_single", "glass_window");
    CHECK_NEAR(1 / (1 / wall_conductance_w_m2k(&kind) + 0.04), 5.75, 0.1);
    kind_of(&kind, "wall_brick_cavity", "brick_red");
    CHECK_NEAR(1 / (1 / wall_conductance_w_m2k(&kind) + 0.04), 0.94, 0.02);
}

/* Root of a falling function between 200 and 400 K. */
static double balance_k(const WallFlux *law, double through_w_m2k, double room_k)
{
    double low = 200, high = 400;
    for (int i = 0; i < 60; i++) {
        const double t = 0.5 * (low + high), over = t - law->air_k;
        const double root = pow(fabs(over), 1.0 / 3), natural = 1.31 * root; /* of a wall */
        const double glass = sqrt(natural * natural + law->forced_w_m2k * law->forced_w_m2k);
        const double film = natural + law->rough * (glass - natural);
        const double q = law->absorbed_w_m2 - law->emissivity * 5.670374419184429e-8 * t * t * t * t - film * over +
                         through_w_m2k * (room_k - t);
        *(q > 0 ? &low : &high) = t;
    }
    return 0.5 * (low + high);
}

/* A fortnight of one night: the wall's face is where its balance with U (room - face) is, and the flux through it is
 * that. */
static void a_heated_room_loses_what_its_u_value_says(void **state)
{
    (void)state;
    static const double      room_k = 293.15, n = 14 * 144;
    static const char *const of[][2] = {
        {"wall_brick_cavity", "brick_red"}, {"wall_stone", "stone_granite"}, {"glazing_double", "glass_window"}};
    const GroundWeather w = still_weather(2);
    const WallPlace     place = {&w, 279, 0.25};
    const WallFace      north = {{0, 1, 0}, 1};
    for (int k = 0; k < 3; k++) {
        WallKind    kind;
        WallFlux    law;
        ColumnState s;
        double      falls;
        kind_of(&kind, of[k][0], of[k][1]);
        wall_start(&s, &kind, 285, room_k);
        for (int i = 0; i < n; i++) wall_step(&s, &kind, NULL, &place, &place, &north, room_k, 0.02, 600);
        wall_flux(&law, &kind, &place, &north);
        /* what is absorbed: half the sky by its root, half the ground, e of both; no sun */
        const double high = sqrt(0.5), sigma = 5.670374419184429e-8;
        CHECK_NEAR(law.absorbed_w_m2,
                   kind.emissivity * (0.5 * (high * 0.8 * sigma * pow(280, 4) + (1 - high) * sigma * pow(280, 4)) +
                                      0.5 * sigma * pow(279, 4)),
                   1e-6);
        const double u = wall_conductance_w_m2k(&kind), want_k = balance_k(&law, u, room_k);
        CHECK_NEAR(s.temp_k[0], want_k, 2e-3);
        CHECK_NEAR(-wall_flux_w_m2(&falls, s.temp_k[0], &law), u * (room_k - want_k), 0.02);
    }
}

/* The surface's response to a daily wave of flux, by transfer matrices of homogeneous layers (Carslaw & Jaeger 3.7):
 * temperature over flux at the outer face, with the room's film inside at a constant temperature. */
static double complex response(const Construction *of, double film_w_m2k)
{
    const double   w = 2 * pi_rad / 86400;
    double complex t = 1 / of->inside_w_m2k, q = 1; /* at the inner face, for a flux of 1 into the room */
    for (int l = of->layers - 1; l >= 0; l--) {
        const ColumnLayer   *at = &of->layer[l];
        const double complex g = csqrt(I * w * at->capacity_j_m3k / at->conductivity_w_mk) * at->thickness_m;
        const double complex z = at->thickness_m / at->conductivity_w_mk / g;
        const double complex t0 = ccosh(g) * t + z * csinh(g) * q, q0 = csinh(g) / z * t + ccosh(g) * q;
        t = t0, q = q0;
    }
    return t / (q + film_w_m2k * t); /* of what is absorbed, with what the film takes back */
}

static void a_daily_wave_is_that_of_transfer_matrices(void **state)
{
    (void)state;
    static const char *const of[][2] = {{"wall_brick_cavity", "brick_red"},      {"wall_stone", "stone_granite"},
                                        {"roof_felt_insulated", "asphalt_road"}, {"wall_concrete_sandwich", "concrete"},
                                        {"glazing_double", "glass_window"},      {"roof_tile_insulated", "brick_red"}};
    static const double      step_s = 600, room_k = 293.15, wave_w_m2 = 2;
    for (int k = 0; k < 6; k++) {
        GroundWeather  w[2];
        WallKind       kind;
        WallFlux       law;
        ColumnState    s;
        double         falls[2], mean_k = 0;
        double complex sum = 0;
        const WallFace up = {{0, 0, 1}, 1};
        const int      day = 144, days = 12;
        kind_of(&kind, of[k][0], of[k][1]);
        wall_start(&s, &kind, 285, room_k);
        w[0] = w[1] = still_weather(4);
        for (int i = 0; i < days * day; i++) {
            const double t = 2 * pi_rad * (i + 1) / day;
            w[0].diffuse_w_m2 = w[1].diffuse_w_m2;
            w[1].diffuse_w_m2 = 100 + wave_w_m2 / kind.absorptance * cos(t); /* a level face takes all of it */
            const WallPlace before = {&w[0], 280, 0}, after = {&w[1], 280, 0};
            wall_step(&s, &kind, NULL, &before, &after, &up, room_k, 0.001, step_s);
            if (i < (days - 1) * day) continue;
            sum += s.temp_k[0] * cexp(-I * t) * 2 / day;
            mean_k += s.temp_k[0] / day;
        }
        wall_flux(&law, &kind, &(WallPlace){&w[1], 280, 0}, &up);
        wall_flux_w_m2(&falls[0], mean_k, &law);
        const double film =
            (wall_flux_w_m2(&falls[1], mean_k - 0.1, &law) - wall_flux_w_m2(&falls[1], mean_k + 0.1, &law)) / 0.2;
        const double complex want = wave_w_m2 * response(&kind.of, film);
        print_message("%-22s wave of 2 W/m2: %.4f K, %.2f h late; by matrices %.4f K, %.2f h\n", of[k][0], cabs(sum),
                      -carg(sum) * 12 / pi_rad, cabs(want), -carg(want) * 12 / pi_rad);
        CHECK_NEAR(cabs(sum - want) / cabs(want), 0, 0.005);
    }
}

/* Films in still air at 10 K, worked out by hand: 1.31 10^(1/3) of a wall; a warm roof 9.482 / 6.238, a cold one 1.810
 * / 2.382 times that root. In wind of 5 m/s at 10 m, 3.693 m/s at the eaves: 0.5 (3.26 3.693^0.89 + 3.55 3.693^0.617).
 */
static void films_are_those_of_their_sources(void **state)
{
    (void)state;
    WallFlux     law = {.sides = 1, .air_k = 280, .emissivity = 0.9, .rough = 1};
    const double root = 2.154434690031884;
    CHECK_NEAR(wall_film_w_m2k(&law, 290, 0), 1.31 * root, 2e-3);
    CHECK_NEAR(wall_film_w_m2k(&law, 290, 1), 9.482 / 6.238 * root, 1e-9);
    CHECK_NEAR(wall_film_w_m2k(&law, 270, 1), 1.810 / 2.382 * root, 1e-9);
    CHECK_NEAR(wall_film_w_m2k(&law, 270, -1), 9.482 / 6.238 * root, 1e-9);
    WallKind            kind;
    const GroundWeather w = still_weather(5);
    kind_of(&kind, "wall_brick_cavity", "brick_red");
    wall_flux(&law, &kind, &(WallPlace){&w, 280, 0}, &(WallFace){{0, 1, 0}, 1});
    CHECK_NEAR(law.forced_w_m2k, 0.5 * (3.26 * 3.1985 + 3.55 * 2.2391), 0.01);
    const double natural = 1.31 * root, glass = hypot(natural, law.forced_w_m2k);
    CHECK_NEAR(wall_film_w_m2k(&law, 290, 0), natural + 1.67 * (glass - natural), 0.01);
    /* a wall's film is continuous in its tilt */
    CHECK_NEAR(wall_film_w_m2k(&law, 290, 1e-9), wall_film_w_m2k(&law, 290, -1e-9), 0.01);
    for (double up = -1; up <= 1; up += 0.25) /* what the air takes rises with temperature: one balance */
        for (double t = 250, last = -1e9; t < 340; t += 0.5) {
            const double takes = wall_film_w_m2k(&law, t, up) * (t - law.air_k);
            CHECK(takes > last);
            last = takes;
        }
}

/* A rail in the sun, then not: from one balance to the other by exp(-t 2 h / C), h of each side. */
static void a_sheet_follows_at_once(void **state)
{
    (void)state;
    GroundWeather day = still_weather(3), night;
    WallKind      kind;
    WallFlux      law;
    ColumnState   s;
    double        falls;
    kind_of(&kind, "rail_metal", "steel_worn"); /* 4 mm of steel: 14040 J/(m2 K) */
    night = day;
    day.direct_w_m2 = 100, day.sun_d_enu[0] = 1, day.sun_d_enu[2] = 0;
    const WallPlace sun = {&day, 280, 0}, dark = {&night, 280, 0};
    const WallFace  east = {{1, 0, 0}, 1}, west = {{-1, 0, 0}, 1};
    ColumnState     other;
    column_start(&s, &kind.column, 280);
    column_start(&other, &kind.column, 280);
    for (int i = 0; i < 144; i++) {
        wall_step(&s, &kind, NULL, &sun, &sun, &east, 0, 0.02, 600);
        wall_step(&other, &kind, NULL, &sun, &sun, &west, 0, 0.02, 600);
    }
    CHECK_NEAR(s.temp_k[0], other.temp_k[0], 1e-6); /* both sides are outside */
    const double begin_k = s.temp_k[0];
    wall_flux(&law, &kind, &dark, &east);
    double low = 250, high = 320;
    for (int i = 0; i < 60; i++) {
        const double t = 0.5 * (low + high);
        *(wall_flux_w_m2(&falls, t, &law) > 0 ? &low : &high) = t;
    }
    const double end_k = low, middle_k = 0.5 * (begin_k + end_k);
    const double h = (wall_flux_w_m2(&falls, middle_k - 0.5, &law) - wall_flux_w_m2(&falls, middle_k + 0.5, &law));
    CHECK(begin_k - end_k > 1.5);
    for (int i = 1; i <= 4; i++) {
        wall_step(&s, &kind, NULL, &dark, &dark, &east, 0, 0.02, 300);
        CHECK_NEAR(s.temp_k[0], end_k + (begin_k - end_k) * exp(-300.0 * i * h / (0.004 * 7800 * 450)), 0.05);
    }
}

/* An unheated room in a steady state is between its faces and the outer air, by h and the air change; heated ones by
 * the hour, flues by the season. */
static void rooms_are_what_they_say(void **state)
{
    (void)state;
    const Construction *barn = &constructions.row[constructions_named(&constructions, "wall_boards")];
    double              room_k = 280;
    for (int i = 0; i < 3000; i++) room_k = wall_room_step(barn, room_k, 300, 285, 600);
    CHECK_NEAR(room_k, (7.69 * 300 + 0.5 * 285) / 8.19, 1e-6);
    /* 50 kJ/(m2 K) over 8.19 W/(m2 K): 6105 s; by steps of 10 s */
    room_k = 280;
    for (int i = 0; i < 610; i++) room_k = wall_room_step(barn, room_k, 300, 300, 10);
    CHECK_NEAR(room_k, 300 - 20 * exp(-6100 * 8.19 / 50e3), 0.02);
    const Construction *house = &constructions.row[constructions_named(&constructions, "wall_brick_cavity")];
    CHECK_NEAR(wall_behind_k(house, 12, 275, 275, 0), 293.15, 1e-9);
    CHECK_NEAR(wall_behind_k(house, 3, 275, 275, 0), 289.15, 1e-9);
    CHECK_NEAR(wall_behind_k(house, 23, 275, 275, 0), 289.15, 1e-9);
    CHECK_NEAR(wall_behind_k(house, 12, 295, 295, 0), 298, 1e-9); /* summer: not heated */
    const Construction *flue = &constructions.row[constructions_named(&constructions, "chimney_in_use")];
    CHECK_NEAR(wall_behind_k(flue, 12, 275, 270, 0), 400.15, 1e-9);
    CHECK_NEAR(wall_behind_k(flue, 12, 290, 292, 0), 292, 1e-9);
    CHECK_NEAR(wall_day_step(280, 290, 86400), 290 - 10 * exp(-1), 1e-9);
}

static void parts_find_their_rows(void **state)
{
    (void)state;
    static const struct {
        const char *part, *material, *name;
        HeatRole    role;
    } c[] = {{"wall", "brick_red", "wall_brick_cavity", HEAT_DWELLING},
             {"wall", "brick_yellow", "wall_brick_solid", HEAT_PASSIVE},
             {"wall", "render_ochre", "wall_render_block", HEAT_DWELLING},
             {"wall", "stone_wall_grey", "wall_stone", HEAT_DWELLING},
             {"wall", "paint_white_wood", "wall_timber_frame", HEAT_DWELLING},
             {"wall", "timber_red", "wall_boards", HEAT_PASSIVE},
             {"wall", "sheet_green", "wall_sheet", HEAT_PASSIVE},
             {"wall", "metal_steel_galvanized", "wall_sheet_insulated", HEAT_DWELLING},
             {"roof", "roof_tile_clay", "roof_tile_insulated", HEAT_DWELLING},
             {"roof", "slate_blue", "roof_slate", HEAT_PASSIVE},
             {"roof", "felt_gravel", "roof_felt_insulated", HEAT_DWELLING},
             {"roof", "thatch_moss", "roof_thatch", HEAT_DWELLING},
             {"window", "glass_window", "glazing_double", HEAT_WINDOW},
             {"window", "glass_window", "glazing_single", HEAT_PASSIVE},
             {"window", "paint_white_wood", "frame_timber", HEAT_PASSIVE},
             {"rail", "concrete_panel", "rail_concrete", HEAT_PASSIVE},
             {"rail", "metal_steel_galvanized", "rail_metal", HEAT_PASSIVE},
             {"chimney", "brick_red", "chimney_in_use", HEAT_FLUE},
             {"container", "container_blue", "container", HEAT_PASSIVE},
             {"deck", "concrete", "deck", HEAT_PASSIVE},
             {"no such part", "canvas", "other", HEAT_PASSIVE}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++)
        assert_string_equal(
            constructions.row[constructions_find(&constructions, c[k].part, c[k].role, c[k].material)].name, c[k].name);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(resistances_are_those_of_the_standard),
        cmocka_unit_test(u_values_are_those_in_use),
        cmocka_unit_test(a_heated_room_loses_what_its_u_value_says),
        cmocka_unit_test(a_daily_wave_is_that_of_transfer_matrices),
        cmocka_unit_test(films_are_those_of_their_sources),
        cmocka_unit_test(a_sheet_follows_at_once),
        cmocka_unit_test(rooms_are_what_they_say),
        cmocka_unit_test(parts_find_their_rows),
    };
    return cmocka_run_group_tests(tests, open_tables, close_tables);
}
