/* sensor/score/score_page_private.h: parts of the page of a report. */
#ifndef SENSOR_SCORE_SCORE_PAGE_PRIVATE_H
#define SENSOR_SCORE_SCORE_PAGE_PRIVATE_H

#include "sensor/publish/files/svg_plot.h"
#include "sensor/score/score_page.h"

extern const char *const page_colour[score_recognisers_max];
extern const char *const page_dashes[score_recognisers_max]; /* so that curves differ without colours, too */

/* A text from outside: what cannot be shown is escaped, then markup. */
void page_text(FILE *page, const char *text);
/* The stroke of a recogniser, and its name. */
void page_key(FILE *page, const ScoreReport *report, int recogniser);
/* Of all, in a line; nothing of a single one. */
void page_legend(FILE *page, const ScoreReport *report);
/* A cell of numbers; NaN: a dash. format: of one double. */
void page_cell(FILE *page, const char *format, double value);

void page_plots(FILE *page, const ScoreReport *report);   /* rates against quantities */
void page_curves(FILE *page, const ScoreReport *report);  /* precision and recall, errors of centroids */
void page_classes(FILE *page, const ScoreReport *report); /* average precision, confusion */
void page_tracks(FILE *page, const ScoreReport *report);
void page_errors(FILE *page, const ScoreReport *report); /* centroids, ranges, ages */
void page_cases(FILE *page, const ScoreReport *report);

#endif
