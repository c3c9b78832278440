/* sensor/publish/video/video_encoder_private.h: images to packets of compressed video, one packet for each image, at
 * once.
 *
 * No B frames, no look-ahead, one thread: the bytes depend on the images and on the version of the libraries alone.
 * Constant quality, whatever the bit rate. Parameter sets are in each key frame, so that a receiver may join there.
 *
 * Grey levels are full range, 0 .. 2^bits - 1, and flagged so: luma is the image's value. The chroma of grey images is
 * neutral: 4:2:0 is what hardware decoders, browsers and GStreamer display; 4:0:0 is not. Colour is BT.709, 4:2:0,
 * chroma sited left as H.264's default. Images with an odd side, which 4:2:0 cannot have, are 4:0:0 and 4:4:4. FFV1 is
 * lossless: gray16, rgb48. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_ENCODER_PRIVATE_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_ENCODER_PRIVATE_H

#include "sensor/settings/publish_choice.h"
#include "pitviper_library.h"

typedef struct EncoderConfig {
    enum VideoCodec codec;
    int             width, height;
    bool            colour;
    double          rate_hz; /* nominal: of players that show it; real times are the muxer's */
} EncoderConfig;

/* A packet is valid until the next call. */
typedef struct VideoPacket {
    const uint8_t *bytes;
    size_t         count;
    bool           key;
} VideoPacket;

typedef struct Encoder Encoder;

/* STATUS_UNSUPPORTED: the libraries lack the encoder, or it refuses the size; STATUS_IO: they cannot be loaded. Logged.
 */
Status video_encoder_open(Encoder **out, const EncoderConfig *config);
/* Counted: what writes its packets in another thread holds it, and closes it when they are written. That thread may
 * ask for its configuration and parameters, which do not change. */
void video_encoder_hold(Encoder *encoder);
void video_encoder_close(Encoder *encoder);     /* NULL is valid */
int  video_encoder_bits(enum VideoCodec codec); /* of an image's values: 8, 10, 12, 16 */
/* image: grey, or R G B interleaved; uint8_t for 8 bits, else uint16_t. key: decodable by itself; the first is anyway.
 * unix_us: microseconds of its time since 1970, which H.264 and H.265 carry before the image as MISB ST 0604 says, the
 * same as ST 0601's tag 2; negative: none. STATUS_IO: the encoder failed, logged; open another one. */
Status video_encoder_encode(VideoPacket *out, Encoder *encoder, const void *image, bool key, int64_t unix_us);

const EncoderConfig *video_encoder_config(const Encoder *encoder);
/* What a container records of the codec. */
struct AVCodecParameters;
Status video_encoder_parameters(struct AVCodecParameters *out, const Encoder *encoder);

/* Lets through at most one line of the libraries' own messages for each of ours, shown by `pitviper -v`. Called by
 * video_encoder_open and video_transport_open. */
void video_quiet_libraries(void);

/* ---- FFmpeg's libraries, loaded when a video or stream is first asked for ------------------------ */

extern Library video_library;

/* ---- images to the planes of a video frame ------------------------------------------------------- */

typedef enum PixelLayout {
    PIXELS_GREY, /* luma alone */
    PIXELS_420,  /* luma, and two planes of half the size; width and height are even */
    PIXELS_444,  /* three planes of full size */
    PIXELS_RGB,  /* as the image: interleaved */
} PixelLayout;

typedef struct VideoPlanes {
    uint8_t    *at[3];
    ptrdiff_t   stride[3]; /* octets */
    PixelLayout layout;
    int         width, height, bits; /* 8: octets; else 16-bit values */
} VideoPlanes;

/* Converts an image, grey or (colour) R G B interleaved, with the planes' bits. RGB becomes YCbCr by BT.709, full
 * range, in integers, within 0.51 of the exact value. Chroma is 4:2:0, with weights 1 2 1 about each even column of two
 * rows. */
void video_pixels(const VideoPlanes *out, const void *image, bool colour);

#endif
