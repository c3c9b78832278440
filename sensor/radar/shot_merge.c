/* sensor/radar/shot_merge.c: fewer echoes of a target where the radar tells few of them apart. */
#include "sensor/radar/seeker_radar_private.h"

/* ---- points ------------------------------------------------------------------------------------------ */

/* A target that is far, small or met by little bandwidth needs fewer echoes than it has scattering centres.
 *
 * Its points are shared out to the nodes of a grid over what tells them apart: delay, range rate, and the two
 * angles of the antenna's pattern; linearly, each with the phase of its own path at the middle of band and
 * interval. Nodes are so close that a phase changes by 0.4 rad from one to the next at the ends of band and
 * interval, and u of the pattern (antenna.h) by 0.25: an error of up to 2 % of a point's amplitude (an eighth of
 * the square) along each axis, 0.6 % rms over the band. An axis along which they part by less than 0.1 rad in all
 * has one node (up to 5 %): a target that nothing resolves is one echo. Where nodes are not far fewer than points,
 * and on parts that spin or roll, points stay. bench precision has the time it saves, and its error. */
enum { axes = merge_axes, worth = 2 };
static const double step_rad[axes] = {0.4, 0.4, 0.25, 0.25}, together_rad = 0.1;

static double wave_rad_m(const RadarShot *shot) { return 2 * pi_rad * shot->preset->wave.centre_hz / light_mps; }

typedef struct Axis {
    double low, high, scale; /* rad of phase, or u, over its unit */
    int    nodes;
} Axis;

/* Lays the grid over the spans of so many along the first axes. False: it would need too many nodes. */
static bool grid_over(Axis axis[axes], int along, size_t *nodes, int count)
{
    *nodes = 1;
    for (int a = 0; a < along; a++) {
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

/* Makes a node that holds nothing yet: a point like those of the target, at the node's place. */
static RadarPoint node_of(const Axis axis[axes], size_t number, const RadarPoint *like, const RadarShot *shot)
{
    int        at[axes];
    RadarPoint out = *like;
    double     along[3];
    for (int a = 0; a < axes; a++) at[a] = (int)(number % (size_t)axis[a].nodes), number /= (size_t)axis[a].nodes;
    out.path_m = node_at(&axis[0], at[0]);
    out.path_per_pulse_m = node_at(&axis[1], at[1]);
    const double right = node_at(&axis[2], at[2]), down = node_at(&axis[3], at[3]);
    v3_scale(along, sqrt(fmax(1 - right * right - down * down, 0)), shot->ahead);
    v3_add_scaled(along, along, right, shot->right);
    v3_add_scaled(along, along, down, shot->down);
    v3_add_scaled(out.p_enu, shot->p_enu, shot->reference_m + 0.5 * out.path_m, along);
    out.same = out.other = 0;
    return out;
}

static double lost_on_the_way(const RadarShot *shot, const RadarPoint *p)
{
    Sight to;
    if (!shot->radar->foliage && shot->chaff_count == 0) return 0;
    shot_sight(&to, shot, p->p_enu, 0);
    return shot_volume_np(shot, &to);
}

/* The nodes about a place: the first of them, and weights and distance of the two along each axis. */
typedef struct Share {
    double         weight[axes][2];
    double complex turn[2]; /* from the phase of the place's path to those of the nodes */
    size_t         first, stride[axes];
} Share;

/* x: places along the first axes; path_m: x[0]. */
static void find_share(Share *out, const Axis axis[axes], int along, double k, const double x[axes])
{
    size_t next = 1;
    *out = (Share){.turn = {0}};
    for (int a = 0; a < along; a++) {
        const int    last = axis[a].nodes - 1;
        const double at = last > 0 ? clamp((x[a] - axis[a].low) / (axis[a].high - axis[a].low), 0, 1) * last : 0;
        const int    low = at < last ? (int)at : last - (last > 0);
        out->weight[a][1] = last > 0 ? at - low : 0;
        out->weight[a][0] = 1 - out->weight[a][1];
        out->stride[a] = axis[a].nodes > 1 ? next : 0;
        out->first += (size_t)low * next;
        next *= (size_t)axis[a].nodes;
        for (int side = 0; side < 2 && a == 0; side++) {
            const double phase = -k * (x[0] - node_at(&axis[a], low + side));
            out->turn[side] = CMPLX(cos(phase), sin(phase));
        }
    }
}

/* Adds a point to the nodes about it. */
static void share_out(RadarPoint *node, const double *lost_np, const Axis axis[axes], const RadarShot *shot,
                      const RadarPoint *p, const double x[axes])
{
    const double own_np = lost_on_the_way(shot, p);
    Share        s;
    find_share(&s, axis, axes, wave_rad_m(shot), x);
    for (int corner = 0; corner < 1 << axes; corner++) {
        double size = 1;
        size_t i = s.first;
        for (int a = 0; a < axes; a++) {
            size *= s.weight[a][corner >> a & 1];
            i += corner >> a & 1 ? s.stride[a] : 0;
        }
        if (size == 0) continue;
        if (lost_np[i] != own_np) size *= exp(lost_np[i] - own_np);
        const double re = size * creal(s.turn[corner & 1]), im = size * cimag(s.turn[corner & 1]);
        node[i].same += CMPLX(creal(p->same) * re - cimag(p->same) * im, creal(p->same) * im + cimag(p->same) * re);
        node[i].other +=
            CMPLX(creal(p->other) * re - cimag(p->other) * im, creal(p->other) * im + cimag(p->other) * re);
    }
}

/* Scale of each axis, and no span yet. */
static void open_axes(Axis axis[axes], const RadarShot *shot)
{
    const Waveform *wave = &shot->preset->wave;
    const double    reach = antenna_u_per_sine(&shot->preset->antenna);
    const double scale[axes] = {pi_rad * wave->bandwidth_hz / light_mps, 0.5 * wave_rad_m(shot) * wave->pulses, reach,
                                reach};
    for (int a = 0; a < axes; a++) axis[a] = (Axis){INFINITY, -INFINITY, scale[a], 1};
}

static void widen(Axis *axis, double x)
{
    if (x < axis->low) axis->low = x;
    if (x > axis->high) axis->high = x;
}

void shot_merge_points(TargetPoints *points, const RadarShot *shot)
{
    RadarPoint *point = shot->radar->points.point + points->first;
    const bool *spins = points->spins;
    const int   count = points->count;
    Axis        axis[axes];
    size_t      nodes;
    int         still = 0;
    open_axes(axis, shot);
    for (int i = 0; i < count; i++) {
        if (spins[i]) continue;
        still++;
        for (int a = 0; a < axes; a++) widen(&axis[a], points->x[i][a]);
    }
    if (still < 2 || !grid_over(axis, axes, &nodes, still)) return;
    RadarPoint *node = arena_alloc(shot->arena, nodes, sizeof *node);
    double     *lost_np = arena_alloc(shot->arena, nodes, sizeof *lost_np);
    if (!node || !lost_np) return; /* no less right */
    for (size_t i = 0; i < nodes; i++) {
        node[i] = node_of(axis, i, &point[0], shot);
        lost_np[i] = lost_on_the_way(shot, &node[i]);
    }
    for (int i = 0; i < count; i++)
        if (!spins[i]) share_out(node, lost_np, axis, shot, &point[i], points->x[i]);
    int kept = 0;
    /* first those that spin: nodes are fewer than the points that leave room for them */
    for (int i = 0; i < count; i++)
        if (spins[i]) point[kept++] = point[i];
    for (size_t i = 0; i < nodes; i++)
        if (node[i].same != 0 || node[i].other != 0) point[kept++] = node[i];
    points->count = kept;
}

/* ---- echoes ------------------------------------------------------------------------------------------ */

int shot_merge_echoes(Echo *echo, const bool *spins, int count, const RadarShot *shot)
{
    enum { along = 2 };
    Axis   axis[axes];
    size_t nodes;
    int    still = 0, kept = 0;
    open_axes(axis, shot);
    for (int i = 0; i < count; i++) {
        if (spins[i]) continue;
        still++;
        widen(&axis[0], echo[i].path_m), widen(&axis[1], echo[i].path_per_pulse_m);
    }
    if (still < 2 || !grid_over(axis, along, &nodes, still)) return count;
    Echo *node = arena_alloc(shot->arena, nodes, sizeof *node);
    if (!node) return count; /* no less right */
    for (size_t i = 0; i < nodes; i++) {
        node[i].path_m = node_at(&axis[0], (int)(i % (size_t)axis[0].nodes));
        node[i].path_per_pulse_m = node_at(&axis[1], (int)(i / (size_t)axis[0].nodes));
    }
    for (int i = 0; i < count; i++) {
        Share s;
        if (spins[i]) continue;
        find_share(&s, axis, along, wave_rad_m(shot), (const double[axes]){echo[i].path_m, echo[i].path_per_pulse_m});
        for (int corner = 0; corner < 1 << along; corner++) {
            const int    near = corner & 1, late = corner >> 1;
            const double size = s.weight[0][near] * s.weight[1][late];
            const double re = size * creal(s.turn[near]), im = size * cimag(s.turn[near]);
            Echo        *to = &node[s.first + (near ? s.stride[0] : 0) + (late ? s.stride[1] : 0)];
            for (int c = 0; c < interval_channels; c++) {
                const double a = creal(echo[i].amplitude[c]), b = cimag(echo[i].amplitude[c]);
                to->amplitude[c] += CMPLX(a * re - b * im, a * im + b * re);
            }
        }
    }
    for (int i = 0; i < count; i++)
        if (spins[i]) echo[kept++] = echo[i];
    for (size_t i = 0; i < nodes; i++)
        if (node[i].amplitude[CHANNEL_SUM] != 0 || node[i].amplitude[CHANNEL_CROSS] != 0) echo[kept++] = node[i];
    return kept;
}
