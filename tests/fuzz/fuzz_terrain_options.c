/* tests/fuzz/fuzz_terrain_options.c: any octets as the options in a terrain store's header. Without a fuzzer
 * run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "terrain/import/terrain_import.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const seed[3] = {
        "elevation /data/a.tif,/data/b.tif@ellipsoid\ncover /data/c.tif:4\ncover-table nlcd\norigin 47.5,-122\nsize 12x16\n",
        "surface /data/dsm\nphoto /data/rgb.tif\nvertical geoid\nspacing 0.5\nhorizon 50\ncanopy-height /data/lcp.tif:6\n",
        "elevation /data/a.nc@part=z@down@nodata=-9999@srs=EPSG:32633+5773\nunit us-ft\nsrs EPSG:6529\nnodata none\n",
    };
    return fuzz_seed_text(out, seed[index % 3]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char     text[8 * terrain_paths_size], again[8 * terrain_paths_size];
    TerrainOptions *o = malloc(2 * sizeof *o);
    char           *input = malloc(size + 1);
    const char     *why;
    int             line;
    if (!o || !input) abort();
    memcpy(input, data, size);
    input[size] = 0;
    if (terrain_options_parse(o, &why, &line, input)) {
        if (terrain_options_fault(o) || !(o->horizon_km >= 1 && o->horizon_km <= 400)) abort();
        for (int c = 0; c < 2; c++)
            if (!(o->size_km[c] >= 0 && o->size_km[c] <= 1000) || fabs(o->origin_deg[c]) > 360) abort();
        /* what is written is read back as the same */
        if (terrain_options_text(text, sizeof text, o)) {
            if (!terrain_options_parse(o + 1, &why, &line, text) || !terrain_options_text(again, sizeof again, o + 1) ||
                strcmp(text, again) != 0)
                abort();
        }
    } else if (!why || line < 0) abort();
    free(o);
    free(input);
    return 0;
}
