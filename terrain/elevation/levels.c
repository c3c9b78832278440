/* terrain/elevation/levels.c: from heights above the ellipsoid to the stored levels: with Earth curvature into
 * ENU, joined to the level around, and quantised, coarse before fine, so that edge posts fall exactly on the level
 * around them. */

#include "terrain/elevation/levels.h"

#include <stdlib.h>

/* ---- fields ------------------------------------------------------------------------------- */

Status levels_field_create(Field *out, double spacing_m, int i0, int j0, int nx, int ny)
{
    Field field = {spacing_m, i0, j0, nx, ny, NULL};
    if (nx < 1 || ny < 1) return STATUS_BAD_VALUE;
    field.v = calloc((size_t)nx * ny, sizeof *field.v);
    if (!field.v) return STATUS_NO_MEMORY;
    *out = field;
    return STATUS_OK;
}

void levels_field_destroy(Field *field)
{
    free(field->v);
    *field = (Field){0};
}

double levels_height(const Field *posts, double x_m, double y_m, int corner[3], double weight[3])
{
    const double fx = x_m / posts->spacing_m - posts->i0, fy = y_m / posts->spacing_m - posts->j0;
    if (!(fx >= 0 && fy >= 0 && fx <= posts->nx - 1 && fy <= posts->ny - 1)) return NAN;
    const int    i = fx < posts->nx - 1 ? (int)fx : posts->nx - 2, j = fy < posts->ny - 1 ? (int)fy : posts->ny - 2;
    const double u = fx - i, v = fy - j;

    const int sw = j * posts->nx + i;
    corner[0] = sw;
    corner[1] = u >= v ? sw + 1 : sw + posts->nx;
    corner[2] = sw + posts->nx + 1;
    weight[0] = 1 - fmax(u, v);
    weight[1] = fabs(u - v);
    weight[2] = fmin(u, v);
    return weight[0] * posts->v[corner[0]] + weight[1] * posts->v[corner[1]] + weight[2] * posts->v[corner[2]];
}

/* ---- curvature ---------------------------------------------------------------------------- */

void levels_curve(Curve *out, const LocalFrame *frame)
{
    static const double a_m = 6378137, b_m = 6356752.314245179498; /* semi-axes of WGS 84 */
    for (int k = 0; k < 3; k++) {
        const double inv = out->inv_scale[k] = 1 / (k < 2 ? a_m : b_m);
        out->origin[k] = frame->origin_ecef[k] * inv;
        out->east[k] = frame->r_ecef_from_enu[3 * k] * inv;
        out->north[k] = frame->r_ecef_from_enu[3 * k + 1] * inv;
        out->up[k] = frame->r_ecef_from_enu[3 * k + 2] * inv;
    }
}

void levels_curve_at(const Curve *curve, double x_m, double y_m, double *z_m, double *dz_per_h)
{
    /* the vertical line at (x, y) meets the unit sphere where A z^2 + 2 B z + C = 0; C is zero at the origin,
     * so the root is taken without a difference */
    double q[3];
    for (int k = 0; k < 3; k++) q[k] = curve->origin[k] + x_m * curve->east[k] + y_m * curve->north[k];
    const double a = v3_dot(curve->up, curve->up), b = v3_dot(q, curve->up), c = v3_dot(q, q) - 1;
    const double root = sqrt(fmax(b * b - a * c, 0));
    const double z = -c / (b + root);

    /* the normal, in ECEF, is the scaled point scaled once more; up is already scaled once */
    double n[3];
    for (int k = 0; k < 3; k++) n[k] = (q[k] + z * curve->up[k]) * curve->inv_scale[k];
    const double nz = v3_dot(q, curve->up) + z * a;
    *z_m = z;
    *dz_per_h = v3_length(n) / fmax(nz, 1e-12);
}

/* Turns a level's heights above the ellipsoid into ENU z. Exact on every stride-th post, bilinear between: over
 * 64 m the ellipsoid bends by 0.1 mm. */
Status levels_bend(Field *posts, const Curve *curve)
{
    int stride = (int)(64 / posts->spacing_m);
    if (stride < 1) stride = 1;
    const int nx = (posts->nx - 1) / stride + 2;
    double   *z = malloc(4 * (size_t)nx * sizeof *z);
    if (!z) return STATUS_NO_MEMORY;

    /* two rows of exact values: z and dz/dh, south and north of the rows between them */
    double *z_of[2] = {z, z + nx}, *g_of[2] = {z + 2 * nx, z + 3 * nx};
    for (int j0 = 0; j0 < posts->ny; j0 += stride) {
        for (int side = 0; side < 2; side++)
            for (int c = 0; c < nx; c++)
                levels_curve_at(curve, (posts->i0 + c * stride) * posts->spacing_m,
                                (posts->j0 + j0 + side * stride) * posts->spacing_m, &z_of[side][c], &g_of[side][c]);
        for (int j = j0; j < j0 + stride && j < posts->ny; j++) {
            const double v = (double)(j - j0) / stride;
            float       *row = posts->v + (size_t)j * posts->nx;
            for (int c = 0; c * stride < posts->nx; c++) {
                const double zw = z_of[0][c] + v * (z_of[1][c] - z_of[0][c]);
                const double ze = z_of[0][c + 1] + v * (z_of[1][c + 1] - z_of[0][c + 1]);
                const double g = g_of[0][c];
                const int    end = (c + 1) * stride < posts->nx ? stride : posts->nx - c * stride;
                for (int i = 0; i < end; i++)
                    row[c * stride + i] = (float)(zw + (ze - zw) * i / stride + g * row[c * stride + i]);
            }
        }
    }
    free(z);
    return STATUS_OK;
}

/* ---- joining --------------------------------------------------------------------------------- */

/* Blends the posts near the outline into the surface of the enclosing level, on which the outline itself lies. */
void levels_join(WorkLevel *level, const WorkLevel *outer, int band)
{
    Field *z = &level->z;
    for (int j = 0; j < z->ny; j++) {
        const int dj = j < z->ny - 1 - j ? j : z->ny - 1 - j;
        for (int i = 0; i < z->nx; i++) {
            const int di = i < z->nx - 1 - i ? i : z->nx - 1 - i, d = di < dj ? di : dj;
            if (d >= band) {
                i = z->nx - band - 1 > i ? z->nx - band - 1 : i; /* jumps across the middle, which is not blended */
                continue;
            }
            int          corner[3];
            double       weight[3];
            const double around_m =
                levels_height(&outer->z, (z->i0 + i) * z->spacing_m, (z->j0 + j) * z->spacing_m, corner, weight);
            const double share = smooth_step(0, band, d);
            float       *post = &z->v[(size_t)j * z->nx + i];
            *post = (float)(around_m + share * (*post - around_m));
        }
    }
}

/* ---- quantisation ------------------------------------------------------------------------- */

typedef struct Quanta {
    double z0_m, step_m;
} Quanta;

/* Chooses the step, a power of two, that holds the level's heights, and an origin that is a multiple of every possible
 * step. */
static Quanta choose_quanta(const Field *z)
{
    static const double finest_m = 0x1p-8, origin_m = 64;
    float               low = z->v[0], high = z->v[0];
    const size_t        posts = (size_t)z->nx * z->ny;
    for (size_t n = 0; n < posts; n++) {
        low = low < z->v[n] ? low : z->v[n];
        high = high > z->v[n] ? high : z->v[n];
    }
    Quanta q = {.z0_m = floor((low - 16) / origin_m) * origin_m, .step_m = finest_m};
    while ((high + 16 - q.z0_m) / q.step_m > 65535) q.step_m *= 2;
    return q;
}

/* Quantises all posts of a level whose tiles have base 0 and shift 0, tile by tile. */
static void quantise_plain(ElevationLevel *to, const Field *z, float z0, float inv_step, float half)
{
    for (int tj = 0; tj < to->tiles_y; tj++)
        for (int ti = 0; ti < to->tiles_x; ti++) {
            const int i0 = ti * elevation_tile_cells, j0 = tj * elevation_tile_cells;
            const int columns = z->nx - i0 < elevation_tile_side ? z->nx - i0 : elevation_tile_side;
            const int rows = z->ny - j0 < elevation_tile_side ? z->ny - j0 : elevation_tile_side;
            uint16_t *stored = to->stored + ((size_t)tj * (size_t)to->tiles_x + (size_t)ti) * elevation_tile_posts;
            for (int j = 0; j < rows; j++, stored += elevation_tile_side) {
                const float *v = z->v + (size_t)(j0 + j) * (size_t)z->nx + (size_t)i0;
                for (int i = 0; i < columns; i++) stored[i] = (uint16_t)(int32_t)((v[i] - z0) * inv_step + half);
            }
        }
}

/* Quantises a level. Posts on the hole's outline become multiples of the coarse step and of 8 fine steps, rounded down
 * (so that lines stay clear): then the seven posts between them are whole fine steps. */
static void quantise(Elevation *elevation, const WorkLevel *levels, int count, const Quanta *quanta)
{
    for (int k = count - 1; k >= 0; k--) {
        const WorkLevel *level = &levels[k];
        const Field     *z = &level->z;
        ElevationLevel  *to = &elevation->level[k];
        const float      inv_step = (float)(1 / quanta[k].step_m), z0 = (float)quanta[k].z0_m;
        /* coarse steps may be as large as the clearance of lines, so posts are rounded down there */
        const float  half = k < 2 ? 0.5f : 0.0f;
        const float *v = z->v;
        if (to->plain) quantise_plain(to, z, z0, inv_step, half);
        for (int j = 0; j < z->ny && !to->plain; j++)
            for (int i = 0; i < z->nx; i++) elevation_set_post(to, i, j, (uint16_t)((*v++ - z0) * inv_step + half));

        if (k > 0) {
            const double coarse = fmax(quanta[k].step_m, level_ratio * quanta[k - 1].step_m);
            for (int j = level->hole_j0; j <= level->hole_j1; j++)
                for (int i = level->hole_i0; i <= level->hole_i1; i++) {
                    const bool rim =
                        i == level->hole_i0 || i == level->hole_i1 || j == level->hole_j0 || j == level->hole_j1;
                    if (!rim) {
                        i = level->hole_i1 - 1;
                        continue;
                    }
                    const size_t at = (size_t)(j - z->j0) * z->nx + (i - z->i0);
                    elevation_set_post(
                        to, i - z->i0, j - z->j0,
                        (uint16_t)((floor(z->v[at] / coarse) * coarse - quanta[k].z0_m) / quanta[k].step_m));
                }
        }
        if (level->outermost) continue;

        const ElevationLevel *outer = &elevation->level[k + 1];
        const int oi = z->i0 / level_ratio - levels[k + 1].z.i0, oj = z->j0 / level_ratio - levels[k + 1].z.j0;
        for (int side = 0; side < 4; side++) {
            const bool along_x = side < 2, far_side = side & 1;
            const int  n = along_x ? z->nx : z->ny;
            for (int m = 0; m < n; m++) {
                const int    i = along_x ? m : far_side ? z->nx - 1 : 0, j = along_x ? far_side ? z->ny - 1 : 0 : m;
                const int    c = m / level_ratio, part = m % level_ratio;
                const int    ai = oi + (along_x ? c : i / level_ratio), aj = oj + (along_x ? j / level_ratio : c);
                const double za = elevation_post_m(outer, ai, aj);
                const double zb = part ? elevation_post_m(outer, ai + along_x, aj + !along_x) : za;
                const double post = (za + (zb - za) * part / level_ratio - quanta[k].z0_m) / quanta[k].step_m;
                elevation_set_post(to, i, j, (uint16_t)post);
            }
        }
    }
}

Status levels_store(Elevation *out, const WorkLevel *levels, int count)
{
    Elevation elevation = {0};
    Quanta    quanta[elevation_max_levels];
    for (int k = 0; k < count; k++) {
        const Field *z = &levels[k].z;
        quanta[k] = choose_quanta(z);
        const Status status =
            elevation_level_create(&elevation, k,
                                   &(ElevationGrid){z->nx, z->ny, z->i0 * z->spacing_m, z->j0 * z->spacing_m,
                                                    z->spacing_m, quanta[k].z0_m, quanta[k].step_m});
        if (status != STATUS_OK) {
            elevation_destroy(&elevation);
            return status;
        }
    }
    quantise(&elevation, levels, count, quanta);
    elevation_build_pyramids(&elevation);
    *out = elevation;
    return STATUS_OK;
}

/* ---- quantised in one fine step for all levels: each tile has the base and shift that its heights need ---- */

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
            low = low < z->v[n] ? low : z->v[n];
            high = high > z->v[n] ? high : z->v[n];
        }
    }
    /* posts are never negative, so the conversion rounds down */
    Steps s = {.step_m = finest_m};
    for (;; s.step_m *= 2) {
        s.z0_m = floor(low - seam_posts * s.step_m) - 1;
        if ((high - s.z0_m) / s.step_m < elevation_highest_post - 2 * seam_posts) return s;
    }
}

/* Writes the rows of posts of one row of tiles, in steps. */
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
    int i0, i1, j0, j1; /* in the level's posts, numbered from 0; i1 < i0: there is no seam */
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

/* The first and the last tile that hold any of the posts n0 .. n1 along an axis with this many posts and tiles. */
static void holding(int out[2], int n0, int n1, int posts, int tiles)
{
    n0 = n0 > 0 ? n0 : 0, n1 = n1 < posts - 1 ? n1 : posts - 1;
    const int low = n0 / elevation_tile_cells, high = n1 / elevation_tile_cells;
    out[0] = n0 % elevation_tile_cells == 0 && n0 > 0 ? low - 1 : low;
    out[1] = high < tiles ? high : tiles - 1;
}

/* The coarsest shift of the tiles that hold posts of a level's outline between post (i, j) of it and the posts
 * level_ratio to both sides, which lie on straight lines to their neighbours of the level around. */
static int coarsest_beside(const ElevationLevel *level, int i, int j)
{
    const bool along_x = j == 0 || j == level->ny - 1, along_y = i == 0 || i == level->nx - 1;
    int        shift = 0;
    for (int axis = 0; axis < 2; axis++) { /* a post at a corner lies on both sides */
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

/* Chooses bases and shifts of tiles. They are zero where one range holds the whole level, which makes look-ups fastest.
 * */
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

/* Rounds the posts on the hole's outline down to a unit that is eight units of those tiles of the inner level that are
 * beside them. So a cliff elsewhere on the outline moves none of them. */
static void round_hole(ElevationLevel *to, const WorkLevel *level, const ElevationLevel *inside)
{
    const Seam hole = hole_of(level);
    for (int j = hole.j0; j <= hole.j1; j++)
        for (int i = hole.i0; i <= hole.i1; i++) {
            if (j > hole.j0 && j < hole.j1 && i > hole.i0) i = hole.i1;
            const int unit =
                level_ratio << coarsest_beside(inside, level_ratio * (i - hole.i0), level_ratio * (j - hole.j0));
            elevation_set_post(to, i, j, elevation_post(to, i, j) / unit * unit);
        }
}

/* Lays the posts of the outline onto the straight edges of the enclosing level. */
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
        status = elevation_level_create(&elevation, k,
                                        &(ElevationGrid){z->nx, z->ny, z->i0 * z->spacing_m, z->j0 * z->spacing_m,
                                                         z->spacing_m, steps.z0_m, steps.step_m});
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
