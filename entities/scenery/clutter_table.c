/* entities/scenery/clutter_table.c: what stands about, how densely and how warm: etc/clutter.csv and others of its
 * format. */
#include "entities/scenery/scenery_clutter_private.h"
#include "entities/shapes/parametric.h"

#include <stdio.h>
#include <stdlib.h>

static const char *class_named(int class) { return scenery_class_name((SceneryClass) class); }

static const char *parse_shape(void *out, const char *text)
{
    if (!parametric_known(text)) return "a built-in shape (`pitviper models` lists them)";
    snprintf(out, sizeof((ClutterRow *)0)->shape, "%s", text);
    return NULL;
}

/* Names of materials with blanks between; none: the shape's own. */
static const char *parse_paint(void *out, const char *text)
{
    int         count = 0;
    const char *accepted = "names of materials with blanks between, 8 at most of 31 letters, 95 in all";
    if (strlen(text) >= clutter_cell_octets) return accepted;
    for (const char *at = text; *at;) {
        const size_t length = strcspn(at, " ");
        count += length > 0;
        if (length > 31 || count > clutter_most_variants) return accepted;
        at += length + strspn(at + length, " ");
    }
    snprintf(out, clutter_cell_octets, "%s", text);
    return NULL;
}

static bool is_driven(ClutterWhere where)
{
    return where < CLUTTER_YARDS || where == CLUTTER_IN_FIELD || where == CLUTTER_IN_PASTURE ||
           where == CLUTTER_IN_SCRUB || where == CLUTTER_AT_EDGE;
}

#define FIELD(member) TABLE_AT(ClutterRow, member)

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    ClutterTable     *table = user;
    const ClutterRow *row = read;
    if (row->group_high < row->group_low) return table_rows_refuse(rows, number, "group_high", "at least group_low");
    if (row->length_high_m < row->length_low_m)
        return table_rows_refuse(rows, number, "length_high_m", "at least length_low_m");
    if (row->length_low_m > 0 && !(row->length_low_m >= 0.1))
        return table_rows_refuse(rows, number, "length_low_m", "0, or at least 0.1");
    if (row->running + row->recent > 1) return table_rows_refuse(rows, number, "recent", "at most 1 - running");
    if (row->heat != CLUTTER_ENGINE && row->heat != CLUTTER_WORKS && row->running + row->recent > 0)
        return table_rows_refuse(rows, number, "running", "0 without an engine (heat)");
    if (row->heat == CLUTTER_DRIVES && !is_driven(row->where))
        return table_rows_refuse(rows, number, "heat",
                                 "that of what stands: only on road, lane and track, and over field, pasture, scrub "
                                 "and edge is driven");
    if (row->heat == CLUTTER_DRIVES && row->group_high > 1)
        return table_rows_refuse(rows, number, "group_high", "1 of what drives");
    if (row->group_high > 1 && row->where < CLUTTER_AREAS)
        return table_rows_refuse(rows, number, "group_high", "1 where nothing stands in groups: on ways and in yards");
    table->row[table->rows++] = *row;
    return STATUS_OK;
}

Status clutter_table_read(ClutterTable *out, const char *path)
{
    static const TableColumn columns[] = {
        {"class", TABLE_NAMED, FIELD(class), .low = CLUTTER_NONE + 1, .high = CLUTTER_CLASSES - 1,
         .named = class_named},
        {"shape", TABLE_OWN, FIELD(shape), .parse = parse_shape},
        {"paint", TABLE_OWN, FIELD(paint), .absent = TABLE_EMPTY, .parse = parse_paint},
        {"where", TABLE_CHOICE, FIELD(where),
         .choices =
             "road, lane, track, house, barn, hall, farmyard, works, field, pasture, scrub, forest, edge, rock, sand, built"},
        {"density", TABLE_DOUBLE, FIELD(density), .low = 0, .high = 10000},
        {"group_low", TABLE_WHOLE, FIELD(group_low), .low = 1, .high = 100},
        {"group_high", TABLE_WHOLE, FIELD(group_high), .low = 1, .high = 100},
        {"spread_m", TABLE_DOUBLE, FIELD(spread_m), .low = 0, .high = 80},
        {"length_low_m", TABLE_DOUBLE, FIELD(length_low_m), .low = 0, .high = 20},
        {"length_high_m", TABLE_DOUBLE, FIELD(length_high_m), .low = 0, .high = 20},
        {"heat", TABLE_CHOICE, FIELD(heat), .choices = "cold, engine, works, drives, lives, burns"},
        {"running", TABLE_DOUBLE, FIELD(running), .low = 0, .high = 1},
        {"recent", TABLE_DOUBLE, FIELD(recent), .low = 0, .high = 1},
        {"reach_m", TABLE_DOUBLE, FIELD(reach_m), .low = 0, .high = 65536, .absent = TABLE_LATER},
    };
    static const TableFormat format = {"clutter", columns, sizeof columns / sizeof *columns,
                                       "etc/clutter.csv explains the columns", .most_rows = clutter_most_rows};
    ClutterTable            *table = calloc(1, sizeof *table);
    ClutterRow               row;
    if (!table) return STATUS_NO_MEMORY;
    const Status status = table_each(&format, path, &row, sizeof row, take_row, table);
    if (status == STATUS_OK) *out = *table;
    free(table);
    return status;
}

bool clutter_table_path(char *out, size_t size, const char *named)
{
    static const struct {
        const char *name, *file;
    } built_in[] = {{"countryside", "clutter.csv"}, {"rear_area", "clutter_rear_area.csv"}};
    for (size_t k = 0; k < sizeof built_in / sizeof *built_in; k++)
        if (strcmp(named, built_in[k].name) == 0) return etc_path(out, size, built_in[k].file);
    if (strpbrk(named, "/.") && snprintf(out, size, "%s", named) < (int)size) return true;
    log_error("clutter: no table of that name: %s; next: countryside, rear_area or the path of a CSV", named);
    return false;
}

Status scenery_clutter_check(const char *path)
{
    ClutterTable *table = malloc(sizeof *table);
    const Status  status = table ? clutter_table_read(table, path) : STATUS_NO_MEMORY;
    free(table);
    return status;
}
