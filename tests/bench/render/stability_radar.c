/* tests/bench/render/stability_radar.c: the field that a target scatters, under stress: ranges, offsets, needles and
 * triangles without area, wavelengths from decimetres to tenths of a millimetre, antennas in the target. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"

#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/total_field.h"

typedef struct Stand {
    Model        model;
    RadarTarget *target;
    TotalField   field;
} Stand;

static bool stand_open(Stand *s, const char *shape, double sag_m)
{
    *s = (Stand){0};
    return radar_shape_build(&s->model, shape, sag_m) == STATUS_OK &&
           radar_target_create(&s->target, &s->model, NULL, "avx2") == STATUS_OK;
}

static void stand_close(Stand *s)
{
    total_field_free(&s->field);
    radar_target_destroy(s->target);
    model_destroy(&s->model);
}

/* Computes the field of one look. False: it is refused. */
static bool look(ScatterMatrix *out, Stand *s, const ScatterAntenna *a, double f_hz)
{
    const TubeConfig config = tubes_default_config(f_hz);
    return total_field_trace(&s->field, s->target, a, a, &config, true, NULL) == STATUS_OK &&
           total_field_sweep(out, &(FrequencySweep){.count = 1, .first_hz = f_hz}, &s->field, NULL) == STATUS_OK;
}

/* Looks at a corner reflector at 94 GHz from 1 m to 1000 km away: the mirror image of a point is a point, so beyond the
 * near field its cross section tends to that of plane waves as 1 / range. */
static double ranges(void *user, bool quick)
{
    Stand  s;
    double worst = 0;
    (void)user;
    if (!stand_open(&s, "corner:0.1", 1e-3)) return INFINITY;
    ScatterAntenna a;
    ScatterMatrix  far, near;
    radar_look(&a, 0.8, 0.6, INFINITY);
    bool good = look(&far, &s, &a, 94e9);
    for (int n = 0; n <= (quick ? 4 : 12) && good; n++) {
        a.range_m = pow(10, 6.0 * n / (quick ? 4 : 12));
        good = look(&near, &s, &a, 94e9);
        if (!isfinite(scatter_power(near.hh))) worst = INFINITY;
        const double blur = 0.1 * 0.1 * 94e9 / light_mps / a.range_m; /* a^2 / lambda range */
        if (blur < 0.3) worst = fmax(worst, sqrt(scatter_power(near.hh - far.hh) / scatter_power(far.hh)) - 8 * blur);
    }
    stand_close(&s);
    return good ? worst : INFINITY;
}

/* Moves target and antenna together, up to 20 km, and turns them, at 94 GHz: the field must be the same. */
static double offsets(void *user, bool quick)
{
    Stand  s;
    double worst = 0;
    Dice   dice = {.stream = 90};
    (void)user;
    if (!stand_open(&s, "trihedral:0.1", 1e-3)) return INFINITY;
    ScatterAntenna a;
    ScatterMatrix  want, got;
    radar_look(&a, 0.7, 0.5, 3000);
    bool good = look(&want, &s, &a, 94e9);
    for (int n = 0; n < (quick ? 3 : 20) && good; n++) {
        double         p_target[3], r[9], from[3], p_antenna[3];
        ScatterAntenna seen;
        stress_any_rotation(r, &dice);
        for (int c = 0; c < 3; c++) p_target[c] = stress_uniform(&dice, -20000, 20000);
        v3_scale(from, a.range_m, a.u);
        m3_mul_v3(p_antenna, r, from);
        v3_add(p_antenna, p_antenna, p_target);
        radar_antenna(&seen, p_antenna, p_target, r);
        good = look(&got, &s, &seen, 94e9);
        worst = fmax(worst, sqrt(scatter_power(got.hh - want.hh) / scatter_power(want.hh)));
    }
    stand_close(&s);
    return good ? worst : INFINITY;
}

/* Needles, triangles of no area, corners that coincide, a plate within 1e-12 of edge-on, seen from everywhere and
 * exactly along the axes: values that are not finite. */
static double needles(void *user, bool quick)
{
    Model        m;
    RadarTarget *target = NULL;
    TotalField   field = {0};
    Dice         dice = {.stream = 91};
    double       wrong = 0;
    (void)user;
    if (stress_model(&m, 120, 40) != STATUS_OK) return INFINITY;
    for (int t = 0; t < 40; t++) {
        double p[3][3];
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++) p[v][c] = stress_uniform(&dice, -0.2, 0.2);
        if (t % 4 == 1) memcpy(p[2], p[1], sizeof p[2]);       /* no area */
        if (t % 4 == 2) v3_add_scaled(p[2], p[1], 1e-9, p[0]); /* a needle */
        if (t % 4 == 3)
            for (int v = 0; v < 3; v++) p[v][t % 3] = 0.1 + 1e-12 * v; /* across an axis */
        stress_triangle(&m, p[0], p[1], p[2]);
    }
    bool good = model_measure(&m) == STATUS_OK && radar_target_create(&target, &m, NULL, "avx2") == STATUS_OK;
    for (int n = 0; n < (quick ? 4 : 30) && good; n++) {
        const TubeConfig config = tubes_default_config(10e9);
        ScatterAntenna   a = {{0}, n % 2 ? 3 : INFINITY};
        ScatterMatrix    s;
        if (n < 3) a.u[n] = n % 2 ? -1 : 1;
        else stress_direction(a.u, &dice);
        good = total_field_trace(&field, target, &a, &a, &config, true, NULL) == STATUS_OK &&
               total_field_sweep(&s, &(FrequencySweep){.count = 1, .first_hz = 10e9}, &field, NULL) == STATUS_OK;
        wrong +=
            good && !isfinite(scatter_power(s.hh) + scatter_power(s.hv) + scatter_power(s.vh) + scatter_power(s.vv));
    }
    total_field_free(&field);
    radar_target_destroy(target);
    stress_model_free(&m);
    return good ? wrong : INFINITY;
}

/* A plate from 30 MHz to 300 GHz, square on and at grazing incidence: square on, 4 pi A^2 / lambda^2 is met; grazing,
 * values are finite. */
static double wavelengths(void *user, bool quick)
{
    Stand  s;
    double worst = 0;
    (void)user;
    if (!stand_open(&s, "plate:0.3x0.2", 1e-3)) return INFINITY;
    bool good = true;
    for (int n = 0; n <= (quick ? 4 : 16) && good; n++) {
        const double     f_hz = 3e7 * pow(1e4, (double)n / (quick ? 4 : 16)), k = 2 * pi_rad * f_hz / light_mps;
        const TubeConfig config = tubes_default_config(f_hz);
        ScatterAntenna   a;
        ScatterMatrix    m;
        radar_look(&a, 0, 0, INFINITY);
        good = tubes_trace(&s.field.hits, s.target, &a, &a, &config, NULL) == STATUS_OK &&
               field_at(&m, f_hz, &s.field.hits, NULL) == STATUS_OK;
        worst = fmax(worst, fabs(cabs(m.hh) / (k * 0.06 / (2 * pi_rad)) - 1));
        radar_look(&a, 0.5 * pi_rad - 1e-9, 0, INFINITY);
        good = good && look(&m, &s, &a, f_hz);
        if (!isfinite(scatter_power(m.hh) + scatter_power(m.vv))) worst = INFINITY;
    }
    stand_close(&s);
    return good ? worst : INFINITY;
}

static void hush(void *user, LogLevel level, const char *line) { (void)user, (void)level, (void)line; }

/* An antenna within the target's box: refused, or finite; none of it may stop the program. */
static double inside(void *user, bool quick)
{
    Stand  s;
    double wrong = 0;
    Dice   dice = {.stream = 92};
    (void)user;
    if (!stand_open(&s, "corner:0.3", 1e-3)) return INFINITY;
    log_set_sink(hush, NULL);
    for (int n = 0; n < (quick ? 10 : 60); n++) {
        ScatterAntenna a = {.range_m = stress_log_uniform(&dice, 1e-6, 1)};
        ScatterMatrix  m;
        stress_direction(a.u, &dice);
        if (look(&m, &s, &a, 10e9)) wrong += !isfinite(scatter_power(m.hh) + scatter_power(m.vv));
    }
    log_set_sink(NULL, NULL);
    stand_close(&s);
    return wrong;
}

Status bench_stability_radar(Bench *bench)
{
    static const StressCase cases[] = {
        {"radar field: a corner at 94 GHz, 1 m .. 1000 km", ranges, 1e-3, "relative",
         "plane waves, less 8 a^2 / lambda R"},
        {"radar field: moved up to 20 km and turned, 94 GHz", offsets, 1e-5, "relative", "the field at the origin"},
        {"radar field: needles, no area, along the axes", needles, 0, "values", "finite"},
        {"radar field: a plate, 30 MHz .. 300 GHz, and grazing", wavelengths, 1e-3, "relative", "4 pi A^2 / lambda^2"},
        {"radar field: antennas within the target", inside, 0, "values", "refused, or finite"},
    };
    stress_cases(bench, cases, sizeof cases / sizeof *cases, NULL);
    return STATUS_OK;
}
