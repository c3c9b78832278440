/* terrain/culture/culture_give_way.c: takes records away that stand in the way of what was driven. */
#include "terrain/culture/culture_give_way.h"
#include "terrain/culture/culture_private.h"

#include <stdlib.h>

/* What is near a path, sampled so densely that no record is missed: a disc of half_m, grown by half a step. */
static void mark_along(CultureMarks *marks, const Culture *c, const DrivenPath *path)
{
    static const double step_m = 0.5;
    const double        length_m = hypot(path->b_m[0] - path->a_m[0], path->b_m[1] - path->a_m[1]);
    if (!isfinite(length_m) || !(path->half_m >= 0) || length_m > 2 * culture_farthest_m) return;
    const int steps = (int)ceil(length_m / step_m);
    for (int k = 0; k <= steps; k++) {
        const double t = steps ? (double)k / steps : 0;
        culture_mark_near(marks, c, path->a_m[0] + t * (path->b_m[0] - path->a_m[0]),
                          path->a_m[1] + t * (path->b_m[1] - path->a_m[1]), path->half_m + (steps ? 0.5 * step_m : 0));
    }
}

static double away_m(const DrivenPath *path, const double p[2])
{
    const double dx = path->b_m[0] - path->a_m[0], dy = path->b_m[1] - path->a_m[1], square = dx * dx + dy * dy;
    const double t = square > 0 ? clamp(((p[0] - path->a_m[0]) * dx + (p[1] - path->a_m[1]) * dy) / square, 0, 1) : 0;
    return hypot(path->a_m[0] + t * dx - p[0], path->a_m[1] + t * dy - p[1]);
}

/* Whether a line that is near a path goes: those that stand do, power lines only where a corner, a pole, is in it. */
static bool line_goes(const Culture *c, const CultureLine *l, const DrivenPath *path, int count)
{
    static const double pole_m = 0.4;
    if (l->kind == CULTURE_WALL || l->kind == CULTURE_FENCE || l->kind == CULTURE_WIRE_FENCE) return true;
    for (int k = 0; l->kind == CULTURE_POWER_LINE && k < l->corners; k++)
        for (int n = 0; n < count; n++)
            if (away_m(&path[n], c->corner_m[l->first_corner + k]) < path[n].half_m + pole_m) return true;
    return false;
}

Status culture_give_way(Culture *c, int *taken, const DrivenPath *path, int count)
{
    *taken = 0;
    if (count == 0 || !c->index) return STATUS_OK;
    CultureMarks marks = {calloc((size_t)c->buildings + 1, 1), calloc((size_t)c->lines + 1, 1),
                          calloc((size_t)c->points + 1, 1)};
    const bool   there = marks.building && marks.line && marks.point;
    int          buildings = 0, lines = 0, points = 0;
    for (int n = 0; n < count && there; n++) mark_along(&marks, c, &path[n]);
    for (int n = 0; n < c->buildings && there; n++)
        if (!marks.building[n]) c->building[buildings++] = c->building[n];
    for (int n = 0; n < c->lines && there; n++)
        if (!marks.line[n] || !line_goes(c, &c->line[n], path, count)) c->line[lines++] = c->line[n];
    for (int n = 0; n < c->points && there; n++)
        if (!marks.point[n]) c->point[points++] = c->point[n];
    free(marks.building), free(marks.line), free(marks.point);
    if (!there) return STATUS_NO_MEMORY;
    *taken = c->buildings - buildings + c->lines - lines + c->points - points;
    c->buildings = buildings, c->lines = lines, c->points = points; /* their corners stay, and belong to none */
    return *taken ? culture_index(c) : STATUS_OK;
}
