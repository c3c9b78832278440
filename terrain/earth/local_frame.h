/* terrain/earth/local_frame.h: ECEF <-> east-north-up about one origin, in double.
 *
 * The matrix is taken once from GeographicLib; a conversion is then a 3x3 and an offset, 1 nm at ECEF size. */
#ifndef TERRAIN_EARTH_LOCAL_FRAME_H
#define TERRAIN_EARTH_LOCAL_FRAME_H

#include "terrain/earth/geodesy.h"

typedef struct LocalFrame {
    Geodetic origin;
    double   origin_ecef[3];
    double   r_ecef_from_enu[9];
} LocalFrame;

Status local_frame_at(LocalFrame *out, const Geodetic *origin);

static inline void enu_from_ecef(double p_enu[3], const LocalFrame *frame, const double p_ecef[3])
{
    double d_ecef[3];
    v3_sub(d_ecef, p_ecef, frame->origin_ecef);
    m3_tmul_v3(p_enu, frame->r_ecef_from_enu, d_ecef);
}

static inline void ecef_from_enu(double p_ecef[3], const LocalFrame *frame, const double p_enu[3])
{
    double d_ecef[3];
    m3_mul_v3(d_ecef, frame->r_ecef_from_enu, p_enu);
    v3_add(p_ecef, d_ecef, frame->origin_ecef);
}

#endif
