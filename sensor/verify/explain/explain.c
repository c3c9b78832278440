/* sensor/verify/explain/explain.c: renders a saved frame with a record of one pixel, and adds that up. */
#include "sensor/verify/explain/explain_private.h"

#include "render/trace/plants/forest.h"

#include <inttypes.h>
#include <stdlib.h>

const char *const explain_term_name[EXPLAIN_TERMS] = {
    "emitted", "sun",  "sky",   "ground",     "surroundings", "lamps",    "path",
    "beyond",  "disc", "smoke", "neighbours", "bounce_1",     "bounce_2", "bounce_3_and_more"};

/* ---- names ------------------------------------------------------------------------------------- */

static const char *name_of_plant(const SavedScene *scene, uint32_t number)
{
    const Woods     *woods = &scene->woods;
    const int        page = woods_page_of(number);
    const WoodsPage *of;
    if (number < (uint32_t)woods->count) return plant_name((PlantKind)woods->plant[number].kind);
    if (number & forest_low_bit || page < 0 || page >= woods->pages_x * woods->pages_y) return "low plant";
    const uint32_t place = number - woods_page_number(page);
    if (forest_page_plants(&of, scene->world.forest, page) != STATUS_OK || place >= (uint32_t)of->count) return "plant";
    return plant_name((PlantKind)of->plant[place].kind);
}

void explain_surface(char *out, size_t size, const Explained *e, const PixelSample *s)
{
    char id[dis_id_text_size];
    if (!(s->range_m < INFINITY)) {
        snprintf(out, size, "sky");
    } else if (s->entity) {
        const SnapshotEntity *entity = &e->scene->snapshot.entity[s->entity - 1];
        const Model          *model = catalog_model(e->scene->catalog, s->model);
        const char           *part = (int)s->part <= model->part_count && s->part ? model->part[s->part - 1].name : "";
        dis_entity_id_text(id, entity->id);
        snprintf(out, size, "%s %s, %s", id, model->name, part);
    } else if (s->kind == hit_scenery) {
        explain_scenery_name(out, size, e, s);
    } else if (s->kind == hit_plant) {
        snprintf(out, size, "%s, %s", name_of_plant(e->scene, s->plant - 1), s->radius_m > 0 ? "wood" : "leaf");
    } else {
        snprintf(out, size, "ground, %s", surface_name((SurfaceClass)s->surface));
    }
}

/* ---- planes -------------------------------------------------------------------------------------- */

/* Adds a sample's light, of this weight, to the terms of a plane. */
static void add_light(ExplainedPlane *p, const PixelSample *s, double weight)
{
    const PixelLight *l = &s->light[p->channel];
    const double      left = weight * (l->smoky ? (double)l->smoke_transmittance : 1);
    double           *term = p->term;
    if (l->smoky) term[EXPLAIN_SMOKE] += weight * (double)l->smoke;
    term[EXPLAIN_PATH] += left * (double)l->path;
    if (!(s->range_m < INFINITY)) {
        term[EXPLAIN_BEYOND] += left * l->beyond * (double)l->beyond_transmittance;
        term[EXPLAIN_DISC] += left * l->disc;
        return;
    }
    const double air = left * (double)l->air_transmittance;
    const double sky = (double)l->reflected_sky, ground = (double)l->reflected_ground;
    term[EXPLAIN_EMITTED] += left * (double)l->emitted * (double)l->transmittance;
    term[EXPLAIN_SUN] += left * (double)l->sunlit * (double)l->sun_transmittance;
    term[EXPLAIN_SKY] += air * sky;
    term[EXPLAIN_GROUND] += air * ground;
    term[EXPLAIN_LAMPS] += air * (double)l->lamps;
    term[EXPLAIN_SURROUNDINGS] += air * ((double)l->reflected - sky - ground);
}

static void add_passes(ExplainedPlane *p, const PixelSample *s, double weight, double sum[2])
{
    const PixelLight *l = &s->light[p->channel];
    if (l->smoky) p->passes[2] -= weight * (1 - (double)l->smoke_transmittance);
    sum[1] += weight;
    if (!(s->range_m < INFINITY)) return;
    sum[0] += weight;
    p->passes[0] += weight * (double)(p->channel >= AIR_MWIR ? l->transmittance : l->sun_transmittance);
    p->passes[1] += weight * (double)l->air_transmittance;
}

static Status explain_plane(ExplainedPlane *p, const Explained *e, Arena *arena)
{
    const PixelRecord *r = p->record;
    double             met[2] = {0};
    p->weight = arena_alloc(arena, (size_t)r->samples + 1, sizeof *p->weight);
    if (!p->weight) return STATUS_NO_MEMORY;
    p->sum = pixel_record_value(p->weight, &p->term[EXPLAIN_NEIGHBOURS], r, p->recorded_plane, r->steps);
    for (int i = 0; i < r->samples; i++) {
        const PixelSample *s = &r->sample[i];
        if (p->weight[i] == 0) continue;
        if (p->is_radar)
            for (int b = 0; b < radar_bounces; b++) p->term[EXPLAIN_BOUNCES + b] += p->weight[i] * (double)s->radar[b];
        else add_light(p, s, p->weight[i]), add_passes(p, s, p->weight[i], met);
    }
    p->passes[0] = met[0] > 0 ? p->passes[0] / met[0] : NAN;
    p->passes[1] = met[0] > 0 ? p->passes[1] / met[0] : NAN;
    p->passes[2] = met[1] > 0 ? 1 + p->passes[2] / met[1] : NAN;
    p->temp_k = NAN;
    if (!p->is_radar && p->channel >= AIR_MWIR)
        p->temp_k = planck_table_temp(
            p->channel == AIR_MWIR ? e->scene->world.planck_mwir : e->scene->world.planck_lwir, (double)p->value);
    return STATUS_OK;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The planes of the picture, each with the record that it is of: R and B with lateral colour have their own. */
static Status explain_planes(Explained *e, Arena *arena)
{
    const RenderRequest *request = &e->file->request;
    FrameArray           from[frame_max_planes];
    const int            count = frame_planes(from, e->picture, request);
    const size_t         px = picture_index(e->picture, e->x, e->y);
    Status               status = STATUS_OK;
    for (int k = 0; k < picture_plane_count && status == STATUS_OK; k++) {
        const float *values = picture_plane(e->picture, k);
        if (!values || !has_band(request->bands, picture_band(k))) continue;
        ExplainedPlane *p = &e->plane[e->planes++];
        *p = (ExplainedPlane){.plane = k, .band = picture_band(k), .is_radar = k == picture_radar, .value = values[px]};
        p->record = &e->record[0];
        p->recorded_plane = k;
        for (int c = 0; c < 2; c++)
            if (k == picture_optical + 2 * c && e->record[1 + c].steps > 0)
                p->record = &e->record[1 + c], p->recorded_plane = picture_optical;
        for (int c = 0; c < p->record->channels; c++)
            if (p->record->channel[c].plane == p->recorded_plane) p->channel = p->record->channel[c].channel;
        for (int i = 0; i < count; i++)
            if (from[i].values == values) frame_plane(p->name, &from[i]), p->unit = from[i].unit;
        status = explain_plane(p, e, arena);
        if (status != STATUS_OK || bits_of(p->sum) == bits_of(p->value)) continue;
        e->wrong++;
        log_error("explain: %s at column %d, row %d is %.9g (0x%08" PRIx32
                  "), and its terms add up to %.9g (0x%08" PRIx32
                  "): a fault of this program; please report it with the frame file",
                  p->name, e->x, e->y, (double)p->value, bits_of(p->value), (double)p->sum, bits_of(p->sum));
    }
    return status;
}

/* ---- detectors ----------------------------------------------------------------------------------- */

static Status explain_bands(Explained *e, Pool *pool, Arena *arena)
{
    const SavedFrame *file = e->file;
    const Picture    *picture = e->picture;
    const size_t      count = (size_t)picture->width * (size_t)picture->height, px = picture_index(picture, e->x, e->y);
    FrameDisplay      display[BAND_COUNT];
    Camera           *camera = arena_alloc(arena, 1, sizeof *camera);
    uint8_t          *shown = arena_alloc(arena, 3 * count, 1);
    if (!camera || !shown) return STATUS_NO_MEMORY;
    Status status = camera_open(camera, &e->scene->sensors, &e->scene->config, true);
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        e->band[b].watch.px = px;
        if (camera->chain[b]) chain_watch(camera->chain[b], &e->band[b].watch);
    }
    const DisplaysOf of = {.config = &e->scene->config,
                           .picture = picture,
                           .camera = camera,
                           .frame = file->frame,
                           .time_s = file->time_s,
                           .rate_px_s = {file->rate_px_s[0], file->rate_px_s[1]}};
    if (status == STATUS_OK) status = frame_displays_make(display, &of, file->request.bands, pool, arena);
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        const FrameDisplay *d = &display[b];
        ExplainedBand      *to = &e->band[b];
        if (d->planes == 0) continue;
        frame_display_quantise(shown, d, count, 8);
        to->there = true, to->has_chain = camera->chain[b] != NULL, to->curved = d->detector.plateau > 0;
        to->channels = d->planes, to->level = d->level;
        for (int c = 0; c < d->planes; c++) {
            to->grey[c] = shown[px * (size_t)d->planes + (size_t)c];
            to->displayed[c] = d->plane[c][px];
        }
    }
    camera_close(camera);
    return status;
}

/* ---- all of it ----------------------------------------------------------------------------------- */

Status explain_pixel(Explained *e, SavedFrame *file, SavedScene *scene, int x, int y, Pool *pool, Arena *arena)
{
    SavedAgain *again = arena_alloc(arena, 1, sizeof *again);
    *e = (Explained){.x = x, .y = y, .file = file, .scene = scene};
    for (int k = 0; k < pixel_records; k++) pixel_record_open(&e->record[k], x, y);
    if (!again) return STATUS_NO_MEMORY;
    file->request.record = e->record;
    Status status =
        saved_again(again, &(SavedStage){file, &scene->snapshot, &scene->world, &scene->config, pool, arena}, false);
    file->request.record = NULL;
    for (int k = 0; k < pixel_records; k++)
        if (status == STATUS_OK && e->record[k].lost) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) return status;
    e->picture = &again->picture;
    e->differ = saved_differences(file, &again->made, true);
    if (e->differ)
        log_error(
            "explain: the frame rendered here is not that of the file (%d planes differ)%s; what follows explains "
            "the one rendered here",
            e->differ, strcmp(file->version, PITVIPER_VERSION) == 0 ? "" : ": another version of pitviper made it");
    if (e->record[0].samples == 0 && file->request.sampling > SAMPLING_TARGETS) {
        const bool quarter = file->request.sampling == SAMPLING_QUARTER;
        log_error(
            "explain: column %d, row %d has no ray of its own in this frame, which gave up sampling to be in time: it is "
            "the mean of pixels beside it that have some; explain column %d, row %d",
            x, y,
            quarter ? x & ~1
            : x > 0 ? x - 1
                    : x + 1,
            quarter ? y & ~1 : y);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < pixel_records; k++) pixel_record_sort(&e->record[k]);
    status = explain_planes(e, arena);
    return status == STATUS_OK ? explain_bands(e, pool, arena) : status;
}

void explain_close(Explained *e)
{
    for (int k = 0; k < pixel_records; k++) pixel_record_close(&e->record[k]);
}
