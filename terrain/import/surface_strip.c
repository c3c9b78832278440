/* terrain/import/surface_strip.c: overlapping windows of a surface model taken apart, beyond its data the ground that
 * the files lead over to; and buildings counted. */
#include "terrain/culture/culture_surface.h"
#include "terrain/import/terrain_import_private.h"

#include <stdlib.h>

enum { core_cells = 1024, fade_posts = 24 };

typedef struct Work {
    StreamLevel level;
    int         row0, rows; /* rows that were asked for */
    int         r0, r1;     /* the same with margins */
    int         margin;
    float      *surface_m, *bare_m; /* [r1 - r0][nx] */
    float *plain_m; /* [r1 - r0][nx] of all posts, also beyond the data: the terrain model, else the surface between
                       its cells */
    uint8_t      *of_file; /* [r1 - r0][nx] */
    uint8_t      *rgb;     /* [r1 - r0][nx][3]; NULL: none */
    uint8_t      *away;    /* [r1 - r0][nx] distance from the data in posts, at most fade_posts */
    SurfaceStrip *out;
    int           windows;
    Crown       **crown; /* [windows] */
    int          *crowns;
    Culture      *culture; /* [windows]; NULL: buildings are not wanted */
    Status       *status;
} Work;

void surface_strip_free(SurfaceStrip *strip)
{
    free(strip->h_m);
    free(strip->kind);
    free(strip->canopy_m);
    free(strip->crown);
    culture_free(&strip->culture);
    *strip = (SurfaceStrip){0};
}

/* Measures the city-block distance from the data, in two sweeps. */
static void measure_away(Work *w)
{
    const int nx = w->level.nx, ny = w->r1 - w->r0;
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            uint8_t *at = &w->away[(size_t)j * (size_t)nx + (size_t)i];
            int      least = w->of_file[(size_t)j * (size_t)nx + (size_t)i] ? 0 : fade_posts;
            if (i > 0 && at[-1] + 1 < least) least = at[-1] + 1;
            if (j > 0 && at[-nx] + 1 < least) least = at[-nx] + 1;
            *at = (uint8_t)least;
        }
    for (int j = ny - 1; j >= 0; j--)
        for (int i = nx - 1; i >= 0; i--) {
            uint8_t *at = &w->away[(size_t)j * (size_t)nx + (size_t)i];
            if (i + 1 < nx && at[1] + 1 < *at) *at = (uint8_t)(at[1] + 1);
            if (j + 1 < ny && at[nx] + 1 < *at) *at = (uint8_t)(at[nx] + 1);
        }
}

/* Copies the middle of a window into the strip. */
static void keep_window(Work *w, const SurfaceParts *parts, int task, int i0, int nx, int ny)
{
    const int    level_nx = w->level.nx, from_i = task * core_cells;
    const int    to_i = from_i + core_cells < level_nx ? from_i + core_cells : level_nx;
    const double s = w->level.spacing_m;
    (void)ny;
    for (int j = w->row0; j < w->row0 + w->rows; j++)
        for (int i = from_i; i < to_i; i++) {
            const size_t n = (size_t)(j - w->r0) * (size_t)nx + (size_t)(i - i0);
            const size_t at = (size_t)(j - w->row0) * (size_t)level_nx + (size_t)i;
            const size_t src = (size_t)(j - w->r0) * (size_t)level_nx + (size_t)i;
            const double share =
                (double)w->away[src] / fade_posts; /* share of the ground that the files lead over to */
            uint8_t kind = parts->kind[n];
            double  h_m = (double)parts->bare_m[n];
            if (!isfinite(h_m)) h_m = (double)w->plain_m[src];
            const double canopy_m = (double)w->surface_m[src] - h_m;
            /* what is ground has the height between its cells, but beside a wall or a crown */
            if (!w->bare_m && parts->bare_m[n] == w->surface_m[src] && fabs((double)w->plain_m[src] - h_m) < 0.5 * s)
                h_m = (double)w->plain_m[src];
            h_m += share * share * (3 - 2 * share) * ((double)w->plain_m[src] - h_m);
            const bool roof = kind == CELL_BUILDING && isfinite(parts->roof_m[n]);
            if (roof && !w->culture) h_m = (double)parts->roof_m[n];
            if (kind == CELL_BUILDING && !roof) kind = CELL_BARE;
            w->out->h_m[at] = (float)h_m;
            w->out->kind[at] = kind;
            w->out->canopy_m[at] = kind == CELL_TREE && canopy_m > 0 ? (float)canopy_m : 0;
        }
    for (int k = 0; k < parts->crown_count; k++) { /* keeps crowns whose top is in the middle of the window */
        Crown     c = parts->crown[k];
        const int i = i0 + (int)floor((double)c.x_m / s), j = w->r0 + (int)floor((double)c.y_m / s);
        if (i < from_i || i >= to_i || j < w->row0 || j >= w->row0 + w->rows) continue;
        c.x_m = (float)((w->level.i0 + i0 - 0.5) * s + (double)c.x_m);
        c.y_m = (float)((w->level.j0 + w->r0 - 0.5) * s + (double)c.y_m);
        w->crown[task][w->crowns[task]++] = c;
    }
}

/* Buildings whose middle is in the core of a window. */
static Status add_buildings(Work *w, const SurfaceParts *parts, const SurfaceModel *model, int task)
{
    const int          i0 = task * core_cells - (int)model->column, j0 = w->row0 - (int)model->row;
    const int          i1 = i0 + core_cells;
    const double       s = w->level.spacing_m;
    const SurfaceCore  core = {i0, j0, i1 < model->nx ? i1 : model->nx, j0 + w->rows};
    const SurfacePlace place = {{(w->level.i0 - 0.5) * s, (w->level.j0 - 0.5) * s}, {s, 0}, {0, s}};
    return culture_add_surface(&w->culture[task], parts, model, &place, &core);
}

static void take_window(void *user, int worker, int task)
{
    Work        *w = user;
    const int    level_nx = w->level.nx, ny = w->r1 - w->r0;
    const int    i0 = task * core_cells > w->margin ? task * core_cells - w->margin : 0;
    const int    end = (task + 1) * core_cells + w->margin, i1 = end < level_nx ? end : level_nx, nx = i1 - i0;
    const size_t cells = (size_t)nx * (size_t)ny;
    float       *surface_m = malloc(cells * sizeof *surface_m);
    float       *bare_in_m = w->bare_m ? malloc(cells * sizeof *bare_in_m) : NULL;
    uint8_t     *rgb = w->rgb ? malloc(3 * cells) : NULL;
    SurfaceParts parts = {
        .bare_m = malloc(cells * sizeof(float)), .roof_m = malloc(cells * sizeof(float)), .kind = malloc(cells)};
    (void)worker;
    w->status[task] = STATUS_NO_MEMORY;
    if (!surface_m || !parts.bare_m || !parts.roof_m || !parts.kind || (w->bare_m && !bare_in_m) || (w->rgb && !rgb))
        goto done;
    for (int j = 0; j < ny; j++) {
        const size_t from = (size_t)j * (size_t)level_nx + (size_t)i0, to = (size_t)j * (size_t)nx;
        memcpy(surface_m + to, w->surface_m + from, (size_t)nx * sizeof *surface_m);
        if (bare_in_m) memcpy(bare_in_m + to, w->bare_m + from, (size_t)nx * sizeof *bare_in_m);
        if (rgb) memcpy(rgb + 3 * to, w->rgb + 3 * from, 3 * (size_t)nx);
    }
    const SurfaceModel model = {.nx = nx,
                                .ny = ny,
                                .cell_m = w->level.spacing_m,
                                .surface_m = surface_m,
                                .bare_m = bare_in_m,
                                .rgb = rgb,
                                .column = i0,
                                .row = w->r0};
    w->status[task] = take_apart_surface(&parts, &model);
    if (w->status[task] != STATUS_OK) goto done;
    w->crown[task] = malloc(((size_t)parts.crown_count + 1) * sizeof **w->crown);
    if (w->crown[task]) keep_window(w, &parts, task, i0, nx, ny);
    else w->status[task] = STATUS_NO_MEMORY;
    if (w->culture && w->status[task] == STATUS_OK) w->status[task] = add_buildings(w, &parts, &model, task);
done:
    free(surface_m);
    free(bare_in_m);
    free(rgb);
    free(parts.bare_m);
    free(parts.roof_m);
    free(parts.kind);
    free(parts.crown);
}

static double around(void *user, double x_m, double y_m) { return elevation_stream_around(user, x_m, y_m); }

static Status read_colours(Work *w, const SurfaceSources *from)
{
    const size_t     posts = (size_t)(w->r1 - w->r0) * (size_t)w->level.nx;
    const GroundView view = {from->frame, around, from->surface, from->pool, "terrain import: --photo"};
    const double     s = w->level.spacing_m;
    const CellRows   cells = {w->level.nx, w->r1 - w->r0, (w->level.i0 - 0.5) * s, (w->level.j0 + w->r0 - 0.5) * s, s};
    uint8_t         *rgba = calloc(posts, 4);
    w->rgb = malloc(3 * posts);
    Status status = rgba && w->rgb ? ground_rows_colours(rgba, from->photo, &cells, &view) : STATUS_NO_MEMORY;
    for (size_t n = 0; status == STATUS_OK && n < posts; n++) memcpy(w->rgb + 3 * n, rgba + 4 * n, 3);
    free(rgba);
    return status;
}

/* Reads the heights of both models; NaN where a file has none. */
static Status read_models(Work *w, const SurfaceSources *from)
{
    static const float smooth_m = 0.1F;
    const int          rows = w->r1 - w->r0;
    const size_t       posts = (size_t)rows * (size_t)w->level.nx;
    w->surface_m = malloc(posts * sizeof *w->surface_m);
    w->plain_m = malloc(posts * sizeof *w->plain_m);
    w->of_file = malloc(posts);
    w->away = malloc(posts);
    if (from->bare) w->bare_m = malloc(posts * sizeof *w->bare_m);
    if (!w->surface_m || !w->plain_m || !w->of_file || !w->away || (from->bare && !w->bare_m)) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    if (from->bare) {
        status = elevation_stream_heights(from->bare, w->r0, rows, w->bare_m, w->of_file, false);
        memcpy(w->plain_m, w->bare_m, posts * sizeof *w->plain_m);
        for (size_t n = 0; n < posts; n++)
            if (w->of_file[n] != 1 && w->of_file[n] != 3) w->bare_m[n] = NAN;
    }
    float *between_m = from->bare ? malloc(posts * sizeof *between_m) : w->plain_m;
    if (!between_m) return STATUS_NO_MEMORY;
    if (status == STATUS_OK)
        status = elevation_stream_cells(from->surface, w->r0, rows, between_m, w->surface_m, w->of_file);
    /* Between cells the surface is smooth on slopes of ground and roofs. Beside a wall, and where one return of many
     * came from the ground below a crown, it is neither: there the nearest cell says what it is. */
    for (size_t n = 0; n < posts && status == STATUS_OK; n++)
        if (fabsf(between_m[n] - w->surface_m[n]) < smooth_m) w->surface_m[n] = between_m[n];
    if (from->bare) free(between_m);
    if (status != STATUS_OK) return status;
    const size_t first = (size_t)(w->row0 - w->r0) * (size_t)w->level.nx;
    const size_t end = first + (size_t)w->rows * (size_t)w->level.nx;
    for (size_t n = 0; n < posts; n++) {
        if (w->of_file[n] != 1 && w->of_file[n] != 3) w->surface_m[n] = NAN;
        if (n < first || n >= end) continue;
        w->out->voids += w->of_file[n] == 2;
        w->out->voids_coarser += w->of_file[n] == 3;
    }
    measure_away(w);
    return STATUS_OK;
}

Status surface_strip_make(SurfaceStrip *out, const SurfaceSources *from, int row0, int rows)
{
    SurfaceStrip strip = {0};
    Work         w = {.row0 = row0, .rows = rows, .out = &strip};
    elevation_stream_level(&w.level, from->surface, 0);
    w.margin = (int)ceil(take_apart_reach_m / w.level.spacing_m) + 1;
    if (from->buildings) w.margin += (int)ceil(surface_building_most_m / w.level.spacing_m) + 2;
    w.r0 = row0 > w.margin ? row0 - w.margin : 0;
    w.r1 = row0 + rows + w.margin < w.level.ny ? row0 + rows + w.margin : w.level.ny;
    w.windows = (w.level.nx + core_cells - 1) / core_cells;
    const size_t posts = (size_t)rows * (size_t)w.level.nx;
    strip.h_m = malloc(posts * sizeof *strip.h_m);
    strip.kind = malloc(posts);
    strip.canopy_m = malloc(posts * sizeof *strip.canopy_m);
    w.crown = calloc((size_t)w.windows, sizeof *w.crown);
    w.crowns = calloc((size_t)w.windows, sizeof *w.crowns);
    w.status = calloc((size_t)w.windows, sizeof *w.status);
    if (from->buildings) w.culture = calloc((size_t)w.windows, sizeof *w.culture);
    const bool whole =
        strip.h_m && strip.kind && strip.canopy_m && w.crown && w.crowns && w.status && (w.culture || !from->buildings);
    Status status = whole ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = read_models(&w, from);
    if (status == STATUS_OK && from->photo) status = read_colours(&w, from);
    if (status == STATUS_OK && !pool_run_unless_stopped(from->pool, w.windows, take_window, &w)) status = STATUS_IO;
    for (int k = 0; status == STATUS_OK && k < w.windows; k++) {
        status = w.status[k];
        strip.crowns += w.crowns[k];
    }
    if (status == STATUS_OK && strip.crowns > 0) {
        strip.crown = malloc((size_t)strip.crowns * sizeof *strip.crown);
        if (!strip.crown) status = STATUS_NO_MEMORY;
        for (int k = 0, at = 0; strip.crown && k < w.windows; at += w.crowns[k++])
            if (w.crowns[k] > 0) memcpy(strip.crown + at, w.crown[k], (size_t)w.crowns[k] * sizeof *strip.crown);
    }
    for (int k = 0; w.culture && k < w.windows; k++) {
        if (status == STATUS_OK) status = import_buildings_add(&strip.culture, &w.culture[k]);
        culture_free(&w.culture[k]);
    }
    for (int k = 0; w.crown && k < w.windows; k++) free(w.crown[k]);
    free(w.culture);
    free(w.crown);
    free(w.crowns);
    free(w.status);
    free(w.surface_m);
    free(w.bare_m);
    free(w.plain_m);
    free(w.of_file);
    free(w.away);
    free(w.rgb);
    if (status == STATUS_OK) *out = strip;
    else surface_strip_free(&strip);
    return status;
}

/* ---- buildings counted: connected parts of cells, joined row by row ------------------------------ */

static int root_of(int *parent, int label)
{
    while (parent[label] != label) label = parent[label] = parent[parent[label]];
    return label;
}

Status terrain_buildings_count(TerrainBuildings *b, int nx, const uint8_t *kind)
{
    const size_t most = 2 * (size_t)nx + 2;
    if (!b->label) {
        b->label = calloc((size_t)nx, sizeof *b->label);
        b->parent = malloc(most * sizeof *b->parent);
        b->compact = malloc(most * sizeof *b->compact);
        if (!b->label || !b->parent || !b->compact) return STATUS_NO_MEMORY;
    }
    int labels = b->labels;
    for (int k = 0; k <= labels; k++) b->parent[k] = k;
    for (int i = 0; i < nx; i++) {
        const int west = i > 0 ? b->label[i - 1] : 0, south = b->label[i];
        if (kind[i] != CELL_BUILDING) b->label[i] = 0;
        else if (west && south) {
            const int a = root_of(b->parent, west), c = root_of(b->parent, south);
            b->count -= a != c;
            b->parent[a] = c;
        } else if (west || south) b->label[i] = west + south;
        else {
            b->label[i] = ++labels;
            b->parent[labels] = labels;
            b->count++;
        }
    }
    memset(b->compact, 0, ((size_t)labels + 1) * sizeof *b->compact);
    b->labels = 0;
    for (int i = 0; i < nx; i++) {
        if (!b->label[i]) continue;
        int *to = &b->compact[root_of(b->parent, b->label[i])];
        if (*to == 0) *to = ++b->labels;
        b->label[i] = *to;
    }
    return STATUS_OK;
}

void terrain_buildings_free(TerrainBuildings *b)
{
    free(b->label);
    free(b->parent);
    free(b->compact);
    *b = (TerrainBuildings){0};
}
