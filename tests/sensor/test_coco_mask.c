/* Masks as text: the words of pycocotools 2.0.11 for the same pixels, and every mask of random planes read back. */
#include "tests/check.h"

#include "sensor/publish/coco/coco.h"

enum { value = 3 };

static void check_text(const uint32_t *plane, int width, int height, const char *want, const int bbox[4],
                       long long area)
{
    CocoMaskExtent extent[value];
    coco_mask_extents(extent, value, plane, width, height);
    const CocoMaskExtent *e = &extent[value - 1];
    char                 *text = malloc(coco_mask_text_size(e));
    CHECK(text);
    coco_mask_text(text, plane, value, width, height, e);
    assert_string_equal(text, want);
    CHECK(strlen(text) < coco_mask_text_size(e));
    CHECK(e->pixels == area && e->box[0] == bbox[0] && e->box[1] == bbox[1] && e->box[2] - e->box[0] == bbox[2] &&
          e->box[3] - e->box[1] == bbox[3]);
    free(text);
}

/* '#': the value; '.': none; 'o': another. Rows separated by blanks. */
static void check_picture(const char *rows, const char *want, int x, int y, int w, int h, long long area)
{
    uint32_t  plane[256];
    const int width = (int)strcspn(rows, " ");
    int       n = 0;
    for (const char *at = rows; *at; at++)
        if (*at != ' ') plane[n++] = *at == '#' ? value : *at == 'o' ? value - 1 : 0;
    check_text(plane, width, n / width, want, (const int[]){x, y, w, h}, area);
}

static void masks_are_written_as_pycocotools_writes_them(void **state)
{
    (void)state;
    check_picture("....... ..###.. ..###o. ..###.. ....o..", ";320009", 2, 1, 3, 3, 9);
    check_picture("#### #### ####", "0<", 0, 0, 4, 3, 12);
    check_picture(".... .... ...#", ";1", 3, 2, 1, 1, 1);
    check_picture("#... .... ....", "01;", 0, 0, 1, 1, 1);
    check_picture(".#. .#. .#. .#.", "444", 1, 0, 1, 4, 4);
    check_picture(".#.#.# #.#.#. .#.#.# #.#.#.", "11110O10O10O10O10O0", 0, 0, 6, 4, 12);
    check_picture(".##.. .##.. .#... .#... .#.#. .#.##", "688JMO", 1, 0, 4, 6, 11);

    uint32_t *far = calloc(720 * 486, sizeof *far);
    CHECK(far);
    far[0] = far[720 * 486 - 1] = value;
    check_text(far, 720, 486, "01nfe:0", (const int[]){0, 0, 720, 486}, 2);
    free(far);

    uint32_t pattern[60 * 37];
    for (int y = 0; y < 60; y++)
        for (int x = 0; x < 37; x++)
            pattern[y * 37 + x] = (x * x * 7 + y * 13 + x * y) % 5 == 0 && y > 3 && x > 2 && x < 30 ? value : 0;
    check_text(
        pattern, 37, 60,
        "k514000000000000000000020N00000000000000000000010O000000000000000000070I0000000000000000000Q20oM0000000000000"
        "00000020N00000000000000000000010O000000000000000000070I0000000000000000000Q20oM000000000000000000020N0000000"
        "0000000000000010O000000000000000000070I0000000000000000000Q20oM000000000000000000020N00000000000000000000010"
        "O000000000000000000070I0000000000000000000Q20oM000000000000000000020N00000000000000000000010O000000000000000"
        "000070I0000000000000000000Q20oM000000000000000000020N000000000000000000000P=",
        (const int[]){3, 4, 27, 56}, 248);
}

/* The format read back, by its description: groups of five bits, the second run before added from the fourth on. */
static void read_back(uint8_t *mask, const char *text, size_t pixels)
{
    long long run[3] = {0};
    size_t    at = 0;
    int       count = 0;
    for (const char *c = text; *c; count++) {
        long long number = 0;
        int       shift = 0, group;
        do {
            CHECK(*c >= 48 && *c < 112);
            group = *c++ - 48;
            number |= (long long)(group & 31) << shift;
            shift += 5;
        } while (group & 32);
        if (group & 16) number -= 1LL << shift;
        if (count > 2) number += run[1];
        CHECK(number >= 0 && at + (size_t)number <= pixels && (count == 0 || number > 0));
        for (long long i = 0; i < number; i++) mask[at++] = count & 1;
        run[1] = run[0];
        run[0] = number;
    }
    CHECK(at == pixels);
}

static void every_mask_reads_back(void **state)
{
    (void)state;
    enum { most = 60 };
    uint32_t plane[most * most];
    uint8_t  mask[most * most];
    for (uint32_t n = 0; n < 600; n++) {
        const int width = 1 + (int)(random_uniform(1, 0, n, 0) * most);
        const int height = 1 + (int)(random_uniform(1, 0, n, 1) * most);
        const int count = 1 + (int)(random_uniform(1, 0, n, 2) * 4), block = 1 + (int)(random_uniform(1, 0, n, 3) * 9);
        const double fill = random_uniform(1, 0, n, 4);
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const double u = random_uniform(2, n, (uint32_t)(y / block), (uint64_t)(x / block));
                plane[y * width + x] = u < fill ? 1 + (uint32_t)(u / fill * count) : 0;
            }
        CocoMaskExtent extent[4];
        coco_mask_extents(extent, count, plane, width, height);
        for (int k = 0; k < count; k++) {
            long long pixels = 0;
            if (extent[k].pixels == 0) continue;
            const size_t size = coco_mask_text_size(&extent[k]);
            char        *text = malloc(size);
            CHECK(text);
            coco_mask_text(text, plane, (uint32_t)k + 1, width, height, &extent[k]);
            CHECK(strlen(text) < size);
            read_back(mask, text, (size_t)width * (size_t)height);
            free(text);
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++) {
                    const bool is = plane[y * width + x] == (uint32_t)k + 1;
                    CHECK(mask[x * height + y] == is);
                    pixels += is;
                    const int *box = extent[k].box;
                    CHECK(!is || (x >= box[0] && x < box[2] && y >= box[1] && y < box[3]));
                }
            CHECK(pixels == extent[k].pixels);
        }
    }
}

/* A whole box is the mask of a plane that has the value just there. */
static void a_box_is_the_mask_of_its_pixels(void **state)
{
    (void)state;
    enum { width = 7, height = 5, area = width * height };
    for (int code = 0; code < width * height * width * height; code++) {
        const int            a = code % area, b = code / area;
        const CocoMaskExtent box = {.box = {a % width, a / width, b % width + 1, b / width + 1}};
        if (box.box[2] <= box.box[0] || box.box[3] <= box.box[1]) continue;
        uint32_t       plane[area] = {0};
        CocoMaskExtent extent[1];
        char           text[7 * (width * (height + 1) + 2) + 1], want[sizeof text];
        for (int y = box.box[1]; y < box.box[3]; y++)
            for (int x = box.box[0]; x < box.box[2]; x++) plane[y * width + x] = 1;
        coco_mask_extents(extent, 1, plane, width, height);
        CHECK(memcmp(extent->box, box.box, sizeof box.box) == 0 && coco_mask_text_size(&box) <= sizeof text);
        coco_mask_text(want, plane, 1, width, height, extent);
        coco_mask_box_text(text, width, height, &box);
        assert_string_equal(text, want);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(masks_are_written_as_pycocotools_writes_them),
        cmocka_unit_test(every_mask_reads_back),
        cmocka_unit_test(a_box_is_the_mask_of_its_pixels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
