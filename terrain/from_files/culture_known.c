/* terrain/from_files/culture_known.c: tells records that are there already, by their kind and corners: files of
 * neighbouring areas, or one that is named twice, hold things in common; and poles that a power line has itself. */
#include "terrain/from_files/culture_import_private.h"

#include <stdlib.h>

/* Where a record is: its corners, and how many. kind: no two kinds are one thing. */
typedef struct Where {
    int32_t kind, corners;
    const double (*corner_m)[2];
} Where;

_Static_assert(offsetof(CulturePoint, y_m) == offsetof(CulturePoint, x_m) + sizeof(double) &&
                   offsetof(CultureTree, y_m) == offsetof(CultureTree, x_m) + sizeof(double),
               "a place is a corner");

static Where where_of(const Culture *c, KnownList list, int number)
{
    switch (list) {
    case KNOWN_BUILDING: /* two of one outline would stand in each other, whatever is said of them */
        return (Where){0, c->building[number].corners,
                       (const double(*)[2])c->corner_m + c->building[number].first_corner};
    case KNOWN_LINE:
        return (Where){c->line[number].kind, c->line[number].corners,
                       (const double(*)[2])c->corner_m + c->line[number].first_corner};
    case KNOWN_POINT:
        return (Where){c->point[number].kind, 1, (const double(*)[2])(const void *)&c->point[number].x_m};
    default:
        return (Where){c->tree[number].kind, 1, (const double(*)[2])(const void *)&c->tree[number].x_m};
    }
}

/* The slot of a record like that one, or the free one for it; there is one. */
static KnownRecord *slot_of(const CultureKnown *known, const Culture *c, KnownList list, const Where *w)
{
    const int32_t what[3] = {(int32_t)list, w->kind, w->corners};
    uint64_t      hash = culture_mix(culture_mix_seed, what, sizeof what);
    hash = culture_mix(hash, w->corner_m, (size_t)w->corners * sizeof *w->corner_m);
    for (size_t at = (size_t)(hash ^ hash >> 29);; at++) {
        KnownRecord *r = &known->slot[at & (known->room - 1)];
        if (r->number == 0) return r;
        if (r->list != (int32_t)list) continue;
        const Where o = where_of(c, list, r->number - 1);
        if (o.kind == w->kind && o.corners == w->corners &&
            memcmp(o.corner_m, w->corner_m, (size_t)w->corners * sizeof *w->corner_m) == 0)
            return r;
    }
}

static Status grow(CultureKnown *known, const Culture *c)
{
    CultureKnown larger = {.room = known->room ? 2 * known->room : 1024, .count = known->count};
    larger.slot = calloc(larger.room, sizeof *larger.slot);
    if (!larger.slot) return STATUS_NO_MEMORY;
    for (size_t k = 0; k < known->room; k++) {
        const KnownRecord *r = &known->slot[k];
        if (r->number == 0) continue;
        const Where w = where_of(c, (KnownList)r->list, r->number - 1);
        *slot_of(&larger, c, (KnownList)r->list, &w) = *r;
    }
    free(known->slot);
    *known = larger;
    return STATUS_OK;
}

Status culture_known_take(bool *again, CultureKnown *known, const Culture *c, KnownList list)
{
    const int    count[] = {c->buildings, c->lines, c->points, c->trees}, number = count[list];
    const Where  w = where_of(c, list, number - 1);
    const Status status = 2 * (known->count + 1) > known->room ? grow(known, c) : STATUS_OK;
    if (status != STATUS_OK) return status;
    KnownRecord *r = slot_of(known, c, list, &w);
    *again = r->number != 0;
    if (!*again) *r = (KnownRecord){(int32_t)list, number}, known->count++;
    return STATUS_OK;
}

/* Leaves out poles and masts that carry a power line, whose corners are poles. */
Status culture_leave_poles(Culture *c, CultureReport *report)
{
    static const double same_m = 1;
    int                 kept = 0;
    const Status        status = culture_index(c);
    if (status != STATUS_OK) return status;
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        const bool          carries = p->kind == CULTURE_POLE || p->kind == CULTURE_MAST;
        if (carries && culture_line_near(c, CULTURE_POWER_LINE, p->x_m, p->y_m, same_m) >= 0)
            report->left[CULTURE_LEFT_TWICE]++;
        else c->point[kept++] = *p;
    }
    if (kept == c->points) return STATUS_OK;
    c->points = kept;
    return culture_index(c);
}
