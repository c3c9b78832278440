/* entities/scenery/clutter_ruts.c: the lines of wheels behind what came over soil and stands: from a way, or as far as
 * it is soil. */
#include "entities/scenery/scenery_clutter_private.h"

/* What rolls, or is towed, to where it stands. */
static bool rolls(int class)
{
    return class == CLUTTER_CAR || class == CLUTTER_VAN || class == CLUTTER_LORRY || class == CLUTTER_TRACTOR ||
           class == CLUTTER_GENERATOR || class == CLUTTER_MACHINE || class == CLUTTER_TRAILER;
}

/* How long ago it came, log-uniform: of what runs, and of what stands for days. Estimates. */
static double came_s(const ClutterThing *t, double u)
{
    static const double runs_s[2] = {600, 12 * 3600.0}, stands_s[2] = {86400, 7 * 86400.0};
    const double       *of_s = t->mode == clutter_mode_cold ? stands_s : runs_s;
    if (t->mode >= clutter_mode_stopped)
        return clutter_stop_least_s *
               pow(clutter_stop_most_s / clutter_stop_least_s, (t->mode - clutter_mode_stopped + 0.5) / clutter_stops);
    return of_s[0] * pow(of_s[1] / of_s[0], u);
}

/* Backwards from where it stands, in pieces of a curvature that is drawn for every three of them. */
int clutter_ruts_of(SceneryRut *out, int room, const ClutterWork *work, const ClutterThing *t, int object)
{
    static const double piece_m = 15, bend_rad = 0.2;
    const ClutterRow   *row = &work->table.row[t->row];
    const Landscape    *land = work->config->landscape;
    const Elevation    *e = &land->elevation;
    double              to[3] = {t->x_m, t->y_m, elevation_height(e, t->x_m, t->y_m, NULL)};
    double              heading_rad = t->heading_rad;
    int                 count = 0;
    if (t->path_count || row->where < CLUTTER_AREAS || !rolls(row->class) || !isfinite(to[2])) return 0;
    while (count < room && count < clutter_ruts_each) {
        double from[3];
        heading_rad += bend_rad * (2 * clutter_unit(t->rank, (uint64_t)(60 + count / 3)) - 1);
        from[0] = to[0] - piece_m * sin(heading_rad), from[1] = to[1] - piece_m * cos(heading_rad);
        from[2] = elevation_height(e, from[0], from[1], NULL);
        if (!isfinite(from[2]) || !surface_loosens(landscape_surface(land, from[0], from[1])) ||
            (work->config->culture && culture_is_in_way(work->config->culture, from[0], from[1], 2)))
            break;
        SceneryRut *r = &out[count++];
        *r = (SceneryRut){.object = object, .came_s = (float)came_s(t, clutter_unit(t->rank, 59))};
        memcpy(r->a_enu, from, sizeof r->a_enu), memcpy(r->b_enu, to, sizeof r->b_enu);
        memcpy(to, from, sizeof to);
    }
    return count;
}
