/* sensor/publish/consumers/consume_pairs.c: the consumer that writes each frame with and without its target, with and
 * without noise. */

#include "sensor/publish/consumers/consume_pairs.h"
#include "pitviper_output.h"
#include "entities/table/entity_index.h"
#include "sensor/publish/files/frame_files.h"

#include <errno.h>
#include <stdlib.h>
#include <jansson.h>

/* ---- a line of pairs.jsonl: a frame with all its members and their files ------------------------- */

enum { pair_members = 1 + pair_folders };

typedef struct PairMember {
    bool        target, noise;
    const char *radiance, *shown; /* folders below the run's: of radiance and truth, of displays and raw counts */
    const FrameDisplay *display;  /* [BAND_COUNT] values of black and white */
} PairMember;

typedef struct PairRecord {
    int                frame;
    double             time_s;
    long long          seed;
    int                removed_count;
    const DisEntityId *removed; /* removed entities */
    const char        *frame_sha256, *background_sha256;
    unsigned           bands, raw; /* 1 << Band: rendered; with raw counts */
    bool               png, truth;
    PairMember         member[pair_members];
} PairRecord;

static void set_file(json_t *object, const char *key, const char *below, const char *place, const char *band, int frame,
                     const char *ending)
{
    char path[128];
    snprintf(path, sizeof path, "%s%s%s/%s/%06d.%s", below, *below ? "/" : "", place, band, frame, ending);
    json_object_set_new(object, key, json_string(path));
}

static json_t *member_json(const PairRecord *r, const PairMember *m)
{
    json_t *member = json_pack("{s:b,s:b}", "target", m->target, "noise", m->noise), *bands = json_object();
    if (r->truth) set_file(member, "truth", m->radiance, "frames", "truth", r->frame, "exr");
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!(r->bands >> b & 1)) continue;
        const char *name = band_name((Band)b);
        json_t     *band = json_object();
        set_file(band, "radiance", m->radiance, "frames", name, r->frame, "exr");
        /* radar has no detector noise: its image is listed with its radiance */
        if (r->png)
            set_file(band, "display", b == BAND_RADAR ? m->radiance : m->shown, "frames", name, r->frame, "png");
        if (r->raw >> b & 1) set_file(band, "raw", m->shown, "raw", name, r->frame, "png");
        if (r->png && b != BAND_RADAR)
            json_object_set_new(band, "level", json_pack("[f,f]", m->display[b].level.low, m->display[b].level.high));
        json_object_set_new(bands, name, band);
    }
    json_object_set_new(member, "bands", bands);
    return member;
}

/* Writes one line and flushes it. STATUS_IO when it cannot be written; STATUS_NO_MEMORY. */
static Status write_pair_record(FILE *file, const PairRecord *r)
{
    json_t *removed = json_array(), *members = json_array();
    for (int i = 0; i < r->removed_count; i++) {
        char id[dis_id_text_size];
        dis_entity_id_text(id, r->removed[i]);
        json_array_append_new(removed, json_string(id));
    }
    for (int m = 0; m < pair_members; m++) json_array_append_new(members, member_json(r, &r->member[m]));
    json_t *line = json_pack("{s:i,s:f,s:I,s:o,s:s,s:s,s:o}", "frame", r->frame, "time_s", r->time_s, "seed",
                             (json_int_t)r->seed, "removed", removed, "frame_sha256", r->frame_sha256,
                             "background_sha256", r->background_sha256, "members", members);
    char   *text = line ? json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(15)) : NULL;
    json_decref(line);
    if (!text) return STATUS_NO_MEMORY;
    const bool ok = fprintf(file, "%s\n", text) > 0 && fflush(file) == 0;
    free(text);
    return ok ? STATUS_OK : STATUS_IO;
}

/* ---- the consumer -------------------------------------------------------------------------------- */

/* The members of a pair, with the target and without it; CLEAN: without noise. */
enum { WITH, CLEAN, BACKGROUND, BACKGROUND_CLEAN, path_size = frame_path_size };

/* The detector products of one member. The first is the run's own. */
typedef struct Member {
    char         folder[path_size];
    Camera       camera;
    FrameDisplay display[BAND_COUNT]; /* of the present frame */
} Member;

typedef struct Pairs {
    Consumer consumer;
    PairsOf  of;
    Config   noiseless;
    bool     all;
    FILE    *index;
    int      frames, taken; /* taken: entities removed, over all frames */
    Member   member[pair_members];
} Pairs;

static Status close_pairs(Consumer *consumer)
{
    Pairs *p = (Pairs *)consumer;
    Status status = STATUS_OK;
    if (p->frames > 0 && p->taken == 0)
        log_warn("pairs: nothing was taken away in any frame: %s; --pairs all takes every entity",
                 p->all ? "there was none but the host" : "there is no aim (exercise.aim), or it was never there");
    if (p->index && fclose(p->index) != 0) {
        log_error("pairs: cannot write pairs.jsonl: %s", strerror(errno));
        status = STATUS_IO;
    }
    for (int m = CLEAN; m < pair_members; m++) camera_close(&p->member[m].camera);
    free(p);
    return status;
}

/* ---- the index -------------------------------------------------------------------------------- */

static Status write_line(const Pairs *p, const Frame *frame)
{
    PairRecord r = {.frame = frame->number,
                    .time_s = frame->time_s,
                    .seed = p->of.config->seed,
                    .removed = frame->taken,
                    .removed_count = frame->taken_count,
                    .frame_sha256 = frame->seen.sha256,
                    .background_sha256 = frame->without->sha256,
                    .bands = frame->request.bands,
                    .raw = p->of.raw,
                    .png = p->of.config->publish.png,
                    .truth = frame_files_truth(p->of.config)};
    for (int m = WITH; m < pair_members; m++)
        r.member[m] = (PairMember){
            .target = m < BACKGROUND,
            .noise = m == WITH || m == BACKGROUND,
            .radiance = m < BACKGROUND ? "" : pair_folder[BACKGROUND - 1],
            .shown = m == WITH ? "" : pair_folder[m - 1],
            .display = m == WITH ? frame->display : p->member[m].display,
        };
    const Status status = write_pair_record(p->index, &r);
    if (status == STATUS_IO) log_error("pairs: cannot write pairs.jsonl: %s", strerror(errno));
    return status;
}

/* ---- a frame ---------------------------------------------------------------------------------- */

/* Ids are in order, as those of a snapshot are. */
static bool is_of(uint64_t owner, const DisEntityId *id, int count)
{
    int low = 0, high = count;
    while (low < high) {
        const int      middle = (low + high) / 2;
        const uint64_t key = entity_key(id[middle]) + 1;
        if (key == owner) return true;
        if (key < owner) low = middle + 1;
        else high = middle;
    }
    return false;
}

/* Removes the smoke, dust and flames of these entities, the marks where they stood, and their tracks. */
static Status take_traces(Snapshot *s, const DisEntityId *id, int count, Arena *arena)
{
    EffectPuff  *puff = arena_alloc(arena, (size_t)s->puff_count + 1, sizeof *puff);
    GroundStand *stand = arena_alloc(arena, (size_t)s->marks.stands + 1, sizeof *stand);
    GroundTrack *track = arena_alloc(arena, (size_t)s->marks.tracks + 1, sizeof *track);
    if (!puff || !stand || !track) return STATUS_NO_MEMORY;
    int puffs = 0, stands = 0, tracks = 0;
    for (int i = 0; i < s->puff_count; i++)
        if (!is_of(s->puff[i].owner, id, count)) puff[puffs++] = s->puff[i];
    for (int i = 0; i < s->marks.stands; i++)
        if (!is_of(s->marks.stand[i].owner, id, count)) stand[stands++] = s->marks.stand[i];
    for (int i = 0; i < s->marks.tracks; i++)
        if (!is_of(s->marks.track[i].owner, id, count)) track[tracks++] = s->marks.track[i];
    s->puff = puff, s->puff_count = puffs;
    s->marks.stand = stand, s->marks.stands = stands;
    s->marks.track = track, s->marks.tracks = tracks;
    return STATUS_OK;
}

Status pairs_take_away(Frame *frame, const PairsTaken *take)
{
    const Snapshot *with = &frame->seen.snapshot;
    Snapshot       *without = &frame->without->snapshot;
    const int       only = take->all || dis_entity_id_is_none(take->aim) ? -1 : snapshot_find(with, take->aim);
    SnapshotEntity *entity = arena_alloc(frame->arena, (size_t)with->count + 1, sizeof *entity);
    DisEntityId    *ids = arena_alloc(frame->arena, (size_t)with->count + 1, sizeof *ids);
    if (!entity || !ids) return STATUS_NO_MEMORY;
    frame->taken = ids;
    frame->taken_count = 0;
    if (with->count > 0) memcpy(entity, with->entity, (size_t)with->count * sizeof *entity);
    for (int i = 0; i < with->count; i++) {
        if (i == take->host || (!take->all && i != only)) continue;
        entity[i].model = -1;
        ids[frame->taken_count++] = entity[i].id;
    }
    *without = *with;
    without->entity = entity;
    return take_traces(without, ids, frame->taken_count, frame->arena);
}

static Status write_member(Pairs *p, int m, Frame *frame)
{
    Member          *member = &p->member[m];
    FrameView       *view = m < BACKGROUND ? &frame->seen : frame->without;
    const Config    *config = m == BACKGROUND ? p->of.config : &p->noiseless;
    const DisplaysOf of = {.config = config,
                           .picture = &view->picture,
                           .noise_of = m < BACKGROUND ? NULL : &frame->seen.picture,
                           .camera = &member->camera,
                           .frame = frame->number,
                           .time_s = frame->time_s,
                           .rate_px_s = {frame->rate_px_s[0], frame->rate_px_s[1]},
                           .counts = p->of.raw != 0};
    const FrameFiles files = {.out = member->folder,
                              .config = config,
                              .world = frame->world,
                              .picture = &view->picture,
                              .snapshot = &view->snapshot,
                              .request = &frame->request,
                              .host = frame->host,
                              .config_sha256 = p->of.config_sha256,
                              .frame = frame->number,
                              .time_s = frame->time_s,
                              .unix_s = frame->unix_s,
                              .png = p->of.config->publish.png,
                              .raw = p->of.raw != 0,
                              .display = member->display};
    const Status     made = frame_displays_make(member->display, &of, frame->request.bands, p->of.pool, frame->arena);
    if (made != STATUS_OK) return made;
    return m == BACKGROUND ? frame_files_write(view->sha256, &files, p->of.pool)
                           : frame_files_write_displays(&files, p->of.pool);
}

static Status put(Consumer *consumer, Frame *frame)
{
    Pairs *p = (Pairs *)consumer;
    Status status = frame_sha256(&frame->seen);
    for (int m = CLEAN; m < pair_members && status == STATUS_OK; m++) status = write_member(p, m, frame);
    if (status != STATUS_OK) return status;
    p->frames++;
    p->taken += frame->taken_count;
    return write_line(p, frame);
}

/* ---- opened ----------------------------------------------------------------------------------- */

static Status begin(Consumer *consumer)
{
    Pairs         *p = (Pairs *)consumer;
    const PairsOf *of = &p->of;
    const unsigned kept = of->bands | (frame_files_truth(of->config) ? frame_truth : 0);
    Status         status = STATUS_OK;
    char           path[path_size];
    for (int m = CLEAN; m < pair_members && status == STATUS_OK; m++) {
        Member *member = &p->member[m];
        if (snprintf(member->folder, path_size, "%s/%s", of->out, pair_folder[m - 1]) >= path_size) {
            log_error("pairs: the name of the folder %s is too long; choose another place with --out", of->out);
            return STATUS_BAD_VALUE;
        }
        status = m == BACKGROUND ? frame_files_prepare(member->folder, kept, of->raw)
                                 : frame_files_prepare_displays(member->folder, of->bands, of->raw);
    }
    if (status != STATUS_OK) return status;
    snprintf(path, sizeof path, "%.*s/pairs.jsonl", path_size - 32, of->out); /* the longer paths of the folders are
                                                                               * valid */
    p->index = output_file(path, 0);
    if (p->index) return STATUS_OK;
    log_error("pairs: cannot write %s: %s; choose another place with --out", path, output_reason(errno));
    return STATUS_IO;
}

Status consume_pairs(Consumer **out, const PairsOf *of)
{
    Pairs *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    p->consumer = (Consumer){
        WANT_WITHOUT | WANT_CELLS | WANT_PLANES | WANT_SHA256 | WANT_DISPLAY, put, NULL, close_pairs, "pairs", begin};
    p->of = *of;
    p->all = of->config->publish.pairs == PUBLISH_PAIRS_ALL;
    p->noiseless = *of->config;
    p->noiseless.detector.noise = 0;
    Status status = STATUS_OK;
    for (int m = CLEAN; m < pair_members && status == STATUS_OK; m++)
        status = camera_open(&p->member[m].camera, of->sensors, of->config, m == BACKGROUND);
    if (status == STATUS_OK) *out = &p->consumer;
    else close_pairs(&p->consumer);
    return status;
}
