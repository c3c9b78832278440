/* pitviper_file.h: opens every file from outside for reading.
 *
 * A name that a user or another file gives may be of anything: a FIFO without a writer would be waited for without end,
 * a device has no end. What is opened here is a regular file, or a pipe where the caller says that one makes sense; a
 * stop that was requested ends the wait for a pipe. A library that opens by name itself is given the name only after
 * file_is_regular. */
#ifndef PITVIPER_FILE_H
#define PITVIPER_FILE_H

#include "pitviper.h"

typedef enum FileFrom {
    FILE_FROM_DISK,  /* a regular file: what is read twice, mapped or sought in */
    FILE_FROM_SHELL, /* also a pipe that the program was started with: `<(...)`, /dev/stdin */
    FILE_FROM_PIPE,  /* also a FIFO by its name: what is read once, from beginning to end */
} FileFrom;

enum { file_why_size = 128 };

/* A descriptor, closed on exec; -1: why says what it is, or the system's reason. octets, may be NULL: of a regular
 * file; UINT64_MAX: of a pipe. */
int file_open(char why[file_why_size], uint64_t *octets, const char *path, FileFrom from);
/* The same as a stream of a regular file. */
FILE *file_open_stream(char why[file_why_size], const char *path);
/* Whether there is a regular file of that name (or a link to one) that can be read; why as above. */
bool file_is_regular(char why[file_why_size], const char *path);

/* Octets read: fewer than wanted at the end alone. -1: errno; ECANCELED: a stop was requested while a pipe was waited
 * for. */
long file_read(int file, void *out, size_t octets);
/* The same from a place in a regular file. */
long file_read_at(int file, void *out, size_t octets, uint64_t at);
/* A whole file of at most `most` octets and a 0 behind them; the caller frees it. Failures are logged as the module's:
 * STATUS_IO, STATUS_NO_MEMORY, STATUS_BAD_VALUE (larger). */
Status file_read_whole(char **out, size_t *octets, const char *module, const char *path, size_t most, FileFrom from);
/* How a wait for a pipe learns that a stop was requested; set before the first file is opened. NULL: never. */
void file_stop_when(bool (*asked)(void));
bool file_stop_asked(void);

#endif
