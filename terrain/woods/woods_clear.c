/* terrain/woods/woods_clear.c: where plants must not stand. */
#include "terrain/woods/woods_private.h"

#include "terrain/landscape/ways.h"

#include <stdlib.h>

static const double vehicle_m = 4, way_room_m = 1;

/* ---- clearings -------------------------------------------------------------------------------- */

/* From the path's middle. */
static double away_from(const WoodsPath *p, double x_m, double y_m)
{
    const double dx = p->b_m[0] - p->a_m[0], dy = p->b_m[1] - p->a_m[1], square = dx * dx + dy * dy;
    const double ax = x_m - p->a_m[0], ay = y_m - p->a_m[1];
    const double t = square > 0 ? clamp((ax * dx + ay * dy) / square, 0, 1) : 0;
    return hypot(ax - t * dx, ay - t * dy);
}

/* Calls count or put for every square that a path may reach into. */
static void walk_squares(WoodsClearings *c, uint32_t *at, bool put)
{
    static const double reach_m = 4; /* more room than any plant is given */
    for (int n = 0; n < c->count; n++) {
        const WoodsPath *p = &c->path[n];
        int64_t          from[2], end[2];
        for (int k = 0; k < 2; k++) {
            const double low = fmin(p->a_m[k], p->b_m[k]) - p->half_m - reach_m;
            const double high = fmax(p->a_m[k], p->b_m[k]) + p->half_m + reach_m;
            const int64_t first = k ? c->j0 : c->i0;
            const int     squares = k ? c->ny : c->nx;
            from[k] = (int64_t)clamp(floor(low / woods_square_m) - (double)first, 0, squares);
            end[k] = (int64_t)clamp(floor(high / woods_square_m) - (double)first + 1, 0, squares);
        }
        for (int64_t j = from[1]; j < end[1]; j++)
            for (int64_t i = from[0]; i < end[0]; i++) {
                const double x_m = ((double)(c->i0 + i) + 0.5) * woods_square_m;
                const double y_m = ((double)(c->j0 + j) + 0.5) * woods_square_m;
                if (away_from(p, x_m, y_m) > p->half_m + 0.7072 * woods_square_m + reach_m) continue;
                if (put) c->item[at[j * c->nx + i]] = (uint32_t)n;
                at[j * c->nx + i]++;
            }
    }
}

Status woods_clearings_create(WoodsClearings *out, const WoodsSource *s, const WoodsConfig *config)
{
    const LandscapeEvidence *known = &s->landscape->fitted_to;
    const size_t             squares = (size_t)s->nx * (size_t)s->ny;
    WoodsClearings           c = {.i0 = s->i0, .j0 = s->j0, .nx = s->nx, .ny = s->ny};
    c.path  = calloc((size_t)config->path_count + (size_t)known->fix_count + 1, sizeof *c.path);
    c.first = calloc(squares + 2, sizeof *c.first);
    if (!c.path || !c.first) goto lost;
    for (int n = 0; n < config->path_count; n++) c.path[c.count++] = config->path[n];
    for (int n = 0; n < known->fix_count; n++) {
        const double *p = known->fix[n].p_enu;
        c.path[c.count++] = (WoodsPath){{p[0], p[1]}, {p[0], p[1]}, vehicle_m, vehicle_m};
    }
    /* counted at first[2 ..], then summed: while they are filled, first[n + 1] is the next place of square n */
    walk_squares(&c, c.first + 2, false);
    for (size_t n = 1; n <= squares; n++) c.first[n + 1] += c.first[n];
    c.item = calloc((size_t)c.first[squares + 1] + 1, sizeof *c.item);
    if (!c.item) goto lost;
    walk_squares(&c, c.first + 1, true);
    *out = c;
    return STATUS_OK;
lost:
    woods_clearings_free(&c);
    return STATUS_NO_MEMORY;
}

bool woods_is_cleared(const WoodsClearings *c, double x_m, double y_m, double room_m, bool low)
{
    const double i = floor(x_m / woods_square_m) - (double)c->i0, j = floor(y_m / woods_square_m) - (double)c->j0;
    if (!(i >= 0 && j >= 0 && i < c->nx && j < c->ny)) return false;
    const size_t n = (size_t)j * (size_t)c->nx + (size_t)i;
    for (uint32_t k = c->first[n]; k < c->first[n + 1]; k++) {
        const WoodsPath *p = &c->path[c->item[k]];
        if (away_from(p, x_m, y_m) < (low ? p->low_half_m : p->half_m) + room_m) return true;
    }
    return false;
}

void woods_clearings_free(WoodsClearings *c)
{
    free(c->path), free(c->first), free(c->item);
    memset(c, 0, sizeof *c);
}

/* ---- surfaces --------------------------------------------------------------------------------- */

static bool surface_bears(uint8_t surface)
{
    return surface != SURFACE_NONE && surface != SURFACE_WATER && surface != SURFACE_ROAD && surface != SURFACE_TRACK &&
           surface != SURFACE_SNOW;
}

void woods_bears(uint8_t *bears, const WoodsSource *s, int count, const double *x_m, const double *y_m, double room_m,
                 bool low)
{
    enum { some = 256 };
    static const double side[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double              x[some], y[some];
    uint8_t             surface[some];
    for (int first = 0; first < count; first += some) {
        const int n = count - first < some ? count - first : some;
        for (int k = 0; k < n; k++) {
            WayPlace way;
            bears[first + k] = !woods_is_cleared(&s->clearings, x_m[first + k], y_m[first + k], room_m, low);
            if (!landscape_way(&way, s->landscape, x_m[first + k], y_m[first + k])) continue;
            bears[first + k] &= fabs(way.across_m) > way.half_m + way_room_m + room_m;
        }
        for (int q = 0; q < 4; q++) {
            for (int k = 0; k < n; k++) {
                x[k] = x_m[first + k] + side[q][0] * (room_m + way_room_m);
                y[k] = y_m[first + k] + side[q][1] * (room_m + way_room_m);
            }
            landscape_surfaces(surface, s->landscape, n, x, y);
            for (int k = 0; k < n; k++) bears[first + k] &= surface_bears(surface[k]);
        }
    }
}
