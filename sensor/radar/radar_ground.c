/* sensor/radar/radar_ground.c: the echoes of the ground within the main lobe, wherever it turns, and range window. */
#include "sensor/radar/seeker_radar_private.h"

enum { cells_most = 400000, block = hits_capacity };

static const double sight_slack_m = 0.5; /* ground met so much before a scatterer is its own */

void making_lit_rectangle(double low_m[2], double high_m[2], const Making *m)
{
    const double *p = m->scene->view->p_enu, reach = m->frame->reference_m,
                 lobe_rad = asin(fmin(m->reach * making_null(m), 1));
    const double  below_m = p[2] - m->base_m;
    const double  level = hypot(m->ahead[0], m->ahead[1]), azimuth = atan2(m->ahead[1], m->ahead[0]);
    const double  turn = atan2(tan(fmin(m->scan_half_rad, 1.5)), fmax(level, 0.05));
    const double  wide = fmin(lobe_rad / fmax(level - lobe_rad, 0.05) + turn, pi_rad), margin_m = 50 + 0.02 * reach;
    const double  range_m[2] = {m->near_m, m->far_m};
    low_m[0] = low_m[1] = INFINITY;
    high_m[0] = high_m[1] = -INFINITY;
    for (int end = 0; end < 2; end++) {
        const double plan_m =
            sqrt(fmax(range_m[end] * range_m[end] - below_m * below_m, 0)) + (end ? margin_m : -margin_m);
        for (int i = -4; i <= 4; i++) {
            const double a = azimuth + wide * i / 4,
                         at[2] = {p[0] + fmax(plan_m, 0) * cos(a), p[1] + fmax(plan_m, 0) * sin(a)};
            for (int k = 0; k < 2; k++) {
                low_m[k] = fmin(low_m[k], at[k]);
                high_m[k] = fmax(high_m[k], at[k]);
            }
        }
    }
}

/* Scatterers of a block, as the table and the echoes need them. */
typedef struct Ground {
    int         count;
    ClutterCell cell[block];
    double      p_enu[3][block];
    float       n_enu[3][block];
    uint8_t     surface[block];
    Sight       sight[block];
} Ground;

typedef struct GroundJob {
    const Making      *making;
    const ClutterCell *cell;
    int                cells;
    double             widest;     /* sine off the axis of the main lobe's null */
    Ground            *ground;     /* [blocks] */
    RadarPoint        *point;      /* [cells]: those of block b from b * block on */
    int               *hidden;     /* [blocks] */
} GroundJob;

/* Where the block's cells lie, those within beam and window alone. */
static void place_block(Ground *g, const GroundJob *job, int first, int end)
{
    const Making    *m = job->making;
    const Landscape *land = m->scene->world->landscape;
    g->count = 0;
    for (int i = first; i < end; i++) {
        double p[3], n[3];
        Sight  sight;
        clutter_place(p, &m->radar->cells, &job->cell[i]);
        p[2] = elevation_height(&land->elevation, p[0], p[1], n);
        if (!isfinite(p[2])) continue;
        making_sight(&sight, m, p, 0);
        if (!sight.within || making_off_axis(m, &sight) > job->widest) continue;
        const int to = g->count++;
        g->cell[to] = job->cell[i];
        g->sight[to] = sight;
        for (int k = 0; k < 3; k++) {
            g->p_enu[k][to] = p[k];
            g->n_enu[k][to] = (float)n[k];
        }
    }
}

/* Takes out what relief or entities hide. */
static void drop_hidden(Ground *g, const Making *m, int *hidden)
{
    bool   out[block];
    double slack_m[block];
    for (int i = 0; i < g->count; i++) slack_m[i] = sight_slack_m;
    making_hidden(out, m, m->scene->view->p_enu, g->sight, slack_m, g->count, -1);
    int kept = 0;
    for (int i = 0; i < g->count; i++) {
        if (out[i]) continue;
        g->cell[kept] = g->cell[i];
        g->sight[kept] = g->sight[i];
        for (int k = 0; k < 3; k++) {
            g->p_enu[k][kept] = g->p_enu[k][i];
            g->n_enu[k][kept] = g->n_enu[k][i];
        }
        kept++;
    }
    *hidden = g->count - kept;
    g->count = kept;
}

/* Where plants stand on their own, the ground of woods is what grows below them: as grass. */
static void take_canopy_off(Ground *g, const Foliage *foliage)
{
    for (int i = 0; i < g->count && foliage; i++) {
        const uint8_t s = g->surface[i];
        if ((s == SURFACE_FOREST_BROADLEAF || s == SURFACE_FOREST_CONIFER || s == SURFACE_SCRUB) &&
            foliage_reaches(foliage, g->p_enu[0][i], g->p_enu[1][i]))
            g->surface[i] = SURFACE_GRASS;
    }
}

static void scatter_block(void *user, int worker, int task)
{
    static _Thread_local ClutterScatterer scatterer[block];
    static _Thread_local ScatterMatrix    matrix[block];
    const GroundJob *job = user;
    const Making    *m = job->making;
    const SeekerRadar *r = m->radar;
    Ground          *g = &job->ground[task];
    const int        first = task * block, end = first + block < job->cells ? first + block : job->cells;
    (void)worker;
    place_block(g, job, first, end);
    job->hidden[task] = 0;
    if (g->count == 0) return;
    drop_hidden(g, m, &job->hidden[task]);
    landscape_surfaces(g->surface, m->scene->world->landscape, g->count, g->p_enu[0], g->p_enu[1]);
    take_canopy_off(g, r->foliage);
    clutter_cache_draw(scatterer, r->drawn, &r->cells, &r->clutter, r->band, g->count, g->cell, g->surface);
    const double       *p = m->scene->view->p_enu;
    const ClutterGround ground = {g->count, g->cell, g->surface, {g->p_enu[0], g->p_enu[1], g->p_enu[2]},
                                  {g->n_enu[0], g->n_enu[1], g->n_enu[2]}};
    const ClutterLook   look = {{p[0], p[1], p[2]}, m->preset->wave.centre_hz, m->scene->t_s, r->wind_mps};
    clutter_see(matrix, &r->cells, &r->clutter, scatterer, &ground, &look);
    static const double still[3] = {0, 0, 0};
    for (int i = 0; i < g->count; i++) {
        double to_antenna[3], h[3], v[3];
        v3_scale(to_antenna, -1, g->sight[i].d_enu);
        scatter_basis(h, v, to_antenna);
        scatter_turn(&matrix[i], h, v, m->right);
        job->point[first + i] = (RadarPoint){
            .p_enu = {g->p_enu[0][i], g->p_enu[1][i], g->p_enu[2][i]},
            .path_m = 2 * (g->sight[i].range_m - m->reference_m),
            .path_per_pulse_m = 2 * (making_range_rate(m, &g->sight[i], still) - m->reference_rate_mps) /
                                m->preset->wave.repeat_hz,
            .same = m->preset->transmits_h ? matrix[i].hh : matrix[i].vv,
            .other = m->preset->transmits_h ? matrix[i].vh : matrix[i].hv,
            .share = 1, .widest = job->widest};
    }
}

Status making_ground(Making *m)
{
    SeekerRadar  *r = m->radar;
    const double *p = m->scene->view->p_enu, widest = fmin(m->reach * making_null(m), 1),
                 lobe_rad = asin(making_null(m));
    double        low_m[2], high_m[2];
    making_lit_rectangle(low_m, high_m, m);

    /* sides of 1/128 of the beam's width, less where the resolution asks for it near by; coarser where that is too
     * many */
    double       share = lobe_rad / 128;
    const size_t most = m->scan_half_rad > 0 ? 2 * cells_most : cells_most;
    ClutterCell *cell = arena_alloc(m->arena, most, sizeof *cell);
    size_t       count;
    if (!cell) return STATUS_NO_MEMORY;
    while ((count = clutter_cells_at(cell, most, &r->cells, low_m, high_m, p, share)) > most) share *= sqrt(2);
    const int    blocks = (int)((count + block - 1) / block);
    GroundJob    job = {.making = m, .cell = cell, .cells = (int)count, .widest = widest,
                        .ground = arena_alloc(m->arena, (size_t)blocks + 1, sizeof *job.ground),
                        .point = points_room(&r->points, blocks * block + 1),
                        .hidden = arena_alloc(m->arena, (size_t)blocks + 1, sizeof *job.hidden)};
    if (!job.ground || !job.point || !job.hidden) return STATUS_NO_MEMORY;
    if (m->pool) pool_run(m->pool, blocks, scatter_block, &job);
    else for (int b = 0; b < blocks; b++) scatter_block(&job, 0, b);
    for (int b = 0; b < blocks; b++) {
        const size_t kept = (size_t)job.ground[b].count;
        memmove(r->points.point + r->points.count, job.point + (size_t)b * block, kept * sizeof *job.point);
        r->points.count += (int)kept;
        m->frame->ground_cells += job.ground[b].count + job.hidden[b];
        m->frame->ground_hidden += job.hidden[b];
    }
    return STATUS_OK;
}
