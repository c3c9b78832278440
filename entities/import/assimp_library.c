/* entities/import/assimp_library.c: the functions of assimp that assimp.c calls. */
#include "entities/import/assimp_library.h"

#define ASSIMP(X)                                                                                                     \
    X(aiGetErrorString) X(aiGetMaterialColor) X(aiGetMaterialString) X(aiGetMaterialTextureCount) X(aiImportFileEx)   \
    X(aiIsExtensionSupported)
LIBRARY(assimp_library, ASSIMP, "assimp", PITVIPER_ASSIMP_FILE, "libassimp5");
