/* entities/survey/survey_track.c: interpolates a recorded entity between its reports. */
#include "entities/survey/survey.h"

#include "entities/motion/dead_reckoning.h"

/* ---- attitude: the shortest turn at an even rate ------------------------------------------ */

/* Unit quaternion (w, x, y, z) of a rotation; the largest component is taken first, so none is divided by a small
 * one (Shepperd 1978). */
static void quaternion_from_rotation(double q[4], const double r[9])
{
    const double four[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                            1 - r[0] - r[4] + r[8]};
    int          largest = 0;
    for (int i = 1; i < 4; i++)
        if (four[i] > four[largest]) largest = i;

    const double product[4][4] = {{four[0], r[7] - r[5], r[2] - r[6], r[3] - r[1]},
                                  {r[7] - r[5], four[1], r[3] + r[1], r[2] + r[6]},
                                  {r[2] - r[6], r[3] + r[1], four[2], r[7] + r[5]},
                                  {r[3] - r[1], r[2] + r[6], r[7] + r[5], four[3]}};
    double       length = 0;
    for (int i = 0; i < 4; i++) length += product[largest][i] * product[largest][i];
    length = sqrt(length);
    for (int i = 0; i < 4; i++) q[i] = product[largest][i] / length;
}

static void rotation_from_quaternion(double r[9], const double q[4])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    r[0] = 1 - 2 * (y * y + z * z), r[1] = 2 * (x * y - w * z), r[2] = 2 * (x * z + w * y);
    r[3] = 2 * (x * y + w * z), r[4] = 1 - 2 * (x * x + z * z), r[5] = 2 * (y * z - w * x);
    r[6] = 2 * (x * z - w * y), r[7] = 2 * (y * z + w * x), r[8] = 1 - 2 * (x * x + y * y);
}

void survey_turn(double out[9], const double r0[9], const double r1[9], double u)
{
    double q0[4], q1[4], q[4], along = 0, across = 0, length = 0;

    quaternion_from_rotation(q0, r0);
    quaternion_from_rotation(q1, r1);
    for (int i = 0; i < 4; i++) along += q0[i] * q1[i];
    const double sign = along < 0 ? -1 : 1;
    for (int i = 0; i < 4; i++) {
        const double d = q1[i] - along * q0[i];
        across += d * d;
    }
    /* atan2, not acos: exact for small turns. Near no turn at all sin(k a) / sin(a) is k. */
    const double angle = atan2(sqrt(across), fabs(along)), s = sin(angle);
    const double k0 = s > 1e-9 ? sin((1 - u) * angle) / s : 1 - u, k1 = s > 1e-9 ? sin(u * angle) / s : u;
    for (int i = 0; i < 4; i++) {
        q[i] = k0 * q0[i] + k1 * sign * q1[i];
        length += q[i] * q[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 4; i++) q[i] /= length;
    rotation_from_quaternion(out, q);
}

/* Under any even acceleration the chord is no faster than the faster end; a third above that, and above a vehicle's
 * start from rest, it is a discontinuity. */
static const double step_speeds = 1.3, step_floor_mps = 5;

/* ---- position ----------------------------------------------------------------------------- */

/* The reported velocity as a tangent of the cubic, made safe: not backwards along the chord, and at most three
 * times its speed. Within that no cubic overshoots its ends (Fritsch & Carlson 1980). A missile's first report
 * has the launcher's velocity and its next one is far away. */
static void safe_tangent(double out[3], const double v_mps[3], const double chord_mps[3])
{
    const double chord = v3_length(chord_mps);
    double       unit[3];

    memset(out, 0, 3 * sizeof *out);
    if (!v3_normalize(unit, chord_mps)) return;
    memcpy(out, v_mps, 3 * sizeof *out);
    const double along = v3_dot(out, unit);
    if (along < 0) v3_add_scaled(out, out, -along, unit);
    const double speed = v3_length(out);
    if (speed > 3 * chord) v3_scale(out, 3 * chord / speed, out);
}

void survey_point_rotation(double r_ecef_from_body[9], const TrackPoint *point)
{
    r_ecef_from_body_euler(r_ecef_from_body, (double)point->euler_rad[0], (double)point->euler_rad[1],
                           (double)point->euler_rad[2]);
}

static void hold(TrackPose *out, const TrackPoint *point, bool moves)
{
    memcpy(out->p_ecef, point->p_ecef, sizeof out->p_ecef);
    survey_point_rotation(out->r_ecef_from_body, point);
    for (int i = 0; i < 3; i++) out->v_ecef_mps[i] = moves ? point->v_ecef_mps[i] : 0;
}

/* Last point at or before t_s; -1: none. */
static int point_before(const Track *track, double t_s)
{
    int low = 0, high = track->count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (track->point[middle].t_s <= t_s) low = middle + 1;
        else high = middle;
    }
    return low - 1;
}

void survey_track_at(TrackPose *out, const Track *track, double t_s)
{
    const int at = point_before(track, t_s);
    if (at < 0 || at == track->count - 1) {
        const TrackPoint *end = track->point + (at < 0 ? 0 : at);
        hold(out, end, end->t_s == t_s && !end->frozen);
        return;
    }
    const TrackPoint *a = track->point + at, *b = a + 1;
    if (a->frozen || a->deactivated || a->paused) { /* the next report is of a new entity, or starts from here */
        hold(out, a, false);
        return;
    }
    const double h_s = b->t_s - a->t_s, u = (t_s - a->t_s) / h_s, w = 1 - u;
    double       d[3], chord_mps[3], va[3], vb[3], ra[9], rb[9];

    /* from a, not from the Earth's centre: the cubic then works on metres */
    v3_sub(d, b->p_ecef, a->p_ecef);
    v3_scale(chord_mps, 1 / h_s, d);
    safe_tangent(va, a->v_ecef_mps, chord_mps);
    safe_tangent(vb, b->v_ecef_mps, chord_mps);
    /* A sender that stamps late moves an entity metres within a millisecond: a step, not a speed. */
    const double reported_mps = fmax(v3_length(a->v_ecef_mps), v3_length(b->v_ecef_mps));
    const bool   step = v3_length(chord_mps) > step_speeds * reported_mps + step_floor_mps;
    for (int i = 0; i < 3; i++) {
        out->p_ecef[i] = a->p_ecef[i] + u * u * (3 - 2 * u) * d[i] + h_s * u * w * (w * va[i] - u * vb[i]);
        out->v_ecef_mps[i] = step ? w * a->v_ecef_mps[i] + u * b->v_ecef_mps[i]
                                  : 6 * u * w * chord_mps[i] + w * (1 - 3 * u) * va[i] + u * (3 * u - 2) * vb[i];
    }
    survey_point_rotation(ra, a);
    survey_point_rotation(rb, b);
    survey_turn(out->r_ecef_from_body, ra, rb, u);
}

bool survey_track_knows(const Track *track, double t_s)
{
    const int at = point_before(track, t_s);
    return t_s <= track->point[track->count - 1].t_s && (at < 0 || !track->point[at].paused);
}
