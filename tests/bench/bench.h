/* tests/bench/bench.h: the harness of `pitviper bench`: suites of rows, each a time with its error. */
#ifndef TESTS_BENCH_BENCH_H
#define TESTS_BENCH_BENCH_H

#include "pitviper.h"

/* One line of a table. Fields without a value are NaN, or NULL for text; bench_row gives a row of those. Suite and
 * `what` identify a row in other versions and on other machines, too, so `what` holds no measured figure. */
typedef struct BenchRow {
    const char *what;
    double      median, best; /* of an item; unit "s" is printed as ns .. s, any other as it is */
    const char *unit;
    double      rate; /* items per second, in this unit */
    const char *rate_unit;
    double      ratio; /* relative to the row that `to` names */
    const char *to;
    double      error, error_limit; /* passes when error <= limit; no limit: measured, not checked */
    const char *error_unit, *against;
    double      low, high; /* quartiles of the rounds, in unit: the noise */
    const char *mark;      /* printed after `what`, not part of it: "* default" */
} BenchRow;

typedef struct Bench Bench;

/* One suite of `pitviper bench NAME`, in one room. tests/bench/suites.c lists them; those with one name run one after
 * another. */
typedef struct BenchSuite {
    const char *name, *help;
    const char *room;            /* that it judges */
    const char *options;         /* in addition to those of every bench, for the usage text: "size=WxH,model=FILE";
                                  * NULL */
    Status (*run)(Bench *bench); /* logs the reason of a failure */
    Status (*check)(const Bench *bench); /* of the options' values, before anything is set up; logged. NULL: none */
    const char *reads; /* how to read its table, one sentence for a report; NULL: as the others of this name */
} BenchSuite;

BenchRow bench_row(const char *what);
void     bench_add(Bench *bench, const BenchRow *row);
/* Keeps the largest error so far, by magnitude, where NaN counts as larger than any; and makes its row. For rows with
 * errors only. */
void bench_worse(double *worst, double error);
void bench_stress(Bench *bench, const char *what, double error, double limit, const char *unit, const char *against);
bool bench_quick(const Bench *bench); /* seconds, not minutes: fewer rounds */
int  bench_threads(const Bench *bench);
const char *bench_option(const Bench *bench, const char *name); /* NULL: not given */
double      bench_memory_mb(const char *key);                   /* of /proc/self/status, "VmRSS:"; NaN: unknown */
void        bench_progress(Bench *bench, const char *what);     /* on a terminal */

/* Work to be timed: `run` does `items` of it. Takes inputs the compiler cannot see, passes results to bench_keep. */
typedef struct BenchWork {
    void (*run)(void *user);
    void  *user;
    double items;
} BenchWork;
enum { bench_rounds_max = 64 };
typedef struct BenchTime {
    int    rounds;
    double item_s[bench_rounds_max]; /* of each round */
    double median_s, best_s;         /* of an item */
} BenchTime;
/* Computes the median and the best of item_s[rounds]. */
void bench_time_finish(BenchTime *time);
/* Runs all of them in turn, round after round, after one warm-up round. */
void   bench_time(BenchTime *out, Bench *bench, const BenchWork *work, int count);
double bench_ratio(const BenchTime *a, const BenchTime *b); /* median over the rounds of a / b */
/* Row of a time: median, best and items a second. */
BenchRow bench_row_of(const char *what, const BenchTime *time, const char *rate_unit, double per_rate);
/* The compiler must assume that this memory is read. */
static inline void bench_keep(const void *memory) { __asm__ volatile("" : : "g"(memory) : "memory"); }

/* ---- time against error: the settings of one tunable ---------------------------------------- */

/* One setting. */
typedef struct BenchSetting {
    const char *setting;    /* "2 x 2" */
    BenchTime   time;       /* all settings of a tunable are timed in turn, by one bench_time */
    double      error;      /* in BenchTunable.error_unit, against a reference that does not approximate */
    double      also;       /* a second error of the same setting, checked like the first; 0: there is none */
    const char *also_is;    /* its meaning, of the first setting: "of 8-12 um, K" */
    double      bytes;      /* memory that the setting needs; 0: the same for all; 1: negligible */
    bool        is_default; /* exactly one is */
} BenchSetting;

typedef struct BenchTunable {
    const char *name;                 /* "rays a pixel" */
    const char *turned_by;            /* the configuration key, or the file of the constant: "render/air/air.c" */
    const char *of;                   /* what is timed: "a frame of 320 x 216, three bands" */
    const char *error_unit, *against; /* "%"; "256 rays a pixel" */
    double      stated;               /* the largest stated error of the default */
} BenchTunable;

enum { bench_settings_max = 16 };
/* Times the settings of a tunable in turn, work[k] being point[k]'s, and adds the rows of bench_tunable_rows. A default
 * that would fail gets twice as many rounds first: a load on the machine should not decide. */
void bench_tunable(Bench *bench, const BenchTunable *tunable, const BenchWork *work, BenchSetting *point, int count);
/* Rows of the table, a plot, and the verdict: the default must keep the stated error, and no other setting may be
 * better beyond noise in time, error or memory without being worse in another of them: the Pareto front, marked `*`.
 * The rule is in tests/bench/tunable.c. */
void bench_tunable_rows(Bench *bench, const BenchTunable *tunable, const BenchSetting *point, int count);
bool bench_dominates(const BenchTunable *tunable, const BenchSetting *a, const BenchSetting *b); /* a dominates b */
bool bench_on_front(const BenchTunable *tunable, const BenchSetting *point, int count, int index);
/* Writes the verdict on the default as text: the errors it keeps, and the better settings there are. quick: times are
 * not checked. */
void bench_verdict(char out[512], const BenchTunable *tunable, const BenchSetting *point, int count, bool quick);
/* More rounds of the same works, appended to the existing ones, up to bench_rounds_max. */
void bench_time_more(BenchTime *time, Bench *bench, const BenchWork *work, int count);
/* Run time against error, log-log, as SVG with its own style, for light and dark: each setting with its name, the
 * front as a line, the default circled, the stated error dashed. */
void plot_tunable(FILE *to, const BenchTunable *tunable, const BenchSetting *point, int count);

/* The command: argv[0] NAME, then options; suites are walked by next(&state) from a zeroed state. Exit code: 1 when a
 * suite failed or an error is beyond its limit. */
typedef const BenchSuite *BenchNext(size_t state[2]);
int                       bench_command(int argc, char **argv, BenchNext *next);

/* For qsort of doubles. */
static inline int bench_by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* A number that contributes to a largest error; NaN propagates. */
static inline void bench_worst(double *worst, double error)
{
    if (!(error <= *worst)) *worst = error;
}

#endif
