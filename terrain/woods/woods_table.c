/* terrain/woods/woods_table.c: reads etc/woods.csv. */
#include "terrain/woods/woods_table.h"

static Status read_row(WoodsTable *out, bool seen[SURFACE_COUNT], const Table *table, int row)
{
    static const struct {
        const char *name;
        double      low, high;
    } columns[] = {{"per_ha", 0, 600}, {"low_m", 0.2, 60}, {"high_m", 0.2, 60}, {"floor_per_m2", 0, 4},
                   {"floor_low_m", 0.02, 3}, {"floor_high_m", 0.02, 3}};
    const char        *name = table_text(table, row, table_column(table, "surface"));
    const char        *floor_name = table_text(table, row, table_column(table, "floor"));
    const SurfaceClass surface = surface_find(name);
    double             value[6], sum = 0;
    if (surface == SURFACE_NONE || seen[surface]) {
        log_error("woods: %s:%d: no such surface class, or listed twice: %s", table->path, table->line[row + 1], name);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < 6; k++) {
        const Status got = table_number(&value[k], table, row, table_column(table, columns[k].name), columns[k].low,
                                        columns[k].high);
        if (got != STATUS_OK) return got;
    }
    WoodsClass c = {.per_m2 = 1e-4 * value[0], .low_m = value[1], .high_m = value[2], .floor = plant_find(floor_name),
                    .floor_per_m2 = value[3], .floor_low_m = value[4], .floor_high_m = value[5]};
    for (int k = 0; k < PLANT_STANDING; k++) {
        const int column = table_column(table, plant_name((PlantKind)k));
        if (column < 0) continue;
        const Status got = table_number(&c.share[k], table, row, column, 0, 1);
        if (got != STATUS_OK) return got;
        sum += c.share[k];
    }
    const bool low_kind = c.floor == PLANT_KINDS ? strcmp(floor_name, "none") == 0 : c.floor >= PLANT_STANDING;
    if (c.high_m < c.low_m || c.floor_high_m < c.floor_low_m || !low_kind || (c.per_m2 > 0 && !(sum > 0))) {
        log_error("woods: %s:%d: high below low, shares that are all 0, or a floor that is neither none nor a low plant: %s",
                  table->path, table->line[row + 1], floor_name);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < PLANT_STANDING && sum > 0; k++) c.share[k] /= sum;
    seen[surface] = true;
    out->of[surface] = c;
    return STATUS_OK;
}

Status woods_table_read(WoodsTable *out, const char *path)
{
    static const char *const needed[] = {"surface", "per_ha", "low_m", "high_m", "floor", "floor_per_m2", "floor_low_m",
                                         "floor_high_m"};
    WoodsTable woods = {0};
    Table      table = {0};
    bool       seen[SURFACE_COUNT] = {0};
    Status     status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    for (int s = 0; s < SURFACE_COUNT; s++) woods.of[s].floor = PLANT_KINDS;
    for (size_t k = 0; k < sizeof needed / sizeof *needed && status == STATUS_OK; k++)
        if (table_column(&table, needed[k]) < 0) {
            log_error("woods: column missing: file=%s column=%s", path, needed[k]);
            status = STATUS_BAD_VALUE;
        }
    for (int row = 0; row < table.rows && status == STATUS_OK; row++) status = read_row(&woods, seen, &table, row);
    table_close(&table);
    if (status == STATUS_OK) *out = woods;
    return status;
}
