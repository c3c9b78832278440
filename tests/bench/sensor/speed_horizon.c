/* tests/bench/sensor/speed_horizon.c: what lines of sight that bend cost, low over the sea and from high, and the Earth
 * beyond the terrain's outline. */
#include "tests/bench/sensor/speed_private.h"
#include "tests/scenes/ocean.h"

enum { ships = 5, settings = 7 };

static const DisEntityType frigate = {1, 3, 225, 6, 1, 0, 0};

typedef struct SeaView {
    const char *what;
    double      eye_m, down_rad, hfov_rad;
    bool        bent;
    int         to; /* the setting that it is compared with; -1: none */
} SeaView;

static const SeaView views[settings] = {
    {"sea: frame from 20 m, level, rays straight", 20, 0.002, 0.17, false, -1},
    {"sea: frame from 20 m, level, rays bend", 20, 0.002, 0.17, true, 0},
    {"sea: frame from 10 km, level, rays straight", 10e3, 0.056, 0.17, false, -1},
    {"sea: frame from 10 km, level, rays bend", 10e3, 0.056, 0.17, true, 2},
    {"beyond: frame from 99 km, all of it within the outline", 99e3, 1.2, 0.3, true, -1},
    {"beyond: frame from 14 km, the horizon", 14e3, 0.066, 0.3, true, 4},
    {"beyond: frame from 99 km, the horizon", 99e3, 0.17, 0.3, true, 4},
};
static const char *const compared[settings] = {
    [1] = "straight rays", [3] = "straight rays", [5] = "within the outline", [6] = "within the outline"};

static RenderRequest sea_request(const Speed *s, const SeaView *of)
{
    const double d_enu[3] = {0, cos(of->down_rad), -sin(of->down_rad)};
    View         view = {.p_enu = {0, 0, of->eye_m},
                         .width = s->width,
                         .height = s->height,
                         .focal_px = view_focal_px(s->width, of->hfov_rad)};
    view_upright(view.r_enu_from_cam, d_enu);
    RenderRequest request = speed_request(&view, three_bands, true);
    request.refraction = of->bent;
    return request;
}

/* Frigates 4 to 20 km away, the last beyond the horizon of 20 m. */
static Status open_sea(Speed *s)
{
    const Geodetic origin = {34.4 * rad_per_deg, -108.9 * rad_per_deg, 0};
    char           catalog[512];
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = ocean_create(&s->landscape, &s->frame, &origin);
    if (status == STATUS_OK) status = trial_scene_open(&s->scene, &s->landscape, catalog, &frigate, 1, 0);
    for (int k = 0; k < ships && status == STATUS_OK; k++) {
        const TrialPlace place = {.type = frigate,
                                  .number = k + 1,
                                  .east_m = 150.0 * (k - 2),
                                  .north_m = 4000.0 * (k + 1),
                                  .turn_rad = 0.8 * k,
                                  .appearance = 1u << 22};
        status = trial_scene_place(&s->scene, &place);
    }
    return status;
}

static Status time_sea(Speed *s)
{
    TrialFrame frame[settings];
    BenchWork  work[settings];
    BenchTime  time[settings];
    char       what[what_size];
    bench_progress(s->bench, "sea");
    for (int k = 0; k < settings; k++) {
        const RenderRequest request = sea_request(s, &views[k]);
        frame[k] = speed_frame(s, &s->scene, &request, true);
        work[k] = (BenchWork){trial_frame, &frame[k], 1};
    }
    bench_time(time, s->bench, work, settings);
    for (int k = 0; k < settings; k++) {
        snprintf(what, sizeof what, "%s, %s", views[k].what, all_threads);
        BenchRow row = bench_row_of(what, &time[k], "frames/s", 1);
        if (views[k].to >= 0) row.ratio = bench_ratio(&time[k], &time[views[k].to]), row.to = compared[k];
        trial_frame(&frame[k]); /* frames share an arena */
        if (frame[k].status != STATUS_OK) return frame[k].status;
        speed_judge_bits(&row, s, &frame[k]);
        bench_add(s->bench, &row);
    }
    return STATUS_OK;
}

Status bench_speed_horizon(Bench *bench)
{
    if (!speed_wants(bench, "optical")) return STATUS_OK;
    static Speed s; /* its scene is pointed to */
    s = (Speed){.bench = bench};
    Status status = speed_open(&s);
    if (status == STATUS_OK) status = open_sea(&s);
    if (status == STATUS_OK) status = time_sea(&s);
    if (status != STATUS_OK) log_error("bench: speed: sea: %s", status_name(status));
    speed_close(&s);
    return status;
}
