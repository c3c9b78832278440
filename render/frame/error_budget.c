/* render/frame/error_budget.c: pixels looked at again. First some candidates, one in each of many equal fields, tell how much
 * they differ from their neighbours; of these the probes are drawn, the likelier the more; then blocks of probes are
 * traced, each to sums of its own. */
#include "render/frame/error_budget.h"

#include "render/light/optical.h"
#include "render/frame/render_private.h"

enum { probes_a_block = 64, blocks_most = 12, candidates_a_probe = 4, tables_probes = 48,
       tables_blocks = 4 /* of them, for as many threads */ };
static const double pixels_a_probe = 1200; /* 16 rays each: 1.3 % of a frame of one ray a pixel */
static const uint32_t stream = 0x6275;     /* "bu" */

typedef struct Candidate {
    uint16_t x, y;
    double   area;                          /* px that it stands for */
    double   weight;                        /* to be drawn */
    unsigned planes;                        /* 1 << plane: those that its own samples do not speak for */
    float    value[picture_plane_count], contrast[picture_plane_count];
} Candidate;

typedef struct ProbeOf {
    int    candidate;
    double stands_for; /* px */
} ProbeOf;

typedef enum ProbePass { PASS_RAYS, PASS_BASE, PASS_COARSE } ProbePass;

struct ProbeTask {
    bool           of_tables; /* asked directly, and nothing else */
    ProbePass      pass;
    int            count;
    const ProbeOf *probe; /* [count] */
    const Candidate *candidate;
    float          base[picture_plane_count][probes_a_block];
    double         image_px[probes_a_block];   /* how far the ground moves on the image */
    double         sampling[picture_plane_count], detail[picture_plane_count], tables[picture_plane_count];
    double         tables_px;
};

typedef struct Budget {
    const Job  *job;
    int         field_px, columns, rows, candidates, probes, blocks, n;
    bool        law;       /* more rays than the pixels have are too many: by the law */
    Candidate  *candidate;
    ProbeOf    *probe, tables_probe[tables_probes];
    ProbeTask  *task;      /* [blocks + tables_blocks] */
    Veils     (*direct)[AIR_BAND_COUNT]; /* [workers] */
} Budget;

static Band band_of(int plane)
{
    return plane == picture_mwir    ? BAND_MWIR
           : plane == picture_lwir  ? BAND_LWIR
           : plane == picture_radar ? BAND_RADAR
                                    : BAND_OPTICAL;
}

double plane_contrast(const Picture *p, const float *value, int x, int y)
{
    const size_t at = (size_t)y * (size_t)p->width + (size_t)x, row = (size_t)p->width;
    const double here = (double)value[at];
    double       sum = 0;
    int          count = 0;
    if (x > 0) sum += (value[at - 1] - here) * (value[at - 1] - here), count++;
    if (x + 1 < p->width) sum += (value[at + 1] - here) * (value[at + 1] - here), count++;
    if (y > 0) sum += (value[at - row] - here) * (value[at - row] - here), count++;
    if (y + 1 < p->height) sum += (value[at + row] - here) * (value[at + row] - here), count++;
    return count > 0 ? sum / count : 0;
}

double error_budget_kelvin(const PlanckTable *planck, double mean_w_m2_sr, double rms_w_m2_sr)
{
    const double step = 1e-3 * mean_w_m2_sr;
    if (!(mean_w_m2_sr > 0)) return NAN;
    return rms_w_m2_sr * (planck_table_temp(planck, mean_w_m2_sr + step) - planck_table_temp(planck, mean_w_m2_sr)) /
           step;
}

/* ---- which pixels ---------------------------------------------------------------------------- */

/* Planes whose error at a pixel is not told by its own samples; see refine_tile. */
static unsigned planes_to_ask(const Job *job, size_t px)
{
    const unsigned flags = job->refine ? job->refine[px] : 0;
    unsigned       planes = 0;
    if (flags & refine_all || (job->picture->covered && job->picture->covered[px] > 0)) return 0;
    for (int k = 0; k < picture_plane_count; k++) {
        const bool sunlit = band_of(k) == BAND_OPTICAL || band_of(k) == BAND_MWIR;
        if (picture_plane(job->picture, k) && !(flags & refine_sun && !(flags & refine_step) && sunlit))
            planes |= 1u << k;
    }
    return planes;
}

/* A row of fields. */
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
        c->x    = (uint16_t)(x0 + (int)(random_uniform(1, stream, 0, 2 * field) * w));
        c->y    = (uint16_t)(y0 + (int)(random_uniform(1, stream, 0, 2 * field + 1) * h));
        c->area = (double)w * h;
        const size_t px = pixel_index(b->job, c->x, c->y);
        c->planes = planes_to_ask(b->job, px);
        for (int k = 0; k < picture_plane_count; k++) {
            const float *value = picture_plane(p, k);
            if (!value) continue;
            c->value[k]    = value[px];
            c->contrast[k] = (float)plane_contrast(p, value, c->x, c->y);
        }
    }
}

/* By weight, in steps. Returns how many. */
static int draw(ProbeOf *out, int most, const Budget *b)
{
    double sum = 0, gone = 0;
    int    count = 0;
    for (int i = 0; i < b->candidates; i++) sum += b->candidate[i].weight * b->candidate[i].area;
    if (!(sum > 0)) return 0;
    const double step = sum / most;
    double       to = 0.5 * step;
    for (int i = 0; i < b->candidates; i++) {
        const Candidate *c = &b->candidate[i];
        int              drawn = 0;
        for (gone += c->weight * c->area; to < gone; to += step) drawn++;
        if (drawn > 0 && count < most) out[count++] = (ProbeOf){i, drawn * step / c->weight};
    }
    return count;
}

/* By the root of what it differs by, over each plane's mean, and by no less than an even share. */
static int draw_probes(Budget *b, const double mean[picture_plane_count])
{
    double sum = 0, area = 0;
    for (int i = 0; i < b->candidates; i++) {
        Candidate *c = &b->candidate[i];
        double     relative = 0;
        c->weight = 0;
        if (!c->planes) continue;
        for (int k = 0; k < picture_plane_count; k++)
            if (c->planes >> k & 1 && mean[k] != 0) relative += (double)c->contrast[k] / (mean[k] * mean[k]);
        c->weight = sqrt(relative);
        sum += c->weight * c->area;
        area += c->area;
    }
    if (!(area > 0)) return 0;
    const double even = sum > 0 ? sum / area : 1;
    for (int i = 0; i < b->candidates; i++)
        if (b->candidate[i].planes) b->candidate[i].weight += even;
    return draw(b->probe, b->probes, b);
}

/* By how bright it is, over each plane's mean, and no less than evenly: what tables do is in proportion to that, and a
 * few hot pixels can hold half of a thermal band. */
static int draw_tables(Budget *b, const double mean[picture_plane_count])
{
    for (int i = 0; i < b->candidates; i++) {
        Candidate *c = &b->candidate[i];
        c->weight = c->planes ? 1 : 0;
        for (int k = 0; k < picture_radar; k++)
            if (c->planes >> k & 1 && mean[k] > 0) c->weight = fmax(c->weight, (double)c->value[k] / mean[k]);
    }
    return draw(b->tables_probe, tables_probes, b);
}

/* ---- the ground at every second post ----------------------------------------------------------- */

static double post_m(const ElevationLevel *l, int i, int j)
{
    return l->z0_m + l->step_m * l->post[(size_t)j * (size_t)l->nx + (size_t)i];
}

/* A cell of `stride` posts: height at (x, y), and normal. */
static double cell_height(double n_enu[3], const ElevationLevel *l, double fx, double fy, int i, int j, int stride)
{
    const double u = (fx - i) / stride, v = (fy - j) / stride;
    const double sw = post_m(l, i, j), se = post_m(l, i + stride, j), nw = post_m(l, i, j + stride),
                 ne = post_m(l, i + stride, j + stride);
    const double du = u >= v ? se - sw : ne - nw, dv = u >= v ? ne - se : nw - sw, s = l->spacing_m * stride;
    const double length = sqrt(du * du + dv * dv + s * s);
    n_enu[0] = -du / length, n_enu[1] = -dv / length, n_enu[2] = s / length;
    return sw + u * du + v * dv;
}

bool error_budget_coarser(double turn_enu[3], double *rise_m, const Elevation *elevation, double x_m, double y_m)
{
    for (int n = 0; n < elevation->level_count; n++) {
        const ElevationLevel *l = &elevation->level[n];
        const double fx = (x_m - l->x0_m) / l->spacing_m, fy = (y_m - l->y0_m) / l->spacing_m;
        double       fine[3], coarse[3];
        if (!(fx >= 0 && fy >= 0 && fx <= l->nx - 1 && fy <= l->ny - 1)) continue;
        const int i = (int)fx, j = (int)fy;
        if (i / 2 * 2 + 2 > l->nx - 1 || j / 2 * 2 + 2 > l->ny - 1) return false;
        *rise_m = cell_height(coarse, l, fx, fy, i / 2 * 2, j / 2 * 2, 2) - cell_height(fine, l, fx, fy, i, j, 1);
        v3_sub(turn_enu, coarse, fine);
        return true;
    }
    return false;
}

/* ---- a block of probes -------------------------------------------------------------------------- */

static const Candidate *candidate_of(const ProbeTask *t, int p) { return &t->candidate[t->probe[p].candidate]; }

double error_budget_law(const float *out, int n)
{
    double sum = 0;
    for (int row = 0; row < n; row++)
        for (int column = 0; column < n; column++) {
            const double here = (double)out[row * n + column];
            if (column + 1 < n) sum += (out[row * n + column + 1] - here) * (out[row * n + column + 1] - here);
            if (row + 1 < n) sum += (out[(row + 1) * n + column] - here) * (out[(row + 1) * n + column] - here);
        }
    return mean_law * sum / ((double)n * n * n * n);
}

void law_take(Scratch *s, const Job *job, int plane)
{
    const Block *block = &s->block;
    const int    samples = block->n * block->n;
    for (int p = 0; p < block->pixels; p++) {
        const double open =
            job->picture->covered ? 1 - (double)job->picture->covered[pixel_index(job, block->x[p], block->y[p])] : 1;
        s->law[plane] += open * open * error_budget_law(s->out + p * samples, block->n);
    }
}

void probe_take(Scratch *s, const Job *job, int plane)
{
    ProbeTask *t = s->block.probe;
    const int  n = s->block.n, samples = n * n;
    const bool law = t->pass == PASS_RAYS && n == job->request->samples;
    for (int p = 0; p < t->count; p++) {
        const Candidate *c = candidate_of(t, p);
        if (t->pass == PASS_BASE) {
            t->base[plane][p] = s->out[p];
            continue;
        }
        if (!(c->planes >> plane & 1)) continue;
        double square, sum = 0;
        if (law) {
            square = error_budget_law(s->out + p * samples, n);
        } else if (t->pass == PASS_RAYS) {
            for (int k = 0; k < samples; k++) sum += (double)s->out[p * samples + k];
            square = sum / samples - (double)c->value[plane];
            square *= square;
        } else {
            const double moved = t->image_px[p] * t->image_px[p], turned = (double)(s->out[p] - t->base[plane][p]);
            square = turned * turned + (double)c->contrast[plane] * moved / (1 + moved);
        }
        *(t->pass == PASS_RAYS ? &t->sampling[plane] : &t->detail[plane]) += t->probe[p].stands_for * square;
    }
}

/* Turns the block's hits of ground as their posts, twice as far apart, would. */
static void coarsen(Scratch *s, const Job *job, ProbeTask *t)
{
    const World *world = job->world;
    for (int p = 0; p < t->count; p++) {
        double turn_enu[3], rise_m;
        t->image_px[p] = 0;
        if (!world->landscape || !s->hits.surface[p] ||
            !error_budget_coarser(turn_enu, &rise_m, &world->landscape->elevation, s->hits.p_enu[0][p],
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

/* The first hits of the block, directly. Those of its own pixels are in radiance and base. */
static void ask_directly(Scratch *s, const Job *job, ProbeTask *t, Veils direct[AIR_BAND_COUNT], int count)
{
    static const int band_at[3] = {optical_channel_r, optical_channel_g, optical_channel_b};
    const RenderRequest *request = job->request;
    const Materials     *materials = &job->world->materials;
    const unsigned       air_bands = render_air_bands(s->block.bands, request->optical);
    const int            all = s->hits.count;
    s->hits.count = s->rays.count = count;
    air_veils_directly(direct, job->air, air_bands, &s->hits, &s->rays, s->temp_k, s->air);
    for (int plane = 0; plane < picture_plane_count; plane++) {
        if (!picture_plane(job->picture, plane) || plane == picture_radar) continue;
        AirBand b = plane == picture_mwir ? AIR_MWIR : AIR_LWIR;
        if (band_of(plane) == BAND_OPTICAL)
            b = request->optical == OPTICAL_RGB ? (AirBand)band_at[plane - picture_optical]
                                                : request->optical == OPTICAL_NIR ? AIR_NIR : AIR_PAN;
        float        open_w_m2[hits_capacity];
        const float *around = request->sky_samples > 0 ? s->gathered.w_m2[b] : NULL;
        if (!around && s->any_open) {
            const double level_w_m2 = b >= AIR_MWIR ? job->air->light.ground_w_m2_sr[b] * pi_rad
                                                    : optical_ground_w_m2((int)b, job->air, materials);
            for (int i = 0; i < count; i++) {
                const double n_enu[3] = {s->hits.n_enu[0][i], s->hits.n_enu[1][i], s->hits.n_enu[2][i]};
                open_w_m2[i] = (float)((double)s->open.factor[b][i] * (daylight_on_plane(&job->air->light, b, n_enu) +
                                                                       level_w_m2 * 0.5 * (1 - n_enu[2])));
            }
            around = open_w_m2;
        }
        float       *out = s->radiance[b];
        if (b >= AIR_MWIR)
            thermal_shade(out, band_of(plane), job->air, materials, &s->hits, &s->rays, s->material, s->temp_k,
                          s->shadow, around, &direct[b], NULL);
        else
            optical_shade(out, (int)b, job->air, materials, &s->hits, &s->rays, s->material, s->texture[b], s->shadow,
                          around, &direct[b], NULL);
        veil_apply(out, &s->veil, b == AIR_MWIR ? effect_band_mwir : b == AIR_LWIR ? effect_band_lwir : (int)b, count);
        for (int p = 0; p < count; p++) {
            const double apart = (double)(out[p] - t->base[plane][p]);
            t->tables[plane] += t->probe[p].stands_for * apart * apart;
        }
    }
    for (int p = 0; p < count; p++) t->tables_px += t->probe[p].stands_for;
    s->hits.count = s->rays.count = all;
}

static void set_block(Scratch *s, const Job *job, ProbeTask *t, ProbePass pass, int n)
{
    t->pass  = pass;
    s->block = (Block){.n = n, .pixels = t->count, .sign = 1, .bands = job->request->bands, .probe = t};
    for (int p = 0; p < t->count; p++) {
        s->block.x[p] = candidate_of(t, p)->x;
        s->block.y[p] = candidate_of(t, p)->y;
    }
}

static void probe_task(void *user, int worker, int index)
{
    const Budget *b = user;
    const Job    *job = b->job;
    ProbeTask    *t = &b->task[index];
    Scratch      *s = job->scratch[worker];
    double        box[4] = {INFINITY, INFINITY, 0, 0};
    for (int p = 0; p < t->count; p++) {
        const Candidate *c = candidate_of(t, p);
        box[0] = fmin(box[0], c->x), box[1] = fmin(box[1], c->y);
        box[2] = fmax(box[2], c->x + 1), box[3] = fmax(box[3], c->y + 1);
    }
    const int all = visibility_block_entities(s->list, job->visibility, &job->request->view, box[0], box[1], box[2],
                                              box[3], job->request->hidden_entity, &s->counters.visibility);
    int       listed = 0;
    for (int k = 0; k < all; k++)
        if (!job->is_small[s->list[k]]) s->list[listed++] = s->list[k];
    if (t->of_tables) {
        set_block(s, job, t, PASS_BASE, 1);
        render_block(s, job, listed, NULL);
        ask_directly(s, job, t, b->direct[worker], t->count);
        return;
    }
    /* as many pixels at a time as a block of samples holds */
    const ProbeOf *first = t->probe;
    const int      count = t->count, piece = hits_capacity / (b->n * b->n);
    for (int p = 0; p < count; p += piece) {
        t->probe = first + p;
        t->count = count - p < piece ? count - p : piece;
        set_block(s, job, t, PASS_RAYS, b->n);
        render_block(s, job, listed, NULL);
    }
    t->probe = first, t->count = count;
    set_block(s, job, t, PASS_BASE, 1);
    render_block(s, job, listed, NULL);
    coarsen(s, job, t);
    t->pass = PASS_COARSE;
    shade_block(s, job);
}

/* ---- the whole ---------------------------------------------------------------------------------- */

static Status plan(Budget *b, Pool *pool, Arena *arena)
{
    const Picture *p = b->job->picture;
    const int      samples = b->job->request->samples;
    const double   pixels = (double)p->width * p->height;
    b->law      = 4 * samples > 16;
    b->n        = b->law ? samples : 4 * samples;
    b->blocks   = (int)clamp(ceil(pixels / pixels_a_probe / probes_a_block), 1, blocks_most);
    b->probes   = b->blocks * probes_a_block;
    b->field_px = (int)fmax(floor(sqrt(pixels / (b->probes * candidates_a_probe))), 1);
    b->columns  = (p->width + b->field_px - 1) / b->field_px;
    b->rows     = (p->height + b->field_px - 1) / b->field_px;
    b->candidates = b->columns * b->rows;
    b->candidate = arena_alloc(arena, (size_t)b->candidates, sizeof *b->candidate);
    b->probe     = arena_alloc(arena, (size_t)b->probes, sizeof *b->probe);
    b->task      = arena_alloc(arena, (size_t)b->blocks + tables_blocks, sizeof *b->task);
    b->direct    = arena_alloc(arena, (size_t)pool_threads(pool), sizeof *b->direct);
    return b->candidate && b->probe && b->task && b->direct ? STATUS_OK : STATUS_NO_MEMORY;
}

/* Blocks of probes, then those of tables; returns how many there are of both. */
static int deal(Budget *b, int probes, int of_tables)
{
    const int a_block = (of_tables + tables_blocks - 1) / tables_blocks;
    int       tasks = 0;
    for (int first = 0; first < probes; first += probes_a_block)
        b->task[tasks++] = (ProbeTask){.probe = b->probe + first, .candidate = b->candidate,
                                       .count = probes - first < probes_a_block ? probes - first : probes_a_block};
    for (int first = 0; first < of_tables; first += a_block)
        b->task[tasks++] = (ProbeTask){.of_tables = true, .probe = b->tables_probe + first, .candidate = b->candidate,
                                       .count = of_tables - first < a_block ? of_tables - first : a_block};
    return tasks;
}

Status error_budget(Job *job, Pool *pool, Arena *arena)
{
    const double start_s = wall_clock_s();
    Picture     *picture = job->picture;
    const double pixels = (double)picture->width * picture->height;
    Budget       b = {.job = job};
    ErrorBudget *out = arena_alloc(arena, 1, sizeof *out);
    Status       status = out ? plan(&b, pool, arena) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    pool_run(pool, b.rows, candidate_task, &b);
    for (int i = 0; i < b.candidates; i++)
        for (int k = 0; k < picture_plane_count; k++)
            out->mean[k] += (double)b.candidate[i].value[k] * b.candidate[i].area;
    for (int k = 0; k < picture_plane_count; k++) out->mean[k] /= pixels;
    out->probes = draw_probes(&b, out->mean);
    const int tasks = deal(&b, out->probes, draw_tables(&b, out->mean));
    pool_run(pool, tasks, probe_task, &b);

    const int tiles = job->law ? job->tiles_x * job->tiles_y : 0;
    double    tables_px = 0;
    for (int t = 0; t < tasks; t++) tables_px += b.task[t].tables_px;
    for (int k = 0; k < picture_plane_count; k++) {
        double sampling = job->footprint_law[k], detail = 0, tables = 0;
        for (int t = 0; t < tiles; t++) sampling += job->law[t][k];
        for (int t = 0; t < tasks; t++) {
            sampling += b.task[t].sampling[k];
            detail += b.task[t].detail[k];
            tables += b.task[t].tables[k];
        }
        const bool there = picture_plane(picture, k) != NULL;
        out->sampling[k]        = there ? sqrt(sampling / pixels) : NAN;
        out->level_of_detail[k] = there ? sqrt(detail / pixels) : NAN;
        out->tables[k]          = there ? sqrt(tables_px > 0 ? tables / tables_px : 0) : NAN;
        if (!there) out->mean[k] = NAN;
    }
    out->ms = 1e3 * (wall_clock_s() - start_s);
    picture->budget = out;
    return STATUS_OK;
}
