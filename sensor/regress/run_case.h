/* sensor/regress/run_case.h: one case, from its folder to a verdict. */
#ifndef SENSOR_REGRESS_RUN_CASE_H
#define SENSOR_REGRESS_RUN_CASE_H

#include "sensor/regress/case_result.h"

typedef struct CaseHow {
    int         threads;         /* of a child */
    const char *isa;             /* of the ray tracer; NULL: the default of replay */
    bool        update, allow_missing; /* allow_missing: of logs */
    const char *why;
} CaseHow;

/* result->c has been read and result->work named; the folder is made here. Log lines of the calling thread go to
 * result->said. */
void run_case(CaseResult *result, const CaseHow *how);
/* Destination of the log lines during a case. NULL: the default. */
void run_case_log(void *user, LogLevel level, const char *line); /* a LogSink */

#endif
