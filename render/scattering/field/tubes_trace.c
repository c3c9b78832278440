/* render/scattering/field/tubes_trace.c: follows ray tubes from mirror to mirror, and what each facet radiates. */
#include "render/scattering/field/currents_private.h"
#include "render/scattering/field/tubes_private.h"

#include <stdlib.h>

/* Rays leave a facet from this far above it, past faces of other parts that coincide with it (render/trace/parts counts
 * faces within 0.1 mm as one); their length is taken from the facet itself. */
static const double lift_m = 2e-4;
static const double least_power = 1e-8; /* of the incident field's: weaker tubes end */

typedef struct Tube {
    double p[3], d[3]; /* where it was last mirrored, and its direction since */
    double turn[2][3]; /* change of direction, and */
    double side[2][3]; /* of place, from one ray of the grid to the next */
    Field  e[2];       /* at p, transmitted h and v */
    double path_m;     /* to p */
    float  first[3];
    int    bounces;
} Tube;

struct TubeTile {
    int     count;
    Tube    tube[tile_rays];
    double  o[3][tile_rays], d[3][tile_rays], far_m[tile_rays], range_m[tile_rays];
    PartHit hit[tile_rays];
    double  from[3][tile_rays], to[3][tile_rays], limit_m[tile_rays]; /* towards the receiver */
    uint8_t met[tile_rays], kept[tile_rays], arrived[tile_rays], whole[tile_rays];
    TubeHit record[tile_rays];
    int     alive[tile_rays];
};

size_t tube_tile_octets(void) { return sizeof(TubeTile); }

/* ---- the start -------------------------------------------------------------------------------------- */

/* Starts a tube at x, y of the grid, which are counted in cells. side_m: side of the tube. */
static void start_tube(TubeTile *tile, const TubeWork *work, double x, double y, double side_m)
{
    const TubeGrid *grid = &work->grid;
    const int       i = tile->count++;
    Tube           *tube = &tile->tube[i];
    double          q[3], e[2][3], back_m = grid->back_m;
    const double    x_m = grid->first_m[0] + x * grid->spacing_m, y_m = grid->first_m[1] + y * grid->spacing_m;
    for (int c = 0; c < 3; c++) q[c] = grid->centre[c] + x_m * grid->side[0][c] + y_m * grid->side[1][c];
    if (grid->plane) {
        memcpy(tube->d, grid->axis, sizeof tube->d);
        for (int s = 0; s < 2; s++) {
            memset(tube->turn[s], 0, sizeof tube->turn[s]);
            v3_scale(tube->side[s], side_m, grid->side[s]);
        }
    } else {
        v3_sub(tube->d, q, grid->antenna);
        const double away_m = v3_length(tube->d);
        v3_scale(tube->d, 1 / away_m, tube->d);
        for (int s = 0; s < 2; s++) {
            v3_add_scaled(tube->turn[s], grid->side[s], -v3_dot(grid->side[s], tube->d), tube->d);
            v3_scale(tube->turn[s], side_m / away_m, tube->turn[s]);
        }
        back_m = fmin(back_m, away_m);
    }
    polarise(e, &work->tx, tube->d);
    for (int p = 0; p < 2; p++) {
        memcpy(tube->e[p].re, e[p], sizeof e[p]);
        memset(tube->e[p].im, 0, sizeof tube->e[p].im);
    }
    tube->bounces = 0;
    for (int c = 0; c < 3; c++) {
        tile->o[c][i] = q[c] - back_m * tube->d[c];
        tile->d[c][i] = tube->d[c];
    }
    tile->far_m[i] = INFINITY;
}

/* ---- a hit ------------------------------------------------------------------------------------------ */

/* What a tube meets. */
typedef struct Facing {
    double base[3], flat[3];      /* the point of the facet, and its normal, towards the ray */
    double p[3], n[3], smooth[3]; /* point and normal where the surface is warped; the normal of the curved surface that
                                     facets approximate */
    double sign;                  /* -1: the facet is seen from behind */
    bool   warped;
    double bend[9]; /* second derivatives of the height, towards the ray, 1/m */
} Facing;

/* Crossings of the tube's sides over a length: roots of its cross-section a + b t + c t^2. */
static int caustics(double a, double b, double c, double t_m)
{
    const double end = a + b * t_m + c * t_m * t_m;
    if ((end < 0) != (a < 0)) return 1;
    if (!(c != 0 && b * b > 4 * a * c)) return 0;
    const double middle = -b / (2 * c);
    return middle > 0 && middle < t_m ? 2 : 0;
}

static double cross_section(const double u[3], const double v[3], const double d[3])
{
    double w[3];
    v3_cross(w, u, v);
    return v3_dot(w, d);
}

/* Carries a tube from its last mirror to a point t_m on: spreads the field and widens the tube. */
static void carry(Tube *tube, double t_m)
{
    const double a = cross_section(tube->side[0], tube->side[1], tube->d);
    const double b =
        cross_section(tube->turn[0], tube->side[1], tube->d) + cross_section(tube->side[0], tube->turn[1], tube->d);
    const double c = cross_section(tube->turn[0], tube->turn[1], tube->d);
    const double end = a + t_m * (b + t_m * c);
    const int    crossed = caustics(a, b, c, t_m);
    const double gain = sqrt(fabs(a) / fmax(fabs(end), 1e-9 * fabs(a)));
    for (int s = 0; s < 2; s++) v3_add_scaled(tube->side[s], tube->side[s], t_m, tube->turn[s]);
    for (int p = 0; p < 2; p++) {
        if (gain != 1) field_scale(&tube->e[p], gain);
        for (int q = 0; q < crossed; q++) field_quarter(&tube->e[p]);
    }
    tube->path_m += t_m;
}

/* Tilts the normals of a hit as its surface is warped, and returns how much farther along its ray that is met, m; a ray
 * that grazes meets the plane. */
static double warp_hit(Facing *facing, const Tube *tube, const Warp *warp, const PosedNode *node)
{
    double at[3], from[3], height_m, slope[3], bend[9], gradient[3], half[9];
    memcpy(facing->flat, facing->n, sizeof facing->flat);
    facing->warped = false;
    if (!(warp->amplitude_m > 0)) return 0;
    v3_sub(from, facing->base, node->p_enu);
    m3_tmul_v3(at, node->r_enu_from_node, from);
    tubes_warp_at(&height_m, slope, bend, warp, at);
    m3_mul_v3(gradient, node->r_enu_from_node, slope);
    v3_scale(gradient, facing->sign, gradient);
    v3_add_scaled(gradient, gradient, -v3_dot(gradient, facing->flat), facing->flat);
    const double under = v3_dot(facing->flat, tube->d) - v3_dot(gradient, tube->d);
    if (!(under < -0.02)) return 0;
    facing->warped = true;
    m3_mul(half, node->r_enu_from_node, bend);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            facing->bend[3 * i + j] = facing->sign * v3_dot(half + 3 * i, node->r_enu_from_node + 3 * j);
    v3_sub(facing->n, facing->n, gradient);
    v3_normalize(facing->n, facing->n);
    v3_sub(facing->smooth, facing->smooth, gradient);
    v3_normalize(facing->smooth, facing->smooth);
    return facing->sign * height_m / under;
}

/* Computes the place of the hit and the tube there. False: the ray, without its lift, meets the facet's plane behind
 * it. */
static bool arrive(Tube *tube, Facing *facing, const TubeTile *tile, const TubeWork *work, const PosedFacet *facet,
                   const Warp *warp, int i)
{
    const double o[3] = {tile->o[0][i], tile->o[1][i], tile->o[2][i]};
    parts_facet_normals(facing->n, facing->smooth, work->target->model, facet, o, tube->d, tile->range_m[i]);
    facing->sign = v3_dot(facing->n, facet->geo_enu) < 0 ? -1 : 1;
    v3_add_scaled(facing->base, o, tile->range_m[i], tube->d);
    if (tube->bounces == 0) {
        double way[3];
        v3_add_scaled(facing->p, facing->base, warp_hit(facing, tube, warp, facet->node), tube->d);
        tube->path_m = scatter_path(way, &work->tx, facing->p);
        if (!work->grid.plane) {
            const double away_m = work->tx.range_m + tube->path_m;
            for (int s = 0; s < 2; s++) v3_scale(tube->side[s], away_m, tube->turn[s]);
            for (int p = 0; p < 2; p++) field_scale(&tube->e[p], work->tx.range_m / away_m);
        }
        for (int c = 0; c < 3; c++) tube->first[c] = (float)facing->p[c];
    } else { /* the ray began beside the tube's own point, so its length is taken from there */
        double beside[3];
        v3_sub(beside, o, tube->p);
        const double plane_m = tile->range_m[i] + v3_dot(facing->n, beside) / v3_dot(facing->n, tube->d);
        v3_add_scaled(facing->base, tube->p, plane_m, tube->d);
        const double t_m = plane_m + warp_hit(facing, tube, warp, facet->node);
        if (!(t_m > 0)) return false;
        v3_add_scaled(facing->p, tube->p, t_m, tube->d);
        carry(tube, t_m);
    }
    const double against = v3_dot(facing->n, tube->d);
    for (int s = 0; s < 2; s++)
        v3_add_scaled(tube->side[s], tube->side[s], -v3_dot(facing->n, tube->side[s]) / against, tube->d);
    memcpy(tube->p, facing->p, sizeof tube->p);
    tube->bounces++;
    return v3_length(tube->side[0]) <= work->widest_m && v3_length(tube->side[1]) <= work->widest_m;
}

/* Computes how the smooth normal changes over a displacement on the facet. */
static void bend(double dn[3], const Model *model, const PosedFacet *facet, const Facing *facing, const double w[3])
{
    double          at[3], cross[3], turned[3];
    const uint32_t *index = model->triangle[facet->triangle];
    m3_tmul_v3(at, facet->node->r_enu_from_node, w);
    v3_cross(cross, at, facet->ac);
    const double b = v3_dot(cross, facet->n) / facet->area2;
    v3_cross(cross, facet->ab, at);
    const double c = v3_dot(cross, facet->n) / facet->area2;
    for (int x = 0; x < 3; x++) {
        const double n0 = (double)model->normal[index[0]][x];
        turned[x] = b * ((double)model->normal[index[1]][x] - n0) + c * ((double)model->normal[index[2]][x] - n0);
    }
    m3_mul_v3(dn, facet->node->r_enu_from_node, turned);
    v3_scale(dn, facing->sign, dn);
    v3_add_scaled(dn, dn, -v3_dot(dn, facing->smooth), facing->smooth);
}

/* Gives the tube the direction, the spreading and the field that it has after the mirror. */
static void leave(Tube *tube, const TubeWork *work, const PosedFacet *facet, const Facing *facing,
                  const RadarSurface *surface, double complex te, double complex tm)
{
    double        d_out[3];
    const double *n = facing->smooth;
    mirror_direction(d_out, tube->d, n);
    const bool bent = !facet->even || facing->warped;
    const bool curved = bent && v3_dot(n, tube->d) < 0 && v3_dot(d_out, facing->flat) > 1e-6;
    if (!curved) {
        n = facing->flat;
        mirror_direction(d_out, tube->d, n);
    }
    const double facing_d = v3_dot(n, tube->d);
    for (int s = 0; s < 2; s++) {
        double dn[3] = {0, 0, 0};
        if (curved && !facet->even) bend(dn, work->target->model, facet, facing, tube->side[s]);
        if (curved && facing->warped) {
            double over[3];
            m3_mul_v3(over, facing->bend, tube->side[s]);
            v3_sub(dn, dn, over);
            v3_add_scaled(dn, dn, -v3_dot(dn, n), n);
        }
        const double along = v3_dot(n, tube->turn[s]) + v3_dot(tube->d, dn);
        for (int c = 0; c < 3; c++) tube->turn[s][c] -= 2 * (along * n[c] + facing_d * dn[c]);
    }
    for (int p = 0; p < 2; p++) {
        const Field e = tube->e[p];
        reflect_field(&tube->e[p], &e, surface, te, tm, n, tube->d, d_out);
    }
    memcpy(tube->d, d_out, sizeof tube->d);
}

/* Records what a facet radiates towards the receiver. False: it radiates nothing that way. */
static bool record_hit(TubeHit *record, const Tube *tube, const TubeWork *work, const Facing *facing,
                       const RadarSurface *surface, double complex te, double complex tm, int part)
{
    double       s[3], footprint[3], radiated[8];
    const double path_m = scatter_path(s, &work->rx, tube->p);
    if (!(v3_dot(facing->n, s) > 0) && !work->config.keep_hidden) return false;
    v3_cross(footprint, tube->side[0], tube->side[1]);
    double area_m2 = 0.5 * v3_length(footprint);
    if (!isinf(work->rx.range_m)) area_m2 *= work->rx.range_m / (work->rx.range_m + path_m);
    facet_radiates(radiated, tube->e, surface, te, tm, facing->n, tube->d, s, &work->rx);
    for (int i = 0; i < 8; i++) record->amplitude[i] = (float)(area_m2 * radiated[i]);
    const double against = v3_dot(facing->smooth, tube->d);
    for (int i = 0; i < 2; i++) {
        double side[3];
        memcpy(side, tube->side[i], sizeof side);
        if (against < -0.05) v3_add_scaled(side, side, -v3_dot(facing->smooth, side) / against, tube->d);
        record->slope_m[i] = (float)(0.5 * (v3_dot(s, side) - v3_dot(tube->d, side)));
    }
    record->path_m = tube->path_m + path_m;
    for (int c = 0; c < 3; c++) {
        record->first[c] = tube->first[c];
        record->last[c] = (float)tube->p[c];
    }
    record->bounce = (uint8_t)tube->bounces;
    record->part = (uint16_t)part;
    return true;
}

static double power_of(const Tube *tube)
{
    double most = 0;
    for (int p = 0; p < 2; p++)
        most = fmax(most, v3_dot(tube->e[p].re, tube->e[p].re) + v3_dot(tube->e[p].im, tube->e[p].im));
    return most;
}

/* ---- a tile ----------------------------------------------------------------------------------------- */

static bool keep(TubeWorker *worker, const TubeHit *hit)
{
    if (worker->count == worker->capacity) {
        const size_t want = worker->capacity ? 2 * worker->capacity : 4096;
        TubeHit     *larger = realloc(worker->hit, want * sizeof *larger);
        if (!larger) return false;
        worker->hit = larger;
        worker->capacity = want;
    }
    worker->hit[worker->count++] = *hit;
    return true;
}

/* Mirrors the rays of a list that met something: records them and sets the way on. Fills `alive` with those that go on.
 */
static int mirror_all(TubeTile *tile, TubeWork *work, const int *list, int count)
{
    const Model *model = work->target->model;
    PosedFacet   facet = {.node = NULL};
    int          alive = 0;
    for (int k = 0; k < count; k++) {
        const int i = list[k];
        Tube     *tube = &tile->tube[i];
        Facing    facing;
        tile->kept[i] = tile->arrived[i] = tile->whole[i] = 0;
        if (isinf(tile->range_m[i])) continue;
        const PosedNode *node = &work->target->entity.node[tile->hit[i].node];
        if (facet.node != node || facet.triangle != tile->hit[i].triangle)
            parts_facet(&facet, model, &work->target->entity, &tile->hit[i]);
        const int part = model->triangle_part[tile->hit[i].triangle];
        if (!arrive(tube, &facing, tile, work, &facet, &work->warp[part], i)) continue;
        tile->arrived[i] = 1;
        tile->whole[i] = work->whole && tube->bounces == 1 && work->whole[tile->hit[i].triangle];
        const RadarSurface *surface = &work->surface[part];
        double complex      te = -1, tm = 1;
        if (surface->kind != RADAR_METAL || surface->rough_m > 0)
            fresnel_surface(&te, &tm, surface, work->k, fmin(1, -v3_dot(facing.n, tube->d)));
        tile->kept[i] = record_hit(&tile->record[i], tube, work, &facing, surface, te, tm, part);
        if (tile->kept[i]) {
            double       s[3];
            const double path_m = scatter_path(s, &work->rx, tube->p);
            for (int c = 0; c < 3; c++) {
                tile->from[c][i] = facing.base[c] + lift_m * facing.flat[c];
                tile->to[c][i] = s[c];
            }
            tile->limit_m[i] = work->rx.range_m + path_m;
        }
        if (tube->bounces > work->config.bounces - !work->config.last_only) continue;
        leave(tube, work, &facet, &facing, surface, te, tm);
        if (!(power_of(tube) >= least_power)) continue;
        for (int c = 0; c < 3; c++) {
            tile->o[c][i] = facing.base[c] + lift_m * facing.flat[c];
            tile->d[c][i] = tube->d[c];
        }
        tile->alive[alive++] = i;
    }
    return alive;
}

/* Records whose facet the receiver does not see are dropped. */
static void hide(TubeTile *tile, const TubeWork *work, const int *list, int count, int bounce)
{
    int asked[tile_rays], asks = 0;
    if (work->config.keep_hidden || (work->monostatic && bounce == 1)) return;
    for (int k = 0; k < count; k++)
        if (tile->kept[list[k]]) {
            tile->met[list[k]] = 0;
            asked[asks++] = list[k];
        }
    const double *const from[3] = {tile->from[0], tile->from[1], tile->from[2]};
    const double *const to[3] = {tile->to[0], tile->to[1], tile->to[2]};
    parts_any_hits(tile->met, &work->target->entity, from, to, tile->limit_m, asked, asks, false);
    for (int k = 0; k < asks; k++)
        if (tile->met[asked[k]]) tile->kept[asked[k]] = 0;
}

static void find_next(TubeTile *tile, const TubeWork *work, const int *list, int count)
{
    const double *const o[3] = {tile->o[0], tile->o[1], tile->o[2]}, *const d[3] = {tile->d[0], tile->d[1], tile->d[2]};
    for (int k = 0; k < count; k++) tile->range_m[list[k]] = INFINITY;
    parts_first_hits(tile->range_m, tile->hit, &work->target->entity, o, d, tile->far_m, list, count, false);
}

static void open_tile(TubeTile *tile, const TubeWork *work, long long number, int level, const TubeCell *cell,
                      int count)
{
    const int    column = (int)(number % work->grid.tiles[0]) * tile_side;
    const int    row = (int)(number / work->grid.tiles[0]) * tile_side;
    const double share = 1.0 / (1 << level);
    tile->count = 0;
    for (int k = 0; k < count; k++)
        start_tube(tile, work, column + (cell[k].x + 0.5) * share - 0.5, row + (cell[k].y + 0.5) * share - 0.5,
                   share * work->grid.spacing_m);
}

/* Notes in a cell what its tube met at a mirror. */
static void leave_mark(TubeCell *cell, const TubeTile *tile, int i, int bounce)
{
    if (!tile->arrived[i] || bounce > trail_most) return;
    const TubeHit *record = &tile->record[i];
    TubeMark      *mark = &cell->mark[bounce - 1];
    cell->marks = bounce;
    mark->seen = tile->kept[i];
    mark->whole = tile->whole[i];
    if (!mark->seen) return;
    mark->path_m = record->path_m;
    memcpy(mark->slope_m, record->slope_m, sizeof mark->slope_m);
    mark->part = record->part;
}

bool tube_follow(TubeWork *work, int worker_at, long long number, int level, TubeCell *cell, int cells, int first)
{
    TubeWorker *worker = &work->worker[worker_at];
    TubeTile   *tile = worker->tile;
    int         list[tile_rays];
    bool        good = true;
    open_tile(tile, work, number, level, cell, cells);
    int count = tile->count;
    for (int i = 0; i < count; i++) list[i] = i;
    find_next(tile, work, list, count);
    for (int bounce = 1; count > 0; bounce++) {
        const int alive = mirror_all(tile, work, list, count);
        hide(tile, work, list, count, bounce);
        find_next(tile, work, tile->alive, alive);
        for (int k = 0; k < count; k++) leave_mark(&cell[list[k]], tile, list[k], bounce);
        if (work->config.last_only)
            for (int k = 0; k < alive; k++)
                if (!isinf(tile->range_m[tile->alive[k]])) tile->kept[tile->alive[k]] = 0;
        for (int k = 0; k < count; k++) {
            tile->record[list[k]].cell = first + list[k];
            if (tile->kept[list[k]] && !tile->whole[list[k]]) good &= keep(worker, &tile->record[list[k]]);
        }
        memcpy(list, tile->alive, (size_t)alive * sizeof *list);
        count = alive;
        if (work->config.last_only && bounce > work->config.bounces) break;
    }
    return good;
}
