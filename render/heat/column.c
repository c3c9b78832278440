/* render/heat/column.c: solves the heat conduction into layers, step by step (column.h). */
#include "render/heat/column_private.h"

Status column_create(Column *out, const ColumnLayer *layer, int layers, double first_m, double growth)
{
    *out = (Column){.nodes = 1};
    if (layers < 1 || !(first_m > 0) || !(growth >= 1)) return STATUS_BAD_VALUE;
    for (int l = 0; l < layers; l++) {
        const ColumnLayer *at = &layer[l];
        if (!(at->thickness_m > 0) || !(at->conductivity_w_mk > 0) || !(at->capacity_j_m3k > 0))
            return STATUS_BAD_VALUE;
        /* as many elements as it takes, then scaled to fill the layer */
        int    count = 0;
        double sum = 0;
        for (double size = first_m; sum < at->thickness_m * (1 - 1e-9) && count < column_most_nodes; size *= growth) {
            sum += size;
            count++;
        }
        double size = first_m * at->thickness_m / sum;
        if (out->nodes + count > column_most_nodes) return STATUS_BAD_VALUE;
        for (int e = 0; e < count; e++, size *= growth) {
            const int i = out->nodes - 1;
            out->capacity_j_m2k[i] += 0.5 * size * at->capacity_j_m3k;
            out->capacity_j_m2k[i + 1] = 0.5 * size * at->capacity_j_m3k;
            out->conductance_w_m2k[i] = at->conductivity_w_mk / size;
            out->depth_m[i + 1] = out->depth_m[i] + size;
            out->nodes++;
        }
    }
    return STATUS_OK;
}

void column_start(ColumnState *out, const Column *column, double temp_k)
{
    *out = (ColumnState){0};
    for (int i = 0; i < column->nodes; i++) out->temp_k[i] = temp_k;
}

double column_heat_j_m2(const ColumnState *state, const Column *column)
{
    double sum = 0;
    for (int i = 0; i < column->nodes; i++) sum += column->capacity_j_m2k[i] * state->temp_k[i];
    return sum;
}

double column_temp_k(const ColumnState *state, const Column *column, double depth_m)
{
    for (int i = 1; i < column->nodes; i++)
        if (depth_m <= column->depth_m[i]) {
            const double share = (depth_m - column->depth_m[i - 1]) / (column->depth_m[i] - column->depth_m[i - 1]);
            return state->temp_k[i - 1] + clamp(share, 0, 1) * (state->temp_k[i] - state->temp_k[i - 1]);
        }
    return state->temp_k[column->nodes - 1];
}

/* ---- one implicit stage ------------------------------------------------------------------------ */

/* Root of line + flux(T) - steep T, which falls. */
static double surface_root(const ColumnBoundary *b, const void *law, double line, double steep, double guess_k)
{
    double falls, low_k = -INFINITY, high_k = INFINITY, temp_k = guess_k, last_k = NAN, last = NAN, before = NAN;
    for (int i = 0; i < 200; i++) {
        const double miss = line + b->flux(&falls, temp_k, law) - steep * temp_k;
        if (miss == 0) break;
        *(miss > 0 ? &low_k : &high_k) = temp_k;
        double slope = steep + fmax(falls, 0);
        if (i > 0 && last_k != temp_k) { /* the secant's, where it falls */
            const double secant = (last - miss) / (temp_k - last_k);
            if (secant > 0.2 * slope && secant < 5 * slope) slope = secant;
        }
        double     next_k = temp_k + miss / slope;
        const bool open = isinf(low_k) || isinf(high_k), near = fabs(next_k - temp_k) < 1e-11 * fmax(fabs(temp_k), 1);
        /* T^4 far from its root: Newton's steps up and the secant's down may go round in circles */
        if (!(next_k > low_k && next_k < high_k) || (!open && !near && fabs(miss) > 0.5 * fabs(before))) {
            next_k = open ? temp_k + miss / slope : 0.5 * (low_k + high_k);
            if (next_k == low_k || next_k == high_k) break;
        }
        if (next_k < 0) next_k = 0.5 * temp_k; /* no temperature below 0 K */
        before = last;                         /* two steps ago */
        last_k = temp_k, last = miss;
        if (fabs(next_k - temp_k) < 1e-11 * fmax(fabs(temp_k), 1)) {
            temp_k = next_k;
            break;
        }
        temp_k = next_k;
    }
    return temp_k;
}

/* Eliminates (C / stage + K), without the surface's own exchange. */
static void eliminate(ColumnFactors *f, const Column *c, double stage_s)
{
    const double *g = c->conductance_w_m2k;
    const int     last = c->nodes - 1;
    double        steep = c->capacity_j_m2k[last] / stage_s + g[last] + (last > 0 ? g[last - 1] : 0);
    f->over[last] = 1 / steep;
    for (int i = last - 1; i >= 0; i--) {
        f->share[i] = g[i] * f->over[i + 1];
        steep = c->capacity_j_m2k[i] / stage_s + (i > 0 ? g[i - 1] : 0) + g[i] * (1 - f->share[i]);
        f->over[i] = 1 / steep;
    }
    f->steep0 = steep;
}

static const double tr_gamma = 0.58578643762690495; /* 2 - sqrt 2 */

void column_factors(ColumnFactors *out, const Column *column, double dt_s)
{
    out->dt_s = dt_s;
    out->half = NULL;
    eliminate(out, column, 0.5 * tr_gamma * dt_s);
}

/* (C / stage + K) T = right + flux(T_0) e_0. */
static void solve_stage(double temp_k[], const Column *c, const ColumnFactors *f, const ColumnBoundary *b,
                        const void *law, const double right[])
{
    const int last = c->nodes - 1;
    double    line[column_most_nodes];
    line[last] = right[last] + c->conductance_w_m2k[last] * b->deep_k;
    for (int i = last - 1; i >= 0; i--) line[i] = right[i] + f->share[i] * line[i + 1];
    temp_k[0] = surface_root(b, law, line[0], f->steep0, temp_k[0]);
    for (int i = 1; i <= last; i++) temp_k[i] = line[i] * f->over[i] + f->share[i - 1] * temp_k[i - 1];
}

/* Heat into each node by conduction, W/m2. */
static void conducted(double out[], const Column *c, const ColumnBoundary *b, const double temp_k[])
{
    const int last = c->nodes - 1;
    for (int i = 0; i <= last; i++) out[i] = 0;
    for (int i = 0; i < last; i++) {
        const double flow = c->conductance_w_m2k[i] * (temp_k[i] - temp_k[i + 1]);
        out[i] -= flow;
        out[i + 1] += flow;
    }
    out[last] += c->conductance_w_m2k[last] * (b->deep_k - temp_k[last]);
}

/* What a law and a place in the step come to. */
typedef struct Step {
    const Column         *column;
    const ColumnBoundary *boundary;
    double                dt_s; /* of the whole step */
} Step;

/* Solves (C / stage + K + falls) x = right / stage; returns x at the surface. */
static double filtered_k(const Column *c, const ColumnFactors *f, const double right_j_m2[], double falls,
                         double stage_s)
{
    double line = right_j_m2[c->nodes - 1];
    for (int i = c->nodes - 2; i >= 0; i--) line = right_j_m2[i] + f->share[i] * line;
    return line / stage_s / (f->steep0 + falls);
}

/* Backward Euler over [from, from + width] of the step: first order, and without overshoot whatever its length. */
static void euler(ColumnState *s, const Step *step, double from, double width)
{
    const Column     *c = step->column;
    _Alignas(16) char law[column_law_octets];
    ColumnFactors     f;
    double            right[column_most_nodes] = {0}, falls;
    const double      h_s = width * step->dt_s;
    const int         last = c->nodes - 1;
    eliminate(&f, c, h_s);
    step->boundary->at(law, from + width, step->boundary->user);
    for (int i = 0; i <= last; i++) right[i] = c->capacity_j_m2k[i] / h_s * s->temp_k[i];
    solve_stage(s->temp_k, c, &f, step->boundary, law, right);
    const double q = step->boundary->flux(&falls, s->temp_k[0], law);
    s->heat_j_m2 += h_s * (q + c->conductance_w_m2k[last] * (step->boundary->deep_k - s->temp_k[last]));
}

/* Heat into each node, conducted and through the surface under this law. */
static void flows(double out[], double *q, double *deep, double *falls, const Step *step, const void *law,
                  const double temp_k[])
{
    const ColumnBoundary *b = step->boundary;
    *q = b->flux(falls, temp_k[0], law);
    *deep = b->deep_k - temp_k[step->column->nodes - 1];
    conducted(out, step->column, b, temp_k);
    out[0] += *q;
}

/* TR-BDF2 over [from, from + width] of the step. Returns the estimate of its error at the surface, K (Hosea &
 * Shampine, Applied Numerical Mathematics 20, 1996). */
static double tr_bdf2(ColumnState *s, const Step *step, const ColumnFactors *f, double from, double width)
{
    static const double   gamma = 0.58578643762690495, w = 0.35355339059327376; /* 2 - sqrt 2; sqrt 2 / 4 */
    const double          alpha = 1 / (gamma * (2 - gamma)), beta = (1 - gamma) * (1 - gamma) / (gamma * (2 - gamma));
    const Column         *c = step->column;
    const ColumnBoundary *b = step->boundary;
    _Alignas(16) char     law[column_law_octets];
    double       flow[3][column_most_nodes] = {{0}}, right[column_most_nodes] = {0}, before_k[column_most_nodes];
    double       q[3], deep[3], falls;
    const int    n = c->nodes;
    const double h_s = width * step->dt_s, stage_s = 0.5 * gamma * h_s,
                 per_s = 1 / stage_s; /* the same for both stages */

    b->at(law, from, b->user);
    flows(flow[0], &q[0], &deep[0], &falls, step, law, s->temp_k);
    memcpy(before_k, s->temp_k, (size_t)n * sizeof *before_k);
    for (int i = 0; i < n; i++) right[i] = c->capacity_j_m2k[i] * per_s * before_k[i] + flow[0][i];
    b->at(law, from + gamma * width, b->user);
    solve_stage(s->temp_k, c, f, b, law, right);
    flows(flow[1], &q[1], &deep[1], &falls, step, law, s->temp_k);

    for (int i = 0; i < n; i++) right[i] = c->capacity_j_m2k[i] * per_s * (alpha * s->temp_k[i] - beta * before_k[i]);
    b->at(law, from + width, b->user);
    solve_stage(s->temp_k, c, f, b, law, right);
    flows(flow[2], &q[2], &deep[2], &falls, step, law, s->temp_k);

    const double d = 0.5 * gamma;
    s->heat_j_m2 += h_s * (w * (q[0] + q[1]) + d * q[2]);
    s->heat_j_m2 += h_s * c->conductance_w_m2k[n - 1] * (w * (deep[0] + deep[1]) + d * deep[2]);
    if (!(b->tolerance_k > 0)) return 0;
    for (int i = 0; i < n; i++)
        right[i] = h_s * ((w - (1 - w) / 3) * flow[0][i] - 1.0 / 3 * flow[1][i] + (2 * d / 3) * flow[2][i]);
    return fabs(filtered_k(c, f, right, fmax(falls, 0), stage_s));
}

enum { most_halvings = 14 };

static void advance(ColumnState *s, const Step *step, const ColumnFactors *given, double from, double width, int depth)
{
    const ColumnState before = *s;
    ColumnFactors     own;
    if (depth == most_halvings) {
        euler(s, step, from, width);
        return;
    }
    if (!given) column_factors(&own, step->column, width * step->dt_s);
    const double error_k = tr_bdf2(s, step, given ? given : &own, from, width);
    if (!(step->boundary->tolerance_k > 0) || error_k <= step->boundary->tolerance_k) return;
    *s = before;
    s->halved++;
    const ColumnFactors *half = given ? given->half : NULL;
    advance(s, step, half, from, 0.5 * width, depth + 1);
    advance(s, step, half, from + 0.5 * width, 0.5 * width, depth + 1);
}

void column_step(ColumnState *state, const Column *column, const ColumnFactors *factors, const ColumnBoundary *boundary,
                 double dt_s)
{
    const Step step = {column, boundary, dt_s};
    advance(state, &step, factors && factors->dt_s == dt_s ? factors : NULL, 0, 1, 0);
}
