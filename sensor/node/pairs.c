#include "sensor/node/pairs.h"

#include "sensor/node/session_private.h" /* turn_normals */
#include "sensor/publish/pair_record.h"

#include <errno.h>
#include <stdlib.h>

enum { WITH, CLEAN, BACKGROUND, BACKGROUND_CLEAN, path_size = 4200 };

/* What lies behind a detector, of one member. The first is the session's own. */
typedef struct Member {
    char       folder[path_size];
    Chain     *chain[BAND_COUNT];
    FrameLevel level[BAND_COUNT];
} Member;

struct Pairs {
    const SessionShared *shared;
    Config   noiseless;
    bool     all;
    unsigned raw;
    FILE    *index;
    int      frames, taken; /* taken: entities, over all frames */
    Member   member[pair_members];
};

Status pairs_open(Pairs **out, const SessionShared *shared, const char *folder, unsigned raw)
{
    char     path[path_size + 16];
    Pairs   *p = calloc(1, sizeof *p);
    Sensors *quiet = malloc(sizeof *quiet);
    Status   status = p && quiet ? STATUS_OK : STATUS_NO_MEMORY;
    if (status != STATUS_OK) goto failed;
    p->shared    = shared;
    p->raw       = raw;
    p->all       = strcmp(shared->config->publish.pairs, "all") == 0;
    p->noiseless = *shared->config;
    p->noiseless.detector.noise = 0;
    *quiet = *shared->sensors;
    for (int b = 0; b < BAND_COUNT; b++) quiet->preset[b].noise_scale = 0;
    const unsigned kept = shared->bands | (frame_files_truth(shared->config) ? frame_truth : 0);
    for (int m = CLEAN; m < pair_members && status == STATUS_OK; m++) {
        Member *member = &p->member[m];
        snprintf(member->folder, sizeof member->folder, "%s/%s", folder, pair_folder[m - 1]);
        status = sensors_chains(member->chain, m == BACKGROUND ? shared->sensors : quiet, shared->config);
        if (status == STATUS_OK)
            status = m == BACKGROUND ? frame_files_prepare(member->folder, kept, raw)
                                     : frame_files_prepare_displays(member->folder, shared->bands, raw);
    }
    if (status != STATUS_OK) goto failed;
    snprintf(path, sizeof path, "%s/pairs.jsonl", folder);
    p->index = fopen(path, "w");
    if (p->index) {
        free(quiet);
        *out = p;
        return STATUS_OK;
    }
    log_error("pairs: cannot write %s: %s; choose another place with --out", path, strerror(errno));
    status = STATUS_IO;

failed:
    free(quiet);
    pairs_close(p);
    return status;
}

Status pairs_close(Pairs *p)
{
    Status status = STATUS_OK;
    if (!p) return status;
    if (p->frames > 0 && p->taken == 0)
        log_warn("pairs: nothing was taken away in any frame: %s; --pairs all takes every entity",
                 p->all ? "there was none but the host" : "nobody is aimed at (exercise.aim), or it was never there");
    if (p->index && fclose(p->index) != 0) {
        log_error("pairs: cannot write pairs.jsonl: %s", strerror(errno));
        status = STATUS_IO;
    }
    for (int m = CLEAN; m < pair_members; m++)
        for (int b = 0; b < BAND_COUNT; b++) chain_destroy(p->member[m].chain[b]);
    free(p);
    return status;
}

/* ---- the index -------------------------------------------------------------------------------- */

static Status write_line(const Pairs *p, const FrameFiles *files, const char *with_sha256, const char *without_sha256,
                         const DisEntityId *removed, int removed_count)
{
    PairRecord r = {.frame = files->frame, .time_s = files->time_s, .seed = p->shared->config->seed, .removed = removed,
                    .removed_count = removed_count, .frame_sha256 = with_sha256, .background_sha256 = without_sha256,
                    .bands = files->request->bands, .raw = p->raw, .png = files->png,
                    .truth = frame_files_truth(p->shared->config)};
    for (int m = WITH; m < pair_members; m++)
        r.member[m] = (PairMember){
            .target   = m < BACKGROUND,
            .noise    = m == WITH || m == BACKGROUND,
            .radiance = m < BACKGROUND ? "" : pair_folder[BACKGROUND - 1],
            .shown    = m == WITH ? "" : pair_folder[m - 1],
            .level    = m == WITH ? files->level : p->member[m].level,
        };
    const Status status = record_write_pair(p->index, &r);
    if (status == STATUS_IO) log_error("pairs: cannot write pairs.jsonl: %s", strerror(errno));
    return status;
}

/* ---- a frame ---------------------------------------------------------------------------------- */

/* The same snapshot, indices and all, less what is taken away, whose ids are listed. */
static Status take_away(Snapshot *without, DisEntityId **taken, int *taken_count, const Pairs *p, const Snapshot *with,
                        DisEntityId aim, int host, Arena *arena)
{
    const int       only = p->all || dis_entity_id_is_none(aim) ? -1 : snapshot_find(with, aim);
    SnapshotEntity *entity = arena_alloc(arena, (size_t)with->count + 1, sizeof *entity);
    *taken       = arena_alloc(arena, (size_t)with->count + 1, sizeof **taken);
    *taken_count = 0;
    if (!entity || !*taken) return STATUS_NO_MEMORY;
    if (with->count > 0) memcpy(entity, with->entity, (size_t)with->count * sizeof *entity);
    for (int i = 0; i < with->count; i++) {
        if (i == host || (!p->all && i != only)) continue;
        entity[i].model = -1;
        (*taken)[(*taken_count)++] = entity[i].id;
    }
    *without        = *with;
    without->entity = entity;
    return STATUS_OK;
}

static Status write_member(char *sha256, Pairs *p, int m, FrameFiles files)
{
    Member    *member = &p->member[m];
    TruthNoise ignored;
    files.out    = member->folder;
    files.chain  = member->chain;
    files.level  = member->level;
    files.config = m == BACKGROUND ? p->shared->config : &p->noiseless;
    frame_expose(&ignored, member->chain, files.picture, files.config);
    return m == BACKGROUND ? frame_files_write(sha256, &files, p->shared->pool)
                           : frame_files_write_displays(&files, p->shared->pool);
}

Status pairs_frame(Pairs *p, const FrameFiles *with, const char *sha256, const Air *air, const double r_host_from_enu[9],
                   DisEntityId aim, int host, Arena *arena)
{
    Snapshot   snapshot;
    Picture    picture;
    char       without_sha256[sha256_text_size];
    FrameFiles without = *with;
    DisEntityId *taken;
    int          taken_count;

    without.snapshot = &snapshot;
    without.picture  = &picture;
    without.noise_of = with->picture;
    Status status    = take_away(&snapshot, &taken, &taken_count, p, with->snapshot, aim, host, arena);
    if (status == STATUS_OK)
        status = render(&picture, p->shared->world, &snapshot, with->request, air, p->shared->pool, arena);
    if (status == STATUS_OK) turn_normals(&picture, r_host_from_enu);
    if (status == STATUS_OK) status = write_member(NULL, p, CLEAN, *with);
    if (status == STATUS_OK) status = write_member(without_sha256, p, BACKGROUND, without);
    if (status == STATUS_OK) status = write_member(NULL, p, BACKGROUND_CLEAN, without);
    if (status != STATUS_OK) return status;
    p->frames++;
    p->taken += taken_count;
    return write_line(p, with, sha256, without_sha256, taken, taken_count);
}
