/* pitviper_library.h: shared libraries that are loaded when they are first needed, not when the program starts.
 *
 * OpenImageIO, GDAL, FFmpeg and assimp bring some 250 more libraries along; looking up their symbols costs every start
 * 0.15 s and 90 MB, whatever the command. A file NAME_library.c lists the functions that are called, and LIBRARY makes
 * of each a jump to an address that library_load fills in. The sources call them as ever, with the library's own
 * headers; a function that the list lacks is an undefined reference of the linker. */
#ifndef PITVIPER_LIBRARY_H
#define PITVIPER_LIBRARY_H

#include "pitviper.h"

typedef struct LibraryFunction {
    const char *name;
    const char *jump;    /* its address here */
    void      **address; /* its address in the library; NULL before */
} LibraryFunction;

typedef struct Library {
    const char            *name;    /* as users know it */
    const char            *file;    /* soname; without a slash it is looked for as the system does */
    const char            *package; /* Debian's, for the message */
    int                    count;
    const LibraryFunction *function; /* [count] */
    int                    loaded;
} Library;

/* Loads it once for the process, and for good; later calls cost a read. Call it before any of its functions, on the
 * main thread before a pool starts where that is possible: a first call takes 10 to 150 ms. It may be called by several
 * threads. The calling thread's floating-point modes stay as they were (a library built with fast mathematics sets its
 * own when it is loaded). STATUS_IO, logged with what to install, when it is missing or lacks a function. */
Status library_load(Library *library);

/* Path of a module of our own: beside the program, or in lib/pitviper of the installation. False, logged: it is not
 * there. */
bool library_module(char *out, size_t out_size, const char *name);

/* The jumps are weak, so that a test can put a function of its own in place of one. */
#define LIBRARY_JUMP(function)                                                                                         \
    __attribute__((visibility("hidden"))) void *library_address_##function;                                            \
    extern const char                           library_jump_##function[] __asm__(#function);                          \
    __asm__(".pushsection .text\n.balign 16\n.weak " #function "\n.type " #function ", @function\n" #function          \
            ":\n\tjmp *library_address_" #function "(%rip)\n.size " #function ", . - " #function "\n.popsection\n");
#define LIBRARY_ROW(function) {#function, library_jump_##function, &library_address_##function},
/* list: a macro that applies its argument to every function's name. */
#define LIBRARY(variable, list, ...)                                                                                   \
    list(LIBRARY_JUMP) static const LibraryFunction variable##_functions[] = {list(LIBRARY_ROW)};                      \
    Library variable = {__VA_ARGS__, sizeof variable##_functions / sizeof *variable##_functions, variable##_functions, \
                        0}

#endif
