/* tests/bench/bench_private.h: shared by the files of the bench command. */
#ifndef TESTS_BENCH_BENCH_PRIVATE_H
#define TESTS_BENCH_BENCH_PRIVATE_H

#include "tests/bench/bench.h"
#include "sensor/publish/files/html_page.h"

enum { bench_options_max = 16, bench_parts_max = 64 };

typedef struct BenchOption {
    char        name[24];
    const char *value;
} BenchOption;

/* A row stored for the report: it owns its texts. */
typedef struct BenchKept {
    BenchRow row;
    char    *plot; /* SVG placed after the row; NULL: none */
} BenchKept;

/* The rows of one tunable, for the report; its plot is placed after the last. */
typedef struct BenchBlock {
    int  first, rows, chosen; /* of the stored rows; chosen: the default's, -1: none */
    bool broken;              /* a row of it is beyond its limit */
    char name[96], turned_by[96], of[128], also[64], words[512];
} BenchBlock;

typedef struct BenchPart { /* a suite, of all libraries */
    const char *name, *help, *reads;
    int         first, count; /* of the stored rows */
    int         failed;       /* suites that failed to complete */
    double      took_s;
} BenchPart;

typedef struct BenchMachine {
    char        processor[128], governor[32], system[80], compiler[80], libraries[512];
    const char *isa;
    int         cores;
    double      load, memory_gb; /* load: of the last minute, before the run; NaN: unknown */
} BenchMachine;
void bench_machine_read(BenchMachine *out);
void bench_machine_line(char out[512], const BenchMachine *machine);

struct Bench {
    const char *suite, *room; /* room: the suites of this one alone; NULL: of all */
    bool        quick, all;
    int         threads, options, rows, broken; /* broken: rows whose error is beyond its limit */
    BenchOption option[bench_options_max];
    const char *plots;                 /* folder; NULL: not requested */
    bool        out_of_memory, spoilt; /* spoilt: a plot could not be written */
    FILE       *csv;
    BenchKept  *kept; /* [kept_count] */
    int         kept_count, kept_capacity;
    BenchBlock *block; /* [blocks], by their first rows */
    int         blocks, blocks_capacity;
    BenchPart  *part; /* [parts] */
    int         parts;
};

/* Gives the value at a share 0 .. 1 of sorted values, interpolated linearly. */
double bench_quantile(const double *value, int count, double share);
/* Writes three digits and a unit, seconds with a fitting prefix. */
void bench_show(char out[32], double value, const char *unit);
/* Whether its error is within its limit, or has none. */
bool bench_holds(const BenchRow *row);

/* Writes the stored rows, part by part, with their plots, failures first. took_s: the time of the whole run. */
Status bench_report(const Bench *bench, const BenchMachine *machine, const char *path, double took_s);
/* `bench compare A.csv B.csv [--report FILE] [--slower FACTOR]`; argv[0]: compare. Exit code. */
int bench_compare(int argc, char **argv);
/* Frees the stored rows. */
void bench_forget(Bench *bench);

#endif
