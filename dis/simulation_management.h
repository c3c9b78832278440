/* dis/simulation_management.h: Remove Entity (12), Start/Resume (13), Stop/Freeze (14). */
#ifndef DIS_SIMULATION_MANAGEMENT_H
#define DIS_SIMULATION_MANAGEMENT_H

#include "dis/pdu.h"

typedef struct DisClockTime {
    uint32_t hour;      /* hours since 1970-01-01 00:00 UTC */
    uint32_t past_hour; /* as a time stamp: (x >> 1) * 3600 / 2^31 s */
} DisClockTime;

/* The family with reliability (types 52, 53, 54) shares these structs: header.type says which. reliability, and the
 * padding behind it, belong to it alone. */
typedef struct DisRemoveEntity {
    DisHeader   header;
    DisEntityId originating, receiving; /* receiving: the entity removed; 0xFFFF is a wildcard */
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

size_t dis_encode_remove_entity(uint8_t *out, size_t capacity, const DisRemoveEntity *pdu);
size_t dis_encode_start_resume(uint8_t *out, size_t capacity, const DisStartResume *pdu);
size_t dis_encode_stop_freeze(uint8_t *out, size_t capacity, const DisStopFreeze *pdu);

#endif
