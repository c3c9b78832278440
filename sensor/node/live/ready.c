/* sensor/node/live/ready.c: says when a live node is ready. */
#include "sensor/node/live/ready.h"

static const double again_s = 10;

static void say(Ready *r, const SessionReady *now, double now_s)
{
    const int models = now->models - r->said.models, signatures = now->signatures - r->said.signatures;
    if (r->said_s > 0 && (now_s - r->said_s < again_s || (models == 0 && signatures == 0))) return;
    if (r->said_s > 0)
        log_info("run: ready again: %d more models, %d signatures, in %.1f s", models, signatures, now_s - r->since_s);
    else
        log_info("run: ready: %d models, %d signatures, %.1f s after the first entity", models, signatures,
                 now_s - r->heard_s);
    r->said = *now;
    r->said_s = now_s;
}

void ready_check(Ready *r, const SessionReady *now, double now_s)
{
    if (now->entities == 0) return;
    const bool is = now->waiting == 0;
    if (!is && r->is) r->since_s = now_s;
    if (is && r->first_s <= 0) r->first_s = now_s - r->heard_s;
    if (is) say(r, now, now_s);
    r->is = is;
}
