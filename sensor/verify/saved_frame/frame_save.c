/* sensor/verify/saved_frame/frame_save.c: collects the inputs of a frame, packs them, renders the frame again from the
 * octets, and writes the file when the planes are equal. */
#include "sensor/verify/saved_frame/frame_save.h"
#include "pitviper_output.h"

#include "sensor/verify/saved_frame/saved_again.h"
#include "sensor/verify/saved_frame/saved_scene.h"
#include "sensor/verify/saved_frame/ground_cutout_private.h"
#include "sensor/frame/frame_world.h"
#include "sensor/instruments/radar.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4096 };

/* ---- collected ----------------------------------------------------------------------------------- */

/* Writes the settings, without terrain files, which the frame file replaces, and without those that affect no plane. */
static Status write_settings(char **text, const Config *config)
{
    Config plain = *config;
    size_t octets;
    *plain.terrain.elevation = *plain.terrain.cover = *plain.terrain.cover_table = *plain.terrain.orthophoto = 0;
    *plain.terrain.store = *plain.terrain.place = *plain.terrain.trees = 0;
    if (strcmp(plain.terrain.buildings, "invented") != 0)
        snprintf(plain.terrain.buildings, sizeof plain.terrain.buildings, "off");
    *plain.terrain.geoid = *plain.record.path = *plain.quality.table = *plain.flight.missile = 0;
    *plain.exercise.cigi = *plain.exercise.cigi_types = *plain.exercise.head = 0;
    *plain.projector.band = *plain.projector.table = 0;
    FILE *to = open_memstream(text, &octets);
    if (!to) return STATUS_NO_MEMORY;
    config_write_settings(to, &plain);
    const bool whole = !ferror(to);
    return fclose(to) == 0 && whole ? STATUS_OK : STATUS_NO_MEMORY;
}

static Status gather_scenery(SavedFrame *file, const FrameScenery *scenery)
{
    SavedScenery *to = &file->scenery;
    file->built = scenery && (scenery->culture.index || scenery->culture.trees > 0 || scenery->scenery.objects > 0);
    if (!file->built) return STATUS_OK;
    *to = (SavedScenery){.plan = scenery->plan,
                         .drivens = scenery->drivens,
                         .driven = scenery->driven,
                         .objects = scenery->scenery.objects};
    if (to->plan.from == CULTURE_FROM_RECORDS) to->culture = scenery->culture;
    return saved_scenery_sha256(to->sha256, &scenery->scenery);
}

/* Lists each model of the snapshot once. */
static Status list_models(SavedFrame *file, const Catalog *catalog, Arena *arena)
{
    const Snapshot *s = &file->snapshot;
    const int       models = catalog_model_count(catalog);
    bool           *listed = arena_alloc(arena, (size_t)models + 1, sizeof *listed);
    file->model = arena_alloc(arena, (size_t)models + 1, sizeof *file->model);
    if (!listed || !file->model) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int e = 0; e < s->count && status == STATUS_OK; e++) {
        const int m = s->entity[e].model;
        if (m < 0 || m >= models || listed[m]) continue;
        const Model *model = catalog_model(catalog, m);
        SavedModel  *to = &file->model[file->model_count++];
        listed[m] = true;
        to->model = m;
        to->node_count = model->node_count;
        snprintf(to->name, sizeof to->name, "%s", model->name);
        status = saved_model_sha256(to->sha256, model);
    }
    return status;
}

/* Poses the nodes of all entities, since the snapshot of a frame poses only those that are rendered. joint: the values
 * of their joints. */
static Status pose_nodes(SavedFrame *file, double **joint, const Catalog *catalog, Arena *arena)
{
    Snapshot    *s = &file->snapshot;
    const size_t nodes = (size_t)s->node_count + 1;
    NodePose    *pose = arena_alloc(arena, nodes, sizeof *pose);
    *joint = arena_alloc(arena, nodes, sizeof **joint);
    if (!pose || !*joint) return STATUS_NO_MEMORY;
    if (s->node) return STATUS_OK;
    for (size_t n = 0; n < nodes; n++) m3_identity(pose[n].r_body_from_node); /* of those that are not seen */
    for (int e = 0; e < s->count; e++) {
        const int m = s->entity[e].model, n = s->entity[e].first_node;
        if (m >= 0) snapshot_pose(pose + n, *joint + n, s, e, catalog_model(catalog, m));
    }
    s->node = pose;
    return STATUS_OK;
}

static Status gather(SavedFrame *file, SavedMade *made, char **settings, const FrameSave *save, Arena *arena)
{
    const Frame *f = save->frame;
    char         catalog[path_size];
    double      *joint;
    *file = (SavedFrame){.version = f->provenance.version,
                         .host = f->host,
                         .config_sha256 = f->provenance.config_sha256,
                         .frame = f->number,
                         .time_s = f->time_s,
                         .unix_s = save->unix_s,
                         .snapshot = f->seen.snapshot,
                         .request = f->request,
                         .eye = *save->eye,
                         .rate_px_s = {f->rate_px_s[0], f->rate_px_s[1]},
                         .ground_km2 = f->record.ground_km2,
                         .at_limit = f->record.gimbal_at_limit,
                         .all_on_ground = save->all_on_ground};
    memcpy(file->r_ecef_from_body, f->record.r_ecef_from_body, sizeof file->r_ecef_from_body);
    landscape_parts(&file->ground, f->world->landscape);
    file->planted = save->woods != NULL;
    if (file->planted) file->woods = *save->woods;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = gather_scenery(file, save->scenery);
    if (status == STATUS_OK) status = saved_tables(&file->tables, save->config, catalog);
    if (status == STATUS_OK) status = write_settings(settings, save->config);
    if (status == STATUS_OK) status = pose_nodes(file, &joint, f->world->catalog, arena);
    if (status == STATUS_OK) status = list_models(file, f->world->catalog, arena);
    if (status == STATUS_OK) status = saved_made(made, f->seen.plane, f->seen.plane_count);
    if (status == STATUS_OK && radar_of(f)) status = saved_radar_gather(file, radar_of(f), joint);
    if (status != STATUS_OK) return status;
    file->settings = *settings;
    file->plane = made->plane;
    file->plane_count = made->plane_count;
    memcpy(file->frame_sha256, made->sha256, sizeof file->frame_sha256);
    return STATUS_OK;
}

/* Gathers the points where the frame's rays hit the ground or entities on it, the sensor, the origin, and smoke on the
 * ground. */
static Status gather_places(GroundCutout *out, const Frame *f, Arena *arena)
{
    const Picture    *picture = &f->seen.picture;
    const View       *view = &f->request.view;
    const Snapshot   *snapshot = &f->seen.snapshot;
    const LocalFrame *frame = &f->world->frame;
    const size_t      most = (size_t)picture->width * (size_t)picture->height + (size_t)snapshot->puff_count + 2;
    double(*place)[2] = arena_alloc(arena, most, sizeof *place);
    int n = 1; /* the first is the origin */
    if (!place) return STATUS_NO_MEMORY;
    memcpy(place[n++], view->p_enu, sizeof *place);
    for (int y = 0; y < picture->height; y++)
        for (int x = 0; x < picture->width; x++) {
            const double range_m = (double)picture->range_m[(size_t)y * (size_t)picture->width + (size_t)x];
            double       d_enu[3];
            if (!isfinite(range_m)) continue;
            view_ray(d_enu, view, x + 0.5, y + 0.5);
            for (int k = 0; k < 2; k++) place[n][k] = view->p_enu[k] + range_m * d_enu[k];
            n++;
        }
    for (int p = 0; p < snapshot->puff_count; p++) {
        double p_enu[3];
        if (!snapshot->puff[p].grounded) continue;
        enu_from_ecef(p_enu, frame, snapshot->puff[p].p_ecef);
        memcpy(place[n++], p_enu, sizeof *place);
    }
    *out = (GroundCutout){.count = n, .p_m = (const double(*)[2])place};
    return STATUS_OK;
}

/* ---- verified ------------------------------------------------------------------------------------- */

/* Whether the octets give the same planes, and the same map by a radar; NULL: there is none. What follows from the
 * file's plants and this installation's tables is taken from the run's cache. */
static Status prove(bool *same, const ByteSink *bytes, const FrameSave *save, SeekerRadar *radar, Arena *arena)
{
    const RadarFrame *measured;
    const Frame      *f = save->frame;
    SavedFrame        file;
    SavedAgain       *again = arena_alloc(arena, 1, sizeof *again);
    Landscape         landscape = {0};
    World             world = {0};
    Woods             woods = {0};
    FrameScenery      scenery = {0};
    const SavedStage  stage = {&file, &file.snapshot, &world, save->config, save->pool, arena};
    char              follows[saved_follows_size];
    *same = false;
    if (!again) return STATUS_NO_MEMORY;
    Status status = saved_frame_parse(&file, bytes->bytes, bytes->count, "the file just made", arena);
    if (status == STATUS_OK) status = saved_ground_open(&landscape, &file.ground);
    if (status == STATUS_OK) status = saved_scenery_make(&scenery, &landscape, &file, false);
    if (status == STATUS_OK)
        status = frame_world(&world, save->config, f->world->catalog, &landscape, &file.ground.frame, "avx2");
    if (status == STATUS_OK) {
        world_keep(&world, f->world->cache);
        status = saved_ground_plant(&world, &woods, &file, &scenery.culture, save->config,
                                    saved_follows(follows, &file, &file.tables) ? follows : NULL, "avx2", save->pool);
    }
    if (status == STATUS_OK && scenery.scenery.objects > 0)
        status = world_scenery(&world, &scenery.scenery, "avx2", save->pool);
    if (status == STATUS_OK) status = frame_world_warm(&world, save->config, file.unix_s, save->pool);
    if (status == STATUS_OK) {
        file.snapshot.effect_table = f->seen.snapshot.effect_table;
        status = saved_again(again, &stage, false);
    }
    if (status == STATUS_OK) *same = saved_differences(&file, &again->made, false) == 0;
    if (*same && radar) {
        *same = false;
        status = saved_radar_again(&measured, radar, &stage, &again->picture);
        if (status == STATUS_OK) status = saved_radar_same(same, &file, measured);
    }
    world_close(&world);
    woods_destroy(&woods);
    frame_scenery_free(&scenery);
    landscape_destroy(&landscape);
    return status;
}

/* Packs the smallest of a few cut-outs that gives the same bits. reach_m: how far it reaches. The first cut-out has the
 * ground that is directly visible; glossy surfaces reflect hills that are farther away than those in the image. */
static Status pack_proved(ByteSink *bytes, double *reach_m, const SavedFrame *file, const FrameSave *save,
                          Arena *gathered)
{
    static const double reaches_m[][2] = {{100, 100}, {3000, 100}, {20000, 100}, {20000, 3000}, {INFINITY, INFINITY}};
    GroundCutout        kept = {0};
    Arena              *arena = arena_create();
    SeekerRadar        *radar = NULL;
    bool                same = false;
    Status              status = arena ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && file->measured)
        status = radar_open(&radar, save->config, "avx2", false, save->frame->world->cache);
    if (save->frame->world->forest) forest_keep_found(save->frame->world->forest); /* what the frame found is there */
    /* where plants and clutter stand, and how far walls reach down, follows from all of the ground */
    const bool whole = file->planted || file->built;
    const bool cut = !file->ground.invented && !(file->ground.store && *file->ground.store) && !whole;
    if (status == STATUS_OK && cut) status = gather_places(&kept, save->frame, gathered);
    for (size_t r = 0; r < sizeof reaches_m / sizeof *reaches_m && status == STATUS_OK && !same; r++) {
        if (!cut && isfinite(reaches_m[r][0])) continue;
        *reach_m = kept.reach_m = reaches_m[r][0];
        kept.looks_reach_m = reaches_m[r][1];
        sink_free(bytes);
        arena_reset(arena);
        status = saved_frame_pack(bytes, file, &kept);
        if (status == STATUS_OK) status = prove(&same, bytes, save, radar, arena);
    }
    if (status == STATUS_OK && !same) {
        log_error("frame: frame %d, rendered again from its file, is another picture; nothing is written. Please "
                  "report this",
                  file->frame);
        status = STATUS_BAD_VALUE;
    }
    seeker_radar_destroy(radar);
    arena_destroy(arena);
    return status;
}

/* Written next to its final path and renamed: a file is complete or absent. */
static Status write_file(const char *path, const ByteSink *bytes)
{
    FILE *to = output_begin(path, 0);
    if (to) fwrite(bytes->bytes, 1, bytes->count, to);
    if (to && output_end(to, path)) return STATUS_OK;
    log_error("frame: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}

Status frame_save(const FrameSave *save)
{
    char        path[path_size], *settings = NULL;
    ByteSink    bytes = {0};
    double      reach_m = INFINITY;
    Arena      *arena = arena_create();
    SavedFrame *file = arena ? arena_alloc(arena, 1, sizeof *file) : NULL;
    SavedMade  *made = arena ? arena_alloc(arena, 1, sizeof *made) : NULL;
    Status      status = file && made ? STATUS_OK : STATUS_NO_MEMORY;
    if (snprintf(path, sizeof path, "%s/frame_%06d.pvf", save->out, save->frame->number) >= (int)sizeof path)
        status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = gather(file, made, &settings, save, arena);
    if (status == STATUS_OK) status = pack_proved(&bytes, &reach_m, file, save, arena);
    if (status == STATUS_OK) status = write_file(path, &bytes);
    if (status == STATUS_OK && !file->ground.invented && isfinite(reach_m))
        log_print("frame %d: %s, %.0f KB; ground within %.0f m of what is seen\n", file->frame, path,
                  1e-3 * (double)bytes.count, reach_m);
    else if (status == STATUS_OK) log_print("frame %d: %s, %.0f KB\n", file->frame, path, 1e-3 * (double)bytes.count);
    free(settings);
    sink_free(&bytes);
    arena_destroy(arena);
    return status;
}
