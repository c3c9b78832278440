/* terrain/landscape/levels_fine.c: heights from files into posts of one fine step for all levels; each tile has the
 * base and shift that its own heights need, and edge posts are exactly on the level around. */
#include "terrain/landscape/landscape_private.h"

#include <stdlib.h>

static const double finest_m = 0x1p-11;

/* A post of a seam is moved by less than this: the coarsest unit that the rounding of a hole's outline may need. */
enum { seam_posts = level_ratio << elevation_most_shift };

typedef struct Steps {
    double z0_m, step_m;
} Steps;

static Steps choose_steps(const WorkLevel *levels, int count)
{
    float low = levels[0].z.v[0], high = low;
    for (int k = 0; k < count; k++) {
        const Field *z = &levels[k].z;
        const size_t posts = (size_t)z->nx * (size_t)z->ny;
        for (size_t n = 0; n < posts; n++) {
            low  = low < z->v[n] ? low : z->v[n];
            high = high > z->v[n] ? high : z->v[n];
        }
    }
    /* posts are never negative, so that conversion rounds down */
    Steps s = {.step_m = finest_m};
    for (;; s.step_m *= 2) {
        s.z0_m = floor(low - seam_posts * s.step_m) - 1;
        if ((high - s.z0_m) / s.step_m < elevation_highest_post - 2 * seam_posts) return s;
    }
}

/* The rows of posts of one row of tiles, in steps. */
static void rows_of(int32_t *post, const Field *z, int tile_j, const Steps *steps)
{
    const int    j0 = tile_j * elevation_tile_cells;
    const int    rows = z->ny - j0 < elevation_tile_side ? z->ny - j0 : elevation_tile_side;
    const size_t count = (size_t)rows * (size_t)z->nx;
    const float *v = z->v + (size_t)j0 * (size_t)z->nx;
    const double per_m = 1 / steps->step_m;
    for (size_t n = 0; n < count; n++) post[n] = (int32_t)(((double)v[n] - steps->z0_m) * per_m + 0.5);
}

/* The lines of posts on which a level meets another: its outline, or its hole's. */
typedef struct Seam {
    int i0, i1, j0, j1; /* of the level's posts from 0 on; i1 < i0: none */
} Seam;

static Seam outline_of(const WorkLevel *level)
{
    if (level->outermost) return (Seam){0, -1, 0, -1};
    return (Seam){0, level->z.nx - 1, 0, level->z.ny - 1};
}

static Seam hole_of(const WorkLevel *level)
{
    const Field *z = &level->z;
    if (level->hole_i1 < level->hole_i0) return (Seam){0, -1, 0, -1};
    return (Seam){level->hole_i0 - z->i0, level->hole_i1 - z->i0, level->hole_j0 - z->j0, level->hole_j1 - z->j0};
}

static bool tile_meets(const Seam *s, int ti, int tj)
{
    const int i0 = ti * elevation_tile_cells, i1 = i0 + elevation_tile_cells;
    const int j0 = tj * elevation_tile_cells, j1 = j0 + elevation_tile_cells;
    if (i1 < s->i0 || i0 > s->i1 || j1 < s->j0 || j0 > s->j1) return false;
    return !(i0 > s->i0 && i1 < s->i1 && j0 > s->j0 && j1 < s->j1);
}

/* The tiles that hold any of the posts n0 .. n1 of an axis with this many posts and tiles: first and last. */
static void holding(int out[2], int n0, int n1, int posts, int tiles)
{
    n0 = n0 > 0 ? n0 : 0, n1 = n1 < posts - 1 ? n1 : posts - 1;
    const int low = n0 / elevation_tile_cells, high = n1 / elevation_tile_cells;
    out[0] = n0 % elevation_tile_cells == 0 && n0 > 0 ? low - 1 : low;
    out[1] = high < tiles ? high : tiles - 1;
}

/* The coarsest shift of the tiles that hold posts of a level's outline between post (i, j) of it and the posts level_ratio
 * to both sides, which lie on straight lines to their neighbours of the level around. */
static int coarsest_beside(const ElevationLevel *level, int i, int j)
{
    const bool along_x = j == 0 || j == level->ny - 1, along_y = i == 0 || i == level->nx - 1;
    int        shift = 0;
    for (int axis = 0; axis < 2; axis++) { /* a corner is on both */
        const int reach_i = axis == 0 ? level_ratio : 0, reach_j = axis == 1 ? level_ratio : 0;
        int       a[2], b[2];
        if (!(axis == 0 ? along_x : along_y)) continue;
        holding(a, i - reach_i, i + reach_i, level->nx, level->tiles_x);
        holding(b, j - reach_j, j + reach_j, level->ny, level->tiles_y);
        for (int tj = b[0]; tj <= b[1]; tj++)
            for (int ti = a[0]; ti <= a[1]; ti++) {
                const int of = level->tile[(size_t)tj * (size_t)level->tiles_x + (size_t)ti].shift;
                shift = of > shift ? of : shift;
            }
    }
    return shift;
}

/* Bases and shifts: zero where one range holds the level, so that it is as quick as can be. */
static void choose_tiles(ElevationLevel *to, const WorkLevel *level, int32_t *post, const Steps *steps)
{
    const Seam outline = outline_of(level), hole = hole_of(level);
    int32_t    highest = 0;
    to->plain = false;
    for (int tj = 0; tj < to->tiles_y; tj++) {
        rows_of(post, &level->z, tj, steps);
        for (int ti = 0; ti < to->tiles_x; ti++) {
            int32_t range[2];
            elevation_tile_range(range, to, ti, tj, post);
            const int room = tile_meets(&outline, ti, tj) || tile_meets(&hole, ti, tj) ? seam_posts : 0;
            to->tile[(size_t)tj * (size_t)to->tiles_x + (size_t)ti] =
                elevation_tile_of(range[0] - room, range[1] + room);
            highest = range[1] > highest ? range[1] : highest;
        }
    }
    if (highest > 65535 - seam_posts) return;
    memset(to->tile, 0, (size_t)to->tiles_x * (size_t)to->tiles_y * sizeof *to->tile);
    to->plain = true;
}

/* Posts of the hole's outline become multiples of what divides into eight whole units of the tiles beside them of the level
 * inside, rounded down: a cliff elsewhere on the outline moves none of them. */
static void round_hole(ElevationLevel *to, const WorkLevel *level, const ElevationLevel *inside)
{
    const Seam hole = hole_of(level);
    for (int j = hole.j0; j <= hole.j1; j++)
        for (int i = hole.i0; i <= hole.i1; i++) {
            if (j > hole.j0 && j < hole.j1 && i > hole.i0) i = hole.i1;
            const int unit = level_ratio << coarsest_beside(inside, level_ratio * (i - hole.i0), level_ratio * (j - hole.j0));
            elevation_set_post(to, i, j, elevation_post(to, i, j) / unit * unit);
        }
}

/* Posts of the outline, onto the straight edges of the level around. */
static void lay_outline(ElevationLevel *to, const WorkLevel *level, const ElevationLevel *outer,
                        const WorkLevel *outer_level)
{
    const Field *z = &level->z;
    const int    oi = z->i0 / level_ratio - outer_level->z.i0, oj = z->j0 / level_ratio - outer_level->z.j0;
    for (int j = 0; j < z->ny; j++)
        for (int i = 0; i < z->nx; i++) {
            if (j > 0 && j < z->ny - 1 && i > 0) i = z->nx - 1;
            const bool    along_x = j == 0 || j == z->ny - 1;
            const int     part = (along_x ? i : j) % level_ratio, ai = oi + i / level_ratio, aj = oj + j / level_ratio;
            const int32_t a = elevation_post(outer, ai, aj);
            const int32_t b = part ? elevation_post(outer, ai + along_x, aj + !along_x) : a;
            elevation_set_post(to, i, j, a + (b - a) / level_ratio * part);
        }
}

Status levels_store_fine(Elevation *out, const WorkLevel *levels, int count)
{
    Elevation   elevation = {0};
    const Steps steps = choose_steps(levels, count);
    Status      status = STATUS_OK;
    int         widest = 0;
    for (int k = 0; k < count; k++) widest = levels[k].z.nx > widest ? levels[k].z.nx : widest;
    int32_t *post = malloc((size_t)widest * elevation_tile_side * sizeof *post);
    if (!post) return STATUS_NO_MEMORY;
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        const Field *z = &levels[k].z;
        status = elevation_level_create(&elevation, k, z->nx, z->ny, z->i0 * z->spacing_m, z->j0 * z->spacing_m,
                                        z->spacing_m, steps.z0_m, steps.step_m);
        if (status == STATUS_OK) choose_tiles(&elevation.level[k], &levels[k], post, &steps);
    }
    for (int k = count - 1; k >= 0 && status == STATUS_OK; k--) {
        ElevationLevel *to = &elevation.level[k];
        for (int tj = 0; tj < to->tiles_y; tj++) {
            rows_of(post, &levels[k].z, tj, &steps);
            elevation_fill_tiles(to, tj, post);
        }
        if (k > 0) round_hole(to, &levels[k], &elevation.level[k - 1]);
        if (!levels[k].outermost) lay_outline(to, &levels[k], &elevation.level[k + 1], &levels[k + 1]);
    }
    free(post);
    if (status == STATUS_OK) {
        elevation_build_pyramids(&elevation);
        *out = elevation;
    } else {
        elevation_destroy(&elevation);
    }
    return status;
}
