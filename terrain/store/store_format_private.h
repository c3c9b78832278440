/* terrain/store/store_format_private.h: the octets of a terrain store (etc/TERRAIN_STORE.md).
 *
 * A header, whose texts follow it, and sections at multiples of a page. All numbers are little-endian, double and float
 * IEEE 754. Offsets and sizes of sections follow from the sizes of levels and rasters: a file whose table says anything
 * else is damaged, so no offset of a file is ever used unchecked. */
#ifndef TERRAIN_STORE_STORE_FORMAT_PRIVATE_H
#define TERRAIN_STORE_STORE_FORMAT_PRIVATE_H

#include "terrain/store/store.h"

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a header is read as it is");

enum { store_version = 1, store_page = 4096, store_most_text = 1 << 20, store_classes = 32 };
_Static_assert((int)SURFACE_COUNT <= (int)store_classes, "means of every class fit");

static const char store_magic[8] = "PVTERR\r\n"; /* the line end reveals a copy that was made as text */

/* Sections in the order of the file. Of each level: its tiles, its posts, its pyramid (of each k from
 * elevation_pyramid_first on the heights, then from elevation_rise_level on the rises, each from a multiple of 64). */
enum {
    STORE_TILES,
    STORE_POSTS = STORE_TILES + elevation_max_levels,
    STORE_PYRAMID = STORE_POSTS + elevation_max_levels,
    STORE_SURFACE = STORE_PYRAMID + elevation_max_levels,
    STORE_ALBEDO =
        STORE_SURFACE + cover_windows, /* blocks of all mips, the largest first, each starting at a multiple of 64 */
    STORE_CANOPY_HEIGHT,
    STORE_CANOPY_COVER,
    STORE_CROWNS,
    STORE_SECTIONS
};
_Static_assert((int)STORE_SECTIONS < (int)store_sections_most, "and the header");

typedef enum StoreText {
    STORE_SOURCES,
    STORE_OPTIONS,
    STORE_CRS,
    STORE_DATUM,
    STORE_PROVENANCE,
    STORE_TEXTS
} StoreText;

typedef struct StoreSection {
    uint64_t offset, octets; /* 0, 0: the section is empty */
} StoreSection;

typedef struct StoreHeaderLevel {
    int32_t nx, ny;
    double  x0_m, y0_m, spacing_m, z0_m, step_m, worst_m;
    int32_t pyramid_base, pyramid_shift, rise_shift, plain;
} StoreHeaderLevel;

typedef struct StoreHeader {
    char     magic[8];
    uint32_t version, classes; /* classes: SURFACE_COUNT when it was written, which defines the octets' meaning */
    uint64_t file_octets;
    uint64_t header_octets;         /* octets of the header and its texts; a multiple of a page */
    uint64_t checksum;              /* checksum of header and texts, computed with this field 0 */
    uint64_t content;               /* hash of all sections, levels and rasters */
    char     made[32];              /* UTC */
    double   lat_rad, lon_rad, h_m; /* origin */
    double   posting_m, geoid_m;
    int32_t  level_count, spare;
    StoreHeaderLevel level[elevation_max_levels];
    StoreGrid        surface[cover_windows], albedo, canopy_height, canopy_cover;
    float            mean[store_classes][photo_channels];
    uint64_t         crown_count, building_count;
    StoreSection     section[STORE_SECTIONS];
    uint32_t text[STORE_TEXTS]; /* octets of each text with its 0; the texts follow the header one after another */
} StoreHeader;
_Static_assert(sizeof(StoreHeader) <= store_page && sizeof(StoreGrid) == 32 && sizeof(StoreHeaderLevel) == 72,
               "no padding");
_Static_assert(sizeof(PhotoBlock) == 8 && sizeof(ElevationTile) == 8 && sizeof(Crown) == 16 &&
                   sizeof(ElevationRise) == 8,
               "as in the file");

uint64_t store_checksum(const StoreHeader *header); /* The texts of the header must follow it in memory. */

/* Fills in section[] and file_octets from levels, rasters, crown_count and header_octets. False: too large. */
bool store_layout(StoreHeader *header);

/* Octets of the header and its texts, from the first page of a file of file_octets. STATUS_BAD_VALUE or
 * STATUS_UNSUPPORTED: *why says the reason (static storage). */
Status store_header_size(size_t *octets, const char **why, const StoreHeader *first, uint64_t file_octets);
/* Checks all of the header and its texts: whether every size, offset and number is in range. */
Status      store_header_check(const char **why, const StoreHeader *header, size_t octets, uint64_t file_octets);
const char *store_text(const StoreHeader *header, StoreText text);

/* The text STORE_OPTIONS that records some options, malloc'd; and the options in such a text. */
char *store_record(const char *options);

/* Sets levels, rasters and texts of `out` from a checked header, whose sections are at map + offset. */
void store_attach(TerrainStore *out, const StoreHeader *header, uint8_t *map);
/* Hash of levels, rasters and sections. pool NULL: one thread. */
uint64_t store_content(const StoreHeader *header, const uint8_t *map, Pool *pool);

#endif
