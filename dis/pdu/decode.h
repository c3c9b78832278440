/* dis/pdu/decode.h: the PDUs that Pitviper reads and sends, as plain structs; decodes and encodes them, and iterates
 * over those of a datagram. */
#ifndef DIS_PDU_DECODE_H
#define DIS_PDU_DECODE_H

#include "dis/pdu/pdu.h"

/* ---- Entity State (type 1) and Entity State Update (67) ---------------------------------------- */

enum { dis_variable_articulated = 0, dis_variable_attached = 1 };

/* One 16-octet record. Records other than articulated and attached are kept in `octets` alone. */
typedef struct DisVariableParameter {
    uint8_t       record_type;
    uint8_t       change;      /* articulated: change indicator; attached: 1 = detached */
    uint16_t      attached_to; /* 0 = hull, else the ordinal of a part in this PDU */
    uint32_t      parameter;   /* articulated: class (multiple of 32) + metric (1 .. 16); attached: station */
    float         value;       /* articulated: metres, radians, or per second; may be NaN on the wire */
    DisEntityType type;        /* attached: what hangs there */
    uint8_t       octets[16];  /* the record as on the wire; the encoder starts from these octets */
} DisVariableParameter;

typedef struct DisEntityState {
    DisHeader            header;
    DisEntityId          id;
    uint8_t              force;
    uint8_t              variable_count;
    DisEntityType        type, alternative_type;
    float                velocity_mps[3]; /* world axes for dead reckoning 1..5, body axes for 6..9 */
    double               p_ecef[3];
    float                psi_rad, theta_rad, phi_rad; /* geocentric Euler angles */
    uint32_t             appearance;
    uint8_t              dead_reckoning; /* algorithm */
    uint8_t              dead_reckoning_other[15];
    float                acceleration_mps2[3]; /* axes as velocity */
    float                angular_rate_rps[3];  /* body axes always */
    uint8_t              marking_set;
    char                 marking[11]; /* any bytes, not terminated */
    uint32_t             capabilities;
    DisVariableParameter variable[dis_max_variable_parameters]; /* [variable_count] */
} DisEntityState;

typedef struct DisEntityStateUpdate {
    DisHeader            header;
    DisEntityId          id;
    uint8_t              padding, variable_count;
    float                velocity_mps[3];
    double               p_ecef[3];
    float                psi_rad, theta_rad, phi_rad;
    uint32_t             appearance;
    DisVariableParameter variable[dis_max_variable_parameters];
} DisEntityStateUpdate;

/* The decoders and encoders of single types. Decoders as dis_decode; encoders write header.length as computed and
 * return the octets written; 0: capacity is too small. */
Status dis_decode_entity_state(DisEntityState *out, const uint8_t *pdu, size_t octets);
Status dis_decode_entity_state_update(DisEntityStateUpdate *out, const uint8_t *pdu, size_t octets);
size_t dis_encode_entity_state(uint8_t *out, size_t capacity, const DisEntityState *pdu);
size_t dis_encode_entity_state_update(uint8_t *out, size_t capacity, const DisEntityStateUpdate *pdu);

/* Whether id, position, attitude and motion are fit for geodesy: false and the reason otherwise.
 * Near the Earth: 1e5 m .. 1e8 m from its centre. Velocity, acceleration, rates: finite. */
bool dis_entity_is_usable(DisDrop *why, DisEntityId id, const double p_ecef[3], const float velocity_mps[3],
                          const float euler_rad[3]);
static inline bool dis_entity_state_is_usable(DisDrop *why, const DisEntityState *pdu)
{
    const float euler_rad[3] = {pdu->psi_rad, pdu->theta_rad, pdu->phi_rad};
    return dis_entity_is_usable(why, pdu->id, pdu->p_ecef, pdu->velocity_mps, euler_rad);
}
static inline bool dis_entity_state_update_is_usable(DisDrop *why, const DisEntityStateUpdate *pdu)
{
    const float euler_rad[3] = {pdu->psi_rad, pdu->theta_rad, pdu->phi_rad};
    return dis_entity_is_usable(why, pdu->id, pdu->p_ecef, pdu->velocity_mps, euler_rad);
}

/* ---- Fire (type 2) and Detonation (3) ------------------------------------------------------- */

enum {
    dis_result_entity_impact = 1,
    dis_result_entity_proximate = 2,
    dis_result_ground_impact = 3,
    dis_result_detonation = 5,
    dis_result_none = 6
};

typedef struct DisDescriptor {
    DisEntityType type;
    uint16_t      warhead, fuse, quantity, rate;
} DisDescriptor;

typedef struct DisFire {
    DisHeader     header;
    DisEntityId   firing, target, munition;
    DisEventId    event;
    uint32_t      fire_mission;
    double        p_ecef[3];
    DisDescriptor descriptor;
    float         velocity_mps[3];
    float         range_m; /* 0: the range is unknown */
} DisFire;

typedef struct DisDetonation {
    DisHeader            header;
    DisEntityId          firing, target, munition; /* a target of 0:0:0 means none */
    DisEventId           event;
    float                velocity_mps[3];
    double               p_ecef[3];
    DisDescriptor        descriptor;
    float                p_target_m[3]; /* where the munition hit, in the target's body axes */
    uint8_t              result;
    uint8_t              variable_count;
    uint8_t              padding[2];
    DisVariableParameter variable[dis_max_variable_parameters];
} DisDetonation;

Status dis_decode_fire(DisFire *out, const uint8_t *pdu, size_t octets);
Status dis_decode_detonation(DisDetonation *out, const uint8_t *pdu, size_t octets);
size_t dis_encode_fire(uint8_t *out, size_t capacity, const DisFire *pdu);
size_t dis_encode_detonation(uint8_t *out, size_t capacity, const DisDetonation *pdu);

/* ---- Remove Entity (type 12), Start/Resume (13), Stop/Freeze (14) --------------------------- */

typedef struct DisClockTime {
    uint32_t hour;      /* hours since 1970-01-01 00:00 UTC */
    uint32_t past_hour; /* as a time stamp: (x >> 1) * 3600 / 2^31 s */
} DisClockTime;

/* The family with reliability (types 52, 53, 54) shares these structs: header.type says which. reliability, and the
 * padding behind it, belong to it alone. */
typedef struct DisRemoveEntity {
    DisHeader   header;
    DisEntityId originating, receiving; /* receiving: the entity that is removed; 0xFFFF is a wildcard */
    uint8_t     reliability, reliability_padding[3];
    uint32_t    request;
} DisRemoveEntity;

typedef struct DisStartResume {
    DisHeader    header;
    DisEntityId  originating, receiving;
    DisClockTime real_world, simulation;
    uint8_t      reliability, reliability_padding[3];
    uint32_t     request;
} DisStartResume;

typedef struct DisStopFreeze {
    DisHeader    header;
    DisEntityId  originating, receiving;
    DisClockTime real_world;
    uint8_t      reason, frozen_behaviour;
    uint8_t      padding[2]; /* with reliability: that octet, then padding */
    uint32_t     request;
} DisStopFreeze;

Status dis_decode_remove_entity(DisRemoveEntity *out, const uint8_t *pdu, size_t octets);
Status dis_decode_start_resume(DisStartResume *out, const uint8_t *pdu, size_t octets);
/* Whether Start/Resume or Stop/Freeze name an entity: they name a simulation, whose entity 0 is the application itself,
 * and so all that it simulates; 0xFFFF: any. */
static inline bool dis_simulation_names(DisEntityId named, DisEntityId is)
{
    const bool all = named.entity == 0xFFFF || (named.entity == 0 && named.site != 0);
    return (named.site == is.site || named.site == 0xFFFF) &&
           (named.application == is.application || named.application == 0xFFFF) && (all || named.entity == is.entity);
}
/* Whether those stopped go on transmitting updates: bit 1 of the frozen behaviour. */
static inline bool dis_stop_lets_report(const DisStopFreeze *pdu) { return pdu->frozen_behaviour >> 1 & 1; }
Status             dis_decode_stop_freeze(DisStopFreeze *out, const uint8_t *pdu, size_t octets);
size_t             dis_encode_remove_entity(uint8_t *out, size_t capacity, const DisRemoveEntity *pdu);
size_t             dis_encode_start_resume(uint8_t *out, size_t capacity, const DisStartResume *pdu);
size_t             dis_encode_stop_freeze(uint8_t *out, size_t capacity, const DisStopFreeze *pdu);

/* ---- Data (type 20) and Set Data (19) ------------------------------------------------------- */

/* Fixed and variable datums, to one entity or to all. IEEE 1278.1-1995 5.4.6.10. */

enum { dis_pdu_set_data = 19, dis_pdu_data = 20, dis_smallest_mtu = 1400 };

typedef struct DisFixedDatum {
    uint32_t id, value;
} DisFixedDatum;

typedef struct DisVariableDatum {
    uint32_t       id, bits;
    const uint8_t *value;   /* (bits + 7) / 8 octets; after reading it points into the PDU */
    const uint8_t *padding; /* octets behind the value, to the next multiple of 8; NULL: zeros; after reading it points
                               into the PDU */
} DisVariableDatum;

enum { dis_data_fixed_max = 64, dis_data_variable_max = 64 };

typedef struct DisData {
    DisHeader        header;
    DisEntityId      originating, receiving;
    uint32_t         request;
    uint32_t         padding;
    int              fixed_count, variable_count;
    DisFixedDatum    fixed[dis_data_fixed_max];
    DisVariableDatum variable[dis_data_variable_max];
} DisData;

Status dis_decode_data(DisData *out, const uint8_t *pdu, size_t octets);
/* Encodes Data, or Set Data, which has the same layout. Returns 0 where it does not fit into capacity, or into 65535
 * octets. */
size_t dis_encode_data(uint8_t *out, size_t capacity, const DisData *pdu);

/* ---- any PDU: a tagged union of the plain structs ---------------------------------------------- */

/* 11 KiB, most of it for 255 variable records: allocate one per loop, not one per PDU. */
typedef struct DisPdu {
    uint8_t type; /* which of these: dis_pdu_entity_state, ...; as in the header */
    union {
        DisHeader            header; /* first member of every struct */
        DisEntityState       entity_state;
        DisEntityStateUpdate update;
        DisFire              fire;
        DisDetonation        detonation;
        DisRemoveEntity      remove;
        DisStartResume       start;
        DisStopFreeze        stop;
        DisData              data; /* its values point into the PDU's octets */
    };
} DisPdu;

/* pdu: header.length octets from dis_next_pdu. On failure `out` is untouched; when it succeeds, variable records and
 * datums beyond the counted ones are unchanged. Values are not validated here: see dis_entity_is_usable.
 * STATUS_TRUNCATED: fewer octets than the header or the type needs, or than the length field gives (0: all octets).
 * STATUS_BAD_VALUE: a count that the length cannot hold.
 * STATUS_UNSUPPORTED: a type that is not decoded, or more datums than the output holds. */
Status dis_decode(DisPdu *out, const uint8_t *pdu, size_t octets);
/* Writes header.length as computed. Returns the octets written; 0: capacity is too small, or no such type. */
size_t dis_encode(uint8_t *out, size_t capacity, const DisPdu *pdu);
/* Counts, by reason, a PDU that dis_decode refused. A PDU of a type that is not acted upon is not counted as dropped.
 * */
void dis_count_refused(DisCounters *counters, uint8_t type, Status status);
/* `Entity State`, `Attribute`, ...; `unknown type` beyond 72. */
const char *dis_pdu_type_name(uint8_t type);

/* ---- the PDUs of a datagram -------------------------------------------------------------------- */

/* Next PDU of a datagram: *at advances by the length field. True and header/pdu set when there is one;
 * false at the end or at the first inconsistent length, which is counted. PDUs returned are counted by type.
 * Up to 7 zeros before a PDU or at the end are padding. A length field of 0 is replaced in header, and counted, where
 * the types and counts of the PDUs from there on end exactly with the datagram.
 *
 *     for (const uint8_t *at = bytes; dis_next_pdu(&header, &pdu, &at, bytes + count, counters);) ...
 *
 * pdu: header.length octets starting at the header, inside the datagram. */
bool dis_next_pdu(DisHeader *header, const uint8_t **pdu, const uint8_t **at, const uint8_t *end,
                  DisCounters *counters);

/* The sender of a PDU: every type of the standard names its site and application right after the header.
 * False, and out untouched, for a type outside it or one too short. */
bool dis_pdu_sender(uint16_t site_application[2], const DisHeader *header, const uint8_t *pdu);
/* The entity number that a PDU reports (Entity State, Entity State Update); -1: it is not a report. */
int dis_pdu_entity(const DisHeader *header, const uint8_t *pdu);

#endif
