/* dis/decode.c: the table of PDU types; decodes and encodes tagged PDUs by it. */
#include "dis/decode_private.h"

#include "dis/data_private.h"
#include "dis/entity_state_private.h"
#include "dis/reader.h"
#include "dis/simulation_management_private.h"
#include "dis/warfare_private.h"

/* From and to the member of the union that belongs to the type; dis_decode sets the tag. */
static Status decode_entity_state(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_entity_state(&out->entity_state, pdu, octets);
}

static size_t encode_entity_state(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_entity_state(out, capacity, &pdu->entity_state);
}

static Status decode_entity_state_update(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_entity_state_update(&out->update, pdu, octets);
}

static size_t encode_entity_state_update(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_entity_state_update(out, capacity, &pdu->update);
}

static Status decode_fire(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_fire(&out->fire, pdu, octets);
}

static size_t encode_fire(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_fire(out, capacity, &pdu->fire);
}

static Status decode_detonation(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_detonation(&out->detonation, pdu, octets);
}

static size_t encode_detonation(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_detonation(out, capacity, &pdu->detonation);
}

static Status decode_remove_entity(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_remove_entity(&out->remove, pdu, octets);
}

static size_t encode_remove_entity(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_remove_entity(out, capacity, &pdu->remove);
}

static Status decode_start_resume(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_start_resume(&out->start, pdu, octets);
}

static size_t encode_start_resume(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_start_resume(out, capacity, &pdu->start);
}

static Status decode_stop_freeze(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_stop_freeze(&out->stop, pdu, octets);
}

static size_t encode_stop_freeze(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_stop_freeze(out, capacity, &pdu->stop);
}

static Status decode_data(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    return dis_decode_data(&out->data, pdu, octets);
}

static size_t encode_data(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return dis_encode_data(out, capacity, &pdu->data);
}

/* Types of IEEE 1278.1-2012, table of PDU types. Those with functions are decoded; of these, the lengths of those that
 * are acted upon are validated while iterating over a datagram, and a PDU that cannot be decoded is counted as dropped.
 * The lengths of the others are not validated. */
typedef struct PduType {
    const char *name;
    unsigned    least_octets; /* before variable records; 0: not acted upon */
    Status    (*decode)(DisPdu *out, const uint8_t *pdu, size_t octets); /* NULL: not decoded */
    size_t    (*encode)(uint8_t *out, size_t capacity, const DisPdu *pdu);
} PduType;

static const PduType pdu_type[256] = {
    [0] = {"Other"},
    [1] = {"Entity State", 144, decode_entity_state, encode_entity_state},
    [2] = {"Fire", 96, decode_fire, encode_fire},
    [3] = {"Detonation", 104, decode_detonation, encode_detonation},
    [4] = {"Collision"},
    [5] = {"Service Request"},
    [6] = {"Resupply Offer"},
    [7] = {"Resupply Received"},
    [8] = {"Resupply Cancel"},
    [9] = {"Repair Complete"},
    [10] = {"Repair Response"},
    [11] = {"Create Entity"},
    [12] = {"Remove Entity", 28, decode_remove_entity, encode_remove_entity},
    [13] = {"Start/Resume", 44, decode_start_resume, encode_start_resume},
    [14] = {"Stop/Freeze", 40, decode_stop_freeze, encode_stop_freeze},
    [15] = {"Acknowledge"},
    [16] = {"Action Request"},
    [17] = {"Action Response"},
    [18] = {"Data Query"},
    [19] = {"Set Data", 0, decode_data, encode_data},
    [20] = {"Data", 0, decode_data, encode_data},
    [21] = {"Event Report"},
    [22] = {"Comment"},
    [23] = {"Electromagnetic Emission"},
    [24] = {"Designator"},
    [25] = {"Transmitter"},
    [26] = {"Signal"},
    [27] = {"Receiver"},
    [28] = {"IFF"},
    [29] = {"Underwater Acoustic"},
    [30] = {"Supplemental Emission/Entity State"},
    [31] = {"Intercom Signal"},
    [32] = {"Intercom Control"},
    [33] = {"Aggregate State"},
    [34] = {"IsGroupOf"},
    [35] = {"Transfer Ownership"},
    [36] = {"IsPartOf"},
    [37] = {"Minefield State"},
    [38] = {"Minefield Query"},
    [39] = {"Minefield Data"},
    [40] = {"Minefield Response NACK"},
    [41] = {"Environmental Process"},
    [42] = {"Gridded Data"},
    [43] = {"Point Object State"},
    [44] = {"Linear Object State"},
    [45] = {"Areal Object State"},
    [46] = {"TSPI"},
    [47] = {"Appearance"},
    [48] = {"Articulated Parts"},
    [49] = {"LE Fire"},
    [50] = {"LE Detonation"},
    [51] = {"Create Entity-R"},
    [52] = {"Remove Entity-R", 32, decode_remove_entity, encode_remove_entity},
    [53] = {"Start/Resume-R", 48, decode_start_resume, encode_start_resume},
    [54] = {"Stop/Freeze-R", 40, decode_stop_freeze, encode_stop_freeze},
    [55] = {"Acknowledge-R"},
    [56] = {"Action Request-R"},
    [57] = {"Action Response-R"},
    [58] = {"Data Query-R"},
    [59] = {"Set Data-R"},
    [60] = {"Data-R"},
    [61] = {"Event Report-R"},
    [62] = {"Comment-R"},
    [63] = {"Record-R"},
    [64] = {"Set Record-R"},
    [65] = {"Record Query-R"},
    [66] = {"Collision-Elastic"},
    [67] = {"Entity State Update", 72, decode_entity_state_update, encode_entity_state_update},
    [68] = {"Directed Energy Fire"},
    [69] = {"Entity Damage Status"},
    [70] = {"Information Operations Action"},
    [71] = {"Information Operations Report"},
    [72] = {"Attribute"},
};

const char *dis_pdu_type_name(uint8_t type) { return pdu_type[type].name ? pdu_type[type].name : "unknown type"; }

unsigned dis_least_octets(uint8_t type)
{
    return pdu_type[type].least_octets ? pdu_type[type].least_octets : dis_header_octets;
}

size_t dis_whole_octets(const uint8_t *pdu, size_t octets)
{
    static const struct {
        uint8_t type, count_at; /* where the number of variable records is */
    } counted[] = {{dis_pdu_entity_state, 19}, {dis_pdu_entity_state_update, 19}, {dis_pdu_detonation, 101}};
    enum { record_octets = 16 };
    if (octets < dis_header_octets) return 0;
    const uint8_t  type = dis_load_header(pdu).type;
    const unsigned least = pdu_type[type].least_octets;
    if (least == 0 || least > octets) return 0;
    for (size_t i = 0; i < sizeof counted / sizeof counted[0]; i++)
        if (counted[i].type == type) return least + record_octets * (size_t)pdu[counted[i].count_at];
    return least;
}

Status dis_decode(DisPdu *out, const uint8_t *pdu, size_t octets)
{
    if (octets < dis_header_octets) return STATUS_TRUNCATED;
    const uint8_t type = dis_load_header(pdu).type;
    if (!pdu_type[type].decode) return STATUS_UNSUPPORTED;
    const Status status = pdu_type[type].decode(out, pdu, octets);
    if (status == STATUS_OK) out->type = type;
    return status;
}

size_t dis_encode(uint8_t *out, size_t capacity, const DisPdu *pdu)
{
    return pdu_type[pdu->type].encode ? pdu_type[pdu->type].encode(out, capacity, pdu) : 0;
}

void dis_count_refused(DisCounters *counters, uint8_t type, Status status)
{
    if (!pdu_type[type].least_octets) return;
    if (status == STATUS_BAD_VALUE) counters->dropped[DIS_DROP_BAD_COUNT]++;
    else if (status == STATUS_TRUNCATED) counters->dropped[DIS_DROP_TRUNCATED]++;
}
