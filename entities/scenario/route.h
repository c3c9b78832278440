/* entities/scenario/route.h: a smooth path through points: position and its derivatives by the distance along it.
 *
 * A cubic spline through the points (chord length its parameter, natural at the ends or closed), then sampled evenly
 * by arc length and held as a uniform cubic B-spline: twice differentiable, and as quick far along as at the
 * beginning. */
#ifndef ENTITIES_SCENARIO_ROUTE_H
#define ENTITIES_SCENARIO_ROUTE_H

#include "pitviper.h"

enum { route_max_points = 128 };

typedef struct Route {
    bool    loop;
    double  length_m, step_m;   /* of the plane curve; between knots */
    int     knots;
    double (*control)[3];       /* [knots + 3] (loop: periodic) */
} Route;

typedef struct RoutePoint {
    double p[3], d[3], dd[3];   /* p by distance; |d_xy| = 1 within 1e-3 */
} RoutePoint;

/* point: x, y, z; at least 2 (loop: 3), neighbours at least 0.1 m apart in the plane. Distances are those of the
 * plane. The result passes the points within 1e-3 of the distance between them (tests/entities/test_route.c).
 * STATUS_BAD_VALUE for fewer or nearer points, STATUS_NO_MEMORY. */
Status route_create(Route *out, const double (*point)[3], int count, bool loop);
void   route_destroy(Route *route);
/* Before the start and after the end it continues straight; a loop is periodic. */
void   route_at(RoutePoint *out, const Route *route, double distance_m);

#endif
