/* terrain/elevation/elevation_kept.c: levels to the octets of an entry of the cache, and back. */
#include "terrain/elevation/elevation.h"

_Static_assert(sizeof(ElevationTile) == 8 && sizeof(ElevationRise) == 8, "no padding: the octets are the numbers");

static size_t tiles_of(const ElevationLevel *l) { return (size_t)l->tiles_x * (size_t)l->tiles_y; }

/* Where posts are, by which a level is made while it is read. Its posts must be there before room is made for them. */
static void pass_grid(Kept *kept, Elevation *elevation, int index)
{
    const ElevationLevel *l = &elevation->level[index];
    int32_t               side[2] = {l->nx, l->ny};
    double                number[5] = {l->x0_m, l->y0_m, l->spacing_m, l->z0_m, l->step_m};
    kept_pass(kept, side, sizeof side);
    kept_doubles(kept, number, 5);
    if (!kept_is_read(kept) || !kept->good) return;
    const ElevationGrid grid = {side[0], side[1], number[0], number[1], number[2], number[3], number[4]};
    ElevationLevel      level;
    kept_check(kept, elevation_level_describe(&level, &grid) == STATUS_OK);
    if (!kept->good || !kept_has(kept, elevation_level_stored(&level) * sizeof *level.stored)) return;
    kept_check(kept, elevation_level_create(elevation, index, &grid) == STATUS_OK);
}

static void pass_tiles(Kept *kept, ElevationLevel *l)
{
    uint8_t plain = l->plain;
    bool    flat = true;
    kept_pass(kept, l->tile, tiles_of(l) * sizeof *l->tile);
    kept_pass(kept, &plain, sizeof plain);
    for (size_t n = 0; kept_is_read(kept) && kept->good && n < tiles_of(l); n++) {
        const ElevationTile t = l->tile[n];
        kept_check(kept, t.base >= elevation_lowest_post && t.base <= elevation_highest_post && t.shift >= 0 &&
                             t.shift <= elevation_most_shift);
        flat = flat && t.base == 0 && t.shift == 0;
    }
    kept_check(kept, plain == 0 || (plain == 1 && flat));
    l->plain = plain;
    kept_pass(kept, l->stored, elevation_level_stored(l) * sizeof *l->stored);
}

static void pass_pyramid(Kept *kept, ElevationLevel *l)
{
    int32_t number[3] = {l->pyramid_base, l->pyramid_shift, l->rise_shift};
    kept_pass(kept, number, sizeof number);
    kept_check(kept, number[1] >= 0 && number[1] <= 15 && number[2] >= 0 && number[2] <= 15);
    kept_check(kept, number[0] >= elevation_lowest_post && number[0] <= elevation_highest_post);
    l->pyramid_base = number[0], l->pyramid_shift = number[1], l->rise_shift = number[2];
    for (int k = elevation_pyramid_first; k < l->pyramid_count; k++) {
        const size_t nodes = (size_t)l->pyramid_nx[k] * (size_t)l->pyramid_ny[k];
        kept_pass(kept, l->pyramid[k], nodes * sizeof **l->pyramid);
        if (k >= elevation_rise_level) kept_pass(kept, l->rise[k], nodes * sizeof **l->rise);
    }
}

void elevation_kept_values(Kept *kept, void *user)
{
    Elevation *e = user;
    int32_t    levels = e->level_count;
    kept_pass(kept, &levels, sizeof levels);
    kept_check(kept, levels >= 1 && levels <= elevation_max_levels);
    for (int k = 0; k < levels && kept->good; k++) {
        pass_grid(kept, e, k);
        if (!kept->good) return;
        pass_tiles(kept, &e->level[k]);
        pass_pyramid(kept, &e->level[k]);
    }
}
