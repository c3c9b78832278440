/* tests/bench/sensor/quality_rows.c: `pitviper bench quality`: each row of settings on bare ground and in woods, in
 * each view against 16 x 16 rays in every pixel. A row's error is that of its worst view. Its time is of two of the
 * views in larger images, on one thread, rows interleaved, the best of the rounds. */
#include "tests/bench/suites.h"

#include "pitviper_output.h"
#include "tests/bench/sensor/quality_woods.h"
#include "sensor/quality/quality.h"

#include <errno.h>

enum { rounds_most = 2 };

static const QualitySettings reference = {16, 0, 0};

/* the first is the fastest, by which machines are compared */
static const QualitySettings grid[] = {{1, 0, 0},   {1, 2, 8},    {1, 2, 24}, {1, 4, 24},  {1, 4, 48}, {1, 8, 64},
                                       {2, 0, 0},   {2, 4, 48},   {2, 8, 64}, {3, 6, 64},  {3, 9, 96}, {4, 8, 96},
                                       {5, 10, 96}, {6, 12, 128}, {8, 0, 0},  {8, 16, 128}};
enum { grid_count = sizeof grid / sizeof *grid };

/* Computes the errors of one image in percent and in kelvin per band. */
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

/* Measures the errors of rows of this scene, in the order of the grid. Among plants every second view is taken. */
static Status measure_errors(QualityRow *rows, QualityMeasure *lab, Bench *bench)
{
    const bool woods = rows->scene == QUALITY_WOODS;
    for (int v = 0; v < quality_measure_views; v += lab->quick ? 3 : woods ? 2 : 1) {
        char what[64];
        snprintf(what, sizeof what, "errors, %s, view %d of %d", quality_scene_name(rows->scene), v + 1,
                 quality_measure_views);
        bench_progress(bench, what);
        TrialFrame fine = quality_measure_frame(lab, v, reference);
        fine.pool = lab->many;
        fine.arena = lab->reference_arena;
        trial_frame(&fine);
        for (int k = 0; k < grid_count && fine.status == STATUS_OK; k++) {
            TrialFrame  f = quality_measure_frame(lab, v, grid[k]);
            double      percent[quality_bands], kelvin[quality_bands];
            QualityRow *r = &rows[k];
            f.pool = lab->many;
            trial_frame(&f);
            if (f.status != STATUS_OK) return f.status;
            errors_of(percent, kelvin, &f.picture, &fine.picture, &lab->scene.world);
            for (int b = 0; b < quality_bands; b++) {
                r->percent[b] = fmax(r->percent[b], percent[b]);
                r->kelvin[b] = b == BAND_OPTICAL ? NAN : fmax(r->kelvin[b], kelvin[b]);
            }
        }
        if (fine.status != STATUS_OK) return fine.status;
    }
    return STATUS_OK;
}

static Status measure_times(QualityRow *rows, BenchTime time[grid_count], QualityMeasure *lab, Bench *bench)
{
    QualityMeasure large = *lab;
    const int      rounds = lab->quick || rows->scene == QUALITY_WOODS ? 1 : rounds_most;
    quality_measure_enlarge(&large);
    for (int n = 0; n < rounds; n++)
        for (int k = 0; k < grid_count; k++) {
            char what[64];
            snprintf(what, sizeof what, "times, %s, round %d of %d", quality_scene_name(rows->scene), n + 1, rounds);
            bench_progress(bench, what);
            time[k].item_s[n] = quality_measure_time(&large, grid[k], false);
            time[k].rounds = n + 1;
            if (isnan(time[k].item_s[n])) return STATUS_NO_MEMORY;
        }
    for (int k = 0; k < grid_count; k++) {
        bench_time_finish(&time[k]);
        rows[k].ms_megapixel = 1e3 * time[k].best_s;
    }
    return STATUS_OK;
}

/* Rows that some target selects are marked, like a front. */
static void list_row(Bench *bench, const QualityTable *table, int k, const BenchTime *time)
{
    const QualityRow *r = &table->row[k], *first = &table->row[k / grid_count * grid_count];
    const char       *scene = quality_scene_name(r->scene);
    char              what[96];
    if (r->edge_samples > 0)
        snprintf(what, sizeof what, "%s: samples %d, edge_samples %d, target_samples %d", scene, r->samples,
                 r->edge_samples, r->target_samples);
    else snprintf(what, sizeof what, "%s: samples %d, antialias off", scene, r->samples);
    BenchRow row = bench_row(what);
    row.median = time->median_s;
    row.best = time->best_s;
    row.unit = "s";
    row.rate = 1 / time->median_s;
    row.rate_unit = "Mpx/s";
    row.ratio = r->ms_megapixel / first->ms_megapixel;
    row.to = "the scene's first";
    row.error = fmax(r->percent[BAND_OPTICAL], fmax(r->percent[BAND_MWIR], r->percent[BAND_LWIR]));
    row.error_unit = "%";
    row.against = "16 x 16 rays a pixel: worst band of the worst view";
    row.mark = quality_wanted(table, k) ? "*" : NULL;
    bench_add(bench, &row);
}

Status bench_quality_check(const Bench *bench)
{
    const char *path = bench_option(bench, "table");
    if (!path || output_check(path, 0) == 0) return STATUS_OK;
    log_error("bench: --table: cannot write %s: %s; choose another place", path, output_reason(errno));
    return STATUS_IO;
}

static Status measure(QualityTable *table, BenchTime *time, Woods *woods, QualityMeasure *lab, Bench *bench)
{
    for (int scene = 0; scene < quality_scenes; scene++) {
        QualityRow *rows = table->row + scene * grid_count;
        for (int k = 0; k < grid_count; k++)
            rows[k] = (QualityRow){.scene = (QualityScene)scene,
                                   .samples = grid[k].samples,
                                   .edge_samples = grid[k].edge_samples,
                                   .target_samples = grid[k].target_samples};
        Status status = STATUS_OK;
        if (scene == QUALITY_WOODS) {
            bench_progress(bench, "woods");
            status = quality_woods_plant(woods, lab);
        }
        if (status == STATUS_OK) status = measure_errors(rows, lab, bench);
        if (status == STATUS_OK) status = measure_times(rows, time + scene * grid_count, lab, bench);
        if (status != STATUS_OK) return status;
    }
    return STATUS_OK;
}

/* Rounds rows as a table has them: rows that differ by less are the same. */
static void round_rows(QualityTable *table)
{
    for (int k = 0; k < table->count; k++) {
        QualityRow *r = &table->row[k];
        double     *value[] = {&r->percent[0], &r->percent[1], &r->percent[2], &r->kelvin[1], &r->kelvin[2]};
        for (size_t n = 0; n < sizeof value / sizeof *value; n++) {
            char text[32];
            snprintf(text, sizeof text, "%.3g", *value[n]);
            text_to_double(value[n], text);
        }
    }
}

Status bench_quality(Bench *bench)
{
    enum { rows = quality_scenes * grid_count };
    QualityMeasure   lab;
    QualityTable     table = {.count = rows};
    static BenchTime time[rows];
    Woods            woods = {0};
    const char      *path = bench_option(bench, "table");
    memset(time, 0, sizeof time);
    bench_progress(bench, "ground and vehicles");
    Status status = quality_measure_open(&lab, 1, bench_quick(bench));
    if (status == STATUS_OK) status = measure(&table, time, &woods, &lab, bench);
    round_rows(&table);
    for (int k = 0; k < rows && status == STATUS_OK; k++) list_row(bench, &table, k, &time[k]);
    /* what nothing would pick is not written, but for the first of a scene: machines are compared by that of bare
     * ground */
    QualityTable written = {.count = 0};
    for (int k = 0; k < rows; k++)
        if (k % grid_count == 0 || quality_wanted(&table, k)) written.row[written.count++] = table.row[k];
    if (status == STATUS_OK && path)
        status = quality_write(path, &written,
                               "rms error at most, and time on one thread of the machine it was measured on, by "
                               "`pitviper bench quality --table FILE`");
    quality_measure_close(&lab);
    woods_destroy(&woods);
    return status;
}
