/* terrain/invented/ways_villages.c: where villages are, and their lanes with plots. */
#include "terrain/invented/ways_private.h"

#include <stdlib.h>

static const double lane_half_m = 2.2;

/* ---- villages --------------------------------------------------------------------------------- */

/* Chooses places for villages: gentle dry land, one in most squares of the grid. */
static void choose_villages(Ways *ways, const WaysGround *ground)
{
    static const double margin_m = 300, steepest = 0.09;
    const int           across = (int)fmax(rint(ways->side_m[0] / ways_village_grid_m), 1);
    const int           up = (int)fmax(rint(ways->side_m[1] / ways_village_grid_m), 1);
    const double        wide_m = ways->side_m[0] / across, high_m = ways->side_m[1] / up;
    for (int n = 0; n < across * up && ways->villages < ways_most_villages; n++) {
        const uint64_t h = invented_hash(ground->seed + 60, n % across, n / across);
        if (across * up > 1 && invented_unit(invented_hash(h, 0, 0)) < 0.25) continue;
        double best[2] = {0, 0}, least = INFINITY;
        for (int k = 0; k < 16; k++) {
            const double x = (n % across + 0.15 + 0.7 * invented_unit(invented_hash(h, 1, k))) * wide_m;
            const double y = (n / across + 0.15 + 0.7 * invented_unit(invented_hash(h, 2, k))) * high_m;
            if (x < margin_m || y < margin_m || x > ways->side_m[0] - margin_m || y > ways->side_m[1] - margin_m)
                continue;
            bool busy = false;
            for (int m = 0; m < 9 && !busy; m++)
                busy = ground->coast->sea_count && coast_at(ground->coast, ways->x0_m + x + 250 * (m % 3 - 1),
                                                            ways->y0_m + y + 250 * (m / 3 - 1)) != COAST_LAND;
            if (busy) continue;
            const double arm_m = 120, here = ways_height(ways, ground, x, y);
            const double dx = ways_height(ways, ground, x + arm_m, y) - ways_height(ways, ground, x - arm_m, y);
            const double dy = ways_height(ways, ground, x, y + arm_m) - ways_height(ways, ground, x, y - arm_m);
            const double score = hypot(dx, dy) / (2 * arm_m);
            if (!isfinite(here) || !(score < steepest) || score >= least) continue;
            least = score, best[0] = x, best[1] = y;
        }
        if (least == INFINITY) continue;
        ways->village[ways->villages][0] = best[0], ways->village[ways->villages][1] = best[1];
        ways->villages++;
    }
}

/* Indexes the segments laid so far, which are those of streams and gullies. */
static Status index_streams(Ways *ways)
{
    double *xy = malloc(2 * ((size_t)ways->segments + 1) * sizeof *xy);
    if (!xy) return STATUS_NO_MEMORY;
    for (int n = 0; n < ways->segments; n++)
        xy[2 * n] = (double)ways->segment[n].x_m, xy[2 * n + 1] = (double)ways->segment[n].y_m;
    const Status status = near_grid_create(&ways->stream_near, 64, ways->segments, xy, xy + 1, 2 * sizeof *xy);
    free(xy);
    return status;
}

Status ways_choose_villages(Ways *ways, const WaysGround *ground)
{
    choose_villages(ways, ground);
    return index_streams(ways);
}

/* ---- plots ------------------------------------------------------------------------------------ */

/* Whether the start of a segment of a stream or gully, or a pond, is within near_m (at most 64). */
static bool stream_near(const Ways *ways, double x, double y, double near_m)
{
    const NearGrid *grid = &ways->stream_near;
    const int64_t   west = near_grid_cell(grid, x - near_m), east = near_grid_cell(grid, x + near_m);
    const int64_t   south = near_grid_cell(grid, y - near_m), north = near_grid_cell(grid, y + near_m);
    for (int64_t j = south; j <= north; j++)
        for (int64_t i = west; i <= east; i++) {
            int first, end;
            near_grid_bucket(grid, i, j, &first, &end);
            for (int n = first; n < end; n++) {
                const WaySegment *s = &ways->segment[grid->item[n]];
                if (fabs((double)s->x_m - x) < near_m && fabs((double)s->y_m - y) < near_m) return true;
            }
        }
    for (int n = 0; n < ways->ponds; n++)
        if (hypot((double)ways->pond[n].x_m - x, (double)ways->pond[n].y_m - y) < near_m + (double)ways->pond[n].most_m)
            return true;
    return false;
}

/* Distance of a place from the nearest road or lane other than a given one. */
static double other_road_m(const Ways *ways, const int *near, int count, int way, double x, double y)
{
    double least = INFINITY;
    for (int n = 0; n < count; n++) {
        const WaySegment *s = &ways->segment[near[n]];
        if (s->way == way) continue;
        const double px = x - (double)s->x_m, py = y - (double)s->y_m, dx = (double)s->dx, dy = (double)s->dy;
        const double t = clamp(px * dx + py * dy, 0, (double)s->length_m);
        least = fmin(least, hypot(px - t * dx, py - t * dy));
    }
    return least;
}

/* Whether a vehicle was reported in a plot's house, with room for its own half length. */
static bool vehicle_in_house(const Ways *ways, const HousePlot *p)
{
    static const double room_m = 4;
    const double        x = p->x_m - ways->x0_m + p->house[0] * p->direction[0] - p->house[1] * p->direction[1];
    const double        y = p->y_m - ways->y0_m + p->house[0] * p->direction[1] + p->house[1] * p->direction[0];
    return ways_vehicle_near(ways, x, y, hypot(p->house_half[0], p->house_half[1]) + room_m);
}

/* Lays plots along both sides of the roads and lanes about a village. */
static Status lay_plots(Ways *ways, const WaysGround *ground, const double centre[2], double radius_m)
{
    static const double back_m = 1.4; /* distance of a plot from the way's edge */
    int                 near[4096], nears = 0;
    const int           first_plot = ways->plots;
    Status              status = STATUS_OK;
    for (int n = 0; n < ways->segments && nears < 4096; n++)
        if (ways->segment[n].kind <= WAY_LANE &&
            hypot((double)ways->segment[n].x_m - centre[0], (double)ways->segment[n].y_m - centre[1]) < radius_m + 80)
            near[nears++] = n;
    double next[2] = {0, 0};
    int    way = -1;
    for (int n = 0; n < nears && status == STATUS_OK; n++) {
        const WaySegment *s = &ways->segment[near[n]];
        if (s->way != way) way = s->way, next[0] = next[1] = (double)s->along_m;
        if (hypot((double)s->x_m - centre[0], (double)s->y_m - centre[1]) > radius_m) continue;
        for (int side = 0; side < 2 && status == STATUS_OK; side++) {
            if ((double)s->along_m < next[side]) continue;
            const uint64_t h =
                invented_hash(ground->seed + 61, (int64_t)(s->x_m * 16), (int64_t)(s->y_m * 16) * 2 + side);
            const double u = invented_unit(h), v = invented_unit(invented_hash(h, 1, 0));
            const double z = invented_unit(invented_hash(h, 2, 0));
            HousePlot    p = {.half_along_m = 9 + 6 * u, .half_across_m = 15 + 9 * v};
            const double sign = side ? -1 : 1, off_m = (double)s->half_m + back_m + p.half_across_m;
            p.direction[0] = (double)s->dx, p.direction[1] = (double)s->dy;
            const double x = (double)s->x_m + p.half_along_m * (double)s->dx - sign * off_m * (double)s->dy;
            const double y = (double)s->y_m + p.half_along_m * (double)s->dy + sign * off_m * (double)s->dx;
            next[side] = (double)s->along_m + 6;
            if (z < 0.12) continue; /* leaves a gap between plots */
            const double reach = hypot(p.half_along_m, p.half_across_m);
            if (other_road_m(ways, near, nears, s->way, x, y) < p.half_across_m + 6) continue;
            if (stream_near(ways, x, y, reach + 8)) continue;
            bool taken = false;
            for (int k = first_plot; k < ways->plots && !taken; k++)
                taken = hypot(ways->plot[k].x_m - ways->x0_m - x, ways->plot[k].y_m - ways->y0_m - y) <
                        0.9 * (p.half_along_m + ways->plot[k].half_along_m);
            if (taken) continue;
            p.x_m = ways->x0_m + x, p.y_m = ways->y0_m + y;
            /* moves the house towards the lane, which is at negative values across a plot on the left */
            p.house_half[0] = 5 + 2.5 * v, p.house_half[1] = 4 + 1.5 * u;
            p.house[0] = (z - 0.5) * (p.half_along_m - p.house_half[0] - 2);
            p.house[1] = -sign * (p.half_across_m - p.house_half[1] - 4 - 4 * z);
            next[side] = (double)s->along_m + 2 * p.half_along_m + 1;
            if (vehicle_in_house(ways, &p)) continue;
            status = ways_reserve((void **)&ways->plot, &ways->plots_room, ways->plots + 1, sizeof *ways->plot);
            if (status == STATUS_OK) ways->plot[ways->plots++] = p;
        }
    }
    return status;
}

/* Lays lanes that leave the roads about a village, bent to the left and right in turn; some meet at their ends. */
static Status lay_lanes(Ways *ways, const WaysGround *ground, const double centre[2], double radius_m)
{
    WayLine   control = {0}, line = {0};
    Status    status = STATUS_OK;
    const int roads = ways->segments;
    int       lanes = 0;
    double    last_m = -1e9;
    int       way = -1;
    for (int n = 0; n < roads && status == STATUS_OK && lanes < 7; n++) {
        const WaySegment s = ways->segment[n];
        if (s.kind != WAY_ROAD || hypot((double)s.x_m - centre[0], (double)s.y_m - centre[1]) > 0.75 * radius_m)
            continue;
        if (s.way != way) way = s.way, last_m = (double)s.along_m - 45;
        const uint64_t h = invented_hash(ground->seed + 62, (int64_t)(s.x_m * 16), (int64_t)(s.y_m * 16));
        if ((double)s.along_m - last_m < 75 + 40 * invented_unit(h)) continue;
        last_m = (double)s.along_m;
        const double sign = lanes % 2 ? -1 : 1;
        const double length_m = (0.45 + 0.5 * invented_unit(invented_hash(h, 1, 0))) * radius_m;
        const double bend = 0.5 * (invented_unit(invented_hash(h, 2, 0)) - 0.5);
        double       x = (double)s.x_m, y = (double)s.y_m, dx = -sign * (double)s.dy, dy = sign * (double)s.dx;
        control.count = 0;
        for (int k = 0; k <= 5 && status == STATUS_OK; k++) {
            status = ways_line_add(&control, x, y);
            const double c = cos(bend * 0.5), t = sin(bend * 0.5), turned = dx * c - dy * t;
            dy = dx * t + dy * c, dx = turned;
            x += dx * length_m / 5, y += dy * length_m / 5;
            if (k > 0 && stream_near(ways, x, y, 12)) break;
        }
        if (status != STATUS_OK || control.count < 3) continue;
        status = ways_draw_spline(&line, &control);
        if (status == STATUS_OK) status = ways_lay_line(ways, WAY_LANE, &line, lane_half_m);
        lanes++;
    }
    free(control.p), free(line.p);
    return status;
}

Status ways_lay_villages(Ways *ways, const WaysGround *ground)
{
    Status status = STATUS_OK;
    for (int n = 0; n < ways->villages && status == STATUS_OK; n++) {
        const double size = invented_unit(invented_hash(ground->seed + 64, n, 0));
        const double radius_m = n % 2 ? 90 + 60 * size : 220 + 110 * size; /* radius of hamlets, and of villages */
        status = lay_lanes(ways, ground, ways->village[n], radius_m);
        if (status == STATUS_OK) status = lay_plots(ways, ground, ways->village[n], radius_m);
    }
    return status;
}
