/* sensor/quality/machine_factor.c: times the fastest settings by the wall clock, the best of five. */
#include "sensor/quality/machine_factor.h"

#include "sensor/quality/lab.h"
#include "sensor/quality/quality.h"

Status machine_factor(double *factor, const char *table_path, int threads)
{
    QualityLab   lab;
    QualityTable table;
    char         text[32];
    Status       status = quality_open(&table, table_path);
    if (status != STATUS_OK) return status;
    const QualityRow *first = &table.row[0];
    if (first->scene == QUALITY_WOODS || first->samples != quality_quickest.samples || first->edge_samples != quality_quickest.edge_samples ||
        first->target_samples != quality_quickest.target_samples) {
        log_error(
            "quality: %s: its first row is not samples 1 without edge_samples on bare ground, by which machines are compared; give "
            "quality.machine_factor",
            table_path);
        return STATUS_BAD_VALUE;
    }
    status = quality_lab_open(&lab, threads, false);
    quality_lab_enlarge(&lab);
    double best_s = INFINITY;
    for (int n = 0; n < 5 && status == STATUS_OK; n++) {
        const double s = quality_lab_time(&lab, quality_quickest, true);
        if (isnan(s)) status = STATUS_NO_MEMORY;
        best_s = fmin(best_s, s);
    }
    if (status == STATUS_OK) {
        /* rounded as it is written, so that giving it again gives the same value */
        snprintf(text, sizeof text, "%.2g", 1e3 * best_s / first->ms_megapixel);
        if (!text_to_double(factor, text)) status = STATUS_BAD_VALUE;
        *factor = clamp(*factor, 0.001, 1000);
    }
    quality_lab_close(&lab);
    return status;
}
