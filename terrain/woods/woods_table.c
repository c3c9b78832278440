/* terrain/woods/woods_table.c: the kinds of plants, how one stands, and what grows on each class (etc/woods.csv). */
#include "terrain/woods/woods.h"

/* ---- kinds --------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    bool        deciduous;
    double      crown;
} kinds[PLANT_KINDS] = {
    [PLANT_PINE] = {"pine", false, 0.16},
    [PLANT_ALDER] = {"alder", true, 0.18},
    [PLANT_BIRCH] = {"birch", true, 0.22},
    [PLANT_ENGLISH_OAK] = {"english_oak", true, 0.29},
    [PLANT_SESSILE_OAK] = {"sessile_oak", true, 0.24},
    [PLANT_RED_OAK] = {"red_oak", true, 0.24},
    [PLANT_WHITE_OAK] = {"white_oak", true, 0.32},
    [PLANT_BUSH] = {"bush", true, 0.49},
    [PLANT_HEDGE] = {"hedge", true, 0.44},
    [PLANT_REED] = {"reed", false, 0.17},
    [PLANT_GRASS] = {"grass_tuft", false, 0.75},
    [PLANT_DRY_GRASS] = {"dry_tuft", false, 0.66},
    [PLANT_CROP] = {"crop_plant", false, 0.22},
    [PLANT_ROCK] = {"boulder", false, 0.65},
};

const char *plant_name(PlantKind kind) { return kind >= 0 && kind < PLANT_KINDS ? kinds[kind].name : "none"; }

/* The kind of that name; PLANT_KINDS: there is none. */
static PlantKind plant_find(const char *name)
{
    for (int k = 0; k < PLANT_KINDS; k++)
        if (strcmp(kinds[k].name, name) == 0) return (PlantKind)k;
    return PLANT_KINDS;
}

bool plant_is_deciduous(PlantKind kind) { return kind >= 0 && kind < PLANT_KINDS && kinds[kind].deciduous; }

double plant_crown_share(PlantKind kind) { return kind >= 0 && kind < PLANT_KINDS ? kinds[kind].crown : 0; }

/* The shortest turn from up to the leaning axis a (Rodrigues): columns of R = I + [w] + [w]^2 / (1 + a_z), w = up x a;
 * of the plant turned by its twist before. */
void plant_axes(double axis[3][3], double scale[2], const Plant *plant, const double sway_rad[2])
{
    const double step = plant_most_tilt_rad / 127;
    const double east = plant->lean[0] * step + (sway_rad ? sway_rad[0] : 0);
    const double north = plant->lean[1] * step + (sway_rad ? sway_rad[1] : 0);
    const double up = 1 / sqrt(1 + east * east + north * north), ax = east * up, ay = north * up;
    const double per = 1 / (1 + up);
    const double x[3] = {1 - ax * ax * per, -ax * ay * per, -ax}, y[3] = {-ax * ay * per, 1 - ay * ay * per, -ay};
    const double turn = plant->twist * (2 * pi_rad / 65536), cosine = cos(turn), sine = sin(turn);
    for (int c = 0; c < 3; c++) {
        axis[0][c] = cosine * x[c] + sine * y[c];
        axis[1][c] = cosine * y[c] - sine * x[c];
    }
    axis[2][0] = ax, axis[2][1] = ay, axis[2][2] = up;
    scale[1] = plant_height_m(plant);
    scale[0] = scale[1] * plant->width / 128;
}

void plant_transform(double m_enu_from_plant[9], const Plant *plant, const double sway_rad[2])
{
    double axis[3][3], scale[2];
    plant_axes(axis, scale, plant, sway_rad);
    for (int c = 0; c < 9; c++) m_enu_from_plant[c] = axis[c % 3][c / 3] * scale[c % 3 == 2];
}

/* ---- what grows on each class -------------------------------------------------------------------- */

static Status read_row(WoodsTable *out, bool seen[SURFACE_COUNT], const Table *table, int row)
{
    static const struct {
        const char *name;
        double      low, high;
    } columns[] = {{"per_ha", 0, 600},     {"low_m", 0.2, 60},       {"high_m", 0.2, 60},
                   {"floor_per_m2", 0, 4}, {"floor_low_m", 0.02, 3}, {"floor_high_m", 0.02, 3}};
    const char        *name = table_text(table, row, table_column(table, "surface"));
    const char        *floor_name = table_text(table, row, table_column(table, "floor"));
    const SurfaceClass surface = surface_find(name);
    double             value[6], sum = 0;
    if (surface == SURFACE_NONE || seen[surface]) {
        log_error("woods: %s:%d: no such surface class, or listed twice: %s", table->path, table->line[row + 1], name);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < 6; k++) {
        const Status got =
            table_number(&value[k], table, row, table_column(table, columns[k].name), columns[k].low, columns[k].high);
        if (got != STATUS_OK) return got;
    }
    WoodsClass c = {.per_m2 = 1e-4 * value[0],
                    .low_m = value[1],
                    .high_m = value[2],
                    .floor = plant_find(floor_name),
                    .floor_per_m2 = value[3],
                    .floor_low_m = value[4],
                    .floor_high_m = value[5]};
    for (int k = 0; k < PLANT_STANDING; k++) {
        const int column = table_column(table, plant_name((PlantKind)k));
        if (column < 0) continue;
        const Status got = table_number(&c.share[k], table, row, column, 0, 1);
        if (got != STATUS_OK) return got;
        sum += c.share[k];
    }
    const bool low_kind = c.floor == PLANT_KINDS ? strcmp(floor_name, "none") == 0 : c.floor >= PLANT_STANDING;
    if (c.high_m < c.low_m || c.floor_high_m < c.floor_low_m || !low_kind || (c.per_m2 > 0 && !(sum > 0))) {
        log_error(
            "woods: %s:%d: high below low, shares that are all 0, or a floor that is neither none nor a low plant: %s",
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
    static const char *const needed[] = {"surface", "per_ha",       "low_m",       "high_m",
                                         "floor",   "floor_per_m2", "floor_low_m", "floor_high_m"};
    WoodsTable               woods = {0};
    Table                    table = {0};
    bool                     seen[SURFACE_COUNT] = {0};
    Status                   status = table_open(&table, path);
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
