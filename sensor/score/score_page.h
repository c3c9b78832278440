/* sensor/score/score_page.h: a report as one HTML file, which needs no other. */
#ifndef SENSOR_SCORE_SCORE_PAGE_H
#define SENSOR_SCORE_SCORE_PAGE_H

#include "sensor/score/score.h"

/* Writes the page: the few numbers first, then plots, classes, tracks, errors, and the worst misses and false alarms
 * with crops of the frames' PNGs where report.out has them. Links to frames are relative to report.out. All texts of
 * the report are plain: they are escaped. Equal reports and equal PNGs give equal octets. STATUS_IO, logged: there is
 * then no file. */
Status score_write_page(const ScoreReport *report, const char *path);

#endif
