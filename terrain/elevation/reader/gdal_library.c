/* terrain/elevation/reader/gdal_library.c: the functions of GDAL that the reader calls. */
#include "terrain/elevation/reader/gdal_library.h"

#define GDAL(X)                                                                                                       \
    X(CPLErrorReset) X(CPLGetLastErrorMsg) X(CPLPopErrorHandler) X(CPLPushErrorHandler) X(CPLQuietErrorHandler)       \
    X(CPLSetErrorHandler) X(GDALGetDataCoverageStatus) X(GDALGetDatasetDriver) X(GDALGetDescription)    \
    X(CSLAddString) X(OSRGetPROJSearchPaths)                                                                          \
    X(CPLSetConfigOption) X(CSLDestroy) X(GDALGetFileList)                                                            \
    X(GDALAllRegister) X(GDALClose) X(GDALDataTypeIsInteger) X(GDALDatasetRasterIO) X(GDALGetBlockSize)               \
    X(GDALGetCacheMax64) X(GDALGetGeoTransform) X(GDALGetMaskBand) X(GDALGetMaskFlags) X(GDALGetRasterBand)           \
    X(GDALGetRasterCount) X(GDALGetRasterDataType) X(GDALGetRasterOffset) X(GDALGetRasterScale)                       \
    X(GDALGetRasterUnitType) X(GDALGetRasterXSize) X(GDALGetRasterYSize) X(GDALGetSpatialRef) X(GDALIdentifyDriver)   \
    X(GDALInvGeoTransform) X(GDALOpen) X(GDALRasterIO) X(GDALSetCacheMax64) X(OCTDestroyCoordinateTransformation)     \
    X(OCTNewCoordinateTransformation) X(OCTTransform) X(OSRClone) X(OSRDemoteTo2D) X(OSRDestroySpatialReference)      \
    X(OSRGetAngularUnits) X(OSRGetAxesCount) X(OSRImportFromEPSG) X(OSRIsCompound) X(OSRIsGeographic) X(OSRIsSame)    \
    X(OSRNewSpatialReference) X(OSRSetAxisMappingStrategy) X(OSRStripVertical)
LIBRARY(gdal_library, GDAL, "GDAL", PITVIPER_GDAL_FILE, "libgdal32");
