/* terrain/ground/landscape_parts.h: the data of a landscape as plain arrays: what a file must hold to reproduce the
 * same terrain bit by bit without its original inputs.
 *
 * A synthetic terrain is a pure function of its configuration, frame and evidence, of which it keeps a copy. One from
 * files is its posts, land cover classes and photograph as resampled in ENU. One from a terrain store is that store:
 * store_open_landscape opens it, not landscape_from_parts. */
#ifndef TERRAIN_GROUND_LANDSCAPE_PARTS_H
#define TERRAIN_GROUND_LANDSCAPE_PARTS_H

#include "terrain/ground/ground_image.h"
#include "terrain/ground/landscape.h"

typedef struct LandscapeParts {
    LocalFrame        frame;
    LandscapeConfig   config;
    bool              invented;
    const char       *store;         /* path of the terrain store; NULL or empty: no store */
    uint64_t          store_content; /* the store's hash; config.seed is the seed it was opened with */
    LandscapeEvidence said;          /* synthetic terrain: the evidence that it was fitted to */
    Elevation         elevation;     /* terrain from files: levels and posts; the pyramids are not used */
    CoverGrid         cover[cover_windows];
    Photo             photo;
    uint64_t          cover_seed;
    double            geoid_m, treeline_m;
} LandscapeParts;

/* The parts of a landscape, which they borrow from. */
void landscape_parts(LandscapeParts *out, const Landscape *landscape);
/* Makes a landscape from copies of its parts. These may come from a hostile file: STATUS_BAD_VALUE, and the reason in
 * *why (static storage). A synthetic landscape takes as long as landscape_create_from. */
Status landscape_from_parts(Landscape *out, const char **why, const LandscapeParts *parts);

/* A landscape from files that borrows the arrays of its parts (`borrowed` is set in them), which are trusted. Takes
 * over map and its path, where not NULL: landscape_destroy unmaps it. treeline_m is not used. */
Status landscape_borrow(Landscape *out, const LandscapeParts *parts, const LandscapeMap *map);
/* The seed of a landscape from files for its cover, from that of the configuration. */
uint64_t landscape_cover_seed(uint64_t seed);
/* The map of a landscape from a store; its path is NULL for any other. */
LandscapeMap landscape_map(const Landscape *landscape);
/* Means of the photograph over each class. */
void landscape_photo_means(float mean[SURFACE_COUNT][photo_channels], Landscape *landscape);

/* Whether the seams are as terrain/elevation/elevation.h requires: a level's outline runs along cell edges of the next
 * level, inside it. */
bool landscape_parts_nested(const ElevationLevel *fine, const ElevationLevel *coarse);

/* Bounds that landscape_from_parts keeps: posts of all levels, cells of a cover window, pixels of a photograph, and
 * rows of each kind of evidence. */
enum {
    landscape_parts_posts = 1 << 26,
    landscape_parts_cells = 1 << 26,
    landscape_parts_pixels = 1 << 27,
    landscape_parts_rows = 1 << 21,
};

#endif
