/* dis/capture/log_pcap.c: pcap and pcapng, record by record.
 *
 * Sources: pcap-savefile(5) of libpcap; PCAP Next Generation (draft-ietf-opsawg-pcapng). The length of a record is its
 * length field, up to a limit; an inconsistent record ends the reading, and the records before it are kept. */
#include "dis/capture/log_private.h"

#include "dis/pdu/pdu.h"

#include <stdarg.h>
#include <stdlib.h>

enum {
    block_section = 0x0A0D0D0A,
    block_interface = 1,
    block_old_packet = 2,
    block_simple_packet = 3,
    block_statistics = 5,
    block_packet = 6,
    order_magic = 0x1A2B3C4D,
    option_end = 0,
    option_tsresol = 9,
    option_tsoffset = 14,
    packet_most = 262144,         /* most octets of a packet: libpcap's limit */
    body_most = packet_most + 32, /* most octets of a block that are read */
    interfaces_most = 65536,
};

static const uint64_t ns_per_s = 1000000000;

typedef struct Interface {
    int      link;
    uint32_t snap;     /* most octets of a packet that the capture kept; 0: all */
    uint64_t per_s;    /* units of the time stamps in a second */
    int64_t  offset_s; /* seconds to be added to the time stamps */
} Interface;

struct DisCapture {
    DisStream *stream;
    bool       ng, big;       /* ng: pcapng; big: the file is big-endian */
    size_t     record_octets; /* of pcap: octets of a packet's header */
    Interface *interface;     /* its interfaces; pcap has one */
    int        count, capacity;
    double     last_s;
    char      *notes; /* terminated text of the notes; NULL: there are none yet */
    size_t     note_octets, note_capacity;
    Status     status;
    char       problem[200];
    uint64_t   body_at; /* offset of the packet's octets in the file; UINT64_MAX: it has none */
    uint8_t    body[body_most];
};

__attribute__((format(printf, 2, 3))) static bool stop(DisCapture *c, const char *format, ...)
{
    const char *below = dis_stream_problem(c->stream);
    va_list     arguments;
    va_start(arguments, format);
    if (below) snprintf(c->problem, sizeof c->problem, "%s", below); /* the problem is an error of the file below */
    else vsnprintf(c->problem, sizeof c->problem, format, arguments);
    va_end(arguments);
    c->status = dis_stream_status(c->stream);
    return false;
}

static uint16_t load_u16(const DisCapture *c, const uint8_t *p)
{
    return (uint16_t)(c->big ? p[0] << 8 | p[1] : p[1] << 8 | p[0]);
}

static uint32_t load_u32(const DisCapture *c, const uint8_t *p)
{
    return c->big ? (uint32_t)load_u16(c, p) << 16 | load_u16(c, p + 2)
                  : (uint32_t)load_u16(c, p + 2) << 16 | load_u16(c, p);
}

/* Whether the octets are the magic number. *big: whether they are in big-endian order. */
static bool magic_is(bool *big, const uint8_t *p, uint32_t magic)
{
    const uint32_t little = (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0];
    *big = little == __builtin_bswap32(magic);
    return *big || little == magic;
}

/* ---- time ---------------------------------------------------------------------------------------------- */

static double stamp_s(const Interface *face, uint64_t ticks)
{
    static const int64_t most_s = 9000000000; /* times above this, or below 0, are clamped */
    uint64_t             per_s = face->per_s, part = ticks % per_s, ns;
    const uint64_t       whole_s = ticks / per_s;
    if (ns_per_s % per_s == 0) {
        ns = part * (ns_per_s / per_s);
    } else if (per_s % ns_per_s == 0) {
        ns = part / (per_s / ns_per_s);
    } else {
        while (per_s >> 34)
            per_s >>= 1, part >>= 1; /* divides by powers of two, so that the product below fits: 2^34 * 10^9 < 2^64 */
        ns = part * ns_per_s / per_s;
    }
    const int64_t stamp = whole_s > (uint64_t)most_s ? most_s : (int64_t)whole_s;
    const int64_t shift = face->offset_s > most_s ? most_s : face->offset_s < -most_s ? -most_s : face->offset_s;
    const int64_t s = stamp + shift < 0 ? 0 : stamp + shift > most_s ? most_s : stamp + shift;
    return dis_unix_s(s * (int64_t)ns_per_s + (int64_t)ns);
}

/* Units a second from if_tsresol: the lower seven bits are a power of 10, or of 2 where the eighth is set. 0: a 64-bit
 * number cannot hold it. */
static uint64_t resolution(uint8_t code)
{
    uint64_t per_s = 1;
    if (code & 0x80) return (code & 0x7F) <= 63 ? (uint64_t)1 << (code & 0x7F) : 0;
    if (code > 19) return 0;
    for (int i = 0; i < code; i++) per_s *= 10;
    return per_s;
}

/* ---- interfaces ---------------------------------------------------------------------------------------- */

static bool add_interface(DisCapture *c, Interface face)
{
    if (c->count == interfaces_most) return stop(c, "more than %d interfaces", interfaces_most);
    if (c->count == c->capacity) {
        const int  capacity = c->capacity ? 2 * c->capacity : 4;
        Interface *grown = realloc(c->interface, (size_t)capacity * sizeof *grown);
        if (!grown) {
            stop(c, "out of memory");
            c->status = STATUS_NO_MEMORY;
            return false;
        }
        c->interface = grown;
        c->capacity = capacity;
    }
    c->interface[c->count++] = face;
    return true;
}

static bool read_interface(DisCapture *c, size_t octets)
{
    if (octets < 8) return stop(c, "an interface block of %zu octets", octets + 12);
    Interface face = {.link = load_u16(c, c->body), .snap = load_u32(c, c->body + 4), .per_s = 1000000};
    for (size_t at = 8; at + 4 <= octets;) {
        const uint16_t code = load_u16(c, c->body + at), length = load_u16(c, c->body + at + 2);
        const uint8_t *value = c->body + at + 4;
        if (code == option_end) break;
        at += 4 + ((size_t)length + 3) / 4 * 4;
        if (at > octets) return stop(c, "an option of interface %d reaches beyond its block", c->count);
        if (code == option_tsresol && length == 1) face.per_s = resolution(*value);
        if (code == option_tsoffset && length == 8) {
            const uint64_t high = load_u32(c, value + (c->big ? 0 : 4)), low = load_u32(c, value + (c->big ? 4 : 0));
            face.offset_s = (int64_t)(high << 32 | low);
        }
        if (face.per_s == 0) return stop(c, "interface %d has time stamps finer than 64 bits can count", c->count);
    }
    return add_interface(c, face);
}

/* Adds a comment to the notes. One that does not fit, or is cut, is left out: notes are not part of the packets. */
static void take_note(DisCapture *c, const uint8_t *text, size_t octets)
{
    enum { notes_most = 1 << 26 };
    const size_t needed = c->note_octets + octets + 2;
    if (needed > notes_most) return;
    if (needed > c->note_capacity) {
        char *larger = realloc(c->notes, 2 * needed);
        if (!larger) return;
        c->notes = larger;
        c->note_capacity = 2 * needed;
    }
    for (size_t i = 0; i < octets; i++) c->notes[c->note_octets++] = text[i] >= ' ' ? (char)text[i] : ' ';
    c->notes[c->note_octets++] = '\n';
    c->notes[c->note_octets] = 0;
}

static void read_statistics(DisCapture *c, size_t octets)
{
    enum { option_comment = 1 };
    for (size_t at = 12; at + 4 <= octets;) {
        const uint16_t code = load_u16(c, c->body + at), length = load_u16(c, c->body + at + 2);
        const uint8_t *value = c->body + at + 4;
        if (code == option_end) break;
        at += 4 + ((size_t)length + 3) / 4 * 4;
        if (at > octets) break;
        if (code == option_comment) take_note(c, value, length);
    }
}

const char *dis_capture_notes(const DisCapture *c) { return c->notes ? c->notes : ""; }

/* ---- pcapng -------------------------------------------------------------------------------------------- */

/* Reads a section header, whose type has been read; its length is in its own byte order. */
static bool begin_section(DisCapture *c, uint8_t head[12], uint32_t *length)
{
    if (dis_stream_read(c->stream, head + 8, 4) < 4) return stop(c, "it ends inside a section header");
    if (!magic_is(&c->big, head + 8, order_magic)) return stop(c, "a section header without its byte-order mark");
    *length = load_u32(c, head + 4);
    if (*length < 28 || *length % 4) return stop(c, "a section header of %u octets", *length);
    c->count = 0;
    return true;
}

static bool take_packet(DisCapturePacket *out, DisCapture *c, const uint8_t *at, size_t there, uint32_t captured,
                        const Interface *face)
{
    if (captured > there) return stop(c, "a packet of %u octets in a block with room for %zu", captured, there);
    *out = (DisCapturePacket){c->last_s, face->link, captured, at, c->body_at};
    if (out->at != UINT64_MAX) out->at += (uint64_t)(at - c->body);
    return true;
}

/* looked_at: how many of the block's `octets` are in memory. found: whether the block was a packet. */
static bool read_block(bool *found, DisCapturePacket *out, DisCapture *c, uint32_t type, size_t looked_at,
                       uint64_t octets)
{
    const bool old = type == block_old_packet, simple = type == block_simple_packet;
    *found = false;
    if (type == block_interface) return read_interface(c, looked_at);
    if (type == block_statistics) read_statistics(c, looked_at);
    if (type != block_packet && !old && !simple) return true;
    const size_t head = simple ? 4 : 20;
    if (octets < head) return stop(c, "a packet block of %llu octets", (unsigned long long)octets + 12);
    const uint32_t number = simple ? 0 : old ? load_u16(c, c->body) : load_u32(c, c->body);
    if (number >= (uint32_t)c->count) return stop(c, "a packet of interface %u, which no block describes", number);
    const Interface *face = &c->interface[number];
    uint32_t         captured = simple ? load_u32(c, c->body) : load_u32(c, c->body + 12);
    if (!simple) c->last_s = stamp_s(face, (uint64_t)load_u32(c, c->body + 4) << 32 | load_u32(c, c->body + 8));
    if (simple && face->snap && captured > face->snap) captured = face->snap;
    if (simple && captured > octets - head) captured = (uint32_t)(octets - head);
    if (captured <= octets - head && captured > looked_at - head) captured = (uint32_t)(looked_at - head);
    *found = true;
    return take_packet(out, c, c->body + head, looked_at - head, captured, face);
}

static bool next_block(bool *found, DisCapturePacket *out, DisCapture *c)
{
    uint8_t      head[12], tail[4];
    size_t       begun = 8;
    const size_t got = dis_stream_read(c->stream, head, 8);
    *found = false;
    if (got == 0 && !dis_stream_problem(c->stream)) return false;
    if (got < 8) return stop(c, "it ends inside a block's header");
    uint32_t   length = load_u32(c, head + 4);
    const bool section = load_u32(c, head) == block_section; /* this block type is the same in either byte order */
    if (section) {
        if (!begin_section(c, head, &length)) return false;
        begun = 12;
    } else if (length < 12 || length % 4) {
        return stop(c, "a block of %u octets", length);
    }
    const uint64_t octets = length - begun - 4;
    const size_t   looked_at = octets < body_most ? (size_t)octets : body_most;
    c->body_at = dis_stream_offset(c->stream);
    if (dis_stream_read(c->stream, c->body, looked_at) < looked_at || !dis_stream_skip(c->stream, octets - looked_at) ||
        dis_stream_read(c->stream, tail, 4) < 4)
        return stop(c, "it ends inside a block");
    if (load_u32(c, tail) != length)
        return stop(c, "a block says %u octets at its begin, %u at its end", length, load_u32(c, tail));
    if (section) return load_u16(c, c->body) == 1 || stop(c, "version %u of pcapng", load_u16(c, c->body));
    return read_block(found, out, c, load_u32(c, head), looked_at, octets);
}

/* ---- pcap ---------------------------------------------------------------------------------------------- */

static bool next_record(DisCapturePacket *out, DisCapture *c)
{
    uint8_t      head[24];
    const size_t got = dis_stream_read(c->stream, head, c->record_octets);
    if (got == 0 && !dis_stream_problem(c->stream)) return false;
    if (got < c->record_octets) return stop(c, "it ends inside a packet's header");
    const uint32_t captured = load_u32(c, head + 8);
    if (captured > packet_most) return stop(c, "a packet of %u octets", captured);
    c->body_at = dis_stream_offset(c->stream);
    if (dis_stream_read(c->stream, c->body, captured) < captured) return stop(c, "it ends inside a packet");
    const Interface *face = c->interface;
    Interface        whole = *face; /* the stamp is 32 bits of seconds, then a fraction that may exceed a second */
    whole.offset_s = (int64_t)load_u32(c, head);
    c->last_s = stamp_s(&whole, load_u32(c, head + 4));
    *out = (DisCapturePacket){c->last_s, face->link, captured, c->body, c->body_at};
    return true;
}

static bool begin_pcap(DisCapture *c, const uint8_t magic[4])
{
    static const struct {
        uint32_t magic, per_s;
        size_t   record_octets;
    } form[] = {{0xA1B2C3D4, 1000000, 16}, {0xA1B23C4D, 1000000000, 16}, {0xA1B2CD34, 1000000, 24}};
    for (size_t i = 0; i < sizeof form / sizeof *form; i++) {
        uint8_t head[20];
        if (!magic_is(&c->big, magic, form[i].magic)) continue;
        if (dis_stream_read(c->stream, head, sizeof head) < sizeof head) return stop(c, "it ends inside its header");
        if (load_u16(c, head) != 2) return stop(c, "version %u of pcap", load_u16(c, head));
        c->record_octets = form[i].record_octets;
        /* only the lower 16 bits are the link type; bits above them give the length of the frame check sequence */
        return add_interface(c, (Interface){.link = load_u16(c, head + (c->big ? 18 : 16)), .per_s = form[i].per_s});
    }
    return stop(c, "its first octets are those of neither");
}

/* ---- both ---------------------------------------------------------------------------------------------- */

static bool begin(DisCapture *c)
{
    uint8_t head[12], tail[4];
    bool    ignored;
    if (dis_stream_read(c->stream, head, 4) < 4) return stop(c, "it ends inside its header");
    c->ng = magic_is(&ignored, head, block_section);
    if (!c->ng) return begin_pcap(c, head);
    uint32_t length;
    if (dis_stream_read(c->stream, head + 4, 4) < 4) return stop(c, "it ends inside a section header");
    if (!begin_section(c, head, &length)) return false;
    if (dis_stream_read(c->stream, c->body, 2) < 2) return stop(c, "it ends inside a section header");
    if (load_u16(c, c->body) != 1) return stop(c, "version %u of pcapng", load_u16(c, c->body));
    if (!dis_stream_skip(c->stream, length - 18) || dis_stream_read(c->stream, tail, 4) < 4)
        return stop(c, "it ends inside a section header");
    if (load_u32(c, tail) != length) return stop(c, "a section header says two lengths");
    return true;
}

void dis_capture_drain(DisCapture *c) { dis_stream_drain(c->stream); }
int  dis_capture_file(const DisCapture *c) { return dis_stream_file(c->stream); }

Status dis_capture_open_tapped(DisCapture **out, const char *path, DisStreamTap *tap, void *user)
{
    DisCapture *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    Status status = dis_stream_open_tapped(&c->stream, path, tap, user);
    if (status == STATUS_OK && !begin(c)) {
        const char *packing = dis_stream_packing(c->stream);
        status = c->status != STATUS_OK ? c->status : STATUS_UNSUPPORTED;
        if (status != STATUS_NO_MEMORY)
            log_error(
                "log: %s is not a capture (%s%s%s): pcap and pcapng files are read, as written by tcpdump -w, dumpcap "
                "or Wireshark, also compressed with gzip, zstd, bzip2 or xz; a text log (.dislog, .kdislog) is none: "
                "wrap its datagrams with text2pcap -u 3000,3000",
                path, packing ? packing : "", packing ? ": " : "", c->problem);
    }
    if (status == STATUS_OK) *out = c;
    else dis_capture_close(c);
    return status;
}

void dis_capture_close(DisCapture *c)
{
    if (!c) return;
    dis_stream_close(c->stream);
    free(c->interface);
    free(c->notes);
    free(c);
}

bool dis_capture_next(DisCapturePacket *out, DisCapture *c)
{
    bool found = false;
    if (*c->problem) return false;
    if (!c->ng) return next_record(out, c);
    while (next_block(&found, out, c))
        if (found) return true;
    return false;
}

const char *dis_capture_problem(const DisCapture *c) { return *c->problem ? c->problem : NULL; }
Status      dis_capture_status(const DisCapture *c) { return c->status; }
int         dis_capture_link(const DisCapture *c, int i) { return i >= 0 && i < c->count ? c->interface[i].link : -1; }
