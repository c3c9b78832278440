/* tests/bench/sensor/woods_errors.c: how the pictures of far plants differ from full detail, in a piece about the
 * middle of each view.
 *
 * Both are rendered with one ray a pixel, with 16 and with 36. The grids of the latter two have no ray in common, so
 * with full detail F and the judged representation T the mean of (T16 - F16)(T36 - F36) is the squared difference of
 * what the two are with any number of rays, without the noise of either: the structural error. In the same way (X -
 * F16)(X - F36) is the squared error of one ray X, and the mean product of T16 and T36 at a distance the true
 * correlation. */
#include "tests/bench/sensor/woods_private.h"

enum { sets = 3 /* of rays: one, 16, 36 */, tiles_most = 24, lags_most = most_lags };
static const int set_samples[sets] = {1, 4, 6};
/* The piece, of the picture's sides, and its tiles; quick and full. */
static const double piece_share[2] = {0.2, 0.4};
static const int    tile_side[2] = {16, 48};

/* Columns of the sums of a tile. */
typedef enum TileSum {
    SUM_FULL, /* means of 16 and 36 rays */
    SUM_JUDGED,
    SUM_JUDGED_ONE, /* of one ray, whose texels are wider */
    SUM_ONE_4,      /* squared error of one ray over blocks of 4 px: full, judged; of 8 px */
    SUM_ONE_8 = SUM_ONE_4 + woods_details,
    SUM_STRUCTURE_1 = SUM_ONE_8 + woods_details, /* structural, over blocks of 1, 4, 8 px */
    SUM_STRUCTURE_4,
    SUM_STRUCTURE_8,
    SUM_CONTRAST, /* variance of one-ray pixels: full, judged */
    SUM_LAGS = SUM_CONTRAST + woods_details,
    TILE_SUMS = SUM_LAGS + woods_details * lags_most
} TileSum;

typedef enum Figure {
    FIGURE_BIAS,
    FIGURE_BIAS_ONE,
    FIGURE_ONE_4, /* of the judged over that of full detail */
    FIGURE_ONE_8,
    FIGURE_STRUCTURE_1,
    FIGURE_STRUCTURE_4,
    FIGURE_STRUCTURE_8,
    FIGURE_CONTRAST_ONE,
    FIGURE_CONTRAST,
    FIGURE_LENGTH,
} Figure;

typedef struct PlaneErrors {
    const double *of; /* [tiles][TILE_SUMS] */
    int           tiles, lags;
    Figure        figure;
} PlaneErrors;

/* Differences and roots in % of the mean in full detail, ratios as they are. */
static double figure_of(const void *user, int without)
{
    const PlaneErrors *p = user;
    double             s[TILE_SUMS];
    group_sums(s, p->of, p->tiles, TILE_SUMS, without);
    const double  tiles = p->tiles - (without >= 0), per_mean = 100 * tiles / s[SUM_FULL];
    const double *full = s + SUM_LAGS, *judged = full + lags_most;
    switch (p->figure) {
    case FIGURE_BIAS:
        return 100 * (s[SUM_JUDGED] / s[SUM_FULL] - 1);
    case FIGURE_BIAS_ONE:
        return 100 * (s[SUM_JUDGED_ONE] / s[SUM_FULL] - 1);
    case FIGURE_ONE_4:
        return sqrt(s[SUM_ONE_4 + 1] / s[SUM_ONE_4]);
    case FIGURE_ONE_8:
        return sqrt(s[SUM_ONE_8 + 1] / s[SUM_ONE_8]);
    case FIGURE_STRUCTURE_1:
        return signed_root(s[SUM_STRUCTURE_1] / tiles) * per_mean;
    case FIGURE_STRUCTURE_4:
        return signed_root(s[SUM_STRUCTURE_4] / tiles) * per_mean;
    case FIGURE_STRUCTURE_8:
        return signed_root(s[SUM_STRUCTURE_8] / tiles) * per_mean;
    case FIGURE_CONTRAST_ONE:
        return 100 * (sqrt(s[SUM_CONTRAST + 1] / s[SUM_CONTRAST]) - 1);
    case FIGURE_CONTRAST:
        return 100 * (sqrt(judged[0] / full[0]) - 1);
    case FIGURE_LENGTH:
        return 100 * (correlation_length(judged, p->lags) / correlation_length(full, p->lags) - 1);
    }
    return NAN;
}

/* ---- sums over tiles ------------------------------------------------------------------------------ */

typedef struct Pieces {
    WoodsFrame frame[woods_details][sets];
    PlaneTile  tile[tiles_most];
    int        tiles, lags;
} Pieces;

static const float *plane_of(const Pieces *p, int detail, int set, int plane)
{
    return picture_plane(&p->frame[detail][set].frame.picture, plane);
}

static void sum_tile(double *s, const Pieces *p, const PlaneTile *tile, int plane)
{
    const float *one[woods_details], *some[woods_details], *many[woods_details];
    for (int d = 0; d < woods_details; d++) {
        one[d] = plane_of(p, d, 0, plane), some[d] = plane_of(p, d, 1, plane), many[d] = plane_of(p, d, 2, plane);
        s[SUM_FULL + d] = 0.5 * (tile_mean(tile, some[d]) + tile_mean(tile, many[d]));
        s[SUM_ONE_4 + d] = tile_product(tile, 4, one[d], some[0], one[d], many[0]);
        s[SUM_ONE_8 + d] = tile_product(tile, 8, one[d], some[0], one[d], many[0]);
        tile_lags(&s[SUM_CONTRAST + d], 1, tile, one[d], one[d]);
        tile_lags(&s[SUM_LAGS + d * lags_most], p->lags, tile, some[d], many[d]);
    }
    s[SUM_JUDGED_ONE] = tile_mean(tile, one[1]);
    s[SUM_STRUCTURE_1] = tile_product(tile, 1, some[1], some[0], many[1], many[0]);
    s[SUM_STRUCTURE_4] = tile_product(tile, 4, some[1], some[0], many[1], many[0]);
    s[SUM_STRUCTURE_8] = tile_product(tile, 8, some[1], some[0], many[1], many[0]);
}

/* ---- rows ----------------------------------------------------------------------------------------- */

/* Kelvins of a hundredth of the mean radiance at that mean; 0: of an optical plane. */
static double kelvin_per_percent(const WoodsBench *w, int plane, double mean)
{
    if (plane != picture_mwir && plane != picture_lwir) return 0;
    const PlanckTable *planck = plane == picture_mwir ? w->scene.world.planck_mwir : w->scene.world.planck_lwir;
    return planck_table_temp(planck, 1.005 * mean) - planck_table_temp(planck, 0.995 * mean);
}

typedef struct PlaneRows {
    WoodsBench *w;
    int         v, plane;
    PlaneErrors errors;
    double      sum[TILE_SUMS], mean, k; /* k: K of a % */
} PlaneRows;

static Estimate estimate(PlaneRows *r, Figure figure)
{
    r->errors.figure = figure;
    return group_estimate(figure_of, &r->errors, r->errors.tiles);
}

static void judge(PlaneRows *r, const char *figure, Estimate value, WoodsLimit limit, const char *text)
{
    char what[what_size];
    snprintf(what, sizeof what, "%s: %s, %s: %s", woods_pose[r->v].name, woods_detail[1], woods_plane[r->plane],
             figure);
    woods_judge(r->w, what, value, limit, text);
}

/* Roots of sums as % of the mean. */
static double percent(const PlaneRows *r, int sum)
{
    return 100 * signed_root(r->sum[sum] / r->errors.tiles) / r->mean;
}

static void judge_one_ray(PlaneRows *r)
{
    char text[160];
    for (int k = 0; k < 2; k++) {
        const int    sum = k ? SUM_ONE_8 : SUM_ONE_4;
        const double full = percent(r, sum), judged = percent(r, sum + 1);
        int at = snprintf(text, sizeof text, "rms over that in full detail, reference's noise out; %.3g / %.3g %%",
                          judged, full);
        if (r->k > 0) snprintf(text + at, sizeof text - (size_t)at, " = %.2g / %.2g K", judged * r->k, full * r->k);
        judge(r, k ? "one ray, blocks of 8 px" : "one ray, blocks of 4 px",
              estimate(r, k ? FIGURE_ONE_8 : FIGURE_ONE_4), (WoodsLimit){1, "x", false}, text);
    }
}

static void judge_structure(PlaneRows *r)
{
    char     text[160];
    Estimate error = estimate(r, FIGURE_STRUCTURE_4);
    snprintf(text, sizeof text, "noise of both out; %.3g %%; blocks of 1, 8 px: %.3g, %.3g %%", error.value,
             estimate(r, FIGURE_STRUCTURE_1).value, estimate(r, FIGURE_STRUCTURE_8).value);
    if (r->k > 0) error.value *= r->k, error.se *= r->k;
    judge(r, "structural error, blocks of 4 px", error,
          r->plane == picture_lwir   ? (WoodsLimit){0.15, "K", false}
          : r->plane == picture_mwir ? (WoodsLimit){NAN, "K", false}
                                     : (WoodsLimit){10, "%", false},
          text);
}

static void judge_plane(PlaneRows *r)
{
    static const WoodsLimit alike = {15, "%", false};
    char                    text[160];
    const double           *full = r->sum + SUM_LAGS, *judged = full + lags_most;
    const int               lags = r->errors.lags;
    const Estimate          bias = estimate(r, FIGURE_BIAS);
    if (r->k > 0) snprintf(text, sizeof text, "16 and 36 rays, both; %+.3g K", bias.value * r->k);
    else snprintf(text, sizeof text, "16 and 36 rays, both");
    judge(r, "mean", bias, (WoodsLimit){1, "%", false}, text);
    judge(r, "mean, one ray", estimate(r, FIGURE_BIAS_ONE), (WoodsLimit){1, "%", false},
          "beside 16 and 36 rays in full detail");
    judge_one_ray(r);
    judge_structure(r);
    snprintf(text, sizeof text, "deviation within tiles; %.3g / %.3g %% of the mean", percent(r, SUM_CONTRAST + 1),
             percent(r, SUM_CONTRAST));
    judge(r, "contrast of a pixel, one ray", estimate(r, FIGURE_CONTRAST_ONE), alike, text);
    snprintf(text, sizeof text, "noise out; %.3g / %.3g %% of the mean", percent(r, SUM_LAGS + lags_most),
             percent(r, SUM_LAGS));
    judge(r, "contrast of a pixel", estimate(r, FIGURE_CONTRAST), alike, text);
    snprintf(text, sizeof text, "to 1/e, noise out; %.2f / %.2f px", correlation_length(judged, lags),
             correlation_length(full, lags));
    judge(r, "autocorrelation length", estimate(r, FIGURE_LENGTH), alike, text);
}

static Status judge_planes(WoodsBench *w, int v, const Pieces *p)
{
    Arena  *arena = w->arena[0]; /* not that of a piece */
    double *of = arena_alloc(arena, (size_t)p->tiles * TILE_SUMS, sizeof *of);
    if (!of) return STATUS_NO_MEMORY;
    for (int b = 0; b < woods_bands; b++) {
        PlaneRows r = {w, v, woods_band_plane[b], {of, p->tiles, p->lags, FIGURE_BIAS}, {0}, 0, 0};
        for (int t = 0; t < p->tiles; t++) sum_tile(of + (size_t)t * TILE_SUMS, p, &p->tile[t], r.plane);
        group_sums(r.sum, of, p->tiles, TILE_SUMS, -1);
        r.mean = r.sum[SUM_FULL] / p->tiles;
        r.k = kelvin_per_percent(w, r.plane, r.mean);
        judge_plane(&r);
    }
    return STATUS_OK;
}

/* Rows of the pixel's error in every plane but radar's, which is of few pixels: one ray beside 16, and the same 16 rays
 * in both. */
static void say_planes(WoodsBench *w, int v, const Pieces *p)
{
    for (int k = 0; k < woods_details + 1; k++)
        for (int plane = 0; plane < picture_radar; plane++) {
            const bool   paired = k == woods_details;
            const float *got = paired ? plane_of(p, 1, 1, plane) : plane_of(p, k, 0, plane),
                        *want = plane_of(p, 0, 1, plane);
            double square[2] = {0}, mean[2] = {0};
            char   what[what_size], text[160];
            if (!got || !want) continue;
            for (int t = 0; t < p->tiles; t++) {
                square[0] += tile_product(&p->tile[t], 1, got, want, got, want);
                square[1] += tile_product(&p->tile[t], 8, got, want, got, want);
                mean[0] += tile_mean(&p->tile[t], got), mean[1] += tile_mean(&p->tile[t], want);
            }
            const double per_mean = 100 * p->tiles / mean[1];
            snprintf(what, sizeof what, "%s: %s%s, %s", woods_pose[v].name, paired ? "" : "one ray, ",
                     woods_detail[paired ? 1 : k], woods_plane[plane]);
            snprintf(text, sizeof text, "rms, %s; blocks of 8 px: %.2g %%; mean: %+.2g %%",
                     paired ? "the same 16 rays, both" : "16 rays a pixel in full detail",
                     sqrt(square[1] / p->tiles) * per_mean, 100 * (mean[0] / mean[1] - 1));
            BenchRow row = bench_row(what);
            row.error = sqrt(square[0] / p->tiles) * per_mean;
            row.error_unit = "%";
            row.against = text;
            bench_add(w->bench, &row);
        }
}

/* ---- cover ---------------------------------------------------------------------------------------- */

typedef struct Cover {
    const double *of; /* [tiles][woods_details] pixels that show a standing plant */
    int           tiles;
} Cover;

static double cover_off(const void *user, int without)
{
    const Cover *c = user;
    double       s[woods_details];
    group_sums(s, c->of, c->tiles, woods_details, without);
    return s[1] > 0 || s[0] > 0 ? 100 * (s[1] / s[0] - 1) : 0;
}

static void judge_cover(WoodsBench *w, int v, const Pieces *p)
{
    double of[tiles_most * woods_details] = {0}, all = 0;
    Cover  cover = {of, p->tiles};
    char   what[what_size], text[160];
    for (int t = 0; t < p->tiles; t++)
        for (int d = 0; d < woods_details; d++) {
            const PlaneTile *tile = &p->tile[t];
            const uint32_t  *instance = p->frame[d][0].frame.picture.instance;
            for (int i = 0; i < tile->side * tile->side; i++)
                of[t * woods_details + d] +=
                    woods_is_standing(instance[(tile->y0 + i / tile->side) * tile->width + tile->x0 + i % tile->side]);
            all += d == 0 ? of[t * woods_details] : 0;
        }
    snprintf(what, sizeof what, "%s: %s: cover", woods_pose[v].name, woods_detail[1]);
    snprintf(text, sizeof text, "pixels of standing plants, one ray, both; %.4g %% in full detail",
             100 * all / p->tiles / p->tile[0].side / p->tile[0].side);
    woods_judge(w, what, group_estimate(cover_off, &cover, p->tiles), (WoodsLimit){0.5, "%", false}, text);
}

/* ---- the piece ------------------------------------------------------------------------------------ */

static Status render_pieces(WoodsBench *w, int v, Pieces *p, Arena *arena[woods_details][sets])
{
    const bool quick = bench_quick(w->bench);
    for (int d = 0; d < woods_details; d++)
        for (int k = 0; k < sets; k++) {
            RenderRequest request = woods_request(w, v, set_samples[k]);
            request.bands &= three_bands;
            request.view.width = (int)(piece_share[!quick] * request.view.width);
            request.view.height = (int)(piece_share[!quick] * request.view.height);
            p->frame[d][k] = woods_frame(w, d, &request, w->many, arena[d][k]);
            woods_render(&p->frame[d][k]);
            if (p->frame[d][k].frame.status != STATUS_OK) return p->frame[d][k].frame.status;
        }
    const View *view = &p->frame[0][0].frame.request.view;
    const int   side = tile_side[!quick];
    p->tiles = plane_tiles(p->tile, tiles_most, view->width, view->height, side);
    p->lags = side - 1 < lags_most ? side - 1 : lags_most; /* past the mean of the tile they fall below 0 */
    return p->tiles > 0 ? STATUS_OK : STATUS_BAD_VALUE;
}

Status woods_errors(WoodsBench *w, int v)
{
    Pieces pieces;
    Arena *arena[woods_details][sets] = {{NULL}};
    Status status = STATUS_OK;
    arena_reset(w->arena[0]);
    for (int k = 0; k < woods_details * sets && status == STATUS_OK; k++)
        if (!(arena[k / sets][k % sets] = arena_create())) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = render_pieces(w, v, &pieces, arena);
    if (status == STATUS_OK) {
        say_planes(w, v, &pieces);
        judge_cover(w, v, &pieces);
        status = judge_planes(w, v, &pieces);
    }
    for (int k = 0; k < woods_details * sets; k++) arena_destroy(arena[k / sets][k % sets]);
    return status;
}
