/* sensor/radar/radar_volume.c: what fills the air before and about the targets: which of it weakens every echo, and
 * the echoes of rain. */
#include "sensor/radar/radar_volume.h"

#include "render/radar/rain_scatter.h"

enum { rings = 4, sectors = 8, strata = rings * sectors, slices_most = 4096, stream_rain = 0x52414900 };

static const double nearest_m = 10;       /* of rain: an antenna's near field */
static const double turbulence_mps = 1.0; /* rms, each way: Nathanson, Radar Design Principles, 2nd ed. 1991, 6.7 */

/* ---- on the way of every echo -------------------------------------------------------------------- */

Status making_volume_open(Making *m)
{
    const World *world = m->scene->world;
    SeekerRadar *r = m->radar;
    const Woods *woods = world->forest ? forest_woods(world->forest) : NULL;
    if (r->foliage && (!woods || foliage_woods(r->foliage) != woods)) {
        foliage_destroy(r->foliage);
        r->foliage = NULL;
    }
    if (woods && !r->foliage && r->in_band) {
        const Status status = foliage_create(&r->foliage, woods, forest_plants(world->forest), &r->clutter, r->band);
        if (status != STATUS_OK) return status;
    }
    return making_chaff_open(m);
}

double making_volume_np(const Making *m, const Sight *sight)
{
    double np = 0;
    if (m->radar->foliage)
        np = foliage_loss_db(NULL, m->radar->foliage, m->p_enu, sight->d_enu, sight->range_m) * log(10) / 10;
    return m->chaff_count > 0 ? np + making_chaff_np(m, sight) : np;
}

/* ---- numbers ------------------------------------------------------------------------------------- */

uint32_t making_key(const Making *m)
{
    const uint32_t key[2] = {(uint32_t)m->radar->seed, (uint32_t)(m->radar->seed >> 32)};
    uint64_t       bits[2];
    uint32_t       mixed[4] = {m->scene->number};
    memcpy(&bits[0], &m->scene->t_s, 8);
    memcpy(&bits[1], &m->ahead[0], 8);
    for (int k = 0; k < 2; k++) {
        const uint32_t counter[4] = {mixed[0], (uint32_t)bits[k], (uint32_t)(bits[k] >> 32), stream_rain};
        random_u32x4(mixed, counter, key);
    }
    return mixed[0];
}

void making_wind(double v_enu_mps[3], const Making *m)
{
    const Weather *w = m->scene->weather;
    v_enu_mps[0] = -w->wind_mps * sin(w->wind_from_rad);
    v_enu_mps[1] = -w->wind_mps * cos(w->wind_from_rad);
    v_enu_mps[2] = 0;
}

static void place_point(RadarPoint *q, const Making *m, const VolumePoint *point, double widest)
{
    v3_add_scaled(q->p_enu, m->p_enu, point->sight.range_m, point->sight.d_enu);
    memcpy(q->v_enu_mps, point->v_enu_mps, sizeof q->v_enu_mps);
    q->path_m = 2 * (point->sight.range_m - m->reference_m);
    const double off_mps = making_range_rate(m, &point->sight, q->v_enu_mps) - m->reference_rate_mps;
    q->path_per_pulse_m = 2 * off_mps / m->preset->wave.repeat_hz;
    q->same = m->preset->transmits_h ? point->s.hh : point->s.vv;
    q->other = m->preset->transmits_h ? point->s.vh : point->s.hv;
    q->share = 1;
    q->widest = widest;
    q->room_m = 0;
    q->own = m->after_s != 0;
}

int making_keep(RadarPoint *out, VolumePoint *point, int count, const Making *m, double slack_m, double widest)
{
    static _Thread_local Sight sight[hits_capacity];
    static _Thread_local bool  hidden[hits_capacity];
    static _Thread_local double slacks_m[hits_capacity];
    for (int i = 0; i < count; i++) {
        sight[i] = point[i].sight;
        slacks_m[i] = slack_m;
    }
    making_hidden(hidden, m, m->scene->view->p_enu, sight, slacks_m, count, -1);
    int kept = 0;
    for (int i = 0; i < count; i++) {
        if (hidden[i]) continue;
        double to_antenna[3], h[3], v[3];
        v3_scale(to_antenna, -1, point[i].sight.d_enu);
        scatter_basis(h, v, to_antenna);
        if (point[i].turns) scatter_turn(&point[i].s, h, v, m->right);
        place_point(&out[kept++], m, &point[i], widest);
    }
    return kept;
}

typedef struct VolumeJob {
    const Making *making;
    VolumeMake    make;
    void         *user;
    int           each;
    RadarPoint   *point; /* [tasks * each] */
    int          *kept; /* [tasks] */
} VolumeJob;

static void volume_task(void *user, int worker, int task)
{
    const VolumeJob *job = user;
    (void)worker;
    job->kept[task] = job->make(job->point + (size_t)task * (size_t)job->each, job->making, job->user, task);
}

Status making_points(Making *m, int tasks, int each, VolumeMake make, void *user)
{
    VolumeJob job = {.making = m, .each = each, .make = make, .user = user,
                     .point = points_room(&m->radar->points, tasks * each + 1),
                     .kept = arena_alloc(m->arena, (size_t)tasks + 1, sizeof *job.kept)};
    if (!job.point || !job.kept) return STATUS_NO_MEMORY;
    if (m->pool) pool_run(m->pool, tasks, volume_task, &job);
    else for (int t = 0; t < tasks; t++) volume_task(&job, 0, t);
    RadarPoints *points = &m->radar->points;
    for (int t = 0; t < tasks; t++) {
        memmove(points->point + points->count, job.point + (size_t)t * (size_t)each,
                (size_t)job.kept[t] * sizeof *job.point);
        points->count += job.kept[t];
    }
    return STATUS_OK;
}

/* ---- rain ---------------------------------------------------------------------------------------- */

typedef struct Rain {
    RainScatter scatter;
    double      wind_mps[3], top_enu_m, from_m, slice_m, null;
    int         slices;
    uint32_t    key;
} Rain;

enum { slices_a_task = hits_capacity / strata };

/* One scatterer in each of the strata of a slice of range: equal steps of the square of the sine off the axis, by
 * equal sectors; so the power of a slice hardly depends on where they fall. */
static bool place_drop(VolumePoint *out, const Making *m, const Rain *rain, int slice, int stratum)
{
    const uint64_t at = (uint64_t)slice * strata + (uint64_t)stratum;
    double         u[4], n[7], d[3];
    for (uint64_t k = 0; k < 4; k++) u[k] = random_uniform(m->radar->seed, stream_rain + 1, rain->key, 4 * at + k);
    random_normals(n, 7, m->radar->seed, stream_rain + 2, rain->key, 7 * at);
    const double range_m = rain->from_m + (slice + u[0]) * rain->slice_m;
    const double square = rain->null * rain->null * (stratum / sectors + u[1]) / rings;
    const double sine = sqrt(square), along = sqrt(1 - square),
                 turn = 2 * pi_rad * (stratum % sectors + u[2]) / sectors;
    for (int k = 0; k < 3; k++) d[k] = along * m->ahead[k] + sine * (cos(turn) * m->right[k] + sin(turn) * m->down[k]);
    const double p[3] = {m->p_enu[0] + range_m * d[0], m->p_enu[1] + range_m * d[1],
                         m->p_enu[2] + range_m * d[2]};
    making_sight(&out->sight, m, p, 0);
    if (!(p[2] < rain->top_enu_m)) return false;
    /* solid angle: d(sine^2) / 2 by d(turn) over the cosine */
    const double volume_m3 = range_m * range_m * rain->slice_m * rain->null * rain->null * pi_rad / (strata * along);
    const double size = sqrt(rain->scatter.back_1_m * volume_m3 / (8 * pi_rad)), across = size * sqrt(rain_depolarised);
    const double complex same = size * CMPLX(n[0], n[1]), other = across * CMPLX(n[2], n[3]);
    out->s = (ScatterMatrix){.hh = same, .vv = same, .hv = other, .vh = other};
    out->turns = false; /* alike in every basis about the line of sight */
    for (int k = 0; k < 3; k++) out->v_enu_mps[k] = rain->wind_mps[k] + turbulence_mps * n[4 + k];
    out->v_enu_mps[2] -= rain_fall_mps(&rain->scatter, u[3]);
    return true;
}

static int make_rain(RadarPoint *out, const Making *m, void *user, int task)
{
    static _Thread_local VolumePoint point[hits_capacity];
    const Rain                      *rain = user;
    int                              count = 0;
    for (int slice = task * slices_a_task; slice < (task + 1) * slices_a_task && slice < rain->slices; slice++)
        for (int s = 0; s < strata; s++) count += place_drop(&point[count], m, rain, slice, s);
    return making_keep(out, point, count, m, 0, 1.001 * rain->null);
}

Status making_rain(Making *m)
{
    const RadarAir *air = &m->radar->air;
    Rain           *rain = arena_alloc(m->arena, 1, sizeof *rain);
    GasState        state;
    if (!m->scene->world->atmosphere || !(air->rain_mm_h > 0)) return STATUS_OK;
    if (!rain) return STATUS_NO_MEMORY;
    radar_air_at(&state, air, 0);
    const double f_ghz = 1e-9 * m->preset->wave.centre_hz;
    if (!rain_scatter(&rain->scatter, f_ghz, clamp(state.temp_k, 273.15, 323.15), air->rain_mm_h)) return STATUS_OK;
    making_wind(rain->wind_mps, m);
    rain->top_enu_m = m->base_m + air->rain_top_m;
    rain->from_m = fmax(m->near_m, nearest_m);
    rain->null = making_null(m);
    rain->key = making_key(m);
    rain->slice_m = fmax(0.25 * light_mps / m->preset->wave.bandwidth_hz, (m->far_m - rain->from_m) / slices_most);
    rain->slices = (int)ceil((m->far_m - rain->from_m) / rain->slice_m - 1e-9);
    m->frame->rain_1_m = rain->scatter.back_1_m;
    return making_points(m, (rain->slices + slices_a_task - 1) / slices_a_task, hits_capacity, make_rain, rain);
}

Status making_volume(Making *m)
{
    Status status = STATUS_OK;
    if (m->radar->foliage && m->radar->ground) status = making_canopy(m);
    if (status == STATUS_OK && m->chaff_count > 0) status = making_chaff(m);
    return status;
}
