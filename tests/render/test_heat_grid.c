/* Columns on their grid of time: ground so thin that it is always in balance, against that balance for every normal, in
 * the open, in the shade, without sun and without sky; the past in its intervals, and what each left, against the decay
 * of a body of one temperature; half hours of the sun. labels: physics */
#include "tests/check.h"

#include "render/heat/heat_private.h"

static GroundKinds kinds; /* conducts well and holds little: some minutes after a change it is in balance */
static Arena      *arena;

static int open_kinds(void **state)
{
    (void)state;
    for (int k = 0; k < ground_kinds; k++)
        kinds.kind[k] = (GroundKind){.rock_w_mk = 100,
                                     .rock_j_m3k = 5e3,
                                     .roughness_m = 0.01 * (k + 1),
                                     .vapour = GROUND_DRY,
                                     .absorptance = 0.4 + 0.02 * k,
                                     .emissivity = 0.98 - 0.02 * k,
                                     .melts_k = INFINITY};
    arena = arena_create();
    return arena == NULL;
}

static int close_kinds(void **state)
{
    (void)state;
    arena_destroy(arena);
    return 0;
}

/* The same at all times; the sun in the north east. */
static void still_weather(GroundWeather *out, double unix_s, const void *user)
{
    (void)unix_s, (void)user;
    *out = (GroundWeather){.air = {288, 900, 101325, 3, 2, 10},
                           .direct_w_m2 = 700,
                           .diffuse_w_m2 = 110,
                           .longwave_w_m2 = 310,
                           .sun_d_enu = {0.48, 0.36, 0.8}};
}

static HeatConfig config_of(double unix_s, double step_s, double spin_up_s, int facets, HeatWeather *weather)
{
    HeatConfig c = heat_default_config();
    c.grid = (GroundGrid){0.25, 1, 0.5, 0.002};
    c.unix_s = unix_s, c.step_s = step_s, c.spin_up_s = spin_up_s, c.facets = facets, c.weather = weather;
    return c;
}

/* Temperature at which the balance of a kind is even, by halving. */
static double even_k(int kind, const GroundWeather *w, const GroundExposure *e)
{
    const GroundColumn c = {.kind = &kinds.kind[kind]};
    SurfaceFlux        flux;
    double             low_k = 150, high_k = 450, falls;
    ground_flux(&flux, &c, w, e);
    for (int n = 0; n < 60; n++) {
        const double k = 0.5 * (low_k + high_k);
        *(surface_flux_w_m2(&falls, k, &flux) > 0 ? &low_k : &high_k) = k;
    }
    return low_k;
}

/* Facet (u, v) of a square of five: (a, b) = (u, v) / 2 - 1, x = (a + b) / 2, y = (a - b) / 2, up = 1 - |x| - |y|: the
 * middle is level, the edge are walls. What a slope sees below the horizon is level ground; what sees no sky, air. */
static void columns_are_in_balance(void **state)
{
    (void)state;
    const BranchKind wood[2] = {{3, 0.5, 1e4, 0.7, 0.95}, {4, 0.5, 1e4, 0.3, 0.6}};
    HeatConfig       c = config_of(1e9, 600, 6 * 3600, 5, still_weather);
    GroundWeather    w, dark;
    HeatNow         *now;
    Heat            *h;
    still_weather(&w, 0, NULL);
    dark = w, dark.direct_w_m2 = dark.diffuse_w_m2 = 0;
    CHECK(heat_create(&h, &kinds, &c, wood, 2) == STATUS_OK);
    CHECK(heat_now(&now, h, 1e9 + 4000, arena) == STATUS_OK);
    CHECK_NEAR(now->table.air_k, 288, 1e-9);
    for (int k = 1; k < ground_kinds; k++) {
        const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
        const double         level_k = even_k(k, &w, &level);
        for (int v = 0; v < 5; v++)
            for (int u = 0; u < 5; u++) {
                const double   a = 0.5 * u - 1, b = 0.5 * v - 1, x = 0.5 * (a + b), y = 0.5 * (a - b);
                GroundExposure e = {{x, y, 1 - fabs(x) - fabs(y)}, 1, 1, level_k};
                v3_normalize(e.n_enu, e.n_enu);
                CHECK_NEAR((double)now->table.sun_k[k][5 * v + u], even_k(k, &w, &e), 0.02);
            }
        for (int i = 0; i < heat_ups; i++) {
            const double         up = i / 3.0;
            const GroundExposure e = {{sqrt(1 - up * up), 0, up}, 0, 1, level_k};
            CHECK_NEAR((double)now->table.shade_k[k][i], even_k(k, &w, &e), 0.02);
            CHECK_NEAR((double)now->table.dark_k[k][i], even_k(k, &dark, &e), 0.02);
        }
        const GroundExposure hidden = {{0, 0, 1}, 0, 0, 288};
        CHECK_NEAR((double)now->table.hidden_k[k], even_k(k, &w, &hidden), 0.02);
        GroundColumn column;
        heat_level(&column, h, k, now->share);
        CHECK_NEAR(column.state.temp_k[0], level_k, 0.02);
        /* how fast level ground gives heat away there: the slope of its balance */
        SurfaceFlux  flux;
        double       falls;
        GroundColumn of = {.kind = &kinds.kind[k]};
        ground_flux(&flux, &of, &w, &level);
        const double slope =
            50 * (surface_flux_w_m2(&falls, level_k - 0.01, &flux) - surface_flux_w_m2(&falls, level_k + 0.01, &flux));
        for (int back = 0; back < 30; back++)
            CHECK_NEAR((double)h->state[k].falls_w_m2k[place_of(h->index - back)], slope, 0.01 * slope);
        const Sky *sky = &h->sky[place_of(h->index - 3)];
        CHECK(sky->direct_w_m2 == 700 && sky->diffuse_w_m2 == 110);
        CHECK_NEAR(sky->loss_w_m2, stefan_w_m2k4 * pow(288, 4) - 310, 1e-9);
    }
    const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
    const double         grass_k = even_k(SURFACE_GRASS, &w, &level);
    for (int k = 0; k < 2; k++)
        for (int r = 0; r < 3; r++)
            for (int shade = 0; shade < 2; shade++) {
                Branch             b;
                BranchSides        want;
                const BranchSides *got = &now->table.branch[k][r][shade];
                heat_branch_start(&b, &wood[k], branch_radius_m[r], 290);
                for (int s = 0; s < 60; s++) heat_branch_step(&b, &w, shade ? 0 : 1, grass_k, 600);
                heat_branch_sides(&want, &b);
                CHECK_NEAR((double)got->mean_k, (double)want.mean_k, 0.02);
                for (int i = 0; i < 3; i++) CHECK_NEAR((double)got->side_k[i], (double)want.side_k[i], 0.01);
                CHECK_NEAR((double)got->twice_k[1], (double)want.twice_k[1], 0.01);
            }
    CHECK(now->branches == 2 && now->branch_material[0] == 3 && now->branch_material[1] == 4);
    CHECK(now->kind_of[SURFACE_FOREST_CONIFER] == ground_forest_floor && now->kind_of[SURFACE_GRASS] == SURFACE_GRASS);
    CHECK(now->slots == heat_day_slots); /* the sun does not set */
    heat_destroy(h);
    arena_reset(arena);
}

/* A sun whose direction says the time: east millions of seconds since 1e9, up while it is six to eighteen hours UTC. */
static void telling_weather(GroundWeather *out, double unix_s, const void *user)
{
    const double hour = (unix_s - floor(unix_s / 86400) * 86400) / 3600;
    still_weather(out, unix_s, user);
    out->sun_d_enu[0] = (unix_s - 1e9) / 1e6, out->sun_d_enu[1] = 0;
    out->sun_d_enu[2] = hour > 6 && hour < 18 ? 0.5 : -0.5;
    out->direct_w_m2 = out->sun_d_enu[2] > 0 ? 700 : 0;
    out->diffuse_w_m2 = 0;
}

/* Half hours of the day with the sun up, by their middles; those that have not come yet are of the day before. What the
 * past's intervals left is theirs by halves of an hour, each where its own middle lies. Begun at two times, of which
 * the middles of half hours lie a minute before the end of a half hour, and at its beginning. */
static void half_hours_of_the_sun(void **state)
{
    (void)state;
    static const double minutes[2] = {12 * 60 + 14, 15 * 60 + 15};
    for (int c = 0; c < 2; c++) {
        const double day_s_ = 86400.0 * floor(1e9 / 86400 + 2), begin_s = day_s_ + 60 * minutes[c];
        HeatConfig   config = config_of(begin_s, 60, 31 * 3600, 3, telling_weather);
        float        d[3][heat_day_slots];
        HeatNow     *now;
        Heat        *h;
        CHECK(heat_create(&h, &kinds, &config, NULL, 0) == STATUS_OK);
        CHECK(heat_now(&now, h, begin_s, arena) == STATUS_OK);
        CHECK(heat_slots(d, h) == 24 && now->slots == 24);
        for (int s = 0; s < 24; s++) {
            double at_s = day_s_ + 6 * 3600 + 900 + 1800 * s;
            if (at_s > begin_s) at_s -= 86400;
            CHECK_NEAR((double)d[0][s], (at_s - 1e9) / 1e6, 1e-6);
            CHECK(d[2][s] == 0.5f && now->slot_d_enu[0][s] == d[0][s]);
        }
        /* the grid's time of the beginning itself: its table is the first of the two */
        const HeatPast *p = &now->past[0];
        float           want[heat_day_slots] = {0};
        for (int i = 0; i < p->count; i++) {
            const int parts = p->span_s[i] > 1800 ? 2 : 1; /* an hour, half an hour, ten minutes */
            for (int part = 0; part < parts; part++) {
                const double middle_s = p->unix_s[i] + (parts == 1 ? 0 : part ? 900 : -900);
                const int    slot = (int)floor((middle_s - 86400 * floor(middle_s / 86400)) / 1800) - 12;
                if (slot >= 0 && slot < 24) want[slot] += p->sun_k[SURFACE_SAND][i] / (float)parts;
            }
        }
        for (int s = 0; s < 24; s++)
            CHECK_NEAR((double)h->table[0].slot_k[SURFACE_SAND][s], (double)want[s],
                       1e-6 * fabs((double)want[s]) + 1e-12);
        heat_destroy(h);
        arena_reset(arena);
    }
}

/* Ten minutes for three hours, half hours to six, hours to thirty, in whole steps and no less than one; not before the
 * spin-up's first time, nor further than what is remembered. */
static void the_past_in_intervals(void **state)
{
    (void)state;
    static const struct {
        double  step_s;
        int64_t first; /* steps back */
        int     count[3];
        double  span_s[3];
    } c[] = {{600, 1000, {18, 6, 24}, {600, 1800, 3600}}, {60, 5000, {18, 6, 24}, {600, 1800, 3600}},
             {3600, 100, {3, 3, 24}, {3600, 3600, 3600}}, {1200, 100, {9, 5, 24}, {1200, 2400, 3600}},
             {600, 30, {18, 4, 0}, {600, 1800, 0}},       {600, 29, {18, 3, 0}, {600, 1800, 0}}};
    Heat *h = calloc(1, sizeof *h);
    CHECK(h != NULL);
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        static HeatPast past;
        Interval        interval[heat_past];
        h->config = config_of(0, c[k].step_s, 3600, 3, telling_weather);
        h->index = (int64_t)(1e9 / c[k].step_s), h->first = h->index - c[k].first;
        h->layers[1].capacity_j_m2k[0] = 3e4, h->layers[1].conductance_w_m2k[0] = 60;
        const int count = heat_past_begin(h, &past, interval);
        double    end_s = (double)h->index * c[k].step_s;
        int       i = 0;
        CHECK(count == c[k].count[0] + c[k].count[1] + c[k].count[2] && past.count == count);
        for (int part = 0; part < 3; part++)
            for (int n = 0; n < c[k].count[part]; n++, i++) {
                CHECK_NEAR(past.span_s[i], c[k].span_s[part], 1e-9);
                CHECK_NEAR(past.unix_s[i], end_s - 0.5 * c[k].span_s[part], 1e-6);
                CHECK_NEAR((double)interval[i].to * c[k].step_s, end_s, 1e-6);
                end_s -= c[k].span_s[part];
                CHECK_NEAR((double)interval[i].from * c[k].step_s, end_s, 1e-6);
                CHECK_NEAR(past.sun_d_enu[i][0], (past.unix_s[i] - 1e9) / 1e6, 1e-9);
            }
        CHECK_NEAR((double)past.effusivity[1], sqrt(2 * 3e4 * 60), 0.01);
    }
    free(h);
}

/* A slab of one temperature, C J/(m2 K), that loses f W/(m2 K): what one W/m2 over an interval from a to b seconds ago
 * left is (exp(-a f / C) - exp(-b f / C)) / f. The sun's of that is by its mean and the absorptance, the sky's by its
 * light less emissivity times what it takes. Losses f = 20, a sun that falls by 0.5 W/m2 a step, from 600 W/m2 now. */
static void what_a_watt_left(void **state)
{
    (void)state;
    const ColumnLayer layer = {0.1, 1e5, 1e6};
    const double      c = 1e5, f = 20;
    static HeatPast   past;
    Interval          interval[heat_past];
    Heat             *h = calloc(1, sizeof *h);
    CHECK(h != NULL && column_create(&h->layers[3], &layer, 1, 0.1, 1) == STATUS_OK);
    h->config = config_of(0, 600, 3600, 3, telling_weather);
    h->index = 1000, h->first = 0;
    h->kinds.kind[3] = (GroundKind){.absorptance = 0.7, .emissivity = 0.9};
    for (int s = 0; s < 1000; s++) {
        h->sky[place_of(1000 - s)] = (Sky){600 - 0.5 * s, 80 + s, 90 + 0.25 * s};
        h->state[3].falls_w_m2k[place_of(1000 - s)] = (float)f;
    }
    const int count = heat_past_begin(h, &past, interval);
    heat_past_respond(&(PastJob){h, interval, count, &past}, 0, 3);
    CHECK(count == 48);
    double ago_s = 0;
    for (int i = 0; i < count; i++) {
        const double to_s = ago_s + past.span_s[i], steps = 0.5 * (ago_s + to_s) / 600;
        const double want = (exp(-ago_s * f / c) - exp(-to_s * f / c)) / f;
        const double slack = 8e-3 * want + 2e-6;
        CHECK_NEAR((double)past.watt_k[3][i], want, slack);
        CHECK_NEAR((double)past.sun_k[3][i], want * 0.7 * (600 - 0.5 * steps), 500 * slack);
        CHECK_NEAR((double)past.sky_k[3][i], want * (0.7 * (80 + steps) - 0.9 * (90 + 0.25 * steps)), 100 * slack);
        ago_s = to_s;
    }
    free(h);
}

/* What heat_create and heat_now take, and what they do not. */
static void bounds(void **state)
{
    (void)state;
    const HeatConfig good = config_of(1e9, 600, 600, 3, still_weather);
    Heat            *h = NULL;
    for (int k = 0; k < 16; k++) {
        HeatConfig c = good;
        int        branches = 0;
        if (k == 0) c.facets = 1;
        if (k == 1) c.facets = 4;
        if (k == 2) c.facets = 19;
        if (k == 3) c.step_s = 59.9, c.spin_up_s = 599;
        if (k == 4) c.step_s = 3601, c.spin_up_s = 36010;
        if (k == 5) c.spin_up_s = 590;
        if (k == 6) c.spin_up_s = 600 * 1.05e5;
        if (k == 7) c.unix_s = 1.05e11;
        if (k == 8) c.unix_s = -1.05e11;
        if (k == 9) branches = -1;
        if (k == 10) branches = branch_most_kinds + 1;
        if (k == 11) c.facets = 2;
        if (k <= 11) {
            CHECK(heat_create(&h, &kinds, &c, NULL, branches) == STATUS_BAD_VALUE && h == NULL);
            continue;
        }
        if (k == 13) c.step_s = 60, c.spin_up_s = 60;
        if (k == 14) c.step_s = c.spin_up_s = 3600;
        if (k == 15) c.unix_s = -0.95e11;
        HeatNow *now;
        CHECK(heat_create(&h, &kinds, &c, NULL, branches) == STATUS_OK);
        CHECK(heat_now(&now, h, 1.05e12 * c.step_s, arena) == STATUS_BAD_VALUE &&
              heat_now(&now, h, NAN, arena) == STATUS_OK);
        heat_destroy(h);
        h = NULL;
    }
    arena_reset(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(columns_are_in_balance),
                                       cmocka_unit_test(half_hours_of_the_sun), cmocka_unit_test(the_past_in_intervals),
                                       cmocka_unit_test(what_a_watt_left), cmocka_unit_test(bounds)};
    return cmocka_run_group_tests(tests, open_kinds, close_kinds);
}
