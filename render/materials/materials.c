/* render/materials/materials.c: reads the material tables and resolves names to rows once, so that no strings are
 * compared later. */
#include "render/materials/materials.h"

#include "pitviper_table.h"

#include <stdio.h>
#include <stdlib.h>

enum { materials_limit = 60000 }; /* a hit carries its row in 16 bits */

int materials_find(const Materials *materials, const char *name)
{
    for (int i = 0; i < materials->count; i++)
        if (strcmp(materials->material[i].name, name) == 0) return i;
    return -1;
}

/* A row as it is in the file. */
typedef struct Row {
    Material m;
    double   tau[SPECTRAL_PLACES];
} Row;

#define FIELD(member) TABLE_AT(Row, m.member)

static const TableColumn fixed_columns[] = {
    {"name", .type = TABLE_NAME, FIELD(name)},
    {"solar_absorptance", TABLE_FLOAT, FIELD(solar_absorptance), .low = 0, .high = 1},
    {"gloss", TABLE_FLOAT, FIELD(gloss), .low = 0, .high = 1},
    {"roughness_rad", TABLE_FLOAT, FIELD(roughness), .low = 0, .high = 1.5},
    {"metal", TABLE_FLOAT, FIELD(metal), .low = 0, .high = 1},
    {"radar_gamma", TABLE_FLOAT, FIELD(radar_gamma), .low = 0, .high = 100},
    /* from still air and aerogel to copper, tungsten and hydrogen-rich liquids, with margin */
    {"conductivity_w_mk", TABLE_FLOAT, FIELD(conductivity_w_mk), .low = 0.01, .high = 1000},
    {"density_kg_m3", TABLE_FLOAT, FIELD(density_kg_m3), .low = 1, .high = 25000},
    {"heat_capacity_j_kgk", TABLE_FLOAT, FIELD(heat_capacity_j_kgk), .low = 50, .high = 10000},
};
enum { fixed_count = sizeof fixed_columns / sizeof *fixed_columns };

/* Reflectance and transmittance in a channel's place. */
static const struct {
    size_t rho, tau;
} places[SPECTRAL_PLACES] = {
    [SPECTRAL_B] = {offsetof(Material, rho[optical_channel_b]), offsetof(Material, tau[optical_channel_b])},
    [SPECTRAL_G] = {offsetof(Material, rho[optical_channel_g]), offsetof(Material, tau[optical_channel_g])},
    [SPECTRAL_R] = {offsetof(Material, rho[optical_channel_r]), offsetof(Material, tau[optical_channel_r])},
    [SPECTRAL_PAN] = {offsetof(Material, rho[optical_channel_pan]), offsetof(Material, tau[optical_channel_pan])},
    [SPECTRAL_NIR] = {offsetof(Material, rho[optical_channel_nir]), offsetof(Material, tau[optical_channel_nir])},
    [SPECTRAL_MWIR] = {offsetof(Material, rho_mwir), offsetof(Material, tau_mwir)},
    [SPECTRAL_LWIR] = {offsetof(Material, rho_lwir), offsetof(Material, tau_lwir)},
};

/* The columns of a file of materials: rho_CHANNEL, and tau_CHANNEL behind them. */
typedef struct Columns {
    TableColumn column[fixed_count + 2 * SPECTRAL_PLACES];
    char        name[2 * SPECTRAL_PLACES][32];
    TableFormat plain, with_tau;
} Columns;

static void fill_columns(Columns *out)
{
    memcpy(out->column, fixed_columns, sizeof fixed_columns);
    for (int k = 0; k < 2 * SPECTRAL_PLACES; k++) {
        const int  p = k % SPECTRAL_PLACES;
        const bool tau = k >= SPECTRAL_PLACES;
        snprintf(out->name[k], sizeof out->name[k], "%s_%s", tau ? "tau" : "rho", channel_in((ChannelPlace)p)->name);
        out->column[fixed_count + k] =
            (TableColumn){.name = out->name[k],
                          .type = tau ? TABLE_DOUBLE : TABLE_FLOAT,
                          .offset = tau ? offsetof(Row, tau) + (size_t)p * sizeof(double) : places[p].rho,
                          .high = 1};
    }
    out->plain = (TableFormat){.module = "materials",
                               .column = out->column,
                               .count = fixed_count + SPECTRAL_PLACES,
                               .next = "etc/materials.csv explains the columns"};
    out->with_tau = out->plain;
    out->with_tau.count += SPECTRAL_PLACES;
}

/* A row's transmittances; with its reflectance each at most 1. */
static Status take_tau(Row *row, const TableRows *rows, int number, const Columns *columns)
{
    for (int p = 0; p < SPECTRAL_PLACES; p++) {
        const char  *name = columns->name[SPECTRAL_PLACES + p];
        const double rho = (double)*(const float *)((const char *)&row->m + places[p].rho), tau = row->tau[p];
        if (tau + rho > 1) return table_rows_refuse(rows, number, name, "at most 1 together with the reflectance");
        if (tau > 0 && (!(rho > 0) || row->m.gloss > 0))
            return table_rows_refuse(rows, number, name,
                                     "0: what lets light through reflects some as well, and has no gloss");
        *(float *)((char *)&row->m + places[p].tau) = (float)tau;
    }
    return STATUS_OK;
}

/* Whose rows a file holds. A row of the program or of plants whose name an earlier file has is left out; a row of the
 * user's replaces that row in its place. */
typedef enum RowsOf { ROWS_PROGRAM, ROWS_PLANTS, ROWS_OWN } RowsOf;

static bool name_repeated(const TableRows *rows, int row, const char *name)
{
    for (int earlier = 0; earlier < row; earlier++)
        if (strcmp(table_rows_text(rows, earlier, "name"), name) == 0) return true;
    return false;
}

static Status take_rows(Materials *m, const TableRows *rows, const Columns *columns, RowsOf of)
{
    for (int i = 0; i < rows->table.rows; i++) {
        Row    row = {0};
        Status status = table_rows_get(&row, rows, i);
        if (status == STATUS_OK && rows->format == &columns->with_tau) status = take_tau(&row, rows, i, columns);
        if (status != STATUS_OK) return status;
        const int same = materials_find(m, row.m.name);
        if (same == 0 || name_repeated(rows, i, row.m.name))
            return table_rows_refuse(rows, i, "name", "a name of its own: repeated, or that of the program's row 0");
        if (same < 0) m->material[m->count++] = row.m;
        else if (of == ROWS_OWN) m->material[same] = row.m;
    }
    return STATUS_OK;
}

/* Appends the rows of one file to those present. */
static Status read_rows(Materials *m, const char *path, RowsOf of)
{
    TableRows rows;
    Columns   columns;
    Status    status = channels_load();
    if (status != STATUS_OK) return status;
    fill_columns(&columns);
    status = table_rows_open(&rows, &columns.plain, path);
    if (status != STATUS_OK) return status;
    if (of == ROWS_PLANTS || (of == ROWS_OWN && table_rows_has(&rows, columns.name[SPECTRAL_PLACES])))
        status = table_rows_use(&rows, &columns.with_tau);
    if (status == STATUS_OK && rows.table.rows > materials_limit - m->count)
        status = table_rows_lack(&rows, "%d rows are too many; the limit is %d", rows.table.rows, (int)materials_limit);
    Material *larger = NULL;
    if (status == STATUS_OK) {
        larger = realloc(m->material, ((size_t)m->count + (size_t)rows.table.rows + 1) * sizeof *m->material);
        if (larger) m->material = larger;
        else status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK) status = take_rows(m, &rows, &columns, of);
    table_rows_close(&rows);
    return status;
}

/* Those of the table, each at its place whatever the user has; then the user's own (models.materials), which replace
 * rows of the table at their places or follow it. */
static Status read_materials(Materials *m, const char *path)
{
    const char *own = etc_own("materials.csv");
    Status      status = STATUS_OK;
    m->material = calloc(1, sizeof *m->material);
    if (!m->material) return STATUS_NO_MEMORY;
    /* row 0: absorbs everything, reflects nothing; its heat is that of dry sand */
    m->material[0] =
        (Material){.name = "none", .conductivity_w_mk = 0.24f, .density_kg_m3 = 1600, .heat_capacity_j_kgk = 800};
    m->count = 1;
    status = read_rows(m, path, ROWS_PROGRAM);
    m->own_first = m->count;
    return status == STATUS_OK && own ? read_rows(m, own, ROWS_OWN) : status;
}

typedef struct SurfaceRow {
    SurfaceClass surface;
    const char  *material;
} SurfaceRow;

static Status take_surface(void *user, const void *read, const TableRows *rows, int number)
{
    Materials        *m = user;
    const SurfaceRow *row = read;
    const int         material = materials_find(m, row->material);
    if (material < 0) return table_rows_refuse(rows, number, "material", "the name of a material");
    m->surface[row->surface] = material;
    return STATUS_OK;
}

static Status read_surfaces(Materials *m, const char *path)
{
    static const TableColumn columns[] = {
        {"surface", TABLE_NAMED, TABLE_AT(SurfaceRow, surface), SURFACE_NAMED, .key = true},
        {"material", .type = TABLE_CELL, TABLE_AT(SurfaceRow, material)}};
    static const TableFormat format = {"materials", columns, 2, .every = true,
                                       .next = "etc/surfaces.csv is an example"};
    SurfaceRow               row;
    const Status             status = table_each(&format, path, &row, sizeof row, take_surface, m);
    int                      land = 0;
    double                   sum[optical_channel_count] = {0};
    if (status != STATUS_OK) return status;
    /* the common land: neither water nor the classes that only cover files contain */
    for (int s = SURFACE_NONE + 1; s < SURFACE_WATER; s++, land++)
        for (int c = 0; c < optical_channel_count; c++) sum[c] += m->material[m->surface[s]].rho[c];
    for (int c = 0; c < optical_channel_count; c++) m->ground_rho[c] = (float)(sum[c] / land);
    return STATUS_OK;
}

static Status find_part_material(int *out, const Materials *m, const Model *model, int part, const char *name,
                                 const char *path)
{
    *out = materials_find(m, name);
    if (*out >= 0) return STATUS_OK;
    log_error("materials: a part's material is not in the table: file=%s model=%s part=%s material=%s", path,
              model->name, model->part[part].name, name);
    return STATUS_BAD_VALUE;
}

Status materials_of_model(int *part, int *damaged, const Materials *m, const Model *model, const char *path)
{
    const int burnt = materials_find(m, "burnt");
    for (int p = 0; p < model->part_count; p++) {
        Status status = find_part_material(&part[p], m, model, p, model->part[p].material, path);
        for (int state = 0; state < model_damage_states && status == STATUS_OK; state++) {
            int        *row = &damaged[p * model_damage_states + state];
            const char *name = model->part[p].damage_material[state];
            *row = state == model_damage_states - 1 && burnt >= 0 ? burnt : part[p];
            if (state > 0 && *name) status = find_part_material(row, m, model, p, name, path);
        }
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

static Status resolve_parts(Materials *m, const Catalog *catalog, const char *path)
{
    const int model_count = catalog_model_count(catalog);
    m->part = calloc((size_t)model_count + 1, sizeof *m->part);
    m->damaged = calloc((size_t)model_count + 1, sizeof *m->damaged);
    m->parts = calloc((size_t)model_count + 1, sizeof *m->parts);
    if (!m->part || !m->damaged || !m->parts) return STATUS_NO_MEMORY;
    m->model_count = model_count;
    for (int i = 0; i < model_count; i++) {
        const Model *model = catalog_model(catalog, i);
        m->part[i] = calloc((size_t)model->part_count + 1, sizeof **m->part);
        m->damaged[i] = calloc((size_t)model->part_count + 1, model_damage_states * sizeof **m->damaged);
        if (!m->part[i] || !m->damaged[i]) return STATUS_NO_MEMORY;
        m->parts[i] = model->part_count;
        const Status status = materials_of_model(m->part[i], m->damaged[i], m, model, path);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

Status materials_open(Materials *out, const char *path, const char *surfaces_path, const Catalog *catalog)
{
    Materials m = {0};
    Status    status = read_materials(&m, path);
    if (status == STATUS_OK) status = read_surfaces(&m, surfaces_path);
    if (status == STATUS_OK && catalog) status = resolve_parts(&m, catalog, path);
    if (status != STATUS_OK) {
        materials_close(&m);
        return status;
    }
    *out = m;
    return STATUS_OK;
}

/* ---- plants --------------------------------------------------------------------------------- */

/* What a kind consists of. */
static bool has_organ(PlantKind kind, PlantOrgan organ)
{
    if (kind == PLANT_ROCK) return organ == PLANT_STONE;
    return organ == PLANT_LEAF || (organ == PLANT_BARK && kind < PLANT_STANDING);
}

/* Rows by kind and organ: leaf_KIND, bark_KIND, stone_KIND. */
static Status find_plants(Materials *m, const char *path)
{
    static const char *const organ_name[PLANT_ORGANS] = {"bark", "leaf", "stone"};
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int organ = 0; organ < PLANT_ORGANS; organ++) {
            char name[64];
            snprintf(name, sizeof name, "%s_%s", organ_name[organ], plant_name((PlantKind)kind));
            const int row = materials_find(m, name);
            m->plant[kind][organ] = row > 0 ? row : 0;
            if (row > 0 || !has_organ((PlantKind)kind, (PlantOrgan)organ)) continue;
            log_error("materials: row missing: file=%s name=%s", path, name);
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}

/* paint_COLOUR_wood of the program's table. */
static Status find_marks(Materials *m)
{
    for (int k = PLANT_UNMARKED + 1; k < PLANT_MARKS; k++) {
        char name[64];
        snprintf(name, sizeof name, "paint_%s_wood", plant_mark_name((PlantMark)k));
        m->mark[k] = materials_find(m, name);
        if (m->mark[k] > 0) continue;
        log_error("materials: row missing, of marks on trunks: name=%s; next: a complete copy of etc/materials.csv",
                  name);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static Status take_beneath(void *user, const void *read, const TableRows *rows, int number)
{
    Materials        *m = user;
    const SurfaceRow *row = read;
    const int         material = materials_find(m, row->material);
    if (strcmp(row->material, "same") == 0) return STATUS_OK;
    if (material < 0) return table_rows_refuse(rows, number, "ground", "same, or the name of a material");
    m->surface[row->surface] = material;
    return STATUS_OK;
}

static Status read_ground_beneath(Materials *m, const char *path)
{
    static const TableColumn columns[] = {{"surface", TABLE_NAMED, TABLE_AT(SurfaceRow, surface), SURFACE_NAMED},
                                          {"ground", .type = TABLE_CELL, TABLE_AT(SurfaceRow, material)}};
    static const TableFormat format = {"materials", columns, 2, .next = "etc/woods.csv explains the columns"};
    SurfaceRow               row;
    return table_each(&format, path, &row, sizeof row, take_beneath, m);
}

/* Row `was` of the user's own is row map[was - first] now. */
static void move_row(int *row, const int *map, int first)
{
    if (*row >= first) *row = map[*row - first];
}

/* Puts the user's own rows behind those of plants, or in the place of one of the same name. */
static Status put_own_behind(Materials *m, const Material *own, int own_count, int first)
{
    Material *larger = realloc(m->material, ((size_t)m->count + (size_t)own_count + 1) * sizeof *larger);
    int      *map = malloc(((size_t)own_count + 1) * sizeof *map);
    if (larger) m->material = larger;
    if (!larger || !map) {
        free(map);
        return STATUS_NO_MEMORY;
    }
    m->own_first = m->count;
    for (int i = 0; i < own_count; i++) {
        const int same = materials_find(m, own[i].name);
        map[i] = same >= 0 ? same : m->count++;
        m->material[map[i]] = own[i];
    }
    for (int s = 0; s < SURFACE_COUNT; s++) move_row(&m->surface[s], map, first);
    for (int i = 0; i < m->model_count; i++) {
        for (int p = 0; p < m->parts[i]; p++) move_row(&m->part[i][p], map, first);
        for (int p = 0; p < m->parts[i] * model_damage_states; p++) move_row(&m->damaged[i][p], map, first);
    }
    free(map);
    return STATUS_OK;
}

/* Plants between the program's rows and the user's own: no row of the program's moves for the user's. */
static Status read_plants(Materials *m, const char *path)
{
    const int first = m->own_first, own_count = m->count - first;
    Material *own = malloc(((size_t)own_count + 1) * sizeof *own);
    if (!own) return STATUS_NO_MEMORY;
    memcpy(own, m->material + first, (size_t)own_count * sizeof *own);
    m->count = first;
    Status status = read_rows(m, path, ROWS_PLANTS);
    if (status == STATUS_OK && m->count > materials_limit - own_count) {
        log_error("materials: too many rows: file=%s rows=%d limit=%d", path, m->count + own_count,
                  (int)materials_limit);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = put_own_behind(m, own, own_count, first);
    free(own);
    return status;
}

Status materials_add_plants(Materials *m, const char *path, const char *ground_path)
{
    Status status = read_plants(m, path);
    if (status == STATUS_OK) status = find_plants(m, path);
    if (status == STATUS_OK) status = find_marks(m);
    return status == STATUS_OK ? read_ground_beneath(m, ground_path) : status;
}

bool materials_let_through(const Materials *m)
{
    for (int i = 0; i < m->count; i++)
        if (m->material[i].tau[optical_channel_nir] > 0) return true;
    return false;
}

void materials_close(Materials *materials)
{
    if (!materials) return;
    for (int i = 0; i < materials->model_count; i++) {
        if (materials->part) free(materials->part[i]);
        if (materials->damaged) free(materials->damaged[i]);
    }
    free(materials->part);
    free(materials->damaged);
    free(materials->parts);
    free(materials->material);
    *materials = (Materials){0};
}
