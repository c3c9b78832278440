/* entities/catalog.c: entity type -> model, by the longest pattern of etc/catalog.csv. */
#include "entities/catalog.h"
#include "entities/model_import.h"
#include "entities/parametric.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { type_fields = 7, any = -1, catalog_columns = 6 };

typedef struct CatalogRow {
    int    field[type_fields]; /* any: a star */
    int    length;             /* fields up to the last one named */
    int    named;              /* fields that are not a star */
    int    order;              /* in the file */
    int    model;
    Origin origin;
} CatalogRow;

/* A model of the catalog. A built-in shape is built coarsely when the catalog is opened, once for all sizes of it:
 * nodes and parts, with their materials and heat, depend on neither size nor facets. With fine facets and in its size
 * it is built when a type that has it is first asked for: of two hundred models an exercise has ten. */
typedef struct CatalogModel {
    char *source;          /* its built-in name, or its file */
    ModelSize size;        /* zeroes: its own */
    int shape;             /* index of the one whose `first` this is a size of */
    int class;             /* index of the first of the same name */
    Model first;           /* of shape == own index alone: coarse, or of a file */
    _Atomic(Model *) fine; /* NULL: not asked for yet, or of a file */
    atomic_bool failed;    /* no memory when it was asked for */
} CatalogModel;

struct Catalog {
    int row_count, model_count;
    CatalogRow *row;
    CatalogModel *model; /* model[0]: unknown */
    double sag_m;
    pthread_mutex_t *building;
};

static const double coarse_sag_m = 0.1;

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

/* Index of the model of that name or file and size. If it is new a file is read now, and so is a shape that no size of
 * it has called for yet. Files are beside the catalog at `path`. */
static Status find_or_add(int *out, Catalog *catalog, const char *name, const ModelSize *size, const char *path)
{
    char        source[1024];
    bool        imported;
    const char *slash = strrchr(path, '/');
    const int   folder = model_is_path(name) && name[0] != '/' && slash ? (int)(slash - path) + 1 : 0;
    if ((size_t)snprintf(source, sizeof source, "%.*s%s", folder, path, name) >= sizeof source) return STATUS_BAD_VALUE;
    CatalogModel *added = catalog->model + catalog->model_count;
    added->shape = catalog->model_count;
    for (int m = catalog->model_count - 1; m >= 0; m--) {
        const CatalogModel *model = catalog->model + m;
        if (strcmp(model->source, source) != 0) continue;
        added->shape = model->shape;
        if (memcmp(&model->size, size, sizeof *size) != 0) continue;
        *out = m;
        return STATUS_OK;
    }
    Status status = STATUS_OK;
    double factor[3];
    if (added->shape == catalog->model_count)
        status = parametric_known(source) ? parametric_build(&added->first, source, coarse_sag_m)
                                          : model_open(&added->first, NULL, &imported, source, catalog->sag_m);
    if (status == STATUS_OK && !model_scale_to(factor, &catalog->model[added->shape].first, size)) {
        const Model *own = &catalog->model[added->shape].first;
        log_error("catalog: too far from the shape's own size: model=%s its=%.4g x %.4g x %.4g m range=0.02..50 times",
                  source, own->length_m, own->width_m, own->height_m);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK && !(added->source = strdup(source))) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        if (added->shape == catalog->model_count) model_destroy(&added->first);
        return status;
    }
    added->size = *size;
    added->class = 0;
    while (added->class < catalog->model_count && strcmp(catalog->model[catalog->model[added->class].shape].first.name,
                                                         catalog->model[added->shape].first.name) != 0)
        added->class++;
    *out = catalog->model_count++;
    return STATUS_OK;
}

/* With its own facets and size, once. */
static void build_fine(const Catalog *catalog, int index)
{
    CatalogModel *m = catalog->model + index;
    if (atomic_load(&m->fine) || atomic_load(&m->failed) || !parametric_known(m->source)) return;
    pthread_mutex_lock(catalog->building);
    if (!atomic_load(&m->fine) && !atomic_load(&m->failed)) {
        Model *fine = calloc(1, sizeof *fine);
        const Status status =
            fine ? parametric_build_size(fine, m->source, &m->size, catalog->sag_m) : STATUS_NO_MEMORY;
        if (status == STATUS_OK) {
            atomic_store(&m->fine, fine);
        } else {
            free(fine);
            atomic_store(&m->failed, true);
            log_error("catalog: cannot build a model, its coarse form is shown: model=\"%s\" reason=%s", m->source,
                      status_name(status));
        }
    }
    pthread_mutex_unlock(catalog->building);
}

static Status read_size(ModelSize *size, const Table *table, int r, const int column[catalog_columns],
                        const char *model)
{
    double *const figure[3] = {&size->length_m, &size->width_m, &size->height_m};
    for (int k = 0; k < 3; k++) {
        *figure[k] = 0;
        if (column[3 + k] < 0 || !*table_text(table, r, column[3 + k])) continue;
        const Status status = table_number(figure[k], table, r, column[3 + k], 0.001, 2000);
        if (status != STATUS_OK) return status;
        if (!model_is_path(model)) continue;
        log_error("catalog: a file has its own size, which its sidecar scales: file=%s line=%d model=\"%s\"",
                  table->path, table->line[r + 1], model);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static Status read_row(CatalogRow *row, Catalog *catalog, const Table *table, int r, const int column[catalog_columns])
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
    ModelSize size;
    Status status = read_size(&size, table, r, column, model);
    if (status != STATUS_OK) return status;
    status = find_or_add(&row->model, catalog, model, &size, table->path);
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
    static const char *const names[catalog_columns] = {"type", "model", "origin", "length_m", "width_m", "height_m"};
    static const ModelSize own = {0};
    Table    table = {0};
    int column[catalog_columns], unknown;
    Catalog *catalog = NULL;

    if (!(sag_m >= 1e-5 && sag_m <= 0.1)) {
        log_error("catalog: sag out of range: sag_m=%g range=1e-5..0.1", sag_m);
        return STATUS_BAD_VALUE;
    }
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    for (int c = 0; c < catalog_columns; c++) {
        column[c] = table_column(&table, names[c]);
        if (column[c] < 0 && c < 3) {
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
    catalog->building = calloc(1, sizeof *catalog->building);
    if (!catalog->row || !catalog->model || !catalog->building) goto done;
    pthread_mutex_init(catalog->building, NULL);
    catalog->sag_m = sag_m;

    status = find_or_add(&unknown, catalog, "unknown", &own, "");
    if (status != STATUS_OK) log_error("catalog: cannot build the unknown model: %s", status_name(status));
    for (int r = 0; r < table.rows && status == STATUS_OK; r++) {
        CatalogRow *row = catalog->row + catalog->row_count;
        status = read_row(row, catalog, &table, r, column);
        row->order = catalog->row_count++;
    }
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
        CatalogModel *model = catalog->model + m;
        Model *fine = atomic_load(&model->fine);
        if (fine) model_destroy(fine);
        free(fine);
        if (model->shape == m) model_destroy(&model->first);
        free(model->source);
    }
    if (catalog->building) pthread_mutex_destroy(catalog->building);
    free(catalog->building);
    free(catalog->model);
    free(catalog->row);
    free(catalog);
}

int catalog_model_count(const Catalog *catalog) { return catalog->model_count; }

const Model *catalog_model(const Catalog *catalog, int model)
{
    const CatalogModel *m = catalog->model + (model >= 0 && model < catalog->model_count ? model : 0);
    const Model *fine = atomic_load(&m->fine);
    return fine ? fine : &catalog->model[m->shape].first;
}

bool catalog_is_built(const Catalog *catalog, int model)
{
    const CatalogModel *m = catalog->model + (model >= 0 && model < catalog->model_count ? model : 0);
    return atomic_load(&m->fine) || atomic_load(&m->failed) || !parametric_known(m->source);
}

bool catalog_shows(const Catalog *catalog, int model)
{
    return model < 0 || model >= catalog->model_count || strcmp(catalog->model[model].source, "none") != 0;
}

int catalog_class(const Catalog *catalog, int model)
{
    return catalog->model[model >= 0 && model < catalog->model_count ? model : 0].class;
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
        build_fine(catalog, row->model);
        return row->model;
    }
    if (origin) *origin = ORIGIN_BASE;
    if (matched) *matched = 0;
    build_fine(catalog, 0);
    return 0;
}
