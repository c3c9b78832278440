/* terrain/elevation/reader/gdal_library.c: the functions of GDAL that the reader calls. */
#include "terrain/elevation/reader/gdal_library.h"

#define GDAL(X)                                                                                                       \
    X(CPLErrorReset) X(CPLGetLastErrorMsg) X(CPLPopErrorHandler) X(CPLPushErrorHandler) X(CPLQuietErrorHandler)       \
    X(CPLSetConfigOption) X(CPLSetErrorHandler) X(CSLAddString) X(CSLDestroy) X(GDALAllRegister) X(GDALClose)         \
    X(GDALDataTypeIsInteger) X(GDALDatasetRasterIO) X(GDALGetBlockSize) X(GDALGetCacheMax64)                          \
    X(GDALGetDataCoverageStatus) X(GDALGetDataTypeName) X(GDALGetDatasetDriver) X(GDALGetDescription)                 \
    X(GDALGetFileList) X(GDALGetGeoTransform) X(GDALGetMaskBand) X(GDALGetMaskFlags) X(GDALGetMetadata)               \
    X(GDALGetMetadataItem) X(GDALGetRasterBand) X(GDALGetRasterColorInterpretation) X(GDALGetRasterCount)             \
    X(GDALGetRasterDataType) X(GDALGetRasterNoDataValue) X(GDALGetRasterOffset) X(GDALGetRasterScale)                 \
    X(GDALGetRasterUnitType) X(GDALGetRasterXSize) X(GDALGetRasterYSize) X(GDALGetSpatialRef) X(GDALIdentifyDriver)   \
    X(GDALInvGeoTransform) X(GDALOpen) X(GDALRasterIO) X(GDALSetCacheMax64) X(OCTDestroyCoordinateTransformation)     \
    X(OCTNewCoordinateTransformation) X(OCTTransform) X(OSRClone) X(OSRDemoteTo2D) X(OSRDestroySpatialReference)      \
    X(OSRGetAngularUnits) X(OSRGetAttrValue) X(OSRGetAxesCount) X(OSRGetAxis) X(OSRGetLinearUnits) X(OSRGetName)      \
    X(OSRGetPROJSearchPaths) X(OSRGetTargetLinearUnits) X(OSRImportFromEPSG) X(OSRIsCompound) X(OSRIsGeographic)      \
    X(OSRIsProjected) X(OSRIsSame) X(OSRNewSpatialReference) X(OSRSetAxisMappingStrategy) X(OSRSetFromUserInput)      \
    X(OSRStripVertical)
LIBRARY(gdal_library, GDAL, "GDAL", PITVIPER_GDAL_FILE, "libgdal32");
