/* sensor/verify/saved_frame/saved_fields_ground.c: the ground of a frame file, field by field: evidence, elevation,
 * cover, photograph. */
#include "sensor/verify/saved_frame/saved_frame_private.h"

#include "terrain/ground/ground_image.h"

#include <stdlib.h>

static void fix_fields(Fields *f, void *record)
{
    GroundFix *fix = record;
    field_reals(f, "place of the ground", fix->p_enu, 3, local_m);
    field_int(f, "voter", &fix->voter, 0, INT32_MAX - 1);
}

static void line_fields(Fields *f, void *record)
{
    ClearLine *line = record;
    field_reals(f, "clear line", line->a_enu, 3, local_m);
    field_reals(f, "clear line", line->b_enu, 3, local_m);
}

static void place_fields(Fields *f, void *record)
{
    CoastPlace *place = record;
    field_real(f, "place of sea or land", &place->x_m, -local_m, local_m);
    field_real(f, "place of sea or land", &place->y_m, -local_m, local_m);
    field_bool(f, "place of sea or land", &place->sea);
}

static void evidence_fields(Fields *f, LandscapeEvidence *said)
{
    enum { most = landscape_parts_rows };
    field_real(f, "height of the sea", &said->sea_h_m, -local_m, local_m);
    field_list(f, &said->fix_count, (void **)&said->fix, sizeof *said->fix, most, fix_fields);
    field_list(f, &said->line_count, (void **)&said->line, sizeof *said->line, most, line_fields);
    field_list(f, &said->place_count, (void **)&said->place, sizeof *said->place, most, place_fields);
}

/* The values of a grid; reading, they are all allocated. */
static void grid_values(Fields *f, const GroundCutout *kept, void **values, const CutoutGrid *grid)
{
    if (f->to) {
        ground_cutout_put(f->to, grid, *values, kept);
        return;
    }
    *values = fields_good(f) ? arena_alloc(f->arena, (size_t)grid->nx * (size_t)grid->ny, (size_t)grid->octets) : NULL;
    if (fields_good(f) && !*values) f->no_memory = true;
    if (*values && grid->octets == (int)sizeof(PhotoBlock)) /* omitted: not covered */
        for (size_t n = 0; n < (size_t)grid->nx * (size_t)grid->ny; n++) ((PhotoBlock *)*values)[n].index = 0xffffffff;
    if (*values) ground_cutout_get(f->from, grid, *values);
}

/* Limits the values in all of a ground's grids of one kind to `most`. */
static void limit(Fields *f, const char *name, size_t *sum, int nx, int ny, size_t most)
{
    *sum += (size_t)nx * (size_t)ny;
    if (f->from && fields_good(f) && *sum > most) f->fault = name;
}

/* Base and shift of each tile, which version 1 did not have; reading, they are allocated. */
static void tile_fields(Fields *f, ElevationLevel *l)
{
    const int tiles = l->tiles_x * l->tiles_y;
    if (f->from) {
        l->tile = arena_alloc(f->arena, (size_t)tiles, sizeof *l->tile);
        f->no_memory |= !l->tile;
        if (!l->tile) return;
        memset(l->tile, 0, (size_t)tiles * sizeof *l->tile);
    }
    if (f->version >= 2) field_bool(f, "tiles of a level", &l->plain);
    for (int t = 0; t < tiles && !l->plain && fields_good(f); t++) {
        field_int(f, "base of a tile", &l->tile[t].base, elevation_lowest_post, elevation_highest_post);
        field_int(f, "shift of a tile", &l->tile[t].shift, 0, elevation_most_shift);
        if (fields_good(f) && l->tile[t].base % elevation_base_unit != 0) f->fault = "base of a tile";
    }
}

/* Puts stored posts into rows; the posts of an edge are stored in the tile that begins with it. */
static void stored_to_rows(uint16_t *post, const ElevationLevel *l)
{
    for (int j = 0; j < l->ny; j++)
        for (int i = 0; i < l->nx; i++) *post++ = l->stored[elevation_stored_index(l, i, j)];
}

static void stored_from_rows(ElevationLevel *l, const uint16_t *post)
{
    for (int j = 0; j < l->ny; j++)
        for (int i = 0; i < l->nx; i++) {
            const ElevationTile tile = l->tile[elevation_tile_index(l, i, j)];
            elevation_set_post(l, i, j, tile.base + ((int32_t)*post++ << tile.shift));
        }
    elevation_fill_edges(l);
}

static void post_fields(Fields *f, ElevationLevel *l, const GroundCutout *kept)
{
    uint16_t *post = NULL;
    if (f->from && fields_good(f)) {
        ElevationLevel described;
        if (elevation_level_describe(&described, &(ElevationGrid){l->nx, l->ny, l->x0_m, l->y0_m, l->spacing_m, l->z0_m,
                                                                  l->step_m}) != STATUS_OK)
            f->fault = "size of a level";
        else *l = described;
    }
    if (fields_good(f)) tile_fields(f, l);
    if (!fields_good(f)) return;
    if (f->to) {
        post = malloc((size_t)l->nx * (size_t)l->ny * sizeof *post);
        f->no_memory |= !post;
        if (post) stored_to_rows(post, l);
    }
    const CutoutGrid grid = {l->nx, l->ny, 2, l->x0_m, l->y0_m, l->spacing_m};
    if (post || f->from) grid_values(f, kept, (void **)&post, &grid);
    if (f->to) {
        free(post);
    } else if (post) {
        l->stored = arena_alloc(f->arena, elevation_level_stored(l), sizeof *l->stored);
        f->no_memory |= !l->stored;
        if (l->stored) stored_from_rows(l, post);
    }
}

static void level_fields(Fields *f, ElevationLevel *l, size_t *posts, const GroundCutout *kept)
{
    field_int(f, "posts of a level", &l->nx, 2, elevation_most_posts);
    field_int(f, "posts of a level", &l->ny, 2, elevation_most_posts);
    field_real(f, "place of a level", &l->x0_m, -local_m, local_m);
    field_real(f, "place of a level", &l->y0_m, -local_m, local_m);
    field_real(f, "spacing of a level", &l->spacing_m, 0.1, 1e5);
    field_real(f, "height of a level", &l->z0_m, -local_m, local_m);
    field_real(f, "step of a level", &l->step_m, 1e-9, 100);
    limit(f, "posts of the ground", posts, l->nx, l->ny, landscape_parts_posts);
    post_fields(f, l, kept);
}

static void cover_fields(Fields *f, CoverGrid *g, size_t *cells, const GroundCutout *kept)
{
    field_int(f, "cells of the cover", &g->nx, 0, 32768);
    field_int(f, "cells of the cover", &g->ny, 0, 32768);
    if (!fields_good(f) || g->nx == 0 || g->ny == 0) {
        g->nx = g->ny = 0;
        return;
    }
    field_real(f, "place of the cover", &g->x0_m, -local_m, local_m);
    field_real(f, "place of the cover", &g->y0_m, -local_m, local_m);
    field_real(f, "cells of the cover", &g->cell_m, 1e-3, 1e6);
    limit(f, "cells of the cover", cells, g->nx, g->ny, landscape_parts_cells);
    grid_values(f, kept, (void **)&g->surface, &(CutoutGrid){g->nx, g->ny, 1, g->x0_m, g->y0_m, g->cell_m});
}

static void photo_fields(Fields *f, Photo *p, const GroundCutout *kept)
{
    size_t pixels = 0;
    field_int(f, "photograph", &p->mips, 0, ground_image_mips);
    if (f->version < 2 && p->mips > 0) f->fault = "photograph of version 1";
    if (!fields_good(f) || p->mips == 0) return;
    field_real(f, "place of the photograph", &p->x0_m, -local_m, local_m);
    field_real(f, "place of the photograph", &p->y0_m, -local_m, local_m);
    field_real(f, "pixels of the photograph", &p->cell_m, 1e-3, 1e6);
    field_floats(f, "mean of the photograph", &p->mean[0][0], SURFACE_COUNT * photo_channels, 0, 1e6f);
    for (int k = 0; k < p->mips && fields_good(f); k++) {
        field_int(f, "pixels of the photograph", &p->nx[k], 1, 65536);
        field_int(f, "pixels of the photograph", &p->ny[k], 1, 65536);
        limit(f, "pixels of the photograph", &pixels, p->nx[k], p->ny[k], landscape_parts_pixels);
        const int across = (int)photo_blocks_across(p->nx[k]), up = (int)photo_blocks_across(p->ny[k]);
        grid_values(f, kept, (void **)&p->block[k],
                    &(CutoutGrid){across, up, sizeof **p->block, p->x0_m, p->y0_m, ldexp(p->cell_m, k + 2)});
    }
}

void saved_fields_ground(Fields *f, SavedFrame *file, const GroundCutout *kept)
{
    LandscapeParts *g = &file->ground;
    size_t          posts = 0, cells = 0;
    field_real(f, "latitude of the origin", &g->frame.origin.lat_rad, -pi_rad / 2, pi_rad / 2);
    field_real(f, "longitude of the origin", &g->frame.origin.lon_rad, -4, 4);
    field_real(f, "height of the origin", &g->frame.origin.h_m, -earth_m, earth_m);
    const Geodetic origin = g->frame.origin;
    const Status   placed = f->from && fields_good(f) ? local_frame_at(&g->frame, &origin) : STATUS_OK;
    if (placed == STATUS_NO_MEMORY) f->no_memory = true;
    else if (placed != STATUS_OK) f->fault = "origin";
    field_u64(f, &g->config.seed);
    field_real(f, "relief", &g->config.relief_m, 0, 200);
    field_real(f, "spacing of the ground", &g->config.spacing_m, 0, 1e5);
    field_real(f, "width of the ground", &g->config.half_width_m, 0, local_m);
    field_real(f, "horizon", &g->config.horizon_m, 0, local_m);
    field_bool(f, "invented ground", &g->invented);
    if (!fields_good(f)) return;
    if (g->invented) {
        evidence_fields(f, &g->said);
        return;
    }
    if (!g->store) g->store = "";
    if (f->version >= 2) {
        field_text(f, &g->store, 4096);
        field_u64(f, &g->store_content);
    }
    if (!fields_good(f) || (g->store && *g->store)) return;
    field_u64(f, &g->cover_seed);
    field_real(f, "geoid", &g->geoid_m, -1e4, 1e4);
    field_real(f, "treeline", &g->treeline_m, -1e5, 1e5);
    field_int(f, "levels", &g->elevation.level_count, 1, elevation_max_levels);
    for (int n = 0; n < g->elevation.level_count && fields_good(f); n++)
        level_fields(f, &g->elevation.level[n], &posts, kept);
    for (int w = 0; w < cover_windows && fields_good(f); w++) cover_fields(f, &g->cover[w], &cells, kept);
    if (fields_good(f)) photo_fields(f, &g->photo, kept);
}
