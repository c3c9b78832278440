/* sensor/score/json_pick.c: copies a JSON text, leaving out members that are not wanted. */
#include "sensor/score/json_pick.h"

enum { deepest = 64, name_sizes = 32 };

typedef struct Pick {
    const char        *at, *end;
    char              *out;
    bool               good;
    const char *const *names;
    int                count;
    unsigned           sizes; /* bit n: some name has n characters */
} Pick;

static inline void skip_blanks(Pick *p)
{
    while (p->at < p->end && (*p->at == ' ' || *p->at == '\t' || *p->at == '\r' || *p->at == '\n')) p->at++;
}

static inline bool next_is(Pick *p, char c)
{
    skip_blanks(p);
    return p->at < p->end && *p->at == c;
}

static inline void copy(Pick *p, const char *from)
{
    memcpy(p->out, from, (size_t)(p->at - from));
    p->out += p->at - from;
}

/* Goes behind a text; at its first quote. */
static inline void skip_text(Pick *p)
{
    for (p->at++; p->at < p->end && *p->at != '"'; p->at++)
        if (*p->at == '\\' && p->end - p->at > 1) p->at++;
    p->good &= p->at < p->end;
    p->at += p->at < p->end;
}

static inline bool ends_word(char c)
{
    return c == ',' || c == ']' || c == '}' || c == '[' || c == '{' || c == ':' || c == '"' || (c >= 0 && c <= ' ');
}

/* Goes behind a number or a word. */
static void skip_word(Pick *p)
{
    const char *from = p->at;
    while (p->at < p->end && !ends_word(*p->at)) p->at++;
    p->good &= p->at > from;
}

static void skip_value(Pick *p)
{
    if (p->at < p->end && *p->at != '"' && *p->at != '{' && *p->at != '[') {
        skip_word(p);
        return;
    }
    int depth = 0;
    do {
        const char c = p->at < p->end ? *p->at : 0;
        p->good &= p->at < p->end;
        if (c == '"') skip_text(p);
        else p->at++;
        depth += (c == '{' || c == '[') - (c == '}' || c == ']');
    } while (p->good && depth > 0);
}

static bool is_wanted(const Pick *p, const char *key, size_t length)
{
    if (length >= name_sizes || !(p->sizes >> length & 1)) return false;
    for (int i = 0; i < p->count; i++)
        if (p->names[i][0] == *key && strlen(p->names[i]) == length && memcmp(p->names[i], key, length) == 0)
            return true;
    return false;
}

static void pick_value(Pick *p, int depth);

static void pick_object(Pick *p, int depth)
{
    bool any = false;
    *p->out++ = '{';
    p->at++;
    for (bool first = true; p->good && !next_is(p, '}'); first = false) {
        if (!first && !next_is(p, ',')) p->good = false;
        p->at += !first && p->good;
        if (!next_is(p, '"')) p->good = false;
        if (!p->good) return;
        const char *key = p->at;
        skip_text(p);
        const size_t length = (size_t)(p->at - key);
        if (!p->good || !next_is(p, ':')) {
            p->good = false;
            return;
        }
        p->at++;
        skip_blanks(p);
        if (!is_wanted(p, key + 1, length - 2)) {
            skip_value(p);
            continue;
        }
        if (any) *p->out++ = ',';
        memcpy(p->out, key, length);
        p->out += length;
        *p->out++ = ':';
        any = true;
        pick_value(p, depth + 1);
    }
    if (!p->good) return; /* there may be no room for ends that the text does not have */
    p->at++;
    *p->out++ = '}';
}

static void pick_list(Pick *p, int depth)
{
    *p->out++ = '[';
    p->at++;
    for (bool first = true; p->good && !next_is(p, ']'); first = false) {
        if (!first && !next_is(p, ',')) p->good = false;
        if (!p->good) return;
        if (!first) *p->out++ = ',', p->at++;
        pick_value(p, depth + 1);
    }
    if (!p->good) return;
    p->at++;
    *p->out++ = ']';
}

static void pick_value(Pick *p, int depth)
{
    skip_blanks(p);
    if (depth > deepest || p->at >= p->end) p->good = false;
    if (!p->good) return;
    const char *from = p->at;
    if (*from == '{') {
        pick_object(p, depth);
    } else if (*from == '[') {
        pick_list(p, depth);
    } else {
        skip_value(p);
        copy(p, from);
    }
}

size_t json_pick(char *out, const char *text, size_t length, const char *const *names, int count)
{
    Pick p = {.at = text, .end = text + length, .out = out, .good = true, .names = names, .count = count};
    for (int i = 0; i < count; i++)
        if (strlen(names[i]) < name_sizes) p.sizes |= 1u << strlen(names[i]);
    pick_value(&p, 0);
    skip_blanks(&p);
    return p.good && p.at == p.end ? (size_t)(p.out - out) : 0;
}
