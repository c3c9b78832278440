/* sensor/publish/patience.h: a place that takes no files while a live node goes on: said once, tried again now and
 * then. */
#ifndef SENSOR_NODE_PATIENCE_H
#define SENSOR_NODE_PATIENCE_H

#include "pitviper.h"

typedef struct Patience {
    const char *what;   /* `picture files`, as messages name it */
    double      off_s;  /* wall clock: not before */
    bool        failed; /* the last try */
    int         lacking; /* how often it was not there */
} Patience;

static const double patience_s = 10;

/* Whether to try now. What is tried again in this thread says nothing of its own: patience_over says how it went. */
static inline bool patience_due(const Patience *p)
{
    const bool due = wall_clock_s() >= p->off_s;
    if (due && p->failed) log_hush(true);
    return due;
}

/* After a try, with its status; after none, with STATUS_IO. */
static inline void patience_over(Patience *p, bool tried, Status status)
{
    if (tried) log_hush(false);
    if (status == STATUS_OK) {
        if (p->failed) log_info("session: %s again; %d frames lack them", p->what, p->lacking);
        p->failed = false;
        return;
    }
    p->lacking++;
    if (!tried) return;
    if (!p->failed) log_warn("session: going on without %s; trying again every %.0f s", p->what, patience_s);
    p->failed = true;
    p->off_s  = wall_clock_s() + patience_s;
}

#endif
