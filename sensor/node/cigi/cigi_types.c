/* sensor/node/cigi/cigi_types.c: reads the table of a CIGI host's entity types. */
#include "sensor/node/cigi/cigi_types.h"

#include "entities/exercise/scenario.h"
#include "pitviper_table.h"

static const char *parse_type(void *member, const char *text)
{
    return scenario_type_parse(member, text) ? NULL : "an entity type, for example 1.1.222.1.1.1.0";
}

static const TableColumn columns[] = {
    {"number", TABLE_INT, TABLE_AT(CigiType, number), .low = 1, .high = 65535},
    {"type", TABLE_OWN, TABLE_AT(CigiType, type), .parse = parse_type},
    {"force", TABLE_CHOICE, TABLE_AT(CigiType, force), .choices = "other, friendly, opposing, neutral"},
};

static const TableFormat format = {.module = "cigi types",
                                   .column = columns,
                                   .count = sizeof columns / sizeof *columns,
                                   .next = "etc/cigi_types.csv explains the columns",
                                   .most_rows = cigi_types_most};

static Status take(void *user, const void *row, const TableRows *rows, int number)
{
    CigiTypes      *types = user;
    const CigiType *type = row;
    if (cigi_types_find(types, type->number))
        return table_rows_refuse(rows, number, "number", "a number that no row before has");
    types->row[types->count++] = *type;
    return STATUS_OK;
}

Status cigi_types_read(CigiTypes *out, const char *path)
{
    char     own[4096];
    CigiType row;
    out->count = 0;
    if (!*path && !etc_path(own, sizeof own, "cigi_types.csv")) return STATUS_IO;
    return table_each(&format, *path ? path : own, &row, sizeof row, take, out);
}

const CigiType *cigi_types_find(const CigiTypes *types, int number)
{
    for (int i = 0; i < types->count; i++)
        if (types->row[i].number == number) return &types->row[i];
    return NULL;
}
