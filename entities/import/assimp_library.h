/* entities/import/assimp_library.h: assimp, loaded when a model file is first imported. */
#ifndef ENTITIES_IMPORT_ASSIMP_LIBRARY_H
#define ENTITIES_IMPORT_ASSIMP_LIBRARY_H

#include "pitviper_library.h"

extern Library assimp_library;

#endif
