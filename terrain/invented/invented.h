/* terrain/invented/invented.h: invented ground: what it is fitted to, its posts, and what covers it.
 *
 * It passes through the fixes, stays below the clear lines, and has a sea where places of sea are known; it has fields,
 * ways, villages, hedgerows. A pure function of configuration, frame and evidence. Eight places of its cover at once:
 * invented_eight.h. */
#ifndef TERRAIN_INVENTED_INVENTED_H
#define TERRAIN_INVENTED_INVENTED_H

#include "terrain/earth/geodesy.h"
#include "terrain/elevation/elevation.h"
#include "terrain/surface.h"

#include "pitviper_kept.h"

/* ---- random numbers of places ---------------------------------------------------------------- */

/* Well mixed 64 bits of (seed, a, b). The finaliser is Stafford's thirteenth variant ("Better bit mixing",
 * 2011); the odd multipliers only keep a and b apart. */
static inline uint64_t invented_hash(uint64_t seed, int64_t a, int64_t b)
{
    uint64_t h = seed + (uint64_t)a * 0x9e3779b97f4a7c15u + (uint64_t)b * 0xd1b54a32d192ed03u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}

/* A number in [0, 1) from the upper 53 bits. */
static inline double invented_unit(uint64_t h) { return (double)(h >> 11) * 0x1p-53; }

/* ---- evidence --------------------------------------------------------------------------------- */

/* A known point of the ground. The fixes of one source entity (voter) have one vote in the consensus together; a fix of
 * voter 0 has a vote of its own, and is only checked by its slopes to others. */
typedef struct GroundFix {
    double p_enu[3];
    int    voter; /* >= 0 */
} GroundFix;

/* A place of which only one thing is known: that it is sea, or that it is dry land. */
typedef struct CoastPlace {
    double x_m, y_m;
    bool   sea;
} CoastPlace;

/* A straight line that the ground must leave clear, from a to b, by 2 m where possible and 0.15 m at least. An end
 * within 8 m of a fix counts as at the fix: within invented_taper_m of such an end (14 m at 4 m posts; in proportion
 * on the coarser levels) the line sets no limit, so a shot may end on the ground it hits. Elsewhere lines take
 * precedence: a fix above one is dropped. Give the places of gun, seeker and burst, not the point between a vehicle's
 * tracks: a line from base to base along flat ground drops every fix beside it. */
typedef struct ClearLine {
    double a_enu[3], b_enu[3];
} ClearLine;

typedef struct LandscapeConfig {
    uint64_t seed;
    double   relief_m;     /* rms height of the hills far from any fix, 0 .. 200 */
    double   spacing_m;    /* spacing of level 0, 1 .. 30 */
    double   half_width_m; /* half width of level 0 */
    double   horizon_m;    /* half width of the outermost level */
} LandscapeConfig;

/* All evidence of an exercise on its ground. Without a sea fix there is no sea. */
typedef struct LandscapeEvidence {
    int               fix_count, line_count, place_count;
    const GroundFix  *fix;
    const ClearLine  *line;
    const CoastPlace *place;
    double            sea_h_m; /* height of the water's surface above the ellipsoid */
} LandscapeEvidence;

/* Radius about an end at a fix within which a line sets no limit. */
double invented_taper_m(const LandscapeConfig *config);
/* Finds the fixes of source entities that the consensus rejects: [fix_count] bytes, 1: rejected. Source entities are
 * numbered from 1, up to the number of fixes. See votes.c. */
Status invented_inconsistent(uint8_t *outvoted, const GroundFix *fix, int fix_count);
/* Height of positions above the ground of the source entities near them (the plane of best consensus), and the distance
 * of the nearest of them, m; NaN: none within 300 m. */
Status invented_consensus_height(double *above_m, double *nearest_m, const double (*p_enu)[3], int count,
                                 const GroundFix *fix, int fix_count);

/* ---- the sea ---------------------------------------------------------------------------------- */

enum { coast_grids = 6, coast_cells = 256 };

/* The extent of the sea: thinned places and, for quick answers, nested grids about the origin. A grid gives for each
 * cell whether it is all sea, all land away from the beach, or must be evaluated place by place. */
typedef struct Coast {
    int sea_count, land_count; /* sea_count 0: there is no sea */
    double (*sea)[2], (*land)[2];
    double   h_m;
    uint64_t seed;
    uint8_t *cell[coast_grids]; /* [coast_cells][coast_cells] CoastKind; NULL: no grid */
} Coast;

typedef enum CoastKind { COAST_LAND, COAST_SEA, COAST_BEACH, COAST_UNSURE } CoastKind;

CoastKind coast_at(const Coast *coast, double x_m, double y_m); /* never COAST_UNSURE */

/* ---- the ground ------------------------------------------------------------------------------- */

typedef struct Ways Ways;

/* The parts that determine what covers the ground. */
typedef struct InventedGround {
    uint64_t seed;
    Coast    coast;
    Ways    *ways; /* roads, streams, villages; NULL: none */
} InventedGround;

typedef struct InventedTerrain {
    Elevation      elevation;
    InventedGround ground;
    double         fit_worst_m; /* both as in Landscape (terrain/ground/landscape.h) */
    int            fixes_dropped;
} InventedTerrain;

/* STATUS_BAD_VALUE: a figure of the configuration is out of its range. */
Status invented_create(InventedTerrain *out, const LandscapeConfig *config, const LocalFrame *frame,
                       const LandscapeEvidence *evidence);
/* The same from the cache, or into it. cache may be NULL. */
Status invented_create_kept(InventedTerrain *out, const LandscapeConfig *config, const LocalFrame *frame,
                            const LandscapeEvidence *evidence, Cache *cache);
/* KeptValues of InventedTerrain: of zeroes while they are read. After what is wrong invented_free. */
KeptValues invented_kept_values;
void       invented_free(InventedTerrain *terrain);
void       invented_ground_free(InventedGround *ground); /* accepts zeroes */

struct WorkLevel; /* terrain/elevation/levels.h */
/* Leads levels of real ground, heights above the ellipsoid, through fixes: a smooth field through their differences,
 * pulled in from wide waves to those of some posts, is added to every level. *largest_m: of its values. */
Status invented_correct(struct WorkLevel *level, int levels, const LocalFrame *frame, double horizon_m,
                        const GroundFix *fix, int fix_count, double *largest_m);

/* ---- ways ------------------------------------------------------------------------------------- */

/* Roads, lanes, tracks and streams of invented ground, and the plots of its villages: a pure function of the seed, the
 * terrain and the fixes. Streams follow the descent of the ground and end in a pond, another stream, the sea or the
 * rim of the finest level; roads join the villages and the rim, tracks lead from roads into fields and woods. Where
 * vehicles were reported or will be changes nothing of it, but that no house and no pond is where one was. Heights are
 * not changed. */
typedef enum WayKind { WAY_NONE, WAY_ROAD, WAY_LANE, WAY_TRACK, WAY_STREAM, WAY_GULLY, WAY_KINDS } WayKind;

/* The nearest way about a place. */
typedef struct WayPlace {
    WayKind kind;
    int     way;          /* its number */
    double  across_m;     /* signed distance from its middle line, positive to the left */
    double  along_m;      /* distance along it from its start */
    double  half_m;       /* half its width there */
    double  direction[2]; /* unit vector along it, east and north */
} WayPlace;

/* A village's plot: a rectangle beside its lane, with a place for a house. */
typedef struct HousePlot {
    double x_m, y_m;     /* middle of the plot */
    double direction[2]; /* unit vector along the lane */
    double half_along_m, half_across_m;
    double house[2];      /* middle of the house relative to that of the plot: along the lane, and towards it */
    double house_half[2]; /* half the house's sides, along the lane and across it */
} HousePlot;

/* The nearest way about a place. Returns false when no way has its edge within some metres. NULL: there are no ways. */
bool ways_at(WayPlace *out, const Ways *ways, double x_m, double y_m);
/* The vertices of a way in order, up to `most` of them; returns their number. */
int              ways_vertices(double (*out)[2], WayKind *kind, const Ways *ways, int way, int most);
const HousePlot *ways_plots(const Ways *ways, int *count);
bool             ways_village(double place_m[2], const Ways *ways, int index);
double           ways_wetness(const Ways *ways, double x_m, double y_m);
/* Whether anything of the ways reaches into the index cell of a place. */
bool ways_touch(const Ways *ways, double x_m, double y_m);

/* ---- hedgerows -------------------------------------------------------------------------------- */

/* Kind of a whole hedgerow: cut, grown out to shrubs, or with trees in it. */
typedef enum HedgeHeight { HEDGE_CUT, HEDGE_SHRUBS, HEDGE_TREES } HedgeHeight;

typedef struct HedgePlace {
    double      x_m, y_m;
    uint64_t    hedge; /* a number that is the same along one hedgerow */
    HedgeHeight height;
} HedgePlace;

/* The place on the middle of a hedgerow in square (i, j) of a grid of spacing_m. Returns false when no hedgerow passes
 * through the square. */
bool hedge_in_square(HedgePlace *out, uint64_t seed, int64_t i, int64_t j, double spacing_m);

#endif
