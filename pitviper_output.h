/* pitviper_output.h: files and folders that are written. Every file that a user sees is opened here.
 *
 * A symbolic link in the last part of a file's name is not followed, and below a folder that is held (output_hold) none
 * in any part: a link that lies among the products of an earlier run is refused. The folders that the user names may be
 * links. What is opened is a regular file, empty and locked until it is closed: of two processes that write one file
 * the second is refused.
 *
 * Functions that return an int or a pointer say why they failed in errno, for output_reason. */
#ifndef PITVIPER_OUTPUT_H
#define PITVIPER_OUTPUT_H

#include "pitviper.h"

#include <dirent.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    OUTPUT_STREAM = 1, /* also a pipe, a device, /dev/stdout or another open descriptor: for a name that a user gives */
    OUTPUT_READ = 2,   /* open for reading too */
    OUTPUT_KEEP = 4,   /* the file's contents stay for now */
    OUTPUT_FOLDER = 8, /* only for output_check: a folder, which output_folder would make */
};

/* A descriptor; -1: failed. */
int   output_open(const char *path, unsigned how);
FILE *output_file(const char *path, unsigned how);

/* A file that has its name only when it is whole: begin opens PATH.part, end closes it and renames it to PATH, or
 * removes it when a write or the closing failed; abandon removes it. A stream is written directly. end is false when it
 * failed. */
FILE *output_begin(const char *path, unsigned how);
bool  output_end(FILE *file, const char *path);
void  output_abandon(FILE *file, const char *path);

/* Whether output_begin, output_open or output_folder would fail for what is there now: a link, no folder, no
 * permission. 0: they would not; nothing is created. */
int output_check(const char *path, unsigned how);

/* The ending of a file's name with its point, `.png`; empty: it has none, or is that of a stream. */
const char *output_ending(const char *path);

/* As mkdir -p, rename, remove (of a file or an empty folder) and opendir. */
int  output_folder(const char *path);
int  output_rename(const char *from, const char *to);
int  output_remove(const char *path);
DIR *output_list(const char *path);
/* Removes a regular file that output_open made and no process has open since: what a killed writer left. False: it is
 * being written, it is none, or it cannot be removed. */
bool output_remove_left(const char *path);

/* strerror, in words that fit a file that is written. */
const char *output_reason(int error);

/* Locks a folder that exists for this process, until release or its end; may be repeated. STATUS_IO, logged as the
 * module's: another process holds it. Not while files below it are opened by other threads. */
Status output_hold(const char *module, const char *folder);
void   output_release(const char *folder);

#ifdef __cplusplus
}
#endif
#endif
