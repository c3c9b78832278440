/* terrain/landscape/cover_table.h: from the codes of land cover files to surface classes. */
#ifndef TERRAIN_LANDSCAPE_COVER_TABLE_H
#define TERRAIN_LANDSCAPE_COVER_TABLE_H

#include "terrain/surface.h"

enum { cover_codes_most = 1024 };

/* Of most files 0 is no class; where a table has it (Dynamic World's water) it is one. */
typedef struct CoverTable {
    bool    known[cover_codes_most];
    uint8_t surface[cover_codes_most];
} CoverTable;

/* A CSV of columns code and surface; logs what is wrong with it. */
Status cover_table_read(CoverTable *out, const char *path);
/* asked: as cover_grid_read has it. Empty: the table with most of the pixels' codes, 0 left out; of equals the first. name: which it
 * is, in static storage or the caller's. */
Status cover_table_choose(CoverTable *out, const char **name, const char *asked, const long histogram[cover_codes_most]);

#endif
