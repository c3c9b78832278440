/* terrain/earth/geoid.c: the .gtx grid, read completely and stored with a margin, so that look-ups need no bounds
 * checks. */
#include "terrain/earth/geoid.h"

#include "pitviper_file.h"

#include <stdlib.h>

static const char  file_name[] = "egm96_15.gtx";
static const float gap_m = -88.8888f; /* .gtx's own mark for no value */
enum { header_octets = 40, margin = 2, most_posts = 40 << 20 };

static uint32_t read_u32(const uint8_t *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static double read_f64(const uint8_t *at)
{
    const uint64_t bits = (uint64_t)read_u32(at) << 32 | read_u32(at + 4);
    double         value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static bool find_file(char *out, size_t out_size)
{
    const char *lists[] = {getenv("PROJ_DATA"), getenv("PROJ_LIB"), "/usr/share/proj:/usr/local/share/proj"};
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
        for (const char *at = lists[k]; at && *at;) {
            const size_t length = strcspn(at, ":");
            const int    n = snprintf(out, out_size, "%.*s/%s", (int)length, at, file_name);
            if (n > 0 && n < (int)out_size) {
                char why[file_why_size];
                if (file_is_regular(why, out)) return true;
            }
            at += length + (at[length] == ':');
        }
    return false;
}

/* False: not a plausible grid of the Earth; nothing is allocated. */
static bool read_header(Geoid *g, const uint8_t header[header_octets])
{
    g->south_deg = read_f64(header);
    g->west_deg = read_f64(header + 8);
    g->step_lat_deg = read_f64(header + 16);
    g->step_lon_deg = read_f64(header + 24);
    const uint32_t rows = read_u32(header + 32), columns = read_u32(header + 36);
    if (rows < 4 || columns < 4 || rows > 65535 || columns > 65535 || (uint64_t)rows * columns > most_posts)
        return false;
    g->rows = (int)rows;
    g->columns = (int)columns;
    if (!(g->south_deg >= -90 && g->west_deg >= -360 && g->west_deg <= 360)) return false;
    if (!(g->step_lat_deg > 0 && g->step_lon_deg > 0)) return false;
    const double north_deg = g->south_deg + (g->rows - 1) * g->step_lat_deg;
    const double round_deg = g->columns * g->step_lon_deg;
    if (!(north_deg <= 90 + 1e-6 && round_deg <= 360 + 1e-6 + g->step_lon_deg)) return false;
    g->wraps = fabs(round_deg - 360) < 1e-6 && g->columns % 2 == 0;
    g->south_pole = g->wraps && fabs(g->south_deg + 90) < 1e-6;
    g->north_pole = g->wraps && fabs(north_deg - 90) < 1e-6;
    return true;
}

static float *post_at(const Geoid *g, int row, int column)
{
    return g->n_m + (size_t)(row + margin) * (size_t)(g->columns + 2 * margin) + (size_t)(column + margin);
}

static void fill_margin(const Geoid *g)
{
    for (int row = 0; row < g->rows; row++)
        for (int k = 1; k <= margin; k++) {
            *post_at(g, row, -k) = g->wraps ? *post_at(g, row, g->columns - k) : NAN;
            *post_at(g, row, g->columns - 1 + k) = g->wraps ? *post_at(g, row, k - 1) : NAN;
        }
    for (int k = 1; k <= margin; k++)
        for (int column = -margin; column < g->columns + margin; column++) {
            /* over the pole lies the same latitude half way round */
            const int across = g->wraps ? (column + g->columns + g->columns / 2) % g->columns : 0;
            *post_at(g, -k, column) = g->south_pole ? *post_at(g, k, across) : NAN;
            *post_at(g, g->rows - 1 + k, column) = g->north_pole ? *post_at(g, g->rows - 1 - k, across) : NAN;
        }
}

static Status read_posts(Geoid *g, FILE *file, const char *path)
{
    uint8_t *row_octets = malloc(4 * (size_t)g->columns);
    g->n_m = calloc((size_t)(g->rows + 2 * margin) * (size_t)(g->columns + 2 * margin), sizeof *g->n_m);
    Status status = row_octets && g->n_m ? STATUS_OK : STATUS_NO_MEMORY;
    for (int row = 0; status == STATUS_OK && row < g->rows; row++) {
        if (fread(row_octets, 4 * (size_t)g->columns, 1, file) != 1) {
            log_error("geoid: %s ends in row %d of %d; install it again: apt-get install --reinstall proj-data", path,
                      row, g->rows);
            status = STATUS_TRUNCATED;
            break;
        }
        for (int column = 0; column < g->columns; column++) {
            const uint32_t bits = read_u32(row_octets + 4 * column);
            float          n_m;
            memcpy(&n_m, &bits, sizeof n_m);
            if (fabsf(n_m - gap_m) < 1e-3f) n_m = NAN;
            else if (!(fabsf(n_m) <= 200)) {
                log_error("geoid: %s: row %d, column %d is %g m, not within 200 m; install it again: "
                          "apt-get install --reinstall proj-data",
                          path, row, column, (double)n_m);
                status = STATUS_BAD_VALUE;
                break;
            }
            *post_at(g, row, column) = n_m;
        }
    }
    free(row_octets);
    if (status == STATUS_OK) fill_margin(g);
    return status;
}

Status geoid_open(Geoid *out, const char *path)
{
    char    found[4096];
    uint8_t header[header_octets];
    Geoid   geoid = {0};
    if (!path || !*path) {
        if (!find_file(found, sizeof found)) {
            log_error(
                "geoid: no %s in $PROJ_DATA, $PROJ_LIB or /usr/share/proj; apt-get install proj-data, or name one "
                "with terrain.geoid",
                file_name);
            return STATUS_IO;
        }
        path = found;
    }
    char  why[file_why_size];
    FILE *file = file_open_stream(why, path);
    if (!file) {
        log_error("geoid: cannot open %s: %s; apt-get install proj-data, or name another with terrain.geoid", path,
                  why);
        return STATUS_IO;
    }
    Status status = fread(header, sizeof header, 1, file) == 1 ? STATUS_OK : STATUS_TRUNCATED;
    if (status == STATUS_OK && !read_header(&geoid, header)) status = STATUS_BAD_VALUE;
    if (status != STATUS_OK) log_error("geoid: %s is not a .gtx grid; name one with terrain.geoid", path);
    else status = read_posts(&geoid, file, path);
    fclose(file);
    if (status != STATUS_OK) {
        geoid_close(&geoid);
        return status;
    }
    *out = geoid;
    return STATUS_OK;
}

void geoid_close(Geoid *geoid)
{
    free(geoid->n_m);
    *geoid = (Geoid){0};
}

/* Lagrange's cubic through posts at -1, 0, 1, 2. */
static void cubic(double w[4], double t)
{
    w[0] = -t * (t - 1) * (t - 2) / 6;
    w[1] = (t + 1) * (t - 1) * (t - 2) / 2;
    w[2] = -(t + 1) * t * (t - 2) / 2;
    w[3] = (t + 1) * t * (t - 1) / 6;
}

double geoid_height_m(const Geoid *geoid, double lat_rad, double lon_rad)
{
    const double lat_deg = lat_rad / rad_per_deg;
    double       east_deg = lon_rad / rad_per_deg - geoid->west_deg;
    if (!(fabs(lat_deg) <= 90 + 1e-9) || !isfinite(east_deg)) return NAN;
    east_deg -= 360 * floor(east_deg / 360);
    const double fy = (lat_deg - geoid->south_deg) / geoid->step_lat_deg, fx = east_deg / geoid->step_lon_deg;
    if (!(fy >= -1e-6 && fy <= geoid->rows - 1 + 1e-6)) return NAN;
    if (!geoid->wraps && !(fx <= geoid->columns - 1)) return NAN;

    int j = (int)floor(fy), i = (int)floor(fx);
    j = j < 0 ? 0 : j > geoid->rows - 2 ? geoid->rows - 2 : j;
    i = i > geoid->columns - 1 ? geoid->columns - 1 : i;
    double wx[4], wy[4], sum = 0;
    cubic(wx, fx - i);
    cubic(wy, fy - j);
    for (int b = 0; b < 4; b++) {
        const float *row = post_at(geoid, j - 1 + b, i - 1);
        sum += wy[b] * (wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2] + wx[3] * row[3]);
    }
    return sum;
}
