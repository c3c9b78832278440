/* entities/import/model_import.c: a flat scene and its sidecar -> a Model. */
#include "entities/import/model_import_private.h"

#include <stdlib.h>

const char *import_lost_name(ImportLost lost)
{
    static const char *const name[IMPORT_LOST_COUNT] = {
        "textures",        "lights",           "cameras",          "animations",   "bones",
        "morph_targets",   "points_and_lines", "levels_of_detail", "switched_off", "external_references",
        "freedom_offsets", "other_objects",
    };
    return (unsigned)lost < IMPORT_LOST_COUNT ? name[lost] : "?";
}

/* ---- building ------------------------------------------------------------------------------------------------ */

typedef struct Build {
    const ImportScene  *scene;
    const Sidecar      *sidecar;
    const ImportPaints *paints;
    ImportJoints        joints;
    ModelImport        *report;
    Model               model;
    int                 vertex_room, triangle_room;
} Build;

static void to_body(double p_body[3], const ModelImport *r, const double p_file[3])
{
    double off[3];
    v3_sub(off, p_file, r->p_origin_file);
    m3_mul_v3(p_body, r->r_body_from_file, off);
    v3_scale(p_body, r->scale_m, p_body);
}

static void node_to_file(double p_file[3], const double m[12], const double p[3])
{
    for (int i = 0; i < 3; i++) p_file[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
}

static void set_frame(Build *b)
{
    ModelImport   *r = b->report;
    const Sidecar *s = b->sidecar;
    const double  *forward = s->has_axes ? s->forward : b->scene->forward, *up = s->has_axes ? s->up : b->scene->up;
    double         right[3];
    v3_cross(right, forward, up);
    for (int i = 0; i < 3; i++) {
        r->r_body_from_file[i] = forward[i];
        r->r_body_from_file[3 + i] = right[i];
        r->r_body_from_file[6 + i] = -up[i] + 0.0;
    }
    r->axes_assumed = !s->has_axes;
    r->scale_assumed = !(s->scale_m > 0);
    r->scale_m = r->scale_assumed ? b->scene->unit_m : s->scale_m;
    r->mirrored = b->scene->mirrored;
    static const char sidecar[sizeof r->unit_from] = "the sidecar";
    memcpy(r->unit_from, r->scale_assumed ? b->scene->unit_from : sidecar, sizeof sidecar);
    memcpy(r->axes_from, r->axes_assumed ? b->scene->axes_from : sidecar, sizeof sidecar);
}

/* Sets the origin at the centre of the base: over the middle of what does not move (DIS measures an entity without its
 * articulated parts), as low as the lowest part. */
static Status set_origin(Build *b)
{
    const double low0[3] = {INFINITY, INFINITY, INFINITY};
    double       low[2][3],
        high[2]
            [3]; /* extents in body directions from the file's origin: [0] of everything, [1] of what does not move */
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            low[k][i] = low0[i];
            high[k][i] = -low0[i];
        }
    for (int m = 0; m < b->scene->mesh_count; m++) {
        const ImportMesh  *mesh = &b->scene->mesh[m];
        const ImportPlace *place = &b->joints.place[mesh->node];
        if (place->dropped) continue;
        for (int t = 3 * mesh->first_triangle; t < 3 * (mesh->first_triangle + mesh->triangle_count); t++) {
            double p_file[3], p[3];
            node_to_file(p_file, place->m,
                         b->scene->vertex[mesh->first_vertex + (int)b->scene->triangle[t / 3][t % 3]]);
            if (!v3_is_finite(p_file)) {
                log_error("model: a coordinate is not a finite number: file=%s node=%s", b->report->file,
                          b->scene->node[mesh->node].name);
                return STATUS_BAD_VALUE;
            }
            m3_mul_v3(p, b->report->r_body_from_file, p_file);
            for (int k = 0; k < (place->joint < 0 ? 2 : 1); k++)
                for (int i = 0; i < 3; i++) {
                    low[k][i] = fmin(low[k][i], p[i]);
                    high[k][i] = fmax(high[k][i], p[i]);
                }
        }
    }
    if (!(low[0][0] <= high[0][0])) {
        log_error("model: nothing to see: file=%s: no triangles%s", b->report->file,
                  b->sidecar->drop.count > 0 ? " that the sidecar does not drop" : "");
        return STATUS_BAD_VALUE;
    }
    double reach = 0;
    for (int i = 0; i < 3; i++) reach = fmax(reach, fmax(fabs(low[0][i]), fabs(high[0][i])));
    if (!(reach * b->report->scale_m <= 1e5)) {
        log_error("model: larger than 100 km: file=%s reach_m=%g: set `scale` in the sidecar", b->report->file,
                  reach * b->report->scale_m);
        return STATUS_BAD_VALUE;
    }
    if (b->sidecar->has_origin) {
        memcpy(b->report->p_origin_file, b->sidecar->p_origin_file, sizeof b->report->p_origin_file);
    } else {
        const int    k = low[1][0] <= high[1][0];
        const double base[3] = {0.5 * (low[k][0] + high[k][0]), 0.5 * (low[k][1] + high[k][1]), high[0][2]};
        m3_tmul_v3(b->report->p_origin_file, b->report->r_body_from_file, base);
        for (int i = 0; i < 3; i++) b->report->p_origin_file[i] += 0.0; /* no -0 */
    }
    return STATUS_OK;
}

/* Printable, without the separators of names in output files (`,;:"\`), and never empty. */
static void clean_name(char out[model_name_size], const char *name, const char *instead)
{
    size_t n = 0;
    for (; name[n] && n < model_name_size - 1; n++)
        out[n] = name[n] <= ' ' || name[n] >= 0x7f || strchr(",;:\"\\", name[n]) ? '_' : name[n];
    out[n] = 0;
    if (n == 0) snprintf(out, model_name_size, "%s", instead);
}

/* `name~2`, `name~3` ... for those that are called the same; `step` octets lie from one name to the next. */
static void make_unique(char name[model_name_size], const char *taken, int count, size_t step)
{
    char      base[model_name_size];
    const int room = model_name_size - 12; /* leaves room for ~ and a number */
    int       number = 1;
    memcpy(base, name, sizeof base);
    for (int i = 0; i < count; i++) {
        const char  *other = taken + (size_t)i * step;
        const size_t length = strlen(base);
        number += strcmp(other, base) == 0 || (strncmp(other, base, length) == 0 && other[length] == '~');
    }
    for (; number > 1; number++) {
        snprintf(name, model_name_size, "%.*s~%d", room, base, number);
        int i = 0;
        while (i < count && strcmp(taken + (size_t)i * step, name) != 0) i++;
        if (i == count) return;
    }
}

/* Rodrigues; see model.c; this inverts its joints at rest. */
static void turned(double r[9], const double a[3], double angle_rad)
{
    const double c = cos(angle_rad), s = sin(angle_rad), v = 1 - c;
    const double m[9] = {c + v * a[0] * a[0],        v * a[0] * a[1] - s * a[2], v * a[0] * a[2] + s * a[1],
                         v * a[0] * a[1] + s * a[2], c + v * a[1] * a[1],        v * a[1] * a[2] - s * a[0],
                         v * a[0] * a[2] - s * a[1], v * a[1] * a[2] + s * a[0], c + v * a[2] * a[2]};
    memcpy(r, m, sizeof m);
}

/* Builds the nodes. Node 0 is what does not move; a joint's node has body axes in the file's pose, at its pivot. */
static Status build_nodes(Build *b)
{
    Model *m = &b->model;
    m->node = calloc((size_t)b->joints.count + 1, sizeof *m->node);
    if (!m->node) return STATUS_NO_MEMORY;
    m->node_count = b->joints.count + 1;
    strcpy(m->node[0].name, "hull");
    m->node[0].parent = -1;
    m->node[0].low = 1;
    m->node[0].high = -1;
    m3_identity(m->node[0].r_parent_from_node);
    for (int j = 0; j < b->joints.count; j++) {
        const ImportJoint *joint = &b->joints.joint[j];
        ModelNode         *node = &m->node[j + 1];
        double             p_body[3], p_above[3] = {0, 0, 0};
        clean_name(node->name, joint->name, "joint");
        make_unique(node->name, m->node[0].name, j + 1, sizeof *m->node);
        node->parent = joint->parent + 1;
        to_body(p_body, b->report, joint->p_pivot_file);
        if (joint->parent >= 0) to_body(p_above, b->report, b->joints.joint[joint->parent].p_pivot_file);
        v3_sub(node->p_parent, p_body, p_above);
        node->joint = joint->kind;
        memcpy(node->axis, joint->axis_body, sizeof node->axis);
        turned(node->r_parent_from_node, joint->axis_body, joint->kind == JOINT_ROTATION ? -joint->rest : 0);
        node->dis_class = joint->dis_class;
        node->dis_metric = joint->dis_metric;
        node->low = joint->low;
        node->high = joint->high;
        node->spin_rps_moving = joint->spin_rps;
        node->roll_radius_m = joint->roll_radius_m;
        b->report->joints_from_file += joint->from_file;
    }
    return STATUS_OK;
}

static Status check_materials(const Build *b)
{
    const SidecarRules *rules[] = {&b->sidecar->materials, &b->sidecar->node_materials, &b->sidecar->damage_materials};
    for (size_t k = 0; k < sizeof rules / sizeof *rules; k++)
        for (int i = 0; i < rules[k]->count; i++)
            if (!import_paints_have(b->paints, rules[k]->rule[i].value)) {
                log_error("sidecar: %s:%d: materials: '%s' is not a row of etc/materials.csv, nor of your own "
                          "(models.materials)",
                          b->sidecar->path, rules[k]->rule[i].line, rules[k]->rule[i].value);
                return STATUS_BAD_VALUE;
            }
    return STATUS_OK;
}

/* Reports patterns of the sidecar without a match: a typing error, or a general rule for many models. */
static void warn_unused(const Build *b)
{
    const struct {
        const SidecarRules *rules;
        const char         *key;
    } list[] = {{&b->sidecar->drop, "drop"},
                {&b->sidecar->node_materials, "node_materials"},
                {&b->sidecar->roles, "roles"},
                {&b->sidecar->thickness, "thickness_mm"},
                {&b->sidecar->damage_hide, "damage.hide"},
                {&b->sidecar->damage_materials, "damage.materials"},
                {&b->sidecar->materials, "materials"}};
    for (size_t k = 0; k < sizeof list / sizeof *list; k++)
        for (int i = 0; i < list[k].rules->count; i++) {
            const SidecarRule *rule = &list[k].rules->rule[i];
            bool               used = false;
            if (list[k].rules == &b->sidecar->materials) {
                for (int m = 0; m < b->scene->material_count && !used; m++)
                    used = import_matches(rule->pattern, b->scene->material[m].name);
            } else {
                for (int n = 0; n < b->scene->node_count && !used; n++)
                    used = import_matches(rule->pattern, b->scene->node[n].name) ||
                           import_matches(rule->pattern, b->joints.place[n].path);
            }
            if (!used)
                log_warn("sidecar: %s:%d: %s: nothing matches '%s'", b->sidecar->path, rule->line, list[k].key,
                         rule->pattern);
        }
}

static void surface_part(Build *b, ModelPart *part, const ImportMesh *mesh)
{
    const ImportMaterial *material = &b->scene->material[mesh->material];
    const ImportPlace    *place = b->joints.place;
    const SidecarRule    *rule = import_rule(&b->sidecar->node_materials, b->scene, place, mesh->node, 0);
    ImportMaterialSource  source = MATERIAL_BY_SIDECAR;
    const char           *name = rule ? rule->value : NULL;
    for (int i = b->sidecar->materials.count - 1; i >= 0 && !name; i--)
        if (import_matches(b->sidecar->materials.rule[i].pattern, material->name))
            name = b->sidecar->materials.rule[i].value;
    if (!name) name = import_paint_guess(&source, b->paints, material);
    snprintf(part->material, sizeof part->material, "%s", name);
    b->report->material_parts[source]++;

    const SidecarRule *role = import_rule(&b->sidecar->roles, b->scene, place, mesh->node, 0);
    if (!role || !heat_role_find(&part->role, role->value)) part->role = import_role_guess(place[mesh->node].path);
    const SidecarRule *skin = import_rule(&b->sidecar->thickness, b->scene, place, mesh->node, 0);
    double             thickness_mm;
    if (skin && text_to_double(&thickness_mm, skin->value)) part->thickness_m = 1e-3 * thickness_mm;
    for (int state = 1; state < model_damage_states; state++) {
        const SidecarRule *other = import_rule(&b->sidecar->damage_materials, b->scene, place, mesh->node, state);
        if (import_rule(&b->sidecar->damage_hide, b->scene, place, mesh->node, state))
            part->damage_hidden |= (uint8_t)(1 << state);
        if (other) snprintf(part->damage_material[state], sizeof part->damage_material[state], "%s", other->value);
    }
}

/* Whether a triangle has an area: two corners at one place, or all on a line, has none. */
static bool has_area(const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3], bc[3], n[3];
    v3_sub(ab, b, a);
    v3_sub(ac, c, a);
    v3_sub(bc, c, b);
    v3_cross(n, ab, ac);
    const double shortest = fmin(v3_dot(ab, ab), fmin(v3_dot(ac, ac), v3_dot(bc, bc)));
    const double longest = fmax(v3_dot(ab, ab), fmax(v3_dot(ac, ac), v3_dot(bc, bc)));
    return shortest > 0 && v3_length(n) > 1e-12 * longest;
}

/* The matrix that transforms normals: the inverse transpose of a placement's linear part, times its determinant, which
 * is returned. */
static double normal_matrix(double out[9], const double m[12])
{
    const double r0[3] = {m[0], m[1], m[2]}, r1[3] = {m[4], m[5], m[6]}, r2[3] = {m[8], m[9], m[10]};
    v3_cross(out, r1, r2);
    v3_cross(out + 3, r2, r0);
    v3_cross(out + 6, r0, r1);
    return v3_dot(r0, out);
}

/* Builds a part from a mesh of the file. */
static Status build_part(Build *b, const ImportMesh *mesh)
{
    Model             *m = &b->model;
    const ImportPlace *place = &b->joints.place[mesh->node];
    const int          node = place->joint + 1;
    double             p_pivot[3] = {0, 0, 0}, flip[9];
    Status             status = STATUS_NO_MEMORY;
    const double       determinant = normal_matrix(flip, place->m);
    double(*corner)[3] = malloc(((size_t)mesh->triangle_count * 3 + 1) * sizeof *corner);
    uint32_t(*from)[3] = malloc(((size_t)mesh->triangle_count + 1) * sizeof *from);
    if (!corner || !from) goto done;
    if (place->joint >= 0) to_body(p_pivot, b->report, b->joints.joint[place->joint].p_pivot_file);

    int triangles = 0;
    for (int t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count; t++) {
        double(*c)[3] = corner + 3 * triangles;
        for (int k = 0; k < 3; k++) {
            /* a mirrored placement turns every triangle inside out */
            const uint32_t v = b->scene->triangle[t][determinant < 0 ? 2 - k : k];
            double         p_file[3];
            node_to_file(p_file, place->m, b->scene->vertex[mesh->first_vertex + (int)v]);
            to_body(c[k], b->report, p_file);
            v3_sub(c[k], c[k], p_pivot);
            from[triangles][k] = v;
        }
        if (has_area(c[0], c[1], c[2])) triangles++;
        else b->report->degenerate_triangles++;
    }
    if (triangles == 0) {
        b->report->empty_meshes++;
        status = STATUS_OK;
        goto done;
    }

    ModelPart *part = &m->part[m->part_count];
    *part = (ModelPart){.node = node, .first_triangle = m->triangle_count, .triangle_count = triangles};
    clean_name(part->name, b->scene->node[mesh->node].name, "part");
    make_unique(part->name, m->part[0].name, m->part_count, sizeof *m->part);
    surface_part(b, part, mesh);

    const int first = m->vertex_count;
    if (mesh->has_normals) {
        for (int t = 0; t < triangles; t++)
            for (int k = 0; k < 3; k++) {
                /* triangles share the file's vertices, which are kept where they are, even unused ones */
                const int v = first + (int)from[t][k];
                memcpy(m->vertex[v], corner[3 * t + k], sizeof m->vertex[v]);
                m->triangle[m->triangle_count + t][k] = (uint32_t)v;
            }
        double plane[3];
        for (int t = 0; t < triangles; t++)
            for (int k = 0; k < 3; k++) {
                const int    v = first + (int)from[t][k];
                const float *n_node = b->scene->normal[mesh->first_vertex + (int)from[t][k]];
                const double n[3] = {n_node[0], n_node[1], n_node[2]};
                double       n_file[3], n_body[3], ab[3], ac[3];
                m3_mul_v3(n_file, flip, n);
                if (determinant < 0) v3_scale(n_file, -1, n_file);
                m3_mul_v3(n_body, b->report->r_body_from_file, n_file);
                if (!v3_normalize(n_body,
                                  n_body)) { /* there is no normal, or it is not a number: the facet's own is taken */
                    v3_sub(ab, corner[3 * t + 1], corner[3 * t]);
                    v3_sub(ac, corner[3 * t + 2], corner[3 * t]);
                    v3_cross(plane, ab, ac);
                    if (!v3_normalize(n_body, plane)) n_body[0] = 1, n_body[1] = n_body[2] = 0;
                }
                for (int i = 0; i < 3; i++) m->normal[v][i] = (float)n_body[i];
            }
        m->vertex_count += mesh->vertex_count;
    } else {
        const int count = import_smooth(m->vertex + first, m->normal + first, m->triangle + m->triangle_count,
                                        (const double(*)[3])corner, triangles, b->sidecar->crease_rad);
        if (count < 0) goto done;
        for (int t = 0; t < triangles; t++)
            for (int k = 0; k < 3; k++) m->triangle[m->triangle_count + t][k] += (uint32_t)first;
        m->vertex_count += count;
        b->report->smoothed_parts++;
    }
    for (int t = 0; t < triangles; t++) m->triangle_part[m->triangle_count + t] = (uint16_t)m->part_count;
    m->triangle_count += triangles;
    m->part_count++;
    status = STATUS_OK;

done:
    free(corner);
    free(from);
    return status;
}

static Status build_parts(Build *b)
{
    Model *m = &b->model;
    size_t vertices = 0, triangles = 0;
    for (int i = 0; i < b->scene->mesh_count; i++) {
        const ImportMesh *mesh = &b->scene->mesh[i];
        vertices += mesh->has_normals ? (size_t)mesh->vertex_count : 3 * (size_t)mesh->triangle_count;
        triangles += (size_t)mesh->triangle_count;
    }
    m->part = calloc((size_t)b->scene->mesh_count + 1, sizeof *m->part);
    m->vertex = calloc(vertices + 1, sizeof *m->vertex);
    m->normal = calloc(vertices + 1, sizeof *m->normal);
    m->triangle = calloc(triangles + 1, sizeof *m->triangle);
    m->triangle_part = calloc(triangles + 1, sizeof *m->triangle_part);
    if (!m->part || !m->vertex || !m->normal || !m->triangle || !m->triangle_part) return STATUS_NO_MEMORY;
    for (size_t v = 0; v < vertices; v++) m->normal[v][0] = 1; /* gives vertices that no triangle uses a normal */
    /* parts of a node must be neighbours */
    for (int node = 0; node < m->node_count; node++)
        for (int i = 0; i < b->scene->mesh_count; i++) {
            const ImportMesh  *mesh = &b->scene->mesh[i];
            const ImportPlace *place = &b->joints.place[mesh->node];
            if (place->joint + 1 != node) continue;
            if (place->dropped) {
                b->report->dropped_meshes++;
                continue;
            }
            const Status status = build_part(b, mesh);
            if (status != STATUS_OK) return status;
        }
    if (m->triangle_count == 0) {
        log_error("model: nothing to see: file=%s: every triangle is without area", b->report->file);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static void name_model(Build *b)
{
    char        extension[16], stem_name[model_name_size];
    size_t      stem;
    const char *slash = strrchr(b->report->file, '/');
    import_split_extension(extension, &stem, b->report->file);
    const size_t from = slash ? (size_t)(slash - b->report->file) + 1 : 0;
    snprintf(stem_name, sizeof stem_name, "%.*s", stem > from ? (int)(stem - from) : 0, b->report->file + from);
    clean_name(b->model.name, b->sidecar->name[0] ? b->sidecar->name : stem_name, "model");
}

static Status build_model(Build *b)
{
    set_frame(b);
    Status status = check_materials(b);
    if (status == STATUS_OK)
        status = import_joints(&b->joints, b->scene, b->sidecar, b->report->r_body_from_file, b->report->scale_m);
    if (status == STATUS_OK) status = set_origin(b);
    if (status == STATUS_OK) status = build_nodes(b);
    if (status == STATUS_OK) status = build_parts(b);
    if (status != STATUS_OK) return status;
    name_model(b);
    warn_unused(b);
    import_warn_names(b->scene, b->joints.place, b->sidecar, b->report->file);
    status = model_measure(&b->model);
    if (status == STATUS_OK) status = model_check(&b->model);
    return status == STATUS_OK ? model_edges(&b->report->edges, &b->model) : status;
}

Status model_import(Model *out, ModelImport *report, const char *path)
{
    ModelImport  filled = {0};
    Sidecar      sidecar = sidecar_default();
    ImportScene  scene = {0};
    ImportPaints paints = {0};
    char         extension[16];
    size_t       stem;
    Status       status = import_find_files(&filled, &sidecar, path);
    if (status == STATUS_OK) {
        import_split_extension(extension, &stem, filled.file);
        if (strcmp(extension, "flt") == 0) status = import_openflight(&scene, filled.file);
        else if (strcmp(extension, "gltf") == 0 || strcmp(extension, "glb") == 0 || strcmp(extension, "vrm") == 0)
            status = import_gltf(&scene, filled.file, extension);
        else status = import_assimp(&scene, filled.file, extension);
    }
    if (status == STATUS_OK) status = import_paints_open(&paints);
    Build b = {.scene = &scene, .sidecar = &sidecar, .paints = &paints, .report = &filled};
    if (status == STATUS_OK) status = build_model(&b);
    if (status == STATUS_NO_MEMORY) log_error("model: no memory: file=%s", filled.file);
    import_count_names(&filled.unnamed_nodes, &filled.shared_names, &scene);
    filled.source_nodes = scene.node_count;
    filled.source_meshes = scene.mesh_count;
    filled.source_materials = scene.material_count;
    memcpy(filled.lost, scene.lost, sizeof filled.lost);
    import_joints_close(&b.joints, scene.node_count);
    import_scene_close(&scene);
    import_paints_close(&paints);
    sidecar_close(&sidecar);
    if (status == STATUS_OK) {
        *out = b.model;
        if (report) *report = filled;
    } else {
        model_destroy(&b.model);
    }
    return status;
}

void model_import_say(const ModelImport *r, const Model *model)
{
    char   lost[400] = "nothing";
    size_t n = 0;
    for (int i = 0; i < IMPORT_LOST_COUNT && n < sizeof lost; i++)
        if (r->lost[i] > 0)
            n += (size_t)snprintf(lost + n, sizeof lost - n, "%s%d %s", n ? ", " : "", r->lost[i],
                                  import_lost_name((ImportLost)i));
    log_info("model: %s: %.4g x %.4g x %.4g m, %d triangles; %.9g m a unit (%s), axes by %s; lost: %s; sidecar: %s%s",
             r->file, model->length_m, model->width_m, model->height_m, model->triangle_count, r->scale_m, r->unit_from,
             r->axes_from, lost, r->sidecar[0] ? r->sidecar : "none",
             r->scale_assumed || r->axes_assumed ? " (`scale`, `axes` there say otherwise)" : "");
}
