/* Fewer echoes than scattering centres: the map of all four channels hardly changes, a target that nothing resolves is
 * one echo, and where a target is resolved nothing is merged. labels: physics small */
#include "tests/sensor/radar_scene.h"

#include "sensor/radar/seeker_radar_private.h"

static int open_models(void **state)
{
    (void)state;
    scene_folder();
    FILE *file = scene_obj("boxes", NULL);
    int   first = 1;
    /* unlike, over seven metres along and across, and two up */
    for (int i = 0; i < 16; i++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = (k < 2 ? -3.5 : 0) + (k < 2 ? 6.5 : 1.5) * random_uniform(1, 0, (uint32_t)i, (uint64_t)k);
            high[k] = low[k] + 0.3 + 0.2 * random_uniform(1, 1, (uint32_t)i, (uint64_t)k);
        }
        char name[8];
        snprintf(name, sizeof name, "box%d", i);
        first = scene_box(file, name, first, low, high);
    }
    CHECK(fclose(file) == 0);
    file = scene_obj("sphere", NULL);
    scene_sphere(file, 1, 0.1, 0, 0, 0);
    CHECK(fclose(file) == 0);
    scene_open((const char *const[]){"boxes", "sphere"}, 2);
    return 0;
}

static int close_models(void **state)
{
    (void)state;
    scene_close();
    return 0;
}

/* Nodes of the grid that points are shared out to, and between which there are points, from what the radar keeps of all
 * of them: over path, its growth, and the cosines to the right and down 0.4, 0.4, 0.25 and 0.25 apart, where they part
 * by more than 0.1 in all. Phases are those at the ends of the band, pi B / c of path, and of the interval, k / 2 of
 * its growth for each pulse; u is pi d / lambda of a cosine. */
static void nodes_of(int *nodes, int *used, const SeekerRadar *radar)
{
    enum { most = 1 << 10 };
    static const double step[4] = {0.4, 0.4, 0.25, 0.25};
    static double       x[most][4];
    static bool         taken[1 << 17];
    const RadarPreset  *p = &radar->preset;
    const double        lambda_m = light_mps / p->wave.centre_hz, u = pi_rad * p->antenna.diameter_m / lambda_m;
    const double scale[4] = {pi_rad * p->wave.bandwidth_hz / light_mps, pi_rad / lambda_m * p->wave.pulses, u, u};
    double       low[4], high[4];
    int          size[4];
    CHECK(radar->target_points <= most);
    for (int i = 0; i < radar->target_points; i++) {
        const RadarPoint *q = &radar->points.point[i];
        const double     *r = stage.view.r_enu_from_cam;
        double            d[3];
        v3_sub(d, q->p_enu, stage.view.p_enu);
        v3_normalize(d, d);
        x[i][0] = q->path_m, x[i][1] = q->path_per_pulse_m;
        for (int k = 0; k < 2; k++) x[i][2 + k] = d[0] * r[k] + d[1] * r[3 + k] + d[2] * r[6 + k];
        for (int a = 0; a < 4; a++) {
            low[a] = i == 0 ? x[i][a] : fmin(low[a], x[i][a]);
            high[a] = i == 0 ? x[i][a] : fmax(high[a], x[i][a]);
        }
    }
    *nodes = 1, *used = 0;
    for (int a = 0; a < 4; a++) {
        const double span = scale[a] * (high[a] - low[a]);
        size[a] = span > 0.1 ? 1 + (int)ceil(span / step[a]) : 1;
        printf("%s%.2f steps", a ? ", " : "", span / step[a]);
        *nodes *= size[a];
    }
    printf("\n");
    if (*nodes > (int)(sizeof taken / sizeof *taken)) return;
    memset(taken, 0, sizeof taken);
    for (int i = 0; i < radar->target_points; i++)
        for (int corner = 0; corner < 16; corner++) {
            int  at = 0, stride = 1;
            bool beside = true; /* a point on a node has no share in the next */
            for (int a = 0; a < 4; a++) {
                const double along = size[a] > 1 ? (x[i][a] - low[a]) / (high[a] - low[a]) * (size[a] - 1) : 0;
                const int    here = (int)floor(along) + (corner >> a & 1);
                beside = beside && (!(corner >> a & 1) || along > floor(along));
                at += here * stride, stride *= size[a];
            }
            if (beside && !taken[at]) taken[at] = true, ++*used;
        }
}

/* Root of the power of what merging changes over the map's own, of all channels; their numbers of echoes. */
static double changed(int *merged, int *apart, const char *preset)
{
    SeekerRadar *radar = scene_radar(preset, NULL);
    stage.scene.apart = true;
    const RadarFrame *want = scene_measure(radar);
    int               nodes, used;
    nodes_of(&nodes, &used, radar);
    stage.scene.apart = false;
    const RadarFrame *got = scene_measure(radar);
    const size_t      cells = (size_t)interval_channels * (size_t)want->map.rows * (size_t)want->map.columns;
    double            off = 0, power = 0;
    for (size_t i = 0; i < cells; i++) {
        off += scatter_power(got->map.cell[i] - want->map.cell[i]);
        power += scatter_power(want->map.cell[i]);
    }
    *merged = got->echoes, *apart = want->echoes;
    printf("%d of %d nodes\n", used, nodes);
    CHECK(*merged == (nodes > *apart / 2 ? *apart : used));
    seeker_radar_destroy(radar);
    return sqrt(off / power);
}

static void few_echoes_make_the_same_map(void **state)
{
    (void)state;
    /* still; turning, so that range rates differ; off the axis, where the pattern has a slope. So that spans are just
     * beyond a whole number of steps, or beyond what is together: 7.02 of path; 0.26 of growth; 3.05 to the right */
    static const double rps[3] = {0, 0.0016, 0}, north_m[3] = {0, 0, 12}, east_m[3] = {0, 0, 226};
    static const double yaw_rad[3] = {4 * rad_per_deg, 0, 0};
    for (int i = 0; i < 3; i++) {
        int merged, apart;
        stage.snapshot.count = 0;
        SnapshotEntity *e = scene_add(0, east_m[i], north_m[i], 0);
        const double    c = cos(yaw_rad[i]), s = sin(yaw_rad[i]), turn[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
        double          turned[9];
        m3_mul(turned, e->r_ecef_from_body, turn);
        memcpy(e->r_ecef_from_body, turned, sizeof turned);
        e->w_body_rps[2] = rps[i];
        const double off = changed(&merged, &apart, "search_ku");
        printf("boxes %g m off the axis, turning by %g rad/s: %d echoes of %d, %.2f %% of the map\n", north_m[i],
               rps[i], merged, apart, 100 * off);
        CHECK(merged < apart / 2 && off < 0.02 && off > 1e-9);
    }
}

static void one_echo_of_what_nothing_resolves(void **state)
{
    (void)state;
    int merged, apart;
    stage.snapshot.count = 0;
    scene_add(1, 0, 0, 0);
    const double off = changed(&merged, &apart, "search_ku");
    printf("a sphere of 0.1 m: %d echo of %d, %.2f %% of the map\n", merged, apart, 100 * off);
    CHECK(merged == 1 && apart > 1 && off < 0.05);
}

static void what_is_resolved_stays(void **state)
{
    (void)state;
    int merged, apart;
    stage.snapshot.count = 0;
    scene_add(0, 0, 0, 0)->w_body_rps[2] = 2;
    CHECK(changed(&merged, &apart, "seeker_35") == 0 && merged == apart);
}

/* What sample m of row n has of echoes, by the formula of echo.h at the frequency and time of interval_private.h; an
 * LFM pulse of 20 us. */
static double complex sample_of(const Echo *echo, int count, int channel, int m, int n)
{
    const double   f_hz = 35e9 + (m - 256) * 5e8 / 512, t_s = (n - 31.5) / 2e4 + (m - 256) * 20e-6 / 512;
    double complex sum = 0;
    for (int i = 0; i < count; i++)
        sum += echo[i].amplitude[channel] *
               cexp(-2 * pi_rad * I * f_hz / light_mps * (echo[i].path_m + echo[i].path_per_pulse_m * 2e4 * t_s));
    return sum;
}

/* By path and its growth alone, whatever the directions: 14 m and 0.043 mm are 73.4 and 1 rad at the ends of band and
 * interval, which is 185 x 4 nodes 0.4 rad apart at most. Between two of them exp(j x) is off by x^2 / 2 <= 0.02 for an
 * echo half way, at the ends; over the band, the interval and all places by 0.02 (8 / 15)^(1/2) (1 / 5)^(1/2) = 0.0065
 * for either axis. What spins stays as it is, and all of them where nodes would be more than half as many. */
static void echoes_are_merged_by_path_and_growth(void **state)
{
    (void)state;
    enum { count = 2000, spinning = 10 };
    static Echo       echo[count], merged[count];
    static bool       spins[count];
    const RadarPreset preset = {
        .wave =
            {.centre_hz = 35e9, .bandwidth_hz = 5e8, .pulse_s = 20e-6, .repeat_hz = 2e4, .samples = 512, .pulses = 64},
        .antenna = {.diameter_m = 0.18, .taper = 1, .wavelength_m = light_mps / 35e9}};
    const RadarShot shot = {.preset = &preset, .arena = stage.arena};
    double          off = 0, power = 0;
    for (uint64_t i = 0; i < count; i++) {
        double normal[2 * interval_channels];
        random_normals(normal, 2 * interval_channels, 4, 0, 0, 2 * interval_channels * i);
        echo[i] = (Echo){14 * random_uniform(4, 1, 0, i), 4.3e-5 * random_uniform(4, 2, 0, i), {0}};
        for (int c = 0; c < interval_channels; c++) echo[i].amplitude[c] = CMPLX(normal[2 * c], normal[2 * c + 1]);
        spins[i] = i % (count / spinning) == 7;
        if (spins[i]) echo[i].path_per_pulse_m = 1e-3 * (double)i / count;
    }
    memcpy(merged, echo, sizeof echo);
    const int left = shot_merge_echoes(merged, spins, count, &shot);
    CHECK(left > 600 + spinning && left <= 740 + spinning);
    for (int i = 0, at = 0; i < count; i++)
        if (spins[i]) CHECK(memcmp(&merged[at++], &echo[i], sizeof *echo) == 0);
    for (int c = 0; c < interval_channels; c += 3)
        for (int m = 0; m < 512; m += 73)
            for (int n = 0; n < 64; n += 9) {
                const double complex want = sample_of(echo, count, c, m, n);
                off += scatter_power(sample_of(merged, left, c, m, n) - want), power += scatter_power(want);
            }
    printf("%d echoes of %d: %.2f %% of their sum\n", left, count, 100 * sqrt(off / power));
    CHECK(off < 0.015 * 0.015 * power && off > 0.003 * 0.003 * power);
    for (int i = 0; i < count; i++) echo[i].path_per_pulse_m *= 20;
    memcpy(merged, echo, sizeof echo);
    CHECK(shot_merge_echoes(merged, spins, count, &shot) == count && memcmp(merged, echo, sizeof echo) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_echoes_make_the_same_map), cmocka_unit_test(echoes_are_merged_by_path_and_growth),
        cmocka_unit_test(one_echo_of_what_nothing_resolves), cmocka_unit_test(what_is_resolved_stays)};
    return cmocka_run_group_tests(tests, open_models, close_models);
}
