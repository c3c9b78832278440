/* entities/scenario/exercise_bad.c: one malformed datagram of each kind, in turn. Every one must be dropped and
 * counted, or accepted where valid; none may affect the others. */
#include "entities/scenario/exercise.h"

static uint8_t random_octet(const Cast *cast, double t_s, size_t at)
{
    return (uint8_t)(256 * random_uniform((uint64_t)cast->scenario->seed, 9, (uint32_t)(t_s * 60), at));
}

void exercise_send_bad(ExerciseLink *link, const Cast *cast, DisEntityState *es, int kind, double t_s)
{
    uint8_t    bytes[8192];
    Kinematics k;
    if (cast->entity_count == 0) return;
    cast_kinematics(&k, cast, 0, t_s);
    /* those that are valid drive beside the first entity, not inside it */
    const double right[3] = {k.r_ecef_from_body[1], k.r_ecef_from_body[4], k.r_ecef_from_body[7]};
    v3_add_scaled(k.p_ecef, k.p_ecef, kind == 5 ? 25 : -25, right);
    exercise_fill_state(es, link, cast, 0, &k, 0, t_s);
    es->id.entity = (uint16_t)(64900 + kind);
    switch (kind) {
    case 1: es->p_ecef[1] = NAN; break;
    case 2: memset(es->p_ecef, 0, sizeof es->p_ecef); break;
    case 3: es->velocity_mps[2] = INFINITY; break;
    case 4: es->psi_rad = NAN; break;
    case 5: /* an unassigned type, and a hostile marking */
        es->type = (DisEntityType){9, 9, 999, 99, 9, 9, 9};
        memcpy(es->marking, "\x01\xff\x80<b>\n\r\t\"'", 11);
        break;
    case 7: es->id = (DisEntityId){65535, 65535, 65535}; break;
    case 8: { /* joints with extreme and non-finite values */
        static const float value[4] = {NAN, INFINITY, -1e30f, 0};
        es->variable_count = 4;
        for (int i = 0; i < 4; i++)
            es->variable[i] = (DisVariableParameter){
                .record_type = dis_variable_articulated, .attached_to = (uint16_t)(i / 2), .value = value[i],
                .parameter = i < 2 ? 4107u + (unsigned)i : 4427u + (unsigned)i};
        break;
    }
    }
    size_t count = dis_encode_entity_state(bytes, sizeof bytes, es);
    switch (kind) {
    case 0: bytes[8] = bytes[9] = 0; break;            /* length field 0 */
    case 6: bytes[0] = 42; break;
    case 9: count = 100; break;                        /* truncated */
    case 10: bytes[19] = 255; break;                   /* more parts than the table holds */
    case 11: bytes[2] = 200; break;                    /* an unknown type */
    case 12:                                           /* noise */
        for (size_t i = 0; i < count; i++) bytes[i] = random_octet(cast, t_s, i);
        break;
    case 13: count = random_octet(cast, t_s, 0) % 7; break; /* 0 .. 6 octets */
    }
    link->counts.malformed++;
    link_datagram(link, t_s, bytes, count);
}
