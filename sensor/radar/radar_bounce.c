/* sensor/radar/radar_bounce.c: the echoes of entities by way of the ground near them. */
#include "sensor/radar/seeker_radar_private.h"

#include "render/radar/radar_equation.h"

enum { steps = 4 };
static const double near_ground = 2;   /* radii above the ground up to which its plane is that under the entity */
static const double slack_m = 0.5, slack_height_m = 0.1; /* ground met so much before the reflection is its own */

typedef struct Bounce {
    double         p_ground_enu[3], n_enu[3];  /* a point of the plane, its normal */
    double         p_image_enu[3], v_image_enu_mps[3];
    GroundPlane    plane;                      /* body axes */
    ScatterAntenna image;
    GroundLeg      direct, by_ground;
} Bounce;

/* ---- where the ground mirrors ------------------------------------------------------------------------- */

static bool plane_at(Bounce *b, const Making *m, const Target *t, const double p_enu[2])
{
    const Elevation *elevation = &m->scene->world->landscape->elevation;
    b->p_ground_enu[0] = p_enu[0];
    b->p_ground_enu[1] = p_enu[1];
    b->p_ground_enu[2] = elevation_height(elevation, p_enu[0], p_enu[1], b->n_enu);
    if (!isfinite(b->p_ground_enu[2]) || !v3_is_finite(b->n_enu)) return false;
    ground_plane(&b->plane, b->p_ground_enu, b->n_enu, t->p_enu, t->r_enu_from_body);
    return true;
}

/* The point of the plane by which the antenna sees the entity's origin. */
static void reflection_of(double p_enu[3], const Bounce *b, const Target *t)
{
    double p_body[3];
    ground_reflection_point(p_body, &b->image, &b->plane);
    m3_mul_v3(p_enu, t->r_enu_from_body, p_body);
    v3_add(p_enu, p_enu, t->p_enu);
}

/* The plane of the ground under an entity that is near it; else that at the reflection, found in a few steps. False:
 * the ground does not mirror this entity to the antenna. */
static bool find_ground(Bounce *b, double p_enu[3], const Making *m, const Target *t)
{
    double extra_m = 0, right[3];
    if (!plane_at(b, m, t, t->p_enu)) return false;
    const bool raised = b->plane.height_m > near_ground * t->of->radius_m;
    for (int step = 0; step <= (raised ? steps : 0); step++) {
        if (step > 0 && !plane_at(b, m, t, p_enu)) return false;
        if (!(b->plane.height_m > -t->of->radius_m)) return false;
        extra_m = ground_image(&b->image, &t->antenna, &b->plane);
        if (!(v3_dot(b->plane.n, b->image.u) < -1e-4)) return false;
        reflection_of(p_enu, b, t);
    }
    m3_tmul_v3(right, t->r_enu_from_body, m->right);
    const int           surface = landscape_surface(m->scene->world->landscape, p_enu[0], p_enu[1]);
    const GroundSurface of = ground_surface(&m->radar->mirror.row[surface], m->preset->wave.centre_hz);
    const double        k = 2 * pi_rad / m->preset->antenna.wavelength_m;
    ground_leg_direct(&b->direct, &t->antenna, right);
    if (!ground_leg_image(&b->by_ground, &t->antenna, &b->image, extra_m, &b->plane, &of, k, right)) return false;
    return b->by_ground.coherence >= ground_least_coherence && extra_m < m->half_window_m;
}

/* Whether the antenna sees the reflection: within its beam, and nothing but the entity itself before it. */
static bool reflection_is_seen(const Making *m, const Target *t, const Bounce *b, const double p_enu[3])
{
    const double own_m = fmax(slack_m, slack_height_m / -v3_dot(b->plane.n, b->image.u));
    bool         hidden;
    Sight        to;
    making_sight(&to, m, p_enu, m->half_window_m);
    if (!(v3_dot(to.d_enu, m->ahead) > 0) || making_off_axis(m, &to) > m->widest) return false;
    making_hidden(&hidden, m, m->p_enu, &to, &own_m, 1, t->index);
    return !hidden;
}

/* ---- echoes ------------------------------------------------------------------------------------------- */

/* One way between the antenna and a place: length, its growth, and the antenna's gain in its direction. */
typedef struct Way {
    double      range_m, rate_mps;
    double      volume_np;  /* power lost in foliage and chaff; by the ground: as directly */
    AntennaGain gain;
} Way;

static Way way_direct(const Making *m, const double p_enu[3], const double v_enu_mps[3])
{
    Sight to;
    making_sight(&to, m, p_enu, 0);
    return (Way){to.range_m, making_range_rate(m, &to, v_enu_mps), making_volume_np(m, &to),
                 antenna_gain(&m->preset->antenna, to.cos_right, to.cos_down)};
}

static Way way_by_ground(const Making *m, const Bounce *b, const double p_enu[3], const double v_enu_mps[3])
{
    double to[3], d[3], v[3];
    Sight  direct;
    making_sight(&direct, m, p_enu, 0);
    v3_sub(to, p_enu, b->p_image_enu);
    const double range_m = v3_length(to);
    v3_scale(to, 1 / range_m, to);
    v3_sub(v, v_enu_mps, b->v_image_enu_mps);
    v3_add_scaled(d, to, -2 * v3_dot(to, b->n_enu), b->n_enu); /* as it leaves the antenna */
    return (Way){range_m, v3_dot(to, v), making_volume_np(m, &direct),
                 antenna_gain(&m->preset->antenna, v3_dot(d, m->right), v3_dot(d, m->down))};
}

/* As making_amplitudes, out by one way and back by another. */
static void add_amplitudes(double complex amplitude[interval_channels], const Making *m, const Way *out,
                           const Way *back, const ScatterMatrix *s)
{
    const RadarPreset   *p = m->preset;
    const RadarLink link = {p->power_w, 1, 1, p->antenna.wavelength_m, sqrt(out->range_m * back->range_m), p->loss};
    const double         lost_np = m->air_np_m * (out->range_m + back->range_m) + out->volume_np + back->volume_np;
    const double         unit = sqrt(radar_received_w(&link, 4 * pi_rad) * exp(-lost_np));
    const double complex same = unit * out->gain.sum * (p->transmits_h ? s->hh : s->vv);
    const double complex other = unit * out->gain.sum * (p->transmits_h ? s->vh : s->hv);
    amplitude[CHANNEL_SUM] += same * back->gain.sum;
    amplitude[CHANNEL_RIGHT] += same * back->gain.right;
    amplitude[CHANNEL_DOWN] += same * back->gain.down;
    amplitude[CHANNEL_CROSS] += other * back->gain.sum;
}

/* Of the centres at hand, by the ground one way and (once) the other way round, or both ways. */
static Status add_echoes(Making *m, const Target *t, const Bounce *b, const RadarTruth *truth, bool once)
{
    SeekerRadar  *r = m->radar;
    const int     count = r->centres.count;
    const double  pulse_s = 1 / m->preset->wave.repeat_hz;
    Echo         *echo = arena_alloc(m->arena, (size_t)count + 1, sizeof *echo);
    if (!echo) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) {
        const ScatterCentre *c = &r->centres.centre[i];
        double               p_enu[3], v_enu_mps[3];
        ScatterMatrix        s;
        m3_mul_v3(p_enu, t->r_enu_from_body, c->p);
        v3_add(p_enu, p_enu, t->p_enu);
        making_target_velocity(v_enu_mps, t, t->of->part[c->part].node, c->p);
        const Way ground = way_by_ground(m, b, p_enu, v_enu_mps);
        const Way other = once ? way_direct(m, p_enu, v_enu_mps) : ground;
        ground_through(&s, &c->s, &b->by_ground, once ? &b->direct : &b->by_ground);
        echo[i] = (Echo){.path_m = t->antenna.range_m + b->image.range_m - 2 * m->reference_m + c->path_m};
        if (!once) echo[i].path_m += b->by_ground.extra_m;
        add_amplitudes(echo[i].amplitude, m, &other, &ground, &s);
        if (once) add_amplitudes(echo[i].amplitude, m, &ground, &other, &(ScatterMatrix){s.hh, s.vh, s.hv, s.vv});
        for (int k = 0; k < interval_channels; k++) echo[i].amplitude[k] *= sqrt(truth->visible);
        echo[i].path_per_pulse_m = (ground.rate_mps + other.rate_mps - 2 * m->reference_rate_mps) * pulse_s;
    }
    echo_add(r->echoes, echo, count, m->pool);
    return STATUS_OK;
}

static void areas(double m2[3], const ScatterMatrix *s)
{
    const double complex of[3] = {s->hh, s->vv, s->hv};
    for (int p = 0; p < 3; p++) m2[p] = 4 * pi_rad * (creal(of[p]) * creal(of[p]) + cimag(of[p]) * cimag(of[p]));
}

static void add_truth(RadarTruth *truth, const Making *m, const Bounce *b, const GroundFields *s)
{
    static const ScatterMatrix none;
    const double  k = 2 * pi_rad / m->preset->antenna.wavelength_m;
    const int     sent = m->preset->transmits_h ? 0 : 1;
    ScatterMatrix sum;
    ground_sum(&sum, s, &b->direct, &b->by_ground, k);
    areas(truth->bounce.rcs_m2, &sum);
    ground_sum(&sum, &(GroundFields){none, s->once, none}, &b->direct, &b->by_ground, k);
    areas(truth->bounce.once_m2, &sum);
    ground_sum(&sum, &(GroundFields){none, none, s->twice}, &b->direct, &b->by_ground, k);
    areas(truth->bounce.twice_m2, &sum);
    truth->bounce.coherence = b->by_ground.coherence;
    if (truth->rcs_m2[sent] > 0) truth->snr *= truth->bounce.rcs_m2[sent] / truth->rcs_m2[sent];
}

Status making_bounce(Making *m, const Target *t, const ScatterMatrix *direct, RadarTruth *truth)
{
    SeekerRadar *r = m->radar;
    Bounce       b;
    GroundFields s;
    double       p_enu[3];
    if (!r->ground_bounce || !m->scene->world->landscape || !find_ground(&b, p_enu, m, t)) return STATUS_OK;
    if (!reflection_is_seen(m, t, &b, p_enu)) return STATUS_OK;
    v3_scale(b.p_image_enu, b.image.range_m, b.image.u);
    m3_mul_v3(b.p_image_enu, t->r_enu_from_body, (double[3]){b.p_image_enu[0], b.p_image_enu[1], b.p_image_enu[2]});
    v3_add(b.p_image_enu, b.p_image_enu, t->p_enu);
    v3_add_scaled(b.v_image_enu_mps, m->scene->v_enu_mps, -2 * v3_dot(m->scene->v_enu_mps, b.n_enu), b.n_enu);
    for (int twice = 0; twice < 2; twice++) {
        const SignatureLook  look = {.tx = twice ? b.image : t->antenna, .rx = b.image, .image = {twice, true},
                                     .plane = b.plane};
        const Signature     *signature;
        Status status = signatures_find(&signature, r->signatures, t->model, t->joint, snapshot_damage(t->entity),
                                        &look, m->pool);
        if (status != STATUS_OK) return status;
        if (!signature) m->missing++;
        if (m->missing > 0) continue;
        status = centres_make(&r->centres, signature, &look.tx, &look.rx, m->pool);
        if (status != STATUS_OK) return status;
        centres_field(twice ? &s.twice : &s.once, &r->centres, m->preset->wave.centre_hz);
        status = add_echoes(m, t, &b, truth, !twice);
        if (status != STATUS_OK) return status;
    }
    if (m->missing > 0) return STATUS_OK;
    s.direct = *direct;
    add_truth(truth, m, &b, &s);
    return STATUS_OK;
}
