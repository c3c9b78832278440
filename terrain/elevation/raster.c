/* terrain/elevation/raster.c: the interface to GDAL. Its messages are captured, not printed: one log line has them,
 * with a remedy. */
#include "terrain/elevation/raster.h"

#include "terrain/elevation/gdal_library.h"
#include "terrain/elevation/raster_source.h"
#include "terrain/elevation/raster_stated.h"

#include <strings.h>
#include <cpl_conv.h>
#include <cpl_string.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <gdal.h>
#include <limits.h>
#include <ogr_srs_api.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* most_side: of a sheet, px; sheets lie within 1e8 px of the first, so that sums stay in an int */
enum { most_sheets = 4096, path_size = 4096, most_side = 100000000 };

/* Handles of one file, so that threads read at once and GDAL's cache of blocks lasts from one read to the next. */
enum { handles = 8, most_open_sheets = 48 };
typedef struct RasterOpen {
    pthread_mutex_t lock[handles];
    GDALDatasetH    file[handles];
} RasterOpen;

static pthread_once_t once = PTHREAD_ONCE_INIT;

static void register_drivers(void)
{
    static const GIntBig most_cache = 256 << 20; /* octets; by default a twentieth of the memory */
    /* A file may name others (VRT): none makes this program ask a server. */
    CPLSetConfigOption("GDAL_SKIP", "HTTP,WMS,WMTS,WCS,DAAS,EEDA,EEDAI,PLMosaic,NGW,OGCAPI,STACTA,STACIT,PostGISRaster");
    CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", "none"); /* of /vsicurl/ and those of its kind */
    GDALAllRegister();
    if (GDALGetCacheMax64() > most_cache) GDALSetCacheMax64(most_cache);
}

/* GDAL's reason for the last failure, or a default text. */
static const char *reason(const char *else_text)
{
    const char *text = CPLGetLastErrorMsg();
    return text && *text ? text : else_text;
}

static void quiet(void)
{
    CPLPushErrorHandler(CPLQuietErrorHandler);
    pthread_once(&once, register_drivers);
    CPLErrorReset();
}

static void loud(void) { CPLPopErrorHandler(); }

/* ---- one sheet ------------------------------------------------------------------------------ */

/* What decides whether sheets share a grid. */
typedef struct Opened {
    double transform[6];
    int    width, height, bands;
    bool   ellipsoidal, bytes, whole;
    double metres_per_unit;
    int    row_block;
    RasterStated stated;
    RasterChoice choice;
    OGRSpatialReferenceH crs;
} Opened;

/* The coordinate system that the user names, else the file's; NULL, logged: none. */
static OGRSpatialReferenceH crs_of(const RasterChoice *choice, GDALDatasetH file, const char *path, const char *key)
{
    const OGRSpatialReferenceH stated = GDALGetSpatialRef(file);
    if (!*choice->srs) {
        if (!stated)
            log_error("%s: %s does not say its coordinate system; %s@srs=EPSG:nnnn does (or gdal_edit.py -a_srs EPSG:nnnn)", key,
                      path, path);
        return stated ? OSRClone(stated) : NULL;
    }
    OGRSpatialReferenceH named = OSRNewSpatialReference(NULL);
    if (named && OSRSetFromUserInput(named, choice->srs) == OGRERR_NONE) return named;
    log_error("%s: %s: '%s' is no coordinate system that PROJ knows: %s; EPSG:32633 is one", key, path, choice->srs,
              reason("unknown"));
    if (named) OSRDestroySpatialReference(named);
    return NULL;
}

/* Corner 0, 0 and pixels of 1 are what GDAL gives a file that says nothing. */
static bool is_placed(double transform[6], GDALDatasetH file)
{
    static const double nothing[6] = {0, 1, 0, 0, 0, 1};
    double inverse[6], mirrored[6];
    if (GDALGetGeoTransform(file, transform) != CE_None || !GDALInvGeoTransform(transform, inverse)) return false;
    memcpy(mirrored, transform, sizeof mirrored);
    mirrored[5] = fabs(mirrored[5]);
    return memcmp(mirrored, nothing, sizeof nothing) != 0;
}

/* GDAL's name of a grid in a file, `NETCDF:"a.nc":height`, and its own, `height`; NULL: this line of the list names none. */
static const char *part_of(const char **own, const char *line)
{
    const char *name = strstr(line, "_NAME=");
    if (!name) return NULL;
    const char *colon = strrchr(name, ':');
    *own = colon ? colon + 1 : name + 6;
    return name + 6;
}

/* The grid that is asked for, in path; false, logged: there is none, or none was asked for. */
static bool choose_part(char path[path_size], GDALDatasetH file, const char *asked, const char *key)
{
    char      **part = GDALGetMetadata(file, "SUBDATASETS");
    char        names[400] = "";
    const char *own;
    for (int k = 0; part && part[k]; k++) {
        const char *name = part_of(&own, part[k]);
        if (!name) continue;
        if (strcmp(own, asked) == 0 && strlen(name) < path_size) {
            strcpy(path, name);
            return true;
        }
        const size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", own);
    }
    log_error("%s: %s holds several grids, %s: %s; choose one: %s@part=NAME", key, path,
              *asked ? "but none that is called so" : "and none is chosen", *names ? names : "none that can be named", path);
    return false;
}

static Status describe(Opened *out, GDALDatasetH file, const RasterChoice *choice, const char *path, const char *key)
{
    Opened o = {.width = GDALGetRasterXSize(file), .height = GDALGetRasterYSize(file),
                .bands = GDALGetRasterCount(file), .choice = *choice};
    if (o.bands < 1 || o.width < 2 || o.height < 2) {
        log_error("%s: %s holds %d bands of %d x %d pixels; a sheet needs a band and 2 x 2", key, path, o.bands,
                  o.width, o.height);
        return STATUS_BAD_VALUE;
    }
    if (o.width > most_side || o.height > most_side) {
        log_error("%s: %s has %d x %d pixels, more than %d a side; gdal_translate -srcwin cuts out what is needed", key,
                  path, o.width, o.height, (int)most_side);
        return STATUS_BAD_VALUE;
    }
    if (choice->band > o.bands) {
        log_error("%s: %s has %d bands, not %d; gdalinfo %s lists them", key, path, o.bands, choice->band, path);
        return STATUS_BAD_VALUE;
    }
    if (!is_placed(o.transform, file)) {
        log_error("%s: %s does not say where its corners are; gdal_translate -a_ullr W N E S %s OUT.tif", key, path,
                  path);
        return STATUS_BAD_VALUE;
    }
    o.crs = crs_of(choice, file, path, key);
    if (!o.crs) return STATUS_BAD_VALUE;
    const int             number = choice->band ? choice->band : 1;
    const GDALRasterBandH band = GDALGetRasterBand(file, number);
    raster_state(&o.stated, file, number, o.crs);
    o.ellipsoidal     = !OSRIsCompound(o.crs) && OSRGetAxesCount(o.crs) == 3;
    o.bytes           = GDALGetRasterDataType(band) == GDT_Byte;
    o.whole           = GDALDataTypeIsInteger(GDALGetRasterDataType(band));
    int block_x = 0, block_y = 0;
    GDALGetBlockSize(band, &block_x, &block_y);
    for (o.row_block = 64; o.row_block < block_y && o.row_block < 1024;) o.row_block *= 2;
    const double unit_m = raster_unit_m(*choice->unit ? choice->unit : o.stated.unit);
    const bool   down = choice->sense ? choice->sense < 0 : o.stated.down;
    o.metres_per_unit = (unit_m > 0 ? unit_m : 1) * (down ? -1 : 1);
    OSRStripVertical(o.crs);
    OSRDemoteTo2D(o.crs, NULL);
    OSRSetAxisMappingStrategy(o.crs, OAMS_TRADITIONAL_GIS_ORDER);
    *out = o;
    return STATUS_OK;
}

/* ---- grids ---------------------------------------------------------------------------------- */

/* But for the band, which each sheet has for itself. */
static bool same_choice(const RasterChoice *a, const RasterChoice *b)
{
    return a->vertical == b->vertical && strcmp(a->unit, b->unit) == 0 && a->sense == b->sense &&
           a->has_void == b->has_void && a->no_void == b->no_void && a->void_value == b->void_value &&
           (a->band != 0) == (b->band != 0);
}

static bool same_grid(const Raster *raster, const Opened *o, double at_px[2])
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
    const double dx = b[0] - a[0], dy = b[3] - a[3];
    const double *to = raster->px_from_crs;
    at_px[0] = to[1] * dx + to[2] * dy;
    at_px[1] = to[4] * dx + to[5] * dy;
    if (raster->whole_turn_px > 0) at_px[0] -= raster->whole_turn_px * rint(at_px[0] / raster->whole_turn_px);
    return fabs(at_px[0] - rint(at_px[0])) < 0.01 && fabs(at_px[1] - rint(at_px[1])) < 0.01 &&
           fabs(at_px[0]) < 1e8 && fabs(at_px[1]) < 1e8;
}

static Status start_raster(Raster *raster, Opened *o)
{
    OGRSpatialReferenceH earth = OSRNewSpatialReference(NULL);
    Status status = STATUS_BAD_VALUE;
    memcpy(raster->crs_from_px, o->transform, sizeof o->transform);
    raster->bands           = o->bands;
    raster->ellipsoidal     = o->ellipsoidal;
    raster->metres_per_unit = o->metres_per_unit;
    raster->bytes           = o->bytes;
    raster->whole           = o->whole;
    raster->stated          = o->stated;
    raster->choice          = o->choice;
    raster->low             = -INFINITY;
    raster->high            = INFINITY;
    raster->row_block       = o->row_block;
    raster->crs             = o->crs;
    o->crs                  = NULL;
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

/* Of a file that names others, such as a VRT, those too; what those name where it matters. */
static bool parts_may_be_opened(GDALDatasetH file, const char *path, const char *key, int depth)
{
    char **parts = GDALGetFileList(file);
    bool   good = depth < 8;
    for (int k = 0; good && parts && parts[k]; k++) {
        if (strcmp(parts[k], path) == 0) continue;
        good = raster_file_allowed(parts[k], key);
        GDALDatasetH part = good && raster_stays_within() ? GDALOpen(parts[k], GA_ReadOnly) : NULL;
        if (part) good = parts_may_be_opened(part, parts[k], key, depth + 1);
        if (part) GDALClose(part);
    }
    CSLDestroy(parts);
    return good;
}

/* gzip and zip files are read through GDAL's own names for what is in them. */
static const char *remedy(char out[path_size + 80], const char *path)
{
    const char *ending = strrchr(path, '.');
    const bool  gzip = ending && strcasecmp(ending, ".gz") == 0, zip = ending && strcasecmp(ending, ".zip") == 0;
    if (gzip) snprintf(out, path_size + 80, "name it /vsigzip/%s, or gunzip it", path);
    else if (zip) snprintf(out, path_size + 80, "name what is in it, /vsizip/%s/NAME.tif, or unzip it", path);
    else snprintf(out, path_size + 80, "gdalinfo %s says what it is", path);
    return out;
}

static Status add_sheet(RasterSet *set, const char *name, const RasterChoice *choice, const char *key)
{
    Opened o = {0};
    Status status = STATUS_IO;
    double at_px[2] = {0, 0};
    char   path[path_size], next[path_size + 80];
    snprintf(path, sizeof path, "%s", name);
    if (!raster_file_allowed(path, key)) return STATUS_IO;
    GDALDatasetH file = GDALOpen(path, GA_ReadOnly);
    if (!file) {
        log_error("%s: cannot read %s: %s; %s", key, path, reason("not a raster GDAL knows"), remedy(next, path));
        return STATUS_IO;
    }
    if (*choice->part || (GDALGetRasterCount(file) < 1 && GDALGetMetadata(file, "SUBDATASETS"))) {
        const bool chosen = parts_may_be_opened(file, path, key, 0) && choose_part(path, file, choice->part, key);
        GDALClose(file);
        if (!chosen) return STATUS_BAD_VALUE;
        file = GDALOpen(path, GA_ReadOnly);
        if (!file) {
            log_error("%s: cannot read %s: %s", key, path, reason("not a raster GDAL knows"));
            return STATUS_IO;
        }
    }
    status = parts_may_be_opened(file, path, key, 0) ? describe(&o, file, choice, path, key) : STATUS_IO;
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
        raster      = &set->raster[set->count++];
        *raster     = (Raster){.order = set->count};
        at_px[0] = at_px[1] = 0;
        status = start_raster(raster, &o);
        if (status != STATUS_OK) {
            log_error("%s: no way from WGS 84 to the coordinate system of %s: %s; gdalwarp -t_srs EPSG:4326 %s OUT.tif",
                      key, path, reason("unknown to PROJ"), path);
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
    if (o.row_block > raster->row_block) raster->row_block = o.row_block;
    if (sheets[raster->sheet_count].path) raster->sheet_count++;
    else status = STATUS_NO_MEMORY;
done:
    if (o.crs) OSRDestroySpatialReference(o.crs);
    return status;
}

/* The outermost corner becomes pixel (0, 0). */
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
    raster->width  = x1 - x0;
    raster->height = y1 - y0;
    double *t = raster->crs_from_px;
    t[0] += x0 * t[1] + y0 * t[2];
    t[3] += x0 * t[4] + y0 * t[5];
    if (!GDALInvGeoTransform(t, raster->px_from_crs)) return STATUS_BAD_VALUE;

    const double cx = 0.5 * raster->width, cy = 0.5 * raster->height;
    double x[3] = {cx, cx + 1, cx}, y[3] = {cy, cy, cy + 1}, p_ecef[3][3];
    raster_earth_from_px(raster, 3, x, y);
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
    char  **name = NULL, full[path_size];
    int     names = 0, used = 0;
    Status  status = STATUS_OK;
    DIR    *folder = opendir(path);
    if (!folder) {
        log_error("%s: cannot read the folder %s: %s", key, path, strerror(errno));
        return STATUS_IO;
    }
    for (struct dirent *entry; status == STATUS_OK && (entry = readdir(folder));) {
        struct stat about;
        const int   n = snprintf(full, sizeof full, "%s/%s", path, entry->d_name);
        if (n < 0 || n >= (int)sizeof full || stat(full, &about) != 0 || !S_ISREG(about.st_mode)) continue;
        if (!raster_file_allowed(full, key)) {
            status = STATUS_IO;
            break;
        }
        if (!GDALIdentifyDriver(full, NULL)) continue; /* notes, world files, overviews' sidecars */
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
        log_error("%s: the folder %s holds nothing that GDAL reads; gdalinfo --formats lists what it does", key, path);
        status = STATUS_BAD_VALUE;
    }
    return status;
}

static int finer_first(const void *a, const void *b)
{
    const Raster *p = a, *q = b;
    /* within a hundredth they are the same: a posting in degrees changes along the meridian */
    const double x = rint(100 * log(fmax(p->posting_m[0], p->posting_m[1]))),
                 y = rint(100 * log(fmax(q->posting_m[0], q->posting_m[1])));
    if (x != y) return x < y ? -1 : 1;
    return p->order < q->order ? -1 : p->order > q->order;
}

/* Room for handles, unless that takes more files than a process may have open. */
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

static void kept_free(struct RasterKept *kept);

static void close_handles(RasterOpen *open)
{
    for (int h = 0; open && h < handles; h++) {
        if (open->file[h]) GDALClose(open->file[h]);
        pthread_mutex_destroy(&open->lock[h]);
    }
    free(open);
}

Status raster_set_open(RasterSet *out, const char *paths, const char *key)
{
    RasterSet set = {0};
    Status    status = library_load(&gdal_library);
    if (status != STATUS_OK) return status;
    quiet();
    for (const char *at = paths; status == STATUS_OK && *at;) {
        char         path[path_size], name[path_size];
        RasterChoice choice;
        const char  *why = NULL;
        struct stat  about;
        const size_t length = strcspn(at, ",");
        size_t       skip = strspn(at, " "), end = length;
        if (skip > length) skip = length;
        while (end > skip && at[end - 1] == ' ') end--;
        const int n = snprintf(path, sizeof path, "%.*s", (int)(end - skip), at + skip);
        at += length + (at[length] == ',');
        if (n == 0) continue;
        memcpy(name, path, sizeof name);
        if (n < 0 || n >= (int)sizeof path) status = STATUS_BAD_VALUE;
        else if (!raster_choice_take(&choice, &why, path)) {
            log_error("%s: %s: %s", key, name, why);
            status = STATUS_BAD_VALUE;
        } else if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) status = add_folder(&set, path, &choice, key);
        else status = add_sheet(&set, path, &choice, key);
    }
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
    loud();
    if (status == STATUS_OK) *out = set;
    else raster_set_close(&set);
    return status;
}

void raster_set_close(RasterSet *set)
{
    for (int k = 0; k < set->count; k++) {
        Raster *raster = &set->raster[k];
        for (int n = 0; n < raster->sheet_count; n++) {
            close_handles(raster->sheet[n].open);
            free(raster->sheet[n].path);
        }
        free(raster->sheet);
        kept_free(raster->kept);
        if (raster->crs_from_earth) OCTDestroyCoordinateTransformation(raster->crs_from_earth);
        if (raster->earth_from_crs) OCTDestroyCoordinateTransformation(raster->earth_from_crs);
        if (raster->crs) OSRDestroySpatialReference(raster->crs);
    }
    free(set->raster);
    *set = (RasterSet){0};
}

/* ---- places --------------------------------------------------------------------------------- */

static void through(const double t[6], int count, double *x, double *y)
{
    for (int k = 0; k < count; k++) {
        const double a = x[k], b = y[k];
        const bool   ok = isfinite(a) && isfinite(b);
        x[k] = ok ? t[0] + a * t[1] + b * t[2] : NAN;
        y[k] = ok ? t[3] + a * t[4] + b * t[5] : NAN;
    }
}

void raster_px_from_earth(const Raster *raster, int count, double *lon_to_x, double *lat_to_y)
{
    for (int k = 0; k < count; k++) {
        lon_to_x[k] /= rad_per_deg;
        lat_to_y[k] /= rad_per_deg;
    }
    quiet();
    OCTTransform(raster->crs_from_earth, count, lon_to_x, lat_to_y, NULL);
    loud();
    through(raster->px_from_crs, count, lon_to_x, lat_to_y);
    if (raster->whole_turn_px > 0) /* the full turn of longitude of the raster */
        for (int k = 0; k < count; k++)
            lon_to_x[k] -= raster->whole_turn_px * rint((lon_to_x[k] - 0.5 * raster->width) / raster->whole_turn_px);
}

void raster_earth_from_px(const Raster *raster, int count, double *x_to_lon, double *y_to_lat)
{
    through(raster->crs_from_px, count, x_to_lon, y_to_lat);
    quiet();
    OCTTransform(raster->earth_from_crs, count, x_to_lon, y_to_lat, NULL);
    loud();
    for (int k = 0; k < count; k++) {
        const bool ok = isfinite(x_to_lon[k]) && isfinite(y_to_lat[k]) && fabs(y_to_lat[k]) <= 90;
        x_to_lon[k] = ok ? x_to_lon[k] * rad_per_deg : NAN;
        y_to_lat[k] = ok ? y_to_lat[k] * rad_per_deg : NAN;
    }
}

/* ---- pixels --------------------------------------------------------------------------------- */

/* A sheet's handle for a window that begins at row y, locked; NULL, logged: the file cannot be read. */
static GDALDatasetH sheet_open(const RasterSheet *s, int row_block, int y, const char *key)
{
    const int    h = y / (row_block > 0 ? row_block : 1) % handles;
    GDALDatasetH file = NULL;
    if (s->open) {
        pthread_mutex_lock(&s->open->lock[h]);
        file = s->open->file[h];
    }
    if (!file) file = GDALOpen(s->path, GA_ReadOnly);
    if (s->open) s->open->file[h] = file;
    if (file && GDALGetRasterXSize(file) == s->width && GDALGetRasterYSize(file) == s->height) return file;
    log_error("%s: %s: %s", key, s->path, file ? "it changed while it was read" : reason("it cannot be opened"));
    if (s->open) {
        s->open->file[h] = NULL;
        pthread_mutex_unlock(&s->open->lock[h]);
    }
    if (file) GDALClose(file);
    return NULL;
}

static void sheet_done(const RasterSheet *s, int row_block, int y, GDALDatasetH file)
{
    if (!s->open) GDALClose(file);
    else pthread_mutex_unlock(&s->open->lock[y / (row_block > 0 ? row_block : 1) % handles]);
}

/* What a sheet and a window have in common, px of the raster. False: nothing. */
static bool common_part(int part[4], const RasterSheet *s, int x0, int y0, int width, int height)
{
    part[0] = x0 > s->x0 ? x0 : s->x0;
    part[1] = y0 > s->y0 ? y0 : s->y0;
    part[2] = x0 + width < s->x0 + s->width ? x0 + width : s->x0 + s->width;
    part[3] = y0 + height < s->y0 + s->height ? y0 + height : s->y0 + s->height;
    return part[0] < part[2] && part[1] < part[3];
}

/* ---- decoded rows ---------------------------------------------------------------------------- */

/* A file without a name: the raster's rows in float, those that have been read. */
typedef struct RasterKept {
    int           file;
    int           band;
    atomic_uchar *has; /* [height] */
} RasterKept;

void raster_keep(Raster *raster, int band, const char *folder)
{
    RasterKept *kept = calloc(1, sizeof *kept);
    if (!kept || raster->kept) {
        free(kept);
        return;
    }
    kept->band = band;
    kept->has  = calloc((size_t)raster->height, sizeof *kept->has);
    kept->file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (!kept->has || kept->file < 0) { /* no such file system: read twice */
        if (kept->file >= 0) close(kept->file);
        free(kept->has);
        free(kept);
        return;
    }
    raster->kept = kept;
}

static void kept_free(RasterKept *kept)
{
    if (!kept) return;
    close(kept->file);
    free(kept->has);
    free(kept);
}

static bool whole_io(bool write, int file, float *at, size_t count, size_t offset)
{
    char  *octets = (char *)at;
    size_t left = count * sizeof *at;
    off_t  where = (off_t)(offset * sizeof *at);
    while (left > 0) {
        const ssize_t n = write ? pwrite(file, octets, left, where) : pread(file, octets, left, where);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        octets += n;
        where += n;
        left -= (size_t)n;
    }
    return true;
}

/* Full rows of the raster into the file; a full disk only costs another reading. */
static void keep_rows(const Raster *raster, float *rows, int y0, int height)
{
    RasterKept *kept = raster->kept;
    for (int y = y0; y < y0 + height; y++)
        if (!atomic_load(&kept->has[y]) && whole_io(true, kept->file, rows + (size_t)(y - y0) * (size_t)raster->width,
                                                   (size_t)raster->width, (size_t)y * (size_t)raster->width))
            atomic_store(&kept->has[y], 1);
}

static bool read_kept(float *out, const Raster *raster, int x0, int y0, int width, int height)
{
    const RasterKept *kept = raster->kept;
    if (x0 < 0 || y0 < 0 || x0 + width > raster->width || y0 + height > raster->height) return false;
    for (int y = y0; y < y0 + height; y++)
        if (!atomic_load(&kept->has[y])) return false;
    if (x0 == 0 && width == raster->width)
        return whole_io(false, kept->file, out, (size_t)width * (size_t)height, (size_t)y0 * (size_t)width);
    for (int y = y0; y < y0 + height; y++)
        if (!whole_io(false, kept->file, out + (size_t)(y - y0) * (size_t)width, (size_t)width,
                      (size_t)y * (size_t)raster->width + (size_t)x0))
            return false;
    return true;
}

static Status damaged(const RasterSheet *s, const char *key)
{
    log_error("%s: %s is damaged: %s; fetch it again, or leave it out", key, s->path, reason("rows are missing"));
    return STATUS_IO;
}

/* One sheet's part of the window, over what is there already: the first sheet that has a value wins. */
static Status read_sheet(float *out, const Raster *raster, const RasterSheet *s, bool first, int number, int x0, int y0,
                         int width, int height, const char *key)
{
    int part[4];
    if (!common_part(part, s, x0, y0, width, height)) return STATUS_OK;
    const int w = part[2] - part[0], h = part[3] - part[1];
    const int strip = h < 256 ? h : 256;

    Status         status = STATUS_IO;
    float         *value = NULL;
    unsigned char *mask = NULL;
    GDALDatasetH   file = sheet_open(s, raster->row_block, part[1], key);
    if (!file) return status;
    GDALRasterBandH band = GDALGetRasterBand(file, s->band ? s->band : number);
    if (!band) {
        log_error("%s: %s: %s", key, s->path, reason("it has no such band"));
        goto done;
    }
    const bool masked = !(GDALGetMaskFlags(band) & GMF_ALL_VALID);
    int        has_scale = 0, has_offset = 0;
    double     scale = GDALGetRasterScale(band, &has_scale), offset = GDALGetRasterOffset(band, &has_offset);
    if (!has_scale || !(scale != 0) || !isfinite(scale)) scale = 1;
    if (!has_offset || !isfinite(offset)) offset = 0;
    const bool  more = masked || raster->choice.has_void || isfinite(raster->low) || isfinite(raster->high);
    const float hole = raster->choice.has_void ? (float)raster->choice.void_value : NAN;
    if (first && !more && scale == 1 && offset == 0) { /* nothing else is there: without a copy */
        float *to = out + (size_t)(part[1] - y0) * (size_t)width + (size_t)(part[0] - x0);
        status = GDALRasterIO(band, GF_Read, part[0] - s->x0, part[1] - s->y0, w, h, to, w, h, GDT_Float32, 0,
                              width * (int)sizeof *to) == CE_None ? STATUS_OK : damaged(s, key);
        goto done;
    }
    status = STATUS_NO_MEMORY;
    value  = malloc((size_t)w * (size_t)strip * sizeof *value);
    mask   = malloc((size_t)w * (size_t)strip);
    if (!value || !mask) goto done;
    for (int y = part[1]; y < part[3]; y += strip) {
        const int rows = part[3] - y < strip ? part[3] - y : strip;
        if (GDALRasterIO(band, GF_Read, part[0] - s->x0, y - s->y0, w, rows, value, w, rows, GDT_Float32, 0, 0) !=
                CE_None ||
            (masked && GDALRasterIO(GDALGetMaskBand(band), GF_Read, part[0] - s->x0, y - s->y0, w, rows, mask, w, rows,
                                    GDT_Byte, 0, 0) != CE_None)) {
            status = damaged(s, key);
            goto done;
        }
        for (int r = 0; r < rows; r++) {
            float *to = out + (size_t)(y + r - y0) * (size_t)width + (size_t)(part[0] - x0);
            const float         *from = value + (size_t)r * (size_t)w;
            const unsigned char *valid = mask + (size_t)r * (size_t)w;
            if (!more)
                for (int i = 0; i < w; i++) to[i] = isnan(to[i]) ? (float)(from[i] * scale + offset) : to[i];
            for (int i = 0; more && i < w; i++) {
                const float z = (float)(from[i] * scale + offset);
                const bool  good = (!masked || valid[i]) && from[i] != hole && z >= raster->low && z <= raster->high;
                to[i] = isnan(to[i]) && good ? z : to[i];
            }
        }
    }
    status = STATUS_OK;
done:
    sheet_done(s, raster->row_block, part[1], file);
    free(value);
    free(mask);
    return status;
}

static Status read_sheet_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, const RasterSheet *s, int first,
                               int bands, int x0, int y0, int width, int height, const char *key)
{
    int part[4];
    if (!common_part(part, s, x0, y0, width, height)) return STATUS_OK;
    const int      w = part[2] - part[0], h = part[3] - part[1];
    const size_t   count = (size_t)w * (size_t)h;
    uint8_t       *value = NULL, *mask = NULL;
    Status         status = STATUS_IO;
    GDALDatasetH   file = sheet_open(s, raster->row_block, part[1], key);
    if (!file) return status;
    int band[4] = {0};
    for (int b = 0; b < bands; b++) band[b] = s->band && bands == 1 ? s->band : first + b;
    const GDALRasterBandH of = GDALGetRasterBand(file, band[0]);
    if (!of || !GDALGetRasterBand(file, band[bands - 1])) {
        log_error("%s: %s: %s", key, s->path, reason("it has no such band"));
        goto done;
    }
    const bool masked = !(GDALGetMaskFlags(of) & GMF_ALL_VALID);
    if (raster->sheet_count == 1 && !masked) { /* nothing else is there: without a copy */
        const size_t at = (size_t)(part[1] - y0) * (size_t)width + (size_t)(part[0] - x0);
        const CPLErr error = GDALDatasetRasterIO(file, GF_Read, part[0] - s->x0, part[1] - s->y0, w, h,
                                                 out + at * (size_t)bands, w, h, GDT_Byte, bands, band, bands,
                                                 bands * width, 1);
        status = error == CE_None ? STATUS_OK : damaged(s, key);
        for (int r = 0; r < h; r++) memset(valid + at + (size_t)r * (size_t)width, 255, (size_t)w);
        goto done;
    }
    status = STATUS_NO_MEMORY;
    value  = malloc(count * (size_t)bands);
    mask   = malloc(count);
    if (!value || !mask) goto done;
    status = STATUS_IO;
    if (GDALDatasetRasterIO(file, GF_Read, part[0] - s->x0, part[1] - s->y0, w, h, value, w, h, GDT_Byte, bands, band,
                            bands, bands * w, 1) != CE_None ||
        (masked && GDALRasterIO(GDALGetMaskBand(of), GF_Read, part[0] - s->x0, part[1] - s->y0, w, h, mask, w, h,
                                GDT_Byte, 0, 0) != CE_None)) {
        status = damaged(s, key);
        goto done;
    }
    for (int r = 0; r < h; r++) {
        const size_t at = (size_t)(part[1] + r - y0) * (size_t)width + (size_t)(part[0] - x0);
        const size_t from = (size_t)r * (size_t)w;
        for (size_t i = 0; i < (size_t)w; i++) {
            if (valid[at + i] || (masked && !mask[from + i])) continue;
            valid[at + i] = 255;
            for (int b = 0; b < bands; b++)
                out[(at + i) * (size_t)bands + (size_t)b] = value[(from + i) * (size_t)bands + (size_t)b];
        }
    }
    status = STATUS_OK;
done:
    sheet_done(s, raster->row_block, part[1], file);
    free(value);
    free(mask);
    return status;
}

void raster_enu_box(double low_m[2], double high_m[2], const Raster *raster, const LocalFrame *frame, double inset_px)
{
    enum { side = 16 };
    low_m[0] = low_m[1] = INFINITY;
    high_m[0] = high_m[1] = -INFINITY;
    const double w = raster->width - 2 * inset_px, h = raster->height - 2 * inset_px;
    for (int edge = 0; edge < 4; edge++)
        for (int k = 0; k <= side; k++) {
            const double along = (double)k / side;
            double       x = inset_px + (edge < 2 ? along * w : edge == 2 ? 0 : w);
            double       y = inset_px + (edge < 2 ? edge ? h : 0 : along * h);
            double       p_ecef[3], p_enu[3];
            raster_earth_from_px(raster, 1, &x, &y);
            const Geodetic place = {.lat_rad = y, .lon_rad = x};
            if (ecef_from_geodetic(p_ecef, NULL, &place) != STATUS_OK) continue;
            enu_from_ecef(p_enu, frame, p_ecef);
            for (int c = 0; c < 2; c++) {
                low_m[c]  = fmin(low_m[c], p_enu[c]);
                high_m[c] = fmax(high_m[c], p_enu[c]);
            }
        }
}

Status raster_read(float *out, const Raster *raster, int band, int x0, int y0, int width, int height, const char *key)
{
    Status       status = STATUS_OK;
    const size_t count = (size_t)width * (size_t)height;
    const bool   keeps = raster->kept && ((RasterKept *)raster->kept)->band == band;
    if (keeps && read_kept(out, raster, x0, y0, width, height)) return STATUS_OK;
    const RasterSheet *only = raster->sheet_count == 1 ? &raster->sheet[0] : NULL;
    for (size_t k = 0; k < count; k++) out[k] = NAN;
    quiet();
    for (int k = 0; status == STATUS_OK && k < raster->sheet_count; k++)
        status = read_sheet(out, raster, &raster->sheet[k], only != NULL, band, x0, y0, width, height, key);
    loud();
    if (status == STATUS_OK && keeps && x0 == 0 && width == raster->width && y0 >= 0 && y0 + height <= raster->height)
        keep_rows(raster, out, y0, height);
    return status;
}

Status raster_read_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, int first_band, int bands, int x0, int y0,
                         int width, int height, const char *key)
{
    Status       status = STATUS_OK;
    const size_t count = (size_t)width * (size_t)height;
    if (bands < 1 || bands > 4) return STATUS_BAD_VALUE;
    memset(out, 0, count * (size_t)bands);
    memset(valid, 0, count);
    quiet();
    for (int k = 0; status == STATUS_OK && k < raster->sheet_count; k++)
        status = read_sheet_bytes(out, valid, raster, &raster->sheet[k], first_band, bands, x0, y0, width, height, key);
    loud();
    return status;
}
