/* sensor/truth/frame_error.c: errors of a frame: their spread over pixels, the budget by source, and the budget of a
 * radar's map. */
#include "sensor/truth/frame_error.h"
#include "render/heat/vehicle_heat.h"
#include "dis/pdu/pdu.h"
#include "render/frame/render.h"
#include "render/scattering/signatures/signature.h"

/* ---- the spread of errors over pixels, and what a displaced target does to those near it --------- */

static const double least_k = 1e-4;
enum { most_px = 1024, way_most_px = 256 };

void error_spread_add(ErrorSpread *s, double square_k2, double px)
{
    const double decades = square_k2 > least_k * least_k ? 0.5 * log10(square_k2) - log10(least_k) : 0;
    s->px[(int)clamp(decades * error_bins_a_decade, 0, error_bins - 1)] += px;
    s->all_px += px;
    s->beyond_px += square_k2 > 0 ? px * erfc(1 / sqrt(2 * square_k2)) : 0;
    s->squares_px_k2 += px * square_k2;
}

void error_spread_join(ErrorSpread *s, const ErrorSpread *more)
{
    for (int i = 0; i < error_bins; i++) s->px[i] += more->px[i];
    s->all_px += more->all_px;
    s->beyond_px += more->beyond_px;
    s->squares_px_k2 += more->squares_px_k2;
}

double error_spread_median_k(const ErrorSpread *s)
{
    double below = 0;
    int    bin = 0;
    if (!(s->all_px > 0)) return NAN;
    while (bin < error_bins - 1 && below + s->px[bin] < 0.5 * s->all_px) below += s->px[bin++];
    /* less than half is below it, so it holds some */
    const double within = clamp((0.5 * s->all_px - below) / s->px[bin], 0, 1);
    return bin == 0 ? 0 : least_k * pow(10, (bin + within) / error_bins_a_decade);
}

double error_spread_rms_k(const ErrorSpread *s) { return s->all_px > 0 ? sqrt(s->squares_px_k2 / s->all_px) : NAN; }
double error_spread_beyond(const ErrorSpread *s) { return s->all_px > 0 ? s->beyond_px / s->all_px : NAN; }

static double heat_k2(const DisplacedTarget *of, size_t at)
{
    const double temp_k = of->picture->temp_k ? (double)of->picture->temp_k[at] : NAN;
    if (!isfinite(temp_k) || !isfinite(of->air_k)) return 0;
    const double k = vehicle_heat_error_k(temp_k, of->air_k);
    return k * k;
}

void error_spread_of_displaced(ErrorSpread *touched, ErrorSpread *own, const DisplacedTarget *of)
{
    static const int way[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const Picture   *p = of->picture;
    const uint32_t   id = (uint32_t)of->index + 1;
    const int        d = (int)clamp(rint(of->way_px), 1, way_most_px);
    const double     shorter = fmin(of->way_px, 1) * fmin(of->way_px, 1); /* below a pixel as its square */
    const int       *b = of->px->box;
    const int        x0 = b[0] > d ? b[0] - d : 0, x1 = b[2] + d < p->width ? b[2] + d : p->width;
    const int        y0 = b[1] > d ? b[1] - d : 0, y1 = b[3] + d < p->height ? b[3] + d : p->height;
    const double     area = (double)(x1 - x0) * (y1 - y0);
    const int        step = area > most_px ? (int)ceil(sqrt(area / most_px)) : 1;
    for (int y = y0 + step / 2; y < y1; y += step)
        for (int x = x0 + step / 2; x < x1; x += step) {
            const size_t at = (size_t)y * (size_t)p->width + (size_t)x;
            const double here = pixel_share_of(p, of->px, id, at);
            double       here_k = NAN, sum = 0;
            int          count = 0;
            bool         any = here > 0;
            for (int k = 0; k < 4; k++) {
                const int to_x = x + d * way[k][0], to_y = y + d * way[k][1];
                if (to_x < 0 || to_x >= p->width || to_y < 0 || to_y >= p->height) continue;
                const size_t to = (size_t)to_y * (size_t)p->width + (size_t)to_x;
                count++;
                if (!(here > 0) && !(pixel_share_of(p, of->px, id, to) > 0)) continue; /* ground, which stays */
                if (isnan(here_k)) here_k = planck_table_temp(of->planck, (double)of->value[at]);
                const double apart_k = planck_table_temp(of->planck, (double)of->value[to]) - here_k;
                any = true;
                sum += apart_k * apart_k;
            }
            if (!any) continue;
            const double square = of->further_k2 + (count > 0 ? shorter * sum / count : 0) +
                                  (here > 0 ? here * here * heat_k2(of, at) : 0);
            error_spread_add(touched, square, (double)step * step);
            if (here > 0) error_spread_add(own, square, here * step * step);
        }
}

/* ---- the budget of a frame: the estimates of the renderer, and what only the node knows ---------- */

/* Rows of a target are subsampled to about this many pixels at most. */
enum { target_most_px = 4096 };

/* Sums over the pixels of one target in one plane. One is of squared differences between neighbours of which at least
 * one is the target's, less those of the ground alone, which are estimated from the surrounding ground. The other is of
 * squared differences of its pixels from the mean of the surroundings. */
typedef struct Outline {
    double steps, apart;
} Outline;

static double square(double x) { return x * x; }

typedef struct Steps {
    /* squared differences with the target and without; squared shares of ground with */
    double on, ground, ground_pairs, ground_visible;
} Steps;

static void add_step(Steps *s, double share_a, double share_b, double step)
{
    if (share_a > 0 || share_b > 0) {
        s->on += square(step);
        s->ground_visible += square(1 - share_a) + square(1 - share_b);
    } else {
        s->ground += square(step);
        s->ground_pairs++;
    }
}

static Outline outline_of(const Picture *p, const TargetPixels *px, int index, const float *value)
{
    const int box[4] = {px->box[0] > 0 ? px->box[0] - 1 : 0, px->box[1] > 0 ? px->box[1] - 1 : 0,
                        px->box[2] < p->width ? px->box[2] + 1 : p->width,
                        px->box[3] < p->height ? px->box[3] + 1 : p->height};
    const int      area = (box[2] - box[0]) * (box[3] - box[1]), stride = 1 + area / target_most_px;
    const uint32_t id = (uint32_t)index + 1;
    Outline        o = {0, 0};
    Steps          s = {0, 0, 0, 0};
    double         ring = 0, ring_px = 0, sum = 0, sum_2 = 0, on_px = 0;
    for (int y = box[1]; y < box[3]; y += stride)
        for (int x = box[0]; x < box[2]; x++) {
            const size_t at = (size_t)y * (size_t)p->width + (size_t)x, right = at + 1, below = at + (size_t)p->width;
            const double on = pixel_share_of(p, px, id, at);
            if (on > 0) sum += value[at], sum_2 += square(value[at]), on_px++;
            else ring += value[at], ring_px++;
            if (x + 1 < p->width)
                add_step(&s, on, pixel_share_of(p, px, id, right), (double)value[right] - (double)value[at]);
            if (y + 1 < p->height)
                add_step(&s, on, pixel_share_of(p, px, id, below), (double)value[below] - (double)value[at]);
        }
    const double mean = ring_px > 0 ? ring / ring_px : on_px > 0 ? sum / on_px : 0;
    o.apart = fmax(sum_2 - 2 * mean * sum + mean * mean * on_px, 0);
    o.steps = fmax(s.on - (s.ground_pairs > 0 ? 0.5 * s.ground / s.ground_pairs * s.ground_visible : 0), 0) * stride;
    o.apart *= stride;
    return o;
}

/* Squared error over the image when it is displaced by way_px pixels: below a pixel it grows with the square of the
 * displacement, beyond with the swept area; it is at most that of a target at an unrelated position. */
static double shifted(const Outline *o, double way_px)
{
    const double swept = o->steps * way_px * way_px / (2 + 0.5 * pi_rad * way_px), most = 2 * o->apart;
    return swept > 0 && most > 0 ? swept * most / (swept + most) : 0;
}

static Band band_of(int plane)
{
    return plane == picture_mwir    ? BAND_MWIR
           : plane == picture_lwir  ? BAND_LWIR
           : plane == picture_radar ? BAND_RADAR
                                    : BAND_OPTICAL;
}

/* How far the ground's error moves a target on the image: it displaces and tilts a clamped entity. It is taken from the
 * errors of the ground at four points, at half the entity's radius from its centre. */
static double ground_way_m(const World *world, const SnapshotEntity *e, const Model *model)
{
    static const double place[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double              p_enu[3], turn_enu[3], rise_m[4];
    const double        half_m = 0.5 * model->radius_m;
    if (!world->landscape || e->type.kind != dis_kind_platform || e->type.domain != dis_domain_land) return 0;
    enu_from_ecef(p_enu, &world->frame, e->p_ecef);
    for (int k = 0; k < 4; k++)
        if (!render_error_coarser(turn_enu, &rise_m[k], &world->landscape->elevation, p_enu[0] + half_m * place[k][0],
                                  p_enu[1] + half_m * place[k][1]))
            return 0;
    /* the mean error of the points raises its centre; their differences tilt its outline, at the same distance from
     * the centre */
    const double mean_m = 0.25 * (rise_m[0] + rise_m[1] + rise_m[2] + rise_m[3]);
    const double lean_m = 0.5 * hypot(rise_m[0] - rise_m[1], rise_m[2] - rise_m[3]);
    return hypot(mean_m, lean_m);
}

/* Squared error of temperature that ground, plants and parts have by the steps, elements and facets of their heat: mean
 * over all pixels, K2. Targets smaller than a pixel count with the share that they cover. */
static double mean_heat_k2(const Picture *p, const Snapshot *snapshot, double air_k)
{
    const size_t pixels = (size_t)p->width * (size_t)p->height;
    double       sum = 0;
    if (!p->temp_k || !isfinite(air_k)) return 0;
    for (size_t i = 0; i < pixels; i++) {
        const double temp_k = (double)p->temp_k[i];
        const int    entity = (int)p->entity[i] - 1;
        if (!isfinite(temp_k)) continue;
        if (entity < 0) sum += square(0.03 + 0.005 * fabs(temp_k - air_k));
        else if (entity < snapshot->count && snapshot->entity[entity].first_patch >= 0)
            sum += square((p->covered && p->covered[i] > 0 ? (double)p->covered[i] : 1) *
                          vehicle_heat_error_k(temp_k, air_k));
    }
    return sum / (double)pixels;
}

/* ---- pixel by pixel ------------------------------------------------------------------------------ */

static void error_of_target(ErrorSpread *all, Target *t, const DisplacedTarget *of, Band band)
{
    ErrorSpread own = {0};
    error_spread_of_displaced(all, &own, of);
    t->band[band].error_rms_k = error_spread_rms_k(&own);
    t->band[band].error_median_k = error_spread_median_k(&own);
}

/* Adds the error of the pixels that no displaced target touches. It is that of the probes, which stand for pixels whose
 * own samples say nothing; the sum of squares of the others is spread over them as an exponential distribution, taken
 * in nine steps. further_k2: a squared error that all of them have besides. */
static void error_of_the_rest(ErrorSpread *all, const ErrorBudget *budget, int plane, double pixels, double kelvin,
                              double further_k2)
{
    enum { steps = 9 };
    const float *square_w = budget->probe_square[plane - picture_mwir];
    const double rest = fmax(pixels - all->all_px, 0) / pixels;
    double       asked = 0;
    for (int i = 0; i < budget->probes; i++)
        if (!isnan(square_w[i])) asked += budget->probe_px[i];
    const double most = asked > pixels ? pixels / asked : 1, refined = fmax(pixels - asked, 0);
    for (int i = 0; i < budget->probes; i++)
        if (!isnan(square_w[i]))
            error_spread_add(all, square(kelvin) * (double)square_w[i] + further_k2, rest * most * budget->probe_px[i]);
    if (!(refined > 0)) return;
    const double mean_k2 = square(kelvin) * budget->refined_square[plane - picture_mwir] / refined;
    for (int i = 0; i < steps; i++)
        error_spread_add(all, -log(1 - (i + 0.5) / steps) * mean_k2 + further_k2, rest * refined / steps);
}

/* A plane's errors of all targets: sums of squares over the image, and pixel by pixel in a thermal plane. */
typedef struct PlaneOf {
    const Picture     *picture;
    const World       *world;
    const Snapshot    *snapshot;
    double             focal_px, sag_m, air_k;
    bool               clamped;
    Band               band;
    const float       *value;
    const PlanckTable *planck; /* NULL: not thermal */
    double             tables_k2;
} PlaneOf;

typedef struct PlaneSums {
    double      drift, facets;
    ErrorSpread spread;
} PlaneSums;

static void add_target(PlaneSums *sums, Target *t, const PlaneOf *of)
{
    const SnapshotEntity *e = &of->snapshot->entity[t->index];
    const TargetPixels   *px = &of->picture->target[t->index];
    if (!(px->visible > 0) || !(t->range_m > 0)) return;
    const double  per_m = of->focal_px / t->range_m;
    const Model  *model = catalog_model(of->world->catalog, e->model);
    const Outline o = outline_of(of->picture, px, t->index, of->value);
    /* two of three directions of a displacement in space are visible; a rotation moves the outline by half the radius,
     * in the mean */
    const double way_m = hypot(sqrt(2.0 / 3) * e->drift_m, 0.5 * model->radius_m * e->drift_rad);
    const double ground_m = of->clamped ? ground_way_m(of->world, e, model) : 0;
    const double still_m = hypot(2.0 / 3 * of->sag_m, ground_m);
    sums->drift += shifted(&o, way_m * per_m);
    sums->facets += shifted(&o, still_m * per_m);
    t->error_px = hypot(way_m, still_m) * per_m;
    if (!of->planck) return;
    const DisplacedTarget displaced = {.picture = of->picture,
                                       .px = px,
                                       .index = t->index,
                                       .value = of->value,
                                       .planck = of->planck,
                                       .way_px = t->error_px,
                                       .further_k2 = of->tables_k2,
                                       .air_k = e->first_patch >= 0 ? of->air_k : NAN};
    error_of_target(&sums->spread, t, &displaced, of->band);
}

static void plants_of_bands(FrameError *out, const ErrorBudget *budget)
{
    const PlantPrice *plants = &budget->plants;
    double            bias[BAND_COUNT] = {0}, se[BAND_COUNT] = {0}, square[BAND_COUNT] = {0};
    int               planes[BAND_COUNT] = {0};
    out->plants = *plants;
    for (int k = 0; k < picture_plane_count && plants->rays > 0; k++) {
        const Band b = band_of(k);
        if (!(budget->mean[k] > 0)) continue;
        bias[b] += plants->bias[k] / budget->mean[k];
        se[b] += plants->bias_se[k] / budget->mean[k]; /* as if channels went together, which they nearly do */
        square[b] += (plants->rms[k] / budget->mean[k]) * (plants->rms[k] / budget->mean[k]);
        planes[b]++;
    }
    for (int b = 0; b < BAND_COUNT; b++) {
        out->plants_bias[b] = planes[b] > 0 ? bias[b] / planes[b] : NAN;
        out->plants_bias_se[b] = planes[b] > 0 ? se[b] / planes[b] : NAN;
        out->plants_rms[b] = planes[b] > 0 ? sqrt(square[b] / planes[b]) : NAN;
    }
}

bool frame_error(FrameError *out, const FrameErrorOf *of, Target *target, int targets)
{
    const Picture     *picture = of->picture;
    const World       *world = of->world;
    const ErrorBudget *budget = picture->budget;
    const double       pixels = (double)picture->width * picture->height;
    double             sums[BAND_COUNT][error_sources] = {{0}};
    int                planes[BAND_COUNT] = {0};
    if (!budget || !picture->entity || !picture->target) return false;
    for (int b = 0; b < BAND_COUNT; b++) out->median_k[b] = out->beyond_1k[b] = NAN;
    plants_of_bands(out, budget);
    for (int k = 0; k < picture_plane_count; k++) {
        const Band         b = band_of(k);
        const PlanckTable *planck = b == BAND_MWIR ? world->planck_mwir : b == BAND_LWIR ? world->planck_lwir : NULL;
        PlaneOf            in = {.picture = picture,
                                 .world = world,
                                 .snapshot = of->snapshot,
                                 .focal_px = of->request->view.focal_px,
                                 .sag_m = of->sag_m,
                                 .air_k = of->air_k,
                                 .clamped = of->clamped,
                                 .band = b,
                                 .value = picture_plane(picture, k),
                                 .planck = planck};
        PlaneSums          all = {0};
        if (!in.value || !(budget->mean[k] > 0)) continue;
        const double kelvin = planck ? render_error_kelvin(planck, budget->mean[k], 1) : NAN; /* for 1 W/(m2 sr) */
        in.tables_k2 = square(kelvin * budget->tables[k]);
        for (int i = 0; i < targets; i++) add_target(&all, &target[i], &in);
        const double square_of_mean = square(budget->mean[k]);
        const double all_heat_k2 = kelvin > 0 ? mean_heat_k2(picture, of->snapshot, of->air_k) : 0;
        const double heat = kelvin > 0 ? all_heat_k2 / square(kelvin) : 0;
        const double squares[ERROR_TOTAL] = {square(budget->sampling[k]),
                                             square(budget->level_of_detail[k]) + all.facets / pixels,
                                             square(budget->tables[k]), heat, all.drift / pixels};
        for (int s = 0; s < ERROR_TOTAL; s++) {
            sums[b][s] += squares[s] / square_of_mean;
            sums[b][ERROR_TOTAL] += squares[s] / square_of_mean;
        }
        planes[b]++;
        if (!planck) continue;
        error_of_the_rest(&all.spread, budget, k, pixels, kelvin, in.tables_k2 + all_heat_k2);
        out->median_k[b] = error_spread_median_k(&all.spread);
        out->beyond_1k[b] = error_spread_beyond(&all.spread);
    }
    for (int b = 0; b < BAND_COUNT; b++) {
        const int          plane = b == BAND_MWIR ? picture_mwir : picture_lwir;
        const PlanckTable *planck = b == BAND_MWIR ? world->planck_mwir : world->planck_lwir;
        for (int s = 0; s < error_sources; s++) {
            out->share[b][s] = planes[b] > 0 ? sqrt(sums[b][s] / planes[b]) : NAN;
            out->kelvin[b][s] =
                planes[b] > 0 && (b == BAND_MWIR || b == BAND_LWIR)
                    ? render_error_kelvin(planck, budget->mean[plane], out->share[b][s] * budget->mean[plane])
                    : NAN;
        }
    }
    return true;
}

/* ---- the budget of a radar's map ----------------------------------------------------------------- */

enum { weights = 256 }; /* of a window of any length: its shape */

double radar_error_of_gridding(void) { return 1.5e-4; }

/* 2 (1 - rho): rho is the response's correlation with itself, the transform of the squared weights. */
static double radar_error_of_moving(const RadarPreset *preset, double cells)
{
    double w[weights], sum = 0, all = 0;
    if (!(cells > 0) || window_weights(w, weights, &preset->range_window) != STATUS_OK) return 0;
    for (int i = 0; i < weights; i++) {
        sum += w[i] * w[i] * cos(2 * pi_rad * cells * (i - 0.5 * (weights - 1)) / weights);
        all += w[i] * w[i];
    }
    return 2 * (1 - fabs(sum) / all);
}

/* Squared error over the square of the field, from a standard deviation of the cross section in dB
 * (signature_error_db). */
static double square_of_db(double db)
{
    const double root = pow(10, 0.1 * db) - 1;
    return 0.5 * root * root;
}

static double map_energy(const RangeDoppler *map)
{
    double sum = 0; /* of the sum channel, which is the first */
    for (size_t i = 0; i < (size_t)map->rows * (size_t)map->columns; i++) sum += scatter_power(map->cell[i]);
    return sum;
}

void radar_error(RadarError *out, const RadarFrame *r, const Snapshot *snapshot)
{
    const double cells_error = signature_cells_error();
    const double noise_w = r->receiver.noise_w * r->map.noise_share, all = map_energy(&r->map);
    /* a point's response has the energy of its peak times the windows' equivalent noise bandwidths, in cells */
    const double cells = r->map.noise_share * r->map.rows * r->map.columns;
    double       squares[error_sources] = {0}, own = 0, total = 0;
    for (int i = 0; i < r->targets; i++) {
        const RadarTruth *t = &r->target[i];
        const double      energy = t->snr * noise_w * cells;
        if (!(energy > 0)) continue;
        squares[ERROR_DEAD_RECKONING] +=
            energy *
            radar_error_of_moving(r->preset, snapshot->entity[t->entity].drift_m / sqrt(3) / r->map.metre_per_column);
        const double error_db = t->rcs_error_db[r->preset->transmits_h ? 0 : 1];
        if (isnan(error_db)) continue; /* a given signature */
        own += energy;
        squares[ERROR_SAMPLING] += energy * square_of_db(error_db);
        squares[ERROR_LEVEL_OF_DETAIL] += energy * cells_error;
    }
    squares[ERROR_TABLES] = all * radar_error_of_gridding() * radar_error_of_gridding();
    for (int s = 0; s < ERROR_TOTAL; s++) {
        squares[ERROR_TOTAL] += squares[s];
        total += s == ERROR_DEAD_RECKONING || s == ERROR_TABLES ? 0 : squares[s];
    }
    for (int s = 0; s < error_sources; s++) {
        const double of_field = s == ERROR_TABLES  ? radar_error_of_gridding()
                                : s == ERROR_TOTAL ? hypot(sqrt(total / own), radar_error_of_gridding())
                                                   : sqrt(squares[s] / own);
        out->share[s] = all > 0 ? sqrt(squares[s] / all) : NAN;
        out->db[s] = own > 0 ? 10 * log10(1 + sqrt(2) * of_field) : NAN;
    }
    out->share[ERROR_HEAT] = out->db[ERROR_HEAT] = out->db[ERROR_DEAD_RECKONING] = NAN;
}
