/* sensor/publish/video/video_pixels.c: images to the planes of a video frame. */
#include "sensor/publish/video/video_pixels.h"

static int value_at(const void *image, size_t i, int bits)
{
    return bits == 8 ? ((const uint8_t *)image)[i] : ((const uint16_t *)image)[i];
}

static void put_value(uint8_t *row, int i, int value, int bits)
{
    if (bits == 8) row[i] = (uint8_t)value;
    else ((uint16_t *)(void *)row)[i] = (uint16_t)value;
}

static void copy_rows(const VideoPlanes *out, const void *image, int values)
{
    const size_t octets = (size_t)values * (size_t)out->width * (out->bits == 8 ? 1 : 2);
    for (int y = 0; y < out->height; y++)
        memcpy(out->at[0] + y * out->stride[0], (const uint8_t *)image + (size_t)y * octets, octets);
}

static void neutral_chroma(const VideoPlanes *out)
{
    const bool half = out->layout == PIXELS_420;
    const int  w = half ? out->width / 2 : out->width, h = half ? out->height / 2 : out->height;
    for (int p = 1; p < 3; p++)
        for (int y = 0; y < h; y++)
            for (int x = 0; x < w; x++) put_value(out->at[p] + y * out->stride[p], x, 1 << (out->bits - 1), out->bits);
}

/* ITU-R BT.709: Y = 0.2126 R + 0.7152 G + 0.0722 B, Cb = (B - Y) / 1.8556, Cr = (R - Y) / 1.5748; times 2^16. The
 * weights of Y sum to 2^16, those of a difference to 0: grey stays grey, to the value. */
enum { fixed_bits = 16, y_r = 13933, y_g = 46871, y_b = 4732 };
static const int chroma_weight[2][3] = {{-7509, -25259, 32768}, {32768, -29763, -3005}};

static int luma(const int rgb[3])
{
    return (int)(((int64_t)y_r * rgb[0] + (int64_t)y_g * rgb[1] + (int64_t)y_b * rgb[2] + (1 << (fixed_bits - 1))) >>
                 fixed_bits);
}

/* sum: R, G, B times `weight`, a power of 2. */
static int chroma(const int sum[3], int which, int weight, int bits)
{
    const int    *w     = chroma_weight[which];
    const int64_t scale = (int64_t)weight << fixed_bits;
    const int64_t exact = (int64_t)w[0] * sum[0] + (int64_t)w[1] * sum[1] + (int64_t)w[2] * sum[2] +
                          ((int64_t)1 << (bits - 1)) * scale + scale / 2;
    const int64_t value = exact / scale; /* exact > 0 */
    return value >= 1 << bits ? (1 << bits) - 1 : (int)value;
}

static void add_pixel(int sum[3], const VideoPlanes *out, const void *image, int x, int y, int weight)
{
    const size_t at = 3 * ((size_t)y * (size_t)out->width + (size_t)x);
    for (int c = 0; c < 3; c++) sum[c] += weight * value_at(image, at + (size_t)c, out->bits);
}

static void colour_planes(const VideoPlanes *out, const void *image)
{
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++) {
            int rgb[3] = {0};
            add_pixel(rgb, out, image, x, y, 1);
            put_value(out->at[0] + y * out->stride[0], x, luma(rgb), out->bits);
            if (out->layout == PIXELS_444)
                for (int p = 1; p < 3; p++)
                    put_value(out->at[p] + y * out->stride[p], x, chroma(rgb, p - 1, 1, out->bits), out->bits);
        }
    for (int y = 0; out->layout == PIXELS_420 && y < out->height; y += 2)
        for (int x = 0; x < out->width; x += 2) {
            int sum[3] = {0};
            for (int row = y; row < y + 2; row++) {
                add_pixel(sum, out, image, x > 0 ? x - 1 : 0, row, 1);
                add_pixel(sum, out, image, x, row, 2);
                add_pixel(sum, out, image, x + 1, row, 1);
            }
            for (int p = 1; p < 3; p++)
                put_value(out->at[p] + y / 2 * out->stride[p], x / 2, chroma(sum, p - 1, 8, out->bits), out->bits);
        }
}

void video_pixels(const VideoPlanes *out, const void *image, bool colour)
{
    if (out->layout == PIXELS_RGB) {
        copy_rows(out, image, 3);
    } else if (colour) {
        colour_planes(out, image);
    } else {
        copy_rows(out, image, 1);
        if (out->layout != PIXELS_GREY) neutral_chroma(out);
    }
}
