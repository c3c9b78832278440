/* tests/bench/terrain/stability_import.c: terrain stores of awkward files: across the antimeridian, over the poles,
 * cliffs, mostly voids, overlapping sheets with a step between them, posts 0.1 m and 100 m apart. Reference: the file's
 * own function at each stored post, found by GeographicLib's geodetic places and, at the poles, Snyder's polar
 * stereographic formulas. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "terrain/import/terrain_import.h"

#include <stdlib.h>
#include <unistd.h>

enum { side = 160, most_sheets = 2 };

typedef enum Shape { SHAPE_HILLS, SHAPE_CLIFF, SHAPE_VOIDS, SHAPE_RAISED } Shape;

static bool is_void(Shape shape, int i, int j)
{
    return shape == SHAPE_VOIDS && (i % 10 != 0 || j % 40 > 1) && (i / 3) % 7 != 0;
}

static double height_m(Shape shape, int i, int j)
{
    const double hills_m = 120 + 6 * sin(0.11 * i) + 4 * cos(0.07 * j + 0.02 * i);
    return shape == SHAPE_CLIFF ? hills_m + (i > side / 2 ? 900 : 0) : shape == SHAPE_RAISED ? hills_m + 40 : hills_m;
}

typedef struct Sheet {
    Shape  shape;
    double west, north, step; /* of the corner; degrees, or metres of the projection */
} Sheet;

typedef struct Case {
    const char *what;
    int         epsg; /* 4326, 3413 (north), 3031 (south) */
    double      lat_deg, lon_deg, spacing_m;
    int         sheets;
    Sheet       sheet[most_sheets];
    double      limit_m;
} Case;

static const Case cases[] = {
    {"store of files: two sheets that meet at the antimeridian",
     4326,
     45,
     180,
     3,
     2,
     {{SHAPE_HILLS, 180 - side * 3e-5, 45.0024, 3e-5}, {SHAPE_HILLS, -180, 45.0024, 3e-5}},
     0.005},
    {"store of files: over the North Pole, polar stereographic",
     3413,
     90,
     0,
     4,
     1,
     {{SHAPE_HILLS, -320, 320, 4}},
     0.005},
    {"store of files: over the South Pole, polar stereographic",
     3031,
     -90,
     0,
     4,
     1,
     {{SHAPE_HILLS, -320, 320, 4}},
     0.005},
    {"store of files: a cliff of 900 m", 4326, 10.0008, 20.0008, 1, 1, {{SHAPE_CLIFF, 20, 10.0016, 1e-5}}, 0.05},
    {"store of files: nine of ten posts void", 4326, 10.0008, 20.0008, 1, 1, {{SHAPE_VOIDS, 20, 10.0016, 1e-5}}, 0.005},
    {"store of files: overlapping sheets, the second 40 m higher",
     4326,
     10.0008,
     20.0012,
     1,
     2,
     {{SHAPE_HILLS, 20, 10.0016, 1e-5}, {SHAPE_RAISED, 20.0008, 10.0016, 1e-5}},
     0.005},
    {"store of files: posts 0.1 m apart", 4326, 10.00008, 20.00008, 0.1, 1, {{SHAPE_HILLS, 20, 10.00016, 1e-6}}, 0.005},
    {"store of files: posts 100 m apart", 4326, 10.08, 20.08, 100, 1, {{SHAPE_HILLS, 20, 10.16, 1e-3}}, 0.02},
};
enum { case_count = sizeof cases / sizeof *cases, few_cases = 3 };

/* ---- files ----------------------------------------------------------------------------------- */

static bool write_sheet(const char *folder, const Case *c, int n)
{
    const Sheet *s = &c->sheet[n];
    char         path[temp_name_size];
    snprintf(path, sizeof path, "%s/%d.raw", folder, n);
    FILE *file = output_file(path, 0);
    if (!file) return false;
    for (int k = 0; k < side * side; k++) {
        const float z = is_void(s->shape, k % side, k / side) ? -9999 : (float)height_m(s->shape, k % side, k / side);
        fwrite(&z, sizeof z, 1, file);
    }
    bool ok = fclose(file) == 0;
    snprintf(path, sizeof path, "%s/%d.vrt", folder, n);
    file = output_file(path, 0);
    if (!file) return false;
    fprintf(
        file,
        "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\"><SRS>EPSG:%d</SRS><GeoTransform>%.12f, %.12f, 0, %.12f, 0, "
        "%.12f</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\" subClass=\"VRTRawRasterBand\"><NoDataValue>-9999"
        "</NoDataValue><SourceFilename relativeToVRT=\"1\">%d.raw</SourceFilename><ByteOrder>LSB</ByteOrder></VRTRasterBand>"
        "</VRTDataset>\n",
        side, side, c->epsg, s->west, s->step, s->north, -s->step, n);
    return fclose(file) == 0 && ok;
}

/* ---- the file's own surface ------------------------------------------------------------------ */

/* Snyder, Map Projections (1987), (21-33), (21-34), (14-15), (15-9): true at latitude 70 N along 45 W, or 71 S along 0.
 */
static void polar(double out[2], const Geodetic *place, bool north)
{
    const double a_m = 6378137, f = 1 / 298.257223563, e = sqrt(f * (2 - f)), sign = north ? 1 : -1;
    const double true_rad = (north ? 70 : 71) * rad_per_deg, lat = sign * place->lat_rad;
    const double lon = place->lon_rad - (north ? -45 * rad_per_deg : 0);
    const double t = tan(pi_rad / 4 - lat / 2) / pow((1 - e * sin(lat)) / (1 + e * sin(lat)), e / 2);
    const double tc = tan(pi_rad / 4 - true_rad / 2) / pow((1 - e * sin(true_rad)) / (1 + e * sin(true_rad)), e / 2);
    const double mc = cos(true_rad) / sqrt(1 - e * e * sin(true_rad) * sin(true_rad)), rho = a_m * mc * t / tc;
    out[0] = rho * sin(lon);
    out[1] = -sign * rho * cos(lon);
}

/* Bilinear height of a sheet at a place; NaN beyond it, or next to a void. beside: it is within a post of the outline.
 */
static double sheet_m(bool *beside, const Case *c, const Sheet *s, const Geodetic *place)
{
    double at[2] = {place->lon_rad / rad_per_deg, place->lat_rad / rad_per_deg};
    if (c->epsg != 4326) polar(at, place, c->epsg == 3413);
    else at[0] -= 360 * rint((at[0] - s->west - 0.5 * side * s->step) / 360);
    const double x = (at[0] - s->west) / s->step - 0.5, y = (s->north - at[1]) / s->step - 0.5;
    *beside = x >= -1 && y >= -1 && x < side && y < side;
    if (!(x >= 0 && y >= 0 && x < side - 1 && y < side - 1)) return NAN;
    const int    i = (int)x, j = (int)y;
    const double u = x - i, v = y - j;
    double       sum = 0;
    for (int n = 0; n < 4; n++) {
        if (is_void(s->shape, i + n % 2, j + n / 2)) return NAN;
        sum += (n % 2 ? u : 1 - u) * (n / 2 ? v : 1 - v) * (double)(float)height_m(s->shape, i + n % 2, j + n / 2);
    }
    return sum;
}

/* Worst error over the posts of level 0 that lie in the first sheet that has them. */
static double worst_of(const Case *c, const TerrainStore *store, long *compared)
{
    enum { rim = 26 };
    const ElevationLevel *l = &store->elevation.level[0];
    double                worst_m = 0;
    for (int j = rim; j < l->ny - rim; j++)
        for (int i = rim; i < l->nx - rim; i++) {
            double   p_enu[3] = {l->x0_m + i * l->spacing_m, l->y0_m + j * l->spacing_m, 0}, p_ecef[3], want_m = NAN;
            Geodetic place;
            p_enu[2] = elevation_height(&store->elevation, p_enu[0], p_enu[1], NULL);
            ecef_from_enu(p_ecef, &store->frame, p_enu);
            if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return INFINITY;
            bool beside = false; /* between the last post of one sheet and the first of the next both count */
            for (int n = 0; n < c->sheets && isnan(want_m) && !beside; n++)
                want_m = sheet_m(&beside, c, &c->sheet[n], &place);
            if (isnan(want_m)) {
                if (!(place.h_m > 60 && place.h_m < 1100)) return INFINITY; /* filled: within what is around */
                continue;
            }
            worst_m = fmax(worst_m, fabs(place.h_m - want_m));
            ++*compared;
        }
    return worst_m;
}

static double import_case(Status *status, const char *folder, const Case *c)
{
    char            list[3 * temp_name_size] = "", out[temp_name_size], text[64];
    TerrainOptions *o = malloc(sizeof *o);
    TerrainReport   report;
    TerrainStore    store;
    const char     *why;
    double          worst_m = INFINITY;
    long            compared = 0;
    if (!o) *status = STATUS_NO_MEMORY;
    for (int n = 0; n < c->sheets && *status == STATUS_OK; n++) {
        const size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s/%d.vrt", n ? "," : "", folder, n);
        if (!write_sheet(folder, c, n)) *status = STATUS_IO;
    }
    if (*status != STATUS_OK) goto done;
    snprintf(out, sizeof out, "%s/case.store", folder);
    terrain_options_default(o);
    bool ok = terrain_options_set(o, &why, "elevation", list) &&
              terrain_options_set(o, &why, "vertical", "ellipsoid") && terrain_options_set(o, &why, "horizon", "2");
    snprintf(text, sizeof text, "%g", c->spacing_m);
    ok = ok && terrain_options_set(o, &why, "spacing", text);
    snprintf(text, sizeof text, "%.9g,%.9g", c->lat_deg, c->lon_deg);
    ok = ok && terrain_options_set(o, &why, "origin", text);
    log_suppress(true);
    if (ok && terrain_import(&report, o, out, NULL, NULL) == STATUS_OK && store_open(&store, out) == STATUS_OK) {
        worst_m = worst_of(c, &store, &compared);
        store_close(&store);
    }
    log_suppress(false);
    if (compared < 500) worst_m = INFINITY;
    remove(out);
done:
    free(o);
    return worst_m;
}

Status bench_stability_import(Bench *bench)
{
    char   folder[temp_path_size], path[temp_name_size];
    Status status = STATUS_OK;
    if (!temp_folder(folder)) return STATUS_IO;
    for (int k = 0; k < (bench_quick(bench) ? few_cases : case_count) && status == STATUS_OK; k++) {
        bench_progress(bench, cases[k].what);
        const double worst_m = import_case(&status, folder, &cases[k]);
        if (status == STATUS_OK)
            bench_stress(bench, cases[k].what, worst_m, cases[k].limit_m, "m",
                         "the file's function at each stored post");
    }
    for (int n = 0; n < 2 * most_sheets; n++) {
        snprintf(path, sizeof path, "%s/%d.%s", folder, n / 2, n % 2 ? "vrt" : "raw");
        remove(path);
    }
    rmdir(folder);
    if (status != STATUS_OK) log_error("bench: cannot write into %s: %s", folder, status_name(status));
    return status;
}
