/* sensor/commands/sweep/sweep_draw.c: `mode: random`: draws values of all axes from one seed, without repetition. */
#include "sensor/commands/sweep/sweep_private.h"

#include "sensor/frame/plane.h"

#include <stdlib.h>

/* Enough draws to find all of 10000 equally likely combinations (10000 (ln 10000 + 0.577) = 98000 on average, standard
 * deviation 12800). Rarer ones, from lists that repeat a value, are then enumerated in order. */
enum { draws_max = 200000, key_size = sweep_axes_max * 24 };

/* ---- equal values --------------------------------------------------------------- */

typedef struct Listed {
    const char *text;
    bool        is_number;
    double      number;
    int         place;
} Listed;

/* Orders values; 5000 and 5e3 are equal. */
static int by_value(const void *a, const void *b)
{
    const Listed *x = a, *y = b;
    if (x->is_number && y->is_number) return (x->number > y->number) - (x->number < y->number);
    return strcmp(x->text, y->text);
}

static int by_value_and_place(const void *a, const void *b)
{
    const Listed *x = a, *y = b;
    const int     values = by_value(a, b);
    return values ? values : x->place - y->place;
}

/* Fills axis->kind_of and kinds: of a range the number of whole numbers in it, 0 where they are too many to count. */
static Status count_kinds(SweepAxis *axis)
{
    if (axis->count == 0) {
        const double span = axis->high - axis->low;
        axis->kinds = span == 0 ? 1 : axis->whole && span < 1e9 ? (int)span + 1 : 0;
        return STATUS_OK;
    }
    Listed    *listed = calloc((size_t)axis->count, sizeof *listed);
    const bool number = sweep_key_kind(axis->key) != CONFIG_WORD;
    axis->kind_of = calloc((size_t)axis->count, sizeof *axis->kind_of);
    axis->first_of = calloc((size_t)axis->count, sizeof *axis->first_of);
    if (!listed || !axis->kind_of || !axis->first_of) {
        free(listed);
        return STATUS_NO_MEMORY;
    }
    for (int i = 0; i < axis->count; i++) {
        listed[i] = (Listed){.text = axis->value[i], .place = i};
        listed[i].is_number = number && text_to_double(&listed[i].number, axis->value[i]);
    }
    qsort(listed, (size_t)axis->count, sizeof *listed, by_value_and_place);
    for (int i = 0, first = 0; i < axis->count; i++) { /* holds, for now, the place of the first of its kind */
        if (i == 0 || by_value(&listed[i - 1], &listed[i]) != 0) first = listed[i].place;
        axis->kind_of[listed[i].place] = first;
    }
    for (int i = 0; i < axis->count; i++) {
        const int first = axis->kind_of[i];
        if (first == i) axis->first_of[axis->kinds] = i;
        axis->kind_of[i] = first == i ? axis->kinds++ : axis->kind_of[first];
    }
    free(listed);
    return STATUS_OK;
}

/* ---- one draw --------------------------------------------------------------------------------- */

static double uniform(const Sweep *sweep, int draw, const SweepAxis *axis)
{
    /* a hash of the key's name, FNV-1a, so that an additional axis changes no draw of the others */
    uint64_t key = 14695981039346656037u;
    for (const char *at = axis->key; *at; at++) key = (key ^ (uint8_t)*at) * 1099511628211u;
    return random_uniform((uint64_t)sweep->draw, 0x53770000u, (uint32_t)draw, key);
}

/* Which kind an axis has in the n-th combination; the last axis changes fastest. */
static int kind_in_order(const Sweep *sweep, int n, int axis)
{
    for (int i = sweep->axis_count - 1; i > axis; i--) n /= sweep->axis[i].kinds;
    return n % sweep->axis[axis].kinds;
}

static int choice_of(const Sweep *sweep, int draw, const SweepAxis *axis)
{
    return (int)fmin(uniform(sweep, draw, axis) * axis->count, axis->count - 1);
}

void sweep_drawn_value(char out[sweep_value_size], const Sweep *sweep, int draw, int axis)
{
    const SweepAxis *a = &sweep->axis[axis];
    if (draw >= draws_max) {
        const int kind = kind_in_order(sweep, draw - draws_max, axis);
        if (a->count > 0) snprintf(out, sweep_value_size, "%s", a->value[a->first_of[kind]]);
        else snprintf(out, sweep_value_size, "%.0f", a->low + kind);
        return;
    }
    const double u = a->count > 0 ? 0 : uniform(sweep, draw, a);
    if (a->count > 0) snprintf(out, sweep_value_size, "%s", a->value[choice_of(sweep, draw, a)]);
    else if (a->whole)
        snprintf(out, sweep_value_size, "%.0f", fmin(a->low + floor(u * (a->high - a->low + 1)), a->high));
    else snprintf(out, sweep_value_size, "%.9g", clamp(a->low + u * (a->high - a->low), a->low, a->high));
}

/* Key of a draw: the kinds of its values. Draws with equal keys are the same. */
static void key_of(char key[key_size], const Sweep *sweep, int draw)
{
    char   value[sweep_value_size];
    size_t n = 0;
    for (int i = 0; i < sweep->axis_count; i++) {
        const SweepAxis *a = &sweep->axis[i];
        if (a->count > 0 && draw >= draws_max)
            snprintf(value, sizeof value, "%d", kind_in_order(sweep, draw - draws_max, i));
        else if (a->count > 0) snprintf(value, sizeof value, "%d", a->kind_of[choice_of(sweep, draw, a)]);
        else sweep_drawn_value(value, sweep, draw, i);
        n += (size_t)snprintf(key + n, key_size - n, "%.22s,", value);
    }
}

/* ---- without repetition -------------------------------------------------------------------------------- */

typedef struct Seen {
    int size;                         /* a power of two, twice what it will hold at least */
    char (*sha256)[sha256_text_size]; /* empty: free */
} Seen;

/* Adds a key. False: it is already present. */
static bool add(Seen *seen, const char *key, Status *status)
{
    char sha256[sha256_text_size], head[9];
    *status = sha256_bytes(sha256, key, strlen(key));
    if (*status != STATUS_OK) return false;
    snprintf(head, sizeof head, "%.8s", sha256);
    for (int at = (int)(strtoul(head, NULL, 16) & (unsigned)(seen->size - 1));; at = (at + 1) & (seen->size - 1)) {
        if (!*seen->sha256[at]) {
            memcpy(seen->sha256[at], sha256, sizeof sha256);
            return true;
        }
        if (strcmp(seen->sha256[at], sha256) == 0) return false;
    }
}

/* Combinations of the axes, as far as sweep_variants_max + 1; ordered: none of them is a range of real numbers. */
static long long combinations(bool *ordered, const Sweep *sweep)
{
    long long product = 1;
    *ordered = true;
    for (int i = 0; i < sweep->axis_count; i++) {
        const int kinds = sweep->axis[i].kinds;
        if (kinds == 0) *ordered = false;
        product = kinds == 0 || product * kinds > sweep_variants_max ? sweep_variants_max + 1 : product * kinds;
    }
    return product;
}

Status sweep_draw(Sweep *sweep, const char *path)
{
    char   key[key_size];
    Seen   seen = {.size = 2};
    Status status = STATUS_OK;
    bool   ordered;
    int    found = 0, draw = 0;
    for (int i = 0; i < sweep->axis_count && status == STATUS_OK; i++) status = count_kinds(&sweep->axis[i]);
    if (status != STATUS_OK) return status;
    const long long all = combinations(&ordered, sweep);
    if (sweep->count > all) {
        log_error("sweep: %s:%d: count: %d different draws are requested, but the axes have %lld combination%s; lower "
                  "count, or add values",
                  path, sweep->count_line, sweep->count, all, all == 1 ? "" : "s");
        return STATUS_BAD_VALUE;
    }
    while (seen.size < 2 * sweep->count) seen.size *= 2;
    seen.sha256 = calloc((size_t)seen.size, sizeof *seen.sha256);
    sweep->draw_of = calloc((size_t)sweep->count, sizeof *sweep->draw_of);
    if (!seen.sha256 || !sweep->draw_of) status = STATUS_NO_MEMORY;
    /* after the draws the combinations are enumerated in order, until there are as many as requested */
    for (; found < sweep->count && status == STATUS_OK && (draw < draws_max || ordered); draw++) {
        key_of(key, sweep, draw);
        if (add(&seen, key, &status)) sweep->draw_of[found++] = draw;
    }
    free(seen.sha256);
    if (status == STATUS_OK && found < sweep->count) {
        log_error("sweep: %s:%d: count: only %d of %d draws differ among 200000 tries; lower count, or widen a "
                  "range",
                  path, sweep->count_line, found, sweep->count);
        status = STATUS_BAD_VALUE;
    }
    return status;
}
