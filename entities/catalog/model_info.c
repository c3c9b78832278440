/* entities/catalog/model_info.c: what `pitviper model info` prints of one model, and `pitviper model list` of all. */
#include "entities/catalog/model_info.h"
#include "entities/import/sidecar.h"
#include "entities/shapes/parametric.h"

const char *model_info_axis(char out[4], const ModelImport *import, int which)
{
    const double *m = import->r_body_from_file;
    snprintf(out, 4, "?");
    for (int i = 0; i < 3; i++) {
        const double along = which == 0 ? m[i] : -m[6 + i];
        if (fabs(along) > 0.5) snprintf(out, 4, "%c%c", along > 0 ? '+' : '-', "xyz"[i]);
    }
    return out;
}

static void print_import(const ModelImport *r)
{
    static const char *const source[MATERIAL_SOURCE_COUNT] = {"the sidecar", "the name in the file",
                                                              "the nearest colour", "nothing: paint_olive"};
    static const char        otherwise[] = "in a sidecar says otherwise";
    char                     axis[2][4];
    text_print(stdout, "file: %s, %lld octets\nsidecar: %s\n", r->file, r->octets, r->sidecar[0] ? r->sidecar : "none");
    text_print(stdout, "axes of the file: %s forward, %s up (%s%s%s)\n", model_info_axis(axis[0], r, 0),
               model_info_axis(axis[1], r, 1), r->axes_from, r->axes_assumed ? "; `axes` " : "",
               r->axes_assumed ? otherwise : "");
    text_print(stdout, "scale: %.9g m a unit (%s%s%s)\n", r->scale_m, r->unit_from,
               r->scale_assumed ? "; `scale` " : "", r->scale_assumed ? otherwise : "");
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
    if (node->low > node->high) text_print(stdout, " free");
    else if (turns) text_print(stdout, " %g .. %g deg", node->low / rad_per_deg, node->high / rad_per_deg);
    else text_print(stdout, " %g .. %g m", node->low, node->high);
}

static void print_nodes(const Model *m)
{
    text_print(stdout, "\nnodes: %d\n", m->node_count);
    for (int i = 0; i < m->node_count; i++) {
        const ModelNode *node = &m->node[i];
        char             text[32];
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
            if (part->damage_hidden >> state & 1) text_print(stdout, ", damage %d: hidden", state);
            else if (part->damage_material[state][0])
                text_print(stdout, ", damage %d: %s", state, part->damage_material[state]);
        }
        putchar('\n');
    }
}

/* Judges a model's size. It is odd when it is half as large again as anything in the catalog, or much smaller than
 * anything; and, where the name says what the model is, when it is off by a factor of 3. */
static void judge_size(ModelInfo *info, const char *name)
{
    static const double slack = 1.5, named_slack = 3;
    const ModelImport  *import = &info->import;
    /* a file that says centimetres may be drawn in metres all the same: 8 cm are then 8 m */
    const double least_m = import->scale_assumed && import->scale_m != 1 ? 0.3 : 0.05;
    const double largest_m = model_size_largest_m(&info->model);
    const char  *slash = strrchr(name, '/');
    char         path[4096], advice[200];
    Catalog     *catalog;
    SizeRange    range = {.high_m = 100}, named;
    log_suppress(true); /* a broken catalog is no fault of this model; a size below the least needs no catalog */
    if (largest_m > range.high_m && etc_path(path, sizeof path, "catalog.csv") &&
        catalog_open(&catalog, path, 0.1) == STATUS_OK) {
        catalog_size_range(&range, catalog, -1, -1);
        catalog_close(catalog);
    }
    log_suppress(false);
    range.low_m = slack * least_m; /* model_size_is_odd divides this by slack again */
    if (model_size_range_named(&named, slash ? slash + 1 : name) &&
        model_size_is_odd(advice, largest_m, &named, named_slack, &info->import))
        snprintf(info->advice, sizeof info->advice, "it is %.3g m large, and `%s`, as it is called, %.3g m: %s",
                 largest_m, named.high, named.high_m, advice);
    else if (model_size_is_odd(advice, largest_m, &range, slack, &info->import))
        snprintf(info->advice, sizeof info->advice, "it is %.3g m large, and %s %.3g m%s%s: %s", largest_m,
                 largest_m > range.high_m ? "nothing of etc/catalog.csv is larger than" : "few things are smaller than",
                 largest_m > range.high_m ? range.high_m : least_m, largest_m > range.high_m ? ", " : "",
                 largest_m > range.high_m ? range.high : "", advice);
    info->odd = info->advice[0] != 0;
    if (info->odd) log_warn("model: %s: %s", info->import.file, info->advice);
}

Status model_info_open(ModelInfo *out, const char *name, const ModelSize *size, double sag_m)
{
    ModelInfo info = {.sized = size->length_m > 0 || size->width_m > 0 || size->height_m > 0};
    Status    status = info.sized && parametric_known(name)
                           ? parametric_build_size(&info.model, name, size, sag_m)
                           : model_open(&info.model, &info.import, &info.imported, name, sag_m);
    if (status == STATUS_NO_MEMORY) log_error("model: %s: %s", name, status_name(status));
    if (status != STATUS_OK) return status; /* all other errors were reported where they occurred */
    info.sized = info.sized && info.imported;
    if (model_edges(&info.edges, &info.model) != STATUS_OK) {
        model_destroy(&info.model);
        log_error("model: no memory: %s", name);
        return STATUS_NO_MEMORY;
    }
    if (info.sized) model_fit(&info.fit, &info.model, &info.import, size, 1.1);
    else if (info.imported) judge_size(&info, name);
    *out = info;
    return STATUS_OK;
}

void model_info_close(ModelInfo *info) { model_destroy(&info->model); }

void model_info_print(const ModelInfo *info)
{
    const Model      *m = &info->model;
    const ModelEdges *edges = &info->edges;
    text_print(stdout, "model: %s\n", m->name);
    if (info->imported) print_import(&info->import);
    else text_print(stdout, "built in, facets within %g m of their surfaces\n", m->sag_m);
    text_print(stdout, "size: %.3f x %.3f x %.3f m (length, width, height)\n", m->length_m, m->width_m, m->height_m);
    if (info->sized)
        text_print(stdout, "size asked for: %s%s\n", info->fit.fits ? "as it is" : "not so: ", info->fit.advice);
    if (info->imported && m->width_m > 2 * m->length_m && m->length_m > 0) {
        char          axis[2][4];
        const double *right = info->import.r_body_from_file + 3;
        int           side = 0;
        for (int i = 1; i < 3; i++)
            if (fabs(right[i]) > fabs(right[side])) side = i;
        snprintf(axis[0], sizeof axis[0], "+%c", "xyz"[side]);
        text_print(
            stdout,
            "wider than long: if it faces along its length, `axes: '%s %s'` in a sidecar turns it (- in place of + "
            "the other way)\n",
            axis[0], model_info_axis(axis[1], &info->import, 1));
    }
    text_print(stdout, "box: %.3f %.3f %.3f .. %.3f %.3f %.3f m (forward, right, down of the base's centre)\n",
               m->box_low[0], m->box_low[1], m->box_low[2], m->box_high[0], m->box_high[1], m->box_high[2]);
    text_print(stdout, "radius: %.3f m, of every pose\n", m->radius_m);
    text_print(stdout, "triangles: %d, vertices: %d\n", m->triangle_count, m->vertex_count);
    text_print(stdout, "edges: %lld open, in %d parts; %lld shared by more than two triangles; %d parts inside out\n",
               edges->open, edges->open_parts, edges->crowded, edges->inside_out_parts);
    print_nodes(m);
    print_parts(m);
}

/* ---- the list: built-in shapes, and the model of each entity type of the catalog -------------- */

/* Names of kinds and domains in IEEE 1278.1 and SISO-REF-010. */
static const char *kind_name(int kind, int domain)
{
    static const char *const domains[] = {"other", "land", "air", "surface", "subsurface", "space"};
    static const char *const kinds[] = {"other",    "platform", "munition", "life form",  "environmental",
                                        "cultural", "supply",   "radio",    "expendable", "sensor/emitter"};
    if (kind == 1 && domain >= 1 && domain <= 5) return domains[domain];
    return kind >= 0 && kind <= 9 ? kinds[kind] : "any";
}

/* turret azimuth, gun elevation, 2 rotors, 6 wheels. */
static void parts_of(char *out, size_t out_size, const Model *model)
{
    size_t n = 0;
    int    wheels = 0, spinning = 0;
    *out = 0;
    for (int i = 0; i < model->node_count && n < out_size; i++) {
        const ModelNode *node = &model->node[i];
        char             text[32];
        const char      *metric = sidecar_metric_text(node->dis_metric);
        if (node->joint == JOINT_FIXED) continue;
        if (node->dis_class)
            n += (size_t)snprintf(out + n, out_size - n, "%s%s %s", n ? ", " : "",
                                  sidecar_class_text(text, node->dis_class) ? text : node->name, metric ? metric : "?");
        wheels += node->roll_radius_m > 0;
        spinning += node->spin_rps_moving != 0;
    }
    if (spinning && n < out_size)
        n += (size_t)snprintf(out + n, out_size - n, "%s%d that spin", n ? ", " : "", spinning);
    if (wheels && n < out_size) snprintf(out + n, out_size - n, "%s%d wheels", n ? ", " : "", wheels);
    if (!*out) snprintf(out, out_size, "none");
}

static Status list_shapes(FILE *to)
{
    static const double coarse_chord_error_m = 0.1; /* nodes and sizes do not depend on it */
    text_print(to, "Built-in shapes: name, size in metres (length x width x height), articulated parts\n\n");
    for (int i = 0; i < parametric_count(); i++) {
        Model        model;
        char         parts[400], size[40];
        const Status status = parametric_build(&model, parametric_name(i), coarse_chord_error_m);
        if (status != STATUS_OK) return status;
        parts_of(parts, sizeof parts, &model);
        snprintf(size, sizeof size, "%.2f x %.2f x %.2f", model.length_m, model.width_m,
                 fmax(model.box_high[2], 0) - model.box_low[2]);
        text_print(to, "  %-16s %-24s %s\n", parametric_name(i), size, parts);
        model_destroy(&model);
    }
    return STATUS_OK;
}

Status model_list(FILE *to, const char *catalog_path)
{
    Catalog *catalog;
    Status   status = catalog_open(&catalog, catalog_path, 0.1);
    if (status != STATUS_OK) return status;
    status = list_shapes(to);
    text_print(to, "\nCatalog, in the order in which it is searched: entity type, kind, model, size, row, note%s\n\n",
               etc_own("catalog.csv") ? "; your own first" : "");
    for (int r = 0; r < catalog_row_count(catalog) && status == STATUS_OK; r++) {
        CatalogRowInfo row;
        double         m[3];
        char           size[40] = "not seen", parts[400] = "";
        catalog_row(&row, catalog, r);
        catalog_size(m, catalog, row.model);
        if (catalog_has_shape(catalog, row.model)) snprintf(size, sizeof size, "%.2f x %.2f x %.2f", m[0], m[1], m[2]);
        const char *slash = strrchr(row.path, '/');
        text_print(to, "  %-22s %-12s %-18s %-24s %s:%d  %s", row.type, kind_name(row.kind, row.domain), row.source,
                   size, slash ? slash + 1 : row.path, row.line, row.note);
        if (model_is_path(row.source)) { /* of the others it stands above */
            parts_of(parts, sizeof parts, catalog_model(catalog, row.model));
            text_print(to, "; articulated: %s", parts);
        }
        fputc('\n', to);
    }
    catalog_close(catalog);
    return status;
}
