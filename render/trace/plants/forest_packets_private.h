/* render/trace/plants/forest_packets_private.h: eight rays on their way through lists of plants, shared by
 * forest_packets.c and forest_visits.c. */
#ifndef RENDER_TRACE_PLANTS_FOREST_PACKETS_PRIVATE_H
#define RENDER_TRACE_PLANTS_FOREST_PACKETS_PRIVATE_H

#include "render/trace/plants/forest_private.h"

enum { cards_kept = 1024 };

/* What rays of a block have of the plants that they meet. */
typedef struct Memory {
    const Plant *of[cards_kept]; /* NULL: none yet */
    Card         card[cards_kept];
    PlantFrame   frame[frames_kept];
} Memory;

/* A plant's table whose texels are on their way: it is looked up when the next plant is visited. */
typedef struct Pending {
    const PlantList *list; /* NULL: none */
    const Card      *card;
    uint32_t         place;
    bool             any;
    CardAim          aim;
} Pending;

typedef struct Packet {
    struct RTCIntersectContext base; /* first: Embree passes it to the callbacks */
    CardRays                   rays;
    Memory                    *kept;
    int                        count;
    unsigned                   by_table; /* lanes that need no plant itself */
    unsigned                   table_hit;
    uint64_t                   entered; /* plants' boxes */
    unsigned                   late;    /* lanes that end nearer, or are stopped, than Embree knows */
    Pending                    pending;
    ListRay                    ray[card_lanes];
} Packet;

/* Looks up what is pending. Before the origin of rays changes. */
void packet_settle(Packet *p);

/* ---- what Embree passes to a callback --------------------------------------------------------- */

/* Fields of n rays lie one after another (rtcore_ray.h), and they may stand in any order. */
typedef struct Fields {
    const int      *valid;
    unsigned        n;
    float          *end_m;
    const uint32_t *id;
} Fields;

static inline Fields fields_of(const int *valid, unsigned n, void *rays)
{
    return (Fields){valid, n, (float *)rays + 8 * n, (const uint32_t *)rays + 10 * n};
}

static inline unsigned lanes_of(const Fields *f)
{
    unsigned lanes = 0;
    for (unsigned k = 0; k < f->n; k++)
        if (f->valid[k]) lanes |= 1u << f->id[k];
    return lanes;
}

/* Where the rays of these lanes end that Embree has. */
static inline void end_rays(const Fields *of, const Packet *p, unsigned lanes)
{
    for (unsigned k = 0; lanes && k < of->n; k++) {
        const ListRay *ray = &p->ray[of->id[k]];
        if (of->valid[k] && lanes >> of->id[k] & 1) of->end_m[k] = (float)((ray->limit_m - ray->piece_m) * past);
    }
}

static inline void stop_rays(const Fields *of, unsigned lanes)
{
    for (unsigned k = 0; lanes && k < of->n; k++)
        if (of->valid[k] && lanes >> of->id[k] & 1) of->end_m[k] = -INFINITY;
}

#endif
