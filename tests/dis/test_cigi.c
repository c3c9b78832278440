/* tests/dis/test_cigi.c: CIGI packets octet by octet as the document has them, exact inverses in either octet order,
 * and what a datagram may do wrong. Wireshark's dissector judges the layouts in tests/system/test_cigi_judge.sh. */
#include "tests/check.h"
#include "tests/dis/random_cigi.h"

static CigiCounters counters;
static CigiReader   reader;
static CigiPacket   first, packet;

/* IG Control of 3.3: Operate, time stamp valid; host frame 7, time stamp 0x01020304, last IG frame 9. */
static const uint8_t control_big[24] = {1, 24, 3, 0, 0x35, 0, 0x80, 0, 0, 0, 0, 7, 1, 2, 3, 4, 0, 0, 0, 9, 0, 0, 0, 0};
static const uint8_t control_little[24] = {1, 24, 3, 0, 0x35, 0, 0, 0x80, 7, 0, 0, 0,
                                           4, 3,  2, 1, 9,    0, 0, 0,    0, 0, 0, 0};

static uint8_t datagram[4096];
static size_t  octets;

static void begin(const uint8_t *control)
{
    memset(&counters, 0, sizeof counters);
    memcpy(datagram, control, 24);
    octets = 24;
}

/* Octets 0, 1, 2 ... behind a header. */
static uint8_t *add(uint8_t id, uint8_t size, size_t there)
{
    uint8_t *at = datagram + octets;
    for (size_t i = 0; i < there; i++) at[i] = (uint8_t)i;
    at[0] = id;
    at[1] = size;
    octets += there;
    return at;
}

static Status opened(void) { return cigi_open(&reader, &first, &counters, datagram, octets, CIGI_FROM_HOST); }

static int packets(void)
{
    int count = 0;
    while (cigi_next(&packet, &reader, &counters)) count++;
    return count;
}

/* ---- layouts ------------------------------------------------------------------------------------ */

static void ig_control_is_read_in_either_order(void **state)
{
    (void)state;
    for (int little = 0; little < 2; little++) {
        begin(little ? control_little : control_big);
        CHECK(opened() == STATUS_OK && first.id == cigi_ig_control && reader.order == (CigiOrder)little);
        const CigiIgControl *c = &first.of.ig_control;
        CHECK(c->major == 3 && c->minor == 3 && c->database == 0 && c->mode == cigi_mode_operate);
        CHECK(c->timestamp_valid && !c->smoothing);
        CHECK(c->host_frame == 7 && c->timestamp == 0x01020304 && c->last_ig_frame == 9);
        CHECK(packets() == 0 && counters.datagrams == 1 && counters.packets[1] == 1);
    }
}

/* Entity Control as the document draws it: octets by hand. 45.5 degrees is 0x4046C000 00000000, -7.25 0xC01D0000 ..,
 * 1234.5 0x40934A00 ..; roll 1.5 is 0x3FC00000, pitch -2 0xC0000000, yaw 90 0x42B40000. */
static void entity_control_octets(void **state)
{
    (void)state;
    static const uint8_t wanted[48] = {2,    48,   0x12, 0x34, 0x25, 0x0A, 200,  0, 0x56, 0x78, 0x9A, 0xBC,
                                       0x3F, 0xC0, 0,    0,    0xC0, 0,    0,    0, 0x42, 0xB4, 0,    0,
                                       0x40, 0x46, 0xC0, 0,    0,    0,    0,    0, 0xC0, 0x1D, 0,    0,
                                       0,    0,    0,    0,    0x40, 0x93, 0x4A, 0, 0,    0,    0,    0};
    const CigiPacket     entity = {.id = cigi_entity_control,
                                   .of.entity_control = {.id = 0x1234,
                                                         .state = cigi_entity_active,
                                                         .attached = true,
                                                         .clamp = 1,
                                                         .loops = true,
                                                         .animation = 2,
                                                         .alpha = 200,
                                                         .type = 0x5678,
                                                         .parent = 0x9ABC,
                                                         .roll_deg = 1.5f,
                                                         .pitch_deg = -2,
                                                         .yaw_deg = 90,
                                                         .p = {45.5, -7.25, 1234.5}}};
    uint8_t              out[64];
    CHECK(cigi_write(out, sizeof out, &entity, CIGI_BIG_ENDIAN) == 48 && memcmp(out, wanted, 48) == 0);
    begin(control_big);
    memcpy(datagram + octets, wanted, 48);
    octets += 48;
    CHECK(opened() == STATUS_OK && cigi_next(&packet, &reader, &counters));
    const CigiEntityControl *e = &packet.of.entity_control;
    CHECK(packet.id == cigi_entity_control && e->id == 0x1234 && e->state == 1 && e->attached && !e->collides);
    CHECK(e->clamp == 1 && e->loops && !e->backward && e->animation == 2 && e->alpha == 200 && e->type == 0x5678);
    CHECK(e->parent == 0x9ABC && e->roll_deg == 1.5f && e->pitch_deg == -2 && e->yaw_deg == 90);
    CHECK(e->p[0] == 45.5 && e->p[1] == -7.25 && e->p[2] == 1234.5);
}

static void every_field_has_its_octets_alone(void **state)
{
    (void)state;
    static const uint8_t width[] = {1, 1, 1, 1, 2, 4, 4, 8};
    for (int k = 0; k < cigi_id_count; k++) {
        const CigiLayout *layout = cigi_layout(cigi_ids[k]);
        uint8_t           taken[cigi_most_octets] = {0xFF, 0xFF}; /* bits, by octet */
        CHECK(layout && layout->id == cigi_ids[k] && layout->octets % 8 == 0 && layout->octets <= cigi_most_octets);
        if (layout->id == cigi_ig_control || layout->id == cigi_start_of_frame) taken[6] = taken[7] = 0xFF;
        for (int i = 0; i < layout->count; i++) {
            const CigiField *f = &layout->field[i];
            CHECK(f->octet % width[f->kind] == 0 && f->octet + width[f->kind] <= layout->octets);
            for (int o = 0; o < width[f->kind]; o++) {
                const uint8_t mask = (uint8_t)(f->bits ? ((1u << f->bits) - 1) << f->shift : 0xFF);
                CHECK((taken[f->octet + o] & mask) == 0);
                taken[f->octet + o] |= mask;
            }
        }
    }
}

static void write_and_read_are_inverses(void **state)
{
    (void)state;
    for (uint32_t seed = 0; seed < 600; seed++) {
        Dice             d = dice(seed);
        const CigiSender sender = seed % 2 ? CIGI_FROM_IG : CIGI_FROM_HOST;
        const CigiOrder  order = seed / 2 % 2 ? CIGI_LITTLE_ENDIAN : CIGI_BIG_ENDIAN;
        const int        begins = sender == CIGI_FROM_HOST ? 1 : cigi_host_ids + 1;
        const int        count = sender == CIGI_FROM_HOST ? cigi_host_ids - 1 : cigi_id_count - cigi_host_ids - 1;
        CigiPacket       sent[9] = {random_cigi_first(sender, &d)};
        memset(&counters, 0, sizeof counters);
        octets = cigi_write(datagram, sizeof datagram, &sent[0], order);
        for (int i = 1; i < 9; i++) {
            sent[i] = random_cigi(cigi_ids[begins + (int)(roll(&d) % (uint32_t)count)], &d);
            const size_t added = cigi_write(datagram + octets, sizeof datagram - octets, &sent[i], order);
            CHECK(added == cigi_layout(sent[i].id)->octets);
            octets += added;
        }
        CHECK(cigi_open(&reader, &first, &counters, datagram, octets, sender) == STATUS_OK && reader.order == order);
        CHECK(same_cigi(&first, &sent[0]));
        for (int i = 1; i < 9; i++) {
            CHECK(cigi_next(&packet, &reader, &counters));
            CHECK(same_cigi(&packet, &sent[i]));
        }
        CHECK(!cigi_next(&packet, &reader, &counters));
    }
}

static void what_does_not_fit_is_not_written(void **state)
{
    (void)state;
    Dice d = dice(1);
    for (int k = 0; k < cigi_id_count; k++) {
        const CigiPacket any = random_cigi(cigi_ids[k], &d);
        const uint8_t    size = cigi_layout(any.id)->octets;
        uint8_t          out[cigi_most_octets + 1];
        memset(out, 0xEE, sizeof out);
        CHECK(cigi_write(out, size - 1u, &any, CIGI_BIG_ENDIAN) == 0 && out[0] == 0xEE);
        CHECK(cigi_write(out, size, &any, CIGI_BIG_ENDIAN) == size && out[size] == 0xEE && out[1] == size);
    }
    CHECK(cigi_write(datagram, sizeof datagram, &(CigiPacket){.id = 200}, CIGI_BIG_ENDIAN) == 0);
}

/* ---- a datagram that is wrong ------------------------------------------------------------------- */

static void other_versions_are_refused(void **state)
{
    (void)state;
    static const uint8_t cigi_4[2][24] = {{0, 24, 0, 0, 4, 0, 0, 4}, {24, 0, 0, 0, 4, 0, 0, 4}};
    for (int major = 0; major < 256; major++) {
        begin(control_big);
        datagram[2] = (uint8_t)major;
        CHECK(opened() == (major == 3 ? STATUS_OK : STATUS_UNSUPPORTED));
        CHECK(counters.dropped[CIGI_DROP_VERSION] == (major != 3) && counters.datagrams == (major == 3));
    }
    for (int i = 0; i < 2; i++) {
        begin(cigi_4[i]);
        CHECK(opened() == STATUS_UNSUPPORTED && counters.dropped[CIGI_DROP_VERSION] == 1);
    }
}

/* Before 3.2 IG Control has 16 octets, and no frame number of the IG. */
static void ig_control_of_3_0_is_read(void **state)
{
    (void)state;
    for (int minor = 0; minor < 16; minor++) {
        begin(control_big);
        datagram[1] = 16;
        datagram[4] = (uint8_t)(minor << 4 | 5);
        octets = 16;
        CHECK(opened() == (minor < 2 ? STATUS_OK : STATUS_BAD_VALUE));
        CHECK(counters.dropped[CIGI_DROP_SIZE_SHORT] == (minor >= 2));
        if (minor < 2) CHECK(first.of.ig_control.host_frame == 7 && first.of.ig_control.last_ig_frame == 0);
    }
}

static void a_first_packet_that_is_wrong(void **state)
{
    (void)state;
    static const struct {
        int      octet, value; /* octet -1: the datagram has value octets */
        CigiDrop why;
    } cases[] = {{0, 101, CIGI_DROP_FIRST},    {0, 2, CIGI_DROP_FIRST},       {0, 0, CIGI_DROP_FIRST},
                 {1, 0, CIGI_DROP_SIZE_SHORT}, {1, 23, CIGI_DROP_SIZE},       {1, 16, CIGI_DROP_SIZE_SHORT},
                 {1, 32, CIGI_DROP_SIZE_LONG}, {1, 248, CIGI_DROP_SIZE_LONG}, {6, 0, CIGI_DROP_MAGIC},
                 {7, 1, CIGI_DROP_MAGIC},      {7, 0x80, CIGI_DROP_MAGIC},    {-1, 0, CIGI_DROP_SHORT},
                 {-1, 15, CIGI_DROP_SHORT},    {-1, 23, CIGI_DROP_SIZE_LONG}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        begin(control_big);
        if (cases[i].octet < 0) octets = (size_t)cases[i].value;
        else datagram[cases[i].octet] = (uint8_t)cases[i].value;
        CHECK(opened() != STATUS_OK && counters.datagrams == 0);
        for (int why = 0; why < CIGI_DROP_COUNT; why++) CHECK(counters.dropped[why] == (why == (int)cases[i].why));
    }
}

static void unknown_packets_are_skipped_by_their_size(void **state)
{
    (void)state;
    begin(control_big);
    add(3, 24, 24);     /* Conformal Clamped Entity Control: not of the subset */
    add(201, 248, 248); /* a user's */
    add(201, 8, 8);
    add(cigi_los_response, 16, 16); /* the IG's own, from a host */
    add(cigi_view_control, 32, 32);
    CHECK(opened() == STATUS_OK && packets() == 1 && packet.id == cigi_view_control);
    CHECK(counters.skipped[3] == 1 && counters.skipped[201] == 2 && counters.skipped[cigi_los_response] == 1);
    CHECK(counters.packets[cigi_view_control] == 1 && counters.packets[3] == 0);
}

static void sizes_are_not_trusted(void **state)
{
    (void)state;
    static const struct {
        uint8_t  size;
        size_t   there;
        CigiDrop why;
        int      read;
    } cases[] = {{0, 48, CIGI_DROP_SIZE, 0},        {47, 48, CIGI_DROP_SIZE, 0},       {1, 48, CIGI_DROP_SIZE, 0},
                 {248, 48, CIGI_DROP_SIZE_LONG, 0}, {40, 40, CIGI_DROP_SIZE_SHORT, 1}, {8, 8, CIGI_DROP_SIZE_SHORT, 1},
                 {56, 56, CIGI_DROP_COUNT, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        begin(control_big);
        add(cigi_entity_control, cases[i].size, cases[i].there);
        add(cigi_hat_hot_request, 32, 32);
        CHECK(opened() == STATUS_OK && packets() == cases[i].read);
        for (int why = 0; why < CIGI_DROP_COUNT; why++) CHECK(counters.dropped[why] == (why == (int)cases[i].why));
        CHECK(!cigi_next(&packet, &reader, &counters)); /* asked again, nothing is counted again */
        if (cases[i].why < CIGI_DROP_COUNT) CHECK(counters.dropped[cases[i].why] == 1);
    }
    for (size_t cut = 24; cut < 24 + 48; cut++) { /* no octet beyond the datagram is read: a sanitizer sees it */
        begin(control_big);
        add(cigi_entity_control, 48, 48);
        uint8_t *exact = malloc(cut);
        memcpy(exact, datagram, cut);
        CHECK(cigi_open(&reader, &first, &counters, exact, cut, CIGI_FROM_HOST) == STATUS_OK);
        CHECK(packets() == 0 && counters.dropped[CIGI_DROP_SIZE_LONG] == (cut > 24));
        free(exact);
    }
}

static void what_is_no_number_is_refused(void **state)
{
    (void)state;
    static const uint8_t not_finite[] = {0x7F, 0xFF};
    for (int k = 0; k < cigi_host_ids; k++) {
        const CigiLayout *layout = cigi_layout(cigi_ids[k]);
        for (int i = 0; i < layout->count; i++) {
            const CigiField *f = &layout->field[i];
            if (f->kind != CIGI_F32 && f->kind != CIGI_F64) continue;
            for (int sign = 0; sign < 2; sign++) {
                begin(control_big);
                uint8_t *at = add(layout->id, layout->octets, layout->octets);
                memset(at + 2, 0, layout->octets - 2u);
                at[f->octet] = not_finite[sign];
                at[f->octet + 1] = 0xF0;
                CHECK(opened() == STATUS_OK && packets() == 0 && counters.dropped[CIGI_DROP_NOT_FINITE] == 1);
            }
        }
    }
}

static void a_second_ig_control_is_not_used(void **state)
{
    (void)state;
    begin(control_big);
    memcpy(datagram + octets, control_big, 24);
    octets += 24;
    add(cigi_entity_control, 48, 48);
    CHECK(opened() == STATUS_OK && packets() == 1 && counters.dropped[CIGI_DROP_SECOND] == 1);
}

static void drops_and_packets_have_names(void **state)
{
    (void)state;
    for (int why = 0; why < CIGI_DROP_COUNT; why++) {
        CHECK(strcmp(cigi_drop_cause((CigiDrop)why), "unknown") != 0);
        CHECK(strcmp(cigi_drop_name((CigiDrop)why), "unknown") != 0);
        for (int k = 0; k < why; k++) CHECK(strcmp(cigi_drop_name((CigiDrop)why), cigi_drop_name((CigiDrop)k)) != 0);
    }
    CHECK(strcmp(cigi_packet_name(cigi_sensor_control), "Sensor Control") == 0);
    CHECK(strcmp(cigi_packet_name(99), "unknown packet") == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ig_control_is_read_in_either_order),
        cmocka_unit_test(entity_control_octets),
        cmocka_unit_test(every_field_has_its_octets_alone),
        cmocka_unit_test(write_and_read_are_inverses),
        cmocka_unit_test(what_does_not_fit_is_not_written),
        cmocka_unit_test(other_versions_are_refused),
        cmocka_unit_test(ig_control_of_3_0_is_read),
        cmocka_unit_test(a_first_packet_that_is_wrong),
        cmocka_unit_test(unknown_packets_are_skipped_by_their_size),
        cmocka_unit_test(sizes_are_not_trusted),
        cmocka_unit_test(what_is_no_number_is_refused),
        cmocka_unit_test(a_second_ig_control_is_not_used),
        cmocka_unit_test(drops_and_packets_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
