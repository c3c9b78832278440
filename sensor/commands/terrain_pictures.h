/* sensor/commands/terrain_pictures.h: a terrain store from above: shaded relief, and classes with a legend. */
#ifndef SENSOR_COMMANDS_TERRAIN_PICTURES_H
#define SENSOR_COMMANDS_TERRAIN_PICTURES_H

#include "terrain/store/store.h"

enum { terrain_picture_most_px = 2000 }; /* a side, without the legend */

/* Cells of window 0 of each class, of octets that are no class as SURFACE_NONE. */
void terrain_class_cells(uint64_t cells[SURFACE_COUNT], const CoverGrid *grid);

/* Level 0, north up, squares of posts averaged. Light from the north-west, 45 degrees high. */
Status terrain_picture_hillshade(const char *path, const TerrainStore *store);
/* Window 0 of the classes, squares of cells averaged. */
Status terrain_picture_classes(const char *path, const TerrainStore *store);

#endif
