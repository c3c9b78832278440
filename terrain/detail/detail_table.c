/* terrain/detail/detail_table.c: the statistics of the ground's detail, and the weights of the octaves that give
 * them under any footprint.
 *
 * The covariance of a class is fitted by those of the octaves (least squares, no weight below 0). A sample's footprint
 * then passes a share of each octave's variance, integrated over its rectangle, and makes what it passes smoother: as
 * smooth as coarser octaves are, to which the variance is moved. So the variance and the correlation of neighbouring
 * samples are those of the filtered class, and no octave that the samples cannot resolve remains: a sample that moves
 * by a part of its footprint sees nearly the same. */
#include "terrain/detail/detail.h"
#include "pitviper_table.h"

#include <stdlib.h>

/* ---- covariance of an octave ------------------------------------------------------------------ */

enum { kernel_steps = 64, kernel_phases = 64 };

/* Covariance of an octave of cells of 1 at a distance of i / (kernel_steps / 3), mean of all directions. */
typedef struct Kernel {
    double at[kernel_steps + 1];
} Kernel;
static const double kernel_reach = 3; /* beyond 2 sqrt 2 it is 0 */

static double bump(double t) /* weight of a lattice point at a distance t */
{
    const double s = fabs(t) < 1 ? fabs(t) : 1;
    return cos(0.5 * pi_rad * s * s * (3 - 2 * s));
}

static double along_axis(const double axis[kernel_steps + 1], double d)
{
    const double f = fabs(d) * (kernel_steps / 2.0);
    const int    i = (int)f;
    return i < kernel_steps ? axis[i] + (f - i) * (axis[i + 1] - axis[i]) : 0;
}

static void kernel_create(Kernel *out)
{
    double axis[kernel_steps + 1];
    for (int i = 0; i <= kernel_steps; i++) {
        double sum = 0;
        for (int k = 0; k < 2 * kernel_phases; k++) {
            const double t = (k + 0.5) / kernel_phases - 1;
            sum += bump(t) * bump(t + 2.0 * i / kernel_steps);
        }
        axis[i] = sum / kernel_phases;
    }
    enum { directions = 16 };
    for (int i = 0; i <= kernel_steps; i++) {
        const double r = kernel_reach * i / kernel_steps;
        out->at[i] = 0;
        for (int k = 0; k < directions; k++) {
            const double angle = 0.5 * pi_rad * (k + 0.5) / directions;
            out->at[i] += along_axis(axis, r * cos(angle)) * along_axis(axis, r * sin(angle)) / directions;
        }
    }
}

static double kernel_at(const Kernel *kernel, double r)
{
    const double f = r * (kernel_steps / kernel_reach);
    const int    i = f < kernel_steps ? (int)f : kernel_steps;
    return i < kernel_steps ? kernel->at[i] + (f - i) * (kernel->at[i + 1] - kernel->at[i]) : 0;
}

/* ---- the class's covariance as octaves ---------------------------------------------------------- */

static double covariance_at(const DetailStatistics *s, double d_m)
{
    return (1 - s->far_share) * exp(-d_m / s->length_m) + s->far_share * exp(-d_m / s->far_length_m);
}

/* Variances of the octaves, of sum 1: least squares over distances from a tenth of the shorter length to eight of the
 * longer, none below 0; by coordinate descent, which converges for eight unknowns. */
static void fit_octaves(double variance[detail_octaves], const Kernel *kernel, const DetailStatistics *s)
{
    enum { distances = 48, rounds = 400 };
    static const double total_weight = 30;
    double              normal[detail_octaves][detail_octaves], right[detail_octaves], sum = 0;
    const double        longest_m = s->far_share > 0 ? fmax(s->length_m, s->far_length_m) : s->length_m;
    const double        first_m = 0.03, ratio = pow(fmax(8 * longest_m, 1) / first_m, 1.0 / (distances - 1));
    for (int n = 0; n < detail_octaves; n++) {
        right[n] = total_weight, variance[n] = 0;
        for (int m = 0; m < detail_octaves; m++) normal[n][m] = total_weight;
    }
    for (int k = 0; k < distances; k++) {
        const double d_m = first_m * pow(ratio, k), want = covariance_at(s, d_m);
        double       of[detail_octaves];
        for (int n = 0; n < detail_octaves; n++) of[n] = kernel_at(kernel, d_m / detail_octave_m[n]);
        for (int n = 0; n < detail_octaves; n++) {
            right[n] += of[n] * want;
            for (int m = 0; m < detail_octaves; m++) normal[n][m] += of[n] * of[m];
        }
    }
    for (int round = 0; round < rounds; round++)
        for (int n = 0; n < detail_octaves; n++) {
            double left = right[n];
            for (int m = 0; m < detail_octaves; m++)
                if (m != n) left -= normal[n][m] * variance[m];
            variance[n] = fmax(left / normal[n][n], 0);
        }
    for (int n = 0; n < detail_octaves; n++) sum += variance[n];
    for (int n = 0; n < detail_octaves; n++) variance[n] /= sum;
}

/* ---- footprints --------------------------------------------------------------------------------- */

/* What of an octave's variance arrives in which octave. */
typedef struct Transfer {
    float to[detail_octaves][detail_octaves];
} Transfer;

static double node_of(int index, int per_doubling)
{
    return ldexp(1 + (double)(index % per_doubling) / per_doubling, index / per_doubling);
}

/* Variance of the mean over a rectangle of an octave of cells of 1: its covariance at the difference of two places. */
static double passed(const Kernel *kernel, double across, double along)
{
    enum { steps = 16 };
    double sum = 0;
    /* beyond the kernel's reach there is nothing to sum */
    const double reach_x = fmin(across, kernel_reach), reach_y = fmin(along, kernel_reach);
    for (int j = 0; j < steps; j++)
        for (int i = 0; i < steps; i++) {
            const double x = reach_x * (i + 0.5) / steps, y = reach_y * (j + 0.5) / steps;
            sum += (1 - x / across) * (1 - y / along) * kernel_at(kernel, sqrt(x * x + y * y));
        }
    return 4 * sum * (reach_x / across) * (reach_y / along) / (steps * steps);
}

/* The two octaves as smooth as octave n is after the mean over a square of `wide`: alike at 0.8 of its side (nearer,
 * the next pixel is too much alike; further, what an eye sees that moves by a part of a pixel changes too much). */
static void smoother(Transfer *out, int n, double share, double wide_m)
{
    const double own_m = detail_octave_width * detail_octave_m[n], d_m = 0.8 * wide_m;
    const double width_m = sqrt(own_m * own_m + wide_m * wide_m / 6);
    int          m = n;
    while (m < detail_octaves - 1 && detail_octave_width * detail_octave_m[m + 1] <= width_m) m++;
    memset(out->to[n], 0, sizeof out->to[n]);
    if (m == detail_octaves - 1) {
        out->to[n][m] = (float)share;
        return;
    }
    const double low_m = detail_octave_width * detail_octave_m[m],
                 high_m = detail_octave_width * detail_octave_m[m + 1];
    const double low = -expm1(-d_m * d_m / (2 * low_m * low_m)), high = -expm1(-d_m * d_m / (2 * high_m * high_m));
    const double want = -expm1(-d_m * d_m / (2 * width_m * width_m)), part = clamp((want - high) / (low - high), 0, 1);
    out->to[n][m] = (float)(share * part);
    out->to[n][m + 1] = (float)(share * (1 - part));
}

static void transfer_of(Transfer *out, const Kernel *kernel, int size, int elongation)
{
    const double across_m = node_of(size, 4) * ldexp(1, detail_least_log2), ratio = node_of(elongation, 2);
    for (int n = 0; n < detail_octaves; n++) {
        if (size == 0) {
            memset(out->to[n], 0, sizeof out->to[n]);
            out->to[n][n] = 1;
            continue;
        }
        const double cells = across_m / detail_octave_m[n];
        const double share = size == detail_sizes - 1 ? 0 : passed(kernel, cells, cells * ratio);
        /* octaves have no direction: a longer footprint makes them somewhat smoother also across it */
        smoother(out, n, share, across_m * pow(ratio, 0.33));
    }
}

/* ---- weights ------------------------------------------------------------------------------------ */

/* c of g + c (g^2 - 1) with this skew, for a normal g: (6 c + 8 c^3) / (1 + 2 c^2)^1.5 rises up to c = 0.7. */
static double hermite_of_skew(double skew)
{
    double low = 0, high = 0.7;
    for (int k = 0; k < 50; k++) {
        const double c = 0.5 * (low + high), v = 1 + 2 * c * c;
        if ((6 * c + 8 * c * c * c) / (v * sqrt(v)) < fabs(skew)) low = c;
        else high = c;
    }
    return skew < 0 ? -low : low;
}

static void fill_weights(float weight[detail_octaves], uint8_t *used, const double variance[detail_octaves],
                         const Transfer *transfer, double sigma, double cut_off)
{
    double arrived[detail_octaves] = {0}, all = 0, kept = 0;
    for (int n = 0; n < detail_octaves; n++)
        for (int m = n; m < detail_octaves; m++) arrived[m] += variance[n] * (double)transfer->to[n][m];
    for (int m = 0; m < detail_octaves; m++) all += arrived[m];
    /* also what is too weak to be seen: a ten-thousandth of the class's own variance */
    for (int m = 0; m < detail_octaves; m++) {
        if (!(arrived[m] > cut_off * all && all > 0.02 * cut_off)) arrived[m] = 0;
        kept += arrived[m];
    }
    *used = 0;
    for (int m = 0; m < detail_octaves; m++) {
        weight[m] = kept > 0 ? (float)(sigma * sqrt(arrived[m] * all / kept)) : 0;
        if (weight[m] > 0) *used |= (uint8_t)(1u << m);
    }
}

Status detail_table_create(DetailTable **out, const DetailStatistics statistics[SURFACE_COUNT][detail_fields],
                           double cut_off)
{
    DetailTable *table = calloc(1, sizeof *table);
    double(*variance)[detail_fields][detail_octaves] = calloc(SURFACE_COUNT, sizeof *variance);
    if (!table || !variance) {
        free(table);
        free(variance);
        return STATUS_NO_MEMORY;
    }
    Kernel kernel;
    kernel_create(&kernel);
    memcpy(table->statistics, statistics, sizeof table->statistics);
    for (int c = SURFACE_NONE + 1; c < SURFACE_COUNT; c++)
        for (int f = 0; f < detail_fields; f++) {
            const DetailStatistics *s = &statistics[c][f];
            const double            bend = hermite_of_skew(s->skew);
            if (!(s->sigma > 0)) continue;
            fit_octaves(variance[c][f], &kernel, s);
            table->bend[c][f] = (float)(bend / (s->sigma / sqrt(1 + 2 * bend * bend)));
            table->follows[c][f] = (float)s->follows;
            table->apart[c][f] = (float)sqrt(1 - s->follows * s->follows);
        }
    for (int i = 0; i < detail_sizes; i++)
        for (int j = 0; j < detail_longs; j++) {
            Transfer transfer;
            transfer_of(&transfer, &kernel, i, j);
            for (int c = SURFACE_NONE + 1; c < SURFACE_COUNT; c++)
                for (int f = 0; f < detail_fields; f++) {
                    const DetailStatistics *s = &statistics[c][f];
                    const double bend = hermite_of_skew(s->skew), sigma = s->sigma / sqrt(1 + 2 * bend * bend);
                    if (s->sigma > 0)
                        fill_weights(table->weights[c][i][j].of[f], &table->used[c][i][j][f], variance[c][f], &transfer,
                                     sigma, cut_off);
                }
        }
    free(variance);
    *out = table;
    return STATUS_OK;
}

void detail_table_close(DetailTable *table) { free(table); }

/* ---- the file ----------------------------------------------------------------------------------- */

/* The largest standard deviation of each field, in its unit. */
static const double most_sigma[detail_fields] = {1, 10, 2, 0.05};

typedef struct Row {
    SurfaceClass     surface;
    int              field;
    DetailStatistics s;
} Row;

#define FIELD(member) TABLE_AT(Row, member)

static const TableColumn columns[] = {
    {"surface", TABLE_NAMED, FIELD(surface), SURFACE_NAMED, .key = true},
    {"field", TABLE_CHOICE, FIELD(field), .choices = "albedo, temperature, radar, height", .key = true},
    {"sigma", TABLE_DOUBLE, FIELD(s.sigma), .low = 0, .high = 10},
    {"length_m", TABLE_DOUBLE, FIELD(s.length_m), .low = 0.05, .high = 50},
    {"far_share", TABLE_DOUBLE, FIELD(s.far_share), .low = 0, .high = 1},
    {"far_length_m", TABLE_DOUBLE, FIELD(s.far_length_m), .low = 0.05, .high = 50},
    {"skew", TABLE_DOUBLE, FIELD(s.skew), .low = -1.5, .high = 1.5},
    {"follows_albedo", TABLE_DOUBLE, FIELD(s.follows), .low = -1, .high = 1},
};
static const TableFormat format = {"ground detail", columns, sizeof columns / sizeof *columns, .every = true,
                                   .next = "etc/ground_detail.csv explains the columns"};

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    DetailStatistics(*statistics)[detail_fields] = user;
    const Row *row = read;
    const int  f = row->field;
    if (row->s.sigma > most_sigma[f])
        return table_rows_refuse(rows, number, "sigma", "a number in 0 .. %g", most_sigma[f]);
    if ((f == DETAIL_ALBEDO || f == DETAIL_HEIGHT) && row->s.follows != 1)
        return table_rows_refuse(rows, number, "follows_albedo", "1, as of albedo and height it is");
    statistics[row->surface][f] = row->s;
    return STATUS_OK;
}

Status detail_table_open(DetailTable **out, const char *path, double cut_off)
{
    DetailStatistics statistics[SURFACE_COUNT][detail_fields] = {{{0}}};
    Row              row;
    const Status     status = table_each(&format, path, &row, sizeof row, take_row, statistics);
    return status == STATUS_OK ? detail_table_create(out, statistics, cut_off) : status;
}
