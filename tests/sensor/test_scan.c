/* A beam that scans: spheres at places that the test knows, in the real beam, sharpened by Doppler, and on pixels. Widths
 * and resolutions against an integral over the aperture and lambda R / (2 v T sin psi). labels: threads */
#include "tests/check.h"

#include "sensor/radar/seeker_radar.h"

static const double radius_m = 0.5, range_m = 3000, eye_m = 200;
enum { spheres_most = 2, columns_px = 401, rows_px = 9 };

typedef struct Stage {
    Landscape  landscape;
    Catalog   *catalog;
    World      world;
    Pool      *pool;
    Arena     *arena;
    View       view;
    Snapshot   snapshot;
    SnapshotEntity entity[spheres_most];
    NodePose   node[8];
    int        model;
    char       folder[temp_path_size], catalog_path[temp_name_size];
    float      range_m[rows_px * columns_px];
    uint32_t   shown[rows_px * columns_px];
} Stage;

static Stage stage;
static const DisEntityType sphere_type = {1, 1, 225, 83, 7, 0, 0};

static void put_sphere(FILE *to, const void *user)
{
    enum { rings = 100, sides = 200 }; /* facets 60 um deep: a three-hundredth of the wavelength */
    (void)user;
    fprintf(to, "o sphere\n");
    for (int i = 0; i <= rings; i++)
        for (int j = 0; j < sides; j++) {
            const double t = pi_rad * i / rings, p = 2 * pi_rad * j / sides;
            const double x = sin(t) * cos(p), y = cos(t), z = sin(t) * sin(p);
            fprintf(to, "v %.9f %.9f %.9f\nvn %.9f %.9f %.9f\n", radius_m * x, radius_m + radius_m * y, radius_m * z, x, y, z);
        }
    for (int i = 0; i < rings; i++)
        for (int j = 0; j < sides; j++) {
            const int a1 = i * sides + j + 1, b1 = i * sides + (j + 1) % sides + 1, a2 = a1 + sides, b2 = b1 + sides;
            if (i > 0) fprintf(to, "f %d//%d %d//%d %d//%d\n", a1, a1, b1, b1, b2, b2);
            if (i < rings - 1) fprintf(to, "f %d//%d %d//%d %d//%d\n", a1, a1, b2, b2, a2, a2);
        }
}

static void put_text(FILE *to, const void *user) { fputs(user, to); }

static int open_stage(void **state)
{
    (void)state;
    char            path[temp_name_size];
    Origin          origin_of;
    LocalFrame      frame;
    const Geodetic  origin = {0.6, -1.9, 700};
    LandscapeConfig config = landscape_default_config();
    config.half_width_m = 4000;
    config.horizon_m = 20000;
    config.relief_m = 0;
    if (!temp_folder(stage.folder)) return -1;
    snprintf(path, sizeof path, "%s/sphere.obj", stage.folder);
    if (text_write_file("test", path, put_sphere, NULL) != STATUS_OK) return -1;
    snprintf(path, sizeof path, "%s/sphere.yaml", stage.folder);
    if (text_write_file("test", path, put_text, "materials: {\"*\": metal_steel_galvanized}\n") != STATUS_OK) return -1;
    snprintf(stage.catalog_path, sizeof stage.catalog_path, "%s/catalog.csv", stage.folder);
    if (text_write_file("test", stage.catalog_path, put_text,
                        "type,model,origin,length_m,width_m,height_m\n1.1.225.83.7.0.0,sphere.obj,base,1,1,1\n") != STATUS_OK)
        return -1;
    if (catalog_open(&stage.catalog, stage.catalog_path, 0.01) != STATUS_OK || local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    stage.model = catalog_find(stage.catalog, sphere_type, &origin_of, NULL);
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (world_open(&stage.world, stage.catalog, &stage.landscape, &frame, "avx2") != STATUS_OK) return -1;
    if (atmosphere_open(&stage.world.atmosphere, "us1976") != STATUS_OK) return -1;
    stage.arena = arena_create();
    return stage.arena && pool_create(&stage.pool, 3) == STATUS_OK ? 0 : -1;
}

static int close_stage(void **state)
{
    (void)state;
    static const char *const files[] = {"sphere.obj", "sphere.yaml", "catalog.csv"};
    char                     path[temp_name_size];
    pool_destroy(stage.pool);
    arena_destroy(stage.arena);
    world_close(&stage.world);
    landscape_destroy(&stage.landscape);
    catalog_close(stage.catalog);
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", stage.folder, files[i]);
        remove(path);
    }
    rmdir(stage.folder);
    return 0;
}

/* East of the eye is ahead, south to the right: direction of an azimuth, level. */
static void toward(double d_enu[3], double azimuth) { d_enu[0] = cos(azimuth), d_enu[1] = -sin(azimuth), d_enu[2] = 0; }

static void place_sphere(int i, double azimuth, const double v_enu_mps[3])
{
    const LocalFrame *frame = &stage.world.frame;
    const double      ground_m = elevation_height(&stage.landscape.elevation, 0, 0, NULL);
    double            d[3], p[3] = {0, 0, ground_m + eye_m - radius_m};
    SnapshotEntity   *e = &stage.entity[i];
    toward(d, azimuth);
    v3_add_scaled(p, p, range_m, d);
    *e = (SnapshotEntity){.id = {1, 1, (uint16_t)(i + 1)}, .type = sphere_type, .model = stage.model};
    ecef_from_enu(e->p_ecef, frame, p);
    m3_mul_v3(e->v_ecef_mps, frame->r_ecef_from_enu, v_enu_mps);
    /* body: x north, y east, z down; of no matter to a sphere but that its top be above */
    const double r_enu_from_body[9] = {0, 1, 0, 1, 0, 0, 0, 0, -1};
    m3_mul(e->r_ecef_from_body, frame->r_ecef_from_enu, r_enu_from_body);
    for (int n = 0; n < 8; n++)
        stage.node[n] = (NodePose){.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    stage.snapshot = (Snapshot){.count = i + 1, .entity = stage.entity, .node = stage.node};
    CHECK(catalog_model(stage.catalog, stage.model)->node_count <= 8);
}

static RadarScene scene_of(double speed_mps, const Weather *weather)
{
    const double ground_m = elevation_height(&stage.landscape.elevation, 0, 0, NULL);
    stage.view = (View){.p_enu = {0, 0, ground_m + eye_m}, .width = columns_px, .height = rows_px, .focal_px = 500,
                        .r_enu_from_cam = {0, 0, 1, -1, 0, 0, 0, -1, 0}};
    return (RadarScene){.world = &stage.world, .snapshot = &stage.snapshot, .view = &stage.view, .hidden = -1, .v_enu_mps = {speed_mps, 0, 0},
                        .reference_m = range_m, .weather = weather, .number = 5};
}

static SeekerRadar *open_radar(const char *preset, double scan_deg, double scan_step, bool ground)
{
    SeekerRadar *radar;
    CHECK(seeker_radar_create(&radar, &(SeekerRadarConfig){.preset = preset, .catalog = stage.catalog_path, .isa = "avx2", .ground = ground,
                                                           .scan_rad = scan_deg * rad_per_deg, .scan_step = scan_step, .seed = 3}) ==
          STATUS_OK);
    return radar;
}

static const RadarFrame *measure(SeekerRadar *radar, const RadarScene *scene, Pool *pool)
{
    const RadarFrame *frame;
    CHECK(seeker_radar_measure(&frame, radar, scene, pool, stage.arena) == STATUS_OK);
    return frame;
}

/* Field of an aperture lit (1 - r^2)^taper, by an integral over it; 1 on the axis. */
static double aperture_field(const Antenna *a, double angle)
{
    const double u = pi_rad * a->diameter_m / a->wavelength_m * sin(angle);
    double       sum = 0, all = 0;
    for (int i = 0; i < 4000; i++) {
        const double r = (i + 0.5) / 4000, light = pow(1 - r * r, a->taper) * r;
        sum += light * j0(u * r);
        all += light;
    }
    return sum / all;
}

static double two_way_width(const Antenna *a)
{
    double low = 0, high = 0.5 * a->wavelength_m / a->diameter_m;
    for (int i = 0; i < 50; i++) {
        const double middle = 0.5 * (low + high);
        if (pow(aperture_field(a, middle), 4) > 0.5) low = middle;
        else high = middle;
    }
    return 2 * low;
}

/* ---- figures of a response that rises and falls, over its index --------------------------------------- */

static int peak_of(const double *power, int count)
{
    int peak = 0; /* NaN: none */
    for (int i = 1; i < count; i++)
        if (power[i] > power[peak] || isnan(power[peak])) peak = i;
    return peak;
}

/* Vertex of the parabola through three logarithms. */
static double vertex_of(const double *power, int peak)
{
    const double a = log(power[peak - 1]), b = log(power[peak]), c = log(power[peak + 1]);
    return peak + 0.5 * (a - c) / (a - 2 * b + c);
}

/* Between the half-power points, straight in decibels between samples. */
static double width_of(const double *power, int count, int peak)
{
    double vertex = vertex_of(power, peak) - peak, side[2];
    const double a = log(power[peak - 1]), b = log(power[peak]), c = log(power[peak + 1]);
    const double half = b - 0.25 * (a - c) * vertex + log(0.5);
    for (int s = 0; s < 2; s++) {
        const int step = s ? 1 : -1;
        int       i = peak;
        while (i + step >= 0 && i + step < count && log(power[i + step]) > half) i += step;
        CHECK(i + step >= 0 && i + step < count);
        side[s] = i + step * (log(power[i]) - half) / (log(power[i]) - log(power[i + step]));
    }
    return side[1] - side[0];
}

/* Power of each azimuth about its greatest over range: of all cells over which one point spreads, so that it does not
 * matter where in a cell it is. */
static void over_range(double *out, const double *power, int rows, int columns)
{
    for (int i = 0; i < rows; i++) {
        const double *row = power + (size_t)i * (size_t)columns;
        const int     peak = peak_of(row, columns);
        out[i] = 0;
        for (int x = peak - 3; x <= peak + 3; x++)
            if (x >= 0 && x < columns && row[x] > 0) out[i] += row[x];
    }
}

static double line[scan_azimuths_most];

/* ---- tests -------------------------------------------------------------------------------------------- */

static void a_point_has_its_azimuth_and_the_beam_its_width(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    const double        azimuth = 1.23 * rad_per_deg;
    SeekerRadar        *radar = open_radar("search_ku", 8, 0.1, false);
    place_sphere(0, azimuth, still);
    const RadarScene  scene = scene_of(0, &weather);
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene, stage.pool);
    const RadarScan  *s = frame->scan;
    CHECK(s && s->plan.positions % 2 == 1);
    over_range(line, s->power_w, s->plan.positions, s->columns);
    const int    peak = peak_of(line, s->plan.positions);
    const double found = (vertex_of(line, peak) - s->plan.positions / 2) * s->plan.step_rad;
    const double width = width_of(line, s->plan.positions, peak) * s->plan.step_rad, want = two_way_width(&frame->preset->antenna);
    const int    column = peak_of(s->power_w + (size_t)peak * (size_t)s->columns, s->columns);
    printf("point at %.4f deg, want %.4f; width %.4f deg, two-way pattern %.4f, product %.4f\n", found / rad_per_deg,
           azimuth / rad_per_deg, width / rad_per_deg, want / rad_per_deg, s->beam_rad / rad_per_deg);
    CHECK_NEAR(found, azimuth, 0.005 * want);
    CHECK_NEAR(width, want, 0.01 * want);
    CHECK_NEAR(s->beam_rad, want, 1e-4 * want);
    CHECK_NEAR((column - s->columns / 2) * frame->map.metre_per_column, -radius_m, 0.5 * frame->map.metre_per_column);
    seeker_radar_destroy(radar);
}

/* Antenna and target move on from position to position: the peak is where the beam's axis and the line of sight to
 * the target meet. */
static void what_moves_is_met_where_it_is_then(void **state)
{
    (void)state;
    const double  v[3] = {-20, -60, 0}, speed = 250, azimuth = 8 * rad_per_deg;
    const Weather weather = weather_default();
    SeekerRadar  *radar = open_radar("search_ku", 24, 0.25, false);
    place_sphere(0, azimuth, v);
    const RadarScene  scene = scene_of(speed, &weather);
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene, stage.pool);
    const RadarScan  *s = frame->scan;
    over_range(line, s->power_w, s->plan.positions, s->columns);
    const int    peak = peak_of(line, s->plan.positions);
    const double found = (vertex_of(line, peak) - s->plan.positions / 2) * s->plan.step_rad;
    /* on paper: two-way pattern over range to the fourth, at each position */
    double paper[scan_positions_most] = {0}, range_then_m[scan_positions_most];
    for (int i = 0; i < s->plan.positions; i++) {
        const double from_middle = i - s->plan.positions / 2, t_s = from_middle * s->plan.interval_s;
        const double x = range_m * cos(azimuth) + (v[0] - speed) * t_s, y = range_m * sin(azimuth) - v[1] * t_s;
        const double off = from_middle * s->plan.step_rad - atan2(y, x);
        range_then_m[i] = hypot(x, y) - radius_m;
        paper[i] = pow(aperture_field(&frame->preset->antenna, off) / range_then_m[i], 4);
    }
    const double met = (vertex_of(paper, peak_of(paper, s->plan.positions)) - s->plan.positions / 2) * s->plan.step_rad;
    const int    column = peak_of(s->power_w + (size_t)peak * (size_t)s->columns, s->columns);
    const double followed_m = frame->reference_m + frame->reference_rate_mps * (peak - s->plan.positions / 2) * s->plan.interval_s;
    printf("met at %.4f deg, want %.4f (%.4f at the frame's time)\n", found / rad_per_deg, met / rad_per_deg, azimuth / rad_per_deg);
    CHECK(fabs(met - azimuth) > 0.2 * s->beam_rad); /* so that the test tells */
    CHECK_NEAR(found, met, 0.02 * s->beam_rad);
    CHECK_NEAR(followed_m + (column - s->columns / 2) * frame->map.metre_per_column, range_then_m[peak], 0.75 * frame->map.metre_per_column);
    seeker_radar_destroy(radar);
}

static const double speed_mps = 200, off_rad = 14 * rad_per_deg;

/* lambda R / (2 v T sin psi) over R. */
static double on_paper_rad(const RadarFrame *frame)
{
    const double interval_s = 128 / 4000.0, lambda_m = 299792458.0 / 16.5e9;
    CHECK(frame->preset->wave.pulses == 128 && frame->preset->wave.repeat_hz == 4000);
    return lambda_m / (2 * speed_mps * interval_s * sin(off_rad));
}

static double window_width(const RadarFrame *frame)
{
    WindowFigures figures;
    double        weight[128];
    CHECK(window_weights(weight, 128, &frame->preset->doppler_window) == STATUS_OK);
    CHECK(window_figures(&figures, weight, 128) == STATUS_OK);
    return figures.width_3db;
}

static void doppler_sharpens_as_on_paper(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 32, 0.5, false);
    place_sphere(0, off_rad, still);
    RadarScene        scene = scene_of(speed_mps, &weather);
    arena_reset(stage.arena);
    const RadarFrame *frame = measure(radar, &scene, stage.pool);
    const RadarScan  *s = frame->scan;
    const double      first = -(s->plan.positions / 2) * s->plan.step_rad, paper = on_paper_rad(frame), bins = window_width(frame);
    over_range(line, s->sharp_w, s->azimuths, s->columns);
    const int    peak = peak_of(line, s->azimuths);
    const double found = first + vertex_of(line, peak) * s->azimuth_step_rad;
    const double width = width_of(line, s->azimuths, peak) * s->azimuth_step_rad;
    const size_t at = (size_t)peak * (size_t)s->columns + (size_t)(s->columns / 2);
    printf("sharpened: at %.4f deg, want %.4f; %.3f mrad at half power, %.3f on paper; product %.3f m, paper %.3f m\n", found / rad_per_deg,
           off_rad / rad_per_deg, 1e3 * width, 1e3 * bins * paper, s->resolution_m[at], bins * paper * range_m);
    CHECK_NEAR(found, off_rad, 0.05 * bins * paper);
    CHECK_NEAR(width / bins, paper, 0.1 * paper);
    CHECK(s->sharpened[at] == 1);
    CHECK_NEAR(s->resolution_m[at], bins * paper * range_m, 0.02 * bins * paper * range_m);

    /* ahead it gains nothing: the real beam stands there, and is said to; to both sides of it, it sharpens */
    const size_t ahead = (size_t)(s->azimuths / 2) * (size_t)s->columns + (size_t)(s->columns / 2);
    CHECK(s->sharpened[ahead] == 0 && s->sharpened[(size_t)(s->columns / 2)] == 1);
    CHECK_NEAR(s->resolution_m[ahead], s->beam_rad * range_m, 1e-6 * range_m);
    CHECK_NEAR(s->sharp_w[ahead] / s->power_w[(size_t)(s->plan.positions / 2) * (size_t)s->columns + (size_t)(s->columns / 2)], 1, 1e-9);

    /* two, nearer than the beam is wide: one in the real beam, two sharpened */
    const double apart = 1.8 * bins * paper;
    CHECK(apart < 0.75 * s->beam_rad);
    place_sphere(0, off_rad - 0.5 * apart, still);
    place_sphere(1, off_rad + 0.5 * apart, still);
    frame = measure(radar, &scene, stage.pool);
    s = frame->scan;
    over_range(line, s->power_w, s->plan.positions, s->columns);
    int humps = 0;
    for (int i = 1; i < s->plan.positions - 1; i++) /* above a hundredth of the greatest: no side lobes */
        humps += line[i] > line[i - 1] && line[i] >= line[i + 1] && line[i] > 0.01 * line[peak_of(line, s->plan.positions)];
    CHECK(humps == 1);
    over_range(line, s->sharp_w, s->azimuths, s->columns);
    for (int side = -1; side <= 1; side += 2) {
        const double want = off_rad + side * 0.5 * apart;
        const int    begin = (int)((off_rad + (side < 0 ? -apart : 0) - first) / s->azimuth_step_rad);
        const int    count = (int)(apart / s->azimuth_step_rad), one = begin + peak_of(line + begin, count);
        const double at_one = first + vertex_of(line, one) * s->azimuth_step_rad;
        const double between = line[(int)lround((off_rad - first) / s->azimuth_step_rad)];
        printf("of two: at %.4f deg, want %.4f; between them %.1f dB\n", at_one / rad_per_deg, want / rad_per_deg,
               10 * log10(between / line[one]));
        CHECK_NEAR(at_one, want, 0.1 * bins * paper);
        CHECK(between < 0.25 * line[one]);
    }
    seeker_radar_destroy(radar);
}

/* Every pixel shows something at the sphere's range but for a few: its picture is that of the scan over azimuth. */
static void pixels_have_the_value_of_their_range_and_azimuth(void **state)
{
    (void)state;
    const double  v[3] = {25, 0, 0}; /* recedes; 5 m by the time the beam is there */
    static const double still[3] = {0, 0, 0};
    const Weather weather = weather_default();
    SeekerRadar  *radar = open_radar("search_ku", 32, 0.5, false);
    for (int moves = 0; moves < 2; moves++) {
        place_sphere(0, off_rad, moves ? v : still);
        RadarScene scene = scene_of(speed_mps, &weather);
        scene.range_m = stage.range_m;
        scene.entity = stage.shown;
        for (int i = 0; i < rows_px * columns_px; i++) {
            stage.range_m[i] = (float)(range_m - radius_m);
            stage.shown[i] = moves ? 1 : 0;
        }
        const int beyond = 2 * columns_px, sky = 3 * columns_px; /* two rows of other things */
        for (int x = 0; x < columns_px; x++) {
            stage.range_m[beyond + x] = (float)(range_m + 100);
            stage.range_m[sky + x] = INFINITY;
        }
        arena_reset(stage.arena);
        const RadarScan *s = measure(radar, &scene, stage.pool)->scan;
        CHECK(s->width == columns_px && s->height == rows_px);
        const int    middle = (rows_px / 2) * columns_px;
        const double want = 0.5 * columns_px + 500 * tan(off_rad) - 0.5; /* index of the pixel whose centre is there */
        double       real[columns_px], sharp[columns_px];
        for (int x = 0; x < columns_px; x++) {
            real[x] = isnan(s->view_w[middle + x]) ? 0 : s->view_w[middle + x];
            sharp[x] = isnan(s->view_sharp_w[middle + x]) ? 0 : s->view_sharp_w[middle + x];
            CHECK(isnan(s->view_w[sky + x]) && isnan(s->view_sharp_w[sky + x]));
        }
        const double beam_px = 500 * s->beam_rad / pow(cos(off_rad), 2), at_real = vertex_of(real, peak_of(real, columns_px));
        const double at_sharp = vertex_of(sharp, peak_of(sharp, columns_px));
        printf("%s: on pixel %.2f in the real beam, %.2f sharpened, want %.2f; the beam is %.1f pixels wide\n", moves ? "moving" : "still",
               at_real, at_sharp, want, beam_px);
        CHECK(real[0] == 0 && real[columns_px - 1] == 0); /* out of the sector */
        const int px = (int)lround(want);
        CHECK(s->view_w[beyond + px] < 1e-3 * real[px]);
        CHECK_NEAR(at_real, want, 0.05 * beam_px);
        if (!moves) CHECK_NEAR(at_sharp, want, 0.5); /* Doppler displaces what moves */
    }
    seeker_radar_destroy(radar);
}

/* A fifth of a step from a position the cubic is farthest off: by 2.15 % of the beamwidth for a dish of taper 1. */
static void between_positions_the_beam_is_nearly_a_gaussian(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 32, 0.5, false);
    ScanPlan            plan;
    RadarPreset         preset;
    char                path[4096];
    CHECK(etc_path(path, sizeof path, "radars.csv") && radar_preset_read(&preset, path, "search_ku") == STATUS_OK);
    CHECK(scan_plan(&plan, &preset, 32 * rad_per_deg, 0.5) == STATUS_OK);
    const double azimuth = 3.2 * plan.step_rad, want = 0.5 * columns_px + 500 * tan(azimuth) - 0.5;
    place_sphere(0, azimuth, still);
    RadarScene scene = scene_of(0, &weather);
    for (int i = 0; i < rows_px * columns_px; i++) stage.range_m[i] = (float)(range_m - radius_m);
    scene.range_m = stage.range_m;
    arena_reset(stage.arena);
    const RadarScan *s = measure(radar, &scene, stage.pool)->scan;
    double           real[columns_px];
    for (int x = 0; x < columns_px; x++) real[x] = isnan(s->view_w[x]) ? 0 : s->view_w[x];
    const double error_rad = (vertex_of(real, peak_of(real, columns_px)) - want) / 500 * pow(cos(azimuth), 2);
    printf("between positions: %.2f %% of the beamwidth off\n", 100 * error_rad / (2 * plan.step_rad));
    CHECK_NEAR(error_rad / (2 * plan.step_rad), 0, 0.03);
    seeker_radar_destroy(radar);
}

/* What is refused: more positions than there is room for. */
static void too_fine_a_scan_is_refused(void **state)
{
    (void)state;
    RadarPreset preset;
    ScanPlan    plan;
    char        path[4096];
    CHECK(etc_path(path, sizeof path, "radars.csv") && radar_preset_read(&preset, path, "search_ku") == STATUS_OK);
    CHECK(scan_plan(&plan, &preset, 160 * rad_per_deg, 0.05) == STATUS_BAD_VALUE);
    CHECK(scan_plan(&plan, &preset, 160 * rad_per_deg, 0.5) == STATUS_OK && plan.positions % 2 == 1);
    CHECK((plan.positions - 1) * plan.step_rad >= 160 * rad_per_deg && (plan.positions - 3) * plan.step_rad < 160 * rad_per_deg);
    CHECK(scan_plan(&plan, &preset, 0, 0.5) == STATUS_OK && plan.positions == 1);
}

/* Whatever makes it: and the middle position is the interval of a beam that stares: over ground bit for bit, of entities but
 * for finer scattering centres, which are to hold over all positions. */
static void the_same_bits(void **state)
{
    (void)state;
    static const double still[3] = {0, 0, 0};
    const Weather       weather = weather_default();
    SeekerRadar        *radar = open_radar("search_ku", 12, 0.5, false), *stares = open_radar("search_ku", 0, 0.5, false);
    place_sphere(0, 2 * rad_per_deg, still);
    place_sphere(1, -3 * rad_per_deg, still);
    for (int ground = 0; ground < 2; ground++) {
        if (ground) {
            seeker_radar_destroy(radar);
            seeker_radar_destroy(stares);
            radar = open_radar("seeker_35", 8, 0.5, true);
            stares = open_radar("seeker_35", 0, 0.5, true);
            stage.snapshot.count = 0;
        }
        RadarScene scene = scene_of(speed_mps, &weather);
        if (ground) { /* down onto the ground, in radar axes of another kind */
            const double r[9] = {0, -0.2, sqrt(0.96), -1, 0, 0, 0, -sqrt(0.96), -0.2};
            memcpy(stage.view.r_enu_from_cam, r, sizeof r);
            scene.reference_m = eye_m / 0.2;
        }
        for (int i = 0; i < rows_px * columns_px; i++) stage.range_m[i] = (float)scene.reference_m;
        scene.range_m = stage.range_m;
        arena_reset(stage.arena);
        const RadarFrame *three = measure(radar, &scene, stage.pool), *one = measure(radar, &scene, NULL);
        const RadarFrame *still_one = measure(stares, &scene, stage.pool);
        const RadarScan  *a = three->scan, *b = one->scan;
        const size_t map = interval_channels * (size_t)one->map.rows * (size_t)one->map.columns * sizeof *one->map.cell;
        const size_t pixels = (size_t)a->width * (size_t)a->height;
        CHECK(memcmp(three->map.cell, one->map.cell, map) == 0);
        double most = 0, apart = 0;
        for (size_t i = 0; i < map / sizeof *one->map.cell; i++) {
            most = fmax(most, cabs(one->map.cell[i]));
            apart = fmax(apart, cabs(one->map.cell[i] - still_one->map.cell[i]));
        }
        printf("%s: the middle position is %.1e off the beam that stares\n", ground ? "ground" : "spheres", apart / most);
        CHECK(!still_one->scan && apart <= (ground ? 0 : 0.03 * most));
        CHECK(memcmp(a->power_w, b->power_w, (size_t)a->plan.positions * (size_t)a->columns * sizeof *a->power_w) == 0);
        CHECK(memcmp(a->sharp_w, b->sharp_w, (size_t)a->azimuths * (size_t)a->columns * sizeof *a->sharp_w) == 0);
        CHECK(memcmp(a->view_w, b->view_w, pixels * sizeof *a->view_w) == 0);
        CHECK(memcmp(a->view_sharp_w, b->view_sharp_w, pixels * sizeof *a->view_sharp_w) == 0);
        CHECK(!ground || one->ground_cells > still_one->ground_cells);
    }
    seeker_radar_destroy(radar);
    seeker_radar_destroy(stares);
}

/* From a still antenna each position sees what a beam sees that stares there: the same ground, to the sector's ends. */
static void a_position_is_a_beam_that_stares_there(void **state)
{
    (void)state;
    const Weather weather = weather_default();
    SeekerRadar  *radar = open_radar("seeker_35", 24, 0.5, true), *stares = open_radar("seeker_35", 0, 0.5, true);
    stage.snapshot.count = 0;
    RadarScene   scene = scene_of(0, &weather);
    const double r[9] = {0, -0.2, sqrt(0.96), -1, 0, 0, 0, -sqrt(0.96), -0.2};
    memcpy(stage.view.r_enu_from_cam, r, sizeof r);
    scene.reference_m = eye_m / 0.2;
    arena_reset(stage.arena);
    const RadarScan *s = measure(radar, &scene, stage.pool)->scan;
    for (int i = 0; i < s->plan.positions; i += s->plan.positions / 2) {
        const double azimuth = (i - s->plan.positions / 2) * s->plan.step_rad, c = cos(azimuth), n = sin(azimuth);
        for (int k = 0; k < 3; k++) {
            stage.view.r_enu_from_cam[3 * k] = c * r[3 * k] - n * r[3 * k + 2];
            stage.view.r_enu_from_cam[3 * k + 2] = c * r[3 * k + 2] + n * r[3 * k];
        }
        const RadarFrame *there = measure(stares, &scene, stage.pool);
        double            apart = 0, all = 0;
        for (int x = 0; x < s->columns; x++) {
            apart += fabs(s->power_w[(size_t)i * (size_t)s->columns + (size_t)x] - there->profile_w[x]);
            all += there->profile_w[x];
        }
        printf("position %d, %.1f deg: %.1e off the beam that stares there\n", i, azimuth / rad_per_deg, apart / all);
        CHECK(apart < 0.01 * all);
    }
    seeker_radar_destroy(radar);
    seeker_radar_destroy(stares);
}

/* What a position leaves out: two-way power of ground beyond the null, over all, for ground lit evenly; and of one
 * target beyond u = 16. By sums over the aperture. */
static void little_is_left_out(void **state)
{
    (void)state;
    for (int taper = 0; taper <= 2; taper++) {
        static const double null_u[] = {3.8317, 5.1356, 6.3802}, most_beyond[] = {5e-4, 2e-5, 2e-6}, most_far[] = {2e-6, 2e-8, 1e-9};
        const Antenna a = {.diameter_m = 0.18, .taper = taper, .wavelength_m = 0.0085};
        const double  per_u = a.wavelength_m / (pi_rad * a.diameter_m);
        double        beyond = 0, all = 0, far = 0;
        for (double u = 0.01; u < 40; u += 0.02) {
            const double power = pow(aperture_field(&a, asin(u * per_u)), 4);
            all += power; /* a strip of ground at one range: over azimuth alone */
            if (u > null_u[taper]) beyond += power;
            if (u > 16) far = fmax(far, power);
        }
        printf("taper %d: ground beyond the null %.1f dB, entities beyond u = 16 below %.1f dB\n", taper, 10 * log10(beyond / all),
               10 * log10(far));
        CHECK(beyond / all < most_beyond[taper]);
        CHECK(far < most_far[taper]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_has_its_azimuth_and_the_beam_its_width),
        cmocka_unit_test(what_moves_is_met_where_it_is_then),
        cmocka_unit_test(doppler_sharpens_as_on_paper),
        cmocka_unit_test(pixels_have_the_value_of_their_range_and_azimuth),
        cmocka_unit_test(between_positions_the_beam_is_nearly_a_gaussian),
        cmocka_unit_test(too_fine_a_scan_is_refused),
        cmocka_unit_test(the_same_bits),
        cmocka_unit_test(a_position_is_a_beam_that_stares_there),
        cmocka_unit_test(little_is_left_out),
    };
    return cmocka_run_group_tests(tests, open_stage, close_stage);
}
