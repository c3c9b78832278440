/* dis/pdu/pdu.h: common to all PDUs: identifiers, types, enumerations, the header, counters.
 *
 * Wire facts: IEEE 1278.1-1995 (version 5), 1278.1A-1998 (6), 1278.1-2012 (7). Structs are plain and keep
 * every octet, padding too, so that decode and encode are exact inverses. */
#ifndef DIS_PDU_PDU_H
#define DIS_PDU_PDU_H

#include "pitviper.h"

enum {
    dis_pdu_entity_state = 1,
    dis_pdu_fire = 2,
    dis_pdu_detonation = 3,
    dis_pdu_remove_entity = 12,
    dis_pdu_start_resume = 13,
    dis_pdu_stop_freeze = 14,
    dis_pdu_remove_entity_r = 52, /* the family with reliability has the same layout and one more octet */
    dis_pdu_start_resume_r = 53,
    dis_pdu_stop_freeze_r = 54,
    dis_pdu_entity_state_update = 67,
    dis_header_octets = 12,
    dis_port = 3000,
    dis_max_variable_parameters = 255,
};

typedef struct DisEntityId {
    uint16_t site, application, entity;
} DisEntityId;

typedef struct DisEntityType {
    uint8_t  kind, domain;
    uint16_t country;
    uint8_t  category, subcategory, specific, extra;
} DisEntityType;

typedef struct DisEventId {
    uint16_t site, application, number;
} DisEventId;

typedef struct DisHeader {
    uint8_t  version; /* 5, 6 or 7 */
    uint8_t  exercise, type, family;
    uint32_t timestamp; /* raw; see exercise_clock.h */
    uint16_t length;    /* octets, header included */
    uint8_t  status;    /* meaningful in version 7 only; a padding octet before, kept as read */
    uint8_t  padding;
} DisHeader;

/* Order of ids everywhere in the program: site, application, entity. <0, 0, >0 like memcmp. */
int  dis_entity_id_compare(DisEntityId a, DisEntityId b);
bool dis_entity_id_is_none(DisEntityId id); /* 0:0:0 */
/* `site:application:entity` and `kind.domain.country.category.subcategory.specific.extra`. */
enum { dis_id_text_size = 20, dis_type_text_size = 32 };
void dis_entity_id_text(char out[dis_id_text_size], DisEntityId id);
bool dis_entity_id_parse(DisEntityId *out, const char *text);
void dis_entity_type_text(char out[dis_type_text_size], DisEntityType type);

/* Why bytes were dropped. Names appear in run.json. */
typedef enum DisDrop {
    DIS_DROP_SHORT_HEADER,     /* fewer than 12 octets left */
    DIS_DROP_BAD_VERSION,      /* not 5, 6 or 7 */
    DIS_DROP_LENGTH_ZERO,      /* the length field is 0, and the datagram's own length does not tell the PDU's */
    DIS_DROP_LENGTH_TOO_SHORT, /* length field below 12, or below what its type needs */
    DIS_DROP_LENGTH_TOO_LONG,  /* length field beyond the datagram */
    DIS_DROP_TRUNCATED,        /* the record ends before its fields do */
    DIS_DROP_BAD_COUNT,        /* a count that the length cannot hold */
    DIS_DROP_NOT_FINITE,       /* NaN or infinity in a kinematic field */
    DIS_DROP_BAD_POSITION,     /* finite, but not a place near the Earth: the centre, beyond 1e8 m */
    DIS_DROP_NO_IDENTITY,      /* the id has 0, 0xFFFF or 0xFFFE where it must name one entity */
    DIS_DROP_OTHER_EXERCISE,   /* filtered by exercise id */
    DIS_DROP_TABLE_FULL,       /* the entity table refused a new entity */
    DIS_DROP_COUNT
} DisDrop;

const char *dis_drop_name(DisDrop drop);
const char *dis_drop_cause(DisDrop drop); /* a few words for people: `a length field of 0` */

typedef struct DisCounters {
    uint64_t datagrams;
    uint64_t pdus[256]; /* well-formed headers, counted by type */
    uint64_t dropped[DIS_DROP_COUNT];
    uint64_t lengths_made; /* PDUs with a length field of 0, whose length was found from their type and the datagram */
    uint64_t padded;       /* runs of zeros behind a PDU, passed over */
    uint64_t stamps_doubted; /* PDUs that are timed by their arrival although they are stamped: exercise_clock.h */
} DisCounters;

/* ---- arrival times ------------------------------------------------------------------------------- */

/* Unix time, whole nanoseconds >= 0 -> seconds: the only conversion, so that a node that receives a datagram live and
 * one that reads it from a recording get the same double. Never decreasing; neighbours within 0.24 us may become
 * equal. */
static inline double dis_unix_s(int64_t unix_ns)
{
    return (double)(unix_ns / 1000000000) + 1e-9 * (double)(unix_ns % 1000000000);
}

/* The last nanosecond for which dis_unix_s is not after unix_s; -1: unix_s is before 1970. Times beyond 9e9 s (2255)
 * count as 9e9 s. */
int64_t dis_unix_ns_until(double unix_s);

/* ---- enumerations --------------------------------------------------------------------------- */

/* The values of SISO-REF-010 that Pitviper uses. */

enum {
    dis_kind_platform = 1,
    dis_kind_munition = 2,
    dis_kind_life_form = 3,
    dis_kind_cultural_feature = 5,
    dis_kind_supply = 6,
    dis_kind_expendable = 8,
    dis_kind_sensor_emitter = 9
};
enum {
    dis_munition_guided = 1,
    dis_munition_fixed = 3
}; /* values of a munition's category; 2 is ballistic; fixed ones are mines */
enum {
    dis_domain_land = 1,
    dis_domain_air = 2,
    dis_domain_surface = 3,
    dis_domain_subsurface = 4,
    dis_domain_space = 5
};

/* Appearance: bits that platforms of every domain share, and those of land platforms. */
enum {
    dis_appearance_damage_shift = 3, /* two bits; 3: destroyed */
    dis_appearance_smoke_shift = 5,  /* two bits; 1: plume, 2: engine smoke, 3: both */
    dis_appearance_trail_shift = 7,  /* two bits; 0: none .. 3: large; dust, contrail or motor smoke by domain */
    dis_appearance_flaming_bit = 15,
    dis_appearance_afterburner_bit = 16, /* air platforms */
    dis_appearance_frozen_bit = 21,
    dis_appearance_power_plant_bit = 22,
    dis_appearance_deactivated_bit = 23,
};
enum { dis_damage_destroyed = 3 };

#endif
