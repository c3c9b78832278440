/* pitviper_text.c: numbers from text, sanitizing of untrusted bytes, and the word that was meant. */

#include "pitviper_file.h"
#include "pitviper_output.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

bool text_to_double(double *out, const char *text)
{
    if (!*text || strchr(" \t\n\v\f\r", *text) || strpbrk(text, "xX")) return false;
    char *end;
    errno = 0;
    const double v = strtod(text, &end);
    if (end == text || *end || !isfinite(v)) return false;
    *out = v;
    return true;
}

const char *text_next_line(const char *at)
{
    const char *end = strchr(at, '\n');
    return end && end[1] ? end + 1 : NULL;
}

bool text_to_long(long long *out, const char *text)
{
    if (!*text || strchr(" \t\n\v\f\r", *text)) return false;
    char *end;
    errno = 0;
    const long long v = strtoll(text, &end, 10);
    if (end == text || *end || errno == ERANGE) return false;
    *out = v;
    return true;
}

void text_escape(char *out, size_t out_size, const char *bytes, size_t count)
{
    static const char digits[] = "0123456789abcdef";
    size_t            n = 0;
    for (size_t i = 0; i < count; i++) {
        const unsigned char c = (unsigned char)bytes[i];
        const bool          plain = c >= 0x20 && c < 0x7f && c != '\\';
        if (n + (plain ? 1 : 4) + 1 > out_size) break;
        if (plain) {
            out[n++] = (char)c;
        } else {
            out[n++] = '\\';
            out[n++] = 'x';
            out[n++] = digits[c >> 4];
            out[n++] = digits[c & 15];
        }
    }
    if (out_size) out[n] = 0;
}

/* Octets of the well-formed UTF-8 character at `at` (RFC 3629), and the character; 0: none. */
static size_t utf8_octets(uint32_t *code, const unsigned char *at)
{
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t          octets = *at < 0x80 ? 1 : *at >> 5 == 6 ? 2 : *at >> 4 == 14 ? 3 : *at >> 3 == 30 ? 4 : 0;
    if (octets == 0) return 0;
    uint32_t c = octets == 1 ? *at : *at & (0x7Fu >> octets);
    for (size_t i = 1; i < octets; i++) {
        if (at[i] >> 6 != 2) return 0; /* the text's end too */
        c = c << 6 | (at[i] & 0x3F);
    }
    if (c < least[octets] || c > 0x10FFFF || (c >= 0xD800 && c <= 0xDFFF)) return 0;
    *code = c;
    return octets;
}

/* C0, DEL and C1; line and paragraph separators; bidirectional and invisible characters. */
static bool steers_terminals(uint32_t c)
{
    return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x061C || (c >= 0x200B && c <= 0x200F) ||
           (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) || c == 0xFEFF ||
           (c >= 0xE0000 && c <= 0xE007F);
}

void text_show(char *out, size_t out_size, const char *text, bool lines)
{
    size_t n = 0;
    for (const unsigned char *at = (const unsigned char *)text; *at;) {
        uint32_t     code = 0;
        const size_t octets = utf8_octets(&code, at);
        const bool   kept = octets > 0 && (!steers_terminals(code) || (lines && (*at == '\n' || *at == '\t')));
        const size_t taken = octets > 0 ? octets : 1;
        if (n + (kept ? taken : 4 * taken) + 1 > out_size) break;
        if (kept) {
            memcpy(out + n, at, taken);
            n += taken;
        } else {
            for (size_t i = 0; i < taken; i++) n += (size_t)snprintf(out + n, out_size - n, "\\x%02x", at[i]);
        }
        at += taken;
    }
    if (out_size) out[n] = 0;
}

/* Without allocating, but for texts of more than 16 KiB: messages must not be lost when memory is exhausted. */
void text_vprint(FILE *to, const char *format, va_list arguments)
{
    enum { usual = 16384 };
    char    text[usual], shown[4 * usual];
    char   *long_text = NULL, *long_shown = NULL;
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(text, sizeof text, format, arguments);
    if (length < 0) *text = 0;
    if (length >= usual && vasprintf(&long_text, format, again) < 0) long_text = NULL;
    va_end(again);
    if (long_text) long_shown = malloc(4 * (size_t)length + 1);
    if (long_shown) text_show(long_shown, 4 * (size_t)length + 1, long_text, true);
    else text_show(shown, sizeof shown, text, true);
    fputs(long_shown ? long_shown : shown, to);
    if (length >= usual && !long_shown) log_error("text: out of memory: a line is cut after %d octets", usual - 1);
    free(long_shown);
    free(long_text);
}

void text_print(FILE *to, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    text_vprint(to, format, arguments);
    va_end(arguments);
}

/* ---- files -------------------------------------------------------------------------------- */

Status text_read_file(char **out, size_t *octets, const char *module, const char *path, size_t most)
{
    return file_read_whole(out, octets, module, path, most, FILE_FROM_DISK);
}

/* Days since 1970-01-01 of a proleptic Gregorian date. Source: Hinnant, "chrono-compatible low-level date
 * algorithms", by the count of days in 400-year eras. */
static long long days_from_date(int year, int month, int day)
{
    const long long y = month <= 2 ? year - 1 : year;
    const long long era = (y >= 0 ? y : y - 399) / 400;
    const long long yoe = y - era * 400;
    const long long doy = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + yoe * 365 + yoe / 4 - yoe / 100 + doy - 719468;
}

bool text_to_unix_s(double *unix_s, const char *text)
{
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int              year, month, day, hour, minute, used = 0;
    double           second;
    if (sscanf(text, "%4d-%2d-%2dT%2d:%2d:%lfZ%n", &year, &month, &day, &hour, &minute, &second, &used) != 6 ||
        text[used] || year < 1900 || year > 2100 || month < 1 || month > 12 || day < 1 ||
        day > days[month - 1] + (month == 2 && year % 4 == 0 && (year % 100 != 0 || year % 400 == 0)) || hour < 0 ||
        hour > 23 || minute < 0 || minute > 59 || !(second >= 0 && second < 60))
        return false;
    *unix_s = (double)days_from_date(year, month, day) * 86400 + hour * 3600 + minute * 60 + second;
    return true;
}

Status text_write_file(const char *module, const char *path, void (*put)(FILE *to, const void *user), const void *user)
{
    FILE *to = output_begin(path, OUTPUT_STREAM);
    if (to) put(to, user);
    if (to && output_end(to, path)) return STATUS_OK;
    log_error("%s: cannot write %s: %s", module, path, output_reason(errno));
    return STATUS_IO;
}

/* ---- words ---------------------------------------------------------------------------------- */

/* The known word that a mistyped one was probably meant to be, for every "did you mean". */

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
