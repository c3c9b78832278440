/* terrain/woods/woods_table.h: what grows on each surface class (etc/woods.csv). */
#ifndef TERRAIN_WOODS_WOODS_TABLE_H
#define TERRAIN_WOODS_WOODS_TABLE_H

#include "terrain/surface.h"
#include "terrain/woods/plant.h"

typedef struct WoodsClass {
    double    per_m2;               /* woody plants */
    double    low_m, high_m;
    double    share[PLANT_STANDING]; /* their sum is 1, or 0 where per_m2 is 0 */
    PlantKind floor;                /* PLANT_KINDS: none */
    double    floor_per_m2, floor_low_m, floor_high_m;
} WoodsClass;

typedef struct WoodsTable {
    WoodsClass of[SURFACE_COUNT];
} WoodsTable;

/* STATUS_BAD_VALUE: logged, with file, line and value. */
Status woods_table_read(WoodsTable *out, const char *path);

#endif
