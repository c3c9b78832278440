/* sensor/publish/video/video_names.c: paths and addresses of a run's videos, and the commands that show its streams. */
#include "sensor/publish/video/video_names.h"

#include <sys/stat.h>

int video_folder_kinds(VideoKind kind[2], const Config *config)
{
    const bool lossless = config->publish.video_codec == VIDEO_FFV1;
    kind[0] = lossless ? VIDEO_MKV : VIDEO_TS;
    kind[1] = VIDEO_MP4;
    return lossless ? 1 : 2;
}

bool video_path(char out[video_path_size], const Config *config, const char *host_folder, Band band, VideoKind kind)
{
    static const char *const endings[] = {NULL, NULL, "mp4", "mkv", "ts"};
    const char              *path = config->publish.video;
    const int                length = video_kind(path) != VIDEO_FOLDER
                                          ? snprintf(out, video_path_size, "%s", path)
                                          : snprintf(out, video_path_size, "%s/%s%s%s.%s", path, host_folder ? host_folder : "",
                                      host_folder ? "/" : "", band_name(band), endings[kind]);
    if (length < video_path_size) return true;
    log_error("video: the name %.100s... is too long; choose another with --video", path);
    return false;
}

bool video_stream_url(StreamUrl *out, const Config *config, unsigned bands, Band band)
{
    const char *why;
    if (!*config->publish.stream || !publish_stream_parse(out, &why, config->publish.stream)) return false;
    const int before = __builtin_popcount(bands & ((1u << band) - 1));
    out->port = (uint16_t)(out->port + before * publish_stream_port_step); /* publish_video_check: it fits */
    return true;
}

unsigned video_wanted(const Config *config)
{
    return (*config->publish.stream ? VIDEO_TO_STREAM : 0u) | (*config->publish.video ? VIDEO_TO_FILE : 0u);
}

Status video_hosts_check(const Config *config, int hosts)
{
    const bool single = video_kind(config->publish.video) > VIDEO_FOLDER;
    if (hosts <= 1 || (!single && !*config->publish.stream)) return STATUS_OK;
    log_error("video: several hosts do not fit into one %s; choose one --host, or --video FOLDER",
              single ? "file" : "stream");
    return STATUS_UNSUPPORTED;
}

static bool exists(char found[video_path_size], const char *path)
{
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode) || about.st_size == 0) return false;
    snprintf(found, video_path_size, "%s", path);
    return true;
}

bool video_earlier(char found[video_path_size], const Config *config, unsigned bands, const char *host_folder)
{
    char            path[video_path_size];
    VideoKind       kind[2];
    const VideoKind asked = video_kind(config->publish.video);
    if (asked == VIDEO_NONE) return false;
    const int kinds = asked == VIDEO_FOLDER ? video_folder_kinds(kind, config) : 1;
    if (asked != VIDEO_FOLDER) kind[0] = asked;
    for (int b = 0; b < BAND_COUNT; b++)
        for (int k = 0; k < kinds; k++)
            if (bands >> b & 1 && video_path(path, config, host_folder, (Band)b, kind[k]) && exists(found, path))
                return true;
    return false;
}

void video_watch_lines(char *out, size_t out_size, const Config *config, unsigned bands)
{
    size_t used = 0;
    out[0] = 0;
    for (int b = 0; b < BAND_COUNT; b++) {
        StreamUrl url;
        char      address[40];
        if (!(bands >> b & 1) || !video_stream_url(&url, config, bands, (Band)b)) continue;
        snprintf(address, sizeof address, "%u.%u.%u.%u:%u", url.address[0], url.address[1], url.address[2],
                 url.address[3], url.port);
        const char *colon = strchr(address, ':');
        const int   n = snprintf(out + used, out_size - used,
                                 "  %-8s ffplay -analyzeduration 1500000 -fflags nobuffer -flags low_delay udp://%s"
                                   "   or   vlc udp://@%s\n",
                                 band_name((Band)b), address, publish_stream_multicast(&url) ? address : colon);
        if (n < 0 || (size_t)n >= out_size - used) break;
        used += (size_t)n;
    }
    out[used] = 0;
}

void video_watch_print(const Config *config, unsigned bands)
{
    char text[1024];
    video_watch_lines(text, sizeof text, config, bands);
    if (*text) log_print("streams can be watched with:\n%s", text);
}
