/* sensor/regress/run_case.h: one case, from its folder to a verdict. */
#ifndef SENSOR_REGRESS_RUN_CASE_H
#define SENSOR_REGRESS_RUN_CASE_H

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
    char      line[700];         /* printed behind the name */
    char      chosen[8192];      /* of an update: lines with host, aim and other automatic choices */
    double    seconds;
    Verdict   verdict;
    char      work[case_path_size]; /* work folder; out/ holds the products of replay */
    char      command[16384];    /* lines: the commands that reproduce it */
    char      said[8192];        /* last lines of its processes, and log messages about it */
} CaseResult;

typedef struct CaseHow {
    int         threads;         /* of a child */
    const char *isa;             /* of the ray tracer; NULL: the default of replay */
    bool        update, allow_missing; /* allow_missing: of logs */
    const char *why;
} CaseHow;

/* result->c has been read and result->work named; the folder is made here. Log lines of the calling thread go to
 * result->said. */
void run_case(CaseResult *result, const CaseHow *how);
/* While inside: where the log's lines go. NULL: nowhere special. */
void run_case_log(void *user, LogLevel level, const char *line); /* a LogSink */
/* Makes PATH and what is above it. False, logged. */
bool make_folder(const char *path);

#endif
