/* entities/exercise/hide.c: a place to hide: candidates about a place, by what stands around them and how much it
 * hides. */
#include "entities/exercise/hide.h"

enum { candidates = 30000, kept_most = 400, judged_most = 60 };

static double drawn(const HideWish *wish, int candidate, uint64_t which)
{
    return random_uniform(wish->seed, 11, (uint32_t)wish->number, 8 * (uint64_t)candidate + which);
}

/* ---- what stands around a place ---------------------------------------------------------------------------- */

/* Standing plants about a place, of which only what a kind of hide asks for is counted. */
typedef struct Around {
    bool   clear;           /* none has to make room for the footprint */
    int    trees;           /* with a trunk and 5 m high, within 20 m */
    int    trees_of[8];     /* of these, in each eighth of the circle */
    int    rows;            /* bushes and hedges within 9 m */
    double nearest_crown_m; /* from the place to the nearest crown's edge */
} Around;

static Around around(const HideGround *ground, const double p_enu[3], const WoodsPath *footprint)
{
    static const double reach_m = 20, row_m = 9, tree_m = 5, room_m = 0.5; /* that of plants: woods_square.c */
    const Woods        *w = &ground->woods;
    const double        x = p_enu[0] - w->origin_enu[0], y = p_enu[1] - w->origin_enu[1];
    Around              a = {.clear = true, .nearest_crown_m = INFINITY};
    const int           from_i = (int)clamp(floor((x - reach_m) / woods_square_m), 0, w->nx - 1),
              to_i = (int)clamp(floor((x + reach_m) / woods_square_m), 0, w->nx - 1),
              from_j = (int)clamp(floor((y - reach_m) / woods_square_m), 0, w->ny - 1),
              to_j = (int)clamp(floor((y + reach_m) / woods_square_m), 0, w->ny - 1);
    for (int j = from_j; j <= to_j; j++)
        for (int i = from_i; i <= to_i; i++)
            for (uint32_t n = w->first[j * w->nx + i]; n < w->first[j * w->nx + i + 1]; n++) {
                const Plant *p = &w->plant[n];
                const double dx = (double)p->p_m[0] - x, dy = (double)p->p_m[1] - y, d_m = hypot(dx, dy);
                const double crown_m = plant_height_m(p) * plant_crown_share((PlantKind)p->kind) * p->width / 128.0;
                a.nearest_crown_m = fmin(a.nearest_crown_m, d_m - crown_m);
                if (woods_path_away_m(footprint, x + dx + w->origin_enu[0], y + dy + w->origin_enu[1]) <
                    footprint->half_m + room_m)
                    a.clear = false;
                if (plant_is_tree((PlantKind)p->kind) && plant_height_m(p) >= tree_m && d_m < reach_m) {
                    a.trees++;
                    a.trees_of[(int)floor((atan2(dy, dx) + pi_rad) * 4 / pi_rad) & 7]++;
                }
                a.rows += !plant_is_tree((PlantKind)p->kind) && d_m < row_m;
            }
    return a;
}

/* Whether trees stand on one side, of half a circle, and hardly any on the other. */
static bool is_edge(const Around *a)
{
    for (int first = 0; first < 8; first++) {
        int here = 0;
        for (int k = 0; k < 4; k++) here += a->trees_of[(first + k) & 7];
        if (here >= 5 && a->trees - here <= 1) return true;
    }
    return false;
}

static bool is_within_wood(const Around *a)
{
    int empty = 0;
    for (int k = 0; k < 8; k++) empty += a->trees_of[k] == 0;
    return a->trees >= 12 && empty <= 1;
}

/* Lower than the mean of the ground on a circle by 0.4 m. */
static bool is_hollow(const Landscape *landscape, const double p_enu[3])
{
    static const double circle_m = 30, deep_m = 0.4;
    double              sum = 0;
    for (int k = 0; k < 8; k++)
        sum += elevation_height(&landscape->elevation, p_enu[0] + circle_m * cos(k * pi_rad / 4),
                                p_enu[1] + circle_m * sin(k * pi_rad / 4), NULL);
    return p_enu[2] < sum / 8 - deep_m;
}

static bool is_of_kind(enum ScenarioHide kind, const HideGround *ground, const double p_enu[3],
                       const WoodsPath *footprint)
{
    static const double open_m = 12;
    const Around        a = around(ground, p_enu, footprint);
    if (!a.clear) return false;
    switch (kind) {
    case SCENARIO_HIDE_OPEN:
        return a.nearest_crown_m > open_m;
    case SCENARIO_HIDE_TREE_LINE:
        return is_edge(&a);
    case SCENARIO_HIDE_WOOD:
        return is_within_wood(&a);
    case SCENARIO_HIDE_HEDGE:
        return a.rows >= 4 && a.trees <= 4;
    case SCENARIO_HIDE_HOLLOW: /* asked later, of a height that is known */
    case SCENARIO_HIDE_BESIDE:
    case SCENARIO_HIDE_BUILDING: /* drawn beside one */
    case SCENARIO_HIDE_WALL:
    case SCENARIO_HIDE_NONE:
        break;
    }
    return true;
}

/* ---- whether a vehicle can stand there ------------------------------------------------------------------------ */

static bool bears(const Landscape *landscape, HidePose *pose, const Model *model)
{
    static const double steepest = 0.2;
    double              x[5], y[5], z[5], low = INFINITY, high = -INFINITY;
    uint8_t             surface[5];
    WayPlace            way;
    for (int k = 0; k < 5; k++) { /* the middle, and the corners */
        const double along = k == 0 ? 0 : k % 2 ? model->box_high[0] : model->box_low[0];
        const double right = k == 0 ? 0 : (k < 3 ? -0.5 : 0.5) * model->width_m;
        x[k] = pose->p_enu[0] + along * pose->nose[0] + right * pose->nose[1];
        y[k] = pose->p_enu[1] + along * pose->nose[1] - right * pose->nose[0];
        z[k] = elevation_height(&landscape->elevation, x[k], y[k], NULL);
        if (!isfinite(z[k])) return false;
        low = fmin(low, z[k]), high = fmax(high, z[k]);
    }
    pose->p_enu[2] = z[0];
    if (high - low > steepest * hypot(model->length_m, model->width_m)) return false;
    if (landscape_way(&way, landscape, x[0], y[0]) && fabs(way.across_m) < way.half_m + 0.5 * model->width_m)
        return false; /* on the road, in the stream */
    landscape_surfaces(surface, landscape, 5, x, y);
    for (int k = 0; k < 5; k++)
        if (surface[k] == SURFACE_NONE || surface[k] == SURFACE_WATER || surface[k] == SURFACE_ROAD) return false;
    return true;
}

/* Whether something that is built is in a vehicle's footprint and the room about it, of which a node that shows the
 * vehicle would take it away (terrain/culture/culture_give_way.h). */
static bool meets_built(const Culture *culture, const WoodsPath *footprint)
{
    static const double step_m = 0.5, more_m = 0.3; /* more: half a step, and what reports are off */
    const double        dx = footprint->b_m[0] - footprint->a_m[0], dy = footprint->b_m[1] - footprint->a_m[1];
    const int           steps = (int)ceil(hypot(dx, dy) / step_m);
    for (int k = 0; culture && k <= steps; k++) {
        const double t = steps ? (double)k / steps : 0;
        if (culture_is_in_way(culture, footprint->a_m[0] + t * dx, footprint->a_m[1] + t * dy,
                              footprint->half_m + more_m))
            return true;
    }
    return false;
}

/* A piece of an outline or wall near the place, by chance, and a place beyond it as the observer sees it. */
static bool place_behind(double p_m[2], const HideWish *wish, const HideGround *ground, const HideSight *sight,
                         int candidate)
{
    enum { looks = 400 };
    const Culture *c = ground->culture;
    const bool     wall = wish->kind == SCENARIO_HIDE_WALL;
    const int      records = !c ? 0 : wall ? c->lines : c->buildings;
    const double   level = fmax(hypot(sight->d_enu[0], sight->d_enu[1]), 1e-9);
    for (int look = 0; look < looks && records > 0; look++) {
        const double at =
            random_uniform(wish->seed, 13, (uint32_t)wish->number, (uint64_t)candidate * looks + (uint64_t)look);
        const int n = (int)fmin(at * records, records - 1);
        if (wall && c->line[n].kind != CULTURE_WALL) continue;
        const int first = wall ? c->line[n].first_corner : c->building[n].first_corner;
        const int corners = wall ? c->line[n].corners : c->building[n].corners;
        if (hypot(c->corner_m[first][0] - wish->about_m[0], c->corner_m[first][1] - wish->about_m[1]) > wish->within_m)
            continue;
        const int     k = (int)fmin(drawn(wish, candidate, 0) * (corners - wall), corners - wall - 1);
        const double *a = c->corner_m[first + k], *b = c->corner_m[first + (k + 1) % corners];
        const double  long_m = hypot(b[0] - a[0], b[1] - a[1]);
        if (!(long_m > 0)) return false;
        double out[2] = {(b[1] - a[1]) / long_m, (a[0] - b[0]) / long_m}; /* of outlines; walls have two sides */
        double away = -(out[0] * sight->d_enu[0] + out[1] * sight->d_enu[1]) / level;
        if (wall && away < 0) out[0] = -out[0], out[1] = -out[1], away = -away;
        if (away < 0.1) return false; /* on the side that the observer sees */
        const double share = 1.2 * drawn(wish, candidate, 1) - 0.1, half_m = 0.5 * wish->shape.model->width_m;
        const double off_m = half_m + 0.6 + (wall ? 4 : 9) * drawn(wish, candidate, 3);
        for (int i = 0; i < 2; i++) p_m[i] = a[i] + share * (b[i] - a[i]) + off_m * out[i];
        return true;
    }
    return false;
}

/* Beyond the box as the observer sees it, a metre or more off, and to a side so that some of it shows. */
static void place_beside(double p_m[2], const HideWish *wish, const HideSight *sight, int candidate)
{
    const HideBox *b = wish->beside;
    const double   level = fmax(hypot(sight->d_enu[0], sight->d_enu[1]), 1e-9);
    const double   away[2] = {-sight->d_enu[0] / level, -sight->d_enu[1] / level};
    double         deep_m = 0, wide_m = 0, middle[2];
    const double  *low = b->shape.model->box_low, *high = b->shape.model->box_high;
    for (int k = 0; k < 2; k++)
        middle[k] = b->p_enu[k] + 0.5 * (low[0] + high[0]) * b->nose[k] +
                    0.5 * (low[1] + high[1]) * (k ? -b->nose[0] : b->nose[1]);
    const double half[2] = {0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])};
    const double c = fabs(b->nose[0] * away[0] + b->nose[1] * away[1]), s = sqrt(fmax(1 - c * c, 0));
    deep_m = half[0] * c + half[1] * s, wide_m = half[0] * s + half[1] * c;
    const double reach_m = 0.5 * hypot(wish->shape.model->length_m, wish->shape.model->width_m);
    const double off_m = deep_m + 0.5 * wish->shape.model->width_m + 1 + 6 * drawn(wish, candidate, 0);
    const double side_m = (wide_m + reach_m) * (2 * drawn(wish, candidate, 1) - 1);
    p_m[0] = middle[0] + off_m * away[0] - side_m * away[1];
    p_m[1] = middle[1] + off_m * away[1] + side_m * away[0];
}

static bool meets_box(const HideBox *box, const HidePose *pose, const Model *model)
{
    /* corners of each in the axes of the other, with half a metre */
    static const double room_m = 0.5;
    for (int k = 0; k < 9; k++) {
        const double  along = model->box_low[0] + 0.5 * (k % 3) * (model->box_high[0] - model->box_low[0]);
        const double  right = 0.5 * (k / 3 - 1) * model->width_m;
        const double  x = pose->p_enu[0] + along * pose->nose[0] + right * pose->nose[1] - box->p_enu[0];
        const double  y = pose->p_enu[1] + along * pose->nose[1] - right * pose->nose[0] - box->p_enu[1];
        const double  f = x * box->nose[0] + y * box->nose[1], r = x * box->nose[1] - y * box->nose[0];
        const double *low = box->shape.model->box_low, *high = box->shape.model->box_high;
        if (f > low[0] - room_m && f < high[0] + room_m && r > low[1] - room_m && r < high[1] + room_m) return true;
    }
    return false;
}

static bool draw_pose(HidePose *pose, double *heading_rad, const HideWish *wish, const HideGround *ground,
                      const HideSight *sight, int candidate)
{
    double p_m[2];
    if (wish->kind == SCENARIO_HIDE_BESIDE) {
        place_beside(p_m, wish, sight, candidate);
    } else if (wish->kind == SCENARIO_HIDE_BUILDING || wish->kind == SCENARIO_HIDE_WALL) {
        if (!place_behind(p_m, wish, ground, sight, candidate)) return false;
    } else { /* evenly over the circle */
        const double r_m = wish->within_m * sqrt(drawn(wish, candidate, 0));
        const double a_rad = 2 * pi_rad * drawn(wish, candidate, 1);
        p_m[0] = wish->about_m[0] + r_m * cos(a_rad), p_m[1] = wish->about_m[1] + r_m * sin(a_rad);
    }
    *heading_rad = isnan(wish->heading_rad) ? 2 * pi_rad * drawn(wish, candidate, 2) : wish->heading_rad;
    *pose = (HidePose){{p_m[0], p_m[1], 0}, {sin(*heading_rad), cos(*heading_rad)}};
    for (int n = 0; n < wish->taken_count; n++)
        if (hypot(p_m[0] - wish->taken[n][0], p_m[1] - wish->taken[n][1]) < hide_apart_m) return false;
    return true;
}

/* ---- the search -------------------------------------------------------------------------------------------------- */

static bool points_of(HidePoints *points, const HidePose *pose, const HideWish *wish, const HideSight *sight)
{
    const double d_body[3] = {sight->d_enu[0] * pose->nose[0] + sight->d_enu[1] * pose->nose[1],
                              sight->d_enu[0] * pose->nose[1] - sight->d_enu[1] * pose->nose[0], -sight->d_enu[2]};
    return hide_points(points, &wish->shape, d_body) == STATUS_OK;
}

/* Inserts one into the list of those nearest to what is planned; of equal ones the earlier is first. */
static void keep(HideFound *list, int *count, const HideFound *found, double planned)
{
    const double off = fabs(found->occlusion - planned);
    int          at = *count;
    while (at > 0 && fabs(list[at - 1].occlusion - planned) > off) at--;
    if (at >= judged_most) return;
    const int last = *count < judged_most ? (*count)++ : judged_most - 1;
    memmove(list + at + 1, list + at, (size_t)(last - at) * sizeof *list);
    list[at] = *found;
}

/* The one of the list that the judge finds nearest; where there is no judge, the first. */
static void judge_list(HideFound *out, const HideFound *list, int count, const HideGround *ground, const HideWish *wish,
                       const HideSight *sight)
{
    static const double enough = 0.02;
    HidePoints          points;
    double              least = INFINITY;
    *out = list[0];
    for (int n = 0; n < count && least > enough; n++) {
        HideFound judged = list[n];
        if (!points_of(&points, &judged.pose, wish, sight) ||
            !hide_judged(&judged.occlusion, ground, &judged.pose, &points, sight, wish->beside))
            return;
        if (fabs(judged.occlusion - wish->occlusion) >= least) continue;
        least = fabs(judged.occlusion - wish->occlusion);
        *out = judged;
    }
}

bool hide_find(HideFound *out, const HideGround *ground, const HideWish *wish, const HideSight *sight)
{
    HideFound  list[judged_most + 1];
    HidePoints points;
    int        fit = 0, count = 0, most_left_out = 0;
    for (int n = 0; n < candidates && fit < kept_most; n++) {
        HideFound found = {0};
        if (!draw_pose(&found.pose, &found.heading_rad, wish, ground, sight, n)) continue;
        if (wish->beside && meets_box(wish->beside, &found.pose, wish->shape.model)) continue;
        const WoodsPath footprint = woods_footprint(found.pose.p_enu, found.pose.nose, wish->shape.model->box_high[0],
                                                    wish->shape.model->box_low[0], wish->shape.model->width_m);
        if (meets_built(ground->culture, &footprint)) continue;
        if (!is_of_kind(wish->kind, ground, found.pose.p_enu, &footprint)) continue;
        if (!bears(ground->landscape, &found.pose, wish->shape.model)) continue;
        if (wish->kind == SCENARIO_HIDE_HOLLOW && !is_hollow(ground->landscape, found.pose.p_enu)) continue;
        if (!points_of(&points, &found.pose, wish, sight)) return false;
        int left_out;
        found.occlusion = hide_occlusion(&left_out, ground, &found.pose, &points, sight, wish->beside);
        if (left_out > most_left_out) most_left_out = left_out;
        fit++;
        keep(list, &count, &found, wish->occlusion);
    }
    if (count > 0) judge_list(out, list, count, ground, wish, sight);
    out->fit = fit, out->left_out = most_left_out;
    return count > 0;
}
