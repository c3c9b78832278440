/* render/ground/ground.c: the elevation in the form that the ray tracers use, and the scalar tracer. */
#include "render/ground/ground_private.h"

/* Of the whole level's edges; of a small level without rises, as far as its posts can be apart. */
static double steepest(const GroundLevel *g)
{
    if (!g->rise[g->top]) return elevation_highest_post - elevation_lowest_post;
    const ElevationRise r = *g->rise[g->top];
    const int           along = r.east > r.west ? r.east : r.west, across = r.north > r.south ? r.north : r.south;
    return g->rise_unit * (along > across ? along : across);
}

void ground_prepare(Ground *out, const Elevation *elevation)
{
    *out = (Ground){.elevation = elevation, .level_count = elevation ? elevation->level_count : 0};
    for (int k = 0; k < out->level_count; k++) {
        const ElevationLevel *e = &elevation->level[k];
        GroundLevel          *g = &out->level[k];
        *g = (GroundLevel){.stored = e->stored, .tile = e->tile, .plain = e->plain, .tiles_x = e->tiles_x,
                           .cells_x = e->nx - 1, .cells_y = e->ny - 1, .top = e->pyramid_count - 1,
                           .pyramid_base = e->pyramid_base, .pyramid_shift = e->pyramid_shift,
                           .rise_unit = 1 << e->rise_shift, .x0_m = e->x0_m, .y0_m = e->y0_m, .z0_m = e->z0_m,
                           .cells_per_m = 1 / e->spacing_m, .posts_per_m = 1 / e->step_m};
        for (int p = 0; p < e->pyramid_count; p++) {
            g->pyramid[p]    = e->pyramid[p];
            g->rise[p]       = e->rise[p];
            g->pyramid_nx[p] = e->pyramid_nx[p];
        }
        g->highest  = ground_highest(g, g->top, 0, 0);
        g->steepest = steepest(g);
    }
}

/* Interval of t over which the ray is above the rectangle of a level; false: none from 0 on. */
static bool level_interval(LevelRay *r, const GroundLevel *g)
{
    const double u_low = (0 - r->u0) * r->per_du, u_high = (g->cells_x - r->u0) * r->per_du;
    const double v_low = (0 - r->v0) * r->per_dv, v_high = (g->cells_y - r->v0) * r->per_dv;
    const double u_in = r->per_du > 0 ? u_low : u_high, u_out = r->per_du > 0 ? u_high : u_low;
    const double v_in = r->per_dv > 0 ? v_low : v_high, v_out = r->per_dv > 0 ? v_high : v_low;
    r->first_m = u_in > v_in ? u_in : v_in;
    r->first_m = r->first_m > 0 ? r->first_m : 0;
    r->last_m  = u_out < v_out ? u_out : v_out;
    return r->first_m < r->last_m;
}

static void add_piece(GroundRay *out, int level, double first_m, double last_m)
{
    if (!(first_m < last_m && first_m < farthest_m)) return;
    out->level[out->piece_count]   = level;
    out->first_m[out->piece_count] = first_m;
    out->last_m[out->piece_count]  = last_m;
    out->piece_count++;
}

void ground_ray(GroundRay *out, const Ground *ground, const double o[3], const double d[3], double far_m)
{
    static const double usable_m = 1e9; /* beyond it a cell number would lose its fraction */
    out->piece_count = out->piece = 0;
    if (!(fabs(o[0]) <= usable_m && fabs(o[1]) <= usable_m && fabs(o[2]) <= usable_m)) return;
    if (!(fabs(d[0]) <= 2 && fabs(d[1]) <= 2 && fabs(d[2]) <= 2 && v3_dot(d, d) > 0.25 && far_m > 0)) return;

    int inner = ground->level_count; /* innermost level that the ray passes */
    for (; inner > 0; inner--) {
        ground_level_ray(&out->of_level[inner - 1], &ground->level[inner - 1], o, d);
        if (!level_interval(&out->of_level[inner - 1], &ground->level[inner - 1])) break;
    }
    if (inner == ground->level_count) return;

    const LevelRay *r = out->of_level;
    for (int k = ground->level_count - 1; k > inner; k--)
        add_piece(out, k, r[k].first_m, fmin(r[k - 1].first_m, r[k].last_m));
    add_piece(out, inner, r[inner].first_m, r[inner].last_m);
    for (int k = inner + 1; k < ground->level_count; k++)
        add_piece(out, k, fmax(r[k - 1].last_m, r[k].first_m), r[k].last_m);
}

/* Traces one level. Descends the max pyramid where the ray comes lower than a node's highest post, steps along it
 * otherwise, and ascends wherever it leaves a parent. */
static double level_first_hit(GroundHit *hit, const GroundLevel *g, const LevelRay *r, double far_m)
{
    double t, stop;
    ground_walk(&t, &stop, g, r, far_m);
    const bool east = r->per_du > 0, north = r->per_dv > 0;
    int        k = ground_start_level(g, r), i = 0, j = 0;
    if (!(t < stop)) return INFINITY;
    i = ground_cell_at(r->u0, r->du, r->per_du, t, g->cells_x);
    j = ground_cell_at(r->v0, r->dv, r->per_dv, t, g->cells_y);
    for (;;) {
        const int    node_i = i >> k, node_j = j >> k;
        const int    line_u = (node_i + east) << k, line_v = (node_j + north) << k;
        const double at_u = (line_u - r->u0) * r->per_du, at_v = (line_v - r->v0) * r->per_dv;
        double       next = at_u < at_v ? at_u : at_v;
        next = next < r->last_m ? next : r->last_m;
        const double lowest  = r->w0 + (r->dw < 0 ? next : t) * r->dw;
        const int32_t highest = k > 0 ? ground_highest(g, k, node_i, node_j) : ground_cell_highest(g, i, j);
        if (!(lowest > highest + ground_clear_posts)) {
            if (k > 0) {
                k = ground_level_below(k);
                continue;
            }
            bool         north_west;
            const double range_m = ground_cell_hit(g, r, i, j, &north_west);
            if (range_m < INFINITY) {
                if (!(range_m < far_m)) return INFINITY;
                if (hit) *hit = (GroundHit){.i = i, .j = j, .north_west = north_west};
                return range_m;
            }
        }
        t = next;
        if (!(t < stop)) return INFINITY;
        const bool crosses_u = at_u <= t, crosses_v = at_v <= t;
        if (crosses_u) i = east ? line_u : line_u - 1;
        else if (k > 0) i = ground_cell_at(r->u0, r->du, r->per_du, t, g->cells_x);
        if (crosses_v) j = north ? line_v : line_v - 1;
        else if (k > 0) j = ground_cell_at(r->v0, r->dv, r->per_dv, t, g->cells_y);
        const int up = ground_level_above(k), inside = (1 << up) - 1; /* lines of the parent */
        if (k < g->top && ((crosses_u && !(line_u & inside)) || (crosses_v && !(line_v & inside)))) k = up;
    }
}

double ground_first_hit(GroundHit *hit, const Ground *ground, const double o_enu[3], const double d_enu[3],
                        double far_m)
{
    GroundRay ray;
    ground_ray(&ray, ground, o_enu, d_enu, far_m);
    for (int p = 0; p < ray.piece_count; p++) {
        const int level = ray.level[p];
        LevelRay *r = &ray.of_level[level];
        r->first_m = ray.first_m[p];
        r->last_m  = ray.last_m[p];
        const double range_m = level_first_hit(hit, &ground->level[level], r, far_m);
        if (range_m < INFINITY) {
            if (hit) hit->level = level;
            return range_m;
        }
    }
    return INFINITY;
}
