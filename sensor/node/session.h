/* sensor/node/session.h: one host's seeker through a log: frame after frame, rendered and published. */
#ifndef SENSOR_NODE_SESSION_H
#define SENSOR_NODE_SESSION_H

#include "entities/entity_table.h"
#include "render/render.h"
#include "sensor/node/choices.h"
#include "sensor/node/sensors.h"
#include "sensor/publish/plane_hash.h"

/* What all hosts of one run share. */
typedef struct SessionShared {
    const Config  *config;
    const DisLog  *log;
    const Survey  *survey;
    const Catalog *catalog;
    World         *world;
    Pool          *pool;
    double         unix_s;    /* Unix time of exercise time 0 */
    unsigned       bands;
    int            exercise;  /* identifier; -1: all */
    bool           png, no_skip;
    bool           clamp;     /* land vehicles are set onto the world's ground */
    double         speed;     /* exercise seconds a second; INFINITY: as fast as it goes */
    const char    *config_sha256;
    const Sensors *sensors;
} SessionShared;

enum { session_stages = 6 };
extern const char *const session_stage_name[session_stages];

typedef struct SessionResult {
    int     frames;
    int     buried;                   /* frames whose eye was below the ground */
    char  (*hash)[sha256_text_size];  /* [frames] */
    double (*stage_ms)[session_stages]; /* [frames] */
    RenderCounters counters;
    EntityCounters entities;
    EffectCounters effects;
} SessionResult;

/* Renders the plan into `out` (frames, profiles, truth.jsonl). Progress on stderr when it is a terminal.
 * The result is the caller's to free with session_result_free, also after a failure. */
Status session_run(SessionResult *result, const SessionShared *shared, const HostPlan *plan, const char *out);
void   session_result_free(SessionResult *result);

#endif
