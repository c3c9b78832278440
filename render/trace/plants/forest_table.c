/* render/trace/plants/forest_table.c: what rays meet of a prototype, by table: for plants that are low in the picture.
 *
 * A table holds, for each of a set of directions and each texel of a square across it, the quad and the depth that one
 * ray at a random place of the texel meets. A ray is looked up under the direction nearest to it, half a step off at
 * most (5.6 degrees about the axis, 3.75 in elevation). Coarser levels hold one of the texels that they cover, chosen
 * at random: a look-up of any level is one sample, with the statistics of a ray.
 *
 * A texel is traced when it is first asked for, and kept, in the memory and between runs (forest_kept.c). It is a pure
 * function of the prototype: neither the order of asking nor the thread that traces it shows. */
#include "render/trace/plants/forest_private.h"

#include <stdlib.h>

static const double highest_rad = 15 * rad_per_deg;
static const double row_rad = 105 * rad_per_deg / (table_elevations - 1);

static const uint64_t seed = 0x7461626c65; /* of places within texels */

/* ---- directions ------------------------------------------------------------------------------- */

static void place_way(TableWay *out, const ShapeScene *shape, int way)
{
    const double up_rad = highest_rad - way / table_azimuths * row_rad;
    const double turn_rad = (way % table_azimuths + 0.5) * 2 * pi_rad / table_azimuths;
    const double level = cos(up_rad), x = cos(turn_rad), y = sin(turn_rad);
    const double d[3] = {level * x, level * y, sin(up_rad)}, u[3] = {y, -x, 0};
    double       v[3], half[2] = {0, 0};
    v3_cross(v, u, d);
    for (int c = 0; c < 3; c++) half[0] += fabs(u[c]) * shape->half[c], half[1] += fabs(v[c]) * shape->half[c];
    for (int c = 0; c < 3; c++) out->d[c] = d[c], out->u[c] = u[c] / half[0], out->v[c] = v[c] / half[1];
}

int plant_table_way(const double d[3])
{
    const double up_rad = plant_rough_angle(sqrt(d[0] * d[0] + d[1] * d[1]), d[2]);
    if (!(up_rad <= highest_rad)) return -1;
    const double turn_rad = plant_rough_angle(d[0], d[1]);
    const int    row = (int)((highest_rad - up_rad) / row_rad + 0.5);
    const int    column = (int)floor(turn_rad * (table_azimuths / (2 * pi_rad)));
    return (row < table_elevations ? row : table_elevations - 1) * table_azimuths + (column & (table_azimuths - 1));
}

/* ---- texels ----------------------------------------------------------------------------------- */

/* One ray, at a random place of a texel of the finest level. */
static uint32_t trace(const PlantTable *table, int way, int place)
{
    const TableWay *w = &table->way[way];
    const uint64_t  index = (uint64_t)way * table_side * table_side + (uint64_t)place;
    double          at[2] = {place % table_side, place / table_side}, o[3], at_m;
    uint32_t        quad;
    for (int k = 0; k < 2; k++) at[k] = (at[k] + random_uniform(seed, (uint32_t)k, 0, index)) * 2 / table_side - 1;
    for (int c = 0; c < 3; c++) /* u and v are unit vectors over half widths: times their squares, the half widths */
        o[c] = at[0] * w->u[c] / v3_dot(w->u, w->u) + at[1] * w->v[c] / v3_dot(w->v, w->v) - table->radius * w->d[c];
    if (!shape_first(&quad, &at_m, table->shape, o, w->d)) return table_nothing;
    const double depth = (at_m - table->radius) / table->radius * table_depth_steps;
    const int    whole = (int)lrint(clamp(depth, -table_depth_steps, table_depth_steps));
    return (uint32_t)whole << table_quad_bits | (quad + 2);
}

/* The texel of the finest level that one of a coarser level holds. */
static int finest_of(int way, int level, int place)
{
    const int      side = table_side >> level, most = (1 << level) - 1;
    const uint64_t index = (uint64_t)way * (uint64_t)(side * side) + (uint64_t)place;
    const int      draw = (int)(random_uniform(seed, 2, (uint32_t)level, index) * (1 << 2 * level));
    const int      x = (place % side << level) + (draw & most), y = (place / side << level) + (draw >> level & most);
    return y * table_side + x;
}

uint32_t plant_table_trace(PlantTable *table, int way, int level, int place)
{
    const int row = way / table_azimuths; /* its part in the cache */
    uint32_t *at = (uint32_t *)(uintptr_t)plant_table_texels(table, way, level) + place;
    uint32_t  texel = __atomic_load_n(at, __ATOMIC_RELAXED);
    if (texel != table_unset) return texel;
    if (level == 0 && !shape_kept_is_taken(table->kept, row)) {
        shape_kept_take(table->kept, row);
        texel = __atomic_load_n(at, __ATOMIC_RELAXED);
        if (texel != table_unset) return texel;
    }
    texel = level == 0 ? trace(table, way, place) : plant_table_trace(table, way, 0, finest_of(way, level, place));
    __atomic_store_n(at, texel, __ATOMIC_RELAXED); /* every thread that traces it stores the same */
    if (level == 0) shape_kept_count(table->kept, row, 1);
    return texel;
}

/* ---- tables ----------------------------------------------------------------------------------- */

Status plant_table_create(PlantTable **out, const ShapeScene *shape)
{
    if (shape->shape->quads + 2 > table_quad_mask) {
        log_error("forest: a prototype of %d quads has no table: %d are possible", shape->shape->quads,
                  table_quad_mask - 2);
        return STATUS_UNSUPPORTED;
    }
    PlantTable *table = calloc(1, sizeof *table);
    if (!table) return STATUS_NO_MEMORY;
    table->shape = shape;
    table->radius = v3_length(shape->half);
    table->step = 2 * table->radius / table_side;
    for (int way = 0; way < table_ways; way++) place_way(&table->way[way], shape, way);
    for (int level = 0; level < table_levels; level++) {
        const size_t side = table_side >> level;
        table->level[level] = calloc(table_ways * side * side, sizeof **table->level);
        if (table->level[level]) continue;
        plant_table_destroy(table);
        return STATUS_NO_MEMORY;
    }
    *out = table;
    return STATUS_OK;
}

void plant_table_destroy(PlantTable *table)
{
    for (int level = 0; table && level < table_levels; level++) free(table->level[level]);
    free(table);
}
