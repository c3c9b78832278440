/* entities/scenery/scenery_solids.c: closed solids of works: swept bands, bodies of revolution, bars. */
#include "entities/scenery/scenery_buildings_private.h"

/* Corner k of a station's cross-section, counter-clockwise seen against the way: right low, left low .. */
static void section_corner(double p[3], const Station *s, int k, const Section *of)
{
    static const int side[4] = {-1, 1, 1, -1};
    const double     across_m = of->across_m + side[k] * of->half_m, *left = s->left;
    p[0] = s->p[0] + across_m * left[0], p[1] = s->p[1] + across_m * left[1];
    p[2] = s->p[2] + (k < 2 ? of->low_m : of->high_m);
}

void cell_sweep(CellMesh *cell, int slot, const Station *station, int n, const Section *of)
{
    double end[2][4][3];
    for (int k = 0; k < 4; k++)
        section_corner(end[0][3 - k], &station[0], k, of), section_corner(end[1][k], &station[n - 1], k, of);
    /* seen from behind (against the way out of the first station) left and right are exchanged */
    cell_face(cell, slot, (const double(*)[3])end[1], 4);
    cell_face(cell, slot, (const double(*)[3])end[0], 4);
    for (int i = 0; i + 1 < n; i++)
        for (int k = 0; k < 4; k++) {
            double side[4][3];
            section_corner(side[0], &station[i], k, of), section_corner(side[3], &station[i + 1], k, of);
            section_corner(side[1], &station[i], (k + 1) % 4, of);
            section_corner(side[2], &station[i + 1], (k + 1) % 4, of);
            /* two triangles: sides of a band that turns are not flat */
            const double a[3][3] = {{side[0][0], side[0][1], side[0][2]},
                                    {side[1][0], side[1][1], side[1][2]},
                                    {side[2][0], side[2][1], side[2][2]}};
            const double b[3][3] = {{side[0][0], side[0][1], side[0][2]},
                                    {side[2][0], side[2][1], side[2][2]},
                                    {side[3][0], side[3][1], side[3][2]}};
            cell_face(cell, slot, a, 3);
            cell_face(cell, slot, b, 3);
        }
}

void cell_bar(CellMesh *cell, int slot, const double from[3], const double to[3], double half_m)
{
    double d[3], u[3], v[3];
    v3_sub(d, to, from);
    if (!v3_normalize(d, d)) return;
    const double other[3] = {0, fabs(d[2]) > 0.9 ? 1 : 0, fabs(d[2]) > 0.9 ? 0 : 1};
    v3_cross(u, other, d);
    v3_normalize(u, u);
    v3_cross(v, d, u);
    double p[2][4][3];
    for (int k = 0; k < 4; k++) {
        const double a = (k == 0 || k == 3 ? -half_m : half_m), b = k < 2 ? -half_m : half_m;
        for (int c = 0; c < 3; c++) {
            p[0][k][c] = from[c] + a * u[c] + b * v[c];
            p[1][k][c] = to[c] + a * u[c] + b * v[c];
        }
    }
    double back[4][3];
    for (int k = 0; k < 4; k++) memcpy(back[k], p[0][3 - k], sizeof back[k]);
    cell_face(cell, slot, (const double(*)[3])back, 4);
    cell_face(cell, slot, (const double(*)[3])p[1], 4);
    for (int k = 0; k < 4; k++) {
        const int l = (k + 1) % 4;
        double    side[4][3];
        memcpy(side[0], p[0][k], sizeof side[0]), memcpy(side[1], p[0][l], sizeof side[1]);
        memcpy(side[2], p[1][l], sizeof side[2]), memcpy(side[3], p[1][k], sizeof side[3]);
        cell_face(cell, slot, (const double(*)[3])side, 4);
    }
}

void cell_round(CellMesh *cell, int slot, const double middle[2], const double half[2], double heading_rad,
                const double (*rz)[2], int n, int sides)
{
    const double along[2] = {sin(heading_rad), cos(heading_rad)}; /* clockwise from north */
    uint32_t     ring[2][64];
    for (int i = 0; i + 1 < n; i++) {
        /* rings of their own for each strip: edges between strips stay sharp */
        const double dr = rz[i + 1][0] - rz[i][0], dz = rz[i + 1][1] - rz[i][1];
        for (int e = 0; e < 2; e++)
            for (int k = 0; k < sides; k++) {
                const double c = cos(2 * pi_rad * k / sides), s = sin(2 * pi_rad * k / sides), r = rz[i + e][0];
                const double x = r * c * half[0], y = r * s * half[1];
                const double nx = dz * c / half[0], ny = dz * s / half[1], nz = -dr;
                /* shape x along the heading, y to the left of it */
                const double p[3] = {middle[0] + x * along[0] - y * along[1], middle[1] + x * along[1] + y * along[0],
                                     rz[i + e][1]};
                const double normal[3] = {nx * along[0] - ny * along[1], nx * along[1] + ny * along[0], nz};
                ring[e][k] = cell_vertex(cell, p, normal);
            }
        for (int k = 0; k < sides; k++) {
            const int l = (k + 1) % sides;
            if (rz[i][0] > 0) cell_triangle(cell, slot, ring[0][k], ring[0][l], ring[1][l]);
            if (rz[i + 1][0] > 0) cell_triangle(cell, slot, ring[0][k], ring[1][l], ring[1][k]);
        }
    }
}
