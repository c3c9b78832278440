/* Libraries that are loaded when they are needed: their functions are called by name afterwards, what is missing is one
 * error with a next step, and the floating-point modes of the caller stay. */
#include "tests/check.h"

#include "pitviper_library.h"

#include <dlfcn.h>
#include <unistd.h>
#include <xmmintrin.h>

/* zlib is linked to nothing here */
const char   *zlibVersion(void);
unsigned long crc32(unsigned long crc, const unsigned char *bytes, unsigned count);
#define ZLIB(X) X(zlibVersion) X(crc32)
LIBRARY(zlib, ZLIB, "zlib", "libz.so.1", "zlib1g");

void pitviper_no_such_function(void);
#define LACKING(X) X(pitviper_no_such_function)
LIBRARY(lacking, LACKING, "zlib", "libz.so.1", "zlib1g");
void pitviper_nor_this_one(void);
#define ABSENT(X) X(pitviper_nor_this_one)
LIBRARY(absent, ABSENT, "Nothing", "libpitviper-nothing.so.7", "libnothing7");

void pitviper_broken_function(void);
#define BROKEN(X) X(pitviper_broken_function)
static char broken_path[16];
LIBRARY(broken, BROKEN, "Pictures", broken_path, "libpictures");

double fast_maths_twice(double x);
#define FAST_MATHS(X) X(fast_maths_twice)
LIBRARY(fast_maths, FAST_MATHS, "fast mathematics", PITVIPER_FAST_MATHS "1.so", NULL);

static void functions_are_called_by_name(void **state)
{
    (void)state;
    CHECK(library_load(&zlib) == STATUS_OK && library_load(&zlib) == STATUS_OK);
    CHECK(zlibVersion()[0] == '1');
    CHECK(crc32(0, (const unsigned char *)"123456789", 9) == 0xCBF43926); /* the CRC's check value */
}

static void what_is_missing_is_said(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    CHECK(library_load(&absent) == STATUS_IO);
    CHECK(strstr(check_said, "Nothing cannot be loaded: libpitviper-nothing.so.7") &&
          strstr(check_said, "apt install libnothing7"));
    CHECK(library_load(&lacking) == STATUS_IO);
    CHECK(strstr(check_said, "has no pitviper_no_such_function"));
    char path[512];
    CHECK(!library_module(path, sizeof path, "pitviper-nothing.so"));
    CHECK(strstr(check_said, "pitviper-nothing.so is missing") && strstr(check_said, "cmake --install"));

    /* a module of our own that is not one: an error of its own, since no package brings it */
    strcpy(broken_path, "/tmp/XXXXXX");
    const int file = mkstemp(broken_path);
    CHECK(file >= 0 && write(file, "\177ELF", 4) == 4 && close(file) == 0);
    CHECK(library_load(&broken) == STATUS_IO);
    CHECK(strstr(check_said, broken_path) && strstr(check_said, "install the program again") &&
          !strstr(check_said, "apt"));
    unlink(broken_path);
    log_set_sink(NULL, NULL);
}

/* Where a library was built with fast mathematics, loading it makes denormal numbers 0 in the thread that loads it. */
static void floating_point_modes_stay(void **state)
{
    (void)state;
    const unsigned modes = _mm_getcsr();
    void          *other = dlopen(PITVIPER_FAST_MATHS "2.so", RTLD_NOW);
    CHECK(other && _mm_getcsr() != modes); /* the twin: without the care of library_load they change */
    _mm_setcsr(modes);
    CHECK(library_load(&fast_maths) == STATUS_OK);
    CHECK(_mm_getcsr() == modes);
    CHECK(fast_maths_twice(21) == 42);
    dlclose(other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(functions_are_called_by_name),
        cmocka_unit_test(what_is_missing_is_said),
        cmocka_unit_test(floating_point_modes_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
