/* entities/effects/heat.h: temperatures of an entity's parts from its activity.
 *
 * Each heat role has one driver, a steady rise at full drive, and a time constant each way (etc/heat.csv). Between
 * reports every drive is constant (or ends at a known time), so a level follows in closed form and does not depend
 * on frame times. Evidence is the appearance word *and* the observed motion: VR-Forces
 * flies helicopters and drives tanks without ever setting the power-plant bit. */
#ifndef ENTITIES_EFFECTS_HEAT_H
#define ENTITIES_EFFECTS_HEAT_H

#include "dis/pdu.h"
#include "entities/models/model.h"

typedef enum HeatDriver {
    HEAT_DRIVER_NONE = 0,
    HEAT_DRIVER_ENGINE, /* power plant: 0.6 idling, 1 at 10 m/s; air platforms 1 */
    HEAT_DRIVER_MOTION, /* speed over the ground: 1 at 10 m/s */
    HEAT_DRIVER_FIRING, /* 1 for one second a Fire PDU; shots in quick succession add up */
    HEAT_DRIVER_FLIGHT, /* 1 for an air platform */
    HEAT_DRIVER_BURN,   /* 1 for a munition's first two seconds */
    HEAT_DRIVER_SPEED,  /* recovery rise r v^2 / (2 cp) over the role's rise_k, at most 1 */
    HEAT_DRIVER_LIFE,   /* 1 for a life form alive and a building not destroyed */
    HEAT_DRIVER_PYROTECHNIC, /* 1 for an expendable's first four seconds */
    HEAT_DRIVER_BURNING,/* 1 while flaming */
    HEAT_DRIVER_COUNT
} HeatDriver;

typedef struct HeatTable {
    HeatDriver driver[HEAT_ROLE_COUNT];
    double     rise_k[HEAT_ROLE_COUNT]; /* above a passive part, steady at full drive */
    double     warm_up_s[HEAT_ROLE_COUNT], cool_down_s[HEAT_ROLE_COUNT]; /* time constants */
} HeatTable;

/* Every role must have its row. Failures are logged with file and line. */
Status heat_table_open(HeatTable *out, const char *path);

/* `value` until `until_s`, then nothing. */
typedef struct HeatDrive {
    double value, until_s;
} HeatDrive;

typedef struct HeatState {
    double    t_s;
    double    level[HEAT_ROLE_COUNT]; /* 0 .. 1 at t_s */
    HeatDrive drive[HEAT_DRIVER_COUNT];
    double    moved_s; /* when it was last known to move; -INFINITY: never */
    bool      moving, destroyed;
} HeatState;

/* The state of one report. */
typedef struct HeatEvidence {
    DisEntityType type;
    uint32_t      appearance;
    double        speed_mps; /* as reported; 0 when frozen */
} HeatEvidence;

/* First report: assumed to have been in that state for ambient_s, so a wreck without flames is cold. Munitions and
 * expendables start cold, with their motor or grain burning. */
void heat_begin(HeatState *state, const HeatTable *table, const HeatEvidence *evidence, double t_s, double ambient_s);
void heat_report(HeatState *state, const HeatTable *table, const HeatEvidence *evidence, double t_s);
/* It fired; or it is the munition that was fired. */
void heat_fire(HeatState *state, const HeatTable *table, double t_s);
void heat_launch(HeatState *state, const HeatTable *table, double t_s);

/* Temperature above a passive part at t_s (at or after the last report; earlier counts as that), K. Only roles of
 * the mask (1 << role) are computed; others are 0. HEAT_WRECK of a wreck is added to every role. */
void heat_at(float rise_k[HEAT_ROLE_COUNT], const HeatState *state, const HeatTable *table, uint32_t roles, double t_s);
/* Roles of a model's parts that have a driver. */
uint32_t heat_roles(const Model *model, const HeatTable *table);

/* Until when engine and rotors turn without a further report: power-plant bit, moving or moved lately, or an air
 * platform; never a destroyed one. -INFINITY: they do not turn; INFINITY: until the next report. */
double heat_runs_until(const HeatState *state);
/* The engine's drive at t_s, 0 .. 1; and whether a decoy's grain burns. */
double heat_engine(const HeatState *state, double t_s);
bool   heat_grain_burns(const HeatState *state, double t_s);

#endif
