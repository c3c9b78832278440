/* entities/scenery/clutter_drives.c: clutter that drives along a line, there on the right side and back on the other:
 * along ways, and off them over soil. */
#include "entities/scenery/scenery_clutter_private.h"

#include <stdlib.h>

void clutter_line_measure(ClutterLine *line)
{
    line->length_m = 0;
    for (int k = 0; k + 1 < line->count; k++)
        line->length_m += hypot(line->p[k + 1][0] - line->p[k][0], line->p[k + 1][1] - line->p[k][1]);
}

bool clutter_may_pass(const ClutterWork *work, const double p[2])
{
    static const double radius_m = 4, height_m = 4;
    return isfinite(elevation_height(&work->config->landscape->elevation, p[0], p[1], NULL)) &&
           clutter_keeps_clear(work->spots, p[0], p[1], radius_m, height_m);
}

/* ---- there and back ----------------------------------------------------------------------------- */

static Status path_add(ClutterWork *work, const double p[3])
{
    if (work->paths == work->path_room) {
        const int room = work->path_room + work->path_room / 2 + 1024;
        void     *more = realloc(work->path, (size_t)room * sizeof *work->path);
        if (more) work->path = more;
        void *loose = realloc(work->path_loose, (size_t)room);
        if (loose) work->path_loose = loose;
        if (!more || !loose) return STATUS_NO_MEMORY;
        work->path_room = room;
    }
    work->path_loose[work->paths] = surface_loosens(landscape_surface(work->config->landscape, p[0], p[1]));
    memcpy(work->path[work->paths++], p, 3 * sizeof(double));
    return STATUS_OK;
}

/* One side of a line, from its vertex a to b (b < a: back), half a lane right of its middle. */
static Status path_side(ClutterWork *work, const ClutterLine *line, int a, int b)
{
    const int    step = a < b ? 1 : -1;
    Status       status = STATUS_OK;
    const double off_m = 0.5 * line->half_m;
    for (int k = a; k != b + step && status == STATUS_OK; k += step) {
        double        d[2] = {0, 0}, p[3];
        const double *from = line->p[k == a ? k : k - step], *to = line->p[k == b ? k : k + step];
        const double  run_m = hypot(to[0] - from[0], to[1] - from[1]);
        for (int c = 0; c < 2; c++) d[c] = run_m > 0 ? (to[c] - from[c]) / run_m : 0;
        p[0] = line->p[k][0] + off_m * d[1], p[1] = line->p[k][1] - off_m * d[0];
        p[2] = elevation_height(&work->config->landscape->elevation, p[0], p[1], NULL);
        if (isfinite(p[2])) status = path_add(work, p);
    }
    return status;
}

static int by_rank(const void *pa, const void *pb)
{
    const ClutterThing *a = pa, *b = pb;
    return (a->rank > b->rank) - (a->rank < b->rank);
}

/* At equal speeds, at distances that leave room. */
Status clutter_add_riders(ClutterWork *work, const ClutterLine *line, ClutterThing *rider, int riders, double more_m)
{
    static const double room_m = 40; /* of a vehicle */
    const double        loop_m = 2 * line->length_m;
    const int           first = work->paths;
    qsort(rider, (size_t)riders, sizeof *rider, by_rank);
    if (riders > loop_m / room_m) riders = (int)(loop_m / room_m);
    if (riders == 0) return STATUS_OK;
    Status status = path_side(work, line, 0, line->count - 1);
    if (status == STATUS_OK) status = path_side(work, line, line->count - 1, 0);
    if (work->paths - first < 2) return status; /* beyond the ground */
    const uint64_t key = line->key;
    const double   speed_mps = clutter_speed_mps[line->kind] * (0.8 + 0.4 * clutter_unit(key, 1));
    for (int k = 0; k < riders && status == STATUS_OK; k++) {
        ClutterThing *t = &rider[k];
        const double  spare_m = loop_m / riders - 0.5 * room_m;
        SceneryMover  mover = {.first = 0, .count = work->paths - first, .speed_mps = speed_mps};
        const Scenery at = {.path_enu = work->path + first};
        double        p[3], pose[9];
        mover.phase_m = loop_m * k / riders + spare_m * clutter_unit(t->rank, 2);
        scenery_pose(p, pose, &at, &mover, 0);
        t->x_m = p[0], t->y_m = p[1], t->heading_rad = atan2(pose[0], pose[3]);
        t->path = first, t->path_count = mover.count;
        t->speed_mps = (float)speed_mps, t->phase_m = (float)mover.phase_m;
        if (clutter_in_square(work->config, p[0], p[1], more_m)) status = clutter_add(work, *t);
    }
    return status;
}

/* ---- off the ways ------------------------------------------------------------------------------- */

enum { most_corners = 18, least_corners = 11 };
static const double corner_m = 12, off_way_m = 5; /* off_way_m: from the middle of a line to its edge */

/* Whether wheels can come from a corner before, headed this way: soil below both lanes, no way, nothing built. */
static bool goes_on(const ClutterWork *work, const double p[2], double heading_rad)
{
    static const float  room_m[3] = {12, 9, 4}; /* both sides of the line, with what drives on them */
    static const double step_m = 3;
    const double        forward[2] = {sin(heading_rad), cos(heading_rad)};
    for (double back_m = 0; back_m < corner_m; back_m += step_m)
        for (int side = -1; side <= 1; side++) {
            const double x = p[0] - back_m * forward[0] + 0.5 * off_way_m * side * forward[1];
            const double y = p[1] - back_m * forward[1] - 0.5 * off_way_m * side * forward[0];
            if (!surface_loosens(landscape_surface(work->config->landscape, x, y))) return false;
        }
    return clutter_can_stand(work->spots, p[0], p[1], heading_rad, room_m) && clutter_may_pass(work, p);
}

/* From a place on it winds as far as it can: of a curvature that is drawn again for every four corners. */
Status clutter_place_off_ways(ClutterWork *work, int row, uint64_t h, double x_m, double y_m)
{
    static const double bend_rad = 0.12;
    double              p[most_corners][2] = {{x_m, y_m}}, heading_rad = 2 * pi_rad * clutter_unit(h, 4);
    ClutterLine         line = {.p = p, .count = 1, .kind = clutter_off_ways, .half_m = off_way_m, .key = h};
    ClutterThing        rider = {.rank = h, .row = row, .variant = clutter_variant_of(work, row, h)};
    if (!clutter_in_square(work->config, x_m, y_m, clutter_off_ways_m + clutter_margin_m)) return STATUS_OK;
    if (!clutter_is_area(work->config->landscape, work->table.row[row].where, x_m, y_m) ||
        !goes_on(work, p[0], heading_rad))
        return STATUS_OK;
    while (line.count < most_corners) {
        const int n = line.count;
        heading_rad += bend_rad * (2 * clutter_unit(h, (uint64_t)(20 + n / 4)) - 1);
        p[n][0] = p[n - 1][0] + corner_m * sin(heading_rad), p[n][1] = p[n - 1][1] + corner_m * cos(heading_rad);
        if (!goes_on(work, p[n], heading_rad)) break;
        line.count++;
    }
    clutter_line_measure(&line);
    return line.count < least_corners ? STATUS_OK : clutter_add_riders(work, &line, &rider, 1, clutter_off_ways_m);
}
