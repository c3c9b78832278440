/* sensor/publish/files/html_page.h: reports: a page that needs no other file. */
#ifndef SENSOR_PUBLISH_FILES_HTML_PAGE_H
#define SENSOR_PUBLISH_FILES_HTML_PAGE_H

#include "pitviper.h"

/* Opens path.part and writes the head, with the common style; NULL, logged. The content is then written by fprintf
 * as markup, or by the functions below. */
FILE *html_begin(const char *path, const char *title);
/* The same with rules of its own behind the common style. */
FILE *html_begin_styled(const char *path, const char *title, const char *rules);
/* Plain text: markup characters are escaped. */
__attribute__((format(printf, 2, 3))) void html_text(FILE *page, const char *format, ...);
/* Embeds an image. type: "png" or "svg+xml". */
void html_image(FILE *page, const char *type, const void *bytes, size_t count, const char *alt);
/* Embeds samples as a PNG, as image_write_png takes them, through the file `scratch`, which is then gone. False, and
 * nothing of it is in the page, when it cannot be made. */
bool html_png(FILE *page, const void *values, int width, int height, int channels, int bits, const char *scratch,
              const char *alt);
/* Ends the page and renames the file into place. STATUS_IO, logged, and no file, when any part could not be written. */
Status html_end(FILE *page, const char *path);

#endif
