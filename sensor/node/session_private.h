/* sensor/node/session_private.h: one host's seeker between frames. */
#ifndef SENSOR_NODE_SESSION_PRIVATE_H
#define SENSOR_NODE_SESSION_PRIVATE_H

#include "sensor/world/frame_light.h"
#include "sensor/node/mount.h"
#include "sensor/node/player.h"
#include "sensor/node/seeker.h"
#include "sensor/node/session.h"
#include "sensor/publish/consumers.h"
#include "sensor/publish/frame_queue.h"

struct Session {
    const SessionShared *shared;
    HostPlan             plan;          /* host and aim are filled in when they are heard of */
    char                 out[4096];
    char                 host_text[dis_id_text_size];
    EntityTable         *table;
    Player              *player;        /* the caller's */
    Seeker               seeker;
    int64_t              tick;          /* next gimbal tick */
    double               p_aim_ecef[3]; /* last known */
    bool                 aim_known;
    Mount                mount;
    int                  mount_model, mount_node; /* the model whose node that is; -1: none yet */
    NodePose            *node;          /* of the host, [most nodes of a model]; joint: the same */
    double              *joint;
    bool                 limit_reported;    /* what was last said of the gimbal's limit, and at which tick */
    int64_t              limit_tick;
    uint64_t             given_up_reported; /* what was last said of a full table, and when; wall clock */
    double               given_up_reported_s, left_out_reported_s;
    Chain               *chain[BAND_COUNT]; /* of the bands with a sensor of etc/sensors.csv: what noise targets have */
    Consumers            consumers;
    unsigned             wants;         /* of all consumers */
    FramePool           *frames;
    Pool                *publish_pool;  /* of the publishing thread; NULL: publishing is done in this one */
    FrameLevel           level[BAND_COUNT]; /* of the picture files: the publishing thread's */
    QueueCounters        written;       /* live: picture files; when closed */
    int                  lines_failed;  /* live: lines of truth.jsonl; when closed */
    int                  published;     /* frames that all consumers have had: the publishing thread's */
    Status               listed;        /* of the result's lists: the publishing thread's */
    SessionResult        result;
    int                  capacity;      /* of the result's lists */
};

typedef struct Eye {
    EyeState state;
    View     view;
    double   r_ecef_from_body[9];
    int      hidden; /* snapshot index of the host; -1 */
    bool     at_limit, aim_known;
    double   p_aim_ecef[3];
    double   w_cam_rps[3]; /* how the camera turns, in its own axes */
} Eye;

/* The present host into the result's list, once. */
void session_note_host(Session *s);
/* Feeds what counts by t_s, finds host and aim, and turns the gimbal, on a fixed grid of exercise time. */
void session_advance(Session *s, double t_s);
/* Tells the table what a full one is to keep: host and aim, and what is near the host, else near the aim. */
void session_keep(Session *s);
/* False: there will be no picture. */
bool session_host_is_there(const Session *s);
/* Where the eye is at t_s and where it looks. The host's pose goes into the snapshot as it is seen from. False: the
 * host is not there. */
bool session_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s);
/* Who gets this session's frames, from the configuration; and room for as many frames as that takes. done: each frame
 * that all have had. */
Status session_consumers(Session *s, FrameDone *done);

#endif
