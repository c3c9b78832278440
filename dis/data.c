/* dis/data.c: Data. */
#include "dis/data_private.h"

#include "dis/reader.h"

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
