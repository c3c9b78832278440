/* sensor/radar/radar_sight.c: which scattering centres of an entity the antenna sees past relief, plants and other
 * entities. */
#include "sensor/radar/seeker_radar_private.h"

enum { cells_along = 48, most_cells = cells_along * cells_along * cells_along, block_rays = 256 };
static const double least_side_m = 0.05;

/* Cells of centres, a sight line each. */
typedef struct Lines {
    const Making *making;
    int           entity, count;
    double      (*p_enu)[3];  /* [count] the ends of the sight lines */
    bool         *hidden;     /* [count] */
} Lines;

static void look_along(void *user, int worker, int task)
{
    static const double no_slack_m[block_rays];
    const Lines        *l = user;
    const double       *p = l->making->scene->view->p_enu;
    const int first = task * block_rays, left = l->count - first, count = left < block_rays ? left : block_rays;
    Sight               sight[block_rays];
    (void)worker;
    for (int i = 0; i < count; i++) {
        v3_sub(sight[i].d_enu, l->p_enu[first + i], p);
        sight[i].range_m = v3_length(sight[i].d_enu);
        v3_normalize(sight[i].d_enu, sight[i].d_enu);
    }
    making_hidden(l->hidden + first, l->making, p, sight, no_slack_m, count, l->entity);
}

/* Puts centres into cells, body axes: of[i] is that of centre i; returns how many there are. middle: mean position of a
 * cell's centres by amplitude. */
static int make_cells(int *of, double (*middle)[3], double *weight, int32_t *grid, const Centres *centres)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, side_m = least_side_m;
    int    size[3], count = 0;
    for (int i = 0; i < centres->count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], centres->centre[i].p[k]);
            high[k] = fmax(high[k], centres->centre[i].p[k]);
        }
    for (int k = 0; k < 3; k++) side_m = fmax(side_m, (high[k] - low[k]) / (cells_along - 1));
    for (int k = 0; k < 3; k++) size[k] = (int)((high[k] - low[k]) / side_m) + 1;
    memset(grid, 0xff, (size_t)(size[0] * size[1] * size[2]) * sizeof *grid);
    for (int i = 0; i < centres->count; i++) {
        const ScatterCentre *c = &centres->centre[i];
        int                  at = 0;
        for (int k = 0; k < 3; k++) at = at * size[k] + (int)((c->p[k] - low[k]) / side_m);
        if (grid[at] < 0) {
            grid[at] = count;
            memset(middle[count], 0, sizeof middle[count]);
            weight[count++] = 0;
        }
        of[i] = grid[at];
        v3_add_scaled(middle[of[i]], middle[of[i]], c->weight, c->p);
        weight[of[i]] += c->weight;
    }
    return count;
}

Status radar_sight_centres(bool *seen, const Making *m, int entity, const double p_enu[3],
                           const double r_enu_from_body[9], const Centres *centres)
{
    const size_t n = (size_t)centres->count + 1;
    int         *of = arena_alloc(m->arena, n, sizeof *of);
    int32_t     *grid = arena_alloc(m->arena, most_cells, sizeof *grid);
    double      *weight = arena_alloc(m->arena, n, sizeof *weight);
    Lines        lines = {.making = m, .entity = entity, .p_enu = arena_alloc(m->arena, n, sizeof *lines.p_enu),
                          .hidden = arena_alloc(m->arena, n, sizeof *lines.hidden)};
    if (!of || !grid || !weight || !lines.p_enu || !lines.hidden) return STATUS_NO_MEMORY;
    if (centres->count == 0) return STATUS_OK;
    lines.count = make_cells(of, lines.p_enu, weight, grid, centres);
    for (int i = 0; i < lines.count; i++) {
        double p_body[3];
        v3_scale(p_body, weight[i] > 0 ? 1 / weight[i] : 0, lines.p_enu[i]);
        m3_mul_v3(lines.p_enu[i], r_enu_from_body, p_body);
        v3_add(lines.p_enu[i], lines.p_enu[i], p_enu);
    }
    const int tasks = (lines.count + block_rays - 1) / block_rays;
    if (m->pool) pool_run(m->pool, tasks, look_along, &lines);
    else for (int t = 0; t < tasks; t++) look_along(&lines, 0, t);
    for (int i = 0; i < centres->count; i++) seen[i] = !lines.hidden[of[i]];
    return STATUS_OK;
}
