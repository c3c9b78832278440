/* terrain/import/options.h: what a terrain store is made from and how: from a command line, or from the header of an
 * existing store. */
#ifndef TERRAIN_IMPORT_OPTIONS_H
#define TERRAIN_IMPORT_OPTIONS_H

#include "terrain/landscape/elevation_import.h"

enum { terrain_paths_size = 16384, terrain_path_size = 4096 };

typedef struct TerrainOptions {
    /* lists of files and folders, separated by commas; empty: none */
    char   elevation[terrain_paths_size], surface[terrain_paths_size], cover[terrain_paths_size],
        photo[terrain_paths_size], canopy_height[terrain_path_size], canopy_cover[terrain_path_size];
    char   cover_table[terrain_path_size], geoid[terrain_path_size]; /* empty: chosen; EGM96 */
    char   unit[16], srs[128], nodata[32]; /* of elevation and surface files that have none after their name */
    char   sources_from[terrain_path_size]; /* folders of files that other files name (raster_sources_from) */
    ElevationVertical vertical;
    double spacing_m;             /* 0: the posting of the finest data */
    double origin_deg[2];         /* latitude, longitude; NaN: middle of the finest data */
    double size_km[2];            /* 0: all data */
    double horizon_km;
    double most_gb;               /* that may be written; 64 times as much decoded */
} TerrainOptions;

void   terrain_options_default(TerrainOptions *out);
/* One option by its name: elevation (added to those before), surface, cover, cover-table, photo, canopy-height,
 * canopy-cover, geoid, sources-from, vertical, unit, srs, nodata, spacing, origin, size, horizon, most-gb. False: *why says what is
 * accepted, in static storage,
 * and nothing has changed. */
bool   terrain_options_set(TerrainOptions *o, const char **why, const char *name, const char *value);
/* The names of a list of elevation or surface files, each with what the options choose for it after it
 * (raster_choice.h). False: too long. */
bool   terrain_options_sources(char *out, size_t out_size, const TerrainOptions *o, const char *list);
/* What is missing or contradicts, in static storage; NULL: nothing. */
const char *terrain_options_fault(const TerrainOptions *o);
/* `name value`, a line each, paths absolute; those that have their default are left out. False: too long. */
bool   terrain_options_text(char *out, size_t out_size, const TerrainOptions *o);
/* The text of a store's header. False: *why, and *line from 1 on. */
bool   terrain_options_parse(TerrainOptions *out, const char **why, int *line, const char *text);

#endif
