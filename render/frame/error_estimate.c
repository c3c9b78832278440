/* render/frame/error_estimate.c: the error estimate of a frame by re-sampling some of its pixels. One candidate in
 * each of many equal fields is weighted by its difference from its neighbours; the pixels to re-sample are drawn
 * with these weights; blocks of them are shaded, each into its own sums. Where targets are not refined their pixels are
 * fields of their own: they are few, and hold most of an infrared band's error. */

#include "render/frame/render.h"
#include "render/frame/frame_private.h"

enum {
    probes_a_block = 64,
    blocks_most = 12,
    candidates_a_probe = 4,
    tables_probes = 48,
    hottest_probes = 2,
    tables_blocks = 4 /* of them, for as many threads */,
    target_candidates = 512,
    target_blocks = 4
};
static const double   large_target = 1.0 / 16; /* of the picture: a box above it has fields enough */
static const double   pixels_a_probe = 1200;   /* 16 rays each: 1.3 % of a frame of one ray a pixel */
static const uint32_t stream = 0x6275;         /* "bu" */

typedef struct Candidate {
    uint16_t x, y;
    double   area;   /* number of pixels that it represents */
    double   weight; /* to be drawn */
    unsigned planes; /* 1 << plane: those whose error its own samples do not estimate */
    float    value[picture_plane_count], contrast[picture_plane_count];
} Candidate;

typedef struct ProbeOf {
    int    candidate;
    double stands_for; /* px */
} ProbeOf;

/* A block of re-sampled pixels. */
typedef struct ProbeTask {
    bool             of_tables; /* computed directly, without tables, and nothing else */
    int              count;
    const ProbeOf   *probe; /* [count] */
    const Candidate *candidate;
    float            base[picture_plane_count][probes_a_block];
    double           image_px[probes_a_block]; /* displacement of the ground on the image */
    bool             plant[probes_a_block];    /* its ray meets one */
    double           sampling[picture_plane_count], detail[picture_plane_count], tables[picture_plane_count];
    double           tables_px;
    int              first; /* of its probes, those at hand; of squares: all of the block */
    float           *square[error_thermal_planes];
} ProbeTask;

typedef struct Budget {
    const Job *job;
    int        field_px, columns, rows, candidates, probes, blocks, n;
    int        target_first; /* the first of their candidates */
    int        target_px;    /* number of pixels in boxes of targets that are not refined */
    uint8_t   *of_target;    /* 1: one of them; NULL: none */
    bool       law;          /* too many rays to re-sample more finely: the sampling variance is used */
    Candidate *candidate;
    ProbeOf   *probe, tables_probe[tables_probes + hottest_probes];
    ProbeTask *task;                    /* [blocks + tables_blocks] */
    AirPaths (*direct)[AIR_BAND_COUNT]; /* [workers] */
    double *probe_px;                   /* ErrorBudget's */
    float  *square[error_thermal_planes];
} Budget;

/* ---- which pixels ---------------------------------------------------------------------------- */

/* Marks the boxes of targets and a pixel about them. */
static Status mark_targets(Budget *b, Arena *arena)
{
    const Job     *job = b->job;
    const Picture *p = job->picture;
    const int      pixels = p->width * p->height;
    if (looks_for_edges(job->request)) return STATUS_OK; /* they are refined */
    if (!(b->of_target = arena_alloc(arena, (size_t)pixels, 1))) return STATUS_NO_MEMORY;
    for (int i = 0; i < job->scene.snapshot->count; i++) {
        const double *box = job->boxes[i].projected_box;
        if (!job->boxes[i].projected) continue;
        const int x0 = (int)fmax(0, floor(box[0]) - 1), x1 = (int)fmin(p->width, ceil(box[2]) + 1);
        const int y0 = (int)fmax(0, floor(box[1]) - 1), y1 = (int)fmin(p->height, ceil(box[3]) + 1);
        if ((double)(x1 - x0) * (y1 - y0) > large_target * pixels) continue;
        for (int y = y0; y < y1; y++)
            for (int x = x0; x < x1; x++) b->of_target[pixel_index(job, x, y)] = 1;
    }
    for (int k = 0; k < pixels; k++) b->target_px += b->of_target[k];
    return STATUS_OK;
}

static void read_candidate(Candidate *c, const Job *job)
{
    const Picture *p = job->picture;
    c->planes = planes_to_resample(job, pixel_index(job, c->x, c->y));
    for (int k = 0; k < picture_plane_count; k++) {
        const float *value = picture_plane(p, k);
        if (!value) continue;
        c->value[k] = value[pixel_index(job, c->x, c->y)];
        c->contrast[k] = (float)picture_contrast(p, value, c->x, c->y);
    }
}

/* Divides the targets' pixels, in the picture's order, into equal shares and draws a candidate from each; they follow
 * the candidates of the fields. */
static void add_target_candidates(Budget *b)
{
    const int    width = b->job->picture->width;
    const int    count = b->target_px < target_candidates ? b->target_px : target_candidates;
    const double share = (double)b->target_px / count;
    int          met = 0, px = -1;
    for (int k = 0; k < count; k++) {
        const int wanted = (int)((k + random_uniform(1, stream, 1, (uint64_t)k)) * share); /* below target_px */
        while (met <= wanted) met += b->of_target[++px];
        Candidate *c = &b->candidate[b->candidates++]; /* target_first and on */
        *c = (Candidate){.x = (uint16_t)(px % width), .y = (uint16_t)(px / width), .area = share};
        read_candidate(c, b->job);
    }
}

/* Moves a field's candidate to a pixel that is no target's, and lets it stand for the number of those. */
static void leave_targets_out(Candidate *c, const Budget *b, int x0, int y0, int w, int h)
{
    const int first = (c->y - y0) * w + c->x - x0;
    int       found = -1;
    c->area = 0;
    for (int k = 0; k < w * h; k++) {
        const int at = (first + k) % (w * h);
        if (b->of_target[pixel_index(b->job, x0 + at % w, y0 + at / w)]) continue;
        if (found < 0) found = at;
        c->area++;
    }
    if (found < 0) return;
    c->x = (uint16_t)(x0 + found % w), c->y = (uint16_t)(y0 + found / w);
}

/* A pool task: draws the candidates of a row of fields. */
static void candidate_task(void *user, int worker, int row)
{
    const Budget  *b = user;
    const Picture *p = b->job->picture;
    (void)worker;
    for (int column = 0; column < b->columns; column++) {
        const uint64_t field = (uint64_t)row * (uint64_t)b->columns + (uint64_t)column;
        Candidate     *c = &b->candidate[field];
        const int      x0 = column * b->field_px, y0 = row * b->field_px;
        const int      w = p->width - x0 < b->field_px ? p->width - x0 : b->field_px;
        const int      h = p->height - y0 < b->field_px ? p->height - y0 : b->field_px;
        c->x = (uint16_t)(x0 + (int)(random_uniform(1, stream, 0, 2 * field) * w));
        c->y = (uint16_t)(y0 + (int)(random_uniform(1, stream, 0, 2 * field + 1) * h));
        c->area = (double)w * h;
        if (b->of_target) leave_targets_out(c, b, x0, y0, w, h);
        read_candidate(c, b->job);
    }
}

/* Draws at most `most` of the candidates from .. end - 1, in equal steps of their summed weight. Returns how many. */
static int draw(ProbeOf *out, int most, const Budget *b, int from, int end)
{
    double sum = 0, gone = 0;
    int    count = 0;
    for (int i = from; i < end; i++) sum += b->candidate[i].weight * b->candidate[i].area;
    if (!(sum > 0)) return 0;
    const double step = sum / most;
    double       to = 0.5 * step;
    for (int i = from; i < end; i++) {
        const Candidate *c = &b->candidate[i];
        int              drawn = 0;
        for (gone += c->weight * c->area; to < gone; to += step) drawn++;
        if (drawn > 0 && count < most) out[count++] = (ProbeOf){i, drawn * step / c->weight};
    }
    return count;
}

/* Draws probes. A candidate's weight is the root of the difference from its neighbours over each plane's own mean
 * difference (so that the ground's noise in one band does not hide the borders of another), and no less than a uniform
 * share. */
static int draw_probes(ProbeOf *out, int most, Budget *b, int from, int end)
{
    double sum = 0, area = 0, typical[picture_plane_count] = {0};
    for (int i = from; i < end; i++)
        for (int k = 0; k < picture_plane_count; k++)
            if (b->candidate[i].planes >> k & 1)
                typical[k] += b->candidate[i].area * (double)b->candidate[i].contrast[k];
    for (int i = from; i < end; i++) {
        Candidate *c = &b->candidate[i];
        double     relative = 0;
        c->weight = 0;
        if (!c->planes) continue;
        for (int k = 0; k < picture_plane_count; k++)
            if (c->planes >> k & 1 && typical[k] > 0) relative += (double)c->contrast[k] / typical[k];
        c->weight = sqrt(relative);
        sum += c->weight * c->area;
        area += c->area;
    }
    if (!(area > 0)) return 0;
    const double even = sum > 0 ? sum / area : 1;
    for (int i = from; i < end; i++)
        if (b->candidate[i].planes) b->candidate[i].weight += even;
    return draw(out, most, b, from, end);
}

/* The brightest pixel of each infrared plane, for itself alone: one exhaust may hold most of its plane's error, and few
 * candidates fall on it. Their candidates are the last ones. Returns how many. */
static int add_hottest(ProbeOf *out, const Budget *b)
{
    static const int planes[hottest_probes] = {picture_mwir, picture_lwir};
    const Picture   *p = b->job->picture;
    const size_t     pixels = (size_t)p->width * (size_t)p->height;
    int              count = 0;
    for (int n = 0; n < hottest_probes; n++) {
        const float *value = picture_plane(p, planes[n]);
        size_t       most = 0;
        for (size_t i = 1; value && i < pixels; i++)
            if (value[i] > value[most]) most = i;
        if (!value || !planes_to_resample(b->job, most)) continue;
        Candidate *c = &b->candidate[b->candidates + count];
        *c = (Candidate){.x = (uint16_t)(most % (size_t)p->width),
                         .y = (uint16_t)(most / (size_t)p->width),
                         .area = 1,
                         .planes = planes_to_resample(b->job, most),
                         .weight = 1};
        for (int k = 0; k < picture_plane_count; k++)
            if (picture_plane(p, k)) c->value[k] = picture_plane(p, k)[most];
        out[count] = (ProbeOf){b->candidates + count, 1};
        count++;
    }
    return count;
}

/* Draws the probes of the tables. A candidate's weight is its brightness over each plane's mean, and no less than a
 * uniform share: the error of the tables is proportional to it, and a few hot pixels can hold half of a thermal band.
 */
static int draw_tables(Budget *b, const double mean[picture_plane_count])
{
    for (int i = 0; i < b->candidates; i++) {
        Candidate *c = &b->candidate[i];
        c->weight = c->planes ? 1 : 0;
        for (int k = 0; k < picture_radar; k++)
            if (c->planes >> k & 1 && mean[k] > 0) c->weight = fmax(c->weight, (double)c->value[k] / mean[k]);
    }
    const int drawn = draw(b->tables_probe, tables_probes, b, 0, b->candidates);
    return drawn > 0 ? drawn + add_hottest(b->tables_probe + drawn, b) : 0;
}

/* ---- a block of re-sampled pixels --------------------------------------------------------------- */

static const Candidate *candidate_of(const ProbeTask *t, int p) { return &t->candidate[t->probe[p].candidate]; }

/* Adds to the squared error of the probe p at hand, if the plane is a thermal one. */
static void take_square(ProbeTask *t, int p, int plane, double square)
{
    if (plane == picture_mwir || plane == picture_lwir) t->square[plane - picture_mwir][t->first + p] += (float)square;
}

/* Adds the change of a plane's values with more rays: sampling error, from their own variance where they have as
 * many rays as the picture. */
static void take_rays(ProbeTask *t, const Job *job, int n, const float *value, int plane)
{
    const int  samples = n * n;
    const bool law = n == job->request->samples;
    for (int p = 0; p < t->count; p++) {
        const Candidate *c = candidate_of(t, p);
        if (!(c->planes >> plane & 1)) continue;
        double       square, sum = 0;
        const double variance = law ? render_error_variance(value + p * samples, n) : 0;
        for (int k = 0; k < samples; k++) sum += (double)value[p * samples + k];
        square = sum / samples - (double)c->value[plane];
        square *= square;
        /* a pixel that is filled from others is off by more than as many rays of its own would be */
        if (law) square = sampling_fills(job, c->x, c->y) ? fmax(square - variance, variance) : variance;
        t->sampling[plane] += t->probe[p].stands_for * square;
        take_square(t, p, plane, square);
    }
}

/* Adds the change of a plane's values when the ground is known at every second post only. */
static void take_coarse(ProbeTask *t, const float *value, int plane)
{
    for (int p = 0; p < t->count; p++) {
        const Candidate *c = candidate_of(t, p);
        if (!(c->planes >> plane & 1)) continue;
        const double moved = t->image_px[p] * t->image_px[p], turned = (double)(value[p] - t->base[plane][p]);
        const double square = turned * turned + (double)c->contrast[plane] * moved / (1 + moved);
        t->detail[plane] += t->probe[p].stands_for * square;
        take_square(t, p, plane, square);
    }
}

static void take_tables(ProbeTask *t, const float *value, int plane)
{
    for (int p = 0; p < t->count; p++) {
        const double apart = (double)(value[p] - t->base[plane][p]);
        t->tables[plane] += t->probe[p].stands_for * apart * apart;
    }
}

/* Tilts the block's ground hits as posts twice as far apart would. */
static void coarsen(Samples *s, const Job *job, ProbeTask *t)
{
    const World *world = job->scene.world;
    for (int p = 0; p < t->count; p++) {
        double turn_enu[3], rise_m;
        t->image_px[p] = 0;
        if (!world->landscape || !s->hits.surface[p] ||
            !render_error_coarser(turn_enu, &rise_m, &world->landscape->elevation, s->hits.p_enu[0][p],
                                  s->hits.p_enu[1][p]))
            continue;
        double n_enu[3];
        for (int k = 0; k < 3; k++) n_enu[k] = (double)s->hits.n_enu[k][p] + turn_enu[k];
        if (v3_normalize(n_enu, n_enu))
            for (int k = 0; k < 3; k++) s->hits.n_enu[k][p] = (float)n_enu[k];
        const double up = s->rays.d_enu[2][p];
        t->image_px[p] = fabs(rise_m) * sqrt(1 - up * up) * job->request->view.focal_px / s->hits.range_m[p];
    }
}

/* Shades the task's pixels with n x n samples each. */
static void shade_pixels(Worker *w, const Job *job, const ProbeTask *t, int n, int listed)
{
    w->block.n = n;
    w->block.pixels = w->block.columns = 0;
    for (int p = 0; p < t->count; p++) pixels_add(&w->block, candidate_of(t, p)->x, candidate_of(t, p)->y);
    block_trace(w, job, job->request->bands, listed);
    shade_samples_sun(&w->shader, &job->scene, &w->samples);
    block_light(w, job);
}

/* Shades one sample a pixel, the reference of the comparisons. */
static void shade_base(Worker *w, const Job *job, ProbeTask *t, int listed)
{
    shade_pixels(w, job, t, 1, listed);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        const float *value = block_values(w, job, plane);
        if (value) memcpy(t->base[plane], value, (size_t)t->count * sizeof *value);
    }
}

static void probe_task(void *user, int worker, int index)
{
    const Budget *b = user;
    const Job    *job = b->job;
    ProbeTask    *t = &b->task[index];
    Worker       *w = job->worker[worker];
    double        box[4] = {INFINITY, INFINITY, 0, 0};
    const float  *value;
    for (int p = 0; p < t->count; p++) {
        const Candidate *c = candidate_of(t, p);
        box[0] = fmin(box[0], c->x), box[1] = fmin(box[1], c->y);
        box[2] = fmax(box[2], c->x + 1), box[3] = fmax(box[3], c->y + 1);
    }
    const int listed = list_entities(w, job, box, false);
    if (t->of_tables) {
        shade_base(w, job, t, listed);
        shade_samples_light_directly(&w->shader, &job->scene, &w->samples, b->direct[worker]);
        for (int plane = 0; plane < picture_radar; plane++)
            if ((value = block_values(w, job, plane))) take_tables(t, value, plane);
        for (int p = 0; p < t->count; p++) t->tables_px += t->probe[p].stands_for;
        return;
    }
    /* as many pixels at a time as a block of samples holds */
    const ProbeOf *first = t->probe;
    const int      count = t->count, piece = hits_capacity / (b->n * b->n);
    for (int p = 0; p < count; p += piece) {
        t->probe = first + p;
        t->first = p;
        t->count = count - p < piece ? count - p : piece;
        shade_pixels(w, job, t, b->n, listed);
        for (int plane = 0; plane < picture_plane_count; plane++)
            if ((value = block_values(w, job, plane))) take_rays(t, job, b->n, value, plane);
    }
    t->probe = first, t->count = count, t->first = 0;
    shade_base(w, job, t, listed);
    for (int p = 0; p < count; p++) t->plant[p] = w->samples.hits.kind[p] == hit_plant;
    coarsen(&w->samples, job, t);
    block_light(w, job);
    for (int plane = 0; plane < picture_plane_count; plane++)
        if ((value = block_values(w, job, plane))) take_coarse(t, value, plane);
}

/* ---- the whole ---------------------------------------------------------------------------------- */

static Status plan(Budget *b, Pool *pool, Arena *arena)
{
    const Picture *p = b->job->picture;
    const int      samples = b->job->request->samples;
    const double   pixels = (double)p->width * p->height;
    b->law = 4 * samples > 16;
    b->n = b->law ? samples : 4 * samples;
    b->blocks = (int)clamp(ceil(pixels / pixels_a_probe / probes_a_block), 1, blocks_most);
    b->probes = b->blocks * probes_a_block;
    b->field_px = (int)fmax(floor(sqrt(pixels / (b->probes * candidates_a_probe))), 1);
    b->columns = (p->width + b->field_px - 1) / b->field_px;
    b->rows = (p->height + b->field_px - 1) / b->field_px;
    b->candidates = b->columns * b->rows;
    b->candidate = arena_alloc(arena, (size_t)b->candidates + target_candidates + hottest_probes, sizeof *b->candidate);
    const size_t most = (size_t)(b->probes + target_blocks * probes_a_block);
    b->target_first = b->candidates;
    b->probe = arena_alloc(arena, most, sizeof *b->probe);
    b->task = arena_alloc(arena, (size_t)b->blocks + target_blocks + tables_blocks, sizeof *b->task);
    b->direct = arena_alloc(arena, (size_t)pool_threads(pool), sizeof *b->direct);
    b->probe_px = arena_alloc(arena, most, sizeof *b->probe_px);
    bool ok = b->candidate && b->probe && b->task && b->direct && b->probe_px;
    for (int k = 0; k < error_thermal_planes; k++)
        ok = (b->square[k] = arena_alloc(arena, most, sizeof *b->square[k])) && ok;
    return ok ? mark_targets(b, arena) : STATUS_NO_MEMORY;
}

/* Fills the tasks: blocks of re-sampled pixels, then those that check the tables; returns the number of both. */
static int deal(Budget *b, int probes, int of_tables)
{
    for (int i = 0; i < probes; i++) {
        b->probe_px[i] = b->probe[i].stands_for;
        for (int k = 0; k < error_thermal_planes; k++)
            b->square[k][i] = b->candidate[b->probe[i].candidate].planes >> (picture_mwir + k) & 1 ? 0 : NAN;
    }
    const int a_block = (of_tables + tables_blocks - 1) / tables_blocks;
    int       tasks = 0;
    for (int first = 0; first < probes; first += probes_a_block)
        b->task[tasks++] = (ProbeTask){.probe = b->probe + first,
                                       .candidate = b->candidate,
                                       .count = probes - first < probes_a_block ? probes - first : probes_a_block,
                                       .square = {b->square[0] + first, b->square[1] + first}};
    for (int first = 0; first < of_tables; first += a_block)
        b->task[tasks++] = (ProbeTask){.of_tables = true,
                                       .probe = b->tables_probe + first,
                                       .candidate = b->candidate,
                                       .count = of_tables - first < a_block ? of_tables - first : a_block};
    return tasks;
}

/* The error by plants, over the pixels that show some, to the squares of those probes. */
static void take_plants(ProbeTask *t, const PlantPrice *plants)
{
    for (int k = 0; k < error_thermal_planes; k++) {
        const double all = fmax(plants->structure_square[picture_mwir + k], 0),
                     square = all * plants->rays / plants->met;
        for (int p = 0; p < t->count; p++)
            if (t->plant[p]) t->square[k][p] += (float)square;
    }
}

Status error_estimate(const Job *job, Pool *pool, Arena *arena)
{
    const double start_s = wall_clock_s();
    Picture     *picture = job->picture;
    const double pixels = (double)picture->width * picture->height;
    Budget       b = {.job = job};
    ErrorBudget *out = arena_alloc(arena, 1, sizeof *out);
    Status       status = out ? plan(&b, pool, arena) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    pool_run(pool, b.rows, candidate_task, &b);
    if (b.target_px > 0) add_target_candidates(&b);
    for (int i = 0; i < b.candidates; i++)
        for (int k = 0; k < picture_plane_count; k++)
            out->mean[k] += (double)b.candidate[i].value[k] * b.candidate[i].area;
    for (int k = 0; k < picture_plane_count; k++) out->mean[k] /= pixels;
    out->probes = draw_probes(b.probe, b.probes, &b, 0, b.target_first);
    if (b.candidates > b.target_first)
        out->probes +=
            draw_probes(b.probe + out->probes, target_blocks * probes_a_block, &b, b.target_first, b.candidates);
    const int tasks = deal(&b, out->probes, draw_tables(&b, out->mean));
    pool_run(pool, tasks, probe_task, &b);
    if (job->scene.full != job->scene.visibility) status = plant_price(&out->plants, job, pool, arena);
    if (status != STATUS_OK) return status;
    for (int t = 0; t < tasks && out->plants.met > 0; t++)
        if (!b.task[t].of_tables) take_plants(&b.task[t], &out->plants);

    const int tiles = job->law ? job->tiles_x * job->tiles_y : 0;
    double    tables_px = 0;
    for (int t = 0; t < tasks; t++) tables_px += b.task[t].tables_px;
    for (int k = 0; k < picture_plane_count; k++) {
        double sampling = job->target_variance[k], detail = 0, tables = 0;
        for (int t = 0; t < tiles; t++) sampling += job->law[t][k];
        if (k == picture_mwir || k == picture_lwir) out->refined_square[k - picture_mwir] = sampling;
        for (int t = 0; t < tasks; t++) {
            sampling += b.task[t].sampling[k];
            detail += b.task[t].detail[k];
            tables += b.task[t].tables[k];
        }
        const bool there = picture_plane(picture, k) != NULL;
        out->sampling[k] = there ? sqrt(sampling / pixels) : NAN;
        out->level_of_detail[k] = there ? sqrt(detail / pixels + fmax(out->plants.structure_square[k], 0)) : NAN;
        out->tables[k] = there ? sqrt(tables_px > 0 ? tables / tables_px : 0) : NAN;
        if (!there) out->mean[k] = NAN;
    }
    out->probe_px = b.probe_px;
    for (int k = 0; k < error_thermal_planes; k++) out->probe_square[k] = b.square[k];
    out->ms = 1e3 * (wall_clock_s() - start_s);
    picture->budget = out;
    return STATUS_OK;
}
