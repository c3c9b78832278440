/* Image files: what goes in comes out, to the bit, by name; and what cannot be written says so and leaves
 * nothing behind. */
#include "tests/check.h"

#include "sensor/publish/images/image_file.h"

#include <dirent.h>
#include <pthread.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

enum { width = 67, height = 41, pixels = width * height };

static char folder[64];

static const char *in_folder(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int files_in_folder(void)
{
    int  count = 0;
    DIR *dir = opendir(folder);
    CHECK(dir != NULL);
    for (struct dirent *e; (e = readdir(dir));) count += e->d_name[0] != '.';
    closedir(dir);
    return count;
}

static void empty_folder(void)
{
    DIR *dir = opendir(folder);
    CHECK(dir != NULL);
    for (struct dirent *e; (e = readdir(dir));)
        if (e->d_name[0] != '.') unlink(in_folder(e->d_name));
    closedir(dir);
}

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    empty_folder();
    return rmdir(folder);
}

/* Log lines, captured. */
static char last_line[512];
static int  lines;

static void capture(void *user, LogLevel level, const char *line)
{
    (void)user;
    (void)level;
    snprintf(last_line, sizeof last_line, "%s", line);
    lines++;
}

static float    range_m[pixels], temp_k[pixels];
static uint32_t entity[pixels], part[pixels];

static void fill(void)
{
    for (int i = 0; i < pixels; i++) {
        range_m[i] = i % 7 == 0 ? INFINITY : 1.0f / (float)(i + 1) + (float)i;
        temp_k[i] = i % 11 == 0 ? NAN : 273.15f + 0.001f * (float)i;
        entity[i] = UINT32_MAX - (uint32_t)i; /* not one of them is a float */
        part[i] = (uint32_t)i;
    }
    range_m[1] = -0.0f;
    entity[0] = 4294967295u;
    entity[1] = 16777217u; /* 2^24 + 1, the first integer a float lacks */
    entity[2] = 0;
    entity[3] = 2147483649u;
}

/* The first files of the program, asked for by several threads at once: each loads the modules, or waits. */
static void *first_files(void *user)
{
    const int   k = *(const int *)user;
    char        path[2][128];
    ImageInfo   info;
    const Plane plane[] = {plane_f32("range_m", width, height, range_m), plane_u32("entity", width, height, entity)};
    for (int png = 0; png < 2; png++) snprintf(path[png], sizeof path[0], "%s/%d.%s", folder, k, png ? "png" : "exr");
    return image_write_exr_as(path[0], "zip:1", plane, 2, NULL, NULL, 0) == STATUS_OK &&
                   image_write_png(path[1], entity, width, height, 1, 16) == STATUS_OK &&
                   image_info(&info, path[0]) == STATUS_OK && info.channels == 2 &&
                   image_info(&info, path[1]) == STATUS_OK && info.bits == 16
               ? user
               : NULL;
}

static void threads_ask_first_at_once(void **state)
{
    enum { threads = 6 };
    pthread_t thread[threads];
    int       number[threads];
    (void)state;
    fill();
    for (int k = 0; k < threads; k++) {
        number[k] = k;
        assert_int_equal(pthread_create(&thread[k], NULL, first_files, &number[k]), 0);
    }
    for (int k = 0; k < threads; k++) {
        void *done;
        assert_int_equal(pthread_join(thread[k], &done), 0);
        assert_ptr_equal(done, &number[k]);
    }
    empty_folder();
}

/* Native mixed formats through the library and back: every bit, channels found by name though the file has
 * them in the alphabet's order. */
static void exr_round_trip_is_exact(void **state)
{
    (void)state;
    fill();
    const Plane plane[] = {plane_f32("range_m", width, height, range_m), plane_u32("entity", width, height, entity),
                           plane_u32("part", width, height, part), plane_f32("temp_k", width, height, temp_k)};
    const char *compressions[] = {NULL, "none", "rle", "zips", "zip:1", "piz"};
    for (int k = 0; k < 6; k++) {
        const char  *path = in_folder("truth.exr");
        const Status status = compressions[k] ? image_write_exr_as(path, compressions[k], plane, 4, NULL, NULL, 0)
                                              : image_write_exr(path, plane, 4, NULL, NULL, 0);
        assert_int_equal(status, STATUS_OK);

        ImageInfo info;
        assert_int_equal(image_info(&info, path), STATUS_OK);
        assert_int_equal(info.width, width);
        assert_int_equal(info.height, height);
        assert_int_equal(info.channels, 4);
        assert_string_equal(info.name[0], "entity");
        assert_int_equal(info.type[0], PLANE_U32);
        assert_string_equal(info.name[2], "range_m");
        assert_int_equal(info.type[2], PLANE_F32);

        static float    f[pixels];
        static uint32_t u[pixels];
        assert_int_equal(image_read_u32(u, path, "entity"), STATUS_OK);
        assert_memory_equal(u, entity, sizeof u);
        assert_int_equal(image_read_u32(u, path, "part"), STATUS_OK);
        assert_memory_equal(u, part, sizeof u);
        assert_int_equal(image_read_f32(f, path, "range_m"), STATUS_OK);
        assert_memory_equal(f, range_m, sizeof f);
        assert_int_equal(image_read_f32(f, path, "temp_k"), STATUS_OK);
        assert_memory_equal(f, temp_k, sizeof f);
    }
}

/* Octets are widened to uint32, which the format has; alone and among others. */
static void octets_become_uint32(void **state)
{
    (void)state;
    static uint8_t  cover[pixels];
    static uint32_t u[pixels];
    fill();
    for (int i = 0; i < pixels; i++) cover[i] = (uint8_t)(37 * i);
    const Plane plane[] = {{"cover", PLANE_U8, width, height, cover}, plane_u32("entity", width, height, entity)};
    const char *path = in_folder("cover.exr");
    for (int planes = 1; planes <= 2; planes++) {
        assert_int_equal(image_write_exr(path, plane, planes, NULL, NULL, 0), STATUS_OK);
        assert_int_equal(image_read_u32(u, path, "cover"), STATUS_OK);
        for (int i = 0; i < pixels; i++) assert_int_equal(u[i], (uint8_t)(37 * i));
    }
    assert_int_equal(image_read_u32(u, path, "entity"), STATUS_OK);
    assert_memory_equal(u, entity, sizeof u);
}

/* Lines that shrink and lines that do not, in one file: noise below a constant sky, and a sky again; the last band of
 * lines is not whole. The sky costs next to nothing, noise no more than its size. */
static void lines_shrink_or_stay(void **state)
{
    (void)state;
    enum { columns = 64, rows = 16 * 37 + 5, noisy_from = 16 * 3, noisy_to = 16 * 20 };
    static float plane_in[rows * columns], plane_out[rows * columns];
    uint32_t     seed = 1;
    for (int i = 0; i < rows * columns; i++) {
        const int y = i / columns;
        seed = seed * 1664525u + 1013904223u;
        memcpy(&plane_in[i], &seed, sizeof seed);
        if (y < noisy_from || y >= noisy_to || !isfinite(plane_in[i])) plane_in[i] = 0;
    }
    const Plane plane[] = {plane_f32("Y", columns, rows, plane_in), plane_f32("Z", columns, rows, plane_in)};
    const char *path = in_folder("lines.exr");
    struct stat about;
    const int   noise = (noisy_to - noisy_from) * columns * 4, of_line = 16 + columns * 4 / 16;
    for (int planes = 1; planes <= 2; planes++) { /* written as it is, and interleaved */
        assert_int_equal(image_write_exr_as(path, "rle", plane, planes, NULL, NULL, 0), STATUS_OK);
        assert_int_equal(image_read_f32(plane_out, path, plane[planes - 1].name), STATUS_OK);
        assert_memory_equal(plane_out, plane_in, sizeof plane_in);
        assert_int_equal(stat(path, &about), 0);
        CHECK(about.st_size > planes * noise * 9 / 10 && about.st_size < planes * (noise + rows * of_line) + 4000);
    }
}

/* No silent conversion: the wrong type or name is refused and the output stays. */
static void reading_never_converts(void **state)
{
    (void)state;
    fill();
    const Plane plane[] = {plane_f32("Y", width, height, range_m), plane_u32("entity", width, height, entity)};
    const char *path = in_folder("two.exr");
    assert_int_equal(image_write_exr(path, plane, 2, NULL, NULL, 0), STATUS_OK);
    log_set_sink(capture, NULL);
    float    f = 7;
    uint32_t u = 7;
    assert_int_equal(image_read_f32(&f, path, "entity"), STATUS_BAD_VALUE);
    assert_int_equal(image_read_u32(&u, path, "Y"), STATUS_BAD_VALUE);
    assert_int_equal(image_read_u32(&u, path, "part"), STATUS_BAD_VALUE);
    assert_int_equal(image_read_u32(&u, in_folder("absent.exr"), "part"), STATUS_IO);
    log_set_sink(NULL, NULL);
    CHECK(f == 7 && u == 7);
}

static void attributes_come_back(void **state)
{
    (void)state;
    fill();
    const Plane          plane = plane_f32("Y", width, height, range_m);
    const ImageAttribute attribute[] = {image_string("unit", "W/(m2 sr)"), image_int("frame", 2147483647),
                                        image_float("gain", 0.5), image_double("time_s", 1392.4000000001),
                                        image_string("entity_ids", "1:3001:82 1:3001:72")};
    const char          *path = in_folder("attributes.exr");
    assert_int_equal(image_write_exr(path, &plane, 1, "2024:06:21 10:00:00", attribute, 5), STATUS_OK);

    char   text[64];
    double number;
    assert_true(image_read_string(text, sizeof text, path, "DateTime"));
    assert_string_equal(text, "2024:06:21 10:00:00");
    assert_true(image_read_string(text, sizeof text, path, "unit"));
    assert_string_equal(text, "W/(m2 sr)");
    assert_true(image_read_string(text, sizeof text, path, "entity_ids"));
    assert_string_equal(text, "1:3001:82 1:3001:72");
    assert_true(image_read_number(&number, path, "frame"));
    CHECK(number == 2147483647.0);
    assert_true(image_read_number(&number, path, "gain"));
    CHECK(number == 0.5);
    assert_true(image_read_number(&number, path, "time_s"));
    CHECK(number == 1392.4000000001);
    assert_false(image_read_number(&number, path, "unit"));
    assert_false(image_read_string(text, sizeof text, path, "none such"));
}

/* Other writers put the wall clock into the file; two runs must give the same bytes. */
static void file_bytes_repeat(void **state)
{
    (void)state;
    fill();
    const Plane plane = plane_f32("Y", width, height, range_m);
    static char bytes[2][65536];
    size_t      count[2];
    for (int k = 0; k < 2; k++) {
        const char *path = in_folder("same.exr");
        assert_int_equal(image_write_exr(path, &plane, 1, NULL, NULL, 0), STATUS_OK);
        FILE *file = fopen(path, "rb");
        CHECK(file != NULL);
        count[k] = fread(bytes[k], 1, sizeof bytes[k], file);
        fclose(file);
        if (k == 0) sleep(1); /* so that a wall clock would show */
    }
    CHECK(count[0] > 1000 && count[0] == count[1]);
    assert_memory_equal(bytes[0], bytes[1], count[0]);
}

static void png_round_trip(void **state)
{
    (void)state;
    static uint8_t  in8[3 * pixels], out8[3 * pixels];
    static uint16_t in16[3 * pixels], out16[3 * pixels];
    for (int i = 0; i < 3 * pixels; i++) {
        in8[i] = (uint8_t)(i * 7);
        in16[i] = (uint16_t)(i * 257 + 1);
    }
    for (int channels = 1; channels <= 3; channels += 2) {
        const char  *path = in_folder("picture.png");
        const size_t n = (size_t)channels * pixels;
        ImageInfo    info;
        assert_int_equal(image_write_png(path, in8, width, height, channels, 8), STATUS_OK);
        assert_int_equal(image_info(&info, path), STATUS_OK);
        CHECK(info.channels == channels && info.bits == 8 && info.width == width && info.height == height);
        assert_int_equal(image_read_png(out8, path), STATUS_OK);
        assert_memory_equal(out8, in8, n);

        assert_int_equal(image_write_png(path, in16, width, height, channels, 16), STATUS_OK);
        assert_int_equal(image_info(&info, path), STATUS_OK);
        CHECK(info.channels == channels && info.bits == 16);
        assert_int_equal(image_read_png(out16, path), STATUS_OK);
        assert_memory_equal(out16, in16, 2 * n);
    }
}

/* One line, with the path and the reason, and no file. */
static void check_refused(Status got, Status want, const char *path, const char *reason)
{
    assert_int_equal(got, want);
    assert_int_equal(lines, 1);
    if (!strstr(last_line, path) || !strstr(last_line, reason))
        fail_msg("'%s' names neither '%s' nor '%s'", last_line, path, reason);
    lines = 0;
}

static void a_file_that_cannot_be_written_says_so(void **state)
{
    (void)state;
    fill();
    const Plane plane = plane_f32("Y", width, height, range_m);
    empty_folder();
    lines = 0;
    log_set_sink(capture, NULL);

    const char *path = "/nowhere/at/all.exr";
    check_refused(image_write_exr(path, &plane, 1, NULL, NULL, 0), STATUS_IO, path, "No such file or directory");
    path = "/nowhere/at/all.png";
    check_refused(image_write_png(path, entity, width, height, 1, 8), STATUS_IO, path, "No such file or directory");
    path = "/dev/null/x.exr";
    check_refused(image_write_exr(path, &plane, 1, NULL, NULL, 0), STATUS_IO, path, "Not a directory");

    /* the target is a folder: written, but cannot be put in its place */
    char blocked[128];
    snprintf(blocked, sizeof blocked, "%s/folder.exr", folder);
    assert_int_equal(mkdir(blocked, 0777), 0);
    check_refused(image_write_exr(blocked, &plane, 1, NULL, NULL, 0), STATUS_IO, blocked, "Is a directory");
    assert_int_equal(rmdir(blocked), 0);

    log_set_sink(NULL, NULL);
    assert_int_equal(files_in_folder(), 0);
}

/* A disk that fills up in the middle, played by a limit on file size. */
static void a_full_disk_leaves_the_old_file(void **state)
{
    (void)state;
    fill();
    empty_folder();
    const Plane plane = plane_f32("Y", width, height, range_m);
    char        path[128];
    snprintf(path, sizeof path, "%s/full.exr", folder);
    assert_int_equal(image_write_exr(path, &plane, 1, "1999:01:01 00:00:00", NULL, 0), STATUS_OK);

    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    small = (struct rlimit){1000, before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    lines = 0;
    log_set_sink(capture, NULL);
    const Status exr = image_write_exr(path, &plane, 1, NULL, NULL, 0);
    char         exr_line[sizeof last_line];
    strcpy(exr_line, last_line);
    const int exr_lines = lines;
    lines = 0;
    const Status png = image_write_png(path, entity, width, height, 1, 16);
    log_set_sink(NULL, NULL);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);

    check_refused(png, STATUS_IO, path, "File too large");
    lines = exr_lines;
    strcpy(last_line, exr_line);
    check_refused(exr, STATUS_IO, path, "File too large");
    assert_int_equal(files_in_folder(), 1); /* no .part */
    char text[64];
    assert_true(image_read_string(text, sizeof text, path, "DateTime"));
    assert_string_equal(text, "1999:01:01 00:00:00");
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    fill();
    static double  f64[pixels];
    const Plane    one = plane_f32("Y", width, height, range_m);
    const Plane    twice[] = {one, one};
    const Plane    sizes[] = {one, plane_f32("Z", height, width, range_m)};
    const Plane    wide[] = {plane_f64("Y", width, height, f64)};
    const Plane    nameless[] = {plane_f32("", width, height, range_m)};
    const Plane    empty[] = {plane_f32("Y", 0, 0, range_m)};
    const uint16_t grey[4] = {0};
    char           path[128];
    snprintf(path, sizeof path, "%s/nonsense", folder);
    empty_folder();

    lines = 0;
    log_set_sink(capture, NULL);
    check_refused(image_write_exr(path, &one, 0, NULL, NULL, 0), STATUS_BAD_VALUE, path, "no planes");
    check_refused(image_write_exr(path, twice, 2, NULL, NULL, 0), STATUS_BAD_VALUE, path, "one name");
    check_refused(image_write_exr(path, sizes, 2, NULL, NULL, 0), STATUS_BAD_VALUE, path, "different size");
    check_refused(image_write_exr(path, wide, 1, NULL, NULL, 0), STATUS_BAD_VALUE, path, "neither");
    check_refused(image_write_exr(path, nameless, 1, NULL, NULL, 0), STATUS_BAD_VALUE, path, "name");
    check_refused(image_write_exr(path, empty, 1, NULL, NULL, 0), STATUS_BAD_VALUE, path, "size");
    check_refused(image_write_png(path, grey, 2, 2, 2, 8), STATUS_BAD_VALUE, path, "channel count");
    check_refused(image_write_png(path, grey, 2, 2, 1, 12), STATUS_BAD_VALUE, path, "depth");
    log_set_sink(NULL, NULL);
    assert_int_equal(files_in_folder(), 0);
}

/* First and last row of a letter with ink of a half or more; returns the sum of its ink, in pixels. */
static double ink_of(int rows[2], const uint8_t *cell, int wide, int high)
{
    double sum = 0;
    rows[0] = high, rows[1] = -1;
    for (int v = 0; v < high; v++)
        for (int u = 0; u < wide; u++) {
            sum += cell[v * wide + u] / 255.0;
            if (cell[v * wide + u] < 128) continue;
            rows[0] = v < rows[0] ? v : rows[0];
            rows[1] = v;
        }
    return sum;
}

/* DejaVu Sans Mono's own figures: capitals 1493 of 2048 units high, x 1120, an em 2048, a letter 1233 wide. */
static void letters_are_those_of_the_font(void **state)
{
    (void)state;
    enum { size_px = 36, wide = 22, high = 48, base = 36 };
    static uint8_t cover[image_letter_count][high * wide];
    int            rows[2];
    assert_int_equal(image_letters(&cover[0][0], wide, high, base, size_px), STATUS_OK);
    for (int letter = 1; letter < image_letter_count; letter++) {
        assert_true(ink_of(rows, cover[letter], wide, high) > 4);
        for (int other = 0; other < letter; other++)
            assert_memory_not_equal(cover[letter], cover[other], sizeof cover[letter]);
    }
    CHECK_NEAR(ink_of(rows, cover[0], wide, high), 0, 0); /* a blank */
    ink_of(rows, cover['H' - ' '], wide, high);
    CHECK_NEAR(rows[1], base - 1, 1);
    CHECK_NEAR(rows[1] + 1 - rows[0], size_px * 1493.0 / 2048, 1);
    ink_of(rows, cover['x' - ' '], wide, high);
    CHECK_NEAR(rows[1] + 1 - rows[0], size_px * 1120.0 / 2048, 1);
    ink_of(rows, cover['g' - ' '], wide, high);
    assert_true(rows[1] >= base + size_px / 8); /* it hangs below */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_ask_first_at_once), /* before any other */
        cmocka_unit_test(letters_are_those_of_the_font),
        cmocka_unit_test(exr_round_trip_is_exact),
        cmocka_unit_test(octets_become_uint32),
        cmocka_unit_test(lines_shrink_or_stay),
        cmocka_unit_test(reading_never_converts),
        cmocka_unit_test(attributes_come_back),
        cmocka_unit_test(file_bytes_repeat),
        cmocka_unit_test(png_round_trip),
        cmocka_unit_test(a_file_that_cannot_be_written_says_so),
        cmocka_unit_test(a_full_disk_leaves_the_old_file),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
