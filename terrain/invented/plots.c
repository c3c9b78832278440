/* terrain/invented/plots.c: the invented fields, and the hedgerows between them: cells of a jittered grid, some joined
 * in twos and fours. Properties of a cell are computed once and shared by its positions. */

#include "terrain/invented/invented.h"
#include "terrain/invented/invented_eight.h"

static uint64_t field_of_site(uint64_t seed, int64_t i, int64_t j)
{
    const double four = invented_unit(invented_hash(seed + 1, i >> 1, j >> 1));
    if (four < 0.25) return invented_hash(seed + 2, i >> 1, j >> 1);
    if (four < 0.45) return invented_hash(seed + 3, i >> 1, j);
    if (four < 0.60) return invented_hash(seed + 4, i, j >> 1);
    return invented_hash(seed + 5, i, j);
}

static SurfaceClass crop_of_field(uint64_t id, bool arable)
{
    static const struct {
        double       arable, pasture; /* this kind is drawn where a uniform number is below this share */
        SurfaceClass surface;
    } share[] = {
        {0.38, 0.10, SURFACE_CROP},  {0.58, 0.15, SURFACE_PLOUGHED},  {0.70, 0.20, SURFACE_BARE_SOIL},
        {0.88, 0.62, SURFACE_GRASS}, {1.00, 0.90, SURFACE_DRY_GRASS}, {1.00, 1.00, SURFACE_SCRUB},
    };
    const double u = invented_unit(invented_hash(id, 7, 0));
    for (size_t n = 0; n < sizeof share / sizeof share[0]; n++)
        if (u < (arable ? share[n].arable : share[n].pasture)) return share[n].surface;
    return SURFACE_GRASS;
}

static void find_cell(PlotCell *cell, uint64_t seed, int64_t ci, int64_t cj)
{
    static const double jitter = 0.5;
    double              whole_x[16] = {0}, whole_y[16] = {0}; /* a place that stands for the field as a whole */
    *cell = (PlotCell){.i = ci, .j = cj, .seed = seed, .known = true};
    for (int n = 0; n < plot_sites; n++) {
        const int64_t  di = n % 3 - 1, dj = n / 3 - 1, i = ci + di, j = cj + dj;
        const uint64_t h = invented_hash(seed, i, j);
        const double   ux = (double)(h & 0xffffffffu) * 0x1p-32 - 0.5, uy = (double)(h >> 32) * 0x1p-32 - 0.5;
        cell->x_m[n] = (float)(((double)di + 0.5 + jitter * ux) * plot_m);
        cell->y_m[n] = (float)(((double)dj + 0.5 + jitter * uy) * plot_m);
        cell->id[n] = field_of_site(seed, i, j);
        cell->field[n] = n;
        for (int k = n - 1; k >= 0; k--)
            if (cell->id[k] == cell->id[n]) cell->field[n] = k;
        whole_x[n] = (double)(i >> 1) * 2 * plot_m, whole_y[n] = (double)(j >> 1) * 2 * plot_m;

        const uint64_t turn = invented_hash(cell->id[n], 8, 0);
        const double   dx = invented_unit(turn) - 0.5, dy = invented_unit(invented_hash(turn, 9, 0)) - 0.5;
        const double   length = fmax(sqrt(dx * dx + dy * dy), 1e-3);
        cell->across_x[n] = (float)(dx / length), cell->across_y[n] = (float)(dy / length);
    }
    float arable[16];
    for (int n = 0; n < 16; n += 8) f32x8_store(arable + n, noise_eight(seed + 13, 1900, whole_x + n, whole_y + n));
    for (int n = 0; n < plot_sites; n++) cell->crop[n] = (int32_t)crop_of_field(cell->id[n], arable[n] > -0.15f);
}

/* The cell comes from earlier look-ups where it is kept. A cell's content depends on its seed and place alone, so
 * results do not depend on which cells are kept. */
PlotCell *plot_cell_at(uint64_t seed, int64_t i, int64_t j)
{
    static _Thread_local PlotCell kept[plot_cells_kept];
    PlotCell                     *cell = &kept[(uint64_t)(i + 11 * j) % plot_cells_kept];
    if (!cell->known || cell->i != i || cell->j != j || cell->seed != seed) find_cell(cell, seed, i, j);
    return cell;
}

/* The block of four by four sites that a site is in. Tracks run along the borders of most blocks, and so join up. */
static uint64_t block_of(const PlotCell *cell, uint64_t seed, int site)
{
    return invented_hash(seed + 8, (cell->i + site % 3 - 1) >> 2, (cell->j + site / 3 - 1) >> 2);
}

/* The properties of the border between two sites that all its places share. */
static PlotEdge find_edge(const PlotCell *cell, uint64_t seed, int site, int other)
{
    const double   dx = (double)(cell->x_m[other] - cell->x_m[site]), dy = (double)(cell->y_m[other] - cell->y_m[site]);
    const uint64_t one = block_of(cell, seed, site), two = block_of(cell, seed, other);
    const double   u = invented_unit(invented_hash(seed + 6, (int64_t)(cell->id[other] ^ cell->id[site]), 0));
    const double   v = invented_unit(invented_hash(seed + 9, (int64_t)(one ^ two), 0));
    return (PlotEdge){.known = true,
                      .first = cell->id[site] < cell->id[other],
                      .track = one != two ? v < 0.7 : u<0.05, .hedge = u> 0.66,
                      .apart_m = fmax(sqrt(dx * dx + dy * dy), 1e-3)};
}

const PlotEdge *plot_edge(PlotCell *cell, uint64_t seed, int site, int other)
{
    PlotEdge *edge = &cell->edge[site][other];
    if (!edge->known) *edge = find_edge(cell, seed, site, other);
    return edge;
}

PlotBorder plot_border(PlotCell *cell, uint64_t seed, int site, int other, float x_m, float y_m)
{
    /* distance to the perpendicular bisector of the two sites */
    const double    own_x = (double)(x_m - cell->x_m[site]), own_y = (double)(y_m - cell->y_m[site]);
    const double    off_x = (double)(x_m - cell->x_m[other]), off_y = (double)(y_m - cell->y_m[other]);
    const double    more = off_x * off_x + off_y * off_y - (own_x * own_x + own_y * own_y);
    const PlotEdge *edge = plot_edge(cell, seed, site, other);
    return (PlotBorder){
        .away_m = 0.5 * more / edge->apart_m, .first = edge->first, .track = edge->track, .hedge = edge->hedge};
}

bool plot_border_about(PlotBorder *out, double away_from[2], uint64_t *fields, uint64_t seed, double x_m, double y_m)
{
    double x[8], y[8], bent_x[8], bent_y[8], i[8], j[8], near_least = INFINITY, c, t;
    float  from_x[8], from_y[8];
    F32x8  in_x, in_y;
    int    site = 0;
    for (int k = 0; k < 8; k++) x[k] = x_m, y[k] = y_m;
    plot_bend(bent_x, bent_y, seed, x, y);
    plot_cells_of(i, j, &in_x, &in_y, bent_x, bent_y);
    f32x8_store(from_x, in_x), f32x8_store(from_y, in_y);
    PlotCell *cell = plot_cell_at(seed, (int64_t)i[0], (int64_t)j[0]);
    for (int n = 0; n < plot_sites; n++) {
        const double dx = (double)(from_x[0] - cell->x_m[n]), dy = (double)(from_y[0] - cell->y_m[n]);
        if (dx * dx + dy * dy < near_least) near_least = dx * dx + dy * dy, site = n;
    }
    plot_turn(&c, &t, seed);
    out->away_m = INFINITY;
    for (int n = 0; n < plot_sites; n++) {
        if (cell->field[n] == cell->field[site]) continue;
        const PlotBorder border = plot_border(cell, seed, site, n, from_x[0], from_y[0]);
        if (border.away_m >= out->away_m) continue;
        const double dx = (double)(cell->x_m[n] - cell->x_m[site]), dy = (double)(cell->y_m[n] - cell->y_m[site]);
        const double apart_m = fmax(sqrt(dx * dx + dy * dy), 1e-3);
        *out = border;
        away_from[0] = -(c * dx + t * dy) / apart_m, away_from[1] = (t * dx - c * dy) / apart_m;
        *fields = cell->id[n] ^ cell->id[site];
    }
    return out->away_m < INFINITY;
}

/* ---- hedgerows ----------------------------------------------------------------------------------- */

static const double beside_track_m = 2.8; /* middle of a hedgerow from the border, where a track runs along that */

static HedgeHeight height_of(uint64_t hedge)
{
    const double u = invented_unit(invented_hash(hedge, 10, 0));
    return u < 0.45 ? HEDGE_CUT : u < 0.8 ? HEDGE_SHRUBS : HEDGE_TREES;
}

/* The place is beside a track, where there is one, on the square's side of it. */
bool hedge_in_square(HedgePlace *out, uint64_t seed, int64_t i, int64_t j, double spacing_m)
{
    double x = ((double)i + 0.5) * spacing_m, y = ((double)j + 0.5) * spacing_m;
    for (int step = 0; step < 4; step++) { /* the plane is bent, so the step towards the border is repeated */
        PlotBorder border;
        double     away[2];
        if (!plot_border_about(&border, away, &out->hedge, seed, x, y) || !border.hedge) return false;
        const double to_go_m = (border.track ? beside_track_m : 0) - border.away_m;
        if (fabs(to_go_m) > 1.5 * spacing_m + beside_track_m) return false;
        x += to_go_m * away[0], y += to_go_m * away[1];
    }
    out->x_m = x, out->y_m = y, out->height = height_of(out->hedge);
    return (int64_t)floor(x / spacing_m) == i && (int64_t)floor(y / spacing_m) == j;
}
