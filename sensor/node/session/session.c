/* sensor/node/session/session.c: the seeker of one host: frames rendered, passed to consumers, and listed. */
#include "sensor/node/session/session_private.h"

#include <stdlib.h>
#include <unistd.h>

/* ---- its state, at the beginning -------------------------------------------------------------------- */

/* Reads the ground marks of what stood and drove before a restart. */
static Status read_marks(Session *s)
{
    const char *path = s->shared->config->heat.marks;
    if (!*path || access(path, F_OK) != 0) return STATUS_OK;
    return entity_table_marks_load(s->table, s->shared->unix_s, path);
}

static Status open_session(Session *s)
{
    const SessionShared *shared = s->shared;
    EntityTableConfig    table = entity_table_default_config();

    table.pool = shared->pool;
    table.capacity = shared->config->entities.capacity;
    table.shown = shared->config->entities.shown;
    table.new_per_s = shared->config->entities.new_per_s;
    table.stood_s = 60 * shared->config->heat.stood_min;
    table.seed = (uint64_t)shared->config->seed;
    table.timeout_s = shared->config->entities.timeout_s;
    table.timeout_land_v7_s = shared->config->entities.timeout_land_v7_s;
    table.extrapolation_limit_s = shared->config->entities.extrapolation_limit_s;
    if (shared->contact != GROUND_CONTACT_NONE)
        table.ground = (ContactGround){
            .frame = &shared->world->frame,
            .elevation = &shared->world->landscape->elevation,
            .landscape = shared->contact == GROUND_CONTACT_INCONSISTENT ? shared->world->landscape : NULL};
    s->crowd.given_up_s = s->crowd.left_out_s = -INFINITY;
    s->tick = (int64_t)ceil(s->plan.start_s * seeker_ticks_per_s);
    memcpy(s->p_aim_ecef, s->plan.p_aim_ecef, sizeof s->p_aim_ecef);
    const bool observes = dis_entity_id_is_none(s->plan.host) && !s->plan.any_munition;
    Status     status = shared->cigi     ? session_host_cigi(&s->host, s)
                        : shared->flight ? session_host_flight(&s->host, s)
                        : observes       ? session_host_observer(&s->host, s)
                                         : session_host_entity(&s->host, s);
    if (status == STATUS_OK && *shared->config->exercise.head) status = session_host_head(&s->host, s);
    if (status == STATUS_OK) status = entity_table_create(&s->table, &table, shared->catalog);
    if (status == STATUS_OK) status = read_marks(s);
    if (status == STATUS_OK) status = session_heat_open(s);
    if (status == STATUS_OK) status = session_ready_open(s);
    if (status == STATUS_OK) status = frame_verdicts_read(&s->verdicts, shared->notes);
    if (status == STATUS_OK)
        status = instruments_open(
            &s->instruments, shared->instruments,
            &(InstrumentsOf){shared->config, shared->sensors, shared->isa, shared->live, shared->world->cache});
    if (status == STATUS_OK) session_keep(s);
    return status == STATUS_OK ? session_consumers(s, session_list_frame) : status;
}

Status session_open(Session **out, const SessionShared *shared, const HostPlan *plan, Player *player,
                    const char *folder)
{
    char     earlier[frame_path_size];
    Session *s = calloc(1, sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    s->shared = shared;
    s->fed_s = -INFINITY;
    s->plan = *plan;
    s->player = player;
    Status status = STATUS_OK;
    if (snprintf(s->out, sizeof s->out, "%s", folder) >= (int)sizeof s->out) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = open_session(s);
    if (status == STATUS_OK && !frame_files_earlier(earlier, s->out)) status = session_begin_files(s);
    s->opened = status == STATUS_OK;
    if (s->opened) *out = s;
    else session_close(s, NULL);
    return status;
}

/* ---- frame after frame ------------------------------------------------------------------------------ */

/* Enters the frame into the latency ledger, before its consumers get it. */
static void begin_latency(Session *s, Frame *f)
{
    const SessionShared *shared = s->shared;
    const double         fed_s = player_fed_s(s->player);
    if (!s->latency) return;
    f->times.instant_s = shared->clock->wall_s(shared->clock, f->time_s);
    f->times.arrived_s = isfinite(fed_s) ? shared->clock->wall_s(shared->clock, fed_s) : 0;
    f->times.fresh = fed_s > s->fed_s;
    s->fed_s = fed_s;
    f->latency = s->latency;
    f->latency_key = latency_begin(s->latency, &f->times);
}

Status session_frame(bool *shown, Session *s, const FrameTime *at)
{
    const FlightLoop *loop = s->shared->flight;
    int               left_out = 0;
    if (loop && loop->hooks && loop->hooks->boundary) loop->hooks->boundary(loop->hooks->user, at->t_s);
    session_advance(s, at->t_s);
    if (s->host->begin) s->host->begin(s->host, at->t_s);
    session_prepare(s, at->t_s);
    Status status = s->advance_status;
    *shown = false;
    if (status == STATUS_OK && s->host->is_there(s->host)) { /* otherwise nothing is extrapolated for it */
        Frame *frame = frame_pool_take(s->frames);
        status = session_make_frame(shown, &left_out, frame, s, at);
        if (status == STATUS_OK && *shown && loop) session_flight_seen(s, frame);
        if (status == STATUS_OK && *shown) {
            begin_latency(s, frame);
            status = consumers_put(&s->consumers, frame);
        }
        frame_release(frame);
    }
    session_report_crowd(s, left_out);
    if (status == STATUS_OK && *shown) s->result.frames++;
    if (status == STATUS_NO_MEMORY)
        log_error("session: out of memory at frame %d; choose a smaller --size or fewer --samples", at->number);
    return status;
}

/* ---- the end ---------------------------------------------------------------------------------------- */

const SessionResult *session_result(const Session *s) { return &s->result; }
int                  session_entities(const Session *s) { return entity_table_count(s->table); }
uint64_t             session_over_rate(const Session *s) { return entity_table_counters(s->table)->over_rate; }
uint64_t             session_lost(char out[latency_lost_size], const Session *s)
{
    *out = 0;
    return s->latency ? latency_lost(out, s->latency) : 0;
}
bool        session_flight_over(const Session *s) { return s->shared->flight && s->shared->flight->over; }
const char *session_host(const Session *s) { return s->host_text; }

/* Frames that lack files: of the kind that lacks most, since a frame that lacks several counts once. */
static void count_lost_files(Session *s)
{
    SessionResult *r = &s->result;
    for (size_t k = 0; k < sizeof s->written / sizeof *s->written; k++) {
        if (s->written[k].failed > r->files_failed) r->files_failed = s->written[k].failed;
        if (s->written[k].left_out > r->files_left_out) r->files_left_out = s->written[k].left_out;
    }
    r->files_failed += s->lines_failed;
}

Status session_close(Session *s, SessionResult *result)
{
    session_heat_report(s);
    Status status = consumers_close(&s->consumers); /* the last frames are published before */
    if (!publish_hangs()) {
        answers_close(s->answers, &s->result.answers);
        geoid_close(&s->geoid);
    }
    head_link_close(s->head, &s->result.head);
    if (status == STATUS_OK) status = s->listed;
    /* of a session that could not be opened nothing is written over what it could not read */
    if (s->opened && *s->shared->config->heat.marks && status == STATUS_OK)
        status = entity_table_marks_save(s->table, s->shared->unix_s, s->shared->config->heat.marks);
    if (s->opened && status == STATUS_OK) status = session_heat_keep(s);
    s->result.frames = s->published;
    count_lost_files(s);
    player_forgotten(&s->result.shots_forgotten, &s->result.munitions_forgotten, s->player);
    if (s->table) s->result.entities = *entity_table_counters(s->table);
    if (s->table) s->result.effects = *entity_table_effect_counters(s->table);
    if (s->latency) latency_summary(&s->result.latency, s->latency);
    if (!publish_hangs()) latency_destroy(s->latency);
    if (result) *result = s->result;
    else session_result_free(&s->result);
    if (publish_hangs()) return STATUS_IO; /* its threads have what is left of it */
    instruments_close(&s->instruments);
    frame_verdicts_free(s->verdicts);
    session_heat_close(s);
    session_ready_close(s);
    entity_table_destroy(s->table);
    frame_pool_destroy(s->frames);
    pool_destroy(s->publish_pool);
    if (s->host) s->host->destroy(s->host);
    free(s);
    return status;
}
