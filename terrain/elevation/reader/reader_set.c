/* terrain/elevation/reader/reader_set.c: sets of files as GDAL has them: which of their sheets share a grid. */
#include "terrain/elevation/reader/reader_private.h"

#include <cpl_string.h>
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>

enum { most_sheets = 4096, path_size = wire_path_size };

/* ---- grids ---------------------------------------------------------------------------------- */

/* Whether two choices are the same except for the band, which each sheet has for itself. */
static bool same_choice(const RasterChoice *a, const RasterChoice *b)
{
    return a->vertical == b->vertical && strcmp(a->unit, b->unit) == 0 && a->sense == b->sense &&
           a->has_void == b->has_void && a->no_void == b->no_void && a->void_value == b->void_value &&
           (a->band != 0) == (b->band != 0);
}

static bool same_grid(const Raster *raster, const SheetOpened *o, double at_px[2])
{
    const double *a = raster->crs_from_px, *b = o->transform;
    if (!OSRIsSame(raster->crs, o->crs) || raster->ellipsoidal != o->ellipsoidal || raster->bytes != o->bytes ||
        raster->bands != o->bands || raster->metres_per_unit != o->metres_per_unit ||
        strcmp(raster->stated.unit, o->stated.unit) != 0 || raster->stated.coloured != o->stated.coloured ||
        raster->stated.grey != o->stated.grey || !same_choice(&raster->choice, &o->choice))
        return false;
    static const int terms[4] = {1, 2, 4, 5};
    for (int k = 0; k < 4; k++)
        if (!(fabs(a[terms[k]] - b[terms[k]]) <= 1e-6 * (fabs(a[1]) + fabs(a[2])))) return false;
    const double  dx = b[0] - a[0], dy = b[3] - a[3];
    const double *to = raster->px_from_crs;
    at_px[0] = to[1] * dx + to[2] * dy;
    at_px[1] = to[4] * dx + to[5] * dy;
    if (raster->whole_turn_px > 0) at_px[0] -= raster->whole_turn_px * rint(at_px[0] / raster->whole_turn_px);
    return fabs(at_px[0] - rint(at_px[0])) < 0.01 && fabs(at_px[1] - rint(at_px[1])) < 0.01 && fabs(at_px[0]) < 1e8 &&
           fabs(at_px[1]) < 1e8;
}

static Status start_raster(Raster *raster, SheetOpened *o)
{
    OGRSpatialReferenceH earth = OSRNewSpatialReference(NULL);
    Status               status = STATUS_BAD_VALUE;
    memcpy(raster->crs_from_px, o->transform, sizeof o->transform);
    raster->bands = o->bands;
    raster->ellipsoidal = o->ellipsoidal;
    raster->metres_per_unit = o->metres_per_unit;
    raster->bytes = o->bytes;
    raster->whole = o->whole;
    raster->stated = o->stated;
    raster->choice = o->choice;
    raster->low = -INFINITY;
    raster->high = INFINITY;
    raster->row_block = o->row_block;
    raster->crs = o->crs;
    o->crs = NULL;
    if (OSRIsGeographic(raster->crs)) {
        double turn = 2 * pi_rad / OSRGetAngularUnits(raster->crs, NULL);
        raster->whole_turn_px = fabs(turn / raster->crs_from_px[1]);
        if (!isfinite(raster->whole_turn_px)) raster->whole_turn_px = 0;
    }
    if (earth && OSRImportFromEPSG(earth, 4326) == OGRERR_NONE) {
        OSRSetAxisMappingStrategy(earth, OAMS_TRADITIONAL_GIS_ORDER);
        raster->crs_from_earth = OCTNewCoordinateTransformation(earth, raster->crs);
        raster->earth_from_crs = OCTNewCoordinateTransformation(raster->crs, earth);
        if (raster->crs_from_earth && raster->earth_from_crs &&
            GDALInvGeoTransform(raster->crs_from_px, raster->px_from_crs))
            status = STATUS_OK;
    }
    if (earth) OSRDestroySpatialReference(earth);
    return status;
}

/* Whether a file, and the files it names (as a VRT does), may be opened. Those that these name in turn are checked
 * where nothing else stops them. */
static bool parts_may_be_opened(GDALDatasetH file, const char *path, const char *owner, const char *key, int depth)
{
    char **parts = GDALGetFileList(file);
    bool   good = depth < 8;
    for (int k = 0; good && parts && parts[k]; k++) {
        if (strcmp(parts[k], path) == 0) continue;
        good = reader_part_allowed(parts[k], owner, key);
        const bool   list = strlen(parts[k]) > 4 && strcasecmp(parts[k] + strlen(parts[k]) - 4, ".vrt") == 0;
        GDALDatasetH part = good && (list || reader_by_name) ? GDALOpen(parts[k], GA_ReadOnly) : NULL;
        if (part) good = parts_may_be_opened(part, parts[k], owner, key, depth + 1);
        if (part) GDALClose(part);
    }
    CSLDestroy(parts);
    return good;
}

/* gzip and zip files are read through GDAL's own names for what is in them. */
static const char *remedy(char out[path_size + 80], const char *path)
{
    const char *foreign = reader_foreign(path);
    if (foreign) return foreign;
    const char *ending = strrchr(path, '.');
    const bool  gzip = ending && strcasecmp(ending, ".gz") == 0, zip = ending && strcasecmp(ending, ".zip") == 0;
    if (gzip) snprintf(out, path_size + 80, "name it /vsigzip/%s, or gunzip it", path);
    else if (zip) snprintf(out, path_size + 80, "name what is in it, /vsizip/%s/NAME.tif, or unzip it", path);
    else snprintf(out, path_size + 80, "gdalinfo %s says what it is", path);
    return out;
}

static Status add_sheet(RasterSet *set, const char *name, const RasterChoice *choice, const char *key)
{
    SheetOpened o = {0};
    Status      status = STATUS_IO;
    double      at_px[2] = {0, 0};
    char        path[path_size], next[path_size + 80];
    snprintf(path, sizeof path, "%s", name);
    if (!reader_file_allowed(path, key)) return STATUS_IO;
    reader_works_at(path);
    GDALDatasetH file = GDALOpen(path, GA_ReadOnly);
    if (!file) {
        log_error("%s: cannot read %s: %s; %s", key, path, reader_reason("not a raster GDAL knows"),
                  remedy(next, path));
        return STATUS_IO;
    }
    if (*choice->part || (GDALGetRasterCount(file) < 1 && GDALGetMetadata(file, "SUBDATASETS"))) {
        const bool chosen =
            parts_may_be_opened(file, path, path, key, 0) && reader_choose_part(path, file, choice->part, key);
        GDALClose(file);
        if (!chosen) return STATUS_BAD_VALUE;
        file = GDALOpen(path, GA_ReadOnly);
        if (!file) {
            log_error("%s: cannot read %s: %s", key, path, reader_reason("not a raster GDAL knows"));
            return STATUS_IO;
        }
    }
    status = parts_may_be_opened(file, path, name, key, 0) ? reader_describe(&o, file, choice, path, key) : STATUS_IO;
    const double data_px = status == STATUS_OK ? reader_data_px(file) : 0;
    GDALClose(file);
    if (status != STATUS_OK) return status;

    Raster *raster = NULL;
    for (int k = 0; !raster && k < set->count; k++)
        if (same_grid(&set->raster[k], &o, at_px)) raster = &set->raster[k];
    if (!raster) {
        Raster *more = realloc(set->raster, ((size_t)set->count + 1) * sizeof *more);
        if (!more) {
            status = STATUS_NO_MEMORY;
            goto done;
        }
        set->raster = more;
        raster = &set->raster[set->count++];
        *raster = (Raster){.order = set->count};
        at_px[0] = at_px[1] = 0;
        status = start_raster(raster, &o);
        if (status != STATUS_OK) {
            log_error("%s: no way from WGS 84 to the coordinate system of %s: %s; gdalwarp -t_srs EPSG:4326 %s OUT.tif",
                      key, path, reader_reason("unknown to PROJ"), path);
            goto done;
        }
    }
    RasterSheet *sheets = realloc(raster->sheet, ((size_t)raster->sheet_count + 1) * sizeof *sheets);
    if (!sheets) {
        status = STATUS_NO_MEMORY;
        goto done;
    }
    raster->sheet = sheets;
    sheets[raster->sheet_count] =
        (RasterSheet){strdup(path), (int)lrint(at_px[0]), (int)lrint(at_px[1]), o.width, o.height, o.choice.band, NULL};
    raster->data_share += data_px;
    if (o.row_block > raster->row_block) raster->row_block = o.row_block;
    if (sheets[raster->sheet_count].path) raster->sheet_count++;
    else status = STATUS_NO_MEMORY;
done:
    if (o.crs) OSRDestroySpatialReference(o.crs);
    return status;
}

/* Makes the outermost corner pixel (0, 0). */
static Status finish_raster(Raster *raster)
{
    int x0 = raster->sheet[0].x0, y0 = raster->sheet[0].y0, x1 = x0, y1 = y0;
    for (int k = 0; k < raster->sheet_count; k++) {
        const RasterSheet *s = &raster->sheet[k];
        x0 = s->x0 < x0 ? s->x0 : x0;
        y0 = s->y0 < y0 ? s->y0 : y0;
        x1 = s->x0 + s->width > x1 ? s->x0 + s->width : x1;
        y1 = s->y0 + s->height > y1 ? s->y0 + s->height : y1;
    }
    for (int k = 0; k < raster->sheet_count; k++) {
        raster->sheet[k].x0 -= x0;
        raster->sheet[k].y0 -= y0;
    }
    raster->width = x1 - x0;
    raster->height = y1 - y0;
    raster->data_share = fmin(raster->data_share / ((double)raster->width * raster->height), 1);
    raster->sparse = raster->data_share < 1 - 1e-12;
    double *t = raster->crs_from_px;
    t[0] += x0 * t[1] + y0 * t[2];
    t[3] += x0 * t[4] + y0 * t[5];
    if (!GDALInvGeoTransform(t, raster->px_from_crs)) return STATUS_BAD_VALUE;

    const double cx = 0.5 * raster->width, cy = 0.5 * raster->height;
    double       x[3] = {cx, cx + 1, cx}, y[3] = {cy, cy, cy + 1}, p_ecef[3][3];
    reader_earth_from_px(raster, 3, x, y);
    for (int k = 0; k < 3; k++) {
        const Geodetic place = {.lat_rad = y[k], .lon_rad = x[k]};
        const Status   status = ecef_from_geodetic(p_ecef[k], NULL, &place);
        if (status != STATUS_OK) return status;
    }
    for (int k = 0; k < 2; k++) {
        double d[3];
        v3_sub(d, p_ecef[k + 1], p_ecef[0]);
        raster->posting_m[k] = v3_length(d);
    }
    return raster->posting_m[0] > 0 && raster->posting_m[1] > 0 ? STATUS_OK : STATUS_BAD_VALUE;
}

/* ---- lists of files ------------------------------------------------------------------------- */

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static Status add_folder(RasterSet *set, const char *path, const RasterChoice *choice, const char *key)
{
    char **name = NULL, full[path_size];
    int    names = 0, used = 0;
    Status status = STATUS_OK;
    DIR   *folder = opendir(path);
    if (!folder) {
        log_error("%s: cannot read the folder %s: %s", key, path, strerror(errno));
        return STATUS_IO;
    }
    for (struct dirent *entry; status == STATUS_OK && (entry = readdir(folder));) {
        struct stat about;
        const int   n = snprintf(full, sizeof full, "%s/%s", path, entry->d_name);
        if (n < 0 || n >= (int)sizeof full || stat(full, &about) != 0 || !S_ISREG(about.st_mode)) continue;
        if (!reader_file_allowed(full, key)) {
            status = STATUS_IO;
            break;
        }
        if (!GDALIdentifyDriver(full, NULL))
            continue; /* the file is not a raster but notes, a world file, an overview's sidecar */
        char **more = names < most_sheets ? realloc(name, ((size_t)names + 1) * sizeof *name) : NULL;
        if (more) name = more;
        if (!more || !(name[names] = strdup(full))) status = STATUS_NO_MEMORY;
        else names++;
    }
    closedir(folder);
    if (names > 0) qsort(name, (size_t)names, sizeof *name, by_name);
    for (int k = 0; k < names; k++) {
        if (status == STATUS_OK) status = add_sheet(set, name[k], choice, key);
        used++;
        free(name[k]);
    }
    free(name);
    if (status == STATUS_OK && used == 0) {
        const char *foreign = reader_foreign(path);
        log_error("%s: the folder %s holds nothing that GDAL reads; %s", key, path,
                  foreign ? foreign : "gdalinfo --formats lists what it does");
        status = STATUS_BAD_VALUE;
    }
    return status;
}

static int finer_first(const void *a, const void *b)
{
    const Raster *p = a, *q = b;
    /* postings within a hundredth count as equal, since a posting in degrees changes along the meridian */
    const double x = rint(100 * log(fmax(p->posting_m[0], p->posting_m[1]))),
                 y = rint(100 * log(fmax(q->posting_m[0], q->posting_m[1])));
    if (x != y) return x < y ? -1 : 1;
    return p->order < q->order ? -1 : p->order > q->order;
}

/* Allocates room for handles, unless that takes more files than a process may have open. */
static void keep_open(RasterSet *set)
{
    int sheets = 0;
    for (int k = 0; k < set->count; k++) sheets += set->raster[k].sheet_count;
    for (int k = 0; sheets <= most_open_sheets && k < set->count; k++)
        for (int n = 0; n < set->raster[k].sheet_count; n++) {
            RasterOpen *open = set->raster[k].sheet[n].open = calloc(1, sizeof *open);
            for (int h = 0; open && h < handles; h++) pthread_mutex_init(&open->lock[h], NULL);
        }
}

static void close_handles(RasterOpen *open)
{
    for (int h = 0; open && h < handles; h++) {
        if (open->file[h]) GDALClose(open->file[h]);
        pthread_mutex_destroy(&open->lock[h]);
    }
    free(open);
}

bool reader_next_name(char out[wire_path_size], const char **at, bool *long_name)
{
    while (**at) {
        const size_t length = strcspn(*at, ",");
        size_t       skip = strspn(*at, " "), end = length;
        if (skip > length) skip = length;
        while (end > skip && (*at)[end - 1] == ' ') end--;
        const int n = snprintf(out, wire_path_size, "%.*s", (int)(end - skip), *at + skip);
        *at += length + ((*at)[length] == ',');
        *long_name |= n >= wire_path_size;
        if (n > 0) return n < wire_path_size;
    }
    return false;
}

static void reader_set_close(RasterSet *set)
{
    for (int k = 0; k < set->count; k++) {
        Raster *raster = &set->raster[k];
        for (int n = 0; n < raster->sheet_count; n++) {
            close_handles(raster->sheet[n].open);
            free(raster->sheet[n].path);
        }
        free(raster->sheet);
        if (raster->crs_from_earth) OCTDestroyCoordinateTransformation(raster->crs_from_earth);
        if (raster->earth_from_crs) OCTDestroyCoordinateTransformation(raster->earth_from_crs);
        if (raster->crs) OSRDestroySpatialReference(raster->crs);
    }
    free(set->raster);
    *set = (RasterSet){0};
}

Status reader_set_open(RasterSet *out, const char *paths, const char *key)
{
    RasterSet set = {0};
    Status    status = STATUS_OK;
    char      path[path_size];
    bool      too_long = false;
    reader_quiet();
    for (const char *at = paths; status == STATUS_OK && reader_next_name(path, &at, &too_long);) {
        struct stat  about;
        RasterChoice choice;
        const char  *why = NULL;
        char         name[path_size];
        memcpy(name, path, sizeof name);
        if (!raster_choice_take(&choice, &why, path)) {
            log_error("%s: %s: %s", key, name, why);
            status = STATUS_BAD_VALUE;
        } else if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) status = add_folder(&set, path, &choice, key);
        else status = add_sheet(&set, path, &choice, key);
    }
    if (too_long && status == STATUS_OK) status = STATUS_BAD_VALUE;
    for (int k = 0; status == STATUS_OK && k < set.count; k++) {
        status = finish_raster(&set.raster[k]);
        if (status != STATUS_OK)
            log_error("%s: %s does not lie on the Earth; gdalinfo says its corners", key, set.raster[k].sheet[0].path);
    }
    if (status == STATUS_OK && set.count == 0) {
        log_error("%s: names no file", key);
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) qsort(set.raster, (size_t)set.count, sizeof *set.raster, finer_first);
    if (status == STATUS_OK) keep_open(&set);
    reader_loud();
    if (status == STATUS_OK) *out = set;
    else reader_set_close(&set);
    return status;
}
