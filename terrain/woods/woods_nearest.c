/* terrain/woods/woods_nearest.c: which squares of trees stand, where there are more than may: those nearest to the
 * places. */
#include "terrain/woods/woods_private.h"

#include <stdlib.h>

typedef struct SquareAway {
    double   away_m;
    uint32_t square;
} SquareAway;

static int compare_away(const void *a, const void *b)
{
    const SquareAway *p = a, *q = b;
    if (p->away_m != q->away_m) return p->away_m < q->away_m ? -1 : 1;
    return (p->square > q->square) - (p->square < q->square);
}

static void from_centre(SquareAway *away, const WoodsSource *s)
{
    const size_t squares = (size_t)s->nx * (size_t)s->ny;
    for (size_t n = 0; n < squares; n++) {
        const double x_m = s->origin_enu[0] + ((double)(n % (size_t)s->nx) + 0.5) * woods_square_m;
        const double y_m = s->origin_enu[1] + ((double)(n / (size_t)s->nx) + 0.5) * woods_square_m;
        away[n] = (SquareAway){hypot(x_m - s->centre_m[0], y_m - s->centre_m[1]), (uint32_t)n};
    }
}

static const int none = 1 << 20; /* more squares than there are on a side */

/* Marks the squares of places with 0, others with none. False: no place is in a square. */
static bool mark(int *rows, const WoodsSource *s, const WoodsConfig *config)
{
    bool any = false;
    for (int n = 0; n < s->nx * s->ny; n++) rows[n] = none;
    for (int n = 0; n < config->place_count; n++) {
        const double *p = config->place[n].p_m;
        const double  i = floor((p[0] - s->origin_enu[0]) / woods_square_m);
        const double  j = floor((p[1] - s->origin_enu[1]) / woods_square_m);
        if (!(i >= 0 && j >= 0 && i < s->nx && j < s->ny)) continue;
        rows[(int)j * s->nx + (int)i] = 0;
        any = true;
    }
    return any;
}

/* From the middle of a square to that of the nearest that has a place. First along each column, then the least sum of
 * squares along each row: exact (Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions", 2012, whose
 * envelope these short rows do not need). rows[nx * ny]: as marked, becomes the distances along columns. */
static void from_places(SquareAway *away, int *rows, const WoodsSource *s)
{
    const int nx = s->nx, ny = s->ny;
    for (int n = nx; n < nx * ny; n++)
        if (rows[n] > rows[n - nx] + 1) rows[n] = rows[n - nx] + 1;
    for (int n = nx * (ny - 1) - 1; n >= 0; n--)
        if (rows[n] > rows[n + nx] + 1) rows[n] = rows[n + nx] + 1;
    for (int n = 0; n < nx * ny; n++) {
        const int *row = rows + n - n % nx, i = n % nx;
        int64_t    least = (int64_t)row[i] * row[i];
        for (int d = 1; (int64_t)d * d < least && (i - d >= 0 || i + d < nx); d++)
            for (int k = i - d; k <= i + d; k += 2 * d) {
                if (k < 0 || k >= nx) continue;
                const int64_t square = (int64_t)d * d + (int64_t)row[k] * row[k];
                least = square < least ? square : least;
            }
        away[n] = (SquareAway){woods_square_m * sqrt((double)least), (uint32_t)n};
    }
}

Status woods_keep_nearest(Woods *out, const WoodsSource *s, SquarePlants *square, const WoodsConfig *config)
{
    const size_t squares = (size_t)s->nx * (size_t)s->ny;
    SquareAway  *away = malloc(squares * sizeof *away);
    int         *rows = malloc(squares * sizeof *rows);
    int64_t      kept = 0;
    out->bare = calloc(squares, 1);
    if (!away || !rows || !out->bare) {
        free(away), free(rows);
        return STATUS_NO_MEMORY;
    }
    /* a corner of a square is farther than its middle, and so is a place from that of its own */
    double within_m = 0.7072 * woods_square_m;
    if (mark(rows, s, config)) {
        from_places(away, rows, s);
        within_m *= 2;
    } else from_centre(away, s);
    free(rows);
    qsort(away, squares, sizeof *away, compare_away);
    out->reach_m = away[squares - 1].away_m;
    bool full = false;
    for (size_t k = 0; k < squares; k++) {
        SquarePlants *one = &square[away[k].square];
        if (!full && kept + one->count > config->most_trees) {
            full = true;
            out->reach_m = fmax(away[k].away_m - within_m, 0);
        }
        if (full) {
            out->left_out += one->count;
            one->count = 0;
            out->bare[away[k].square] = 1;
        }
        kept += one->count;
    }
    free(away);
    return STATUS_OK;
}
