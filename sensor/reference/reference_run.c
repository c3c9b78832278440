/* sensor/reference/reference_run.c: fields of run.json. */
#include "sensor/reference/reference.h"

#include "dis/pdu/pdu.h"
#include "render/trace/visibility/visibility.h"
#include "sensor/node/session/session.h"

static const char *drop(int i) { return i < DIS_DROP_COUNT ? dis_drop_name((DisDrop)i) : NULL; }
static const char *skip(int i) { return i < SKIP_COUNT ? visibility_skip_name((Skip)i) : NULL; }
static const char *what_skip(int i) { return visibility_skip_what((Skip)i); }
static const char *kind(int i) { return i < PLANT_STANDING ? plant_name((PlantKind)i) : NULL; }
static const char *stage(int i) { return i < session_stages ? session_stage_name[i] : NULL; }

/* All but those that are no fault. */
static const char *answer_fault(int i)
{
    const int reason = i + 1 + (i + 1 >= DETECTIONS_LATE);
    return reason < DETECTIONS_REASONS ? detections_reason_name[reason] : NULL;
}

static const char *latency(int i) { return i < LATENCY_STAGE_COUNT ? latency_stage_name[i] : NULL; }

static const ReferenceField fields[] = {
    {"pitviper", "string", "", "", "", "version of the program"},
    {"status", "string", "", "", "", "complete; stopped: by a signal; failed"},
    {"planes", "string", "", "", "", "planes of the truth files, or `none` (--planes, --no-files)"},
    {"config_sha256", "string", "", "", "", "SHA-256 of every setting that the planes depend on"},
    {"settings", "object", "", "", "", "those settings, given or by default"},
    {"settings.KEY", "string", "as in `pitviper check --default`", "", "", "its value as text; `nan`: not given"},
    {"tables_sha256", "object", "", "", "", "the tables and model files that were readable"},
    {"tables_sha256.FILE", "string", "", "", "", "SHA-256; of a folder of the atmosphere: of all its tables"},
    {"log", "string", "", "", "", "name of the log, or of the network's address"},
    {"log_sha256", "string", "", "", "in a live run", "SHA-256 of the log's octets"},
    {"seed", "integer", "", "", "", "of all random numbers"},
    {"threads", "integer", "", "", "", "number of threads; no effect on the planes"},
    {"isa", "string", "", "", "", "instruction set of the ray tracer"},
    {"libraries", "object", "", "", "", "libraries used in the computation"},
    {"libraries.LIBRARY", "string", "", "", "", "its version"},
    {"memory", "string", "", "", "without publish.memory", "name of the ring of frames in /dev/shm"},
    {"detections_port", "integer", "", "", "without publish.detections_port",
     "UDP port that received a recogniser's detections"},
    {"hosts", "list of strings", "", "site:application:entity, or `observer`", "",
     "which entities carried the sensor, one after the other"},
    {"choices", "list of strings", "", "`what: choice`", "", "automatic choices, as printed"},
    {"frames", "integer", "", "", "", "number of frames rendered"},
    {"frame_sha256", "list of strings", "", "as frame_number", "with publish.truth false", "SHA-256 of all planes before they are encoded"},
    {"frame_number", "list of integers", "", "from 0", "",
     "numbers of the frames in frame_sha256; of a very long run only the first"},
    {"materials", "list of strings", "", "", "", "names of the materials: the k-th, from 1, is value k of the material "
     "planes"},
    {"woods", "object", "", "", "with terrain.woods off", "plants that stand on the ground"},
    {"woods.plants", "integer", "", "", "", "trees, bushes and hedges"},
    {"woods.kinds", "object", "", "", "", "of these, by kind"},
    {"woods.kinds.KIND", "integer", "", "", "", "plants"},
    {"woods.from", "object", "", "", "", "by what says where they stand"},
    {"woods.from.crowns", "integer", "", "", "", "trunks marked in the terrain store"},
    {"woods.from.canopy", "integer", "", "", "", "its layers of canopy height and cover"},
    {"woods.from.classes", "integer", "", "", "", "surface classes alone"},
    {"woods.from.hedges", "integer", "", "", "", "edges of fields"},
    {"woods.left_out", "integer", "", "", "", "plants beyond terrain.woods_trees"},
    {"woods.reach_m", "number", "m", "from the aim, when the world was made", "", "within it none is left out"},
    {"woods.paths", "integer", "", "", "", "straight pieces of paths cleared of plants; on real ground none"},
    {"woods.entities", "integer", "", "", "", "entities on the ground at their first report"},
    {"woods.in_trunks", "integer", "", "", "", "of these, within a trunk"},
    {"woods.list_mb", "number", "MB", "", "", "memory of the list of plants, without the ray tracer's"},
    {"counters", "object", "", "", "", "over the whole run"},
    {"counters.datagrams", "integer", "", "", "", "received, of this exercise or another"},
    {"counters.pdus", "object", "", "", "", "by PDU type"},
    {"counters.pdus.TYPE", "integer", "", "", "when there were none", "well-formed PDUs of this type"},
    {"counters.dropped", "object", "", "", "", "PDUs rejected, by reason"},
    {"counters.dropped.REASON", "integer", "", "", "", "PDUs"},
    {"counters.lengths_made", "integer", "", "", "when 0",
     "PDUs with a length field of 0, taken by their type and the datagram's length"},
    {"counters.padded", "integer", "", "", "when 0", "runs of zeros behind a PDU, passed over"},
    {"counters.stamps_doubted", "integer", "", "", "", "time stamps inconsistent with their arrival"},
    {"counters.packets_without_datagram", "integer", "", "", "",
     "of the capture: other protocols, other ports, cut short, incomplete fragments"},
    {"counters.own", "integer", "", "", "", "datagrams of this node itself, ignored"},
    {"counters.live", "object", "", "", "in a replay", "counters of a live node only"},
    {"counters.live.datagrams", "integer", "", "", "", "received from the network"},
    {"counters.live.lost_kernel", "integer", "", "", "", "lost in the kernel"},
    {"counters.live.lost_queue", "integer", "", "", "", "lost because the receive queue was full"},
    {"counters.live.sent", "integer", "", "", "", "Data PDUs sent"},
    {"counters.live.send_failed", "integer", "", "", "", "Data PDUs that could not be sent"},
    {"counters.live.record_failed", "integer", "", "", "", "datagrams that --record could not write"},
    {"counters.live.frames_late", "integer", "", "", "", "frames dropped because they were too late"},
    {"counters.live.rate_hz", "number", "Hz", "", "without a frame", "frames asked for"},
    {"counters.live.kept_share", "number", "", "0 .. 1", "without a frame", "of the frames that were due, those that were made"},
    {"counters.live.files_failed", "integer", "", "", "", "frames whose files could not be written"},
    {"counters.live.files_left_out", "integer", "", "", "", "frames without files because the disk was too slow"},
    {"counters.answers", "object", "", "", "without publish.detections_port", "datagrams of a recogniser"},
    {"counters.answers.datagrams", "integer", "", "", "", "all that arrived: taken, refused or lost"},
    {"counters.answers.taken", "integer", "", "", "", "answers in answers.jsonl"},
    {"counters.answers.late", "integer", "", "", "", "of these, received after that to a newer frame: not in metadata"},
    {"counters.answers.refused", "object", "", "", "", "by reason"},
    {"counters.answers.refused.FAULT", "integer", "", "", "when there were none", "datagrams"},
    {"counters.answers.lost_kernel", "integer", "", "", "", "lost in the kernel, since they came too fast"},
    {"counters.answers.lines", "integer", "", "", "", "of answers.jsonl"},
    {"counters.answers.lines_failed", "integer", "", "", "when 0", "that could not be written"},
    {"counters.streams", "object", "", "", "without publish.stream", "datagrams of all streams"},
    {"counters.streams.sent", "integer", "", "", "", "taken by the network"},
    {"counters.streams.refused", "integer", "", "", "", "not sent, since no program listened to those before"},
    {"counters.streams.no_route", "integer", "", "", "", "not sent, since there was no way to the address"},
    {"counters.streams.lost", "integer", "", "", "", "not sent, since the network was too slow"},
    {"counters.frames_in_a_lost_ring", "integer", "", "", "when 0",
     "frames in shared memory whose name had been removed or replaced by another program"},
    {"counters.frames_at_gimbal_limit", "integer", "", "", "", "frames with the aim point beyond the gimbal limit"},
    {"counters.frames_without_radar", "integer", "", "", "radar.preset, live or a recording of that",
     "frames whose radar was left out, as signatures of targets were still to be made; absent: none"},
    {"counters.entities", "object", "", "", "", "of the entity table"},
    {"counters.entities.created", "integer", "", "", "", "new ones"},
    {"counters.entities.timed_out", "integer", "", "", "", "removed after a timeout"},
    {"counters.entities.deactivated", "integer", "", "", "", "by their last Entity State"},
    {"counters.entities.removed", "integer", "", "", "", "by a Remove Entity PDU"},
    {"counters.entities.evicted", "integer", "", "", "", "given up for others, when the table was full"},
    {"counters.entities.refused", "integer", "", "", "", "not taken, since all others came first"},
    {"counters.entities.over_rate", "integer", "", "", "when 0",
     "reports of new ones beyond entities.new_per_s of their sender"},
    {"counters.entities.tombstones_dropped", "integer", "", "", "when 0",
     "ends forgotten while a late report could still come"},
    {"counters.entities.marks_forgotten", "integer", "", "", "when 0",
     "the oldest ground marks (stands, tracks, burns), beyond capacity"},
    {"counters.entities.shots_forgotten", "integer", "", "", "when 0",
     "Fire PDUs, of which the latest 1024 are known"},
    {"counters.entities.munitions_forgotten", "integer", "", "", "when 0",
     "munitions, of which the latest 256 of a sort are known"},
    {"counters.entities.most_left_out_of_a_frame", "integer", "", "", "", "beyond the nearest entities.shown"},
    {"counters.frames_without_all_entities", "integer", "", "", "", "frames that left some out"},
    {"counters.effects", "object", "", "", "", "bursts, flashes, smoke"},
    {"counters.effects.events_refused", "integer", "", "", "", "Fire and Detonation PDUs rejected"},
    {"counters.effects.events_repeated", "integer", "", "", "", "duplicates"},
    {"counters.effects.events_dropped", "integer", "", "", "", "dropped because the table was full"},
    {"counters.effects.trails_dropped", "integer", "", "", "", "dropped because the table was full"},
    {"counters.rays_primary", "integer", "", "", "", "primary rays, of these:"},
    {"counters.rays_edges", "integer", "", "", "", "for pixels with an edge in them"},
    {"counters.rays_small_targets", "integer", "", "", "", "for small targets"},
    {"counters.pixels", "integer", "px", "", "", "in all frames"},
    {"counters.pixels_refined", "integer", "px", "", "", "with additional rays"},
    {"counters.small_targets", "integer", "", "", "", "targets below 16 px, in all frames"},
    {"counters.small_targets_by_pixels", "integer", "", "", "when 0",
     "of these, beyond the limit of rays a frame (4 per pixel, at least 131072): sampled by pixels, the nearest the boresight last"},
    {"counters.rays_ground", "integer", "", "", "", "rays tested against the ground"},
    {"counters.rays_parts", "integer", "", "", "", "rays tested against parts of entities"},
    {"counters.rays_sun_ground", "integer", "", "", "", "shadow rays against the ground"},
    {"counters.rays_sun_parts", "integer", "", "", "", "shadow rays against parts of entities"},
    {"counters.rays_sun_for_heat", "integer", "", "", "", "rays to the sun from plants that served their light and their "
     "temperature: so many were saved"},
    {"counters.skipped", "object", "", "", "", "computations skipped, with the same output (--no-skip)"},
    {"counters.skipped.ray_entity_pairs", "integer", "", "", "", "ray-entity pairs in all"},
    {"counters.skipped.sun_ray_entity_pairs", "integer", "", "", "", "shadow-ray-entity pairs in all"},
    {"counters.skipped.tiles_without_entities", "integer", "", "", "", "tiles of the image"},
    {"counters.skipped.SKIP", "integer", "", "", "", "by kind"},
    {"timings_ms", "object", "", "", "", "wall time per stage of a frame; differs in every run"},
    {"timings_ms.STAGE", "object", "", "", "", "one stage; `frame` is the total"},
    {"timings_ms.STAGE.median", "number", "ms", "", "", "median over the frames"},
    {"timings_ms.STAGE.p95", "number", "ms", "", "", "95th percentile"},
    {"timings_ms.STAGE.max", "number", "ms", "", "", "maximum"},
    {"latency_ms", "object", "", "", "in a replay at full speed",
     "latency_ms of truth.jsonl over all frames; of a run and of replay --speed X"},
    {"latency_ms.edges_ms", "list of 31 numbers", "ms", "ascending", "",
     "edges of the histograms' bins, five a decade, 0.01 ms .. 10 s"},
    {"latency_ms.LATENCY", "object", "", "", "when no frame has it",
     "one step; arrival_to_pose: only of frames that used a datagram which no earlier frame used"},
    {"latency_ms.LATENCY.median", "number", "ms", "", "", "median, at most 2.4 % above the exact one"},
    {"latency_ms.LATENCY.p95", "number", "ms", "", "", "95th percentile, likewise"},
    {"latency_ms.LATENCY.p99", "number", "ms", "", "", "99th percentile, likewise"},
    {"latency_ms.LATENCY.max", "number", "ms", "", "", "maximum"},
    {"latency_ms.LATENCY.count", "integer", "", "", "", "number of frames"},
    {"latency_ms.LATENCY.histogram", "list of 32 integers", "", "below the first edge, between edges, above the last",
     "", "number of frames by latency"},
    {"latency_ms.consumers", "object", "", "", "", "by consumer: from the end of rendering until it was done"},
    {"latency_ms.consumers.CONSUMER", "object", "", "", "", "one consumer"},
    {"latency_ms.consumers.CONSUMER.median", "number", "ms", "", "when it was done with no frame", "as above"},
    {"latency_ms.consumers.CONSUMER.p95", "number", "ms", "", "when it was done with no frame", "as above"},
    {"latency_ms.consumers.CONSUMER.p99", "number", "ms", "", "when it was done with no frame", "as above"},
    {"latency_ms.consumers.CONSUMER.max", "number", "ms", "", "when it was done with no frame", "as above"},
    {"latency_ms.consumers.CONSUMER.count", "integer", "", "", "", "frames that it was done with"},
    {"latency_ms.consumers.CONSUMER.left_out", "integer", "", "", "", "frames that it was not given, for lack of time"},
    {"latency_ms.consumers.CONSUMER.histogram", "list of 32 integers", "", "as above", "", "number of frames by latency"},
};

static const ReferenceWord words[] = {
    {"KEY", "a setting's section and key with a dot between, such as sensor.width_px", NULL, NULL},
    {"FILE", "catalog.csv, atmosphere/midlat_summer, a model's file as the catalog names it", NULL, NULL},
    {"LIBRARY", "embree, openimageio, geographiclib, erfa, fftw, libc, compiler", NULL, NULL},
    {"TYPE", "the PDU type's number: 1 Entity State, 2 Fire, 3 Detonation ...", NULL, NULL},
    {"REASON", "one of", drop, NULL},
    {"FAULT", "one of", answer_fault, NULL},
    {"SKIP", "one of", skip, what_skip},
    {"KIND", "one of", kind, NULL},
    {"STAGE", "one of", stage, NULL},
    {"LATENCY", "one of", latency, NULL},
    REFERENCE_WORD_CONSUMER,
};

const Reference reference_run = {
    .topic = "run.json",
    .file  = "run.json",
    .title = "the run: settings, hashes, choices, counters, times",
    .about = "Written at the end of a run, also of one that was stopped. Two runs with the same config_sha256, "
             "log_sha256,\n"
             "tables_sha256, version and libraries have the same frame_sha256.",
    .field = REFERENCE_FIELDS(fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json\n"
        "run = json.load(open('run.json'))\n"
        "print(run['pitviper'], run['frames'], 'frames from', ', '.join(run['hosts']))\n"
        "for line in run['choices']:\n"
        "    print('chosen:', line)\n"
        "hashes = dict(zip(run['frame_number'], run['frame_sha256']))\n"
        "lost = {why: n for why, n in run['counters']['dropped'].items() if n}\n"
        "print(lost, run['timings_ms']['frame']['median'], 'ms a frame', len(hashes))\n",
};
