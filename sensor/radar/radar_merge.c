/* sensor/radar/radar_merge.c: fewer echoes of a target than it has scattering centres, where it is far, small or met by
 * little bandwidth.
 *
 * Its points are shared out to the nodes of a grid over what tells them apart: delay, range rate, and the two angles of
 * the antenna's pattern; linearly, each with the phase of its own path at the middle of band and interval. Nodes are so
 * close that a phase changes by 0.4 rad from one to the next at the ends of band and interval, and u of the pattern
 * (antenna.h) by 0.25: an error of up to 2 % of a point's amplitude (an eighth of the square) along each axis, 0.6 % rms
 * over the band. An axis along which they part by less than 0.1 rad in all has one node (up to 5 %): a target that nothing
 * resolves is one echo. Where nodes are not far fewer than points, and on parts that spin or roll, points stay. bench
 * precision has the time it saves, and its error. */
#include "sensor/radar/seeker_radar_private.h"

enum { axes = merge_axes, worth = 2 };
static const double step_rad[axes] = {0.4, 0.4, 0.25, 0.25}, together_rad = 0.1;

typedef struct Axis {
    double low, high, scale;    /* rad of phase, or u, over its unit */
    int    nodes;
} Axis;

/* False: too many nodes. */
static bool grid_over(Axis axis[axes], size_t *nodes, int count)
{
    *nodes = 1;
    for (int a = 0; a < axes; a++) {
        const double span = axis[a].scale * (axis[a].high - axis[a].low);
        axis[a].nodes = span <= together_rad ? 1 : span < 1e6 ? 1 + (int)ceil(span / step_rad[a]) : 1000000;
        *nodes *= (size_t)axis[a].nodes;
        if (*nodes > (size_t)count / worth) return false;
    }
    return true;
}

static double node_at(const Axis *axis, int i)
{
    return axis->nodes == 1 ? 0.5 * (axis->low + axis->high)
                            : axis->low + (axis->high - axis->low) * i / (axis->nodes - 1);
}

/* Where nothing is on it yet: like a point of the target, at the node's place. */
static RadarPoint node_of(const Axis axis[axes], size_t number, const RadarPoint *like, const Making *m)
{
    int        at[axes];
    RadarPoint out = *like;
    double     along[3];
    for (int a = 0; a < axes; a++) at[a] = (int)(number % (size_t)axis[a].nodes), number /= (size_t)axis[a].nodes;
    out.path_m = node_at(&axis[0], at[0]);
    out.path_per_pulse_m = node_at(&axis[1], at[1]);
    const double right = node_at(&axis[2], at[2]), down = node_at(&axis[3], at[3]);
    v3_scale(along, sqrt(fmax(1 - right * right - down * down, 0)), m->ahead);
    v3_add_scaled(along, along, right, m->right);
    v3_add_scaled(along, along, down, m->down);
    v3_add_scaled(out.p_enu, m->p_enu, m->reference_m + 0.5 * out.path_m, along);
    out.same = out.other = 0;
    return out;
}

static double lost_on_the_way(const Making *m, const RadarPoint *p)
{
    Sight to;
    if (!m->radar->foliage && m->chaff_count == 0) return 0;
    making_sight(&to, m, p->p_enu, 0);
    return making_volume_np(m, &to);
}

/* Adds a point to the nodes about it. */
static void share_out(RadarPoint *node, const double *lost_np, const Axis axis[axes], const Making *m,
                      const RadarPoint *p, const double x[axes])
{
    const double   k = 2 * pi_rad * m->preset->wave.centre_hz / light_mps, own_np = lost_on_the_way(m, p);
    double         weight[axes][2];
    double complex turn[2] = {0};
    size_t         first = 0, stride[axes], next = 1;
    for (int a = 0; a < axes; a++) {
        const int    last = axis[a].nodes - 1;
        const double at = last > 0 ? clamp((x[a] - axis[a].low) / (axis[a].high - axis[a].low), 0, 1) * last : 0;
        const int    low = at < last ? (int)at : last - (last > 0);
        weight[a][1] = last > 0 ? at - low : 0;
        weight[a][0] = 1 - weight[a][1];
        stride[a] = next;
        first += (size_t)low * next;
        next *= (size_t)axis[a].nodes;
        for (int side = 0; side < 2 && a == 0; side++) {
            const double phase = -k * (p->path_m - node_at(&axis[a], low + side));
            turn[side] = CMPLX(cos(phase), sin(phase));
        }
    }
    for (int corner = 0; corner < 1 << axes; corner++) {
        double   size = 1;
        size_t   i = first;
        for (int a = 0; a < axes; a++) {
            size *= weight[a][corner >> a & 1];
            i += (corner >> a & 1 && axis[a].nodes > 1) ? stride[a] : 0;
        }
        if (size == 0) continue;
        if (lost_np[i] != own_np) size *= exp(lost_np[i] - own_np);
        const double re = size * creal(turn[corner & 1]), im = size * cimag(turn[corner & 1]);
        node[i].same += CMPLX(creal(p->same) * re - cimag(p->same) * im, creal(p->same) * im + cimag(p->same) * re);
        node[i].other +=
            CMPLX(creal(p->other) * re - cimag(p->other) * im, creal(p->other) * im + cimag(p->other) * re);
    }
}

int making_merge(RadarPoint *point, const double (*x)[merge_axes], const bool *spins, int count, const Making *m)
{
    const Waveform *wave = &m->preset->wave;
    const double    k = 2 * pi_rad * wave->centre_hz / light_mps;
    const double    reach = antenna_u_per_sine(&m->preset->antenna);
    const double    scale[axes] = {pi_rad * wave->bandwidth_hz / light_mps, 0.5 * k * wave->pulses, reach, reach};
    Axis            axis[axes];
    size_t          nodes;
    int             still = 0;
    for (int a = 0; a < axes; a++) axis[a] = (Axis){INFINITY, -INFINITY, scale[a], 1};
    for (int i = 0; i < count; i++) {
        if (spins[i]) continue;
        still++;
        for (int a = 0; a < axes; a++) {
            if (x[i][a] < axis[a].low) axis[a].low = x[i][a];
            if (x[i][a] > axis[a].high) axis[a].high = x[i][a];
        }
    }
    if (still < 2 || !grid_over(axis, &nodes, still)) return count;
    RadarPoint *node = arena_alloc(m->arena, nodes, sizeof *node);
    double     *lost_np = arena_alloc(m->arena, nodes, sizeof *lost_np);
    if (!node || !lost_np) return count; /* no less right */
    for (size_t i = 0; i < nodes; i++) {
        node[i] = node_of(axis, i, &point[0], m);
        lost_np[i] = lost_on_the_way(m, &node[i]);
    }
    for (int i = 0; i < count; i++)
        if (!spins[i]) share_out(node, lost_np, axis, m, &point[i], x[i]);
    int kept = 0;
    /* first those that spin: nodes are fewer than the points that leave room for them */
    for (int i = 0; i < count; i++)
        if (spins[i]) point[kept++] = point[i];
    for (size_t i = 0; i < nodes; i++)
        if (node[i].same != 0 || node[i].other != 0) point[kept++] = node[i];
    return kept;
}
