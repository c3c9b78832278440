/* render/frame/render.c: a frame: prepares what its passes share, runs them one after the other and sums their
 * results. */

#include "render/frame/render.h"
#include "render/frame/frame_private.h"
#include "render/frame/planes.h"
#include "render/light/optical.h"

int render_places(int samples, int edge_samples)
{
    const int n = edge_samples > samples ? edge_samples : samples;
    return n * n;
}

/* ---- the frame's memory --------------------------------------------------------------------- */

static Status create_worker(Worker **out, const Job *job, Arena *arena)
{
    const int entities = job->scene.snapshot->count;
    Worker   *w = *out = arena_alloc(arena, 1, sizeof *w);
    if (!w) return STATUS_NO_MEMORY;
    w->list = arena_alloc(arena, (size_t)entities, sizeof *w->list);
    w->volume = arena_alloc(arena, (size_t)job->scene.effects.count + 1, sizeof *w->volume);
    w->outline = arena_alloc(arena, (size_t)entities, sizeof *w->outline);
    if (!w->list || !w->outline || !w->volume) return STATUS_NO_MEMORY;
    if (job->request->record && !(w->terms = arena_alloc(arena, 1, sizeof *w->terms))) return STATUS_NO_MEMORY;
    const Status status = shade_samples_create(&w->samples, hits_capacity, arena);
    return status == STATUS_OK ? target_sums_create(&w->sums, entities, job->request->profile_bins, arena) : status;
}

static Status create_job(Job *job, int workers, Arena *arena)
{
    const size_t entities = (size_t)job->scene.snapshot->count, tiles = (size_t)job->tiles_x * (size_t)job->tiles_y;
    job->worker = arena_alloc(arena, (size_t)workers, sizeof *job->worker);
    job->boxes = arena_alloc(arena, entities, sizeof *job->boxes);
    job->is_small = arena_alloc(arena, entities, sizeof *job->is_small);
    if (!job->worker || !job->boxes || !job->is_small) return STATUS_NO_MEMORY;
    if (looks_for_edges(job->request)) {
        const size_t px = (size_t)job->picture->width * (size_t)job->picture->height;
        job->refine = arena_alloc(arena, px, sizeof *job->refine);
        job->sun = arena_alloc(arena, px, sizeof *job->sun);
        if (!job->refine || !job->sun) return STATUS_NO_MEMORY;
        if (job->request->budget && !(job->law = arena_alloc(arena, tiles, sizeof *job->law))) return STATUS_NO_MEMORY;
    }
    if (job->request->sampling > SAMPLING_TARGETS &&
        !(job->whole = arena_alloc(arena, (size_t)job->picture->width * (size_t)job->picture->height, 1)))
        return STATUS_NO_MEMORY;
    Status status = leaf_filter_prepare(job, arena);
    for (int k = 0; k < workers && status == STATUS_OK; k++) status = create_worker(&job->worker[k], job, arena);
    return status;
}

static void ask_sky(void *user, int worker, int task)
{
    const Job *job = user;
    sky_visibility_task(job->scene.sky, job->worker[worker]->shader.sky, task);
}

/* After the boxes. */
static Status prepare_sky(Job *job, Pool *pool, Arena *arena)
{
    const RenderRequest *request = job->request;
    const World         *world = job->scene.world;
    const unsigned       bands = render_air_bands(request->bands, request->optical);
    if (!request->sky_visibility || request->sky_samples > 0 || !bands || job->scene.snapshot->count == 0)
        return STATUS_OK;
    double(*box_px)[4] = arena_alloc(arena, (size_t)job->scene.snapshot->count, sizeof *box_px);
    if (!box_px) return STATUS_NO_MEMORY;
    for (int k = 0; k < job->scene.snapshot->count; k++)
        for (int c = 0; c < 4; c++) box_px[k][c] = job->boxes[k].projected ? job->boxes[k].projected_box[c] : NAN;
    const SkyVisibilityScene scene = {
        .gather = {job->scene.bare, job->scene.air, &world->materials, world->patches, job->scene.snapshot},
        .landscape = world->landscape,
        .view = &request->view,
        .box_px = (const double(*)[4])box_px,
        .air_bands = bands,
        .skips_off = request->skips_off,
        .hidden_entity = request->hidden_entity,
        .kept = world->sky};
    Status status = sky_visibility_create(&job->scene.sky, &scene, arena);
    for (int w = 0; w < pool_threads(pool) && status == STATUS_OK; w++)
        status = sky_worker_create(&job->worker[w]->shader.sky, job->scene.sky, arena);
    if (status == STATUS_OK && !skips(request->skips_off, SKIP_LIGHT))
        pool_run(pool, sky_visibility_tasks(job->scene.sky), ask_sky, job);
    return status;
}

/* ---- the frame ------------------------------------------------------------------------------ */

static bool request_is_good(const RenderRequest *r)
{
    return r->samples >= 1 && r->samples <= 16 && r->edge_samples >= 0 && r->edge_samples <= 16 &&
           (r->target_samples == 0 || (r->target_samples >= 8 && r->target_samples <= 256)) && r->view.width >= 1 &&
           r->view.height >= 1 && r->view.width <= 8192 && r->view.height <= 8192 && r->view.focal_px > 0 &&
           v3_is_finite(r->view.p_enu) && r->profile_bins >= 0 && fabs(r->lateral[0]) <= view_most_lateral &&
           fabs(r->lateral[1]) <= view_most_lateral && r->sky_samples >= 0 &&
           r->sky_samples <= hemisphere_samples_max && r->sampling <= SAMPLING_QUARTER;
}

static void choose_rules(Job *job)
{
    const RenderRequest *request = job->request;
    job->rules.picture = job->picture;
    job->rules.visibility = job->scene.visibility;
    for (int b = 0; b < BAND_COUNT; b++)
        job->rules.smoke_channel[b] = picture_smoke_channel((Band)b, request->bands, request->optical);
    sum_rules_choose(&job->rules, request, &job->scene.world->radar);
}

/* What the passes need of the scene, and memory for their results. */
static Status prepare(Job *job, Pool *pool, Arena *arena)
{
    const RenderRequest *request = job->request;
    ShadeScene          *scene = &job->scene;
    const World         *world = scene->world;
    job->side_px = tile_side_samples / request->samples;
    job->tiles_x = (request->view.width + job->side_px - 1) / job->side_px;
    job->tiles_y = (request->view.height + job->side_px - 1) / job->side_px;
    job->channels = picture_channels(job->channel, request->bands, request->optical);

    if (request->record) {
        request->record->channels = job->channels;
        memcpy(request->record->channel, job->channel, sizeof job->channel);
    }

    Status status =
        planes_create(job->picture, request, scene->snapshot->count, world->forest || world->scenery, arena);
    if (status == STATUS_OK && job->picture->optical[1]) optical_white(job->picture->white_w_m2_sr, scene->air);
    if (status == STATUS_OK)
        status = shade_scene_create(scene, request, render_air_bands(request->bands, request->optical), pool, arena);
    if (status == STATUS_OK) status = create_job(job, pool_threads(pool), arena);
    if (status != STATUS_OK) return status;
    choose_rules(job);
    if (request->truth || request->target_samples > 0 || looks_for_edges(request) || request->sky_visibility ||
        job->whole)
        pool_run(pool, scene->snapshot->count, project_target, job);
    visibility_tighten(scene->visibility);
    status = prepare_sky(job, pool, arena);
    if (status == STATUS_OK && request->target_samples > 0) status = target_grids_plan(job, arena);
    job->rules.coverer = job->coverer;
    return status;
}

/* Sums over workers and target grids, into the picture. */
static Status gather_sums(Job *job, int workers, Arena *arena)
{
    Picture            *picture = job->picture;
    const TargetSums  **sums = arena_alloc(arena, (size_t)workers, sizeof *sums);
    const ScenerySums **scenery = arena_alloc(arena, (size_t)workers, sizeof *scenery);
    if (!sums || !scenery) return STATUS_NO_MEMORY;
    for (int k = 0; k < workers; k++) {
        scenery[k] = &job->worker[k]->scenery;
        const Worker  *w = job->worker[k];
        RenderCounters counters = w->counters;
        sums[k] = &w->sums;
        counters.visibility = w->shader.counters;
        render_counters_add(&picture->counters, &counters);
        picture->times.visibility_ms += 1e3 * w->shader.visibility_s;
        picture->times.shadow_ms += 1e3 * w->shader.shadow_s;
        picture->times.shade_ms += 1e3 * w->shader.shade_s;
        picture->times.radar_ms += 1e3 * w->shader.radar_s;
    }
    const WorkerSums of = {.sums = sums,
                           .workers = workers,
                           .entities = job->scene.snapshot->count,
                           .profile_bins = job->request->profile_bins,
                           .boxes = job->boxes};
    const Status     status = target_sums_gather(picture, &job->rules, &of, arena);
    if (status == STATUS_OK && picture->target) target_grids_sample(job);
    const SceneryTracer *tracer = job->scene.world->scenery;
    if (status == STATUS_OK && picture->target && tracer)
        return scenery_sums_gather(picture, &job->rules, scenery, workers, scenery_tracer_of(tracer), arena);
    return status;
}

static Status run_passes(Job *job, Pool *pool, Arena *arena)
{
    const RenderRequest *request = job->request;
    Picture             *picture = job->picture;
    const double         prepared_s = wall_clock_s();
    if (job->footprints > 0) {
        pool_run(pool, job->footprints, target_grid_task, job);
        target_grids_cover(job);
    }
    if (looks_for_edges(request)) {
        mark_boxes(job);
        const Status marked = mark_hot_parts(job, arena);
        if (marked != STATUS_OK) return marked;
    }
    sampling_mark(job);
    const double small_s = wall_clock_s();
    pool_run(pool, job->tiles_x * job->tiles_y, base_tile, job);
    if (job->whole) pool_run(pool, job->tiles_x * job->tiles_y, sampling_fill_tile, job);
    const double base_s = wall_clock_s();
    if (looks_for_edges(request)) pool_run(pool, job->tiles_x * job->tiles_y, refine_tile, job);
    if (job->smoothed) leaf_filter(job, pool);
    picture->times.target_grids_ms = 1e3 * (small_s - prepared_s);
    picture->times.base_ms = 1e3 * (base_s - small_s);
    picture->times.edges_ms = 1e3 * (wall_clock_s() - base_s);
    const Status status = gather_sums(job, pool_threads(pool), arena);
    if (status != STATUS_OK) return status;
    if (request->budget) target_grids_error(job);
    target_grids_composite(job);
    return request->budget ? error_estimate(job, pool, arena) : STATUS_OK;
}

/* One map of directions to the image for all channels. */
static Status render_once(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request,
                          const Air *air, Pool *pool, Arena *arena)
{
    const double start_s = wall_clock_s();
    Picture      picture = {0};
    Job          job = {.request = request,
                        .picture = &picture,
                        .rules = {.arena = arena},
                        .scene = {.world = world, .snapshot = snapshot, .air = air}};
    Status       status = prepare(&job, pool, arena);
    picture.times.prepare_ms = 1e3 * (wall_clock_s() - start_s);
    if (status == STATUS_OK) status = run_passes(&job, pool, arena);
    if (status == STATUS_OK) status = visibility_status(job.scene.visibility);
    sky_visibility_close(job.scene.sky, &picture.counters.visibility);
    shade_scene_close(&job.scene);
    if (status != STATUS_OK) return status;
    if (!request->truth) planes_forget_truth(&picture);
    *out = picture;
    return STATUS_OK;
}

static bool has_lateral(const RenderRequest *r)
{
    return r->optical == OPTICAL_RGB && has_band(r->bands, BAND_OPTICAL) && (r->lateral[0] != 0 || r->lateral[1] != 0);
}

Status render(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request, const Air *air,
              Pool *pool, Arena *arena)
{
    Picture picture = {0};
    if (!request_is_good(request)) return STATUS_BAD_VALUE;
    Status status = render_once(&picture, world, snapshot, request, air, pool, arena);
    for (int k = 0; k < 2 && has_lateral(request) && status == STATUS_OK; k++) {
        /* a colour of different magnification is rendered as a picture of its own: other rays, other edges; truth is
         * that of green */
        RenderRequest one = *request;
        Picture       colour;
        if (request->lateral[k] == 0) continue;
        one.bands = 1u << BAND_OPTICAL;
        one.optical = k == 0 ? OPTICAL_RED : OPTICAL_BLUE;
        one.truth = one.budget = false;
        if (one.record) one.record += 1 + k;
        one.view.focal_px *= 1 + request->lateral[k];
        status = render_once(&colour, world, snapshot, &one, air, pool, arena);
        if (status != STATUS_OK) break;
        picture.optical[2 * k] = colour.optical[0];
        render_counters_add(&picture.counters, &colour.counters);
        picture.times.prepare_ms += colour.times.prepare_ms, picture.times.visibility_ms += colour.times.visibility_ms;
        picture.times.shadow_ms += colour.times.shadow_ms, picture.times.shade_ms += colour.times.shade_ms;
        picture.times.target_grids_ms += colour.times.target_grids_ms, picture.times.base_ms += colour.times.base_ms;
        picture.times.edges_ms += colour.times.edges_ms;
    }
    if (status == STATUS_OK) *out = picture;
    return status;
}

/* ---- figures of the error estimate ----------------------------------------------------------- */

double render_error_kelvin(const PlanckTable *planck, double mean_w_m2_sr, double rms_w_m2_sr)
{
    const double step = 1e-3 * mean_w_m2_sr;
    if (!(mean_w_m2_sr > 0)) return NAN;
    return rms_w_m2_sr * (planck_table_temp(planck, mean_w_m2_sr + step) - planck_table_temp(planck, mean_w_m2_sr)) /
           step;
}

/* ---- the ground at every second post ----------------------------------------------------------- */

/* A cell of `stride` posts: height at (x, y), and normal. */
static double cell_height(double n_enu[3], const ElevationLevel *l, double fx, double fy, int i, int j, int stride)
{
    const double u = (fx - i) / stride, v = (fy - j) / stride;
    const double sw = elevation_post_m(l, i, j), se = elevation_post_m(l, i + stride, j);
    const double nw = elevation_post_m(l, i, j + stride), ne = elevation_post_m(l, i + stride, j + stride);
    const double du = u >= v ? se - sw : ne - nw, dv = u >= v ? ne - se : nw - sw, s = l->spacing_m * stride;
    const double length = sqrt(du * du + dv * dv + s * s);
    n_enu[0] = -du / length, n_enu[1] = -dv / length, n_enu[2] = s / length;
    return sw + u * du + v * dv;
}

bool render_error_coarser(double turn_enu[3], double *rise_m, const Elevation *elevation, double x_m, double y_m)
{
    for (int n = 0; n < elevation->level_count; n++) {
        const ElevationLevel *l = &elevation->level[n];
        const double          fx = (x_m - l->x0_m) / l->spacing_m, fy = (y_m - l->y0_m) / l->spacing_m;
        double                fine[3], coarse[3];
        if (!(fx >= 0 && fy >= 0 && fx <= l->nx - 1 && fy <= l->ny - 1)) continue;
        const int i = (int)fx, j = (int)fy;
        if (i / 2 * 2 + 2 > l->nx - 1 || j / 2 * 2 + 2 > l->ny - 1) return false;
        *rise_m = cell_height(coarse, l, fx, fy, i / 2 * 2, j / 2 * 2, 2) - cell_height(fine, l, fx, fy, i, j, 1);
        v3_sub(turn_enu, coarse, fine);
        return true;
    }
    return false;
}

/* Squared error of a pixel's mean, estimated from its own samples. */
double render_error_variance(const float *out, int n)
{
    double sum = 0;
    for (int row = 0; row < n; row++)
        for (int column = 0; column < n; column++) {
            const double here = (double)out[row * n + column];
            if (column + 1 < n) sum += (out[row * n + column + 1] - here) * (out[row * n + column + 1] - here);
            if (row + 1 < n) sum += (out[(row + 1) * n + column] - here) * (out[(row + 1) * n + column] - here);
        }
    return mean_variance_factor * sum / ((double)n * n * n * n);
}
