/* tests/bench/sensor/woods_flight.c: a flight of 20 s at 250 m/s down to an impact among the plants: what a plant's
 * change of representation adds to the change from frame to frame, and whether some frames take longer than others.
 *
 * Twice a second two frames are rendered, 1/25 s apart, each in full detail (F, then F') and in the representation that
 * is judged (T, T'); sun, plants and ground stand still. A plant that reaches its full detail in between changes from T
 * to F', where full detail changes from F to F'. Few do in one step; so all pixels are taken of plants that are nearly
 * as high in the picture as those that change. With means of squares over them, the share of the change that full
 * detail does not have is 1 - <(F' - F)^2> / <(F' - T)^2>. 0: none; 50 %: the jump is as large as the change by motion
 * and sampling that full detail has anyway; below 0: the judged representation is smoother, and hides some of that.
 *
 * Flown by tables, and once more with terrain.woods_tables: off, whose plants change from sprays to leaves of their
 * size. */
#include "tests/bench/sensor/woods_private.h"

enum { frames_most = 40, block_px = 4, least_px = 8 /* of a block's 16 */ };
static const double speed_mps = 250, step_s = 0.04, down_rad = 15 * rad_per_deg, hfov_rad = 20 * rad_per_deg;
static const double flight_m = 5000, quick_m = 800; /* to the impact */
static const double nearly = 0.75;                  /* of the height at which plants change */

/* Columns of a frame's sums: of plants that are about to change and of the whole picture, pixels and blocks. */
typedef enum FlightSum {
    CHANGE_FULL,                     /* (F' - F)^2 of plants about to change: pixels, blocks */
    CHANGE_JUDGED = CHANGE_FULL + 2, /* (F' - T)^2 */
    ALL_FULL = CHANGE_JUDGED + 2,    /* (F' - F)^2 of all pixels */
    ALL_JUDGED = ALL_FULL + 2,       /* (T' - T)^2 */
    PIXELS = ALL_JUDGED + 2,
    FLIGHT_SUMS
} FlightSum;

typedef struct Flight {
    WoodsBench *w;
    const char *name;      /* of what is judged */
    double      change_px; /* height in the picture just below which every plant is in that representation */
    double      hfov_rad;
    int         width, height, frames, counted; /* counted: frames so far */
    double      sum[woods_bands][frames_most][FLIGHT_SUMS];
    double      cpu_s[woods_details][frames_most];
    Arena      *arena[2][woods_details]; /* of first and second frames */
    WoodsFrame  frame[2][woods_details];
} Flight;

static View view_at(const Flight *f, double range_m)
{
    const double d_enu[3] = {0, cos(down_rad), -sin(down_rad)};
    View         view = {.width = f->width, .height = f->height, .focal_px = view_focal_px(f->width, f->hfov_rad)};
    for (int c = 0; c < 3; c++) view.p_enu[c] = -range_m * d_enu[c];
    view.p_enu[2] += elevation_height(&f->w->landscape.elevation, 0, 0, NULL) + 1;
    view_upright(view.r_enu_from_cam, d_enu);
    return view;
}

/* Pixels of plants that are nearly as high as those that change. */
static void find_changing(uint8_t *changing, const Flight *f)
{
    const WoodsFrame *first = &f->frame[0][0];
    const Picture    *p = &first->frame.picture;
    const double      change_px = f->change_px, focal_px = first->frame.request.view.focal_px;
    for (int i = 0; i < f->width * f->height; i++) {
        changing[i] = 0;
        if (!woods_is_standing(p->instance[i])) continue;
        const double px = plant_height_m(&f->w->woods.plant[p->instance[i] - 1]) * focal_px / (double)p->range_m[i];
        changing[i] = px >= nearly * change_px && px < change_px;
    }
}

void woods_add_squares(double sum[2], const float *a, const float *b, const uint8_t *of, int width, int height)
{
    for (int y = 0; y + block_px <= height; y += block_px)
        for (int x = 0; x + block_px <= width; x += block_px) {
            double off = 0, n = 0;
            for (int i = 0; i < block_px * block_px; i++) {
                const size_t at = (size_t)(y + i / block_px) * (size_t)width + (size_t)(x + i % block_px);
                if (of && !of[at]) continue;
                const double d = (double)b[at] - (double)a[at];
                sum[0] += d * d, off += d, n++;
            }
            if (n >= least_px) sum[1] += off * off / (n * n);
        }
}

static void add_frame(Flight *f, const uint8_t *changing)
{
    for (int b = 0; b < woods_bands; b++) {
        const float *at[2][woods_details];
        double      *sum = f->sum[b][f->counted];
        for (int k = 0; k < 2 * woods_details; k++)
            at[k / woods_details][k % woods_details] =
                picture_plane(&f->frame[k / woods_details][k % woods_details].frame.picture, woods_band_plane[b]);
        woods_add_squares(&sum[CHANGE_FULL], at[0][0], at[1][0], changing, f->width, f->height);
        woods_add_squares(&sum[CHANGE_JUDGED], at[0][1], at[1][0], changing, f->width, f->height);
        woods_add_squares(&sum[ALL_FULL], at[0][0], at[1][0], NULL, f->width, f->height);
        woods_add_squares(&sum[ALL_JUDGED], at[0][1], at[1][1], NULL, f->width, f->height);
        for (int i = 0; i < f->width * f->height; i++) sum[PIXELS] += changing[i];
    }
    f->counted++;
}

static Status fly(Flight *f)
{
    const double start_m = bench_quick(f->w->bench) ? quick_m : flight_m;
    uint8_t     *changing = arena_alloc(f->w->arena[0], (size_t)(f->width * f->height), sizeof *changing);
    if (!changing) return STATUS_NO_MEMORY;
    for (int n = 0; n < f->frames; n++) {
        for (int k = 0; k < 2 * woods_details; k++) {
            const int     later = k / woods_details, d = k % woods_details;
            WoodsFrame   *frame = &f->frame[later][d];
            RenderRequest request = woods_request(f->w, 0, 1);
            request.bands &= three_bands;
            request.view = view_at(f, start_m * (f->frames - n) / f->frames - later * step_s * speed_mps);
            *frame = woods_frame(f->w, d, &request, f->w->many, f->arena[later][d]);
            const double busy_s = woods_processor_s();
            woods_render(frame);
            if (!later) f->cpu_s[d][n] = woods_processor_s() - busy_s;
            if (frame->frame.status != STATUS_OK) return frame->frame.status;
        }
        find_changing(changing, f);
        add_frame(f, changing);
    }
    return STATUS_OK;
}

/* ---- rows ----------------------------------------------------------------------------------------- */

typedef struct Change {
    const double *of;
    int           frames, sum; /* sum: FlightSum of full detail; the judged one is two columns later */
    bool          share;       /* else the ratio of roots less 1 */
} Change;

static double change_of(const void *user, int without)
{
    const Change *c = user;
    double        s[FLIGHT_SUMS];
    group_sums(s, c->of, c->frames, FLIGHT_SUMS, without);
    const double full = s[c->sum], judged = s[c->sum + 2];
    return 100 * (c->share ? 1 - full / judged : sqrt(judged / full) - 1);
}

static void judge_changes(const Flight *f)
{
    static const char *const scale[2] = {"pixels", "blocks of 4 px"};
    char                     what[what_size], text[160];
    for (int b = 0; b < woods_bands; b++)
        for (int k = 0; k < 2; k++) {
            Change change = {f->sum[b][0], f->frames, CHANGE_FULL + k, true};
            Change all = {f->sum[b][0], f->frames, ALL_FULL + k, false};
            double pixels = 0, frames = 0;
            for (int n = 0; n < f->frames; n++) pixels += f->sum[b][n][PIXELS], frames += f->sum[b][n][PIXELS] > 0;
            snprintf(what, sizeof what, "flight: %s, %s: change of representation, %s", f->name,
                     woods_plane[woods_band_plane[b]], scale[k]);
            snprintf(text, sizeof text, "share of the plants' change that full detail has not; %g pixels in %g frames",
                     pixels, frames);
            woods_judge(f->w, what, group_estimate(change_of, &change, f->frames), (WoodsLimit){50, "%", true}, text);
            snprintf(what, sizeof what, "flight: %s, %s: change from frame to frame, %s", f->name,
                     woods_plane[woods_band_plane[b]], scale[k]);
            woods_judge(f->w, what, group_estimate(change_of, &all, f->frames), (WoodsLimit){NAN, "%", true},
                        "rms beyond that of full detail, 1/25 s apart, all of the picture");
        }
}

/* Tables fill as they are asked for, most of them in the first frame. */
static void say_times(const Flight *f)
{
    for (int d = 0; d < woods_details; d++) {
        BenchTime time = {.rounds = f->frames};
        double    slowest_s = 0;
        char      what[what_size];
        for (int n = 0; n < f->frames; n++) {
            time.item_s[n] = f->cpu_s[d][n];
            if (n > 0) slowest_s = fmax(slowest_s, f->cpu_s[d][n]);
        }
        bench_time_finish(&time);
        snprintf(what, sizeof what, "flight: a frame's processor time, %s", woods_detail[d]);
        const BenchRow row = bench_row_of(what, &time, NULL, 1);
        bench_add(f->w->bench, &row);
        snprintf(what, sizeof what, "flight: first frame over the median, %s", woods_detail[d]);
        woods_say(f->w, what, f->cpu_s[d][0] / time.median_s, "x");
        snprintf(what, sizeof what, "flight: slowest frame over the median, %s", woods_detail[d]);
        woods_judge(f->w, what, (Estimate){slowest_s / time.median_s, NAN}, (WoodsLimit){d ? 2 : NAN, "x", false},
                    "processor time, the first one apart");
    }
}

static Status fly_and_judge(WoodsBench *w, const char *name, double change_px, bool timed)
{
    const bool quick = bench_quick(w->bench);
    Flight     f = {.w = w, .name = name, .change_px = change_px};
    Status     status = STATUS_OK;
    f.width = quick ? 72 : 360, f.height = quick ? 48 : 243, f.frames = quick ? 4 : frames_most;
    f.hfov_rad = quick ? 0.6 * hfov_rad : hfov_rad; /* so that some plants change their representation */
    bench_progress(w->bench, "flight");
    arena_reset(w->arena[0]);
    for (int k = 0; k < 2 * woods_details && status == STATUS_OK; k++)
        if (!(f.arena[k / woods_details][k % woods_details] = arena_create())) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = fly(&f);
    if (status == STATUS_OK) {
        judge_changes(&f);
        if (timed) say_times(&f);
    }
    for (int k = 0; k < 2 * woods_details; k++) arena_destroy(f.arena[k / woods_details][k % woods_details]);
    return status;
}

/* By tables that nothing has been asked of before; then by leaves. */
Status woods_flight(WoodsBench *w)
{
    const ForestConfig tables = forest_config(w->forest[1]), leaves = {.leaves = true, .fine = true};
    const bool         quick = bench_quick(w->bench);
    Status             status = quick ? STATUS_OK : woods_replace(w, 1, &tables);
    if (status == STATUS_OK) status = fly_and_judge(w, woods_detail[1], forest_table_px[0], true);
    if (status == STATUS_OK && !quick) status = woods_replace(w, 1, &leaves);
    if (status == STATUS_OK && !quick) status = fly_and_judge(w, "leaves of their size", forest_fine_px[0], false);
    return status;
}
