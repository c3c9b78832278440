/* sensor/publish/retry_backoff.h: retries a destination that cannot be written while a live node continues: reported
 * once, retried at intervals. */
#ifndef SENSOR_PUBLISH_RETRY_BACKOFF_H
#define SENSOR_PUBLISH_RETRY_BACKOFF_H

#include "pitviper.h"

typedef struct RetryBackoff {
    const char *what;   /* the products, as messages name them */
    double      off_s;  /* wall clock: no retry before */
    bool        failed; /* the last try */
    int         lacking; /* number of failures */
} RetryBackoff;

static const double retry_interval_s = 10;

/* Whether to try now. During a retry the messages of this thread are suppressed: retry_done reports the result. */
static inline bool retry_due(const RetryBackoff *p)
{
    const bool due = wall_clock_s() >= p->off_s;
    if (due && p->failed) log_suppress(true);
    return due;
}

/* After a try, with its status; after none, with STATUS_IO. */
static inline void retry_done(RetryBackoff *p, bool tried, Status status)
{
    if (tried) log_suppress(false);
    if (status == STATUS_OK) {
        if (p->failed) log_info("session: %s again; %d frames lack them", p->what, p->lacking);
        p->failed = false;
        return;
    }
    p->lacking++;
    if (!tried) return;
    if (!p->failed) log_warn("session: going on without %s; trying again every %.0f s", p->what, retry_interval_s);
    p->failed = true;
    p->off_s  = wall_clock_s() + retry_interval_s;
}

/* At the end of the run: what it lacks, if that has not been said yet. */
static inline void retry_end(const RetryBackoff *p)
{
    if (p->failed) log_warn("session: %d frames lack %s", p->lacking, p->what);
}

#endif
