/* sensor/publish/html.h: reports: a page that needs no other file. */
#ifndef SENSOR_PUBLISH_HTML_H
#define SENSOR_PUBLISH_HTML_H

#include "pitviper.h"

/* Opens path.part and writes the head, with the house's style; NULL, logged. What follows is written by fprintf as
 * markup, or by these. */
FILE  *html_begin(const char *path, const char *title);
/* Text as text: what would be markup is escaped. */
__attribute__((format(printf, 2, 3))) void html_text(FILE *page, const char *format, ...);
/* A picture inside the page. type: "png", "svg+xml". */
void   html_image(FILE *page, const char *type, const void *bytes, size_t count, const char *alt);
/* Ends the page and gives the file its name. STATUS_IO, logged, and no file, when anything of it could not be written.
 */
Status html_end(FILE *page, const char *path);

#endif
