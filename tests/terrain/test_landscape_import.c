/* tests/terrain/test_landscape_import.c: cover and photographs on small made-up sheets, where each answer is on paper,
 * and the Autzen sample against gdallocationinfo.
 *
 * A made-up sheet: 64 x 64 cells of 10 m in UTM zone 10, its centre at easting 494500, northing 4878000, which
 * gdaltransform places at 44.0551450382678 N, 123.06866432757 W; north there is 3 minutes from grid north. */
#include "tests/check.h"

#include "terrain/earth/geoid.h"
#include "terrain/culture/culture_ground.h"
#include "terrain/from_files/elevation_import.h"

enum { cells = 64 };
static const double centre_lat_deg = 44.0551450382678, centre_lon_deg = -123.06866432757;

typedef int Painter(int column, int row); /* row 0 in the north */

static void write_sheet(char path[64], const char *name, Painter *paint)
{
    snprintf(path, 64, "/tmp/pitviper-%d-%s.asc", (int)getpid(), name);
    FILE *file = fopen(path, "w");
    CHECK(file);
    fprintf(file, "ncols %d\nnrows %d\nxllcorner %d\nyllcorner %d\ncellsize 10\nNODATA_value -9999\n", cells, cells,
            494500 - 5 * cells, 4878000 - 5 * cells);
    for (int row = 0; row < cells; row++) {
        for (int column = 0; column < cells; column++) fprintf(file, "%d ", paint(column, row));
        fputc('\n', file);
    }
    CHECK(fclose(file) == 0);
    char prj[80];
    snprintf(prj, sizeof prj, "%.*sprj", (int)strlen(path) - 3, path);
    file = fopen(prj, "w");
    CHECK(file &&
          fputs("Projection    UTM\nZone          10\nDatum         WGS84\nSpheroid      WGS84\nUnits         METERS\n"
                "Parameters\n",
                file) >= 0 &&
          fclose(file) == 0);
}

/* Octets, as photographs are: red, green and blue sheets as one. */
static void write_photo(char path[64], const char *name, char sheet[3][64])
{
    snprintf(path, 64, "/tmp/pitviper-%d-%s.vrt", (int)getpid(), name);
    FILE *file = fopen(path, "w");
    CHECK(file);
    fprintf(file,
            "<VRTDataset rasterXSize='%d' rasterYSize='%d'><SRS>EPSG:32610</SRS><GeoTransform>%d,10,0,%d,0,-10"
            "</GeoTransform>",
            cells, cells, 494500 - 5 * cells, 4878000 + 5 * cells);
    for (int b = 0; b < 3; b++)
        fprintf(file,
                "<VRTRasterBand dataType='Byte' band='%d'><SimpleSource><SourceFilename>%s</SourceFilename>"
                "<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>",
                b + 1, sheet[b]);
    fputs("</VRTDataset>", file);
    CHECK(fclose(file) == 0);
}

static int level_ground(int column, int row)
{
    (void)column;
    (void)row;
    return 100;
}
static int quadrants(int column, int row)
{
    return row < cells / 2 ? column < cells / 2 ? 10 : 30 : column < cells / 2 ? 50 : 80;
}
static int nlcd_codes(int column, int row)
{
    return row < cells / 2 ? column < cells / 2 ? 42 : 71 : column < cells / 2 ? 23 : 11;
}
static int fuel_codes(int column, int row)
{
    return row < cells / 2 ? column < cells / 2 ? 183 : 102 : column < cells / 2 ? 91 : 98;
}
static int dynamic_codes(int column, int row)
{
    return row < cells / 2 ? column < cells / 2 ? 1 : 4 : column < cells / 2 ? 6 : 0;
}
static int corine_numbers(int column, int row)
{
    return row < cells / 2 ? column < cells / 2 ? 24 : 18 : column < cells / 2 ? 2 : 41;
}
static int corine_classes(int column, int row)
{
    return row < cells / 2 ? column < cells / 2 ? 312 : 231 : column < cells / 2 ? 112 : 512;
}
static int foreign_codes(int column, int row)
{
    (void)row;
    return column < cells / 2 ? 200 + column % 3 * 5 + 10 : 240;
}
static int grassland(int column, int row)
{
    (void)column;
    (void)row;
    return 30;
}
static int west_bright(int column, int row)
{
    (void)row;
    return column < cells / 2 ? 206 : 41;
}
static int north_bright(int column, int row)
{
    (void)column;
    return row < cells / 2 ? 206 : 41;
}
/* Fields of one colour but the south-west's chess board, 40 m from the others: a block of pixels holds colours on one
 * line. 154: the mean of the light of the chess board. */
static int chess(int column, int row)
{
    return column >= cells / 2 - 4 || row < cells / 2 + 4 ? 154 : (column + row) & 1 ? 206 : 41;
}

static LocalFrame centre_frame(void)
{
    LocalFrame     frame;
    const Geodetic place = {centre_lat_deg * rad_per_deg, centre_lon_deg * rad_per_deg, 0};
    assert_int_equal(local_frame_at(&frame, &place), STATUS_OK);
    return frame;
}

static LandscapeFiles files_of(const char *elevation, const char *cover, const char *photo)
{
    return (LandscapeFiles){.elevation = {.paths = elevation, .geoid_path = "", .horizon_m = 20000},
                            .cover = cover,
                            .cover_table = "",
                            .photo = photo,
                            .seed = 1};
}

static void check_quadrants(const Landscape *land, const SurfaceClass want[4])
{
    /* north-west, north-east, south-west, south-east; 60 m clear of borders, which wander by half a cell of 10 m */
    for (int n = 0; n < 4; n++)
        for (double a = 60; a < 300; a += 17)
            for (double b = 60; b < 300; b += 17)
                assert_int_equal(landscape_surface(land, n & 1 ? a : -a, n & 2 ? -b : b), want[n]);
}

static void classes_come_from_the_codes(void **state)
{
    (void)state;
    static const struct {
        Painter     *paint;
        const char  *table;
        SurfaceClass want[4];
    } kinds[] = {
        {quadrants, "worldcover", {SURFACE_FOREST_BROADLEAF, SURFACE_GRASS, SURFACE_BUILT, SURFACE_WATER}},
        {nlcd_codes, "nlcd", {SURFACE_FOREST_CONIFER, SURFACE_GRASS, SURFACE_BUILT, SURFACE_WATER}},
        {fuel_codes, "fbfm40", {SURFACE_FOREST_CONIFER, SURFACE_DRY_GRASS, SURFACE_BUILT, SURFACE_WATER}},
        {dynamic_codes, "dynamicworld", {SURFACE_FOREST_BROADLEAF, SURFACE_CROP, SURFACE_BUILT, SURFACE_WATER}},
        {corine_numbers, "corine", {SURFACE_FOREST_CONIFER, SURFACE_GRASS, SURFACE_BUILT, SURFACE_WATER}},
        {corine_classes, "corine", {SURFACE_FOREST_CONIFER, SURFACE_GRASS, SURFACE_BUILT, SURFACE_WATER}},
    };
    const LocalFrame frame = centre_frame();
    char             elevation[64], cover[64];
    write_sheet(elevation, "level", level_ground);
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        Landscape       land = {0};
        LandscapeReport report;
        write_sheet(cover, "cover", kinds[k].paint);
        const LandscapeFiles files = files_of(elevation, cover, "");
        assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_OK);
        assert_string_equal(report.cover.table, kinds[k].table);
        CHECK(report.cover.unknown == 0 && report.cover.band == 1);
        check_quadrants(&land, kinds[k].want);
        CHECK_NEAR(report.cover.share[kinds[k].want[0]], 0.25,
                   0.03); /* cells of 10 m along a rim turned by 3 minutes */
        /* beyond the sheet something grows all the same */
        CHECK(landscape_surface(&land, 2000, 2000) != SURFACE_NONE);
        landscape_destroy(&land);
    }
}

static void tables_can_be_named_and_their_faults_are_told(void **state)
{
    (void)state;
    const LocalFrame frame = centre_frame();
    char             elevation[64], cover[64], table[text_file_size];
    Landscape        land = {0};
    LandscapeReport  report;
    log_set_sink(check_listen, NULL);
    write_sheet(elevation, "level", level_ground);
    write_sheet(cover, "cover", foreign_codes);
    LandscapeFiles files = files_of(elevation, cover, "");
    assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "terrain.cover_table") && !land.cover);

    text_file(table, "code, surface\n210, sand\n215, snow\n220, wetland\n");
    files.cover_table = table;
    assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_OK);
    CHECK(report.cover.share[SURFACE_SAND] > 0.3 && report.cover.unknown > 1900 && report.cover.unknown < 2200);
    landscape_destroy(&land);
    remove(table);

    static const char *const bad[] = {"code, surface\n210, moonrock\n", "code, surface\n210, sand\n210, snow\n",
                                      "code, surface\n1e9, sand\n", "code, cover\n210, sand\n"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        text_file(table, bad[k]);
        assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_BAD_VALUE);
        CHECK(!land.cover);
        remove(table);
    }
    files.cover_table = "worldcover";
    files.cover_band = 2;
    assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "terrain.cover_band"));
    log_set_sink(NULL, NULL);
}

/* IEC 61966-2-1 by hand: 206/255 -> 0.617207, 41/255 -> 0.022174: octets that five bits hold (photo.h). */
static const double bright = 0.617207, dark = 0.022174;

static void a_photograph_is_relative_to_its_class(void **state)
{
    (void)state;
    const LocalFrame frame = centre_frame();
    char             elevation[64], cover[64], sheet[3][64], photo[64];
    Landscape        land = {0};
    LandscapeReport  report;
    write_sheet(elevation, "level", level_ground);
    write_sheet(cover, "cover", grassland);
    write_sheet(sheet[0], "red", west_bright);
    write_sheet(sheet[1], "green", north_bright);
    write_sheet(sheet[2], "blue", chess);
    write_photo(photo, "photo", sheet);
    const LandscapeFiles files = files_of(elevation, cover, photo);
    assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_OK);

    /* half bright, half dark: the class's mean is between, and each half its ratio to it; octets hold 0.5 % */
    const double mean = 0.5 * (bright + dark);
    float        f[albedo_channels];
    landscape_albedo(f, &land, SURFACE_GRASS, -150, 150, 10);
    CHECK_NEAR((double)f[albedo_red], bright / mean, 0.02);
    CHECK_NEAR((double)f[albedo_green], bright / mean, 0.02);
    landscape_albedo(f, &land, SURFACE_GRASS, 150, 150, 10);
    CHECK_NEAR((double)f[albedo_red], dark / mean, 0.02); /* east: not mirrored */
    CHECK_NEAR((double)f[albedo_green], bright / mean, 0.02);
    landscape_albedo(f, &land, SURFACE_GRASS, -150, -150, 10);
    CHECK_NEAR((double)f[albedo_green], dark / mean, 0.02); /* south: not upside down */
    /* the chess board is gone once the footprint is eight of its fields */
    landscape_albedo(f, &land, SURFACE_GRASS, -150, -150, 80);
    CHECK_NEAR((double)f[albedo_blue], 1, 0.03);
    CHECK_NEAR((double)f[albedo_all], ((double)f[0] + (double)f[1] + (double)f[2]) / 3, 1e-6);

    /* over the whole class the mean is 1 a channel */
    double sum[3] = {0};
    int    count = 0;
    for (double x_m = -300; x_m < 300; x_m += 3.7)
        for (double y_m = -300; y_m < 300; y_m += 3.7, count++) {
            landscape_albedo(f, &land, SURFACE_GRASS, x_m, y_m, 4);
            for (int c = 0; c < 3; c++) sum[c] += (double)f[c];
        }
    for (int c = 0; c < 3; c++) CHECK_NEAR(sum[c] / count, 1, 0.02); /* 600 m of 640; octets */
    landscape_albedo(f, &land, SURFACE_GRASS, 5000, 0, 10);
    for (int c = 0; c < albedo_channels; c++) CHECK(f[c] == 1);
    landscape_destroy(&land);
}

/* Real lidar: height, class and colour at places against the files, read by GDAL's own tool in the files' own pixels.
 */
static void autzen_agrees_with_gdallocationinfo(void **state)
{
    (void)state;
    char dtm[512], cover[512], photo[512], command[1200];
    if (!reference_path(dtm, "terrain/autzen/autzen_dtm_1m.tif") ||
        !reference_path(cover, "terrain/autzen/autzen_cover_1m.tif") ||
        !reference_path(photo, "terrain/autzen/autzen_rgb_1m.tif"))
        skip();
    if (system("command -v gdallocationinfo >/dev/null") != 0) {
        printf("skipped: apt-get install gdal-bin for gdallocationinfo\n");
        skip();
    }
    Landscape        land = {0};
    LandscapeReport  report;
    const LocalFrame frame = centre_frame();
    LandscapeFiles   files = files_of(dtm, cover, photo);
    assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_OK);

    enum { places = 300 };
    char input[64];
    snprintf(input, sizeof input, "/tmp/pitviper-places-%d", (int)getpid());
    FILE  *list = fopen(input, "w");
    double x_m[places], y_m[places];
    CHECK(list);
    for (int n = 0; n < places; n++) {
        double   p_enu[3], p_ecef[3];
        Geodetic place;
        x_m[n] = p_enu[0] = -400 + 800 * random_uniform(5, 1, 0, (uint64_t)n);
        y_m[n] = p_enu[1] = -500 + 1000 * random_uniform(5, 2, 0, (uint64_t)n);
        p_enu[2] = elevation_height(&land.elevation, x_m[n], y_m[n], NULL);
        ecef_from_enu(p_ecef, &frame, p_enu);
        assert_int_equal(geodetic_from_ecef(&place, p_ecef), STATUS_OK);
        fprintf(list, "%.12f %.12f\n", place.lon_rad / rad_per_deg, place.lat_rad / rad_per_deg);
    }
    fclose(list);
    static const int code_of[] = {[SURFACE_FOREST_BROADLEAF] = 10,
                                  [SURFACE_SCRUB] = 20,
                                  [SURFACE_GRASS] = 30,
                                  [SURFACE_BUILT] = 50,
                                  [SURFACE_BARE_SOIL] = 60};
    int              agree = 0, asked = 0;
    snprintf(command, sizeof command, "gdallocationinfo -valonly -wgs84 '%s' < %s", cover, input);
    FILE *answer = popen(command, "r");
    for (int n = 0; n < places; n++) {
        int code;
        CHECK(fscanf(answer, "%d", &code) == 1);
        const SurfaceClass surface = landscape_surface(&land, x_m[n], y_m[n]);
        if (code == 0) continue;
        asked++;
        agree += (size_t)surface < sizeof code_of / sizeof *code_of && code_of[surface] == code;
    }
    pclose(answer);
    /* nearest of nearest: where the 1 m cells of ENU and of UTM do not overlap, and the class changes from cell to cell
     */
    print_message("cover agrees at %d of %d places\n", agree, asked);
    CHECK(agree > 0.85 * asked);

    /* colour: the red octets' linear light and the albedo go together as they must within one class */
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    int    count = 0;
    snprintf(command, sizeof command, "gdallocationinfo -valonly -b 1 -wgs84 '%s' < %s", photo, input);
    answer = popen(command, "r");
    for (int n = 0; n < places; n++) {
        int   octet;
        float f[albedo_channels];
        CHECK(fscanf(answer, "%d", &octet) == 1);
        landscape_albedo(f, &land, SURFACE_GRASS, x_m[n], y_m[n], 1);
        const double a = pow((octet / 255.0 + 0.055) / 1.055, 2.4), b = (double)f[albedo_red];
        sx += a, sy += b, sxx += a * a, syy += b * b, sxy += a * b, count++;
    }
    pclose(answer);
    remove(input);
    const double r = (count * sxy - sx * sy) / sqrt((count * sxx - sx * sx) * (count * syy - sy * sy));
    print_message("red: correlation %.3f over %d places\n", r, count);
    CHECK(r > 0.9); /* nearest against bilinear pixels; mirrored or a pixel row off by 10 m it is below 0.5 */
    landscape_destroy(&land);
}

static int remove_sheets(void **state)
{
    (void)state;
    char command[200];
    snprintf(command, sizeof command, "rm -f /tmp/pitviper-%d-*", (int)getpid());
    return system(command);
}

/* A road and a river of culture lie over the classes of files, as wide as they are; a building does not. */
static void culture_lies_on_them(void **state)
{
    (void)state;
    static const double road[2][2] = {{-250, -200}, {250, -200}}, river[2][2] = {{100, -250}, {100, 250}};
    static const double house[4][2] = {{-150, 100}, {-130, 100}, {-130, 120}, {-150, 120}};
    const LocalFrame    frame = centre_frame();
    const SurfaceClass  bare[4] = {SURFACE_FOREST_BROADLEAF, SURFACE_GRASS, SURFACE_BUILT, SURFACE_WATER};
    Landscape           land = {0};
    LandscapeReport     report;
    Culture             c = {0};
    char                elevation[64], cover[64];
    write_sheet(elevation, "level", level_ground);
    write_sheet(cover, "cover", quadrants);
    const LandscapeFiles files = files_of(elevation, cover, "");
    assert_int_equal(landscape_import(&land, &report, &files, &frame, NULL, 0), STATUS_OK);
    CHECK(culture_add_line(&c, &(CultureLine){.width_m = 8, .surface = SURFACE_ROAD}, road, 2) == STATUS_OK &&
          culture_add_line(&c, &(CultureLine){.width_m = 12, .surface = SURFACE_WATER}, river, 2) == STATUS_OK &&
          culture_add_building(&c, &(Building){.eaves_m = 4, .ridge_m = 7}, house, 4) == STATUS_OK);
    assert_int_equal(culture_index(&c), STATUS_OK);
    culture_lay(&land, &c);
    for (double x = -240; x < 80; x += 7) {
        CHECK(landscape_surface(&land, x, -196.1) == SURFACE_ROAD &&
              landscape_surface(&land, x, -203.9) == SURFACE_ROAD);
        if (fabs(x) < 60) continue;
        const SurfaceClass beside = x < 0 ? SURFACE_BUILT : SURFACE_WATER;
        CHECK(landscape_surface(&land, x, -195.9) == beside && landscape_surface(&land, x, -204.1) == beside);
    }
    for (double y = 60; y < 240; y += 7) {
        CHECK(landscape_surface(&land, 94.1, y) == SURFACE_WATER &&
              landscape_surface(&land, 105.9, y) == SURFACE_WATER);
        CHECK(landscape_surface(&land, 93.9, y) == SURFACE_GRASS &&
              landscape_surface(&land, 106.1, y) == SURFACE_GRASS);
    }
    CHECK(landscape_surface(&land, -140, 110) == SURFACE_FOREST_BROADLEAF);
    culture_lay(&land, NULL);
    check_quadrants(&land, bare);
    landscape_destroy(&land);
    culture_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(classes_come_from_the_codes),
        cmocka_unit_test(tables_can_be_named_and_their_faults_are_told),
        cmocka_unit_test(culture_lies_on_them),
        cmocka_unit_test(a_photograph_is_relative_to_its_class),
        cmocka_unit_test(autzen_agrees_with_gdallocationinfo),
    };
    return cmocka_run_group_tests(tests, NULL, remove_sheets);
}
