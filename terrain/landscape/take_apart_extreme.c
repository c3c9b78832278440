/* terrain/landscape/take_apart_extreme.c: least and greatest of a square about each value. */
#include "terrain/landscape/take_apart_private.h"

#include <float.h>
#include <stdlib.h>

enum { lanes = 32 }; /* columns at a time */

/* Extreme of [x, x + width) for each of count elements of `lane` floats; beyond them stand width - 1 neutral ones.
 * Windows double: O(log width) passes that vectorize. */
static void run_least(float *a, size_t count, size_t width, size_t lane)
{
    size_t w = 1;
    for (; 2 * w <= width; w *= 2)
#pragma GCC ivdep
        for (size_t i = 0; i < (count + width - 2 * w) * lane; i++)
            a[i] = a[i + w * lane] < a[i] ? a[i + w * lane] : a[i];
    if (w == width) return;
#pragma GCC ivdep
    for (size_t i = 0; i < count * lane; i++) {
        const float b = a[i + (width - w) * lane];
        a[i] = b < a[i] ? b : a[i];
    }
}

Status take_apart_extreme(float *value, int nx, int ny, int radius, bool greatest)
{
    const size_t r = (size_t)radius, width = 2 * r + 1, n = (size_t)nx, m = (size_t)ny;
    const float  sign = greatest ? -1 : 1;
    if (radius <= 0) return STATUS_OK;
    const size_t row = n + 2 * r, strip = (m + 2 * r) * lanes;
    float *buffer = malloc((row > strip ? row : strip) * sizeof *buffer);
    if (!buffer) return STATUS_NO_MEMORY;

    for (size_t y = 0; y < m; y++) {
        for (size_t x = 0; x < r; x++) buffer[x] = buffer[n + r + x] = FLT_MAX;
        for (size_t x = 0; x < n; x++) buffer[r + x] = sign * value[y * n + x];
        run_least(buffer, n, width, 1);
        memcpy(value + y * n, buffer, n * sizeof *value);
    }
    for (size_t x0 = 0; x0 < n; x0 += lanes) {
        const size_t some = n - x0 < lanes ? n - x0 : lanes;
        for (size_t i = 0; i < r * lanes; i++) buffer[i] = buffer[(m + r) * lanes + i] = FLT_MAX;
        for (size_t y = 0; y < m; y++)
            for (size_t x = 0; x < lanes; x++)
                buffer[(r + y) * lanes + x] = x < some ? value[y * n + x0 + x] : FLT_MAX;
        run_least(buffer, m, width, lanes);
        for (size_t y = 0; y < m; y++)
            for (size_t x = 0; x < some; x++) value[y * n + x0 + x] = sign * buffer[y * lanes + x];
    }
    free(buffer);
    return STATUS_OK;
}
