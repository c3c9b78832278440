/* terrain/culture/culture_invented_houses.c: houses on the plots of villages: use, roof, fabrics, each village in a
 * style of its own. */
#include "terrain/culture/culture_invented_private.h"

#include <stdlib.h>

/* What most houses of a village have. */
typedef struct VillageStyle {
    uint8_t wall, roof_fabric;
    double  alike; /* share of houses that have it */
    double  pitch_rad;
} VillageStyle;

static uint8_t draw_wall(double u)
{
    return u < 0.45 ? FABRIC_RENDER : u < 0.75 ? FABRIC_BRICK : u < 0.88 ? FABRIC_STONE : FABRIC_TIMBER;
}

static uint8_t draw_roof_fabric(double u)
{
    return u < 0.68 ? FABRIC_TILE : u < 0.86 ? FABRIC_SLATE : u < 0.96 ? FABRIC_SHEET : FABRIC_THATCH;
}

static VillageStyle style_of(const Inventor *v, int village)
{
    const uint64_t h = invented_hash(v->seed, 10, village);
    return (VillageStyle){draw_wall(invent_unit(h, 0)), draw_roof_fabric(0.86 * invent_unit(h, 1)),
                          0.5 + 0.3 * invent_unit(h, 2), (36 + 10 * invent_unit(h, 3)) * rad_per_deg};
}

Building invent_roofed(const Rectangle *r, RoofShape roof, double eaves_m, double pitch_rad, bool along)
{
    const double heading = atan2(r->along[1], r->along[0]), span_m = along ? r->half_m[1] : r->half_m[0];
    const double rise[ROOF_SHAPES] = {
        [ROOF_FLAT] = 0,
        [ROOF_GABLED] = span_m,
        [ROOF_HIPPED] = fmin(r->half_m[0], r->half_m[1]),
        [ROOF_PYRAMIDAL] = fmin(r->half_m[0], r->half_m[1]),
        [ROOF_SKILLION] = 2 * (along ? r->half_m[0] : r->half_m[1]),
    };
    return (Building){.eaves_m = (float)eaves_m,
                      .ridge_m = (float)(eaves_m + rise[roof] * tan(pitch_rad)),
                      .ridge_rad = (float)(along ? heading : heading + 0.5 * pi_rad),
                      .roof = (uint8_t)roof,
                      .wall_fabric = FABRIC_RENDER,
                      .roof_fabric = roof == ROOF_FLAT ? FABRIC_FELT : FABRIC_TILE,
                      .levels = 1};
}

Building invent_house(const Inventor *v, const Rectangle *r, int village, uint64_t hash)
{
    static const double level_m = 2.7, plinth_m = 0.4;
    const VillageStyle  style = style_of(v, village);
    const double        u = invent_unit(hash, 0);
    const int           levels = invent_unit(hash, 1) < 0.55 ? 1 : 2;
    const bool          longer = r->half_m[0] >= r->half_m[1];
    /* most ridges are along the longer side, most of these along the lane */
    const bool      along = invent_unit(hash, 2) < 0.8 ? longer : !longer;
    const RoofShape roof = u < 0.74 ? ROOF_GABLED : u < 0.9 ? ROOF_HIPPED : u < 0.95 ? ROOF_PYRAMIDAL : ROOF_FLAT;
    const double    pitch =
        clamp(style.pitch_rad + 8 * rad_per_deg * (invent_unit(hash, 3) - 0.5), 30 * rad_per_deg, 50 * rad_per_deg);
    Building b = invent_roofed(r, roof, plinth_m + levels * level_m, pitch, roof == ROOF_HIPPED ? longer : along);
    b.use = BUILDING_HOUSE, b.levels = (uint8_t)levels;
    b.wall_fabric = invent_unit(hash, 4) < style.alike ? style.wall : draw_wall(invent_unit(hash, 5));
    if (roof != ROOF_FLAT) {
        b.roof_fabric = invent_unit(hash, 6) < style.alike ? style.roof_fabric : draw_roof_fabric(invent_unit(hash, 7));
        if (b.roof_fabric == FABRIC_THATCH && pitch < 45 * rad_per_deg) b.roof_fabric = FABRIC_TILE;
    }
    b.heated = invent_unit(hash, 8) < 0.9;
    b.chimneys = (uint8_t)(invent_unit(hash, 9) < 0.12 ? 0 : invent_unit(hash, 9) < 0.8 ? 1 : 2);
    return b;
}

Rectangle invent_plot_rectangle(const HousePlot *plot)
{
    return (Rectangle){
        plot->x_m, plot->y_m, {plot->direction[0], plot->direction[1]}, {plot->half_along_m, plot->half_across_m}};
}

/* Some houses near the middle of a large village are flats: school, inn, office. */
static void make_flats(Building *b, const Rectangle *r, uint64_t hash)
{
    const int levels = 2 + (invent_unit(hash, 20) < 0.5);
    Building  flats = invent_roofed(r, b->roof, 0.6 + 3.0 * levels, 35 * rad_per_deg, r->half_m[0] >= r->half_m[1]);
    flats.use = BUILDING_FLATS, flats.levels = (uint8_t)levels, flats.heated = true, flats.chimneys = 1;
    flats.wall_fabric = b->wall_fabric == FABRIC_TIMBER ? FABRIC_RENDER : b->wall_fabric;
    flats.roof_fabric = b->roof_fabric == FABRIC_THATCH ? FABRIC_TILE : b->roof_fabric;
    *b = flats;
}

void invent_houses(Inventor *v)
{
    static const double flats_m = 130; /* from the middle */
    int                 plots;
    const HousePlot    *plot = landscape_plots(v->landscape, &plots);
    v->built = calloc((size_t)plots + 1, 1);
    if (!v->built) {
        v->status = STATUS_NO_MEMORY;
        return;
    }
    for (int n = 0; n < plots; n++) {
        const Rectangle all = invent_plot_rectangle(&plot[n]);
        invent_take(v, &all, TAKEN_PLOT, n);
    }
    for (int n = 0; n < plots && v->status == STATUS_OK; n++) {
        const HousePlot *p = &plot[n];
        const Rectangle  all = invent_plot_rectangle(p);
        const Rectangle  r = rectangle_within(&all, p->house[0], p->house[1], p->house_half[0], p->house_half[1]);
        const uint64_t   hash = invent_hash(v, 11, r.x_m, r.y_m);
        double           away_m;
        const int        village = invent_village_near(&away_m, v, p->x_m, p->y_m);
        Building         b = invent_house(v, &r, village, hash);
        if (away_m < flats_m && invent_unit(hash, 21) < 0.12 && r.half_m[0] * r.half_m[1] > 32)
            make_flats(&b, &r, hash);
        if (invent_slope(v, &r) > culture_steepest || invent_is_taken(v, &r, TAKEN_BUILDING, -1) ||
            !invent_is_dry(v, &r, 0) || !invent_is_clear(v, &r, (double)b.ridge_m + culture_above_ridge_m))
            continue;
        invent_building(v, &r, &b, n);
        v->built[n] = 1;
        if (village >= 0) v->houses[village]++;
    }
}
