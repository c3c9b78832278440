/* entities/catalog/model_info.c: what `pitviper model info` prints of one model. */
#include "entities/catalog/model_info.h"

#include "entities/catalog/model_fit.h"
#include "entities/import/model_import.h"
#include "entities/parametric/parametric.h"
#include "entities/import/sidecar.h"

#include <stdlib.h>

static void print_import(const ModelImport *r)
{
    static const char *const source[MATERIAL_SOURCE_COUNT] = {"the sidecar", "the name in the file",
                                                              "the nearest colour", "nothing: paint_olive"};
    text_print(stdout, "file: %s\nsidecar: %s\n", r->file, r->sidecar[0] ? r->sidecar : "none");
    const double *m = r->r_body_from_file;
    char axes[2][3];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            const double along = k == 0 ? m[i] : -m[6 + i];
            if (fabs(along) > 0.5) snprintf(axes[k], sizeof axes[k], "%c%c", along > 0 ? '+' : '-', "xyz"[i]);
        }
    text_print(stdout, "axes of the file: %s forward, %s up (%s)\n", axes[0], axes[1],
           r->axes_assumed ? "the format's habit; `axes` in a sidecar says otherwise" : "from the sidecar");
    text_print(stdout, "scale: %g m a unit\n", r->scale_m);
    text_print(stdout, "origin in the file: %g %g %g\n", r->p_origin_file[0], r->p_origin_file[1], r->p_origin_file[2]);
    text_print(stdout, "in the file: %d nodes, %d meshes, %d materials\n", r->source_nodes, r->source_meshes,
               r->source_materials);
    if (r->unnamed_nodes || r->shared_names)
        text_print(
            stdout,
            "names: %d nodes have none, %d share theirs with another: a sidecar tells nodes apart by name and path\n",
            r->unnamed_nodes, r->shared_names);
    text_print(stdout, "left out: %d meshes by the sidecar, %d without triangles, %d triangles without area\n",
               r->dropped_meshes, r->empty_meshes, r->degenerate_triangles);
    text_print(stdout, "lost:");
    int kinds = 0;
    for (int i = 0; i < IMPORT_LOST_COUNT; i++)
        if (r->lost[i] > 0)
            text_print(stdout, "%s %d %s", kinds++ ? "," : "", r->lost[i], import_lost_name((ImportLost)i));
    text_print(stdout, "%s\n", kinds ? "" : " nothing");
    text_print(stdout, "joints from the file: %d\n", r->joints_from_file);
    text_print(stdout, "normals: of %d parts by crease angle, of the others from the file\n", r->smoothed_parts);
    for (int i = 0; i < MATERIAL_SOURCE_COUNT; i++)
        if (r->material_parts[i] > 0)
            text_print(stdout, "materials of %d parts by %s\n", r->material_parts[i], source[i]);
}

static void print_limits(const ModelNode *node)
{
    const bool turns = node->joint == JOINT_ROTATION;
    if (node->low > node->high)
        text_print(stdout, " free");
    else if (turns)
        text_print(stdout, " %g .. %g deg", node->low / rad_per_deg, node->high / rad_per_deg);
    else
        text_print(stdout, " %g .. %g m", node->low, node->high);
}

static void print_nodes(const Model *m)
{
    text_print(stdout, "\nnodes: %d\n", m->node_count);
    for (int i = 0; i < m->node_count; i++) {
        const ModelNode *node = &m->node[i];
        char text[32];
        const char *named = sidecar_class_text(text, node->dis_class), *metric = sidecar_metric_text(node->dis_metric);
        text_print(stdout, "  %3d %s", i, node->name);
        if (node->parent >= 0)
            text_print(stdout, " on %s at %.3f %.3f %.3f", m->node[node->parent].name, node->p_parent[0],
                       node->p_parent[1], node->p_parent[2]);
        if (node->joint != JOINT_FIXED) {
            text_print(stdout, ", %s %.3f %.3f %.3f", node->joint == JOINT_ROTATION ? "turns about" : "slides along",
                       node->axis[0], node->axis[1], node->axis[2]);
            print_limits(node);
            if (node->dis_class)
                text_print(stdout, ", DIS class %u%s%s metric %u %s", node->dis_class, named ? " " : "",
                           named ? named : "", node->dis_metric, metric ? metric : "?");
            if (node->spin_rps_moving != 0)
                text_print(stdout, ", spins at %g rpm", node->spin_rps_moving * 60 / (2 * pi_rad));
            if (node->roll_radius_m > 0) text_print(stdout, ", rolls on %.3f m", node->roll_radius_m);
        }
        putchar('\n');
    }
}

static void print_parts(const Model *m)
{
    text_print(stdout, "\nparts: %d\n", m->part_count);
    for (int i = 0; i < m->part_count; i++) {
        const ModelPart *part = &m->part[i];
        text_print(stdout, "  %3d %s on %s, %s, heat %s, %d triangles", i, part->name, m->node[part->node].name,
                   part->material, heat_role_name(part->role), part->triangle_count);
        if (part->thickness_m > 0) text_print(stdout, ", skin %g mm", 1e3 * part->thickness_m);
        for (int state = 1; state < model_damage_states; state++) {
            if (part->damage_hidden >> state & 1)
                text_print(stdout, ", damage %d: hidden", state);
            else if (part->damage_material[state][0])
                text_print(stdout, ", damage %d: %s", state, part->damage_material[state]);
        }
        putchar('\n');
    }
}

int model_info(const char *name, const ModelSize *size, double sag_m)
{
    const bool sized = size->length_m > 0 || size->width_m > 0 || size->height_m > 0;
    Model model;
    ModelImport report = {0};
    ModelEdges edges;
    bool imported;
    Status status = STATUS_OK;
    imported = false;
    if (sized && parametric_known(name))
        status = parametric_build_size(&model, name, size, sag_m);
    else
        status = model_open(&model, &report, &imported, name, sag_m);
    if (status == STATUS_NO_MEMORY) log_error("model: %s: %s", name, status_name(status));
    if (status != STATUS_OK) return 1; /* all other errors were reported where they occurred */
    if (model_edges(&edges, &model) != STATUS_OK) {
        model_destroy(&model);
        log_error("model: no memory: %s", name);
        return 1;
    }
    text_print(stdout, "model: %s\n", model.name);
    if (imported)
        print_import(&report);
    else
        text_print(stdout, "built in, facets within %g m of their surfaces\n", model.sag_m);
    text_print(stdout, "size: %.3f x %.3f x %.3f m (length, width, height)\n", model.length_m, model.width_m,
               model.height_m);
    if (imported && sized) {
        ModelFit fit;
        model_fit(&fit, &model, &report, size, 1.1);
        text_print(stdout, "size asked for: %s%s\n", fit.fits ? "as it is" : "not so: ", fit.advice);
    }
    text_print(stdout, "box: %.3f %.3f %.3f .. %.3f %.3f %.3f m (forward, right, down of the base's centre)\n",
               model.box_low[0], model.box_low[1], model.box_low[2], model.box_high[0], model.box_high[1],
               model.box_high[2]);
    text_print(stdout, "radius: %.3f m, of every pose\n", model.radius_m);
    text_print(stdout, "triangles: %d, vertices: %d\n", model.triangle_count, model.vertex_count);
    text_print(stdout, "edges: %lld open, in %d parts; %lld shared by more than two triangles; %d parts inside out\n",
               edges.open, edges.open_parts, edges.crowded, edges.inside_out_parts);
    print_nodes(&model);
    print_parts(&model);
    model_destroy(&model);
    return 0;
}
