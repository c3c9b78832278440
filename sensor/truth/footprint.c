/* sensor/truth/footprint.c: where the image meets the ground, and how much of it is seen. */
#include "sensor/truth/truth.h"
#include "terrain/earth/refraction.h"
#include "render/trace/ground/ground.h"

static Ground ground_seen_by(const World *world, const RenderRequest *request)
{
    Ground ground;
    ground_prepare(&ground, world->landscape ? &world->landscape->elevation : NULL);
    if (request->refraction) ground.bend_per_m = world_bend(world, REFRACTION_OPTICAL, request->view.p_enu);
    return ground;
}

/* ---- its corners ----------------------------------------------------------------------------------- */

static GroundPoint ground_point(const Ground *ground, const LocalFrame *frame, const View *view, double column_px,
                                double row_px)
{
    double      d_enu[3], p_enu[3], p_ecef[3];
    Geodetic    place;
    GroundPoint out = {.known = false};
    view_ray(d_enu, view, column_px, row_px);
    const double range_m = ground_first_hit(NULL, ground, view->p_enu, d_enu, INFINITY);
    if (!(range_m > 0 && range_m < INFINITY)) return out;
    v3_add_scaled(p_enu, view->p_enu, range_m, d_enu);
    p_enu[2] -= refraction_drop(ground->bend_per_m, view->p_enu, p_enu);
    ecef_from_enu(p_ecef, frame, p_enu);
    if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return out;
    return (GroundPoint){true, place.lat_rad, place.lon_rad, place.h_m, range_m};
}

void truth_footprint(GroundPoint out[FOOTPRINT_COUNT], const World *world, const RenderRequest *request)
{
    const View  *view = &request->view;
    const double corner[FOOTPRINT_COUNT][2] = {{0.5, 0.5}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const Ground ground = ground_seen_by(world, request);
    for (int k = 0; k < FOOTPRINT_COUNT; k++)
        out[k] = ground_point(&ground, &world->frame, view, corner[k][0] * view->width, corner[k][1] * view->height);
}

/* ---- its area -------------------------------------------------------------------------------------- */

/* Rays through the middles of cells, `columns` by `rows`. More rows than columns: towards the horizon a row has ever
 * more ground. */
enum { area_columns = 16, area_rows = 512 };

/* Ground that is met at less than this angle, rad, counts as if it were met at it: what is seen of it hangs on the
 * next post. */
static const double area_least_graze = 1e-3;

/* Corners of the cells of a row, as unit vectors. */
static void corners_of_row(double corner[area_columns + 1][3], const View *view, int row)
{
    for (int k = 0; k <= area_columns; k++)
        view_ray(corner[k], view, (double)k / area_columns * view->width, (double)row / area_rows * view->height);
}

/* Solid angle of a small cell, sr: half the product of its diagonals. */
static double cell_sr(const double upper[2][3], const double lower[2][3])
{
    double down[3], up[3], normal[3];
    v3_sub(down, lower[1], upper[0]);
    v3_sub(up, upper[1], lower[0]);
    v3_cross(normal, down, up);
    return 0.5 * v3_length(normal);
}

/* Map area of the ground that a ray of solid angle sr meets at range_m in the direction d. */
static double met_area(const Elevation *elevation, const double p_enu[3], const double d_enu[3], double range_m,
                       double sr)
{
    double at_enu[3], n_enu[3] = {0, 0, 1};
    v3_add_scaled(at_enu, p_enu, range_m, d_enu);
    if (!isfinite(elevation_height(elevation, at_enu[0], at_enu[1], n_enu))) return 0;
    return range_m * range_m * sr * n_enu[2] / fmax(-v3_dot(n_enu, d_enu), area_least_graze);
}

double truth_ground_area(const World *world, const RenderRequest *request)
{
    const View  *view = &request->view;
    const Ground ground = ground_seen_by(world, request);
    double       edge[2][area_columns + 1][3], o[3][area_columns], d[3][area_columns], far_m[area_columns];
    double       range_m[area_columns], sum = 0;
    if (!world->landscape) return 0;
    for (int k = 0; k < area_columns; k++) {
        far_m[k] = truth_ground_far_m;
        for (int c = 0; c < 3; c++) o[c][k] = view->p_enu[c];
    }
    corners_of_row(edge[0], view, 0);
    for (int row = 0; row < area_rows; row++) {
        const double(*upper)[3] = edge[row % 2];
        corners_of_row(edge[1 - row % 2], view, row + 1);
        const double(*lower)[3] = edge[1 - row % 2];
        for (int k = 0; k < area_columns; k++) {
            double d_enu[3];
            view_ray(d_enu, view, (k + 0.5) / area_columns * view->width, (row + 0.5) / area_rows * view->height);
            for (int c = 0; c < 3; c++) d[c][k] = d_enu[c];
        }
        ground_first_hits(range_m, NULL, &ground, area_columns, (const double *const[]){o[0], o[1], o[2]},
                          (const double *const[]){d[0], d[1], d[2]}, far_m);
        for (int k = 0; k < area_columns; k++) {
            const double d_enu[3] = {d[0][k], d[1][k], d[2][k]};
            if (!(range_m[k] > 0 && range_m[k] < INFINITY)) continue;
            sum +=
                met_area(&world->landscape->elevation, view->p_enu, d_enu, range_m[k], cell_sr(&upper[k], &lower[k]));
        }
    }
    return sum;
}
