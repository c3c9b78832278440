/* sensor/publish/consumers/consume_pairs.c: the consumer that writes each frame with and without its target, with and
 * without noise. */

#include "sensor/publish/consumers/consume_pairs.h"
#include "pitviper_output.h"
#include "entities/table/entity_index.h"
#include "sensor/publish/files/frame_files.h"

#include <errno.h>
#include <stdlib.h>
#include <jansson.h>

/* ---- the consumer -------------------------------------------------------------------------------- */

/* The members of a pair, with the target and without it; CLEAN: without noise. */
enum { WITH, CLEAN, BACKGROUND, BACKGROUND_CLEAN, pair_members = 1 + pair_folders, path_size = frame_path_size };

/* The detector products of one member. The first is the run's own. */
typedef struct Member {
    bool         target, noise;
    const char  *radiance, *shown; /* folders below the run's: of radiance and truth, of displays and raw counts */
    char         folder[path_size];
    Camera       camera;
    FrameDisplay display[BAND_COUNT]; /* of the present frame */
} Member;

typedef struct Pairs {
    Consumer     consumer;
    PairsOf      of;
    Config       noiseless;
    bool         all;
    FILE        *index;
    int          frames, taken; /* taken: entities removed, over all frames */
    Member       member[pair_members];
    const Frame *frame; /* the present one */
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

/* ---- a line of pairs.jsonl: a frame with all its members and their files ------------------------- */

/* One band of a member. An empty name: there is no such file. */
typedef struct PairBand {
    char   radiance[96], display[96], raw[96];
    double level[2]; /* NaN: none */
} PairBand;

static void put_name(char out[96], const Pairs *p, const char *below, const char *place, const char *band,
                     const char *ending)
{
    snprintf(out, 96, "%s%s%s/%s/%06d.%s", below, *below ? "/" : "", place, band, p->frame->number, ending);
}

static const void *next_band(FieldAt *at, int i)
{
    const Pairs  *p = at->record;
    const Member *m = at->of;
    const bool    png = p->of.config->publish.png, radar = i == BAND_RADAR;
    PairBand     *b = (PairBand *)at->room;
    if (i >= BAND_COUNT || !(p->frame->request.bands >> i & 1)) return i < BAND_COUNT ? field_keyed(at, "", b) : NULL;
    const char          *name = band_name((Band)i);
    const DetectorLevel *level = &(m == p->member ? p->frame->display : m->display)[i].level;
    *b = (PairBand){.level = {png && !radar ? level->low : NAN, level->high}};
    put_name(b->radiance, p, m->radiance, "frames", name, "exr");
    /* radar has no detector noise: its image is listed with its radiance */
    if (png) put_name(b->display, p, radar ? m->radiance : m->shown, "frames", name, "png");
    if (p->of.raw >> i & 1) put_name(b->raw, p, m->shown, "raw", name, "png");
    return field_keyed(at, name, b);
}

static json_t *truth_file(FieldAt *at)
{
    char name[96];
    put_name(name, at->record, ((const Member *)at->of)->radiance, "frames", "truth", "exr");
    return frame_files_truth(((const Pairs *)at->record)->of.config) ? json_string(name) : NULL;
}

static const void *next_removed(FieldAt *at, int i)
{
    const Frame *frame = at->of;
    return i < frame->taken_count ? &frame->taken[i] : NULL;
}

static const void *next_member(FieldAt *at, int i)
{
    return i < pair_members ? &((const Pairs *)at->of)->member[i] : NULL;
}

static const void *frame_of(const void *of) { return ((const Pairs *)of)->frame; }
static const void *without_of(const void *of) { return ((const Pairs *)of)->frame->without; }
static const void *config_of(const void *of) { return ((const Pairs *)of)->of.config; }
static const void *levelled(const void *of) { return isfinite(((const PairBand *)of)->level[0]) ? of : NULL; }

#define OF_BAND(member) FIELD_MEMBER(PairBand, member)

static const Field band_rows[] = {
    {"radiance", "", "file", "", "its EXR, always without detector noise", OF_BAND(radiance)},
    {"display", "", "file", "with --no-png", "its PNG; radar: without noise too", OF_BAND(display),
     .unless_empty = true},
    {"raw", "", "file", "without a sensor, and in radar", "its counts", OF_BAND(raw), .unless_empty = true},
    {"level", "counts of the sensor; else W/(m2 sr)", "black, white", "in radar and with --no-png",
     "values shown as black and white; RGB: after white balance", FIELD_IN(levelled, PairBand, level)},
};

static const Field bands_rows[] = {
    {"BAND", "", "", "when the band was not rendered", "of one band", .item = next_band, FIELD_OBJECT(band_rows)},
};

static const Field member_rows[] = {
    {"target", "", "", "", "with the target", FIELD_MEMBER(Member, target)},
    {"noise", "", "", "", "with the detector's noise", FIELD_MEMBER(Member, noise)},
    {"truth", "", "file, from the folder of pairs.jsonl", "", "its truth EXR", FIELD_GET("string", truth_file)},
    {"bands", "", "", "", "its images", FIELD_OBJECT(bands_rows)},
};

static const Field pair_rows[] = {
    {"frame", "", "from 0", "", "number of the frame", FIELD_IN(frame_of, Frame, number)},
    {"time_s", "s", "exercise time", "", "instant of the frame", FIELD_IN(frame_of, Frame, time_s)},
    {"seed", "", "", "", "seed of the noise, the same in all members", FIELD_IN(config_of, Config, seed)},
    {"removed", "", "site:application:entity", "", "entities removed from the background", .in = frame_of,
     .item = next_removed, .type = "list of strings", .kind = FIELD_OF_ID},
    {"frame_sha256", "", "", "", "SHA-256 of the planes with the target, as in truth.jsonl",
     FIELD_IN(frame_of, Frame, seen.sha256)},
    {"background_sha256", "", "", "", "SHA-256 of the planes without it", FIELD_IN(without_of, FrameView, sha256)},
    {"members", "", "with noise, with; with, without; without, with; without, without", "",
     "the four images of each band", .item = next_member, FIELD_OBJECTS(member_rows)},
};
const FieldTable pair_fields = {pair_rows, sizeof pair_rows / sizeof *pair_rows};

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
    p->frame = frame;
    char *text = field_line(&pair_fields, p, 15);
    if (!text) return STATUS_NO_MEMORY;
    const bool ok = fprintf(p->index, "%s\n", text) > 0 && fflush(p->index) == 0;
    if (!ok) log_error("pairs: cannot write pairs.jsonl: %s", strerror(errno));
    free(text);
    return ok ? STATUS_OK : STATUS_IO;
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
    for (int m = WITH; m < pair_members; m++) {
        p->member[m].target = m < BACKGROUND;
        p->member[m].noise = m == WITH || m == BACKGROUND;
        p->member[m].radiance = m < BACKGROUND ? "" : pair_folder[BACKGROUND - 1];
        p->member[m].shown = m == WITH ? "" : pair_folder[m - 1];
    }
    for (int m = CLEAN; m < pair_members && status == STATUS_OK; m++)
        status = camera_open(&p->member[m].camera, of->sensors, of->config, m == BACKGROUND);
    if (status == STATUS_OK) *out = &p->consumer;
    else close_pairs(&p->consumer);
    return status;
}
