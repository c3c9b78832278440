/* render/radar/gas_attenuation.c: P.676-13 line by line, and its tables of lines.
 *
 * The complex shape of a line at f0, with j the sign of a wave exp(+j w t - j k z) whose refractivity is N' - j N'':
 *
 *     F = f / f0 [(1 - j d) / (f0 - f - j w) - (1 + j d) / (f0 + f + j w)],    N' + j N'' = S F
 *
 * Its imaginary part is the F of P.676-13, eq. 5; the real part belongs to it by causality. */
#include "render/radar/gas_attenuation.h"

typedef struct LineColumn {
    const char *name;
    double low, high;
} LineColumn;

enum { line_columns = 7 };

static const LineColumn oxygen_column[line_columns] = {
    {"line_ghz", 1, 5000},     {"strength", 0, 1e5},  {"strength_slope", 0, 20},  {"width", 0.1, 1000},
    {"width_exponent", -1, 1}, {"coupling", -50, 50}, {"coupling_slope", -50, 50}};
static const LineColumn water_column[line_columns] = {
    {"line_ghz", 1, 5000},     {"strength", 0, 1e5}, {"strength_slope", 0, 20}, {"width", 0.1, 1000},
    {"width_exponent", -1, 5}, {"self", 0, 100},     {"self_exponent", -1, 10}};

static Status read_list(GasLineList *out, const char *path, const char *standard, const LineColumn column[line_columns])
{
    Table table;
    char found[1024];
    const char *name[line_columns];
    int at[line_columns];
    if (!path && !etc_path(found, sizeof found, standard)) {
        log_error("gas lines: no etc/%s", standard);
        return STATUS_IO;
    }
    Status status = table_open(&table, path ? path : found);
    if (status != STATUS_OK) return status;
    for (int c = 0; c < line_columns; c++) name[c] = column[c].name;
    if (!table_columns(at, &table, name, line_columns, "gas lines")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK && (table.rows < 1 || table.rows > gas_lines_max)) {
        log_error("gas lines: %s: rows=%d: want 1 to %d", table.path, table.rows, (int)gas_lines_max);
        status = STATUS_BAD_VALUE;
    }
    for (int row = 0; status == STATUS_OK && row < table.rows; row++) {
        for (int c = 0; c < line_columns && status == STATUS_OK; c++)
            status = table_number(c == 0 ? &out->f_ghz[row] : &out->c[c - 1][row], &table, row, at[c], column[c].low,
                                  column[c].high);
        if (status == STATUS_OK && row > 0 && !(out->f_ghz[row] > out->f_ghz[row - 1])) {
            log_error("gas lines: %s:%d: line_ghz=%g is not above that of the row before", table.path,
                      table.line[row + 1], out->f_ghz[row]);
            status = STATUS_BAD_VALUE;
        }
    }
    out->count = table.rows;
    table_close(&table);
    return status;
}

Status gas_lines_read(GasLines *out, const char *oxygen_path, const char *water_path)
{
    GasLines lines = {0};
    Status status = read_list(&lines.oxygen, oxygen_path, "radar/oxygen_lines.csv", oxygen_column);
    if (status == STATUS_OK) status = read_list(&lines.water, water_path, "radar/water_lines.csv", water_column);
    if (status == STATUS_OK) *out = lines;
    return status;
}

/* Adds strength times the shape: imaginary part, and real part. */
static void add_line(double *absorbed, double *dispersed, double strength, double f, double f0, double width,
                     double coupling)
{
    const double below = f0 - f, above = f0 + f, w2 = width * width;
    const double p = 1 / (below * below + w2), q = 1 / (above * above + w2), s = strength * f / f0;
    *absorbed += s * ((width - coupling * below) * p + (width - coupling * above) * q);
    *dispersed += s * ((below + coupling * width) * p - (above + coupling * width) * q);
}

void gas_attenuation(GasAttenuation *out, const GasLines *lines, double f_ghz, const GasState *air)
{
    const double p = air->dry_hpa, e = air->vapour_hpa, f = f_ghz;
    *out = (GasAttenuation){NAN, NAN, NAN, NAN};
    if (!(f >= 1 && f <= 1000 && p >= 0 && p <= 1200 && e >= 0 && e <= 150 && air->temp_k >= 150 && air->temp_k <= 350))
        return;

    const double theta = 300 / air->temp_k, theta3 = theta * theta * theta, theta08 = pow(theta, 0.8);
    double dry = 0, wet = 0, dry_ppm = 0, wet_ppm = 0;

    const GasLineList *oxygen = &lines->oxygen;
    for (int i = 0; i < oxygen->count; i++) {
        const double strength = oxygen->c[0][i] * 1e-7 * p * theta3 * exp(oxygen->c[1][i] * (1 - theta));
        const double broad = oxygen->c[3][i] == 0 ? theta08 : pow(theta, 0.8 - oxygen->c[3][i]);
        const double width = oxygen->c[2][i] * 1e-4 * (p * broad + 1.1 * e * theta);
        const double coupling = (oxygen->c[4][i] + oxygen->c[5][i] * theta) * 1e-4 * (p + e) * theta08;
        add_line(&dry, &dry_ppm, strength, f, oxygen->f_ghz[i], sqrt(width * width + 2.25e-6) /* Zeeman */, coupling);
    }
    /* Debye spectrum of oxygen below 10 GHz, pressure-induced nitrogen above 100; d / (d^2 + f^2), not 1 / d: no air,
     * no width */
    const double d = 5.6e-4 * (p + e) * theta08, debye = 6.14e-5 * p * theta * theta / (d * d + f * f);
    dry += f * d * debye + f * p * theta * theta * 1.4e-12 * p * theta * sqrt(theta) / (1 + 1.9e-5 * f * sqrt(f));
    dry_ppm -= f * f * debye;

    const GasLineList *water = &lines->water;
    const double theta35 = theta3 * sqrt(theta);
    for (int i = 0; i < water->count && e > 0; i++) {
        const double f0 = water->f_ghz[i];
        const double strength = water->c[0][i] * 0.1 * e * theta35 * exp(water->c[1][i] * (1 - theta));
        const double width =
            water->c[2][i] * 1e-4 * (p * pow(theta, water->c[3][i]) + water->c[4][i] * e * pow(theta, water->c[5][i]));
        const double doppler = 0.535 * width + sqrt(0.217 * width * width + 2.1316e-12 * f0 * f0 / theta);
        add_line(&wet, &wet_ppm, strength, f, f0, doppler, 0);
    }
    *out = (GasAttenuation){
        .dry_db_km = 0.1820 * f * dry, .wet_db_km = 0.1820 * f * wet, .dry_ppm = dry_ppm, .wet_ppm = wet_ppm};
}
