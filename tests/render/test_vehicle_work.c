/* The account of work on entities' heat, in units that are the same on every machine: how many pieces a window of 0.1 s
 * has room for, and when a model's patches are there. */
#include "tests/render/vehicle_stage.h"

#include "render/heat/given_heat.h"
#include "render/heat/vehicle_heat_private.h"

enum { most_asked = 64 };
static double asked_unix_s[most_asked]; /* at which weather of the past was asked for */
static int    asked;

static Status everywhere(PlaceHeat *out, const void *user, double unix_s, const double p_enu[3], bool present)
{
    (void)user, (void)p_enu;
    if (!present && asked < most_asked) asked_unix_s[asked++] = unix_s;
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

/* A past is a day in steps whose loads are those of their middles: four of three hours, three of two, five of one, and
 * of the last hour, in which the engine runs as now, 2, 8, 15, 15, 10, 5 and 5 minutes. What was kept by a run that
 * ended up to three hours before is carried on in as many even steps; what is older counts for nothing. */
static void steps_of_the_past(void **state)
{
    (void)state;
    static const double minutes[] = {180, 180, 180, 180, 120, 120, 120, 60, 60, 60, 60, 60, 2, 8, 15, 15, 10, 5, 5};
    static const double gap_s[] = {-10, 0, 10, 10799, 10801};
    enum { steps = sizeof minutes / sizeof *minutes };
    double all_min = 0;
    for (int k = 0; k < steps; k++) all_min += minutes[k];
    CHECK(all_min == 24 * 60);
    for (int c = -1; c < 5; c++) {
        Scene     s;
        Snapshot  none = {0};
        KeptHeat *kept = NULL;
        int       number = 1;
        if (c >= 0) {
            char path[text_file_size], *text = malloc(20000);
            CHECK(text != NULL);
            place(&s, tank, (EntityDrives){.engine = 1});
            const VehicleHeatConfig any = {.step_s = 30, .window_us = INFINITY, .place = everywhere};
            VehicleHeat            *h = stage_start(&any, NULL);
            CHECK(vehicle_heat_tick(h, &none) == STATUS_OK);
            for (int k = 1; h->count == 0; k++) tick(h, &s, k);
            int at = sprintf(text, "entity,model,unix_s,node_k\n1:1:1,%s,%.3f,",
                             tracer_model(stage.tracer, s.entity.model)->name, 5000 - gap_s[c]);
            for (int n = 0; n < h->shape[s.entity.model].nodes; n++) at += sprintf(text + at, "300 ");
            sprintf(text + at, "\n");
            vehicle_heat_destroy(h);
            text_file(path, text);
            free(text);
            CHECK(heat_kept_open(&kept, path) == STATUS_OK);
            remove(path);
        }
        VehicleHeat *h = stage_start(
            &(VehicleHeatConfig){.step_s = 30, .window_us = INFINITY, .unix_s = 5000, .place = everywhere}, kept);
        CHECK(vehicle_heat_tick(h, &none) == STATUS_OK);
        place(&s, tank, (EntityDrives){.engine = 1});
        s.snapshot.t_s = 0.01;
        asked = 0;
        while (tick(h, &s, number), h->count == 0 || !h->state[0]->shown) number++;
        const double seen_s = h->state[0]->seen_s, since_s = seen_s + (c >= 0 ? gap_s[c] : 0);
        const bool   goes_on = c >= 0 && since_s >= 0 && since_s <= 10800;
        double       begun_s = 5000 + seen_s - (goes_on ? since_s : 86400);
        CHECK(asked == (goes_on && since_s == 0 ? 0 : steps));
        for (int k = 0; k < asked; k++) {
            const double span_s = goes_on ? since_s / steps : 60 * minutes[k];
            CHECK_NEAR(asked_unix_s[k], begun_s + 0.5 * span_s, 2e-3);
            begun_s += span_s;
        }
        vehicle_heat_destroy(h);
        if (kept) heat_kept_close(kept);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(looks_in_a_window), cmocka_unit_test(steps_in_a_window),
                                       cmocka_unit_test(steps_of_the_past)};
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
