/* terrain/from_files/elevation_posts.c: heights of the posts of a level, any of its rows at a time: where their
 * vertical lines cross the surface that the grids hold together. */
#include "terrain/from_files/elevation_import_private.h"

#include <stdlib.h>

static const double lowest_view_m = -1000, highest_view_m = 9500,
                    rise_m = 4000; /* rise_m: height of the second exact look-up */
enum { rows_a_task = 16, most_run = 128, rows_at_once = 4 };

/* ---- where posts lie in the grids ----------------------------------------------------------- */

/* Longitude and latitude where the vertical lines of the lattice's nodes are at height h. */
static Status lattice_places(double *lon, double *lat, const Import *m, const View *view, double h_m)
{
    const Field *z = &view->level;
    for (int b = 0; b < view->nodes_y; b++)
        for (int a = 0; a < view->nodes_x; a++) {
            double p_enu[3] = {(z->i0 + a * view->stride) * z->spacing_m,
                               (z->j0 + view->node_row0 + b * view->stride) * z->spacing_m, 0},
                   p_ecef[3];
            double z_m, dz_per_h;
            levels_curve_at(&m->curve, p_enu[0], p_enu[1], &z_m, &dz_per_h);
            p_enu[2] = z_m + h_m * dz_per_h;
            ecef_from_enu(p_ecef, m->frame, p_enu);
            Geodetic     place;
            const Status status = geodetic_from_ecef(&place, p_ecef);
            if (status != STATUS_OK) return status;
            lon[b * view->nodes_x + a] = place.lon_rad;
            lat[b * view->nodes_x + a] = place.lat_rad;
        }
    return STATUS_OK;
}

void view_free(View *view)
{
    for (int k = 0; k < import_most_grids; k++) {
        Sight *s = &view->sight[k];
        free(s->x);
        free(s->y);
        free(s->dx);
        free(s->dy);
        raster_patch_free(&view->patch[k]);
    }
    free(view->n_m);
    *view = (View){0};
}

/* Makes a view. Its lattice has a node every 16 posts, and at least every 128 m, over which the ellipsoid departs from
 * a plane by 0.3 mm; nodes that are farther apart are wrong by less than a 400th of the posts' spacing. */
Status view_create(View *out, const Import *m, const Field *level, int row0, int rows)
{
    View v = {.level = *level, .row0 = row0, .rows = rows};
    v.stride = level->spacing_m * 16 >= 128 ? 16 : (int)(128 / level->spacing_m);
    v.node_row0 = row0 / v.stride * v.stride;
    v.nodes_x = (level->nx - 1) / v.stride + 2; /* one node beyond the last post */
    v.nodes_y = (row0 + rows - 1 - v.node_row0) / v.stride + 2;
    const int    nodes = v.nodes_x * v.nodes_y;
    const size_t size = (size_t)nodes * sizeof(double);
    double      *lon = malloc(size), *lat = malloc(size);
    Status       status = STATUS_NO_MEMORY;
    v.n_m = malloc(size);
    if (!lon || !lat || !v.n_m) goto done;
    status = lattice_places(lon, lat, m, &v, 0);
    if (status != STATUS_OK) goto done;
    for (int n = 0; n < nodes; n++) v.n_m[n] = m->geoid.n_m ? geoid_height_m(&m->geoid, lat[n], lon[n]) : 0;
    for (int high = 0; high < 2; high++) {
        status = lattice_places(lon, lat, m, &v, high ? rise_m : 0);
        if (status != STATUS_OK) goto done;
        for (int k = 0; k < m->grids; k++) {
            Sight   *s = &v.sight[k];
            double **x = high ? &s->dx : &s->x, **y = high ? &s->dy : &s->y;
            *x = malloc(size);
            *y = malloc(size);
            if (!*x || !*y) {
                status = STATUS_NO_MEMORY;
                goto done;
            }
            memcpy(*x, lon, size);
            memcpy(*y, lat, size);
            raster_px_from_earth(m->grid[k].raster, nodes, *x, *y);
            for (int n = 0; high && n < nodes; n++) {
                s->dx[n] = (s->dx[n] - s->x[n]) / rise_m;
                s->dy[n] = (s->dy[n] - s->y[n]) / rise_m;
            }
        }
    }
done:
    free(lon);
    free(lat);
    if (status == STATUS_OK) *out = v;
    else view_free(&v);
    return status;
}

/* The window of a grid that a view needs, at the grid's own posting or averaged to the level's. */
bool view_window(RasterPatchWindow *out, const View *view, const Import *m, int grid)
{
    const Grid  *g = &m->grid[grid];
    const Sight *s = &view->sight[grid];
    const int    nodes = view->nodes_x * view->nodes_y;
    double       low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int n = 0; n < nodes; n++)
        for (int side = 0; side < 2; side++) {
            const double h_m = side ? highest_view_m : lowest_view_m, x = s->x[n] + h_m * s->dx[n],
                         y = s->y[n] + h_m * s->dy[n];
            if (!isfinite(x) || !isfinite(y)) continue;
            low[0] = fmin(low[0], x);
            low[1] = fmin(low[1], y);
            high[0] = fmax(high[0], x);
            high[1] = fmax(high[1], y);
        }
    const double size[2] = {g->raster->width, g->raster->height};
    int          from[2], to[2];
    for (int c = 0; c < 2; c++) {
        const double reach = g->long_m / g->units[c];
        if (!(high[c] > -reach && low[c] < size[c] + reach)) return false;
        from[c] = (int)clamp(floor(low[c]) - 2, 0, size[c] - 2);
        to[c] = (int)clamp(ceil(high[c]) + 3, from[c] + 2, size[c]);
    }
    int factor = 1;
    while (2 * factor * fmax(g->units[0], g->units[1]) <= view->level.spacing_m * 1.001) factor *= 2;
    *out = (RasterPatchWindow){from[0], from[1], to[0], to[1], factor, NULL};
    return true;
}

/* ---- heights -------------------------------------------------------------------------------- */

/* Height of one grid above the ellipsoid at a place in its pixels, and how far the place is beyond its outermost posts.
 * There the height is held at the edge, averaged ever more broadly. Returns false when the place is too far away to
 * count. nearest: of the nearest pixel alone. */
static bool grid_at(double *h_m, double *out_m, const Grid *g, const RasterPatch *patch, double x, double y, double n_m,
                    bool nearest)
{
    if (patch->mips == 0 || !isfinite(x) || !isfinite(y)) return false;
    const double w = g->raster->width - 0.5, h = g->raster->height - 0.5;
    const double out_x = (x < 0.5 ? 0.5 - x : x > w ? x - w : 0) * g->units[0];
    const double out_y = (y < 0.5 ? 0.5 - y : y > h ? y - h : 0) * g->units[1];
    double       mip = 0;
    *out_m = 0;
    if (out_x > 0 || out_y > 0) {
        const double posting_m = fmin(g->units[0], g->units[1]);
        *out_m = hypot(out_x, out_y);
        if (*out_m >= g->long_m) return false;
        mip = log2((posting_m + 0.5 * *out_m) / (posting_m * patch->factor));
    }
    if (nearest && *out_m == 0) {
        x = patch->x0 + (floor((x - patch->x0) / patch->factor) + 0.5) * patch->factor;
        y = patch->y0 + (floor((y - patch->y0) / patch->factor) + 0.5) * patch->factor;
    }
    *h_m = raster_patch_at(patch, x, y, mip) * g->raster->metres_per_unit + (g->ellipsoidal ? 0 : n_m);
    return true;
}

/* Height inside a hole of grid `at`: that of the next coarser grid at the place, and so on where that has a hole too.
 * Where there is no other grid, the hole's filling. */
static double coarser_in_holes(const Import *m, const View *view, int at, double filled_m, const double *x,
                               const double *y, double n_m, bool nearest)
{
    double sum = 0, left = 1, h_m = filled_m, out_m = 0;
    for (int k = at; k < m->grids; k++) {
        if (k > at && (!grid_at(&h_m, &out_m, &m->grid[k], &view->patch[k], x[k], y[k], n_m, nearest) || out_m > 0))
            continue;
        const double inside = raster_patch_hole(&view->patch[k], x[k], y[k]);
        if (!(inside > 0)) return sum + left * h_m;
        sum += left * (1 - inside) * h_m;
        left *= inside;
    }
    return sum + left * filled_m;
}

/* Height of all grids together: the finest that holds the place, blended with finer ones near by. Between and beyond
 * all grids the nearest edges count most, and farther out the base height. */
static double composed(const Import *m, const View *view, const double *x, const double *y, double n_m, bool nearest)
{
    double h_m[import_most_grids], out_m[import_most_grids], sum = 0, left = 1, weights = 0, cover = 0;
    int    at = 0;
    for (; at < m->grids; at++) {
        if (!grid_at(&h_m[at], &out_m[at], &m->grid[at], &view->patch[at], x[at], y[at], n_m, nearest))
            out_m[at] = INFINITY;
        else if (out_m[at] == 0) break;
    }
    if (at < m->grids) {
        if (view->patch[at].share) h_m[at] = coarser_in_holes(m, view, at, h_m[at], x, y, n_m, nearest);
        for (int k = 0; k < at; k++) {
            if (!(out_m[k] < m->grid[k].short_m)) continue;
            const double share = 1 - smooth_step(0, m->grid[k].short_m, out_m[k]);
            sum += left * share * h_m[k];
            left *= 1 - share;
        }
        return sum + left * h_m[at];
    }
    for (int k = 0; k < m->grids; k++) {
        if (!(out_m[k] < m->grid[k].long_m)) continue;
        const double share = 1 - smooth_step(0, m->grid[k].long_m, out_m[k]),
                     near = out_m[k] + 0.1 * m->grid[k].units[0];
        weights += share / (near * near);
        sum += share / (near * near) * h_m[k];
        cover = fmax(cover, share);
    }
    return weights > 0 ? cover * sum / weights + (1 - cover) * m->base_h_m : m->base_h_m;
}

/* Height at which the vertical line of the ENU plane, which is inclined to the grids' own verticals, meets their
 * surface. */
static double height_at(const Import *m, const View *view, const double *x0, const double *y0, const double *dx,
                        const double *dy, double n_m, double guess_m)
{
    double h_m = guess_m, lean = 0;
    for (int k = 0; k < m->grids; k++) lean = fmax(lean, fmax(fabs(dx[k]), fabs(dy[k])));
    for (int iteration = 0; iteration < 8; iteration++) {
        double x[import_most_grids], y[import_most_grids];
        for (int k = 0; k < m->grids; k++) {
            x[k] = x0[k] + h_m * dx[k];
            y[k] = y0[k] + h_m * dy[k];
        }
        const double next_m = composed(m, view, x, y, n_m, false), moved_px = fabs(next_m - h_m) * lean;
        h_m = next_m;
        if (moved_px < 1e-4) break; /* of a pixel: a tenth of a millimetre on a slope of 1 at 1 m posts */
    }
    return h_m;
}

static inline double mix(const double *v, int nx, double a, double b)
{
    const double south = v[0] + a * (v[1] - v[0]), north = v[nx] + a * (v[nx + 1] - v[nx]);
    return south + b * (north - south);
}

/* Heights of a run of posts in one row within one cell of the lattice, from all grids; cell_m: as View's. */
static double run_of_grids(float *h_m, float *cell_m, const Import *m, const View *view, size_t node, double b,
                           int from, int count, double guess_m)
{
    const int nx = view->nodes_x;
    for (int i = 0; i < count; i++) {
        const double a = (double)(from + i) / view->stride;
        double       x0[import_most_grids] = {0}, y0[import_most_grids] = {0}, dx[import_most_grids] = {0},
               dy[import_most_grids] = {0};
        for (int k = 0; k < m->grids; k++) {
            const Sight *s = &view->sight[k];
            if (view->patch[k].mips == 0) continue;
            x0[k] = mix(s->x + node, nx, a, b);
            y0[k] = mix(s->y + node, nx, a, b);
            dx[k] = mix(s->dx + node, nx, a, b);
            dy[k] = mix(s->dy + node, nx, a, b);
        }
        guess_m = height_at(m, view, x0, y0, dx, dy, mix(view->n_m + node, nx, a, b), guess_m);
        h_m[i] = (float)guess_m;
        if (!cell_m) continue;
        for (int k = 0; k < m->grids; k++) x0[k] += guess_m * dx[k], y0[k] += guess_m * dy[k];
        cell_m[i] = (float)composed(m, view, x0, y0, mix(view->n_m + node, nx, a, b), true);
    }
    return guess_m;
}

/* The same where only one grid has anything: its bilinear surface is evaluated directly. Several rows are computed at
 * once, since each post waits for the one before it. */
static void run_of_one(float *h_m, float *cell_m, const Import *m, const View *view, int grid, size_t node,
                       const double *b, int from, int count, int rows, double *guess_m)
{
    const int          nx = view->nodes_x, level_nx = view->level.nx;
    const Sight       *s = &view->sight[grid];
    const Grid        *g = &m->grid[grid];
    const RasterPatch *p = &view->patch[grid];
    const float       *v = p->v[0];
    const double       w = g->raster->width - 0.5, h = g->raster->height - 0.5, unit = g->raster->metres_per_unit;
    const double       inv_factor = 1.0 / p->factor, most_x = p->nx[0] - 1, most_y = p->ny[0] - 1;
    double             x0[rows_at_once][most_run], y0[rows_at_once][most_run], dx[rows_at_once][most_run],
        dy[rows_at_once][most_run], n_m[rows_at_once][most_run];
    for (int r = 0; r < rows; r++)
        for (int i = 0; i < count; i++) {
            const double a = (double)(from + i) / view->stride;
            x0[r][i] = mix(s->x + node, nx, a, b[r]);
            y0[r][i] = mix(s->y + node, nx, a, b[r]);
            dx[r][i] = mix(s->dx + node, nx, a, b[r]);
            dy[r][i] = mix(s->dy + node, nx, a, b[r]);
            n_m[r][i] = mix(view->n_m + node, nx, a, b[r]);
        }
    for (int i = 0; i < count; i++)
        for (int r = 0; r < rows; r++) {
            const double lean = fmax(fabs(dx[r][i]), fabs(dy[r][i])), add_m = g->ellipsoidal ? 0 : n_m[r][i];
            double       h_of = guess_m[r];
            for (int iteration = 0; iteration < 8; iteration++) {
                const double x = x0[r][i] + h_of * dx[r][i], y = y0[r][i] + h_of * dy[r][i];
                double       next_m;
                if (x >= 0.5 && x <= w && y >= 0.5 && y <= h) {
                    const double px = clamp((x - p->x0) * inv_factor - 0.5, 0, most_x),
                                 py = clamp((y - p->y0) * inv_factor - 0.5, 0, most_y);
                    const int c = (int)px < p->nx[0] - 1 ? (int)px : p->nx[0] - 2,
                              q = (int)py < p->ny[0] - 1 ? (int)py : p->ny[0] - 2;
                    const double t = px - c, f = py - q;
                    const float *lo = v + (size_t)q * (size_t)p->nx[0] + c, *hi = lo + p->nx[0];
                    const double south = (double)lo[0] + t * (double)(lo[1] - lo[0]),
                                 north = (double)hi[0] + t * (double)(hi[1] - hi[0]);
                    next_m = (south + f * (north - south)) * unit + add_m;
                } else {
                    double at_x[import_most_grids] = {0}, at_y[import_most_grids] = {0};
                    at_x[grid] = x;
                    at_y[grid] = y;
                    next_m = composed(m, view, at_x, at_y, n_m[r][i], false);
                }
                const double moved_px = fabs(next_m - h_of) * lean;
                h_of = next_m;
                if (moved_px < 1e-4) break; /* of a pixel: a tenth of a millimetre on a slope of 1 at 1 m posts */
            }
            guess_m[r] = h_of;
            h_m[(size_t)r * (size_t)level_nx + (size_t)i] = (float)h_of;
            if (!cell_m) continue;
            double at_x[import_most_grids] = {0}, at_y[import_most_grids] = {0};
            at_x[grid] = x0[r][i] + h_of * dx[r][i], at_y[grid] = y0[r][i] + h_of * dy[r][i];
            cell_m[(size_t)r * (size_t)level_nx + (size_t)i] = (float)composed(m, view, at_x, at_y, n_m[r][i], true);
        }
}

typedef struct Finding {
    const Import *m;
    const View   *view;
    float        *h_m;
    int           only; /* the only grid that has anything here; -1: several have, or none */
} Finding;

static void find_rows(void *user, int worker, int task)
{
    const Finding *f = user;
    const View    *view = f->view;
    const int      nx = view->level.nx, after = (task + 1) * rows_a_task, end = after < view->rows ? after : view->rows;
    (void)worker;
    for (int r = task * rows_a_task, rows; r < end; r += rows) {
        const int j = view->row0 + r - view->node_row0, node_row = j / view->stride;
        double    b[rows_at_once], guess_m[rows_at_once];
        for (rows = 0; rows < (f->only >= 0 ? rows_at_once : 1) && r + rows < end; rows++) {
            if ((j + rows) / view->stride != node_row) break;
            b[rows] = (double)((j + rows) % view->stride) / view->stride;
            guess_m[rows] = f->m->base_h_m;
        }
        for (int i = 0; i < nx;) {
            const size_t node = (size_t)node_row * (size_t)view->nodes_x + (size_t)(i / view->stride);
            int          from = i % view->stride, count = view->stride - from;
            count = count < nx - i ? count : nx - i;
            count = count < most_run ? count : most_run;
            const size_t first = (size_t)r * (size_t)nx + (size_t)i;
            float       *to = f->h_m + first, *cell = view->cell_m ? view->cell_m + first : NULL;
            if (f->only >= 0) run_of_one(to, cell, f->m, view, f->only, node, b, from, count, rows, guess_m);
            else guess_m[0] = run_of_grids(to, cell, f->m, view, node, b[0], from, count, guess_m[0]);
            i += count;
        }
    }
}

Status view_heights(float *h_m, const View *view, const Import *m)
{
    Finding f = {m, view, h_m, -1};
    int     some = 0;
    for (int k = 0; k < m->grids; k++) {
        if (view->patch[k].mips == 0) continue;
        some++;
        f.only = k;
    }
    if (some != 1 || view->patch[f.only].nx[0] < 2 || view->patch[f.only].ny[0] < 2) f.only = -1;
    return pool_run_unless_stopped(m->pool, (view->rows + rows_a_task - 1) / rows_a_task, find_rows, &f) ? STATUS_OK
                                                                                                         : STATUS_IO;
}

/* ---- into ENU -------------------------------------------------------------------------------- */

typedef struct Bending {
    const Import *m;
    const Field  *level;
    float        *v;
    int           row0, rows, stride, nx;
    double       *z; /* [tasks][4][nx] */
} Bending;

/* Exact on every stride-th post of the level, bilinear between: over 64 m the ellipsoid bends by 0.1 mm. */
static void bend_rows(void *user, int worker, int task)
{
    const Bending *b = user;
    const Field   *z = b->level;
    const int      nx = b->nx, stride = b->stride, group = (b->row0 / stride + task) * stride;
    double        *space = b->z + 4 * (size_t)nx * (size_t)task;
    double        *z_of[2] = {space, space + nx}, *g_of[2] = {space + 2 * nx, space + 3 * nx};
    (void)worker;
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < nx; c++)
            levels_curve_at(&b->m->curve, (z->i0 + c * stride) * z->spacing_m,
                            (z->j0 + group + side * stride) * z->spacing_m, &z_of[side][c], &g_of[side][c]);
    const int from = group > b->row0 ? group : b->row0;
    const int to = group + stride < b->row0 + b->rows ? group + stride : b->row0 + b->rows;
    for (int j = from; j < to; j++) {
        const double v = (double)(j - group) / stride;
        float       *row = b->v + (size_t)(j - b->row0) * (size_t)z->nx;
        for (int c = 0; c * stride < z->nx; c++) {
            const double zw = z_of[0][c] + v * (z_of[1][c] - z_of[0][c]);
            const double ze = z_of[0][c + 1] + v * (z_of[1][c + 1] - z_of[0][c + 1]);
            const double g = g_of[0][c];
            const int    end = (c + 1) * stride < z->nx ? stride : z->nx - c * stride;
            for (int i = 0; i < end; i++)
                row[c * stride + i] = (float)(zw + (ze - zw) * i / stride + g * (double)row[c * stride + i]);
        }
    }
}

Status view_bend(float *rows_m, const Import *m, const Field *level, int row0, int rows)
{
    Bending b = {.m = m, .level = level, .v = rows_m, .row0 = row0, .rows = rows};
    b.stride = (int)(64 / level->spacing_m);
    if (b.stride < 1) b.stride = 1;
    b.nx = (level->nx - 1) / b.stride + 2;
    const int tasks = (row0 + rows - 1) / b.stride - row0 / b.stride + 1;
    b.z = malloc(4 * (size_t)b.nx * (size_t)tasks * sizeof *b.z);
    if (!b.z) return STATUS_NO_MEMORY;
    const bool whole = pool_run_unless_stopped(m->pool, tasks, bend_rows, &b);
    free(b.z);
    return whole ? STATUS_OK : STATUS_IO;
}

/* Blends some rows of a level into the level around, as levels_join does. */
void view_join(float *rows_m, const Field *level, int row0, int rows, const Field *outer)
{
    const int band = import_join_band;
    for (int j = row0; j < row0 + rows; j++) {
        const int dj = j < level->ny - 1 - j ? j : level->ny - 1 - j;
        for (int i = 0; i < level->nx; i++) {
            const int di = i < level->nx - 1 - i ? i : level->nx - 1 - i, d = di < dj ? di : dj;
            if (d >= band) {
                i = level->nx - band - 1 > i ? level->nx - band - 1
                                             : i; /* jumps across the middle, which is not blended */
                continue;
            }
            int          corner[3];
            double       weight[3];
            const double around_m = levels_height(outer, (level->i0 + i) * level->spacing_m,
                                                  (level->j0 + j) * level->spacing_m, corner, weight);
            const double share = smooth_step(0, band, d);
            float       *post = &rows_m[(size_t)(j - row0) * (size_t)level->nx + (size_t)i];
            *post = (float)(around_m + share * ((double)*post - around_m));
        }
    }
}
