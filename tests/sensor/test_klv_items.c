/* Every item of a packet against the tables of ST 0601.19 and ST 0903.6, kept here: its tag, how many octets it has,
 * which integer stands for its value, and when it is absent. */
#include "tests/sensor/klv_lab.h"

/* ---- ST 0601 ------------------------------------------------------------------------------------- */

/* The maps of ST 0601: low .. high onto all values of an unsigned integer; -high .. high onto those of a signed one but
 * the lowest. */
typedef enum ItemForm { NUMBER, UNSIGNED, SIGNED, TEXT } ItemForm;

typedef struct Item {
    unsigned    tag;
    ItemForm    form;
    size_t      octets; /* 0: of the text */
    double      low, high, value;
    const char *text;
} Item;

static void check_item(const Item *want, Value got)
{
    if (!got.at) fail_msg("tag %u is absent", want->tag);
    if (want->form == TEXT) {
        if (!is_text(got, want->text)) fail_msg("tag %u is not `%s`", want->tag, want->text);
        return;
    }
    if (got.count != want->octets) fail_msg("tag %u has %zu octets, not %zu", want->tag, got.count, want->octets);
    const double steps =
        want->form == UNSIGNED ? ldexp(1, 8 * (int)want->octets) - 1 : ldexp(1, 8 * (int)want->octets - 1) - 1;
    const double whole = want->form == NUMBER     ? want->value
                         : want->form == UNSIGNED ? (want->value - want->low) / (want->high - want->low) * steps
                                                  : want->value / want->high * steps;
    if (number(got, want->form == SIGNED) != floor(whole + 0.5))
        fail_msg("tag %u is %.0f, want %.3f", want->tag, number(got, want->form == SIGNED), whole);
}

/* The packet: key, length, these items and no other, the checksum as the last. */
static void check_packet(const Item *item, int items)
{
    static const uint8_t key[16] = {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01,
                                    0x0E, 0x01, 0x03, 0x01, 0x01, 0x00, 0x00, 0x00};
    assert_memory_equal(lab.octets, key, sizeof key);
    size_t at = 17, length = lab.octets[16];
    if (length & 0x80) {
        int more = (int)(length & 0x7F);
        for (length = 0; more > 0; more--) length = length << 8 | lab.octets[at++];
    }
    assert_int_equal(at + length, lab.used);
    for (int k = 0; k <= items; k++) {
        const unsigned tag = lab.octets[at], count = lab.octets[at + 1];
        CHECK(count < 128 && at + 2 + count <= lab.used);
        assert_int_equal(tag, k < items ? item[k].tag : 1);
        if (k < items) check_item(&item[k], (Value){lab.octets + at + 2, count});
        else CHECK(count == 2 && at + 4 == lab.used);
        at += 2 + count;
    }
    uint16_t sum = 0; /* ST 0601: of 16-bit words, up to the length of the checksum itself */
    for (size_t i = 0; i < lab.used - 2; i++) sum = (uint16_t)(sum + (i % 2 ? lab.octets[i] : lab.octets[i] << 8));
    CHECK(sum == lab.octets[lab.used - 2] * 256 + lab.octets[lab.used - 1]);
}

/* A regional grid whose height is 10 m + 1 m a degree of latitude + 2 m a degree of longitude, which a cubic between
 * posts follows. */
enum { posts = 25 };
static float        grid[(posts + 4) * (posts + 4)];
static const Geoid *sloping_geoid(void)
{
    static Geoid geoid = {
        .rows = posts, .columns = posts, .south_deg = 36, .west_deg = -24, .step_lat_deg = 1, .step_lon_deg = 1};
    for (int j = 0; j < posts + 4; j++)
        for (int i = 0; i < posts + 4; i++) grid[j * (posts + 4) + i] = (float)(10 + (36 + j - 2) + 2 * (-24 + i - 2));
    geoid.n_m = grid;
    return &geoid;
}

static void every_item_is_as_the_standard_has_it(void **state)
{
    (void)state;
    static const double corner_deg[4][2] = {{48.5, -11.75}, {-48.125, 11.625}, {47.5, 120.25}, {-12.5, -170.5}};
    const KlvSource     source = {.band = BAND_MWIR, .geoid = sloping_geoid()};
    scene(&somewhere, (double[3]){350.5, 4, -12}, (double[3]){-30, -10.5, -3});
    lab.footprint[FOOTPRINT_CENTRE] = (GroundPoint){true, 48.2 * rad_per_deg, -11.4 * rad_per_deg, 415, 12345.6};
    for (int k = 0; k < 4; k++)
        lab.footprint[FOOTPRINT_UPPER_LEFT + k] =
            (GroundPoint){true, corner_deg[k][0] * rad_per_deg, corner_deg[k][1] * rad_per_deg, 400, 13000};
    const double vfov_deg = 2 * atan(0.75 * tan(3 * rad_per_deg)) / rad_per_deg; /* 480 rows of 640 square columns */
    const Item   item[] = {
          {2, NUMBER, 8, 0, 0, 1750000000250000, NULL},
          {3, TEXT, 0, 0, 0, 0, "Exercise"},
          {5, UNSIGNED, 2, 0, 360, 350.5, NULL},
          {6, SIGNED, 2, 0, 20, 4, NULL},
          {7, SIGNED, 2, 0, 50, -12, NULL},
          {10, TEXT, 0, 0, 0, 0, "platform"},
          {11, TEXT, 0, 0, 0, 0, "IR MWIR"},
          {12, TEXT, 0, 0, 0, 0, "Geodetic WGS84"},
          {13, SIGNED, 4, 0, 90, 48.25, NULL},
          {14, SIGNED, 4, 0, 180, -11.5, NULL},
          {15, UNSIGNED, 2, -900, 19000, 2345 - (10 + 48.25 - 23), NULL}, /* above mean sea level */
          {16, UNSIGNED, 2, 0, 180, 6, NULL},
          {17, UNSIGNED, 2, 0, 180, vfov_deg, NULL},
          {18, UNSIGNED, 4, 0, 360, 330, NULL},
          {19, SIGNED, 4, 0, 180, -10.5, NULL},
          {20, UNSIGNED, 4, 0, 360, 357, NULL},
          {21, UNSIGNED, 4, 0, 5e6, 12345.6, NULL},
          {22, UNSIGNED, 2, 0, 1e4, 2 * 12345.6 * tan(3 * rad_per_deg), NULL},
          {23, SIGNED, 4, 0, 90, 48.2, NULL},
          {24, SIGNED, 4, 0, 180, -11.4, NULL},
          {25, UNSIGNED, 2, -900, 19000, 415 - (10 + 48.2 - 22.8), NULL},
          {56, UNSIGNED, 1, 0, 255, sqrt(200 * 200 + 30 * 30), NULL}, /* level, not the 5 m/s up */
          {59, TEXT, 0, 0, 0, 0, "MSL 1"},
          {65, NUMBER, 1, 0, 0, 19, NULL},
          {75, UNSIGNED, 2, -900, 19000, 2345, NULL},
          {77, NUMBER, 1, 0, 0, 3, NULL}, /* exercise */
          {78, UNSIGNED, 2, -900, 19000, 415, NULL},
          {79, SIGNED, 2, 0, 327, -30, NULL},
          {80, SIGNED, 2, 0, 327, 200, NULL},
          {82, SIGNED, 4, 0, 90, corner_deg[0][0], NULL},
          {83, SIGNED, 4, 0, 180, corner_deg[0][1], NULL},
          {84, SIGNED, 4, 0, 90, corner_deg[1][0], NULL},
          {85, SIGNED, 4, 0, 180, corner_deg[1][1], NULL},
          {86, SIGNED, 4, 0, 90, corner_deg[2][0], NULL},
          {87, SIGNED, 4, 0, 180, corner_deg[2][1], NULL},
          {88, SIGNED, 4, 0, 90, corner_deg[3][0], NULL},
          {89, SIGNED, 4, 0, 180, corner_deg[3][1], NULL},
          {90, SIGNED, 4, 0, 90, 4, NULL},
          {91, SIGNED, 4, 0, 90, -12, NULL},
    };
    lab.used = klv_frame(lab.octets, &lab.record, 1750000000.25, &source, NULL);
    check_packet(item, sizeof item / sizeof *item);
}

/* An observer above one corner of the Earth's axes, whose matrices are of 0 and 1: angles that are exactly 0 are 0, not
 * a whole turn. Without a footprint, without a place. */
static void what_is_not_known_is_absent(void **state)
{
    (void)state;
    const KlvSource source = {.band = BAND_OPTICAL, .mission = "M", .sensor = "S"};
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    /* down is -x, north z, east y: looking north, right east */
    static const double r_ecef_from_cam[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1}, still[3] = {0},
                        far_x[3] = {6378137 + 20000.503, 0, 0};
    memcpy(lab.record.r_ecef_from_cam, r_ecef_from_cam, sizeof r_ecef_from_cam);
    memcpy(lab.record.p_eye_ecef, far_x, sizeof far_x);
    memcpy(lab.record.v_eye_mps, still, sizeof still);
    lab.record.host = NULL, lab.record.footprint = NULL;
    const Item level[] = {
        {2, NUMBER, 8, 0, 0, 10000001, NULL}, /* rounded to the nearest us */
        {3, TEXT, 0, 0, 0, 0, "M"},
        {5, UNSIGNED, 2, 0, 360, 0, NULL},
        {6, SIGNED, 2, 0, 20, 0, NULL},
        {7, SIGNED, 2, 0, 50, 0, NULL},
        {10, TEXT, 0, 0, 0, 0, "observer"},
        {11, TEXT, 0, 0, 0, 0, "S"},
        {12, TEXT, 0, 0, 0, 0, "Geodetic WGS84"},
        {13, SIGNED, 4, 0, 90, 0, NULL},
        {14, SIGNED, 4, 0, 180, 0, NULL},
        {16, UNSIGNED, 2, 0, 180, 6, NULL},
        {17, UNSIGNED, 2, 0, 180, 2 * atan(0.75 * tan(3 * rad_per_deg)) / rad_per_deg, NULL},
        {18, UNSIGNED, 4, 0, 360, 0, NULL},
        {19, SIGNED, 4, 0, 180, 0, NULL},
        {20, UNSIGNED, 4, 0, 360, 0, NULL},
        {56, UNSIGNED, 1, 0, 255, 0, NULL},
        {65, NUMBER, 1, 0, 0, 19, NULL},
        {77, NUMBER, 1, 0, 0, 3, NULL},
        {79, SIGNED, 2, 0, 327, 0, NULL},
        {80, SIGNED, 2, 0, 327, 0, NULL},
        {90, SIGNED, 4, 0, 90, 0, NULL},
        {91, SIGNED, 4, 0, 90, 0, NULL},
        {104, NUMBER, 3, 0, 0, 128 * 20900.503 - 0.384, NULL}, /* IMAPB(-900, 40000, 3): 2^(23 - 16) a metre, down */
    };
    lab.used = klv_frame(lab.octets, &lab.record, 10.00000053, &source, NULL);
    check_packet(level, sizeof level / sizeof *level);
    lab.used = klv_frame(lab.octets, &lab.record, 10.00000047, &source, NULL);
    CHECK(number(tag_of(2), false) == 10000000);

    /* in neither range above 40 km; below 19 km in the coarser item */
    lab.record.p_eye_ecef[0] = 6378137 + 40000.5;
    lab.used = klv_frame(lab.octets, &lab.record, 10, &source, NULL);
    CHECK(!has(104) && !has(75));
    lab.record.p_eye_ecef[0] = 6378137 + 18999.9;
    lab.used = klv_frame(lab.octets, &lab.record, 10, &source, NULL);
    CHECK(!has(104) && number(tag_of(75), false) == 65535);
    lab.record.p_eye_ecef[0] = 6378137 + 19000.1;
    lab.used = klv_frame(lab.octets, &lab.record, 10, &source, NULL);
    CHECK(has(104) && !has(75));

    /* without a place the sensor still has its angles on the platform */
    lab.record.p_eye_ecef[0] = NAN;
    const Item nowhere[] = {
        level[0],  level[1],  level[5],  level[6],  level[7],  level[10],
        level[11], level[12], level[13], level[14], level[16], level[17],
    };
    lab.used = klv_frame(lab.octets, &lab.record, 10.00000053, &source, NULL);
    check_packet(nowhere, sizeof nowhere / sizeof *nowhere);

    /* times from 1970 to 2200 */
    CHECK(klv_frame(lab.octets, &lab.record, 0, &source, NULL) > 0);
    CHECK(klv_frame(lab.octets, &lab.record, -1e-6, &source, NULL) == 0);
    CHECK(klv_frame(lab.octets, &lab.record, 7258118399.5, &source, NULL) > 0);
    CHECK(klv_frame(lab.octets, &lab.record, 7258118400, &source, NULL) == 0);
}

static void places_are_on_the_earth(void **state)
{
    (void)state;
    static const struct {
        double lat_deg, lon_deg;
        bool   known;
    } at[] = {{90, 180, true},   {-90, -180, true},  {90.5, 0, false}, {-90.5, 0, false},
              {0, 180.5, false}, {0, -180.5, false}, {NAN, 0, false},  {0, NAN, false}};
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        lab.footprint[FOOTPRINT_CENTRE] =
            (GroundPoint){true, at[k].lat_deg * rad_per_deg, at[k].lon_deg * rad_per_deg, -899.9, 5e6};
        encode(NULL);
        CHECK(has(23) == at[k].known && has(24) == at[k].known);
        CHECK(!at[k].known ||
              (fabs(number(tag_of(23), true)) == 0x7FFFFFFF && fabs(number(tag_of(24), true)) == 0x7FFFFFFF));
        CHECK(number(tag_of(21), false) == 4294967295.0 && number(tag_of(78), false) == 0);
    }
    lab.footprint[FOOTPRINT_CENTRE] = (GroundPoint){true, 0, 0, -900.5, 5.2e6};
    encode(NULL);
    CHECK(!has(78) && !has(21));
    lab.footprint[FOOTPRINT_CENTRE] = (GroundPoint){true, 0, 0, 19000.4, 1e5};
    encode(NULL);
    CHECK(!has(78) && has(21) && !has(22)); /* 10481 m wide */
    lab.footprint[FOOTPRINT_CENTRE].range_m = 0.5e4 / tan(3 * rad_per_deg) * (1 - 1e-9);
    encode(NULL);
    CHECK(number(tag_of(22), false) == 65535);
    lab.footprint[FOOTPRINT_CENTRE].known = false;
    encode(NULL);
    CHECK(!has(21) && !has(22) && !has(23) && !has(78));
    /* a view of 180.5 degrees, and a platform that is too fast for 56: 255.5 m/s */
    lab.record.hfov_rad = 180.5 * rad_per_deg;
    for (int k = 0; k < 3; k++) lab.record.v_eye_mps[k] *= 255.5 / sqrt(200 * 200 + 30 * 30);
    encode(NULL);
    CHECK(!has(16) && !has(56) && has(80));
}

static void names_are_as_long_as_the_standard_allows(void **state)
{
    (void)state;
    char      name[80];
    KlvSource source = {.band = BAND_RADAR, .mission = name, .sensor = name};
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = 0;
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    memcpy(lab.host.marking, "ABCDEFGHIJKL", sizeof lab.host.marking); /* not even terminated */
    lab.used = klv_frame(lab.octets, &lab.record, 10, &source, NULL);
    CHECK(tag_of(3).count == 63 && tag_of(11).count == 63 && is_text(tag_of(59), "ABCDEFGHIJK"));
    static const char *const sensor[BAND_COUNT] = {"EO", "IR MWIR", "IR LWIR", "RADAR"};
    for (int b = 0; b < BAND_COUNT; b++) {
        source = (KlvSource){.band = (Band)b};
        strcpy(lab.host.marking, b ? "\t \x7F" : "~"); /* nothing to print in the others */
        lab.used = klv_frame(lab.octets, &lab.record, 10, &source, NULL);
        CHECK(is_text(tag_of(11), sensor[b]) && has(59) == (b == 0));
    }
}

/* ---- ST 0903 ------------------------------------------------------------------------------------- */

/* The target's own set within the first pack of the series: after the length of the pack and its id, below 128. */
static Value pack_of(Value series)
{
    if (!series.at) fail_msg("no series of targets");
    CHECK(series.at[0] < 128 && series.at[1] < 128);
    return (Value){series.at + 2, series.at[0] - 1u};
}

static KlvTarget plain_target(uint64_t id)
{
    return (KlvTarget){.id = id, .box = {10, 20, 30, 24}, .confidence = NAN, .pixels = NAN};
}

static Value encode_target(const KlvTarget *target)
{
    encode(&(KlvTargets){.count = 1, .total = 1, .target = target});
    return find(tag_of(74), 101);
}

static void items_of_a_target(void **state)
{
    (void)state;
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    static const struct {
        int  box[4];
        bool inside;
    } of[] = {{{0, 0, 640, 480}, true},   {{10, 20, 30, 24}, true},  {{-1, 0, 640, 480}, false},
              {{0, -1, 640, 480}, false}, {{0, 0, 641, 480}, false}, {{0, 0, 640, 481}, false},
              {{10, 20, 10, 24}, false},  {{10, 20, 30, 20}, false}, {{30, 20, 10, 24}, false},
              {{10, 24, 30, 20}, false}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        KlvTarget t = plain_target(5);
        t.confidence = 1; /* so that it is in the packet at all */
        t.pixels = 1;
        memcpy(t.box, of[k].box, sizeof t.box);
        const Value pack = pack_of(encode_target(&t));
        for (unsigned tag = 1; tag <= 3; tag++) CHECK(!!find(pack, tag).at == of[k].inside);
        CHECK(!!find(pack, 7).at == of[k].inside); /* its share of the box */
        CHECK(find(pack, 5).count == 1 && number(find(pack, 5), false) == 100);
        for (unsigned tag = 17; tag < 108; tag++) CHECK(!find(pack, tag).at);
    }
    /* percent of the box of 80 px, to the nearest, 1 at least and 100 at most */
    static const double pixels[][2] = {{0.8 * 47.47, 47}, {0.8 * 47.53, 48}, {0.001, 1}, {80, 100},
                                       {80.9, 100},       {0, -1},           {NAN, -1}};
    for (size_t k = 0; k < sizeof pixels / sizeof *pixels; k++) {
        KlvTarget t = plain_target(5);
        t.pixels = pixels[k][0];
        const Value pack = pack_of(encode_target(&t)), got = find(pack, 7);
        CHECK(got.at ? got.count == 1 && number(got, false) == pixels[k][1] : pixels[k][1] < 0);
        CHECK(!find(pack, 5).at);
    }
    /* confidence in percent, 0 .. 1 only */
    static const double confidence[][2] = {{0, 0}, {1, 100}, {0.8747, 87}, {0.8753, 88}, {-0.01, -1}, {1.01, -1}};
    for (size_t k = 0; k < sizeof confidence / sizeof *confidence; k++) {
        KlvTarget t = plain_target(5);
        t.confidence = confidence[k][0];
        const Value got = find(pack_of(encode_target(&t)), 5);
        CHECK(got.at ? got.count == 1 && number(got, false) == confidence[k][1] : confidence[k][1] < 0);
    }
    /* a place: IMAPB of (-90, 90, 4), (-180, 180, 4), (-900, 19000, 2), of 2^23, 2^22 and 1 a unit; whole or absent */
    static const struct {
        double lat_deg, lon_deg, h_m;
        bool   known;
    } at[] = {{90, 180, 19000, true}, {-90, -180, -900, true}, {90.5, 0, 0, false},
              {-90.5, 0, 0, false},   {0, 180.5, 0, false},    {0, -180.5, 0, false},
              {0, 0, 19000.5, false}, {0, 0, -900.5, false},   {45.5, -100.25, 77, true}};
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        KlvTarget t = plain_target(5);
        t.located = true, t.place = (Geodetic){at[k].lat_deg * rad_per_deg, at[k].lon_deg * rad_per_deg, at[k].h_m};
        const Value got = find(pack_of(encode_target(&t)), 17);
        CHECK(!!got.at == at[k].known);
        if (!got.at) continue;
        assert_int_equal(got.count, 10);
        CHECK_NEAR(number((Value){got.at, 4}, false), (at[k].lat_deg + 90) * 8388608, 1);
        CHECK_NEAR(number((Value){got.at + 4, 4}, false), (at[k].lon_deg + 180) * 4194304, 1);
        CHECK(number((Value){got.at + 8, 2}, false) == at[k].h_m + 900);
        t.located = false;
        CHECK(!find(pack_of(encode_target(&t)), 17).at);
    }
}

/* Elements of a series, each behind its length, which is below 128. */
static int elements(Value series)
{
    int count = 0;
    for (size_t at = 0; series.at && at < series.count; at += 1u + series.at[at]) {
        CHECK(series.at[at] < 128);
        count++;
    }
    return count;
}

/* Twenty targets of twenty classes by six algorithms: as many as a packet names, the others without. */
static void names_of_classes_and_algorithms(void **state)
{
    (void)state;
    static KlvTarget target[20];
    static char      name[20][40];
    for (int k = 0; k < 20; k++) {
        target[k] = plain_target(1 + (uint64_t)k);
        snprintf(name[k], sizeof name[k], "class-%c-0123456789-abcdefghijklmnopq", 'A' + k);
        target[k].class_name = name[k];
        target[k].algorithm = "net"; /* the same, in versions of two octets */
        target[k].algorithm_version = k < 12 ? (char *)"v1\0v2\0v3" + 3 * (k / 4) : name[k / 4];
    }
    target[19].algorithm = NULL, target[19].class_name = "";
    target[1].algorithm_version = target[0].algorithm_version = NULL; /* not said: unknown */
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    encode(&(KlvTargets){.truth = true, .count = 20, .target = target});
    const Value set = tag_of(74), series = find(set, 101);
    assert_int_equal(elements(series), 20);
    assert_int_equal(elements(find(set, 102)), 4);
    assert_int_equal(elements(find(set, 103)), 16);
    CHECK(number(find(set, 5), false) == 20 && number(find(set, 6), false) == 20);
    /* of unknown version, v1 (the third and fourth), v2, v3; then there is no room */
    size_t at = 0;
    for (int k = 0; k < 20; k++, at += 1u + series.at[at]) {
        const Value pack = {series.at + at + 2, series.at[at] - 1u}, object = find(pack, 107),
                    algorithm = find(pack, 22);
        CHECK(series.at[at + 1] == k + 1);
        const int want = k < 2 ? 1 : k < 4 ? 2 : k < 8 ? 3 : k < 12 ? 4 : 0;
        CHECK(want ? algorithm.at && number(algorithm, false) == want : !algorithm.at);
        CHECK(k < 16 ? object.at && object.count == 4 && object.at[3] == k + 1 : !object.at);
    }
    /* an element of each: id, name, version, that it is truth; id, family, class, label, cut at 31 */
    static const char algorithm[] = "\x18"
                                    "\x01\x01\x01"
                                    "\x02\x03net"
                                    "\x03\x07unknown"
                                    "\x04\x05truth";
    static const char ontology[] = "\x6C"
                                   "\x01\x01\x01"
                                   "\x03\x12urn:pitviper:truth"
                                   "\x04\x32urn:pitviper:truth:class-A-0123456789-abcdefghijkl"
                                   "\x06\x1F"
                                   "class-A-0123456789-abcdefghijkl";
    assert_memory_equal(find(set, 102).at, algorithm, sizeof algorithm - 1);
    assert_memory_equal(find(set, 103).at, ontology, sizeof ontology - 1);
}

/* Counts and sizes have three octets at most; what is not known of the frame is absent. */
static void the_set_says_which_frame_it_is_of(void **state)
{
    (void)state;
    const KlvTarget target = plain_target(5);
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    lab.record.frame = 0x1000005;
    encode(&(KlvTargets){.count = 1, .total = 0x1000000, .target = &target});
    Value set = tag_of(74);
    CHECK(number(find(set, 5), false) == 0xFFFFFF && number(find(set, 7), false) == 5);
    CHECK(number(find(set, 8), false) == 640 && number(find(set, 9), false) == 480);
    CHECK(find(set, 2).count == 8 && find(set, 11).count == 2 && find(set, 12).count == 2);
    CHECK(!find(set, 102).at && !find(set, 103).at); /* no algorithm, no class */
    lab.record.frame = 0;
    lab.request.view.width = 0x1000004, lab.request.view.height = 0x1000002;
    encode(&(KlvTargets){.count = 1, .total = 3, .target = &target});
    set = tag_of(74);
    CHECK(number(find(set, 7), false) == 0 && number(find(set, 8), false) == 4 && number(find(set, 9), false) == 2);
    CHECK(number(find(set, 5), false) == 3 && number(find(set, 6), false) == 1);
    encode(&(KlvTargets){.count = 1, .target = &target, .elsewhen = true, .frame = -1, .unix_s = 5});
    set = tag_of(74);
    CHECK(!find(set, 7).at && number(find(set, 2), false) == 5000000);
    lab.record.hfov_rad = 180.5 * rad_per_deg;
    encode(&(KlvTargets){.count = 1, .target = &target});
    CHECK(!find(tag_of(74), 11).at && find(tag_of(74), 12).at);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_item_is_as_the_standard_has_it),
        cmocka_unit_test(what_is_not_known_is_absent),
        cmocka_unit_test(places_are_on_the_earth),
        cmocka_unit_test(names_are_as_long_as_the_standard_allows),
        cmocka_unit_test(items_of_a_target),
        cmocka_unit_test(names_of_classes_and_algorithms),
        cmocka_unit_test(the_set_says_which_frame_it_is_of),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
