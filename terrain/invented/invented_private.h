/* terrain/invented/invented_private.h: what the files that fit the posts of invented ground share.
 *
 * invented.c      layout of the levels, and the sequence of steps
 * field.c         smooth fields: cubic B-splines refined octave by octave, with hills and fixes in them
 * votes.c         which entities are consistent with the others
 * fit.c           which fixes are consistent, and the last centimetres on the posts themselves
 * clear_lines.c   height limits by clear lines
 * coast.c         extent of the sea, and the transition from land to it
 * plots.c         fields, and the hedgerows between them
 * ways.c          roads, streams, villages (ways_private.h) */
#ifndef TERRAIN_INVENTED_INVENTED_PRIVATE_H
#define TERRAIN_INVENTED_INVENTED_PRIVATE_H

#include "terrain/elevation/levels.h"
#include "terrain/invented/invented.h"

/* ---- points by place ---------------------------------------------------------------------- */

/* Point numbers sorted by square cell; every query walks the 3 x 3 cells about a place. */
typedef struct NearGrid {
    double   cell_m;
    int      count;
    uint32_t mask;
    int     *start; /* [mask + 2] first of each bucket in item */
    int     *item;  /* [count] ascending within a bucket */
} NearGrid;

Status near_grid_create(NearGrid *out, double cell_m, int count, const double *x_m, const double *y_m, size_t stride);
void   near_grid_destroy(NearGrid *grid);

/* Bucket of a cell: items [*first, *end) of grid->item. Other cells share buckets: check the distance. */
void                  near_grid_bucket(const NearGrid *grid, int64_t ci, int64_t cj, int *first, int *end);
static inline int64_t near_grid_cell(const NearGrid *grid, double x_m) { return (int64_t)floor(x_m / grid->cell_m); }

enum { lowest_ground_m = -1000 }; /* nothing on the ground or above it is lower; the Dead Sea's shore is at -430 */

/* ---- fixes -------------------------------------------------------------------------------- */

/* One accepted fix of the ground; fixes equal within 1 cm share a row. */
typedef struct FixRow {
    double x_m, y_m, z_m; /* ENU */
    double h_m;           /* above the ellipsoid */
    int    fix;           /* its number in the caller's array */
    int    weight;        /* source entities that share it */
    int    level;         /* level it lies on */
    bool   dropped;
} FixRow;

typedef struct FixSet {
    int      count;
    FixRow  *row;
    int     *row_of_fix; /* [fix_count] row each fix shares, -1: dropped by itself */
    NearGrid near;       /* of the rows */
} FixSet;

Status fix_set_create(FixSet *out, const LocalFrame *frame, const GroundFix *fix, int fix_count, double horizon_m);
void   fix_set_destroy(FixSet *set);

/* ---- fields ------------------------------------------------------------------------------- */

/* Share of the synthetic relief near fixes, on its own coarse grid. */
typedef struct Calm {
    Field factor; /* v NULL: 1 everywhere */
} Calm;

/* A height the smooth field should pass through, or only stay below. */
typedef struct FieldAim {
    double x_m, y_m, h_m;
    bool   ceiling;
} FieldAim;

/* The same spline on control points half as far apart. The window must lie two fine points inside. */
Status field_refine(Field *out, const Field *coarse, int i0, int j0, int nx, int ny);
/* Values of the spline at its own knots. The window must lie one point inside. */
Status field_posts(Field *out, const Field *spline, int i0, int j0, int nx, int ny);
void   field_add_hills(Field *spline, uint64_t seed, double rms_m, const Calm *calm);
Status field_pull(Field *spline, const FieldAim *aim, int count);
Status calm_create(Calm *out, const FixSet *fixes, double cell_m);

/* ---- posts of one level ------------------------------------------------------------------- */

/* Moves posts until every row of this level is fitted, below cap, the outline unchanged; drops rows that the posts
 * cannot fit together with their neighbours. */
void fit_posts(WorkLevel *level, int index, FixSet *fixes);

/* ---- clear lines -------------------------------------------------------------------------- */

/* Within this distance of an end at a fix the line sets no limit. Two diagonals of a cell and a little: closer, the
 * line would limit the posts of the fix. */
static inline double taper_of_spacing_m(double spacing_m) { return 3.5 * spacing_m; }

typedef struct LineSet {
    int        count;
    ClearLine *line;        /* the usable ones */
    int        touch_count; /* positions where a line ends at a fix */
    double    *touch;       /* [touch_count][3] */
    NearGrid   near_touch;
} LineSet;

Status line_set_create(LineSet *out, const ClearLine *line, int count, const LocalFrame *frame, const FixSet *fixes,
                       double horizon_m);
void   line_set_destroy(LineSet *set);
/* Points on the lines lower than h_m above the ellipsoid, less the clearance, as ceilings. */
Status line_ceilings(FieldAim **out, int *out_count, const LineSet *lines, const LocalFrame *frame, double h_m);
/* Cuts the level's posts to what the lines allow and drops the rows that are above it. */
Status line_cut(WorkLevel *level, int index, const LineSet *lines, FixSet *fixes);

/* ---- coast -------------------------------------------------------------------------------- */

Status coast_create(Coast *out, const LandscapeEvidence *evidence, uint64_t seed);
void   coast_destroy(Coast *coast);
/* Heights above the ellipsoid of a level's posts led down to the sea; its water posts marked. */
Status coast_shape(WorkLevel *level, const Coast *coast);

/* ---- ways --------------------------------------------------------------------------------- */

/* What ways are laid out on. */
typedef struct WaysGround {
    const Elevation *elevation;
    const Coast     *coast;
    uint64_t         seed;
    int              fix_count;
    const GroundFix *fix;
} WaysGround;

Status ways_create(Ways **out, const WaysGround *ground);
void   ways_free(Ways *ways); /* accepts NULL */

#endif
