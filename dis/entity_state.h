/* dis/entity_state.h: Entity State (type 1) and Entity State Update (type 67). */
#ifndef DIS_ENTITY_STATE_H
#define DIS_ENTITY_STATE_H

#include "dis/pdu.h"

enum { dis_variable_articulated = 0, dis_variable_attached = 1 };

/* One 16-octet record. Records other than articulated and attached are kept in `octets` alone. */
typedef struct DisVariableParameter {
    uint8_t  record_type;
    uint8_t  change;      /* articulated: change indicator; attached: 1 = detached */
    uint16_t attached_to; /* 0 = hull, else the ordinal of a part in this PDU */
    uint32_t parameter;   /* articulated: class (multiple of 32) + metric (1 .. 16); attached: station */
    float    value;       /* articulated: metres, radians, or per second; may be NaN on the wire */
    DisEntityType type;   /* attached: what hangs there */
    uint8_t  octets[16];  /* as on the wire; the encoder starts from these */
} DisVariableParameter;

typedef struct DisEntityState {
    DisHeader     header;
    DisEntityId   id;
    uint8_t       force;
    uint8_t       variable_count;
    DisEntityType type, alternative_type;
    float         velocity_mps[3];      /* world axes for dead reckoning 1..5, body axes for 6..9 */
    double        p_ecef[3];
    float         psi_rad, theta_rad, phi_rad; /* geocentric Euler angles */
    uint32_t      appearance;
    uint8_t       dead_reckoning;       /* algorithm */
    uint8_t       dead_reckoning_other[15];
    float         acceleration_mps2[3]; /* axes as velocity */
    float         angular_rate_rps[3];  /* body axes always */
    uint8_t       marking_set;
    char          marking[11];          /* any bytes, not terminated */
    uint32_t      capabilities;
    DisVariableParameter variable[dis_max_variable_parameters]; /* [variable_count] */
} DisEntityState;

typedef struct DisEntityStateUpdate {
    DisHeader   header;
    DisEntityId id;
    uint8_t     padding, variable_count;
    float       velocity_mps[3];
    double      p_ecef[3];
    float       psi_rad, theta_rad, phi_rad;
    uint32_t    appearance;
    DisVariableParameter variable[dis_max_variable_parameters];
} DisEntityStateUpdate;

/* Decoding: decode.h. These write header.length as computed and return the octets written; 0: capacity is too small. */
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

#endif
