/* sensor/publish/video/video_pixels.c: images to the planes of a video frame. */
#include "sensor/publish/video/video_pixels.h"

static void copy_rows(const VideoPlanes *out, const void *image, int values)
{
    const size_t octets = (size_t)values * (size_t)out->width * (out->bits == 8 ? 1 : 2);
    for (int y = 0; y < out->height; y++)
        memcpy(out->at[0] + y * out->stride[0], (const uint8_t *)image + (size_t)y * octets, octets);
}

static void neutral_chroma(const VideoPlanes *out)
{
    const bool     half   = out->layout == PIXELS_420;
    const uint16_t middle = (uint16_t)(1 << (out->bits - 1));
    const int      w = half ? out->width / 2 : out->width, h = half ? out->height / 2 : out->height;
    for (int p = 1; p < 3; p++)
        for (int y = 0; y < h; y++) {
            uint8_t *row = out->at[p] + y * out->stride[p];
            if (out->bits == 8) memset(row, middle, (size_t)w);
            for (int x = 0; out->bits > 8 && x < w; x++) ((uint16_t *)(void *)row)[x] = middle;
        }
}

/* ITU-R BT.709: Y = 0.2126 R + 0.7152 G + 0.0722 B, Cb = (B - Y) / 1.8556, Cr = (R - Y) / 1.5748; times 2^16. The
 * weights of Y sum to 2^16, those of a difference to 0: grey stays grey, to the value. */
enum { fixed_bits = 16, y_r = 13933, y_g = 46871, y_b = 4732 };
static const int chroma_weight[2][3] = {{-7509, -25259, 32768}, {32768, -29763, -3005}};

/* The following are compiled for octets and for 16-bit values: octet is a constant where they are called. */
#define FOR_BOTH static inline __attribute__((always_inline))

FOR_BOTH int64_t pixel_at(const void *image, size_t i, bool octet)
{
    return octet ? ((const uint8_t *)image)[i] : ((const uint16_t *)image)[i];
}

FOR_BOTH void store(uint8_t *row, int i, int64_t value, bool octet)
{
    if (octet) row[i] = (uint8_t)value;
    else ((uint16_t *)(void *)row)[i] = (uint16_t)value;
}

/* r, g, b: times 2^weight_bits. */
FOR_BOTH int64_t chroma(const int w[3], int64_t r, int64_t g, int64_t b, int weight_bits, int bits)
{
    const int     shift = fixed_bits + weight_bits;
    const int64_t value = (w[0] * r + w[1] * g + w[2] * b + ((int64_t)1 << (bits - 1 + shift)) +
                           ((int64_t)1 << (shift - 1))) >> shift; /* of a positive number */
    return value >> bits ? ((int64_t)1 << bits) - 1 : value;
}

FOR_BOTH void luma_row(uint8_t *to, const void *image, size_t at, int width, bool octet)
{
    for (int x = 0; x < width; x++, at += 3)
        store(to, x, (y_r * pixel_at(image, at, octet) + y_g * pixel_at(image, at + 1, octet) +
                      y_b * pixel_at(image, at + 2, octet) + (1 << (fixed_bits - 1))) >> fixed_bits, octet);
}

/* Of one value of a pixel, or of the columns left, here and right of two rows with weights 1 2 1. */
FOR_BOTH int64_t sum_of(const void *image, size_t here, size_t left, size_t right, size_t row, bool octet)
{
    int64_t sum = 0;
    for (size_t k = 0; k < 2; k++)
        sum += pixel_at(image, left + k * row, octet) + 2 * pixel_at(image, here + k * row, octet) +
               pixel_at(image, right + k * row, octet);
    return sum;
}

FOR_BOTH void colour_planes(const VideoPlanes *out, const void *image, bool octet)
{
    const size_t row  = 3 * (size_t)out->width;
    const int    bits = out->bits;
    for (int y = 0; y < out->height; y++)
        luma_row(out->at[0] + y * out->stride[0], image, (size_t)y * row, out->width, octet);
    for (int p = 1; p < 3; p++) {
        const int *w = chroma_weight[p - 1];
        for (int y = 0; out->layout == PIXELS_444 && y < out->height; y++)
            for (int x = 0; x < out->width; x++) {
                const size_t at = (size_t)y * row + 3 * (size_t)x;
                store(out->at[p] + y * out->stride[p], x,
                      chroma(w, pixel_at(image, at, octet), pixel_at(image, at + 1, octet),
                             pixel_at(image, at + 2, octet), 0, bits), octet);
            }
        for (int y = 0; out->layout == PIXELS_420 && y < out->height; y += 2)
            for (int x = 0; x < out->width; x += 2) {
                const size_t at = (size_t)y * row + 3 * (size_t)x, left = x > 0 ? at - 3 : at, right = at + 3;
                store(out->at[p] + y / 2 * out->stride[p], x / 2,
                      chroma(w, sum_of(image, at, left, right, row, octet),
                             sum_of(image, at + 1, left + 1, right + 1, row, octet),
                             sum_of(image, at + 2, left + 2, right + 2, row, octet), 3, bits), octet);
            }
    }
}

void video_pixels(const VideoPlanes *out, const void *image, bool colour)
{
    if (out->layout == PIXELS_RGB) {
        copy_rows(out, image, 3);
    } else if (colour) {
        if (out->bits == 8) colour_planes(out, image, true);
        else colour_planes(out, image, false);
    } else {
        copy_rows(out, image, 1);
        if (out->layout != PIXELS_GREY) neutral_chroma(out);
    }
}
