/* render/scattering/field/radar_model.c: builds the simple shapes (sphere, plate, corner ...) as targets, and opens
 * any target by its name. */
#include "render/scattering/field/radar_model.h"
#include "entities/import/model_import.h"

#include <stdlib.h>

enum { most_facets = 4000000 };

/* Vertices are not shared: each facet has its own three. */
typedef struct Builder {
    Model *model;
    int    capacity; /* facets */
} Builder;

static bool open_model(Builder *b, Model *model, const char *name)
{
    *model = (Model){.node_count = 1, .part_count = 1};
    *b = (Builder){.model = model};
    model->node = calloc(1, sizeof *model->node);
    model->part = calloc(2, sizeof *model->part);
    if (!model->node || !model->part) return false;
    snprintf(model->name, sizeof model->name, "%s", name);
    snprintf(model->node->name, sizeof model->node->name, "body");
    model->node->parent = -1;
    m3_identity(model->node->r_parent_from_node);
    snprintf(model->part->name, sizeof model->part->name, "body");
    snprintf(model->part->material, sizeof model->part->material, "metal");
    return true;
}

static bool make_room(Builder *b, int facets)
{
    Model       *m = b->model;
    const size_t count = (size_t)facets;
    b->capacity = facets;
    m->vertex = calloc(3 * count, sizeof *m->vertex);
    m->normal = calloc(3 * count, sizeof *m->normal);
    m->triangle = calloc(count, sizeof *m->triangle);
    m->triangle_part = calloc(count, sizeof *m->triangle_part);
    return m->vertex && m->normal && m->triangle && m->triangle_part;
}

static void add_facet(Builder *b, const double p[3][3], const double n[3][3])
{
    Model    *m = b->model;
    const int t = m->triangle_count++;
    for (int c = 0; c < 3; c++) {
        const int v = m->vertex_count++;
        m->triangle[t][c] = (uint32_t)v;
        for (int x = 0; x < 3; x++) {
            m->vertex[v][x] = p[c][x];
            m->normal[v][x] = (float)n[c][x];
        }
    }
    m->triangle_part[t] = (uint16_t)(m->part_count - 1);
    m->part[m->part_count - 1].triangle_count++;
}

static void begin_part(Builder *b, const char *name)
{
    ModelPart *part = &b->model->part[b->model->part_count++];
    *part = b->model->part[0];
    snprintf(part->name, sizeof part->name, "%s", name);
    part->first_triangle = b->model->triangle_count;
    part->triangle_count = 0;
}

/* Adds a flat triangle with its own normal, right-handed about a, b, c. */
static void add_flat(Builder *b, const double a[3], const double c[3], const double d[3])
{
    double ab[3], ac[3], n[3], p[3][3], normal[3][3];
    v3_sub(ab, c, a);
    v3_sub(ac, d, a);
    v3_cross(n, ab, ac);
    v3_normalize(n, n);
    for (int x = 0; x < 3; x++) {
        p[0][x] = a[x], p[1][x] = c[x], p[2][x] = d[x];
        for (int k = 0; k < 3; k++) normal[k][x] = n[x];
    }
    add_facet(b, (const double(*)[3])p, (const double(*)[3])normal);
}

/* The parallelogram o, o + u, o + u + v, o + v. */
static void add_plate(Builder *b, const double o[3], const double u[3], const double v[3])
{
    double ou[3], ov[3], ouv[3];
    v3_add(ou, o, u);
    v3_add(ov, o, v);
    v3_add(ouv, ou, v);
    add_flat(b, o, ou, ouv);
    add_flat(b, o, ouv, ov);
}

/* ---- curved ones ------------------------------------------------------------------------------------ */

/* Sides of a circle for a sag: cos(pi / n) = 1 - sag / r. */
static double circle_sides(double radius_m, double sag_m)
{
    return fmax(8, ceil(pi_rad / acos(1 - fmin(sag_m / radius_m, 0.2))));
}

/* Each face of an octahedron in n x n triangles, its points moved out to the sphere. The deepest facets, at the
 * middle of a face, have a sag of 0.83 radii / n^2 (measured). */
static bool build_sphere(Builder *b, double radius_m, double sag_m)
{
    const double n = ceil(sqrt(0.83 * radius_m / fmin(sag_m, 0.1 * radius_m)));
    if (8 * n * n > most_facets || !make_room(b, (int)(8 * n * n))) return false;
    for (int octant = 0; octant < 8; octant++) {
        const double sign[3] = {octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1};
        const bool   turned = sign[0] * sign[1] * sign[2] < 0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n - i; j++)
                for (int half = 0; half < (j < n - i - 1 ? 2 : 1); half++) {
                    const int at[2][3][2] = {{{i, j}, {i + 1, j}, {i, j + 1}},
                                             {{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}};
                    double    p[3][3], normal[3][3];
                    for (int c = 0; c < 3; c++) {
                        const int   *g = at[half][turned ? 2 - c : c];
                        const double angle[2] = {0.5 * pi_rad * g[0] / n, 0.5 * pi_rad * g[1] / n};
                        const double q[3] = {sin(angle[0]), sin(angle[1]), sin(0.5 * pi_rad - angle[0] - angle[1])};
                        const double length = v3_length(q);
                        for (int x = 0; x < 3; x++) {
                            normal[c][x] = sign[x] * q[x] / length;
                            p[c][x] = radius_m * normal[c][x];
                        }
                    }
                    add_facet(b, (const double(*)[3])p, (const double(*)[3])normal);
                }
    }
    return true;
}

static bool build_cylinder(Builder *b, double radius_m, double length_m, double sag_m)
{
    const double sides = circle_sides(radius_m, sag_m);
    if (4 * sides > most_facets || !make_room(b, 4 * (int)sides)) return false;
    for (int i = 0; i < sides; i++)
        for (int half = 0; half < 2; half++) {
            static const int at[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
            double           p[3][3], n[3][3];
            for (int c = 0; c < 3; c++) {
                const double angle = 2 * pi_rad * (i + at[half][c][0]) / sides;
                n[c][0] = cos(angle), n[c][1] = sin(angle), n[c][2] = 0;
                p[c][0] = radius_m * n[c][0], p[c][1] = radius_m * n[c][1], p[c][2] = length_m * (at[half][c][1] - 0.5);
            }
            add_facet(b, (const double(*)[3])p, (const double(*)[3])n);
        }
    begin_part(b, "ends");
    for (int i = 0; i < 2 * (int)sides; i++) {
        const double z_m = length_m * (i < sides ? 0.5 : -0.5), way = i < sides ? 1 : -1, step = 2 * pi_rad / sides;
        const double o[3] = {0, 0, z_m}, p[3] = {radius_m * cos(i * step), radius_m * sin(i * step), z_m};
        const double q[3] = {radius_m * cos((i + way) * step), radius_m * sin((i + way) * step), z_m};
        add_flat(b, o, p, q);
    }
    return true;
}

static bool build_disc(Builder *b, double radius_m, double sag_m)
{
    const double sides = circle_sides(radius_m, sag_m);
    if (sides > most_facets || !make_room(b, (int)sides)) return false;
    for (int i = 0; i < sides; i++) {
        const double o[3] = {0, 0, 0}, from = 2 * pi_rad * i / sides, to = 2 * pi_rad * (i + 1) / sides;
        const double p[3] = {0, radius_m * cos(from), radius_m * sin(from)};
        const double q[3] = {0, radius_m * cos(to), radius_m * sin(to)};
        add_flat(b, o, p, q);
    }
    return true;
}

/* ---- flat ones -------------------------------------------------------------------------------------- */

static bool build_plate(Builder *b, double a_m, double b_m)
{
    const double o[3] = {0, -a_m / 2, -b_m / 2}, u[3] = {0, a_m, 0}, v[3] = {0, 0, b_m};
    if (!make_room(b, 2)) return false;
    add_plate(b, o, u, v);
    return true;
}

static bool build_dihedral(Builder *b, double a_m, double b_m)
{
    const double o[3] = {0, 0, -b_m / 2}, half = a_m * sqrt(0.5), u[3] = {half, half, 0}, w[3] = {half, -half, 0};
    const double v[3] = {0, 0, b_m};
    if (!make_room(b, 4)) return false;
    add_plate(b, o, v, u);
    add_plate(b, o, w, v);
    return true;
}

static bool build_trihedral(Builder *b, double a_m, bool square)
{
    const double o[3] = {0, 0, 0}, axis[3][3] = {{a_m, 0, 0}, {0, 0, -a_m}, {0, a_m, 0}};
    if (!make_room(b, square ? 6 : 3)) return false;
    for (int c = 0; c < 3; c++) {
        if (square) add_plate(b, o, axis[c], axis[(c + 1) % 3]);
        else add_flat(b, o, axis[c], axis[(c + 1) % 3]);
    }
    return true;
}

/* ---- by name ---------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    int         dimensions;
} shapes[] = {{"sphere", 1},   {"plate", 2},     {"disc", 1},  {"cylinder", 2},
              {"dihedral", 2}, {"trihedral", 1}, {"corner", 1}};
enum { shape_count = sizeof shapes / sizeof *shapes };

/* A name means a shape where it has a colon. */
static bool is_shape(const char *name) { return strchr(name, ':') != NULL; }

/* Reads the number of a shape, and its dimensions. -1: the name is no shape. */
static int read_name(double size_m[2], const char *name)
{
    const char  *colon = strchr(name, ':');
    char         text[64], *cross;
    const size_t length = colon ? (size_t)(colon - name) : 0;
    if (!colon || snprintf(text, sizeof text, "%s", colon + 1) >= (int)sizeof text) return -1;
    for (int s = 0; s < shape_count; s++) {
        if (strlen(shapes[s].name) != length || memcmp(shapes[s].name, name, length) != 0) continue;
        cross = strchr(text, 'x');
        if ((cross != NULL) != (shapes[s].dimensions == 2)) return -1;
        if (cross) *cross = 0;
        size_m[1] = 1;
        if (!text_to_double(&size_m[0], text) || (cross && !text_to_double(&size_m[1], cross + 1))) return -1;
        return size_m[0] >= 1e-3 && size_m[0] <= 100 && size_m[1] >= 1e-3 && size_m[1] <= 100 ? s : -1;
    }
    return -1;
}

static bool build_shape(Builder *b, int shape, const double size_m[2], double sag_m)
{
    switch (shape) {
    case 0:
        return build_sphere(b, size_m[0], sag_m);
    case 1:
        return build_plate(b, size_m[0], size_m[1]);
    case 2:
        return build_disc(b, size_m[0], sag_m);
    case 3:
        return build_cylinder(b, size_m[0], size_m[1], sag_m);
    case 4:
        return build_dihedral(b, size_m[0], size_m[1]);
    default:
        return build_trihedral(b, size_m[0], shape == 6);
    }
}

Status radar_shape_build(Model *out, const char *name, double sag_m)
{
    Model     model;
    Builder   builder;
    double    size_m[2];
    const int shape = read_name(size_m, name);
    if (shape < 0) {
        log_error("radar: no such shape: name=%s accepted=sphere:R, plate:AxB, disc:R, cylinder:RxL, dihedral:AxB, "
                  "trihedral:A, corner:A with 0.001 .. 100 m",
                  name);
        return STATUS_BAD_VALUE;
    }
    Status status = open_model(&builder, &model, name) ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && !build_shape(&builder, shape, size_m, sag_m)) {
        log_error("radar: a shape of more than %d facets, or no memory for it: name=%s sag_m=%g", (int)most_facets,
                  name, sag_m);
        status = STATUS_BAD_VALUE;
    }
    model.sag_m = sag_m;
    if (status == STATUS_OK) status = model_measure(&model);
    if (status == STATUS_OK) *out = model;
    else model_destroy(&model);
    return status;
}

/* ---- targets ------------------------------------------------------------------------------------ */

Status radar_model_open(RadarModel *out, const char *name, const RadarMaterials *materials, double sag_m)
{
    ModelImport report;
    bool        imported = false;
    *out = (RadarModel){0};
    Status status = is_shape(name) ? radar_shape_build(&out->model, name, sag_m)
                                   : model_open(&out->model, &report, &imported, name, sag_m);
    if (status == STATUS_OK && imported) model_import_say(&report, &out->model);
    if (status == STATUS_OK) status = radar_target_create(&out->target, &out->model, materials, "avx2");
    if (status != STATUS_OK) radar_model_close(out);
    return status;
}

void radar_model_close(RadarModel *m)
{
    radar_target_destroy(m->target);
    model_destroy(&m->model);
    *m = (RadarModel){0};
}
