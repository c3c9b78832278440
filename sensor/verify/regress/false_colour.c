/* sensor/verify/regress/false_colour.c: planes as false-colour PNGs in an HTML page, with a colour scale. */
#include "sensor/verify/regress/regress_private.h"

#include "sensor/publish/files/html_page.h"

#include <stdlib.h>

enum { bar_width = 120, bar_height = 12 };

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

Scale false_colour_scale(const float *a, const float *b, size_t count)
{
    float *sorted = malloc(2 * count * sizeof *sorted);
    size_t n = 0;
    Scale  scale = {0, 1};
    for (size_t i = 0; sorted && i < 2 * count; i++) {
        const float v = i < count ? a[i] : b ? b[i - count] : NAN;
        if (isfinite(v)) sorted[n++] = v;
    }
    if (n > 0) {
        qsort(sorted, n, sizeof *sorted, compare_floats);
        scale.low = (double)sorted[(size_t)(0.005 * (double)(n - 1))];
        scale.high = (double)sorted[(size_t)(0.995 * (double)(n - 1))];
        const double least = 1e-6 * fabs(scale.high) + 1e-12;
        if (!(scale.high - scale.low > least)) {
            scale.low -= least;
            scale.high += least;
        }
    }
    free(sorted);
    return scale;
}

Scale false_colour_scale_of_difference(const float *difference, size_t count, double least)
{
    float *sorted = malloc(count * sizeof *sorted);
    size_t n = 0;
    double most = least > 0 ? least : 1e-12;
    for (size_t i = 0; sorted && i < count; i++)
        if (isfinite(difference[i]) && difference[i] != 0) sorted[n++] = fabsf(difference[i]);
    if (n > 0) {
        qsort(sorted, n, sizeof *sorted, compare_floats);
        most = fmax(most, (double)sorted[(size_t)(0.995 * (double)(n - 1))]);
    }
    free(sorted);
    return (Scale){-most, most};
}

/* Interpolates in a list of `count` evenly spaced colours. */
static void between(uint8_t out[3], const uint8_t colour[][3], int count, double t)
{
    const double at = clamp(t, 0, 1) * (count - 1);
    const int    i = at >= count - 1 ? count - 2 : (int)at;
    for (int k = 0; k < 3; k++) out[k] = (uint8_t)lround(colour[i][k] + (at - i) * (colour[i + 1][k] - colour[i][k]));
}

static void colour_of(uint8_t out[3], float value, Colours colours, Scale scale)
{
    /* dark blue, purple, orange, pale yellow: brightness rises steadily, so they can be told apart with colour
     * blindness */
    static const uint8_t heat[5][3] = {{8, 8, 40}, {84, 24, 110}, {182, 54, 84}, {246, 140, 40}, {252, 250, 190}};
    static const uint8_t sides[5][3] = {
        {10, 60, 160}, {120, 170, 225}, {250, 250, 250}, {235, 150, 110}, {165, 15, 30}};
    static const uint8_t not_finite[3] = {150, 60, 200};
    if (!isfinite(value)) {
        memcpy(out, not_finite, 3);
    } else if (colours == COLOURS_IDS) {
        uint32_t       hash[4];
        const uint32_t counter[4] = {(uint32_t)clamp((double)value, 0, 4294967295.0)}, key[2] = {7, 0};
        random_u32x4(hash, counter, key);
        for (int k = 0; k < 3; k++) out[k] = counter[0] ? (uint8_t)(70 + hash[k] % 180) : 20;
    } else {
        const double t = ((double)value - scale.low) / (scale.high - scale.low);
        if (colours == COLOURS_HEAT) between(out, heat, 5, t);
        else between(out, sides, 5, t);
    }
}

/* Display gamma. */
static uint8_t shown(float value, Scale scale)
{
    if (!isfinite(value)) return 128;
    return (uint8_t)lround(255 * pow(clamp(((double)value - scale.low) / (scale.high - scale.low), 0, 1), 1 / 2.2));
}

bool false_colour_picture(FILE *page, const FalseColour *p, int wanted_width, const char *scratch, const char *alt)
{
    const int    width = p->width, height = p->height, times = wanted_width / width > 1 ? wanted_width / width : 1;
    const size_t w = (size_t)width * (size_t)times, h = (size_t)height * (size_t)times;
    uint8_t     *rgb = malloc(3 * w * h);
    if (!rgb) return false;
    for (size_t y = 0; y < h; y++)
        for (size_t x = 0; x < w; x++) {
            const size_t from = y / (size_t)times * (size_t)width + x / (size_t)times;
            uint8_t     *to = rgb + 3 * (y * w + x);
            if (x % (size_t)times) memcpy(to, to - 3, 3);
            else if (p->planes == 3)
                for (int k = 0; k < 3; k++) to[k] = shown(p->plane[k][from], p->scale);
            else colour_of(to, p->plane[0][from], p->colours, p->scale);
        }
    const bool ok = html_png(page, rgb, (int)w, (int)h, 3, 8, scratch, alt);
    free(rgb);
    return ok;
}

bool false_colour_legend(FILE *page, Colours colours, Scale scale, const char *unit, const char *scratch)
{
    uint8_t rgb[3 * bar_width * bar_height];
    for (int y = 0; y < bar_height; y++)
        for (int x = 0; x < bar_width; x++) {
            const double t = (x + 0.5) / bar_width;
            colour_of(rgb + 3 * (y * bar_width + x), (float)(scale.low + t * (scale.high - scale.low)), colours, scale);
        }
    html_text(page, "%.4g ", scale.low);
    if (!html_png(page, rgb, bar_width, bar_height, 3, 8, scratch, "scale of colours")) return false;
    html_text(page, " %.4g%s%s", scale.high, *unit ? " " : "", unit);
    return true;
}
