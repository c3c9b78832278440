/* tests/fuzz/fuzz_store.c: any octets as a terrain store: opened, and its ground looked at where it is accepted.
 * Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "terrain/store/store_format_private.h"

#include <stdlib.h>

const int fuzz_rounds = 6000;

/* Two levels of a tile each, with classes, a photograph, canopy and a crown. */
static size_t small_store(uint8_t *out)
{
    const StorePlan plan = {.origin = {0.5, 1, 0},
                            .level_count = 2,
                            .level = {{.nx = 17, .ny = 17, .x0_m = -8, .y0_m = -8, .spacing_m = 1, .seam_shift = -1},
                                      {.nx = 9, .ny = 9, .x0_m = -32, .y0_m = -32, .spacing_m = 8, .seam_shift = -1}},
                            .surface = {{16, 16, -8, -8, 1}},
                            .albedo = {16, 16, -8, -8, 1},
                            .canopy_height = {4, 4, -8, -8, 4},
                            .options = "--out x",
                            .crs = "EPSG:4326"};
    const Crown     crown = {1, 2, 3, 4};
    uint8_t         octets[4 * 16 * 16];
    float           z_m[17 * 17];
    char            path[temp_path_size];
    StoreWriter    *w;
    if (!temp_file(path, ".store") || store_writer_create(&w, path, &plan, NULL) != STATUS_OK) abort();
    for (size_t n = 0; n < sizeof octets; n++) octets[n] = (uint8_t)(1 + n % 9);
    for (int n = 0; n < 17 * 17; n++) z_m[n] = (float)(n % 29) * 0.37f;
    if (store_write_posts(w, 1, 9, z_m) != STATUS_OK || store_write_posts(w, 0, 17, z_m) != STATUS_OK ||
        store_write_surface(w, 0, 16, octets) != STATUS_OK || store_write_albedo(w, 16, octets) != STATUS_OK ||
        store_write_canopy_height(w, 4, octets) != STATUS_OK || store_write_crowns(w, 1, &crown) != STATUS_OK ||
        store_writer_finish(w, 1, NULL) != STATUS_OK)
        abort();
    FILE        *from = fopen(path, "rb");
    const size_t size = from ? fread(out, 1, fuzz_seed_octets, from) : 0;
    if (!from || fclose(from) != 0 || size == 0 || size == fuzz_seed_octets) abort();
    unlink(path);
    return size;
}

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static uint8_t store[fuzz_seed_octets];
    static size_t  size;
    (void)index;
    if (!size) size = small_store(store);
    memcpy(out, store, size);
    return size;
}

static void look(const uint8_t *data, size_t size)
{
    char         path[fuzz_path_size], which[64];
    const int    file = fuzz_file(path, data, size);
    TerrainStore store;
    Landscape    landscape;
    if (file < 0) return;
    free(store_recall(path));
    if (store_open(&store, path) == STATUS_OK) {
        StorePart part[store_sections_most];
        double    sum = 0;
        if (store_parts(part, &store) > store_sections_most || store.octets != size) abort();
        store_sources(&store, which, sizeof which);
        for (uint64_t k = 0; k < store.crown_count; k++) sum += store.crown[k].height_m > 0;
        if (!(sum >= 0)) abort();
        store_close(&store);
    }
    if (store_open_landscape(&landscape, path, 1) == STATUS_OK) {
        float factor[albedo_channels];
        for (int k = -40; k <= 40; k += 5) {
            if (isinf(elevation_height(&landscape.elevation, k, 0.3 * k, NULL))) abort();
            if (landscape_surface(&landscape, k, 0.3 * k) >= SURFACE_COUNT) abort();
            landscape_albedo(factor, &landscape, SURFACE_GRASS, k, 0.3 * k, 1 + k * k);
        }
        landscape_destroy(&landscape);
    }
    close(file);
}

/* As it is, and with the checksum that its octets should have, which hides nothing then. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    log_set_level((LogLevel)(LOG_ERROR + 1));
    look(data, size);
    if (size < sizeof(StoreHeader)) return 0;
    StoreHeader *h = malloc(size);
    if (!h) return 0;
    memcpy(h, data, size);
    memcpy(h->magic, store_magic, sizeof h->magic);
    h->file_octets = size;
    if (h->header_octets >= sizeof *h && h->header_octets <= size) {
        h->checksum = store_checksum(h);
        look((const uint8_t *)h, size);
    }
    free(h);
    return 0;
}
