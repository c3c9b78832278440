/* entities/catalog/model_list.c: `pitviper model list`: built-in shapes, and the model of each entity type of the
 * catalog. */
#include "entities/catalog/model_info.h"
#include "entities/import/model_import.h"
#include "entities/parametric/parametric.h"
#include "entities/import/sidecar.h"

/* As IEEE 1278.1 and SISO-REF-010 have kinds and domains. */
static const char *kind_name(int kind, int domain)
{
    static const char *const domains[] = {"other", "land", "air", "surface", "subsurface", "space"};
    static const char *const kinds[] = {"other",   "platform", "munition", "life form", "environmental",
                                        "cultural", "supply",  "radio",    "expendable", "sensor/emitter"};
    if (kind == 1 && domain >= 1 && domain <= 5) return domains[domain];
    return kind >= 0 && kind <= 9 ? kinds[kind] : "any";
}

/* turret azimuth, gun elevation, 2 rotors, 6 wheels. */
static void parts_of(char *out, size_t out_size, const Model *model)
{
    size_t n = 0;
    int wheels = 0, spinning = 0;
    *out = 0;
    for (int i = 0; i < model->node_count && n < out_size; i++) {
        const ModelNode *node = &model->node[i];
        char text[32];
        const char *metric = sidecar_metric_text(node->dis_metric);
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
        Model model;
        char parts[400], size[40];
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
    Status status = catalog_open(&catalog, catalog_path, 0.1);
    if (status != STATUS_OK) return status;
    status = list_shapes(to);
    text_print(to, "\nCatalog, in the order in which it is searched: entity type, kind, model, size, row, note%s\n\n",
            etc_own("catalog.csv") ? "; your own first" : "");
    for (int r = 0; r < catalog_row_count(catalog) && status == STATUS_OK; r++) {
        CatalogRowInfo row;
        double m[3];
        char size[40] = "not seen", parts[400] = "";
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
