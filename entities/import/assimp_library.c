/* entities/import/assimp_library.c: the functions of assimp that assimp.c calls. */
#include "entities/import/assimp_library.h"

#define ASSIMP(X)                                                                                                     \
    X(aiCreatePropertyStore) X(aiGetErrorString) X(aiGetMaterialColor) X(aiGetMaterialString)                          \
    X(aiGetMaterialTextureCount) X(aiImportFileExWithProperties) X(aiIsExtensionSupported)                             \
    X(aiSetImportPropertyInteger)
LIBRARY(assimp_library, ASSIMP, "assimp", PITVIPER_ASSIMP_FILE, "libassimp5");
