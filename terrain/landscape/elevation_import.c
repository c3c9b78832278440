/* terrain/landscape/elevation_import.c: plan the levels; from the horizon inwards, read what a level needs of every
 * grid, find its posts, apply curvature and blend; at the end measure the error against the files. */
#include "terrain/landscape/elevation_import_private.h"

#include <stdlib.h>

static const char key[] = "terrain.elevation";
static const double lowest_m = -12500, highest_m = 9500; /* below the deepest trench or above Everest: a void */
static const double rise_m = 4000; /* between the two heights with exact look-up */
enum { most_posts_0 = 36 << 20, outer_half_posts = 1024, last_half_posts = 2048 };

/* ---- plan ----------------------------------------------------------------------------------- */

static int round_out(double posts)
{
    return (int)(posts < 0 ? floor(posts / level_ratio) : ceil(posts / level_ratio)) * level_ratio;
}

/* How far a grid's nearest edge is from the origin: positive inside, negative outside; and the farthest. */
static void grid_reach(double reach_m[2], const Raster *raster, const LocalFrame *frame)
{
    double x = frame->origin.lon_rad, y = frame->origin.lat_rad;
    raster_px_from_earth(raster, 1, &x, &y);
    const double west = (x - 0.5) * raster->posting_m[0], east = (raster->width - 0.5 - x) * raster->posting_m[0];
    const double north = (y - 0.5) * raster->posting_m[1], south = (raster->height - 0.5 - y) * raster->posting_m[1];
    const double nearest = fmin(fmin(west, east), fmin(north, south));
    const double out_x = fmax(fmax(-west, -east), 0), out_y = fmax(fmax(-north, -south), 0);
    reach_m[0] = out_x > 0 || out_y > 0 || !isfinite(nearest) ? -hypot(out_x, out_y) : nearest;
    reach_m[1] = fmax(fmax(west, east), fmax(north, south));
    if (!isfinite(x) || !isfinite(y)) reach_m[0] = -INFINITY;
}

static Status choose_main(Import *m, ElevationReport *report)
{
    static const double nearest_m = 20000;
    double best_m = -INFINITY;
    m->main = -1;
    report->reach_m[0] = -INFINITY;
    report->reach_m[1] = 0;
    for (int k = 0; k < m->grids; k++) {
        double reach_m[2];
        grid_reach(reach_m, m->grid[k].raster, m->frame);
        if (m->main < 0 && reach_m[0] > 0) m->main = k;
        best_m = fmax(best_m, reach_m[0]);
        report->reach_m[0] = fmax(report->reach_m[0], reach_m[0]);
        report->reach_m[1] = fmax(report->reach_m[1], reach_m[1]);
    }
    if (m->main >= 0) return STATUS_OK;
    if (!(best_m > -nearest_m)) {
        log_error("%s: the action is at %.4f, %.4f degrees, %.0f km from the nearest data; name sheets that hold it",
                  key, m->frame->origin.lat_rad / rad_per_deg, m->frame->origin.lon_rad / rad_per_deg, -best_m * 1e-3);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < m->grids; k++) {
        double reach_m[2];
        grid_reach(reach_m, m->grid[k].raster, m->frame);
        if (reach_m[0] == best_m) m->main = k;
    }
    return STATUS_OK;
}

static void set_window(WorkLevel *level, double spacing_m, int i0, int i1, int j0, int j1)
{
    *level = (WorkLevel){.z = {spacing_m, i0, j0, i1 - i0 + 1, j1 - j0 + 1, NULL}, .hole_i1 = -1};
}

static void plan_levels(Import *m)
{
    enum { least_ring = 2 * level_ratio, margin = 32 };
    const Raster *raster = m->grid[m->main].raster;
    double        s = m->files->spacing_m > 0 ? m->files->spacing_m : fmin(raster->posting_m[0], raster->posting_m[1]);
    s = fmax(rint(s * 64) / 64, 0x1p-6); /* dyadic, so that every post's place is exact */

    double low[2], high[2];
    int    first[2], last[2];
    raster_enu_box(low, high, raster, m->frame, 0.5);
    for (int k = 0; k < m->grids; k++) { /* neighbours of about the same posting belong to it */
        double other_low[2], other_high[2];
        if (fmin(m->grid[k].units[0], m->grid[k].units[1]) > 2 * s || k == m->main) continue;
        raster_enu_box(other_low, other_high, m->grid[k].raster, m->frame, 0.5);
        for (int c = 0; c < 2; c++) {
            low[c]  = fmin(low[c], other_low[c]);
            high[c] = fmax(high[c], other_high[c]);
        }
    }
    const int half = round_out(0.5 * sqrt((double)most_posts_0) - level_ratio);
    for (int c = 0; c < 2; c++) {
        const double a = fmin(low[c] / s, 0) - margin, b = fmax(high[c] / s, 0) + margin;
        first[c] = round_out(fmax(a, -half));
        last[c]  = round_out(fmin(b, half));
    }
    set_window(&m->level[0], s, first[0], last[0], first[1], last[1]);
    m->level_count = 1;
    while (m->level_count < elevation_max_levels) {
        const WorkLevel *in = &m->level[m->level_count - 1];
        const int i1 = in->z.i0 + in->z.nx - 1, j1 = in->z.j0 + in->z.ny - 1;
        const double narrowest = fmin(fmin(-in->z.i0, i1), fmin(-in->z.j0, j1)) * s; /* data may be one long strip */
        if (narrowest >= m->files->horizon_m) break;
        s *= level_ratio;
        const bool ends = m->level_count == elevation_max_levels - 1 || outer_half_posts * s >= m->files->horizon_m;
        const int  wide = round_out(fmin(ends ? last_half_posts : outer_half_posts, m->files->horizon_m / s));
        WorkLevel *level = &m->level[m->level_count++];
        int w[4] = {-wide, wide, -wide, wide};
        const int need[4] = {round_out(in->z.i0 / level_ratio - least_ring), round_out(i1 / level_ratio + least_ring),
                             round_out(in->z.j0 / level_ratio - least_ring), round_out(j1 / level_ratio + least_ring)};
        for (int e = 0; e < 4; e++)
            if (e & 1 ? need[e] > w[e] : need[e] < w[e]) w[e] = need[e];
        set_window(level, s, w[0], w[1], w[2], w[3]);
        level->hole_i0 = in->z.i0 / level_ratio;
        level->hole_i1 = i1 / level_ratio;
        level->hole_j0 = in->z.j0 / level_ratio;
        level->hole_j1 = j1 / level_ratio;
        if (ends) break;
    }
    m->level[m->level_count - 1].outermost = true;
    for (int k = 0; k < m->level_count; k++) m->spacing_m[k] = m->level[k].z.spacing_m;
}

/* ---- where posts lie in the grids ----------------------------------------------------------- */

/* Longitude and latitude on the lattice's nodes of the vertical line at height h. */
static Status lattice_places(double *lon, double *lat, const Import *m, const Field *z, double h_m)
{
    for (int b = 0; b < m->lattice_ny; b++)
        for (int a = 0; a < m->lattice_nx; a++) {
            double p_enu[3] = {(z->i0 + a * m->stride) * z->spacing_m, (z->j0 + b * m->stride) * z->spacing_m, 0},
                   p_ecef[3];
            double z_m, dz_per_h;
            curve_at(&m->curve, p_enu[0], p_enu[1], &z_m, &dz_per_h);
            p_enu[2] = z_m + h_m * dz_per_h;
            ecef_from_enu(p_ecef, m->frame, p_enu);
            Geodetic     place;
            const Status status = geodetic_from_ecef(&place, p_ecef);
            if (status != STATUS_OK) return status;
            lon[b * m->lattice_nx + a] = place.lon_rad;
            lat[b * m->lattice_nx + a] = place.lat_rad;
        }
    return STATUS_OK;
}

static void free_lattice(Import *m)
{
    for (int k = 0; k < m->grids; k++) {
        Sight *s = &m->grid[k].sight;
        free(s->x);
        free(s->y);
        free(s->dx);
        free(s->dy);
        *s = (Sight){0};
        patch_free(&m->grid[k].patch);
    }
    free(m->n_m);
    m->n_m = NULL;
}

/* A node of the lattice every 16 posts, and every 128 m at least: over that the ellipsoid departs from a plane by
 * 0.3 mm, and where nodes are farther apart by less than a 400th of the posts' spacing. */
static Status look_out(Import *m, const Field *z)
{
    m->stride     = z->spacing_m * 16 >= 128 ? 16 : (int)(128 / z->spacing_m);
    m->lattice_nx = (z->nx - 1) / m->stride + 2; /* one more than the last post stands on */
    m->lattice_ny = (z->ny - 1) / m->stride + 2;
    const int    nodes = m->lattice_nx * m->lattice_ny;
    const size_t size = (size_t)nodes * sizeof(double);
    double      *lon = malloc(size), *lat = malloc(size);
    Status       status = STATUS_NO_MEMORY;
    m->n_m = malloc(size);
    if (!lon || !lat || !m->n_m) goto done;
    status = lattice_places(lon, lat, m, z, 0);
    if (status != STATUS_OK) goto done;
    for (int n = 0; n < nodes; n++) m->n_m[n] = m->geoid.n_m ? geoid_height_m(&m->geoid, lat[n], lon[n]) : 0;
    for (int high = 0; high < 2; high++) {
        status = lattice_places(lon, lat, m, z, high ? rise_m : 0);
        if (status != STATUS_OK) goto done;
        for (int k = 0; k < m->grids; k++) {
            Sight   *s = &m->grid[k].sight;
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
    return status;
}

/* Reads what this level needs of every grid: at its own posting, or averaged to the level's. */
static Status read_patches(Import *m, const Field *z)
{
    const int nodes = m->lattice_nx * m->lattice_ny;
    for (int k = 0; k < m->grids; k++) {
        Grid        *g = &m->grid[k];
        const Sight *s = &g->sight;
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int n = 0; n < nodes; n++)
            for (int side = 0; side < 2; side++) {
                const double h_m = side ? highest_m : -1000, x = s->x[n] + h_m * s->dx[n], y = s->y[n] + h_m * s->dy[n];
                if (!isfinite(x) || !isfinite(y)) continue;
                low[0]  = fmin(low[0], x);
                low[1]  = fmin(low[1], y);
                high[0] = fmax(high[0], x);
                high[1] = fmax(high[1], y);
            }
        const double size[2] = {g->raster->width, g->raster->height};
        int          from[2], to[2];
        bool         near = true;
        for (int c = 0; c < 2; c++) {
            const double reach = g->long_m / g->units[c];
            if (!(high[c] > -reach && low[c] < size[c] + reach)) near = false;
            from[c] = (int)clamp(floor(low[c]) - 2, 0, size[c] - 2);
            to[c]   = (int)clamp(ceil(high[c]) + 3, from[c] + 2, size[c]);
        }
        if (!near) continue;
        int factor = 1;
        while (2 * factor * fmax(g->units[0], g->units[1]) <= z->spacing_m * 1.001) factor *= 2;
        const double unit = g->raster->metres_per_unit;
        const Status status = patch_read(&g->patch, g->raster, 1, from[0], from[1], to[0], to[1], factor,
                                         lowest_m / unit, highest_m / unit, key);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

/* ---- heights -------------------------------------------------------------------------------- */

/* One grid at a place in its pixels: height above the ellipsoid, and how far it is beyond its outermost posts; there it
 * is held at its edge, ever more broadly averaged. False: too far to count. */
static bool grid_at(double *h_m, double *out_m, const Grid *g, double x, double y, double n_m)
{
    if (g->patch.mips == 0 || !isfinite(x) || !isfinite(y)) return false;
    const double w = g->raster->width - 0.5, h = g->raster->height - 0.5;
    const double out_x = (x < 0.5 ? 0.5 - x : x > w ? x - w : 0) * g->units[0];
    const double out_y = (y < 0.5 ? 0.5 - y : y > h ? y - h : 0) * g->units[1];
    double       mip = 0;
    *out_m = 0;
    if (out_x > 0 || out_y > 0) {
        const double posting_m = fmin(g->units[0], g->units[1]);
        *out_m = hypot(out_x, out_y);
        if (*out_m >= g->long_m) return false;
        mip = log2((posting_m + 0.5 * *out_m) / (posting_m * g->patch.factor));
    }
    *h_m = patch_at(&g->patch, x, y, mip) * g->raster->metres_per_unit + (g->ellipsoidal ? 0 : n_m);
    return true;
}

/* All grids together: the finest that holds the place, led over to by finer ones near by; between and beyond all of
 * them the edges, the nearest first, and farther out the plain. */
static double composed(const Import *m, const double *x, const double *y, double n_m)
{
    double h_m[import_most_grids], out_m[import_most_grids], sum = 0, left = 1, weights = 0, cover = 0;
    int    at = 0;
    for (; at < m->grids; at++) {
        if (!grid_at(&h_m[at], &out_m[at], &m->grid[at], x[at], y[at], n_m)) out_m[at] = INFINITY;
        else if (out_m[at] == 0) break;
    }
    if (at < m->grids) {
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

/* Where the vertical line of the ENU plane, which is inclined against the grids' own verticals, intersects them. */
static double height_at(const Import *m, const double *x0, const double *y0, const double *dx, const double *dy,
                        double n_m, double guess_m)
{
    double h_m = guess_m, lean = 0;
    for (int k = 0; k < m->grids; k++) lean = fmax(lean, fmax(fabs(dx[k]), fabs(dy[k])));
    for (int iteration = 0; iteration < 8; iteration++) {
        double x[import_most_grids], y[import_most_grids];
        for (int k = 0; k < m->grids; k++) {
            x[k] = x0[k] + h_m * dx[k];
            y[k] = y0[k] + h_m * dy[k];
        }
        const double next_m = composed(m, x, y, n_m), moved_px = fabs(next_m - h_m) * lean;
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

static void find_posts(const Import *m, Field *z)
{
    double guess_m = m->base_h_m;
    for (int j = 0; j < z->ny; j++) {
        const int    lj = j / m->stride;
        const double b = (double)(j % m->stride) / m->stride;
        for (int i = 0; i < z->nx; i++) {
            const int    li = i / m->stride;
            const double a = (double)(i % m->stride) / m->stride;
            const size_t node = (size_t)lj * (size_t)m->lattice_nx + (size_t)li;
            double x0[import_most_grids] = {0}, y0[import_most_grids] = {0}, dx[import_most_grids] = {0},
                   dy[import_most_grids] = {0};
            for (int k = 0; k < m->grids; k++) {
                const Sight *s = &m->grid[k].sight;
                if (m->grid[k].patch.mips == 0) continue;
                x0[k] = mix(s->x + node, m->lattice_nx, a, b);
                y0[k] = mix(s->y + node, m->lattice_nx, a, b);
                dx[k] = mix(s->dx + node, m->lattice_nx, a, b);
                dy[k] = mix(s->dy + node, m->lattice_nx, a, b);
            }
            guess_m = height_at(m, x0, y0, dx, dy, mix(m->n_m + node, m->lattice_nx, a, b), guess_m);
            z->v[(size_t)j * (size_t)z->nx + (size_t)i] = (float)guess_m;
        }
    }
}

/* Mean and spread of each grid's outline: for the blending from it, and the height beyond the coarsest. */
static bool measure_edges(Import *m, double geoid_m)
{
    bool any = false;
    for (int k = 0; k < m->grids; k++) {
        Grid        *g = &m->grid[k];
        const Patch *p = &g->patch;
        const int    nx = p->nx[0], ny = p->ny[0];
        double       sum = 0, low = INFINITY, high = -INFINITY;
        long         count = 0;
        if (p->mips == 0) continue;
        for (int j = 0; j < ny; j++)
            for (int i = 0; i < nx; i++) {
                if (j > 0 && j < ny - 1 && i > 0 && i < nx - 1) i = nx - 1;
                const double h_m = p->v[0][(size_t)j * (size_t)nx + (size_t)i] * g->raster->metres_per_unit;
                sum += h_m;
                low  = fmin(low, h_m);
                high = fmax(high, h_m);
                count++;
            }
        m->base_h_m = sum / (double)count + (g->ellipsoidal ? 0 : geoid_m);
        g->long_m   = clamp(15 * (high - low), 2000, 30000); /* a slope of one in fifteen */
        any         = true;
    }
    return any;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static Status open_files(Import *m)
{
    Status status = raster_set_open(&m->set, m->files->paths, key);
    if (status != STATUS_OK) return status;
    if (m->set.count > import_most_grids) {
        log_error("%s: the files lie on %d different grids, more than %d; gdalbuildvrt joins them", key, m->set.count,
                  (int)import_most_grids);
        return STATUS_BAD_VALUE;
    }
    bool wants_geoid = false;
    m->grids = m->set.count;
    for (int k = 0; k < m->grids; k++) {
        const Raster *raster = &m->set.raster[k];
        Grid         *g = &m->grid[k];
        g->raster      = raster;
        g->units[0]    = raster->posting_m[0];
        g->units[1]    = raster->posting_m[1];
        g->ellipsoidal =
            m->files->vertical == ELEVATION_BY_FILE ? raster->ellipsoidal : m->files->vertical == ELEVATION_ELLIPSOID;
        wants_geoid |= !g->ellipsoidal;
        /* into the coarser grid around: some of its posts */
        g->short_m =
            k + 1 < m->grids ? 8 * fmax(m->set.raster[k + 1].posting_m[0], m->set.raster[k + 1].posting_m[1]) : 0;
        g->long_m  = 30000; /* until its edge has been seen */
    }
    return wants_geoid ? geoid_open(&m->geoid, m->files->geoid_path) : STATUS_OK;
}

static Status make_level(Import *m, int k, double geoid_m, Patch *kept, long *voids)
{
    WorkLevel *level = &m->level[k];
    Field     *z = &level->z;
    Status     status = field_create(z, z->spacing_m, z->i0, z->j0, z->nx, z->ny);
    if (status == STATUS_OK) status = look_out(m, z);
    if (status == STATUS_OK) status = read_patches(m, z);
    if (status == STATUS_OK) {
        if (level->outermost && !measure_edges(m, geoid_m)) {
            log_error("%s: no post of the named files holds a height; gdalinfo -mm says what they hold", key);
            status = STATUS_BAD_VALUE;
        } else {
            find_posts(m, z);
        }
    }
    if (status == STATUS_OK && k == 0) {
        *voids = m->grid[m->main].patch.voids;
        *kept  = m->grid[m->main].patch;
        m->grid[m->main].patch = (Patch){0};
    }
    free_lattice(m);
    return status;
}

Status elevation_import(Elevation *out, ElevationReport *report, const ElevationFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count)
{
    Import          m = {.files = files, .frame = frame};
    ElevationReport r = {0};
    Elevation       elevation = {0};
    Patch           patch = {0};
    if (!(files->horizon_m > 0) || !(files->spacing_m >= 0)) return STATUS_BAD_VALUE;
    curve_of_frame(&m.curve, frame);
    Status status = open_files(&m);
    if (status == STATUS_OK) status = choose_main(&m, &r);
    if (status != STATUS_OK) goto done;
    plan_levels(&m);
    r.geoid_m = m.geoid.n_m ? geoid_height_m(&m.geoid, frame->origin.lat_rad, frame->origin.lon_rad) : 0;
    for (int k = m.level_count - 1; status == STATUS_OK && k >= 0; k--)
        status = make_level(&m, k, r.geoid_m, &patch, &r.voids);
    if (status == STATUS_OK && fix_count > 0) status = elevation_import_correct(&m, fix, fix_count, &r.correction_m);
    for (int k = m.level_count - 1; status == STATUS_OK && k >= 0; k--) {
        status = levels_bend(&m.level[k].z, &m.curve);
        if (status == STATUS_OK && !m.level[k].outermost) levels_join(&m.level[k], &m.level[k + 1], import_join_band);
    }
    if (status == STATUS_OK) status = levels_store_fine(&elevation, m.level, m.level_count);
    if (status == STATUS_OK && patch.mips > 0 && r.correction_m == 0 && patch.factor == 1 && patch.nx[0] > 1 &&
        patch.ny[0] > 1)
        status = elevation_import_measure(&r, &m, &elevation, &patch);
    if (status != STATUS_OK) goto done;

    const Grid *main_grid = &m.grid[m.main];
    for (int k = 0; k < m.set.count; k++) r.sheets += m.set.raster[k].sheet_count;
    r.grids       = m.grids;
    r.posting_m   = fmin(main_grid->units[0], main_grid->units[1]);
    r.spacing_m   = m.spacing_m[0];
    r.width_m[0]  = (m.level[0].z.nx - 1) * m.spacing_m[0];
    r.width_m[1]  = (m.level[0].z.ny - 1) * m.spacing_m[0];
    r.blend_m     = m.grid[m.grids - 1].long_m;
    r.beyond_h_m  = m.base_h_m;
    r.ellipsoidal = main_grid->ellipsoidal;
    if (r.ellipsoidal) r.geoid_m = 0;
    *report = r;
    *out    = elevation;
    elevation = (Elevation){0};

done:
    elevation_destroy(&elevation);
    patch_free(&patch);
    free_lattice(&m);
    for (int k = 0; k < elevation_max_levels; k++) field_destroy(&m.level[k].z);
    geoid_close(&m.geoid);
    raster_set_close(&m.set);
    return status;
}
