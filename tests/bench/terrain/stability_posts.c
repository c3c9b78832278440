/* tests/bench/terrain/stability_posts.c: extreme elevation data: cliffs over the full range of quanta, spikes one
 * post wide, voids, grids of one cell and of a billion. References: each triangle's plane in long double, all posts for
 * the pyramids, and the least and greatest height of the file. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "terrain/elevation/elevation.h"
#include "terrain/from_files/elevation_import.h"

#include <stdlib.h>
#include <unistd.h>

static double uniform(uint32_t stream, uint64_t index, double low, double high)
{
    return low + (high - low) * random_uniform(0x6E0D, stream, 0, index);
}

/* ---- grids ---------------------------------------------------------------------------------- */

typedef enum Shape { FLAT_LOW, FLAT_HIGH, CLIFF, SPIKE, CHESS, NOISE, SHAPES } Shape;

static uint16_t shape_post(Shape shape, int i, int j, int nx, int ny)
{
    switch (shape) {
    case FLAT_HIGH:
        return 65535;
    case CLIFF:
        return 2 * i > nx ? 65535 : 0;
    case SPIKE:
        return i == nx / 2 && j == ny / 2 ? 65535 : 0;
    case CHESS:
        return (i + j) % 2 ? 65535 : 0;
    case NOISE:
        return (uint16_t)uniform(1, (uint64_t)j * (uint64_t)nx + (uint64_t)i, 0, 65536);
    default:
        return 0;
    }
}

typedef struct Sheet {
    int    nx, ny;
    double x0_m, y0_m, spacing_m, z0_m, step_m;
} Sheet;

static const Sheet sheets[] = {
    {2, 2, -1, -1, 2, 0, 1},          {2, 3, -5e5, 3e5, 1e5, -12500, 0.34},  {3, 2, 0, 0, 0x1p-6, 0, 0x1p-8},
    {65, 33, -960, 480, 30, 0, 0.34}, {257, 1025, -1e6, 1e6, 1, -1e4, 1},    {2, 65536, 0, -32768, 1, 0, 0.1},
    {65536, 2, -32768, 0, 1, 0, 0.1}, {33, 65, 1e3, -1e5, 0.5, 1e3, 1e-300}, {1500, 1500, -750, -750, 1, 0, 0x1p-8},
};
static const Sheet huge_sheet = {16385, 16385, -8192, -8192, 1, 0, 0x1p-4}; /* half a gigabyte of posts */

static Status fill(Elevation *out, const Sheet *s, Shape shape)
{
    const Status status = elevation_level_create(
        out, 0, &(ElevationGrid){s->nx, s->ny, s->x0_m, s->y0_m, s->spacing_m, s->z0_m, s->step_m});
    if (status != STATUS_OK) return status;
    for (int j = 0; j < s->ny; j++)
        for (int i = 0; i < s->nx; i++) elevation_set_post(&out->level[0], i, j, shape_post(shape, i, j, s->nx, s->ny));
    elevation_build_pyramids(out);
    return STATUS_OK;
}

/* Gives a place of the grid: a post, an edge or a diagonal, each with its neighbours, or any place. */
static double coordinate(double x0_m, double spacing_m, int n, uint32_t stream, uint64_t at)
{
    const double post = floor(uniform(stream, at, 0, n)), share = uniform(stream + 1, at, 0, 1);
    const int    kind = (int)uniform(stream + 2, at, 0, 5);
    double       x_m = x0_m + spacing_m * post;
    if (kind == 1) x_m = nextafter(x_m, -INFINITY);
    if (kind == 2) x_m = nextafter(x_m, INFINITY);
    if (kind >= 3) x_m += spacing_m * (kind == 3 ? 0.5 : share);
    return clamp(x_m, x0_m, x0_m + spacing_m * (n - 1));
}

typedef struct GridErrors {
    double off_m, normal, over_m, absent;
} GridErrors;

static void look(GridErrors *errors, const Elevation *ground, int looks)
{
    const ElevationLevel *l = &ground->level[0];
    for (int n = 0; n < looks; n++) {
        const double x_m = coordinate(l->x0_m, l->spacing_m, l->nx, 10, (uint64_t)n);
        const double y_m = coordinate(l->y0_m, l->spacing_m, l->ny, 20, (uint64_t)n);
        double       normal[3] = {NAN, NAN, NAN};
        const double z_m = elevation_height(ground, x_m, y_m, normal);
        if (!isfinite(z_m)) {
            errors->absent++;
            continue;
        }
        const long double fx = ((long double)x_m - l->x0_m) / l->spacing_m,
                          fy = ((long double)y_m - l->y0_m) / l->spacing_m;
        const int i = (int)fminl(floorl(fx), l->nx - 2), j = (int)fminl(floorl(fy), l->ny - 2);
        /* a place on an edge belongs to both cells, on a diagonal to both triangles: the nearest of them is meant */
        double least_m = INFINITY, least_normal = INFINITY, low = INFINITY, high = -INFINITY;
        for (int cell = 0; cell < 9; cell++) {
            const int a = i - 1 + cell % 3, b = j - 1 + cell / 3;
            if (a < 0 || b < 0 || a > l->nx - 2 || b > l->ny - 2) continue;
            int32_t           p[4];
            const long double u = fx - a, v = fy - b, edge = 1e-9L;
            if (!(u >= -edge && v >= -edge && u <= 1 + edge && v <= 1 + edge)) continue;
            elevation_cell(p, l, a, b);
            for (int side = 0; side < 2; side++) {
                if (side ? u > v + edge : u < v - edge) continue;
                const long double sw = p[0], se = p[1], nw = p[2], ne = p[3];
                const long double du = (side ? ne - nw : se - sw) * l->step_m,
                                  dv = (side ? nw - sw : ne - se) * l->step_m;
                const long double length = hypotl(hypotl(du, dv), l->spacing_m);
                const long double want = l->z0_m + l->step_m * sw + u * du + v * dv;
                least_m = fmin(least_m, (double)(fabsl(z_m - want) * l->spacing_m / length));
                least_normal = fmin(least_normal, (double)fmaxl(fabsl(normal[0] + du / length),
                                                                fmaxl(fabsl(normal[1] + dv / length),
                                                                      fabsl(normal[2] - l->spacing_m / length))));
                for (int k = 0; k < 4; k++) {
                    low = fmin(low, l->z0_m + l->step_m * p[k]);
                    high = fmax(high, l->z0_m + l->step_m * p[k]);
                }
            }
        }
        bench_worse(&errors->off_m, least_m);
        bench_worse(&errors->normal, least_normal);
        bench_worse(&errors->normal, v3_length(normal) - 1);
        bench_worse(&errors->over_m, fmax(fmax(low - z_m, z_m - high), 0));
    }
}

/* Entries of pyramid and rises that are inconsistent with their posts. */
static double wrong_entries(const Elevation *ground)
{
    const ElevationLevel *l = &ground->level[0];
    double                wrong =
        l->pyramid_count < 1 || l->pyramid_nx[l->pyramid_count - 1] != 1 || l->pyramid_ny[l->pyramid_count - 1] != 1;
    for (int k = elevation_pyramid_first; k < l->pyramid_count; k++)
        for (int b = 0; b < l->pyramid_ny[k]; b++)
            for (int a = 0; a < l->pyramid_nx[k]; a++) {
                int       most = 0, rise[4] = {0};
                const int i1 = ((a + 1) << k) < l->nx - 1 ? (a + 1) << k : l->nx - 1;
                const int j1 = ((b + 1) << k) < l->ny - 1 ? (b + 1) << k : l->ny - 1;
                for (int j = b << k; j <= j1; j++)
                    for (int i = a << k; i <= i1; i++) {
                        const int post = elevation_post(l, i, j);
                        const int east = i < i1 ? elevation_post(l, i + 1, j) - post : 0;
                        const int north = j < j1 ? elevation_post(l, i, j + 1) - post : 0;
                        const int each[4] = {east, -east, north, -north};
                        most = post > most ? post : most;
                        for (int e = 0; e < 4; e++) rise[e] = each[e] > rise[e] ? each[e] : rise[e];
                    }
                const size_t at = (size_t)b * (size_t)l->pyramid_nx[k] + (size_t)a;
                wrong += l->pyramid[k][at] != most;
                if (k < elevation_rise_level) continue;
                const ElevationRise r = l->rise[k][at];
                wrong += r.east != rise[0] || r.west != rise[1] || r.north != rise[2] || r.south != rise[3];
            }
    return wrong;
}

static Status grids(Bench *bench)
{
    const bool quick = bench_quick(bench);
    const int  count = sizeof sheets / sizeof *sheets;
    GridErrors errors = {0};
    double     wrong = 0;
    for (int n = 0; n < count * SHAPES + !quick; n++) {
        const bool   huge = n == count * SHAPES, large = huge || n % count == count - 1;
        Elevation    ground = {0};
        const Status status = fill(&ground, huge ? &huge_sheet : &sheets[n % count], huge ? CLIFF : (Shape)(n / count));
        if (status != STATUS_OK) return status;
        look(&errors, &ground, quick ? 400 : 20000);
        if (!huge && (!large || !quick || n / count == NOISE)) wrong += wrong_entries(&ground);
        elevation_destroy(&ground);
    }
    const char *plane = "the triangle's plane, long double";
    bench_stress(bench, "ground: cliffs, spikes, chess of 65535 quanta, off the surface", errors.off_m, 1e-9, "m",
                 plane);
    /* the heights themselves are rounded: 1.8e-12 m of 22 km, over posts 30 m apart */
    bench_stress(bench, "the same: its normals", errors.normal, 1e-13, "", plane);
    bench_stress(bench, "the same: above or below every post of the cell", errors.over_m, 1e-11, "m",
                 "the cell's four posts");
    bench_stress(bench, "the same: places without ground", errors.absent, 0, "places", "outline of the grid");
    bench_stress(bench, "the same: pyramids and rises", wrong, 0, "entries", "every post of each square");
    return STATUS_OK;
}

/* Sizes and scales that are none. */
static void refusals(Bench *bench)
{
    static const double none[] = {0, -1, NAN, INFINITY, -INFINITY};
    static const int    size[] = {-1, 0, 1, elevation_most_posts + 1, 2147483647, -2147483647 - 1};
    double              taken = 0;
    for (int n = 0; n < 5 + 5 + 3 * 3 + 6 * 2; n++) {
        Elevation ground = {0};
        double    v[5] = {0, 0, 1, 0, 1}; /* x0, y0, spacing, z0, step */
        int       s[2] = {4, 4};
        if (n < 5) v[2] = none[n];
        else if (n < 10) v[4] = none[n - 5];
        else if (n < 19) v[(n - 10) / 3 == 2 ? 3 : (n - 10) / 3] = none[2 + (n - 10) % 3];
        else s[(n - 19) % 2] = size[(n - 19) / 2];
        taken +=
            elevation_level_create(&ground, 0, &(ElevationGrid){s[0], s[1], v[0], v[1], v[2], v[3], v[4]}) == STATUS_OK;
        elevation_destroy(&ground);
    }
    bench_stress(bench, "ground: sizes and scales that are none, accepted", taken, 0, "grids", "refusal");
}

/* ---- files ---------------------------------------------------------------------------------- */

typedef struct File {
    const char *what;
    int         width, height;
    float (*post)(int i, int j);
    double low_m, high_m; /* of its heights; NaN: there are none, and it must be refused */
    double west_deg, south_deg, step_deg;
} File;

static const float gap = -9999;
static float       post_flat(int i, int j) { return (void)i, (void)j, 431.25f; }
static float       post_cliff(int i, int j) { return (void)j, i < 40 ? 9000 : -12000; }
static float       post_spike(int i, int j) { return i == 31 && j == 17 ? 9400 : i == 12 && j == 40 ? -12400 : 0; }
static float       post_chess(int i, int j) { return (i + j) % 2 ? 9400 : -12400; }
static float       post_lonely(int i, int j) { return i == 20 && j == 20 ? 123 : gap; }
static float       post_void(int i, int j) { return (void)i, (void)j, gap; }
static float       post_holes(int i, int j) { return i > 20 || (i + j) % 2 ? gap : j % 3 ? 100 : 2500; }
static float       post_wild(int i, int j)
{
    static const float wild[] = {NAN, INFINITY, -INFINITY, 3.4e38f, -3.4e38f, 1e-42f, -0.0f, 1e5f, -2e4f, 250, -9999};
    return wild[(3 * i + 7 * j) % 11];
}

static const File files[] = {
    {"chess of 22 km", 48, 48, post_chess, -12400, 9400, -122, 36, 3e-4},
    {"wild numbers", 48, 48, post_wild, 0, 250, 179.995, -12, 3e-4},
    {"one post, the rest void", 48, 48, post_lonely, 123, 123, -122, 36, 3e-4},
    {"1 x 1", 1, 1, post_flat, NAN, NAN, -122, 36, 3e-4},
    {"all void", 32, 32, post_void, NAN, NAN, -122, 36, 3e-4},
    /* further cases, in full runs only */
    {"flat, 2 x 2", 2, 2, post_flat, 431.25, 431.25, -122, 36, 3e-4},
    {"flat, over the date line", 64, 64, post_flat, 431.25, 431.25, 179.99, 10, 3e-4},
    {"cliff of 21 km", 64, 64, post_cliff, -12000, 9000, -122, 36, 3e-4},
    {"spike and pit", 64, 64, post_spike, -12400, 9400, -122, 36, 3e-4},
    {"holes", 64, 64, post_holes, 100, 2500, -122, 36, 3e-4},
    {"at 89 degrees north", 64, 64, post_spike, -12400, 9400, 20, 88.98, 3e-4},
    {"at 89 degrees south", 64, 64, post_cliff, -12000, 9000, 20, -89, 3e-4},
    {"posts 1 cm apart", 48, 48, post_spike, -12400, 9400, 0, 0, 1e-7},
    {"wide, 2 high", 4000, 2, post_cliff, -12000, 9000, 7, 45, 3e-4},
};
enum { few_files = 5, all_files = sizeof files / sizeof *files };

static const char *const parts[] = {"ground.hdr", "ground.prj", "ground.flt", "ground.flt.aux.xml"};

/* Writes an ESRI grid of floats, its header and its coordinate system into the folder. */
static bool write_file(const char *folder, const File *f)
{
    bool ok = true;
    for (int part = 0; part < 3 && ok; part++) {
        char path[temp_name_size];
        snprintf(path, sizeof path, "%s/%s", folder, parts[part]);
        FILE *file = output_file(path, 0);
        if (!file) return false;
        if (part == 0)
            fprintf(file,
                    "ncols %d\nnrows %d\nxllcorner %.10f\nyllcorner %.10f\ncellsize %.10f\nNODATA_value -9999\n"
                    "byteorder lsbfirst\n",
                    f->width, f->height, f->west_deg, f->south_deg, f->step_deg);
        else if (part == 1)
            fputs("GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
                  "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]\n",
                  file);
        else
            for (int n = 0; n < f->width * f->height; n++) {
                const float v = f->post(n % f->width, n / f->width);
                fwrite(&v, sizeof v, 1, file);
            }
        ok = !ferror(file);
        ok = fclose(file) == 0 && ok;
    }
    return ok;
}

static const double horizon_m = 3000;

/* Places without ground or with a normal that is none; how far the ground leaves what the file holds. */
static void look_at_file(double *absent, double *over_m, const Elevation *ground, const LocalFrame *frame,
                         const File *f, int looks)
{
    for (int n = 0; n < looks; n++) {
        const double scale = pow(10, uniform(30, (uint64_t)n, -3, 0)) * horizon_m;
        const double x_m = scale * uniform(31, (uint64_t)n, -1, 1), y_m = scale * uniform(32, (uint64_t)n, -1, 1);
        double       normal[3] = {NAN, NAN, NAN}, p_ecef[3];
        const double p_enu[3] = {x_m, y_m, elevation_height(ground, x_m, y_m, normal)};
        Geodetic     place;
        ecef_from_enu(p_ecef, frame, p_enu);
        if (!isfinite(p_enu[2]) || !(fabs(v3_length(normal) - 1) <= 1e-14) ||
            geodetic_from_ecef(&place, p_ecef) != STATUS_OK) {
            ++*absent;
            continue;
        }
        bench_worse(over_m, fmax(fmax(f->low_m - place.h_m, place.h_m - f->high_m), 0));
    }
}

static Status imports(Bench *bench)
{
    const int count = bench_quick(bench) ? few_files : all_files;
    char      folder[temp_path_size], path[temp_name_size];
    double    absent = 0, over_m = 0, judged = 0;
    if (!temp_folder(folder)) return STATUS_IO;
    Status status = STATUS_OK;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        const File     *f = &files[k];
        const Geodetic  origin = {(f->south_deg + 0.5 * f->height * f->step_deg) * rad_per_deg,
                                  (f->west_deg + 0.5 * f->width * f->step_deg) * rad_per_deg, 0};
        LocalFrame      frame;
        Elevation       ground = {0};
        ElevationReport report;
        bench_progress(bench, f->what);
        if (!write_file(folder, f)) status = STATUS_IO;
        snprintf(path, sizeof path, "%s/ground.flt", folder);
        if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
        if (status != STATUS_OK) break;
        const ElevationFiles from = {.paths = path,
                                     .geoid_path = "",
                                     .vertical = ELEVATION_ELLIPSOID,
                                     .horizon_m = horizon_m,
                                     .spacing_m = f->step_deg * 1e5};
        log_suppress(true);
        const bool taken = elevation_import(&ground, &report, &from, &frame, NULL, 0) == STATUS_OK;
        log_suppress(false);
        judged += taken == isnan(f->low_m);
        if (taken) look_at_file(&absent, &over_m, &ground, &frame, f, bench_quick(bench) ? 3000 : 100000);
        elevation_destroy(&ground);
    }
    for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
        snprintf(path, sizeof path, "%s/%s", folder, parts[k]);
        remove(path);
    }
    rmdir(folder);
    if (status != STATUS_OK) {
        log_error("bench: cannot write into %s: %s", folder, status_name(status));
        return status;
    }
    bench_stress(bench, "ground of files: voids, NaN, 1 x 1: wrongly taken or refused", judged, 0, "files",
                 "what they hold");
    bench_stress(bench, "ground of files: places without height or normal", absent, 0, "places",
                 "every place to the horizon");
    /* the limit is half a quantum of 22 km in 16 bits, and the chord between posts under the Earth's bend */
    bench_stress(bench, "ground of files: beyond the heights that the file holds", over_m, 0.5, "m",
                 "least and greatest of the file");
    return STATUS_OK;
}

Status bench_stability_posts(Bench *bench)
{
    refusals(bench);
    Status status = grids(bench);
    if (status == STATUS_OK) status = imports(bench);
    if (status == STATUS_OK) status = bench_stability_import(bench);
    return status;
}
