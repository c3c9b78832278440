/* terrain/woods/woods_kept.c: standing plants as octets, for the cache, and back with every number checked.
 *
 * WoodsHead, first[squares + 1], plant[count], and bare[squares] where there is one. */
#include "terrain/woods/woods_private.h"

#include <stdlib.h>

typedef struct WoodsHead {
    double  reach_m;
    int32_t nx, ny, count, left_out, from_crowns, from_canopy, from_classes, from_hedges, bare, zero;
} WoodsHead;
_Static_assert(sizeof(WoodsHead) == 48 && sizeof(Plant) == 20, "no padding: the octets are the numbers");

static size_t squares_of(const Woods *w) { return (size_t)w->nx * (size_t)w->ny; }

size_t woods_to_octets(void *out, const Woods *w)
{
    const size_t first = (squares_of(w) + 1) * sizeof *w->first, plant = (size_t)w->count * sizeof *w->plant,
                 bare = w->bare ? squares_of(w) : 0;
    const WoodsHead head = {
        w->reach_m,      w->nx,          w->ny,           w->count, w->left_out, w->from_crowns, w->from_canopy,
        w->from_classes, w->from_hedges, w->bare != NULL, 0};
    char *at = out;
    if (at) {
        memcpy(at, &head, sizeof head);
        memcpy(at + sizeof head, w->first, first);
        if (plant > 0) memcpy(at + sizeof head + first, w->plant, plant);
        if (bare > 0) memcpy(at + sizeof head + first + plant, w->bare, bare);
    }
    return sizeof head + first + plant + bare;
}

static bool are_listed(const Woods *w)
{
    const size_t squares = squares_of(w);
    if (w->first[0] != 0 || w->first[squares] != (uint32_t)w->count) return false;
    for (size_t n = 0; n < squares; n++)
        if (w->first[n] > w->first[n + 1]) return false;
    return true;
}

bool woods_is_plant(const Plant *p)
{
    return p->kind < PLANT_STANDING && plant_height_m(p) > 0 && isfinite(p->p_m[0]) && isfinite(p->p_m[1]) &&
           isfinite(p->p_m[2]);
}

/* What out->nx and ny say is what its source has: the room is bounded by that. */
Status woods_from_octets(Woods *out, const void *octets, size_t count)
{
    const char  *at = octets;
    const size_t squares = squares_of(out), first = (squares + 1) * sizeof *out->first;
    WoodsHead    head;
    if (count < sizeof head + first) return STATUS_BAD_VALUE;
    memcpy(&head, at, sizeof head);
    const size_t plant = head.count > 0 ? (size_t)head.count * sizeof *out->plant : 0;
    if (head.nx != out->nx || head.ny != out->ny || head.count < 0 || (head.bare != 0 && head.bare != 1) ||
        count != sizeof head + first + plant + (head.bare ? squares : 0) || head.left_out < 0 || isnan(head.reach_m))
        return STATUS_BAD_VALUE;
    out->reach_m = head.reach_m, out->count = head.count, out->left_out = head.left_out;
    out->from_crowns = head.from_crowns, out->from_canopy = head.from_canopy;
    out->from_classes = head.from_classes, out->from_hedges = head.from_hedges;
    out->first = malloc(first);
    out->plant = malloc(plant + sizeof *out->plant);
    out->bare = head.bare ? malloc(squares + 1) : NULL;
    if (!out->first || !out->plant || (head.bare && !out->bare)) return STATUS_NO_MEMORY;
    memcpy(out->first, at + sizeof head, first);
    memcpy(out->plant, at + sizeof head + first, plant);
    if (out->bare) memcpy(out->bare, at + sizeof head + first + plant, squares);
    if (!are_listed(out)) return STATUS_BAD_VALUE;
    for (int k = 0; k < out->count; k++) {
        if (!woods_is_plant(&out->plant[k])) return STATUS_BAD_VALUE;
        out->by_kind[out->plant[k].kind]++;
    }
    return STATUS_OK;
}
