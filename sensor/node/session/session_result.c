/* sensor/node/session/session_result.c: what a session says of its frames: hosts, lists, counts. */
#include "sensor/node/session/session_private.h"

#include <stdlib.h>

const char *const session_stage_name[session_stages] = {"frame", "snapshot", "visibility", "shade", "radar", "publish"};

static Status room_in_lists(SessionResult *r, int *capacity)
{
    if (r->listed < *capacity) return STATUS_OK;
    const int larger = *capacity ? 2 * *capacity : 1024;
    int(*numbers) = realloc(r->number, (size_t)larger * sizeof *numbers);
    if (numbers) r->number = numbers;
    char(*hash)[sha256_text_size] = realloc(r->hash, (size_t)larger * sizeof *hash);
    if (hash) r->hash = hash;
    double(*stage_ms)[session_stages] = realloc(r->stage_ms, (size_t)larger * sizeof *stage_ms);
    if (stage_ms) r->stage_ms = stage_ms;
    if (!numbers || !hash || !stage_ms) return STATUS_NO_MEMORY;
    *capacity = larger;
    return STATUS_OK;
}

void session_list_frame(void *user, const Frame *f)
{
    Session           *s = user;
    SessionResult     *r = &s->result;
    const Provenance  *p = &f->provenance;
    const RenderTimes *times = &f->seen.picture.times;
    const double       share = 1.0 / pool_threads(s->shared->pool); /* of a sum over threads: as if evenly spread */
    const double       publish_s = wall_clock_s() - f->publish_begun_s;
    const double       ms[session_stages] = {1e3 * (p->rendered_s - p->begun_s + publish_s),
                                             1e3 * (p->posed_s - p->begun_s),
                                             times->prepare_ms + share * (times->visibility_ms + times->shadow_ms),
                                             share * times->shade_ms,
                                             share * times->radar_ms,
                                             1e3 * publish_s};
    s->published++;
    r->at_limit += f->record.gimbal_at_limit;
    r->buried += f->buried;
    render_counters_add(&r->counters, &f->seen.picture.counters);
    if (r->listed == session_frames_kept || s->listed != STATUS_OK) return;
    s->listed = room_in_lists(r, &s->capacity);
    if (s->listed != STATUS_OK) return;
    r->number[r->listed] = f->number;
    memcpy(r->hash[r->listed], f->seen.sha256, sizeof f->seen.sha256);
    memcpy(r->stage_ms[r->listed], ms, sizeof ms);
    r->listed++;
}

void session_result_free(SessionResult *result)
{
    free(result->number);
    free(result->hash);
    free(result->stage_ms);
    memset(result, 0, sizeof *result);
}
