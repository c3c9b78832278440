/* tests/fuzz/write_seeds.c: a fuzzer's own seeds as files, for its corpus: with FUZZ_WRITE_SEEDS=FOLDER in the
 * environment they are written there and the program ends. */
#include "tests/fuzz/fuzz_seed.h"

#include <stdlib.h>

enum { seeds_written = 64 };

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    static uint8_t data[fuzz_seed_octets];
    const char    *folder = getenv("FUZZ_WRITE_SEEDS");
    (void)argc;
    (void)argv;
    for (uint32_t i = 0; folder && i < seeds_written; i++) {
        char         path[4096];
        const size_t size = fuzz_seed(data, i);
        snprintf(path, sizeof path, "%s/seed%02u", folder, i);
        FILE *file = fopen(path, "wb");
        if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0) {
            perror(path);
            exit(1);
        }
    }
    if (folder) exit(0);
    return 0;
}
