/* terrain/from_files/culture_building.c: heights, roof and fabrics of a building, from what its attributes say and,
 * where they say nothing, its use and size. */
#include "terrain/from_files/culture_import_private.h"

static const double storey_m = 3;

/* ---- directions -------------------------------------------------------------------------------------- */

void culture_rectangle(double side_m[2], double *along_rad, const double (*p)[2], int corners)
{
    enum { most_tries = 64 }; /* edges that are tried, evenly over the outline: few buildings have as many directions */
    const int step = (corners - 1) / most_tries + 1;
    double    least_m2 = INFINITY;
    side_m[0] = side_m[1] = *along_rad = 0;
    for (int k = 0; k < corners; k += step) {
        const double *a = p[k], *b = p[(k + 1) % corners], length_m = hypot(b[0] - a[0], b[1] - a[1]);
        if (!(length_m > 0)) continue;
        const double c = (b[0] - a[0]) / length_m, s = (b[1] - a[1]) / length_m;
        double       low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int n = 0; n < corners; n++) {
            const double dx = p[n][0] - a[0], dy = p[n][1] - a[1], at[2] = {c * dx + s * dy, c * dy - s * dx};
            for (int axis = 0; axis < 2; axis++)
                low[axis] = fmin(low[axis], at[axis]), high[axis] = fmax(high[axis], at[axis]);
        }
        const double u_m = high[0] - low[0], v_m = high[1] - low[1];
        if (!(u_m * v_m < least_m2 * (1 - 1e-9))) continue;
        least_m2 = u_m * v_m;
        side_m[0] = fmax(u_m, v_m), side_m[1] = fmin(u_m, v_m);
        *along_rad = atan2(s, c) + (v_m > u_m ? 0.5 * pi_rad : 0);
    }
    /* 0 .. pi: a line has no sense; of a square, whose sides are equal but for rounding, 0 .. pi / 2 */
    const double turn = side_m[0] - side_m[1] > 1e-6 * side_m[0] ? pi_rad : 0.5 * pi_rad;
    *along_rad -= turn * floor(*along_rad / turn + 1e-9);
}

/* ---- use ------------------------------------------------------------------------------------------- */

/* By the size of the ground floor, where nothing says a use: a garage is smaller than 40 m2, a house than 400. */
static BuildingUse use_by_size(double area_m2, double levels)
{
    if (levels >= 4) return BUILDING_FLATS;
    return area_m2 < 40     ? BUILDING_SHED
           : area_m2 < 400  ? BUILDING_HOUSE
           : area_m2 < 1200 ? BUILDING_FLATS
                            : BUILDING_HALL;
}

static RoofShape roof_of(BuildingUse use, double area_m2, double levels)
{
    switch (use) {
    case BUILDING_HOUSE:
        return area_m2 < 1000 ? ROOF_GABLED : ROOF_FLAT;
    case BUILDING_FLATS:
        return levels >= 5 || area_m2 > 800 ? ROOF_FLAT : ROOF_HIPPED;
    case BUILDING_BARN:
    case BUILDING_CHURCH:
        return ROOF_GABLED;
    case BUILDING_SHED:
        return area_m2 < 25 ? ROOF_FLAT : ROOF_GABLED;
    default:
        return ROOF_FLAT;
    }
}

/* Walls up to the eaves, where neither a height nor levels say it: two storeys of a house, one of a small one. */
static double eaves_of(BuildingUse use, double area_m2)
{
    switch (use) {
    case BUILDING_HOUSE:
        return area_m2 < 80 ? storey_m : 2 * storey_m;
    case BUILDING_FLATS:
        return 3 * storey_m;
    case BUILDING_BARN:
        return 5;
    case BUILDING_SHED:
        return 2.4;
    case BUILDING_HALL:
        return 7;
    default:
        return 9;
    }
}

/* Rise of a roof over half a width of building, by its shape: slopes of 40 degrees, of barns 30, of churches 52. */
static double rise_of(BuildingUse use, RoofShape roof, double width_m)
{
    static const double most_m = 12;
    const double slope = use == BUILDING_CHURCH ? 1.28 : use == BUILDING_BARN || use == BUILDING_HALL ? 0.577 : 0.84;
    if (roof == ROOF_FLAT) return 0;
    if (roof == ROOF_SKILLION) return fmin(0.18 * width_m, most_m); /* 10 degrees */
    return fmin(0.5 * slope * width_m, most_m);
}

static int wall_of(BuildingUse use)
{
    static const uint8_t wall[BUILDING_USES] = {
        [BUILDING_HOUSE] = FABRIC_RENDER, [BUILDING_FLATS] = FABRIC_CONCRETE, [BUILDING_BARN] = FABRIC_TIMBER,
        [BUILDING_SHED] = FABRIC_TIMBER,  [BUILDING_HALL] = FABRIC_SHEET,     [BUILDING_CHURCH] = FABRIC_STONE};
    return wall[use];
}

static int cover_of(BuildingUse use, RoofShape roof)
{
    if (use == BUILDING_HALL) return FABRIC_SHEET;
    if (use == BUILDING_CHURCH) return FABRIC_SLATE;
    return roof == ROOF_FLAT ? FABRIC_FELT : FABRIC_TILE;
}

/* ---- heights ----------------------------------------------------------------------------------------- */

/* A number that a building can have, else NAN, counted. */
static double believed(double value, double low, double high, int *mended)
{
    if (isnan(value)) return NAN;
    if (value >= low && value <= high) return value;
    ++*mended;
    return NAN;
}

/* Sets eaves and ridge of a building of a known roof. */
static HeightFrom set_heights(Building *b, const CultureFacts *f, double area_m2, double width_m, int *mended)
{
    static const double least_m = 1.8; /* of walls, where a whole height leaves so much */
    const BuildingUse   use = (BuildingUse)b->use;
    const double        height_m = believed(f->height_m, 1, (double)culture_highest_m, mended);
    const double        levels = believed(f->levels, 0.5, 150, mended);
    double              rise_m = believed(f->roof_height_m, 0, 60, mended);
    const double        roof_levels = believed(f->roof_levels, 0, 10, mended);
    if (isnan(rise_m) && roof_levels > 0 && b->roof != ROOF_FLAT) rise_m = 0.9 * storey_m * roof_levels;
    if (isnan(rise_m)) rise_m = rise_of(use, (RoofShape)b->roof, width_m);
    if (b->roof == ROOF_FLAT) rise_m = 0;
    double             eaves_m = eaves_of(use, area_m2);
    HeightFrom         from = HEIGHT_FROM_USE;
    const CultureRule *rule = f->what[VECTOR_POLYGON];
    if (rule && rule->height_m > 0) eaves_m = rule->height_m;
    if (!isnan(levels)) eaves_m = storey_m * levels, from = HEIGHT_FROM_LEVELS;
    const double eaves_said_m = believed(f->eaves_m, 1, (double)culture_highest_m, mended);
    if (!isnan(height_m) && eaves_said_m <= height_m + 1e-3) { /* both, as records have them */
        eaves_m = fmin(eaves_said_m, height_m), rise_m = height_m - eaves_m, from = HEIGHT_FROM_FILE;
    } else if (isnan(height_m) && !isnan(eaves_said_m)) {
        eaves_m = eaves_said_m, from = HEIGHT_FROM_FILE;
    } else if (!isnan(height_m)) { /* of everything: the roof takes what its shape wants, and leaves the walls their
                                      share */
        eaves_m = fmax(height_m - rise_m, fmin(fmax(0.5 * height_m, least_m), height_m));
        rise_m = height_m - eaves_m, from = HEIGHT_FROM_FILE;
    }
    b->eaves_m = (float)eaves_m;
    b->ridge_m = fmaxf((float)(eaves_m + rise_m), b->eaves_m);
    b->levels = (uint8_t)clamp(!isnan(levels) ? ceil(levels) : floor(eaves_m / storey_m + 0.2), 1, 100);
    return from;
}

/* Direction of the ridge, or for a single slope that in which it falls. roof:direction is the way a slope faces, which
 * is across the ridge. */
static double ridge_of(const CultureFacts *f, RoofShape roof, double along_rad)
{
    const double across_rad = along_rad + 0.5 * pi_rad;
    if (fabs(f->ridge_rad) <= 2 * pi_rad) return f->ridge_rad;
    if (!isnan(f->direction_rad)) {
        const double faces_rad = 0.5 * pi_rad - f->direction_rad; /* from clockwise of north */
        return roof == ROOF_SKILLION ? faces_rad : faces_rad + 0.5 * pi_rad;
    }
    if (roof == ROOF_SKILLION) return f->roof_way == 1 ? along_rad : across_rad;
    return f->roof_way == 1 ? across_rad : along_rad;
}

/* Mean width of the wings about courtyards: of a strip of this area with both its sides in the outline. */
static double wing_m(const double (*p)[2], int corners, double area_m2)
{
    double around_m = 0;
    for (int k = 0; k < corners; k++)
        around_m += hypot(p[(k + 1) % corners][0] - p[k][0], p[(k + 1) % corners][1] - p[k][1]);
    return 2 * area_m2 / around_m;
}

void culture_building_make(Building *out, HeightFrom *from, int *mended, const CultureFacts *f,
                           const double (*corner_m)[2], int corners, double area_m2, bool hollow)
{
    const CultureRule *rule = f->what[VECTOR_POLYGON];
    double             side_m[2], along_rad;
    const int          of_rule = rule && rule->makes == MAKES_BUILDING ? rule->kind : -1;
    Building           b = {0};
    culture_rectangle(side_m, &along_rad, corner_m, corners);
    if (hollow) side_m[1] = wing_m(corner_m, corners, area_m2);
    const BuildingUse use = f->use >= 0    ? (BuildingUse)f->use
                            : of_rule >= 0 ? (BuildingUse)of_rule
                                           : use_by_size(area_m2, f->levels);
    b.use = (uint8_t)use;
    b.roof = (uint8_t)(f->roof >= 0 ? f->roof : (int)roof_of(use, area_m2, f->levels));
    *from = set_heights(&b, f, area_m2, side_m[1], mended);
    b.ridge_rad = (float)remainder(ridge_of(f, (RoofShape)b.roof, along_rad), 2 * pi_rad);
    b.wall_fabric = (uint8_t)(f->wall >= 0 ? f->wall : wall_of(use));
    b.roof_fabric = (uint8_t)(f->cover >= 0 ? f->cover : cover_of(use, (RoofShape)b.roof));
    b.damage = f->ruined ? 2 : 0;
    b.heated = f->heated >= 0 ? f->heated : (use == BUILDING_HOUSE || use == BUILDING_FLATS) && !f->ruined;
    b.chimneys = f->chimneys >= 0 && f->chimneys <= 4           ? (uint8_t)f->chimneys
                 : use == BUILDING_HOUSE                        ? 1
                 : use == BUILDING_FLATS && b.roof != ROOF_FLAT ? 2
                                                                : 0;
    *out = b;
}
