/* tests/bench/machine.c: the machine and the program of a run. */
#include "tests/bench/bench_private.h"

#include "entities/import/reader_private.h"
#include "sensor/publish/images/image_file.h"

#include <gnu/libc-version.h>
#include <libgen.h>
#include <limits.h>
#include <link.h>
#include <stdlib.h>
#include <sys/utsname.h>
#include <unistd.h>

/* Finds the first line of a file that begins with key, and copies what follows its colon; without a key, all of the
 * first line. */
static void line_of(char *out, size_t out_size, const char *path, const char *key)
{
    char  line[512];
    FILE *file = fopen(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *at = line;
        if (key && strncmp(line, key, strlen(key)) != 0) continue;
        if (key && (at = strchr(line, ':'))) at += 1 + strspn(at + 1, " \t");
        if (at) snprintf(out, out_size, "%.*s", (int)strcspn(at, "\n"), at);
        break;
    }
    if (file) fclose(file);
}

typedef struct Libraries {
    char  *out;
    size_t size, used;
} Libraries;

/* The real name of a shared object ends with its version: libassimp.so.5.2.5. */
static int add_library(struct dl_phdr_info *info, size_t size, void *user)
{
    static const char *const shown[] = {"embree", "OpenImageIO", "GeographicLib", "assimp", "erfa",
                                        "pcap",   "fftw3",       "jansson",       "crypto", "yaml"};
    Libraries               *l = user;
    char                     real[PATH_MAX];
    (void)size;
    if (!info->dlpi_name || !realpath(info->dlpi_name, real)) return 0;
    const char *name = basename(real), *so = strstr(name, ".so.");
    if (!so || strncmp(name, "lib", 3) != 0) return 0;
    for (size_t k = 0; k < sizeof shown / sizeof *shown; k++) {
        if (strncmp(name + 3, shown[k], strlen(shown[k])) != 0) continue;
        const size_t left = l->size - l->used;
        const int    n = snprintf(l->out + l->used, left, ", %.*s %s", (int)(so - name - 3), name + 3, so + 4);
        if (n > 0 && (size_t)n < left) l->used += (size_t)n;
        else l->out[l->used] = 0;
        break;
    }
    return 0;
}

void bench_machine_read(BenchMachine *out)
{
    struct utsname system = {.release = "?"};
    double         load = NAN;
    *out = (BenchMachine){.processor = "unknown processor", .governor = "unknown", .cores = thread_processors()};
    line_of(out->processor, sizeof out->processor, "/proc/cpuinfo", "model name");
    line_of(out->governor, sizeof out->governor, "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", NULL);
    if (getloadavg(&load, 1) != 1) load = NAN;
    out->load = load;
    out->isa = __builtin_cpu_supports("avx512f") ? "AVX-512" : __builtin_cpu_supports("avx2") ? "AVX2" : "no AVX2";
    out->memory_gb = 1e-9 * (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    uname(&system);
    snprintf(out->system, sizeof out->system, "Linux %.60s", system.release);
    snprintf(out->compiler, sizeof out->compiler, "%s %s",
#ifdef __clang__
             "clang", __clang_version__);
#else
             "gcc", __VERSION__);
#endif
    Libraries l = {out->libraries, sizeof out->libraries, 0};
    l.used = (size_t)snprintf(l.out, l.size, "glibc %s, gdal %s", gnu_get_libc_version(), PITVIPER_GDAL_VERSION);
    if (library_load(&assimp_library) != STATUS_OK || image_read_prepare() != STATUS_OK)
        log_warn("bench: a library is missing, and so are its version and what needs it");
    dl_iterate_phdr(add_library, &l);
}

void bench_machine_line(char out[512], const BenchMachine *m)
{
    snprintf(out, 512, "%s, %d cores, %s; built for x86-64-v3 by %s; pitviper %s; load %.1f", m->processor, m->cores,
             m->isa, m->compiler, PITVIPER_VERSION, m->load);
}

double bench_memory_mb(const char *key)
{
    char   line[256];
    double kb = NAN;
    FILE  *file = fopen("/proc/self/status", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, key, strlen(key)) == 0) kb = strtod(line + strlen(key), NULL);
    if (file) fclose(file);
    return kb * 1024e-6;
}
