/* pitviper_settings.c: one value by its row of a table: ranges, units, choices, and the messages for invalid values. */
#include "pitviper_settings_private.h"

#include <stdlib.h>

int settings_find(const SettingTable *table, const char *name)
{
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->row[i].name, name) == 0) return i;
    return -1;
}

/* The nearest key; or the same key of another section. */
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
              best ? "; did you mean " : table->all_keys ? "; all keys: " : "", best ? settings_prefix(table) : "",
              best ? best : table->all_keys ? table->all_keys : "", best ? "?" : "");
    return STATUS_BAD_VALUE;
}

static bool is_choice(const char *choices, const char *value)
{
    const size_t length = strlen(value);
    if (strchr(value, '|')) return false;
    for (const char *at = choices; at; at = strchr(at, '|'), at = at ? at + 1 : NULL)
        if (strncmp(at, value, length) == 0 && (at[length] == '|' || !at[length])) return true;
    return false;
}

const char *settings_prefix(const SettingTable *table) { return table->prefix ? table->prefix : ""; }

void settings_accepted(char *out, size_t out_size, const Setting *row)
{
    const char *kind = row->type == SETTING_DOUBLE ? "a number" : row->type == SETTING_NUMBERS ? "numbers"
                                                                                               : "a whole number";
    if (row->type == SETTING_OWN || row->type == SETTING_EACH || row->type == SETTING_MAP)
        snprintf(out, out_size, "%s", row->choices);
    else if (row->choices) snprintf(out, out_size, "one of %s", row->choices);
    else if (row->type == SETTING_TEXT || row->type == SETTING_WORDS || settings_is_path(row))
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
    const bool long_text =
        !row->choices && (row->type == SETTING_TEXT || row->type == SETTING_WORDS || settings_is_path(row));
    WordMeant meant = word_meant(value);
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

/* Numbers separated by spaces or commas. */
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

/* `a, b` without the blanks; out NULL: counted alone. */
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

/* False: they do not fit. */
static bool words_into(char *out, size_t out_size, const char *value)
{
    if (join_words(NULL, value) >= out_size) return false;
    memset(out, 0, out_size);
    join_words(out, value);
    return true;
}

/* ---- one value, stored ----------------------------------------------------------------------- */

/* file: its source; NULL: the command line. */
Status settings_store(void *out, const SettingTable *table, const Setting *row, const char *value, const char *source,
                    const char *file)
{
    char      *at = (char *)out + row->offset;
    double     number;
    long long  whole;
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
            const int small = (int)whole;
            memcpy(at, &small, sizeof small);
        }
        return STATUS_OK;
    case SETTING_BOOL:
        if (strcmp(value, "true") != 0 && strcmp(value, "false") != 0) break;
        *(bool *)at = value[0] == 't';
        return STATUS_OK;
    case SETTING_PATH:
    case SETTING_PATHS:
    case SETTING_NAME_OR_PATH:
        if (!settings_place_paths(at, row->size, row->type, value, file)) break;
        return STATUS_OK;
    case SETTING_WORDS:
        if (!words_into(at, row->size, value)) break;
        return STATUS_OK;
    case SETTING_TEXT:
        if (strlen(value) >= row->size || (row->choices && !is_choice(row->choices, value))) break;
        memset(at, 0, row->size);
        strcpy(at, value);
        return STATUS_OK;
    case SETTING_NUMBERS:
        if (!numbers_of(&list, row, value)) break;
        memcpy(at, &list, sizeof list);
        return STATUS_OK;
    case SETTING_OWN:
    case SETTING_EACH:
    case SETTING_MAP: break; /* in files alone */
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
