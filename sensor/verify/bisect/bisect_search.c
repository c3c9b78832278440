/* sensor/verify/bisect/bisect_search.c: the search through parts, files and rows: what of a part moves the case is
 * sought in it with the rest of what is needed held as in NEW. */
#include "sensor/verify/bisect/bisect_private.h"

#include <stdlib.h>

enum { each_most = 6 }; /* so many or fewer are tried alone, each */

/* The items of one level: those differences in `within` that have one group. */
typedef struct Level {
    Bisect     *b;
    int         level, items;
    const bool *within, *held; /* [differences]; held: as in NEW in all tests; NULL: none */
    int        *first;         /* [items]: a difference of each */
    bool       *in;            /* [differences], of a test */
} Level;

static bool is_in_item(const Level *l, int difference, int item)
{
    return l->within[difference] &&
           l->b->d.difference[difference].group[l->level] == l->b->d.difference[l->first[item]].group[l->level];
}

static void note_alone(Level *l, int item, int trial)
{
    Bisect *b = l->b;
    for (int i = 0; i < b->alone_count; i++)
        if (b->alone[i].trial == trial) return;
    if (b->alone_count < alone_most) b->alone[b->alone_count++] = (Alone){l->first[item], l->level, trial};
}

static DeltaAnswer test_items(void *user, const bool *item)
{
    Level *l = user;
    int    count = 0, last = 0, trial;
    for (int i = 0; i < l->items; i++) {
        count += item[i];
        if (item[i]) last = i;
    }
    for (int k = 0; k < l->b->d.count; k++) l->in[k] = l->held && l->held[k];
    for (int i = 0; i < l->items; i++)
        for (int k = 0; item[i] && k < l->b->d.count; k++)
            if (is_in_item(l, k, i)) l->in[k] = true;
    const DeltaAnswer answer = trial_answer(&trial, l->b, l->in);
    if (count == 1 && !l->held && trial >= 0) note_alone(l, last, trial);
    return answer;
}

static bool begin_level(Level *l, Bisect *b, int level, const bool *within, const bool *held)
{
    const size_t count = (size_t)b->d.count;
    *l = (Level){b, level, 0, within, held, calloc(count + 1, sizeof *l->first), calloc(count + 1, sizeof *l->in)};
    for (int k = 0; l->first && k < b->d.count; k++)
        if (within[k] && (l->items == 0 || !is_in_item(l, k, l->items - 1))) l->first[l->items++] = k;
    return l->first && l->in;
}

static void end_level(Level *l)
{
    free(l->first);
    free(l->in);
}

static void copy_items(bool *to, const Level *l, const DeltaSet *set)
{
    for (int k = 0; k < l->b->d.count; k++) to[k] = false;
    for (int i = 0; i < l->items; i++)
        for (int k = 0; set->in[i] && k < l->b->d.count; k++) to[k] = to[k] || is_in_item(l, k, i);
}

static Status search(Cause *out, int *found, int most, Bisect *b, int level, const bool *within, const bool *held);

/* Goes on in each item of a set of several: the others of the set are held meanwhile. in: becomes what is left of them.
 */
static Status narrow(bool *in, bool *smallest, Bisect *b, const Level *l, const DeltaSet *set, const bool *held)
{
    const size_t count = (size_t)b->d.count;
    bool        *inside = calloc(count + 1, sizeof *inside), *others = calloc(count + 1, sizeof *others);
    Status       status = inside && others ? STATUS_OK : STATUS_NO_MEMORY;
    for (int i = 0; i < l->items && status == STATUS_OK; i++) {
        Cause one;
        int   found = 0;
        if (!set->in[i]) continue;
        for (size_t k = 0; k < count; k++) {
            inside[k] = is_in_item(l, (int)k, i);
            others[k] = !inside[k] && (in[k] || (held && held[k]));
        }
        status = search(&one, &found, 1, b, l->level + 1, inside, others);
        if (status != STATUS_OK || found == 0) continue;
        for (size_t k = 0; k < count; k++)
            if (inside[k]) in[k] = one.in[k];
        *smallest = *smallest && one.smallest;
        free(one.in);
    }
    free(inside);
    free(others);
    return status;
}

static Status take_set(Cause *out, int *found, int most, Bisect *b, const Level *l, const DeltaSet *set,
                       const bool *held)
{
    bool  *in = calloc((size_t)b->d.count + 1, sizeof *in), smallest = set->smallest;
    Status status = in ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) copy_items(in, l, set);
    if (status == STATUS_OK && l->level + 1 < levels && set->size == 1) {
        status = search(out, found, most, b, l->level + 1, in, held);
        free(in);
        return status;
    }
    if (status == STATUS_OK && l->level + 1 < levels) status = narrow(in, &smallest, b, l, set, held);
    if (status != STATUS_OK) {
        free(in);
        return status;
    }
    out[(*found)++] = (Cause){.in = in, .trial = -1, .smallest = smallest};
    return STATUS_OK;
}

/* Appends up to `most` causes among the differences within. */
static Status search(Cause *out, int *found, int most, Bisect *b, int level, const bool *within, const bool *held)
{
    Level       l;
    DeltaSet    set[causes_most];
    DeltaAnswer rest;
    int         sets = 0;
    if (!begin_level(&l, b, level, within, held)) {
        end_level(&l);
        return STATUS_NO_MEMORY;
    }
    const DeltaSearch of = {l.items, test_items, &l, each_most};
    Status            status = delta_causes(set, &sets, most, &rest, &of);
    for (int i = 0; i < sets && status == STATUS_OK && *found < most; i++)
        status = take_set(out, found, most, b, &l, &set[i], held);
    if (sets) delta_free(set, sets);
    end_level(&l);
    return status;
}

/* The files that the runs have read, if they are not all and move it together: the others need no search then. */
static bool only_read(bool *within, Bisect *b)
{
    int read = 0, trial;
    for (int k = 0; k < b->d.count; k++) {
        const Difference *one = &b->d.difference[k];
        const bool        file = one->kind == OF_FILE || one->kind == OF_ROW;
        within[k] = !file || b->d.tables.file[one->file].is_read;
        read += within[k];
    }
    return read > 0 && (read == b->d.count || trial_answer(&trial, b, within) == DELTA_MOVES);
}

Status bisect_search(Bisect *b)
{
    const size_t count = (size_t)b->d.count;
    bool        *within = malloc(count + 1), *left = calloc(count + 1, sizeof *left);
    int          trial;
    Status       status = within && left ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        memset(left, true, count);
        trial_answer(&trial, b, left); /* all: NEW, which is known */
        const int level = b->d.old.kind == SIDE_PROGRAM  ? level_parts
                          : b->d.old.kind == SIDE_TABLES ? level_files
                                                         : level_all;
        if (!only_read(within, b)) memset(within, true, count);
        status = search(b->cause, &b->cause_count, causes_most, b, level, within, NULL);
    }
    for (int i = 0; i < b->cause_count && status == STATUS_OK; i++) {
        Cause *c = &b->cause[i];
        for (size_t k = 0; k < count; k++) {
            c->size += c->in[k];
            left[k] = left[k] && !c->in[k];
        }
        trial_answer(&c->trial, b, c->in);
    }
    if (status == STATUS_OK) b->rest = trial_answer(&trial, b, left);
    free(within);
    free(left);
    return status;
}
