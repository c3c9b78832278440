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
/* Gets all octets of the file in order, before they are expanded; from the first on when it is given before any is
 * read. */
typedef void DisStreamTap(void *user, const void *octets, size_t count);
Status       dis_stream_open_tapped(DisStream **out, const char *path, DisStreamTap *tap, void *user);
/* Reads what is left of the file, for the tap alone. */
void dis_stream_drain(DisStream *stream);
/* Offset in the file of what is read next; UINT64_MAX: compressed, or a pipe. */
uint64_t dis_stream_offset(const DisStream *stream);
int      dis_stream_file(const DisStream *stream); /* its descriptor */
void     dis_stream_close(DisStream *stream);

/* Fewer than requested: end of file, or an error, see dis_stream_problem. */
size_t dis_stream_read(DisStream *stream, void *out, size_t octets);
/* Reads over them; whether they were all there. */
bool dis_stream_skip(DisStream *stream, uint64_t octets);

/* Why the octets stopped before the end; NULL: they did not. */
const char *dis_stream_problem(const DisStream *stream);
/* STATUS_OK also where the file is cut or damaged: what came before can be used. STATUS_NO_MEMORY, STATUS_IO;
 * STATUS_UNSUPPORTED: it expands to more than a capture does. */
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
    size_t         octets;    /* captured, of at most 256 KiB */
    const uint8_t *bytes;     /* until the next packet */
    uint64_t       at;        /* offset of bytes in the file; UINT64_MAX: it is compressed, or a pipe */
} DisCapturePacket;

/* A file that is no capture, or cannot be read: a logged reason and the status. tap: as dis_stream_open_tapped has it;
 * may be NULL; dis_capture_drain: reads the rest of the file for it. */
Status dis_capture_open_tapped(DisCapture **out, const char *path, DisStreamTap *tap, void *user);
void   dis_capture_drain(DisCapture *capture);
int    dis_capture_file(const DisCapture *capture); /* its descriptor */
void   dis_capture_close(DisCapture *capture);

/* False: no more, because the file ends or because of an error, see dis_capture_problem. */
bool        dis_capture_next(DisCapturePacket *out, DisCapture *capture);
const char *dis_capture_problem(const DisCapture *capture); /* NULL: the file ended as it should */
/* STATUS_OK, also where the file is cut or damaged; else what was read must not be used. */
Status dis_capture_status(const DisCapture *capture);
/* Comments of its blocks of interface statistics so far, a line each; those beyond 16 MiB in all are left out. */
const char *dis_capture_notes(const DisCapture *capture);
/* The LINKTYPE_ of interface i of the present section; -1: there is no such interface. */
int dis_capture_link(const DisCapture *capture, int i);

/* ---- datagrams: log_packet.c ---------------------------------------------------------------- */

typedef struct DisPacketReader DisPacketReader;

/* Datagrams to `port` (dis_port_any: payloads that start with a DIS header; dis_port_default: to 3000, and those while
 * there are none) are appended to the log, their octets in the arena, beyond dis_log_in_memory in log->file; packets
 * without one are counted there. */
Status dis_packet_reader_create(DisPacketReader **out, DisLog *log, Arena *arena, int port);
void   dis_packet_reader_destroy(DisPacketReader *reader);

bool dis_packet_reads(int link); /* LINKTYPE_; whether this link layer is read */
/* One packet of a link layer that is read; the log's counters.packets is its number. STATUS_NO_MEMORY. */
Status dis_packet_read(DisPacketReader *reader, const DisCapturePacket *packet);
/* There are no more: datagrams in reassembly are dropped. True: of dis_port_default, none went to 3000, and other UDP
 * was there. */
bool dis_packet_reader_end(DisPacketReader *reader);

/* ---- octets on disk: log.c --------------------------------------------------------------------- */

/* Puts octets into the scratch file, in $TMPDIR or /tmp; *at is their place. STATUS_IO, logged. */
Status dis_log_file_keep(uint64_t *at, DisLogFile *file, const uint8_t *bytes, size_t octets);

#endif
