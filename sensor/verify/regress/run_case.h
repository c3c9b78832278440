/* sensor/verify/regress/run_case.h: a case of the regression, run, compared and reported: its result, how it is run,
 * its processes. */
#ifndef SENSOR_VERIFY_REGRESS_RUN_CASE_H
#define SENSOR_VERIFY_REGRESS_RUN_CASE_H

#include "sensor/verify/regress/verdict.h"

/* ---- the result of a case, and its messages ------------------------------------------------------ */

typedef enum CaseState {
    CASE_OK,
    CASE_FAILED, /* beyond tolerance of its baseline */
    CASE_BROKEN, /* could not be run, or read */
    CASE_NO_RECORD,
    CASE_SKIPPED, /* its log is missing, which is allowed */
    CASE_STATES
} CaseState;

typedef struct CaseResult {
    Case      c;
    CaseState state;
    bool      compared, updated;
    char      line[700];    /* printed after the name */
    char      chosen[8192]; /* of an update: lines with host, aim and other automatic choices */
    double    seconds;
    Verdict   verdict;
    char      work[case_path_size];        /* work folder; out/ holds the products of replay */
    char      record[case_path_size + 64]; /* folder of the baseline; set when it is run */
    char      command[16384];              /* lines: the commands that reproduce it */
    char      said[8192];                  /* last lines of its processes, and log messages about it */
} CaseResult;

/* ---- one case, from its folder to a verdict (run_case.c) ----------------------------------------- */

typedef struct CaseHow {
    int         threads;               /* of a child */
    const char *isa;                   /* of the ray tracer; NULL: the default of replay */
    bool        update, allow_missing; /* allow_missing: of logs */
    const char *why;
    /* In place of what the case and this program have (NULL), for a bisection: */
    const char *generator, *program; /* executables: of `exercise`, of `replay` */
    const char *tables;              /* folder of tables (PITVIPER_ETC); "": those of the executable itself */
    const char *settings;            /* file of settings */
    const char *record;              /* folder of the baseline; "": nothing is compared, and the state is CASE_OK */
    bool        verbose;             /* replay names the tables that it reads, in work/replay.stderr */
} CaseHow;

/* result->c has been read and result->work named; the folder is made here. Log lines of the calling thread go to
 * result->said. */
void run_case(CaseResult *result, const CaseHow *how);
/* The LogSink of the log lines during a case, with a CaseResult as user. NULL: the default. */
void run_case_log(void *user, LogLevel level, const char *line); /* a LogSink */
/* Ends a case with a line; false. Adds to what its processes said. */
bool run_case_end(CaseResult *result, CaseState state, const char *format, ...) __attribute__((format(printf, 3, 4)));
void run_case_say(CaseResult *result, const char *text);
/* Removes a folder and all in it, following no link: called only for one that this process has made by temp_folder, and
 * for those in it. */
void run_case_remove(const char *folder);

/* ---- a recogniser's answers (case_scores.c) ------------------------------------------------------ */

/* Runs the recogniser of the case, if it names one, scores the answers against the truth of the run, and writes
 * work/out/scores.json. Nothing without scores in the case. False: it failed, and the result of the case is set. */
bool case_scores(CaseResult *result);

/* ---- approval of a run as the baseline of its case (case_update.c) ------------------------------- */

/* Moves the products in result->work to result->c.folder/record, all or none of them. card.md gets an entry: why, what
 * differs from the previous baseline, date of the exercise, version, hash of the settings. Sets the result: CASE_OK,
 * updated, or CASE_BROKEN with the reason in result->line. */
void case_update(CaseResult *result, const char *why);
/* The products of result->work/out as the files of a baseline, in place of those that are in `folder`, which is made.
 * Failures are logged. */
Status case_write_record(const CaseResult *result, const char *folder);

/* ---- reports (regress_report.c, regress_junit.c) ------------------------------------------------- */

const char *case_state_name(CaseState state); /* `ok`, `FAILED`, `skipped` */

/* JUnit's testsuite: failure: beyond tolerance, or no baseline; error: could not be run; skipped: no log. */
Status regress_junit_write(const char *path, const CaseResult *const *result, int count);
/* Writes one self-contained page: a table of all cases, images of what failed side by side, passed cases collapsed. It
 * reads the products of each case again, so the work folders must still exist. */
Status regress_report_write(const char *path, const CaseResult *const *result, int count);
/* A case that failed, as a part of another page: its line, inputs, channels, images; its anchor is `case` and number.
 */
void regress_report_failed(FILE *page, const CaseResult *result, int number);

/* ---- planes as PNG in a page, enlarged so that single pixels are visible (false_colour.c) -------- */

typedef enum Colours {
    COLOURS_HEAT,   /* dark to bright, by a scale */
    COLOURS_SIGNED, /* blue below 0, red above, white at it */
    COLOURS_IDS,    /* a colour per id; 0 is dark */
} Colours;

typedef struct Scale {
    double low, high;
} Scale;

/* Makes a scale from the 0.5th to the 99.5th percentile of both planes together; for a single value it gets a width. */
Scale false_colour_scale(const float *a, const float *b, size_t count);
/* -most .. most: the largest of the finite differences but one in two hundred of those that are not 0, at least
 * `least`. */
Scale false_colour_scale_of_difference(const float *difference, size_t count, double least);

/* One plane, or three for red, green, blue of COLOURS_HEAT. Pixels that are not finite are violet. */
typedef struct FalseColour {
    const float *plane[3];
    int          planes, width, height;
    Colours      colours;
    Scale        scale;
} FalseColour;

/* Into the page, as <img>. scratch: a file that may be written. False, and nothing written, when it cannot be made. */
bool false_colour_picture(FILE *page, const FalseColour *picture, int wanted_width, const char *scratch,
                          const char *alt);
/* A bar of the colours with the numbers at its ends. */
bool false_colour_legend(FILE *page, Colours colours, Scale scale, const char *unit, const char *scratch);

/* ---- this program as a child process, so that a crash or a hang affects only one case (case_child.c)  */

enum { child_arguments_max = 640 };

typedef struct ChildLine {
    const char *program; /* its executable; NULL: this one */
    const char *tables;  /* its PITVIPER_ETC; "": unset; NULL: that of this process */
    const char *folder;  /* its current folder; NULL: that of this process */
    bool        apart;   /* a program of others: without network (confine_network) and display */
    int         count;
    const char *argument[child_arguments_max + 1]; /* argument[0]: `pitviper`; ends with NULL. Borrowed */
} ChildLine;

typedef struct ChildEnd {
    bool   timed_out, stopped; /* ended by this process: after timeout_s; on a signal to stop */
    int    signal, code;       /* signal 0: it exited with this code */
    double seconds;
} ChildEnd;

/* False when there are too many. */
bool case_child_add(ChildLine *line, const char *argument);
/* Runs it to its end, in the environment of this process but with LC_ALL=C, TZ=UTC and its tables, standard input
 * empty, its output in two files. In a process group of its own, which is ended as a whole, also with what is left of
 * it behind its first process. STATUS_IO, logged, when it cannot be started. */
Status case_child_run(ChildEnd *end, const ChildLine *line, const char *out_path, const char *error_path,
                      double timeout_s);
/* Writes the command line, quoted for a shell. */
void case_child_text(char *out, size_t out_size, const ChildLine *line);
/* Reads the last lines of a file, at most that many octets; "" when it cannot be read. */
void case_child_tail(char *out, size_t out_size, const char *path);

#endif
