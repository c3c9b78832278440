/* terrain/landscape/landscape_private.h: shared by the files of the synthetic terrain.
 *
 * landscape.c        layout of the levels, and the sequence of steps
 * levels.c           curvature, joining, quantisation: also for terrain from files
 * field.c            smooth fields: cubic B-splines refined octave by octave, with hills and fixes in them
 * votes.c            which entities are consistent with the others
 * coast.c            extent of the sea, and the transition from land to it
 * fit.c              which fixes are consistent, and the last centimetres on the posts themselves
 * clear_lines.c      height limits by clear lines
 * nearest_fix.c      spatial index of points
 * plots.c            synthetic fields
 * ways.c             roads, streams, villages: terrain/landscape/ways.h
 * hedges.c           places of hedgerows
 * cover.c            land cover: tracks, hedges, woods; land cover from files
 * texture.c          brightness from photographs
 * detail.c           noise of the ground; detail_table.c: its statistics */
#ifndef TERRAIN_LANDSCAPE_LANDSCAPE_PRIVATE_H
#define TERRAIN_LANDSCAPE_LANDSCAPE_PRIVATE_H

#include "terrain/landscape/ground_image.h"
#include "terrain/landscape/landscape.h"
#include "terrain/landscape/work_level.h"

/* ---- integer hash ------------------------------------------------------------------------- */

/* Well mixed 64 bits of (seed, a, b). The finaliser is Stafford's thirteenth variant ("Better bit mixing",
 * 2011); the odd multipliers only keep a and b apart. */
static inline uint64_t landscape_hash(uint64_t seed, int64_t a, int64_t b)
{
    uint64_t h = seed + (uint64_t)a * 0x9e3779b97f4a7c15u + (uint64_t)b * 0xd1b54a32d192ed03u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

/* Top 53 bits as [0, 1). */
static inline double unit_from_hash(uint64_t h)
{
    return (double)(h >> 11) * 0x1p-53;
}

static inline double smooth_step(double low, double high, double x)
{
    const double t = clamp((x - low) / (high - low), 0, 1);
    return t * t * (3 - 2 * t);
}

/* ---- points by place ---------------------------------------------------------------------- */

/* Point numbers sorted by square cell; every query walks the 3 x 3 cells about a place. */
typedef struct NearGrid {
    double  cell_m;
    int     count;
    uint32_t mask;
    int    *start; /* [mask + 2] first of each bucket in item */
    int    *item;  /* [count] ascending within a bucket */
} NearGrid;

Status near_grid_create(NearGrid *out, double cell_m, int count, const double *x_m, const double *y_m, size_t stride);
void   near_grid_destroy(NearGrid *grid);

/* Bucket of a cell: items [*first, *end) of grid->item. Other cells share buckets: check the distance. */
void near_grid_bucket(const NearGrid *grid, int64_t ci, int64_t cj, int *first, int *end);
static inline int64_t near_grid_cell(const NearGrid *grid, double x_m)
{
    return (int64_t)floor(x_m / grid->cell_m);
}

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
    int     count;
    FixRow *row;
    int    *row_of_fix; /* [fix_count] row each fix shares, -1: dropped by itself */
    NearGrid near;      /* of the rows */
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
double field_spline_at(const Field *spline, double x_m, double y_m); /* NaN outside */
void   field_add_hills(Field *spline, uint64_t seed, double rms_m, const Calm *calm);
Status field_pull(Field *spline, const FieldAim *aim, int count);
double field_bilinear(const Field *field, double x_m, double y_m); /* held at the edges */
Status calm_create(Calm *out, const FixSet *fixes, double cell_m);

/* ---- posts of one level ------------------------------------------------------------------- */

/* Height of the triangle of a field of posts, as elevation_height defines it; NaN outside. corner, weight: the
 * three posts and their shares. */
double posts_at(const Field *posts, double x_m, double y_m, int corner[3], double weight[3]);

/* Moves posts until every row of this level is fitted, below cap, the outline unchanged; drops rows that the posts
 * cannot fit together with their neighbours. */
void fit_posts(WorkLevel *level, int index, FixSet *fixes);

/* ---- clear lines -------------------------------------------------------------------------- */

/* Within this distance of an end at a fix the line sets no limit. Two diagonals of a cell and a little: closer, the
 * line would limit the posts of the fix. */
static inline double taper_of_spacing_m(double spacing_m)
{
    return 3.5 * spacing_m;
}

typedef struct LineSet {
    int       count;
    ClearLine *line;       /* the usable ones */
    int       touch_count; /* positions where a line ends at a fix */
    double   *touch;       /* [touch_count][3] */
    NearGrid  near_touch;
} LineSet;

Status line_set_create(LineSet *out, const ClearLine *line, int count, const LocalFrame *frame, const FixSet *fixes,
                       double horizon_m);
void   line_set_destroy(LineSet *set);
/* Points on the lines lower than h_m above the ellipsoid, less the clearance, as ceilings. */
Status line_ceilings(FieldAim **out, int *out_count, const LineSet *lines, const LocalFrame *frame, double h_m);
/* Cuts the level's posts to what the lines allow and drops the rows that are above it. */
Status line_cut(WorkLevel *level, int index, const LineSet *lines, FixSet *fixes);

/* ---- curvature ---------------------------------------------------------------------------- */

/* z of the ellipsoid at ENU (x, y), and dz per metre of height there. */
typedef struct Curve {
    double origin[3], east[3], north[3], up[3]; /* on the unit sphere */
    double inv_scale[3];
} Curve;

void curve_of_frame(Curve *out, const LocalFrame *frame);
/* z = *z_m + h * *dz_per_h within h^2 lean^2 / 2R: 0.1 mm at 6 km, 2 cm at 400 km and h = 9 km. */
void curve_at(const Curve *curve, double x_m, double y_m, double *z_m, double *dz_per_h);

/* ---- levels ------------------------------------------------------------------------------- */

/* Turns heights above the ellipsoid into ENU z, in place. */
Status levels_bend(Field *posts, const Curve *curve);

/* ---- coast -------------------------------------------------------------------------------- */

enum { coast_grids = 6, coast_cells = 256 };

/* Thinned places, and for quick answers nested grids about the origin that give for each cell whether it is all sea,
 * all land away from the beach, or must be evaluated position by position. */
typedef struct Coast {
    int      sea_count, land_count; /* sea_count 0: no sea */
    double (*sea)[2], (*land)[2];
    double   h_m;
    uint64_t seed;
    uint8_t *cell[coast_grids]; /* [coast_cells][coast_cells] CoastKind; NULL: no grid */
} Coast;

typedef enum CoastKind { COAST_LAND, COAST_SEA, COAST_BEACH, COAST_UNSURE } CoastKind;

Status    coast_create(Coast *out, const LandscapeEvidence *evidence, uint64_t seed);
void      coast_destroy(Coast *coast);
CoastKind coast_at(const Coast *coast, double x_m, double y_m); /* never COAST_UNSURE */
/* Heights above the ellipsoid of a level's posts led down to the sea; its water posts marked. */
Status    coast_shape(WorkLevel *level, const Coast *coast);

/* ---- cover -------------------------------------------------------------------------------- */

typedef struct Cover {
    uint64_t  seed;
    bool      real;              /* elevation from files: no fields on steep slopes, woods instead */
    Curve     curve;             /* real: heights above the sea are needed */
    double    geoid_m, treeline_m;
    CoverGrid grid[cover_windows];
    Photo     photo;
    Coast     coast;
    struct Ways *ways;           /* synthetic: roads, streams, villages; NULL: none */
    LandscapeMap store;           /* grid, photo and the elevation borrow from it */
} Cover;

/* Height above the sea up to which trees grow. */
double landscape_treeline_m(double lat_rad);

/* Means of the photograph over each class, once the classes are known. */
void cover_measure_photo(Landscape *landscape);
void cover_free(Cover *cover);   /* accepts NULL */

/* ---- ways --------------------------------------------------------------------------------- */

/* What ways are laid out on. */
typedef struct WaysGround {
    const Elevation *elevation;
    const Coast     *coast;
    uint64_t         seed;
    int              fix_count;
    const GroundFix *fix;
} WaysGround;

Status ways_create(struct Ways **out, const WaysGround *ground);

/* ---- photograph ---------------------------------------------------------------------------- */

/* Side of the photograph's pixels at each place, 0: no photograph there (terrain/landscape/texture.c). */
void texture_photo_cells(float cell_m[8], const Landscape *landscape, const double x_m[8], const double y_m[8],
                         unsigned lanes);

#endif
