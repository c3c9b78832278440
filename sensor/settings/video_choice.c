/* sensor/settings/video_choice.c: parses the address of a stream, and checks the settings of videos and streams. */
#include "sensor/settings/video_choice.h"
#include "pitviper_output.h"

#include <strings.h>
#include <sys/stat.h>

/* ---- address ------------------------------------------------------------------------------------ */

/* Digits without a leading zero, at most `most`. False: not that. */
static bool read_number(int *out, const char **at, int most)
{
    int         value = 0;
    const char *from  = *at;
    while (**at >= '0' && **at <= '9') {
        value = 10 * value + (**at - '0');
        if (value > most) return false;
        (*at)++;
    }
    if (*at == from || (*from == '0' && *at - from > 1)) return false;
    *out = value;
    return true;
}

bool stream_url_parse(StreamUrl *out, const char **why, const char *text)
{
    static const char scheme[] = "udp://";
    StreamUrl         url;
    int               value = 0;
    if (strncmp(text, scheme, sizeof scheme - 1) != 0) {
        *why = "does not begin with udp://";
        return false;
    }
    const char *at = text + sizeof scheme - 1;
    if (*at == '@') {
        *why = "is an address as a player receives it; without the @";
        return false;
    }
    for (int i = 0; i < 4; i++) {
        if (!read_number(&value, &at, 255) || (i < 3 && *at++ != '.')) {
            *why = "has no IPv4 address in numbers, such as 127.0.0.1 or 239.1.2.3";
            return false;
        }
        url.address[i] = (uint8_t)value;
    }
    if (*at != ':') {
        *why = "has no port, such as :5004";
        return false;
    }
    at++;
    if (!read_number(&value, &at, 65535) || value == 0 || *at) {
        *why = "has no port of 1 .. 65535 at its end";
        return false;
    }
    url.port = (uint16_t)value;
    if (url.address[0] == 0 || (url.address[0] >= 240 && memcmp(url.address, "\xFF\xFF\xFF\xFF", 4) != 0)) {
        *why = "has an address that no machine can have";
        return false;
    }
    *out = url;
    return true;
}

/* ---- settings ----------------------------------------------------------------------------------- */

VideoKind video_kind(const char *path)
{
    static const struct { const char *end; VideoKind kind; } ends[] = {
        {".mp4", VIDEO_MP4}, {".mkv", VIDEO_MKV}, {".ts", VIDEO_TS}};
    const size_t length = strlen(path);
    if (!length) return VIDEO_NONE;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        const size_t end = strlen(ends[i].end);
        if (length > end && path[length - end - 1] != '/' && strcasecmp(path + length - end, ends[i].end) == 0)
            return ends[i].kind;
    }
    return VIDEO_FOLDER;
}

/* A name with another ending is no folder, unless it is one already or says so. */
static bool other_video(const char *path)
{
    struct stat about;
    const char *ending = output_ending(path);
    bool        known  = strcmp(ending, ".264") == 0 || strcmp(ending, ".265") == 0; /* the only ones without a letter */
    for (const char *at = ending; *at && !known; at++) known = (*at | 32) >= 'a' && (*at | 32) <= 'z';
    return known && !(stat(path, &about) == 0 && S_ISDIR(about.st_mode));
}

VideoCodec video_codec(const char *name)
{
    static const char *const names[] = {"h264", "h264-10", "hevc-12", "ffv1"};
    int                      i       = 0;
    while (i < VIDEO_FFV1 && strcmp(name, names[i]) != 0) i++;
    return (VideoCodec)i;
}

/* Bands in a list as configured; the names are checked elsewhere. */
static int bands_listed(const char *text)
{
    int count = 1;
    for (; *text; text++) count += *text == ',';
    return count;
}

Status video_choice_check(const char *video, const char *stream, const char *codec, const char *bands)
{
    const VideoKind kind = video_kind(video);
    const char     *why  = NULL;
    StreamUrl       url;
    if (kind == VIDEO_NONE && !*stream) return STATUS_OK;
#ifndef PITVIPER_VIDEO
    log_error("config: publish.%s: this program was built without FFmpeg's libraries; install libavcodec-dev, "
              "libavformat-dev and libavutil-dev and build it again, or leave it out",
              *stream ? "stream" : "video");
    return STATUS_BAD_VALUE;
#endif
    if (kind == VIDEO_FOLDER && other_video(video)) {
        log_error("config: publish.video: '%s': choose a name that ends with .mp4, .mkv or .ts, or a folder (a name without an "
                  "ending, or with / at its end)", video);
        return STATUS_BAD_VALUE;
    }
    if (*stream && !stream_url_parse(&url, &why, stream)) {
        log_error("config: publish.stream: '%s' %s; for example udp://239.1.2.3:5004", stream, why);
        return STATUS_BAD_VALUE;
    }
    const int steps = (bands_listed(bands) - 1) * stream_port_step;
    if (*stream && url.port + steps > 65535) {
        log_error("config: publish.stream: port %d: the last of %d bands would be sent to port %d; choose one of at "
                  "most %d", url.port, steps / stream_port_step + 1, url.port + steps, 65535 - steps);
        return STATUS_BAD_VALUE;
    }
    const bool lossless = video_codec(codec) == VIDEO_FFV1;
    if (lossless && *stream) {
        log_error("config: publish.video_codec: ffv1 is for files; MPEG-TS (publish.stream) does not carry it; choose "
                  "h264, h264-10 or hevc-12");
        return STATUS_BAD_VALUE;
    }
    if (lossless && (kind == VIDEO_MP4 || kind == VIDEO_TS)) {
        log_error("config: publish.video_codec: ffv1 is for .mkv files; publish.video: %s: choose a name that ends "
                  "with .mkv, a folder, or another codec", video);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}
