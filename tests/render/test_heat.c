/* The ground's heat over a day: tables against columns run by themselves, shade of hours past against columns shaded in
 * those hours, and what everyone knows of slopes, snow, water and nights. labels: physics */
#include "tests/scenes/paper_day.h"

#include "render/heat/heat_private.h"

static GroundKinds kinds;
static Arena      *arena;

static int open_kinds(void **state)
{
    (void)state;
    paper_kinds(&kinds);
    arena = arena_create();
    return arena == NULL;
}

static int close_kinds(void **state)
{
    (void)state;
    arena_destroy(arena);
    return 0;
}

static HeatNow *at(Heat *h, double hour)
{
    HeatNow *now;
    CHECK(heat_now(&now, h, paper_unix_s + 3600 * hour, arena) == STATUS_OK);
    return now;
}

static const double level[3] = {0, 0, 1};

static double ground_k(const HeatNow *now, int kind, double x, double y, double z)
{
    double n[3];
    CHECK(v3_normalize(n, (double[3]){x, y, z}));
    return heat_ground_k(now, kind, n, 0, 1, 1);
}

/* A column by itself from the same beginning: eight days before, so that its start is forgotten. shaded: from and to,
 * hours of the last day, without direct sun. */
static double column_k(int kind, const PaperDay *day, const double n_enu[3], double until_h, double from_h, double to_h)
{
    static const double step_s = 300, before_s = 3 * 86400;
    Column              layers;
    GroundColumn        c;
    GroundWeather       w[2];
    CHECK(ground_layers(&layers, &kinds.kind[kind], &(GroundGrid){0.0015, 1.2, 3, 0.01}) == STATUS_OK);
    ground_column_start(&c, &kinds.kind[kind], &layers, day->air_k + 3);
    paper_weather(&w[0], paper_unix_s - before_s, day);
    for (double t = -before_s; t < 3600 * until_h - 1; t += step_s) {
        const double hour = (t + 0.5 * step_s) / 3600;
        const bool   shaded = hour > from_h && hour < to_h;
        paper_weather(&w[1], paper_unix_s + t + step_s, day);
        const GroundExposure e = {{n_enu[0], n_enu[1], n_enu[2]}, shaded ? 0 : 1, 1, c.state.temp_k[0]};
        ground_column_step(&c, 0.01, &w[0], &w[1], &e, step_s);
        w[0] = w[1];
    }
    return c.state.temp_k[0];
}

static void tables_are_columns(void **state)
{
    (void)state;
    static const int    which[] = {SURFACE_GRASS, SURFACE_BARE_SOIL, SURFACE_ROAD, SURFACE_SAND, SURFACE_ROCK};
    static const double hours[] = {5, 13, 20};
    Heat               *h = paper_heat(&kinds, &paper_summer, 4, NULL);
    double              worst_k = 0;
    for (int t = 0; t < 3; t++) {
        const HeatNow *now = at(h, hours[t]);
        for (int k = 0; k < 5; k++)
            worst_k = fmax(worst_k, fabs(ground_k(now, which[k], 0, 0, 1) -
                                         column_k(which[k], &paper_summer, level, hours[t], 0, 0)));
        arena_reset(arena);
    }
    print_message("level ground against columns run by themselves: %.2f K\n", worst_k);
    CHECK(worst_k < 0.8); /* what two days of spin-up leave of deep ground, and the elements */
    heat_destroy(h);
}

/* Sun 30 degrees up in the east: the balance of a slope facing it and one facing away. */
static void slopes_face_the_sun(void **state)
{
    (void)state;
    Heat          *h = paper_heat(&kinds, &paper_summer, 0, NULL);
    const double   tilt = 30 * rad_per_deg;
    const HeatNow *morning = at(h, 7.7), *evening = at(h, 16.3), *night = at(h, 27);
    const double   low = sin(tilt), high = cos(tilt);
    const double   east_am = ground_k(morning, SURFACE_GRASS, low, 0, high),
                 west_am = ground_k(morning, SURFACE_GRASS, -low, 0, high);
    const double east_pm = ground_k(evening, SURFACE_GRASS, low, 0, high),
                 west_pm = ground_k(evening, SURFACE_GRASS, -low, 0, high);
    const double wall_e = ground_k(morning, SURFACE_BUILT, 1, 0, 0),
                 wall_w = ground_k(morning, SURFACE_BUILT, -1, 0, 0);
    print_message(
        "slopes of 30 degrees, east less west: %+.1f K in the morning, %+.1f K in the afternoon; walls %+.1f K\n",
        east_am - west_am, east_pm - west_pm, wall_e - wall_w);
    /* some 300 W/m2 between their cosines, over 30 W/(m2 K) of film, emission, moisture and soil */
    CHECK_NEAR(east_am - west_am, 10, 3);
    CHECK_NEAR(west_pm - east_pm, 10, 3);
    CHECK(wall_e - wall_w > 6 && wall_e - wall_w < 14);
    CHECK(fabs(ground_k(night, SURFACE_GRASS, low, 0, high) - ground_k(night, SURFACE_GRASS, -low, 0, high)) < 1.5);
    heat_destroy(h);
    arena_reset(arena);
}

/* Normals between the facets, against columns run for them. */
static void facets_are_close(void **state)
{
    (void)state;
    static const double n[][3] = {
        {0.3, 0.1, 0.95}, {-0.5, 0.4, 0.77}, {0.2, -0.7, 0.68}, {-0.1, -0.2, 0.97}, {0.75, 0.6, 0.28}};
    Heat  *h = paper_heat(&kinds, &paper_summer, 4, NULL);
    double sum = 0;
    for (int k = 0; k < 5; k++) {
        double unit[3];
        CHECK(v3_normalize(unit, n[k]));
        const double found = heat_ground_k(at(h, 9), SURFACE_DRY_GRASS, unit, 0, 1, 1),
                     want = column_k(SURFACE_DRY_GRASS, &paper_summer, unit, 9, 0, 0);
        print_message("normal %+.1f %+.1f: %+.2f K\n", unit[0], unit[1], found - want);
        CHECK_NEAR(found, want, 1); /* straight between facets 15 degrees apart, of 10 to 20 K from side to side */
        sum += (found - want) * (found - want) / 5;
    }
    CHECK(sqrt(sum) < 0.5);
    heat_destroy(h);
    arena_reset(arena);
}

/* Straight between the nodes of the tables, one by one: the definition of heat_ground_k. */
static double by_hand_k(const GroundHeatTable *t, int kind, const double n[3], double taken, double open, double dark)
{
    const double sum = fabs(n[0]) + fabs(n[1]) + (n[2] > 0 ? n[2] : 0), over = 1 / sum;
    const double x = 0.5 * ((n[0] + n[1]) * over + 1) * (t->facets - 1),
                 y = 0.5 * ((n[0] - n[1]) * over + 1) * (t->facets - 1);
    const int i = x < t->facets - 2 ? (int)x : t->facets - 2, j = y < t->facets - 2 ? (int)y : t->facets - 2;
    double    row[2], up_k[2];
    for (int r = 0; r < 2; r++) {
        const float *k = &t->sun_k[kind][(j + r) * t->facets + i];
        row[r] = (double)k[0] + (x - i) * ((double)k[1] - (double)k[0]);
    }
    const double sun_k = row[0] + (y - j) * (row[1] - row[0]), up = clamp(n[2], 0, 1) * (heat_ups - 1);
    const int    u = up < heat_ups - 2 ? (int)up : heat_ups - 2;
    for (int side = 0; side < 2; side++) {
        const float *k = side ? t->dark_k[kind] : t->shade_k[kind];
        up_k[side] = (double)k[u] + (up - u) * ((double)k[u + 1] - (double)k[u]);
    }
    const double shade_k = up_k[0], dark_k = up_k[1], lit_k = sun_k + taken * (shade_k - sun_k);
    return dark_k + dark * (lit_k - dark_k) +
           (1 - open) * ((double)t->hidden_k[kind] - (dark_k + dark * (shade_k - dark_k)));
}

/* Places side by side, of any kinds, against each by itself, to the bit. */
static void places_side_by_side(void **state)
{
    (void)state;
    Heat          *h = paper_heat(&kinds, &paper_summer, 4, NULL);
    const HeatNow *now = at(h, 13.2);
    for (int n = 0; n < 4000; n++) {
        HeatPlaces place;
        double     temp_k[heat_lanes];
        for (int k = 0; k < heat_lanes; k++) {
            double       v[3], unit[3];
            const double special[3] = {n % 7 - 3, (n / 7) % 3 - 1, n % 2};
            for (int c = 0; c < 3; c++)
                v[c] = random_uniform(8, (uint32_t)c, (uint64_t)k, (uint64_t)n) - (c == 2 ? 0.1 : 0.5);
            if (k == 2 || !v3_normalize(unit, v)) /* along axes and edges of the square of facets */
                if (!v3_normalize(unit, special)) unit[0] = unit[1] = 0, unit[2] = 1;
            for (int c = 0; c < 3; c++) place.n_enu[c][k] = unit[c];
            place.kind[k] = (int)(random_uniform(8, 3, (uint64_t)k, (uint64_t)n) * SURFACE_COUNT);
            place.taken[k] = k == 1 ? 0 : random_uniform(8, 4, (uint64_t)k, (uint64_t)n);
            place.open[k] = k == 3 ? 1 : random_uniform(8, 5, (uint64_t)k, (uint64_t)n);
            place.dark[k] = 0.6 + random_uniform(8, 6, (uint64_t)k, (uint64_t)n);
        }
        heat_grounds_k(temp_k, now, &place);
        for (int k = 0; k < heat_lanes; k++) {
            const double unit[3] = {place.n_enu[0][k], place.n_enu[1][k], place.n_enu[2][k]};
            const double want_k =
                by_hand_k(&now->table, place.kind[k], unit, place.taken[k], place.open[k], place.dark[k]);
            const double alone_k =
                heat_ground_k(now, place.kind[k], unit, place.taken[k], place.open[k], place.dark[k]);
            assert_memory_equal(&temp_k[k], &want_k, sizeof want_k);
            assert_memory_equal(&temp_k[k], &alone_k, sizeof alone_k);
        }
    }
    heat_destroy(h);
    arena_reset(arena);
}

/* In the shade for some hours of the day: the share of slots in those hours, against a column without that sun. */
static void shade_of_the_hours_before(void **state)
{
    (void)state;
    static const int    which[] = {SURFACE_GRASS, SURFACE_BARE_SOIL, SURFACE_ROAD};
    static const double from_h[] = {6, 9, 9, 12, 4}, to_h[] = {9, 12, 12, 15, 20}, until_h[] = {9.5, 12, 14, 18, 13};
    Heat               *h = paper_heat(&kinds, &paper_summer, 4, NULL);
    for (int c = 0; c < 5; c++) {
        const HeatNow *now = at(h, until_h[c]);
        uint8_t        shadow[heat_day_slots] = {0};
        for (int s = 0; s < now->slots; s++) {
            double hour = 0.25; /* the half hour with the sun in that place */
            for (double least = INFINITY, mid = 0.25; mid < 24; mid += 0.5) {
                GroundWeather w;
                double        miss[3];
                paper_weather(&w, paper_unix_s + 3600 * mid, &paper_summer);
                for (int k = 0; k < 3; k++) miss[k] = w.sun_d_enu[k] - (double)now->slot_d_enu[k][s];
                if (v3_length(miss) < least) least = v3_length(miss), hour = mid;
            }
            shadow[s] = hour > from_h[c] && hour < to_h[c] ? 255 : 0;
        }
        for (int k = 0; k < 3; k++) {
            const double taken = heat_taken(now, which[k], level, shadow);
            const double sunlit_k = heat_ground_k(now, which[k], level, 0, 1, 1),
                         found_k = heat_ground_k(now, which[k], level, taken, 1, 1);
            const double want_k = column_k(which[k], &paper_summer, level, until_h[c], from_h[c], to_h[c]) -
                                  column_k(which[k], &paper_summer, level, until_h[c], 0, 0);
            print_message("%s at %.1f h, shaded %g to %g h: %.2f K, column %.2f K (%.2f of the sun)\n",
                          kinds.kind[which[k]].name, until_h[c], from_h[c], to_h[c], found_k - sunlit_k, want_k, taken);
            CHECK_NEAR(found_k - sunlit_k, want_k, 0.5 + 0.12 * fabs(want_k));
        }
        arena_reset(arena);
    }
    heat_destroy(h);
}

static void what_everyone_knows(void **state)
{
    (void)state;
    Heat          *h = paper_heat(&kinds, &paper_summer, 0, NULL);
    const HeatNow *noon = at(h, 13), *dawn = at(h, 28);
    double         spread = 0, mean = 0, water[2] = {400, 0};
    int            count = 0;
    for (int s = 1; s < SURFACE_COUNT; s++) {
        const double day_k = ground_k(noon, s, 0, 0, 1), night_k = ground_k(dawn, s, 0, 0, 1);
        print_message("%-17s noon %.1f  dawn %.1f K\n", kinds.kind[s].name, day_k, night_k);
        if (s == SURFACE_SNOW) {
            CHECK(day_k <= 273.1501);
            continue;
        }
        if (s != SURFACE_WATER) CHECK(day_k > night_k + 2);
        mean += night_k, spread += night_k * night_k, count++;
    }
    mean /= count;
    print_message("spread of the classes at dawn: %.1f K\n", sqrt(spread / count - mean * mean));
    CHECK(sqrt(spread / count - mean * mean) > 1);
    for (int hour = 0; hour < 24; hour++) {
        const double k = ground_k(at(h, hour), SURFACE_WATER, 0, 0, 1);
        water[0] = fmin(water[0], k), water[1] = fmax(water[1], k);
    }
    print_message("water over the day: %.2f K\n", water[1] - water[0]);
    CHECK(water[1] - water[0] < 2); /* follows days */
    CHECK(ground_k(noon, SURFACE_ROAD, 0, 0, 1) > ground_k(noon, SURFACE_GRASS, 0, 0, 1) + 5);
    CHECK(ground_k(dawn, SURFACE_ROAD, 0, 0, 1) > ground_k(dawn, SURFACE_GRASS, 0, 0, 1));
    CHECK(ground_k(noon, SURFACE_ROCK, 0, 0, 1) < ground_k(noon, SURFACE_SAND, 0, 0, 1)); /* it conducts */
    /* dark ground by day warmer, by night as all */
    CHECK(heat_ground_k(noon, SURFACE_BARE_SOIL, level, 0, 1, 1.2) >
          heat_ground_k(noon, SURFACE_BARE_SOIL, level, 0, 1, 0.8) + 2);
    /* under crowns: colder by day, warmer by night */
    CHECK(heat_ground_k(noon, SURFACE_GRASS, level, 0.9, 0.2, 1) <
          heat_ground_k(noon, SURFACE_GRASS, level, 0, 1, 1) - 3);
    CHECK(heat_ground_k(dawn, SURFACE_GRASS, level, 0.9, 0.2, 1) >
          heat_ground_k(dawn, SURFACE_GRASS, level, 0, 1, 1) + 0.5);
    heat_destroy(h);
    arena_reset(arena);
}

/* The same bits whatever was asked before, and for any number of threads; no steps at times of the grid. */
static void a_function_of_time_alone(void **state)
{
    (void)state;
    Pool *pool;
    CHECK(pool_create(&pool, 3) == STATUS_OK);
    Heat *one = paper_heat(&kinds, &paper_summer, 10, NULL), *three = paper_heat(&kinds, &paper_summer, 10, pool);
    static const double hours[] = {10.02, 12.5, 11.03, 10.0, 13.9, 12.5};
    HeatNow            *first = NULL;
    for (int k = 0; k < 6; k++) {
        HeatNow *a = at(one, hours[k]), *b = at(three, hours[5 - k]);
        if (k == 1) first = a;
        if (k == 5) CHECK(memcmp(first, a, sizeof *a) == 0);
        if (k == 0) CHECK(memcmp(at(one, 12.5), b, sizeof *b) == 0);
    }
    const double before = ground_k(at(one, 12 - 1e-6), SURFACE_SAND, 0, 0, 1),
                 after = ground_k(at(one, 12 + 1e-6), SURFACE_SAND, 0, 0, 1);
    CHECK_NEAR(before, after, 1e-3);
    CHECK(memcmp(at(one, 5), at(one, 10), offsetof(HeatNow, slots)) != 0 ||
          ground_k(at(one, 5), SURFACE_SAND, 0, 0, 1) == ground_k(at(one, 10), SURFACE_SAND, 0, 0, 1));
    heat_destroy(one);
    heat_destroy(three);
    pool_destroy(pool);
    arena_reset(arena);
}

/* Shade of a day and more is remembered, whatever the step. */
static void a_day_is_remembered(void **state)
{
    (void)state;
    static const double steps_s[] = {60, 600, 3600};
    for (int k = 0; k < 3; k++) {
        HeatConfig c = heat_default_config();
        Heat      *h;
        c.weather = paper_weather, c.user = &paper_summer, c.unix_s = paper_unix_s + 43200, c.step_s = steps_s[k],
        c.facets = 3;
        CHECK(heat_create(&h, &kinds, &c, NULL, 0) == STATUS_OK);
        const HeatPast *p = &at(h, 12)->past[1];
        double          all_s = 0;
        for (int i = 0; i < p->count; i++) {
            if (i > 0) CHECK_NEAR(p->unix_s[i - 1] - p->unix_s[i], 0.5 * (p->span_s[i - 1] + p->span_s[i]), 1e-3);
            all_s += p->span_s[i];
        }
        CHECK(all_s >= 24 * 3600);
        heat_destroy(h);
    }
    arena_reset(arena);
}

static void same_now(Heat *a, Heat *b, double hour)
{
    const HeatNow *p = at(a, hour), *q = at(b, hour);
    for (int k = 1; k < ground_kinds; k++) {
        CHECK(memcmp(p->table.sun_k[k], q->table.sun_k[k], sizeof p->table.sun_k[k]) == 0);
        CHECK(p->table.hidden_k[k] == q->table.hidden_k[k] && p->table.slot_k[k][9] == q->table.slot_k[k][9]);
        for (int i = 0; i < 2; i++)
            CHECK(memcmp(p->past[i].watt_k[k], q->past[i].watt_k[k], sizeof p->past[i].watt_k[k]) == 0);
    }
    CHECK(memcmp(p->table.branch[0], q->table.branch[0], sizeof p->table.branch[0]) == 0);
    CHECK(p->table.air_k == q->table.air_k && p->past[1].count == q->past[1].count && p->share == q->share);
    GroundColumn m, n;
    heat_level(&m, a, SURFACE_GRASS, p->share), heat_level(&n, b, SURFACE_GRASS, q->share);
    CHECK(memcmp(m.state.temp_k, n.state.temp_k, (size_t)m.column->nodes * sizeof *m.state.temp_k) == 0);
    CHECK(m.saturation == n.saturation && m.column->nodes == n.column->nodes);
}

/* What is kept of warm ground past an entry's checksum: octets of another length, with a number that is not finite, or
 * with more of the past than there is room for, are not taken. */
static void octets_that_are_no_ground(void **state)
{
    (void)state;
    HeatConfig c = heat_default_config();
    Heat      *h;
    size_t     count = 0;
    c.weather = paper_weather, c.user = &paper_summer, c.unix_s = paper_unix_s + 43200, c.facets = 3,
    c.spin_up_s = 3600;
    CHECK(heat_create(&h, &kinds, &c, NULL, 0) == STATUS_OK);
    char        *octets = kept_write(&count, heat_kept_values, h);
    const double nan_k = NAN;
    const size_t past = sizeof(int32_t) + 2 * sizeof(double) * heat_past + 3 * sizeof(double) * heat_past +
                        3 * sizeof(float) * ground_kinds * heat_past +
                        2 * sizeof(float) * ground_kinds; /* the last of it */
    CHECK(octets && count > past && kept_read(heat_kept_values, h, octets, count));
    CHECK(!kept_read(heat_kept_values, h, octets, count - 1) && !kept_read(heat_kept_values, h, octets, 0));
    for (int32_t wrong = -1; wrong <= heat_past + 1; wrong += heat_past + 2) {
        int32_t right;
        memcpy(&right, octets + count - past, sizeof right);
        CHECK(right > 0 && right <= heat_past);
        memcpy(octets + count - past, &wrong, sizeof wrong);
        CHECK(!kept_read(heat_kept_values, h, octets, count));
        memcpy(octets + count - past, &right, sizeof right);
    }
    CHECK(kept_read(heat_kept_values, h, octets, count));
    memcpy(octets, &nan_k, sizeof nan_k);
    CHECK(!kept_read(heat_kept_values, h, octets, count));
    free(octets);
    heat_destroy(h);
}

/* Ground from the cache is as ground that was warmed, at the beginning, later, and back again; another day's is not
 * taken for it. */
static void kept_ground_is_the_same(void **state)
{
    (void)state;
    static const double hours[] = {12, 12.05, 14.3, 11, 12.4};
    const BranchKind    wood = {1, 0.2, 1e6, 0.8, 0.95};
    char                folder[temp_path_size], command[temp_path_size + 16];
    HeatConfig          c = heat_default_config();
    PaperDay            other = paper_summer;
    Heat               *h[4];
    CHECK(temp_folder(folder));
    Cache *cache = cache_open(folder, 64 << 20);
    CHECK(cache);
    c.weather = paper_weather, c.user = &paper_summer, c.unix_s = paper_unix_s + 43200, c.facets = 3;
    CHECK(heat_create(&h[0], &kinds, &c, &wood, 1) == STATUS_OK);
    c.cache = cache;
    CHECK(heat_create(&h[1], &kinds, &c, &wood, 1) == STATUS_OK && cache_counters(cache).made == 1);
    CHECK(heat_create(&h[2], &kinds, &c, &wood, 1) == STATUS_OK && cache_counters(cache).fetched == 1);
    for (int k = 0; k < 5; k++) same_now(h[0], h[1], hours[k]), same_now(h[0], h[2], hours[k]);
    other.air_k += 0.01;
    c.user = &other;
    CHECK(heat_create(&h[3], &kinds, &c, &wood, 1) == STATUS_OK && cache_counters(cache).made == 2);
    CHECK(at(h[3], 12)->table.sun_k[SURFACE_GRASS][4] != at(h[0], 12)->table.sun_k[SURFACE_GRASS][4]);
    for (int k = 0; k < 4; k++) heat_destroy(h[k]);
    cache_close(cache);
    arena_reset(arena);
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
}

/* Name of what is kept of a heat. */
static void name_of(char name[sha256_text_size], const Heat *h)
{
    CacheKey key = heat_kept_key(h);
    void    *octets;
    size_t   count;
    CHECK(key.good && !cache_fetch(&octets, &count, NULL, &key));
    memcpy(name, key.name, sha256_text_size);
}

/* Changes the lowest bit of an input: the name must be another. */
static void check_named(const Heat *h, void *input, const char *what)
{
    char           plain[sha256_text_size], other[sha256_text_size];
    unsigned char *octet = input;
    name_of(plain, h);
    *octet ^= 1;
    name_of(other, h);
    *octet ^= 1;
    if (strcmp(plain, other) == 0) fail_msg("%s is not in the name of warm ground", what);
}

/* All that warm ground follows from, each changed alone: grid, times, facets, each kind's figures and layers, wood, and
 * the weather of every time, first and last. */
static void each_input_is_in_the_name_of_warm_ground(void **state)
{
    (void)state;
    enum { times = 5 };
    static GroundWeather weather[times];
    Heat                *h = calloc(1, sizeof *h);
    CHECK(h != NULL);
    h->kinds = kinds;
    h->config = heat_default_config();
    h->branches = 2;
    h->course = (Course){.wide = 30, .coarse = 2, .fine = 3, .at = weather};
    HeatConfig   *c = &h->config;
    double *const number[] = {&c->grid.first_m, &c->grid.growth, &c->grid.depth_m, &c->grid.tolerance_k,
                              &c->step_s,       &c->spin_up_s,   &c->unix_s};
    for (size_t k = 0; k < sizeof number / sizeof *number; k++) check_named(h, number[k], "a figure of the settings");
    check_named(h, &c->facets, "facets");
    check_named(h, &h->course.wide, "wide");
    for (int k = 0; k < ground_kinds; k++) {
        GroundKind   *g = &h->kinds.kind[k];
        double *const of[] = {&g->porosity,    &g->quartz,         &g->saturation,  &g->rock_w_mk,  &g->rock_j_m3k,
                              &g->roughness_m, &g->resistance_s_m, &g->absorptance, &g->emissivity, &g->melts_k};
        for (size_t i = 0; i < sizeof of / sizeof *of; i++) check_named(h, of[i], g->name);
        check_named(h, &g->vapour, "vapour");
        for (int l = 0; l < g->layers; l++) {
            check_named(h, &g->layer[l].thickness_m, "a layer's thickness");
            check_named(h, &g->layer[l].conductivity_w_mk, "a layer's conductivity");
            check_named(h, &g->layer[l].capacity_j_m3k, "a layer's capacity");
        }
    }
    for (int k = 0; k < 2; k++) {
        BranchKind   *b = &h->branch_kind[k];
        double *const of[] = {&b->conductivity_w_mk, &b->capacity_j_m3k, &b->absorptance, &b->emissivity};
        for (int i = 0; i < 4; i++) check_named(h, of[i], "a figure of wood");
    }
    for (int t = 0; t < times; t++)
        for (size_t i = 0; i < sizeof *weather / sizeof(double); i++)
            check_named(h, (double *)&weather[t] + i, "the weather of a time");
    free(h);
}

static void settings_out_of_range(void **state)
{
    (void)state;
    HeatConfig c = heat_default_config();
    Heat      *h = NULL;
    c.weather = paper_weather, c.user = &paper_summer;
    const HeatConfig good = c;
    c.facets = 8;
    CHECK(heat_create(&h, &kinds, &c, NULL, 0) == STATUS_BAD_VALUE);
    c = good, c.step_s = 0;
    CHECK(heat_create(&h, &kinds, &c, NULL, 0) == STATUS_BAD_VALUE);
    c = good, c.unix_s = NAN;
    CHECK(heat_create(&h, &kinds, &c, NULL, 0) == STATUS_BAD_VALUE && h == NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_are_columns),        cmocka_unit_test(slopes_face_the_sun),
        cmocka_unit_test(facets_are_close),          cmocka_unit_test(places_side_by_side),
        cmocka_unit_test(shade_of_the_hours_before), cmocka_unit_test(what_everyone_knows),
        cmocka_unit_test(a_function_of_time_alone),  cmocka_unit_test(a_day_is_remembered),
        cmocka_unit_test(settings_out_of_range),     cmocka_unit_test(octets_that_are_no_ground),
        cmocka_unit_test(kept_ground_is_the_same),   cmocka_unit_test(each_input_is_in_the_name_of_warm_ground),
    };
    return cmocka_run_group_tests(tests, open_kinds, close_kinds);
}
