/* sensor/node/run/made_world.c: the layers of a run's world: taken over where their keys are equal, else made. */
#include "sensor/node/run/made_world.h"

#include "pitviper_channels.h"
#include "sensor/frame/frame_world.h"
#include "sensor/node/player/player.h"
#include "terrain/culture/culture_ground.h"

#include <malloc.h>
#include <stdlib.h>
#include <sys/stat.h>

static const char *const layer_name[MADE_LAYERS] = {"log",   "survey", "catalog", "ground", "culture",
                                                    "woods", "models", "air",     "warmth"};

/* Keys of the configuration that a layer may follow from (config_part). */
static const char *const layer_keys[MADE_LAYERS] = {
    [MADE_LOG] = "exercise.port exercise.causal node.site node.application",
    [MADE_SURVEY] = "",
    [MADE_CATALOG] = "models.",
    [MADE_GROUND] =
        "seed terrain. -terrain.woods -terrain.detail -terrain.buildings -terrain.trees -terrain.clutter -terrain.lamps",
    [MADE_CULTURE] = "seed terrain.buildings terrain.trees terrain.clutter terrain.lamps",
    [MADE_WOODS] =
        "seed terrain. -terrain.detail -terrain.buildings -terrain.trees -terrain.clutter -terrain.lamps -terrain.woods_level1_px -terrain.woods_tables -terrain.woods_sway "
        "-terrain.woods_low_m -terrain.woods_far_m -terrain.woods_far_mb",
    [MADE_MODELS] = "models. terrain.detail terrain.woods_leaves terrain.woods_level1_px terrain.woods_tables "
                    "terrain.woods_sway terrain.woods_far_m terrain.woods_far_mb",
    [MADE_AIR] = "weather.atmosphere weather.visibility_m weather.fog",
    [MADE_WARM] = "weather. heat.step_s heat.facets heat.shadow_m",
};

/* ---- life ------------------------------------------------------------------------------------------- */

Status made_world_create(MadeWorld **out)
{
    *out = calloc(1, sizeof **out);
    return *out ? STATUS_OK : STATUS_NO_MEMORY;
}

static void take_down(MadeWorld *m, MadeLayer layer)
{
    switch (layer) {
    case MADE_LOG:
        dis_log_close(&m->log);
        m->log = (DisLog){0};
        free(m->retimed);
        m->retimed = NULL;
        break;
    case MADE_SURVEY:
        survey_destroy(&m->survey);
        survey_destroy(&m->basis);
        m->survey = m->basis = (Survey){0};
        m->has_basis = false;
        break;
    case MADE_CATALOG:
        catalog_close(m->catalog);
        m->catalog = NULL;
        break;
    case MADE_GROUND:
        landscape_destroy(&m->landscape);
        m->landscape = (Landscape){0};
        break;
    case MADE_CULTURE:
        if (m->scenery.culture.index) culture_lay(&m->landscape, NULL);
        frame_scenery_free(&m->scenery);
        break;
    case MADE_WOODS:
        choice_woods_free(&m->woods);
        break;
    case MADE_MODELS:
        world_close(&m->world);
        break;
    case MADE_AIR: /* frame_world_air and frame_world_warm put others in their place */
    case MADE_WARM:
    case MADE_LAYERS:
        break;
    }
    m->key[layer][0] = 0;
    m->said[layer].count = 0;
}

/* Takes down a layer and all that stand on it. The catalog of models follows from neither log nor survey, and stays;
 * ground of a place does too. */
static void take_down_from(MadeWorld *m, MadeLayer layer)
{
    const bool placed = *m->key[MADE_GROUND] && *m->part[MADE_GROUND].terrain.place;
    for (int at = MADE_LAYERS - 1; at >= (int)layer; at--) {
        const bool stays = layer < MADE_CATALOG && (at == MADE_CATALOG || (at == MADE_GROUND && placed));
        if (!stays) take_down(m, (MadeLayer)at);
    }
}

void made_world_destroy(MadeWorld *m)
{
    if (!m) return;
    take_down_from(m, MADE_LOG);
    take_down_from(m, MADE_CATALOG);
    pool_destroy(m->pool);
    cache_close(m->cache);
    free(m);
}

/* ---- keys ------------------------------------------------------------------------------------------- */

typedef struct Key {
    Sha256 *digest;
    bool    good;
} Key;

static void add(Key *key, const void *octets, size_t count)
{
    key->good = key->good && sha256_add(key->digest, octets, count);
}

static void add_text(Key *key, const char *text) { add(key, text, strlen(text) + 1); }

/* Begins with the layer's settings, which it puts into *part. */
static Key key_of(Config *part, MadeLayer layer, const Config *config)
{
    char text[config_text_size];
    Key  key = {sha256_begin(), true};
    key.good = key.digest;
    config_part(part, config, layer_keys[layer]);
    config_text(text, sizeof text, part);
    add_text(&key, text);
    return key;
}

/* Whether the layer is there by this key, which it ends. Else it is taken down, and `key` is what it gets when it is
 * made; empty where there was no memory for it: such a layer is equal to none. */
static bool is_there(char key_text[sha256_text_size], MadeWorld *m, MadeLayer layer, Key *key)
{
    if (!key->digest || sha256_end(key_text, key->digest, key->good) != STATUS_OK) key_text[0] = 0;
    if (*key_text && strcmp(key_text, m->key[layer]) == 0) return true;
    take_down_from(m, layer);
    return false;
}

/* What was made is there from here on; what failed is not. */
static Status done(MadeWorld *m, MadeLayer layer, const char key_text[sha256_text_size], Status status)
{
    if (status != STATUS_OK) {
        take_down_from(m, layer);
        return status;
    }
    strcpy(m->key[layer], key_text);
    m->made[layer]++;
    log_detail("world: %s made", layer_name[layer]);
    return STATUS_OK;
}

static void say(Choices *choices, const Choices *lines)
{
    for (int i = 0; i < lines->count; i++) choice_add(choices, "%s", lines->line[i]);
}

static bool begins(const char *text, const char *with) { return strncmp(text, with, strlen(with)) == 0; }

/* The tables that a layer may read, by content, and the channels that stand in their places. Of air: those of the
 * atmosphere. What only detector, radar and given heat read is in no layer. */
static void add_tables(Key *key, const TablesUsed *tables, const Config *config, bool air)
{
    const char *slash = strrchr(config->sensor.table, '/'), *sheet = slash ? slash + 1 : config->sensor.table;
    for (int i = 0; i < tables->count; i++) {
        const TableUsed *t = &tables->table[i];
        if (begins(t->name, "radar/") || begins(t->name, "heat/")) continue;
        if (!air && (begins(t->name, "atmosphere/") || begins(t->name, "weather/"))) continue;
        if (strcmp(t->name, "sensors.csv") == 0 || strcmp(t->name, "radars.csv") == 0) continue;
        bool again = false; /* a sheet is listed after the tables */
        for (int k = 0; k < i; k++) again |= strcmp(tables->table[k].name, t->name) == 0;
        if (*sheet && strcmp(t->name, sheet) == 0 && (again || !strstr(sheet, ".csv"))) continue;
        add_text(key, t->name);
        add_text(key, t->sha256);
    }
    for (int p = 0; p < SPECTRAL_PLACES; p++) add_text(key, channel_in((ChannelPlace)p)->name);
}

/* The user's own tables, by content. */
static void add_own(Key *key, const Config *config)
{
    const char *const own[] = {config->models.catalog, config->models.materials};
    char              sha256[sha256_text_size];
    for (int i = 0; i < 2; i++) {
        if (!*own[i]) continue;
        key->good = key->good && sha256_file(sha256, own[i]) == STATUS_OK;
        add_text(key, sha256);
    }
}

/* The table of clutter, by content. */
static void add_clutter(Key *key, const Config *config)
{
    char path[1024], sha256[sha256_text_size];
    if (!(config->terrain.clutter > 0)) return;
    key->good = key->good && clutter_table_path(path, sizeof path, config->terrain.clutter_table) &&
                sha256_file(sha256, path) == STATUS_OK;
    if (key->good) add_text(key, sha256);
}

/* ---- log, survey, catalog --------------------------------------------------------------------------- */

static void hash_octets(void *user, const void *octets, size_t count) { add(user, octets, count); }

/* A causal replay takes arrival times as a live node received them, independent of the time stamps. What its world
 * follows from may have the others. */
static Status take_times(MadeWorld *m, bool causal)
{
    DisLog *log = &m->log;
    if (!log->retimed) {
        for (int i = 0; causal && i < log->count; i++) log->datagram[i].capture_s = log->datagram[i].packet_s;
        return STATUS_OK;
    }
    m->retimed = malloc(((size_t)log->count + 1) * sizeof *m->retimed);
    if (!m->retimed) return STATUS_NO_MEMORY;
    memcpy(m->retimed, log->datagram, (size_t)log->count * sizeof *m->retimed);
    DisDatagram *by_packets = causal ? log->datagram : m->retimed;
    for (int i = 0; i < log->count; i++) by_packets[i].capture_s = by_packets[i].packet_s;
    if (causal)
        log_warn("replay: the packet times do not keep pace with the time stamps; --causal takes them as they are");
    log->retimed = !causal;
    return STATUS_OK;
}

DisLog made_log_by(const MadeWorld *m, const Config *config, bool packet_times)
{
    DisLog log = m->log;
    if (m->retimed && packet_times != config->exercise.causal) log.datagram = m->retimed, log.retimed = !packet_times;
    return log;
}

static Status open_log(MadeWorld *m, const char *path, const Config *config)
{
    Key    hash = {sha256_begin(), true}; /* of the octets as they are read: once */
    Status status =
        hash.digest ? dis_log_open_read(&m->log, path, config->exercise.port, hash_octets, &hash) : STATUS_NO_MEMORY;
    if (hash.digest) {
        const Status ended = sha256_end(m->log_sha256, hash.digest, hash.good);
        if (status == STATUS_OK) status = ended;
    }
    if (status != STATUS_OK) return status;
    m->own = (uint64_t)player_drop_own(&m->log, config);
    return take_times(m, config->exercise.causal);
}

Status made_log(MadeWorld *m, const char *path, const Config *config)
{
    char        key_text[sha256_text_size];
    struct stat at;
    Key         key = key_of(&m->part[MADE_LOG], MADE_LOG, config);
    add(&key, &config->exercise.port, sizeof config->exercise.port); /* not in the hashed text */
    add_text(&key, path);
    key.good = key.good && stat(path, &at) == 0 && S_ISREG(at.st_mode) && !config->exercise.causal;
    if (key.good) {
        const int64_t of[] = {(int64_t)at.st_dev,         (int64_t)at.st_ino,          (int64_t)at.st_size,
                              (int64_t)at.st_mtim.tv_sec, (int64_t)at.st_mtim.tv_nsec, (int64_t)at.st_ctim.tv_sec,
                              (int64_t)at.st_ctim.tv_nsec};
        add(&key, of, sizeof of);
    }
    if (is_there(key_text, m, MADE_LOG, &key) && !dis_log_failed(&m->log)) return STATUS_OK;
    take_down_from(m, MADE_LOG);
    return done(m, MADE_LOG, key_text, open_log(m, path, &m->part[MADE_LOG]));
}

/* The key of a part of a log, or of what a live node heard, is empty. */
Status made_survey(MadeWorld *m, const DisLog *heard, int exercise)
{
    char key_text[sha256_text_size];
    Key  key = key_of(&m->part[MADE_SURVEY], MADE_SURVEY, &m->part[MADE_LOG]);
    key.good = key.good && *m->key[MADE_LOG] && heard->datagram == m->log.datagram && heard->count == m->log.count;
    add(&key, &exercise, sizeof exercise);
    if (is_there(key_text, m, MADE_SURVEY, &key)) return STATUS_OK;
    return done(m, MADE_SURVEY, key_text, survey_log(&m->survey, heard, exercise));
}

Status made_basis(MadeWorld *m, const DisLog *from, const DisLog *heard, int exercise)
{
    if (m->has_basis) survey_destroy(&m->basis);
    m->has_basis = false;
    if (from->datagram == heard->datagram && from->count == heard->count) return STATUS_OK;
    const Status status = survey_log(&m->basis, from, exercise);
    m->has_basis = status == STATUS_OK;
    return status;
}

const Survey *made_basis_survey(const MadeWorld *m) { return m->has_basis ? &m->basis : &m->survey; }

Status made_catalog(MadeWorld *m, const Config *config, const TablesUsed *tables)
{
    char         key_text[sha256_text_size], path[4096];
    Config      *part = &m->part[MADE_CATALOG];
    Key          key = key_of(part, MADE_CATALOG, config);
    const Status found = etc_path(path, sizeof path, "catalog.csv") ? STATUS_OK : STATUS_BAD_VALUE;
    key.good = key.good && *m->key[MADE_SURVEY];
    add_tables(&key, tables, config, false);
    add_own(&key, config);
    if (is_there(key_text, m, MADE_CATALOG, &key)) return STATUS_OK;
    return done(m, MADE_CATALOG, key_text,
                found == STATUS_OK ? catalog_open(&m->catalog, path, part->models.sag_m) : found);
}

Status made_pool(MadeWorld *m, int threads)
{
    if (m->pool && m->threads == threads) return STATUS_OK;
    take_down_from(m, MADE_GROUND); /* heat keeps a pointer to the pool */
    pool_destroy(m->pool);
    m->pool = NULL;
    m->threads = threads;
    return pool_create(&m->pool, threads);
}

void made_cache(MadeWorld *m, const Config *config)
{
    if (!m->cache) m->cache = frame_world_cache(config);
}

/* ---- the world -------------------------------------------------------------------------------------- */

static void add_frame(Key *key, const LocalFrame *frame)
{
    const double origin[] = {frame->origin.lat_rad, frame->origin.lon_rad, frame->origin.h_m};
    add(key, origin, sizeof origin);
    add(key, frame->origin_ecef, sizeof frame->origin_ecef);
    add(key, frame->r_ecef_from_enu, sizeof frame->r_ecef_from_enu);
}

static Status need_ground(MadeWorld *m, const MadeOf *of, const GroundEvidence *evidence)
{
    char       key_text[sha256_text_size];
    Config    *part = &m->part[MADE_GROUND];
    Key        key = key_of(part, MADE_GROUND, of->config);
    const bool placed = *part->terrain.place;
    add_frame(&key, of->frame);
    key.good = key.good && *m->key[MADE_CATALOG] && (placed || choice_evidence_hash(key.digest, evidence));
    const bool        there = is_there(key_text, m, MADE_GROUND, &key);
    const ChoiceBasis basis = {made_basis_survey(m), part, m->catalog, evidence, m->cache, NULL};
    if (placed) {
        const Status status =
            there ? STATUS_OK : done(m, MADE_GROUND, key_text, choice_placed_ground(&m->landscape, part, m->cache));
        m->said[MADE_GROUND].count = 0; /* what is said of the exercise is another with each log */
        if (status != STATUS_OK) return status;
        return choice_placed_contact(&m->contact, &m->said[MADE_GROUND], &basis, &m->landscape);
    }
    if (there) return STATUS_OK;
    return done(m, MADE_GROUND, key_text,
                choice_ground(&m->landscape, &m->contact, &m->said[MADE_GROUND], &basis, of->frame));
}

static void add_square(Key *key, const WoodsSquare *square)
{
    add(key, square->centre_m, sizeof square->centre_m);
    add(key, &square->half_width_m, sizeof square->half_width_m);
    add(key, &square->own, sizeof square->own);
}

static Status need_culture(MadeWorld *m, const MadeOf *of, const GroundEvidence *evidence)
{
    char    key_text[sha256_text_size];
    Config *part = &m->part[MADE_CULTURE];
    Key     key = key_of(part, MADE_CULTURE, of->config);
    add_square(&key, of->square);
    add_clutter(&key, part);
    /* ground that the log has made keeps what it says of vehicles; placed ground has none of it */
    const bool placed = *of->config->terrain.place;
    key.good = key.good && *m->key[MADE_GROUND] && (!placed || choice_evidence_hash(key.digest, evidence)) &&
               (strcmp(part->terrain.buildings, "off") == 0 || choice_harm_hash(key.digest, made_basis_survey(m)));
    if (is_there(key_text, m, MADE_CULTURE, &key)) return STATUS_OK;
    const ChoiceBasis basis = {made_basis_survey(m), part, m->catalog, placed ? evidence : NULL, m->cache, NULL};
    const Status      status = choice_scenery(&m->scenery, &m->said[MADE_CULTURE], &basis, of->square, &m->landscape);
    if (status == STATUS_OK && m->scenery.culture.index) culture_lay(&m->landscape, &m->scenery.culture);
    return done(m, MADE_CULTURE, key_text, status);
}

static Status need_woods(MadeWorld *m, const MadeOf *of, const GroundEvidence *evidence)
{
    char    key_text[sha256_text_size];
    Config *part = &m->part[MADE_WOODS];
    Key     key = key_of(part, MADE_WOODS, of->config);
    add_square(&key, of->square);
    key.good = key.good && *m->key[MADE_CULTURE] && choice_evidence_hash(key.digest, evidence);
    if (is_there(key_text, m, MADE_WOODS, &key)) return STATUS_OK;
    char follows[4 * sha256_text_size]; /* settings, tables, frame and evidence by content; paths of vehicles are in
                                           WoodsConfig */
    snprintf(follows, sizeof follows, "%s%s%s%s", m->key[MADE_CATALOG], m->key[MADE_GROUND],
             m->scenery.culture.index || m->scenery.culture.trees > 0 ? m->key[MADE_CULTURE] : "", key_text);
    const bool        known = *m->key[MADE_CATALOG] && *m->key[MADE_CULTURE] && *key_text;
    const ChoiceBasis basis = {made_basis_survey(m), part, m->catalog, evidence, m->cache, known ? follows : NULL};
    return done(
        m, MADE_WOODS, key_text,
        choice_woods(&m->woods, &m->said[MADE_WOODS], &basis, of->square, &m->landscape, &m->scenery.culture, m->pool));
}

static Status need_models(MadeWorld *m, const MadeOf *of)
{
    char    key_text[sha256_text_size];
    Config *part = &m->part[MADE_MODELS];
    Key     key = key_of(part, MADE_MODELS, of->config);
    key.good = key.good && *m->key[MADE_WOODS];
    add_text(&key, of->isa);
    if (is_there(key_text, m, MADE_MODELS, &key)) return STATUS_OK;
    Status status = frame_world_open(&m->world, part, m->catalog, &m->landscape, of->frame, of->isa);
    if (status == STATUS_OK) world_keep(&m->world, m->cache);
    if (status == STATUS_OK)
        status = frame_world_plant(&m->world, m->woods.on ? &m->woods.woods : NULL, part, of->isa, m->pool);
    if (status == STATUS_OK && m->scenery.scenery.objects > 0)
        status = world_scenery(&m->world, &m->scenery.scenery, of->isa, m->pool);
    return done(m, MADE_MODELS, key_text, status);
}

static Status need_air(MadeWorld *m, const MadeOf *of)
{
    char    key_text[sha256_text_size], model[frame_model_size];
    Config *part = &m->part[MADE_AIR];
    Key     key = key_of(part, MADE_AIR, of->config);
    /* of a set by weather the one model, so that weather alone makes no other air of one that is no set */
    const Status named = frame_world_model(model, of->config);
    if (named != STATUS_OK) return named;
    if (snprintf(part->weather.atmosphere, sizeof part->weather.atmosphere, "%s", model) >=
        (int)sizeof part->weather.atmosphere) {
        log_error("atmosphere: path too long: model=%s", model);
        return STATUS_BAD_VALUE;
    }
    add_text(&key, model);
    key.good = key.good && *m->key[MADE_MODELS];
    add_tables(&key, of->tables, of->config, true);
    if (is_there(key_text, m, MADE_AIR, &key)) return STATUS_OK;
    return done(m, MADE_AIR, key_text, frame_world_air(&m->world, part));
}

static Status need_warmth(MadeWorld *m, const MadeOf *of)
{
    char    key_text[sha256_text_size];
    Config *part = &m->part[MADE_WARM];
    Key     key = key_of(part, MADE_WARM, of->config);
    key.good = key.good && *m->key[MADE_AIR];
    add(&key, &of->unix_s, sizeof of->unix_s);
    add_tables(&key, of->tables, of->config, true);
    if (is_there(key_text, m, MADE_WARM, &key)) return STATUS_OK;
    return done(m, MADE_WARM, key_text, frame_world_warm(&m->world, part, of->unix_s, m->pool));
}

Status made_world(MadeWorld *m, Choices *choices, const MadeOf *of)
{
    GroundEvidence *evidence = NULL;
    Status          status = choice_evidence(&evidence, made_basis_survey(m), m->catalog, of->frame);
    if (status == STATUS_OK) status = need_ground(m, of, evidence);
    if (status == STATUS_OK) {
        say(choices, &m->said[MADE_GROUND]);
        choice_report_submerged(choices, made_basis_survey(m), evidence, of->plan);
    }
    if (status == STATUS_OK) status = need_culture(m, of, evidence);
    if (status == STATUS_OK) status = need_woods(m, of, evidence);
    choice_evidence_free(evidence);
    if (status != STATUS_OK) return status;
    say(choices, &m->said[MADE_CULTURE]);
    say(choices, &m->said[MADE_WOODS]);
    choice_shapes(choices, &m->survey, m->catalog);
    status = need_models(m, of);
    if (status == STATUS_OK) status = need_air(m, of);
    if (status == STATUS_OK) status = need_warmth(m, of);
    if (status == STATUS_OK) frame_world_radar(&m->world, of->config);
    malloc_trim(0); /* what set-up needed for a while goes back to the system: 26 MB with the demo, in 2 ms */
    return status;
}
