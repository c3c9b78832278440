/* tests/render/atmosphere_errors.h: errors of many points, collected and judged; cells of a table by name. */
#ifndef TESTS_RENDER_ATMOSPHERE_ERRORS_H
#define TESTS_RENDER_ATMOSPHERE_ERRORS_H

#include "tests/check.h"

enum { errors_max = 40000 };

typedef struct Errors {
    int    count;
    double worst, square;
    int    worst_line;
    double one[errors_max];
} Errors;

static void keep(Errors *errors, double error, int line)
{
    error = fabs(error);
    if (isnan(error)) error = INFINITY;
    if (errors->count < errors_max) errors->one[errors->count++] = error;
    errors->square += error * error;
    if (error < errors->worst) return;
    errors->worst = error;
    errors->worst_line = line;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double percentile(Errors *errors, double share)
{
    qsort(errors->one, (size_t)errors->count, sizeof *errors->one, compare);
    return errors->one[(int)fmin(share * errors->count, errors->count - 1)];
}

/* One row of a table, by column name. */
static double cell(const Table *table, int row, const char *column)
{
    const int c = table_column(table, column);
    double    value = NAN;
    if (c < 0) fail_msg("%s: no column %s", table->path, column);
    return text_to_double(&value, table_text(table, row, c)) ? value : NAN;
}

static const char *word(const Table *table, int row, const char *column)
{
    const int c = table_column(table, column);
    if (c < 0) fail_msg("%s: no column %s", table->path, column);
    return table_text(table, row, c);
}

static double relative(double got, double want, double floor) { return (got - want) / fmax(fabs(want), floor); }

/* Says a file's worst and fails beyond the limit; p99 and worst are of relative errors. */
static void judge(Errors *errors, const char *what, double p99_limit, double worst_limit)
{
    const double p99 = percentile(errors, 0.99);
    printf("  %-34s %5d points: median %.1e, p99 %.1e, worst %.1e (line %d)\n", what, errors->count,
           percentile(errors, 0.5), p99, errors->worst, errors->worst_line);
    CHECK(errors->count > 0);
    if (!(p99 <= p99_limit && errors->worst <= worst_limit))
        fail_msg("%s: p99 %g, limit %g; worst %g, limit %g", what, p99, p99_limit, errors->worst, worst_limit);
}

#endif
