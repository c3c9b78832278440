/* dis/capture/log_private.h: the octets of a capture file, its packets, and their datagrams; for the files of the
 * log. */
#ifndef DIS_CAPTURE_LOG_PRIVATE_H
#define DIS_CAPTURE_LOG_PRIVATE_H

#include "dis/capture/log.h"

/* ---- octets: log_stream.c ---------------------------------------------------------------------- */

/* The octets of a file from its beginning on, expanded where it is compressed.
 *
 * gzip, zstd, bzip2 and xz are known by their first octets; streams that follow one another are one, zeros behind them
 * are padding, and anything else behind them is left with a warning. Memory is bounded for any file: a
 * window of at most 128 MiB (zstd) or a decoder of 256 MiB (xz), and what is expanded may be 256 times what was read,
 * and 16 MiB beyond it. */
typedef struct DisStream DisStream;

/* A file that cannot be opened or read, or is empty: a logged reason and the status. */
Status dis_stream_open(DisStream **out, const char *path);
/* Gets all octets of the file in order, before they are expanded. It gets them from the first on when it is set before
 * any are read. */
typedef void DisStreamTap(void *user, const void *octets, size_t count);
Status       dis_stream_open_tapped(DisStream **out, const char *path, DisStreamTap *tap, void *user);
/* Reads the rest of the file, so that the tap gets all octets. */
void dis_stream_drain(DisStream *stream);
/* Offset in the file of the octets that are read next; UINT64_MAX: the file is compressed, or a pipe. */
uint64_t dis_stream_offset(const DisStream *stream);
int      dis_stream_file(const DisStream *stream); /* the file's descriptor */
void     dis_stream_close(DisStream *stream);

/* Returns fewer octets than requested at the end of the file, or after an error: see dis_stream_problem. */
size_t dis_stream_read(DisStream *stream, void *out, size_t octets);
/* Passes over octets; returns whether all of them were there. */
bool dis_stream_skip(DisStream *stream, uint64_t octets);

/* Why the octets stopped before the end of the file; NULL: they did not. */
const char *dis_stream_problem(const DisStream *stream);
/* STATUS_OK also where the file is cut or damaged, since what came before can be used. STATUS_UNSUPPORTED: it expands
 * to more than a capture does. Else STATUS_NO_MEMORY or STATUS_IO. */
Status dis_stream_status(const DisStream *stream);
/* `gzip`, `zstd`, `bzip2`, `xz`; NULL: not compressed. */
const char *dis_stream_packing(const DisStream *stream);

/* ---- packets: log_pcap.c --------------------------------------------------------------------------- */

/* The packets one after the other. pcap in either byte order, stamps in micro- or nanoseconds, and the form with longer
 * packet headers that patched libpcaps wrote. pcapng with any number of sections, each in its own byte order, and of
 * interfaces, each with its own link layer, resolution and offset of time. */
typedef struct DisCapture DisCapture;

typedef struct DisCapturePacket {
    double         capture_s; /* Unix time: dis_unix_s; no sooner than 1970, no later than 2255 */
    int            link;      /* LINKTYPE_ of its interface */
    size_t         octets;    /* octets that were captured, at most 256 KiB */
    const uint8_t *bytes;     /* valid until the next packet is read */
    uint64_t       at;        /* offset of bytes in the file; UINT64_MAX: it is compressed, or a pipe */
} DisCapturePacket;

/* Opens a capture. A file that is not one, or cannot be read, gives an error status and a logged reason. tap: as of
 * dis_stream_open_tapped, may be NULL. dis_capture_drain: reads the rest of the file for it. */
Status dis_capture_open_tapped(DisCapture **out, const char *path, DisStreamTap *tap, void *user);
void   dis_capture_drain(DisCapture *capture);
int    dis_capture_file(const DisCapture *capture); /* the file's descriptor */
void   dis_capture_close(DisCapture *capture);

/* Returns false when there are no more packets, because the file ends or because of an error: see dis_capture_problem.
 * */
bool        dis_capture_next(DisCapturePacket *out, DisCapture *capture);
const char *dis_capture_problem(const DisCapture *capture); /* NULL: the file ended as it should */
/* STATUS_OK, also where the file is cut or damaged. With any other status what was read must not be used. */
Status dis_capture_status(const DisCapture *capture);
/* Comments of its blocks of interface statistics so far, a line each; those beyond 16 MiB in all are left out. */
const char *dis_capture_notes(const DisCapture *capture);
/* The LINKTYPE_ of interface i of the present section; -1: there is no such interface. */
int dis_capture_link(const DisCapture *capture, int i);

/* ---- datagrams: log_packet.c ---------------------------------------------------------------- */

typedef struct DisPacketReader DisPacketReader;

/* Makes a reader that appends datagrams to the log, their octets to the arena or, beyond dis_log_in_memory, to
 * log->file. port: the UDP destination; dis_port_any: payloads that start with a DIS header; dis_port_default: port
 * 3000, and payloads that start with a DIS header until one to port 3000 comes. Packets without a datagram are counted
 * in the log. */
Status dis_packet_reader_create(DisPacketReader **out, DisLog *log, Arena *arena, int port);
void   dis_packet_reader_destroy(DisPacketReader *reader);

bool dis_packet_reads(int link); /* whether the link layer with this LINKTYPE_ is read */
/* Reads one packet, whose link layer dis_packet_reads. Its number is the log's counters.packets. Fails with
 * STATUS_NO_MEMORY. */
Status dis_packet_read(DisPacketReader *reader, const DisCapturePacket *packet);
/* Ends the reading; datagrams in reassembly are dropped. Returns true where the port was dis_port_default, no datagram
 * went to 3000, and other UDP was there. */
bool dis_packet_reader_end(DisPacketReader *reader);

/* ---- octets on disk: log.c --------------------------------------------------------------------- */

/* Appends octets to the scratch file, in $TMPDIR or /tmp; *at becomes their place. STATUS_IO is logged. */
Status dis_log_file_keep(uint64_t *at, DisLogFile *file, const uint8_t *bytes, size_t octets);

#endif
