/* render/trace/plants/plant_table.h: what rays meet of a prototype, by table: for plants that are low in the picture.
 *
 * A table holds, for each of a set of directions and each texel of a square across it, the quad and the depth that one
 * ray at a random place of the texel meets. A ray is looked up under the direction nearest to it, half a step off at
 * most (5.6 degrees about the axis, 3.75 in elevation). Coarser levels hold one of the texels that they cover, chosen
 * at random: a look-up of any level is one sample, with the statistics of a ray.
 *
 * A texel is traced when it is first asked for, and kept. It is a pure function of the prototype: neither the order of
 * asking nor the thread that traces it shows. */
#ifndef RENDER_TRACE_PLANTS_PLANT_TABLE_H
#define RENDER_TRACE_PLANTS_PLANT_TABLE_H

#include "pitviper.h"

struct ShapeScene;

enum {
    table_azimuths = 32,
    table_elevations = 15,
    table_ways = table_azimuths * table_elevations,
    table_side = 128, /* texels of the finest level; each further has half of them */
    table_levels = 4,
    /* a texel: what was met. Of a hit: 2 + quad in the lower bits, depth in the upper, signed, in radius /
     * table_depth_steps behind the middle of the prototype's box. */
    table_unset = 0, /* not traced yet */
    table_nothing = 1,
    table_quad_bits = 18,
    table_quad_mask = (1 << table_quad_bits) - 1,
    table_depth_steps = 8000
};

/* A direction of the table in the prototype's axes, and the square across it, about the middle of the box: a point p
 * from there is in it where u . p and v . p are within -1 and 1. */
typedef struct TableWay {
    double d[3], u[3], v[3]; /* unit; over half the square's widths */
} TableWay;

typedef struct PlantTable {
    const struct ShapeScene *shape;
    double                   radius;              /* of a sphere about the box, of a plant 1 m high */
    double                   step;                /* width of a texel of the finest level, likewise */
    TableWay                 way[table_ways];     /* elevations from 15 degrees upwards to straight down */
    uint32_t                *level[table_levels]; /* [table_ways][side][side] */
} PlantTable;

/* Its memory, 23.5 MB, is the machine's only where it is asked for. STATUS_NO_MEMORY; STATUS_UNSUPPORTED: the prototype
 * has too many quads. */
Status plant_table_create(PlantTable **out, const struct ShapeScene *shape);
void   plant_table_destroy(PlantTable *table); /* accepts NULL */

/* The way nearest to a direction of any length in the prototype's axes, within 0.3 degrees; -1: it rises by more than
 * 15 degrees, which no table holds. */
int plant_table_way(const double d[3]);
/* The texels of a way and level, in rows by v. */
static inline const uint32_t *plant_table_texels(const PlantTable *table, int way, int level)
{
    const size_t side = table_side >> level;
    return table->level[level] + (size_t)way * side * side;
}
/* Traces a texel that is table_unset there, and keeps it. Thread-safe. */
uint32_t plant_table_trace(PlantTable *table, int way, int level, int place);

#endif
