/* entities/shapes/mesh_loft.c: bodies drawn through cross sections, and bands around wheels. */
#include "entities/shapes/mesh_builder_private.h"

#include <assert.h>
#include <stdlib.h>

/* ---- lofts ------------------------------------------------------------------------------------ */

enum { wheel_capacity = 16 };

enum { loft_width, loft_top, loft_bottom, loft_fields };

static double station_field(const Station *s, int field)
{
    return field == loft_width ? s->half_width : field == loft_top ? s->top : s->bottom;
}

/* Slope of a field at a station: monotone cubic, harmonic mean of the neighbouring slopes (Fritsch and
 * Butland, SIAM J. Sci. Stat. Comput. 5, 1984), one-sided at the ends. */
static double station_slope(const Station *s, int count, int i, int field)
{
    const double here = station_field(&s[i], field);
    const double before = i > 0 ? (here - station_field(&s[i - 1], field)) / (s[i].x - s[i - 1].x) : 0;
    const double after = i + 1 < count ? (station_field(&s[i + 1], field) - here) / (s[i + 1].x - s[i].x) : 0;
    if (i == 0) return after;
    if (i + 1 == count) return before;
    if (!(before * after > 0)) return 0;
    const double h0 = s[i].x - s[i - 1].x, h1 = s[i + 1].x - s[i].x;
    const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
    return (w0 + w1) / (w0 / before + w1 / after);
}

/* A section, its slopes in x, and the largest second derivative in the interval. */
typedef struct Section {
    Station at, slope;
    double  bend;
} Section;

static Section section_at(const Station *s, int count, int interval, double x)
{
    const Station *a = &s[interval], *c = a + 1;
    const double   h = c->x - a->x, t = (x - a->x) / h;
    double         value[loft_fields], slope[loft_fields], bends[loft_fields];
    for (int f = 0; f < loft_fields; f++) {
        const double p = station_field(a, f), q = station_field(c, f);
        const double u = station_slope(s, count, interval, f) * h, v = station_slope(s, count, interval + 1, f) * h;
        /* p + u t + (3d - 2u - v) t^2 + (u + v - 2d) t^3, d = q - p: exact at t = 0; t = 1 is taken as q */
        const double c2 = 3 * (q - p) - 2 * u - v, c3 = u + v - 2 * (q - p);
        value[f] = x == c->x ? q : p + t * (u + t * (c2 + t * c3));
        slope[f] = (u + t * (2 * c2 + t * 3 * c3)) / h;
        /* the second derivative is linear in t, so it is largest at an end */
        bends[f] = fmax(fabs(2 * c2), fabs(2 * c2 + 6 * c3)) / (h * h);
    }
    const double round_slope = (c->round - a->round) / h;
    /* a point moves with the width in y and between top and bottom in z; the corner's share moves too: twice
     * the product of slopes, times at most 1 - cos 45 */
    const double bend =
        hypot(bends[loft_width], fmax(bends[loft_top], bends[loft_bottom])) +
        2 * 0.3 * fabs(round_slope) * (fabs(slope[loft_width]) + fabs(slope[loft_bottom] - slope[loft_top]));
    return (Section){
        .at = {x, value[loft_width], value[loft_top], value[loft_bottom],
               x == c->x ? c->round : a->round + (x - a->x) * round_slope},
        .slope = {1, slope[loft_width], slope[loft_top], slope[loft_bottom], round_slope},
        .bend = bend,
    };
}

Station mesh_station_at(const Station *station, int count, double x)
{
    int interval = 0;
    while (interval < count - 2 && x > station[interval + 1].x) interval++;
    return section_at(station, count, interval, x).at;
}

/* One vertex of a section: corner 0 .. 3 from +y towards +z, step 0 .. steps within it. The quarter turns are
 * exact, so that corners which meet (round 1) meet to the bit. */
static void section_point(double p[3], double n[3], const Section *s, int corner, int step, int steps)
{
    static const double quarter[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const double        t = 0.5 * pi_rad * step / steps;
    const double        ct = step == steps ? 0 : cos(t), st = step == steps ? 1 : sin(t);
    const double        c = quarter[corner][0] * ct - quarter[corner][1] * st;
    const double        d = quarter[corner][1] * ct + quarter[corner][0] * st;
    const double        sign_y = corner == 0 || corner == 3 ? 1 : -1, sign_z = corner < 2 ? 1 : -1;
    const double        k = s->at.round, k1 = s->slope.round;
    const double        a = s->at.half_width, a1 = s->slope.half_width;
    const double        h = 0.5 * (s->at.bottom - s->at.top), h1 = 0.5 * (s->slope.bottom - s->slope.top);
    const double        mid = 0.5 * (s->at.bottom + s->at.top), mid1 = 0.5 * (s->slope.bottom + s->slope.top);
    const double        u = sign_y + k * (c - sign_y), v = sign_z + k * (d - sign_z); /* 1: on the full width */
    p[0] = s->at.x;
    p[1] = a * u;
    p[2] = mid + h * v;
    /* perpendicular to the tangents along x, (1, y', z'), and around, (0, -a sin, h cos) */
    const double y1 = a1 * u + a * k1 * (c - sign_y), z1 = mid1 + h1 * v + h * k1 * (d - sign_z);
    n[0] = -(h * c * y1 + a * d * z1);
    n[1] = h * c;
    n[2] = a * d;
}

void mesh_loft(MeshBuilder *b, Place place, const Station *station, int count)
{
    assert(count >= 2);
    const Warp   warp = mesh_warp(&place);
    const double sag = 0.4 * b->model.sag_m / warp.largest; /* around, and again along; see the header */
    double       corner_radius = 0;
    for (int i = 0; i < count; i++) {
        const Station *s = &station[i];
        assert(s->half_width > 0 && s->top < s->bottom && s->round > 0 && s->round <= 1 && (i == 0 || s[-1].x < s->x));
        corner_radius = fmax(corner_radius, s->round * fmax(s->half_width, 0.5 * (s->bottom - s->top)));
    }
    const int steps = (mesh_circle_sides(corner_radius, sag) + 3) / 4, sides = 4 * (steps + 1);
    uint32_t  last = 0;
    for (int i = 0; i + 1 < count; i++) {
        const double h = station[i + 1].x - station[i].x;
        /* a straight line errs by h^2 / 8 times the second derivative */
        double bend = 0;
        for (int k = 0; k <= 2; k++) bend = fmax(bend, section_at(station, count, i, station[i].x + 0.5 * k * h).bend);
        const int parts = (int)fmax(1, ceil(h * sqrt(bend / (8 * sag)) - 1e-9));
        for (int k = i == 0 ? 0 : 1; k <= parts; k++) {
            const double  x = k == parts ? station[i + 1].x : station[i].x + h * k / parts;
            const Section s = section_at(station, count, i, x);
            if (!mesh_reserve(b, sides, 2LL * sides)) return;
            const uint32_t ring = (uint32_t)b->model.vertex_count;
            for (int j = 0; j < sides; j++) {
                double p[3], n[3];
                section_point(p, n, &s, j / (steps + 1), j % (steps + 1), steps);
                mesh_add_vertex(b, &place, &warp, p, n);
            }
            if (i > 0 || k > 0) mesh_add_band(b, &warp, last, ring, sides);
            last = ring;
        }
    }
    for (int side = 0; side < 2; side++) {
        const Section s = section_at(station, count, side ? count - 2 : 0, station[side ? count - 1 : 0].x);
        const double  flat[3] = {side ? 1 : -1, 0, 0};
        if (!mesh_reserve(b, sides, sides)) return;
        const uint32_t ring = (uint32_t)b->model.vertex_count;
        for (int j = 0; j < sides; j++) {
            double p[3], n[3];
            section_point(p, n, &s, j / (steps + 1), j % (steps + 1), steps);
            mesh_add_vertex(b, &place, &warp, p, flat);
        }
        for (uint32_t j = 1; j + 1 < (uint32_t)sides; j++)
            mesh_add_triangle(b, &warp, ring, ring + (side ? j : j + 1), ring + (side ? j + 1 : j));
    }
}

/* ---- tracks ------------------------------------------------------------------------------------- */

/* A point of the band's inner line, with the outward normal, in the plane (x, up). */
typedef struct BeltPoint {
    double x, up, nx, nup;
} BeltPoint;

/* Outward normal of the straight run from wheel a to wheel c: the outer tangent, on the right of the way. */
static void belt_tangent(double n[2], const BeltWheel *a, const BeltWheel *c)
{
    const double dx = c->x - a->x, dup = a->z - c->z, d = hypot(dx, dup);
    const double s = (a->radius - c->radius) / d, t = sqrt(1 - s * s);
    n[0] = (s * dx + t * dup) / d;
    n[1] = (s * dup - t * dx) / d;
}

/* The band's inner line, closed, and where it goes. */
typedef struct BeltLine {
    const Belt  *belt;
    const Place *place;
    Warp         warp;
    BeltPoint   *point;
    int          count;
} BeltLine;

/* out_y: how far out along the band's normal, and y. */
static void belt_vertex(MeshBuilder *b, const BeltLine *line, const BeltPoint *p, const double out_y[2],
                        const double n[3])
{
    mesh_add_vertex(b, line->place, &line->warp,
                    (double[3]){p->x + out_y[0] * p->nx, out_y[1], -(p->up + out_y[0] * p->nup)}, n);
}

/* A closed strip between two lines that follow the band: (out, y) of the first, of the second, and which way
 * it faces: along the band's normal (1, -1) or along y. */
static void belt_strip(MeshBuilder *b, const BeltLine *line, const double out_y0[2], const double out_y1[2],
                       double along_normal, double along_y)
{
    const int count = line->count;
    if (!mesh_reserve(b, 2LL * count, 2LL * count)) return;
    const uint32_t first = (uint32_t)b->model.vertex_count;
    for (int i = 0; i < count; i++) {
        const BeltPoint *p = &line->point[i];
        const double     n[3] = {along_normal * p->nx, along_y, -(along_normal * p->nup)};
        belt_vertex(b, line, p, out_y0, n);
        belt_vertex(b, line, p, out_y1, n);
    }
    for (int i = 0; i < count; i++) {
        const uint32_t a = first + 2 * (uint32_t)i, c = first + 2 * (uint32_t)((i + 1) % count);
        mesh_add_triangle(b, &line->warp, a, c, c + 1);
        mesh_add_triangle(b, &line->warp, a, c + 1, a + 1);
    }
}

static void belt_cleats(MeshBuilder *b, const BeltLine *line)
{
    const Belt      *belt = line->belt;
    const Place     *place = line->place;
    const BeltPoint *point = line->point;
    const int        count = line->count;
    const double     thickness = belt->thickness;
    double           round_m = 0;
    for (int pass = 0, next = 0; pass < 2; pass++) {
        double at_m = 0;
        for (int i = 0; i < count; i++) {
            const BeltPoint *p = &point[i], *q = &point[(i + 1) % count];
            const double     px = p->x + thickness * p->nx, pup = p->up + thickness * p->nup;
            const double     dx = q->x + thickness * q->nx - px, dup = q->up + thickness * q->nup - pup;
            const double     run = hypot(dx, dup);
            for (; pass == 1 && next < belt->cleats && round_m * next / belt->cleats < at_m + run && run > 0; next++) {
                const double s = (round_m * next / belt->cleats - at_m) / run;
                /* shape z along the band's own normal, which turns with the bend even where facets are long;
                 * shape x along its tangent; sunk by a fifth of the band so that it never floats */
                const double n = hypot(p->nx + s * (q->nx - p->nx), p->nup + s * (q->nup - p->nup));
                const double nx = (p->nx + s * (q->nx - p->nx)) / n, nup = (p->nup + s * (q->nup - p->nup)) / n;
                const double local[9] = {-nup, 0, nx, 0, 1, 0, -nx, 0, -nup};
                const double p_shape[3] = {px + s * dx, 0, -(pup + s * dup)};
                double       m[9];
                Place        cleat;
                m3_mul(m, place->m, local);
                memcpy(cleat.m, m, sizeof m);
                mesh_place_point(cleat.p, place, p_shape);
                mesh_box(b, cleat, -0.5 * belt->cleat_length, belt->y0, -0.2 * thickness, 0.5 * belt->cleat_length,
                         belt->y1, belt->cleat_height);
            }
            at_m += run;
        }
        round_m = at_m;
    }
}

void mesh_belt(MeshBuilder *b, Place place, const BeltWheel *wheel, int count, const Belt *belt)
{
    const double thickness = belt->thickness, y0 = belt->y0, y1 = belt->y1;
    assert(count >= 2 && count <= wheel_capacity && thickness > 0 && y0 < y1);
    const Warp   warp = mesh_warp(&place);
    const double sag = b->model.sag_m / warp.largest;
    BeltWheel    w[wheel_capacity];
    double       area = 0;
    int          point_count = 0;
    for (int i = 0; i < count; i++) {
        const BeltWheel *p = &wheel[i], *q = &wheel[(i + 1) % count];
        area += q->x * p->z - p->x * q->z; /* in (x, up = -z) */
    }
    for (int i = 0; i < count; i++) w[i] = wheel[area > 0 || count == 2 ? i : count - 1 - i];

    BeltPoint *point = NULL;
    int        capacity = 0;
    for (int i = 0; i < count; i++) {
        const BeltWheel *a = &w[(i + count - 1) % count], *c = &w[i], *e = &w[(i + 1) % count];
        double           n0[2], n1[2];
        belt_tangent(n0, a, c);
        belt_tangent(n1, c, e);
        const double from = atan2(n0[1], n0[0]);
        double       turn = atan2(n0[0] * n1[1] - n0[1] * n1[0], n0[0] * n1[0] + n0[1] * n1[1]);
        if (turn < 0) turn += 2 * pi_rad;
        const int steps = (int)fmax(1, ceil(turn / mesh_chord_angle(c->radius + thickness, sag) - 1e-9));
        if (!mesh_grow(b, &point, &capacity, point_count + steps + 1, sizeof *point)) break;
        for (int k = 0; k <= steps; k++) {
            const double angle = from + turn * k / steps, nx = cos(angle), nup = sin(angle);
            point[point_count++] = (BeltPoint){c->x + c->radius * nx, -c->z + c->radius * nup, nx, nup};
        }
    }
    if (b->status == STATUS_OK) {
        const BeltLine line = {belt, &place, warp, point, point_count};
        const double inner0[2] = {0, y0}, inner1[2] = {0, y1}, outer0[2] = {thickness, y0}, outer1[2] = {thickness, y1};
        belt_strip(b, &line, outer0, outer1, 1, 0);
        belt_strip(b, &line, inner1, inner0, -1, 0);
        belt_strip(b, &line, inner0, outer0, 0, -1);
        belt_strip(b, &line, outer1, inner1, 0, 1);
        if (belt->cleats > 0) belt_cleats(b, &line);
    }
    free(point);
}
