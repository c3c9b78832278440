/* render/radar/given_list.c: see given_list.h. */
#include "render/radar/given_list.h"

#include <stdlib.h>

enum { by_any, by_model, by_id };

typedef struct GivenRow {
    int             by;
    DisEntityId     id;
    char            model[model_name_size];
    GivenSignature *signature;
} GivenRow;

struct GivenList {
    int       count;
    GivenRow *row;
};

static Status complain(const Table *table, int row, const char *what)
{
    log_error("radar.given: %s:%d: %s", table->path, table->line[row + 1], what);
    return STATUS_BAD_VALUE;
}

static Status take_row(GivenRow *out, const Table *table, int row, const int column[2])
{
    const char *entity = table_text(table, row, column[0]), *file = table_text(table, row, column[1]);
    const char *slash = strrchr(table->path, '/');
    char        path[4096];
    if (!*entity || !*file) return complain(table, row, "entity or signature is empty; * stands for all entities");
    out->by = strcmp(entity, "*") == 0 ? by_any : dis_entity_id_parse(&out->id, entity) ? by_id : by_model;
    if (snprintf(out->model, sizeof out->model, "%s", entity) >= (int)sizeof out->model)
        return complain(table, row, "the name of a model is too long; see `pitviper model list`");
    const int folder = slash && *file != '/' ? (int)(slash - table->path) + 1 : 0;
    if (snprintf(path, sizeof path, "%.*s%s", folder, table->path, file) >= (int)sizeof path)
        return complain(table, row, "the path of the signature is too long");
    return given_signature_open(&out->signature, path);
}

Status given_list_open(GivenList **out, const char *path)
{
    static const char *const name[2] = {"entity", "signature"};
    int        column[2];
    Table      table = {0};
    GivenList *list = calloc(1, sizeof *list);
    if (!list) return STATUS_NO_MEMORY;
    Status status = table_open(&table, path);
    if (status == STATUS_OK && !table_columns(column, &table, name, 2, "radar.given")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) list->row = calloc((size_t)table.rows + 1, sizeof *list->row);
    if (status == STATUS_OK && !list->row) status = STATUS_NO_MEMORY;
    for (int i = 0; status == STATUS_OK && i < table.rows; i++) status = take_row(&list->row[list->count++], &table, i, column);
    table_close(&table);
    if (status == STATUS_OK) *out = list;
    else given_list_close(list);
    return status;
}

void given_list_close(GivenList *list)
{
    if (!list) return;
    for (int i = 0; i < list->count; i++) given_signature_close(list->row[i].signature);
    free(list->row);
    free(list);
}

const GivenSignature *given_list_find(const GivenList *list, DisEntityId id, const char *model)
{
    const GivenRow *best = NULL;
    for (int i = 0; list && i < list->count; i++) {
        const GivenRow *row = &list->row[i];
        const bool      is_it = row->by == by_any || (row->by == by_id ? dis_entity_id_compare(row->id, id) == 0
                                                                       : strcmp(row->model, model) == 0);
        if (is_it && (!best || row->by > best->by)) best = row;
    }
    return best ? best->signature : NULL;
}
