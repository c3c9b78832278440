/* entities/flight/missile.h: what flies: a row of etc/missiles.csv, or of a table like it, in units of the program.
 *
 * A plain struct without pointers; tests and tools may fill one by hand. flight.h says what each member does. */
#ifndef ENTITIES_FLIGHT_MISSILE_H
#define ENTITIES_FLIGHT_MISSILE_H

#include "pitviper.h"

typedef enum MissileGuidance {
    MISSILE_PN,        /* true proportional navigation */
    MISSILE_AUGMENTED, /* the same with the target's acceleration */
    MISSILE_PURSUIT,   /* the velocity turns to the line of sight */
    MISSILE_COMMAND,   /* onto the line from a sight at the launcher to the target */
    MISSILE_LOFT,      /* climbs, flies level, then proportional navigation from above */
} MissileGuidance;

enum { missile_drag_nodes = 8, missile_stages = 2 };
/* Mach numbers of the drag table; linear between them, constant beyond */
static const double missile_mach[missile_drag_nodes] = {0, 0.8, 0.95, 1.05, 1.2, 2, 3, 5};

typedef struct Missile {
    char            name[32];
    MissileGuidance guidance;
    double          mass_kg;                     /* at launch */
    double          burn_kg[missile_stages];     /* propellant of boost and sustain; spent evenly */
    double          thrust_n[missile_stages];    /* constant, of any height */
    double          burn_s[missile_stages];      /* one after the other */
    double          ignite_s;                    /* from launch to the boost */
    double          launch_mps;                  /* speed that the launcher gives it */
    double          area_m2;                     /* cross-section, to which the coefficients refer */
    double          drag[missile_drag_nodes];    /* coefficient without lift, at missile_mach */
    double          lift_slope;                  /* of the lift coefficient over sin(angle of attack) */
    double          most_attack_rad;             /* angle of attack at most, below pi / 2 */
    double          most_lateral_mps2;           /* what the airframe bears */
    double          lag_s;                       /* autopilot: time constant, > 0 */
    double          damping;                     /* 0: first order; else second, natural frequency 1 / lag_s */
    double          gain;                        /* navigation constant; pursuit 1/s; command rad/s */
    double          gravity_share;               /* of gravity across the velocity that the autopilot lifts */
    double          guide_after_s;               /* from launch; it flies straight before */
    double          loft_rad, loft_m, dive_rad;  /* climb at most so steep, above launch; dives at that depression */
    double          gimbal_rad, gimbal_rate_rps; /* seeker: largest angle off the body's axis; rate of turn. 0: none */
    double          field_rad;                   /* full angle of its field of view */
    double          memory_s;                    /* oldest line of sight that guides */
    double          fuze_m;                      /* closest approach at which it goes off */
    double          life_s;                      /* longest flight */
} Missile;

/* Reads the row of that name. An error is logged with file, line, column, value and range; an unknown name with the
 * known ones. */
Status missile_read(Missile *out, const char *path, const char *name);
/* All rows: `most` of them at most, *count as many as there are. The first that is wrong is logged. */
Status missile_read_all(Missile *out, int most, int *count, const char *path);

const char *missile_guidance_name(MissileGuidance guidance);

#endif
