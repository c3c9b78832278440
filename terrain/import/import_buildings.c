/* terrain/import/import_buildings.c: the buildings of a surface model as records, on the ground of its store. */
#include "terrain/from_files/culture_import.h"
#include "terrain/import/terrain_import_private.h"

#include <stdlib.h>

Status import_buildings_add(Culture *to, const Culture *from)
{
    Status status = STATUS_OK;
    to->left_out += from->left_out;
    for (int n = 0; n < from->buildings && status == STATUS_OK; n++) {
        const Building *b = &from->building[n];
        status = culture_add_building(to, b, (const double(*)[2])from->corner_m + b->first_corner, b->corners);
    }
    return status;
}

/* ENU z of a place whose height above the ellipsoid is given; its x and y are those of ENU. Along the vertical of the
 * origin a height grows by the cosine between the verticals, so each round leaves a millionth of the error of the one
 * before within 10 km, and ten thousandth within 100. */
static double z_of_height(const LocalFrame *frame, double x_m, double y_m, double h_m)
{
    enum { rounds = 4 };
    double   p_enu[3] = {x_m, y_m, h_m - frame->origin.h_m}, p_ecef[3];
    Geodetic place;
    for (int k = 0; k < rounds; k++) {
        ecef_from_enu(p_ecef, frame, p_enu);
        if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) return NAN;
        p_enu[2] += h_m - place.h_m;
    }
    return p_enu[2];
}

static double store_ground(void *user, double x_m, double y_m)
{
    return elevation_height(&((const TerrainStore *)user)->elevation, x_m, y_m, NULL);
}

static int by_id(const void *a, const void *b)
{
    const uint64_t x = ((const Building *)a)->id, y = ((const Building *)b)->id;
    return (x > y) - (x < y);
}

/* Puts a building on its floor; its roof stays where it was, if that is a metre over the floor. Returns false where
 * there is no ground. */
static bool settle(Building *b, const double (*corner_m)[2], const CultureFiles *ground)
{
    double middle_m[2] = {0};
    for (int k = 0; k < b->corners; k++)
        for (int c = 0; c < 2; c++) middle_m[c] += corner_m[k][c] / b->corners;
    const double base_m = z_of_height(ground->frame, middle_m[0], middle_m[1], (double)b->base_m);
    const double floor_m = culture_floor_m(ground, corner_m, b->corners);
    if (!isfinite(base_m) || !isfinite(floor_m)) return false;
    b->eaves_m = (float)fmax((double)b->eaves_m + base_m - floor_m, 1);
    b->ridge_m = fmaxf((float)((double)b->ridge_m + base_m - floor_m), b->eaves_m);
    b->base_m = (float)floor_m;
    return true;
}

Status import_buildings_write(StoreImport *m, const TerrainStore *store)
{
    const CultureFiles ground = {.frame = &store->frame, .ground = store_ground, .user = (void *)store};
    Culture            all = {0};
    Status             status = STATUS_OK;
    if (m->culture.buildings > 0)
        qsort(m->culture.building, (size_t)m->culture.buildings, sizeof *m->culture.building, by_id);
    for (int n = 0; n < m->culture.buildings && status == STATUS_OK; n++) {
        Building b = m->culture.building[n];
        const double(*corner_m)[2] = (const double(*)[2])m->culture.corner_m + b.first_corner;
        if (settle(&b, corner_m, &ground)) status = culture_add_building(&all, &b, corner_m, b.corners);
        else all.left_out++;
    }
    if (status == STATUS_OK) status = culture_write_geojson(m->o->buildings, &all, &ground);
    m->r.records = all.buildings;
    m->r.records_left = m->culture.left_out + all.left_out;
    culture_free(&all);
    return status;
}
