/* tests/dis/make_capture.h: captures made by hand, layer by layer, in memory and then in a temporary file. */
#ifndef TESTS_DIS_MAKE_CAPTURE_H
#define TESTS_DIS_MAKE_CAPTURE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A packet grows at its end; layers are put in from the outside in, lengths are patched afterwards. */
typedef struct Bytes {
    uint8_t at[1 << 20];
    size_t  count;
} Bytes;

static inline void put(Bytes *b, const void *from, size_t octets)
{
    memcpy(b->at + b->count, from, octets);
    b->count += octets;
}

static inline void put_u8(Bytes *b, unsigned v) { b->at[b->count++] = (uint8_t)v; }

static inline void put_be16(Bytes *b, unsigned v)
{
    put_u8(b, v >> 8);
    put_u8(b, v);
}

static inline void put_be32(Bytes *b, uint32_t v)
{
    put_be16(b, v >> 16);
    put_be16(b, v & 0xFFFF);
}

static inline void put_zeros(Bytes *b, size_t octets)
{
    memset(b->at + b->count, 0, octets);
    b->count += octets;
}

/* In the byte order of the capture file: little unless `big`. */
static inline void put_file32(Bytes *b, uint32_t v, bool big)
{
    if (big) {
        put_be32(b, v);
    } else {
        for (int i = 0; i < 4; i++) put_u8(b, v >> 8 * i & 255);
    }
}

static inline void put_file16(Bytes *b, unsigned v, bool big)
{
    put_u8(b, big ? v >> 8 : v & 255);
    put_u8(b, big ? v & 255 : v >> 8);
}

/* ---- file formats ---------------------------------------------------------------------------------- */

static inline void pcap_begin(Bytes *file, uint32_t link, bool nanoseconds, bool big)
{
    file->count = 0;
    put_file32(file, nanoseconds ? 0xA1B23C4D : 0xA1B2C3D4, big);
    put_file16(file, 2, big);
    put_file16(file, 4, big);
    put_zeros(file, 8);
    put_file32(file, 262144, big);
    put_file32(file, link, big);
}

static inline void pcap_packet(Bytes *file, uint32_t s, uint32_t fraction, const Bytes *packet, size_t captured,
                               bool big)
{
    put_file32(file, s, big);
    put_file32(file, fraction, big);
    put_file32(file, (uint32_t)captured, big);
    put_file32(file, (uint32_t)packet->count, big);
    put(file, packet->at, captured);
}

/* pcapng: one section, one interface with nanosecond stamps. */
static inline void pcapng_begin(Bytes *file, uint16_t link)
{
    file->count = 0;
    put_file32(file, 0x0A0D0D0A, false); /* section header block */
    put_file32(file, 28, false);
    put_file32(file, 0x1A2B3C4D, false);
    put_file16(file, 1, false);
    put_file16(file, 0, false);
    put_file32(file, 0xFFFFFFFF, false);
    put_file32(file, 0xFFFFFFFF, false);
    put_file32(file, 28, false);
    put_file32(file, 1, false); /* interface description block */
    put_file32(file, 32, false);
    put_file16(file, link, false);
    put_file16(file, 0, false);
    put_file32(file, 0, false);
    put_file16(file, 9, false); /* if_tsresol: 10^-9 s */
    put_file16(file, 1, false);
    put_file32(file, 9, false);
    put_file32(file, 0, false); /* end of options */
    put_file32(file, 32, false);
}

static inline void pcapng_packet(Bytes *file, uint64_t ns, const Bytes *packet)
{
    const size_t   pad = -packet->count & 3;
    const uint32_t length = (uint32_t)(32 + packet->count + pad);
    put_file32(file, 6, false); /* enhanced packet block */
    put_file32(file, length, false);
    put_file32(file, 0, false);
    put_file32(file, (uint32_t)(ns >> 32), false);
    put_file32(file, (uint32_t)ns, false);
    put_file32(file, (uint32_t)packet->count, false);
    put_file32(file, (uint32_t)packet->count, false);
    put(file, packet->at, packet->count);
    put_zeros(file, pad);
    put_file32(file, length, false);
}

/* Writes a temporary file; its name, to be removed by the caller, lands in `path`. */
static inline bool write_file(char path[64], const Bytes *file)
{
    strcpy(path, "/tmp/pitviper_capture_XXXXXX");
    const int fd = mkstemp(path);
    if (fd < 0) return false;
    const bool whole = write(fd, file->at, file->count) == (ssize_t)file->count;
    return close(fd) == 0 && whole;
}

/* ---- layers ------------------------------------------------------------------------------------------ */

static inline void put_ethernet(Bytes *b, unsigned type)
{
    put_zeros(b, 12);
    put_be16(b, type);
}

/* Header of 20 octets plus options; payload octets follow. flags_offset: as in the header. */
static inline void put_ipv4(Bytes *b, unsigned protocol, size_t payload, unsigned id, unsigned flags_offset,
                            int options)
{
    put_u8(b, 0x45 + (unsigned)options / 4);
    put_u8(b, 0);
    put_be16(b, (unsigned)(20 + options + (int)payload));
    put_be16(b, id);
    put_be16(b, flags_offset);
    put_u8(b, 64);
    put_u8(b, protocol);
    put_be16(b, 0);
    put_be32(b, 0x7F000001);
    put_be32(b, 0x7FFFFFFF);
    put_zeros(b, (size_t)options);
}

static inline void put_ipv6(Bytes *b, unsigned next, size_t payload)
{
    put_be32(b, 0x60000000);
    put_be16(b, (unsigned)payload);
    put_u8(b, next);
    put_u8(b, 64);
    for (int i = 0; i < 32; i++) put_u8(b, (unsigned)i);
}

static inline void put_udp(Bytes *b, unsigned port, const void *payload, size_t octets)
{
    put_be16(b, 50000);
    put_be16(b, port);
    put_be16(b, (unsigned)(8 + octets));
    put_be16(b, 0);
    put(b, payload, octets);
}

#endif
