/* sensor/node/session_private.h: one host's seeker between frames. */
#ifndef SENSOR_NODE_SESSION_PRIVATE_H
#define SENSOR_NODE_SESSION_PRIVATE_H

#include "sensor/node/frame_files.h"
#include "sensor/node/frame_light.h"
#include "sensor/node/frame_writer.h"
#include "sensor/node/mount.h"
#include "sensor/node/pairs.h"
#include "sensor/node/patience.h"
#include "sensor/node/player.h"
#include "sensor/node/seeker.h"
#include "sensor/node/session.h"
#include "sensor/publish/coco.h"

struct Session {
    const SessionShared *shared;
    HostPlan             plan;          /* host and aim are filled in when they are heard of */
    char                 out[4096];
    char                 host_text[dis_id_text_size];
    EntityTable         *table;
    Player              *player;        /* the caller's */
    FILE                *truth;
    Seeker               seeker;
    Arena               *frame_arena;
    int64_t              tick;          /* next gimbal tick */
    double               p_aim_ecef[3]; /* last known */
    bool                 aim_known;
    Mount                mount;
    int                  mount_model, mount_node; /* the model whose node that is; -1: none yet */
    NodePose            *node;          /* of the host, [most nodes of a model]; joint: the same */
    double              *joint;
    bool                 limit_said;    /* what was last said of the gimbal's limit, and at which tick */
    int64_t              limit_tick;
    uint64_t             given_up_said; /* what was last said of a full table, and when; wall clock */
    double               given_up_said_s, left_out_said_s;
    Chain               *chain[BAND_COUNT]; /* of the bands with a sensor of etc/sensors.csv */
    FrameLevel           level[BAND_COUNT];
    FrameWriter         *writer;        /* of a live node with files; else they are written in the loop */
    Patience             truth_patience; /* live: with truth.jsonl */
    Pairs               *pairs;         /* NULL: not asked for */
    Coco                *coco;
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

#endif
