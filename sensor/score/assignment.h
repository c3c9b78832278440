/* sensor/score/assignment.h: the one-to-one assignment of rows to columns that has the greatest sum of weights. */
#ifndef SENSOR_SCORE_ASSIGNMENT_H
#define SENSOR_SCORE_ASSIGNMENT_H

#include "pitviper.h"

/* A sparse matrix of weights >= 0: row r has the entries first[r] .. first[r + 1] - 1, each column at most once. What
 * is not named, and weight 0, is never assigned. */
typedef struct Assignment {
    int           rows, columns;
    const int    *first;  /* [rows + 1], ascending from 0 */
    const int    *column; /* [first[rows]] */
    const double *weight; /* [first[rows]], finite */
} Assignment;

/* match[rows]: its column; -1: none. Rows and columns may stay alone.
 *
 * The Hungarian method with shortest augmenting paths (Jonker and Volgenant, A Shortest Augmenting Path Algorithm for
 * Dense and Sparse Linear Assignment Problems, Computing 38, 1987), in its sparse form: a search by Dijkstra from each
 * row, where a row may also be left alone at weight 0. Integer weights give an exact sum. At most rows x entries x log
 * entries. STATUS_NO_MEMORY. */
Status assignment_greatest(int *match, const Assignment *of, Arena *scratch);

#endif
