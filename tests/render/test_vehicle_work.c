/* The account of work on entities' heat, in units that are the same on every machine: how many pieces a window of 0.1 s
 * has room for, and when a model's patches are there. */
#include "tests/render/vehicle_stage.h"

#include "render/heat/vehicle_heat_private.h"

static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)unix_s, (void)p_enu, (void)present;
    *out = (PlaceHeat){.air_k = 288,
                       .air_density = 1,
                       .longwave_w_m2 = 300,
                       .ground_k = 288,
                       .under_k = 288,
                       .water_k = 288,
                       .sun_d_enu = {0, 0, 1}};
    return STATUS_OK;
}

static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0};

/* A world that has begun, of this window, and a tank that it meets at 10 ms. */
static VehicleHeat *begin(Scene *s, double window_us)
{
    Snapshot     none = {0};
    VehicleHeat *h = stage_start(&(VehicleHeatConfig){.step_s = 30, .window_us = window_us, .place = everywhere}, NULL);
    CHECK(vehicle_heat_tick(h, &none) == STATUS_OK);
    place(s, tank, (EntityDrives){.engine = 1});
    return h;
}

static void tick(VehicleHeat *h, Scene *s, int number)
{
    s->snapshot.t_s = number / 100.0;
    CHECK(vehicle_heat_tick(h, &s->snapshot) == STATUS_OK);
}

/* Its patches are there 0.1 s and 15 us a triangle after it was met. A look of a patch is 45 units: a window of 92 has
 * room for two of them, and ten ticks later for two more. */
static void looks_in_a_window(void **state)
{
    (void)state;
    Scene        s;
    VehicleHeat *h = begin(&s, 92);
    int          first = 1;
    while (tick(h, &s, first), h->count == 0) first++;
    const int    triangles = tracer_model(stage.tracer, s.entity.model)->triangle_count;
    const double wait_s = 0.1 + 15e-6 * triangles;
    print_message("%d triangles: met at 0.01 s, there at %.2f s\n", triangles, first / 100.0);
    CHECK(first / 100.0 >= 0.01 + wait_s - 1e-9 && first / 100.0 < 0.02 + wait_s - 1e-9);
    for (int k = 0; k < 30; k++) {
        if (k > 0) tick(h, &s, first + k);
        CHECK(h->state[0]->looked == 2 * (k / 10 + 1) && !h->state[0]->shown);
    }
    vehicle_heat_destroy(h);
}

/* A step of the past is 2 units a patch and 0.6 a node, one of the present 3 and 1. A window that is 1 % more than the
 * sum of both has room for as many steps of the past as fit; the last of 19 and the first of the present are in one. */
static void steps_in_a_window(void **state)
{
    (void)state;
    Scene        s;
    VehicleHeat *h = begin(&s, INFINITY);
    int          number = 1;
    tick(h, &s, number);
    const VehicleShape *shape = &h->shape[s.entity.model];
    CHECK(h->count == 1 && shape->patches->count > 20);
    const double past = 2 * shape->patches->count + 0.6 * shape->nodes,
                 present = 3 * shape->patches->count + shape->nodes;
    const int patches = shape->patches->count;
    vehicle_heat_destroy(h);
    h = begin(&s, 1.01 * (past + present));
    const int fit = (int)(1.01 * (past + present) / past);
    while (tick(h, &s, number), h->count == 0 || h->state[0]->looked < patches) number++;
    while (h->state[0]->lived == 0) tick(h, &s, ++number); /* what looking left of the window is over by then or not */
    int begun = h->state[0]->lived;
    CHECK(begun <= fit);
    for (int lived = begun; !h->state[0]->shown;) {
        int until = number + 10;
        while (number < until) tick(h, &s, ++number);
        const int now = h->state[0]->lived;
        CHECK(now <= 19 && (now == 19 || now == lived + fit || lived == begun));
        if (now == 19 && 19 - lived < fit) CHECK(19 - lived > 1 || h->state[0]->shown);
        lived = now;
    }
    vehicle_heat_destroy(h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(looks_in_a_window), cmocka_unit_test(steps_in_a_window)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
