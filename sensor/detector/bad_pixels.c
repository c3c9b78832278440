/* sensor/detector/bad_pixels.c: defective pixels: their map, their values, and replacement from neighbours. */
#include "sensor/detector/bad_pixels.h"

#include <stdlib.h>

static const uint32_t streams = 0x3f000000u; /* does not overlap with the streams of other noise */

void bad_pixels_make(uint8_t *map, int width, int height, double share, double clustered, uint64_t seed,
                     uint32_t stream)
{
    const double begin = share / (1 + 4 * clustered); /* a cluster has 1 + 8 / 2 pixels on average */
    memset(map, PIXEL_GOOD, (size_t)width * (size_t)height);
    if (!(share > 0)) return;
    for (int r = 0; r < height; r++)
        for (int c = 0; c < width; c++) {
            const uint64_t at = (uint64_t)r << 32 | (uint32_t)c;
            if (!(random_uniform(seed, streams + 4 * stream, 0, at) < begin)) continue;
            const double  lot  = random_uniform(seed, streams + 4 * stream, 1, at);
            const uint8_t kind = lot < 0.5 ? PIXEL_DEAD : lot < 0.75 ? PIXEL_HOT : PIXEL_BLINKING;
            map[(size_t)r * (size_t)width + (size_t)c] = kind;
            if (!(random_uniform(seed, streams + 4 * stream, 2, at) < clustered)) continue;
            uint32_t sides[4];
            const uint32_t counter[4] = {(uint32_t)c, (uint32_t)r, 3, streams + 4 * stream};
            const uint32_t key[2]     = {(uint32_t)seed, (uint32_t)(seed >> 32)};
            random_u32x4(sides, counter, key);
            for (int k = 0; k < 9; k++) {
                const int y = r + k / 3 - 1, x = c + k % 3 - 1;
                if (k != 4 && sides[0] >> k & 1 && y >= 0 && y < height && x >= 0 && x < width)
                    map[(size_t)y * (size_t)width + (size_t)x] = kind;
            }
        }
}

void bad_pixels_insert(uint16_t *count, const uint8_t *map, int width, int height, uint16_t full, uint64_t seed,
                     uint32_t stream, int frame)
{
    const size_t pixels = (size_t)width * (size_t)height;
    for (size_t i = 0; i < pixels; i++) {
        if (map[i] == PIXEL_GOOD) continue;
        if (map[i] == PIXEL_DEAD)
            count[i] = 0;
        else if (map[i] == PIXEL_HOT || random_uniform(seed, streams + 4 * stream + 1, (uint32_t)frame / 8, i) < 0.5)
            count[i] = full;
    }
}

void bad_pixels_replace(uint16_t *count, const uint8_t *map, int width, int height)
{
    for (int r = 0; r < height; r++)
        for (int c = 0; c < width; c++) {
            if (map[(size_t)r * (size_t)width + (size_t)c] == PIXEL_GOOD) continue;
            for (int ring = 1; ring <= 8; ring++) {
                uint32_t sum = 0, good = 0;
                for (int y = r - ring; y <= r + ring; y++)
                    for (int x = c - ring; x <= c + ring; x++) {
                        if (y < 0 || y >= height || x < 0 || x >= width) continue;
                        if (abs(y - r) != ring && abs(x - c) != ring) continue;
                        const size_t i = (size_t)y * (size_t)width + (size_t)x;
                        if (map[i] != PIXEL_GOOD) continue;
                        sum += count[i];
                        good++;
                    }
                if (good == 0) continue;
                count[(size_t)r * (size_t)width + (size_t)c] = (uint16_t)((sum + good / 2) / good);
                break;
            }
        }
}
