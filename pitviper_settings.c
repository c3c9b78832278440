/* pitviper_settings.c: values by the rows of a table: ranges, units, choices, names of files, and the messages for
 * invalid ones; settings as text. */

#include "pitviper_settings_private.h"
#include "pitviper_file.h"

#include <assert.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_path(const Setting *row)
{
    return row->type == SETTING_PATH || row->type == SETTING_PATHS || row->type == SETTING_NAME_OR_PATH ||
           row->type == SETTING_NAME_OR_PATHS;
}

static bool is_several(SettingType type) { return type == SETTING_PATHS || type == SETTING_NAME_OR_PATHS; }

static bool is_name(SettingType type, const char *value)
{
    return (type == SETTING_NAME_OR_PATH || type == SETTING_NAME_OR_PATHS) && !strpbrk(value, "/.");
}

int settings_find(const SettingTable *table, const char *name)
{
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->row[i].name, name) == 0) return i;
    return -1;
}

/* The known key nearest to a name, or the same key in another section. */
static WordMeant key_meant(const SettingTable *table, const char *name)
{
    WordMeant   meant = word_meant(name);
    const char *point = strrchr(name, '.'), *last = point ? point + 1 : name;
    for (int i = 0; i < table->count; i++) word_consider(&meant, table->row[i].name);
    for (int i = 0; i < table->list_count; i++) word_consider(&meant, table->list[i].name);
    for (int i = 0; !*meant.word && i < table->count; i++) {
        const char *dot = strchr(table->row[i].name, '.');
        if (strcmp(last, dot ? dot + 1 : table->row[i].name) == 0)
            snprintf(meant.word, sizeof meant.word, "%s", table->row[i].name);
    }
    return meant;
}

Status settings_say_unknown(const SettingTable *table, const char *source, const char *name)
{
    char        shown[160];
    WordMeant   meant = key_meant(table, name);
    const char *best = *meant.word ? meant.word : NULL;
    text_escape(shown, sizeof shown, name, strlen(name));
    log_error("%s: %s: no such key: %s%s%s%s%s%s", table->module, source, settings_prefix(table), shown,
              best              ? "; did you mean "
              : table->all_keys ? "; all keys: "
                                : "",
              best ? settings_prefix(table) : "",
              best              ? best
              : table->all_keys ? table->all_keys
                                : "",
              best ? "?" : "");
    return STATUS_BAD_VALUE;
}

/* The place of a word among choices, from 0; -1: it is none of them. */
static int choice_place(const char *choices, const char *value)
{
    const size_t length = strcspn(value, "|");
    int          place = 0;
    if (value[length]) return -1;
    for (const char *at = choices; at; at = strchr(at, '|'), at = at ? at + 1 : NULL, place++)
        if (strncmp(at, value, length) == 0 && (at[length] == '|' || !at[length])) return place;
    return -1;
}

/* The word at a place, and `|` and more behind it; *length: without those. */
static const char *choice_word(int *length, const char *choices, int place)
{
    for (; place > 0; place--) choices = strchr(choices, '|') + 1;
    *length = (int)strcspn(choices, "|");
    return choices;
}

const char *settings_prefix(const SettingTable *table) { return table->prefix ? table->prefix : ""; }

void settings_accepted(char *out, size_t out_size, const Setting *row)
{
    const char *kind = row->type == SETTING_DOUBLE    ? "a number"
                       : row->type == SETTING_NUMBERS ? "numbers"
                                                      : "a whole number";
    if (row->type == SETTING_OWN || row->type == SETTING_EACH || row->type == SETTING_MAP)
        snprintf(out, out_size, "%s", row->choices);
    else if (row->choices) snprintf(out, out_size, "one of %s", row->choices);
    else if (row->type == SETTING_TEXT || row->type == SETTING_WORDS || is_path(row))
        snprintf(out, out_size, "text of at most %zu characters", row->size - 1);
    else if (row->type == SETTING_BOOL) snprintf(out, out_size, "true or false");
    else if (isnan(row->low)) snprintf(out, out_size, "%s", kind);
    else
        snprintf(out, out_size, "%s in %.10g .. %.10g%s%s", kind, row->low, row->high, *row->unit ? " " : "",
                 row->unit);
}

static void report_bad(const SettingTable *table, const char *source, const Setting *row, const char *value)
{
    char       shown[160], accepted[512];
    const bool long_text = row->type == SETTING_TEXT || row->type == SETTING_WORDS || is_path(row);
    WordMeant  meant = word_meant(value);
    text_escape(shown, sizeof shown, value, strnlen(value, sizeof shown));
    if (long_text) snprintf(accepted, sizeof accepted, "longer than %zu characters", row->size - 1);
    else settings_accepted(accepted, sizeof accepted, row);
    if (row->choices) word_consider_list(&meant, row->choices, '|');
    log_error("%s: %s: %s%s: '%s' is %s%s%s", table->module, source, settings_prefix(table), row->name, shown,
              long_text ? "" : "not ", accepted, word_hint(&meant));
}

bool settings_number(double *out, const Setting *row, const char *value)
{
    double number;
    if (!text_to_double(&number, value)) return false;
    if (!isnan(row->low) && !(number >= row->low && number <= row->high)) return false;
    *out = number;
    return true;
}

/* Reads numbers separated by spaces or commas. */
static bool numbers_of(NumberList *out, const Setting *row, const char *value)
{
    NumberList list = {0};
    char       word[64];
    for (const char *at = value; *(at += strspn(at, " ,"));) {
        const size_t length = strcspn(at, " ,");
        if (length >= sizeof word || list.count == number_list_capacity) return false;
        memcpy(word, at, length);
        word[length] = 0;
        if (!settings_number(&list.number[list.count++], row, word)) return false;
        at += length;
    }
    *out = list;
    return true;
}

/* Copies `a, b` without the blanks; with out NULL it only counts. */
static size_t join_words(char *out, const char *value)
{
    size_t n = 0;
    for (const char *at = value; *at;) {
        at += strspn(at, " \t");
        size_t       length = strcspn(at, ",");
        const size_t step = length + (at[length] == ',');
        const bool   more = at[length] == ',';
        while (length > 0 && strchr(" \t", at[length - 1])) length--;
        if (out) memcpy(out + n, at, length);
        n += length;
        if (out && more) out[n] = ',';
        n += more;
        at += step;
    }
    return n;
}

/* Returns false when the words do not fit. */
static bool words_into(char *out, size_t out_size, const char *value)
{
    if (join_words(NULL, value) >= out_size) return false;
    memset(out, 0, out_size);
    join_words(out, value);
    return true;
}

/* ---- names of files: relative to the file that gives them, or made absolute ----------------- */

enum { paths_most = 4096 }; /* octets of the longest list of paths */

/* Length of the folder, with its slash, that paths in a file are relative to. A file without a folder (a pipe,
 * /dev/stdin) has none: they are relative to the current folder. */
static size_t folder_of(const char *file)
{
    struct stat about;
    const char *slash = file ? strrchr(file, '/') : NULL;
    if (!slash || (stat(file, &about) == 0 && !S_ISREG(about.st_mode))) return 0;
    return (size_t)(slash - file) + 1;
}

/* Prefixes each path with the folder that it is relative to. Returns false when that does not fit. */
static bool place_paths(char *out, size_t out_size, SettingType type, const char *value, const char *file)
{
    const size_t folder = folder_of(file);
    size_t       n = 0;
    char         made[paths_most] = {0};
    bool         fits = true;
    assert(out_size <= sizeof made);
    for (const char *at = value; fits && *at;) {
        const size_t blanks = is_several(type) ? strspn(at, " ") : 0;
        const size_t length = is_several(type) ? strcspn(at, ",") : strlen(at);
        const bool   name = is_name(type, value);
        const size_t before = blanks < length && at[blanks] != '/' && !name ? folder : 0;
        fits = n + before + length + (at[length] != 0) < out_size;
        if (!fits) break;
        if (before) memcpy(made + n, file, before);
        memcpy(made + n + before, at + (blanks < length ? blanks : length), blanks < length ? length - blanks : 0);
        n += before + (blanks < length ? length - blanks : 0);
        if (at[length]) made[n++] = ',';
        at += length + (at[length] != 0);
    }
    if (fits) memcpy(out, made, out_size);
    return fits;
}

/* Makes a path absolute: the real path if it exists, else with the current folder prepended. */
static bool absolute(char *out, size_t out_size, const char *path)
{
    char       *real = realpath(path, NULL), here[4096];
    const char *folder = path[0] == '/' || real ? "" : getcwd(here, sizeof here);
    const int   n = folder ? snprintf(out, out_size, "%s%s%s", folder, *folder ? "/" : "", real ? real : path) : -1;
    free(real);
    return n >= 0 && n < (int)out_size;
}

static bool is_among(const char *name, const char *names)
{
    const size_t length = strlen(name);
    for (const char *at = names; (at = strstr(at, name)); at += length)
        if ((at == names || at[-1] == ',') && (at[length] == 0 || at[length] == ',')) return true;
    return false;
}

bool settings_paths_good(const void *from, const SettingTable *table, const char *outputs)
{
    for (int i = 0; i < table->count; i++) {
        const Setting *row = &table->row[i];
        const char    *at = (const char *)from + row->offset;
        if (!is_path(row) || is_among(row->name, outputs)) continue;
        if (is_name(row->type, at)) continue;
        while (*at) {
            const size_t length = is_several(row->type) ? strcspn(at, ",") : strlen(at);
            char         path[4096], why[file_why_size];
            struct stat  about;
            snprintf(path, sizeof path, "%.*s", (int)length, at);
            at += length + (at[length] != 0);
            if (stat(path, &about) != 0 || S_ISREG(about.st_mode) || S_ISDIR(about.st_mode)) continue;
            file_is_regular(why, path);
            log_error("%s: %s: cannot read %s: %s", table->module, row->name, path, why);
            return false;
        }
    }
    return true;
}

void settings_absolute(void *out, const SettingTable *table)
{
    for (int i = 0; i < table->count; i++) {
        const Setting *row = &table->row[i];
        char          *at = (char *)out + row->offset, made[paths_most] = {0}, one[4096];
        size_t         n = 0;
        if (!is_path(row) || !*at || is_name(row->type, at)) continue;
        assert(row->size <= sizeof made);
        bool fits = true;
        for (const char *from = at; fits && *from;) {
            const size_t length = is_several(row->type) ? strcspn(from, ",") : strlen(from);
            char         path[4096];
            fits = length < sizeof path;
            if (!fits) break;
            snprintf(path, sizeof path, "%.*s", (int)length, from);
            if (!length || !absolute(one, sizeof one, path)) snprintf(one, sizeof one, "%s", path);
            n += (size_t)snprintf(made + n, row->size - n, "%s%s", one, from[length] ? "," : "");
            fits = n < row->size;
            from += length + (from[length] != 0);
        }
        if (fits) memcpy(at, made, row->size);
    }
}

/* ---- one value, stored ----------------------------------------------------------------------- */

/* file: where the value comes from; NULL: the command line. */
Status settings_store(void *out, const SettingTable *table, const Setting *row, const char *value, const char *source,
                      const char *file)
{
    char      *at = (char *)out + row->offset;
    double     number;
    long long  whole;
    int        small;
    NumberList list;
    switch (row->type) {
    case SETTING_DOUBLE:
        if (!settings_number(&number, row, value)) break;
        memcpy(at, &number, sizeof number);
        return STATUS_OK;
    case SETTING_INT:
    case SETTING_LONG:
        if (!text_to_long(&whole, value) || !((double)whole >= row->low && (double)whole <= row->high)) break;
        if (row->type == SETTING_LONG) {
            memcpy(at, &whole, sizeof whole);
        } else {
            small = (int)whole;
            memcpy(at, &small, sizeof small);
        }
        return STATUS_OK;
    case SETTING_BOOL:
        if (strcmp(value, "true") != 0 && strcmp(value, "false") != 0) break;
        *(bool *)at = value[0] == 't';
        return STATUS_OK;
    case SETTING_SWITCH:
        if (choice_place(row->choices, value) < 0) break;
        *(bool *)at = strcmp(value, "on") == 0;
        return STATUS_OK;
    case SETTING_CHOICE:
        small = choice_place(row->choices, value);
        assert(row->size == sizeof small); /* an enum */
        if (small < 0) break;
        memcpy(at, &small, sizeof small);
        return STATUS_OK;
    case SETTING_PATH:
    case SETTING_PATHS:
    case SETTING_NAME_OR_PATH:
    case SETTING_NAME_OR_PATHS:
        if (!place_paths(at, row->size, row->type, value, file)) break;
        return STATUS_OK;
    case SETTING_WORDS:
        if (!words_into(at, row->size, value)) break;
        return STATUS_OK;
    case SETTING_TEXT:
        if (strlen(value) >= row->size) break;
        memset(at, 0, row->size);
        strcpy(at, value);
        return STATUS_OK;
    case SETTING_NUMBERS:
        if (!numbers_of(&list, row, value)) break;
        memcpy(at, &list, sizeof list);
        return STATUS_OK;
    case SETTING_OWN:
    case SETTING_EACH:
    case SETTING_MAP:
        break; /* these exist only in files */
    }
    report_bad(table, source, row, value);
    return STATUS_BAD_VALUE;
}

Status settings_set(void *out, bool *given, const SettingTable *table, const char *name, const char *value,
                    const char *source)
{
    return settings_set_from(out, given, table, name, value, source, NULL);
}

Status settings_set_from(void *out, bool *given, const SettingTable *table, const char *name, const char *value,
                         const char *source, const char *file)
{
    const int row = settings_find(table, name);
    if (row < 0) return settings_say_unknown(table, source, name);
    const Status status = settings_store(out, table, &table->row[row], value, source, file);
    if (status == STATUS_OK && given) given[row] = true;
    return status;
}

/* ---- settings as text: for hashes, as a file that reads back, and as a list of keys --------- */

/* Writes a value in the form that reads back; returns as snprintf. */
static int value_text(char *out, size_t out_size, const Setting *row, const void *from, const char *number_format)
{
    const char       *at = (const char *)from + row->offset;
    double            number;
    long long         whole;
    int               small, n = 0;
    const char       *word;
    const NumberList *list;
    switch (row->type) {
    case SETTING_DOUBLE:
        memcpy(&number, at, sizeof number);
        return snprintf(out, out_size, number_format, number);
    case SETTING_INT:
        memcpy(&small, at, sizeof small);
        return snprintf(out, out_size, "%d", small);
    case SETTING_LONG:
        memcpy(&whole, at, sizeof whole);
        return snprintf(out, out_size, "%lld", whole);
    case SETTING_BOOL:
        return snprintf(out, out_size, "%s", *(const bool *)at ? "true" : "false");
    case SETTING_SWITCH:
        return snprintf(out, out_size, "%s", *(const bool *)at ? "on" : "off");
    case SETTING_CHOICE:
        memcpy(&small, at, sizeof small);
        word = choice_word(&n, row->choices, small);
        return snprintf(out, out_size, "%.*s", n, word);
    case SETTING_TEXT:
    case SETTING_WORDS:
    case SETTING_PATH:
    case SETTING_PATHS:
    case SETTING_NAME_OR_PATH:
    case SETTING_NAME_OR_PATHS:
        return snprintf(out, out_size, "%s", at);
    case SETTING_NUMBERS:
        list = (const NumberList *)at;
        n = snprintf(out, out_size, "[");
        for (int i = 0; i < list->count; i++) {
            n += snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, "%s", i ? ", " : "");
            n += snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, number_format, list->number[i]);
        }
        return n + snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, "]");
    case SETTING_OWN:
    case SETTING_EACH:
    case SETTING_MAP:
        break;
    }
    *out = 0;
    return 0;
}

enum { value_size = 32 * number_list_capacity }; /* more than any text */

void settings_text(char *out, size_t out_size, const SettingTable *table, const void *from)
{
    char   value[value_size];
    size_t n = 0;
    *out = 0;
    for (int i = 0; i < table->count && n < out_size; i++) {
        value_text(value, sizeof value, &table->row[i], from, "%.17g");
        n += (size_t)snprintf(out + n, out_size - n, "%s=%s\n", table->row[i].name, value);
    }
}

/* Writes a number with the fewest of 6, 9 or 17 digits that read back as the same number. */
static void readable(char *out, size_t out_size, const Setting *row, const void *from)
{
    static const char *const formats[] = {"%g", "%.9g", "%.17g"};
    double                   want, got;
    for (int i = 0; i < 3; i++) {
        value_text(out, out_size, row, from, formats[i]);
        if (row->type != SETTING_DOUBLE) return;
        memcpy(&want, (const char *)from + row->offset, sizeof want);
        if (text_to_double(&got, out) && got == want) return;
    }
}

/* Whether YAML needs no quotes for a text. */
static bool is_plain(const char *text)
{
    if (!*text || strchr("-?:,[]{}#&*!|>'\"%@` ", text[0])) return false;
    return !strstr(text, ": ") && !strstr(text, " #") && text[strlen(text) - 1] != ' ';
}

static void put_quoted(FILE *to, const char *text)
{
    fputc('\'', to);
    for (; *text; text++) fputs(*text == '\'' ? "\'\'" : (const char[]){*text, 0}, to);
    fputc('\'', to);
}

void settings_write(FILE *to, const SettingTable *table, const void *from, const bool *shown)
{
    char value[value_size], section[64] = "";
    for (int i = 0; i < table->count; i++) {
        const Setting *row = &table->row[i];
        const char    *point = strchr(row->name, '.'), *key = point ? point + 1 : row->name;
        const size_t   length = point ? (size_t)(point - row->name) : 0;
        const char    *indent = point ? "  " : "";
        double         number = 0;
        if (strncmp(section, row->name, length) != 0 || section[length]) {
            snprintf(section, sizeof section, "%.*s", (int)length, row->name);
            if (length) fprintf(to, "\n%s:\n", section);
            else fputc('\n', to);
        }
        fprintf(to, "%s# %s", indent, row->help);
        if (row->choices) fprintf(to, "%s%s", *row->help ? "; " : "", row->choices);
        else if (row->type == SETTING_BOOL) fprintf(to, "%strue or false", *row->help ? "; " : "");
        else if (row->type != SETTING_TEXT && row->type != SETTING_WORDS && !is_path(row) && !isnan(row->low))
            fprintf(to, "%s%g .. %g%s%s", *row->help ? "; " : "", row->low, row->high, *row->unit ? " " : "",
                    row->unit);
        else if (*row->unit) fprintf(to, "%s%s", *row->help ? "; " : "", row->unit);
        fputc('\n', to);

        readable(value, sizeof value, row, from);
        if (row->type == SETTING_DOUBLE) memcpy(&number, (const char *)from + row->offset, sizeof number);
        const bool unset = isnan(number), hidden = unset || (shown && !shown[i]);
        fprintf(to, "%s%s%s:%s", indent, hidden ? "# " : "", key, unset ? "" : " ");
        if ((row->type == SETTING_TEXT || row->type == SETTING_WORDS || is_path(row)) && !is_plain(value))
            put_quoted(to, value);
        else fputs(unset ? "" : value, to);
        fputc('\n', to);
    }
}

void settings_write_keys(FILE *to, const SettingTable *table)
{
    char accepted[512];
    for (int i = 0; i < table->count; i++) {
        settings_accepted(accepted, sizeof accepted, &table->row[i]);
        fprintf(to, "  %s%s: %s\n", settings_prefix(table), table->row[i].name, accepted);
        if (*table->row[i].help) fprintf(to, "      %s\n", table->row[i].help);
    }
    for (int i = 0; i < table->list_count; i++)
        fprintf(to, "  %s%s: a list, each with keys of its own\n", settings_prefix(table), table->list[i].name);
}
