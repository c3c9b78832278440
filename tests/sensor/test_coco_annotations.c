/* coco.json of frames made by hand: which targets are to be found and which are ignore regions, with what boxes and
 * signals. Masks: test_coco_mask.c. Joined files: test_coco_merge.c. */
#include "tests/check.h"

#include "sensor/publish/coco/coco.h"

#include <jansson.h>

enum { width = 9, height = 6, most = 8 };

static struct {
    char           folder[temp_path_size];
    RenderRequest  request;
    Snapshot       snapshot;
    SnapshotEntity entity[most];
    TargetRecord   target[most];
    FrameRecord    record;
    uint32_t       plane[width * height];
} lab;

/* Pixels of the truth plane: digits are values, from 1. */
static void paint(const char *rows)
{
    int n = 0;
    for (const char *at = rows; *at; at++)
        if (*at != ' ') lab.plane[n++] = *at == '.' ? 0 : (uint32_t)(*at - '0');
    CHECK(n == width * height);
}

static void target(int index, const int box[4], double visible, double snr_optical, double snr_lwir)
{
    TargetRecord *t = &lab.target[index];
    *t = (TargetRecord){.index = index,
                        .id = {1, 2, (uint16_t)(30 + index)},
                        .class_number = 1 + index % 2,
                        .plane_value = index + 1,
                        .model = "model",
                        .amodal_box = {1.5, 2.5, 7, 4.25},
                        .pixels = 3.5,
                        .visible_fraction = visible,
                        .range_m = 1000 + index};
    memcpy(t->box, box, sizeof t->box);
    for (int b = 0; b < BAND_COUNT; b++) t->band[b] = (TargetBand){.snr = NAN, .contrast = NAN, .contrast_k = NAN};
    t->band[BAND_OPTICAL].snr = snr_optical, t->band[BAND_OPTICAL].contrast = 0.25;
    t->band[BAND_LWIR].snr = snr_lwir, t->band[BAND_LWIR].contrast = 9, t->band[BAND_LWIR].contrast_k = -2.5;
}

static void frame(int number, int targets)
{
    lab.request = (RenderRequest){.view = {.width = width, .height = height, .focal_px = 100},
                                  .bands = 1 << BAND_OPTICAL | 1 << BAND_LWIR};
    lab.snapshot = (Snapshot){.count = targets, .entity = lab.entity};
    lab.record = (FrameRecord){.frame = number,
                               .time_s = 2.5,
                               .snapshot = &lab.snapshot,
                               .request = &lab.request,
                               .target = lab.target,
                               .target_count = targets};
}

static json_t *read_file(void)
{
    char path[temp_name_size];
    snprintf(path, sizeof path, "%s/coco.json", lab.folder);
    json_t *all = json_load_file(path, 0, NULL);
    CHECK(all && remove(path) == 0);
    return all;
}

static double number(const json_t *of, const char *key) { return json_number_value(json_object_get(of, key)); }
static double at(const json_t *of, const char *key, size_t k)
{
    return json_number_value(json_array_get(json_object_get(of, key), k));
}

static void check_annotation(const json_t *a, int image, int entity, const int bbox[4], int area, const char *why)
{
    char name[32];
    snprintf(name, sizeof name, "1:2:%d", 30 + entity);
    CHECK(number(a, "image_id") == image);
    assert_string_equal(json_string_value(json_object_get(a, "entity")), name);
    for (size_t k = 0; k < 4; k++) assert_int_equal((int)at(a, "bbox", k), bbox[k]);
    CHECK(number(a, "area") == area && number(a, "iscrowd") == (why != NULL) && number(a, "ignore") == (why != NULL));
    CHECK(number(a, "category_id") == 1 + entity % 2 && number(a, "plane_value") == entity + 1);
    CHECK(number(a, "range_m") == 1000 + entity && number(a, "pixels") == 3.5);
    const char *got = json_string_value(json_object_get(a, "ignored_as"));
    CHECK(why ? got && strcmp(got, why) == 0 : !got);
    /* x, y, width, height */
    static const double amodal[4] = {1.5, 2.5, 5.5, 1.75};
    for (size_t k = 0; k < 4; k++) CHECK(at(a, "bbox_amodal", k) == amodal[k]);
    const json_t *segmentation = json_object_get(a, "segmentation");
    CHECK(at(segmentation, "size", 0) == height && at(segmentation, "size", 1) == width);
}

/* Clutter: a category of its own, with masks by its own plane, in each image; what fills no pixel is left out, and
 * without it there is no such category. */
static void clutter_is_a_category(void **state)
{
    (void)state;
    const ClutterRecord clutter[3] = {
        {.class_name = "cow", .id = "00000000000000aa", .pixels = 4.25, .range_m = 700, .instance = 3},
        {.class_name = "fire", .id = "00000000000000bb", .pixels = 0.25, .range_m = 900, .instance = 8},
        {.class_name = "rock", .id = "00000000000000cc", .pixels = 2, .range_m = 650, .instance = 9}};
    for (int with = 0; with < 2; with++) {
        Coco *coco;
        CHECK(coco_open(&coco, lab.folder, "png", (CocoLimits){1, 0, 0}, "sha", 1) == STATUS_OK);
        CHECK(coco_begin(coco) == STATUS_OK);
        paint(".........  ..111....  ..111....  .........  .........  .........");
        target(0, (const int[]){2, 1, 5, 3}, 0.9, 4, 5);
        frame(5, 1);
        CHECK(coco_frame(coco, &lab.record, lab.plane) == STATUS_OK);
        paint(".........  .1.......  11.......  .....3...  .....3...  .........");
        lab.record.clutter = clutter, lab.record.clutter_count = with ? 3 : 0;
        CHECK(coco_clutter(coco, &lab.record, lab.plane) == STATUS_OK);
        CHECK(coco_close(coco) == STATUS_OK);

        json_t *all = read_file(), *found = json_object_get(all, "annotations");
        json_t *categories = json_object_get(all, "categories");
        CHECK(json_array_size(found) == (with ? 6 : 2));
        json_t *last = json_array_get(categories, json_array_size(categories) - 1);
        CHECK((strcmp(json_string_value(json_object_get(last, "name")), "clutter") == 0) == with);
        for (size_t k = 2; with && k < 6; k++) {
            const json_t        *a = json_array_get(found, k);
            const ClutterRecord *of = &clutter[k < 4 ? 0 : 2];
            static const int     box[2][4] = {{0, 1, 2, 2}, {5, 3, 1, 2}};
            CHECK(number(a, "id") == (int)k + 1 && number(a, "image_id") == (k % 2 ? 23 : 21));
            CHECK(number(a, "category_id") == number(last, "id") && number(last, "id") == 200);
            CHECK(number(a, "area") == (k < 4 ? 3 : 2) && number(a, "iscrowd") == 0 && number(a, "ignore") == 0);
            for (size_t i = 0; i < 4; i++) assert_int_equal((int)at(a, "bbox", i), box[k < 4 ? 0 : 1][i]);
            assert_string_equal(json_string_value(json_object_get(a, "class")), of->class_name);
            assert_string_equal(json_string_value(json_object_get(a, "clutter")), of->id);
            CHECK(number(a, "pixels") == of->pixels && number(a, "range_m") == of->range_m);
            CHECK(!json_object_get(a, "entity"));
        }
        json_decref(all);
    }
}

static void targets_are_found_or_ignored(void **state)
{
    (void)state;
    Coco            *coco;
    const CocoLimits limits = {2, 0.5, 3};
    CHECK(coco_open(&coco, lab.folder, "png", limits, "sha", 77) == STATUS_OK && coco_begin(coco) == STATUS_OK);
    paint(".........  ..111..44  ..111....  .....5...  .....5..6  3........");
    target(0, (const int[]){2, 1, 5, 3}, 0.9, -4, 5);
    target(1, (const int[]){5, 3, 7, 5}, 0.9, 9, 9);   /* fills no pixel by more than half */
    target(2, (const int[]){0, 4, 2, 6}, 0.9, 9, 9);   /* of one pixel, which is less than two */
    target(3, (const int[]){7, 1, 8, 2}, 0.49, 9, 9);  /* of two; its mask goes beyond the box */
    target(4, (const int[]){5, 3, 6, 5}, 0.5, 3, 2.9); /* at each limit; in one band below it */
    target(5, (const int[]){0, 0, 0, 0}, 0.9, 9, 9);   /* seen in the plane alone */
    target(6, (const int[]){0, 0, 0, 0}, 0, NAN, NAN); /* hidden: in no image */
    frame(5, 7);
    CHECK(coco_frame(coco, &lab.record, lab.plane) == STATUS_OK);
    CHECK(coco_close(coco) == STATUS_OK);

    json_t *all = read_file(), *images = json_object_get(all, "images"), *found = json_object_get(all, "annotations");
    CHECK(json_array_size(images) == 2 && json_array_size(found) == 12);
    /* 4 a frame, from 1: optical the first, lwir the third */
    static const char *const file[2] = {"frames/optical/000005.png", "frames/lwir/000005.png"};
    for (size_t k = 0; k < 2; k++) {
        const json_t *image = json_array_get(images, k);
        CHECK(number(image, "id") == (k ? 23 : 21) && number(image, "width") == width &&
              number(image, "height") == height);
        assert_string_equal(json_string_value(json_object_get(image, "file_name")), file[k]);
        CHECK(number(image, "frame") == 5 && number(image, "time_s") == 2.5);
    }
    static const struct {
        int         bbox[4], area;
        const char *why[2];
    } want[6] = {{{2, 1, 3, 2}, 6, {NULL, NULL}},       {{5, 3, 2, 2}, 4, {"no_mask", "no_mask"}},
                 {{0, 4, 2, 2}, 4, {"small", "small"}}, {{7, 1, 2, 1}, 2, {"hidden", "hidden"}},
                 {{5, 3, 1, 2}, 2, {NULL, "faint"}},    {{8, 4, 1, 1}, 1, {"small", "small"}}};
    for (size_t k = 0; k < 12; k++) {
        const json_t *a = json_array_get(found, k);
        CHECK(number(a, "id") == (double)k + 1);
        check_annotation(a, k < 6 ? 21 : 23, (int)k % 6, want[k % 6].bbox, want[k % 6].area, want[k % 6].why[k / 6]);
        /* of the image's band: kelvin where there are any */
        CHECK(number(a, "contrast") == (k < 6 ? 0.25 : -2.5) && !!json_object_get(a, "contrast_k") == (k >= 6));
        CHECK(number(a, "snr") == lab.target[k % 6].band[k < 6 ? BAND_OPTICAL : BAND_LWIR].snr);
    }
    const json_t *info = json_object_get(all, "info");
    CHECK(number(info, "seed") == 77 && number(info, "min_pixels") == 2 && number(info, "min_visible") == 0.5 &&
          number(info, "min_snr") == 3);
    json_decref(all);
}

/* Without limits whatever has a pixel is to be found, also of unknown share and signal; a share that is unknown fits no
 * limit. Later frames may have more entities, and larger masks. */
static void without_limits(void **state)
{
    (void)state;
    for (int limited = 0; limited < 2; limited++) {
        Coco            *coco;
        const CocoLimits limits = {1, limited ? 0.01 : 0, 0};
        CHECK(coco_open(&coco, lab.folder, "exr", limits, "sha", 0) == STATUS_OK && coco_begin(coco) == STATUS_OK);
        paint(".........  .........  ..1......  .........  .........  .........");
        target(0, (const int[]){2, 2, 3, 3}, NAN, NAN, 0);
        frame(0, 1);
        CHECK(coco_frame(coco, &lab.record, lab.plane) == STATUS_OK);
        paint("2.2.2.2.2  .2.2.2.2.  2.2.2.2.2  .2.2.2.2.  2.2.2.2.2  .2.2.2.1.");
        target(0, (const int[]){7, 5, 8, 6}, 1, NAN, 0);
        target(1, (const int[]){0, 0, 9, 6}, 1, 0, NAN);
        frame(1, 2);
        CHECK(coco_frame(coco, &lab.record, lab.plane) == STATUS_OK && coco_close(coco) == STATUS_OK);
        json_t *all = read_file(), *found = json_object_get(all, "annotations");
        CHECK(json_array_size(found) == 6);
        const int one[4] = {2, 2, 1, 1}, last[4] = {7, 5, 1, 1}, whole[4] = {0, 0, 9, 6};
        check_annotation(json_array_get(found, 0), 1, 0, one, 1, limited ? "hidden" : NULL);
        check_annotation(json_array_get(found, 2), 5, 0, last, 1, NULL);
        check_annotation(json_array_get(found, 3), 5, 1, whole, 26, NULL);
        check_annotation(json_array_get(found, 5), 7, 1, whole, 26, NULL);
        CHECK(!json_object_get(json_array_get(found, 0), "snr") && number(json_array_get(found, 1), "snr") == 0);
        json_decref(all);
    }
}

/* Ignore regions as text: all pixels of a box. A box as high as the image is one run; elsewhere its columns are runs of
 * their own. Words of pycocotools 2.0.11 for the same pixels are made of the same runs by coco_mask_text, which is held
 * against it. */
static void regions_are_masks_of_their_box(void **state)
{
    (void)state;
    for (int x0 = 0; x0 < width; x0++)
        for (int x1 = x0 + 1; x1 <= width; x1++)
            for (int y0 = 0; y0 < height; y0++)
                for (int y1 = y0 + 1; y1 <= height; y1++) {
                    CocoMaskExtent extent;
                    char           region[600], mask[600];
                    for (int i = 0; i < width * height; i++) {
                        const int x = i % width, y = i / width;
                        lab.plane[i] = x >= x0 && x < x1 && y >= y0 && y < y1;
                    }
                    coco_mask_extents(&extent, 1, lab.plane, width, height);
                    CHECK(extent.pixels == (x1 - x0) * (y1 - y0));
                    coco_mask_box_text(region, width, height, &extent);
                    coco_mask_text(mask, lab.plane, 1, width, height, &extent);
                    assert_string_equal(region, mask);
                    CHECK(strlen(region) < coco_mask_text_size(&extent) &&
                          coco_mask_text_size(&extent) <= sizeof region);
                }
}

static void a_folder_that_is_not_there(void **state)
{
    (void)state;
    Coco *coco;
    log_set_sink(check_listen, NULL);
    CHECK(coco_close(NULL) == STATUS_OK);
    CHECK(coco_open(&coco, "/nowhere/at/all", "png", (CocoLimits){1, 0, 0}, "sha", 0) == STATUS_OK);
    CHECK(coco_begin(coco) == STATUS_IO && coco_close(coco) == STATUS_OK);
    log_set_sink(NULL, NULL);
}

static int open_lab(void **state)
{
    (void)state;
    return temp_folder(lab.folder) ? 0 : -1;
}

static int close_lab(void **state)
{
    (void)state;
    return rmdir(lab.folder); /* no parts are left */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clutter_is_a_category),
        cmocka_unit_test(targets_are_found_or_ignored),
        cmocka_unit_test(without_limits),
        cmocka_unit_test(regions_are_masks_of_their_box),
        cmocka_unit_test(a_folder_that_is_not_there),
    };
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
