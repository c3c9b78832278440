/* tests/check.h: the checks every test uses on top of cmocka, and where the reference data is. */
#ifndef TESTS_CHECK_H
#define TESTS_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

#include <signal.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "pitviper.h"

/* Processor time of this process, s: what a test may limit, since a busy machine does not change it. */
static inline double cpu_s(void) { return (double)clock() / CLOCKS_PER_SEC; }

/* Written as !(error <= tolerance) so that a NaN fails. */
#define CHECK_NEAR(got, want, tolerance)                                                                               \
    do {                                                                                                               \
        const double got_ = (got), want_ = (want), tolerance_ = (tolerance);                                           \
        if (!(fabs(got_ - want_) <= tolerance_))                                                                       \
            fail_msg("%s:%d: %s = %.17g, want %.17g +- %g", __FILE__, __LINE__, #got, got_, want_, tolerance_);        \
    } while (0)

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) fail_msg("%s:%d: %s", __FILE__, __LINE__, #condition);                                       \
    } while (0)

/* Reference data outside the repository: $PITVIPER_DATA, default ../shared/data; an absolute path, which means the same
 * in any file. False, and one line said, when the file is absent: the test then calls skip(). */
static inline bool reference_path(char out[512], const char *name)
{
    const char *root = getenv("PITVIPER_DATA");
    snprintf(out, 512, "%s/%s", root ? root : "../shared/data", name);
    FILE *file = fopen(out, "rb");
    if (!file) {
        printf("skipped: no reference data at %s (set PITVIPER_DATA)\n", out);
        return false;
    }
    fclose(file);
    char      *whole = realpath(out, NULL);
    const bool fits = whole && snprintf(out, 512, "%s", whole) < 512;
    free(whole);
    return fits;
}

enum { text_file_size = 64 };

/* A file that holds this text, until remove(path). */
static inline void text_file(char path[text_file_size], const char *text)
{
    strcpy(path, "/tmp/pitviper-test-XXXXXX");
    const int    file = mkstemp(path);
    const size_t octets = strlen(text);
    CHECK(file >= 0 && write(file, text, octets) == (ssize_t)octets && close(file) == 0);
}

/* Until it is undone no file of this process takes another octet, as on a full disk: EFBIG. Not while a test prints. */
static inline void check_full_disk(bool full)
{
    static struct rlimit before;
    struct rlimit        none = {0};
    if (full) {
        signal(SIGXFSZ, SIG_IGN);
        getrlimit(RLIMIT_FSIZE, &before);
        none.rlim_max = before.rlim_max;
    }
    setrlimit(RLIMIT_FSIZE, full ? &none : &before);
}

/* What was said last at warning level or above, while log_set_sink(check_listen, NULL). */
static char        check_said[1024] __attribute__((unused));
static inline void check_listen(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (level >= LOG_WARN) snprintf(check_said, sizeof check_said, "%s", line);
}

#endif
