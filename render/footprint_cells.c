/* render/footprint_cells.c: where a small target is sampled, and how finely.
 *
 * Coarse cells are sampled first, one ray each. One that sees the target where a neighbour beside it does not, or
 * the other way round, gives way to four: inside the outline one ray speaks for all four. Bands that the sun lights go
 * finer also where it is shadow here and sun there; the others keep the coarse cell there, so that no band's bits
 * depend on which others are asked for. The radar, whose glints no neighbour foretells, has all of the fine cells.
 *
 * Nothing here depends on which pixels the target lies over, nor on who traces what else. */
#include "render/footprint_private.h"

/* ---- cells ---------------------------------------------------------------------------------- */

/* A cell by one number: its level, and row * columns + column of that level. */
enum { level_bit = 24 };

static int level_of(int cell) { return cell >> level_bit; }
static int index_of(int cell) { return cell & ((1 << level_bit) - 1); }
static int columns_at(const Footprint *f, int level) { return f->columns >> (footprint_levels - 1 - level); }
static int rows_at(const Footprint *f, int level) { return f->rows >> (footprint_levels - 1 - level); }
static int column_of(const Footprint *f, int cell) { return index_of(cell) % columns_at(f, level_of(cell)); }
static int row_of(const Footprint *f, int cell) { return index_of(cell) / columns_at(f, level_of(cell)); }

static int cell_at(const Footprint *f, int level, int column, int row)
{
    return level << level_bit | (row * columns_at(f, level) + column);
}

typedef struct Span {
    double low, high; /* px */
} Span;

static Span span_of(double low, double high, int cell, int cells)
{
    const double length = high - low;
    return (Span){low + length * cell / cells, low + length * (cell + 1) / cells};
}

static Span across_of(const Footprint *f, int cell)
{
    return span_of(f->box[0], f->box[2], column_of(f, cell), columns_at(f, level_of(cell)));
}

static Span down_of(const Footprint *f, int cell)
{
    return span_of(f->box[1], f->box[3], row_of(f, cell), rows_at(f, level_of(cell)));
}

static double overlap(Span a, double low, double high)
{
    const double length = fmin(a.high, high) - fmax(a.low, low);
    return length > 0 ? length : 0;
}

uint64_t footprint_key(const Footprint *f, int cell)
{
    return (uint64_t)1 << 62 | (uint64_t)f->entity << 32 | (uint64_t)cell;
}

double footprint_area(const Footprint *f, int cell)
{
    return overlap(across_of(f, cell), f->x0, f->x1) * overlap(down_of(f, cell), f->y0, f->y1);
}

/* Where a cell is sampled: columns shifted among rows, and rows among columns, by the golden section, so that an edge
 * along either is met in many more steps than there are cells across, and one along a diagonal, too. Coarse ones are
 * shifted by half as much: they speak for light that changes across them, best in the middle, yet must meet whatever is
 * as wide as a fine cell. */
static void cell_sample(double at_px[2], const Footprint *f, int cell)
{
    static const double golden = 0.6180339887498949;
    const int    level = level_of(cell), column = column_of(f, cell), row = row_of(f, cell);
    const double u = 0.5 + row * golden, v = 0.5 + column * golden, part = level == 0 ? 0.5 : 1;
    const double right = 0.5 + part * (u - floor(u) - 0.5), down = 0.5 + part * (v - floor(v) - 0.5);
    at_px[0] = f->box[0] + (f->box[2] - f->box[0]) * (column + right) / columns_at(f, level);
    at_px[1] = f->box[1] + (f->box[3] - f->box[1]) * (row + down) / rows_at(f, level);
}

static void over_pixels(const Footprint *f, int cell, VisitPixel *visit, void *user)
{
    const Span across = across_of(f, cell), down = down_of(f, cell);
    for (int y = (int)fmax(f->y0, floor(down.low)); y < f->y1 && y < down.high; y++)
        for (int x = (int)fmax(f->x0, floor(across.low)); x < f->x1 && x < across.high; x++) {
            const double area = overlap(across, x, x + 1) * overlap(down, y, y + 1);
            if (area > 0) visit(user, f, (y - f->y0) * (f->x1 - f->x0) + x - f->x0, x, y, area);
        }
}

typedef struct Splat {
    double *sum, value;
} Splat;

static void splat_pixel(void *user, const Footprint *f, int pixel, int x, int y, double area)
{
    (void)f, (void)x, (void)y;
    const Splat *splat = user;
    splat->sum[pixel] += area * splat->value;
}

void footprint_splat(Scratch *s, int plane)
{
    Footprint *f = s->block.footprint;
    for (int i = 0; i < s->hits.count; i++) {
        Splat splat = {f->sum[plane], s->out[i]};
        over_pixels(f, s->block.cell[i], splat_pixel, &splat);
        f->square[plane] += footprint_area(f, s->block.cell[i]) * s->out[i] * s->out[i];
    }
}

static int at_most(int a, int b) { return a < b ? a : b; }

/* ---- rays ----------------------------------------------------------------------------------- */

typedef enum Kind { KIND_NONE, KIND_SEEN, KIND_HIDDEN } Kind;

/* What a cell's ray found: of the target if anything. */
typedef struct Seen {
    uint8_t  kind, shadow;
    uint16_t part;
    float    n_enu[3];
} Seen;

/* Cells that are traced together; their rays in Scratch.some, what they met in Scratch.all. */
typedef struct Batch {
    Footprint *f;
    Scratch   *s;
    const Job *job;
    int        listed;                 /* entities, in Scratch.list */
    int        count, columns;         /* columns 0: in no rows */
    int        cell[hits_capacity];
    Seen       seen[hits_capacity];
} Batch;

static void copy_ray(Rays *to, int k, const Rays *from, int i)
{
    for (int c = 0; c < 3; c++) {
        to->o_enu[c][k] = from->o_enu[c][i];
        to->d_enu[c][k] = from->d_enu[c][i];
    }
    to->far_m[k] = from->far_m[i];
}

/* Samples that met the target, those of `take` (NULL: all), close together as the block's hits; which: of the batch. */
static int gather_seen(int which[hits_capacity], const Batch *b, const bool *take)
{
    Scratch    *s = b->s;
    const Hits *from = &s->all;
    Hits       *to = &s->hits;
    int         kept = 0;
    for (int i = 0; i < b->count; i++) {
        if (b->seen[i].kind != KIND_SEEN || (take && !take[i])) continue;
        which[kept]         = i;
        s->block.cell[kept] = b->cell[i];
        s->shadow[kept]     = b->seen[i].shadow;
        to->range_m[kept]   = from->range_m[i];
        to->entity[kept]    = from->entity[i];
        to->part[kept]      = from->part[i];
        to->model[kept]     = from->model[i];
        to->surface[kept]   = from->surface[i];
        for (int k = 0; k < 3; k++) {
            to->p_enu[k][kept] = from->p_enu[k][i];
            to->n_geo[k][kept] = from->n_geo[k][i];
            to->n_enu[k][kept] = from->n_enu[k][i];
        }
        copy_ray(&s->rays, kept++, &s->some, i);
    }
    to->count   = s->rays.count = kept;
    to->columns = s->rays.columns = 0;
    return kept;
}

static void make_rays(Batch *b)
{
    const View *view = &b->job->request->view;
    Rays       *rays = &b->s->some;
    for (int i = 0; i < b->count; i++) {
        double at_px[2], d_enu[3];
        cell_sample(at_px, b->f, b->cell[i]);
        view_ray(d_enu, view, at_px[0], at_px[1]);
        for (int k = 0; k < 3; k++) {
            rays->o_enu[k][i] = view->p_enu[k];
            rays->d_enu[k][i] = d_enu[k];
        }
        rays->far_m[i] = INFINITY;
    }
    rays->count   = b->count;
    rays->columns = b->columns;
}

/* Cells whose ray meets something else first: the target behind it, with nothing else in the world? */
static void find_hidden(Batch *b)
{
    Scratch *s = b->s;
    int      which[hits_capacity], asked = 0;
    for (int i = 0; i < b->count; i++) {
        const double o_enu[3] = {s->some.o_enu[0][i], s->some.o_enu[1][i], s->some.o_enu[2][i]};
        const double d_enu[3] = {s->some.d_enu[0][i], s->some.d_enu[1][i], s->some.d_enu[2][i]};
        if (b->seen[i].kind == KIND_SEEN || !(s->all.range_m[i] < INFINITY) ||
            !visibility_may_lie_beyond(b->job->visibility, b->f->entity, o_enu, d_enu, s->all.range_m[i]))
            continue;
        which[asked] = i;
        copy_ray(&s->rays, asked++, &s->some, i);
    }
    if (asked == 0) return;
    s->rays.count   = asked;
    s->rays.columns = 0;
    visibility_entity_only(s->meets, b->job->visibility, &s->rays, b->f->entity);
    for (int k = 0; k < asked; k++)
        if (s->meets[k]) b->seen[which[k]].kind = KIND_HIDDEN;
}

static void trace(Batch *b)
{
    Scratch       *s = b->s;
    const Job     *job = b->job;
    const uint32_t id = (uint32_t)b->f->entity + 1;
    const double   t0 = wall_clock_s();
    int            which[hits_capacity];
    make_rays(b);
    visibility_first_hit(&s->all, job->visibility, &s->some, s->list, b->listed, job->request->hidden_entity,
                         &s->counters.visibility);
    s->counters.rays_primary += (uint64_t)b->count;
    s->counters.rays_small_targets += (uint64_t)b->count;
    for (int i = 0; i < b->count; i++) {
        b->seen[i] = (Seen){.kind = s->all.entity[i] == id ? KIND_SEEN : KIND_NONE, .part = s->all.part[i]};
        for (int k = 0; k < 3; k++) b->seen[i].n_enu[k] = s->all.n_enu[k][i];
    }
    find_hidden(b);
    s->visibility_s += wall_clock_s() - t0;
    s->block.bands = job->request->bands;
    const int kept = gather_seen(which, b, NULL);
    if (kept == 0) return;
    trace_shadows(s, job);
    for (int k = 0; k < kept; k++) b->seen[which[k]].shadow = s->shadow[k];
}

/* ---- what they give ------------------------------------------------------------------------- */

typedef struct TruthSample {
    const Scratch *s;
    int            sample;
    double         at_px[2];
} TruthSample;

static void offer_truth(void *user, const Footprint *f, int pixel, int x, int y, double area)
{
    (void)area;
    const TruthSample *t = user;
    const double       dx = t->at_px[0] - x - 0.5, dy = t->at_px[1] - y - 0.5, square_px = dx * dx + dy * dy;
    FootprintTruth    *to = &f->truth[pixel];
    const Scratch     *s = t->s;
    if (!(square_px < to->square_px)) return;
    *to = (FootprintTruth){.square_px = square_px, .range_m = (float)s->hits.range_m[t->sample],
                           .temp_k = s->temp_k[t->sample], .part = s->hits.part[t->sample],
                           .material = s->material[t->sample]};
    for (int k = 0; k < 3; k++) to->normal[k] = s->hits.n_enu[k][t->sample];
}

static void add_area(void *user, const Footprint *f, int pixel, int x, int y, double area)
{
    (void)user, (void)x, (void)y;
    f->area[pixel] += area;
}

/* What hides the target where its own samples did not meet it first. */
static void count_hidden(const Batch *b, const bool *take)
{
    Footprint     *f = b->f;
    const Hits    *all = &b->s->all;
    for (int i = 0; i < b->count; i++) {
        if (!take[i] || b->seen[i].kind == KIND_NONE) continue;
        const double area = footprint_area(f, b->cell[i]);
        f->amodal += area;
        over_pixels(f, b->cell[i], footprint_grow_box, f->amodal_box);
        if (b->seen[i].kind == KIND_SEEN) continue;
        if (all->entity[i]) {
            f->hidden_entity += area;
            f->hidden_by[all->entity[i] - 1] += area;
        } else {
            f->hidden_ground += area;
        }
    }
}

/* Shades some of the batch in these bands; areas: and counts them as the target's own. */
static void give(const Batch *b, const bool *take, unsigned bands, bool areas)
{
    Footprint *f = b->f;
    Scratch   *s = b->s;
    int        which[hits_capacity];
    if (areas && b->job->picture->target) count_hidden(b, take);
    if (gather_seen(which, b, take) == 0) return;
    s->block.bands = bands;
    shade_block(s, b->job);
    for (int i = 0; i < s->hits.count; i++) {
        const int    cell = s->block.cell[i];
        const double area = footprint_area(f, cell);
        for (int band = 0; band < BAND_COUNT; band++)
            if (has_band(bands, (Band)band)) f->veiled[band] += area * veil_taken(s, b->job, (Band)band, i);
        if (!areas) continue;
        f->visible += area;
        over_pixels(f, cell, add_area, NULL);
        if (!f->truth) continue;
        TruthSample truth = {.s = s, .sample = i};
        cell_sample(truth.at_px, f, cell);
        over_pixels(f, cell, offer_truth, &truth);
    }
}

/* ---- how finely ----------------------------------------------------------------------------- */

typedef enum Differ { differ_outline = 1, differ_shadow = 2 } Differ;

/* Outline: the target, none of it, or it hidden. */
static unsigned differ(const Seen *a, const Seen *b)
{
    if (a->kind != b->kind) return differ_outline;
    return a->kind == KIND_SEEN && a->shadow != b->shadow ? differ_shadow : 0;
}

/* Coarse cells that fine ones take the place of. */
typedef struct Finer {
    int  count;
    int  cell[hits_capacity];
    bool sun_only[hits_capacity]; /* for the bands that the sun lights: areas and others have the coarse one */
} Finer;

static unsigned passive_bands(const Job *job) { return job->request->bands & ~(1u << BAND_RADAR); }
static unsigned sunlit_bands(const Job *job) { return job->request->bands & (1u << BAND_OPTICAL | 1u << BAND_MWIR); }

/* Four cells each in place of some. */
static void sample_finer(Batch *b, const Finer *finer)
{
    enum { at_once = hits_capacity / 4 };
    const Footprint *f = b->f;
    for (int first = 0; first < finer->count; first += at_once) {
        bool whole[hits_capacity] = {0}, sun[hits_capacity] = {0};
        int  any_sun = 0;
        b->count   = 4 * at_most(at_once, finer->count - first);
        b->columns = 0;
        for (int n = 0; n < b->count; n++) {
            const int from = first + n / 4, coarse = finer->cell[from];
            b->cell[n] = cell_at(f, 1, 2 * column_of(f, coarse) + n % 2, 2 * row_of(f, coarse) + n % 4 / 2);
            sun[n]     = finer->sun_only[from];
            whole[n]   = !sun[n];
            any_sun += sun[n];
        }
        trace(b);
        give(b, whole, passive_bands(b->job), true);
        if (any_sun) give(b, sun, sunlit_bands(b->job), false);
    }
}

/* Coarse rows row0 .. row1, and all that is finer there. With `beside`, a row more on each side is traced to compare
 * with. */
static void sample_slab(Batch *b, int row0, int row1, int beside)
{
    const Footprint *f = b->f;
    const int        columns = columns_at(f, 0), from = row0 > 0 ? row0 - beside : 0;
    const int        to = at_most(row1 + beside, rows_at(f, 0));
    bool             whole[hits_capacity] = {0}, others[hits_capacity] = {0};
    Finer            finer;
    finer.count = 0;
    b->count    = (to - from) * columns;
    b->columns  = columns;
    for (int i = 0; i < b->count; i++) b->cell[i] = cell_at(f, 0, 0, from) + i;
    trace(b);
    for (int i = (row0 - from) * columns; i < (row1 - from) * columns; i++) {
        const int column = i % columns, row = from + i / columns;
        unsigned  unlike = 0;
        if (column > 0) unlike |= differ(&b->seen[i], &b->seen[i - 1]);
        if (column + 1 < columns) unlike |= differ(&b->seen[i], &b->seen[i + 1]);
        if (row > from) unlike |= differ(&b->seen[i], &b->seen[i - columns]);
        if (row + 1 < to) unlike |= differ(&b->seen[i], &b->seen[i + columns]);
        const bool outline = unlike & differ_outline;
        whole[i]  = !unlike;
        others[i] = unlike && !outline;
        if (!unlike) continue;
        finer.cell[finer.count]       = b->cell[i];
        finer.sun_only[finer.count++] = !outline;
    }
    give(b, whole, passive_bands(b->job), true);
    give(b, others, passive_bands(b->job) & ~sunlit_bands(b->job), true);
    sample_finer(b, &finer);
}

/* All of the fine cells, for the radar. */
static void sample_radar(Batch *b)
{
    const Footprint *f = b->f;
    const int        cells = f->columns * f->rows;
    const int        rows = hits_capacity / f->columns, block = (rows < 4 ? rows : rows / 4 * 4) * f->columns;
    bool             own[hits_capacity];
    memset(own, 1, sizeof own);
    for (int cell = 0; cell < cells; cell += block) {
        b->count   = at_most(block, cells - cell);
        b->columns = f->columns;
        for (int i = 0; i < b->count; i++) b->cell[i] = cell_at(f, footprint_levels - 1, 0, 0) + cell + i;
        trace(b);
        give(b, own, 1u << BAND_RADAR, false);
    }
}

void footprint_task(void *user, int worker, int index)
{
    const Job *job = user;
    Scratch   *s = job->scratch[worker];
    Footprint *f = &job->footprint[job->footprint_turn[index]];
    s->counters.small_targets++;
    if (f->columns * f->rows == 0) return;
    const int listed = visibility_block_entities(s->list, job->visibility, &job->request->view, f->box[0], f->box[1],
                                                 f->box[2], f->box[3], job->request->hidden_entity);
    s->block = (Block){.n = 1, .sign = 1, .bands = job->request->bands, .footprint = f};
    Batch     batch = {.f = f, .s = s, .job = job, .listed = listed};
    const int columns = columns_at(f, 0), rows = rows_at(f, 0), at_once = hits_capacity / columns;
    const int beside = rows > at_once && at_once > 2, slab = at_once - 2 * beside;
    for (int row = 0; row < rows; row += slab) sample_slab(&batch, row, at_most(row + slab, rows), beside);
    if (has_band(job->request->bands, BAND_RADAR)) sample_radar(&batch);
}
