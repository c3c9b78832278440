/* tests/fuzz/fuzz_table.c: any octets as a table of CSV, and as every table of etc/ whose columns it has. Without a
 * fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/catalog.h"
#include "entities/effects.h"
#include "entities/heat.h"
#include "render/atmosphere_private.h"
#include "render/materials.h"
#include "sensor/detector/preset.h"

#include <stdlib.h>

const int fuzz_rounds = 1500;

/* A table of etc/, or a few rows in the way of the others. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const name[] = {"catalog.csv",  "heat.csv",     "effects.csv",
                                       "materials.csv", "surfaces.csv", "sensors.csv"};
    enum { names = sizeof name / sizeof *name };
    char path[1024];
    switch (index % (names + 3)) {
    case names:
        return fuzz_seed_text(out, "type,model,origin\n1.1.*.2,unknown,base\n1,\"tank_t72\",centre\n*,unknown,base\n");
    case names + 1:
        return fuzz_seed_text(out, "observer_m,target_m,range_m,sun,depth\n0,0,10,0.1,1\n0,0,100,0.2,2\n"
                                   "0,50,60,0.1,1\n50,0,60,0.1,1\n50,50,10,0.3,1\n");
    case names + 2:
        return fuzz_seed_text(out, "# full\nheight_m,angle_deg,b,g\n0,0,1,2\n0,10,3,4\n10,0,5,6\n10,10,7,\"8\"\n");
    default:
        break;
    }
    FILE *file = etc_path(path, sizeof path, name[index % (names + 3)]) ? fopen(path, "rb") : NULL;
    if (!file) return 0;
    const size_t size = fread(out, 1, fuzz_seed_octets, file);
    fclose(file);
    return size;
}

/* Every cell of the table is a string, and a number only within what was asked for. */
static void walk(const Table *table)
{
    if (table->columns < 1 || table->rows < 0) abort();
    for (int row = 0; row < table->rows; row++)
        for (int column = 0; column < table->columns; column++) {
            double    number, unix_s;
            long long whole;
            const char *text = table_text(table, row, column);
            if (table_number(&number, table, row, column, -10, 10) == STATUS_OK && !(fabs(number) <= 10)) abort();
            if (text_to_double(&number, text) && !isfinite(number)) abort();
            (void)text_to_long(&whole, text);
            if (text_to_unix_s(&unix_s, text) && !(fabs(unix_s) <= 5e9)) abort();
            if (column > 0 && text == table_text(table, row, column - 1)) abort();
        }
}

static void read_grids(const char *path)
{
    static const GridColumn axis[2] = {{"height_m", 0, height_max_m}, {"angle_deg", 0, 180}};
    static const GridColumn value[2] = {{"b", 1e-6, 1e6}, {"g", 1e-6, 1e6}};
    Grid grid;
    for (int axes = 1; axes <= 2; axes++) {
        if (grid_open(&grid, path, axis, axes, value, 2) != STATUS_OK) continue;
        double out[2];
        grid_at(out, &grid, (const double[2]){12, 34});
        if (!(out[0] >= 0.99e-6 && out[0] <= 1.01e6)) abort();
        grid_close(&grid);
    }
}

static void read_paths(const char *path)
{
    static const GridColumn value[2] = {{"sun", 0, 100}, {"depth", 0, 100}};
    PathTable paths;
    for (int keys = 3; keys <= 5; keys += 2) {
        if (paths_open(&paths, path, keys, value, 2, NULL) != STATUS_OK) continue;
        for (int i = 0; i < paths.rows * paths.values; i++)
            if (!(paths.value[i] >= 0 && paths.value[i] <= 100)) abort();
        paths_close(&paths);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char materials_path[1024], surfaces_path[1024];
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (!*materials_path && !(etc_path(materials_path, sizeof materials_path, "materials.csv") &&
                              etc_path(surfaces_path, sizeof surfaces_path, "surfaces.csv")))
        abort();
    char      path[fuzz_path_size];
    const int file = fuzz_file(path, data, size);
    if (file < 0) return 0;

    Table table;
    if (table_open(&table, path) == STATUS_OK) {
        walk(&table);
        if (table_column(&table, "origin") >= 0) {
            Catalog *catalog;
            if (catalog_open(&catalog, path, 0.1) == STATUS_OK) {
                for (int kind = 0; kind < 4; kind++) {
                    const int model = catalog_find(catalog, (DisEntityType){.kind = (uint8_t)kind}, NULL, NULL);
                    if (model < 0 || model >= catalog_model_count(catalog)) abort();
                }
                catalog_close(catalog);
            }
        }
        HeatTable    heat;
        EffectTable  effects;
        SensorPreset preset;
        Materials    materials;
        if (table_column(&table, "driver") >= 0) (void)heat_table_open(&heat, path);
        if (table_column(&table, "life_s") >= 0) (void)effect_table_open(&effects, path);
        if (table_column(&table, "hfov_deg") >= 0 && preset_read(&preset, path, "staring_lwir") == STATUS_OK)
            preset_refresh(&preset);
        if (table_column(&table, "metal") >= 0 && materials_open(&materials, path, surfaces_path, NULL) == STATUS_OK)
            materials_close(&materials);
        if (table_column(&table, "surface") >= 0 && materials_open(&materials, materials_path, path, NULL) == STATUS_OK)
            materials_close(&materials);
        if (table_column(&table, "height_m") >= 0) read_grids(path);
        if (table_column(&table, "range_m") >= 0) read_paths(path);
        table_close(&table);
    }
    close(file);
    return 0;
}
