/* entities/shapes/rock.c: boulders: a ball cut by planes of random directions, and roughened; flat below, where it
 * stands. Three forms, each drawn from a seed of its own: 1.6 m long, about 1.2 m wide and 0.8 m high, as boulders lie
 * (axes 1 : 0.71 : 0.5 are near the mean of Zingg's classes: Wadell and Zingg on the form of particles, 1935). */
#include "entities/shapes/mesh_builder_private.h"
#include "entities/shapes/parametric.h"

#include <stdlib.h>

enum { cuts = 18, octahedron = 8, side = 14, face_points = (side + 1) * (side + 2) / 2 };
static const double day_depth_m = 0.25; /* what a day warms of granite: sqrt(k day / (pi rho c)) is 0.2 m */
static const double half_m[3] = {0.8, 0.6, 0.52}, sunk = 0.45; /* sunk: share of the half height that is below ground */

static double drawn(uint32_t seed, uint32_t stream, uint32_t k) { return random_uniform(seed, stream, 0, k); }

/* Where a direction meets the rock, of the ball's axes. */
static void surface_at(double p[3], const double d[3], const double (*cut)[4], uint32_t seed)
{
    double r = 1;
    for (int k = 0; k < cuts; k++) {
        const double c = v3_dot(d, cut[k]);
        if (c > 0.05) r = fmin(r, cut[k][3] / c);
    }
    /* waves of three lengths, of the direction alone so that faces meet */
    double rough = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const double f = 5.0 * (1 << k), phase = 2 * pi_rad * drawn(seed, 9, k);
        rough += sin(f * d[0] + phase) * sin(f * d[1] + 2 * phase) * sin(f * d[2] + 3 * phase) / (1 << k);
    }
    r *= 1 + 0.035 * rough;
    for (int c = 0; c < 3; c++) p[c] = half_m[c] * r * d[c] + 0.0; /* no -0: faces meet to the bit */
    /* up is -z: the lower part is in the ground */
    p[2] = fmin(p[2] - (1 - sunk) * half_m[2], 0.0);
}

Status parametric_rock(Model *out, const char *name, double sag_m)
{
    const uint32_t seed = (uint32_t)atoi(name + strlen(name) - 1);
    double         cut[cuts][4], point[face_points][3];
    MeshBuilder   *b = mesh_builder_create(name, sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "rock", -1, 0, 0, 0);
    mesh_part(b, 0, "rock", "stone_granite", HEAT_PASSIVE);
    for (uint32_t k = 0; k < cuts; k++) {
        const double z = 2 * drawn(seed, 1, k) - 1, turn = 2 * pi_rad * drawn(seed, 2, k), r = sqrt(1 - z * z);
        cut[k][0] = r * cos(turn), cut[k][1] = r * sin(turn), cut[k][2] = z;
        cut[k][3] = 0.62 + 0.33 * drawn(seed, 3, k);
    }
    const Place place = place_at(0, 0, 0);
    const Warp  warp = mesh_warp(&place);
    for (int face = 0; face < octahedron && mesh_reserve(b, 3 * side * side, side * side); face++) {
        const double sign[3] = {face & 1 ? -1 : 1, face & 2 ? -1 : 1, face & 4 ? -1 : 1};
        const bool   flips = sign[0] * sign[1] * sign[2] < 0;
        int          row[side + 2];
        for (int j = 0, n = 0; j <= side; j++) {
            row[j] = n;
            for (int i = 0; i <= side - j; i++, n++) {
                /* no sums of rounded shares: points of a shared edge must be equal */
                double d[3] = {sign[0] * (side - i - j), sign[1] * i, sign[2] * j};
                v3_normalize(d, d);
                surface_at(point[n], d, (const double(*)[4])cut, seed);
            }
        }
        for (int j = 0; j < side; j++)
            for (int i = 0; i < side - j; i++)
                for (int upper = 0; upper < (i + j + 2 <= side ? 2 : 1); upper++) {
                    const int a = row[j] + i, c = row[j + 1] + i;
                    const int corner[3] = {upper ? a + 1 : a, upper ? c + 1 : a + 1, c};
                    double    p[3][3], e[3], f[3], n[3];
                    for (int k = 0; k < 3; k++) memcpy(p[k], point[corner[flips ? 2 - k : k]], sizeof p[k]);
                    v3_sub(e, p[1], p[0]), v3_sub(f, p[2], p[0]), v3_cross(n, e, f);
                    if (!v3_normalize(n, n)) n[0] = 0, n[1] = 0, n[2] = 1;
                    const uint32_t first = mesh_add_vertex(b, &place, &warp, p[0], n);
                    mesh_add_vertex(b, &place, &warp, p[1], n), mesh_add_vertex(b, &place, &warp, p[2], n);
                    mesh_add_triangle(b, &warp, first, first + 1, first + 2);
                }
    }
    const Status status = mesh_builder_finish(out, b);
    if (status == STATUS_OK) out->sag_m = sag_m, out->part[0].thickness_m = day_depth_m;
    return status;
}
