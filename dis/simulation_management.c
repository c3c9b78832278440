/* dis/simulation_management.c: Remove Entity, Start/Resume, Stop/Freeze, and the same with reliability. */
#include "dis/simulation_management_private.h"

#include "dis/reader.h"

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
