#include "entities/mesh_builder.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

enum { meridian_capacity = 64, outline_capacity = 64, wheel_capacity = 16, sides_least = 8, sides_most = 4096 };

/* One piece of a meridian: a line when radius is 0, else an arc about (cx, cr). */
typedef struct Piece {
    double x0, r0, x1, r1;
    double cx, cr, radius, from_rad, turn_rad;
} Piece;

struct MeshBuilder {
    Model  model;
    int    node_capacity, part_capacity, vertex_capacity, triangle_capacity;
    Status status;
    double begin_x, begin_r, at_x, at_r; /* meridian being drawn */
    int    piece_count;
    Piece  piece[meridian_capacity];
};

/* ---- places --------------------------------------------------------------------------------- */

Place place_at(double x, double y, double z)
{
    Place place = {{x, y, z}, {0}};
    m3_identity(place.m);
    return place;
}

Place place_axis(double x, double y, double z, double dx, double dy, double dz)
{
    Place  place = place_at(x, y, z);
    double d[3] = {dx, dy, dz}, side[3], third[3];
    const bool ok = v3_normalize(d, d);
    assert(ok);
    (void)ok;
    /* shape y is the body axis least along d, made perpendicular: a right angle stays exactly one */
    const double ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]);
    double other[3] = {0, 0, 0};
    other[ay <= ax && ay <= az ? 1 : az <= ax ? 2 : 0] = 1;
    v3_add_scaled(side, other, -v3_dot(other, d), d);
    v3_normalize(side, side);
    v3_cross(third, d, side);
    for (int i = 0; i < 3; i++) {
        place.m[3 * i]     = d[i];
        place.m[3 * i + 1] = side[i];
        place.m[3 * i + 2] = third[i];
    }
    return place;
}

Place place_scaled(Place place, double sx, double sy, double sz)
{
    const double s[3] = {sx, sy, sz};
    for (int i = 0; i < 9; i++) place.m[i] *= s[i % 3];
    return place;
}

static void rotation_about(double r[9], const double axis[3], double angle_rad)
{
    const double c = cos(angle_rad), s = sin(angle_rad), v = 1 - c;
    const double x = axis[0], y = axis[1], z = axis[2];
    const double m[9] = {c + v * x * x,     v * x * y - s * z, v * x * z + s * y,
                         v * x * y + s * z, c + v * y * y,     v * y * z - s * x,
                         v * x * z - s * y, v * y * z + s * x, c + v * z * z};
    memcpy(r, m, sizeof m);
}

Place place_turned(Place place, const double axis[3], double angle_rad)
{
    double r[9], m[9];
    rotation_about(r, axis, angle_rad);
    m3_mul(m, r, place.m);
    memcpy(place.m, m, sizeof m);
    return place;
}

Place place_mirror_y(Place place)
{
    place.p[1] = -place.p[1];
    for (int i = 3; i < 6; i++) place.m[i] = -place.m[i];
    return place;
}

/* What a place does to lengths, normals and winding. */
typedef struct Warp {
    double largest;      /* longest column: lengths grow by no more than this */
    double normal_m[9];  /* inverse transpose, up to length */
    bool   flips;
} Warp;

static Warp warp_of(const Place *place)
{
    Warp warp = {0};
    double column[3][3], cross[3];
    for (int j = 0; j < 3; j++) {
        for (int i = 0; i < 3; i++) column[j][i] = place->m[3 * i + j];
        const double length = v3_length(column[j]);
        assert(length > 0);
        warp.largest = fmax(warp.largest, length);
        /* orthogonal columns: the inverse transpose divides each by its squared length */
        for (int i = 0; i < 3; i++) warp.normal_m[3 * i + j] = column[j][i] / (length * length);
    }
    v3_cross(cross, column[0], column[1]);
    warp.flips = v3_dot(cross, column[2]) < 0;
    return warp;
}

/* ---- storage -------------------------------------------------------------------------------- */

static bool grow(MeshBuilder *b, void *array, int *capacity, int needed, size_t size)
{
    if (b->status != STATUS_OK) return false;
    if (needed <= *capacity) return true;
    int wanted = *capacity ? *capacity : 64;
    while (wanted < needed) wanted += wanted / 2;
    void **pointer = array;
    void  *moved   = realloc(*pointer, (size_t)wanted * size);
    if (!moved) {
        b->status = STATUS_NO_MEMORY;
        return false;
    }
    *pointer  = moved;
    *capacity = wanted;
    return true;
}

MeshBuilder *mesh_builder_create(const char *model_name, double sag_m)
{
    assert(sag_m > 0);
    MeshBuilder *b = calloc(1, sizeof *b);
    if (!b) return NULL;
    snprintf(b->model.name, sizeof b->model.name, "%s", model_name);
    b->model.sag_m = sag_m;
    return b;
}

Status mesh_builder_finish(Model *out, MeshBuilder *b)
{
    Model *m = &b->model;
    if (b->status == STATUS_OK) {
        /* two arrays grow together with the triangles and vertices; this one only now */
        m->triangle_part = malloc((size_t)(m->triangle_count ? m->triangle_count : 1) * sizeof *m->triangle_part);
        if (!m->triangle_part) b->status = STATUS_NO_MEMORY;
    }
    const Status status = b->status;
    if (status == STATUS_OK) {
        for (int part = 0; part < m->part_count; part++) {
            const ModelPart *p = &m->part[part];
            for (int t = 0; t < p->triangle_count; t++) m->triangle_part[p->first_triangle + t] = (uint16_t)part;
        }
        model_measure(m);
        *out = *m;
    } else {
        model_destroy(m);
    }
    free(b);
    return status;
}

int mesh_node(MeshBuilder *b, const char *name, int parent, double x, double y, double z)
{
    Model *m = &b->model;
    assert(parent < m->node_count && (parent >= 0) == (m->node_count > 0));
    if (!grow(b, &m->node, &b->node_capacity, m->node_count + 1, sizeof *m->node)) return 0;
    ModelNode *node = &m->node[m->node_count];
    *node = (ModelNode){.parent = parent, .p_parent = {x, y, z}, .axis = {1, 0, 0}, .low = 1, .high = -1};
    m3_identity(node->r_parent_from_node);
    assert(strlen(name) < sizeof node->name);
    snprintf(node->name, sizeof node->name, "%s", name);
    return m->node_count++;
}

ModelNode *mesh_node_get(MeshBuilder *b, int node)
{
    /* after a failed allocation there may be no node at all: what is written then goes nowhere */
    static _Thread_local ModelNode nowhere;
    return b->status == STATUS_OK ? &b->model.node[node] : &nowhere;
}

void mesh_joint(MeshBuilder *b, int node, double ax, double ay, double az, uint32_t dis_class, uint32_t dis_metric,
                double low_rad, double high_rad)
{
    ModelNode *n = mesh_node_get(b, node);
    n->joint     = JOINT_ROTATION;
    n->axis[0]   = ax;
    n->axis[1]   = ay;
    n->axis[2]   = az;
    n->dis_class = dis_class;
    n->dis_metric = dis_metric;
    n->low        = low_rad;
    n->high       = high_rad;
}

void mesh_part(MeshBuilder *b, int node, const char *name, const char *material, HeatRole role)
{
    Model *m = &b->model;
    if (!grow(b, &m->part, &b->part_capacity, m->part_count + 1, sizeof *m->part)) return;
    ModelPart *part = &m->part[m->part_count];
    assert(node < m->node_count && (m->part_count == 0 || node >= part[-1].node) && m->part_count < UINT16_MAX);
    *part = (ModelPart){.node = node, .role = role, .first_triangle = m->triangle_count};
    assert(strlen(name) < sizeof part->name && strlen(material) < sizeof part->material);
    snprintf(part->name, sizeof part->name, "%s", name);
    snprintf(part->material, sizeof part->material, "%s", material);
    m->part_count++;
}

/* Room for what a shell adds: false when memory is out, and then nothing of the shell is added. */
static bool reserve(MeshBuilder *b, long long vertices, long long triangles)
{
    Model *m = &b->model;
    assert(b->status != STATUS_OK || m->part_count > 0);
    if (m->vertex_count + vertices > INT32_MAX / 4 || m->triangle_count + triangles > INT32_MAX / 4) {
        b->status = STATUS_NO_MEMORY;
        return false;
    }
    const int vertex_need = m->vertex_count + (int)vertices, triangle_need = m->triangle_count + (int)triangles;
    int normal_capacity = b->vertex_capacity; /* grows in step with the vertices */
    return grow(b, &m->vertex, &normal_capacity, vertex_need, sizeof *m->vertex) &&
           grow(b, &m->normal, &b->vertex_capacity, vertex_need, sizeof *m->normal) &&
           grow(b, &m->triangle, &b->triangle_capacity, triangle_need, sizeof *m->triangle);
}

static void place_point(double out[3], const Place *place, const double p_shape[3])
{
    /* + 0.0 turns -0 into 0: equal places get equal bits */
    m3_mul_v3(out, place->m, p_shape);
    for (int i = 0; i < 3; i++) out[i] = out[i] + place->p[i] + 0.0;
}

/* Room must be reserved. Returns the new vertex's index. */
static uint32_t add_vertex(MeshBuilder *b, const Place *place, const Warp *warp, const double p_shape[3],
                           const double n_shape[3])
{
    Model *m = &b->model;
    double n[3];
    place_point(m->vertex[m->vertex_count], place, p_shape);
    m3_mul_v3(n, warp->normal_m, n_shape);
    const bool ok = v3_normalize(n, n);
    assert(ok);
    (void)ok;
    for (int i = 0; i < 3; i++) m->normal[m->vertex_count][i] = (float)n[i];
    return (uint32_t)m->vertex_count++;
}

/* Adds a triangle unless two of its corners are one place (the pole of a sphere): its edges cancel, so the
 * shell stays closed without it. */
static void add_triangle(MeshBuilder *b, const Warp *warp, uint32_t i, uint32_t j, uint32_t k)
{
    Model *m = &b->model;
    const size_t size = sizeof m->vertex[0];
    if (!memcmp(m->vertex[i], m->vertex[j], size) || !memcmp(m->vertex[j], m->vertex[k], size) ||
        !memcmp(m->vertex[k], m->vertex[i], size))
        return;
    uint32_t *t = m->triangle[m->triangle_count++];
    t[0] = i;
    t[1] = warp->flips ? k : j;
    t[2] = warp->flips ? j : k;
    m->part[m->part_count - 1].triangle_count++;
}

/* A flat triangle with its own three vertices. */
static void add_facet(MeshBuilder *b, const Place *place, const Warp *warp, const double p[3], const double q[3],
                      const double r[3])
{
    double u[3], v[3], n[3];
    v3_sub(u, q, p);
    v3_sub(v, r, p);
    v3_cross(n, u, v);
    if (!(v3_length(n) > 0)) return; /* an edge that has shrunk to a point: see add_triangle */
    const uint32_t first = add_vertex(b, place, warp, p, n);
    add_vertex(b, place, warp, q, n);
    add_vertex(b, place, warp, r, n);
    add_triangle(b, warp, first, first + 1, first + 2);
}

/* Two rings of `sides` vertices each, joined by a band; ring 1 lies towards higher shape x. */
static void add_band(MeshBuilder *b, const Warp *warp, uint32_t ring0, uint32_t ring1, int sides)
{
    for (int j = 0; j < sides; j++) {
        const uint32_t k = (uint32_t)(j + 1 < sides ? j + 1 : 0);
        add_triangle(b, warp, ring0 + (uint32_t)j, ring0 + k, ring1 + k);
        add_triangle(b, warp, ring0 + (uint32_t)j, ring1 + k, ring1 + (uint32_t)j);
    }
}

/* ---- bodies of revolution -------------------------------------------------------------------- */

/* Angle of a chord with this sag; never more than a quarter of a right angle and a bit (8 sides). */
static double chord_angle(double radius_m, double sag_m)
{
    const double widest = 2 * pi_rad / sides_least;
    if (!(sag_m < radius_m)) return widest;
    /* 2 acos(1 - e) by way of the half angle: 1 - cos a = 2 sin^2(a / 2) keeps its digits for small e */
    return fmin(widest, 4 * asin(sqrt(0.5 * sag_m / radius_m)));
}

int mesh_circle_sides(double radius_m, double sag_m)
{
    const double sides = ceil(2 * pi_rad / chord_angle(radius_m, sag_m) - 1e-9);
    return (int)clamp(sides, sides_least, sides_most);
}

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
    Piece *piece    = next_piece(b);
    piece->cx       = cx;
    piece->cr       = cr;
    piece->radius   = hypot(piece->x0 - cx, piece->r0 - cr);
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
    MeshBuilder  *b;
    const Place  *place;
    const Warp   *warp;
    int           sides;
    double       *unit;            /* cosines and sines [sides][2] */
    uint32_t      last_ring;       /* ring at the end of the last strip, and its meridian point and normal */
    double        last[4];
    bool          has_last;
} Lathe;

static uint32_t lathe_ring(Lathe *l, double x, double r, double nx, double nr)
{
    const uint32_t first = (uint32_t)l->b->model.vertex_count;
    for (int j = 0; j < l->sides; j++) {
        const double c = l->unit[2 * j], s = l->unit[2 * j + 1];
        add_vertex(l->b, l->place, l->warp, (double[3]){x, r * c, r * s}, (double[3]){nx, nr * c, nr * s});
    }
    return first;
}

/* A conical strip; the ring before is shared where the surface runs on smoothly. */
static void lathe_strip(Lathe *l, const double from[4], const double to[4])
{
    if (!reserve(l->b, 2LL * l->sides, 2LL * l->sides)) return;
    const bool shared = l->has_last && !memcmp(l->last, from, sizeof l->last);
    const uint32_t ring0 = shared ? l->last_ring : lathe_ring(l, from[0], from[1], from[2], from[3]);
    const uint32_t ring1 = lathe_ring(l, to[0], to[1], to[2], to[3]);
    add_band(l->b, l->warp, ring0, ring1, l->sides);
    memcpy(l->last, to, sizeof l->last);
    l->last_ring = ring1;
    l->has_last  = true;
}

void mesh_lathe(MeshBuilder *b, Place place)
{
    const Warp warp = warp_of(&place);
    double radius = 0;
    bool   curved = false;
    assert(b->piece_count > 0);
    for (int i = 0; i < b->piece_count; i++) {
        const Piece *p = &b->piece[i];
        radius = fmax(radius, fmax(p->r0, p->r1));
        if (p->radius > 0) {
            curved = true;
            /* the arc's own top, when it passes there: a quarter turn lies between its ends */
            const double to_top = p->turn_rad < 0 ? p->from_rad - 0.5 * pi_rad : 0.5 * pi_rad - p->from_rad;
            const double ahead  = to_top < 0 ? to_top + 2 * pi_rad : to_top;
            if (ahead <= fabs(p->turn_rad)) radius = fmax(radius, p->cr + p->radius);
        }
    }
    /* closed: both ends on the axis, or the end at the beginning */
    const Piece *end = &b->piece[b->piece_count - 1];
    assert((b->begin_r == 0 && end->r1 == 0) || hypot(end->x1 - b->begin_x, end->r1 - b->begin_r) < 1e-9);

    const double sag = b->model.sag_m / warp.largest / (curved ? 2 : 1);
    Lathe l = {.b = b, .place = &place, .warp = &warp, .sides = mesh_circle_sides(radius, sag)};
    l.unit = malloc((size_t)l.sides * 2 * sizeof *l.unit);
    if (!l.unit) {
        b->status = STATUS_NO_MEMORY;
        return;
    }
    for (int j = 0; j < l.sides; j++) {
        l.unit[2 * j]     = cos(2 * pi_rad * j / l.sides);
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
        const double step   = chord_angle(p->radius, sag);
        const int    steps  = (int)fmax(1, ceil(fabs(p->turn_rad) / step - 1e-9));
        const double facing = p->turn_rad < 0 ? 1 : -1; /* a hollow faces its centre */
        double from[4] = {p->x0, p->r0, facing * cos(p->from_rad), facing * sin(p->from_rad)};
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
            bool free_of_others = cross2(p[a], p[v], p[c]) > 0;
            for (int k = 0; k < remaining && free_of_others; k++) {
                const int o = left[k];
                if (o == a || o == v || o == c) continue;
                free_of_others = cross2(p[a], p[v], p[o]) < 0 || cross2(p[v], p[c], p[o]) < 0 ||
                                 cross2(p[c], p[a], p[o]) < 0;
            }
            if (free_of_others) ear = i;
        }
        assert(ear >= 0); /* the outline crosses itself: our own mistake */
        triangle[made][0] = left[(ear + remaining - 1) % remaining];
        triangle[made][1] = left[ear];
        triangle[made][2] = left[(ear + 1) % remaining];
        made++;
        remaining--;
        for (int k = ear; k < remaining; k++) left[k] = left[k + 1];
    }
    for (int k = 0; k < 3; k++) triangle[made][k] = left[k];
}

void mesh_slab(MeshBuilder *b, Place place, int count, const double (*at_y0)[2], double y0,
               const double (*at_y1)[2], double y1)
{
    assert(count >= 3 && count <= outline_capacity && y0 < y1);
    double p[2][outline_capacity][3], outline[outline_capacity][2], area = 0;
    int    face[outline_capacity][3];
    for (int i = 0; i < count; i++) {
        const double *u = at_y0[i], *v = at_y0[(i + 1) % count];
        area += u[0] * v[1] - v[0] * u[1];
    }
    for (int i = 0; i < count; i++) {
        const int k = area > 0 ? i : count - 1 - i; /* counter-clockwise in (x, z), which is seen from -y */
        const double a[3] = {at_y0[k][0], y0, at_y0[k][1]}, c[3] = {at_y1[k][0], y1, at_y1[k][1]};
        memcpy(p[0][i], a, sizeof a);
        memcpy(p[1][i], c, sizeof c);
        outline[i][0] = a[0];
        outline[i][1] = a[2];
    }
    clip_ears(face, count, (const double (*)[2])outline);
    if (!reserve(b, 12LL * count, 4LL * count)) return;
    const Warp warp = warp_of(&place);
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

/* ---- lofts ------------------------------------------------------------------------------------ */

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
    const double after  = i + 1 < count ? (station_field(&s[i + 1], field) - here) / (s[i + 1].x - s[i].x) : 0;
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
    const double h = c->x - a->x, t = (x - a->x) / h;
    double value[loft_fields], slope[loft_fields], bends[loft_fields];
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
    const double bend = hypot(bends[loft_width], fmax(bends[loft_top], bends[loft_bottom])) +
                        2 * 0.3 * fabs(round_slope) * (fabs(slope[loft_width]) + fabs(slope[loft_bottom] - slope[loft_top]));
    return (Section){
        .at    = {x, value[loft_width], value[loft_top], value[loft_bottom],
                  x == c->x ? c->round : a->round + (x - a->x) * round_slope},
        .slope = {1, slope[loft_width], slope[loft_top], slope[loft_bottom], round_slope},
        .bend  = bend,
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
    const double t = 0.5 * pi_rad * step / steps;
    const double ct = step == steps ? 0 : cos(t), st = step == steps ? 1 : sin(t);
    const double c = quarter[corner][0] * ct - quarter[corner][1] * st;
    const double d = quarter[corner][1] * ct + quarter[corner][0] * st;
    const double sign_y = corner == 0 || corner == 3 ? 1 : -1, sign_z = corner < 2 ? 1 : -1;
    const double k = s->at.round, k1 = s->slope.round;
    const double a = s->at.half_width, a1 = s->slope.half_width;
    const double h = 0.5 * (s->at.bottom - s->at.top), h1 = 0.5 * (s->slope.bottom - s->slope.top);
    const double mid = 0.5 * (s->at.bottom + s->at.top), mid1 = 0.5 * (s->slope.bottom + s->slope.top);
    const double u = sign_y + k * (c - sign_y), v = sign_z + k * (d - sign_z); /* 1: on the full width */
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
    const Warp   warp = warp_of(&place);
    const double sag  = 0.4 * b->model.sag_m / warp.largest; /* around, and again along; see the header */
    double corner_radius = 0;
    for (int i = 0; i < count; i++) {
        const Station *s = &station[i];
        assert(s->half_width > 0 && s->top < s->bottom && s->round > 0 && s->round <= 1 && (i == 0 || s[-1].x < s->x));
        corner_radius = fmax(corner_radius, s->round * fmax(s->half_width, 0.5 * (s->bottom - s->top)));
    }
    const int steps = (mesh_circle_sides(corner_radius, sag) + 3) / 4, sides = 4 * (steps + 1);
    uint32_t last = 0;
    for (int i = 0; i + 1 < count; i++) {
        const double h = station[i + 1].x - station[i].x;
        /* a straight line errs by h^2 / 8 times the second derivative */
        double bend = 0;
        for (int k = 0; k <= 2; k++) bend = fmax(bend, section_at(station, count, i, station[i].x + 0.5 * k * h).bend);
        const int parts = (int)fmax(1, ceil(h * sqrt(bend / (8 * sag)) - 1e-9));
        for (int k = i == 0 ? 0 : 1; k <= parts; k++) {
            const double  x = k == parts ? station[i + 1].x : station[i].x + h * k / parts;
            const Section s = section_at(station, count, i, x);
            if (!reserve(b, sides, 2LL * sides)) return;
            const uint32_t ring = (uint32_t)b->model.vertex_count;
            for (int j = 0; j < sides; j++) {
                double p[3], n[3];
                section_point(p, n, &s, j / (steps + 1), j % (steps + 1), steps);
                add_vertex(b, &place, &warp, p, n);
            }
            if (i > 0 || k > 0) add_band(b, &warp, last, ring, sides);
            last = ring;
        }
    }
    for (int side = 0; side < 2; side++) {
        const Section s = section_at(station, count, side ? count - 2 : 0, station[side ? count - 1 : 0].x);
        const double  flat[3] = {side ? 1 : -1, 0, 0};
        if (!reserve(b, sides, sides)) return;
        const uint32_t ring = (uint32_t)b->model.vertex_count;
        for (int j = 0; j < sides; j++) {
            double p[3], n[3];
            section_point(p, n, &s, j / (steps + 1), j % (steps + 1), steps);
            add_vertex(b, &place, &warp, p, flat);
        }
        for (uint32_t j = 1; j + 1 < (uint32_t)sides; j++)
            add_triangle(b, &warp, ring, ring + (side ? j : j + 1), ring + (side ? j + 1 : j));
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

static void belt_vertex(MeshBuilder *b, const Place *place, const Warp *warp, const BeltPoint *p, double out_m, double y,
                        double nx, double ny, double nup)
{
    add_vertex(b, place, warp, (double[3]){p->x + out_m * p->nx, y, -(p->up + out_m * p->nup)},
               (double[3]){nx, ny, -nup});
}

/* A closed strip between two lines that follow the band: (out, y) of the first, of the second, and which way
 * it faces: along the band's normal (1, -1) or along y. */
static void belt_strip(MeshBuilder *b, const Place *place, const Warp *warp, const BeltPoint *point, int count,
                       double out0, double y0, double out1, double y1, double along_normal, double along_y)
{
    if (!reserve(b, 2LL * count, 2LL * count)) return;
    const uint32_t first = (uint32_t)b->model.vertex_count;
    for (int i = 0; i < count; i++) {
        const BeltPoint *p = &point[i];
        const double nx = along_normal * p->nx, nup = along_normal * p->nup;
        belt_vertex(b, place, warp, p, out0, y0, nx, along_y, nup);
        belt_vertex(b, place, warp, p, out1, y1, nx, along_y, nup);
    }
    for (int i = 0; i < count; i++) {
        const uint32_t a = first + 2 * (uint32_t)i, c = first + 2 * (uint32_t)((i + 1) % count);
        add_triangle(b, warp, a, c, c + 1);
        add_triangle(b, warp, a, c + 1, a + 1);
    }
}

static void belt_cleats(MeshBuilder *b, const Place *place, const BeltPoint *point, int count, double thickness,
                        double y0, double y1, int cleats, double height, double length_m)
{
    double round_m = 0;
    for (int pass = 0, next = 0; pass < 2; pass++) {
        double at_m = 0;
        for (int i = 0; i < count; i++) {
            const BeltPoint *p = &point[i], *q = &point[(i + 1) % count];
            const double px = p->x + thickness * p->nx, pup = p->up + thickness * p->nup;
            const double dx = q->x + thickness * q->nx - px, dup = q->up + thickness * q->nup - pup;
            const double run = hypot(dx, dup);
            for (; pass == 1 && next < cleats && round_m * next / cleats < at_m + run && run > 0; next++) {
                const double s = (round_m * next / cleats - at_m) / run;
                /* shape z along the band's own normal, which turns with the bend even where facets are long;
                 * shape x along its tangent; sunk by a fifth of the band so that it never floats */
                const double n = hypot(p->nx + s * (q->nx - p->nx), p->nup + s * (q->nup - p->nup));
                const double nx = (p->nx + s * (q->nx - p->nx)) / n, nup = (p->nup + s * (q->nup - p->nup)) / n;
                const double local[9] = {-nup, 0, nx, 0, 1, 0, -nx, 0, -nup};
                const double p_shape[3] = {px + s * dx, 0, -(pup + s * dup)};
                double m[9];
                Place  cleat;
                m3_mul(m, place->m, local);
                memcpy(cleat.m, m, sizeof m);
                place_point(cleat.p, place, p_shape);
                mesh_box(b, cleat, -0.5 * length_m, y0, -0.2 * thickness, 0.5 * length_m, y1, height);
            }
            at_m += run;
        }
        round_m = at_m;
    }
}

void mesh_belt(MeshBuilder *b, Place place, const BeltWheel *wheel, int count, double thickness, double y0, double y1,
               int cleats, double cleat_height, double cleat_length)
{
    assert(count >= 2 && count <= wheel_capacity && thickness > 0 && y0 < y1);
    const Warp   warp = warp_of(&place);
    const double sag  = b->model.sag_m / warp.largest;
    BeltWheel w[wheel_capacity];
    double    area = 0;
    int       point_count = 0;
    for (int i = 0; i < count; i++) {
        const BeltWheel *p = &wheel[i], *q = &wheel[(i + 1) % count];
        area += q->x * p->z - p->x * q->z; /* in (x, up = -z) */
    }
    for (int i = 0; i < count; i++) w[i] = wheel[area > 0 || count == 2 ? i : count - 1 - i];

    BeltPoint *point = NULL;
    int        capacity = 0;
    for (int i = 0; i < count; i++) {
        const BeltWheel *a = &w[(i + count - 1) % count], *c = &w[i], *e = &w[(i + 1) % count];
        double n0[2], n1[2];
        belt_tangent(n0, a, c);
        belt_tangent(n1, c, e);
        const double from = atan2(n0[1], n0[0]);
        double turn = atan2(n0[0] * n1[1] - n0[1] * n1[0], n0[0] * n1[0] + n0[1] * n1[1]);
        if (turn < 0) turn += 2 * pi_rad;
        const int steps = (int)fmax(1, ceil(turn / chord_angle(c->radius + thickness, sag) - 1e-9));
        if (!grow(b, &point, &capacity, point_count + steps + 1, sizeof *point)) break;
        for (int k = 0; k <= steps; k++) {
            const double angle = from + turn * k / steps, nx = cos(angle), nup = sin(angle);
            point[point_count++] = (BeltPoint){c->x + c->radius * nx, -c->z + c->radius * nup, nx, nup};
        }
    }
    if (b->status == STATUS_OK) {
        belt_strip(b, &place, &warp, point, point_count, thickness, y0, thickness, y1, 1, 0);
        belt_strip(b, &place, &warp, point, point_count, 0, y1, 0, y0, -1, 0);
        belt_strip(b, &place, &warp, point, point_count, 0, y0, thickness, y0, 0, -1);
        belt_strip(b, &place, &warp, point, point_count, thickness, y1, 0, y1, 0, 1);
        if (cleats > 0) belt_cleats(b, &place, point, point_count, thickness, y0, y1, cleats, cleat_height, cleat_length);
    }
    free(point);
}
