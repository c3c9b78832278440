/* tests/sensor/test_saved_fields.c: fields of a frame file: one line writes and reads each, a list of records takes
 * its least size from them, and older versions lack what came later. */
#include "tests/check.h"

#include "sensor/verify/saved_frame/saved_frame_private.h"

typedef struct Toy {
    int    number;
    double metres;
    float  warmth[2];
    char   name[6];
    bool   new_flag; /* of files of version 4 */
} Toy;

typedef struct Toys {
    const char *title;
    int         count;
    Toy        *toy;
} Toys;

enum { toy_octets = 4 + 8 + 2 * 4 + 6, most_toys = 1000 };

static void toy_fields(Fields *f, void *record)
{
    Toy *t = record;
    field_int(f, "number", &t->number, -3, 7);
    field_real(f, "metres", &t->metres, 0, 100);
    field_floats(f, "warmth", t->warmth, 2, -1, 1);
    field_chars(f, "name", t->name, sizeof t->name);
    if (f->version >= 4) field_bool(f, "flag", &t->new_flag); /* a new field is such a line */
    else t->new_flag = true;
}

static void fields(Fields *f, Toys *toys)
{
    field_text(f, &toys->title, 20);
    field_list(f, &toys->count, (void **)&toys->toy, sizeof *toys->toy, most_toys, toy_fields);
}

static ByteSink written(const Toys *toys, int version)
{
    ByteSink sink = {0};
    Toys     copy = *toys;
    fields(&(Fields){.to = &sink, .version = version}, &copy);
    return sink;
}

/* What is read of these octets; a fault, or that they end too early, is in *f. */
static Toys read_back(Fields *f, ByteSource *from, const uint8_t *octets, size_t count, int version, Arena *arena)
{
    Toys toys = {0};
    *from = (ByteSource){octets, octets + count, false};
    *f = (Fields){.from = from, .version = version, .arena = arena};
    fields(f, &toys);
    return toys;
}

static void what_is_written_is_read(void **state)
{
    (void)state;
    Toy        some[2] = {{-3, 12.25, {0.5f, -1}, "one", false}, {7, 0, {1, 0.125f}, "other", true}};
    const Toys toys = {"a title", 2, some};
    Arena     *arena = arena_create();
    Fields     f;
    ByteSource from;
    for (int version = 3; version <= 4; version++) {
        const int octets = toy_octets + (version >= 4 ? 4 : 0);
        ByteSink  sink = written(&toys, version);
        assert_int_equal(sink.count, 4 + strlen(toys.title) + 4 + 2 * (size_t)octets);
        const Toys got = read_back(&f, &from, sink.bytes, sink.count, version, arena);
        CHECK(fields_good(&f) && from.at == from.end && got.count == 2);
        assert_string_equal(got.title, "a title");
        for (int i = 0; i < 2; i++) {
            const Toy *t = &got.toy[i];
            CHECK(t->number == some[i].number && t->metres == some[i].metres);
            CHECK(memcmp(t->warmth, some[i].warmth, sizeof t->warmth) == 0 && strcmp(t->name, some[i].name) == 0);
            CHECK(t->new_flag == (version >= 4 ? some[i].new_flag : true));
        }
        /* fewer octets: it is said that they end too early, of no field that it is out of range */
        for (size_t less = 1; less < sink.count; less++) {
            const Toys part = read_back(&f, &from, sink.bytes, sink.count - less, version, arena);
            CHECK(!fields_good(&f) && !f.fault && part.count == 0 && !part.toy);
        }
        sink_free(&sink);
    }
    arena_destroy(arena);
}

/* Each field out of its range is named; the twin, in its range, is not. */
static void what_is_out_of_range_is_named(void **state)
{
    (void)state;
    Arena *arena = arena_create();
    static const struct {
        Toy         toy;
        const char *fault;
    } cases[] = {{{-4, 1, {0}, "", false}, "number"},
                 {{8, 1, {0}, "", false}, "number"},
                 {{0, NAN, {0}, "", false}, "metres"},
                 {{0, 100.5, {0}, "", false}, "metres"},
                 {{0, 1, {0, 1.5f}, "", false}, "warmth"},
                 {{0, 1, {NAN, 0}, "", false}, "warmth"},
                 {{0, 1, {0}, {'a', 'b', 'c', 'd', 'e', 'f'}, false}, "name"},
                 {{7, 100, {1, -1}, "abcde", true}, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Toy        toy = cases[i].toy;
        Fields     f;
        ByteSource from;
        ByteSink   sink = written(&(Toys){"", 1, &toy}, 4);
        read_back(&f, &from, sink.bytes, sink.count, 4, arena);
        if (cases[i].fault) assert_string_equal(f.fault, cases[i].fault);
        else CHECK(fields_good(&f));
        sink_free(&sink);
    }
    arena_destroy(arena);
}

/* Counts that no file of this size can have, and more than the list may have, are refused before there is memory for
 * them. */
static void a_count_is_no_more_than_the_octets_hold(void **state)
{
    (void)state;
    Arena         *arena = arena_create();
    Fields         f;
    ByteSource     from;
    static uint8_t octets[8 + (most_toys + 1) * (toy_octets + 4)];
    for (uint32_t count = 0; count < 4; count++)
        for (int held = 0; held < 4; held++) {
            memset(octets, 0, sizeof octets);
            memcpy(octets + 4, &count, sizeof count);
            const Toys got = read_back(&f, &from, octets, 8 + (size_t)held * (toy_octets + 4), 4, arena);
            CHECK(fields_good(&f) == ((int)count <= held) && got.count == (fields_good(&f) ? (int)count : 0));
        }
    for (uint32_t count = most_toys; count <= most_toys + 1; count++) {
        memcpy(octets + 4, &count, sizeof count);
        read_back(&f, &from, octets, sizeof octets, 4, arena);
        CHECK(fields_good(&f) == (count == most_toys));
    }
    arena_destroy(arena);
}

/* ---- files of older versions --------------------------------------------------------------------- */

static void identity(double r[9])
{
    for (int k = 0; k < 9; k++) r[k] = k % 4 == 0;
}

/* A frame with one of everything that came with a version after the first. */
static SavedFrame frame_of_now(void)
{
    static SnapshotEntity   entity;
    static GroundStand      stand;
    static float            patch_k[2] = {290, 310};
    static const WoodsPlace place[2] = {{{1, 2}}, {{3, 4}}};
    SavedFrame              file = {.version = "1",
                                    .host = "1:2:3",
                                    .config_sha256 = "",
                                    .settings = "seed: 1\n",
                                    .planted = true,
                                    .ground_km2 = 1.5};
    /* what writes an older version changes what it writes */
    entity = (SnapshotEntity){.model = -1, .p_ecef = {6378137, 0, 0}, .first_patch = 0, .patches = 2, .dt_k = 4};
    stand = (GroundStand){.p_ecef = {6378137, 0, 0},
                          .low_m = {-4, -2, -3},
                          .high_m = {4, 2, 0},
                          .to_s = 60,
                          .blow = {.radius_m = 0.5f, .speed_mps = 20, .excess_k = 100, .to_s = 60}};
    identity(entity.r_ecef_from_body), identity(stand.r_ecef_from_body);
    file.snapshot = (Snapshot){.count = 1, .entity = &entity, .patch_count = 2, .patch_k = patch_k};
    file.snapshot.marks.stands = 1, file.snapshot.marks.stand = &stand;
    file.request = (RenderRequest){.view = {.width = 16, .height = 12, .focal_px = 30},
                                   .bands = 1,
                                   .samples = 1,
                                   .hidden_entity = -1,
                                   .sampling = SAMPLING_QUARTER,
                                   .refraction = true};
    file.eye.host_index = -1;
    identity(file.request.view.r_enu_from_cam), identity(file.eye.r_ecef_from_cam), identity(file.r_ecef_from_body);
    file.ground = (LandscapeParts){.invented = true, .config = landscape_default_config()};
    file.woods =
        (WoodsConfig){.half_width_m = 500, .most_trees = 70, .place_count = 2, .place = place, .far_half_m = 20000};
    return file;
}

static void ground_fields(Fields *f, SavedFrame *file) { saved_fields_ground(f, file, NULL); }

enum { part_request, part_woods, part_marks, part_snapshot, changed_parts, parts = 10 };

static const struct {
    const char *name;
    void (*fields)(Fields *f, SavedFrame *file);
} part[parts] = {{"request", saved_fields_request}, {"woods", saved_fields_woods},
                 {"marks", saved_fields_marks},     {"snapshot", saved_fields_snapshot},
                 {"about", saved_fields_about},     {"settings", saved_fields_settings},
                 {"tables", saved_fields_tables},   {"models", saved_fields_models},
                 {"planes", saved_fields_planes},   {"ground", ground_fields}};

/* A file that says it is of a version, with chunks of another or the same. octets: of its chunks, plain. */
static ByteSink file_as(size_t octets[parts], uint32_t says, int version)
{
    SavedFrame frame = frame_of_now();
    ByteSink   file = {0};
    sink_bytes(&file, "PVFRAME\n", 8);
    sink_bytes(&file, &says, sizeof says);
    for (int k = 0; k < parts; k++) {
        ByteSink chunk = {0};
        part[k].fields(&(Fields){.to = &chunk, .version = version}, &frame);
        chunks_put(&file, part[k].name, &chunk);
        if (octets) octets[k] = chunk.count;
        sink_free(&chunk);
    }
    chunks_end(&file);
    return file;
}

static Status parsed(SavedFrame *out, uint32_t says, int version, Arena *arena)
{
    ByteSink     file = file_as(NULL, says, version);
    const Status status = saved_frame_parse(out, file.bytes, file.count, "a test's", arena);
    sink_free(&file);
    return status;
}

/* What etc/FRAME_FILE.md says a version lacks takes no octets in it, and is read as it was before: nothing, no step of
 * sampling, straight lines of sight, the time of plants or none. A u32, or a bool, has 4 octets, a float 4, a double 8,
 * a list 4 and its records.
 */
static void older_versions_are_read(void **state)
{
    enum { places = 4 + 2 * 16, blow = 9 * 4 + 2 * 8, patches = 12 + 4 + 2 * 4, roles = 21 * 4 };
    static const int less[chunks_version][changed_parts] = {/* than now, from version 1 */
                                                            {24, places + 8, blow, patches - roles},
                                                            {24, places + 8, blow, patches - roles},
                                                            {24, places + 8, blow, 0},
                                                            {24, places + 8, 0, 0},
                                                            {20, places + 8, 0, 0},
                                                            {20, 8, 0, 0},
                                                            {16, 8, 0, 0},
                                                            {16, 0, 0, 0},
                                                            {8, 0, 0, 0},
                                                            {0, 0, 0, 0}};
    Arena           *arena = arena_create();
    size_t           now[parts], octets[parts];
    ByteSink         file = file_as(now, chunks_version, chunks_version);
    (void)state;
    sink_free(&file);
    for (int version = 1; version <= chunks_version; version++) {
        SavedFrame got;
        arena_reset(arena);
        file = file_as(octets, (uint32_t)version, version), sink_free(&file);
        for (int k = 0; k < parts; k++)
            assert_int_equal((int)now[k] - (int)octets[k], k < changed_parts ? less[version - 1][k] : 0);
        assert_int_equal(parsed(&got, (uint32_t)version, version, arena), STATUS_OK);
        const SnapshotEntity *e = &got.snapshot.entity[0];
        const GroundStand    *stand = &got.snapshot.marks.stand[0];
        CHECK(got.snapshot.count == 1 && got.snapshot.marks.stands == 1 && got.woods.most_trees == 70);
        CHECK(!got.built);
        CHECK(version >= 9 ? got.ground_km2 == 1.5 : isnan(got.ground_km2));
        CHECK(got.woods.far_half_m == (version >= 8 ? 20000 : 0));
        CHECK(got.request.refraction == (version >= 7));
        CHECK(got.woods.place_count == (version >= 6 ? 2 : 0));
        CHECK(got.request.sampling == (version >= 5 ? SAMPLING_QUARTER : SAMPLING_ALL));
        CHECK(stand->blow.excess_k == (version >= 4 ? 100 : 0) && stand->blow.to_s == (version >= 4 ? 60 : 0));
        CHECK(e->patches == (version >= 3 ? 2 : 0) && e->first_patch == (version >= 3 ? 0 : -1));
        CHECK(e->dt_k == (version >= 3 ? 4 : 0) && got.snapshot.patch_count == (version >= 3 ? 2 : 0));
    }
    arena_destroy(arena);
}

/* A version that is none, or later, and content of another version than the file says. */
static void other_versions_are_refused(void **state)
{
    Arena     *arena = arena_create();
    SavedFrame got;
    (void)state;
    assert_int_equal(parsed(&got, 0, chunks_version, arena), STATUS_UNSUPPORTED);
    assert_int_equal(parsed(&got, chunks_version + 1, chunks_version, arena), STATUS_UNSUPPORTED);
    assert_int_equal(parsed(&got, UINT32_MAX, chunks_version, arena), STATUS_UNSUPPORTED);
    for (int version = 3; version <= chunks_version; version++) {
        assert_int_equal(parsed(&got, (uint32_t)version, version - 1, arena), STATUS_BAD_VALUE);
        assert_int_equal(parsed(&got, (uint32_t)version - 1, version, arena), STATUS_BAD_VALUE);
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read), cmocka_unit_test(what_is_out_of_range_is_named),
        cmocka_unit_test(a_count_is_no_more_than_the_octets_hold), cmocka_unit_test(older_versions_are_read),
        cmocka_unit_test(other_versions_are_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
