/* sensor/regress/update.h: a run becomes the record, and the card says why. */
#ifndef SENSOR_REGRESS_UPDATE_H
#define SENSOR_REGRESS_UPDATE_H

#include "sensor/regress/run_case.h"

/* The products in result->work become result->c.folder/record, all or none of them; card.md gets a paragraph: why, what
 * differs from the record before, date of the exercise, version, hash of the settings. Ends the case: CASE_OK, updated, or
 * CASE_BROKEN with the reason in result->line. */
void update_case(CaseResult *result, const char *why);

#endif
