/* terrain/store/store_write.c: a terrain store written: the file at its full size, its rasters, and its end. */
#include "pitviper_output.h"
#include "terrain/ground/landscape_parts.h"
#include "terrain/store/store_writer_private.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

bool store_source_look(StoreSource *source)
{
    struct stat about;
    if (stat(source->path, &about) != 0) return false;
    source->octets = about.st_size;
    source->mtime_ns = (int64_t)about.st_mtim.tv_sec * 1000000000 + about.st_mtim.tv_nsec;
    return true;
}

/* a fine step costs nothing: a tile's shift adapts to its relief */
static const double store_step_m = 0x1p-11;

/* ---- the plan ------------------------------------------------------------------------------------ */

/* Relief over one tile that the default of seam_shift holds: a mean slope of 56 degrees. */
static int default_seam_shift(const StoreLevel *level)
{
    const double relief_m = 1.5 * elevation_tile_cells * level->spacing_m;
    int          shift = 0;
    while (shift < elevation_most_shift && ldexp(level->step_m, shift) * (65535 - 2 * elevation_base_unit) < relief_m)
        shift++;
    return shift;
}

static bool is_power_of_two(double x)
{
    int exponent;
    return x > 0 && isfinite(x) && frexp(x, &exponent) == 0.5;
}

/* How far the ellipsoid lies below the plane of the posts at the corner of a level farthest from its origin. The radius
 * is that at the pole, where the ellipsoid curves least, so that no level is refused that fits. */
static double deepest_m(const StoreHeaderLevel *l)
{
    static const double radius_m = 6.4e6;
    const double        x_m = fmax(-l->x0_m, l->x0_m + (l->nx - 1) * l->spacing_m),
                 y_m = fmax(-l->y0_m, l->y0_m + (l->ny - 1) * l->spacing_m);
    const double far_m = fmin(hypot(x_m, y_m), radius_m);
    return radius_m - sqrt(radius_m * radius_m - far_m * far_m);
}

static const char *plan_fault(const StorePlan *plan, const StoreHeader *h)
{
    for (int n = 0; n < plan->level_count; n++) {
        const double z0 = h->level[n].z0_m;
        const bool   even = z0 == h->level[0].z0_m || z0 == 64 * rint(z0 / 64);
        if (!is_power_of_two(h->level[n].step_m) || !even) return "steps or origins are not dyadic";
        if (deepest_m(&h->level[n]) > fabs(z0) + 9000 + h->level[n].step_m * elevation_highest_post)
            return "it reaches so far that the ground sinks more than 16 km below the plane at its origin; --size takes a part, "
                   "--horizon less around it";
        if (n > 0 && !is_power_of_two(rint(h->level[n].spacing_m / h->level[n - 1].spacing_m)))
            return "the spacings of two levels are not in the ratio of a power of two";
    }
    return NULL;
}

/* Writes a text of the header with its 0. */
static void put_text(FILE *to, StoreHeader *h, StoreText text, const char *value)
{
    const char *it = value ? value : "";
    fwrite(it, 1, strlen(it) + 1, to);
    h->text[text] = (uint32_t)strlen(it) + 1;
}

static void put_sources(FILE *to, StoreHeader *h, const StorePlan *plan)
{
    const long from = ftell(to);
    for (int k = 0; k < plan->source_count; k++)
        fprintf(to, "%lld %lld %s\n", (long long)plan->source[k].octets, (long long)plan->source[k].mtime_ns,
                plan->source[k].path);
    fputc(0, to);
    h->text[STORE_SOURCES] = (uint32_t)(ftell(to) - from);
}

/* Makes the header, as far as it is known, with its texts. */
static Status make_header(StoreHeader **out, const StorePlan *plan)
{
    char  *octets = NULL;
    size_t count = 0;
    char  *record = store_record(plan->options ? plan->options : "");
    FILE  *to = record ? open_memstream(&octets, &count) : NULL;
    if (!to) {
        free(record);
        return STATUS_NO_MEMORY;
    }
    StoreHeader h = {.version = store_version,
                     .classes = SURFACE_COUNT,
                     .lat_rad = plan->origin.lat_rad,
                     .lon_rad = plan->origin.lon_rad,
                     .h_m = plan->origin.h_m,
                     .posting_m = plan->posting_m,
                     .geoid_m = plan->geoid_m,
                     .level_count = plan->level_count,
                     .albedo = plan->albedo,
                     .canopy_height = plan->canopy_height,
                     .canopy_cover = plan->canopy_cover};
    memcpy(h.magic, store_magic, sizeof h.magic);
    memcpy(h.surface, plan->surface, sizeof h.surface);
    for (int n = 0; n < plan->level_count && n < elevation_max_levels; n++) {
        const StoreLevel *l = &plan->level[n];
        h.level[n] = (StoreHeaderLevel){.nx = l->nx,
                                        .ny = l->ny,
                                        .x0_m = l->x0_m,
                                        .y0_m = l->y0_m,
                                        .spacing_m = l->spacing_m,
                                        .z0_m = l->z0_m,
                                        .step_m = l->step_m > 0 ? l->step_m : store_step_m};
    }
    fwrite(&h, sizeof h, 1, to);
    put_sources(to, &h, plan);
    put_text(to, &h, STORE_OPTIONS, record);
    free(record);
    put_text(to, &h, STORE_CRS, plan->crs);
    put_text(to, &h, STORE_DATUM, plan->vertical_datum);
    put_text(to, &h, STORE_PROVENANCE, plan->provenance);
    const long end = ftell(to), padded = (end + store_page - 1) / store_page * store_page;
    for (long n = end; n < padded; n++) fputc(0, to);
    h.header_octets = (uint64_t)padded;
    const bool whole = !ferror(to);
    if (fclose(to) != 0 || !whole) {
        free(octets);
        return STATUS_NO_MEMORY;
    }
    memcpy(octets, &h, sizeof h);
    *out = (StoreHeader *)(void *)octets;
    return STATUS_OK;
}

/* ---- the file ------------------------------------------------------------------------------------ */

static Status io_fault(const StoreWriter *w, const char *what)
{
    log_error("store: cannot %s %s: %s%s", what, w->part, strerror(errno),
              errno == ENOSPC ? "; free some space, or name a file on another disk" : "");
    return STATUS_IO;
}

/* Opens and locks the file to be written: of two writers of one store the second stops. */
static Status open_part(StoreWriter *w)
{
    w->file = output_check(w->path, 0) == 0 ? output_open(w->part, OUTPUT_READ) : -1;
    if (w->file < 0) {
        log_error("store: cannot write %s: %s%s", w->path, output_reason(errno),
                  errno == EBUSY ? "; wait until it is done" : "");
        return STATUS_IO;
    }
    const uint64_t octets = w->header->file_octets;
    const int      full =
        posix_fallocate(w->file, 0, (off_t)octets); /* a full disk is found here, and not by SIGBUS later */
    if (full != 0) {
        errno = full;
        return io_fault(w, "reserve the space of");
    }
    void *map = mmap(NULL, octets, PROT_READ | PROT_WRITE, MAP_SHARED, w->file, 0);
    if (map == MAP_FAILED) return io_fault(w, "map");
    w->map = map;
    w->map_octets = w->end = octets;
    return STATUS_OK;
}

/* Sets where levels and photograph will be in the map. */
static Status begin(StoreWriter *w, const StorePlan *plan)
{
    TerrainStore at;
    store_attach(&at, w->header, w->map);
    w->elevation = at.elevation;
    w->photo = at.photo;
    Status status = STATUS_OK;
    for (int n = 0; n < w->elevation.level_count && status == STATUS_OK; n++) {
        StoreLevel level = plan->level[n];
        level.step_m = w->header->level[n].step_m;
        status = store_posts_begin(w, n, level.seam_shift >= 0 ? level.seam_shift : default_seam_shift(&level));
    }
    return status == STATUS_OK ? store_albedo_begin(w) : status;
}

/* Makes the header of a plan and lays out its sections; logs what no store can hold. */
static Status plan_header(StoreHeader **out, const char *path, const StorePlan *plan)
{
    const char *why = NULL;
    Status      status = make_header(out, plan);
    if (status != STATUS_OK) return status;
    StoreHeader *h = *out;
    why = plan_fault(plan, h);
    if (!why && !store_layout(h)) why = "its sizes are out of range";
    h->checksum = store_checksum(h);
    if (!why) store_header_check(&why, h, (size_t)h->header_octets, h->file_octets);
    if (why) log_error("store: %s cannot be written: %s", path, why);
    return why ? STATUS_BAD_VALUE : STATUS_OK;
}

Status store_plan_octets(uint64_t *octets, const char *path, const StorePlan *plan)
{
    StoreHeader *h = NULL;
    const Status status = plan_header(&h, path, plan);
    if (status == STATUS_OK) *octets = h->file_octets;
    free(h);
    return status;
}

Status store_writer_create(StoreWriter **out, const char *path, const StorePlan *plan, Pool *pool)
{
    *out = NULL;
    StoreWriter *w = calloc(1, sizeof *w);
    if (!w) return STATUS_NO_MEMORY;
    w->file = -1;
    w->pool = pool;
    w->seed = plan->seed;
    const bool named = asprintf(&w->part, "%s.tmp", path) > 0 && (w->path = strdup(path)) != NULL;
    Status     status = named ? plan_header(&w->header, path, plan) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = open_part(w);
    if (status == STATUS_OK) status = begin(w, plan);
    if (status == STATUS_OK) *out = w;
    else store_writer_abandon(w);
    return status;
}

static void free_writer(StoreWriter *w)
{
    store_posts_end(w);
    store_albedo_end(w);
    if (w->map) munmap(w->map, w->map_octets);
    if (w->file >= 0) close(w->file);
    free(w->header);
    free(w->part);
    free(w->path);
    free(w);
}

void store_writer_abandon(StoreWriter *w)
{
    if (!w) return;
    if (w->file >= 0) output_remove(w->part);
    free_writer(w);
}

/* ---- rasters ---------------------------------------------------------------------------------------- */

/* A raster of octets, none above `most`. */
typedef struct OctetRaster {
    const StoreGrid *grid;
    int              section, most;
    int             *done; /* rows */
    const char      *what;
} OctetRaster;

/* Writes the next rows of a raster. */
static Status write_rows(StoreWriter *w, const OctetRaster *to, int rows, const uint8_t *value)
{
    const StoreGrid *grid = to->grid;
    const size_t     count = (size_t)(rows > 0 ? rows : 0) * (size_t)grid->nx;
    unsigned         bad = 0;
    if (rows < 0 || rows > grid->ny - *to->done) {
        log_error("store: %s: too many rows of the %s", w->path, to->what);
        return STATUS_BAD_VALUE;
    }
    for (size_t n = 0; n < count; n++) bad |= value[n] > to->most;
    if (bad) {
        log_error("store: %s: a value of the %s is above %d", w->path, to->what, to->most);
        return STATUS_BAD_VALUE;
    }
    memcpy(w->map + w->header->section[to->section].offset + (size_t)*to->done * (size_t)grid->nx, value, count);
    *to->done += rows;
    return STATUS_OK;
}

Status store_write_surface(StoreWriter *w, int window, int rows, const uint8_t *surface)
{
    if (window < 0 || window >= cover_windows) return STATUS_BAD_VALUE;
    const OctetRaster to = {&w->header->surface[window], STORE_SURFACE + window, SURFACE_COUNT - 1,
                            &w->surface_rows[window], "classes"};
    return write_rows(w, &to, rows, surface);
}

Status store_write_canopy_height(StoreWriter *w, int rows, const uint8_t *height)
{
    const OctetRaster to = {&w->header->canopy_height, STORE_CANOPY_HEIGHT, 255, &w->canopy_height_rows,
                            "canopy height"};
    return write_rows(w, &to, rows, height);
}

Status store_write_canopy_cover(StoreWriter *w, int rows, const uint8_t *cover)
{
    const OctetRaster to = {&w->header->canopy_cover, STORE_CANOPY_COVER, 100, &w->canopy_cover_rows, "canopy cover"};
    return write_rows(w, &to, rows, cover);
}

Status store_write_crowns(StoreWriter *w, int count, const Crown *crown)
{
    const uint8_t *at = (const uint8_t *)crown;
    size_t         left = (size_t)(count > 0 ? count : 0) * sizeof *crown;
    w->crowns += (uint64_t)(count > 0 ? count : 0);
    while (left > 0) {
        const ssize_t put = pwrite(w->file, at, left, (off_t)w->end);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return io_fault(w, "write");
        at += put;
        left -= (size_t)put;
        w->end += (uint64_t)put;
    }
    return STATUS_OK;
}

/* ---- the end ---------------------------------------------------------------------------------------- */

static const char *missing(const StoreWriter *w)
{
    const StoreHeader *h = w->header;
    for (int n = 0; n < h->level_count; n++)
        if (w->posts[n].done < h->level[n].ny) return "posts";
    for (int n = 0; n < cover_windows; n++)
        if (w->surface_rows[n] < h->surface[n].ny) return "classes";
    if (w->photo.mips && w->mip[0].done < w->photo.ny[0]) return "the photograph";
    if (w->canopy_height_rows < h->canopy_height.ny) return "canopy heights";
    return w->canopy_cover_rows < h->canopy_cover.ny ? "canopy covers" : NULL;
}

/* Sets the file to its final length, and maps it whole. */
static Status extend(StoreWriter *w)
{
    w->header->crown_count = w->crowns;
    if (!store_layout(w->header)) return STATUS_BAD_VALUE;
    const uint64_t octets = w->header->file_octets;
    if (ftruncate(w->file, (off_t)octets) != 0) return io_fault(w, "write");
    munmap(w->map, w->map_octets);
    void *map = mmap(NULL, octets, PROT_READ | PROT_WRITE, MAP_SHARED, w->file, 0);
    w->map = map == MAP_FAILED ? NULL : map;
    if (!w->map) return io_fault(w, "map");
    w->map_octets = octets;
    return STATUS_OK;
}

/* Measures the photograph's means over each class, with the store's own landscape. */
static Status measure_photo(StoreWriter *w)
{
    TerrainStore store;
    store_attach(&store, w->header, w->map);
    const Geodetic origin = {w->header->lat_rad, w->header->lon_rad, w->header->h_m};
    Status         status = local_frame_at(&store.frame, &origin);
    if (status != STATUS_OK || store.photo.mips == 0) return status;
    Landscape landscape;
    status = store_landscape(&landscape, &store, w->seed, NULL);
    if (status != STATUS_OK) return status;
    landscape_photo_means(w->header->mean, &landscape); /* sets the first of store_classes rows */
    landscape_destroy(&landscape);
    return STATUS_OK;
}

static void date(char out[32])
{
    const time_t now = time(NULL);
    struct tm    utc;
    gmtime_r(&now, &utc);
    strftime(out, 32, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

/* Syncs the folder as well, so that the new name survives a loss of power. */
static void sync_folder(const char *path)
{
    char *folder = strdup(path), *slash = folder ? strrchr(folder, '/') : NULL;
    if (slash) slash[slash == folder] = 0;
    const int fd = folder ? open(slash ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (fd >= 0) {
        fsync(fd); /* advisory: the file itself is safe already */
        close(fd);
    }
    free(folder);
}

static Status seal(StoreWriter *w)
{
    enum { synced_at_once = 64 << 20 }; /* octets that are synced at once, which a stop must wait for */
    StoreHeader *h = w->header;
    if (work_stop_asked()) return STATUS_IO;
    h->content = store_content(h, w->map, w->pool);
    date(h->made);
    h->checksum = store_checksum(h);
    memcpy(w->map, h, (size_t)h->header_octets);
    for (size_t at = 0; at < w->map_octets; at += synced_at_once) {
        const size_t left = w->map_octets - at;
        if (work_stop_asked()) return STATUS_IO;
        if (msync((char *)w->map + at, left < synced_at_once ? left : synced_at_once, MS_SYNC) != 0)
            return io_fault(w, "write");
    }
    if (fsync(w->file) != 0) return io_fault(w, "write");
    if (output_rename(w->part, w->path) != 0) {
        log_error("store: cannot rename %s to %s: %s", w->part, w->path, strerror(errno));
        return STATUS_IO;
    }
    sync_folder(w->path);
    return STATUS_OK;
}

Status store_writer_finish(StoreWriter *w, uint64_t buildings, StoreReport *report)
{
    const char *lacks = missing(w);
    if (lacks) log_error("store: %s: not all %s were written", w->path, lacks);
    w->header->building_count = buildings;
    Status status = lacks ? STATUS_BAD_VALUE : extend(w);
    if (status == STATUS_OK) status = measure_photo(w);
    if (status == STATUS_OK) status = seal(w);
    if (status != STATUS_OK) {
        store_writer_abandon(w);
        return status;
    }
    if (report) {
        *report = (StoreReport){.octets = w->header->file_octets, .crowns = w->crowns, .buildings = buildings};
        for (int n = 0; n < w->header->level_count; n++) {
            report->step_m[n] = w->header->level[n].step_m;
            report->worst_m[n] = w->header->level[n].worst_m;
        }
    }
    free_writer(w);
    return STATUS_OK;
}
