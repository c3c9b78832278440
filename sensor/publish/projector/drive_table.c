/* sensor/publish/projector/drive_table.c: drive levels by a table of a projector's measurement. */
#include "sensor/publish/projector/drive_table.h"

#include "pitviper_table.h"

#include <stdlib.h>

static const double least_step = 1e-30; /* between values: slopes are finite, in numbers that are not denormal */

typedef struct Row {
    double radiance, counts, level;
} Row;

typedef struct Reading {
    DriveTable table;
    int        room, most;
} Reading;

static const TableColumn columns[] = {
    {"radiance", TABLE_DOUBLE, TABLE_AT(Row, radiance), .low = -1e30, .high = 1e30, .absent = TABLE_LATER},
    {"counts", TABLE_WHOLE, TABLE_AT(Row, counts), .low = 0, .high = 65535, .absent = TABLE_LATER},
    {"level", TABLE_DOUBLE, TABLE_AT(Row, level), .low = 0, .high = 65535}};
static const TableFormat format = {.module = "projector",
                                   .column = columns,
                                   .count = sizeof columns / sizeof *columns,
                                   .next = "etc/reference/projector.md explains the columns",
                                   .least_rows = 2,
                                   .most_rows = drive_rows_most};

static Status make_room(Reading *r)
{
    if (r->table.rows < r->room) return STATUS_OK;
    const int larger = r->room ? 2 * r->room : 256;
    double   *value = realloc(r->table.value, (size_t)larger * sizeof *value);
    if (value) r->table.value = value;
    double *level = realloc(r->table.level, (size_t)larger * sizeof *level);
    if (level) r->table.level = level;
    if (!value || !level) return STATUS_NO_MEMORY;
    r->room = larger;
    return STATUS_OK;
}

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    Reading   *r = user;
    const Row *row = read;
    const bool radiance = table_rows_has(rows, "radiance"), counts = table_rows_has(rows, "counts");
    if (radiance == counts) return table_rows_lack(rows, "one of the columns radiance and counts, and not both");
    const double value = counts ? row->counts : row->radiance;
    if (number > 0 && !(value - r->table.value[number - 1] >= least_step))
        return table_rows_refuse(rows, number, counts ? "counts" : "radiance", "above that of the row before");
    if (row->level > r->most)
        return table_rows_refuse(rows, number, "level", "at most %d, with projector.bits: %d", r->most,
                                 r->most > 255 ? 16 : 8);
    const Status status = make_room(r);
    if (status != STATUS_OK) return status;
    r->table.counts = counts;
    r->table.value[number] = value;
    r->table.level[number] = row->level;
    r->table.rows = number + 1;
    return STATUS_OK;
}

/* The bin of a value between the first and the last; it never falls as the value rises. */
static int bin_of(const DriveTable *t, double value)
{
    const double low = t->value[0], high = t->value[t->rows - 1];
    return (int)fmin((value - low) / (high - low) * drive_bins, drive_bins - 1);
}

/* Slopes, and where to look for a value: most of its rows are passed over by one division. */
static Status index_rows(DriveTable *t)
{
    t->slope = calloc((size_t)t->rows, sizeof *t->slope);
    if (!t->slope) return STATUS_NO_MEMORY;
    for (int i = 0; i + 1 < t->rows; i++)
        t->slope[i] = (t->level[i + 1] - t->level[i]) / (t->value[i + 1] - t->value[i]);
    for (int i = 0, bin = 0; bin <= drive_bins; bin++) {
        while (i + 1 < t->rows && bin_of(t, t->value[i + 1]) < bin) i++;
        t->of_bin[bin] = i;
    }
    return STATUS_OK;
}

Status drive_table_read(DriveTable *out, const char *path, int most)
{
    Reading r = {.most = most};
    Row     row;
    Status  status = table_each(&format, path, &row, sizeof row, take_row, &r);
    if (status == STATUS_OK) status = index_rows(&r.table);
    if (status == STATUS_OK && r.table.counts) {
        r.table.of_count = malloc(65536 * sizeof *r.table.of_count);
        if (!r.table.of_count) status = STATUS_NO_MEMORY;
        for (int k = 0; k < 65536 && status == STATUS_OK; k++) r.table.of_count[k] = drive_level(&r.table, k);
    }
    if (status == STATUS_OK) *out = r.table;
    else drive_table_free(&r.table);
    return status;
}

void drive_table_free(DriveTable *t)
{
    free(t->value);
    free(t->level);
    free(t->slope);
    free(t->of_count);
    *t = (DriveTable){0};
}

uint16_t drive_level(const DriveTable *t, double value)
{
    const int last = t->rows - 1;
    if (!(value > t->value[0])) return (uint16_t)floor(t->level[0] + 0.5);
    if (value >= t->value[last]) return (uint16_t)floor(t->level[last] + 0.5);
    const int bin = bin_of(t, value);
    int       low = t->of_bin[bin], high = t->of_bin[bin + 1] + 1; /* the value is from low on, below high */
    if (high > last) high = last;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (t->value[middle] <= value) low = middle;
        else high = middle;
    }
    return (uint16_t)floor(t->level[low] + t->slope[low] * (value - t->value[low]) + 0.5);
}

void drive_levels_of_radiance(uint16_t *out, const DriveTable *t, const float *radiance, size_t count)
{
    for (size_t i = 0; i < count; i++) out[i] = drive_level(t, (double)radiance[i]);
}

void drive_levels_of_counts(uint16_t *out, const DriveTable *t, const uint16_t *counts, size_t count)
{
    for (size_t i = 0; i < count; i++) out[i] = t->of_count[counts[i]];
}
