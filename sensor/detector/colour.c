/* sensor/detector/colour.c: white balance and the matrix from three rectangular bands to linear sRGB. */
#include "sensor/detector/colour.h"

static const double matrix[3][3] = {
    {1.0174, 0.1380, -0.1554}, {-0.1259, 1.1569, -0.0310}, {-0.0079, -0.1236, 1.1315}};

static const double luminance[3] = {0.2126, 0.7152, 0.0722}; /* of the primaries, ITU-R BT.709 */

void display_colour(DisplayColour *out, const double white[3], double zero, double full)
{
    *out = (DisplayColour){.zero = zero, .gain = {1, 1, 1}, .white = 0, .most = full};
    const double mean = (white[0] + white[1] + white[2]) / 3;
    if (!(white[0] > 0 && white[1] > 0 && white[2] > 0 && mean < INFINITY)) return;
    out->white = mean;
    out->most  = INFINITY;
    for (int c = 0; c < 3; c++) {
        out->gain[c] = mean / white[c];
        out->most    = fmin(out->most, out->gain[c] * full);
    }
}

/* No call to a library in the loop over pixels, as fmin is one. */
static inline double least_of(double a, double b) { return a < b ? a : b; }

void display_colour_apply(float *const out[3], const float *const in[3], size_t count, const DisplayColour *colour)
{
    for (size_t i = 0; i < count; i++) {
        const double seen[3] = {in[0][i], in[1][i], in[2][i]};
        double       balanced[3], rgb[3];
        if (!isfinite(seen[0] + seen[1] + seen[2])) {
            for (int c = 0; c < 3; c++) out[c][i] = (float)seen[c];
            continue;
        }
        for (int c = 0; c < 3; c++) balanced[c] = least_of((seen[c] - colour->zero) * colour->gain[c], colour->most);
        for (int c = 0; c < 3; c++)
            rgb[c] = matrix[c][0] * balanced[0] + matrix[c][1] * balanced[1] + matrix[c][2] * balanced[2];
        const double grey  = luminance[0] * rgb[0] + luminance[1] * rgb[1] + luminance[2] * rgb[2];
        const double least = least_of(least_of(rgb[0], rgb[1]), rgb[2]);
        const double share = grey > 0 && least < 0 ? grey / (grey - least) : 1;
        for (int c = 0; c < 3; c++)
            out[c][i] = (float)(colour->zero + (share < 1 ? grey + share * (rgb[c] - grey) : rgb[c]));
    }
}
