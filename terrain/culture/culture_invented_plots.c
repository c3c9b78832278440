/* terrain/culture/culture_invented_plots.c: what else is on a plot with a house: garage, shed or small barn, and what
 * encloses it. */
#include "terrain/culture/culture_invented_private.h"

/* ---- enclosures ------------------------------------------------------------------------------------ */

static bool is_at_gate(const Enclosure *e, double x_m, double y_m)
{
    for (int g = 0; g < e->gates; g++)
        if (hypot(e->gate_m[g][0] - x_m, e->gate_m[g][1] - y_m) < e->gate_half_m[g]) return true;
    return false;
}

static bool is_open(const Inventor *v, const Enclosure *e, const Rectangle *piece)
{
    static const double room_m = 0.2;
    return !is_at_gate(e, piece->x_m, piece->y_m) &&
           !invent_is_taken(v, piece, TAKEN_BUILDING | TAKEN_THING | TAKEN_DRIVE, -1) &&
           !invent_is_taken(v, piece, TAKEN_PLOT, e->owner) && invent_is_dry(v, piece, room_m) &&
           invent_is_clear(v, piece, (double)e->line.height_m);
}

/* Adds the straight run from a to b, if it is long enough to be one. */
static void add_run(Inventor *v, const Enclosure *e, const double a[2], const double b[2])
{
    static const double shortest_m = 1.9;
    const double        corner[2][2] = {{a[0], a[1]}, {b[0], b[1]}}, length_m = hypot(b[0] - a[0], b[1] - a[1]);
    if (length_m < shortest_m) return;
    const Rectangle r = {0.5 * (a[0] + b[0]),
                         0.5 * (a[1] + b[1]),
                         {(b[0] - a[0]) / length_m, (b[1] - a[1]) / length_m},
                         {0.5 * length_m, 0.5 * (double)e->line.width_m}};
    invent_take(v, &r, TAKEN_LINE, e->owner);
    invent_line(v, &e->line, corner, 2);
}

void invent_enclosure(Inventor *v, const Enclosure *e)
{
    static const double step_m = 1;
    for (int k = 0; k + 1 < e->corners; k++) {
        const double *a = e->corner_m[k], *b = e->corner_m[k + 1];
        const double  length_m = hypot(b[0] - a[0], b[1] - a[1]);
        const int     parts = (int)fmax(ceil(length_m / step_m), 1);
        double        from[2], last[2];
        bool          runs = false;
        if (!(length_m > 0)) continue;
        for (int n = 0; n < parts; n++) {
            const double    p[2] = {a[0] + (b[0] - a[0]) * n / parts, a[1] + (b[1] - a[1]) * n / parts};
            const double    q[2] = {a[0] + (b[0] - a[0]) * (n + 1) / parts, a[1] + (b[1] - a[1]) * (n + 1) / parts};
            const Rectangle piece = {0.5 * (p[0] + q[0]),
                                     0.5 * (p[1] + q[1]),
                                     {(b[0] - a[0]) / length_m, (b[1] - a[1]) / length_m},
                                     {0.5 * length_m / parts, 0.15}};
            const bool      open = is_open(v, e, &piece);
            if (open && !runs) memcpy(from, p, sizeof from), runs = true;
            if (open) memcpy(last, q, sizeof last);
            if (runs && (!open || n + 1 == parts)) add_run(v, e, from, last), runs = false;
        }
    }
}

void invent_enclose(Enclosure *e, const Rectangle *r)
{
    double corner[4][2];
    rectangle_corners(corner, r);
    e->corners = 5;
    for (int k = 0; k < 5; k++) memcpy(e->corner_m[k], corner[k % 4], sizeof corner[0]);
}

CultureLine invent_border(CultureLineKind kind, double height_m)
{
    return (CultureLine){
        .kind = (uint8_t)kind, .width_m = kind == CULTURE_WALL ? 0.3f : 0.1f, .height_m = (float)height_m};
}

/* ---- small buildings ------------------------------------------------------------------------------- */

bool invent_fits(const Inventor *v, const Rectangle *r, double room_m, double top_m, int owner)
{
    const Rectangle roomy = rectangle_grown(r, room_m);
    return !invent_is_taken(v, &roomy, TAKEN_BUILDING | TAKEN_THING | TAKEN_LINE, -1) &&
           !invent_is_taken(v, r, TAKEN_PLOT | TAKEN_SITE, owner) && invent_slope(v, r) <= culture_steepest &&
           invent_is_dry(v, r, 0.3) && invent_is_clear(v, r, top_m);
}

/* Where the middle of the drive is that the cover draws beside the house. */
static double drive_of(const HousePlot *p)
{
    return p->house[0] + (p->house[0] > 0 ? -1 : 1) * (p->house_half[0] + 1.8);
}

/* The drive from the house's front to the way. */
static void keep_drive(Inventor *v, const HousePlot *p, const Rectangle *plot, double front, int owner)
{
    static const double half_m = 1.7, beyond_m = 1.3;
    const double        from = fabs(p->house[1]) + p->house_half[1], to = p->half_across_m + beyond_m;
    const Rectangle     r = rectangle_within(plot, drive_of(p), front * 0.5 * (from + to), half_m, 0.5 * (to - from));
    invent_take(v, &r, TAKEN_DRIVE, owner);
}

/* A garage at the end of the drive. */
static void add_garage(Inventor *v, const HousePlot *p, const Rectangle *plot, double front, int owner, uint64_t hash)
{
    static const double half_m[2] = {1.6, 2.8}, eaves_m = 2.4;
    const double        drive = drive_of(p);
    const double        back = p->house_half[1] + half_m[1] - 2.5 * invent_unit(hash, 41);
    const Rectangle     r = rectangle_within(plot, drive, p->house[1] - front * back, half_m[0], half_m[1]);
    if (fabs(drive) + half_m[0] > p->half_along_m - 0.6) return;
    const bool flat = invent_unit(hash, 42) < 0.45;
    Building   b = invent_roofed(&r, flat ? ROOF_FLAT : ROOF_GABLED, eaves_m, 28 * rad_per_deg, false);
    b.use = BUILDING_SHED, b.wall_fabric = invent_unit(hash, 43) < 0.6 ? FABRIC_RENDER : FABRIC_BRICK;
    if (invent_fits(v, &r, 0.15, (double)b.ridge_m, owner)) invent_building(v, &r, &b, owner);
}

static void add_shed(Inventor *v, const HousePlot *p, const Rectangle *plot, double front, int owner, uint64_t hash)
{
    const bool   barn = invent_unit(hash, 50) < 0.18;
    const double half[2] = {barn ? 4 + invent_unit(hash, 51) : 1.2 + invent_unit(hash, 51),
                            barn ? 2.6 + invent_unit(hash, 52) : 1.0 + 0.6 * invent_unit(hash, 52)};
    const double    across = p->half_across_m - half[1] - 1.5 - 3 * invent_unit(hash, 53);
    const double    room = p->half_along_m - half[0] - 1.5;
    const Rectangle r =
        rectangle_within(plot, room * (2 * invent_unit(hash, 54) - 1), -front * across, half[0], half[1]);
    if (room < 0) return;
    const RoofShape roof = barn || invent_unit(hash, 55) < 0.6 ? ROOF_GABLED : ROOF_SKILLION;
    Building        b = invent_roofed(&r, roof, barn ? 3 : 2,
                                      (barn                  ? 40
                                       : roof == ROOF_GABLED ? 30
                                                             : 10) *
                                          rad_per_deg,
                                      roof == ROOF_GABLED);
    b.use = barn ? BUILDING_BARN : BUILDING_SHED, b.wall_fabric = FABRIC_TIMBER;
    b.roof_fabric = barn ? FABRIC_TILE : invent_unit(hash, 56) < 0.5 ? FABRIC_FELT : FABRIC_SHEET;
    if (invent_fits(v, &r, 0.6, (double)b.ridge_m, owner)) invent_building(v, &r, &b, owner);
}

/* ---- borders ---------------------------------------------------------------------------------------- */

/* Along the lane, open where drives are and before the door; at the sides and behind, where most plots have their hedge
 * alone. */
static void add_borders(Inventor *v, const HousePlot *p, const Rectangle *plot, double front, int owner, uint64_t hash)
{
    static const double inset_m = 0.25;
    const double        u = invent_unit(hash, 60), w = invent_unit(hash, 61);
    const double        along = p->half_along_m - inset_m, across = front * (p->half_across_m - inset_m);
    Enclosure           e = {.owner = owner, .gates = 1, .gate_half_m = {1.1}};
    rectangle_at(e.gate_m[0], plot, p->house[0], across); /* before the door */
    if (u < 0.78) {
        e.line = u < 0.3    ? invent_border(CULTURE_WALL, 0.8 + 0.5 * invent_unit(hash, 62))
                 : u < 0.66 ? invent_border(CULTURE_FENCE, 1.0)
                            : invent_border(CULTURE_WIRE_FENCE, 1.2);
        e.corners = 2;
        rectangle_at(e.corner_m[0], plot, -along, across), rectangle_at(e.corner_m[1], plot, along, across);
        invent_enclosure(v, &e);
    }
    if (w > 0.45) return;
    e.line = w < 0.2    ? invent_border(CULTURE_FENCE, 1.1 + 0.5 * invent_unit(hash, 63))
             : w < 0.38 ? invent_border(CULTURE_WIRE_FENCE, 1.2)
                        : invent_border(CULTURE_WALL, 1.4 + 0.4 * invent_unit(hash, 63));
    e.corners = 4, e.gates = 0;
    rectangle_at(e.corner_m[0], plot, -along, across), rectangle_at(e.corner_m[1], plot, -along, -across);
    rectangle_at(e.corner_m[2], plot, along, -across), rectangle_at(e.corner_m[3], plot, along, across);
    invent_enclosure(v, &e);
}

void invent_plots(Inventor *v)
{
    int              plots;
    const HousePlot *plot = landscape_plots(v->landscape, &plots);
    for (int step = 0; step < 2; step++) /* fences stop at what is built on any plot */
        for (int n = 0; n < plots && v->status == STATUS_OK; n++) {
            const Rectangle r = invent_plot_rectangle(&plot[n]);
            const uint64_t  hash = invent_hash(v, 12, r.x_m, r.y_m);
            const double    front = plot[n].house[1] < 0 ? -1 : 1;
            if (!v->built[n]) continue;
            if (step == 1) {
                add_borders(v, &plot[n], &r, front, n, hash);
                continue;
            }
            keep_drive(v, &plot[n], &r, front, n);
            if (invent_unit(hash, 40) < 0.6) add_garage(v, &plot[n], &r, front, n, hash);
            if (invent_unit(hash, 44) < 0.5) add_shed(v, &plot[n], &r, front, n, hash);
        }
}
