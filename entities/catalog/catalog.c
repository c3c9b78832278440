/* entities/catalog/catalog.c: entity type -> model, by the longest pattern of etc/catalog.csv. */

#include "entities/catalog/catalog_private.h"
#include "pitviper_table.h"
#include "entities/shapes/parametric.h"
#include "pitviper_output.h"

#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

static const double coarse_chord_error_m = 0.1;

/* Reads a type: numbers and stars with dots between; parts omitted at the end are stars. Fields have 8 bits, the
 * country 16. */
static bool read_type(int field[catalog_type_fields], const char *text)
{
    for (int f = 0; f < catalog_type_fields; f++) field[f] = catalog_any;
    for (int f = 0; f < catalog_type_fields; f++) {
        char         part[8];
        const size_t length = strcspn(text, ".");
        long long    value;

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
    return false; /* there is an eighth field */
}

static Status open_file(CatalogModel *model, bool *imported, const char *source, double sag_m)
{
    model->import = calloc(1, sizeof *model->import);
    const Status status =
        model->import ? model_open(&model->first, model->import, imported, source, sag_m) : STATUS_NO_MEMORY;
    if (status == STATUS_OK && *imported) model_import_say(model->import, &model->first);
    return status;
}

/* Finds or adds the model of that name or file, and size. When it is new, a file is read now, and so is a shape of
 * which no other size was added before. Files are relative to the folder of `path`. */
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
        status = parametric_known(source) ? parametric_build(&added->first, source, coarse_chord_error_m)
                                          : open_file(added, &imported, source, catalog->sag_m);
    if (status == STATUS_OK && !model_scale_to(factor, &catalog->model[added->shape].first, size)) {
        const Model *own = &catalog->model[added->shape].first;
        log_error("catalog: too far from the shape's own size: model=%s its=%.4g x %.4g x %.4g m range=0.02..50 times",
                  source, own->length_m, own->width_m, own->height_m);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK && !(added->source = strdup(source))) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        if (added->shape == catalog->model_count) model_destroy(&added->first);
        free(added->import);
        added->import = NULL;
        return status;
    }
    added->size = *size;
    added->same_name = 0;
    while (added->same_name < catalog->model_count &&
           strcmp(catalog->model[catalog->model[added->same_name].shape].first.name,
                  catalog->model[added->shape].first.name) != 0)
        added->same_name++;
    *out = catalog->model_count++;
    return STATUS_OK;
}

/* Builds the model with its own facets and size, once. */
static void build_fine(const Catalog *catalog, int index)
{
    CatalogModel *m = catalog->model + index;
    if (atomic_load(&m->fine) || atomic_load(&m->failed) || !parametric_known(m->source)) return;
    pthread_mutex_lock(catalog->building);
    if (!atomic_load(&m->fine) && !atomic_load(&m->failed)) {
        Model       *fine = calloc(1, sizeof *fine);
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

/* A row as it is in the file. */
typedef struct Row {
    int         field[catalog_type_fields], origin;
    const char *model, *note;
    ModelSize   size;
} Row;

static const char *parse_type(void *out, const char *text)
{
    return read_type(out, text) ? NULL : "an entity type: kind.domain.country... of 0 .. 255 (country 0 .. 65535) or *";
}

#define LENGTH(member) TABLE_DOUBLE, TABLE_AT(Row, size.member), .low = 0.001, .high = 2000, .absent = TABLE_OPTIONAL

static const TableColumn columns[] = {
    {"type", TABLE_OWN, TABLE_AT(Row, field), .parse = parse_type},
    {"model", .type = TABLE_CELL, TABLE_AT(Row, model)},
    {"origin", TABLE_CHOICE, TABLE_AT(Row, origin), .choices = "base, centre"},
    {"length_m", LENGTH(length_m)},
    {"width_m", LENGTH(width_m)},
    {"height_m", LENGTH(height_m)},
    {"note", TABLE_CELL, TABLE_AT(Row, note), .absent = TABLE_LATER},
};
static const TableFormat format = {"catalog", columns, sizeof columns / sizeof *columns,
                                   .next = "etc/catalog.csv explains the columns"};

static Status take_row(CatalogRow *row, Catalog *catalog, const TableRows *rows, int number)
{
    static const ModelSize own_size = {0};
    Row                    read = {0};
    Status                 status = table_rows_get(&read, rows, number);
    if (status != STATUS_OK) return status;
    memcpy(row->field, read.field, sizeof row->field);
    row->line = rows->table.line[number + 1];
    row->size = read.size;
    row->origin = read.origin == 0 ? ORIGIN_BASE : ORIGIN_CENTRE;
    row->length = row->named = 0;
    for (int f = 0; f < catalog_type_fields; f++) {
        if (row->field[f] == catalog_any) continue;
        row->named++;
        row->length = f + 1;
    }
    if (!(row->note = strdup(read.note))) return STATUS_NO_MEMORY;
    status = find_or_add(&row->model, catalog, read.model, model_is_path(read.model) ? &own_size : &row->size,
                         rows->table.path);
    if (status != STATUS_OK)
        log_error("catalog: cannot use this model: file=%s line=%d model=\"%s\" reason=%s; `pitviper model list` lists "
                  "what is built in, `pitviper model info FILE` says what is in a file",
                  rows->table.path, row->line, read.model, status_name(status));
    return status == STATUS_UNSUPPORTED ? STATUS_BAD_VALUE : status;
}

/* The search order of rows: the user's own first, then those named deeper, then those with more fields named, then by
 * their order in the file. */
static int row_order(const void *x, const void *y)
{
    const CatalogRow *a = x, *b = y;
    if (a->own != b->own) return a->own ? -1 : 1;
    if (a->length != b->length) return a->length > b->length ? -1 : 1;
    if (a->named != b->named) return a->named > b->named ? -1 : 1;
    return (a->order > b->order) - (a->order < b->order);
}

/* ---- the whole ----------------------------------------------------------------------------------- */

static Status take_rows(Catalog *catalog, const TableRows *rows, bool own)
{
    Status status = STATUS_OK;
    for (int r = 0; r < rows->table.rows && status == STATUS_OK; r++) {
        CatalogRow *row = catalog->row + catalog->row_count;
        row->own = own;
        status = take_row(row, catalog, rows, r);
        row->order = catalog->row_count++;
    }
    return status;
}

Status catalog_open(Catalog **out, const char *path, double sag_m)
{
    static const ModelSize own_size = {0};
    const char            *own_path = etc_own("catalog.csv");
    TableRows              rows = {0}, own = {0};
    int                    unknown;
    Catalog               *catalog = NULL;

    if (!(sag_m >= 1e-5 && sag_m <= 0.1)) {
        log_error("catalog: sag out of range: sag_m=%g range=1e-5..0.1", sag_m);
        return STATUS_BAD_VALUE;
    }
    Status status = table_rows_open(&rows, &format, path);
    if (status == STATUS_OK && own_path) status = table_rows_open(&own, &format, own_path);
    if (status != STATUS_OK) goto done;
    status = STATUS_NO_MEMORY;
    catalog = calloc(1, sizeof *catalog);
    if (!catalog) goto done;
    const size_t most = (size_t)rows.table.rows + (size_t)own.table.rows + 1;
    catalog->row = calloc(most, sizeof *catalog->row);
    catalog->model = calloc(most, sizeof *catalog->model);
    catalog->building = calloc(1, sizeof *catalog->building);
    catalog->path = strdup(path);
    catalog->own_path = strdup(own_path ? own_path : "");
    if (!catalog->row || !catalog->model || !catalog->building || !catalog->path || !catalog->own_path) goto done;
    pthread_mutex_init(catalog->building, NULL);
    catalog->sag_m = sag_m;

    status = find_or_add(&unknown, catalog, "unknown", &own_size, "");
    if (status != STATUS_OK) log_error("catalog: cannot build the unknown model: %s", status_name(status));
    /* the program's models keep their numbers, whatever the user adds: row_order decides the precedence */
    if (status == STATUS_OK) status = take_rows(catalog, &rows, false);
    if (status == STATUS_OK && own_path) status = take_rows(catalog, &own, true);
    qsort(catalog->row, (size_t)catalog->row_count, sizeof *catalog->row, row_order);
    if (status == STATUS_OK) catalog_warn_sizes(catalog);

done:
    table_rows_close(&rows);
    table_rows_close(&own);
    if (status == STATUS_OK) *out = catalog;
    else catalog_close(catalog);
    return status;
}

void catalog_close(Catalog *catalog)
{
    if (!catalog) return;
    for (int m = 0; m < catalog->model_count; m++) {
        CatalogModel *model = catalog->model + m;
        Model        *fine = atomic_load(&model->fine);
        if (fine) model_destroy(fine);
        free(fine);
        if (model->shape == m) model_destroy(&model->first);
        free(model->source);
        free(model->import);
    }
    for (int r = 0; r < catalog->row_count; r++) free(catalog->row[r].note);
    if (catalog->building) pthread_mutex_destroy(catalog->building);
    free(catalog->building);
    free(catalog->path);
    free(catalog->own_path);
    free(catalog->model);
    free(catalog->row);
    free(catalog);
}

int catalog_row_count(const Catalog *catalog) { return catalog->row_count; }

void catalog_row(CatalogRowInfo *out, const Catalog *catalog, int index)
{
    const CatalogRow *row = catalog->row + index;
    size_t            n = 0;
    *out = (CatalogRowInfo){.model = row->model,
                            .own = row->own,
                            .line = row->line,
                            .path = row->own ? catalog->own_path : catalog->path,
                            .note = row->note ? row->note : "",
                            .source = catalog->model[row->model].source};
    for (int f = 0; f < catalog_type_fields; f++) {
        if (row->field[f] == catalog_any)
            n += (size_t)snprintf(out->type + n, sizeof out->type - n, "%s*", f ? "." : "");
        else n += (size_t)snprintf(out->type + n, sizeof out->type - n, "%s%d", f ? "." : "", row->field[f]);
    }
    out->kind = row->field[0], out->domain = row->field[1];
}

int catalog_model_count(const Catalog *catalog) { return catalog->model_count; }

const Model *catalog_model(const Catalog *catalog, int model)
{
    const CatalogModel *m = catalog->model + (model >= 0 && model < catalog->model_count ? model : 0);
    const Model        *fine = atomic_load(&m->fine);
    return fine ? fine : &catalog->model[m->shape].first;
}

bool catalog_is_built(const Catalog *catalog, int model)
{
    const CatalogModel *m = catalog->model + (model >= 0 && model < catalog->model_count ? model : 0);
    return atomic_load(&m->fine) || atomic_load(&m->failed) || !parametric_known(m->source);
}

bool catalog_has_shape(const Catalog *catalog, int model)
{
    return model < 0 || model >= catalog->model_count ||
           (strcmp(catalog->model[model].source, "none") != 0 && !catalog_is_chaff(catalog, model));
}

bool catalog_is_chaff(const Catalog *catalog, int model)
{
    return model >= 0 && model < catalog->model_count && strcmp(catalog->model[model].source, "chaff") == 0;
}

int catalog_class(const Catalog *catalog, int model)
{
    return catalog->model[model >= 0 && model < catalog->model_count ? model : 0].same_name;
}

int catalog_find(const Catalog *catalog, DisEntityType type, Origin *origin, int *matched)
{
    const int field[catalog_type_fields] = {type.kind,        type.domain,   type.country, type.category,
                                            type.subcategory, type.specific, type.extra};

    for (int r = 0; r < catalog->row_count; r++) {
        const CatalogRow *row = catalog->row + r;
        int               f = 0;
        while (f < row->length && (row->field[f] == catalog_any || row->field[f] == field[f])) f++;
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

Status catalog_open_one(Catalog **out, int *model, const char *name, double sag_m)
{
    char   path[temp_path_size];
    char  *real = model_is_path(name) ? realpath(name, NULL) : NULL;
    Status status = STATUS_IO;
    if (!model_is_path(name) && !parametric_known(name)) return model_say_unknown(name);
    if (!temp_file(path, ".csv")) {
        free(real);
        return STATUS_IO;
    }
    FILE *file = output_file(path, 0);
    if (file) {
        fputs("type,model,origin\n*,\"", file);
        for (const char *c = real ? real : name; *c; c++) fputs(*c == '"' ? "\"\"" : (const char[]){*c, 0}, file);
        fputs("\",base\n", file);
        if (fclose(file) == 0) status = catalog_open(out, path, sag_m);
    } else {
        log_error("model: cannot write %s", path);
    }
    unlink(path);
    free(real);
    if (status == STATUS_OK) *model = catalog_find(*out, (DisEntityType){.kind = 1}, NULL, NULL);
    return status;
}
