/* sensor/node/run/run_counters.c: the counters of run.json. */
#include "sensor/frame/json_object.h"
#include "sensor/node/run/run_record_private.h"

/* ---- where the values are, and those that are no plain member ------------------------------------ */

static json_t *count_of(uint64_t count) { return json_integer((json_int_t)count); }

static const void *heard_of(const void *of) { return ((const RunRecord *)of)->end->heard; }
static const void *render_of(const void *of) { return &((const RunRecord *)of)->end->result->counters; }
static const void *live_of(const void *of) { return ((const RunRecord *)of)->run->live; }

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

/* NULL: it ended before its rate was known. */
static const void *rated(const void *of)
{
    const LiveCounters *live = of;
    return live->rate_hz > 0 ? live : NULL;
}

static const void *next_fault(FieldItem *item, const void *of, int i, const void *record)
{
    const AnswerCounters *c = of;
    (void)record;
    if (i == DETECTIONS_REASONS) return NULL;
    return run_keyed(item, i == DETECTIONS_GOOD || i == DETECTIONS_LATE ? "" : detections_reason_name[i],
                     &c->datagrams[i]);
}

static const void *next_skip(FieldItem *item, const void *of, int i, const void *record)
{
    const RenderCounters *c = of;
    (void)record;
    return i < SKIP_COUNT ? run_keyed(item, visibility_skip_name((Skip)i), &c->visibility.skipped[i]) : NULL;
}

static json_t *pdus(const void *of, const void *record)
{
    const DisCounters *c = heard_of(of);
    json_t            *object = json_object();
    char               type[16];
    (void)record;
    for (int i = 0; i < 256; i++) {
        snprintf(type, sizeof type, "%d", i);
        if (c->pdus[i]) json_object_set_new(object, type, count_of(c->pdus[i]));
    }
    return object;
}

/* A length of 0 is absent when there was none, so that records from before it was counted stay comparable. */
static json_t *dropped(const void *of, const void *record)
{
    const DisCounters *c = heard_of(of);
    json_t            *object = json_object();
    (void)record;
    for (int i = 0; i < DIS_DROP_COUNT; i++)
        if (i != DIS_DROP_LENGTH_ZERO || c->dropped[i])
            json_object_set_new(object, dis_drop_name((DisDrop)i), count_of(c->dropped[i]));
    return object;
}

static json_t *packets_lost(const void *of, const void *record)
{
    const DisLogCounters *link = ((const Run *)run_of_record(of))->link;
    (void)record;
    return count_of(link ? dis_log_dropped(link) : 0);
}

static json_t *kept_share(const void *of, const void *record)
{
    const SessionResult *result = run_result_of(record);
    return rated(of) ? json_real(record_live_kept_share(of, (uint64_t)result->frames)) : NULL;
}

static json_t *answers_received(const void *of, const void *record)
{
    const AnswerCounters *c = of;
    uint64_t              received = c->lost_kernel;
    (void)record;
    for (int i = 0; i < DETECTIONS_REASONS; i++) received += c->datagrams[i];
    return count_of(received);
}

static json_t *answers_taken(const void *of, const void *record)
{
    const AnswerCounters *c = of;
    (void)record;
    return count_of(c->datagrams[DETECTIONS_GOOD] + c->datagrams[DETECTIONS_LATE]);
}

/* ---- the fields ---------------------------------------------------------------------------------- */

static const Field pdu_rows[] = {
    {"TYPE", "integer", "", "", "when there were none", "well-formed PDUs of this type", .elsewhere = true},
};
static const FieldTable pdu_fields = FIELD_TABLE(pdu_rows);

static const Field drop_rows[] = {
    {"REASON", "integer", "", "", "", "PDUs", .elsewhere = true},
};
static const FieldTable drop_fields = FIELD_TABLE(drop_rows);

static const Field live_rows[] = {
    {"datagrams", "integer", "", "", "", "received from the network", FIELD_MEMBER(LiveCounters, datagrams)},
    {"lost_kernel", "integer", "", "", "", "lost in the kernel", FIELD_MEMBER(LiveCounters, lost_kernel)},
    {"lost_queue", "integer", "", "", "", "lost because the receive queue was full",
     FIELD_MEMBER(LiveCounters, lost_queue)},
    {"sent", "integer", "", "", "", "Data PDUs sent", FIELD_MEMBER(LiveCounters, sent)},
    {"send_failed", "integer", "", "", "", "Data PDUs that could not be sent", FIELD_MEMBER(LiveCounters, send_failed)},
    {"record_failed", "integer", "", "", "", "datagrams that --record could not write",
     FIELD_MEMBER(LiveCounters, record_failed)},
    {"frames_late", "integer", "", "", "", "frames dropped because they were too late",
     FIELD_MEMBER(LiveCounters, frames_late)},
    {"rate_hz", "number", "Hz", "", "without a frame", "frames asked for", .at = rated,
     FIELD_MEMBER(LiveCounters, rate_hz)},
    {"kept_share", "number", "", "0 .. 1", "without a frame", "of the frames that were due, those that were made",
     .get = kept_share},
    {"files_failed", "integer", "", "", "", "frames whose files could not be written",
     FIELD_MEMBER(LiveCounters, files_failed)},
    {"files_left_out", "integer", "", "", "", "frames without files because the disk was too slow",
     FIELD_MEMBER(LiveCounters, files_left_out)},
};
static const FieldTable live_fields = FIELD_TABLE(live_rows);

static const Field fault_rows[] = {
    {"FAULT", "integer", "", "", "when there were none", "datagrams", .item = next_fault, .kind = FIELD_OF_COUNT,
     .unless_0 = true},
};
static const FieldTable fault_fields = FIELD_TABLE(fault_rows);

static const Field answer_rows[] = {
    {"datagrams", "integer", "", "", "", "all that arrived: taken, refused or lost", .get = answers_received},
    {"taken", "integer", "", "", "", "answers in answers.jsonl", .get = answers_taken},
    {"late", "integer", "", "", "", "of these, received after that to a newer frame: not in metadata",
     FIELD_MEMBER(AnswerCounters, datagrams[DETECTIONS_LATE])},
    {"refused", "object", "", "", "", "by reason", .rows = &fault_fields},
    {"lost_kernel", "integer", "", "", "", "lost in the kernel, since they came too fast",
     FIELD_MEMBER(AnswerCounters, lost_kernel)},
    {"lines", "integer", "", "", "", "of answers.jsonl", FIELD_MEMBER(AnswerCounters, lines)},
    {"lines_failed", "integer", "", "", "when 0", "that could not be written",
     FIELD_MEMBER(AnswerCounters, lines_failed), .unless_0 = true},
};
static const FieldTable answer_fields = FIELD_TABLE(answer_rows);

static const Field stream_rows[] = {
    {"sent", "integer", "", "", "", "taken by the network", FIELD_MEMBER(StreamCounters, sent)},
    {"refused", "integer", "", "", "", "not sent, since no program listened to those before",
     FIELD_MEMBER(StreamCounters, refused)},
    {"no_route", "integer", "", "", "", "not sent, since there was no way to the address",
     FIELD_MEMBER(StreamCounters, no_route)},
    {"lost", "integer", "", "", "", "not sent, since the network was too slow", FIELD_MEMBER(StreamCounters, lost)},
};
static const FieldTable stream_fields = FIELD_TABLE(stream_rows);

static const Field entity_rows[] = {
    {"created", "integer", "", "", "", "new ones", FIELD_MEMBER(SessionResult, entities.created)},
    {"timed_out", "integer", "", "", "", "removed after a timeout", FIELD_MEMBER(SessionResult, entities.timed_out)},
    {"deactivated", "integer", "", "", "", "by their last Entity State",
     FIELD_MEMBER(SessionResult, entities.deactivated)},
    {"removed", "integer", "", "", "", "by a Remove Entity PDU", FIELD_MEMBER(SessionResult, entities.removed)},
    {"evicted", "integer", "", "", "", "given up for others, when the table was full",
     FIELD_MEMBER(SessionResult, entities.evicted)},
    {"refused", "integer", "", "", "", "not taken, since all others came first",
     FIELD_MEMBER(SessionResult, entities.refused)},
    {"over_rate", "integer", "", "", "when 0", "reports of new ones beyond entities.new_per_s of their sender",
     FIELD_MEMBER(SessionResult, entities.over_rate), .unless_0 = true},
    {"tombstones_dropped", "integer", "", "", "when 0", "ends forgotten while a late report could still come",
     FIELD_MEMBER(SessionResult, entities.tombstones_dropped), .unless_0 = true},
    {"marks_forgotten", "integer", "", "", "when 0", "the oldest ground marks (stands, tracks, burns), beyond capacity",
     FIELD_MEMBER(SessionResult, entities.marks_forgotten), .unless_0 = true},
    {"shots_forgotten", "integer", "", "", "when 0", "Fire PDUs, of which the latest 1024 are known",
     FIELD_MEMBER(SessionResult, shots_forgotten), .unless_0 = true},
    {"munitions_forgotten", "integer", "", "", "when 0", "munitions, of which the latest 256 of a sort are known",
     FIELD_MEMBER(SessionResult, munitions_forgotten), .unless_0 = true},
    {"most_left_out_of_a_frame", "integer", "", "", "", "beyond the nearest entities.shown",
     FIELD_MEMBER(SessionResult, most_left_out)},
};
static const FieldTable entity_fields = FIELD_TABLE(entity_rows);

static const Field effect_rows[] = {
    {"events_refused", "integer", "", "", "", "Fire and Detonation PDUs rejected",
     FIELD_MEMBER(SessionResult, effects.refused)},
    {"events_repeated", "integer", "", "", "", "duplicates", FIELD_MEMBER(SessionResult, effects.repeated)},
    {"events_dropped", "integer", "", "", "", "dropped because the table was full",
     FIELD_MEMBER(SessionResult, effects.events_dropped)},
    {"trails_dropped", "integer", "", "", "", "dropped because the table was full",
     FIELD_MEMBER(SessionResult, effects.sources_dropped)},
};
static const FieldTable effect_fields = FIELD_TABLE(effect_rows);

static const Field skip_rows[] = {
    {"ray_entity_pairs", "integer", "", "", "", "ray-entity pairs in all",
     FIELD_MEMBER(RenderCounters, visibility.skipped_parts)},
    {"sun_ray_entity_pairs", "integer", "", "", "", "shadow-ray-entity pairs in all",
     FIELD_MEMBER(RenderCounters, visibility.skipped_sun_parts)},
    {"tiles_without_entities", "integer", "", "", "", "tiles of the image",
     FIELD_MEMBER(RenderCounters, tiles_without_entities)},
    {"SKIP", "integer", "", "", "", "by kind", .item = next_skip, .kind = FIELD_OF_COUNT},
};
static const FieldTable skip_fields = FIELD_TABLE(skip_rows);

static const Field counter_rows[] = {
    {"datagrams", "integer", "", "", "", "received, of this exercise or another", .at = heard_of,
     FIELD_MEMBER(DisCounters, datagrams), .channel = FIELD_COUNTERS},
    {"pdus", "object", "", "", "", "by PDU type", .get = pdus, .rows = &pdu_fields, .channel = FIELD_COUNTERS},
    {"dropped", "object", "", "", "", "PDUs rejected, by reason", .get = dropped, .rows = &drop_fields,
     .channel = FIELD_COUNTERS},
    {"lengths_made", "integer", "", "", "when 0",
     "PDUs with a length field of 0, taken by their type and the datagram's length", .at = heard_of,
     FIELD_MEMBER(DisCounters, lengths_made), .unless_0 = true},
    {"padded", "integer", "", "", "when 0", "runs of zeros behind a PDU, passed over", .at = heard_of,
     FIELD_MEMBER(DisCounters, padded), .unless_0 = true},
    {"stamps_doubted", "integer", "", "", "", "time stamps inconsistent with their arrival", .at = heard_of,
     FIELD_MEMBER(DisCounters, stamps_doubted)},
    {"packets_without_datagram", "integer", "", "", "",
     "of the capture: other protocols, other ports, cut short, incomplete fragments", .get = packets_lost,
     .channel = FIELD_COUNTERS},
    {"own", "integer", "", "", "", "datagrams of this node itself, ignored", .at = run_of_record,
     FIELD_MEMBER(Run, own), .channel = FIELD_COUNTERS},
    {"live", "object", "", "", "in a replay", "counters of a live node only", .at = live_of, .rows = &live_fields},
    {"answers", "object", "", "", "without publish.detections_port", "datagrams of a recogniser", .at = answers_of,
     .rows = &answer_fields},
    {"streams", "object", "", "", "without publish.stream", "datagrams of all streams", .at = streams_of,
     .rows = &stream_fields},
    {"frames_in_a_lost_ring", "integer", "", "", "when 0",
     "frames in shared memory whose name had been removed or replaced by another program", .at = run_result_of,
     FIELD_MEMBER(SessionResult, sent.frames_unnamed), .unless_0 = true},
    {"frames_at_gimbal_limit", "integer", "", "", "", "frames with the aim point beyond the gimbal limit",
     .at = run_result_of, FIELD_MEMBER(SessionResult, at_limit)},
    {"frames_without_radar", "integer", "", "", "radar.preset, live or a recording of that",
     "frames whose radar was left out, as signatures of targets were still to be made; absent: none",
     .at = run_result_of, FIELD_MEMBER(SessionResult, radar_left_out), .unless_0 = true},
    {"frames_without_all_entities", "integer", "", "", "", "frames that left some out", .at = run_result_of,
     FIELD_MEMBER(SessionResult, frames_crowded)},
    {"entities", "object", "", "", "", "of the entity table", .at = run_result_of, .rows = &entity_fields,
     .channel = FIELD_COUNTERS},
    {"effects", "object", "", "", "", "bursts, flashes, smoke", .at = run_result_of, .rows = &effect_fields,
     .channel = FIELD_COUNTERS},
    {"rays_primary", "integer", "", "", "", "primary rays, of these:", .at = render_of,
     FIELD_MEMBER(RenderCounters, rays_primary)},
    {"rays_edges", "integer", "", "", "", "for pixels with an edge in them", .at = render_of,
     FIELD_MEMBER(RenderCounters, rays_edges)},
    {"rays_small_targets", "integer", "", "", "", "for small targets", .at = render_of,
     FIELD_MEMBER(RenderCounters, rays_small_targets)},
    {"pixels", "integer", "px", "", "", "in all frames", .at = render_of, FIELD_MEMBER(RenderCounters, pixels)},
    {"pixels_refined", "integer", "px", "", "", "with additional rays", .at = render_of,
     FIELD_MEMBER(RenderCounters, pixels_refined)},
    {"small_targets", "integer", "", "", "", "targets below 16 px, in all frames", .at = render_of,
     FIELD_MEMBER(RenderCounters, small_targets)},
    {"small_targets_by_pixels", "integer", "", "", "when 0",
     "of these, beyond the limit of rays a frame (4 per pixel, at least 131072): sampled by pixels, the nearest the boresight last",
     .at = render_of, FIELD_MEMBER(RenderCounters, small_targets_by_pixels), .unless_0 = true},
    {"rays_ground", "integer", "", "", "", "rays tested against the ground", .at = render_of,
     FIELD_MEMBER(RenderCounters, visibility.rays_ground)},
    {"rays_parts", "integer", "", "", "", "rays tested against parts of entities", .at = render_of,
     FIELD_MEMBER(RenderCounters, visibility.rays_parts)},
    {"rays_sun_ground", "integer", "", "", "", "shadow rays against the ground", .at = render_of,
     FIELD_MEMBER(RenderCounters, visibility.rays_sun_ground)},
    {"rays_sun_parts", "integer", "", "", "", "shadow rays against parts of entities", .at = render_of,
     FIELD_MEMBER(RenderCounters, visibility.rays_sun_parts)},
    {"rays_sun_for_heat", "integer", "", "", "",
     "rays to the sun from plants that served their light and their temperature: so many were saved", .at = render_of,
     FIELD_MEMBER(RenderCounters, visibility.rays_sun_for_heat)},
    {"skipped", "object", "", "", "", "computations skipped, with the same output (--no-skip)", .at = render_of,
     .rows = &skip_fields},
};
const FieldTable run_counter_fields = FIELD_TABLE(counter_rows);
