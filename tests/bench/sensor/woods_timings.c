/* tests/bench/sensor/woods_timings.c: the time of frames among plants: one ray a pixel, default quality, the stages. */
#include "tests/bench/sensor/woods_private.h"

static double rays_of(const Picture *p)
{
    const VisibilityCounters *v = &p->counters.visibility;
    return (double)p->counters.rays_primary + (double)v->rays_sun_ground;
}

static double plant_share(const Picture *p)
{
    double       met = 0;
    const size_t count = (size_t)p->width * (size_t)p->height;
    for (size_t i = 0; i < count; i++) met += p->instance && p->instance[i] != 0;
    return 100 * met / (double)count;
}

/* Returns 1 if one thread, with nothing skipped, gives other planes. */
static double differs(WoodsBench *w, const WoodsFrame *many)
{
    WoodsFrame one = *many;
    char       hash[2][sha256_text_size];
    one.frame.pool = w->one;
    one.frame.arena = w->arena[1];
    one.frame.request.skips_off = skips_all_off;
    woods_render(&one);
    if (one.frame.status != STATUS_OK || trial_frame_hash(hash[0], &one.frame) != STATUS_OK ||
        trial_frame_hash(hash[1], &many->frame) != STATUS_OK)
        return NAN;
    return strcmp(hash[0], hash[1]) != 0;
}

static Status time_view(WoodsBench *w, int v)
{
    const RenderRequest request = woods_request(w, v, 1);
    const int           rounds = bench_quick(w->bench) ? 2 : 5;
    WoodsFrame          frame[woods_details];
    BenchTime           time[woods_details] = {{.rounds = rounds}, {.rounds = rounds}}, cores[woods_details];
    char                what[what_size];
    bench_progress(w->bench, woods_pose[v].name);
    for (int k = 0; k < woods_details; k++) frame[k] = woods_frame(w, k, &request, w->many, w->arena[0]);
    memcpy(cores, time, sizeof cores);
    for (int r = -1; r < rounds; r++) /* in turn; the first is to warm up */
        for (int k = 0; k < woods_details; k++) {
            const double start_s = wall_clock_s(), busy_s = woods_processor_s();
            woods_render(&frame[k]);
            if (r < 0) continue;
            time[k].item_s[r] = wall_clock_s() - start_s;
            cores[k].item_s[r] = (woods_processor_s() - busy_s) / pool_threads(w->many);
        }
    for (int k = 0; k < woods_details; k++) bench_time_finish(&time[k]), bench_time_finish(&cores[k]);
    for (int k = 0; k < woods_details; k++) {
        woods_render(&frame[k]);
        if (frame[k].frame.status != STATUS_OK) return frame[k].frame.status;
        const Picture *p = &frame[k].frame.picture;
        snprintf(what, sizeof what, "%s: one ray a pixel, %s", woods_pose[v].name, woods_detail[k]);
        BenchRow row = bench_row_of(what, &time[k], "M rays/s", 1e6 / rays_of(p));
        row.ratio = k ? bench_ratio(&time[1], &time[0]) : NAN;
        row.to = k ? woods_detail[0] : NULL;
        row.error = differs(w, &frame[k]);
        row.error_limit = 0;
        row.error_unit = "differ";
        row.against = "planes of one thread, nothing skipped";
        bench_add(w->bench, &row);
        snprintf(what, sizeof what, "%s: time of processors over threads, %s", woods_pose[v].name, woods_detail[k]);
        row = bench_row_of(what, &cores[k], NULL, 1);
        bench_add(w->bench, &row);
        if (k > 0) continue;
        snprintf(what, sizeof what, "%s: plants' boxes that a ray enters", woods_pose[v].name);
        woods_say(w, what, (double)p->counters.visibility.rays_plants / (double)p->counters.rays_primary, "");
        snprintf(what, sizeof what, "%s: pixels of plants", woods_pose[v].name);
        woods_say(w, what, plant_share(p), "%");
    }
    return STATUS_OK;
}

/* Times frames as a node asks for them, with edges, small targets and the estimate of their error, in turn with one ray
 * a pixel in full detail. Bits are compared elsewhere, with one ray a pixel and by the tests. */
static Status time_default(WoodsBench *w, int v)
{
    enum { kinds = woods_details + 1 }; /* the last: one ray */
    const View          view = woods_view(w, v);
    const RenderRequest as_node =
        trial_default_request(&w->scene, &view, woods_pose[v].above_m / sin(woods_pose[v].down_deg * rad_per_deg));
    const RenderRequest one = woods_request(w, v, 1);
    const int           rounds = bench_quick(w->bench) ? 1 : 3;
    BenchTime           time[kinds] = {{.rounds = rounds}, {.rounds = rounds}, {.rounds = rounds}};
    char                what[what_size];
    double              refined = 0;
    for (int r = 0; r < rounds; r++)
        for (int k = 0; k < kinds; k++) {
            WoodsFrame f =
                woods_frame(w, k < woods_details ? k : 0, k < woods_details ? &as_node : &one, w->many, w->arena[0]);
            const double start_s = wall_clock_s();
            woods_render(&f);
            if (f.frame.status != STATUS_OK) return f.frame.status;
            time[k].item_s[r] = wall_clock_s() - start_s;
            if (k == 0) refined = (double)f.frame.picture.counters.pixels_refined;
        }
    for (int k = 0; k < kinds; k++) bench_time_finish(&time[k]);
    for (int k = 0; k < woods_details; k++) {
        snprintf(what, sizeof what, "%s: default quality, %s", woods_pose[v].name, woods_detail[k]);
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        row.ratio = bench_ratio(&time[k], k ? &time[0] : &time[woods_details]);
        row.to = k ? woods_detail[0] : "one ray a pixel";
        bench_add(w->bench, &row);
    }
    snprintf(what, sizeof what, "%s: default quality: pixels sampled again", woods_pose[v].name);
    woods_say(w, what, 100 * refined / ((double)w->width * w->height), "%");
    return STATUS_OK;
}

Status woods_timings(WoodsBench *w, int v)
{
    const Status status = time_view(w, v);
    return status == STATUS_OK ? time_default(w, v) : status;
}

/* Times the stages on one thread, where they add up. */
Status woods_stages(WoodsBench *w, int v)
{
    static const struct {
        TrialStage  stage;
        const char *name;
    } stages[] = {{STAGE_PREPARE, "prepare, low plants"},
                  {STAGE_VISIBILITY, "first hits"},
                  {STAGE_SUN, "sun rays"},
                  {STAGE_SHADE, "shading"},
                  {STAGE_RADAR, "radar"},
                  {STAGE_REST, "rest"},
                  {STAGE_TRUTH, "truth of targets"}};
    enum { rounds = 3 };
    const RenderRequest request = woods_request(w, v, 1);
    WoodsFrame          f = woods_frame(w, 0, &request, w->one, w->arena[1]);
    BenchTime           time[TRIAL_STAGE_COUNT] = {0};
    for (int r = 0; r < rounds; r++) {
        woods_render(&f);
        if (f.frame.status != STATUS_OK) return f.frame.status;
        for (int s = 0; s < TRIAL_STAGE_COUNT; s++) time[s].item_s[r] = f.frame.stage_s[s], time[s].rounds = rounds;
    }
    for (int s = 0; s < TRIAL_STAGE_COUNT; s++) bench_time_finish(&time[s]);
    for (size_t k = 0; k < sizeof stages / sizeof *stages; k++) {
        char what[what_size];
        snprintf(what, sizeof what, "%s: 1 thread: %s", woods_pose[v].name, stages[k].name);
        if (!(time[stages[k].stage].best_s > 0)) continue;
        BenchRow row = bench_row_of(what, &time[stages[k].stage], NULL, 1);
        row.ratio = bench_ratio(&time[stages[k].stage], &time[STAGE_FRAME]);
        row.to = "frame";
        bench_add(w->bench, &row);
    }
    return STATUS_OK;
}
