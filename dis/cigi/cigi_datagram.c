/* dis/cigi/cigi_datagram.c: the packets of a CIGI datagram, one after the other by their sizes; and one packet written.
 */
#include "dis/cigi/cigi_datagram.h"

#include "dis/cigi/cigi_fields.h"

const char *cigi_drop_name(CigiDrop drop)
{
    static const char *const name[CIGI_DROP_COUNT] = {
        [CIGI_DROP_SHORT] = "short",
        [CIGI_DROP_FIRST] = "first_packet",
        [CIGI_DROP_VERSION] = "version",
        [CIGI_DROP_MAGIC] = "byte_swap",
        [CIGI_DROP_SIZE] = "size",
        [CIGI_DROP_SIZE_LONG] = "size_too_long",
        [CIGI_DROP_SIZE_SHORT] = "size_too_short",
        [CIGI_DROP_NOT_FINITE] = "not_finite",
        [CIGI_DROP_SECOND] = "second_control",
    };
    return (unsigned)drop < CIGI_DROP_COUNT ? name[drop] : "unknown";
}

const char *cigi_drop_cause(CigiDrop drop)
{
    static const char *const cause[CIGI_DROP_COUNT] = {
        [CIGI_DROP_SHORT] = "fewer octets than the first packet needs",
        [CIGI_DROP_FIRST] = "a first packet other than IG Control or Start of Frame",
        [CIGI_DROP_VERSION] = "a version of CIGI other than 3",
        [CIGI_DROP_MAGIC] = "a byte swap magic number other than 0x8000 and 0x0080",
        [CIGI_DROP_SIZE] = "a packet size of 0, or not a multiple of 8",
        [CIGI_DROP_SIZE_LONG] = "a packet size beyond the end of the datagram",
        [CIGI_DROP_SIZE_SHORT] = "a packet size below what its packet needs",
        [CIGI_DROP_NOT_FINITE] = "a field that is not a number",
        [CIGI_DROP_SECOND] = "a second IG Control or Start of Frame in a datagram",
    };
    return (unsigned)drop < CIGI_DROP_COUNT ? cause[drop] : "unknown";
}

const char *cigi_packet_name(uint8_t id)
{
    const CigiLayout *layout = cigi_layout(id);
    return layout ? layout->name : "unknown packet";
}

/* Ids of the IG's packets begin here; beyond, from 201 on, are those that users define for either. */
static bool sent_by(uint8_t id, CigiSender sender) { return (id < cigi_start_of_frame) == (sender == CIGI_FROM_HOST); }

/* IG Control (id 0) or Start of Frame (0xFFFF) of CIGI 4, where a size of 16 bits is first. */
static bool of_cigi_4(const uint8_t *p)
{
    return p[4] == 4 && p[2] == p[3] && (p[2] == 0 || p[2] == 0xFF) && (p[0] == 0) != (p[1] == 0);
}

static Status refuse(CigiCounters *counters, CigiDrop why, Status status)
{
    counters->dropped[why]++;
    return status;
}

Status cigi_open(CigiReader *out, CigiPacket *first, CigiCounters *counters, const uint8_t *datagram, size_t octets,
                 CigiSender sender)
{
    enum { before_3_2 = 16 };
    const CigiLayout *layout = cigi_layout(sender == CIGI_FROM_HOST ? cigi_ig_control : cigi_start_of_frame);
    if (octets < before_3_2) return refuse(counters, CIGI_DROP_SHORT, STATUS_TRUNCATED);
    if (of_cigi_4(datagram)) return refuse(counters, CIGI_DROP_VERSION, STATUS_UNSUPPORTED);
    if (datagram[0] != layout->id) return refuse(counters, CIGI_DROP_FIRST, STATUS_BAD_VALUE);
    if (datagram[2] != cigi_major) return refuse(counters, CIGI_DROP_VERSION, STATUS_UNSUPPORTED);
    const size_t size = datagram[1];
    const int    minor = datagram[sender == CIGI_FROM_HOST ? 4 : 5] >> 4;
    if (size % 8 != 0) return refuse(counters, CIGI_DROP_SIZE, STATUS_BAD_VALUE);
    if (size < (minor < 2 ? before_3_2 : layout->octets))
        return refuse(counters, CIGI_DROP_SIZE_SHORT, STATUS_BAD_VALUE);
    if (size > octets) return refuse(counters, CIGI_DROP_SIZE_LONG, STATUS_TRUNCATED);
    const unsigned magic = (unsigned)datagram[6] << 8 | datagram[7];
    const bool     swapped = magic == cigi_magic >> 8;
    if (magic != cigi_magic && !swapped) return refuse(counters, CIGI_DROP_MAGIC, STATUS_BAD_VALUE);

    const CigiOrder order = swapped ? CIGI_LITTLE_ENDIAN : CIGI_BIG_ENDIAN;
    CigiPacket      packet = {.id = layout->id};
    cigi_read_fields(&packet, layout, datagram, minor < 2 ? before_3_2 : size, order);
    counters->datagrams++;
    counters->packets[layout->id]++;
    *first = packet;
    *out = (CigiReader){datagram + size, datagram + octets, order, sender};
    return STATUS_OK;
}

bool cigi_next(CigiPacket *out, CigiReader *r, CigiCounters *counters)
{
    while (r->at < r->end) {
        const size_t left = (size_t)(r->end - r->at);
        const bool   headed = left >= 2;
        const size_t size = headed ? r->at[1] : 0;
        if (size == 0 || size % 8 != 0 || size > left) {
            counters->dropped[!headed || size > left ? CIGI_DROP_SIZE_LONG : CIGI_DROP_SIZE]++;
            r->at = r->end;
            return false;
        }
        const uint8_t    *packet = r->at;
        const uint8_t     id = packet[0];
        const CigiLayout *layout = cigi_layout(id);
        CigiPacket        read = {.id = id};
        r->at += size;
        if (!layout || !sent_by(id, r->sender)) counters->skipped[id]++;
        else if (id == cigi_ig_control || id == cigi_start_of_frame) counters->dropped[CIGI_DROP_SECOND]++;
        else if (size < layout->octets) counters->dropped[CIGI_DROP_SIZE_SHORT]++;
        else if (!cigi_read_fields(&read, layout, packet, size, r->order)) counters->dropped[CIGI_DROP_NOT_FINITE]++;
        else {
            counters->packets[id]++;
            *out = read;
            return true;
        }
    }
    return false;
}

size_t cigi_write(uint8_t *out, size_t capacity, const CigiPacket *packet, CigiOrder order)
{
    const CigiLayout *layout = cigi_layout(packet->id);
    if (!layout || capacity < layout->octets) return 0;
    memset(out, 0, layout->octets);
    cigi_write_fields(out, layout, packet, order);
    out[0] = layout->id;
    out[1] = layout->octets;
    if (layout->id != cigi_ig_control && layout->id != cigi_start_of_frame) return layout->octets;
    uint8_t *const minor = &out[layout->id == cigi_ig_control ? 4 : 5];
    out[2] = cigi_major;
    *minor = (uint8_t)((*minor & 15) | cigi_minor << 4);
    out[order == CIGI_BIG_ENDIAN ? 6 : 7] = cigi_magic >> 8;
    return layout->octets;
}
