/* dis/pdu/simulation_management.c: Remove Entity, Start/Resume, Stop/Freeze, and the same with reliability; Data and
 * Set Data. */

#include "dis/pdu/decode.h"
#include "dis/pdu/octets.h"

enum { remove_entity_octets = 28, start_resume_octets = 44, stop_freeze_octets = 40, reliability_octets = 4 };

static bool is_reliable(uint8_t type) { return type == dis_pdu_remove_entity_r || type == dis_pdu_start_resume_r; }

static void read_reliability(uint8_t *reliability, uint8_t padding[3], DisReader *r, uint8_t type)
{
    *reliability = 0;
    memset(padding, 0, 3);
    if (!is_reliable(type)) return;
    *reliability = dis_read_u8(r);
    dis_read_octets(padding, r, 3);
}

static void write_reliability(DisWriter *w, uint8_t reliability, const uint8_t padding[3], uint8_t type)
{
    if (!is_reliable(type)) return;
    dis_write_u8(w, reliability);
    dis_write_octets(w, padding, 3);
}

static DisClockTime read_clock_time(DisReader *r)
{
    DisClockTime time;
    time.hour = dis_read_u32(r);
    time.past_hour = dis_read_u32(r);
    return time;
}

static void write_clock_time(DisWriter *w, DisClockTime time)
{
    dis_write_u32(w, time.hour);
    dis_write_u32(w, time.past_hour);
}

Status dis_decode_remove_entity(DisRemoveEntity *out, const uint8_t *pdu, size_t octets)
{
    DisReader       r = dis_pdu_reader(pdu, octets);
    DisRemoveEntity remove;
    remove.header = dis_read_header(&r);
    remove.originating = dis_read_entity_id(&r);
    remove.receiving = dis_read_entity_id(&r);
    read_reliability(&remove.reliability, remove.reliability_padding, &r, remove.header.type);
    remove.request = dis_read_u32(&r);
    if (r.truncated) return STATUS_TRUNCATED;
    *out = remove;
    return STATUS_OK;
}

size_t dis_encode_remove_entity(uint8_t *out, size_t capacity, const DisRemoveEntity *pdu)
{
    const size_t octets = remove_entity_octets + (is_reliable(pdu->header.type) ? reliability_octets : 0);
    if (capacity < octets) return 0;
    DisWriter w = {out, out + octets, false};
    dis_write_header(&w, &pdu->header, octets);
    dis_write_entity_id(&w, pdu->originating);
    dis_write_entity_id(&w, pdu->receiving);
    write_reliability(&w, pdu->reliability, pdu->reliability_padding, pdu->header.type);
    dis_write_u32(&w, pdu->request);
    return octets;
}

Status dis_decode_start_resume(DisStartResume *out, const uint8_t *pdu, size_t octets)
{
    DisReader      r = dis_pdu_reader(pdu, octets);
    DisStartResume start;
    start.header = dis_read_header(&r);
    start.originating = dis_read_entity_id(&r);
    start.receiving = dis_read_entity_id(&r);
    start.real_world = read_clock_time(&r);
    start.simulation = read_clock_time(&r);
    read_reliability(&start.reliability, start.reliability_padding, &r, start.header.type);
    start.request = dis_read_u32(&r);
    if (r.truncated) return STATUS_TRUNCATED;
    *out = start;
    return STATUS_OK;
}

size_t dis_encode_start_resume(uint8_t *out, size_t capacity, const DisStartResume *pdu)
{
    const size_t octets = start_resume_octets + (is_reliable(pdu->header.type) ? reliability_octets : 0);
    if (capacity < octets) return 0;
    DisWriter w = {out, out + octets, false};
    dis_write_header(&w, &pdu->header, octets);
    dis_write_entity_id(&w, pdu->originating);
    dis_write_entity_id(&w, pdu->receiving);
    write_clock_time(&w, pdu->real_world);
    write_clock_time(&w, pdu->simulation);
    write_reliability(&w, pdu->reliability, pdu->reliability_padding, pdu->header.type);
    dis_write_u32(&w, pdu->request);
    return octets;
}

Status dis_decode_stop_freeze(DisStopFreeze *out, const uint8_t *pdu, size_t octets)
{
    DisReader     r = dis_pdu_reader(pdu, octets);
    DisStopFreeze stop;
    stop.header = dis_read_header(&r);
    stop.originating = dis_read_entity_id(&r);
    stop.receiving = dis_read_entity_id(&r);
    stop.real_world = read_clock_time(&r);
    stop.reason = dis_read_u8(&r);
    stop.frozen_behaviour = dis_read_u8(&r);
    dis_read_octets(stop.padding, &r, sizeof stop.padding);
    stop.request = dis_read_u32(&r);
    if (r.truncated) return STATUS_TRUNCATED;
    *out = stop;
    return STATUS_OK;
}

size_t dis_encode_stop_freeze(uint8_t *out, size_t capacity, const DisStopFreeze *pdu)
{
    if (capacity < stop_freeze_octets) return 0;
    DisWriter w = {out, out + stop_freeze_octets, false};
    dis_write_header(&w, &pdu->header, stop_freeze_octets);
    dis_write_entity_id(&w, pdu->originating);
    dis_write_entity_id(&w, pdu->receiving);
    write_clock_time(&w, pdu->real_world);
    dis_write_u8(&w, pdu->reason);
    dis_write_u8(&w, pdu->frozen_behaviour);
    dis_write_octets(&w, pdu->padding, sizeof pdu->padding);
    dis_write_u32(&w, pdu->request);
    return stop_freeze_octets;
}

/* ---- Data and Set Data ---------------------------------------------------------------------- */

enum { data_octets = 40, fixed_datum_octets = 8, variable_datum_octets = 8, alignment = 8 };

/* The length of a variable datum is in bits; its octets are followed by padding to 64 bits. */
static size_t value_octets(uint32_t bits) { return ((size_t)bits + 7) / 8; }
static size_t padding_octets(uint32_t bits) { return -value_octets(bits) & (alignment - 1); }

static void read_datums(DisData *data, DisReader *r)
{
    for (int i = 0; i < data->fixed_count; i++) {
        data->fixed[i].id = dis_read_u32(r);
        data->fixed[i].value = dis_read_u32(r);
    }
    for (int i = 0; i < data->variable_count; i++) {
        DisVariableDatum *datum = &data->variable[i];
        datum->id = dis_read_u32(r);
        datum->bits = dis_read_u32(r);
        datum->value = dis_take(r, value_octets(datum->bits));
        datum->padding = dis_take(r, padding_octets(datum->bits));
    }
}

Status dis_decode_data(DisData *out, const uint8_t *pdu, size_t octets)
{
    DisReader r = dis_pdu_reader(pdu, octets);
    DisData   data;
    data.header = dis_read_header(&r);
    data.originating = dis_read_entity_id(&r);
    data.receiving = dis_read_entity_id(&r);
    data.request = dis_read_u32(&r);
    data.padding = dis_read_u32(&r);
    const uint32_t fixed = dis_read_u32(&r), variable = dis_read_u32(&r);
    if (r.truncated) return STATUS_TRUNCATED;

    const size_t left = (size_t)(r.end - r.at);
    if (fixed > left / fixed_datum_octets || variable > (left - fixed * fixed_datum_octets) / variable_datum_octets)
        return STATUS_BAD_VALUE;
    if (fixed > dis_data_fixed_max || variable > dis_data_variable_max) return STATUS_UNSUPPORTED;
    data.fixed_count = (int)fixed;
    data.variable_count = (int)variable;
    read_datums(&data, &r);
    if (r.truncated) return STATUS_BAD_VALUE;

    memcpy(out, &data, offsetof(DisData, fixed)); /* datums not counted stay as they are */
    memcpy(out->fixed, data.fixed, fixed * sizeof *data.fixed);
    memcpy(out->variable, data.variable, variable * sizeof *data.variable);
    return STATUS_OK;
}

size_t dis_encode_data(uint8_t *out, size_t capacity, const DisData *pdu)
{
    if (pdu->fixed_count < 0 || pdu->fixed_count > dis_data_fixed_max || pdu->variable_count < 0 ||
        pdu->variable_count > dis_data_variable_max)
        return 0;
    size_t length = data_octets + (size_t)pdu->fixed_count * fixed_datum_octets;
    for (int i = 0; i < pdu->variable_count; i++)
        length += variable_datum_octets + value_octets(pdu->variable[i].bits) + padding_octets(pdu->variable[i].bits);
    if (length > capacity || length > UINT16_MAX) return 0;

    static const uint8_t zeros[alignment];
    DisWriter            w = {out, out + length, false};
    dis_write_header(&w, &pdu->header, length);
    dis_write_entity_id(&w, pdu->originating);
    dis_write_entity_id(&w, pdu->receiving);
    dis_write_u32(&w, pdu->request);
    dis_write_u32(&w, pdu->padding);
    dis_write_u32(&w, (uint32_t)pdu->fixed_count);
    dis_write_u32(&w, (uint32_t)pdu->variable_count);
    for (int i = 0; i < pdu->fixed_count; i++) {
        dis_write_u32(&w, pdu->fixed[i].id);
        dis_write_u32(&w, pdu->fixed[i].value);
    }
    for (int i = 0; i < pdu->variable_count; i++) {
        const DisVariableDatum *datum = &pdu->variable[i];
        dis_write_u32(&w, datum->id);
        dis_write_u32(&w, datum->bits);
        if (datum->bits) dis_write_octets(&w, datum->value, value_octets(datum->bits));
        dis_write_octets(&w, datum->padding ? datum->padding : zeros, padding_octets(datum->bits));
    }
    return length;
}
