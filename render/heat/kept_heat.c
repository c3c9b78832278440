/* render/heat/kept_heat.c: see kept_heat.h. */
#include "render/heat/kept_heat.h"

#include <stdlib.h>

enum { most_nodes = 4096 };

struct KeptHeat {
    Table      table;
    int        count;
    KeptNodes *entity; /* [count], by id */
    double    *temp_k;
};

static Status complain(const Table *table, int row, const char *what)
{
    log_error("heat.vehicles: %s:%d: %s; without the file the program assumes what entities did before", table->path,
              table->line[row + 1], what);
    return STATUS_BAD_VALUE;
}

/* Numbers with blanks between. -1: something else, or out of range. */
static int read_numbers(double *out, const char *text)
{
    int count = 0;
    while (*text == ' ') text++;
    while (*text) {
        char        *end;
        const double k = strtod(text, &end);
        if (end == text || !(k >= 0.5 && k <= 1e4) || (*end && *end != ' ') || count == most_nodes) return -1;
        if (out) out[count] = k;
        count++;
        for (text = end; *text == ' ';) text++;
    }
    return count;
}

static int by_id(const void *a, const void *b)
{
    const KeptNodes *p = a, *q = b;
    const int        order = dis_entity_id_compare(p->id, q->id);
    return order != 0 ? order : (p->temp_k > q->temp_k) - (p->temp_k < q->temp_k);
}

static Status take_rows(KeptHeat *k, const int column[4])
{
    size_t all = 0, at = 0;
    for (int row = 0; row < k->table.rows; row++) {
        const int nodes = read_numbers(NULL, table_text(&k->table, row, column[3]));
        if (nodes <= 0) return complain(&k->table, row, "node_k is not a list of temperatures of 0.5 .. 10000 K");
        all += (size_t)nodes;
    }
    k->entity = calloc((size_t)k->table.rows + 1, sizeof *k->entity);
    k->temp_k = calloc(all + 1, sizeof *k->temp_k);
    if (!k->entity || !k->temp_k) return STATUS_NO_MEMORY;
    for (int row = 0; row < k->table.rows; row++) {
        KeptNodes *e = &k->entity[k->count];
        e->model  = table_text(&k->table, row, column[1]);
        e->temp_k = k->temp_k + at;
        if (!dis_entity_id_parse(&e->id, table_text(&k->table, row, column[0]))) return complain(&k->table, row, "entity is no id such as 1:2:3");
        const Status status = table_number(&e->unix_s, &k->table, row, column[2], -1e12, 1e12);
        if (status != STATUS_OK) return status;
        e->nodes = read_numbers(k->temp_k + at, table_text(&k->table, row, column[3]));
        at += (size_t)e->nodes;
        k->count++;
    }
    qsort(k->entity, (size_t)k->count, sizeof *k->entity, by_id);
    return STATUS_OK;
}

Status kept_heat_open(KeptHeat **out, const char *path)
{
    static const char *const name[4] = {"entity", "model", "unix_s", "node_k"};
    int       column[4];
    KeptHeat *k = calloc(1, sizeof *k);
    if (!k) return STATUS_NO_MEMORY;
    Status status = table_open(&k->table, path);
    if (status == STATUS_OK && !table_columns(column, &k->table, name, 4, "heat.vehicles")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = take_rows(k, column);
    if (status == STATUS_OK) *out = k;
    else kept_heat_close(k);
    return status;
}

void kept_heat_close(KeptHeat *k)
{
    if (!k) return;
    table_close(&k->table);
    free(k->entity);
    free(k->temp_k);
    free(k);
}

const KeptNodes *kept_heat_find(const KeptHeat *k, DisEntityId id, const char *model, int nodes)
{
    int low = 0, high = k->count;
    while (low < high) { /* the first of that id */
        const int middle = low + (high - low) / 2;
        if (dis_entity_id_compare(k->entity[middle].id, id) < 0) low = middle + 1;
        else high = middle;
    }
    if (low == k->count || dis_entity_id_compare(k->entity[low].id, id) != 0) return NULL;
    return k->entity[low].nodes == nodes && strcmp(k->entity[low].model, model) == 0 ? &k->entity[low] : NULL;
}

typedef struct Kept {
    const KeptNodes *nodes;
    int              count;
} Kept;

static void put_all(FILE *to, const void *user)
{
    const Kept *kept = user;
    char        id[dis_id_text_size];
    fputs("# Temperatures of entities' thermal networks, K. Written and read again by Pitviper.\nentity,model,unix_s,node_k\n", to);
    for (int i = 0; i < kept->count; i++) {
        const KeptNodes *e = &kept->nodes[i];
        dis_entity_id_text(id, e->id);
        fprintf(to, "%s,\"%s\",%.17g,", id, e->model, e->unix_s);
        for (int n = 0; n < e->nodes; n++) fprintf(to, "%s%.9g", n ? " " : "", e->temp_k[n]);
        fputc('\n', to);
    }
}

Status kept_heat_save(const KeptNodes *nodes, int count, const char *path)
{
    return text_write_file("heat.vehicles", path, put_all, &(Kept){nodes, count});
}
