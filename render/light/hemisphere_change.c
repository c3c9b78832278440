/* render/light/hemisphere_change.c: change of the light at a point by what is near, see hemisphere.h. */
#include "render/light/hemisphere_private.h"

#include "render/light/sky_visibility.h"
#include "render/trace/parts/parts.h"

/* Whether a ray may meet the box of a listed entity within reach. */
static bool may_meet(const HemisphereScene *scene, const double o_enu[3], const double d_enu[3], double reach_m,
                     const int *list, int listed)
{
    for (int k = 0; k < listed; k++) {
        const PosedEntity *e = visibility_posed(scene->visibility, list[k]);
        double             offset[3], o[3], d[3], near_m = 0, far_m = reach_m;
        if (e->model < 0) continue;
        v3_sub(offset, e->centre_enu, o_enu);
        const double along = v3_dot(offset, d_enu), square = v3_dot(offset, offset) - along * along;
        if (square > e->radius_m * e->radius_m || along < -e->radius_m || along > reach_m + e->radius_m) continue;
        v3_sub(offset, o_enu, e->p_enu);
        m3_tmul_v3(o, e->r_enu_from_body, offset);
        m3_tmul_v3(d, e->r_enu_from_body, d_enu);
        for (int c = 0; c < 3; c++) {
            const double per = 1 / d[c], a = (e->box_low[c] - o[c]) * per, b = (e->box_high[c] - o[c]) * per;
            const double in_m = a < b ? a : b, out_m = a < b ? b : a;
            /* a ray along a face gives NaN there, which leaves the interval as it is; fmax would be a call */
            near_m = in_m > near_m ? in_m : near_m;
            far_m = out_m < far_m ? out_m : far_m;
        }
        if (near_m <= far_m + 1e-6) return true;
    }
    return false;
}

static bool ray_may_meet(const HemisphereScene *scene, const Rays *rays, int i, double reach_m, const int *list,
                         int listed)
{
    const double o_enu[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
    const double d_enu[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
    return may_meet(scene, o_enu, d_enu, reach_m, list, listed);
}

/* The bright ring about the sun is sampled apart from the rest of the sky: it is a few per cent of the sky's light
 * within 1 % of the directions, and would cause most of the noise. ring_w_m2 is the excess of the sky there over its
 * radiance at the ring's edge, on a plane facing the sun. A hit has separate directions towards the ring; surfaces
 * met by later bounces receive it where the sun shines on them. */
enum { ring_node = 6, ring_directions = 4, ring_sample = -1 };
static const double ring_rad = 3.14159265358979323846 * ring_node * ring_node / (air_sky_angles * air_sky_angles);

typedef struct Open {
    bool   ring;             /* the sun is up */
    bool   ring_shines;      /* and in some of the bands there is a ring about it */
    double across_enu[2][3]; /* with the sun's direction, a right-angled triad */
    double ring_w_m2[AIR_BAND_COUNT];
    double ground[AIR_BAND_COUNT]; /* radiance of level, open ground */
} Open;

static double ring_radiance(const AirSky *sky, const SkyPlace *at, const SkyPlace *edge)
{
    return daylight_sky_there(sky, at) - daylight_sky_there(sky, edge);
}

/* Moves a direction within the ring about the sun to the edge of that ring. */
static SkyPlace ring_edge(const SkyPlace *at)
{
    SkyPlace edge = *at;
    if (edge.angle < ring_node) edge.angle = ring_node, edge.angle_share = 0;
    return edge;
}

static void ring_direction(double d_enu[3], const Open *open, const double sun_d_enu[3], double off_rad,
                           double turn_rad)
{
    const double c = cos(off_rad), x = sin(off_rad) * cos(turn_rad), y = sin(off_rad) * sin(turn_rad);
    for (int k = 0; k < 3; k++) d_enu[k] = c * sun_d_enu[k] + x * open->across_enu[0][k] + y * open->across_enu[1][k];
}

static void open_light(Open *out, const HemisphereScene *scene, unsigned bands)
{
    enum { offs = 16, turns = 3 };
    const Air    *air = scene->air;
    const double *sun = air->light.sun_d_enu;
    *out = (Open){.ring = sun[2] > 0};
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) out->ground[b] = hemisphere_ground_radiance(scene, (AirBand)b);
    if (!out->ring) return;
    hemisphere_axes_across(out->across_enu[0], out->across_enu[1], sun);
    for (int i = 0; i < offs * turns; i++) {
        const double off_rad = ring_rad * (i / turns + 0.5) / offs;
        double       d_enu[3];
        ring_direction(d_enu, out, sun, off_rad, 2 * pi_rad * (i % turns) / turns);
        if (d_enu[2] < 0) continue;
        SkyPlace at;
        daylight_sky_place(&at, &air->light, d_enu);
        const SkyPlace edge = ring_edge(&at);
        const double   sr = 2 * pi_rad * ring_rad * sin(off_rad) / (offs * turns);
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            if (bands >> b & 1) out->ring_w_m2[b] += ring_radiance(&air->light.sky[b], &at, &edge) * cos(off_rad) * sr;
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++) out->ring_shines |= out->ring_w_m2[b] != 0;
}

typedef struct Change {
    double w_m2[AIR_BAND_COUNT], below_w_m2[AIR_BAND_COUNT];
    int    blocked, sunlit, parts, inside;
} Change;

static void count_first(Change *to, const Paths *p, int i, const HemisphereScene *scene)
{
    const Hits *hits = &p->hits;
    to->blocked++;
    to->parts += hits->entity[i] != 0;
    to->inside += hits->inside[i];
    double along = 0;
    for (int c = 0; c < 3; c++) along += hits->n_enu[c][i] * scene->air->light.sun_d_enu[c];
    to->sunlit += p->sun[i] > 0 && along > 0;
}

/* What one call of hemisphere_change shares among its steps. */
typedef struct ChangeJob {
    const HemisphereScene *scene;
    unsigned               bands;
    int                    samples;
    double                 reach_m;
    Open                   open;
    bool                   ground_points; /* among the hits */
    const uint64_t        *key;
    const int             *list;
    int                    listed;
    SkyNotes              *notes; /* NULL: nothing is noted */
    VisibilityCounters    *counters;
} ChangeJob;

/* Whether it matters which of the places that paths meet the sun shines on: for light other than thermal, and for what
 * refines the ground's points. */
static bool asks_sun(const ChangeJob *job, int bounce)
{
    return (job->bands & ~(1u << AIR_LWIR)) != 0 || job->open.ring_shines || (bounce == 0 && job->ground_points);
}

static void meet(Paths *p, const ChangeJob *job, int bounce, const SkyMet *const *known)
{
    const HemisphereScene *scene = job->scene;
    if (known) {
        p->hits.count = p->rays.count, p->hits.several = false;
        for (int i = 0; i < p->rays.count; i++) sky_met_load(&p->hits, &p->rays, i, known[i]);
    } else {
        bool parts_alone = bounce == 0; /* from points on the ground, the ground is not traced */
        for (int i = 0; i < p->rays.count; i++) p->rays.far_m[i] = job->reach_m, parts_alone &= p->from_ground[i];
        const RayEntities among = visibility_listed(job->list, job->listed, -1);
        if (parts_alone) visibility_first_part(&p->hits, scene->visibility, &p->rays, among, job->counters);
        else visibility_first_hit(&p->hits, scene->visibility, &p->rays, among, job->counters);
    }
    hemisphere_light_met(p, scene, job->bands, asks_sun(job, bounce), job->counters);
}

/* Path i, which met something, goes on. Returns its new index; -1: it ends. */
static int go_on(Paths *p, int i, const ChangeJob *job, int bounce, const SkyMet **known)
{
    const int of = p->of_hit[i], sample = p->of_sample[i];
    if (known) {
        if (known[i][1].bounce != bounce + 1) return -1; /* it met nothing more */
        known[p->rays.count] = known[i] + 1;
        return p->rays.count++;
    }
    const uint64_t to = job->key[of];
    const uint32_t draw = (uint32_t)(2 * (sample * hemisphere_change_bounces + bounce));
    const int      at = hemisphere_leave(&p->rays, &p->hits, i, false, random_uniform(0, stream_change, draw, to),
                                         random_uniform(0, stream_change, draw + 1, to));
    if (job->notes) {
        const double o_enu[3] = {p->rays.o_enu[0][at], p->rays.o_enu[1][at], p->rays.o_enu[2][at]};
        const double d_enu[3] = {p->rays.d_enu[0][at], p->rays.d_enu[1][at], p->rays.d_enu[2][at]};
        sky_notes_ray(job->notes, of, o_enu, d_enu, job->reach_m);
    }
    /* from the ground, too, only parts change the light */
    if (p->hits.entity[i] || ray_may_meet(job->scene, &p->rays, at, job->reach_m, job->list, job->listed)) return at;
    p->rays.count = at;
    return -1;
}

/* Follows one block of paths to its end. known: what they met first, and after it what they met then; NULL: they are
 * traced. */
static void follow_change(Change *sum, Paths *p, const ChangeJob *job, const SkyMet **known)
{
    const HemisphereScene *scene = job->scene;
    const Open            *open = &job->open;
    const unsigned         bands = job->bands;
    double                 brought[AIR_BAND_COUNT][hits_capacity];
    int                    of_hit[hits_capacity];
    bool                   down[hits_capacity]; /* it left below the horizontal */
    const int              started = p->rays.count;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1) memset(brought[b], 0, (size_t)started * sizeof *brought[b]);
    for (int i = 0; i < started; i++) p->of_path[i] = i, of_hit[i] = p->of_hit[i], down[i] = false;

    for (int bounce = 0; bounce < hemisphere_change_bounces && p->rays.count > 0; bounce++) {
        meet(p, job, bounce, known);
        const int count = p->hits.count;
        p->rays.count = 0;
        for (int i = 0; i < count; i++) {
            const int of = p->of_hit[i];
            if (!(p->hits.range_m[i] < INFINITY)) continue;
            if (p->from_ground[i] && !p->hits.entity[i]) continue;
            if (p->of_sample[i] == ring_sample) {
                for (int b = 0; b < AIR_BAND_COUNT; b++)
                    if (bands >> b & 1) brought[b][p->of_path[i]] -= p->share[b][i];
                continue;
            }
            if (job->notes && !known) sky_notes_met(job->notes, of, p->of_sample[i], bounce, &p->hits, &p->rays, i);
            const double d_enu[3] = {p->rays.d_enu[0][i], p->rays.d_enu[1][i], p->rays.d_enu[2][i]};
            if (bounce == 0) count_first(&sum[of], p, i, scene), down[i] = d_enu[2] < 0;
            const double n_enu[3] = {p->hits.n_enu[0][i], p->hits.n_enu[1][i], p->hits.n_enu[2][i]};
            float        share[AIR_BAND_COUNT];
            PlanePlace   plane;
            SkyPlace     sky;
            daylight_plane_place(&plane, &scene->air->light, n_enu);
            if (d_enu[2] >= 0) {
                daylight_sky_place(&sky, &scene->air->light, d_enu);
                if (open->ring) sky = ring_edge(&sky);
            }
            const double ring = (1 - (double)p->sun[i]) * fmax(v3_dot(n_enu, scene->air->light.sun_d_enu), 0) / pi_rad;
            for (int b = 0; b < AIR_BAND_COUNT; b++) {
                if (!(bands >> b & 1)) continue;
                double       rho;
                const double ground = open->ground[b];
                const double shown = hemisphere_met(&rho, p, i, scene, (AirBand)b, ground, false) +
                                     rho * (daylight_plane_there(&scene->air->light, (AirBand)b, &plane) / pi_rad +
                                            ground * 0.5 * (1 - n_enu[2]) - ring * open->ring_w_m2[b]);
                const double behind = d_enu[2] < 0 ? ground : daylight_sky_there(&scene->air->light.sky[b], &sky);
                brought[b][p->of_path[i]] += p->share[b][i] * (shown - behind);
                share[b] = 2 * p->share[b][i] * (float)rho;
            }
            /* half of them continue with double weight; compacted: no slot is read after a later path was written to
             * it */
            if (bounce == hemisphere_change_bounces - 1 || (p->of_sample[i] >> bounce & 1)) continue;
            const bool from_ground = !p->hits.entity[i];
            const int  at = go_on(p, i, job, bounce, known);
            if (at < 0) continue;
            p->of_hit[at] = of, p->of_sample[at] = p->of_sample[i], p->of_path[at] = p->of_path[i];
            p->from_ground[at] = from_ground;
            for (int b = 0; b < AIR_BAND_COUNT; b++)
                if (bands >> b & 1) p->share[b][at] = share[b];
        }
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (bands >> b & 1)
            for (int i = 0; i < started; i++) {
                sum[of_hit[i]].w_m2[b] += brought[b][i];
                if (down[i]) sum[of_hit[i]].below_w_m2[b] += brought[b][i];
            }
}

enum { close_most = 64 };

/* The listed entities within whose reach a point lies. */
static int list_close(int close[close_most], const HemisphereScene *scene, const Hits *hits, int i,
                      const double *list_reach_m, const int *list, int listed)
{
    int count = 0;
    for (int k = 0; k < listed && count < close_most; k++) {
        const PosedEntity *e = visibility_posed(scene->visibility, list[k]);
        const double       far_m = e->radius_m + list_reach_m[k];
        double             square = 0;
        for (int c = 0; c < 3; c++) {
            const double off_m = e->centre_enu[c] - hits->p_enu[c][i];
            square += off_m * off_m;
        }
        if (square < far_m * far_m) close[count++] = list[k];
    }
    return count;
}

/* Adds ray n of those towards the ring; its shares are what is lost when it meets something; -1: it points into the
 * surface or below the horizon. */
static int leave_to_ring(Paths *p, const Hits *hits, int from, const ChangeJob *job, int n, double u, double v)
{
    const HemisphereScene *scene = job->scene;
    const double           off_rad = ring_rad * (n + u) / ring_directions;
    const double           n_enu[3] = {hits->n_enu[0][from], hits->n_enu[1][from], hits->n_enu[2][from]};
    double                 d_enu[3];
    ring_direction(d_enu, &job->open, scene->air->light.sun_d_enu, off_rad, 2 * pi_rad * (v + n * golden_ratio));
    const double along = v3_dot(d_enu, n_enu);
    if (along <= 0 || d_enu[2] < 0) return -1;
    const int at = p->rays.count++;
    for (int k = 0; k < 3; k++) {
        p->rays.o_enu[k][at] = hits->p_enu[k][from] + leave_offset_m * hits->n_geo[k][from];
        p->rays.d_enu[k][at] = d_enu[k];
    }
    SkyPlace place;
    daylight_sky_place(&place, &scene->air->light, d_enu);
    const SkyPlace edge = ring_edge(&place);
    const double   share = along * 2 * ring_rad * sin(off_rad) * job->samples / ring_directions;
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        if (job->bands >> b & 1)
            p->share[b][at] = (float)(share * ring_radiance(&scene->air->light.sky[b], &place, &edge));
    return at;
}

/* Rotates by the angle whose cosine and sine are `by`: rounding stays below 1e-13 over all directions of a point. */
static void v2_turn(double turn[2], const double by[2])
{
    const double x = turn[0] * by[0] - turn[1] * by[1];
    turn[1] = turn[0] * by[1] + turn[1] * by[0];
    turn[0] = x;
}

/* Follows the paths of points whose meetings are known, all but the rays towards the ring. */
static void follow_known(Change *sum, Paths *p, const ChangeJob *job, const SkyMet *const *of, int count)
{
    const SkyMet *known[hits_capacity];
    p->rays.count = p->rays.columns = 0;
    for (int i = 0; i < count; i++)
        for (const SkyMet *met = of[i]; met && met->bounce != sky_met_end; met++) {
            if (met->bounce != 0) continue;
            const int at = p->rays.count++;
            known[at] = met;
            p->of_hit[at] = i, p->of_sample[at] = met->sample, p->from_ground[at] = false;
            for (int b = 0; b < AIR_BAND_COUNT; b++) p->share[b][at] = 1;
            if (p->rays.count < hits_capacity) continue;
            follow_change(sum, p, job, known);
            p->rays.count = 0;
        }
    if (p->rays.count > 0) follow_change(sum, p, job, known);
}

void hemisphere_change(HemisphereChange *out, const HemisphereScene *scene, const Hits *hits,
                       const HemisphereNear *near, const uint64_t *key, SkyNotes *notes, VisibilityCounters *counters)
{
    const int     samples = near->samples;
    Paths         paths;
    Change        sum[hits_capacity];
    const SkyMet *known[hits_capacity];
    ChangeJob     job = {.scene = scene,
                         .bands = near->bands,
                         .samples = samples,
                         .reach_m = near->reach_m,
                         .key = key,
                         .list = near->list,
                         .listed = near->listed,
                         .notes = notes,
                         .counters = counters};
    const double  golden_turn[2] = {cos(2 * pi_rad * golden_ratio), sin(2 * pi_rad * golden_ratio)};
    open_light(&job.open, scene, near->bands);
    memset(sum, 0, (size_t)hits->count * sizeof *sum);
    for (int i = 0; i < hits->count; i++) known[i] = NULL, job.ground_points |= !hits->entity[i];
    if (notes) {
        sky_notes_find(known, notes, hits, key, samples);
        follow_known(sum, &paths, &job, known, hits->count);
        sky_notes_begin(notes, hits->count);
    }
    paths.rays.count = paths.rays.columns = 0;
    paths.rays.bent = false;
    for (int i = 0; i < hits->count; i++) {
        if (known[i] && !job.open.ring_shines) continue;
        const double u0 = random_uniform(0, stream_first, 0, key[i]), v0 = random_uniform(0, stream_first, 1, key[i]);
        int          close[close_most];
        const int    closes =
            hits->entity[i] ? 0 : list_close(close, scene, hits, i, near->list_reach_m, near->list, near->listed);
        double turn[2] = {cos(2 * pi_rad * v0), sin(2 * pi_rad * v0)};
        Base   base;
        hemisphere_base_at(&base, hits, i);
        for (int k = known[i] ? samples : 0; k < samples + (job.open.ring_shines ? ring_directions : 0); k++) {
            const int at = k < samples ? hemisphere_leave_base(&paths.rays, &base, (k + u0) / samples, turn)
                                       : leave_to_ring(&paths, hits, i, &job, k - samples, u0, v0);
            v2_turn(turn, golden_turn);
            if (at < 0) continue;
            if (!hits->entity[i] && !ray_may_meet(scene, &paths.rays, at, near->reach_m, close, closes)) {
                paths.rays.count = at; /* would contribute nothing */
                continue;
            }
            paths.of_hit[at] = i;
            paths.from_ground[at] = !hits->entity[i];
            paths.of_sample[at] = k < samples ? k : ring_sample;
            for (int b = 0; b < AIR_BAND_COUNT && k < samples; b++) paths.share[b][at] = 1;
            if (paths.rays.count < hits_capacity) continue;
            follow_change(sum, &paths, &job, NULL);
            paths.rays.count = 0;
        }
    }
    if (paths.rays.count > 0) follow_change(sum, &paths, &job, NULL);
    if (notes) sky_notes_keep(notes, hits, key, samples, near->reach_m, known);
    for (int i = 0; i < hits->count; i++) {
        const Change *s = &sum[i];
        out[i] = (HemisphereChange){.blocked = (float)s->blocked / (float)samples,
                                    .sunlit = (float)s->sunlit / (float)samples,
                                    .inside = s->parts ? (float)s->inside / (float)s->parts : 0};
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            out[i].w_m2[b] = (float)(s->w_m2[b] * pi_rad / samples);
            out[i].below_w_m2[b] = (float)(s->below_w_m2[b] * pi_rad / samples);
        }
    }
}
