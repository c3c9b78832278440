/* sensor/verify/saved_frame/saved_scene.c: what a frame file needs from this installation: tables, ground, plants,
 * models, sensors. */
#include "sensor/verify/saved_frame/saved_scene.h"
#include "sensor/verify/saved_frame/saved_frame_private.h"
#include "sensor/frame/frame_world.h"
#include "terrain/store/store.h"
#include "pitviper_output.h"
#include "sensor/settings/config.h"

#include <stdlib.h>
#include <unistd.h>

/* ---- tables of etc/ and of the user, by SHA-256 -------------------------------------------------- */

static Status add_own(TablesUsed *out, const char *name, const char *path)
{
    if (!*path || out->count == tables_used_max) return STATUS_OK;
    TableUsed *t = &out->table[out->count];
    snprintf(t->name, sizeof t->name, "%s", name);
    const Status status = sha256_file(t->sha256, path);
    out->count += status == STATUS_OK;
    return status;
}

Status saved_tables(TablesUsed *out, const Config *config, const char *catalog)
{
    Status status = tables_used(out, config, catalog);
    if (status == STATUS_OK) status = add_own(out, "models.catalog", config->models.catalog);
    if (status == STATUS_OK) status = add_own(out, "models.materials", config->models.materials);
    return status;
}

/* ---- the ground, and its plants ------------------------------------------------------------------ */

/* Of a terrain store, which may have gigabytes, the file has the path and the hash of the content. */
static Status open_store(Landscape *out, const LandscapeParts *parts)
{
    const Status status = store_open_landscape(out, parts->store, parts->config.seed);
    if (status != STATUS_OK) {
        log_error("frame: the frame was made over the terrain store %s; put it back there, or make it again with "
                  "`pitviper terrain import` from the same files",
                  parts->store);
        return status;
    }
    if (landscape_map(out).content == parts->store_content) return STATUS_OK;
    log_error("frame: the terrain store %s is not the one that the frame was made over: its content has another hash; "
              "put the old one back, or make it again with `pitviper terrain import` from the same files",
              parts->store);
    landscape_destroy(out);
    return STATUS_BAD_VALUE;
}

Status saved_ground_open(Landscape *out, const LandscapeParts *parts)
{
    if (parts->store && *parts->store) return open_store(out, parts);
    const char  *why = NULL;
    const Status status = landscape_from_parts(out, &why, parts);
    if (status == STATUS_BAD_VALUE)
        log_error("frame: the ground in the file cannot be used: %s", why ? why : "values out of range");
    return status;
}

bool saved_follows(char out[saved_follows_size], const SavedFrame *file, const TablesUsed *tables)
{
    Sha256 *digest = sha256_begin();
    bool    good = digest != NULL;
    for (int i = 0; i < tables->count && good; i++) {
        const TableUsed *t = &tables->table[i];
        good = sha256_add(digest, t->name, strlen(t->name) + 1) && sha256_add(digest, t->sha256, sizeof t->sha256 - 1);
    }
    snprintf(out, sha256_text_size + 1, "%.64s ", file->ground_sha256);
    return digest && sha256_end(out + strlen(out), digest, good) == STATUS_OK;
}

Status saved_ground_plant(World *world, Woods *woods, const SavedFrame *file, const Culture *culture,
                          const Config *config, const char *follows, const char *isa, Pool *pool)
{
    WoodsConfig how = file->woods;
    if (!file->planted) return STATUS_OK;
    how.culture = culture->index || culture->trees > 0 ? culture : NULL;
    how.store = file->ground.store && *file->ground.store ? file->ground.store : NULL;
    how.cache = how.store ? NULL : world->cache, how.follows = follows;
    const Status status = woods_create(woods, world->landscape, &how, pool);
    if (status == STATUS_OK) return frame_world_plant(world, woods, config, isa, pool);
    log_error("frame: its plants cannot be grown again: %s", status_name(status));
    return status;
}

/* The world of a frame file, from its own ground and this installation's tables. */

enum { path_size = 4096 };

/* ---- settings ----------------------------------------------------------------------------------- */

static Status read_settings(Config *config, const SavedFrame *file)
{
    char         path[temp_path_size];
    const Config plain = config_default();
    *config = plain;
    if (!temp_file(path, ".yaml")) return STATUS_IO;
    FILE      *to = output_file(path, 0);
    const bool put = to && fputs(file->settings, to) >= 0, closed = to && fclose(to) == 0;
    if (!put || !closed) log_error("frame: cannot write %s", path);
    const Status status = put && closed ? config_read(config, path) : STATUS_IO;
    unlink(path);
    const bool cached = config->cache.on;
    config->cache = plain.cache; /* no file from elsewhere says where this machine keeps things */
    config->cache.on = cached;
    return status;
}

/* Channels first: sensors and tables depend on them. Samples may have been selected for the frame (quality.*), and
 * the image size by its sensor. */
static Status choose_sensors(SavedScene *s, const SavedFrame *file)
{
    const RenderRequest *r = &file->request;
    unsigned             bands;
    if (!config_bands_choose(&bands, s->config.sensor.bands)) return STATUS_BAD_VALUE;
    if (bands != r->bands) {
        log_error("frame: the bands of the request are not those of the settings (sensor.bands)");
        return STATUS_BAD_VALUE;
    }
    Choices *choices = calloc(1, sizeof *choices);
    if (!choices) return STATUS_NO_MEMORY;
    const Status status = sensors_choose(&s->sensors, choices, &s->config, r->bands);
    free(choices);
    s->config.sensor.width_px = r->view.width;
    s->config.sensor.height_px = r->view.height;
    s->config.sensor.samples = r->samples;
    if (r->edge_samples > 0) s->config.sensor.edge_samples = r->edge_samples;
    return status;
}

/* ---- compared ----------------------------------------------------------------------------------- */

static const TableUsed *table_named(const TablesUsed *tables, const char *name)
{
    for (int i = 0; i < tables->count; i++)
        if (strcmp(tables->table[i].name, name) == 0) return &tables->table[i];
    return NULL;
}

void saved_say(bool forced, const char *name, const char *what)
{
    if (forced) log_warn("frame: %s %s", name, what);
    else log_error("frame: %s %s; the frame cannot be the same. --force renders it with what is here", name, what);
}

static int compare_tables(const TablesUsed *was, const TablesUsed *is, bool forced)
{
    int differ = 0;
    for (int i = 0; i < was->count; i++) {
        const TableUsed *here = table_named(is, was->table[i].name);
        if (here && strcmp(here->sha256, was->table[i].sha256) == 0) continue;
        differ++;
        saved_say(forced, was->table[i].name, here ? "is not the table that the frame was made with" : "is not here");
    }
    for (int i = 0; i < is->count; i++) {
        if (table_named(was, is->table[i].name)) continue;
        differ++;
        saved_say(forced, is->table[i].name, "is here, and was not where the frame was made");
    }
    return differ;
}

/* Every entity's model by its type, as the entity table finds it; each model's facets by hash. Nodes that do not
 * match cannot be forced: their poses are the file's. */
static Status take_models(SavedScene *s, const SavedFrame *file, bool forced)
{
    Status status = STATUS_OK;
    bool   fits = true;
    s->snapshot = file->snapshot;
    for (int i = 0; i < file->model_count && status == STATUS_OK; i++) {
        const SavedModel *was = &file->model[i];
        int               here = -1;
        for (int e = 0; e < s->snapshot.count; e++) { /* the file's array is the reader's own */
            SnapshotEntity *entity = &file->snapshot.entity[e];
            if (entity->model != was->model) continue;
            const int found = catalog_find(s->catalog, entity->type, NULL, NULL);
            if (here >= 0 && found != here) fits = false;
            here = found;
        }
        if (here < 0) continue;
        char         sha256[sha256_text_size];
        const Model *model = catalog_model(s->catalog, here);
        status = saved_model_sha256(sha256, model);
        const bool same = status == STATUS_OK && here == was->model && strcmp(sha256, was->sha256) == 0;
        if (!same) saved_say(forced, was->name, "is not the model that the frame was made with");
        fits &= model->node_count == was->node_count && (same || forced) && here == was->model;
    }
    if (status == STATUS_OK && !fits) {
        if (forced) log_error("frame: models with other parts cannot take the poses of the file");
        status = STATUS_BAD_VALUE;
    }
    return status;
}

/* ---- all of it ---------------------------------------------------------------------------------- */

Status saved_scene_open(SavedScene *s, const SavedFrame *file, bool forced, const char *isa, Pool *pool)
{
    char       catalog[path_size], effects[path_size], follows[saved_follows_size];
    TablesUsed here;
    *s = (SavedScene){0};
    Status status = read_settings(&s->config, file);
    if (status == STATUS_OK) status = config_own_tables(&s->config);
    if (status == STATUS_OK) status = choose_sensors(s, file);
    if (!etc_path(catalog, sizeof catalog, "catalog.csv") || !etc_path(effects, sizeof effects, "effects.csv"))
        return STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = saved_tables(&here, &s->config, catalog);
    if (status == STATUS_OK) s->tables_differ = compare_tables(&file->tables, &here, forced);
    if (status == STATUS_OK && s->tables_differ > 0 && !forced) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = catalog_open(&s->catalog, catalog, s->config.models.sag_m);
    if (status == STATUS_OK) status = take_models(s, file, forced);
    if (status == STATUS_OK) status = effect_table_open(&s->effects, effects);
    if (status == STATUS_OK) status = saved_ground_open(&s->landscape, &file->ground);
    if (status == STATUS_OK) status = saved_scenery_make(&s->scenery, &s->landscape, file, forced);
    if (status == STATUS_OK)
        status = frame_world(&s->world, &s->config, s->catalog, &s->landscape, &file->ground.frame, isa);
    if (status == STATUS_OK) world_keep(&s->world, s->cache = frame_world_cache(&s->config));
    if (status == STATUS_OK)
        status = saved_ground_plant(&s->world, &s->woods, file, &s->scenery.culture, &s->config,
                                    saved_follows(follows, file, &here) ? follows : NULL, isa, pool);
    if (status == STATUS_OK && s->scenery.scenery.objects > 0)
        status = world_scenery(&s->world, &s->scenery.scenery, isa, pool);
    if (status == STATUS_OK) status = frame_world_warm(&s->world, &s->config, file->unix_s, pool);
    s->snapshot.effect_table = &s->effects;
    return status;
}

void saved_scene_close(SavedScene *s)
{
    world_close(&s->world);
    woods_destroy(&s->woods);
    frame_scenery_free(&s->scenery);
    landscape_destroy(&s->landscape);
    catalog_close(s->catalog);
    cache_close(s->cache);
    *s = (SavedScene){0};
}
