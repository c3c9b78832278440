/* entities/probe_flight.c: `pitviper probe flight`: a missile against a target, a flight a row. */
#include "entities/probe_private.h"

#include "entities/flight/engagement.h"
#include "terrain/earth/geodesy.h"

#include <stdlib.h>

enum { missiles_most = 256 };

typedef struct FlightProbe {
    int     count;
    Missile missile[missiles_most];
} FlightProbe;

Status flight_probe_open(void **state, int argc, char **argv)
{
    char path[1024];
    if (argc > 2) {
        log_error("flight: usage: probe flight [TABLE]: a table like etc/missiles.csv");
        return STATUS_BAD_VALUE;
    }
    if (argc == 2) {
        if (snprintf(path, sizeof path, "%s", argv[1]) >= (int)sizeof path) {
            log_error("flight: the path of the table is longer than %zu octets", sizeof path - 1);
            return STATUS_BAD_VALUE;
        }
    } else if (!etc_path(path, sizeof path, "missiles.csv")) {
        log_error("flight: no missiles.csv in etc/");
        return STATUS_IO;
    }
    FlightProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    const Status status = missile_read_all(p->missile, missiles_most, &p->count, path);
    if (status != STATUS_OK) free(p);
    else p->count = p->count < missiles_most ? p->count : missiles_most, *state = p;
    return status;
}

void flight_probe_close(void *state) { free(state); }

static const Missile *find(const FlightProbe *p, const char *name)
{
    for (int i = 0; i < p->count; i++)
        if (strcmp(p->missile[i].name, name) == 0) return &p->missile[i];
    return NULL;
}

static double or_else(const ProbeValue *in, double otherwise) { return isnan(in->number) ? otherwise : in->number; }

static bool inside(double x, double low, double high) { return x >= low && x <= high; }

/* Columns of the input, in the order of the table in entities/probe.c. */
enum {
    at_missile,
    at_lat,
    at_lon,
    at_height,
    at_azimuth,
    at_elevation,
    at_speed,
    at_target, /* 3: place */
    at_target_v = at_target + 3,
    at_target_a = at_target_v + 3,
    at_until = at_target_a + 3,
    at_step,
    at_every,
    at_late,
    at_ranged,
    at_ground,
    at_world,
    at_air,
};

/* A vector of ENU at the launch; absent numbers are 0. */
static bool enu_vector(double out_ecef[3], const LocalFrame *frame, const ProbeValue *in, double most)
{
    double enu[3];
    for (int k = 0; k < 3; k++) {
        enu[k] = or_else(&in[k], 0);
        if (!inside(fabs(enu[k]), 0, most)) return false;
    }
    m3_mul_v3(out_ecef, frame->r_ecef_from_enu, enu);
    return true;
}

const char *flight_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    const Missile *missile = find(state, in[at_missile].text);
    if (!missile) return "missile is not a row of the table";
    const Geodetic launch = {in[at_lat].number * rad_per_deg, in[at_lon].number * rad_per_deg, in[at_height].number};
    if (!inside(in[at_lat].number, -90, 90) || !inside(in[at_lon].number, -360, 360) ||
        !inside(launch.h_m, -500, 80000))
        return "lat_deg, lon_deg must be a place, height_m -500 .. 80000";
    LocalFrame frame;
    if (local_frame_at(&frame, &launch) != STATUS_OK) return "lat_deg, lon_deg must be a place";

    FlightWorld world = flight_world();
    world.step_s = or_else(&in[at_step], 0.001);
    if (!inside(world.step_s, 0.0005, 0.01)) return "step_s must be 0.0005 .. 0.01";
    const double whole = or_else(&in[at_world], 1), air = or_else(&in[at_air], 1);
    if (!inside(whole, 0, 2) || whole != floor(whole))
        return "earth must be 1, 0 (no gravity, no turning) or 2 (no turning)";
    if (!inside(air, 0, 10)) return "air must be 0 .. 10";
    world.gravity = whole > 0;
    world.turning = whole == 1;
    world.air = air;

    Engagement   e = {.ranged = or_else(&in[at_ranged], 1) != 0, .until_s = or_else(&in[at_until], INFINITY)};
    const double azimuth = in[at_azimuth].number * rad_per_deg, elevation = in[at_elevation].number * rad_per_deg;
    const double speed_mps = or_else(&in[at_speed], missile->launch_mps);
    if (!inside(speed_mps, flight_least_mps, 3000))
        return "speed_mps (or launch_mps of the missile's row) must be 0.001 .. 3000: without speed a launch has no "
               "direction";
    if (!inside(e.until_s, 0, INFINITY)) return "until_s must be 0 or later";
    const double ahead_enu[3] = {speed_mps * sin(azimuth) * cos(elevation), speed_mps * cos(azimuth) * cos(elevation),
                                 speed_mps * sin(elevation)};
    m3_mul_v3(e.v_ecef_mps, frame.r_ecef_from_enu, ahead_enu);
    memcpy(e.p_ecef, frame.origin_ecef, sizeof e.p_ecef);

    double away[3];
    e.target = !isnan(in[at_target].number);
    for (int k = 1; k < 3; k++)
        if (isnan(in[at_target + k].number) == e.target) return "a target needs target_e_m, target_n_m and target_u_m";
    if (!enu_vector(away, &frame, &in[at_target], 5e5) ||
        !enu_vector(e.target_v_ecef_mps, &frame, &in[at_target_v], 5000) ||
        !enu_vector(e.target_a_ecef_mps2, &frame, &in[at_target_a], 500))
        return "a target's place, velocity, acceleration are at most 500000 m, 5000 m/s, 500 m/s2 in each axis";
    v3_add(e.target_ecef, frame.origin_ecef, away);
    e.sight_every_s = or_else(&in[at_every], 0);
    e.sight_late_s = or_else(&in[at_late], 0);
    if (!inside(e.sight_every_s, 0, 60)) return "sight_every_s must be 0 .. 60";
    if (!inside(e.sight_late_s, 0, (engagement_waiting_most - 2) * fmax(e.sight_every_s, world.step_s)))
        return "sight_late_s must be 0 .. 254 times sight_every_s, or step_s";
    if (!isnan(in[at_ground].number)) {
        if (!inside(in[at_ground].number, -1e5, 1e5)) return "ground_u_m must be -100000 .. 100000";
        const double up[3] = {0, 0, 1};
        e.ground = true;
        m3_mul_v3(e.normal_ecef, frame.r_ecef_from_enu, up);
        v3_add_scaled(e.on_ecef, frame.origin_ecef, in[at_ground].number, e.normal_ecef);
    }

    EngagementResult r;
    engagement_fly(&r, &e, missile, &world);
    out[0].number = r.t_s;
    for (int k = 0; k < 3; k++) {
        out[1 + k].number = r.p_ecef[k];
        out[4 + k].number = r.state.v_ecef_mps[k];
    }
    const double last[] = {r.state.mass_kg,
                           r.state.mach,
                           r.state.lateral_mps2,
                           r.state.attack_rad / rad_per_deg,
                           r.most_lateral_mps2,
                           r.most_attack_rad / rad_per_deg,
                           r.most_gimbal_rad / rad_per_deg};
    enum { lasts = sizeof last / sizeof *last };
    for (int k = 0; k < lasts; k++) out[7 + k].number = last[k];
    if (e.target && isfinite(r.miss.least_m)) {
        out[7 + lasts].number = r.miss.least_m;
        out[8 + lasts].number = r.miss.t_s;
        double enu[3];
        m3_tmul_v3(enu, frame.r_ecef_from_enu, r.miss.away_ecef);
        for (int k = 0; k < 3; k++) out[9 + lasts + k].number = enu[k];
        if (r.miss.fuzed) out[12 + lasts].number = r.miss.fuze_t_s;
    }
    out[13 + lasts].text = flight_end_name(r.end);
    out[14 + lasts].text =
        r.verdict < flight_verdict_count && r.state.tick > 0 ? flight_verdict_name(r.verdict) : "none";
    out[15 + lasts].number = (double)r.guided;
    return NULL;
}
