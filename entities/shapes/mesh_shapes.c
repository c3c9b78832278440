/* entities/shapes/mesh_shapes.c: bodies of revolution and flat-faced shapes. */
#include "entities/shapes/mesh_builder_private.h"

#include <assert.h>
#include <stdlib.h>

enum { outline_capacity = 64 };

/* ---- bodies of revolution -------------------------------------------------------------------- */

void mesh_profile_begin(MeshBuilder *b, double x, double r)
{
    b->piece_count = 0;
    b->begin_x = b->at_x = x;
    b->begin_r = b->at_r = r;
}

static Piece *next_piece(MeshBuilder *b)
{
    assert(b->piece_count < meridian_capacity);
    Piece *piece = &b->piece[b->piece_count++];
    *piece = (Piece){.x0 = b->at_x, .r0 = b->at_r};
    return piece;
}

void mesh_profile_line(MeshBuilder *b, double x, double r)
{
    Piece *piece = next_piece(b);
    piece->x1 = b->at_x = x;
    piece->r1 = b->at_r = r;
}

void mesh_profile_arc(MeshBuilder *b, double cx, double cr, double turn_rad)
{
    Piece *piece = next_piece(b);
    piece->cx = cx;
    piece->cr = cr;
    piece->radius = hypot(piece->x0 - cx, piece->r0 - cr);
    piece->from_rad = atan2(piece->r0 - cr, piece->x0 - cx);
    piece->turn_rad = turn_rad;
    piece->x1 = cx + piece->radius * cos(piece->from_rad + turn_rad);
    piece->r1 = cr + piece->radius * sin(piece->from_rad + turn_rad);
    /* an arc that means to end on the axis ends there */
    if (fabs(piece->r1) < 1e-9) piece->r1 = 0;
    b->at_x = piece->x1;
    b->at_r = piece->r1;
}

typedef struct Lathe {
    MeshBuilder *b;
    const Place *place;
    const Warp  *warp;
    int          sides;
    double      *unit;      /* cosines and sines [sides][2] */
    uint32_t     last_ring; /* ring at the end of the last strip, and its meridian point and normal */
    double       last[4];
    bool         has_last;
} Lathe;

static uint32_t lathe_ring(Lathe *l, double x, double r, double nx, double nr)
{
    const uint32_t first = (uint32_t)l->b->model.vertex_count;
    for (int j = 0; j < l->sides; j++) {
        const double c = l->unit[2 * j], s = l->unit[2 * j + 1];
        mesh_add_vertex(l->b, l->place, l->warp, (double[3]){x, r * c, r * s}, (double[3]){nx, nr * c, nr * s});
    }
    return first;
}

/* A conical strip; the ring before is shared where the surface runs on smoothly. */
static void lathe_strip(Lathe *l, const double from[4], const double to[4])
{
    if (!mesh_reserve(l->b, 2LL * l->sides, 2LL * l->sides)) return;
    const bool     shared = l->has_last && !memcmp(l->last, from, sizeof l->last);
    const uint32_t ring0 = shared ? l->last_ring : lathe_ring(l, from[0], from[1], from[2], from[3]);
    const uint32_t ring1 = lathe_ring(l, to[0], to[1], to[2], to[3]);
    mesh_add_band(l->b, l->warp, ring0, ring1, l->sides);
    memcpy(l->last, to, sizeof l->last);
    l->last_ring = ring1;
    l->has_last = true;
}

void mesh_lathe(MeshBuilder *b, Place place)
{
    const Warp warp = mesh_warp(&place);
    double     radius = 0;
    bool       curved = false;
    assert(b->piece_count > 0);
    for (int i = 0; i < b->piece_count; i++) {
        const Piece *p = &b->piece[i];
        radius = fmax(radius, fmax(p->r0, p->r1));
        if (p->radius > 0) {
            curved = true;
            /* the arc's own top, when it passes there: a quarter turn lies between its ends */
            const double to_top = p->turn_rad < 0 ? p->from_rad - 0.5 * pi_rad : 0.5 * pi_rad - p->from_rad;
            const double ahead = to_top < 0 ? to_top + 2 * pi_rad : to_top;
            if (ahead <= fabs(p->turn_rad)) radius = fmax(radius, p->cr + p->radius);
        }
    }
    /* closed: both ends on the axis, or the end at the beginning */
    const Piece *end = &b->piece[b->piece_count - 1];
    assert((b->begin_r == 0 && end->r1 == 0) || hypot(end->x1 - b->begin_x, end->r1 - b->begin_r) < 1e-9);

    const double sag = b->model.sag_m / warp.largest / (curved ? 2 : 1);
    Lathe        l = {.b = b, .place = &place, .warp = &warp, .sides = mesh_circle_sides(radius, sag)};
    l.unit = malloc((size_t)l.sides * 2 * sizeof *l.unit);
    if (!l.unit) {
        b->status = STATUS_NO_MEMORY;
        return;
    }
    for (int j = 0; j < l.sides; j++) {
        l.unit[2 * j] = cos(2 * pi_rad * j / l.sides);
        l.unit[2 * j + 1] = sin(2 * pi_rad * j / l.sides);
    }
    for (int i = 0; i < b->piece_count; i++) {
        const Piece *p = &b->piece[i];
        /* the last point of a ring is its first, to the bit */
        const bool   closes = i == b->piece_count - 1 && b->begin_r != 0;
        const double x1 = closes ? b->begin_x : p->x1, r1 = closes ? b->begin_r : p->r1;
        if (!(p->radius > 0)) {
            const double dx = x1 - p->x0, dr = r1 - p->r0, length = hypot(dx, dr);
            if (!(length > 0)) continue;
            lathe_strip(&l, (double[4]){p->x0, p->r0, -dr / length, dx / length},
                        (double[4]){x1, r1, -dr / length, dx / length});
            continue;
        }
        const double step = mesh_chord_angle(p->radius, sag);
        const int    steps = (int)fmax(1, ceil(fabs(p->turn_rad) / step - 1e-9));
        const double facing = p->turn_rad < 0 ? 1 : -1; /* a hollow faces its centre */
        double       from[4] = {p->x0, p->r0, facing * cos(p->from_rad), facing * sin(p->from_rad)};
        for (int k = 1; k <= steps; k++) {
            const double a = p->from_rad + p->turn_rad * k / steps;
            double to[4] = {p->cx + p->radius * cos(a), p->cr + p->radius * sin(a), facing * cos(a), facing * sin(a)};
            if (k == steps) {
                to[0] = x1;
                to[1] = r1;
            }
            lathe_strip(&l, from, to);
            memcpy(from, to, sizeof from);
        }
    }
    free(l.unit);
}

void mesh_cone(MeshBuilder *b, Place place, double x0, double r0, double x1, double r1)
{
    assert(x0 < x1);
    mesh_profile_begin(b, x0, 0);
    mesh_profile_line(b, x0, r0);
    mesh_profile_line(b, x1, r1);
    mesh_profile_line(b, x1, 0);
    mesh_lathe(b, place);
}

void mesh_cylinder(MeshBuilder *b, Place place, double x0, double x1, double radius)
{
    mesh_cone(b, place, x0, radius, x1, radius);
}

void mesh_tube(MeshBuilder *b, Place place, double x0, double x1, double radius, double bore)
{
    assert(x0 < x1 && bore < radius);
    mesh_profile_begin(b, x0, bore);
    mesh_profile_line(b, x0, radius);
    mesh_profile_line(b, x1, radius);
    mesh_profile_line(b, x1, bore);
    mesh_profile_line(b, x0, bore);
    mesh_lathe(b, place);
}

void mesh_sphere(MeshBuilder *b, Place place, double radius)
{
    mesh_profile_begin(b, -radius, 0);
    mesh_profile_arc(b, 0, 0, -pi_rad);
    mesh_lathe(b, place);
}

void mesh_bar(MeshBuilder *b, const double from[3], const double to[3], double radius)
{
    double d[3];
    v3_sub(d, to, from);
    mesh_cylinder(b, place_axis(from[0], from[1], from[2], d[0], d[1], d[2]), 0, v3_length(d), radius);
}

/* ---- flat-faced shapes ------------------------------------------------------------------------ */

/* A flat triangle with its own three vertices. */
static void add_facet(MeshBuilder *b, const Place *place, const Warp *warp, const double p[3], const double q[3],
                      const double r[3])
{
    double u[3], v[3], n[3];
    v3_sub(u, q, p);
    v3_sub(v, r, p);
    v3_cross(n, u, v);
    if (!(v3_length(n) > 0)) return; /* an edge that has shrunk to a point: see mesh_add_triangle */
    const uint32_t first = mesh_add_vertex(b, place, warp, p, n);
    mesh_add_vertex(b, place, warp, q, n);
    mesh_add_vertex(b, place, warp, r, n);
    mesh_add_triangle(b, warp, first, first + 1, first + 2);
}

static double cross2(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Ears off a counter-clockwise simple polygon: count - 2 triangles. O(n^3) at worst, n <= 64. */
static void clip_ears(int (*triangle)[3], int count, const double (*p)[2])
{
    int left[outline_capacity], remaining = count, made = 0;
    for (int i = 0; i < count; i++) left[i] = i;
    while (remaining > 3) {
        int ear = -1;
        for (int i = 0; i < remaining && ear < 0; i++) {
            const int a = left[(i + remaining - 1) % remaining], v = left[i], c = left[(i + 1) % remaining];
            bool      free_of_others = cross2(p[a], p[v], p[c]) > 0;
            for (int k = 0; k < remaining && free_of_others; k++) {
                const int o = left[k];
                if (o == a || o == v || o == c) continue;
                free_of_others =
                    cross2(p[a], p[v], p[o]) < 0 || cross2(p[v], p[c], p[o]) < 0 || cross2(p[c], p[a], p[o]) < 0;
            }
            if (free_of_others) ear = i;
        }
        assert(ear >= 0); /* the outline intersects itself: a programming error */
        triangle[made][0] = left[(ear + remaining - 1) % remaining];
        triangle[made][1] = left[ear];
        triangle[made][2] = left[(ear + 1) % remaining];
        made++;
        remaining--;
        for (int k = ear; k < remaining; k++) left[k] = left[k + 1];
    }
    for (int k = 0; k < 3; k++) triangle[made][k] = left[k];
}

void mesh_slab(MeshBuilder *b, Place place, int count, const double (*at_y0)[2], double y0, const double (*at_y1)[2],
               double y1)
{
    assert(count >= 3 && count <= outline_capacity && y0 < y1);
    double p[2][outline_capacity][3], outline[outline_capacity][2], area = 0;
    int    face[outline_capacity][3];
    for (int i = 0; i < count; i++) {
        const double *u = at_y0[i], *v = at_y0[(i + 1) % count];
        area += u[0] * v[1] - v[0] * u[1];
    }
    for (int i = 0; i < count; i++) {
        const int    k = area > 0 ? i : count - 1 - i; /* counter-clockwise in (x, z), which is seen from -y */
        const double a[3] = {at_y0[k][0], y0, at_y0[k][1]}, c[3] = {at_y1[k][0], y1, at_y1[k][1]};
        memcpy(p[0][i], a, sizeof a);
        memcpy(p[1][i], c, sizeof c);
        outline[i][0] = a[0];
        outline[i][1] = a[2];
    }
    clip_ears(face, count, (const double(*)[2])outline);
    if (!mesh_reserve(b, 12LL * count, 4LL * count)) return;
    const Warp warp = mesh_warp(&place);
    for (int t = 0; t < count - 2; t++) {
        add_facet(b, &place, &warp, p[0][face[t][0]], p[0][face[t][1]], p[0][face[t][2]]);
        add_facet(b, &place, &warp, p[1][face[t][0]], p[1][face[t][2]], p[1][face[t][1]]);
    }
    for (int i = 0; i < count; i++) {
        const int k = (i + 1) % count;
        add_facet(b, &place, &warp, p[0][i], p[1][i], p[1][k]);
        add_facet(b, &place, &warp, p[0][i], p[1][k], p[0][k]);
    }
}

void mesh_prism(MeshBuilder *b, Place place, int count, const double (*outline)[2], double y0, double y1)
{
    mesh_slab(b, place, count, outline, y0, outline, y1);
}

void mesh_box(MeshBuilder *b, Place place, double x0, double y0, double z0, double x1, double y1, double z1)
{
    assert(x0 < x1 && z0 < z1);
    const double outline[4][2] = {{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}};
    mesh_prism(b, place, 4, outline, y0, y1);
}
