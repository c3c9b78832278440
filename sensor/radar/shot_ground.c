/* sensor/radar/shot_ground.c: the ground in a shot: its own echoes within the main lobe, wherever it turns, and the
 * range window; and the echoes of entities by way of it. */
#include "sensor/radar/seeker_radar_private.h"
#include "render/scattering/paths/radar_path.h"

/* ---- the ground's own echoes -------------------------------------------------------------------- */

enum { cells_most = 400000, block = hits_capacity };

static const double sight_slack_m = 0.5; /* ground met so much before a scatterer is its own */

void shot_lit_rectangle(double low_m[2], double high_m[2], const RadarShot *shot)
{
    const double *p = shot->scene->view->p_enu, reach = shot->frame->reference_m,
                 lobe_rad = asin(fmin(shot->reach * shot_null(shot), 1));
    const double below_m = p[2] - shot->base_m;
    const double level = hypot(shot->ahead[0], shot->ahead[1]), azimuth = atan2(shot->ahead[1], shot->ahead[0]);
    const double turn = atan2(tan(fmin(shot->sector_half_rad, 1.5)), fmax(level, 0.05));
    const double wide = fmin(lobe_rad / fmax(level - lobe_rad, 0.05) + turn, pi_rad), margin_m = 50 + 0.02 * reach;
    const double range_m[2] = {shot->near_m, shot->far_m};
    low_m[0] = low_m[1] = INFINITY;
    high_m[0] = high_m[1] = -INFINITY;
    for (int end = 0; end < 2; end++) {
        const double plan_m =
            sqrt(fmax(range_m[end] * range_m[end] - below_m * below_m, 0)) + (end ? margin_m : -margin_m);
        for (int i = -4; i <= 4; i++) {
            const double a = azimuth + wide * i / 4,
                         at[2] = {p[0] + fmax(plan_m, 0) * cos(a), p[1] + fmax(plan_m, 0) * sin(a)};
            for (int k = 0; k < 2; k++) {
                low_m[k] = fmin(low_m[k], at[k]);
                high_m[k] = fmax(high_m[k], at[k]);
            }
        }
    }
}

/* Scatterers of a block, as the table and the echoes need them. */
typedef struct Ground {
    int         count;
    ClutterCell cell[block];
    double      p_enu[3][block];
    float       n_enu[3][block];
    uint8_t     surface[block];
    Sight       sight[block];
} Ground;

typedef struct GroundJob {
    const RadarShot   *shot;
    const ClutterCell *cell;
    int                cells;
    double             widest; /* sine off the axis of the main lobe's null */
    Ground            *ground; /* [blocks] */
    RadarPoint        *point;  /* [cells]: points of block b begin at b * block */
    int               *hidden; /* [blocks] */
} GroundJob;

/* Places the cells of the block, as far as they are within beam and window. */
static void place_block(Ground *g, const GroundJob *job, int first, int end)
{
    const RadarShot *shot = job->shot;
    const Landscape *land = shot->scene->world->landscape;
    g->count = 0;
    for (int i = first; i < end; i++) {
        double p[3], n[3];
        Sight  sight;
        clutter_place(p, &shot->radar->cells, &job->cell[i]);
        p[2] = elevation_height(&land->elevation, p[0], p[1], n);
        if (!isfinite(p[2])) continue;
        shot_sight(&sight, shot, p, 0);
        if (!sight.within || shot_off_axis(shot, &sight) > job->widest) continue;
        const int to = g->count++;
        g->cell[to] = job->cell[i];
        g->sight[to] = sight;
        for (int k = 0; k < 3; k++) {
            g->p_enu[k][to] = p[k];
            g->n_enu[k][to] = (float)n[k];
        }
    }
}

/* Takes out what relief or entities hide. */
static void drop_hidden(Ground *g, const RadarShot *shot, int *hidden)
{
    bool   out[block];
    double slack_m[block];
    for (int i = 0; i < g->count; i++) slack_m[i] = sight_slack_m;
    shot_hidden(out, shot, shot->scene->view->p_enu, g->sight, slack_m, g->count, -1);
    int kept = 0;
    for (int i = 0; i < g->count; i++) {
        if (out[i]) continue;
        g->cell[kept] = g->cell[i];
        g->sight[kept] = g->sight[i];
        for (int k = 0; k < 3; k++) {
            g->p_enu[k][kept] = g->p_enu[k][i];
            g->n_enu[k][kept] = g->n_enu[k][i];
        }
        kept++;
    }
    *hidden = g->count - kept;
    g->count = kept;
}

/* Where plants have echoes of their own, the ground of woods is what grows below them, and is taken as grass. */
static void take_canopy_off(Ground *g, const Foliage *foliage)
{
    for (int i = 0; i < g->count && foliage; i++) {
        const uint8_t s = g->surface[i];
        if ((s == SURFACE_FOREST_BROADLEAF || s == SURFACE_FOREST_CONIFER || s == SURFACE_SCRUB) &&
            foliage_reaches(foliage, g->p_enu[0][i], g->p_enu[1][i]))
            g->surface[i] = SURFACE_GRASS;
    }
}

static void scatter_block(void *user, int worker, int task)
{
    static _Thread_local ClutterScatterer scatterer[block];
    static _Thread_local ScatterMatrix    matrix[block];
    const GroundJob                      *job = user;
    const RadarShot                      *shot = job->shot;
    const SeekerRadar                    *r = shot->radar;
    Ground                               *g = &job->ground[task];
    const int first = task * block, end = first + block < job->cells ? first + block : job->cells;
    (void)worker;
    place_block(g, job, first, end);
    job->hidden[task] = 0;
    if (g->count == 0) return;
    drop_hidden(g, shot, &job->hidden[task]);
    landscape_surfaces(g->surface, shot->scene->world->landscape, g->count, g->p_enu[0], g->p_enu[1]);
    take_canopy_off(g, r->foliage);
    const ClutterKind kind = {&r->cells, &r->clutter, r->band};
    clutter_cache_draw(scatterer, r->drawn, &kind, g->count, g->cell, g->surface);
    const double       *p = shot->scene->view->p_enu;
    const ClutterGround ground = {g->count,
                                  g->cell,
                                  g->surface,
                                  {g->p_enu[0], g->p_enu[1], g->p_enu[2]},
                                  {g->n_enu[0], g->n_enu[1], g->n_enu[2]}};
    const ClutterLook   look = {{p[0], p[1], p[2]}, shot->preset->wave.centre_hz, shot->scene->t_s, r->wind_mps};
    clutter_see(matrix, &r->cells, &r->clutter, scatterer, &ground, &look);
    static const double still[3] = {0, 0, 0};
    for (int i = 0; i < g->count; i++) {
        double to_antenna[3], h[3], v[3];
        v3_scale(to_antenna, -1, g->sight[i].d_enu);
        scatter_basis(h, v, to_antenna);
        scatter_turn(&matrix[i], h, v, shot->right);
        job->point[first + i] = (RadarPoint){
            .p_enu = {g->p_enu[0][i], g->p_enu[1][i], g->p_enu[2][i]},
            .path_m = 2 * (g->sight[i].range_m - shot->reference_m),
            .path_per_pulse_m = 2 * (shot_range_rate(shot, &g->sight[i], still) - shot->reference_rate_mps) /
                                shot->preset->wave.repeat_hz,
            .same = shot->preset->transmits_h ? matrix[i].hh : matrix[i].vv,
            .other = shot->preset->transmits_h ? matrix[i].vh : matrix[i].hv,
            .share = 1,
            .widest = job->widest};
    }
}

Status shot_ground(RadarShot *shot)
{
    SeekerRadar  *r = shot->radar;
    const double *p = shot->scene->view->p_enu, widest = fmin(shot->reach * shot_null(shot), 1),
                 lobe_rad = asin(shot_null(shot));
    double low_m[2], high_m[2];
    shot_lit_rectangle(low_m, high_m, shot);

    /* sides of 1/128 of the beam's width, less where the resolution asks for it near by; coarser where that is too
     * many */
    double       share = lobe_rad / 128;
    const size_t most = shot->sector_half_rad > 0 ? 2 * cells_most : cells_most;
    ClutterCell *cell = arena_alloc(shot->arena, most, sizeof *cell);
    size_t       count;
    if (!cell) return STATUS_NO_MEMORY;
    while ((count = clutter_cells_at(cell, most, &r->cells, low_m, high_m, p, share)) > most) share *= sqrt(2);
    const int blocks = (int)((count + block - 1) / block);
    GroundJob job = {.shot = shot,
                     .cell = cell,
                     .cells = (int)count,
                     .widest = widest,
                     .ground = arena_alloc(shot->arena, (size_t)blocks + 1, sizeof *job.ground),
                     .point = radar_points_room(&r->points, blocks * block + 1),
                     .hidden = arena_alloc(shot->arena, (size_t)blocks + 1, sizeof *job.hidden)};
    if (!job.ground || !job.point || !job.hidden) return STATUS_NO_MEMORY;
    if (shot->pool) pool_run(shot->pool, blocks, scatter_block, &job);
    else
        for (int b = 0; b < blocks; b++) scatter_block(&job, 0, b);
    for (int b = 0; b < blocks; b++) {
        const size_t kept = (size_t)job.ground[b].count;
        memmove(r->points.point + r->points.count, job.point + (size_t)b * block, kept * sizeof *job.point);
        r->points.count += (int)kept;
        shot->frame->ground_cells += job.ground[b].count + job.hidden[b];
        shot->frame->ground_hidden += job.hidden[b];
    }
    return STATUS_OK;
}

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

static Way way_direct(const RadarShot *shot, const double p_enu[3], const double v_enu_mps[3])
{
    Sight to;
    shot_sight(&to, shot, p_enu, 0);
    return (Way){to.range_m, shot_range_rate(shot, &to, v_enu_mps), shot_volume_np(shot, &to),
                 antenna_gain(&shot->preset->antenna, to.cos_right, to.cos_down)};
}

static Way way_by_ground(const RadarShot *shot, const Bounce *b, const double p_enu[3], const double v_enu_mps[3])
{
    double to[3], d[3], v[3];
    Sight  direct;
    shot_sight(&direct, shot, p_enu, 0);
    v3_sub(to, p_enu, b->p_image_enu);
    const double range_m = v3_length(to);
    v3_scale(to, 1 / range_m, to);
    v3_sub(v, v_enu_mps, b->v_image_enu_mps);
    v3_add_scaled(d, to, -2 * v3_dot(to, b->n_enu), b->n_enu); /* as it leaves the antenna */
    return (Way){range_m, v3_dot(to, v), shot_volume_np(shot, &direct),
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

/* Adds the echoes of the centres at hand that go by the ground one way, in either order (once), or both ways. */
static Status add_echoes(RadarShot *shot, const Target *t, const Bounce *b, const RadarTruth *truth, bool once)
{
    SeekerRadar *r = shot->radar;
    const int    count = r->centres.count;
    const double pulse_s = 1 / shot->preset->wave.repeat_hz;
    Echo        *echo = arena_alloc(shot->arena, (size_t)count + 1, sizeof *echo);
    if (!echo) return STATUS_NO_MEMORY;
    for (int i = 0; i < count; i++) {
        const ScatterCentre *c = &r->centres.centre[i];
        double               p_enu[3], v_enu_mps[3];
        ScatterMatrix        s;
        m3_mul_v3(p_enu, t->r_enu_from_body, c->p);
        v3_add(p_enu, p_enu, t->p_enu);
        shot_target_velocity(v_enu_mps, t, t->of->part[c->part].node, c->p);
        const Way ground = way_by_ground(shot, b, p_enu, v_enu_mps);
        const Way other = once ? way_direct(shot, p_enu, v_enu_mps) : ground;
        ground_through(&s, &c->s, &b->by_ground, once ? &b->direct : &b->by_ground);
        echo[i] = (Echo){.path_m = t->antenna.range_m + b->image.range_m - 2 * shot->reference_m + c->path_m};
        if (!once) echo[i].path_m += b->by_ground.extra_m;
        add_amplitudes(echo[i].amplitude, shot, &other, &ground, &s);
        if (once) add_amplitudes(echo[i].amplitude, shot, &ground, &other, &(ScatterMatrix){s.hh, s.vh, s.hv, s.vv});
        for (int k = 0; k < interval_channels; k++) echo[i].amplitude[k] *= sqrt(truth->visible);
        echo[i].path_per_pulse_m = (ground.rate_mps + other.rate_mps - 2 * shot->reference_rate_mps) * pulse_s;
    }
    echo_add(r->echoes, echo, count, shot->pool);
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
