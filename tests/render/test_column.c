/* Conduction in layers, against closed forms (mpmath; Carslaw & Jaeger, Conduction of Heat in Solids, 1959): smooth
 * loads at the default step, steps with the sub-steps that the solver takes at a jump, graded elements.
 * labels: physics */
#include "tests/check.h"
#include "render/heat/column_private.h"

static const double day_s = 86400, step_s = 300, base_k = 300;

/* gain(t) + film (T_out(t) - T) + emissivity sigma (T_sky^4 - T^4) */
typedef struct Load {
    double steady_w_m2, wave_w_m2, film_w_m2k, out_k, out_wave_k, emissivity, sky_k;
} Load;
typedef struct Now {
    Load   load;
    double t_s, dt_s;
} Now;
typedef struct Law {
    double gain_w_m2, film_w_m2k, emissivity, sky_k;
} Law;

static double flux(double *falls, double temp_k, const void *user)
{
    const Law   *l = user;
    const double sigma = 5.670374419184429e-8;
    *falls = l->film_w_m2k + 4 * l->emissivity * sigma * pow(fabs(temp_k), 3);
    return l->gain_w_m2 - l->film_w_m2k * temp_k + l->emissivity * sigma * (pow(l->sky_k, 4) - pow(temp_k, 4));
}

static void law_at(void *out, double share, const void *user)
{
    const Now   *now = user;
    const Load  *l = &now->load;
    const double wave = sin(2 * pi_rad / day_s * (now->t_s + share * now->dt_s));
    *(Law *)out = (Law){l->steady_w_m2 + l->wave_w_m2 * wave + l->film_w_m2k * (l->out_k + l->out_wave_k * wave),
                        l->film_w_m2k, l->emissivity, l->sky_k};
}

typedef struct Run {
    Column      column;
    ColumnState state;
    double      t_s;
} Run;

static void begin(Run *r, const ColumnLayer *layer, int layers, double first_m, double growth, double temp_k)
{
    CHECK(column_create(&r->column, layer, layers, first_m, growth) == STATUS_OK);
    column_start(&r->state, &r->column, temp_k);
    r->t_s = 0;
}

static void go(Run *r, const Load *load, double until_s, double dt_s)
{
    while (r->t_s < until_s - 1e-6) {
        const Now            now = {*load, r->t_s, dt_s};
        const ColumnBoundary b = {flux, law_at, &now, 0, 0.001};
        column_step(&r->state, &r->column, NULL, &b, dt_s);
        r->t_s += dt_s;
    }
}

/* Amplitude and lag of the surface over the last day, from its first harmonic. */
static void harmonic(Run *r, const Load *load, double dt_s, double *amplitude_k, double *lag_h)
{
    double    in = 0, out = 0;
    const int steps = (int)lround(day_s / dt_s);
    for (int i = 0; i < steps; i++) {
        go(r, load, r->t_s + dt_s, dt_s);
        const double phase = 2 * pi_rad / day_s * r->t_s;
        in += r->state.temp_k[0] * sin(phase) * 2 / steps;
        out += r->state.temp_k[0] * cos(phase) * 2 / steps;
    }
    *amplitude_k = hypot(in, out);
    *lag_h = fmod(atan2(-out, in) / (2 * pi_rad) * 24 + 24, 24);
}

static const ColumnLayer shallow[] = {{0.22, 0.30, 1.28e6}}; /* for an hour */
static const ColumnLayer soil[] = {{0.9, 0.30, 1.28e6}};

static void wave_of_the_surface(void **state)
{
    (void)state;
    Run r;
    begin(&r, soil, 1, 0.002, 1.03, base_k);
    const Load held = {.film_w_m2k = 1e8, .out_k = base_k, .out_wave_k = 10};
    go(&r, &held, 12 * day_s, step_s);
    CHECK_NEAR(column_temp_k(&r.state, &r.column, 0.05) - base_k, -3.1290907532, 0.01);
    go(&r, &held, 12.25 * day_s, step_s);
    CHECK_NEAR(column_temp_k(&r.state, &r.column, 0.05) - base_k, 4.3574012633, 0.01);
}

static void wave_of_the_flux(void **state)
{
    (void)state;
    Run    r;
    double amplitude_k, lag_h;
    begin(&r, soil, 1, 0.002, 1.03, base_k);
    const Load load = {.wave_w_m2 = 300};
    go(&r, &load, 30 * day_s, step_s);
    harmonic(&r, &load, step_s, &amplitude_k, &lag_h);
    CHECK_NEAR(amplitude_k, 56.7704817, 0.01);
    CHECK_NEAR(lag_h, 3, 0.001);
}

static void asphalt_over_soil(void **state)
{
    (void)state;
    const ColumnLayer   road[] = {{0.05, 0.75, 2110 * 920.0}, {0.6, 0.30, 1.28e6}};
    static const double film[] = {0, 15}, amplitude[] = {33.4207934559, 14.0783148086},
                        lag[] = {3.76871464835, 1.37150745207};
    for (int k = 0; k < 2; k++) {
        Run    r;
        double amplitude_k, lag_h;
        begin(&r, road, 2, 0.002, 1.035, base_k);
        const Load load = {.wave_w_m2 = 300, .film_w_m2k = film[k], .out_k = base_k};
        go(&r, &load, 40 * day_s, step_s);
        harmonic(&r, &load, step_s, &amplitude_k, &lag_h);
        CHECK_NEAR(amplitude_k, amplitude[k], 0.01);
        CHECK_NEAR(lag_h, lag[k], 0.002);
    }
}

static void steps_on_soil(void **state)
{
    (void)state;
    Run r;
    begin(&r, shallow, 1, 0.0005, 1.03, base_k);
    go(&r, &(Load){.steady_w_m2 = 500}, 3600, step_s);
    CHECK_NEAR(r.state.temp_k[0] - base_k, 54.6274215296, 0.01);
    begin(&r, shallow, 1, 0.0005, 1.03, base_k);
    go(&r, &(Load){.film_w_m2k = 20, .out_k = base_k + 1}, 3600, step_s);
    CHECK_NEAR(r.state.temp_k[0] - base_k, 0.73764920506, 1e-4); /* 0.01 K of a step of 100 K */
}

/* Half of a slab 2 L thick: adiabatic at its centre. */
static void slab(void **state)
{
    (void)state;
    static const double bi[] = {1, 10}, centre[] = {0.77252638342, 0.45464055561},
                        surface[] = {0.50452192790, 0.06432895527};
    for (int k = 0; k < 2; k++) {
        const ColumnLayer layer = {0.1, 1, 1e6};
        Run               r;
        begin(&r, &layer, 1, 0.0005, 1.06, base_k + 1);
        const double until_s = 0.5 * 0.1 * 0.1 * 1e6;
        go(&r, &(Load){.film_w_m2k = bi[k] * 1 / 0.1, .out_k = base_k}, until_s, until_s / 50);
        CHECK_NEAR(r.state.temp_k[0] - base_k, surface[k], 1e-4);
        CHECK_NEAR(r.state.temp_k[r.column.nodes - 1] - base_k, centre[k], 1e-4);
    }
}

static void radiating_steel(void **state)
{
    (void)state;
    const ColumnLayer plate = {0.01, 1e6, 3.925e6}; /* conducts so well that it has one temperature */
    Run               r;
    begin(&r, &plate, 1, 0.005, 1, 400);
    go(&r, &(Load){.emissivity = 0.9}, 3600, step_s);
    CHECK_NEAR(r.state.temp_k[0], 323.02835379, 0.01);
    begin(&r, &plate, 1, 0.005, 1, 400);
    go(&r, &(Load){.emissivity = 0.9, .sky_k = 280}, 600, step_s);
    CHECK_NEAR(r.state.temp_k[0], 386.196673986, 0.01);
    go(&r, &(Load){.emissivity = 0.9, .sky_k = 280}, 3600, step_s);
    CHECK_NEAR(r.state.temp_k[0], 342.826760707, 0.01);
}

static void steady_layers(void **state)
{
    (void)state;
    const ColumnLayer wall[] = {{0.003, 45.28, 3.9e6}, {0.05, 0.03, 5e4}, {0.002, 200, 2.4e6}};
    Run               r;
    begin(&r, wall, 3, 0.001, 1.3, 300);
    const Now now = {{.film_w_m2k = 25, .out_k = 310}, 0, 1e4};
    r.column.conductance_w_m2k[r.column.nodes - 1] = 8;
    const ColumnBoundary b = {flux, law_at, &now, 295, 0.001};
    for (int k = 0; k < 50; k++) column_step(&r.state, &r.column, NULL, &b, now.dt_s);
    CHECK_NEAR(25 * (310 - r.state.temp_k[0]), 8.188922051969, 1e-8);
}

/* Sun, radiation and air over a day: what the surface let in is what the column holds. */
static void energy_is_kept(void **state)
{
    (void)state;
    Run r;
    begin(&r, soil, 1, 0.002, 1.2, 290);
    const double before = column_heat_j_m2(&r.state, &r.column);
    const Load   load = {.steady_w_m2 = 200,
                         .wave_w_m2 = 400,
                         .film_w_m2k = 12,
                         .out_k = 288,
                         .out_wave_k = 5,
                         .emissivity = 0.95,
                         .sky_k = 260};
    double       turned = 0, last = before;
    for (int k = 0; k < 144; k++) {
        go(&r, &load, (k + 1) * 600.0, 600);
        const double now = column_heat_j_m2(&r.state, &r.column);
        turned += fabs(now - last);
        last = now;
    }
    CHECK(turned > 1e6);
    CHECK_NEAR((last - before - r.state.heat_j_m2) / turned, 0, 1e-6);
}

static void an_isothermal_enclosure_stays(void **state)
{
    (void)state;
    Run r;
    begin(&r, soil, 1, 0.002, 1.2, 290);
    go(&r, &(Load){.film_w_m2k = 12, .out_k = 290, .emissivity = 0.95, .sky_k = 290}, day_s, 600);
    for (int i = 0; i < r.column.nodes; i++) CHECK_NEAR(r.state.temp_k[i], 290, 1e-7);
}

/* 1 K to 2000 K, layers of 1 um to 1 m, steps of 1e-3 to 1e5 s: finite, between what is around it. */
static void extremes(void **state)
{
    (void)state;
    static const double temps_k[] = {1, 300, 2000}, thick_m[] = {1e-6, 1e-3, 1}, dt_s[] = {1e-3, 1, 600, 1e5};
    static const double conducts[] = {0.02, 1, 400};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int t = 0; t < 3; t++)
                for (int d = 0; d < 4; d++)
                    for (int k = 0; k < 3; k++) {
                        const ColumnLayer layer = {thick_m[t], conducts[k], 2e6};
                        Run               r;
                        begin(&r, &layer, 1, thick_m[t] / 4, 1.2, temps_k[a]);
                        const Load load = {
                            .film_w_m2k = 5, .out_k = temps_k[b], .emissivity = 0.9, .sky_k = temps_k[b]};
                        const double low_k = fmin(temps_k[a], temps_k[b]), high_k = fmax(temps_k[a], temps_k[b]);
                        for (int s = 0; s < 20; s++) {
                            go(&r, &load, r.t_s + dt_s[d], dt_s[d]);
                            for (int i = 0; i < r.column.nodes; i++) {
                                CHECK(r.state.temp_k[i] > low_k - 0.02 * (high_k - low_k) - 1e-4);
                                CHECK(r.state.temp_k[i] < high_k + 0.02 * (high_k - low_k) + 1e-4);
                            }
                        }
                    }
}

/* Elements of 0.02 m that double fill 0.1 m with 0.02 + 0.04 + 0.08 = 0.14: scaled by 5/7; then 0.05 m with 0.06, by
 * 5/6. A node has half of the elements beside it. */
static void elements_fill_their_layers(void **state)
{
    (void)state;
    static const ColumnLayer layer[] = {{0.1, 1.5, 2e6}, {0.05, 0.3, 1e6}};
    static const double      size_m[] = {0.1 / 7, 0.2 / 7, 0.4 / 7, 0.1 / 6, 0.2 / 6};
    Column                   c;
    ColumnState              s = {.temp_k = {300, 298, 296, 293, 291, 290}};
    double                   depth_m = 0, heat_j_m2 = 0;
    CHECK(column_create(&c, layer, 2, 0.02, 2) == STATUS_OK && c.nodes == 6);
    for (int i = 0; i < 6; i++) {
        const double above = i > 0 ? size_m[i - 1] * (i <= 3 ? 2e6 : 1e6) : 0,
                     below = i < 5 ? size_m[i] * (i < 3 ? 2e6 : 1e6) : 0;
        CHECK_NEAR(c.capacity_j_m2k[i], (above + below) / 2, 1e-7);
        CHECK_NEAR(c.depth_m[i], depth_m, 1e-12);
        if (i < 5) {
            CHECK_NEAR(c.conductance_w_m2k[i], (i < 3 ? 1.5 : 0.3) / size_m[i], 1e-9);
            CHECK_NEAR(column_temp_k(&s, &c, depth_m + 0.25 * size_m[i]), 0.75 * s.temp_k[i] + 0.25 * s.temp_k[i + 1],
                       1e-9);
            depth_m += size_m[i];
        }
        heat_j_m2 += (above + below) / 2 * s.temp_k[i];
    }
    CHECK(c.conductance_w_m2k[5] == 0 && column_temp_k(&s, &c, -1) == 300 && column_temp_k(&s, &c, 1) == 290);
    CHECK_NEAR(column_heat_j_m2(&s, &c), heat_j_m2, 1e-4);
    /* as many nodes as there is room for, and one more */
    CHECK(column_create(&c, &(ColumnLayer){column_most_nodes - 1, 1, 1}, 1, 1, 1) == STATUS_OK &&
          c.nodes == column_most_nodes);
    CHECK(column_create(&c, &(ColumnLayer){column_most_nodes, 1, 1}, 1, 1, 1) == STATUS_BAD_VALUE);
}

typedef struct Rising {
    double from_w_m2, more_w_m2, film_w_m2k;
} Rising;

static double linear_flux(double *falls, double temp_k, const void *user)
{
    const Rising *l = user;
    *falls = l->film_w_m2k;
    return l->from_w_m2 - l->film_w_m2k * temp_k;
}

static void rising_at(void *out, double share, const void *user)
{
    const Rising *l = user;
    *(Rising *)out = (Rising){l->from_w_m2 + share * l->more_w_m2, 0, l->film_w_m2k};
}

/* The layers above over a bottom of 285 K through 4 W/(m2 K), under 12 W/(m2 K) to air of 290 K and a load that rises
 * from 400 to 700 W/m2 within an hour: one step of TR-BDF2 with its error at the surface (Hosea & Shampine 1996,
 * filtered by the last stage's matrix), the same in two halves, and backward Euler in 2^14 parts, where no error is
 * small enough; by dense matrices in Python (numpy). */
static void steps_as_published(void **state)
{
    (void)state;
    static const ColumnLayer layer[] = {{0.1, 1.5, 2e6}, {0.05, 0.3, 1e6}};
    static const double      begin_k[] = {300, 298, 296, 293, 291, 290}, error_k = 0.428173712917;
    static const struct {
        double tolerance_k;
        int    halved;
        double temp_k[6], heat_j_m2;
    } c[] = {
        {0,
         0,
         {310.744820545, 306.815584266, 300.984351374, 296.231559461, 293.629135134, 290.264670087},
         1240268.05775},
        {error_k * (1 + 1e-9),
         0,
         {310.744820545, 306.815584266, 300.984351374, 296.231559461, 293.629135134, 290.264670087},
         1240268.05775},
        {error_k * (1 - 1e-9),
         1,
         {310.612271696, 306.724339969, 301.105672162, 296.222984674, 293.521507144, 290.354443786},
         1243107.04169},
        {1e-30,
         (1 << 14) - 1,
         {310.62754986, 306.735587062, 301.111383719, 296.224724845, 293.516027864, 290.356692542},
         1244311.31846},
    };
    const Rising law = {400 + 12 * 290, 300, 12};
    for (int k = 0; k < 4; k++) {
        Column      column;
        ColumnState s = {.heat_j_m2 = 5};
        CHECK(column_create(&column, layer, 2, 0.02, 2) == STATUS_OK);
        column.conductance_w_m2k[5] = 4;
        for (int with = 0; with < 2; with++) { /* factors given, and found */
            ColumnFactors        f, half;
            const ColumnBoundary b = {linear_flux, rising_at, &law, 285, c[k].tolerance_k};
            column_factors(&f, &column, 3600);
            column_factors(&half, &column, 1800);
            f.half = &half;
            memcpy(s.temp_k, begin_k, sizeof begin_k);
            s.heat_j_m2 = 5, s.halved = 0;
            column_step(&s, &column, with ? &f : NULL, &b, 3600);
            for (int i = 0; i < 6; i++) CHECK_NEAR(s.temp_k[i], c[k].temp_k[i], 2e-8);
            CHECK_NEAR(s.heat_j_m2 - 5, c[k].heat_j_m2, 1e-3);
            CHECK(s.halved == c[k].halved);
        }
    }
}

static void wrong_layers_are_refused(void **state)
{
    (void)state;
    Column            c;
    const ColumnLayer good = {1, 1, 1e6}, bad[] = {{0, 1, 1e6}, {1, -1, 1e6}, {1, 1, NAN}, {INFINITY, 1, 1}};
    CHECK(column_create(&c, &good, 0, 0.1, 1) == STATUS_BAD_VALUE);
    CHECK(column_create(&c, &good, 1, 0, 1) == STATUS_BAD_VALUE);
    CHECK(column_create(&c, &good, 1, 1e-4, 1) == STATUS_BAD_VALUE); /* too many elements */
    for (int k = 0; k < 4; k++) CHECK(column_create(&c, &bad[k], 1, 0.1, 1) == STATUS_BAD_VALUE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wave_of_the_surface),
        cmocka_unit_test(wave_of_the_flux),
        cmocka_unit_test(asphalt_over_soil),
        cmocka_unit_test(steps_on_soil),
        cmocka_unit_test(slab),
        cmocka_unit_test(radiating_steel),
        cmocka_unit_test(steady_layers),
        cmocka_unit_test(energy_is_kept),
        cmocka_unit_test(an_isothermal_enclosure_stays),
        cmocka_unit_test(extremes),
        cmocka_unit_test(elements_fill_their_layers),
        cmocka_unit_test(steps_as_published),
        cmocka_unit_test(wrong_layers_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
