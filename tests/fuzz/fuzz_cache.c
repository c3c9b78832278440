/* tests/fuzz/fuzz_cache.c: any octets as a file of the cache, and as the plants and woods that its checksum let pass.
 * Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "pitviper_cache.h"
#include "render/trace/plants/plants_kept.h"
#include "terrain/woods/woods_private.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char entry[sha256_text_size] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

static PlantQuad quads[PLANT_KINDS];

/* Prototypes of one quad each. */
static Plants *few_quads(void)
{
    static Plants plants;
    for (int k = 0; k < PLANT_KINDS * plant_levels; k++)
        plants.shape[k / plant_levels][k % plant_levels] =
            (PlantShape){.quads = 1, .leaves = 1, .quad = &quads[k / plant_levels]};
    return &plants;
}

/* Of three kinds, by the first octet: a file of the cache, light of prototypes, woods of 2 x 2 squares. */
size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    out[0] = (uint8_t)(index % 3);
    if (index % 3 == 0) {
        const uint64_t count = index % 97;
        memcpy(out + 1, "PVKEPT1\n", 8);
        memcpy(out + 9, entry, 64);
        memcpy(out + 73, &count, sizeof count);
        for (uint64_t i = 0; i < count; i++) out[81 + i] = (uint8_t)i;
        char sum[sha256_text_size];
        if (sha256_bytes(sum, out + 1, 80 + count) != STATUS_OK) return 1;
        memcpy(out + 81 + count, sum, 64);
        return 145 + count;
    }
    if (index % 3 == 1) {
        for (size_t k = 0; k < sizeof quads / sizeof *quads; k++) quads[k].open_up = quads[k].open_down = 0.5f;
        return 1 + plants_light_to_octets(out + 1, few_quads());
    }
    Plant    plant[3] = {{.height = 100, .kind = PLANT_BIRCH}, {.height = 900}, {.height = 1, .kind = PLANT_HEDGE}};
    uint32_t first[5] = {0, 1, 1, 2, 3};
    uint8_t  bare[4] = {0, 1, 0, 0};
    return 1 +
           woods_to_octets(
               out + 1,
               &(Woods){.nx = 2, .ny = 2, .count = 3, .first = first, .plant = plant, .bare = index % 2 ? bare : NULL});
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    if (*data % 3 == 0) {
        size_t at, count;
        if (cache_entry_read(&at, &count, entry, data + 1, size - 1) && at + count > size - 1) abort();
    } else if (*data % 3 == 1) {
        if (plants_light_from_octets(few_quads(), data + 1, size - 1) != STATUS_OK) return 0;
        for (size_t k = 0; k < sizeof quads / sizeof *quads; k++)
            if (!(quads[k].open_up >= 0 && quads[k].open_up <= 1 && quads[k].open_down >= 0 && quads[k].open_down <= 1))
                abort();
    } else {
        Woods woods = {.nx = 2, .ny = 2};
        if (woods_from_octets(&woods, data + 1, size - 1) == STATUS_OK && woods_to_octets(NULL, &woods) != size - 1)
            abort();
        free(woods.first), free(woods.plant), free(woods.bare);
    }
    return 0;
}
