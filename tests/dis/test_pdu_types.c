/* The table of PDU types against the standard's, and what a PDU's type alone decides: its least length, its sender. */
#include "tests/check.h"

#include "dis/pdu/decode.h"

/* IEEE 1278.1-2012, PDU types (SISO-REF-010, UID 4), in their order. PyPI's opendis 1.0 has the same classes at the
 * numbers it decodes, but for 6, 41 and 63, which it confuses with 66, 43 and 65. */
static const char *const standard_name[] = {
    "Other",
    "Entity State",
    "Fire",
    "Detonation",
    "Collision",
    "Service Request",
    "Resupply Offer",
    "Resupply Received",
    "Resupply Cancel",
    "Repair Complete",
    "Repair Response",
    "Create Entity",
    "Remove Entity",
    "Start/Resume",
    "Stop/Freeze",
    "Acknowledge",
    "Action Request",
    "Action Response",
    "Data Query",
    "Set Data",
    "Data",
    "Event Report",
    "Comment",
    "Electromagnetic Emission",
    "Designator",
    "Transmitter",
    "Signal",
    "Receiver",
    "IFF",
    "Underwater Acoustic",
    "Supplemental Emission/Entity State",
    "Intercom Signal",
    "Intercom Control",
    "Aggregate State",
    "IsGroupOf",
    "Transfer Ownership",
    "IsPartOf",
    "Minefield State",
    "Minefield Query",
    "Minefield Data",
    "Minefield Response NACK",
    "Environmental Process",
    "Gridded Data",
    "Point Object State",
    "Linear Object State",
    "Areal Object State",
    "TSPI",
    "Appearance",
    "Articulated Parts",
    "LE Fire",
    "LE Detonation",
    "Create Entity-R",
    "Remove Entity-R",
    "Start/Resume-R",
    "Stop/Freeze-R",
    "Acknowledge-R",
    "Action Request-R",
    "Action Response-R",
    "Data Query-R",
    "Set Data-R",
    "Data-R",
    "Event Report-R",
    "Comment-R",
    "Record-R",
    "Set Record-R",
    "Record Query-R",
    "Collision-Elastic",
    "Entity State Update",
    "Directed Energy Fire",
    "Entity Damage Status",
    "Information Operations Action",
    "Information Operations Report",
    "Attribute",
};
enum { standard_types = sizeof standard_name / sizeof standard_name[0] };

static void names_are_the_standards(void **state)
{
    (void)state;
    CHECK(standard_types == 73);
    for (int type = 0; type < 256; type++) {
        const char *want = type < standard_types ? standard_name[type] : "unknown type";
        if (strcmp(dis_pdu_type_name((uint8_t)type), want) != 0)
            fail_msg("type %d is %s, not %s", type, dis_pdu_type_name((uint8_t)type), want);
    }
}

/* Octets before the variable records, by the layouts of IEEE 1278.1-2012: 12 of the header, 6 an entity id, 8 an entity
 * type, 12 a vector of floats, 24 a vector of doubles, 8 a clock time. */
static unsigned standard_octets(int type)
{
    switch (type) {
    case 1: /* id, force, count, 2 types, velocity, location, orientation, appearance, dead reckoning, marking, 4 */
        return 12 + 6 + 1 + 1 + 2 * 8 + 12 + 24 + 12 + 4 + 40 + 12 + 4;
    case 2: /* firing, target, munition, event, mission, location, descriptor, velocity, range */
        return 12 + 3 * 6 + 6 + 4 + 24 + 16 + 12 + 4;
    case 3: /* firing, target, exploding, event, velocity, location, descriptor, location in the target, result, count,
               2 */
        return 12 + 3 * 6 + 6 + 12 + 24 + 16 + 12 + 1 + 1 + 2;
    case 12: /* originating, receiving, request */
        return 12 + 2 * 6 + 4;
    case 13: /* and two clock times */
        return 12 + 2 * 6 + 2 * 8 + 4;
    case 14: /* one, reason, behaviour, 2; in the reliable one these 2 are reliability and 1 */
    case 54:
        return 12 + 2 * 6 + 8 + 1 + 1 + 2 + 4;
    case 52: /* reliability, 3 */
        return 12 + 2 * 6 + 1 + 3 + 4;
    case 53:
        return 12 + 2 * 6 + 2 * 8 + 1 + 3 + 4;
    case 67: /* id, 1, count, velocity, location, orientation, appearance */
        return 12 + 6 + 1 + 1 + 12 + 24 + 12 + 4;
    default: /* not acted upon: a header is enough */
        return 12;
    }
}

static void each_type_has_its_least_length(void **state)
{
    (void)state;
    for (int type = 0; type < 256; type++) {
        const unsigned least = standard_octets(type);
        for (unsigned octets = least - 1; octets <= least; octets++) {
            uint8_t        wire[160] = {7, 1, (uint8_t)type, 1, 0, 0, 0, 0, 0, (uint8_t)octets};
            DisCounters    counters = {0};
            DisHeader      header;
            const uint8_t *pdu, *at = wire;
            CHECK(dis_next_pdu(&header, &pdu, &at, wire + (octets < 12 ? 12 : octets), &counters) == (octets == least));
            CHECK(counters.dropped[DIS_DROP_LENGTH_TOO_SHORT] == (octets < least));
            CHECK(counters.pdus[type] == (octets == least));
            if (octets == least) CHECK(header.type == type && header.length == octets && pdu == wire);
        }
    }
}

/* Lengths of 0 are made up where they, and those of up to 63 PDUs behind, end with the datagram: of 65 the first is
 * refused. */
static void lengths_of_zero_are_made_for_64_pdus(void **state)
{
    (void)state;
    enum { octets = 40 };
    static uint8_t wire[65 * octets];
    for (int count = 63; count <= 65; count++) {
        memset(wire, 0, sizeof wire);
        for (int i = 0; i < count; i++) wire[octets * i] = 7, wire[octets * i + 2] = 14, wire[octets * i + 3] = 5;
        DisCounters    counters = {0};
        DisHeader      header;
        const uint8_t *pdu, *at = wire;
        unsigned       made = 0;
        while (dis_next_pdu(&header, &pdu, &at, wire + octets * count, &counters)) made += header.length == octets;
        CHECK(made == (count <= 64 ? (unsigned)count : 0) && counters.lengths_made == made);
        CHECK(counters.dropped[DIS_DROP_LENGTH_ZERO] == (count > 64));
    }
}

/* Types 1 .. 72 begin with an id of site, application and one number more, at octets 12, 14 and 16. */
static void senders_are_at_octet_12(void **state)
{
    (void)state;
    uint8_t wire[18] = {7};
    wire[12] = 0x12, wire[13] = 0x34, wire[14] = 0x56, wire[15] = 0x78, wire[16] = 0x9A, wire[17] = 0xBC;
    for (int type = 0; type < 256; type++)
        for (int octets = 12; octets <= 18; octets++) {
            const DisHeader header = {.version = 7, .type = (uint8_t)type, .length = (uint16_t)octets};
            uint16_t        sender[2] = {1, 2};
            const bool      named = type >= 1 && type <= 72 && octets >= 16;
            CHECK(dis_pdu_sender(sender, &header, wire) == named);
            CHECK(sender[0] == (named ? 0x1234 : 1) && sender[1] == (named ? 0x5678 : 2));
            CHECK(dis_pdu_entity(&header, wire) == ((type == 1 || type == 67) && octets >= 18 ? 0x9ABC : -1));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_the_standards),
        cmocka_unit_test(each_type_has_its_least_length),
        cmocka_unit_test(lengths_of_zero_are_made_for_64_pdus),
        cmocka_unit_test(senders_are_at_octet_12),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
