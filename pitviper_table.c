/* pitviper_table.c: files of CSV: their cells, and their rows into structs. */

#include "pitviper_table.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { table_max_octets = 1 << 26, said_size = 640 };

static char *trim(char *text)
{
    while (*text == ' ' || *text == '\t') text++;
    char *end = text + strlen(text);
    while (end > text && strchr(" \t\r", end[-1])) *--end = 0;
    return text;
}

int text_split(char **cell, int capacity, char *line)
{
    int   count = 0;
    char *at = line;
    for (;;) {
        while (*at == ' ' || *at == '\t') at++;
        char *start = at, *end;
        if (*at == '"') {
            char *to = start = ++at;
            while (*at && !(at[0] == '"' && at[1] != '"')) {
                if (*at == '"') at++;
                *to++ = *at++;
            }
            if (!*at) return -1;
            at++;
            end = to;
            while (*at && *at != ',') at++;
        } else {
            while (*at && *at != ',') at++;
            end = at;
        }
        const bool more = *at == ',';
        *end = 0;
        if (count < capacity) cell[count] = trim(start);
        count++;
        if (!more) return count;
        at++;
    }
}

static Status open_table(Table *out, const char *module, const char *path)
{
    Table  table = {0};
    size_t octets = 0;
    Status status = text_read_file(&table.text, &octets, module, path, table_max_octets);
    if (status != STATUS_OK) return status;
    if (strlen(table.text) != octets) {
        log_error("%s: %s: holds a NUL octet; is it a text file?", module, path);
        status = STATUS_BAD_VALUE;
        goto fail;
    }
    status = STATUS_NO_MEMORY;
    table.path = strdup(path);
    if (!table.path) goto fail;

    int lines = 1;
    for (const char *c = table.text; *c; c++) lines += *c == '\n';
    table.line = calloc((size_t)lines, sizeof *table.line);
    if (!table.line) goto fail;

    int number = 0;
    table.rows = -1; /* the header is row -1 while counting */
    /* a byte-order mark, which spreadsheets write, is skipped */
    for (char *next = table.text + (strncmp(table.text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0), *line; next && *next;) {
        line = next;
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        number++;
        line = trim(line);
        if (!*line || *line == '#') continue;
        if (table.rows < 0) {
            int columns = 1;
            for (const char *c = line; *c; c++) columns += *c == ',';
            /* a row has at least one octet per column: bounds the memory for a wide header over many blank lines */
            size_t cells_most = (size_t)columns * (size_t)lines;
            if (cells_most > octets + (size_t)columns) cells_most = octets + (size_t)columns;
            table.cell = calloc(cells_most, sizeof *table.cell);
            if (!table.cell) goto fail;
            table.columns = columns;
        }
        char    **row = table.cell + (size_t)(table.rows + 1) * (size_t)table.columns;
        const int cells = text_split(row, table.columns, line);
        if (table.rows < 0 && cells > 0) table.columns = cells;
        if (cells != table.columns) {
            if (cells < 0)
                log_error(
                    "%s: %s:%d: a quote is not closed; it ends on its line, and a quote in a cell is written twice",
                    module, path, number);
            else
                log_error("%s: %s:%d: %d columns where the header has %d; a cell with a comma in it stands in quotes",
                          module, path, number, cells, table.columns);
            status = STATUS_BAD_VALUE;
            goto fail;
        }
        table.line[++table.rows] = number;
    }
    if (table.rows < 0) {
        log_error("%s: %s: no header line; the first line that is no comment names the columns", module, path);
        status = STATUS_BAD_VALUE;
        goto fail;
    }
    log_detail("table: %s: %d rows", path, table.rows);
    *out = table;
    return STATUS_OK;

fail:
    table_close(&table);
    return status;
}

Status table_open(Table *out, const char *path) { return open_table(out, "text", path); }

void table_close(Table *table)
{
    free(table->path);
    free(table->cell);
    free(table->line);
    free(table->text);
    memset(table, 0, sizeof *table);
}

int table_column(const Table *table, const char *name)
{
    for (int i = 0; i < table->columns; i++)
        if (strcmp(table->cell[i], name) == 0) return i;
    return -1;
}

const char *table_text(const Table *table, int row, int column)
{
    return table->cell[(size_t)(row + 1) * (size_t)table->columns + (size_t)column];
}

bool table_columns(int *column, const Table *table, const char *const *name, int count, const char *module)
{
    for (int c = 0; c < count; c++) {
        column[c] = table_column(table, name[c]);
        if (column[c] >= 0) continue;
        log_error("%s: %s has no column %s", module, table->path, name[c]);
        return false;
    }
    return true;
}

Status table_number(double *out, const Table *table, int row, int column, double low, double high)
{
    const char *text = table_text(table, row, column);
    double      value;
    if (!text_to_double(&value, text) || !(value >= low && value <= high)) {
        log_error("text: %s:%d: column %s: '%s' is not a number in %g .. %g", table->path, table->line[row + 1],
                  table->cell[column], text, low, high);
        return STATUS_BAD_VALUE;
    }
    *out = value;
    return STATUS_OK;
}

/* ---- rows into structs ------------------------------------------------------------------------ */

const char *table_rows_text(const TableRows *rows, int row, const char *column)
{
    const int at = table_column(&rows->table, column);
    return at >= 0 ? table_text(&rows->table, row, at) : "";
}

/* `module: file:line: column name: 'value' is not accepted; next`; row -1: the header, -2: the file; column NULL:
 * `accepted` says what is wrong. */
static Status refuse(const TableRows *rows, int row, const char *column, const char *value, const char *accepted)
{
    const TableFormat *f = rows->format;
    char               line[16] = "", begin[192] = "";
    if (row >= -1) snprintf(line, sizeof line, ":%d", rows->table.line[row + 1]);
    if (column) snprintf(begin, sizeof begin, "column %.60s: '%.80s' is not ", column, value);
    log_error("%s: %s%s: %s%s%s%s", f->module, rows->table.path, line, begin, accepted, f->next ? "; " : "",
              f->next ? f->next : "");
    return STATUS_BAD_VALUE;
}

Status table_rows_refuse(const TableRows *rows, int row, const char *column, const char *accepted, ...)
{
    char    text[512];
    va_list arguments;
    va_start(arguments, accepted);
    vsnprintf(text, sizeof text, accepted, arguments);
    va_end(arguments);
    return refuse(rows, row, column, column ? table_rows_text(rows, row, column) : "", text);
}

Status table_rows_lack(const TableRows *rows, const char *what, ...)
{
    char    text[512];
    va_list arguments;
    va_start(arguments, what);
    vsnprintf(text, sizeof text, what, arguments);
    va_end(arguments);
    return refuse(rows, -2, NULL, "", text);
}

bool table_rows_has(const TableRows *rows, const char *column) { return table_column(&rows->table, column) >= 0; }

Status table_rows_find(int *row, const TableRows *rows, const char *name, const char *what, const char *beside,
                       const char *other)
{
    char      known[512] = "";
    int       found = -1;
    WordMeant meant = word_meant(name);
    for (int i = 0; i < rows->table.rows; i++) {
        const char  *here = table_rows_text(rows, i, "name");
        const size_t length = strlen(known);
        if (strcmp(here, name) == 0) {
            if (found >= 0) return table_rows_refuse(rows, i, "name", "another name than those of the rows above");
            found = i;
        }
        snprintf(known + length, sizeof known - length, "%s%s", i ? ", " : "", here);
        word_consider(&meant, here);
    }
    if (found >= 0) {
        *row = found;
        return STATUS_OK;
    }
    word_consider(&meant, other);
    log_error("%s: %s: no %s named '%s'%s; there are: %s%s", rows->format->module, rows->table.path, what, name, beside,
              known, word_hint(&meant));
    return STATUS_BAD_VALUE;
}

Status table_rows_use(TableRows *rows, const TableFormat *format)
{
    char      said[128];
    const int count = rows->table.rows;
    rows->format = format;
    for (int c = 0; c < format->count; c++) {
        const TableColumn *column = &format->column[c];
        rows->at[c] = table_column(&rows->table, column->name);
        if (rows->at[c] >= 0 || column->absent == TABLE_LATER || column->absent == TABLE_OPTIONAL) continue;
        snprintf(said, sizeof said, "no column %.60s", column->name);
        return refuse(rows, -1, NULL, "", said);
    }
    if (format->most_rows == 0 || (count >= format->least_rows && count <= format->most_rows)) return STATUS_OK;
    return table_rows_lack(rows, "%d rows, of %d to %d", count, format->least_rows, format->most_rows);
}

Status table_rows_open(TableRows *out, const TableFormat *format, const char *path)
{
    TableRows rows = {.format = format};
    Status    status = open_table(&rows.table, format->module, path);
    if (status != STATUS_OK) return status;
    status = table_rows_use(&rows, format);
    if (status == STATUS_OK) *out = rows;
    else table_rows_close(&rows);
    return status;
}

void table_rows_close(TableRows *rows) { table_close(&rows->table); }

/* ---- words ------------------------------------------------------------------------------------ */

/* The next of "a, b, c": its length, and *at where the one after it begins; NULL: it was the last. */
static int next_choice(const char **at)
{
    const char *comma = strchr(*at, ',');
    const int   length = comma ? (int)(comma - *at) : (int)strlen(*at);
    *at = comma ? comma + 2 : NULL; /* ", " */
    return length;
}

/* The word of a column that stands for k. */
static void word_of(char out[64], const TableColumn *column, int k)
{
    const char *at = column->choices, *word = at;
    if (column->type == TABLE_NAMED) {
        snprintf(out, 64, "%s", column->named(k));
        return;
    }
    int length = next_choice(&at);
    for (; k > 0; k--) word = at, length = next_choice(&at);
    snprintf(out, 64, "%.*s", length, word);
}

static int last_word(const TableColumn *column)
{
    if (column->type == TABLE_NAMED) return (int)column->high;
    int last = 0;
    for (const char *at = column->choices; at[0]; at++) last += at[0] == ',';
    return last;
}

/* NULL, and *out for which it stands; else what is accepted. */
static const char *read_word(int *out, char said[said_size], const TableColumn *column, const char *text)
{
    char   word[64];
    size_t n = (size_t)snprintf(said, said_size, "one of");
    for (int k = (int)column->low; k <= last_word(column); k++) {
        word_of(word, column, k);
        if (strcmp(word, text) == 0) {
            *out = k;
            return NULL;
        }
        if (n + 72 < said_size) n += (size_t)snprintf(said + n, said_size - n, "%s %s", n > 6 ? "," : "", word);
    }
    return said;
}

/* ---- rows into structs ------------------------------------------------------------------------ */

/* Puts a number where it belongs; an int's range is its column's, which fits. */
static void put_number(void *out, const TableColumn *column, double number)
{
    const double value = column->unit != 0 ? column->unit * number : number;
    if (column->type == TABLE_FLOAT) *(float *)out = (float)value;
    else if (column->type == TABLE_INT || column->type == TABLE_CHOICE || column->type == TABLE_NAMED)
        *(int *)out = (int)value;
    else *(double *)out = value;
}

static void put_absent(void *out, const TableColumn *column)
{
    if (column->type == TABLE_NAME) *(char *)out = 0;
    else if (column->type == TABLE_CELL) *(const char **)out = "";
    else if (column->type != TABLE_OWN) put_number(out, column, column->otherwise);
}

/* What is accepted where the text is not; said: room for it. NULL: it was put into *out. */
static const char *read_cell(void *out, char said[said_size], const TableColumn *column, const char *text)
{
    double number;
    switch (column->type) {
    case TABLE_CELL:
        *(const char **)out = text;
        return NULL;
    case TABLE_OWN:
        return column->parse(out, text);
    case TABLE_CHOICE:
    case TABLE_NAMED:
        return read_word(out, said, column, text);
    case TABLE_NAME:
        if (*text && strlen(text) < column->size) {
            memcpy(out, text, strlen(text) + 1);
            return NULL;
        }
        snprintf(said, said_size, "a name of 1 to %zu characters", column->size - 1);
        return said;
    default:
        break;
    }
    const bool whole = column->type == TABLE_INT || column->type == TABLE_WHOLE;
    if (text_to_double(&number, text) && number >= column->low && number <= column->high &&
        !(whole && number != floor(number))) {
        put_number(out, column, number);
        return NULL;
    }
    snprintf(said, said_size, "a %snumber in %g .. %g", whole ? "whole " : "", column->low, column->high);
    return said;
}

Status table_rows_get(void *out, const TableRows *rows, int row)
{
    for (int c = 0; c < rows->format->count; c++) {
        const TableColumn *column = &rows->format->column[c];
        void              *member = (char *)out + column->offset;
        const char        *text = rows->at[c] >= 0 ? table_text(&rows->table, row, rows->at[c]) : "";
        char               said[said_size];
        if (rows->at[c] < 0 || (!*text && column->absent >= TABLE_EMPTY)) {
            put_absent(member, column);
            continue;
        }
        const char *accepted = read_cell(member, said, column, text);
        if (accepted) return refuse(rows, row, column->name, text, accepted);
    }
    return STATUS_OK;
}

Status table_rows_numbers(double **out, const TableRows *rows)
{
    const size_t count = (size_t)rows->format->count;
    double      *numbers = calloc((size_t)rows->table.rows * count + 1, sizeof *numbers);
    Status       status = numbers ? STATUS_OK : STATUS_NO_MEMORY;
    for (int r = 0; r < rows->table.rows && status == STATUS_OK; r++)
        status = table_rows_get(numbers + (size_t)r * count, rows, r);
    if (status == STATUS_OK) *out = numbers;
    else free(numbers);
    return status;
}

/* ---- every row, by its keys -------------------------------------------------------------------- */

/* Place among all combinations of keys of those of a row; with all: their number. */
static size_t key_of(const TableFormat *format, const void *row, bool all)
{
    size_t place = 0, number = 1;
    for (int c = 0; c < format->count; c++) {
        const TableColumn *column = &format->column[c];
        if (!column->key) continue;
        const size_t values = (size_t)(last_word(column) + 1);
        if (!all) place = place * values + (size_t) * (const int *)((const char *)row + column->offset);
        number *= values;
    }
    return all ? number : place;
}

/* The words of a combination; false: some key's number has none. */
static bool key_text(char out[256], const TableFormat *format, size_t key)
{
    char   word[64], behind[256];
    size_t values = 1;
    *out = 0;
    for (int c = format->count - 1; c >= 0; c--, key /= values) {
        const TableColumn *column = &format->column[c];
        values = column->key ? (size_t)(last_word(column) + 1) : 1;
        if (!column->key) continue;
        const int k = (int)(key % values);
        if (k < (int)column->low) return false;
        word_of(word, column, k);
        snprintf(behind, sizeof behind, "%s", out);
        snprintf(out, 256, "%s %s%s%.150s", column->name, word, *behind ? ", " : "", behind);
    }
    return *out != 0;
}

Status table_each(const TableFormat *format, const char *path, void *row, size_t size, TableTake *take, void *user)
{
    TableRows    rows;
    char         said[256];
    const size_t keys = key_of(format, NULL, true);
    Status       status = table_rows_open(&rows, format, path);
    if (status != STATUS_OK) return status;
    bool *seen = calloc(keys, sizeof *seen);
    if (!seen) status = STATUS_NO_MEMORY;
    for (int r = 0; r < rows.table.rows && status == STATUS_OK; r++) {
        memset(row, 0, size);
        status = table_rows_get(row, &rows, r);
        const size_t key = status == STATUS_OK ? key_of(format, row, false) : 0;
        if (status == STATUS_OK && seen[key] && key_text(said, format, key))
            status = table_rows_refuse(&rows, r, NULL, "a second row of %s", said);
        if (status == STATUS_OK) status = take(user, row, &rows, r);
        seen[key] = true;
    }
    for (size_t key = 0; key < keys && format->every && status == STATUS_OK; key++)
        if (!seen[key] && key_text(said, format, key)) status = table_rows_lack(&rows, "no row of %s", said);
    free(seen);
    table_rows_close(&rows);
    return status;
}
