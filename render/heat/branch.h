/* render/heat/branch.h: heat of trunks and branches: conduction in a round body by its diameter and side.
 *
 * Temperature over the sides of a cylinder in three parts, each of which conducts by itself: the mean, the side towards
 * the sun or sky (cosine), and how much narrower the sunlit side is than that (cosine of twice the angle, of upright
 * trunks). Rings of the radius, backward Euler. Thin branches are taken to point everywhere, those thicker than 30 mm to
 * stand upright. The film is that of a cylinder across the wind (Churchill & Bernstein, J. Heat Transfer 99, 1977).
 *
 * Error: test_branch.c, against finite volumes over rings and sides. */
#ifndef RENDER_HEAT_BRANCH_H
#define RENDER_HEAT_BRANCH_H

#include "render/heat/ground_column.h"

enum { branch_radii = 5, branch_rings = 8, branch_most_kinds = 24 };
static const double branch_radius_m[branch_radii] = {0.004, 0.012, 0.04, 0.12, 0.3};

/* Wood under its bark. */
typedef struct BranchKind {
    int    material; /* row of the table of materials: how hits name it */
    double conductivity_w_mk, capacity_j_m3k, absorptance, emissivity;
} BranchKind;

/* Temperature of a side: mean + side . n + twice[0] (nx^2 - ny^2) + twice[1] 2 nx ny, K. */
typedef struct BranchSides {
    float mean_k, side_k[3], twice_k[2];
} BranchSides;

typedef struct Branch {
    const BranchKind *kind;
    double radius_m;
    double part[6][branch_rings]; /* mean, side, twice; outermost ring first */
    double face_k[6];             /* of the bark's face */
} Branch;

void branch_start(Branch *out, const BranchKind *kind, double radius_m, double temp_k);
/* sun: share of the direct sun that it gets; ground_k: of what it sees below. */
void branch_step(Branch *branch, const GroundWeather *after, double sun, double ground_k, double dt_s);
void branch_sides(BranchSides *out, const Branch *branch);

static inline double branch_side_k(const BranchSides *s, const double n[3])
{
    return (double)s->mean_k + (double)s->side_k[0] * n[0] + (double)s->side_k[1] * n[1] + (double)s->side_k[2] * n[2] +
           (double)s->twice_k[0] * (n[0] * n[0] - n[1] * n[1]) + (double)s->twice_k[1] * 2 * n[0] * n[1];
}
/* W/(m2 K) */
double branch_film_w_m2k(double radius_m, double wind_mps);

#endif
