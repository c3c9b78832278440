/* tests/bench/terrain/precision_land.c: the ground as posts, and the weakest octave of its detail. */
#include "tests/bench/suites.h"

#include "terrain/detail/detail.h"
#include "terrain/ground/landscape.h"
#include "tests/bench/bench.h"

#include <stdlib.h>

/* ---- synthetic terrain ---------------------------------------------------------------------------- */

typedef struct MakeSet {
    LandscapeConfig   config;
    const LocalFrame *frame;
    Status            status;
} MakeSet;

static void make_land(void *user)
{
    MakeSet  *s = user;
    Landscape landscape = {0};
    s->status = landscape_create(&landscape, &s->config, s->frame, NULL, 0, NULL, 0);
    bench_keep(&landscape);
    if (s->status == STATUS_OK) landscape_destroy(&landscape);
}

/* Rms difference in height within a ring about the origin. */
static double rms_m(const Elevation *got, const Elevation *want, double from_m, double to_m)
{
    enum { places = 20000 };
    double square = 0;
    for (int i = 0; i < places; i++) {
        const double r = from_m + (to_m - from_m) * random_uniform(41, 0, 0, (uint64_t)i),
                     a = 2 * pi_rad * random_uniform(41, 1, 0, (uint64_t)i);
        const double off =
            elevation_height(got, r * cos(a), r * sin(a), NULL) - elevation_height(want, r * cos(a), r * sin(a), NULL);
        square += off * off;
    }
    return sqrt(square / places);
}

static double bytes_of(const Elevation *e)
{
    size_t posts, pyramids;
    landscape_quick_bytes(&posts, &pyramids, e);
    return (double)(posts + pyramids);
}

/* Keeps every n-th post of a ground. */
static Status thinned(Elevation *out, const ElevationLevel *from, int step)
{
    const int    nx = (from->nx - 1) / step + 1, ny = (from->ny - 1) / step + 1;
    const Status status = elevation_level_create(
        out, 0, &(ElevationGrid){nx, ny, from->x0_m, from->y0_m, step * from->spacing_m, from->z0_m, from->step_m});
    if (status != STATUS_OK) return status;
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) elevation_set_post(&out->level[0], i, j, elevation_post(from, i * step, j * step));
    elevation_build_pyramids(out);
    return STATUS_OK;
}

/* A landscape of another spacing is another landscape, so one of 1 m is thinned. */
static Status tunable_spacing(Bench *bench, const LocalFrame *frame)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"8 m", "4 m", "2 m", "1 m"};
    static const int         step[settings] = {8, 4, 2, 1};
    const double             half_m = bench_quick(bench) ? 300 : 1000;
    MakeSet                  set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    Landscape                fine = {0};
    LandscapeConfig          config = landscape_default_config();
    config.half_width_m = half_m, config.horizon_m = 4 * half_m, config.spacing_m = 1;
    Status status = landscape_create(&fine, &config, frame, NULL, 0, NULL, 0);
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        Elevation thin = {0};
        config.spacing_m = step[k];
        set[k] = (MakeSet){.config = config, .frame = frame};
        work[k] = (BenchWork){make_land, &set[k], 1};
        status = thinned(&thin, &fine.elevation.level[0], step[k]);
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = status == STATUS_OK ? rms_m(&thin, &fine.elevation, 0, 0.9 * half_m) : NAN,
                                  .is_default = step[k] == 4,
                                  .bytes = bytes_of(&thin)};
        elevation_destroy(&thin);
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"spacing of invented ground", "terrain.spacing_m", "to make the ground", "m",
                                      "rms of height, posts of 1 m", 0.1},
                      work, point, settings);
    landscape_destroy(&fine);
    return status;
}

/* Measures how far the finest level should reach: what a coarser one costs there, over its distance. */
static Status tunable_reach(Bench *bench, const LocalFrame *frame)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"1.5 km", "3 km", "4.5 km", "6 km"};
    static const double      half_m[settings] = {1500, 3000, 4500, 6000};
    const bool               quick = bench_quick(bench);
    MakeSet                  set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    LandscapeConfig          config = landscape_default_config();
    Landscape                fine = {0}, land;
    if (quick) config.spacing_m = 16; /* a quarter as fine: the same levels from four times as far */
    config.half_width_m = 8000;
    Status status = landscape_create(&fine, &config, frame, NULL, 0, NULL, 0);
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        config.half_width_m = half_m[k];
        set[k] = (MakeSet){.config = config, .frame = frame};
        work[k] = (BenchWork){make_land, &set[k], 1};
        status = landscape_create(&land, &config, frame, NULL, 0, NULL, 0);
        if (status != STATUS_OK) break;
        /* just outside the level, where it shows most: 1 / 989 rad is a pixel of 720 across 40 degrees */
        const double near_m = 1.02 * half_m[k], far_m = fmin(1.5 * half_m[k], 7900);
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = rms_m(&land.elevation, &fine.elevation, near_m, far_m) / near_m * 989,
                                  .is_default = half_m[k] == 6000,
                                  .bytes = bytes_of(&land.elevation)};
        landscape_destroy(&land);
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"reach of the finest level", "terrain/invented/invented.c", "to make the ground",
                                      "px",
                                      quick ? "rms just outside it, the finest level; posts of 16 m"
                                            : "rms just outside it, the finest level; 720 px across 40 degrees",
                                      quick ? 0.5 : 0.05},
                      work, point, settings);
    landscape_destroy(&fine);
    return status;
}

/* ---- height of a post ----------------------------------------------------------------------------- */

enum { side_posts = 512 };

typedef struct PostSet {
    double   z0_m, step_m; /* 0: floats */
    uint16_t post[side_posts * side_posts];
    float    narrow[side_posts * side_posts];
    double   at[1024][2], z_m[1024];
} PostSet;

/* Hills of 60 m, without quantisation. */
static double true_height(double x, double y)
{
    return 500 + 30 * sin(x / 97.3) * cos(y / 61.7) + 7 * sin(x / 13.1 + 1) * sin(y / 17.9) +
           0.9 * cos(x / 3.3 - y / 4.1);
}

static void ask_posts(void *user)
{
    PostSet *s = user;
    for (int i = 0; i < 1024; i++) {
        const int    x = (int)s->at[i][0], y = (int)s->at[i][1];
        const double u = s->at[i][0] - x, v = s->at[i][1] - y;
        double       z[4];
        for (int k = 0; k < 4; k++) {
            const int at = (y + k / 2) * side_posts + x + k % 2;
            z[k] = s->step_m > 0 ? s->z0_m + s->step_m * s->post[at] : (double)s->narrow[at];
        }
        s->z_m[i] =
            u >= v ? z[0] + u * (z[1] - z[0]) + v * (z[3] - z[1]) : z[0] + u * (z[3] - z[2]) + v * (z[2] - z[0]);
    }
    bench_keep(s->z_m);
}

static void tunable_posts(Bench *bench)
{
    enum { settings = 5 };
    static const char *const name[settings] = {"steps of 1 m", "steps of 1 / 8 m", "steps of 1 / 64 m",
                                               "steps of 1 / 256 m", "floats"};
    static const double      step_m[settings] = {1, 1 / 8.0, 1 / 64.0, 1 / 256.0, 0};
    static PostSet           set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        PostSet *s = &set[k];
        s->z0_m = 384, s->step_m = step_m[k];
        for (int i = 0; i < side_posts * side_posts; i++) {
            const double z = true_height(i % side_posts, i / side_posts);
            s->narrow[i] = (float)z;
            if (s->step_m > 0) s->post[i] = (uint16_t)((z - s->z0_m) / s->step_m + 0.5);
            const double held = s->step_m > 0 ? s->z0_m + s->step_m * s->post[i] : (double)s->narrow[i];
            bench_worst(&point[k].error, fabs(held - z));
        }
        for (int i = 0; i < 1024; i++)
            for (int c = 0; c < 2; c++)
                s->at[i][c] = (side_posts - 2) * random_uniform(42, (uint32_t)c, 0, (uint64_t)i);
        work[k] = (BenchWork){ask_posts, s, 1024};
        point[k].setting = name[k];
        point[k].is_default = k == 3;
        point[k].bytes = (s->step_m > 0 ? 2.0 : 4.0) * side_posts * side_posts;
    }
    bench_tunable(bench,
                  &(BenchTunable){"height of a post", "terrain/elevation/levels.c", "a height between posts", "m",
                                  "largest, double, hills of 80 m", 0.002},
                  work, point, settings);
}

/* ---- posts of terrain from files -------------------------------------------------------------------- */

enum { mountain_posts = 513, mountain_asks = 4096 };

typedef struct StoreSet {
    Elevation    ground;
    const float *narrow; /* or these */
    double       at[mountain_asks][2], z_m[mountain_asks];
} StoreSet;

/* A mountain of 1.4 km of relief over 2 km of posts 4 m apart; up to some 150 m of relief in a tile of 256 m. */
static double mountain_height(double i, double j)
{
    return 1500 + 600 * sin(i / 170 - 1.4) * cos(j / 240) + 60 * sin(i / 23.3 + 1) * sin(j / 31.9) +
           2 * cos(i / 3.3 - j / 4.1);
}

static void ask_store(void *user)
{
    StoreSet *s = user;
    for (int n = 0; n < mountain_asks; n++) {
        if (!s->narrow) {
            s->z_m[n] = elevation_height(&s->ground, s->at[n][0], s->at[n][1], NULL);
            continue;
        }
        const double x = 0.25 * s->at[n][0], y = 0.25 * s->at[n][1];
        const int    i = (int)x, j = (int)y;
        const float *z = s->narrow + j * mountain_posts + i;
        const double u = x - i, v = y - j, sw = (double)z[0], se = (double)z[1], nw = (double)z[mountain_posts],
                     ne = (double)z[mountain_posts + 1];
        s->z_m[n] = u >= v ? sw + u * (se - sw) + v * (ne - se) : sw + u * (ne - nw) + v * (nw - sw);
    }
    bench_keep(s->z_m);
}

/* Compares one range for all posts, as before tiles, with a step that tiles shift as far as their own heights need. */
static Status tunable_store(Bench *bench)
{
    enum { settings = 6 };
    static const char *const name[settings] = {"one range: 1 / 32 m", "tiles: 1 / 32 m",   "tiles: 1 / 128 m",
                                               "tiles: 1 / 512 m",    "tiles: 1 / 2048 m", "floats"};
    static const double      step_m[settings] = {1 / 32.0, 1 / 32.0, 1 / 128.0, 1 / 512.0, 1 / 2048.0, 0};
    static StoreSet          set[settings];
    static float             narrow[mountain_posts * mountain_posts];
    static int32_t           post[mountain_posts * mountain_posts];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    Status                   status = STATUS_OK;
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        StoreSet *s = &set[k];
        /* with one range, posts are from 0 on; else that of the origin is far below, so that tiles have bases */
        const double z0_m = k == 0 ? 512 : -1024;
        for (int n = 0; n < mountain_posts * mountain_posts; n++) {
            const double z_m = mountain_height(n % mountain_posts, n / mountain_posts);
            narrow[n] = (float)z_m;
            if (step_m[k] > 0) post[n] = (int32_t)floor((z_m - z0_m) / step_m[k] + 0.5);
        }
        if (step_m[k] > 0) {
            status = elevation_level_create(&s->ground, 0,
                                            &(ElevationGrid){mountain_posts, mountain_posts, 0, 0, 4, z0_m, step_m[k]});
            if (status == STATUS_OK) status = elevation_fill(&s->ground.level[0], post);
        } else {
            s->narrow = narrow;
        }
        for (int n = 0; n < mountain_posts * mountain_posts && status == STATUS_OK; n++) {
            const int    i = n % mountain_posts, j = n / mountain_posts;
            const double held_m = s->narrow ? (double)narrow[n] : elevation_post_m(&s->ground.level[0], i, j);
            bench_worst(&point[k].error, fabs(held_m - mountain_height(i, j)));
        }
        for (int n = 0; n < mountain_asks; n++)
            for (int c = 0; c < 2; c++)
                s->at[n][c] = 4 * (mountain_posts - 1.01) * random_uniform(44, (uint32_t)c, 0, (uint64_t)n);
        work[k] = (BenchWork){ask_store, s, mountain_asks};
        point[k].setting = name[k];
        point[k].is_default = k == 4;
        point[k].bytes = s->narrow ? (double)sizeof narrow : 2.0 * (double)elevation_level_stored(&s->ground.level[0]);
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"posts of terrain from files", "terrain/elevation/levels.c",
                                      "a height between posts", "m", "largest, double, mountains of 1.4 km", 0.005},
                      work, point, settings);
    for (int k = 0; k < settings; k++) elevation_destroy(&set[k].ground);
    return status;
}

/* ---- detail: weakest octave ------------------------------------------------------------------------ */

enum { spots = 1024 };

typedef struct DetailSet {
    const Landscape   *land;
    const DetailTable *table;
    uint8_t class[spots];
    double x_m[spots], y_m[spots];
    float  across_m[spots], along_m[spots], albedo[spots], warmth_k[spots], slope_x[spots], slope_y[spots];
} DetailSet;

static void ask_details(void *user)
{
    DetailSet         *s = user;
    const GroundDetail out = {
        .albedo = s->albedo, .warmth_k = s->warmth_k, .slope_x = s->slope_x, .slope_y = s->slope_y};
    detail_at(&out, s->table, s->land, spots, s->class, s->x_m, s->y_m, &(GroundFootprint){s->across_m, s->along_m});
    bench_keep(s->albedo);
}

static double rms_percent(const float *a, const float *b)
{
    double square = 0;
    for (int i = 0; i < spots; i++) square += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
    return 100 * sqrt(square / spots);
}

/* Rows of a picture: eight neighbours share their footprint. */
static Status tunable_detail(Bench *bench, const Landscape *land)
{
    enum { settings = 6 };
    static const char *const name[settings] = {"every octave", "0.001", "0.005", "0.02", "0.1", "none"};
    static const double      cut_off[settings] = {0, 0.001, 0.005, 0.02, 0.1, 2};
    static DetailSet         set[settings];
    DetailTable             *table[settings] = {NULL};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    char                     path[512];
    Status                   status = etc_path(path, sizeof path, "ground_detail.csv") ? STATUS_OK : STATUS_BAD_VALUE;
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        DetailSet *s = &set[k];
        status = detail_table_open(&table[k], path, cut_off[k]);
        s->land = land, s->table = table[k];
        for (int i = 0; i < spots; i++) {
            const double wide_m = 0.03 * pow(200, random_uniform(43, 2, 0, (uint64_t)(i / 64)));
            s->class[i] = SURFACE_GRASS;
            s->x_m[i] = 800 * (random_uniform(43, 0, 0, (uint64_t)(i / 64)) - 0.5) + wide_m * (i % 64);
            s->y_m[i] = 800 * (random_uniform(43, 1, 0, (uint64_t)(i / 64)) - 0.5);
            s->across_m[i] = (float)wide_m;
            s->along_m[i] = (float)(wide_m * (1 + 9 * random_uniform(43, 3, 0, (uint64_t)(i / 64))));
        }
        if (status == STATUS_OK) ask_details(s);
        work[k] = (BenchWork){ask_details, s, spots};
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = rms_percent(s->albedo, set[0].albedo),
                                  .is_default = cut_off[k] == detail_cut_off};
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"detail: weakest octave", "terrain/detail/detail_table.c",
                                      "a pixel of 0.03 .. 6 m on grass", "%", "rms of brightness, every octave", 2},
                      work, point, settings);
    for (int k = 0; k < settings; k++) detail_table_close(table[k]);
    return status;
}

Status bench_precision_land(Bench *bench)
{
    const Geodetic  origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    Landscape       land = {0};
    config.half_width_m = 500, config.horizon_m = 2000;
    bench_progress(bench, "invented ground");
    Status status = local_frame_at(&frame, &origin);
    if (status == STATUS_OK) status = tunable_spacing(bench, &frame);
    if (status == STATUS_OK) status = tunable_reach(bench, &frame);
    if (status == STATUS_OK) status = landscape_create(&land, &config, &frame, NULL, 0, NULL, 0);
    if (status == STATUS_OK) {
        tunable_posts(bench);
        status = tunable_store(bench);
        if (status == STATUS_OK) status = tunable_detail(bench, &land);
    }
    if (status != STATUS_OK) log_error("bench: precision: ground: %s", status_name(status));
    landscape_destroy(&land);
    return status;
}
