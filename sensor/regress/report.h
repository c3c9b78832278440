/* sensor/regress/report.h: what a regression found, for people (HTML) and for test servers (JUnit XML). */
#ifndef SENSOR_REGRESS_REPORT_H
#define SENSOR_REGRESS_REPORT_H

#include "sensor/regress/run_case.h"

const char *case_state_name(CaseState state); /* `ok`, `FAILED`, `skipped` */

/* JUnit's testsuite: failure: beyond the record, or none there; error: could not be run; skipped: no log. */
Status junit_write(const char *path, const CaseResult *const *result, int count);
/* One page with everything inside it: a table of all, pictures of what failed side by side, passed ones folded. Reads the
 * products of each case anew: work folders must still be there. */
Status report_write(const char *path, const CaseResult *const *result, int count);

#endif
