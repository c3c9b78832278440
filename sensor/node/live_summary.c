/* sensor/node/live_summary.c: the last lines of `pitviper run`: what it heard, made, kept and could not write. */
#include "sensor/node/live_summary.h"

#include <stdio.h>

void live_summary(const LiveCounters *c, const HealthSample *s, uint64_t own)
{
    static const double enough_share = 0.5; /* of the frames asked for: fewer are worth a warning */
    char                sent[80] = "";
    if (s->publishes)
        snprintf(sent, sizeof sent, "; PDUs sent %llu, not sent %llu", (unsigned long long)c->sent,
                 (unsigned long long)c->send_failed);
    const uint64_t frames = s->frames;
    log_info("run: %llu datagrams heard, %llu of them our own; lost %llu; frames made %llu, left out %llu%s",
             (unsigned long long)c->datagrams, (unsigned long long)own, (unsigned long long)(c->lost_kernel + c->lost_queue),
             (unsigned long long)frames, (unsigned long long)c->frames_late, sent);
    const double   share = live_kept_share(c, frames);
    if (frames > 0 && share < enough_share)
        log_warn("run: kept %.3g of %g frames a second, fewer than half: lower sensor.rate_hz (--rate), the size, or the "
                 "quality (quality.budget, sensor.samples), or render fewer bands", share * c->rate_hz, c->rate_hz);
    else if (frames > 0)
        log_info("run: kept %.3g of %g frames a second", share * c->rate_hz, c->rate_hz);
    if (c->files_failed || c->files_left_out)
        log_warn("run: frames without their files: %llu for want of time, %llu could not be written; --no-png or "
                 "--no-files leaves more time", (unsigned long long)c->files_left_out,
                 (unsigned long long)c->files_failed);
}
