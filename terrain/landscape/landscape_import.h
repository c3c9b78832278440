/* terrain/landscape/landscape_import.h: real ground: elevation, land cover and a photograph from files. */
#ifndef TERRAIN_LANDSCAPE_LANDSCAPE_IMPORT_H
#define TERRAIN_LANDSCAPE_LANDSCAPE_IMPORT_H

#include "terrain/landscape/elevation_import.h"
#include "terrain/landscape/ground_image.h"

typedef struct LandscapeFiles {
    ElevationFiles elevation;
    const char    *cover, *cover_table, *photo; /* empty: none */
    int            cover_band;                  /* 0: chosen */
    uint64_t       seed;                        /* of texture, and of surfaces not in the files */
} LandscapeFiles;

typedef struct LandscapeReport {
    ElevationReport elevation;
    CoverReport     cover;        /* where cover is named */
    double          photo_posting_m;
} LandscapeReport;

/* fix: as elevation_import. Failures are logged with file and next step. */
Status landscape_import(Landscape *out, LandscapeReport *report, const LandscapeFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count);

#endif
