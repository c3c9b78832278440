/* sensor/commands/program.c: what the programs of Pitviper do with their streams, the environment and common options.
 */
#include "sensor/commands/program.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

const char program_common_help[] =
    "  -q, --quiet        only errors, warnings and requested output: no choices, progress, notices or summary\n"
    "  -v, --verbose      also the tables, settings and models read, and where the time goes\n"
    "  -h, --help         print the help of the command\n"
    "  -V, --version      print the version\n";

void program_fill_closed(void)
{
    int fd;
    while ((fd = open("/dev/null", O_RDONLY)) >= 0 && fd <= STDERR_FILENO) {
    }
    if (fd > STDERR_FILENO) close(fd);
}

bool program_tables_there(bool reads, int argc, char **argv)
{
    const char *etc = getenv("PITVIPER_ETC");
    struct stat there;
    for (int i = 1; i < argc; i++) reads &= strcmp(argv[i], "--default") != 0 && strcmp(argv[i], "--keys") != 0;
    if (!etc || (stat(etc, &there) == 0 && S_ISDIR(there.st_mode))) return !reads || etc_is_complete();
    log_error("PITVIPER_ETC: there is no folder '%s'; unset it, or name the one that holds catalog.csv", etc);
    return false;
}

/* Whether standard output is a pipe that its reader has left. */
static bool reader_has_gone(void)
{
    struct pollfd out = {.fd = STDOUT_FILENO};
    return poll(&out, 1, 0) == 1 && out.revents & POLLERR;
}

int program_printed(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return code;
    if (reader_has_gone()) return code;
    if (code == 0) log_error("cannot write the output: %s", errno ? strerror(errno) : "it is closed");
    return code ? code : 1;
}

bool program_take_verbosity(int *argc, char **argv)
{
    bool quiet = false, verbose = false, open = true;
    int  kept = 1;
    for (int i = 1; i < *argc; i++) {
        const bool q = open && (strcmp(argv[i], "-q") == 0 || strcmp(argv[i], "--quiet") == 0);
        const bool v = open && (strcmp(argv[i], "-v") == 0 || strcmp(argv[i], "--verbose") == 0);
        open &= strcmp(argv[i], "--") != 0;
        quiet |= q, verbose |= v;
        if (!q && !v) argv[kept++] = argv[i];
    }
    argv[ *argc = kept] = NULL;
    if (quiet && verbose) log_error("--quiet and --verbose exclude each other; leave one out");
    else if (quiet) log_set_level(LOG_WARN);
    else if (verbose) log_set_level(LOG_DETAIL);
    return !(quiet && verbose);
}

bool program_asks_for(const char *name, const char *letter, int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], name) == 0 || strcmp(argv[i], letter) == 0) return true;
    return false;
}
