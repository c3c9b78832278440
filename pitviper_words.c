/* pitviper_words.c: the known word that a mistyped one was probably meant to be, for every "did you mean". */
#include "pitviper.h"

#include <ctype.h>

enum { word_size = 64 };

/* Edit distance of two words: insertions, deletions, substitutions and transpositions; letters of either case are
 * equal. At most 63 letters. */
static int slips(const char *a, const char *b)
{
    int       row[3][word_size], n = (int)strlen(b);
    const int m = (int)strlen(a);
    if (m >= word_size || n >= word_size) return word_size;
    for (int j = 0; j <= n; j++) row[0][j] = j;
    for (int i = 1; i <= m; i++) {
        int       *now = row[i % 3];
        const int *above = row[(i + 2) % 3], *before = row[(i + 1) % 3];
        const int  letter = tolower((unsigned char)a[i - 1]);
        now[0] = i;
        for (int j = 1; j <= n; j++) {
            const int other = above[j - 1] + (letter != tolower((unsigned char)b[j - 1]));
            const int missing = above[j] + 1, more = now[j - 1] + 1;
            now[j] = other < missing ? other : missing;
            if (more < now[j]) now[j] = more;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && before[j - 2] + 1 < now[j])
                now[j] = before[j - 2] + 1;
        }
    }
    return row[m % 3][n];
}

WordMeant word_meant(const char *typed)
{
    const size_t length = strlen(typed);
    return (WordMeant){.typed = typed, .least = length < 3 ? 1 : length < 6 ? 2 : 3};
}

void word_consider(WordMeant *meant, const char *known)
{
    const int n = *known ? slips(meant->typed, known) : word_size;
    /* two words of two letters that share none are no slip of each other */
    if (n >= meant->least || n >= (int)strlen(known)) return;
    meant->least = n;
    snprintf(meant->word, sizeof meant->word, "%s", known);
}

void word_consider_list(WordMeant *meant, const char *list, char separator)
{
    char known[word_size];
    for (const char *at = list; at && *at;) {
        const char  *end = strchr(at, separator);
        const size_t length = end ? (size_t)(end - at) : strlen(at);
        if (length < sizeof known) {
            memcpy(known, at, length);
            known[length] = 0;
            word_consider(meant, known);
        }
        at = end ? end + 1 : NULL;
    }
}

const char *word_hint(WordMeant *meant)
{
    meant->hint[0] = 0;
    if (meant->word[0]) snprintf(meant->hint, sizeof meant->hint, "; did you mean %s?", meant->word);
    return meant->hint;
}
