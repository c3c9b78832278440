/* sensor/radar/shot_bounce.c: the echoes of entities by way of the ground near them. */
#include "sensor/radar/seeker_radar_private.h"
#include "render/scattering/paths/radar_path.h"

/* ---- entities by way of the ground: where it mirrors -------------------------------------------- */

enum { steps = 4 };
static const double near_ground = 2; /* radii above the ground up to which its plane is that under the entity */
static const double slack_m = 0.5, slack_height_m = 0.1; /* ground met so much before the reflection is its own */

typedef struct Bounce {
    double         p_ground_enu[3], n_enu[3]; /* a point of the plane, its normal */
    double         p_image_enu[3], v_image_enu_mps[3];
    GroundPlane    plane; /* body axes */
    ScatterAntenna image;
    GroundLeg      direct, by_ground;
} Bounce;

static bool plane_at(Bounce *b, const RadarShot *shot, const Target *t, const double p_enu[2])
{
    const Elevation *elevation = &shot->scene->world->landscape->elevation;
    b->p_ground_enu[0] = p_enu[0];
    b->p_ground_enu[1] = p_enu[1];
    b->p_ground_enu[2] = elevation_height(elevation, p_enu[0], p_enu[1], b->n_enu);
    if (!isfinite(b->p_ground_enu[2]) || !v3_is_finite(b->n_enu)) return false;
    ground_plane(&b->plane, b->p_ground_enu, b->n_enu, t->p_enu, t->r_enu_from_body);
    return true;
}

/* Finds the point of the ground plane by which the antenna sees the entity's origin. */
static void reflection_of(double p_enu[3], const Bounce *b, const Target *t)
{
    double p_body[3];
    ground_reflection_point(p_body, &b->image, &b->plane);
    m3_mul_v3(p_enu, t->r_enu_from_body, p_body);
    v3_add(p_enu, p_enu, t->p_enu);
}

/* Finds the plane of the ground: under an entity that is near it, else at the reflection, which takes a few steps.
 * False: the ground does not mirror this entity to the antenna. */
static bool find_ground(Bounce *b, double p_enu[3], const RadarShot *shot, const Target *t)
{
    double extra_m = 0, right[3];
    if (!plane_at(b, shot, t, t->p_enu)) return false;
    const bool raised = b->plane.height_m > near_ground * t->of->radius_m;
    for (int step = 0; step <= (raised ? steps : 0); step++) {
        if (step > 0 && !plane_at(b, shot, t, p_enu)) return false;
        if (!(b->plane.height_m > -t->of->radius_m)) return false;
        extra_m = ground_image(&b->image, &t->antenna, &b->plane);
        if (!(v3_dot(b->plane.n, b->image.u) < -1e-4)) return false;
        reflection_of(p_enu, b, t);
    }
    m3_tmul_v3(right, t->r_enu_from_body, shot->right);
    const int           surface = landscape_surface(shot->scene->world->landscape, p_enu[0], p_enu[1]);
    const GroundSurface of = ground_surface(&shot->radar->mirror.row[surface], shot->preset->wave.centre_hz);
    const double        k = 2 * pi_rad / shot->preset->antenna.wavelength_m;
    ground_leg_direct(&b->direct, &t->antenna, right);
    if (!ground_leg_image(&b->by_ground, &(GroundMirror){&t->antenna, &b->image, extra_m, &b->plane}, &of, k, right))
        return false;
    return b->by_ground.coherence >= ground_least_coherence && extra_m < shot->half_window_m;
}

/* Whether the antenna sees the reflection: within its beam, and nothing but the entity itself before it. */
static bool reflection_is_seen(const RadarShot *shot, const Target *t, const Bounce *b, const double p_enu[3])
{
    const double own_m = fmax(slack_m, slack_height_m / -v3_dot(b->plane.n, b->image.u));
    bool         hidden;
    Sight        to;
    shot_sight(&to, shot, p_enu, shot->half_window_m);
    if (!(v3_dot(to.d_enu, shot->ahead) > 0) || shot_off_axis(shot, &to) > shot->widest) return false;
    shot_hidden(&hidden, shot, shot->p_enu, &to, &own_m, 1, t->index);
    return !hidden;
}

/* ---- their echoes ------------------------------------------------------------------------------------------- */

/* One way between the antenna and a place: its length, how fast it grows, and the antenna's gain in its direction. */
typedef struct Way {
    double      range_m, rate_mps;
    double      volume_np; /* power lost in foliage and chaff; by the ground: as directly */
    AntennaGain gain;
} Way;

static Way way_direct(const RadarShot *shot, const Sight *to, double volume_np, const double v_enu_mps[3])
{
    return (Way){to->range_m, shot_range_rate(shot, to, v_enu_mps), volume_np,
                 antenna_gain(&shot->preset->antenna, to->cos_right, to->cos_down)};
}

static Way way_by_ground(const RadarShot *shot, const Bounce *b, double volume_np, const double p_enu[3],
                         const double v_enu_mps[3])
{
    double to[3], d[3], v[3];
    v3_sub(to, p_enu, b->p_image_enu);
    const double range_m = v3_length(to);
    v3_scale(to, 1 / range_m, to);
    v3_sub(v, v_enu_mps, b->v_image_enu_mps);
    v3_add_scaled(d, to, -2 * v3_dot(to, b->n_enu), b->n_enu); /* as it leaves the antenna */
    return (Way){range_m, v3_dot(to, v), volume_np,
                 antenna_gain(&shot->preset->antenna, v3_dot(d, shot->right), v3_dot(d, shot->down))};
}

/* Adds amplitudes as shot_amplitudes has them, with one way out and another way back. */
static void add_amplitudes(double complex amplitude[interval_channels], const RadarShot *shot, const Way *out,
                           const Way *back, const ScatterMatrix *s)
{
    const RadarPreset *p = shot->preset;
    const RadarLink    link = {p->power_w, 1, 1, p->antenna.wavelength_m, sqrt(out->range_m * back->range_m), p->loss};
    const double       lost_np = shot->air_np_m * (out->range_m + back->range_m) + out->volume_np + back->volume_np;
    const double       unit = sqrt(radar_received_w(&link, 4 * pi_rad) * exp(-lost_np));
    const double complex same = unit * out->gain.sum * (p->transmits_h ? s->hh : s->vv);
    const double complex other = unit * out->gain.sum * (p->transmits_h ? s->vh : s->hv);
    amplitude[CHANNEL_SUM] += same * back->gain.sum;
    amplitude[CHANNEL_RIGHT] += same * back->gain.right;
    amplitude[CHANNEL_DOWN] += same * back->gain.down;
    amplitude[CHANNEL_CROSS] += other * back->gain.sum;
}

/* What foliage and chaff take on the direct way to the centres of an entity, by cells of half a metre, which stands for
 * the way by the ground too. Only cells that have a centre are asked. */
enum { loss_cells_most = 1 << 15, block_losses = 16 };
static const double loss_cell_m = 0.5;

typedef struct LossGrid {
    const RadarShot *shot;
    const Target    *target;
    double           low[3], side_m; /* body axes */
    int              size[3], count;
    int             *cell; /* [count]: those that have a centre */
    float           *np;   /* [cells] */
} LossGrid;

static int loss_cell(const LossGrid *g, const double p_body[3])
{
    int at = 0;
    for (int k = 0; k < 3; k++) at = at * g->size[k] + (int)((p_body[k] - g->low[k]) / g->side_m);
    return at;
}

static void find_losses(void *user, int worker, int task)
{
    LossGrid *g = user;
    (void)worker;
    for (int i = task * block_losses; i < (task + 1) * block_losses && i < g->count; i++) {
        double p_body[3], p_enu[3];
        Sight  to;
        for (int k = 2, left = g->cell[i]; k >= 0; left /= g->size[k], k--)
            p_body[k] = g->low[k] + (left % g->size[k] + 0.5) * g->side_m;
        m3_mul_v3(p_enu, g->target->r_enu_from_body, p_body);
        v3_add(p_enu, p_enu, g->target->p_enu);
        shot_sight(&to, g->shot, p_enu, 0);
        g->np[g->cell[i]] = (float)shot_volume_np(g->shot, &to);
    }
}

static Status grid_losses(LossGrid *g, const RadarShot *shot, const Target *t, const Centres *centres)
{
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    *g = (LossGrid){.shot = shot, .target = t, .low = {INFINITY, INFINITY, INFINITY}, .side_m = loss_cell_m};
    if (centres->count == 0 || (!shot->radar->foliage && shot->chaff_count == 0)) return STATUS_OK;
    for (int i = 0; i < centres->count; i++)
        for (int k = 0; k < 3; k++) {
            g->low[k] = fmin(g->low[k], centres->centre[i].p[k]);
            high[k] = fmax(high[k], centres->centre[i].p[k]);
        }
    int64_t cells = 0;
    for (; cells == 0 || cells > loss_cells_most; g->side_m *= cells > loss_cells_most ? 1.5 : 1) {
        cells = 1;
        for (int k = 0; k < 3; k++) {
            g->size[k] = (int)fmin((high[k] - g->low[k]) / g->side_m, 1e5) + 1;
            cells *= g->size[k];
        }
    }
    g->np = arena_alloc_raw(shot->arena, (size_t)cells, sizeof *g->np);
    g->cell = arena_alloc_raw(shot->arena, (size_t)cells, sizeof *g->cell);
    if (!g->np || !g->cell) return STATUS_NO_MEMORY;
    for (int64_t i = 0; i < cells; i++) g->np[i] = NAN;
    for (int i = 0; i < centres->count; i++) {
        const int at = loss_cell(g, centres->centre[i].p);
        if (!isnan(g->np[at])) continue;
        g->np[at] = 0;
        g->cell[g->count++] = at;
    }
    const int tasks = (g->count + block_losses - 1) / block_losses;
    if (shot->pool) pool_run(shot->pool, tasks, find_losses, g);
    else
        for (int i = 0; i < tasks; i++) find_losses(g, 0, i);
    return STATUS_OK;
}

/* The centres at hand, by way of the ground. */
typedef struct EchoJob {
    const RadarShot *shot;
    const Target    *target;
    const Bounce    *bounce;
    double           visible; /* share of the power */
    bool             once;    /* one way, in either order; else both ways */
    double           forward_mps;
    const LossGrid  *loss;
    Echo            *echo;  /* [centres] */
    bool            *spins; /* [centres] */
} EchoJob;

enum { block_echoes = 256 };

static void make_echoes(void *user, int worker, int task)
{
    const EchoJob   *job = user;
    const RadarShot *shot = job->shot;
    const Target    *t = job->target;
    const Bounce    *b = job->bounce;
    const Centres   *centres = &shot->radar->centres;
    const bool       once = job->once;
    const double     pulse_s = 1 / shot->preset->wave.repeat_hz;
    const int        first = task * block_echoes, left = centres->count - first;
    (void)worker;
    for (int i = first; i < first + (left < block_echoes ? left : block_echoes); i++) {
        const ScatterCentre *c = &centres->centre[i];
        Echo                *echo = &job->echo[i];
        double               p_enu[3], v_enu_mps[3];
        ScatterMatrix        s;
        Sight                direct;
        m3_mul_v3(p_enu, t->r_enu_from_body, c->p);
        v3_add(p_enu, p_enu, t->p_enu);
        shot_target_velocity(v_enu_mps, t, t->of->part[c->part].node, c->p);
        job->spins[i] = shot_target_spins(t, t->of->part[c->part].node, job->forward_mps);
        shot_sight(&direct, shot, p_enu, 0);
        const double volume_np = job->loss->np ? (double)job->loss->np[loss_cell(job->loss, c->p)] : 0;
        const Way    ground = way_by_ground(shot, b, volume_np, p_enu, v_enu_mps);
        const Way    other = once ? way_direct(shot, &direct, volume_np, v_enu_mps) : ground;
        ground_through(&s, &c->s, &b->by_ground, once ? &b->direct : &b->by_ground);
        *echo = (Echo){.path_m = t->antenna.range_m + b->image.range_m - 2 * shot->reference_m + c->path_m};
        if (!once) echo->path_m += b->by_ground.extra_m;
        add_amplitudes(echo->amplitude, shot, &other, &ground, &s);
        if (once) add_amplitudes(echo->amplitude, shot, &ground, &other, &(ScatterMatrix){s.hh, s.vh, s.hv, s.vv});
        for (int k = 0; k < interval_channels; k++) echo->amplitude[k] *= sqrt(job->visible);
        echo->path_per_pulse_m = (ground.rate_mps + other.rate_mps - 2 * shot->reference_rate_mps) * pulse_s;
    }
}

/* Adds the echoes of the centres at hand that go by the ground one way, in either order (once), or both ways. */
static Status add_echoes(RadarShot *shot, const Target *t, const Bounce *b, const RadarTruth *truth, bool once)
{
    SeekerRadar *r = shot->radar;
    const int    count = r->centres.count, blocks = (count + block_echoes - 1) / block_echoes;
    double       v_body[3];
    LossGrid     loss;
    m3_tmul_v3(v_body, t->r_enu_from_body, t->v_enu_mps);
    const Status status = grid_losses(&loss, shot, t, &r->centres);
    if (status != STATUS_OK) return status;
    EchoJob job = {.shot = shot,
                   .loss = &loss,
                   .target = t,
                   .bounce = b,
                   .visible = truth->visible,
                   .once = once,
                   .forward_mps = v_body[0],
                   .echo = arena_alloc_raw(shot->arena, (size_t)count + 1, sizeof *job.echo),
                   .spins = arena_alloc_raw(shot->arena, (size_t)count + 1, sizeof *job.spins)};
    if (!job.echo || !job.spins) return STATUS_NO_MEMORY;
    if (shot->pool) pool_run(shot->pool, blocks, make_echoes, &job);
    else
        for (int i = 0; i < blocks; i++) make_echoes(&job, 0, i);
    echo_add(r->echoes, job.echo, shot->scene->apart ? count : shot_merge_echoes(job.echo, job.spins, count, shot),
             shot->pool);
    return STATUS_OK;
}

static void areas(double m2[3], const ScatterMatrix *s)
{
    const double complex of[3] = {s->hh, s->vv, s->hv};
    for (int p = 0; p < 3; p++) m2[p] = 4 * pi_rad * (creal(of[p]) * creal(of[p]) + cimag(of[p]) * cimag(of[p]));
}

static void add_truth(RadarTruth *truth, const RadarShot *shot, const Bounce *b, const GroundFields *s)
{
    static const ScatterMatrix none;
    const double               k = 2 * pi_rad / shot->preset->antenna.wavelength_m;
    const int                  sent = shot->preset->transmits_h ? 0 : 1;
    ScatterMatrix              sum;
    ground_sum(&sum, s, &b->direct, &b->by_ground, k);
    areas(truth->bounce.rcs_m2, &sum);
    ground_sum(&sum, &(GroundFields){none, s->once, none}, &b->direct, &b->by_ground, k);
    areas(truth->bounce.once_m2, &sum);
    ground_sum(&sum, &(GroundFields){none, none, s->twice}, &b->direct, &b->by_ground, k);
    areas(truth->bounce.twice_m2, &sum);
    truth->bounce.coherence = b->by_ground.coherence;
    if (truth->rcs_m2[sent] > 0) truth->snr *= truth->bounce.rcs_m2[sent] / truth->rcs_m2[sent];
}

Status shot_bounce(RadarShot *shot, const Target *t, const ScatterMatrix *direct, RadarTruth *truth)
{
    SeekerRadar *r = shot->radar;
    Bounce       b;
    GroundFields s;
    double       p_enu[3];
    if (!r->ground_bounce || shot->coarse || !shot->scene->world->landscape || !find_ground(&b, p_enu, shot, t))
        return STATUS_OK;
    if (!reflection_is_seen(shot, t, &b, p_enu)) return STATUS_OK;
    v3_scale(b.p_image_enu, b.image.range_m, b.image.u);
    m3_mul_v3(b.p_image_enu, t->r_enu_from_body, (double[3]){b.p_image_enu[0], b.p_image_enu[1], b.p_image_enu[2]});
    v3_add(b.p_image_enu, b.p_image_enu, t->p_enu);
    v3_add_scaled(b.v_image_enu_mps, shot->scene->v_enu_mps, -2 * v3_dot(shot->scene->v_enu_mps, b.n_enu), b.n_enu);
    for (int twice = 0; twice < 2; twice++) {
        const SignatureLook look = {
            .tx = twice ? b.image : t->antenna, .rx = b.image, .image = {twice, true}, .plane = b.plane};
        const Signature *signature;
        Status status = signatures_find(&signature, r->signatures, t->model, t->joint, snapshot_damage(t->entity),
                                        &look, shot->pool);
        if (status != STATUS_OK) return status;
        if (!signature) shot->missing++;
        if (shot->missing > 0) continue;
        status = centres_make(&r->centres, signature, &look.tx, &look.rx, shot->pool);
        if (status != STATUS_OK) return status;
        centres_field(twice ? &s.twice : &s.once, &r->centres, shot->preset->wave.centre_hz);
        status = add_echoes(shot, t, &b, truth, !twice);
        if (status != STATUS_OK) return status;
    }
    if (shot->missing > 0) return STATUS_OK;
    s.direct = *direct;
    add_truth(truth, shot, &b, &s);
    return STATUS_OK;
}
