/* sensor/publish/video/video_pixels.h: images to the planes of a video frame. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_PIXELS_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_PIXELS_H

#include "pitviper.h"

typedef enum PixelLayout {
    PIXELS_GREY,   /* luma alone */
    PIXELS_420,    /* luma, and two planes of half the size; width and height are even */
    PIXELS_444,    /* three planes of full size */
    PIXELS_RGB,    /* as the image: interleaved */
} PixelLayout;

typedef struct VideoPlanes {
    uint8_t    *at[3];
    ptrdiff_t   stride[3]; /* octets */
    PixelLayout layout;
    int         width, height, bits; /* 8: octets; else 16-bit values */
} VideoPlanes;

/* image: grey, or (colour) R G B interleaved, of the planes' bits. RGB to YCbCr: BT.709, full range, in integers;
 * within 0.51 of the exact value. Chroma 4:2:0: weights 1 2 1 about each even column, of two rows. */
void video_pixels(const VideoPlanes *out, const void *image, bool colour);

#endif
