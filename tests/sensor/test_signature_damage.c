/* Signatures on disk that are damaged, cut or of another name are refused and made anew. labels: physics slow */
#include "tests/sensor/signature_files.h"

static Got again, first;

/* The file of the first look: the only one, in a folder of its own. */
static void damaged_files_are_made_anew(void **state)
{
    (void)state;
    char           path[400] = "";
    struct dirent *e;
    static uint8_t octets[1 << 24];
    empty_folder(true);
    look(&first, 30, NULL, 1e-3, true);
    DIR *d = opendir(folder);
    while ((e = readdir(d)))
        if (e->d_name[0] != '.') snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
    closedir(d);
    FILE        *file = fopen(path, "rb");
    const size_t count = fread(octets, 1, sizeof octets, file);
    fclose(file);
    const size_t cut[4] = {0, 7, 100, count - 1}, spoil[5] = {3, 20, 73, 80 + 84 * 5, count - 3};
    for (int i = 0; i < 9; i++) {
        file = fopen(path, "wb");
        if (i >= 4) octets[spoil[i - 4]] ^= 0x10;
        fwrite(octets, 1, i < 4 ? cut[i] : count, file);
        fclose(file);
        if (i >= 4) octets[spoil[i - 4]] ^= 0x10;
        check_said[0] = 0;
        log_set_sink(check_listen, NULL);
        look(&again, 30, NULL, 1e-3, true);
        log_set_sink(NULL, NULL);
        CHECK(again.counters.made == 1 && again.files.refused == 1 && again.files.written == 1 && same(&again, &first));
        CHECK(strstr(check_said, "is damaged") != NULL);
        look(&again, 30, NULL, 1e-3, true);
        CHECK(again.counters.fetched == 1 && same(&again, &first));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damaged_files_are_made_anew),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
