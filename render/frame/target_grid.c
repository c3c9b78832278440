/* render/frame/target_grid.c: targets that are small on the image, each sampled on a grid over its own box.
 *
 * A target of a few pixels or less is sometimes hit by the samples of the pixels and sometimes missed, and flickers.
 * Here its box on the image is divided into cells, a fixed number across the target whatever its size, and each cell is
 * sampled once. The grid moves with the target, not with the pixels: its sum does not change as the target crosses
 * them. A cell's result is distributed to the pixels below it by exact shares of its area, so that the sum over pixels
 * is that over the target. The pixels' own samples exclude small targets; the composite pixel is its own value times
 * the share that the target's silhouette leaves, plus the grids' contribution: the target where a cell shows it, and
 * what hides it where one does not (leaves, a crest, a larger entity). The pixel's own samples cannot tell what lies
 * before the target from what lies behind it: with their mean in place of the leaves, ground would shine through gaps
 * that the target fills.
 *
 * Beside a silhouette the pixel's mean is used: exact where the ground is uniform over a pixel. */
#include "render/frame/frame_private.h"

#include <stdlib.h>

/* ---- planning ------------------------------------------------------------------------------- */

/* Below this both ways (or this one way and four times as much the other) the grid is more accurate: edge samples,
 * 1 / 16 px apart along an axis, have errors of up to 1 / 16 px of width, 0.4 % of 16 px. */
static bool is_small(const TargetPixels *t)
{
    const double w = t->projected_box[2] - t->projected_box[0], h = t->projected_box[3] - t->projected_box[1];
    return t->projected && fmin(w, h) < small_target_px && fmax(w, h) < small_target_long_px;
}

/* Cells of a target's grid. */
static void cells_of(int *columns, int *rows, const Job *job, int index)
{
    const double *box = job->boxes[index].projected_box, w = box[2] - box[0], h = box[3] - box[1];
    /* never fewer than the edges of larger targets get */
    const int per_px = looks_for_edges(job->request) ? job->request->edge_samples : job->request->samples;
    *columns = *rows = 0;
    if (!(w > 0 && h > 0)) return;
    *columns = (int)fmax(job->grid_side, ceil(w) * per_px);
    *rows = (int)fmax(job->grid_side, ceil(h) * per_px);
}

/* ---- a limit for many targets ------------------------------------------------------------------ */

/* The grids of a frame have at most so many cells for each of its pixels, or 2^17 (56 targets of 48 x 48) where that
 * is more. Grids finer than the default's become coarser to stay within the limit: without one, a target errs four
 * times as much as with 48 x 48. Where those are too many, targets are sampled by pixels and their edges, as larger
 * ones are. */
enum { cells_per_pixel = 4, cells_always = 1 << 17, usual_side = 48 };

static int64_t cells_allowed(const Job *job)
{
    const View *view = &job->request->view;
    return (int64_t)fmax(cells_always, (double)cells_per_pixel * view->width * view->height);
}

static int64_t cells_wanted(const Job *job)
{
    int64_t cells = 0;
    int     columns, rows;
    for (int i = 0; i < job->scene.snapshot->count; i++) {
        if (!job->is_small[i]) continue;
        cells_of(&columns, &rows, job, i);
        cells += (int64_t)columns * rows;
    }
    return cells;
}

/* The finest grids that fit, down to the usual ones. */
static void choose_side(Job *job)
{
    int low = usual_side, high = job->request->target_samples;
    job->grid_side = high;
    if (high <= low || cells_wanted(job) <= cells_allowed(job)) return;
    while (high - low > 1) {
        job->grid_side = (low + high) / 2;
        if (cells_wanted(job) <= cells_allowed(job)) low = job->grid_side;
        else high = job->grid_side;
    }
    job->grid_side = low;
}

typedef struct SmallPlace {
    double square_px; /* from the image's centre */
    int    index;
} SmallPlace;

static int nearer_the_axis(const void *left, const void *right)
{
    const SmallPlace *a = left, *b = right;
    if (a->square_px != b->square_px) return a->square_px < b->square_px ? -1 : 1;
    return (a->index > b->index) - (a->index < b->index);
}

/* The targets nearest the boresight keep their grids. Returns their number. */
static Status limit_cells(int *count, Job *job, Arena *arena)
{
    const View   *view = &job->request->view;
    const int64_t most = cells_allowed(job);
    int64_t       cells = 0;
    int           columns, rows, places = 0;
    if (cells_wanted(job) <= most) return STATUS_OK;
    SmallPlace *place = arena_alloc(arena, (size_t)*count, sizeof *place);
    if (!place) return STATUS_NO_MEMORY;
    for (int i = 0; i < job->scene.snapshot->count; i++) {
        const double *box = job->boxes[i].projected_box;
        if (!job->is_small[i]) continue;
        const double dx = 0.5 * (box[0] + box[2] - view->width), dy = 0.5 * (box[1] + box[3] - view->height);
        place[places++] = (SmallPlace){dx * dx + dy * dy, i};
    }
    qsort(place, (size_t)places, sizeof *place, nearer_the_axis);
    for (int k = 0; k < places; k++) {
        cells_of(&columns, &rows, job, place[k].index);
        cells += (int64_t)columns * rows;
        if (cells <= most) continue;
        job->is_small[place[k].index] = false;
        --*count;
        job->picture->counters.small_targets_by_pixels++;
    }
    return STATUS_OK;
}

static Status plan_one(TargetGrid *f, const Job *job, int index, Arena *arena)
{
    const View *view = &job->request->view;
    f->entity = index;
    memcpy(f->box, job->boxes[index].projected_box, sizeof f->box);
    cells_of(&f->columns, &f->rows, job, index);
    f->x0 = (int)fmax(0, floor(f->box[0])), f->x1 = (int)fmin(view->width, ceil(f->box[2]));
    f->y0 = (int)fmax(0, floor(f->box[1])), f->y1 = (int)fmin(view->height, ceil(f->box[3]));
    const size_t pixels = (size_t)(f->x1 - f->x0) * (size_t)(f->y1 - f->y0);
    bool         ok = (f->area = arena_alloc(arena, pixels, sizeof(double))) != NULL;
    ok = (f->before = arena_alloc(arena, pixels, sizeof(double))) && ok;
    for (int k = 0; k < picture_plane_count; k++) {
        if (!picture_plane(job->picture, k)) continue;
        ok = (f->sum[k] = arena_alloc(arena, pixels, sizeof(double))) && ok;
        ok = (f->before_sum[k] = arena_alloc(arena, pixels, sizeof(double))) && ok;
    }
    if (job->picture->entity) {
        ok = (f->truth = arena_alloc(arena, pixels, sizeof *f->truth)) && ok;
        for (size_t i = 0; ok && i < pixels; i++) f->truth[i].square_px = INFINITY;
    }
    const size_t cells = (size_t)f->columns * (size_t)f->rows;
    const bool   budget = job->request->budget, handed = job->request->hand_over_cells;
    if (budget || handed) ok = (f->met = arena_alloc(arena, cells, sizeof *f->met)) && ok;
    for (int k = 0; k < picture_plane_count; k++) {
        const bool handed_plane = handed && k != picture_radar;
        if (!picture_plane(job->picture, k)) continue;
        if (budget || handed_plane) ok = (f->cell[k] = arena_alloc(arena, cells, sizeof(float))) && ok;
        if (handed_plane) ok = (f->behind[k] = arena_alloc(arena, pixels, sizeof(float))) && ok;
    }
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

Status target_grids_plan(Job *job, Arena *arena)
{
    const size_t px = (size_t)job->picture->width * (size_t)job->picture->height;
    int          count = 0;
    for (int i = 0; i < job->scene.snapshot->count; i++) count += job->is_small[i] = is_small(&job->boxes[i]);
    if (count == 0) return STATUS_OK;
    choose_side(job);
    const Status limited = limit_cells(&count, job, arena);
    if (limited != STATUS_OK) return limited;
    job->footprint = arena_alloc(arena, (size_t)count, sizeof *job->footprint);
    job->picture->covered = arena_alloc(arena, px, sizeof *job->picture->covered);
    job->coverer = arena_alloc(arena, px, sizeof *job->coverer);
    job->before = arena_alloc(arena, px, sizeof *job->before);
    job->target_grid_order = arena_alloc(arena, (size_t)count, sizeof *job->target_grid_order);
    if (!job->footprint || !job->target_grid_order || !job->picture->covered || !job->coverer || !job->before)
        return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int i = 0; i < job->scene.snapshot->count && status == STATUS_OK; i++)
        if (job->is_small[i]) status = plan_one(&job->footprint[job->footprints++], job, i, arena);
    if (job->request->hand_over_cells) {
        job->picture->small.target = arena_alloc(arena, (size_t)count, sizeof *job->picture->small.target);
        if (!job->picture->small.target) return STATUS_NO_MEMORY;
    }
    /* the largest first, so that no worker is still busy with one when the others have finished */
    for (int n = 0; n < job->footprints; n++) {
        const TargetGrid *f = &job->footprint[n];
        int               at = n;
        for (; at > 0; at--) {
            const TargetGrid *before = &job->footprint[job->target_grid_order[at - 1]];
            if (before->columns * before->rows >= f->columns * f->rows) break;
            job->target_grid_order[at] = job->target_grid_order[at - 1];
        }
        job->target_grid_order[at] = n;
    }
    return status;
}

bool target_grid_hidden(const Job *job, int entity)
{
    int low = 0, high = job->footprints; /* by entity */
    while (low < high) {
        const int middle = (low + high) / 2;
        if (job->footprint[middle].entity < entity) low = middle + 1;
        else high = middle;
    }
    return low < job->footprints && job->footprint[low].entity == entity && !(job->footprint[low].visible > 0);
}

/* ---- cells ---------------------------------------------------------------------------------- */

typedef struct Span {
    double low, high; /* px */
} Span;

static Span cell_span(const TargetGrid *f, int axis, int cell)
{
    const int    cells = axis == 0 ? f->columns : f->rows;
    const double low = f->box[axis], length = f->box[axis + 2] - low;
    return (Span){low + length * cell / cells, low + length * (cell + 1) / cells};
}

static double overlap(Span a, double low, double high)
{
    const double length = fmin(a.high, high) - fmax(a.low, low);
    return length > 0 ? length : 0;
}

/* A key for each cell of each entity that seeds the random choices of its sample; different from all pixel keys. */
static uint64_t cell_key(const TargetGrid *f, int cell)
{
    return (uint64_t)1 << 62 | (uint64_t)f->entity << 32 | (uint64_t)cell;
}

/* Area of a cell within the image, px. */
static double cell_area(const TargetGrid *f, int cell)
{
    return overlap(cell_span(f, 0, cell % f->columns), f->x0, f->x1) *
           overlap(cell_span(f, 1, cell / f->columns), f->y0, f->y1);
}

/* Position of a cell's sample: columns shifted among rows, and rows among columns, by the golden section, so that an
 * edge along either is resolved in many more steps than there are cells across, and one along a diagonal, too. */
static void cell_sample(double at_px[2], const TargetGrid *f, int cell)
{
    static const double golden = 0.6180339887498949;
    const int           column = cell % f->columns, row = cell / f->columns;
    const double        u = 0.5 + row * golden, v = 0.5 + column * golden;
    at_px[0] = f->box[0] + (f->box[2] - f->box[0]) * (column + u - floor(u)) / f->columns;
    at_px[1] = f->box[1] + (f->box[3] - f->box[1]) * (row + v - floor(v)) / f->rows;
}

void target_grid_shares(CellShares *out, const TargetGrid *f, int cell)
{
    const Span across = cell_span(f, 0, cell % f->columns), down = cell_span(f, 1, cell / f->columns);
    out->count = 0;
    for (int y = (int)fmax(f->y0, floor(down.low)); y < f->y1 && y < down.high; y++)
        for (int x = (int)fmax(f->x0, floor(across.low)); x < f->x1 && x < across.high; x++) {
            const double area = overlap(across, x, x + 1) * overlap(down, y, y + 1);
            if (!(area > 0) || out->count == shares_most) continue;
            out->pixel[out->count] = (y - f->y0) * (f->x1 - f->x0) + x - f->x0;
            out->x[out->count] = x, out->y[out->count] = y;
            out->area[out->count++] = area;
        }
}

static void add_value(double *sum, const CellShares *s, double value)
{
    for (int k = 0; k < s->count; k++) sum[s->pixel[k]] += s->area[k] * value;
}

static void add_area(double *sum, const CellShares *s)
{
    for (int k = 0; k < s->count; k++) sum[s->pixel[k]] += s->area[k];
}

/* ---- sampling ------------------------------------------------------------------------------- */

typedef struct TruthSample {
    const Samples *s;
    int            sample;
    double         at_px[2];
} TruthSample;

static void offer_truth(const TruthSample *t, const TargetGrid *f, int pixel, int x, int y)
{
    const double     dx = t->at_px[0] - x - 0.5, dy = t->at_px[1] - y - 0.5, square_px = dx * dx + dy * dy;
    TargetGridTruth *to = &f->truth[pixel];
    const Samples   *s = t->s;
    if (!(square_px < to->square_px)) return;
    *to = (TargetGridTruth){.square_px = square_px,
                            .range_m = (float)s->hits.range_m[t->sample],
                            .temp_k = s->temp_k[t->sample],
                            .part = s->hits.part[t->sample],
                            .material = s->hits.material[t->sample]};
    for (int k = 0; k < 3; k++) to->normal[k] = s->hits.n_enu[k][t->sample];
}

/* Compacts the cells whose ray would meet the target if it were alone in the world: no other ray is traced, and the
 * target itself not again. Without SKIP_CELL all stay, and are. Returns their number. */
static int keep_amodal(int *cell, TargetGrid *f, Worker *w, const Job *job, int first_cell)
{
    Rays      *rays = &w->samples.rays;
    const int  count = rays->count;
    const bool leave_out = skips(job->request->skips_off, SKIP_CELL);
    int        kept = 0;
    if (leave_out) visibility_entity_hits(&w->known, job->scene.visibility, rays, f->entity, &w->shader.counters);
    else visibility_entity_only(w->meets, job->scene.visibility, rays, f->entity, &w->shader.counters);
    for (int i = 0; i < count; i++) {
        if (leave_out) w->meets[i] = w->known.range_m[i] < INFINITY;
        if (!w->meets[i] && leave_out) continue;
        w->known.range_m[kept] = w->known.range_m[i], w->known.hit[kept] = w->known.hit[i];
        cell[kept] = first_cell + i;
        w->meets[kept] = w->meets[i];
        for (int k = 0; k < 3; k++) {
            rays->o_enu[k][kept] = rays->o_enu[k][i];
            rays->d_enu[k][kept] = rays->d_enu[k][i];
        }
        rays->far_m[kept++] = rays->far_m[i];
    }
    w->shader.counters.skipped[SKIP_CELL] += (uint64_t)(count - kept);
    rays->count = kept;
    rays->columns = 0;
    return kept;
}

/* What hides the target where its own samples did not meet it first. */
static void count_hidden(TargetGrid *f, Worker *w, const Job *job, const int *cell)
{
    const uint32_t id = (uint32_t)f->entity + 1;
    const Hits    *hits = &w->samples.hits;
    for (int i = 0; i < hits->count; i++) {
        if (!w->meets[i]) continue;
        const double area = cell_area(f, cell[i]);
        CellShares   shares;
        f->amodal += area;
        target_grid_shares(&shares, f, cell[i]);
        for (int k = 0; k < shares.count; k++) grow_pixel_box(f->amodal_box, shares.x[k], shares.y[k]);
        if (hits->entity[i] == id) continue;
        if (hits->entity[i]) {
            f->hidden_entity += area;
            occlusion_add(&w->sums.hidden, job->rules.arena, f->entity, (int)hits->entity[i] - 1, 0, area);
        } else if (hits->kind[i] == hit_scenery) {
            f->hidden_scenery += area;
        } else if (hits->instance[i]) {
            f->hidden_plants += area;
        } else {
            f->hidden_ground += area;
        }
    }
}

/* Splits the samples into those that met the target, which stay, and those of its silhouette that something hides,
 * which go to the worker's hits and `before`: no other is shaded here. What small targets hide is left to their own
 * grids. Returns how many stay. */
static int part_samples(const TargetGrid *f, Worker *w, const Job *job, int *cell, int *before)
{
    const uint32_t id = (uint32_t)f->entity + 1;
    Hits          *hits = &w->samples.hits;
    Rays          *rays = &w->samples.rays;
    int            kept = 0, hidden = 0;
    for (int i = 0; i < hits->count; i++) {
        if (hits->entity[i] == id) {
            cell[kept] = cell[i];
            hits_copy(hits, rays, kept++, hits, rays, i);
        } else if (w->meets[i] && !(hits->entity[i] && job->is_small[hits->entity[i] - 1])) {
            before[hidden] = cell[i];
            hits_copy(&w->hits, &w->rays, hidden++, hits, rays, i);
        }
    }
    hits->count = rays->count = kept;
    w->hits.count = w->rays.count = hidden;
    hits->columns = rays->columns = w->hits.columns = w->rays.columns = 0;
    w->hits.several = false;
    return kept;
}

static void light_cells(const TargetGrid *f, Worker *w, const Job *job, const int *cell)
{
    Samples *s = &w->samples;
    for (int i = 0; i < s->hits.count && job->scene.sky_samples > 0; i++) w->key[i] = cell_key(f, cell[i]);
    s->key = w->key;
    s->per_rad = job->request->view.focal_px;
    w->shader.terms = record_in_box(job, f->x0, f->y0, f->x1, f->y1) ? w->terms : NULL;
    shade_samples_sun(&w->shader, &job->scene, s);
    shade_samples_light(&w->shader, &job->scene, s);
}

/* Light of the cells that something hides, into the pixels that show some of the target. */
static void shade_hidden(TargetGrid *f, Worker *w, const Job *job, int *cell)
{
    Samples *s = &w->samples;
    int      kept = 0;
    for (int i = 0; i < w->hits.count; i++) {
        CellShares shares;
        bool       shown = false;
        target_grid_shares(&shares, f, cell[i]);
        for (int k = 0; k < shares.count; k++) shown |= f->area[shares.pixel[k]] > 0;
        if (!shown) continue;
        cell[kept] = cell[i];
        hits_copy(&s->hits, &s->rays, kept++, &w->hits, &w->rays, i);
    }
    s->hits.count = s->rays.count = kept;
    if (kept == 0) return;
    light_cells(f, w, job, cell);
    record_cells(f, w, job, cell, PIXEL_BEFORE);
    const float *value[picture_plane_count];
    for (int plane = 0; plane < picture_plane_count; plane++) value[plane] = block_values(w, job, plane);
    for (int i = 0; i < kept; i++) {
        CellShares shares;
        target_grid_shares(&shares, f, cell[i]);
        for (int plane = 0; plane < picture_plane_count; plane++)
            if (value[plane]) add_value(f->before_sum[plane], &shares, (double)value[plane][i]);
        add_area(f->before, &shares);
    }
}

/* Light of the samples that met the target, into its cells, its pixels and its sums. */
static void shade_cells(TargetGrid *f, Worker *w, const Job *job, const int *cell, int count)
{
    Samples *s = &w->samples;
    ask_smoke(w, job, f->box);
    light_cells(f, w, job, cell);
    record_cells(f, w, job, cell, PIXEL_TARGET);
    const float *value[picture_plane_count];
    for (int plane = 0; plane < picture_plane_count; plane++) value[plane] = block_values(w, job, plane);
    for (int i = 0; i < count; i++) {
        CellShares shares;
        target_grid_shares(&shares, f, cell[i]);
        w->area_px[i] = cell_area(f, cell[i]);
        for (int plane = 0; plane < picture_plane_count; plane++) {
            if (!value[plane]) continue;
            const float v = value[plane][i];
            add_value(f->sum[plane], &shares, (double)v);
            if (f->cell[plane]) f->cell[plane][cell[i]] = v, f->met[cell[i]] = true;
            f->square[plane] += w->area_px[i] * v * v;
        }
        f->visible += w->area_px[i];
        for (int b = 0; b < BAND_COUNT; b++)
            f->veiled[b] += w->area_px[i] * samples_smoke_taken(s, job->rules.smoke_channel[b], i);
        add_area(f->area, &shares);
        if (!f->truth) continue;
        TruthSample truth = {.s = s, .sample = i};
        cell_sample(truth.at_px, f, cell[i]);
        for (int k = 0; k < shares.count; k++) offer_truth(&truth, f, shares.pixel[k], shares.x[k], shares.y[k]);
    }
    if (s->radar && job->request->profile_bins > 0)
        target_sums_profile(&w->sums, &job->rules, job->request, s, w->area_px);
}

static void sample_cells(TargetGrid *f, Worker *w, const Job *job, int first_cell, int count, int listed)
{
    const View  *view = &job->request->view;
    Samples     *s = &w->samples;
    const double t0 = wall_clock_s();
    int          cell[hits_capacity]; /* of each sample: row * columns + column */
    for (int i = 0; i < count; i++) {
        double at_px[2], d_enu[3];
        cell_sample(at_px, f, first_cell + i);
        view_ray(d_enu, view, at_px[0], at_px[1]);
        for (int k = 0; k < 3; k++) {
            s->rays.o_enu[k][i] = view->p_enu[k];
            s->rays.d_enu[k][i] = d_enu[k];
        }
        s->rays.far_m[i] = INFINITY;
    }
    s->rays.count = count;
    s->rays.columns = f->columns;
    w->counters.rays_primary += (uint64_t)count;
    w->counters.rays_small_targets += (uint64_t)count;
    keep_amodal(cell, f, w, job, first_cell);
    w->shader.visibility_s += wall_clock_s() - t0;
    s->known = skips(job->request->skips_off, SKIP_CELL) ? &w->known : NULL;
    shade_samples_trace(&w->shader, &job->scene, s, w->list, listed);
    s->known = NULL;
    if (job->picture->target) count_hidden(f, w, job, cell);
    int       before[hits_capacity];
    const int kept = part_samples(f, w, job, cell, before);
    if (kept == 0) return;
    shade_cells(f, w, job, cell, kept);
    shade_hidden(f, w, job, before);
}

void target_grid_task(void *user, int worker, int index)
{
    const Job  *job = user;
    Worker     *w = job->worker[worker];
    TargetGrid *f = &job->footprint[job->target_grid_order[index]];
    const int   cells = f->columns * f->rows;
    w->counters.small_targets++;
    if (cells == 0) return;
    const int listed = list_entities(w, job, f->box, true);
    ask_bands(w, job, job->request->bands);
    /* complete rows, in multiples of four where they fit: their rays are traced in squares */
    const int rows = hits_capacity / f->columns, block = (rows < 4 ? rows : rows / 4 * 4) * f->columns;
    for (int cell = 0; cell < cells; cell += block)
        sample_cells(f, w, job, cell, cells - cell < block ? cells - cell : block, listed);
}
