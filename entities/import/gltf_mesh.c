/* entities/import/gltf_mesh.c: meshes of a glTF file as triangles: strips and fans taken apart, blended by their
 * default weights, posed by their skin as the file's nodes stand. */
#include "entities/import/gltf_private.h"

#include <stdlib.h>

enum { most_targets = 4096, most_joints = 65536, most_sets = 4 };

/* How a node poses its mesh. */
typedef struct Pose {
    int    weights;
    double weight[most_targets];
    int    joints;       /* number of joints; 0: no skin */
    double (*joint)[12]; /* p_node = joint (p_mesh, 1) */
} Pose;

static Status wrong(Gltf *g, const char *what) { return reader_fails(g->said, STATUS_BAD_VALUE, "%s", what); }

static int attribute(const Gltf *g, const json_t *attributes, const char *name)
{
    return gltf_index(attributes, name, json_array_size(json_object_get(g->root, "accessors")));
}

/* ---- triangles -------------------------------------------------------------------------------------- */

/* Number of triangles by mode. 4: a list; 5: a strip, in which every other triangle is turned; 6: a fan. */
static int triangles_of(int mode, int corners) { return mode == 4 ? corners / 3 : corners > 2 ? corners - 2 : 0; }

static int corner_of(int mode, int t, int k)
{
    if (mode == 4) return 3 * t + k;
    if (mode == 6) return k == 0 ? 0 : t + k;
    return k == 0 ? t : t + 1 + ((k - 1) ^ (t & 1));
}

static Status read_triangles(GltfShape *s, Gltf *g, const json_t *primitive, int mode)
{
    double *index = NULL;
    int     corners = s->vertices;
    Status  status = STATUS_OK;
    if (json_object_get(primitive, "indices"))
        status = gltf_accessor(&index, &corners, g, attribute(g, primitive, "indices"), 1, "indices");
    if (status != STATUS_OK) return status;
    s->triangles = triangles_of(mode, corners);
    s->triangle = calloc((size_t)s->triangles + 1, sizeof *s->triangle);
    if (!s->triangle) status = STATUS_NO_MEMORY;
    for (int t = 0; t < s->triangles && status == STATUS_OK; t++)
        for (int k = 0; k < 3; k++) {
            const int    corner = corner_of(mode, t, k);
            const double v = index ? index[corner] : corner;
            if (!(v >= 0 && v < s->vertices)) status = wrong(g, "an index is beyond its vertices");
            else s->triangle[t][k] = (uint32_t)v;
        }
    free(index);
    return status;
}

/* ---- vertices --------------------------------------------------------------------------------------- */

/* Adds an attribute of each morph target, multiplied by its weight. */
static Status blend(double *numbers, int count, Gltf *g, const json_t *primitive, const char *name, const Pose *pose)
{
    const json_t *targets = json_object_get(primitive, "targets");
    for (int i = 0; i < pose->weights; i++) {
        const json_t *target = json_array_get(targets, (size_t)i);
        double       *delta;
        int           deltas;
        if (pose->weight[i] == 0 || !json_object_get(target, name)) continue;
        const Status status = gltf_accessor(&delta, &deltas, g, attribute(g, target, name), 3, "a morph target");
        if (status != STATUS_OK) return status;
        for (int k = 0; k < 3 * count && deltas == count; k++) numbers[k] += pose->weight[i] * delta[k];
        free(delta);
        if (deltas != count) return wrong(g, "a morph target has another number of vertices");
    }
    return STATUS_OK;
}

static void mul_point(double out[3], const double m[12], const double p[3])
{
    for (int i = 0; i < 3; i++) out[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

/* Moves the vertices to where the skin puts them. *moved: whether they moved farther than the file's single precision
 * explains. */
static Status pose_vertices(bool *moved, GltfShape *s, Gltf *g, const json_t *attributes, const Pose *pose)
{
    double *joint[most_sets] = {0}, *weight[most_sets] = {0}, reach = 0;
    int     sets = 0;
    Status  status = STATUS_OK;
    for (; sets < most_sets && status == STATUS_OK; sets++) {
        char name[2][24];
        int  count[2] = {0};
        snprintf(name[0], sizeof name[0], "JOINTS_%d", sets);
        snprintf(name[1], sizeof name[1], "WEIGHTS_%d", sets);
        if (!json_object_get(attributes, name[0]) || !json_object_get(attributes, name[1])) break;
        status = gltf_accessor(&joint[sets], &count[0], g, attribute(g, attributes, name[0]), 4, name[0]);
        if (status == STATUS_OK)
            status = gltf_accessor(&weight[sets], &count[1], g, attribute(g, attributes, name[1]), 4, name[1]);
        if (status == STATUS_OK && (count[0] != s->vertices || count[1] != s->vertices))
            status = wrong(g, "a skin has another number of vertices");
    }
    double(*posed)[3] = status == STATUS_OK && sets ? malloc(((size_t)s->vertices + 1) * sizeof *posed) : NULL;
    if (status == STATUS_OK && sets && !posed) status = STATUS_NO_MEMORY;
    for (int v = 0; v < s->vertices && posed && status == STATUS_OK; v++) {
        double sum[3] = {0, 0, 0}, total = 0;
        for (int i = 0; i < 4 * sets; i++) {
            const double w = weight[i / 4][4 * v + i % 4], j = joint[i / 4][4 * v + i % 4];
            double       p[3];
            if (!(w > 0)) continue;
            if (!(j >= 0 && j < pose->joints)) {
                status = wrong(g, "a skin's joint is beyond its list");
                break;
            }
            mul_point(p, pose->joint[(int)j], s->vertex[v]);
            v3_add_scaled(sum, sum, w, p);
            total += w;
        }
        if (total > 0) v3_scale(posed[v], 1 / total, sum);
        else memcpy(posed[v], s->vertex[v], sizeof posed[v]);
        for (int i = 0; i < 3; i++) reach = fmax(reach, fabs(s->vertex[v][i]));
    }
    for (int v = 0; v < s->vertices && posed && status == STATUS_OK && !*moved; v++)
        for (int i = 0; i < 3; i++) *moved = *moved || !(fabs(posed[v][i] - s->vertex[v][i]) <= 1e-5 * reach);
    if (*moved && status == STATUS_OK) memcpy(s->vertex, posed, (size_t)s->vertices * sizeof *posed);
    free(posed);
    for (int i = 0; i < most_sets; i++) free(joint[i]), free(weight[i]);
    return status;
}

static Status read_vertices(GltfShape *s, Gltf *g, const json_t *primitive, const Pose *pose)
{
    const json_t *attributes = json_object_get(primitive, "attributes");
    double       *position = NULL, *normal = NULL;
    int           normals = 0;
    bool          moved = false;
    Status status = gltf_accessor(&position, &s->vertices, g, attribute(g, attributes, "POSITION"), 3, "POSITION");
    if (status != STATUS_OK) return status;
    s->vertex = (double(*)[3])(void *)position;
    if (s->vertices > import_max_vertices) return wrong(g, "more than 8 M vertices");
    status = blend(position, s->vertices, g, primitive, "POSITION", pose);
    if (status == STATUS_OK && pose->joints) status = pose_vertices(&moved, s, g, attributes, pose);
    if (status != STATUS_OK || moved || !json_object_get(attributes, "NORMAL"))
        return status; /* a skin turns normals, so these are found by crease */
    status = gltf_accessor(&normal, &normals, g, attribute(g, attributes, "NORMAL"), 3, "NORMAL");
    if (status == STATUS_OK && normals != s->vertices)
        status = wrong(g, "NORMAL has another number of vertices than POSITION");
    if (status == STATUS_OK) status = blend(normal, normals, g, primitive, "NORMAL", pose);
    if (status == STATUS_OK && !(s->normal = malloc(((size_t)normals + 1) * sizeof *s->normal)))
        status = STATUS_NO_MEMORY;
    for (int i = 0; i < 3 * normals && status == STATUS_OK; i++) s->normal[i / 3][i % 3] = (float)normal[i];
    free(normal);
    return status;
}

/* ---- a mesh ----------------------------------------------------------------------------------------- */

/* Reads the shape of a primitive. *drawn: false when it has no triangles. */
static Status read_shape(GltfShape *s, bool *drawn, Gltf *g, const json_t *primitive, const Pose *pose)
{
    const json_t *mode = json_object_get(primitive, "mode"), *attributes = json_object_get(primitive, "attributes");
    const int     kind = mode ? (int)json_integer_value(mode) : 4;
    *drawn = false;
    *s = (GltfShape){0};
    if (kind < 4 || kind > 6) {
        g->scene->lost[LOST_POINTS_AND_LINES]++;
        return STATUS_OK;
    }
    if (!json_object_get(attributes, "POSITION")) {
        g->scene->lost[LOST_OTHER]++;
        return STATUS_OK;
    }
    if (gltf_extension(primitive, "KHR_draco_mesh_compression") &&
        !gltf_accessor_is_stored(g, attribute(g, attributes, "POSITION")))
        return reader_fails(g->said, STATUS_UNSUPPORTED,
                            "a mesh is packed by the extension KHR_draco_mesh_compression, which "
                            "is not read: export it without mesh compression");
    s->material = gltf_index(primitive, "material", json_array_size(json_object_get(g->root, "materials")));
    if (s->material < 0) s->material = g->scene->material_count - 1; /* the default material follows the file's own */
    Status status = read_vertices(s, g, primitive, pose);
    if (status == STATUS_OK) status = read_triangles(s, g, primitive, kind);
    *drawn = status == STATUS_OK && s->triangles > 0;
    return status;
}

static void close_shape(GltfShape *s)
{
    free(s->vertex);
    free(s->normal);
    free(s->triangle);
}

void gltf_shapes_close(Gltf *g)
{
    for (int i = 0; i < g->shape_count; i++) close_shape(&g->shape[i]);
    free(g->shape);
    free(g->draw);
    free(g->cached);
}

/* Default weights: the node's, else the mesh's. */
static Status read_weights(Pose *pose, Gltf *g, const json_t *node, const json_t *mesh)
{
    const json_t *own = json_object_get(node, "weights"), *list = own ? own : json_object_get(mesh, "weights");
    if (json_array_size(list) > most_targets) return wrong(g, "more than 4096 morph targets");
    pose->weights = (int)json_array_size(list);
    for (int i = 0; i < pose->weights; i++) pose->weight[i] = json_number_value(json_array_get(list, (size_t)i));
    return STATUS_OK;
}

/* The inverse of a placement; false: it has none. */
static bool invert(double out[12], const double m[12])
{
    const double a[3] = {m[0], m[1], m[2]}, b[3] = {m[4], m[5], m[6]}, c[3] = {m[8], m[9], m[10]};
    double       bc[3], ca[3], ab[3];
    v3_cross(bc, b, c);
    v3_cross(ca, c, a);
    v3_cross(ab, a, b);
    const double det = v3_dot(a, bc);
    if (!(fabs(det) > 0) || !isfinite(1 / det)) return false;
    for (int i = 0; i < 3; i++) {
        out[4 * i] = bc[i] / det, out[4 * i + 1] = ca[i] / det, out[4 * i + 2] = ab[i] / det;
        out[4 * i + 3] = -(out[4 * i] * m[3] + out[4 * i + 1] * m[7] + out[4 * i + 2] * m[11]);
    }
    return true;
}

static Status read_skin(Pose *pose, Gltf *g, const json_t *node, int document_node)
{
    const json_t *skin =
        gltf_item(g, "skins", gltf_index(node, "skin", json_array_size(json_object_get(g->root, "skins"))));
    const json_t *list = json_object_get(skin, "joints");
    const size_t  count = json_array_size(list);
    double        to_node[12], *inverse = NULL;
    int           inverses = 0;
    if (!skin || count == 0) return STATUS_OK;
    if (count > most_joints) return wrong(g, "more than 65536 joints of a skin");
    if (!invert(to_node, g->world[document_node])) return STATUS_OK; /* it has no volume anyway */
    if (json_object_get(skin, "inverseBindMatrices")) {
        const Status status =
            gltf_accessor(&inverse, &inverses, g, attribute(g, skin, "inverseBindMatrices"), 16, "inverseBindMatrices");
        if (status != STATUS_OK) return status;
    }
    pose->joint = calloc(count, sizeof *pose->joint);
    Status status = pose->joint ? STATUS_OK : STATUS_NO_MEMORY;
    if (inverse && (size_t)inverses < count && status == STATUS_OK)
        status = wrong(g, "inverseBindMatrices are fewer than the skin's joints");
    for (size_t j = 0; j < count && status == STATUS_OK; j++) {
        const json_t    *value = json_array_get(list, j);
        const json_int_t joint = json_integer_value(value);
        double           bind[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, world[12];
        if (!json_is_integer(value) || joint < 0 || (size_t)joint >= g->nodes || !g->in_scene[joint]) {
            status = wrong(g, "a skin's joint is no node of the scene");
            break;
        }
        for (int i = 0; i < 12 && inverse; i++)
            bind[i] = inverse[16 * j + (size_t)(4 * (i % 4) + i / 4)]; /* glTF's matrices are by columns */
        gltf_place(world, g->world[joint], bind);
        gltf_place(pose->joint[j], to_node, world);
    }
    free(inverse);
    pose->joints = status == STATUS_OK ? (int)count : 0;
    return status;
}

/* Adds the draws of a shape that has been read, one for each time it is drawn. */
static Status add_draws(Gltf *g, const GltfDrawn *drawn, int shape)
{
    ImportScene     *s = g->scene;
    const GltfShape *of = &g->shape[shape];
    for (int i = 0; i < drawn->count; i++) {
        if (of->vertices > import_max_vertices - s->vertex_count) return wrong(g, "more than 8 M vertices");
        if (of->triangles > import_max_triangles - s->triangle_count) return wrong(g, "more than 8 M triangles");
        if (s->mesh_count == import_max_meshes) return wrong(g, "more than 16384 parts");
        if (!gltf_room(&g->draw, &g->draw_room, g->draw_count, sizeof *g->draw)) return STATUS_NO_MEMORY;
        g->draw[g->draw_count++] = (GltfDraw){drawn->first + i, shape};
        s->mesh_count++;
        s->vertex_count += of->vertices;
        s->triangle_count += of->triangles;
    }
    return STATUS_OK;
}

Status gltf_draw(Gltf *g, const GltfDrawn *drawn)
{
    const json_t *node = gltf_item(g, "nodes", drawn->document_node);
    const int     mesh = gltf_index(node, "mesh", g->meshes);
    const json_t *object = gltf_item(g, "meshes", mesh);
    json_t       *primitive;
    size_t        i;
    if (mesh < 0) return wrong(g, "a node's mesh is not there");
    const bool own = json_object_get(node, "weights") || json_object_get(node, "skin");
    Status     status = STATUS_OK;
    if (!own && g->cached[mesh][0] >= 0) {
        for (int k = 0; k < g->cached[mesh][1] && status == STATUS_OK; k++)
            status = add_draws(g, drawn, g->cached[mesh][0] + k);
        return status;
    }
    Pose *pose = calloc(1, sizeof *pose); /* too large for the stack */
    if (!pose) return STATUS_NO_MEMORY;
    const int first = g->shape_count;
    status = read_weights(pose, g, node, object);
    if (status == STATUS_OK) status = read_skin(pose, g, node, drawn->document_node);
    json_array_foreach(json_object_get(object, "primitives"), i, primitive)
    {
        GltfShape shape;
        bool      any = false;
        if (status != STATUS_OK) break;
        status = read_shape(&shape, &any, g, primitive, pose);
        if (any && !gltf_room(&g->shape, &g->shape_room, g->shape_count, sizeof *g->shape)) status = STATUS_NO_MEMORY;
        if (!any || status != STATUS_OK) {
            close_shape(&shape);
            continue;
        }
        g->shape[g->shape_count++] = shape;
        status = add_draws(g, drawn, g->shape_count - 1);
    }
    if (!own) g->cached[mesh][0] = first, g->cached[mesh][1] = g->shape_count - first;
    free(pose->joint);
    free(pose);
    return status;
}
