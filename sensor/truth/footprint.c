/* sensor/truth/footprint.c: where the boresight and the corners of an image meet the ground. */
#include "sensor/truth/footprint.h"

#include "render/ground/ground.h"

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
    ecef_from_enu(p_ecef, frame, p_enu);
    if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return out;
    return (GroundPoint){true, place.lat_rad, place.lon_rad, place.h_m, range_m};
}

void footprint_of_view(GroundPoint out[FOOTPRINT_COUNT], const World *world, const View *view)
{
    const double corner[FOOTPRINT_COUNT][2] = {{0.5, 0.5}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
    Ground       ground;
    ground_prepare(&ground, world->landscape ? &world->landscape->elevation : NULL);
    for (int k = 0; k < FOOTPRINT_COUNT; k++)
        out[k] = ground_point(&ground, &world->frame, view, corner[k][0] * view->width, corner[k][1] * view->height);
}
