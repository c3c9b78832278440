/* terrain/elevation/reader/reader_sparse.c: what of a raster holds nothing: between its sheets, and blocks that a TIFF lacks. */
#include "terrain/elevation/reader/reader_handles.h"
#include "terrain/elevation/reader/reader_private.h"

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

bool reader_uniform(float *value, const Raster *raster, int band, int x0, int y0, int width, int height, const char *key)
{
    bool  uniform = true;
    float v = NAN;
    int   sheets = 0;
    reader_quiet();
    for (int k = 0; uniform && k < raster->sheet_count; k++) {
        const RasterSheet *s = &raster->sheet[k];
        int                part[4];
        if (!common_part(part, s, x0, y0, width, height)) continue;
        GDALDatasetH file = sheet_open(s, raster->row_block, part[1], key);
        uniform = file && has_no_block(file, band, part, s);
        if (file) sheet_done(s, raster->row_block, part[1], file);
        if (uniform) uniform = reader_read(&v, raster, band, part[0], part[1], 1, 1, key) == STATUS_OK;
        const bool whole = part[2] - part[0] == width && part[3] - part[1] == height;
        if (!isnan(v)) uniform &= whole && ++sheets == 1 && raster->sheet_count == 1;
    }
    reader_loud();
    if (uniform) *value = v;
    return uniform;
}
