/* render/trace/scenery/scenery_trace.c: scenery among what rays can meet: first hits and shadows. */
#include "render/trace/scenery/scenery_planes_private.h"
#include "render/trace/scenery/scenery_tracer_private.h"
#include "render/trace/visibility/trace_entry.h"

/* Not fmin and fmax, which compile to calls. */
static inline double larger(double a, double b) { return a > b ? a : b; }

enum {
    most_listed = 192, /* objects that a block may meet; more are found by the tree, ray by ray */
    run_rays = 64,
};

typedef struct SceneryFound {
    uint32_t object[hits_capacity]; /* index + 1; 0: none */
    PartHit  hit[hits_capacity];
} SceneryFound;

static const PosedEntity *crowd_posed(const void *f, int object) { return frame_posed(f, object); }
static double             crowd_lift_m(const void *f, int object) { return frame_lift_m(f, object); }

static bool raises(const SceneryFrame *f, bool bent) { return bent && f->lift.bend_per_m > 0; }

static Crowd crowd_of(const SceneryFrame *f, const BroadPhase *tree, bool bent)
{
    return (Crowd){.tree = tree,
                   .lift = raises(f, bent) ? &f->lift : NULL,
                   .posed = crowd_posed,
                   .lift_m = raises(f, bent) ? crowd_lift_m : NULL,
                   .self = f,
                   .ask_all = !skips(f->skips_off, SKIP_PART)};
}

/* ---- objects that a block may meet -------------------------------------------------------------- */

/* An object, and a box about it as these rays meet it. */
typedef struct Listed {
    int    object;
    double near_m; /* of its sphere, along the block's axis, from the world's origin */
    double low[3], high[3];
} Listed;

typedef struct List {
    int    count;   /* -1: more than there is room for */
    double axis[3]; /* unit */
    Listed of[most_listed];
} List;

/* Objects of one tree or of two (other: NULL: one) within, nearest along the axis first. */
static void list_objects(List *out, const SceneryFrame *f, const BroadPhase *tree, const BroadPhase *other,
                         const Planes *in, const double axis[3], bool bent)
{
    const BroadLift *lift = raises(f, bent) ? &f->lift : NULL;
    const double(*plane)[4] = (const double(*)[4])in->plane;
    int object[most_listed];
    int count = broad_phase_some_in_planes(object, most_listed, tree, lift, plane, in->count);
    if (count >= 0 && other) {
        const int more = broad_phase_some_in_planes(object + count, most_listed - count, other, lift, plane, in->count);
        count = more < 0 ? -1 : count + more;
    }
    out->count = count;
    memcpy(out->axis, axis, sizeof out->axis);
    for (int n = 0; n < count; n++) {
        const PosedEntity *e = frame_posed(f, object[n]);
        Listed             l = {.object = object[n], .near_m = v3_dot(e->centre_enu, axis) - e->radius_m};
        int                k = n;
        parts_posed_box(l.low, l.high, e);
        if (lift) {
            const double lift_m = frame_lift_m(f, object[n]);
            l.low[2] += lift_m, l.high[2] += lift_m, l.near_m -= lift_m;
        }
        for (; k > 0 && out->of[k - 1].near_m > l.near_m; k--) out->of[k] = out->of[k - 1];
        out->of[k] = l;
    }
}

static bool box_within(const Listed *l, const Planes *in)
{
    static const double room_m = 1e-5;
    for (int p = 0; p < in->count; p++) {
        const double *n = in->plane[p];
        const double  farthest = n[0] * (n[0] > 0 ? l->high[0] : l->low[0]) +
                                n[1] * (n[1] > 0 ? l->high[1] : l->low[1]) + n[2] * (n[2] > 0 ? l->high[2] : l->low[2]);
        if (farthest + room_m < n[3]) return false;
    }
    return true;
}

/* ---- runs: neighbouring rays of a block ----------------------------------------------------------- */

typedef struct Run {
    int                 count, ray[run_rays]; /* of the block */
    double              o[3][run_rays], d[3][run_rays], limit_m[run_rays];
    uint32_t            object[run_rays];
    PartHit             hit[run_rays];
    uint8_t             dark[run_rays];
    const double *const from[3], *const way[3];
} Run;

#define RUN(name) Run name = {.from = {name.o[0], name.o[1], name.o[2]}, .way = {name.d[0], name.d[1], name.d[2]}}

static void take_run(Run *r, const Bundle *b, const int *order, int first, const double *limit_m)
{
    r->count = b->count - first < run_rays ? b->count - first : run_rays;
    for (int k = 0; k < r->count; k++) {
        const int i = order ? order[first + k] : first + k;
        r->ray[k] = i, r->object[k] = 0, r->dark[k] = 0;
        r->limit_m[k] = limit_m ? limit_m[i] : INFINITY;
        for (int c = 0; c < 3; c++) r->o[c][k] = b->o[c][i], r->d[c][k] = b->d[c][i];
    }
}

static Bundle bundle_of(const Run *r, bool bent) { return (Bundle){r->from, r->way, r->count, 0, bent}; }

static int list_ones(int list[run_rays], const uint8_t *ask, int count)
{
    int listed = 0;
    for (int k = 0; k < count; k++) {
        list[listed] = k;
        listed += ask[k];
    }
    return listed;
}

/* ---- first hits ----------------------------------------------------------------------------------- */

/* The rays of a run against one object. Returns the pairs that were asked. */
static uint64_t meet_object(Run *r, const SceneryFrame *f, int object, bool bent, VisibilityCounters *counters)
{
    const PosedEntity *e = frame_posed(f, object);
    const double       lift_m = raises(f, bent) ? frame_lift_m(f, object) : 0;
    double             until_m[run_rays], nearer_m[run_rays], z_m[run_rays];
    uint8_t            ask[run_rays];
    int                list[run_rays];
    if (e->model < 0) return 0;
    const double centre[3] = {e->centre_enu[0], e->centre_enu[1], e->centre_enu[2] + lift_m};
    for (int k = 0; k < r->count; k++) /* at equal range the lower object has priority */
        until_m[k] = r->object[k] > (uint32_t)object + 1 ? next_up(r->limit_m[k]) : r->limit_m[k];
    if (!skips(f->skips_off, SKIP_SCENERY)) memset(ask, 1, sizeof ask);
    else rays_meet_sphere(ask, r->count, r->from, r->way, until_m, centre, e->radius_m);
    const int listed = list_ones(list, ask, r->count);
    if (listed == 0) return 0;
    for (int n = 0; n < listed; n++) nearer_m[list[n]] = INFINITY;
    const double *const from[3] = {r->from[0], r->from[1], lowered(z_m, r->from[2], lift_m, list, listed)};
    counters->skipped[SKIP_PART] +=
        (uint64_t)listed * (uint64_t)e->node_count -
        parts_first_hits(nearer_m, r->hit, e, from, r->way, until_m, list, listed, !skips(f->skips_off, SKIP_PART));
    for (int n = 0; n < listed; n++) {
        const int k = list[n];
        if (!(nearer_m[k] < INFINITY)) continue;
        r->limit_m[k] = nearer_m[k];
        r->object[k] = (uint32_t)object + 1;
    }
    return (uint64_t)listed;
}

/* The rays of a run against the block's list. */
static uint64_t meet_listed(Run *r, const SceneryFrame *f, const List *list, bool bent, VisibilityCounters *counters)
{
    const Bundle b = bundle_of(r, bent);
    Planes       planes;
    double       axis[3];
    uint64_t     asked = 0;
    if (list->count > 2 && !scenery_pyramid(&planes, axis, &b, r->limit_m)) planes.count = 0;
    const double start_m = v3_dot((const double[3]){r->o[0][0], r->o[1][0], r->o[2][0]}, list->axis);
    for (int n = 0; n < list->count; n++) {
        double far_m = 0;
        for (int k = 0; k < r->count; k++) far_m = larger(far_m, r->limit_m[k]);
        if (list->of[n].near_m - start_m > far_m + 1e-3) break;
        if (list->count <= 2 || box_within(&list->of[n], &planes))
            asked += meet_object(r, f, list->of[n].object, bent, counters);
    }
    return asked;
}

static uint64_t meet_crowd(double *limit_m, SceneryFound *of, const SceneryFrame *f, const BroadPhase *tree,
                           const Bundle *b, const int *order, VisibilityCounters *counters)
{
    CrowdCounts counts = {0};
    const Crowd crowd = crowd_of(f, tree, b->bent);
    crowd_first_hits(limit_m, of->object, of->hit, &counts, &crowd, b->o, b->d, b->count, NULL, order);
    counters->skipped[SKIP_PART] += counts.nodes - counts.asked_nodes;
    return counts.asked;
}

/* By runs: those of the list; NULL: every object. */
static uint64_t meet_by_runs(double *limit_m, SceneryFound *of, const SceneryFrame *f, const List *list,
                             const Bundle *b, const int *order, VisibilityCounters *counters)
{
    uint64_t asked = 0;
    for (int first = 0; first < b->count; first += run_rays) {
        RUN(run);
        take_run(&run, b, order, first, limit_m);
        if (list) asked += meet_listed(&run, f, list, b->bent, counters);
        for (int k = 0; k < f->of->scenery->objects && !list; k++) asked += meet_object(&run, f, k, b->bent, counters);
        for (int k = 0; k < run.count; k++) {
            if (!run.object[k]) continue;
            limit_m[run.ray[k]] = run.limit_m[k];
            of->object[run.ray[k]] = run.object[k];
            of->hit[run.ray[k]] = run.hit[k];
        }
    }
    return asked;
}

static void scenery_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    const SceneryFrame *f = self;
    SceneryFound       *of = found;
    const Bundle        b = {block->o_enu, block->d_enu, block->rays->count, block->rays->columns, block->rays->bent};
    double              limit_m[hits_capacity], axis[3];
    int                 order[hits_capacity];
    List                list = {.count = -1};
    Planes              planes;
    uint64_t            asked = 0;
    const bool          by_tree = skips(f->skips_off, SKIP_SCENERY);
    const uint64_t      pairs = (uint64_t)(f->of->drawable + f->of->moving) * (uint64_t)b.count;
    if (by_tree && scenery_pyramid(&planes, axis, &b, block->limit_m))
        list_objects(&list, f, f->of->tree, f->tree, &planes, axis, b.bent);
    if (list.count == 0) {
        for (int i = 0; i < b.count; i++) range_m[i] = INFINITY;
        block->counters->skipped[SKIP_SCENERY] += pairs;
        return;
    }
    memcpy(limit_m, block->limit_m, (size_t)b.count * sizeof *limit_m);
    memset(of->object, 0, (size_t)b.count * sizeof *of->object);
    order_rays(order, b.count, b.columns);
    if (list.count > 0 || !by_tree)
        asked += meet_by_runs(limit_m, of, f, by_tree ? &list : NULL, &b, order, block->counters);
    if (by_tree && list.count < 0) {
        asked += meet_crowd(limit_m, of, f, f->of->tree, &b, order, block->counters);
        if (f->tree) asked += meet_crowd(limit_m, of, f, f->tree, &b, order, block->counters);
    }
    for (int i = 0; i < b.count; i++) range_m[i] = of->object[i] ? limit_m[i] : INFINITY;
    block->counters->rays_scenery += asked;
    block->counters->skipped[SKIP_SCENERY] += pairs - asked;
}

/* facet: of the hit completed before, and of this one after. */
static void complete_hit(Hits *hits, int i, PosedFacet *facet, const SceneryFound *found, const TraceBlock *block,
                         const SceneryFrame *f)
{
    const int            object = (int)found->object[i] - 1;
    const PartHit       *hit = &found->hit[i];
    const PosedEntity   *posed = frame_posed(f, object);
    const SceneryTracer *t = f->of;
    const Model         *model = tracer_model(t->tracer, posed->model);
    const double         lift_m = raises(f, block->rays->bent) ? frame_lift_m(f, object) : 0;
    const double         o[3] = {block->o_enu[0][i], block->o_enu[1][i], block->o_enu[2][i] - lift_m};
    const double         d[3] = {block->d_enu[0][i], block->d_enu[1][i], block->d_enu[2][i]};
    double               n_geo[3], n_enu[3];
    if (lift_m > 0) hits->p_enu[2][i] = o[2] + hits->range_m[i] * d[2]; /* raised as a whole */
    if (facet->node != &posed->node[hit->node] || facet->triangle != hit->triangle)
        parts_facet(facet, model, posed, hit);
    parts_facet_normals(n_geo, n_enu, model, facet, o, d, hits->range_m[i]);
    visibility_store_normals(hits, i, n_geo, n_enu, d);
    const int part = model->triangle_part[hit->triangle];
    hits->kind[i] = hit_scenery;
    hits->instance[i] = found->object[i];
    hits->model[i] = (uint16_t)posed->model;
    hits->inside[i] = v3_dot(facet->geo_enu, d) > 0;
    hits->part[i] = (uint16_t)(part + 1);
    hits->facet[i] = hit->triangle;
    if (t->row)
        hits->material[i] = (uint16_t)t->row[(t->row_first[posed->model] + part) * model_damage_states + posed->damage];
}

/* What hits read is seldom near: all of it is on its way before the first is completed. */
static void fetch_hits(const int *list, int count, const SceneryFound *found, const SceneryFrame *f, bool first)
{
    uint32_t last = UINT32_MAX; /* neighbours often meet the same */
    for (int k = 0; k < count; k++) {
        const int      i = list[k];
        const uint32_t triangle = found->hit[i].triangle;
        if (triangle != last)
            parts_fetch(tracer_model(f->of->tracer, frame_posed(f, (int)found->object[i] - 1)->model), triangle, first);
        last = triangle;
    }
}

static void scenery_finish(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                           const void *self)
{
    PosedFacet facet = {.node = NULL};
    fetch_hits(list, count, found, self, true);
    fetch_hits(list, count, found, self, false);
    for (int k = 0; k < count; k++) complete_hit(hits, list[k], &facet, found, block, self);
}

/* ---- shadows -------------------------------------------------------------------------------------- */

static uint64_t shade_by_object(Run *r, const SceneryFrame *f, int object, VisibilityCounters *counters)
{
    const PosedEntity *e = frame_posed(f, object);
    uint8_t            ask[run_rays];
    int                list[run_rays];
    if (e->model < 0) return 0;
    if (!skips(f->skips_off, SKIP_SCENERY)) {
        memset(ask, 1, sizeof ask);
    } else {
        rays_meet_sphere(ask, r->count, r->from, r->way, r->limit_m, e->centre_enu, e->radius_m);
        for (int k = 0; k < r->count; k++) ask[k] &= !r->dark[k];
    }
    const int listed = list_ones(list, ask, r->count);
    if (listed == 0) return 0;
    counters->skipped[SKIP_PART] +=
        (uint64_t)listed * (uint64_t)e->node_count -
        parts_any_hits(r->dark, e, r->from, r->way, r->limit_m, list, listed, !skips(f->skips_off, SKIP_PART));
    return (uint64_t)listed;
}

/* By runs: those of the list; NULL: every object. */
static uint64_t shade_by_runs(uint8_t *dark, const SceneryFrame *f, const List *list, const Bundle *b,
                              const double way[3], VisibilityCounters *counters)
{
    uint64_t asked = 0;
    for (int first = 0; first < b->count; first += run_rays) {
        RUN(run);
        Planes planes;
        take_run(&run, b, NULL, first, NULL);
        const Bundle of = bundle_of(&run, false);
        if (list && list->count > 2) scenery_prism(&planes, &of, way);
        for (int n = 0; list && n < list->count; n++)
            if (list->count <= 2 || box_within(&list->of[n], &planes))
                asked += shade_by_object(&run, f, list->of[n].object, counters);
        for (int k = 0; k < f->of->scenery->objects && !list; k++) asked += shade_by_object(&run, f, k, counters);
        memcpy(dark + first, run.dark, (size_t)run.count);
    }
    return asked;
}

static uint64_t shade_by_crowd(uint8_t *dark, const SceneryFrame *f, const BroadPhase *tree, const Bundle *b,
                               VisibilityCounters *counters)
{
    CrowdCounts counts = {0};
    const Crowd crowd = crowd_of(f, tree, false);
    crowd_any_hits(dark, &counts, &crowd, b->count, b->o, b->d);
    counters->skipped[SKIP_PART] += counts.nodes - counts.asked_nodes;
    return counts.asked;
}

/* Rays of a list (NULL: all) against the objects of one tree; NULL: against every object, one after the other. */
static uint64_t shade_by_tree(uint8_t *dark, const SceneryFrame *f, const BroadPhase *tree, const Bundle *all,
                              const int *ray, int count, const double way[3], VisibilityCounters *counters)
{
    double              start[3][hits_capacity];
    uint8_t             met[hits_capacity];
    const double *const o[3] = {start[0], start[1], start[2]};
    const Bundle        some = {o, all->d, count, 0, false}, *b = ray ? &some : all;
    List                list;
    Planes              planes;
    uint64_t            asked;
    if (count == 0) return 0;
    for (int k = 0; k < count && ray; k++)
        for (int c = 0; c < 3; c++) start[c][k] = all->o[c][ray[k]];
    memset(met, 0, sizeof met);
    if (!tree) {
        asked = shade_by_runs(met, f, NULL, b, way, counters);
    } else {
        scenery_prism(&planes, b, way);
        list_objects(&list, f, tree, NULL, &planes, way, false);
        if (list.count == 0) return 0;
        asked =
            list.count > 0 ? shade_by_runs(met, f, &list, b, way, counters) : shade_by_crowd(met, f, tree, b, counters);
    }
    for (int k = 0; k < count; k++) dark[ray ? ray[k] : k] |= met[k];
    return asked;
}

/* Traced only for rays that nothing has stopped, against what stands only for those that do not pass above it. */
static void scenery_any(const TraceShadow *s, const void *self)
{
    const SceneryFrame *f = self;
    double              start[3][hits_capacity], way[3][hits_capacity];
    int                 ray[hits_capacity], below[hits_capacity], left = 0;
    uint8_t             dark[hits_capacity];
    const double *const o[3] = {start[0], start[1], start[2]}, *const d[3] = {way[0], way[1], way[2]};
    uint64_t asked = 0;
    for (int i = 0; i < s->count; i++) {
        if (s->dark[i] && skips(f->skips_off, SKIP_SUN_STOPPED)) continue;
        for (int c = 0; c < 3; c++) start[c][left] = s->o_enu[c][i], way[c][left] = s->way_enu[c];
        dark[left] = 0, ray[left++] = i;
    }
    s->counters->skipped[SKIP_SUN_STOPPED] += (uint64_t)(s->count - left);
    if (left == 0) return;
    const Bundle b = {o, d, left, 0, false};
    if (!skips(f->skips_off, SKIP_SCENERY)) {
        asked = shade_by_tree(dark, f, NULL, &b, NULL, left, s->way_enu, s->counters);
    } else {
        const int count = scenery_heights_below(below, f->of->heights, o, left, s->way_enu);
        asked = shade_by_tree(dark, f, f->of->tree, &b, below, count, s->way_enu, s->counters);
        if (f->tree) asked += shade_by_tree(dark, f, f->tree, &b, NULL, left, s->way_enu, s->counters);
    }
    for (int k = 0; k < left; k++) s->dark[ray[k]] |= dark[k];
    s->counters->rays_sun_scenery += asked;
    s->counters->skipped[SKIP_SCENERY] += (uint64_t)(f->of->drawable + f->of->moving) * (uint64_t)left - asked;
}

static const TraceEntry trace_scenery = {.turn = 1, /* after the ground, which shortens most rays */
                                         .found_octets = sizeof(SceneryFound),
                                         .first_hits = scenery_first,
                                         .finish = scenery_finish,
                                         .any_hits = scenery_any};

Status scenery_frame_join(Visibility *v, const SceneryFrame *frame)
{
    return frame ? visibility_add(v, &trace_scenery, frame) : STATUS_OK;
}

const SceneryFrame *scenery_frame_in(const Visibility *v) { return visibility_self(v, &trace_scenery); }
