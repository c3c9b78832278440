/* render/air/atmosphere_legs.c: a path's legs, by the triangle of its ends and the Earth's centre, and how two legs of
 * one path add up. */
#include "render/air/atmosphere_private.h"

static const double least_dip_m = 500, longest_piece_m = 80e3, least_height_m = 1000;

/* A ray: where it begins, by the height and the cosine of its zenith angle. */
typedef struct Ray {
    double height_m, up;
} Ray;

static double lowest_m(const Ray *ray)
{
    const double level = sqrt(fmax(1 - ray->up * ray->up, 0));
    return ray->height_m - (earth_radius_m + ray->height_m) * ray->up * ray->up / (1 + level);
}

/* From one height to another over a distance. */
static Ray ray_between(double a_m, double b_m, double range_m)
{
    const double up =
        ((b_m - a_m) * (2 * earth_radius_m + a_m + b_m) / range_m - range_m) / (2 * (earth_radius_m + a_m));
    return (Ray){a_m, clamp(up, -1, 1)};
}

double air_ray_up(const AirPath *path)
{
    return path->range_m > 0 ? ray_between(path->observer_m, path->target_m, path->range_m).up : 0;
}

double air_pieces_share(const AirPath *leg)
{
    return clamp(leg->range_m / longest_piece_m - 1, 0, 1) * clamp(leg->observer_m / least_height_m - 1, 0, 1);
}

int air_leg_pieces(AirPath piece[air_pieces_max], const AirPath *leg)
{
    piece[0] = *leg;
    if (!(air_pieces_share(leg) > 0)) return 1;
    const Ray ray = ray_between(leg->observer_m, leg->target_m, leg->range_m);
    const int count = (int)fmin(ceil(leg->range_m / longest_piece_m), air_pieces_max);
    for (int i = 0; i < count; i++) {
        const double from_m = i * longest_piece_m, to_m = i + 1 < count ? from_m + longest_piece_m : leg->range_m;
        piece[i] = *leg;
        if (i > 0) piece[i].observer_m = piece[i - 1].target_m;
        if (i + 1 < count) piece[i].target_m = fmax(air_height_along(ray.height_m, ray.up, to_m, NULL), 0);
        piece[i].range_m = fmax(to_m - from_m, fabs(piece[i].target_m - piece[i].observer_m));
    }
    return count;
}

double air_tangent_m(double height_m, double up)
{
    const Ray ray = {height_m, clamp(up, -1, 1)};
    return up < 0 ? fmax(lowest_m(&ray), 0) : height_m;
}

AirPath air_path_down(double height_m, double up)
{
    return (AirPath){.observer_m = height_m,
                     .target_m = air_tangent_m(height_m, up),
                     .range_m = up < 0 ? -up * (earth_radius_m + height_m) : 0};
}

AirLegs air_legs(const AirPath *path, double top_m)
{
    AirLegs      legs = {0};
    const double a_m = path->observer_m, b_m = path->target_m, range_m = path->range_m;
    if (!(range_m > 0)) return legs;
    const double r_m = earth_radius_m + a_m;
    const Ray    ray = ray_between(a_m, b_m, range_m);
    const double middle_m = -r_m * ray.up; /* to the lowest point */
    double       from_m = 0, to_m = range_m, low_m = a_m, high_m = b_m;
    if (fmax(a_m, b_m) > top_m) { /* to and from the top: half a chord from the lowest point */
        const double half2 = (top_m - lowest_m(&ray)) * (2 * earth_radius_m + top_m + lowest_m(&ray)),
                     half_m = sqrt(fmax(half2, 0));
        if (a_m > top_m) from_m = middle_m - half_m, low_m = top_m;
        if (b_m > top_m) to_m = middle_m + half_m, high_m = top_m;
        if (!(half2 > 0) || !(from_m < range_m) || !(to_m > 0) || !(to_m > from_m)) return legs;
    }
    const double lowest = fmax(lowest_m(&ray), 0), dip_m = fmin(low_m, high_m) - lowest;
    legs.whole = *path;
    legs.whole.observer_m = low_m, legs.whole.target_m = high_m, legs.whole.range_m = to_m - from_m;
    legs.leg[0] = legs.leg[1] = legs.whole;
    legs.count = 1, legs.cut = clamp((dip_m - least_dip_m) / least_dip_m / 2, 0, 1);
    if (!(middle_m > from_m && middle_m < to_m && legs.cut > 0)) return legs;
    legs.leg[0].target_m = legs.leg[1].observer_m = lowest;
    legs.leg[0].range_m = middle_m - from_m, legs.leg[1].range_m = to_m - middle_m;
    legs.count = 2;
    return legs;
}

/* ---- two legs ------------------------------------------------------------------------------------- */

/* Runs of LOWTRAN7 (us1976, without haze) of level legs up to 5 km above their lowest point and from there to space, by
 * that point's height: the power with which the legs' depths add up, and the depth of the first leg for the sky's
 * radiance over that for its own emission. The legs' length changes the former by 0.04, the latter by 4 %; in LOWTRAN's
 * tropical air both are those of air 1 to 2 km lower, in subarctic winter 2 km higher (tests/data/limb.csv). */
enum { node_count = 12 };
static const double node_m[node_count] = {0, 1e3, 2e3, 3e3, 4e3, 5e3, 6e3, 8e3, 10e3, 12e3, 15e3, 18e3};
static const struct {
    AirBand band;
    double  growth[node_count], sky[node_count];
} of_band[] = {
    {AIR_NIR,
     {0.59, 0.62, 0.65, 0.69, 0.72, 0.75, 0.78, 0.83, 0.87, 0.89, 0.91, 0.92},
     {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}},
    {AIR_MWIR,
     {0.55, 0.51, 0.48, 0.46, 0.45, 0.44, 0.43, 0.41, 0.40, 0.38, 0.37, 0.36},
     {1.00, 1.02, 1.04, 1.09, 1.17, 1.27, 1.34, 1.50, 1.60, 1.65, 1.78, 1.88}},
    {AIR_LWIR,
     {0.85, 0.85, 0.84, 0.79, 0.71, 0.64, 0.58, 0.50, 0.44, 0.40, 0.38, 0.37},
     {1.00, 1.00, 1.02, 1.08, 1.30, 1.77, 2.18, 2.90, 3.40, 3.60, 3.85, 4.00}},
};

static double by_height(AirBand band, double tangent_m, bool sky)
{
    double    t;
    const int i = interval_of(&t, node_m, node_count, tangent_m);
    for (size_t k = 0; k < sizeof of_band / sizeof of_band[0]; k++) {
        const double *value = sky ? of_band[k].sky : of_band[k].growth;
        if (of_band[k].band == band) return value[i] + t * (value[i + 1] - value[i]);
    }
    return 1; /* in visible light the air has no lines to speak of */
}

double air_legs_depth(AirBand band, double tangent_m, double first, double second)
{
    const double growth = by_height(band, tangent_m, false), most = fmax(first, second), least = fmin(first, second);
    if (!(least > 0)) return fmax(most, 0);
    return growth < 1 ? most * pow(1 + pow(least / most, 1 / growth), growth) : most + least;
}

double air_legs_passed(AirBand band, double tangent_m, double first, double second)
{
    const double both = air_legs_depth(band, tangent_m, first, second);
    return second > 1e-9 ? exp(-first) * fmin(expm1(first - both) / expm1(-second), 1) : exp(-first);
}

double air_legs_sky_passed(AirBand band, double tangent_m, double first)
{
    return exp(-first * by_height(band, tangent_m, true));
}
