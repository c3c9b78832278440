/* sensor/commands/contact_sheet.h: manifest.html: a thumbnail of each variant of a sweep, its bands side by side, and its
 * settings. Written as variants end; the page appears when whole. */
#ifndef SENSOR_COMMANDS_CONTACT_SHEET_H
#define SENSOR_COMMANDS_CONTACT_SHEET_H

#include "pitviper.h"

enum { sheet_inside = 400 }; /* so many pictures are in the page itself, the rest beside it: a page of some 30 MB */

typedef struct ContactSheet {
    FILE *page;
    char  path[4300];
    int   shown;
} ContactSheet;

/* out: folder of the sweep. */
Status sheet_begin(ContactSheet *sheet, const char *out, const char *title);
/* Makes OUT/folder/thumbnail.png of the displays of this frame; without any, words stand alone. text: lines below it,
 * the first in bold; bad: they say why there is no more. */
void   sheet_add(ContactSheet *sheet, const char *out, const char *folder, int frame, const char *text, bool bad);
/* STATUS_IO, logged. */
Status sheet_end(ContactSheet *sheet);

#endif
