/* dis/cigi/cigi_fields.c: the layouts of CIGI 3.3's packets, as tables, and their fields read and written by them. */
#include "dis/cigi/cigi_fields.h"

#define MEMBER(type, member) (uint16_t) offsetof(type, member)
#define BITS(name, octet, shift, bits, type, member)                                                                   \
    {                                                                                                                  \
        name, CIGI_BITS, octet, shift, bits, MEMBER(type, member)                                                      \
    }
#define FLAG(name, octet, shift, type, member)                                                                         \
    {                                                                                                                  \
        name, CIGI_FLAG, octet, shift, 1, MEMBER(type, member)                                                         \
    }
#define WHOLE(name, kind, octet, type, member)                                                                         \
    {                                                                                                                  \
        name, kind, octet, 0, 0, MEMBER(type, member)                                                                  \
    }

/* ---- host to IG -------------------------------------------------------------------------------- */

#define T CigiIgControl
static const CigiField ig_control[] = {
    WHOLE("major version", CIGI_U8, 2, T, major),
    WHOLE("database number", CIGI_S8, 3, T, database),
    BITS("ig mode", 4, 0, 2, T, mode),
    FLAG("timestamp valid", 4, 2, T, timestamp_valid),
    FLAG("smoothing enable", 4, 3, T, smoothing),
    BITS("minor version", 4, 4, 4, T, minor),
    WHOLE("host frame number", CIGI_U32, 8, T, host_frame),
    WHOLE("timestamp", CIGI_U32, 12, T, timestamp),
    WHOLE("last ig frame number", CIGI_U32, 16, T, last_ig_frame),
};
#undef T
#define T CigiEntityControl
static const CigiField entity_control[] = {
    WHOLE("entity id", CIGI_U16, 2, T, id),
    BITS("entity state", 4, 0, 2, T, state),
    FLAG("attach state", 4, 2, T, attached),
    FLAG("collision detection enable", 4, 3, T, collides),
    FLAG("inherit alpha", 4, 4, T, inherits_alpha),
    BITS("ground/ocean clamp", 4, 5, 2, T, clamp),
    FLAG("animation direction", 5, 0, T, backward),
    FLAG("animation loop mode", 5, 1, T, loops),
    BITS("animation state", 5, 2, 2, T, animation),
    FLAG("linear extrapolation/interpolation enable", 5, 4, T, smoothing),
    WHOLE("alpha", CIGI_U8, 6, T, alpha),
    WHOLE("entity type", CIGI_U16, 8, T, type),
    WHOLE("parent id", CIGI_U16, 10, T, parent),
    WHOLE("roll", CIGI_F32, 12, T, roll_deg),
    WHOLE("pitch", CIGI_F32, 16, T, pitch_deg),
    WHOLE("yaw", CIGI_F32, 20, T, yaw_deg),
    WHOLE("latitude/x offset", CIGI_F64, 24, T, p[0]),
    WHOLE("longitude/y offset", CIGI_F64, 32, T, p[1]),
    WHOLE("altitude/z offset", CIGI_F64, 40, T, p[2]),
};
#undef T
#define T CigiRateControl
static const CigiField rate_control[] = {
    WHOLE("entity id", CIGI_U16, 2, T, entity),
    WHOLE("articulated part id", CIGI_U8, 4, T, part),
    FLAG("apply to articulated part", 5, 0, T, of_part),
    FLAG("coordinate system", 5, 1, T, local),
    WHOLE("x linear rate", CIGI_F32, 8, T, v_mps[0]),
    WHOLE("y linear rate", CIGI_F32, 12, T, v_mps[1]),
    WHOLE("z linear rate", CIGI_F32, 16, T, v_mps[2]),
    WHOLE("roll angular rate", CIGI_F32, 20, T, roll_deg_s),
    WHOLE("pitch angular rate", CIGI_F32, 24, T, pitch_deg_s),
    WHOLE("yaw angular rate", CIGI_F32, 28, T, yaw_deg_s),
};
#undef T
#define T CigiViewControl
static const CigiField view_control[] = {
    WHOLE("view id", CIGI_U16, 2, T, view),          WHOLE("group id", CIGI_U8, 4, T, group),
    FLAG("x offset enable", 5, 0, T, x_on),          FLAG("y offset enable", 5, 1, T, y_on),
    FLAG("z offset enable", 5, 2, T, z_on),          FLAG("roll enable", 5, 3, T, roll_on),
    FLAG("pitch enable", 5, 4, T, pitch_on),         FLAG("yaw enable", 5, 5, T, yaw_on),
    WHOLE("entity id", CIGI_U16, 6, T, entity),      WHOLE("x offset", CIGI_F32, 8, T, offset_m[0]),
    WHOLE("y offset", CIGI_F32, 12, T, offset_m[1]), WHOLE("z offset", CIGI_F32, 16, T, offset_m[2]),
    WHOLE("roll", CIGI_F32, 20, T, roll_deg),        WHOLE("pitch", CIGI_F32, 24, T, pitch_deg),
    WHOLE("yaw", CIGI_F32, 28, T, yaw_deg),
};
#undef T
#define T CigiSensorControl
static const CigiField sensor_control[] = {
    WHOLE("view id", CIGI_U16, 2, T, view),
    WHOLE("sensor id", CIGI_U8, 4, T, sensor),
    FLAG("sensor on/off", 5, 0, T, on),
    FLAG("polarity", 5, 1, T, black_hot),
    FLAG("line-by-line dropout enable", 5, 2, T, line_dropout),
    FLAG("automatic gain", 5, 3, T, automatic_gain),
    FLAG("track white/black", 5, 4, T, tracks_black),
    BITS("track mode", 5, 5, 3, T, track_mode),
    FLAG("response type", 6, 0, T, extended),
    WHOLE("gain", CIGI_F32, 8, T, gain),
    WHOLE("level", CIGI_F32, 12, T, level),
    WHOLE("ac coupling", CIGI_F32, 16, T, ac_coupling_us),
    WHOLE("noise", CIGI_F32, 20, T, noise),
};
#undef T
#define T CigiViewDefinition
static const CigiField view_definition[] = {
    WHOLE("view id", CIGI_U16, 2, T, view),       WHOLE("group id", CIGI_U8, 4, T, group),
    FLAG("near enable", 5, 0, T, near_on),        FLAG("far enable", 5, 1, T, far_on),
    FLAG("left enable", 5, 2, T, left_on),        FLAG("right enable", 5, 3, T, right_on),
    FLAG("top enable", 5, 4, T, top_on),          FLAG("bottom enable", 5, 5, T, bottom_on),
    BITS("mirror mode", 5, 6, 2, T, mirror),      BITS("pixel replication mode", 6, 0, 3, T, replication),
    FLAG("projection type", 6, 3, T, parallel),   FLAG("reorder", 6, 4, T, reorder),
    BITS("view type", 6, 5, 3, T, type),          WHOLE("near", CIGI_F32, 8, T, near_m),
    WHOLE("far", CIGI_F32, 12, T, far_m),         WHOLE("left", CIGI_F32, 16, T, left_deg),
    WHOLE("right", CIGI_F32, 20, T, right_deg),   WHOLE("top", CIGI_F32, 24, T, top_deg),
    WHOLE("bottom", CIGI_F32, 28, T, bottom_deg),
};
#undef T
#define T CigiHatHotRequest
static const CigiField hat_hot_request[] = {
    WHOLE("hat/hot id", CIGI_U16, 2, T, id),
    BITS("request type", 4, 0, 2, T, type),
    FLAG("coordinate system", 4, 2, T, by_entity),
    WHOLE("update period", CIGI_U8, 5, T, period),
    WHOLE("entity id", CIGI_U16, 6, T, entity),
    WHOLE("latitude/x offset", CIGI_F64, 8, T, p[0]),
    WHOLE("longitude/y offset", CIGI_F64, 16, T, p[1]),
    WHOLE("altitude/z offset", CIGI_F64, 24, T, p[2]),
};
#undef T
#define T CigiLosSegmentRequest
static const CigiField los_segment_request[] = {
    WHOLE("los id", CIGI_U16, 2, T, id),
    FLAG("request type", 4, 0, T, extended),
    FLAG("source point coordinate system", 4, 1, T, from_entity),
    FLAG("destination point coordinate system", 4, 2, T, to_entity),
    FLAG("response coordinate system", 4, 3, T, answer_entity),
    FLAG("destination entity id valid", 4, 4, T, other_entity),
    WHOLE("alpha threshold", CIGI_U8, 5, T, alpha),
    WHOLE("source entity id", CIGI_U16, 6, T, entity),
    WHOLE("source latitude/x offset", CIGI_F64, 8, T, from[0]),
    WHOLE("source longitude/y offset", CIGI_F64, 16, T, from[1]),
    WHOLE("source altitude/z offset", CIGI_F64, 24, T, from[2]),
    WHOLE("destination latitude/x offset", CIGI_F64, 32, T, to[0]),
    WHOLE("destination longitude/y offset", CIGI_F64, 40, T, to[1]),
    WHOLE("destination altitude/z offset", CIGI_F64, 48, T, to[2]),
    WHOLE("material mask", CIGI_U32, 56, T, materials),
    WHOLE("update period", CIGI_U8, 60, T, period),
    WHOLE("destination entity id", CIGI_U16, 62, T, destination_entity),
};
#undef T
#define T CigiLosVectorRequest
static const CigiField los_vector_request[] = {
    WHOLE("los id", CIGI_U16, 2, T, id),
    FLAG("request type", 4, 0, T, extended),
    FLAG("source point coordinate system", 4, 1, T, from_entity),
    FLAG("response coordinate system", 4, 2, T, answer_entity),
    WHOLE("alpha threshold", CIGI_U8, 5, T, alpha),
    WHOLE("entity id", CIGI_U16, 6, T, entity),
    WHOLE("azimuth", CIGI_F32, 8, T, azimuth_deg),
    WHOLE("elevation", CIGI_F32, 12, T, elevation_deg),
    WHOLE("minimum range", CIGI_F32, 16, T, least_m),
    WHOLE("maximum range", CIGI_F32, 20, T, most_m),
    WHOLE("source latitude/x offset", CIGI_F64, 24, T, from[0]),
    WHOLE("source longitude/y offset", CIGI_F64, 32, T, from[1]),
    WHOLE("source altitude/z offset", CIGI_F64, 40, T, from[2]),
    WHOLE("material mask", CIGI_U32, 48, T, materials),
    WHOLE("update period", CIGI_U8, 52, T, period),
};
#undef T

/* ---- IG to host -------------------------------------------------------------------------------- */

#define T CigiStartOfFrame
static const CigiField start_of_frame[] = {
    WHOLE("major version", CIGI_U8, 2, T, major),
    WHOLE("database number", CIGI_S8, 3, T, database),
    WHOLE("ig status code", CIGI_U8, 4, T, status),
    BITS("ig mode", 5, 0, 2, T, mode),
    FLAG("timestamp valid", 5, 2, T, timestamp_valid),
    FLAG("earth reference model", 5, 3, T, other_earth),
    BITS("minor version", 5, 4, 4, T, minor),
    WHOLE("ig frame number", CIGI_U32, 8, T, ig_frame),
    WHOLE("timestamp", CIGI_U32, 12, T, timestamp),
    WHOLE("last host frame number", CIGI_U32, 16, T, last_host_frame),
};
#undef T
#define T CigiHatHotResponse
static const CigiField hat_hot_response[] = {
    WHOLE("hat/hot id", CIGI_U16, 2, T, id),   FLAG("valid", 4, 0, T, valid),
    FLAG("response type", 4, 1, T, hot),       BITS("host frame number lsn", 4, 4, 4, T, host_frame),
    WHOLE("height", CIGI_F64, 8, T, height_m),
};
#undef T
#define T CigiHatHotExtendedResponse
static const CigiField hat_hot_extended_response[] = {
    WHOLE("hat/hot id", CIGI_U16, 2, T, id),
    FLAG("valid", 4, 0, T, valid),
    BITS("host frame number lsn", 4, 4, 4, T, host_frame),
    WHOLE("hat", CIGI_F64, 8, T, hat_m),
    WHOLE("hot", CIGI_F64, 16, T, hot_m),
    WHOLE("material code", CIGI_U32, 24, T, material),
    WHOLE("normal vector azimuth", CIGI_F32, 28, T, normal_azimuth_deg),
    WHOLE("normal vector elevation", CIGI_F32, 32, T, normal_elevation_deg),
};
#undef T
#define T CigiLosResponse
static const CigiField los_response[] = {
    WHOLE("los id", CIGI_U16, 2, T, id),
    FLAG("valid", 4, 0, T, valid),
    FLAG("entity id valid", 4, 1, T, entity_valid),
    FLAG("visible", 4, 2, T, visible),
    BITS("host frame number lsn", 4, 4, 4, T, host_frame),
    WHOLE("response count", CIGI_U8, 5, T, count),
    WHOLE("entity id", CIGI_U16, 6, T, entity),
    WHOLE("range", CIGI_F64, 8, T, range_m),
};
#undef T
#define T CigiLosExtendedResponse
static const CigiField los_extended_response[] = {
    WHOLE("los id", CIGI_U16, 2, T, id),
    FLAG("valid", 4, 0, T, valid),
    FLAG("entity id valid", 4, 1, T, entity_valid),
    FLAG("range valid", 4, 2, T, range_valid),
    FLAG("visible", 4, 3, T, visible),
    BITS("host frame number lsn", 4, 4, 4, T, host_frame),
    WHOLE("response count", CIGI_U8, 5, T, count),
    WHOLE("entity id", CIGI_U16, 6, T, entity),
    WHOLE("range", CIGI_F64, 8, T, range_m),
    WHOLE("latitude/x offset", CIGI_F64, 16, T, p[0]),
    WHOLE("longitude/y offset", CIGI_F64, 24, T, p[1]),
    WHOLE("altitude/z offset", CIGI_F64, 32, T, p[2]),
    WHOLE("red", CIGI_U8, 40, T, red),
    WHOLE("green", CIGI_U8, 41, T, green),
    WHOLE("blue", CIGI_U8, 42, T, blue),
    WHOLE("alpha", CIGI_U8, 43, T, alpha),
    WHOLE("material code", CIGI_U32, 44, T, material),
    WHOLE("normal vector azimuth", CIGI_F32, 48, T, normal_azimuth_deg),
    WHOLE("normal vector elevation", CIGI_F32, 52, T, normal_elevation_deg),
};
#undef T
#define T CigiSensorResponse
static const CigiField sensor_response[] = {
    WHOLE("view id", CIGI_U16, 2, T, view),
    WHOLE("sensor id", CIGI_U8, 4, T, sensor),
    BITS("sensor status", 5, 0, 2, T, status),
    WHOLE("gate x size", CIGI_U16, 8, T, gate_px[0]),
    WHOLE("gate y size", CIGI_U16, 10, T, gate_px[1]),
    WHOLE("gate x position", CIGI_F32, 12, T, gate_deg[0]),
    WHOLE("gate y position", CIGI_F32, 16, T, gate_deg[1]),
    WHOLE("frame counter", CIGI_U32, 20, T, frame),
};
#undef T
#define T CigiSensorExtendedResponse
static const CigiField sensor_extended_response[] = {
    WHOLE("view id", CIGI_U16, 2, T, view),
    WHOLE("sensor id", CIGI_U8, 4, T, sensor),
    BITS("sensor status", 5, 0, 2, T, status),
    FLAG("entity id valid", 5, 2, T, entity_valid),
    WHOLE("entity id", CIGI_U16, 6, T, entity),
    WHOLE("gate x size", CIGI_U16, 8, T, gate_px[0]),
    WHOLE("gate y size", CIGI_U16, 10, T, gate_px[1]),
    WHOLE("gate x position", CIGI_F32, 12, T, gate_deg[0]),
    WHOLE("gate y position", CIGI_F32, 16, T, gate_deg[1]),
    WHOLE("frame counter", CIGI_U32, 20, T, frame),
    WHOLE("track point latitude", CIGI_F64, 24, T, track[0]),
    WHOLE("track point longitude", CIGI_F64, 32, T, track[1]),
    WHOLE("track point altitude", CIGI_F64, 40, T, track[2]),
};
#undef T

#define LAYOUT(name, id, octets, fields)                                                                               \
    {                                                                                                                  \
        name, id, octets, fields, (int)(sizeof fields / sizeof *fields)                                                \
    }
static const CigiLayout layouts[] = {
    LAYOUT("IG Control", cigi_ig_control, 24, ig_control),
    LAYOUT("Entity Control", cigi_entity_control, 48, entity_control),
    LAYOUT("Rate Control", cigi_rate_control, 32, rate_control),
    LAYOUT("View Control", cigi_view_control, 32, view_control),
    LAYOUT("Sensor Control", cigi_sensor_control, 24, sensor_control),
    LAYOUT("View Definition", cigi_view_definition, 32, view_definition),
    LAYOUT("HAT/HOT Request", cigi_hat_hot_request, 32, hat_hot_request),
    LAYOUT("Line of Sight Segment Request", cigi_los_segment_request, 64, los_segment_request),
    LAYOUT("Line of Sight Vector Request", cigi_los_vector_request, 56, los_vector_request),
    LAYOUT("Start of Frame", cigi_start_of_frame, 24, start_of_frame),
    LAYOUT("HAT/HOT Response", cigi_hat_hot_response, 16, hat_hot_response),
    LAYOUT("HAT/HOT Extended Response", cigi_hat_hot_extended_response, 40, hat_hot_extended_response),
    LAYOUT("Line of Sight Response", cigi_los_response, 16, los_response),
    LAYOUT("Line of Sight Extended Response", cigi_los_extended_response, 56, los_extended_response),
    LAYOUT("Sensor Response", cigi_sensor_response, 24, sensor_response),
    LAYOUT("Sensor Extended Response", cigi_sensor_extended_response, 48, sensor_extended_response),
};

const CigiLayout *cigi_layout(uint8_t id)
{
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++)
        if (layouts[i].id == id) return &layouts[i];
    return NULL;
}

/* ---- one field ---------------------------------------------------------------------------------- */

/* The octets of a field, from `order`, as a number: the bits of a float. */
static uint64_t load(const uint8_t *at, int count, CigiOrder order)
{
    uint64_t v = 0;
    for (int i = 0; i < count; i++) v = v << 8 | at[order == CIGI_BIG_ENDIAN ? i : count - 1 - i];
    return v;
}

static void store(uint8_t *at, int count, CigiOrder order, uint64_t v)
{
    for (int i = 0; i < count; i++) at[order == CIGI_BIG_ENDIAN ? count - 1 - i : i] = (uint8_t)(v >> 8 * i);
}

static int octets_of(CigiFieldKind kind)
{
    switch (kind) {
    case CIGI_U16:
        return 2;
    case CIGI_U32:
    case CIGI_F32:
        return 4;
    case CIGI_F64:
        return 8;
    default:
        return 1;
    }
}

bool cigi_read_fields(CigiPacket *out, const CigiLayout *layout, const uint8_t *octets, size_t count, CigiOrder order)
{
    bool finite = true;
    for (int i = 0; i < layout->count; i++) {
        const CigiField *f = &layout->field[i];
        const int        width = octets_of(f->kind);
        uint8_t         *member = (uint8_t *)&out->of + f->member;
        if ((size_t)f->octet + (size_t)width > count) continue;
        const uint64_t bits = load(octets + f->octet, width, order),
                       in_octet = bits >> f->shift & ((1u << f->bits) - 1);
        const uint16_t u16 = (uint16_t)bits;
        const uint32_t u32 = (uint32_t)bits;
        const bool     flag = in_octet;
        float          f32;
        double         f64;
        switch (f->kind) {
        case CIGI_BITS:
            *member = (uint8_t)in_octet;
            break;
        case CIGI_FLAG:
            memcpy(member, &flag, sizeof flag);
            break;
        case CIGI_S8:
        case CIGI_U8:
            *member = (uint8_t)bits;
            break;
        case CIGI_U16:
            memcpy(member, &u16, sizeof u16);
            break;
        case CIGI_U32:
            memcpy(member, &u32, sizeof u32);
            break;
        case CIGI_F32:
            memcpy(member, &u32, sizeof u32);
            memcpy(&f32, &u32, sizeof f32);
            finite &= isfinite(f32);
            break;
        case CIGI_F64:
            memcpy(member, &bits, sizeof bits);
            memcpy(&f64, &bits, sizeof f64);
            finite &= isfinite(f64);
            break;
        }
    }
    return finite;
}

void cigi_write_fields(uint8_t *out, const CigiLayout *layout, const CigiPacket *packet, CigiOrder order)
{
    for (int i = 0; i < layout->count; i++) {
        const CigiField *f = &layout->field[i];
        const uint8_t   *member = (const uint8_t *)&packet->of + f->member;
        uint16_t         u16;
        uint32_t         u32;
        uint64_t         u64;
        bool             flag;
        switch (f->kind) {
        case CIGI_BITS:
            out[f->octet] |= (uint8_t)((*member & ((1u << f->bits) - 1)) << f->shift);
            break;
        case CIGI_FLAG:
            memcpy(&flag, member, sizeof flag);
            out[f->octet] |= (uint8_t)(flag << f->shift);
            break;
        case CIGI_S8:
        case CIGI_U8:
            out[f->octet] = *member;
            break;
        case CIGI_U16:
            memcpy(&u16, member, sizeof u16);
            store(out + f->octet, 2, order, u16);
            break;
        case CIGI_U32:
        case CIGI_F32:
            memcpy(&u32, member, sizeof u32);
            store(out + f->octet, 4, order, u32);
            break;
        case CIGI_F64:
            memcpy(&u64, member, sizeof u64);
            store(out + f->octet, 8, order, u64);
            break;
        }
    }
}

double cigi_field_value(const CigiPacket *packet, const CigiField *field)
{
    const uint8_t *member = (const uint8_t *)&packet->of + field->member;
    uint16_t       u16;
    uint32_t       u32;
    float          f32;
    double         f64;
    bool           flag;
    switch (field->kind) {
    case CIGI_FLAG:
        return memcpy(&flag, member, sizeof flag), flag;
    case CIGI_S8:
        return (int8_t)*member;
    case CIGI_U16:
        return memcpy(&u16, member, sizeof u16), u16;
    case CIGI_U32:
        return memcpy(&u32, member, sizeof u32), u32;
    case CIGI_F32:
        return memcpy(&f32, member, sizeof f32), (double)f32;
    case CIGI_F64:
        return memcpy(&f64, member, sizeof f64), f64;
    default:
        return *member;
    }
}

void cigi_field_set(CigiPacket *packet, const CigiField *field, double value)
{
    uint8_t       *member = (uint8_t *)&packet->of + field->member;
    const bool     flag = value != 0;
    const float    f32 = (float)value;
    const uint64_t bits = field->kind == CIGI_F32 || field->kind == CIGI_F64 ? 0 : (uint64_t)(int64_t)value;
    const uint16_t u16 = (uint16_t)bits;
    const uint32_t u32 = (uint32_t)bits;
    switch (field->kind) {
    case CIGI_FLAG:
        memcpy(member, &flag, sizeof flag);
        break;
    case CIGI_U16:
        memcpy(member, &u16, sizeof u16);
        break;
    case CIGI_U32:
        memcpy(member, &u32, sizeof u32);
        break;
    case CIGI_F32:
        memcpy(member, &f32, sizeof f32);
        break;
    case CIGI_F64:
        memcpy(member, &value, sizeof value);
        break;
    default:
        *member = (uint8_t)bits;
        break;
    }
}
