/* render/heat/heat_network.c: steps a network of thermal nodes with SUNDIALS' ARKODE (heat_network_private.h).
 *
 * The system that ARKODE sees: the nodes' temperatures, and one number more, the heat from outside over the sum of the
 * capacities. Every Runge-Kutta stage keeps the sum of C_i T_i less that heat, and so does every Newton iteration, as
 * its matrix does: energy is kept to rounding, whatever the error of the step. Held nodes have the equation T' = 0. */
#include "render/heat/heat_network_private.h"

#include "render/heat/surface_flux_private.h"

#include <arkode/arkode_arkstep.h>
#include <assert.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

/* Error of one internal step: the root of the sum over nodes of the squares, so that no node is beyond it. Below 100 K
 * in proportion: temperatures stay positive. At 1e-3 K steps of 30 s took 1.6 times as long. */
static const double tolerance_k = 3e-3, tolerance_full_k = 100;

/* A link or an exchange. */
typedef struct Flow {
    int    a, b;
    double size;         /* conductance, W/K, or area, m2 */
    double inward;       /* what goes from a to b comes from outside: 1, as a is held; -1: b is; 0 */
    int    a_row, b_row; /* places in the matrix: row a of column b, row b of column a; -1: one is held */
} Flow;

struct Network {
    int     nodes, links, exchanges;
    double  sum_j_k;                       /* of the capacities that are not held; 1: all are */
    double *capacity_j_k;                  /* [nodes]; 0: held */
    double *per_j_k;                       /* 1 / capacity; 0: held [nodes] */
    Flow   *flow;                          /* links, then exchanges */
    double *flow_w, *fourth, *outside_w_k; /* scratch [nodes] */

    const NetworkLoad *load, *load_end; /* of the step */
    double             dt_s;

    SUNContext      context;
    N_Vector        state;
    SUNMatrix       matrix;
    SUNLinearSolver solver;
    void           *arkode;
};

/* ---- the equations ------------------------------------------------------------------------------ */

static NetworkLoad load_at(const Network *n, int i, double share)
{
    const NetworkLoad *a = &n->load[i], *b = &n->load_end[i];
    return (NetworkLoad){a->heat_w + share * (b->heat_w - a->heat_w), a->film_w_k + share * (b->film_w_k - a->film_w_k),
                         a->fluid_k + share * (b->fluid_k - a->fluid_k),
                         a->emits_m2 + share * (b->emits_m2 - a->emits_m2)};
}

static int derivative(double t_s, N_Vector y, N_Vector out, void *user)
{
    Network      *n = user;
    const double *temp_k = N_VGetArrayPointer(y), share = t_s / n->dt_s;
    double       *d = N_VGetArrayPointer(out), *flow_w = n->flow_w, *fourth = n->fourth, outside_w = 0;
    for (int i = 0; i < n->nodes; i++) {
        const NetworkLoad l = load_at(n, i, share);
        const double      square = temp_k[i] * temp_k[i];
        /* |T|^3 T: iterations may look below 0 K, and flows must not turn there */
        fourth[i] = stefan_w_m2k4 * square * temp_k[i] * fabs(temp_k[i]);
        flow_w[i] = l.heat_w + l.film_w_k * (l.fluid_k - temp_k[i]) - l.emits_m2 * fourth[i];
        if (n->per_j_k[i] > 0) outside_w += flow_w[i];
    }
    for (int k = 0; k < n->links + n->exchanges; k++) {
        const Flow   *f = &n->flow[k];
        const double *level = k < n->links ? temp_k : fourth, w = f->size * (level[f->a] - level[f->b]);
        flow_w[f->a] -= w;
        flow_w[f->b] += w;
        outside_w += f->inward * w;
    }
    for (int i = 0; i < n->nodes; i++) d[i] = n->per_j_k[i] * flow_w[i];
    d[n->nodes] = outside_w / n->sum_j_k;
    return 0;
}

/* I - gamma J. A column holds its diagonal, then the other nodes, then the heat from outside, last. */
static int newton_matrix(double t_s, N_Vector y, N_Vector fy, SUNMatrix matrix, SUNMatrix mass, int same, int *fresh,
                         double gamma_s, void *user, N_Vector a, N_Vector b, N_Vector c)
{
    (void)fy, (void)mass, (void)same, (void)a, (void)b, (void)c;
    Network            *n = user;
    const double       *temp_k = N_VGetArrayPointer(y), *per = n->per_j_k, share = t_s / n->dt_s;
    double             *value = SUNSparseMatrix_Data(matrix), *rises = n->flow_w, *outside = n->outside_w_k;
    const sunindextype *column = SUNSparseMatrix_IndexPointers(matrix);
    memset(value, 0, (size_t)column[n->nodes + 1] * sizeof *value);
    for (int i = 0; i < n->nodes; i++) {
        const NetworkLoad l = load_at(n, i, share);
        n->fourth[i] = 4 * stefan_w_m2k4 * temp_k[i] * temp_k[i] * fabs(temp_k[i]);
        rises[i] = outside[i] = l.film_w_k + l.emits_m2 * n->fourth[i];
    }
    for (int k = 0; k < n->links + n->exchanges; k++) {
        const Flow  *f = &n->flow[k];
        const bool   link = k < n->links;
        const double a_w_k = f->size * (link ? 1 : n->fourth[f->a]), b_w_k = f->size * (link ? 1 : n->fourth[f->b]);
        rises[f->a] += a_w_k;
        rises[f->b] += b_w_k;
        if (f->a_row < 0) {
            outside[f->a] += a_w_k;
            outside[f->b] += b_w_k;
        } else {
            value[f->b_row] -= gamma_s * per[f->b] * a_w_k;
            value[f->a_row] -= gamma_s * per[f->a] * b_w_k;
        }
    }
    for (int i = 0; i < n->nodes; i++) {
        value[column[i]] = 1 + gamma_s * per[i] * rises[i];
        if (per[i] > 0) value[column[i + 1] - 1] = gamma_s * outside[i] / n->sum_j_k;
    }
    value[column[n->nodes]] = 1;
    *fresh = SUNTRUE;
    return 0;
}

/* Weights of the errors for ARKODE: held nodes and the heat from outside have none. */
static int weights(N_Vector y, N_Vector out, void *user)
{
    const Network *n = user;
    const double  *temp_k = N_VGetArrayPointer(y);
    double        *w = N_VGetArrayPointer(out);
    const double   per_k = sqrt(n->nodes + 1) / tolerance_k; /* ARKODE's norm is the root of a mean */
    for (int i = 0; i < n->nodes; i++)
        w[i] = n->per_j_k[i] > 0 ? per_k * fmax(1, tolerance_full_k / fmax(fabs(temp_k[i]), 1e-3)) : 0;
    w[n->nodes] = 0;
    return 0;
}

/* ---- the linear solver: SUNDIALS' for KLU, less its memory of earlier matrices -------------------- */

/* The order of the unknowns is found once, from the places alone, and diagonals are the pivots: the diagonal of
 * C (I - gamma J) outweighs the rest of its column, so no other pivot is better. SUNDIALS' own initialization would
 * order again at each start, and its pivots would depend on the first matrix. */
static int keep_order(SUNLinearSolver solver)
{
    (void)solver;
    return 0;
}

static int factor(SUNLinearSolver solver, SUNMatrix matrix)
{
    SuiteSparse_long *column = SUNSparseMatrix_IndexPointers(matrix), *row = SUNSparseMatrix_IndexValues(matrix);
    return klu_l_refactor(column, row, SUNSparseMatrix_Data(matrix), SUNLinSol_KLUGetSymbolic(solver),
                          SUNLinSol_KLUGetNumeric(solver), SUNLinSol_KLUGetCommon(solver))
               ? 0
               : 1;
}

static Status prepare_solver(Network *n)
{
    double             *value = SUNSparseMatrix_Data(n->matrix);
    const sunindextype *column = SUNSparseMatrix_IndexPointers(n->matrix);
    n->solver = SUNLinSol_KLU(n->state, n->matrix, n->context);
    if (!n->solver) return STATUS_NO_MEMORY;
    klu_l_common *common = SUNLinSol_KLUGetCommon(n->solver);
    common->tol = 0;   /* the diagonal, always */
    common->scale = 1; /* any but none, as capacities differ by 1e8 */
    for (int i = 0; i <= n->nodes; i++)
        for (sunindextype k = column[i]; k < column[i + 1]; k++) value[k] = k == column[i] ? 1 : -1e-3;
    if (SUNLinSolInitialize(n->solver) != 0 || SUNLinSolSetup(n->solver, n->matrix) != 0) return STATUS_NO_MEMORY;
    n->solver->ops->initialize = keep_order;
    n->solver->ops->setup = factor;
    return STATUS_OK;
}

typedef struct Pair {
    int column, row;
} Pair;

static int by_column(const void *a, const void *b)
{
    const Pair *p = a, *q = b;
    return p->column != q->column ? p->column - q->column : p->row - q->row;
}

/* Places of all pairs of nodes that exchange something, each once. */
static Status place(Network *n)
{
    const int flows = n->links + n->exchanges;
    Pair     *pair = malloc((2 * (size_t)flows + 1) * sizeof *pair);
    int      *at = malloc((2 * (size_t)flows + 1) * sizeof *at); /* places of pairs */
    int       pairs = 0, count = 0;
    Status    status = STATUS_NO_MEMORY;
    if (!pair || !at) goto done;
    for (int k = 0; k < flows; k++) {
        const Flow *f = &n->flow[k];
        if (f->a_row < 0) continue;
        pair[pairs++] = (Pair){f->a, f->b};
        pair[pairs++] = (Pair){f->b, f->a};
    }
    qsort(pair, (size_t)pairs, sizeof *pair, by_column);
    for (int p = 0; p < pairs; p++)
        if (p == 0 || by_column(&pair[p], &pair[count - 1]) != 0) pair[count++] = pair[p];
    n->matrix = SUNSparseMatrix(n->nodes + 1, n->nodes + 1, count + 2 * n->nodes + 1, CSC_MAT, n->context);
    if (!n->matrix) goto done;
    sunindextype *column = SUNSparseMatrix_IndexPointers(n->matrix), *row = SUNSparseMatrix_IndexValues(n->matrix);
    int           places = 0, p = 0;
    for (int i = 0; i < n->nodes; i++) {
        column[i] = places;
        row[places++] = i;
        for (; p < count && pair[p].column == i; p++) {
            at[p] = places;
            row[places++] = pair[p].row;
        }
        if (n->per_j_k[i] > 0) row[places++] = n->nodes;
    }
    column[n->nodes] = places;
    row[places++] = n->nodes;
    column[n->nodes + 1] = places;
    for (int k = 0; k < flows; k++) {
        Flow *f = &n->flow[k];
        if (f->a_row < 0) continue;
        f->b_row = at[(const Pair *)bsearch(&(Pair){f->a, f->b}, pair, (size_t)count, sizeof *pair, by_column) - pair];
        f->a_row = at[(const Pair *)bsearch(&(Pair){f->b, f->a}, pair, (size_t)count, sizeof *pair, by_column) - pair];
    }
    status = STATUS_OK;
done:
    free(pair);
    free(at);
    return status;
}

/* ---- a network ----------------------------------------------------------------------------------- */

static void say_nothing(int code, const char *module, const char *function, char *text, void *user)
{
    (void)code, (void)module, (void)function, (void)text, (void)user; /* what failed is in the Status */
}

static Status prepare_arkode(Network *n)
{
    n->arkode = ARKStepCreate(NULL, derivative, 0, n->state, n->context);
    if (!n->arkode) return STATUS_NO_MEMORY;
    void *a = n->arkode;
    int   wrong = ARKStepSetErrHandlerFn(a, say_nothing, NULL) | ARKStepSetUserData(a, n);
    wrong |= ARKStepWFtolerances(a, weights) | ARKStepSetLinearSolver(a, n->solver, n->matrix);
    wrong |= ARKStepSetLinSysFn(a, newton_matrix);
    /* Kennedy & Carpenter, NASA/TM-2001-211038 (2001): third order, L-stable. At 1e-3 K a step of 30 s of 100 nodes
     * took 54 us and erred by 1e-5 K; TR-BDF2 50 us and 1e-4 K, and three times as long at 120 s; fourth order 77 us */
    wrong |= ARKStepSetTableNum(a, ARKODE_ARK324L2SA_DIRK_4_2_3, ARKODE_ERK_NONE);
    /* slopes from the stages, not from the equations again, which would enlarge what Newton's iteration left */
    wrong |= ARKStepSetDeduceImplicitRhs(a, SUNTRUE) | ARKStepSetLinearSolutionScaling(a, SUNFALSE);
    wrong |= ARKStepSetPredictorMethod(a, 0); /* the start of the step: no history */
    /* nothing between steps is asked for */
    wrong |= ARKStepSetInterpolantType(a, ARK_INTERP_LAGRANGE) | ARKStepSetInterpolantDegree(a, 0);
    wrong |= ARKStepSetMaxErrTestFails(a, 100) | ARKStepSetMaxConvFails(a, 100);
    wrong |= ARKStepSetMaxNumSteps(a, network_most_steps);
    return wrong == 0 ? STATUS_OK : STATUS_NO_MEMORY;
}

/* The flow without its places; false: wrong. */
static bool flow_of(Flow *out, const Network *n, int a, int b, double size)
{
    if (a < 0 || b < 0 || a >= n->nodes || b >= n->nodes || a == b || !(size >= 0) || isinf(size)) return false;
    const bool a_held = n->per_j_k[a] == 0, b_held = n->per_j_k[b] == 0;
    *out = (Flow){a, b, size, a_held - b_held, a_held || b_held ? -1 : 0, a_held || b_held ? -1 : 0};
    return true;
}

static Status copy_shape(Network *n, const NetworkShape *shape)
{
    for (int i = 0; i < n->nodes; i++) {
        const double c = shape->capacity_j_k[i];
        if (!(c > 0)) return STATUS_BAD_VALUE;
        n->capacity_j_k[i] = isinf(c) ? 0 : c;
        n->per_j_k[i] = 1 / c;
        n->sum_j_k += n->capacity_j_k[i];
    }
    if (n->sum_j_k == 0) n->sum_j_k = 1;
    if (isinf(n->sum_j_k)) return STATUS_BAD_VALUE;
    for (int k = 0; k < n->links; k++) {
        const NetworkLink *l = &shape->link[k];
        if (!flow_of(&n->flow[k], n, l->a, l->b, l->conductance_w_k)) return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < n->exchanges; k++) {
        const NetworkExchange *e = &shape->exchange[k];
        if (!flow_of(&n->flow[n->links + k], n, e->a, e->b, e->area_m2)) return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status heat_network_create(Network **out, const NetworkShape *shape)
{
    if (shape->nodes < 1 || shape->links < 0 || shape->exchanges < 0) return STATUS_BAD_VALUE;
    Network *n = calloc(1, sizeof *n);
    if (!n) return STATUS_NO_MEMORY;
    n->nodes = shape->nodes, n->links = shape->links, n->exchanges = shape->exchanges;
    const size_t nodes = (size_t)n->nodes;
    Status       status = STATUS_NO_MEMORY;
    n->capacity_j_k = calloc(5 * nodes, sizeof *n->capacity_j_k);
    n->flow = calloc((size_t)n->links + (size_t)n->exchanges + 1, sizeof *n->flow);
    if (!n->capacity_j_k || !n->flow) goto fail;
    n->per_j_k = n->capacity_j_k + nodes, n->flow_w = n->per_j_k + nodes;
    n->fourth = n->flow_w + nodes, n->outside_w_k = n->fourth + nodes;
    status = copy_shape(n, shape);
    if (status != STATUS_OK) goto fail;
    status = STATUS_NO_MEMORY;
    if (SUNContext_Create(NULL, &n->context) != 0) goto fail;
    n->state = N_VNew_Serial(n->nodes + 1, n->context);
    if (!n->state) goto fail;
    N_VConst(0, n->state);
    status = place(n);
    if (status == STATUS_OK) status = prepare_solver(n);
    if (status == STATUS_OK) status = prepare_arkode(n);
    if (status != STATUS_OK) goto fail;
    *out = n;
    return STATUS_OK;

fail:
    heat_network_destroy(n);
    return status;
}

void heat_network_destroy(Network *network)
{
    if (!network) return;
    if (network->arkode) ARKStepFree(&network->arkode);
    if (network->solver) SUNLinSolFree(network->solver);
    if (network->matrix) SUNMatDestroy(network->matrix);
    if (network->state) N_VDestroy(network->state);
    if (network->context) SUNContext_Free(&network->context);
    free(network->flow);
    free(network->capacity_j_k);
    free(network);
}

int heat_network_nodes(const Network *network) { return network->nodes; }

void heat_network_exchange(Network *network, const double *area_m2)
{
    for (int k = 0; k < network->exchanges; k++) {
        assert(area_m2[k] >= 0 && isfinite(area_m2[k]));
        network->flow[network->links + k].size = area_m2[k];
    }
}

void heat_network_conductances(Network *network, const double *w_k)
{
    for (int k = 0; k < network->links; k++) network->flow[k].size = w_k[k];
}

double heat_network_heat_j(const Network *network, const double *temp_k)
{
    double sum = 0;
    for (int i = 0; i < network->nodes; i++) sum += network->capacity_j_k[i] * temp_k[i];
    return sum;
}

/* ---- a step -------------------------------------------------------------------------------------- */

static bool load_is_good(const NetworkLoad *l)
{
    return isfinite(l->heat_w) && l->film_w_k >= 0 && isfinite(l->film_w_k) && isfinite(l->fluid_k) &&
           l->emits_m2 >= 0 && isfinite(l->emits_m2);
}

/* once: one step, its error not looked at. */
static Status solve(Network *n, double dt_s, bool once)
{
    double reached_s;
    int    code = ARKStepReInit(n->arkode, NULL, derivative, 0, n->state);
    if (code == 0) code = ARKStepSetFixedStep(n->arkode, once ? dt_s : 0);
    /* a long step needs more iterations, which may end at 0.01 K */
    if (code == 0) code = ARKStepSetMaxNonlinIters(n->arkode, once ? 20 : 0);
    if (code == 0) code = ARKStepSetNonlinConvCoef(n->arkode, once ? 10 : 0);
    if (code == 0 && !once) code = ARKStepSetInitStep(n->arkode, dt_s);
    if (code == 0) code = ARKStepSetStopTime(n->arkode, dt_s);
    if (code == 0) code = ARKStepEvolve(n->arkode, dt_s, n->state, &reached_s, ARK_NORMAL);
    if (code == ARK_MEM_FAIL) return STATUS_NO_MEMORY;
    return code >= 0 ? STATUS_OK : STATUS_UNSUPPORTED;
}

static Status run(double *temp_k, double *heat_in_j, Network *network, const NetworkLoad *load,
                  const NetworkLoad *load_end, double dt_s, bool once)
{
    Network *n = network;
    double  *state = N_VGetArrayPointer(n->state);
    if (!(dt_s > 0) || isinf(dt_s)) return STATUS_BAD_VALUE;
    n->load = load, n->load_end = load_end ? load_end : load, n->dt_s = dt_s;
    for (int i = 0; i < n->nodes; i++) {
        if (!(temp_k[i] > 0) || isinf(temp_k[i])) return STATUS_BAD_VALUE;
        if (!load_is_good(&n->load[i]) || !load_is_good(&n->load_end[i])) return STATUS_BAD_VALUE;
        state[i] = temp_k[i];
    }
    state[n->nodes] = 0;
    const Status status = solve(n, dt_s, once);
    if (status != STATUS_OK) return status;
    for (int i = 0; i <= n->nodes; i++)
        if (!isfinite(state[i]) || (i < n->nodes && !(state[i] > 0))) return STATUS_BAD_VALUE;
    for (int i = 0; i < n->nodes; i++) temp_k[i] = state[i];
    if (heat_in_j) *heat_in_j += n->sum_j_k * state[n->nodes];
    return STATUS_OK;
}

Status heat_network_step(double *temp_k, double *heat_in_j, Network *network, const NetworkLoad *load,
                         const NetworkLoad *load_end, double dt_s)
{
    return run(temp_k, heat_in_j, network, load, load_end, dt_s, false);
}

Status heat_network_leap(double *temp_k, Network *network, const NetworkLoad *load, double dt_s)
{
    return run(temp_k, NULL, network, load, load, dt_s, true);
}
