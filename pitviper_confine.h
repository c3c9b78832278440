/* pitviper_confine.h: takes from a process what a reader of other people's files has no need of, before it opens the
 * first: the network, other programs and processes, writing, files elsewhere, memory without end.
 *
 * What is refused fails with an error, so that the library that asked says so; the process is not ended. None of it can
 * be taken back. Threads that are started later are confined alike; call these before there are others. */
#ifndef PITVIPER_CONFINE_H
#define PITVIPER_CONFINE_H

#include "pitviper.h"

enum { confine_why_size = 160 };

/* No core file, nothing written to any file, and at most more_octets of address space on top of what there is; 0: no
 * such limit. Sanitizers' shadows are terabytes of address space: under them there is none either. */
void confine_limits(uint64_t more_octets);

/* From here on only the files below these folders, and these files, can be opened, for reading alone (Landlock, links
 * followed). Names that are not there are passed over. False: this kernel has no Landlock (before Linux 5.13, or not
 * configured), or refused: why says which, and nothing is confined. */
bool confine_files(char why[confine_why_size], const char *const *readable, int count);

/* From here on only those system calls work that reading, memory, threads and time need (a seccomp filter): no socket,
 * not even a local one; no new process or program; no signal to others; no file opened for writing, made, renamed or
 * removed. False: why says what the kernel refused. */
bool confine_calls(char why[confine_why_size]);

/* From here on no socket can be made (a seccomp filter), by this process and by programs that it becomes: for programs
 * of others, which need what confine_calls refuses. Async-signal-safe but for `why`. */
bool confine_network(char why[confine_why_size]);

#endif
