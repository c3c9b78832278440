/* tests/sensor/scan_stage.h: spheres over level ground before a radar that scans, and figures of its response. */
#ifndef TESTS_SENSOR_SCAN_STAGE_H
#define TESTS_SENSOR_SCAN_STAGE_H

#include "tests/check.h"

#include "sensor/radar/seeker_radar.h"

static const double radius_m = 0.5, range_m = 3000, eye_m = 200;
enum { spheres_most = 2, columns_px = 401, rows_px = 9 };

typedef struct Stage {
    Landscape      landscape;
    Catalog       *catalog;
    World          world;
    Pool          *pool;
    Arena         *arena;
    View           view;
    Snapshot       snapshot;
    SnapshotEntity entity[spheres_most];
    NodePose       node[8];
    int            model;
    char           folder[temp_path_size], catalog_path[temp_name_size];
    float          range_m[rows_px * columns_px];
    uint32_t       shown[rows_px * columns_px];
} Stage;

static Stage               stage;
static const DisEntityType sphere_type = {1, 1, 225, 83, 7, 0, 0};

static inline void put_sphere(FILE *to, const void *user)
{
    enum { rings = 100, sides = 200 }; /* facets 60 um deep: a three-hundredth of the wavelength */
    (void)user;
    fprintf(to, "o sphere\n");
    for (int i = 0; i <= rings; i++)
        for (int j = 0; j < sides; j++) {
            const double t = pi_rad * i / rings, p = 2 * pi_rad * j / sides;
            const double x = sin(t) * cos(p), y = cos(t), z = sin(t) * sin(p);
            fprintf(to, "v %.9f %.9f %.9f\nvn %.9f %.9f %.9f\n", radius_m * x, radius_m + radius_m * y, radius_m * z, x,
                    y, z);
        }
    for (int i = 0; i < rings; i++)
        for (int j = 0; j < sides; j++) {
            const int a1 = i * sides + j + 1, b1 = i * sides + (j + 1) % sides + 1, a2 = a1 + sides, b2 = b1 + sides;
            if (i > 0) fprintf(to, "f %d//%d %d//%d %d//%d\n", a1, a1, b1, b1, b2, b2);
            if (i < rings - 1) fprintf(to, "f %d//%d %d//%d %d//%d\n", a1, a1, b2, b2, a2, a2);
        }
}

static void put_text(FILE *to, const void *user) { fputs(user, to); }

static inline int open_stage(void **state)
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
    const char *const rows = "type,model,origin,length_m,width_m,height_m\n1.1.225.83.7.0.0,sphere.obj,base,1,1,1\n";
    if (text_write_file("test", stage.catalog_path, put_text, rows) != STATUS_OK) return -1;
    if (catalog_open(&stage.catalog, stage.catalog_path, 0.01) != STATUS_OK) return -1;
    if (local_frame_at(&frame, &origin) != STATUS_OK) return -1;
    stage.model = catalog_find(stage.catalog, sphere_type, &origin_of, NULL);
    if (landscape_create(&stage.landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return -1;
    if (world_open(&stage.world, stage.catalog, &stage.landscape, &frame, "avx2") != STATUS_OK) return -1;
    if (atmosphere_open(&stage.world.atmosphere, "us1976") != STATUS_OK) return -1;
    stage.arena = arena_create();
    return stage.arena && pool_create(&stage.pool, 3) == STATUS_OK ? 0 : -1;
}

static inline int close_stage(void **state)
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

static inline void place_sphere(int i, double azimuth, const double v_enu_mps[3])
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
    for (int n = 0; n < 8; n++) stage.node[n] = (NodePose){.r_body_from_node = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    stage.snapshot = (Snapshot){.count = i + 1, .entity = stage.entity, .node = stage.node};
    CHECK(catalog_model(stage.catalog, stage.model)->node_count <= 8);
}

static inline RadarScene scene_of(double speed, const Weather *weather)
{
    const double ground_m = elevation_height(&stage.landscape.elevation, 0, 0, NULL);
    stage.view = (View){.p_enu = {0, 0, ground_m + eye_m},
                        .width = columns_px,
                        .height = rows_px,
                        .focal_px = 500,
                        .r_enu_from_cam = {0, 0, 1, -1, 0, 0, 0, -1, 0}};
    return (RadarScene){.world = &stage.world,
                        .snapshot = &stage.snapshot,
                        .view = &stage.view,
                        .hidden = -1,
                        .v_enu_mps = {speed, 0, 0},
                        .reference_m = range_m,
                        .weather = weather,
                        .number = 5};
}

static inline SeekerRadar *open_radar(const char *preset, double scan_deg, double scan_step, bool ground)
{
    SeekerRadar            *radar;
    const SeekerRadarConfig config = {.preset = preset,
                                      .catalog = stage.catalog_path,
                                      .isa = "avx2",
                                      .ground = ground,
                                      .scan_rad = scan_deg * rad_per_deg,
                                      .scan_step = scan_step,
                                      .seed = 3};
    CHECK(seeker_radar_create(&radar, &config) == STATUS_OK);
    return radar;
}

static inline const RadarFrame *measure(SeekerRadar *radar, const RadarScene *scene, Pool *pool)
{
    const RadarFrame *frame;
    CHECK(seeker_radar_measure(&frame, radar, scene, pool, stage.arena) == STATUS_OK);
    return frame;
}

/* Field of an aperture lit (1 - r^2)^taper, by an integral over it; 1 on the axis. */
static inline double aperture_field(const Antenna *a, double angle)
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

static inline double two_way_width(const Antenna *a)
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

static inline int peak_of(const double *power, int count)
{
    int peak = 0; /* NaN: none */
    for (int i = 1; i < count; i++)
        if (power[i] > power[peak] || isnan(power[peak])) peak = i;
    return peak;
}

/* Vertex of the parabola through three logarithms. */
static inline double vertex_of(const double *power, int peak)
{
    const double a = log(power[peak - 1]), b = log(power[peak]), c = log(power[peak + 1]);
    return peak + 0.5 * (a - c) / (a - 2 * b + c);
}

/* Between the half-power points, straight in decibels between samples. */
static inline double width_of(const double *power, int count, int peak)
{
    double       vertex = vertex_of(power, peak) - peak, side[2];
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
static inline void over_range(double *out, const double *power, int rows, int columns)
{
    for (int i = 0; i < rows; i++) {
        const double *row = power + (size_t)i * (size_t)columns;
        const int     peak = peak_of(row, columns);
        out[i] = 0;
        for (int x = peak - 3; x <= peak + 3; x++)
            if (x >= 0 && x < columns && row[x] > 0) out[i] += row[x];
    }
}

#endif
