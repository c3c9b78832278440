/* render/radar/ground_table.c: see ground_table.h. */
#include "render/radar/ground_table.h"

enum { column_surface, column_f, column_e1, column_e2, column_rms, column_heights, column_count };
static const char *const column_names[] = {"surface", "f_ghz", "eps_re", "eps_im", "rms_mm", "heights"};

static Status bad_row(const Table *table, int row, const char *what, const char *value)
{
    log_error("radar ground: %s: file=%s line=%d value=\"%s\"", what, table->path, table->line[row + 1], value);
    return STATUS_BAD_VALUE;
}

static Status read_row(GroundTable *out, const Table *table, int row, const int at[column_count])
{
    const char        *name = table_text(table, row, at[column_surface]);
    const char        *heights = table_text(table, row, at[column_heights]);
    const SurfaceClass surface = surface_find(name);
    const bool         waves = strcmp(heights, "waves") == 0;
    double             f_ghz, e1, e2, rms_mm;
    if (surface == SURFACE_NONE) return bad_row(table, row, "no such surface; use one of etc/surfaces.csv", name);
    if (!waves && strcmp(heights, "gaussian") != 0) return bad_row(table, row, "heights is gaussian or waves", heights);
    if (table_number(&f_ghz, table, row, at[column_f], 0.1, 1000) != STATUS_OK ||
        table_number(&e1, table, row, at[column_e1], 1, 1000) != STATUS_OK ||
        table_number(&e2, table, row, at[column_e2], 0, 1e6) != STATUS_OK ||
        table_number(&rms_mm, table, row, at[column_rms], 0, 1e5) != STATUS_OK)
        return STATUS_BAD_VALUE;
    GroundRow *to = &out->row[surface];
    if (to->points == 0) {
        to->rms_m = 1e-3 * rms_mm;
        to->waves = waves;
    } else {
        if (to->rms_m != 1e-3 * rms_mm || to->waves != waves)
            return bad_row(table, row, "rms_mm and heights must be those of the surface's first row", name);
        if (to->points == ground_points) return bad_row(table, row, "more than 8 frequencies of a surface", name);
        if (!(1e9 * f_ghz > to->frequency_hz[to->points - 1]))
            return bad_row(table, row, "f_ghz must rise from row to row of a surface", name);
    }
    to->frequency_hz[to->points] = 1e9 * f_ghz;
    to->e1[to->points] = e1;
    to->e2[to->points++] = e2;
    return STATUS_OK;
}

Status ground_table_open(GroundTable *out, const char *path)
{
    Table       table = {0};
    GroundTable read = {0};
    int         at[column_count];
    Status      status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    if (!table_columns(at, &table, column_names, column_count, "radar ground")) status = STATUS_BAD_VALUE;
    for (int row = 0; row < table.rows && status == STATUS_OK; row++) status = read_row(&read, &table, row, at);
    table_close(&table);
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT && status == STATUS_OK; s++)
        if (read.row[s].points == 0) {
            log_error("radar ground: no row of a surface: file=%s surface=%s", path, surface_name((SurfaceClass)s));
            status = STATUS_BAD_VALUE;
        }
    if (status != STATUS_OK) return status;
    read.row[SURFACE_NONE] = read.row[SURFACE_BARE_SOIL];
    *out = read;
    return STATUS_OK;
}

GroundSurface ground_surface(const GroundRow *row, double frequency_hz)
{
    const double *f = row->frequency_hz;
    int           p = 0;
    while (p < row->points - 1 && f[p + 1] < frequency_hz) p++;
    double e1 = row->e1[p], e2 = row->e2[p];
    if (p < row->points - 1) {
        const double share = clamp(log(frequency_hz / f[p]) / log(f[p + 1] / f[p]), 0, 1);
        e1 += share * (row->e1[p + 1] - e1);
        e2 += share * (row->e2[p + 1] - e2);
    }
    return (GroundSurface){CMPLX(e1, -e2), row->rms_m, row->waves};
}

/* exp(-x) I0(x), x >= 0. Source: Abramowitz and Stegun 9.8.1, 9.8.2, to 2e-7. */
static double scaled_i0(double x)
{
    static const double small[] = {1, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813};
    static const double large[] = {0.39894228,  0.01328592, 0.00225319, -0.00157565, 0.00916281,
                                   -0.02057706, 0.02635537, -0.01647633, 0.00392377};
    const bool   near = x < 3.75;
    const double t = near ? x * x / (3.75 * 3.75) : 3.75 / x;
    double       sum = 0;
    for (int i = near ? 6 : 8; i >= 0; i--) sum = sum * t + (near ? small[i] : large[i]);
    return near ? sum * exp(-x) : sum / sqrt(x);
}

double ground_roughness(double rms_m, bool waves, double k, double sin_grazing)
{
    const double phase = k * rms_m * sin_grazing, x = 2 * phase * phase;
    return waves ? scaled_i0(x) : exp(-x);
}

void ground_reflection(double complex *te, double complex *tm, const GroundSurface *surface, double k,
                       double sin_grazing)
{
    const double rough = ground_roughness(surface->rms_m, surface->waves, k, sin_grazing);
    fresnel_half_space(te, tm, surface->eps, sin_grazing);
    *te *= rough, *tm *= rough;
}
