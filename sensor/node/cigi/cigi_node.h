/* sensor/node/cigi/cigi_node.h: the CIGI host of a node: what it says, frame after frame, and what it is answered. */
#ifndef SENSOR_NODE_CIGI_CIGI_NODE_H
#define SENSOR_NODE_CIGI_CIGI_NODE_H

#include "dis/cigi/cigi_link.h"
#include "dis/cigi/cigi_session.h"
#include "sensor/node/cigi/cigi_answer.h"
#include "sensor/node/cigi/cigi_drawn.h"
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

typedef struct CigiNode {
    CigiLink    *link;
    CigiSession  session;
    CigiScene    scene;
    CigiDrawn    drawn;
    uint16_t     view;
    double       hfov_deg; /* the sensor's */
    double       asked_s;  /* wall_clock_s of the first Start of Frame; 0: not yet */
    CigiFix      fix[2];   /* of the frame that is due, and of the one before; [fixes] */
    int          fixes;
    CigiPacket   request[cigi_requests_most]; /* not answered yet; [requests] */
    int          requests;
    CigiStanding standing[cigi_requests_most]; /* [standing_count] */
    int          standing_count;
    uint64_t     requests_lost;              /* beyond these capacities */
    bool         other_fov, unseen, unheard; /* said once */
} CigiNode;

/* Opens exercise.cigi; Start of Frame is sent from the first cigi_node_wait on. */
Status cigi_node_open(CigiNode **out, const Config *config);
/* Says what was counted. Accepts NULL. */
void cigi_node_close(CigiNode *node);

/* Sends what is due and waits at most wait_s for a datagram of the host. CIGI_DUE: a frame is to be made. What needs no
 * picture is answered at once. CIGI_REFUSED: there is nothing. */
CigiEvent cigi_node_wait(CigiNode *node, const CigiGround *ground, double wait_s);
/* Notes where the eye is at the frame that is due. False: the host has not said it. */
bool cigi_node_fix(CigiNode *node, double t_s);
/* The frame that is due is delivered, or is none: answers requests, and sends Start of Frame. */
void cigi_node_delivered(CigiNode *node, const CigiGround *ground);

#endif
