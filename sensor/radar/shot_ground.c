/* sensor/radar/shot_ground.c: the ground in a shot: its echoes within the main lobe, wherever it turns, and the range
 * window. */
#include "sensor/radar/seeker_radar_private.h"
#include "render/scattering/paths/radar_path.h"

/* ---- the ground's own echoes -------------------------------------------------------------------- */

enum { cells_most = 400000, block = hits_capacity };

static const double sight_slack_m = 0.5; /* ground met so much before a scatterer is its own */

void shot_lit_rectangle(double low_m[2], double high_m[2], const RadarShot *shot)
{
    const double *p = shot->scene->view->p_enu, reach = shot->frame->reference_m,
                 lobe_rad = asin(fmin(shot->reach * shot_null(shot), 1));
    const double below_m = p[2] - shot->base_m;
    const double level = hypot(shot->ahead[0], shot->ahead[1]), azimuth = atan2(shot->ahead[1], shot->ahead[0]);
    const double turn = atan2(tan(fmin(shot->sector_half_rad, 1.5)), fmax(level, 0.05));
    const double wide = fmin(lobe_rad / fmax(level - lobe_rad, 0.05) + turn, pi_rad), margin_m = 50 + 0.02 * reach;
    const double range_m[2] = {shot->near_m, shot->far_m};
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
    const RadarShot   *shot;
    const ClutterCell *cell;
    int                cells;
    double             widest;        /* sine off the axis of the main lobe's null */
    RadarPoint        *point;         /* [cells]: points of block b begin at b * block */
    int               *kept, *hidden; /* [blocks] */
} GroundJob;

/* Places the cells of the block, as far as they are within beam and window. */
static void place_block(Ground *g, const GroundJob *job, int first, int end)
{
    const RadarShot *shot = job->shot;
    const Landscape *land = shot->scene->world->landscape;
    g->count = 0;
    for (int i = first; i < end; i++) {
        double p[3], n[3];
        Sight  sight;
        clutter_place(p, &shot->radar->cells, &job->cell[i]);
        p[2] = elevation_height(&land->elevation, p[0], p[1], n);
        if (!isfinite(p[2])) continue;
        shot_sight(&sight, shot, p, 0);
        if (!sight.within || shot_off_axis(shot, &sight) > job->widest) continue;
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
static void drop_hidden(Ground *g, const RadarShot *shot, int *hidden)
{
    bool   out[block];
    double slack_m[block];
    for (int i = 0; i < g->count; i++) slack_m[i] = sight_slack_m;
    shot_hidden(out, shot, shot->scene->view->p_enu, g->sight, slack_m, g->count, -1);
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

/* Where plants have echoes of their own, the ground of woods is what grows below them, and is taken as grass. */
static void take_canopy_off(Ground *g, const Foliage *foliage)
{
    for (int i = 0; i < g->count && foliage; i++) {
        const uint8_t s = g->surface[i];
        if ((s == SURFACE_FOREST_BROADLEAF || s == SURFACE_FOREST_CONIFER || s == SURFACE_SCRUB) &&
            foliage_reaches(foliage, g->p_enu[0][i], g->p_enu[1][i]))
            g->surface[i] = SURFACE_GRASS;
    }
}

/* Where buildings stand as themselves, the ground between them is bare. */
static void take_walls_off(Ground *g, const RadarShot *shot)
{
    for (int i = 0; i < g->count && shot->scenery; i++)
        g->surface[i] = shot_bare_surface(shot, g->surface[i], g->p_enu[0][i], g->p_enu[1][i]);
}

static void scatter_block(void *user, int worker, int task)
{
    static _Thread_local Ground           scatterers;
    static _Thread_local ClutterScatterer scatterer[block];
    static _Thread_local ScatterMatrix    matrix[block];
    const GroundJob                      *job = user;
    const RadarShot                      *shot = job->shot;
    const SeekerRadar                    *r = shot->radar;
    Ground                               *g = &scatterers;
    const int first = task * block, end = first + block < job->cells ? first + block : job->cells;
    (void)worker;
    place_block(g, job, first, end);
    job->kept[task] = job->hidden[task] = 0;
    if (g->count == 0) return;
    drop_hidden(g, shot, &job->hidden[task]);
    job->kept[task] = g->count;
    landscape_surfaces(g->surface, shot->scene->world->landscape, g->count, g->p_enu[0], g->p_enu[1]);
    take_canopy_off(g, r->foliage);
    take_walls_off(g, shot);
    const ClutterKind kind = {&r->cells, &r->clutter, r->band};
    clutter_cache_draw(scatterer, r->drawn, &kind, g->count, g->cell, g->surface);
    const double       *p = shot->scene->view->p_enu;
    const ClutterGround ground = {g->count,
                                  g->cell,
                                  g->surface,
                                  {g->p_enu[0], g->p_enu[1], g->p_enu[2]},
                                  {g->n_enu[0], g->n_enu[1], g->n_enu[2]}};
    const ClutterLook   look = {{p[0], p[1], p[2]}, shot->preset->wave.centre_hz, shot->scene->t_s, r->wind_mps};
    clutter_see(matrix, &r->cells, &r->clutter, scatterer, &ground, &look);
    static const double still[3] = {0, 0, 0};
    for (int i = 0; i < g->count; i++) {
        double to_antenna[3], h[3], v[3];
        v3_scale(to_antenna, -1, g->sight[i].d_enu);
        scatter_basis(h, v, to_antenna);
        scatter_turn(&matrix[i], h, v, shot->right);
        job->point[first + i] = (RadarPoint){
            .p_enu = {g->p_enu[0][i], g->p_enu[1][i], g->p_enu[2][i]},
            .path_m = 2 * (g->sight[i].range_m - shot->reference_m),
            .path_per_pulse_m = 2 * (shot_range_rate(shot, &g->sight[i], still) - shot->reference_rate_mps) /
                                shot->preset->wave.repeat_hz,
            .same = shot->preset->transmits_h ? matrix[i].hh : matrix[i].vv,
            .other = shot->preset->transmits_h ? matrix[i].vh : matrix[i].hv,
            .share = 1,
            .widest = job->widest};
    }
}

Status shot_ground(RadarShot *shot)
{
    SeekerRadar  *r = shot->radar;
    const double *p = shot->scene->view->p_enu, widest = fmin(shot->reach * shot_null(shot), 1),
                 lobe_rad = asin(shot_null(shot));
    double low_m[2], high_m[2];
    shot_lit_rectangle(low_m, high_m, shot);

    /* sides of 1/128 of the beam's width, less where the resolution asks for it near by; coarser where that is too
     * many */
    double       share = lobe_rad / 128;
    const size_t most = shot->sector_half_rad > 0 ? 2 * cells_most : cells_most;
    ClutterCell *cell = arena_alloc_raw(shot->arena, most, sizeof *cell);
    size_t       count;
    if (!cell) return STATUS_NO_MEMORY;
    while ((count = clutter_cells_at(cell, most, &r->cells, low_m, high_m, p, share)) > most) share *= sqrt(2);
    const int blocks = (int)((count + block - 1) / block);
    GroundJob job = {.shot = shot,
                     .cell = cell,
                     .cells = (int)count,
                     .widest = widest,
                     .kept = arena_alloc(shot->arena, (size_t)blocks + 1, sizeof *job.kept),
                     .point = radar_points_room(&r->points, blocks * block + 1),
                     .hidden = arena_alloc(shot->arena, (size_t)blocks + 1, sizeof *job.hidden)};
    if (!job.kept || !job.point || !job.hidden) return STATUS_NO_MEMORY;
    if (shot->pool) pool_run(shot->pool, blocks, scatter_block, &job);
    else
        for (int b = 0; b < blocks; b++) scatter_block(&job, 0, b);
    for (int b = 0; b < blocks; b++) {
        const size_t kept = (size_t)job.kept[b];
        memmove(r->points.point + r->points.count, job.point + (size_t)b * block, kept * sizeof *job.point);
        r->points.count += (int)kept;
        shot->frame->ground_cells += job.kept[b] + job.hidden[b];
        shot->frame->ground_hidden += job.hidden[b];
    }
    return STATUS_OK;
}
