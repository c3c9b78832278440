/* entities/catalog.c: entity type -> model, by the longest pattern of etc/catalog.csv. */
#include "entities/catalog.h"
#include "entities/model_import.h"
#include "entities/parametric.h"

#include <stdlib.h>

enum { type_fields = 7, any = -1 };

typedef struct CatalogRow {
    int    field[type_fields]; /* any: a star */
    int    length;             /* fields up to the last one named */
    int    named;              /* fields that are not a star */
    int    order;              /* in the file */
    int    model;
    Origin origin;
} CatalogRow;

struct Catalog {
    int         row_count, model_count;
    CatalogRow *row;
    Model      *model; /* model[0]: unknown */
    char      **source; /* of each model: its built-in name, or its file */
};

/* Dotted numbers and stars; what is left out at the end is a star. Fields are 8 bits, the country 16. */
static bool parse_type(int field[type_fields], const char *text)
{
    for (int f = 0; f < type_fields; f++) field[f] = any;
    for (int f = 0; f < type_fields; f++) {
        char part[8];
        const size_t length = strcspn(text, ".");
        long long value;

        if (length == 0 || length >= sizeof part) return false;
        memcpy(part, text, length);
        part[length] = 0;
        if (strcmp(part, "*") != 0) {
            if (part[0] < '0' || part[0] > '9') return false; /* no sign, no blank */
            if (!text_to_long(&value, part) || value > (f == 2 ? 65535 : 255)) return false;
            field[f] = (int)value;
        }
        text += length;
        if (!*text) return true;
        text++;
    }
    return false; /* an eighth field */
}

/* Index of the model of that name or file; if it is new a file is read now, a built-in model is left to build_models.
 * Files are beside the catalog at `path`. */
static Status find_or_build(int *out, Catalog *catalog, const char *name, const char *path, double sag_m)
{
    char        source[1024];
    bool        imported;
    const char *slash = strrchr(path, '/');
    const int   folder = model_is_path(name) && name[0] != '/' && slash ? (int)(slash - path) + 1 : 0;
    if ((size_t)snprintf(source, sizeof source, "%.*s%s", folder, path, name) >= sizeof source) return STATUS_BAD_VALUE;
    for (int m = 0; m < catalog->model_count; m++) {
        if (strcmp(catalog->source[m], source) == 0) {
            *out = m;
            return STATUS_OK;
        }
    }
    char *kept = strdup(source);
    if (!kept) return STATUS_NO_MEMORY;
    const Status status =
        parametric_known(source) ? STATUS_OK
                                 : model_open(catalog->model + catalog->model_count, NULL, &imported, source, sag_m);
    if (status != STATUS_OK) {
        free(kept);
        return status;
    }
    catalog->source[catalog->model_count] = kept;
    *out = catalog->model_count++;
    return STATUS_OK;
}

/* The built-in models, when all rows have named theirs. */
static Status build_models(Catalog *catalog, double sag_m)
{
    Status status = STATUS_OK;
    for (int m = 0; m < catalog->model_count && status == STATUS_OK; m++) {
        if (!parametric_known(catalog->source[m])) continue;
        status = parametric_build(catalog->model + m, catalog->source[m], sag_m);
        if (status != STATUS_OK)
            log_error("catalog: cannot build a model: model=\"%s\" reason=%s", catalog->source[m], status_name(status));
    }
    return status;
}

static Status read_row(CatalogRow *row, Catalog *catalog, const Table *table, int r, const int column[3], double sag_m)
{
    const char *type = table_text(table, r, column[0]), *model = table_text(table, r, column[1]);
    const char *origin = table_text(table, r, column[2]);
    const int line = table->line[r + 1];

    if (!parse_type(row->field, type)) {
        log_error("catalog: not an entity type: file=%s line=%d type=\"%s\" want=kind.domain.country... of 0 .. 255 "
                  "(country 0 .. 65535) or *", table->path, line, type);
        return STATUS_BAD_VALUE;
    }
    row->length = row->named = 0;
    for (int f = 0; f < type_fields; f++) {
        if (row->field[f] == any) continue;
        row->named++;
        row->length = f + 1;
    }
    if (strcmp(origin, "base") == 0) row->origin = ORIGIN_BASE;
    else if (strcmp(origin, "centre") == 0) row->origin = ORIGIN_CENTRE;
    else {
        log_error("catalog: not an origin: file=%s line=%d origin=\"%s\" want=base or centre", table->path, line,
                  origin);
        return STATUS_BAD_VALUE;
    }
    const Status status = find_or_build(&row->model, catalog, model, table->path, sag_m);
    if (status != STATUS_OK)
        log_error("catalog: cannot use this model: file=%s line=%d model=\"%s\" reason=%s", table->path, line, model,
                  status_name(status));
    return status == STATUS_UNSUPPORTED ? STATUS_BAD_VALUE : status;
}

/* Longer first, then more fields named, then the order of the file: it is the search order. */
static int row_order(const void *x, const void *y)
{
    const CatalogRow *a = x, *b = y;
    if (a->length != b->length) return a->length > b->length ? -1 : 1;
    if (a->named != b->named) return a->named > b->named ? -1 : 1;
    return (a->order > b->order) - (a->order < b->order);
}

Status catalog_open(Catalog **out, const char *path, double sag_m)
{
    static const char *const names[3] = {"type", "model", "origin"};
    Table    table = {0};
    int      column[3], unknown;
    Catalog *catalog = NULL;
    Status   status = table_open(&table, path);

    if (status != STATUS_OK) return status;
    for (int c = 0; c < 3; c++) {
        column[c] = table_column(&table, names[c]);
        if (column[c] < 0) {
            log_error("catalog: a column is missing: file=%s column=%s", path, names[c]);
            status = STATUS_BAD_VALUE;
            goto done;
        }
    }
    status = STATUS_NO_MEMORY;
    catalog = calloc(1, sizeof *catalog);
    if (!catalog) goto done;
    catalog->row = calloc((size_t)table.rows + 1, sizeof *catalog->row);
    catalog->model = calloc((size_t)table.rows + 1, sizeof *catalog->model);
    catalog->source = calloc((size_t)table.rows + 1, sizeof *catalog->source);
    if (!catalog->row || !catalog->model || !catalog->source) goto done;

    status = find_or_build(&unknown, catalog, "unknown", "", sag_m);
    if (status != STATUS_OK) log_error("catalog: cannot build the unknown model: %s", status_name(status));
    for (int r = 0; r < table.rows && status == STATUS_OK; r++) {
        CatalogRow *row = catalog->row + catalog->row_count;
        status = read_row(row, catalog, &table, r, column, sag_m);
        row->order = catalog->row_count++;
    }
    if (status == STATUS_OK) status = build_models(catalog, sag_m);
    qsort(catalog->row, (size_t)catalog->row_count, sizeof *catalog->row, row_order);

done:
    table_close(&table);
    if (status == STATUS_OK) *out = catalog;
    else catalog_close(catalog);
    return status;
}

void catalog_close(Catalog *catalog)
{
    if (!catalog) return;
    for (int m = 0; m < catalog->model_count; m++) {
        model_destroy(catalog->model + m);
        free(catalog->source[m]);
    }
    free(catalog->source);
    free(catalog->model);
    free(catalog->row);
    free(catalog);
}

int catalog_model_count(const Catalog *catalog) { return catalog->model_count; }

const Model *catalog_model(const Catalog *catalog, int model)
{
    return model >= 0 && model < catalog->model_count ? catalog->model + model : catalog->model;
}

int catalog_find(const Catalog *catalog, DisEntityType type, Origin *origin, int *matched)
{
    const int field[type_fields] = {type.kind, type.domain, type.country, type.category,
                                    type.subcategory, type.specific, type.extra};

    for (int r = 0; r < catalog->row_count; r++) {
        const CatalogRow *row = catalog->row + r;
        int f = 0;
        while (f < row->length && (row->field[f] == any || row->field[f] == field[f])) f++;
        if (f < row->length) continue;
        if (origin) *origin = row->origin;
        if (matched) *matched = row->length;
        return row->model;
    }
    if (origin) *origin = ORIGIN_BASE;
    if (matched) *matched = 0;
    return 0;
}
