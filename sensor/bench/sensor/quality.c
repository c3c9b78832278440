/* sensor/bench/sensor/quality.c: `pitviper bench quality`: each row of settings in each scene against 16 x 16 rays
 * in every pixel. A row's error is that of its worst scene. Its time is of two of the scenes in larger images, on
 * one thread, rows interleaved, the best of the rounds. */
#include "sensor/bench/sensor/quality.h"

#include "pitviper_output.h"
#include "sensor/quality/lab.h"
#include "sensor/quality/quality.h"

#include <errno.h>

enum { rounds_most = 2 };

static const QualitySettings reference = {16, 0, 0};

/* the first is the fastest, by which machines are compared */
static const QualitySettings grid[] = {
    {1, 0, 0}, {1, 2, 8},  {1, 2, 24}, {1, 4, 24}, {1, 4, 48},  {1, 8, 64},   {2, 0, 0}, {2, 4, 48},
    {2, 8, 64}, {3, 6, 64}, {3, 9, 96}, {4, 8, 96}, {5, 10, 96}, {6, 12, 128}, {8, 0, 0}, {8, 16, 128}};
enum { grid_count = sizeof grid / sizeof *grid };

/* Of one image, percent and kelvin per band. */
static void errors_of(double percent[quality_bands], double kelvin[quality_bands], const Picture *p,
                      const Picture *true_one, const World *world)
{
    const size_t count = (size_t)p->width * (size_t)p->height;
    double       shares[quality_bands] = {0};
    for (int k = 0; k <= picture_lwir; k++) {
        const int    band = k < picture_mwir ? BAND_OPTICAL : k == picture_mwir ? BAND_MWIR : BAND_LWIR;
        const float *a = picture_plane(p, k), *b = picture_plane(true_one, k);
        double       square = 0, sum = 0, square_k = 0;
        for (size_t i = 0; i < count; i++) {
            const double apart = (double)a[i] - (double)b[i];
            square += apart * apart;
            sum += (double)b[i];
            if (band == BAND_OPTICAL) continue;
            const PlanckTable *planck = band == BAND_MWIR ? world->planck_mwir : world->planck_lwir;
            const double apart_k = planck_table_temp(planck, (double)a[i]) - planck_table_temp(planck, (double)b[i]);
            square_k += apart_k * apart_k;
        }
        shares[band] += square * (double)count / (sum * sum) / (band == BAND_OPTICAL ? 3 : 1);
        kelvin[band] = band == BAND_OPTICAL ? NAN : sqrt(square_k / (double)count);
    }
    for (int b = 0; b < quality_bands; b++) percent[b] = 100 * sqrt(shares[b]);
}

static Status measure_errors(QualityTable *table, QualityLab *lab, Bench *bench)
{
    for (int v = 0; v < quality_lab_views; v += lab->quick ? 3 : 1) {
        char what[64];
        snprintf(what, sizeof what, "errors, view %d of %d", v + 1, quality_lab_views);
        bench_progress(bench, what);
        TrialFrame fine = quality_lab_frame(lab, v, reference);
        fine.pool  = lab->many;
        fine.arena = lab->reference_arena;
        trial_frame(&fine);
        for (int k = 0; k < grid_count && fine.status == STATUS_OK; k++) {
            TrialFrame  f = quality_lab_frame(lab, v, grid[k]);
            double      percent[quality_bands], kelvin[quality_bands];
            QualityRow *r = &table->row[k];
            f.pool = lab->many;
            trial_frame(&f);
            if (f.status != STATUS_OK) return f.status;
            errors_of(percent, kelvin, &f.picture, &fine.picture, &lab->scene.world);
            for (int b = 0; b < quality_bands; b++) {
                r->percent[b] = fmax(r->percent[b], percent[b]);
                r->kelvin[b]  = b == BAND_OPTICAL ? NAN : fmax(r->kelvin[b], kelvin[b]);
            }
        }
        if (fine.status != STATUS_OK) return fine.status;
    }
    return STATUS_OK;
}

/* Rows that some target selects are marked, like a front. */
static void list_row(Bench *bench, const QualityTable *table, int k, const BenchTime *time)
{
    const QualityRow *r = &table->row[k], *first = &table->row[0];
    char              what[96];
    if (r->edge_samples > 0)
        snprintf(what, sizeof what, "samples %d, edge_samples %d, target_samples %d", r->samples, r->edge_samples,
                 r->target_samples);
    else snprintf(what, sizeof what, "samples %d, antialias off", r->samples);
    BenchRow row   = bench_row(what);
    row.median     = time->median_s;
    row.best       = time->best_s;
    row.unit       = "s";
    row.rate       = 1 / time->median_s;
    row.rate_unit  = "Mpx/s";
    row.ratio      = r->ms_megapixel / first->ms_megapixel;
    row.to         = "the first";
    row.error      = fmax(r->percent[BAND_OPTICAL], fmax(r->percent[BAND_MWIR], r->percent[BAND_LWIR]));
    row.error_unit = "%";
    row.against    = "16 x 16 rays a pixel: worst band of the worst view";
    row.mark       = quality_wanted(table, k) ? "*" : NULL;
    bench_add(bench, &row);
}

Status bench_quality_check(const Bench *bench)
{
    const char *path = bench_option(bench, "table");
    if (!path || output_check(path, 0) == 0) return STATUS_OK;
    log_error("bench: --table: cannot write %s: %s; choose another place", path, output_reason(errno));
    return STATUS_IO;
}

Status bench_quality(Bench *bench)
{
    QualityLab   lab;
    QualityTable table = {.count = grid_count};
    BenchTime    time[grid_count] = {0};
    const char  *path = bench_option(bench, "table");
    bench_progress(bench, "ground and vehicles");
    Status status = quality_lab_open(&lab, 1, bench_quick(bench));
    for (int k = 0; k < grid_count; k++)
        table.row[k] = (QualityRow){.samples = grid[k].samples, .edge_samples = grid[k].edge_samples,
                                      .target_samples = grid[k].target_samples};
    if (status == STATUS_OK) status = measure_errors(&table, &lab, bench);
    const int rounds = lab.quick ? 1 : rounds_most;
    quality_lab_enlarge(&lab);
    for (int n = 0; n < rounds && status == STATUS_OK; n++)
        for (int k = 0; k < grid_count; k++) {
            char what[64];
            snprintf(what, sizeof what, "times, round %d of %d", n + 1, rounds);
            bench_progress(bench, what);
            time[k].item_s[n] = quality_lab_time(&lab, grid[k], false);
            time[k].rounds    = n + 1;
            if (isnan(time[k].item_s[n])) status = STATUS_NO_MEMORY;
        }
    for (int k = 0; k < grid_count && status == STATUS_OK; k++) {
        bench_time_finish(&time[k]);
        table.row[k].ms_megapixel = 1e3 * time[k].best_s;
    }
    for (int k = 0; k < grid_count && status == STATUS_OK; k++) list_row(bench, &table, k, &time[k]);
    /* what nothing would pick is not written, but for the first, by which machines are compared */
    QualityTable written = {.count = 0};
    for (int k = 0; k < grid_count; k++)
        if (k == 0 || quality_wanted(&table, k)) written.row[written.count++] = table.row[k];
    if (status == STATUS_OK && path)
        status = quality_write(path, &written,
                               "rms error at most, and time on one thread of the machine it was measured on, by "
                               "`pitviper bench quality --table FILE`");
    quality_lab_close(&lab);
    return status;
}
