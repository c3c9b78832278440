/* render/materials/materials.c: reads the material tables and resolves names to rows once, so that no strings are
 * compared later. */
#include "render/materials/materials.h"

#include <stdio.h>
#include <stdlib.h>

enum { materials_limit = 60000 }; /* a hit carries its row in 16 bits */

int materials_find(const Materials *materials, const char *name)
{
    for (int i = 0; i < materials->count; i++)
        if (strcmp(materials->material[i].name, name) == 0) return i;
    return -1;
}

/* Every number column of a material, its member and its valid range. Without a name: rho_<name> of the channel of
 * that index. */
static const struct {
    const char  *name;
    size_t       offset;
    double       low, high;
    ChannelPlace place;
} number_columns[] = {
    {NULL, offsetof(Material, rho[optical_channel_b]), 0, 1, SPECTRAL_B},
    {NULL, offsetof(Material, rho[optical_channel_g]), 0, 1, SPECTRAL_G},
    {NULL, offsetof(Material, rho[optical_channel_r]), 0, 1, SPECTRAL_R},
    {NULL, offsetof(Material, rho[optical_channel_pan]), 0, 1, SPECTRAL_PAN},
    {NULL, offsetof(Material, rho[optical_channel_nir]), 0, 1, SPECTRAL_NIR},
    {NULL, offsetof(Material, rho_mwir), 0, 1, SPECTRAL_MWIR},
    {NULL, offsetof(Material, rho_lwir), 0, 1, SPECTRAL_LWIR},
    {"solar_absorptance", offsetof(Material, solar_absorptance), 0, 1, 0},
    {"gloss", offsetof(Material, gloss), 0, 1, 0},
    {"roughness_rad", offsetof(Material, roughness), 0, 1.5, 0},
    {"metal", offsetof(Material, metal), 0, 1, 0},
    {"radar_gamma", offsetof(Material, radar_gamma), 0, 100, 0},
    /* from still air and aerogel to copper, tungsten and hydrogen-rich liquids, with margin */
    {"conductivity_w_mk", offsetof(Material, conductivity_w_mk), 0.01, 1000, 0},
    {"density_kg_m3", offsetof(Material, density_kg_m3), 1, 25000, 0},
    {"heat_capacity_j_kgk", offsetof(Material, heat_capacity_j_kgk), 50, 10000, 0},
};
enum { number_column_count = sizeof number_columns / sizeof *number_columns };

/* Transmittances: of plants only. Named tau_<name>. */
static const struct {
    size_t       offset, rho;
    ChannelPlace place;
} tau_columns[] = {
    {offsetof(Material, tau[optical_channel_b]), offsetof(Material, rho[optical_channel_b]), SPECTRAL_B},
    {offsetof(Material, tau[optical_channel_g]), offsetof(Material, rho[optical_channel_g]), SPECTRAL_G},
    {offsetof(Material, tau[optical_channel_r]), offsetof(Material, rho[optical_channel_r]), SPECTRAL_R},
    {offsetof(Material, tau[optical_channel_pan]), offsetof(Material, rho[optical_channel_pan]), SPECTRAL_PAN},
    {offsetof(Material, tau[optical_channel_nir]), offsetof(Material, rho[optical_channel_nir]), SPECTRAL_NIR},
    {offsetof(Material, tau_mwir), offsetof(Material, rho_mwir), SPECTRAL_MWIR},
    {offsetof(Material, tau_lwir), offsetof(Material, rho_lwir), SPECTRAL_LWIR},
};
enum { tau_column_count = sizeof tau_columns / sizeof *tau_columns };

/* A row's transmittances; with its reflectance each at most 1. */
static Status read_tau(Material *material, const Table *table, int row)
{
    for (int i = 0; i < tau_column_count; i++) {
        char         wanted[32];
        double       value;
        const float *rho = (const float *)((const char *)material + tau_columns[i].rho);
        snprintf(wanted, sizeof wanted, "tau_%s", channel_in(tau_columns[i].place)->name);
        const int column = table_column(table, wanted);
        if (column < 0) {
            log_error("materials: column missing: file=%s column=%s", table->path, wanted);
            return STATUS_BAD_VALUE;
        }
        const Status got = table_number(&value, table, row, column, 0, 1);
        if (got != STATUS_OK) return got;
        if (value + (double)*rho > 1) {
            log_error("materials: reflectance and transmittance exceed 1 together: file=%s line=%d column=%s",
                      table->path, table->line[row + 1], wanted);
            return STATUS_BAD_VALUE;
        }
        if (value > 0 && (!(*rho > 0) || material->gloss > 0)) {
            log_error("materials: what lets light through reflects some as well, and has no gloss: file=%s line=%d "
                      "column=%s",
                      table->path, table->line[row + 1], wanted);
            return STATUS_BAD_VALUE;
        }
        *(float *)((char *)material + tau_columns[i].offset) = (float)value;
    }
    return STATUS_OK;
}

/* Whose rows a file holds. A row of the program or of plants whose name an earlier file has is left out; a row of the
 * user's replaces that row in its place. */
typedef enum RowsOf { ROWS_PROGRAM, ROWS_PLANTS, ROWS_OWN } RowsOf;

static bool name_repeated(const Table *table, int row, int column)
{
    for (int earlier = 0; earlier < row; earlier++)
        if (strcmp(table_text(table, earlier, column), table_text(table, row, column)) == 0) return true;
    return false;
}

/* Appends the rows of one file to those present. */
static Status read_rows(Materials *m, const char *path, RowsOf of)
{
    Table     table = {0};
    const int before = m->count;
    Status    status = channels_load();
    if (status == STATUS_OK) status = table_open(&table, path);
    if (status != STATUS_OK) return status;

    status = STATUS_BAD_VALUE;
    const int name_column = table_column(&table, "name");
    int       column[number_column_count];
    for (int i = -1; i < number_column_count; i++) {
        char wanted[32] = "name";
        if (i >= 0 && number_columns[i].name) snprintf(wanted, sizeof wanted, "%s", number_columns[i].name);
        else if (i >= 0) snprintf(wanted, sizeof wanted, "rho_%s", channel_in(number_columns[i].place)->name);
        if (i >= 0) column[i] = table_column(&table, wanted);
        if ((i < 0 ? name_column : column[i]) >= 0) continue;
        log_error("materials: column missing: file=%s line=%d column=%s", path, table.line[0], wanted);
        goto done;
    }
    char first_tau[32];
    snprintf(first_tau, sizeof first_tau, "tau_%s", channel_in(tau_columns[0].place)->name);
    const bool lets_through = of == ROWS_PLANTS || (of == ROWS_OWN && table_column(&table, first_tau) >= 0);
    if (table.rows > materials_limit - before) {
        log_error("materials: too many rows: file=%s rows=%d limit=%d", path, table.rows, (int)materials_limit);
        goto done;
    }
    Material *larger = realloc(m->material, ((size_t)before + (size_t)table.rows + 1) * sizeof *m->material);
    if (!larger) {
        status = STATUS_NO_MEMORY;
        goto done;
    }
    m->material = larger;
    for (int row = 0; row < table.rows; row++) {
        const char  *name = table_text(&table, row, name_column);
        const size_t length = strlen(name);
        const int    same = materials_find(m, name);
        if (length == 0 || length >= sizeof m->material->name || same == 0 || name_repeated(&table, row, name_column)) {
            log_error("materials: name empty, repeated or longer than %zu: file=%s line=%d name=%s",
                      sizeof m->material->name - 1, path, table.line[row + 1], name);
            goto done;
        }
        Material material = {0};
        memcpy(material.name, name, length + 1);
        for (int i = 0; i < number_column_count; i++) {
            double       value;
            const Status got =
                table_number(&value, &table, row, column[i], number_columns[i].low, number_columns[i].high);
            if (got != STATUS_OK) goto done;
            *(float *)((char *)&material + number_columns[i].offset) = (float)value;
        }
        if (lets_through && read_tau(&material, &table, row) != STATUS_OK) goto done;
        if (same < 0) m->material[m->count++] = material;
        else if (of == ROWS_OWN) m->material[same] = material;
    }
    status = STATUS_OK;
done:
    table_close(&table);
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

/* Row of the class of this name in a file of one row a class; logged when unknown. */
static Status find_surface(SurfaceClass *out, const Table *table, int row, int column)
{
    const char *name = table_text(table, row, column);
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++)
        if (strcmp(surface_name((SurfaceClass)s), name) == 0) {
            *out = (SurfaceClass)s;
            return STATUS_OK;
        }
    log_error("materials: no such surface class: file=%s line=%d surface=%s", table->path, table->line[row + 1], name);
    return STATUS_BAD_VALUE;
}

/* Each class exactly once. */
static Status check_materials_used(const bool seen[SURFACE_COUNT], const char *path)
{
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++)
        if (!seen[s]) {
            log_error("materials: surface class missing: file=%s surface=%s", path, surface_name((SurfaceClass)s));
            return STATUS_BAD_VALUE;
        }
    return STATUS_OK;
}

static Status read_surfaces(Materials *m, const char *path)
{
    Table  table = {0};
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;

    status = STATUS_BAD_VALUE;
    bool      seen[SURFACE_COUNT] = {0};
    const int surface_column = table_column(&table, "surface"), material_column = table_column(&table, "material");
    if (surface_column < 0 || material_column < 0) {
        log_error("materials: column missing: file=%s column=%s", path, surface_column < 0 ? "surface" : "material");
        goto done;
    }
    for (int row = 0; row < table.rows; row++) {
        const char *name = table_text(&table, row, material_column);
        if (strcmp(table_text(&table, row, surface_column), surface_name(SURFACE_NONE)) == 0) continue; /* is "none" */
        SurfaceClass surface;
        if (find_surface(&surface, &table, row, surface_column) != STATUS_OK) goto done;
        const int material = materials_find(m, name);
        if (material < 0 || seen[surface]) {
            log_error("materials: surface repeated or its material unknown: file=%s line=%d surface=%s material=%s",
                      path, table.line[row + 1], surface_name(surface), name);
            goto done;
        }
        seen[surface] = true;
        m->surface[surface] = material;
    }
    status = check_materials_used(seen, path);
    if (status != STATUS_OK) goto done;

    int    land = 0;
    double sum[optical_channel_count] = {0};
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT; s++) {
        if (s >= SURFACE_WATER)
            continue; /* the common land: neither water nor the classes that only cover files
                       * contain */
        for (int c = 0; c < optical_channel_count; c++) sum[c] += m->material[m->surface[s]].rho[c];
        land++;
    }
    for (int c = 0; c < optical_channel_count; c++) m->ground_rho[c] = (float)(sum[c] / land);
done:
    table_close(&table);
    return status;
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

static Status resolve_parts(Materials *m, const Catalog *catalog, const char *path)
{
    const int model_count = catalog_model_count(catalog), burnt = materials_find(m, "burnt");
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
        for (int p = 0; p < model->part_count; p++) {
            Status status = find_part_material(&m->part[i][p], m, model, p, model->part[p].material, path);
            for (int state = 0; state < model_damage_states && status == STATUS_OK; state++) {
                int        *row = &m->damaged[i][p * model_damage_states + state];
                const char *name = model->part[p].damage_material[state];
                *row = state == model_damage_states - 1 && burnt >= 0 ? burnt : m->part[i][p];
                if (state > 0 && *name) status = find_part_material(row, m, model, p, name, path);
            }
            if (status != STATUS_OK) return status;
        }
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

static Status read_ground_beneath(Materials *m, const char *path)
{
    Table  table = {0};
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    const int surface_column = table_column(&table, "surface"), ground_column = table_column(&table, "ground");
    if (surface_column < 0 || ground_column < 0) {
        log_error("materials: column missing: file=%s columns=surface,ground", path);
        status = STATUS_BAD_VALUE;
    }
    for (int row = 0; row < table.rows && status == STATUS_OK; row++) {
        SurfaceClass surface;
        const char  *name = table_text(&table, row, ground_column);
        status = find_surface(&surface, &table, row, surface_column);
        if (status != STATUS_OK || strcmp(name, "same") == 0) continue;
        const int material = materials_find(m, name);
        if (material < 0) {
            log_error("materials: no such material: file=%s line=%d ground=%s", path, table.line[row + 1], name);
            status = STATUS_BAD_VALUE;
        } else {
            m->surface[surface] = material;
        }
    }
    table_close(&table);
    return status;
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
