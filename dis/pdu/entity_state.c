/* dis/pdu/entity_state.c: Entity State, Entity State Update, Fire and Detonation, by the offsets of IEEE 1278.1. */

#include "dis/pdu/decode.h"
#include "dis/pdu/octets.h"

enum { entity_state_octets = 144, entity_state_update_octets = 72, fire_octets = 96, detonation_octets = 104 };

/* ---- variable parameter records ------------------------------------------------------------- */

enum { variable_parameter_octets = 16 };

/* count records of 16 octets each; the caller has checked that they are there. */
static void load_variable_parameters(DisVariableParameter *out, const uint8_t *records, int count)
{
    for (int i = 0; i < count; i++, records += variable_parameter_octets) {
        DisVariableParameter *v = &out[i];
        *v = (DisVariableParameter){.record_type = records[0]};
        memcpy(v->octets, records, sizeof v->octets);
        if (v->record_type != dis_variable_articulated && v->record_type != dis_variable_attached) continue;
        v->change = records[1];
        v->attached_to = dis_load_u16(records + 2);
        v->parameter = dis_load_u32(records + 4);
        if (v->record_type == dis_variable_articulated) v->value = dis_load_f32(records + 8);
        else v->type = dis_load_entity_type(records + 8);
    }
}

static void store_variable_parameters(uint8_t *records, const DisVariableParameter *from, int count)
{
    for (int i = 0; i < count; i++, records += variable_parameter_octets) {
        const DisVariableParameter *v = &from[i];
        memcpy(records, v->octets, sizeof v->octets);
        records[0] = v->record_type;
        if (v->record_type != dis_variable_articulated && v->record_type != dis_variable_attached) continue;
        records[1] = v->change;
        dis_store_u16(records + 2, v->attached_to);
        dis_store_u32(records + 4, v->parameter);
        if (v->record_type == dis_variable_articulated) dis_store_f32(records + 8, &v->value);
        else dis_store_entity_type(records + 8, v->type);
    }
}

/* ---- Entity State ---------------------------------------------------------------------------- */

/* Octets beyond the records that variable_count announces are ignored (and so not written again): no such
 * PDU occurs in the 1354 recorded ones this was checked on. */
Status dis_decode_entity_state(DisEntityState *out, const uint8_t *pdu, size_t octets)
{
    DisReader      r = dis_pdu_reader(pdu, octets);
    const uint8_t *p = dis_take(&r, entity_state_octets);
    if (!p) return STATUS_TRUNCATED;
    const int      count = p[19];
    const uint8_t *records = dis_take(&r, (size_t)count * variable_parameter_octets);
    if (!records) return STATUS_BAD_VALUE;

    out->header = dis_load_header(p);
    out->id = dis_load_entity_id(p + 12);
    out->force = p[18];
    out->variable_count = p[19];
    out->type = dis_load_entity_type(p + 20);
    out->alternative_type = dis_load_entity_type(p + 28);
    for (int i = 0; i < 3; i++) out->velocity_mps[i] = dis_load_f32(p + 36 + 4 * i);
    for (int i = 0; i < 3; i++) out->p_ecef[i] = dis_load_f64(p + 48 + 8 * i);
    out->psi_rad = dis_load_f32(p + 72);
    out->theta_rad = dis_load_f32(p + 76);
    out->phi_rad = dis_load_f32(p + 80);
    out->appearance = dis_load_u32(p + 84);
    out->dead_reckoning = p[88];
    memcpy(out->dead_reckoning_other, p + 89, sizeof out->dead_reckoning_other);
    for (int i = 0; i < 3; i++) out->acceleration_mps2[i] = dis_load_f32(p + 104 + 4 * i);
    for (int i = 0; i < 3; i++) out->angular_rate_rps[i] = dis_load_f32(p + 116 + 4 * i);
    out->marking_set = p[128];
    memcpy(out->marking, p + 129, sizeof out->marking);
    out->capabilities = dis_load_u32(p + 140);
    if (count) load_variable_parameters(out->variable, records, count);
    return STATUS_OK;
}

size_t dis_encode_entity_state(uint8_t *out, size_t capacity, const DisEntityState *pdu)
{
    const size_t length = entity_state_octets + (size_t)pdu->variable_count * variable_parameter_octets;
    if (capacity < length) return 0;

    dis_store_header(out, &pdu->header, length);
    dis_store_entity_id(out + 12, pdu->id);
    out[18] = pdu->force;
    out[19] = pdu->variable_count;
    dis_store_entity_type(out + 20, pdu->type);
    dis_store_entity_type(out + 28, pdu->alternative_type);
    for (int i = 0; i < 3; i++) dis_store_f32(out + 36 + 4 * i, &pdu->velocity_mps[i]);
    for (int i = 0; i < 3; i++) dis_store_f64(out + 48 + 8 * i, &pdu->p_ecef[i]);
    dis_store_f32(out + 72, &pdu->psi_rad);
    dis_store_f32(out + 76, &pdu->theta_rad);
    dis_store_f32(out + 80, &pdu->phi_rad);
    dis_store_u32(out + 84, pdu->appearance);
    out[88] = pdu->dead_reckoning;
    memcpy(out + 89, pdu->dead_reckoning_other, sizeof pdu->dead_reckoning_other);
    for (int i = 0; i < 3; i++) dis_store_f32(out + 104 + 4 * i, &pdu->acceleration_mps2[i]);
    for (int i = 0; i < 3; i++) dis_store_f32(out + 116 + 4 * i, &pdu->angular_rate_rps[i]);
    out[128] = pdu->marking_set;
    memcpy(out + 129, pdu->marking, sizeof pdu->marking);
    dis_store_u32(out + 140, pdu->capabilities);
    store_variable_parameters(out + entity_state_octets, pdu->variable, pdu->variable_count);
    return length;
}

/* ---- Entity State Update ----------------------------------------------------------------------- */

Status dis_decode_entity_state_update(DisEntityStateUpdate *out, const uint8_t *pdu, size_t octets)
{
    DisReader      r = dis_pdu_reader(pdu, octets);
    const uint8_t *p = dis_take(&r, entity_state_update_octets);
    if (!p) return STATUS_TRUNCATED;
    const int      count = p[19];
    const uint8_t *records = dis_take(&r, (size_t)count * variable_parameter_octets);
    if (!records) return STATUS_BAD_VALUE;

    out->header = dis_load_header(p);
    out->id = dis_load_entity_id(p + 12);
    out->padding = p[18];
    out->variable_count = p[19];
    for (int i = 0; i < 3; i++) out->velocity_mps[i] = dis_load_f32(p + 20 + 4 * i);
    for (int i = 0; i < 3; i++) out->p_ecef[i] = dis_load_f64(p + 32 + 8 * i);
    out->psi_rad = dis_load_f32(p + 56);
    out->theta_rad = dis_load_f32(p + 60);
    out->phi_rad = dis_load_f32(p + 64);
    out->appearance = dis_load_u32(p + 68);
    load_variable_parameters(out->variable, records, count);
    return STATUS_OK;
}

size_t dis_encode_entity_state_update(uint8_t *out, size_t capacity, const DisEntityStateUpdate *pdu)
{
    const size_t length = entity_state_update_octets + (size_t)pdu->variable_count * variable_parameter_octets;
    if (capacity < length) return 0;

    dis_store_header(out, &pdu->header, length);
    dis_store_entity_id(out + 12, pdu->id);
    out[18] = pdu->padding;
    out[19] = pdu->variable_count;
    for (int i = 0; i < 3; i++) dis_store_f32(out + 20 + 4 * i, &pdu->velocity_mps[i]);
    for (int i = 0; i < 3; i++) dis_store_f64(out + 32 + 8 * i, &pdu->p_ecef[i]);
    dis_store_f32(out + 56, &pdu->psi_rad);
    dis_store_f32(out + 60, &pdu->theta_rad);
    dis_store_f32(out + 64, &pdu->phi_rad);
    dis_store_u32(out + 68, pdu->appearance);
    store_variable_parameters(out + entity_state_update_octets, pdu->variable, pdu->variable_count);
    return length;
}

/* ---- fit for geodesy ----------------------------------------------------------------------------- */

/* In the entity number 0, 0xFFFE and 0xFFFF mean no entity, a request for an id, and all entities. Site and application
 * may be 0: unconfigured senders send that, and their entities are valid. */
static bool names_one_entity(DisEntityId id)
{
    return id.entity != 0 && id.entity < 0xFFFE && id.site != 0xFFFF && id.application != 0xFFFF;
}

bool dis_entity_is_usable(DisDrop *why, DisEntityId id, const double p_ecef[3], const float velocity_mps[3],
                          const float euler_rad[3])
{
    static const double nearest_m = 1e5, farthest_m = 1e8;

    if (!names_one_entity(id)) {
        *why = DIS_DROP_NO_IDENTITY;
        return false;
    }
    for (int i = 0; i < 3; i++) {
        if (!isfinite(p_ecef[i]) || !isfinite(velocity_mps[i]) || !isfinite(euler_rad[i])) {
            *why = DIS_DROP_NOT_FINITE;
            return false;
        }
    }
    const double r_m = v3_length(p_ecef); /* r_m may be infinite for finite components; then it is too far as well */
    if (!(r_m >= nearest_m && r_m <= farthest_m)) {
        *why = DIS_DROP_BAD_POSITION;
        return false;
    }
    return true;
}

/* ---- Fire and Detonation -------------------------------------------------------------------- */

static DisEventId read_event_id(DisReader *r)
{
    DisEventId event;
    event.site = dis_read_u16(r);
    event.application = dis_read_u16(r);
    event.number = dis_read_u16(r);
    return event;
}

static void write_event_id(DisWriter *w, DisEventId event)
{
    dis_write_u16(w, event.site);
    dis_write_u16(w, event.application);
    dis_write_u16(w, event.number);
}

/* Version 7 gives the fields from warhead to rate another meaning for expendables and for explosions without a munition
 * (status octet). Their places and sizes are the same, so the octets are kept either way. */
static DisDescriptor read_descriptor(DisReader *r)
{
    DisDescriptor d;
    d.type = dis_read_entity_type(r);
    d.warhead = dis_read_u16(r);
    d.fuse = dis_read_u16(r);
    d.quantity = dis_read_u16(r);
    d.rate = dis_read_u16(r);
    return d;
}

static void write_descriptor(DisWriter *w, const DisDescriptor *d)
{
    dis_write_entity_type(w, d->type);
    dis_write_u16(w, d->warhead);
    dis_write_u16(w, d->fuse);
    dis_write_u16(w, d->quantity);
    dis_write_u16(w, d->rate);
}

Status dis_decode_fire(DisFire *out, const uint8_t *pdu, size_t octets)
{
    DisReader r = dis_pdu_reader(pdu, octets);
    DisFire   fire;
    fire.header = dis_read_header(&r);
    fire.firing = dis_read_entity_id(&r);
    fire.target = dis_read_entity_id(&r);
    fire.munition = dis_read_entity_id(&r);
    fire.event = read_event_id(&r);
    fire.fire_mission = dis_read_u32(&r);
    dis_read_f64(fire.p_ecef, &r, 3);
    fire.descriptor = read_descriptor(&r);
    dis_read_f32(fire.velocity_mps, &r, 3);
    dis_read_f32(&fire.range_m, &r, 1);
    if (r.truncated) return STATUS_TRUNCATED;
    *out = fire;
    return STATUS_OK;
}

size_t dis_encode_fire(uint8_t *out, size_t capacity, const DisFire *pdu)
{
    if (capacity < fire_octets) return 0;
    DisWriter w = {out, out + fire_octets, false};
    dis_write_header(&w, &pdu->header, fire_octets);
    dis_write_entity_id(&w, pdu->firing);
    dis_write_entity_id(&w, pdu->target);
    dis_write_entity_id(&w, pdu->munition);
    write_event_id(&w, pdu->event);
    dis_write_u32(&w, pdu->fire_mission);
    dis_write_f64(&w, pdu->p_ecef, 3);
    write_descriptor(&w, &pdu->descriptor);
    dis_write_f32(&w, pdu->velocity_mps, 3);
    dis_write_f32(&w, &pdu->range_m, 1);
    return fire_octets;
}

Status dis_decode_detonation(DisDetonation *out, const uint8_t *pdu, size_t octets)
{
    DisReader     r = dis_pdu_reader(pdu, octets);
    DisDetonation d;
    d.header = dis_read_header(&r);
    d.firing = dis_read_entity_id(&r);
    d.target = dis_read_entity_id(&r);
    d.munition = dis_read_entity_id(&r);
    d.event = read_event_id(&r);
    dis_read_f32(d.velocity_mps, &r, 3);
    dis_read_f64(d.p_ecef, &r, 3);
    d.descriptor = read_descriptor(&r);
    dis_read_f32(d.p_target_m, &r, 3);
    d.result = dis_read_u8(&r);
    d.variable_count = dis_read_u8(&r);
    dis_read_octets(d.padding, &r, sizeof d.padding);
    if (r.truncated) return STATUS_TRUNCATED;

    const uint8_t *records = dis_take(&r, (size_t)d.variable_count * variable_parameter_octets);
    if (!records) return STATUS_BAD_VALUE;
    memcpy(out, &d, offsetof(DisDetonation, variable)); /* copies without the unused ones of the 255 records */
    load_variable_parameters(out->variable, records, d.variable_count);
    return STATUS_OK;
}

size_t dis_encode_detonation(uint8_t *out, size_t capacity, const DisDetonation *pdu)
{
    const size_t length = detonation_octets + (size_t)pdu->variable_count * variable_parameter_octets;
    if (capacity < length) return 0;
    DisWriter w = {out, out + detonation_octets, false};
    dis_write_header(&w, &pdu->header, length);
    dis_write_entity_id(&w, pdu->firing);
    dis_write_entity_id(&w, pdu->target);
    dis_write_entity_id(&w, pdu->munition);
    write_event_id(&w, pdu->event);
    dis_write_f32(&w, pdu->velocity_mps, 3);
    dis_write_f64(&w, pdu->p_ecef, 3);
    write_descriptor(&w, &pdu->descriptor);
    dis_write_f32(&w, pdu->p_target_m, 3);
    dis_write_u8(&w, pdu->result);
    dis_write_u8(&w, pdu->variable_count);
    dis_write_octets(&w, pdu->padding, sizeof pdu->padding);
    store_variable_parameters(out + detonation_octets, pdu->variable, pdu->variable_count);
    return length;
}
