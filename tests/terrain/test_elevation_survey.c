/* tests/terrain/test_elevation_survey.c: files of heights that do not say what they hold, or say it oddly: taken
 * rightly, or refused by name. The answers are the heights that the files were written from. */
#include "tests/check.h"

#include "terrain/import/terrain_import.h"
#include "terrain/from_files/elevation_import.h"

#include <unistd.h>

enum { nx = 200, ny = 160 };

static char folder[temp_path_size];
static char heard_all[8000]; /* every warning and error of a case */

static void listen_all(void *user, LogLevel level, const char *line)
{
    (void)user;
    const size_t used = strlen(heard_all);
    if (level >= LOG_WARN) snprintf(heard_all + used, sizeof heard_all - used, "%s\n", line);
}

/* ---- files: raw numbers, and a VRT that says of them what a case wants ------------------------- */

static double hills(int i, int j) { return 300 + 60 * sin(0.03 * i) * cos(0.025 * j); }
static bool   in_hole(int i, int j) { return abs(i - 60) < 12 && abs(j - 50) < 9; }

static double plain(int i, int j) { return hills(i, j); }
static double hole_9999(int i, int j) { return in_hole(i, j) ? -9999 : hills(i, j); }
static double hole_999(int i, int j) { return in_hole(i, j) ? -999 : hills(i, j); }
static double hole_0(int i, int j) { return in_hole(i, j) ? 0 : 200 + hills(i, j); }
static double hole_two(int i, int j) { return in_hole(i, j) ? i < 60 ? -9999 : -9998 : hills(i, j); }
static double hole_low(int i, int j) { return in_hole(i, j) ? -32768 : hills(i, j); }
static double mostly_low(int i, int j) { return in_hole(i, j) || i > 155 || i < 50 ? -32767 : hills(i, j); }
static double hole_high(int i, int j) { return in_hole(i, j) ? 1e20 : hills(i, j); }
static double hole_depth(int i, int j) { return in_hole(i, j) ? 9999 : -hills(i, j); }
static double depths(int i, int j) { return -hills(i, j); }
static double in_feet(int i, int j) { return hills(i, j) / 0.3048; }
static double in_us_feet(int i, int j) { return hills(i, j) * 3937 / 1200; }
static double in_cm(int i, int j) { return 100 * hills(i, j); }
static double trench(int i, int j) { return -10900 + 60.0 * i + 0 * j; } /* through -9999, whole, without a void */
static double cliffs(int i, int j) { return hills(i, j) + (i / 20 % 2 ? 250 : 0); }
static double octets(int i, int j) { return (i * 7 + j * 3) % 255; }

typedef struct File {
    const char *type; /* GDAL's */
    double (*z)(int i, int j);
    const char *band;   /* XML of the band */
    const char *srs;    /* NULL: WGS 84; empty: none */
    const char *choice; /* after the name */
    const char *place;  /* geotransform; NULL: about 46 N 11 E */
    int         bands;  /* 0: one */
    const char *colour[4];
} File;

static const double west_deg = 11, north_deg = 46, step_deg = 1e-4;

static size_t write_number(void *out, const char *type, double value)
{
    if (strcmp(type, "Int16") == 0) {
        const int16_t v = (int16_t)lrint(value);
        memcpy(out, &v, sizeof v);
        return sizeof v;
    }
    if (strcmp(type, "Int32") == 0) {
        const int32_t v = (int32_t)lrint(value);
        memcpy(out, &v, sizeof v);
        return sizeof v;
    }
    if (strcmp(type, "Byte") == 0) {
        const uint8_t v = (uint8_t)lrint(value);
        memcpy(out, &v, sizeof v);
        return sizeof v;
    }
    const float v = (float)value;
    memcpy(out, &v, sizeof v);
    return sizeof v;
}

/* `name` with the choice after it. */
static void write_file(char path[temp_name_size + 64], const char *name, const File *f, int west)
{
    char raw[temp_name_size], vrt[temp_name_size];
    snprintf(raw, sizeof raw, "%s/%s.raw", folder, name);
    snprintf(vrt, sizeof vrt, "%s/%s.vrt", folder, name);
    const int bands = f->bands ? f->bands : 1;
    size_t    octets_each = 0;
    FILE     *file = fopen(raw, "wb");
    CHECK(file != NULL);
    for (int n = 0; n < nx * ny; n++) {
        uint8_t number[8];
        octets_each = write_number(number, f->type, f->z(west + n % nx, n / nx));
        CHECK(fwrite(number, octets_each, 1, file) == 1);
    }
    CHECK(fclose(file) == 0);
    file = fopen(vrt, "w");
    CHECK(file != NULL);
    fprintf(file, "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\">\n", nx, ny);
    if (!f->srs || *f->srs) fprintf(file, "<SRS>%s</SRS>\n", f->srs ? f->srs : "EPSG:4326");
    if (!f->place)
        fprintf(file, "<GeoTransform>%.10f,%.10f,0,%.10f,0,%.10f</GeoTransform>\n", west_deg + west * step_deg,
                step_deg, north_deg, -step_deg);
    else if (*f->place) fprintf(file, "<GeoTransform>%s</GeoTransform>\n", f->place);
    for (int b = 0; b < bands; b++)
        fprintf(file,
                "<VRTRasterBand dataType=\"%s\" band=\"%d\" subClass=\"VRTRawRasterBand\">%s%s%s%s\n"
                "<SourceFilename relativeToVRT=\"1\">%s.raw</SourceFilename><ByteOrder>LSB</ByteOrder>"
                "<PixelOffset>%zu</PixelOffset><LineOffset>%zu</LineOffset></VRTRasterBand>\n",
                f->type, b + 1, f->colour[b] ? "<ColorInterp>" : "", f->colour[b] ? f->colour[b] : "",
                f->colour[b] ? "</ColorInterp>" : "", f->band ? f->band : "", name, octets_each, nx * octets_each);
    fprintf(file, "</VRTDataset>\n");
    CHECK(fclose(file) == 0);
    snprintf(path, temp_name_size + 64, "%s%s", vrt, f->choice ? f->choice : "");
}

/* Where post i, j of the file lies, and the ground there; NaN: the import refused. */
static double ground_at(const char *paths, int i, int j, ElevationReport *report)
{
    Elevation            elevation = {0};
    LocalFrame           frame;
    const Geodetic       middle = {(north_deg - (j + 0.5) * step_deg) * rad_per_deg,
                                   (west_deg + (i + 0.5) * step_deg) * rad_per_deg, 0};
    const ElevationFiles files = {.paths = paths, .geoid_path = "", .vertical = ELEVATION_ELLIPSOID, .horizon_m = 2000};
    assert_int_equal(local_frame_at(&frame, &middle), STATUS_OK);
    *heard_all = 0;
    if (elevation_import(&elevation, report, &files, &frame, NULL, 0) != STATUS_OK) return NAN;
    const double h_m = elevation_height(&elevation, 0, 0, NULL);
    elevation_destroy(&elevation);
    return h_m;
}

/* ---- what is taken rightly --------------------------------------------------------------------- */

static void numbers_are_read_as_what_they_are(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        File        file;
        const char *said;   /* NULL: nothing may be said */
        double      hole_m; /* in the middle of the hole; NaN: among the hills' own heights */
        double      off_m;  /* of the ground beside the formula */
    } cases[] = {
        {"plain", {.type = "Float32", .z = plain}, NULL, NAN, 0},
        {"int16 -9999 without a tag", {.type = "Int16", .z = hole_9999}, "-9999", NAN, 0},
        {"a tag NaN and -9999",
         {.type = "Float32", .z = hole_9999, .band = "<NoDataValue>nan</NoDataValue>"},
         "-9999",
         NAN,
         0},
        {"-9999 declared", {.type = "Int16", .z = hole_9999, .band = "<NoDataValue>-9999</NoDataValue>"}, NULL, NAN, 0},
        {"-999", {.type = "Float32", .z = hole_999}, "-999", NAN, 0},
        {"0 below a plateau", {.type = "Int16", .z = hole_0}, "posts of 0", NAN, 200},
        {"-9999 and -9998", {.type = "Float32", .z = hole_two}, "-9999, -9998", NAN, 0},
        {"-32768", {.type = "Int16", .z = hole_low}, "no heights on Earth", NAN, 0},
        {"-32767 on half of it and more", {.type = "Int16", .z = mostly_low}, "no heights on Earth", NAN, 0},
        {"1e20", {.type = "Float32", .z = hole_high}, "no heights on Earth", NAN, 0},
        {"named by the user", {.type = "Int16", .z = hole_9999, .choice = "@nodata=-9999"}, NULL, NAN, 0},
        {"the user says it is none", {.type = "Int16", .z = hole_9999, .choice = "@nodata=none"}, NULL, -9999, 0},
        {"cliffs of 250 m", {.type = "Float32", .z = cliffs}, NULL, NAN, 250},
        {"feet, stated", {.type = "Float32", .z = in_feet, .band = "<UnitType>ft</UnitType>"}, NULL, NAN, 0},
        {"feet of the vertical system", {.type = "Float32", .z = in_us_feet, .srs = "EPSG:4326+6360"}, NULL, NAN, 0},
        {"feet, named", {.type = "Float32", .z = in_feet, .choice = "@ft"}, NULL, NAN, 0},
        {"feet, an unknown unit but named",
         {.type = "Float32", .z = in_us_feet, .band = "<UnitType>foots</UnitType>", .choice = "@us-ft"},
         NULL,
         NAN,
         0},
        {"centimetres, named", {.type = "Int32", .z = in_cm, .choice = "@cm"}, NULL, NAN, 0},
        {"depths by the vertical system", {.type = "Float32", .z = depths, .srs = "EPSG:4326+5715"}, NULL, NAN, 0},
        {"depths with a void", {.type = "Float32", .z = hole_depth, .srs = "EPSG:4326+5715"}, "9999", NAN, 0},
        {"depths by `positive`",
         {.type = "Float32", .z = depths, .band = "<Metadata><MDI key=\"positive\">down</MDI></Metadata>"},
         NULL,
         NAN,
         0},
        {"depths, named", {.type = "Float32", .z = depths, .choice = "@down"}, NULL, NAN, 0},
        {"heights in spite of it",
         {.type = "Float32", .z = plain, .srs = "EPSG:4326+5715", .choice = "@up"},
         NULL,
         NAN,
         0},
        {"without a coordinate system, named",
         {.type = "Float32", .z = plain, .srs = "", .choice = "@srs=EPSG:4326"},
         NULL,
         NAN,
         0},
        {"scaled", {.type = "Int32", .z = in_cm, .band = "<Scale>0.01</Scale>"}, NULL, NAN, 0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char            path[temp_name_size + 64];
        ElevationReport report;
        write_file(path, "case", &cases[k].file, 0);
        const double tolerance = strncmp(cases[k].file.type, "Int", 3) == 0 ? 0.6 : 0.1;
        const double got = ground_at(path, 150, 100, &report), want = hills(150, 100) + cases[k].off_m;
        if (!(fabs(got - want) < tolerance)) fail_msg("%s: %g m, not %g: %s", cases[k].what, got, want, heard_all);
        if (cases[k].said ? !strstr(heard_all, cases[k].said) : *heard_all != 0)
            fail_msg("%s: said `%s`", cases[k].what, heard_all);
        const double hole = ground_at(path, 60, 50, &report), base = cases[k].off_m < 200 ? 0 : cases[k].off_m;
        if (isnan(cases[k].hole_m) ? !(hole > base + 230 && hole < base + 370) : !(fabs(hole - cases[k].hole_m) < 1))
            fail_msg("%s: %g m in the hole", cases[k].what, hole);
    }
}

static double nothing(int i, int j) { return (void)i, (void)j, -9999; }

/* A tile without a height beside one that has them: the other is used; alone it is an error. */
static void a_tile_of_voids_alone_is_none(void **state)
{
    (void)state;
    char            void_path[temp_name_size + 64], path[temp_name_size + 64], both[2 * temp_name_size + 200];
    ElevationReport report;
    const File      f = {.type = "Int16", .z = nothing}, g = {.type = "Float32", .z = plain};
    write_file(void_path, "nothing", &f, 0);
    write_file(path, "something", &g, 0);
    CHECK(isnan(ground_at(void_path, 100, 80, &report)) && strstr(heard_all, "no post"));
    snprintf(both, sizeof both, "%s,%s", void_path, path);
    CHECK_NEAR(ground_at(both, 100, 80, &report), hills(100, 80), 0.1);
    CHECK(strstr(heard_all, "-9999 alone") != NULL);
}

static void a_trench_is_no_void(void **state)
{
    (void)state;
    char            path[temp_name_size + 64];
    ElevationReport report;
    const File      f = {.type = "Int16", .z = trench};
    write_file(path, "trench", &f, 0);
    CHECK_NEAR(ground_at(path, 15, 80, &report), trench(15, 80), 1); /* about -9999 */
    if (*heard_all) fail_msg("said %s", heard_all);
}

/* Two sheets of one grid, each with a collar of -9999 that the other fills. */
static double collar_east(int i, int j) { return i >= 120 ? -9999 : hills(i, j); }
static double collar_west(int i, int j) { return i < 110 ? -9999 : hills(i, j); }

static void a_void_of_one_sheet_does_not_hide_another(void **state)
{
    (void)state;
    char            one[temp_name_size + 64], two[temp_name_size + 64], both[2 * temp_name_size + 200];
    ElevationReport report;
    const File      a = {.type = "Float32", .z = collar_east}, b = {.type = "Float32", .z = collar_west};
    write_file(one, "one", &a, 0);
    write_file(two, "two", &b, 30); /* 30 px east */
    snprintf(both, sizeof both, "%s,%s", one, two);
    CHECK_NEAR(ground_at(both, 150, 80, &report), hills(150, 80), 0.1);
    CHECK_NEAR(ground_at(both, 115, 80, &report), hills(115, 80), 0.1);
    CHECK(strstr(heard_all, "-9999") != NULL);
    assert_int_equal(report.grids, 1);
}

/* ---- what is refused ---------------------------------------------------------------------------- */

static void what_cannot_be_heights_is_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        File        file;
        const char *said[3];
    } cases[] = {
        {"an unknown unit",
         {.type = "Float32", .z = plain, .band = "<UnitType>furlong</UnitType>"},
         {"'furlong'", "@us-ft", "--unit"}},
        {"a coordinate system in feet, heights in what?",
         {.type = "Float32", .z = plain, .srs = "EPSG:2278", .place = "3000000,30,0,13800000,0,-30"},
         {"US survey foot", "@us-ft", "--unit"}},
        {"centimetres", {.type = "Int32", .z = in_cm}, {"no heights on Earth", "@cm", "--unit"}},
        {"a photograph",
         {.type = "Byte", .z = octets, .bands = 3, .colour = {"Red", "Green", "Blue"}},
         {"photograph", "--photo", ":1"}},
        {"of sixteen bits",
         {.type = "Int16", .z = plain, .bands = 3, .colour = {"Red", "Green", "Blue"}},
         {"photograph", "--photo", ":1"}},
        {"with a palette", {.type = "Byte", .z = octets, .colour = {"Palette"}}, {"photograph", "--photo", ":1"}},
        {"grey", {.type = "Byte", .z = octets, .colour = {"Gray"}}, {"photograph", "--photo", ":1"}},
        {"no coordinate system", {.type = "Float32", .z = plain, .srs = ""}, {"coordinate system", "@srs=EPSG", NULL}},
        {"no place", {.type = "Float32", .z = plain, .place = ""}, {"corners", "a_ullr", NULL}},
        {"the place of a file that has none",
         {.type = "Float32", .z = plain, .place = "0,1,0,0,0,1"},
         {"corners", "a_ullr", NULL}},
        {"the same, upwards",
         {.type = "Float32", .z = plain, .srs = "EPSG:32633", .place = "0,1,0,0,0,-1"},
         {"corners", "a_ullr", NULL}},
        {"a choice that is none", {.type = "Float32", .z = plain, .choice = "@frob"}, {"@frob", "geoid", NULL}},
        {"a CRS that is a file",
         {.type = "Float32", .z = plain, .choice = "@srs=/etc/passwd"},
         {"EPSG:32633", NULL, NULL}},
        {"a CRS that is none",
         {.type = "Float32", .z = plain, .choice = "@srs=EPSG:999999"},
         {"EPSG:999999", NULL, NULL}},
        {"a band that it lacks", {.type = "Float32", .z = plain, .choice = ":7"}, {"not 7", NULL, NULL}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char            path[temp_name_size + 64];
        ElevationReport report;
        write_file(path, "bad", &cases[k].file, 0);
        const double got = ground_at(path, 150, 100, &report);
        if (!isnan(got)) fail_msg("%s: taken, %g m", cases[k].what, got);
        for (int n = 0; n < 3 && cases[k].said[n]; n++)
            if (!strstr(heard_all, cases[k].said[n]))
                fail_msg("%s: said `%s`, without %s", cases[k].what, heard_all, cases[k].said[n]);
    }
    /* its octets are heights when the user says so */
    char            path[temp_name_size + 64];
    ElevationReport report;
    const File      grey = {.type = "Byte", .z = octets, .colour = {"Gray"}, .choice = ":1@m"};
    write_file(path, "grey", &grey, 0);
    CHECK(!isnan(ground_at(path, 150, 100, &report)));
}

/* ---- large files, of which a part is looked at ---------------------------------------------------- */

/* A VRT that shows a small raster 40 times as large: 8000 x 6400 posts. */
static void write_large(char path[temp_name_size + 64], const char *name, double (*z)(int i, int j))
{
    const File f = {.type = "Float32", .z = z};
    char       small[temp_name_size + 64];
    write_file(small, name, &f, 0);
    snprintf(path, temp_name_size + 64, "%s/%s-large.vrt", folder, name);
    FILE *file = fopen(path, "w");
    CHECK(file != NULL);
    fprintf(file,
            "<VRTDataset rasterXSize=\"%d\" rasterYSize=\"%d\"><SRS>EPSG:4326</SRS>"
            "<GeoTransform>%.10f,%.12f,0,%.10f,0,%.12f</GeoTransform>"
            "<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"1\">%s.vrt"
            "</SourceFilename><SourceBand>1</SourceBand><SrcRect xOff=\"0\" yOff=\"0\" xSize=\"%d\" ySize=\"%d\"/>"
            "<DstRect xOff=\"0\" yOff=\"0\" xSize=\"%d\" ySize=\"%d\"/></SimpleSource></VRTRasterBand></VRTDataset>",
            40 * nx, 40 * ny, west_deg, step_deg / 40, north_deg, -step_deg / 40, name, nx, ny, 40 * nx, 40 * ny);
    CHECK(fclose(file) == 0);
}

static double corner_void(int i, int j) { return i + j < 30 ? -1234 : hills(i, j); }
/* Windows of 512 posts lie every 1070 here: those of a column see the lake or the plateau, none its shore. */
static double lake(int i, int j) { return (void)j, i < 14 ? -430.5 : i > 25 ? 400 + 0.1 * i : -430.5 + (i - 14) * 69; }
static double lake_void(int i, int j) { return (void)j, i < 14 ? -9999 : i > 25 ? 400 + 0.1 * i : -9999; }

static Status survey_of(ElevationSurvey *out, const char *path)
{
    RasterSet set = {0};
    *heard_all = 0;
    assert_int_equal(raster_set_open(&set, path, "test"), STATUS_OK);
    const Status status = elevation_survey(out, &set.raster[0], "test", NULL);
    raster_set_close(&set);
    return status;
}

static void of_large_files_windows_are_looked_at(void **state)
{
    (void)state;
    char            path[temp_name_size + 64];
    ElevationSurvey s;
    write_large(path, "corner", corner_void);
    assert_int_equal(survey_of(&s, path), STATUS_OK);
    CHECK(!s.whole && s.suspects == 1 && s.suspect[0] == -1234 && strstr(heard_all, "at least"));
    CHECK(s.low_m > 230 && s.high_m < 370);
    write_large(path, "lake", lake); /* flat, alone among what was seen, and no void */
    assert_int_equal(survey_of(&s, path), STATUS_OK);
    CHECK(!s.whole && s.suspects == 0 && !*heard_all);
    CHECK_NEAR(s.low_m, -430.5, 1e-3);
    write_large(path, "lakevoid", lake_void);
    assert_int_equal(survey_of(&s, path), STATUS_OK);
    CHECK(s.suspects == 1 && s.suspect[0] == -9999);
}

static void threads_see_the_same(void **state)
{
    (void)state;
    char            path[temp_name_size + 64];
    ElevationSurvey one, more;
    RasterSet       set = {0};
    Pool           *pool;
    const File      f = {.type = "Float32", .z = hole_two};
    write_file(path, "threads", &f, 0);
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    assert_int_equal(survey_of(&one, path), STATUS_OK);
    assert_int_equal(raster_set_open(&set, path, "test"), STATUS_OK);
    assert_int_equal(elevation_survey(&more, &set.raster[0], "test", pool), STATUS_OK);
    raster_set_close(&set);
    pool_destroy(pool);
    CHECK(one.low_m == more.low_m && one.high_m == more.high_m && one.suspects == more.suspects &&
          one.suspect_posts == more.suspect_posts && one.suspect_posts == 23 * 17 && one.gap_m == more.gap_m);
}

/* ---- options ------------------------------------------------------------------------------------- */

static void options_are_said_after_names_that_lack_them(void **state)
{
    (void)state;
    char           path[temp_name_size + 64], list[4096], text[8192], want[4096];
    TerrainOptions o, again;
    const char    *why;
    int            line;
    const File     f = {.type = "Float32", .z = plain};
    write_file(path, "named", &f, 0);
    terrain_options_default(&o);
    CHECK(terrain_options_set(&o, &why, "unit", "us-ft") && terrain_options_set(&o, &why, "srs", "EPSG:32633+5773") &&
          terrain_options_set(&o, &why, "nodata", "-1"));
    CHECK(!terrain_options_set(&o, &why, "unit", "furlong") && strstr(why, "us-ft"));
    CHECK(!terrain_options_set(&o, &why, "unit", "geoid"));
    CHECK(!terrain_options_set(&o, &why, "srs", "+init=/etc/passwd"));
    CHECK(!terrain_options_set(&o, &why, "srs", "EPSG:1,2"));
    CHECK(!terrain_options_set(&o, &why, "nodata", "some"));
    snprintf(list, sizeof list, "%s, %s@m@nodata=none", path, path);
    CHECK(terrain_options_set(&o, &why, "elevation", list));
    snprintf(want, sizeof want, "%s@us-ft@srs=EPSG:32633+5773@nodata=-1,%s@m@nodata=none@srs=EPSG:32633+5773", path,
             path);
    CHECK(terrain_options_sources(list, sizeof list, &o, o.elevation));
    assert_string_equal(list, want);
    CHECK(!terrain_options_sources(list, strlen(want), &o, o.elevation));
    CHECK(terrain_options_text(text, sizeof text, &o) && terrain_options_parse(&again, &why, &line, text));
    assert_string_equal(again.unit, "us-ft");
    assert_string_equal(again.srs, "EPSG:32633+5773");
    assert_string_equal(again.nodata, "-1");
}

static void choices_stand_after_names_of_any_kind(void **state)
{
    (void)state;
    char        odd[temp_name_size], path[temp_name_size + 64];
    const char *why;
    snprintf(odd, sizeof odd, "%s/a@b:2", folder);
    FILE *file = fopen(odd, "w");
    CHECK(file && fclose(file) == 0);
    static const struct {
        const char *after;
        bool        good;
        int         band, sense;
        const char *unit;
    } cases[] = {{"", true, 0, 0, ""},          {"@ft", true, 0, 0, "ft"},
                 {":3@down", true, 3, -1, ""},  {"@up@us-ft", true, 0, 1, "us-ft"},
                 {"@", false, 0, 0, ""},        {"@ft@", false, 0, 0, "ft"},
                 {"@nodata=", false, 0, 0, ""}, {":0", true, 0, 0, ""},
                 {"@srs=", false, 0, 0, ""}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        RasterChoice c;
        snprintf(path, sizeof path, "%s%s", odd, cases[k].after);
        const bool good = raster_choice_take(&c, &why, path);
        if (good != cases[k].good) fail_msg("`%s`: %d", cases[k].after, good);
        if (!good) continue;
        CHECK(c.band == cases[k].band && c.sense == cases[k].sense && strcmp(c.unit, cases[k].unit) == 0);
        if (cases[k].after[0] != ':' || c.band) assert_string_equal(path, odd);
    }
    RasterChoice c;
    snprintf(path, sizeof path, "NETCDF:\"/no/where.nc\":depth@down@geoid"); /* GDAL's own */
    CHECK(raster_choice_take(&c, &why, path) && c.sense == -1 && c.vertical == RASTER_VERTICAL_GEOID);
    assert_string_equal(path, "NETCDF:\"/no/where.nc\":depth");
}

static int set_up(void **state)
{
    (void)state;
    log_set_sink(listen_all, NULL);
    return temp_folder(folder) ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    char line[temp_path_size + 20];
    snprintf(line, sizeof line, "rm -rf %s", folder);
    return system(line) == 0 ? 0 : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_read_as_what_they_are),
        cmocka_unit_test(a_tile_of_voids_alone_is_none),
        cmocka_unit_test(a_trench_is_no_void),
        cmocka_unit_test(a_void_of_one_sheet_does_not_hide_another),
        cmocka_unit_test(what_cannot_be_heights_is_refused_by_name),
        cmocka_unit_test(of_large_files_windows_are_looked_at),
        cmocka_unit_test(threads_see_the_same),
        cmocka_unit_test(options_are_said_after_names_that_lack_them),
        cmocka_unit_test(choices_stand_after_names_of_any_kind),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
