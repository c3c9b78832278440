/* tests/fuzz/fuzz_obj.c: any octets as an OBJ file made plain, and as the texts in which a unit is looked for. Made
 * plain again nothing changes. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "entities/import/reader_private.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

static const char *const seed[4] = {
    "# units: mm\nmtllib a.mtl\no a\nv .6 -1 0\nv -.6e1 +.5 1.e-3 # x\nv 1 \\\n 2 \\\r\n 3 .5 .5 .5\nvt .1\nvn 0 1 "
    "0\nusemtl\tred\nf 1/1/1 -2//-1 "
    "+03//1\r\nf 1 2 3\nl 1/1 2\rs off\ng b\ncurv 0 1\n",
    "  0\nSECTION\n  2\nHEADER\n  9\n$INSUNITS\n 70\n     4\n  0\nENDSEC\n",
    "<?xml version=\"1.0\"?><amf unit=\"inch\"><object/></amf>",
    "PK\3\4aaaaAAaaaaaaaaaaaaaaaa\x07"
    "aaaa.model<model unit=\"micron\">",
};

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    if (index % 4 != 3) return fuzz_seed_text(out, seed[index % 4]);
    const size_t octets = fuzz_seed_text(out, seed[3]);
    memset(out + 8, 0, 2); /* not packed */
    memset(out + 27, 0, 3);
    return octets;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static ReaderSaid said;
    int               lost[IMPORT_LOST_COUNT] = {0};
    char              word[24], *text = malloc(size + 1), *again;
    size_t            octets = size, more;
    if (!text) return 0;
    memcpy(text, data, size);
    static const char *const extension[] = {"dxf", "amf", "3mf"};
    for (int i = 0; i < 3; i++) {
        const double unit_m = import_stated_unit(word, extension[i], text, size);
        if (!(unit_m >= 0 && unit_m < 1e4)) abort();
    }
    const double unit_m = import_comment_unit(word, text, size);
    if (!(unit_m >= 0 && unit_m <= 1000)) abort();
    said = (ReaderSaid){0};
    if (import_obj_plain(&text, &octets, lost, &said, NULL) != STATUS_OK) {
        if (!said.error[0]) abort();
        free(text);
        return 0;
    }
    again = malloc(octets + 1);
    if (again) {
        memcpy(again, text, octets);
        more = octets;
        if (import_obj_plain(&again, &more, lost, &said, NULL) != STATUS_OK || more != octets ||
            memcmp(again, text, octets) != 0)
            abort();
    }
    free(again);
    free(text);
    return 0;
}
