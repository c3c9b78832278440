/* entities/scenery/clutter_yards.c: clutter about buildings: beside a wall, along or across it. Without buildings the
 * houses are those of an invented landscape's plots. */
#include "entities/scenery/scenery_clutter_private.h"

enum { tries = 12 };

/* An outline, counter-clockwise from above, and whose it is. */
typedef struct Yard {
    const double (*corner_m)[2];
    int      corners;
    uint64_t key;
} Yard;

/* A place beside a wall; false: none that is free. */
static bool find_place(ClutterThing *t, const ClutterWork *work, const Yard *yard, uint64_t h)
{
    const float *size_m = work->variant[t->variant].size_m;
    double       round_m = 0;
    for (int k = 0; k < yard->corners; k++) {
        const double *a = yard->corner_m[k], *b = yard->corner_m[(k + 1) % yard->corners];
        round_m += hypot(b[0] - a[0], b[1] - a[1]);
    }
    for (uint64_t n = 0; n < tries; n++) {
        double at_m = clutter_unit(h, 10 + 4 * n) * round_m;
        int    k = 0;
        for (; k + 1 < yard->corners; k++) {
            const double *a = yard->corner_m[k], *b = yard->corner_m[k + 1];
            const double  piece_m = hypot(b[0] - a[0], b[1] - a[1]);
            if (at_m <= piece_m) break;
            at_m -= piece_m;
        }
        const double *a = yard->corner_m[k], *b = yard->corner_m[(k + 1) % yard->corners];
        const double  piece_m = hypot(b[0] - a[0], b[1] - a[1]);
        if (!(piece_m > 0.1)) continue;
        const double dx = (b[0] - a[0]) / piece_m, dy = (b[1] - a[1]) / piece_m, share = fmin(at_m / piece_m, 1);
        const bool   across = clutter_unit(h, 11 + 4 * n) < 0.5; /* its length away from the wall */
        const double half_m = 0.5 * (double)size_m[across ? 0 : 1];
        const double off_m = half_m + 0.6 + 5 * clutter_unit(h, 12 + 4 * n);
        const double turn = clutter_unit(h, 13 + 4 * n) < 0.5 ? 1 : -1;
        t->x_m = a[0] + share * (b[0] - a[0]) + off_m * dy;
        t->y_m = a[1] + share * (b[1] - a[1]) - off_m * dx;
        t->heading_rad = across ? atan2(turn * dy, -turn * dx) : atan2(turn * dx, turn * dy);
        if (clutter_can_stand(work->spots, t->x_m, t->y_m, t->heading_rad, size_m)) return true;
    }
    return false;
}

static Status place_yard(ClutterWork *work, const Yard *yard, ClutterWhere where)
{
    Status status = STATUS_OK;
    if (!clutter_in_square(work->config, yard->corner_m[0][0], yard->corner_m[0][1], 300)) return STATUS_OK;
    for (int r = 0; r < work->table.rows && status == STATUS_OK; r++) {
        const ClutterRow *row = &work->table.row[r];
        if (row->where != where) continue;
        const uint64_t of = clutter_hash(work, r, (int64_t)yard->key, 1, 0);
        const int      count = clutter_poisson(work->config->density * row->density, clutter_unit(of, 0));
        for (int k = 0; k < count && status == STATUS_OK && !clutter_is_full(work); k++) {
            const uint64_t h = invented_hash(of, k + 1, 9);
            ClutterThing   t = {.rank = h, .row = r, .variant = clutter_variant_of(work, r, h)};
            if (find_place(&t, work, yard, h) && clutter_in_square(work->config, t.x_m, t.y_m, clutter_margin_m))
                status = clutter_add(work, t);
        }
    }
    return status;
}

static Status place_plots(ClutterWork *work)
{
    int              count = 0;
    Status           status = STATUS_OK;
    const HousePlot *plot = landscape_plots(work->config->landscape, &count);
    for (int n = 0; n < count && status == STATUS_OK; n++) {
        const HousePlot *p = &plot[n];
        const double     along[2] = {p->direction[0], p->direction[1]}, across[2] = {-along[1], along[0]};
        double           corner[4][2];
        for (int k = 0; k < 4; k++) {
            const double a = p->house[0] + (k == 1 || k == 2 ? 1 : -1) * p->house_half[0];
            const double b = p->house[1] + (k >= 2 ? 1 : -1) * p->house_half[1];
            for (int c = 0; c < 2; c++) corner[k][c] = (c ? p->y_m : p->x_m) + a * along[c] + b * across[c];
        }
        const Yard yard = {(const double(*)[2])corner, 4,
                           invented_hash(3, (int64_t)llrint(p->x_m * 16), (int64_t)llrint(p->y_m * 16))};
        status = place_yard(work, &yard, CLUTTER_AT_HOUSE);
    }
    return status;
}

/* ---- in the open of a yard ---------------------------------------------------------------------- */

/* A straight piece of a yard's strip. */
typedef struct Strip {
    double   a_m[2], along[2], long_m, wide_m; /* along: unit vector */
    uint64_t key;
} Strip;

/* Things of a row on a strip, along it or across; its round ends stay free. */
static Status place_open(ClutterWork *work, const Strip *s, int r)
{
    static const double turn_rad = 0.25; /* at most, off the strip's direction: nothing is parked quite straight */
    const uint64_t      of = clutter_hash(work, r, (int64_t)s->key, 4, 0);
    const double        mean = work->config->density * work->table.row[r].density * 1e-4 * s->long_m * s->wide_m;
    const int           count = clutter_poisson(mean, clutter_unit(of, 0));
    Status              status = STATUS_OK;
    for (int k = 0; k < count && status == STATUS_OK && !clutter_is_full(work); k++) {
        const uint64_t h = invented_hash(of, k + 1, 9);
        ClutterThing   t = {.rank = h, .row = r, .variant = clutter_variant_of(work, r, h)};
        const double   quarter_rad = 0.5 * pi_rad * floor(4 * clutter_unit(h, 1));
        bool           stands = false;
        t.heading_rad = atan2(s->along[0], s->along[1]) + quarter_rad + turn_rad * (2 * clutter_unit(h, 2) - 1);
        for (uint64_t n = 0; n < tries && !stands; n++) {
            const double along_m = s->long_m * clutter_unit(h, 10 + 2 * n);
            const double right_m = s->wide_m * (clutter_unit(h, 11 + 2 * n) - 0.5);
            t.x_m = s->a_m[0] + along_m * s->along[0] + right_m * s->along[1];
            t.y_m = s->a_m[1] + along_m * s->along[1] - right_m * s->along[0];
            stands = clutter_can_stand(work->spots, t.x_m, t.y_m, t.heading_rad, work->variant[t.variant].size_m);
        }
        if (stands && clutter_in_square(work->config, t.x_m, t.y_m, clutter_margin_m)) status = clutter_add(work, t);
    }
    return status;
}

static Status place_opens(ClutterWork *work)
{
    const Culture *culture = work->config->culture;
    Status         status = STATUS_OK;
    for (int n = 0; n < culture->lines; n++) {
        const CultureLine *l = &culture->line[n];
        const bool         paved = l->surface == SURFACE_BUILT || l->surface == SURFACE_ROAD;
        const ClutterWhere where = paved ? CLUTTER_IN_WORKS : CLUTTER_IN_FARMYARD;
        for (int k = 0; l->kind == CULTURE_YARD && k + 1 < l->corners; k++) {
            const double *a = culture->corner_m[l->first_corner + k], *b = culture->corner_m[l->first_corner + k + 1];
            Strip         s = {.a_m = {a[0], a[1]}, .wide_m = (double)l->width_m, .key = invented_hash(l->id, k, 6)};
            s.long_m = hypot(b[0] - a[0], b[1] - a[1]);
            if (!(s.long_m > 1) || !clutter_in_square(work->config, a[0], a[1], s.long_m + s.wide_m + clutter_margin_m))
                continue;
            for (int c = 0; c < 2; c++) s.along[c] = (b[c] - a[c]) / s.long_m;
            for (int r = 0; r < work->table.rows && status == STATUS_OK; r++)
                if (work->table.row[r].where == where) status = place_open(work, &s, r);
        }
    }
    return status;
}

/* ---- all of them -------------------------------------------------------------------------------- */

Status clutter_place_yards(ClutterWork *work)
{
    const Culture *culture = work->config->culture;
    if (!culture || culture->buildings == 0) return place_plots(work);
    Status status = place_opens(work);
    for (int n = 0; n < culture->buildings && status == STATUS_OK; n++) {
        const Building    *b = &culture->building[n];
        const ClutterWhere where = b->use == BUILDING_HOUSE || b->use == BUILDING_FLATS ? CLUTTER_AT_HOUSE
                                   : b->use == BUILDING_BARN                            ? CLUTTER_AT_BARN
                                   : b->use == BUILDING_HALL                            ? CLUTTER_AT_HALL
                                                                                        : CLUTTER_PLACES;
        if (where == CLUTTER_PLACES) continue;
        const Yard yard = {(const double(*)[2])culture->corner_m + b->first_corner, b->corners, b->id};
        status = place_yard(work, &yard, where);
    }
    return status;
}
