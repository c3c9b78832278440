/* sensor/score/assignment.c: assignment of the greatest sum of weights, by shortest augmenting paths. */
#include "sensor/score/assignment.h"

/* Prices keep row_price[r] + column_price[c] >= weight, equal where r has c; that of a row or column which is alone is
 * 0. The length of an entry is by how much the prices exceed its weight. */
typedef struct Search {
    const Assignment *of;
    double           *row_price, *column_price; /* [rows], [columns] */
    int              *match, *row_of;           /* of a row, its column; of a column, its row; -1: none */
    double           *length;                   /* of the shortest path to a column [columns] */
    int              *from;                     /* the row before it on that path [columns] */
    int              *seen;                     /* the search that reached it [columns] */
    int              *place;                    /* in the heap; -1: left it [columns] */
    int              *heap, heaped;             /* columns by length [columns] */
    int              *done, dones;              /* columns that left the heap, in that order [columns] */
} Search;

static void heap_put(Search *s, int at, int column)
{
    s->heap[at] = column;
    s->place[column] = at;
}

static void heap_rise(Search *s, int column)
{
    int at = s->place[column];
    while (at > 0 && s->length[s->heap[(at - 1) / 2]] > s->length[column]) {
        heap_put(s, at, s->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    heap_put(s, at, column);
}

static int heap_take(Search *s)
{
    const int least = s->heap[0], last = s->heap[--s->heaped];
    int       at = 0;
    for (int next = 1; next < s->heaped; next = 2 * at + 1) {
        if (next + 1 < s->heaped && s->length[s->heap[next + 1]] < s->length[s->heap[next]]) next++;
        if (s->length[last] <= s->length[s->heap[next]]) break;
        heap_put(s, at, s->heap[next]);
        at = next;
    }
    if (s->heaped) heap_put(s, at, last);
    s->place[least] = -1;
    return least;
}

/* Lengthens the path by each entry of a row; nothing of `most` and longer matters. */
static void extend(Search *s, int search, int row, double length, double most)
{
    for (int k = s->of->first[row]; k < s->of->first[row + 1]; k++) {
        const int    c = s->of->column[k];
        const double to = length + fmax(0, s->row_price[row] + s->column_price[c] - s->of->weight[k]);
        if (to >= most || (s->seen[c] == search && to >= s->length[c])) continue;
        if (s->seen[c] != search) s->place[c] = s->heaped++;
        s->seen[c] = search;
        s->length[c] = to;
        s->from[c] = row;
        heap_rise(s, c);
    }
}

/* Gives the row a column, or none, along the shortest path to a column that is free or a row that is then alone. */
static void assign(Search *s, int row)
{
    double price = 0;
    for (int k = s->of->first[row]; k < s->of->first[row + 1]; k++)
        price = fmax(price, s->of->weight[k] - s->column_price[s->of->column[k]]);
    s->row_price[row] = price;
    s->heaped = s->dones = 0;
    double most = price; /* the row itself stays alone */
    int    end = -1;     /* the last column of the path; the row that had it, if any, is then alone */
    extend(s, row, row, 0, most);
    while (s->heaped && s->length[s->heap[0]] < most) {
        const int c = heap_take(s), owner = s->row_of[c];
        s->done[s->dones++] = c;
        if (owner < 0) {
            most = s->length[c];
            end = c;
            break;
        }
        if (s->length[c] + s->row_price[owner] < most) {
            most = s->length[c] + s->row_price[owner];
            end = c;
        }
        extend(s, row, owner, s->length[c], most);
    }
    s->row_price[row] -= most;
    for (int k = 0; k < s->dones; k++) {
        const int    c = s->done[k];
        const double by = most - s->length[c];
        s->column_price[c] += by;
        if (s->row_of[c] >= 0) s->row_price[s->row_of[c]] = fmax(0, s->row_price[s->row_of[c]] - by);
    }
    if (end >= 0 && s->row_of[end] >= 0) s->match[s->row_of[end]] = -1;
    for (int c = end; c >= 0;) {
        const int r = s->from[c], before = s->match[r];
        s->match[r] = c;
        s->row_of[c] = r;
        c = r == row ? -1 : before;
    }
}

Status assignment_greatest(int *match, const Assignment *of, Arena *scratch)
{
    const size_t rows = (size_t)of->rows + 1, columns = (size_t)of->columns + 1;
    Search       s = {.of = of, .match = match};
    s.row_price = arena_alloc(scratch, rows, sizeof *s.row_price);
    s.column_price = arena_alloc(scratch, columns, sizeof *s.column_price);
    s.length = arena_alloc_raw(scratch, columns, sizeof *s.length);
    int *all = arena_alloc_raw(scratch, 6 * columns, sizeof *all);
    if (!s.row_price || !s.column_price || !s.length || !all) return STATUS_NO_MEMORY;
    s.row_of = all, s.from = all + columns, s.seen = all + 2 * columns;
    s.place = all + 3 * columns, s.heap = all + 4 * columns, s.done = all + 5 * columns;
    for (int c = 0; c < of->columns; c++) s.row_of[c] = s.seen[c] = -1;
    for (int r = 0; r < of->rows; r++) match[r] = -1;
    for (int r = 0; r < of->rows; r++) assign(&s, r);
    return STATUS_OK;
}
