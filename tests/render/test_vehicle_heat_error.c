/* tests/render/test_vehicle_heat_error.c: the estimate of what steps and the past's single steps leave out of
 * entities' temperatures, against steps of a second and a past of eight times as many, with error control.
 * labels: physics */
#include "tests/render/vehicle_stage.h"

/* A clear day about the equinox at 45 degrees north; Unix time 0 is noon. */
static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)p_enu, (void)present;
    const double turn = unix_s * 2 * pi_rad / 86400, up = M_SQRT1_2 * cos(turn);
    *out = (PlaceHeat){.air_k = 288 + 5 * cos(turn - 0.7),
                       .air_density = 1,
                       .wind_enu_mps = {2, 1, 0},
                       .longwave_w_m2 = 300,
                       .ground_rho = 0.2,
                       .sun_d_enu = {-sin(turn), -M_SQRT1_2 * cos(turn), up}};
    out->ground_k = out->air_k + 10 * cos(turn - 0.4), out->under_k = out->water_k = out->air_k;
    if (up > 0) out->direct_w_m2 = 1361 * pow(0.7, pow(1 / fmax(up, 0.02), 0.678)), out->diffuse_w_m2 = 136 * up;
    return STATUS_OK;
}

static VehicleHeat *start(double unix_s, double step_s, int past_parts)
{
    return stage_start(
        &(VehicleHeatConfig){
            .step_s = step_s, .window_us = INFINITY, .past_parts = past_parts, .unix_s = unix_s, .place = everywhere},
        NULL);
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0}, truck = {1, 1, 222, 7, 1, 0, 0},
                           person = {3, 1, 225, 1, 0, 0, 0}, helicopter = {1, 2, 225, 20, 1, 0, 0},
                           house = {5, 1, 225, 1, 0, 0, 0};

typedef struct Case {
    const char   *name;
    DisEntityType type;
    double        hour;          /* of the day, at its first report */
    EntityDrives  before, after; /* five minutes after it appeared */
} Case;

/* rms of an entity's patches by area, and of their estimate. */
static void misses(double *off_k, double *estimate_k, const Scene *a, const Scene *fine, double air_k)
{
    const Patches *p = &stage.patches.of[a->entity.model];
    double         off = 0, estimate = 0, m2 = 0;
    CHECK(a->entity.patches == p->count && fine->entity.patches == p->count);
    for (int i = 0; i < p->count; i++) {
        const double k = (double)a->snapshot.patch_k[i], d = k - (double)fine->snapshot.patch_k[i],
                     e = vehicle_heat_error_k(k, air_k);
        off += patch_open_m2(&p->patch[i]) * d * d, estimate += patch_open_m2(&p->patch[i]) * e * e,
            m2 += patch_open_m2(&p->patch[i]);
    }
    *off_k = sqrt(off / m2), *estimate_k = sqrt(estimate / m2);
}

static void the_estimate_holds(void **state)
{
    (void)state;
    enum { looks = 5 };
    static const double look_s[looks] = {0, 20, 290, 330, 590};
    static const Case   cases[] = {
          {"tank that stands, morning", tank, 9, {.engine = 0}, {.engine = 0}},
          {"tank that stands, then starts", tank, 15, {.engine = 0}, {.engine = 0.6f}},
          {"tank that drives, then halts", tank, 12, {.engine = 1, .speed_mps = 10}, {.engine = 0.6f}},
          {"tank at night, idle, then drives", tank, 2, {.engine = 0.6f}, {.engine = 1, .speed_mps = 10}},
          {"tank that fires", tank, 18, {.engine = 0.6f}, {.engine = 0.6f, .fired_kg = {0, 15}}},
          {"truck that drives, then burns", truck, 10, {.engine = 1, .speed_mps = 15}, {.burning = 1}},
          {"truck that stands, evening", truck, 19, {.engine = 0}, {.engine = 0}},
          {"helicopter", helicopter, 11, {.engine = 1, .flying = 1}, {.engine = 1, .flying = 1}},
          {"person", person, 14, {.alive = 1}, {.alive = 1}},
          {"house", house, 8, {.alive = 1}, {.alive = 1}},
    };
    int held = 0, all = 0;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        Scene        s[2];
        VehicleHeat *heat[2];
        int          look = 0;
        for (int k = 0; k < 2; k++) {
            place(&s[k], cases[c].type, cases[c].before);
            heat[k] = start(3600 * (cases[c].hour - 12), k ? 1 : 30, k ? 8 : 1);
        }
        for (double t_s = 0; t_s <= look_s[looks - 1]; t_s += 1) {
            double off_k, estimate_k;
            for (int k = 0; k < 2; k++) {
                s[k].entity.drives = t_s < 300 ? cases[c].before : cases[c].after;
                s[k].snapshot.t_s = t_s;
                CHECK(vehicle_heat_tick(heat[k], &s[k].snapshot) == STATUS_OK);
            }
            if (t_s != look_s[look]) continue;
            PlaceHeat now;
            CHECK(everywhere(&now, NULL, 3600 * (cases[c].hour - 12) + t_s, (const double[3]){0}, true) == STATUS_OK);
            for (int k = 0; k < 2; k++) CHECK(vehicle_heat_show(heat[k], &s[k].snapshot, stage.arena) == STATUS_OK);
            misses(&off_k, &estimate_k, &s[0], &s[1], now.air_k);
            print_message("%s, %3.0f s: off by %.3f K, estimate %.3f K: %.2f\n", cases[c].name, t_s, off_k, estimate_k,
                          off_k / estimate_k);
            held += off_k < 2 * estimate_k && off_k > 0.5 * estimate_k;
            all++, look++;
        }
        for (int k = 0; k < 2; k++) vehicle_heat_destroy(heat[k]);
    }
    print_message("%d of %d within a factor of 2\n", held, all);
    CHECK(all == looks * (int)(sizeof cases / sizeof *cases) && held >= 0.9 * all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_estimate_holds)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
