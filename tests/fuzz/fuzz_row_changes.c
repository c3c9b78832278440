/* tests/fuzz/fuzz_row_changes.c: any octets as two versions of a table, apart at the first octet 1. Mixed without a
 * change they are the old rows, with all changes the new ones. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "sensor/verify/bisect/row_changes.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char *const seed[2] = {
    "# paints\nname,rho,gloss\nred,0.1,0.5\ngreen,0.2,0.5\nblue,0.3,0.5\n\1name,rho,gloss\nred,0.1,0.5\n"
    "black,0.02,0.1\ngreen,0.25,0.5\n",
    "a\n1\n2\n3\n4\n\1a\n1\n3\n2\n4\n",
};

size_t fuzz_seed(uint8_t *out, uint32_t index) { return fuzz_seed_text(out, seed[index % 2]); }

/* The rows of one side, as row_changes_write puts them. */
static char *rows_of(const RowSide *side)
{
    char  *text = NULL;
    size_t octets;
    FILE  *to = open_memstream(&text, &octets);
    for (int i = 0; to && i < side->rows; i++) fprintf(to, "%s\n", side->row[i]);
    if (!to || fclose(to) != 0) abort();
    return text;
}

static void compare(const RowChanges *c, bool new)
{
    bool  *is_new = malloc((size_t)c->count + 1);
    char  *text = NULL, *want = rows_of(new ? &c->new : &c->old);
    size_t octets;
    FILE  *to = open_memstream(&text, &octets);
    if (!to || !is_new) abort();
    memset(is_new, new, (size_t)c->count + 1);
    row_changes_write(to, c, is_new);
    if (fclose(to) != 0 || strcmp(text, want) != 0) abort();
    free(is_new);
    free(text);
    free(want);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char       *text = malloc(size + 1), said[600];
    const char *why;
    RowChanges  c;
    if (!text) return 0;
    memcpy(text, data, size);
    text[size] = 0;
    char *second = strchr(text, 1);
    if (second) *second++ = 0;
    const Status status = row_changes_of(&c, &why, text, second ? second : text);
    if ((status == STATUS_UNSUPPORTED) != (why != NULL)) abort();
    if (status == STATUS_OK) {
        if (c.count > row_changes_most || (!second && c.count != 0)) abort();
        for (int i = 0; i < c.count; i++) row_changes_say(said, sizeof said, &c, i);
        compare(&c, false);
        compare(&c, true);
        row_changes_free(&c);
    }
    free(text);
    return 0;
}
