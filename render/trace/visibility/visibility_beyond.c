/* render/trace/visibility/visibility_beyond.c: the round Earth beyond the terrain's outline, among what rays can meet.
 *
 * The ellipsoid (WGS 84) raised to the lowest ground of the outline. Rays bend there as over the ground: a ray's square
 * of the distance from the centre, in axes that make the ellipsoid a unit sphere, is a convex function of its range, so
 * that Newton's steps from the outline outwards reach the first root without passing it. Where the outline in a place's
 * direction is water, so is the place; else it has the surface of the place that is mirrored at the outline. */
#include "render/trace/visibility/visibility_private.h"

#include <float.h>

static const double equator_m = 6378137, pole_m = 6378137 * (1 - 1 / 298.257223563); /* WGS 84 */
static const double least_half_m = 100e3; /* a narrower terrain was not made to reach the horizon */

struct RoundEarth {
    double low_m[2], high_m[2]; /* the terrain's outline: east, north */
    double inset_m;             /* half a cell of its outermost level */
    double unit_from_enu[9];    /* of directions */
    double origin[3];           /* of the local frame, from the Earth's centre */
};

/* Lowest ground of the outline, m over the ellipsoid; false: there is none. */
static bool lowest_of_outline(double *low_m, const RoundEarth *e, const Visibility *v)
{
    enum { sides = 4, places = 16 };
    *low_m = INFINITY;
    for (int n = 0; n < sides * places; n++) {
        const int    side = n / places, along = side & 1;
        const double share = (n % places + 0.5) / places;
        double       p_enu[3], p_ecef[3];
        Geodetic     at;
        p_enu[along] = e->low_m[along] + share * (e->high_m[along] - e->low_m[along]);
        p_enu[!along] = side < 2 ? e->low_m[!along] + e->inset_m : e->high_m[!along] - e->inset_m;
        p_enu[2] = elevation_height(&v->landscape->elevation, p_enu[0], p_enu[1], NULL);
        ecef_from_enu(p_ecef, v->frame, p_enu);
        if (geodetic_from_ecef(&at, p_ecef) == STATUS_OK && at.h_m < *low_m) *low_m = at.h_m;
    }
    return *low_m < INFINITY;
}

/* Distance from a place to the nearest side of the outline, m; below 0 outside. */
static double room_at(const RoundEarth *e, double x_m, double y_m)
{
    return fmin(fmin(x_m - e->low_m[0], e->high_m[0] - x_m), fmin(y_m - e->low_m[1], e->high_m[1] - y_m));
}

Status visibility_round_earth(Visibility *v, Arena *arena)
{
    const Elevation *ground = v->landscape ? &v->landscape->elevation : NULL;
    if (!ground || ground->level_count < 1) return STATUS_OK;
    const ElevationLevel *level = &ground->level[ground->level_count - 1];
    RoundEarth            e = {.low_m = {level->x0_m, level->y0_m}, .inset_m = 0.5 * level->spacing_m};
    double                low_m, eye_ecef[3];
    Geodetic              eye;
    e.high_m[0] = level->x0_m + (level->nx - 1) * level->spacing_m;
    e.high_m[1] = level->y0_m + (level->ny - 1) * level->spacing_m;
    if (!(e.high_m[0] - e.low_m[0] >= 2 * least_half_m && e.high_m[1] - e.low_m[1] >= 2 * least_half_m))
        return STATUS_OK;
    ecef_from_enu(eye_ecef, v->frame, v->eye_enu);
    if (geodetic_from_ecef(&eye, eye_ecef) != STATUS_OK) return STATUS_OK;
    /* The ground hides all beyond it from an eye whose horizon is nearer than the outline, by the ample radius of 4/3,
     * as long as the outline is no more than 500 m lower than the ellipsoid. */
    const double room_m = fmax(room_at(&e, v->eye_enu[0], v->eye_enu[1]), 0), over_m = eye.h_m + 500;
    if (2 * 4.0 / 3 * equator_m * over_m < room_m * room_m) return STATUS_OK;
    if (!lowest_of_outline(&low_m, &e, v)) return STATUS_OK;
    for (int c = 0; c < 3; c++) {
        const double axis_m = (c < 2 ? equator_m : pole_m) + low_m;
        e.origin[c] = v->frame->origin_ecef[c] / axis_m;
        for (int k = 0; k < 3; k++) e.unit_from_enu[3 * c + k] = v->frame->r_ecef_from_enu[3 * c + k] / axis_m;
    }
    RoundEarth *kept = arena_alloc(arena, 1, sizeof *kept);
    if (!kept) return STATUS_NO_MEMORY;
    *kept = e;
    v->round = kept;
    return visibility_add(v, &trace_beyond, kept);
}

bool visibility_is_beyond(const Visibility *v, double x_m, double y_m)
{
    return v->round && room_at(v->round, x_m, y_m) <= 0;
}

/* ---- one ray ---------------------------------------------------------------------------------- */

/* A ray in those axes: o + t d - t^2 sink. */
typedef struct UnitRay {
    double o[3], d[3], sink[3];
} UnitRay;

static void unit_ray(UnitRay *out, const RoundEarth *e, const double o_enu[3], const double d_enu[3], double bend_per_m)
{
    const double sink_enu[3] = {0, 0, bend_per_m * (d_enu[0] * d_enu[0] + d_enu[1] * d_enu[1])};
    m3_mul_v3(out->o, e->unit_from_enu, o_enu);
    v3_add(out->o, out->o, e->origin);
    m3_mul_v3(out->d, e->unit_from_enu, d_enu);
    m3_mul_v3(out->sink, e->unit_from_enu, sink_enu);
}

/* First range from from_m on at which the ray is not above the Earth; INFINITY: none. */
static double range_from(const UnitRay *r, double from_m)
{
    enum { most_steps = 64 }; /* a ray that grazes halves its error in each */
    static const double enough_m = 1e-4;
    double              t = from_m;
    for (int n = 0; n < most_steps; n++) {
        double at[3], way[3];
        for (int c = 0; c < 3; c++) {
            at[c] = r->o[c] + t * (r->d[c] - t * r->sink[c]);
            way[c] = r->d[c] - 2 * t * r->sink[c];
        }
        const double over = v3_dot(at, at) - 1, rate = 2 * v3_dot(at, way);
        if (over <= 0) return t;
        if (!(rate < 0)) return INFINITY;
        t -= over / rate;
        if (-over / rate < enough_m) return t;
    }
    return t;
}

/* Ranges between which a ray is within the outline. false: nowhere. */
static bool outline_span(double span_m[2], const RoundEarth *e, const double o_enu[3], const double d_enu[3])
{
    span_m[0] = 0, span_m[1] = INFINITY;
    for (int c = 0; c < 2; c++) {
        if (!(fabs(d_enu[c]) > DBL_MIN)) {
            if (!(o_enu[c] >= e->low_m[c] && o_enu[c] <= e->high_m[c])) return false;
            continue;
        }
        const double a = (e->low_m[c] - o_enu[c]) / d_enu[c], b = (e->high_m[c] - o_enu[c]) / d_enu[c];
        span_m[0] = fmax(span_m[0], fmin(a, b));
        span_m[1] = fmin(span_m[1], fmax(a, b));
    }
    return span_m[0] <= span_m[1];
}

static double range_beyond(const RoundEarth *e, const double o_enu[3], const double d_enu[3], double bend_per_m,
                           double limit_m)
{
    double     span_m[2];
    UnitRay    ray;
    const bool crosses = outline_span(span_m, e, o_enu, d_enu);
    if (crosses && span_m[0] <= 0 && !(span_m[1] < limit_m)) return INFINITY;
    unit_ray(&ray, e, o_enu, d_enu, bend_per_m);
    if (!crosses || span_m[0] > 0) { /* from outside; what lies below the Earth there meets nothing */
        if (!(v3_dot(ray.o, ray.o) > 1)) return INFINITY;
        const double before_m = range_from(&ray, 0);
        if (!crosses || before_m < span_m[0]) return before_m;
    }
    return span_m[1] < limit_m ? range_from(&ray, span_m[1]) : INFINITY;
}

/* ---- the entry -------------------------------------------------------------------------------- */

static void beyond_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    const RoundEarth *e = self;
    const double      bend_per_m = block->rays->bent ? block->v->seen.bend_per_m : 0;
    (void)found;
    for (int i = 0; i < block->rays->count; i++) {
        const double o_enu[3] = {block->o_enu[0][i], block->o_enu[1][i], block->o_enu[2][i]};
        const double d_enu[3] = {block->d_enu[0][i], block->d_enu[1][i], block->d_enu[2][i]};
        range_m[i] = INFINITY;
        if (!(room_at(e, o_enu[0], o_enu[1]) < block->limit_m[i]) || !v3_is_finite(d_enu)) continue;
        const double at_m = range_beyond(e, o_enu, d_enu, bend_per_m, block->limit_m[i]);
        if (at_m < block->limit_m[i]) range_m[i] = at_m;
    }
}

/* The surface of a place outside of the outline. */
static SurfaceClass surface_beyond(const RoundEarth *e, const Landscape *landscape, double x_m, double y_m)
{
    const double at[2] = {x_m, y_m};
    double       middle[2], away[2], times = 1; /* distance from the middle over that of the outline */
    for (int c = 0; c < 2; c++) {
        middle[c] = 0.5 * (e->low_m[c] + e->high_m[c]);
        away[c] = at[c] - middle[c];
        times = fmax(times, fabs(away[c]) / (0.5 * (e->high_m[c] - e->low_m[c]) - e->inset_m));
    }
    const SurfaceClass edge = landscape_surface(landscape, middle[0] + away[0] / times, middle[1] + away[1] / times);
    if (edge == SURFACE_WATER) return edge;
    const double       share = (fabs(fmod(times - 1, 4) - 2) - 1) / times; /* to and fro between the outlines */
    const SurfaceClass there = landscape_surface(landscape, middle[0] + share * away[0], middle[1] + share * away[1]);
    return there == SURFACE_NONE ? edge : there;
}

static void beyond_finish(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                          const void *self)
{
    const RoundEarth *e = self;
    const Visibility *v = block->v;
    const double      twice = block->rays->bent ? 2 * v->seen.bend_per_m : 0;
    (void)found;
    for (int k = 0; k < count; k++) {
        const int    i = list[k];
        const double p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
        const double x = block->d_enu[0][i], y = block->d_enu[1][i];
        const double d_enu[3] = {x, y, block->d_enu[2][i] - twice * hits->range_m[i] * (x * x + y * y)};
        double       at[3], up[3];
        m3_mul_v3(at, e->unit_from_enu, p_enu);
        v3_add(at, at, e->origin);
        m3_tmul_v3(up, e->unit_from_enu, at); /* the gradient */
        if (!v3_normalize(up, up)) continue;
        hits->kind[i] = hit_ground;
        hits->surface[i] = (uint8_t)surface_beyond(e, v->landscape, p_enu[0], p_enu[1]);
        if (hits->surface[i] && v->materials) hits->material[i] = (uint16_t)v->materials->surface[hits->surface[i]];
        visibility_store_normals(hits, i, up, up, d_enu);
    }
}

/* Hits that face the sun have no Earth before it. */
static void beyond_any(const TraceShadow *shadow, const void *self) { (void)shadow, (void)self; }

const TraceEntry trace_beyond = {
    .turn = 3, .found_octets = 0, .first_hits = beyond_first, .finish = beyond_finish, .any_hits = beyond_any};
