/* Metadata packets octet by octet, against hand values and the worked example of ST 0601.
 * tests/system/test_klv.sh has readers that are not ours decode them. */
#include "tests/sensor/klv_lab.h"

static KlvWriter writer_on(uint8_t *octets, size_t room)
{
    memset(octets, 0xEE, room);
    return (KlvWriter){.octet = octets, .room = room};
}

#define CHECK_OCTETS(w, ...)                                                                                           \
    do {                                                                                                               \
        const uint8_t want_[] = {__VA_ARGS__};                                                                         \
        CHECK(!(w).full);                                                                                              \
        assert_int_equal((w).used, sizeof want_);                                                                      \
        assert_memory_equal((w).octet, want_, sizeof want_);                                                           \
        (w).used = 0;                                                                                                  \
    } while (0)

static void lengths_and_tags(void **state)
{
    (void)state;
    uint8_t   octets[64];
    KlvWriter w = writer_on(octets, sizeof octets);
    klv_put_length(&w, 0);
    CHECK_OCTETS(w, 0);
    klv_put_length(&w, 127);
    CHECK_OCTETS(w, 0x7F);
    klv_put_length(&w, 128);
    CHECK_OCTETS(w, 0x81, 0x80);
    klv_put_length(&w, 256);
    CHECK_OCTETS(w, 0x82, 0x01, 0x00);
    klv_put_length(&w, 65536);
    CHECK_OCTETS(w, 0x83, 0x01, 0x00, 0x00);
    klv_put_oid(&w, 0);
    CHECK_OCTETS(w, 0);
    klv_put_oid(&w, 127);
    CHECK_OCTETS(w, 0x7F);
    klv_put_oid(&w, 128);
    CHECK_OCTETS(w, 0x81, 0x00);
    klv_put_oid(&w, 16384);
    CHECK_OCTETS(w, 0x81, 0x80, 0x00);
    klv_put_oid(&w, UINT64_MAX);
    CHECK_OCTETS(w, 0x81, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F);
    klv_item_short(&w, 5, 0);
    CHECK_OCTETS(w, 5, 1, 0);
    klv_item_short(&w, 5, 0x10000);
    CHECK_OCTETS(w, 5, 3, 1, 0, 0);
    klv_item_text(&w, 3, "  a\nb \xC3\xA9 ", 63);
    CHECK_OCTETS(w, 3, 2, 'a', 'b');
    klv_item_text(&w, 3, "abcdef", 4);
    CHECK_OCTETS(w, 3, 4, 'a', 'b', 'c', 'd');
    klv_item_text(&w, 3, " \t", 4);
    klv_item_text(&w, 3, NULL, 4);
    assert_int_equal(w.used, 0);
    assert_int_equal(klv_checksum((const uint8_t[]){1, 2, 3}, 3), 0x0402);
}

/* The worked example of ST 0601: values and octets. */
static void maps(void **state)
{
    (void)state;
    uint8_t   octets[64];
    KlvWriter w = writer_on(octets, sizeof octets);
    klv_item_unsigned(&w, 5, 2, 0, 360, 159.974365);
    CHECK_OCTETS(w, 5, 2, 0x71, 0xC2);
    klv_item_signed(&w, 6, 2, 20, -0.431531724);
    CHECK_OCTETS(w, 6, 2, 0xFD, 0x3D);
    klv_item_signed(&w, 7, 2, 50, 3.40586566);
    CHECK_OCTETS(w, 7, 2, 0x08, 0xB8);
    klv_item_signed(&w, 13, 4, 90, 60.1768229669783);
    CHECK_OCTETS(w, 13, 4, 0x55, 0x95, 0xB6, 0x6D);
    klv_item_signed(&w, 14, 4, 180, 128.426759042045);
    CHECK_OCTETS(w, 14, 4, 0x5B, 0x53, 0x60, 0xC4);
    klv_item_unsigned(&w, 15, 2, -900, 19000, 14190.7195);
    CHECK_OCTETS(w, 15, 2, 0xC2, 0x21);
    klv_item_unsigned(&w, 18, 4, 0, 360, 160.719211474396);
    CHECK_OCTETS(w, 18, 4, 0x72, 0x4A, 0x0A, 0x20);
    klv_item_signed(&w, 19, 4, 180, -168.79232483394);
    CHECK_OCTETS(w, 19, 4, 0x87, 0xF8, 0x4B, 0x86);
    klv_item_unsigned(&w, 21, 4, 0, 5e6, 68590.98329874477);
    CHECK_OCTETS(w, 21, 4, 0x03, 0x83, 0x09, 0x26);
    /* the ends; the error indicator 0x8000 is never reached */
    klv_item_signed(&w, 79, 2, 327, -327);
    CHECK_OCTETS(w, 79, 2, 0x80, 0x01);
    klv_item_signed(&w, 79, 2, 327, 327);
    CHECK_OCTETS(w, 79, 2, 0x7F, 0xFF);
    klv_item_unsigned(&w, 18, 4, 0, 360, 360);
    CHECK_OCTETS(w, 18, 4, 0xFF, 0xFF, 0xFF, 0xFF);
    klv_put_imapb(&w, 2, -900, 19000, -900);
    klv_put_imapb(&w, 2, -900, 19000, 0);
    klv_put_imapb(&w, 2, -900, 19000, 10000);
    CHECK_OCTETS(w, 0, 0, 0x03, 0x84, 0x2A, 0x94);
    klv_put_imapb(&w, 2, 0, 180, 180);
    CHECK_OCTETS(w, 0x5A, 0x00);
    static const double unknown[] = {NAN, INFINITY, -INFINITY, 1e300, -180.0001};
    for (int k = 0; k < 5; k++) {
        klv_item_unsigned(&w, 5, 2, 0, 360, unknown[k]);
        klv_item_signed(&w, 19, 4, 180, unknown[k]);
        klv_item_imapb(&w, 11, 2, 0, 180, unknown[k]);
    }
    assert_int_equal(w.used, 0);
}

static void never_beyond_the_buffer(void **state)
{
    (void)state;
    uint8_t octets[16];
    for (size_t room = 0; room < 8; room++) {
        KlvWriter w = writer_on(octets, sizeof octets);
        w.room = room;
        klv_item_number(&w, 2, 0x0102030405060708, 8);
        klv_put_number(&w, 1, 1);
        CHECK(w.full && w.used <= room);
        for (size_t i = room; i < sizeof octets; i++) assert_int_equal(octets[i], 0xEE);
    }
}

static void the_writer_at_its_limits(void **state)
{
    (void)state;
    uint8_t   octets[200];
    KlvWriter w = {.octet = octets, .room = sizeof octets};
    /* to the nearest step */
    static const double unsigned_steps[][2] = {{0, 0}, {7.47, 7}, {7.53, 8}, {65535, 65535}};
    for (size_t k = 0; k < 4; k++) {
        w.used = 0;
        klv_item_unsigned(&w, 5, 2, 0, 65535, unsigned_steps[k][0]);
        CHECK(w.used == 4 && octets[2] * 256 + octets[3] == unsigned_steps[k][1]);
    }
    w.used = 0;
    klv_item_signed(&w, 5, 2, 32767, 9.47);
    CHECK(octets[3] == 9);
    w.used = 0;
    klv_item_signed(&w, 5, 2, 32767, 9.53);
    CHECK(octets[3] == 10);
    /* ST 1201: 0 stands on a step where the range has both signs, and only there. -77/256 .. 0.5 in one octet: 2^7 a
     * unit, 0 at 38.5, half a step higher */
    const double low = -77 / 256.0;
    w.used = 0;
    klv_put_imapb(&w, 1, low, 0.5, 0);
    klv_put_imapb(&w, 1, low, 0.5, 0.05);              /* 6.4 steps on */
    klv_put_imapb(&w, 1, -low, 1.1, 1);                /* 89.5 steps */
    klv_put_imapb(&w, 1, -77.5 / 512, 0, -50.8 / 512); /* 26.7 steps */
    CHECK(w.used == 4 && octets[0] == 39 && octets[1] == 45 && octets[2] == 89 && octets[3] == 26);
    /* the ends of the range are in it */
    w.used = 0;
    klv_item_imapb(&w, 11, 2, 0, 180, 0);
    klv_item_imapb(&w, 11, 2, 0, 180, 180);
    CHECK(w.used == 8 && octets[1] == 2 && octets[2] == 0 && octets[6] == 0x5A);
    klv_item_imapb(&w, 11, 2, 0, 180, 180.01);
    klv_item_imapb(&w, 11, 2, 0, 180, -0.01);
    CHECK(w.used == 8);
    /* eight octets, whichever */
    w.used = 0;
    klv_item_short(&w, 6, UINT64_MAX);
    CHECK(w.used == 10 && octets[1] == 8 && octets[2] == 0xFF && octets[9] == 0xFF);
    w.used = 0;
    klv_item_number(&w, 6, 0x0102030405060708, 8);
    for (int k = 0; k < 8; k++) CHECK(octets[2 + k] == k + 1);
    /* texts: the first and the last printable octet, and what is beside them */
    w.used = 0;
    klv_item_text(&w, 3, "\x1F\x20!\x20~\x7F\x20", 63);
    CHECK(w.used == 5 && memcmp(octets + 2, "! ~", 3) == 0);
    char text[200];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = 0;
    w.used = 0;
    klv_item_text(&w, 3, text, 199);
    CHECK(w.used == 2 + 1 + 128 && octets[1] == 0x81 && octets[2] == 128); /* the most that is kept of one */
    /* to the last octet, and nothing after what did not fit */
    w = (KlvWriter){.octet = octets, .room = 3};
    klv_put(&w, "abc", 3);
    CHECK(!w.full && w.used == 3);
    w.used = 1;
    klv_put(&w, "defg", 3);
    CHECK(w.full && w.used == 1);
    klv_put(&w, "h", 1);
    CHECK(w.used == 1);
}

/* ---- packets ------------------------------------------------------------------------------------ */

static void pose_of_platform_and_sensor(void **state)
{
    (void)state;
    scene(&somewhere, (double[3]){91.5, 4, -12}, (double[3]){-30, -10.5, 3});
    lab.footprint[FOOTPRINT_CENTRE] = (GroundPoint){true, 48.2 * rad_per_deg, -11.4 * rad_per_deg, 415, 12345.6};
    lab.footprint[FOOTPRINT_LOWER_RIGHT] = (GroundPoint){true, 48.1 * rad_per_deg, 179.9999 * rad_per_deg, 400, 13000};
    encode(NULL);
    const Value time = tag_of(2);
    CHECK(time.at == lab.octets + 21 - (lab.octets[16] == 0x81 ? 1 : 0) && time.count == 8);
    CHECK(number(time, false) == 1750000000250000);
    CHECK_NEAR(unsigned_of(5, 0, 360), 91.5, 0.0028);
    CHECK_NEAR(signed_of(6, 20), 4, 0.00031);
    CHECK_NEAR(signed_of(7, 50), -12, 0.00077);
    CHECK_NEAR(signed_of(90, 90), 4, 1e-7);
    CHECK_NEAR(signed_of(91, 90), -12, 1e-7);
    CHECK_NEAR(signed_of(13, 90), 48.25, 3e-8);
    CHECK_NEAR(signed_of(14, 180), -11.5, 5e-8);
    CHECK_NEAR(unsigned_of(75, -900, 19000), 2345, 0.16);
    CHECK_NEAR(unsigned_of(16, 0, 180), 6, 0.0014);
    CHECK_NEAR(unsigned_of(17, 0, 180), 2 * atan(0.75 * tan(3 * rad_per_deg)) / rad_per_deg, 0.0014);
    CHECK_NEAR(unsigned_of(18, 0, 360), 330, 1e-7);
    CHECK_NEAR(signed_of(19, 180), -10.5, 1e-7);
    CHECK_NEAR(unsigned_of(20, 0, 360), 3, 1e-7);
    CHECK_NEAR(unsigned_of(21, 0, 5e6), 12345.6, 0.0007);
    CHECK_NEAR(unsigned_of(22, 0, 1e4), 2 * 12345.6 * tan(3 * rad_per_deg), 0.08);
    CHECK_NEAR(signed_of(23, 90), 48.2, 3e-8);
    CHECK_NEAR(signed_of(24, 180), -11.4, 5e-8);
    CHECK_NEAR(unsigned_of(78, -900, 19000), 415, 0.16);
    CHECK_NEAR(unsigned_of(56, 0, 255), hypot(200, 30), 0.51);
    CHECK_NEAR(signed_of(79, 327), -30, 0.006);
    CHECK_NEAR(signed_of(80, 327), 200, 0.006);
    CHECK_NEAR(signed_of(86, 90), 48.1, 3e-8);
    CHECK_NEAR(signed_of(87, 180), 179.9999, 5e-8);
    CHECK(!has(82) && !has(83) && !has(84) && !has(88) && !has(89)); /* corners that are not on the ground */
    CHECK(!has(15) && !has(25) && !has(74) && !has(104));            /* no geoid, no targets, not that high */
    CHECK(is_text(tag_of(3), "Exercise 1") && is_text(tag_of(10), "platform") && is_text(tag_of(11), "IR LWIR"));
    CHECK(is_text(tag_of(12), "Geodetic WGS84") && is_text(tag_of(59), "MSL 1"));
    CHECK(number(tag_of(65), false) == 19 && number(tag_of(77), false) == 3);
    const Value sum = tag_of(1);
    CHECK(sum.at + 2 == lab.octets + lab.used && number(sum, false) == klv_checksum(lab.octets, lab.used - 2));
    CHECK(lab.used < 600);
}

/* Every place of the footprint in its own tags: four corners clockwise from the upper left (ST 0601, 82 .. 89), each
 * with a latitude and a longitude that no other has. */
static void each_corner_has_its_own_tags(void **state)
{
    (void)state;
    static const double at_deg[FOOTPRINT_COUNT][2] = {
        {10.5, 20.5}, {-11.25, 121.25}, {12.75, -122.75}, {-33.5, -43.5}, {54.125, 164.125}};
    static const int corner[4] = {FOOTPRINT_UPPER_LEFT, FOOTPRINT_UPPER_RIGHT, FOOTPRINT_LOWER_RIGHT,
                                  FOOTPRINT_LOWER_LEFT};
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    for (int k = 0; k < FOOTPRINT_COUNT; k++)
        lab.footprint[k] =
            (GroundPoint){true, at_deg[k][0] * rad_per_deg, at_deg[k][1] * rad_per_deg, 100 + 10 * k, 1000 + 100 * k};
    encode(NULL);
    for (unsigned k = 0; k < 4; k++) {
        CHECK_NEAR(signed_of(82 + 2 * k, 90), at_deg[corner[k]][0], 3e-8);
        CHECK_NEAR(signed_of(83 + 2 * k, 180), at_deg[corner[k]][1], 5e-8);
    }
    CHECK_NEAR(signed_of(23, 90), at_deg[FOOTPRINT_CENTRE][0], 3e-8);
    CHECK_NEAR(signed_of(24, 180), at_deg[FOOTPRINT_CENTRE][1], 5e-8);
    CHECK_NEAR(unsigned_of(78, -900, 19000), 100 + 10 * FOOTPRINT_CENTRE, 0.16);
    CHECK_NEAR(unsigned_of(21, 0, 5e6), 1000 + 100 * FOOTPRINT_CENTRE, 0.0007);
    /* a sensor that looks the other way about: the place stays, the signs of its own place too */
    const Geodetic south = {-33.5 * rad_per_deg, 151.25 * rad_per_deg, 120};
    scene(&south, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    encode(NULL);
    CHECK_NEAR(signed_of(13, 90), -33.5, 3e-8);
    CHECK_NEAR(signed_of(14, 180), 151.25, 5e-8);
}

static void what_is_beyond_a_range_is_absent(void **state)
{
    (void)state;
    scene(&(Geodetic){0, 0, 25000}, (double[3]){0, 80, 100}, (double[3]){0, 0, 0});
    lab.footprint[FOOTPRINT_CENTRE] = (GroundPoint){true, NAN, 0, 0, INFINITY};
    for (int k = 0; k < 3; k++) lab.record.v_eye_mps[k] *= 4;
    encode(NULL);
    CHECK(!has(6) && !has(7) && !has(91) && !has(56) && !has(80) && !has(75) && !has(15)); /* 80 degrees, 800 m/s */
    CHECK_NEAR(signed_of(90, 90), 80, 1e-7);
    CHECK(has(79) && has(78) && !has(21) && !has(22) && !has(23) && !has(24));
    CHECK(tag_of(104).count == 3);
    CHECK_NEAR(number(tag_of(104), false) / 128 - 900, 25000, 0.008); /* IMAPB(-900, 40000, 3): 2^(23 - 16) a metre */

    /* an observer that is no entity is its own platform */
    scene(&somewhere, (double[3]){350, -20, 0}, (double[3]){0, 0, 0});
    lab.record.host = NULL;
    lab.record.footprint = NULL;
    memset(lab.record.r_ecef_from_body, 0, sizeof lab.record.r_ecef_from_body);
    encode(NULL);
    CHECK_NEAR(unsigned_of(5, 0, 360), 350, 0.0028);
    CHECK_NEAR(signed_of(90, 90), -20, 1e-7);
    CHECK_NEAR(signed_of(19, 180), 0, 1e-7);
    CHECK(!has(59) && !has(21) && is_text(tag_of(10), "observer"));

    static const double bad[] = {NAN, INFINITY, -1, 1e11};
    for (int k = 0; k < 4; k++) CHECK(klv_frame(lab.octets, &lab.record, bad[k], &lwir, NULL) == 0);
}

/* ---- targets -------------------------------------------------------------------------------------- */

static KlvTarget some_target(uint64_t id)
{
    return (KlvTarget){.id = id,
                       .box = {10, 20, 30, 24},
                       .confidence = 0.874,
                       .pixels = 40,
                       .located = true,
                       .place = {48 * rad_per_deg, 11 * rad_per_deg, 100},
                       .class_name = "tank",
                       .algorithm = "yolo",
                       .algorithm_version = "8"};
}

static void a_target(void **state)
{
    (void)state;
    const KlvTarget  target = some_target(200);
    const KlvTargets targets = {.count = 1, .total = 7, .target = &target};
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    encode(&targets);
    const Value set = tag_of(74), series = find(set, 101), algorithms = find(set, 102);
    CHECK(number(find(set, 2), false) == 1750000000250000);
    CHECK(is_text(find(set, 3), "Pitviper ATR"));
    CHECK(number(find(set, 4), false) == 6);
    CHECK(number(find(set, 5), false) == 7 && number(find(set, 6), false) == 1);
    CHECK(number(find(set, 7), false) == 300);
    CHECK(number(find(set, 8), false) == 640 && number(find(set, 9), false) == 480);
    CHECK(is_text(find(set, 10), "IR LWIR"));
    CHECK(number(find(set, 11), false) == 6 * 128); /* IMAPB(0, 180, 2): 2^(15 - 8) a degree */
    /* 480 of 640 square pixels: 2 atan(0.75 tan 3 deg) = 4.502312 degrees; x 128 = 576.3, of which IMAPB keeps the
     * whole */
    CHECK(number(find(set, 12), false) == 576 && find(set, 12).count == 2);
    static const uint8_t want[] = {
        0x81, 0x48,                                                  /* id 200 */
        1,    2,    0x37, 0x15,                                      /* column 20, row 22, from 0: 22 * 640 + 20 + 1 */
        2,    2,    0x32, 0x0B,                                      /* column 10, row 20 */
        3,    2,    0x39, 0x9E,                                      /* column 29, row 23: within the box */
        5,    1,    87,   7,    1, 50,                               /* confidence; 40 of 80 pixels */
        17,   10,   0x45, 0,    0, 0,  0x2F, 0xC0, 0, 0, 0x03, 0xE8, /* 138 * 2^23; 191 * 2^22; 1000 */
        22,   1,    1,    107,  4, 3,  3,    1,    1,
    };
    assert_int_equal(series.count, 1 + sizeof want);
    assert_int_equal(series.at[0], sizeof want);
    assert_memory_equal(series.at + 1, want, sizeof want);
    static const uint8_t algorithm[] = {12, 1, 1, 1, 2, 4, 'y', 'o', 'l', 'o', 3, 1, '8'};
    assert_int_equal(algorithms.count, sizeof algorithm);
    assert_memory_equal(algorithms.at, algorithm, sizeof algorithm);
    CHECK(memmem(set.at, set.count, "urn:pitviper:detected:tank", 26) && !memmem(set.at, set.count, "truth", 5));
    /* ST 0903 ontology set: id, its family, the class within it, the label; one element, after its length of 60 */
    static const char ontology[] = "\x3C"
                                   "\x01\x01\x01"
                                   "\x03\x15urn:pitviper:detected"
                                   "\x04\x1Aurn:pitviper:detected:tank"
                                   "\x06\x04tank";
    const Value       ontologies = find(set, 103);
    assert_int_equal(ontologies.count, sizeof ontology - 1);
    assert_memory_equal(ontologies.at, ontology, sizeof ontology - 1);
}

static void many_targets_and_truth(void **state)
{
    (void)state;
    static KlvTarget target[300];
    static char      name[18][60]; /* longer than any packet holds as a whole, and different at the start */
    for (int k = 0; k < 18; k++)
        snprintf(name[k], sizeof name[k], "%c and so on, with a long name beyond all limits", 'a' + k);
    for (int k = 0; k < 300; k++) {
        target[k] = some_target(UINT64_MAX - (unsigned)k / 2); /* each id twice */
        target[k].class_name = name[k % 18];
        target[k].algorithm = target[k].algorithm_version = name[k % 7];
    }
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    lab.request.view.width = lab.request.view.height = 4096;
    for (int k = 0; k < 300; k++) target[k].box[2] = target[k].box[3] = 4096;
    encode(&(KlvTargets){.truth = true, .count = 300, .total = 100000, .target = target});
    Value set = tag_of(74);
    CHECK(number(find(set, 5), false) == 100000 && number(find(set, 6), false) == klv_most_targets);
    CHECK(is_text(find(set, 3), "Pitviper truth"));
    CHECK(memmem(set.at, set.count, "urn:pitviper:truth:a-and-so-on--with-a-long-name-be", 50));
    CHECK(!memmem(set.at, set.count, "detected", 8));
    CHECK(lab.used > 4800 && lab.used < klv_most_octets); /* nearly the largest packet */
    encode(&(KlvTargets){.truth = true});
    set = tag_of(74);
    CHECK(number(find(set, 5), false) == 0 && number(find(set, 6), false) == 0 && !find(set, 101).at);

    /* an id once */
    const KlvTarget two[2] = {some_target(5), some_target(5)};
    encode(&(KlvTargets){.count = 2, .target = two});
    set = tag_of(74);
    CHECK(number(find(set, 5), false) == 2 && number(find(set, 6), false) == 1);

    /* no box outside of the image, no place outside of the range */
    KlvTarget odd = some_target(1);
    odd.box[0] = -1;
    odd.place.h_m = 20000;
    odd.confidence = NAN;
    odd.algorithm = odd.class_name = NULL;
    encode(&(KlvTargets){.count = 1, .target = &odd}); /* nothing is left of it */
    set = tag_of(74);
    CHECK(number(find(set, 5), false) == 1 && number(find(set, 6), false) == 0);
}

static void targets_of_truth(void **state)
{
    (void)state;
    static TargetRecord target[100];
    static KlvTarget    kept[klv_most_targets];
    KlvTargets          out;
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    for (int k = 0; k < 100; k++) {
        target[k] = (TargetRecord){.index = k,
                                   .id = {1, 3001, (uint16_t)k},
                                   .pixels = (k * 37) % 100,
                                   .box = {1, 2, 3 + k, 9},
                                   .class_number = 1};
        memcpy(target[k].p_ecef, lab.record.p_eye_ecef, sizeof target[k].p_ecef);
    }
    target[99].box[2] = 0; /* hidden */
    lab.record.target = target;
    lab.record.target_count = 100;
    klv_truth_targets(&out, kept, &lab.record);
    CHECK(out.truth && out.total == 98 && out.count == klv_most_targets && out.target == kept);
    for (int k = 1; k < out.count; k++) CHECK(kept[k - 1].pixels > kept[k].pixels);
    CHECK(kept[0].pixels == 99 && kept[0].id == ((uint64_t)1 << 32 | (uint64_t)3001 << 16 | 27));
    CHECK(kept[0].located && isnan(kept[0].confidence) && strcmp(kept[0].algorithm, "truth") == 0);
    CHECK_NEAR(kept[0].place.h_m, 2345, 1e-6);
    assert_string_equal(kept[0].class_name, "tank");
}

static void targets_of_a_recogniser(void **state)
{
    (void)state;
    static KlvTarget kept[klv_most_targets];
    static Answer    answer = {.frame = 250, .unix_s = 1749999999.5, .count = 4};
    KlvTargets       out;
    answer.detection[0] = (AnswerDetection){{10.2, 20, 29.5, 23.001}, .score = 0.25, .track = 7, .class_name = "tank"};
    answer.detection[1] = (AnswerDetection){{1, 2, 3, 4}, .score = 1};
    /* lines of sight alone: through the third pixel of the second row, and beside the image */
    answer.detection[2] = (AnswerDetection){{NAN, NAN, NAN, NAN}, .score = 0.5, .point_px = {2.99, 1.01}};
    answer.detection[3] = (AnswerDetection){{NAN, NAN, NAN, NAN}, .score = 0.5, .point_px = {-0.01, 1.01}};
    klv_of_answer(&out, kept, &answer);
    CHECK(!out.truth && out.count == 4 && out.target == kept && kept[0].id == 7 && kept[1].id == 0x100000001);
    assert_memory_equal(kept[0].box, ((const int[4]){10, 20, 30, 24}), sizeof kept[0].box);
    assert_memory_equal(kept[1].box, ((const int[4]){1, 2, 3, 4}), sizeof kept[1].box);
    CHECK_NEAR(kept[0].confidence, 0.25, 0);
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    encode(&out);
    const Value vmti = tag_of(74);
    CHECK(number(tag_of(2), false) == 1750000000250000 && number(find(vmti, 2), false) == 1749999999500000);
    CHECK(number(find(vmti, 7), false) == 250);
    CHECK(number(find(vmti, 5), false) == 4 && number(find(vmti, 6), false) == 4);
    Value series = find(vmti, 101);
    for (int k = 0; k < 4; k++) { /* after length and id, of one octet for the track and five for the others */
        const Value pack = {series.at + (k == 0 ? 2 : 6), series.at[0] - (k == 0 ? 1 : 5)};
        CHECK((find(pack, 1).at != NULL) == (k < 3) && (find(pack, 2).at != NULL) == (k < 2));
        if (k == 2) CHECK(number(find(pack, 1), false) == lab.request.view.width + 3);
        series.at += 1 + series.at[0];
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_and_tags),
        cmocka_unit_test(maps),
        cmocka_unit_test(never_beyond_the_buffer),
        cmocka_unit_test(the_writer_at_its_limits),
        cmocka_unit_test(pose_of_platform_and_sensor),
        cmocka_unit_test(each_corner_has_its_own_tags),
        cmocka_unit_test(what_is_beyond_a_range_is_absent),
        cmocka_unit_test(a_target),
        cmocka_unit_test(many_targets_and_truth),
        cmocka_unit_test(targets_of_truth),
        cmocka_unit_test(targets_of_a_recogniser),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
