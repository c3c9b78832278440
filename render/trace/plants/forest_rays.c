/* render/trace/plants/forest_rays.c: rays through a frame's plants: standing ones, low ones, and those of pages. */
#include "render/trace/plants/forest_rays_private.h"

/* ---- pages ------------------------------------------------------------------------------------ */

/* A ray begins anew, in floats about the page, where it enters the page's box: 50 km away a float steps by 4 mm. */
typedef struct PageRay {
    double o[3], from_m, far_m; /* in the page's axes; along the piece */
} PageRay;

static bool enter_page(PageRay *out, const ListRay *ray, const PagesInReach *pages, int k, const PlantList *list)
{
    double low[3], high[3], start[3], from_m = 0, to_m = smaller(ray->limit_m, ray->piece_end_m) - ray->piece_m;
    far_page_box(low, high, pages, k);
    for (int c = 0; c < 3; c++) start[c] = ray->o_enu[c] + ray->piece_m * ray->d_enu[c];
    start[2] -=
        ray->bend_per_m * (ray->d_enu[0] * ray->d_enu[0] + ray->d_enu[1] * ray->d_enu[1]) * ray->piece_m * ray->piece_m;
    for (int c = 0; c < 3; c++) {
        const double per = fabs(ray->piece_d[c]) < 1e-30 ? 1e30 : 1 / ray->piece_d[c];
        const double a = (low[c] - start[c]) * per, b = (high[c] - start[c]) * per;
        from_m = larger(from_m, smaller(a, b)), to_m = smaller(to_m, larger(a, b));
    }
    if (!(from_m <= to_m)) return false;
    out->from_m = from_m, out->far_m = (to_m - from_m) * past + 1;
    for (int c = 0; c < 3; c++) out->o[c] = start[c] + from_m * ray->piece_d[c] - list->origin_enu[c];
    return true;
}

void page_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const PagesInReach *pages = a->geometryUserPtr;
    ListRay            *ray = (ListRay *)a->context;
    struct RTCRayHit    inner;
    PageRay             at;
    if (!a->valid[0]) return;
    const PlantList *list = far_page_need(pages, pages->page[a->primID]);
    if (!list || !list->scene || !enter_page(&at, ray, pages, (int)a->primID, list)) return;
    const double piece_m = ray->piece_m, limit_m = ray->limit_m;
    fill_ray(&inner.ray, at.o, ray->piece_d, at.far_m);
    inner.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray->piece_m += at.from_m;
    rtcIntersect1(list->scene, &ray->base, &inner);
    ray->piece_m = piece_m;
    if (ray->limit_m < limit_m) ((struct RTCRayHit *)a->rayhit)->ray.tfar = (float)((ray->limit_m - piece_m) * past);
}

void page_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    const PagesInReach *pages = a->geometryUserPtr;
    ListRay            *ray = (ListRay *)a->context;
    struct RTCRay       inner;
    PageRay             at;
    if (!a->valid[0] || ray->met) return;
    const PlantList *list = far_page_need(pages, pages->page[a->primID]);
    if (!list || !list->scene || !enter_page(&at, ray, pages, (int)a->primID, list)) return;
    fill_ray(&inner, at.o, ray->piece_d, at.far_m);
    rtcOccluded1(list->scene, &ray->base, &inner);
    if (ray->met) ((struct RTCRay *)a->ray)->tfar = -INFINITY;
}

/* ---- rays ------------------------------------------------------------------------------------- */

static void open_rays(ListRay *ray)
{
    ray->entered = 0;
    for (int k = 0; k < frames_kept; k++) ray->kept[k].plant = NULL;
}

/* False: a ray that Embree does not accept (not finite, or from too far), which meets nothing. */
static bool open_ray(ListRay *ray, const ForestFrame *frame, const double *const o_enu[3], const double *const d_enu[3],
                     int i, double limit_m, bool real)
{
    static const double most_m = 1e15;
    rtcInitIntersectContext(&ray->base);
    ray->frame = frame, ray->real = real, ray->limit_m = limit_m, ray->met = false;
    ray->bend_per_m = ray->piece_m = 0, ray->met_in = NULL;
    for (int c = 0; c < 3; c++) ray->o_enu[c] = o_enu[c][i], ray->d_enu[c] = d_enu[c][i];
    return v3_dot(ray->d_enu, ray->d_enu) < 2 &&
           fabs(ray->o_enu[0]) + fabs(ray->o_enu[1]) + fabs(ray->o_enu[2]) < most_m;
}

/* What rays are traced through: standing plants, low ones, pages. */
enum { most_scenes = 3 };
typedef struct PlantScene {
    RTCScene         scene;
    double           origin_enu[3];
    struct RTCBounds bounds;
} PlantScene;

static void add_scene(PlantScene *out, int *count, RTCScene scene, const double origin_enu[3])
{
    if (!scene) return;
    out[*count].scene = scene;
    memcpy(out[*count].origin_enu, origin_enu, sizeof out->origin_enu);
    rtcGetSceneBounds(scene, &out[(*count)++].bounds);
}

static int scenes_of(PlantScene out[most_scenes], const ForestFrame *frame)
{
    const PlantList    *low = low_plants_list(frame);
    const PagesInReach *far = frame->far;
    int                 count = 0;
    add_scene(out, &count, frame->forest->standing.scene, frame->forest->standing.origin_enu);
    if (low) add_scene(out, &count, low->scene, low->origin_enu);
    if (far) add_scene(out, &count, far->scene, far->origin_enu);
    return count;
}

static void start_of(double o[3], ListRay *ray, const PlantScene *in)
{
    v3_sub(o, ray->o_enu, in->origin_enu);
    ray->piece_m = 0, ray->piece_end_m = INFINITY;
    memcpy(ray->piece_d, ray->d_enu, sizeof ray->piece_d);
}

static void first_hit_straight(ListRay *ray, const PlantScene *list)
{
    struct RTCRayHit outer;
    double           o[3];
    start_of(o, ray, list);
    fill_ray(&outer.ray, o, ray->d_enu, ray->limit_m * past);
    outer.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(list->scene, &ray->base, &outer);
}

/* Ranges between which a ray is over a list's plants. */
static bool over_plants(double span_m[2], const ListRay *ray, const struct RTCBounds *b, const double o[3])
{
    static const double farthest_m = 1e7;
    const double low[2] = {(double)b->lower_x, (double)b->lower_y}, high[2] = {(double)b->upper_x, (double)b->upper_y};
    span_m[0] = 0, span_m[1] = smaller(ray->limit_m, farthest_m);
    for (int c = 0; c < 2; c++) {
        const double d = ray->d_enu[c], per = fabs(d) < 1e-30 ? 1e30 : 1 / d;
        const double p = (low[c] - 1 - o[c]) * per, q = (high[c] + 1 - o[c]) * per;
        span_m[0] = larger(span_m[0], smaller(p, q)), span_m[1] = smaller(span_m[1], larger(p, q));
    }
    return span_m[0] < span_m[1];
}

/* In straight pieces, each within less of the ray than plants' boxes have room: a chord of 1.6 km is 13 mm off at most.
 * A piece whose ends are above all plants is above them. */
static void first_hit_bent(ListRay *ray, const PlantScene *list)
{
    const struct RTCBounds *bounds = &list->bounds;
    static const double     piece_m = 1600, nearest = 1e-4;
    const double            top_m = (double)bounds->upper_z + 1;
    double                  o[3], span_m[2];
    start_of(o, ray, list);
    if (!over_plants(span_m, ray, bounds, o)) return;
    const double square = ray->d_enu[0] * ray->d_enu[0] + ray->d_enu[1] * ray->d_enu[1];
    const double step_m = piece_m / larger(sqrt(square), nearest), fall = ray->bend_per_m * square;
    for (double from_m = span_m[0]; from_m < smaller(span_m[1], ray->limit_m); from_m += step_m) {
        struct RTCRayHit outer;
        const double     to_m = smaller(from_m + step_m, span_m[1]);
        const double     start[3] = {o[0] + from_m * ray->d_enu[0], o[1] + from_m * ray->d_enu[1],
                                     o[2] + from_m * (ray->d_enu[2] - fall * from_m)};
        const double     chord[3] = {ray->d_enu[0], ray->d_enu[1], ray->d_enu[2] - fall * (from_m + to_m)};
        if (start[2] > top_m && o[2] + to_m * (ray->d_enu[2] - fall * to_m) > top_m) continue;
        ray->piece_m = from_m, ray->piece_end_m = to_m;
        memcpy(ray->piece_d, chord, sizeof chord);
        fill_ray(&outer.ray, start, chord, (smaller(to_m, ray->limit_m) - from_m) * past);
        outer.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(list->scene, &ray->base, &outer);
    }
}

uint64_t forest_first_hits(double *range_m, ForestHit *hit, const ForestFrame *frame, int count,
                           const double *const o_enu[3], const double *const d_enu[3], const uint8_t *real)
{
    PlantScene scene[most_scenes];
    ListRay    ray;
    const int  scenes = scenes_of(scene, frame);
    open_rays(&ray);
    for (int i = 0; i < count; i++) {
        if (!open_ray(&ray, frame, o_enu, d_enu, i, range_m[i], real && real[i])) continue;
        ray.bend_per_m = frame->bend_per_m;
        for (int k = 0; k < scenes; k++) {
            if (frame->bend_per_m > 0) first_hit_bent(&ray, &scene[k]);
            else first_hit_straight(&ray, &scene[k]);
        }
        if (!ray.met) continue;
        range_m[i] = ray.limit_m;
        hit[i] = ray.hit;
    }
    return ray.entered;
}

uint64_t forest_any_hits(uint8_t *dark, const ForestFrame *frame, int count, const double *const o_enu[3],
                         const double *const d_enu[3], const double *far_m, const uint8_t *real)
{
    PlantScene scene[most_scenes];
    ListRay    ray;
    const int  scenes = scenes_of(scene, frame);
    open_rays(&ray);
    for (int i = 0; i < count; i++) {
        if (dark[i]) continue;
        if (!open_ray(&ray, frame, o_enu, d_enu, i, far_m[i], real && real[i])) continue;
        for (int k = 0; k < scenes && !ray.met; k++) {
            struct RTCRay outer;
            double        o[3];
            start_of(o, &ray, &scene[k]);
            fill_ray(&outer, o, ray.d_enu, ray.limit_m * past);
            rtcOccluded1(scene[k].scene, &ray.base, &outer);
        }
        dark[i] = ray.met;
    }
    return ray.entered;
}
