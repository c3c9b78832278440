/* terrain/invented/ways_tracks.c: tracks of farms and woods: they leave the roads between villages on both sides, bend
 * gently and end in the open, by the seed alone. */
#include "terrain/invented/ways_private.h"

#include <stdlib.h>

static const double track_half_m = 1.7;

/* Whether a track may lead over a place: it is land, away from the rim, from villages and from ponds. */
static bool is_free(const Ways *ways, const WaysGround *ground, double x, double y)
{
    static const double margin_m = 40, village_m = 360, pond_m = 8;
    if (!(x > margin_m && y > margin_m && x < ways->side_m[0] - margin_m && y < ways->side_m[1] - margin_m))
        return false;
    for (int n = 0; n < ways->villages; n++)
        if (hypot(ways->village[n][0] - x, ways->village[n][1] - y) < village_m) return false;
    for (int n = 0; n < ways->ponds; n++)
        if (hypot((double)ways->pond[n].x_m - x, (double)ways->pond[n].y_m - y) < (double)ways->pond[n].most_m + pond_m)
            return false;
    return !ground->coast->sea_count || coast_at(ground->coast, ways->x0_m + x, ways->y0_m + y) == COAST_LAND;
}

/* The middle line of a track from a place of a road: steps of a drawn length that turn by a drawn bend. False: it comes
 * to what is in its way before it is worth a track. */
static bool draw_track(WayLine *control, Status *status, const Ways *ways, const WaysGround *ground,
                       const WaySegment *from, uint64_t h)
{
    static const double shortest_m = 180, longest_m = 900, step_m = 60, turns_rad = 0.5;
    const double        length_m = shortest_m + (longest_m - shortest_m) * invented_unit(invented_hash(h, 1, 0));
    const double        sign = h & 1 ? -1 : 1, skew_rad = 0.8 * (invented_unit(invented_hash(h, 2, 0)) - 0.5);
    const double        dx = (double)from->dx, dy = (double)from->dy;
    double    x = (double)from->x_m, y = (double)from->y_m, heading_rad = atan2(sign * dx, -sign * dy) + skew_rad;
    const int steps = (int)(length_m / step_m);
    control->count = 0;
    for (int k = 0; k <= steps && *status == STATUS_OK && is_free(ways, ground, x, y); k++) {
        *status = ways_line_add(control, x, y);
        heading_rad += turns_rad * (invented_unit(invented_hash(h, 3, k)) - 0.5);
        x += step_m * cos(heading_rad), y += step_m * sin(heading_rad);
    }
    return *status == STATUS_OK && control->count > 3;
}

Status ways_lay_tracks(Ways *ways, const WaysGround *ground)
{
    static const double apart_m = 260, more_m = 340;
    WayLine             control = {0}, line = {0};
    Status              status = STATUS_OK;
    const int           roads = ways->segments;
    int                 way = -1;
    double              next_m = 0;
    for (int n = 0; n < roads && status == STATUS_OK && ways->ways < UINT16_MAX; n++) {
        const WaySegment s = ways->segment[n]; /* laying moves the rows */
        if (s.kind != WAY_ROAD) continue;
        const uint64_t h = invented_hash(ground->seed + 65, (int64_t)(s.x_m * 16), (int64_t)(s.y_m * 16));
        if (s.way != way) way = s.way, next_m = (double)s.along_m + apart_m * invented_unit(h);
        if ((double)s.along_m < next_m) continue;
        next_m = (double)s.along_m + apart_m + more_m * invented_unit(invented_hash(h, 4, 0));
        if (!draw_track(&control, &status, ways, ground, &s, h)) continue;
        status = ways_draw_spline(&line, &control);
        if (status == STATUS_OK) status = ways_lay_line(ways, WAY_TRACK, &line, track_half_m);
    }
    free(control.p), free(line.p);
    return status;
}
