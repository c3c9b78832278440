/* terrain/elevation/reader/reader_pixels.c: places and pixels of the rasters of a set, as GDAL and PROJ give them. */

#include "terrain/elevation/reader/reader_private.h"

#include <ogr_srs_api.h>
#include <stdlib.h>

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

/* A PROJ transformation serves one thread at a time, so calls take this lock. */
static pthread_mutex_t transforming = PTHREAD_MUTEX_INITIALIZER;

static void transform(void *by, int count, double *x, double *y)
{
    pthread_mutex_lock(&transforming);
    reader_quiet();
    OCTTransform(by, count, x, y, NULL);
    reader_loud();
    pthread_mutex_unlock(&transforming);
}

void reader_px_from_earth(const Raster *raster, int count, double *lon_to_x, double *lat_to_y)
{
    for (int k = 0; k < count; k++) {
        lon_to_x[k] /= rad_per_deg;
        lat_to_y[k] /= rad_per_deg;
    }
    transform(raster->crs_from_earth, count, lon_to_x, lat_to_y);
    through(raster->px_from_crs, count, lon_to_x, lat_to_y);
    if (raster->whole_turn_px > 0) /* adds or subtracts whole turns of longitude */
        for (int k = 0; k < count; k++)
            lon_to_x[k] -= raster->whole_turn_px * rint((lon_to_x[k] - 0.5 * raster->width) / raster->whole_turn_px);
}

void reader_earth_from_px(const Raster *raster, int count, double *x_to_lon, double *y_to_lat)
{
    through(raster->crs_from_px, count, x_to_lon, y_to_lat);
    transform(raster->earth_from_crs, count, x_to_lon, y_to_lat);
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
    reader_works_at(s->path);
    if (!file) file = GDALOpen(s->path, GA_ReadOnly);
    if (s->open) s->open->file[h] = file;
    if (file && GDALGetRasterXSize(file) == s->width && GDALGetRasterYSize(file) == s->height) return file;
    log_error("%s: %s: %s", key, s->path, file ? "it changed while it was read" : reader_reason("it cannot be opened"));
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

/* The part that a sheet and a window have in common, px of the raster. Returns false when there is none. */
static bool common_part(int part[4], const RasterSheet *s, RasterWindow window)
{
    const int x0 = window.x0, y0 = window.y0, width = window.width, height = window.height;
    part[0] = x0 > s->x0 ? x0 : s->x0;
    part[1] = y0 > s->y0 ? y0 : s->y0;
    part[2] = x0 + width < s->x0 + s->width ? x0 + width : s->x0 + s->width;
    part[3] = y0 + height < s->y0 + s->height ? y0 + height : s->y0 + s->height;
    return part[0] < part[2] && part[1] < part[3];
}

static Status damaged(const RasterSheet *s, const char *key)
{
    log_error("%s: %s is damaged: %s; fetch it again, or leave it out", key, s->path,
              reader_reason("rows are missing"));
    return STATUS_IO;
}

/* Reads one sheet's part of the window, only where no earlier sheet has a value. */
static Status read_sheet(float *out, const Raster *raster, const RasterSheet *s, bool first, int number,
                         RasterWindow window, const char *key)
{
    const int x0 = window.x0, y0 = window.y0, width = window.width;
    int       part[4];
    if (!common_part(part, s, window)) return STATUS_OK;
    const int w = part[2] - part[0], h = part[3] - part[1];
    const int strip = h < 256 ? h : 256;

    Status         status = STATUS_IO;
    float         *value = NULL;
    unsigned char *mask = NULL;
    GDALDatasetH   file = sheet_open(s, raster->row_block, part[1], key);
    if (!file) return status;
    GDALRasterBandH band = GDALGetRasterBand(file, s->band ? s->band : number);
    if (!band) {
        log_error("%s: %s: %s", key, s->path, reader_reason("it has no such band"));
        goto done;
    }
    const bool masked = !(GDALGetMaskFlags(band) & GMF_ALL_VALID);
    int        has_scale = 0, has_offset = 0;
    double     scale = GDALGetRasterScale(band, &has_scale), offset = GDALGetRasterOffset(band, &has_offset);
    if (!has_scale || !(scale != 0) || !isfinite(scale)) scale = 1;
    if (!has_offset || !isfinite(offset)) offset = 0;
    const bool  more = masked || raster->choice.has_void || isfinite(raster->low) || isfinite(raster->high);
    const float hole = raster->choice.has_void ? (float)raster->choice.void_value : NAN;
    if (first && !more && scale == 1 && offset == 0) { /* nothing else is in the window, so no copy is needed */
        float *to = out + (size_t)(part[1] - y0) * (size_t)width + (size_t)(part[0] - x0);
        status = GDALRasterIO(band, GF_Read, part[0] - s->x0, part[1] - s->y0, w, h, to, w, h, GDT_Float32, 0,
                              width * (int)sizeof *to) == CE_None
                     ? STATUS_OK
                     : damaged(s, key);
        goto done;
    }
    status = STATUS_NO_MEMORY;
    value = malloc((size_t)w * (size_t)strip * sizeof *value);
    mask = malloc((size_t)w * (size_t)strip);
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
            float               *to = out + (size_t)(y + r - y0) * (size_t)width + (size_t)(part[0] - x0);
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
                               int bands, RasterWindow window, const char *key)
{
    const int x0 = window.x0, y0 = window.y0, width = window.width;
    int       part[4];
    if (!common_part(part, s, window)) return STATUS_OK;
    const int    w = part[2] - part[0], h = part[3] - part[1];
    const size_t count = (size_t)w * (size_t)h;
    uint8_t     *value = NULL, *mask = NULL;
    Status       status = STATUS_IO;
    GDALDatasetH file = sheet_open(s, raster->row_block, part[1], key);
    if (!file) return status;
    int band[4] = {0};
    for (int b = 0; b < bands; b++) band[b] = s->band && bands == 1 ? s->band : first + b;
    const GDALRasterBandH of = GDALGetRasterBand(file, band[0]);
    if (!of || !GDALGetRasterBand(file, band[bands - 1])) {
        log_error("%s: %s: %s", key, s->path, reader_reason("it has no such band"));
        goto done;
    }
    const bool masked = !(GDALGetMaskFlags(of) & GMF_ALL_VALID);
    if (raster->sheet_count == 1 && !masked) { /* nothing else is in the window, so no copy is needed */
        const size_t at = (size_t)(part[1] - y0) * (size_t)width + (size_t)(part[0] - x0);
        const CPLErr error =
            GDALDatasetRasterIO(file, GF_Read, part[0] - s->x0, part[1] - s->y0, w, h, out + at * (size_t)bands, w, h,
                                GDT_Byte, bands, band, bands, bands * width, 1);
        status = error == CE_None ? STATUS_OK : damaged(s, key);
        for (int r = 0; r < h; r++) memset(valid + at + (size_t)r * (size_t)width, 255, (size_t)w);
        goto done;
    }
    status = STATUS_NO_MEMORY;
    value = malloc(count * (size_t)bands);
    mask = malloc(count);
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

Status reader_read(float *out, const Raster *raster, int band, RasterWindow window, const char *key)
{
    Status             status = STATUS_OK;
    const size_t       count = (size_t)window.width * (size_t)window.height;
    const RasterSheet *only = raster->sheet_count == 1 ? &raster->sheet[0] : NULL;
    for (size_t k = 0; k < count; k++) out[k] = NAN;
    reader_quiet();
    for (int k = 0; status == STATUS_OK && k < raster->sheet_count; k++)
        status = read_sheet(out, raster, &raster->sheet[k], only != NULL, band, window, key);
    reader_loud();
    return status;
}

Status reader_read_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, int first_band, int bands,
                         RasterWindow window, const char *key)
{
    Status       status = STATUS_OK;
    const size_t count = (size_t)window.width * (size_t)window.height;
    if (bands < 1 || bands > 4) return STATUS_BAD_VALUE;
    memset(out, 0, count * (size_t)bands);
    memset(valid, 0, count);
    reader_quiet();
    for (int k = 0; status == STATUS_OK && k < raster->sheet_count; k++)
        status = read_sheet_bytes(out, valid, raster, &raster->sheet[k], first_band, bands, window, key);
    reader_loud();
    return status;
}

/* ---- what of a raster holds nothing: between its sheets, and blocks that a TIFF lacks ----------- */

static bool is_tiff(GDALDatasetH file)
{
    const GDALDriverH driver = GDALGetDatasetDriver(file);
    return driver && strcmp(GDALGetDescription(driver), "GTiff") == 0;
}

double reader_data_px(GDALDatasetH file)
{
    const int             width = GDALGetRasterXSize(file), height = GDALGetRasterYSize(file);
    const GDALRasterBandH band = GDALGetRasterBand(file, 1);
    double                percent = 100;
    if (band && is_tiff(file) &&
        GDALGetDataCoverageStatus(band, 0, 0, width, height, 0, &percent) & GDAL_DATA_COVERAGE_STATUS_UNIMPLEMENTED)
        percent = 100;
    return (percent >= 0 && percent <= 100 ? percent / 100 : 1) * width * height;
}

/* No block of this part is there, and no mask says more of it than its nodata value does: all of it is one value. */
static bool has_no_block(GDALDatasetH file, int number, const int part[4], const RasterSheet *s)
{
    const GDALRasterBandH band = GDALGetRasterBand(file, s->band ? s->band : number);
    if (!band || !is_tiff(file) || (GDALGetMaskFlags(band) & ~(GMF_ALL_VALID | GMF_NODATA))) return false;
    return GDALGetDataCoverageStatus(band, part[0] - s->x0, part[1] - s->y0, part[2] - part[0], part[3] - part[1],
                                     GDAL_DATA_COVERAGE_STATUS_DATA, NULL) == GDAL_DATA_COVERAGE_STATUS_EMPTY;
}

bool reader_uniform(float *value, const Raster *raster, int band, RasterWindow window, const char *key)
{
    bool  uniform = true;
    float v = NAN;
    int   sheets = 0;
    reader_quiet();
    for (int k = 0; uniform && k < raster->sheet_count; k++) {
        const RasterSheet *s = &raster->sheet[k];
        int                part[4];
        if (!common_part(part, s, window)) continue;
        GDALDatasetH file = sheet_open(s, raster->row_block, part[1], key);
        uniform = file && has_no_block(file, band, part, s);
        if (file) sheet_done(s, raster->row_block, part[1], file);
        if (uniform) uniform = reader_read(&v, raster, band, (RasterWindow){part[0], part[1], 1, 1}, key) == STATUS_OK;
        const bool whole = part[2] - part[0] == window.width && part[3] - part[1] == window.height;
        if (!isnan(v)) uniform &= whole && ++sheets == 1 && raster->sheet_count == 1;
    }
    reader_loud();
    if (uniform) *value = v;
    return uniform;
}
