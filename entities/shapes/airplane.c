/* entities/shapes/airplane.c: aircraft other than fighters and helicopters, of one family of lines: airliners (two or
 * four engines under a low swept wing), cargo aircraft (high wing, propellers or jets), a bomber (eight engines in four
 * pods), a patrol aircraft (low wing, four propellers), a ground-attack aircraft (straight wing, two fins, engines on
 * the rear body), a light aircraft (braced high wing, propeller in front) and an unmanned aircraft (long straight wing,
 * propeller behind).
 *
 * Published length, span and height (manufacturers' airport-planning documents and type certificates, USAF and US Navy
 * fact sheets, Jane's All the World's Aircraft; the same in the open encyclopedias):
 *   Boeing 737-800 39.47 x 35.79 x 12.55 m; 747-400 70.66 x 64.44 x 19.41; C-130H 29.79 x 40.41 x 11.66; C-17A 53.04 x
 *   51.74 x 16.79; B-52H 48.5 x 56.4 x 12.4; P-3C 35.61 x 30.38 x 10.27; A-10A 16.26 x 17.53 x 4.47; Cessna 172 8.28 x
 *   11.00 x 2.72; MQ-1 8.22 x 14.8 x 2.1.
 * Body sections, chords, sweeps and where engines hang are read off three-view drawings to a few per cent: estimates.
 *
 * The base is the ground under the wheels. Where the gear folds (3072 position, as the fighter's) it is up at rest, so
 * the lowest point at rest is the belly or an engine. Propellers turn while the aircraft runs. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

#include <stdio.h>

typedef enum EnginePlace { UNDER_WING, PROPELLER_ON_WING, REAR_BODY, NOSE_PROPELLER, TAIL_PROPELLER } EnginePlace;

/* Shape and size; x from the middle of the length, heights above the ground. */
typedef struct Airplane {
    const char *name, *paint;
    double      length, span, height;
    double      half_width, body_low, body_high, nose, tail,
        tail_low;                                              /* tail: length of the upswept end, its lowest height */
    double droop;                                              /* height of the nose's tip, as a share of the body's */
    double wing_x, wing_h, root, tip, sweep, rise, wing_thick; /* leading edge at the middle; sweep, rise: of the tip */
    double plane_x, plane_h, plane_half, plane_root, plane_tip, plane_sweep, plane_rise;
    double fin_x, fin_low, fin_root, fin_tip, fin_sweep, fin_y; /* fin_y: 0 one in the middle; else two, so far out */
    EnginePlace engines;
    int         engine_count; /* a side, for those on wings and body */
    double      engine_y[4], engine_ahead, engine_h, engine_radius, engine_length;
    double      propeller_radius;
    int         blades;
    double      gear_y, gear_x, nose_x, wheel_radius;
    bool        gear_folds, airliner_windows, struts;
} Airplane;

/* clang-format off */
static const Airplane airplanes[] = {
    {.name = "airliner", .paint = "paint_white_missile", .length = 39.47, .span = 35.79, .height = 12.55, .half_width
     = 1.88, .body_low = 1.35, .body_high = 5.36, .nose = 6.0, .tail = 13, .tail_low = 3.9, .droop = 0.40, .wing_x =
     5.2, .wing_h = 2.05, .root = 8.2, .tip = 1.60, .sweep = 9.6, .rise = 2.0, .wing_thick = 0.11, .plane_x = -13.6,
     .plane_h = 4.75, .plane_half = 7.17, .plane_root = 4.6, .plane_tip = 1.5, .plane_sweep = 4.6, .plane_rise = 0.9,
     .fin_x = -10.9, .fin_low = 4.6, .fin_root = 7.0, .fin_tip = 2.0, .fin_sweep = 6.2, .engines = UNDER_WING,
     .engine_count = 1, .engine_y = {4.83}, .engine_ahead = 2.9, .engine_h = 1.55, .engine_radius = 1.03,
     .engine_length = 4.4, .gear_y = 2.86, .gear_x = -1.6, .nose_x = 14.4, .wheel_radius = 0.56, .gear_folds = true,
     .airliner_windows = true},
    {.name = "airliner_4", .paint = "paint_white_missile", .length = 70.66, .span = 64.44, .height = 19.41,
     .half_width = 3.25, .body_low = 2.1, .body_high = 9.0, .nose = 9.5, .tail = 23, .tail_low = 6.3, .droop = 0.42,
     .wing_x = 14.5, .wing_h = 3.9, .root = 15.0, .tip = 4.0, .sweep = 24.0, .rise = 4.2, .wing_thick = 0.11,
     .plane_x = -23.0, .plane_h = 7.6, .plane_half = 11.1, .plane_root = 9.0, .plane_tip = 2.6, .plane_sweep = 8.9,
     .plane_rise = 1.3, .fin_x = -18.6, .fin_low = 8.0, .fin_root = 11.5, .fin_tip = 4.2, .fin_sweep = 10.6, .engines
     = UNDER_WING, .engine_count = 2, .engine_y = {11.7, 20.8}, .engine_ahead = 4.2, .engine_h = 2.6, .engine_radius
     = 1.35, .engine_length = 6.3, .gear_y = 5.5, .gear_x = -1.5, .nose_x = 26.5, .wheel_radius = 0.62, .gear_folds =
     true, .airliner_windows = true},
    {.name = "cargo_plane", .paint = "paint_air_grey", .length = 29.79, .span = 40.41, .height = 11.66, .half_width =
     2.15, .body_low = 0.62, .body_high = 5.0, .nose = 4.2, .tail = 11.5, .tail_low = 3.7, .droop = 0.36, .wing_x =
     4.3, .wing_h = 4.85, .root = 4.88, .tip = 2.4, .sweep = 0.7, .rise = 0.8, .wing_thick = 0.16, .plane_x = -10.6,
     .plane_h = 5.0, .plane_half = 8.03, .plane_root = 4.1, .plane_tip = 1.9, .plane_sweep = 1.5, .plane_rise = 0,
     .fin_x = -8.1, .fin_low = 4.6, .fin_root = 6.3, .fin_tip = 2.7, .fin_sweep = 3.6, .engines = PROPELLER_ON_WING,
     .engine_count = 2, .engine_y = {4.95, 10.05}, .engine_ahead = 1.9, .engine_h = 4.6, .engine_radius = 0.62,
     .engine_length = 5.2, .propeller_radius = 2.06, .blades = 4, .gear_y = 2.18, .gear_x = -0.6, .nose_x = 9.2,
     .wheel_radius = 0.7, .gear_folds = true},
    {.name = "cargo_jet", .paint = "paint_air_grey", .length = 53.04, .span = 51.74, .height = 16.79, .half_width =
     3.43, .body_low = 0.9, .body_high = 7.6, .nose = 7.0, .tail = 19, .tail_low = 5.8, .droop = 0.36, .wing_x =
     10.2, .wing_h = 7.3, .root = 11.0, .tip = 2.4, .sweep = 13.5, .rise = -0.9, .wing_thick = 0.13, .plane_x =
     -19.5, .plane_h = 16.35, .plane_half = 9.92, .plane_root = 5.4, .plane_tip = 2.0, .plane_sweep = 5.0,
     .plane_rise = -0.3, .fin_x = -13.0, .fin_low = 6.9, .fin_root = 8.6, .fin_tip = 5.6, .fin_sweep = 6.3, .engines
     = UNDER_WING, .engine_count = 2, .engine_y = {7.9, 13.9}, .engine_ahead = 3.4, .engine_h = 5.1, .engine_radius =
     1.2, .engine_length = 5.4, .gear_y = 3.6, .gear_x = -1.5, .nose_x = 17.9, .wheel_radius = 0.62, .gear_folds =
     true},
    {.name = "bomber", .paint = "paint_air_grey", .length = 48.5, .span = 56.4, .height = 12.4, .half_width = 1.5,
     .body_low = 1.3, .body_high = 4.9, .nose = 5.0, .tail = 14, .tail_low = 3.2, .droop = 0.42, .wing_x = 11.5,
     .wing_h = 4.55, .root = 9.4, .tip = 3.8, .sweep = 20.5, .rise = -0.6, .wing_thick = 0.12, .plane_x = -15.85,
     .plane_h = 4.5, .plane_half = 7.92, .plane_root = 6.3, .plane_tip = 2.4, .plane_sweep = 6.0, .plane_rise = 0,
     .fin_x = -12.0, .fin_low = 4.4, .fin_root = 9.6, .fin_tip = 4.6, .fin_sweep = 6.4, .engines = UNDER_WING,
     .engine_count = 4, .engine_y = {9.65, 11.05, 17.65, 19.05}, .engine_ahead = 3.6, .engine_h = 2.75,
     .engine_radius = 0.62, .engine_length = 4.4, .gear_y = 1.25, .gear_x = -6.0, .nose_x = 8.6, .wheel_radius = 0.7,
     .gear_folds = true},
    {.name = "patrol_plane", .paint = "paint_air_grey", .length = 35.61, .span = 30.38, .height = 10.27, .half_width
     = 1.73, .body_low = 1.3, .body_high = 4.85, .nose = 5.2, .tail = 14, .tail_low = 3.6, .droop = 0.42, .wing_x =
     5.9, .wing_h = 1.95, .root = 5.8, .tip = 2.3, .sweep = 1.4, .rise = 1.5, .wing_thick = 0.13, .plane_x = -9.4,
     .plane_h = 4.3, .plane_half = 6.53, .plane_root = 3.6, .plane_tip = 1.5, .plane_sweep = 1.5, .plane_rise = 1.0,
     .fin_x = -7.2, .fin_low = 4.4, .fin_root = 6.1, .fin_tip = 2.3, .fin_sweep = 3.6, .engines = PROPELLER_ON_WING,
     .engine_count = 2, .engine_y = {4.85, 9.75}, .engine_ahead = 2.6, .engine_h = 2.7, .engine_radius = 0.6,
     .engine_length = 6.2, .propeller_radius = 2.06, .blades = 4, .gear_y = 4.75, .gear_x = 0.3, .nose_x = 9.4,
     .wheel_radius = 0.6, .gear_folds = true},
    {.name = "attack_plane", .paint = "paint_air_grey", .length = 16.26, .span = 17.53, .height = 4.47, .half_width =
     0.62, .body_low = 0.95, .body_high = 2.75, .nose = 2.6, .tail = 4.5, .tail_low = 1.75, .droop = 0.32, .wing_x =
     2.2, .wing_h = 1.35, .root = 3.04, .tip = 1.98, .sweep = 0.35, .rise = 0.55, .wing_thick = 0.14, .plane_x =
     -5.8, .plane_h = 2.15, .plane_half = 2.87, .plane_root = 1.95, .plane_tip = 1.8, .plane_sweep = 0, .plane_rise =
     0, .fin_x = -5.3, .fin_low = 1.75, .fin_root = 2.6, .fin_tip = 1.75, .fin_sweep = 0.85, .fin_y = 2.87, .engines
     = REAR_BODY, .engine_count = 1, .engine_y = {1.25}, .engine_h = 3.05, .engine_ahead = -1.6, .engine_radius =
     0.72, .engine_length = 2.9, .gear_y = 2.62, .gear_x = -0.2, .nose_x = 5.1, .wheel_radius = 0.45, .gear_folds =
     true},
    {.name = "light_plane", .paint = "paint_white_missile", .length = 8.28, .span = 11.00, .height = 2.72,
     .half_width = 0.56, .body_low = 0.62, .body_high = 2.05, .nose = 2.4, .tail = 4.6, .tail_low = 1.15, .droop =
     0.40, .wing_x = 1.55, .wing_h = 2.1, .root = 1.63, .tip = 1.13, .sweep = 0.12, .rise = 0.16, .wing_thick = 0.12,
     .plane_x = -2.85, .plane_h = 1.35, .plane_half = 1.72, .plane_root = 1.2, .plane_tip = 0.85, .plane_sweep = 0.3,
     .plane_rise = 0, .fin_x = -2.35, .fin_low = 1.3, .fin_root = 1.55, .fin_tip = 0.7, .fin_sweep = 1.05, .engines =
     NOSE_PROPELLER, .engine_h = 1.28, .propeller_radius = 0.95, .blades = 2, .gear_y = 1.27, .gear_x = 0.35, .nose_x
     = 2.35, .wheel_radius = 0.22, .struts = true},
    {.name = "uav", .paint = "paint_grey", .length = 8.22, .span = 14.80, .height = 2.10, .half_width = 0.43,
     .body_low = 0.95, .body_high = 1.72, .nose = 1.4, .tail = 1.2, .tail_low = 1.15, .droop = 0.40, .wing_x = 0.75,
     .wing_h = 1.3, .root = 1.15, .tip = 0.55, .sweep = 0.3, .rise = 0.32, .wing_thick = 0.12, .plane_x = -2.2,
     .plane_h = 1.3, .plane_half = 2.1, .plane_root = 0.95, .plane_tip = 0.6, .plane_sweep = 0.25, .plane_rise =
     -0.85, .engines = TAIL_PROPELLER, .engine_h = 1.38, .propeller_radius = 0.85, .blades = 2, .gear_y = 0.85,
     .gear_x = -0.55, .nose_x = 2.6, .wheel_radius = 0.20},
};
/* clang-format on */

static void build_body(MeshBuilder *b, const Airplane *a)
{
    const double half = 0.5 * a->length, tall = a->body_high - a->body_low, middle = 0.5 * (a->body_low + a->body_high);
    const double tip_h = a->body_low + a->droop * tall, x0 = -half, x1 = half - a->nose;
    const bool   pusher = a->engines == TAIL_PROPELLER, front = a->engines == NOSE_PROPELLER;
    /* the propeller makes the last bit of the length */
    const double tail_x = pusher ? x0 + 0.10 * a->propeller_radius : x0,
                 nose_x = front ? half - 0.22 * a->propeller_radius : half;
    const double end = pusher ? 0.5 : 0.16, top = a->body_high;
    const double tail_top = pusher ? a->engine_h + 0.22 : fmin(a->tail_low + 0.32 * tall, top);
    const double tail_low = pusher ? a->engine_h - 0.22 : a->tail_low;
    Station      s[8] = {
             {tail_x, end * a->half_width, -tail_top, -tail_low, 1},
             {x0 + 0.5 * a->tail, 0.68 * a->half_width, -(0.5 * (tail_top + top) + 0.06 * tall),
              -(0.45 * a->tail_low + 0.55 * a->body_low), 1},
             {x0 + a->tail, a->half_width, -top, -a->body_low, 1},
             {x1 - 0.3 * (x1 - x0 - a->tail), a->half_width, -top, -a->body_low, 1},
             {x1, 0.985 * a->half_width, -(top - 0.01 * tall), -(a->body_low + 0.01 * tall), 1},
             {half - 0.45 * a->nose, 0.82 * a->half_width, -(middle + 0.36 * tall), -(a->body_low + 0.07 * tall), 1},
             {half - 0.12 * a->nose, 0.42 * a->half_width, -(tip_h + 0.24 * tall), -(tip_h - 0.21 * tall), 1},
             {nose_x, 0.06 * a->half_width, -(tip_h + 0.03 * tall), -(tip_h - 0.03 * tall), 1},
    };
    if (front) { /* cowling, cabin, slim tail boom: the roof falls away behind the wing */
        const double  w = a->half_width, c = a->engine_h;
        const Station plane[8] = {
            {x0, 0.08 * w, -1.45, -1.25, 1},         {x0 + 1.5, 0.32 * w, -1.58, -1.02, 0.9},
            {x0 + 3.6, 0.85 * w, -1.95, -0.72, 0.6}, {x0 + 4.4, w, -2.08, -0.64, 0.45},
            {1.35, w, -2.08, -0.64, 0.45},           {2.05, w, -1.62, -0.66, 0.5},
            {3.3, 0.8 * w, -1.52, -0.78, 0.6},       {nose_x, 0.5 * w, -(c + 0.16), -(c - 0.28), 0.8}};
        memcpy(s, plane, sizeof s);
    }
    if (pusher) { /* a bulged head for the dish */
        s[5] = (Station){half - 0.55 * a->nose, a->half_width, -1.80, -0.95, 1};
        s[6] = (Station){half - 0.15 * a->nose, 0.68 * a->half_width, -1.66, -1.02, 1};
        s[7] = (Station){half, 0.10 * a->half_width, -1.35, -1.24, 1};
        s[3] = (Station){1.2, 0.75 * a->half_width, -1.55, -1.0, 1};
        s[4] = (Station){half - 1.25 * a->nose, 0.85 * a->half_width, -1.65, -0.98, 1};
    }
    mesh_part(b, 0, "fuselage", a->paint, HEAT_AIRFRAME);
    mesh_loft(b, place_at(0, 0, 0), s, 8);
    if (!pusher) {
        mesh_part(b, 0, "windows", "glass_window", HEAT_AIRFRAME);
        if (front) {
            const double pane[4][2] = {{1.36, 2.0}, {1.95, 1.66}, {1.98, 1.70}, {1.39, 2.04}};
            parts_profile(b, 4, pane, -0.45, 0.45);
            for (int side = -1; side <= 1; side += 2)
                parts_box(b, 0.1, 1.3, side < 0 ? -0.575 : 0.54, side < 0 ? -0.54 : 0.575, 1.5, 1.95);
        } else {
            /* the flight deck's panes: a band just outside the lines of the nose */
            const double  x = half - 0.36 * a->nose;
            Station       at = mesh_station_at(s, 8, x), before = mesh_station_at(s, 8, half - 0.20 * a->nose);
            const Station band[2] = {{x, 0.80 * at.half_width, at.top - 0.012 * tall, at.top + 0.30 * tall, 0.8},
                                     {half - 0.20 * a->nose, 0.80 * before.half_width, before.top - 0.012 * tall,
                                      before.top + 0.18 * tall, 0.8}};
            mesh_loft(b, place_at(0, 0, 0), band, 2);
            if (a->airliner_windows)
                for (int side = -1; side <= 1; side += 2) {
                    const double w = a->half_width, h = middle + 0.02 * tall;
                    parts_box(b, x0 + a->tail, x1, side < 0 ? -w - 0.01 : 0.98 * w, side < 0 ? -0.98 * w : w + 0.01, h,
                              h + 0.075 * tall);
                }
        }
    }
}

static double wing_lead(const Airplane *a, double y) { return a->wing_x - a->sweep * y / (0.5 * a->span); }
static double wing_height(const Airplane *a, double y) { return a->wing_h + a->rise * y / (0.5 * a->span); }
static double wing_chord(const Airplane *a, double y) { return a->root + (a->tip - a->root) * y / (0.5 * a->span); }

static void build_surfaces(MeshBuilder *b, const Airplane *a)
{
    const double half = 0.5 * a->span;
    mesh_part(b, 0, "wings", a->paint, HEAT_AIRFRAME);
    for (int side = -1; side <= 1; side += 2) {
        parts_wing(b, parts_side(side), wing_lead(a, 0), wing_lead(a, 0) - a->root, 0.02, -a->wing_h,
                   wing_lead(a, half), wing_lead(a, half) - a->tip, half, -(a->wing_h + a->rise), a->wing_thick);
        if (a->struts) parts_bar(b, 0.75, side * 0.5, 0.8, 0.85, side * 2.75, wing_height(a, 2.75) - 0.05, 0.04);
    }
    mesh_part(b, 0, "tailplane", a->paint, HEAT_AIRFRAME);
    for (int side = -1; side <= 1; side += 2)
        parts_wing(b, parts_side(side), a->plane_x, a->plane_x - a->plane_root, 0.02, -a->plane_h,
                   a->plane_x - a->plane_sweep, a->plane_x - a->plane_sweep - a->plane_tip, a->plane_half,
                   -(a->plane_h + a->plane_rise), 0.09);
    if (a->fin_root > 0) {
        mesh_part(b, 0, "fin", a->paint, HEAT_AIRFRAME);
        for (int side = -1; side <= 1; side += 2)
            if (a->fin_y > 0 || side > 0)
                parts_fin(b, side * a->fin_y, a->fin_x, a->fin_x - a->fin_root, a->fin_low, a->fin_x - a->fin_sweep,
                          a->fin_x - a->fin_sweep - a->fin_tip, a->height, 0.09);
    } else { /* the tail is an inverted V; the antenna and the air scoop on the back make the height */
        mesh_part(b, 0, "scoop", a->paint, HEAT_AIRFRAME);
        const Station scoop[3] = {
            {-3.4, 0.16, -1.75, -1.4, 0.9}, {-2.6, 0.2, -1.86, -1.4, 0.9}, {-1.9, 0.12, -1.62, -1.4, 0.9}};
        mesh_loft(b, place_at(0, 0, 0), scoop, 3);
        parts_fin(b, 0, -2.3, -2.75, 1.6, -2.6, -2.85, a->height, 0.10);
    }
}

static void build_engines(MeshBuilder *b, const Airplane *a)
{
    const double r = a->engine_radius, l = a->engine_length;
    if (a->engines == NOSE_PROPELLER || a->engines == TAIL_PROPELLER) {
        const double x = a->engines == NOSE_PROPELLER ? 3.2 : -0.5 * a->length + 0.45;
        mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
        const double low = a->engines == NOSE_PROPELLER ? 0.75 : 0.45; /* below the cowling */
        parts_bar(b, x - 0.35, 0.2, a->engine_h - low, x - 0.15, 0.2, a->engine_h - 0.15, 0.04);
        return;
    }
    mesh_part(b, 0, "nacelles", a->paint, HEAT_AIRFRAME);
    for (int side = -1; side <= 1; side += 2)
        for (int e = 0; e < a->engine_count; e++) {
            const double y = a->engine_y[e],
                         lead = a->engines == REAR_BODY ? a->engine_ahead : wing_lead(a, y) + a->engine_ahead;
            const double h =
                a->engine_h + (a->engines == UNDER_WING ? a->rise * (y - a->engine_y[0]) / (0.5 * a->span) : 0);
            if (a->engines == PROPELLER_ON_WING) {
                const double  x1 = lead, tall = 1.3 * r;
                const Station s[4] = {{x1 - l, 0.3 * r, -(h + 0.4 * r), -(h + 0.1 * r), 1},
                                      {x1 - 0.6 * l, r, -(h + tall), -(h - tall), 1},
                                      {x1 - 0.3 * l, r, -(h + tall), -(h - tall), 1},
                                      {x1, 0.75 * r, -(h + 0.75 * r), -(h - 0.75 * r), 1}};
                mesh_loft(b, place_at(0, side * y, 0), s, 4);
            } else {
                const double x1 = lead, x0 = x1 - l; /* open in front: the fan's face lies inside the lip */
                mesh_profile_begin(b, x0, 0);
                mesh_profile_line(b, x0, 0.55 * r);
                mesh_profile_line(b, x0 + 0.45 * l, 0.96 * r);
                mesh_profile_line(b, x1 - 0.12 * l, r);
                mesh_profile_line(b, x1, 0.88 * r);
                mesh_profile_line(b, x1, 0.78 * r);
                mesh_profile_line(b, x1 - 0.12 * l, 0.76 * r);
                mesh_profile_line(b, x1 - 0.12 * l, 0);
                mesh_lathe(b, place_at(0, side * y, -h));
                if (a->engines == UNDER_WING) { /* pylon, up to the wing's middle */
                    const double w = wing_height(a, y), c = wing_chord(a, y), front = wing_lead(a, y);
                    const double pylon[4][2] = {{x1 - 0.35 * l, h + 0.9 * r},
                                                {front - 0.1 * c, w},
                                                {front - 0.55 * c, w},
                                                {fmin(x0 + 0.15 * l, front - 0.3 * c), h + 0.4 * r}};
                    parts_profile(b, 4, pylon, side * y - 0.09 * r, side * y + 0.09 * r);
                } else {
                    parts_box(b, x0 + 0.25 * l, x1 - 0.3 * l, side < 0 ? -y : 0.1, side < 0 ? -0.1 : y, h - 0.55 * r,
                              h - 0.25 * r);
                }
            }
        }
    mesh_part(b, 0, "exhaust", "nozzle_steel", HEAT_TURBINE);
    for (int side = -1; side <= 1; side += 2)
        for (int e = 0; e < a->engine_count; e++) {
            const double y = a->engine_y[e],
                         lead = a->engines == REAR_BODY ? a->engine_ahead : wing_lead(a, y) + a->engine_ahead;
            const double h =
                a->engine_h + (a->engines == UNDER_WING ? a->rise * (y - a->engine_y[0]) / (0.5 * a->span) : 0);
            if (a->engines == PROPELLER_ON_WING) /* a pipe out of the nacelle's lower side */
                mesh_cylinder(b, place_axis(lead - 0.55 * l, side * y, -(h - 1.15 * r), -1, 0, 0.15), 0, 0.9 * r,
                              0.3 * r);
            else mesh_cone(b, place_at(lead - l, side * y, -h), -0.16 * l, 0.12 * r, 0.05 * l, 0.44 * r);
        }
    if (a->engines == PROPELLER_ON_WING) {
        int number = 1;
        for (int side = -1; side <= 1; side += 2)
            for (int e = 0; e < a->engine_count; e++) {
                char name[24];
                snprintf(name, sizeof name, "propeller_%d", number++);
                parts_propeller(b, name, wing_lead(a, a->engine_y[e]) + a->engine_ahead, side * a->engine_y[e],
                                a->engine_h, a->propeller_radius, a->blades, 1020);
            }
    }
}

/* One leg and its wheel; folded, they lie inside the body or the wing's root. */
static void build_leg(MeshBuilder *b, const Airplane *a, const char *name, double x, double y, double top_h)
{
    const double r = a->wheel_radius;
    const double drop = a->gear_folds ? a->body_low + 0.15 * (a->body_high - a->body_low) : 0;
    const double stowed_y = a->gear_folds ? copysign(fmin(fabs(y), 0.3 * a->half_width), y) : y;
    const int    node = mesh_node(b, name, 0, x, stowed_y, -drop);
    if (a->gear_folds) { /* slides out and down, in a straight line */
        ModelNode   *n = mesh_node_get(b, node);
        const double way_m = hypot(drop, y - stowed_y);
        n->joint = JOINT_TRANSLATION;
        n->axis[0] = 0, n->axis[1] = (y - stowed_y) / way_m, n->axis[2] = drop / way_m;
        n->low = 0, n->high = way_m;
        n->dis_class = 3072, n->dis_metric = 1;
        n->dis_scale = n->value_slow = way_m;
    }
    const double foot = -r; /* of the axle, in the node's axes */
    const Place  outwards = place_axis(0, 0, foot, 0, y < 0 ? -1 : 1, 0);
    mesh_part(b, node, "gear", "metal_dark", HEAT_PASSIVE);
    mesh_bar(b, (double[3]){0, 0, foot},
             (double[3]){0,
                         (y < 0   ? 1
                          : y > 0 ? -1
                                  : 0) *
                             (a->gear_folds ? 0 : 0.6 * fabs(y)),
                         -top_h},
             0.18 * r);
    mesh_part(b, node, "tyre", "rubber_black", HEAT_PASSIVE);
    mesh_cylinder(b, outwards, -0.3 * r, 0.3 * r, r);
}

Status parametric_airplane(Model *out, const char *name, double sag_m)
{
    const Airplane *a = airplanes;
    while (strcmp(a->name, name) != 0) a++;
    MeshBuilder *b = mesh_builder_create(name, sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "fuselage", -1, 0, 0, 0);
    build_body(b, a);
    build_surfaces(b, a);
    build_engines(b, a);
    if (a->engines == NOSE_PROPELLER)
        parts_propeller(b, "propeller", 0.5 * a->length - 0.22 * a->propeller_radius, 0, a->engine_h,
                        a->propeller_radius, a->blades, 2400);
    if (a->engines == TAIL_PROPELLER)
        parts_propeller(b, "propeller", -0.5 * a->length + 0.10 * a->propeller_radius, 0, a->engine_h,
                        a->propeller_radius, a->blades, 2400);
    const double leg_m = a->gear_folds ? 2.2 * a->wheel_radius : a->body_low + 0.05;
    build_leg(b, a, "gear_left", a->gear_x, -a->gear_y, leg_m);
    build_leg(b, a, "gear_right", a->gear_x, a->gear_y, leg_m);
    build_leg(b, a, "gear_nose", a->nose_x, 0, a->gear_folds ? leg_m : a->body_low + 0.12);
    return mesh_builder_finish(out, b);
}
