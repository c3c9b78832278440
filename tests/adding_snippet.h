/* tests/adding_snippet.h: what etc/ADDING.md shows is what a test does: its snippets stand in the test's own source, to
 * the letter but for blanks. */
#ifndef TESTS_ADDING_SNIPPET_H
#define TESTS_ADDING_SNIPPET_H

#include "tests/check.h"

/* The first place in `text` of the octets of `piece` up to `end`, blanks of both aside: behind it. NULL: there is none.
 */
static inline const char *adding_find(const char *text, const char *piece, const char *end)
{
    static const char blanks[] = " \t\n";
    for (; *text; text++) {
        const char *t = text, *p = piece;
        for (;;) {
            while (p < end && strchr(blanks, *p)) p++;
            if (p == end) return t;
            while (*t && strchr(blanks, *t)) t++;
            if (*t++ != *p++) break;
        }
    }
    return NULL;
}

/* Whether all of `shown` stands in `source`. An empty line or `...` is what is left out there: its pieces come in
 * their order. Nothing shown does not stand. */
static inline bool adding_stands(const char *shown, const char *source)
{
    if (!*shown) return false;
    while (source && *shown) {
        const char *line = strstr(shown, "\n\n"), *dots = strstr(shown, "...");
        const char *end = !line || (dots && dots < line) ? dots : line;
        if (!end) return adding_find(source, shown, shown + strlen(shown)) != NULL;
        source = adding_find(source, shown, end);
        shown = end + (end == dots ? 3 : 2);
    }
    return source != NULL;
}

/* The block of ADDING that is fenced as ```c TAG, the only one, stands in the file `source`. */
static inline void check_adding_snippet(const char *tag, const char *source)
{
    char  *page = NULL, *own = NULL, fence[64];
    size_t octets = 0;
    CHECK(text_read_file(&page, &octets, "test", "etc/ADDING.md", 1 << 20) == STATUS_OK);
    CHECK(text_read_file(&own, &octets, "test", source, 1 << 20) == STATUS_OK);
    snprintf(fence, sizeof fence, "```c %s\n", tag);
    char *shown = strstr(page, fence);
    CHECK(shown && !strstr(shown + 1, fence));
    shown += strlen(fence);
    char *end = strstr(shown, "```");
    CHECK(end != NULL);
    *end = 0;
    if (!adding_stands(shown, own)) fail_msg("%s has not what etc/ADDING.md shows as %s:\n%s", source, tag, shown);
    free(page);
    free(own);
}

#endif
