/* entities/catalog/catalog_sizes.c: sizes of the catalog's models, and warnings of models from files with odd ones. */
#include "entities/catalog/catalog_private.h"
#include "entities/shapes/parametric.h"

/* The first of the program's rows, in search order, that covers all of a row's types and has a shape of its own. */
static const CatalogRow *row_behind(const Catalog *catalog, const CatalogRow *row)
{
    for (int r = 0; r < catalog->row_count; r++) {
        const CatalogRow *other = catalog->row + r;
        int               f = 0;
        if (other->own || other == row || !parametric_known(catalog->model[other->model].source)) continue;
        while (f < catalog_type_fields && (other->field[f] == catalog_any || other->field[f] == row->field[f])) f++;
        if (f == catalog_type_fields && other->length > 1)
            return catalog_has_shape(catalog, other->model) ? other : NULL;
    }
    return NULL;
}

void catalog_size(double size_m[3], const Catalog *catalog, int model)
{
    const CatalogModel *m = catalog->model + (model >= 0 && model < catalog->model_count ? model : 0);
    const Model        *first = &catalog->model[m->shape].first;
    double              factor[3] = {1, 1, 1};
    if (!m->import) model_scale_to(factor, first, &m->size);
    size_m[0] = factor[0] * first->length_m;
    size_m[1] = factor[1] * first->width_m;
    size_m[2] = factor[2] * (fmax(first->box_high[2], 0) - first->box_low[2]);
}

void catalog_size_range(SizeRange *out, const Catalog *catalog, int kind, int domain)
{
    *out = (SizeRange){0};
    for (int r = 0; r < catalog_row_count(catalog); r++) {
        CatalogRowInfo row;
        double         m[3];
        char           who[64];
        catalog_row(&row, catalog, r);
        if (row.own || model_is_path(row.source) || !catalog_has_shape(catalog, row.model)) continue;
        if ((kind >= 0 && row.kind != kind) || (domain >= 0 && row.domain >= 0 && row.domain != domain)) continue;
        catalog_size(m, catalog, row.model);
        snprintf(who, sizeof who, "%.40s, line %d", row.note && *row.note ? row.note : row.source, row.line);
        model_size_range_take(out, fmax(m[0], fmax(m[1], m[2])), who);
    }
}

/* Reports a model from a file when the program knows no size for its type, and no thing of its kind has a similar size.
 * */
static void warn_odd_size(const Catalog *catalog, const CatalogRow *row, const CatalogModel *m)
{
    static const double slack = 3;
    const double        largest_m = model_size_largest_m(&catalog->model[m->shape].first);
    SizeRange           range;
    char                advice[200];
    catalog_size_range(&range, catalog, row->field[0], row->field[1]);
    if (!model_size_is_odd(advice, largest_m, &range, slack, m->import)) return;
    log_warn(
        "catalog: %s:%d: %s is %.3g m large, but what etc/catalog.csv has of its kind is %.3g m (%s) to %.3g m (%s) large: %s; "
        "if it is right, say so with length_m, width_m, height_m in the row",
        row->own ? catalog->own_path : catalog->path, row->line, m->source, largest_m, range.low_m, range.low,
        range.high_m, range.high, advice);
}

void catalog_warn_sizes(const Catalog *catalog)
{
    static const double said = 1.1, usual = 1.6;
    for (int r = 0; r < catalog->row_count; r++) {
        const CatalogRow   *row = catalog->row + r;
        const CatalogModel *m = catalog->model + row->model;
        ModelSize           want = row->size;
        char                from[200] = "the row";
        double              size[3];
        ModelFit            fit;
        if (!m->import) continue;
        const bool        stated = want.length_m > 0 || want.width_m > 0 || want.height_m > 0;
        const CatalogRow *behind = stated ? NULL : row_behind(catalog, row);
        if (!stated && !behind) {
            warn_odd_size(catalog, row, m);
            continue;
        }
        if (behind) {
            catalog_size(size, catalog, behind->model);
            want = (ModelSize){size[0], size[1], size[2]};
            snprintf(from, sizeof from, "etc/catalog.csv:%d (%s%s%.60s), for such types,", behind->line,
                     catalog->model[behind->model].source, behind->note && *behind->note ? ": " : "",
                     behind->note ? behind->note : "");
        }
        const Model *model = &catalog->model[m->shape].first;
        model_fit(&fit, model, m->import, &want, behind ? usual : said);
        if (fit.fits) continue;
        const double    want_m = fmax(want.length_m, fmax(want.width_m, want.height_m));
        const SizeRange about = {.low_m = want_m, .high_m = want_m};
        char            advice[200];
        if (fit.factor == 0 && model_size_is_odd(advice, model_size_largest_m(model), &about, 3, m->import))
            snprintf(fit.advice, sizeof fit.advice, "%s", advice);
        char         text[3][24];
        const double figure[3] = {want.length_m, want.width_m, want.height_m};
        for (int k = 0; k < 3; k++) snprintf(text[k], sizeof text[k], figure[k] > 0 ? "%.3g" : "?", figure[k]);
        log_warn("catalog: %s:%d: %s is %.3g x %.3g x %.3g m (length, width, height), but %s says %s x %s x %s: %s%s",
                 row->own ? catalog->own_path : catalog->path, row->line, m->source, model->length_m, model->width_m,
                 fmax(model->box_high[2], 0) - model->box_low[2], from, text[0], text[1], text[2], fit.advice,
                 behind ? "; if it is right, say so with length_m, width_m, height_m in the row" : "");
    }
}
