/* sensor/publish/images/picture_text.c: words and boxes in pictures; the shapes of the letters are those of a font, by
 * OpenImageIO. */
#include "sensor/publish/images/picture_text.h"
#include "sensor/publish/images/image_file.h"

#include <pthread.h>
#include <stdlib.h>

/* Of a letter, in dots: its cell, and where it stands in it. */
enum { cell_wide = 6, cell_high = 10, cell_base = 8, font_size = 9, times_most = 8 };

/* Printable ASCII, as shares of 255 that each pixel is covered: [letter][cell_high x times][cell_wide x times]; NULL:
 * not made, or there is no font. They are made once for each size, and stay. */
static struct {
    uint8_t *cover;
    bool     tried;
} letters[times_most + 1];

static const uint8_t *letters_of(int times)
{
    static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    pthread_mutex_lock(&mutex);
    if (!letters[times].tried) {
        const int wide = cell_wide * times, high = cell_high * times;
        letters[times].tried = true;
        letters[times].cover = calloc(image_letter_count, (size_t)wide * (size_t)high);
        if (!letters[times].cover ||
            image_letters(letters[times].cover, wide, high, cell_base * times, font_size * times) != STATUS_OK) {
            log_warn(
                "pictures: they have no words, as there is no font DejaVuSansMono.ttf; next: apt-get install fonts-dejavu-core, "
                "or name its folder in OPENIMAGEIO_FONTS");
            free(letters[times].cover);
            letters[times].cover = NULL;
        }
    }
    pthread_mutex_unlock(&mutex);
    return letters[times].cover;
}

/* white: share of 255 */
static void dot(const Drawing *d, int x, int y, int white)
{
    if (x < d->left || y < 0 || x >= d->right || y >= d->height) return;
    const size_t at = ((size_t)y * (size_t)d->width + (size_t)x) * (size_t)d->planes;
    const int    value = (d->full * white + 127) / 255;
    for (int p = 0; p < d->planes; p++)
        if (d->wide) ((uint16_t *)d->pixels)[at + (size_t)p] = (uint16_t)value;
        else ((uint8_t *)d->pixels)[at + (size_t)p] = (uint8_t)value;
}

void picture_text_draw(const Drawing *d, int x, int y, int times, const char *text)
{
    times = times < 1 ? 1 : times > times_most ? times_most : times;
    const int      wide = cell_wide * times, high = cell_high * times, top = y + (7 - cell_base) * times;
    const uint8_t *cover = letters_of(times);
    if (!cover) return;
    for (int v = 0; v < high; v++)
        for (int u = -times; u < 0; u++) dot(d, x + u, top + v, 0);
    for (int i = 0; text[i]; i++) {
        const int      letter = text[i] >= ' ' && text[i] <= '~' ? text[i] - ' ' : '?' - ' ';
        const uint8_t *at = cover + (size_t)letter * (size_t)wide * (size_t)high;
        for (int v = 0; v < high; v++)
            for (int u = 0; u < wide; u++) dot(d, x + wide * i + u, top + v, at[v * wide + u]);
    }
}

void picture_text_write(uint8_t *rgb, int width, int height, int x, int y, const char *text)
{
    picture_text_draw(&(Drawing){rgb, width, height, 3, false, 255, 0, width}, x, y, 2, text);
}

void picture_text_box(const Drawing *d, const int box[4])
{
    for (int out = 2; out >= 1; out--) { /* black first */
        const int white = out == 1 ? 255 : 0;
        for (int x = box[0] - out; x < box[2] + out; x++) {
            dot(d, x, box[1] - out, white);
            dot(d, x, box[3] + out - 1, white);
        }
        for (int y = box[1] - out; y < box[3] + out; y++) {
            dot(d, box[0] - out, y, white);
            dot(d, box[2] + out - 1, y, white);
        }
    }
}
