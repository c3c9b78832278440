/* pitviper_temp.c: temporary files and folders in $TMPDIR or /tmp. */
#include "pitviper.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

static bool name_it(char out[temp_path_size], const char *ending)
{
    const char *folder = getenv("TMPDIR");
    if (!folder || !*folder) folder = "/tmp";
    if (snprintf(out, temp_path_size, "%s/pitviper-XXXXXX%s", folder, ending) < temp_path_size) return true;
    log_error("temporary: TMPDIR is longer than %d octets; set a shorter one", temp_path_size - 32);
    *out = 0;
    return false;
}

static bool made(char path[temp_path_size], bool ok)
{
    if (ok) return true;
    log_error("temporary: cannot make %s: %s; set TMPDIR to a folder that can be written", path, strerror(errno));
    *path = 0;
    return false;
}

bool temp_folder(char out[temp_path_size]) { return name_it(out, "") && made(out, mkdtemp(out) != NULL); }

bool temp_file(char out[temp_path_size], const char *ending)
{
    if (!name_it(out, ending)) return false;
    const int handle = mkstemps(out, (int)strlen(ending));
    if (handle >= 0) close(handle);
    return made(out, handle >= 0);
}
