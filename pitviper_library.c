/* pitviper_library.c: loads a shared library and finds the functions that are called. */
#include "pitviper_library.h"

#include <dlfcn.h>
#include <elf.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xmmintrin.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* As with a library that is linked, one that is preloaded may stand in its place. In a program that is linked to the
 * library as well, such as a test, the search finds the jump itself first. */
static void *find(void *handle, const LibraryFunction *function)
{
    void *address = dlsym(RTLD_DEFAULT, function->name);
    return address && address != (const void *)function->jump ? address : dlsym(handle, function->name);
}

/* A module of our own may be broken itself, or left over from another build. */
static void refuse(const Library *library, bool module, const char *what, const char *why)
{
    if (module) log_error("%s %s: %s; its module is broken: install the program again", library->name, what, why);
    else if (library->package)
        log_error("%s %s: %s; install it: apt install %s", library->name, what, why, library->package);
    else log_error("%s %s: %s", library->name, what, why);
}

/* Of a file that was copied in part the loader would map what is not there, and reading it ends the process: the table
 * of sections, which is the last part, has to be in it. */
static bool whole(const char *file)
{
    Elf64_Ehdr  head;
    struct stat about;
    FILE       *in = fopen(file, "rbe");
    const bool  there = in && fread(&head, sizeof head, 1, in) == 1 && fstat(fileno(in), &about) == 0 &&
                       head.e_shoff <= (uint64_t)about.st_size &&
                       (uint64_t)head.e_shnum * head.e_shentsize <= (uint64_t)about.st_size - head.e_shoff;
    if (in) fclose(in);
    return there;
}

static Status load(Library *library)
{
    const bool module = strchr(library->file, '/') != NULL;
    if (module && !whole(library->file)) {
        refuse(library, true, "cannot be loaded", library->file);
        return STATUS_IO;
    }
    void *handle = dlopen(library->file, RTLD_LAZY | RTLD_GLOBAL);
    if (!handle) {
        const char *why = dlerror();
        refuse(library, module && strstr(why, library->file), "cannot be loaded", why);
        return STATUS_IO;
    }
    for (int i = 0; i < library->count; i++)
        if (!find(handle, &library->function[i])) {
            char why[1024];
            snprintf(why, sizeof why, "%s has no %s, it is another version than at the build", library->file,
                     library->function[i].name);
            refuse(library, module, "cannot be used", why);
            dlclose(handle);
            return STATUS_IO;
        }
    for (int i = 0; i < library->count; i++) *library->function[i].address = find(handle, &library->function[i]);
    return STATUS_OK;
}

Status library_load(Library *library)
{
    if (__atomic_load_n(&library->loaded, __ATOMIC_ACQUIRE)) return STATUS_OK;
    const unsigned modes = _mm_getcsr();
    Status         status = STATUS_OK;
    pthread_mutex_lock(&lock);
    if (!library->loaded) {
        status = load(library);
        if (status == STATUS_OK) __atomic_store_n(&library->loaded, 1, __ATOMIC_RELEASE);
    }
    pthread_mutex_unlock(&lock);
    _mm_setcsr(modes);
    return status;
}

bool library_module(char *out, size_t out_size, const char *name)
{
    /* installed; built; of a test, and of a mutant */
    static const char *const beside[] = {"/../lib/pitviper", "", "/..", "/../.."};
    char                     program[4096];
    const ssize_t            length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = 0;
    char *slash = strrchr(program, '/');
    if (slash) *slash = 0;
    for (int i = 0; i < 5; i++) {
        const int n = i < 4 ? snprintf(out, out_size, "%s%s/%s", program, beside[i], name)
                            : snprintf(out, out_size, "%s/%s", PITVIPER_MODULES_INSTALLED, name);
        if (n < (int)out_size && access(out, R_OK) == 0) return true;
    }
    log_error(
        "the program's module %s is missing: looked beside %s, in %s/../lib/pitviper and in %s; install the whole (`cmake "
        "--install BUILD --prefix DIR`) and run DIR/bin/pitviper, or copy lib/pitviper beside the program's folder",
        name, program, program, PITVIPER_MODULES_INSTALLED);
    return false;
}
