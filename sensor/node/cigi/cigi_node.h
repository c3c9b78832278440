/* sensor/node/cigi/cigi_node.h: the CIGI host of a node: what it says, frame after frame, and what it is answered. */
#ifndef SENSOR_NODE_CIGI_CIGI_NODE_H
#define SENSOR_NODE_CIGI_CIGI_NODE_H

#include "dis/cigi/cigi_link.h"
#include "dis/cigi/cigi_session.h"
#include "sensor/node/cigi/cigi_answer.h"
#include "sensor/node/cigi/cigi_drawn.h"
#include "sensor/node/cigi/cigi_recorded.h"
#include "sensor/settings/config.h"

/* Where the eye was at a frame of the host. */
typedef struct CigiFix {
    double t_s; /* exercise time */
    double p_ecef[3], r_ecef_from_view[9];
    bool   rated; /* whether the host says the following */
    double v_ecef_mps[3], w_ecef_rps[3];
} CigiFix;

enum { cigi_requests_most = 64 };

/* A request that is answered again every so many frames. */
typedef struct CigiStanding {
    CigiPacket request;
    int        period, left; /* frames; left: until the next answer */
} CigiStanding;

/* Where a live node's recording takes what the host says. */
typedef struct CigiTap {
    void (*datagram)(void *user, const uint8_t from[16], uint16_t port, const uint8_t *octets, size_t count);
    void (*note)(void *user, const char *text);
    void *user;
} CigiTap;

typedef struct CigiNode {
    CigiLink     *link;
    CigiRecorded *recorded; /* in place of a link: the host of a recording; NULL: none */
    bool          over;     /* it says no more */
    CigiTap       tap;      /* datagram NULL: there is no recording */
    uint64_t      received; /* datagrams of the host */
    int           port;     /* to which they go */
    CigiSession   session;
    CigiScene     scene;
    CigiDrawn     drawn;
    uint16_t      view;
    double        hfov_deg; /* the sensor's */
    double        asked_s;  /* wall_clock_s of the first Start of Frame; 0: not yet */
    CigiFix       fix[2];   /* of the frame that is due, and of the one before; [fixes] */
    int           fixes;
    CigiPacket    request[cigi_requests_most]; /* not answered yet; [requests] */
    int           requests;
    CigiStanding  standing[cigi_requests_most]; /* [standing_count] */
    int           standing_count;
    uint64_t      requests_lost;                         /* beyond these capacities */
    bool          other_fov, unseen, unheard, unstamped; /* said once */
} CigiNode;

/* Opens exercise.cigi; Start of Frame is sent from the first cigi_node_wait on. log: the recording that is replayed,
 * for `recorded`; NULL: a live node, which has none. */
Status cigi_node_open(CigiNode **out, const Config *config, const char *log);
/* Says what was counted. Accepts NULL. */
void cigi_node_close(CigiNode *node);

/* Sends what is due and waits at most wait_s for a datagram of the host. CIGI_DUE: a frame is to be made. What needs no
 * picture is answered at once. CIGI_REFUSED: there is nothing. */
CigiEvent cigi_node_wait(CigiNode *node, const CigiGround *ground, double wait_s);
/* Notes where the eye is at the frame that is due. False: the host has not said it. */
bool cigi_node_fix(CigiNode *node, double t_s);
/* Of a recorded host: exercise time less the host's at the datagram received last. Else that time is noted in the
 * recording, if there is one: the live node has chosen it. */
double cigi_node_offset_s(const CigiNode *node);
void   cigi_node_note_offset(const CigiNode *node, double offset_s);
/* The frame that is due is delivered, or is none: answers requests, and sends Start of Frame. */
void cigi_node_delivered(CigiNode *node, const CigiGround *ground);

#endif
