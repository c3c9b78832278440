/* terrain/elevation/reader/gdal_library.c: GDAL: the functions of it that the reader calls, loaded and prepared; what
 * it has to say is kept. */
#include "terrain/elevation/reader/reader_private.h"

#include <cpl_conv.h>

/* clang-format off */
#define GDAL(X)                                                                                                      \
    X(CPLErrorReset) X(CPLGetLastErrorMsg) X(CPLPopErrorHandler) X(CPLPushErrorHandler) X(CPLQuietErrorHandler)      \
    X(CPLSetConfigOption) X(CPLSetErrorHandler) X(CSLAddString) X(CSLDestroy) X(GDALAllRegister) X(GDALClose)        \
    X(GDALDataTypeIsInteger) X(GDALDatasetRasterIO) X(GDALGetBlockSize) X(GDALGetCacheMax64)                         \
    X(GDALGetDataCoverageStatus) X(GDALGetDataTypeName) X(GDALGetDatasetDriver) X(GDALGetDescription)                \
    X(GDALGetFileList) X(GDALGetGeoTransform) X(GDALGetMaskBand) X(GDALGetMaskFlags) X(GDALGetMetadata)              \
    X(GDALGetMetadataItem) X(GDALGetRasterBand) X(GDALGetRasterColorInterpretation) X(GDALGetRasterCount)            \
    X(GDALGetRasterDataType) X(GDALGetRasterNoDataValue) X(GDALGetRasterOffset) X(GDALGetRasterScale)                \
    X(GDALGetRasterUnitType) X(GDALGetRasterXSize) X(GDALGetRasterYSize) X(GDALGetSpatialRef)                        \
    X(GDALIdentifyDriver) X(GDALInvGeoTransform) X(GDALOpen) X(GDALRasterIO) X(GDALSetCacheMax64)                    \
    X(OCTDestroyCoordinateTransformation) X(OCTNewCoordinateTransformation) X(OCTTransform) X(OSRClone)              \
    X(OSRDemoteTo2D) X(OSRDestroySpatialReference) X(OSRGetAngularUnits) X(OSRGetAttrValue) X(OSRGetAxesCount)       \
    X(OSRGetAxis) X(OSRGetLinearUnits) X(OSRGetName) X(OSRGetPROJSearchPaths) X(OSRGetTargetLinearUnits)             \
    X(OSRImportFromEPSG) X(OSRIsCompound) X(OSRIsGeographic) X(OSRIsProjected) X(OSRIsSame)                          \
    X(OSRNewSpatialReference) X(OSRSetAxisMappingStrategy) X(OSRSetFromUserInput) X(OSRStripVertical)
/* clang-format on */
LIBRARY(gdal_library, GDAL, "GDAL", PITVIPER_GDAL_FILE, "libgdal32");

Status reader_prepare(void)
{
    static const GIntBig most_cache = 256 << 20; /* octets; GDAL's default is a twentieth of the memory */
    static bool          done;                   /* already done by the process that this one was forked from */
    const Status         status = library_load(&gdal_library);
    if (status != STATUS_OK || done) return status;
    done = true;
    CPLSetErrorHandler(CPLQuietErrorHandler);
    /* A file may name others (VRT): none makes this process ask a server, which could not be reached. */
    CPLSetConfigOption("GDAL_SKIP",
                       "HTTP,WMS,WMTS,WCS,DAAS,EEDA,EEDAI,PLMosaic,NGW,OGCAPI,STACTA,STACIT,PostGISRaster");
    CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", "none"); /* concerns /vsicurl/ and similar names */
    GDALAllRegister();
    if (GDALGetCacheMax64() > most_cache) GDALSetCacheMax64(most_cache);
    return STATUS_OK;
}

const char *reader_reason(const char *else_text)
{
    const char *text = CPLGetLastErrorMsg();
    return text && *text ? text : else_text;
}

void reader_quiet(void)
{
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
}

void reader_loud(void) { CPLPopErrorHandler(); }
