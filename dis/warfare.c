/* dis/warfare.c: Fire and Detonation, field by field in the order of IEEE 1278.1. */
#include "dis/warfare_private.h"

#include "dis/entity_state_private.h"
#include "dis/reader.h"

enum { fire_octets = 96, detonation_octets = 104 };

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

/* Version 7 gives warhead .. rate another meaning for expendables and explosions that are no munition (status
 * octet); the places and sizes are the same, so the octets come through either way. */
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

    const uint8_t *records = dis_take(&r, (size_t)d.variable_count * dis_variable_parameter_octets);
    if (!records) return STATUS_BAD_VALUE;
    memcpy(out, &d, offsetof(DisDetonation, variable)); /* 255 unused records stay where they are */
    dis_load_variable_parameters(out->variable, records, d.variable_count);
    return STATUS_OK;
}

size_t dis_encode_detonation(uint8_t *out, size_t capacity, const DisDetonation *pdu)
{
    const size_t length = detonation_octets + (size_t)pdu->variable_count * dis_variable_parameter_octets;
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
    dis_store_variable_parameters(out + detonation_octets, pdu->variable, pdu->variable_count);
    return length;
}
