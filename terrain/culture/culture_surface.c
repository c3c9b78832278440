/* terrain/culture/culture_surface.c: patches of roof, cut at their steps, and the roof shape that fits each. */
#include "terrain/culture/culture_surface.h"
#include "terrain/culture/outline.h"

#include <stdlib.h>

static const double least_m2 = 12;

/* ---- patches -------------------------------------------------------------------------------------------- */

typedef struct Patches {
    int      nx, ny, count;
    int32_t *of;         /* [ny][nx] number of the patch, from 1; 0: no roof */
    int32_t *todo;       /* cells to look at */
    int32_t  before_cut; /* of pieces of the patch that is being cut: their numbers are greater */
} Patches;

static const int32_t unseen = -2; /* a cell of roof that is in no patch yet */

static double roof_of(const SurfaceParts *parts, size_t c)
{
    return parts->kind[c] == CELL_BUILDING ? (double)parts->roof_m[c] : NAN;
}

/* Height of a roof's cell, NAN elsewhere. */
static double roof_at(const SurfaceParts *parts, int nx, int ny, int x, int y)
{
    if (x < 0 || y < 0 || x >= nx || y >= ny) return NAN;
    return roof_of(parts, (size_t)y * (size_t)nx + (size_t)x);
}

/* Whether the roof goes on from a cell to its neighbour: by no more than its own slope on either side, and some. */
static bool goes_on(const void *user, const Patches *p, int x, int y, int dx, int dy)
{
    static const double step_m = 0.45;
    const SurfaceParts *parts = user;
    const double        here = roof_at(parts, p->nx, p->ny, x, y), there = roof_at(parts, p->nx, p->ny, x + dx, y + dy);
    const double        before = roof_at(parts, p->nx, p->ny, x - dx, y - dy);
    const double        after = roof_at(parts, p->nx, p->ny, x + 2 * dx, y + 2 * dy);
    const double        slope = fmax(isnan(before) ? 0 : fabs(here - before), isnan(after) ? 0 : fabs(after - there));
    return fabs(there - here) <= step_m + fmin(slope, 1.5);
}

typedef bool Joins(const void *user, const Patches *p, int x, int y, int dx, int dy);

/* A patch of cells that hold `from`, joined by sides where `joins` says so. */
typedef struct Patch {
    int32_t number;
    size_t  first, last;    /* least and greatest index of its cells */
    int     cells, cuts;    /* how often it was cut off one that no shape fits */
    int     x0, y0, x1, y1; /* box of its cells, inclusive */
} Patch;

static Patch fill_patch(Patches *p, size_t first, int32_t from, int32_t number, Joins *joins, const void *user)
{
    static const int go[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    Patch            patch = {.number = number, .first = first, .last = first};
    int              count = 0;
    patch.x0 = patch.x1 = (int)(first % (size_t)p->nx), patch.y0 = patch.y1 = (int)(first / (size_t)p->nx);
    p->of[first] = number;
    p->todo[count++] = (int32_t)first;
    while (count > 0) {
        const int c = p->todo[--count], x = c % p->nx, y = c / p->nx;
        patch.cells++;
        patch.first = (size_t)c < patch.first ? (size_t)c : patch.first;
        patch.last = (size_t)c > patch.last ? (size_t)c : patch.last;
        patch.x0 = x < patch.x0 ? x : patch.x0, patch.x1 = x > patch.x1 ? x : patch.x1;
        patch.y0 = y < patch.y0 ? y : patch.y0, patch.y1 = y > patch.y1 ? y : patch.y1;
        for (int k = 0; k < 4; k++) {
            const int i = x + go[k][0], j = y + go[k][1];
            if (i < 0 || j < 0 || i >= p->nx || j >= p->ny) continue;
            int32_t *there = &p->of[(size_t)j * (size_t)p->nx + (size_t)i];
            if (*there != from || !joins(user, p, x, y, go[k][0], go[k][1])) continue;
            *there = number;
            p->todo[count++] = j * p->nx + i;
        }
    }
    return patch;
}

/* Whether a patch is nowhere three cells wide. */
static bool is_thin(const Patches *p, const Patch *patch)
{
    for (int y = patch->y0 + 1; y < patch->y1; y++)
        for (int x = patch->x0 + 1; x < patch->x1; x++) {
            bool whole = true;
            for (int k = 0; k < 9 && whole; k++)
                whole = p->of[(size_t)(y + k / 3 - 1) * (size_t)p->nx + (size_t)(x + k % 3 - 1)] == patch->number;
            if (whole) return false;
        }
    return true;
}

/* Whether a patch is the edge of another roof: cells that are partly roof and partly ground lie between both in height
 * and can be a patch of their own. It is thin, and another roof lies beside at least a third of its cells. */
static bool is_edge(const Patches *p, const Patch *patch)
{
    int beside = 0;
    if (!is_thin(p, patch)) return false;
    for (int y = patch->y0; y <= patch->y1; y++)
        for (int x = patch->x0; x <= patch->x1; x++) {
            const size_t c = (size_t)y * (size_t)p->nx + (size_t)x;
            if (p->of[c] != patch->number) continue;
            const int32_t near[4] = {x > 0 ? p->of[c - 1] : 0, x + 1 < p->nx ? p->of[c + 1] : 0,
                                     y > 0 ? p->of[c - (size_t)p->nx] : 0,
                                     y + 1 < p->ny ? p->of[c + (size_t)p->nx] : 0};
            bool other = false;
            for (int k = 0; k < 4; k++) other |= near[k] != 0 && near[k] != patch->number;
            beside += other;
        }
    return 3 * beside >= patch->cells;
}

/* ---- patches of several heights ------------------------------------------------------------------------- */

/* The height that parts a patch's cells best into two groups (Otsu 1979). */
static double parting_m(const double *z_m, int count)
{
    enum { bins = 256 };
    double low = INFINITY, high = -INFINITY, many[bins] = {0}, all = 0, best = -1, at = 0;
    for (int k = 0; k < count; k++) low = fmin(low, z_m[k]), high = fmax(high, z_m[k]);
    const double step = fmax((high - low) / bins, 1e-6);
    for (int k = 0; k < count; k++) many[(int)fmin((z_m[k] - low) / step, bins - 1)]++;
    for (int k = 0; k < bins; k++) all += k * many[k];
    for (double k = 0, below = 0, sum = 0; k < bins - 1; k++) {
        below += many[(int)k], sum += k * many[(int)k];
        const double above = count - below;
        if (below == 0 || above == 0) continue;
        const double apart = sum / below - (all - sum) / above, spread = below * above * apart * apart;
        if (spread > best) best = spread, at = k;
    }
    return low + (at + 1) * step;
}

typedef struct Parting {
    const SurfaceParts *parts;
    double              at_m;
} Parting;

static bool same_side(const void *user, const Patches *p, int x, int y, int dx, int dy)
{
    const Parting *parting = user;
    const size_t   here = (size_t)y * (size_t)p->nx + (size_t)x;
    const size_t   there = (size_t)(y + dy) * (size_t)p->nx + (size_t)(x + dx);
    return ((double)parting->parts->roof_m[here] > parting->at_m) ==
           ((double)parting->parts->roof_m[there] > parting->at_m);
}

/* The cells of a patch that was cut into small pieces go to what they touch, until none is left. */
static void give_away(Patches *p, size_t first, size_t last, int32_t small)
{
    for (bool again = true; again;) {
        again = false;
        for (size_t c = first; c <= last; c++) {
            if (p->of[c] != small) continue;
            const int     x = (int)(c % (size_t)p->nx);
            const int32_t near[4] = {x > 0 ? p->of[c - 1] : 0, x + 1 < p->nx ? p->of[c + 1] : 0,
                                     c >= (size_t)p->nx ? p->of[c - (size_t)p->nx] : 0,
                                     c + (size_t)p->nx < (size_t)p->nx * (size_t)p->ny ? p->of[c + (size_t)p->nx] : 0};
            for (int k = 0; k < 4 && p->of[c] == small; k++)
                if (near[k] > p->before_cut) p->of[c] = near[k], again = true;
        }
    }
}

/* ---- roofs ---------------------------------------------------------------------------------------------- */

/* The cells of a patch in the axes of its outline, from the middle of its box. */
typedef struct Roof {
    int     count;
    double *u_m, *v_m, *z_m, *wall_m; /* along, across, height, distance from the nearest wall */
    double  half_m[2];                /* of the box */
} Roof;

typedef struct RoofFit {
    RoofShape shape;
    double    eaves_m, ridge_m, turn_rad; /* turn: of ridge_rad from along_rad */
    double    rms_m;
} RoofFit;

/* h = a + b x in least squares, and the rms of the rest. */
static void fit_line(double *a, double *b, double *rms, int n, const double *x, const double *h)
{
    double sx = 0, sxx = 0, sh = 0, sxh = 0, shh = 0;
    for (int k = 0; k < n; k++) sx += x[k], sxx += x[k] * x[k], sh += h[k], sxh += x[k] * h[k], shh += h[k] * h[k];
    const double xx = sxx - sx * sx / n, xh = sxh - sx * sh / n;
    *b = xx > 1e-9 ? xh / xx : 0;
    *a = (sh - *b * sx) / n;
    *rms = sqrt(fmax((shh - sh * sh / n - *b * xh) / n, 0));
}

/* A shape is taken when it fits better by a good part than the simpler ones before it. */
static void consider(RoofFit *best, const RoofFit *other)
{
    static const double better = 0.8, least_rise_m = 0.5;
    if (other->ridge_m - other->eaves_m >= least_rise_m && other->rms_m < better * best->rms_m) *best = *other;
}

static int by_height(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static RoofFit fit_roof(const Roof *r, double *x)
{
    double  a, b, rms;
    RoofFit best = {.shape = ROOF_FLAT};
    for (int k = 0; k < r->count; k++) x[k] = 0;
    fit_line(&a, &b, &rms, r->count, x, r->z_m);
    memcpy(x, r->z_m, (size_t)r->count * sizeof *x);
    qsort(x, (size_t)r->count, sizeof *x, by_height);
    /* a flat roof lies where most of its cells are, not parapets and what stands on it */
    best.eaves_m = best.ridge_m = x[r->count / 2], best.rms_m = fmax(rms, 0.02);
    for (int axis = 0; axis < 2; axis++) { /* gables: the ridge along that axis */
        const double *off = axis ? r->u_m : r->v_m, half = r->half_m[1 - axis];
        for (int k = 0; k < r->count; k++) x[k] = fabs(off[k]);
        fit_line(&a, &b, &rms, r->count, x, r->z_m);
        consider(&best, &(RoofFit){ROOF_GABLED, a + b * half, a, axis * 0.5 * pi_rad, rms});
    }
    for (int way = 0; way < 2; way++) {
        const double *off = way ? r->v_m : r->u_m, half = r->half_m[way];
        fit_line(&a, &b, &rms, r->count, off, r->z_m);
        const RoofFit one = {ROOF_SKILLION, a - fabs(b) * half, a + fabs(b) * half,
                             way * 0.5 * pi_rad + (b > 0 ? pi_rad : 0), rms};
        consider(&best, &one);
    }
    double most_m = 0;
    for (int k = 0; k < r->count; k++) most_m = fmax(most_m, r->wall_m[k]);
    fit_line(&a, &b, &rms, r->count, r->wall_m, r->z_m);
    const bool square = fmax(r->half_m[0], r->half_m[1]) < 1.15 * fmin(r->half_m[0], r->half_m[1]);
    consider(&best, &(RoofFit){square ? ROOF_PYRAMIDAL : ROOF_HIPPED, a, a + b * most_m,
                               r->half_m[1] > r->half_m[0] ? 0.5 * pi_rad : 0, rms});
    return best;
}

/* ---- records -------------------------------------------------------------------------------------------- */

static double wall_distance(const Outline *o, double x, double y)
{
    double least = INFINITY;
    for (int k = 0; k < o->corners; k++) {
        const double *a = o->corner[k], *b = o->corner[(k + 1) % o->corners];
        const double  dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
        const double  t = square > 0 ? clamp(((x - a[0]) * dx + (y - a[1]) * dy) / square, 0, 1) : 0;
        least = fmin(least, hypot(x - a[0] - t * dx, y - a[1] - t * dy));
    }
    return least;
}

/* A patch at a time, in arrays of its own box: what is made of it is the same wherever the window lies. */
typedef struct Work {
    Culture            *culture;
    const SurfaceModel *model;
    const SurfacePlace *place;
    const SurfaceCore  *core;
    int                 x0, y0; /* south-west cell of the box in the window */
    Patches             patches;
    SurfaceParts        parts; /* of the box, building where the patch is */
    size_t              room;  /* cells of the box's arrays */
    Outline             outline;
    Roof                roof;
    double             *x;
    int                 least_cells, patch_count, patch_room;
    Patch              *patch; /* to be done, in order */
} Work;

/* The patch's cells into the roof's arrays; the box of its outline. Returns the lowest bare ground. */
static double gather(Work *w, const Patch *patch)
{
    const Outline *o = &w->outline;
    Roof          *r = &w->roof;
    const double   c = cos(o->along_rad), s = sin(o->along_rad), cell_m = w->model->cell_m;
    double         low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, base_m = INFINITY;
    for (int k = 0; k < o->corners; k++) {
        const double uv[2] = {c * o->corner[k][0] + s * o->corner[k][1], c * o->corner[k][1] - s * o->corner[k][0]};
        for (int i = 0; i < 2; i++) low[i] = fmin(low[i], uv[i]), high[i] = fmax(high[i], uv[i]);
    }
    for (int i = 0; i < 2; i++) r->half_m[i] = 0.5 * (high[i] - low[i]) * cell_m;
    r->count = 0;
    for (size_t at = patch->first; at <= patch->last; at++) {
        if (w->patches.of[at] != patch->number) continue;
        const double x = (double)(at % (size_t)w->patches.nx) + 0.5, y = (double)(at / (size_t)w->patches.nx) + 0.5;
        r->u_m[r->count] = (c * x + s * y - 0.5 * (low[0] + high[0])) * cell_m;
        r->v_m[r->count] = (c * y - s * x - 0.5 * (low[1] + high[1])) * cell_m;
        r->wall_m[r->count] = wall_distance(o, x, y) * cell_m;
        r->z_m[r->count++] = (double)w->parts.roof_m[at];
        base_m = fmin(base_m, (double)w->parts.bare_m[at]);
    }
    return base_m;
}

/* Cuts a patch that no shape fits at the height that parts it best; the pieces go to the end of the list. Returns
 * false where that leaves it whole. */
static bool cut_patch(Work *w, const Patch *patch)
{
    Patches      *p = &w->patches;
    const Parting parting = {&w->parts, parting_m(w->roof.z_m, w->roof.count)};
    const int     begun = w->patch_count;
    int32_t       small = 0;
    p->before_cut = p->count;
    if (w->patch_count + patch->cells / w->least_cells + 1 > w->patch_room) return false;
    for (size_t c = patch->first; c <= patch->last; c++) {
        if (p->of[c] != patch->number) continue;
        Patch piece = fill_patch(p, c, patch->number, ++p->count, same_side, &parting);
        piece.cuts = patch->cuts + 1;
        if (piece.cells >= w->least_cells && !is_thin(p, &piece)) w->patch[w->patch_count++] = piece;
        else small = -1, fill_patch(p, piece.first, piece.number, small, same_side, &parting);
    }
    if (small) give_away(p, patch->first, patch->last, small);
    for (int k = begun; k < w->patch_count; k++) { /* what they were given may reach beyond their first and last cell */
        w->patch[k].first = patch->last, w->patch[k].last = patch->first;
        for (size_t c = patch->first; c <= patch->last; c++)
            if (p->of[c] == w->patch[k].number)
                w->patch[k].first = c < w->patch[k].first ? c : w->patch[k].first, w->patch[k].last = c;
    }
    return w->patch_count > begun;
}

/* Whether the mean of the corners lies in the core. */
static bool is_of_core(const Work *w)
{
    const Outline *o = &w->outline;
    double         x = 0, y = 0;
    for (int k = 0; k < o->corners; k++) x += o->corner[k][0] / o->corners, y += o->corner[k][1] / o->corners;
    const int i = w->x0 + (int)floor(x), j = w->y0 + (int)floor(y);
    return !w->core || (i >= w->core->i0 && i < w->core->i1 && j >= w->core->j0 && j < w->core->j1);
}

static Status add_patch(Work *w, const Patch *patch)
{
    static const double good_m = 0.5;
    enum { most_cuts = 5 };
    Outline      *o = &w->outline;
    const int64_t column = w->model->column + w->x0, row = w->model->row + w->y0;
    if (!outline_of_cells(o, w->patches.of, w->patches.nx, w->patches.ny, patch->number, patch->first)) {
        w->outline.corners = 1;
        w->outline.corner[0][0] = (double)(patch->first % (size_t)w->patches.nx);
        w->outline.corner[0][1] = (double)(patch->first / (size_t)w->patches.nx);
        w->culture->left_out += is_of_core(w);
        return STATUS_OK;
    }
    const double  base_m = gather(w, patch);
    const RoofFit fit = fit_roof(&w->roof, w->x);
    if (fit.rms_m > good_m && patch->cells >= 2 * w->least_cells && patch->cuts < most_cuts && cut_patch(w, patch))
        return STATUS_OK;
    if (!is_of_core(w)) return STATUS_OK;
    double direction[2];
    for (int c = 0; c < 2; c++)
        direction[c] = w->place->east_m[c] * cos(o->along_rad + fit.turn_rad) +
                       w->place->north_m[c] * sin(o->along_rad + fit.turn_rad);
    for (int k = 0; k < o->corners; k++) {
        const double i = (double)column + o->corner[k][0], j = (double)row + o->corner[k][1];
        for (int c = 0; c < 2; c++)
            o->corner[k][c] = w->place->origin_m[c] + i * w->place->east_m[c] + j * w->place->north_m[c];
    }
    const uint64_t    of_row = (uint64_t)(row + (int64_t)(patch->first / (size_t)w->patches.nx));
    const uint64_t    of_column = (uint64_t)(column + (int64_t)(patch->first % (size_t)w->patches.nx));
    const double      area_m2 = w->roof.count * w->model->cell_m * w->model->cell_m;
    const double      eaves_m = fmax(fit.eaves_m - base_m, 1);
    const BuildingUse use = area_m2 > 900  ? BUILDING_HALL
                            : area_m2 < 30 ? BUILDING_SHED
                            : eaves_m > 9  ? BUILDING_FLATS
                                           : BUILDING_HOUSE;
    const Building    b = {.id = of_row << 32 | (of_column & 0xffffffffu),
                           .base_m = (float)base_m,
                           .eaves_m = (float)eaves_m,
                           .ridge_m = (float)fmax(fit.ridge_m - base_m, eaves_m),
                           .ridge_rad = (float)atan2(direction[1], direction[0]),
                           .use = (uint8_t)use,
                           .roof = (uint8_t)fit.shape,
                           .wall_fabric = use == BUILDING_HALL ? FABRIC_SHEET : FABRIC_RENDER,
                           .roof_fabric = fit.shape == ROOF_FLAT ? FABRIC_FELT
                                          : area_m2 > 900        ? FABRIC_SHEET
                                                                 : FABRIC_TILE,
                           .levels = (uint8_t)clamp(rint(eaves_m / 3), 1, 100),
                           .heated = area_m2 >= 30};
    return culture_add_building(w->culture, &b, (const double(*)[2])o->corner, o->corners);
}

/* ---- one box after the other ------------------------------------------------------------------------------ */

static void free_box(Work *w)
{
    free(w->patches.of), free(w->patches.todo), free(w->parts.bare_m), free(w->parts.roof_m), free(w->parts.kind);
    free(w->roof.u_m), free(w->roof.v_m), free(w->roof.z_m), free(w->roof.wall_m), free(w->x), free(w->patch);
}

/* Makes room for a box of cells. */
static Status grow_box(Work *w, size_t cells)
{
    if (cells <= w->room) return STATUS_OK;
    free_box(w);
    w->patches.of = malloc(cells * sizeof(int32_t)), w->patches.todo = malloc(cells * sizeof(int32_t));
    w->parts.bare_m = malloc(cells * sizeof(float)), w->parts.roof_m = malloc(cells * sizeof(float));
    w->parts.kind = malloc(cells);
    w->roof.u_m = malloc(cells * sizeof(double)), w->roof.v_m = malloc(cells * sizeof(double));
    w->roof.z_m = malloc(cells * sizeof(double)), w->roof.wall_m = malloc(cells * sizeof(double));
    w->x = malloc(cells * sizeof(double));
    w->patch_room = (int)(8 * cells / (size_t)w->least_cells) + 8; /* each cell is in a few, one for each cut */
    w->patch = malloc((size_t)w->patch_room * sizeof *w->patch);
    w->room = cells;
    return w->patches.of && w->patches.todo && w->parts.bare_m && w->parts.roof_m && w->parts.kind && w->roof.u_m &&
                   w->roof.v_m && w->roof.z_m && w->roof.wall_m && w->x && w->patch
               ? STATUS_OK
               : STATUS_NO_MEMORY;
}

static bool always(const void *user, const Patches *p, int x, int y, int dx, int dy)
{
    (void)user, (void)p, (void)x, (void)y, (void)dx, (void)dy;
    return true;
}

/* The buildings of those cells of a patch of the window that lie in a box. */
static Status take_box(Work *w, const Patches *window, int32_t number, const SurfaceParts *parts,
                       const SurfaceCore *box)
{
    const int    nx = box->i1 - box->i0, ny = box->j1 - box->j0;
    const size_t cells = (size_t)nx * (size_t)ny;
    Status       status = grow_box(w, cells);
    if (status != STATUS_OK) return status;
    w->x0 = box->i0, w->y0 = box->j0;
    w->patches.nx = nx, w->patches.ny = ny, w->patches.count = 0, w->patch_count = 0;
    for (size_t c = 0; c < cells; c++) {
        const size_t at = ((size_t)box->j0 + c / (size_t)nx) * (size_t)window->nx + (size_t)box->i0 + c % (size_t)nx;
        const bool   of = window->of[at] == number;
        w->patches.of[c] = of ? unseen : 0;
        w->parts.kind[c] = of ? CELL_BUILDING : CELL_BARE;
        w->parts.roof_m[c] = of ? parts->roof_m[at] : NAN;
        w->parts.bare_m[c] = parts->bare_m[at];
    }
    for (size_t c = 0; c < cells; c++) {
        if (w->patches.of[c] != unseen) continue;
        const Patch patch = fill_patch(&w->patches, c, unseen, ++w->patches.count, always, NULL);
        if (patch.cells >= w->least_cells) w->patch[w->patch_count++] = patch;
    }
    for (int k = 0; k < w->patch_count && status == STATUS_OK; k++) {
        const Patch patch = w->patch[k];
        status = add_patch(w, &patch);
    }
    return status;
}

static int64_t floor_to(int64_t value, int64_t step) { return value - ((value % step) + step) % step; }

/* A patch of the window as it is, or, larger than surface_building_most_m, cut along lines that the whole model has. */
static Status take_patch(Work *w, const Patches *window, const Patch *patch, const SurfaceParts *parts)
{
    const int most = (int)(surface_building_most_m / w->model->cell_m), tile = most / 2 > 1 ? most / 2 : 1;
    /* walls that are fitted may lie outside of the cells a little */
    const SurfaceCore *core = w->core;
    enum { more = 8 };
    if (core && (patch->x1 + more < core->i0 || patch->x0 - more >= core->i1 || patch->y1 + more < core->j0 ||
                 patch->y0 - more >= core->j1))
        return STATUS_OK;
    if (patch->x1 - patch->x0 < most && patch->y1 - patch->y0 < most) {
        const SurfaceCore box = {patch->x0, patch->y0, patch->x1 + 1, patch->y1 + 1};
        return take_box(w, window, patch->number, parts, &box);
    }
    const int64_t column = w->model->column, row = w->model->row;
    Status        status = STATUS_OK;
    for (int64_t j = floor_to(row + patch->y0, tile); j <= row + patch->y1 && status == STATUS_OK; j += tile)
        for (int64_t i = floor_to(column + patch->x0, tile); i <= column + patch->x1 && status == STATUS_OK;
             i += tile) {
            const SurfaceCore box = {(int)fmax((double)(i - column), patch->x0),
                                     (int)fmax((double)(j - row), patch->y0),
                                     (int)fmin((double)(i - column + tile), patch->x1 + 1),
                                     (int)fmin((double)(j - row + tile), patch->y1 + 1)};
            status = take_box(w, window, patch->number, parts, &box);
        }
    return status;
}

Status culture_add_surface(Culture *culture, const SurfaceParts *parts, const SurfaceModel *model,
                           const SurfacePlace *place, const SurfaceCore *core)
{
    const size_t n = (size_t)model->nx * (size_t)model->ny;
    Patches      window = {.nx = model->nx, .ny = model->ny};
    Work        *w = calloc(1, sizeof *w);
    Status       status = STATUS_NO_MEMORY;
    window.of = malloc(n * sizeof(int32_t));
    window.todo = malloc(n * sizeof(int32_t));
    if (w && window.of && window.todo) status = STATUS_OK;
    if (w) *w = (Work){.culture = culture, .model = model, .place = place, .core = core};
    if (w) w->least_cells = (int)fmax(least_m2 / (model->cell_m * model->cell_m), 4);
    for (size_t c = 0; c < n && status == STATUS_OK; c++) window.of[c] = isnan(roof_of(parts, c)) ? 0 : unseen;
    for (size_t c = 0; c < n && status == STATUS_OK; c++) {
        if (window.of[c] != unseen) continue;
        const Patch patch = fill_patch(&window, c, unseen, ++window.count, goes_on, parts);
        if (patch.cells >= w->least_cells && !is_edge(&window, &patch)) status = take_patch(w, &window, &patch, parts);
    }
    if (w) free_box(w);
    free(window.of), free(window.todo), free(w);
    return status;
}
