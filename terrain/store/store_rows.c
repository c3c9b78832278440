/* terrain/store/store_rows.c: rows, south first, into a store: of posts to tiles (whole steps, edges on the level
 * around, a base and a shift for each tile), of a photograph to blocks and mips. */
#include "terrain/store/store_writer_private.h"

#include <stdlib.h>
#include <sys/mman.h>

enum { cells = elevation_tile_cells };

/* Runs tasks, unless a stop is requested. */
static void run(Pool *pool, int count, PoolTask *task, void *user)
{
    (void)pool_run_unless_stopped(count > 1 ? pool : NULL, count, task,
                                  user); /* tasks may be left out: a file that is not whole is never sealed */
}

/* ---- posts ------------------------------------------------------------------------------------------ */

Status store_posts_begin(StoreWriter *w, int index, int seam_shift)
{
    PostRows             *rows = &w->posts[index];
    const ElevationLevel *level = &w->elevation.level[index];
    const int bands = w->pool ? pool_threads(w->pool) : 1, most = level->tiles_y < bands ? level->tiles_y : bands;
    /* the last row of tiles waits for the shifts of the next row, since their common posts have the coarser unit */
    rows->capacity = (most + 1) * cells + 1;
    rows->seam_shift = seam_shift;
    rows->row = malloc((size_t)rows->capacity * (size_t)level->nx * sizeof *rows->row);
    return rows->row ? STATUS_OK : STATUS_NO_MEMORY;
}

void store_posts_end(StoreWriter *w)
{
    for (int n = 0; n < elevation_max_levels; n++) free(w->posts[n].row);
}

/* ---- whole steps ----------------------------------------------------------------------------------- */

/* The outline of the inner level, in posts of this one: i0 .. i1, j0 .. j1. */
typedef struct Hole {
    int     i0, i1, j0, j1;
    int32_t unit; /* posts on the outline are multiples of this many steps; 0: there is no inner level */
} Hole;

static Hole hole_of(const StoreWriter *w, int index)
{
    if (index == 0) return (Hole){0};
    const ElevationLevel *in = &w->elevation.level[index - 1], *out = &w->elevation.level[index];
    const double          ratio = out->spacing_m / in->spacing_m;
    const double          unit = ldexp(in->step_m, w->posts[index - 1].seam_shift) * rint(ratio) / out->step_m;
    Hole                  h = {.i0 = (int)lrint((in->x0_m - out->x0_m) / out->spacing_m),
                               .j0 = (int)lrint((in->y0_m - out->y0_m) / out->spacing_m),
                               .unit = unit > 1 ? (int32_t)unit : 1};
    h.i1 = h.i0 + (int)lrint((in->nx - 1) / ratio);
    h.j1 = h.j0 + (int)lrint((in->ny - 1) / ratio);
    return h;
}

static int32_t to_unit(int32_t post, int32_t unit) { return (int32_t)floor((double)post / unit + 0.5) * unit; }

typedef struct RowsJob {
    StoreWriter *writer;
    int          index; /* number of the level */
    int          first; /* number of the row that z_m[0] is */
    const float *z_m;
    Hole         hole;
    bool         bad; /* any task sets it: a post is not a number, or beyond what a level holds */
} RowsJob;

/* The post's height on the straight edge between two posts of the level around. */
static int32_t edge_post(const RowsJob *job, int i, int j)
{
    const ElevationLevel *in = &job->writer->elevation.level[job->index];
    const ElevationLevel *out = &job->writer->elevation.level[job->index + 1];
    const int             ratio = (int)lrint(out->spacing_m / in->spacing_m);
    const int             oi = (int)lrint((in->x0_m - out->x0_m) / out->spacing_m);
    const int             oj = (int)lrint((in->y0_m - out->y0_m) / out->spacing_m);
    const bool            along_x = i % ratio != 0;
    const int             part = along_x ? i % ratio : j % ratio, a = oi + i / ratio, b = oj + j / ratio;
    const double          za = elevation_post_m(out, a, b);
    const double          zb = part ? elevation_post_m(out, a + along_x, b + !along_x) : za;
    return (int32_t)lrint((za + (zb - za) * part / ratio - in->z0_m) / in->step_m);
}

static void quantise_row(void *user, int worker, int task)
{
    (void)worker;
    RowsJob              *job = user;
    const ElevationLevel *level = &job->writer->elevation.level[job->index];
    PostRows             *rows = &job->writer->posts[job->index];
    const int             j = job->first + task, nx = level->nx;
    const float          *z_m = job->z_m + (size_t)task * (size_t)nx;
    int32_t              *to = rows->row + (size_t)(j - rows->first) * (size_t)nx;
    const double          inv_step = 1 / level->step_m;
    bool                  bad = false;
    for (int i = 0; i < nx; i++) {
        const double post = rint(((double)z_m[i] - level->z0_m) * inv_step);
        const bool   fits = post >= elevation_lowest_post && post <= elevation_highest_post; /* false for NaN too */
        bad |= !fits;
        to[i] = fits ? (int32_t)post : 0;
    }
    if (bad) {
        job->bad = true; /* tasks may set it at once, all to the same value */
        return;
    }
    const Hole h = job->hole;
    if (h.unit && j >= h.j0 && j <= h.j1) {
        const int step = j == h.j0 || j == h.j1 ? 1 : h.i1 - h.i0;
        for (int i = h.i0; i <= h.i1; i += step) to[i] = to_unit(to[i], h.unit);
    }
    if (job->index + 1 == job->writer->elevation.level_count) return;
    const int step = j == 0 || j == level->ny - 1 ? 1 : nx - 1;
    for (int i = 0; i < nx; i += step) to[i] = edge_post(job, i, j);
}

/* ---- tiles ------------------------------------------------------------------------------------------ */

static void shape_tiles(void *user, int worker, int task)
{
    (void)worker;
    RowsJob        *job = user;
    ElevationLevel *level = &job->writer->elevation.level[job->index];
    const PostRows *rows = &job->writer->posts[job->index];
    const int       tile_j = rows->shaped + task;
    elevation_choose_tiles(level, tile_j, rows->row + (size_t)(tile_j * cells - rows->first) * (size_t)level->nx);
}

static void fill_tiles(void *user, int worker, int task)
{
    (void)worker;
    RowsJob        *job = user;
    ElevationLevel *level = &job->writer->elevation.level[job->index];
    const PostRows *rows = &job->writer->posts[job->index];
    const int       tile_j = rows->first / cells + task;
    elevation_fill_tiles(level, tile_j, rows->row + (size_t)task * cells * (size_t)level->nx);
    /* the system writes these pages back when it likes; this process need not keep them */
    const size_t row = (size_t)level->tiles_x * elevation_tile_posts * sizeof *level->stored;
    const size_t at = (size_t)((uint8_t *)level->stored - job->writer->map) + (size_t)tile_j * row;
    const size_t from = (at + store_page - 1) / store_page * store_page;
    if (row > 2 * store_page)
        madvise(job->writer->map + from, (row - store_page) / store_page * store_page, MADV_DONTNEED);
}

/* Chooses the shifts of whole rows of tiles, fills those whose neighbours have shifts, and keeps the remaining rows. */
static void take_rows(RowsJob *job)
{
    ElevationLevel *level = &job->writer->elevation.level[job->index];
    PostRows       *rows = &job->writer->posts[job->index];
    const int       end = rows->first + rows->count; /* rows before `end` have been given */
    const bool      last = end == level->ny;
    const int       whole = last ? level->tiles_y : (end - 1) / cells;
    if (whole > rows->shaped) run(job->writer->pool, whole - rows->shaped, shape_tiles, job);
    rows->shaped = whole > rows->shaped ? whole : rows->shaped;
    const int fill = (last ? whole : whole - 1) - rows->first / cells;
    if (fill <= 0) return;
    run(job->writer->pool, fill, fill_tiles, job);
    const int gone = last ? rows->count : fill * cells;
    memmove(rows->row, rows->row + (size_t)gone * (size_t)level->nx,
            (size_t)(rows->count - gone) * (size_t)level->nx * sizeof *rows->row);
    rows->first += gone;
    rows->count -= gone;
}

static void pyramid_tiles(void *user, int worker, int task)
{
    (void)worker;
    elevation_build_pyramid_tiles(user, task);
}

/* Finishes a complete level: builds its pyramid, and sets what the header says of it. */
static void finish_level(StoreWriter *w, int index)
{
    ElevationLevel   *level = &w->elevation.level[index];
    StoreHeaderLevel *l = &w->header->level[index];
    int32_t           shift = 0;
    level->plain = true;
    for (size_t t = 0; t < (size_t)level->tiles_x * (size_t)level->tiles_y; t++) {
        shift = level->tile[t].shift > shift ? level->tile[t].shift : shift;
        level->plain &= level->tile[t].shift == 0 && level->tile[t].base == 0;
    }
    elevation_begin_pyramid(level);
    run(w->pool, level->tiles_y, pyramid_tiles, level);
    elevation_finish_pyramid(level);
    l->worst_m =
        0.5 * level->step_m * (shift ? 1 + (1 << shift) : 1); /* a post is rounded to steps, then to the tile's unit */
    l->pyramid_base = level->pyramid_base;
    l->pyramid_shift = level->pyramid_shift;
    l->rise_shift = level->rise_shift;
    l->plain = level->plain;
    free(w->posts[index].row);
    w->posts[index].row = NULL;
    const StoreSection *s = w->header->section;
    const int           part[] = {STORE_TILES + index, STORE_POSTS + index, STORE_PYRAMID + index};
    for (int k = 0; k < 3; k++) madvise(w->map + s[part[k]].offset, s[part[k]].octets, MADV_DONTNEED);
}

Status store_write_posts(StoreWriter *w, int index, int count, const float *z_m)
{
    if (index < 0 || index >= w->elevation.level_count || count < 0) return STATUS_BAD_VALUE;
    const ElevationLevel *level = &w->elevation.level[index];
    PostRows             *rows = &w->posts[index];
    const bool            later = index + 1 < w->elevation.level_count;
    if (count > level->ny - rows->done || (later && w->posts[index + 1].done < w->elevation.level[index + 1].ny)) {
        log_error("store: %s: rows of level %d come out of order or are too many", w->path, index);
        return STATUS_BAD_VALUE;
    }
    RowsJob job = {.writer = w, .index = index, .hole = hole_of(w, index)};
    while (count > 0) {
        const int room = rows->capacity - rows->count, take = count < room ? count : room;
        job.first = rows->done;
        job.z_m = z_m;
        run(w->pool, take, quantise_row, &job);
        if (job.bad) {
            log_error("store: %s: level %d, rows %d to %d: a height is not a number, or is beyond %.0f km", w->path,
                      index, job.first, job.first + take - 1, 1e-3 * level->step_m * elevation_highest_post);
            return STATUS_BAD_VALUE;
        }
        rows->done += take;
        rows->count += take;
        z_m += (size_t)take * (size_t)level->nx;
        count -= take;
        if (rows->count == rows->capacity || rows->done == level->ny) take_rows(&job);
    }
    if (rows->done == level->ny && rows->row) finish_level(w, index);
    return STATUS_OK;
}

/* ---- the photograph --------------------------------------------------------------------------------- */

Status store_albedo_begin(StoreWriter *w)
{
    const Photo *p = &w->photo;
    for (int k = 0; k < p->mips; k++) {
        w->mip[k].row = malloc(16 * (size_t)p->nx[k]);
        if (!w->mip[k].row) return STATUS_NO_MEMORY;
    }
    w->halved = p->mips ? malloc(4 * (size_t)p->nx[0]) : NULL;
    return p->mips && !w->halved ? STATUS_NO_MEMORY : STATUS_OK;
}

void store_albedo_end(StoreWriter *w)
{
    for (int k = 0; k < ground_image_mips; k++) free(w->mip[k].row);
    free(w->halved);
}

enum { piece_blocks = 128 };

typedef struct BlocksJob {
    const uint8_t *rgba;
    PhotoBlock    *to;
    int            nx, rows;
} BlocksJob;

/* Encodes a piece of a row of blocks. It is copied first, as photo_block_row takes whole rows. */
static void encode_piece(void *user, int worker, int task)
{
    (void)worker;
    const BlocksJob *job = user;
    uint8_t          some[4][4 * 4 * piece_blocks];
    const int        i0 = task * 4 * piece_blocks, left = job->nx - i0;
    const int        nx = left < 4 * piece_blocks ? left : 4 * piece_blocks;
    for (int j = 0; j < job->rows; j++)
        memcpy((uint8_t *)some + (size_t)j * 4 * (size_t)nx, job->rgba + 4 * ((size_t)j * (size_t)job->nx + (size_t)i0),
               4 * (size_t)nx);
    photo_block_row(job->to + i0 / 4, (const uint8_t *)some, nx, job->rows);
}

/* Adds a row of mip k, and a row of each further mip that this completes. Rows of mip k are in `rgba`; the row of the
 * next mip is in w->halved, which can be used again once it is copied. */
static void add_row(StoreWriter *w, int k, const uint8_t *rgba)
{
    const Photo *p = &w->photo;
    for (; k < p->mips; k++) {
        MipRows     *m = &w->mip[k];
        const int    nx = p->nx[k], in = m->done % 4;
        const size_t row = 4 * (size_t)nx;
        memcpy(m->row + (size_t)in * row, rgba, row);
        m->done++;
        const bool last = m->done == p->ny[k];
        if (in == 3 || last) {
            BlocksJob job = {m->row, p->block[k] + (size_t)((m->done - 1) / 4) * photo_blocks_across(nx), nx, in + 1};
            run(w->pool, (nx + 4 * piece_blocks - 1) / (4 * piece_blocks), encode_piece, &job);
        }
        if (in % 2 == 0 && !last) return;
        photo_halve_row(w->halved, m->row + (size_t)(in - in % 2) * row, in % 2 ? m->row + (size_t)in * row : NULL, nx);
        rgba = w->halved;
    }
}

Status store_write_albedo(StoreWriter *w, int rows, const uint8_t *rgba)
{
    const Photo *p = &w->photo;
    if (rows < 0 || p->mips == 0 || rows > p->ny[0] - w->mip[0].done) {
        log_error("store: %s: too many rows of the photograph", w->path);
        return STATUS_BAD_VALUE;
    }
    for (int j = 0; j < rows; j++) add_row(w, 0, rgba + (size_t)j * 4 * (size_t)p->nx[0]);
    return STATUS_OK;
}
