/* entities/motion/articulation.h: articulated parts: reported values, extrapolated to the present time.
 *
 * A record is identified by its class and metric, never by its position in the PDU: senders put the rate before the
 * angle or after it. Signs, as the standard has them: azimuth is positive clockwise seen from above, that is
 * right-handed about body z (down); elevation is positive up, that is right-handed about body y (right), which
 * takes x (forward) towards -z (up). A model's joint axis is chosen so that its value is the DIS value. */
#ifndef ENTITIES_MOTION_ARTICULATION_H
#define ENTITIES_MOTION_ARTICULATION_H

#include "dis/pdu/decode.h"
#include "entities/models/model.h"

enum { articulation_max_joints = 32 };

/* One motion of one part: an angle (metrics 11, 13, 15) or a length (1, 3, 5, 7, 9), and its rate (metric + 1). */
typedef struct JointReport {
    uint32_t parameter; /* class + metric of the value */
    float    value;     /* value in rad or m, at Articulation.t_s */
    float    rate;      /* change of the value per second; 0 when none was reported */
} JointReport;

typedef struct Articulation {
    double      t_s; /* exercise time of the report */
    int         count;
    int         attached_count; /* parts attached and not detached in the last report; stored, but not rendered */
    JointReport joint[articulation_max_joints]; /* sorted by parameter */
} Articulation;

/* Values from the records of one PDU at t_s. A joint without a record stops at its present value. NaN and
 * infinite values are ignored. Returns how many articulated records were ignored because their class is none of
 * the standard's (SISO-REF-010: 1024 .. 8191), or because there are too many joints.
 * hold_s: longest time a rate is followed. */
int articulation_report(Articulation *articulation, const DisVariableParameter *record, int count, double t_s,
                        double hold_s);

/* Value of a class and metric at t_s; false when it was never reported. Angles are brought to -pi .. pi. */
bool articulation_value(double *value, const Articulation *articulation, uint32_t dis_class, uint32_t dis_metric,
                        double t_s, double hold_s);

/* Other inputs of a model's joints: running time, and motion over the ground. */
typedef struct JointDrive {
    double spin_s;     /* time for which the engine has run, which turns rotors */
    double distance_m; /* distance travelled forward, which turns wheels */
    double speed_mps;  /* speed, by which landing gear is assumed down or up */
} JointDrive;

/* Below this speed landing gear without a report is assumed down. Fighters approach at 70 .. 80 m/s and may keep
 * their gear out to 150 (flight manuals); estimate. */
static const double articulation_slow_mps = 100;

/* value[model->node_count], ready for model_pose: what was reported, else spin, else roll, else gear down when slow,
 * else 0. */
void articulation_joint_values(double *value, const Model *model, const Articulation *articulation,
                               const JointDrive *drive, double t_s, double hold_s);

#endif
