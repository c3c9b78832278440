/* pitviper_table.h: rows of a CSV file into structs, one TableColumn a column.
 *
 *   typedef struct Camera { int width_px; double pitch_m; } Camera;
 *   static const TableColumn columns[] = {
 *       {"width_px", TABLE_INT, TABLE_AT(Camera, width_px), .low = 8, .high = 8192},
 *       {"pitch_um", TABLE_DOUBLE, TABLE_AT(Camera, pitch_m), .low = 1, .high = 100, .unit = 1e-6}};
 *   static const TableFormat format = {"cameras", columns, 2, "etc/cameras.csv explains the columns"};
 *
 * The order of columns in the file is free; those that no TableColumn names are skipped; of two with one name the first
 * is read. What is wrong is STATUS_BAD_VALUE and one line: module, file, line, column, value, what is accepted, and the
 * format's next step. The form of the file (comments, quotes, blanks) is table_open's, pitviper.h. */
#ifndef PITVIPER_TABLE_H
#define PITVIPER_TABLE_H

#include "pitviper.h"

typedef enum TableType {
    TABLE_DOUBLE,
    TABLE_FLOAT,
    TABLE_WHOLE, /* double; whole numbers alone */
    TABLE_INT,
    TABLE_NAME,   /* char[]: 1 .. size - 1 octets */
    TABLE_CELL,   /* const char *: any text, the empty one too; the table's, until it is closed */
    TABLE_CHOICE, /* an enum, or an int: the place of the word in choices */
    TABLE_NAMED,  /* an enum, or an int: the k in low .. high whose named(k) is the text */
    TABLE_OWN,    /* read by parse */
} TableType;

typedef enum TableAbsent {
    TABLE_REQUIRED,
    TABLE_LATER,    /* the column may be missing, as in files that are older than it; no cell of it may be empty */
    TABLE_EMPTY,    /* the column must be there, and a cell of it may be empty */
    TABLE_OPTIONAL, /* the column may be missing, and a cell of it empty */
} TableAbsent;

typedef struct TableColumn {
    const char *name; /* with the unit of the file: pitch_um */
    TableType   type;
    size_t      offset, size; /* TABLE_AT(Struct, member) */
    double      low, high;    /* of a number, in the file's unit, both included */
    double      unit;         /* member = unit * number; 0: 1 */
    TableAbsent absent;
    double      otherwise; /* the number (file's unit) or choice where absent; a text is "", TABLE_OWN is not written */
    const char *choices;   /* TABLE_CHOICE: "a, b, c" */
    const char *(*parse)(void *member, const char *text); /* TABLE_OWN; NULL: it is read; else what is accepted */
    const char *(*named)(int k);                          /* TABLE_NAMED */
    bool key; /* TABLE_CHOICE, TABLE_NAMED: table_each refuses two rows with the same keys. Required, .low >= 0 */
} TableColumn;
#define TABLE_AT(type, member) offsetof(type, member), sizeof(((type *)0)->member)

typedef struct TableFormat {
    const char        *module; /* prefix of the messages */
    const TableColumn *column;
    int                count;                 /* <= table_columns_most */
    const char        *next;                  /* what to do when it is wrong: "etc/sensors.csv explains the columns" */
    int                least_rows, most_rows; /* most_rows 0: any number */
    bool               every;                 /* table_each needs a row with each combination of keys */
} TableFormat;

enum { table_columns_most = 64 };

typedef struct TableRows {
    Table              table;
    const TableFormat *format;
    int                at[table_columns_most]; /* the format's columns in the file; -1: absent */
} TableRows;

/* Opens a file, finds the format's columns, counts its rows. The format outlives the rows. On failure there is nothing
 * to close. */
Status table_rows_open(TableRows *out, const TableFormat *format, const char *path);
void   table_rows_close(TableRows *rows);
/* Finds the columns of another format, and counts rows, in a file that was opened for the choice. On failure it is
 * still to be closed. */
Status table_rows_use(TableRows *rows, const TableFormat *format);
/* Fills the members that the format's columns name, and no other; row: 0 .. rows->table.rows - 1. */
Status table_rows_get(void *out, const TableRows *rows, int row);
/* Whether the file has that column; the text of a cell, "" where it has not. */
bool        table_rows_has(const TableRows *rows, const char *column);
const char *table_rows_text(const TableRows *rows, int row, const char *column);
/* The row of that name, in the column `name`; else logs those that there are, and the nearest. Two of that name are
 * refused. what: "sensor", for the message; beside: where else it was looked for, " (nor in FILE)", or ""; other: a
 * name without a row, or "". */
Status table_rows_find(int *row, const TableRows *rows, const char *name, const char *what, const char *beside,
                       const char *other);

/* Logs that the value of a column is not what is said here, or with column NULL what is wrong with the row; returns
 * STATUS_BAD_VALUE. For what columns mean together. */
Status table_rows_refuse(const TableRows *rows, int row, const char *column, const char *accepted, ...)
    __attribute__((format(printf, 4, 5)));
/* The same of the whole file: rows that it lacks. */
Status table_rows_lack(const TableRows *rows, const char *what, ...) __attribute__((format(printf, 2, 3)));

/* A format of numbers alone, whose row is double[count]: TABLE_AT_NUMBER(k) is that of index k. The numbers of all
 * rows, [rows][count] and one more; the caller frees them. */
#define TABLE_AT_NUMBER(k) (k) * sizeof(double), sizeof(double)
Status table_rows_numbers(double **out, const TableRows *rows);

/* Every row of a file, in order: `row` (size octets) is zeroed, filled, and given to take, which checks and keeps it.
 */
typedef Status TableTake(void *user, const void *row, const TableRows *rows, int number);
Status table_each(const TableFormat *format, const char *path, void *row, size_t size, TableTake *take, void *user);

#endif
