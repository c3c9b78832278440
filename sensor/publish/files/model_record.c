/* sensor/publish/files/model_record.c: what there is to say of a model, as JSON. Lengths in m, angles in deg. */
#include "sensor/publish/files/model_record.h"

#include "entities/import/sidecar.h"
#include "sensor/frame/json_object.h"

#include <stdlib.h>

/* Names and paths are other people's octets. */
static void set_text(json_t *object, const char *key, const char *text)
{
    char safe[4400];
    text_escape(safe, sizeof safe, text, strlen(text));
    json_object_set_new(object, key, json_string(safe));
}

static void set_count(json_t *object, const char *key, long long count)
{
    json_object_set_new(object, key, json_integer(count));
}

static json_t *numbers(const double *value, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(array, json_real(value[i] + 0.0));
    return array;
}

static json_t *import_json(const ModelImport *r)
{
    static const char *const source[MATERIAL_SOURCE_COUNT] = {"sidecar", "name", "colour", "default"};
    json_t                  *import = json_object(), *lost = json_object(), *left = json_object(), *by = json_object();
    char                     axis[4];
    set_text(import, "file", r->file);
    set_count(import, "octets", r->octets);
    if (r->sidecar[0]) set_text(import, "sidecar", r->sidecar);
    json_set_number(import, "scale_m", r->scale_m);
    set_text(import, "scale_from", r->unit_from);
    set_text(import, "forward", model_info_axis(axis, r, 0));
    set_text(import, "up", model_info_axis(axis, r, 1));
    set_text(import, "axes_from", r->axes_from);
    json_object_set_new(import, "mirrored", json_boolean(r->mirrored));
    json_object_set_new(import, "origin", numbers(r->p_origin_file, 3));
    set_count(import, "nodes", r->source_nodes);
    set_count(import, "meshes", r->source_meshes);
    set_count(import, "materials", r->source_materials);
    set_count(import, "unnamed_nodes", r->unnamed_nodes);
    set_count(import, "shared_names", r->shared_names);
    set_count(import, "joints_from_file", r->joints_from_file);
    set_count(import, "smoothed_parts", r->smoothed_parts);
    set_count(left, "meshes_by_sidecar", r->dropped_meshes);
    set_count(left, "meshes_without_triangles", r->empty_meshes);
    set_count(left, "triangles_without_area", r->degenerate_triangles);
    json_object_set_new(import, "left_out", left);
    for (int i = 0; i < IMPORT_LOST_COUNT; i++)
        if (r->lost[i] > 0) set_count(lost, import_lost_name((ImportLost)i), r->lost[i]);
    json_object_set_new(import, "lost", lost);
    for (int i = 0; i < MATERIAL_SOURCE_COUNT; i++) set_count(by, source[i], r->material_parts[i]);
    json_object_set_new(import, "material_parts_by", by);
    return import;
}

static json_t *node_json(const Model *m, const ModelNode *node)
{
    const bool turns = node->joint == JOINT_ROTATION;
    json_t    *out = json_object();
    set_text(out, "name", node->name);
    if (node->parent >= 0) {
        set_text(out, "parent", m->node[node->parent].name);
        json_object_set_new(out, "at_m", numbers(node->p_parent, 3));
    }
    if (node->joint == JOINT_FIXED) return out;
    set_text(out, "joint", turns ? "turns" : "slides");
    json_object_set_new(out, "axis", numbers(node->axis, 3));
    if (node->low <= node->high) {
        const double limit[2] = {turns ? node->low / rad_per_deg : node->low,
                                 turns ? node->high / rad_per_deg : node->high};
        json_object_set_new(out, turns ? "limits_deg" : "limits_m", numbers(limit, 2));
    }
    if (node->dis_class) {
        set_count(out, "dis_class", node->dis_class);
        set_count(out, "dis_metric", node->dis_metric);
    }
    if (node->spin_rps_moving != 0) json_set_number(out, "spin_rpm", node->spin_rps_moving * 60 / (2 * pi_rad));
    if (node->roll_radius_m > 0) json_set_number(out, "roll_radius_m", node->roll_radius_m);
    return out;
}

static json_t *part_json(const Model *m, const ModelPart *part)
{
    json_t *out = json_object();
    set_text(out, "name", part->name);
    set_text(out, "node", m->node[part->node].name);
    set_text(out, "material", part->material);
    set_text(out, "heat", heat_role_name(part->role));
    set_count(out, "triangles", part->triangle_count);
    if (part->thickness_m > 0) json_set_number(out, "thickness_mm", 1e3 * part->thickness_m);
    return out;
}

bool model_record_print(FILE *to, const ModelInfo *info)
{
    const Model *m = &info->model;
    const double size[3] = {m->length_m, m->width_m, m->height_m};
    json_t      *out = json_object(), *edges = json_object(), *nodes = json_array(), *parts = json_array();
    set_text(out, "model", m->name);
    if (info->imported) json_object_set_new(out, "import", import_json(&info->import));
    else json_set_number(out, "sag_m", m->sag_m);
    json_object_set_new(out, "size_m", numbers(size, 3));
    if (info->sized) {
        json_object_set_new(out, "size_fits", json_boolean(info->fit.fits));
        if (!info->fit.fits) set_text(out, "size_advice", info->fit.advice);
    }
    if (info->odd) set_text(out, "odd_size", info->advice);
    json_object_set_new(out, "box_low_m", numbers(m->box_low, 3));
    json_object_set_new(out, "box_high_m", numbers(m->box_high, 3));
    json_set_number(out, "radius_m", m->radius_m);
    set_count(out, "triangles", m->triangle_count);
    set_count(out, "vertices", m->vertex_count);
    set_count(edges, "open", info->edges.open);
    set_count(edges, "open_parts", info->edges.open_parts);
    set_count(edges, "crowded", info->edges.crowded);
    set_count(edges, "inside_out_parts", info->edges.inside_out_parts);
    json_object_set_new(out, "edges", edges);
    for (int i = 0; i < m->node_count; i++) json_array_append_new(nodes, node_json(m, &m->node[i]));
    for (int i = 0; i < m->part_count; i++) json_array_append_new(parts, part_json(m, &m->part[i]));
    json_object_set_new(out, "nodes", nodes);
    json_object_set_new(out, "parts", parts);
    char *text = json_dumps(out, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
    json_decref(out);
    if (text) text_print(to, "%s\n", text);
    free(text);
    return text != NULL;
}
