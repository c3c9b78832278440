/* render/frame/render.c: the frame, tile by tile: one set of eye rays, one set of sun rays, and every band that
 * somebody asked for from the same hits. */
#include "render/frame/render_private.h"

#include "render/light/gather.h"
#include "render/light/optical.h"

/* The optical channels that somebody wants, in the picture's order; returns how many. */
static int optical_channels(int channel[3], unsigned bands, OpticalChannels optical)
{
    static const int rgb[3] = {optical_channel_r, optical_channel_g, optical_channel_b};
    if (!has_band(bands, BAND_OPTICAL)) return 0;
    if (optical == OPTICAL_RGB) {
        memcpy(channel, rgb, sizeof rgb);
        return 3;
    }
    channel[0] = optical == OPTICAL_NIR ? optical_channel_nir : optical == OPTICAL_RED ? optical_channel_r
               : optical == OPTICAL_BLUE ? optical_channel_b : optical_channel_pan;
    return 1;
}

unsigned render_air_bands(unsigned bands, OpticalChannels optical)
{
    int      channel[3];
    unsigned air = 0;
    for (int c = optical_channels(channel, bands, optical) - 1; c >= 0; c--) air |= 1u << channel[c];
    if (has_band(bands, BAND_MWIR)) air |= 1u << AIR_MWIR;
    if (has_band(bands, BAND_LWIR)) air |= 1u << AIR_LWIR;
    return air;
}

int render_places(int samples, int edge_samples)
{
    const int n = edge_samples > samples ? edge_samples : samples;
    return n * n;
}

double veil_taken(const Scratch *s, const Job *job, Band band, int sample)
{
    int channel[3] = {0};
    if (!s->veil.any || band == BAND_RADAR || !has_band(s->block.bands, band)) return 0;
    int of = band == BAND_MWIR ? effect_band_mwir : effect_band_lwir;
    if (band == BAND_OPTICAL) of = optical_channels(channel, s->block.bands, job->request->optical) == 3 ? channel[1] : channel[0];
    return 1 - (double)s->veil.transmittance[of][sample];
}


void trace_veils(Scratch *s, const Job *job)
{
    const Block *block = &s->block;
    double       box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    if (block->footprint) {
        footprint_box(box, block->footprint);
    } else {
        for (int p = 0; p < block->pixels; p++) {
            box[0] = fmin(box[0], block->x[p]), box[2] = fmax(box[2], block->x[p] + 1.0);
            box[1] = fmin(box[1], block->y[p]), box[3] = fmax(box[3], block->y[p] + 1.0);
        }
    }
    int volumes = job->effects.count;
    for (int n = 0; n < volumes; n++) s->veil_list[n] = n;
    if (volumes > 0 && skips(job->request->skips_off, SKIP_SMOKE)) {
        volumes = veil_block(s->veil_list, job->effects.volume, volumes, &job->request->view, box[0], box[1], box[2], box[3]);
        s->counters.visibility.skipped[SKIP_SMOKE] += (uint64_t)(job->effects.count - volumes);
    }
    veil_rays(&s->veil, job->effects.volume, s->veil_list, volumes, &s->rays, s->hits.range_m,
              render_air_bands(block->bands, job->request->optical));
}

double pixel_cosine3(const View *view, int x, int y) { return view_pixel_share(view, x, y); }

float *picture_plane(const Picture *picture, int plane)
{
    if (plane == picture_mwir) return picture->mwir;
    if (plane == picture_lwir) return picture->lwir;
    if (plane == picture_radar) return picture->radar;
    return picture->optical[plane - picture_optical];
}


void make_rays(Rays *rays, const Block *block, const View *view)
{
    const int     samples = block->n * block->n;
    const double *r = view->r_enu_from_cam, centre_x = 0.5 * view->width, centre_y = 0.5 * view->height;
    const double  focal_px = view->focal_px;
    double        place[256][2], column_px[hits_capacity], row_px[hits_capacity];
    double *const restrict dx = rays->d_enu[0], *const restrict dy = rays->d_enu[1], *const restrict dz = rays->d_enu[2];
    const int     count = block->pixels * samples;
    for (int k = 0; k < samples; k++) sample_place(place[k], block->n, k);
    for (int p = 0, i = 0; p < block->pixels; p++)
        for (int k = 0; k < samples; k++, i++) {
            column_px[i] = block->x[p] + place[k][0];
            row_px[i]    = block->y[p] + place[k][1];
        }
    if (view_has_lens(view)) {
        for (int i = 0; i < count; i++) {
            double at[2];
            lens_back_within(at, &view->lens, (column_px[i] - centre_x) / focal_px, (row_px[i] - centre_y) / focal_px);
            const double n = 1 / sqrt(at[0] * at[0] + at[1] * at[1] + 1), x = n * at[0], y = n * at[1], z = n * 1;
            dx[i] = r[0] * x + r[1] * y + r[2] * z;
            dy[i] = r[3] * x + r[4] * y + r[5] * z;
            dz[i] = r[6] * x + r[7] * y + r[8] * z;
        }
    }
    for (int i = view_has_lens(view) ? count : 0; i < count; i++) {
        const double x_cam = (column_px[i] - centre_x) / focal_px, y_cam = (row_px[i] - centre_y) / focal_px;
        const double n = 1 / sqrt(x_cam * x_cam + y_cam * y_cam + 1), x = n * x_cam, y = n * y_cam, z = n * 1;
        dx[i] = r[0] * x + r[1] * y + r[2] * z;
        dy[i] = r[3] * x + r[4] * y + r[5] * z;
        dz[i] = r[6] * x + r[7] * y + r[8] * z;
    }
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) rays->o_enu[k][i] = view->p_enu[k];
        rays->far_m[i] = INFINITY;
    }
    rays->count   = count;
    rays->columns = block->columns;
}

/* What a photograph says of a channel: its own colour, or the brightness of all three. */
static int albedo_of_channel(int channel)
{
    return channel == optical_channel_r ? albedo_red : channel == optical_channel_g ? albedo_green
         : channel == optical_channel_b ? albedo_blue : albedo_all;
}

/* What each hit is made of. */
static void resolve_materials(Scratch *s, const Job *job)
{
    const Materials *materials = &job->world->materials;
    uint16_t         of_class[256] = {0};
    for (int c = SURFACE_NONE + 1; c < SURFACE_COUNT; c++) of_class[c] = (uint16_t)materials->surface[c];
    for (int i = 0; i < s->hits.count; i++) s->material[i] = of_class[s->hits.surface[i]];
    for (int i = 0; i < s->hits.count; i++)
        if (s->hits.entity[i])
            s->material[i] =
                (uint16_t)material_of_part(materials, s->hits.model[i], s->hits.part[i] - 1,
                                           visibility_damage(job->visibility, (int)s->hits.entity[i] - 1));
}

/* How bright the ground's own pattern is at each hit, in the optical channels that somebody asks for and in that by
 * which ground warms. */
static void resolve_textures(Scratch *s, const Job *job)
{
    const Landscape *landscape = job->world->landscape;
    const Hits      *hits = &s->hits;
    const Rays      *rays = &s->rays;
    const double     px_per_m = job->request->view.focal_px * s->block.n;
    int              channel[4] = {optical_channel_pan};
    const int        channels = 1 + optical_channels(channel + 1, s->block.bands, job->request->optical);
    float           *pattern = s->texture[optical_channel_pan], *footprint_m = s->footprint_m;
    /* a sample's footprint along the ground, which is what would alias: longer as the view grazes */
    for (int i = 0; i < hits->count; i++) {
        float graze = 0;
        for (int k = 0; k < 3; k++) graze -= hits->n_geo[k][i] * (float)rays->d_enu[k][i];
        footprint_m[i] = (float)(hits->range_m[i] / px_per_m) / (graze > 0.01f ? graze : 0.01f);
        pattern[i] = 1;
    }
    if (landscape)
        landscape_textures(pattern, landscape, hits->count, hits->surface, hits->p_enu[0], hits->p_enu[1], footprint_m);
    for (int c = 1; c < channels; c++)
        if (channel[c] != optical_channel_pan) memcpy(s->texture[channel[c]], pattern, (size_t)hits->count * sizeof *pattern);
    if (!landscape || !landscape_has_photo(landscape)) return;
    for (int i = 0; i < hits->count; i++) {
        float albedo[albedo_channels];
        if (!hits->surface[i]) continue;
        landscape_albedo(albedo, landscape, (SurfaceClass)hits->surface[i], hits->p_enu[0][i], hits->p_enu[1][i],
                         (double)footprint_m[i]);
        for (int c = 0; c < channels; c++)
            if (c == 0 || channel[c] != optical_channel_pan) s->texture[channel[c]][i] *= albedo[albedo_of_channel(channel[c])];
    }
}

/* Pixels of the block from p on that lie side by side. */
static int run_from(const Block *block, int p)
{
    int run = 1;
    while (p + run < block->pixels && block->y[p + run] == block->y[p] && block->x[p + run] == block->x[p] + run) run++;
    return run;
}

/* Mean over each pixel's samples, into a plane. */
static void average(float *plane, const Scratch *s, const Job *job)
{
    const Block *block = &s->block;
    const int    samples = block->n * block->n;
    if (block->split) {
        for (int i = 0, p = 0; p < block->pixels; p++) {
            double sum = 0;
            for (; i < s->hits.count && block->pixel_of[i] == p; i++) sum += (double)block->part_of[i] * s->out[i];
            plane[pixel_index(job, block->x[p], block->y[p])] = (float)sum;
        }
        return;
    }
    if (samples == 1) {
        for (int p = 0, run; p < block->pixels; p += run) {
            run = run_from(block, p);
            memcpy(plane + pixel_index(job, block->x[p], block->y[p]), s->out + p, (size_t)run * sizeof *plane);
        }
        return;
    }
    for (int p = 0; p < block->pixels; p++) {
        double sum = 0;
        for (int k = 0; k < samples; k++) sum += s->out[p * samples + k];
        plane[pixel_index(job, block->x[p], block->y[p])] = (float)(sum * (1.0 / samples));
    }
}

/* What a band made of the block's samples (s->out), to whom it belongs. */
static void deliver(Scratch *s, const Job *job, int plane)
{
    if (s->block.footprint) {
        footprint_splat(s, plane);
        return;
    }
    if (s->block.probe) {
        probe_take(s, job, plane);
        return;
    }
    if (s->law && s->block.writes) law_take(s, job, plane);
    if (s->block.writes) average(picture_plane(job->picture, plane), s, job);
    if (job->picture->target) add_radiance(s, job, plane);
}

/* Light from all around, by directions that belong to a sample's place on the picture, whatever block it comes in. */
static void gather_around(Scratch *s, const Job *job)
{
    const Block         *block = &s->block;
    const RenderRequest *request = job->request;
    const GatherScene    scene = {job->visibility, job->air, &job->world->materials, job->world->catalog,
                                  job->snapshot};
    const int            samples = block->n * block->n;
    uint64_t             key[hits_capacity];
    for (int i = 0, within = 0; i < s->hits.count; i++) {
        const int p = block->footprint ? 0 : sample_pixel(block, i);
        within = block->split ? (i > 0 && block->pixel_of[i - 1] == p ? within + 1 : 0) : i % samples;
        key[i] = block->footprint ? footprint_key(block->footprint, block->cell[i])
                                  : (pixel_index(job, block->x[p], block->y[p]) * 32 + (uint64_t)block->n) * 256 +
                                        (uint64_t)within;
    }
    gather_light(&s->gathered, &scene, &s->hits, render_air_bands(block->bands, request->optical), request->sky_samples,
                 key, &s->counters.visibility);
}

/* A band's radiance is done: what hangs in the air before it, and on to whom it belongs. */
static void finish_band(Scratch *s, const Job *job, AirBand band, int veil_band, int plane)
{
    s->out = s->radiance[band];
    veil_apply(s->out, &s->veil, veil_band, s->hits.count);
    deliver(s, job, plane);
}

/* Rays that met nothing. */
static void shade_beyond(Scratch *s, const Job *job, float *const out[AIR_BAND_COUNT])
{
    double ground_w_m2[optical_channel_count];
    for (int c = 0; c < optical_channel_count; c++)
        ground_w_m2[c] = optical_ground_w_m2(c, job->air, &job->world->materials);
    for (int i = 0; i < s->hits.count; i++) {
        if (s->hits.range_m[i] < INFINITY) continue;
        const double d_enu[3] = {s->rays.d_enu[0][i], s->rays.d_enu[1][i], s->rays.d_enu[2][i]};
        for (int c = 0; c < optical_channel_count; c++)
            if (out[c]) out[c][i] = optical_beyond(c, job->air, ground_w_m2[c], d_enu, &s->air[c], i);
        if (out[AIR_MWIR]) out[AIR_MWIR][i] = thermal_beyond(BAND_MWIR, job->air, d_enu, &s->air[AIR_MWIR], i);
        if (out[AIR_LWIR]) out[AIR_LWIR][i] = thermal_beyond(BAND_LWIR, job->air, d_enu, &s->air[AIR_LWIR], i);
    }
}

static void shade_bands(Scratch *s, const Job *job)
{
    const RenderRequest *request = job->request;
    const World         *world   = job->world;
    const unsigned       bands   = s->block.bands, air_bands = render_air_bands(bands, request->optical);
    if (has_band(bands, BAND_MWIR) || has_band(bands, BAND_LWIR) || request->truth)
        thermal_temperature(s->temp_k, job->air, &world->materials, world->catalog, job->snapshot, &s->hits, s->material,
                            s->texture[optical_channel_pan]);
    if (!air_bands) return;
    air_veils_of(s->air, job->air, air_bands, &s->hits, &s->rays, s->temp_k);

    const bool   gathered = request->sky_samples > 0;
    SurfaceBlock block = {.hits = &s->hits, .rays = &s->rays, .material = s->material, .temp_k = s->temp_k,
                          .shadow = s->shadow, .veils = s->air};
    float       *out[AIR_BAND_COUNT] = {NULL};
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        if (!(air_bands >> b & 1)) continue;
        out[b] = s->radiance[b];
        if (b < optical_channel_count) block.texture[b] = s->texture[b];
        if (gathered) block.around_w_m2[b] = s->gathered.w_m2[b];
        else if (s->any_open) block.open[b] = s->open.factor[b];
    }
    surface_light_shade(out, &job->surface_light, &block);
    shade_beyond(s, job, out);

    int       channel[3];
    const int channels = optical_channels(channel, bands, request->optical);
    for (int c = 0; c < channels; c++) finish_band(s, job, (AirBand)channel[c], channel[c], picture_optical + c);
    if (has_band(bands, BAND_MWIR)) finish_band(s, job, AIR_MWIR, effect_band_mwir, picture_mwir);
    if (has_band(bands, BAND_LWIR)) finish_band(s, job, AIR_LWIR, effect_band_lwir, picture_lwir);
}

/* Of the picture's samples, those before which a small target stands count by what it leaves of their pixel. */
static double sample_area(const Scratch *s, const Job *job, int i)
{
    const Block *block = &s->block;
    if (block->footprint) return footprint_area(block->footprint, block->cell[i]);
    const int    p  = sample_pixel(block, i);
    const size_t px = pixel_index(job, block->x[p], block->y[p]);
    return block->sign * (job->picture->covered ? 1 - (double)job->picture->covered[px] : 1) * sample_part(block, i);
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
            s->profile[(int)bin * radar_bounces + b] +=
                llrint(sample_area(s, job, i) * fmin(power, job->profile_limit) / job->profile_quantum);
        }
}

static void shade_radar(Scratch *s, const Job *job)
{
    const World *world = job->world;
    radar_shade(&s->radar, &world->radar, job->visibility, &world->materials, &s->hits, &s->rays, s->material,
                job->request->hidden_entity, &s->counters.visibility);
    s->out = s->radiance[0];
    for (int i = 0; i < s->hits.count; i++) {
        double sum = 0;
        for (int b = 0; b < radar_bounces; b++) sum += s->radar.power[b][i];
        s->out[i] = (float)sum;
    }
    deliver(s, job, picture_radar);
    if (job->request->profile_bins > 0 && !s->block.probe) add_to_profile(s, job);
}

void trace_shadows(Scratch *s, const Job *job)
{
    const double t0 = wall_clock_s();
    if (has_band(s->block.bands, BAND_OPTICAL) || has_band(s->block.bands, BAND_MWIR))
        visibility_shadow(s->shadow, job->visibility, &s->hits, job->air->light.sun_d_enu, &s->counters.visibility);
    else
        memset(s->shadow, 0, sizeof s->shadow);
    s->shadow_s += wall_clock_s() - t0;
}

void shade_block(Scratch *s, const Job *job)
{
    const double t0 = wall_clock_s();
    if (job->picture->target && !s->block.footprint)
        for (int p = 0; p < s->block.pixels; p++)
            s->cosine3[p] = pixel_cosine3(&job->request->view, s->block.x[p], s->block.y[p]);
    resolve_materials(s, job);
    resolve_textures(s, job);
    trace_veils(s, job);
    if (job->request->sky_samples > 0) gather_around(s, job);
    s->any_open = job->sky && render_air_bands(s->block.bands, job->request->optical) &&
                  sky_visibility_open(&s->open, job->sky, s->sky, &s->hits, &s->counters.visibility);
    shade_bands(s, job);
    const double t1 = wall_clock_s();
    if (has_band(s->block.bands, BAND_RADAR)) shade_radar(s, job);
    s->shade_s += t1 - t0;
    s->radar_s += wall_clock_s() - t1;
}

/* The sample nearest a pixel's centre; of equals, the first. */
static int centre_sample(int n)
{
    int    best = 0;
    double least = INFINITY;
    for (int i = 0; i < n * n; i++) {
        double place[2];
        sample_place(place, n, i);
        const double square = (place[0] - 0.5) * (place[0] - 0.5) + (place[1] - 0.5) * (place[1] - 0.5);
        if (square < least) least = square, best = i;
    }
    return best;
}

static void write_truth(const Scratch *s, const Job *job)
{
    const Picture *picture = job->picture;
    const Block   *block   = &s->block;
    const Hits    *hits    = &s->hits;
    const int      samples = block->n * block->n, centre = centre_sample(block->n);
    for (int p = 0, run; p < block->pixels; p += run) {
        run = run_from(block, p);
        /* plane by plane: one stream of writes at a time */
        const size_t px = pixel_index(job, block->x[p], block->y[p]);
        const int    first = p * samples + centre;
        float       *range_m = picture->range_m + px;
        uint32_t    *entity = picture->entity + px, *part = picture->part + px, *material = picture->material + px;
        for (int k = 0; k < run; k++) range_m[k] = (float)hits->range_m[first + k * samples];
        for (int k = 0; k < run; k++) entity[k] = hits->entity[first + k * samples];
        for (int k = 0; k < run; k++) part[k] = hits->part[first + k * samples];
        for (int k = 0; k < run; k++) material[k] = s->material[first + k * samples];
        for (int k = 0; k < run; k++) picture->temp_k[px + (size_t)k] = s->temp_k[first + k * samples];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < run; k++) picture->normal[c][px + (size_t)k] = hits->n_enu[c][first + k * samples];
        for (int k = 0; job->shadow && k < run; k++) job->shadow[px + (size_t)k] = s->shadow[first + k * samples];
    }
}


/* ---- the tiles ------------------------------------------------------------------------------ */

Tile tile_of(const Job *job, int task)
{
    const View *view = &job->request->view;
    Tile        tile = {.x0 = task % job->tiles_x * job->side_px, .y0 = task / job->tiles_x * job->side_px};
    tile.x1 = tile.x0 + job->side_px < view->width ? tile.x0 + job->side_px : view->width;
    tile.y1 = tile.y0 + job->side_px < view->height ? tile.y0 + job->side_px : view->height;
    return tile;
}


int list_entities(Scratch *s, const Job *job, const Tile *tile)
{
    const int all = visibility_block_entities(s->list, job->visibility, &job->request->view, tile->x0, tile->y0,
                                              tile->x1, tile->y1, job->request->hidden_entity, &s->counters.visibility);
    int       listed = 0;
    for (int k = 0; k < all; k++)
        if (!job->is_small[s->list[k]]) s->list[listed++] = s->list[k];
    return listed;
}


void trace_block(Scratch *s, const Job *job, int listed)
{
    const RenderRequest *request = job->request;
    const double         t0 = wall_clock_s();
    make_rays(&s->rays, &s->block, &request->view);
    visibility_first_hit(&s->hits, job->visibility, &s->rays, s->list, listed, request->hidden_entity,
                         &s->counters.visibility);
    s->counters.rays_primary += (uint64_t)s->rays.count;
    s->visibility_s += wall_clock_s() - t0;
}

void render_block(Scratch *s, const Job *job, int listed, HiddenBy *pairs)
{
    trace_block(s, job, listed);
    trace_shadows(s, job);
    shade_block(s, job);
    if (pairs) count_targets(s, job, listed, pairs);
}

static void render_tile(void *user, int worker, int task)
{
    const Job *job   = user;
    Scratch   *s     = job->scratch[worker];
    const Tile tile  = tile_of(job, task);
    Block     *block = &s->block;

    *block = (Block){.n = job->request->samples, .sign = 1, .writes = true, .bands = job->request->bands};
    if (block->n == 1) block->columns = tile.x1 - tile.x0;
    for (int y = tile.y0; y < tile.y1; y++)
        for (int x = tile.x0; x < tile.x1; x++) {
            block->x[block->pixels]   = (uint16_t)x;
            block->y[block->pixels++] = (uint16_t)y;
        }
    const int listed = list_entities(s, job, &tile);
    s->counters.pixels += (uint64_t)block->pixels;
    s->counters.tiles++;
    s->counters.tiles_without_entities += listed == 0;
    render_block(s, job, listed, job->picture->target ? job->pairs + (size_t)task * pairs_per_tile : NULL);
    if (job->picture->entity) write_truth(s, job);
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
    if (has_band(request->bands, BAND_MWIR)) ok = (picture->mwir = arena_alloc(arena, px, sizeof(float))) && ok;
    if (has_band(request->bands, BAND_LWIR)) ok = (picture->lwir = arena_alloc(arena, px, sizeof(float))) && ok;
    if (has_band(request->bands, BAND_RADAR)) {
        ok = (picture->radar = arena_alloc(arena, px, sizeof(float))) && ok;
        if (request->profile_bins > 0)
            ok = (picture->profile = arena_alloc(arena, (size_t)request->profile_bins * radar_bounces,
                                                 sizeof(double))) && ok;
    }
    if (request->truth || looks_for_edges(request)) { /* edges are where truth changes */
        ok = (picture->range_m = arena_alloc(arena, px, sizeof(float))) && ok;
        ok = (picture->entity = arena_alloc(arena, px, sizeof(uint32_t))) && ok;
        ok = (picture->part = arena_alloc(arena, px, sizeof(uint32_t))) && ok;
        ok = (picture->material = arena_alloc(arena, px, sizeof(uint32_t))) && ok;
        ok = (picture->temp_k = arena_alloc(arena, px, sizeof(float))) && ok;
        for (int k = 0; k < 3; k++) ok = (picture->normal[k] = arena_alloc(arena, px, sizeof(float))) && ok;
    }
    if (request->truth) ok = (picture->target = arena_alloc(arena, (size_t)entities, sizeof(TargetPixels))) && ok;
    return ok ? STATUS_OK : STATUS_NO_MEMORY;
}

static Status allocate_job(Job *job, int workers, Arena *arena)
{
    const size_t entities = (size_t)job->snapshot->count;
    job->scratch          = arena_alloc(arena, (size_t)workers, sizeof *job->scratch);
    job->pairs = arena_alloc(arena, (size_t)job->tiles_x * (size_t)job->tiles_y, pairs_per_tile * sizeof *job->pairs);
    job->boxes    = arena_alloc(arena, entities, sizeof *job->boxes);
    job->is_small = arena_alloc(arena, entities, sizeof *job->is_small);
    if (!job->scratch || !job->pairs || !job->boxes || !job->is_small) return STATUS_NO_MEMORY;
    if (looks_for_edges(job->request)) {
        const size_t px = (size_t)job->picture->width * (size_t)job->picture->height;
        job->refine     = arena_alloc(arena, px, sizeof *job->refine);
        job->shadow     = arena_alloc(arena, px, sizeof *job->shadow);
        if (!job->refine || !job->shadow) return STATUS_NO_MEMORY;
        if (job->request->budget)
            job->law = arena_alloc(arena, (size_t)job->tiles_x * (size_t)job->tiles_y, sizeof *job->law);
        if (job->request->budget && !job->law) return STATUS_NO_MEMORY;
    }
    for (int w = 0; w < workers; w++) {
        Scratch *s = job->scratch[w] = arena_alloc(arena, 1, sizeof *s);
        if (!s) return STATUS_NO_MEMORY;
        s->list    = arena_alloc(arena, entities, sizeof *s->list);
        s->target  = arena_alloc(arena, entities, sizeof *s->target);
        s->profile = arena_alloc(arena, (size_t)job->request->profile_bins * radar_bounces, sizeof *s->profile);
        s->veil_list = arena_alloc(arena, (size_t)job->effects.count + 1, sizeof *s->veil_list);
        if (!s->list || !s->veil_list || !s->target || !s->profile) return STATUS_NO_MEMORY;
    }
    return STATUS_OK;
}

static void ask_sky(void *user, int worker, int task)
{
    const Job *job = user;
    sky_visibility_task(job->sky, job->scratch[worker]->sky, task);
}

/* After the boxes. */
static Status prepare_sky(Job *job, Pool *pool, Arena *arena)
{
    const RenderRequest *request = job->request;
    const World         *world   = job->world;
    const unsigned       bands   = render_air_bands(request->bands, request->optical);
    if (!request->sky_visibility || request->sky_samples > 0 || !bands || job->snapshot->count == 0) return STATUS_OK;
    double (*box_px)[4] = arena_alloc(arena, (size_t)job->snapshot->count, sizeof *box_px);
    if (!box_px) return STATUS_NO_MEMORY;
    for (int k = 0; k < job->snapshot->count; k++)
        for (int c = 0; c < 4; c++) box_px[k][c] = job->boxes[k].projected ? job->boxes[k].projected_box[c] : NAN;
    const SkyVisibilityScene scene = {
        .gather = {job->visibility, job->air, &world->materials, world->catalog, job->snapshot},
        .landscape = world->landscape, .view = &request->view, .box_px = (const double (*)[4])box_px,
        .air_bands = bands, .skips_off = request->skips_off, .hidden_entity = request->hidden_entity};
    Status status = sky_visibility_create(&job->sky, &scene, arena);
    for (int w = 0; w < pool_threads(pool) && status == STATUS_OK; w++)
        status = sky_worker_create(&job->scratch[w]->sky, job->sky, arena);
    if (status == STATUS_OK) pool_run(pool, sky_visibility_tasks(job->sky), ask_sky, job);
    return status;
}

/* Planes that only the search for edges wanted. */
static void forget_truth(Picture *picture)
{
    picture->range_m = picture->temp_k = NULL;
    picture->entity = picture->part = picture->material = NULL;
    for (int k = 0; k < 3; k++) picture->normal[k] = NULL;
}

/* ---- the frame ------------------------------------------------------------------------------ */

/* Quanta: areas divide evenly by both grids; nothing answers the radar with more than the peak of its lobe; and no
 * target's own radiance passes 2^20 W/(m2 sr) but a perfect mirror of the sun, which is cut there in truth's sums (not
 * in pictures). Powers of two, so that scaling is exact. */
static void choose_quanta(Job *job)
{
    const RenderRequest *request = job->request;
    const double         pixels  = (double)request->view.width * request->view.height;
    const int            edge    = looks_for_edges(request) ? request->edge_samples : 1;
    /* 2 x 2 is for the ground's own edges: at most 2^2 (16 x 16)^2 2^16 = 2^34 a pixel, of 2^26 */
    job->steps_per_px     = (int64_t)4 * request->samples * request->samples * edge * edge << 16;
    const double lobe_rad = fmax(job->world->radar.lobe_rad, 1e-9); /* as radar_lobe has it */
    job->profile_limit    = exp2(ceil(log2(2 / (pi_rad * lobe_rad * lobe_rad))));
    job->profile_quantum  = job->profile_limit * exp2(ceil(log2(pixels)) - 61);
    job->radiance_limit   = exp2(20);
    job->radiance_quantum = job->radiance_limit * exp2(ceil(log2(pixels)) - 61);
}

static bool request_is_good(const RenderRequest *r)
{
    return r->samples >= 1 && r->samples <= 16 && r->edge_samples >= 0 && r->edge_samples <= 16 &&
           (r->target_samples == 0 || (r->target_samples >= 8 && r->target_samples <= 256)) && r->view.width >= 1 &&
           r->view.height >= 1 && r->view.width <= 8192 && r->view.height <= 8192 && r->view.focal_px > 0 &&
           v3_is_finite(r->view.p_enu) && r->profile_bins >= 0 && fabs(r->lateral[0]) <= view_most_lateral &&
           fabs(r->lateral[1]) <= view_most_lateral &&
           r->sky_samples >= 0 && r->sky_samples <= gather_samples_limit;
}

/* One map of directions to the image for all channels. */
static Status render_once(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request,
                          const Air *air, Pool *pool, Arena *arena)
{

    const double start_s = wall_clock_s();
    const int    workers = pool_threads(pool);
    Picture      picture = {0};
    Visibility  *visibility = NULL;
    Job          job = {.world = world, .snapshot = snapshot, .request = request, .air = air, .picture = &picture};

    job.side_px = tile_side_samples / request->samples;
    job.tiles_x = (request->view.width + job.side_px - 1) / job.side_px;
    job.tiles_y = (request->view.height + job.side_px - 1) / job.side_px;
    choose_quanta(&job);

    Status status = allocate_planes(&picture, request, snapshot->count, arena);
    if (status == STATUS_OK && picture.optical[1]) optical_white(picture.white_w_m2_sr, air);
    if (status == STATUS_OK)
        status = effects_scene(&job.effects, snapshot, request->hidden_entity, &world->frame, &request->view, air,
                               world->materials.ground_rho, render_air_bands(request->bands, request->optical), arena);
    if (status == STATUS_OK) status = allocate_job(&job, workers, arena);
    if (status == STATUS_OK)
        status = visibility_create(&visibility, world->tracer, world->landscape, &world->frame, snapshot,
                                   request->skips_off, arena);
    if (status == STATUS_OK) status = visibility_look(visibility, &request->view, arena);
    if (status != STATUS_OK) return status;
    job.visibility = visibility;
    status = surface_light_prepare(&job.surface_light, air, &world->materials, arena);
    if (status != STATUS_OK) return status;
    if (request->truth || request->target_samples > 0 || looks_for_edges(request) || request->sky_visibility)
        pool_run(pool, snapshot->count, project_target, &job);
    status = prepare_sky(&job, pool, arena);
    if (status != STATUS_OK) return status;
    if (request->target_samples > 0) status = footprints_plan(&job, arena);
    if (status != STATUS_OK) return status;
    if (looks_for_edges(request)) mark_boxes(&job);
    const double prepared_s = wall_clock_s();
    picture.times.prepare_ms = 1e3 * (prepared_s - start_s);

    if (job.footprints > 0) {
        pool_run(pool, job.footprints, footprint_task, &job);
        footprints_cover(&job);
    }
    const double small_s = wall_clock_s();
    pool_run(pool, job.tiles_x * job.tiles_y, render_tile, &job);
    const double base_s = wall_clock_s();
    if (looks_for_edges(request)) pool_run(pool, job.tiles_x * job.tiles_y, refine_tile, &job);
    picture.times.footprints_ms = 1e3 * (small_s - prepared_s);
    picture.times.base_ms       = 1e3 * (base_s - small_s);
    picture.times.edges_ms      = 1e3 * (wall_clock_s() - base_s);
    gather(&job, workers);
    if (request->budget) footprints_error(&job);
    footprints_put_on(&job);
    if (request->budget) status = error_budget(&job, pool, arena);
    if (status != STATUS_OK) return status;
    if (!request->truth) forget_truth(&picture);
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
        /* a colour that is magnified otherwise is a picture of its own: other rays, other edges; truth is green's */
        RenderRequest one = *request;
        Picture       colour;
        if (request->lateral[k] == 0) continue;
        one.bands   = 1u << BAND_OPTICAL;
        one.optical = k == 0 ? OPTICAL_RED : OPTICAL_BLUE;
        one.truth = one.budget = false;
        one.view.focal_px *= 1 + request->lateral[k];
        status = render_once(&colour, world, snapshot, &one, air, pool, arena);
        if (status != STATUS_OK) break;
        picture.optical[2 * k] = colour.optical[0];
        render_counters_add(&picture.counters, &colour.counters);
        picture.times.prepare_ms += colour.times.prepare_ms, picture.times.visibility_ms += colour.times.visibility_ms;
        picture.times.shadow_ms += colour.times.shadow_ms, picture.times.shade_ms += colour.times.shade_ms;
        picture.times.footprints_ms += colour.times.footprints_ms, picture.times.base_ms += colour.times.base_ms;
        picture.times.edges_ms += colour.times.edges_ms;
    }
    if (status == STATUS_OK) *out = picture;
    return status;
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
    PlanckTable **const planck[2] = {&world.planck_mwir, &world.planck_lwir};
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        status = planck_table_create(planck[k], low_m, high_m);
    }
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
