/* render/heat/ground_kinds.c: see ground_kinds.h. */
#include "render/heat/ground_kinds.h"

const char *ground_kind_name(int kind)
{
    return kind == ground_forest_floor ? "forest_floor" : kind == ground_burnt ? "burnt" : surface_name((SurfaceClass)kind);
}

int ground_kind_find(const char *name)
{
    for (int k = 1; k < ground_kinds; k++)
        if (strcmp(ground_kind_name(k), name) == 0) return k;
    return -1;
}

static const struct {
    const char *name;
    size_t      offset;
    double      low, high;
} column[] = {
    {"top_m", offsetof(GroundKind, layer[0].thickness_m), 0, 10},
    {"top_w_mk", offsetof(GroundKind, layer[0].conductivity_w_mk), 0, 1e4},
    {"top_j_m3k", offsetof(GroundKind, layer[0].capacity_j_m3k), 0, 1e7},
    {"under_m", offsetof(GroundKind, layer[1].thickness_m), 0, 10},
    {"under_w_mk", offsetof(GroundKind, layer[1].conductivity_w_mk), 0, 1e4},
    {"under_j_m3k", offsetof(GroundKind, layer[1].capacity_j_m3k), 0, 1e7},
    {"porosity", offsetof(GroundKind, porosity), 0, 0.95},
    {"quartz", offsetof(GroundKind, quartz), 0, 1},
    {"saturation", offsetof(GroundKind, saturation), 0, 1},
    {"rock_w_mk", offsetof(GroundKind, rock_w_mk), 0, 100},
    {"rock_j_m3k", offsetof(GroundKind, rock_j_m3k), 0, 1e7},
    {"roughness_m", offsetof(GroundKind, roughness_m), 1e-5, 3},
    {"leaf_s_m", offsetof(GroundKind, resistance_s_m), 0, 5000},
};
enum { columns = sizeof column / sizeof *column };

static Status read_vapour(GroundKind *out, const Table *table, int row, int at)
{
    static const char *const name[] = {"dry", "soil", "leaves", "water"};
    for (int v = 0; v < 4; v++)
        if (strcmp(table_text(table, row, at), name[v]) == 0) {
            out->vapour = (GroundVapour)v;
            return STATUS_OK;
        }
    log_error("ground heat: vapour is dry, soil, leaves or water: file=%s line=%d vapour=%s", table->path,
              table->line[row + 1], table_text(table, row, at));
    return STATUS_BAD_VALUE;
}

/* Layers that are there, and none of them without its figures. */
static bool layers_fit(GroundKind *kind)
{
    kind->layers = 0;
    for (int l = 0; l < 2; l++) {
        const ColumnLayer *at = &kind->layer[l];
        if (at->thickness_m == 0) return l == 1 || kind->layer[1].thickness_m == 0;
        if (!(at->conductivity_w_mk > 0) || !(at->capacity_j_m3k > 0)) return false;
        kind->layers++;
    }
    return true;
}

static Status read_row(GroundKinds *out, const Table *table, int row, const int at[], const Materials *materials)
{
    const char *name = table_text(table, row, at[columns]), *sun = table_text(table, row, at[columns + 2]);
    const int   k = ground_kind_find(name);
    if (k < 0 || *out->kind[k].name) {
        log_error("ground heat: %s: file=%s line=%d surface=%s", k < 0 ? "no such surface" : "surface repeated",
                  table->path, table->line[row + 1], name);
        return STATUS_BAD_VALUE;
    }
    GroundKind     *kind = &out->kind[k];
    const Material *m = &materials->material[materials->surface[k < SURFACE_COUNT ? k : SURFACE_BARE_SOIL]];
    for (int c = 0; c < columns; c++)
        if (table_number((double *)((char *)kind + column[c].offset), table, row, at[c], column[c].low, column[c].high) != STATUS_OK)
            return STATUS_BAD_VALUE;
    if (read_vapour(kind, table, row, at[columns + 1]) != STATUS_OK) return STATUS_BAD_VALUE;
    kind->absorptance = (double)m->solar_absorptance;
    kind->emissivity  = 1 - (double)m->rho_lwir;
    kind->melts_k     = k == SURFACE_SNOW ? 273.15 : INFINITY;
    if (*sun && table_number(&kind->absorptance, table, row, at[columns + 2], 0, 1) != STATUS_OK) return STATUS_BAD_VALUE;
    if (!layers_fit(kind) || (kind->porosity == 0 && !(kind->rock_w_mk > 0 && kind->rock_j_m3k > 0))) {
        log_error("ground heat: a layer needs conductivity and capacity, and ground without pores rock_w_mk and "
                  "rock_j_m3k: file=%s line=%d", table->path, table->line[row + 1]);
        return STATUS_BAD_VALUE;
    }
    snprintf(kind->name, sizeof kind->name, "%s", name);
    return STATUS_OK;
}

Status ground_kinds_open(GroundKinds *out, const char *path, const Materials *materials)
{
    Table       table = {0};
    int         at[columns + 3];
    const char *const text[] = {"surface", "vapour", "absorptance"};
    *out = (GroundKinds){0};
    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    for (int c = 0; c < columns + 3; c++) {
        const char *name = c < columns ? column[c].name : text[c - columns];
        at[c] = table_column(&table, name);
        if (at[c] >= 0) continue;
        log_error("ground heat: column missing: file=%s column=%s", path, name);
        status = STATUS_BAD_VALUE;
    }
    for (int row = 0; row < table.rows && status == STATUS_OK; row++) status = read_row(out, &table, row, at, materials);
    table_close(&table);
    for (int k = 1; k < ground_kinds && status == STATUS_OK; k++)
        if (!*out->kind[k].name) {
            log_error("ground heat: no row: file=%s surface=%s", path, ground_kind_name(k));
            status = STATUS_BAD_VALUE;
        }
    out->kind[SURFACE_NONE] = out->kind[SURFACE_BARE_SOIL];
    return status;
}
