/* render/trace/plants/forest_packets.c: rays through lists of plants, eight at a time: each plant whose box some of
 * them enter is met by its table, or itself. */
#include "render/trace/plants/forest_private.h"

enum { cards_kept = 1024 };

/* What rays of a block have of the plants that they meet. */
typedef struct Memory {
    const Plant *of[cards_kept]; /* NULL: none yet */
    Card         card[cards_kept];
    PlantFrame   frame[frames_kept];
} Memory;

typedef struct Packet {
    struct RTCIntersectContext base; /* first: Embree passes it to the callbacks */
    CardRays                   rays;
    Memory                    *kept;
    int                        count;
    unsigned                   by_table; /* lanes that need no plant itself */
    unsigned                   table_hit;
    uint64_t                   entered; /* plants' boxes */
    ListRay                    ray[card_lanes];
} Packet;

/* ---- a plant ---------------------------------------------------------------------------------- */

/* Fields of n rays lie one after another (rtcore_ray.h), and they may stand in any order. */
typedef struct Fields {
    const int      *valid;
    unsigned        n;
    float          *end_m;
    const uint32_t *id;
} Fields;

static Fields fields_of(const int *valid, unsigned n, void *rays)
{
    return (Fields){valid, n, (float *)rays + 8 * n, (const uint32_t *)rays + 10 * n};
}

static unsigned lanes_of(const Fields *f)
{
    unsigned lanes = 0;
    for (unsigned k = 0; k < f->n; k++)
        if (f->valid[k]) lanes |= 1u << f->id[k];
    return lanes;
}

/* NULL: no lane needs it. */
static const Card *card_of(Packet *p, const PlantList *list, uint32_t place, unsigned lanes)
{
    const Plant *plant = &list->plant[place];
    const size_t slot = (uintptr_t)plant / sizeof *plant % cards_kept;
    Card        *card = &p->kept->card[slot];
    if (!(p->by_table & lanes)) return NULL;
    if (p->kept->of[slot] != plant) card_make(card, &p->rays, list, plant);
    p->kept->of[slot] = plant;
    return card->real ? NULL : card;
}

/* Rays of a packet that enter a plant's box. */
typedef struct Visit {
    Fields      of;
    const Card *card;          /* NULL: by table nothing is met */
    unsigned    tables, plant; /* lanes that meet it by table, and itself */
} Visit;

static Visit visit_of(Packet *p, const PlantList *list, uint32_t place, Fields of)
{
    const unsigned lanes = lanes_of(&of);
    const Card    *card = card_of(p, list, place, lanes);
    const unsigned tables = card ? lanes & p->by_table : 0;
    p->entered += (uint64_t)__builtin_popcount(lanes);
    return (Visit){of, card, tables, lanes & ~tables};
}

/* Lanes whose first hit is the table's. */
static unsigned first_by_table(Packet *p, const Card *card, uint32_t place, unsigned lanes)
{
    float    range_m[card_lanes];
    uint32_t quad[card_lanes];
    unsigned nearer = 0;
    for (unsigned met = card_meets(range_m, quad, card, &p->rays, place, lanes); met; met &= met - 1) {
        const int    l = __builtin_ctz(met);
        ListRay     *ray = &p->ray[l];
        const double at_m = (double)range_m[l];
        if (!(at_m <= ray->limit_m) || (at_m == ray->limit_m && !(ray->met && place < ray->hit.place))) continue;
        ray->limit_m = at_m, ray->met = true;
        ray->hit.place = place, ray->hit.quad = quad[l];
        nearer |= 1u << l;
    }
    p->table_hit |= nearer;
    return nearer;
}

void plant_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    Packet          *p = (Packet *)a->context;
    const Visit      v = visit_of(p, list, a->primID, fields_of(a->valid, a->N, a->rayhit));
    unsigned         nearer = v.tables ? first_by_table(p, v.card, a->primID, v.tables) : 0;
    for (unsigned left = v.plant; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        if (!plant_first(&p->ray[l], list, a->primID)) continue;
        nearer |= 1u << l, p->table_hit &= ~(1u << l);
    }
    for (unsigned k = 0; nearer && k < v.of.n; k++) {
        const ListRay *ray = &p->ray[v.of.id[k]];
        if (v.of.valid[k] && nearer >> v.of.id[k] & 1) v.of.end_m[k] = (float)((ray->limit_m - ray->piece_m) * past);
    }
}

static unsigned stopped_by_table(Packet *p, const Card *card, uint32_t place, unsigned lanes)
{
    float    range_m[card_lanes];
    uint32_t quad[card_lanes];
    unsigned stopped = 0;
    for (unsigned met = card_meets(range_m, quad, card, &p->rays, place, lanes); met; met &= met - 1) {
        const int l = __builtin_ctz(met);
        if ((double)range_m[l] < p->ray[l].limit_m) p->ray[l].met = true, stopped |= 1u << l;
    }
    return stopped;
}

void plant_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    Packet          *p = (Packet *)a->context;
    const Visit      v = visit_of(p, list, a->primID, fields_of(a->valid, a->N, a->ray));
    unsigned         stopped = v.tables ? stopped_by_table(p, v.card, a->primID, v.tables) : 0;
    for (unsigned left = v.plant; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        if (plant_stops(&p->ray[l], list, a->primID)) stopped |= 1u << l;
    }
    for (unsigned k = 0; stopped && k < v.of.n; k++)
        if (v.of.valid[k] && stopped >> v.of.id[k] & 1) v.of.end_m[k] = -INFINITY;
}

/* ---- packets ---------------------------------------------------------------------------------- */

static void open_packets(Packet *p, Memory *kept, const ForestFrame *frame, const double *way_enu)
{
    p->rays.frame = frame, p->rays.way_enu = way_enu, p->rays.bend_per_m = 0;
    p->kept = kept, p->entered = 0;
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
        if (p->rays.way_enu) p->rays.o[c][lane] = (float)(ray->o_enu[c] - frame->forest->standing.origin_enu[c]);
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

static void start_of(double o[3], const ListRay *ray, const PlantList *list)
{
    v3_sub(o, ray->o_enu, list->origin_enu);
}

/* ---- first hits ------------------------------------------------------------------------------- */

static void first_straight(Packet *p, const PlantList *list, unsigned lanes)
{
    struct RTCRayHit8 outer;
    int               valid[card_lanes] __attribute__((aligned(32)));
    for (int l = 0; l < card_lanes; l++) {
        const ListRay *ray = &p->ray[l];
        const bool     runs = lanes >> l & 1;
        double         o[3] = {0};
        valid[l] = runs ? -1 : 0;
        if (runs) start_of(o, ray, list);
        put_ray(&outer.ray, l, o, runs ? ray->d_enu : (const double[3]){0, 0, 1}, runs ? ray->limit_m * past : 0);
        outer.hit.geomID[l] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, list->scene, &p->base, &outer);
}

/* Ranges between which a ray is over a list's plants. */
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

/* A bent ray over a list's plants, in straight pieces. */
typedef struct Pieces {
    double o[3], from_m, to_m, step_m, fall;
} Pieces;

static bool open_pieces(Pieces *out, const ListRay *ray, const PlantList *list, const struct RTCBounds *bounds)
{
    static const double piece_m = 1600, nearest = 1e-4;
    double              span_m[2];
    start_of(out->o, ray, list);
    if (!over_plants(span_m, ray, bounds, out->o)) return false;
    const double square = ray->d_enu[0] * ray->d_enu[0] + ray->d_enu[1] * ray->d_enu[1];
    out->from_m = span_m[0], out->to_m = span_m[1];
    out->step_m = piece_m / larger(sqrt(square), nearest), out->fall = ray->bend_per_m * square;
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

/* In straight pieces, each within less of the ray than plants' boxes have room: a chord of 1.6 km is 13 mm off at most.
 * Every lane has the next of its own. */
static void first_bent(Packet *p, const PlantList *list, const struct RTCBounds *bounds, unsigned lanes)
{
    const double top_m = (double)bounds->upper_z + 1;
    Pieces       at[card_lanes];
    for (int l = 0; l < card_lanes; l++)
        if (lanes >> l & 1 && !open_pieces(&at[l], &p->ray[l], list, bounds)) lanes &= ~(1u << l);
    while (lanes) {
        struct RTCRayHit8 outer;
        int               valid[card_lanes] __attribute__((aligned(32)));
        for (int l = 0; l < card_lanes; l++) {
            if (lanes >> l & 1 && !put_piece(&outer, &at[l], &p->ray[l], l, top_m)) lanes &= ~(1u << l);
            valid[l] = lanes >> l & 1 ? -1 : 0;
            if (!valid[l]) put_ray(&outer.ray, l, (const double[3]){0}, (const double[3]){0, 0, 1}, 0);
            outer.hit.geomID[l] = RTC_INVALID_GEOMETRY_ID;
        }
        if (lanes) rtcIntersect8(valid, list->scene, &p->base, &outer);
    }
}

/* The order in which rays of a picture go in packets: squares of 4 x 2. */
static int ray_at(int k, int count, int columns)
{
    if (columns < 4 || columns % 4 != 0 || count % (2 * columns) != 0) return k;
    const int row = k / (2 * columns) * 2, in = k % (2 * columns);
    return (row + in % 8 / 4) * columns + in / 8 * 4 + in % 4;
}

/* Whether Embree may cull boxes for all lanes at once: by a frustum, in which rays along an axis, or of several
 * octants, miss boxes that they enter. */
static bool is_frustum(const Packet *p, unsigned lanes)
{
    static const float least = 1e-3f;
    for (int c = 0; c < 3; c++) {
        const F32x8    d = f32x8_load(p->rays.d[c]);
        const unsigned up = f32x8_bits(f32x8_less(f32x8_set((double)least), d)) & lanes;
        const unsigned down = f32x8_bits(f32x8_less(d, f32x8_set((double)-least))) & lanes;
        if (up != lanes && down != lanes) return false;
    }
    return true;
}

uint64_t forest_first_hits(double *range_m, ForestHit *hit, const ForestFrame *frame, int count,
                           const double *const o_enu[3], const double *const d_enu[3], const uint8_t *real)
{
    const PlantList *lists[2] = {&frame->forest->standing, low_plants_list(frame)};
    struct RTCBounds bounds[2];
    Packet           p;
    Memory           kept;
    for (int k = 0; k < 2; k++) {
        if (lists[k] && !lists[k]->scene) lists[k] = NULL;
        if (lists[k]) rtcGetSceneBounds(lists[k]->scene, &bounds[k]);
    }
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
        if (is_frustum(&p, lanes)) p.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        for (int k = 0; k < 2; k++) {
            if (!lists[k]) continue;
            if (frame->bend_per_m > 0) first_bent(&p, lists[k], &bounds[k], lanes);
            else first_straight(&p, lists[k], lanes);
        }
        for (unsigned left = lanes & p.table_hit; left; left &= left - 1) { /* they lie far apart in memory */
            const ForestHit *met = &p.ray[__builtin_ctz(left)].hit;
            const int        kind = lists[0]->plant[met->place].kind;
            __builtin_prefetch(&frame->forest->table[kind]->shape->shape->quad[met->quad]);
        }
        for (int l = 0; l < some; l++) {
            ListRay *ray = &p.ray[l];
            if (!(lanes >> l & 1) || !ray->met) continue;
            if (p.table_hit >> l & 1) plant_complete(ray, lists[0]);
            range_m[of[l]] = ray->limit_m;
            hit[of[l]] = ray->hit;
            hit[of[l]].by_table = p.table_hit >> l & 1;
        }
    }
    return p.entered;
}

/* ---- any hits --------------------------------------------------------------------------------- */

static void any_straight(Packet *p, const PlantList *list, unsigned lanes)
{
    struct RTCRay8 outer;
    int            valid[card_lanes] __attribute__((aligned(32)));
    for (int l = 0; l < card_lanes; l++) {
        const ListRay *ray = &p->ray[l];
        const bool     runs = lanes >> l & 1 && !ray->met;
        double         o[3] = {0};
        valid[l] = runs ? -1 : 0;
        if (runs) start_of(o, ray, list);
        put_ray(&outer, l, o, runs ? ray->d_enu : (const double[3]){0, 0, 1}, runs ? ray->limit_m * past : 0);
    }
    rtcOccluded8(valid, list->scene, &p->base, &outer);
}

uint64_t forest_any_hits(uint8_t *dark, const ForestFrame *frame, int count, const double *const o_enu[3],
                         const double *const d_enu[3], const double *far_m, const ForestLeft *left)
{
    const PlantList *lists[2] = {&frame->forest->standing, low_plants_list(frame)};
    double           way[3] = {0};
    Packet           p;
    Memory           kept;
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
            p.rays.own_place[l] = p.rays.own_quad[l] = -1;
            if (left && left->place)
                p.rays.own_place[l] = (int32_t)left->place[i], p.rays.own_quad[l] = (int32_t)left->quad[i];
            if (open_ray(&p, l, o_enu, d_enu, i, far_m[i], left && left->real && left->real[i])) lanes |= 1u << l;
        }
        for (int k = 0; k < 2 && lanes; k++)
            if (lists[k] && lists[k]->scene) any_straight(&p, lists[k], lanes);
        for (int l = 0; l < some; l++) dark[of[l]] = lanes >> l & 1 && p.ray[l].met;
    }
    return p.entered;
}
