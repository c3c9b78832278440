/* sensor/publish/video/video_names.h: a run's videos and streams by name: what its configuration asks for, the paths
 * and addresses, and the commands that show a stream. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_NAMES_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_NAMES_H

#include "render/scene/view.h"
#include "sensor/settings/config.h"
#include "sensor/settings/publish_choice.h"

enum { video_path_size = 4096 };

typedef enum VideoTo { VIDEO_TO_STREAM = 1, VIDEO_TO_FILE = 2 } VideoTo;
/* What there is to publish: VideoTo; 0: nothing. */
unsigned video_wanted(const Config *config);

/* FOLDER/[HOST/]BAND.ENDING, or publish.video itself when it names a file. False, logged: too long. */
bool video_path(char out[video_path_size], const Config *config, const char *host_folder, Band band, VideoKind kind);
/* The containers of a folder for this codec; returns how many. */
int video_folder_kinds(VideoKind kind[2], const Config *config);
/* The stream of one band among those of the run. False: there is no stream. */
bool video_stream_url(StreamUrl *out, const Config *config, unsigned bands, Band band);

/* STATUS_UNSUPPORTED, logged: several hosts, and a video that is one file, or a stream. */
Status video_hosts_check(const Config *config, int hosts);

/* Whether a video that this run would replace exists, and its path. */
bool video_earlier(char found[video_path_size], const Config *config, unsigned bands, const char *host_folder);

/* Per stream the commands that show it, a line each, with its newline. Empty: there is no stream. print: them, with a
 * line before them; nothing where there is no stream. */
void video_watch_lines(char *out, size_t out_size, const Config *config, unsigned bands);
void video_watch_print(const Config *config, unsigned bands);

#endif
