/* entities/shapes/cover.c: what hides vehicles: a camouflage net, a wall.
 *
 * Net: a lightweight camouflage screen over supports, garnished with scraps of cloth that leave holes between them
 * (class of the ULCANS, NSN 1080-01-457-2956: a hexagon of 27 ft; sizes and shape here an estimate): level over the
 * middle, 3.0 m high, then falling to the ground on all sides, 9.0 m long and 5.8 m wide. Scraps stand in cells of 0.5
 * m along the surface, each 0.42 m square: 0.70 of the surface is covered. Wall: of a yard, brick, 12 m long, 2.0 m
 * high, 0.3 m thick, under a coping; estimate. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

/* ---- the net ------------------------------------------------------------------------------------------- */

static const double net_half_m[2] = {4.5, 2.9}, net_top_half_m[2] = {2.2, 1.0}, net_high_m = 3.0;
static const double scrap_m = 0.42, cell_m = 0.5, cloth_m = 0.004;

/* Height of the net, and its rise along x and y, over a place. */
static double net_height(double rise[2], double x, double y)
{
    const double at[2] = {x, y};
    double       out = 0;
    int          side = 0;
    for (int k = 0; k < 2; k++) {
        const double r = (fabs(at[k]) - net_top_half_m[k]) / (net_half_m[k] - net_top_half_m[k]);
        if (r > out) out = r, side = k;
    }
    rise[0] = rise[1] = 0;
    if (out > 0) rise[side] = -copysign(net_high_m / (net_half_m[side] - net_top_half_m[side]), at[side]);
    return net_high_m * (1 - out);
}

/* A scrap along the surface, as wide as its cell on the level leaves room for; turned a little, each by its own. */
static void add_scrap(MeshBuilder *b, double x, double y, double dx, double dy, uint64_t number)
{
    double       rise[2], u[3], v[3], n[3], m[9];
    const double z = net_height(rise, x, y), turn_rad = 0.5 * (random_uniform(1, 21, 0, number) - 0.5);
    const double along[3] = {1, 0, rise[0]}, across[3] = {0, 1, rise[1]};
    const double long_m = scrap_m / cell_m * dx * v3_length(along), wide_m = scrap_m / cell_m * dy * v3_length(across);
    v3_cross(n, along, across);
    v3_normalize(n, n);
    v3_normalize(u, along);
    v3_cross(v, n, u);
    for (int k = 0; k < 3; k++) { /* body axes: z is down */
        const double flip = k == 0 ? 1 : -1, c = cos(turn_rad), s = sin(turn_rad);
        m[3 * k] = flip * (c * u[k] + s * v[k]);
        m[3 * k + 1] = flip * (c * v[k] - s * u[k]);
        m[3 * k + 2] = flip * n[k];
    }
    Place place = {{x, -y, -fmax(z, 0.22)}, {0}};
    memcpy(place.m, m, sizeof m);
    mesh_box(b, place, -0.5 * long_m, -0.5 * wide_m, -0.5 * cloth_m, 0.5 * long_m, 0.5 * wide_m, 0.5 * cloth_m);
}

static void build_net(MeshBuilder *b)
{
    uint64_t number = 0;
    /* as many cells as the surface needs in each direction, which on the slopes are narrower on the level */
    static const double edge[2][6] = {{-4.5, -2.2, 2.2, 4.5}, {-2.9, -1.0, 1.0, 2.9}};
    mesh_part(b, 0, "garnish", "cloth_olive", HEAT_PASSIVE);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double x0 = edge[0][i], x1 = edge[0][i + 1], y0 = edge[1][j], y1 = edge[1][j + 1];
            double       rise[2];
            net_height(rise, 0.5 * (x0 + x1), 0.5 * (y0 + y1));
            const int nx = (int)ceil((x1 - x0) * hypot(1, rise[0]) / cell_m),
                      ny = (int)ceil((y1 - y0) * hypot(1, rise[1]) / cell_m);
            for (int p = 0; p < nx; p++)
                for (int q = 0; q < ny; q++)
                    add_scrap(b, x0 + (p + 0.5) * (x1 - x0) / nx, y0 + (q + 0.5) * (y1 - y0) / ny, (x1 - x0) / nx,
                              (y1 - y0) / ny, number++);
        }
    mesh_part(b, 0, "poles", "wood_pine", HEAT_PASSIVE);
    for (int i = -1; i <= 1; i += 2)
        for (int j = -1; j <= 1; j += 2)
            parts_bar(b, i * net_top_half_m[0], j * 1.9, 0.01, i * net_top_half_m[0], j * net_top_half_m[1], 2.98,
                      0.03);
}

/* ---- the wall -------------------------------------------------------------------------------------------- */

static void build_wall(MeshBuilder *b)
{
    mesh_part(b, 0, "wall", "brick_red", HEAT_PASSIVE);
    parts_box(b, -6.0, 6.0, -0.15, 0.15, 0, 1.92);
    mesh_part(b, 0, "coping", "concrete", HEAT_PASSIVE);
    parts_box(b, -6.0, 6.0, -0.20, 0.20, 1.92, 2.0);
}

Status parametric_cover(Model *out, const char *name, double sag_m)
{
    MeshBuilder *b = mesh_builder_create(name, sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "body", -1, 0, 0, 0);
    if (strcmp(name, "net") == 0) build_net(b);
    else build_wall(b);
    const Status status = mesh_builder_finish(out, b);
    if (status == STATUS_OK) out->sag_m = sag_m;
    return status;
}
