/* terrain/import/terrain_import.c: files to a terrain store: plan, the levels around, level 0 strip by strip with what
 * covers it (terrain_cover.c). */
#include "pitviper_file.h"
#include "pitviper_output.h"
#include "terrain/import/terrain_import_private.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/statvfs.h>

enum { rows_plain = 512, rows_apart = 1024, most_sources = 8192, options_size = 8 * terrain_paths_size };

static const char module[] = "terrain import";

/* Reports progress; returns false when the import is to stop. */
static bool go_on(StoreImport *m, const char *stage, double share, bool now)
{
    const double s = wall_clock_s();
    if (!m->watch.progress || (!now && s - m->told_s < 0.1)) return true;
    m->told_s = s;
    if (m->watch.progress(m->watch.user, stage, share)) return true;
    m->r.stopped = true;
    return false;
}

/* ---- plan ------------------------------------------------------------------------------------ */

static Status open_set(RasterSet *out, const char *paths, const char *option, bool whole, const char *what)
{
    Status status = *paths ? raster_set_open(out, paths, option) : STATUS_OK;
    for (int k = 0; status == STATUS_OK && whole && k < out->count; k++) {
        if (out->raster[k].whole) continue;
        log_error("%s: %s holds numbers with fractions, not %s; is it elevation?", option, out->raster[k].sheet[0].path,
                  what);
        status = STATUS_BAD_VALUE;
    }
    return status;
}

static Status open_sources(StoreImport *m)
{
    const TerrainOptions *o = m->o;
    Geodetic              origin = {o->origin_deg[0] * rad_per_deg, o->origin_deg[1] * rad_per_deg, 0};
    Status                status = STATUS_OK;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        m->list[k] = malloc(options_size);
        if (!m->list[k]) return STATUS_NO_MEMORY;
        if (terrain_options_sources(m->list[k], options_size, o, k ? o->surface : o->elevation)) continue;
        log_error("%s: the names of the files are too long; name their folder instead", module);
        return STATUS_BAD_VALUE;
    }
    if (isnan(o->origin_deg[0])) status = elevation_middle(&origin, &m->opened, m->list[*o->surface != 0]);
    if (status == STATUS_OK) status = local_frame_at(&m->frame, &origin);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < 2; k++)
        m->files[k] = (ElevationFiles){.paths = m->list[k],
                                       .geoid_path = o->geoid,
                                       .vertical = o->vertical,
                                       .spacing_m = o->spacing_m,
                                       .horizon_m = 1000 * o->horizon_km,
                                       .size_m = {1000 * o->size_km[0], 1000 * o->size_km[1]},
                                       .keep_folder = m->folder,
                                       .heard = m->watch.heard,
                                       .heard_user = m->watch.user,
                                       .opened = (k == 1) == (*o->surface != 0) ? &m->opened : NULL};
    if (*o->surface && status == STATUS_OK)
        status = elevation_stream_open(&m->surface, &m->files[1], &m->frame, NULL, m->pool);
    if (*o->elevation && status == STATUS_OK)
        status = elevation_stream_open(&m->terrain, &m->files[0], &m->frame, m->surface, m->pool);
    m->first = m->surface ? m->surface : m->terrain;
    if (status == STATUS_OK) status = open_set(&m->cover, o->cover, "terrain import: --cover", true, "classes");
    if (status == STATUS_OK) status = open_set(&m->photo, o->photo, "terrain import: --photo", true, "a photograph");
    for (int k = 0; status == STATUS_OK && k < m->photo.count; k++)
        if (!m->photo.raster[k].bytes) {
            log_error("terrain import: --photo: %s holds samples of more than 8 bits; "
                      "gdal_translate -ot Byte -scale %s OUT.tif",
                      m->photo.raster[k].sheet[0].path, m->photo.raster[k].sheet[0].path);
            status = STATUS_BAD_VALUE;
        }
    if (status == STATUS_OK)
        status = open_set(&m->canopy_height, o->canopy_height, "terrain import: --canopy-height", false, "");
    if (status == STATUS_OK)
        status = open_set(&m->canopy_cover, o->canopy_cover, "terrain import: --canopy-cover", false, "");
    return status;
}

/* Plans a grid over level 0: cells of a power of two times the posts' spacing, about as large as pixels. With a set,
 * the grid covers only its part of level 0, from whole nodes on. */
static void plan_grid(StoreGrid *out, const StoreImport *m, double posting_m, const RasterSet *set, int finest)
{
    const double s = m->level.spacing_m;
    const int    p = (int)clamp(floor(log2(posting_m / s) + 0.5), finest, 6);
    const double cell_m = s * exp2(p), x0_m = (m->level.i0 - 0.5) * s, y0_m = (m->level.j0 - 0.5) * s;
    const int    nx = (int)ceil(m->level.nx * s / cell_m), ny = (int)ceil(m->level.ny * s / cell_m);
    double       low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; set && k < set->count; k++) {
        double one_low[2], one_high[2];
        raster_enu_box(one_low, one_high, &set->raster[k], &m->frame, 0);
        for (int c = 0; c < 2; c++) {
            low[c] = fmin(low[c], one_low[c]);
            high[c] = fmax(high[c], one_high[c]);
        }
    }
    int i0 = 0, i1 = nx, j0 = 0, j1 = ny;
    if (set && low[0] < high[0]) {
        const double lean_m =
            0.01 * (high[0] - low[0]) + 10 * cell_m; /* room for heights, which appear displaced outwards */
        i0 = (int)clamp(floor((low[0] - lean_m - x0_m) / cell_m / 64) * 64, 0, nx);
        i1 = (int)clamp(ceil((high[0] + lean_m - x0_m) / cell_m), 0, nx);
        j0 = (int)clamp(floor((low[1] - lean_m - y0_m) / cell_m / 64) * 64, 0, ny);
        j1 = (int)clamp(ceil((high[1] + lean_m - y0_m) / cell_m), 0, ny);
    }
    if (i1 <= i0 || j1 <= j0) *out = (StoreGrid){0};
    else *out = (StoreGrid){i1 - i0, j1 - j0, x0_m + i0 * cell_m, y0_m + j0 * cell_m, cell_m};
}

/* Plans the wide grid: over all that the cover files show, with cells eight times as large, at most 2000 each way about
 * the origin. */
static void plan_wide(StoreGrid *out, const StoreImport *m, double cell_m)
{
    enum { half = 1000 };
    int a[2] = {half, half}, b[2] = {-half, -half};
    for (int k = 0; k < m->cover.count; k++) {
        double low[2], high[2];
        raster_enu_box(low, high, &m->cover.raster[k], &m->frame, 0);
        for (int c = 0; c < 2; c++) {
            a[c] = (int)fmin(a[c], clamp(floor(low[c] / cell_m) - 1, -half, half));
            b[c] = (int)fmax(b[c], clamp(ceil(high[c] / cell_m) + 1, -half, half));
        }
    }
    *out = (StoreGrid){0};
    if (b[0] > a[0] && b[1] > a[1]) *out = (StoreGrid){b[0] - a[0], b[1] - a[1], a[0] * cell_m, a[1] * cell_m, cell_m};
}

static Status list_sources(StoreImport *m)
{
    const RasterSet *sets[] = {m->terrain ? elevation_stream_files(m->terrain) : NULL,
                               m->surface ? elevation_stream_files(m->surface) : NULL,
                               &m->cover,
                               &m->photo,
                               &m->canopy_height,
                               &m->canopy_cover};
    m->source = calloc(most_sources, sizeof *m->source);
    if (!m->source) return STATUS_NO_MEMORY;
    for (size_t s = 0; s < sizeof sets / sizeof *sets; s++)
        for (int k = 0; sets[s] && k < sets[s]->count; k++)
            for (int n = 0; n < sets[s]->raster[k].sheet_count; n++) {
                if (m->plan.source_count == most_sources) {
                    log_error("%s: more than %d files; gdalbuildvrt joins them", module, (int)most_sources);
                    return STATUS_BAD_VALUE;
                }
                StoreSource *to = &m->source[m->plan.source_count++];
                to->path = sets[s]->raster[k].sheet[n].path;
                (void)store_source_look(to); /* a source that is not a file (one of GDAL's own names) keeps size 0 */
            }
    m->plan.source = m->source;
    return STATUS_OK;
}

/* Whether a file of buildings can be made and written, before hours of work. */
static Status look_at_buildings(const StoreImport *m)
{
    static const double most_m = 2;
    if (!*m->o->buildings) return STATUS_OK;
    if (m->level.spacing_m > most_m) {
        log_error(
            "terrain import: --buildings: outlines need posts at most %.3g m apart, and these are %.3g; --spacing 2, "
            "or leave it out",
            most_m, m->level.spacing_m);
        return STATUS_BAD_VALUE;
    }
    if (output_check(m->o->buildings, 0) == 0) return STATUS_OK;
    log_error("terrain import: --buildings: cannot write %s: %s; choose another name", m->o->buildings,
              output_reason(errno));
    return STATUS_IO;
}

static Status plan(StoreImport *m)
{
    StorePlan *p = &m->plan;
    p->origin = m->frame.origin;
    p->level_count = elevation_stream_levels(m->first);
    for (int k = 0; k < p->level_count; k++) {
        StreamLevel l;
        elevation_stream_level(&l, m->first, k);
        p->level[k] = (StoreLevel){.nx = l.nx,
                                   .ny = l.ny,
                                   .x0_m = l.i0 * l.spacing_m,
                                   .y0_m = l.j0 * l.spacing_m,
                                   .spacing_m = l.spacing_m,
                                   .seam_shift = -1};
        if (k == 0) m->level = l;
    }
    m->strip_rows = m->surface ? rows_apart : rows_plain;
    if (m->surface) plan_grid(&p->surface[0], m, m->level.spacing_m, NULL, 0);
    else if (m->cover.count) plan_grid(&p->surface[0], m, import_finest_m(&m->cover), &m->cover, 0);
    if (m->cover.count) plan_wide(&p->surface[1], m, 8 * fmax(p->surface[0].cell_m, import_finest_m(&m->cover)));
    if (m->photo.count) plan_grid(&p->albedo, m, import_finest_m(&m->photo), &m->photo, -3);
    if (m->photo.count && p->albedo.nx == 0) {
        log_error("terrain import: --photo: %s does not reach the terrain; leave it out, or name one of the place",
                  m->photo.raster[0].sheet[0].path);
        return STATUS_BAD_VALUE;
    }
    if (m->surface) {
        plan_grid(&p->canopy_height, m, 4, NULL, 0);
        p->canopy_cover = p->canopy_height;
    }
    if (m->canopy_height.count)
        plan_grid(&p->canopy_height, m, fmax(import_finest_m(&m->canopy_height), 4), &m->canopy_height, 0);
    if (m->canopy_cover.count)
        plan_grid(&p->canopy_cover, m, fmax(import_finest_m(&m->canopy_cover), 4), &m->canopy_cover, 0);
    ElevationReport e;
    Status          status = elevation_stream_report(&e, m->first, NULL);
    if (status == STATUS_OK) status = list_sources(m);
    if (status != STATUS_OK) return status;
    m->options = malloc(options_size);
    if (!m->options) return STATUS_NO_MEMORY;
    if (!terrain_options_text(m->options, options_size, m->o)) {
        log_error("%s: the names of the files are too long to be recorded; name their folder instead", module);
        return STATUS_BAD_VALUE;
    }
    status = look_at_buildings(m);
    if (status != STATUS_OK) return status;
    p->posting_m = e.posting_m;
    p->geoid_m = e.geoid_m;
    p->options = m->options;
    p->crs = "east, north, up at the origin, WGS 84";
    snprintf(m->datum, sizeof m->datum, "%s",
             e.ellipsoidal ? "files above the ellipsoid"
                           : "files above the geoid (EGM96 unless --geoid), converted at each post");
    p->vertical_datum = m->datum;
    snprintf(m->notes, sizeof m->notes, "%s%s%s%s",
             !m->surface ? "terrain model as it is" : "surface model taken apart ",
             !m->surface  ? ""
             : m->terrain ? "with the terrain model beside it: bare ground, crowns listed"
                          : "by its own shape: bare ground, crowns listed",
             !m->surface        ? ""
             : *m->o->buildings ? ", buildings beside it as records"
                                : ", roofs as blocks",
             "; where files overlap the finest wins, of equals the one given first");
    p->provenance = m->notes;
    return STATUS_OK;
}

/* Reports how much there is to do before it is done, and refuses more than is allowed or than the disk has room for.
 * Decoded rows are kept, where that is worthwhile, in what the store leaves of both. */
static Status say_size(StoreImport *m, const char *path)
{
    enum { reads_per_octet = 64 };
    const double   most = 1e9 * m->o->most_gb;
    uint64_t       octets = 0;
    double         px = 0, free_octets = INFINITY;
    struct statvfs disk;
    char           text[256];
    const Status   status = store_plan_octets(&octets, path, &m->plan);
    if (status != STATUS_OK) return status;
    if (m->surface) px += elevation_stream_reads_px(m->surface);
    if (m->terrain) px += elevation_stream_reads_px(m->terrain);
    if (statvfs(m->folder, &disk) == 0) free_octets = (double)disk.f_bavail * (double)disk.f_frsize;
    const double posts = (double)m->level.nx * m->level.ny, store = (double)octets;
    m->keep_octets = fmax(fmin(fmin(most - store, 0.5 * (free_octets - store)), sizeof(float) * px), 0);
    snprintf(
        text, sizeof text,
        "to do: %.1f M posts, %.3g m apart over %.2f x %.2f km; %.1f M pixels to read; %.2f GB to write, and at most %.2f GB of "
        "decoded rows meanwhile",
        1e-6 * posts, m->level.spacing_m, 1e-3 * m->level.nx * m->level.spacing_m,
        1e-3 * m->level.ny * m->level.spacing_m, 1e-6 * px, 1e-9 * store, 1e-9 * m->keep_octets);
    if (m->watch.progress && !m->watch.progress(m->watch.user, text, -1)) m->r.stopped = true;
    if (m->r.stopped) return STATUS_IO;
    if (store > most || sizeof(float) * px > reads_per_octet * most) {
        log_error(
            "%s: that is %.2f GB to write and %.2f GB to decode, more than %.3g and %.3g; --size takes a part, --spacing fewer "
            "posts, --horizon less around them, --most-gb allows more",
            module, 1e-9 * store, 1e-9 * sizeof(float) * px, m->o->most_gb, reads_per_octet * m->o->most_gb);
        return STATUS_BAD_VALUE;
    }
    if (store > free_octets) {
        log_error(
            "%s: that is %.2f GB to write, and %s has room for %.2f; -o names a store on another disk, --size takes a part",
            module, 1e-9 * store, m->folder, 1e-9 * free_octets);
        return STATUS_IO;
    }
    return STATUS_OK;
}

/* Makes the levels around level 0; all files are read once. */
static Status begin(StoreImport *m)
{
    const bool   both = m->surface && m->terrain;
    const double keep_octets = both ? 0.5 * m->keep_octets : m->keep_octets;
    Status       status = STATUS_OK;
    if (m->surface) status = elevation_stream_begin(m->surface, keep_octets);
    if (status == STATUS_OK && both && !go_on(m, "levels around", 0.5, true)) return STATUS_IO;
    if (status == STATUS_OK && m->terrain) status = elevation_stream_begin(m->terrain, keep_octets);
    return status;
}

/* ---- strips ---------------------------------------------------------------------------------- */

static Status count_kinds(StoreImport *m, int rows, const SurfaceStrip *strip)
{
    const size_t nx = (size_t)m->level.nx;
    Status       status = STATUS_OK;
    for (int r = 0; r < rows && status == STATUS_OK; r++) {
        const uint8_t *row = strip->kind + (size_t)r * nx;
        for (size_t i = 0; i < nx; i++) m->kinds[row[i] <= CELL_TREE ? row[i] : 0]++;
        status = terrain_buildings_count(&m->buildings, m->level.nx, row);
    }
    m->voids += strip->voids;
    m->voids_coarser += strip->voids_coarser;
    return status;
}

static Status make_strip(StoreImport *m, int row0, int rows)
{
    const SurfaceSources from = {m->surface, m->terrain, m->photo.count ? &m->photo : NULL,
                                 &m->frame,  m->pool,    *m->o->buildings != 0};
    SurfaceStrip         strip = {0};
    const double         begun_s = wall_clock_s();
    Status               status = STATUS_OK;
    if (m->surface) {
        status = surface_strip_make(&strip, &from, row0, rows);
        if (status == STATUS_OK) status = count_kinds(m, rows, &strip);
        if (status == STATUS_OK) status = import_buildings_add(&m->culture, &strip.culture);
    } else {
        strip.h_m = malloc((size_t)rows * (size_t)m->level.nx * sizeof *strip.h_m);
        status = STATUS_NO_MEMORY;
        if (strip.h_m) status = elevation_stream_heights(m->terrain, row0, rows, strip.h_m, NULL, true);
    }
    if (status == STATUS_OK) status = elevation_stream_bend(m->first, row0, rows, strip.h_m);
    const double posts_s = wall_clock_s();
    if (status == STATUS_OK) status = store_write_posts(m->writer, 0, rows, strip.h_m);
    free(strip.h_m);
    strip.h_m = NULL;
    const double written_s = wall_clock_s();
    if (status == STATUS_OK) status = import_cover(m, row0, rows, m->surface ? &strip : NULL);
    if (status == STATUS_OK) status = import_albedo(m, row0, rows);
    if (status == STATUS_OK) status = import_canopy(m, row0, rows, m->surface ? &strip : NULL);
    if (status == STATUS_OK && strip.crowns > 0) status = store_write_crowns(m->writer, strip.crowns, strip.crown);
    m->r.seconds[1] += posts_s - begun_s;
    m->r.seconds[3] += written_s - posts_s;
    m->r.seconds[2] += wall_clock_s() - written_s;
    surface_strip_free(&strip);
    return status;
}

static Status make_levels(StoreImport *m)
{
    Status status = STATUS_OK;
    for (int k = m->plan.level_count - 1; k >= 1 && status == STATUS_OK; k--) {
        StreamLevel l;
        elevation_stream_level(&l, m->first, k);
        status = store_write_posts(m->writer, k, l.ny, l.z_m);
    }
    if (status == STATUS_OK) status = import_canopy_look(m);
    if (status == STATUS_OK) status = import_cover_wide(m);
    for (int row0 = 0; row0 < m->level.ny && status == STATUS_OK; row0 += m->strip_rows) {
        if (!go_on(m, m->surface ? "taking apart" : "posts", (double)row0 / m->level.ny, false)) return STATUS_IO;
        status = make_strip(m, row0, m->level.ny - row0 < m->strip_rows ? m->level.ny - row0 : m->strip_rows);
    }
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static Status finish(StoreImport *m, const char *path)
{
    StoreWriter *writer = m->writer;
    TerrainStore store = {0};
    const double begun_s = wall_clock_s();
    m->writer = NULL;
    if (!go_on(m, "finishing", 1, true)) {
        store_writer_abandon(writer);
        return STATUS_IO;
    }
    Status status = store_writer_finish(writer, (uint64_t)m->buildings.count, &m->r.store);
    m->r.seconds[3] += wall_clock_s() - begun_s;
    if (status == STATUS_OK) status = store_open(&store, path);
    if (status == STATUS_OK)
        status = elevation_stream_report(&m->r.elevation, m->first, m->surface ? NULL : &store.elevation);
    if (status == STATUS_OK && *m->o->buildings) status = import_buildings_write(m, &store);
    if (m->surface) m->r.elevation.voids = m->voids, m->r.elevation.voids_coarser = m->voids_coarser;
    store_close(&store);
    double cells = 0, posts = 0;
    for (int s = 1; s < SURFACE_COUNT; s++) cells += m->r.cover.share[s];
    for (int s = 1; s < SURFACE_COUNT; s++) m->r.cover.share[s] /= cells > 0 ? cells : 1;
    for (int k = 0; k < 3; k++) posts += (double)m->kinds[k];
    for (int k = 0; k < 3; k++) m->r.kind_share[k] = (double)m->kinds[k] / (posts > 0 ? posts : 1);
    m->r.apart = m->surface != NULL;
    m->r.beside = m->surface && m->terrain;
    m->r.nx = m->level.nx;
    m->r.ny = m->level.ny;
    m->r.photo_posting_m = import_finest_m(&m->photo);
    return status;
}

Status terrain_import(TerrainReport *out, const TerrainOptions *options, const char *path, Pool *pool,
                      const TerrainWatch *watch)
{
    StoreImport *m = calloc(1, sizeof *m);
    if (!m) return STATUS_NO_MEMORY;
    m->o = options;
    m->pool = pool;
    if (watch) m->watch = *watch;
    const char *slash = strrchr(path, '/');
    snprintf(m->folder, sizeof m->folder, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
    const double begun_s = wall_clock_s();
    const char  *fault = terrain_options_fault(options);
    char        *sources = strdup(raster_sources());
    if (*options->sources_from) raster_sources_from(options->sources_from);
    if (m->watch.progress) work_stop_when(file_stop_asked);
    Status status = fault ? STATUS_BAD_VALUE : STATUS_OK;
    if (fault) log_error("%s: %s", module, fault);
    if (status == STATUS_OK && !go_on(m, "levels around", 0, true)) status = STATUS_IO;
    if (status == STATUS_OK) status = open_sources(m);
    if (status == STATUS_OK) status = plan(m);
    if (status == STATUS_OK) status = say_size(m, path);
    if (status == STATUS_OK) status = begin(m);
    if (status == STATUS_OK) status = store_writer_create(&m->writer, path, &m->plan, pool);
    m->r.seconds[0] = wall_clock_s() - begun_s;
    if (status == STATUS_OK) status = make_levels(m);
    if (status == STATUS_OK) status = finish(m, path);
    store_writer_abandon(m->writer);
    m->r.stopped |= status != STATUS_OK && m->watch.progress && file_stop_asked();
    *out = m->r;
    elevation_stream_close(m->terrain);
    elevation_stream_close(m->surface);
    raster_set_close(&m->opened);
    raster_set_close(&m->cover);
    raster_set_close(&m->photo);
    raster_set_close(&m->canopy_height);
    raster_set_close(&m->canopy_cover);
    free(m->source);
    for (int k = 0; k < 2; k++) free(m->list[k]);
    free(m->options);
    terrain_buildings_free(&m->buildings);
    culture_free(&m->culture);
    if (sources) raster_sources_from(sources);
    work_stop_when(NULL);
    free(sources);
    free(m);
    return status;
}
