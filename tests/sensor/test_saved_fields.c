/* tests/sensor/test_saved_fields.c: fields of a frame file: one line writes and reads each, and a list of records takes
 * its least size from them. */
#include "tests/check.h"

#include "sensor/verify/saved_frame/chunks_private.h"

typedef struct Toy {
    int    number;
    double metres;
    float  warmth[2];
    char   name[6];
    bool   new_flag; /* of files of version 4 */
} Toy;

typedef struct Toys {
    const char *title;
    int         count;
    Toy        *toy;
} Toys;

enum { toy_octets = 4 + 8 + 2 * 4 + 6, most_toys = 1000 };

static void toy_fields(Fields *f, void *record)
{
    Toy *t = record;
    field_int(f, "number", &t->number, -3, 7);
    field_real(f, "metres", &t->metres, 0, 100);
    field_floats(f, "warmth", t->warmth, 2, -1, 1);
    field_chars(f, "name", t->name, sizeof t->name);
    if (f->version >= 4) field_bool(f, "flag", &t->new_flag); /* a new field is such a line */
    else t->new_flag = true;
}

static void fields(Fields *f, Toys *toys)
{
    field_text(f, &toys->title, 20);
    field_list(f, &toys->count, (void **)&toys->toy, sizeof *toys->toy, most_toys, toy_fields);
}

static ByteSink written(const Toys *toys, int version)
{
    ByteSink sink = {0};
    Toys     copy = *toys;
    fields(&(Fields){.to = &sink, .version = version}, &copy);
    return sink;
}

/* What is read of these octets; a fault, or that they end too early, is in *f. */
static Toys read_back(Fields *f, ByteSource *from, const uint8_t *octets, size_t count, int version, Arena *arena)
{
    Toys toys = {0};
    *from = (ByteSource){octets, octets + count, false};
    *f = (Fields){.from = from, .version = version, .arena = arena};
    fields(f, &toys);
    return toys;
}

static void what_is_written_is_read(void **state)
{
    (void)state;
    Toy        some[2] = {{-3, 12.25, {0.5f, -1}, "one", false}, {7, 0, {1, 0.125f}, "other", true}};
    const Toys toys = {"a title", 2, some};
    Arena     *arena = arena_create();
    Fields     f;
    ByteSource from;
    for (int version = 3; version <= 4; version++) {
        const int octets = toy_octets + (version >= 4 ? 4 : 0);
        ByteSink  sink = written(&toys, version);
        assert_int_equal(sink.count, 4 + strlen(toys.title) + 4 + 2 * (size_t)octets);
        const Toys got = read_back(&f, &from, sink.bytes, sink.count, version, arena);
        CHECK(fields_good(&f) && from.at == from.end && got.count == 2);
        assert_string_equal(got.title, "a title");
        for (int i = 0; i < 2; i++) {
            const Toy *t = &got.toy[i];
            CHECK(t->number == some[i].number && t->metres == some[i].metres);
            CHECK(memcmp(t->warmth, some[i].warmth, sizeof t->warmth) == 0 && strcmp(t->name, some[i].name) == 0);
            CHECK(t->new_flag == (version >= 4 ? some[i].new_flag : true));
        }
        /* fewer octets: it is said that they end too early, of no field that it is out of range */
        for (size_t less = 1; less < sink.count; less++) {
            const Toys part = read_back(&f, &from, sink.bytes, sink.count - less, version, arena);
            CHECK(!fields_good(&f) && !f.fault && part.count == 0 && !part.toy);
        }
        sink_free(&sink);
    }
    arena_destroy(arena);
}

/* Each field out of its range is named; the twin, in its range, is not. */
static void what_is_out_of_range_is_named(void **state)
{
    (void)state;
    Arena *arena = arena_create();
    static const struct {
        Toy         toy;
        const char *fault;
    } cases[] = {{{-4, 1, {0}, "", false}, "number"},
                 {{8, 1, {0}, "", false}, "number"},
                 {{0, NAN, {0}, "", false}, "metres"},
                 {{0, 100.5, {0}, "", false}, "metres"},
                 {{0, 1, {0, 1.5f}, "", false}, "warmth"},
                 {{0, 1, {NAN, 0}, "", false}, "warmth"},
                 {{0, 1, {0}, {'a', 'b', 'c', 'd', 'e', 'f'}, false}, "name"},
                 {{7, 100, {1, -1}, "abcde", true}, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Toy        toy = cases[i].toy;
        Fields     f;
        ByteSource from;
        ByteSink   sink = written(&(Toys){"", 1, &toy}, 4);
        read_back(&f, &from, sink.bytes, sink.count, 4, arena);
        if (cases[i].fault) assert_string_equal(f.fault, cases[i].fault);
        else CHECK(fields_good(&f));
        sink_free(&sink);
    }
    arena_destroy(arena);
}

/* Counts that no file of this size can have, and more than the list may have, are refused before there is memory for
 * them. */
static void a_count_is_no_more_than_the_octets_hold(void **state)
{
    (void)state;
    Arena         *arena = arena_create();
    Fields         f;
    ByteSource     from;
    static uint8_t octets[8 + (most_toys + 1) * (toy_octets + 4)];
    for (uint32_t count = 0; count < 4; count++)
        for (int held = 0; held < 4; held++) {
            memset(octets, 0, sizeof octets);
            memcpy(octets + 4, &count, sizeof count);
            const Toys got = read_back(&f, &from, octets, 8 + (size_t)held * (toy_octets + 4), 4, arena);
            CHECK(fields_good(&f) == ((int)count <= held) && got.count == (fields_good(&f) ? (int)count : 0));
        }
    for (uint32_t count = most_toys; count <= most_toys + 1; count++) {
        memcpy(octets + 4, &count, sizeof count);
        read_back(&f, &from, octets, sizeof octets, 4, arena);
        CHECK(fields_good(&f) == (count == most_toys));
    }
    arena_destroy(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_written_is_read),
                                       cmocka_unit_test(what_is_out_of_range_is_named),
                                       cmocka_unit_test(a_count_is_no_more_than_the_octets_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
