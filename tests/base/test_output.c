/* Files that are written: no link is followed, of two writers one is refused, and a file is whole or absent. */
#include "tests/check.h"

#include "pitviper_output.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

static char root[temp_path_size];

static const char *in(const char *name)
{
    static char path[4][temp_name_size];
    static int  turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], temp_name_size, "%s/%s", root, name);
    return path[turn];
}

static bool there(const char *name)
{
    struct stat about;
    return lstat(in(name), &about) == 0;
}

static void put(const char *name, const char *text)
{
    FILE *file = fopen(in(name), "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static bool holds(const char *name, const char *text)
{
    char  octets[64] = "";
    FILE *file = fopen(in(name), "r");
    CHECK(file);
    octets[fread(octets, 1, sizeof octets - 1, file)] = 0;
    fclose(file);
    return strcmp(octets, text) == 0;
}

static bool refused(const char *name, unsigned how, int error)
{
    errno = 0;
    const int file = output_open(in(name), how);
    const int why = errno;
    if (file >= 0) close(file);
    errno = 0;
    return file < 0 && why == error && (output_begin(in(name), how) == NULL) && errno == error &&
           output_check(in(name), how) != 0;
}

static void links_are_not_followed(void **state)
{
    (void)state;
    put("kept", "kept");
    CHECK(symlink(in("kept"), in("link")) == 0 && symlink(in("nowhere"), in("dangling")) == 0);
    CHECK(refused("link", 0, ELOOP) && refused("link", OUTPUT_STREAM, ELOOP) && refused("dangling", 0, ELOOP));
    CHECK(holds("kept", "kept") && !there("nowhere"));
    CHECK(strstr(output_reason(ELOOP), "symbolic link"));
    /* the part of a file, too */
    CHECK(symlink(in("kept"), in("whole.part")) == 0);
    CHECK(output_begin(in("whole"), 0) == NULL && errno == ELOOP && holds("kept", "kept"));
    /* a name is replaced, and not what it leads to */
    put("new", "new");
    CHECK(output_rename(in("new"), in("link")) == 0 && holds("link", "new") && holds("kept", "kept"));
    CHECK(output_remove(in("dangling")) == 0 && output_remove(in("whole.part")) == 0 && output_remove(in("link")) == 0);
    CHECK(output_remove(in("kept")) == 0);
}

static void below_a_held_folder_no_folder_is_a_link(void **state)
{
    (void)state;
    CHECK(output_folder(in("out")) == 0 && output_folder(in("other")) == 0);
    put("other/000000.png", "other's");
    CHECK(symlink("../other", in("out/frames")) == 0);
    CHECK(output_hold("test", in("out")) == STATUS_OK);
    CHECK(output_open(in("out/frames/new"), 0) < 0 && errno == ELOOP);
    CHECK(output_folder(in("out/frames")) != 0 && errno == ELOOP);
    CHECK(output_folder(in("out/frames/lwir")) != 0 && errno == ELOOP);
    CHECK(output_check(in("out/frames"), OUTPUT_FOLDER) != 0 && errno == ELOOP);
    CHECK(output_list(in("out/frames")) == NULL && errno == ELOOP);
    CHECK(output_remove(in("out/frames/000000.png")) != 0 && holds("other/000000.png", "other's"));
    CHECK(output_open(in("out/../new"), 0) < 0 && errno == EINVAL && !there("new"));
    /* folders of its own, as deep as they are asked for, with slashes as they come */
    CHECK(output_folder(in("out//a/b/c/")) == 0 && there("out/a/b/c") &&
          output_check(in("out/a/x/y"), OUTPUT_FOLDER) == 0);
    FILE *file = output_begin(in("out/a//b/file"), 0);
    CHECK(file && fputs("text", file) >= 0 && output_end(file, in("out/a//b/file")) && holds("out/a/b/file", "text"));
    DIR *list = output_list(in("out"));
    CHECK(list && closedir(list) == 0);
    /* the folder that is held may have been a link: the user names it */
    CHECK(symlink("out", in("named")) == 0 && output_folder(in("named")) == 0);
    output_release(in("out"));
    CHECK(output_hold("test", in("named/")) == STATUS_OK && output_open(in("named/frames/new"), 0) < 0 &&
          errno == ELOOP);
    output_release(in("named"));
    CHECK(output_remove(in("out/a/b/file")) == 0 && output_remove(in("out/a/b/c")) == 0 &&
          output_remove(in("out/a/b")) == 0);
    CHECK(output_remove(in("out/a")) == 0 && output_remove(in("out/frames")) == 0 && output_remove(in("named")) == 0);
    CHECK(output_remove(in("other/000000.png")) == 0 && output_remove(in("other")) == 0 &&
          output_remove(in("out")) == 0);
}

/* A file that was closed is written again while a process that was started meanwhile still has a copy of its
 * descriptor. */
static void a_program_being_started_is_no_writer(void **state)
{
    (void)state;
    const int first = output_open(in("file"), 0);
    CHECK(first >= 0);
    const pid_t child = fork();
    if (child == 0) {
        usleep(20000);
        _exit(0);
    }
    CHECK(child > 0 && close(first) == 0);
    const int probe = open(in("file"), O_WRONLY);
    CHECK(flock(probe, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK &&
          close(probe) == 0); /* the copy has the lock */
    const int second = output_open(in("file"), 0);
    CHECK(second >= 0 && close(second) == 0);
    CHECK(waitpid(child, NULL, 0) == child && output_remove(in("file")) == 0);
}

static void a_second_writer_is_refused(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    const int first = output_open(in("file"), 0);
    CHECK(first >= 0 && write(first, "first", 5) == 5);
    CHECK(output_open(in("file"), 0) < 0 && errno == EBUSY && strstr(output_reason(EBUSY), "another process"));
    CHECK(close(first) == 0 && holds("file", "first"));
    FILE *part = output_begin(in("file"), 0);
    CHECK(part && output_begin(in("file"), 0) == NULL && errno == EBUSY);
    output_abandon(part, in("file"));
    CHECK(holds("file", "first") && !there("file.part"));
    /* a folder: the lock of another process is another open file description */
    CHECK(output_folder(in("out")) == 0);
    const int other = open(in("out"), O_RDONLY | O_DIRECTORY);
    CHECK(other >= 0 && flock(other, LOCK_EX) == 0);
    CHECK(output_hold("test", in("out")) == STATUS_IO && strstr(check_said, "another process is writing into"));
    CHECK(close(other) == 0 && output_hold("test", in("out")) == STATUS_OK &&
          output_hold("test", in("out/")) == STATUS_OK);
    output_release(in("out"));
    const int later = open(in("out"), O_RDONLY | O_DIRECTORY);
    CHECK(later >= 0 && flock(later, LOCK_EX | LOCK_NB) != 0); /* held twice, released once */
    output_release(in("out"));
    CHECK(flock(later, LOCK_EX | LOCK_NB) == 0 && close(later) == 0);
    CHECK(output_remove(in("file")) == 0 && output_remove(in("out")) == 0);
    log_set_sink(NULL, NULL);
}

static void a_file_is_whole_or_absent(void **state)
{
    (void)state;
    put("file", "older");
    FILE *file = output_begin(in("file"), 0);
    CHECK(file && fputs("newer", file) >= 0 && fflush(file) == 0 && holds("file", "older"));
    CHECK(output_end(file, in("file")) && holds("file", "newer") && !there("file.part"));
    file = output_begin(in("file"), 0);
    CHECK(file && fputs("much more", file) >= 0);
    check_full_disk(true);
    const bool whole = output_end(file, in("file"));
    const int  why = errno;
    check_full_disk(false);
    CHECK(!whole && why == EFBIG && holds("file", "newer") && !there("file.part"));
    CHECK(output_begin(in("no/such"), 0) == NULL && errno == ENOENT && output_check(in("no/such"), 0) != 0 &&
          errno == ENOENT);
    const int kept = output_open(in("file"), OUTPUT_KEEP);
    CHECK(kept >= 0 && holds("file", "newer") && close(kept) == 0);
    CHECK(output_remove(in("file")) == 0);
}

static void pipes_and_devices_where_they_make_sense(void **state)
{
    (void)state;
    char text[8] = "";
    CHECK(mkfifo(in("pipe"), 0600) == 0 && refused("pipe", 0, EMEDIUMTYPE));
    const int end = open(in("pipe"), O_RDONLY | O_NONBLOCK);
    CHECK(end >= 0 && refused("pipe", 0, EMEDIUMTYPE));
    FILE *to = output_begin(in("pipe"), OUTPUT_STREAM);
    CHECK(to && fputs("text", to) >= 0 && output_end(to, in("pipe")) && there("pipe") && !there("pipe.part"));
    CHECK(read(end, text, sizeof text) == 4 && strcmp(text, "text") == 0 && close(end) == 0);
    CHECK(output_open("/dev/null", 0) < 0 && errno == EMEDIUMTYPE && output_check("/dev/null", OUTPUT_STREAM) == 0);
    const int null = output_open("/dev/null", OUTPUT_STREAM), out = output_open("/dev/stdout", OUTPUT_STREAM);
    CHECK(null >= 0 && close(null) == 0 && out >= 0 && close(out) == 0);
    CHECK(output_open("/dev/fd/987", OUTPUT_STREAM) < 0 && errno == EBADF);
    CHECK(output_folder(in("out")) == 0 && refused("out", OUTPUT_STREAM, EISDIR));
    CHECK(output_remove(in("pipe")) == 0 && output_remove(in("out")) == 0);
}

static void endings(void **state)
{
    (void)state;
    static const char *const names[][2] = {{"a.png", ".png"}, {"a.b/c", ""},       {".pcap", ""}, {"a.b.TS", ".TS"},
                                           {"a.", "."},       {"/dev/stdout", ""}, {"v1/", ""}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK(strcmp(output_ending(names[i][0]), names[i][1]) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(links_are_not_followed),
        cmocka_unit_test(below_a_held_folder_no_folder_is_a_link),
        cmocka_unit_test(a_program_being_started_is_no_writer),
        cmocka_unit_test(a_second_writer_is_refused),
        cmocka_unit_test(a_file_is_whole_or_absent),
        cmocka_unit_test(pipes_and_devices_where_they_make_sense),
        cmocka_unit_test(endings),
    };
    if (!temp_folder(root)) return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    rmdir(root);
    return failed;
}
