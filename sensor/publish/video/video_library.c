/* sensor/publish/video/video_library.c: the functions of FFmpeg's libraries that encoder.c and transport.c call. */
#include "sensor/publish/video/video_library.h"

#define FFMPEG(X)                                                                                                     \
    X(av_d2q) X(av_dict_free) X(av_dict_set) X(av_frame_alloc) X(av_frame_free) X(av_frame_get_buffer)                \
    X(av_frame_make_writable) X(av_frame_new_side_data) X(av_frame_remove_side_data) X(av_free) X(av_freep) X(av_log_set_callback) X(av_malloc) X(av_packet_alloc)           \
    X(av_packet_free) X(av_packet_new_side_data) X(av_packet_rescale_ts) X(av_packet_unref) X(av_rescale)             \
    X(av_strerror) X(av_write_frame) X(av_write_trailer) X(avcodec_alloc_context3) X(avcodec_find_encoder_by_name)    \
    X(avcodec_free_context) X(avcodec_open2) X(avcodec_parameters_from_context) X(avcodec_receive_packet)             \
    X(avcodec_send_frame) X(avformat_alloc_output_context2) X(avformat_free_context) X(avformat_new_stream)           \
    X(avformat_write_header) X(avio_alloc_context) X(avio_context_free) X(avio_flush)
LIBRARY(video_library, FFMPEG, "FFmpeg", PITVIPER_FFMPEG_FILE, "libavformat59");
