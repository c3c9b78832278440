/* terrain/import/source_places.h: whether the sources that a terrain store names lie in its own folder. */
#ifndef TERRAIN_IMPORT_SOURCE_PLACES_H
#define TERRAIN_IMPORT_SOURCE_PLACES_H

#include "terrain/import/options.h"

#include <limits.h>

/* The folder that a store lies in, links followed. False: it is not there. */
bool source_folder(char out[PATH_MAX], const char *store);
/* Links are followed; what is not there goes by its name; a name that is no file's (of a server, in an archive) lies
 * outside. outside: the first of the sources that does, "" for none. */
bool sources_within(char *outside, size_t outside_size, const TerrainOptions *options, const char *folder);

#endif
