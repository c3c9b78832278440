/* sensor/settings/publish_choice.c: parses and checks what publish.* asks for: truth planes, shared memory, videos,
 * streams. */
#include "sensor/settings/publish_choice.h"

#include "pitviper_output.h"

#include <ctype.h>
#include <strings.h>
#include <sys/stat.h>

/* ---- truth planes ------------------------------------------------------------------------------------- */

bool publish_planes_parse(PlaneSet *planes, const char *text)
{
    PlaneSet set = 0;
    *planes = strcmp(text, "all") == 0 ? planes_named("", 0) : 0;
    if (*planes || strcmp(text, "none") == 0) return true;
    for (const char *at = text; at;) {
        const size_t   length = strcspn(at, ",");
        const PlaneSet named = length ? planes_named(at, length) : 0;
        if (!named || set & named) return false; /* unknown, or named twice */
        set |= named;
        at = at[length] ? at + length + 1 : NULL;
    }
    *planes = set;
    return true;
}

const char *publish_planes_name(int i)
{
    for (int pass = 0; pass < 3; pass++)
        for (int k = 0; k < plane_row_count; k++) {
            const PlaneRow *row = &plane_rows[k];
            const char     *before = k > 0 ? plane_rows[k - 1].choice : NULL;
            if (!row->choice || (before && strcmp(before, row->choice) == 0)) continue;
            if (pass == (row->plants != PLANTS_OR_NOT ? 2 : row->bands ? 1 : 0) && i-- == 0) return row->choice;
        }
    return NULL;
}

void publish_planes_why(char *out, size_t out_size, const char *text)
{
    PlaneSet set = 0;
    char     word[64];
    *out = 0;
    for (const char *at = text; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        snprintf(word, sizeof word, "%.*s", (int)strcspn(at, ","), at);
        const PlaneSet named = *word ? planes_named(word, strlen(word)) : 0;
        if (!named) {
            WordMeant meant = word_meant(word);
            for (int i = 0; publish_planes_name(i); i++) word_consider(&meant, publish_planes_name(i));
            word_consider_list(&meant, "all|none", '|');
            snprintf(out, out_size, "%s", word_hint(&meant));
            return;
        }
        if (set & named) snprintf(out, out_size, "; %s is named twice", word);
        set |= named;
    }
}

/* ---- shared memory ------------------------------------------------------------------------------------ */

/* Whether a name may be that of a ring: it becomes a file's name under /dev/shm. */
static bool memory_name_good(const char *name)
{
    if (!isalnum((unsigned char)*name)) return false; /* no hidden file, no folder */
    for (const char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c)) return false;
    return true;
}

Status publish_memory_check(const Config *config, bool sensor)
{
    const char *name = config->publish.memory;
    if (!*name) return STATUS_OK;
    if (!memory_name_good(name)) {
        log_error("config: publish.memory: '%s' is not a name of letters, digits, `-`, `_` and `.` that begins with a "
                  "letter or a digit, for example seeker",
                  name);
        return STATUS_BAD_VALUE;
    }
    if (config->publish.memory_planes == MEMORY_PLANES_COUNTS && !sensor) {
        log_error("config: publish.memory_planes: counts are those of a sensor; choose one with sensor.preset or "
                  "sensor.table, or set publish.memory_planes: float");
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* ---- address of a stream ------------------------------------------------------------------------------ */

/* Reads a number of digits without a leading zero, at most `most`. False: it is not such a number. */
static bool read_number(int *out, const char **at, int most)
{
    int         value = 0;
    const char *from = *at;
    while (**at >= '0' && **at <= '9') {
        value = 10 * value + (**at - '0');
        if (value > most) return false;
        (*at)++;
    }
    if (*at == from || (*from == '0' && *at - from > 1)) return false;
    *out = value;
    return true;
}

bool publish_stream_parse(StreamUrl *out, const char **why, const char *text)
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

/* ---- videos and streams ------------------------------------------------------------------------------- */

VideoKind video_kind(const char *path)
{
    static const struct {
        const char *end;
        VideoKind   kind;
    } ends[] = {{".mp4", VIDEO_MP4}, {".mkv", VIDEO_MKV}, {".ts", VIDEO_TS}};
    const size_t length = strlen(path);
    if (!length) return VIDEO_NONE;
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        const size_t end = strlen(ends[i].end);
        if (length > end && path[length - end - 1] != '/' && strcasecmp(path + length - end, ends[i].end) == 0)
            return ends[i].kind;
    }
    return VIDEO_FOLDER;
}

/* Whether a name has an ending that no video here has: then it is no folder, unless it is one already or says so. */
static bool other_video(const char *path)
{
    struct stat about;
    const char *ending = output_ending(path);
    bool        known = strcmp(ending, ".264") == 0 || strcmp(ending, ".265") == 0; /* the only ones without a letter */
    for (const char *at = ending; *at && !known; at++) known = (*at | 32) >= 'a' && (*at | 32) <= 'z';
    return known && !(stat(path, &about) == 0 && S_ISDIR(about.st_mode));
}

/* The number of bands in a list; their names are checked elsewhere. */
static int bands_listed(const char *text)
{
    int count = 1;
    for (; *text; text++) count += *text == ',';
    return count;
}

Status publish_video_check(const Config *config)
{
    const char     *video = config->publish.video, *stream = config->publish.stream, *why = NULL;
    const VideoKind kind = video_kind(video);
    StreamUrl       url;
    if (kind == VIDEO_NONE && !*stream) return STATUS_OK;
#ifndef PITVIPER_VIDEO
    log_error("config: publish.%s: this program was built without FFmpeg's libraries; install libavcodec-dev, "
              "libavformat-dev and libavutil-dev and build it again, or leave it out",
              *stream ? "stream" : "video");
    return STATUS_BAD_VALUE;
#endif
    if (kind == VIDEO_FOLDER && other_video(video)) {
        log_error(
            "config: publish.video: '%s': choose a name that ends with .mp4, .mkv or .ts, or a folder (a name without an "
            "ending, or with / at its end)",
            video);
        return STATUS_BAD_VALUE;
    }
    if (*stream && !publish_stream_parse(&url, &why, stream)) {
        log_error("config: publish.stream: '%s' %s; for example udp://239.1.2.3:5004", stream, why);
        return STATUS_BAD_VALUE;
    }
    const int steps = (bands_listed(config->sensor.bands) - 1) * publish_stream_port_step;
    if (*stream && url.port + steps > 65535) {
        log_error("config: publish.stream: port %d: the last of %d bands would be sent to port %d; choose one of at "
                  "most %d",
                  url.port, steps / publish_stream_port_step + 1, url.port + steps, 65535 - steps);
        return STATUS_BAD_VALUE;
    }
    const bool lossless = config->publish.video_codec == VIDEO_FFV1;
    if (lossless && *stream) {
        log_error("config: publish.video_codec: ffv1 is for files; MPEG-TS (publish.stream) does not carry it; choose "
                  "h264, h264-10 or hevc-12");
        return STATUS_BAD_VALUE;
    }
    if (lossless && (kind == VIDEO_MP4 || kind == VIDEO_TS)) {
        log_error("config: publish.video_codec: ffv1 is for .mkv files; publish.video: %s: choose a name that ends "
                  "with .mkv, a folder, or another codec",
                  video);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}
