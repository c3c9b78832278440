/* sensor/frame/records.h: truth.jsonl and run.json: the names that other tools read (see
 * etc/reference/products.md).
 *
 * Numbering in files: frames as the run counts them, from 0 on; pixels of boxes from 0 on; everything else - the
 * values of the truth planes entity, part and material, plane_value, ids of coco.json, variants of a manifest - from
 * 1 on, and 0 is none. */
#ifndef SENSOR_FRAME_RECORDS_H
#define SENSOR_FRAME_RECORDS_H

#include "entities/motion/dead_reckoning.h"
#include "entities/traces/effect_history.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/radar/radar_frame.h"
#include "sensor/truth/truth.h"
#include "sensor/frame/target_record.h"
#include "sensor/frame/latency_private.h"
#include "sensor/truth/frame_error.h"
#include "terrain/earth/sun.h"
#include "terrain/woods/woods.h"
#include "render/materials/materials.h"

#include <stdio.h>

typedef struct FrameRecord {
    int                   frame;
    double                time_s;
    const Snapshot       *snapshot;
    const Catalog        *catalog;
    const SnapshotEntity *host; /* NULL: an observer that is no entity */
    double                p_eye_ecef[3], v_eye_mps[3];
    double                r_ecef_from_body[9]; /* of the host; of the camera for an observer */
    double                r_ecef_from_cam[9];
    const RenderRequest  *request;
    double                hfov_rad;
    bool                  gimbal_at_limit;
    double                scene_rate_px_s[2]; /* column, row: image motion of a stationary point at the centre */
    const Sun            *sun;
    const TargetRecord   *target;
    int                   target_count;
    const char           *frame_sha256; /* NULL: not given */
    const FrameError     *error;        /* NULL: not given */
    const RadarError     *radar_error;  /* likewise */
    const GroundPoint    *footprint;    /* [FOOTPRINT_COUNT]; NULL: not requested */
    const RadarFrame     *radar;        /* NULL: none */
    const char           *given_up;     /* of quality, by a live node; NULL: nothing */
} FrameRecord;

/* Writes one line and flushes it. STATUS_IO when it cannot be written. */
Status record_write_frame(FILE *file, const FrameRecord *record);
/* These do the same in two steps. The first makes the line as text, which the caller frees with free; NULL: out of
 * memory. The second writes it, with `latency_ms` when latency is not NULL. */
char  *record_frame_text(const FrameRecord *record);
Status record_write_text(FILE *file, const char *text, const LatencyLine *latency);

/* Counters of a live node only. */
typedef struct LiveCounters {
    uint64_t datagrams, lost_kernel, lost_queue, sent, send_failed, record_failed;
    uint64_t frames_late, files_failed, files_left_out;
    double   rate_hz; /* asked for; 0: it ended before that was known */
} LiveCounters;
/* Share of the due frames that were made; 1 where none was due. */
double record_live_kept_share(const LiveCounters *counters, uint64_t frames);

/* Plants of a run. */
typedef struct WoodsRecord {
    const Woods *woods;
    int          paths;               /* pieces cleared of plants */
    int          entities, in_trunks; /* on the ground at their first report; of these within a trunk */
} WoodsRecord;

typedef struct RunRecord {
    const char        *config_sha256, *log_name, *log_sha256, *isa;
    const char        *settings;    /* `section.key=value`, lines: the text hashed as config_sha256 */
    int                table_count; /* files that were read from etc/, and models */
    const char *const *table, *const *table_sha256;
    long long           seed;
    const char         *planes; /* of truth in files: all, none or a list; NULL: no files */
    const char         *status; /* complete; stopped: by a signal before its last frame; failed */
    int                 threads, host_count, choice_count, frames;
    int                 listed; /* length of the two lists */
    const int          *frame_number;
    const char *const  *host; /* ids as text */
    const char *const  *choice;
    const char *const  *frame_sha256; /* NULL: not computed */
    const DisCounters  *dis;
    uint64_t            link_dropped;   /* packets of the capture without a datagram */
    uint64_t            own;            /* datagrams of this node itself, ignored */
    const LiveCounters *live;           /* NULL: a replay */
    int                 radar_left_out; /* frames without radar, for want of signatures */
    int                 frames_reduced; /* frames with something in their given_up */
    int                 at_limit;       /* frames whose aim was beyond the gimbal limit */
    uint64_t            entities_created, entities_timed_out, entities_deactivated, entities_removed;
    uint64_t            entities_evicted, entities_refused; /* by a full table */
    uint64_t            entities_over_rate, tombstones_dropped, marks_forgotten;
    uint64_t            shots_forgotten, munitions_forgotten; /* of munitions that may yet become the host */
    int                 frames_crowded, most_left_out; /* frames without all entities; the most that one frame lacks */
    EffectCounters      effects;
    RenderCounters      render;
    int                 stage_count; /* timings */
    const char *const  *stage;
    double (*stage_ms)[3];                 /* median, p95, max */
    const LatencySummary *latency;         /* NULL: no ledger was kept */
    const char           *memory;          /* name of the ring of frames; NULL: none */
    int                   detections_port; /* 0: none */
    const AnswerCounters *answers;         /* received there; NULL: none */
    const SentCounters   *sent;            /* not NULL */
    bool                  streams;         /* it has streams */
    const WoodsRecord    *woods;           /* NULL: no plants */
    const Materials      *materials;       /* of the material planes; NULL: not given */
} RunRecord;

/* The complete file, atomically. */
Status record_write_run(const char *path, const RunRecord *record);

#endif
