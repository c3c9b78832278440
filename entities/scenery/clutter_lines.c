/* entities/scenery/clutter_lines.c: clutter of roads, lanes and tracks: what stands at their sides, and what drives on
 * them, there on the right side and back on the other. */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

enum { most_vertices = 8192, most_riders = 64 };

typedef struct Line {
    double (*p)[2];
    int          count;
    ClutterWhere kind;
    double       half_m, length_m;
    uint64_t     key;
} Line;

static void measure(Line *line)
{
    line->length_m = 0;
    for (int k = 0; k + 1 < line->count; k++)
        line->length_m += hypot(line->p[k + 1][0] - line->p[k][0], line->p[k + 1][1] - line->p[k][1]);
}

/* A place along a line and the unit vector of its piece. */
static void place_along(double p[2], double d[2], const Line *line, double at_m)
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

static Status place_beside(ClutterWork *work, const Line *line, int r)
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

static Status path_add(ClutterWork *work, const double p[3])
{
    if (work->paths == work->path_room) {
        const int room = work->path_room + work->path_room / 2 + 1024;
        void     *more = realloc(work->path, (size_t)room * sizeof *work->path);
        if (!more) return STATUS_NO_MEMORY;
        work->path = more, work->path_room = room;
    }
    memcpy(work->path[work->paths++], p, 3 * sizeof(double));
    return STATUS_OK;
}

/* One side of a stretch of a line, from its vertex a to b (b < a: back), half a lane right of its middle. */
static Status path_side(ClutterWork *work, const Line *line, int a, int b)
{
    const int    step = a < b ? 1 : -1;
    Status       status = STATUS_OK;
    const double off_m = 0.5 * line->half_m;
    for (int k = a; k != b + step && status == STATUS_OK; k += step) {
        double        d[2] = {0, 0}, p[3];
        const double *from = line->p[k == a ? k : k - step], *to = line->p[k == b ? k : k + step];
        const double  run_m = hypot(to[0] - from[0], to[1] - from[1]);
        for (int c = 0; c < 2; c++) d[c] = run_m > 0 ? (to[c] - from[c]) / run_m : 0;
        p[0] = line->p[k][0] + off_m * d[1], p[1] = line->p[k][1] - off_m * d[0];
        p[2] = elevation_height(&work->config->landscape->elevation, p[0], p[1], NULL);
        if (isfinite(p[2])) status = path_add(work, p);
    }
    return status;
}

/* Whether a vehicle may pass a vertex: the exercise needs no room there. */
static bool open_at(const ClutterWork *work, const Line *line, int k)
{
    static const double radius_m = 4, height_m = 4;
    const double       *p = line->p[k];
    return isfinite(elevation_height(&work->config->landscape->elevation, p[0], p[1], NULL)) &&
           clutter_keeps_clear(work->spots, p[0], p[1], radius_m, height_m);
}

static int by_rank(const void *pa, const void *pb)
{
    const ClutterThing *a = pa, *b = pb;
    return (a->rank > b->rank) - (a->rank < b->rank);
}

/* What drives on a stretch of a line: one number for each row, at equal speeds, at distances that leave room. */
static Status place_riders(ClutterWork *work, const Line *whole, int a, int b)
{
    static const double least_m = 120, room_m = 40; /* of a stretch; of a vehicle */
    Line                line = *whole;
    ClutterThing        rider[most_riders];
    int                 riders = 0;
    line.p += a, line.count = b - a + 1;
    measure(&line);
    if (!(line.length_m >= least_m)) return STATUS_OK;
    const uint64_t key = invented_hash(whole->key, a, 4);
    for (int r = 0; r < work->table.rows; r++) {
        const ClutterRow *row = &work->table.row[r];
        if (row->where != line.kind || row->heat != CLUTTER_DRIVES) continue;
        const uint64_t of = clutter_hash(work, r, (int64_t)key, 3, 0);
        const int      count =
            clutter_poisson(work->config->density * row->density * 1e-3 * line.length_m, clutter_unit(of, 0));
        for (int k = 0; k < count && riders < most_riders; k++) {
            const uint64_t h = invented_hash(of, k + 1, 9);
            rider[riders++] = (ClutterThing){.rank = h, .row = r, .variant = clutter_variant_of(work, r, h)};
        }
    }
    qsort(rider, (size_t)riders, sizeof *rider, by_rank);
    const double loop_m = 2 * line.length_m;
    if (riders > loop_m / room_m) riders = (int)(loop_m / room_m);
    if (riders == 0) return STATUS_OK;
    const int first = work->paths;
    Status    status = path_side(work, &line, 0, line.count - 1);
    if (status == STATUS_OK) status = path_side(work, &line, line.count - 1, 0);
    if (work->paths - first < 2) return status; /* beyond the ground */
    const double speed_mps = clutter_speed_mps[line.kind] * (0.8 + 0.4 * clutter_unit(key, 1));
    for (int k = 0; k < riders && status == STATUS_OK; k++) {
        ClutterThing *t = &rider[k];
        const double  spare_m = loop_m / riders - 0.5 * room_m;
        SceneryMover  mover = {.first = 0, .count = work->paths - first, .speed_mps = speed_mps};
        const Scenery at = {.path_enu = work->path + first};
        double        p[3], pose[9];
        mover.phase_m = loop_m * k / riders + spare_m * clutter_unit(t->rank, 2);
        scenery_pose(p, pose, &at, &mover, 0);
        t->x_m = p[0], t->y_m = p[1], t->heading_rad = atan2(pose[0], pose[3]);
        t->path = first, t->path_count = mover.count;
        t->speed_mps = (float)speed_mps, t->phase_m = (float)mover.phase_m;
        if (clutter_in_square(work->config, p[0], p[1], 0)) status = clutter_add(work, *t);
    }
    return status;
}

static Status place_line(ClutterWork *work, Line *line)
{
    Status status = STATUS_OK;
    bool   drives = false, near = false;
    for (int k = 0; k < line->count && !near; k++)
        near = clutter_in_square(work->config, line->p[k][0], line->p[k][1], 200);
    if (!near) return STATUS_OK;
    measure(line);
    for (int r = 0; r < work->table.rows && status == STATUS_OK; r++) {
        const ClutterRow *row = &work->table.row[r];
        if (row->where != line->kind) continue;
        drives |= row->heat == CLUTTER_DRIVES;
        if (row->heat != CLUTTER_DRIVES) status = place_beside(work, line, r);
    }
    for (int k = 0, from = 0; drives && k <= line->count && status == STATUS_OK; k++) {
        if (k < line->count && open_at(work, line, k)) continue;
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
        WayPlace place;
        Line     line = {.p = vertex, .count = count, .kind = of[kind], .key = (uint64_t)way + 1};
        if (line.kind == CLUTTER_PLACES) continue;
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
        Line line = {.p = vertex, .half_m = 0.5 * (double)l->width_m, .key = l->id ^ 0x5bd1e995u};
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
