/* sensor/node/session.h: one host's seeker through what is heard: frame after frame, rendered and published. */
#ifndef SENSOR_NODE_SESSION_H
#define SENSOR_NODE_SESSION_H

#include "entities/table/entity_table.h"
#include "render/frame/render.h"
#include "sensor/node/choices.h"
#include "sensor/node/player.h"
#include "sensor/settings/sensors.h"
#include "sensor/publish/plane_hash.h"
#include "sensor/publish/records.h"

/* What all hosts of one run share. */
typedef struct SessionShared {
    const Config  *config;
    const Survey  *survey;
    const Catalog *catalog;
    World         *world;
    Pool          *pool;
    double         unix_s;    /* Unix time of exercise time 0 */
    unsigned       bands;
    bool           no_skip;
    GroundContact  contact;   /* which entities are set onto the world's ground */
    bool           live;      /* a file that cannot be written does not end it */
    const char    *config_sha256;
    const Sensors *sensors;
    void         (*publish)(void *user, const FrameRecord *frame); /* every frame made; NULL: nobody asks */
    void          *user;
    int            save_count; /* frames that are also written as frame files, ascending */
    const int     *save;       /* [save_count] */
} SessionShared;

enum { session_stages = 6, session_frames_kept = 1000000, session_hosts_kept = 64 };
extern const char *const session_stage_name[session_stages];

/* Lists hold the first session_frames_kept frames; a live node may make more. */
typedef struct SessionResult {
    int     frames;
    int     listed;
    int     buried;                   /* frames whose eye was below the ground */
    int     at_limit;                 /* frames whose aim was beyond the gimbal */
    int     frames_crowded, most_left_out; /* frames without all entities; the most that one of them lacks */
    int     host_count;               /* the first session_hosts_kept that carried the sensor, in order */
    char    host[session_hosts_kept][dis_id_text_size];
    int     files_failed, files_left_out; /* live: frames without files, for want of a disk, of time; when closed */
    int   (*number);                  /* [listed] */
    char  (*hash)[sha256_text_size];  /* [listed] */
    double (*stage_ms)[session_stages]; /* [listed] */
    RenderCounters counters;
    EntityCounters entities;
    EffectCounters effects;
    uint64_t    shots_forgotten, munitions_forgotten; /* player_forgotten */
} SessionResult;

typedef struct Session Session;

/* Prepares the folder `out` (frames, profiles, truth.jsonl). The player and shared must outlive the session. */
Status session_open(Session **out, const SessionShared *shared, const HostPlan *plan, Player *player,
                    const char *folder);
/* Everything up to t_s, then the frame. t_s must not decrease. shown: false when the host is not there. */
Status session_frame(bool *shown, Session *session, int number, double t_s);
/* So far. */
const SessionResult *session_result(const Session *session);
int         session_entities(const Session *session); /* how many are there */
uint64_t    session_over_rate(const Session *session); /* reports of new ones that came too fast: entities.new_per_s */
const char *session_host(const Session *session); /* id as text, `observer`, or `munition` that is still to come */
/* The session's result is the caller's to free with session_result_free; NULL: it goes too. */
Status session_close(Session *session, SessionResult *result);
void   session_result_free(SessionResult *result);

#endif
