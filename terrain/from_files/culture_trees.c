/* terrain/from_files/culture_trees.c: a table of trees: where each stands, its kind and height, and whether its trunk
 * is painted. */
#include "terrain/from_files/culture_import_private.h"
#include "pitviper_table.h"

PlantKind culture_plant(const char *name)
{
    for (int k = 0; k < PLANT_STANDING; k++)
        if (strcmp(plant_name((PlantKind)k), name) == 0) return (PlantKind)k;
    return PLANT_STANDING;
}

typedef struct TreeRow {
    double lat_deg, lon_deg, x_m, y_m, height_m;
    int    kind, mark;
} TreeRow;

static const char *parse_kind(void *member, const char *text)
{
    const PlantKind kind = culture_plant(text);
    *(int *)member = (int)kind;
    return kind < PLANT_STANDING ? NULL
                                 : "pine, alder, birch, english_oak, sessile_oak, red_oak, white_oak, bush or hedge";
}

PlantMark culture_mark(const char *word)
{
    for (int k = 0; k < PLANT_MARKS; k++)
        if (strcmp(plant_mark_name((PlantMark)k), word) == 0) return (PlantMark)k;
    return PLANT_MARKS;
}

static const char *parse_mark(void *member, const char *text)
{
    const PlantMark mark = strcmp(text, "yes") == 0 ? MARK_WHITE : culture_mark(text);
    *(int *)member = (int)mark;
    return mark < PLANT_MARKS ? NULL : "no, yes (white), white, red, green or blue";
}

#define REST                                                                                                           \
    {"kind", TABLE_OWN, TABLE_AT(TreeRow, kind), .absent = TABLE_LATER, .parse = parse_kind},                          \
        {"height_m", TABLE_DOUBLE, TABLE_AT(TreeRow, height_m), .low = 0.3, .high = 100, .absent = TABLE_OPTIONAL},    \
    {                                                                                                                  \
        "marked", TABLE_OWN, TABLE_AT(TreeRow, mark), .absent = TABLE_OPTIONAL, .parse = parse_mark                    \
    }
static const TableColumn on_earth[] = {{"lat", TABLE_DOUBLE, TABLE_AT(TreeRow, lat_deg), .low = -90, .high = 90},
                                       {"lon", TABLE_DOUBLE, TABLE_AT(TreeRow, lon_deg), .low = -180, .high = 180},
                                       REST};
static const TableColumn in_frame[] = {{"x_m", TABLE_DOUBLE, TABLE_AT(TreeRow, x_m), .low = -1e6, .high = 1e6},
                                       {"y_m", TABLE_DOUBLE, TABLE_AT(TreeRow, y_m), .low = -1e6, .high = 1e6},
                                       REST};
enum { tree_columns = sizeof on_earth / sizeof *on_earth };
static const char        next[] = "etc/reference/terrain.md, \"Trees of a table\", has an example";
static const TableFormat formats[3] = {{"trees", on_earth, tree_columns, next, 0, culture_most_records, false},
                                       {"trees", in_frame, tree_columns, next, 0, culture_most_records, false},
                                       {"trees", on_earth + 2, tree_columns - 2, next, 0, culture_most_records, false}};

Status culture_trees_read(Culture *culture, CultureReport *report, const CultureFiles *from)
{
    TableRows rows;
    Status    status = table_rows_open(&rows, &formats[2], from->trees);
    if (status != STATUS_OK) return status;
    const bool local = table_rows_has(&rows, "x_m");
    status = local && (table_rows_has(&rows, "lat") || table_rows_has(&rows, "lon"))
                 ? table_rows_lack(&rows, "places are given twice, by lat and lon and by x_m and y_m: one of both")
                 : table_rows_use(&rows, &formats[local]);
    for (int n = 0; n < rows.table.rows && status == STATUS_OK; n++) {
        TreeRow row = {.kind = PLANT_ENGLISH_OAK};
        double  p_m[2];
        status = table_rows_get(&row, &rows, n);
        if (status != STATUS_OK) break;
        p_m[0] = row.x_m, p_m[1] = row.y_m;
        if (!local) culture_place(p_m, from, row.lon_deg * rad_per_deg, row.lat_deg * rad_per_deg);
        if (!(fabs(p_m[0]) <= from->half_m && fabs(p_m[1]) <= from->half_m)) {
            report->left[CULTURE_LEFT_OUTSIDE]++;
            continue;
        }
        const int64_t number = n;
        status =
            culture_add_tree(culture, &(CultureTree){.id = culture_mix(culture_mix_seed + 1, &number, sizeof number),
                                                     .x_m = p_m[0],
                                                     .y_m = p_m[1],
                                                     .height_m = isnan(row.height_m) ? 0 : (float)row.height_m,
                                                     .kind = (uint8_t)row.kind,
                                                     .mark = (uint8_t)row.mark});
    }
    table_rows_close(&rows);
    return status;
}
