/* tests/base/test_columns.c: rows of CSV into a toy struct (pitviper_table.h), against answers written by hand: types,
 * units, ranges, columns that are missing, doubled, later or unknown, and files that spreadsheets and vandals write.
 * The toy touches one file, this one; etc/ADDING.md's column is one row of `columns` and one member. */
#include "tests/adding_snippet.h"
#include "tests/check.h"
#include "pitviper_table.h"

typedef enum Colour { RED, DARK_GREEN, BLUE } Colour;

typedef struct Toy {
    char        name[8];
    const char *note;
    double      length_m, whole, later, paint_m;
    float       share;
    int         wheels;
    Colour      colour;
    char        initial;
} Toy;

static const char *parse_initial(void *out, const char *text)
{
    if (strlen(text) != 1) return "one letter";
    *(char *)out = *text;
    return NULL;
}

static const TableColumn columns[] = {
    {"name", .type = TABLE_NAME, TABLE_AT(Toy, name)},
    {"note", .type = TABLE_CELL, TABLE_AT(Toy, note)},
    {"length_64ths", TABLE_DOUBLE, TABLE_AT(Toy, length_m), .low = -5, .high = 4096, .unit = 0.015625},
    {"whole", TABLE_WHOLE, TABLE_AT(Toy, whole), .low = 0, .high = 1e6},
    {"share", TABLE_FLOAT, TABLE_AT(Toy, share), .low = 0, .high = 1, .absent = TABLE_EMPTY, .otherwise = 0.5},
    {"wheels", TABLE_INT, TABLE_AT(Toy, wheels), .low = -2, .high = 18},
    {"colour", TABLE_CHOICE, TABLE_AT(Toy, colour), .choices = "red, dark green, blue"},
    {"initial", TABLE_OWN, TABLE_AT(Toy, initial), .parse = parse_initial, .absent = TABLE_OPTIONAL},
    {"later", TABLE_DOUBLE, TABLE_AT(Toy, later), .low = 0, .high = 9, .unit = 2, .absent = TABLE_LATER,
     .otherwise = 3},
    {"paint_um", TABLE_DOUBLE, TABLE_AT(Toy, paint_m), .low = 0, .high = 900, .unit = 1e-6, .absent = TABLE_LATER,
     .otherwise = 40},
};
enum { count = sizeof columns / sizeof *columns };
static const TableFormat format = {"toys",          columns,       count, .next = "the toy's maker knows",
                                   .least_rows = 0, .most_rows = 3};

#define HEAD "name,note,length_64ths,whole,share,wheels,colour,initial,later\n"

typedef struct Box {
    Toy toy[3];
    int toys;
} Box;

static Status take(void *user, const void *row, const TableRows *rows, int number)
{
    Box *box = user;
    box->toy[box->toys] = *(const Toy *)row;
    CHECK(number == box->toys && rows->format == &format);
    box->toys++;
    return strcmp(box->toy[number].name, "thief") == 0 ? table_rows_refuse(rows, number, "name", "an honest %s", "one")
                                                       : STATUS_OK;
}

static Status read_text(Box *box, const char *text)
{
    char path[text_file_size];
    Toy  toy;
    *box = (Box){0};
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = table_each(&format, path, &toy, sizeof toy, take, box);
    log_set_sink(NULL, NULL);
    remove(path);
    return status;
}

static void cells_become_members(void **state)
{
    (void)state;
    Box box;
    /* CRLF, a byte-order mark, quotes with commas and doubled quotes, another order, a column that no TableColumn names
     */
    CHECK(read_text(
              &box,
              "\xef\xbb\xbf# toys\r\nwhole, colour,name,\"length_64ths\",stranger,note,share,wheels,later,initial\r\n"
              "\r\n 1e3 ,dark green, car ,64,\"x,y\",\"say \"\"hi\"\", ok\",0.25,-2,4.5,c\r\n"
              "0,blue,\"b,\",-5,,,,18,0,\r\n") == STATUS_OK);
    CHECK(box.toys == 2);
    const Toy *a = &box.toy[0], *b = &box.toy[1];
    assert_string_equal(a->name, "car");
    CHECK(a->length_m == 1 && a->whole == 1000 && a->later == 9 && a->share == 0.25f && a->wheels == -2);
    CHECK(a->colour == DARK_GREEN && a->initial == 'c');
    assert_string_equal(b->name, "b,");
    CHECK(b->length_m == -0.078125 && b->whole == 0 && b->later == 0 && b->share == 0.5f && b->wheels == 18);
    CHECK(b->colour == BLUE && b->initial == 0);
}

/* Texts are the table's: they live until it is closed. */
static void rows_are_read_in_any_order(void **state)
{
    (void)state;
    TableRows rows;
    Toy       toy;
    char      path[text_file_size];
    int       row = -1;
    text_file(path, HEAD "a,\"say \"\"hi\"\"\",1,1,0,1,red,a,1\nb,,1,1,0,1,red,a,1\na,third,1,1,0,1,red,a,1\n");
    CHECK(table_rows_open(&rows, &format, path) == STATUS_OK);
    CHECK(table_rows_has(&rows, "later") && !table_rows_has(&rows, "none"));
    memset(&toy, 0x55, sizeof toy);
    CHECK(table_rows_get(&toy, &rows, 2) == STATUS_OK);
    assert_string_equal(toy.note, "third");
    CHECK(table_rows_get(&toy, &rows, 0) == STATUS_OK);
    assert_string_equal(toy.note, "say \"hi\"");
    CHECK(table_rows_get(&toy, &rows, 1) == STATUS_OK);
    assert_string_equal(toy.note, "");
    assert_string_equal(table_rows_text(&rows, 2, "note"), "third");
    assert_string_equal(table_rows_text(&rows, 2, "none"), "");
    CHECK(table_rows_find(&row, &rows, "b", "toy", "", "") == STATUS_OK && row == 1);
    log_set_sink(check_listen, NULL);
    check_said[0] = 0;
    CHECK(table_rows_find(&row, &rows, "a", "toy", "", "") == STATUS_BAD_VALUE && row == 1);
    CHECK(strstr(check_said, ":4: column name: 'a' is not another name"));
    check_said[0] = 0;
    CHECK(table_rows_find(&row, &rows, "nonne", "toy", " (nor there)", "none") == STATUS_BAD_VALUE && row == 1);
    log_set_sink(NULL, NULL);
    CHECK(strstr(check_said, "no toy named 'nonne' (nor there); there are: a, b, a; did you mean none?"));
    table_rows_close(&rows);
    remove(path);
}

/* A file from before `later`, and one without `initial`, too. Others may not be missing, whatever their cells. */
static void a_file_older_than_a_column_is_read(void **state)
{
    (void)state;
    Box box;
    CHECK(read_text(&box, "name,note,length_64ths,whole,share,wheels,colour\na,,1,1,,1,red\n") == STATUS_OK);
    CHECK(box.toys == 1 && box.toy[0].later == 6 && box.toy[0].initial == 0 && box.toy[0].share == 0.5f);
    CHECK(read_text(&box, "name,note,length_64ths,whole,wheels,colour\na,,1,1,1,red\n") == STATUS_BAD_VALUE);
    CHECK(strstr(check_said, ":1: no column share; the toy's maker knows"));
    CHECK(box.toys == 0);
}

/* The row of etc/ADDING.md is the one above; a file that has its column gives the member. */
static void the_column_of_adding_is_read(void **state)
{
    (void)state;
    check_adding_snippet("column", "tests/base/test_columns.c");
    Box box;
    CHECK(read_text(&box, "name,note,length_64ths,whole,share,wheels,colour,paint_um\na,,1,1,,1,red,900\n") ==
          STATUS_OK);
    CHECK_NEAR(box.toy[0].paint_m, 9e-4, 1e-18);
    CHECK(read_text(&box, "name,note,length_64ths,whole,share,wheels,colour\na,,1,1,,1,red\n") == STATUS_OK);
    CHECK_NEAR(box.toy[0].paint_m, 4e-5, 1e-18);
    CHECK(read_text(&box, "name,note,length_64ths,whole,share,wheels,colour,paint_um\na,,1,1,,1,red,901\n") ==
          STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "column paint_um: '901' is not a number in 0 .. 900"));
}

/* What is shown of a source stands in it, or not (tests/adding_snippet.h, by which other sections are compared too). */
static void what_is_shown_stands(void **state)
{
    (void)state;
    static const char source[] = "int a(void)\n{\n    return 1;\n}\nint b ( void ) { }\n";
    CHECK(adding_stands("int a(void) { return 1; }\nint b(void)\n{\n}", source));
    CHECK(adding_stands("int a(void) { ... }\n\nint b(void)", source) && adding_stands("int a(void)\n\n}", source));
    CHECK(!adding_stands("int a(void) { return 2; }", source) && !adding_stands("int a(void) { }", source));
    CHECK(!adding_stands("int b(void) { ... int a(void)", source) &&
          !adding_stands("int b(void)\n\nint a(void)", source));
    CHECK(!adding_stands("int b(void) { }\nint c(void);", source) && !adding_stands("", source));
}

/* Of two columns of one name the first is read, as everywhere before. */
static void of_doubled_columns_the_first_is_read(void **state)
{
    (void)state;
    Box box;
    CHECK(read_text(&box, "name,note,length_64ths,whole,share,wheels,colour,whole\na,,1,7,,1,red,8\n") == STATUS_OK);
    CHECK(box.toy[0].whole == 7);
}

/* One style: module, file, line, column, value, what is accepted, next step. */
static void what_is_wrong_is_said_in_one_way(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {HEAD "a,,1,1,0,1,red,a,1\n# x\nb,,4096.5,1,0,1,red,a,1\n",
         ":4: column length_64ths: '4096.5' is not a number in -5 .. 4096; the toy's maker knows"},
        {HEAD "a,,-5.25,1,0,1,red,a,1\n", ":2: column length_64ths: '-5.25' is not a number in -5 .. 4096"},
        {HEAD "a,,1,1,0,-3,red,a,1\n", ":2: column wheels: '-3' is not a whole number in -2 .. 18"},
        {HEAD "a,,nan,1,0,1,red,a,1\n", ":2: column length_64ths: 'nan' is not a number in -5 .. 4096"},
        {HEAD "a,,-inf,1,0,1,red,a,1\n", ":2: column length_64ths: '-inf' is not a number"},
        {HEAD "a,,1e999,1,0,1,red,a,1\n", ":2: column length_64ths: '1e999' is not a number"},
        {HEAD "a,,0x10,1,0,1,red,a,1\n", ":2: column length_64ths: '0x10' is not a number"},
        {HEAD "a,,\"1,5\",1,0,1,red,a,1\n", ":2: column length_64ths: '1,5' is not a number"},
        {HEAD "a,,,1,0,1,red,a,1\n", ":2: column length_64ths: '' is not a number"},
        {HEAD "a,,1,1.5,0,1,red,a,1\n", ":2: column whole: '1.5' is not a whole number in 0 .. 1e+06"},
        {HEAD "a,,1,1,0,2.25,red,a,1\n", ":2: column wheels: '2.25' is not a whole number in -2 .. 18"},
        {HEAD "a,,1,1,0,4294967297,red,a,1\n", ":2: column wheels: '4294967297' is not a whole number in -2 .. 18"},
        {HEAD "a,,1,1,1.0000001,1,red,a,1\n", ":2: column share: '1.0000001' is not a number in 0 .. 1"},
        {HEAD "a,,1,1,0,1,green,a,1\n", ":2: column colour: 'green' is not one of red, dark green, blue"},
        {HEAD "a,,1,1,0,1,re,a,1\n", ":2: column colour: 're' is not one of"},
        {HEAD "a,,1,1,0,1,\"red, dark green\",a,1\n", ":2: column colour: 'red, dark green' is not one of"},
        {HEAD "a,,1,1,0,1,,a,1\n", ":2: column colour: '' is not one of"},
        {HEAD "a,,1,1,0,1,red,ab,1\n", ":2: column initial: 'ab' is not one letter; the toy's maker knows"},
        {HEAD "a,,1,1,0,1,red,a,\n", ":2: column later: '' is not a number in 0 .. 9"},
        {HEAD ",,1,1,0,1,red,a,1\n", ":2: column name: '' is not a name of 1 to 7 characters"},
        {HEAD "eightlet,,1,1,0,1,red,a,1\n", ":2: column name: 'eightlet' is not a name of 1 to 7 characters"},
        {HEAD "thief,,1,1,0,1,red,a,1\n", ":2: column name: 'thief' is not an honest one; the toy's maker knows"},
        {HEAD "a,,1,1,0,1,red,a\n", ":2: 8 columns where the header has 9"},
        {HEAD "a,\"x,1,1,0,1,red,a,1\n", ":2: a quote is not closed"},
        {HEAD "a,,1,1,0,1,red,a,1\na,,1,1,0,1,red,a,1\na,,1,1,0,1,red,a,1\na,,1,1,0,1,red,a,1\n",
         ": 4 rows, of 0 to 3; the toy's maker knows"},
        {"\xef\xbb\xbf", ": no header line"},
        {"", ": no header line"},
        {"nom,note\n", ":1: no column name"},
        {HEAD "a,,\x1b[2J,1,0,1,red,a,1\n", ":2: column length_64ths: '\\x1b[2J' is not a number"},
    };
    Box box;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK(read_text(&box, bad[i].text) == STATUS_BAD_VALUE);
        if (!strstr(check_said, bad[i].said) || !strstr(check_said, "toys: /tmp/pitviper-test-"))
            fail_msg("said '%s' where '%s' was wanted", check_said, bad[i].said);
    }
}

/* A cell of a megabyte is refused as any other, its message cut; a name of it too; a note of it is read whole. */
static void very_long_lines(void **state)
{
    (void)state;
    enum { long_octets = 1 << 20 };
    static char cell[long_octets + 1], text[long_octets + 256];
    Box         box;
    memset(cell, '7', long_octets);
    snprintf(text, sizeof text, HEAD "a,,%s,1,0,1,red,a,1\n", cell);
    CHECK(read_text(&box, text) == STATUS_BAD_VALUE && strstr(check_said, "is not a number in") &&
          strlen(check_said) < 400);
    snprintf(text, sizeof text, HEAD "%s,,1,1,0,1,red,a,1\n", cell);
    CHECK(read_text(&box, text) == STATUS_BAD_VALUE && strstr(check_said, "is not a name of 1 to 7 characters"));
    snprintf(text, sizeof text, HEAD "a,%s,1,1,0,1,red,a,1\n", cell);
    CHECK(read_text(&box, text) == STATUS_OK && box.toys == 1);
}

/* On failure what was read before stays as it was: the row that is wrong is not given to anyone. */
static void a_bad_row_is_given_to_nobody(void **state)
{
    (void)state;
    Box box;
    CHECK(read_text(&box, HEAD "a,,1,1,0,1,red,a,1\nb,,9999,1,0,1,red,a,1\nc,,1,1,0,1,red,a,1\n") == STATUS_BAD_VALUE);
    CHECK(box.toys == 1);
    CHECK(table_each(&format, "/nonexistent/toys.csv", &box.toy[0], sizeof(Toy), take, &box) == STATUS_IO);
}

/* ---- keys: no two rows of the same, and where the format says so one of each ---- */

typedef struct Cell {
    int    size, colour;
    double number;
} Cell;

static const char *size_named(int size) { return size == 1 ? "small" : size == 2 ? "large" : "none"; }

static const TableColumn cell_columns[] = {
    {"size", TABLE_NAMED, TABLE_AT(Cell, size), .low = 1, .high = 2, .named = size_named, .key = true},
    {"number", TABLE_DOUBLE, TABLE_AT(Cell, number), .low = 0, .high = 99},
    {"colour", TABLE_CHOICE, TABLE_AT(Cell, colour), .choices = "red, blue", .key = true},
};

static Status take_cell(void *user, const void *row, const TableRows *rows, int number)
{
    const Cell *cell = row;
    (void)rows, (void)number;
    ((double *)user)[2 * cell->size + cell->colour] = cell->number;
    return STATUS_OK;
}

static void rows_have_keys(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said; /* NULL: it is read */
        bool        every;
    } cases[] = {
        {"small,1,red\nlarge,2,blue\nlarge,3,red\nsmall,4,blue\n", NULL, true},
        {"small,1,red\nlarge,2,blue\n", NULL, false},
        {"small,1,red\nlarge,2,blue\nlarge,3,red\n", ": no row of size small, colour blue; ask", true},
        {"", ": no row of size small, colour red; ask", true},
        {"small,1,red\nsmall,2,blue\nsmall,3,red\n", ":4: a second row of size small, colour red; ask", false},
        {"none,1,red\n", ":2: column size: 'none' is not one of small, large; ask", false},
        {"small,100,red\n", ":2: column number: '100'", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const TableFormat cells = {"cells", cell_columns, 3, .every = cases[i].every, .next = "ask"};
        char              path[text_file_size], text[256];
        Cell              row;
        double            got[6] = {0};
        snprintf(text, sizeof text, "size,number,colour\n%s", cases[i].text);
        text_file(path, text);
        check_said[0] = 0;
        log_set_sink(check_listen, NULL);
        const Status status = table_each(&cells, path, &row, sizeof row, take_cell, got);
        log_set_sink(NULL, NULL);
        remove(path);
        CHECK(status == (cases[i].said ? STATUS_BAD_VALUE : STATUS_OK));
        if (cases[i].said && !strstr(check_said, cases[i].said)) fail_msg("case %zu: said '%s'", i, check_said);
        if (i == 0) CHECK(got[2] == 1 && got[3] == 4 && got[4] == 3 && got[5] == 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_become_members),
        cmocka_unit_test(rows_are_read_in_any_order),
        cmocka_unit_test(a_file_older_than_a_column_is_read),
        cmocka_unit_test(the_column_of_adding_is_read),
        cmocka_unit_test(what_is_shown_stands),
        cmocka_unit_test(of_doubled_columns_the_first_is_read),
        cmocka_unit_test(what_is_wrong_is_said_in_one_way),
        cmocka_unit_test(very_long_lines),
        cmocka_unit_test(a_bad_row_is_given_to_nobody),
        cmocka_unit_test(rows_have_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
