/* entities/scenery/scenery_lines.c: works along lines: walls, fences, power lines, bridges.
 *
 * A line is cut into pieces of about the length of its kind's posts, between stations that all cells know alike; a run
 * of pieces in one cell is one band. What stands at a station belongs to the piece that begins there; the last piece
 * has the end's too. Diameters are true: 3 mm of fence wire, 12 mm of conductors; a sensor that cannot resolve them
 * sees them alias. */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdlib.h>

enum { pieces_most = 4096, run_stations = 260, sag_pieces = 10 };

/* About how far apart the stations of a kind are; 0: only its corners. Negative: nothing is seen. */
static double spacing_m(int kind)
{
    static const double of[CULTURE_LINE_KINDS] = {
        [CULTURE_WALL] = 8,  [CULTURE_FENCE] = 2.7, [CULTURE_WIRE_FENCE] = 4, [CULTURE_BRIDGE] = 8,
        [CULTURE_ROAD] = -1, [CULTURE_TRACK] = -1,  [CULTURE_WATER] = -1,     [CULTURE_YARD] = -1};
    return of[kind];
}

/* Pieces between corner k and the next; 0: they are one place. */
static int pieces_of(const Culture *c, const CultureLine *line, int k)
{
    const double *a = c->corner_m[line->first_corner + k], *b = c->corner_m[line->first_corner + k + 1];
    const double  length_m = hypot(b[0] - a[0], b[1] - a[1]), step_m = spacing_m(line->kind);
    if (!(length_m > 1e-3)) return 0;
    return step_m > 0 ? (int)clamp(ceil(length_m / step_m - 0.05), 1, pieces_most) : 1;
}

int line_pieces(const Culture *c, const CultureLine *line)
{
    int pieces = 0;
    if (spacing_m(line->kind) < 0) return 0;
    for (int k = 0; k + 1 < line->corners; k++) pieces += pieces_of(c, line, k);
    return pieces;
}

/* Walks along a line from station to station. */
typedef struct Walk {
    const Culture     *c;
    const CultureLine *line;
    int                corner, piece; /* the station is `piece` pieces after this corner */
} Walk;

static const double *corner_of(const Walk *w, int k) { return w->c->corner_m[w->line->first_corner + k]; }

/* From where the last walk was, unless that is behind the piece. */
static Walk walk_to(LineCursor *at, const Culture *c, const CultureLine *line, int piece)
{
    if (piece < at->before) *at = (LineCursor){0, 0};
    for (int n = pieces_of(c, line, at->corner); piece - at->before >= n && at->corner + 2 < line->corners;
         n = pieces_of(c, line, at->corner))
        at->before += n, at->corner++;
    return (Walk){c, line, at->corner, piece - at->before};
}

static void place_of(double p[2], const Walk *w)
{
    const double *a = corner_of(w, w->corner), *b = corner_of(w, w->corner + 1);
    const int     pieces = pieces_of(w->c, w->line, w->corner);
    const double  share = pieces > 0 ? (double)w->piece / pieces : 0;
    for (int k = 0; k < 2; k++) p[k] = share < 1 ? a[k] + share * (b[k] - a[k]) : b[k];
}

void line_piece_middle(double xy_m[2], LineCursor *at, const Culture *c, const CultureLine *line, int piece)
{
    const Walk from = walk_to(at, c, line, piece), to = walk_to(at, c, line, piece + 1);
    double     a[2], b[2];
    place_of(a, &from), place_of(b, &to);
    for (int k = 0; k < 2; k++) xy_m[k] = 0.5 * (a[k] + b[k]);
}

static bool way(double d[2], const double a[2], const double b[2])
{
    const double length = hypot(b[0] - a[0], b[1] - a[1]);
    if (!(length > 1e-3)) return false;
    d[0] = (b[0] - a[0]) / length, d[1] = (b[1] - a[1]) / length;
    return true;
}

/* Left at a station: at a corner that of both its pieces, longer by the mitre, by 2 at most. */
static void set_left(Station *s, const Walk *w)
{
    double d[2] = {1, 0}, before[2];
    int    last = w->corner;
    way(d, corner_of(w, w->corner), corner_of(w, w->corner + 1));
    const int pieces = pieces_of(w->c, w->line, w->corner);
    bool      turns = false;
    memcpy(before, d, sizeof before);
    if (w->piece == 0)
        while (last > 0 && !turns) last--, turns = way(before, corner_of(w, last), corner_of(w, last + 1));
    if (w->piece == pieces)
        for (last = w->corner + 1; last + 1 < w->line->corners && !turns; last++)
            turns = way(before, corner_of(w, last), corner_of(w, last + 1));
    const double whole = turns ? fmax(1 + d[0] * before[0] + d[1] * before[1], 0.5) : 2;
    s->left[0] = -(d[1] + before[1]) / whole, s->left[1] = (d[0] + before[0]) / whole;
    if (hypot(s->left[0], s->left[1]) < 0.5) s->left[0] = -d[1], s->left[1] = d[0]; /* it turns back */
}

static double ground_at(const WorksGround *g, const double p[2])
{
    const double z_m = g->ground_m ? g->ground_m(g->user, p[0] + g->origin[0], p[1] + g->origin[1]) : g->origin[2];
    return isfinite(z_m) ? z_m - g->origin[2] : 0;
}

static Station station_at(LineCursor *at, const Culture *c, const CultureLine *line, int piece, const WorksGround *g)
{
    const Walk w = walk_to(at, c, line, piece);
    Station    s;
    double     p[2];
    place_of(p, &w);
    for (int k = 0; k < 2; k++) s.p[k] = p[k] - g->origin[k];
    s.p[2] = ground_at(g, s.p);
    set_left(&s, &w);
    return s;
}

/* ---- the kinds ------------------------------------------------------------------------------------ */

typedef struct Run {
    CellMesh          *cell;
    const CultureLine *line;
    Station            station[run_stations];
    int                stations;
    bool               ends; /* the last station is the line's */
    const WorksGround *ground;
} Run;

static double or_usual(float given_m, double usual_m) { return given_m > 0 ? (double)given_m : usual_m; }

static void make_wall(const Run *r)
{
    static const char *const of[3] = {"stone_wall_grey", "stone_wall_buff", "brick_red"};
    const int                kind = (int)(3 * record_random(r->line->id, 1));
    const double             high_m = or_usual(r->line->height_m, 1.2), half_m = 0.5 * or_usual(r->line->width_m, 0.4);
    const int                slot = cell_part(r->cell, "wall", of[kind < 3 ? kind : 2], HEAT_PASSIVE);
    cell_sweep(r->cell, slot, r->station, r->stations, &(Section){0, half_m, -0.4, high_m});
}

static void make_posts(const Run *r, double high_m, double half_m, int slot)
{
    for (int k = 0; k < r->stations - !r->ends; k++) {
        const Station *s = &r->station[k];
        const double   length = hypot(s->left[0], s->left[1]), along[2] = {s->left[1] / length, -s->left[0] / length};
        cell_box(r->cell, slot, s->p, along, half_m, half_m, s->p[2] - 0.4, s->p[2] + high_m);
    }
}

static void make_fence(const Run *r)
{
    static const double at[3] = {0.3, 0.62, 0.92};
    const char         *material = record_random(r->line->id, 1) < 0.7 ? "timber_weathered" : "paint_white_wood";
    const double        high_m = or_usual(r->line->height_m, 1.2);
    const int           post = cell_part(r->cell, "post", material, HEAT_PASSIVE);
    const int           rail = cell_part(r->cell, "rail", material, HEAT_PASSIVE);
    make_posts(r, high_m, 0.055, post);
    for (int k = 0; k < (high_m > 0.9 ? 3 : 2); k++) {
        const double z = at[k + (high_m > 0.9 ? 0 : 1)] * high_m;
        /* on the outside of the posts */
        cell_sweep(r->cell, rail, r->station, r->stations, &(Section){0.07, 0.018, z - 0.05, z + 0.05});
    }
}

static void make_wire_fence(const Run *r)
{
    static const double wire_m = 0.0015; /* radius */
    const double        high_m = or_usual(r->line->height_m, 1.1);
    const bool          steel = high_m > 1.5;
    const int post = cell_part(r->cell, "post", steel ? "metal_steel_galvanized" : "timber_weathered", HEAT_PASSIVE);
    const int wire = cell_part(r->cell, "wire", "metal_steel_galvanized", HEAT_PASSIVE);
    make_posts(r, high_m + 0.1, steel ? 0.03 : 0.05, post);
    const int wires = (int)clamp(ceil(high_m / 0.3), 3, 8);
    for (int k = 1; k <= wires; k++) {
        const double z = high_m * k / wires;
        cell_sweep(r->cell, wire, r->station, r->stations, &(Section){0, wire_m, z - wire_m, z + wire_m});
    }
}

/* Wires on poles with a crossarm; of tall lines on lattice towers with two. A wire hangs as a parabola of a fiftieth of
 * its span, but by no more than a third of the poles' height: files leave out poles that stand in a straight line. */
static void make_power_line(const Run *r)
{
    static const double sag = 0.02, deepest = 0.35; /* of the span, of the height */
    const double        high_m = or_usual(r->line->height_m, 9);
    const bool          tall = high_m > 16;
    const double        arm_m = tall ? 0.14 * high_m : 1.1, radius_m = tall ? 0.014 : 0.006;
    const int post = cell_part(r->cell, "post", tall ? "metal_steel_galvanized" : "timber_stained", HEAT_PASSIVE);
    const int wire = cell_part(r->cell, "wire", "metal_aluminium_bare", HEAT_PASSIVE);
    const int arms = tall ? 2 : 1, wires = tall ? 4 : 3;
    for (int k = 0; k < r->stations - !r->ends; k++) {
        const Station *s = &r->station[k];
        const double   length = hypot(s->left[0], s->left[1]), left[2] = {s->left[0] / length, s->left[1] / length};
        if (tall) cell_lattice(r->cell, post, s->p, left, high_m, 0.08 * high_m, 0.02 * high_m);
        else cell_pole(r->cell, post, s->p, high_m, 0.14);
        for (int a = 0; a < arms; a++) {
            const double z = s->p[2] + high_m * (a == 0 ? 0.97 : 0.82);
            const double p[2][3] = {{s->p[0] - arm_m * left[0], s->p[1] - arm_m * left[1], z},
                                    {s->p[0] + arm_m * left[0], s->p[1] + arm_m * left[1], z}};
            cell_bar(r->cell, post, p[0], p[1], tall ? 0.12 : 0.06);
        }
    }
    for (int k = 0; k + 1 < r->stations; k++)
        for (int n = 0; n < wires; n++) {
            const double   across = tall ? (n % 2 ? 0.95 : -0.95) * arm_m : (n - 1) * 0.9 * arm_m;
            const double   z = high_m * (n < 2 || !tall ? 0.97 : 0.82) + (tall ? -1.5 : 0.2); /* insulators */
            const Station *a = &r->station[k], *b = &r->station[k + 1];
            Station        part[sag_pieces + 1];
            const double   span_m = hypot(b->p[0] - a->p[0], b->p[1] - a->p[1]);
            const double   sag_m = fmin(sag * span_m, deepest * high_m);
            for (int i = 0; i <= sag_pieces; i++) {
                const double t = (double)i / sag_pieces;
                for (int c = 0; c < 3; c++) part[i].p[c] = i < sag_pieces ? a->p[c] + t * (b->p[c] - a->p[c]) : b->p[c];
                part[i].p[2] += z - 4 * sag_m * t * (1 - t);
                for (int c = 0; c < 2; c++) {
                    const double la = a->left[c] / hypot(a->left[0], a->left[1]),
                                 lb = b->left[c] / hypot(b->left[0], b->left[1]);
                    part[i].p[c] += across * (la + t * (lb - la));
                    part[i].left[c] = c == 0 ? -(b->p[1] - a->p[1]) / span_m : (b->p[0] - a->p[0]) / span_m;
                }
            }
            cell_sweep(r->cell, wire, part, sag_pieces + 1, &(Section){0, radius_m, -radius_m, radius_m});
        }
}

/* The deck at the height of the ground at the line's ends, straight between them. */
static void make_bridge(Run *r, const Culture *c, int first)
{
    const int     pieces = line_pieces(c, r->line);
    LineCursor    at = {0};
    const Station from = station_at(&at, c, r->line, 0, r->ground), to = station_at(&at, c, r->line, pieces, r->ground);
    const double  half_m = 0.5 * or_usual(r->line->width_m, 6), thick_m = clamp(0.12 * half_m + 0.4, 0.5, 1.5);
    const int     deck = cell_part(r->cell, "deck", "concrete_weathered", HEAT_PASSIVE);
    const int rail = cell_part(r->cell, "rail", half_m > 2 ? "concrete_panel" : "metal_steel_galvanized", HEAT_PASSIVE);
    const int pier = cell_part(r->cell, "base", "concrete_weathered", HEAT_PASSIVE);
    for (int k = 0; k < r->stations; k++) {
        Station     *s = &r->station[k];
        const double ground_m = s->p[2];
        s->p[2] = from.p[2] + (to.p[2] - from.p[2]) * (first + k) / pieces;
        const double length = hypot(s->left[0], s->left[1]), along[2] = {s->left[1] / length, -s->left[0] / length};
        const bool   here = k + 1 < r->stations && (first + k) % 2 == 0 && first + k > 0;
        if (here && s->p[2] - thick_m - ground_m > 1)
            cell_box(r->cell, pier, s->p, along, 0.4 + 0.05 * half_m, 0.75 * half_m, ground_m - 1,
                     s->p[2] - 0.5 * thick_m);
    }
    cell_sweep(r->cell, deck, r->station, r->stations, &(Section){0, half_m, -thick_m, 0});
    for (int side = -1; side <= 1; side += 2)
        cell_sweep(r->cell, rail, r->station, r->stations, &(Section){side * (half_m - 0.14), 0.12, -0.1, 0.95});
}

void line_make(CellMesh *cell, const Culture *c, const CultureLine *line, int first, int count,
               const WorksGround *ground)
{
    Run *r = calloc(1, sizeof *r);
    if (!r) {
        cell->status = STATUS_NO_MEMORY;
        return;
    }
    r->cell = cell, r->line = line, r->ground = ground;
    r->stations = count + 1;
    r->ends = first + count == line_pieces(c, line);
    LineCursor at = {0};
    for (int k = 0; k <= count; k++) r->station[k] = station_at(&at, c, line, first + k, ground);
    cell_begin(cell, line->id);
    switch ((CultureLineKind)line->kind) {
    case CULTURE_WALL:
        make_wall(r);
        break;
    case CULTURE_FENCE:
        make_fence(r);
        break;
    case CULTURE_WIRE_FENCE:
        make_wire_fence(r);
        break;
    case CULTURE_POWER_LINE:
        make_power_line(r);
        break;
    case CULTURE_BRIDGE:
        make_bridge(r, c, first);
        break;
    default:
        break;
    }
    cell_end(cell);
    free(r);
}
