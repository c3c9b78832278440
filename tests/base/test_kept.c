/* Values of the cache's entries: the same after they were kept, refused where anything is too short, too long or not
 * finite. */
#include "tests/adding_snippet.h"

#include "pitviper_kept.h"

typedef struct Thing {
    uint8_t kind;
    int32_t count;
    double  number[3];
    float   small[2];
    bool    odd; /* passes a value more while it is written than while it is read */
} Thing;

static void pass_thing(Kept *kept, void *user)
{
    Thing *t = user;
    kept_pass(kept, &t->kind, sizeof t->kind);
    kept_check(kept, t->kind < 3);
    kept_pass(kept, &t->count, sizeof t->count);
    kept_doubles(kept, t->number, 3);
    kept_floats(kept, t->small, 2);
    if (t->odd && !kept_is_read(kept)) kept_pass(kept, &t->kind, 1);
}

static const Thing whole = {2, -7, {1.5, -0.0, 1e300}, {0.1f, -3}, false};
enum { octets_of_whole = 1 + 4 + 3 * 8 + 2 * 4 };

static void the_same_again(void **state)
{
    (void)state;
    Thing  from = whole, to = {0};
    size_t count = 0;
    char  *octets = kept_write(&count, pass_thing, &from);
    CHECK(octets && count == octets_of_whole);
    CHECK(kept_read(pass_thing, &to, octets, count));
    CHECK(to.kind == 2 && to.count == -7 && memcmp(to.number, whole.number, sizeof to.number) == 0 &&
          memcmp(to.small, whole.small, sizeof to.small) == 0);
    free(octets);
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    Thing  from = whole, to = {0};
    size_t count = 0;
    char  *octets = kept_write(&count, pass_thing, &from), longer[octets_of_whole + 1] = {0};
    CHECK(octets);
    for (size_t n = 0; n < count; n++) CHECK(!kept_read(pass_thing, &to, octets, n));
    memcpy(longer, octets, count);
    CHECK(!kept_read(pass_thing, &to, longer, count + 1));
    octets[0] = 3; /* checked, only while it is read */
    CHECK(!kept_read(pass_thing, &to, octets, count));
    free(octets);
    for (int k = 0; k < 5; k++) { /* numbers that are not finite */
        Thing bad = whole;
        if (k < 3) bad.number[k] = k == 1 ? INFINITY : NAN;
        else bad.small[k - 3] = k == 3 ? -INFINITY : NAN;
        octets = kept_write(&count, pass_thing, &bad);
        CHECK(octets && !kept_read(pass_thing, &to, octets, count));
        free(octets);
    }
}

/* Room is asked for before it is made: as much as there is left. */
static void room(void **state)
{
    (void)state;
    const char octets[8] = {0};
    Kept       kept = {.from = octets, .most = sizeof octets, .good = true};
    CHECK(kept_has(&kept, 8) && !kept_has(&kept, 9) && !kept.good && !kept_has(&kept, 0));
    Kept written = {.good = true};
    CHECK(kept_has(&written, SIZE_MAX));
}

static void through_a_folder(void **state)
{
    (void)state;
    char folder[temp_path_size], command[temp_path_size + 16];
    CHECK(temp_folder(folder));
    Cache   *cache = cache_open(folder, 1 << 20);
    Thing    from = whole, odd = whole, to = {0};
    CacheKey key = cache_key("thing");
    CHECK(cache && !kept_fetch(pass_thing, &to, cache, &key));
    kept_keep(pass_thing, &from, cache, &key);
    key = cache_key("thing");
    CHECK(kept_fetch(pass_thing, &to, cache, &key) && to.count == whole.count);
    odd.odd = true;
    key = cache_key("odd thing");
    CHECK(!kept_fetch(pass_thing, &to, cache, &key));
    kept_keep(pass_thing, &odd, cache, &key);
    key = cache_key("odd thing"); /* a whole entry of other values */
    CHECK(!kept_fetch(pass_thing, &to, cache, &key));
    key = cache_key("thing");
    CHECK(!kept_fetch(pass_thing, &to, NULL, &key));
    kept_keep(pass_thing, &from, NULL, &key);
    cache_close(cache);
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
}

/* The function of etc/ADDING.md is the one above. */
static void as_adding_shows_it(void **state)
{
    (void)state;
    check_adding_snippet("kept", "tests/base/test_kept.c");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_again),   cmocka_unit_test(what_is_wrong_is_refused), cmocka_unit_test(room),
        cmocka_unit_test(through_a_folder), cmocka_unit_test(as_adding_shows_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
