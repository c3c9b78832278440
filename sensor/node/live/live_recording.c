/* sensor/node/live/live_recording.c: a recorder behind a lock: the receiving thread adds, the node flushes. */
#include "sensor/node/live/live_recording.h"

#include "dis/capture/recorder.h"

#include <pthread.h>
#include <stdlib.h>

struct LiveRecording {
    DisUdp         *udp;
    uint8_t         to[16]; /* of the exercise's datagrams */
    int             port;
    pthread_mutex_t lock; /* protects the following */
    DisRecorder    *recorder;
    uint64_t        failed;
    int64_t         first_ns;
};

static void add(void *user, const DisArrival *a)
{
    LiveRecording *r = user;
    pthread_mutex_lock(&r->lock);
    if (r->first_ns == INT64_MAX) r->first_ns = a->capture_ns;
    r->failed += dis_recorder_add(r->recorder, a->capture_ns, a->from, a->from_port, a->bytes, a->octets) != STATUS_OK;
    pthread_mutex_unlock(&r->lock);
}

Status live_recording_open(LiveRecording **out, const char *path, const char *comment, DisUdp *udp, int port)
{
    LiveRecording *r = calloc(1, sizeof *r);
    if (!r) return STATUS_NO_MEMORY;
    r->first_ns = INT64_MAX;
    const Status status = dis_recorder_open(&r->recorder, path, comment);
    if (status != STATUS_OK) {
        free(r);
        return status;
    }
    dis_udp_destination(r->to, udp);
    r->port = port;
    dis_recorder_to(r->recorder, r->to, (uint16_t)port);
    pthread_mutex_init(&r->lock, NULL);
    r->udp = udp;
    dis_udp_tap(udp, add, r);
    *out = r;
    return STATUS_OK;
}

void live_recording_add(LiveRecording *r, int64_t unix_ns, const uint8_t from[16], uint16_t from_port, int port,
                        const uint8_t *bytes, size_t octets)
{
    if (!r) return;
    pthread_mutex_lock(&r->lock);
    dis_recorder_to(r->recorder, from, (uint16_t)port); /* of its family: where this machine has it is not known */
    r->failed += dis_recorder_add(r->recorder, unix_ns, from, from_port, bytes, octets) != STATUS_OK;
    dis_recorder_to(r->recorder, r->to, (uint16_t)r->port);
    pthread_mutex_unlock(&r->lock);
}

Status live_recording_note(LiveRecording *r, int64_t unix_ns, const char *text)
{
    if (!r) return STATUS_OK;
    pthread_mutex_lock(&r->lock);
    const Status status = dis_recorder_note(r->recorder, unix_ns, text);
    pthread_mutex_unlock(&r->lock);
    return status;
}

void live_recording_flush(LiveRecording *r)
{
    if (!r) return;
    pthread_mutex_lock(&r->lock);
    dis_recorder_flush(r->recorder);
    pthread_mutex_unlock(&r->lock);
}

int64_t live_recording_first_ns(LiveRecording *r)
{
    pthread_mutex_lock(&r->lock);
    const int64_t first_ns = r->first_ns;
    pthread_mutex_unlock(&r->lock);
    return first_ns;
}

uint64_t live_recording_failed(LiveRecording *r)
{
    if (!r) return 0;
    pthread_mutex_lock(&r->lock);
    const uint64_t failed = r->failed;
    pthread_mutex_unlock(&r->lock);
    return failed;
}

Status live_recording_close(LiveRecording *r)
{
    if (!r) return STATUS_OK;
    dis_udp_tap(r->udp, NULL, NULL);
    const Status status = dis_recorder_close(r->recorder);
    pthread_mutex_destroy(&r->lock);
    free(r);
    return status;
}
