/* sensor/verify/bisect/row_changes.c: the rows in which two versions of a table differ, and tables with some of them.
 */
#include "sensor/verify/bisect/row_changes.h"

#include <stdlib.h>

/* ---- lines -------------------------------------------------------------------------------------- */

/* Splits a copy of the text in place. */
static Status read_side(RowSide *out, const char *text)
{
    const char *const start = strncmp(text, "\xef\xbb\xbf", 3) == 0 ? text + 3 : text;
    size_t            lines = 1;
    for (const char *c = start; *c; c++) lines += *c == '\n';
    *out = (RowSide){strdup(start), 0, calloc(lines, sizeof *out->row), calloc(lines, sizeof *out->line)};
    if (!out->text || !out->row || !out->line) return STATUS_NO_MEMORY;
    int number = 0;
    for (char *next = out->text; next;) {
        char *line = next;
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        number++;
        size_t n = strlen(line);
        while (n > 0 && strchr(" \t\r", line[n - 1])) line[--n] = 0;
        line += strspn(line, " \t");
        if (!*line || *line == '#') continue;
        out->row[out->rows] = line;
        out->line[out->rows++] = number;
    }
    return STATUS_OK;
}

static void free_side(RowSide *side)
{
    free(side->text);
    free(side->row);
    free(side->line);
}

/* ---- matches -------------------------------------------------------------------------------------- */

static bool same(const RowChanges *c, int old_row, int new_row)
{
    return strcmp(c->old.row[old_row], c->new.row[new_row]) == 0;
}

/* A part of both: rows from `from`, so many. */
typedef struct Part {
    int from, old_rows, new_rows;
} Part;

/* Follows the diagonal k = x - y of edit d back to the start, and notes the matches. Row d of `trace` has 2 d + 1
 * furthest x. */
static void note_matches(int *match, const RowChanges *c, const Part *p, const int *trace, int edits, int k)
{
    for (int d = edits, x = p->old_rows; d >= 0; d--) {
        const int *before = d > 0 ? trace + (size_t)(d - 1) * (size_t)(d - 1) + (d - 1) : NULL;
        const bool down = d > 0 && (k == -d || (k != d && before[k - 1] < before[k + 1]));
        const int  start = d == 0 ? 0 : down ? before[k + 1] : before[k - 1] + 1;
        for (; x > start; x--)
            if (same(c, p->from + x - 1, p->from + x - 1 - k)) match[p->from + x - 1] = p->from + x - 1 - k;
        if (d == 0) break;
        k = down ? k + 1 : k - 1;
        x = before[k];
    }
}

/* The shortest edit from old to new (Myers, An O(ND) difference algorithm, 1986). match[old row]: its row in new, or
 * -1. False: more edits than row_edits_most; *memory false: none left. */
static bool find_matches(int *match, bool *memory, const RowChanges *c, const Part *p)
{
    const size_t most = row_edits_most + 1;
    int         *trace = malloc(most * most * sizeof *trace);
    bool         found = false;
    *memory = trace != NULL;
    for (int d = 0; d <= row_edits_most && trace && !found; d++) {
        int       *now = trace + (size_t)d * (size_t)d + d; /* index -d .. d */
        const int *before = d > 0 ? trace + (size_t)(d - 1) * (size_t)(d - 1) + (d - 1) : NULL;
        for (int k = -d; k <= d && !found; k += 2) {
            int x = 0;
            if (d > 0) x = k == -d || (k != d && before[k - 1] < before[k + 1]) ? before[k + 1] : before[k - 1] + 1;
            while (x < p->old_rows && x - k >= 0 && x - k < p->new_rows && same(c, p->from + x, p->from + x - k)) x++;
            now[k] = x;
            found = x == p->old_rows && x - k == p->new_rows;
            if (found) note_matches(match, c, p, trace, d, k);
        }
    }
    free(trace);
    return found;
}

/* ---- steps -------------------------------------------------------------------------------------- */

static void add_step(RowChanges *c, int old_row, int new_row, bool equal)
{
    c->step[c->steps++] = (RowStep){old_row, new_row, equal ? -1 : c->count};
    if (!equal) c->count++;
}

static bool same_first_cell(const char *a, const char *b)
{
    const size_t n = strcspn(a, ",");
    return n == strcspn(b, ",") && strncmp(a, b, n) == 0;
}

/* The rows between two matches. */
static void add_between(RowChanges *c, int old_row, int old_end, int new_row, int new_end)
{
    const bool paired = old_end - old_row == new_end - new_row;
    for (; new_row < new_end; new_row++) {
        int with = old_row;
        while (!paired && with < old_end && !same_first_cell(c->old.row[with], c->new.row[new_row])) with++;
        if (with < old_end)
            for (; old_row < with; old_row++) add_step(c, old_row, -1, false);
        add_step(c, with < old_end ? old_row++ : -1, new_row, false);
    }
    for (; old_row < old_end; old_row++) add_step(c, old_row, -1, false);
}

static void add_steps(RowChanges *c, const int *match)
{
    int new_row = 0, from = 0;
    for (int row = 0; row <= c->old.rows; row++) {
        const bool end = row == c->old.rows;
        if (!end && match[row] < 0) continue;
        const int with = end ? c->new.rows : match[row];
        add_between(c, from, row, new_row, with);
        if (!end) add_step(c, row, with, true);
        from = row + 1;
        new_row = with + 1;
    }
}

static Status find_steps(RowChanges *c, const char **why)
{
    int *match = malloc((size_t)c->old.rows * sizeof *match), from = 0, tail = 0;
    c->step = malloc((size_t)(c->old.rows + c->new.rows) * sizeof *c->step);
    bool memory = match && c->step;
    if (memory) {
        const int least = c->old.rows < c->new.rows ? c->old.rows : c->new.rows;
        for (int i = 0; i < c->old.rows; i++) match[i] = -1;
        while (from < least && same(c, from, from)) match[from] = from, from++;
        while (tail < least - from && same(c, c->old.rows - 1 - tail, c->new.rows - 1 - tail)) {
            tail++;
            match[c->old.rows - tail] = c->new.rows - tail;
        }
        const bool found =
            find_matches(match, &memory, c, &(Part){from, c->old.rows - from - tail, c->new.rows - from - tail});
        const bool by_place = !found && memory && c->old.rows == c->new.rows;
        for (int i = from; i < c->old.rows && by_place; i++) match[i] = same(c, i, i) ? i : -1;
        if (memory && (found || by_place)) add_steps(c, match);
        else if (memory) *why = "more than 1000 of its rows differ";
        if (c->count > row_changes_most) *why = "more than 4096 of its rows differ";
    }
    free(match);
    return !memory ? STATUS_NO_MEMORY : *why ? STATUS_UNSUPPORTED : STATUS_OK;
}

Status row_changes_of(RowChanges *out, const char **why, const char *old_text, const char *new_text)
{
    RowChanges c = {0};
    Status     status = read_side(&c.old, old_text);
    *why = NULL;
    if (status == STATUS_OK) status = read_side(&c.new, new_text);
    if (status == STATUS_OK && (c.old.rows < 2 || c.new.rows < 2)) *why = "one of them has no rows";
    else if (status == STATUS_OK && !same(&c, 0, 0)) *why = "its columns differ";
    if (*why) status = STATUS_UNSUPPORTED;
    if (status == STATUS_OK) status = find_steps(&c, why);
    if (status == STATUS_OK) *out = c;
    else row_changes_free(&c);
    return status;
}

void row_changes_free(RowChanges *c)
{
    free_side(&c->old);
    free_side(&c->new);
    free(c->step);
    *c = (RowChanges){0};
}

/* ---- words -------------------------------------------------------------------------------------- */

enum { cells_most = 64, named_most = 3 };

static int cells_of(char *copy[cells_most], char **text, const char *row)
{
    *text = strdup(row);
    const int count = *text ? text_split(copy, cells_most, *text) : -1;
    return count > cells_most ? cells_most : count;
}

/* The cells that differ, the first few by name. */
static void say_cells(char *out, size_t out_size, const RowChanges *c, const RowStep *s)
{
    char     *head[cells_most], *was[cells_most], *is[cells_most], *text[3] = {NULL};
    const int columns = cells_of(head, &text[0], c->old.row[0]),
              cells = cells_of(was, &text[1], c->old.row[s->old_row]);
    const int now = cells_of(is, &text[2], c->new.row[s->new_row]);
    size_t    n = 0;
    int       differ = 0;
    for (int i = 0; i < cells && i < now && i < columns; i++) {
        if (strcmp(was[i], is[i]) == 0 || differ++ >= named_most || n + 1 >= out_size) continue;
        n += (size_t)snprintf(out + n, out_size - n, "%s%.40s is %.60s, was %.60s", n ? "; " : "", head[i],
                              *is[i] ? is[i] : "empty", *was[i] ? was[i] : "empty");
    }
    if (differ > named_most && n < out_size) snprintf(out + n, out_size - n, "; and %d more", differ - named_most);
    if (differ == 0) snprintf(out, out_size, "the row differs");
    for (int i = 0; i < 3; i++) free(text[i]);
}

void row_changes_say(char *out, size_t out_size, const RowChanges *c, int change)
{
    char           cells[400];
    const RowStep *s = c->step;
    while (s->change != change) s++;
    const bool  is = s->new_row >= 0;
    const char *row = is ? c->new.row[s->new_row] : c->old.row[s->old_row];
    if (is && s->old_row >= 0) say_cells(cells, sizeof cells, c, s);
    else snprintf(cells, sizeof cells, is ? "is new" : "was removed");
    snprintf(out, out_size, "line %d, %.*s: %s", is ? c->new.line[s->new_row] : c->old.line[s->old_row],
             (int)strcspn(row, ",") < 60 ? (int)strcspn(row, ",") : 60, row, cells);
}

void row_changes_write(FILE *to, const RowChanges *c, const bool *is_new)
{
    for (int i = 0; i < c->steps; i++) {
        const RowStep *s = &c->step[i];
        const bool new = s->change >= 0 && is_new[s->change];
        const int row = new ? s->new_row : s->old_row;
        if (row >= 0) fprintf(to, "%s\n", new ? c->new.row[row] : c->old.row[row]);
    }
}
