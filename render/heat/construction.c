/* render/heat/construction.c: reads etc/constructions.csv and etc/construction_layers.csv (construction.h). */
#include "render/heat/construction.h"

#include "pitviper_table.h"

#include <stdlib.h>

/* ---- materials of layers ------------------------------------------------------------------------ */

#define LAYER(member) TABLE_AT(LayerMaterial, member)

static const TableColumn layer_columns[] = {
    {"name", .type = TABLE_NAME, LAYER(name)},
    {"w_mk", TABLE_DOUBLE, LAYER(conductivity_w_mk), .low = 1e-3, .high = 500, .absent = TABLE_EMPTY},
    {"kg_m3", TABLE_DOUBLE, LAYER(density_kg_m3), .low = 0.5, .high = 20000},
    {"j_kgk", TABLE_DOUBLE, LAYER(heat_capacity_j_kgk), .low = 100, .high = 5000},
    {"m2k_w", TABLE_DOUBLE, LAYER(resistance_m2k_w), .low = 1e-3, .high = 10, .absent = TABLE_EMPTY},
};
static const TableFormat layer_format = {"constructions",
                                         layer_columns,
                                         sizeof layer_columns / sizeof *layer_columns,
                                         .next = "etc/construction_layers.csv explains the columns",
                                         .least_rows = 1,
                                         .most_rows = construction_most_materials};

typedef struct LayerMaterials {
    int           count;
    LayerMaterial row[construction_most_materials];
} LayerMaterials;

static Status take_layer(void *user, const void *read, const TableRows *rows, int number)
{
    LayerMaterials      *to = user;
    const LayerMaterial *m = read;
    for (int k = 0; k < to->count; k++)
        if (strcmp(to->row[k].name, m->name) == 0)
            return table_rows_refuse(rows, number, "name", "another name than those of the rows above");
    if ((m->conductivity_w_mk > 0) == (m->resistance_m2k_w > 0))
        return table_rows_refuse(rows, number, NULL, "one of w_mk and m2k_w must be given");
    to->row[to->count++] = *m;
    return STATUS_OK;
}

/* ---- constructions ------------------------------------------------------------------------------ */

typedef struct Row {
    Construction c;
    char         role[24], layers[256];
    double       day_c, night_c;
} Row;

#define KIND(member) TABLE_AT(Row, c.member)

static const char inside_words[] = "heated, unheated, flue, back, none";

/* Any text that fits. */
static const char *parse_role(void *member, const char *text)
{
    return snprintf(member, sizeof((Row *)0)->role, "%s", text) < (int)sizeof((Row *)0)->role ? NULL : "a heat role";
}
static const char *parse_part(void *member, const char *text)
{
    const int most = (int)sizeof((Construction *)0)->part;
    return snprintf(member, (size_t)most, "%s", text) < most ? NULL : "the name of a part, of at most 23 letters";
}
static const char *parse_material(void *member, const char *text)
{
    const int most = (int)sizeof((Construction *)0)->material;
    return snprintf(member, (size_t)most, "%s", text) < most ? NULL : "a piece of names in etc/materials.csv";
}
static const char *parse_layers(void *member, const char *text)
{
    const int most = (int)sizeof((Row *)0)->layers;
    return snprintf(member, (size_t)most, "%s", text) < most ? NULL : "at most 255 letters";
}

static const TableColumn columns[] = {
    {"name", .type = TABLE_NAME, KIND(name)},
    {"part", TABLE_OWN, KIND(part), .absent = TABLE_EMPTY, .parse = parse_part},
    {"role", TABLE_OWN, TABLE_AT(Row, role), .absent = TABLE_EMPTY, .parse = parse_role},
    {"material", TABLE_OWN, KIND(material), .absent = TABLE_EMPTY, .parse = parse_material},
    {"layers", TABLE_OWN, TABLE_AT(Row, layers), .parse = parse_layers},
    {"inside", TABLE_CHOICE, KIND(inside), .choices = inside_words},
    {"inside_w_m2k", TABLE_DOUBLE, KIND(inside_w_m2k), .low = 0.1, .high = 100, .absent = TABLE_EMPTY},
    {"day_c", TABLE_DOUBLE, TABLE_AT(Row, day_c), .low = -50, .high = 500, .absent = TABLE_EMPTY, .otherwise = 0},
    {"night_c", TABLE_DOUBLE, TABLE_AT(Row, night_c), .low = -50, .high = 500, .absent = TABLE_EMPTY, .otherwise = 0},
    {"room_kj_m2k", TABLE_DOUBLE, KIND(room_j_m2k), .low = 0.1, .high = 1e4, .unit = 1e3, .absent = TABLE_EMPTY},
    {"room_w_m2k", TABLE_DOUBLE, KIND(room_w_m2k), .low = 0, .high = 100, .absent = TABLE_EMPTY},
    {"rough", TABLE_DOUBLE, KIND(rough), .low = 1, .high = 2.5},
    {"absorptance", TABLE_DOUBLE, KIND(absorptance), .low = 0, .high = 1, .absent = TABLE_EMPTY, .otherwise = NAN},
};
static const TableFormat format = {"constructions",
                                   columns,
                                   sizeof columns / sizeof *columns,
                                   .next = "etc/constructions.csv explains the columns",
                                   .least_rows = 1,
                                   .most_rows = construction_most};

typedef struct Reading {
    Constructions        *out;
    const LayerMaterials *materials;
} Reading;

/* "NAME MM; NAME MM ...", from outside in. Returns what is wrong, NULL: nothing. */
static const char *read_layers(Construction *c, const char *text, const LayerMaterials *of)
{
    char words[sizeof((Row *)0)->layers], *rest = NULL;
    snprintf(words, sizeof words, "%s", text);
    for (char *layer = strtok_r(words, ";", &rest); layer; layer = strtok_r(NULL, ";", &rest)) {
        char         name[32], *end, *number = NULL, *word = strtok_r(layer, " ", &number);
        const double mm = word && number ? strtod(number, &end) : NAN;
        if (!word || !number || end == number || end[strspn(end, " ")] || !(mm >= 0.1 && mm <= 5000))
            return "layers are NAME and thickness in mm, 0.1 .. 5000, with ; between";
        if (c->layers == construction_most_layers) return "there are at most 6 layers";
        snprintf(name, sizeof name, "%.31s", word);
        int at = 0;
        while (at < of->count && strcmp(of->row[at].name, name) != 0) at++;
        if (at == of->count) return "layers of materials that are rows of etc/construction_layers.csv";
        const LayerMaterial *m = &of->row[at];
        const double         w_mk = m->resistance_m2k_w > 0 ? 1e-3 * mm / m->resistance_m2k_w : m->conductivity_w_mk;
        c->layer[c->layers++] = (ColumnLayer){1e-3 * mm, w_mk, m->density_kg_m3 * m->heat_capacity_j_kgk};
    }
    return c->layers > 0 ? NULL : "there is no layer";
}

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    static const double zero_c = 273.15;
    Reading            *r = user;
    const Row          *row = read;
    Construction       *c = &r->out->row[r->out->count];
    *c = row->c;
    c->any_role = !*row->role;
    if (!c->any_role && !heat_role_find(&c->role, row->role))
        return table_rows_refuse(rows, number, "role", "a heat role, or empty: any");
    const char *wrong = read_layers(c, row->layers, r->materials);
    if (wrong) return table_rows_refuse(rows, number, "layers", "%s", wrong);
    Column column;
    if (column_create(&column, c->layer, c->layers, wall_first_m, wall_growth) != STATUS_OK)
        return table_rows_refuse(rows, number, "layers", "thinner: they have more than 96 elements");
    const bool room = c->inside == BEHIND_HEATED || c->inside == BEHIND_UNHEATED || c->inside == BEHIND_FLUE;
    if (room != (c->inside_w_m2k > 0))
        return table_rows_refuse(rows, number, "inside_w_m2k", "given of a room or flue, and else empty");
    if (c->inside == BEHIND_UNHEATED && !(c->room_j_m2k > 0))
        return table_rows_refuse(rows, number, "room_kj_m2k", "given of an unheated room");
    if ((c->inside == BEHIND_HEATED || c->inside == BEHIND_FLUE) &&
        !(*table_rows_text(rows, number, "day_c") && *table_rows_text(rows, number, "night_c")))
        return table_rows_refuse(rows, number, "day_c", "the temperature of a heated room or flue, and night_c too");
    c->room_day_k = zero_c + row->day_c, c->room_night_k = zero_c + row->night_c;
    r->out->count++;
    const bool last = number == rows->table.rows - 1;
    return last && (*c->part || !c->any_role || *c->material)
               ? table_rows_refuse(rows, number, NULL, "the last row must fit any part: no part, role or material")
               : STATUS_OK;
}

Status constructions_open(Constructions *out, const char *path, const char *layers_path)
{
    LayerMaterials *materials = calloc(1, sizeof *materials);
    Row            *row = calloc(1, sizeof *row);
    LayerMaterial   layer;
    Status          status = materials && row ? STATUS_OK : STATUS_NO_MEMORY;
    memset(out, 0, sizeof *out);
    if (status == STATUS_OK)
        status = table_each(&layer_format, layers_path, &layer, sizeof layer, take_layer, materials);
    if (status == STATUS_OK) status = table_each(&format, path, row, sizeof *row, take_row, &(Reading){out, materials});
    free(row);
    free(materials);
    return status;
}

Status constructions_open_etc(Constructions *out)
{
    char path[2][512];
    if (etc_path(path[0], sizeof path[0], "constructions.csv") &&
        etc_path(path[1], sizeof path[1], "construction_layers.csv"))
        return constructions_open(out, path[0], path[1]);
    log_error("heat: path of the tables is too long; set PITVIPER_ETC to a shorter one");
    return STATUS_BAD_VALUE;
}

int constructions_find(const Constructions *of, const char *part, HeatRole role, const char *material)
{
    for (int k = 0; k < of->count - 1; k++) {
        const Construction *c = &of->row[k];
        if ((!*c->part || strcmp(c->part, part) == 0) && (c->any_role || c->role == role) &&
            strstr(material, c->material))
            return k;
    }
    return of->count - 1;
}

int constructions_named(const Constructions *of, const char *name)
{
    for (int k = 0; k < of->count; k++)
        if (strcmp(of->row[k].name, name) == 0) return k;
    return -1;
}
