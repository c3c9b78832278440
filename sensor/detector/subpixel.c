/* sensor/detector/subpixel.c: corrects small targets for their subpixel positions, from their cells. */
#include "sensor/detector/subpixel_private.h"

#include "sensor/detector/blur_private.h"
#include "sensor/detector/transform.h"

#include <assert.h>
#include <stdlib.h>

enum {
    nodes_per_px = 8,
    reach_px = 8, /* of the difference of point spreads, each way */
    side = 2 * reach_px + 1,
    period_px = 32,                  /* period of both computed point spreads; tails beyond are aliased */
    fine = period_px * nodes_per_px, /* samples of the continuous one */
    fine_half = fine / 2 + 1,
    coarse_half = period_px / 2 + 1,
    phases = nodes_per_px * nodes_per_px,
    /* nodes of the pixels covered by the largest small target, its length plus one, and one beyond each
     * end */
    most_nodes = (small_target_px + 3) * (small_target_long_px + 3) * phases,
    most_shares = nodes_per_px + 2, /* nodes that share what lies within one pixel */
};

typedef struct Kernel {
    double value[side][side];
} Kernel;

struct SubPixel {
    MtfChain   chain;
    double     smear_px[2];  /* smear of the present kernels; NaN: none yet */
    double    *true_pass;    /* [fine][fine_half]: optics, footprint, jitter; over the nodes' own and the period */
    double    *pixel_pass;   /* [period_px][coarse_half]: transfer of the blur without smear, over the period */
    double    *fine_value;   /* [fine][fine]: continuous point spread, px^-2 */
    double    *coarse_value; /* [period_px][period_px] */
    double    *fine_wave, *coarse_wave; /* spectra, in pairs */
    Transform *to_fine, *to_coarse;
    Kernel    *kernel; /* [phases]: node's row, column within its pixel */
    double    *node;   /* [most_nodes] */
};

/* The frequency of an index of a transform of n points over period_px. */
static double frequency(int k, int n) { return (double)(k <= n / 2 ? k : k - n) / period_px; }

/* A target's light is distributed to nodes by hat functions 2 / nodes_per_px wide. */
static double hat_pass(double f)
{
    const double sinc = mtf_sinc(f / nodes_per_px);
    return sinc * sinc;
}

static void make_passes(SubPixel *s)
{
    const MtfChain *c = &s->chain;
    const double    area = 1.0 / (period_px * period_px);
    for (int j = 0; j < fine; j++)
        for (int k = 0; k < fine_half; k++) {
            const double fx = frequency(k, fine), fy = frequency(j, fine);
            s->true_pass[j * fine_half + k] = area * mtf_optics(c, fx, fy) * mtf_sinc(c->footprint_px * fx) *
                                              mtf_sinc(c->footprint_px * fy) * mtf_jitter(c, fx, fy) /
                                              (hat_pass(fx) * hat_pass(fy));
        }
    for (int j = 0; j < period_px; j++)
        for (int k = 0; k < coarse_half; k++) {
            const double fx = blur_tapered(frequency(k, period_px)), fy = blur_tapered(frequency(j, period_px));
            s->pixel_pass[j * coarse_half + k] =
                area * mtf_optics(c, fx, fy) * mtf_footprint(c, fx, fy) * mtf_jitter(c, fx, fy);
        }
}

Status subpixel_create(SubPixel **out, const MtfChain *chain)
{
    SubPixel *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->chain = *chain;
    s->smear_px[0] = s->smear_px[1] = NAN;
    s->true_pass = malloc(sizeof(double) * fine * fine_half);
    s->pixel_pass = malloc(sizeof(double) * period_px * coarse_half);
    s->fine_value = transform_alloc(fine * fine);
    s->coarse_value = transform_alloc(period_px * period_px);
    s->fine_wave = transform_alloc(2 * fine * fine_half);
    s->coarse_wave = transform_alloc(2 * period_px * coarse_half);
    s->kernel = malloc(phases * sizeof *s->kernel);
    s->node = malloc(most_nodes * sizeof *s->node);
    Status status = STATUS_NO_MEMORY;
    if (s->true_pass && s->pixel_pass && s->fine_value && s->coarse_value && s->fine_wave && s->coarse_wave &&
        s->kernel && s->node)
        status = transform_create(&s->to_fine, TRANSFORM_WAVES_BACK, fine, fine, s->fine_wave, s->fine_value);
    if (status == STATUS_OK)
        status = transform_create(&s->to_coarse, TRANSFORM_WAVES_BACK, period_px, period_px, s->coarse_wave,
                                  s->coarse_value);
    if (status != STATUS_OK) {
        subpixel_destroy(s);
        return status;
    }
    make_passes(s);
    *out = s;
    return STATUS_OK;
}

void subpixel_destroy(SubPixel *s)
{
    if (!s) return;
    transform_destroy(s->to_fine);
    transform_destroy(s->to_coarse);
    free(s->true_pass);
    free(s->pixel_pass);
    transform_free(s->fine_value);
    transform_free(s->coarse_value);
    transform_free(s->fine_wave);
    transform_free(s->coarse_wave);
    free(s->kernel);
    free(s->node);
    free(s);
}

/* ---- the kernels of a smear -------------------------------------------------------------------- */

/* The frequencies f and -f are the same at Nyquist, so the transfer of an oblique smear is averaged over both. */
static double smear_pass(const double smear_px[2], double fx, double fy, bool both)
{
    const double along = smear_px[0] * fx, down = smear_px[1] * fy;
    return both ? 0.5 * (mtf_sinc(along + down) + mtf_sinc(along - down)) : mtf_sinc(along + down);
}

static int wrapped(int i, int n) { return (i % n + n) % n; }

static void make_kernels(SubPixel *s, const double smear_px[2])
{
    if (s->smear_px[0] == smear_px[0] && s->smear_px[1] == smear_px[1]) return;
    memcpy(s->smear_px, smear_px, sizeof s->smear_px);
    for (int j = 0, i = 0; j < fine; j++)
        for (int k = 0; k < fine_half; k++, i++) {
            s->fine_wave[2 * i] = s->true_pass[i] * smear_pass(smear_px, frequency(k, fine), frequency(j, fine),
                                                               2 * k == fine || 2 * j == fine);
            s->fine_wave[2 * i + 1] = 0;
        }
    for (int j = 0, i = 0; j < period_px; j++)
        for (int k = 0; k < coarse_half; k++, i++) {
            s->coarse_wave[2 * i] =
                s->pixel_pass[i] * blur_smear_pass(smear_px, frequency(k, period_px), frequency(j, period_px));
            s->coarse_wave[2 * i + 1] = 0;
        }
    transform_run(s->to_fine);
    transform_run(s->to_coarse);
    for (int phase = 0; phase < phases; phase++)
        for (int y = -reach_px; y <= reach_px; y++)
            for (int x = -reach_px; x <= reach_px; x++) {
                /* a pixel's centre is half a pixel from the node at its corner */
                const int row = wrapped(nodes_per_px * y + nodes_per_px / 2 - phase / nodes_per_px, fine);
                const int column = wrapped(nodes_per_px * x + nodes_per_px / 2 - phase % nodes_per_px, fine);
                const int coarse = wrapped(y, period_px) * period_px + wrapped(x, period_px);
                s->kernel[phase].value[y + reach_px][x + reach_px] =
                    s->fine_value[row * fine + column] - s->coarse_value[coarse];
            }
}

/* ---- cells onto nodes -------------------------------------------------------------------------- */

/* Integral of a node's hat function up to t node distances beyond it; its total integral is 1. */
static double hat_below(double t)
{
    if (t <= -1) return 0;
    if (t >= 1) return 1;
    return t < 0 ? 0.5 * (1 + t) * (1 + t) : 1 - 0.5 * (1 - t) * (1 - t);
}

typedef struct Shares {
    int    first, count;
    double share[most_shares]; /* px that go to each node */
} Shares;

/* Share of each node in from .. to, px, within one pixel. Nodes are at multiples of 1 / nodes_per_px; shares beyond the
 * edge of the image go to the last node within. */
static void share_out(Shares *s, double from_px, double to_px, int size_px)
{
    const double from = from_px * nodes_per_px, to = to_px * nodes_per_px;
    const int    last = size_px * nodes_per_px - 1, low = (int)floor(from), high = (int)ceil(to);
    s->first = low < last ? low : last;
    s->count = 0;
    for (int n = low; n <= high && s->count < most_shares; n++) {
        const double share = (hat_below(to - n) - hat_below(from - n)) / nodes_per_px;
        if (n > last && s->count > 0) s->share[s->count - 1] += share;
        else s->share[s->count++] = share;
    }
}

typedef struct Grid {
    int x0, y0, columns; /* first node, nodes a row */
} Grid;

static void share_cell(SubPixel *s, const Grid *g, const double span[4], int width, int height, double density_e)
{
    Shares across, down;
    share_out(&across, span[0], span[2], width);
    share_out(&down, span[1], span[3], height);
    for (int j = 0; j < down.count; j++) {
        double      *row = s->node + (size_t)(down.first + j - g->y0) * (size_t)g->columns + (across.first - g->x0);
        const double e = density_e * down.share[j];
        for (int i = 0; i < across.count; i++) row[i] += e * across.share[i];
    }
}

static double electrons_of(const SubPixelPlane *p, float radiance)
{
    const double e = p->exposure * photon_table_electrons(p->photons, (double)radiance);
    return isfinite(e) ? e : 0;
}

/* Sums the electrons of the cells, less those of the background behind them. */
static void share_target(SubPixel *s, const Grid *g, const SmallTarget *t, const SubPixelPlane *p)
{
    const double *box = t->box_px, cell_x = (box[2] - box[0]) / t->columns, cell_y = (box[3] - box[1]) / t->rows;
    for (int cell = 0; cell < t->columns * t->rows; cell++) {
        if (!t->met[cell]) continue;
        const double own = electrons_of(p, t->cell[p->plane][cell]);
        const double x = box[0] + cell_x * (cell % t->columns), y = box[1] + cell_y * (cell / t->columns);
        for (int row = (int)fmax(t->y0, floor(y)); row < t->y1 && row < y + cell_y; row++)
            for (int column = (int)fmax(t->x0, floor(x)); column < t->x1 && column < x + cell_x; column++) {
                const double span[4] = {fmax(x, column), fmax(y, row), fmin(x + cell_x, column + 1),
                                        fmin(y + cell_y, row + 1)};
                if (!(span[2] > span[0] && span[3] > span[1])) continue;
                const float behind = t->behind[p->plane][(row - t->y0) * (t->x1 - t->x0) + column - t->x0];
                share_cell(s, g, span, p->width, p->height, own - electrons_of(p, behind));
            }
    }
}

/* ---- nodes into the plane ---------------------------------------------------------------------- */

static void add_kernel(double *more, int width, int height, int column, int row, const Kernel *k, double e)
{
    const int x0 = column - reach_px > 0 ? column - reach_px : 0, y0 = row - reach_px > 0 ? row - reach_px : 0;
    const int x1 = column + reach_px < width ? column + reach_px + 1 : width;
    const int y1 = row + reach_px < height ? row + reach_px + 1 : height;
    for (int y = y0; y < y1; y++) {
        const double *from = k->value[y - row + reach_px] + (x0 - column + reach_px);
        double       *to = more + (size_t)y * (size_t)width;
        for (int x = x0; x < x1; x++) to[x] += e * from[x - x0];
    }
}

static void add_target(SubPixel *s, const SubPixelPlane *p, const SmallTarget *t)
{
    const int width = p->width, height = p->height;
    /* pixels that nodes may belong to: a hat at the target's edge reaches one node further */
    const int    x0 = t->x0 > 0 ? t->x0 - 1 : 0, x1 = t->x1 < width ? t->x1 + 1 : width;
    const int    y0 = t->y0 > 0 ? t->y0 - 1 : 0, y1 = t->y1 < height ? t->y1 + 1 : height;
    const Grid   g = {x0 * nodes_per_px, y0 * nodes_per_px, (x1 - x0) * nodes_per_px};
    const size_t nodes = (size_t)g.columns * (size_t)(y1 - y0) * nodes_per_px;
    assert(nodes <= most_nodes);
    memset(s->node, 0, nodes * sizeof *s->node);
    share_target(s, &g, t, p);
    for (int row = y0; row < y1; row++)
        for (int column = x0; column < x1; column++) {
            double sum = 0;
            for (int j = 0; j < nodes_per_px; j++)
                for (int i = 0; i < nodes_per_px; i++) {
                    const size_t at = (size_t)((row - y0) * nodes_per_px + j) * (size_t)g.columns +
                                      (size_t)((column - x0) * nodes_per_px + i);
                    const double e = s->node[at];
                    if (e == 0) continue;
                    sum += e;
                    add_kernel(p->more, width, height, column, row, &s->kernel[j * nodes_per_px + i], e);
                }
            p->electrons[(size_t)row * (size_t)width + (size_t)column] += (float)sum;
        }
}

void subpixel_targets(SubPixel *s, const SubPixelPlane *p, const SmallTargets *targets, const double smear_px[2])
{
    memset(p->more, 0, (size_t)p->width * (size_t)p->height * sizeof *p->more);
    make_kernels(s, smear_px);
    /* first all the background that they hide, then all their own light: a pixel may contain parts of several */
    for (int n = 0; n < targets->count; n++) {
        const SmallTarget *t = &targets->target[n];
        for (int y = t->y0, k = 0; y < t->y1; y++)
            for (int x = t->x0; x < t->x1; x++, k++)
                if (t->area[k] > 0)
                    p->electrons[(size_t)y * (size_t)p->width + (size_t)x] =
                        (float)electrons_of(p, t->behind[p->plane][k]);
    }
    for (int n = 0; n < targets->count; n++) add_target(s, p, &targets->target[n]);
}
