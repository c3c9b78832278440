/* entities/motion/dead_reckoning.h: the nine algorithms of IEEE 1278.1, closed forms with no loss at small rates.
 *
 * World = ECEF. r_body_from_ecef = Rx(phi) Ry(theta) Rz(psi). No Euler integration anywhere. */
#ifndef ENTITIES_MOTION_DEAD_RECKONING_H
#define ENTITIES_MOTION_DEAD_RECKONING_H

#include "pitviper.h"

typedef struct Kinematics {
    int    algorithm; /* 1 .. 9; others are treated as 1 (static) */
    double p_ecef[3];
    double v_mps[3];  /* world for 1..5, body for 6..9 */
    double a_mps2[3]; /* likewise */
    double w_body_rps[3];
    double r_ecef_from_body[9];
} Kinematics;

typedef struct Motion {
    double p_ecef[3], v_ecef_mps[3], w_body_rps[3], r_ecef_from_body[9];
} Motion;

/* Rotation from geocentric Euler angles, and back (psi, phi chosen in (-pi, pi], theta in [-pi/2, pi/2]). */
void r_ecef_from_body_euler(double r_ecef_from_body[9], double psi_rad, double theta_rad, double phi_rad);
void euler_from_r_ecef_from_body(double *psi_rad, double *theta_rad, double *phi_rad, const double r_ecef_from_body[9]);

/* One entity. v_ecef_mps is the derivative of p_ecef (static: 0); w_body_rps as given. dt_s: any finite value, either
 * sign; bounding it is the caller's (entity_table). */
void dead_reckon(Motion *out, const Kinematics *k, double dt_s);
/* The same with the series in place of closed forms below another square of the angle turned: for benchmarks. */
void dead_reckon_series(Motion *out, const Kinematics *k, double dt_s, double below_rad2);
/* Whether the attitude turns (3, 4, 7, 8), and whether velocity and acceleration are in body axes (6 .. 9). */
bool dead_reckoning_turns(int algorithm);
bool dead_reckoning_in_body_axes(int algorithm);

/* Many of one algorithm, arrays per component; the same bits as the one above. out must not overlap k. */
typedef struct KinematicsArrays {
    int     count;
    double *p_ecef[3], *v_mps[3], *a_mps2[3], *w_body_rps[3]; /* [count] each */
    double *r_ecef_from_body[9];
    double *dt_s;
} KinematicsArrays;
typedef struct MotionArrays {
    double *p_ecef[3], *v_ecef_mps[3], *r_ecef_from_body[9];
} MotionArrays;
void dead_reckon_arrays(MotionArrays *out, int algorithm, const KinematicsArrays *k);

#endif
