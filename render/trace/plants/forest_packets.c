/* render/trace/plants/forest_packets.c: rays through a frame's plants, eight at a time: standing ones, low ones, and
 * those of pages. */
#include "render/trace/plants/forest_packets_private.h"

/* ---- packets ---------------------------------------------------------------------------------- */

static void open_packets(Packet *p, Memory *kept, const ForestFrame *frame, const double *way_enu)
{
    p->rays.frame = frame, p->rays.way_enu = way_enu, p->rays.bend_per_m = 0;
    p->kept = kept, p->entered = 0, p->late = 0, p->pending.list = NULL, p->pending.card = NULL;
    memset(kept->of, 0, sizeof kept->of);
    for (int k = 0; k < frames_kept; k++) kept->frame[k].plant = NULL;
}

static bool is_eye(const ForestFrame *frame, const ListRay *ray)
{
    return ray->o_enu[0] == frame->eye_enu[0] && ray->o_enu[1] == frame->eye_enu[1] &&
           ray->o_enu[2] == frame->eye_enu[2];
}

/* A lane's ray. False: one that Embree does not accept (not finite, or from too far), which meets nothing. */
static bool open_ray(Packet *p, int lane, const double *const o_enu[3], const double *const d_enu[3], int i,
                     double limit_m, bool real)
{
    static const double most_m = 1e15;
    const ForestFrame  *frame = p->rays.frame;
    ListRay            *ray = &p->ray[lane];
    ray->frame = frame, ray->kept = p->kept->frame, ray->real = real, ray->limit_m = limit_m, ray->met = false;
    ray->bend_per_m = p->rays.bend_per_m, ray->piece_m = 0;
    for (int c = 0; c < 3; c++) {
        ray->o_enu[c] = o_enu[c][i], ray->d_enu[c] = d_enu[c][i];
        p->rays.d[c][lane] = (float)ray->d_enu[c];
    }
    const double *way = p->rays.way_enu;
    const bool    alike =
        !way ? is_eye(frame, ray) : ray->d_enu[0] == way[0] && ray->d_enu[1] == way[1] && ray->d_enu[2] == way[2];
    if (alike && !real && frame->forest->config.tables && frame->ray_px > 0) p->by_table |= 1u << lane;
    return v3_dot(ray->d_enu, ray->d_enu) < 2 &&
           fabs(ray->o_enu[0]) + fabs(ray->o_enu[1]) + fabs(ray->o_enu[2]) < most_m;
}

static void put_ray(struct RTCRay8 *rays, int lane, const double o[3], const double d[3], double far_m)
{
    rays->org_x[lane] = (float)o[0], rays->org_y[lane] = (float)o[1], rays->org_z[lane] = (float)o[2];
    rays->dir_x[lane] = (float)d[0], rays->dir_y[lane] = (float)d[1], rays->dir_z[lane] = (float)d[2];
    rays->tnear[lane] = rays->time[lane] = 0;
    rays->tfar[lane] = (float)far_m;
    rays->mask[lane] = ~0u, rays->id[lane] = (unsigned)lane, rays->flags[lane] = 0;
}

static void put_none(struct RTCRay8 *rays, int lane)
{
    put_ray(rays, lane, (const double[3]){0, 0, 0}, (const double[3]){0, 0, 1}, 0);
}

/* Whether Embree may cull boxes for all lanes at once: by a frustum, in which rays along an axis, or of several
 * octants, miss boxes that they enter. */
static bool is_frustum(const struct RTCRay8 *rays, unsigned lanes)
{
    static const float least = 1e-3f;
    const float *const d[3] = {rays->dir_x, rays->dir_y, rays->dir_z};
    for (int c = 0; c < 3; c++) {
        const F32x8    along = f32x8_load(d[c]);
        const unsigned up = f32x8_bits(f32x8_less(f32x8_set((double)least), along)) & lanes;
        const unsigned down = f32x8_bits(f32x8_less(along, f32x8_set((double)-least))) & lanes;
        if (up != lanes && down != lanes) return false;
    }
    return true;
}

/* One lane's ray, alone: its fields, of one word each, lie in the order of the packet's. */
static struct RTCRay ray_of(const struct RTCRay8 *rays, int lane)
{
    enum { words = sizeof(struct RTCRay8) / (card_lanes * sizeof(uint32_t)) };
    uint32_t      word[words];
    struct RTCRay one = {.tfar = 0};
    for (int k = 0; k < words; k++)
        memcpy(&word[k], (const char *)rays + ((size_t)k * card_lanes + (size_t)lane) * sizeof *word, sizeof *word);
    memcpy(&one, word, sizeof word);
    return one;
}

/* First hits of these lanes; the others are filled in. Also from within Embree's callbacks. */
static void intersect(Packet *p, RTCScene scene, struct RTCRayHit8 *rays, unsigned lanes)
{
    const enum RTCIntersectContextFlags flags = p->base.flags;
    int                                 valid[card_lanes] __attribute__((aligned(32)));
    for (int l = 0; l < card_lanes; l++) {
        valid[l] = lanes >> l & 1 ? -1 : 0;
        if (!valid[l]) put_none(&rays->ray, l);
        rays->hit.geomID[l] = RTC_INVALID_GEOMETRY_ID;
    }
    p->base.flags =
        is_frustum(&rays->ray, lanes) ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_NONE;
    if (p->rays.frame->forest->packets) {
        rtcIntersect8(valid, scene, &p->base, rays);
    } else {
        for (unsigned left = lanes; left; left &= left - 1) {
            struct RTCRayHit one = {.ray = ray_of(&rays->ray, __builtin_ctz(left))};
            one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene, &p->base, &one);
        }
    }
    packet_settle(p);
    p->late = 0;
    p->base.flags = flags;
}

/* Likewise whether they are stopped. */
static void occlude(Packet *p, RTCScene scene, struct RTCRay8 *rays, unsigned lanes)
{
    int valid[card_lanes] __attribute__((aligned(32)));
    for (int l = 0; l < card_lanes; l++) {
        valid[l] = lanes >> l & 1 ? -1 : 0;
        if (!valid[l]) put_none(rays, l);
    }
    if (p->rays.frame->forest->packets) {
        rtcOccluded8(valid, scene, &p->base, rays);
        packet_settle(p);
        p->late = 0;
        return;
    }
    for (unsigned left = lanes; left; left &= left - 1) {
        struct RTCRay one = ray_of(rays, __builtin_ctz(left));
        rtcOccluded1(scene, &p->base, &one);
    }
    packet_settle(p);
    p->late = 0;
}

/* The ray's origin, about that of plants. */
static void start_of(double o[3], Packet *p, int lane, const double origin_enu[3])
{
    for (int c = 0; c < 3; c++) {
        o[c] = p->ray[lane].o_enu[c] - origin_enu[c];
        p->rays.o[c][lane] = (float)o[c];
    }
}

/* ---- scenes ----------------------------------------------------------------------------------- */

/* What rays are traced through: standing plants, low ones, pages. */
typedef struct PlantScene {
    RTCScene         scene;
    double           origin_enu[3];
    double           piece_m; /* bent rays go through it in straight pieces of this length */
    struct RTCBounds bounds;
} PlantScene;

enum { most_scenes = 3 };

static void add_scene(PlantScene out[most_scenes], int *count, RTCScene scene, const double origin_enu[3],
                      double piece_m)
{
    PlantScene *to = &out[*count];
    if (!scene) return;
    to->scene = scene, to->piece_m = piece_m;
    memcpy(to->origin_enu, origin_enu, sizeof to->origin_enu);
    rtcGetSceneBounds(scene, &to->bounds);
    ++*count;
}

static int scenes_of(PlantScene out[most_scenes], const ForestFrame *frame)
{
    static const double piece_m = 1600; /* 13 mm off at most: less than plants' boxes have room for */
    const PlantList    *standing = &frame->forest->standing, *low = low_plants_list(frame);
    const PagesInReach *far = frame->far;
    int                 count = 0;
    add_scene(out, &count, standing->scene, standing->origin_enu, piece_m);
    if (low) add_scene(out, &count, low->scene, low->origin_enu, piece_m);
    if (far) add_scene(out, &count, far->scene, far->origin_enu, page_piece_m);
    return count;
}

/* Ranges between which a ray is over the plants of these bounds. */
static bool over_plants(double span_m[2], const ListRay *ray, const struct RTCBounds *b, const double o[3])
{
    static const double farthest_m = 1e7;
    const double low[2] = {(double)b->lower_x, (double)b->lower_y}, high[2] = {(double)b->upper_x, (double)b->upper_y};
    span_m[0] = 0, span_m[1] = smaller(ray->limit_m, farthest_m);
    for (int c = 0; c < 2; c++) {
        const double d = ray->d_enu[c], per = fabs(d) < 1e-30 ? 1e30 : 1 / d;
        const double s = (low[c] - 1 - o[c]) * per, t = (high[c] + 1 - o[c]) * per;
        span_m[0] = larger(span_m[0], smaller(s, t)), span_m[1] = smaller(span_m[1], larger(s, t));
    }
    return span_m[0] < span_m[1];
}

/* ---- pages ------------------------------------------------------------------------------------ */

/* A ray begins anew where it enters the box of a page's plants, in floats about the page: 50 km away a float steps by
 * 4 mm. From there a bent one goes straight on to where it leaves them: 1.5 km on, it is 11 mm off at most. */
static bool enter_page(struct RTCRay8 *inner, Packet *p, int lane, const PlantList *list, const struct RTCBounds *box)
{
    static const double room_m = 1;
    ListRay            *ray = &p->ray[lane];
    const double       *d = ray->d_enu;
    double              o[3], span_m[2];
    start_of(o, p, lane, list->origin_enu);
    if (!over_plants(span_m, ray, box, o)) return false;
    const double fall = ray->bend_per_m * (d[0] * d[0] + d[1] * d[1]);
    const double z_m = o[2] + span_m[0] * (d[2] - fall * span_m[0]);
    const double chord[3] = {d[0], d[1], d[2] - fall * (span_m[0] + span_m[1])};
    const double per = fabs(chord[2]) < 1e-30 ? 1e30 : 1 / chord[2];
    const double s = ((double)box->lower_z - room_m - z_m) * per, t = ((double)box->upper_z + room_m - z_m) * per;
    const double in_m = larger(smaller(s, t), 0), out_m = smaller(larger(s, t), span_m[1] - span_m[0]);
    if (!(in_m <= out_m)) return false;
    ray->piece_m = span_m[0] + in_m;
    const double start[3] = {o[0] + ray->piece_m * d[0], o[1] + ray->piece_m * d[1], z_m + in_m * chord[2]};
    put_ray(inner, lane, start, chord, (out_m - in_m) * past + room_m);
    return true;
}

/* Those of the lanes that enter the page. */
static unsigned enter_lanes(struct RTCRay8 *inner, Packet *p, const PlantList *list, unsigned lanes)
{
    struct RTCBounds box;
    unsigned         in = 0;
    if (!list || !list->scene) return 0;
    rtcGetSceneBounds(list->scene, &box);
    for (unsigned left = lanes; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        if (enter_page(inner, p, l, list, &box)) in |= 1u << l;
    }
    return in;
}

void page_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const PagesInReach *pages = a->geometryUserPtr;
    Packet             *p = (Packet *)a->context;
    const Fields        of = fields_of(a->valid, a->N, a->rayhit);
    const unsigned      lanes = lanes_of(&of);
    struct RTCRayHit8   inner;
    double              piece_m[card_lanes], limit_m[card_lanes];
    unsigned            nearer = 0;
    for (unsigned left = lanes; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        piece_m[l] = p->ray[l].piece_m, limit_m[l] = p->ray[l].limit_m;
    }
    const PlantList *list = far_page_need(pages, pages->page[a->primID].page);
    const unsigned   in = enter_lanes(&inner.ray, p, list, lanes);
    if (in) intersect(p, list->scene, &inner, in);
    for (unsigned left = lanes; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        p->ray[l].piece_m = piece_m[l];
        if (p->ray[l].limit_m < limit_m[l]) nearer |= 1u << l;
    }
    end_rays(&of, p, nearer);
}

void page_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    const PagesInReach *pages = a->geometryUserPtr;
    Packet             *p = (Packet *)a->context;
    const Fields        of = fields_of(a->valid, a->N, a->ray);
    const PlantList    *list = far_page_need(pages, pages->page[a->primID].page);
    struct RTCRay8      inner;
    unsigned            stopped = 0;
    const unsigned      in = enter_lanes(&inner, p, list, lanes_of(&of));
    if (in) occlude(p, list->scene, &inner, in);
    for (unsigned left = in; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        if (p->ray[l].met) stopped |= 1u << l;
    }
    stop_rays(&of, stopped);
}

/* ---- first hits ------------------------------------------------------------------------------- */

static void first_straight(Packet *p, const PlantScene *in, unsigned lanes)
{
    struct RTCRayHit8 outer;
    for (unsigned left = lanes; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        double    o[3];
        start_of(o, p, l, in->origin_enu);
        put_ray(&outer.ray, l, o, p->ray[l].d_enu, p->ray[l].limit_m * past);
    }
    intersect(p, in->scene, &outer, lanes);
}

/* A bent ray over a scene's plants, in straight pieces. */
typedef struct Pieces {
    double o[3], from_m, to_m, step_m, fall;
} Pieces;

static bool open_pieces(Pieces *out, Packet *p, int lane, const PlantScene *in)
{
    static const double nearest = 1e-4;
    const ListRay      *ray = &p->ray[lane];
    double              span_m[2];
    start_of(out->o, p, lane, in->origin_enu);
    if (!over_plants(span_m, ray, &in->bounds, out->o)) return false;
    const double square = ray->d_enu[0] * ray->d_enu[0] + ray->d_enu[1] * ray->d_enu[1];
    out->from_m = span_m[0], out->to_m = span_m[1];
    out->step_m = in->piece_m / larger(sqrt(square), nearest), out->fall = ray->bend_per_m * square;
    return true;
}

/* The next piece that is not above all plants, into lane l: one whose ends are above them is. False: there is none. */
static bool put_piece(struct RTCRayHit8 *outer, Pieces *at, ListRay *ray, int l, double top_m)
{
    while (at->from_m < smaller(at->to_m, ray->limit_m)) {
        const double from_m = at->from_m, to_m = smaller(from_m + at->step_m, at->to_m);
        const double start[3] = {at->o[0] + from_m * ray->d_enu[0], at->o[1] + from_m * ray->d_enu[1],
                                 at->o[2] + from_m * (ray->d_enu[2] - at->fall * from_m)};
        const double chord[3] = {ray->d_enu[0], ray->d_enu[1], ray->d_enu[2] - at->fall * (from_m + to_m)};
        at->from_m += at->step_m;
        if (start[2] > top_m && at->o[2] + to_m * (ray->d_enu[2] - at->fall * to_m) > top_m) continue;
        ray->piece_m = from_m;
        put_ray(&outer->ray, l, start, chord, (smaller(to_m, ray->limit_m) - from_m) * past);
        return true;
    }
    return false;
}

/* In straight pieces, each within less of the ray than boxes have room. Every lane has the next of its own. */
static void first_bent(Packet *p, const PlantScene *in, unsigned lanes)
{
    const double top_m = (double)in->bounds.upper_z + 1;
    Pieces       at[card_lanes];
    for (int l = 0; l < card_lanes; l++)
        if (lanes >> l & 1 && !open_pieces(&at[l], p, l, in)) lanes &= ~(1u << l);
    while (lanes) {
        struct RTCRayHit8 outer;
        for (int l = 0; l < card_lanes; l++)
            if (lanes >> l & 1 && !put_piece(&outer, &at[l], &p->ray[l], l, top_m)) lanes &= ~(1u << l);
        if (lanes) intersect(p, in->scene, &outer, lanes);
    }
}

/* The order in which rays of a picture go in packets: squares of 4 x 2. */
static int ray_at(int k, int count, int columns)
{
    if (columns < 4 || columns % 4 != 0 || count % (2 * columns) != 0) return k;
    const int row = k / (2 * columns) * 2, in = k % (2 * columns);
    return (row + in % 8 / 4) * columns + in / 8 * 4 + in % 4;
}

uint64_t forest_first_hits(double *range_m, ForestHit *hit, const ForestFrame *frame, int count,
                           const double *const o_enu[3], const double *const d_enu[3], const uint8_t *real)
{
    PlantScene scene[most_scenes];
    Packet     p;
    Memory     kept;
    const int  scenes = scenes_of(scene, frame);
    open_packets(&p, &kept, frame, NULL);
    p.rays.bend_per_m = frame->bend_per_m;
    for (int first = 0; first < count; first += card_lanes) {
        const int some = count - first < card_lanes ? count - first : card_lanes;
        int       of[card_lanes];
        unsigned  lanes = 0;
        rtcInitIntersectContext(&p.base);
        p.by_table = p.table_hit = 0;
        for (int l = 0; l < some; l++) {
            const int i = of[l] = ray_at(first + l, count, frame->columns);
            if (open_ray(&p, l, o_enu, d_enu, i, range_m[i], real && real[i])) lanes |= 1u << l;
        }
        for (int k = 0; k < scenes && lanes; k++) {
            if (frame->bend_per_m > 0) first_bent(&p, &scene[k], lanes);
            else first_straight(&p, &scene[k], lanes);
        }
        for (unsigned left = lanes & p.table_hit; left; left &= left - 1) { /* they lie far apart in memory */
            const ForestHit *met = &p.ray[__builtin_ctz(left)].hit;
            const int        kind = forest_list_of(frame, met)->plant[met->place].kind;
            __builtin_prefetch(&frame->forest->table[kind]->shape->shape->quad[met->quad]);
        }
        for (int l = 0; l < some; l++) {
            ListRay *ray = &p.ray[l];
            if (!(lanes >> l & 1) || !ray->met) continue;
            if (p.table_hit >> l & 1) plant_complete(ray, forest_list_of(frame, &ray->hit));
            range_m[of[l]] = ray->limit_m;
            hit[of[l]] = ray->hit;
            hit[of[l]].by_table = p.table_hit >> l & 1;
        }
    }
    return p.entered;
}

/* ---- any hits --------------------------------------------------------------------------------- */

static void any_straight(Packet *p, const PlantScene *in, unsigned lanes)
{
    struct RTCRay8 outer;
    for (unsigned left = lanes; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        double    o[3];
        if (p->ray[l].met) lanes &= ~(1u << l);
        start_of(o, p, l, in->origin_enu);
        put_ray(&outer, l, o, p->ray[l].d_enu, p->ray[l].limit_m * past);
    }
    if (lanes) occlude(p, in->scene, &outer, lanes);
}

uint64_t forest_any_hits(uint8_t *dark, const ForestFrame *frame, int count, const double *const o_enu[3],
                         const double *const d_enu[3], const double *far_m, const ForestLeft *left)
{
    PlantScene scene[most_scenes];
    double     way[3] = {0};
    Packet     p;
    Memory     kept;
    const int  scenes = scenes_of(scene, frame);
    for (int c = 0; c < 3 && count > 0; c++) way[c] = d_enu[c][0];
    open_packets(&p, &kept, frame, way);
    for (int i = 0; i < count;) {
        int      of[card_lanes], some = 0;
        unsigned lanes = 0;
        rtcInitIntersectContext(&p.base);
        p.by_table = 0;
        for (; i < count && some < card_lanes; i++) {
            if (dark[i]) continue;
            const int l = some++;
            of[l] = i;
            p.rays.own_plant[l] = p.rays.own_quad[l] = -1;
            if (left && left->plant)
                p.rays.own_plant[l] = (int32_t)left->plant[i], p.rays.own_quad[l] = (int32_t)left->quad[i];
            if (open_ray(&p, l, o_enu, d_enu, i, far_m[i], left && left->real && left->real[i])) lanes |= 1u << l;
        }
        for (int k = 0; k < scenes && lanes; k++) any_straight(&p, &scene[k], lanes);
        for (int l = 0; l < some; l++) dark[of[l]] = lanes >> l & 1 && p.ray[l].met;
    }
    return p.entered;
}
