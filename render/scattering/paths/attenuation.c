/* render/scattering/paths/attenuation.c: P.676-13 line by line, and its tables of lines.
 *
 * The complex shape of a line at f0, with j the sign of a wave exp(+j w t - j k z) whose refractivity is N' - j N'':
 *
 *     F = f / f0 [(1 - j d) / (f0 - f - j w) - (1 + j d) / (f0 + f + j w)],    N' + j N'' = S F
 *
 * Its imaginary part is the F of P.676-13, eq. 5; the real part belongs to it by causality. */
#include "render/scattering/paths/attenuation.h"

#include "pitviper_table.h"

enum { line_columns = 7 };

/* A row is double[line_columns], the frequency first. */
static const TableColumn oxygen_columns[line_columns] = {
    {"line_ghz", TABLE_DOUBLE, TABLE_AT_NUMBER(0), .low = 1, .high = 5000},
    {"strength", TABLE_DOUBLE, TABLE_AT_NUMBER(1), .low = 0, .high = 1e5},
    {"strength_slope", TABLE_DOUBLE, TABLE_AT_NUMBER(2), .low = 0, .high = 20},
    {"width", TABLE_DOUBLE, TABLE_AT_NUMBER(3), .low = 0.1, .high = 1000},
    {"width_exponent", TABLE_DOUBLE, TABLE_AT_NUMBER(4), .low = -1, .high = 1},
    {"coupling", TABLE_DOUBLE, TABLE_AT_NUMBER(5), .low = -50, .high = 50},
    {"coupling_slope", TABLE_DOUBLE, TABLE_AT_NUMBER(6), .low = -50, .high = 50},
};
static const TableColumn water_columns[line_columns] = {
    {"line_ghz", TABLE_DOUBLE, TABLE_AT_NUMBER(0), .low = 1, .high = 5000},
    {"strength", TABLE_DOUBLE, TABLE_AT_NUMBER(1), .low = 0, .high = 1e5},
    {"strength_slope", TABLE_DOUBLE, TABLE_AT_NUMBER(2), .low = 0, .high = 20},
    {"width", TABLE_DOUBLE, TABLE_AT_NUMBER(3), .low = 0.1, .high = 1000},
    {"width_exponent", TABLE_DOUBLE, TABLE_AT_NUMBER(4), .low = -1, .high = 5},
    {"self", TABLE_DOUBLE, TABLE_AT_NUMBER(5), .low = 0, .high = 100},
    {"self_exponent", TABLE_DOUBLE, TABLE_AT_NUMBER(6), .low = -1, .high = 10},
};
static const TableFormat oxygen_format = {"gas lines",     oxygen_columns,
                                          line_columns,    .next = "etc/radar/oxygen_lines.csv explains the columns",
                                          .least_rows = 1, .most_rows = gas_lines_max};
static const TableFormat water_format = {"gas lines",     water_columns,
                                         line_columns,    .next = "etc/radar/water_lines.csv explains the columns",
                                         .least_rows = 1, .most_rows = gas_lines_max};

static Status take_line(void *user, const void *row, const TableRows *rows, int number)
{
    GasLineList  *list = user;
    const double *x = row;
    if (number > 0 && !(x[0] > list->f_ghz[number - 1]))
        return table_rows_refuse(rows, number, "line_ghz", "above that of the row before");
    list->f_ghz[number] = x[0];
    for (int c = 1; c < line_columns; c++) list->c[c - 1][number] = x[c];
    list->count = number + 1;
    return STATUS_OK;
}

static Status read_list(GasLineList *out, const char *path, const char *standard, const TableFormat *format)
{
    char   found[1024];
    double row[line_columns];
    if (!path && !etc_path(found, sizeof found, standard)) {
        log_error("gas lines: no etc/%s", standard);
        return STATUS_IO;
    }
    return table_each(format, path ? path : found, row, sizeof row, take_line, out);
}

Status gas_lines_read(GasLines *out, const char *oxygen_path, const char *water_path)
{
    GasLines lines = {0};
    Status   status = read_list(&lines.oxygen, oxygen_path, "radar/oxygen_lines.csv", &oxygen_format);
    if (status == STATUS_OK) status = read_list(&lines.water, water_path, "radar/water_lines.csv", &water_format);
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
    double       dry = 0, wet = 0, dry_ppm = 0, wet_ppm = 0;

    const GasLineList *oxygen = &lines->oxygen;
    for (int i = 0; i < oxygen->count; i++) {
        const double strength = oxygen->c[0][i] * 1e-7 * p * theta3 * exp(oxygen->c[1][i] * (1 - theta));
        const double broad = oxygen->c[3][i] == 0 ? theta08 : pow(theta, 0.8 - oxygen->c[3][i]);
        const double width = oxygen->c[2][i] * 1e-4 * (p * broad + 1.1 * e * theta);
        const double coupling = (oxygen->c[4][i] + oxygen->c[5][i] * theta) * 1e-4 * (p + e) * theta08;
        add_line(&dry, &dry_ppm, strength, f, oxygen->f_ghz[i], sqrt(width * width + 2.25e-6) /* Zeeman */, coupling);
    }
    /* the Debye spectrum of oxygen below 10 GHz, and pressure-induced nitrogen above 100; written as d / (d^2 + f^2)
     * and not with 1 / d, since without air there is no width */
    const double d = 5.6e-4 * (p + e) * theta08, debye = 6.14e-5 * p * theta * theta / (d * d + f * f);
    dry += f * d * debye + f * p * theta * theta * 1.4e-12 * p * theta * sqrt(theta) / (1 + 1.9e-5 * f * sqrt(f));
    dry_ppm -= f * f * debye;

    const GasLineList *water = &lines->water;
    const double       theta35 = theta3 * sqrt(theta);
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

/* Permittivity by P.840-9, equations 2 to 11, and the liquid water of fog. */

double complex water_permittivity(double f_ghz, double temp_k)
{
    if (!(f_ghz >= 1 && f_ghz <= 200 && temp_k >= 233.15 && temp_k <= 323.15)) return CMPLX(NAN, NAN);
    const double x = 300 / temp_k - 1;
    const double e0 = 77.66 + 103.3 * x, e1 = 0.0671 * e0, e2 = 3.52;
    const double fp = 20.20 - 146 * x + 316 * x * x, fs = 39.8 * fp; /* relaxation, GHz; least 3.3 */
    const double p = f_ghz / fp, s = f_ghz / fs;
    const double real = (e0 - e1) / (1 + p * p) + (e1 - e2) / (1 + s * s) + e2;
    const double imaginary = p * (e0 - e1) / (1 + p * p) + s * (e1 - e2) / (1 + s * s);
    return CMPLX(real, -imaginary);
}

double cloud_attenuation(double f_ghz, double temp_k)
{
    const double complex water = water_permittivity(f_ghz, temp_k);
    const double         eta = (2 + creal(water)) / -cimag(water);
    return 0.819 * f_ghz / (-cimag(water) * (1 + eta * eta));
}

double fog_liquid_g_m3(double visibility_m)
{
    if (!(visibility_m >= 10)) return NAN;
    if (visibility_m > 1000) return 0;
    const double extinction_per_km = log(50) / (1e-3 * visibility_m); /* ln 50: 2 % contrast */
    return pow(extinction_per_km / 144.7, 1 / 0.88);
}

/* The fits of P.838-3, Tables 1 to 4. */

/* Sum of a exp(-((x - b) / c)^2) over its terms, plus m x + n; x is the logarithm to 10 of the frequency in GHz. */
typedef struct RainFit {
    int    terms;
    double a[5], b[5], c[5], m, n;
} RainFit;

static const RainFit k_h = {4,
                            {-5.33980, -0.35351, -0.23789, -0.94158},
                            {-0.10008, 1.26970, 0.86036, 0.64552},
                            {1.13098, 0.45400, 0.15354, 0.16817},
                            -0.18961,
                            0.71147};
static const RainFit k_v = {4,
                            {-3.80595, -3.44965, -0.39902, 0.50167},
                            {0.56934, -0.22911, 0.73042, 1.07319},
                            {0.81061, 0.51059, 0.11899, 0.27195},
                            -0.16398,
                            0.63297};
static const RainFit alpha_h = {5,
                                {-0.14318, 0.29591, 0.32177, -5.37610, 16.1721},
                                {1.82442, 0.77564, 0.63773, -0.96230, -3.29980},
                                {-0.55187, 0.19822, 0.13164, 1.47828, 3.43990},
                                0.67849,
                                -1.95537};
static const RainFit alpha_v = {5,
                                {-0.07771, 0.56727, -0.20238, -48.2991, 48.5833},
                                {2.33840, 0.95545, 1.14520, 0.791669, 0.791459},
                                {-0.76284, 0.54039, 0.26809, 0.116226, 0.116479},
                                -0.053739,
                                0.83433};

static double fit_at(const RainFit *fit, double x)
{
    double sum = fit->m * x + fit->n;
    for (int i = 0; i < fit->terms; i++) {
        const double u = (x - fit->b[i]) / fit->c[i];
        sum += fit->a[i] * exp(-u * u);
    }
    return sum;
}

bool rain_coefficients(double *k, double *alpha, double f_ghz, double elevation_rad, double tilt_rad)
{
    *k = *alpha = NAN;
    if (!(f_ghz >= 1 && f_ghz <= 1000 && fabs(elevation_rad) <= 0.5 * pi_rad && isfinite(tilt_rad))) return false;
    const double x = log10(f_ghz), kh = pow(10, fit_at(&k_h, x)), kv = pow(10, fit_at(&k_v, x));
    const double ah = fit_at(&alpha_h, x), av = fit_at(&alpha_v, x);
    const double level = cos(elevation_rad), mix = level * level * cos(2 * tilt_rad);
    *k = 0.5 * (kh + kv + (kh - kv) * mix);
    *alpha = (kh * ah + kv * av + (kh * ah - kv * av) * mix) / (2 * *k);
    return true;
}

double rain_attenuation(double f_ghz, double rain_mm_h, double elevation_rad, double tilt_rad)
{
    double k, alpha;
    if (!(rain_mm_h >= 0 && rain_mm_h <= 300) || !rain_coefficients(&k, &alpha, f_ghz, elevation_rad, tilt_rad))
        return NAN;
    return k * pow(rain_mm_h, alpha);
}
