/* sensor/node/session/session_private.h: the state of a session between frames. */
#ifndef SENSOR_NODE_SESSION_SESSION_PRIVATE_H
#define SENSOR_NODE_SESSION_SESSION_PRIVATE_H

#include "render/frame/world.h"
#include "sensor/frame/frame_world.h"
#include "sensor/node/session/seeker_private.h"
#include "sensor/node/player/player.h"
#include "sensor/node/session/session.h"
#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/klv/consume_klv.h"
#include "sensor/publish/memory/detections.h"
#include "sensor/instruments/camera.h"

/* Of entities; without a band that shows temperatures there are none. */
typedef struct SessionHeat {
    GivenHeat     *given;    /* NULL: none */
    KeptHeat      *kept;     /* of a run before; NULL: none */
    WorldVehicles *vehicles; /* NULL: parts are as warm as the air */
    Arena         *arena;    /* of the snapshot of a tick */
    uint64_t       changes;  /* entity_table_changes at the last */
} SessionHeat;

/* The last reports of a full table, and of entities that are not shown. */
typedef struct SessionCrowd {
    uint64_t given_up;
    double   given_up_s, left_out_s; /* wall clock */
} SessionCrowd;

struct Session {
    const SessionShared *shared;
    HostPlan             plan; /* host and aim are filled in when they are received */
    char                 out[4096];
    char                 host_text[dis_id_text_size];
    bool                 opened; /* everything is open */
    EntityTable         *table;
    Player              *player; /* the caller's */
    SessionHeat          heat;
    SessionCrowd         crowd;
    Status               advance_status; /* the first failure of what outlasts a frame: frames fail with it */
    Seeker               seeker;
    int64_t              tick;          /* next gimbal tick */
    double               p_aim_ecef[3]; /* last known */
    bool                 aim_known;
    Mount                mount;
    int                  mount_model, mount_at; /* mount_at: as seeker_mount_node, of that model; -1: none yet */
    NodePose            *node; /* poses and joint values of the host's nodes, [most nodes of a model] */
    double              *joint;
    bool                 limit_reported; /* last report of the gimbal limit, and its tick */
    int64_t              limit_tick;
    Instruments          instruments;
    RadarAbsent         *radar_absent; /* frames that had no radar when they were recorded; NULL: none */
    Consumers            consumers;
    unsigned             raw;        /* bands of whose raw counts there are files */
    Detections          *detections; /* received; NULL: none */
    Geoid                geoid;      /* for metadata; n_m NULL: none */
    unsigned             wants;      /* of all consumers */
    FramePool           *frames;
    Latency             *latency;           /* NULL: none is kept */
    double               fed_s;             /* of the last frame in it: player_fed_s */
    Pool                *publish_pool;      /* of the publishing thread; NULL: publishing is done in this one */
    int                  queues;            /* consumers in threads of their own */
    QueueCounters        written, streamed; /* by the clock: files, streams; when closed */
    int                  lines_failed;      /* live: lines of truth.jsonl; when closed */
    int                  published;         /* frames that all consumers have received: used by the publishing thread */
    Status               listed;            /* of the result's lists: used by the publishing thread */
    SessionResult        result;
    int                  capacity; /* of the result's lists */
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

/* Adds the present host to the result's list, once. */
void session_note_host(Session *s);
/* The first failure of what outlasts a frame; logged. */
void session_note_failure(Session *s, const char *what, Status status);
/* Lists a frame that all consumers have received; called in the publishing thread. */
void session_list_frame(void *session, const Frame *frame);
/* Reports entities that did not fit: at once, and then once a minute while there are more. */
void session_report_crowd(Session *s, int left_out);

Status session_heat_open(Session *s);
void   session_heat_warm(Session *s, double tick_s); /* at each tick */
void   session_heat_report(const Session *s);
Status session_heat_keep(const Session *s); /* for a later run, if there is a file to keep it in */
void   session_heat_close(Session *s);

/* Feeds everything that counts by t_s, finds host and aim, and moves the gimbal, on a fixed grid of exercise time. */
void session_advance(Session *s, double t_s);
/* Sets the entities that a full table keeps: host and aim, and those near the host, else near the aim. */
void session_keep(Session *s);
bool session_observes(const Session *s); /* an observer's eye: there is no host */
/* False: no image will be rendered. */
bool session_host_is_there(const Session *s);
/* Position and direction of the sensor at t_s. The host's pose is written into the snapshot; NULL: into none.
 * False: the host is absent. */
bool session_eye(Eye *eye, Session *s, Snapshot *snapshot, double t_s);
/* One frame, of all but what its consumers do. shown: false when the host is absent. left_out: entities that are not
 * in it. */
Status session_make_frame(bool *shown, int *left_out, Frame *f, Session *s, int number, double t_s);
/* Makes the folders and files of the products, once, in place of those of an earlier run. */
Status session_begin_files(Session *s);
/* The consumers of this session's frames, from the configuration; and a pool for as many frames as they need. done:
 * each frame that all consumers have received. */
Status session_consumers(Session *s, FrameDone *done);

#endif
