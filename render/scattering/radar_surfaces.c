/* render/scattering/radar_surfaces.c: complex reflection of metal, half spaces, slabs and coatings; reads
 * etc/radar/materials.csv. */
#include "render/scattering/radar_surfaces.h"

#include "pitviper_table.h"

#include <stdlib.h>

/* Component across the surface of the wave vector inside, over k; its sign makes the wave decay inwards. */
static double complex inward(double complex eps, double cosine)
{
    const double complex q = csqrt(eps - (1 - cosine * cosine));
    return cimag(q) > 0 ? -q : q;
}

void fresnel_half_space(double complex *te, double complex *tm, double complex eps, double cosine)
{
    const double complex q = inward(eps, cosine);
    *te = (cosine - q) / (cosine + q);
    *tm = (eps * cosine - q) / (eps * cosine + q);
}

void fresnel_slab(double complex *te, double complex *tm, double complex *tte, double complex *ttm,
                  const RadarSurface *surface, double k, double cosine)
{
    const double complex p = cexp(-I * k * surface->thick_m * inward(surface->eps, cosine));
    double complex       g[2], *out[2] = {te, tm}, *through[2] = {tte, ttm};
    fresnel_half_space(&g[0], &g[1], surface->eps, cosine);
    for (int i = 0; i < 2; i++) {
        const double complex under = 1 - g[i] * g[i] * p * p;
        *out[i] = g[i] * (1 - p * p) / under;
        if (through[i]) *through[i] = (1 - g[i] * g[i]) * p / under;
    }
}

/* The wall behind returns -1 (TE) and +1 (TM). */
void fresnel_coated(double complex *te, double complex *tm, double complex eps, double thick_m, double k, double cosine)
{
    const double complex p = cexp(-2 * I * k * thick_m * inward(eps, cosine));
    double complex       g[2];
    fresnel_half_space(&g[0], &g[1], eps, cosine);
    *te = (g[0] - p) / (1 - g[0] * p);
    *tm = (g[1] + p) / (1 + g[1] * p);
}

double fresnel_rough(double rough_m, double k, double cosine)
{
    const double phase = k * rough_m * cosine;
    return exp(-2 * phase * phase);
}

void fresnel_surface(double complex *te, double complex *tm, const RadarSurface *surface, double k, double cosine)
{
    switch (surface->kind) {
    case RADAR_HALF_SPACE:
        fresnel_half_space(te, tm, surface->eps, cosine);
        break;
    case RADAR_SLAB:
        fresnel_slab(te, tm, NULL, NULL, surface, k, cosine);
        break;
    case RADAR_COATED:
        fresnel_coated(te, tm, surface->eps, surface->thick_m, k, cosine);
        break;
    default:
        *te = -1, *tm = 1;
        break;
    }
    const double rough = fresnel_rough(surface->rough_m, k, cosine);
    *te *= rough, *tm *= rough;
}

/* ---- materials ---------------------------------------------------------------------------------- */

typedef struct Row {
    const char *name, *source;
    int         kind;
    double      frequency_hz, e1, e2, thick_mm, rough_mm;
} Row;

static const TableColumn columns[] = {
    {"name", .type = TABLE_CELL, TABLE_AT(Row, name)},
    {"source", .type = TABLE_CELL, TABLE_AT(Row, source)},
    {"kind", TABLE_CHOICE, TABLE_AT(Row, kind), .choices = "metal, half_space, slab, coated"},
    {"thick_mm", TABLE_DOUBLE, TABLE_AT(Row, thick_mm), .low = 0, .high = 1000},
    {"rough_mm", TABLE_DOUBLE, TABLE_AT(Row, rough_mm), .low = 0, .high = 1000},
    {"f_ghz", TABLE_DOUBLE, TABLE_AT(Row, frequency_hz), .low = 0.1, .high = 1000, .unit = 1e9},
    {"eps_re", TABLE_DOUBLE, TABLE_AT(Row, e1), .low = 1, .high = 1000},
    {"eps_im", TABLE_DOUBLE, TABLE_AT(Row, e2), .low = 0, .high = 1e6},
};
static const TableFormat format = {"radar materials", columns, sizeof columns / sizeof *columns,
                                   .next = "etc/radar/materials.csv explains the columns"};

int radar_materials_find(const RadarMaterials *m, const char *name)
{
    for (int i = 0; i < m->count; i++)
        if (strcmp(m->material[i].name, name) == 0) return i;
    return -1;
}

/* Takes a row: it begins a new material, or adds a frequency to the last one. */
static Status take_row(RadarMaterials *m, const Row *row, const TableRows *rows, int number)
{
    const int     known = radar_materials_find(m, row->name);
    const double  thick_m = row->thick_mm / 1000, rough_m = row->rough_mm / 1000;
    RadarMaterial next = {.kind = (RadarSurfaceKind)row->kind, .thick_m = thick_m, .rough_m = rough_m};
    if (!*row->name || strlen(row->name) >= sizeof next.name)
        return table_rows_refuse(rows, number, NULL, "name is empty or longer than 31");
    if (!*row->source) return table_rows_refuse(rows, number, NULL, "a row needs its source");
    if (known >= 0 && known != m->count - 1)
        return table_rows_refuse(rows, number, NULL, "rows of a material must be together: %s", row->name);
    if ((row->thick_mm > 0) != (row->kind == RADAR_SLAB || row->kind == RADAR_COATED))
        return table_rows_refuse(rows, number, "thick_mm", "above 0, for slab and coated, and 0 for others");
    if (known < 0) {
        snprintf(next.name, sizeof next.name, "%s", row->name);
    } else {
        next = m->material[known];
        if ((int)next.kind != row->kind || next.thick_m != thick_m || next.rough_m != rough_m)
            return table_rows_refuse(rows, number, NULL,
                                     "kind, thick_mm and rough_mm must be those of the material's first row");
        if (next.points == radar_material_points)
            return table_rows_refuse(rows, number, NULL, "more than 8 frequencies");
        if (!(row->frequency_hz > next.frequency_hz[next.points - 1]))
            return table_rows_refuse(rows, number, NULL, "f_ghz must rise from row to row");
    }
    next.frequency_hz[next.points] = row->frequency_hz;
    next.e1[next.points] = row->e1;
    next.e2[next.points++] = row->e2;
    m->material[known >= 0 ? known : m->count++] = next;
    return STATUS_OK;
}

/* Adds the materials that have no row of their own, by the defaults for metal and for others; and `metal`, for shapes.
 */
static Status add_defaults(RadarMaterials *m, const Materials *optical, const TableRows *rows)
{
    const int own = radar_materials_find(m, "other_default"), metal = radar_materials_find(m, "metal_default");
    if (own < 0 || metal < 0) return table_rows_lack(rows, "no row of %s", own < 0 ? "other_default" : "metal_default");
    for (int i = 0; i < optical->count; i++) {
        const Material *o = &optical->material[i];
        if (radar_materials_find(m, o->name) >= 0) continue;
        RadarMaterial *added = &m->material[m->count++];
        *added = m->material[o->metal > 0.5f ? metal : own];
        snprintf(added->name, sizeof added->name, "%s", o->name);
    }
    return STATUS_OK;
}

Status radar_materials_open(RadarMaterials *out, const char *path, const Materials *optical)
{
    TableRows      rows;
    RadarMaterials m = {0};
    Status         status = table_rows_open(&rows, &format, path);
    if (status != STATUS_OK) return status;
    m.material = calloc((size_t)rows.table.rows + (size_t)optical->count + 1, sizeof *m.material);
    if (!m.material) status = STATUS_NO_MEMORY;
    for (int i = 0; i < rows.table.rows && status == STATUS_OK; i++) {
        Row row;
        status = table_rows_get(&row, &rows, i);
        if (status == STATUS_OK) status = take_row(&m, &row, &rows, i);
    }
    if (status == STATUS_OK) status = add_defaults(&m, optical, &rows);
    table_rows_close(&rows);
    if (status == STATUS_OK) *out = m;
    else radar_materials_close(&m);
    return status;
}

Status radar_materials_load(RadarMaterials *out)
{
    char      radar[512], materials[512], surfaces[512];
    Materials optical = {0};
    if (!etc_path(radar, sizeof radar, "radar/materials.csv") ||
        !etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv")) {
        log_error("radar materials: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    Status status = materials_open(&optical, materials, surfaces, NULL);
    if (status != STATUS_OK) return status;
    status = radar_materials_open(out, radar, &optical);
    materials_close(&optical);
    return status;
}

void radar_materials_close(RadarMaterials *m)
{
    free(m->material);
    *m = (RadarMaterials){0};
}

void radar_surface(RadarSurface *out, const RadarMaterial *material, double frequency_hz)
{
    int p = 0;
    while (p < material->points - 1 && material->frequency_hz[p + 1] < frequency_hz) p++;
    double share = 0, e1 = material->e1[p], e2 = material->e2[p];
    if (p < material->points - 1) {
        share = clamp(log(frequency_hz / material->frequency_hz[p]) /
                          log(material->frequency_hz[p + 1] / material->frequency_hz[p]),
                      0, 1);
        e1 += share * (material->e1[p + 1] - e1);
        e2 += share * (material->e2[p + 1] - e2);
    }
    *out = (RadarSurface){material->kind, CMPLX(e1, -e2), material->thick_m, material->rough_m};
}
