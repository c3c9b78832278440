/* terrain/woods/woods_table.c: the kinds of plants, how one stands, and what grows on each class (etc/woods.csv). */
#include "terrain/woods/woods.h"
#include "pitviper_table.h"

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

const char *plant_mark_name(PlantMark mark)
{
    static const char *const name[PLANT_MARKS] = {"no", "white", "red", "green", "blue"};
    return mark < PLANT_MARKS ? name[mark] : "no";
}

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

typedef struct Row {
    SurfaceClass surface;
    WoodsClass class;
} Row;

static const char *parse_floor(void *out, const char *text)
{
    const PlantKind floor = plant_find(text);
    *(PlantKind *)out = floor;
    return floor == PLANT_KINDS     ? strcmp(text, "none") == 0 ? NULL : "none, or a plant"
           : floor < PLANT_STANDING ? "none, or a low plant"
                                    : NULL;
}

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    const SurfaceClass surface = ((const Row *)read)->surface;
    WoodsClass         c = ((const Row *)read)->class;
    double             sum = 0;
    for (int k = 0; k < PLANT_STANDING; k++) sum += c.share[k];
    if (c.high_m < c.low_m) return table_rows_refuse(rows, number, "high_m", "at least low_m");
    if (c.floor_high_m < c.floor_low_m) return table_rows_refuse(rows, number, "floor_high_m", "at least floor_low_m");
    if (c.per_m2 > 0 && !(sum > 0)) return table_rows_refuse(rows, number, NULL, "the shares of plants are all 0");
    for (int k = 0; k < PLANT_STANDING && sum > 0; k++) c.share[k] /= sum;
    ((WoodsTable *)user)->of[surface] = c;
    return STATUS_OK;
}

#define FIELD(member) TABLE_AT(Row, member)

Status woods_table_read(WoodsTable *out, const char *path)
{
    enum { own = 8 };
    TableColumn columns[own + PLANT_STANDING] = {
        {"surface", TABLE_NAMED, FIELD(surface), SURFACE_NAMED, .key = true},
        {"floor", TABLE_OWN, FIELD(class.floor), .parse = parse_floor},
        {"per_ha", TABLE_DOUBLE, FIELD(class.per_m2), .low = 0, .high = 600, .unit = 1e-4},
        {"low_m", TABLE_DOUBLE, FIELD(class.low_m), .low = 0.2, .high = 60},
        {"high_m", TABLE_DOUBLE, FIELD(class.high_m), .low = 0.2, .high = 60},
        {"floor_per_m2", TABLE_DOUBLE, FIELD(class.floor_per_m2), .low = 0, .high = 4},
        {"floor_low_m", TABLE_DOUBLE, FIELD(class.floor_low_m), .low = 0.02, .high = 3},
        {"floor_high_m", TABLE_DOUBLE, FIELD(class.floor_high_m), .low = 0.02, .high = 3}};
    for (int k = 0; k < PLANT_STANDING; k++) /* a kind without a column does not grow there */
        columns[own + k] = (TableColumn){.name = plant_name((PlantKind)k),
                                         .absent = TABLE_LATER,
                                         .offset = offsetof(Row, class.share) + (size_t)k * sizeof(double),
                                         .high = 1};
    const TableFormat format = {"woods", columns, own + PLANT_STANDING, .next = "etc/woods.csv explains the columns"};
    WoodsTable        woods = {0};
    Row               row;
    for (int s = 0; s < SURFACE_COUNT; s++) woods.of[s].floor = PLANT_KINDS;
    const Status status = table_each(&format, path, &row, sizeof row, take_row, &woods);
    if (status == STATUS_OK) *out = woods;
    return status;
}
