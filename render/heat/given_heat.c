/* render/heat/given_heat.c: reads and writes temperatures that come from files: given by the user, kept over a
 * restart. */

#include "render/heat/given_heat.h"
#include "pitviper_table.h"

#include <stdlib.h>

enum { by_any = 0, by_kind, by_name };

/* Rows of one entity and part: [first, last) of GivenHeat's. */
typedef struct GivenPart {
    int         entity_by; /* kind: of a model */
    DisEntityId id;
    bool        any_part, has_role; /* part is *; a role is called part */
    HeatRole    role;
    const char *model, *part; /* the table's */
    int         first, last;
} GivenPart;

struct GivenHeat {
    TableRows  rows;
    int        count;
    GivenPart *part;
    double    *t_s, *temp_k; /* [rows], those of a part together */
};

/* A row, to be brought together with those of its part. */
typedef struct GivenRow {
    const char *entity, *part;
    double      t_s, temp_k;
    int         row;
    char        id[dis_id_text_size]; /* entity, where it is an id, in one way */
} GivenRow;

static const TableColumn given_columns[] = {
    {"entity", .type = TABLE_CELL, TABLE_AT(GivenRow, entity)},
    {"part", .type = TABLE_CELL, TABLE_AT(GivenRow, part)},
    {"t_s", TABLE_DOUBLE, TABLE_AT(GivenRow, t_s), .low = -1e9, .high = 1e9},
    {"temp_k", TABLE_DOUBLE, TABLE_AT(GivenRow, temp_k), .low = 1, .high = 4000},
};
static const TableFormat given_format = {"heat.given", given_columns, sizeof given_columns / sizeof *given_columns,
                                         .next = "etc/reference/vehicle_heat.md explains the columns"};

static const char *entity_of(const GivenRow *row) { return *row->id ? row->id : row->entity; }

static int by_part(const void *a, const void *b)
{
    const GivenRow *p = a, *q = b;
    int             order = strcmp(entity_of(p), entity_of(q));
    if (order == 0) order = strcmp(p->part, q->part);
    return order != 0 ? order : (p->row > q->row) - (p->row < q->row);
}

static Status begin_part(GivenPart *out, const TableRows *rows, const GivenRow *row, int at)
{
    *out = (GivenPart){.model = row->entity, .part = row->part, .first = at, .last = at};
    if (!*row->entity || !*row->part)
        return table_rows_refuse(rows, row->row, NULL, "entity or part is empty; * stands for all of them");
    out->entity_by = strcmp(row->entity, "*") == 0                ? by_any
                     : dis_entity_id_parse(&out->id, row->entity) ? by_name
                                                                  : by_kind;
    out->any_part = strcmp(row->part, "*") == 0;
    out->has_role = heat_role_find(&out->role, row->part);
    return STATUS_OK;
}

static Status take_rows(GivenHeat *g, GivenRow *row, int count)
{
    for (int i = 0; i < count; i++) {
        DisEntityId  id;
        const Status status = table_rows_get(&row[i], &g->rows, i);
        if (status != STATUS_OK) return status;
        row[i].row = i;
        if (dis_entity_id_parse(&id, row[i].entity)) dis_entity_id_text(row[i].id, id);
    }
    qsort(row, (size_t)count, sizeof *row, by_part);
    for (int i = 0; i < count; i++) {
        const bool same = i > 0 && strcmp(entity_of(&row[i]), entity_of(&row[i - 1])) == 0 &&
                          strcmp(row[i].part, row[i - 1].part) == 0;
        const Status status = same ? STATUS_OK : begin_part(&g->part[g->count++], &g->rows, &row[i], i);
        if (status != STATUS_OK) return status;
        g->t_s[i] = row[i].t_s;
        g->temp_k[i] = row[i].temp_k;
        if (same && !(g->t_s[i] > g->t_s[i - 1]))
            return table_rows_refuse(&g->rows, row[i].row, NULL,
                                     "t_s does not ascend for this entity and part; sort the rows by time");
        g->part[g->count - 1].last = i + 1;
    }
    return STATUS_OK;
}

Status given_heat_open(GivenHeat **out, const char *path)
{
    GivenHeat *g = calloc(1, sizeof *g);
    if (!g) return STATUS_NO_MEMORY;
    Status       status = table_rows_open(&g->rows, &given_format, path);
    const size_t rows = (size_t)g->rows.table.rows;
    GivenRow    *row = calloc(rows + 1, sizeof *row);
    g->part = calloc(rows + 1, sizeof *g->part);
    g->t_s = calloc(rows + 1, sizeof *g->t_s);
    g->temp_k = calloc(rows + 1, sizeof *g->temp_k);
    if (status == STATUS_OK && !(row && g->part && g->t_s && g->temp_k)) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = take_rows(g, row, (int)rows);
    free(row);
    if (status == STATUS_OK) *out = g;
    else given_heat_close(g);
    return status;
}

void given_heat_close(GivenHeat *g)
{
    if (!g) return;
    table_rows_close(&g->rows);
    free(g->part);
    free(g->t_s);
    free(g->temp_k);
    free(g);
}

static bool is_entity(const GivenPart *p, DisEntityId id, const Model *model)
{
    return p->entity_by == by_any ||
           (p->entity_by == by_name ? dis_entity_id_compare(p->id, id) == 0 : strcmp(p->model, model->name) == 0);
}

/* by_any, by_kind, by_name; -1: another part. */
static int part_by(const GivenPart *p, const ModelPart *part)
{
    if (p->any_part) return by_any;
    if (strcmp(p->part, part->name) == 0) return by_name;
    return p->has_role && p->role == part->role ? by_kind : -1;
}

int given_heat_find(int *rank, const GivenHeat *g, DisEntityId id, const Model *model, int part)
{
    int found = -1;
    *rank = -1;
    for (int i = 0; i < g->count; i++) {
        const GivenPart *p = &g->part[i];
        const int        by = part_by(p, &model->part[part]), closer = 3 * p->entity_by + by;
        if (by >= 0 && closer > *rank && is_entity(p, id, model)) *rank = closer, found = i;
    }
    return found;
}

double given_heat_k(const GivenHeat *g, int index, double t_s)
{
    const GivenPart *p = &g->part[index];
    int              low = p->first, high = p->last - 1;
    if (!(t_s > g->t_s[low])) return g->temp_k[low];
    if (t_s >= g->t_s[high]) return g->temp_k[high];
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (g->t_s[middle] <= t_s) low = middle;
        else high = middle;
    }
    return g->temp_k[low] + (t_s - g->t_s[low]) / (g->t_s[high] - g->t_s[low]) * (g->temp_k[high] - g->temp_k[low]);
}

/* ---- kept over a restart ------------------------------------------------------------------------ */

enum { most_nodes = 4096 };

struct KeptHeat {
    TableRows  rows;
    int        count;
    KeptNodes *entity; /* [count], by id */
    double    *temp_k;
};

typedef struct KeptRow {
    KeptNodes   nodes;
    const char *temp_k; /* nodes.nodes numbers */
} KeptRow;

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

static const char *parse_id(void *out, const char *text)
{
    return dis_entity_id_parse(out, text) ? NULL : "an id such as 1:2:3";
}

static const TableColumn kept_columns[] = {
    {"entity", TABLE_OWN, TABLE_AT(KeptRow, nodes.id), .parse = parse_id},
    {"model", .type = TABLE_CELL, TABLE_AT(KeptRow, nodes.model)},
    {"unix_s", TABLE_DOUBLE, TABLE_AT(KeptRow, nodes.unix_s), .low = -1e12, .high = 1e12},
    {"node_k", .type = TABLE_CELL, TABLE_AT(KeptRow, temp_k)},
};
static const TableFormat kept_format = {"heat.vehicles", kept_columns, sizeof kept_columns / sizeof *kept_columns,
                                        .next = "without the file the program assumes what entities did before"};

static Status take_kept_rows(KeptHeat *k)
{
    size_t all = 0, at = 0;
    for (int row = 0; row < k->rows.table.rows; row++) {
        const int nodes = read_numbers(NULL, table_rows_text(&k->rows, row, "node_k"));
        if (nodes <= 0) return table_rows_refuse(&k->rows, row, "node_k", "a list of temperatures of 0.5 .. 10000 K");
        all += (size_t)nodes;
    }
    k->entity = calloc((size_t)k->rows.table.rows + 1, sizeof *k->entity);
    k->temp_k = calloc(all + 1, sizeof *k->temp_k);
    if (!k->entity || !k->temp_k) return STATUS_NO_MEMORY;
    for (int row = 0; row < k->rows.table.rows; row++) {
        KeptRow      read = {0};
        const Status status = table_rows_get(&read, &k->rows, row);
        if (status != STATUS_OK) return status;
        read.nodes.nodes = read_numbers(k->temp_k + at, read.temp_k);
        read.nodes.temp_k = k->temp_k + at;
        at += (size_t)read.nodes.nodes;
        k->entity[k->count++] = read.nodes;
    }
    qsort(k->entity, (size_t)k->count, sizeof *k->entity, by_id);
    return STATUS_OK;
}

Status heat_kept_open(KeptHeat **out, const char *path)
{
    KeptHeat *k = calloc(1, sizeof *k);
    if (!k) return STATUS_NO_MEMORY;
    Status status = table_rows_open(&k->rows, &kept_format, path);
    if (status == STATUS_OK) status = take_kept_rows(k);
    if (status == STATUS_OK) *out = k;
    else heat_kept_close(k);
    return status;
}

void heat_kept_close(KeptHeat *k)
{
    if (!k) return;
    table_rows_close(&k->rows);
    free(k->entity);
    free(k->temp_k);
    free(k);
}

const KeptNodes *heat_kept_find(const KeptHeat *k, DisEntityId id, const char *model, int nodes)
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
    fputs(
        "# Temperatures of entities' thermal networks, K. Written and read again by Pitviper.\nentity,model,unix_s,node_k\n",
        to);
    for (int i = 0; i < kept->count; i++) {
        const KeptNodes *e = &kept->nodes[i];
        dis_entity_id_text(id, e->id);
        fprintf(to, "%s,\"%s\",%.17g,", id, e->model, e->unix_s);
        for (int n = 0; n < e->nodes; n++) fprintf(to, "%s%.9g", n ? " " : "", e->temp_k[n]);
        fputc('\n', to);
    }
}

Status heat_kept_save(const KeptNodes *nodes, int count, const char *path)
{
    return text_write_file("heat.vehicles", path, put_all, &(Kept){nodes, count});
}
