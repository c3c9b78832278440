/* terrain/culture/culture_invented_works.c: industry along the roads near some villages, and masts on hills. */
#include "terrain/culture/culture_invented_private.h"

/* ---- industry ---------------------------------------------------------------------------------------- */

static const double works_half_m[2] = {62, 44}, works_front_m = 12;
static const double works_top_m = 34; /* of its chimney */

static double unit(uint64_t hash, int k) { return invent_unit(hash, 200 + k); }

static Building hall(const Rectangle *site, const double half_m[2], double eaves_m, uint64_t hash, int k)
{
    Rectangle r = *site;
    r.half_m[0] = half_m[0], r.half_m[1] = half_m[1];
    const bool flat = unit(hash, k) < 0.35;
    Building   b = invent_roofed(&r, flat ? ROOF_FLAT : ROOF_GABLED, eaves_m, (6 + 6 * unit(hash, k + 1)) * rad_per_deg,
                                 half_m[0] >= half_m[1]);
    b.use = BUILDING_HALL, b.heated = unit(hash, k + 2) < 0.6;
    b.wall_fabric = unit(hash, k + 3) < 0.7 ? FABRIC_SHEET : unit(hash, k + 3) < 0.85 ? FABRIC_CONCRETE : FABRIC_BRICK;
    b.roof_fabric = flat ? FABRIC_FELT : FABRIC_SHEET;
    return b;
}

/* Freight containers of 6.06 x 2.44 x 2.59 m (ISO 668, 1CC), side by side in two rows. */
static void add_containers(Inventor *v, const Rectangle *site, uint64_t hash, int owner)
{
    static const double size_m[3] = {2.44, 6.06, 2.59};
    for (int k = 0; k < 16; k++) {
        const double at_m[2] = {-56 + 2.9 * (k % 8), -34 + 8.0 * (k / 8)};
        if (unit(hash, 40 + k) < 0.7) invent_site_point(v, site, CULTURE_CONTAINER, at_m, size_m, owner);
    }
}

static void enclose(Inventor *v, const Rectangle *site, int owner)
{
    const Rectangle all = rectangle_grown(site, -0.5);
    Enclosure       e = {.owner = owner, .gates = 1, .line = invent_border(CULTURE_WIRE_FENCE, 2.2)};
    rectangle_at(e.gate_m[0], &all, 0, -all.half_m[1]), e.gate_half_m[0] = 4.5;
    invent_enclose(&e, &all);
    invent_enclosure(v, &e);
}

static void build_works(Inventor *v, const Rectangle *site, uint64_t hash, int owner)
{
    invent_take(v, site, TAKEN_SITE, owner);
    const double main_half[2] = {20 + 7 * unit(hash, 0), 12 + 4 * unit(hash, 1)};
    const double next_half[2] = {9 + 3 * unit(hash, 2), 14 + 4 * unit(hash, 3)}, office_half[2] = {9, 6};
    Building     b = hall(site, main_half, 7 + 2 * unit(hash, 4), hash, 5);
    invent_site_building(v, site, (double[2]){-30, 22}, main_half, &b, owner);
    b = hall(site, next_half, 5.5 + 2 * unit(hash, 10), hash, 11);
    invent_site_building(v, site, (double[2]){46, 14}, next_half, &b, owner);
    const Rectangle office = rectangle_within(site, 0, 0, office_half[0], office_half[1]);
    b = invent_roofed(&office, ROOF_FLAT, 3.2 * 2 + 0.6, 0, true);
    b.use = BUILDING_FLATS, b.levels = 2, b.heated = true;
    b.wall_fabric = unit(hash, 16) < 0.5 ? FABRIC_CONCRETE : FABRIC_RENDER;
    invent_site_building(v, site, (double[2]){22, -33}, office_half, &b, owner);
    const double tank_m = 6 + 2.5 * unit(hash, 17), tank_top_m = 7 + 3 * unit(hash, 18);
    const int    tanks = 2 + (unit(hash, 19) < 0.5);
    for (int k = 0; k < tanks; k++)
        invent_site_point(v, site, CULTURE_TANK, (double[2]){4 + (tank_m + 2.5) * k, 36},
                          (double[3]){tank_m, tank_m, tank_top_m}, owner);
    invent_site_point(v, site, CULTURE_CHIMNEY, (double[2]){6, 26}, (double[3]){1.8, 1.8, 22 + 10 * unit(hash, 20)},
                      owner);
    for (int k = 0; k < 3; k++) {
        const double size_m = 6 + 4 * unit(hash, 21 + k);
        if (unit(hash, 24 + k) < 0.75)
            invent_site_point(v, site, CULTURE_HEAP, (double[2]){-50 + 13.0 * k, -8},
                              (double[3]){size_m, size_m, 0.38 * size_m}, owner);
    }
    for (int k = 0; k < 3; k++)
        if (unit(hash, 27 + k) < 0.7)
            invent_site_point(v, site, CULTURE_STACK, (double[2]){52, -24 - 5.5 * k},
                              (double[3]){5 + 3 * unit(hash, 30 + k), 3, 2.4}, owner);
    add_containers(v, site, hash, owner);
    for (int k = -1; k <= 1; k += 2)
        invent_site_point(v, site, CULTURE_LAMP, (double[2]){18.0 * k, -20}, (double[3]){0.2, 0.2, 9}, owner);
    invent_site_point(v, site, CULTURE_SIGN, (double[2]){8, -works_half_m[1] + 2}, (double[3]){1.6, 0.1, 2.4}, owner);
    for (int k = 0; k < 2; k++)
        invent_ground_strip(v, site, CULTURE_YARD, SURFACE_BUILT, (double[2]){-48, -26.0 + 22 * k},
                            (double[2]){44, -26.0 + 22 * k}, 22.5);
    invent_ground_strip(v, site, CULTURE_ROAD, SURFACE_ROAD, (double[2]){0, -works_half_m[1] - works_front_m},
                        (double[2]){0, -works_half_m[1] + 8}, 7);
    enclose(v, site, owner);
}

static void add_works(Inventor *v, int village)
{
    enum { looks = 120, most_near = 4096 };
    static const double nearest_m = 150, farthest_m = 1100, steepest = 0.07, apart_m = 75, wildest = 0.25;
    const uint64_t      own = invented_hash(v->seed, 18, village);
    int                 near[most_near], nears = 0;
    for (int way = 0; way < v->way_count; way++)
        for (int n = v->way_first[way]; n + 1 < v->way_first[way + 1] && v->way_kind[way] == WAY_ROAD; n++) {
            const double m = hypot(v->vertex[n][0] - v->village[village][0], v->vertex[n][1] - v->village[village][1]);
            if (m >= nearest_m && m <= farthest_m && nears < most_near) near[nears++] = n;
        }
    for (int k = 0; k < looks && nears > 0; k++) {
        const uint64_t hash = invented_hash(own, k, 0);
        const int      n = near[(int)(invent_unit(hash, 0) * nears)];
        const double  *a = v->vertex[n], *b = v->vertex[n + 1], length_m = hypot(b[0] - a[0], b[1] - a[1]);
        if (!(length_m > 0)) continue;
        const Rectangle road = {a[0], a[1], {(b[0] - a[0]) / length_m, (b[1] - a[1]) / length_m}, {0, 0}};
        const Rectangle site = invent_site_beside(&road, invent_unit(hash, 1) < 0.5, works_front_m, works_half_m);
        const Rectangle all = invent_site_and_front(&site, works_front_m);
        if (invent_is_built_up(v, site.x_m, site.y_m, apart_m) || invent_slope(v, &site) > steepest ||
            invent_is_taken(v, &site, TAKEN_ALL, -1) || invent_wild_share(v, &site) > wildest ||
            !invent_is_dry(v, &site, 0) || !invent_is_clear(v, &all, works_top_m))
            continue;
        build_works(v, &site, hash, invent_owner_works + village);
        return;
    }
}

void invent_works(Inventor *v)
{
    static const double share = 0.7; /* of villages of some size */
    static const int    least_houses = 25;
    for (int n = 0; n < v->villages && v->status == STATUS_OK; n++)
        if (v->houses[n] >= least_houses && invented_unit(invented_hash(v->seed, 19, n)) < share) add_works(v, n);
}

/* ---- masts -------------------------------------------------------------------------------------------- */

/* On the highest of some places of each square of 4 km, within a fence. */
static void add_mast(Inventor *v, const double corner_m[2], uint64_t hash, int owner)
{
    enum { looks = 40 };
    static const double cell_m = 4000, yard_half_m[2] = {5, 5}, away_m = 150;
    const double        high_m = 32 + 20 * invent_unit(hash, 90);
    double              highest_m = -INFINITY;
    Rectangle           best = {0};
    for (int k = 0; k < looks; k++) {
        const Rectangle yard = {corner_m[0] + cell_m * invent_unit(hash, 2 * k),
                                corner_m[1] + cell_m * invent_unit(hash, 2 * k + 1),
                                {1, 0},
                                {yard_half_m[0], yard_half_m[1]}};
        const double    z_m = invent_height(v, yard.x_m, yard.y_m);
        const double    over_m = z_m + (yard.x_m * yard.x_m + yard.y_m * yard.y_m) / (2 * 6371e3); /* the sphere */
        if (!(over_m > highest_m) || invent_is_built_up(v, yard.x_m, yard.y_m, away_m) ||
            invent_is_taken(v, &yard, TAKEN_ALL, -1) || invent_slope(v, &yard) > 0.8 * culture_steepest ||
            !invent_is_dry(v, &yard, 2) || !invent_is_clear(v, &yard, high_m))
            continue;
        highest_m = over_m, best = yard;
    }
    if (highest_m == -INFINITY) return;
    invent_take(v, &best, TAKEN_SITE, owner);
    invent_site_point(v, &best, CULTURE_MAST, (double[2]){0, 1}, (double[3]){1.8, 1.8, high_m}, owner);
    invent_site_point(v, &best, CULTURE_CONTAINER, (double[2]){-1.5, -2.8}, (double[3]){4, 2.4, 2.6}, owner);
    Enclosure e = {.owner = owner, .line = invent_border(CULTURE_WIRE_FENCE, 2.2)};
    invent_enclose(&e, &best);
    invent_enclosure(v, &e);
}

void invent_masts(Inventor *v)
{
    static const double cell_m = 4000;
    const int           across = (int)(v->side_m[0] / cell_m), up = (int)(v->side_m[1] / cell_m);
    for (int n = 0; n < across * up && v->status == STATUS_OK; n++)
        add_mast(v, (double[2]){v->x0_m + n % across * cell_m, v->y0_m + n / across * cell_m},
                 invented_hash(v->seed, 20, n), invent_owner_mast + n);
}
