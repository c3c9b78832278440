/* entities/import/gltf.c: glTF 2.0, text (.gltf) and binary (.glb), in the reader's process: the document, its nodes,
 * materials and what is lost.
 *
 * assimp 5.2 reads glTF too, but takes quantised numbers for octets of a float, and passes over extensions that the
 * file says it cannot be read without. */
#include "entities/import/gltf_private.h"

#include <stdlib.h>

bool gltf_room(void *list, int *room, int count, size_t size)
{
    void **at = list;
    if (count < *room) return true;
    const int more = 2 * *room + 16;
    void     *larger = realloc(*at, (size_t)more * size);
    if (!larger) return false;
    *at = larger;
    *room = more;
    return true;
}

void gltf_place(double out[12], const double a[12], const double b[12])
{
    double m[12];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            m[4 * i + j] =
                a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] + (j == 3 ? a[4 * i + 3] : 0);
    memcpy(out, m, sizeof m);
}

/* ---- nodes ------------------------------------------------------------------------------------------ */

/* A placement from a translation, a quaternion x y z w of any length, and a scale. */
static void place_from_parts(double out[12], const double t[3], const double q[4], const double s[3])
{
    const double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], k = n > 0 ? 2 / n : 0;
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[9] = {1 - k * (y * y + z * z), k * (x * y - z * w),     k * (x * z + y * w),
                         k * (x * y + z * w),     1 - k * (x * x + z * z), k * (y * z - x * w),
                         k * (x * z - y * w),     k * (y * z + x * w),     1 - k * (x * x + y * y)};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) out[4 * i + j] = r[3 * i + j] * s[j];
        out[4 * i + 3] = t[i];
    }
}

static Status node_place(double out[12], Gltf *g, const json_t *node)
{
    double m[16], t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    bool   wrong = false;
    if (gltf_numbers(m, &wrong, node, "matrix", 16)) {
        for (int i = 0; i < 12; i++) out[i] = m[4 * (i % 4) + i / 4]; /* glTF's matrices are by columns */
    } else {
        gltf_numbers(t, &wrong, node, "translation", 3);
        gltf_numbers(q, &wrong, node, "rotation", 4);
        gltf_numbers(s, &wrong, node, "scale", 3);
        place_from_parts(out, t, q, s);
    }
    return wrong ? reader_fails(g->said, STATUS_BAD_VALUE,
                                "a node's matrix, translation, rotation or scale is no list of numbers")
                 : STATUS_OK;
}

static Status add_node(int *out, Gltf *g, const char *name, int parent, const double m[12])
{
    ImportScene *s = g->scene;
    if (s->node_count == import_max_nodes) return reader_fails(g->said, STATUS_BAD_VALUE, "more than 65536 nodes");
    if (!gltf_room(&s->node, &g->node_room, s->node_count, sizeof *s->node)) return STATUS_NO_MEMORY;
    ImportNode *node = &s->node[s->node_count];
    *node = (ImportNode){.parent = parent};
    snprintf(node->name, sizeof node->name, "%s", name);
    memcpy(node->m, m, sizeof node->m);
    *out = s->node_count++;
    return STATUS_OK;
}

/* Adds the instances of EXT_mesh_gpu_instancing: a node below `node` for each. */
static Status add_instances(GltfDrawn *drawn, Gltf *g, const json_t *attributes, int node)
{
    static const struct {
        const char *name;
        int         components;
    } part[3] = {{"TRANSLATION", 3}, {"ROTATION", 4}, {"SCALE", 3}};
    double *numbers[3] = {0};
    int     count = -1;
    Status  status = STATUS_OK;
    for (int k = 0; k < 3 && status == STATUS_OK; k++) {
        int n;
        if (!json_object_get(attributes, part[k].name)) continue;
        status =
            gltf_accessor(&numbers[k], &n, g,
                          gltf_index(attributes, part[k].name, json_array_size(json_object_get(g->root, "accessors"))),
                          part[k].components, part[k].name);
        if (status == STATUS_OK && count >= 0 && n != count)
            status = reader_fails(g->said, STATUS_BAD_VALUE, "instances: as many of %s as of the others are needed",
                                  part[k].name);
        count = n;
    }
    drawn->count = 0;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        static const double none[4] = {0, 0, 0, 1}, one[3] = {1, 1, 1};
        char                name[32];
        double              m[12];
        int                 at;
        place_from_parts(m, numbers[0] ? numbers[0] + 3 * i : none, numbers[1] ? numbers[1] + 4 * i : none,
                         numbers[2] ? numbers[2] + 3 * i : one);
        snprintf(name, sizeof name, "instance_%d", i);
        status = add_node(&at, g, name, node, m);
        if (i == 0) drawn->first = at;
        drawn->count++;
    }
    for (int k = 0; k < 3; k++) free(numbers[k]);
    return status;
}

static Status walk(Gltf *g, const json_t *index, int parent, const double above[12], int depth)
{
    const json_t *node =
        json_is_integer(index) && json_integer_value(index) >= 0 && (size_t)json_integer_value(index) < g->nodes
            ? gltf_item(g, "nodes", (int)json_integer_value(index))
            : NULL;
    const char *name = json_string_value(json_object_get(node, "name"));
    char        unnamed[32];
    double      m[12];
    int         at;
    size_t      i;
    json_t     *child;
    if (!node) return reader_fails(g->said, STATUS_BAD_VALUE, "a scene or node names a node that is not there");
    if (depth > import_max_depth) return reader_fails(g->said, STATUS_BAD_VALUE, "more than 256 levels of nodes");
    if (json_is_false(json_object_get(gltf_extension(node, "KHR_node_visibility"), "visible"))) {
        g->scene->lost[LOST_SWITCHED_OFF]++;
        return STATUS_OK;
    }
    const int own = (int)json_integer_value(index);
    snprintf(unnamed, sizeof unnamed, "nodes[%d]", own); /* as import_report_missing_node knows them */
    Status status = node_place(m, g, node);
    if (status == STATUS_OK) status = add_node(&at, g, name && *name ? name : unnamed, parent, m);
    if (status != STATUS_OK) return status;
    gltf_place(g->world[own], above, m);
    g->in_scene[own] = true;
    if (json_object_get(node, "mesh")) {
        const json_t *instances = json_object_get(gltf_extension(node, "EXT_mesh_gpu_instancing"), "attributes");
        if (!gltf_room(&g->drawn, &g->drawn_room, g->drawn_count, sizeof *g->drawn)) return STATUS_NO_MEMORY;
        GltfDrawn *drawn = &g->drawn[g->drawn_count++];
        *drawn = (GltfDrawn){own, at, 1};
        if (json_object_size(instances) > 0) status = add_instances(drawn, g, instances, at);
    }
    double below[12]; /* another visit of this node may change its entry in `world` */
    memcpy(below, g->world[own], sizeof below);
    json_array_foreach(json_object_get(node, "children"), i, child)
    {
        if (status != STATUS_OK) break;
        status = walk(g, child, at, below, depth + 1);
    }
    return status;
}

/* Walks the scene. If it has one node that is the root, else a node is put above all. Without a scene, the nodes
 * that are children of no other are taken. */
static Status walk_scene(Gltf *g)
{
    static const double here[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const size_t        scenes = json_array_size(json_object_get(g->root, "scenes"));
    json_t             *roots =
        json_incref(json_object_get(gltf_item(g, "scenes",
                                              json_object_get(g->root, "scene") ? gltf_index(g->root, "scene", scenes)
                                              : scenes > 0                      ? 0
                                                                                : -1),
                                    "nodes"));
    json_t *item, *node;
    size_t  i, k;
    int     root = -1;
    Status  status = STATUS_OK;
    if (!roots && scenes == 0) {
        bool *child = calloc(g->nodes + 1, sizeof *child);
        roots = json_array();
        if (!child || !roots) status = STATUS_NO_MEMORY;
        if (child)
            json_array_foreach(json_object_get(g->root, "nodes"), i, node) json_array_foreach(
                json_object_get(node, "children"), k,
                item) if (json_integer_value(item) >= 0 && (size_t)json_integer_value(item) < g->nodes)
                child[json_integer_value(item)] = true;
        for (i = 0; i < g->nodes && status == STATUS_OK; i++)
            if (!child[i] && json_array_append_new(roots, json_integer((json_int_t)i)) != 0) status = STATUS_NO_MEMORY;
        free(child);
    }
    if (status == STATUS_OK && json_array_size(roots) == 0)
        status = reader_fails(g->said, STATUS_BAD_VALUE, "no nodes in its scene");
    if (status == STATUS_OK && json_array_size(roots) > 1) status = add_node(&root, g, "ROOT", -1, here);
    json_array_foreach(roots, i, item)
    {
        if (status != STATUS_OK) break;
        status = walk(g, item, root, here, root < 0 ? 1 : 2);
    }
    if (status == STATUS_OK && g->scene->node_count == 0)
        status = reader_fails(g->said, STATUS_BAD_VALUE, "its only node is switched off");
    json_decref(roots);
    return status;
}

/* ---- materials and the rest --------------------------------------------------------------------------- */

static void fill_material(ImportMaterial *out, const json_t *material)
{
    const json_t *metallic = json_object_get(material, "pbrMetallicRoughness");
    const json_t *specular = gltf_extension(material, "KHR_materials_pbrSpecularGlossiness");
    const char   *name = json_string_value(json_object_get(material, "name"));
    double        rgba[4] = {1, 1, 1, 1};
    bool          wrong = false;
    snprintf(out->name, sizeof out->name, "%s", name ? name : "");
    if (specular) gltf_numbers(rgba, &wrong, specular, "diffuseFactor", 4);
    else gltf_numbers(rgba, &wrong, metallic, "baseColorFactor", 4);
    /* a texture on white gives no colour */
    out->has_colour =
        !json_object_get(specular ? specular : metallic, specular ? "diffuseTexture" : "baseColorTexture");
    for (int i = 0; i < 3; i++) out->rgb[i] = (float)rgba[i];
}

static void count_lost(Gltf *g)
{
    int    *lost = g->scene->lost;
    json_t *item;
    size_t  i;
    lost[LOST_TEXTURES] = gltf_textures(g);
    lost[LOST_LIGHTS] = (int)json_array_size(json_object_get(gltf_extension(g->root, "KHR_lights_punctual"), "lights"));
    lost[LOST_CAMERAS] = (int)json_array_size(json_object_get(g->root, "cameras"));
    lost[LOST_ANIMATIONS] = (int)json_array_size(json_object_get(g->root, "animations"));
    json_array_foreach(json_object_get(g->root, "skins"), i, item) lost[LOST_BONES] +=
        (int)json_array_size(json_object_get(item, "joints"));
    json_array_foreach(json_object_get(g->root, "meshes"), i, item) lost[LOST_MORPH_TARGETS] +=
        (int)json_array_size(json_object_get(json_array_get(json_object_get(item, "primitives"), 0), "targets"));
}

static bool fill_scene(Gltf *g)
{
    ImportScene    *s = g->scene;
    ImportNode     *node = s->node;
    ImportMaterial *material = s->material;
    const int       meshes = g->draw_count;
    s->node = NULL;
    s->material = NULL;
    const bool room = import_scene_room(s);
    if (room) memcpy(s->node, node, (size_t)s->node_count * sizeof *node);
    if (room) memcpy(s->material, material, (size_t)s->material_count * sizeof *material);
    free(node);
    free(material);
    s->vertex_count = s->triangle_count = 0;
    for (int m = 0; m < meshes && room; m++) {
        const GltfShape *shape = &g->shape[g->draw[m].shape];
        s->mesh[m] = (ImportMesh){.node = g->draw[m].node,
                                  .material = shape->material,
                                  .first_vertex = s->vertex_count,
                                  .vertex_count = shape->vertices,
                                  .first_triangle = s->triangle_count,
                                  .triangle_count = shape->triangles,
                                  .has_normals = shape->normal != NULL};
        memcpy(s->vertex[s->vertex_count], shape->vertex, (size_t)shape->vertices * sizeof *shape->vertex);
        if (shape->normal)
            memcpy(s->normal[s->vertex_count], shape->normal, (size_t)shape->vertices * sizeof *shape->normal);
        memcpy(s->triangle[s->triangle_count], shape->triangle, (size_t)shape->triangles * sizeof *shape->triangle);
        s->vertex_count += shape->vertices;
        s->triangle_count += shape->triangles;
    }
    return room;
}

/* ---- the document ----------------------------------------------------------------------------------- */

static uint32_t word_at(const char *at)
{
    const uint8_t *b = (const uint8_t *)at;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* Splits a GLB into its parts: 12 octets of header, then chunks of a length, a kind, and octets. */
static Status take_apart(const char **json, size_t *octets, Gltf *g)
{
    *json = g->text;
    *octets = g->octets;
    if (g->octets < 4 || memcmp(g->text, "glTF", 4) != 0) return STATUS_OK;
    if (g->octets < 20) return reader_fails(g->said, STATUS_BAD_VALUE, "ends within its header");
    if (word_at(g->text + 4) != 2)
        return reader_fails(g->said, STATUS_UNSUPPORTED, "binary glTF of version %u; version 2 is read: convert it",
                            word_at(g->text + 4));
    for (size_t at = 12; g->octets - at >= 8;) {
        const size_t length = word_at(g->text + at), kind = word_at(g->text + at + 4);
        const bool   first = at == 12;
        at += 8;
        if (length > g->octets - at)
            return reader_fails(g->said, STATUS_BAD_VALUE, "ends within a chunk: is it whole?");
        if (first && kind != 0x4e4f534a) return reader_fails(g->said, STATUS_BAD_VALUE, "its first chunk is no JSON");
        if (first) *json = g->text + at, *octets = length;
        else if (kind == 0x004e4942 && !g->binary) g->binary = g->text + at, g->binary_octets = length;
        at += length;
    }
    return STATUS_OK;
}

static Status open_document(Gltf *g)
{
    const char  *json;
    size_t       octets;
    json_error_t why;
    Status       status = take_apart(&json, &octets, g);
    if (status != STATUS_OK) return status;
    if (octets >= 3 && memcmp(json, "\xef\xbb\xbf", 3) == 0) json += 3, octets -= 3;
    while (octets > 0 && (json[octets - 1] == 0 || json[octets - 1] == ' ')) octets--; /* padding */
    g->root = json_loadb(json, octets, JSON_ALLOW_NUL, &why);
    if (!g->root) return reader_fails(g->said, STATUS_BAD_VALUE, "no glTF: line %d: %s", why.line, why.text);
    const json_t *asset = json_object_get(g->root, "asset");
    const char   *version = json_string_value(json_object_get(asset, "version"));
    const char   *least = json_string_value(json_object_get(asset, "minVersion"));
    if (!version || strncmp(version, "2.", 2) != 0 || (least && strcmp(least, "2.0") != 0))
        return reader_fails(g->said, STATUS_UNSUPPORTED, "glTF of version %.20s; 2.0 is read: convert it",
                            least && version ? least
                            : version        ? version
                                             : "unknown");
    g->nodes = json_array_size(json_object_get(g->root, "nodes"));
    g->meshes = json_array_size(json_object_get(g->root, "meshes"));
    g->buffer_count = json_array_size(json_object_get(g->root, "buffers"));
    if (g->buffer_count > 65536 || json_array_size(json_object_get(g->root, "materials")) >= import_max_materials)
        return reader_fails(g->said, STATUS_BAD_VALUE, "more than 65536 buffers or 16383 materials");
    g->buffer = calloc(g->buffer_count + 1, sizeof *g->buffer);
    g->world = calloc(g->nodes + 1, sizeof *g->world);
    g->in_scene = calloc(g->nodes + 1, sizeof *g->in_scene);
    g->cached = malloc((g->meshes + 1) * sizeof *g->cached);
    if (!g->buffer || !g->world || !g->in_scene || !g->cached) return STATUS_NO_MEMORY;
    for (size_t m = 0; m < g->meshes; m++) g->cached[m][0] = -1;
    return STATUS_OK;
}

static Status read_document(Gltf *g)
{
    ImportScene *s = g->scene;
    Status       status = open_document(g);
    if (status == STATUS_OK) status = gltf_extensions(g);
    if (status != STATUS_OK) return status;
    const json_t *materials = json_object_get(g->root, "materials");
    s->material_count = (int)json_array_size(materials) + 1;
    s->material = calloc((size_t)s->material_count, sizeof *s->material);
    if (!s->material) return STATUS_NO_MEMORY;
    for (int m = 0; m < s->material_count; m++) fill_material(&s->material[m], json_array_get(materials, (size_t)m));
    snprintf(s->material[s->material_count - 1].name, model_name_size,
             "DefaultMaterial"); /* the material of parts without one */
    status = walk_scene(g);
    for (int i = 0; i < g->drawn_count && status == STATUS_OK; i++) status = gltf_draw(g, &g->drawn[i]);
    if (status == STATUS_OK && !fill_scene(g)) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    count_lost(g);
    s->forward[2] = s->up[1] = s->unit_m = 1;
    snprintf(s->unit_from, sizeof s->unit_from, "glTF's standard: metres");
    snprintf(s->axes_from, sizeof s->axes_from, "glTF's standard");
    return STATUS_OK;
}

Status import_gltf_text(ImportScene *s, ReaderSaid *said, ReaderFiles *files, char *text, size_t octets)
{
    Gltf         g = {.files = files, .said = said, .scene = s, .text = text, .octets = octets};
    const Status status = read_document(&g);
    gltf_shapes_close(&g);
    gltf_buffers_close(&g);
    free(g.drawn);
    free(g.world);
    free(g.in_scene);
    json_decref(g.root);
    return status;
}

static Status gltf_read(ImportScene *s, ReaderSaid *said, ReaderFiles *files, const char *extension)
{
    char  *text;
    size_t octets;
    (void)extension;
    Status status = reader_read(&text, &octets, files, files->shown);
    if (status != STATUS_OK) return reader_fails(said, status, "it cannot be unpacked, or is larger than 256 MiB");
    status = import_gltf_text(s, said, files, text, octets);
    free(text);
    return status;
}

Status import_gltf(ImportScene *out, const char *path, const char *extension)
{
    return reader_run(out, gltf_read, path, extension);
}
