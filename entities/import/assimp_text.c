/* entities/import/assimp_text.c: texts that assimp reads: OBJ files in the forms that it understands, and the units of
 * length that it does not hand on. */

#include "entities/import/reader_private.h"

#include <ctype.h>
#include <stdlib.h>
#include <strings.h>
#include <zlib.h>

/* ---- words of a text ------------------------------------------------------------------------ */

/* As isspace(), but inlined, since files have millions of characters. */
static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/* A word of a text: what is between blanks. */
typedef struct Word {
    const char *at;
    size_t      length;
} Word;

/* The next word of [*at, end), which it moves; length 0: none. */
static Word next_word(const char **at, const char *end)
{
    const char *from = *at;
    while (from < end && is_blank(*from)) from++;
    Word word = {from, 0};
    while (from + word.length < end && !is_blank(from[word.length])) word.length++;
    *at = from + word.length;
    return word;
}

static bool word_is(Word word, const char *text)
{
    return word.length == strlen(text) && memcmp(word.at, text, word.length) == 0;
}

/* ---- OBJ --------------------------------------------------------------------------------------- */

/* An OBJ file in the forms that assimp reads.
 *
 * assimp 5.2 counts a vertex's numbers by their first characters: `v .6 -1 0` has two to it and is dropped without a
 * word, which moves the index of all that follow; a vertex of 5 or 7 numbers, a statement behind blanks, an index `+1`
 * or `01` fare no better. So each statement is written anew, in its plainest form: `1e-3` becomes `0.001`, digit by
 * digit, the same number. What is plain already keeps its octets. */

enum { most_shift = 60 }; /* largest shift by an exponent: beyond it a number is 0 or too large anyway */

typedef struct Out {
    char  *text;
    size_t octets, room;
    bool   no_memory;
} Out;

static void put(Out *out, const char *bytes, size_t count)
{
    if (out->octets + count + 1 > out->room && !out->no_memory) {
        const size_t room = 2 * out->room + count + 4096;
        char        *larger = realloc(out->text, room);
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
    char   text[16];
    size_t at = sizeof text;
    for (long rest = labs(value); rest > 0; rest /= 10) text[--at] = (char)('0' + rest % 10);
    if (value < 0) text[--at] = '-';
    put(out, text + at, sizeof text - at);
}

/* Writes a decimal number without exponent, `+`, or a missing digit before or after its point. False: it is no number;
 * nan and inf are, as they stand. */
static bool put_number(Out *out, Word word)
{
    const char *at = word.at, *end = at + word.length;
    char        digits[512];
    int         count = 0, before = 0, shift = 0;
    bool        point = false;
    const char *plain = at + (at < end && *at == '-'), *fraction = plain;
    while (fraction < end && is_digit(*fraction)) fraction++;
    if (fraction > plain && (fraction == end || (*fraction == '.' && end - fraction > 1))) {
        const char *rest = fraction + (fraction < end);
        while (rest < end && is_digit(*rest)) rest++;
        if (rest == end) { /* the whole number is copied, as most can be */
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
        if (count < (int)sizeof digits - 2 * most_shift) digits[count++] = *at;
        else if (point) continue; /* a double does not hold these digits */
        else return false;
        before += !point;
    }
    if (count == 0) return false;
    if (at < end && (*at == 'e' || *at == 'E')) {
        char         exponent[16];
        const size_t length = (size_t)(end - at - 1);
        if (length == 0 || length >= sizeof exponent) return false;
        memcpy(exponent, at + 1, length);
        exponent[length] = 0;
        char      *rest;
        const long value = strtol(exponent, &rest, 10);
        if (*rest || isspace((unsigned char)*exponent)) return false;
        shift = value > most_shift ? most_shift : value < -most_shift ? -most_shift : (int)value;
        at = end;
    }
    if (at != end) return false;
    for (; before + shift < 1 && count < (int)sizeof digits; before++, count++) { /* adds zeros in front */
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

/* Writes the numbers of `v` x y z [w | r g b ...] or `vn` x y z; those beyond are colours. */
static bool put_numbers(Out *out, const char *name, const char *at, const char *end)
{
    Word       word[8];
    int        count = 0;
    const bool normal = name[1] == 'n';
    for (Word w; (w = next_word(&at, end)).length > 0 && w.at[0] != '#';)
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
    const bool  minus = *at < end && **at == '-';
    const char *from = *at + (*at < end && (**at == '-' || **at == '+'));
    long        value = 0;
    int         digits = 0;
    for (; from < end && is_digit(*from) && value < 1000000000; from++, digits++) value = 10 * value + (*from - '0');
    *at = from;
    *out = minus ? -value : value;
    return digits > 0 && value > 0;
}

/* Writes the corners of `f` or `l`, v/vt/vn ...: without vt, and with vn where all corners of the face have one. */
static bool put_corners(Out *out, const char *name, const char *at, const char *end)
{
    const char *again = at;
    bool        normals = name[0] == 'f';
    for (int pass = 0; pass < 2; pass++, at = again) {
        if (pass) put(out, name, 1);
        for (Word w; (w = next_word(&at, end)).length > 0 && w.at[0] != '#';) {
            const char *c = w.at, *stop = w.at + w.length;
            long        v, vt, vn = 0;
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
    char   path[1024], *bytes = NULL;
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
    Out         out = {0}, joined = {0};
    Status      status = STATUS_OK;
    for (int line = 1; at < end && status == STATUS_OK;) {
        /* reads a statement; a line that ends with `\` goes on */
        const int   first = line;
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
        const Word word = next_word(&s, tail);
        bool       fine = true;
        if (word.length == 0 || word.at[0] == '#' || word_is(word, "vt")) continue;
        if (word_is(word, "v")) fine = put_numbers(&out, "v", s, tail);
        else if (word_is(word, "vn")) fine = put_numbers(&out, "vn", s, tail);
        else if (word_is(word, "f")) fine = put_corners(&out, "f", s, tail);
        else if (word_is(word, "l")) fine = put_corners(&out, "l", s, tail);
        else {
            lost[LOST_OTHER] += word_is(word, "surf") || word_is(word, "curv");
            if (word_is(word, "mtllib")) look_for(files, said, s, tail);
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

/* ---- units: what comments say ------------------------------------------------------------------------------ */

/* Longest first: `centimetres` has `metres` in it. */
static const struct {
    const char *word;
    double      unit_m;
} units[] = {{"millimet", 0.001}, {"centimet", 0.01}, {"decimet", 0.1}, {"kilomet", 1000}, {"inches", 0.0254},
             {"inch", 0.0254},    {"feet", 0.3048},   {"foot", 0.3048}, {"yard", 0.9144},  {"meter", 1},
             {"metre", 1},        {"mm", 0.001},      {"cm", 0.01},     {"ft", 0.3048},    {"m", 1}};

double import_comment_unit(char word[24], const char *text, size_t octets)
{
    const char *at = text, *end = text + (octets < 65536 ? octets : 65536);
    for (int line = 0; at < end && line < 200; line++) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        if (!stop) stop = end;
        Word        first = next_word(&at, stop);
        const bool  comment = first.length > 0 && (first.at[0] == '#' || word_is(first, "comment") ||
                                                  word_is(first, "obj_info") || (line == 0 && word_is(first, "solid")));
        const char *unit = NULL;
        for (const char *c = first.at; comment && c + 4 <= stop && !unit; c++)
            if (strncasecmp(c, "unit", 4) == 0) unit = c;
        if (unit) {
            char   lower[200];
            size_t n = 0;
            for (const char *c = first.at; c < stop && n < sizeof lower - 1; c++)
                lower[n++] = c >= unit && c < unit + 5    ? ' '
                             : isalpha((unsigned char)*c) ? (char)tolower((unsigned char)*c)
                                                          : ' ';
            lower[n] = 0;
            const char *from = lower;
            for (Word w; (w = next_word(&from, lower + n)).length > 0;)
                for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
                    const size_t length = strlen(units[u].word);
                    if (length > w.length || strncmp(w.at, units[u].word, length) != 0) continue;
                    if (length < 4 && length != w.length) continue; /* `m` and `mm` count only as whole words */
                    snprintf(word, 24, "%.*s", (int)w.length, w.at);
                    return units[u].unit_m;
                }
        }
        at = stop < end ? stop + 1 : end;
    }
    return 0;
}

/* ---- units: what formats say ------------------------------------------------------------------------------- */

/* A 3MF file's model is a part of a ZIP archive: the beginning of the first whose name ends with `.model`. Returns
 * octets. */
static size_t unzip_model(char *out, size_t size, const char *bytes, size_t octets)
{
    const uint8_t *b = (const uint8_t *)bytes;
    for (size_t at = 0; at + 30 <= octets;) {
        const uint8_t *head = memmem(b + at, octets - at, "PK\3\4", 4);
        if (!head || (size_t)(b + octets - head) < 30) return 0;
        const size_t name = head[26] | (size_t)head[27] << 8, extra = head[28] | (size_t)head[29] << 8;
        const size_t left = (size_t)(b + octets - head) - 30;
        const int    method = head[8] | head[9] << 8;
        at = (size_t)(head - b) + 4;
        if (name < 6 || name + extra > left || memcmp(head + 30 + name - 6, ".model", 6) != 0) continue;
        const uint8_t *from = head + 30 + name + extra;
        const size_t   rest = left - name - extra;
        if (method == 0) {
            memcpy(out, from, rest < size ? rest : size);
            return rest < size ? rest : size;
        }
        z_stream z = {.next_in = (Bytef *)(uintptr_t)from,
                      .avail_in = (uInt)rest,
                      .next_out = (Bytef *)out,
                      .avail_out = (uInt)size};
        if (method != 8 || inflateInit2(&z, -MAX_WBITS) != Z_OK) return 0;
        inflate(&z, Z_SYNC_FLUSH);
        inflateEnd(&z);
        return size - z.avail_out;
    }
    return 0;
}

/* `<model unit="inch">`, `<amf unit="inch">`; millimetres where it says none: both standards have that default. */
static double printed_unit(char word[24], const char *text, size_t octets)
{
    static const struct {
        const char *word;
        double      unit_m;
    } known[] = {{"micron", 1e-6}, {"millimeter", 0.001}, {"centimeter", 0.01}, {"inch", 0.0254},
                 {"foot", 0.3048}, {"feet", 0.3048},      {"meter", 1}};
    const char *element = memmem(text, octets, "<model", 6), *at;
    if (!element) element = memmem(text, octets, "<amf", 4);
    const char *end = element ? memchr(element, '>', octets - (size_t)(element - text)) : NULL;
    snprintf(word, 24, "%s", "");
    if (!end || !(at = memmem(element, (size_t)(end - element), "unit=", 5))) return 0.001;
    at += 6;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if ((size_t)(end - at) > strlen(known[i].word) && strncasecmp(at, known[i].word, strlen(known[i].word)) == 0) {
            snprintf(word, 24, "%s", known[i].word);
            return known[i].unit_m;
        }
    return 0.001;
}

/* $INSUNITS of a drawing's header; 0: none, or a drawing without unit. */
static double drawing_unit(char word[24], const char *text, size_t octets)
{
    static const double unit_m[] = {0, 0.0254, 0.3048, 1609.344, 0.001, 0.01, 1,  1000, 0,
                                    0, 0.9144, 0,      0,        1e-6,  0.1,  10, 100};
    const char         *at = memmem(text, octets, "$INSUNITS", 9), *end = text + octets;
    char                number[8] = "";
    long long           code;
    if (!at) return 0;
    at += 9;
    const bool integer = word_is(next_word(&at, end), "70");
    const Word value = next_word(&at, end);
    if (value.length < sizeof number) memcpy(number, value.at, value.length), number[value.length] = 0;
    if (!integer || !text_to_long(&code, number) || code < 0 || code >= (long long)(sizeof unit_m / sizeof *unit_m))
        return 0;
    snprintf(word, 24, "$INSUNITS %lld", code);
    return unit_m[code];
}

double import_stated_unit(char word[24], const char *extension, const char *bytes, size_t octets)
{
    static char model[1 << 14];
    if (strcmp(extension, "dxf") == 0) return drawing_unit(word, bytes, octets);
    if (strcmp(extension, "amf") == 0 && (octets < 2 || memcmp(bytes, "PK", 2) != 0))
        return printed_unit(word, bytes, octets);
    if (strcmp(extension, "3mf") != 0 && strcmp(extension, "amf") != 0) return 0;
    const size_t got = unzip_model(model, sizeof model, bytes, octets);
    return printed_unit(word, model, got);
}
