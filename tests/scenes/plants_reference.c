/* tests/scenes/plants_reference.c: every quad of every plant that a ray may meet, projected along the ray.
 *
 * In the plane across the ray a quad is a polygon and the ray a point: whether the polygon holds the point, and how far
 * it is from the outline, is well defined for quads seen edge-on, too. */
#include "tests/scenes/plants_reference.h"

#include <stdlib.h>

static const double spare_m = 1e-3; /* spheres and boxes are larger by this, so that they leave nothing out */

Status plant_spheres_create(PlantSpheres *out, const Plants *plants)
{
    *out = (PlantSpheres){0};
    for (int k = 0; k < PLANT_STANDING; k++) {
        const PlantShape *shape = &plants->shape[k][plant_whole];
        float            *s = out->sphere[k] = malloc(((size_t)shape->quads + 1) * 4 * sizeof *s);
        if (!s) {
            plant_spheres_destroy(out);
            return STATUS_NO_MEMORY;
        }
        for (int q = 0; q < shape->quads; q++, s += 4) {
            const PlantQuad *quad = &shape->quad[q];
            double           radius = 0;
            for (int c = 0; c < 3; c++)
                s[c] = 0.25f * (quad->corner[0][c] + quad->corner[1][c] + quad->corner[2][c] + quad->corner[3][c]);
            for (int k4 = 0; k4 < 4; k4++) {
                double off[3];
                for (int c = 0; c < 3; c++) off[c] = (double)quad->corner[k4][c] - (double)s[c];
                radius = fmax(radius, v3_length(off));
            }
            s[3] = (float)(radius * 1.0001 + 1e-6);
        }
    }
    return STATUS_OK;
}

void plant_spheres_destroy(PlantSpheres *spheres)
{
    for (int k = 0; k < PLANT_KINDS; k++) free(spheres->sphere[k]);
    *spheres = (PlantSpheres){0};
}

/* ---- one quad ----------------------------------------------------------------------------------- */

typedef struct Placed {
    double      m[9];    /* ENU from the prototype's axes */
    long double foot[3]; /* from the ray's origin */
    long double across[2][3], d[3];
} Placed;

static void place_corner(long double out[3], const Placed *p, const long double at[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = p->foot[c] + (long double)p->m[3 * c] * at[0] + (long double)p->m[3 * c + 1] * at[1] +
                 (long double)p->m[3 * c + 2] * at[2];
}

static long double dot(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The outline in the prototype's axes; returns its corners. */
static int outline_of(long double at[plant_outline_corners_most][3], const Plants *plants, PlantKind kind,
                      const PlantQuad *quad)
{
    const LeafOutline *outline = &plants->outline[kind][quad->outline];
    const bool         leaf = quad->organ == PLANT_LEAF;
    const int          count = leaf ? outline->corners : 4;
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) {
            const long double a = quad->corner[0][c];
            at[i][c] = quad->corner[i % 4][c];
            if (leaf)
                at[i][c] =
                    a + outline->uv[i][0] * (quad->corner[1][c] - a) + outline->uv[i][1] * (quad->corner[3][c] - a);
        }
    return count;
}

/* Distance of the ray from the outline, across it, above 0 within; range of the plane, and cosine to its normal. False:
 * edge-on to the last digit, or behind. */
static bool passes(long double *inside_m, long double *range_m, long double *facing, const Plants *plants,
                   PlantKind kind, const PlantQuad *quad, const Placed *placed)
{
    long double at[plant_outline_corners_most][3], p[plant_outline_corners_most][3], n[3], one[3], two[3];
    long double x[plant_outline_corners_most], y[plant_outline_corners_most], corner[4][3], nearest2 = INFINITY;
    bool        within = false;
    const int   count = outline_of(at, plants, kind, quad);
    for (int i = 0; i < count; i++) {
        place_corner(p[i], placed, at[i]);
        x[i] = dot(p[i], placed->across[0]), y[i] = dot(p[i], placed->across[1]);
    }
    for (int i = 0, j = count - 1; i < count; j = i++) {
        if ((y[i] > 0) != (y[j] > 0) && x[i] + (x[j] - x[i]) * (-y[i]) / (y[j] - y[i]) > 0) within = !within;
        const long double ex = x[j] - x[i], ey = y[j] - y[i], e2 = ex * ex + ey * ey;
        long double       t = e2 > 0 ? -(x[i] * ex + y[i] * ey) / e2 : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        const long double fx = x[i] + t * ex, fy = y[i] + t * ey, d2 = fx * fx + fy * fy;
        if (d2 < nearest2) nearest2 = d2;
    }
    for (int i = 0; i < 4; i++) {
        long double c[3] = {quad->corner[i][0], quad->corner[i][1], quad->corner[i][2]};
        place_corner(corner[i], placed, c);
    }
    /* a card is given by three of its corners; sides of bark are flat but for the rounding of their corners */
    const bool leaf = quad->organ == PLANT_LEAF;
    for (int c = 0; c < 3; c++) {
        one[c] = corner[leaf ? 1 : 2][c] - corner[0][c];
        two[c] = corner[3][c] - corner[leaf ? 0 : 1][c];
    }
    for (int c = 0; c < 3; c++) n[c] = one[(c + 1) % 3] * two[(c + 2) % 3] - one[(c + 2) % 3] * two[(c + 1) % 3];
    const long double length = sqrtl(dot(n, n)), rate = dot(n, placed->d);
    *inside_m = within ? sqrtl(nearest2) : -sqrtl(nearest2);
    if (!(length > 0) || rate == 0) return false;
    for (int c = 0; c < 3; c++)
        one[c] = leaf ? corner[0][c] : 0.25L * (corner[0][c] + corner[1][c] + corner[2][c] + corner[3][c]);
    *range_m = dot(n, one) / rate;
    *facing = fabsl(rate) / length;
    return *range_m > 0;
}

/* ---- one plant ---------------------------------------------------------------------------------- */

/* Whether the box of the shape, a little larger, is entered before limit_m. o, d: in the prototype's axes, d not of
 * length 1: ranges are those of the ray. */
static bool meets_box(const PlantShape *shape, const double o[3], const double d[3], double spare, double limit_m)
{
    double from = 0, to = limit_m;
    for (int c = 0; c < 3; c++) {
        const double a = (double)shape->low[c] - spare - o[c], b = (double)shape->high[c] + spare - o[c];
        if (fabs(d[c]) < 1e-300) {
            if (a > 0 || b < 0) return false;
            continue;
        }
        from = fmax(from, fmin(a / d[c], b / d[c]));
        to = fmin(to, fmax(a / d[c], b / d[c]));
    }
    return from <= to;
}

/* Whether the sphere about the foot that holds the whole plant, whatever its lean, is passed before limit_m. */
static bool meets_plant(const Plant *plant, const PlantShape *shape, const long double foot[3], const double d[3],
                        double limit_m)
{
    double corner[3], from[3], across[3];
    for (int c = 0; c < 3; c++) {
        corner[c] = fmax(fabs((double)shape->low[c]), fabs((double)shape->high[c]));
        from[c] = (double)foot[c];
    }
    const double radius_m = plant_height_m(plant) * fmax(1, plant->width / 128.0) * v3_length(corner) + spare_m;
    const double along_m = v3_dot(from, d);
    v3_add_scaled(across, from, -along_m, d);
    return v3_length(across) <= radius_m && along_m >= -radius_m && along_m - radius_m <= limit_m;
}

void plants_judge(PlantErrors *worst, const Woods *woods, const Plants *plants, const PlantSpheres *spheres,
                  const double o_enu[3], const double d_enu[3], double range_m, const ForestHit *hit)
{
    static const double tie_m = 1e-6; /* of two as near as this either may be met */
    const bool          met = range_m < INFINITY;
    const double        aside[3] = {fabs(d_enu[2]) > 0.9, 0, fabs(d_enu[2]) <= 0.9};
    bool                own = false;
    double              across[2][3];
    Placed              placed;
    worst->rays++;
    worst->hits += met;
    v3_cross(across[0], d_enu, aside);
    v3_normalize(across[0], across[0]);
    v3_cross(across[1], d_enu, across[0]);
    for (int c = 0; c < 3; c++)
        placed.across[0][c] = across[0][c], placed.across[1][c] = across[1][c], placed.d[c] = d_enu[c];
    for (int i = 0; i < woods->count; i++) {
        const Plant      *plant = &woods->plant[i];
        const PlantShape *shape = &plants->shape[plant->kind][plant_whole];
        const float      *sphere = spheres->sphere[plant->kind];
        double            o[3], d[3];
        for (int c = 0; c < 3; c++)
            placed.foot[c] = (long double)woods->origin_enu[c] + plant->p_m[c] - (long double)o_enu[c];
        if (!meets_plant(plant, shape, placed.foot, d_enu, range_m + 1e-3)) continue;
        plant_transform(placed.m, plant, NULL);
        const double *m = placed.m, spare = spare_m / (plant_height_m(plant) * fmin(1, plant->width / 128.0));
        for (int k = 0; k < 3; k++) {
            const double size2 = m[k] * m[k] + m[3 + k] * m[3 + k] + m[6 + k] * m[6 + k];
            o[k] = d[k] = 0;
            for (int c = 0; c < 3; c++)
                o[k] -= m[3 * c + k] * (double)placed.foot[c] / size2, d[k] += m[3 * c + k] * d_enu[c] / size2;
        }
        if (!meets_box(shape, o, d, spare, range_m + 1e-3)) continue;
        const double d2 = v3_dot(d, d);
        for (int q = 0; q < shape->quads; q++, sphere += 4) {
            const bool   mine = met && hit->plant == (uint32_t)i && hit->quad == (uint32_t)q;
            const double to[3] = {(double)sphere[0] - o[0], (double)sphere[1] - o[1], (double)sphere[2] - o[2]};
            const double along = v3_dot(to, d), reach = (double)sphere[3] + spare;
            long double  inside_m, at_m, facing;
            if (!mine && v3_dot(to, to) * d2 - along * along > reach * reach * d2) continue;
            const bool crossed =
                passes(&inside_m, &at_m, &facing, plants, (PlantKind)plant->kind, &shape->quad[q], &placed);
            if (mine) {
                own = true;
                if (inside_m < 0) worst->past_m = fmax(worst->past_m, (double)-inside_m);
                worst->off_m = fmax(worst->off_m, crossed ? (double)(fabsl(range_m - at_m) * facing) : INFINITY);
            } else if (crossed && inside_m > 0 && at_m > tie_m && at_m < (long double)range_m - tie_m) {
                worst->past_m = fmax(worst->past_m, (double)inside_m);
            }
        }
    }
    if (met && (!own || hit->level != plant_whole)) worst->past_m = INFINITY; /* of a plant that the ray cannot meet */
}
