/* pitviper_probe.c: CSV through a probe, line by line, so that it serves a pipe as well as a file. */
#include "pitviper.h"

#include <stdlib.h>

enum { row_max_cells = 256, row_max_octets = 1 << 16 };

typedef struct Column {
    char name[48];
    bool text, optional;
    int  cell; /* number of its cell in the row; -1: the header lacks it */
} Column;

/* Splits "a,b$,c?" into columns. The list is part of the program, so too many columns are a bug. */
static int read_columns(Column *column, const char *list)
{
    int count = 0;
    for (const char *at = list; *at;) {
        const size_t length = strcspn(at, ",");
        size_t       name = length;
        Column       c = {.cell = -1};
        for (; name > 0 && (at[name - 1] == '$' || at[name - 1] == '?'); name--) {
            c.text = c.text || at[name - 1] == '$';
            c.optional = c.optional || at[name - 1] == '?';
        }
        if (count == probe_max_columns || name >= sizeof c.name) abort();
        memcpy(c.name, at, name);
        column[count++] = c;
        at += length + (at[length] == ',');
    }
    return count;
}

/* Reads a line; returns false at the end of the file. A line longer than the limit, or with a NUL in it, is read to its
 * end and rejected with a reason. */
static bool read_line(char *line, FILE *in, const char **error)
{
    size_t length = 0;
    int    c = getc(in);
    *error = NULL;
    if (c == EOF) return false;
    for (; c != EOF && c != '\n'; c = getc(in)) {
        if (c == 0) *error = "the line holds a NUL octet";
        else if (length < row_max_octets - 1) line[length++] = (char)c;
        else if (!*error) *error = "line too long";
    }
    while (length > 0 && line[length - 1] == '\r') length--;
    line[length] = 0;
    return true;
}

static void write_text(FILE *out, const char *text)
{
    if (!strpbrk(text, ",\"")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"') fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

/* The fewest digits that read back as the same number. */
static void write_number(FILE *out, double number)
{
    char text[40];
    if (isnan(number)) return;
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, number);
        if (strtod(text, NULL) == number) break;
    }
    fputs(text, out);
}

/* Why the row cannot be evaluated, or NULL with `in` filled. */
static const char *read_row(ProbeValue *in, const Column *column, int columns, char **cell, char reason[static 128])
{
    for (int i = 0; i < columns; i++) {
        in[i].text = column[i].cell >= 0 ? cell[column[i].cell] : "";
        in[i].number = NAN;
        if (!*in[i].text && column[i].optional) continue;
        if (column[i].text ? *in[i].text != 0 : text_to_double(&in[i].number, in[i].text)) continue;
        snprintf(reason, 128, *in[i].text ? "%s is not a number" : "%s is empty", column[i].name);
        return reason;
    }
    return NULL;
}

static Status find_columns(Column *column, int columns, const Probe *probe, char **cell, int cells)
{
    int found = 0;
    for (int i = 0; i < columns; i++) {
        for (int c = 0; c < cells; c++)
            if (strcmp(cell[c], column[i].name) == 0) column[i].cell = c;
        found += column[i].cell >= 0;
        if (column[i].cell >= 0 || (column[i].optional && (found > 0 || i < columns - 1))) continue;
        log_error("probe: %s: no column %s in the header; it needs %s ($: text, ?: may be missing)", probe->name,
                  column[i].name, probe->in);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status probe_run(const Probe *probe, int argc, char **argv, FILE *in, FILE *out)
{
    Column      column[probe_max_columns], result[probe_max_columns];
    const int   columns = read_columns(column, probe->in), results = read_columns(result, probe->out);
    ProbeValue *value = calloc(2 * probe_max_columns, sizeof *value),
               *answer = value ? value + probe_max_columns : NULL;
    char       *line = malloc(row_max_octets), *copy = malloc(row_max_octets);
    char       *cell[row_max_cells];
    void       *state = NULL;
    bool        opened = false;
    const char *unusable;
    Status      status = STATUS_NO_MEMORY;
    if (!value || !line || !copy) goto done;

    do {
        if (!read_line(line, in, &unusable)) {
            log_error("probe: %s: no header on standard input; it needs %s ($: text, ?: may be missing)", probe->name,
                      probe->in);
            status = STATUS_BAD_VALUE;
            goto done;
        }
        /* skips a byte-order mark, which spreadsheets write */
        if (strncmp(line, "\xef\xbb\xbf", 3) == 0) memmove(line, line + 3, strlen(line + 3) + 1);
    } while (!unusable && (!*line || *line == '#'));
    strcpy(copy, line);
    const int cells = text_split(cell, row_max_cells, copy);
    status = cells < 0 || cells > row_max_cells || unusable ? STATUS_BAD_VALUE : STATUS_OK;
    if (status != STATUS_OK) {
        log_error("probe: %s: the header is not CSV of at most %d columns%s%s", probe->name, row_max_cells,
                  unusable ? ": " : "", unusable ? unusable : "");
        goto done;
    }
    status = find_columns(column, columns, probe, cell, cells);
    if (status == STATUS_OK && probe->open) status = probe->open(&state, argc, argv);
    if (status != STATUS_OK) goto done;
    opened = true;

    fputs(line, out);
    for (int i = 0; i < results; i++) fprintf(out, ",%s", result[i].name);
    fputs(",error\n", out);
    while (read_line(line, in, &unusable)) {
        char reason[128];
        if (!unusable && (!*line || *line == '#')) continue;
        strcpy(copy, line);
        const int   count = text_split(cell, row_max_cells, copy);
        const char *error = unusable ? unusable : count < 0 ? "a quote is not closed" : NULL;
        if (!error && count != cells) {
            snprintf(reason, sizeof reason, "%d columns where the header has %d", count, cells);
            error = reason;
        }
        if (!error) error = read_row(value, column, columns, cell, reason);
        for (int i = 0; i < results; i++) {
            answer[i].text = NULL;
            answer[i].number = NAN;
        }
        if (!error) error = probe->row(state, value, answer);
        fputs(line, out);
        for (int i = 0; i < results; i++) {
            fputc(',', out);
            if (error) continue;
            if (answer[i].text) write_text(out, answer[i].text);
            else write_number(out, answer[i].number);
        }
        fputc(',', out);
        if (error) write_text(out, error);
        fputc('\n', out);
    }
    if (ferror(in) || fflush(out) != 0 || ferror(out)) {
        log_error("probe: %s: reading or writing failed", probe->name);
        status = STATUS_IO;
    }
done:
    if (status == STATUS_NO_MEMORY) log_error("probe: %s: out of memory", probe->name);
    if (opened && probe->close) probe->close(state);
    free(value);
    free(line);
    free(copy);
    return status;
}
