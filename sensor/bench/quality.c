/* sensor/bench/quality.c: each row of settings in each scene against 16 x 16 rays in every pixel. A row's error is that
 * of its worst scene. Its time is of two of the scenes in larger pictures (small targets cost the same in any), on one
 * thread, rows in turn, the best of the rounds: the thread's own, which another program on the machine does not
 * lengthen. */
#include "sensor/bench/quality.h"

#include "sensor/bench/scene.h"
#include "sensor/settings/quality.h"
#include "sensor/bench/quick_landscape.h"

#include <time.h>

enum { vehicles = 20, rounds_most = 2, timed_width = 360, timed_height = 240 };

static const struct {
    double back_m, above_m, hfov_deg;
} views[] = {{60, 12, 40}, {150, 30, 40}, {300, 40, 20}, {300, 8, 30}, {600, 100, 40}, {900, 60, 8}, {1500, 300, 20}};
enum { view_count = sizeof views / sizeof *views };
static const int timed[] = {2, 6};
enum { timed_count = sizeof timed / sizeof *timed };

/* samples, edge_samples, target_samples; the first is the quickest, by which machines are compared. */
static const int grid[][3] = {{1, 0, 0},   {1, 2, 8},    {1, 2, 24}, {1, 4, 24},  {1, 4, 48}, {1, 8, 64},
                              {2, 0, 0},   {2, 4, 48},   {2, 8, 64}, {3, 6, 64},  {3, 9, 96}, {4, 8, 96},
                              {5, 10, 96}, {6, 12, 128}, {8, 0, 0},  {8, 16, 128}};
enum { grid_count = sizeof grid / sizeof *grid };

typedef struct Lab {
    Landscape  ground;
    BenchScene scene;
    Pool      *pool, *many;
    Arena     *arena, *reference_arena;
    int        width, height;
    bool       quick;
} Lab;

static Status open_lab(Lab *lab, int threads, bool quick)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}, {1, 1, 222, 28, 1, 0, 0}};
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    LocalFrame     frame;
    double         times_s[2];
    char           catalog[512];
    *lab = (Lab){.width = quick ? 32 : 120, .height = quick ? 24 : 80, .quick = quick};
    Status status = pool_create(&lab->pool, threads);
    if (status == STATUS_OK) status = pool_create(&lab->many, thread_processors());
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = bench_ground_create(&lab->ground, times_s, &frame, 2000, 4000, lab->many);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = bench_scene_open(&lab->scene, &lab->ground, catalog, types, 3, vehicles);
    lab->arena           = arena_create();
    lab->reference_arena = arena_create();
    return status == STATUS_OK && !(lab->arena && lab->reference_arena) ? STATUS_NO_MEMORY : status;
}

static void close_lab(Lab *lab)
{
    bench_scene_close(&lab->scene);
    landscape_destroy(&lab->ground);
    arena_destroy(lab->arena);
    arena_destroy(lab->reference_arena);
    pool_destroy(lab->many);
    pool_destroy(lab->pool);
}

static BenchFrame frame_of(const Lab *lab, int view, int samples, int edge_samples, int target_samples)
{
    BenchFrame f = {.scene = &lab->scene, .pool = lab->pool, .arena = lab->arena};
    f.request = (RenderRequest){.bands = 7,
                                .truth = true,
                                .optical = OPTICAL_RGB,
                                .samples = samples,
                                .edge_samples = edge_samples,
                                .target_samples = target_samples, .sky_visibility = true,
                                .hidden_entity = -1};
    f.request.view = bench_view(&lab->scene, views[view].back_m, views[view].above_m,
                                views[view].hfov_deg * rad_per_deg, lab->width, lab->height);
    return f;
}

/* Of one picture, percent and kelvin a band. */
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

static Status measure_errors(QualityTable *table, Lab *lab, Bench *bench)
{
    for (int v = 0; v < view_count; v += lab->quick ? 3 : 1) {
        char what[64];
        snprintf(what, sizeof what, "errors, view %d of %d", v + 1, view_count);
        bench_progress(bench, what);
        BenchFrame fine = frame_of(lab, v, 16, 0, 0);
        fine.pool  = lab->many;
        fine.arena = lab->reference_arena;
        bench_frame(&fine);
        for (int k = 0; k < grid_count && fine.status == STATUS_OK; k++) {
            BenchFrame  f = frame_of(lab, v, grid[k][0], grid[k][1], grid[k][2]);
            double      percent[quality_bands], kelvin[quality_bands];
            QualityRow *r = &table->row[k];
            f.pool = lab->many;
            bench_frame(&f);
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

static double thread_clock_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* One row over the views that are timed, once, by the thread's own clock or the wall's: s. NaN: a frame failed. */
static double time_row(const Lab *lab, int k, bool wall)
{
    double s = 0;
    for (int v = 0; v < timed_count; v++) {
        BenchFrame   f = frame_of(lab, timed[v], grid[k][0], grid[k][1], grid[k][2]);
        const double start_s = wall ? wall_clock_s() : thread_clock_s();
        bench_frame(&f);
        s += f.status == STATUS_OK ? (wall ? wall_clock_s() : thread_clock_s()) - start_s : NAN;
    }
    return s;
}

static double megapixels(const Lab *lab) { return 1e-6 * timed_count * lab->width * lab->height; }

static void time_larger(Lab *lab)
{
    if (!lab->quick) lab->width = timed_width, lab->height = timed_height;
}

/* Those that some target picks are marked, as a front is. */
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

Status bench_quality(Bench *bench)
{
    Lab          lab;
    QualityTable table = {.count = grid_count};
    BenchTime    time[grid_count] = {0};
    const char  *path = bench_option(bench, "table");
    bench_progress(bench, "ground and vehicles");
    Status status = open_lab(&lab, 1, bench_quick(bench));
    for (int k = 0; k < grid_count; k++)
        table.row[k] = (QualityRow){.samples = grid[k][0], .edge_samples = grid[k][1], .target_samples = grid[k][2]};
    if (status == STATUS_OK) status = measure_errors(&table, &lab, bench);
    const int rounds = lab.quick ? 1 : rounds_most;
    time_larger(&lab);
    for (int n = 0; n < rounds && status == STATUS_OK; n++)
        for (int k = 0; k < grid_count; k++) {
            char what[64];
            snprintf(what, sizeof what, "times, round %d of %d", n + 1, rounds);
            bench_progress(bench, what);
            time[k].item_s[n] = time_row(&lab, k, false) / megapixels(&lab);
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
    close_lab(&lab);
    return status;
}

Status bench_machine_factor(double *factor, const char *table_path, int threads)
{
    Lab          lab;
    QualityTable table;
    char         text[32];
    Status       status = quality_open(&table, table_path);
    if (status != STATUS_OK) return status;
    const QualityRow *first = &table.row[0];
    if (first->samples != grid[0][0] || first->edge_samples != grid[0][1] || first->target_samples != grid[0][2]) {
        log_error(
            "quality: %s: its first row is not samples 1 without edge_samples, by which machines are compared; give "
            "quality.machine_factor",
            table_path);
        return STATUS_BAD_VALUE;
    }
    status = open_lab(&lab, threads, false);
    time_larger(&lab);
    double best_s = INFINITY;
    for (int n = 0; n < 5 && status == STATUS_OK; n++) {
        const double s = time_row(&lab, 0, true);
        if (isnan(s)) status = STATUS_NO_MEMORY;
        best_s = fmin(best_s, s);
    }
    if (status == STATUS_OK) {
        /* as it is written, so that who gives it again has the same */
        snprintf(text, sizeof text, "%.2g", 1e3 * best_s / megapixels(&lab) / first->ms_megapixel);
        if (!text_to_double(factor, text)) status = STATUS_BAD_VALUE;
        *factor = clamp(*factor, 0.001, 1000);
    }
    close_lab(&lab);
    return status;
}
