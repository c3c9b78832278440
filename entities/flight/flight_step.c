/* entities/flight/flight_step.c: forces, one step of Runge-Kutta, and the attitude and gaze at its end. */
#include "entities/flight/flight_private.h"

#include "terrain/earth/geodesy.h"
#include "terrain/earth/gravity.h"
#include "terrain/weather/standard_atmosphere.h"

static const double near_m = 6e6, far_m = 2e7; /* of the Earth's centre */

/* ---- the missile over time ----------------------------------------------------------------------- */

double missile_mass_kg(const Missile *missile, double age_s)
{
    double mass_kg = missile->mass_kg, begins_s = missile->ignite_s;
    for (int k = 0; k < missile_stages; k++) {
        if (missile->burn_s[k] > 0)
            mass_kg -= missile->burn_kg[k] * clamp((age_s - begins_s) / missile->burn_s[k], 0, 1);
        begins_s += missile->burn_s[k];
    }
    return mass_kg;
}

double missile_thrust_n(const Missile *missile, double age_s)
{
    double begins_s = missile->ignite_s;
    for (int k = 0; k < missile_stages; k++) {
        if (age_s >= begins_s && age_s < begins_s + missile->burn_s[k]) return missile->thrust_n[k];
        begins_s += missile->burn_s[k];
    }
    return 0;
}

double missile_burnt_s(const Missile *missile)
{
    double s = missile->ignite_s;
    for (int k = 0; k < missile_stages; k++) s += missile->burn_s[k];
    return s;
}

double missile_drag(const Missile *missile, double mach)
{
    if (!(mach > missile_mach[0])) return missile->drag[0];
    for (int k = 1; k < missile_drag_nodes; k++)
        if (mach <= missile_mach[k]) {
            const double part = (mach - missile_mach[k - 1]) / (missile_mach[k] - missile_mach[k - 1]);
            return missile->drag[k - 1] + part * (missile->drag[k] - missile->drag[k - 1]);
        }
    return missile->drag[missile_drag_nodes - 1];
}

/* ---- an instant ---------------------------------------------------------------------------------- */

void flight_up(double up_ecef[3], const double p_ecef[3])
{
    Geodetic place = {0};
    (void)geodetic_from_ecef(&place, p_ecef); /* p is finite: held at launch and at each step's end */
    up_ecef[0] = cos(place.lat_rad) * cos(place.lon_rad);
    up_ecef[1] = cos(place.lat_rad) * sin(place.lon_rad);
    up_ecef[2] = sin(place.lat_rad);
}

static double height_of(const double p_ecef[3])
{
    Geodetic place = {0};
    (void)geodetic_from_ecef(&place, p_ecef);
    return place.h_m;
}

void flight_instant(FlightInstant *at, const FlightWorld *world, const FlightState *state)
{
    double air_mps[3];
    v3_sub(air_mps, at->v_ecef_mps, world->wind_ecef_mps);
    at->speed_mps = v3_length(air_mps);
    for (int k = 0; k < 3; k++)
        at->ahead_ecef[k] =
            at->speed_mps > flight_least_mps ? air_mps[k] / at->speed_mps : state->r_ecef_from_body[3 * k];
    earth_gravitation(at->falls_ecef_mps2, at->p_ecef);
    v3_scale(at->falls_ecef_mps2, world->gravity, at->falls_ecef_mps2);
    earth_turning(at->falls_ecef_mps2, at->p_ecef, at->v_ecef_mps, world->turning * earth_turn_rps);
    at->h_m = height_of(at->p_ecef);
    at->climbed_m = at->h_m - state->launch_h_m;
}

/* Forces at an instant, of a given autopilot state. */
typedef struct Forces {
    double mach, lift_n, drag_n; /* lift_n: of sin(angle of attack) 1, the thrust's share included */
    double most_mps2;            /* lateral acceleration that is possible */
    double lateral_mps2[3];      /* that acts */
    double sine;                 /* of the angle of attack */
    double a_ecef_mps2[3];       /* of the whole, in turning axes */
} Forces;

static void find_forces(Forces *out, const FlightInstant *at, const double lag_mps2[3], const Missile *missile,
                        const FlightWorld *world, double mass_kg, double thrust_n)
{
    StandardAir air;
    Forces      f = {0};
    standard_atmosphere(&air, at->h_m - world->geoid_m);
    const double push_n =
        0.5 * world->air * air.density_kg_m3 * at->speed_mps * at->speed_mps * missile->area_m2; /* q S */
    f.mach = at->speed_mps / air.sound_mps;
    f.lift_n = push_n * missile->lift_slope + thrust_n;
    f.most_mps2 = fmin(missile->most_lateral_mps2, f.lift_n * sin(missile->most_attack_rad) / mass_kg);
    v3_across(f.lateral_mps2, lag_mps2, at->ahead_ecef);
    const double asked_mps2 = v3_length(f.lateral_mps2);
    if (asked_mps2 > f.most_mps2) v3_scale(f.lateral_mps2, f.most_mps2 / asked_mps2, f.lateral_mps2);
    f.sine = f.lift_n > 0 ? mass_kg * v3_length(f.lateral_mps2) / f.lift_n : 0;
    f.drag_n = push_n * (missile_drag(missile, f.mach) + missile->lift_slope * f.sine * f.sine);
    const double along_mps2 = (thrust_n * sqrt(fmax(0, 1 - f.sine * f.sine)) - f.drag_n) / mass_kg;
    v3_add(f.a_ecef_mps2, at->falls_ecef_mps2, f.lateral_mps2);
    v3_add_scaled(f.a_ecef_mps2, f.a_ecef_mps2, along_mps2, at->ahead_ecef);
    *out = f;
}

/* ---- one step ------------------------------------------------------------------------------------ */

enum { parts = 12 }; /* position, velocity, autopilot, its rate */

typedef struct Leg {
    const Missile       *missile;
    const FlightWorld   *world;
    const FlightState   *state;
    const FlightCommand *command;
    double launched_s, thrust_n; /* the motor is what it is in the middle of the step: burns end on the grid */
} Leg;

static void slope(double out[parts], const double y[parts], double t_s, const Leg *leg)
{
    const Missile *m = leg->missile;
    FlightInstant  at = {.t_s = t_s};
    Forces         f;
    double         wanted[3], turn_rps[3], carried[3];
    memcpy(at.p_ecef, y, sizeof at.p_ecef);
    memcpy(at.v_ecef_mps, y + 3, sizeof at.v_ecef_mps);
    flight_instant(&at, leg->world, leg->state);
    find_forces(&f, &at, y + 6, m, leg->world, missile_mass_kg(m, t_s - leg->launched_s), leg->thrust_n);
    flight_law(wanted, m, leg->command, &at);
    const double asked_mps2 = v3_length(wanted);
    if (asked_mps2 > f.most_mps2) v3_scale(wanted, f.most_mps2 / asked_mps2, wanted);

    /* the autopilot's axes turn with the velocity, without roll: what is across it stays across it */
    v3_cross(turn_rps, at.ahead_ecef, f.a_ecef_mps2);
    v3_scale(turn_rps, at.speed_mps > flight_least_mps ? 1 / at.speed_mps : 0, turn_rps);
    v3_cross(carried, turn_rps, y + 6);
    double *rate = out + 6, *rate2 = out + 9;
    for (int k = 0; k < 3; k++) {
        out[k] = y[3 + k];
        out[3 + k] = f.a_ecef_mps2[k];
        rate[k] = (m->damping > 0 ? y[9 + k] : (wanted[k] - y[6 + k]) / m->lag_s) + carried[k];
    }
    v3_cross(carried, turn_rps, y + 9);
    for (int k = 0; k < 3; k++)
        rate2[k] = m->damping > 0
                       ? ((wanted[k] - y[6 + k]) / m->lag_s - 2 * m->damping * y[9 + k]) / m->lag_s + carried[k]
                       : 0;
}

/* Attitude at a grid point: the body's axis is turned from the velocity through the air by the angle of attack, which
 * it follows in half the autopilot's time: else a motor that lights would turn it in no time. share: of that way since
 * the grid point before. */
static void set_attitude(FlightState *state, const FlightInstant *at, const Forces *f, double share)
{
    double       x[3], y[3], z[3], down[3], wanted[3];
    const double lateral_mps2 = v3_length(f->lateral_mps2);
    v3_scale(wanted, lateral_mps2 > 0 ? f->sine / lateral_mps2 : 0, f->lateral_mps2);
    v3_across(state->attack_ecef, state->attack_ecef, at->ahead_ecef);
    for (int k = 0; k < 3; k++) state->attack_ecef[k] += share * (wanted[k] - state->attack_ecef[k]);
    const double sine = fmin(v3_length(state->attack_ecef), 1);
    v3_scale(x, sqrt(1 - sine * sine), at->ahead_ecef);
    v3_add(x, x, state->attack_ecef);
    if (!v3_normalize(x, x)) memcpy(x, at->ahead_ecef, sizeof x);
    flight_up(down, at->p_ecef);
    v3_scale(down, -1, down);
    v3_cross(y, down, x);
    if (!(v3_length(y) > 1e-6)) { /* straight up or down: as it was */
        for (int k = 0; k < 3; k++) z[k] = state->r_ecef_from_body[3 * k + 2];
        v3_cross(y, z, x);
    }
    if (!v3_normalize(y, y)) { /* the axis lies where down was */
        const double other[3] = {fabs(x[0]) < 0.5, fabs(x[0]) >= 0.5, 0};
        v3_cross(y, other, x);
        v3_normalize(y, y);
    }
    v3_cross(z, x, y);
    for (int k = 0; k < 3; k++) {
        state->r_ecef_from_body[3 * k] = x[k];
        state->r_ecef_from_body[3 * k + 1] = y[k];
        state->r_ecef_from_body[3 * k + 2] = z[k];
    }
    state->attack_rad = asin(sine);
}

/* Turns a unit vector towards another by an angle at most. */
static void turn_towards(double u[3], const double to[3], double most_rad)
{
    double across[3], cross[3];
    v3_cross(cross, u, to);
    const double angle_rad = atan2(v3_length(cross), v3_dot(u, to));
    if (angle_rad <= most_rad) {
        memcpy(u, to, sizeof across);
        return;
    }
    v3_across(across, to, u);
    if (!v3_normalize(across, across)) return; /* opposite: no way is the shorter */
    v3_scale(u, cos(most_rad), u);
    v3_add_scaled(u, u, sin(most_rad), across);
    v3_normalize(u, u);
}

/* The gaze within the cone about the body's axis. */
static void hold_gimbal(FlightState *state, const Missile *missile)
{
    double forward[3];
    for (int k = 0; k < 3; k++) forward[k] = state->r_ecef_from_body[3 * k];
    double held[3];
    memcpy(held, forward, sizeof held);
    turn_towards(held, state->gaze_ecef, missile->gimbal_rad);
    memcpy(state->gaze_ecef, held, sizeof held);
}

void flight_lock(FlightState *state, const Missile *missile, const double los_ecef[3])
{
    double los[3];
    if (!v3_normalize(los, los_ecef)) return;
    memcpy(state->gaze_ecef, los, sizeof los);
    hold_gimbal(state, missile);
}

/* What a grid point shows of the state's position, velocity and autopilot. */
static void note(FlightState *state, const Missile *missile, const FlightWorld *world, double share)
{
    FlightInstant at = {.t_s = flight_time_s(state, world)};
    Forces        f;
    const double  age_s = (double)(state->tick - state->launch_tick) * world->step_s;
    memcpy(at.p_ecef, state->p_ecef, sizeof at.p_ecef);
    memcpy(at.v_ecef_mps, state->v_ecef_mps, sizeof at.v_ecef_mps);
    flight_instant(&at, world, state);
    state->mass_kg = missile_mass_kg(missile, age_s);
    state->thrust_n = missile_thrust_n(missile, age_s + 0.5 * world->step_s);
    find_forces(&f, &at, state->lag_mps2, missile, world, state->mass_kg, state->thrust_n);
    state->mach = f.mach;
    state->lateral_mps2 = v3_length(f.lateral_mps2);
    state->most_lateral_mps2 = f.most_mps2;
    set_attitude(state, &at, &f, share);
}

void flight_launch(FlightState *out, const Missile *missile, const FlightWorld *world, int64_t tick,
                   const double p_ecef[3], const double v_ecef_mps[3])
{
    FlightState s = {.tick = tick, .launch_tick = tick, .launch_h_m = height_of(p_ecef)};
    m3_identity(s.r_ecef_from_body);
    memcpy(s.p_ecef, p_ecef, sizeof s.p_ecef);
    memcpy(s.v_ecef_mps, v_ecef_mps, sizeof s.v_ecef_mps);
    note(&s, missile, world, 1);
    for (int k = 0; k < 3; k++) s.gaze_ecef[k] = s.r_ecef_from_body[3 * k];
    *out = s;
}

bool flight_step(FlightState *state, const Missile *missile, const FlightWorld *world, const FlightCommand *command)
{
    const double h = world->step_s, t_s = flight_time_s(state, world);
    const double age_s = (double)(state->tick - state->launch_tick) * h;
    const Leg    leg = {
           missile, world, state, command, (double)state->launch_tick * h, missile_thrust_n(missile, age_s + 0.5 * h)};
    double y[parts], at[parts], k1[parts], k2[parts], k3[parts], k4[parts];
    memcpy(y, state->p_ecef, 3 * sizeof *y);
    memcpy(y + 3, state->v_ecef_mps, 3 * sizeof *y);
    memcpy(y + 6, state->lag_mps2, 3 * sizeof *y);
    memcpy(y + 9, state->lag_rate_mps3, 3 * sizeof *y);

    slope(k1, y, t_s, &leg);
    for (int i = 0; i < parts; i++) at[i] = y[i] + 0.5 * h * k1[i];
    slope(k2, at, t_s + 0.5 * h, &leg);
    for (int i = 0; i < parts; i++) at[i] = y[i] + 0.5 * h * k2[i];
    slope(k3, at, t_s + 0.5 * h, &leg);
    for (int i = 0; i < parts; i++) at[i] = y[i] + h * k3[i];
    slope(k4, at, t_s + h, &leg);
    bool finite = true;
    for (int i = 0; i < parts; i++) {
        y[i] += h / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
        finite = finite && isfinite(y[i]);
    }
    const double centre_m = v3_length(y);
    if (!finite || !(centre_m > near_m && centre_m < far_m)) return false;

    state->tick++;
    memcpy(state->p_ecef, y, 3 * sizeof *y);
    memcpy(state->v_ecef_mps, y + 3, 3 * sizeof *y);
    memcpy(state->lag_mps2, y + 6, 3 * sizeof *y);
    memcpy(state->lag_rate_mps3, y + 9, 3 * sizeof *y);
    state->terminal = command->terminal;
    note(state, missile, world, -expm1(-2 * h / missile->lag_s));
    if (command->sees) turn_towards(state->gaze_ecef, command->los_ecef, missile->gimbal_rate_rps * h);
    hold_gimbal(state, missile);
    return true;
}
