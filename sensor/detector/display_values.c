/* sensor/detector/display_values.c: quantisation to raw counts and to display values; display colours. */
#include "sensor/detector/display_values.h"

#include <float.h>

void detector_counts(uint16_t *out, const float *in, size_t count, double step, uint16_t full)
{
    const double per = 1 / step;
    for (size_t i = 0; i < count; i++) {
        const double x = in[i] * per + 0.5; /* a comparison with NaN is false: it falls to 0 */
        out[i] = x >= 1 ? x < full ? (uint16_t)x : full : 0;
    }
}

/* ---- display ------------------------------------------------------------------------------ */

/* Encodes linear light 0 .. 1 as an sRGB code value 0 .. 1 (IEC 61966-2-1). */
static double srgb_encode(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

/* The curve as a table of 4096 intervals, linear between: within 1.2e-4 of the curve, a thirtieth of an 8-bit
 * step; monotone, since the curve is. */
enum { curve_intervals = 4096 };

/* Gain, level and curve of one display in one expression: code = curve(in * scale + shift) * full. */
typedef struct Display {
    double scale, shift, full;
    bool   gamma;
    float  curve[curve_intervals + 2];
} Display;

static void display_prepare(Display *d, const DetectorConfig *config, DetectorLevel level)
{
    const double span = level.high - level.low, middle = 0.5 * (level.low + level.high);
    d->scale = config->gain / span;
    d->shift = 0.5 - middle * d->scale + config->offset;
    d->full = config->bits == 16 ? 65535 : 255;
    d->gamma = config->display_gamma;
    for (int i = 0; d->gamma && i <= curve_intervals; i++)
        d->curve[i] = (float)srgb_encode((double)i / curve_intervals);
    d->curve[curve_intervals + 1] = 1; /* so that the end needs no branch */
}

/* x: of full scale. */
static inline double display_code(const Display *d, double x)
{
    /* written so that NaN falls to 0 at the first comparison */
    x = x > 0 ? x : 0;
    x = x < 1 ? x : 1;
    if (d->gamma) {
        const double at = x * curve_intervals;
        const int    i = (int)at;
        x = d->curve[i] + (at - i) * ((double)d->curve[i + 1] - d->curve[i]);
    }
    return x * d->full + 0.5;
}

static inline void display_write(void *out, size_t at, const Display *d, double x)
{
    if (d->full > 255) ((uint16_t *)out)[at] = (uint16_t)display_code(d, x);
    else ((uint8_t *)out)[at] = (uint8_t)display_code(d, x);
}

void detector_display(void *out, const float *in, size_t count, const DetectorConfig *config, DetectorLevel level)
{
    Display d;
    display_prepare(&d, config, level);
    if (d.gamma || d.full > 255) {
        for (size_t i = 0; i < count; i++) display_write(out, i, &d, in[i] * d.scale + d.shift);
        return;
    }
    /* a loop without a table or a choice uses vectors; a code is below 256, so it may be taken as an int */
    uint8_t     *grey = out;
    const double scale = d.scale, shift = d.shift;
    for (size_t i = 0; i < count; i++) {
        double x = in[i] * scale + shift;
        x = x > 0 ? x : 0;
        x = x < 1 ? x : 1;
        grey[i] = (uint8_t)(int)(x * 255 + 0.5);
    }
}

void detector_display_rgb(void *out, const float *const in[3], size_t count, const DetectorConfig *config,
                          DetectorLevel level)
{
    Display d;
    display_prepare(&d, config, level);
    for (size_t i = 0; i < count; i++) {
        const double mean = ((double)in[0][i] + in[1][i] + in[2][i]) / 3, lit = mean * d.scale + d.shift;
        const double shown = lit > 0 ? lit : 0;
        const bool   has_hue = mean > 0 && mean < INFINITY;
        /* beyond full scale the brightest channel is scaled down to full scale, and the others with it */
        const float  brighter = in[0][i] > in[1][i] ? in[0][i] : in[1][i];
        const double most = (brighter > in[2][i] ? brighter : in[2][i]) / mean;
        const double kept = has_hue && shown * most > 1 ? 1 / most : shown;
        for (size_t c = 0; c < 3; c++)
            display_write(out, 3 * i + c, &d, has_hue ? kept * (in[c][i] / mean) : in[c][i] * d.scale + d.shift);
    }
}

void detector_display_db(void *out, const float *power, size_t count, double dynamic_range_db, int bits)
{
    float brightest = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(power[i]) && power[i] > brightest) brightest = power[i];

    /* brightest 0: all black, and the division below is not used */
    const double full = bits == 16 ? 65535 : 255;
    const double per_max = brightest > 0 ? 1.0 / brightest : 0;
    const double least = brightest * pow(10, -0.1 * dynamic_range_db);
    for (size_t i = 0; i < count; i++) {
        double x = 0;
        if (isinf(power[i]) && power[i] > 0) x = 1;
        else if (power[i] > least && power[i] > 0) /* false for NaN; spares the logarithm of the dark ones */
            x = clamp(1 + 10 * log10(power[i] * per_max) / dynamic_range_db, 0, 1);
        if (bits == 16) ((uint16_t *)out)[i] = (uint16_t)(x * full + 0.5);
        else ((uint8_t *)out)[i] = (uint8_t)(x * full + 0.5);
    }
}

/* ---- colours: white balance, and from three rectangular bands to linear sRGB ---------------------- */

/* Of R, G, B, sqrt(R G), sqrt(G B), sqrt(R B); printed by etc/colour/make/correction.py. A row adds up to 1. */
static const double correction[3][6] = {
    {0.5116, -0.3195, 0.0982, 1.2456, -0.1550, -0.3809},
    {-0.0141, 1.2421, -0.0727, -0.2215, 0.0402, 0.0260},
    {-0.0213, -0.0468, 1.2395, -0.0022, -0.2667, 0.0975},
};

static const double luminance[3] = {0.2126, 0.7152, 0.0722}; /* of the primaries, ITU-R BT.709 */

void display_colour(DisplayColour *out, const double white[3], double zero, double full)
{
    *out = (DisplayColour){.zero = zero, .gain = {1, 1, 1}, .white = 0, .most = full};
    const double mean = (white[0] + white[1] + white[2]) / 3;
    if (!(white[0] > 0 && white[1] > 0 && white[2] > 0 && mean < INFINITY)) return;
    out->white = mean;
    out->most = INFINITY;
    for (int c = 0; c < 3; c++) {
        out->gain[c] = mean / white[c];
        out->most = fmin(out->most, out->gain[c] * full);
    }
}

/* No call to a library, no branch in the loop over pixels: it uses vectors. */
static inline double least_of(double a, double b) { return a < b ? a : b; }
static inline double most_of(double a, double b) { return a > b ? a : b; }

/* Of values below zero, which noise leaves in the dark, there is no root. */
static inline double root_of(double a, double b) { return sqrt(most_of(a, 0) * most_of(b, 0)); }

static inline double corrected(const double k[6], const double term[6])
{
    return k[0] * term[0] + k[1] * term[1] + k[2] * term[2] + k[3] * term[3] + k[4] * term[4] + k[5] * term[5];
}

void display_colour_apply(float *const out[3], const float *const in[3], size_t count, const DisplayColour *colour)
{
    enum { block = 256 };
    const DisplayColour of = *colour;
    for (size_t from = 0; from < count; from += block) {
        const size_t n = count - from < block ? count - from : block;
        float        shown[3][block];
        const float *restrict r = in[0] + from, *restrict g = in[1] + from, *restrict b = in[2] + from;
        for (size_t i = 0; i < n; i++) {
            const double red = r[i], green = g[i], blue = b[i];
            const bool   finite = fabs(red + green + blue) <= DBL_MAX;
            const double x = least_of((red - of.zero) * of.gain[0], of.most);
            const double y = least_of((green - of.zero) * of.gain[1], of.most);
            const double z = least_of((blue - of.zero) * of.gain[2], of.most);
            const double term[6] = {x, y, z, root_of(x, y), root_of(y, z), root_of(x, z)};
            const double rgb[3] = {corrected(correction[0], term), corrected(correction[1], term),
                                   corrected(correction[2], term)};
            const double grey = luminance[0] * rgb[0] + luminance[1] * rgb[1] + luminance[2] * rgb[2];
            const double least = least_of(least_of(rgb[0], rgb[1]), rgb[2]);
            const double mixed = grey / (grey - least);
            const bool   beyond = (grey > 0) & (least < 0);
            shown[0][i] = (float)(finite ? of.zero + (beyond ? grey + mixed * (rgb[0] - grey) : rgb[0]) : red);
            shown[1][i] = (float)(finite ? of.zero + (beyond ? grey + mixed * (rgb[1] - grey) : rgb[1]) : green);
            shown[2][i] = (float)(finite ? of.zero + (beyond ? grey + mixed * (rgb[2] - grey) : rgb[2]) : blue);
        }
        for (int c = 0; c < 3; c++) memcpy(out[c] + from, shown[c], n * sizeof *shown[c]);
    }
}
