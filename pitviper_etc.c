/* pitviper_etc.c: paths of the tables: the user's own first, then those of the program. */
#include "pitviper.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Of an installation that was moved, or made with another --prefix: BIN/../share/pitviper. Empty: not known. */
static void share_beside_program(char *out, size_t out_size)
{
    const ssize_t length = readlink("/proc/self/exe", out, out_size - 1);
    out[length > 0 ? length : 0] = 0;
    for (int i = 0; i < 2; i++) { /* the program's name, and bin */
        char *slash = strrchr(out, '/');
        if (slash) *slash = 0;
    }
    const size_t n = strlen(out);
    if (snprintf(out + n, out_size - n, "/share/pitviper") >= (int)(out_size - n)) *out = 0;
}

static bool join(char *out, size_t out_size, const char *folder, const char *name)
{
    const size_t n = strlen(folder), m = strlen(name);
    if (n + 1 + m >= out_size) return false;
    memcpy(out, folder, n);
    out[n] = '/';
    memcpy(out + n + 1, name, m + 1);
    return true;
}

bool etc_path(char *out, size_t out_size, const char *name)
{
    char        beside[4096];
    const char *from_environment = getenv("PITVIPER_ETC");
    if (from_environment) return join(out, out_size, from_environment, name);
    share_beside_program(beside, sizeof beside);
    const char *const folders[] = {beside, PITVIPER_ETC_DIR, PITVIPER_ETC_INSTALLED};
    bool              fits      = false;
    for (int i = 0; i < 3; i++) {
        fits = join(out, out_size, folders[i], name);
        if (fits && access(out, R_OK) == 0) break;
    }
    return fits;
}

bool etc_is_complete(void)
{
    static const char *const needed[] = {"catalog.csv", "materials.csv", "surfaces.csv", "ground_heat.csv", "ground_detail.csv",
                                         "heat.csv", "effects.csv", "sensors.csv", "channels.csv", "atmosphere/bands.csv"};
    char   path[4096], beside[4096], missing[256] = "";
    size_t n = 0;
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++)
        if (!etc_path(path, sizeof path, needed[i]) || access(path, R_OK) != 0)
            n += (size_t)snprintf(missing + n, sizeof missing - n, "%s%s", n ? ", " : "", needed[i]);
    if (n == 0) return true;
    const char *from_environment = getenv("PITVIPER_ETC");
    if (from_environment) {
        log_error("tables are missing in %s (PITVIPER_ETC): %s; name a folder that has them all, or unset PITVIPER_ETC",
                  from_environment, missing);
        return false;
    }
    share_beside_program(beside, sizeof beside);
    log_error("the program's tables are missing: %s; looked in %s, %s and %s", missing, beside, PITVIPER_ETC_DIR,
              PITVIPER_ETC_INSTALLED);
    log_error("next: install the whole (`cmake --install BUILD --prefix DIR`) and run DIR/bin/pitviper, or copy "
              "share/pitviper beside the program's folder, or set PITVIPER_ETC to the folder etc of the sources");
    return false;
}

/* ---- the user's own ------------------------------------------------------------------------- */

static struct Own {
    const char *name;
    char        path[4096];
} own[] = {{"catalog.csv", ""}, {"materials.csv", ""}, {"sensors.csv", ""}};

bool etc_own_set(const char *name, const char *path)
{
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (strcmp(own[i].name, name) == 0)
            return snprintf(own[i].path, sizeof own[i].path, "%s", path ? path : "") < (int)sizeof own[i].path;
    return false;
}

const char *etc_own(const char *name)
{
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (strcmp(own[i].name, name) == 0 && *own[i].path) return own[i].path;
    return NULL;
}
