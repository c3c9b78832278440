/* sensor/frame/records.h: truth.jsonl: the names that other tools read (see
 * etc/reference/products.md).
 *
 * Numbering in files: frames as the run counts them, from 0 on; pixels of boxes from 0 on; everything else - the
 * values of the truth planes entity, part and material, plane_value, ids of coco.json, variants of a manifest - from
 * 1 on, and 0 is none. */
#ifndef SENSOR_FRAME_RECORDS_H
#define SENSOR_FRAME_RECORDS_H

#include "dis/head/head_pose.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/traces/effect_history.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/radar/radar_frame.h"
#include "sensor/truth/truth.h"
#include "sensor/frame/clutter_record.h"
#include "sensor/frame/target_record.h"
#include "sensor/frame/latency_private.h"
#include "sensor/truth/frame_error.h"
#include "terrain/earth/sun.h"

#include <stdio.h>

typedef struct FrameRecord {
    int                   frame;
    double                time_s;
    const Snapshot       *snapshot;
    const Catalog        *catalog;
    const SnapshotEntity *host;    /* NULL: none of the snapshot */
    DisEntityId           host_id; /* without it: 0:0:0: an observer that is no entity; else a missile in the loop */
    double                p_eye_ecef[3], v_eye_mps[3];
    double                r_ecef_from_body[9]; /* of the host; of the camera for an observer */
    double                r_ecef_from_cam[9];
    const RenderRequest  *request;
    double                hfov_rad;
    bool                  gimbal_at_limit;
    double                scene_rate_px_s[2]; /* column, row: image motion of a stationary point at the centre */
    double                ground_km2;         /* truth_ground_area; NaN: not requested */
    const Sun            *sun;
    const TargetRecord   *target;
    int                   target_count;
    const ClutterRecord  *clutter; /* [clutter_count] that is seen */
    int                   clutter_count;
    const char           *frame_sha256; /* NULL: not given */
    const FrameError     *error;        /* NULL: not given */
    const RadarError     *radar_error;  /* likewise */
    const GroundPoint    *footprint;    /* [FOOTPRINT_COUNT]; NULL: not requested */
    const RadarFrame     *radar;        /* NULL: none */
    bool                  turned;       /* the eye, by a head tracker: head */
    HeadPose              head;
    const char           *given_up; /* of quality, by a live node, separated by commas; NULL: nothing */
} FrameRecord;

/* Writes one line and flushes it. STATUS_IO when it cannot be written. */
Status record_write_frame(FILE *file, const FrameRecord *record);
/* These do the same in two steps. The first makes the line as text, which the caller frees with free; NULL: out of
 * memory. The second writes it, with `latency_ms` when latency is not NULL. */
char  *record_frame_text(const FrameRecord *record);
Status record_write_text(FILE *file, const char *text, const LatencyLine *latency);

/* Counters of a live node only. */
enum { live_steps = SAMPLING_QUARTER + 1 };
typedef struct LiveCounters {
    uint64_t datagrams, lost_kernel, lost_queue, sent, send_failed, record_failed;
    uint64_t frames_late, files_failed, files_left_out;
    uint64_t frames_at[live_steps]; /* made, by step of sampling (RenderRequest.sampling) */
    uint64_t frames_lacking;        /* made, but without a band that was asked for */
    double   rate_hz;               /* asked for; 0: it ended before that was known */
    double   ready_s;               /* ready for its entities, after the first was heard; 0: never */
} LiveCounters;
/* Share of the due frames that were made and lack no band; 1 where none was due. */
static inline double record_live_kept_share(const LiveCounters *counters, uint64_t frames)
{
    const uint64_t due = frames + counters->frames_late;
    return due ? (double)(frames - counters->frames_lacking) / (double)due : 1;
}

#endif
