/* The files of a frame: which are written, with which planes and words beside them, and what is rounded; of a picture
 * made by hand, read back. labels: threads */
#include "tests/check.h"

#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"

#include <float.h>

enum { width = 4, height = 2, pixels = width * height, bins = 3 };

static struct {
    char           out[temp_path_size];
    Catalog       *catalog;
    World          world;
    Material       material[4];
    SnapshotEntity entity[2];
    Snapshot       snapshot;
    RenderRequest  request;
    Picture        picture;
    FrameDisplay   display[BAND_COUNT];
    Config         config;
    Pool          *pool;
    float          lwir[pixels], radar[pixels], range_m[pixels], temp_k[pixels], normal[3][pixels], shown[pixels];
    uint32_t       id[pixels], part[pixels], material_of[pixels], instance[pixels];
    uint8_t        cover[pixels];
    uint16_t       counts[pixels];
    double         profile[bins * radar_bounces];
} lab;

static const char *file(const char *name)
{
    static char path[temp_name_size];
    snprintf(path, sizeof path, "%s/%s", lab.out, name);
    return path;
}

static bool is_there(const char *name) { return access(file(name), F_OK) == 0; }

static void write_frame(bool png, bool raw)
{
    const FrameFiles frame = {.out = lab.out,
                              .config = &lab.config,
                              .world = &lab.world,
                              .picture = &lab.picture,
                              .snapshot = &lab.snapshot,
                              .request = &lab.request,
                              .host = "1:2:3",
                              .config_sha256 = "abc",
                              .frame = 42,
                              .time_s = 1.25,
                              .unix_s = 1e9 + 0.5,
                              .png = png,
                              .raw = raw,
                              .display = lab.display};
    char             hash[sha256_text_size];
    CHECK(frame_files_prepare(lab.out, 1 << BAND_LWIR | 1 << BAND_RADAR | frame_truth, 1 << BAND_LWIR) == STATUS_OK);
    CHECK(frame_files_write(hash, &frame, lab.pool) == STATUS_OK && strlen(hash) == 64);
}

static void picture(void)
{
    lab.config = config_default();
    lab.request = (RenderRequest){.view = {.width = width, .height = height},
                                  .bands = 1 << BAND_LWIR | 1 << BAND_RADAR,
                                  .truth = true,
                                  .profile_near_m = 100,
                                  .profile_bin_m = 2,
                                  .profile_bins = bins};
    for (int i = 0; i < pixels; i++) {
        lab.lwir[i] = (float)(30 + i), lab.radar[i] = (float)i;
        lab.range_m[i] = (float)(100 + i), lab.temp_k[i] = (float)(280 + i);
        for (int k = 0; k < 3; k++) lab.normal[k][i] = (float)(k + 1) / 4;
        lab.id[i] = (uint32_t)i % 3, lab.part[i] = (uint32_t)i % 2, lab.material_of[i] = (uint32_t)i % 4;
        lab.instance[i] = 7, lab.cover[i] = (uint8_t)(1 + i % 2);
        lab.shown[i] = (float)i / pixels, lab.counts[i] = (uint16_t)(1000 + i);
    }
    for (int i = 0; i < bins * radar_bounces; i++) lab.profile[i] = i + 0.5;
    lab.picture = (Picture){.width = width,
                            .height = height,
                            .lwir = lab.lwir,
                            .radar = lab.radar,
                            .profile = lab.profile,
                            .range_m = lab.range_m,
                            .entity = lab.id,
                            .part = lab.part,
                            .material = lab.material_of,
                            .temp_k = lab.temp_k,
                            .normal = {lab.normal[0], lab.normal[1], lab.normal[2]}};
    for (int b = 0; b < BAND_COUNT; b++)
        lab.display[b] =
            (FrameDisplay){.planes = 1, .plane = {lab.shown}, .detector = detector_default_config(), .level = {0, 1}};
    lab.display[BAND_LWIR].counts[0] = lab.counts;
}

static bool has_channel(const ImageInfo *info, const char *name)
{
    for (int k = 0; k < info->channels; k++)
        if (strcmp(info->name[k], name) == 0) return true;
    return false;
}

static void check_text(const char *path, const char *attribute, const char *want)
{
    char got[1024];
    CHECK(image_read_string(got, sizeof got, path, attribute));
    assert_string_equal(got, want);
}

/* Values of the planes, and the names that their numbers stand for: entities by the snapshot, materials without "none",
 * parts of the models that are in the frame. */
static void truth_has_planes_and_names(void **state)
{
    (void)state;
    static const char *const planes[] = {"range_m", "entity", "part", "material", "temp_k", "emissivity_lwir"};
    float                    value[pixels];
    uint32_t                 number[pixels];
    ImageInfo                info;
    double                   read;
    picture();
    write_frame(false, false);
    CHECK(image_info(&info, file("frames/truth/000042.exr")) == STATUS_OK && info.width == width &&
          info.height == height);
    for (size_t k = 0; k < sizeof planes / sizeof *planes; k++)
        if (!has_channel(&info, planes[k])) fail_msg("no %s", planes[k]);
    CHECK(!has_channel(&info, "emissivity_mwir") && !has_channel(&info, "instance") && !has_channel(&info, "cover"));
    CHECK(image_read_u32(number, file("frames/truth/000042.exr"), "entity") == STATUS_OK &&
          memcmp(number, lab.id, sizeof number) == 0);
    CHECK(image_read_f32(value, file("frames/truth/000042.exr"), "range_m") == STATUS_OK &&
          memcmp(value, lab.range_m, sizeof value) == 0);
    CHECK(image_read_f32(value, file("frames/truth/000042.exr"), "emissivity_lwir") == STATUS_OK);
    for (int i = 0; i < pixels; i++)
        CHECK(i % 4 ? fabsf(value[i] - (1 - 0.125f * (float)(i % 4))) < 1e-6f : isnan(value[i]));
    const char *path = file("frames/truth/000042.exr");
    check_text(path, "band", "truth");
    check_text(path, "entity_ids", "1:2:3,1:2:44");
    check_text(path, "material_names", "steel,grass,rock");
    check_text(path, "part_names", "marker:block,plate");
    check_text(path, "host", "1:2:3");
    check_text(path, "config_sha256", "abc");
    check_text(path, "DateTime", "2001:09:09 01:46:40");
    char none[64];
    CHECK(!image_read_string(none, sizeof none, path, "surface_names") &&
          !image_read_string(none, sizeof none, path, "unit"));
    CHECK(image_read_number(&read, path, "frame") && read == 42 && image_read_number(&read, path, "time_s") &&
          read == 1.25);
    CHECK(!image_read_number(&read, path, "mantissa_bits"));

    path = file("frames/lwir/000042.exr");
    CHECK(image_read_f32(value, path, "Y") == STATUS_OK && memcmp(value, lab.lwir, sizeof value) == 0);
    check_text(path, "band", "lwir");
    check_text(path, "unit", "W/(m2 sr)");
    CHECK(!image_read_string(none, sizeof none, path, "entity_ids"));
    CHECK(!is_there("frames/lwir/000042.png") && !is_there("raw/lwir/000042.png") &&
          !is_there("frames/truth/000042.png"));

    /* both models in the frame; with plants, surfaces */
    lab.entity[1].model = catalog_find(lab.catalog, (DisEntityType){.kind = 2}, &(Origin){ORIGIN_BASE}, NULL);
    lab.picture.instance = lab.instance, lab.picture.cover = lab.cover;
    write_frame(false, false);
    char names[1024], want[256];
    path = file("frames/truth/000042.exr");
    CHECK(image_read_string(names, sizeof names, path, "part_names"));
    CHECK(strncmp(names, "marker:block,plate;corner_reflector:", 36) == 0 || strstr(names, ";marker:block,plate"));
    CHECK(image_read_string(names, sizeof names, path, "surface_names"));
    snprintf(want, sizeof want, "%s,%s,", surface_name((SurfaceClass)1), surface_name((SurfaceClass)2));
    CHECK(strncmp(names, want, strlen(want)) == 0);
    int commas = 0;
    for (const char *c = names; *c; c++) commas += *c == ',';
    CHECK(commas == SURFACE_COUNT - 2);
    lab.entity[1].model = lab.entity[0].model;
}

static void planes_are_chosen(void **state)
{
    (void)state;
    ImageInfo info;
    picture();
    strcpy(lab.config.publish.planes, "range,emissivity");
    write_frame(true, true);
    CHECK(image_info(&info, file("frames/truth/000042.exr")) == STATUS_OK && info.channels == 2);
    CHECK(has_channel(&info, "range_m") && has_channel(&info, "emissivity_lwir"));
    CHECK(is_there("frames/truth/000042.png") && is_there("frames/lwir/000042.png") &&
          is_there("frames/radar/000042.png"));
    uint16_t counts[pixels];
    CHECK(image_read_png(counts, file("raw/lwir/000042.png")) == STATUS_OK &&
          memcmp(counts, lab.counts, sizeof counts) == 0);
    strcpy(lab.config.publish.planes, "none");
    write_frame(true, false);
    CHECK(!is_there("frames/truth/000042.exr") && !is_there("frames/truth/000042.png") &&
          is_there("frames/lwir/000042.exr"));
    CHECK(!is_there("raw/lwir/000042.png"));
    write_frame(false, true); /* counts alone */
    CHECK(is_there("raw/lwir/000042.png") && !is_there("frames/lwir/000042.png") &&
          !is_there("frames/radar/000042.png"));
    lab.picture.profile = NULL;
    write_frame(false, false);
    CHECK(!is_there("profiles/radar/000042.csv"));
}

static void a_profile_by_its_bins(void **state)
{
    (void)state;
    char  *text;
    size_t octets;
    picture();
    write_frame(false, false);
    CHECK(text_read_file(&text, &octets, "test", file("profiles/radar/000042.csv"), 1 << 16) == STATUS_OK);
    /* from 100 m, bins of 2 m: their middles */
    assert_string_equal(text, "# range profile, unit relative, model pseudo-radar; a bin is 2 m, its middle is given\n"
                              "range_m,bounce_1,bounce_2,bounce_3\n"
                              "101.000,0.5,1.5,2.5\n103.000,3.5,4.5,5.5\n105.000,6.5,7.5,8.5\n");
    free(text);
}

/* To eight bits of mantissa: the nearest of steps of 2^-8 between 1 and 2, the larger of two as near; what would become
 * infinite, is it, or is no number stays; numbers of things stay. */
static void floats_are_rounded(void **state)
{
    (void)state;
    static const float from[pixels] =
        {1 + 0x1p-9f, 1 + 0x1.fp-10f, 1.5f + 0x1.1p-9f, -(1 + 0x1.8p-8f), INFINITY, FLT_MAX, NAN, 0},
                       want[pixels] = {1 + 0x1p-8f, 1, 1.5f + 0x1p-8f, -(1 + 0x1p-7f), INFINITY, FLT_MAX, NAN, 0};
    float    got[pixels];
    uint32_t number[pixels];
    double   bits;
    picture();
    lab.config.publish.exr_bits = 8;
    memcpy(lab.lwir, from, sizeof from);
    memcpy(lab.range_m, from, sizeof from);
    for (int i = 0; i < pixels; i++) lab.id[i] = 0x12345u + (uint32_t)i;
    write_frame(false, false);
    for (int k = 0; k < 2; k++) {
        const char *path = file(k ? "frames/truth/000042.exr" : "frames/lwir/000042.exr");
        CHECK(image_read_f32(got, path, k ? "range_m" : "Y") == STATUS_OK);
        for (int i = 0; i < pixels; i++) CHECK(isnan(want[i]) ? isnan(got[i]) : got[i] == want[i]);
        CHECK(image_read_number(&bits, path, "mantissa_bits") && bits == 8);
    }
    CHECK(image_read_u32(number, file("frames/truth/000042.exr"), "entity") == STATUS_OK &&
          memcmp(number, lab.id, sizeof number) == 0);
    CHECK(isnan(lab.lwir[6]) && lab.lwir[0] == from[0]); /* the picture itself stays as it is */
}

static void what_cannot_be_written_is_said(void **state)
{
    (void)state;
    char date[32];
    frame_date(date, 0);
    assert_string_equal(date, "1970:01:01 00:00:00");
    frame_date(date, -0.5);
    assert_string_equal(date, "1969:12:31 23:59:59");
    frame_date(date, 1e300);
    assert_string_equal(date, "1970:01:01 00:00:00");
    picture();
    const FrameFiles nowhere = {.out = "/nowhere/at/all",
                                .config = &lab.config,
                                .world = &lab.world,
                                .picture = &lab.picture,
                                .snapshot = &lab.snapshot,
                                .request = &lab.request,
                                .host = "",
                                .config_sha256 = "",
                                .display = lab.display};
    log_set_sink(check_listen, NULL);
    CHECK(frame_files_write(NULL, &nowhere, lab.pool) == STATUS_IO);
    CHECK(strstr(check_said, "/nowhere/at/all"));
    char        path[frame_path_size];
    static char longer[frame_path_size + 8];
    memset(longer, 'x', sizeof longer - 1);
    CHECK(!frame_path(path, &(FrameFiles){.out = longer}, "frames", "lwir", "exr") && strstr(check_said, "too long"));
    CHECK(frame_path(path, &(FrameFiles){.out = "o", .frame = 7}, "frames", "lwir", "exr"));
    assert_string_equal(path, "o/frames/lwir/000007.exr");
    log_set_sink(NULL, NULL);
}

static int open_lab(void **state)
{
    (void)state;
    static const char *const names[4] = {"none", "steel", "grass", "rock"};
    char                     path[text_file_size];
    text_file(path, "type,model,origin\n2.*.*.*.*.*.*,corner_reflector,base\n*.*.*.*.*.*.*,marker,base\n");
    const Status status = catalog_open(&lab.catalog, path, 0.01);
    remove(path);
    if (status != STATUS_OK || !temp_folder(lab.out) || pool_create(&lab.pool, 2) != STATUS_OK) return -1;
    lab.world.catalog = lab.catalog;
    for (int k = 0; k < 4; k++) {
        snprintf(lab.material[k].name, sizeof lab.material[k].name, "%s", names[k]);
        lab.material[k].rho_lwir = 0.1f * (float)k, lab.material[k].tau_lwir = 0.025f * (float)k;
    }
    lab.world.materials = (Materials){.count = 4, .material = lab.material};
    const DisEntityType type = {.kind = 1};
    for (int k = 0; k < 2; k++)
        lab.entity[k] = (SnapshotEntity){.id = {1, 2, (uint16_t)(3 + 41 * k)},
                                         .model = catalog_find(lab.catalog, type, &(Origin){ORIGIN_BASE}, NULL)};
    lab.snapshot = (Snapshot){.count = 2, .entity = lab.entity};
    return 0;
}

static int close_lab(void **state)
{
    (void)state;
    char command[temp_path_size + 16];
    pool_destroy(lab.pool);
    catalog_close(lab.catalog);
    snprintf(command, sizeof command, "rm -rf '%s'", lab.out);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(truth_has_planes_and_names),     cmocka_unit_test(planes_are_chosen),
        cmocka_unit_test(a_profile_by_its_bins),          cmocka_unit_test(floats_are_rounded),
        cmocka_unit_test(what_cannot_be_written_is_said),
    };
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
