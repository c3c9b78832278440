/* tests/terrain/test_elevation_import.c: ground from files against GDAL's own tools.
 *
 * The judge: gdaltransform takes random fractional pixels to longitude and latitude, gdallocationinfo reads the four
 * posts about each, the bilinear height between them goes through GeographicLib to ENU. Our surface must lie there
 * within what the import says resampling cost. EGM96 has its own test. labels: slow */
#include "tests/check.h"

#include "terrain/from_files/elevation_import.h"
#include "terrain/earth/geoid.h"

#include <sys/stat.h>

enum { places = 1000 };

/* Runs a tool over a file of input lines; NULL: it is not installed. */
static FILE *judge(const char *command, const char *input_path)
{
    char line[2048];
    snprintf(line, sizeof line, "%s < %s 2>/dev/null", command, input_path);
    return popen(line, "r");
}

static bool judge_installed(void)
{
    if (system("command -v gdallocationinfo gdaltransform >/dev/null") == 0) return true;
    printf("skipped: apt-get install gdal-bin for gdallocationinfo and gdaltransform\n");
    return false;
}

typedef struct Judged {
    double lon_rad, lat_rad, h_m; /* h: as the file has it */
} Judged;

/* Heights at random places of one file, those at voids left out. */
static int ask_judge(Judged *out, const char *path, int width, int height)
{

    char   command[1200], px_path[64], post_path[64];
    double x[places], y[places];
    int    kept = 0;
    snprintf(px_path, sizeof px_path, "/tmp/pitviper-judge-px-%d", (int)getpid());
    snprintf(post_path, sizeof post_path, "/tmp/pitviper-judge-posts-%d", (int)getpid());
    FILE *px = fopen(px_path, "w"), *post = fopen(post_path, "w");
    CHECK(px && post);
    for (int n = 0; n < places; n++) {
        x[n] = 0.5 + (width - 1.001) * random_uniform(77, 1, 0, (uint64_t)n);
        y[n] = 0.5 + (height - 1.001) * random_uniform(77, 2, 0, (uint64_t)n);
        fprintf(px, "%.9f %.9f\n", x[n], y[n]);
        for (int k = 0; k < 4; k++) fprintf(post, "%d %d\n", (int)(x[n] - 0.5) + (k & 1), (int)(y[n] - 0.5) + (k >> 1));
    }
    fclose(px);
    fclose(post);
    snprintf(command, sizeof command, "gdaltransform -output_xy -t_srs EPSG:4326 '%s'", path);
    FILE *earth = judge(command, px_path);
    snprintf(command, sizeof command, "gdallocationinfo -valonly -b 1 '%s'", path);
    FILE *value = judge(command, post_path);
    CHECK(earth && value);
    for (int n = 0; n < places; n++) {
        double lon_deg, lat_deg, v[4];
        CHECK(fscanf(earth, "%lf %lf", &lon_deg, &lat_deg) == 2);
        for (int k = 0; k < 4; k++) CHECK(fscanf(value, "%lf", &v[k]) == 1);
        const double a = x[n] - 0.5 - floor(x[n] - 0.5), b = y[n] - 0.5 - floor(y[n] - 0.5);
        if (v[0] < -1000 || v[1] < -1000 || v[2] < -1000 || v[3] < -1000) continue; /* the samples' voids */
        out[kept++] = (Judged){lon_deg * rad_per_deg, lat_deg * rad_per_deg,
                               (1 - b) * ((1 - a) * v[0] + a * v[1]) + b * ((1 - a) * v[2] + a * v[3])};
    }
    pclose(earth);
    pclose(value);
    remove(px_path);
    remove(post_path);
    return kept;
}

static LocalFrame frame_at(double lat_deg, double lon_deg)
{
    LocalFrame     frame;
    const Geodetic place = {lat_deg * rad_per_deg, lon_deg * rad_per_deg, 0};
    assert_int_equal(local_frame_at(&frame, &place), STATUS_OK);
    return frame;
}

static ElevationFiles files_of(const char *paths)
{
    return (ElevationFiles){.paths = paths, .geoid_path = "", .horizon_m = 100000};
}

static const Geoid *egm96(void)
{
    static Geoid geoid;
    if (!geoid.n_m) assert_int_equal(geoid_open(&geoid, ""), STATUS_OK);
    return &geoid;
}

static double off_at(const Elevation *ground, const LocalFrame *frame, const Judged *place)
{
    Geodetic at = {place->lat_rad, place->lon_rad,
                   place->h_m + geoid_height_m(egm96(), place->lat_rad, place->lon_rad)};
    double   p_ecef[3], p_enu[3];
    assert_int_equal(ecef_from_geodetic(p_ecef, NULL, &at), STATUS_OK);
    enu_from_ecef(p_enu, frame, p_ecef);
    return elevation_height(ground, p_enu[0], p_enu[1], NULL) - p_enu[2];
}

/* name, size, a place in it, and what the error may be at most: rms and 99th percentile, from the roughness of each. */
typedef struct Sample {
    const char *name;
    int         width, height;
    double      lat_deg, lon_deg, rms_m, p99_m;
} Sample;

static void check_sample(const Sample *s)
{
    char            path[128];
    Elevation       ground = {0};
    ElevationReport report;
    Judged         *judged = malloc(places * sizeof *judged);
    snprintf(path, sizeof path, "terrain/%.100s", s->name);
    char full[512];
    if (!judge_installed() || !reference_path(full, path)) {
        free(judged);
        skip();
    }
    const LocalFrame     frame = frame_at(s->lat_deg, s->lon_deg);
    const ElevationFiles files = files_of(full);
    const double         begun_s = wall_clock_s();
    assert_int_equal(elevation_import(&ground, &report, &files, &frame, NULL, 0), STATUS_OK);
    const double took_s = wall_clock_s() - begun_s;

    const int count = ask_judge(judged, full, s->width, s->height);
    double    sum = 0, worst_m = 0;
    int       beyond = 0;
    CHECK(count > places / 2);
    for (int n = 0; n < count; n++) {
        const double off_m = fabs(off_at(&ground, &frame, &judged[n]));
        CHECK(isfinite(off_m));
        sum += off_m * off_m;
        worst_m = fmax(worst_m, off_m);
        beyond += off_m > report.error_p99_m + 0.002; /* GDAL prints float32 posts to 9 digits */
    }
    const double rms_m = sqrt(sum / count);
    print_message(
        "%-26s posting %.2f m, level 0 %.0f x %.0f m at %.3f m, %ld voids, %.1f s\n"
        "%-26s import says rms %.3f p99 %.3f max %.3f m; GDAL says rms %.3f max %.3f m of %d, %d beyond p99\n",
        s->name, report.posting_m, report.width_m[0], report.width_m[1], report.spacing_m, report.voids, took_s, "",
        report.error_rms_m, report.error_p99_m, report.error_max_m, rms_m, worst_m, count, beyond);
    CHECK(beyond <= count / 100 + 16);                   /* one in a hundred, and five sigma of 1000 draws */
    CHECK(worst_m <= 1.25 * report.error_max_m + 0.002); /* both are draws from one heavy tail, ours of 200 000 */
    CHECK(rms_m <= 1.3 * report.error_rms_m + 0.002);    /* for which one place of 1000 may make a third of the sum */
    CHECK(report.error_rms_m <= s->rms_m && report.error_p99_m <= s->p99_m);
    elevation_destroy(&ground);
    free(judged);
}

#define SAMPLE(function, ...)                                                                                          \
    static void function(void **state)                                                                                 \
    {                                                                                                                  \
        (void)state;                                                                                                   \
        check_sample(&(Sample){__VA_ARGS__});                                                                          \
    }
/* bounds: a tenth above what was measured; half a posting off in one direction at least doubles them all */
SAMPLE(lidar_surface, "autzen/autzen_dsm_1m.tif", 1004, 1390, 44.0565, -123.0690, 0.64, 3.0)
SAMPLE(lidar_ground, "autzen/autzen_dtm_1m.tif", 1004, 1390, 44.0565, -123.0690, 0.008, 0.03)
SAMPLE(landscape_file, "bitterroot/example_lcp.tif", 502, 515, 46.69, -114.17, 1.34, 5.0)
SAMPLE(resampled_radar, "bitterroot/missoula_valley.tif", 714, 975, 46.93, -114.03, 0.82, 3.1)
SAMPLE(utm_radar, "bigtujunga/bigtujunga.tif", 1197, 643, 34.3, -118.15, 0.83, 2.9)
SAMPLE(hgt_east, "srtm3/N49W123.hgt", 1201, 1201, 49.5, -122.5, 1.95, 7.7)
SAMPLE(hgt_west, "srtm3/N49W124.hgt", 1201, 1201, 49.5, -123.5, 1.55, 6.4)
SAMPLE(dted_1, "srtm3/n49_w123.dt1", 1201, 1201, 49.5, -122.5, 1.95, 7.7)
SAMPLE(dted_0, "srtm3/n49_w123.dt0", 121, 121, 49.5, -122.5, 25, 93)
SAMPLE(southern, "srtm3/S33W071.tif", 1201, 1201, -32.5, -70.5, 3.0, 11)

/* ---- sheets, voids, edges ------------------------------------------------------------------- */

/* Two neighbours as one: along their common edge the surface is the same as each alone gives, and has no step. */
static void neighbour_sheets_are_seamless(void **state)
{
    (void)state;
    char            east[512], west[512], both[1100];
    Elevation       ground = {0};
    ElevationReport report;
    if (!reference_path(east, "terrain/srtm3/N49W123.hgt") || !reference_path(west, "terrain/srtm3/N49W124.hgt"))
        skip();
    snprintf(both, sizeof both, "%s, %s", west, east);
    const LocalFrame frame = frame_at(49.35, -123);
    ElevationFiles   files = files_of(both);
    assert_int_equal(elevation_import(&ground, &report, &files, &frame, NULL, 0), STATUS_OK);
    CHECK(report.sheets == 2 && report.grids == 1);
    /* each sheet's own voids, less the one column of posts that both hold and that is counted once */
    assert_int_equal(report.voids, 34926 + 25620 - 4 /* counted in the files */);
    for (double y_m = -20000; y_m < 20000; y_m += 137)
        for (double x_m = -400; x_m < 400; x_m += 20) { /* 100 % is the steepest of these fjords' walls at 90 m posts */
            const double here_m = elevation_height(&ground, x_m, y_m, NULL),
                         next_m = elevation_height(&ground, x_m + 20, y_m, NULL);
            CHECK(fabs(next_m - here_m) < 60);
        }
    elevation_destroy(&ground);
}

static void voids_are_filled_without_a_spike(void **state)
{
    (void)state;
    char            path[512];
    Elevation       ground = {0};
    ElevationReport report;
    if (!reference_path(path, "terrain/srtm3/N49W123.hgt")) skip();
    const LocalFrame frame = frame_at(49.5, -122.5);
    ElevationFiles   files = files_of(path);
    assert_int_equal(elevation_import(&ground, &report, &files, &frame, NULL, 0), STATUS_OK);
    assert_int_equal(report.voids, 34926); /* counted in the file by the data's README */
    const ElevationLevel *level = &ground.level[0];
    double                low_m = INFINITY, high_m = -INFINITY;
    for (int j = 0; j < level->ny; j++)
        for (int i = 0; i < level->nx; i++) {
            const double p_enu[3] = {level->x0_m + i * level->spacing_m, level->y0_m + j * level->spacing_m,
                                     elevation_post_m(level, i, j)};
            double       p_ecef[3];
            Geodetic     place;
            ecef_from_enu(p_ecef, &frame, p_enu);
            assert_int_equal(geodetic_from_ecef(&place, p_ecef), STATUS_OK);
            const double h_m = place.h_m - geoid_height_m(egm96(), place.lat_rad, place.lon_rad);
            low_m = fmin(low_m, h_m);
            high_m = fmax(high_m, h_m);
        }
    print_message("N49W123: %.1f .. %.1f m above the sea\n", low_m, high_m);
    /* gdalinfo -mm: -37 .. 2674; resampling between posts cannot leave that, quantisation by 1/16 m at most */
    CHECK(low_m > -37.1 && high_m < 2674.1);
    elevation_destroy(&ground);
}

/* Both promises of terrain/elevation/elevation.h, on posts as stored: the outline of a level lies on the level around
 * to the bit. */
static void levels_meet_to_the_bit_and_reach_the_horizon(void **state)
{
    (void)state;
    char            path[512];
    Elevation       ground = {0};
    ElevationReport report;
    if (!reference_path(path, "terrain/autzen/autzen_dsm_1m.tif")) skip();
    const LocalFrame frame = frame_at(44.0565, -123.0690);
    ElevationFiles   files = files_of(path);
    assert_int_equal(elevation_import(&ground, &report, &files, &frame, NULL, 0), STATUS_OK);
    CHECK(ground.level_count == 4);
    for (int k = 0; k + 1 < ground.level_count; k++) {
        const ElevationLevel *fine = &ground.level[k];
        Elevation             around = {.level_count = 1};
        around.level[0] = ground.level[k + 1];
        CHECK(around.level[0].spacing_m == 8 * fine->spacing_m);
        for (int j = 0; j < fine->ny; j++)
            for (int i = 0; i < fine->nx; i++) {
                if (j > 0 && j < fine->ny - 1 && i > 0) i = fine->nx - 1;
                const double z_m = elevation_post_m(fine, i, j);
                CHECK(z_m == elevation_height(&around, fine->x0_m + i * fine->spacing_m,
                                              fine->y0_m + j * fine->spacing_m, NULL));
            }
    }
    /* no hole out to the horizon, and beyond the blend a plain at the height that was stated */
    for (double r_m = 10; r_m < 99000; r_m *= 1.3)
        for (int bearing = 0; bearing < 16; bearing++) {
            const double p_enu[3] = {
                r_m * cos(bearing * 0.39), r_m * sin(bearing * 0.39),
                elevation_height(&ground, r_m * cos(bearing * 0.39), r_m * sin(bearing * 0.39), NULL)};
            double   p_ecef[3];
            Geodetic place;
            CHECK(isfinite(p_enu[2]));
            ecef_from_enu(p_ecef, &frame, p_enu);
            assert_int_equal(geodetic_from_ecef(&place, p_ecef), STATUS_OK);
            if (r_m > report.reach_m[1] + report.blend_m + 4000)
                CHECK_NEAR(place.h_m, report.beyond_h_m, 0.6); /* 512 m posts: 5 mm; step 1/4 m .. */
        }
    elevation_destroy(&ground);
}

/* A strip of posts that reaches beyond the horizon to east and west and is 60 m wide: ground to the north all the same.
 */
static void a_long_strip_has_a_horizon_all_around(void **state)
{
    (void)state;
    enum { columns = 4000, rows = 2 };
    char            path[text_file_size], prj[text_file_size + 8], *text = malloc(1000 + 4 * columns * rows);
    Elevation       ground = {0};
    ElevationReport report;
    CHECK(text != NULL);
    size_t at =
        (size_t)sprintf(text, "ncols %d\nnrows %d\nxllcorner 7\nyllcorner 45\ncellsize 0.0003\n", columns, rows);
    for (int n = 0; n < columns * rows; n++)
        at += (size_t)sprintf(text + at, "%d%c", 250, n % columns < columns - 1 ? ' ' : '\n');
    text_file(path, text);
    snprintf(prj, sizeof prj, "%s.prj", path);
    FILE *file = fopen(prj, "w");
    CHECK(file &&
          fputs("GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
                "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]",
                file) > 0 &&
          fclose(file) == 0);
    const LocalFrame frame = frame_at(45.0003, 7.6);
    ElevationFiles   files = {.paths = path, .geoid_path = "", .vertical = ELEVATION_ELLIPSOID, .horizon_m = 20000};
    assert_int_equal(elevation_import(&ground, &report, &files, &frame, NULL, 0), STATUS_OK);
    for (double r_m = 10; r_m < 20000; r_m *= 1.2)
        for (int bearing = 0; bearing < 16; bearing++)
            CHECK_NEAR(elevation_height(&ground, r_m * cos(bearing * 0.39), r_m * sin(bearing * 0.39), NULL) +
                           r_m * r_m / 2 / 6.378e6,
                       250, 0.3); /* the Earth's bend, of two radii 0.7 % apart; quanta */
    elevation_destroy(&ground);
    remove(path);
    remove(prj);
    free(text);
}

/* One sheet within another: 30 m all around 30.9 m is the nearest to that in the samples. */
static void grids_of_two_surveys_are_one_ground(void **state)
{
    (void)state;
    char            fine[512], coarse[512], both[1100];
    Elevation       ground = {0}, alone = {0};
    ElevationReport report, of_alone;
    if (!reference_path(fine, "terrain/autzen/autzen_dtm_1m.tif") ||
        !reference_path(coarse, "terrain/autzen/autzen_dsm_1m.tif"))
        skip();
    /* the same CRS and pixels: the first that has a value wins */
    snprintf(both, sizeof both, "%s,%s", fine, coarse);
    const LocalFrame frame = frame_at(44.0565, -123.0690);
    ElevationFiles   files = files_of(both), first = files_of(fine);
    assert_int_equal(elevation_import(&ground, &report, &files, &frame, NULL, 0), STATUS_OK);
    assert_int_equal(elevation_import(&alone, &of_alone, &first, &frame, NULL, 0), STATUS_OK);
    CHECK(report.sheets == 2 && report.grids == 1 && of_alone.sheets == 1);
    for (double x_m = -400; x_m < 400; x_m += 9.7)
        CHECK(elevation_height(&ground, x_m, 0.31 * x_m, NULL) == elevation_height(&alone, x_m, 0.31 * x_m, NULL));
    elevation_destroy(&ground);
    elevation_destroy(&alone);
}

/* The correction leads the surface through fixes 3 m above it, smoothly. */
static void fixes_are_met_by_a_smooth_correction(void **state)
{
    (void)state;
    char            path[512];
    Elevation       plain = {0}, led = {0};
    ElevationReport report;
    GroundFix       fix[60] = {0};
    if (!reference_path(path, "terrain/bitterroot/example_lcp.tif")) skip();
    const LocalFrame frame = frame_at(46.69, -114.17);
    ElevationFiles   files = files_of(path);
    assert_int_equal(elevation_import(&plain, &report, &files, &frame, NULL, 0), STATUS_OK);
    CHECK(report.correction_m == 0);
    for (int n = 0; n < 60; n++) {
        fix[n].p_enu[0] = -1500 + 50 * n;
        fix[n].p_enu[1] = 300 + 10 * n;
        fix[n].p_enu[2] = elevation_height(&plain, fix[n].p_enu[0], fix[n].p_enu[1], NULL) + 3;
    }
    assert_int_equal(elevation_import(&led, &report, &files, &frame, fix, 60), STATUS_OK);
    for (int n = 0; n < 60; n++)
        CHECK_NEAR(elevation_height(&led, fix[n].p_enu[0], fix[n].p_enu[1], NULL), fix[n].p_enu[2], 0.1);
    CHECK(report.correction_m > 2.9 && report.correction_m < 6);
    double far_m = elevation_height(&led, 5000, -6000, NULL) - elevation_height(&plain, 5000, -6000, NULL);
    CHECK(fabs(far_m) < 4);
    elevation_destroy(&plain);
    elevation_destroy(&led);
}

/* ---- what the world does wrong -------------------------------------------------------------- */

static void expect_refused(const ElevationFiles *files, const LocalFrame *frame, const char *said)
{
    Elevation       ground = {0};
    ElevationReport report = {0};
    check_said[0] = 0;
    CHECK(elevation_import(&ground, &report, files, frame, NULL, 0) != STATUS_OK);
    CHECK(ground.level_count == 0);
    if (!strstr(check_said, said)) fail_msg("said: %s", check_said);
}

static void what_is_wrong_is_said_with_the_next_step(void **state)
{
    (void)state;
    const LocalFrame frame = frame_at(44.0565, -123.0690);
    char             path[text_file_size], dsm[512], cut[64];
    ElevationFiles   files = files_of("/nowhere/ground.tif");
    log_set_sink(check_listen, NULL);
    expect_refused(&files, &frame, "terrain.elevation: cannot read /nowhere/ground.tif");
    files.paths = " , ";
    expect_refused(&files, &frame, "names no file");
    text_file(path, "not a raster");
    files.paths = path;
    expect_refused(&files, &frame, "gdalinfo");
    remove(path);
    text_file(path,
              "<VRTDataset rasterXSize=\"2147483647\" rasterYSize=\"4\"><VRTRasterBand dataType=\"Byte\" band=\"1\"/>"
              "</VRTDataset>");
    files.paths = path;
    expect_refused(&files, &frame, "2147483647 x 4 pixels, more than 100000000 a side");
    remove(path);
    /* 300 octets that ask for 10^16 pixels about the origin */
    text_file(
        path,
        "<VRTDataset rasterXSize=\"99999999\" rasterYSize=\"99999999\"><SRS>EPSG:4326</SRS><GeoTransform>-123.5,1e-8,0,44.5,0,"
        "-1e-8</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"/></VRTDataset>");
    files.paths = path;
    expect_refused(&files, &frame, "GB to decode, more than 1024; gdal_translate -srcwin");
    remove(path);
    snprintf(cut, sizeof cut, "/tmp/pitviper-folder-%d", (int)getpid());
    CHECK(mkdir(cut, 0700) == 0);
    files.paths = cut;
    expect_refused(&files, &frame, "holds nothing that GDAL reads");
    rmdir(cut);

    if (!reference_path(dsm, "terrain/autzen/autzen_dsm_1m.tif")) skip();
    files.paths = dsm;
    files.geoid_path = "/nowhere/egm.gtx";
    expect_refused(&files, &frame, "apt-get install proj-data");
    files.geoid_path = "";
    const LocalFrame elsewhere = frame_at(10, 10);
    expect_refused(&files, &elsewhere, "km from the nearest data");

    /* cut short at every eighth: some open, none may crash or give a ground */
    FILE *from = fopen(dsm, "rb");
    CHECK(from && fseek(from, 0, SEEK_END) == 0);
    const long octets = ftell(from);
    char      *bytes = malloc((size_t)octets);
    CHECK(bytes && fseek(from, 0, SEEK_SET) == 0 && fread(bytes, (size_t)octets, 1, from) == 1);
    fclose(from);
    snprintf(cut, sizeof cut, "/tmp/pitviper-cut-%d.tif", (int)getpid());
    files.paths = cut;
    for (int eighth = 1; eighth < 8; eighth++) {
        FILE *to = fopen(cut, "wb");
        CHECK(to && fwrite(bytes, (size_t)(octets * eighth / 8), 1, to) == 1 && fclose(to) == 0);
        expect_refused(&files, &frame, "terrain.elevation: /tmp/pitviper-cut");
    }
    remove(cut);
    free(bytes);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lidar_surface),
        cmocka_unit_test(lidar_ground),
        cmocka_unit_test(landscape_file),
        cmocka_unit_test(resampled_radar),
        cmocka_unit_test(utm_radar),
        cmocka_unit_test(hgt_east),
        cmocka_unit_test(hgt_west),
        cmocka_unit_test(dted_1),
        cmocka_unit_test(dted_0),
        cmocka_unit_test(southern),
        cmocka_unit_test(neighbour_sheets_are_seamless),
        cmocka_unit_test(voids_are_filled_without_a_spike),
        cmocka_unit_test(levels_meet_to_the_bit_and_reach_the_horizon),
        cmocka_unit_test(a_long_strip_has_a_horizon_all_around),
        cmocka_unit_test(grids_of_two_surveys_are_one_ground),
        cmocka_unit_test(fixes_are_met_by_a_smooth_correction),
        cmocka_unit_test(what_is_wrong_is_said_with_the_next_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
