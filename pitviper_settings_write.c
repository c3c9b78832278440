/* pitviper_settings_write.c: settings as text: for hashes, as a file that reads back, and as a list of keys. */
#include "pitviper_settings_private.h"

/* In the form that reads back; returns as snprintf. */
static int value_text(char *out, size_t out_size, const Setting *row, const void *from, const char *number_format)
{
    const char *at = (const char *)from + row->offset;
    double      number;
    long long   whole;
    int         small, n = 0;
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
    case SETTING_BOOL: return snprintf(out, out_size, "%s", *(const bool *)at ? "true" : "false");
    case SETTING_TEXT:
    case SETTING_WORDS:
    case SETTING_PATH:
    case SETTING_PATHS:
    case SETTING_NAME_OR_PATH: return snprintf(out, out_size, "%s", at);
    case SETTING_NUMBERS:
        list = (const NumberList *)at;
        n    = snprintf(out, out_size, "[");
        for (int i = 0; i < list->count; i++) {
            n += snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, "%s", i ? ", " : "");
            n += snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, number_format, list->number[i]);
        }
        return n + snprintf(out + n, (size_t)n < out_size ? out_size - (size_t)n : 0, "]");
    case SETTING_OWN:
    case SETTING_EACH:
    case SETTING_MAP: break;
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

/* The shortest of 6, 9 or 17 digits that reads back as the same number. */
static void readable(char *out, size_t out_size, const Setting *row, const void *from)
{
    static const char *const formats[] = {"%g", "%.9g", "%.17g"};
    double want, got;
    for (int i = 0; i < 3; i++) {
        value_text(out, out_size, row, from, formats[i]);
        if (row->type != SETTING_DOUBLE) return;
        memcpy(&want, (const char *)from + row->offset, sizeof want);
        if (text_to_double(&got, out) && got == want) return;
    }
}

/* Words that YAML needs no quotes for. */
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
        const Setting *row   = &table->row[i];
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
        else if (row->type != SETTING_TEXT && row->type != SETTING_WORDS && !settings_is_path(row) &&
                 !isnan(row->low))
            fprintf(to, "%s%g .. %g%s%s", *row->help ? "; " : "", row->low, row->high, *row->unit ? " " : "",
                    row->unit);
        else if (*row->unit) fprintf(to, "%s%s", *row->help ? "; " : "", row->unit);
        fputc('\n', to);

        readable(value, sizeof value, row, from);
        if (row->type == SETTING_DOUBLE) memcpy(&number, (const char *)from + row->offset, sizeof number);
        const bool unset = isnan(number), hidden = unset || (shown && !shown[i]);
        fprintf(to, "%s%s%s:%s", indent, hidden ? "# " : "", key, unset ? "" : " ");
        if ((row->type == SETTING_TEXT || row->type == SETTING_WORDS || settings_is_path(row)) && !is_plain(value)) put_quoted(to, value);
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
