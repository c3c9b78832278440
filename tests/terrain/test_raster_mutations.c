/* tests/terrain/test_raster_mutations.c: small GeoTIFF, VRT, NetCDF and DTED files with spoilt headers, imported: the
 * program stays, no connection is made, memory, time and disk stay bounded. PITVIPER_MUTATIONS: how many of each kind
 * (60). */
#include "tests/terrain/raster_lab.h"

#include "terrain/import/terrain_import.h"

#include <arpa/inet.h>
#include <sys/socket.h>

static char folder[64], path[128], store[128];
static int  server_port, server;

/* ---- the files, sound -------------------------------------------------------------------------------- */

static void text_of(LabFile *f, const char *text)
{
    lab_number(f, strlen(text), 4, true);
    lab_put(f, text, strlen(text));
    while (f->count % 4) lab_number(f, 0, 1, true);
}

static void attribute(LabFile *f, const char *name, const char *value)
{
    text_of(f, name);
    lab_number(f, 2, 4, true); /* characters */
    text_of(f, value);
}

/* NetCDF classic: 40 x 40 posts of 0.001 degrees with coordinate variables. */
static void make_netcdf(LabFile *f)
{
    enum { n = 40 };
    static const char wkt[] =
        "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],"
        "UNIT[\"degree\",0.0174532925199433]]";
    for (uint32_t begin = 0, pass = 0; pass < 2; pass++) { /* offsets are known after the first */
        f->count = 0;
        lab_put(f, "CDF\1", 4);
        lab_number(f, 0, 4, true);
        lab_number(f, 10, 4, true);
        lab_number(f, 2, 4, true);
        text_of(f, "lat"), lab_number(f, n, 4, true);
        text_of(f, "lon"), lab_number(f, n, 4, true);
        lab_number(f, 12, 4, true);
        lab_number(f, 1, 4, true);
        attribute(f, "Conventions", "CF-1.5");
        lab_number(f, 11, 4, true);
        lab_number(f, 4, 4, true);
        for (int v = 0; v < 4; v++) {
            static const char *const names[] = {"lat", "lon", "z", "crs"};
            const uint32_t           size = v < 2 ? 8 * n : v == 2 ? 4 * n * n : 4;
            text_of(f, names[v]);
            lab_number(f, v < 2 ? 1 : v == 2 ? 2 : 0, 4, true);
            if (v < 2) lab_number(f, (uint64_t)v, 4, true);
            if (v == 2) lab_number(f, 0, 4, true), lab_number(f, 1, 4, true);
            lab_number(f, 12, 4, true);
            lab_number(f, v == 3 ? 1 : 2, 4, true);
            if (v < 2)
                attribute(f, "units", v ? "degrees_east" : "degrees_north"),
                    attribute(f, "standard_name", v ? "longitude" : "latitude");
            if (v == 2) attribute(f, "units", "m"), attribute(f, "grid_mapping", "crs");
            if (v == 3) attribute(f, "spatial_ref", wkt);
            lab_number(f, v < 2 ? 6 : v == 2 ? 5 : 2, 4, true);
            lab_number(f, size, 4, true);
            lab_number(f, begin + (v > 0 ? 8 * n : 0) + (v > 1 ? 8 * n : 0) + (v > 2 ? 4 * n * n : 0), 4, true);
        }
        begin = (uint32_t)f->count;
    }
    for (int v = 0; v < 2; v++)
        for (int k = 0; k < n; k++) lab_double(f, (v ? 15 : 47) + 0.001 * k, true);
    for (int k = 0; k < n * n; k++) lab_float(f, (float)(300 + k % n), true);
    lab_number(f, 0, 4, true);
}

/* DTED level 0, 1 x 1 degree. */
static void make_dted(LabFile *f)
{
    enum { posts = 121, uhl = 80, dsi = 648, acc = 2700 };
    f->count = 0;
    memset(f->octets, ' ', uhl + dsi + acc);
    memcpy(f->octets, "UHL10150000E0470000N03000300NA  U              012101210", 56);
    memcpy(f->octets + uhl, "DSIU", 4);
    memcpy(f->octets + uhl + 59, "DTED0", 5);
    memcpy(f->octets + uhl + 126, "E96", 3);
    memcpy(f->octets + uhl + 144, "WGS84", 5);
    memcpy(f->octets + uhl + dsi, "ACC", 3);
    f->count = uhl + dsi + acc;
    for (uint32_t line = 0; line < posts; line++) {
        const size_t at = f->count;
        uint32_t     sum = 0;
        lab_number(f, 0xaa000000u | line, 4, true);
        lab_number(f, line, 2, true);
        lab_number(f, 0, 2, true);
        for (int k = 0; k < posts; k++) lab_number(f, (uint64_t)(300 + k), 2, true);
        for (size_t k = at; k < f->count; k++) sum += f->octets[k];
        lab_number(f, sum, 4, true);
    }
}

static void make_tiff(LabFile *f) { lab_tiff(f, 1, 1, -9999); }

static char source[96];
static void make_vrt(LabFile *f) { lab_vrt(f, source); }

static const struct Kind {
    const char *name;
    void (*make)(LabFile *f);
    uint32_t header; /* octets that most changes are in */
} kinds[] = {{"tif", make_tiff, 400}, {"vrt", make_vrt, 800}, {"nc", make_netcdf, 900}, {"dt0", make_dted, 3440}};
enum { kind_count = sizeof kinds / sizeof *kinds };

/* ---- spoilt ------------------------------------------------------------------------------------------ */

static uint64_t state;
static uint32_t chance(uint32_t below)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % below;
}

static void change_octets(LabFile *f, uint32_t header)
{
    static const uint32_t odd[] = {0,          1,          0xff,    0xffff,    0x7fffffff,
                                   0x80000000, 0xffffffff, 0x10000, 100000000, 0xfffffff0};
    const uint32_t        most = chance(8) && header < f->count ? header : (uint32_t)f->count;
    for (uint32_t n = 1 + chance(4); n > 0; n--) {
        const uint32_t at = chance(most), value = chance(3) ? odd[chance(10)] : chance(0xffffffffu);
        const bool     big = chance(2);
        switch (chance(5)) {
        case 0:
            f->octets[at] ^= (uint8_t)(1u << chance(8));
            break;
        case 1:
            f->octets[at] = (uint8_t)value;
            break;
        case 2:
            for (uint32_t k = 0; k < 2 && at + k < f->count; k++)
                f->octets[at + k] = (uint8_t)(value >> 8 * (big ? 1 - k : k));
            break;
        case 3:
            for (uint32_t k = 0; k < 4 && at + k < f->count; k++)
                f->octets[at + k] = (uint8_t)(value >> 8 * (big ? 3 - k : k));
            break;
        default:
            if (chance(8) == 0) f->count = at + 1;
            else f->octets[at] = (uint8_t)chance(256);
        }
    }
}

/* A word or number of a text in the place of another. */
static void change_words(LabFile *f)
{
    char        words[20][160];
    const char *server_name = words[0];
    snprintf(words[0], sizeof *words, "/vsicurl/http://127.0.0.1:%d/a.tif", server_port);
    snprintf(words[1], sizeof *words, "http://127.0.0.1:%d/a.tif", server_port);
    snprintf(words[2], sizeof *words, "/vsicurl_streaming/http://127.0.0.1:%d/a.tif", server_port);
    snprintf(words[3], sizeof *words, "/vsis3/127.0.0.1:%d/a.tif", server_port);
    snprintf(words[4], sizeof *words, "/vsizip//vsicurl/http://127.0.0.1:%d/a.zip/a.tif", server_port);
    snprintf(words[5], sizeof *words, "PG:host=127.0.0.1 port=%d dbname=a mode=2", server_port);
    snprintf(words[6], sizeof *words,
             "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://127.0.0.1:%d/</ServerUrl></Service></GDAL_WMS>",
             server_port);
    snprintf(words[7], sizeof *words, "%s", path);
    static const char *const more[] = {
        "/etc/passwd",          "../../../etc/passwd", "99999999",  "2147483647",    "-1", "1e308", "nan", "",
        "VRTDerivedRasterBand", "VRTWarpedDataset",    "/dev/zero", "/proc/self/mem"};
    for (int k = 0; k < 12; k++) snprintf(words[8 + k], sizeof *words, "%s", more[k]);
    char *at = (char *)f->octets;
    f->octets[f->count] = 0;
    (void)server_name;
    for (uint32_t n = 1 + chance(3); n > 0; n--) {
        size_t from = chance((uint32_t)f->count);
        while (from > 0 && !strchr(">\"= ,", at[from])) from--;
        const size_t length = strcspn(at + from + 1, "<\"= ,>"), rest = f->count - from - 1 - length;
        const char  *word = words[chance(20)];
        if (rest > f->count || f->count + strlen(word) + 1 > sizeof f->octets) continue;
        memmove(at + from + 1 + strlen(word), at + from + 1 + length, rest + 1);
        memcpy(at + from + 1, word, strlen(word));
        f->count += strlen(word) - length;
    }
}

/* ---- imported ---------------------------------------------------------------------------------------- */

static double begun_s;
static bool   for_a_while(void *user, const char *stage, double share)
{
    (void)user;
    (void)stage;
    (void)share;
    return wall_clock_s() - begun_s < 30;
}

static void hear_nothing(void *user, LogLevel level, const char *line)
{
    (void)user;
    (void)level;
    (void)line;
}

static double resident_mb(void)
{
    long  pages = 0;
    FILE *statm = fopen("/proc/self/statm", "r");
    CHECK(statm && fscanf(statm, "%*d %ld", &pages) == 1 && fclose(statm) == 0);
    return (double)pages * (double)sysconf(_SC_PAGESIZE) * 1e-6;
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const double most_mb = 1000; /* what was freed is held back */
#else
static const double most_mb = 100;
#endif

/* What lies in the folder beside the files of the test. */
static int others_here(void)
{
    DIR *here = opendir(folder);
    int  count = 0;
    CHECK(here);
    for (struct dirent *entry; (entry = readdir(here));)
        count += entry->d_name[0] != '.' && strncmp(entry->d_name, "in.", 3) != 0 &&
                 strcmp(entry->d_name, "source.tif") != 0;
    closedir(here);
    return count;
}

static Status import(void)
{
    TerrainOptions o;
    TerrainReport  r;
    const char    *why;
    terrain_options_default(&o);
    CHECK(terrain_options_set(&o, &why, "elevation", path) && terrain_options_set(&o, &why, "size", "0.3x0.3") &&
          terrain_options_set(&o, &why, "horizon", "1") && terrain_options_set(&o, &why, "most-gb", "0.02"));
    begun_s = wall_clock_s();
    const Status status = terrain_import(&r, &o, store, NULL, &(TerrainWatch){.progress = for_a_while});
    CHECK(!r.stopped); /* in 30 s: beyond any doubt */
    if (status == STATUS_OK) CHECK(unlink(store) == 0);
    return status;
}

static void spoilt_files_do_no_harm(void **unused)
{
    (void)unused;
    static LabFile file;
    const char    *wanted = getenv("PITVIPER_MUTATIONS");
    const int      rounds = wanted ? atoi(wanted) : 60;
    for (int k = 0; k < kind_count; k++) {
        int good = 0;
        snprintf(path, sizeof path, "%s/in.%s", folder, kinds[k].name);
        kinds[k].make(&file);
        lab_save(&file, path);
        if (import() != STATUS_OK) fail_msg("%s: the sound file is not read", kinds[k].name);
        log_set_sink(hear_nothing, NULL);
        const double before_mb = resident_mb();
        for (int n = 0; n < rounds; n++) {
            state = (uint64_t)(7919 * n + k);
            kinds[k].make(&file);
            if (k == 1 && chance(4)) change_words(&file);
            else change_octets(&file, kinds[k].header);
            lab_save(&file, path);
            good += import() == STATUS_OK;
            if (others_here() != 0) fail_msg("%s, %d: it left a file", kinds[k].name, n);
            if (accept(server, NULL, NULL) >= 0) fail_msg("%s, %d: a connection", kinds[k].name, n);
        }
        log_set_sink(NULL, NULL);
        const double grown_mb = resident_mb() - before_mb;
        print_message("%s: %d of %d read all the same; %.0f MB more\n", kinds[k].name, good, rounds, grown_mb);
        if (grown_mb > most_mb) fail_msg("%s: %.0f MB more", kinds[k].name, grown_mb);
        CHECK(good > 0 && good < rounds);
        unlink(path);
    }
}

int main(void)
{
    static LabFile     file;
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t          size = sizeof address;
    server = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
    if (server < 0 || bind(server, (struct sockaddr *)&address, size) != 0 || listen(server, 64) != 0 ||
        getsockname(server, (struct sockaddr *)&address, &size) != 0)
        return 1;
    server_port = ntohs(address.sin_port);
    snprintf(folder, sizeof folder, "/tmp/pitviper-test-XXXXXX");
    if (!mkdtemp(folder)) return 1;
    snprintf(source, sizeof source, "%s/source.tif", folder);
    snprintf(store, sizeof store, "%s/out.store", folder);
    make_tiff(&file);
    lab_save(&file, source);
    const struct CMUnitTest tests[] = {cmocka_unit_test(spoilt_files_do_no_harm)};
    const int               failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(source);
    rmdir(folder);
    return failed;
}
