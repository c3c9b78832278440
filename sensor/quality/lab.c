/* sensor/quality/lab.c: the scenes in which sampling settings are measured. Times are those of two of the views. */
#include "sensor/quality/lab.h"

#include "sensor/settings/config.h"
#include "terrain/landscape/quick_landscape.h"

#include <time.h>

enum { vehicles = 20, timed_width = 360, timed_height = 240 };

static const struct {
    double back_m, above_m, hfov_deg;
} views[quality_lab_views] = {{60, 12, 40},   {150, 30, 40}, {300, 40, 20},   {300, 8, 30},
                              {600, 100, 40}, {900, 60, 8},  {1500, 300, 20}};
static const int timed[] = {2, 6};
enum { timed_count = sizeof timed / sizeof *timed };

Status quality_lab_open(QualityLab *lab, int threads, bool quick)
{
    static const DisEntityType types[] = {{1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 2, 1, 0, 0}, {1, 1, 222, 28, 1, 0, 0}};
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    LocalFrame     frame;
    double         times_s[2];
    char           catalog[512];
    *lab = (QualityLab){.width = quick ? 32 : 120, .height = quick ? 24 : 80, .quick = quick};
    Status status = pool_create(&lab->pool, threads);
    if (status == STATUS_OK) status = pool_create(&lab->many, thread_processors());
    if (status == STATUS_OK) status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = quick_landscape_create(&lab->ground, times_s, &frame, quality_lab_east_m,
                                                                 quality_lab_north_m, lab->many);
    if (status == STATUS_OK && !etc_path(catalog, sizeof catalog, "catalog.csv")) status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = trial_scene_open(&lab->scene, &lab->ground, catalog, types, 3, vehicles);
    lab->arena           = arena_create();
    lab->reference_arena = arena_create();
    return status == STATUS_OK && !(lab->arena && lab->reference_arena) ? STATUS_NO_MEMORY : status;
}

void quality_lab_close(QualityLab *lab)
{
    trial_scene_close(&lab->scene);
    landscape_destroy(&lab->ground);
    arena_destroy(lab->arena);
    arena_destroy(lab->reference_arena);
    pool_destroy(lab->many);
    pool_destroy(lab->pool);
}

TrialFrame quality_lab_frame(const QualityLab *lab, int view, QualitySettings settings)
{
    TrialFrame f = {.scene = &lab->scene, .pool = lab->pool, .arena = lab->arena};
    f.request = (RenderRequest){.bands = 7,
                                .truth = true,
                                .optical = OPTICAL_RGB,
                                .samples = settings.samples,
                                .edge_samples = settings.edge_samples,
                                .target_samples = settings.target_samples,
                                .sky_visibility = true,
                                .hidden_entity = -1};
    if (lab->scene.world.forest) f.request.low_plants_m = config_default().terrain.woods_low_m;
    f.request.view = trial_view(&lab->scene, views[view].back_m, views[view].above_m,
                                views[view].hfov_deg * rad_per_deg, lab->width, lab->height);
    return f;
}

void quality_lab_enlarge(QualityLab *lab)
{
    if (!lab->quick) lab->width = timed_width, lab->height = timed_height;
}

static double thread_clock_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double quality_lab_time(const QualityLab *lab, QualitySettings settings, bool wall)
{
    double s = 0;
    for (int v = 0; v < timed_count; v++) {
        TrialFrame   f = quality_lab_frame(lab, timed[v], settings);
        const double start_s = wall ? wall_clock_s() : thread_clock_s();
        trial_frame(&f);
        s += f.status == STATUS_OK ? (wall ? wall_clock_s() : thread_clock_s()) - start_s : NAN;
    }
    return s / (1e-6 * timed_count * lab->width * lab->height);
}
