/* The files of a frame: which are written, with which planes and words beside them, and what is rounded; of a picture
 * made by hand, read back. labels: threads */
#include "tests/check.h"

#include "sensor/publish/consumers/consume_pairs.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"

#include <float.h>
#include <jansson.h>

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

/* ---- consumers that write such files ------------------------------------------------------------- */

/* A frame with the picture, and without its second entity, which was at all pixels of value 2. */
static Frame *frame_of(Arena *arena)
{
    static Frame       frame;
    static FrameView   without;
    static DisEntityId taken[1];
    frame = (Frame){.number = 42,
                    .time_s = 1.25,
                    .unix_s = 1e9 + 0.5,
                    .without = &without,
                    .taken = taken,
                    .taken_count = 1,
                    .request = lab.request,
                    .world = &lab.world,
                    .arena = arena};
    strcpy(frame.host, "1:2:3");
    taken[0] = lab.entity[1].id;
    frame.seen = (FrameView){.picture = lab.picture, .snapshot = lab.snapshot};
    frame.seen.plane_count = frame_planes(frame.seen.plane, &frame.seen.picture, &frame.request);
    without = frame.seen;
    memcpy(frame.display, lab.display, sizeof frame.display);
    return &frame;
}

static const char *text_at(const json_t *of, const char *key) { return json_string_value(json_object_get(of, key)); }

static void a_pair_in_four_folders(void **state)
{
    (void)state;
    static const Sensors            none = {0};
    static const char *const        there[] = {"pairs/clean/frames/lwir/000042.png",
                                               "pairs/background/frames/lwir/000042.png",
                                               "pairs/background/frames/lwir/000042.exr",
                                               "pairs/background/frames/radar/000042.exr",
                                               "pairs/background/frames/radar/000042.png",
                                               "pairs/background/frames/truth/000042.exr",
                                               "pairs/background/profiles/radar/000042.csv",
                                               "pairs/background_clean/frames/lwir/000042.png"},
                             *const not_there[] = {"pairs/clean/frames/lwir/000042.exr",
                                                   "pairs/clean/frames/radar",
                                                   "pairs/clean/frames/truth",
                                                   "pairs/background_clean/frames/lwir/000042.exr",
                                                   "pairs/clean/frames/mwir",
                                                   "pairs/background/raw"};
    /* target, noise; folder of radiance and of displays */
    static const struct {
        bool        target, noise;
        const char *radiance, *shown;
    } member[4] = {{true, true, "", ""},
                   {true, false, "", "pairs/clean/"},
                   {false, true, "pairs/background/", "pairs/background/"},
                   {false, false, "pairs/background/", "pairs/background_clean/"}};
    for (int png = 0; png < 2; png++) {
        Consumer *pairs;
        Arena    *arena = arena_create();
        picture();
        lab.config.publish.pairs = PUBLISH_PAIRS_TARGET;
        lab.config.publish.png = png;
        const PairsOf of = {.out = lab.out,
                            .config = &lab.config,
                            .config_sha256 = "abc",
                            .pool = lab.pool,
                            .bands = lab.request.bands,
                            .sensors = &none};
        CHECK(arena && frame_files_prepare(lab.out, 0, 0) == STATUS_OK);
        CHECK(consume_pairs(&pairs, &of) == STATUS_OK && pairs->begin(pairs) == STATUS_OK);
        CHECK((pairs->wants & (WANT_WITHOUT | WANT_PLANES | WANT_SHA256 | WANT_DISPLAY)) ==
              (WANT_WITHOUT | WANT_PLANES | WANT_SHA256 | WANT_DISPLAY));
        CHECK(pairs->put(pairs, frame_of(arena)) == STATUS_OK && pairs->close(pairs) == STATUS_OK);
        for (size_t k = 0; k < sizeof there / sizeof *there; k++)
            if (is_there(there[k]) != (png || !strstr(there[k], ".png"))) fail_msg("%s", there[k]);
        for (size_t k = 0; k < sizeof not_there / sizeof *not_there; k++)
            if (is_there(not_there[k])) fail_msg("%s is there", not_there[k]);
        json_t *line = json_load_file(file("pairs.jsonl"), 0, NULL), *members = json_object_get(line, "members");
        CHECK(line && json_integer_value(json_object_get(line, "frame")) == 42 && json_array_size(members) == 4);
        CHECK(json_array_size(json_object_get(line, "removed")) == 1);
        assert_string_equal(json_string_value(json_array_get(json_object_get(line, "removed"), 0)), "1:2:44");
        CHECK(strlen(text_at(line, "frame_sha256")) == 64 &&
              strcmp(text_at(line, "frame_sha256"), text_at(line, "background_sha256")) == 0);
        for (size_t k = 0; k < 4; k++) {
            const json_t *m = json_array_get(members, k), *bands = json_object_get(m, "bands");
            char          want[96];
            CHECK(json_is_true(json_object_get(m, "target")) == member[k].target &&
                  json_is_true(json_object_get(m, "noise")) == member[k].noise);
            snprintf(want, sizeof want, "%sframes/truth/000042.exr", member[k].radiance);
            assert_string_equal(text_at(m, "truth"), want);
            CHECK(json_object_size(bands) == 2);
            for (int b = 0; b < 2; b++) {
                const char   *name = b ? "radar" : "lwir";
                const json_t *band = json_object_get(bands, name);
                snprintf(want, sizeof want, "%sframes/%s/000042.exr", member[k].radiance, name);
                assert_string_equal(text_at(band, "radiance"), want);
                snprintf(want, sizeof want, "%sframes/%s/000042.png", b ? member[k].radiance : member[k].shown, name);
                if (png) assert_string_equal(text_at(band, "display"), want);
                else CHECK(!text_at(band, "display"));
                CHECK(!text_at(band, "raw") && !!json_object_get(band, "level") == (png && !b));
            }
        }
        json_decref(line);
        arena_destroy(arena);
    }
    frame_files_prepare(lab.out, 0, 0);
    Consumer *pairs;
    log_set_sink(check_listen, NULL);
    const PairsOf of = {.out = "/dev/null/out",
                        .config = &lab.config,
                        .config_sha256 = "",
                        .pool = lab.pool,
                        .bands = 1,
                        .sensors = &none};
    CHECK(consume_pairs(&pairs, &of) == STATUS_OK && pairs->begin(pairs) == STATUS_IO &&
          pairs->close(pairs) == STATUS_OK);
    log_set_sink(NULL, NULL);
}

/* The newest display of each band that has one, as 8 bits of its own values. */
static void the_latest_display(void **state)
{
    (void)state;
    uint8_t   got[3 * pixels], want[3 * pixels];
    ImageInfo info;
    Consumer *latest;
    picture();
    CHECK(consume_latest(&latest, lab.out, false) == STATUS_OK && latest->wants == WANT_DISPLAY);
    CHECK(latest->begin(latest) == STATUS_OK);
    Frame *frame = frame_of(NULL);
    for (int n = 0; n < 2; n++) { /* then in colour */
        for (int i = 0; i < pixels; i++) lab.shown[i] = (float)(i + n) / 16;
        if (n)
            frame->display[BAND_LWIR].planes = 3,
            frame->display[BAND_LWIR].plane[1] = frame->display[BAND_LWIR].plane[2] = lab.shown;
        frame->display[BAND_MWIR].planes = 0;
        CHECK(latest->put(latest, frame) == STATUS_OK);
        CHECK(image_info(&info, file("latest/lwir.png")) == STATUS_OK && info.channels == (n ? 3 : 1) &&
              info.bits == 8);
        CHECK(image_read_png(got, file("latest/lwir.png")) == STATUS_OK);
        frame_display_quantise(want, &frame->display[BAND_LWIR], pixels, 8);
        assert_memory_equal(got, want, (size_t)(n ? 3 : 1) * pixels);
    }
    CHECK(is_there("latest/optical.png") && is_there("latest/radar.png") && !is_there("latest/mwir.png"));
    CHECK(latest->close(latest) == STATUS_OK);
    log_set_sink(check_listen, NULL);
    for (int patient = 0; patient < 2; patient++) {
        CHECK(consume_latest(&latest, "/dev/null/out", patient) == STATUS_OK && latest->begin(latest) == STATUS_IO);
        CHECK(latest->put(latest, frame) == STATUS_IO && latest->put(latest, frame) == STATUS_IO);
        CHECK(latest->close(latest) == STATUS_OK);
    }
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
        cmocka_unit_test(truth_has_planes_and_names),
        cmocka_unit_test(planes_are_chosen),
        cmocka_unit_test(a_profile_by_its_bins),
        cmocka_unit_test(floats_are_rounded),
        cmocka_unit_test(what_cannot_be_written_is_said),
        cmocka_unit_test(a_pair_in_four_folders),
        cmocka_unit_test(the_latest_display),
    };
    return cmocka_run_group_tests(tests, open_lab, close_lab);
}
