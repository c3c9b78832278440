/* dis/warfare.h: Fire (type 2) and Detonation (type 3). */
#ifndef DIS_WARFARE_H
#define DIS_WARFARE_H

#include "dis/entity_state.h"

enum { dis_result_entity_impact = 1, dis_result_entity_proximate = 2, dis_result_ground_impact = 3,
       dis_result_detonation = 5, dis_result_none = 6 };

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
    float         range_m; /* 0 = unknown */
} DisFire;

typedef struct DisDetonation {
    DisHeader     header;
    DisEntityId   firing, target, munition; /* target 0:0:0: none */
    DisEventId    event;
    float         velocity_mps[3];
    double        p_ecef[3];
    DisDescriptor descriptor;
    float         p_target_m[3]; /* where on the target, its body axes */
    uint8_t       result;
    uint8_t       variable_count;
    uint8_t       padding[2];
    DisVariableParameter variable[dis_max_variable_parameters];
} DisDetonation;

size_t dis_encode_fire(uint8_t *out, size_t capacity, const DisFire *pdu);
size_t dis_encode_detonation(uint8_t *out, size_t capacity, const DisDetonation *pdu);

#endif
