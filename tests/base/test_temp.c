/* Files and folders for a moment: where TMPDIR says, of their own, and none where none can be. */
#include "tests/check.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static void they_lie_where_tmpdir_says(void **state)
{
    (void)state;
    char        folder[temp_path_size], one[temp_path_size], other[temp_path_size];
    struct stat info;
    unsetenv("TMPDIR");
    CHECK(temp_folder(folder) && strncmp(folder, "/tmp/", 5) == 0);
    CHECK(stat(folder, &info) == 0 && S_ISDIR(info.st_mode) && (info.st_mode & 0777) == 0700);
    setenv("TMPDIR", folder, 1);
    CHECK(temp_file(one, ".obj") && temp_file(other, ".obj") && strcmp(one, other) != 0);
    CHECK(strncmp(one, folder, strlen(folder)) == 0 && strcmp(one + strlen(one) - 4, ".obj") == 0);
    CHECK(stat(one, &info) == 0 && S_ISREG(info.st_mode) && info.st_size == 0);
    CHECK(remove(one) == 0 && remove(other) == 0 && rmdir(folder) == 0);
}

static void what_cannot_be_made_has_no_name(void **state)
{
    (void)state;
    char path[temp_path_size], deep[2 * temp_path_size];
    log_set_sink(check_listen, NULL);
    setenv("TMPDIR", "/nowhere/at/all", 1);
    CHECK(!temp_folder(path) && !*path);
    CHECK(!temp_file(path, "") && !*path);
    memset(deep, 'a', sizeof deep - 1);
    deep[0] = '/';
    deep[sizeof deep - 1] = 0;
    setenv("TMPDIR", deep, 1);
    CHECK(!temp_folder(path) && !*path);
    CHECK(!temp_file(path, ".obj") && !*path);
    log_set_sink(NULL, NULL);
    unsetenv("TMPDIR");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_lie_where_tmpdir_says),
        cmocka_unit_test(what_cannot_be_made_has_no_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
