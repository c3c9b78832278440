/* tests/room_tests.c: the tests of one room: ROOM_tests test_NAME runs one file's. The list is tests/CMakeLists.txt's.
 */
#include <stdio.h>
#include <string.h>

#define X(name) int name##_main(void);
ROOM_TESTS
#undef X

#define X(name) {#name, name##_main},
static const struct {
    const char *name;
    int (*run)(void);
} tests[] = {ROOM_TESTS};

int main(int argc, char **argv)
{
    const int count = (int)(sizeof tests / sizeof *tests);
    for (int i = 0; argc == 2 && i < count; i++)
        if (strcmp(tests[i].name, argv[1]) == 0) return tests[i].run();
    fprintf(stderr, "usage: %s TEST; TEST is one of:\n", argv[0]);
    for (int i = 0; i < count; i++) fprintf(stderr, "  %s\n", tests[i].name);
    return 2;
}
