/* entities/import/osg_text.c: the lines that osgconv writes as a tree of elements. */
#include "entities/import/osg_private.h"

#include <stdlib.h>

/* Words of one line in place; `"a b"` is one, without its quotes. False: no memory. */
static bool split_words(OsgText *x, char *line)
{
    for (char *at = line;;) {
        while (*at == ' ' || *at == '\t' || *at == '\r') at++;
        if (!*at) return true;
        if (x->word_count == x->word_room) {
            const int room = x->word_room ? 2 * x->word_room : 4096;
            char **grown = realloc(x->word, (size_t)room * sizeof *grown);
            if (!grown) return false;
            x->word = grown;
            x->word_room = room;
        }
        if (*at == '"') {
            char *to = ++at;
            x->word[x->word_count++] = at;
            while (*at && *at != '"') {
                if (*at == '\\' && at[1]) at++;
                *to++ = *at++;
            }
            if (*at) at++;
            *to = 0;
        } else {
            x->word[x->word_count++] = at;
            while (*at && *at != ' ' && *at != '\t' && *at != '\r') at++;
            if (*at) *at++ = 0;
        }
    }
}

const char *osg_word(const OsgText *x, int element, int index)
{
    const OsgElement *e = &x->element[element];
    return index < e->words ? x->word[e->first_word + index] : "";
}

static Status read_tree(OsgText *x, char *text)
{
    enum { depth_max = 2048 };
    int open[depth_max], last[depth_max];
    int depth = 0;
    open[0] = last[0] = -1;
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        const int first = x->word_count;
        if (*line == '#') continue;
        if (!split_words(x, line)) return STATUS_NO_MEMORY;
        int words = x->word_count - first;
        if (words == 0) continue;
        if (words == 1 && strcmp(x->word[first], "}") == 0) {
            if (depth == 0) return STATUS_BAD_VALUE;
            depth--;
            x->word_count = first;
            continue;
        }
        const bool opens = strcmp(x->word[first + words - 1], "{") == 0;
        if (opens) words--;
        if (x->element_count == x->element_room) {
            const int room = x->element_room ? 2 * x->element_room : 4096;
            OsgElement *grown = realloc(x->element, (size_t)room * sizeof *grown);
            if (!grown) return STATUS_NO_MEMORY;
            x->element = grown;
            x->element_room = room;
        }
        const int e = x->element_count++;
        x->element[e] = (OsgElement){first, words, -1, -1};
        if (last[depth] >= 0)
            x->element[last[depth]].next = e;
        else if (open[depth] >= 0)
            x->element[open[depth]].child = e;
        last[depth] = e;
        if (!opens) continue;
        if (++depth == depth_max) return STATUS_BAD_VALUE;
        open[depth] = e;
        last[depth] = -1;
    }
    return depth == 0 && x->element_count > 0 ? STATUS_OK : STATUS_BAD_VALUE;
}

/* The child with this first word; -1: none. */
int osg_find(const OsgText *x, int element, const char *name)
{
    if (element < 0) return -1;
    for (int c = x->element[element].child; c >= 0; c = x->element[c].next)
        if (strcmp(osg_word(x, c, 0), name) == 0) return c;
    return -1;
}

static long long id_of(const OsgText *x, int element)
{
    long long id = -1;
    const int c = osg_find(x, element, "UniqueID");
    return c >= 0 && text_to_long(&id, osg_word(x, c, 1)) && id >= 0 && id < x->id_count ? id : -1;
}

/* A repeated object is its id alone. */
int osg_resolve(const OsgText *x, int element)
{
    const long long id = id_of(x, element);
    return id >= 0 && x->by_id[id] >= 0 ? x->by_id[id] : element;
}

static Status number_objects(OsgText *x)
{
    x->id_count = x->element_count + 1; /* ids count objects, and an object is more than one element */
    x->by_id = malloc((size_t)x->id_count * sizeof *x->by_id);
    if (!x->by_id) return STATUS_NO_MEMORY;
    for (int i = 0; i < x->id_count; i++) x->by_id[i] = -1;
    for (int e = 0; e < x->element_count; e++) {
        const int first = x->element[e].child;
        const long long id = first >= 0 && x->element[first].next >= 0 ? id_of(x, e) : -1;
        if (id >= 0 && x->by_id[id] < 0) x->by_id[id] = e;
    }
    return STATUS_OK;
}

/* Numbers among an element's words from `from` on; false when there are fewer than count. */
bool osg_numbers(double *out, int count, const OsgText *x, int element, int from)
{
    for (int i = 0; i < count; i++)
        if (element < 0 || !text_to_double(out + i, osg_word(x, element, from + i))) return false;
    return true;
}

Status osg_text_open(OsgText *out, const char *path, char *text, size_t octets)
{
    *out = (OsgText){.path = path};
    const Status status = strlen(text) == octets ? read_tree(out, text) : STATUS_BAD_VALUE;
    return status == STATUS_OK ? number_objects(out) : status;
}

void osg_text_close(OsgText *x)
{
    free(x->element);
    free(x->word);
    free(x->by_id);
}
