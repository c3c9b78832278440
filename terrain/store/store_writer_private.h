/* terrain/store/store_writer_private.h: a store being written, and its landscape: shared by the files of this folder.
 *
 * store_write.c   the file, the plan, rasters, and the end
 * store_rows.c    rows of posts to tiles; rows of a photograph to blocks and mips */
#ifndef TERRAIN_STORE_STORE_WRITER_PRIVATE_H
#define TERRAIN_STORE_STORE_WRITER_PRIVATE_H

#include "terrain/store/store_format_private.h"

/* Rows of one level that are not yet in tiles. */
typedef struct PostRows {
    int      done;  /* rows given so far */
    int      first; /* number of the buffer's first row: a multiple of elevation_tile_cells */
    int      count, capacity;
    int      shaped; /* rows of tiles that have bases and shifts */
    int32_t *row;    /* [capacity][nx] */
    int      seam_shift;
} PostRows;

/* Rows of one mip, up to four, which make a row of blocks. */
typedef struct MipRows {
    int      done; /* rows given so far */
    uint8_t *row;  /* [4][nx][4] */
} MipRows;

struct StoreWriter {
    char        *path, *part;
    int          file;
    uint8_t     *map;
    uint64_t     map_octets, end; /* end: offset behind the crowns written so far */
    Pool        *pool;
    StoreHeader *header; /* header with its texts, header_octets in all */
    uint64_t     seed, crowns;
    Elevation    elevation; /* its arrays are in the map */
    PostRows     posts[elevation_max_levels];
    Photo        photo; /* its blocks are in the map */
    MipRows      mip[ground_image_mips];
    uint8_t     *halved; /* a row of the next mip */
    int          surface_rows[cover_windows], canopy_height_rows, canopy_cover_rows;
};

Status store_posts_begin(StoreWriter *writer, int level, int seam_shift);
void   store_posts_end(StoreWriter *writer);
Status store_albedo_begin(StoreWriter *writer);
void   store_albedo_end(StoreWriter *writer);

/* The landscape of an attached store, whose frame is set; for its reader and its writer. It borrows the store's arrays,
 * and takes over map where that is not NULL. */
Status store_landscape(Landscape *out, const TerrainStore *store, uint64_t seed, const LandscapeMap *map);

#endif
