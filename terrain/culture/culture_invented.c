/* terrain/culture/culture_invented.c: invents what people built, step by step, and keeps what is in the square. */
#include "terrain/culture/culture_invented_private.h"

#include <stdlib.h>

/* ---- records ------------------------------------------------------------------------------------- */

static bool is_in_square(const Inventor *v, double x_m, double y_m)
{
    return x_m >= v->low_m[0] && y_m >= v->low_m[1] && x_m < v->high_m[0] && y_m < v->high_m[1];
}

/* Of the landscape's seed, the kind and the place to a centimetre; never 0. */
static uint64_t id_of(const Inventor *v, uint64_t kind, double x_m, double y_m)
{
    const uint64_t id =
        invented_hash(invented_hash(v->seed, 1000 + (int64_t)kind, 0), llrint(x_m * 100), llrint(y_m * 100));
    return id ? id : 1;
}

/* A float that is not above a height. */
static float float_below(double z_m)
{
    const float z = (float)z_m;
    return (double)z > z_m ? nextafterf(z, -INFINITY) : z;
}

void invent_building(Inventor *v, const Rectangle *r, const Building *building, int owner)
{
    double low_m, high_m, corner[4][2];
    if (v->status != STATUS_OK) return;
    invent_ground_span(&low_m, &high_m, v, r);
    if (!isfinite(low_m) || !isfinite(high_m)) return;
    invent_take(v, r, TAKEN_BUILDING, owner);
    if (v->status != STATUS_OK || !is_in_square(v, r->x_m, r->y_m)) return;
    Building b = *building;
    b.id = id_of(v, 0, r->x_m, r->y_m);
    b.base_m = float_below(low_m);
    b.eaves_m += (float)(high_m - low_m), b.ridge_m += (float)(high_m - low_m);
    rectangle_corners(corner, r);
    v->status = culture_add_building(&v->culture, &b, (const double(*)[2])corner, 4);
}

void invent_point(Inventor *v, CulturePointKind kind, const Rectangle *r, double tall_m, int owner)
{
    double low_m, high_m;
    if (v->status != STATUS_OK) return;
    invent_ground_span(&low_m, &high_m, v, r);
    if (!isfinite(low_m)) return;
    invent_take(v, r, TAKEN_THING, owner);
    if (v->status != STATUS_OK || !is_in_square(v, r->x_m, r->y_m)) return;
    const CulturePoint point = {.id = id_of(v, 1 + (uint64_t)kind, r->x_m, r->y_m),
                                .x_m = r->x_m,
                                .y_m = r->y_m,
                                .base_m = float_below(low_m),
                                .heading_rad = (float)atan2(r->along[0], r->along[1]),
                                .size_m = {(float)(2 * r->half_m[0]), (float)(2 * r->half_m[1]), (float)tall_m},
                                .kind = (uint8_t)kind};
    v->status = culture_add_point(&v->culture, &point);
}

void invent_line(Inventor *v, const CultureLine *line, const double (*corner_m)[2], int corners)
{
    if (v->status != STATUS_OK || corners < 2 || !is_in_square(v, corner_m[0][0], corner_m[0][1])) return;
    CultureLine l = *line;
    /* of its first two corners: several lines may begin at one place */
    l.id = id_of(v, 100 + line->kind, corner_m[0][0] + 3 * corner_m[1][0], corner_m[0][1] + 3 * corner_m[1][1]);
    v->status = culture_add_line(&v->culture, &l, corner_m, corners);
}

/* ---- the landscape's ways and villages -------------------------------------------------------------- */

static Status gather_ways(Inventor *v)
{
    enum { most = 1 << 16 };
    double(*found)[2] = malloc(most * sizeof *found);
    int     room = 0, way_room = 0, count;
    WayKind kind;
    if (!found) return STATUS_NO_MEMORY;
    for (int way = 0; (count = landscape_way_vertices(found, &kind, v->landscape, way, most)) > 0; way++) {
        if (v->vertices + count > room) {
            room = 2 * (v->vertices + count);
            void *more = realloc(v->vertex, (size_t)room * sizeof *v->vertex);
            if (!more) break;
            v->vertex = more;
        }
        if (way + 2 > way_room) {
            way_room = 2 * way + 64;
            int *first = realloc(v->way_first, (size_t)way_room * sizeof *first);
            if (first) v->way_first = first;
            uint8_t *kinds = first ? realloc(v->way_kind, (size_t)way_room) : NULL;
            if (!kinds) break;
            v->way_kind = kinds;
        }
        memcpy(v->vertex + v->vertices, found, (size_t)count * sizeof *found);
        v->way_first[way] = v->vertices, v->way_kind[way] = (uint8_t)kind;
        v->vertices += count, v->way_first[way + 1] = v->vertices, v->way_count = way + 1;
    }
    free(found);
    return count > 0 ? STATUS_NO_MEMORY : STATUS_OK;
}

static Status gather_villages(Inventor *v)
{
    double place[2];
    v->village = calloc(invent_most_villages, sizeof *v->village);
    if (!v->village) return STATUS_NO_MEMORY;
    while (v->villages < invent_most_villages && landscape_village(place, v->landscape, v->villages)) {
        memcpy(v->village[v->villages], place, sizeof place);
        v->villages++;
    }
    return STATUS_OK;
}

int invent_village_near(double *away_m, const Inventor *v, double x_m, double y_m)
{
    int nearest = -1;
    *away_m = INFINITY;
    for (int n = 0; n < v->villages; n++) {
        const double m = hypot(v->village[n][0] - x_m, v->village[n][1] - y_m);
        if (m < *away_m) *away_m = m, nearest = n;
    }
    return nearest;
}

/* ---- the whole ----------------------------------------------------------------------------------- */

static void inventor_free(Inventor *v)
{
    invent_ground_close(v), invent_sites_close(v);
    free(v->vertex), free(v->way_first), free(v->way_kind), free(v->village), free(v->built);
    culture_free(&v->culture);
}

Status culture_invent(Culture *out, const Landscape *landscape, const CultureConfig *config)
{
    Inventor v = {.landscape = landscape};
    for (int k = 0; k < 2; k++) {
        v.low_m[k] = config->centre_m[k] - config->half_width_m,
        v.high_m[k] = config->centre_m[k] + config->half_width_m;
        if (!(fabs(config->centre_m[k]) <= 1e6) || !(config->half_width_m > 0 && config->half_width_m <= 1e6)) {
            log_error("culture: the square about (%g, %g) of half width %g m is none; give a half width in 0 .. 1e6",
                      config->centre_m[0], config->centre_m[1], config->half_width_m);
            return STATUS_BAD_VALUE;
        }
    }
    v.seed = invented_hash(config->seed, 90, 0);
    if (landscape_is_synthetic(landscape) && landscape->elevation.level_count > 0) {
        const ElevationLevel *level = &landscape->elevation.level[0];
        v.x0_m = level->x0_m, v.y0_m = level->y0_m;
        v.side_m[0] = (level->nx - 1) * level->spacing_m, v.side_m[1] = (level->ny - 1) * level->spacing_m;
        v.status = gather_ways(&v);
        if (v.status == STATUS_OK) v.status = gather_villages(&v);
        if (v.status == STATUS_OK && v.way_count > 0) v.status = invent_ground_open(&v);
        if (v.status == STATUS_OK && v.way_count > 0) v.status = invent_sites_open(&v);
        if (v.status == STATUS_OK && v.way_count > 0) {
            invent_houses(&v), invent_churches(&v);
            invent_plots(&v), invent_streets(&v);
            invent_works(&v), invent_farms(&v), invent_masts(&v);
        }
    }
    if (v.status == STATUS_OK) v.status = culture_index(&v.culture);
    const Status status = v.status;
    if (status == STATUS_OK) *out = v.culture, v.culture = (Culture){0};
    inventor_free(&v);
    return status;
}
