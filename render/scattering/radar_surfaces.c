/* render/scattering/radar_surfaces.c: complex reflection of metal, half spaces, slabs and coatings; reads
 * etc/radar/materials.csv. */
#include "render/scattering/radar_surfaces.h"

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

static const char *const column_names[] = {"name",   "kind",     "f_ghz",    "eps_re",
                                           "eps_im", "thick_mm", "rough_mm", "source"};
enum {
    column_name,
    column_kind,
    column_f,
    column_e1,
    column_e2,
    column_thick,
    column_rough,
    column_source,
    column_count
};

static const char *const kind_names[RADAR_SURFACE_KINDS] = {"metal", "half_space", "slab", "coated"};

int radar_materials_find(const RadarMaterials *m, const char *name)
{
    for (int i = 0; i < m->count; i++)
        if (strcmp(m->material[i].name, name) == 0) return i;
    return -1;
}

static Status refuse(const Table *table, int row, const char *what, const char *value)
{
    log_error("radar materials: %s: file=%s line=%d value=%s", what, table->path, table->line[row + 1], value);
    return STATUS_BAD_VALUE;
}

static Status read_kind(RadarMaterial *material, const Table *table, int row, const int column[])
{
    const char *kind = table_text(table, row, column[column_kind]);
    double      thick_mm, rough_mm;
    int         k = 0;
    while (k < RADAR_SURFACE_KINDS && strcmp(kind_names[k], kind) != 0) k++;
    if (k == RADAR_SURFACE_KINDS) return refuse(table, row, "kind is none of metal, half_space, slab, coated", kind);
    if (table_number(&thick_mm, table, row, column[column_thick], 0, 1000) != STATUS_OK ||
        table_number(&rough_mm, table, row, column[column_rough], 0, 1000) != STATUS_OK)
        return STATUS_BAD_VALUE;
    if ((thick_mm > 0) != (k == RADAR_SLAB || k == RADAR_COATED))
        return refuse(table, row, "thick_mm must be above 0 for slab and coated, and 0 for others",
                      table_text(table, row, column[column_thick]));
    material->kind = (RadarSurfaceKind)k;
    material->thick_m = thick_mm / 1000;
    material->rough_m = rough_mm / 1000;
    return STATUS_OK;
}

/* Reads a row: it begins a new material, or adds a frequency to the last one. */
static Status read_row(RadarMaterials *m, const Table *table, int row, const int column[])
{
    const char   *name = table_text(table, row, column[column_name]);
    const int     known = radar_materials_find(m, name);
    RadarMaterial next = {0};
    double        f_ghz, e1, e2;
    if (!*name || strlen(name) >= sizeof next.name) return refuse(table, row, "name is empty or longer than 31", name);
    if (!*table_text(table, row, column[column_source])) return refuse(table, row, "a row needs its source", name);
    if (known >= 0 && known != m->count - 1) return refuse(table, row, "rows of a material must be together", name);
    if (known >= 0) next = m->material[known];
    else snprintf(next.name, sizeof next.name, "%s", name);
    const RadarMaterial before = next;
    if (read_kind(&next, table, row, column) != STATUS_OK) return STATUS_BAD_VALUE;
    if (table_number(&f_ghz, table, row, column[column_f], 0.1, 1000) != STATUS_OK ||
        table_number(&e1, table, row, column[column_e1], 1, 1000) != STATUS_OK ||
        table_number(&e2, table, row, column[column_e2], 0, 1e6) != STATUS_OK)
        return STATUS_BAD_VALUE;
    if (known >= 0) {
        if (next.kind != before.kind || next.thick_m != before.thick_m || next.rough_m != before.rough_m)
            return refuse(table, row, "kind, thick_mm and rough_mm must be those of the material's first row", name);
        if (next.points == radar_material_points) return refuse(table, row, "more than 8 frequencies", name);
        if (!(f_ghz * 1e9 > next.frequency_hz[next.points - 1]))
            return refuse(table, row, "f_ghz must rise from row to row", name);
    }
    next.frequency_hz[next.points] = f_ghz * 1e9;
    next.e1[next.points] = e1;
    next.e2[next.points++] = e2;
    m->material[known >= 0 ? known : m->count++] = next;
    return STATUS_OK;
}

/* Adds the materials that have no row of their own, by the defaults for metal and for others; and `metal`, for shapes.
 */
static Status add_defaults(RadarMaterials *m, const Materials *optical, const char *path)
{
    const int own = radar_materials_find(m, "other_default"), metal = radar_materials_find(m, "metal_default");
    if (own < 0 || metal < 0) {
        log_error("radar materials: row missing: file=%s name=%s", path, own < 0 ? "other_default" : "metal_default");
        return STATUS_BAD_VALUE;
    }
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
    Table          table = {0};
    RadarMaterials m = {0};
    int            column[column_count];
    Status         status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    if (!table_columns(column, &table, column_names, column_count, "radar materials")) {
        table_close(&table);
        return STATUS_BAD_VALUE;
    }
    m.material = calloc((size_t)table.rows + (size_t)optical->count + 1, sizeof *m.material);
    if (!m.material) status = STATUS_NO_MEMORY;
    for (int row = 0; row < table.rows && status == STATUS_OK; row++) status = read_row(&m, &table, row, column);
    if (status == STATUS_OK) status = add_defaults(&m, optical, path);
    table_close(&table);
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
