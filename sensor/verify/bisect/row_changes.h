/* sensor/verify/bisect/row_changes.h: the rows in which two versions of a table differ, and tables with some of them.
 *
 * Any CSV of this program (pitviper_table.h): a header, rows; comments and blank lines are dropped. A row of one is
 * matched with an equal one of the other, in order, so that most rows are; those between two matches are paired by
 * their place, or where their numbers differ by their first cell. What is left is new or was removed. */
#ifndef SENSOR_VERIFY_BISECT_ROW_CHANGES_H
#define SENSOR_VERIFY_BISECT_ROW_CHANGES_H

#include "pitviper.h"

enum { row_changes_most = 4096, row_edits_most = 1000 };

/* A row of the mixed table: of the old one, of the new one, or -1. */
typedef struct RowStep {
    int old_row, new_row; /* from 1; 0 is the header */
    int change;           /* index of the change; -1: both are equal */
} RowStep;

typedef struct RowSide {
    char  *text; /* its lines, on the heap */
    int    rows; /* with the header */
    char **row;  /* [rows] */
    int   *line; /* [rows], from 1 */
} RowSide;

typedef struct RowChanges {
    RowSide  old, new;
    int      steps, count; /* count: of changes */
    RowStep *step;         /* [steps] */
} RowChanges;

/* Of two texts with a 0 at the end; any bytes. STATUS_UNSUPPORTED, *why in words: rows cannot be tried apart (other
 * columns, no rows, too many changes). STATUS_NO_MEMORY. On failure there is nothing to free. */
Status row_changes_of(RowChanges *out, const char **why, const char *old_text, const char *new_text);
void   row_changes_free(RowChanges *changes);
/* The change in words: "line 12, grass: rho_mwir is 0.045, was 0.05". */
void row_changes_say(char *out, size_t out_size, const RowChanges *changes, int change);
/* The table with those changes made, of is_new [count]. */
void row_changes_write(FILE *to, const RowChanges *changes, const bool *is_new);

#endif
