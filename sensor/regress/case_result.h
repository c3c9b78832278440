/* sensor/regress/case_result.h: the result of a case, and its messages. */
#ifndef SENSOR_REGRESS_CASE_RESULT_H
#define SENSOR_REGRESS_CASE_RESULT_H

#include "sensor/regress/verdict.h"

typedef enum CaseState {
    CASE_OK,
    CASE_FAILED,   /* beyond tolerance of its baseline */
    CASE_BROKEN,   /* could not be run, or read */
    CASE_NO_RECORD,
    CASE_SKIPPED,  /* its log is missing, which is allowed */
    CASE_STATES
} CaseState;

typedef struct CaseResult {
    Case      c;
    CaseState state;
    bool      compared, updated;
    char      line[700];         /* printed after the name */
    char      chosen[8192];      /* of an update: lines with host, aim and other automatic choices */
    double    seconds;
    Verdict   verdict;
    char      work[case_path_size]; /* work folder; out/ holds the products of replay */
    char      command[16384];    /* lines: the commands that reproduce it */
    char      said[8192];        /* last lines of its processes, and log messages about it */
} CaseResult;

#endif
