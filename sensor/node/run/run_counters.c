/* sensor/node/run/run_counters.c: the counters of run.json. */
#include "sensor/frame/json_object.h"
#include "sensor/instruments/radar.h"
#include "sensor/node/cigi/cigi_node.h"
#include "sensor/node/run/run_record_private.h"

/* ---- where the values are, and those that are no plain member ------------------------------------ */

static json_t *count_of(uint64_t count) { return json_integer((json_int_t)count); }

static const void *heard_of(const void *of) { return ((const RunRecord *)of)->end->heard; }
static const void *render_of(const void *of) { return &((const RunRecord *)of)->end->result->counters; }
static const void *live_of(const void *of) { return ((const RunRecord *)of)->run->live; }

static const void *cigi_of(const void *of) { return ((const RunRecord *)of)->run->cigi; }

static const void *head_of(const void *of)
{
    const RunRecord *r = of;
    return r->run->live && *run_config_of(r)->exercise.head ? &r->end->result->head : NULL;
}

static const void *next_head_drop(FieldAt *at, int i)
{
    const HeadCounters *c = at->of;
    return i < HEAD_DROPS ? field_keyed(at, i == HEAD_GOOD ? "" : head_drop_name[i], &c->datagrams[i]) : NULL;
}

/* of: CigiNode. */
static const void *next_cigi_drop(FieldAt *at, int i)
{
    const CigiNode *node = at->of;
    return i < CIGI_DROP_COUNT ? field_keyed(at, cigi_drop_name((CigiDrop)i), &node->session.counters.dropped[i])
                               : NULL;
}

static const void *next_cigi_skipped(FieldAt *at, int i)
{
    const CigiNode *node = at->of;
    char            id[8];
    snprintf(id, sizeof id, "%d", i);
    return i < 256 ? field_keyed(at, id, &node->session.counters.skipped[i]) : NULL;
}

static const void *answers_of(const void *of)
{
    const RunRecord *r = of;
    return run_config_of(r)->publish.detections_port ? &r->end->result->answers : NULL;
}

static const void *streams_of(const void *of)
{
    const RunRecord *r = of;
    return *run_config_of(r)->publish.stream ? &r->end->result->sent.stream : NULL;
}

static const void *projector_of(const void *of)
{
    const RunRecord *r = of;
    return *run_config_of(r)->projector.band ? &r->end->result->sent.projector : NULL;
}

/* Figures of a projector's flips; NULL: there are none. */
static const void *some(const LatencyFigures *figures) { return figures->count > 0 ? figures : NULL; }
static const void *interval_of(const void *of) { return some(&((const ProjectorCounters *)of)->interval); }
static const void *off_of(const void *of) { return some(&((const ProjectorCounters *)of)->off); }
static const void *after_of(const void *of) { return some(&((const ProjectorCounters *)of)->after); }

/* NULL: it was never ready. */
static const void *made_ready(const void *of)
{
    const LiveCounters *live = of;
    return live->ready_s > 0 ? live : NULL;
}

/* NULL: it ended before its rate was known. */
static const void *rated(const void *of)
{
    const LiveCounters *live = of;
    return live->rate_hz > 0 ? live : NULL;
}

/* of: datagrams of one form by reason. */
static const void *next_fault(FieldAt *at, int i)
{
    const uint64_t *datagrams = at->of;
    if (i == ANSWER_REASONS) return NULL;
    return field_keyed(at, i == ANSWER_GOOD || i == ANSWER_LATE ? "" : answer_reason_name[i], &datagrams[i]);
}

static const void *next_form(FieldAt *at, int i)
{
    const AnswerCounters *c = at->of;
    return i < ANSWER_FORMS ? field_keyed(at, answer_form_name[i], c->datagrams[i]) : NULL;
}

static const void *next_skip(FieldAt *at, int i)
{
    const RenderCounters *c = at->of;
    return i < SKIP_COUNT ? field_keyed(at, visibility_skip_name((Skip)i), &c->visibility.skipped[i]) : NULL;
}

static json_t *pdus(FieldAt *at)
{
    const DisCounters *c = heard_of(at->of);
    json_t            *object = json_object();
    char               type[16];
    for (int i = 0; i < 256; i++) {
        snprintf(type, sizeof type, "%d", i);
        if (c->pdus[i]) json_object_set_new(object, type, count_of(c->pdus[i]));
    }
    return object;
}

/* A length of 0 is absent when there was none, so that records from before it was counted stay comparable. */
static json_t *dropped(FieldAt *at)
{
    const DisCounters *c = heard_of(at->of);
    json_t            *object = json_object();
    for (int i = 0; i < DIS_DROP_COUNT; i++)
        if (i != DIS_DROP_LENGTH_ZERO || c->dropped[i])
            json_object_set_new(object, dis_drop_name((DisDrop)i), count_of(c->dropped[i]));
    return object;
}

static json_t *packets_lost(FieldAt *at)
{
    const DisLogCounters *link = ((const Run *)run_of_record(at->of))->link;
    return count_of(link ? dis_log_dropped(link) : 0);
}

/* NULL: all frames have their radar. */
static json_t *without_radar(FieldAt *at)
{
    const SessionResult *result = run_result_of(at->record);
    const int            frames = instruments_left_out(result->instrument, &radar_kind);
    return frames ? json_integer(frames) : NULL;
}

/* NULL: none is of coarse signatures. */
static json_t *coarse_radar(FieldAt *at)
{
    const SessionResult *result = run_result_of(at->record);
    const int            frames = instruments_coarse(result->instrument, &radar_kind);
    return frames ? json_integer(frames) : NULL;
}

static json_t *kept_share(FieldAt *at)
{
    const SessionResult *result = run_result_of(at->record);
    return rated(at->of) ? json_real(record_live_kept_share(at->of, (uint64_t)result->frames)) : NULL;
}

static json_t *answers_received(FieldAt *at)
{
    const AnswerCounters *c = at->of;
    uint64_t              received = c->lost_kernel;
    for (int i = 0; i < ANSWER_REASONS; i++) received += answer_datagrams(c, (AnswerReason)i);
    return count_of(received);
}

static json_t *answers_taken(FieldAt *at)
{
    const AnswerCounters *c = at->of;
    return count_of(answer_datagrams(c, ANSWER_GOOD) + answer_datagrams(c, ANSWER_LATE));
}

static json_t *answers_late(FieldAt *at) { return count_of(answer_datagrams(at->of, ANSWER_LATE)); }

/* of: datagrams of one form by reason. */
static json_t *taken_in_form(FieldAt *at)
{
    const uint64_t *datagrams = at->of;
    return count_of(datagrams[ANSWER_GOOD] + datagrams[ANSWER_LATE]);
}

/* ---- the fields ---------------------------------------------------------------------------------- */

#define IN_RUN(member)       FIELD_IN(run_of_record, Run, member)
#define IN_RESULT(member)    FIELD_IN(run_result_of, SessionResult, member)
#define IN_RENDER(member)    FIELD_IN(render_of, RenderCounters, member)
#define IN_HEARD(member)     FIELD_IN(heard_of, DisCounters, member)
#define OF_RESULT(member)    FIELD_MEMBER(SessionResult, member)
#define OF_LIVE(member)      FIELD_MEMBER(LiveCounters, member)
#define OF_CIGI(member)      FIELD_MEMBER(CigiNode, member)
#define OF_ANSWERS(member)   FIELD_MEMBER(AnswerCounters, member)
#define OF_STREAM(member)    FIELD_MEMBER(StreamCounters, member)
#define OF_PROJECTOR(member) FIELD_MEMBER(ProjectorCounters, member)
#define OF_FLIPS(member)     FIELD_MEMBER(LatencyFigures, member)
#define OF_RENDER(member)    FIELD_MEMBER(RenderCounters, member)

static const Field pdu_rows[] = {
    {"TYPE", "", "", "when there were none", "well-formed PDUs of this type", FIELD_ELSEWHERE("integer")},
};

static const Field drop_rows[] = {
    {"REASON", "", "", "", "PDUs", FIELD_ELSEWHERE("integer")},
};

static const Field live_rows[] = {
    {"datagrams", "", "", "", "received from the network", OF_LIVE(datagrams)},
    {"lost_kernel", "", "", "", "lost in the kernel", OF_LIVE(lost_kernel)},
    {"lost_queue", "", "", "", "lost because the receive queue was full", OF_LIVE(lost_queue)},
    {"sent", "", "", "", "Data PDUs sent", OF_LIVE(sent)},
    {"send_failed", "", "", "", "Data PDUs that could not be sent", OF_LIVE(send_failed)},
    {"record_failed", "", "", "", "datagrams that --record could not write", OF_LIVE(record_failed)},
    {"frames_late", "", "", "", "frames dropped because they were too late; none while the host was not there",
     OF_LIVE(frames_late)},
    {"rate_hz", "Hz", "", "without a frame", "frames asked for", FIELD_IN(rated, LiveCounters, rate_hz)},
    {"kept_share", "", "0 .. 1", "without a frame",
     "of the frames that were due, those that were made with all bands asked for", FIELD_GET("number", kept_share)},
    {"frames_lacking", "", "", "", "frames that lack a band asked for: radar.preset, signatures still to be made",
     OF_LIVE(frames_lacking)},
    {"frames_full", "", "", "", "frames sampled as it was set", OF_LIVE(frames_at[SAMPLING_ALL])},
    {"frames_targets", "", "", "", "frames that gave up sampling to be in time, quality.deadline: `targets`",
     OF_LIVE(frames_at[SAMPLING_TARGETS])},
    {"frames_checkerboard", "", "", "", "the same: `checkerboard`", OF_LIVE(frames_at[SAMPLING_CHECKERBOARD])},
    {"frames_quarter", "", "", "", "the same: `quarter`", OF_LIVE(frames_at[SAMPLING_QUARTER])},
    {"ready_s", "s", "after the first entity was heard", "when it never was",
     "when everything was made that the entities heard so far need in frames: models, heat, coarse signatures",
     FIELD_IN(made_ready, LiveCounters, ready_s)},
    {"files_failed", "", "", "", "frames whose files could not be written", OF_LIVE(files_failed)},
    {"files_left_out", "", "", "", "frames without files because the disk was too slow", OF_LIVE(files_left_out)},
};

static const Field cigi_drop_rows[] = {
    {"FLAW", "", "", "when there were none", "datagrams or packets", .item = next_cigi_drop, .kind = FIELD_OF_COUNT,
     .unless_0 = true},
};

static const Field cigi_skipped_rows[] = {
    {"PACKET", "", "", "when there were none", "packets of this id", .item = next_cigi_skipped, .kind = FIELD_OF_COUNT,
     .unless_0 = true},
};

static const Field cigi_rows[] = {
    {"asked", "", "", "", "frames asked for, with a time", OF_CIGI(session.events.frames)},
    {"without_picture", "", "", "", "frames of the host that ask for none: mode, time", OF_CIGI(session.events.idle)},
    {"repeats", "", "", "", "Start of Frame sent again", OF_CIGI(session.events.repeats)},
    {"repeated", "", "", "", "the host's datagrams with a frame that was known", OF_CIGI(session.events.repeated)},
    {"old", "", "", "", "with an older frame: not used", OF_CIGI(session.events.old)},
    {"ahead", "", "", "", "with a frame that answers no new Start of Frame", OF_CIGI(session.events.extra)},
    {"lost", "", "", "", "numbers of its frames that did not come", OF_CIGI(session.events.lost)},
    {"restarts", "", "", "", "how often it began anew", OF_CIGI(session.events.restarts)},
    {"silences", "", "", "", "how often it was silent for 5 s", OF_CIGI(session.events.silences)},
    {"time_back", "", "", "", "frames whose time was before the last", OF_CIGI(session.events.time_back)},
    {"time_ahead", "", "", "", "frames whose time was more than ten minutes after the last",
     OF_CIGI(session.events.time_ahead)},
    {"unstamped", "", "", "", "frames without a valid time stamp", OF_CIGI(session.events.unstamped)},
    {"requests_lost", "", "", "", "requests that did not fit into a frame", OF_CIGI(requests_lost)},
    {"answers_lost", "", "", "", "answers that did not fit into a datagram", OF_CIGI(session.events.unanswered)},
    {"out_of_range", "", "", "", "entities and views refused: a value, too many", OF_CIGI(scene.refused)},
    {"unmapped", "", "", "", "entities with a type that exercise.cigi_types lacks: not drawn", OF_CIGI(drawn.unmapped)},
    {"dropped", "", "", "", "refused, by reason", FIELD_OBJECT(cigi_drop_rows)},
    {"skipped", "", "", "", "packets that are not read, by id", FIELD_OBJECT(cigi_skipped_rows)},
};

static const Field head_drop_rows[] = {
    {"MISTAKE", "", "", "when there were none", "datagrams", .item = next_head_drop, .kind = FIELD_OF_COUNT,
     .unless_0 = true},
};

static const Field head_rows[] = {
    {"taken", "", "", "", "poses that were well-formed and newer than those before",
     FIELD_MEMBER(HeadCounters, datagrams[HEAD_GOOD])},
    {"refused", "", "", "", "by reason", FIELD_OBJECT(head_drop_rows)},
};

static const Field fault_rows[] = {
    {"FAULT", "", "", "when there were none", "datagrams", .item = next_fault, .kind = FIELD_OF_COUNT,
     .unless_0 = true},
};

static const Field form_rows[] = {
    {"taken", "", "", "", "answers in answers.jsonl", FIELD_GET("integer", taken_in_form)},
    {"refused", "", "", "", "by reason", FIELD_OBJECT(fault_rows)},
};

static const Field forms_rows[] = {
    {"FORM", "", "", "", "answers that came so", .item = next_form, FIELD_OBJECT(form_rows)},
};

static const Field answer_rows[] = {
    {"datagrams", "", "", "", "all that arrived: taken, refused or lost", FIELD_GET("integer", answers_received)},
    {"taken", "", "", "", "answers in answers.jsonl", FIELD_GET("integer", answers_taken)},
    {"late", "", "", "", "of these, received after that to a newer frame: not in metadata",
     FIELD_GET("integer", answers_late)},
    {"forms", "", "", "", "those that were read, by form", FIELD_OBJECT(forms_rows)},
    {"lost_kernel", "", "", "", "lost in the kernel, since they came too fast", OF_ANSWERS(lost_kernel)},
    {"lines", "", "", "", "of answers.jsonl", OF_ANSWERS(lines)},
    {"lines_failed", "", "", "when 0", "that could not be written", OF_ANSWERS(lines_failed), .unless_0 = true},
};

static const Field stream_rows[] = {
    {"sent", "", "", "", "taken by the network", OF_STREAM(sent)},
    {"refused", "", "", "", "not sent, since no program listened to those before", OF_STREAM(refused)},
    {"no_route", "", "", "", "not sent, since there was no way to the address", OF_STREAM(no_route)},
    {"lost", "", "", "", "not sent, since the network was too slow", OF_STREAM(lost)},
};

static const Field flip_rows[] = {
    {"median", "ms", "", "", "median, at most 2.4 % above the exact one", OF_FLIPS(median_ms), .as = field_ms},
    {"p95", "ms", "", "", "95th percentile, likewise", OF_FLIPS(p95_ms), .as = field_ms},
    {"p99", "ms", "", "", "99th percentile, likewise", OF_FLIPS(p99_ms), .as = field_ms},
    {"max", "ms", "", "", "maximum", OF_FLIPS(max_ms), .as = field_ms},
    {"count", "", "", "", "number of them", OF_FLIPS(count)},
};

static const Field projector_rows[] = {
    {"on", "", "", "", "display, size, window system and renderer, place of the image", OF_PROJECTOR(what)},
    {"shown", "", "", "", "frames that were flipped", OF_PROJECTOR(shown)},
    {"dropped", "", "", "", "never shown: a newer one came before, or the window was gone", OF_PROJECTOR(dropped)},
    {"late", "", "", "", "of those shown, at whose flip a newer one was there", OF_PROJECTOR(late)},
    {"waited_out", "", "", "", "frames that were held up for all of projector.wait_ms", OF_PROJECTOR(waited_out)},
    {"refresh_hz", "Hz", "", "when 0", "of the display; 0: not known", OF_PROJECTOR(refresh_hz), .unless_0 = true},
    {"after_render_ms", "ms", "", "without a flip", "from the end of rendering to the flip", .in = after_of,
     FIELD_OBJECT(flip_rows)},
    {"interval_ms", "ms", "", "before the second flip", "from flip to flip", .in = interval_of,
     FIELD_OBJECT(flip_rows)},
    {"off_refresh_ms", "ms", "", "when the refresh rate is not known",
     "how far that is from a whole number of refreshes", .in = off_of, FIELD_OBJECT(flip_rows)},
};

static const Field entity_rows[] = {
    {"created", "", "", "", "new ones", OF_RESULT(entities.created)},
    {"timed_out", "", "", "", "removed after a timeout", OF_RESULT(entities.timed_out)},
    {"deactivated", "", "", "", "by their last Entity State", OF_RESULT(entities.deactivated)},
    {"removed", "", "", "", "by a Remove Entity PDU", OF_RESULT(entities.removed)},
    {"evicted", "", "", "", "given up for others, when the table was full", OF_RESULT(entities.evicted)},
    {"refused", "", "", "", "not taken, since all others came first", OF_RESULT(entities.refused)},
    {"over_rate", "", "", "when 0", "reports of new ones beyond entities.new_per_s of their sender",
     OF_RESULT(entities.over_rate), .unless_0 = true},
    {"tombstones_dropped", "", "", "when 0", "ends forgotten while a late report could still come",
     OF_RESULT(entities.tombstones_dropped), .unless_0 = true},
    {"marks_forgotten", "", "", "when 0", "the oldest ground marks (stands, tracks, burns), beyond capacity",
     OF_RESULT(entities.marks_forgotten), .unless_0 = true},
    {"shots_forgotten", "", "", "when 0", "Fire PDUs, of which the latest 1024 are known", OF_RESULT(shots_forgotten),
     .unless_0 = true},
    {"munitions_forgotten", "", "", "when 0", "munitions, of which the latest 256 of a sort are known",
     OF_RESULT(munitions_forgotten), .unless_0 = true},
    {"most_left_out_of_a_frame", "", "", "", "beyond the nearest entities.shown", OF_RESULT(most_left_out)},
};

static const Field effect_rows[] = {
    {"events_refused", "", "", "", "Fire and Detonation PDUs rejected", OF_RESULT(effects.refused)},
    {"events_repeated", "", "", "", "duplicates", OF_RESULT(effects.repeated)},
    {"events_dropped", "", "", "", "dropped because the table was full", OF_RESULT(effects.events_dropped)},
    {"trails_dropped", "", "", "", "dropped because the table was full", OF_RESULT(effects.sources_dropped)},
};

static const Field skip_rows[] = {
    {"ray_entity_pairs", "", "", "", "ray-entity pairs in all", OF_RENDER(visibility.skipped_parts)},
    {"sun_ray_entity_pairs", "", "", "", "shadow-ray-entity pairs in all", OF_RENDER(visibility.skipped_sun_parts)},
    {"tiles_without_entities", "", "", "", "tiles of the image", OF_RENDER(tiles_without_entities)},
    {"SKIP", "", "", "", "by kind", .item = next_skip, .kind = FIELD_OF_COUNT},
};

static const Field counter_rows[] = {
    {"datagrams", "", "", "", "received, of this exercise or another", IN_HEARD(datagrams), .channel = FIELD_COUNTERS},
    {"pdus", "", "", "", "by PDU type", FIELD_OBJECT(pdu_rows), .get = pdus, .channel = FIELD_COUNTERS},
    {"dropped", "", "", "", "PDUs rejected, by reason", FIELD_OBJECT(drop_rows), .get = dropped,
     .channel = FIELD_COUNTERS},
    {"lengths_made", "", "", "when 0", "PDUs with a length field of 0, taken by their type and the datagram's length",
     IN_HEARD(lengths_made), .unless_0 = true},
    {"padded", "", "", "when 0", "runs of zeros behind a PDU, passed over", IN_HEARD(padded), .unless_0 = true},
    {"stamps_doubted", "", "", "", "time stamps inconsistent with their arrival", IN_HEARD(stamps_doubted)},
    {"packets_without_datagram", "", "", "",
     "of the capture: other protocols, other ports, cut short, incomplete fragments",
     FIELD_GET("integer", packets_lost), .channel = FIELD_COUNTERS},
    {"own", "", "", "", "datagrams of this node itself, ignored", IN_RUN(own), .channel = FIELD_COUNTERS},
    {"live", "", "", "in a replay", "counters of a live node only", .in = live_of, FIELD_OBJECT(live_rows)},
    {"cigi", "", "", "without exercise.cigi", "of a CIGI host", .in = cigi_of, FIELD_OBJECT(cigi_rows)},
    {"head", "", "", "without exercise.head, and in a replay", "datagrams of a head tracker", .in = head_of,
     FIELD_OBJECT(head_rows)},
    {"answers", "", "", "without publish.detections_port", "datagrams of a recogniser", .in = answers_of,
     FIELD_OBJECT(answer_rows)},
    {"streams", "", "", "without publish.stream", "datagrams of all streams", .in = streams_of,
     FIELD_OBJECT(stream_rows)},
    {"projector", "", "", "without projector.band", "frames on a display", .in = projector_of,
     FIELD_OBJECT(projector_rows)},
    {"frames_in_a_lost_ring", "", "", "when 0",
     "frames in shared memory whose name had been removed or replaced by another program",
     IN_RESULT(sent.frames_unnamed), .unless_0 = true},
    {"frames_at_gimbal_limit", "", "", "", "frames with the aim point beyond the gimbal limit", IN_RESULT(at_limit)},
    {"frames_without_radar", "", "", "radar.preset, live or a recording of that",
     "frames whose radar was left out, as signatures of targets were still to be made; absent: none",
     FIELD_GET("integer", without_radar), .unless_0 = true},
    {"frames_of_coarse_radar", "", "", "radar.preset, live or a recording of that",
     "frames whose radar had coarse signatures, as finer ones were still to be made; absent: none",
     FIELD_GET("integer", coarse_radar), .unless_0 = true},
    {"frames_reduced", "", "", "when 0", "frames in which a live node gave something up to keep its rate",
     IN_RESULT(frames_reduced), .unless_0 = true},
    {"frames_without_all_entities", "", "", "", "frames that left some out", IN_RESULT(frames_crowded)},
    {"entities", "", "", "", "of the entity table", .in = run_result_of, FIELD_OBJECT(entity_rows),
     .channel = FIELD_COUNTERS},
    {"effects", "", "", "", "bursts, flashes, smoke", .in = run_result_of, FIELD_OBJECT(effect_rows),
     .channel = FIELD_COUNTERS},
    {"rays_primary", "", "", "", "primary rays, of these:", IN_RENDER(rays_primary)},
    {"rays_edges", "", "", "", "for pixels with an edge in them", IN_RENDER(rays_edges)},
    {"rays_small_targets", "", "", "", "for small targets", IN_RENDER(rays_small_targets)},
    {"pixels", "px", "", "", "in all frames", IN_RENDER(pixels)},
    {"pixels_refined", "px", "", "", "with additional rays", IN_RENDER(pixels_refined)},
    {"small_targets", "", "", "", "targets below 16 px, in all frames", IN_RENDER(small_targets)},
    {"small_targets_by_pixels", "", "", "when 0",
     "of these, beyond the limit of rays a frame (4 per pixel, at least 131072): sampled by pixels, the nearest the boresight last",
     IN_RENDER(small_targets_by_pixels), .unless_0 = true},
    {"rays_ground", "", "", "", "rays tested against the ground", IN_RENDER(visibility.rays_ground)},
    {"rays_parts", "", "", "", "rays tested against parts of entities", IN_RENDER(visibility.rays_parts)},
    {"rays_sun_ground", "", "", "", "shadow rays against the ground", IN_RENDER(visibility.rays_sun_ground)},
    {"rays_sun_parts", "", "", "", "shadow rays against parts of entities", IN_RENDER(visibility.rays_sun_parts)},
    {"hits_by_table", "", "", "", "first hits of plants by tables (terrain.woods_tables)",
     IN_RENDER(visibility.hits_by_table)},
    {"rays_sun_for_heat", "", "", "",
     "rays to the sun from plants that served their light and their temperature: so many were saved",
     IN_RENDER(visibility.rays_sun_for_heat)},
    {"skipped", "", "", "", "computations skipped, with the same output (--no-skip)", .in = render_of,
     FIELD_OBJECT(skip_rows)},
};
const FieldTable run_counter_fields = {counter_rows, sizeof counter_rows / sizeof *counter_rows};
