/* sensor/radar/shot_sight.c: the way from the antenna to a place: geometry, the radar equation, and what stands
 * before it. */
#include "sensor/radar/seeker_radar_private.h"

/* ---- geometry and the radar equation ------------------------------------------------------------ */

void shot_sight(Sight *out, const RadarShot *shot, const double p_enu[3], double more_m)
{
    double to[3];
    v3_sub(to, p_enu, shot->p_enu);
    out->range_m = v3_length(to);
    v3_scale(out->d_enu, 1 / fmax(out->range_m, 1e-3), to);
    out->cos_right = v3_dot(out->d_enu, shot->right);
    out->cos_down = v3_dot(out->d_enu, shot->down);
    const double fold_m = waveform_fold_m(&shot->preset->wave);
    double       off_m = out->range_m - shot->reference_m;
    if (shot->preset->far_m > 0 && out->range_m < shot->preset->far_m + more_m)
        off_m -= fold_m * nearbyint(off_m / fold_m);
    out->within = v3_dot(out->d_enu, shot->ahead) > 0 && fabs(off_m) < shot->half_window_m + (shot->sweep_m + more_m);
}

double shot_off_axis(const RadarShot *shot, const Sight *sight)
{
    if (!(shot->sector_half_rad > 0))
        return sqrt(sight->cos_right * sight->cos_right + sight->cos_down * sight->cos_down);
    const double ahead = v3_dot(sight->d_enu, shot->ahead), azimuth = atan2(sight->cos_right, ahead);
    const double off = azimuth - clamp(azimuth, -shot->sector_half_rad, shot->sector_half_rad);
    return hypot(sin(off) * hypot(sight->cos_right, ahead), sight->cos_down);
}

double shot_range_rate(const RadarShot *shot, const Sight *sight, const double v_enu_mps[3])
{
    return v3_dot(sight->d_enu, v_enu_mps) - v3_dot(sight->d_enu, shot->scene->v_enu_mps);
}

double shot_appears_m(const RadarShot *shot, const Sight *sight, double range_rate_mps)
{
    const double followed_mps = shot->preset->wave.uncompensated ? 0 : shot->reference_rate_mps;
    const double middle_m = shot->reference_m;
    return middle_m + waveform_appears_m(&shot->preset->wave, sight->range_m - middle_m, range_rate_mps - followed_mps);
}

void shot_amplitudes(double complex amplitude[interval_channels], const RadarShot *shot, const Sight *sight,
                     const ScatterMatrix *s)
{
    shot_amplitudes_through(amplitude, shot, sight, s, shot_volume_np(shot, sight));
}

void shot_amplitudes_through(double complex amplitude[interval_channels], const RadarShot *shot, const Sight *sight,
                             const ScatterMatrix *s, double volume_np)
{
    const RadarPreset *p = shot->preset;
    const AntennaGain  gain = antenna_gain(&p->antenna, sight->cos_right, sight->cos_down);
    const RadarLink    link = {p->power_w, 1, 1, p->antenna.wavelength_m, sight->range_m, p->loss};
    const double       through_np = shot->air_np_m * sight->range_m + volume_np;
    const double       unit =
        sqrt(radar_received_w(&link, 4 * pi_rad) * exp(-2 * through_np)) * waveform_share(&p->wave, sight->range_m);
    const double complex same = unit * gain.sum * (p->transmits_h ? s->hh : s->vv);
    const double complex other = unit * gain.sum * (p->transmits_h ? s->vh : s->hv);
    amplitude[CHANNEL_SUM] = same * gain.sum;
    amplitude[CHANNEL_RIGHT] = same * gain.right;
    amplitude[CHANNEL_DOWN] = same * gain.down;
    amplitude[CHANNEL_CROSS] = other * gain.sum;
}

double shot_null(const RadarShot *shot)
{
    static const double null_u[] = {3.8317, 5.1356, 6.3802}; /* first zero of the sum beam by the dish's taper */
    return fmin(null_u[shot->preset->antenna.taper] / antenna_u_per_sine(&shot->preset->antenna), 1);
}

/* ---- what stands before places -------------------------------------------------------------------- */

/* The line of sight to where air raises a place to. */
static Sight raised(const RadarShot *shot, const double from_enu[3], const Sight *sight)
{
    double p_enu[3];
    Sight  out = *sight;
    if (!(visibility_bend(shot->visibility) > 0)) return out;
    v3_add_scaled(p_enu, from_enu, sight->range_m, sight->d_enu);
    p_enu[2] += visibility_lift_at(shot->visibility, p_enu);
    v3_sub(out.d_enu, p_enu, from_enu);
    out.range_m = v3_length(out.d_enu);
    if (!v3_normalize(out.d_enu, out.d_enu)) return *sight;
    return out;
}

/* Rays from one place, of a thread. */
typedef struct SightRays {
    Rays       rays;
    EntityHits none; /* of an entity that is not asked */
    double     met_m[hits_capacity];
    uint32_t   met[hits_capacity];
    int        of[hits_capacity]; /* place that a ray is of */
} SightRays;

/* Marks the places before which something is met; own: that entity is no obstacle. */
static void mark_hidden(bool *hidden, SightRays *s, const RadarShot *shot, const double *range_m, const double *slack_m,
                        RayEntities among, int own)
{
    VisibilityCounters counters = {0};
    visibility_first_range(s->met_m, s->met, shot->visibility, &s->rays, among, &counters);
    for (int i = 0; i < s->rays.count; i++) {
        const int at = s->of[i];
        hidden[at] =
            s->met_m[i] < INFINITY && range_m[at] - s->met_m[i] > slack_m[at] && (own < 0 || (int)s->met[i] != own + 1);
    }
}

void shot_hidden(bool *hidden, const RadarShot *shot, const double from_enu[3], const Sight *sight,
                 const double *slack_m, int count, int own)
{
    static _Thread_local SightRays s;
    static const double            more_m = 1e-6; /* a ray searches on past its slack by so much, for rounding */
    double                         range_m[hits_capacity];
    RayEntities                    among = visibility_all_but(shot->scene->hidden);
    s.rays.count = count;
    s.rays.columns = 0;
    s.rays.bent = true;
    for (int i = 0; i < count; i++) {
        const Sight to = raised(shot, from_enu, &sight[i]);
        s.of[i] = i;
        range_m[i] = to.range_m;
        s.rays.far_m[i] = slack_m[i] > more_m ? fmax(to.range_m - slack_m[i] + more_m, 0) : to.range_m;
        for (int k = 0; k < 3; k++) {
            s.rays.o_enu[k][i] = from_enu[k];
            s.rays.d_enu[k][i] = to.d_enu[k];
        }
    }
    if (own < 0) {
        mark_hidden(hidden, &s, shot, range_m, slack_m, among, own);
        return;
    }
    /* where nothing else is met, the entity itself is not asked: it would hide nothing */
    s.none.entity = own;
    for (int i = 0; i < count; i++) s.none.range_m[i] = INFINITY;
    among.known = &s.none;
    mark_hidden(hidden, &s, shot, range_m, slack_m, among, own);
    int left = 0;
    for (int i = 0; i < count; i++) {
        if (!hidden[i]) continue;
        s.of[left] = i;
        s.rays.far_m[left] = s.rays.far_m[i];
        for (int k = 0; k < 3; k++) s.rays.d_enu[k][left] = s.rays.d_enu[k][i];
        left++;
    }
    s.rays.count = left;
    among.known = NULL;
    if (left > 0) mark_hidden(hidden, &s, shot, range_m, slack_m, among, own);
}

/* ---- which scattering centres of an entity are in sight, past relief, plants and other entities ------ */

enum { cells_along = 48, most_cells = cells_along * cells_along * cells_along, block_rays = 256 };
static const double least_side_m = 0.05;

/* Cells of centres, each with one sight line. */
typedef struct Lines {
    const RadarShot *shot;
    int              entity, count;
    double (*p_enu)[3]; /* [count] the ends of the sight lines */
    bool *hidden;       /* [count] */
} Lines;

static void look_along(void *user, int worker, int task)
{
    static const double no_slack_m[block_rays];
    const Lines        *l = user;
    const double       *p = l->shot->scene->view->p_enu;
    const int first = task * block_rays, left = l->count - first, count = left < block_rays ? left : block_rays;
    Sight     sight[block_rays];
    (void)worker;
    for (int i = 0; i < count; i++) {
        v3_sub(sight[i].d_enu, l->p_enu[first + i], p);
        sight[i].range_m = v3_length(sight[i].d_enu);
        v3_normalize(sight[i].d_enu, sight[i].d_enu);
    }
    shot_hidden(l->hidden + first, l->shot, p, sight, no_slack_m, count, l->entity);
}

/* Puts centres into cells, body axes: of[i] is that of centre i; returns how many there are. middle: mean position of a
 * cell's centres by amplitude. */
static int make_cells(int *of, double (*middle)[3], double *weight, int32_t *grid, const Centres *centres)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, side_m = least_side_m;
    int    size[3], count = 0;
    for (int i = 0; i < centres->count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], centres->centre[i].p[k]);
            high[k] = fmax(high[k], centres->centre[i].p[k]);
        }
    for (int k = 0; k < 3; k++) side_m = fmax(side_m, (high[k] - low[k]) / (cells_along - 1));
    for (int k = 0; k < 3; k++) size[k] = (int)((high[k] - low[k]) / side_m) + 1;
    memset(grid, 0xff, (size_t)(size[0] * size[1] * size[2]) * sizeof *grid);
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        int                  at = 0;
        for (int k = 0; k < 3; k++) at = at * size[k] + (int)((c->p[k] - low[k]) / side_m);
        if (grid[at] < 0) {
            grid[at] = count;
            memset(middle[count], 0, sizeof middle[count]);
            weight[count++] = 0;
        }
        of[i] = grid[at];
        v3_add_scaled(middle[of[i]], middle[of[i]], c->weight, c->p);
        weight[of[i]] += c->weight;
    }
    return count;
}

Status shot_sees_centres(bool *seen, const RadarShot *shot, int entity, const double p_enu[3],
                         const double r_enu_from_body[9], const Centres *centres)
{
    const size_t n = (size_t)centres->count + 1;
    int         *of = arena_alloc(shot->arena, n, sizeof *of);
    int32_t     *grid = arena_alloc(shot->arena, most_cells, sizeof *grid);
    double      *weight = arena_alloc(shot->arena, n, sizeof *weight);
    Lines        lines = {.shot = shot,
                          .entity = entity,
                          .p_enu = arena_alloc(shot->arena, n, sizeof *lines.p_enu),
                          .hidden = arena_alloc(shot->arena, n, sizeof *lines.hidden)};
    if (!of || !grid || !weight || !lines.p_enu || !lines.hidden) return STATUS_NO_MEMORY;
    if (centres->count == 0) return STATUS_OK;
    lines.count = make_cells(of, lines.p_enu, weight, grid, centres);
    for (int i = 0; i < lines.count; i++) {
        double p_body[3];
        v3_scale(p_body, weight[i] > 0 ? 1 / weight[i] : 0, lines.p_enu[i]);
        m3_mul_v3(lines.p_enu[i], r_enu_from_body, p_body);
        v3_add(lines.p_enu[i], lines.p_enu[i], p_enu);
    }
    const int tasks = (lines.count + block_rays - 1) / block_rays;
    if (shot->pool) pool_run(shot->pool, tasks, look_along, &lines);
    else
        for (int t = 0; t < tasks; t++) look_along(&lines, 0, t);
    for (int i = 0; i < centres->count; i++) seen[i] = !lines.hidden[of[i]];
    return STATUS_OK;
}
