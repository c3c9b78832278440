/* The folders of a run's products: made, searched for an earlier run, and cleared of what such a run left, and of
 * nothing else. */
#include "tests/check.h"

#include "sensor/publish/files/frame_files.h"

#include <ftw.h>
#include <sys/stat.h>

static char out[temp_path_size];

static const char *path_of(const char *name)
{
    static char path[temp_path_size + 128];
    snprintf(path, sizeof path, "%s/%s", out, name);
    return path;
}

static void folders_above(const char *path)
{
    char above[temp_path_size + 128];
    for (const char *at = path; (at = strchr(at + 1, '/'));) {
        snprintf(above, sizeof above, "%.*s", (int)(at - path), path);
        mkdir(above, 0700);
    }
}

/* An empty file, with the folders above it. */
static void touch(const char *name)
{
    folders_above(path_of(name));
    FILE *file = fopen(path_of(name), "w");
    CHECK(file && fclose(file) == 0);
}

static void fill(const char *name)
{
    touch(name);
    FILE *file = fopen(path_of(name), "w");
    CHECK(file && fputs("{}\n", file) >= 0 && fclose(file) == 0);
}

static void folder(const char *name)
{
    folders_above(path_of(name));
    CHECK(mkdir(path_of(name), 0700) == 0);
}

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *at)
{
    (void)about, (void)kind, (void)at;
    return remove(path);
}
static void remove_all(const char *path) { CHECK(nftw(path, remove_one, 8, FTW_DEPTH | FTW_PHYS) == 0); }

static bool is_there(const char *name) { return access(path_of(name), F_OK) == 0; }

static int open_out(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    if (access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 1); /* many small files: in memory */
    return temp_folder(out) ? 0 : -1;
}

static int close_out(void **state)
{
    (void)state;
    log_set_sink(NULL, NULL);
    remove_all(out);
    return 0;
}

/* ---- what is cleared ----------------------------------------------------------------------------- */

static const char *const ours[] = {"frames/lwir/000123.exr",
                                   "frames/optical/000000.png",
                                   "frames/radar/999999.csv",
                                   "frames/truth/000001.exr",
                                   "raw/mwir/000123.png",
                                   "profiles/radar/000123.csv",
                                   "radar/000123.exr",
                                   "radar/000123_scan.exr",
                                   "radar/000123_scan.png",
                                   "radar/000123_dbs.csv",
                                   "radar/000123_view.exr",
                                   "radar/000123_view_scan.png",
                                   "radar/000123_view_dbs.png",
                                   "frame_000001.pvf",
                                   "lwir.klv",
                                   "optical.KLV",
                                   "latest/lwir.png",
                                   "latest/radar.png.part",
                                   "pairs/clean/frames/lwir/000123.png",
                                   "pairs/background/raw/lwir/000001.png",
                                   "pairs/background_clean/frames/mwir/000001.png",
                                   "pairs.jsonl",
                                   "coco.json",
                                   "answers.jsonl",
                                   "run.json",
                                   "truth.jsonl"};
static const char *const others[] = {"frames/lwir/00012.exr",
                                     "frames/lwir/0000123.exr",
                                     "frames/lwir/00012a.exr",
                                     "frames/lwir/00012:.exr",
                                     "frames/lwir/!00123.exr",
                                     "frames/lwir/00012_.exr",
                                     "frames/lwir/000123.txt",
                                     "frames/lwir/000123.exr.part",
                                     "frames/lwir/000123exr",
                                     "frames/lwir/000123_mine.exr",
                                     "radar/000123_sca.exr",
                                     "radar/000123_scann.exr",
                                     "radar/000123_dbs_.csv",
                                     "frames/mine/000123.exr",
                                     "frames/lwi/000123.exr",
                                     "frames/000123.exr",
                                     "frame_00001.pvf",
                                     "frame_0000001.pvf",
                                     "frame_0000x1.pvf",
                                     "frame_000001.pvg",
                                     "mine.klv",
                                     "lwir.klv2",
                                     "LWIR.klv",
                                     "latest/mine.png",
                                     "latest/lwir.jpg",
                                     "lwir.mkv",
                                     "notes/000123.exr",
                                     "pairs/mine/000123.exr"};
enum { our_count = sizeof ours / sizeof *ours, other_count = sizeof others / sizeof *others };

static void what_a_run_left_is_cleared_and_nothing_else(void **state)
{
    (void)state;
    for (int k = 0; k < our_count; k++) fill(ours[k]);
    for (int k = 0; k < other_count; k++) fill(others[k]);
    frame_files_clear(out);
    for (int k = 0; k < our_count; k++)
        if (is_there(ours[k])) fail_msg("%s is left", ours[k]);
    for (int k = 0; k < other_count; k++)
        if (!is_there(others[k])) fail_msg("%s is gone", others[k]);
    /* folders that are empty are gone, too; those with something else stay */
    CHECK(!is_there("raw") && !is_there("profiles") && !is_there("frames/truth") && !is_there("pairs/clean"));
    CHECK(is_there("frames/lwir") && is_there("radar") && is_there("latest"));

    /* videos lie where publish.video says, and are cleared apart */
    static const char *const video[] = {"lwir.mkv", "optical.ts", "radar.mp4", "mwir.MP4"}, *const no_video[] = {
                                                                                                "mine.ts", "lwir.avi",
                                                                                                "lwir.mp4.part"};
    for (int k = 0; k < 4; k++) fill(video[k]);
    for (int k = 0; k < 3; k++) fill(no_video[k]);
    frame_files_clear_videos(out);
    for (int k = 0; k < 4; k++) CHECK(!is_there(video[k]));
    for (int k = 0; k < 3; k++) CHECK(is_there(no_video[k]));
}

/* Without a sign of an earlier run nothing is taken away: the folder may hold other files. */
static void another_folder_stays_as_it_is(void **state)
{
    (void)state;
    fill("lwir.klv");
    fill("coco.json");
    fill("frame_000001.pvf");
    fill("frames/mine/000123.exr");
    frame_files_clear(out);
    CHECK(is_there("lwir.klv") && is_there("coco.json") && is_there("frame_000001.pvf"));
    touch("truth.jsonl"); /* a run that did not reach its first frame is one */
    frame_files_clear(out);
    CHECK(!is_there("truth.jsonl") && !is_there("lwir.klv") && !is_there("coco.json") &&
          is_there("frames/mine/000123.exr"));
}

static void an_earlier_run_is_found(void **state)
{
    (void)state;
    char found[frame_path_size];
    CHECK(!frame_files_earlier(found, out));
    folder("frames/lwir");
    fill("frames/lwir/notes.txt");
    fill("frames/mine/000001.exr");
    CHECK(!frame_files_earlier(found, out));
    fill("frames/lwir/000007.png");
    CHECK(frame_files_earlier(found, out));
    assert_string_equal(found, path_of("frames/lwir/000007.png"));
    CHECK(remove(found) == 0);
    fill("raw/mwir/000007.png");
    CHECK(frame_files_earlier(found, out) && strcmp(found, path_of("raw/mwir/000007.png")) == 0 && remove(found) == 0);
    fill("radar/000007_dbs.csv");
    CHECK(frame_files_earlier(found, out) && strcmp(found, path_of("radar/000007_dbs.csv")) == 0 && remove(found) == 0);
    fill("run.json");
    CHECK(frame_files_earlier(found, out) && strcmp(found, path_of("run.json")) == 0);
    touch("truth.jsonl"); /* without a line: it ended before its first frame */
    CHECK(!frame_files_earlier(found, out));
    fill("truth.jsonl");
    CHECK(frame_files_earlier(found, out) && strcmp(found, path_of("truth.jsonl")) == 0);
    static char longer[frame_path_size + 8];
    memset(longer, 'x', sizeof longer - 1);
    CHECK(!frame_files_earlier(found, longer));
    frame_files_clear(longer); /* nothing is there */
}

/* ---- what is made ---------------------------------------------------------------------------------- */

static const char *const band_folders[BAND_COUNT] = {"optical", "mwir", "lwir", "radar"};

static void check_folders(unsigned frames, bool truth, bool profiles, unsigned raw)
{
    char name[64];
    for (int b = 0; b < BAND_COUNT; b++) {
        snprintf(name, sizeof name, "frames/%s", band_folders[b]);
        CHECK(is_there(name) == (frames >> b & 1));
        snprintf(name, sizeof name, "raw/%s", band_folders[b]);
        CHECK(is_there(name) == (raw >> b & 1));
    }
    CHECK(is_there("frames/truth") == truth && is_there("profiles/radar") == profiles);
    remove_all(out);
    CHECK(mkdir(out, 0700) == 0);
}

static void folders_are_those_of_the_products(void **state)
{
    (void)state;
    static const struct {
        unsigned bands, raw;
    } of[] = {{1u << BAND_LWIR, 1u << BAND_OPTICAL}, {1u << BAND_OPTICAL | 1u << BAND_RADAR, 1u << BAND_LWIR}, {0, 1}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const unsigned bands = of[k].bands, raw = of[k].raw;
        CHECK(frame_files_prepare(out, bands, raw) == STATUS_OK);
        check_folders(bands, false, bands >> BAND_RADAR & 1, bands ? raw : 0);
        CHECK(frame_files_prepare(out, bands | frame_truth, raw) == STATUS_OK);
        check_folders(bands, true, bands >> BAND_RADAR & 1, raw);
        CHECK(frame_files_prepare_displays(out, bands | frame_truth, raw) == STATUS_OK); /* the radar has none */
        check_folders(bands & ~(1u << BAND_RADAR), false, false, raw);
    }
    fill("truth.jsonl");
    fill("lwir.klv");
    CHECK(frame_files_prepare_displays(out, 1, 0) == STATUS_OK && is_there("lwir.klv")); /* clears nothing */
    CHECK(frame_files_prepare(out, 1, 0) == STATUS_OK && !is_there("lwir.klv"));
}

static void names_that_no_folder_can_have(void **state)
{
    (void)state;
    static char longest[frame_path_size];
    CHECK(frame_files_folder("") == STATUS_BAD_VALUE && strstr(check_said, "no name"));
    memset(longest, 'x', sizeof longest - 1);
    CHECK(frame_files_folder(longest) == STATUS_BAD_VALUE && strstr(check_said, "4095 characters, 4031 are possible"));
    longest[frame_path_size - frame_path_room] = 0;
    CHECK(frame_files_folder(longest) == STATUS_BAD_VALUE);
    longest[frame_path_size - frame_path_room - 1] = 0; /* possible, though not as one name */
    CHECK(frame_files_folder(longest) == STATUS_IO);
    CHECK(frame_files_check(longest) == STATUS_IO);
    touch("file");
    CHECK(frame_files_folder(path_of("file")) == STATUS_IO && strstr(check_said, "cannot write in"));
    CHECK(frame_files_prepare(path_of("file"), 1, 0) == STATUS_IO &&
          frame_files_prepare_displays(path_of("file"), 1, 0) == STATUS_IO);
    CHECK(frame_files_folder(path_of("new")) == STATUS_OK && is_there("new"));
}

/* Whatever stands where a product must be is found before anything is rendered: a folder for a file, a file for a
 * folder. */
static void what_is_in_the_way_is_said(void **state)
{
    (void)state;
    static const char *const files[] = {"run.json",    "truth.jsonl", "coco.json", "pairs.jsonl", "answers.jsonl",
                                        "optical.klv", "mwir.klv",    "lwir.klv",  "radar.klv"};
    static const char *const folders[] = {"frames",
                                          "profiles",
                                          "raw",
                                          "radar",
                                          "latest",
                                          "pairs",
                                          "frames/optical",
                                          "frames/mwir",
                                          "frames/lwir",
                                          "frames/radar",
                                          "frames/truth",
                                          "profiles/radar",
                                          "raw/optical",
                                          "raw/lwir",
                                          "raw/radar",
                                          "pairs/clean",
                                          "pairs/background",
                                          "pairs/background_clean",
                                          "pairs/clean/frames/optical",
                                          "pairs/background/frames/truth",
                                          "pairs/background_clean/raw/radar"};
    CHECK(frame_files_check(out) == STATUS_OK);
    for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
        folder(files[k]);
        check_said[0] = 0;
        CHECK(frame_files_check(out) == STATUS_IO && strstr(check_said, path_of(files[k])));
        remove_all(path_of(files[k]));
        fill(files[k]); /* a file there is overwritten */
    }
    CHECK(frame_files_check(out) == STATUS_OK);
    for (size_t k = 0; k < sizeof folders / sizeof *folders; k++) {
        touch(folders[k]);
        check_said[0] = 0;
        CHECK(frame_files_check(out) == STATUS_IO && strstr(check_said, path_of(folders[k])));
        remove_all(path_of(folders[k]));
        folder(folders[k]);
    }
    CHECK(frame_files_check(out) == STATUS_OK); /* folders that are there are used */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_a_run_left_is_cleared_and_nothing_else, open_out, close_out),
        cmocka_unit_test_setup_teardown(another_folder_stays_as_it_is, open_out, close_out),
        cmocka_unit_test_setup_teardown(an_earlier_run_is_found, open_out, close_out),
        cmocka_unit_test_setup_teardown(folders_are_those_of_the_products, open_out, close_out),
        cmocka_unit_test_setup_teardown(names_that_no_folder_can_have, open_out, close_out),
        cmocka_unit_test_setup_teardown(what_is_in_the_way_is_said, open_out, close_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
