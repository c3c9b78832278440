/* Hostile files with vectors: names that are no files, spoilt and cut ones, a milliard of corners, archives, and a
 * reader that a file has taken over: the program stays, says what is wrong, and takes what is as any record. labels:
 * small */
#include "tests/terrain/vector_lab.h"

/* Files of sound houses in five formats, which tests spoil. */
static int open_sound(void **state)
{
    if (open_lab(state) != 0) return 1;
    begin_file();
    for (int n = 0; n < 60; n++) {
        const double x = 3000 * cos(n), y = 3000 * sin(1.7 * n);
        const double p[5][2] = {{x, y}, {x + 12, y}, {x + 12, y + 9}, {x, y + 9}, {x, y}};
        add_feature("Polygon", "[[", "]]",
                    n % 2 ? "\"building\":\"house\",\"height\":\"9\"" : "\"building\":\"yes\",\"osm_id\":\"5\"", p, 5);
    }
    end_file("a.geojson");
    if (!has_judge()) return 0; /* spoilt_files says so */
    convert("a.gpkg a.geojson");
    convert("a.shp a.geojson");
    convert("a.fgb -lco SPATIAL_INDEX=NO a.geojson");
    return 0;
}

static Status quiet_open(const char *names)
{
    Culture       c = {0};
    CultureReport r;
    log_set_sink(check_listen, NULL);
    *check_said = 0;
    const Status status = open_names(&c, &r, names, NULL);
    log_set_sink(NULL, NULL);
    culture_free(&c);
    return status;
}

static Status count_part(void *user, const VectorPart *part)
{
    ++*(int *)user;
    return part->shape == VECTOR_POLYGON && part->corners == 4 ? STATUS_OK : STATUS_BAD_VALUE;
}

static long status_of(pid_t process, const char *field)
{
    char path[64], line[256];
    long value = -1;
    snprintf(path, sizeof path, "/proc/%d/status", (int)process);
    FILE *status = fopen(path, "r");
    while (status && fgets(line, sizeof line, status))
        if (strncmp(line, field, strlen(field)) == 0) value = strtol(line + strlen(field), NULL, 10);
    if (status) fclose(status);
    return value;
}

/* The process is the confined one of rasters, and leaves nothing behind: a GeoPackage is a database that others write
 * to when they read it. */
static void its_reader_is_confined(void **state)
{
    (void)state;
    const double all[4] = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};
    char         name[128], list[2][4096] = {"", ""};
    need_judge();
    path_of(name, "a.gpkg");
    for (int k = 0; k < 2; k++) {
        char  line[160];
        FILE *files;
        snprintf(line, sizeof line, "cd %s && ls -l --time-style=full-iso", folder);
        files = popen(line, "r");
        CHECK(files && fread(list[k], 1, sizeof list[k] - 1, files) > 0 && pclose(files) == 0);
        if (k) break;
        Vectors   vectors;
        VectorEnd end;
        int       parts = 0;
        CHECK(vectors_open(&vectors, name, "test") == STATUS_OK && vectors.files == 1 && vectors.layers == 1);
        CHECK(vectors.box_deg[0] < vectors.box_deg[2] && vectors.box_deg[1] < vectors.box_deg[3]);
        const pid_t reader = lab_reader();
        CHECK(status_of(reader, "Seccomp:") == 2 && status_of(reader, "NoNewPrivs:") == 1);
        CHECK(vectors_each(&end, &vectors, all, count_part, &parts, "test") == STATUS_OK);
        CHECK(parts == 60 && end.features == 60 && end.outside == 0 && end.shapeless == 0);
        vectors_close(&vectors);
    }
    assert_string_equal(list[0], list[1]);
}

static void names_that_are_no_files(void **state)
{
    (void)state;
    static const char *const names[] = {"/nowhere.geojson",
                                        "http://127.0.0.1:9/a.geojson",
                                        "/vsicurl/http://127.0.0.1:9/a.geojson",
                                        "nothing.gpkg",
                                        "PG:dbname=x",
                                        "/vsizip//vsicurl/http://127.0.0.1:9/a.zip/b.geojson",
                                        "/vsistdin/",
                                        "/vsicurl_streaming/http://127.0.0.1:9/a.zip"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (quiet_open(names[k]) == STATUS_OK || !strstr(check_said, "terrain.buildings"))
            fail_msg("%s: %s", names[k], check_said);
    save("a.vrt", "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>/vsicurl/http://127.0.0.1:9/a.geojson"
                  "</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
    CHECK(quiet_open("a.vrt") != STATUS_OK && strstr(check_said, "GeoPackage"));
    save("tileset.json", "{\"asset\": {\"version\": \"1.0\"}}");
    CHECK(quiet_open("tileset.json") != STATUS_OK && strstr(check_said, "3D Tiles"));
    save("a.flt", "x");
    CHECK(quiet_open("a.flt") != STATUS_OK && strstr(check_said, "OpenFlight"));
    save("a.b3dm", "b3dm");
    CHECK(quiet_open("a.b3dm") != STATUS_OK && strstr(check_said, "3D Tiles"));
    char path[128];
    path_of(path, "cdb");
    CHECK(mkdir(path, 0700) == 0);
    path_of(path, "cdb/Tiles");
    CHECK(mkdir(path, 0700) == 0);
    path_of(path, "cdb/Metadata");
    CHECK(mkdir(path, 0700) == 0);
    CHECK(quiet_open("cdb") != STATUS_OK && strstr(check_said, "CDB"));
    path_of(path, "pipe.geojson");
    CHECK(mkfifo(path, 0600) == 0);
    CHECK(quiet_open("pipe.geojson") != STATUS_OK);
}

static void same_for_elevation(void **state)
{
    (void)state;
    static const struct {
        const char *name, *word;
    } some[] = {{"tileset.json", "3D Tiles"}, {"a.flt", "OpenFlight"}, {"cdb", "CDB"}};
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        char      path[128];
        RasterSet set = {0};
        path_of(path, some[k].name);
        log_set_sink(check_listen, NULL);
        *check_said = 0;
        CHECK(raster_set_open(&set, path, "terrain.elevation") != STATUS_OK);
        log_set_sink(NULL, NULL);
        if (!strstr(check_said, some[k].word)) fail_msg("%s", check_said);
    }
}

/* A Shapefile of one polygon that declares a milliard of points. */
static void a_milliard_of_corners(void **state)
{
    (void)state;
    LabFile file = {.count = 0};
    char    path[128];
    for (int k = 0; k < 7; k++) lab_number(&file, k == 0 ? 9994 : k == 6 ? 50 + 4 + 26 + 16 : 0, 4, true);
    lab_number(&file, 1000, 4, false), lab_number(&file, 5, 4, false);
    for (int k = 0; k < 8; k++) lab_double(&file, k < 4 ? (k % 2 ? 47 : 13) + k / 2 : 0, false);
    lab_number(&file, 1, 4, true), lab_number(&file, 24 + 16, 4, true);
    lab_number(&file, 5, 4, false);
    for (int k = 0; k < 4; k++) lab_double(&file, (k % 2 ? 47 : 13) + k / 2, false);
    lab_number(&file, 1, 4, false), lab_number(&file, 1000000000, 4, false), lab_number(&file, 0, 4, false);
    for (int k = 0; k < 4; k++) lab_double(&file, 13, false);
    path_of(path, "many.shp");
    lab_save(&file, path);
    save("many.prj",
         "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],"
         "UNIT[\"degree\",0.0174532925199433]]");
    Culture       c = {0};
    CultureReport r;
    log_set_sink(check_listen, NULL);
    const Status status = open_names(&c, &r, "many.shp", NULL);
    log_set_sink(NULL, NULL);
    CHECK(status != STATUS_OK || c.buildings == 0);
    culture_free(&c);
}

/* Sound files with octets turned over or their ends cut off: whatever comes of it, the program stays, and what it takes
 * is as any record. */
static void spoilt_files(void **state)
{
    (void)state;
    static const char *const names[] = {"a.gpkg", "a.shp", "a.dbf", "a.shx", "a.geojson", "a.fgb"};
    static uint8_t           sound[1 << 20], spoilt[1 << 20];
    int                      opened = 0, refused = 0;
    need_judge();
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        char path[128];
        path_of(path, names[k]);
        FILE *file = fopen(path, "rb");
        CHECK(file);
        const size_t count = fread(sound, 1, sizeof sound, file);
        fclose(file);
        for (uint32_t n = 0; n < 12; n++) {
            memcpy(spoilt, sound, count);
            const size_t left = n < 3 ? count * (n + 1) / 4 : count;
            for (uint32_t m = 0; m < 20 && n >= 3; m++) {
                const uint64_t at = m * 1000 + n;
                const size_t   reach = n % 2 ? count : count < 400 ? count : 400;
                spoilt[(size_t)(random_uniform(5, (uint32_t)k, 0, at) * (double)reach)] =
                    (uint8_t)(256 * random_uniform(5, (uint32_t)k, 1, at));
            }
            file = fopen(path, "wb");
            CHECK(file && fwrite(spoilt, 1, left, file) == left && fclose(file) == 0);
            Culture       c = {0};
            CultureReport r;
            log_set_sink(check_listen, NULL);
            const Status status =
                open_names(&c, &r, strstr(names[k], "a.dbf") || strstr(names[k], "a.shx") ? "a.shp" : names[k], NULL);
            log_set_sink(NULL, NULL);
            opened += status == STATUS_OK, refused += status != STATUS_OK;
            for (int b = 0; b < c.buildings; b++)
                CHECK(c.building[b].corners >= 3 && c.building[b].ridge_m <= 850 && c.building[b].eaves_m > 0);
            for (int p = 0; p < c.corners; p++)
                CHECK(fabs(c.corner_m[p][0]) <= 16000 && fabs(c.corner_m[p][1]) <= 16000);
            culture_free(&c);
        }
        file = fopen(path, "wb");
        CHECK(file && fwrite(sound, 1, count, file) == count && fclose(file) == 0);
    }
    CHECK(opened > 5 && refused > 5);
}

/* An archive of 12 kB that holds 12 MB of one feature's blanks, and one that is all blanks. */
static void archives(void **state)
{
    (void)state;
    char line[512];
    snprintf(
        line, sizeof line,
        "cd %s && (printf '{\"type\":\"FeatureCollection\",\"features\":['; head -c 50000000 /dev/zero | tr '\\0' ' ') "
        ">blanks.geojson && gzip -k blanks.geojson && gzip -k a.geojson",
        folder);
    CHECK(system(line) == 0);
    snprintf(line, sizeof line, "/vsigzip/%s/a.geojson.gz", folder);
    CHECK(quiet_open(line) == STATUS_OK);
    snprintf(line, sizeof line, "/vsigzip/%s/blanks.geojson.gz", folder);
    CHECK(quiet_open(line) != STATUS_OK);
}

/* A reader that a file has taken over sends sound and spoilt replies: what is taken is as any record. */
static void whatever_it_sends(void **state)
{
    (void)state;
    enum { rounds = 200 };
    static char   path[4200];
    char          self[4096];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    int           opened = 0, refused = 0, taken = 0;
    CHECK(length > 0);
    self[length] = 0;
    *strrchr(self, '/') = 0;
    snprintf(path, sizeof path, "%s/rasters_hostile", self);
    raster_child_program(path);
    raster_child_patience(0.5);
    log_set_sink(check_listen, NULL);
    for (int n = 0; n < rounds; n++) {
        Culture       c = {0};
        CultureReport r;
        const Status  status = open_names(&c, &r, "a.geojson", NULL);
        opened += status == STATUS_OK, refused += status != STATUS_OK, taken += c.buildings;
        for (int b = 0; b < c.buildings; b++) CHECK(c.building[b].corners >= 3 && c.building[b].ridge_m <= 850);
        for (int p = 0; p < c.corners; p++) CHECK(fabs(c.corner_m[p][0]) <= 16000 && fabs(c.corner_m[p][1]) <= 16000);
        culture_free(&c);
    }
    log_set_sink(NULL, NULL);
    raster_child_patience(0);
    raster_child_program(NULL);
    printf("%d opened, %d refused, %d buildings taken\n", opened, refused, taken);
    if (opened < 2 || refused < 2 || taken < 1) fail_msg("%d opened, %d refused, %d taken", opened, refused, taken);
}

/* The same octet by octet, without a process: never more than a refusal. */
static void replies_are_checked(void **state)
{
    (void)state;
    static double room[64];
    uint8_t      *data = (uint8_t *)room;
    VectorPart    part;
    size_t        at = 0;
    const double  place[2] = {0.1, 0.8};
    WireFeature   w = {.octets = sizeof w + 16 + 16, .shape = WIRE_POINT, .corners = 1, .tags = 1, .texts = 13};
    memcpy(data + sizeof w, place, sizeof place);
    memcpy(data + sizeof w + 16, "building\0yes", 13);
    memcpy(data, &w, sizeof w);
    CHECK(vector_part_read(&part, &at, data, sizeof room) && at == w.octets && part.tags == 1 &&
          strcmp(part.value[0], "yes") == 0 && part.lon_lat_rad[0][1] == 0.8);
    static const int32_t odd[] = {-1, 3, 100, 65537, INT32_MAX, INT32_MIN};
    for (size_t field = 0; field < 8; field++)
        for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) {
            WireFeature bad = w;
            memcpy((uint8_t *)&bad + 4 * field, &odd[k], 4);
            memcpy(data, &bad, sizeof bad);
            at = 0;
            const bool taken = vector_part_read(&part, &at, data, sizeof room);
            CHECK(!taken || (field == 3 || field == 6 || field == 7)); /* holes, file, part: any number will do */
        }
    for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) /* rings that are not there */
        for (int field = 0; field < 2; field++) {
            WireFeature bad = w;
            *(field ? &bad.rings : &bad.ring_corners) = odd[k];
            memcpy(data, &bad, sizeof bad);
            at = 0;
            CHECK(!vector_part_read(&part, &at, data, sizeof room));
        }
    /* a triangle with a ring of three corners; the ring's number must be that of its corners */
    WireFeature   yard = {.octets = sizeof yard + 96 + 8 + 16,
                          .shape = WIRE_POLYGON,
                          .corners = 3,
                          .tags = 1,
                          .texts = 13,
                          .rings = 1,
                          .ring_corners = 3,
                          .holes = 1};
    const double  six[6][2] = {{0, 0}, {4, 0}, {0, 4}, {1, 1}, {2, 1}, {1, 2}};
    const int32_t sizes[] = {3, 2, 4, -3, INT32_MAX};
    memcpy(data, &yard, sizeof yard), memcpy(data + sizeof yard, six, sizeof six);
    memset(data + sizeof yard + 96, 0, 24), memcpy(data + sizeof yard + 104, "building\0yes", 13);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        memcpy(data + sizeof yard + 96, &sizes[k], 4);
        at = 0;
        const bool taken = vector_part_read(&part, &at, data, sizeof room);
        CHECK(taken == (k == 0));
        if (taken) CHECK(part.rings == 1 && part.ring[0] == 3 && part.ring_lon_lat_rad[2][1] == 2 && at == yard.octets);
    }
    memcpy(data + sizeof w, place, sizeof place);
    memcpy(data + sizeof w + 16, "building\0yes", 13);
    memcpy(data, &w, sizeof w);
    memset(data + sizeof w + 16, 'x', 16); /* no end */
    at = 0;
    CHECK(!vector_part_read(&part, &at, data, sizeof room));
    at = 4;
    CHECK(!vector_part_read(&part, &at, data, sizeof room));
    at = sizeof room;
    CHECK(!vector_part_read(&part, &at, data, sizeof room));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(its_reader_is_confined), cmocka_unit_test(names_that_are_no_files),
        cmocka_unit_test(same_for_elevation),     cmocka_unit_test(a_milliard_of_corners),
        cmocka_unit_test(spoilt_files),           cmocka_unit_test(archives),
        cmocka_unit_test(whatever_it_sends),      cmocka_unit_test(replies_are_checked),
    };
    return cmocka_run_group_tests(tests, open_sound, close_lab);
}
