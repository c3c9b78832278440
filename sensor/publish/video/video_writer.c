/* sensor/publish/video/video_writer.c: the thread that writes the file of a video, and the packets that wait for it.
 *
 * A disk that is late, or hangs, costs the file its frames: the encoder and the stream go on. What was left out leaves
 * a gap that ends with a key frame. */
#include "sensor/publish/video/video_output_private.h"

#include <stdlib.h>

enum { items = 32, octets_most = 32 << 20 }; /* waiting, whichever is reached first */

typedef struct Item {
    Encoder    *encoder;
    VideoPacket packet; /* bytes: of this item */
    uint8_t    *bytes;  /* [room]: those of the packet, then those of the metadata */
    size_t      room, klv_count;
    int64_t     pts_90k;
    Latency    *latency; /* NULL: none is kept */
    uint64_t    latency_key;
    double      rendered_s;
} Item;

struct VideoWriter {
    VideoOutput     *output; /* used by the thread alone */
    Item             item[items];
    int              first, count; /* the first may be on its way */
    size_t           octets;       /* of all that wait */
    bool             stop;
    bool             needs_key; /* nothing can be written before one */
    bool             gap;       /* a frame was left out since the last key frame */
    double           off_s;     /* wall clock: no key frame before, since the file is not tried before */
    int              left_out;
    Status           closed;
    _Atomic uint64_t steps;
    pthread_mutex_t  lock; /* of all but output and what an item on its way refers to */
    pthread_cond_t   work;
    pthread_t        thread;
};

/* With the lock held. */
static bool has_room(const VideoWriter *w, size_t octets)
{
    return w->count < items && (w->count == 0 || w->octets + octets <= octets_most);
}

static bool key_waits(const VideoWriter *w)
{
    for (int i = 0; i < w->count; i++)
        if (w->item[(w->first + i) % items].packet.key) return true;
    return false;
}

static void write_item(VideoWriter *w, const Item *i)
{
    const VideoUnit unit = {i->packet, i->pts_90k, i->bytes + i->packet.count, i->klv_count};
    video_output_put(w->output, i->encoder, &unit);
    video_encoder_close(i->encoder);
    if (i->latency) latency_done(i->latency, i->latency_key, i->rendered_s, video_file_name);
}

static void *work(void *user)
{
    VideoWriter *w = user;
    pthread_mutex_lock(&w->lock);
    for (;;) {
        while (w->count == 0 && !w->stop) pthread_cond_wait(&w->work, &w->lock);
        if (w->count == 0) break;
        const Item *i = &w->item[w->first];
        pthread_mutex_unlock(&w->lock);
        write_item(w, i);
        atomic_fetch_add(&w->steps, 1);
        pthread_mutex_lock(&w->lock);
        w->octets -= i->packet.count + i->klv_count;
        w->first = (w->first + 1) % items;
        w->count--;
        if (w->output->needs_key && !key_waits(w)) w->needs_key = true;
        w->off_s = w->output->retry.off_s;
    }
    pthread_mutex_unlock(&w->lock);
    w->closed = video_output_close(w->output);
    return NULL;
}

Status video_writer_open(VideoWriter **out, VideoOutput *output)
{
    VideoWriter *w = calloc(1, sizeof *w);
    if (!w) return STATUS_NO_MEMORY;
    w->output = output;
    w->needs_key = true;
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->work, NULL);
    if (publish_thread(&w->thread, work, w)) {
        *out = w;
        return STATUS_OK;
    }
    pthread_cond_destroy(&w->work);
    pthread_mutex_destroy(&w->lock);
    free(w);
    return STATUS_NO_MEMORY;
}

bool video_writer_needs_key(VideoWriter *w)
{
    pthread_mutex_lock(&w->lock);
    const bool needs = w->needs_key && has_room(w, 0) && wall_clock_s() >= w->off_s;
    pthread_mutex_unlock(&w->lock);
    return needs;
}

/* Copies what is to be written; the item is not in the list yet, and only one thread puts. */
static bool fill(Item *i, Encoder *encoder, const VideoUnit *unit, const Frame *frame)
{
    const size_t octets = unit->packet.count + unit->klv_count;
    if (octets > i->room) {
        uint8_t *larger = realloc(i->bytes, octets);
        if (!larger) return false;
        i->bytes = larger;
        i->room = octets;
    }
    memcpy(i->bytes, unit->packet.bytes, unit->packet.count);
    if (unit->klv_count) memcpy(i->bytes + unit->packet.count, unit->klv, unit->klv_count);
    video_encoder_hold(encoder);
    *i = (Item){.encoder = encoder,
                .packet = {i->bytes, unit->packet.count, unit->packet.key},
                .bytes = i->bytes,
                .room = i->room,
                .klv_count = unit->klv_count,
                .pts_90k = unit->pts_90k,
                .latency = frame->latency,
                .latency_key = frame->latency_key,
                .rendered_s = frame->times.rendered_s};
    return true;
}

void video_writer_put(VideoWriter *w, Encoder *encoder, const VideoUnit *unit, const Frame *frame)
{
    const size_t octets = unit->packet.count + unit->klv_count;
    const bool   key = unit->packet.key;
    pthread_mutex_lock(&w->lock);
    Item *i = &w->item[(w->first + w->count) % items];
    bool  taken = has_room(w, octets) && (key || !w->gap);
    pthread_mutex_unlock(&w->lock);
    taken = taken && fill(i, encoder, unit, frame);
    if (!taken && frame->latency) latency_left_out(frame->latency, frame->latency_key, video_file_name);
    pthread_mutex_lock(&w->lock);
    w->gap = !taken || (w->gap && !key);
    w->needs_key = w->gap || (w->needs_key && !key);
    w->left_out += !taken;
    w->count += taken;
    w->octets += taken ? octets : 0;
    pthread_cond_signal(&w->work);
    pthread_mutex_unlock(&w->lock);
}

Status video_writer_close(VideoWriter *w)
{
    pthread_mutex_lock(&w->lock);
    w->stop = true;
    const int left_out = w->left_out;
    pthread_cond_signal(&w->work);
    pthread_mutex_unlock(&w->lock);
    if (left_out)
        log_warn("video: %s lacks %d frames: it was written too slowly; the others are whole", w->output->path,
                 left_out);
    if (!publish_ended(w->thread, &w->steps, w->output->path)) return STATUS_IO;
    const Status closed = w->closed;
    free(w->output);
    for (int i = 0; i < items; i++) free(w->item[i].bytes);
    pthread_cond_destroy(&w->work);
    pthread_mutex_destroy(&w->lock);
    free(w);
    return closed;
}
