/* tests/bench/sensor/woods_targets.c: what of vehicles is seen between plants: 150 of them at random places of each
 * view, 1024 rays over each, in full detail and in the representation that is judged. */
#include "tests/bench/sensor/woods_private.h"

#include "sensor/settings/config.h"

#include <stdlib.h>

enum { seed = 40, rays_each = hits_capacity, batches_most = 8 };

/* How a ray is stopped by plants: by the forest alone; as in frames, where rays near an entity meet real plants. */
enum { ways = 2 };

/* ---- the crowd ------------------------------------------------------------------------------------ */

/* Places them evenly in range and azimuth over what the view sees of level ground, up to twice as far as its middle. */
static TrialPlace site_of(const WoodsBench *w, int v, int k)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}};
    const View                 view = woods_view(w, v);
    const double               half_up = 0.9 * atan(0.5 * view.height / view.focal_px);
    const double               half_across = 0.9 * atan(0.5 * view.width / view.focal_px);
    const double               down = woods_pose[v].down_deg * rad_per_deg, above_m = woods_pose[v].above_m;
    const double               from_m = above_m / tan(down + half_up), middle_m = above_m / tan(down);
    const double to_m = down - half_up > 0 ? fmin(2 * middle_m, above_m / tan(down - half_up)) : 2 * middle_m;
    const double reach_m = fmin(to_m, 0.48 * w->north_m - view.p_enu[1]);
    double       u[3];
    for (int c = 0; c < 3; c++) u[c] = random_uniform(seed, (uint32_t)v, 0, (uint64_t)(3 * k + c));
    const double range_m = from_m + u[0] * (reach_m - from_m), azimuth = (2 * u[1] - 1) * half_across;
    const double side_m = 0.48 * w->east_m;
    return (TrialPlace){.type = types[k % 2],
                        .number = k + 1,
                        .appearance = 1u << 22,
                        .east_m = fmax(-side_m, fmin(side_m, view.p_enu[0] + range_m * sin(azimuth))),
                        .north_m = view.p_enu[1] + range_m * cos(azimuth),
                        .turn_rad = 2 * pi_rad * u[2]};
}

static Status open_crowd(WoodsCrowd *crowd, WoodsBench *w, int v)
{
    EntityTableConfig config = entity_table_default_config();
    config.ground = (ContactGround){.frame = &w->landscape.frame, .elevation = &w->landscape.elevation};
    *crowd = (WoodsCrowd){w, v, w->scene};
    crowd->scene.table = NULL, crowd->scene.vehicles = NULL;
    Status status = entity_table_create(&crowd->scene.table, &config, w->scene.catalog);
    for (int k = 0; k < woods_sites_used(w) && status == STATUS_OK; k++) {
        const TrialPlace place = site_of(w, v, k);
        status = trial_scene_place(&crowd->scene, &place);
    }
    return status;
}

static void close_crowd(WoodsCrowd *crowd)
{
    world_vehicles_destroy(crowd->scene.vehicles);
    entity_table_destroy(crowd->scene.table);
}

/* ---- rays over vehicles --------------------------------------------------------------------------- */

typedef struct Sight {
    const WoodsCrowd *crowd;
    View              view;
    Snapshot          snapshot;
    ForestFrame       forest[woods_details];
    Visibility       *visibility[woods_details];
    double seen[woods_sites][ways][woods_details]; /* share of the rays that meet the vehicle; NaN: none does */
} Sight;

typedef struct SightScratch {
    Rays       over, met;
    Hits       hits;
    EntityHits alone;
    ForestHit  plant[hits_capacity];
    double     range_m[hits_capacity]; /* of met, at which they meet the vehicle */
} SightScratch;

static void rays_over(Rays *rays, const Sight *s, int site, int batch, const double box_px[4])
{
    rays->count = rays_each, rays->columns = 0, rays->bent = false;
    for (int i = 0; i < rays_each; i++) {
        const uint64_t index = 2 * ((uint64_t)batch * rays_each + (uint64_t)i);
        const uint32_t stream = 16 + (uint32_t)s->crowd->v;
        const double   u[2] = {random_uniform(seed, stream, (uint32_t)site, index),
                               random_uniform(seed, stream, (uint32_t)site, index + 1)};
        double         d[3];
        view_ray(d, &s->view, box_px[0] + u[0] * (box_px[2] - box_px[0]), box_px[1] + u[1] * (box_px[3] - box_px[1]));
        for (int c = 0; c < 3; c++) rays->o_enu[c][i] = s->view.p_enu[c], rays->d_enu[c][i] = d[c];
        rays->far_m[i] = INFINITY;
    }
}

/* The rays of a random set that meet the vehicle, were it alone in the world. */
static void find_met(SightScratch *t, const Sight *s, int site, const double box_px[4])
{
    VisibilityCounters counters = {0};
    t->met.count = 0, t->met.columns = 0, t->met.bent = false;
    for (int batch = 0; batch < batches_most && t->met.count < rays_each; batch++) {
        rays_over(&t->over, s, site, batch, box_px);
        visibility_entity_hits(&t->alone, s->visibility[0], &t->over, site, &counters);
        for (int i = 0; i < rays_each && t->met.count < rays_each; i++) {
            if (!(t->alone.range_m[i] < INFINITY)) continue;
            const int to = t->met.count++;
            for (int c = 0; c < 3; c++)
                t->met.o_enu[c][to] = t->over.o_enu[c][i], t->met.d_enu[c][to] = t->over.d_enu[c][i];
            t->met.far_m[to] = INFINITY, t->range_m[to] = t->alone.range_m[i];
        }
    }
}

static double seen_past_forest(SightScratch *t, const ForestFrame *forest)
{
    const double *const o[3] = {t->met.o_enu[0], t->met.o_enu[1], t->met.o_enu[2]};
    const double *const d[3] = {t->met.d_enu[0], t->met.d_enu[1], t->met.d_enu[2]};
    double              range_m[hits_capacity], seen = 0;
    memcpy(range_m, t->range_m, sizeof range_m);
    forest_first_hits(range_m, t->plant, forest, t->met.count, o, d, NULL);
    for (int i = 0; i < t->met.count; i++) seen += range_m[i] >= t->range_m[i];
    return seen / t->met.count;
}

static double seen_in_frame(SightScratch *t, const Visibility *v, int site)
{
    VisibilityCounters counters = {0};
    double             seen = 0;
    visibility_first_hit(&t->hits, v, &t->met, visibility_all_but(-1), &counters);
    for (int i = 0; i < t->hits.count; i++)
        seen += t->hits.entity[i] == (uint32_t)site + 1 ? (double)hit_weight(&t->hits, i) : 0;
    return seen / t->met.count;
}

static void look_at_site(void *user, int worker, int site)
{
    Sight        *s = user;
    SightScratch *t = calloc(1, sizeof *t);
    double        box_px[4];
    (void)worker;
    for (int k = 0; k < ways * woods_details; k++) s->seen[site][k / woods_details][k % woods_details] = NAN;
    if (t && visibility_project_box(box_px, s->visibility[0], &s->view, site)) {
        find_met(t, s, site, box_px);
        for (int d = 0; d < woods_details && t->met.count > 0; d++) {
            s->seen[site][0][d] = seen_past_forest(t, &s->forest[d]);
            s->seen[site][1][d] = seen_in_frame(t, s->visibility[d], site);
        }
    }
    free(t);
}

/* ---- rows ----------------------------------------------------------------------------------------- */

typedef struct Difference {
    const Sight *s;
    int          way;
    bool         mean; /* else rms */
} Difference;

static double difference_of(const void *user, int without)
{
    const Difference *f = user;
    double            sum = 0, square = 0, n = 0;
    for (int k = 0; k < f->s->snapshot.count; k++) {
        const double off = f->s->seen[k][f->way][1] - f->s->seen[k][f->way][0];
        if (isnan(off) || k == without) continue;
        sum += off, square += off * off, n++;
    }
    return f->mean ? sum / n : sqrt(square / n);
}

static void say_sight(WoodsBench *w, int v, const Sight *s, int way)
{
    static const char *const name[ways] = {"visible share of vehicles, by its plants alone",
                                           "visible share of vehicles, as in frames"};
    char                     what[what_size], text[200];
    double                   seen[woods_details] = {0}, known = 0, partly = 0;
    Difference               of = {s, way, true};
    for (int k = 0; k < s->snapshot.count; k++) {
        const double *share = s->seen[k][way];
        if (isnan(share[0])) continue;
        known++, partly += share[0] > 0.02 && share[0] < 0.98;
        for (int d = 0; d < woods_details; d++) seen[d] += share[d];
    }
    const Estimate mean = group_estimate(difference_of, &of, s->snapshot.count);
    of.mean = false;
    snprintf(what, sizeof what, "%s: %s: %s", woods_pose[v].name, woods_detail[1], name[way]);
    snprintf(text, sizeof text,
             "rms difference, %g vehicles, 1024 rays each, %g seen in part; mean %.4f / %.4f: %+.2g +- %.1g", known,
             partly, seen[1] / known, seen[0] / known, mean.value, mean.se);
    woods_judge(w, what, group_estimate(difference_of, &of, s->snapshot.count),
                (WoodsLimit){way ? 0.02 : NAN, "", false}, text);
}

/* Straight rays in still air: the difference does not need refraction. */
static Status open_sight(Sight *s, const WoodsCrowd *crowd, Arena *arena)
{
    static const double calm_mps[2] = {0, 0};
    WoodsBench         *w = crowd->w;
    const World        *world = &w->scene.world;
    const Config        config = config_default();
    s->crowd = crowd;
    s->view = woods_view(w, crowd->v);
    Status status = entity_table_snapshot(&s->snapshot, crowd->scene.table, crowd->scene.sun_now_s + 0.5, arena);
    for (int d = 0; d < woods_details && status == STATUS_OK; d++) {
        status =
            visibility_create(&s->visibility[d], world->tracer, &w->landscape, &world->frame, &s->snapshot, 0, arena);
        if (status != STATUS_OK) return status;
        visibility_materials(s->visibility[d], &world->materials);
        status = forest_frame_open(&s->forest[d], w->forest[d], s->view.p_enu, s->view.focal_px,
                                   config.terrain.woods_low_m, 0, calm_mps, w->many, arena);
        if (status == STATUS_OK) status = visibility_plants(s->visibility[d], &s->forest[d]);
    }
    return status;
}

static Status look_at_vehicles(const WoodsCrowd *crowd)
{
    WoodsBench *w = crowd->w;
    Sight      *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    bench_progress(w->bench, "vehicles among plants");
    arena_reset(w->arena[0]);
    Status status = open_sight(s, crowd, w->arena[0]);
    if (status == STATUS_OK) {
        pool_run(w->many, s->snapshot.count, look_at_site, s);
        status = visibility_status(s->visibility[0]);
    }
    for (int way = 0; way < ways && status == STATUS_OK; way++) say_sight(w, crowd->v, s, way);
    for (int d = 0; d < woods_details; d++) forest_frame_close(&s->forest[d]);
    free(s);
    return status;
}

Status woods_targets(WoodsBench *w)
{
    WoodsRings *rings = calloc(1, sizeof *rings);
    Status      status = rings ? STATUS_OK : STATUS_NO_MEMORY;
    for (int v = bench_quick(w->bench) ? woods_views - 1 : 0; v < woods_views && status == STATUS_OK; v++) {
        if (!(w->views >> v & 1)) continue;
        WoodsCrowd crowd;
        status = open_crowd(&crowd, w, v);
        if (status == STATUS_OK) status = look_at_vehicles(&crowd);
        if (status == STATUS_OK) status = woods_alarms(&crowd, rings);
        close_crowd(&crowd);
    }
    if (status == STATUS_OK) status = woods_classify(w, rings);
    free(rings);
    return status;
}
