/* dis/log_file.h: octets of a large log that stay on disk: in its file, or, where that is compressed or a pipe, in a scratch
 * file without a name. A few windows of it are in memory. */
#ifndef DIS_LOG_FILE_H
#define DIS_LOG_FILE_H

#include "pitviper.h"

typedef struct DisLogFile DisLogFile;

enum { dis_log_file_most = 65536 }; /* octets of one look-up; a datagram has fewer */

/* file: descriptor of the log, which is duplicated. path: for messages. */
Status dis_log_file_create(DisLogFile **out, int file, const char *path);
void   dis_log_file_destroy(DisLogFile *file);

/* Puts octets into the scratch file, in $TMPDIR or /tmp; *at is their place. STATUS_IO, logged. */
Status dis_log_file_keep(uint64_t *at, DisLogFile *file, const uint8_t *bytes, size_t octets);
/* Octets at a place: an offset in the log, or of dis_log_file_keep. Valid until the next call but one; one thread at a time.
 * NULL: they cannot be read any more, which is logged once. */
const uint8_t *dis_log_file_octets(DisLogFile *file, uint64_t at, size_t octets);
bool           dis_log_file_failed(const DisLogFile *file);

#endif
