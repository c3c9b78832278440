/* terrain/invented/coast.c: extent of the sea, and the transition from land to it.
 *
 * A position is sea when it is nearer to a sea fix than to a fix of dry land; the line between is perturbed by a share
 * of the distance to either, so that it resembles a shore and still leaves every fix on its own side. The land's own
 * heights are faded to the sea's level towards the shore, and kept above it except near fixes that are lower. */
#include "terrain/invented/invented_private.h"

#include <stdlib.h>

enum { most_places = 512, block_posts = 16 };
static const double wander =
    0.3; /* amplitude of the shoreline's bends, as a share of the distance to the nearest place of either kind */
static const double most_wander_m = 400;
static const double innermost_m =
    1024; /* half width of the finest grid of the cache; each next grid is four times as wide */
static const double shore_land_m = 400; /* from this distance inland on the land has its own height */
static const double own_land_m = 50;    /* so near to a land fix the terrain may be lower than the sea */
static const double wild_m = 300;       /* so far from a land fix it may not */
static const double beach_m = 12;
static const double own_share =
    0.8; /* the land also has its own height at this share of the way from the shore to a place of land */

/* ---- nearest places ----------------------------------------------------------------------- */

static double nearest_m(const double (*place)[2], int count, double x_m, double y_m)
{
    double least = INFINITY;
    for (int n = 0; n < count; n++) {
        const double dx = place[n][0] - x_m, dy = place[n][1] - y_m;
        const double square = dx * dx + dy * dy;
        least = square < least ? square : least; /* not fmin, which compiles to a call */
    }
    return sqrt(least);
}

/* Finds the places that can be nearest to a point within reach_m of (x, y). */
static int may_be_nearest(double (*out)[2], const double (*place)[2], int count, double x_m, double y_m, double reach_m)
{
    const double far_m = nearest_m(place, count, x_m, y_m) + 2 * reach_m;
    int          kept = 0;
    for (int n = 0; n < count; n++)
        if (hypot(place[n][0] - x_m, place[n][1] - y_m) <= far_m) memcpy(out[kept++], place[n], sizeof out[0]);
    return kept;
}

/* ---- the shore ---------------------------------------------------------------------------- */

/* Smooth value noise, -1 .. 1, of waves of wave_m. */
static double noise(uint64_t seed, double wave_m, double x_m, double y_m)
{
    const double  x = x_m / wave_m, y = y_m / wave_m;
    const int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    const double  u = smooth_step(0, 1, x - floor(x)), v = smooth_step(0, 1, y - floor(y));
    const double  sw = invented_unit(invented_hash(seed, i, j)), se = invented_unit(invented_hash(seed, i + 1, j));
    const double  nw = invented_unit(invented_hash(seed, i, j + 1));
    const double  ne = invented_unit(invented_hash(seed, i + 1, j + 1));
    return 2 * ((1 - v) * ((1 - u) * sw + u * se) + v * ((1 - u) * nw + u * ne)) - 1;
}

static double wander_at(uint64_t seed, double x_m, double y_m)
{
    return 0.55 * noise(seed, 3700, x_m, y_m) + 0.25 * noise(seed + 1, 1100, x_m, y_m) +
           0.13 * noise(seed + 2, 310, x_m, y_m) + 0.07 * noise(seed + 3, 90, x_m, y_m);
}

static double most_wander_at(double to_sea_m, double to_land_m)
{
    return fmin(wander * fmin(to_sea_m, to_land_m), most_wander_m);
}

/* Approximate distance inland, m: half the difference of the distances to sea and to land. It is negative on the water.
 * */
static double inland_m(const Coast *coast, double to_sea_m, double to_land_m, double x_m, double y_m)
{
    if (!coast->land_count) return -INFINITY;
    const double off_m = to_sea_m - to_land_m, room_m = most_wander_at(to_sea_m, to_land_m);
    if (off_m < -room_m || off_m > room_m + 2 * shore_land_m)
        return 0.5 * off_m; /* outside of this range no bend of the shoreline can change the answer */
    return 0.5 * (off_m + room_m * wander_at(coast->seed, x_m, y_m));
}

static CoastKind kind_of(double inland, double to_land_m)
{
    if (!(inland > 0)) return COAST_SEA;
    return inland < fmin(beach_m, 0.5 * to_land_m) ? COAST_BEACH : COAST_LAND;
}

static CoastKind ask(const Coast *coast, double x_m, double y_m)
{
    const double to_sea_m = nearest_m(coast->sea, coast->sea_count, x_m, y_m);
    const double to_land_m = nearest_m(coast->land, coast->land_count, x_m, y_m);
    return kind_of(inland_m(coast, to_sea_m, to_land_m, x_m, y_m), to_land_m);
}

static double grid_cell_m(int grid) { return 2 * innermost_m * (double)(1 << (2 * grid)) / coast_cells; }

CoastKind coast_at(const Coast *coast, double x_m, double y_m)
{
    if (!coast->sea_count) return COAST_LAND;
    if (!coast->land_count) return COAST_SEA;
    for (int g = 0; g < coast_grids; g++) {
        const double per_m = 1 / grid_cell_m(g);
        const double i = x_m * per_m + coast_cells / 2, j = y_m * per_m + coast_cells / 2;
        if (!(i >= 0 && j >= 0 && i < coast_cells && j < coast_cells)) continue;
        const CoastKind kind = (CoastKind)coast->cell[g][(int)j * coast_cells + (int)i];
        return kind == COAST_UNSURE ? ask(coast, x_m, y_m) : kind;
    }
    return ask(coast, x_m, y_m);
}

/* ---- construction ------------------------------------------------------------------------- */

/* Thins places of one kind to a least distance that leaves most_places of them; then restores those whose place the
 * thinned ones would give to the other kind. */
static int thin(double (*out)[2], const LandscapeEvidence *e, bool sea)
{
    int kept = most_places + 1;
    for (double apart_m = 4; kept > most_places; apart_m *= 2) {
        kept = 0;
        for (int n = 0; n < e->place_count && kept <= most_places; n++) {
            const CoastPlace *p = &e->place[n];
            if (p->sea != sea || !(fabs(p->x_m) < 1e7 && fabs(p->y_m) < 1e7)) continue;
            if (nearest_m((const double(*)[2])out, kept, p->x_m, p->y_m) < apart_m) continue;
            if (kept < most_places) out[kept][0] = p->x_m, out[kept][1] = p->y_m;
            kept++;
        }
    }
    return kept;
}

static int keep_contradicted(double (*out)[2], int count, const double (*other)[2], int others,
                             const LandscapeEvidence *e, bool sea)
{
    for (int n = 0; n < e->place_count && count < 2 * most_places; n++) {
        const CoastPlace *p = &e->place[n];
        if (p->sea != sea || !(fabs(p->x_m) < 1e7 && fabs(p->y_m) < 1e7)) continue;
        const double own_m = nearest_m((const double(*)[2])out, count, p->x_m, p->y_m);
        if (own_m > 0.1 * nearest_m(other, others, p->x_m, p->y_m)) out[count][0] = p->x_m, out[count++][1] = p->y_m;
    }
    return count;
}

/* Makes the grids from coarse to fine: a cell inside a coarser cell that is certain is not evaluated. */
static Status make_grids(Coast *coast)
{
    for (int g = coast_grids - 1; g >= 0; g--) {
        coast->cell[g] = malloc(coast_cells * coast_cells);
        if (!coast->cell[g]) return STATUS_NO_MEMORY;
        const double cell_m = grid_cell_m(g), reach_m = cell_m * sqrt(0.5);
        for (int j = 0; j < coast_cells; j++)
            for (int i = 0; i < coast_cells; i++) {
                const int outer = (j / 4 + 3 * coast_cells / 8) * coast_cells + i / 4 + 3 * coast_cells / 8;
                uint8_t  *cell = &coast->cell[g][j * coast_cells + i];
                *cell = g + 1 < coast_grids ? coast->cell[g + 1][outer] : COAST_UNSURE;
                if (*cell != COAST_UNSURE) continue;
                const double x = (i + 0.5 - coast_cells / 2) * cell_m, y = (j + 0.5 - coast_cells / 2) * cell_m;
                const double to_sea_m = nearest_m(coast->sea, coast->sea_count, x, y);
                const double to_land_m = nearest_m(coast->land, coast->land_count, x, y);
                const double off_m = to_sea_m - to_land_m;
                const double room_m = most_wander_at(to_sea_m + reach_m, to_land_m + reach_m);
                const double doubt_m = 2 * reach_m + room_m + 2 * beach_m;
                if (fabs(off_m) > doubt_m) *cell = (uint8_t)(off_m > 0 ? COAST_LAND : COAST_SEA);
            }
    }
    return STATUS_OK;
}

Status coast_create(Coast *out, const LandscapeEvidence *evidence, uint64_t seed)
{
    Coast coast = {.h_m = evidence->sea_h_m, .seed = seed};
    bool  any = false;
    *out = (Coast){0};
    for (int n = 0; n < evidence->place_count && !any; n++) any = evidence->place[n].sea;
    if (!any) return STATUS_OK;
    if (!(coast.h_m >= lowest_ground_m && coast.h_m <= 9000)) return STATUS_BAD_VALUE;

    coast.sea = calloc(2 * most_places, sizeof *coast.sea);
    coast.land = calloc(2 * most_places, sizeof *coast.land);
    Status status = coast.sea && coast.land ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        coast.sea_count = thin(coast.sea, evidence, true);
        coast.land_count = thin(coast.land, evidence, false);
        const int land = keep_contradicted(coast.land, coast.land_count, (const double(*)[2])coast.sea, coast.sea_count,
                                           evidence, false);
        if (land)
            coast.sea_count = keep_contradicted(coast.sea, coast.sea_count, (const double(*)[2])coast.land,
                                                coast.land_count, evidence, true);
        coast.land_count = land;
        if (coast.sea_count && land) status = make_grids(&coast);
    }
    if (status == STATUS_OK) *out = coast;
    else coast_destroy(&coast);
    return status;
}

void coast_destroy(Coast *coast)
{
    for (int g = 0; g < coast_grids; g++) free(coast->cell[g]);
    free(coast->sea);
    free(coast->land);
    *coast = (Coast){0};
}

/* ---- heights ------------------------------------------------------------------------------ */

/* Height above the sea where there is no fix near: never below it. */
static double dry_m(double above_m)
{
    static const double round_m = 2;
    return 0.5 * (above_m + sqrt(above_m * above_m + 4 * round_m * round_m));
}

/* The land's height above the sea after it is faded towards the shore. */
static double led_down_m(double above_m, double inland, double to_sea_m, double to_land_m)
{
    const double wild = smooth_step(own_land_m, wild_m, to_land_m);
    const double own = fmax(2 * inland / (own_share * (to_sea_m + to_land_m)), inland / shore_land_m);
    return smooth_step(0, 1, own) * (above_m + wild * (dry_m(above_m) - above_m));
}

/* What is known of all posts of a block about (x, y): all are on the water; or all are inland beyond the influence of
 * the shore, and all near a place of land or all far from any. */
typedef enum BlockKind { BLOCK_MIXED, BLOCK_WATER, BLOCK_UNTOUCHED, BLOCK_WILD } BlockKind;

static BlockKind kind_of_block(const Coast *coast, double x_m, double y_m, double reach_m)
{
    if (!coast->land_count) return BLOCK_WATER;
    const double to_sea_m = nearest_m(coast->sea, coast->sea_count, x_m, y_m);
    const double to_land_m = nearest_m(coast->land, coast->land_count, x_m, y_m);
    const double off_m = to_sea_m - to_land_m;
    if (off_m < -2 * reach_m - most_wander_at(to_sea_m + reach_m, to_land_m + reach_m)) return BLOCK_WATER;
    const bool own = off_m - 2 * reach_m > most_wander_m + 2 * shore_land_m;
    if (own && to_land_m + reach_m < own_land_m) return BLOCK_UNTOUCHED;
    return own && to_land_m - reach_m > wild_m ? BLOCK_WILD : BLOCK_MIXED;
}

/* Posts i0 .. i1 - 1 of rows j0 .. j1 - 1. */
typedef struct Block {
    int i0, i1, j0, j1;
} Block;

static void shape_block(WorkLevel *level, const Coast *coast, const Coast *local, BlockKind kind, const Block *block)
{
    const int i0 = block->i0, i1 = block->i1, j0 = block->j0, j1 = block->j1;
    Field    *z = &level->z;
    for (int j = j0; kind == BLOCK_WATER && j < j1; j++)
        for (int i = i0; i < i1; i++) {
            z->v[(size_t)j * z->nx + i] = (float)coast->h_m;
            level->water[(size_t)j * z->nx + i] = 1;
        }
    for (int j = j0; kind == BLOCK_WILD && j < j1; j++)
        for (int i = i0; i < i1; i++) {
            float *v = &z->v[(size_t)j * z->nx + i];
            *v = (float)(coast->h_m + dry_m((double)*v - coast->h_m));
        }
    if (kind != BLOCK_MIXED) return;
    for (int j = j0; j < j1; j++)
        for (int i = i0; i < i1; i++) {
            const size_t at = (size_t)j * z->nx + i;
            const double x = (z->i0 + i) * z->spacing_m, y = (z->j0 + j) * z->spacing_m;
            const double to_sea_m = nearest_m(local->sea, local->sea_count, x, y);
            const double to_land_m = nearest_m(local->land, local->land_count, x, y);
            const double inland = inland_m(coast, to_sea_m, to_land_m, x, y);
            level->water[at] = (uint8_t) !(inland > 0);
            const double above_m = (double)z->v[at] - coast->h_m;
            z->v[at] = (float)coast->h_m;
            if (!level->water[at]) z->v[at] = (float)(coast->h_m + led_down_m(above_m, inland, to_sea_m, to_land_m));
        }
}

Status coast_shape(WorkLevel *level, const Coast *coast)
{
    if (!coast->sea_count) return STATUS_OK;
    const Field *z = &level->z;
    Coast        local = {.sea = calloc(2 * most_places, sizeof *local.sea),
                          .land = calloc(2 * most_places, sizeof *local.land)};
    level->water = calloc((size_t)z->nx * z->ny, 1);
    const Status status = local.sea && local.land && level->water ? STATUS_OK : STATUS_NO_MEMORY;
    for (int j = 0; status == STATUS_OK && j < z->ny; j += block_posts)
        for (int i = 0; i < z->nx; i += block_posts) {
            const int       i1 = i + block_posts < z->nx ? i + block_posts : z->nx;
            const int       j1 = j + block_posts < z->ny ? j + block_posts : z->ny;
            const double    x = (z->i0 + 0.5 * (i + i1 - 1)) * z->spacing_m;
            const double    y = (z->j0 + 0.5 * (j + j1 - 1)) * z->spacing_m;
            const double    reach_m = 0.5 * block_posts * sqrt(2.0) * z->spacing_m;
            const BlockKind kind = kind_of_block(coast, x, y, reach_m);
            if (kind == BLOCK_MIXED) {
                local.sea_count =
                    may_be_nearest(local.sea, (const double(*)[2])coast->sea, coast->sea_count, x, y, reach_m);
                local.land_count =
                    may_be_nearest(local.land, (const double(*)[2])coast->land, coast->land_count, x, y, reach_m);
            }
            shape_block(level, coast, &local, kind, &(Block){i, i1, j, j1});
        }
    free(local.sea);
    free(local.land);
    return status;
}
