/* render/trace/plants/forest_visits.c: what rays of a packet meet of the plants of a box: by a plant's table, or of the
 * plant itself. A table is looked up at the visit after its own: its texels come from memory while Embree goes on to
 * the next box. A ray may so enter a box more than it must; what it meets first depends on no order. */
#include "render/trace/plants/forest_packets_private.h"

/* NULL: no lane needs it. */
static const Card *card_of(Packet *p, const PlantList *list, uint32_t place, unsigned lanes)
{
    const Plant *plant = &list->plant[place];
    const size_t slot = (uintptr_t)plant / sizeof *plant % cards_kept;
    Card        *card = &p->kept->card[slot];
    if (!(p->by_table & lanes)) return NULL;
    if (p->kept->of[slot] != plant && p->pending.card == card) packet_settle(p);
    if (p->kept->of[slot] != plant) card_make(card, &p->rays, list, plant);
    p->kept->of[slot] = plant;
    return card->real ? NULL : card;
}

/* Rays of a packet that enter a plant's box. */
typedef struct Visit {
    const Card *card;          /* NULL: by table nothing is met */
    unsigned    tables, plant; /* lanes that meet it by table, and itself */
} Visit;

/* Of neighbours that share a box, rays pass most by more than these are wide and high. */
static unsigned lanes_near(const Packet *p, const PlantList *list, uint32_t place, unsigned lanes)
{
    static const double leans = 0.25; /* of the height: half of it by 15 degrees and most_sway_rad */
    const Plant        *plant = &list->plant[place];
    const double        height_m = plant_height_m(plant), wide = plant->width > 128 ? plant->width / 128.0 : 1;
    const float         middle_m[3] = {plant->p_m[0], plant->p_m[1], plant->p_m[2] + (float)(0.5 * height_m)};
    return card_near(&p->rays, middle_m, (list->forest->hull[plant->kind].radius * wide + leans) * height_m, lanes);
}

static Visit visit_of(Packet *p, const PlantList *list, uint32_t place, unsigned lanes)
{
    if (list->far) lanes = far_page_lacks(p->rays.frame, list, place) ? 0 : lanes_near(p, list, place, lanes);
    const Card    *card = card_of(p, list, place, lanes);
    const unsigned tables = card ? lanes & p->by_table : 0;
    p->entered += (uint64_t)__builtin_popcount(lanes);
    return (Visit){card, tables, lanes & ~tables};
}

/* Lanes whose first hit is the table's. */
static unsigned first_by_table(Packet *p, const Card *card, const PlantList *list, uint32_t place, const CardAim *aim)
{
    const uint32_t plant = plant_number(list, place);
    float          range_m[card_lanes];
    uint32_t       quad[card_lanes];
    unsigned       nearer = 0;
    for (unsigned met = card_meets(range_m, quad, card, &p->rays, plant, aim); met; met &= met - 1) {
        const int    l = __builtin_ctz(met);
        ListRay     *ray = &p->ray[l];
        const double at_m = (double)range_m[l];
        if (!(at_m <= ray->limit_m) || (at_m == ray->limit_m && !(ray->met && plant < ray->hit.plant))) continue;
        ray->limit_m = at_m, ray->met = true;
        ray->hit.plant = plant, ray->hit.place = place, ray->hit.quad = quad[l];
        nearer |= 1u << l;
    }
    p->table_hit |= nearer;
    return nearer;
}

/* Lanes that the table stops. */
static unsigned stopped_by_table(Packet *p, const Card *card, uint32_t plant, const CardAim *aim)
{
    float    range_m[card_lanes];
    uint32_t quad[card_lanes];
    unsigned stopped = 0;
    for (unsigned met = card_meets(range_m, quad, card, &p->rays, plant, aim); met; met &= met - 1) {
        const int l = __builtin_ctz(met);
        if ((double)range_m[l] < p->ray[l].limit_m) p->ray[l].met = true, stopped |= 1u << l;
    }
    return stopped;
}

void packet_settle(Packet *p)
{
    Pending       *of = &p->pending;
    const uint32_t plant = of->list ? plant_number(of->list, of->place) : 0;
    if (!of->list) return;
    p->late |= of->any ? stopped_by_table(p, of->card, plant, &of->aim)
                       : first_by_table(p, of->card, of->list, of->place, &of->aim);
    of->list = NULL;
}

/* The plant is what is pending from now on; what was before is looked up. */
static void aim_at(Packet *p, const Card *card, const PlantList *list, uint32_t place, unsigned lanes, bool any)
{
    CardAim aim;
    if (!card_aim(&aim, card, &p->rays, lanes)) return;
    packet_settle(p);
    p->pending = (Pending){list, card, place, any, aim};
}

/* Lanes whose first hit is the plant's. */
static unsigned meet_first(Packet *p, const PlantList *list, uint32_t place, unsigned lanes)
{
    const Visit v = visit_of(p, list, place, lanes);
    unsigned    nearer = 0;
    if (v.tables) aim_at(p, v.card, list, place, v.tables, false);
    for (unsigned left = v.plant; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        if (!plant_first(&p->ray[l], list, place)) continue;
        nearer |= 1u << l, p->table_hit &= ~(1u << l);
    }
    return nearer;
}

static uint32_t end_of_box(const PlantList *list, uint32_t box)
{
    const uint32_t end = (box + 1) * (uint32_t)list->per_box;
    return end < (uint32_t)list->count ? end : (uint32_t)list->count;
}

void plant_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    Packet          *p = (Packet *)a->context;
    const Fields     of = fields_of(a->valid, a->N, a->rayhit);
    const unsigned   lanes = lanes_of(&of);
    const uint32_t   end = end_of_box(list, a->primID);
    unsigned         nearer = 0;
    for (uint32_t k = a->primID * (uint32_t)list->per_box; k < end; k++) nearer |= meet_first(p, list, k, lanes);
    nearer |= p->late & lanes, p->late &= ~lanes;
    end_rays(&of, p, nearer);
}

/* Lanes that the plant stops. */
static unsigned meet_any(Packet *p, const PlantList *list, uint32_t place, unsigned lanes)
{
    const Visit v = visit_of(p, list, place, lanes);
    unsigned    stopped = 0;
    if (v.tables) aim_at(p, v.card, list, place, v.tables, true);
    for (unsigned left = v.plant; left; left &= left - 1) {
        const int l = __builtin_ctz(left);
        if (plant_stops(&p->ray[l], list, place)) stopped |= 1u << l;
    }
    return stopped;
}

void plant_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    Packet          *p = (Packet *)a->context;
    const Fields     of = fields_of(a->valid, a->N, a->ray);
    const unsigned   lanes = lanes_of(&of);
    const uint32_t   end = end_of_box(list, a->primID);
    unsigned         stopped = 0;
    for (uint32_t k = a->primID * (uint32_t)list->per_box; k < end && lanes & ~stopped; k++)
        stopped |= meet_any(p, list, k, lanes & ~stopped);
    stopped |= p->late & lanes, p->late &= ~lanes;
    stop_rays(&of, stopped);
}
