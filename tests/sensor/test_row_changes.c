/* Rows in which two versions of a table differ: what they are said to be, by hand; mixtures against rows put together
 * here; random pairs, whose two ends are the tables themselves. */
#include "tests/check.h"

#include "sensor/verify/bisect/row_changes.h"

static void write_to(char *out, size_t size, const RowChanges *c, const bool *is_new)
{
    FILE *to = fmemopen(out, size, "w");
    row_changes_write(to, c, is_new);
    fclose(to);
}

static const char old_table[] =
    "# of paints\nname,rho,gloss\n\nred,0.1,0.5\ngreen,0.2,0.5 \nblue,0.3,0.5\nwhite,0.9,0.1\n";

static void changed_new_and_removed_rows_are_told_apart(void **state)
{
    (void)state;
    static const char new_table[] =
        "# of paints, another remark\nname,rho,gloss\nred,0.1,0.5\ngreen,0.25,0.5\nblack,0.02,0.3\nwhite,0.9,0.2\n";
    static const char *const said[] = {
        "line 4, green: rho is 0.25, was 0.2",
        "line 5, black: name is black, was blue; rho is 0.02, was 0.3; gloss is 0.3, was 0.5",
        "line 6, white: gloss is 0.2, was 0.1"};
    RowChanges  c;
    const char *why;
    char        text[400], mixed[400];
    bool        is_new[3] = {false};
    CHECK(row_changes_of(&c, &why, old_table, new_table) == STATUS_OK && !why);
    /* green .. white is one stretch of as many rows on both sides: by place, blue became black */
    CHECK(c.count == 3);
    for (int i = 0; i < 3; i++) {
        row_changes_say(text, sizeof text, &c, i);
        assert_string_equal(text, said[i]);
    }
    write_to(mixed, sizeof mixed, &c, is_new);
    assert_string_equal(mixed, "name,rho,gloss\nred,0.1,0.5\ngreen,0.2,0.5\nblue,0.3,0.5\nwhite,0.9,0.1\n");
    is_new[2] = true;
    write_to(mixed, sizeof mixed, &c, is_new);
    assert_string_equal(mixed, "name,rho,gloss\nred,0.1,0.5\ngreen,0.2,0.5\nblue,0.3,0.5\nwhite,0.9,0.2\n");
    row_changes_free(&c);
}

static void rows_are_paired_by_their_name_where_some_are_new(void **state)
{
    (void)state;
    static const char        new_table[] = "name,rho,gloss\ngold,0.8,1\nred,0.1,0.5\ngreen,0.3,0.5\nwhite,0.8,0.1\n";
    static const char *const said[] = {"line 2, gold: is new", "line 4, green: rho is 0.3, was 0.2",
                                       "line 6, blue: was removed", "line 5, white: rho is 0.8, was 0.9"};
    RowChanges               c;
    const char              *why;
    char                     text[400];
    CHECK(row_changes_of(&c, &why, old_table, new_table) == STATUS_OK);
    CHECK(c.count == 4);
    for (int i = 0; i < 4; i++) {
        row_changes_say(text, sizeof text, &c, i);
        assert_string_equal(text, said[i]);
    }
    row_changes_free(&c);
}

static void remarks_alone_are_no_change(void **state)
{
    (void)state;
    RowChanges  c;
    const char *why;
    CHECK(row_changes_of(&c, &why, "name,a\n# x\nb,1\n", "\xef\xbb\xbfname,a\r\nb,1\r\n\n# y\n") == STATUS_OK);
    CHECK(c.count == 0);
    row_changes_free(&c);
}

static void what_has_other_columns_is_tried_as_a_whole(void **state)
{
    (void)state;
    RowChanges  c;
    const char *why;
    CHECK(row_changes_of(&c, &why, "name,a\nb,1\n", "name,a,b\nb,1,2\n") == STATUS_UNSUPPORTED);
    assert_string_equal(why, "its columns differ");
    CHECK(row_changes_of(&c, &why, "name,a\nb,1\n", "# nothing\n") == STATUS_UNSUPPORTED);
    assert_string_equal(why, "one of them has no rows");
}

/* A column changed in every row of a long table: more edits than are sought, so rows pair by place. */
static void a_column_that_changed_everywhere_is_row_by_row(void **state)
{
    (void)state;
    enum { rows = 3000 };
    char *was = malloc(64 * rows), *is = malloc(64 * rows), text[200];
    int   n = sprintf(was, "name,a\n"), m = sprintf(is, "name,a\n");
    for (int i = 0; i < rows; i++) n += sprintf(was + n, "r%d,%d\n", i, i), m += sprintf(is + m, "r%d,%d\n", i, i + 1);
    RowChanges  c;
    const char *why;
    CHECK(row_changes_of(&c, &why, was, is) == STATUS_OK);
    CHECK(c.count == rows);
    row_changes_say(text, sizeof text, &c, 1500);
    assert_string_equal(text, "line 1502, r1500: a is 1501, was 1500");
    row_changes_free(&c);
    strcpy(is + m, "last,1\n");
    CHECK(row_changes_of(&c, &why, was, is) == STATUS_UNSUPPORTED);
    free(was);
    free(is);
}

/* Tables of few names and values, so that many rows are equal: with no change it is the old one, with all the new. */
static void random_tables_mix_from_end_to_end(void **state)
{
    (void)state;
    enum { size = 1000 };
    bool none[200] = {false}, all[200];
    memset(all, true, sizeof all);
    for (uint64_t seed = 0; seed < 300; seed++) {
        char text[2][size], mixed[size];
        for (int side = 0; side < 2; side++) {
            int       n = sprintf(text[side], "name,a\n");
            const int rows = 1 + (int)(30 * random_uniform(seed, 1, (uint64_t)side, 0));
            for (int i = 0; i < rows; i++)
                n += sprintf(text[side] + n, "%c,%d\n",
                             'a' + (int)(5 * random_uniform(seed, 2, (uint64_t)side, (uint64_t)i)),
                             (int)(3 * random_uniform(seed, 3, (uint64_t)side, (uint64_t)i)));
        }
        RowChanges  c;
        const char *why;
        CHECK(row_changes_of(&c, &why, text[0], text[1]) == STATUS_OK);
        CHECK(c.count <= 200);
        write_to(mixed, size, &c, none);
        assert_string_equal(mixed, text[0]);
        write_to(mixed, size, &c, all);
        assert_string_equal(mixed, text[1]);
        row_changes_free(&c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changed_new_and_removed_rows_are_told_apart),
        cmocka_unit_test(rows_are_paired_by_their_name_where_some_are_new),
        cmocka_unit_test(remarks_alone_are_no_change),
        cmocka_unit_test(what_has_other_columns_is_tried_as_a_whole),
        cmocka_unit_test(a_column_that_changed_everywhere_is_row_by_row),
        cmocka_unit_test(random_tables_mix_from_end_to_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
