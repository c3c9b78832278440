/* render/render.c: the frame, tile by tile: one set of eye rays, one set of sun rays, and every band that
 * somebody asked for from the same hits.
 *
 * Tiles write disjoint pixels. What is summed over tiles (pixels on target, the range profile) is summed in
 * integers, so the order in which threads finish cannot show. */
#include "render/render.h"

#include "render/gather.h"
#include "render/optical.h"

#include <stdlib.h>

enum { tile_side_samples = 32, pairs_per_tile = 16 };

typedef struct TargetCount {
    int64_t visible, amodal, hidden_ground, hidden_entity;
    int     box[4], amodal_box[4];
} TargetCount;

typedef struct HiddenBy {
    int target, occluder; /* snapshot indices */
    int samples;
} HiddenBy;

typedef struct Scratch {
    Rays           rays, some;
    Hits           hits;
    RadarReturns   radar;
    float          out[hits_capacity], temp_k[hits_capacity], texture[hits_capacity];
    uint16_t       material[hits_capacity];
    uint8_t        shadow[hits_capacity], meets[hits_capacity];
    Gathered       gathered; /* with sky_samples only */
    int            some_index[hits_capacity];
    int           *list;    /* [snapshot count] */
    TargetCount   *target;  /* [snapshot count] */
    int64_t       *profile; /* [profile_bins][radar_bounces] */
    RenderCounters counters;
    double         visibility_s, shadow_s, shade_s, radar_s;
} Scratch;

typedef struct Job {
    const World         *world;
    const Snapshot      *snapshot;
    const RenderRequest *request;
    const Air           *air;
    const Visibility    *visibility;
    Picture             *picture;
    Scratch            **scratch; /* a worker */
    HiddenBy            *pairs;   /* [tiles][pairs_per_tile] */
    int                  side_px, tiles_x, tiles_y;
    /* fixed point of the range profile: fine enough to be exact in float's terms, coarse enough that all samples
     * of a picture at the limit stay below 2^62 quanta */
    double               profile_limit, profile_quantum;
} Job;

typedef struct Tile {
    int x0, y0, x1, y1; /* px */
    int samples, across; /* samples a side of a pixel; samples along a row of the tile */
} Tile;

static bool wants(const RenderRequest *request, Band band) { return request->bands >> band & 1; }

/* Index of sample (sx, sy) of pixel (x, y). */
static inline int sample_index(const Tile *tile, int x, int y, int sx, int sy)
{
    return ((y - tile->y0) * tile->samples + sy) * tile->across + (x - tile->x0) * tile->samples + sx;
}

static void make_rays(Rays *rays, const Tile *tile, const View *view)
{
    const int    rows = (tile->y1 - tile->y0) * tile->samples;
    const double step = 1.0 / tile->samples;
    rays->count       = rows * tile->across;
    for (int row = 0, i = 0; row < rows; row++)
        for (int column = 0; column < tile->across; column++, i++) {
            double d_enu[3];
            view_ray(d_enu, view, tile->x0 + (column + 0.5) * step, tile->y0 + (row + 0.5) * step);
            for (int k = 0; k < 3; k++) {
                rays->o_enu[k][i] = view->p_enu[k];
                rays->d_enu[k][i] = d_enu[k];
            }
            rays->far_m[i] = INFINITY;
        }
}

/* What each hit is made of, and how bright the ground's own pattern is there. */
static void resolve_materials(Scratch *s, const Job *job)
{
    const World *world       = job->world;
    const double px_per_m    = job->request->view.focal_px * job->request->samples;
    for (int i = 0; i < s->hits.count; i++) {
        s->texture[i]  = 1;
        s->material[i] = 0;
        if (s->hits.entity[i]) {
            s->material[i] = (uint16_t)world->materials.part[s->hits.model[i]][s->hits.part[i] - 1];
        } else if (s->hits.surface[i]) {
            const SurfaceClass surface = (SurfaceClass)s->hits.surface[i];
            s->material[i]             = (uint16_t)world->materials.surface[surface];
            /* a sample's footprint along the ground, which is what would alias: longer as the view grazes */
            double graze = 0;
            for (int k = 0; k < 3; k++) graze -= s->hits.n_geo[k][i] * s->rays.d_enu[k][i];
            s->texture[i] = (float)landscape_texture(world->landscape, surface, s->hits.p_enu[0][i], s->hits.p_enu[1][i],
                                                     s->hits.range_m[i] / (px_per_m * fmax(graze, 0.01)));
        }
    }
}

/* Mean over each pixel's samples, into a plane. */
static void average(float *plane, const float *sample, const Tile *tile, int width)
{
    const double weight = 1.0 / (tile->samples * tile->samples);
    for (int y = tile->y0; y < tile->y1; y++)
        for (int x = tile->x0; x < tile->x1; x++) {
            double sum = 0;
            for (int sy = 0; sy < tile->samples; sy++)
                for (int sx = 0; sx < tile->samples; sx++) sum += sample[sample_index(tile, x, y, sx, sy)];
            plane[(size_t)y * (size_t)width + (size_t)x] = (float)(sum * weight);
        }
}

/* The optical channels that somebody wants, in the picture's order; returns how many. */
static int optical_channels(int channel[3], unsigned bands, OpticalChannels optical)
{
    static const int rgb[3] = {optical_channel_r, optical_channel_g, optical_channel_b};
    if (!(bands >> BAND_OPTICAL & 1)) return 0;
    if (optical == OPTICAL_RGB) {
        memcpy(channel, rgb, sizeof rgb);
        return 3;
    }
    channel[0] = optical == OPTICAL_NIR ? optical_channel_nir : optical_channel_pan;
    return 1;
}

unsigned render_air_bands(unsigned bands, OpticalChannels optical)
{
    int      channel[3];
    unsigned air = 0;
    for (int c = optical_channels(channel, bands, optical) - 1; c >= 0; c--) air |= 1u << channel[c];
    if (bands >> BAND_MWIR & 1) air |= 1u << AIR_MWIR;
    if (bands >> BAND_LWIR & 1) air |= 1u << AIR_LWIR;
    return air;
}

static void gather_around(Scratch *s, const Job *job, int task)
{
    const RenderRequest *request = job->request;
    const GatherScene    scene = {job->visibility, job->air, &job->world->materials, job->world->catalog, job->snapshot};
    gather_light(&s->gathered, &scene, &s->hits, render_air_bands(request->bands, request->optical),
                 request->sky_samples, (uint64_t)task, &s->counters.visibility);
}

static void shade_bands(Scratch *s, const Job *job, const Tile *tile)
{
    const RenderRequest *request = job->request;
    const World         *world   = job->world;
    Picture             *picture = job->picture;
    const int            width   = picture->width;

    const bool gathered = request->sky_samples > 0;
    int        channel[3];
    const int  channels = optical_channels(channel, request->bands, request->optical);
    for (int c = 0; c < channels; c++) {
        optical_shade(s->out, channel[c], job->air, &world->materials, &s->hits, &s->rays, s->material, s->texture,
                      s->shadow, gathered ? s->gathered.w_m2[channel[c]] : NULL);
        average(picture->optical[c], s->out, tile, width);
    }
    if (wants(request, BAND_MWIR) || wants(request, BAND_LWIR) || request->truth)
        thermal_temperature(s->temp_k, job->air, &world->materials, world->catalog, job->snapshot, &s->hits,
                            s->material, s->texture);
    for (Band band = BAND_MWIR; band <= BAND_LWIR; band++)
        if (wants(request, band)) {
            thermal_shade(s->out, band, job->air, &world->materials, &s->hits, &s->rays, s->material, s->temp_k,
                          s->shadow, gathered ? s->gathered.w_m2[band == BAND_MWIR ? AIR_MWIR : AIR_LWIR] : NULL);
            average(band == BAND_MWIR ? picture->mwir : picture->lwir, s->out, tile, width);
        }
}

static void add_to_profile(Scratch *s, const Job *job)
{
    const RenderRequest *request = job->request;
    for (int b = 0; b < radar_bounces; b++)
        for (int i = 0; i < s->hits.count; i++) {
            const double power = s->radar.power[b][i];
            if (!(power > 0)) continue;
            const double bin = floor((s->radar.slant_m[b][i] - request->profile_near_m) / request->profile_bin_m);
            if (!(bin >= 0 && bin < request->profile_bins)) continue;
            s->profile[(int)bin * radar_bounces + b] += llrint(fmin(power, job->profile_limit) / job->profile_quantum);
        }
}

static void shade_radar(Scratch *s, const Job *job, const Tile *tile)
{
    const World *world   = job->world;
    Picture     *picture = job->picture;
    radar_shade(&s->radar, &world->radar, job->visibility, &world->materials, &s->hits, &s->rays, s->material,
                job->request->hidden_entity, &s->counters.visibility);
    for (int i = 0; i < s->hits.count; i++) {
        double sum = 0;
        for (int b = 0; b < radar_bounces; b++) sum += s->radar.power[b][i];
        s->out[i] = (float)sum;
    }
    average(picture->radar, s->out, tile, picture->width);
    if (job->request->profile_bins > 0) add_to_profile(s, job);
}

/* Truth of a pixel is that of the sample nearest its centre; of equals, the first. */
static void write_truth(const Scratch *s, const Job *job, const Tile *tile)
{
    Picture  *picture = job->picture;
    const int centre  = (tile->samples - 1) / 2;
    for (int y = tile->y0; y < tile->y1; y++)
        for (int x = tile->x0; x < tile->x1; x++) {
            const int    i  = sample_index(tile, x, y, centre, centre);
            const size_t px = (size_t)y * (size_t)picture->width + (size_t)x;
            picture->range_m[px]  = (float)s->hits.range_m[i];
            picture->entity[px]   = s->hits.entity[i];
            picture->part[px]     = s->hits.part[i];
            picture->material[px] = s->material[i];
            picture->temp_k[px]   = s->temp_k[i];
            for (int k = 0; k < 3; k++) picture->normal[k][px] = s->hits.n_enu[k][i];
        }
}

static void grow_box(int box[4], int x, int y)
{
    if (box[2] == 0) {
        box[0] = x, box[1] = y, box[2] = x + 1, box[3] = y + 1;
        return;
    }
    if (x < box[0]) box[0] = x;
    if (y < box[1]) box[1] = y;
    if (x + 1 > box[2]) box[2] = x + 1;
    if (y + 1 > box[3]) box[3] = y + 1;
}

static void merge_box(int box[4], const int other[4])
{
    if (other[2] == 0) return;
    grow_box(box, other[0], other[1]);
    grow_box(box, other[2] - 1, other[3] - 1);
}

static void note_hidden(HiddenBy *pairs, int target, int occluder)
{
    for (int k = 0; k < pairs_per_tile; k++) {
        if (pairs[k].samples == 0) pairs[k] = (HiddenBy){target, occluder, 0};
        if (pairs[k].target == target && pairs[k].occluder == occluder) {
            pairs[k].samples++;
            return;
        }
    }
}

/* Visible and amodal samples of every entity that this tile can show. */
static void count_targets(Scratch *s, const Job *job, const Tile *tile, int listed, HiddenBy *pairs)
{
    for (int n = 0; n < listed; n++) {
        const int      index = s->list[n];
        const uint32_t id    = (uint32_t)index + 1;
        TargetCount   *count = &s->target[index];

        s->some.count = 0;
        for (int i = 0; i < s->hits.count; i++) {
            if (s->hits.entity[i] == id) {
                const int x = tile->x0 + i % tile->across / tile->samples;
                const int y = tile->y0 + i / tile->across / tile->samples;
                count->visible++;
                count->amodal++;
                grow_box(count->box, x, y);
                grow_box(count->amodal_box, x, y);
                continue;
            }
            const int to      = s->some.count++;
            s->some_index[to] = i;
            for (int k = 0; k < 3; k++) {
                s->some.o_enu[k][to] = s->rays.o_enu[k][i];
                s->some.d_enu[k][to] = s->rays.d_enu[k][i];
            }
            s->some.far_m[to] = INFINITY;
        }
        visibility_entity_only(s->meets, job->visibility, &s->some, index);
        for (int k = 0; k < s->some.count; k++) {
            if (!s->meets[k]) continue;
            const int i = s->some_index[k];
            count->amodal++;
            grow_box(count->amodal_box, tile->x0 + i % tile->across / tile->samples,
                     tile->y0 + i / tile->across / tile->samples);
            if (s->hits.entity[i]) {
                count->hidden_entity++;
                note_hidden(pairs, index, (int)s->hits.entity[i] - 1);
            } else {
                count->hidden_ground++;
            }
        }
    }
}

static void render_tile(void *user, int worker, int task)
{
    const Job           *job     = user;
    const RenderRequest *request = job->request;
    const View          *view    = &request->view;
    Scratch             *s       = job->scratch[worker];
    Tile                 tile    = {.samples = request->samples};

    tile.x0     = task % job->tiles_x * job->side_px;
    tile.y0     = task / job->tiles_x * job->side_px;
    tile.x1     = tile.x0 + job->side_px < view->width ? tile.x0 + job->side_px : view->width;
    tile.y1     = tile.y0 + job->side_px < view->height ? tile.y0 + job->side_px : view->height;
    tile.across = (tile.x1 - tile.x0) * tile.samples;

    const double t0 = wall_clock_s();
    make_rays(&s->rays, &tile, view);
    const int listed = visibility_block_entities(s->list, job->visibility, view, tile.x0, tile.y0, tile.x1, tile.y1,
                                                 request->hidden_entity);
    visibility_first_hit(&s->hits, job->visibility, &s->rays, s->list, listed, request->hidden_entity,
                         &s->counters.visibility);
    s->counters.rays_primary += (uint64_t)s->rays.count;
    s->counters.tiles++;
    s->counters.tiles_without_entities += listed == 0;

    const double t1 = wall_clock_s();
    memset(s->shadow, 0, sizeof s->shadow);
    if ((wants(request, BAND_OPTICAL) || wants(request, BAND_MWIR)) && job->air->sun_d_enu[2] > 0)
        visibility_shadow(s->shadow, job->visibility, &s->hits, job->air->sun_d_enu, &s->counters.visibility);

    const double t2 = wall_clock_s();
    resolve_materials(s, job);
    if (request->sky_samples > 0) gather_around(s, job, task);
    shade_bands(s, job, &tile);
    if (request->truth) {
        write_truth(s, job, &tile);
        count_targets(s, job, &tile, listed, job->pairs + (size_t)task * pairs_per_tile);
    }
    const double t3 = wall_clock_s();
    if (wants(request, BAND_RADAR)) shade_radar(s, job, &tile);
    const double t4 = wall_clock_s();

    s->visibility_s += t1 - t0;
    s->shadow_s += t2 - t1;
    s->shade_s += t3 - t2;
    s->radar_s += t4 - t3;
}

/* ---- the frame's memory --------------------------------------------------------------------- */

static Status allocate_planes(Picture *picture, const RenderRequest *request, int entities, Arena *arena)
{
    const size_t px = (size_t)request->view.width * (size_t)request->view.height;
    bool         ok = true;
    picture->width  = request->view.width;
    picture->height = request->view.height;

    int channel[3];
    for (int c = optical_channels(channel, request->bands, request->optical) - 1; c >= 0; c--)
        ok = (picture->optical[c] = arena_alloc(arena, px, sizeof(float))) && ok;
    if (wants(request, BAND_MWIR)) ok = (picture->mwir = arena_alloc(arena, px, sizeof(float))) && ok;
    if (wants(request, BAND_LWIR)) ok = (picture->lwir = arena_alloc(arena, px, sizeof(float))) && ok;
    if (wants(request, BAND_RADAR)) {
        ok = (picture->radar = arena_alloc(arena, px, sizeof(float))) && ok;
        if (request->profile_bins > 0)
            ok = (picture->profile = arena_alloc(arena, (size_t)request->profile_bins * radar_bounces,
                                                 sizeof(double))) && ok;
    }
    if (request->truth) {
        ok = (picture->range_m = arena_alloc(arena, px, sizeof(float))) && ok;
        ok = (picture->entity = arena_alloc(arena, px, sizeof(uint32_t))) && ok;
        ok = (picture->part = arena_alloc(arena, px, sizeof(uint32_t))) && ok;
        ok = (picture->material = arena_alloc(arena, px, sizeof(uint32_t))) && ok;
        ok = (picture->temp_k = arena_alloc(arena, px, sizeof(float))) && ok;
        for (int k = 0; k < 3; k++) ok = (picture->normal[k] = arena_alloc(arena, px, sizeof(float))) && ok;
        ok = (picture->target = arena_alloc(arena, (size_t)entities, sizeof(TargetPixels))) && ok;
    }
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

static Status allocate_job(Job *job, int workers, Arena *arena)
{
    const size_t entities = (size_t)job->snapshot->count;
    job->scratch          = arena_alloc(arena, (size_t)workers, sizeof *job->scratch);
    job->pairs = arena_alloc(arena, (size_t)job->tiles_x * (size_t)job->tiles_y, pairs_per_tile * sizeof *job->pairs);
    if (!job->scratch || !job->pairs) return STATUS_NO_MEMORY;
    for (int w = 0; w < workers; w++) {
        Scratch *s = job->scratch[w] = arena_alloc(arena, 1, sizeof *s);
        if (!s) return STATUS_NO_MEMORY;
        s->list    = arena_alloc(arena, entities, sizeof *s->list);
        s->target  = arena_alloc(arena, entities, sizeof *s->target);
        s->profile = arena_alloc(arena, (size_t)job->request->profile_bins * radar_bounces, sizeof *s->profile);
        if (!s->list || !s->target || !s->profile) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

/* ---- after the tiles ------------------------------------------------------------------------ */

void render_counters_add(RenderCounters *sum, const RenderCounters *more)
{
    VisibilityCounters       *to   = &sum->visibility;
    const VisibilityCounters *from = &more->visibility;
    sum->rays_primary += more->rays_primary;
    sum->tiles += more->tiles;
    sum->tiles_without_entities += more->tiles_without_entities;
    to->rays_ground += from->rays_ground;
    to->rays_parts += from->rays_parts;
    to->rays_sun_ground += from->rays_sun_ground;
    to->rays_sun_parts += from->rays_sun_parts;
    to->skipped_parts += from->skipped_parts;
    to->skipped_sun_parts += from->skipped_sun_parts;
}

static int compare_pairs(const void *a, const void *b)
{
    const HiddenBy *p = a, *q = b;
    if (p->target != q->target) return p->target < q->target ? -1 : 1;
    return p->occluder < q->occluder ? -1 : p->occluder > q->occluder;
}

/* Who hides most of each target; of equals, the lowest id. Sorts the pairs. */
static void name_occluders(TargetPixels *target, HiddenBy *pairs, size_t count)
{
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
        if (pairs[i].samples > 0) pairs[used++] = pairs[i];
    if (used > 1) qsort(pairs, used, sizeof *pairs, compare_pairs);
    int64_t most = 0;
    for (size_t i = 0; i < used;) {
        int64_t   samples = 0;
        const int who = pairs[i].target, by = pairs[i].occluder;
        if (i == 0 || pairs[i - 1].target != who) most = 0;
        for (; i < used && pairs[i].target == who && pairs[i].occluder == by; i++) samples += pairs[i].samples;
        if (samples > most) {
            most                 = samples;
            target[who].occluder = by;
        }
    }
}

/* Only those whose bounding sphere can show: a vertex is not looked at otherwise. */
static void project_target(TargetPixels *target, const Job *job, int index)
{
    const View           *view   = &job->request->view;
    const SnapshotEntity *entity = &job->snapshot->entity[index];
    double                p_enu[3], offset_enu[3], p_cam[3];
    if (index == job->request->hidden_entity) return;
    enu_from_ecef(p_enu, &job->world->frame, entity->p_ecef);
    v3_sub(offset_enu, p_enu, view->p_enu);
    m3_tmul_v3(p_cam, view->r_enu_from_cam, offset_enu);
    const double radius_m = catalog_model(job->world->catalog, entity->model)->radius_m;
    if (!(p_cam[2] > -radius_m)) return;
    /* half a picture and the sphere, in the plane of the sphere's far side: generous, never too tight */
    const double depth_m = p_cam[2] + radius_m;
    if (fabs(p_cam[0]) - radius_m > depth_m * 0.5 * view->width / view->focal_px ||
        fabs(p_cam[1]) - radius_m > depth_m * 0.5 * view->height / view->focal_px)
        return;
    double box[4];
    if (!visibility_project_box(box, job->visibility, view, index)) return;
    if (!(box[2] > 0 && box[0] < view->width && box[3] > 0 && box[1] < view->height)) return;
    target->projected = true;
    memcpy(target->projected_box, box, sizeof box);
}

static void gather(Picture *picture, const Job *job, int workers)
{
    const double share = 1.0 / (job->request->samples * job->request->samples);

    for (int w = 0; w < workers; w++) {
        const Scratch *s = job->scratch[w];
        render_counters_add(&picture->counters, &s->counters);
        picture->times.visibility_ms += 1e3 * s->visibility_s;
        picture->times.shadow_ms += 1e3 * s->shadow_s;
        picture->times.shade_ms += 1e3 * s->shade_s;
        picture->times.radar_ms += 1e3 * s->radar_s;
    }
    for (int i = 0; picture->target && i < job->snapshot->count; i++) {
        TargetCount sum = {0};
        for (int w = 0; w < workers; w++) {
            const TargetCount *t = &job->scratch[w]->target[i];
            sum.visible += t->visible;
            sum.amodal += t->amodal;
            sum.hidden_ground += t->hidden_ground;
            sum.hidden_entity += t->hidden_entity;
            merge_box(sum.box, t->box);
            merge_box(sum.amodal_box, t->amodal_box);
        }
        TargetPixels *target    = &picture->target[i];
        target->visible         = (double)sum.visible * share;
        target->amodal          = (double)sum.amodal * share;
        target->occluded_ground = (double)sum.hidden_ground * share;
        target->occluded_entity = (double)sum.hidden_entity * share;
        target->occluder        = -1;
        memcpy(target->box, sum.box, sizeof sum.box);
        memcpy(target->amodal_box, sum.amodal_box, sizeof sum.amodal_box);
    }
    for (int i = 0; picture->target && i < job->snapshot->count; i++)
        project_target(&picture->target[i], job, i);
    if (picture->target)
        name_occluders(picture->target, job->pairs,
                       (size_t)job->tiles_x * (size_t)job->tiles_y * pairs_per_tile);
    for (int i = 0; picture->profile && i < job->request->profile_bins * radar_bounces; i++) {
        int64_t sum = 0;
        for (int w = 0; w < workers; w++) sum += job->scratch[w]->profile[i];
        picture->profile[i] = (double)sum * job->profile_quantum * share;
    }
}

Status render(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request, const Air *air,
              Pool *pool, Arena *arena)
{
    if (request->samples < 1 || request->samples > 16 || request->view.width < 1 || request->view.height < 1 ||
        !(request->view.focal_px > 0) || !v3_is_finite(request->view.p_enu) || request->profile_bins < 0 ||
        request->sky_samples < 0 || request->sky_samples > gather_samples_limit)
        return STATUS_BAD_VALUE;

    const double start_s = wall_clock_s();
    Picture      picture = {0};
    Visibility  *visibility = NULL;
    Job          job = {.world = world, .snapshot = snapshot, .request = request, .air = air, .picture = &picture};

    job.side_px = tile_side_samples / request->samples;
    job.tiles_x = (request->view.width + job.side_px - 1) / job.side_px;
    job.tiles_y = (request->view.height + job.side_px - 1) / job.side_px;

    /* nothing answers with more than the peak of its lobe; a power of two, so that scaling is exact */
    const double samples = (double)request->view.width * request->view.height * request->samples * request->samples;
    job.profile_limit    = exp2(ceil(log2(2 / (pi_rad * world->radar.lobe_rad * world->radar.lobe_rad))));
    job.profile_quantum  = job.profile_limit * exp2(ceil(log2(samples)) - 61);

    Status status = allocate_planes(&picture, request, snapshot->count, arena);
    if (status == STATUS_OK) status = allocate_job(&job, pool_threads(pool), arena);
    if (status == STATUS_OK)
        status = visibility_create(&visibility, world->tracer, world->landscape, &world->frame, snapshot,
                                   request->no_skip, arena);
    if (status != STATUS_OK) return status;
    job.visibility          = visibility;
    picture.times.prepare_ms = 1e3 * (wall_clock_s() - start_s);

    pool_run(pool, job.tiles_x * job.tiles_y, render_tile, &job);
    gather(&picture, &job, pool_threads(pool));
    *out = picture;
    return STATUS_OK;
}

/* ---- the world ------------------------------------------------------------------------------ */

Status world_open(World *out, const Catalog *catalog, const Landscape *landscape, const LocalFrame *frame,
                  const char *isa)
{
    World  world = {.catalog = catalog, .landscape = landscape, .frame = *frame, .radar = {.lobe_rad = 0.05}};
    char   materials[512], surfaces[512];
    Status status = STATUS_BAD_VALUE;

    if (!etc_path(materials, sizeof materials, "materials.csv") || !etc_path(surfaces, sizeof surfaces, "surfaces.csv")) {
        log_error("render: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    status = tracer_create(&world.tracer, catalog, isa);
    if (status == STATUS_OK) status = materials_open(&world.materials, materials, surfaces, catalog);
    if (status == STATUS_OK) status = planck_table_create(&world.planck_mwir, 3.4e-6, 4.8e-6);
    if (status == STATUS_OK) status = planck_table_create(&world.planck_lwir, 8e-6, 12e-6);
    if (status != STATUS_OK) {
        world_close(&world);
        return status;
    }
    *out = world;
    return STATUS_OK;
}

void world_close(World *world)
{
    atmosphere_close(world->atmosphere);
    planck_table_destroy(world->planck_lwir);
    planck_table_destroy(world->planck_mwir);
    materials_close(&world->materials);
    tracer_destroy(world->tracer);
    memset(world, 0, sizeof *world);
}
