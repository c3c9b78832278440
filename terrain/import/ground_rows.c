/* terrain/import/ground_rows.c: samples rasters at rows of cells of ENU, on all threads. */
#include "terrain/import/terrain_import_private.h"

#include <stdlib.h>

enum { node_cells = 64, rows_a_task = 16 };

/* ---- where cells lie ------------------------------------------------------------------------- */

/* Pixels of cells' corners, exact at every node_cells-th corner, on the ground itself; linear between. */
typedef struct Nodes {
    int     nx, ny;
    double *x, *y;  /* [ny][nx] pixels */
    int     box[4]; /* box of pixels: x0, y0, x1, y1 */
} Nodes;

/* Returns false when the raster has nothing here, or there is no memory (*status). */
static bool nodes_create(Nodes *out, Status *status, const Raster *raster, const CellRows *cells,
                         const GroundView *view)
{
    Nodes     n = {.nx = (cells->nx - 1) / node_cells + 2, .ny = (cells->rows - 1) / node_cells + 2};
    const int count = n.nx * n.ny;
    n.x = malloc(2 * (size_t)count * sizeof *n.x);
    if (!n.x) {
        *status = STATUS_NO_MEMORY;
        return false;
    }
    n.y = n.x + count;
    for (int k = 0; k < count; k++) {
        double p_enu[3] = {cells->x0_m + k % n.nx * node_cells * cells->cell_m,
                           cells->y0_m + k / n.nx * node_cells * cells->cell_m, 0},
               p_ecef[3];
        Geodetic place = {NAN, NAN, 0};
        p_enu[2] = view->z(view->z_user, p_enu[0], p_enu[1]);
        ecef_from_enu(p_ecef, view->frame, p_enu);
        (void)geodetic_from_ecef(&place, p_ecef);
        n.x[k] = place.lon_rad;
        n.y[k] = place.lat_rad;
    }
    raster_px_from_earth(raster, count, n.x, n.y);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < count; k++) {
        if (!isfinite(n.x[k]) || !isfinite(n.y[k])) continue;
        low[0] = fmin(low[0], n.x[k]);
        high[0] = fmax(high[0], n.x[k]);
        low[1] = fmin(low[1], n.y[k]);
        high[1] = fmax(high[1], n.y[k]);
    }
    if (!(high[0] > 0 && high[1] > 0 && low[0] < raster->width && low[1] < raster->height)) {
        free(n.x);
        return false;
    }
    n.box[0] = (int)fmax(floor(low[0]) - 2, 0);
    n.box[1] = (int)fmax(floor(low[1]) - 2, 0);
    n.box[2] = (int)fmin(ceil(high[0]) + 3, raster->width);
    n.box[3] = (int)fmin(ceil(high[1]) + 3, raster->height);
    *out = n;
    return n.box[2] - n.box[0] > 0 && n.box[3] - n.box[1] > 0 ? true : (free(n.x), false);
}

/* Pixels under the centres of a run of cells of row j, from cell i on, all within one cell of the nodes. */
static void places(double *x, double *y, const Nodes *n, int i, int j, int count)
{
    const int     c = i / node_cells, r = j / node_cells;
    const double  v = (j % node_cells + 0.5) / node_cells;
    const double *of[2] = {n->x + (size_t)r * (size_t)n->nx + (size_t)c, n->y + (size_t)r * (size_t)n->nx + (size_t)c};
    for (int k = 0; k < 2; k++) {
        const double *a = of[k], *b = a + n->nx;
        const double  west = a[0] + v * (b[0] - a[0]), east = a[1] + v * (b[1] - a[1]);
        double       *to = k ? y : x;
        for (int m = 0; m < count; m++) to[m] = west + (i % node_cells + m + 0.5) / node_cells * (east - west);
    }
}

/* ---- reading --------------------------------------------------------------------------------- */

typedef struct Job {
    const Raster     *raster;
    const CellRows   *cells;
    const GroundView *view;
    Nodes             nodes;
    int               band, bands;
    uint8_t          *bytes, *valid; /* pixels of the box */
    float            *number;
    void             *out;
    Status           *status;
} Job;

static int box_w(const Job *job) { return job->nodes.box[2] - job->nodes.box[0]; }

static void read_rows(void *user, int worker, int task)
{
    const Job *job = user;
    const int *box = job->nodes.box, block = job->raster->row_block;
    (void)worker;
    const int    from = (box[1] / block + task) * block, to = from + block;
    const int    y0 = from > box[1] ? from : box[1], y1 = to < box[3] ? to : box[3];
    const size_t at = (size_t)(y0 - box[1]) * (size_t)box_w(job);
    if (job->bytes)
        job->status[task] =
            raster_read_bytes(job->bytes + at * (size_t)job->bands, job->valid + at, job->raster, job->band, job->bands,
                              (RasterWindow){box[0], y0, box_w(job), y1 - y0}, job->view->key);
    else
        job->status[task] = raster_read(job->number + at, job->raster, job->band,
                                        (RasterWindow){box[0], y0, box_w(job), y1 - y0}, job->view->key);
}

typedef enum Samples { AS_BYTES, AS_NUMBERS, AS_THEY_ARE } Samples;

typedef struct Sampling {
    int       most_bands;
    Samples   samples;
    PoolTask *sample; /* samples some rows of cells */
} Sampling;

/* Samples one raster after the other: reads its box, then samples the rows of cells. */
static Status each_raster(void *out, const RasterSet *set, int band, const Sampling *how, const CellRows *cells,
                          const GroundView *view)
{
    const Samples samples = how->samples;
    const int     most_bands = how->most_bands;
    Status        status = STATUS_OK;
    for (int k = 0; k < set->count && status == STATUS_OK; k++) {
        const Raster *raster = &set->raster[k];
        const bool    numbers = samples == AS_NUMBERS || (samples == AS_THEY_ARE && !raster->bytes);
        Job           job = {.raster = raster, .cells = cells, .view = view, .band = band > 0 ? band : 1, .out = out};
        job.bands = raster->bands >= most_bands ? most_bands : 1;
        if (!nodes_create(&job.nodes, &status, raster, cells, view)) continue;
        const size_t count = (size_t)box_w(&job) * (size_t)(job.nodes.box[3] - job.nodes.box[1]);
        const int    tasks = (job.nodes.box[3] - 1) / raster->row_block - job.nodes.box[1] / raster->row_block + 1;
        job.status = calloc((size_t)tasks, sizeof *job.status);
        if (numbers) job.number = malloc(count * sizeof *job.number);
        else {
            job.bytes = malloc(count * (size_t)job.bands);
            job.valid = malloc(count);
        }
        if (!job.status || !(numbers ? job.number != NULL : job.bytes && job.valid)) status = STATUS_NO_MEMORY;
        if (status == STATUS_OK && !pool_run_unless_stopped(view->pool, tasks, read_rows, &job)) status = STATUS_IO;
        for (int n = 0; status == STATUS_OK && n < tasks; n++) status = job.status[n];
        if (status == STATUS_OK &&
            !pool_run_unless_stopped(view->pool, (cells->rows + rows_a_task - 1) / rows_a_task, how->sample, &job))
            status = STATUS_IO;
        free(job.status);
        free(job.bytes);
        free(job.valid);
        free(job.number);
        free(job.nodes.x);
    }
    return status;
}

/* ---- sampling -------------------------------------------------------------------------------- */

/* Index of the pixel under a place within the box; -1: the place is beyond the box. */
static inline int64_t pixel_of(const Job *job, double x, double y)
{
    const int *box = job->nodes.box;
    if (!(x >= box[0] && y >= box[1] && x < box[2] && y < box[3])) return -1;
    return (int64_t)((int)y - box[1]) * box_w(job) + ((int)x - box[0]);
}

static void sample_codes(void *user, int worker, int task)
{
    const Job *job = user;
    double     x[node_cells], y[node_cells];
    (void)worker;
    for (int j = task * rows_a_task; j < (task + 1) * rows_a_task && j < job->cells->rows; j++)
        for (int i0 = 0; i0 < job->cells->nx; i0 += node_cells) {
            const int count = job->cells->nx - i0 < node_cells ? job->cells->nx - i0 : node_cells;
            uint16_t *to = (uint16_t *)job->out + (size_t)j * (size_t)job->cells->nx + (size_t)i0;
            places(x, y, &job->nodes, i0, j, count);
            for (int i = 0; i < count; i++) {
                const int64_t at = pixel_of(job, x[i], y[i]);
                if (at < 0 || to[i] > 1)
                    continue; /* a value of 1 stands for code 0, by which most files say that they know nothing */
                const float code = !job->bytes ? job->number[at] : job->valid[at] ? (float)job->bytes[at] : NAN;
                if (code >= 0 && code < surface_codes_most && (code > 0 || to[i] == 0)) to[i] = (uint16_t)(code + 1);
            }
        }
}

static void sample_numbers(void *user, int worker, int task)
{
    const Job *job = user;
    double     x[node_cells], y[node_cells];
    (void)worker;
    for (int j = task * rows_a_task; j < (task + 1) * rows_a_task && j < job->cells->rows; j++)
        for (int i0 = 0; i0 < job->cells->nx; i0 += node_cells) {
            const int count = job->cells->nx - i0 < node_cells ? job->cells->nx - i0 : node_cells;
            float    *to = (float *)job->out + (size_t)j * (size_t)job->cells->nx + (size_t)i0;
            places(x, y, &job->nodes, i0, j, count);
            for (int i = 0; i < count; i++) {
                const int64_t at = pixel_of(job, x[i], y[i]);
                if (at >= 0 && isnan(to[i])) to[i] = job->number[at];
            }
        }
}

static struct Codes {
    float   linear[256];
    uint8_t of_linear[4096];
} codes; /* is filled in before any thread is at work */

static void codes_fill(void)
{
    for (int k = 0; k < 256; k++) codes.linear[k] = photo_linear((uint8_t)k);
    for (int k = 0; k < 4096; k++) codes.of_linear[k] = photo_encoded((float)k / 4095);
}

/* Linear light of the pixels about a place; returns false when one of them is not valid. */
static inline bool light_at(float sum[3], const Job *job, double x, double y, float share)
{
    const int   *box = job->nodes.box, w = box_w(job), h = box[3] - box[1], bands = job->bands;
    const double px = clamp(x - box[0] - 0.5, 0, w - 1), py = clamp(y - box[1] - 0.5, 0, h - 1);
    const int    a = (int)px < w - 1 ? (int)px : w > 1 ? w - 2 : 0, b = (int)py < h - 1 ? (int)py : h > 1 ? h - 2 : 0;
    const size_t e = w > 1, n = h > 1 ? (size_t)w : 0, at = (size_t)b * (size_t)w + (size_t)a;
    if (!(job->valid[at] && job->valid[at + e] && job->valid[at + n] && job->valid[at + n + e])) return false;
    const float    u = (float)(px - a), v = (float)(py - b);
    const float    weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    const uint8_t *q = job->bytes + at * (size_t)bands;
    for (int c = 0; c < 3; c++) {
        const size_t k = bands == 3 ? (size_t)c : 0;
        sum[c] += share * (weight[0] * codes.linear[q[k]] + weight[1] * codes.linear[q[e * (size_t)bands + k]] +
                           weight[2] * codes.linear[q[n * (size_t)bands + k]] +
                           weight[3] * codes.linear[q[(n + e) * (size_t)bands + k]]);
    }
    return true;
}

static void sample_colours(void *user, int worker, int task)
{
    const Job    *job = user;
    const Raster *raster = job->raster;
    const double  posting_m = fmin(raster->posting_m[0], raster->posting_m[1]);
    const int     side =
        (int)clamp(job->cells->cell_m / posting_m + 0.25, 1, 16); /* number of samples in a cell, each way */
    double x[node_cells], y[node_cells];
    (void)worker;
    for (int j = task * rows_a_task; j < (task + 1) * rows_a_task && j < job->cells->rows; j++)
        for (int i0 = 0; i0 < job->cells->nx; i0 += node_cells) {
            const int count = job->cells->nx - i0 < node_cells ? job->cells->nx - i0 : node_cells;
            uint8_t  *to = (uint8_t *)job->out + 4 * ((size_t)j * (size_t)job->cells->nx + (size_t)i0);
            places(x, y, &job->nodes, i0, j, count);
            for (int i = 0; i < count; i++, to += 4) {
                float sum[3] = {0};
                bool  ok = !to[3] && x[i] >= 0 && y[i] >= 0 && x[i] < raster->width && y[i] < raster->height;
                if (ok && side == 1) ok = light_at(sum, job, x[i], y[i], 1);
                else
                    for (int s = 0; ok && s < side * side; s++)
                        ok = light_at(sum, job, x[i] + s % side - 0.5 * (side - 1), y[i] + s / side - 0.5 * (side - 1),
                                      1.0f / (float)(side * side));
                if (!ok) continue;
                for (int c = 0; c < 3; c++) to[c] = codes.of_linear[(int)(4095 * (sum[c] < 1 ? sum[c] : 1) + 0.5f)];
                to[3] = 255;
            }
        }
}

Status ground_rows_codes(uint16_t *code, const RasterSet *set, int band, const CellRows *cells, const GroundView *view)
{
    return each_raster(code, set, band, &(Sampling){1, AS_THEY_ARE, sample_codes}, cells, view);
}

Status ground_rows_numbers(float *value, const RasterSet *set, int band, const CellRows *cells, const GroundView *view)
{
    return each_raster(value, set, band, &(Sampling){1, AS_NUMBERS, sample_numbers}, cells, view);
}

Status ground_rows_colours(uint8_t *rgba, const RasterSet *set, const CellRows *cells, const GroundView *view)
{
    codes_fill();
    return each_raster(rgba, set, 1, &(Sampling){3, AS_BYTES, sample_colours}, cells, view);
}
