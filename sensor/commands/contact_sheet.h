/* sensor/commands/contact_sheet.h: manifest.html: a thumbnail of each variant of a sweep, its bands side by side, and
 * its settings. Written as variants end; renamed into place when complete. */
#ifndef SENSOR_COMMANDS_CONTACT_SHEET_H
#define SENSOR_COMMANDS_CONTACT_SHEET_H

#include "pitviper.h"

enum { sheet_inside = 400 }; /* most thumbnails embedded in the page (some 30 MB); the others are linked */

typedef struct ContactSheet {
    FILE *page;
    char  path[4300];
    int   shown;
} ContactSheet;

/* out: folder of the sweep. */
Status sheet_begin(ContactSheet *sheet, const char *out, const char *title);
/* Makes OUT/folder/thumbnail.png from the display images of this frame; without any, text only. text: lines below it,
 * the first in bold; bad: the reason of a failure. */
void   sheet_add(ContactSheet *sheet, const char *out, const char *folder, int frame, const char *text, bool bad);
/* STATUS_IO, logged. */
Status sheet_end(ContactSheet *sheet);

#endif
