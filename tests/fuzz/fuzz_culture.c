/* tests/fuzz/fuzz_culture.c: any octets as values of attributes, as tags of a feature, as a table of trees, and as what
 * the reader of vectors sends. Without a fuzzer run_corpus.c drives it. */
#include "tests/fuzz/fuzz_seed.h"

#include "terrain/elevation/raster_child.h"
#include "terrain/from_files/culture_import_private.h"

#include <stdlib.h>

const int fuzz_rounds = 20000;

/* The first octet says what the others are. */
enum { OF_VALUE, OF_TAGS, OF_TREES, OF_REPLY, KINDS };

static size_t seed_reply(uint8_t *out, uint32_t index)
{
    const double      place[][2] = {{0.22, 0.82}, {0.2201, 0.82}, {0.2201, 0.8201}};
    static const char tags[] = "building\0yes\0height\0"
                               "12 m";
    size_t            at = 0;
    for (uint32_t n = 0; n < 1 + index % 3; n++) {
        const int         shape = (int)((index + n) % WIRE_SHAPES), corners = shape == WIRE_POINT ? 1 : 3;
        const int32_t     ring[2] = {3, 0}, rings = shape == WIRE_POLYGON && index % 2;
        const size_t      inner = rings ? 16 * 3 + sizeof ring : 0;
        const WireFeature w = {.octets = (uint32_t)(sizeof w + 16 * (size_t)corners + inner + 24),
                               .shape = shape,
                               .corners = corners,
                               .tags = 2,
                               .texts = sizeof tags,
                               .number = n,
                               .holes = rings,
                               .rings = rings,
                               .ring_corners = 3 * rings};
        memcpy(out + at, &w, sizeof w);
        memcpy(out + at + sizeof w, place, 16 * (size_t)corners);
        uint8_t *to = out + at + sizeof w + 16 * (size_t)corners;
        if (rings) memcpy(to, place, 16 * 3), memcpy(to + 16 * 3, ring, sizeof ring);
        memset(to + inner, 0, 24);
        memcpy(to + inner, tags, sizeof tags);
        at += w.octets;
    }
    return at;
}

size_t fuzz_seed(uint8_t *out, uint32_t index)
{
    static const char *const value[] = {"39'6\"",
                                        "3,5 m",
                                        "12.5 ft",
                                        "NNW",
                                        "1e3",
                                        "\"a\"=>\"b\",\"c\"=>\"d \\\"e\\\"\"",
                                        "{\"height\": 12.5, \"building\": \"yes\"}"};
    static const char *const tags[] = {
        "building=house|building:levels=2|roof:shape=hipped|roof:direction=SW|height=9 m",
        "highway=primary|lanes=3|width=9,5|surface=asphalt|bridge=yes",
        "other_tags=\"natural\"=>\"tree\",\"species\"=>\"Quercus robur\",\"height\"=>\"20\"",
        "fclass=building|type=garage|code=1500|building_l=3|measuredHe=7.5"};
    static const char *const trees[] = {"lat,lon,kind,height_m,marked\n47.1,13.2,pine,12,yes\n",
                                        "x_m,y_m\n1,2\n-3,4\n"};
    const uint32_t           n = index / KINDS;
    out[0] = (uint8_t)(index % KINDS);
    switch (index % KINDS) {
    case OF_VALUE:
        return 1 + fuzz_seed_text(out + 1, value[n % 7]);
    case OF_TAGS:
        return 1 + fuzz_seed_text(out + 1, tags[n % 4]);
    case OF_TREES:
        return 1 + fuzz_seed_text(out + 1, trees[n % 2]);
    default:
        return 1 + seed_reply(out + 1, n);
    }
}

static const CultureRules *rules(void)
{
    static CultureRules read;
    if (read.count == 0 && culture_rules_open(&read, NULL) != STATUS_OK) abort();
    return &read;
}

/* A building of whatever the tags say is one that culture takes. */
static void make(int tags, const char *const *name, const char *const *value)
{
    static const double p[4][2] = {{0, 0}, {12, 0}, {12, 9}, {0, 9}};
    CultureFacts        f;
    Culture             c = {0};
    Building            b;
    HeightFrom          from;
    int                 mended = 0;
    culture_facts(&f, rules(), tags, name, value);
    if (f.use >= BUILDING_USES || f.roof >= ROOF_SHAPES || f.wall >= FABRICS || f.cover >= FABRICS ||
        f.plant >= PLANT_STANDING || f.ground >= SURFACE_COUNT)
        abort();
    culture_building_make(&b, &from, &mended, &f, p, 4, 108, false);
    if (from >= HEIGHTS_FROM || b.levels < 1 || culture_add_building(&c, &b, p, 4) != STATUS_OK || c.buildings != 1)
        abort();
    culture_free(&c);
}

static void read_value(const char *text)
{
    char        name[culture_text_size], value[culture_text_size];
    double      m = 5, number = 5, rad = 5;
    const char *at = text, *before = text;
    if (!culture_metres(&m, text) && m != 5) abort();
    if (!culture_number(&number, text) && number != 5) abort();
    if (!culture_direction(&rad, text) ? rad != 5 : !(rad >= 0 && rad <= 6.2832)) abort();
    if (!isfinite(m) || !isfinite(number)) abort();
    for (; culture_pair(name, value, &at); before = at)
        if (at <= before || strlen(name) >= sizeof name || strlen(value) >= sizeof value) abort();
    const char *keys[] = {"height", "roof:direction", "other_tags", "building"}, *values[] = {text, text, text, text};
    make(4, keys, values);
}

static void read_tags(char *text)
{
    const char *name[32], *value[32];
    int         count = 0;
    for (char *at = text; at && *at && count < 32;) {
        char *next = strsep(&at, "|"), *equals = strpbrk(next, "=");
        if (!equals) continue;
        *equals = 0;
        name[count] = next, value[count++] = equals + 1;
    }
    make(count, name, value);
}

static void read_trees(const uint8_t *data, size_t size)
{
    static const LocalFrame frame = {.origin_ecef = {6378137, 0, 0}, .r_ecef_from_enu = {0, 0, 1, 1, 0, 0, 0, 1, 0}};
    char                    path[fuzz_path_size];
    Culture                 c = {0};
    CultureReport           r = {0};
    const int               file = fuzz_file(path, data, size);
    if (file < 0) return;
    if (culture_trees_read(&c, &r, &(CultureFiles){.trees = path, .frame = &frame, .half_m = 1e5}) == STATUS_OK)
        for (int n = 0; n < c.trees; n++)
            if (!(fabs(c.tree[n].x_m) <= 1e5) || c.tree[n].kind >= PLANT_STANDING || !(c.tree[n].height_m <= 100))
                abort();
    culture_free(&c);
    close(file);
}

static void read_reply(const uint8_t *data, size_t size)
{
    uint8_t   *copy = aligned_alloc(64, (size + 64) / 64 * 64);
    VectorPart part;
    size_t     at = 0, before = 0;
    if (!copy) abort();
    memcpy(copy, data, size);
    for (; vector_part_read(&part, &at, copy, size); before = at) {
        double sum = 0;
        if (at <= before || at > size) abort();
        for (int k = 0; k < part.corners; k++) sum += part.lon_lat_rad[k][0] + part.lon_lat_rad[k][1];
        if (sum == 1e-300) abort(); /* so that every place is read */
        make(part.tags, part.name, part.value);
    }
    free(copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    log_suppress(true);
    char *text = malloc(size);
    if (!text) abort();
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    switch (data[0] % KINDS) {
    case OF_VALUE:
        read_value(text);
        break;
    case OF_TAGS:
        read_tags(text);
        break;
    case OF_TREES:
        read_trees(data + 1, size - 1);
        break;
    default:
        read_reply(data + 1, size - 1);
    }
    free(text);
    return 0;
}
