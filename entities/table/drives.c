/* entities/table/drives.c: what an entity does that heats it, from its reports. */
#include "entities/table/snapshot.h"

#include "dis/pdu/pdu.h"

static const double moving_mps = 0.3;          /* above the jitter in the reports of a stationary vehicle */
static const double engine_after_stop_s = 120; /* crews halt with the engine on; estimate */
static const double full_speed_mps = 10;       /* a vehicle's usual speed off the road; estimate */
/* Estimates: full power is some 1.2 W a newton of weight (600 kW for 50 t), which would lift it at 1.2 m/s; a turn
 * of 1 rad/s takes all of it in a tracked vehicle. */
static const double full_climb_mps = 1.2, full_turn_rps = 1;
static const double burn_s = 2;    /* a TOW's launch and flight motors together: under 2 s */
static const double flare_s = 4;   /* decoy flares of the MJU class burn for 3 .. 5 s; estimate */
static const double wreck_s = 600; /* fuel, rubber and ammunition of a vehicle burn out; estimate */
static const float  smoulder =
    0.1f; /* share of the heat of flames that a fire inside, which is not seen, gives; estimate */
static const double most_fired_kg = 1e9;

/* Whether the damage bits are 3, destroyed. They have the same place for every platform domain, for buildings, and (as
 * fatally injured) for life forms. */
static bool is_destroyed(const DriveEvidence *evidence)
{
    const int kind = evidence->type.kind;
    return (kind == dis_kind_platform || kind == dis_kind_life_form || kind == dis_kind_cultural_feature) &&
           (evidence->appearance >> dis_appearance_damage_shift & 3) == dis_damage_destroyed;
}

/* Load of the engine, from 0 at idling to 1 at full power. */
static double load_of(const DriveEvidence *e, double speed_mps)
{
    const double climb_mps = isfinite(e->climb_mps) ? e->climb_mps : 0,
                 turn_rps = isfinite(e->turn_rps) ? fabs(e->turn_rps) : 0;
    return clamp(speed_mps / full_speed_mps + climb_mps / full_climb_mps + turn_rps / full_turn_rps, 0, 1);
}

static void take(DriveState *state, const DriveEvidence *evidence, double t_s)
{
    const bool platform = evidence->type.kind == dis_kind_platform,
               air = platform && evidence->type.domain == dis_domain_air;
    const int  smoke = (int)(evidence->appearance >> dis_appearance_smoke_shift &
                            3); /* bit 1: a plume of smoke rises from it; bit 2: engine smoke */
    const bool works = !is_destroyed(evidence), was_moving = state->moving;
    const bool lives = evidence->type.kind == dis_kind_life_form || evidence->type.kind == dis_kind_cultural_feature;

    state->speed_mps = isfinite(evidence->speed_mps) ? evidence->speed_mps : 0;
    state->moving = platform && state->speed_mps > moving_mps;
    if (state->moving || was_moving) state->moved_s = t_s;

    state->engine = (DriveUntil){0, INFINITY};
    if (!works) state->engine.value = 0;
    else if (air) state->engine.value = 1;
    else if (state->moving) state->engine.value = drives_idle + (1 - drives_idle) * load_of(evidence, state->speed_mps);
    else if (platform && (evidence->appearance >> dis_appearance_power_plant_bit & 1 || smoke & 2))
        state->engine.value = drives_idle;
    else if (platform && t_s < state->moved_s + engine_after_stop_s)
        state->engine = (DriveUntil){drives_idle, state->moved_s + engine_after_stop_s};

    state->flying = air && works;
    state->alive = lives && works;
    state->flaming = platform && evidence->appearance >> dis_appearance_flaming_bit & 1;
    state->smoulders = platform && smoke & 1 && (evidence->appearance >> dis_appearance_damage_shift & 3) != 0;
    state->destroyed = platform && !works; /* only machines burn out; others are just destroyed */
}

void drives_begin(DriveState *state, const DriveEvidence *evidence, double t_s)
{
    *state = (DriveState){.since_s = t_s, .moved_s = -INFINITY};
    take(state, evidence, t_s);
    if (evidence->type.kind == dis_kind_munition) drives_launch(state, t_s);
    else if (evidence->type.kind == dis_kind_expendable) state->flare = (DriveUntil){1, t_s + flare_s};
}

void drives_report(DriveState *state, const DriveEvidence *evidence, double t_s)
{
    const bool was_destroyed = state->destroyed;
    take(state, evidence, t_s);
    if (state->destroyed != was_destroyed) state->wreck = (DriveUntil){state->destroyed, t_s + wreck_s};
}

void drives_fire(DriveState *state, double charge_kg, int rounds)
{
    double *kg = &state->fired_kg[charge_kg >= drives_large_kg];
    if (charge_kg > 0 && rounds > 0) *kg = fmin(*kg + charge_kg * rounds, most_fired_kg);
}

void drives_launch(DriveState *state, double t_s) { state->motor = (DriveUntil){1, t_s + burn_s}; }

void drives_pause(DriveState *state, double paused_s)
{
    DriveUntil *const drive[] = {&state->engine, &state->motor, &state->flare, &state->wreck};
    for (size_t i = 0; i < sizeof drive / sizeof *drive; i++) drive[i]->until_s += paused_s;
    state->moved_s += paused_s;
}

static float now(DriveUntil drive, double t_s) { return t_s < drive.until_s ? (float)drive.value : 0; }

void drives_at(EntityDrives *out, const DriveState *state, double t_s)
{
    *out =
        (EntityDrives){.since_s = state->since_s,
                       .engine = now(state->engine, t_s),
                       .speed_mps = (float)state->speed_mps,
                       .flying = state->flying,
                       .alive = state->alive,
                       .burning = fmaxf(fmaxf(state->flaming, state->smoulders ? smoulder : 0), now(state->wreck, t_s)),
                       .motor = now(state->motor, t_s),
                       .flare = now(state->flare, t_s),
                       .fired_kg = {state->fired_kg[0], state->fired_kg[1]}};
}

double drives_engine(const DriveState *state, double t_s)
{
    return t_s < state->engine.until_s ? state->engine.value : 0;
}

double drives_run_until(const DriveState *state) { return state->engine.value > 0 ? state->engine.until_s : -INFINITY; }
