/* render/scattering/built/facade_table.c: reads etc/radar/facades.csv; what a built surface scatters, and its bumps. */
#include "render/scattering/built/facade_table.h"

#include "pitviper_table.h"

enum { stream_bumps = 0x3e000000 };

typedef struct Row {
    char   material[32];
    double ku, ka, w, hv_db, uneven_m, uneven_length_m;
} Row;

static const TableColumn columns[] = {
    {"material", TABLE_NAME, TABLE_AT(Row, material), .absent = TABLE_REQUIRED},
    {"scattered_ku", TABLE_DOUBLE, TABLE_AT(Row, ku), .low = 0, .high = 1},
    {"scattered_ka", TABLE_DOUBLE, TABLE_AT(Row, ka), .low = 0, .high = 1},
    {"scattered_w", TABLE_DOUBLE, TABLE_AT(Row, w), .low = 0, .high = 1},
    {"hv_vv_db", TABLE_DOUBLE, TABLE_AT(Row, hv_db), .low = -60, .high = 10},
    {"uneven_mm", TABLE_DOUBLE, TABLE_AT(Row, uneven_m), .low = 0, .high = 1000, .unit = 1e-3},
    {"uneven_m", TABLE_DOUBLE, TABLE_AT(Row, uneven_length_m), .low = 0.05, .high = 100},
};
static const TableFormat format = {"radar facades",
                                   columns,
                                   sizeof columns / sizeof *columns,
                                   "etc/radar/facades.csv explains the columns",
                                   1,
                                   .most_rows = facade_rows_most};

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    const Row   *row = read;
    FacadeTable *table = user;
    if (table->count > 0 && strcmp(table->row[table->count - 1].material, "other") == 0)
        return table_rows_refuse(rows, number, NULL, "no row may follow `other`, which fits any material");
    FacadeRow *to = &table->row[table->count++];
    *to = (FacadeRow){.scattered = {row->ku, row->ka, row->w},
                      .hv = pow(10, row->hv_db / 10),
                      .uneven_m = row->uneven_m,
                      .uneven_length_m = row->uneven_length_m};
    memcpy(to->material, row->material, sizeof to->material);
    return STATUS_OK;
}

Status facade_table_open(FacadeTable *out, const char *path)
{
    FacadeTable  table = {0};
    Row          row;
    const Status status = table_each(&format, path, &row, sizeof row, take_row, &table);
    if (status != STATUS_OK) return status;
    if (strcmp(table.row[table.count - 1].material, "other") != 0) {
        log_error("%s: %s: the last row must be `other`; %s", format.module, path, format.next);
        return STATUS_BAD_VALUE;
    }
    *out = table;
    return STATUS_OK;
}

const FacadeRow *facade_row(const FacadeTable *table, const char *material)
{
    int i = 0;
    while (i < table->count - 1 && strncmp(material, table->row[i].material, strlen(table->row[i].material)) != 0) i++;
    return &table->row[i];
}

double facade_diffuse_share(const FacadeRow *row, ClutterBand band, const RadarSurface *surface, double k,
                            double cosine)
{
    const double rough = fresnel_rough(surface->rough_m, k, cosine), s = row->scattered[band];
    return 1 - (1 - s * s) * rough * rough;
}

double facade_sigma0(const FacadeRow *row, ClutterBand band, const RadarSurface *surface, double k, double cosine)
{
    if (!(cosine > 0)) return 0;
    RadarSurface   smooth = *surface;
    double complex te, tm;
    smooth.rough_m = 0;
    fresnel_surface(&te, &tm, &smooth, k, fmin(cosine, 1));
    const double reflected = 0.5 * (scatter_power(te) + scatter_power(tm));
    return 4 * facade_diffuse_share(row, band, surface, k, cosine) * reflected * cosine * cosine;
}

double facade_height(const FacadeRow *row, uint64_t seed, double s_m, double t_m)
{
    if (!(row->uneven_m > 0)) return 0;
    const double s = s_m / row->uneven_length_m, t = t_m / row->uneven_length_m, i = floor(s), j = floor(t);
    double       sum = 0, squares = 0;
    for (int n = 0; n < 4; n++) {
        const double a = i + (n & 1), b = j + (n >> 1), x = fabs(s - a), y = fabs(t - b);
        /* smooth steps, so that slopes are continuous where cells of nodes meet */
        const double   weight = (1 - x * x * (3 - 2 * x)) * (1 - y * y * (3 - 2 * y));
        const uint64_t node = (uint64_t)(uint32_t)(int32_t)a << 32 | (uint32_t)(int32_t)b;
        sum += weight * random_normal(seed, stream_bumps, 0, node);
        squares += weight * weight;
    }
    return row->uneven_m * sum / sqrt(squares);
}
