/* render/scattering/field/tubes_split.c: a tile of the grid of ray tubes, its cells divided where neighbours met
 * different things.
 *
 * Tubes are compared with those beside them, mirror by mirror: where the path of one does not continue the other's
 * within split_rad, or one is seen and the other not, an edge or a bend is between the two. From that mirror on both
 * cells count by four smaller tubes each, which are compared in turn. */
#include "render/scattering/field/tubes_private.h"

#include <limits.h>
#include <stdlib.h>

/* How often a cell may be divided for what parts at a mirror. Later ones are divided less: their tubes part at almost
 * every edge on the way. */
static int deepest(const TubeWork *work, int mirror)
{
    const int less = mirror <= 3 ? 0 : 1;
    return work->levels > less ? work->levels - less : 0;
}

int tube_levels(double spacing_m, double radius_m, const TubeConfig *config)
{
    int levels = 0;
    while (levels < config->splits && spacing_m > radius_m / config->cuts_per_radius) levels++, spacing_m *= 0.5;
    return levels;
}

static int places(int level) { return (tile_side << level) + 2; }

size_t tube_place_count(int levels) { return (size_t)places(levels) * (size_t)places(levels); }

static bool room(TubeWorker *worker, int list, int count)
{
    if (count <= worker->cell_capacity[list]) return true;
    const int want = count > 2 * worker->cell_capacity[list] ? count : 2 * worker->cell_capacity[list];
    TubeCell *larger = realloc(worker->cell[list], (size_t)want * sizeof *larger);
    if (!larger) return false;
    worker->cell[list] = larger;
    worker->cell_capacity[list] = want;
    return true;
}

/* The cells of a tile and one row about it, which are compared with and do not count. */
static bool first_cells(TubeWorker *worker, const TubeGrid *grid, long long number)
{
    const int column = (int)(number % grid->tiles[0]) * tile_side, row = (int)(number / grid->tiles[0]) * tile_side;
    worker->cells[0] = 0;
    if (!room(worker, 0, tile_rays)) return false;
    for (int y = -1; y <= tile_side; y++)
        for (int x = -1; x <= tile_side; x++) {
            if (column + x < 0 || column + x >= grid->count[0] || row + y < 0 || row + y >= grid->count[1]) continue;
            TubeCell *cell = &worker->cell[0][worker->cells[0]++];
            cell->x = x, cell->y = y, cell->from = 1, cell->to = INT_MAX, cell->marks = 0;
        }
    return true;
}

static bool is_about(const TubeCell *cell, int level)
{
    return cell->x < 0 || cell->y < 0 || cell->x >= tile_side << level || cell->y >= tile_side << level;
}

/* Whether a mark's path, continued by x and y cells, is the other's. */
static bool continues(const TubeMark *a, const TubeMark *b, int x, int y, double k, double most_rad)
{
    const double step_m = b->path_m - a->path_m;
    return k * fabs(step_m + 2 * (x * (double)a->slope_m[0] + y * (double)a->slope_m[1])) <= most_rad &&
           k * fabs(step_m + 2 * (x * (double)b->slope_m[0] + y * (double)b->slope_m[1])) <= most_rad;
}

/* Finds the mirror from which the paths of two neighbours differ; 0: there is none. Faces that are summed whole do not
 * count: only what comes after them does. */
static int parting(const TubeWork *work, const TubeCell *a, const TubeCell *b)
{
    const int marks = a->marks < b->marks ? a->marks : b->marks, from = a->from > b->from ? a->from : b->from;
    for (int m = from; m <= marks; m++) {
        const TubeMark *p = &a->mark[m - 1], *q = &b->mark[m - 1];
        const bool      whole = p->whole && q->whole; /* neither counts, though what they reflect may differ */
        if (p->seen != q->seen && !whole) return m;
        if (p->seen && q->seen && work->target->material[p->part] != work->target->material[q->part])
            return whole ? m + 1 : m;
        if (p->seen && !whole && !continues(p, q, b->x - a->x, b->y - a->y, work->k, work->config.split_rad)) return m;
    }
    if (a->marks == b->marks) return 0;
    const TubeCell *longer = a->marks > b->marks ? a : b;
    int             next = marks + 1;
    if (next == 1 && longer->mark[0].whole && ++next > longer->marks) return 0;
    return next > from ? next : from;
}

static void compare(const TubeWork *work, TubeCell *a, TubeCell *b, int level)
{
    const int mirror = parting(work, a, b);
    if (mirror == 0 || level >= deepest(work, mirror)) return;
    const int to = work->config.last_only ? 1 : mirror; /* a tube's last mirror is another one where it parts */
    if (to < a->to) a->to = to;
    if (to < b->to) b->to = to;
}

static void compare_all(const TubeWork *work, TubeWorker *worker, int level)
{
    const int side = places(level), list = level & 1;
    TubeCell *cell = worker->cell[list];
    memset(worker->at, 0xff, (size_t)side * (size_t)side * sizeof *worker->at);
    for (int k = 0; k < worker->cells[list]; k++) worker->at[(cell[k].y + 1) * side + cell[k].x + 1] = k;
    for (int k = 0; k < worker->cells[list]; k++) {
        const int32_t *here = &worker->at[(cell[k].y + 1) * side + cell[k].x + 1];
        const int32_t *next[4] = {here + 1, here + side - 1, here + side, here + side + 1};
        for (int n = 0; n < 4; n++) {
            const int x = cell[k].x + (n == 0 ? 1 : n - 2), y = cell[k].y + (n > 0);
            if (x < -1 || x + 2 > side || y + 2 > side || *next[n] < 0) continue;
            compare(work, &cell[k], &cell[*next[n]], level);
        }
    }
}

/* Drops what the level's children, or its parents, stand for. */
static void drop_others(TubeWorker *worker, size_t first, int level)
{
    const TubeCell *cell = worker->cell[level & 1];
    size_t          kept = first;
    for (size_t i = first; i < worker->count; i++) {
        const TubeHit  *hit = &worker->hit[i];
        const TubeCell *of = &cell[hit->cell];
        if (hit->bounce < of->from || hit->bounce >= of->to || is_about(of, level)) continue;
        if (kept != i) worker->hit[kept] = *hit;
        kept++;
    }
    worker->count = kept;
}

static bool divide(TubeWorker *worker, int level)
{
    const int list = level & 1, next = !list;
    int       count = 0;
    for (int k = 0; k < worker->cells[list]; k++) count += 4 * (worker->cell[list][k].to < INT_MAX);
    worker->cells[next] = 0;
    if (!room(worker, next, count)) return false;
    for (int k = 0; k < worker->cells[list]; k++) {
        const TubeCell *parent = &worker->cell[list][k];
        if (parent->to == INT_MAX) continue;
        for (int q = 0; q < 4; q++) {
            const int x = 2 * parent->x + q % 2, y = 2 * parent->y + q / 2, side = tile_side << (level + 1);
            if (x < -1 || y < -1 || x > side || y > side) continue; /* not beside the tile */
            TubeCell *child = &worker->cell[next][worker->cells[next]++];
            child->x = x, child->y = y;
            child->from = parent->to, child->to = INT_MAX, child->marks = 0;
        }
    }
    return true;
}

void tube_tile(TubeWork *work, int worker_at, long long number, TubePiece *piece)
{
    TubeWorker *worker = &work->worker[worker_at];
    *piece = (TubePiece){.worker = worker_at, .first = worker->count};
    if (!first_cells(worker, &work->grid, number)) piece->failed = true;
    for (int level = 0; worker->cells[level & 1] > 0 && !piece->failed; level++) {
        const int    list = level & 1, count = worker->cells[list];
        const size_t first = worker->count;
        for (int k = 0; k < count && !piece->failed; k += tile_rays)
            piece->failed = !tube_follow(work, worker_at, number, level, worker->cell[list] + k,
                                         count - k < tile_rays ? count - k : tile_rays, k);
        piece->rays += count;
        if (level < work->levels) compare_all(work, worker, level);
        drop_others(worker, first, level);
        if (level == work->levels) break;
        if (!divide(worker, level)) piece->failed = true;
    }
    piece->count = worker->count - piece->first;
}
