/* sensor/regress/report.h: results of a regression as an HTML report and as JUnit XML. */
#ifndef SENSOR_REGRESS_REPORT_H
#define SENSOR_REGRESS_REPORT_H

#include "sensor/regress/run_case.h"

const char *case_state_name(CaseState state); /* `ok`, `FAILED`, `skipped` */

/* JUnit's testsuite: failure: beyond tolerance, or no baseline; error: could not be run; skipped: no log. */
Status junit_write(const char *path, const CaseResult *const *result, int count);
/* One self-contained page: a table of all cases, images of what failed side by side, passed cases collapsed. Reads the
 * products of each case again: the work folders must still exist. */
Status report_write(const char *path, const CaseResult *const *result, int count);

#endif
