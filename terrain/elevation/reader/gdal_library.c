/* terrain/elevation/reader/gdal_library.c: GDAL: the functions of it that the reader calls, loaded and prepared; what
 * it has to say is kept. */
#include "terrain/elevation/reader/reader_private.h"

#include <cpl_conv.h>

/* clang-format off */
#define GDAL(X)                                                                                                      \
    X(CPLErrorReset) X(CPLGetLastErrorType) X(CPLGetLastErrorMsg) X(CPLPopErrorHandler) X(CPLPushErrorHandler) X(CPLQuietErrorHandler)      \
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
    X(OSRNewSpatialReference) X(OSRSetAxisMappingStrategy) X(OSRSetFromUserInput) X(OSRStripVertical)               \
    X(GDALDatasetGetLayer) X(GDALDatasetGetLayerCount) X(GDALOpenEx) X(OGR_FD_GetFieldCount)                         \
    X(OGR_FD_GetFieldDefn) X(OGR_F_Destroy) X(OGR_F_GetFieldAsString) X(OGR_F_GetGeometryRef)                        \
    X(OGR_F_IsFieldSetAndNotNull) X(OGR_Fld_GetNameRef) X(OGR_GT_Flatten) X(OGR_G_DestroyGeometry)                   \
    X(OGR_G_GetGeometryCount) X(OGR_G_GetGeometryRef) X(OGR_G_GetGeometryType) X(OGR_G_GetLinearGeometry)            \
    X(OGR_G_GetPointCount) X(OGR_G_GetPoint) X(OGR_G_HasCurveGeometry) X(OGR_L_GetExtent) X(OGR_L_GetFeatureCount)  \
    X(OGR_L_GetLayerDefn) X(OGR_L_GetNextFeature) X(OGR_L_GetSpatialRef) X(OGR_L_ResetReading)                       \
    X(OGR_L_SetSpatialFilterRect)
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
    CPLSetConfigOption("OGR_GPKG_FOREIGN_KEY_CHECK", "NO"); /* a GeoPackage is read as it is */
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
