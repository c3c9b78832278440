/* entities/scenery/clutter_lines.c: clutter of roads, lanes and tracks: what stands at their sides, and what drives on
 * them. */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

enum { most_vertices = 8192 };

/* A place along a line and the unit vector of its piece. */
static void place_along(double p[2], double d[2], const ClutterLine *line, double at_m)
{
    for (int k = 0; k + 1 < line->count; k++) {
        const double *a = line->p[k], *b = line->p[k + 1], piece_m = hypot(b[0] - a[0], b[1] - a[1]);
        if (at_m > piece_m && k + 2 < line->count) {
            at_m -= piece_m;
            continue;
        }
        for (int c = 0; c < 2; c++) d[c] = piece_m > 0 ? (b[c] - a[c]) / piece_m : c;
        for (int c = 0; c < 2; c++) p[c] = a[c] + fmin(at_m, piece_m) * d[c];
        return;
    }
}

/* ---- at the side -------------------------------------------------------------------------------- */

static Status place_beside(ClutterWork *work, const ClutterLine *line, int r)
{
    const ClutterRow *row = &work->table.row[r];
    const uint64_t    of = clutter_hash(work, r, (int64_t)line->key, 2, 0);
    const int         count =
        clutter_poisson(work->config->density * row->density * 1e-3 * line->length_m, clutter_unit(of, 0));
    Status status = STATUS_OK;
    for (int k = 0; k < count && status == STATUS_OK && !clutter_is_full(work); k++) {
        const uint64_t h = invented_hash(of, k + 1, 9);
        ClutterThing   t = {.rank = h, .row = r, .variant = clutter_variant_of(work, r, h)};
        const float   *size_m = work->variant[t.variant].size_m;
        double         p[2] = {0, 0}, d[2] = {0, 1};
        place_along(p, d, line, clutter_unit(h, 1) * line->length_m);
        /* on the right side headed along, on the left headed back */
        const double side = clutter_unit(h, 2) < 0.5 ? 1 : -1;
        const double off_m = line->half_m + 0.5 * (double)size_m[1] + 0.35 + 0.8 * clutter_unit(h, 3);
        t.x_m = p[0] + side * off_m * d[1], t.y_m = p[1] - side * off_m * d[0];
        t.heading_rad = atan2(side * d[0], side * d[1]);
        if (clutter_in_square(work->config, t.x_m, t.y_m, clutter_margin_m) &&
            clutter_can_stand(work->spots, t.x_m, t.y_m, t.heading_rad, size_m))
            status = clutter_add(work, t);
    }
    return status;
}

/* ---- on it -------------------------------------------------------------------------------------- */

/* What drives on a stretch of a line: one number for each row, at equal speeds, at distances that leave room. */
static Status place_riders(ClutterWork *work, const ClutterLine *whole, int a, int b)
{
    static const double least_m = 120; /* of a stretch */
    ClutterLine         line = *whole;
    ClutterThing        rider[clutter_most_riders];
    int                 riders = 0;
    line.p += a, line.count = b - a + 1;
    clutter_line_measure(&line);
    if (!(line.length_m >= least_m)) return STATUS_OK;
    line.key = invented_hash(whole->key, a, 4);
    for (int r = 0; r < work->table.rows; r++) {
        const ClutterRow *row = &work->table.row[r];
        if ((int)row->where != line.kind || row->heat != CLUTTER_DRIVES) continue;
        const uint64_t of = clutter_hash(work, r, (int64_t)line.key, 3, 0);
        const int      count =
            clutter_poisson(work->config->density * row->density * 1e-3 * line.length_m, clutter_unit(of, 0));
        for (int k = 0; k < count && riders < clutter_most_riders; k++) {
            const uint64_t h = invented_hash(of, k + 1, 9);
            rider[riders++] = (ClutterThing){.rank = h, .row = r, .variant = clutter_variant_of(work, r, h)};
        }
    }
    return clutter_add_riders(work, &line, rider, riders, 0);
}

static Status place_line(ClutterWork *work, ClutterLine *line)
{
    Status status = STATUS_OK;
    bool   drives = false, near = false;
    for (int k = 0; k < line->count && !near; k++)
        near = clutter_in_square(work->config, line->p[k][0], line->p[k][1], 200);
    if (!near) return STATUS_OK;
    clutter_line_measure(line);
    for (int r = 0; r < work->table.rows && status == STATUS_OK; r++) {
        const ClutterRow *row = &work->table.row[r];
        if ((int)row->where != line->kind) continue;
        drives |= row->heat == CLUTTER_DRIVES;
        if (row->heat != CLUTTER_DRIVES) status = place_beside(work, line, r);
    }
    for (int k = 0, from = 0; drives && k <= line->count && status == STATUS_OK; k++) {
        if (k < line->count && clutter_may_pass(work, line->p[k])) continue;
        if (k - from >= 2) status = place_riders(work, line, from, k - 1);
        from = k + 1;
    }
    return status;
}

/* ---- all lines ---------------------------------------------------------------------------------- */

static Status place_ways(ClutterWork *work, double (*vertex)[2])
{
    static const ClutterWhere of[WAY_KINDS] = {
        [WAY_NONE] = CLUTTER_PLACES,    [WAY_ROAD] = CLUTTER_ON_ROAD,  [WAY_LANE] = CLUTTER_ON_LANE,
        [WAY_TRACK] = CLUTTER_ON_TRACK, [WAY_STREAM] = CLUTTER_PLACES, [WAY_GULLY] = CLUTTER_PLACES};
    const Landscape *land = work->config->landscape;
    Status           status = STATUS_OK;
    WayKind          kind = WAY_NONE;
    int              count;
    for (int way = 0;
         status == STATUS_OK && (count = landscape_way_vertices(vertex, &kind, land, way, most_vertices)) > 0; way++) {
        WayPlace    place;
        ClutterLine line = {.p = vertex, .count = count, .kind = (int)of[kind], .key = (uint64_t)way + 1};
        if (line.kind == (int)CLUTTER_PLACES) continue;
        const double *middle = vertex[count / 2];
        line.half_m = landscape_way(&place, land, middle[0], middle[1]) && place.way == way ? place.half_m : 2;
        status = place_line(work, &line);
    }
    return status;
}

static Status place_culture_lines(ClutterWork *work, double (*vertex)[2])
{
    static const double wide_m = 4.6; /* narrower ones are lanes */
    static const double step_m = 8;   /* corners of files are far apart; the ground is not flat */
    const Culture      *c = work->config->culture;
    Status              status = STATUS_OK;
    for (int n = 0; c && n < c->lines && status == STATUS_OK; n++) {
        const CultureLine *l = &c->line[n];
        if (l->kind != CULTURE_ROAD && l->kind != CULTURE_TRACK) continue;
        ClutterLine line = {.p = vertex, .half_m = 0.5 * (double)l->width_m, .key = l->id ^ 0x5bd1e995u};
        line.kind = l->kind == CULTURE_TRACK      ? CLUTTER_ON_TRACK
                    : (double)l->width_m < wide_m ? CLUTTER_ON_LANE
                                                  : CLUTTER_ON_ROAD;
        for (int k = 0; k < l->corners && line.count < most_vertices; k++) {
            const double *b = c->corner_m[l->first_corner + k], *a = c->corner_m[l->first_corner + (k ? k - 1 : 0)];
            const int     parts = (int)clamp(ceil(hypot(b[0] - a[0], b[1] - a[1]) / step_m), 1, most_vertices);
            for (int part = 1; part <= parts && line.count < most_vertices; part++, line.count++)
                for (int i = 0; i < 2; i++) vertex[line.count][i] = a[i] + (b[i] - a[i]) * part / parts;
        }
        if (line.count >= 2) status = place_line(work, &line);
    }
    return status;
}

Status clutter_place_lines(ClutterWork *work)
{
    double(*vertex)[2] = malloc(most_vertices * sizeof *vertex);
    if (!vertex) return STATUS_NO_MEMORY;
    Status status = place_ways(work, vertex);
    if (status == STATUS_OK) status = place_culture_lines(work, vertex);
    free(vertex);
    return status;
}
