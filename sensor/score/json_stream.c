/* sensor/score/json_stream.c: lines of JSONL, and items of lists in a document, cut out of a file piece by piece. */
#include "sensor/score/json_stream.h"
#include "pitviper_file.h"

#include <errno.h>
#include <stdlib.h>

Status json_stream_open(JsonStream *out, const char *path, size_t most)
{
    char  why[file_why_size];
    FILE *file = file_open_stream(why, path);
    *out = (JsonStream){0};
    if (!file) {
        log_error("score: cannot read %s: %s", path, why);
        return STATUS_IO;
    }
    json_stream_of(out, file, path, most);
    return STATUS_OK;
}

void json_stream_of(JsonStream *out, FILE *file, const char *path, size_t most)
{
    *out = (JsonStream){.file = file, .most = most, .at_line = 1};
    snprintf(out->path, sizeof out->path, "%s", path);
}

void json_stream_close(JsonStream *s)
{
    if (s->file) fclose(s->file);
    free(s->text);
    *s = (JsonStream){0};
}

/* ---- octets --------------------------------------------------------------------------------------- */

static int take(JsonStream *s)
{
    const int c = getc_unlocked(s->file);
    s->at_line += c == '\n';
    return c;
}

static void give_back(JsonStream *s, int c)
{
    if (c == EOF) return;
    ungetc(c, s->file);
    s->at_line -= c == '\n';
}

static Status grow(JsonStream *s)
{
    if (s->room > s->most) {
        log_error("score: %s:%ld: more than %zu octets in one piece: this is no file of answers or of truth", s->path,
                  s->line, s->most);
        return STATUS_BAD_VALUE;
    }
    const size_t room = s->room ? 2 * s->room : 4096;
    char        *text = realloc(s->text, room);
    if (!text) return STATUS_NO_MEMORY;
    s->text = text;
    s->room = room;
    return STATUS_OK;
}

static inline Status keep(JsonStream *s, int c)
{
    if (s->length + 1 >= s->room) {
        const Status status = grow(s);
        if (status != STATUS_OK) return status;
    }
    s->text[s->length++] = (char)c;
    return STATUS_OK;
}

static Status end_piece(JsonStream *s)
{
    const Status status = keep(s, 0);
    if (status == STATUS_OK) s->length--;
    if (!ferror(s->file)) return status;
    log_error("score: cannot read %s: %s", s->path, strerror(errno));
    return STATUS_IO;
}

static Status wrong(const JsonStream *s, const char *what)
{
    log_error("score: %s:%ld: %s", s->path, s->at_line, what);
    return STATUS_BAD_VALUE;
}

/* ---- lines ---------------------------------------------------------------------------------------- */

Status json_stream_line(bool *more, JsonStream *s)
{
    int c = json_stream_peek(s);
    s->length = 0;
    s->line = s->at_line;
    *more = c != EOF;
    s->cut = false;
    while ((c = take(s)) != EOF && c != '\n') {
        const Status status = keep(s, c);
        if (status != STATUS_OK) return status;
    }
    s->cut = c == EOF;
    return end_piece(s);
}

int json_stream_peek(JsonStream *s)
{
    int c = take(s);
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n') c = take(s);
    give_back(s, c);
    return c;
}

/* ---- values --------------------------------------------------------------------------------------- */

static inline Status kept_if(JsonStream *s, int c, bool kept) { return kept ? keep(s, c) : STATUS_OK; }

/* Passes over a string whose first quote was taken, or keeps it. */
static Status rest_of_string(JsonStream *s, bool kept)
{
    for (;;) {
        int c = take(s);
        if (c == EOF) return wrong(s, "the file ends within a text");
        Status status = kept_if(s, c, kept);
        if (status == STATUS_OK && c == '\\') {
            if ((c = take(s)) == EOF) return wrong(s, "the file ends within a text");
            status = kept_if(s, c, kept);
            c = 0;
        }
        if (status != STATUS_OK || c == '"') return status;
    }
}

/* Passes over the next value, or keeps it as the piece. Only brackets and texts are looked at. */
static Status value(JsonStream *s, bool kept)
{
    enum { deepest = 64 };
    int    depth = 0, c = json_stream_peek(s);
    Status status = STATUS_OK;
    s->length = 0;
    s->line = s->at_line;
    if (c == ',' || c == ']' || c == '}' || c == ':') return wrong(s, "a value is missing: this is not JSON");
    do {
        if ((c = take(s)) == EOF) {
            if (depth > 0) return wrong(s, "the file ends within a value; is it complete?");
            break;
        }
        if (depth == 0 && (c == ',' || c == ']' || c == '}')) {
            give_back(s, c);
            break;
        }
        status = kept_if(s, c, kept);
        if (status == STATUS_OK && c == '"') status = rest_of_string(s, kept);
        depth += (c == '{' || c == '[') - (c == '}' || c == ']');
        if (depth > deepest) return wrong(s, "more than 64 levels: this is no file of answers or of truth");
    } while (status == STATUS_OK && !(depth == 0 && (c == '}' || c == ']')));
    return status == STATUS_OK ? end_piece(s) : status;
}

/* Passes the comma before an item but the first; *more false: `end` has been taken. */
static Status next_of(bool *more, JsonStream *s, bool *first, int end)
{
    int c = json_stream_peek(s);
    *more = c != end;
    if (c == end) take(s);
    else if (!*first && c != ',') return wrong(s, "a comma is missing, or the file is not complete");
    else if (!*first) take(s);
    if (c == EOF) return wrong(s, "the file ends within a list; is it complete?");
    *first = false;
    return STATUS_OK;
}

Status json_lists_item(bool *more, JsonLists *l)
{
    bool   first = l->first;
    Status status = next_of(more, l->stream, &first, ']');
    l->first = false;
    if (status == STATUS_OK && *more) status = value(l->stream, true);
    l->in_list = status == STATUS_OK && *more;
    return status;
}

static Status begin(bool *more, JsonLists *l)
{
    JsonStream *s = l->stream;
    const int   c = json_stream_peek(s);
    l->begun = true;
    if (c != '[' && c != '{') return wrong(s, "neither an object nor a list of JSON begins here");
    take(s);
    l->whole = l->in_list = c == '[';
    l->first = *more = true;
    return STATUS_OK;
}

static Status read_key(JsonLists *l)
{
    JsonStream *s = l->stream;
    if (json_stream_peek(s) != '"') return wrong(s, "a key is missing: this is not JSON");
    s->line = s->at_line;
    s->length = 0;
    take(s);
    Status status = rest_of_string(s, true);
    if (status == STATUS_OK) status = end_piece(s);
    if (status != STATUS_OK) return status;
    s->text[s->length - 1] = 0; /* its last quote */
    snprintf(l->key, sizeof l->key, "%s", s->text);
    if (json_stream_peek(s) != ':') return wrong(s, "a colon is missing: this is not JSON");
    take(s);
    return STATUS_OK;
}

Status json_lists_next(bool *more, JsonLists *l)
{
    Status status = STATUS_OK;
    bool   first = !l->begun;
    *more = false;
    if (!l->begun) {
        status = begin(more, l);
        if (status != STATUS_OK || l->whole) return status;
    }
    for (bool items = l->in_list; items && status == STATUS_OK;) status = json_lists_item(&items, l);
    if (l->whole) {
        *more = false;
        return status;
    }
    while (status == STATUS_OK) {
        status = next_of(more, l->stream, &first, '}');
        if (status != STATUS_OK || !*more) return status;
        status = read_key(l);
        if (status != STATUS_OK) return status;
        if (json_stream_peek(l->stream) == '[') {
            take(l->stream);
            l->in_list = l->first = true;
            return STATUS_OK;
        }
        status = value(l->stream, false);
    }
    return status;
}
