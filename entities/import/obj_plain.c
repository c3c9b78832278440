/* entities/import/obj_plain.c: an OBJ file in the forms that assimp reads.
 *
 * assimp 5.2 counts a vertex's numbers by their first characters: `v .6 -1 0` has two to it and is dropped without a
 * word, which moves the index of all that follow; a vertex of 5 or 7 numbers, a statement behind blanks, an index `+1`
 * or `01` fare no better. So each statement is written anew, in its plainest form: `1e-3` becomes `0.001`, digit by
 * digit, the same number. What is plain already keeps its octets. */
#include "entities/import/reader.h"

#include <ctype.h>
#include <stdlib.h>
#include <strings.h>

enum { most_shift = 60 }; /* of an exponent: beyond it a number is 0 or too large anyway */

typedef struct Out {
    char *text;
    size_t octets, room;
    bool no_memory;
} Out;

static void put(Out *out, const char *bytes, size_t count)
{
    if (out->octets + count + 1 > out->room && !out->no_memory) {
        const size_t room = 2 * out->room + count + 4096;
        char *larger = realloc(out->text, room);
        out->no_memory = !larger;
        if (larger) out->text = larger, out->room = room;
    }
    if (out->no_memory) return;
    memcpy(out->text + out->octets, bytes, count);
    out->octets += count;
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

static void put_index(Out *out, long value)
{
    char text[16];
    size_t at = sizeof text;
    for (long rest = labs(value); rest > 0; rest /= 10) text[--at] = (char)('0' + rest % 10);
    if (value < 0) text[--at] = '-';
    put(out, text + at, sizeof text - at);
}

/* Writes a decimal number without exponent, `+`, or a missing digit before or after its point. False: it is no number;
 * nan and inf are, as they stand. */
static bool put_number(Out *out, ReaderWord word)
{
    const char *at = word.at, *end = at + word.length;
    char digits[512];
    int count = 0, before = 0, shift = 0;
    bool point = false;
    const char *plain = at + (at < end && *at == '-'), *fraction = plain;
    while (fraction < end && is_digit(*fraction)) fraction++;
    if (fraction > plain && (fraction == end || (*fraction == '.' && end - fraction > 1))) {
        const char *rest = fraction + (fraction < end);
        while (rest < end && is_digit(*rest)) rest++;
        if (rest == end) { /* as nearly all are */
            put(out, word.at, word.length);
            return true;
        }
    }
    const bool minus = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) at++;
    if ((end - at == 3 && (strncasecmp(at, "nan", 3) == 0 || strncasecmp(at, "inf", 3) == 0))) {
        put(out, word.at, word.length);
        return true;
    }
    for (; at < end && (is_digit(*at) || (*at == '.' && !point)); at++) {
        point = point || *at == '.';
        if (*at == '.') continue;
        if (count < (int)sizeof digits - 2 * most_shift)
            digits[count++] = *at;
        else if (point)
            continue; /* digits that no double holds */
        else
            return false;
        before += !point;
    }
    if (count == 0) return false;
    if (at < end && (*at == 'e' || *at == 'E')) {
        char exponent[16];
        const size_t length = (size_t)(end - at - 1);
        if (length == 0 || length >= sizeof exponent) return false;
        memcpy(exponent, at + 1, length);
        exponent[length] = 0;
        char *rest;
        const long value = strtol(exponent, &rest, 10);
        if (*rest || isspace((unsigned char)*exponent)) return false;
        shift = value > most_shift ? most_shift : value < -most_shift ? -most_shift : (int)value;
        at = end;
    }
    if (at != end) return false;
    for (; before + shift < 1 && count < (int)sizeof digits; before++, count++) { /* zeros before */
        memmove(digits + 1, digits, (size_t)count);
        digits[0] = '0';
    }
    while (before + shift > count && count < (int)sizeof digits) digits[count++] = '0';
    before += shift;
    if (minus) put(out, "-", 1);
    put(out, digits, (size_t)before);
    if (count > before) {
        put(out, ".", 1);
        put(out, digits + before, (size_t)(count - before));
    }
    return true;
}

/* `v` x y z [w | r g b ...], `vn` x y z: numbers beyond those are colours. */
static bool put_numbers(Out *out, const char *name, const char *at, const char *end)
{
    ReaderWord word[8];
    int count = 0;
    const bool normal = name[1] == 'n';
    for (ReaderWord w; (w = reader_word(&at, end)).length > 0 && w.at[0] != '#';)
        if (count < 8) word[count++] = w;
    if (count < 3) return false;
    if (count > 3) count = count == 4 && !normal ? 4 : 3;
    put(out, name, strlen(name));
    for (int i = 0; i < count; i++) {
        put(out, " ", 1);
        if (!put_number(out, word[i])) return false;
    }
    put(out, "\n", 1);
    return true;
}

/* Reads `5`, `-2`, `+1`, `007`; false: none, or 0. */
static bool read_index(long *out, const char **at, const char *end)
{
    const bool minus = *at < end && **at == '-';
    const char *from = *at + (*at < end && (**at == '-' || **at == '+'));
    long value = 0;
    int digits = 0;
    for (; from < end && is_digit(*from) && value < 1000000000; from++, digits++) value = 10 * value + (*from - '0');
    *at = from;
    *out = minus ? -value : value;
    return digits > 0 && value > 0;
}

/* `f` and `l` v/vt/vn ...: without vt, and with vn where all of the face have one. */
static bool put_corners(Out *out, const char *name, const char *at, const char *end)
{
    const char *again = at;
    bool normals = name[0] == 'f';
    for (int pass = 0; pass < 2; pass++, at = again) {
        if (pass) put(out, name, 1);
        for (ReaderWord w; (w = reader_word(&at, end)).length > 0 && w.at[0] != '#';) {
            const char *c = w.at, *stop = w.at + w.length;
            long v, vt, vn = 0;
            if (!read_index(&v, &c, stop)) return false;
            if (c < stop && *c == '/') {
                c++;
                if (c < stop && *c != '/' && !read_index(&vt, &c, stop)) return false;
                if (c < stop && *c == '/') {
                    c++;
                    if (c < stop && !read_index(&vn, &c, stop)) return false;
                }
            }
            if (c != stop) return false;
            normals = normals && vn != 0;
            if (!pass) continue;
            put(out, " ", 1);
            put_index(out, v);
            if (normals) put(out, "//", 2), put_index(out, vn);
        }
    }
    put(out, "\n", 1);
    return true;
}

static void look_for(ReaderFiles *files, ReaderSaid *said, const char *at, const char *end)
{
    char path[1024], *bytes = NULL;
    size_t octets;
    while (at < end && isspace((unsigned char)*at)) at++;
    if (!files || at == end) return;
    snprintf(path, sizeof path, "%.*s%.*s", (int)files->folder, files->shown, (int)(end - at), at);
    if (!*files->refused && reader_read(&bytes, &octets, files, path) != STATUS_OK && !*files->refused)
        reader_warns(said, "its materials, %.*s, are not there: colours are lost",
                     (int)(end - at < 100 ? end - at : 100), at);
    free(bytes);
}

Status import_obj_plain(char **text, size_t *octets, int lost[IMPORT_LOST_COUNT], ReaderSaid *said, ReaderFiles *files)
{
    const char *at = *text, *end = *text + *octets;
    Out out = {0}, joined = {0};
    Status status = STATUS_OK;
    for (int line = 1; at < end && status == STATUS_OK;) {
        /* a statement: lines that end with `\` go on */
        const int first = line;
        const char *s = at, *tail = at;
        joined.octets = 0;
        for (bool more = true; more && at < end; line++) {
            const char *stop = at; /* LF, CR LF, or CR alone */
            while (stop < end && *stop != '\n' && *stop != '\r') stop++;
            const char *next = stop + (end - stop > 1 && stop[0] == '\r' && stop[1] == '\n' ? 2 : stop < end);
            while (stop > at && isspace((unsigned char)stop[-1])) stop--;
            const char *begin = at;
            while (begin < stop && isspace((unsigned char)*begin)) begin++;
            more = stop > begin && stop[-1] == '\\' && (*begin != '#' || joined.octets > 0);
            tail = stop;
            if (more || joined.octets > 0) {
                put(&joined, at, (size_t)(stop - at - more));
                put(&joined, " ", 1);
            }
            at = next;
        }
        if (joined.no_memory) break;
        if (joined.octets > 0) s = joined.text, tail = s + joined.octets;
        while (tail > s && (isspace((unsigned char)tail[-1]) || tail[-1] == '\\')) tail--;
        const ReaderWord word = reader_word(&s, tail);
        bool fine = true;
        if (word.length == 0 || word.at[0] == '#' || reader_word_is(word, "vt")) continue;
        if (reader_word_is(word, "v"))
            fine = put_numbers(&out, "v", s, tail);
        else if (reader_word_is(word, "vn"))
            fine = put_numbers(&out, "vn", s, tail);
        else if (reader_word_is(word, "f"))
            fine = put_corners(&out, "f", s, tail);
        else if (reader_word_is(word, "l"))
            fine = put_corners(&out, "l", s, tail);
        else {
            lost[LOST_OTHER] += reader_word_is(word, "surf") || reader_word_is(word, "curv");
            if (reader_word_is(word, "mtllib")) look_for(files, said, s, tail);
            put(&out, word.at, word.length);
            for (const char *c = s; c < tail; c++) put(&out, *c == '\t' ? " " : c, 1);
            put(&out, "\n", 1);
        }
        if (!fine)
            status = reader_fails(said, STATUS_BAD_VALUE, "line %d: `%.*s` is no %s", first,
                                  (int)(tail - word.at < 80 ? tail - word.at : 80), word.at,
                                  word.at[0] == 'v' ? "three numbers, as a vertex or normal has"
                                                    : "list of indices, as a face or line has");
    }
    put(&out, "", 1);
    free(joined.text);
    if (out.no_memory || joined.no_memory) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        free(out.text);
        return status;
    }
    free(*text);
    *text = out.text;
    *octets = out.octets - 1;
    return STATUS_OK;
}
