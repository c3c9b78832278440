/* render/light/far_woods_stand.c: a stand of forest, traced once: what of it is seen, and what of that the sun reaches
 * (far_woods.h). */
#include "render/light/far_woods.h"

#include <stdlib.h>

enum { squares = 8, ray_block = 64, most_suns = stand_suns * stand_azimuths };
static const double stand_seed = 1995;
static const double stand_corner_m = -squares / 2 * woods_square_m; /* of woods_of_class */
static const double view_deg[stand_views] = {4, 10, 20, 36, 60, 90}, sun_deg[stand_suns] = {4, 10, 20, 36, 60, 90};
static const double azimuth_deg[stand_azimuths] = {0, 25, 65, 115, 180};

/* Nodes: elevation of eye or sun over the ground, and azimuth of the sun from that of the eye, rad. */
static double stand_view(int node) { return view_deg[node] * rad_per_deg; }
static double stand_sun(int node) { return sun_deg[node] * rad_per_deg; }
double        far_stand_azimuth(int node) { return azimuth_deg[node] * rad_per_deg; }

static int place_among(double *share, const double *node_deg, int nodes, double rad)
{
    const double at_deg = clamp(rad / rad_per_deg, node_deg[0], node_deg[nodes - 1]);
    int          low = 0;
    while (low < nodes - 2 && at_deg >= node_deg[low + 1]) low++;
    *share = (at_deg - node_deg[low]) / (node_deg[low + 1] - node_deg[low]);
    return low;
}

int far_stand_at_view(double *share, double elevation_rad)
{
    return place_among(share, view_deg, stand_views, elevation_rad);
}
int far_stand_at_sun(double *share, double elevation_rad)
{
    return place_among(share, sun_deg, stand_suns, elevation_rad);
}
int far_stand_at_azimuth(double *share, double azimuth_rad)
{
    return place_among(share, azimuth_deg, stand_azimuths, azimuth_rad);
}

/* ---- rays ------------------------------------------------------------------------------------- */

typedef struct Seen {
    double organ[PLANT_KINDS][2]; /* hits of each kind's leaves and bark, weighted by albedo */
    double height_m;              /* sum over hits of plants */
} Seen;

typedef struct Job {
    WoodStand         *stand;
    const Materials   *materials;
    const ForestFrame *frame;
    Seen               seen[stand_views];
} Job;

static void towards(double d[3], double elevation_rad, double azimuth_rad)
{
    d[0] = cos(elevation_rad) * cos(azimuth_rad), d[1] = cos(elevation_rad) * sin(azimuth_rad),
    d[2] = sin(elevation_rad);
}

static double dice(int view, int ray, int what)
{
    return random_uniform((uint64_t)stand_seed, (uint32_t)view, (uint32_t)ray, (uint64_t)what);
}

/* Anywhere within a quarter of the nearer step about a node: the hot spot is not missed between two of them. */
static double about(const double *node_deg, int nodes, int k, double u)
{
    const double below = k > 0 ? node_deg[k] - node_deg[k - 1] : INFINITY,
                 above = k < nodes - 1 ? node_deg[k + 1] - node_deg[k] : INFINITY;
    return (node_deg[k] + 0.25 * fmin(below, above) * (2 * u - 1)) * rad_per_deg;
}

/* Starts a ray at the height of the tallest plant, with as much of the stand ahead of it as behind. */
static void start_ray(double o[3], double d[3], double *azimuth_rad, int view, int ray)
{
    static const double top_m = 27, half_m = 120;
    *azimuth_rad = 2 * pi_rad * (ray + dice(view, ray, 0)) / stand_rays;
    double to_eye[3];
    towards(to_eye, stand_view(view), *azimuth_rad);
    for (int c = 0; c < 3; c++) d[c] = -to_eye[c];
    o[0] = half_m * (2 * dice(view, ray, 1) - 1), o[1] = half_m * (2 * dice(view, ray, 2) - 1), o[2] = top_m;
    const double back_m = fmin(top_m / to_eye[2], 80); /* about where it ends */
    for (int c = 0; c < 2; c++) o[c] -= d[c] * back_m;
}

typedef struct Met {
    double p[3], n[3], azimuth_rad, albedo;
    int    kind, organ; /* -1: the ground */
} Met;

/* ---- sums ------------------------------------------------------------------------------------- */

static void add_place(CanopyPlace *sum, const CanopyPlace *p, double weight)
{
    sum->up += weight * p->up, sum->down += weight * p->down, sum->up_from_ground += weight * p->up_from_ground;
    sum->sun_here += weight * p->sun_here, sum->sun_on_ground += weight * p->sun_on_ground;
}

static void scale_place(CanopyPlace *sum, double by)
{
    sum->up *= by, sum->down *= by, sum->up_from_ground *= by, sum->sun_here *= by, sum->sun_on_ground *= by;
}

static void add_plant(StandView *v, const WoodStand *stand, const Met *m, const ForestSurface *s)
{
    StandOrgan *o = m->organ == PLANT_LEAF ? &v->leaf : &v->bark;
    CanopyPlace place;
    canopy_place(&place, stand->canopy, m->p[0], m->p[1], fmax(m->p[2], 0), 1);
    double up, down;
    canopy_place_past_plant(&up, &down, &place, stand->canopy, (double)s->open_up, (double)s->open_down);
    const double faces = 0.5 * (1 + m->n[2]), sees_leaves = 2 - up - down;
    v->sees_leaves += sees_leaves;
    for (int k = 0; k < stand_suns; k++) {
        canopy_place(&place, stand->canopy, m->p[0], m->p[1], fmax(m->p[2], 0), sin(stand_sun(k)));
        canopy_place_of_plant(&place, stand->canopy);
        add_place(&v->among[k], &place, sees_leaves);
    }
    o->share += 1, o->bright += m->albedo;
    o->front_up += m->albedo * up * faces, o->front_down += m->albedo * down * (1 - faces);
    o->back_up += m->albedo * up * (1 - faces), o->back_down += m->albedo * down * faces;
    o->n[0] += m->n[0] * cos(m->azimuth_rad) + m->n[1] * sin(m->azimuth_rad), o->n[1] += m->n[2];
    o->open += (double)s->open_up, o->radius_m += log(fmax((double)s->radius_m, 1e-3));
}

static void add_ground(StandView *v, const WoodStand *stand, const Met *m)
{
    CanopyPlace place;
    CanopyStand there;
    double      open = 1;
    canopy_stand(&there, stand->canopy, m->p[0], m->p[1]);
    for (int k = 0; k < stand_suns; k++) {
        canopy_place(&place, stand->canopy, m->p[0], m->p[1], 0, sin(stand_sun(k)));
        open = place.up;
        canopy_place_of_ground(&place, stand->canopy);
        add_place(&v->on_ground[k], &place, 1);
        const double up = sin(stand_sun(k));
        v->ground_through[k] += exp(-0.5 * canopy_clumping(stand->canopy, up) * there.hides / up);
    }
    v->ground += 1, v->ground_up += open, v->ground_open += there.open;
}

static void add_lit(StandLit *lit, const Met *m, const double sun[3])
{
    const double facing = v3_dot(m->n, sun);
    if (m->organ < 0) {
        lit->ground += 1;
    } else if (m->organ == PLANT_LEAF) {
        lit->leaf += 1;
        lit->leaf_front += m->albedo * fmax(facing, 0), lit->leaf_back += m->albedo * fmax(-facing, 0);
    } else {
        lit->bark_front += m->albedo * fmax(facing, 0);
    }
}

/* The suns of one hit. */
static void ask_suns(Job *job, int view, int ray, const Met *m)
{
    double  o[3][most_suns], d[3][most_suns], far_m[most_suns];
    uint8_t dark[most_suns] = {0};
    for (int k = 0; k < most_suns; k++) {
        double sun[3];
        towards(sun, about(sun_deg, stand_suns, k / stand_azimuths, dice(view, ray, 8 + 2 * k)),
                m->azimuth_rad + (k & 1 ? 1 : -1) * about(azimuth_deg, stand_azimuths, k % stand_azimuths,
                                                          dice(view, ray, 9 + 2 * k)));
        const double off_m = v3_dot(m->n, sun) > 0 ? 1e-3 : -1e-3;
        for (int c = 0; c < 3; c++) o[c][k] = m->p[c] + off_m * m->n[c], d[c][k] = sun[c];
        far_m[k] = INFINITY;
    }
    forest_any_hits(dark, job->frame, most_suns, (const double *const[3]){o[0], o[1], o[2]},
                    (const double *const[3]){d[0], d[1], d[2]}, far_m, NULL);
    for (int k = 0; k < most_suns; k++) {
        const double sun[3] = {d[0][k], d[1][k], d[2][k]};
        if (!dark[k]) add_lit(&job->stand->lit[view][k / stand_azimuths][k % stand_azimuths], m, sun);
    }
}

static void take_hit(Job *job, int view, int ray, const ForestHit *hit, bool met, const double o[3], const double d[3],
                     double range_m, double azimuth_rad)
{
    StandView    *v = &job->stand->view[view];
    ForestSurface s;
    Met           m = {.n = {0, 0, 1}, .azimuth_rad = azimuth_rad, .albedo = 1, .organ = -1};
    for (int c = 0; c < 3; c++) m.p[c] = o[c] + range_m * d[c];
    if (met) {
        forest_surface(&s, job->frame, hit, o, d, range_m, 1);
        memcpy(m.n, s.n_enu, sizeof m.n);
        m.albedo = (double)s.albedo, m.kind = hit->kind, m.organ = hit->organ;
        job->seen[view].organ[m.kind][m.organ == PLANT_LEAF] += m.albedo;
        job->seen[view].height_m += m.p[2];
        add_plant(v, job->stand, &m, &s);
    } else {
        m.p[2] = 1e-3;
        add_ground(v, job->stand, &m);
    }
    ask_suns(job, view, ray, &m);
}

static void by_rays(StandView *v, StandLit lit[stand_suns][stand_azimuths])
{
    const double per = 1.0 / stand_rays;
    for (int k = 0; k < stand_suns; k++) {
        if (v->sees_leaves > 0) scale_place(&v->among[k], 1 / v->sees_leaves);
        if (v->ground > 0) scale_place(&v->on_ground[k], 1 / v->ground), v->ground_through[k] /= v->ground;
        for (int a = 0; a < stand_azimuths; a++) {
            StandLit *l = &lit[k][a];
            l->leaf *= per, l->leaf_front *= per, l->leaf_back *= per, l->bark_front *= per, l->ground *= per;
        }
    }
    StandOrgan *const organ[2] = {&v->leaf, &v->bark};
    for (int k = 0; k < 2; k++) {
        StandOrgan *o = organ[k];
        if (o->share > 0)
            o->n[0] /= o->share, o->n[1] /= o->share, o->open /= o->share, o->radius_m = exp(o->radius_m / o->share);
        o->share *= per, o->bright *= per, o->front_up *= per, o->front_down *= per, o->back_up *= per,
            o->back_down *= per;
    }
    if (v->ground > 0) v->ground_up /= v->ground, v->ground_open /= v->ground;
    v->ground *= per;
}

static void trace_view(void *user, int worker, int view)
{
    Job      *job = user;
    double    o[3][ray_block], d[3][ray_block], range_m[ray_block], azimuth_rad[ray_block];
    ForestHit hit[ray_block];
    (void)worker;
    for (int first = 0; first < stand_rays; first += ray_block) {
        double ground_m[ray_block];
        for (int k = 0; k < ray_block; k++) {
            double from[3], along[3];
            start_ray(from, along, &azimuth_rad[k], view, first + k);
            for (int c = 0; c < 3; c++) o[c][k] = from[c], d[c][k] = along[c];
            ground_m[k] = range_m[k] = -from[2] / along[2];
        }
        forest_first_hits(range_m, hit, job->frame, ray_block, (const double *const[3]){o[0], o[1], o[2]},
                          (const double *const[3]){d[0], d[1], d[2]}, NULL);
        for (int k = 0; k < ray_block; k++)
            take_hit(job, view, first + k, &hit[k], range_m[k] < ground_m[k],
                     (const double[3]){o[0][k], o[1][k], o[2][k]}, (const double[3]){d[0][k], d[1][k], d[2][k]},
                     range_m[k], azimuth_rad[k]);
    }
    by_rays(&job->stand->view[view], job->stand->lit[view]);
}

/* ---- materials -------------------------------------------------------------------------------- */

static void add_material(Material *sum, const Material *m, double share)
{
    for (int c = 0; c < optical_channel_count; c++) {
        sum->rho[c] += (float)(share * (double)m->rho[c]);
        sum->tau[c] += (float)(share * (double)m->tau[c]);
    }
    sum->rho_mwir += (float)(share * (double)m->rho_mwir), sum->rho_lwir += (float)(share * (double)m->rho_lwir);
    sum->tau_mwir += (float)(share * (double)m->tau_mwir), sum->tau_lwir += (float)(share * (double)m->tau_lwir);
    sum->solar_absorptance += (float)(share * (double)m->solar_absorptance);
    sum->radar_gamma += (float)(share * (double)m->radar_gamma);
}

/* Means over all views. */
static void mix_materials(Job *job)
{
    double seen[PLANT_KINDS][2] = {{0}}, all[2] = {0}, height_m = 0, plants = 0, most = 0;
    for (int v = 0; v < stand_views; v++) {
        height_m += job->seen[v].height_m;
        plants += stand_rays * (job->stand->view[v].leaf.share + job->stand->view[v].bark.share);
        for (int k = 0; k < PLANT_KINDS; k++)
            for (int o = 0; o < 2; o++) seen[k][o] += job->seen[v].organ[k][o], all[o] += job->seen[v].organ[k][o];
    }
    for (int k = 0; k < PLANT_KINDS; k++)
        for (int o = 0; o < 2; o++) {
            const int row = job->materials->plant[k][o ? PLANT_LEAF : PLANT_BARK];
            if (!(seen[k][o] > 0)) continue;
            add_material(o ? &job->stand->leaf : &job->stand->bark, &job->materials->material[row],
                         seen[k][o] / all[o]);
            if (o == 0 && seen[k][0] > most) most = seen[k][0], job->stand->bark_row = row;
        }
    job->stand->top_m = plants > 0 ? height_m / plants : 0;
}

/* ---- all of it -------------------------------------------------------------------------------- */

static Status trace_stand(WoodStand *stand, const Forest *forest, const Materials *materials, Pool *pool)
{
    static const double eye_enu[3] = {0, 0, 1e6}, calm_mps[2] = {0, 0};
    ForestFrame         frame; /* seen from so far that every plant is at its lesser detail; without wind */
    Job                *job = calloc(1, sizeof *job);
    if (!job) return STATUS_NO_MEMORY;
    Status status = forest_frame_open(&frame, forest, eye_enu, 1, 0, 0, calm_mps, NULL, NULL);
    frame.ray_px = 0; /* by the plants themselves */
    job->stand = stand, job->materials = materials, job->frame = &frame;
    if (status == STATUS_OK) {
        if (pool) pool_run(pool, stand_views, trace_view, job);
        else
            for (int v = 0; v < stand_views; v++) trace_view(job, 0, v);
        mix_materials(job);
        forest_frame_close(&frame);
    }
    free(job);
    return status;
}

Status far_stand_create(WoodStand **out, SurfaceClass surface, double density, const Forest *forest,
                        const Materials *materials, bool leaves, Pool *pool)
{
    Woods      woods = {0};
    Forest    *own = NULL;
    WoodStand *stand = calloc(1, sizeof *stand);
    if (!stand) return STATUS_NO_MEMORY;
    Status status = woods_of_class(&woods, surface, density, (uint64_t)stand_seed, squares);
    if (status == STATUS_OK) status = canopy_create(&stand->canopy, &woods, forest_plants(forest), materials, leaves);
    if (status == STATUS_OK) status = forest_create_beside(&own, forest, &woods);
    if (status == STATUS_OK) status = trace_stand(stand, own, materials, pool);
    forest_destroy(own);
    woods_destroy(&woods);
    if (status == STATUS_OK) *out = stand;
    else far_stand_destroy(stand);
    return status;
}

Status far_stand_create_bare(WoodStand **out)
{
    WoodStand  *stand = calloc(1, sizeof *stand);
    const Woods woods = {.nx = squares, .ny = squares, .origin_enu = {stand_corner_m, stand_corner_m, 0}};
    if (!stand) return STATUS_NO_MEMORY;
    const Status status = canopy_create_bare(&stand->canopy, &woods);
    if (status == STATUS_OK) *out = stand;
    else far_stand_destroy(stand);
    return status;
}

/* A mean's row has no name. */
static void pass_material(Kept *kept, Material *m)
{
    kept_floats(kept, m->rho, (sizeof *m - offsetof(Material, rho)) / sizeof(float));
}

void far_stand_kept_values(Kept *kept, void *user)
{
    const StandKept *of = user;
    WoodStand       *stand = of->stand;
    int32_t          row = stand->bark_row;
    _Static_assert(sizeof(StandOrgan) == 10 * sizeof(double) && sizeof(StandLit) == 5 * sizeof(double) &&
                       sizeof(StandView) % sizeof(double) == 0,
                   "doubles alone");
    canopy_kept_values(kept, stand->canopy);
    pass_material(kept, &stand->leaf);
    pass_material(kept, &stand->bark);
    kept_pass(kept, &row, sizeof row);
    kept_check(kept, row >= 0 && row < of->rows);
    stand->bark_row = row;
    kept_doubles(kept, &stand->top_m, 1);
    kept_doubles(kept, &stand->view[0].leaf.share, sizeof stand->view / (sizeof(double)));
    kept_doubles(kept, &stand->lit[0][0][0].leaf, sizeof stand->lit / (sizeof(double)));
}

void far_stand_destroy(WoodStand *stand)
{
    if (!stand) return;
    canopy_destroy(stand->canopy);
    free(stand);
}
