/* tests/terrain/test_raster_reader.c: the process that reads rasters: what it may not do, what becomes of the program
 * when it ends, hangs or is taken over by a file, and that gaps cost nothing. labels: threads */
#include "tests/terrain/raster_lab.h"

#include "terrain/elevation/raster_patch.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>

enum { side = 4, px = 64 * side };

static char    folder[64], other[64], tiff[96], vrt[96], far_tiff[96];
static LabFile file;
static int     said_errors;

static void count_errors(void *user, LogLevel level, const char *line)
{
    check_listen(user, level, line);
    said_errors += level == LOG_ERROR;
}

static void save_tiff(const char *path, uint32_t has, double nodata)
{
    lab_tiff(&file, side, has, nodata);
    lab_save(&file, path);
}

static void save_vrt(const char *source)
{
    lab_vrt(&file, source);
    lab_save(&file, vrt);
}

/* A program of the tests' own folder in the reader's place; NULL: the product. */
static void read_by(const char *name)
{
    static char   path[4200];
    char          self[4096];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    CHECK(length > 0);
    self[length] = 0;
    *strrchr(self, '/') = 0;
    snprintf(path, sizeof path, "%s/%s", self, name ? name : "");
    raster_child_program(name ? path : NULL);
}

/* Opens it and reads its first pixels. */
static Status read_some(float out[4], const char *path)
{
    RasterSet set = {0};
    Status    status = raster_set_open(&set, path, "test");
    if (status == STATUS_OK) status = raster_read(out, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test");
    raster_set_close(&set);
    return status;
}

/* ---- confinement --------------------------------------------------------------------------------- */

static long status_of(const char *path, const char *field)
{
    char  line[256];
    long  value = -1;
    FILE *status = fopen(path, "r");
    while (status && fgets(line, sizeof line, status))
        if (strncmp(line, field, strlen(field)) == 0) value = strtol(line + strlen(field), NULL, 10);
    if (status) fclose(status);
    return value;
}

static void every_thread_of_it_is_confined(void **state)
{
    (void)state;
    RasterSet set = {0};
    float     some[4];
    char      path[300], target[256];
    int       threads = 0;
    CHECK(raster_set_open(&set, tiff, "test") == STATUS_OK &&
          raster_read(some, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test") == STATUS_OK);
    const pid_t reader = lab_reader();
    snprintf(path, sizeof path, "/proc/%d/task", (int)reader);
    DIR *tasks = opendir(path);
    for (struct dirent *entry; tasks && (entry = readdir(tasks));) {
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "/proc/%d/task/%s/status", (int)reader, entry->d_name);
#if defined(__SANITIZE_THREAD__)
        if (status_of(path, "Seccomp:") != 2) continue; /* the sanitizer's own */
#endif
        if (status_of(path, "Seccomp:") != 2 || status_of(path, "NoNewPrivs:") != 1) fail_msg("%s: not confined", path);
        threads++;
    }
    if (tasks) closedir(tasks);
    CHECK(threads >= wire_channels);
    /* nothing is open but the sockets to the program, its memory, files within the folder and PROJ's tables */
    snprintf(path, sizeof path, "/proc/%d/fd", (int)reader);
    DIR *files = opendir(path);
    int  sockets = 0;
    for (struct dirent *entry; files && (entry = readdir(files));) {
        char full[600];
        if (entry->d_name[0] == '.') continue;
        snprintf(full, sizeof full, "%s/%s", path, entry->d_name);
        const ssize_t length = readlink(full, target, sizeof target - 1);
        if (length < 0) continue;
        target[length] = 0;
        const bool is_socket = strncmp(target, "socket:", 7) == 0;
        sockets += is_socket;
        if (!is_socket && strcmp(target, "/dev/null") != 0 && strncmp(target, folder, strlen(folder)) != 0 &&
            !strstr(target, "proj"))
            fail_msg("it has %s open", target);
    }
    if (files) closedir(files);
    CHECK(sockets == wire_channels);
    raster_set_close(&set);
}

static void no_file_makes_it_ask_a_server(void **state)
{
    (void)state;
    static const struct {
        const char *program;
        bool        asks;
    } readers[] = {{NULL, false},            /* GDAL's options and the filter of system calls */
                   {"rasters_plain", false}, /* the filter alone */
                   {"rasters_open", true}};  /* neither: the twin */
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t          size = sizeof address;
    const int          server = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
    CHECK(server >= 0 && bind(server, (struct sockaddr *)&address, size) == 0 && listen(server, 64) == 0 &&
          getsockname(server, (struct sockaddr *)&address, &size) == 0);
    for (size_t k = 0; k < sizeof readers / sizeof *readers; k++) {
        char  name[128];
        float some[4];
        int   asked = 0;
        read_by(readers[k].program);
        log_set_sink(check_listen, NULL);
        for (int direct = 0; direct < 2; direct++) {
            snprintf(name, sizeof name, "/vsicurl/http://127.0.0.1:%d/a.tif", ntohs(address.sin_port));
            save_vrt(name);
            const pid_t closer = fork(); /* so that a question is answered, with an end */
            if (closer == 0)
                for (double begun_s = wall_clock_s(); wall_clock_s() - begun_s < 20; usleep(1000)) {
                    const int asker = accept(server, NULL, NULL);
                    if (asker >= 0) _exit(shutdown(asker, SHUT_RDWR) == 0 ? 1 : 2);
                }
            raster_child_patience(20);
            CHECK(read_some(some, direct ? name : vrt) != STATUS_OK);
            kill(closer, SIGTERM);
            int how = 0;
            CHECK(waitpid(closer, &how, 0) == closer);
            asked += WIFEXITED(how);
            for (int asker; (asker = accept(server, NULL, NULL)) >= 0; asked++) close(asker);
        }
        log_set_sink(NULL, NULL);
        raster_child_patience(0);
        if ((asked > 0) != readers[k].asks)
            fail_msg("%s: %d connections", readers[k].program ? readers[k].program : "the product", asked);
    }
    close(server);
    read_by(NULL);
}

/* A file of files that calls itself something else is not looked into by name: what it names there is Landlock's alone.
 */
static void others_are_read_in_the_own_folder_alone(void **state)
{
    (void)state;
    char  hidden[96], deep[128], text[512];
    float some[4];
    snprintf(hidden, sizeof hidden, "%s/hidden.dat", folder);
    save_vrt(tiff);
    CHECK(read_some(some, vrt) == STATUS_OK && some[0] == lab_height(0, 0));
    snprintf(deep, sizeof deep, "%s/link.tif", folder);
    CHECK(symlink(far_tiff, deep) == 0);
    log_set_sink(check_listen, NULL);
    const char *const outside[] = {far_tiff, deep, "/vsicurl/http://127.0.0.1:9/a.tif", "/etc/passwd"};
    for (size_t k = 0; k < sizeof outside / sizeof *outside; k++) {
        save_vrt(outside[k]);
        *check_said = 0;
        CHECK(read_some(some, vrt) != STATUS_OK && strstr(check_said, vrt));
        if (!strstr(check_said, "terrain.sources_from") ||
            !strstr(check_said, k == 2 ? "is no file" : "outside its folder"))
            fail_msg("no cause or remedy: %s", check_said);
    }
    save_vrt(far_tiff);
    CHECK(rename(vrt, hidden) == 0);
    save_vrt(hidden);
    *check_said = 0;
    CHECK(read_some(some, vrt) != STATUS_OK && strstr(check_said, "ermission denied"));
    read_by("rasters_open");
    CHECK(read_some(some, vrt) == STATUS_OK); /* the twin */
    read_by("rasters_by_name");
    *check_said = 0;
    CHECK(read_some(some, vrt) != STATUS_OK && strstr(check_said, "outside its folder"));
    read_by(NULL);

    raster_sources_from(other);
    CHECK(read_some(some, vrt) == STATUS_OK && some[3] == lab_height(1, 1));
    save_vrt(far_tiff);
    CHECK(read_some(some, vrt) == STATUS_OK);
    snprintf(text, sizeof text, "/nowhere, %s", other);
    raster_sources_from(text);
    CHECK(read_some(some, vrt) == STATUS_OK);
    raster_stay_within(folder); /* goes before */
    CHECK(read_some(some, vrt) != STATUS_OK);
    raster_stay_within(NULL);
    raster_sources_from("/nowhere");
    CHECK(read_some(some, vrt) != STATUS_OK);
    raster_sources_from(NULL);
    log_set_sink(NULL, NULL);
    /* what the user names may be a link, and be named with anything */
    CHECK(read_some(some, deep) == STATUS_OK);
    snprintf(text, sizeof text, "%s@geoid,%s:1", tiff, far_tiff);
    CHECK(read_some(some, text) == STATUS_OK);
    snprintf(text, sizeof text, "GTIFF_DIR:1:%s", tiff);
    CHECK(read_some(some, text) == STATUS_OK);
    /* names of the folder that is the current one now */
    char *before = realpath(".", NULL);
    CHECK(before && chdir(folder) == 0);
    const Status here = read_some(some, "a.tif");
    CHECK(chdir(before) == 0 && here == STATUS_OK);
    free(before);
    CHECK(unlink(deep) == 0 && unlink(hidden) == 0);
}

/* ---- its end --------------------------------------------------------------------------------------- */

/* It is sent a signal while a set is open: the rest fails, with one line that has `wanted`; another set is read. */
static void ends_by(int number, const char *wanted)
{
    RasterSet set = {0};
    float     some[4];
    double    x = 0.25, y = 0.8;
    CHECK(raster_set_open(&set, tiff, "test.key") == STATUS_OK &&
          raster_read(some, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test.key") == STATUS_OK);
    const pid_t reader = lab_reader();
    CHECK(kill(reader, number) == 0);
    raster_child_patience(0.3); /* no longer than a stopped one needs: opening takes longer on a busy machine */
    said_errors = 0;
    log_set_sink(count_errors, NULL);
    CHECK(raster_read(some, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test.key") == STATUS_IO);
    if (!strstr(check_said, wanted) || !strstr(check_said, tiff) || !strstr(check_said, "test.key") ||
        !strstr(check_said, "gdal_translate"))
        fail_msg("said: %s", check_said);
    CHECK(raster_read(some, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test.key") == STATUS_IO);
    raster_px_from_earth(&set.raster[0], 1, &x, &y);
    CHECK(isnan(x) && isnan(y) && said_errors == 1);
    log_set_sink(NULL, NULL);
    raster_child_patience(0);
    CHECK(kill(reader, 0) != 0); /* it is no more */
    raster_set_close(&set);
    CHECK(read_some(some, tiff) == STATUS_OK);
}

static void one_that_ends_or_hangs_is_one_error(void **state)
{
    (void)state;
    ends_by(SIGKILL, "broke off (signal 9)");
    ends_by(SIGSEGV, "broke off ("); /* a sanitizer makes an exit of it */
    ends_by(SIGSTOP, "did nothing for 0 s");
}

static void one_that_starts_them_may_end(void **state)
{
    (void)state;
    float     some[4];
    RasterSet set = {0};
    CHECK(raster_set_open(&set, tiff, "test") == STATUS_OK);
    CHECK(kill(lab_starter(), SIGKILL) == 0);
    log_set_sink(check_listen, NULL);
    (void)raster_read(some, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test");
    log_set_sink(NULL, NULL);
    raster_set_close(&set);
    CHECK(read_some(some, tiff) == STATUS_OK && some[1] == lab_height(1, 0));
}

/* A process of its own after a fork has readers of its own. */
static void a_fork_has_its_own(void **state)
{
    (void)state;
    RasterSet set = {0};
    float     some[4];
    int       how;
    CHECK(raster_set_open(&set, tiff, "test") == STATUS_OK);
    const pid_t starter = lab_starter(), process = fork();
    CHECK(process >= 0);
    if (process == 0) {
        const bool good = read_some(some, tiff) == STATUS_OK && lab_starter() > 0 && lab_starter() != starter;
        _exit(good ? 0 : 1);
    }
    CHECK(waitpid(process, &how, 0) == process && WIFEXITED(how) && WEXITSTATUS(how) == 0);
    CHECK(raster_read(some, &set.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test") == STATUS_OK &&
          lab_starter() == starter);
    raster_set_close(&set);
}

static void none_is_left(void **state)
{
    (void)state;
    RasterSet a = {0}, b = {0};
    CHECK(raster_set_open(&a, tiff, "test") == STATUS_OK && raster_set_open(&b, tiff, "test") == STATUS_OK);
    raster_set_close(&a);
    float some[4];
    CHECK(raster_read(some, &b.raster[0], 1, (RasterWindow){0, 0, 2, 2}, "test") == STATUS_OK);
    raster_set_close(&b);
    CHECK(lab_child_of(lab_starter()) == 0);
}

/* ---- taken over -------------------------------------------------------------------------------------- */

static void whatever_it_sends_the_program_goes_on(void **state)
{
    (void)state;
    enum { rounds = 300, most = 1 << 20 };
    float   *out = malloc(most * sizeof *out);
    uint8_t *bytes = malloc(4 * most), *valid = malloc(most);
    int      opened = 0, refused = 0;
    CHECK(out && bytes && valid);
    read_by("rasters_hostile");
    log_set_sink(check_listen, NULL);
    raster_child_patience(0.5);
    for (int n = 0; n < rounds; n++) {
        RasterSet set = {0};
        if (raster_set_open(&set, tiff, "test") != STATUS_OK) {
            refused++;
            continue;
        }
        opened++;
        for (int k = 0; k < set.count; k++) {
            Raster *r = &set.raster[k];
            double  x[40], y[40], low[2], high[2];
            float   value;
            CHECK(r->width >= 2 && r->height >= 2 && r->bands >= 1 && r->sheet_count >= 1 && r->posting_m[0] > 0);
            for (int s = 0; s < r->sheet_count; s++) {
                const RasterSheet *sheet = &r->sheet[s];
                CHECK(strlen(sheet->path) < wire_path_size && sheet->x0 >= 0 && sheet->x0 + sheet->width <= r->width);
            }
            (void)raster_read(out, r, 1, (RasterWindow){-3, -3, 600, 300}, "test");
            (void)raster_read_bytes(bytes, valid, r, 1, 3, (RasterWindow){0, 0, 40, 30}, "test");
            (void)raster_uniform(&value, r, 1, (RasterWindow){0, 0, 40, 30}, "test");
            for (int i = 0; i < 40; i++) x[i] = y[i] = 0.01 * i;
            raster_px_from_earth(r, 40, x, y);
            for (int i = 0; i < 40; i++) CHECK(isnan(x[i]) == isnan(y[i]) && !isinf(x[i]));
            LocalFrame frame;
            CHECK(local_frame_at(&frame, &(Geodetic){0.8, 0.25, 0}) == STATUS_OK);
            raster_enu_box(low, high, r, &frame, 0);
        }
        raster_set_close(&set);
    }
    log_set_sink(NULL, NULL);
    raster_child_patience(0);
    read_by(NULL);
    print_message("%d sets were opened, %d refused\n", opened, refused);
    CHECK(opened > 3 && refused > 3);
    free(out);
    free(bytes);
    free(valid);
}

/* ---- gaps -------------------------------------------------------------------------------------------- */

/* Against the definition of a TIFF: a block that is not there has the nodata value, else zeroes. */
static void gaps_are_known_without_reading(void **state)
{
    (void)state;
    static const double nodata[] = {NAN, -9999, 0};
    static float        all[px * px], part[64 * 64];
    const uint32_t      has = 1u << 5 | 1u << 6;
    for (int n = 0; n < 3; n++) {
        RasterSet set = {0};
        float     v = 7;
        save_tiff(tiff, has, nodata[n]);
        CHECK(raster_set_open(&set, tiff, "test") == STATUS_OK);
        const Raster *r = &set.raster[0];
        CHECK(r->sparse);
        CHECK_NEAR(r->data_share, 2.0 / (side * side), 1e-9);
        CHECK(raster_read(all, r, 1, (RasterWindow){0, 0, px, px}, "test") == STATUS_OK);
        for (int y = 0; y < px; y++)
            for (int x = 0; x < px; x++) {
                const bool  there = has >> (y / 64 * side + x / 64) & 1;
                const float got = all[y * px + x];
                if (there ? got != lab_height(x, y) : n == 0 ? got != 0 : !isnan(got))
                    fail_msg("%d, %d: %g", x, y, (double)got);
            }
        for (int t = 0; t < side * side; t++) {
            const bool known = raster_uniform(&v, r, 1, (RasterWindow){t % side * 64, t / side * 64, 64, 64}, "test");
            CHECK(known == !(has >> t & 1));
            if (known) CHECK(n == 0 ? v == 0 : isnan(v));
        }
        CHECK(raster_uniform(&v, r, 1, (RasterWindow){0, 0, px, 64}, "test") &&
              !raster_uniform(&v, r, 1, (RasterWindow){0, 0, px, 65}, "test"));
        CHECK(raster_uniform(&v, r, 1, (RasterWindow){px, 0, 100, 100}, "test") && isnan(v)); /* beyond the raster */
        /* the same when it was kept, which gaps are not */
        CHECK(raster_read(part, r, 1, (RasterWindow){40, 40, 64, 64}, "test") == STATUS_OK);
        for (int k = 0; k < 64 * 64; k++) {
            const float a = part[k], b = all[(40 + k / 64) * px + 40 + k % 64];
            CHECK(memcmp(&a, &b, sizeof a) == 0);
        }
        raster_set_close(&set);
    }
    /* whole: nothing is asked */
    RasterSet set = {0};
    float     v;
    save_tiff(tiff, 0x0000ffff & ~0u, NAN);
    CHECK(raster_set_open(&set, tiff, "test") == STATUS_OK && !set.raster[0].sparse && set.raster[0].data_share == 1);
    CHECK(!raster_uniform(&v, &set.raster[0], 1, (RasterWindow){0, 0, 64, 64}, "test"));
    raster_set_close(&set);
}

static void kept_rows_are_bounded(void **state)
{
    (void)state;
    static float all[px * px], again[px * px];
    for (int whole = 0; whole < 2; whole++) {
        RasterSet set = {0};
        CHECK(raster_set_open(&set, tiff, "test") == STATUS_OK);
        raster_keep(&set.raster[0], 1, folder, whole ? 1e9 : 10.5 * px * sizeof(float)); /* room for ten rows */
        CHECK(raster_read(all, &set.raster[0], 1, (RasterWindow){0, 0, px, px}, "test") == STATUS_OK);
        char        path[64];
        struct stat about;
        double      octets = 0;
        for (int n = 3; n < 64; n++) {
            char target[256];
            snprintf(path, sizeof path, "/proc/self/fd/%d", n);
            const ssize_t length = readlink(path, target, sizeof target - 1);
            if (length > 0 && strncmp(target, folder, strlen(folder)) == 0 && fstat(n, &about) == 0)
                octets = (double)about.st_size;
        }
        CHECK(octets == (whole ? px : 10) * px * sizeof(float));
        CHECK(kill(lab_reader(), SIGKILL) == 0);
        log_set_sink(check_listen, NULL);
        CHECK(raster_read(again, &set.raster[0], 1, (RasterWindow){3, 2, 50, 8}, "test") ==
              STATUS_OK); /* without the reader */
        CHECK((raster_read(again, &set.raster[0], 1, (RasterWindow){0, 0, px, px}, "test") == STATUS_OK) ==
              (whole != 0));
        log_set_sink(NULL, NULL);
        if (whole) CHECK(memcmp(again, all, sizeof all) == 0);
        raster_set_close(&set);
    }
}

int main(void)
{
    snprintf(folder, sizeof folder, "/tmp/pitviper-test-XXXXXX");
    snprintf(other, sizeof other, "/tmp/pitviper-test-XXXXXX");
    if (!mkdtemp(folder) || !mkdtemp(other)) return 1;
    snprintf(tiff, sizeof tiff, "%s/a.tif", folder);
    snprintf(vrt, sizeof vrt, "%s/a.vrt", folder);
    snprintf(far_tiff, sizeof far_tiff, "%s/far.tif", other);
    save_tiff(tiff, 0xffff, NAN);
    save_tiff(far_tiff, 0xffff, NAN);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_thread_of_it_is_confined),
        cmocka_unit_test(no_file_makes_it_ask_a_server),
        cmocka_unit_test(others_are_read_in_the_own_folder_alone),
        cmocka_unit_test(one_that_ends_or_hangs_is_one_error),
        cmocka_unit_test(one_that_starts_them_may_end),
        cmocka_unit_test(a_fork_has_its_own),
        cmocka_unit_test(none_is_left),
        cmocka_unit_test(whatever_it_sends_the_program_goes_on),
        cmocka_unit_test(gaps_are_known_without_reading),
        cmocka_unit_test(kept_rows_are_bounded),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(tiff);
    unlink(vrt);
    unlink(far_tiff);
    rmdir(folder);
    rmdir(other);
    return failed;
}
