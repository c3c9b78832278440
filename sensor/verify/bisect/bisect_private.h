/* sensor/verify/bisect/bisect_private.h: what the files of a bisection share: the two versions, their differences, the
 * runs with some of them, and the report.
 *
 * A difference is the smallest part that is tried apart: the program that renders, the one that makes the exercise, a
 * row of a table, a whole file, a key of settings. A run has some of them as in NEW and the others as in OLD; it is
 * compared with OLD's own, by the case's tolerances, and moves when the channel does that NEW moves first. */
#ifndef SENSOR_VERIFY_BISECT_BISECT_PRIVATE_H
#define SENSOR_VERIFY_BISECT_BISECT_PRIVATE_H

#include "sensor/settings/config.h"
#include "sensor/verify/bisect/delta.h"
#include "sensor/verify/bisect/row_changes.h"
#include "sensor/verify/regress/run_case.h"

enum { bisect_path_size = case_path_size + 640, differences_most = 20000, causes_most = 8, alone_most = 64 };

/* ---- OLD and NEW (sides.c) ----------------------------------------------------------------------- */

typedef enum SideKind { SIDE_PROGRAM, SIDE_TABLES, SIDE_SETTINGS } SideKind;

typedef struct Side {
    const char *given; /* on the command line */
    SideKind    kind;
    char        program[case_path_size];  /* executable */
    char        tables[case_path_size];   /* folder; of a program, empty until it is known */
    char        settings[case_path_size]; /* file */
} Side;

/* What `given` names: an executable, or a folder with one (an installation, a build); a folder of tables; a file of
 * settings. tables: of a program, where the user names them; else NULL. Paths become absolute. STATUS_BAD_VALUE,
 * logged. */
Status side_open(Side *out, const char *given, const char *tables);
/* The tables of a program, from what its verbose replay said in this file. STATUS_BAD_VALUE, logged. */
Status side_find_tables(Side *side, const char *stderr_path, const char *option);
/* "programs", "tables", "settings". */
const char *side_kind_name(SideKind kind);

/* ---- files of tables (table_files.c) --------------------------------------------------------------- */

typedef struct TableFile {
    char       *name;             /* in the folder of tables */
    bool        in_old, in_new;   /* whether they have it */
    bool        differs, is_read; /* read by OLD's or NEW's run, as it said */
    bool        by_rows;          /* its rows are tried apart; else why not, or NULL: there is nothing to tell apart */
    const char *whole;
    RowChanges  rows;
} TableFile;

typedef struct TableFiles {
    int        count;
    TableFile *file; /* [count], by name */
} TableFiles;

/* All files of both folders but pages, scripts and pictures. A file in whose comments alone they differ does not.
 * STATUS_BAD_VALUE, STATUS_IO, logged; STATUS_NO_MEMORY. */
Status table_files_read(TableFiles *out, const char *old_folder, const char *new_folder);
void   table_files_free(TableFiles *files);
/* Notes which of them a verbose replay has read from this folder. */
void table_files_note_read(TableFiles *files, const char *folder, const char *stderr_path);

/* ---- differences (differences.c) ------------------------------------------------------------------- */

/* Program or tables; each file; each row. Settings have only the last. */
enum { level_parts, level_files, level_all, levels };

typedef enum DifferenceKind { OF_PROGRAM, OF_GENERATOR, OF_FILE, OF_ROW, OF_KEY } DifferenceKind;

typedef struct Difference {
    DifferenceKind kind;
    int            file, row, key; /* of OF_FILE and OF_ROW; of OF_ROW; of OF_KEY: those that its kind has */
    int            group[levels];  /* which item of each level it is in; equal ones stand side by side */
} Difference;

typedef struct Differences {
    Side        old, new;
    int         count;
    Difference *difference; /* [count] */
    TableFiles  tables;
    Config      from, to; /* settings of OLD and NEW: the case's with theirs over them */
} Differences;

/* generator: the exercises of both differ. On failure logged, and still to be freed. */
Status differences_find(Differences *d, const Case *c, bool generator);
void   differences_free(Differences *d);
/* In words; level: one of the difference's item there. */
void differences_say(char *out, size_t out_size, const Differences *d, int index, int level);

/* ---- runs (trial.c) ---------------------------------------------------------------------------------- */

typedef struct Trial {
    bool       *in; /* [differences]: as in NEW */
    int         size;
    DeltaAnswer answer;
    int         first;     /* channel; -1: nothing moved, or it could not be run */
    char        line[700]; /* the verdict, or why it could not be run */
} Trial;

/* One of a level tried alone. */
typedef struct Alone {
    int index, level; /* a difference in it */
    int trial;
} Alone;

/* What moves the channel: differences[count] of NEW, with no others. */
typedef struct Cause {
    bool *in;
    int   size, trial;
    bool  smallest;
} Cause;

typedef struct Bisect {
    Differences d;
    Case        c;
    char        work[case_path_size], record[case_path_size + 64];
    int         threads, runs_most;
    const char *isa;
    CaseResult *old, *new, *tried; /* tried: of the last run */
    bool        compared_approved; /* OLD with the approved baseline of the case */
    Verdict     approved;
    Channel     moved; /* the first channel that NEW moves */
    int         runs, trials, trials_room;
    Trial      *trial; /* [trials] */
    int         alone_count, cause_count;
    Alone       alone[alone_most];
    Cause       cause[causes_most];
    DeltaAnswer rest; /* what happens with all differences but those of the causes */
    double      begun_s;
} Bisect;

/* One run of the case with these differences of NEW; work: a folder in b->work. OLD as it is: in NULL and new false;
 * NEW as it is: in NULL and new true. compare: with OLD's. The result says how it ended. */
void trial_run(CaseResult *result, Bisect *b, const char *work, const bool *in, bool new, bool compare);
/* The answer to a set of differences, from a run or, if it was tried, from memory. *trial: its index; -1 when no more
 * may be run. */
DeltaAnswer trial_answer(int *trial, Bisect *b, const bool *in);
/* Finds b->cause, b->alone and b->rest. STATUS_NO_MEMORY. */
Status bisect_search(Bisect *b);

/* ---- what it says (bisect_report.c) ------------------------------------------------------------------ */

void bisect_print(const Bisect *b);
/* FOLDER/bisect.json, FOLDER/report.html; each cause is run once more, for its images. Logged. */
Status bisect_write(Bisect *b, const char *folder);

#endif
