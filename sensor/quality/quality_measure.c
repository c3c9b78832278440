/* sensor/quality/quality_measure.c: measures what sampling settings cost on this machine. Times are those of two of
 * the views. */
#include "sensor/quality/quality_measure.h"

#include "sensor/settings/config.h"
#include "sensor/quality/quality.h"
#include "terrain/ground/landscape.h"

#include <time.h>

enum { vehicles = 20, timed_width = 360, timed_height = 240 };

static const struct {
    double back_m, above_m, hfov_deg;
} views[quality_measure_views] = {{60, 12, 40},   {150, 30, 40}, {300, 40, 20},  {300, 8, 30},
                                  {600, 100, 40}, {900, 60, 8},  {1500, 300, 20}};
static const int timed[] = {2, 6};
enum { timed_count = sizeof timed / sizeof *timed };

Status quality_measure_open(QualityMeasure *m, int threads, bool quick)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}, {1, 1, 222, 28, 1, 0, 0}};
    const Geodetic             origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    LocalFrame                 frame;
    double                     times_s[2];
    char                       catalog[512];
    *m = (QualityMeasure){.width = quick ? 32 : 120, .height = quick ? 24 : 80, .quick = quick};
    Status status = pool_create(&m->pool, threads);
    if (status == STATUS_OK) status = pool_create(&m->many, thread_processors());
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK)
        status = landscape_quick(&m->ground, times_s, &frame, quality_measure_east_m, quality_measure_north_m, m->many);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = trial_scene_open(&m->scene, &m->ground, catalog, types, 3, vehicles);
    m->arena = arena_create();
    m->reference_arena = arena_create();
    return status == STATUS_OK && !(m->arena && m->reference_arena) ? STATUS_NO_MEMORY : status;
}

void quality_measure_close(QualityMeasure *m)
{
    trial_scene_close(&m->scene);
    landscape_destroy(&m->ground);
    arena_destroy(m->arena);
    arena_destroy(m->reference_arena);
    pool_destroy(m->many);
    pool_destroy(m->pool);
}

TrialFrame quality_measure_frame(const QualityMeasure *m, int view, QualitySettings settings)
{
    TrialFrame f = {.scene = &m->scene, .pool = m->pool, .arena = m->arena};
    f.request = (RenderRequest){.bands = 7,
                                .truth = true,
                                .optical = OPTICAL_RGB,
                                .samples = settings.samples,
                                .edge_samples = settings.edge_samples,
                                .target_samples = settings.target_samples,
                                .sky_visibility = true,
                                .hidden_entity = -1};
    if (m->scene.world.forest) f.request.low_plants_m = config_default().terrain.woods_low_m;
    f.request.view = trial_view(&m->scene, views[view].back_m, views[view].above_m, views[view].hfov_deg * rad_per_deg,
                                m->width, m->height);
    return f;
}

void quality_measure_enlarge(QualityMeasure *m)
{
    if (!m->quick) m->width = timed_width, m->height = timed_height;
}

static double thread_clock_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double quality_measure_time(const QualityMeasure *m, QualitySettings settings, bool wall)
{
    double s = 0;
    for (int v = 0; v < timed_count; v++) {
        TrialFrame   f = quality_measure_frame(m, timed[v], settings);
        const double start_s = wall ? wall_clock_s() : thread_clock_s();
        trial_frame(&f);
        s += f.status == STATUS_OK ? (wall ? wall_clock_s() : thread_clock_s()) - start_s : NAN;
    }
    return s / (1e-6 * timed_count * m->width * m->height);
}

/* ---- this machine's speed ------------------------------------------------------------------------------ */

Status quality_machine_factor(double *factor, const char *table_path, int threads)
{
    QualityMeasure m;
    QualityTable   table;
    char           text[32];
    Status         status = quality_open(&table, table_path);
    if (status != STATUS_OK) return status;
    const QualityRow *first = &table.row[0];
    if (first->scene == QUALITY_WOODS || first->samples != quality_quickest.samples ||
        first->edge_samples != quality_quickest.edge_samples ||
        first->target_samples != quality_quickest.target_samples) {
        log_error(
            "quality: %s: its first row is not samples 1 without edge_samples on bare ground, by which machines are compared; give "
            "quality.machine_factor",
            table_path);
        return STATUS_BAD_VALUE;
    }
    /* finds the fastest settings by the wall clock, from the best of five */
    status = quality_measure_open(&m, threads, false);
    quality_measure_enlarge(&m);
    double best_s = INFINITY;
    for (int n = 0; n < 5 && status == STATUS_OK; n++) {
        const double s = quality_measure_time(&m, quality_quickest, true);
        if (isnan(s)) status = STATUS_NO_MEMORY;
        best_s = fmin(best_s, s);
    }
    if (status == STATUS_OK) {
        /* rounded as it is written, so that giving it again gives the same value */
        snprintf(text, sizeof text, "%.2g", 1e3 * best_s / first->ms_megapixel);
        if (!text_to_double(factor, text)) status = STATUS_BAD_VALUE;
        *factor = clamp(*factor, 0.001, 1000);
    }
    quality_measure_close(&m);
    return status;
}
