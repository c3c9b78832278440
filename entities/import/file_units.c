/* entities/import/file_units.c: the unit of length that a file's own text names, where the library that reads the file
 * does not hand it on. */
#include "entities/import/reader.h"

#include <ctype.h>
#include <strings.h>
#include <zlib.h>

/* As isspace() has it, without a call: these are read by the million. */
static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

ReaderWord reader_word(const char **at, const char *end)
{
    const char *from = *at;
    while (from < end && is_blank(*from)) from++;
    ReaderWord word = {from, 0};
    while (from + word.length < end && !is_blank(from[word.length])) word.length++;
    *at = from + word.length;
    return word;
}

bool reader_word_is(ReaderWord word, const char *text)
{
    return word.length == strlen(text) && memcmp(word.at, text, word.length) == 0;
}

/* ---- what comments say ------------------------------------------------------------------------------ */

/* Longest first: `centimetres` has `metres` in it. */
static const struct {
    const char *word;
    double unit_m;
} units[] = {{"millimet", 0.001}, {"centimet", 0.01}, {"decimet", 0.1}, {"kilomet", 1000}, {"inches", 0.0254},
             {"inch", 0.0254},    {"feet", 0.3048},   {"foot", 0.3048}, {"yard", 0.9144},  {"meter", 1},
             {"metre", 1},        {"mm", 0.001},      {"cm", 0.01},     {"ft", 0.3048},    {"m", 1}};

double import_comment_unit(char word[24], const char *text, size_t octets)
{
    const char *at = text, *end = text + (octets < 65536 ? octets : 65536);
    for (int line = 0; at < end && line < 200; line++) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        if (!stop) stop = end;
        ReaderWord first = reader_word(&at, stop);
        const bool comment =
            first.length > 0 && (first.at[0] == '#' || reader_word_is(first, "comment") ||
                                 reader_word_is(first, "obj_info") || (line == 0 && reader_word_is(first, "solid")));
        const char *unit = NULL;
        for (const char *c = first.at; comment && c + 4 <= stop && !unit; c++)
            if (strncasecmp(c, "unit", 4) == 0) unit = c;
        if (unit) {
            char lower[200];
            size_t n = 0;
            for (const char *c = first.at; c < stop && n < sizeof lower - 1; c++)
                lower[n++] = c >= unit && c < unit + 5    ? ' '
                             : isalpha((unsigned char)*c) ? (char)tolower((unsigned char)*c)
                                                          : ' ';
            lower[n] = 0;
            const char *from = lower;
            for (ReaderWord w; (w = reader_word(&from, lower + n)).length > 0;)
                for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
                    const size_t length = strlen(units[u].word);
                    if (length > w.length || strncmp(w.at, units[u].word, length) != 0) continue;
                    if (length < 4 && length != w.length) continue; /* `m` and `mm` are whole words */
                    snprintf(word, 24, "%.*s", (int)w.length, w.at);
                    return units[u].unit_m;
                }
        }
        at = stop < end ? stop + 1 : end;
    }
    return 0;
}

/* ---- what formats say ------------------------------------------------------------------------------- */

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
        const int method = head[8] | head[9] << 8;
        at = (size_t)(head - b) + 4;
        if (name < 6 || name + extra > left || memcmp(head + 30 + name - 6, ".model", 6) != 0) continue;
        const uint8_t *from = head + 30 + name + extra;
        const size_t rest = left - name - extra;
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
        double unit_m;
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
    const char *at = memmem(text, octets, "$INSUNITS", 9), *end = text + octets;
    char number[8] = "";
    long long code;
    if (!at) return 0;
    at += 9;
    const bool integer = reader_word_is(reader_word(&at, end), "70");
    const ReaderWord value = reader_word(&at, end);
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
