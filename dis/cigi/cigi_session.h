/* dis/cigi/cigi_session.h: one CIGI host in step with this image generator: datagrams in, events out, and what is to
 * be sent next. Pure: no socket, no clock; every time is an argument.
 *
 * Synchronous operation. Start of Frame is the heartbeat. The host answers Start of Frame k with one datagram, whose IG
 * Control has the number and the time of its frame; that frame is made, and Start of Frame k + 1, with the answers to
 * what was requested, says that it is delivered:
 *
 *     Start of Frame k  ->  host: IG Control n, time t_n, entities, views  ->  frame at t_n  ->  Start of Frame k + 1
 *
 * Neither goes on before the other, so both keep the host's pace, however fast or slow. Where a datagram is lost,
 * Start of Frame is sent again with the same number. Memory does not grow. */
#ifndef DIS_CIGI_CIGI_SESSION_H
#define DIS_CIGI_CIGI_SESSION_H

#include "dis/cigi/cigi_datagram.h"

enum { cigi_datagram_octets = 1472 }; /* what Ethernet carries unfragmented over UDP and IPv4 */

typedef struct CigiSessionConfig {
    double repeat_s; /* Start of Frame is sent again after so long without an answer; > 0 */
    double silent_s; /* a host that is silent for so long has stopped; > 0 */
    /* A frame further after the last one with a time has no picture, unless the host was in mode Reset/Standby between:
     * a stamp that is wrong by hours is not to be lived through. > 0 */
    double ahead_s;
    /* From frame to frame of a host whose time stamps are not valid; 0: its frames have no picture. */
    double unstamped_ticks;
} CigiSessionConfig;

/* A quarter of a second, five seconds, ten minutes, refused. */
CigiSessionConfig cigi_session_default_config(void);

/* What a datagram of the host means. */
typedef enum CigiEvent {
    CIGI_REFUSED,  /* it is none of CIGI 3; counted by reason */
    CIGI_OLD,      /* a frame of the host from before the present one: nothing of it is used */
    CIGI_REPEATED, /* the same frame again: nothing of it is used; once that is delivered, its Start of Frame is sent
                      again */
    CIGI_EXTRA,    /* a further frame that answers no new Start of Frame: its packets are used, no frame is made */
    CIGI_IDLE,     /* the host's frame is one without a picture: mode Reset/Standby, or no valid time; answered by
                      cigi_session_delivered all the same */
    CIGI_DUE,      /* the frame at cigi_session_time_s is to be made; cigi_session_delivered when it is */
} CigiEvent;

/* What else is new with it, a set. */
enum {
    CIGI_NEWS_FIRST = 1,       /* the first answer of all */
    CIGI_NEWS_MODE = 2,        /* another mode than before */
    CIGI_NEWS_LOST = 4,        /* frames of the host between the last and this one did not arrive */
    CIGI_NEWS_RESTARTED = 8,   /* the host began anew: its frames are counted, and its time is taken, from here */
    CIGI_NEWS_BACK = 16,       /* it was silent, and is heard again */
    CIGI_NEWS_TIME_BACK = 32,  /* its time went back: the frame is not made */
    CIGI_NEWS_TIME_AHEAD = 64, /* its time went ahead by more than ahead_s: the frame is not made */
    CIGI_NEWS_UNSTAMPED = 128, /* its time stamp is not valid */
};

typedef struct CigiSessionCounters {
    uint64_t frames;               /* made: CIGI_DUE */
    uint64_t idle;                 /* answered without a picture */
    uint64_t repeats;              /* Start of Frame sent again */
    uint64_t repeated, old, extra; /* datagrams of these events */
    uint64_t lost;                 /* numbers of host frames that did not arrive */
    uint64_t restarts, silences;
    uint64_t unstamped;  /* frames without a valid time */
    uint64_t time_back;  /* frames whose time was before the last one's */
    uint64_t time_ahead; /* frames whose time was further after the last one's than ahead_s */
    uint64_t unanswered; /* answers to requests that did not fit into a datagram */
} CigiSessionCounters;

/* Of one host. Members are the session's own; read them through the functions below. */
typedef struct CigiSession {
    CigiSessionConfig   config;
    CigiCounters        counters;
    CigiSessionCounters events;
    CigiReader          reader;                      /* of the datagram last received */
    bool                reads;                       /* its packets are to be used */
    bool                heard, timed, silent, waits; /* waits: Start of Frame is sent, and not answered yet */
    bool                to_send;
    bool                rested; /* in mode Reset/Standby since the last frame with a time */
    uint8_t             mode, status;
    uint32_t            host_frame, ig_frame, stamp;
    int64_t             ticks; /* of the last frame with a time, unwrapped */
    double              sent_s, heard_s;
    unsigned            news;
    uint8_t             out[cigi_datagram_octets]; /* Start of Frame and answers */
    size_t              out_octets;
    uint8_t             answer[cigi_datagram_octets]; /* for the next Start of Frame */
    size_t              answer_octets;
} CigiSession;

/* Begins with Start of Frame 1, in mode Reset/Standby. */
void cigi_session_begin(CigiSession *session, const CigiSessionConfig *config, double now_s);

/* A datagram from the host. now_s: monotonic, as that of the other functions. The octets are the caller's, and stay
 * until the last cigi_session_packet. */
CigiEvent cigi_session_receive(CigiSession *session, const uint8_t *datagram, size_t octets, double now_s);
/* CIGI_NEWS_* of the datagram last received. */
unsigned cigi_session_news(const CigiSession *session);
/* The next packet behind IG Control of the datagram last received; none of those that are not used. */
bool cigi_session_packet(CigiPacket *out, CigiSession *session);

/* Exercise time of the frame that is due or was last: the host's time stamp, s, which goes on where its 32 bits, 11.9
 * h, begin again; the first, and that after a restart, is as it is sent. */
double  cigi_session_time_s(const CigiSession *session);
uint8_t cigi_session_mode(const CigiSession *session);

/* An answer to a request, into the next Start of Frame's datagram; its host frame bits are filled in. False: there is
 * no room left; counted. */
bool cigi_session_answer(CigiSession *session, const CigiPacket *response);
/* The frame of CIGI_DUE or CIGI_IDLE is done: makes the next Start of Frame. */
void cigi_session_delivered(CigiSession *session, double now_s);

/* Looks at the time: Start of Frame again, where it was not answered. True once when the host becomes silent. */
bool cigi_session_look(CigiSession *session, double now_s);
/* What is to be sent to the host now, once; false: nothing. */
bool cigi_session_send(const uint8_t **datagram, size_t *octets, CigiSession *session);

/* Ticks of 32 bits that wrap, by the last ones unwrapped: the nearest to these. */
int64_t cigi_unwrap(int64_t last_ticks, uint32_t stamp);

#endif
