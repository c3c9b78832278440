/* tests/terrain/test_photo.c: a photograph's blocks of 4 x 4 pixels: what they lose, coverage, mips. */
#include "tests/check.h"

#include "terrain/ground/ground_image.h"

enum { side = 128 };

/* Sixteen of these at a time, as the codec takes them. */
static PhotoBlock block_of(const uint8_t *rgba, int i0, int j0)
{
    uint8_t cell[16][4];
    for (int n = 0; n < 16; n++) memcpy(cell[n], rgba + 4 * ((j0 + n / 4) * side + i0 + n % 4), 4);
    return photo_block((const uint8_t(*)[4])cell);
}

/* The pixel as an octet, as photo_at sees it: at its centre, without the next mip. */
static bool pixel(uint8_t out[3], const Photo *p, int i, int j)
{
    double linear[photo_channels];
    if (!(photo_at(linear, p, p->x0_m + i + 0.5, p->y0_m + j + 0.5, 1) > 0)) return false;
    for (int c = 0; c < 3; c++) out[c] = photo_encoded((float)linear[c]);
    return true;
}

typedef struct Loss {
    double rms, mean, worst;
} Loss;

static Loss loss_of(const uint8_t *rgba)
{
    static PhotoBlock block[side / 4 * side / 4];
    const Photo p = {.mips = 1, .nx = {side}, .ny = {side}, .x0_m = -7, .y0_m = 11, .cell_m = 1, .block = {block}};
    Loss        loss = {0};
    for (int j = 0; j < side; j += 4)
        for (int i = 0; i < side; i += 4) block[j / 4 * (side / 4) + i / 4] = block_of(rgba, i, j);
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            uint8_t got[3];
            CHECK(pixel(got, &p, i, j));
            for (int c = 0; c < 3; c++) {
                const double off = got[c] - rgba[4 * (j * side + i) + c];
                loss.rms += off * off;
                loss.mean += off;
                loss.worst = fmax(loss.worst, fabs(off));
            }
        }
    loss.rms = sqrt(loss.rms / (3.0 * side * side));
    loss.mean /= 3.0 * side * side;
    return loss;
}

static uint8_t octet(double x) { return (uint8_t)lrint(clamp(x, 0, 255)); }

/* kind 0: even; 1: grey noise about a slow gradient, as grass; 2: fields of two hues with a sharp border and some
 * noise; 3: every channel by itself, which no line through the colours fits. */
static void paint(uint8_t *rgba, int kind, double noise)
{
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) {
            const uint64_t at = (uint64_t)(j * side + i);
            const double   n = noise * random_normal(7, 1, 0, at);
            double         v[3] = {97, 111, 64};
            if (kind == 1)
                for (int c = 0; c < 3; c++) v[c] = (0.7 + 0.6 * i / side) * v[c] + n;
            if (kind == 2 && i + j / 3 > 60) v[0] = 160, v[1] = 120, v[2] = 90;
            for (int c = 0; c < 3 && kind >= 2; c++)
                v[c] += kind == 2 ? n : noise * random_normal(7, 2 + (uint32_t)c, 0, at);
            for (int c = 0; c < 3; c++) rgba[4 * at + (size_t)c] = octet(v[c]);
            rgba[4 * at + 3] = 255;
        }
}

/* The stated errors, in levels of 255. Five bits alone leave 2.4 rms in red and blue. */
static void what_blocks_lose_is_as_stated(void **state)
{
    (void)state;
    static const struct {
        int    kind;
        double noise, rms, worst;
    } of[] = {{0, 0, 1, 1}, {1, 8, 2.9, 12}, {2, 5, 2.5, 45}, {3, 8, 6, 30}};
    static uint8_t rgba[4 * side * side];
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        paint(rgba, of[k].kind, of[k].noise);
        const Loss loss = loss_of(rgba);
        printf("kind %d, noise %g: rms %.2f, mean %+.2f, worst %.0f of 255\n", of[k].kind, of[k].noise, loss.rms,
               loss.mean, loss.worst);
        CHECK(loss.rms <= of[k].rms && loss.worst <= of[k].worst && fabs(loss.mean) <= 1);
    }
    for (int v = 0; v < 256; v++) { /* every even grey */
        for (size_t n = 0; n < sizeof rgba; n++) rgba[n] = n % 4 == 3 ? 255 : (uint8_t)v;
        CHECK(loss_of(rgba).worst <= 2);
    }
}

static void pixels_that_are_not_covered_stay_so(void **state)
{
    (void)state;
    uint8_t cell[16][4];
    for (unsigned holes = 0; holes < 1 << 16; holes += 97) {
        for (int n = 0; n < 16; n++) {
            cell[n][0] = (uint8_t)(100 + 9 * n), cell[n][1] = (uint8_t)(200 - 7 * n), cell[n][2] = (uint8_t)(5 * n);
            cell[n][3] = holes >> n & 1 ? 0 : 255;
        }
        PhotoBlock  block = photo_block((const uint8_t(*)[4])cell);
        const Photo p = {.mips = 1, .nx = {4}, .ny = {4}, .cell_m = 1, .block = {&block}};
        for (int n = 0; n < 16; n++) {
            uint8_t got[3];
            CHECK(pixel(got, &p, n % 4, n / 4) == !(holes >> n & 1));
            double       linear[photo_channels];
            const double x_m = n % 4 + 0.3, y_m = n / 4 + 0.9;
            CHECK(photo_cover_at(&p, x_m, y_m) == photo_at(linear, &p, x_m, y_m, 1));
        }
    }
}

/* Half of every two pixels is white: each mip is the mean of the light, not of the octets. */
static void mips_keep_the_light(void **state)
{
    (void)state;
    uint8_t row[2][4 * 9];
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 2; j++) {
            memset(&row[j][4 * i], (i + j) % 2 ? 255 : 0, 3);
            row[j][4 * i + 3] = 255;
        }
    uint8_t half[4 * 5];
    photo_halve_row(half, row[0], row[1], 9);
    for (int i = 0; i < 4; i++) CHECK_NEAR(half[4 * i], 188, 1); /* IEC 61966-2-1 of 0.5: 187.5 */
    CHECK(half[3] == 255 && half[4 * 4 + 3] == 128);             /* the last has two of four */
    int nx[ground_image_mips] = {9}, ny[ground_image_mips] = {3};
    CHECK(photo_mips(nx, ny) == 5 && nx[4] == 1 && ny[4] == 1 && nx[1] == 5 && ny[1] == 2);
}

/* Half an octet a pixel, and a third more for the mips, at sizes that no block divides too. */
static void the_storage_is_as_stated(void **state)
{
    (void)state;
    static const int size[][2] = {{12000, 16000}, {1004, 1390}, {12001, 15999}};
    for (size_t k = 0; k < sizeof size / sizeof *size; k++) {
        Photo p = {.nx = {size[k][0]}, .ny = {size[k][1]}};
        p.mips = photo_mips(p.nx, p.ny);
        size_t octets = 0;
        for (int m = 0; m < p.mips; m++) octets += photo_block_count(&p, m) * sizeof(PhotoBlock);
        CHECK_NEAR((double)octets / ((double)size[k][0] * size[k][1]), 2.0 / 3, 0.005);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_blocks_lose_is_as_stated),
        cmocka_unit_test(pixels_that_are_not_covered_stay_so),
        cmocka_unit_test(mips_keep_the_light),
        cmocka_unit_test(the_storage_is_as_stated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
