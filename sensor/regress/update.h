/* sensor/regress/update.h: approves a run as the baseline of its case, with the reason in card.md. */
#ifndef SENSOR_REGRESS_UPDATE_H
#define SENSOR_REGRESS_UPDATE_H

#include "sensor/regress/case_result.h"

/* The products in result->work become result->c.folder/record, all or none of them; card.md gets an entry: why, what
 * differs from the previous baseline, date of the exercise, version, hash of the settings. Sets the result: CASE_OK,
 * updated, or CASE_BROKEN with the reason in result->line. */
void update_case(CaseResult *result, const char *why);

#endif
