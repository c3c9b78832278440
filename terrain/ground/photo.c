/* terrain/ground/photo.c: a photograph's pixels to blocks of 4 x 4, their mips, and the light at a place. */
#include "terrain/ground/ground_image.h"

#include <pthread.h>
#include <stdlib.h>

/* ---- sRGB -------------------------------------------------------------------------------------- */

/* IEC 61966-2-1. */
static double linear_of(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

static double encoded_of(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

enum { sixths = 6, sums = 255 * sixths + 1 };

static float          linear_of_sum[sums]; /* by the sum of six octets: every mixture of a block's two colours is one */
static uint8_t        encoded_of_linear[4096]; /* finer than the steps of octets where these are finest */
static pthread_once_t tables_once = PTHREAD_ONCE_INIT;

static void make_tables(void)
{
    for (int k = 0; k < sums; k++) linear_of_sum[k] = (float)linear_of(k / (255.0 * sixths));
    for (int k = 0; k < 4096; k++) encoded_of_linear[k] = (uint8_t)lrint(255 * encoded_of(k / 4095.0));
}

float photo_linear(uint8_t encoded)
{
    pthread_once(&tables_once, make_tables);
    return linear_of_sum[sixths * encoded];
}

uint8_t photo_encoded(float linear)
{
    pthread_once(&tables_once, make_tables);
    return encoded_of_linear[(int)(4095 * linear + 0.5f)];
}

/* ---- mips -------------------------------------------------------------------------------------- */

int photo_mips(int nx[ground_image_mips], int ny[ground_image_mips])
{
    int k = 0;
    for (; k < ground_image_mips - 1 && (nx[k] > 1 || ny[k] > 1); k++) {
        nx[k + 1] = (nx[k] + 1) / 2;
        ny[k + 1] = (ny[k] + 1) / 2;
    }
    return k + 1;
}

void photo_halve_row(uint8_t *out, const uint8_t *south, const uint8_t *north, int nx)
{
    pthread_once(&tables_once, make_tables);
    for (int i = 0; i < (nx + 1) / 2; i++) {
        float sum[3] = {0}, cover = 0;
        for (int n = 0; n < 4; n++) {
            const int      a = 2 * i + (n & 1);
            const uint8_t *row = n >> 1 ? north : south;
            if (a >= nx || !row) continue;
            const uint8_t *from = row + 4 * (size_t)a;
            for (int c = 0; c < 3; c++) sum[c] += from[3] * linear_of_sum[sixths * from[c]];
            cover += from[3];
        }
        uint8_t *to = out + 4 * (size_t)i;
        for (int c = 0; c < 3; c++) to[c] = cover > 0 ? encoded_of_linear[(int)(4095 * sum[c] / cover + 0.5f)] : 0;
        to[3] = (uint8_t)(cover / 4 + 0.5f);
    }
}

/* ---- to blocks --------------------------------------------------------------------------------- */

static uint16_t packed(const float colour[3])
{
    static const float most[3] = {31, 63, 31};
    int                part[3];
    for (int c = 0; c < 3; c++) {
        const float v = colour[c] * most[c] * (1 / 255.0f);
        part[c] = (int)((v > 0 ? v < most[c] ? v : most[c] : 0) + 0.5f);
    }
    return (uint16_t)(part[0] << 11 | part[1] << 5 | part[2]);
}

static inline void unpacked(int colour[3], uint16_t packed565)
{
    const int r = packed565 >> 11, g = packed565 >> 5 & 63, b = packed565 & 31;
    colour[0] = r << 3 | r >> 2;
    colour[1] = g << 2 | g >> 4;
    colour[2] = b << 3 | b >> 2;
}

/* Share of the first colour in sixths; the rest is that of the second. By mode: four colours, or three and "not
 * covered". */
static const uint8_t first_sixths[2][4] = {{6, 0, 4, 2}, {6, 0, 3, 0}};

typedef struct Pixels {
    int     count;        /* covered */
    float   value[3][16]; /* red, green and blue of each pixel */
    uint8_t place[16];
} Pixels;

/* Chooses the nearest of a block's colours for each pixel; returns the sum of the squared errors. */
static float choose(PhotoBlock *block, const Pixels *px, bool holes)
{
    int end[2][3];
    if (holes != (block->first <= block->second)) {
        const uint16_t swapped = block->first;
        block->first = block->second;
        block->second = swapped;
    }
    const bool three = block->first <= block->second; /* when both are equal there is one colour */
    unpacked(end[0], block->first);
    unpacked(end[1], block->second);
    float colour[4][3], sum = 0;
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++) {
            const int w = first_sixths[three][k];
            colour[k][c] = (float)(w * end[0][c] + (sixths - w) * end[1][c]) * (1.0f / sixths);
        }
    /* all sixteen are computed at once; those that are not covered are ignored below */
    float    least[16];
    uint32_t best[16];
    for (int n = 0; n < 16; n++) {
        least[n] = INFINITY;
        best[n] = 0;
    }
    for (uint32_t k = 0; k < (three ? 3u : 4u); k++)
        for (int n = 0; n < 16; n++) {
            const float r = px->value[0][n] - colour[k][0], g = px->value[1][n] - colour[k][1],
                        b = px->value[2][n] - colour[k][2], d2 = r * r + g * g + b * b;
            best[n] = d2 < least[n] ? k : best[n];
            least[n] = d2 < least[n] ? d2 : least[n];
        }
    block->index = 0xffffffff; /* all pixels are not covered, unless set below */
    for (int n = 0; n < px->count; n++) {
        sum += least[n];
        block->index &= ~((3u ^ best[n]) << 2 * px->place[n]);
    }
    return sum;
}

/* Finds the ends of the pixels along their axis of most variance, which is found by powers of the covariance. */
static void ends_of(float end[2][3], const Pixels *px)
{
    float mean[3] = {0}, cov[3][3] = {{0}}, axis[3];
    for (int n = 0; n < 16 && px->count == 16;
         n++) /* a multiplication instead of a division: exact, as sixteen is a power of two */
        for (int c = 0; c < 3; c++) mean[c] += px->value[c][n] * (1.0f / 16);
    for (int n = 0; n < px->count && px->count < 16; n++)
        for (int c = 0; c < 3; c++) mean[c] += px->value[c][n] / (float)px->count;
    for (int n = 0; n < px->count; n++) {
        const float r = px->value[0][n] - mean[0], g = px->value[1][n] - mean[1], b = px->value[2][n] - mean[2];
        cov[0][0] += r * r;
        cov[1][1] += g * g;
        cov[2][2] += b * b;
        cov[0][1] += r * g;
        cov[0][2] += r * b;
        cov[1][2] += g * b;
    }
    cov[1][0] = cov[0][1];
    cov[2][0] = cov[0][2];
    cov[2][1] = cov[1][2];
    int widest = 1;
    for (int c = 0; c < 3; c++) widest = cov[c][c] > cov[widest][widest] ? c : widest;
    for (int c = 0; c < 3; c++) axis[c] = cov[widest][c];
    for (int round = 0; round < 4; round++) {
        float next[3], longest = 0;
        for (int a = 0; a < 3; a++) {
            next[a] = cov[a][0] * axis[0] + cov[a][1] * axis[1] + cov[a][2] * axis[2];
            longest = fabsf(next[a]) > longest ? fabsf(next[a]) : longest;
        }
        if (!(longest > 0)) break;
        for (int a = 0; a < 3; a++) axis[a] = next[a] / longest;
    }
    const float length2 = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
    float       low = 0, high = 0;
    for (int n = 0; n < px->count && length2 > 0; n++) {
        float t = 0;
        for (int c = 0; c < 3; c++) t += (px->value[c][n] - mean[c]) * axis[c];
        low = t < low ? t : low;
        high = t > high ? t : high;
    }
    if (length2 > 0) {
        low /= length2;
        high /= length2;
    }
    for (int c = 0; c < 3; c++) {
        end[0][c] = mean[c] + high * axis[c];
        end[1][c] = mean[c] + low * axis[c];
    }
}

/* Fits the two colours to the pixels' indices by least squares; returns false when only one colour is used. */
static bool refine(float end[2][3], const PhotoBlock *block, const Pixels *px)
{
    const bool three = block->first <= block->second;
    float      aa = 0, ab = 0, bb = 0, ax[3] = {0}, bx[3] = {0};
    for (int n = 0; n < px->count; n++) {
        const float a = (float)first_sixths[three][block->index >> 2 * px->place[n] & 3] * (1.0f / sixths), b = 1 - a;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        for (int c = 0; c < 3; c++) {
            ax[c] += a * px->value[c][n];
            bx[c] += b * px->value[c][n];
        }
    }
    const float det = aa * bb - ab * ab;
    if (!(det > 1e-3f)) return false;
    for (int c = 0; c < 3; c++) {
        end[0][c] = (ax[c] * bb - bx[c] * ab) / det;
        end[1][c] = (bx[c] * aa - ax[c] * ab) / det;
    }
    return true;
}

/* The two colours for pixels that all have one colour: the best mixture for that octet, two thirds of one step and one
 * third of another. */
static void even_ends(float end[2][3], const float colour[3])
{
    static const int most[3] = {31, 63, 31};
    for (int c = 0; c < 3; c++) {
        const int near = (int)(colour[c] * (float)most[c] / 255);
        float     least = INFINITY;
        for (int a = near > 0 ? near - 1 : 0; a <= near + 2 && a <= most[c]; a++)
            for (int b = near > 0 ? near - 1 : 0; b <= near + 2 && b <= most[c]; b++) {
                const int   shift = c == 1 ? 2 : 3, back = c == 1 ? 4 : 2;
                const float mixed = (2.0f * (float)(a << shift | a >> back) + (float)(b << shift | b >> back)) / 3;
                const float off = fabsf(mixed - colour[c]);
                if (off >= least) continue;
                least = off;
                end[0][c] = (float)a * 255 / (float)most[c];
                end[1][c] = (float)b * 255 / (float)most[c];
            }
    }
}

PhotoBlock photo_block(const uint8_t rgba[16][4])
{
    Pixels px = {0};
    bool   even = true;
    for (int n = 0; n < 16; n++) {
        if (rgba[n][3] < 128) continue;
        for (int c = 0; c < 3; c++) {
            px.value[c][px.count] = rgba[n][c];
            even &= px.value[c][px.count] == px.value[c][0];
        }
        px.place[px.count++] = (uint8_t)n;
    }
    const bool holes = px.count < 16;
    PhotoBlock best = {0, 0, 0xffffffff};
    if (px.count == 0) return best;
    float       end[2][3];
    const float first[3] = {px.value[0][0], px.value[1][0], px.value[2][0]};
    if (even && !holes) even_ends(end, first);
    else ends_of(end, &px);
    best = (PhotoBlock){packed(end[0]), packed(end[1]), 0};
    float least = choose(&best, &px, holes);
    for (int round = 0; round < 2 && least > 0 && refine(end, &best, &px); round++) {
        PhotoBlock  next = {packed(end[0]), packed(end[1]), 0};
        const float left = choose(&next, &px, holes);
        if (!(left < least)) break;
        least = left;
        best = next;
    }
    return best;
}

void photo_block_row(PhotoBlock *out, const uint8_t *rgba, int nx, int rows)
{
    uint8_t cell[16][4];
    for (int i0 = 0; i0 < nx; i0 += 4) {
        for (int n = 0; n < 16; n++) {
            const int i = i0 + n % 4 < nx ? i0 + n % 4 : nx - 1, j = n / 4 < rows ? n / 4 : rows - 1;
            memcpy(cell[n], rgba + 4 * ((size_t)j * (size_t)nx + (size_t)i), 4);
        }
        out[i0 / 4] = photo_block((const uint8_t(*)[4])cell);
    }
}

/* ---- light at a place ---------------------------------------------------------------------------- */

/* Sum of the four pixels about a place of mip k, given in its pixels. They are premultiplied by coverage, so that what
 * lies beyond the rim does not darken it. */
static void mip_at(double sum[4], const Photo *p, int k, double x, double y, double share)
{
    const int    nx = p->nx[k], ny = p->ny[k];
    const size_t across = photo_blocks_across(nx);
    x -= 0.5;
    y -= 0.5;
    const double fx = floor(x), fy = floor(y), u = x - fx, v = y - fy;
    if (!(fx >= -1 && fy >= -1 && fx < nx && fy < ny)) return;
    const PhotoBlock *last = NULL;
    int               end[2][3] = {{0}};
    bool              three = false;
    for (int n = 0; n < 4; n++) {
        const int a = (int)fx + (n & 1), b = (int)fy + (n >> 1);
        if (a < 0 || b < 0 || a >= nx || b >= ny) continue;
        const PhotoBlock *block = p->block[k] + (size_t)(b >> 2) * across + (size_t)(a >> 2);
        if (block != last) {
            last = block;
            three = block->first <= block->second;
            unpacked(end[0], block->first);
            unpacked(end[1], block->second);
        }
        const uint32_t index = block->index >> (2 * ((b & 3) * 4 + (a & 3))) & 3;
        if (three && index == 3) continue;
        const int    w = first_sixths[three][index];
        const double weight = share * (n & 1 ? u : 1 - u) * (n >> 1 ? v : 1 - v);
        for (int c = 0; c < 3; c++) sum[c] += weight * (double)linear_of_sum[w * end[0][c] + (sixths - w) * end[1][c]];
        sum[3] += weight;
    }
}

double photo_cover_at(const Photo *photo, double x_m, double y_m)
{
    if (photo->mips == 0) return 0;
    const double x = (x_m - photo->x0_m) / photo->cell_m - 0.5, y = (y_m - photo->y0_m) / photo->cell_m - 0.5;
    const double fx = floor(x), fy = floor(y), u = x - fx, v = y - fy;
    const int    nx = photo->nx[0], ny = photo->ny[0];
    double       sum = 0;
    if (!(fx >= -1 && fy >= -1 && fx < nx && fy < ny)) return 0;
    for (int n = 0; n < 4; n++) {
        const int a = (int)fx + (n & 1), b = (int)fy + (n >> 1);
        if (a < 0 || b < 0 || a >= nx || b >= ny) continue;
        const PhotoBlock *block = photo->block[0] + (size_t)(b >> 2) * photo_blocks_across(nx) + (size_t)(a >> 2);
        const uint32_t    index = block->index >> (2 * ((b & 3) * 4 + (a & 3))) & 3;
        sum += block->first <= block->second && index == 3 ? 0 : (n & 1 ? u : 1 - u) * (n >> 1 ? v : 1 - v);
    }
    return fmin(sum, 1);
}

double photo_at(double linear[photo_channels], const Photo *photo, double x_m, double y_m, double footprint_m)
{
    double sum[4] = {0};
    if (photo->mips == 0) return 0;
    const double x = (x_m - photo->x0_m) / photo->cell_m, y = (y_m - photo->y0_m) / photo->cell_m;
    if (!(x > -1 && y > -1 && x < photo->nx[0] + 1 && y < photo->ny[0] + 1)) return 0;
    pthread_once(&tables_once, make_tables);
    const double mip = clamp(log2(fmax(footprint_m / photo->cell_m, 1)), 0, photo->mips - 1);
    const int    k = (int)mip;
    const double between = mip - k, s = exp2(-k);
    mip_at(sum, photo, k, x * s, y * s, 1 - between);
    if (between > 0) mip_at(sum, photo, k + 1, 0.5 * x * s, 0.5 * y * s, between);
    if (!(sum[3] > 0)) return 0;
    for (int c = 0; c < photo_channels; c++) linear[c] = sum[c] / sum[3];
    return fmin(sum[3], 1);
}

void photo_free(Photo *photo)
{
    for (int k = 0; k < ground_image_mips && !photo->borrowed; k++) free(photo->block[k]);
    *photo = (Photo){0};
}
