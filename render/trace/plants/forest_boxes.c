/* render/trace/plants/forest_boxes.c: the box about a standing plant, for Embree's tree over all of them. */
#include "render/trace/plants/forest_private.h"

/* The azimuth of the table at or before that of a vector. An arctangent within 0.005 rad, a twentieth of the table's
 * step, leaves it within one of that; which side of it the vector is on says the rest. */
static int azimuth_before(const double (*azimuth)[2], double x, double y)
{
    const double wide = fabs(x), high = fabs(y), most = wide > high ? wide : high, least = wide > high ? high : wide;
    const double a = most > 0 ? least / most : 0, near_rad = a * (0.9724 - 0.1919 * a * a);
    const double quarter = wide > high ? near_rad : 0.5 * pi_rad - near_rad, half = x < 0 ? pi_rad - quarter : quarter;
    const double turn = y < 0 ? 2 * pi_rad - half : half;
    int          k = (int)(turn * (shape_azimuths / (2 * pi_rad))) % shape_azimuths;
    if (azimuth[k][0] * y - azimuth[k][1] * x < 0) k = (k + shape_azimuths - 1) % shape_azimuths;
    else if (azimuth[k + 1][1] * x - azimuth[k + 1][0] * y < 0) k = (k + 1) % shape_azimuths;
    return k;
}

/* How far a shape reaches along a vector of its axes, at most. The reach between two azimuths is no more than the mix
 * of theirs that makes up the vector, since the reach along a sum of vectors is at most the sum of those along them.
 */
static double reach_along(const ShapeScene *shape, const double along[3])
{
    static const double per_sine = 1 / 0.098017140329560602; /* of 2 pi / shape_azimuths */
    _Static_assert(shape_azimuths == 64, "its sine");
    const double  x = along[0], y = along[1];
    const int     k = azimuth_before(shape->azimuth, x, y);
    const double *low = shape->azimuth[k], *high = shape->azimuth[k + 1];
    const double  mix =
        (shape->reach[k] * (high[1] * x - high[0] * y) + shape->reach[k + 1] * (low[0] * y - low[1] * x)) * per_sine;
    const double up = along[2] * (shape->centre[2] + shape->half[2]),
                 down = along[2] * (shape->centre[2] - shape->half[2]);
    return mix + 1e-4 * sqrt(x * x + y * y) + (up > down ? up : down);
}

/* An upper bound of the same reach from the shape's box, which is cheaper. */
static double box_along(const ShapeScene *shape, const double along[3])
{
    double reach = 0;
    for (int c = 0; c < 3; c++) reach += along[c] * shape->centre[c] + fabs(along[c]) * shape->half[c];
    return reach;
}

/* Tight boxes cost as much as a ray each: worth it for those that stand for many frames. */
static void box_of(double low[3], double high[3], const PlantList *list, const Plant *plant)
{
    static const double room_m = 0.02; /* of a float 16 km from the origin, twenty times */
    const ShapeScene   *level[plant_levels] = {&list->forest->shape[plant->kind][0],
                                               &list->forest->shape[plant->kind][1]};
    const double        swing_m = list->forest->config.sway > 0 ? most_sway_rad * 1.1 * plant_height_m(plant) : 0;
    double              m[9];
    for (int c = 0; c < 3; c++) low[c] = INFINITY, high[c] = -INFINITY;
    plant_transform(m, plant, NULL);
    double (*const reach)(const ShapeScene *, const double[3]) = list->frame || list->far ? box_along : reach_along;
    for (int l = 0; l < plant_levels; l++) {
        if (!level[l]->scene) continue;
        for (int c = 0; c < 3; c++) {
            const double along[3] = {m[3 * c], m[3 * c + 1], m[3 * c + 2]}, back[3] = {-along[0], -along[1], -along[2]};
            const double before = -reach(level[l], back) - room_m - swing_m,
                         after = reach(level[l], along) + room_m + swing_m;
            low[c] = before < low[c] ? before : low[c]; /* not fmin, which compiles to a call */
            high[c] = after > high[c] ? after : high[c];
        }
    }
    for (int c = 0; c < 3; c++) /* of a kind without quads */
        if (!(low[c] <= high[c])) low[c] = high[c] = 0;
    for (int c = 0; c < 3; c++) low[c] += (double)plant->p_m[c], high[c] += (double)plant->p_m[c];
}

void plant_box(const struct RTCBoundsFunctionArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    const int        first = (int)a->primID * list->per_box, end = first + list->per_box;
    float           *bound[2] = {&a->bounds_o->lower_x, &a->bounds_o->upper_x};
    for (int k = first; k < end && k < list->count; k++) {
        double low[3], high[3];
        box_of(low, high, list, &list->plant[k]);
        for (int c = 0; c < 3; c++) {
            if (k == first || (float)low[c] < bound[0][c]) bound[0][c] = (float)low[c];
            if (k == first || (float)high[c] > bound[1][c]) bound[1][c] = (float)high[c];
        }
    }
}
