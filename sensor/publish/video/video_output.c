/* sensor/publish/video/video_output.c: one destination of an encoded video: a stream or a file. */
#include "sensor/publish/video/video_output.h"

static bool to_network(void *user, const uint8_t *bytes, size_t count)
{
    udp_video_send(user, bytes, count);
    return true;
}

static bool to_file(void *user, const uint8_t *bytes, size_t count) { return video_file_write(user, bytes, count); }
static bool seek_file(void *user, int64_t position) { return video_file_seek(user, position); }

static bool is_due(const VideoOutput *o) { return o->udp || !o->patient || wall_clock_s() >= o->retry.off_s; }

bool video_output_needs_key(const VideoOutput *o) { return (o->needs_key || !o->transport) && is_due(o); }

static void drop(VideoOutput *o)
{
    transport_close(o->transport, false);
    o->transport = NULL;
    if (o->file) video_file_close(o->file);
    o->file = NULL;
}

static Status open_output(VideoOutput *o, const Encoder *encoder)
{
    TransportConfig config = {.container = o->kind, .klv = o->klv, .title = o->title,
                              .sink = {to_network, NULL, o->udp}};
    Status          status = STATUS_OK;
    if (!o->udp) {
        status      = video_file_open(&o->file, o->path);
        config.sink = (TransportSink){to_file, o->kind == VIDEO_TS ? NULL : seek_file, o->file};
    }
    if (status == STATUS_OK) status = transport_open(&o->transport, &config, encoder);
    if (status == STATUS_IO && o->file) log_error("video: cannot write %s: %s", o->path, video_file_error(o->file));
    if (status == STATUS_OK && o->file) video_file_mark(o->file);
    if (status != STATUS_OK) drop(o);
    return status;
}

static Status put(VideoOutput *o, const Encoder *encoder, const VideoPacket *packet, int64_t pts_90k,
                  const uint8_t *klv, size_t klv_count)
{
    if (!packet->key && (o->needs_key || !o->transport)) return STATUS_IO;
    Status status = o->transport ? STATUS_OK : open_output(o, encoder);
    if (status != STATUS_OK) return status;
    status = transport_put(o->transport, packet, pts_90k, klv, klv_count);
    /* after a failure: whether the disk takes it is known at once */
    if (status == STATUS_OK && o->file && o->needs_key) status = transport_flush(o->transport);
    if (o->file && !video_file_mark(o->file)) status = STATUS_IO;
    o->needs_key = status != STATUS_OK;
    if (status != STATUS_OK && o->file) {
        log_error("video: cannot write %s: %s", o->path, video_file_error(o->file));
        transport_forget_positions(o->transport);
    }
    return status;
}

Status video_output_put(VideoOutput *o, const Encoder *encoder, const VideoPacket *packet, int64_t pts_90k,
                        const uint8_t *klv, size_t klv_count)
{
    if (o->udp) {
        put(o, encoder, packet, pts_90k, klv, klv_count);
        return STATUS_OK;
    }
    if (!o->patient) return put(o, encoder, packet, pts_90k, klv, klv_count);
    const bool   due    = retry_due(&o->retry);
    const Status status = due ? put(o, encoder, packet, pts_90k, klv, klv_count) : STATUS_IO;
    if (!due) o->needs_key = true; /* it lacks a frame */
    retry_done(&o->retry, due, status);
    return STATUS_OK;
}

Status video_output_close(VideoOutput *o)
{
    Status status = STATUS_OK;
    if (o->transport) {
        status       = transport_close(o->transport, true);
        o->transport = NULL;
    }
    if (o->file) {
        if (!video_file_mark(o->file) || status != STATUS_OK) {
            log_error("video: cannot write the end of %s: %s", o->path, video_file_error(o->file));
            status = STATUS_IO;
        }
        const Status closed = video_file_close(o->file);
        if (status == STATUS_OK) status = closed;
        o->file = NULL;
    }
    udp_video_close(o->udp, o->sent);
    o->udp = NULL;
    return o->patient ? STATUS_OK : status;
}
