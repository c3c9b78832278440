/* dis/pdu/octets.h: big-endian octets in and out, for the files of this module only.
 *
 * The cursors are bounds-checked with a sticky error: read or write every field, then check once. A hot decoder takes
 * one block, with a single check, and loads from it at the offsets of the standard. Floats travel as bits: nothing here
 * computes with them, and SSE moves do not quieten, so the payload of a NaN survives. */
#ifndef DIS_PDU_OCTETS_H
#define DIS_PDU_OCTETS_H

#include "dis/pdu/pdu.h"

typedef struct DisReader {
    const uint8_t *at, *end;
    bool           truncated;
} DisReader;

typedef struct DisWriter {
    uint8_t *at, *end;
    bool     overflow;
} DisWriter;

/* ---- loads and stores at a known place ----------------------------------------------------- */

static inline uint16_t dis_load_u16(const uint8_t *p)
{
    uint16_t v;
    memcpy(&v, p, sizeof v);
    return __builtin_bswap16(v);
}

static inline uint32_t dis_load_u32(const uint8_t *p)
{
    uint32_t v;
    memcpy(&v, p, sizeof v);
    return __builtin_bswap32(v);
}

static inline float dis_load_f32(const uint8_t *p)
{
    const uint32_t bits = dis_load_u32(p);
    float          v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static inline double dis_load_f64(const uint8_t *p)
{
    uint64_t bits;
    double   v;
    memcpy(&bits, p, sizeof bits);
    bits = __builtin_bswap64(bits);
    memcpy(&v, &bits, sizeof v);
    return v;
}

static inline DisEntityId dis_load_entity_id(const uint8_t *p)
{
    return (DisEntityId){dis_load_u16(p), dis_load_u16(p + 2), dis_load_u16(p + 4)};
}

static inline DisEntityType dis_load_entity_type(const uint8_t *p)
{
    return (DisEntityType){p[0], p[1], dis_load_u16(p + 2), p[4], p[5], p[6], p[7]};
}

/* The first 12 octets of every PDU. */
static inline DisHeader dis_load_header(const uint8_t *p)
{
    return (DisHeader){.version = p[0],
                       .exercise = p[1],
                       .type = p[2],
                       .family = p[3],
                       .timestamp = dis_load_u32(p + 4),
                       .length = dis_load_u16(p + 8),
                       .status = p[10],
                       .padding = p[11]};
}

static inline void dis_store_u16(uint8_t *p, uint16_t v)
{
    v = __builtin_bswap16(v);
    memcpy(p, &v, sizeof v);
}

static inline void dis_store_u32(uint8_t *p, uint32_t v)
{
    v = __builtin_bswap32(v);
    memcpy(p, &v, sizeof v);
}

static inline void dis_store_f32(uint8_t *p, const float *v)
{
    uint32_t bits;
    memcpy(&bits, v, sizeof bits);
    dis_store_u32(p, bits);
}

static inline void dis_store_f64(uint8_t *p, const double *v)
{
    uint64_t bits;
    memcpy(&bits, v, sizeof bits);
    bits = __builtin_bswap64(bits);
    memcpy(p, &bits, sizeof bits);
}

static inline void dis_store_entity_id(uint8_t *p, DisEntityId id)
{
    dis_store_u16(p, id.site);
    dis_store_u16(p + 2, id.application);
    dis_store_u16(p + 4, id.entity);
}

static inline void dis_store_entity_type(uint8_t *p, DisEntityType type)
{
    p[0] = type.kind;
    p[1] = type.domain;
    dis_store_u16(p + 2, type.country);
    p[4] = type.category;
    p[5] = type.subcategory;
    p[6] = type.specific;
    p[7] = type.extra;
}

/* ---- reading -------------------------------------------------------------------------------- */

/* The next `octets`, or NULL when fewer are left; every later read then fails too. */
static inline const uint8_t *dis_take(DisReader *r, size_t octets)
{
    if ((size_t)(r->end - r->at) < octets) {
        r->at = r->end;
        r->truncated = true;
        return NULL;
    }
    const uint8_t *block = r->at;
    r->at += octets;
    return block;
}

static inline uint8_t dis_read_u8(DisReader *r)
{
    const uint8_t *p = dis_take(r, 1);
    return p ? *p : 0;
}

static inline uint16_t dis_read_u16(DisReader *r)
{
    const uint8_t *p = dis_take(r, 2);
    return p ? dis_load_u16(p) : 0;
}

static inline uint32_t dis_read_u32(DisReader *r)
{
    const uint8_t *p = dis_take(r, 4);
    return p ? dis_load_u32(p) : 0;
}

static inline void dis_read_octets(void *out, DisReader *r, size_t octets)
{
    const uint8_t *p = dis_take(r, octets);
    if (p) memcpy(out, p, octets);
    else memset(out, 0, octets);
}

static inline void dis_read_f32(float *out, DisReader *r, int count)
{
    for (int i = 0; i < count; i++) {
        const uint8_t *p = dis_take(r, 4);
        out[i] = p ? dis_load_f32(p) : 0;
    }
}

static inline void dis_read_f64(double *out, DisReader *r, int count)
{
    for (int i = 0; i < count; i++) {
        const uint8_t *p = dis_take(r, 8);
        out[i] = p ? dis_load_f64(p) : 0;
    }
}

static inline DisHeader dis_read_header(DisReader *r)
{
    const uint8_t *p = dis_take(r, dis_header_octets);
    return p ? dis_load_header(p) : (DisHeader){0};
}

static inline DisEntityId dis_read_entity_id(DisReader *r)
{
    const uint8_t *p = dis_take(r, 6);
    return p ? dis_load_entity_id(p) : (DisEntityId){0};
}

static inline DisEntityType dis_read_entity_type(DisReader *r)
{
    const uint8_t *p = dis_take(r, 8);
    return p ? dis_load_entity_type(p) : (DisEntityType){0};
}

/* A reader over one PDU: up to its length field, and never beyond the octets given. Where the length field is 0 it
 * reads all octets given, which dis_next_pdu has found out. */
static inline DisReader dis_pdu_reader(const uint8_t *pdu, size_t octets)
{
    const size_t field = octets < dis_header_octets ? 0 : dis_load_u16(pdu + 8), length = field ? field : octets;
    if (length < dis_header_octets || length > octets) return (DisReader){pdu, pdu, true};
    return (DisReader){pdu, pdu + length, false};
}

/* ---- writing -------------------------------------------------------------------------------- */

static inline uint8_t *dis_give(DisWriter *w, size_t octets)
{
    if ((size_t)(w->end - w->at) < octets) {
        w->at = w->end;
        w->overflow = true;
        return NULL;
    }
    uint8_t *block = w->at;
    w->at += octets;
    return block;
}

static inline void dis_write_u8(DisWriter *w, uint8_t v)
{
    uint8_t *p = dis_give(w, 1);
    if (p) *p = v;
}

static inline void dis_write_u16(DisWriter *w, uint16_t v)
{
    uint8_t *p = dis_give(w, 2);
    if (p) dis_store_u16(p, v);
}

static inline void dis_write_u32(DisWriter *w, uint32_t v)
{
    uint8_t *p = dis_give(w, 4);
    if (p) dis_store_u32(p, v);
}

static inline void dis_write_octets(DisWriter *w, const void *from, size_t octets)
{
    uint8_t *p = dis_give(w, octets);
    if (p) memcpy(p, from, octets);
}

static inline void dis_write_f32(DisWriter *w, const float *v, int count)
{
    for (int i = 0; i < count; i++) {
        uint8_t *p = dis_give(w, 4);
        if (p) dis_store_f32(p, &v[i]);
    }
}

static inline void dis_write_f64(DisWriter *w, const double *v, int count)
{
    for (int i = 0; i < count; i++) {
        uint8_t *p = dis_give(w, 8);
        if (p) dis_store_f64(p, &v[i]);
    }
}

static inline void dis_store_header(uint8_t *p, const DisHeader *header, size_t length)
{
    p[0] = header->version;
    p[1] = header->exercise;
    p[2] = header->type;
    p[3] = header->family;
    dis_store_u32(p + 4, header->timestamp);
    dis_store_u16(p + 8, (uint16_t)length);
    p[10] = header->status;
    p[11] = header->padding;
}

static inline void dis_write_header(DisWriter *w, const DisHeader *header, size_t length)
{
    uint8_t *p = dis_give(w, dis_header_octets);
    if (p) dis_store_header(p, header, length);
}

static inline void dis_write_entity_id(DisWriter *w, DisEntityId id)
{
    uint8_t *p = dis_give(w, 6);
    if (p) dis_store_entity_id(p, id);
}

static inline void dis_write_entity_type(DisWriter *w, DisEntityType type)
{
    uint8_t *p = dis_give(w, 8);
    if (p) dis_store_entity_type(p, type);
}

#endif
