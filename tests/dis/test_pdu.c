/* tests/dis/test_pdu.c: layouts octet by octet, exact inverses, and what a datagram may do wrong. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"
#include "dis/pdu/decode.h"

static DisPdu decoded, again;

/* ---- layouts: octet k holds k, so a field says where it was read ------------------------------- */

static uint8_t staircase[256];

static void build_staircase(uint8_t type, uint16_t length)
{
    for (int i = 0; i < 256; i++) staircase[i] = (uint8_t)i;
    staircase[0] = 7;
    staircase[2] = type;
    staircase[8] = (uint8_t)(length >> 8);
    staircase[9] = (uint8_t)length;
}

static uint16_t u16_at(int k) { return (uint16_t)(k << 8 | (k + 1)); }
static uint32_t u32_at(int k) { return (uint32_t)u16_at(k) << 16 | u16_at(k + 2); }

static bool is_f32_at(const float *v, int k)
{
    uint32_t bits;
    memcpy(&bits, v, sizeof bits);
    return bits == u32_at(k);
}

static bool is_f64_at(const double *v, int k)
{
    uint64_t bits;
    memcpy(&bits, v, sizeof bits);
    return bits == ((uint64_t)u32_at(k) << 32 | u32_at(k + 4));
}

static bool is_id_at(DisEntityId id, int k)
{
    return id.site == u16_at(k) && id.application == u16_at(k + 2) && id.entity == u16_at(k + 4);
}

static bool is_type_at(DisEntityType t, int k)
{
    return t.kind == k && t.domain == k + 1 && t.country == u16_at(k + 2) && t.category == k + 4 &&
           t.subcategory == k + 5 && t.specific == k + 6 && t.extra == k + 7;
}

static void header_is_where_the_standard_says(void **state)
{
    (void)state;
    build_staircase(200, 40);
    DisCounters    counters = {0};
    DisHeader      header;
    const uint8_t *pdu, *at = staircase;
    CHECK(dis_next_pdu(&header, &pdu, &at, staircase + 40, &counters));
    CHECK(header.version == 7 && header.exercise == 1 && header.type == 200 && header.family == 3);
    CHECK(header.timestamp == u32_at(4) && header.length == 40 && header.status == 10 && header.padding == 11);
    CHECK(pdu == staircase && at == staircase + 40 && counters.pdus[200] == 1);
}

static void entity_state_fields(void **state)
{
    (void)state;
    build_staircase(1, 176);
    staircase[19] = 2;
    staircase[144] = dis_variable_articulated;
    staircase[160] = dis_variable_attached;
    DisEntityState *es = &decoded.entity_state;
    CHECK(dis_decode(&decoded, staircase, 176) == STATUS_OK);
    CHECK(is_id_at(es->id, 12) && es->force == 18 && es->variable_count == 2);
    CHECK(is_type_at(es->type, 20) && is_type_at(es->alternative_type, 28));
    for (int i = 0; i < 3; i++) {
        CHECK(is_f32_at(&es->velocity_mps[i], 36 + 4 * i));
        CHECK(is_f64_at(&es->p_ecef[i], 48 + 8 * i));
        CHECK(is_f32_at(&es->acceleration_mps2[i], 104 + 4 * i));
        CHECK(is_f32_at(&es->angular_rate_rps[i], 116 + 4 * i));
    }
    CHECK(is_f32_at(&es->psi_rad, 72) && is_f32_at(&es->theta_rad, 76) && is_f32_at(&es->phi_rad, 80));
    CHECK(es->appearance == u32_at(84) && es->dead_reckoning == 88);
    CHECK(memcmp(es->dead_reckoning_other, staircase + 89, 15) == 0);
    CHECK(es->marking_set == 128 && memcmp(es->marking, staircase + 129, 11) == 0);
    CHECK(es->capabilities == u32_at(140));
    CHECK(es->variable[0].change == 145 && es->variable[0].attached_to == u16_at(146));
    CHECK(es->variable[0].parameter == u32_at(148) && is_f32_at(&es->variable[0].value, 152));
    CHECK(es->variable[1].change == 161 && es->variable[1].attached_to == u16_at(162));
    CHECK(es->variable[1].parameter == u32_at(164) && is_type_at(es->variable[1].type, 168));
}

static void entity_state_update_fields(void **state)
{
    (void)state;
    build_staircase(67, 88);
    staircase[19] = 1;
    staircase[72] = dis_variable_articulated;
    DisEntityStateUpdate *update = &decoded.update;
    CHECK(dis_decode(&decoded, staircase, 88) == STATUS_OK);
    CHECK(is_id_at(update->id, 12) && update->padding == 18 && update->variable_count == 1);
    for (int i = 0; i < 3; i++) {
        CHECK(is_f32_at(&update->velocity_mps[i], 20 + 4 * i));
        CHECK(is_f64_at(&update->p_ecef[i], 32 + 8 * i));
    }
    CHECK(is_f32_at(&update->psi_rad, 56) && is_f32_at(&update->theta_rad, 60) && is_f32_at(&update->phi_rad, 64));
    CHECK(update->appearance == u32_at(68));
    CHECK(update->variable[0].parameter == u32_at(76) && is_f32_at(&update->variable[0].value, 80));
}

static void fire_fields(void **state)
{
    (void)state;
    build_staircase(2, 96);
    DisFire *fire = &decoded.fire;
    CHECK(dis_decode(&decoded, staircase, 96) == STATUS_OK);
    CHECK(is_id_at(fire->firing, 12) && is_id_at(fire->target, 18) && is_id_at(fire->munition, 24));
    CHECK(fire->event.site == u16_at(30) && fire->event.application == u16_at(32) && fire->event.number == u16_at(34));
    CHECK(fire->fire_mission == u32_at(36) && is_type_at(fire->descriptor.type, 64));
    CHECK(fire->descriptor.warhead == u16_at(72) && fire->descriptor.fuse == u16_at(74));
    CHECK(fire->descriptor.quantity == u16_at(76) && fire->descriptor.rate == u16_at(78));
    for (int i = 0; i < 3; i++) {
        CHECK(is_f64_at(&fire->p_ecef[i], 40 + 8 * i));
        CHECK(is_f32_at(&fire->velocity_mps[i], 80 + 4 * i));
    }
    CHECK(is_f32_at(&fire->range_m, 92));
}

static void detonation_fields(void **state)
{
    (void)state;
    build_staircase(3, 120);
    staircase[101] = 1;
    DisDetonation *d = &decoded.detonation;
    CHECK(dis_decode(&decoded, staircase, 120) == STATUS_OK);
    CHECK(is_id_at(d->firing, 12) && is_id_at(d->target, 18) && is_id_at(d->munition, 24));
    CHECK(d->event.number == u16_at(34) && is_type_at(d->descriptor.type, 72) && d->descriptor.rate == u16_at(86));
    for (int i = 0; i < 3; i++) {
        CHECK(is_f32_at(&d->velocity_mps[i], 36 + 4 * i));
        CHECK(is_f64_at(&d->p_ecef[i], 48 + 8 * i));
        CHECK(is_f32_at(&d->p_target_m[i], 88 + 4 * i));
    }
    CHECK(d->result == 100 && d->variable_count == 1 && d->padding[0] == 102 && d->padding[1] == 103);
    CHECK(d->variable[0].record_type == 104 && memcmp(d->variable[0].octets, staircase + 104, 16) == 0);
}

static void simulation_management_fields(void **state)
{
    (void)state;
    build_staircase(12, 28);
    CHECK(dis_decode(&decoded, staircase, 28) == STATUS_OK);
    CHECK(is_id_at(decoded.remove.originating, 12) && is_id_at(decoded.remove.receiving, 18));
    CHECK(decoded.remove.request == u32_at(24));

    build_staircase(13, 44);
    CHECK(dis_decode(&decoded, staircase, 44) == STATUS_OK);
    CHECK(decoded.start.real_world.hour == u32_at(24) && decoded.start.real_world.past_hour == u32_at(28));
    CHECK(decoded.start.simulation.hour == u32_at(32) && decoded.start.simulation.past_hour == u32_at(36));
    CHECK(decoded.start.request == u32_at(40));

    build_staircase(14, 40);
    CHECK(dis_decode(&decoded, staircase, 40) == STATUS_OK);
    CHECK(decoded.stop.real_world.hour == u32_at(24) && decoded.stop.real_world.past_hour == u32_at(28));
    CHECK(decoded.stop.reason == 32 && decoded.stop.frozen_behaviour == 33 && decoded.stop.padding[1] == 35);
    CHECK(decoded.stop.request == u32_at(36));
}

/* ---- inverses -------------------------------------------------------------------------------------- */

static void random_pdus_come_back_octet_for_octet(void **state)
{
    (void)state;
    static uint8_t wire[random_pdu_octets], back[random_pdu_octets];
    Dice           d = dice(1);
    for (int round = 0; round < 20000; round++) {
        const int    kind = (int)(roll(&d) % random_pdu_kinds);
        const size_t length = random_pdu(wire, &d, kind);
        CHECK(dis_decode(&decoded, wire, length) == STATUS_OK);
        CHECK(dis_encode(back, sizeof back, &decoded) == length);
        CHECK(memcmp(wire, back, length) == 0);
        CHECK(dis_encode(back, length, &decoded) == length);
        CHECK(dis_encode(back, length - 1, &decoded) == 0);
    }
}

/* A signalling NaN with a payload, an infinity, -0 and the least denormal, in every float of a PDU. */
static void float_patterns_survive(void **state)
{
    (void)state;
    static const uint32_t f32[] = {0x7FA5A5A5, 0xFFC12345, 0x7F800000, 0x80000000, 0x00000001, 0xFF800001};
    static const uint64_t f64[] = {0x7FF5A5A5DEADBEEF, 0xFFF8000000000123, 0xFFF0000000000000, 0x8000000000000000, 1};
    static uint8_t        wire[160], back[160];
    for (size_t a = 0; a < sizeof f32 / sizeof f32[0]; a++) {
        for (size_t b = 0; b < sizeof f64 / sizeof f64[0]; b++) {
            memset(wire, 0, sizeof wire);
            wire[0] = 6;
            wire[2] = 1;
            wire[9] = 160;
            wire[19] = 1;
            static const int f32_at[] = {36, 40, 44, 72, 76, 80, 104, 108, 112, 116, 120, 124, 152};
            for (size_t i = 0; i < sizeof f32_at / sizeof f32_at[0]; i++)
                for (int k = 0; k < 4; k++) wire[f32_at[i] + k] = (uint8_t)(f32[a] >> (24 - 8 * k));
            for (int i = 0; i < 3; i++)
                for (int k = 0; k < 8; k++) wire[48 + 8 * i + k] = (uint8_t)(f64[b] >> (56 - 8 * k));
            CHECK(dis_decode(&decoded, wire, 160) == STATUS_OK);
            again.entity_state = decoded.entity_state; /* a copy of the struct must not quieten either */
            CHECK(dis_encode_entity_state(back, 160, &again.entity_state) == 160);
            CHECK(memcmp(wire, back, 160) == 0);
        }
    }
}

/* Every length below the whole PDU fails, and the output keeps every octet it had. */
static void failure_leaves_the_output_alone(void **state)
{
    (void)state;
    static uint8_t wire[random_pdu_octets];
    Dice           d = dice(2);
    for (int kind = 0; kind < random_pdu_kinds; kind++) {
        const size_t length = random_pdu(wire, &d, kind);
        for (size_t octets = 0; octets < length; octets++) {
            memset(&decoded, 0xA5, sizeof decoded);
            memset(&again, 0xA5, sizeof again);
            CHECK(dis_decode(&decoded, wire, octets) != STATUS_OK);
            CHECK(memcmp(&decoded, &again, sizeof again) == 0);
        }
        /* the same with a length field that admits it */
        for (size_t octets = 1; octets < length; octets++) {
            wire[8] = (uint8_t)(octets >> 8);
            wire[9] = (uint8_t)octets;
            memset(&decoded, 0xA5, sizeof decoded);
            const Status status = dis_decode(&decoded, wire, length);
            CHECK(status == (octets < (size_t)random_pdu_fixed[kind] ? STATUS_TRUNCATED : STATUS_BAD_VALUE));
            CHECK(memcmp(&decoded, &again, sizeof again) == 0);
        }
    }
}

static void surplus_octets_are_ignored(void **state)
{
    (void)state;
    static uint8_t wire[200], back[200];
    memset(wire, 0xEE, sizeof wire);
    wire[0] = 7;
    wire[2] = 1;
    wire[8] = 0;
    wire[9] = 170; /* one record announced, room for one and ten octets more */
    wire[19] = 1;
    CHECK(dis_decode(&decoded, wire, 170) == STATUS_OK);
    CHECK(decoded.entity_state.variable_count == 1 && decoded.entity_state.header.length == 170);
    CHECK(dis_encode_entity_state(back, sizeof back, &decoded.entity_state) == 160);
    CHECK(back[9] == 160 && memcmp(back + 10, wire + 10, 150) == 0);
}

/* ---- the walk --------------------------------------------------------------------------------------- */

static size_t put_header(uint8_t *at, uint8_t version, uint8_t type, uint16_t length)
{
    memset(at, 0, length < 12 ? 12 : length);
    at[0] = version;
    at[1] = 1;
    at[2] = type;
    at[8] = (uint8_t)(length >> 8);
    at[9] = (uint8_t)length;
    return length;
}

/* Walks exactly `octets` (on the heap, so that a sanitizer sees the end); returns the PDUs found. */
static int walk(DisCounters *counters, const uint8_t *bytes, size_t octets)
{
    uint8_t *heap = malloc(octets ? octets : 1);
    CHECK(heap != NULL);
    memcpy(heap, bytes, octets);
    const uint8_t *at = heap, *end = heap + octets, *pdu;
    DisHeader      header;
    int            found = 0;
    *counters = (DisCounters){0};
    while (dis_next_pdu(&header, &pdu, &at, end, counters)) {
        CHECK(pdu >= heap && pdu + header.length <= end && at == pdu + header.length);
        found++;
    }
    CHECK(at == end);
    CHECK(!dis_next_pdu(&header, &pdu, &at, end, counters)); /* asking again finds and counts nothing */
    free(heap);
    return found;
}

static uint64_t all_drops(const DisCounters *counters)
{
    uint64_t sum = 0;
    for (int i = 0; i < DIS_DROP_COUNT; i++) sum += counters->dropped[i];
    return sum;
}

static void bundles_are_walked(void **state)
{
    (void)state;
    static uint8_t bytes[4096];
    DisCounters    counters;
    size_t         n = put_header(bytes, 7, 1, 144);
    n += put_header(bytes + n, 7, 72, 32);
    n += put_header(bytes + n, 5, 137, 12); /* a type nobody knows */
    n += put_header(bytes + n, 6, 2, 96);
    n += put_header(bytes + n, 6, 1, 144);
    CHECK(walk(&counters, bytes, n) == 5);
    CHECK(counters.pdus[1] == 2 && counters.pdus[72] == 1 && counters.pdus[137] == 1 && counters.pdus[2] == 1);
    CHECK(all_drops(&counters) == 0);
    CHECK(walk(&counters, bytes, 0) == 0 && all_drops(&counters) == 0);
}

/* After one good PDU: a misfit of every kind, counted once under its own name, the first PDU kept. */
static void every_misfit_has_its_reason(void **state)
{
    (void)state;
    const struct {
        uint8_t  version, type;
        uint16_t length, present;
        DisDrop  why;
    } misfit[] = {
        {7, 1, 144, 11, DIS_DROP_SHORT_HEADER},        {7, 1, 144, 1, DIS_DROP_SHORT_HEADER},
        {4, 1, 144, 144, DIS_DROP_BAD_VERSION},        {8, 1, 144, 144, DIS_DROP_BAD_VERSION},
        {0, 0, 0, 20, DIS_DROP_BAD_VERSION}, /* zeros at the end of a datagram */
        {7, 20, 0, 144, DIS_DROP_LENGTH_ZERO},         {7, 20, 11, 144, DIS_DROP_LENGTH_TOO_SHORT},
        {7, 1, 143, 144, DIS_DROP_LENGTH_TOO_SHORT},   {7, 3, 103, 144, DIS_DROP_LENGTH_TOO_SHORT},
        {7, 67, 71, 144, DIS_DROP_LENGTH_TOO_SHORT},   {7, 2, 95, 144, DIS_DROP_LENGTH_TOO_SHORT},
        {7, 12, 27, 144, DIS_DROP_LENGTH_TOO_SHORT},   {7, 13, 43, 144, DIS_DROP_LENGTH_TOO_SHORT},
        {7, 14, 39, 144, DIS_DROP_LENGTH_TOO_SHORT},   {7, 1, 145, 144, DIS_DROP_LENGTH_TOO_LONG},
        {7, 20, 14064, 508, DIS_DROP_LENGTH_TOO_LONG},
    };
    static uint8_t bytes[20000];
    for (size_t i = 0; i < sizeof misfit / sizeof misfit[0]; i++) {
        DisCounters  counters;
        const size_t n = put_header(bytes, 7, 1, 144);
        put_header(bytes + n, misfit[i].version, misfit[i].type, misfit[i].length);
        CHECK(walk(&counters, bytes, n + misfit[i].present) == 1);
        CHECK(counters.pdus[1] == 1 && all_drops(&counters) == 1);
        CHECK(counters.dropped[misfit[i].why] == 1);
    }
}

/* Zeros up to a multiple of 8 octets between PDUs and at the end; eight and more are no padding. */
static void padded_bundles_are_walked(void **state)
{
    (void)state;
    static uint8_t bytes[2000];
    DisCounters    counters;
    for (size_t zeros = 0; zeros <= 8; zeros++) {
        memset(bytes, 0, sizeof bytes);
        size_t at = put_header(bytes, 7, 1, 144) + zeros;
        at += put_header(bytes + at, 7, 12, 28) + zeros;
        at += put_header(bytes + at, 6, 1, 144) + zeros;
        const bool taken = zeros < 8;
        CHECK(walk(&counters, bytes, at) == (taken ? 3 : 1));
        CHECK(all_drops(&counters) == !taken && counters.padded == (taken && zeros ? 3 : 0));
    }
}

/* A length field of 0: taken where types and counts end exactly with the datagram, alone, in bundles, padded. */
static void lengths_of_zero_are_found(void **state)
{
    (void)state;
    static uint8_t bytes[20000];
    DisCounters    counters;
    const struct {
        uint8_t type, count_at, count;
        size_t  octets;
    } sent[] = {{1, 19, 0, 144}, {1, 19, 3, 192}, {67, 19, 2, 104}, {2, 0, 0, 96},  {3, 101, 1, 120}, {12, 0, 0, 28},
                {13, 0, 0, 44},  {14, 0, 0, 40},  {52, 0, 0, 32},   {53, 0, 0, 48}, {54, 0, 0, 40}};
    const size_t kinds = sizeof sent / sizeof sent[0];
    for (size_t i = 0; i < kinds; i++)
        for (int extra = -1; extra <= 8; extra++) {
            memset(bytes, 0, sizeof bytes);
            put_header(bytes, 7, sent[i].type, 0);
            if (sent[i].count_at) bytes[sent[i].count_at] = sent[i].count;
            const bool   taken = extra >= 0 && extra < 8;
            const size_t octets = sent[i].octets + (size_t)(extra + 1) - 1;
            CHECK(walk(&counters, bytes, octets) == taken);
            CHECK(counters.lengths_made == taken && counters.dropped[DIS_DROP_LENGTH_ZERO] == !taken);
            if (taken) CHECK(dis_decode(&decoded, bytes, sent[i].octets) == STATUS_OK && decoded.type == sent[i].type);
        }
    size_t at = 0;
    memset(bytes, 0, sizeof bytes);
    for (size_t i = 0; i < kinds; i++) {
        put_header(bytes + at, 7, sent[i].type, 0);
        if (sent[i].count_at) bytes[at + sent[i].count_at] = sent[i].count;
        at += sent[i].octets;
    }
    CHECK(walk(&counters, bytes, at) == (int)kinds && counters.lengths_made == kinds);
    memset(bytes, 0, sizeof bytes); /* more than is looked at: refused, in time linear in their number */
    for (int i = 0; i < 500; i++) put_header(bytes + 28 * i, 7, 12, 0);
    CHECK(walk(&counters, bytes, 28 * 500) == 0 && counters.dropped[DIS_DROP_LENGTH_ZERO] == 1);
    put_header(bytes, 7, 20, 0); /* Data: its length is its own */
    CHECK(walk(&counters, bytes, 40) == 0 && counters.dropped[DIS_DROP_LENGTH_ZERO] == 1);
}

/* The family with reliability keeps every octet; where the request is. */
static void reliable_ones_survive(void **state)
{
    (void)state;
    static const struct {
        uint8_t type;
        size_t  octets, request_at;
    } kind[] = {{52, 32, 28}, {53, 48, 44}, {54, 40, 36}};
    Dice d = dice(9);
    for (int round = 0; round < 300; round++) {
        uint8_t   wire[48], back[48];
        const int k = round % 3;
        roll_octets(&d, wire, sizeof wire);
        wire[0] = 7, wire[2] = kind[k].type, wire[8] = 0, wire[9] = (uint8_t)kind[k].octets;
        CHECK(dis_decode(&decoded, wire, kind[k].octets) == STATUS_OK);
        CHECK(dis_encode(back, sizeof back, &decoded) == kind[k].octets && memcmp(back, wire, kind[k].octets) == 0);
        const uint32_t request = k == 0   ? decoded.remove.request
                                 : k == 1 ? decoded.start.request
                                          : decoded.stop.request;
        const uint8_t *at = wire + kind[k].request_at;
        CHECK(request == ((uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3]));
        CHECK(dis_decode(&decoded, wire, kind[k].octets - 1) != STATUS_OK);
    }
}

static void names_are_whole_and_different(void **state)
{
    (void)state;
    for (int i = 0; i < DIS_DROP_COUNT; i++)
        for (int k = 0; k < i; k++)
            CHECK(strcmp(dis_drop_name((DisDrop)i), dis_drop_name((DisDrop)k)) != 0 &&
                  strcmp(dis_drop_cause((DisDrop)i), dis_drop_cause((DisDrop)k)) != 0);
    CHECK(strcmp(dis_drop_name((DisDrop)DIS_DROP_COUNT), "unknown") == 0);
    CHECK(strcmp(dis_pdu_type_name(1), "Entity State") == 0 && strcmp(dis_pdu_type_name(72), "Attribute") == 0);
    CHECK(strcmp(dis_pdu_type_name(137), "unknown type") == 0);
}

/* ---- identifiers --------------------------------------------------------------------------------------- */

static void ids_as_text(void **state)
{
    (void)state;
    char        text[dis_id_text_size];
    DisEntityId id = {1, 3001, 65535}, back = {9, 9, 9};
    dis_entity_id_text(text, id);
    CHECK(strcmp(text, "1:3001:65535") == 0);
    CHECK(dis_entity_id_parse(&back, text) && dis_entity_id_compare(id, back) == 0);
    dis_entity_id_text(text, (DisEntityId){65535, 65535, 65535});
    CHECK(strcmp(text, "65535:65535:65535") == 0);

    static const char *const bad[] = {"",       ":",     "1:2",    "1:2:",    "1:2:3:",
                                      "1:2:3 ", "1:2:x", "-1:2:3", "+1:2:3",  "1:2:65536",
                                      " 1:2:3", "1::3",  "1.2.3",  "1:2:3:4", "99999999999999999999:1:1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        back = (DisEntityId){9, 9, 9};
        CHECK(!dis_entity_id_parse(&back, bad[i]));
        CHECK(back.site == 9 && back.application == 9 && back.entity == 9);
    }

    char type[dis_type_text_size];
    dis_entity_type_text(type, (DisEntityType){255, 255, 65535, 255, 255, 255, 255});
    CHECK(strcmp(type, "255.255.65535.255.255.255.255") == 0);
}

static void ids_are_ordered_by_site_application_entity(void **state)
{
    (void)state;
    const DisEntityId order[] = {{0, 0, 0},     {0, 0, 1},      {0, 1, 0},  {1, 0, 0},
                                 {1, 3001, 66}, {1, 3001, 256}, {256, 0, 0}};
    for (int i = 0; i < 7; i++)
        for (int k = 0; k < 7; k++) {
            const int c = dis_entity_id_compare(order[i], order[k]);
            CHECK((c > 0) - (c < 0) == (i > k) - (i < k));
        }
    CHECK(dis_entity_id_is_none(order[0]) && !dis_entity_id_is_none(order[1]));
}

/* ---- fit for geodesy ------------------------------------------------------------------------------------ */

static void usable_entities(void **state)
{
    (void)state;
    const DisEntityId id = {1, 3001, 66};
    const double      p[3] = {6378137, 0, 0};
    const float       v[3] = {0, 0, 0}, euler[3] = {0, 0, 0};
    DisDrop           why = DIS_DROP_COUNT;
    CHECK(dis_entity_is_usable(&why, id, p, v, euler) && why == DIS_DROP_COUNT);
    CHECK(dis_entity_is_usable(&why, (DisEntityId){0, 0, 1}, p, v, euler)); /* a sender nobody configured */

    const DisEntityId nobody[] = {{0, 0, 0},         {1, 3001, 0},   {1, 3001, 0xFFFF},
                                  {1, 3001, 0xFFFE}, {0xFFFF, 1, 1}, {1, 0xFFFF, 1}};
    for (int i = 0; i < 6; i++) {
        CHECK(!dis_entity_is_usable(&why, nobody[i], p, v, euler));
        CHECK(why == DIS_DROP_NO_IDENTITY);
    }
    for (int axis = 0; axis < 3; axis++) {
        for (int bad = 0; bad < 3; bad++) {
            const double x = bad == 0 ? NAN : bad == 1 ? INFINITY : -INFINITY;
            double       bad_p[3] = {6378137, 0, 0};
            float        bad_v[3] = {0}, bad_euler[3] = {0};
            bad_p[axis] = x;
            bad_v[axis] = bad_euler[axis] = (float)x;
            CHECK(!dis_entity_is_usable(&why, id, bad_p, v, euler) && why == DIS_DROP_NOT_FINITE);
            CHECK(!dis_entity_is_usable(&why, id, p, bad_v, euler) && why == DIS_DROP_NOT_FINITE);
            CHECK(!dis_entity_is_usable(&why, id, p, v, bad_euler) && why == DIS_DROP_NOT_FINITE);
        }
    }
    const double nowhere[][3] = {{0, 0, 0}, {9.9e4, 0, 0}, {0, 1.01e8, 0}, {1e300, 1e300, 0}};
    for (int i = 0; i < 4; i++) {
        CHECK(!dis_entity_is_usable(&why, id, nowhere[i], v, euler));
        CHECK(why == DIS_DROP_BAD_POSITION);
    }
    const double somewhere[][3] = {
        {0, 0, 4.2e7}, {0, -1.02e5, 0}, {0, 0, 9.9e7}}; /* an orbit; just within 1e5 .. 1e8 m */
    for (int i = 0; i < 3; i++) CHECK(dis_entity_is_usable(&why, id, somewhere[i], v, euler));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(header_is_where_the_standard_says),
        cmocka_unit_test(entity_state_fields),
        cmocka_unit_test(entity_state_update_fields),
        cmocka_unit_test(fire_fields),
        cmocka_unit_test(detonation_fields),
        cmocka_unit_test(simulation_management_fields),
        cmocka_unit_test(random_pdus_come_back_octet_for_octet),
        cmocka_unit_test(float_patterns_survive),
        cmocka_unit_test(failure_leaves_the_output_alone),
        cmocka_unit_test(surplus_octets_are_ignored),
        cmocka_unit_test(bundles_are_walked),
        cmocka_unit_test(every_misfit_has_its_reason),
        cmocka_unit_test(padded_bundles_are_walked),
        cmocka_unit_test(lengths_of_zero_are_found),
        cmocka_unit_test(reliable_ones_survive),
        cmocka_unit_test(names_are_whole_and_different),
        cmocka_unit_test(ids_as_text),
        cmocka_unit_test(ids_are_ordered_by_site_application_entity),
        cmocka_unit_test(usable_entities),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
