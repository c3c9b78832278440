/* sensor/bench/render/precision_network.c: a vehicle's network of thermal nodes: steps in time, with loads that change
 * within them and are straight between their ends; and what a step costs. */
#include "sensor/bench/render/network_vehicle.h"
#include "sensor/bench/render/rows.h"

#include "sensor/bench/turn.h"

static const double span_s = 7200, look_s = 120;
enum { looks = 60 };

typedef struct Drive {
    const NetworkVehicle *vehicle;
    Network              *network;
    double                step_s;
    Status                status;
    double                temp_k[looks][vehicle_most_nodes];
} Drive;

static void drive(void *user)
{
    Drive       *d = user;
    NetworkLoad  load[2][vehicle_most_nodes];
    double       temp_k[vehicle_most_nodes];
    const int    steps = (int)lround(span_s / d->step_s), every = (int)lround(look_s / d->step_s);
    const size_t size = (size_t)d->vehicle->nodes * sizeof *temp_k;
    memcpy(temp_k, d->vehicle->start_k, size);
    network_vehicle_loads(load[0], d->vehicle, 0);
    for (int s = 0; s < steps && d->status == STATUS_OK; s++) {
        network_vehicle_loads(load[(s + 1) % 2], d->vehicle, (s + 1) * d->step_s);
        d->status = network_step(temp_k, NULL, d->network, load[s % 2], load[(s + 1) % 2], d->step_s);
        if ((s + 1) % every == 0) memcpy(d->temp_k[(s + 1) / every - 1], temp_k, size);
    }
    bench_keep(d->temp_k);
}

static void compare(BenchSetting *point, const Drive *a, const Drive *fine)
{
    double sum = 0;
    for (int t = 0; t < looks; t++)
        for (int i = 0; i < fine->vehicle->nodes; i++) {
            const double off_k = a->temp_k[t][i] - fine->temp_k[t][i];
            bench_worse(&point->error, fabs(off_k));
            sum += off_k * off_k;
        }
    point->also = sqrt(sum / (looks * fine->vehicle->nodes));
}

static Status knob_step(Bench *bench, const NetworkVehicle *vehicle, Network *network)
{
    enum { settings = 4 };
    static const double      step_s[settings] = {10, 30, 60, 120};
    static const char *const name[settings] = {"10 s", "30 s", "60 s", "120 s"};
    static Drive set[settings], fine;
    BenchWork    work[settings];
    BenchSetting point[settings] = {0};
    fine = (Drive){.vehicle = vehicle, .network = network, .step_s = 1};
    drive(&fine);
    Status status = fine.status;
    for (int k = 0; k < settings; k++) {
        set[k] = (Drive){.vehicle = vehicle, .network = network, .step_s = step_s[k]};
        drive(&set[k]);
        if (set[k].status != STATUS_OK) status = set[k].status;
        work[k] = (BenchWork){drive, &set[k], span_s / 60};
        point[k] = (BenchSetting){.setting = name[k], .also_is = "rms, K", .is_default = step_s[k] == 30};
        compare(&point[k], &set[k], &fine);
    }
    if (status != STATUS_OK) return status;
    bench_tunable(bench, &(BenchTunable){"steps of a vehicle's heat", "render/heat/network.h", "a minute of 100 nodes",
                                         "K", "largest, over two hours, steps of 1 s", 0.2}, work, point, settings);
    return STATUS_OK;
}

Status bench_precision_network(Bench *bench)
{
    static NetworkVehicle vehicle;
    Network *network = NULL;
    network_vehicle(&vehicle, vehicle_most_nodes);
    Status status = network_vehicle_create(&network, &vehicle);
    if (status == STATUS_OK) status = knob_step(bench, &vehicle, network);
    if (status != STATUS_OK) log_error("bench: precision: network: %s", status_name(status));
    network_destroy(network);
    return status;
}

/* ---- the time of a step -------------------------------------------------------------------------- */

static const double time_step_s = 30;
enum { timed_steps = 100 };

typedef struct Timed {
    const NetworkVehicle *vehicle;
    Network              *network;
    NetworkLoad           load[timed_steps + 1][vehicle_most_nodes];
    double                temp_k[vehicle_most_nodes], heat_j;
    int                   failed;
} Timed;

static void steps(void *user)
{
    Timed *t = user;
    memcpy(t->temp_k, t->vehicle->start_k, sizeof t->temp_k);
    for (int s = 0; s < timed_steps; s++) {
        const Status status = network_step(t->temp_k, &t->heat_j, t->network, t->load[s], t->load[s + 1], time_step_s);
        t->failed += status != STATUS_OK;
    }
    bench_keep(t->temp_k);
}

Status bench_speed_network(Bench *bench)
{
    static NetworkVehicle vehicle;
    static Timed          t;
    BenchTime             time;
    network_vehicle(&vehicle, vehicle_most_nodes);
    t = (Timed){.vehicle = &vehicle};
    const Status status = network_vehicle_create(&t.network, &vehicle);
    if (status != STATUS_OK) return status;
    for (int s = 0; s <= timed_steps; s++) network_vehicle_loads(t.load[s], &vehicle, s * time_step_s);
    bench_time(&time, bench, &(BenchWork){steps, &t, timed_steps}, 1);
    BenchRow row = bench_row_of("heat of a vehicle: a step of 30 s, 100 nodes, 1 thread", &time, "steps/s", 1);
    row.error = t.failed, row.error_limit = 0, row.error_unit = "steps", row.against = "no failure";
    bench_add(bench, &row);
    network_destroy(t.network);
    return STATUS_OK;
}
