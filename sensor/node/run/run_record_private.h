/* sensor/node/run/run_record_private.h: what run.json is made from: run_record.c, its counters:
 * run_counters.c, what stands in the world: run_scenery.c. */
#ifndef SENSOR_NODE_RUN_RUN_RECORD_PRIVATE_H
#define SENSOR_NODE_RUN_RUN_RECORD_PRIVATE_H

#include "sensor/frame/field.h"
#include "sensor/node/run/host_run_private.h"

/* Wall times of a stage over the listed frames. */
typedef struct StageTimes {
    double median_ms, p95_ms, max_ms;
} StageTimes;

typedef struct RunRecord {
    const Run    *run;
    const RunEnd *end;
    const char   *memory; /* name of the ring of frames; NULL: none */
    StageTimes    stage[session_stages];
    bool          has_scenery; /* terrain.buildings, terrain.trees or terrain.clutter are on */
    SceneryCounts scenery;
} RunRecord;

extern const FieldTable run_counter_fields;
extern const FieldTable run_scenery_fields;             /* run_scenery.c */
const void             *run_scenery_of(const void *of); /* of a RunRecord; NULL: there is none */
void                    run_count_scenery(RunRecord *record);

static inline const Config *run_config_of(const RunRecord *r) { return &r->run->options.config; }
static inline const void   *run_of_record(const void *of) { return ((const RunRecord *)of)->run; }
static inline const void   *run_result_of(const void *of) { return ((const RunRecord *)of)->end->result; }

#endif
