/* sensor/publish/video/video_absent.c: in place of videos and streams in a program built without FFmpeg's libraries.
 * Its settings are refused before (sensor/settings/publish_choice.c). */
#include "sensor/publish/video/consume_video.h"
#include "sensor/publish/video/video_names.h"

Status consume_video(Consumer **out, const VideoOf *of)
{
    (void)out;
    (void)of;
    log_error("video: this program was built without FFmpeg's libraries; install libavcodec-dev, libavformat-dev and "
              "libavutil-dev and build it again");
    return STATUS_UNSUPPORTED;
}

Status video_prepare(const Config *config)
{
    (void)config;
    return STATUS_OK;
}

Status video_hosts_check(const Config *config, int hosts)
{
    (void)config, (void)hosts;
    return STATUS_OK;
}

unsigned video_wanted(const Config *config)
{
    (void)config;
    return 0;
}

bool video_earlier(char found[video_path_size], const Config *config, unsigned bands, const char *host_folder)
{
    (void)config, (void)bands, (void)host_folder;
    found[0] = 0;
    return false;
}

void video_watch_print(const Config *config, unsigned bands) { (void)config, (void)bands; }

void video_watch_lines(char *out, size_t out_size, const Config *config, unsigned bands)
{
    (void)config, (void)bands;
    if (out_size) out[0] = 0;
}
