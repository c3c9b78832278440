/* coco.json of several folders in one: new ids, and files that this program did not write end in a line. */
#include "tests/check.h"

#include "sensor/publish/coco/coco_file.h"

#include <sys/stat.h>

static char folder[64];

static void path_of(char path[256], const char *name, const char *file)
{
    snprintf(path, 256, "%s/%s/%s", folder, name, file);
}

static void put(const char *name, const char *text)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    mkdir(path, 0777);
    path_of(path, name, "coco.json");
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static void take(const char *name)
{
    char path[256];
    path_of(path, name, "coco.json");
    remove(path);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    remove(path);
}

static bool there(const char *file)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return access(path, F_OK) == 0;
}

static const char *const good[] = {
    "{\"images\":[{\"id\":15,\"file_name\":\"frames/lwir/3.png\"},{\"id\":3,\"file_name\":\"frames/lwir/0.png\"}],"
    "\"annotations\":[{\"id\":1,\"image_id\":3,\"category_id\":2},{\"id\":2,\"image_id\":15,\"category_id\":1}]}",
    "{\"images\":[{\"id\":3,\"file_name\":\"frames/lwir/0.png\"}],\"annotations\":[]}",
};

static void ids_are_new(void **state)
{
    (void)state;
    CocoMerge *merge;
    char       path[256], text[8192] = "";
    put("a", good[0]);
    put("b", good[1]);
    CHECK(coco_merge_open(&merge, folder) == STATUS_OK && !there("coco.json.part"));
    CHECK(coco_merge_add(merge, "a") == STATUS_OK && coco_merge_add(merge, "b") == STATUS_OK);
    CHECK(coco_merge_close(merge, true) == STATUS_OK);
    snprintf(path, sizeof path, "%s/coco.json", folder);
    FILE *file = fopen(path, "r");
    CHECK(file && fread(text, 1, sizeof text - 1, file) > 0);
    fclose(file);
    CHECK(strstr(text, "{\"id\":1,\"file_name\":\"a/frames/lwir/3.png\",\"variant\":\"a\"}"));
    CHECK(strstr(text, "{\"id\":2,\"file_name\":\"a/frames/lwir/0.png\",\"variant\":\"a\"}"));
    CHECK(strstr(text, "{\"id\":3,\"file_name\":\"b/frames/lwir/0.png\",\"variant\":\"b\"}"));
    CHECK(strstr(text, "{\"id\":1,\"image_id\":2,\"category_id\":2}"));
    CHECK(strstr(text, "{\"id\":2,\"image_id\":1,\"category_id\":1}"));
    /* nothing is added: what stood there goes */
    CHECK(coco_merge_open(&merge, folder) == STATUS_OK && coco_merge_close(merge, true) == STATUS_OK &&
          !there("coco.json"));
    take("a");
    take("b");
}

static void others_files_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",
        "[",
        "{}",
        "[]",
        "7",
        "{\"images\":7}",
        "{\"images\":[7]}",
        "{\"images\":[{}]}",
        "{\"images\":[{\"id\":\"x\"}]}",
        "{\"images\":[{\"id\":1}]}",
        "{\"images\":[{\"id\":1.5,\"file_name\":\"f\"}]}",
        "{\"images\":[{\"id\":1,\"file_name\":\"f\"}],\"annotations\":[{\"image_id\":2}]}",
        "{\"images\":[{\"id\":1,\"file_name\":\"f\"}],\"annotations\":[7]}",
        "{\"images\":[],\"annotations\":[{\"id\":1,\"image_id\":0}]}",
    };
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CocoMerge *merge;
        put("a", good[0]);
        put("b", bad[i]);
        check_said[0] = 0;
        CHECK(coco_merge_open(&merge, folder) == STATUS_OK && coco_merge_add(merge, "a") == STATUS_OK);
        if (coco_merge_add(merge, "b") == STATUS_OK) fail_msg("taken: %s", bad[i]);
        CHECK(strstr(check_said, "/b/coco.json"));
        CHECK(coco_merge_close(merge, false) == STATUS_OK);
        CHECK(!there("coco.json") && !there("coco.json.part") && !there("coco.json.annotations.part"));
    }
    take("a");
    take("b");
}

/* Whole or not at all. */
static void a_full_disk_leaves_nothing(void **state)
{
    (void)state;
    CocoFile file;
    log_set_sink(check_listen, NULL);
    CHECK(coco_file_open(&file, folder) == STATUS_OK && there("coco.json.part"));
    CHECK(coco_file_image(&file, json_pack("{s:i}", "id", 1)) == STATUS_OK);
    check_full_disk(true);
    const Status closed = coco_file_close(&file, json_object(), true);
    check_full_disk(false);
    CHECK(closed == STATUS_IO && strstr(check_said, "coco.json: File too large"));
    CHECK(!there("coco.json") && !there("coco.json.part") && !there("coco.json.annotations.part"));
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_full_disk_leaves_nothing),
        cmocka_unit_test(ids_are_new),
        cmocka_unit_test(others_files_are_refused),
    };
    strcpy(folder, "/tmp/pitviper-test-XXXXXX");
    if (!mkdtemp(folder)) return 1;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    remove(folder);
    return failed;
}
