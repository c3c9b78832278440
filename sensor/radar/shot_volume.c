/* sensor/radar/shot_volume.c: echoes of what fills a volume: rain, foliage, chaff, as points with random amplitudes.
 *
 * Each point has a complex Gaussian amplitude, so that any sum of them is one too: speckle about the mean power of the
 * volume, with the Doppler spectrum of the points' velocities. Draws are functions of seed and place (foliage), or of
 * seed, time, axis and frame number (rain and chaff, whose phases last for less than a millisecond of motion). */
#include "sensor/radar/seeker_radar_private.h"
#include "render/scattering/clutter/volume_scatter.h"

typedef struct VolumePoint {
    Sight         sight; /* from the antenna of the RadarShot */
    ScatterMatrix s;     /* m */
    bool          turns; /* s is in the horizontal's basis (scatter.h): to be turned to the antenna's */
    double        v_enu_mps[3];
} VolumePoint;

enum { rings = 4, sectors = 8, strata = rings * sectors, slices_most = 4096, stream_rain = 0x52414900 };

static const double nearest_m = 10;       /* of rain: an antenna's near field */
static const double turbulence_mps = 1.0; /* rms, each way: Nathanson, Radar Design Principles, 2nd ed. 1991, 6.7 */

/* ---- points ------------------------------------------------------------------------------------- */

/* A key of this interval and no other, for the `frame` of random_uniform. */
static uint32_t interval_key(const RadarShot *shot)
{
    const uint32_t key[2] = {(uint32_t)shot->radar->seed, (uint32_t)(shot->radar->seed >> 32)};
    uint64_t       bits[2];
    uint32_t       mixed[4] = {shot->scene->number};
    memcpy(&bits[0], &shot->scene->t_s, 8);
    memcpy(&bits[1], &shot->ahead[0], 8);
    for (int k = 0; k < 2; k++) {
        const uint32_t counter[4] = {mixed[0], (uint32_t)bits[k], (uint32_t)(bits[k] >> 32), stream_rain};
        random_u32x4(mixed, counter, key);
    }
    return mixed[0];
}

/* Gives the velocity of the wind: the direction that it blows towards. */
static void wind_of(double v_enu_mps[3], const RadarShot *shot)
{
    const Weather *w = shot->scene->weather;
    v_enu_mps[0] = -w->wind_mps * sin(w->wind_from_rad);
    v_enu_mps[1] = -w->wind_mps * cos(w->wind_from_rad);
    v_enu_mps[2] = 0;
}

static void place_point(RadarPoint *q, const RadarShot *shot, const VolumePoint *point, double widest)
{
    v3_add_scaled(q->p_enu, shot->p_enu, point->sight.range_m, point->sight.d_enu);
    memcpy(q->v_enu_mps, point->v_enu_mps, sizeof q->v_enu_mps);
    q->path_m = 2 * (point->sight.range_m - shot->reference_m);
    const double off_mps = shot_range_rate(shot, &point->sight, q->v_enu_mps) - shot->reference_rate_mps;
    q->path_per_pulse_m = 2 * off_mps / shot->preset->wave.repeat_hz;
    q->same = shot->preset->transmits_h ? point->s.hh : point->s.vv;
    q->other = shot->preset->transmits_h ? point->s.vh : point->s.hv;
    q->share = 1;
    q->widest = widest;
    q->room_m = 0;
    q->own = shot->after_s != 0;
    q->source = 0;
}

/* Those that neither relief nor entities hide, for the positions of the beam less than `widest` off (RadarPoint);
 * returns how many. count: up to hits_capacity. */
static int keep_seen(RadarPoint *out, VolumePoint *point, int count, const RadarShot *shot, double slack_m,
                     double widest)
{
    static _Thread_local Sight  sight[hits_capacity];
    static _Thread_local bool   hidden[hits_capacity];
    static _Thread_local double slacks_m[hits_capacity];
    for (int i = 0; i < count; i++) {
        sight[i] = point[i].sight;
        slacks_m[i] = slack_m;
    }
    shot_hidden(hidden, shot, shot->scene->view->p_enu, sight, slacks_m, count, -1);
    int kept = 0;
    for (int i = 0; i < count; i++) {
        if (hidden[i]) continue;
        double to_antenna[3], h[3], v[3];
        v3_scale(to_antenna, -1, point[i].sight.d_enu);
        scatter_basis(h, v, to_antenna);
        if (point[i].turns) scatter_turn(&point[i].s, h, v, shot->right);
        place_point(&out[kept++], shot, &point[i], widest);
    }
    return kept;
}

/* make(out, ...) fills at most `each` points for each task, in any thread, and returns how many; they are added to the
 * radar's in order of tasks. */
typedef int (*VolumeMake)(RadarPoint *out, const RadarShot *shot, void *user, int task);

typedef struct VolumeJob {
    const RadarShot *shot;
    VolumeMake       make;
    void            *user;
    int              each;
    RadarPoint      *point; /* [tasks * each] */
    int             *kept;  /* [tasks] */
} VolumeJob;

static void volume_task(void *user, int worker, int task)
{
    const VolumeJob *job = user;
    (void)worker;
    job->kept[task] = job->make(job->point + (size_t)task * (size_t)job->each, job->shot, job->user, task);
}

static Status add_points(RadarShot *shot, int tasks, int each, VolumeMake make, void *user)
{
    VolumeJob job = {.shot = shot,
                     .each = each,
                     .make = make,
                     .user = user,
                     .point = radar_points_room(&shot->radar->points, tasks * each + 1),
                     .kept = arena_alloc(shot->arena, (size_t)tasks + 1, sizeof *job.kept)};
    if (!job.point || !job.kept) return STATUS_NO_MEMORY;
    if (shot->pool) pool_run(shot->pool, tasks, volume_task, &job);
    else
        for (int t = 0; t < tasks; t++) volume_task(&job, 0, t);
    RadarPoints *points = &shot->radar->points;
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

/* Places one scatterer in each stratum of a slice of range. Strata are equal steps of the square of the sine off the
 * axis by equal sectors, so that the power of a slice hardly depends on where the scatterers fall. */
static bool place_drop(VolumePoint *out, const RadarShot *shot, const Rain *rain, int slice, int stratum)
{
    const uint64_t at = (uint64_t)slice * strata + (uint64_t)stratum;
    double         u[4], n[7], d[3];
    for (uint64_t k = 0; k < 4; k++) u[k] = random_uniform(shot->radar->seed, stream_rain + 1, rain->key, 4 * at + k);
    random_normals(n, 7, shot->radar->seed, stream_rain + 2, rain->key, 7 * at);
    const double range_m = rain->from_m + (slice + u[0]) * rain->slice_m;
    const double square = rain->null * rain->null * (stratum / sectors + u[1]) / rings;
    const double sine = sqrt(square), along = sqrt(1 - square),
                 turn = 2 * pi_rad * (stratum % sectors + u[2]) / sectors;
    for (int k = 0; k < 3; k++)
        d[k] = along * shot->ahead[k] + sine * (cos(turn) * shot->right[k] + sin(turn) * shot->down[k]);
    const double p[3] = {shot->p_enu[0] + range_m * d[0], shot->p_enu[1] + range_m * d[1],
                         shot->p_enu[2] + range_m * d[2]};
    shot_sight(&out->sight, shot, p, 0);
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

static int make_rain(RadarPoint *out, const RadarShot *shot, void *user, int task)
{
    static _Thread_local VolumePoint point[hits_capacity];
    const Rain                      *rain = user;
    int                              count = 0;
    for (int slice = task * slices_a_task; slice < (task + 1) * slices_a_task && slice < rain->slices; slice++)
        for (int s = 0; s < strata; s++) count += place_drop(&point[count], shot, rain, slice, s);
    return keep_seen(out, point, count, shot, 0, 1.001 * rain->null);
}

Status shot_rain(RadarShot *shot)
{
    const RadarAir *air = &shot->radar->air;
    Rain           *rain = arena_alloc(shot->arena, 1, sizeof *rain);
    GasState        state;
    if (!shot->scene->world->atmosphere || !(air->rain_mm_h > 0)) return STATUS_OK;
    if (!rain) return STATUS_NO_MEMORY;
    radar_air_at(&state, air, 0);
    const double f_ghz = 1e-9 * shot->preset->wave.centre_hz;
    if (!rain_scatter(&rain->scatter, f_ghz, clamp(state.temp_k, 273.15, 323.15), air->rain_mm_h)) return STATUS_OK;
    wind_of(rain->wind_mps, shot);
    rain->top_enu_m = shot->base_m + air->rain_top_m;
    rain->from_m = fmax(shot->near_m, nearest_m);
    rain->null = shot_null(shot);
    rain->key = interval_key(shot);
    rain->slice_m =
        fmax(0.25 * light_mps / shot->preset->wave.bandwidth_hz, (shot->far_m - rain->from_m) / slices_most);
    rain->slices = (int)ceil((shot->far_m - rain->from_m) / rain->slice_m - 1e-9);
    shot->frame->rain_1_m = rain->scatter.back_1_m;
    return add_points(shot, (rain->slices + slices_a_task - 1) / slices_a_task, hits_capacity, make_rain, rain);
}

/* ---- foliage: the echoes of plants, from within their crowns ------------------------------------ */

enum { leaf_points_most = 400000, least_each = 8, most_each = 256, stream_leaf = 0x43414e00 };

static const double sight_slack_m = 0.05;

typedef struct Canopy {
    const int    *crown;
    CrownLeaves **kept; /* of each crown; NULL: not kept */
    int           each;
    double        null;
    ClutterMotion motion[SURFACE_COUNT];
} Canopy;

/* Places a scatterer of a crown: even over the spheroid. */
static void place_leaf(CrownLeaf *out, const SeekerRadar *r, uint32_t index, int number)
{
    const FoliageCrown *crown = foliage_crown(r->foliage, (int)index);
    const double       *origin = foliage_origin(r->foliage);
    const double        across = (double)crown->across_m, up = (double)crown->up_m;
    double              u[3];
    for (uint64_t k = 0; k < 3; k++) u[k] = random_uniform(r->seed, stream_leaf, index, 3 * (uint64_t)number + k);
    const double radius = cbrt(u[0]), z = 2 * u[1] - 1, level = sqrt(1 - z * z), turn = 2 * pi_rad * u[2];
    out->p_enu[0] = origin[0] + (double)crown->centre_m[0] + across * radius * level * cos(turn);
    out->p_enu[1] = origin[1] + (double)crown->centre_m[1] + across * radius * level * sin(turn);
    out->p_enu[2] = origin[2] + (double)crown->centre_m[2] + up * radius * z;
}

static int make_crown(RadarPoint *out, const RadarShot *shot, void *user, int task)
{
    static _Thread_local VolumePoint point[most_each];
    const Canopy                    *canopy = user;
    const SeekerRadar               *r = shot->radar;
    const uint32_t                   index = (uint32_t)canopy->crown[task];
    CrownLeaves                     *kept = canopy->kept[task];
    const FoliageCrown              *crown = foliage_crown(r->foliage, (int)index);
    const double                    *eye = shot->scene->view->p_enu;
    const ClutterRow                *row = &r->clutter.row[crown->surface][r->band];
    const double                     across = (double)crown->across_m, up = (double)crown->up_m;
    const double      sigma_m2 = clutter_foliage_volume(row) * 4 / 3.0 * pi_rad * across * across * up / canopy->each;
    const ClutterLook look = {{eye[0], eye[1], eye[2]}, shot->preset->wave.centre_hz, shot->scene->t_s, r->wind_mps};
    int               count = 0;
    for (int i = 0; i < canopy->each; i++) {
        VolumePoint *to = &point[count];
        CrownLeaf    own, *leaf = kept ? &kept->leaf[i] : &own;
        const bool   fresh = !kept || i >= kept->drawn;
        if (fresh) place_leaf(leaf, r, index, i);
        if (fresh && kept) clutter_draw_leaf(&leaf->scatterer, row, r->seed, index, (uint32_t)i);
        shot_sight(&to->sight, shot, leaf->p_enu, 0);
        if (!to->sight.within || shot_off_axis(shot, &to->sight) > canopy->null) continue;
        if (!kept) clutter_draw_leaf(&leaf->scatterer, row, r->seed, index, (uint32_t)i);
        clutter_see_leaf(&to->s, &leaf->scatterer, &canopy->motion[crown->surface], sigma_m2, leaf->p_enu, &look);
        to->turns = true;
        memset(to->v_enu_mps, 0, sizeof to->v_enu_mps);
        count++;
    }
    if (kept && kept->drawn < canopy->each) kept->drawn = canopy->each;
    return count > 0 ? keep_seen(out, point, count, shot, sight_slack_m, canopy->null) : 0;
}

/* So many points a crown that some four are in each step of range across the widest of them, or that each step of the
 * window has some 48 of all crowns that one position of the beam lights: amplitudes are Gaussian, so that their number
 * changes no law of the speckle, and by so many a step's mean power is off by a seventh (rms). Fewer where there would
 * be too many of them; by powers of two. */
static double points_wanted(const RadarShot *shot, int lit, double widest_m)
{
    enum { a_crown_step = 4, a_step = 48 };
    const Waveform *wave = &shot->preset->wave;
    const double    cell_m = 0.5 * light_mps / wave->bandwidth_hz, lobe_rad = asin(shot_null(shot));
    const double    at_once = lit * lobe_rad / (lobe_rad + shot->sector_half_rad);
    const double    want = fmin(a_crown_step * 2 * widest_m / cell_m, a_step * (double)wave->samples / at_once);
    return fmin(want, (double)leaf_points_most / lit);
}

static Status add_canopy(RadarShot *shot)
{
    const SeekerRadar *r = shot->radar;
    Canopy             canopy = {.null = shot_null(shot)};
    double             low_m[2], high_m[2], widest_m = 0;
    shot_lit_rectangle(low_m, high_m, shot);
    const int count = foliage_in(NULL, 0, r->foliage, low_m, high_m);
    int      *crown = arena_alloc(shot->arena, (size_t)count + 1, sizeof *crown);
    if (!crown) return STATUS_NO_MEMORY;
    foliage_in(crown, count, r->foliage, low_m, high_m);
    int lit = 0;
    for (int i = 0; i < count; i++) {
        const FoliageCrown *c = foliage_crown(r->foliage, crown[i]);
        const double       *origin = foliage_origin(r->foliage), room_m = fmax((double)c->across_m, (double)c->up_m);
        double              p[3];
        Sight               sight;
        for (int k = 0; k < 3; k++) p[k] = origin[k] + (double)c->centre_m[k];
        shot_sight(&sight, shot, p, room_m);
        const double room = room_m / fmax(sight.range_m, 1);
        if (!sight.within || shot_off_axis(shot, &sight) > canopy.null + room) continue;
        widest_m = fmax(widest_m, (double)c->across_m);
        crown[lit++] = crown[i];
    }
    if (lit == 0) return STATUS_OK;
    canopy.crown = crown;
    canopy.each = least_each;
    const double want = points_wanted(shot, lit, widest_m);
    while (canopy.each < want && canopy.each < most_each) canopy.each *= 2;
    for (int s = 0; s < SURFACE_COUNT; s++)
        canopy.motion[s] = clutter_motion(&r->clutter.row[s][r->band], shot->preset->wave.centre_hz, r->wind_mps);
    shot->frame->crowns = lit;
    canopy.kept = arena_alloc(shot->arena, (size_t)lit, sizeof *canopy.kept);
    if (!canopy.kept) return STATUS_NO_MEMORY;
    if (shot->radar->leaves) leaf_cache_begin(shot->radar->leaves);
    for (int i = 0; i < lit && shot->radar->leaves; i++)
        canopy.kept[i] = leaf_cache_crown(shot->radar->leaves, (uint32_t)crown[i], canopy.each);
    return add_points(shot, lit, canopy.each, make_crown, &canopy);
}

/* ---- chaff: what its clouds take from every echo behind them, and their own --------------------- */

enum { points_a_task = 512, chaff_points_most = 16384, stream_chaff = 0x43484600 };

struct ChaffCloud {
    double   p_enu[3], v_enu_mps[3], radius_m, dipoles;
    uint32_t id;
};

static Status find_chaff(RadarShot *shot)
{
    const Snapshot    *snapshot = shot->scene->snapshot;
    const LocalFrame  *frame = &shot->scene->world->frame;
    struct ChaffCloud *cloud;
    if (snapshot->chaff_count == 0 || !(shot->radar->chaff_dipoles > 0)) return STATUS_OK;
    cloud = arena_alloc(shot->arena, (size_t)snapshot->chaff_count, sizeof *cloud);
    if (!cloud) return STATUS_NO_MEMORY;
    for (int i = 0; i < snapshot->chaff_count; i++) {
        const SnapshotChaff *from = &snapshot->chaff[i];
        enu_from_ecef(cloud[i].p_enu, frame, from->p_ecef);
        m3_tmul_v3(cloud[i].v_enu_mps, frame->r_ecef_from_enu, from->v_ecef_mps);
        cloud[i].radius_m = chaff_radius_m(from->age_s);
        cloud[i].dipoles = shot->radar->chaff_dipoles;
        cloud[i].id = (uint32_t)from->id.site << 16 ^ (uint32_t)from->id.application << 8 ^ from->id.entity;
        if (v3_length(cloud[i].v_enu_mps) > 0) continue;
        /* reported at rest: where it was dispensed, and left to the air since */
        wind_of(cloud[i].v_enu_mps, shot);
        cloud[i].v_enu_mps[2] -= chaff_fall_mps;
        v3_add_scaled(cloud[i].p_enu, cloud[i].p_enu, from->age_s, cloud[i].v_enu_mps);
    }
    shot->chaff = cloud;
    shot->chaff_count = snapshot->chaff_count;
    return STATUS_OK;
}

static double chaff_np(const RadarShot *shot, const Sight *sight)
{
    const double wavelength_m = shot->preset->antenna.wavelength_m;
    double       column = 0;
    for (int i = 0; i < shot->chaff_count; i++) {
        double centre[3];
        v3_sub(centre, shot->chaff[i].p_enu, shot->p_enu);
        column +=
            chaff_column_1_m2(shot->chaff[i].dipoles, shot->chaff[i].radius_m, centre, sight->d_enu, sight->range_m);
    }
    return column * chaff_taken * wavelength_m * wavelength_m;
}

typedef struct ChaffJob {
    const struct ChaffCloud *cloud;
    int                      points;
    uint32_t                 key;
} ChaffJob;

static int make_chaff(RadarPoint *out, const RadarShot *shot, void *user, int task)
{
    static _Thread_local VolumePoint point[points_a_task];
    const ChaffJob                  *job = user;
    const struct ChaffCloud         *cloud = job->cloud;
    const uint64_t                   seed = shot->radar->seed;
    const double                     wavelength_m = shot->preset->antenna.wavelength_m;
    const double                     sigma_m2 = chaff_same * wavelength_m * wavelength_m * cloud->dipoles / job->points;
    int                              count = 0;
    for (int i = task * points_a_task; i < (task + 1) * points_a_task && i < job->points; i++) {
        VolumePoint *to = &point[count];
        double       n[13], p[3];
        random_normals(n, 13, seed, stream_chaff, job->key ^ cloud->id, 13 * (uint64_t)i);
        v3_add_scaled(p, cloud->p_enu, cloud->radius_m, n);
        shot_sight(&to->sight, shot, p, 0);
        if (!to->sight.within || shot_off_axis(shot, &to->sight) > shot->widest) continue;
        chaff_scatter(&to->s, sigma_m2, n + 3);
        to->turns = false;
        v3_add_scaled(to->v_enu_mps, cloud->v_enu_mps, chaff_turbulence_mps, n + 9);
        to->v_enu_mps[2] += chaff_fall_spread_mps * n[12];
        count++;
    }
    return count > 0 ? keep_seen(out, point, count, shot, 0, shot->widest) : 0;
}

static Status add_chaff(RadarShot *shot)
{
    const double cell_m = 0.5 * light_mps / shot->preset->wave.bandwidth_hz;
    Status       status = STATUS_OK;
    for (int i = 0; i < shot->chaff_count && status == STATUS_OK; i++) {
        const struct ChaffCloud *cloud = &shot->chaff[i];
        Sight                    sight;
        shot_sight(&sight, shot, cloud->p_enu, 5 * cloud->radius_m);
        const double room = 5 * cloud->radius_m / fmax(sight.range_m, 1);
        if (!sight.within || shot_off_axis(shot, &sight) > shot->widest + room) continue;
        /* some 32 points in a step of range, the cloud being six radii long */
        ChaffJob job = {cloud, (int)clamp(ceil(32 * 6 * cloud->radius_m / cell_m), 512, chaff_points_most),
                        interval_key(shot)};
        status = add_points(shot, (job.points + points_a_task - 1) / points_a_task, points_a_task, make_chaff, &job);
        shot->frame->clouds++;
    }
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------------- */

Status shot_volume_open(RadarShot *shot)
{
    const World *world = shot->scene->world;
    SeekerRadar *r = shot->radar;
    const Woods *woods = world->forest ? forest_woods(world->forest) : NULL;
    if (r->foliage && (!woods || foliage_woods(r->foliage) != woods)) {
        leaf_cache_destroy(r->leaves);
        foliage_destroy(r->foliage);
        r->leaves = NULL;
        r->foliage = NULL;
    }
    if (woods && !r->foliage && r->in_band) {
        const Status status = foliage_create(&r->foliage, woods, forest_plants(world->forest), &r->clutter, r->band);
        if (status != STATUS_OK) return status;
        if (r->ground && leaf_cache_create(&r->leaves) != STATUS_OK) return STATUS_NO_MEMORY;
    }
    shot_volume_fan(shot);
    return find_chaff(shot);
}

void shot_volume_fan(RadarShot *beam)
{
    static const double room_m = 50; /* beyond the window: of entities that reach out of it */
    const SeekerRadar  *r = beam->radar;
    const double        sine = fmin(1.05 * beam->widest + 0.01, 0.7);
    FoliageFanOf        of = {.half = sine / sqrt(1 - sine * sine), .far_m = beam->far_m + beam->sweep_m + room_m};
    beam->fan = NULL;
    if (!r->foliage || !r->ground) return; /* without ground there are few echoes */
    for (int k = 0; k < 3; k++) {
        of.o_enu[k] = beam->p_enu[k];
        of.axis[0][k] = beam->right[k], of.axis[1][k] = beam->down[k], of.axis[2][k] = beam->ahead[k];
    }
    foliage_fan_create(&beam->fan, r->foliage, &of, beam->arena);
}

double shot_volume_np(const RadarShot *shot, const Sight *sight)
{
    double np = 0;
    if (shot->radar->foliage)
        np = (foliage_fan_is_from(shot->fan, shot->p_enu)
                  ? foliage_fan_loss_db(shot->fan, sight->d_enu, sight->range_m)
                  : foliage_loss_db(NULL, shot->radar->foliage, shot->p_enu, sight->d_enu, sight->range_m)) *
             log(10) / 10;
    return shot->chaff_count > 0 ? np + chaff_np(shot, sight) : np;
}

Status shot_volume(RadarShot *shot)
{
    Status status = STATUS_OK;
    if (shot->radar->foliage && shot->radar->ground) status = add_canopy(shot);
    if (status == STATUS_OK && shot->chaff_count > 0) status = add_chaff(shot);
    return status;
}
