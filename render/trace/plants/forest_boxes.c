/* render/trace/plants/forest_boxes.c: the box about a plant, or some neighbours, for Embree's tree over all of them. */
#include "render/trace/plants/forest_private.h"

double plant_rough_angle(double x, double y)
{
    const double wide = fabs(x), high = fabs(y), most = wide > high ? wide : high, least = wide > high ? high : wide;
    const double a = most > 0 ? least / most : 0, near_rad = a * (0.9724 - 0.1919 * a * a);
    const double quarter = wide > high ? near_rad : 0.5 * pi_rad - near_rad, half = x < 0 ? pi_rad - quarter : quarter;
    return most > 0 ? (y < 0 ? -half : half) : 0;
}

/* The azimuth of the table at or before that of a vector. A rough angle is off by a twentieth of the table's step, so
 * that it leaves it within one of that; which side of it the vector is on says the rest. */
static int azimuth_before(const double (*azimuth)[2], double x, double y)
{
    const double angle = plant_rough_angle(x, y), turn = angle < 0 ? angle + 2 * pi_rad : angle;
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

/* Of all levels of its shape, without its sway. reach: of a shape along a vector of its axes. */
static void bounds_by(double low_m[3], double high_m[3], const PlantList *list, const Plant *plant,
                      double (*reach)(const ShapeScene *, const double[3]))
{
    const ShapeScene *hull = &list->forest->hull[plant->kind];
    double            m[9];
    plant_transform(m, plant, NULL);
    for (int c = 0; c < 3; c++) {
        const double along[3] = {m[3 * c], m[3 * c + 1], m[3 * c + 2]}, back[3] = {-along[0], -along[1], -along[2]};
        low_m[c] = hull->azimuth ? -reach(hull, back) : 0; /* NULL: a kind without quads */
        high_m[c] = hull->azimuth ? reach(hull, along) : 0;
    }
}

/* Unit of PlantList.bounds of a plant. */
static double bounds_unit_m(const PlantList *list, const Plant *plant)
{
    static const double per = 1.0 / 120;
    const double        height_m = plant_height_m(plant), wide = plant->width > 128 ? plant->width / 128.0 : 1;
    return list->forest->hull[plant->kind].most * per * wide * height_m;
}

/* The box in whole units, outwards, which are kept. Lean adds less to a coordinate than the units have room for. */
static void keep_bounds(double low_m[3], double high_m[3], const PlantList *list, uint32_t place)
{
    const double unit_m = bounds_unit_m(list, &list->plant[place]);
    int8_t      *kept = list->bounds[place];
    for (int c = 0; c < 3; c++) {
        kept[c] = (int8_t)clamp(floor(low_m[c] / unit_m), -127, 127);
        kept[3 + c] = (int8_t)clamp(ceil(high_m[c] / unit_m), -127, 127);
        low_m[c] = kept[c] * unit_m < low_m[c] ? kept[c] * unit_m : low_m[c];
        high_m[c] = kept[3 + c] * unit_m > high_m[c] ? kept[3 + c] * unit_m : high_m[c];
    }
}

void plant_bounds(double low_m[3], double high_m[3], const PlantList *list, const Plant *plant)
{
    const double unit_m = bounds_unit_m(list, plant), swing_m = plant_swing_m(list, plant);
    if (!list->bounds) bounds_by(low_m, high_m, list, plant, box_along);
    for (int c = 0; c < 3; c++) {
        const int8_t *kept = list->bounds ? list->bounds[plant - list->plant] : NULL;
        low_m[c] = (kept ? kept[c] * unit_m : low_m[c]) - swing_m;
        high_m[c] = (kept ? kept[3 + c] * unit_m : high_m[c]) + swing_m;
    }
}

/* Tight boxes cost as much as a ray each: worth it for those that stand from the start. */
static void box_of(float low[3], float high[3], const PlantList *list, uint32_t place)
{
    static const double room_m = 0.02; /* of a float 16 km from the origin, twenty times */
    const Plant        *plant = &list->plant[place];
    const double        swing_m = plant_swing_m(list, plant);
    double              low_m[3], high_m[3];
    bounds_by(low_m, high_m, list, plant, list->frame || list->far ? box_along : reach_along);
    if (list->bounds) keep_bounds(low_m, high_m, list, place);
    for (int c = 0; c < 3; c++) {
        low[c] = (float)((double)plant->p_m[c] + low_m[c] - room_m - swing_m);
        high[c] = (float)((double)plant->p_m[c] + high_m[c] + room_m + swing_m);
    }
}

void plant_box(const struct RTCBoundsFunctionArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    const uint32_t   first = a->primID * (uint32_t)list->per_box, end = first + (uint32_t)list->per_box;
    float           *bound[2] = {&a->bounds_o->lower_x, &a->bounds_o->upper_x};
    for (uint32_t k = first; k < end && k < (uint32_t)list->count; k++) {
        float low[3], high[3];
        box_of(low, high, list, k);
        for (int c = 0; c < 3; c++) {
            if (k == first || low[c] < bound[0][c]) bound[0][c] = low[c];
            if (k == first || high[c] > bound[1][c]) bound[1][c] = high[c];
        }
    }
}
