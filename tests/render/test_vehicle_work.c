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

/* A step of the past is 2 units a patch and 0.6 a node, one of the present 3 and 1. After its looks, in an empty
 * window: one of five steps of the past has room for five of them, one of half a per cent less for four; one of all 19
 * and a step of the present shows it, one of half a per cent less does not. */
static void steps_in_a_window(void **state)
{
    (void)state;
    static const double room[] = {1.005, 0.995, 1.005, 0.995};
    for (int c = 0; c < 4; c++) {
        Scene        s;
        int          number = 1;
        VehicleHeat *h = begin(&s, 46);
        while (tick(h, &s, number), h->count == 0) number++;
        const VehicleShape *shape = &h->shape[s.entity.model];
        const double        past = 2 * shape->patches->count + 0.6 * shape->nodes,
                     present = 3 * shape->patches->count + shape->nodes;
        CHECK(shape->patches->count > 20);
        while (h->state[0]->looked < shape->patches->count) tick(h, &s, ++number); /* one every 0.1 s */
        for (int k = 1; k < 10; k++) tick(h, &s, ++number);
        CHECK(h->state[0]->lived == 0);
        h->config.window_us = room[c] * (c < 2 ? 5 * past : 19 * past + present);
        tick(h, &s, ++number);
        CHECK(h->state[0]->lived == (c == 0 ? 5 : c == 1 ? 4 : 19) && h->state[0]->shown == (c == 2));
        vehicle_heat_destroy(h);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(looks_in_a_window), cmocka_unit_test(steps_in_a_window)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
