/* tests/fuzz/fuzz_flight.c: any octets as the numbers of a missile and of the lines of sight that it is given while it
 * flies. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/flight/engagement.h"
#include "entities/flight/sight_filter.h"
#include "terrain/earth/geodesy.h"

#include <stdlib.h>

const int fuzz_rounds = 3000;

enum { most_steps = 40 };

/* A true sight, some of whose numbers are changed by the rounds of run_corpus.c. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const names[] = {"at_loft", "ir_ag", "laser_ag", "sam_ir", "wire_at", "bomb_laser"};
    out[0] = (uint8_t)(index % (sizeof names / sizeof *names));
    out[1] = (uint8_t)(index / 7);
    FlightSight  sight;
    const double eye[3] = {6378137 + 3000, 0, 0}, still[3] = {0}, target[3] = {6378137, 10.0 * index, 4000},
                 v[3] = {0, 5, 0};
    if (!flight_sight_true(&sight, 0.01 * (index % 9), eye, still, target, v, still)) return 0;
    for (int k = 0; k < 6; k++) memcpy(out + 2 + k * sizeof sight, &sight, sizeof sight);
    return 2 + 6 * sizeof sight;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static Missile missile[16];
    static int     missiles;
    char           path[1024];
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!missiles &&
        !(etc_path(path, sizeof path, "missiles.csv") && missile_read_all(missile, 16, &missiles, path) == STATUS_OK))
        abort();
    if (size < 2 + sizeof(FlightSight)) return 0;
    const Missile *m = &missile[data[0] % missiles];
    FlightWorld    world = flight_world();
    const double   p[3] = {6378137 + 3000, 0, 0}, v[3] = {0, m->launch_mps, 1};
    FlightState    s;
    world.air = data[1] % 3;
    world.step_s = data[1] & 64 ? 0.01 : 0.001;
    flight_launch(&s, m, &world, data[1] % 5, p, v);
    SightFilter filter = sight_filter(data[1] % 100 / 100.0);
    Miss        miss = miss_begin();
    size_t      at = 2;
    for (int i = 0; i < most_steps; i++) {
        const FlightState before = s;
        FlightSight       sight;
        FlightCommand     c;
        if (at + sizeof sight > size) at = 2;
        memcpy(&sight, data + at, sizeof sight);
        if (i % 4 == 3) at += sizeof sight;
        if (sight_filter_take(&filter, sight.t_s + 0.01 * i, sight.los_ecef) &&
            !(fabs(v3_length(filter.los_ecef) - 1) < 1e-6 && v3_is_finite(filter.rate_ecef_rps)))
            abort();
        if (i % 3 == 1 && filter.count > 0) sight_filter_sight(&sight, &filter, s.p_ecef, s.v_ecef_mps);
        if (i % 8 == 1 && v3_is_finite(sight.los_ecef)) flight_lock(&s, m, sight.los_ecef);
        flight_command(&c, m, &world, &s, &sight);
        if (c.verdict < 0 || c.verdict >= flight_verdict_count || !*flight_verdict_name(c.verdict)) abort();
        if (!flight_step(&s, m, &world, &c)) break;
        if (!v3_is_finite(s.p_ecef) || !v3_is_finite(s.v_ecef_mps) || !v3_is_finite(s.gaze_ecef)) abort();
        if (!(fabs(v3_length(s.gaze_ecef) - 1) < 1e-6)) abort();
        if (!(s.lateral_mps2 <= m->most_lateral_mps2 * (1 + 1e-9))) abort();
        if (!(s.attack_rad <= m->most_attack_rad + 1e-9)) abort();
        for (int k = 0; k < 9; k++)
            if (!(fabs(s.r_ecef_from_body[k]) <= 1 + 1e-9)) abort();
        MissLeg leg, still;
        memset(&still, 0, sizeof still);
        memcpy(leg.p0_ecef, before.p_ecef, sizeof leg.p0_ecef),
            memcpy(leg.v0_ecef_mps, before.v_ecef_mps, sizeof leg.v0_ecef_mps);
        memcpy(leg.p1_ecef, s.p_ecef, sizeof leg.p1_ecef),
            memcpy(leg.v1_ecef_mps, s.v_ecef_mps, sizeof leg.v1_ecef_mps);
        memcpy(still.p0_ecef, p, sizeof p), memcpy(still.p1_ecef, p, sizeof p);
        miss_step(&miss, flight_time_s(&before, &world), world.step_s, &leg, &still, m->fuze_m);
        if (!(miss.least_m >= 0 && miss.least_m <= 1e-3)) abort(); /* it begins there */
    }
    return 0;
}
