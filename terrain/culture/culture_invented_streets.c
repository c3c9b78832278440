/* terrain/culture/culture_invented_streets.c: what belongs to a village as a whole and to its roads: church, lamps,
 * signs, a power line. */
#include "terrain/culture/culture_invented_private.h"

/* ---- places along ways ------------------------------------------------------------------------------ */

double invent_way_length(const Inventor *v, int way)
{
    double m = 0;
    for (int n = v->way_first[way] + 1; n < v->way_first[way + 1]; n++)
        m += hypot(v->vertex[n][0] - v->vertex[n - 1][0], v->vertex[n][1] - v->vertex[n - 1][1]);
    return m;
}

bool invent_way_place(Rectangle *out, const Inventor *v, int way, double along_m, double left_m)
{
    for (int n = v->way_first[way] + 1; n < v->way_first[way + 1] && along_m >= 0; n++) {
        const double *a = v->vertex[n - 1], *b = v->vertex[n];
        const double  length_m = hypot(b[0] - a[0], b[1] - a[1]);
        if (!(length_m > 0) || along_m > length_m) {
            along_m -= length_m;
            continue;
        }
        const double d[2] = {(b[0] - a[0]) / length_m, (b[1] - a[1]) / length_m};
        *out = (Rectangle){
            a[0] + along_m * d[0] - left_m * d[1], a[1] + along_m * d[1] + left_m * d[0], {d[0], d[1]}, {0, 0}};
        return true;
    }
    return false;
}

bool invent_is_built_up(const Inventor *v, double x_m, double y_m, double near_m)
{
    const Rectangle about = {x_m, y_m, {1, 0}, {near_m, near_m}};
    return invent_is_taken(v, &about, TAKEN_PLOT, -1);
}

/* Whether a post of half_m can stand beside a way: beside all ways, on none of the fields' tracks. */
static bool post_fits(const Inventor *v, const Rectangle *post, double tall_m, double apart_m)
{
    const Rectangle roomy = rectangle_grown(post, 0.3), alone = rectangle_grown(post, apart_m);
    const uint8_t   surface = (uint8_t)landscape_surface(v->landscape, post->x_m, post->y_m);
    return surface != SURFACE_ROAD && surface != SURFACE_BUILT && invent_is_dry(v, post, 0.1) &&
           !invent_is_taken(v, &roomy, TAKEN_BUILDING | TAKEN_LINE | TAKEN_DRIVE, -1) &&
           !invent_is_taken(v, &alone, TAKEN_THING, -1) && invent_is_clear(v, post, tall_m);
}

/* Which side of a way has its lamps, 1: the left; the power line is on the other. */
static double lamp_side(const Inventor *v, int way)
{
    const double *p = v->vertex[v->way_first[way]];
    return invent_unit(invent_hash(v, 13, p[0], p[1]), 0) < 0.5 ? 1 : -1;
}

static double half_width_m(const Inventor *v, int way) { return v->way_kind[way] == WAY_ROAD ? 3 : 2.2; }

/* ---- lamps and signs -------------------------------------------------------------------------------- */

static void add_lamps(Inventor *v, int way)
{
    static const double spacing_m = 35, lane_spacing_m = 45, beside_m = 0.9, near_m = 28, apart_m = 12;
    static const double tries_m[] = {0, 4, -4, 8, -8};
    const bool          road = v->way_kind[way] == WAY_ROAD;
    const double        length_m = invent_way_length(v, way), side = lamp_side(v, way);
    for (double at_m = 0.5 * spacing_m; at_m < length_m; at_m += road ? spacing_m : lane_spacing_m)
        for (int k = 0; k < 10; k++) {
            Rectangle    post;
            const double left_m = (k < 5 ? side : -side) * (half_width_m(v, way) + beside_m);
            if (!invent_way_place(&post, v, way, at_m + tries_m[k % 5], left_m)) continue;
            if (!invent_is_built_up(v, post.x_m, post.y_m, near_m)) break;
            post.half_m[0] = post.half_m[1] = 0.08;
            const double tall_m = road ? 7 : 5;
            if (!post_fits(v, &post, tall_m, apart_m)) continue;
            invent_point(v, CULTURE_LAMP, &post, tall_m, -1);
            break;
        }
}

static void add_sign(Inventor *v, int way, double at_m, double side)
{
    static const double tries_m[] = {0, 6, -6, 12, -12};
    for (int k = 0; k < 5; k++) {
        Rectangle at;
        if (!invent_way_place(&at, v, way, at_m + tries_m[k], side * (half_width_m(v, way) + 1.5))) continue;
        /* its plate is across the road */
        const Rectangle sign = {at.x_m, at.y_m, {-at.along[1], at.along[0]}, {0.5, 0.05}};
        if (!post_fits(v, &sign, 2.6, 0.5)) continue;
        invent_point(v, CULTURE_SIGN, &sign, 2.6, -1);
        return;
    }
}

/* Signs where a road comes to houses, and leaves them for good: on the right of who comes. */
static void add_signs(Inventor *v, int way)
{
    static const double step_m = 10, near_m = 38, before_m = 15, gap_m = 200, open_m = 60;
    const double        length_m = invent_way_length(v, way);
    double              first_m = -1, last_m = -1;
    for (double at_m = 0; at_m <= length_m + gap_m; at_m += step_m) {
        Rectangle  p;
        const bool on = at_m <= length_m && invent_way_place(&p, v, way, at_m, 0);
        if (on && invent_is_built_up(v, p.x_m, p.y_m, near_m)) {
            if (first_m < 0) first_m = at_m;
            last_m = at_m;
        } else if (first_m >= 0 && at_m - last_m >= gap_m) {
            if (first_m > open_m) add_sign(v, way, first_m - before_m, -1);
            if (last_m < length_m - open_m) add_sign(v, way, last_m + before_m, 1);
            first_m = -1;
        }
    }
}

/* ---- power lines ------------------------------------------------------------------------------------- */

static const double pole_m = 9, wires_m = 8.5;

static bool pole_at(Rectangle *out, const Inventor *v, int way, double at_m)
{
    static const double inside_m = 1.0, outside_m = 4.0, near_m = 45;
    Rectangle           middle;
    if (!invent_way_place(&middle, v, way, at_m, 0)) return false;
    const double beside_m = invent_is_built_up(v, middle.x_m, middle.y_m, near_m) ? inside_m : outside_m;
    invent_way_place(out, v, way, at_m, -lamp_side(v, way) * (half_width_m(v, way) + beside_m));
    out->half_m[0] = out->half_m[1] = 0.13;
    return landscape_surface(v->landscape, out->x_m, out->y_m) != SURFACE_TRACK && post_fits(v, out, pole_m, 2);
}

/* Whether wires may hang between two poles. */
static bool span_at(Rectangle *out, const Inventor *v, const Rectangle *a, const Rectangle *b)
{
    const double dx = b->x_m - a->x_m, dy = b->y_m - a->y_m, length_m = hypot(dx, dy);
    if (!(length_m > 1)) return false;
    *out = (Rectangle){a->x_m + 0.5 * dx, a->y_m + 0.5 * dy, {dx / length_m, dy / length_m}, {0.5 * length_m, 0.8}};
    const Rectangle roomy = rectangle_grown(out, 0.5);
    return length_m <= invent_longest_span_m && length_m >= invent_shortest_span_m &&
           !invent_is_taken(v, &roomy, TAKEN_BUILDING, -1) && invent_is_clear(v, out, pole_m);
}

/* A line over some places of poles, which the line itself has. */
static void add_wires(Inventor *v, const Rectangle *pole, const Rectangle *span, int poles)
{
    static const CultureLine wires = {.kind = CULTURE_POWER_LINE, .width_m = 1.4f, .height_m = (float)wires_m};
    double                   corner[invent_most_poles][2];
    if (poles < 3) return;
    for (int k = 0; k < poles; k++) {
        corner[k][0] = pole[k].x_m, corner[k][1] = pole[k].y_m;
        invent_take(v, &pole[k], TAKEN_THING, -1);
        if (k > 0) invent_take(v, &span[k], TAKEN_WIRES, -1);
    }
    invent_line(v, &wires, (const double(*)[2])corner, poles);
}

/* Poles along a whole way; where none may stand, or no wire hang, one line ends and the next begins. */
static void add_power_line(Inventor *v, int way)
{
    static const double span_m = 50, tries_m[] = {0, -2, 2, -4, 4, -6, 6, -8, 8}, first_m = 6, on_m = 20;
    const double        length_m = invent_way_length(v, way);
    Rectangle           pole[invent_most_poles], span[invent_most_poles];
    int                 poles = 0;
    double              at_m = first_m;
    while (at_m < length_m) {
        bool found = false;
        if (poles == 0) {
            if (pole_at(&pole[0], v, way, at_m)) poles = 1;
            else at_m += on_m;
            continue;
        }
        for (int k = 0; k < 9 && !found && poles < invent_most_poles; k++) {
            const double next_m = at_m + span_m + tries_m[k];
            if (!pole_at(&pole[poles], v, way, next_m) || !span_at(&span[poles], v, &pole[poles - 1], &pole[poles]))
                continue;
            found = true, at_m = next_m, poles++;
        }
        if (found) continue;
        add_wires(v, pole, span, poles);
        poles = 0, at_m += on_m;
    }
    add_wires(v, pole, span, poles);
}

/* The longest road that ends in a village, which is the one that was laid to join it with the next. */
static int longest_road(const Inventor *v, int village)
{
    static const double near_m = 250, shortest_m = 400;
    double              longest_m = shortest_m;
    int                 found = -1;
    for (int way = 0; way < v->way_count; way++) {
        const double *from = v->vertex[v->way_first[way]], *end = v->vertex[v->way_first[way + 1] - 1];
        const double *c = v->village[village];
        if (v->way_kind[way] != WAY_ROAD ||
            fmin(hypot(from[0] - c[0], from[1] - c[1]), hypot(end[0] - c[0], end[1] - c[1])) > near_m)
            continue;
        const double length_m = invent_way_length(v, way);
        if (length_m > longest_m) longest_m = length_m, found = way;
    }
    return found;
}

/* ---- churches ---------------------------------------------------------------------------------------- */

/* The vertices of roads and lanes about a place. */
static int vertices_near(double (*out)[2], int most, const Inventor *v, const double p_m[2], double near_m)
{
    int count = 0;
    for (int way = 0; way < v->way_count; way++)
        for (int n = v->way_first[way]; n < v->way_first[way + 1] && v->way_kind[way] <= WAY_LANE; n++)
            if (count < most && hypot(v->vertex[n][0] - p_m[0], v->vertex[n][1] - p_m[1]) < near_m)
                memcpy(out[count++], v->vertex[n], sizeof *out);
    return count;
}

static double nearest_m(const double (*vertex)[2], int count, double x_m, double y_m)
{
    double square = INFINITY;
    for (int n = 0; n < count; n++) {
        const double dx = vertex[n][0] - x_m, dy = vertex[n][1] - y_m;
        square = fmin(square, dx * dx + dy * dy);
    }
    return sqrt(square);
}

/* A nave with its tower at the west end, in a walled yard by a road near the middle of the village. */
static void add_church(Inventor *v, int village)
{
    enum { looks = 300, most_vertices = 1024 };
    static const double closest_m = 20, farthest_m = 260, yard_m = 6, to_road_m = 24, tower_top_m = 32;
    const uint64_t      h = invented_hash(v->seed, 14, village);
    const double        tower = 2.5 + 0.6 * invent_unit(h, 0), nave = 8 + 4 * invent_unit(h, 1),
                 wide = 4.2 + invent_unit(h, 2);
    const double turn = 0.5 * (invent_unit(h, 3) - 0.5);
    double       least = INFINITY;
    Rectangle    best = {0};
    double       road[most_vertices][2];
    const int    roads = vertices_near(road, most_vertices, v, v->village[village], farthest_m + 100);
    for (int k = 0; k < looks; k++) {
        const double    angle = 2 * pi_rad * invent_unit(h, 10 + 2 * k), u = invent_unit(h, 11 + 2 * k);
        const double    away_m = closest_m + (farthest_m - closest_m) * u;
        const Rectangle all = {v->village[village][0] + away_m * cos(angle),
                               v->village[village][1] + away_m * sin(angle),
                               {cos(turn), sin(turn)},
                               {nave + tower, wide}};
        const Rectangle yard = rectangle_grown(&all, yard_m);
        if (invent_is_taken(v, &yard, TAKEN_ALL, -1) || invent_slope(v, &all) > 0.8 * culture_steepest) continue;
        const double score =
            fabs(nearest_m((const double(*)[2])road, roads, all.x_m, all.y_m) - to_road_m) + 0.3 * away_m;
        const Rectangle parts[2] = {rectangle_within(&all, tower, 0, nave, wide),
                                    rectangle_within(&all, -nave, 0, tower, tower)};
        if (score >= least || invent_slope(v, &parts[0]) > culture_steepest ||
            invent_slope(v, &parts[1]) > culture_steepest || !invent_is_dry(v, &yard, 0) ||
            !invent_is_clear(v, &yard, tower_top_m))
            continue;
        least = score, best = all;
    }
    if (least == INFINITY) return;
    const int       owner = invent_owner_church + village;
    const Rectangle hall = rectangle_within(&best, tower, 0, nave, wide);
    const Rectangle west = rectangle_within(&best, -nave, 0, tower, tower), yard = rectangle_grown(&best, yard_m);
    Building        b = invent_roofed(&hall, ROOF_GABLED, 7.5, 50 * rad_per_deg, true);
    b.use = BUILDING_CHURCH, b.wall_fabric = invent_unit(h, 4) < 0.6 ? FABRIC_STONE : FABRIC_RENDER;
    b.roof_fabric = invent_unit(h, 5) < 0.5 ? FABRIC_SLATE : FABRIC_TILE;
    invent_building(v, &hall, &b, owner);
    Building t = invent_roofed(&west, ROOF_PYRAMIDAL, 17 + 5 * invent_unit(h, 6), 62 * rad_per_deg, true);
    t.use = BUILDING_CHURCH, t.wall_fabric = b.wall_fabric, t.roof_fabric = FABRIC_SLATE;
    invent_building(v, &west, &t, owner);
    Enclosure    e = {.owner = owner, .line = invent_border(CULTURE_WALL, 1.2), .gates = 1, .gate_half_m = {1.5}};
    const double out_m = yard.half_m[0];
    rectangle_at(e.gate_m[0], &yard, -out_m, 0);
    invent_take(v, &yard, TAKEN_SITE, owner);
    invent_enclose(&e, &yard);
    invent_enclosure(v, &e);
}

/* ---- all of it ---------------------------------------------------------------------------------------- */

void invent_churches(Inventor *v)
{
    static const int least_houses = 30;
    for (int n = 0; n < v->villages && v->status == STATUS_OK; n++)
        if (v->houses[n] >= least_houses) add_church(v, n);
}

void invent_streets(Inventor *v)
{
    for (int way = 0; way < v->way_count && v->status == STATUS_OK; way++) {
        const double *p = v->vertex[v->way_first[way]];
        const bool    lit = v->way_kind[way] == WAY_ROAD ||
                         (v->way_kind[way] == WAY_LANE && invent_unit(invent_hash(v, 15, p[0], p[1]), 0) < 0.6);
        if (v->way_kind[way] == WAY_ROAD) add_signs(v, way);
        if (lit) add_lamps(v, way);
    }
    for (int way = 0; way < v->way_count && v->status == STATUS_OK; way++)
        for (int n = 0; n < v->villages; n++)
            if (longest_road(v, n) == way) {
                add_power_line(v, way);
                break;
            }
}
