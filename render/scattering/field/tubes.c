/* render/scattering/field/tubes.c: shoots the grid of ray tubes at a target, and warps its faces by a smooth random
 * height. */
#include "render/scattering/field/tubes.h"
#include "render/scattering/field/tubes_private.h"

#include <stdlib.h>

void tubes_warp_make(Warp *out, double rms_m, double length_m, uint64_t seed, int part)
{
    const uint32_t stream = 95, frame = (uint32_t)part;
    out->amplitude_m = rms_m * sqrt(2.0 / warp_waves);
    for (int w = 0; w < warp_waves; w++) {
        const uint64_t at = 4 * (uint64_t)w;
        const double   z = 2 * random_uniform(seed, stream, frame, at) - 1, across = sqrt(fmax(0, 1 - z * z));
        const double   turn = 2 * pi_rad * random_uniform(seed, stream, frame, at + 1);
        const double   k = 2 * pi_rad / length_m * (0.5 + random_uniform(seed, stream, frame, at + 2));
        out->k[w][0] = k * across * cos(turn);
        out->k[w][1] = k * across * sin(turn);
        out->k[w][2] = k * z;
        out->phase_rad[w] = 2 * pi_rad * random_uniform(seed, stream, frame, at + 3);
    }
}

void tubes_warp_at(double *height_m, double gradient[3], double bend[9], const Warp *warp, const double p[3])
{
    *height_m = 0;
    memset(gradient, 0, 3 * sizeof *gradient);
    memset(bend, 0, 9 * sizeof *bend);
    for (int w = 0; w < warp_waves; w++) {
        const double *k = warp->k[w], phase = v3_dot(k, p) + warp->phase_rad[w];
        const double  c = warp->amplitude_m * cos(phase), s = warp->amplitude_m * sin(phase);
        *height_m += c;
        for (int i = 0; i < 3; i++) {
            gradient[i] -= s * k[i];
            for (int j = 0; j < 3; j++) bend[3 * i + j] -= c * k[i] * k[j];
        }
    }
}

/* Lays the grid of tubes and gathers their hits into one list; the tubes' own way is in
 * tubes_trace.c. */

enum {
    round_tiles = 512, /* hits are gathered so often: bounds the memory of workers */
    most_rays = 1 << 28,
    most_hits = 1 << 26 /* 5 GB */
};

TubeConfig tubes_default_config(double frequency_hz)
{
    return (TubeConfig){.frequency_hz = frequency_hz,
                        .rays_per_wavelength = 1.25,
                        .rays_per_radius = 128,
                        .splits = 2,
                        .cuts_per_radius = 768,
                        .split_rad = 0.5,
                        .bounces = 8,
                        .warp_length_m = 0.5};
}

void tubes_free(TubeHits *hits)
{
    free(hits->path_m);
    for (int i = 0; i < 2; i++) free(hits->slope_m[i]);
    for (int i = 0; i < 8; i++) free(hits->amplitude[i]);
    for (int c = 0; c < 3; c++) free(hits->first[c]), free(hits->last[c]);
    free(hits->bounce);
    free(hits->part);
    *hits = (TubeHits){0};
}

/* ---- the grid --------------------------------------------------------------------------------------- */

/* Hashes a look; looks that differ by a rounding have the same hash. */
static uint64_t hash_look(const TubeConfig *config, const ScatterAntenna *tx)
{
    uint64_t hash = config->seed + 0x9E3779B97F4A7C15u;
    for (int c = 0; c < 4; c++) {
        const double  x = c < 3 ? tx->u[c] * 1e9 : isinf(tx->range_m) ? 0 : tx->range_m * 1e3;
        const int64_t whole = llround(clamp(x, -9e18, 9e18));
        hash = (hash ^ (uint64_t)whole) * 0xBF58476D1CE4E5B9u;
        hash ^= hash >> 31;
    }
    return hash;
}

/* Finds where the line from the transmitter through a point meets the grid's plane, in the grid's axes. False: this is
 * behind the transmitter. */
static bool on_grid(double at_m[2], const TubeGrid *grid, const double p[3])
{
    double from[3];
    v3_sub(from, p, grid->centre);
    double scale = 1;
    if (!grid->plane) {
        const double ahead = 1 + v3_dot(from, grid->axis) / grid->distance_m;
        if (!(ahead > 1e-6)) return false;
        scale = 1 / ahead;
    }
    for (int i = 0; i < 2; i++) at_m[i] = scale * v3_dot(from, grid->side[i]);
    return true;
}

/* Turns the sides of a grid by an angle about its axis. */
static void turn_grid(TubeGrid *grid, double angle_rad)
{
    double       x[3], y[3];
    const double pole[3] = {0, fabs(grid->axis[2]) > 0.9, fabs(grid->axis[2]) <= 0.9};
    v3_cross(x, pole, grid->axis);
    v3_normalize(x, x);
    v3_cross(y, grid->axis, x);
    for (int c = 0; c < 3; c++) {
        grid->side[0][c] = cos(angle_rad) * x[c] + sin(angle_rad) * y[c];
        grid->side[1][c] = cos(angle_rad) * y[c] - sin(angle_rad) * x[c];
    }
}

static Status lay_grid(TubeGrid *grid, const RadarTarget *target, const ScatterAntenna *tx, const TubeConfig *config)
{
    const PosedEntity *entity = &target->entity;
    const double       wavelength_m = light_mps / config->frequency_hz;
    const double       curve_m = config->curve_m > 0 ? config->curve_m : target->curve_m;
    const double       widest_m = fmax(sqrt(wavelength_m * curve_m / 16), wavelength_m / 8);
    const uint64_t     hash = hash_look(config, tx);
    grid->spacing_m =
        fmin(fmin(wavelength_m / config->rays_per_wavelength, widest_m), entity->radius_m / config->rays_per_radius);
    memcpy(grid->centre, entity->centre_enu, sizeof grid->centre);
    grid->plane = isinf(tx->range_m);
    if (grid->plane) {
        v3_scale(grid->axis, -1, tx->u);
    } else {
        v3_scale(grid->antenna, tx->range_m, tx->u);
        v3_sub(grid->axis, grid->centre, grid->antenna);
        grid->distance_m = v3_length(grid->axis);
        if (!(grid->distance_m > 0)) return STATUS_BAD_VALUE;
        v3_scale(grid->axis, 1 / grid->distance_m, grid->axis);
    }
    turn_grid(grid, 2 * pi_rad * random_uniform(hash, 94, 0, 0));
    grid->back_m = 2.5 * entity->radius_m + 1e-3;

    double low_m[2] = {INFINITY, INFINITY}, high_m[2] = {-INFINITY, -INFINITY};
    for (int corner = 0; corner < 8; corner++) {
        double p[3], at_m[2];
        for (int c = 0; c < 3; c++) p[c] = corner >> c & 1 ? entity->box_high[c] : entity->box_low[c];
        if (!on_grid(at_m, grid, p)) return STATUS_BAD_VALUE;
        for (int i = 0; i < 2; i++) {
            low_m[i] = fmin(low_m[i], at_m[i]);
            high_m[i] = fmax(high_m[i], at_m[i]);
        }
    }
    for (int i = 0; i < 2; i++) {
        const double count = ceil((high_m[i] - low_m[i]) / grid->spacing_m) + 1;
        if (!(count < 1 << 24)) return STATUS_UNSUPPORTED;
        grid->count[i] = (int)count;
        grid->first_m[i] = low_m[i] - grid->spacing_m * random_uniform(hash, 94, 0, 1 + (uint64_t)i);
        grid->tiles[i] = (grid->count[i] + tile_side - 1) / tile_side;
    }
    return (double)grid->count[0] * grid->count[1] <= most_rays ? STATUS_OK : STATUS_UNSUPPORTED;
}

/* ---- the list --------------------------------------------------------------------------------------- */

static bool grow(void *array, size_t capacity, size_t octets)
{
    void **at = array, *larger = realloc(*at, capacity * octets);
    if (larger) *at = larger;
    return larger != NULL;
}

static Status reserve(TubeHits *hits, size_t more)
{
    if (hits->count + more <= hits->capacity) return STATUS_OK;
    const size_t want = hits->count + more > 2 * hits->capacity ? hits->count + more : 2 * hits->capacity;
    bool         good = grow(&hits->path_m, want, sizeof(double));
    for (int i = 0; i < 2; i++) good &= grow(&hits->slope_m[i], want, sizeof(float));
    for (int i = 0; i < 8; i++) good &= grow(&hits->amplitude[i], want, sizeof(float));
    for (int c = 0; c < 3; c++)
        good &= grow(&hits->first[c], want, sizeof(float)) && grow(&hits->last[c], want, sizeof(float));
    good &= grow(&hits->bounce, want, sizeof(uint8_t)) && grow(&hits->part, want, sizeof(uint16_t));
    if (!good) return STATUS_NO_MEMORY;
    hits->capacity = want;
    return STATUS_OK;
}

static void append(TubeHits *hits, const TubeHit *hit, size_t count)
{
    for (size_t k = 0; k < count; k++, hit++) {
        const size_t at = hits->count++;
        hits->path_m[at] = hit->path_m;
        for (int i = 0; i < 2; i++) hits->slope_m[i][at] = hit->slope_m[i];
        for (int i = 0; i < 8; i++) hits->amplitude[i][at] = hit->amplitude[i];
        for (int c = 0; c < 3; c++) hits->first[c][at] = hit->first[c], hits->last[c][at] = hit->last[c];
        hits->bounce[at] = hit->bounce;
        hits->part[at] = hit->part;
    }
}

/* ---- all of it -------------------------------------------------------------------------------------- */

static Status open_work(TubeWork *work, int threads, const RadarTarget *target)
{
    work->worker = calloc((size_t)threads, sizeof *work->worker);
    work->surface = calloc((size_t)target->model->part_count + 1, sizeof *work->surface);
    work->piece = calloc(round_tiles, sizeof *work->piece);
    work->warp = calloc((size_t)target->model->part_count + 1, sizeof *work->warp);
    if (!work->worker || !work->surface || !work->piece || !work->warp) return STATUS_NO_MEMORY;
    for (int p = 0; p < target->model->part_count && work->config.warp_m > 0; p++)
        tubes_warp_make(&work->warp[p], work->config.warp_m, work->config.warp_length_m, work->config.warp_seed, p);
    for (int w = 0; w < threads; w++) {
        work->worker[w].tile = calloc(1, tube_tile_octets());
        work->worker[w].at = malloc(tube_place_count(work->levels) * sizeof *work->worker[w].at);
        if (!work->worker[w].tile || !work->worker[w].at) return STATUS_NO_MEMORY;
    }
    for (int p = 0; p < target->model->part_count && target->materials; p++)
        radar_surface(&work->surface[p], &target->materials->material[target->material[p]], work->config.frequency_hz);
    return STATUS_OK;
}

static void close_work(TubeWork *work, int threads)
{
    for (int w = 0; w < threads && work->worker; w++) {
        free(work->worker[w].hit);
        free(work->worker[w].tile);
        free(work->worker[w].at);
        for (int i = 0; i < 2; i++) free(work->worker[w].cell[i]);
    }
    free(work->worker);
    free(work->surface);
    free(work->warp);
    free(work->piece);
}

static void run_tile(void *user, int worker, int task)
{
    TubeWork *work = user;
    tube_tile(work, worker, work->first_tile + task, &work->piece[task]);
}

static Status gather(TubeHits *out, TubeWork *work, int threads, int count)
{
    size_t more = 0;
    for (int t = 0; t < count; t++) {
        if (work->piece[t].failed) return STATUS_NO_MEMORY;
        more += work->piece[t].count;
        out->rays += work->piece[t].rays;
    }
    if (out->count + more > most_hits) {
        log_error("radar: more than %d hits of ray tubes: rays=%lld; take a lower frequency", (int)most_hits,
                  out->rays);
        return STATUS_UNSUPPORTED;
    }
    const Status status = reserve(out, more + 1);
    if (status != STATUS_OK) return status;
    for (int t = 0; t < count; t++)
        if (work->piece[t].count)
            append(out, work->worker[work->piece[t].worker].hit + work->piece[t].first, work->piece[t].count);
    for (int w = 0; w < threads; w++) work->worker[w].count = 0;
    return STATUS_OK;
}

Status tubes_trace(TubeHits *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                   const TubeConfig *config, Pool *pool)
{
    const TubeRest all = {.whole = NULL, .none = false};
    return tubes_trace_rest(out, target, tx, rx, config, &all, pool);
}

Status tubes_trace_rest(TubeHits *out, const RadarTarget *target, const ScatterAntenna *tx, const ScatterAntenna *rx,
                        const TubeConfig *config, const TubeRest *rest, Pool *pool)
{
    const int threads = pool ? pool_threads(pool) : 1;
    TubeWork  work = {.target = target,
                      .whole = rest->whole,
                      .tx = *tx,
                      .rx = *rx,
                      .config = *config,
                      .k = 2 * pi_rad * config->frequency_hz / light_mps,
                      .monostatic = memcmp(tx->u, rx->u, sizeof tx->u) == 0 && tx->range_m == rx->range_m};
    if (!scatter_antenna_is_good(tx) || !scatter_antenna_is_good(rx) || !(config->frequency_hz > 0) ||
        !(config->rays_per_wavelength > 0) || !(config->rays_per_radius >= 0) ||
        !(config->warp_m >= 0 && config->warp_length_m > 0) || isinf(config->frequency_hz) || config->bounces < 1 ||
        config->bounces > 255 || config->splits < 0 || config->splits > tubes_splits_most ||
        !(config->cuts_per_radius > 0 && config->split_rad > 0)) {
        log_error("radar: an antenna or a number of the ray tubes is out of range: frequency_hz=%g "
                  "rays_per_wavelength=%g bounces=%d",
                  config->frequency_hz, config->rays_per_wavelength, config->bounces);
        return STATUS_BAD_VALUE;
    }
    out->count = 0;
    out->rays = 0;
    out->tx = *tx, out->rx = *rx;
    out->frequency_hz = config->frequency_hz;
    if (target->entity.node_count == 0) return STATUS_OK;
    Status status = lay_grid(&work.grid, target, tx, config);
    if (status != STATUS_OK) {
        log_error(status == STATUS_BAD_VALUE ? "radar: the transmitter is within the target: range_m=%g"
                                             : "radar: more than 2^28 ray tubes: range_m=%g; take a lower frequency",
                  tx->range_m);
        return status;
    }
    out->spacing_m = work.grid.spacing_m;
    if (rest->none) return STATUS_OK;
    work.levels = tube_levels(work.grid.spacing_m, target->entity.radius_m, config);
    work.widest_m = target->entity.radius_m;
    status = open_work(&work, threads, target);
    const long long tiles = (long long)work.grid.tiles[0] * work.grid.tiles[1];
    for (long long t = 0; t < tiles && status == STATUS_OK; t += round_tiles) {
        const int count = (int)(tiles - t < round_tiles ? tiles - t : round_tiles);
        work.first_tile = t;
        if (pool) pool_run(pool, count, run_tile, &work);
        else
            for (int k = 0; k < count; k++) run_tile(&work, 0, k);
        status = gather(out, &work, threads, count);
    }
    if (status == STATUS_NO_MEMORY) log_error("radar: out of memory for the hits of ray tubes: rays=%lld", out->rays);
    if (status == STATUS_OK && out->count > 0) {
        static const TubeHit nothing;
        append(out, &nothing, 1);
        out->count--;
    }
    close_work(&work, threads);
    return status;
}
