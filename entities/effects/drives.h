/* entities/effects/drives.h: what an entity does that heats it: its engine, its motion, its shots, flames.
 *
 * Evidence is the appearance word *and* the observed motion: VR-Forces flies helicopters and drives tanks without
 * ever setting the power-plant bit. Engine smoke says that the engine runs, as of a vehicle that makes its own
 * screen. A plume of smoke from one that is damaged says that it smoulders; from one that is not, a screen, it warms
 * nothing. Flames need no smoke. Between reports every drive is constant or ends at a known time, so drives at a
 * time are a function of the reports and of that time. What they do to temperatures: render/heat/vehicle_heat.h. */
#ifndef ENTITIES_EFFECTS_DRIVES_H
#define ENTITIES_EFFECTS_DRIVES_H

#include "dis/pdu.h"

/* At an instant. */
typedef struct EntityDrives {
    double since_s;      /* exercise time of its first report */
    float  engine;       /* share of full power: 0.6 idling, 1 at 10 m/s on level ground, or at less uphill and in turns; air
                          * platforms 1; 0: stopped */
    float  speed_mps;    /* as reported; 0 when frozen */
    float  flying;       /* 1: an air platform that is not destroyed */
    float  alive;        /* 1: a life form alive; a building not destroyed */
    float  burning;      /* 1: in flames, or destroyed before our eyes in the last ten minutes; 0.1: damaged, a plume of smoke from it */
    float  motor;        /* 1: a munition's motor burns, in its first two seconds */
    float  flare;        /* 1: an expendable's grain burns, in its first four seconds */
    double fired_kg[2];  /* propellant of all its shots: of small guns (below drives_large_kg a shot), of large ones */
} EntityDrives;

static const double drives_idle = 0.6;   /* engine of one that idles; estimate */
static const double drives_large_kg = 1; /* of propellant, a shot */

typedef struct DriveUntil {
    double value, until_s; /* value until then, afterwards 0 */
} DriveUntil;

typedef struct DriveState {
    double     since_s, speed_mps;
    DriveUntil engine, motor, flare, wreck;
    double     moved_s;  /* when it was last known to move; -INFINITY: never */
    bool       moving, flying, alive, flaming, smoulders, destroyed;
    double     fired_kg[2];
} DriveState;

/* The state of one report. */
typedef struct DriveEvidence {
    DisEntityType type;
    uint32_t      appearance;
    double        speed_mps; /* as reported; 0 when frozen */
    double        climb_mps; /* upwards */
    double        turn_rps;  /* about its own vertical axis */
} DriveEvidence;

/* Of the first report. A wreck without flames does not burn. Munitions and expendables start with their motor or grain
 * burning. */
void drives_begin(DriveState *state, const DriveEvidence *evidence, double t_s);
void drives_report(DriveState *state, const DriveEvidence *evidence, double t_s);
/* It fired a charge (effect_charge_kg), `rounds` times; or it is the munition that was fired. */
void drives_fire(DriveState *state, double charge_kg, int rounds);
void drives_launch(DriveState *state, double t_s);
void drives_at(EntityDrives *out, const DriveState *state, double t_s);

/* Until when engine and rotors turn without a further report: power-plant bit, moving or moved lately, or an air
 * platform; never a destroyed one. -INFINITY: they do not turn; INFINITY: until the next report. */
double drives_run_until(const DriveState *state);
/* The engine's share of full power at t_s, 0 .. 1. */
double drives_engine(const DriveState *state, double t_s);

#endif
