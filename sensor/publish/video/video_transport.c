/* sensor/publish/video/video_transport.c: packets of video and KLV metadata into a container, through libavformat.
 *
 * av_write_frame, not the interleaving form: that would keep metadata back until the next frame. */
#include "sensor/publish/video/video_output_private.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <stdlib.h>

enum { sync_header_octets = 5, buffer_octets_file = 1 << 16 };

struct Transport {
    TransportConfig  config;
    AVFormatContext *format;
    AVIOContext     *io;
    AVStream        *video, *klv;
    AVPacket        *packet;
    int64_t          first_90k; /* of the first frame; -1: none yet */
    int64_t          turns_90k; /* added to times before 1970: whole turns of 33 bits */
    int64_t          last_90k;
    uint8_t          klv_sequence;
    bool             failed; /* of the sink, since it was asked */
    bool             begun;  /* the header is written */
    uint8_t          cell[sync_header_octets + klv_octets_most + AV_INPUT_BUFFER_PADDING_SIZE];
};

static int write_sink(void *user, uint8_t *bytes, int count)
{
    Transport *t = user;
    if (!t->config.sink.write(t->config.sink.user, bytes, (size_t)count)) t->failed = true;
    return count; /* a failure must not stop the muxer for good: the sink may recover */
}

static int64_t seek_sink(void *user, int64_t offset, int whence)
{
    Transport *t = user;
    if (whence != SEEK_SET || !t->config.sink.seek(t->config.sink.user, offset)) return AVERROR(ENOSYS);
    return offset;
}

static Status sink_status(Transport *t, int result)
{
    const bool failed = t->failed || result < 0;
    t->failed = false;
    return failed ? STATUS_IO : STATUS_OK;
}

static Status add_streams(Transport *t, const Encoder *encoder)
{
    const EncoderConfig *c = video_encoder_config(encoder);
    t->video = avformat_new_stream(t->format, NULL);
    if (!t->video || video_encoder_parameters(t->video->codecpar, encoder) != STATUS_OK) return STATUS_NO_MEMORY;
    t->video->time_base = (AVRational){1, 90000};
    t->video->avg_frame_rate = av_d2q(c->rate_hz, 1000000);
    t->video->codecpar->codec_tag = 0;
    if (t->config.container == VIDEO_MP4 && c->codec == VIDEO_HEVC_12) /* parameter sets out of band: Apple's players */
        t->video->codecpar->codec_tag = MKTAG('h', 'v', 'c', '1');
    if (t->config.container != VIDEO_TS || t->config.klv == KLV_OFF) return STATUS_OK;
    t->klv = avformat_new_stream(t->format, NULL);
    if (!t->klv) return STATUS_NO_MEMORY;
    t->klv->time_base = (AVRational){1, 90000};
    t->klv->codecpar->codec_type = AVMEDIA_TYPE_DATA;
    t->klv->codecpar->codec_id = AV_CODEC_ID_SMPTE_KLV;
    if (t->config.klv == KLV_SYNC) t->klv->codecpar->profile = FF_PROFILE_KLVA_SYNC;
    return STATUS_OK;
}

static int write_header(Transport *t)
{
    AVDictionary *options = NULL;
    if (t->config.container == VIDEO_TS) {
        /* the length of a video PES packet, where it fits: receivers need not wait for the next frame */
        av_dict_set(&options, "omit_video_pes_length", "0", 0);
        av_dict_set(&options, "pat_period", "0.1", 0);
        av_dict_set(&t->format->metadata, "service_provider", "pitviper", 0);
        av_dict_set(&t->format->metadata, "service_name", t->config.title, 0);
    } else {
        av_dict_set(&t->format->metadata, "title", t->config.title, 0);
    }
    if (t->config.container == VIDEO_MP4)
        av_dict_set(&options, "movflags", "frag_keyframe+empty_moov+default_base_moof", 0);
    const int result = avformat_write_header(t->format, &options);
    av_dict_free(&options);
    return result;
}

Status video_transport_open(Transport **out, const TransportConfig *config, const Encoder *encoder)
{
    static const char *const names[] = {NULL, NULL, "mp4", "matroska", "mpegts"};
    const bool               ts = config->container == VIDEO_TS;
    const int                octets = ts ? transport_octets : buffer_octets_file;
    Transport               *t = calloc(1, sizeof *t);
    uint8_t                 *buffer = av_malloc((size_t)octets);
    Status                   status = STATUS_NO_MEMORY;
    if (!t || !buffer) goto fail;
    video_quiet_libraries();
    t->config = *config;
    t->first_90k = -1;
    t->io = avio_alloc_context(buffer, octets, 1, t, NULL, write_sink, config->sink.seek ? seek_sink : NULL);
    if (!t->io) goto fail;
    buffer = NULL;
    if (!config->sink.seek) t->io->seekable = 0;
    if (ts) t->io->max_packet_size = transport_octets;
    t->packet = av_packet_alloc();
    if (!t->packet || avformat_alloc_output_context2(&t->format, NULL, names[config->container], NULL) < 0) goto fail;
    t->format->pb = t->io;
    t->format->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_BITEXACT | AVFMT_FLAG_FLUSH_PACKETS;
    t->format->max_delay = 0;
    status = add_streams(t, encoder);
    if (status != STATUS_OK) goto fail;
    const int result = write_header(t);
    if (result < 0) {
        log_error("video: %s does not take this video: %s", names[config->container], av_err2str(result));
        status = STATUS_UNSUPPORTED;
        goto fail;
    }
    avio_flush(t->io);
    t->begun = true;
    status = sink_status(t, 0);
    if (status != STATUS_OK) goto fail;
    *out = t;
    return STATUS_OK;

fail:
    av_free(buffer);
    video_transport_close(t, false);
    return status;
}

/* Times of MPEG-TS: they are positive, and equal those of the clock modulo 2^33. */
static int64_t time_of(Transport *t, int64_t pts_90k)
{
    const int64_t turn = (int64_t)1 << 33;
    if (t->first_90k == -1) {
        t->turns_90k = pts_90k < 0 ? (-pts_90k / turn + 1) * turn : 0;
        t->first_90k = pts_90k + t->turns_90k;
    }
    pts_90k += t->turns_90k;
    return t->config.container == VIDEO_TS ? pts_90k : pts_90k - t->first_90k;
}

static int write_klv(Transport *t, int64_t at_90k, const uint8_t *klv, size_t count)
{
    AVPacket    *p = t->packet;
    const bool   sync = t->config.klv == KLV_SYNC;
    const size_t head = sync ? sync_header_octets : 0;
    if (count > klv_octets_most) return AVERROR(EINVAL);
    /* the header of a metadata AU cell (ISO/IEC 13818-1, 2.12.4): service 0, its number, a flag that it is whole and
     * decodable by itself, its length */
    const uint8_t cell[sync_header_octets] = {0, t->klv_sequence, 0xDF, (uint8_t)(count >> 8), (uint8_t)count};
    memcpy(t->cell, cell, head);
    memcpy(t->cell + head, klv, count);
    t->klv_sequence++;
    av_packet_unref(p);
    p->data = t->cell;
    p->size = (int)(head + count);
    p->stream_index = t->klv->index;
    p->flags = AV_PKT_FLAG_KEY;
    p->pts = p->dts =
        sync ? at_90k : AV_NOPTS_VALUE; /* FFmpeg's muxer writes none on stream id 0xBD, as ST 1402 has it */
    if (!sync) {
        uint8_t *id = av_packet_new_side_data(p, AV_PKT_DATA_MPEGTS_STREAM_ID, 1);
        if (!id) return AVERROR(ENOMEM);
        *id = 0xBD;
    }
    return av_write_frame(t->format, p);
}

Status video_transport_put(Transport *t, const VideoPacket *packet, int64_t pts_90k, const uint8_t *klv,
                           size_t klv_count)
{
    const int64_t at_90k = time_of(t, pts_90k);
    AVPacket     *p = t->packet;
    int           result = t->klv && klv && klv_count ? write_klv(t, at_90k, klv, klv_count) : 0;
    av_packet_unref(p);
    p->data = (uint8_t *)(uintptr_t)packet->bytes; /* read only */
    p->size = (int)packet->count;
    p->stream_index = t->video->index;
    p->flags = packet->key ? AV_PKT_FLAG_KEY : 0;
    p->pts = p->dts = at_90k;
    p->duration = t->video->avg_frame_rate.num > 0
                      ? av_rescale(90000, t->video->avg_frame_rate.den, t->video->avg_frame_rate.num)
                      : 0;
    av_packet_rescale_ts(p, (AVRational){1, 90000}, t->video->time_base);
    if (result >= 0 && packet->key && t->config.container == VIDEO_MKV) result = av_write_frame(t->format, NULL);
    if (result >= 0) result = av_write_frame(t->format, p);
    avio_flush(t->io);
    return sink_status(t, result);
}

Status video_transport_flush(Transport *t)
{
    const int result = av_write_frame(t->format, NULL);
    avio_flush(t->io);
    return sink_status(t, result);
}

void video_transport_forget_positions(Transport *t) { t->io->seekable = 0; }

Status video_transport_close(Transport *t, bool finish)
{
    if (!t) return STATUS_OK;
    int result = 0;
    if (finish && t->begun) result = av_write_trailer(t->format);
    if (finish && t->io) avio_flush(t->io);
    const Status status = sink_status(t, result);
    avformat_free_context(t->format);
    if (t->io) av_freep(&t->io->buffer);
    avio_context_free(&t->io);
    av_packet_free(&t->packet);
    free(t);
    return status;
}
