/* pitviper.h: shared basics.
 *
 * Status and log, per-frame memory, one thread pool, counter-based random numbers,
 * text tables, and small vectors. Independent of DIS, Earth and light. */
#ifndef PITVIPER_H
#define PITVIPER_H

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#define PV_RESTRICT
#else
#define PV_RESTRICT restrict
#endif

/* ---- status ------------------------------------------------------------------------------- */

typedef enum Status {
    STATUS_OK = 0,
    STATUS_TRUNCATED,   /* the input ends before the record does */
    STATUS_BAD_VALUE,   /* a field is outside its documented range */
    STATUS_UNSUPPORTED, /* well-formed, but not something this node handles */
    STATUS_IO,          /* a call of the operating system failed */
    STATUS_NO_MEMORY,
} Status;

const char *status_name(Status status);

/* ---- log ---------------------------------------------------------------------------------- */

typedef enum LogLevel { LOG_DETAIL /* hidden by default */, LOG_INFO, LOG_WARN, LOG_ERROR } LogLevel;
typedef void LogSink(void *user, LogLevel level, const char *line);

/* One line, `module: what happened: key=value`, without a newline. Default sink: stderr. Thread-safe.
 * log_set_sink(NULL, NULL) restores the default. log_set_level hides everything below; at first below LOG_INFO.
 * log_suppress: suppresses messages of the calling thread only, until it is undone. */
void        log_set_sink(LogSink *sink, void *user);
void        log_set_level(LogLevel lowest);
const char *log_head(LogLevel level); /* Prefix of a line on stderr: "pitviper: error: "; of information "" */
void        log_suppress(bool hushed);
/* A line at the end of a terminal, rewritten in place and out of the way of what is logged; NULL: none. Nothing where
 * stderr is no terminal, where information is hidden, and with a sink. Standard output: set it to NULL before. */
void log_status(const char *text);
/* Whether --quiet, or --verbose, is set. Quiet: no choices, progress or notices; warnings, errors and requested output
 * stay. */
bool log_is_quiet(void);
bool log_is_verbose(void);
/* Prints to standard output what was not requested: choices, a summary at the end. Prints nothing when quiet. */
void log_print(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_detail(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* ---- arena: memory of one frame -------------------------------------------------------- */

/* Blocks are kept over a reset, so a loop that needs the same amount each time calls malloc only at first; those of
 * requests beyond 1 MB that were not needed since the reset before are freed. arena_alloc may be called by several
 * threads at once; no other function of the arena may run at the same time. */
typedef struct Arena Arena;

Arena *arena_create(void);
void   arena_destroy(Arena *arena);
void   arena_reset(Arena *arena);
/* 64-byte aligned, zeroed; NULL when memory is out or count * size overflows. */
void *arena_alloc(Arena *arena, size_t count, size_t size);
/* The same not zeroed: for what is written before it is read. */
void  *arena_alloc_raw(Arena *arena, size_t count, size_t size);
size_t arena_bytes(const Arena *arena);

/* ---- threads: one pool -------------------------------------------------------------------- */

typedef struct Pool Pool;
/* worker: 0 .. pool_threads - 1, for scratch; task: 0 .. count - 1. */
typedef void PoolTask(void *user, int worker, int task);

/* threads >= 1, the caller counts as one of them. Workers set FTZ/DAZ. */
Status pool_create(Pool **out, int threads);
void   pool_destroy(Pool *pool);
int    pool_threads(const Pool *pool);
/* Runs task(user, worker, i) once for each i, in any order, and returns when all are done. */
void pool_run(Pool *pool, int count, PoolTask *task, void *user);
/* Sets how long work, such as an import of minutes, learns from now on that a stop was requested. NULL: nothing stops
 * it. */
void work_stop_when(bool (*asked)(void));
bool work_stop_asked(void);
/* Runs as pool_run does, or in the caller alone without a pool (NULL); once a stop is requested, tasks that have not
 * begun are left out. Returns false when some may have been. */
bool pool_run_unless_stopped(Pool *pool, int count, PoolTask *task, void *user);
/* Flush-to-zero and denormals-are-zero for the calling thread; main and the workers call it once. */
void thread_flush_denormals(void);

/* Processors that this process may run on, at least 1. */
int thread_processors(void);

/* Monotonic wall clock, s: for pacing and reports, never for results. */
double wall_clock_s(void);

/* ---- random: a pure function of counters -------------------------------------------------- */

/* Philox 4x32-10 (Salmon, Moraes, Dror, Shaw, SC 2011). Same inputs, same bits, in any order. */
void random_u32x4(uint32_t out[4], const uint32_t counter[4], const uint32_t key[2]);
/* One uniform in [0, 1) and one standard normal for (seed, stream, frame, index). */
double random_uniform(uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index);
double random_normal(uint64_t seed, uint32_t stream, uint32_t frame, uint64_t index);
/* Those of indices first .. first + count - 1: the same numbers, several times as fast. */
void random_normals(double *out, size_t count, uint64_t seed, uint32_t stream, uint32_t frame, uint64_t first);

/* ---- text --------------------------------------------------------------------------------- */

/* A CSV file: `#` comment lines and blank lines skipped, first row the header, every row as wide as it. */
typedef struct Table {
    char  *path;
    int    columns, rows;
    char **cell; /* [rows + 1][columns], row 0 is the header; trimmed */
    int   *line; /* line number in the file of each row [rows + 1] */
    char  *text;
} Table;

/* On failure logs file, line and reason. */
Status table_open(Table *out, const char *path);
void   table_close(Table *table);
int    table_column(const Table *table, const char *name); /* -1: none */
/* column[count] of these names; false, logged as the module's, where one is missing. */
bool        table_columns(int *column, const Table *table, const char *const *name, int count, const char *module);
const char *table_text(const Table *table, int row, int column); /* row 0 .. rows - 1 */
/* Finite numbers in [low, high] only; logs file, line, column, value and range otherwise. */
Status table_number(double *out, const Table *table, int row, int column, double low, double high);

/* Splits one line of CSV in place into trimmed cells; quotes keep commas, a doubled quote is one. Returns how many
 * there are, those beyond capacity too; -1: a quote is not closed. */
int text_split(char **cell, int capacity, char *line);
/* Whole string as a finite double / integer; false otherwise (`1,5`, `3x`, empty, out of range). */
bool text_to_double(double *out, const char *text);
bool text_to_long(long long *out, const char *text);
/* The line after the one that `at` is in; NULL: there is none. */
const char *text_next_line(const char *at);
/* UTC as 2026-06-21T10:00:00Z, seconds with or without a fraction, 1900 .. 2100, to Unix time. */
bool text_to_unix_s(double *unix_s, const char *text);
/* Printable ASCII kept, anything else as \xNN; always terminated. For markings and other untrusted bytes. */
void text_escape(char *out, size_t out_size, const char *bytes, size_t count);
/* A text from outside, such as a file's name, made safe for a terminal: valid UTF-8 unchanged; control characters,
 * bidirectional controls and octets that are not UTF-8 as \xNN. lines: newlines and tabs stay. Truncated to the size of
 * the output. */
void text_show(char *out, size_t out_size, const char *text, bool lines);
/* printf to a terminal, file or pipe with text from outside: through text_show, keeping the format's newlines. */
void text_print(FILE *to, const char *format, ...) __attribute__((format(printf, 2, 3)));
void text_vprint(FILE *to, const char *format, va_list arguments) __attribute__((format(printf, 2, 0)));

/* The known word nearest to a mistyped one, by its edit distance: 2 at most, 1 in words of less than six letters, case
 * aside. Start with word_meant, consider every known word, then ask for the hint. Words of at most 63 letters. */
typedef struct WordMeant {
    const char *typed;
    int         least;
    char        word[64], hint[96];
} WordMeant;
WordMeant   word_meant(const char *typed);
void        word_consider(WordMeant *meant, const char *known);
void        word_consider_list(WordMeant *meant, const char *list, char separator); /* "a|b|c" */
const char *word_hint(WordMeant *meant);                                            /* "; did you mean WORD?", or "" */

/* Writes a file of what `put` prints, by output_begin (pitviper_output.h): it has its name only when it is whole.
 * STATUS_IO is logged as the module's. */
Status text_write_file(const char *module, const char *path, void (*put)(FILE *to, const void *user), const void *user);
/* A whole file of at most `most` octets and a 0 behind them; the caller frees it. Failures are logged as the
 * module's. */
Status text_read_file(char **out, size_t *octets, const char *module, const char *path, size_t most);

/* A new empty folder, or file with this suffix, in $TMPDIR or /tmp; the caller removes it. False: logged,
 * and an empty name. */
enum { temp_path_size = 512, temp_name_size = temp_path_size + 128 }; /* temp_name_size: for a file in such a folder */
bool temp_folder(char out[temp_path_size]);
bool temp_file(char out[temp_path_size], const char *ending);

/* Path of a file under etc/: $PITVIPER_ETC, else share/pitviper beside the program, the source folder or the installed
 * one. False when too long. */
bool etc_path(char *out, size_t out_size, const char *name);
/* Whether the files read by every run exist; else logs what is missing, the folders searched, and a remedy. */
bool etc_is_complete(void);
/* A user's table beside catalog.csv, materials.csv or sensors.csv of etc/: its rows take precedence. path
 * NULL or empty: none. False: too long, or no such table. Set before work begins, by one thread. etc_own: NULL:
 * none. */
bool        etc_own_set(const char *name, const char *path);
const char *etc_own(const char *name);

/* ---- probes: one model at a time, for comparison with other programs --------------------------- */

enum { probe_max_columns = 24, probe_text_size = 96 };

typedef struct ProbeValue {
    double      number; /* of an input: its cell as a number. Of an output: the result, written when text is NULL */
    const char *text;   /* of an input: its cell. Of an output: written when not NULL */
    char        buffer[probe_text_size]; /* buffer size of an output's text */
} ProbeValue;

/* A row of CSV in, the same row and its results out. Each module lists its own in <module>/probe.h; `pitviper probe
 * NAME` finds them. Column names carry units and are separated by commas. An input with a `$` behind its name is text,
 * all others must be finite numbers; with a `?` it may be missing, or empty, and is then NaN (or "" for text). */
typedef struct Probe {
    const char *name, *help; /* help: one line, what it computes and from what source */
    const char *arguments;   /* arguments after NAME on the command line, as usage shows them: "MODEL"; NULL: none */
    const char *in, *out;    /* result columns that could not be computed are NaN, and written empty */
    /* May be NULL. On failure logs why; *state is then not closed. argv[0] is the probe's name. */
    Status (*open)(void **state, int argc, char **argv);
    /* NULL: success; else the reason, for the row's error column (in static storage, or in out[0].buffer). */
    const char *(*row)(void *state, const ProbeValue *in, ProbeValue *out);
    void (*close)(void *state); /* may be NULL */
} Probe;

/* Reads CSV with a header from in, writes to out: its columns, those of the probe, and `error`. Extra columns pass
 * through; a bad row gets its reason and empty results. STATUS_BAD_VALUE, logged, when a column is missing. */
Status probe_run(const Probe *probe, int argc, char **argv, FILE *in, FILE *out);

/* ---- small vectors ------------------------------------------------------------------------ */

/* Matrices are row by row: r_a_from_b[3 * row + column]. */

static const double pi_rad = 3.14159265358979323846;
static const double rad_per_deg = 0.017453292519943295769;

static inline double v3_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double v3_length(const double a[3]) { return sqrt(v3_dot(a, a)); }

static inline void v3_sub(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static inline void v3_add(double out[3], const double a[3], const double b[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[i] + b[i];
}

/* a + s b */
static inline void v3_add_scaled(double out[3], const double a[3], double s, const double b[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[i] + s * b[i];
}

static inline void v3_scale(double out[3], double s, const double a[3])
{
    for (int i = 0; i < 3; i++) out[i] = s * a[i];
}

/* out must not alias a or b. */
static inline void v3_cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* False, and out untouched, when a is zero or not finite. May alias. */
static inline bool v3_normalize(double out[3], const double a[3])
{
    const double n = v3_length(a);
    if (!(n > 0) || !isfinite(n)) return false;
    v3_scale(out, 1 / n, a);
    return true;
}

static inline bool v3_is_finite(const double a[3]) { return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]); }

/* out = m a; out must not alias a. */
static inline void m3_mul_v3(double out[3], const double m[9], const double a[3])
{
    for (int i = 0; i < 3; i++) out[i] = m[3 * i] * a[0] + m[3 * i + 1] * a[1] + m[3 * i + 2] * a[2];
}

/* out = transpose(m) a, the inverse for a rotation; out must not alias a. */
static inline void m3_tmul_v3(double out[3], const double m[9], const double a[3])
{
    for (int i = 0; i < 3; i++) out[i] = m[i] * a[0] + m[3 + i] * a[1] + m[6 + i] * a[2];
}

/* out = a b; out must not alias. */
static inline void m3_mul(double out[9], const double a[9], const double b[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

/* out = transpose(a) b; out must not alias. */
static inline void m3_tmul(double out[9], const double a[9], const double b[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
}

static inline void m3_identity(double out[9])
{
    for (int i = 0; i < 9; i++) out[i] = i % 4 == 0;
}

static inline double clamp(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

#ifdef __cplusplus
}
#endif
#endif
