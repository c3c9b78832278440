/* dis/log_stream.h: the octets of a file from its beginning on, expanded where it is compressed.
 *
 * gzip, zstd, bzip2 and xz are known by their first octets; streams that follow one another are one, zeros behind them
 * are padding, and anything else behind them is left with a warning. Memory is bounded for any file: a
 * window of at most 128 MiB (zstd) or a decoder of 256 MiB (xz), and what is expanded may be 256 times what was read,
 * and 16 MiB beyond it. */
#ifndef DIS_LOG_STREAM_H
#define DIS_LOG_STREAM_H

#include "pitviper.h"

typedef struct DisStream DisStream;

enum { dis_stream_ratio_most = 256, dis_stream_free_octets = 1 << 24 };

/* A file that cannot be opened or read, or is empty: a logged reason and the status. */
Status dis_stream_open(DisStream **out, const char *path);
/* Gets all octets of the file in order, before they are expanded; from the first on when it is given before any is read. */
typedef void DisStreamTap(void *user, const void *octets, size_t count);
Status dis_stream_open_tapped(DisStream **out, const char *path, DisStreamTap *tap, void *user);
/* Reads what is left of the file, for the tap alone. */
void   dis_stream_drain(DisStream *stream);
/* Offset in the file of what is read next; UINT64_MAX: compressed, or a pipe. */
uint64_t dis_stream_offset(const DisStream *stream);
int    dis_stream_file(const DisStream *stream); /* its descriptor */
void   dis_stream_close(DisStream *stream);

/* Fewer than requested: end of file, or an error, see dis_stream_problem. */
size_t dis_stream_read(DisStream *stream, void *out, size_t octets);
/* Reads over them; whether they were all there. */
bool   dis_stream_skip(DisStream *stream, uint64_t octets);

/* Why the octets stopped before the end; NULL: they did not. */
const char *dis_stream_problem(const DisStream *stream);
/* STATUS_OK also where the file is cut or damaged: what came before can be used. STATUS_NO_MEMORY, STATUS_IO;
 * STATUS_UNSUPPORTED: it expands to more than a capture does. */
Status      dis_stream_status(const DisStream *stream);
/* `gzip`, `zstd`, `bzip2`, `xz`; NULL: not compressed. */
const char *dis_stream_packing(const DisStream *stream);

#endif
