/* sensor/regress/run_case.h: one case, from its folder to a verdict. */
#ifndef SENSOR_REGRESS_RUN_CASE_H
#define SENSOR_REGRESS_RUN_CASE_H

#include "sensor/regress/verdict.h"

typedef enum CaseState {
    CASE_OK,
    CASE_FAILED,   /* beyond its record */
    CASE_BROKEN,   /* could not be run, or read */
    CASE_NO_RECORD,
    CASE_SKIPPED,  /* its log is not here, and may be absent */
    CASE_STATES
} CaseState;

typedef struct CaseResult {
    Case      c;
    CaseState state;
    bool      compared, updated;
    char      line[700];         /* what the terminal says behind the name */
    char      chosen[8192];      /* of an update: host, aim and other choices of the run, lines */
    double    seconds;
    Verdict   verdict;
    char      work[case_path_size]; /* what was made; out/ is replay's */
    char      command[16384];    /* to repeat it by hand, lines */
    char      said[8192];        /* the last lines of its processes, and ours of it */
} CaseResult;

typedef struct CaseHow {
    int         threads;         /* of a child */
    const char *isa;             /* of its tracer; NULL: as replay has it */
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
