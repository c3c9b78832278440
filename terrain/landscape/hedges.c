/* terrain/landscape/hedges.c: places of hedgerows: squares of a grid that a hedgerow's middle passes through. */
#include "terrain/landscape/hedges.h"

#include "terrain/landscape/ways_private.h"

#include <stdlib.h>

static const double beside_track_m = 2.8; /* middle of a hedgerow from the border, where a track runs along that */

/* The place in a square on a hedgerow's middle, or beside its track on the square's side of it. */
static bool place_in_square(HedgePlace *out, uint64_t seed, int64_t i, int64_t j, double spacing_m)
{
    double x = ((double)i + 0.5) * spacing_m, y = ((double)j + 0.5) * spacing_m;
    for (int step = 0; step < 4; step++) { /* the plane is bent: towards it, again */
        PlotBorder border;
        double     away[2];
        if (!plot_border_about(&border, away, &out->hedge, seed, x, y) || !border.hedge) return false;
        const double to_go_m = (border.track ? beside_track_m : 0) - border.away_m;
        if (fabs(to_go_m) > 1.5 * spacing_m + beside_track_m) return false;
        x += to_go_m * away[0], y += to_go_m * away[1];
    }
    out->x_m = x, out->y_m = y;
    return (int64_t)floor(x / spacing_m) == i && (int64_t)floor(y / spacing_m) == j;
}

static HedgeHeight height_of(uint64_t hedge)
{
    const double u = unit_from_hash(landscape_hash(hedge, 10, 0));
    return u < 0.45 ? HEDGE_CUT : u < 0.8 ? HEDGE_SHRUBS : HEDGE_TREES;
}

Status landscape_hedges(HedgePlace **out, int *count, const Landscape *landscape, const double south_west_m[2],
                        const double north_east_m[2], double spacing_m)
{
    const Cover *cover = landscape->cover;
    double       from[2], end[2], squares = 1;
    int          room = 0;
    *out = NULL;
    *count = 0;
    if (!(spacing_m >= 1 && spacing_m <= 50)) return STATUS_BAD_VALUE;
    for (int a = 0; a < 2; a++) {
        if (!(fabs(south_west_m[a]) < 1e6 && fabs(north_east_m[a]) < 1e6)) return STATUS_BAD_VALUE;
        from[a] = floor(south_west_m[a] / spacing_m), end[a] = ceil(north_east_m[a] / spacing_m);
        squares *= fmax(end[a] - from[a], 0);
    }
    if (!(squares <= 1 << 26)) return STATUS_BAD_VALUE;
    if (!cover || cover->real) return STATUS_OK;
    for (int64_t j = (int64_t)from[1]; j < (int64_t)end[1]; j++)
        for (int64_t i = (int64_t)from[0]; i < (int64_t)end[0]; i++) {
            HedgePlace place;
            if (!place_in_square(&place, cover->seed, i, j, spacing_m)) continue;
            /* what lies over hedgerows is in the classes */
            if (landscape_surface(landscape, place.x_m, place.y_m) != SURFACE_SCRUB) continue;
            place.height = height_of(place.hedge);
            const Status status = ways_reserve((void **)out, &room, *count + 1, sizeof **out);
            if (status != STATUS_OK) {
                free(*out);
                *out = NULL;
                *count = 0;
                return status;
            }
            (*out)[(*count)++] = place;
        }
    return STATUS_OK;
}
