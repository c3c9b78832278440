/* Answers as MISB ST 0903: a packet written by hand from the standard's tag tables, and accepted by stanag4609 and
 * tstrans; what is wrong with others, each item; packets of another program; and those that this one publishes, read
 * back. */
#include "tests/sensor/answer_lab.h"
#include "tests/sensor/klv_lab.h"

/* Tags 2 (1000.5 s), 3 to 6, 7 (frame 6), 8, 9 (64 x 48), 10 (IR LWIR), 11 to 13, 101: id 9 of box [3, 4, 20, 10], 75
 * %, with class 1 of the ontology series; id 2^32 + 1 of centroid 809, 50 %, with a VObject of its own; 103: class 1 is
 * a tank. */
static const char packet[] = "060E2B34020B01010E0103030600000081B7020800000000"
                             "3BA26B2003064D7920415452040106050102060102070106"
                             "0801400901300A074952204C5749520B0205000C0204000D"
                             "220170F592F02373364AF8AA9162C00F2EB2DA16B7434100"
                             "0841A0BE365B5AB96A3645653A1609010201CC0202010403"
                             "02025405014B6B0403030101229080808001010203290501"
                             "326614010575726E3A78020B75726E3A783A747275636B67"
                             "1C1B010101030575726E3A78040975726E3A783A6D627406"
                             "0474616E6B0102081F";

static size_t from_hex(uint8_t *out, const char *text)
{
    size_t count = 0;
    for (unsigned octet; sscanf(text + 2 * count, "%2x", &octet) == 1; count++) out[count] = (uint8_t)octet;
    return count;
}

static void a_packet_by_hand(void **state)
{
    (void)state;
    static Answer      a;
    uint8_t            octets[256], spoilt[256];
    const AnswerCamera camera = camera_north();
    const size_t       size = from_hex(octets, packet);
    CHECK(size == 201 && answer_read(&a, octets, size, &answer_scope) == ANSWER_GOOD);
    CHECK(a.form == ANSWER_KLV && a.band == BAND_LWIR && a.count == 2);
    CHECK(a.numbered && a.frame == 6 && a.number_bits == 0xFFFFFF && a.timed && a.time_us == 1000500000);
    const AnswerDetection *one = &a.detection[0], *two = &a.detection[1];
    const double           box[4] = {3, 4, 20, 10};
    assert_memory_equal(one->box_px, box, sizeof box);
    CHECK(one->score == 0.75 && one->track == 9 && strcmp(one->class_name, "tank") == 0);
    CHECK(isnan(two->box_px[0]) && two->score == 0.5 && two->track == 0 && strcmp(two->class_name, "truck") == 0);
    CHECK(two->point_px[0] == 40.5 && two->point_px[1] == 12.5);
    answer_complete(&a, &camera); /* the centroid as a line of sight: tangents 0.085 to the right, 0.115 up */
    CHECK_NEAR(two->los_rad[0], atan(0.085), 1e-9);
    CHECK_NEAR(two->los_rad[1], atan(0.115 / sqrt(1 + 0.085 * 0.085)), 1e-9);
    CHECK(isnan(one->los_rad[0]));

    for (size_t cut = 0; cut < size; cut++) CHECK(answer_read(&a, octets, cut, &answer_scope) != ANSWER_GOOD);
    memcpy(spoilt, octets, size);
    spoilt[size] = 0;
    CHECK(answer_read(&a, spoilt, size + 1, &answer_scope) == ANSWER_LOCAL_SET);
    for (size_t bit = 0; bit < 8 * size; bit++) { /* each bit is in the sum */
        spoilt[bit / 8] ^= (uint8_t)(1 << bit % 8);
        CHECK(answer_read(&a, spoilt, size, &answer_scope) != ANSWER_GOOD);
        spoilt[bit / 8] ^= (uint8_t)(1 << bit % 8);
    }
    const AnswerScope wider = {1 << BAND_LWIR, 65, 48}, other = {1 << BAND_MWIR, 64, 48};
    CHECK(answer_read(&a, octets, size, &wider) == ANSWER_IMAGE &&
          answer_read(&a, octets, size, &other) == ANSWER_BAND);
}

/* ---- each item --------------------------------------------------------------------------------------- */

/* A local set by hand: the items, then a right checksum. */
static size_t set_of(uint8_t *out, const char *items)
{
    static const char key[] = "060E2B34020B01010E01030306000000";
    const size_t      head = from_hex(out, key);
    const size_t      used = from_hex(out + head + 3, items);
    unsigned          sum = 0;
    size_t            at = head;
    out[at++] = 0x82, out[at++] = (uint8_t)((used + 4) >> 8), out[at++] = (uint8_t)(used + 4);
    at += used;
    out[at++] = 1, out[at++] = 2;
    for (size_t i = 0; i < at; i++) sum += i % 2 ? out[i] : (unsigned)out[i] << 8;
    out[at++] = (uint8_t)(sum >> 8), out[at++] = (uint8_t)sum;
    return at;
}

#define TIME "0208000000003BA26B20"

static void each_item_is_checked(void **state)
{
    (void)state;
    static const struct {
        const char  *items;
        AnswerReason reason;
    } of[] = {
        {TIME, ANSWER_GOOD},                /* nothing was found, in the only band */
        {TIME "0A046C776972", ANSWER_GOOD}, /* the name of the band */
        {TIME "0A024952", ANSWER_BAND},
        {"070106", ANSWER_GOOD}, /* by its number alone */
        {"", ANSWER_FRAME},
        {"0A046C776972", ANSWER_FRAME},
        {TIME TIME, ANSWER_LOCAL_SET}, /* an item twice */
        {"0200", ANSWER_LOCAL_SET},    /* numbers of no octets, of too many, beyond their range */
        {"0209000000000000000000", ANSWER_LOCAL_SET},
        {"0208FFFFFFFFFFFFFFFF", ANSWER_LOCAL_SET},
        {"070400000006", ANSWER_LOCAL_SET},
        {TIME "0800", ANSWER_LOCAL_SET},
        {TIME "080140", ANSWER_GOOD}, /* the width, the height */
        {TIME "080141", ANSWER_IMAGE},
        {TIME "090131", ANSWER_IMAGE},
        {TIME "060100", ANSWER_GOOD}, /* targets that are not there */
        {TIME "060101", ANSWER_COUNT},
        {TIME "7F00", ANSWER_GOOD}, /* tags of no meaning here */
        {TIME "FF7F0100", ANSWER_GOOD},
        {TIME "80010100", ANSWER_LOCAL_SET},               /* tag 1 in a long form: twice */
        {TIME "FFFFFFFFFFFFFFFFFF7F00", ANSWER_LOCAL_SET}, /* a tag beyond 2^63 */
        {TIME "0580", ANSWER_LOCAL_SET}, /* lengths: of no octets, of five, of 127, beyond the end, in a long form */
        {TIME "05850000000001", ANSWER_LOCAL_SET},
        {TIME "05FF", ANSWER_LOCAL_SET},
        {TIME "0584FFFFFFFF00", ANSWER_LOCAL_SET},
        {TIME "05840000000100", ANSWER_GOOD},
        {TIME "0A7F4C57", ANSWER_LOCAL_SET},
        {TIME "6500", ANSWER_GOOD}, /* targets: none, one of no octets, one of an id alone */
        {TIME "650100", ANSWER_LOCAL_SET},
        {TIME "65020107", ANSWER_BOX},
        {TIME "65050507010101", ANSWER_LOCAL_SET}, /* longer than the series */
        {TIME "65050407010201", ANSWER_LOCAL_SET}, /* an item longer than the target */
        {TIME "65050407010101", ANSWER_GOOD},      /* centroids: first, before it, last, behind it */
        {TIME "65050407010100", ANSWER_BOX},
        {TIME "6506050701020C00", ANSWER_GOOD},
        {TIME "6506050701020C01", ANSWER_BOX},
        {TIME "650B0A07010700000000000000", ANSWER_LOCAL_SET},
        {TIME "65050407020101", ANSWER_BOX}, /* boxes: half of one, one of a pixel, empty, one that ends above */
        {TIME "65080707020105030105", ANSWER_GOOD},
        {TIME "65080707020105030104", ANSWER_BOX},
        {TIME "65080707020145030106", ANSWER_BOX},
        {TIME "65080707020100030104", ANSWER_BOX},
        {TIME "6509080702010503020C01", ANSWER_BOX},
        {TIME "65080707010101050164", ANSWER_GOOD}, /* confidence: 100, 101, of two octets, of none */
        {TIME "65080707010101050165", ANSWER_SCORE},
        {TIME "6509080701010105020001", ANSWER_LOCAL_SET},
        {TIME "650706070101010500", ANSWER_LOCAL_SET},
        {TIME "65080707130130140140", ANSWER_GOOD}, /* row and column: last, behind them, 0, a row alone */
        {TIME "65080707130131140140", ANSWER_BOX},
        {TIME "65080707130130140141", ANSWER_BOX},
        {TIME "65080707130100140101", ANSWER_BOX},
        {TIME "65050407130101", ANSWER_BOX},
        {TIME "650A04070101010407010101", ANSWER_LOCAL_SET}, /* an id twice; two ids */
        {TIME "650A04070101010408010101", ANSWER_GOOD},
        {TIME "650E0D07110A2D0000005A0000000708", ANSWER_GOOD}, /* place: whole, cut, beyond a pole, a special value */
        {TIME "650D0C0711092D0000005A00000007", ANSWER_LOCAL_SET},
        {TIME "650E0D07110A5B0000005A0000000708", ANSWER_LOCAL_SET},
        {TIME "650E0D07110AC80000005A0000000708", ANSWER_LOCAL_SET},
        {TIME "650B0A070101016B0403030105",
         ANSWER_GOOD}, /* classes: of no series, of one, broken, too long, not printable */
        {TIME "650B0A070101016B0403030101670706010101060141", ANSWER_GOOD},
        {TIME "650B0A070101016B0403030201", ANSWER_LOCAL_SET},
        {TIME "650A09070101016B03050301", ANSWER_LOCAL_SET},
        {TIME
         "650B0A070101016B0403030101672524010101061F41414141414141414141414141414141414141414141414141414141414141",
         ANSWER_GOOD},
        {TIME
         "650B0A070101016B040303010167262501010106204141414141414141414141414141414141414141414141414141414141414141",
         ANSWER_TEXT},
        {TIME "650C0B0701010166050203610A62", ANSWER_TEXT},
        {TIME "6505040701010167020501", ANSWER_LOCAL_SET},
    };
    static Answer  a;
    static uint8_t octets[512];
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const AnswerReason reason = answer_read(&a, octets, set_of(octets, of[i].items), &answer_scope);
        if (reason != of[i].reason) fail_msg("%zu: %s: %s", i, of[i].items, answer_reason_name[reason]);
    }
    /* of two bands it must say which */
    const AnswerScope both = {1 << BAND_LWIR | 1 << BAND_MWIR, answer_width, answer_height};
    CHECK(answer_read(&a, octets, set_of(octets, TIME), &both) == ANSWER_BAND);
    CHECK(answer_read(&a, octets, set_of(octets, TIME "0A074952204D574952"), &both) == ANSWER_GOOD &&
          a.band == BAND_MWIR);
}

/* As many targets as an answer may have, and one more. */
static void many_targets(void **state)
{
    (void)state;
    static char    items[4096];
    static uint8_t octets[4096];
    static Answer  a;
    for (int count = answer_detections_most; count <= answer_detections_most + 1; count++) {
        size_t used = (size_t)snprintf(items, sizeof items, TIME "6582%04X", 5 * count);
        for (int k = 0; k < count; k++)
            used += (size_t)snprintf(items + used, sizeof items - used, "04%02X0101%02X", k + 1, k + 1);
        const AnswerReason reason = answer_read(&a, octets, set_of(octets, items), &answer_scope);
        CHECK(reason == (count == answer_detections_most ? ANSWER_GOOD : ANSWER_COUNT));
        if (reason == ANSWER_GOOD)
            CHECK(a.count == answer_detections_most && a.detection[63].track == 64 &&
                  a.detection[63].point_px[0] == 63.5);
    }
}

/* ---- of others, and our own --------------------------------------------------------------------------- */

/* Five of jmisb's, of a sensor of another name: all of it is in order but that. */
static void packets_of_another_program(void **state)
{
    (void)state;
    enum { each = 130, packets = 5 };
    static const AnswerScope theirs = {1 << BAND_LWIR, 1000, 600};
    static Answer            a;
    uint8_t                  octets[packets * each];
    char                     path[512];
    if (!reference_path(path, "klv/st0903-jmisb.bin")) skip();
    FILE *file = fopen(path, "rb");
    CHECK(file && fread(octets, 1, sizeof octets, file) == sizeof octets);
    fclose(file);
    for (int k = 0; k < packets; k++) {
        CHECK(answer_read(&a, octets + k * each, each, &theirs) == ANSWER_BAND);
        octets[k * each + 25]++; /* of its time */
        CHECK(answer_read(&a, octets + k * each, each, &theirs) == ANSWER_CHECKSUM);
    }
}

/* What is published of an answer, in an ST 0601 packet: read back, it is that answer; scores to a percent, boxes to a
 * pixel, places to 1.3 cm, and 1 m in height. */
static void what_is_published_is_read_back(void **state)
{
    (void)state;
    static KlvTarget kept[klv_most_targets];
    static Answer    answer = {.frame = 250, .unix_s = 1749999999.5, .count = 3}, back;
    KlvTargets       targets;
    AnswerCamera     camera;
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    const AnswerScope scope = {1 << BAND_LWIR | 1 << BAND_MWIR, lab.request.view.width, lab.request.view.height};
    answer_camera(&camera, &lab.record);
    for (int k = 0; k < 3; k++)
        answer.detection[k] = (AnswerDetection){.box_px = {NAN, NAN, NAN, NAN},
                                                .los_rad = {NAN, NAN},
                                                .range_m = NAN,
                                                .score = 0.25 * (k + 1),
                                                .track = k == 1 ? 0 : 7,
                                                .class_name = "tank",
                                                .point_px = {NAN, NAN}};
    memcpy(answer.detection[0].box_px, (double[4]){10, 20, 30, 24}, sizeof answer.detection[0].box_px);
    answer.detection[1].point_px[0] = 100.5, answer.detection[1].point_px[1] = 50.5;
    answer.detection[1].range_m = 2000;
    answer.detection[1].score = NAN;
    memcpy(answer.detection[2].box_px, (double[4]){0, 0, 1, 1}, sizeof answer.detection[2].box_px);
    answer.detection[2].track = 8;
    *answer.detection[2].class_name = 0;
    answer_complete(&answer, &camera);
    klv_of_answer(&targets, kept, &answer);
    lab.used = klv_frame(lab.octets, &lab.record, 1750000000, &(KlvSource){.band = BAND_LWIR}, &targets);
    CHECK(answer_read(&back, lab.octets, lab.used, &scope) == ANSWER_GOOD);
    CHECK(back.count == 3 && back.band == BAND_LWIR && back.frame == 250 && back.time_us == 1749999999500000);
    answer_complete(&back, &camera);
    for (int k = 0; k < 3; k++) {
        const AnswerDetection *a = &answer.detection[k], *b = &back.detection[k];
        for (int i = 0; i < 4; i++) CHECK(isnan(a->box_px[i]) ? isnan(b->box_px[i]) : a->box_px[i] == b->box_px[i]);
        CHECK(a->track == b->track && strcmp(a->class_name, b->class_name) == 0);
        CHECK(isnan(a->score) ? isnan(b->score) : fabs(a->score - b->score) < 1e-12);
        CHECK(isnan(a->range_m) == isnan(b->range_m) && isnan(a->los_rad[0]) == isnan(b->los_rad[0]));
    }
    CHECK_NEAR(back.detection[1].los_rad[0], answer.detection[1].los_rad[0], 1e-9);
    CHECK_NEAR(back.detection[1].los_rad[1], answer.detection[1].los_rad[1], 1e-9);
    CHECK_NEAR(back.detection[1].range_m, 2000, 1.1);
    for (size_t cut = 0; cut < lab.used; cut++) CHECK(answer_read(&back, lab.octets, cut, &scope) != ANSWER_GOOD);
    lab.octets[lab.used / 2]++;
    CHECK(answer_read(&back, lab.octets, lab.used, &scope) != ANSWER_GOOD);
    /* a packet without targets is no answer */
    lab.used = klv_frame(lab.octets, &lab.record, 1750000000, &(KlvSource){.band = BAND_LWIR}, NULL);
    CHECK(answer_read(&back, lab.octets, lab.used, &scope) == ANSWER_LOCAL_SET);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_packet_by_hand),
        cmocka_unit_test(each_item_is_checked),
        cmocka_unit_test(many_targets),
        cmocka_unit_test(packets_of_another_program),
        cmocka_unit_test(what_is_published_is_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
